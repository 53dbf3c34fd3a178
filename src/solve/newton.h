/* newton - Newton's method on the convex energy Pi(x) = sum phi_e(l_e) - P.x of a tension net (METHOD section 5): steps
 * from a shape near the answer, and the error estimate for shapes that any method has found.
 * Stability: internal; may change in any version.
 *
 * Unknowns: the coordinates of the free nodes, and the tensions of the cables whose law has a multiplier (length,
 * elastic). newton_matrix.h has the matrix. */
#ifndef HIFDM_NEWTON_H
#define HIFDM_NEWTON_H

#include <hifdm/formfind.h>

/* Take Newton steps from the workspace's position_m and tension_N while they reduce the imbalance, at most max_steps.
 * *n_step is increased by their number. Needs a workspace of a model with has_newton. Returns true when the imbalance
 * is smaller at the end than at the start; q_N_per_m then belongs to the new shape. Else q_N_per_m is unchanged. */
bool hf_newton_run(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace, int max_steps,
                   int *n_step);

/* Set position_error_m (largest move of a node in the next Newton step, of net and truss together) and condition of
 * the result whose shape is in the workspace. Leaves both unchanged when there is no such step. Returns a lower
 * bound of the least eigenvalue of the matrix at that shape, N/m, or 0 (hf_newton_matrix_factor_below). */
double hf_newton_certify(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

/* A tension below this fraction of the reference tension, in an elastic cable, is rounding: the cable is slack, and its
 * force density is set to 0. A node held by such cables alone has no position. The tests of solve pass from 1e-14 to
 * 1e-8; the larger, the more nodes of nets of stiff cables count as loose. */
#define HF_NEWTON_NOTHING 1e-12

#endif
