/* pull_kernel - kernels for eight elastic nets side by side in SIMD lanes, compiled once for each instruction set. They
 * compute the tensions of the cables, and products with a matrix of the truss. */
#ifndef HIFDM_PULL_KERNEL_H
#define HIFDM_PULL_KERNEL_H

#include "base/lane.h"
#include <hifdm/model.h>

/* Computes the tension T = k (l - l0) of each taut cable, 0 of each slack one, and q = T/l. cut_m (l0),
 * stiffness_N_per_m (k = EA/l0), tension_N and q_N_per_m are [n_cable][HF_LANES]. The positions x_m are
 * [3][n_node][HF_LANES] by row. All arrays are aligned to HF_ALIGNMENT. */
typedef void hf_pull_find(const hf_model *model, const double *x_m, const double *cut_m,
                          const double *stiffness_N_per_m, double *tension_N, double *q_N_per_m);

/* Computes out = A in for a square matrix A of n columns. The rows are padded with zeros to a multiple of HF_PULL_ROWS,
 * n_pad. `in` is [n][HF_LANES], `out` is [n_pad][HF_LANES]; they must not overlap. packed is [n_pad /
 * HF_PULL_ROWS][n][HF_PULL_ROWS], with the rows of a block side by side. */
#define HF_PULL_ROWS 8
typedef void hf_pull_multiply(int n, const double *packed, const double *in, double *out);

/* The Makefile compiles pull_kernel.c with -DHF_ISA=avx512 and so on. The names end in the instruction set. */
hf_pull_find hf_pull_find_portable, hf_pull_find_avx2, hf_pull_find_avx512;
hf_pull_multiply hf_pull_multiply_portable, hf_pull_multiply_avx2, hf_pull_multiply_avx512;

#endif
