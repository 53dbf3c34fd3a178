/* Figures of a shape as an antenna: against the far field by hf_pattern, and by laws. A smooth surface loses nothing, a
 * rigid motion changes nothing with a refocused feed, a tilt turns the beam. Bounds hold; figures without a meaning are
 * NaN; the same bits from every instruction set. */
#include "support.h"

#include "base/elementary.h"
#include "search/parallel.h"
#include "surface/antenna.h"
#include "surface/antenna_kernel.h"
#include "surface/pattern_feed.h"
#include "surface/surface_fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- reflectors ---- */

enum { SIDE_MOST = 40, NODES_MOST = (SIDE_MOST + 1) * (SIDE_MOST + 1) };

/* A grid of square facets, its middle at (middle_m, 0). */
struct dish {
    int corner[4 * SIDE_MOST * SIDE_MOST], n_node;
    double target_m[3 * NODES_MOST], position_m[3 * NODES_MOST];
    hf_facets facets;
    hf_surface_settings surface;
    hf_antenna antenna;
    double *scratch;
};
static struct dish d;

static const hf_pattern_surface shape = {&d.facets, d.position_m, NULL};

static void begin(hf_surface_kind kind, int side, double half_m, double middle_m, double focal_m)
{
    memset(&d, 0, sizeof d);
    d.facets = (hf_facets){.corner = d.corner, .n_facet = side * side};
    d.surface = (hf_surface_settings){.kind = kind, .focal_length_m = focal_m};
    d.surface.pattern =
        (hf_pattern_settings){.position_m = {NAN, NAN, NAN}, .aim_m = {NAN, NAN, NAN}, .cos_power = NAN};
    d.n_node = (side + 1) * (side + 1);
    for (int k = 0; k < d.n_node; k++) {
        double x = middle_m + half_m * (2.0 * (k % (side + 1)) / side - 1),
               y = half_m * (2.0 * (k / (side + 1)) / side - 1);
        double square = kind == HF_SURFACE_PARABOLOID ? x * x + y * y : x * x;
        memcpy(d.target_m + 3 * k, (double[]){x, y, square / (4 * focal_m)}, 3 * sizeof(double));
    }
    for (int i = 0; i < side * side; i++) {
        int a = i / side * (side + 1) + i % side;
        memcpy(d.corner + 4 * i, (int[]){a, a + 1, a + side + 2, a + side + 1}, 4 * sizeof(int));
    }
    memcpy(d.position_m, d.target_m, sizeof d.target_m);
}

static void make(double wavelength_m)
{
    ck_assert_int_eq(hf_antenna_make(&d.surface, &d.facets, d.target_m, HF_LIGHT_M_PER_S / wavelength_m, &d.antenna),
                     HF_OK);
    d.scratch = aligned_alloc(64, (hf_antenna_scratch(&d.antenna) * sizeof(double) + 127) / 64 * 64);
    ck_assert_ptr_nonnull(d.scratch);
}

static hf_antenna_figures measure(void)
{
    hf_antenna_figures f;
    ck_assert_int_eq(hf_antenna_measure(&d.antenna, HF_ANTENNA_ALL, &shape, d.scratch, &f), HF_OK);
    return f;
}

static void end(void)
{
    hf_antenna_free(&d.antenna);
    free(d.scratch);
}

/* Moves the nodes of the target surface by a rotation about the middle of the net, then by a shift. */
static void move(const double angle[3], const double shift_m[3])
{
    double by[3][3];
    hf_fit_rotation(angle, (const int[3]){0}, by);
    for (int k = 0; k < d.n_node; k++)
        for (int c = 0; c < 3; c++) {
            d.position_m[3 * k + c] = shift_m[c] + d.target_m[3 * (d.n_node / 2) + c];
            for (int e = 0; e < 3; e++)
                d.position_m[3 * k + c] += by[c][e] * (d.target_m[3 * k + e] - d.target_m[3 * (d.n_node / 2) + e]);
        }
}

static void shake(struct rng *rng, double by_m)
{
    for (int k = 0; k < 3 * d.n_node; k++)
        d.position_m[k] += rng_uniform(rng, -by_m, by_m);
}

/* ---- gain and loss ---- */

/* The errors of flat facets have the order h^2. The loss has h^4, and h^2 with a feed beside the focus. None is left
 * for a smooth surface. */
START_TEST(a_smooth_surface_loses_nothing)
{
    hf_antenna_figures f[3];
    for (int k = 0; k < 3; k++) {
        begin(_i % 2 ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER, 10 << k, 3, _i % 2 ? 3.5 : 0, 6);
        if (_i / 2) memcpy(d.surface.pattern.position_m, (double[]){0.1, 0, 6.05}, 3 * sizeof(double));
        make(0.05);
        f[k] = measure();
        end();
    }
    double left[] = {64 * f[2].fixed.gain_loss_dB - 20 * f[1].fixed.gain_loss_dB + f[0].fixed.gain_loss_dB,
                     64 * f[2].refocused.gain_loss_dB - 20 * f[1].refocused.gain_loss_dB + f[0].refocused.gain_loss_dB};
    printf("left: %.2g dB fixed, %.2g dB refocused\n", left[0] / 45, left[1] / 45);
    for (int k = 0; k < 2; k++) {
        ck_assert_double_eq_tol(left[k] / 45, 0, 1e-3);
        ck_assert_double_eq_tol(f[k].refocused.half_path_rms_m / f[k + 1].refocused.half_path_rms_m, 4, 0.1);
    }
}
END_TEST

/* The gain is that of the far field, and the beam is where its cuts have their maximum. */
START_TEST(gain_and_beam_are_those_of_the_far_field)
{
    enum { N = 201 };
    double co[N], cross[N];
    hf_far_field p;
    hf_feed feed;
    begin(_i % 2 ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER, 12, 3, _i % 2 ? 3.5 : 0.5, 6);
    if (_i >= 2) d.surface.pattern.polarisation = HF_POLARISATION_Y;
    struct rng rng = rng_start(970 + (uint64_t)_i);
    move((double[]){0, 2e-3, 0}, (double[]){1e-3, 0, 2e-3});
    shake(&rng, 1e-3);
    make(0.05);
    hf_antenna_figures f = measure();
    hf_antenna_points q = hf_antenna_points_of(&d.antenna, &shape, d.scratch);
    hf_antenna_view view;
    double s[3], theta_deg, phi_deg;
    hf_antenna_light(&d.antenna, &d.antenna.beam.feed, &q);
    memcpy(s, d.antenna.beam.feed.beam, sizeof s);
    ck_assert_int_eq(hf_feed_make(&d.surface, &d.facets, d.target_m, &feed), 0);
    ck_assert(hf_antenna_aim(&d.antenna, &q, s, &view));
    theta_deg = 180 / HF_PI * atan2(hypot(s[0], s[1]), s[2]);
    phi_deg = 180 / HF_PI * atan2(s[1], s[0]);
    ck_assert_double_eq_tol(theta_deg, f.pointing_deg, 1e-9); /* the nominal beam is along z */
    for (int k = 0; k < 3; k++) {                             /* at the nominal beam, along the tilt, across it */
        double at[2] = {k ? theta_deg - 0.02 : -0.02, k ? theta_deg + 0.02 : 0.02};
        hf_pattern_settings *set = &d.surface.pattern;
        set->theta_deg[0] = at[0];
        set->theta_deg[1] = at[1];
        set->n_theta = N;
        set->phi_deg = (hf_double_list){1, {phi_deg + (k == 2)}};
        ck_assert_int_eq(hf_pattern_create(set, &shape, &feed, HF_LIGHT_M_PER_S / 0.05, 1, &p), HF_OK);
        hf_parallel_each(1, HF_PATTERN_BLOCKS, hf_pattern_sum_block, &p);
        hf_pattern_finish(&p, co, cross);
        hf_pattern_free(&p);
        hf_cut_figures cut = hf_pattern_figures(N, at, co);
        if (k == 0) ck_assert_double_eq_tol(co[N / 2], f.fixed.gain_dBi, 1e-5);
        if (k == 1) ck_assert_double_eq_tol(cut.beam_deg, f.pointing_deg, 1e-5);
        if (k == 2) ck_assert_double_lt(cut.gain_dBi, co[N / 2] + 1e-4);
    }
    ck_assert_double_eq_tol(f.fixed.gain_loss_dB, d.antenna.smooth_dBi - f.fixed.gain_dBi, 1e-12);
    end();
}
END_TEST

/* Ruze's formula and physical optics agree for small errors of any kind, with either feed. */
START_TEST(small_errors_lose_what_ruze_says)
{
    struct rng rng = rng_start(980 + (uint64_t)_i);
    for (int trial = 0; trial < 10; trial++) {
        double size = pow(2, trial) * 1e-5;
        begin(_i % 2 ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER, 16, 3, _i % 2 ? 3.5 : 0, 6);
        move((double[]){size * rng_uniform(&rng, -0.1, 0.1), size * rng_uniform(&rng, -0.1, 0.1), 0},
             (double[]){0, 0, size * rng_uniform(&rng, -2, 2)});
        shake(&rng, size);
        make(0.05);
        hf_antenna_figures f = measure();
        end();
        if (!(f.fixed.gain_loss_dB < 1)) continue;
        ck_assert_double_eq_tol(f.fixed.ruze_loss_dB, f.fixed.gain_loss_dB, 0.002 + 0.05 * f.fixed.gain_loss_dB);
        ck_assert_double_eq_tol(f.refocused.ruze_loss_dB, f.refocused.gain_loss_dB,
                                0.002 + 0.05 * f.refocused.gain_loss_dB);
        ck_assert_double_le(f.refocused.half_path_rms_m, f.fixed.half_path_rms_m * (1 + 1e-9));
    }
}
END_TEST

/* ---- motions ---- */

START_TEST(a_refocused_feed_moves_with_the_shape)
{
    struct rng rng = rng_start(990 + (uint64_t)_i);
    begin(_i % 2 ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER, 12, 3, 3.5, 6);
    if (_i / 2) memcpy(d.surface.pattern.position_m, (double[]){0.05, 0, 6.02}, 3 * sizeof(double));
    if (_i / 2) memcpy(d.surface.pattern.aim_m, (double[]){3.4, 0, 0}, 3 * sizeof(double));
    shake(&rng, 5e-4);
    memcpy(d.target_m, d.position_m, sizeof d.target_m); /* the rough shape, which then moves */
    make(0.05);
    hf_antenna_figures still = measure();
    for (int trial = 0; trial < 8; trial++) {
        double turn[3], shift_m[3];
        for (int c = 0; c < 3; c++) {
            turn[c] = rng_uniform(&rng, -0.01, 0.01);
            shift_m[c] = rng_uniform(&rng, -0.01, 0.01);
        }
        turn[2] = 0; /* about the axis, the fit of a paraboloid is not unique, but the taper is not round */
        move(turn, shift_m);
        hf_antenna_figures moved = measure();
        ck_assert_double_eq_tol(moved.refocused.gain_dBi, still.refocused.gain_dBi, 1e-4);
        ck_assert_double_eq_tol(moved.refocused.half_path_rms_m, still.refocused.half_path_rms_m, 1e-9);
        ck_assert_double_gt(moved.fixed.gain_loss_dB, still.fixed.gain_loss_dB);
    }
    end();
}
END_TEST

/* A tilt of the reflector about its vertex turns the beam by the tilt. It also moves the feed by f times the tilt,
 * which turns the beam by nearly the tilt again (beam deviation factor 0.8 to 1). The angle is linear in the tilt. */
START_TEST(a_tilt_turns_the_beam)
{
    double first = 0;
    for (int k = 0; k < 3; k++) {
        double tilt = 2e-4 * (1 << 2 * k), by[3][3];
        begin(HF_SURFACE_PARABOLOID, 16, 3, 0, 6);
        hf_fit_rotation((double[]){_i ? tilt : 0, _i ? 0 : -tilt, 0}, (const int[3]){0}, by);
        for (int n = 0; n < d.n_node; n++)
            for (int c = 0; c < 3; c++)
                d.position_m[3 * n + c] = hf_dot3(by[c], d.target_m + 3 * n);
        make(0.05);
        hf_antenna_figures f = measure();
        double factor = f.pointing_deg * HF_PI / 180 / tilt - 1;
        if (k == 0) first = factor;
        ck_assert_double_gt(factor, 0.8);
        ck_assert_double_lt(factor, 1);
        ck_assert_double_eq_tol(factor, first, 1e-3);
        end();
    }
}
END_TEST

/* ---- bounds ---- */

/* Random motions of the nodes, and those by which a figure changes most, stay within the bounds. */
START_TEST(bounds_hold)
{
    const double delta = 1e-7;
    hf_antenna_figures bound;
    struct rng rng = rng_start(1000 + (uint64_t)_i);
    begin(_i % 2 ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER, 4, 3, _i % 2 ? 3.5 : 0, 6);
    make(0.3);
    shake(&rng, 1e-3);
    hf_antenna_figures is = measure();
    ck_assert_int_eq(hf_antenna_bound(&d.antenna, HF_ANTENNA_ALL, &shape, delta, &bound), HF_OK);
    static double sum[9];
    memset(sum, 0, sizeof sum);
    const double *from = (const double *)&is, *most = (const double *)&bound;
    for (int n = 0; n < d.n_node; n++) { /* the sum over all nodes of the largest change by one of them */
        double square[9] = {0};
        for (int c = 0; c < 3; c++) {
            hf_antenna_figures moved[2];
            double keep_m = d.position_m[3 * n + c];
            for (int side = 0; side < 2; side++) {
                d.position_m[3 * n + c] = keep_m + (side ? 1e-6 : -1e-6);
                moved[side] = measure();
            }
            d.position_m[3 * n + c] = keep_m;
            for (int k = 0; k < 9; k++) {
                double rate = (((double *)&moved[1])[k] - ((double *)&moved[0])[k]) / 2e-6;
                square[k] += rate * rate;
            }
        }
        for (int k = 0; k < 9; k++)
            sum[k] += delta * sqrt(square[k]);
    }
    for (int k = 0; k < 9; k++) {
        ck_assert_double_ge(most[k], sum[k] * 0.999);
        ck_assert_double_le(most[k], fmax(100 * sum[k], delta));
        ck_assert(isfinite(from[k]));
    }
    end();
}
END_TEST

/* ---- derivatives ---- */

static double figure_of(unsigned group)
{
    hf_antenna_figures f;
    ck_assert_int_eq(hf_antenna_measure(&d.antenna, group, &shape, d.scratch, &f), HF_OK);
    return group == HF_ANTENNA_REFOCUSED ? f.refocused.gain_dBi
           : group == HF_ANTENNA_FIXED   ? f.fixed.gain_dBi
                                         : f.pointing_deg;
}

/* Compares the gradient of the figure of a group along a way with differences of five points. */
static void compare_along(unsigned group, const double *gradient, const double *way, double step_m, double agreement)
{
    static double start_m[3 * NODES_MOST];
    double at[5], rate = 0, size = 0;
    memcpy(start_m, d.position_m, sizeof start_m);
    for (int i = 0; i < 3 * d.n_node; i++) {
        rate += gradient[i] * way[i];
        size += fabs(gradient[i] * way[i]);
    }
    for (int side = -2; side <= 2; side++) {
        for (int i = 0; i < 3 * d.n_node; i++)
            d.position_m[i] = start_m[i] + side * step_m * way[i];
        at[side + 2] = figure_of(group);
    }
    memcpy(d.position_m, start_m, sizeof start_m);
    double found = (8 * (at[3] - at[1]) - (at[4] - at[0])) / (12 * step_m);
    ck_assert_msg(fabs(found - rate) < agreement * size, "group %u: %.12g, not %.12g: %g of %g", group, rate, found,
                  fabs(found - rate) / size, size);
}

/* The derivatives along random motions of the nodes are those of differences. A best fit ends at 1e-11 of its sum of
 * squares, which moves the refocused gain by up to 1e-7 dB, most where a shift and a turn nearly cancel. With fits that
 * end at 1e-28, these differences agree to 1e-10, too. */
START_TEST(derivatives_are_those_of_differences)
{
    static const unsigned group[] = {HF_ANTENNA_FIXED, HF_ANTENNA_REFOCUSED, HF_ANTENNA_POINTING};
    static const double step_m[] = {1e-4, 5e-4, 1e-4};
    static double gradient[3 * NODES_MOST], way[3 * NODES_MOST];
    struct rng rng = rng_start(1100 + (uint64_t)_i);
    hf_antenna near;
    bool exists, is_plane_wave = _i >= 8; /* its beam is too wide for a pointing */
    begin(_i % 2 ? HF_SURFACE_PARABOLIC_CYLINDER : HF_SURFACE_PARABOLOID, 4, 3, _i / 2 % 2 ? 3.5 : 0, 6);
    d.surface.pattern.feed = is_plane_wave ? HF_FEED_PLANE_WAVE : HF_FEED_AUTO;
    d.surface.pattern.polarisation = _i / 4 % 2 ? HF_POLARISATION_Y : HF_POLARISATION_X;
    make(0.3);
    move((const double[]){0.002, -0.003, 0}, (const double[]){0.001, 0.002, -0.003});
    shake(&rng, 1e-4);
    ck_assert_int_eq(hf_antenna_near(&d.antenna, &shape, d.scratch, &near), HF_OK);
    d.antenna.start = near.start;
    const double agreement[] = {1e-8, _i % 4 == 2 ? 1e-5 : 1e-4, 1e-8};
    for (int k = 0; k < (is_plane_wave ? 1 : 3); k++) {
        ck_assert_int_eq(hf_antenna_gradient(&d.antenna, group[k], &shape, d.n_node, gradient, &exists), HF_OK);
        ck_assert(exists);
        for (int trial = 0; trial < 3; trial++) {
            for (int i = 0; i < 3 * d.n_node; i++)
                way[i] = rng_uniform(&rng, -1, 1);
            compare_along(group[k], gradient, way, step_m[k], agreement[k]);
        }
    }
    end();
}
END_TEST

/* Points of a surface with another apex and focal length, whose fits hold parameters at bounds or leave them out. */
START_TEST(derivatives_follow_a_fit_of_some_parameters)
{
    static const struct {
        double apex_m[2], slide_m, middle_m, longer;
        int n;
    } of[] = {{{0.1, 0.1}, 0, 0, 0.4, 5}, {{0.7, 0}, 0, 3.5, 1, 4}, {{0, 0}, 0.4, 4, 1, 5}, {{0.7, 0.8}, 0, 0, 1, 4}};
    static double gradient[3 * NODES_MOST], way[3 * NODES_MOST];
    struct rng rng = rng_start(1150 + (uint64_t)_i);
    hf_antenna near;
    bool exists;
    begin(HF_SURFACE_PARABOLOID, of[_i].slide_m > 0 ? 32 : 8, 3, of[_i].middle_m, 6);
    make(3);
    for (int i = 0; i < d.n_node; i++) {
        double *p = d.position_m + 3 * (size_t)i, middle_m = of[_i].middle_m;
        p[0] = middle_m + (p[0] - middle_m) * (1.2 - 0.02 * p[1] * p[1]); /* so that one point is farthest out */
        double x = p[0] - of[_i].apex_m[0], y = p[1] - of[_i].apex_m[1];
        p[2] = (x * x + y * y) / (4 * 6 * of[_i].longer);
        p[0] += of[_i].slide_m;
    }
    shake(&rng, 1e-4);
    ck_assert_int_eq(hf_antenna_near(&d.antenna, &shape, d.scratch, &near), HF_OK);
    d.antenna.start = near.start;
    ck_assert_int_eq(near.start.n, of[_i].n);
    ck_assert_int_eq(hf_antenna_gradient(&d.antenna, HF_ANTENNA_REFOCUSED, &shape, d.n_node, gradient, &exists), HF_OK);
    ck_assert(exists);
    for (int trial = 0; trial < 4; trial++) {
        for (int i = 0; i < 3 * d.n_node; i++) /* the last way stretches the net, and thus moves the bounds */
            way[i] = trial < 3 ? rng_uniform(&rng, -1, 1) : i % 3 < 2 ? d.position_m[i] / 3 : 0;
        compare_along(HF_ANTENNA_REFOCUSED, gradient, way, 1e-4, 1e-4);
    }
    end();
}
END_TEST

/* ---- figures without a meaning ---- */

START_TEST(figures_without_a_meaning_are_missing)
{
    hf_antenna_figures f;
    begin(HF_SURFACE_PARABOLOID, 4, 3, 0, 6);
    make(0.002); /* the facets are far too coarse */
    ck_assert(d.antenna.is_too_coarse);
    f = measure();
    for (int k = 0; k < 9; k++)
        ck_assert(isnan(((double *)&f)[k]));
    end();
    struct rng rng = rng_start(1010);
    begin(HF_SURFACE_PARABOLOID, 16, 3, 0, 6);
    make(0.05);
    shake(&rng, 0.02); /* rough as the wave: no beam is left, and Ruze's formula does not hold */
    f = measure();
    ck_assert(isnan(f.pointing_deg));
    ck_assert(isnan(f.fixed.ruze_loss_dB) && isnan(f.refocused.ruze_loss_dB));
    ck_assert_double_gt(f.fixed.gain_loss_dB, 3);
    ck_assert(isfinite(f.fixed.gain_loss_dB) && isfinite(f.refocused.gain_loss_dB));
    end();
}
END_TEST

/* ---- kernels ---- */

START_TEST(instruction_sets_change_no_bit)
{
    static const hf_antenna_kernels *const kernel[] = {HF_LANE_EACH(&hf_antenna_kernels)};
    enum { N = 808 };
    static _Alignas(64) double x[6 * N], current[2][3 * N], path_m[2][N];
    struct rng rng = rng_start(1020);
    double e[2][3] = {{1, 0, 0}, {0, 1, 0}}, sum[2][3], co[3] = {1, 0, 0}, center[3] = {0.1, 0.2, 0.3};
    hf_antenna_sums sums[2];
    for (int kind = HF_FEED_POINT; kind <= HF_FEED_PLANE_WAVE; kind++) {
        hf_feed feed = {.kind = (hf_feed_kind)kind,
                        .position_m = {0, 0, 5},
                        .axis = {0, 0, -1},
                        .co = {1, 0, 0},
                        .cos_power = 2.3,
                        .beam = {0, 0, 1}};
        for (int i = 0; i < N; i++) {
            for (int c = 0; c < 6; c++)
                x[c * N + i] = c == 5 ? rng_uniform(&rng, -0.1, 1) : rng_uniform(&rng, -3, 3);
            if (i % 10 == 0) x[2 * N + i] = rng_uniform(&rng, 5, 6); /* behind the feed */
        }
        for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
            int to = isa > 0;
            if (!hf_lane_has_isa((hf_lane_isa)isa)) {
                skip_for_machine("unit/antenna", hf_lane_isa_name((hf_lane_isa)isa));
                continue;
            }
            kernel[isa]->light(&feed, co, 0.05, N, x, current[to], path_m[to], sum[to]);
            kernel[isa]->look(feed.beam, e, co, center, 0.05, N, x, current[to], path_m[to], &sums[to]);
            ck_assert_mem_eq(current[0], current[to], sizeof current[0]);
            ck_assert_mem_eq(path_m[0], path_m[to], sizeof path_m[0]);
            ck_assert_mem_eq(sum[0], sum[to], sizeof sum[0]);
            ck_assert_mem_eq(&sums[0], &sums[to], sizeof sums[0]);
        }
        for (int i = 0; i < N; i++) { /* the reference */
            double p[3] = {x[i], x[N + i], x[2 * N + i]}, up[3] = {x[3 * N + i], x[4 * N + i], x[5 * N + i]};
            double toward[3], field[3], c[3] = {0};
            ck_assert_double_eq_tol(hf_feed_light(&feed, p, toward, field), path_m[0][i], 1e-14);
            if (hf_dot3(toward, up) < 0) hf_cross(up, field, c);
            for (int k = 0; k < 3; k++)
                ck_assert_double_eq_tol(2 * c[k], current[0][k * N + i], 1e-13 * (1 + fabs(c[k])));
        }
    }
}
END_TEST

START_TEST(memory_may_fail)
{
    hf_antenna a;
    begin(HF_SURFACE_PARABOLOID, 4, 3, 0, 6);
    for (int n = 1;; n++) {
        fail_allocation_at(n);
        hf_status status = hf_antenna_make(&d.surface, &d.facets, d.target_m, HF_LIGHT_M_PER_S / 0.1, &a);
        bool has_failed = end_allocation_failure();
        hf_antenna_free(&a);
        ck_assert_int_eq(status, has_failed ? HF_NO_MEMORY : HF_OK);
        if (!has_failed) break;
    }
}
END_TEST

Suite *suite_unit_antenna(void)
{
    Suite *suite = suite_create("unit/antenna");
    TCase *tcase = tcase_create("antenna");
    tcase_add_loop_test(tcase, a_smooth_surface_loses_nothing, 0, 4);
    tcase_add_loop_test(tcase, gain_and_beam_are_those_of_the_far_field, 0, 4);
    tcase_add_loop_test(tcase, small_errors_lose_what_ruze_says, 0, 4);
    tcase_add_loop_test(tcase, a_refocused_feed_moves_with_the_shape, 0, 4);
    tcase_add_loop_test(tcase, a_tilt_turns_the_beam, 0, 2);
    tcase_add_loop_test(tcase, bounds_hold, 0, 2);
    tcase_add_loop_test(tcase, derivatives_are_those_of_differences, 0, 12);
    tcase_add_loop_test(tcase, derivatives_follow_a_fit_of_some_parameters, 0, 4);
    tcase_add_test(tcase, figures_without_a_meaning_are_missing);
    tcase_add_test(tcase, instruction_sets_change_no_bit);
    tcase_add_test(tcase, memory_may_fail);
    suite_add_tcase(suite, tcase);
    return suite;
}
