/* newton - Newton's method on the convex energy Pi(x) = sum phi_e(l_e) - P.x of a tension net (METHOD section 5):
 * the accuracy reference, the error estimate of every other method, and the matrix that a population shares.
 *
 * Unknowns: the 3 n_free coordinates, dof 3*row + component, and the tensions of the cables under law length or
 * elastic. Per cable, with unit vector u: force T u, stiffness (T/l)(I - uu') + k uu' with k = phi''(l). A cable under
 * law length has k = STIFFENING T/L*: its tension step dT = k (dl + l - L*) is eliminated, so that the matrix stays
 * symmetric positive definite. Eq. 8 is the same step with a stiffening of 1. An elastic cable is treated alike, with
 * k = EA/l0 and L* = l0 (1 + T/EA), so that no force contains EA times an error of length; a slack one has k = 0.
 * Matrix: lower band, column-major, half-bandwidth 3b + 2. */
#ifndef HIFDM_NEWTON_H
#define HIFDM_NEWTON_H

#include <hifdm/formfind.h>

/* Start from the workspace's q_N_per_m under its law and target (hf_form_prepare, hf_evaluate_prepare). Fixed-point
 * iterations of hf_form_find alternate with Newton steps; a shape that Newton has reached is measured as it is. Stops
 * by residual; result->iterations counts both kinds. history (may be NULL) holds the fixed-point iterations. Needs a
 * workspace of a model with has_newton. Returns result->status. */
hf_status hf_newton_find(const hf_model *model, const hf_form_settings *settings, hf_workspace *workspace,
                         hf_history *history, hf_form_result *result);

/* Factor the Newton matrix at the workspace's shape and tensions into newton_band. *condition (may be NULL): estimate
 * of its 1-norm condition number, INFINITY when a Levenberg shift was needed. HF_SINGULAR when no shift helps. */
hf_status hf_newton_factor(const hf_model *model, hf_workspace *workspace, double *condition);

/* Stiffness [3][3] of cable e between its ends at the workspace's shape and tensions: its part of the Newton matrix,
 * which the coupling with a truss needs for the cables that end at attachments. */
void hf_newton_block(const hf_model *model, const hf_workspace *workspace, int i_cable, double block[3][3]);

/* A tension below this part of the reference tension is what rounding leaves in a slack elastic cable: a node that only
 * such cables hold is loose, and has no position. */
#define HF_NEWTON_NOTHING 1e-12

/* For a net with elastic cables: descend on its energy from the workspace's position_m to near the minimum, and set
 * tension_N and q_N_per_m by the laws. Returns the number of steps, at most max_steps. */
int hf_newton_descend(const hf_model *model, hf_workspace *workspace, int max_steps);

/* Fill position_error_m (largest move of a node in the next step) and condition of a result whose shape the workspace
 * holds; untouched when there is no step. */
void hf_newton_certify(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

#endif
