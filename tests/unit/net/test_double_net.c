/* What stands behind a point of the front net, by the closed form: along the normal the distance to the rear surface is
 * a quadratic in the length, whose smaller root is wanted. */
#include "support.h"

#include "net/double_net.h"

#include <math.h>

/* Coefficients of the height above the rear surface, a t^2 + b t + c, on the normal (2 k x, 2 k y, -1) t from the point
 * (x, y, k s^2); k: curvature of the front, s: over which it is curved. */
static void expand(const hf_double_net *d, const double at[3], double *a, double *b, double *c)
{
    bool is_round = d->kind == HF_SURFACE_PARABOLOID;
    double k = 1 / (4 * d->focal_length_m), nearing = k + 1 / (4 * d->rear_focal_length_m);
    double x = at[0], y = is_round ? at[1] : 0, u = x - d->middle_x_m, slope[2] = {2 * k * x, 2 * k * y};
    *a = (nearing - k) * (slope[0] * slope[0] + slope[1] * slope[1]);
    *b = -1 - 2 * k * (x * slope[0] + y * slope[1]) + 2 * nearing * (u * slope[0] + y * slope[1]);
    *c = d->distance_m - (d->half_m * d->half_m - u * u - y * y) * nearing;
}

/* Random dishes; of every second one the rear net so far away that the normal nearly misses it, by `grazing` of the
 * square of b. */
START_TEST(the_normal_ends_on_the_rear_surface)
{
    int n_found = 0;
    for (int trial = 0; trial < 200; trial++) {
        struct rng rng = rng_start(9100 + (uint64_t)trial);
        double a, b, c, grazing = pow(10, rng_uniform(&rng, -8, -1)), rear[3];
        hf_double_net d = {.kind = _i ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER,
                           .focal_length_m = rng_uniform(&rng, 2, 6),
                           .rear_focal_length_m = rng_uniform(&rng, 2, 6),
                           .middle_x_m = _i ? 0 : rng_uniform(&rng, 0, 1),
                           .half_m = rng_uniform(&rng, 3, 5)};
        double x = d.middle_x_m + rng_uniform(&rng, -0.5, 0.5) * d.half_m, y = rng_uniform(&rng, -0.5, 0.5) * d.half_m;
        double front[3] = {x, y, (x * x + (_i ? y * y : 0)) / (4 * d.focal_length_m)};
        d.distance_m = rng_uniform(&rng, 1, 4);
        expand(&d, front, &a, &b, &c);
        if (trial % 2) d.distance_m += (1 - grazing) * b * b / (4 * a) - c;
        expand(&d, front, &a, &b, &c);
        if (!(b < 0 && c > 0 && d.distance_m < 1e6)) continue;
        if (b * b < 4 * a * c) {
            ck_assert(!hf_double_net_behind(&d, false, front, rear));
            continue;
        }
        double t = 2 * c / (-b + sqrt(b * b - 4 * a * c)), k = 1 / (2 * d.focal_length_m);
        ck_assert_msg(hf_double_net_behind(&d, false, front, rear), "trial %d: not found, %g", trial, grazing);
        ck_assert_double_eq_tol(rear[0], x + t * k * x, 1e-6 * t);
        ck_assert_double_eq_tol(rear[1], y + (_i ? t * k * y : 0), 1e-6 * t);
        ck_assert_double_eq_tol(rear[2], front[2] - t, 1e-6 * t);
        n_found++;
        ck_assert(hf_double_net_behind(&d, true, front, rear));
        ck_assert_double_eq(rear[0], x);
        ck_assert_double_eq(rear[1], y);
        ck_assert_double_eq_tol(rear[2], front[2] - c, 1e-12 * (1 + d.distance_m));
    }
    ck_assert_int_gt(n_found, 80);
}
END_TEST

Suite *suite_unit_double_net(void)
{
    Suite *suite = suite_create("unit/double_net");
    TCase *tests = tcase_create("double_net");
    tcase_add_loop_test(tests, the_normal_ends_on_the_rear_surface, 0, 2);
    suite_add_tcase(suite, tests);
    return suite;
}
