/* bound - certified bounds of the distance between the shape that was found and the true equilibrium (METHOD section
 * 3).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_BOUND_H
#define HIFDM_BOUND_H

#include <hifdm/formfind.h>

/* Computes position_bound_m, psi_bound_m and bound_reason of the result whose shape is in the workspace. Its status
 * must be HF_OK or HF_NOT_CONVERGED. If has_factor is true, the workspace holds a factor of the matrix at this shape:
 * that of hf_newton_certify, or that of D in `band` if there is no Newton matrix. The factor is overwritten unless the
 * reason is HF_BOUND_STRUTS, HF_BOUND_LOOSE or HF_BOUND_NO_MATRIX. least_N_per_m: a certified lower bound of its
 * minimum eigenvalue, or 0. */
void hf_bound_prove(const hf_model *model, bool has_factor, double least_N_per_m, hf_workspace *workspace,
                    hf_form_result *result);

#endif
