/* band_kernel - band Cholesky, substitution and products of rows, compiled once for each instruction set. band.c
 * chooses one at run time.
 *
 * All instruction sets give the same bits. Each product is fused with the sum that it is added to (fma). Rows are
 * processed in strips of eight, whatever the width of a vector is. In the factorisation each entry has one accumulator,
 * to which the columns contribute in rising order. On a processor without fused multiply-add the bits are the same, but
 * the kernels are slow (base/lane.h). */
#pragma once

#include "base/lane.h"

/* The kernels of one instruction set. band.h describes the functions. `factor` processes columns `first` to end-1 and
 * expects that all earlier columns are finished. `first` must be a multiple of 4. */
typedef struct {
    int (*factor)(int n, int half_bandwidth, double *band, int first, int end);
    void (*back_solve)(int n, int half_bandwidth, int n_rhs, const double *factor, double *b, int ldb);
    void (*gram)(int first, int end, int n_column, const double *a, int lda, double *gram, int ldg);
} hf_band_kernels;

extern const hf_band_kernels HF_LANE_EACH(hf_band_kernels);
