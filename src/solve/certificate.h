/* certificate - what a found shape says about its own error: backward error, condition, position error. */
#ifndef HIFDM_CERTIFICATE_H
#define HIFDM_CERTIFICATE_H

#include <hifdm/formfind.h>

/* Fill position_error_m, condition and backward_error of a result whose shape the workspace holds; NaN where there is
 * no shape. With a Newton matrix: hf_newton_certify. Without: condition of D; the position error is the move that D
 * makes of the nodal forces left, NaN when a law iterates (struts), for which D says nothing. */
void hf_certify(const hf_model *model, hf_workspace *workspace, hf_form_result *result);

#endif
