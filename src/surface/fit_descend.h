/* fit_descend - from where a best fit has no slope down to where it is least: Newton's method with the whole second
 * derivatives (METHOD section 9). */
#ifndef HIFDM_FIT_DESCEND_H
#define HIFDM_FIT_DESCEND_H

#include "surface/fit_point.h"

/* Does the sum of squares curve down nowhere? */
bool hf_fit_is_least(const hf_fit_frame *frame);

/* The minimum below `at`, the parameters of the frame; adds to `iterations`. False where a shift across passes
 * across_most, in units of the size, or where steps do not end. */
bool hf_fit_descend(const hf_fit_frame *frame, hf_fit_parameters *at, double across_most, int *iterations);

#endif
