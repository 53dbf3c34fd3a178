/* band - symmetric band matrices in LAPACK's layout: solution of D X = B, and condition numbers.
 *
 * Our own kernels factor positive definite matrices; they give the same bits on every machine. LAPACK's LU with
 * pivoting factors indefinite matrices. LAPACK estimates the condition numbers. hf_lapack_load must return HF_OK before
 * a function that uses LAPACK is called; hf_workspace_create and hf_frame_build call it.
 *
 * Measured with 512-bit vectors and n = 437: factor and three solutions take 40 % of the time of the reference LAPACK
 * at half-bandwidth 21, and 10 % at half-bandwidth 65. */
#pragma once

#include <hifdm/status.h>
#include <signal.h>
#include <stdbool.h>

/* Solves D X = B by band Cholesky, with our kernels or with LAPACK. band [n][half_bandwidth+1] is the lower band; its
 * factor replaces it. b [3][ldb]: the solutions replace rows 0 to n-1 of each column. Returns HF_OK, and *bad_row is
 * -1. Returns HF_SINGULAR if the matrix is not positive definite. b is then unchanged, and *bad_row is the row at which
 * the factorisation failed. */
hf_status hf_band_solve(bool by_lapack, int n, int half_bandwidth, double *band, double *b, int ldb, int *bad_row);

/* Solves D X = B like hf_band_solve, but for an indefinite matrix (negative force densities), by LU with pivoting
 * (dgbtrf, dgbtrs). `band` is only read. general [n][3*half_bandwidth+1] and pivot [n] are scratch; they contain
 * the LU afterwards. */
hf_status hf_band_solve_indefinite(int n, int half_bandwidth, const double *band, double *general, int *pivot,
                                   double *b, int ldb, int *bad_row);

/* The two steps of hf_band_solve: factor once, then solve for any number of right-hand sides. hf_band_factor
 * returns 0, or 1 + the row at which the factorisation failed. b [n_rhs][ldb]: the solutions replace rows 0 to n-1
 * of each column. */
int hf_band_factor(int n, int half_bandwidth, double *band);
void hf_band_back_solve(int n, int half_bandwidth, int n_rhs, const double *factor, double *b, int ldb);

/* Factors like hf_band_factor, with the same bits, but can be interrupted. Returns HF_OK or HF_SINGULAR, or
 * HF_INTERRUPTED soon after *stop is set. `stop` may be NULL. */
hf_status hf_band_factor_until(const volatile sig_atomic_t *stop, int n, int half_bandwidth, double *band);

/* Factor a general band matrix [n][3*half_bandwidth+1] in LAPACK's layout, and solve with the factor. Entry (i,j) is at
 * index 2*half_bandwidth + i - j of column j. The first half_bandwidth entries of each column are room for pivoting.
 * pivot [n]. hf_band_factor_general returns 0, or 1 + the row at which the factorisation failed. */
int hf_band_factor_general(int n, int half_bandwidth, double *general, int *pivot);
void hf_band_back_solve_general(int n, int half_bandwidth, int n_rhs, const double *general, const int *pivot,
                                double *b, int ldb);

/* hf_band_factor and hf_band_back_solve with LAPACK (dpbtrf, dpbtrs) instead of our kernels. The factors
 * have the same layout. */
int hf_band_factor_lapack(int n, int half_bandwidth, double *band);
void hf_band_back_solve_lapack(int n, int half_bandwidth, int n_rhs, const double *factor, double *b, int ldb);

/* hf_band_norm returns the 1-norm of the matrix before it is factored; work [n]. hf_band_condition returns LAPACK's
 * estimate of the condition number in this norm (dlacn2); work [3n], integer_work [n]. It returns INFINITY if the
 * matrix is singular to working precision. */
double hf_band_norm(int n, int half_bandwidth, const double *band, double *work);
double hf_band_condition(int n, int half_bandwidth, const double *factor, double norm, double *work, int *integer_work);

/* Estimates the condition number from the LU that hf_band_solve_indefinite leaves in `general` and `pivot` (dgbcon).
 * Returns INFINITY if the estimated reciprocal is not positive. work [3n], integer_work [n]. */
double hf_band_condition_indefinite(int n, int half_bandwidth, const double *general, const int *pivot, double norm,
                                    double *work, int *integer_work);

/* Computes rows `first` to end-1 of the lower triangle of A A' for a dense A [n][n_column] with row length lda. Writes
 * them to gram [n][ldg], with some entries of the upper triangle of these rows. `first` must be a multiple of 4. */
void hf_band_gram(int first, int end, int n_column, const double *a, int lda, double *gram, int ldg);
