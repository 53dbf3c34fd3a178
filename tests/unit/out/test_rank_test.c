/* The Mann-Whitney U test, against scipy.stats: mannwhitneyu for values without ties and for large samples,
 * permutation_test of the rank sum for small samples with ties. */
#include "out/rank_test.h"

#include "support.h"

#include <math.h>

enum { N_MOST = 15 };

static const struct {
    int n, m;
    double a[N_MOST], b[N_MOST], p;
} known[] = {
    {3, 3, {1, 2, 3}, {4, 5, 6}, 0.1},
    {5, 5, {1, 2, 3, 4, 5}, {6, 7, 8, 9, 10}, 0.00793650793650794},
    {4, 7, {1, 3, 5, 7}, {2, 4, 6, 8, 9, 10, 11}, 0.163636363636364},
    {5, 4, {19, 22, 16, 29, 24}, {20, 11, 17, 12}, 0.111111111111111},
    {15,
     15,
     {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
     {8.5, 9.5, 10.5, 11.5, 12.5, 13.5, 14.5, 15.5, 16.5, 17.5, 18.5, 19.5, 20.5, 21.5, 22.5},
     0.000215062747264139},
    {4, 4, {1, 1, 2, 3}, {2, 3, 3, 4}, 0.2},
    {5, 6, {1, 2, 2, 3, 3}, {3, 4, 4, 5, 5, 6}, 0.012987012987013},
    {3, 3, {1, 1, 1}, {1, 1, 1}, 1},
    {5, 5, {0}, {1, 1, 1, 1, 1}, 0.00793650793650794},
    {1, 1, {0}, {1}, 1},
};

START_TEST(small_samples_are_exact)
{
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        ck_assert_double_eq_tol(hf_rank_test(known[i].a, known[i].n, known[i].b, known[i].m), known[i].p, 1e-14);
        ck_assert_double_eq_tol(hf_rank_test(known[i].b, known[i].m, known[i].a, known[i].n), known[i].p, 1e-14);
    }
}
END_TEST

START_TEST(large_samples_are_approximated)
{
    double a[30], b[30];
    for (int i = 0; i < 30; i++) {
        a[i] = i * i % 23;
        b[i] = i * i % 23 + 5;
    }
    ck_assert_double_eq_tol(hf_rank_test(a, 25, b, 20), 0.00262170375097802, 1e-13);
    for (int i = 0; i < 30; i++) {
        a[i] = i;
        b[i] = i + 4.5;
    }
    ck_assert_double_eq_tol(hf_rank_test(a, 30, b, 30), 0.0656712576891266, 1e-13);
    for (int i = 0; i < 30; i++)
        b[i] = a[i] = 7;
    ck_assert_double_eq(hf_rank_test(a, 30, b, 30), 1);
}
END_TEST

/* Samples of one distribution, with and without ties: a p-value below 0.01 occurs in at most 1 % of the trials. */
START_TEST(equal_distributions_seldom_differ)
{
    static const int size[][2] = {{5, 5}, {15, 15}, {6, 9}, {30, 30}};
    enum { N_TRIAL = 500 };
    for (size_t s = 0; s < sizeof size / sizeof *size; s++)
        for (int n_level = 4; n_level <= 1000000; n_level *= 500) {
            int n_differ = 0;
            for (int trial = 0; trial < N_TRIAL; trial++) {
                struct rng rng = rng_start((uint64_t)trial);
                double value[60];
                for (int i = 0; i < size[s][0] + size[s][1]; i++)
                    value[i] = floor(n_level * rng_uniform(&rng, 0, 1));
                n_differ += hf_rank_test(value, size[s][0], value + size[s][0], size[s][1]) < 0.01;
            }
            ck_assert_int_le(n_differ, 14); /* mean 5 at most, standard deviation 2.2 */
        }
}
END_TEST

Suite *suite_unit_rank_test(void)
{
    Suite *suite = suite_create("unit/rank_test");
    TCase *tcase = tcase_create("rank_test");
    tcase_add_test(tcase, small_samples_are_exact);
    tcase_add_test(tcase, large_samples_are_approximated);
    tcase_add_test(tcase, equal_distributions_seldom_differ);
    suite_add_tcase(suite, tcase);
    return suite;
}
