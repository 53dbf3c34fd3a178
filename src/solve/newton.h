/* newton - Newton's method on the convex energy Pi(x) = sum phi_e(l_e) - P.x of a tension net (METHOD section 5): steps
 * from a shape that is near the answer, and the error estimate of every other method.
 * Stability: internal; may change in any version.
 *
 * Unknowns: the coordinates of the free nodes, and the tensions of the cables whose law has a multiplier (length,
 * elastic). newton_matrix.h has the matrix. */
#ifndef HIFDM_NEWTON_H
#define HIFDM_NEWTON_H

#include <hifdm/formfind.h>

/* Newton steps from the workspace's position_m and tension_N while they help, at most max_steps; *n_step counts them.
 * Needs a workspace of a model with has_newton. When the steps helped: true, and q_N_per_m belongs to the new shape;
 * else q_N_per_m is as it was. */
bool hf_newton_run(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace, int max_steps,
                   int *n_step);

/* Fill position_error_m (largest move of a node in the next step) and condition of a result whose shape the workspace
 * holds; untouched when there is no step. */
void hf_newton_certify(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

/* A tension below this part of the reference tension is what rounding leaves in a slack elastic cable: a node that only
 * such cables hold is loose, and has no position. */
#define HF_NEWTON_NOTHING 1e-12

#endif
