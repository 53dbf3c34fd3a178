/* equilibrium - from first force densities to the shape of least energy: a few steps of the paper's iteration and of
 * Newton's method where these are near the answer, else the primal-dual path (METHOD section 5).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_EQUILIBRIUM_H
#define HIFDM_EQUILIBRIUM_H

#include <hifdm/formfind.h>

/* Start from the workspace's q_N_per_m under its law and target (hf_form_prepare, hf_evaluate_prepare): iterations of
 * hf_form_find, then hf_newton_run. Where these do not converge, and at once for a net with elastic cables,
 * hf_interior_run finds the shape from the theoretical one. Stops by residual; result->iterations counts the steps of
 * all kinds. history (may be NULL) holds them. Needs a workspace of a model with has_newton.
 * Returns result->status. */
hf_status hf_equilibrium_find(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                              hf_history *history, hf_form_result *result);

#endif
