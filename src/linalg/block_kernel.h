/* block_kernel - the loops of dissection, compiled once for each instruction set. All give the same bits: each
 * entry is the result of one chain of fused products. */
#pragma once

#include "base/lane.h"

#include <stddef.h>

typedef struct {
    /* Subtracts W A' from six columns of `to` [6][ld_to]: n_term columns of w [n_term][ld] times the numbers a
     * [n_term][ld_a], of which the first six count. n is the number of rows, a multiple of HF_LANES. */
    void (*subtract)(int n, int n_term, const double *w, size_t ld, const double *a, size_t ld_a, double *to,
                     size_t ld_to);
    /* Subtracts the columns w [6][ld] times x [6] from `to` [n]. */
    void (*spread)(int n, const double *w, size_t ld, const double *x, double *to);
    /* Sets dot [6] to the products of the columns w [6][ld] with x [n]. */
    void (*dot)(int n, const double *w, size_t ld, const double *x, double *dot);
} hf_block_kernels;

extern const hf_block_kernels HF_LANE_EACH(hf_block_kernels);
