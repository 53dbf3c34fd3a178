/* The band solvers against each other, GSL's band Cholesky and plain dense elimination, over a grid of sizes. */
#include "support.h"

#include "linalg/band.h"
#include "linalg/lapack.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>

enum { MAX_N = 60, MAX_K = 20, LDB = MAX_N + 3 };

struct band_system {
    int n, k;
    double band[MAX_N * (MAX_K + 1)]; /* lower band, column-major: D(i,j) at i-j + j*(k+1) */
    double b[3 * LDB];                /* rows n.. of each column are a guard */
};

static const int sizes[] = {1, 2, 3, 7, 12, 31, 60}, widths[] = {0, 1, 2, 5, 11, 20};
enum { N_SIZES = sizeof sizes / sizeof *sizes, N_WIDTHS = sizeof widths / sizeof *widths };

/* Entries in (-1, 1); `dominance` added to a diagonal that exceeds the sum of its row makes it positive definite. */
static struct band_system random_system(int n, int k, double dominance, uint64_t stream)
{
    struct rng rng = rng_start(stream);
    struct band_system s = {.n = n, .k = k};
    double row_sum[MAX_N] = {0};
    for (int j = 0; j < n; j++)
        for (int i = j; i <= j + k && i < n; i++) {
            double value = s.band[i - j + j * (k + 1)] = rng_uniform(&rng, -1, 1);
            if (i != j) row_sum[i] += fabs(value), row_sum[j] += fabs(value);
        }
    for (int j = 0; j < n && dominance > 0; j++)
        s.band[j * (k + 1)] = row_sum[j] + dominance;
    for (int i = 0; i < 3 * LDB; i++)
        s.b[i] = i % LDB < n ? rng_uniform(&rng, -2.385, 2.385) : 77;
    return s;
}

static double entry(const struct band_system *s, int i, int j)
{
    int low = i < j ? i : j, d = abs(i - j);
    return d <= s->k ? s->band[d + low * (s->k + 1)] : 0;
}

/* Textbook Gaussian elimination with partial pivoting on the full matrix. x: [3][LDB]. */
static void solve_dense(const struct band_system *s, double *x)
{
    static double a[MAX_N][MAX_N];
    int n = s->n;
    memcpy(x, s->b, sizeof s->b);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            a[i][j] = entry(s, i, j);
    for (int p = 0; p < n; p++) {
        int best = p;
        for (int i = p + 1; i < n; i++)
            if (fabs(a[i][p]) > fabs(a[best][p])) best = i;
        for (int j = 0; j < n; j++) {
            double swap = a[p][j];
            a[p][j] = a[best][j], a[best][j] = swap;
        }
        for (int c = 0; c < 3; c++) {
            double swap = x[c * LDB + p];
            x[c * LDB + p] = x[c * LDB + best], x[c * LDB + best] = swap;
        }
        for (int i = p + 1; i < n; i++) {
            double factor = a[i][p] / a[p][p];
            for (int j = p; j < n; j++)
                a[i][j] -= factor * a[p][j];
            for (int c = 0; c < 3; c++)
                x[c * LDB + i] -= factor * x[c * LDB + p];
        }
    }
    for (int c = 0; c < 3; c++)
        for (int i = n - 1; i >= 0; i--) {
            for (int j = i + 1; j < n; j++)
                x[c * LDB + i] -= a[i][j] * x[c * LDB + j];
            x[c * LDB + i] /= a[i][i];
        }
}

/* The layouts agree: GSL's row j holds column j of the lower band. */
static void solve_gsl(const struct band_system *s, double *x)
{
    struct band_system copy = *s;
    memcpy(x, s->b, sizeof s->b);
    gsl_matrix_view a = gsl_matrix_view_array(copy.band, (size_t)s->n, (size_t)s->k + 1);
    ck_assert_int_eq(gsl_linalg_cholesky_band_decomp(&a.matrix), GSL_SUCCESS);
    for (int c = 0; c < 3; c++) {
        gsl_vector_view v = gsl_vector_view_array(x + c * LDB, (size_t)s->n);
        ck_assert_int_eq(gsl_linalg_cholesky_band_svx(&a.matrix, &v.vector), GSL_SUCCESS);
    }
}

static void assert_same(const double *x, const double *y, double tolerance)
{
    for (int i = 0; i < 3 * LDB; i++)
        ck_assert_double_eq_tol(x[i], y[i], tolerance);
}

/* Rows sum to at most 2*20 + 0.317 beside a dominance of 0.317: the condition number stays below 300 and |x| below
 * 2.385/0.317, so roundoff below 300 * 8 * 60 * 1e-16 = 2e-11 even if all of it added up; measured 1e-14. */
#define TOLERANCE 1e-12

START_TEST(cholesky_lu_gsl_and_dense_agree)
{
    int n = sizes[_i % N_SIZES], k = widths[_i / N_SIZES];
    struct band_system s = random_system(n, k, 0.317, (uint64_t)_i);
    double cholesky[3 * LDB], lu[3 * LDB], other[3 * LDB], general[MAX_N * (3 * MAX_K + 1)];
    int pivot[MAX_N], bad_row = 7;
    memcpy(lu, s.b, sizeof lu);
    ck_assert_int_eq(hf_band_solve_indefinite(n, k, s.band, general, pivot, lu, LDB, &bad_row), HF_OK);
    ck_assert_int_eq(bad_row, -1);
    solve_dense(&s, other);
    assert_same(lu, other, TOLERANCE);
    struct band_system copy = s;
    memcpy(cholesky, s.b, sizeof cholesky);
    bad_row = 7;
    ck_assert_int_eq(hf_band_solve(false, n, k, copy.band, cholesky, LDB, &bad_row), HF_OK);
    ck_assert_int_eq(bad_row, -1);
    assert_same(cholesky, other, TOLERANCE); /* the guard rows, too */
    if (k >= n) return;                      /* GSL wants no wider band than the matrix */
    solve_gsl(&s, other);
    assert_same(cholesky, other, TOLERANCE);
}
END_TEST

/* Many right-hand sides share one reading of the factor; each has the answer that LAPACK gives it alone. */
START_TEST(many_right_hand_sides_are_solved_as_each_alone)
{
    enum { N_RHS = 11 };
    int n = sizes[_i % N_SIZES], k = widths[_i / N_SIZES];
    struct band_system s = random_system(n, k, 0, 2000 + (uint64_t)_i);
    double x[3 * LDB], all[N_RHS * LDB], alone[N_RHS * LDB], general[MAX_N * (3 * MAX_K + 1)];
    int pivot[MAX_N], bad_row;
    memcpy(x, s.b, sizeof x);
    ck_assert_int_eq(hf_band_solve_indefinite(n, k, s.band, general, pivot, x, LDB, &bad_row), HF_OK);
    for (int c = 0; c < N_RHS; c++)
        for (int i = 0; i < LDB; i++)
            all[c * LDB + i] = alone[c * LDB + i] = i % (c + 1) ? 0 : s.b[c % 3 * LDB + i] - 0.1 * c;
    hf_band_back_solve_general(n, k, N_RHS, general, pivot, all, LDB);
    for (int c = 0; c < N_RHS; c++) {
        double size = 0;
        hf_band_back_solve_general(n, k, 1, general, pivot, alone + c * LDB, LDB);
        for (int i = 0; i < n; i++)
            size = fmax(size, fabs(alone[c * LDB + i]));
        for (int i = 0; i < LDB; i++)
            ck_assert_double_eq_tol(all[c * LDB + i], alone[c * LDB + i], 1e-12 * size);
    }
}
END_TEST

/* A random matrix may be badly conditioned, so the solution proves little; the backward error of LU with pivoting is
 * small whatever the condition: below n * growth * 1e-16 of |A| |x|, growth below 100 in practice. */
START_TEST(indefinite_systems_are_solved)
{
    int n = sizes[_i % N_SIZES], k = widths[_i / N_SIZES];
    struct band_system s = random_system(n, k, 0, 1000 + (uint64_t)_i);
    double x[3 * LDB], general[MAX_N * (3 * MAX_K + 1)], size = 0;
    int pivot[MAX_N], bad_row;
    memcpy(x, s.b, sizeof x);
    ck_assert_int_eq(hf_band_solve_indefinite(n, k, s.band, general, pivot, x, LDB, &bad_row), HF_OK);
    for (int i = 0; i < 3 * LDB; i++)
        if (i % LDB < n) size = fmax(size, fabs(x[i]));
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < n; i++) {
            double rest = s.b[c * LDB + i];
            for (int j = 0; j < n; j++)
                rest -= entry(&s, i, j) * x[c * LDB + j];
            ck_assert_double_le(fabs(rest), 1e-13 * (2 * k + 1) * size + 1e-15);
        }
}
END_TEST

/* Cholesky breaks at the first pivot that is not positive: the row that is named. */
START_TEST(not_positive_definite_is_told_with_its_row)
{
    int n = 31, k = 5, bad_row = -1, row = _i;
    struct band_system s = random_system(n, k, 0.317, 2000), copy;
    static const double wrong[] = {0, -1e-3, -5};
    for (size_t w = 0; w < sizeof wrong / sizeof *wrong; w++) {
        copy = s;
        for (int j = 0; j < n; j++) /* cut row and column off, so that only the diagonal decides */
            for (int d = 0; d <= k; d++)
                if (j == row || j + d == row) copy.band[d + j * (k + 1)] = 0;
        copy.band[row * (k + 1)] = wrong[w];
        ck_assert_int_eq(hf_band_solve(false, n, k, copy.band, copy.b, LDB, &bad_row), HF_SINGULAR);
        ck_assert_int_eq(bad_row, row);
        ck_assert_mem_eq(copy.b, s.b, sizeof s.b); /* untouched */
    }
}
END_TEST

START_TEST(singular_is_told_with_its_row_by_lu_too)
{
    int n = 31, k = 5, pivot[MAX_N], bad_row = -1, row = _i;
    double general[MAX_N * (3 * MAX_K + 1)];
    struct band_system s = random_system(n, k, 0.317, 3000);
    for (int j = 0; j < n; j++)
        for (int d = 0; d <= k; d++)
            if (j == row || j + d == row) s.band[d + j * (k + 1)] = 0;
    ck_assert_int_eq(hf_band_solve_indefinite(n, k, s.band, general, pivot, s.b, LDB, &bad_row), HF_SINGULAR);
    ck_assert_int_eq(bad_row, row);
    s.band[row * (k + 1)] = -0.5; /* negative is no trouble for LU */
    ck_assert_int_eq(hf_band_solve_indefinite(n, k, s.band, general, pivot, s.b, LDB, &bad_row), HF_OK);
}
END_TEST

static volatile sig_atomic_t is_told;

static void tell_to_stop(int number)
{
    is_told = number;
}

/* In parts the bits are the same, and a pivot below zero is seen in the last one. Told to stop before it begins, it
 * touches nothing; told after 20 ms of half a second, it does not come to the last column. */
START_TEST(a_factorisation_is_told_to_stop)
{
    static const int size[][2] = {{64, 3}, {65, 40}, {300, 70}, {6000, 1000}};
    const struct itimerval soon = {.it_value = {.tv_usec = 20000}};
    signal(SIGVTALRM, tell_to_stop);
    for (int i = 0; i < 4; i++) {
        int n = size[i][0], k = size[i][1];
        bool is_large = i == 3;
        size_t bytes = sizeof(double) * (size_t)n * (size_t)(k + 1);
        double *given = malloc(bytes), *whole = malloc(bytes), *band = malloc(bytes);
        ck_assert(given && whole && band);
        for (int j = 0; j < n; j++)
            for (int d = 0; d <= k; d++)
                given[(ptrdiff_t)j * (k + 1) + d] = d ? 1.0 / (1 + (j + d) % 7) : 2.0 * k + 1;
        memcpy(whole, given, bytes);
        memcpy(band, given, bytes);
        is_told = 1;
        ck_assert_int_eq(hf_band_factor_until(&is_told, n, k, band), HF_INTERRUPTED);
        ck_assert_mem_eq(band, given, bytes);
        is_told = 0;
        if (is_large) setitimer(ITIMER_VIRTUAL, &soon, NULL);
        ck_assert_int_eq(hf_band_factor_until(&is_told, n, k, band), is_large ? HF_INTERRUPTED : HF_OK);
        if (is_large) {
            ck_assert(band[0] != given[0] && band[bytes / sizeof *band - 1 - (size_t)k] == 2.0 * k + 1);
        } else {
            ck_assert_int_eq(hf_band_factor(n, k, whole), 0);
            ck_assert_mem_eq(band, whole, bytes);
            given[(ptrdiff_t)(n - 1) * (k + 1)] = -1;
            ck_assert_int_eq(hf_band_factor_until(&is_told, n, k, given), HF_SINGULAR);
        }
        free(given);
        free(whole);
        free(band);
    }
}
END_TEST

static void load_lapack(void)
{
    ck_assert_int_eq(hf_lapack_load(NULL), HF_OK);
}

Suite *suite_unit_band(void)
{
    Suite *suite = suite_create("unit/band");
    TCase *tests = tcase_create("band");
    suite_add_tcase(suite, tests);
    tcase_add_checked_fixture(tests, load_lapack, NULL);
    tcase_add_loop_test(tests, cholesky_lu_gsl_and_dense_agree, 0, N_SIZES * N_WIDTHS);
    tcase_add_loop_test(tests, many_right_hand_sides_are_solved_as_each_alone, 0, N_SIZES * N_WIDTHS);
    tcase_add_loop_test(tests, indefinite_systems_are_solved, 0, N_SIZES * N_WIDTHS);
    tcase_add_loop_test(tests, not_positive_definite_is_told_with_its_row, 0, 31);
    tcase_add_loop_test(tests, singular_is_told_with_its_row_by_lu_too, 0, 31);
    tcase_add_test(tests, a_factorisation_is_told_to_stop);
    return suite;
}
