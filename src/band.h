/* band - solve D X = B for a symmetric band matrix and three right-hand sides, by LAPACK. */
#ifndef HIFDM_BAND_H
#define HIFDM_BAND_H

#include <hifdm/status.h>

/* Band Cholesky (dpbtrf, dpbtrs). band: lower band [n][half_bandwidth+1], replaced by its factor; b: [3][ldb], rows
 * 0..n-1 of each replaced by the solution. HF_SINGULAR when not positive definite (b is untouched then); *bad_row is
 * the row where it broke, -1 otherwise. */
hf_status hf_band_solve(int n, int half_bandwidth, double *band, double *b, int ldb, int *bad_row);

/* The same for an indefinite matrix (force densities below zero): LU with pivoting (dgbtrf, dgbtrs).
 * band is only read; general: [n][3*half_bandwidth+1] and pivot: [n] are scratch. */
hf_status hf_band_solve_indefinite(int n, int half_bandwidth, const double *band, double *general, int *pivot,
                                   double *b, int ldb, int *bad_row);

/* One system per thread: keep a threaded BLAS from starting threads of its own. Call once, before any solve. */
void hf_band_single_threaded(void);

/* Name of the LAPACK in use, for the provenance, e.g. "OpenBLAS 0.3.21 ... Haswell"; "reference or unknown". */
const char *hf_band_library(void);

#endif
