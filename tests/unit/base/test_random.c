/* Random numbers and clocks. Stored results are computed again from their seed, so the generator must keep giving the
 * numbers of its published reference implementation. */
#include "support.h"

#include "base/clock.h"
#include "base/random.h"

#include <inttypes.h>

/* The first five of seed 1234567, as the authors' reference implementation (splitmix64.c of Vigna) gives them. */
START_TEST(numbers_are_those_of_splitmix64)
{
    static const uint64_t expected[5] = {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                         4593380528125082431u, 16408922859458223821u};
    hf_random random = {1234567};
    for (int i = 0; i < 5; i++)
        ck_assert_uint_eq(hf_random_next(&random), expected[i]);
}
END_TEST

/* Journals and result files rely on these starting states: their designs are computed again from them. */
START_TEST(a_stream_is_named_by_seed_generation_and_individual)
{
    ck_assert_uint_eq(hf_random_stream(1, 0, 0).state, 5127574494469434565u);
    ck_assert_uint_eq(hf_random_stream(1, 3, 7).state, 4209807263053981009u);
    ck_assert_uint_ne(hf_random_stream(1, 7, 3).state, hf_random_stream(1, 3, 7).state);
    ck_assert_uint_ne(hf_random_stream(2, 3, 7).state, hf_random_stream(1, 3, 7).state);
}
END_TEST

START_TEST(uniform_numbers_have_53_bits_and_never_reach_one)
{
    hf_random random = {1234567};
    ck_assert_double_eq(hf_random_uniform(&random), (double)(6457827717110365317u >> 11) / 9007199254740992.0);
    ck_assert_double_lt((double)(UINT64_MAX >> 11) * 0x1p-53, 1);
    double sum = 0;
    for (int i = 0; i < 10000; i++)
        sum += hf_random_uniform(&random);
    ck_assert_double_eq_tol(sum / 10000, 0.5, 0.015); /* five standard deviations */
}
END_TEST

START_TEST(clocks_run_forward)
{
    double wall_s = hf_clock_s(), cpu_s = hf_clock_thread_cpu_s(), begin_s = cpu_s;
    for (int i = 0; i < 1000; i++) {
        double now_s = hf_clock_s(), used_s = hf_clock_thread_cpu_s();
        ck_assert_double_ge(now_s, wall_s);
        ck_assert_double_ge(used_s, cpu_s);
        wall_s = now_s;
        cpu_s = used_s;
    }
    ck_assert_double_gt(cpu_s, begin_s);
}
END_TEST

Suite *suite_unit_random(void)
{
    Suite *suite = suite_create("unit/random");
    TCase *tc = tcase_create("random");
    tcase_add_test(tc, numbers_are_those_of_splitmix64);
    tcase_add_test(tc, a_stream_is_named_by_seed_generation_and_individual);
    tcase_add_test(tc, uniform_numbers_have_53_bits_and_never_reach_one);
    tcase_add_test(tc, clocks_run_forward);
    suite_add_tcase(suite, tc);
    return suite;
}
