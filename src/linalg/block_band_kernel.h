/* block_band_kernel - the loops of block_band, compiled once for each instruction set. All give the same bits: each
 * entry is the result of one chain of fused products. */
#pragma once

#include "base/lane.h"

#include <stddef.h>

typedef struct {
    /* Subtracts W a from each of n_column columns of `to` [][ld_to]: rows 0 to n-1 of w [6][ld] times 6 numbers a. The
     * numbers of column c are at a[k * ld_a + c]. n_column is 1 or 2. */
    void (*subtract)(int n_column, int n, const double *w, size_t ld, const double *a, size_t ld_a, double *to,
                     size_t ld_to);
    /* Sets dot [6] to the products of the columns w [6][ld] with x [n]. */
    void (*dot)(int n, const double *w, size_t ld, const double *x, double *dot);
} hf_block_band_kernels;

extern const hf_block_band_kernels HF_LANE_EACH(hf_block_band_kernels);
