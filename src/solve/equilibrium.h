/* equilibrium - from first force densities to the shape of least energy: a few steps of the paper's iteration and of
 * Newton's method where these are near the answer, else the primal-dual path (METHOD section 5).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_EQUILIBRIUM_H
#define HIFDM_EQUILIBRIUM_H

#include <hifdm/formfind.h>

/* Start from the workspace's q_N_per_m under its law and target (hf_form_prepare, hf_evaluate_prepare): iterations of
 * hf_form_find, then hf_newton_run. Where these do not converge, and at once for a net with elastic cables
 * unless starts_near, hf_interior_run finds the shape from the theoretical one. Stops by residual; result->iterations
 * counts the steps of all kinds. history (may be NULL) holds them. Needs a workspace of a model with has_newton.
 * Returns result->status. */
hf_status hf_equilibrium_find(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                              hf_history *history, hf_form_result *result);

/* hf_form_find, but where the path applies (has_newton) no refusal is about an iterate alone. Nodes that run together
 * on the way may part again, and a net without a shape may end as not converged: the path says whether the net has a
 * shape. Where it has one, the iteration goes on; else the status and the culprit are those of the path. Counts the
 * steps of both. */
hf_status hf_equilibrium_find_by_paper(const hf_model *model, const hf_form_settings *settings, hf_stop_rule stop,
                                       hf_workspace *workspace, hf_history *history, hf_form_result *result);

/* For an iteration under the rule residual that has ended as not converged, with its laws, force densities and shape in
 * the workspace: where the path says that the net has no shape, status and culprit become those of the path. Returns
 * result->status. */
hf_status hf_equilibrium_judge_open(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                                    hf_form_result *result);

#endif
