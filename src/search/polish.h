/* polish - Levenberg-Marquardt on the boundary pretensions, with exact sensitivities, within limits (METHOD section 7).
 * It measures how good the design of the genetic algorithm is, and can improve it. Each step is the least of the
 * damped quadratic model of psi^2 within the bounds and below the cap on the boundary tension ratio, which are linear
 * limits of a quadratic programme: an active bound is met exactly, and no penalty bends the way to the optimum. */
#ifndef HIFDM_POLISH_H
#define HIFDM_POLISH_H

#include <hifdm/optimiser.h>
#include <hifdm/evaluate.h>

typedef struct {
    int iterations, evaluations;
    double start_psi_m, psi_m;
    hf_polish_stop stop;
    int n_at_lower, n_at_upper; /* pretensions at their bounds */
    bool is_at_cap;             /* the cap on the boundary tension ratio holds the last step */
} hf_polish_result;

/* Can designs of this evaluator be polished? The net must be convex, and the rule force_density or tension. */
bool hf_polish_applies(const hf_evaluator *evaluator);

/* Is a run from a design of the genetic algorithm cheap beside its n_evaluation evaluations? By counted operations, so
 * that the answer does not depend on the machine: at most a tenth of theirs, or too few to notice. */
bool hf_polish_is_cheap(const hf_evaluator *evaluator, long n_evaluation);

/* Start from the feasible design_N [n_gene] within [lower_N, upper_N] and replace it by the best design found, which is
 * feasible and never worse. Genes linked by a symmetry keep their differences. workspace is scratch. Returns HF_OK,
 * HF_NO_MEMORY, HF_INTERRUPTED, or the status of an infeasible start. */
hf_status hf_polish_run(const hf_evaluator *evaluator, const double *lower_N, const double *upper_N, int max_iterations,
                        double *design_N, hf_workspace *workspace, hf_polish_result *result);

#endif
