/* Calls the fastest kernels of this machine for positive definite matrices, and LAPACK for indefinite ones:
 *
 *     positive definite   band [n][k+1]  -> hf_band_factor -> L  -> hf_band_back_solve -> x
 *     indefinite          general band   -> dgbtrf         -> LU -> panels of 8, dgbtrs for the rest -> x
 *
 * Contents: kernels - LAPACK */
#include "linalg/band.h"

#include "linalg/band_kernel.h"
#include "linalg/dot.h"
#include "linalg/lapack.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define AT_A_TIME 64 /* columns between two checks of the flag: a few tenths of a second at a half-bandwidth of 5000 */

/* ---- kernels ---- */

static const hf_band_kernels *const kernels_of_isa[] = {HF_LANE_EACH(&hf_band_kernels)};

int hf_band_factor(int n, int half_bandwidth, double *band)
{
    return kernels_of_isa[hf_lane_best_isa()]->factor(n, half_bandwidth, band, 0, n);
}

hf_status hf_band_factor_until(const volatile sig_atomic_t *stop, int n, int half_bandwidth, double *band)
{
    const hf_band_kernels *here = kernels_of_isa[hf_lane_best_isa()];
    for (int first = 0; first < n; first += AT_A_TIME) {
        if (stop && *stop) return HF_INTERRUPTED;
        int end = n - first > AT_A_TIME ? first + AT_A_TIME : n;
        if (here->factor(n, half_bandwidth, band, first, end) != 0) return HF_SINGULAR;
    }
    return HF_OK;
}

void hf_band_back_solve(int n, int half_bandwidth, int n_rhs, const double *factor, double *b, int ldb)
{
    kernels_of_isa[hf_lane_best_isa()]->back_solve(n, half_bandwidth, n_rhs, factor, b, ldb);
}

hf_status hf_band_solve(bool by_lapack, int n, int half_bandwidth, double *band, double *b, int ldb, int *bad_row)
{
    *bad_row = (by_lapack ? hf_band_factor_lapack : hf_band_factor)(n, half_bandwidth, band) - 1;
    if (*bad_row >= 0) return HF_SINGULAR;
    (by_lapack ? hf_band_back_solve_lapack : hf_band_back_solve)(n, half_bandwidth, 3, band, b, ldb);
    return HF_OK;
}

void hf_band_gram(int first, int end, int n_column, const double *a, int lda, double *gram, int ldg)
{
    kernels_of_isa[hf_lane_best_isa()]->gram(first, end, n_column, a, lda, gram, ldg);
}

/* ---- LAPACK ---- */

/* Calls one routine of LAPACK. */
#define CALL(routine, ...)                                                                                             \
    do {                                                                                                               \
        int call_n_thread_ = hf_lapack_begin();                                                                        \
        hf_lapack()->routine(__VA_ARGS__);                                                                             \
        hf_lapack_end(call_n_thread_);                                                                                 \
    } while (0)

int hf_band_factor_lapack(int n, int half_bandwidth, double *band)
{
    int ldab = half_bandwidth + 1, info = 0;
    CALL(dpbtrf, "L", &n, &half_bandwidth, band, &ldab, &info);
    return info > 0 ? info : info < 0;
}

void hf_band_back_solve_lapack(int n, int half_bandwidth, int n_rhs, const double *factor, double *b, int ldb)
{
    int ldab = half_bandwidth + 1, info = 0;
    CALL(dpbtrs, "L", &n, &half_bandwidth, &n_rhs, factor, &ldab, b, &ldb, &info);
}

double hf_band_norm(int n, int half_bandwidth, const double *band, double *work)
{
    int ldab = half_bandwidth + 1;
    return hf_lapack()->dlansb("1", "L", &n, &half_bandwidth, band, &ldab, work);
}

double hf_band_condition(int n, int half_bandwidth, const double *factor, double norm, double *work, int *integer_work)
{
    double inverse_norm = 0, *x = work + n;
    int what = 0, kept[3];
    do { /* dlacn2 asks for products with the inverse or its transpose until its estimate is complete */
        CALL(dlacn2, &n, work, x, integer_work, &inverse_norm, &what, kept);
        if (what != 0) hf_band_back_solve(n, half_bandwidth, 1, factor, x, n);
    } while (what != 0);
    double condition = norm * inverse_norm;
    return isfinite(condition) && condition < 1 / DBL_EPSILON ? condition : (double)INFINITY;
}

int hf_band_factor_general(int n, int half_bandwidth, double *general, int *pivot)
{
    int k = half_bandwidth, ldab = 3 * k + 1, info = 0;
    CALL(dgbtrf, &n, &n, &k, &k, general, &ldab, pivot, &info);
    return info > 0 ? info : info < 0;
}

#define GENERAL_PANEL 8 /* right-hand sides that share one pass over the factor */

/* Solves like dgbtrs, with one pass over the factor for all right-hand sides b [n_rhs][ldb]. LAPACK reads the upper
 * triangle once for each right-hand side. */
static void back_solve_panel(int n, int k, int n_rhs, const double *general, const int *pivot, double *b, int ldb)
{
    ptrdiff_t ldab = 3 * k + 1;
    for (int j = 0; j < n; j++)
        for (int c = 0; c < n_rhs; c++) {
            double *x = b + (ptrdiff_t)c * ldb, top = x[pivot[j] - 1];
            x[pivot[j] - 1] = x[j];
            x[j] = top;
            if (top != 0)
                hf_subtract((size_t)(k < n - 1 - j ? k : n - 1 - j), top, general + j * ldab + 2 * k + 1, x + j + 1);
        }
    for (int j = n - 1; j >= 0; j--)
        for (int c = 0; c < n_rhs; c++) {
            double *x = b + (ptrdiff_t)c * ldb;
            int above = j < 2 * k ? j : 2 * k;
            if (x[j] == 0) continue;
            x[j] /= general[j * ldab + 2 * k];
            hf_subtract((size_t)above, x[j], general + j * ldab + 2 * k - above, x + j - above);
        }
}

void hf_band_back_solve_general(int n, int half_bandwidth, int n_rhs, const double *general, const int *pivot,
                                double *b, int ldb)
{
    int k = half_bandwidth, ldab = 3 * k + 1, info = 0;
    for (; n_rhs >= GENERAL_PANEL; n_rhs -= GENERAL_PANEL, b += (ptrdiff_t)GENERAL_PANEL * ldb)
        back_solve_panel(n, k, GENERAL_PANEL, general, pivot, b, ldb);
    CALL(dgbtrs, "N", &n, &k, &k, &n_rhs, general, &ldab, pivot, b, &ldb, &info);
}

hf_status hf_band_solve_indefinite(int n, int half_bandwidth, const double *band, double *general, int *pivot,
                                   double *b, int ldb, int *bad_row)
{
    int k = half_bandwidth, ldab = 3 * k + 1;
    memset(general, 0, (size_t)n * (size_t)ldab * sizeof *general);
    for (int j = 0; j < n; j++)
        for (int d = 0; d <= k && j + d < n; d++) {
            double value = band[d + j * (k + 1)];
            general[2 * k + d + j * ldab] = value;
            general[2 * k - d + (j + d) * ldab] = value;
        }
    *bad_row = hf_band_factor_general(n, k, general, pivot) - 1;
    if (*bad_row >= 0) return HF_SINGULAR;
    hf_band_back_solve_general(n, k, 3, general, pivot, b, ldb);
    return HF_OK;
}

double hf_band_condition_indefinite(int n, int half_bandwidth, const double *general, const int *pivot, double norm,
                                    double *work, int *integer_work)
{
    int k = half_bandwidth, ldab = 3 * k + 1, info = 0;
    double reciprocal = 0;
    CALL(dgbcon, "1", &n, &k, &k, general, &ldab, pivot, &norm, &reciprocal, work, integer_work, &info);
    return reciprocal > 0 ? 1 / reciprocal : (double)INFINITY;
}
