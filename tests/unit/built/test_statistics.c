/* Ranks and intervals of very many samples, against sorting, tables and sums term by term. */
#include "nets.h"

#include "base/elementary.h"
#include "built/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static hf_status read_numbers(void *context, long first, int n, double *row)
{
    memcpy(row, (double *)context + first * HF_TOLERANCE_COLUMNS, (size_t)n * HF_TOLERANCE_COLUMNS * sizeof *row);
    return HF_OK;
}

START_TEST(order_is_that_of_sorting)
{
    enum { N = 3001 };
    double *row = malloc(sizeof *row * N * HF_TOLERANCE_COLUMNS), sorted[N], value[5];
    double missing = _i ? -(double)INFINITY : (double)INFINITY;
    struct rng rng = rng_start(3);
    int n = 0;
    for (int i = 0; i < N; i++) {
        double x = rng_uniform(&rng, -1, 1) * pow(10, rng_uniform(&rng, -9, 9));
        if (i % 10 == 3) x = 7; /* ties */
        if (i % 50 == 4) x = (double)NAN;
        if (i == 77) x = INFINITY;
        row[i * HF_TOLERANCE_COLUMNS + 4] = x;
        sorted[n++] = isnan(x) ? missing : x;
    }
    qsort(sorted, (size_t)n, sizeof *sorted, hf_compare_doubles);
    const hf_statistics_rows rows = {N, read_numbers, row, HF_TOLERANCE_COLUMNS};
    const long rank[5] = {1, n / 3, n / 2, n - 1, n};
    ck_assert_int_eq(hf_statistics_order(&rows, 4, missing, 5, rank, value), HF_OK);
    for (int k = 0; k < 5; k++)
        ck_assert(value[k] == sorted[rank[k] - 1]);
    free(row);
}
END_TEST

/* Figures of tables: Clopper and Pearson for 9 of 10; the median of 100 between ranks 40 and 61 (Conover). */
START_TEST(intervals_are_those_of_tables)
{
    double low, high;
    long from, to;
    hf_statistics_interval(10, 9, &low, &high);
    ck_assert_double_eq_tol(low, 0.5550, 5e-5);
    ck_assert_double_eq_tol(high, 0.9975, 5e-5);
    hf_statistics_interval(10, 10, &low, &high);
    ck_assert_double_eq_tol(low, 0.6915, 5e-5);
    ck_assert_double_eq(high, 1);
    hf_statistics_ranks(100, 0.5, &from, &to);
    ck_assert_int_eq(from, 40);
    ck_assert_int_eq(to, 61);
    hf_statistics_ranks(20, 0.99, &from, &to);
    ck_assert_int_eq(to, 21); /* there is no such value */
}
END_TEST

/* P(B >= k), term by term from the logarithms of factorials. */
static double at_least(int n, int k, double part)
{
    double sum = 0;
    for (int i = k; i <= n; i++)
        sum += exp(lgamma(n + 1.0) - lgamma(i + 1.0) - lgamma(n - i + 1.0) + i * log(part) + (n - i) * log1p(-part));
    return sum;
}

/* Each end of the interval of k in 1000 leaves 2.5 % in its tail; and those of very many stay near the normal ones. */
START_TEST(intervals_are_right_for_every_count)
{
    enum { N = 1000, MANY = 10000000 };
    double low, high, before = -1;
    long from, to;
    for (int k = 0; k <= N; k++) {
        hf_statistics_interval(N, k, &low, &high);
        ck_assert_msg(low > before && low <= k / (double)N && high >= k / (double)N, "%d: %g %g", k, low, high);
        if (k > 0) ck_assert_double_eq_tol(at_least(N, k, low), 0.025, 1e-9);
        if (k < N) ck_assert_double_eq_tol(1 - at_least(N, k + 1, high), 0.025, 1e-9);
        before = k > 0 ? low : before;
    }
    static const double part[] = {0.5, 0.95, 0.99};
    for (int q = 0; q < 3; q++) {
        double middle = MANY * part[q], wide = 1.959963984540054 * sqrt(middle * (1 - part[q]));
        hf_statistics_ranks(MANY, part[q], &from, &to);
        ck_assert_msg(fabs((double)from - middle + wide) < 3 && fabs((double)to - middle - wide) < 3, "%ld %ld", from,
                      to);
        hf_statistics_interval(MANY, (long)middle, &low, &high);
        ck_assert_double_eq_tol(low * MANY, middle - wide, 4);
        ck_assert_double_eq_tol(high * MANY, middle + wide, 4);
    }
    hf_statistics_interval(100000000, 1, &low, &high); /* n p is 0.0253 and 5.572 (Poisson) */
    ck_assert_double_eq_tol(low * 1e8, 0.025318, 1e-6);
    ck_assert_double_eq_tol(high * 1e8, 5.571643, 1e-5);
}
END_TEST

Suite *suite_unit_statistics(void)
{
    Suite *suite = suite_create("unit/statistics");
    TCase *tcase = tcase_create("statistics");
    tcase_add_loop_test(tcase, order_is_that_of_sorting, 0, 2);
    tcase_add_test(tcase, intervals_are_those_of_tables);
    tcase_add_test(tcase, intervals_are_right_for_every_count);
    suite_add_tcase(suite, tcase);
    return suite;
}
