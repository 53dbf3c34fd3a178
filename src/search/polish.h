/* polish - Levenberg-Marquardt on the boundary pretensions (gsl_multilarge_nlinear) with exact sensitivities: the
 * yardstick for the genetic algorithm, and a finish for it. psi^2 is a sum of squares; its derivative is one solve per
 * gene, or class of linked genes, with the factored Newton matrix, dx/dT_k = -H^-1 dg/dT_k (METHOD section 7, M11). */
#ifndef HIFDM_POLISH_H
#define HIFDM_POLISH_H

#include <hifdm/evaluate.h>

typedef struct {
    int iterations, evaluations;
    double start_psi_m, psi_m;
    int converged; /* 0: the iteration limit ended it */
} hf_polish_result;

/* Can this evaluator be polished: a convex net, and the rule force_density or tension. */
int hf_polish_applies(const hf_evaluator *evaluator);

/* From the feasible design_N [n_gene] within [lower_N, upper_N], which the best design found replaces (never a worse
 * or an infeasible one). Genes linked by a symmetry keep their differences. workspace is scratch. HF_OK, HF_NO_MEMORY,
 * or the status of a start that is infeasible. GSL's error handler must be off (hifdm.h). */
hf_status hf_polish_run(const hf_evaluator *evaluator, const double *lower_N, const double *upper_N, int max_iterations,
                        double *design_N, hf_workspace *workspace, hf_polish_result *result);

#endif
