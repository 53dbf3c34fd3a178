/* dense - dense square matrices, stored by columns: product, and LU with partial pivoting. The order of operations is
 * fixed, so the bits are the same on every machine. The functions are meant for a few hundred rows. */
#pragma once

/* Computes c = a b, all [n][n] by columns. c must not be a or b. */
void hf_dense_multiply(int n, const double *a, const double *b, double *c);

/* Factors a [n][n] = P L U in place. pivot [n]: the row with which row k was exchanged in step k. Returns 0, or 1 + the
 * column without a pivot. */
int hf_dense_factor(int n, double *a, int *pivot);

/* Solves for the right-hand sides b [n_rhs][n]; the solutions replace them. */
void hf_dense_solve(int n, const double *factor, const int *pivot, int n_rhs, double *b);
