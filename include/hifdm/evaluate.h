/* evaluate - one form-finding by the method that fits, alone or on a truss -> one plain result: of the case itself
 * (hf_evaluate_form), or of a design, which is a boundary pretension for each gene (hf_evaluate).
 * Stability: stable. */
#ifndef HIFDM_EVALUATE_H
#define HIFDM_EVALUATE_H

#include <hifdm/formfind.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The method that form.method means in this net: HF_METHOD_NEWTON, or HF_METHOD_HIFDM for the paper's iteration (which
 * serves iterative_fdm and fdm too: the laws of the model decide). *why (may be NULL): the reason in words. */
hf_method hf_evaluate_method(const hf_model *model, const hf_form_settings *form, const char **why);

/* Form-finding as the case asks for it, with its certificate. history: NULL, or where iterations are recorded. Returns
 * result->status, HF_OK, HF_NOT_CONVERGED or an ill-posed one; the shape stays in the workspace. */
hf_status hf_evaluate_form(const hf_model *model, const hf_form_settings *form, hf_workspace *workspace,
                           hf_history *history, hf_form_result *result);

/* Constant during a run, shared by all threads. model, form and start_q are borrowed. */
typedef struct {
    const hf_model *model;
    const hf_form_settings *form;
    const double *start_q_N_per_m; /* [n_cable] first force densities of the inner cables: those of the found shape */
    hf_rule rule;
    hf_solver solver;
    double boundary_ratio_cap; /* a larger boundary tension ratio is HF_RATIO_CAP; INFINITY: no cap */
} hf_evaluator;

/* design_N: [model->n_gene] boundary pretensions T' > 0. The shape stays in the workspace. A candidate that fails has
 * its status in the result and NaN for psi and ratios; that is not an error of the run. Returns result->status. */
hf_status hf_evaluate(const hf_evaluator *evaluator, const double *design_N, hf_workspace *workspace,
                      hf_form_result *result);

/* The parts of hf_evaluate before and after the solver. prepare: laws, targets and first force densities of a design
 * into the workspace. judge: the cap on the ratio, and NaN measures for an infeasible design; returns the status. */
void hf_evaluate_prepare(const hf_evaluator *evaluator, const double *design_N, hf_workspace *workspace);
hf_status hf_evaluate_judge(const hf_evaluator *evaluator, hf_form_result *result);

/* L* of a boundary cable: the prescribed length where there is one, else the theoretical one, m. */
double hf_evaluate_design_length_m(const hf_model *model, int i_cable);

#ifdef __cplusplus
}
#endif
#endif
