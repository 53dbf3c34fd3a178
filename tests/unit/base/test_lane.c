/* The vectors of kernels: fused products of the portable ones, which are put together from sums and products, are those
 * of C's fma() to the bit. */
#include "support.h"

#define HF_ISA portable
#define HF_LANE_VECTORS
#include "base/lane.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { N_TRIAL = 60000 };

/* Any bits; small whole numbers, which give zeros of both signs and exact sums; numbers of few and of many digits and
 * of moderate size; those next to 1. */
static double draw(struct rng *rng)
{
    uint64_t bits = rng_next(rng);
    double any;
    switch (rng_int(rng, 0, 4)) {
    case 0:
        memcpy(&any, &bits, sizeof any);
        return any;
    case 1:
        return (double)(int)(bits % 9) - 4;
    case 2:
        return ldexp((double)(int64_t)bits, (int)(rng_next(rng) % 80) - 100);
    case 3:
        return ldexp((double)(bits % 1024 + 1), (int)(rng_next(rng) % 80) - 40);
    default:
        return 1 + ldexp((double)(bits % 8), -52);
    }
}

/* An addend at which the rounding is hard: nothing, or some last bits, are left of the sum; or it is half a last bit of
 * the product, or nearly so. */
static double draw_near(struct rng *rng, double product)
{
    switch (isnormal(product) ? rng_int(rng, 0, 3) : 0) {
    case 0:
        return draw(rng);
    case 1:
        return -product * (1 + ldexp(rng_int(rng, -8, 7), -53));
    case 2:
        return ldexp(product, rng_int(rng, -60, 59));
    default:
        return ldexp(rng_int(rng, 0, 1) ? 1 : -1, ilogb(product) + rng_int(rng, 50, 59));
    }
}

static void assert_same(double found, double wanted, double a, double b, double c)
{
    ck_assert_msg(!memcmp(&found, &wanted, sizeof found) || (isnan(found) && isnan(wanted)),
                  "%a, %a and %a: %a, not %a", a, b, c, found, wanted);
}

START_TEST(fused_products_are_those_of_c)
{
    struct rng rng = rng_start(17);
    vec a, b, c;
    for (int i = 0; i < N_TRIAL; i++) {
        for (int k = 0; k < WIDTH; k++) {
            a[k] = draw(&rng), b[k] = draw(&rng);
            c[k] = draw_near(&rng, a[k] * b[k]);
        }
        vec sum = plus_product(c, a, b), difference = less_product(c, a, b);
        for (int k = 0; k < WIDTH; k++) {
            assert_same(sum[k], fma(a[k], b[k], c[k]), a[k], b[k], c[k]);
            assert_same(difference[k], fma(-a[k], b[k], c[k]), a[k], b[k], c[k]);
        }
    }
}
END_TEST

Suite *suite_unit_lane(void)
{
    Suite *suite = suite_create("unit/lane");
    TCase *tests = tcase_create("lane");
    tcase_add_test(tests, fused_products_are_those_of_c);
    suite_add_tcase(suite, tests);
    return suite;
}
