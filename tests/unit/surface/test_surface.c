/* Measures of the surface, each compared with its definition written out again; the best fit of known motions. */
#include "laws.h"

#include "surface/cloud.h"
#include "surface/surface_near.h"

/* ---- the best fit ---- */

static hf_status fit_nodes(double focal_length_m, int n, const double *position_m, hf_surface_fit *fit)
{
    return hf_surface_fit_points(HF_SURFACE_PARABOLIC_CYLINDER, focal_length_m, n, position_m, NULL, fit);
}

/* Rx(a) Ry(b) Rz(c) p, by the textbook. */
static void turn(const double angle[3], const double p[3], double to[3])
{
    double q[3] = {p[0], p[1], p[2]};
    for (int k = 2; k >= 0; k--) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double u = q[i], v = q[j], c = cos(angle[k]), s = sin(angle[k]);
        q[i] = c * u - s * v;
        q[j] = s * u + c * v;
    }
    memcpy(to, q, sizeof q);
}

/* A grid of the cylinder, aperture 10 m, length 12 m, of another focal length, turned about the origin and shifted. */
enum { NX = 13, NY = 9, N_GRID = NX * NY };

static void moved_grid(double focal_length_m, const double angle[3], const double shift[3], double *position_m)
{
    for (int k = 0; k < N_GRID; k++) {
        double x = -5 + 10.0 * (k % NX) / (NX - 1), p[3] = {x, 12.0 * (k / NX) / (NY - 1), x * x / 4 / focal_length_m};
        double q[3];
        turn(angle, p, q);
        for (int c = 0; c < 3; c++)
            position_m[c * N_GRID + k] = q[c] + shift[c];
    }
}

/* The fit turns about another centre, and knows no shift along the generatrix: where it puts a point of the wanted
 * surface may differ from where the motion put it, but only along the moved generatrix g. */
static double difference_from(const hf_surface_fit *fit, const double angle[3], const double shift[3])
{
    static const double corner[4][3] = {{0, 0, 0}, {5, 0, 0}, {0, 12, 0}, {0, 0, 3}}, y[3] = {0, 1, 0};
    double turned[3] = {fit->rotation_x_rad, fit->rotation_y_rad, fit->rotation_z_rad}, g[3], most = 0;
    double center[3] = {fit->center_x_m, fit->center_y_m, fit->center_z_m};
    turn(angle, y, g);
    for (int k = 0; k < 4; k++) {
        double from[3], a[3], b[3], along = 0;
        for (int c = 0; c < 3; c++)
            from[c] = corner[k][c] - center[c];
        turn(turned, from, a);
        turn(angle, corner[k], b);
        a[0] += fit->shift_x_m;
        a[2] += fit->shift_z_m;
        for (int c = 0; c < 3; c++) {
            a[c] += center[c] - b[c] - shift[c];
            along += a[c] * g[c];
        }
        for (int c = 0; c < 3; c++)
            most = fmax(most, fabs(a[c] - along * g[c]));
    }
    return most;
}

static const struct {
    double focal_length_m, found_m, angle[3], shift[3], tolerance;
} motions[] = {
    {5, 5, {0}, {0}, 1e-12},
    {5, 5.3, {0}, {0}, 1e-9},
    {5, 4.9, {0.01, -0.02, 0.015}, {0.05, 0.3, -0.04}, 1e-9},
    {7.2, 7.25, {-0.003, 0.001, 0.002}, {-0.01, 0.02, 0.03}, 1e-9},
    /* shift and turn about y are the same to a part of x^2/(8 f^2), here 6e-4: the 1e-15 m of the coordinates of some
     * metres, over 6e-4 x/(2f) = 2e-5, and as much again for the solution of a least-squares problem */
    {70.6, 70, {0.001, 0.0005, 0.001}, {0.01, 0, 0.01}, 1e-9},
};
enum { N_MOTION = sizeof motions / sizeof *motions };

START_TEST(known_motion_and_focal_length_are_recovered)
{
    double position_m[3 * N_GRID];
    hf_surface_fit fit;
    moved_grid(motions[_i].found_m, motions[_i].angle, motions[_i].shift, position_m);
    ck_assert_int_eq(fit_nodes(motions[_i].focal_length_m, N_GRID, position_m, &fit), HF_OK);
    ck_assert_double_eq_tol(fit.focal_length_m, motions[_i].found_m, motions[_i].tolerance * motions[_i].found_m);
    ck_assert_double_lt(difference_from(&fit, motions[_i].angle, motions[_i].shift), motions[_i].tolerance);
    ck_assert_double_lt(fit.half_path_rms_m, 1e-14); /* rounding of coordinates of a few metres */
    ck_assert_double_lt(fit.normal_rms_m, 1e-14);
    ck_assert(fit.converged);
    ck_assert_int_lt(fit.iterations, 60);
}
END_TEST

/* A paraboloid of revolution: apertures about the axis and beside it. The turn about its axis is not to be seen; axis,
 * vertex and focal length are. */
static const struct {
    double focal_length_m, found_m, middle_m, angle[3], shift[3];
} round_motions[] = {
    {5, 5, 0, {0}, {0}},
    {5, 5.3, 0, {0}, {0}},
    {5, 4.9, 0, {0.01, -0.02, 0.015}, {0.05, 0.1, -0.04}},
    {5, 5.1, 7, {0.003, -0.002, 0.015}, {0.02, -0.03, 0.05}},
};
enum { N_ROUND_MOTION = sizeof round_motions / sizeof *round_motions };

START_TEST(known_paraboloid_is_recovered)
{
    double p[3 * N_GRID], axis[2][3], vertex[2][3], zero[3] = {0}, z[3] = {0, 0, 1}, from[3];
    double f = round_motions[_i].found_m;
    hf_surface_fit fit;
    for (int k = 0; k < N_GRID; k++) {
        double x = round_motions[_i].middle_m - 3 + 6.0 * (k % NX) / (NX - 1), y = -3 + 6.0 * (k / NX) / (NY - 1);
        double q[3];
        turn(round_motions[_i].angle, (double[]){x, y, (x * x + y * y) / (4 * f)}, q);
        for (int c = 0; c < 3; c++)
            p[c * N_GRID + k] = q[c] + round_motions[_i].shift[c];
    }
    ck_assert_int_eq(
        hf_surface_fit_points(HF_SURFACE_PARABOLOID, round_motions[_i].focal_length_m, N_GRID, p, NULL, &fit), HF_OK);
    ck_assert(fit.converged);
    ck_assert_double_eq_tol(fit.focal_length_m, f, 1e-9);
    ck_assert_double_lt(fit.half_path_rms_m, 1e-14); /* rounding, as above */
    ck_assert_double_lt(fit.normal_rms_m, 1e-14);
    ck_assert_double_eq(fit.rotation_z_rad, 0);
    const double turned[3] = {fit.rotation_x_rad, fit.rotation_y_rad, fit.rotation_z_rad};
    const double center[3] = {fit.center_x_m, fit.center_y_m, fit.center_z_m};
    const double moved[3] = {fit.shift_x_m, fit.shift_y_m, fit.shift_z_m};
    turn(round_motions[_i].angle, z, axis[0]);
    turn(turned, z, axis[1]);
    turn(round_motions[_i].angle, zero, vertex[0]);
    for (int c = 0; c < 3; c++)
        from[c] = -center[c];
    turn(turned, from, vertex[1]);
    for (int c = 0; c < 3; c++) {
        ck_assert_double_eq_tol(axis[0][c], axis[1][c], 1e-9);
        ck_assert_double_eq_tol(vertex[0][c] + round_motions[_i].shift[c], vertex[1][c] + center[c] + moved[c], 1e-8);
    }
}
END_TEST

/* Points of weight two are points that are there twice. */
START_TEST(weights_count_points)
{
    double p[3 * N_GRID], root[N_GRID], twice[2 * 3 * N_GRID];
    struct rng rng = rng_start(440 + (uint64_t)_i);
    hf_surface_kind kind = _i ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER;
    hf_surface_fit one, two;
    int n = 0;
    for (int k = 0; k < N_GRID; k++) {
        p[k] = rng_uniform(&rng, -3, 3);
        p[N_GRID + k] = rng_uniform(&rng, -3, 3);
        p[2 * N_GRID + k] = (p[k] * p[k] + _i * p[N_GRID + k] * p[N_GRID + k]) / 21 + rng_uniform(&rng, -3e-3, 3e-3);
        root[k] = k % 2 ? 1 : sqrt(2);
        n += k % 2 ? 1 : 2;
    }
    for (int c = 0, at = 0; c < 3; c++)
        for (int k = 0; k < N_GRID; k++)
            for (int copy = k % 2; copy < 2; copy++)
                twice[at++] = p[c * N_GRID + k];
    ck_assert_int_eq(hf_surface_fit_points(kind, 5, N_GRID, p, root, &one), HF_OK);
    ck_assert_int_eq(hf_surface_fit_points(kind, 5, n, twice, NULL, &two), HF_OK);
    ck_assert(one.converged && two.converged);
    ck_assert_double_eq_tol(one.focal_length_m, two.focal_length_m, 1e-7);
    ck_assert_double_eq_tol(one.half_path_rms_m, two.half_path_rms_m, 1e-13);
    ck_assert_double_eq_tol(one.normal_rms_m, two.normal_rms_m, 1e-10);
    ck_assert_double_gt(one.half_path_rms_m, 1e-3);
}
END_TEST

/* With noise on top the answer is a minimum: no small change of any parameter lowers the half-path RMS. It is looked at
 * through the public call: a fit that starts from another wanted focal length ends in the same place. */
START_TEST(fit_of_a_rough_surface_is_a_minimum)
{
    double position_m[3 * N_GRID];
    static const double angle[3] = {0.002, -0.004, 0.001}, shift[3] = {0.02, 0, 0.01};
    struct rng rng = rng_start(400 + (uint64_t)_i);
    hf_surface_fit one, other;
    moved_grid(5.1, angle, shift, position_m);
    for (int k = 0; k < N_GRID; k++)
        position_m[2 * N_GRID + k] += rng_uniform(&rng, -0.003, 0.003);
    ck_assert_int_eq(fit_nodes(5, N_GRID, position_m, &one), HF_OK);
    ck_assert_int_eq(fit_nodes(5.4, N_GRID, position_m, &other), HF_OK);
    ck_assert_double_eq_tol(one.focal_length_m, other.focal_length_m, 1e-7);
    ck_assert_double_eq_tol(one.half_path_rms_m, other.half_path_rms_m, 1e-13);
    ck_assert_double_gt(one.half_path_rms_m, 0.5 * 0.003 / sqrt(3)); /* that of the noise, less six of 117 parts */
    ck_assert_double_lt(one.half_path_rms_m, 1.2 * 0.003 / sqrt(3));
    ck_assert_double_gt(one.normal_rms_m, one.half_path_rms_m); /* its weights are the larger ones */
}
END_TEST

START_TEST(few_nodes_are_no_fault)
{
    static const double position_m[] = {0, 1, 0, 1, 0, 0.3};
    hf_surface_fit fit;
    ck_assert_int_eq(fit_nodes(5, 2, position_m, &fit), HF_OK);
    ck_assert_double_lt(fit.half_path_rms_m, 1e-9);
    ck_assert_int_eq(fit_nodes(5, 1, position_m, &fit), HF_OK);
    ck_assert(isfinite(fit.focal_length_m));
    ck_assert(fit.converged);
}
END_TEST

/* Eight nodes within +-1.2 m, off by up to 2 mm: they do not determine a shift in x apart from a turn about y, and an
 * unguarded fit ends metres away. Their heights are up to 72 mm, so that f is known to some 2 mm/72 mm; both starts end
 * in one place, as above. */
START_TEST(fit_of_few_rough_nodes_stays)
{
    enum { N = 8 };
    double p[3 * N];
    struct rng rng = rng_start(420 + (uint64_t)_i);
    hf_surface_fit one, other;
    for (int k = 0; k < N; k++) {
        p[k] = -1.2 + 0.8 * (k % 4);
        p[N + k] = k / 4 * 1.3;
        p[2 * N + k] = p[k] * p[k] / 20 + rng_uniform(&rng, -0.002, 0.002);
    }
    ck_assert_int_eq(fit_nodes(5, N, p, &one), HF_OK);
    ck_assert_int_eq(fit_nodes(5.4, N, p, &other), HF_OK);
    ck_assert(one.converged && other.converged);
    ck_assert_double_eq_tol(one.focal_length_m, 5, 0.5);
    ck_assert_double_lt(fabs(one.shift_x_m), 0.13);
    ck_assert_double_eq_tol(one.focal_length_m, other.focal_length_m, 1e-7);
    ck_assert_double_eq_tol(one.half_path_rms_m, other.half_path_rms_m, 1e-13);
}
END_TEST

/* Two lines along y, off by up to 5 mm, do not determine a focal length apart from a shift along z. */
START_TEST(fit_of_two_lines_keeps_the_focal_length)
{
    enum { N = 8 };
    double p[3 * N];
    hf_surface_fit fit;
    for (int i = 0; i < 20; i++) {
        struct rng rng = rng_start(430 + (uint64_t)i);
        for (int k = 0; k < N; k++) {
            p[k] = k % 2 ? 0.7 : -0.7;
            p[N + k] = k / 2 * 0.8;
            p[2 * N + k] = 0.05 + rng_uniform(&rng, -0.005, 0.005);
        }
        ck_assert_int_eq(fit_nodes(5, N, p, &fit), HF_OK);
        ck_assert(fit.converged);
        ck_assert_double_lt(fit.half_path_rms_m, 0.005);
        ck_assert_double_eq_tol(fit.shift_z_m, 0.0255, 0.02); /* 0.05 - 0.7^2/20 */
        ck_assert(fit.focal_length_m >= 2.5 && fit.focal_length_m <= 10);
    }
}
END_TEST

/* No number to fit: told as not converged, never as a perfect surface. */
START_TEST(fit_without_an_answer_has_no_value)
{
    static const double position_m[] = {0, 1, 2, 0, 1, 0, NAN, 0.3, 0.2};
    hf_surface_fit fit;
    ck_assert_int_eq(fit_nodes(5, 3, position_m, &fit), HF_OK);
    ck_assert(!fit.converged);
    ck_assert(isnan(fit.half_path_rms_m) && isnan(fit.focal_length_m) && isnan(fit.rotation_z_rad));
}
END_TEST

/* ---- the fit from one nearby ---- */

/* Points of a rough surface over 6 m by 6 m about x = middle_m: off by up to rough_m. */
static void rough_points(struct rng *rng, hf_surface_kind kind, double focal_length_m, double middle_m, double rough_m,
                         double *p, double *root)
{
    for (int k = 0; k < N_GRID; k++) {
        double x = middle_m - 3 + 6.0 * (k % NX) / (NX - 1), y = -3 + 6.0 * (k / NX) / (NY - 1);
        double square = x * x + (kind == HF_SURFACE_PARABOLOID ? y * y : 0);
        p[k] = x + rng_uniform(rng, -rough_m, rough_m);
        p[N_GRID + k] = y + rng_uniform(rng, -rough_m, rough_m);
        p[2 * N_GRID + k] = square / (4 * focal_length_m) + rng_uniform(rng, -rough_m, rough_m);
        root[k] = rng_uniform(rng, 0.5, 1.5);
    }
}

static hf_surface_pose pose_of(hf_surface_kind kind, double focal_length_m, const double *p, const double *root)
{
    hf_surface_fit fit;
    hf_fit_parameters parameters;
    ck_assert_int_eq(hf_surface_fit_find(kind, focal_length_m, N_GRID, p, root, &fit, &parameters), HF_OK);
    return hf_surface_pose_of(kind, focal_length_m, &fit, &parameters);
}

/* Of both kinds, flat and deep, about the axis and beside it, with weights and without: a net that is moved, turned and
 * bent has from the fit of another the RMS that the reference finds from the wanted surface. Both end where the sum of
 * squares is within rounding of its least. Where noise of 1 mm or 1 cm hardly lets a fit tell a shift from a turn, the
 * reference may be left to find it. */
START_TEST(fit_from_one_nearby_is_the_reference)
{
    static const double focal_m[] = {3, 5, 12}, middle_m[] = {0, 4}, rough_m[] = {1e-5, 1e-3, 1e-2};
    double p[3 * N_GRID], q[3 * N_GRID], root[N_GRID], most = 0;
    int n_found = 0;
    struct rng rng = rng_start(450 + (uint64_t)_i);
    hf_surface_kind kind = _i % 2 ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER;
    for (int trial = 0; trial < 18; trial++) {
        double f = focal_m[trial % 3], rough = rough_m[trial / 3 % 3], found;
        const double *by = _i / 2 ? root : NULL, shift[3] = {0.5 * rough, -rough, 2 * rough};
        const double angle[3] = {0.3 * rough, -0.2 * rough, 0.5 * rough};
        hf_surface_fit fit;
        rough_points(&rng, kind, 1.01 * f, middle_m[trial / 9], rough, p, root);
        hf_surface_pose pose = pose_of(kind, f, p, by);
        for (int k = 0; k < N_GRID; k++) {
            double from[3] = {p[k], p[N_GRID + k], p[2 * N_GRID + k]}, to[3];
            turn(angle, from, to);
            for (int c = 0; c < 3; c++)
                q[c * N_GRID + k] = to[c] + shift[c] + rng_uniform(&rng, -rough, rough);
        }
        ck_assert_int_eq(hf_surface_fit_points(kind, f, N_GRID, q, by, &fit), HF_OK);
        bool is_found = hf_surface_fit_near(&pose, N_GRID, q, by, &found);
        ck_assert(is_found || rough > 1e-5);
        if (is_found) most = fmax(most, fabs(found / fit.half_path_rms_m - 1));
        n_found += is_found;
    }
    printf("%d of 18 fits from one nearby, off by %.3g at most\n", n_found, most);
    ck_assert_int_gt(n_found, 6);
    ck_assert_double_lt(most, 1e-9);
}
END_TEST

/* What the reference might take for undetermined, or what does not settle, is left to it. */
START_TEST(fit_from_one_nearby_knows_its_end)
{
    double p[3 * N_GRID], q[3 * N_GRID], root[N_GRID], found;
    struct rng rng = rng_start(460);
    hf_surface_kind kind = HF_SURFACE_PARABOLOID;
    rough_points(&rng, kind, 5, 0, 1e-3, p, root);
    hf_surface_pose pose = pose_of(kind, 5, p, root);
    ck_assert(hf_surface_fit_near(&pose, N_GRID, p, root, &found));
    for (int step = 1; step < 3; step++) { /* the fits shift by 0.13 and 0.28 m; the reference allows 0.3 m */
        for (int k = 0; k < N_GRID; k++)
            q[k] = p[k] + 0.16 * step;
        memcpy(q + N_GRID, p + N_GRID, 2 * N_GRID * sizeof *q);
        hf_surface_pose moved = pose_of(kind, 5, q, root);
        ck_assert_int_eq(moved.n, HF_FIT_N_PARAMETER);
        ck_assert(hf_surface_fit_near(&moved, N_GRID, q, root, &found) == (step == 1));
    }
    rough_points(&rng, kind, 8.5, 0, 1e-3, q, root);
    ck_assert(!hf_surface_fit_near(&pose, N_GRID, q, root, &found));
    memcpy(q, p, sizeof q);
    q[5] = NAN;
    ck_assert(!hf_surface_fit_near(&pose, N_GRID, q, root, &found));
    pose.n = 0;
    ck_assert(!hf_surface_fit_near(&pose, N_GRID, p, root, &found));
    double few[12] = {0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0.1};
    hf_surface_fit fit;
    hf_fit_parameters parameters;
    ck_assert_int_eq(hf_surface_fit_find(kind, 5, 4, few, NULL, &fit, &parameters), HF_OK);
    pose = hf_surface_pose_of(kind, 5, &fit, &parameters);
    ck_assert(pose.n < HF_FIT_N_PARAMETER || !hf_surface_fit_near(&pose, 4, few, NULL, &found));
}
END_TEST

/* ---- the fit at its bounds ---- */

/* Points of an offset paraboloid beside its axis, shifted by shift_m along x. Its size is 3 m, so that a fit may shift
 * by 0.3 m. */
static void shifted_points(double shift_m, double rough_m, double *p, double *root)
{
    struct rng rng = rng_start(470);
    rough_points(&rng, HF_SURFACE_PARABOLOID, 5, 4, rough_m, p, root);
    for (int k = 0; k < N_GRID; k++)
        p[k] += shift_m;
}

/* Points that determine a shift beyond its bound have a fit with the shift at this bound, the best one of those within
 * the bounds. The RMS has no jump where the shift reaches its bound. */
START_TEST(fit_holds_a_shift_at_its_bound)
{
    double p[3 * N_GRID], root[N_GRID], before_m = 0;
    for (double shift_m = 0.28; shift_m < 0.36; shift_m += 2e-3) {
        hf_surface_fit fit;
        hf_fit_parameters found;
        shifted_points(shift_m, 1e-4, p, root);
        ck_assert_int_eq(hf_surface_fit_find(HF_SURFACE_PARABOLOID, 5, N_GRID, p, root, &fit, &found), HF_OK);
        ck_assert(fit.converged);
        ck_assert_int_eq(found.n + found.n_held, HF_FIT_N_PARAMETER);
        bool is_held = found.n_held > 0;
        ck_assert(fabs(shift_m - 0.3) < 0.01 || is_held == (shift_m > 0.3)); /* errors move the minimum, too */
        if (is_held) ck_assert_double_eq_tol(fit.shift_x_m, 0.1 * found.size_m, 1e-12);
        if (before_m > 0) ck_assert_double_eq_tol(fit.half_path_rms_m, before_m, 2e-5);
        before_m = fit.half_path_rms_m;
    }
    ck_assert_double_gt(before_m, 1e-5);
}
END_TEST

/* Errors of the points that move the minimum beyond the bounds do not hold a fit there: neither a shift by noise, nor
 * that of a few points, nor the focal length of two lines. */
START_TEST(fit_holds_nothing_because_of_errors)
{
    double p[3 * N_GRID], root[N_GRID];
    hf_surface_fit fit;
    hf_fit_parameters found;
    struct rng rng = rng_start(480 + (uint64_t)_i);
    hf_surface_kind kind = _i % 2 ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER;
    int n_left = 0;
    for (int i = 0; i < 20; i++) {
        rough_points(&rng, kind, 8, 0, 0.03, p, root);
        ck_assert_int_eq(hf_surface_fit_find(kind, 8, N_GRID, p, root, &fit, &found), HF_OK);
        ck_assert_int_eq(found.n_held, 0);
        n_left += found.n < HF_FIT_N_PARAMETER;
    }
    ck_assert_int_gt(n_left, 0);
    enum { FEW = 20 };
    shifted_points(0.35, 1e-6, p, root);
    for (int d = 0; d < 3; d++)
        memmove(p + d * FEW, p + d * N_GRID, FEW * sizeof *p);
    ck_assert_int_eq(hf_surface_fit_find(HF_SURFACE_PARABOLOID, 5, FEW, p, NULL, &fit, &found), HF_OK);
    ck_assert_int_eq(found.n_held, 0);
}
END_TEST

/* The derivatives of the residuals are those of differences, whether the fit is free, its shift is at its bound,
 * which moves with the points, or its focal length is at its bound, too. */
START_TEST(derivatives_know_the_bounds_of_the_fit)
{
    static const double shift_m[] = {0.1, 0.33, 0}, focal_m[] = {5, 5, 2.3}, step = 1e-5;
    double p[3 * N_GRID], root[N_GRID], move[3 * N_GRID], there[3 * N_GRID];
    double residual[N_GRID], plus[N_GRID], minus[N_GRID], rate[N_GRID];
    int row[N_GRID];
    hf_arena arena = {0};
    hf_cloud cloud = {.kind = HF_SURFACE_PARABOLOID,
                      .focal_length_m = focal_m[_i],
                      .along = HF_ALONG_HALF_PATH,
                      .feed = HF_REFOCUSED,
                      .n_node = N_GRID,
                      .n = N_GRID,
                      .row = row};
    struct rng rng = rng_start(490 + (uint64_t)_i);
    hf_cloud_lay_out(&arena, &cloud);
    ck_assert_int_eq(hf_arena_allocate(&arena), HF_OK);
    hf_cloud_lay_out(&arena, &cloud);
    shifted_points(shift_m[_i], 1e-3, p, root);
    for (int k = 0; k < N_GRID; k++)
        row[k] = k;
    for (int k = 0; k < 3 * N_GRID; k++)
        move[k] = rng_uniform(&rng, -1, 1);
    for (int side = 1; side >= -1; side--) {
        for (int k = 0; k < 3 * N_GRID; k++)
            there[k] = p[k] + side * step * move[k];
        ck_assert_int_eq(hf_cloud_measure(&cloud, there, side > 0 ? plus : side < 0 ? minus : residual), HF_OK);
        ck_assert_int_eq(cloud.pose.found.n_held, _i);
        if (side != 0) continue;
        ck_assert_int_eq(hf_cloud_linearise(&cloud), HF_OK);
        hf_cloud_push(&cloud, move, rate);
    }
    for (int k = 0; k < N_GRID; k++)
        ck_assert_double_eq_tol(rate[k], (plus[k] - minus[k]) / (2 * step), 1e-7);
    hf_arena_free(&arena);
}
END_TEST

/* ---- the measures ---- */

static void open_reflector(struct net *net)
{
    OPEN_CASE(net, SMALL_REFLECTOR, "surface.frequencies_Hz=[1e9, 1.5e9]");
    memcpy(net->work.position_m, net->model.position_m, 3 * (size_t)net->model.n_node * sizeof(double));
}

static hf_surface_measures measured(struct net *net)
{
    hf_surface_measures s;
    hf_facets none = {0};
    ck_assert_int_eq(
        hf_surface_measure(&net->settings.surface, &none, &net->model, net->work.position_m, net->work.tension_N, &s),
        HF_OK);
    ck_assert(s.is_measured);
    return s;
}

/* Nodes raised by amounts of their own. Sums of some tens of numbers in another order: 1e-13 of them; z of the fifth
 * digit of x^2/(4f), whose rounding is 1e-16 m. */
START_TEST(errors_are_those_of_their_definitions)
{
    struct net net;
    open_reflector(&net);
    const hf_model *m = &net.model;
    const double f = net.settings.parabolic_cylinder.focal_length_m;
    struct rng rng = rng_start(410);
    long double normal = 0, half_path = 0, up = 0;
    int n = 0, is_round = _i;
    if (is_round) net.settings.surface.kind = HF_SURFACE_PARABOLOID;
    for (int row = 0; row < m->n_free; row++) {
        double dz = rng_uniform(&rng, -0.02, 0.02), x = m->position_m[row], y = m->position_m[m->n_node + row];
        if (is_round) net.work.position_m[2 * m->n_node + row] += y * y / (4 * f);
        double moved = dz + (is_round ? y * y / (4 * f) : 0);
        net.work.position_m[2 * m->n_node + row] += dz;
        if (net.scene.role[m->node_of_row[row]] != HF_ROLE_INNER) continue;
        long double slope2 = ((long double)x * x + is_round * y * y) / (4 * f * f), cosine = 1 / sqrtl(1 + slope2);
        up += moved * moved;
        normal += dz * cosine * dz * cosine;
        half_path += dz * cosine * cosine * dz * cosine * cosine;
        n++;
    }
    hf_surface_measures s = measured(&net);
    ck_assert_double_eq_tol(s.z_rms_m, (double)sqrtl(up / n), 1e-15);
    ck_assert_double_eq_tol(s.normal_rms_m, (double)sqrtl(normal / n), 1e-15);
    ck_assert_double_eq_tol(s.half_path_rms_m, (double)sqrtl(half_path / n), 1e-15);
    ck_assert_double_lt(s.fit.half_path_rms_m, s.half_path_rms_m);
    for (int k = 0; k < 2; k++) {
        double wave_m = 299792458 / net.settings.surface.frequencies_Hz.value[k];
        double gain = exp(-pow(4 * acos(-1) * s.half_path_rms_m / wave_m, 2)); /* Ruze */
        ck_assert_double_eq_tol(s.gain_loss_dB[k], -10 * log10(gain), 1e-12 * s.gain_loss_dB[k]);
        ck_assert_double_lt(s.fit_gain_loss_dB[k], s.gain_loss_dB[k]);
    }
    close_net(&net);
}
END_TEST

/* Beyond 3 dB, at lambda/15.1, Ruze's formula says nothing, and no number is given. */
START_TEST(loss_beyond_the_formula_is_no_number)
{
    const double f = 9.6e9, wave_m = 299792458 / f, edge_m = wave_m * sqrt(0.3 * log(10)) / (4 * acos(-1));
    ck_assert_double_eq_tol(wave_m / edge_m, 15.1, 0.05);
    ck_assert_double_eq_tol(hf_surface_gain_loss_dB(edge_m * (1 - 1e-9), f), 3, 1e-8);
    ck_assert_double_nan(hf_surface_gain_loss_dB(edge_m * (1 + 1e-9), f));
    ck_assert_double_nan(hf_surface_gain_loss_dB(0.4678, f));
    ck_assert_double_nan(hf_surface_gain_loss_dB((double)NAN, f));
    ck_assert_double_eq(hf_surface_gain_loss_dB(0, f), 0);
    ck_assert_double_eq_tol(hf_surface_frequency_of_loss_Hz(edge_m, HF_RUZE_MOST_DB), f, 1e-12 * f);
    ck_assert_double_eq(hf_surface_frequency_of_loss_Hz(0, HF_RUZE_MOST_DB), INFINITY);
}
END_TEST

/* A shift along the generatrix is a deviation, but no error of the surface. Percentiles as numpy's. */
START_TEST(drift_along_the_surface_is_no_error)
{
    struct net net;
    open_reflector(&net);
    const hf_model *m = &net.model;
    int n = m->n_inner_node;
    for (int k = 0; k < n; k++) /* 0, 1, 2, ... mm, not in order */
        net.work.position_m[m->n_node + m->inner_row[k]] += 1e-3 * (7 * k % n);
    ck_assert_int_ne(n % 7, 0);
    hf_surface_measures s = measured(&net);
    ck_assert_double_lt(s.normal_rms_m, 1e-15);
    ck_assert_double_lt(s.half_path_rms_m, 1e-15);
    ck_assert_double_eq_tol(s.deviation_p50_m, 0.50e-3 * (n - 1), 1e-14);
    ck_assert_double_eq_tol(s.deviation_p90_m, 0.90e-3 * (n - 1), 1e-14);
    ck_assert_double_eq_tol(s.deviation_p95_m, 0.95e-3 * (n - 1), 1e-14);
    ck_assert_double_eq_tol(s.deviation_p99_m, 0.99e-3 * (n - 1), 1e-14);
    ck_assert_double_eq_tol(s.deviation_max_m, 1e-3 * (n - 1), 1e-14);
    close_net(&net);
}
END_TEST

/* RMS about the mean of what lies between a parabola and its chords, by the trapezoidal rule with 1000 intervals:
 * 1e-6 relative. The width is that of a cell. */
START_TEST(faceting_is_the_rms_under_a_chord)
{
    struct net net;
    open_reflector(&net);
    double w = 0.5, f = net.settings.parabolic_cylinder.focal_length_m, sum = 0, square = 0; /* 4 m in 4 x 2 cells */
    for (int k = 0; k <= 1000; k++) {
        double x = w * (k / 1000.0 - 0.5), gap = (w * w / 4 - x * x) / (4 * f), part = k % 1000 ? 1e-3 : 0.5e-3;
        sum += part * gap;
        square += part * gap * gap;
    }
    hf_surface_measures s = measured(&net);
    ck_assert_double_eq_tol(s.faceting_rms_m, sqrt(square - sum * sum), 1e-5 * s.faceting_rms_m);
    net.settings.surface.strip_width_m = 0;
    ck_assert_double_nan(measured(&net).faceting_rms_m);
    close_net(&net);
}
END_TEST

Suite *suite_unit_surface(void)
{
    Suite *suite = suite_create("unit/surface");
    TCase *tests = tcase_create("surface");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, known_motion_and_focal_length_are_recovered, 0, N_MOTION);
    tcase_add_loop_test(tests, known_paraboloid_is_recovered, 0, N_ROUND_MOTION);
    tcase_add_loop_test(tests, weights_count_points, 0, 2);
    tcase_add_loop_test(tests, fit_of_a_rough_surface_is_a_minimum, 0, 3);
    tcase_add_test(tests, few_nodes_are_no_fault);
    tcase_add_loop_test(tests, fit_of_few_rough_nodes_stays, 0, 8);
    tcase_add_test(tests, fit_of_two_lines_keeps_the_focal_length);
    tcase_add_test(tests, fit_without_an_answer_has_no_value);
    tcase_add_loop_test(tests, fit_from_one_nearby_is_the_reference, 0, 4);
    tcase_add_test(tests, fit_from_one_nearby_knows_its_end);
    tcase_add_test(tests, fit_holds_a_shift_at_its_bound);
    tcase_add_loop_test(tests, fit_holds_nothing_because_of_errors, 0, 2);
    tcase_add_loop_test(tests, derivatives_know_the_bounds_of_the_fit, 0, 3);
    tcase_add_loop_test(tests, errors_are_those_of_their_definitions, 0, 2);
    tcase_add_test(tests, loss_beyond_the_formula_is_no_number);
    tcase_add_test(tests, drift_along_the_surface_is_no_error);
    tcase_add_test(tests, faceting_is_the_rms_under_a_chord);
    return suite;
}
