/* Lengths and elementary functions: against the C library in long double, at the ends of their ranges, bit by bit. */
#include "support.h"

#include "base/elementary.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

enum { N = 20000 };

START_TEST(they_are_those_of_the_library)
{
    struct rng rng = rng_start(11);
    double norm = 0, sine = 0, inverse = 0, power = 0;
    for (int k = 0; k < N; k++) {
        double size = pow(10, rng_uniform(&rng, -12, 8)), x = size * rng_uniform(&rng, -1, 1),
               y = size * rng_uniform(&rng, -1, 1), z = size * rng_uniform(&rng, -1, 1),
               e = rng_uniform(&rng, -900, 900);
        long double length = sqrtl((long double)x * x + (long double)y * y + (long double)z * z);
        norm = fmax(norm, (double)fabsl(hf_norm(x, y, z) / length - 1));
        sine = fmax(sine, (double)fabsl(hf_sine(x) - sinl(x)));
        sine = fmax(sine, (double)fabsl(hf_cosine(x) - cosl(x)));
        inverse = fmax(inverse, (double)fabsl(hf_inverse_sinh(x) / asinhl(x) - 1));
        power = fmax(power, (double)fabsl(hf_power_of_two(e) / exp2l(e) - 1));
    }
    ck_assert_double_le(norm, 4.4e-16);
    ck_assert_double_le(sine, 2e-16);
    ck_assert_double_le(inverse, 1e-15);
    ck_assert_double_le(power, 4e-16);
}
END_TEST

START_TEST(ends_of_the_ranges)
{
    ck_assert_double_eq(hf_norm(0, 0, 0), 0);
    ck_assert_double_eq(hf_norm(3 * 0x1p700, 0, -4 * 0x1p700), 5 * 0x1p700);
    ck_assert_double_eq(hf_norm(3 * 0x1p-1070, 4 * 0x1p-1070, 0), 5 * 0x1p-1070);
    ck_assert_double_eq_tol(hf_norm(0x1p1023, 0x1p1023, 0x1p1023) / 0x1p1023, 1.7320508075688772, 4e-16);
    ck_assert_double_eq(hf_norm(-(double)INFINITY, 1, 2), (double)INFINITY);
    ck_assert_double_eq(hf_norm((double)NAN, (double)INFINITY, 2), (double)INFINITY);
    ck_assert_double_nan(hf_norm((double)NAN, 1, 2));
    ck_assert_double_nan(hf_norm(1, 1e300, (double)NAN));
    ck_assert_double_eq(hf_distance((double[]){1, 2, 3}, (double[]){1, 5, 7}), 5);
    ck_assert_double_eq(hf_sine(0), 0);
    ck_assert_double_eq(hf_cosine(0), 1);
    ck_assert_double_nan(hf_sine((double)INFINITY));
    ck_assert_double_nan(hf_cosine((double)NAN));
    ck_assert_double_eq(hf_inverse_sinh(0), 0);
    ck_assert_double_eq_tol(hf_inverse_sinh(1e300) / 691.46867507877364, 1, 1e-15); /* ln 2e300 */
    for (int k = -490; k <= 490; k += 5)
        ck_assert_double_eq_tol(hf_norm(ldexp(2, k), ldexp(3, k), ldexp(6, k)) / ldexp(7, k), 1, 3e-16);
    for (int k = 8; k < 300; k += 7) { /* far beyond: a sine and a cosine of one angle */
        double angle = 1.2345 * pow(10, k), s = hf_sine(angle), c = hf_cosine(angle);
        ck_assert_double_eq_tol(s * s + c * c, 1, 1e-15);
        if (k < 12) ck_assert_double_eq_tol(s, (double)sinl(angle), 1e-16 * angle);
    }
    ck_assert_double_eq_tol(hf_inverse_sinh(-1e-300) / 1e-300, -1, 1e-15);
    ck_assert_double_eq(hf_inverse_sinh(-(double)INFINITY), -(double)INFINITY);
    for (int k = -60; k <= 60; k++)
        ck_assert_double_eq(hf_power_of_two(k), ldexp(1, k));
}
END_TEST

/* Also against GSL, which takes the same quotients and the C library's logarithm. */
START_TEST(logarithm_and_normal_quantile)
{
    for (int k = -1070 / 2; k < 1000; k += 7)
        for (int i = 0; i < 16; i++) {
            double x = ldexp(1 + i / 16.0, k), y = log(x);
            ck_assert_double_eq_tol(hf_logarithm(x), y, fmax(3e-16 * fabs(y), 1e-16));
        }
    for (int k = 1; k < 4096; k++)
        ck_assert_double_eq_tol(hf_normal_quantile(k / 4096.0), gsl_cdf_ugaussian_Pinv(k / 4096.0), 1e-14);
    for (int k = 2; k < 1000; k += 3) {
        double far = gsl_cdf_ugaussian_Pinv(ldexp(1, -k));
        ck_assert_double_eq_tol(hf_normal_quantile(ldexp(1, -k)) / far, 1, 2e-15);
        if (k < 53) ck_assert_double_eq(hf_normal_quantile(1 - ldexp(1, -k)), -hf_normal_quantile(ldexp(1, -k)));
    }
    ck_assert_double_eq(hf_normal_quantile(0.5), 0);
}
END_TEST

/* FNV-1a of the bits of values between -8 and 8: by this number each processor and compiler must agree. */
START_TEST(bits)
{
    uint64_t sum = 14695981039346656037u;
    for (int k = 0; k < 4096; k++) {
        double x = (k - 2048) / 256.0 + k * 0x1p-40;
        const double value[] = {hf_norm(x, 1 / (x + 9), 0.3),
                                hf_sine(x),
                                hf_cosine(100 * x),
                                hf_inverse_sinh(x),
                                hf_power_of_two(2 * x),
                                hf_logarithm(x + 9),
                                hf_normal_quantile(x / 16.1 + 0.5)};
        unsigned char byte[sizeof value];
        memcpy(byte, value, sizeof value);
        for (size_t i = 0; i < sizeof value; i++)
            sum = (sum ^ byte[i]) * 1099511628211u;
    }
    ck_assert(sum == 1827576997480047962u);
}
END_TEST

/* Against a stable sort of all values, for lists that are shorter and longer than these. */
START_TEST(lists_have_the_largest_values)
{
    enum { N_VALUE = 40, N_LIST = 50 };
    struct rng rng = rng_start(12);
    double value[N_VALUE];
    for (int n_max = 1; n_max <= N_LIST; n_max += 7) {
        int list[N_LIST], n = 0;
        for (int i = 0; i < N_VALUE; i++) {
            value[i] = floor(rng_uniform(&rng, -9, 9));
            n = hf_list_largest(i, value, n_max, n, list);
        }
        ck_assert_int_eq(n, n_max < N_VALUE ? n_max : N_VALUE);
        for (int k = 0; k < n; k++) {
            int n_before = 0;
            for (int i = 0; i < N_VALUE; i++)
                n_before += value[i] > value[list[k]] || (value[i] == value[list[k]] && i < list[k]);
            ck_assert_int_eq(n_before, k);
        }
    }
}
END_TEST

START_TEST(largest_magnitude)
{
    const double value[] = {1, -3, 2, NAN};
    ck_assert_double_eq(hf_max_magnitude(4, value), 3);
    ck_assert_double_eq(hf_max_magnitude(1, value + 3), 0);
    ck_assert_double_eq(hf_max_magnitude(0, value), 0);
}
END_TEST

Suite *suite_unit_elementary(void)
{
    Suite *suite = suite_create("unit/elementary");
    TCase *tests = tcase_create("elementary");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, they_are_those_of_the_library);
    tcase_add_test(tests, ends_of_the_ranges);
    tcase_add_test(tests, logarithm_and_normal_quantile);
    tcase_add_test(tests, bits);
    tcase_add_test(tests, lists_have_the_largest_values);
    tcase_add_test(tests, largest_magnitude);
    return suite;
}
