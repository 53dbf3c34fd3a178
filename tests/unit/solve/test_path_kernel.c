/* The cables of the path: their equations, written out for one cable, and the same bits on every instruction set. */
#include "support.h"

#include "solve/path_kernel.h"

#include <math.h>
#include <string.h>

enum { N_BLOCK = 9, N_CABLE = N_BLOCK * HF_LANES };

static const hf_path_kernels *const kernel[HF_LANE_N_ISA] = {HF_LANE_EACH(&hf_path_kernels)};

/* ---- cables ---- */

/* Random points in the cones; a fifth of the cables have none, and the last block is not full. */
static void fill(hf_path_cables block[N_BLOCK], int seed)
{
    struct rng rng = rng_start(40 + (uint64_t)seed);
    memset(block, 0, N_BLOCK * sizeof *block);
    for (int e = 0; e < N_CABLE - 3; e++) {
        hf_path_cables *p = block + e / HF_LANES;
        int k = e % HF_LANES, kind = (int)rng_uniform(&rng, 0, 5);
        double d = 0, t = 0;
        for (int c = 0; c < 3; c++) {
            p->d[c][k] = rng_uniform(&rng, -1, 1);
            p->t[c][k] = rng_uniform(&rng, -1, 1);
            p->Dd[c][k] = rng_uniform(&rng, -0.5, 0.5);
            d += p->d[c][k] * p->d[c][k];
            t += p->t[c][k] * p->t[c][k];
        }
        p->has_cone[k] = kind > 0;
        p->has_multiplier[k] = kind > 2;
        p->target[k] = rng_uniform(&rng, 0.5, 1.5);
        p->EA[k] = kind > 3 ? pow(10, rng_uniform(&rng, 0, 6)) : INFINITY;
        p->flex[k] = kind > 3 ? p->target[k] / p->EA[k] : 0;
        p->theoretical[k] = 1;
        p->v[k] = sqrt(d) + pow(10, rng_uniform(&rng, -6, 0));
        p->T[k] = sqrt(t) + pow(10, rng_uniform(&rng, -6, 0));
        p->weight[k] = rng_uniform(&rng, 0.1, 10);
        if (kind == 0) p->along[k] = p->across[k] = 3;
    }
}

/* ---- one cable, written out ---- */

struct point {
    double x[4];
};

static struct point point_of(double first, const double rest[3][HF_LANES], int k, double sign)
{
    return (struct point){{first, sign * rest[0][k], sign * rest[1][k], sign * rest[2][k]}};
}

/* W a with W = eta [w0, w1'; w1, I + w1 w1'/(1 + w0)], or its inverse, which has -w1 and 1/eta. */
static struct point scaled(const hf_path_cables *p, int k, struct point a, bool inverse)
{
    double sign = inverse ? -1 : 1, eta = sqrt(p->eta2[k]), w0 = p->w0[k], inner = 0;
    struct point b;
    for (int c = 0; c < 3; c++)
        inner += sign * p->w1[c][k] * a.x[c + 1];
    b.x[0] = w0 * a.x[0] + inner;
    for (int c = 0; c < 3; c++)
        b.x[c + 1] = a.x[c + 1] + sign * p->w1[c][k] * (a.x[0] + inner / (1 + w0));
    for (int c = 0; c < 4; c++)
        b.x[c] *= inverse ? 1 / eta : eta;
    return b;
}

/* The product of Jordan's algebra. */
static struct point product(struct point a, struct point b)
{
    struct point r = {{a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2] + a.x[3] * b.x[3]}};
    for (int c = 1; c < 4; c++)
        r.x[c] = a.x[0] * b.x[c] + b.x[0] * a.x[c];
    return r;
}

static double norm(struct point a)
{
    return sqrt(a.x[0] * a.x[0] + a.x[1] * a.x[1] + a.x[2] * a.x[2] + a.x[3] * a.x[3]);
}

static void expect_near(struct point a, struct point b, double scale)
{
    for (int c = 0; c < 4; c++)
        ck_assert_double_eq_tol(a.x[c], b.x[c], 1e-7 * scale);
}

/* Asserts the equations of one cable with a cone after a direction for the product `target`. */
static void expect_equations(const hf_path_cables *p, int k, double target, bool corrected)
{
    struct point lambda = point_of(p->lambda0[k], p->lambda1, k, 1);
    struct point z = scaled(p, k, point_of(p->T[k], p->t, k, -1), false);
    expect_near(z, lambda, norm(lambda));
    expect_near(scaled(p, k, point_of(p->v[k], p->d, k, 1), true), lambda, norm(lambda));
    if (p->has_multiplier[k] != 0) {
        double over = p->target[k] + p->flex[k] * p->T[k] - p->v[k];
        ck_assert_double_eq_tol(p->short_m[k], over, 1e-12);
        ck_assert_double_eq_tol(p->Dv[k], over + p->flex[k] * p->DT[k], 1e-9 * (1 + fabs(p->Dv[k])));
    } else {
        ck_assert_double_eq(p->DT[k], 0);
    }
    struct point Ds = scaled(p, k, point_of(p->Dv[k], p->Dd, k, 1), true);
    struct point Dz = scaled(p, k, point_of(p->DT[k], p->Dt, k, -1), false), sum, right;
    for (int c = 0; c < 4; c++) {
        sum.x[c] = Ds.x[c] + Dz.x[c];
        right.x[c] = -product(lambda, lambda).x[c] + (c ? 0 : target * p->weight[k]);
        if (corrected) right.x[c] -= c ? p->corrector1[c - 1][k] : p->corrector0[k];
    }
    double terms = norm(lambda) * (norm(Ds) + norm(Dz) + norm(lambda)) + target * p->weight[k];
    expect_near(product(lambda, sum), right, terms);
}

static double least_slack(const hf_path_cables *p, int k, double part)
{
    struct point s = point_of(p->v[k] + part * p->Dv[k], p->d, k, 1),
                 z = point_of(p->T[k] + part * p->DT[k], p->t, k, 1);
    for (int c = 0; c < 3; c++) {
        s.x[c + 1] += part * p->Dd[c][k];
        z.x[c + 1] += part * p->Dt[c][k];
    }
    double v = s.x[0], T = z.x[0];
    s.x[0] = z.x[0] = 0;
    return fmin((v - norm(s)) / p->v[k], (T - norm(z)) / p->T[k]);
}

START_TEST(equations_hold)
{
    hf_path_cables block[N_BLOCK];
    fill(block, _i);
    double length_error = kernel[0]->measure(N_BLOCK, block), largest = 0;
    kernel[0]->set_scaling(N_BLOCK, block);
    kernel[0]->set_side(N_BLOCK, block, 0, false);
    kernel[0]->set_direction(N_BLOCK, block, true);
    for (int e = 0; e < N_CABLE; e++) {
        const hf_path_cables *p = block + e / HF_LANES;
        int k = e % HF_LANES;
        if (p->has_cone[k] != 0) expect_equations(p, k, 0, false);
        if (p->has_multiplier[k] != 0) largest = fmax(largest, fabs(p->short_m[k]));
    }
    ck_assert_double_eq(length_error, largest);
    kernel[0]->set_side(N_BLOCK, block, 0.1, true);
    double room = 1 / kernel[0]->set_direction(N_BLOCK, block, false), least = INFINITY;
    for (int e = 0; e < N_CABLE; e++) {
        const hf_path_cables *p = block + e / HF_LANES;
        int k = e % HF_LANES;
        if (p->has_cone[k] == 0) continue;
        expect_equations(p, k, 0.1, true);
        least = fmin(least, least_slack(p, k, room));
    }
    ck_assert_double_eq_tol(least, 0, 1e-6);
}
END_TEST

START_TEST(cables_without_a_cone_stay)
{
    hf_path_cables block[N_BLOCK], before[N_BLOCK];
    fill(block, 0);
    memcpy(before, block, sizeof block);
    kernel[0]->measure(N_BLOCK, block);
    kernel[0]->set_scaling(N_BLOCK, block);
    kernel[0]->set_side(N_BLOCK, block, 0.1, false);
    kernel[0]->set_direction(N_BLOCK, block, true);
    kernel[0]->move(N_BLOCK, block, 0.5);
    for (int e = 0; e < N_CABLE; e++) {
        const hf_path_cables *p = block + e / HF_LANES, *was = before + e / HF_LANES;
        int k = e % HF_LANES;
        if (p->has_cone[k] != 0) {
            ck_assert_double_eq(p->T_before[k], was->T[k]);
            ck_assert_double_eq(p->v[k], was->v[k] + 0.5 * p->Dv[k]);
            continue;
        }
        ck_assert_double_eq(p->along[k], was->along[k]);
        ck_assert_double_eq(p->across[k], was->across[k]);
        ck_assert_double_eq(p->T[k], was->T[k]);
        for (int c = 0; c < 3; c++) {
            ck_assert_double_eq(p->unit[c][k], 0);
            ck_assert_double_eq(p->t[c][k], was->along[k] * was->d[c][k]);
        }
    }
}
END_TEST

/* One step and its figures. */
static void step(int isa, int seed, hf_path_cables block[N_BLOCK], double figure[3])
{
    fill(block, seed);
    figure[0] = kernel[isa]->measure(N_BLOCK, block);
    kernel[isa]->set_scaling(N_BLOCK, block);
    kernel[isa]->set_side(N_BLOCK, block, 0, false);
    figure[1] = kernel[isa]->set_direction(N_BLOCK, block, true);
    kernel[isa]->set_side(N_BLOCK, block, 0.1, true);
    figure[2] = kernel[isa]->set_direction(N_BLOCK, block, false);
    kernel[isa]->move(N_BLOCK, block, 0.9 / figure[2]);
}

START_TEST(same_bits_on_every_instruction_set)
{
    hf_path_cables portable[N_BLOCK], block[N_BLOCK];
    double figure[3], other[3];
    step(HF_LANE_PORTABLE, _i, portable, figure);
    for (int isa = 1; isa < HF_LANE_N_ISA; isa++) {
        if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
        step(isa, _i, block, other);
        for (int e = 0; e < N_CABLE; e++) {
            const hf_path_cables *p = portable + e / HF_LANES, *q = block + e / HF_LANES;
            int k = e % HF_LANES;
            if (p->has_cone[k] == 0) continue;
            ck_assert_double_eq(p->T[k], q->T[k]);
            ck_assert_double_eq(p->v[k], q->v[k]);
            ck_assert_double_eq(p->along[k], q->along[k]);
            ck_assert_double_eq(p->across[k], q->across[k]);
            for (int c = 0; c < 3; c++) {
                ck_assert_double_eq(p->t[c][k], q->t[c][k]);
                ck_assert_double_eq(p->pull[c][k], q->pull[c][k]);
                ck_assert_double_eq(p->unit[c][k], q->unit[c][k]);
            }
        }
        ck_assert_int_eq(memcmp(figure, other, sizeof figure), 0);
    }
}
END_TEST

Suite *suite_unit_path_kernel(void)
{
    Suite *suite = suite_create("unit/solve/path_kernel");
    TCase *tests = tcase_create("path_kernel");
    tcase_add_loop_test(tests, equations_hold, 0, 20);
    tcase_add_test(tests, cables_without_a_cone_stay);
    tcase_add_loop_test(tests, same_bits_on_every_instruction_set, 0, 5);
    suite_add_tcase(suite, tests);
    return suite;
}
