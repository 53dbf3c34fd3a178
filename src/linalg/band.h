/* band - symmetric band matrices in LAPACK's layout: solve D X = B, condition numbers.
 *
 * Positive definite matrices are factored by kernels of our own, which give the same bits on every machine; indefinite
 * ones by LAPACK's LU with pivoting. Conditions are LAPACK's estimates. Before a function that calls LAPACK is used,
 * hf_lapack_load must have returned HF_OK; hf_workspace_create and hf_frame_build call it. Measured with 512-bit
 * vectors: factor and three solutions of n = 437, half-bandwidth 21 take two fifths of the reference LAPACK's time,
 * with 65 a tenth. */
#ifndef HIFDM_BAND_H
#define HIFDM_BAND_H

#include <hifdm/status.h>
#include <signal.h>
#include <stdbool.h>

/* Band Cholesky. band: lower band [n][half_bandwidth+1], replaced by its factor; b: [3][ldb], rows
 * 0..n-1 of each replaced by the solution. HF_SINGULAR when the matrix is not positive definite: b is then untouched,
 * and *bad_row is the row at which the factorisation failed; otherwise *bad_row is -1. */
hf_status hf_band_solve(int n, int half_bandwidth, double *band, double *b, int ldb, int *bad_row);

/* hf_band_solve for an indefinite matrix (force densities below zero): LU with pivoting (dgbtrf, dgbtrs).
 * band is only read; general: [n][3*half_bandwidth+1] and pivot: [n] are scratch. */
hf_status hf_band_solve_indefinite(int n, int half_bandwidth, const double *band, double *general, int *pivot,
                                   double *b, int ldb, int *bad_row);

/* The two parts of hf_band_solve: factor once, then solve for any number of right-hand sides. hf_band_factor returns 0,
 * or 1 + the row at which the factorisation failed. b: [n_rhs][ldb], rows 0..n-1 of each replaced by the solution. */
int hf_band_factor(int n, int half_bandwidth, double *band);
void hf_band_back_solve(int n, int half_bandwidth, int n_rhs, const double *factor, double *b, int ldb);

/* hf_band_factor of a large matrix: HF_OK, HF_SINGULAR, or HF_INTERRUPTED soon after *stop is set (NULL: never); the
 * same bits. */
hf_status hf_band_factor_until(const volatile sig_atomic_t *stop, int n, int half_bandwidth, double *band);

/* The two parts for a matrix [n][3*half_bandwidth+1] in LAPACK's general band: entry (i,j) at 2*half_bandwidth + i - j
 * of column j; the first half_bandwidth places of each are room for pivoting. pivot: [n]. */
int hf_band_factor_general(int n, int half_bandwidth, double *general, int *pivot);
void hf_band_back_solve_general(int n, int half_bandwidth, int n_rhs, const double *general, const int *pivot,
                                double *b, int ldb);

/* hf_band_solve, hf_band_factor and hf_band_back_solve by LAPACK (dpbtrf, dpbtrs). The factors have the same layout. */
hf_status hf_band_solve_lapack(int n, int half_bandwidth, double *band, double *b, int ldb, int *bad_row);
int hf_band_factor_lapack(int n, int half_bandwidth, double *band);
void hf_band_back_solve_lapack(int n, int half_bandwidth, int n_rhs, const double *factor, double *b, int ldb);

/* 1-norm of the matrix (before factoring; work: [n]) and LAPACK's estimate of its condition number in that norm
 * (dlacn2; work: [3n], integer_work: [n]); INFINITY when it is singular to working precision. */
double hf_band_norm(int n, int half_bandwidth, const double *band, double *work);
double hf_band_condition(int n, int half_bandwidth, const double *factor, double norm, double *work, int *integer_work);

/* hf_band_condition from the LU that hf_band_solve_indefinite leaves (dgbcon). */
double hf_band_condition_indefinite(int n, int half_bandwidth, const double *general, const int *pivot, double norm,
                                    double *work, int *integer_work);

/* Compute rows `first` to end-1 of the lower triangle of A A' for the dense A [n][n_column] of row length lda: gram
 * [n][ldg] (of the upper triangle some places of these rows are written, too). `first` is a multiple of 4. */
void hf_band_gram(int first, int end, int n_column, const double *a, int lda, double *gram, int ldg);

#endif
