/* fit_descend - descends from a point with zero gradient to a minimum of a best fit, by Newton's method with all second
 * derivatives (METHOD section 9). */
#ifndef HIFDM_FIT_DESCEND_H
#define HIFDM_FIT_DESCEND_H

#include "surface/fit_point.h"

/* Returns true if the sum of squares has no direction of negative curvature. */
bool hf_fit_is_least(const hf_fit_frame *frame);

/* Descends to the minimum below `at`, the parameters of the frame. Adds the number of steps to *iterations. Returns
 * false if a shift across exceeds across_most, in units of the size, or if the steps do not converge. */
bool hf_fit_descend(const hf_fit_frame *frame, hf_fit_parameters *at, double across_most, int *iterations);

#endif
