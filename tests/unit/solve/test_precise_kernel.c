/* The measure of eight cables at twice the precision: that of the scalar operations to the last bit, on every
 * instruction set. */
#include "support.h"

#include "linalg/twofold.h"
#include "solve/precise_kernel.h"

#include <math.h>
#include <string.h>

static hf_precise_measure *const measure[HF_LANE_N_ISA] = {HF_LANE_EACH(hf_precise_measure)};

enum { SPRING, ELASTIC, SLACK_ELASTIC, RIGID, GIVEN, N_KIND };

static void fill(hf_precise_lanes *p, struct rng *rng)
{
    memset(p, 0, sizeof *p);
    for (int k = 0; k < HF_LANES; k++) {
        int kind = k % N_KIND;
        for (int c = 0; c < 3; c++) {
            p->from[c][0][k] = rng_uniform(rng, -10, 10);
            p->from[c][1][k] = rng_uniform(rng, -1e-17, 1e-17);
            p->to[c][0][k] = p->from[c][0][k] + rng_uniform(rng, -1, 1);
            p->to[c][1][k] = rng_uniform(rng, -1e-17, 1e-17);
        }
        p->T[0][k] = rng_uniform(rng, 1, 10);
        p->T[1][k] = kind == GIVEN ? 0 : rng_uniform(rng, -1e-17, 1e-17);
        p->target[k] = rng_uniform(rng, 0.5, 1);
        p->EA[k] = kind == ELASTIC || kind == SLACK_ELASTIC ? rng_uniform(rng, 1e2, 1e6) : 1;
        p->is_spring[k] = kind == SPRING;
        p->is_elastic[k] = kind == ELASTIC || kind == SLACK_ELASTIC;
        p->is_slack[k] = kind == SLACK_ELASTIC;
    }
}

static void expect_same(hf_twofold a, const double b[2][HF_LANES], int k)
{
    ck_assert_double_eq(a.hi, b[0][k]);
    ck_assert_double_eq(a.lo, b[1][k]);
}

static void expect_cable(const hf_precise_lanes *p, int k, bool by_law)
{
    int kind = k % N_KIND;
    hf_twofold d[3], square = {0, 0}, T = {p->T[0][k], p->T[1][k]}, q;
    hf_twofold target = hf_twofold_of(p->target[k]), EA = hf_twofold_of(p->EA[k]), wanted = target;
    for (int c = 0; c < 3; c++) {
        hf_twofold from = {p->from[c][0][k], p->from[c][1][k]}, to = {p->to[c][0][k], p->to[c][1][k]};
        d[c] = hf_twofold_subtract(to, from);
        hf_twofold_add_to(&square, hf_twofold_multiply(d[c], d[c]));
    }
    hf_twofold length = hf_twofold_root(square);
    bool is_elastic = kind == ELASTIC || kind == SLACK_ELASTIC;
    if (is_elastic) wanted = hf_twofold_add(target, hf_twofold_divide(hf_twofold_multiply(target, T), EA));
    expect_same(hf_twofold_subtract(length, wanted), p->over, k);
    if (kind == SPRING) T = hf_twofold_multiply(target, length);
    if (is_elastic && by_law)
        T = hf_twofold_divide(hf_twofold_multiply(EA, hf_twofold_subtract(length, target)), target);
    q = kind == SLACK_ELASTIC ? (hf_twofold){0, 0} : hf_twofold_divide(T, length);
    ck_assert_double_eq(p->length[k], length.hi);
    ck_assert_double_eq(p->q[k], q.hi);
    for (int c = 0; c < 3; c++) {
        ck_assert_double_eq(p->unit[c][k], d[c].hi / length.hi);
        expect_same(hf_twofold_multiply(q, d[c]), p->pull[c], k);
    }
}

START_TEST(lanes_are_the_scalar_operations)
{
    struct rng rng = rng_start(60 + (uint64_t)_i);
    hf_precise_lanes lanes;
    fill(&lanes, &rng);
    for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
        if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
        measure[isa](&lanes, _i % 2);
        for (int k = 0; k < HF_LANES; k++)
            expect_cable(&lanes, k, _i % 2);
    }
}
END_TEST

Suite *suite_unit_precise_kernel(void)
{
    Suite *suite = suite_create("unit/solve/precise_kernel");
    TCase *tests = tcase_create("precise_kernel");
    tcase_add_loop_test(tests, lanes_are_the_scalar_operations, 0, 20);
    suite_add_tcase(suite, tests);
    return suite;
}
