/* Dense matrices against LAPACK, over random sizes. */
#include "support.h"

#include "linalg/dense.h"
#include "linalg/lapack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef void factor_routine(const int *m, const int *n, double *a, const int *lda, int *pivot, int *info);
typedef void solve_routine(const char *trans, const int *n, const int *n_rhs, const double *a, const int *lda,
                           const int *pivot, double *b, const int *ldb, int *info);
typedef void multiply_routine(const char *trans_a, const char *trans_b, const int *m, const int *n, const int *k,
                              const double *alpha, const double *a, const int *lda, const double *b, const int *ldb,
                              const double *beta, double *c, const int *ldc);

enum { MAX_N = 60, N_RHS = 3 };

static void (*of_lapack(const char *name))(void)
{
    ck_assert_int_eq(hf_lapack_load(NULL), HF_OK);
    void (*routine)(void) = hf_lapack_find(name);
    ck_assert_msg(routine != NULL, "LAPACK has no %s", name);
    return routine;
}

static void draw(int count, double *a, struct rng *rng)
{
    for (int i = 0; i < count; i++)
        a[i] = rng_uniform(rng, -1, 1);
}

/* Both take the largest entry of a column as its pivot, so their factors are the same but for rounding: entries below
 * 60, growth below 100 in 60 columns of numbers that are this random, sums of 60. */
START_TEST(factor_and_solution)
{
    struct rng rng = rng_start((uint64_t)_i);
    int n = 1 + (int)rng_uniform(&rng, 0, MAX_N), n_rhs = N_RHS, info, pivot[MAX_N], theirs_pivot[MAX_N];
    double a[MAX_N * MAX_N], b[N_RHS * MAX_N], theirs[MAX_N * MAX_N], x[N_RHS * MAX_N];
    draw(n * n, a, &rng);
    draw(N_RHS * n, b, &rng);
    memcpy(theirs, a, sizeof a);
    memcpy(x, b, sizeof b);
    ((factor_routine *)of_lapack("dgetrf_"))(&n, &n, theirs, &n, theirs_pivot, &info);
    ck_assert_int_eq(hf_dense_factor(n, a, pivot), info);
    for (int i = 0; i < n; i++)
        ck_assert_int_eq(pivot[i], theirs_pivot[i] - 1);
    for (int i = 0; i < n * n; i++)
        ck_assert_double_eq_tol(a[i], theirs[i], 1e-10);
    ((solve_routine *)of_lapack("dgetrs_"))("N", &n, &n_rhs, theirs, &n, theirs_pivot, x, &n, &info);
    hf_dense_solve(n, a, pivot, N_RHS, b);
    for (int i = 0; i < N_RHS * n; i++)
        ck_assert_double_eq_tol(b[i], x[i], 1e-8 * (1 + fabs(x[i])));
}
END_TEST

START_TEST(product)
{
    struct rng rng = rng_start((uint64_t)_i);
    int n = 1 + (int)rng_uniform(&rng, 0, MAX_N);
    double a[MAX_N * MAX_N], b[MAX_N * MAX_N], c[MAX_N * MAX_N], theirs[MAX_N * MAX_N], one = 1, zero = 0;
    draw(n * n, a, &rng);
    draw(n * n, b, &rng);
    hf_dense_multiply(n, a, b, c);
    ((multiply_routine *)of_lapack("dgemm_"))("N", "N", &n, &n, &n, &one, a, &n, b, &n, &zero, theirs, &n);
    for (int i = 0; i < n * n; i++)
        ck_assert_double_eq_tol(c[i], theirs[i], 1e-13 * n);
}
END_TEST

START_TEST(no_pivot)
{
    double a[9] = {1, 2, 3, 2, 4, 6, 1, 0, 1};
    int pivot[3];
    ck_assert_int_eq(hf_dense_factor(3, a, pivot), 2);
    a[0] = (double)NAN;
    ck_assert_int_eq(hf_dense_factor(1, a, pivot), 1);
}
END_TEST

Suite *suite_unit_dense(void)
{
    Suite *suite = suite_create("unit/dense");
    TCase *tests = tcase_create("dense");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, factor_and_solution, 0, 30);
    tcase_add_loop_test(tests, product, 0, 10);
    tcase_add_test(tests, no_pivot);
    return suite;
}
