/* polish - Levenberg-Marquardt on the boundary pretensions (gsl_multilarge_nlinear) with exact sensitivities. It
 * measures how good the design of the genetic algorithm is, and can improve it. psi^2 is a sum of squares; its
 * derivative takes one solve with the factored Newton matrix per gene, or per class of linked genes: dx/dT_k = -H^-1
 * dg/dT_k (METHOD section 7, M11). */
#ifndef HIFDM_POLISH_H
#define HIFDM_POLISH_H

#include <hifdm/evaluate.h>

typedef struct {
    int iterations, evaluations;
    double start_psi_m, psi_m;
    bool converged; /* false: the iteration limit ended the run */
} hf_polish_result;

/* Can designs of this evaluator be polished? The net must be convex, and the rule force_density or tension. */
bool hf_polish_applies(const hf_evaluator *evaluator);

/* Start from the feasible design_N [n_gene] within [lower_N, upper_N] and replace it by the best design found, which is
 * feasible and never worse. Genes linked by a symmetry keep their differences. workspace is scratch. Returns HF_OK,
 * HF_NO_MEMORY, or the status of an infeasible start. GSL's error handler must be off (hifdm.h). */
hf_status hf_polish_run(const hf_evaluator *evaluator, const double *lower_N, const double *upper_N, int max_iterations,
                        double *design_N, hf_workspace *workspace, hf_polish_result *result);

#endif
