/* certificate - error estimates and certified bounds for a shape that a solver has found: backward error, condition,
 * position error, and certified bounds of the distance between the
 * shape and the true equilibrium (METHOD section 3).
 * Stability: internal; may change in any version. */
#pragma once

#include <hifdm/formfind.h>

/* Sets position_error_m, condition and backward_error of the result whose shape is in the workspace, and its bounds and
 * bound_reason. The figures are NaN if the status is neither HF_OK nor HF_NOT_CONVERGED. A model with
 * a Newton matrix uses hf_newton_certify. For other models the condition is that of D, and the position error is the
 * maximum node displacement in D^-1 times the remaining forces. That position error is NaN if a law iterates (nets with
 * struts) or the net is on a truss: D is then not the derivative of the forces. */
void hf_certify(const hf_model *model, hf_workspace *workspace, hf_form_result *result);
