/* evaluate - one design (a boundary pretension for each gene) -> one plain result. */
#ifndef HIFDM_EVALUATE_H
#define HIFDM_EVALUATE_H

#include <hifdm/config.h>
#include <hifdm/formfind.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Constant during a run, shared by all threads. model, form and start_q are borrowed. */
typedef struct {
    const hf_model *model;
    const hf_form_settings *form;
    const double *start_q_N_per_m; /* [n_cable] first force densities of the inner cables: those of the found shape */
    int rule;                      /* hf_rule */
    double boundary_ratio_cap;
} hf_evaluator;

/* design_N: [model->n_gene] boundary pretensions T' > 0. The shape stays in the workspace. A candidate that fails has
 * its status in the result and NaN measures; that is not an error of the run. Returns result->status. */
hf_status hf_evaluate(const hf_evaluator *evaluator, const double *design_N, hf_workspace *workspace,
                      hf_form_result *result);

#ifdef __cplusplus
}
#endif
#endif
