/* Numbers of twice the precision: sums and products of doubles are exact, the other operations right to 16 u^2. */
#include "support.h"

#include "linalg/twofold.h"
#include <math.h>

#define TRIALS 20000

static hf_twofold any(struct rng *rng)
{
    double hi = rng_uniform(rng, 1, 2) * pow(2, rng_int(rng, -40, 40)) * (rng_int(rng, 0, 1) ? 1 : -1);
    return hf_twofold_sum(hi, rng_uniform(rng, -0.5, 0.5) * 0x1p-52 * hi);
}

/* |a - b| / |b| in units of u^2. */
static double off(hf_twofold a, hf_twofold b)
{
    hf_twofold d = hf_twofold_subtract(a, b);
    return fabs(d.hi / b.hi) / HF_TWOFOLD_UNIT;
}

/* Products of integers of 26 bits are exact in a double, so those of 52 bits can be put together from four. */
START_TEST(products_of_doubles_are_exact)
{
    struct rng rng = rng_start(0);
    for (int k = 0; k < TRIALS; k++) {
        double a1 = rng_int(&rng, 1 << 25, (1 << 26) - 1), a0 = rng_int(&rng, 0, (1 << 26) - 1);
        double b1 = rng_int(&rng, 1 << 25, (1 << 26) - 1), b0 = rng_int(&rng, 0, (1 << 26) - 1);
        hf_twofold p = hf_twofold_product(0x1p26 * a1 + a0, 0x1p26 * b1 + b0);
        /* from the top, each difference is exact */
        double rest = ((p.hi - 0x1p52 * a1 * b1) - 0x1p26 * a1 * b0) - 0x1p26 * a0 * b1;
        ck_assert_double_eq(rest - a0 * b0 + p.lo, 0);
    }
}
END_TEST

START_TEST(sums_of_doubles_are_exact)
{
    struct rng rng = rng_start(1);
    for (int k = 0; k < TRIALS; k++) {
        double a = rng_uniform(&rng, -1, 1), b = rng_uniform(&rng, -1, 1) * pow(2, rng_int(&rng, -60, 60));
        hf_twofold s = hf_twofold_sum(a, b), back = hf_twofold_sum(s.hi, -b);
        ck_assert_double_eq(back.hi + s.lo + back.lo, a);
        ck_assert_double_eq(s.hi, a + b);
    }
}
END_TEST

START_TEST(operations_undo_each_other)
{
    struct rng rng = rng_start(2);
    for (int k = 0; k < TRIALS; k++) {
        hf_twofold a = any(&rng), b = any(&rng), square = hf_twofold_multiply(a, a);
        hf_twofold back = hf_twofold_multiply(hf_twofold_divide(a, b), b);
        ck_assert_double_le(off(back, a), 24);
        hf_twofold root = hf_twofold_root(square);
        ck_assert_double_le(off(root, a.hi > 0 ? a : hf_twofold_minus(a)), 12);
        hf_twofold sum = hf_twofold_add(hf_twofold_add(a, b), hf_twofold_minus(a));
        double allowed = 8 * (1 + fabs(a.hi / b.hi)); /* the error of the first sum is relative to it */
        ck_assert_double_le(off(sum, b), allowed);
        ck_assert_double_eq(a.hi, a.hi + a.lo);
    }
    ck_assert_double_eq(hf_twofold_root((hf_twofold){0, 0}).hi, 0);
}
END_TEST

/* (1 + u)^2 - 1 - 2 u = u^2, which a double cannot see. */
START_TEST(what_a_double_loses_is_kept)
{
    hf_twofold one = hf_twofold_of(1), a = {1, 0x1p-53}, square = hf_twofold_multiply(a, a);
    ck_assert_double_eq(hf_twofold_subtract(square, one).hi, 0x1p-52);
    hf_twofold third = hf_twofold_divide(one, hf_twofold_of(3));
    hf_twofold rest = hf_twofold_subtract(hf_twofold_multiply(third, hf_twofold_of(3)), one);
    ck_assert_double_le(fabs(rest.hi), 24 * HF_TWOFOLD_UNIT);
    ck_assert_double_eq(third.hi, 1.0 / 3);
    ck_assert(third.lo != 0);
}
END_TEST

Suite *suite_unit_twofold(void)
{
    Suite *suite = suite_create("unit/twofold");
    TCase *tests = tcase_create("twofold");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, products_of_doubles_are_exact);
    tcase_add_test(tests, sums_of_doubles_are_exact);
    tcase_add_test(tests, operations_undo_each_other);
    tcase_add_test(tests, what_a_double_loses_is_kept);
    return suite;
}
