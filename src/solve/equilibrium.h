/* equilibrium - from first force densities to the shape of minimum energy. It takes a few steps of the paper's
 * iteration and of Newton's method if the start is near the answer, else the primal-dual path (METHOD section 5).
 * Stability: internal; may change in any version. */
#pragma once

#include <hifdm/formfind.h>

/* Finds the shape from the workspace's q_N_per_m under its law and target (hf_form_prepare, hf_evaluate_prepare). It
 * takes iterations of hf_form_find, then Newton steps (hf_newton_run). If they do not converge, hf_interior_run starts
 * at the target positions. A net with elastic cables goes there at once unless starts_near is set. The stopping rule is
 * residual, and result->iterations counts the steps of all kinds. history (may be NULL) receives them. The workspace
 * must be of a model with has_newton. Returns result->status. */
hf_status hf_equilibrium_find(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                              hf_history *history, hf_form_result *result);

/* Finds the shape by the paper's iteration, hf_form_find. An iterate may collapse although the net has a shape, and the
 * iteration on a net without a shape may end as not converged. Where the path applies (has_newton), it therefore
 * decides whether the net has a shape. If so, the iteration continues; else status and culprit are those of the path.
 * The steps of both are counted. history may be NULL. Returns result->status. */
hf_status hf_equilibrium_find_by_paper(const hf_model *model, const hf_form_settings *settings, hf_stop_rule stop,
                                       hf_workspace *workspace, hf_history *history, hf_form_result *result);

/* Decides whether a net has a shape after an iteration under the rule residual has not converged. The workspace holds
 * the laws, force densities and shape of that iteration. If the path finds that the net has no shape, status and
 * culprit become those of the path. Returns result->status. */
hf_status hf_equilibrium_judge_open(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                                    hf_form_result *result);
