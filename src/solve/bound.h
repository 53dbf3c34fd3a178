/* bound - how far the true equilibrium can be from the shape that was found: a proof, not an estimate (METHOD section
 * 3).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_BOUND_H
#define HIFDM_BOUND_H

#include <hifdm/formfind.h>

/* Set position_bound_m, psi_bound_m and bound_reason of the result whose shape is in the workspace. Its status is HF_OK
 * or HF_NOT_CONVERGED. The workspace holds a factor of the matrix at the shape (hf_newton_certify; without a Newton
 * matrix that of D in `band`), which is overwritten unless the reason is HF_BOUND_STRUTS or HF_BOUND_LOOSE. has_factor
 * is false when there is none. least_N_per_m: a proven lower bound of its least eigenvalue, or 0. */
void hf_bound_prove(const hf_model *model, bool has_factor, double least_N_per_m, hf_workspace *workspace,
                    hf_form_result *result);

#endif
