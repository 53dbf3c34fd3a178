/* repair - moves proposed designs into optimize.limits, into constraints by requirements and below boundary_ratio_cap
 * before they are evaluated. All children of a generation share a linear model of the limited values: that at its best
 * design, or at the design nearest to the limits. A child that breaks a limit by this model is mirrored at the limit
 * that it breaks most, until it breaks none (METHOD section 7). Steps are measured relative to the widths of the
 * bounds. */
#pragma once

#include <hifdm/evaluate.h>
#include <hifdm/population.h>

typedef struct hf_repair hf_repair;

/* Creates a repair for designs of this population. It borrows the evaluator and the bounds of the population. *repair
 * is NULL if there are no limits or no derivatives, or if a model would cost more than a generation. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_repair_create(const hf_evaluator *evaluator, const hf_population *population, hf_repair **repair);
void hf_repair_free(hf_repair *repair); /* `repair` may be NULL */

/* Computes the model for the children of the generation `now`. If all designs that were evaluated last are within the
 * limits, there is no model, and the children stay as they are. */
void hf_repair_begin(hf_repair *repair, const hf_population *now);

/* Returns true if there is a model. */
bool hf_repair_is_active(const hf_repair *repair);

/* Returns true if the model has no design within the bounds that meets all limits: a value cannot come within 1 % of
 * its limit, or two tensions cannot come within 1 % of the cap on their ratio. *ratio: minimum of that ratio if it is
 * the boundary tension ratio, else NaN. */
bool hf_repair_expects_none(const hf_repair *repair, double *ratio);

/* Moves individual i of `next`. Several threads may move different individuals at the same time. One individual in
 * eight stays as it is and shows whether the limits still bind. */
void hf_repair_child(const hf_repair *repair, hf_population *next, int i);
