/* interior - finds the equilibrium of a tension net by a primal-dual interior path, for all laws and from any shape
 * (METHOD section 5).
 * Stability: internal; may change in any version. */
#pragma once

#include <hifdm/formfind.h>
#include <stdbool.h>

/* Finds the shape of minimum energy from the target positions, with supports where hf_form_set_supports puts them. It
 * takes at most max_steps factorisations and increases *n_step by their number. The workspace must be of a model with
 * has_newton. Does not allocate.
 *
 * is_held: starts from the shape spring_anchor_m instead, with the laws and targets of the workspace. Springs of
 * spring_N_per_m [n_free] pull the rows to that shape; INFINITY fixes a row. It then records no history and does not
 * look for straight chains.
 *
 * Returns
 *
 *   HF_OK              forces and lengths are within the tolerances of the settings; position_m, tension_N and
 *                      q_N_per_m hold the shape, with slack cables without force
 *   HF_COLLAPSED       at the minimum energy, cable *culprit is shorter than collapse_ratio allows
 *   HF_SINGULAR        the energy has no minimum: row *culprit moves away without bound
 *   HF_STRAIGHT_CHAIN  a straight chain is under lateral load (hf_form_chain_is_loaded)
 *   HF_INTERRUPTED     the workspace's stop was set
 *   HF_NOT_CONVERGED   none of these; the workspace holds the last shape of the path, or one nearer to the answer. */
hf_status hf_interior_run(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                          bool is_held, int max_steps, int *n_step, int *culprit);
