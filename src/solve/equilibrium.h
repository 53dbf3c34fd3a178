/* equilibrium - from first force densities to the shape of least energy. The paper's iteration and Newton's method
 * alternate until the residual is small (METHOD section 5).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_EQUILIBRIUM_H
#define HIFDM_EQUILIBRIUM_H

#include <hifdm/formfind.h>

/* Start from the workspace's q_N_per_m under its law and target (hf_form_prepare, hf_evaluate_prepare). Iterations of
 * hf_form_find alternate with Newton steps (hf_newton_run); a net with elastic cables descends on its energy first
 * (hf_descent_run). A shape found by Newton is measured without another linear solve. Stops by residual;
 * result->iterations counts the steps of all kinds. history (may be NULL) holds the fixed-point iterations. Needs a
 * workspace of a model with has_newton. Returns result->status. */
hf_status hf_equilibrium_find(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                              hf_history *history, hf_form_result *result);

#endif
