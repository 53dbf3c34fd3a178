/* pull_kernel - what elastic cables pull with, and what a truss makes of it, in eight nets side by side; compiled once
 * for each instruction set. */
#ifndef HIFDM_PULL_KERNEL_H
#define HIFDM_PULL_KERNEL_H

#include "base/lane.h"
#include <hifdm/model.h>

/* Sets the tension k (l - l0) of each taut cable, 0 of each slack one, and q, which is it over the length: cut_m,
 * stiffness_N_per_m (k = EA/l0), tension_N and q_N_per_m [n_cable][HF_LANES] at the positions x_m [3][n_node]
 * [HF_LANES] by row. All are aligned to HF_ALIGNMENT. */
typedef void hf_pull_find(const hf_model *model, const double *x_m, const double *cut_m,
                          const double *stiffness_N_per_m, double *tension_N, double *q_N_per_m);

/* out = A in for a matrix of n columns and as many rows, filled up to a multiple of HF_PULL_ROWS; in [n][HF_LANES], out
 * [n filled up][HF_LANES], not the same. packed: [n filled up / HF_PULL_ROWS][n][HF_PULL_ROWS], rows side by side. */
#define HF_PULL_ROWS 8
typedef void hf_pull_multiply(int n, const double *packed, const double *in, double *out);

/* The Makefile compiles pull_kernel.c with -DHF_ISA=avx512 and so on; the names end in it. */
hf_pull_find hf_pull_find_portable, hf_pull_find_avx2, hf_pull_find_avx512;
hf_pull_multiply hf_pull_multiply_portable, hf_pull_multiply_avx2, hf_pull_multiply_avx512;

#endif
