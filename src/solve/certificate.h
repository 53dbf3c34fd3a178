/* certificate - error estimates for a shape that has been found: backward error, condition, position error (METHOD
 * section 3).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_CERTIFICATE_H
#define HIFDM_CERTIFICATE_H

#include <hifdm/formfind.h>

/* Set position_error_m, condition and backward_error of the result whose shape is in the workspace; NaN without a
 * shape. Models with a Newton matrix: hf_newton_certify. Others: the condition is that of D, and the position error is
 * the largest node of D^-1 times the remaining forces. The position error is NaN when a law iterates (nets with
 * struts), because D is not the derivative of the forces then. */
void hf_certify(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

#endif
