/* interior - the equilibrium of a tension net by a primal-dual interior path, for all laws, from any shape (METHOD
 * section 5).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_INTERIOR_H
#define HIFDM_INTERIOR_H

#include <hifdm/formfind.h>

/* Find the shape of least energy from the theoretical positions (supports where hf_form_place_supports puts them), in
 * at most max_steps factorisations, by whose number *n_step is increased. Needs a workspace of a model with has_newton.
 * Does not allocate. Returns
 *   HF_OK              forces and lengths are within the tolerances of the settings; position_m, tension_N and
 *                      q_N_per_m hold the shape, slack cables without force
 *   HF_COLLAPSED       at the least energy cable *culprit is shorter than collapse_ratio
 *   HF_SINGULAR        the energy has no least value: row *culprit moves away without end
 *   HF_STRAIGHT_CHAIN  a straight chain is under lateral load (hf_form_chain_is_loaded)
 *   HF_INTERRUPTED     the workspace's stop was set
 *   HF_NOT_CONVERGED   none of these; the workspace holds the last shape of the path, or one nearer to the answer. */
hf_status hf_interior_run(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                          int max_steps, int *n_step, int *culprit);

/* The same from the shape spring_place_m, to which springs of spring_N_per_m pull the rows (INFINITY: the row does not
 * move), with the cables' laws and targets of the workspace. */
hf_status hf_interior_run_held(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                               int max_steps, int *n_step, int *culprit);

#endif
