/* quadratic_kernel - the inner loops of quadratic programmes, compiled once for each instruction set. quadratic.c
 * chooses one at run time. All give the same bits as scalar loops: products are not fused with sums, and each entry is
 * accumulated in the same order. */
#pragma once

#include "base/lane.h"

/* The kernels of one instruction set.
 *
 * invert: strip [n][HF_LANES] contains columns `first` and on of the unit matrix; the same columns of L^-1 replace
 * them. triangle [n][n] is L as a band whose columns begin with the diagonal. Rows before `first` are neither read nor
 * written.
 *
 * turn: works on columns of J [][ld], where ld is a multiple of HF_LANES. For i from last down to first, columns i and
 * i + 1 (u and v) become cosine[i] u + sine[i] v and cosine[i] v - sine[i] u.
 *
 * combine: computes sum [ld] = weight[first] column `first` + ... + weight[end - 1] column end - 1 of J, added
 * in this order. */
typedef struct {
    void (*invert)(int n, int first, const double *triangle, double *strip);
    void (*turn)(int ld, int first, int last, const double *cosine, const double *sine, double *J);
    void (*combine)(int ld, int first, int end, const double *weight, const double *J, double *sum);
} hf_quadratic_kernels;

extern const hf_quadratic_kernels HF_LANE_EACH(hf_quadratic_kernels);
