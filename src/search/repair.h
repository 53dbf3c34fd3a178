/* repair - moves proposed designs into optimize.limits, into constraints by requirements and below boundary_ratio_cap
 * before they are evaluated. All children of a generation share a linear model of the limited values: that at its best
 * design, or at the design nearest to the limits. A child that breaks a limit by this model is mirrored at the limit
 * that it breaks most, until it breaks none (METHOD section 7). Steps are measured relative to the widths of the
 * bounds. */
#pragma once

#include "solve/limits.h"
#include <hifdm/evaluate.h>
#include <hifdm/population.h>

typedef struct hf_repair hf_repair;

/* Creates a repair for designs of this population. It borrows the evaluator and the bounds of the population. *repair
 * is NULL if there are no limits or no derivatives, or if hf_refine_model_is_cheap returns false. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_repair_create(const hf_evaluator *evaluator, const hf_population *population, hf_repair **repair);
void hf_repair_free(hf_repair *repair); /* `repair` may be NULL */

/* Computes the model for the children of the generation `now`. If all designs that were evaluated last are within the
 * limits, there is no model, and the children stay as they are. */
void hf_repair_begin(hf_repair *repair, const hf_population *now);

/* Returns true if there is a model. */
bool hf_repair_is_active(const hf_repair *repair);

/* A limit that no design within the bounds meets by the model. `limit` has cables or attachment, bound, and as its
 * value an estimate of the best value that designs reach, on the wrong side of the bound. */
typedef struct {
    hf_limit_held limit; /* row: HF_LIMITS_CAP for the boundary tension ratio, else 0 */
    int constraint;      /* constraint by a requirement, or -1 */
} hf_repair_doubt;

/* Looks for a limit that the model exceeds by more than 1 % at all designs within the bounds. Each limit is looked at
 * alone, and of a ratio each pair of tensions. Values that no variable changes are left out, because they may have no
 * derivatives. Must be called before another generation is proposed. Returns false if there is no such limit, or no
 * model. */
bool hf_repair_doubts(const hf_repair *repair, hf_repair_doubt *doubt);

/* Moves individual i of `next`. Several threads may move different individuals at the same time. One individual in
 * eight stays as it is and shows whether the limits still bind. */
void hf_repair_child(const hf_repair *repair, hf_population *next, int i);
