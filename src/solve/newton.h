/* newton - Newton's method on the convex energy Pi(x) = sum phi_e(l_e) - P.x of a tension net (METHOD section 5). It
 * takes steps from a shape near the answer, and estimates the errors of shapes that any method has found.
 * Stability: internal; may change in any version.
 *
 * The unknowns are the coordinates of the free nodes, and the tensions of the cables whose law has a multiplier
 * (length, elastic). newton_matrix.h has the matrix. */
#pragma once

#include <hifdm/formfind.h>

/* Takes at most max_steps Newton steps from the workspace's position_m and tension_N while they reduce the imbalance.
 * *n_step is increased by their number. The workspace must be of a model with has_newton. Returns true if the imbalance
 * is smaller at the end than at the start; q_N_per_m then belongs to the new shape. Otherwise q_N_per_m is unchanged,
 * but position_m and tension_N may have changed. */
bool hf_newton_run(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace, int max_steps,
                   int *n_step);

/* Copies positions [3][n_node], and tensions or force densities [n_cable]. */
void hf_newton_copy(const hf_model *model, const double *from_m, const double *from_cable, double *to_m,
                    double *to_cable);

/* Sets q_N_per_m and length_m for position_m and the multipliers in tension_N. Cables whose law has one of the flags
 * may_be_slack have no force below HF_NEWTON_NOTHING. */
void hf_newton_set_force_densities(const hf_model *model, unsigned may_be_slack, hf_workspace *workspace);

/* Sets condition and position_error_m of the result whose shape is in the workspace. The position error is the maximum
 * displacement of a node in the next Newton step of net and truss together. If there is no such step, condition is NaN
 * and position_error_m is unchanged; it is also unchanged with loose nodes. Sets n_drifting and culprit if the
 * equilibrium is not unique. Returns a lower bound of the minimum eigenvalue of the matrix at that shape, N/m, or 0
 * (hf_newton_matrix_factor_below). */
double hf_newton_certify(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

/* A tension below this fraction of the reference tension counts as rounding in an elastic cable. The cable is then
 * slack, and its force density is 0. A node held by such cables alone has no determined position. The tests of solve
 * pass from 1e-14 to 1e-8; a larger value makes more nodes of nets of stiff cables count as loose. */
#define HF_NEWTON_NOTHING 1e-12
