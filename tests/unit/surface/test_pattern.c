/* Far fields by physical optics against closed forms: plates, discs, paraboloids, cylinders, errors, gratings; the same
 * bits from every instruction set and number of threads. */
#include "support.h"

#include "base/lane.h"
#include "search/parallel.h"
#include "surface/gain.h"
#include "surface/pattern_kernel.h"
#include <hifdm/pattern.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define LIGHT_M_PER_S 299792458.0

/* ---- surfaces ---- */

enum { N_ANGLE = 201, NODES_MOST = 70000, FACETS_MOST = 20000, CUTS = HF_PATTERN_CUTS };

struct sheet {
    double position_m[3 * NODES_MOST];
    int corner[4 * FACETS_MOST];
    hf_facets facets;
    const double *sag_m; /* NULL: flat */
    hf_surface_settings surface;
    double co[CUTS * N_ANGLE], cross[CUTS * N_ANGLE];
};
static struct sheet s;

/* Pattern settings of a test: the wavelength is 1 m. */
static void begin(hf_feed_kind feed, double from_deg, double to_deg, int n_theta)
{
    memset(&s, 0, sizeof s);
    s.facets.corner = s.corner;
    s.surface = (hf_surface_settings){.kind = HF_SURFACE_PARABOLOID, .focal_length_m = 1e9};
    s.surface.pattern = (hf_pattern_settings){.theta_deg = {from_deg, to_deg},
                                              .n_theta = n_theta,
                                              .phi_deg = {3, {0, 45, 90}},
                                              .feed = feed,
                                              .position_m = {NAN, NAN, NAN},
                                              .aim_m = {NAN, NAN, NAN},
                                              .cos_power = NAN};
}

/* A facet of its own four nodes, the last one NULL for a triangle. */
static void add(const double *a, const double *b, const double *c, const double *d)
{
    const double *node[4] = {a, b, c, d ? d : c};
    int i = s.facets.n_facet++;
    ck_assert(s.facets.n_facet <= FACETS_MOST);
    for (int k = 0; k < 4; k++) {
        s.corner[4 * i + k] = 4 * i + (k == 3 && !d ? 2 : k);
        memcpy(s.position_m + 3 * (4 * i + k), node[k], 3 * sizeof(double));
    }
}

static void add_rectangle(double x, double y, double z, double width, double height)
{
    add((double[]){x, y, z}, (double[]){x + width, y, z}, (double[]){x + width, y + height, z},
        (double[]){x, y + height, z});
}

/* How many facets have the feed behind them. */
static int solve_any(int n_thread)
{
    hf_feed feed;
    hf_far_field p;
    const hf_pattern_surface surface = {&s.facets, s.position_m, s.sag_m};
    int n_behind = hf_feed_make(&s.surface, &s.facets, s.position_m, &feed);
    ck_assert_int_eq(hf_pattern_create(&s.surface.pattern, &surface, &feed, LIGHT_M_PER_S, n_thread, &p), HF_OK);
    hf_parallel_each(n_thread, HF_PATTERN_BLOCKS, hf_pattern_sum_block, &p);
    hf_pattern_finish(&p, s.co, s.cross);
    hf_pattern_free(&p);
    return n_behind;
}

static void solve(int n_thread)
{
    ck_assert_int_eq(solve_any(n_thread), 0);
}

static double loss_in_phase_dB(void)
{
    hf_gain_beam beam;
    hf_gain_beam_make(&s.surface, &s.facets, s.position_m, LIGHT_M_PER_S, &beam);
    ck_assert_int_lt(beam.order, HF_GAIN_ORDER_MOST);
    return hf_gain_loss_dB(&beam, &(hf_pattern_surface){&s.facets, s.position_m, s.sag_m});
}

/* Root of the gain, of angle i of a cut. */
static double field(const double *gain_dBi, int cut, int i)
{
    return pow(10, gain_dBi[cut * s.surface.pattern.n_theta + i] / 20);
}

static double theta_of(int i)
{
    const hf_pattern_settings *p = &s.surface.pattern;
    return PI / 180 * (p->theta_deg[0] + (p->theta_deg[1] - p->theta_deg[0]) * i / (p->n_theta - 1));
}

static double phi_of(int cut)
{
    return PI / 180 * s.surface.pattern.phi_deg.value[cut];
}

/* What polarisation x has of a current along x, by Ludwig's third definition. */
static double share(int cut, int i)
{
    double c = cos(phi_of(cut));
    return cos(theta_of(i)) * c * c + 1 - c * c;
}

static double sinc(double x)
{
    return x == 0 ? 1 : sin(x) / x;
}

/* ---- apertures ---- */

/* Root of the gain of the plate 2 sqrt(pi A) |F|, F its sinc: to 1e-6 of the largest, and the cross polarisation. */
START_TEST(plate_is_a_sinc)
{
    const double a = 7.3, b = 11.9;
    const int n[3][2] = {{1, 1}, {5, 3}, {31, 17}};
    for (int trial = 0; trial < 6; trial++) {
        double to_deg = trial < 3 ? 20 : 89;
        int nx = n[trial % 3][0], ny = n[trial % 3][1];
        begin(HF_FEED_PLANE_WAVE, -to_deg, to_deg, N_ANGLE);
        for (int i = 0; i < nx * ny; i++)
            add_rectangle(a * (i % nx) / nx, b * (double)(i / nx) / ny, 0, a / nx, b / ny);
        solve(1);
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < N_ANGLE; i++) {
                double u = sin(theta_of(i)) * cos(phi_of(c)), v = sin(theta_of(i)) * sin(phi_of(c));
                double F = 2 * sqrt(PI * a * b) * fabs(sinc(PI * a * u) * sinc(PI * b * v));
                double twist = fabs((cos(theta_of(i)) - 1) * sin(2 * phi_of(c)) / 2);
                ck_assert_double_eq_tol(field(s.co, c, i), F * share(c, i), 1e-9 * sqrt(a * b));
                ck_assert_double_eq_tol(field(s.cross, c, i), F * twist, 1e-9 * sqrt(a * b));
            }
    }
}
END_TEST

/* A disc of many triangles, its corners a little outside so that the areas agree. */
START_TEST(disc_is_an_airy_pattern)
{
    enum { SIDES = 4000 };
    const double R = 10, outer = R * sqrt(2 * PI / SIDES / sin(2 * PI / SIDES));
    begin(HF_FEED_PLANE_WAVE, -12, 12, N_ANGLE);
    for (int i = 0; i < SIDES; i++) {
        double a = 2 * PI * i / SIDES, b = 2 * PI * (i + 1) / SIDES;
        add((double[]){0, 0, 0}, (double[]){outer * cos(a), outer * sin(a), 0},
            (double[]){outer * cos(b), outer * sin(b), 0}, NULL);
    }
    solve(2);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < N_ANGLE; i++) {
            double x = 2 * PI * R * fabs(sin(theta_of(i))), airy = x == 0 ? 1 : 2 * fabs(j1(x)) / x;
            ck_assert_double_eq_tol(field(s.co, c, i) / (2 * PI * R), airy * share(c, i), 1e-6);
        }
    hf_cut_figures f = hf_pattern_figures(N_ANGLE, s.surface.pattern.theta_deg, s.co);
    ck_assert_double_eq_tol(f.gain_dBi, 20 * log10(2 * PI * R), 1e-4);
    ck_assert_double_eq_tol(f.beam_deg, 0, 1e-9);
    ck_assert_double_eq_tol(f.half_power_width_deg, 180 / PI * 1.02899 / (2 * R), 0.01); /* of [2 J1(x)/x]^2 */
    ck_assert_double_eq_tol(f.first_sidelobe_dB, -17.57, 0.1);
    ck_assert_double_eq(f.highest_sidelobe_dB, f.first_sidelobe_dB);
}
END_TEST

/* The power in front of a large disc is what falls on it. */
START_TEST(disc_reflects_what_falls_on_it)
{
    enum { SIDES = 400 };
    double sum = 0;
    begin(HF_FEED_PLANE_WAVE, 0, 90, N_ANGLE);
    s.surface.pattern.phi_deg = (hf_double_list){2, {0, 90}}; /* powers go as 1 and cos(2 phi) */
    for (int i = 0; i < SIDES; i++) {
        double a = 2 * PI * i / SIDES, b = 2 * PI * (i + 1) / SIDES;
        add((double[]){0, 0, 0}, (double[]){10 * cos(a), 10 * sin(a), 0}, (double[]){10 * cos(b), 10 * sin(b), 0},
            NULL);
    }
    solve(1);
    for (int k = 0; k < 2 * N_ANGLE; k++) {
        int i = k % N_ANGLE;
        double end = i == 0 || i == N_ANGLE - 1 ? 0.5 : 1;
        sum += end * (pow(10, s.co[k] / 10) + pow(10, s.cross[k] / 10)) / 2 * sin(theta_of(i)) / 2;
    }
    sum *= PI / 2 / (N_ANGLE - 1);
    ck_assert_double_eq_tol(sum, 1, 0.02);
}
END_TEST

/* ---- reflectors ---- */

/* Rings and sectors of facets on the paraboloid of focal length f_m; polygons of the areas of circles. */
static void add_paraboloid(int rings, double radius_m, double f_m)
{
    double sector = PI / (3 * rings), wider = sqrt(sector / sin(sector));
    s.surface.focal_length_m = f_m;
    for (int i = 0; i < rings; i++)
        for (int k = 0; k < 6 * rings; k++) {
            double p[4][3];
            for (int c = 0; c < 4; c++) {
                double r = wider * radius_m * (i + (c == 1 || c == 2)) / rings, a = sector * (k + (c >= 2));
                p[c][0] = r * cos(a);
                p[c][1] = r * sin(a);
                p[c][2] = r * r / (4 * f_m);
            }
            add(p[0], p[1], p[2], p[3]);
        }
}

/* The gain that ray optics gives to a feed at the focus, with taper and spillover:
 * (4 pi f/lambda)^2 2 (2q + 1) [int cos^q(t) tan(t/2) dt]^2 up to the edge. */
static double aperture_gain(double radius_m, double f_m, double q)
{
    enum { N = 20000 };
    double edge = 2 * atan(radius_m / (2 * f_m)), sum = 0;
    for (int i = 0; i <= N; i++) {
        double t = edge * i / N;
        sum += (i == 0 || i == N ? 1 : i % 2 ? 4 : 2) * pow(cos(t), q) * tan(t / 2) * edge / N / 3;
    }
    return 2 * (2 * q + 1) * pow(4 * PI * f_m * sum, 2);
}

/* What facets lose goes as a h^2 + b h^4 of their size, by weights and by phases; nothing else is lost. */
START_TEST(paraboloid_has_the_gain_of_its_aperture)
{
    double loss[3];
    for (int k = 0; k < 3; k++) {
        begin(HF_FEED_AUTO, -5, 5, N_ANGLE);
        s.surface.pattern.cos_power = 1.7;
        add_paraboloid(12 << k, 20, 16);
        solve(2);
        double full = aperture_gain(20, 16, 1.7), gain = pow(field(s.co, 0, N_ANGLE / 2), 2);
        loss[k] = 1 - gain / full;
        ck_assert_double_lt(field(s.cross, 0, N_ANGLE / 2), 1e-6);
    }
    ck_assert_double_eq_tol((64 * loss[2] - 20 * loss[1] + loss[0]) / 45, 0, 1e-6);
    ck_assert_double_gt(loss[0], 8 * loss[1]);
    ck_assert_double_gt(loss[1], 4 * loss[2]);
}
END_TEST

/* A feed beside the focus moves the beam to the other side, by nearly the same angle. */
START_TEST(feed_beside_the_focus_moves_the_beam)
{
    begin(HF_FEED_POINT, -8, 8, N_ANGLE);
    memcpy(s.surface.pattern.position_m, (double[]){1, 0, 24}, 3 * sizeof(double));
    memcpy(s.surface.pattern.aim_m, (double[]){0, 0, 0}, 3 * sizeof(double));
    s.surface.pattern.cos_power = 8;
    add_paraboloid(24, 20, 24);
    solve(2);
    hf_cut_figures f = hf_pattern_figures(N_ANGLE, s.surface.pattern.theta_deg, s.co);
    double feed_deg = 180 / PI * atan(1 / 24.0);
    ck_assert_double_gt(-f.beam_deg, 0.85 * feed_deg);
    ck_assert_double_lt(-f.beam_deg, feed_deg);
}
END_TEST

/* A line at the focus of a cylinder: its aperture fields E(x) = cos^q / sqrt(path), in phase. */
START_TEST(cylinder_has_the_gain_of_its_aperture)
{
    enum { STRIPS = 96, N = 20000 };
    const double half = 18, f_m = 15, length = 30, q[] = {0.5, 2, 60};
    for (int trial = 0; trial < 6; trial++) {
        double sum = 0, power = 0;
        begin(HF_FEED_AUTO, -5, 5, N_ANGLE);
        s.surface.kind = HF_SURFACE_PARABOLIC_CYLINDER;
        s.surface.focal_length_m = f_m;
        s.surface.pattern.cos_power = q[trial / 2];
        s.surface.pattern.polarisation = trial % 2 ? HF_POLARISATION_Y : HF_POLARISATION_X;
        for (int i = 0; i < STRIPS; i++) {
            double x[2] = {half * (2.0 * i / STRIPS - 1), half * (2.0 * (i + 1) / STRIPS - 1)};
            double z[2] = {x[0] * x[0] / (4 * f_m), x[1] * x[1] / (4 * f_m)};
            add((double[]){x[0], 0, z[0]}, (double[]){x[1], 0, z[1]}, (double[]){x[1], length, z[1]},
                (double[]){x[0], length, z[0]});
        }
        solve(1);
        for (int i = 0; i < N; i++) {
            double x = half * (2 * (i + 0.5) / N - 1), path = f_m + x * x / (4 * f_m), t = 2 * atan(x / (2 * f_m));
            sum += pow(cos(t), q[trial / 2]) / sqrt(path) * 2 * half / N;
            power += pow(cos(PI * ((i + 0.5) / N - 0.5)), 2 * q[trial / 2]) * PI / N;
        }
        double gain = 4 * PI * length * sum * sum / power;
        ck_assert_double_eq_tol(pow(field(s.co, 0, N_ANGLE / 2), 2) / gain, 1, 0.004);
    }
}
END_TEST

/* Under a beam that falls more steeply on one side: half of its power is 2 deg to the left and 5 deg to the right. */
START_TEST(a_width_has_two_sides)
{
    const double ends_deg[] = {-10, 10}, half_dB = 10 * log10(2);
    double gain[N_ANGLE];
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < N_ANGLE; i++) {
            double at_deg = ends_deg[0] + (ends_deg[1] - ends_deg[0]) * i / (N_ANGLE - 1);
            gain[i] = 30 - half_dB * pow(at_deg / ((at_deg < 0) == side ? 2 : 5), 2);
        }
        hf_cut_figures f = hf_pattern_figures(N_ANGLE, ends_deg, gain);
        ck_assert_int_eq(f.doubt, HF_CUT_FINE);
        ck_assert_double_eq_tol(f.half_power_width_deg, 7, 0.01);
    }
}
END_TEST

/* A facet that shows the feed its back has no current, and no share of the power, whatever it would add. */
START_TEST(backs_of_facets_are_dark)
{
    const hf_feed_kind feed[] = {HF_FEED_POINT, HF_FEED_PLANE_WAVE};
    double co[CUTS * N_ANGLE];
    for (int k = 0; k < 2; k++) {
        begin(feed[k], -20, 20, N_ANGLE);
        memcpy(s.surface.pattern.position_m, (double[]){2.5, 2, 40}, 3 * sizeof(double));
        memcpy(s.surface.pattern.aim_m, (double[]){2.5, 2, 0}, 3 * sizeof(double));
        s.surface.pattern.cos_power = 2;
        add_rectangle(0, 0, 0, 5, 4);
        solve(1);
        memcpy(co, s.co, sizeof co);
        add((double[]){5, 0, 0}, (double[]){4, 0, 2}, (double[]){4, 4, 2}, (double[]){5, 4, 0}); /* it leans over */
        ck_assert_int_eq(solve_any(1), 1);
        for (int i = 0; i < CUTS * N_ANGLE; i++)
            ck_assert_double_eq(s.co[i], co[i]);
    }
}
END_TEST

/* ---- errors ---- */

/* Pieces of a plate that stand too high or too low by chance: Ruze's loss, as far as it holds. */
START_TEST(random_errors_lose_what_ruze_says)
{
    enum { N = 100 };
    const double sigma[] = {1.0 / 60, 1.0 / 30, 1.0 / 20};
    for (int trial = 0; trial < 3; trial++) {
        struct rng rng = rng_start((uint64_t)trial);
        double square = 0, edge = sigma[trial] * sqrt(3.0);
        begin(HF_FEED_PLANE_WAVE, -1, 1, 3);
        for (int i = 0; i < N * N; i++) {
            double z = rng_uniform(&rng, -edge, edge);
            square += z * z / (N * N);
            add_rectangle(i % N - N / 2, i / N - N / 2.0, z, 1, 1);
        }
        solve(2);
        double loss_dB = 10 * log10(4 * PI * N * N) - s.co[1], ruze_dB = 10 / log(10) * pow(4 * PI, 2) * square;
        ck_assert_double_eq_tol(loss_dB, ruze_dB, 0.08 * ruze_dB);
        ck_assert_double_eq_tol(loss_in_phase_dB(), loss_dB, 1e-9);
    }
}
END_TEST

/* Small errors of a tilted and bent sheet: the loss in phase is Ruze's of their variance, to the next power of it. */
START_TEST(small_errors_lose_what_ruze_says)
{
    enum { N = 20 };
    for (int trial = 0; trial < 3; trial++) {
        struct rng rng = rng_start((uint64_t)trial);
        double z[N + 1][N + 1], sum = 0, square = 0, sigma = 1e-3 * (trial + 1);
        begin(HF_FEED_PLANE_WAVE, -1, 1, 3);
        for (int i = 0; i < (N + 1) * (N + 1); i++)
            z[i / (N + 1)][i % (N + 1)] = rng_uniform(&rng, -sigma, sigma) + sigma * (i % (N + 1)) / N;
        for (int i = 0; i < N * N; i++) {
            int x = i / N, y = i % N, h = N / 2;
            double c[4] = {z[x][y], z[x + 1][y], z[x + 1][y + 1], z[x][y + 1]}, all = c[0] + c[1] + c[2] + c[3],
                   own = 0;
            add((double[]){x - h, y - h, c[0]}, (double[]){x + 1 - h, y - h, c[1]},
                (double[]){x + 1 - h, y + 1 - h, c[2]}, (double[]){x - h, y + 1 - h, c[3]});
            for (int k = 0; k < 4; k++) /* of a bilinear square: the mean of c_i c_j over it is 4, 2 or 1 / 36 */
                own += c[k] * (4 * c[k] + 2 * c[(k + 1) % 4] + 2 * c[(k + 3) % 4] + c[(k + 2) % 4]) / 36;
            sum += all / 4 / (N * N);
            square += own / (N * N);
        }
        double variance = pow(4 * PI, 2) * (square - sum * sum), lost = 1 - pow(10, -loss_in_phase_dB() / 10);
        ck_assert_double_eq_tol(lost, variance, variance * variance);
    }
}
END_TEST

/* The mesh of a flat plate between its cables: what is lost in phase is what the far field lacks along the beam. */
START_TEST(pillows_lose_what_the_field_loses)
{
    static double sag_m[4 * 6];
    const double sag_of_side_m[4] = {0.02, 0.03, -0.01, 0.02};
    begin(HF_FEED_PLANE_WAVE, -20, 20, N_ANGLE);
    for (int i = 0; i < 6; i++)
        add_rectangle(2 * (i % 3), 2 * (i / 3), 0, 2, 2);
    solve(1);
    double flat_dBi = s.co[N_ANGLE / 2];
    ck_assert_double_eq_tol(loss_in_phase_dB(), 0, 1e-12);
    for (int i = 0; i < 4 * 6; i++)
        sag_m[i] = sag_of_side_m[i % 4] * (1 + i / 4 % 3);
    s.sag_m = sag_m;
    solve(1);
    double loss_dB = flat_dBi - s.co[N_ANGLE / 2];
    ck_assert_double_gt(loss_dB, 0.1);
    ck_assert_double_eq_tol(loss_in_phase_dB(), loss_dB, 1e-4 * loss_dB);
}
END_TEST

/* With the feed at its focus, beside the axis as well, a reflector has no other loss in phase than that of its facets,
 * which goes as h^4; the beam of a feed beside the focus is on the other side. */
START_TEST(beams_are_where_the_surface_sends_them)
{
    double loss[2];
    hf_feed feed;
    for (int k = 0; k < 2; k++) {
        begin(HF_FEED_AUTO, -1, 1, 3);
        add_paraboloid(12 << k, 20, 16);
        for (int i = 0; i < 4 * s.facets.n_facet; i++) { /* another part of the same paraboloid */
            double *p = s.position_m + 3 * i;
            p[0] += 25;
            p[2] = (p[0] * p[0] + p[1] * p[1]) / (4 * 16);
        }
        solve(2);
        ck_assert_int_eq(hf_feed_make(&s.surface, &s.facets, s.position_m, &feed), 0);
        ck_assert_double_eq_tol(feed.axis[0], 0.96, 0.1);
        for (int d = 0; d < 3; d++)
            ck_assert_double_eq_tol(feed.beam[d], d == 2, 1e-15);
        loss[k] = loss_in_phase_dB();
    }
    ck_assert_double_gt(loss[1], 0);
    ck_assert_double_gt(loss[0], 14 * loss[1]);
    memcpy(s.surface.pattern.position_m, (double[]){1, 0, 16}, 3 * sizeof(double));
    memcpy(s.surface.pattern.aim_m, (double[]){0, 0, -3}, 3 * sizeof(double)); /* below the vertex */
    hf_feed_make(&s.surface, &s.facets, s.position_m, &feed);
    ck_assert_double_eq_tol(feed.beam[0], -1 / hypot(1, 16), 1e-15);
    ck_assert_double_eq_tol(feed.beam[2], 16 / hypot(1, 16), 1e-15);
}
END_TEST

/* Strips that stand high and low in turn: lobes where the period is a wave longer, of the size of their sum. */
START_TEST(periods_have_their_grating_lobes)
{
    enum { STRIPS = 40 };
    const double width = 3, z = 0.06;
    begin(HF_FEED_PLANE_WAVE, 0, 30, N_ANGLE);
    for (int i = 0; i < STRIPS; i++)
        add_rectangle(width * i, 0, i % 2 ? z : -z, width, 50);
    solve(1);
    int top = 0;
    for (int i = 0; i < N_ANGLE; i++) {
        double re = 0, im = 0, u = sin(theta_of(i)), one = 2 * width * 50 * fabs(sinc(PI * width * u)) * share(0, i);
        for (int k = 0; k < STRIPS; k++) {
            double phase = 2 * PI * (width * k * u + (k % 2 ? z : -z) * (1 + cos(theta_of(i))));
            re += cos(phase);
            im += sin(phase);
        }
        double F = one * hypot(re, im) * sqrt(PI / (STRIPS * width * 50));
        ck_assert_double_eq_tol(field(s.co, 0, i), F, 1e-8 * STRIPS);
        if (theta_of(i) > 0.05 && s.co[i] > s.co[top]) top = i;
        if (theta_of(i) <= 0.05) top = i;
    }
    ck_assert_double_eq_tol(sin(theta_of(top)), 1 / (2 * width), 0.5 / (STRIPS * width));
}
END_TEST

/* ---- the same bits ---- */

START_TEST(threads_change_no_bit)
{
    static double co[CUTS * N_ANGLE];
    begin(HF_FEED_AUTO, -5, 5, N_ANGLE);
    add_paraboloid(9, 20, 16);
    solve(1);
    memcpy(co, s.co, sizeof co);
    for (int n_thread = 2; n_thread < 6; n_thread++) {
        solve(n_thread);
        ck_assert_mem_eq(co, s.co, sizeof co);
    }
}
END_TEST

enum { POINTS = 37, DIRECTIONS = 24, NODES = 5 };

START_TEST(instruction_sets_change_no_bit)
{
    static const hf_pattern_kernels *const kernel[] = {HF_LANE_EACH(&hf_pattern_kernels)};
    static _Alignas(64) double point[HF_PATTERN_POINT * POINTS], direction[3 * DIRECTIONS], between[NODES * DIRECTIONS];
    static _Alignas(64) double sum[HF_LANE_N_ISA][6 * DIRECTIONS], to[HF_LANE_N_ISA][6 * DIRECTIONS];
    struct rng rng = rng_start(5);
    for (int i = 0; i < HF_PATTERN_POINT * POINTS; i++)
        point[i] = rng_uniform(&rng, -1, 1) * (i < 4 * POINTS ? 300 : 1);
    for (int i = 0; i < 3 * DIRECTIONS; i++)
        direction[i] = rng_uniform(&rng, -1, 1);
    for (int i = 0; i < NODES * DIRECTIONS; i++)
        between[i] = rng_uniform(&rng, -1, 1);
    for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
        if (!hf_lane_has_isa((hf_lane_isa)isa)) {
            skip_for_machine("unit/pattern", hf_lane_isa_name((hf_lane_isa)isa));
            continue;
        }
        const double middle[] = {31.7, -8.125, 1000.5};
        kernel[isa]->points(POINTS, point, DIRECTIONS, direction, sum[isa]);
        kernel[isa]->spread(NODES, 8, sum[isa], between, middle, 77.7, DIRECTIONS, direction, to[isa]);
        kernel[isa]->spread(0, DIRECTIONS, sum[isa], NULL, middle, 77.7, DIRECTIONS, direction, to[isa]);
        ck_assert_mem_eq(sum[0], sum[isa], sizeof sum[0]);
        ck_assert_mem_eq(to[0], to[isa], sizeof to[0]);
    }
    for (int a = 0; a < DIRECTIONS; a++) {
        double want[6] = {0};
        for (int i = 0; i < POINTS; i++) {
            long double turns = -(long double)point[3 * POINTS + i];
            for (int d = 0; d < 3; d++)
                turns += (long double)direction[d * DIRECTIONS + a] * point[d * POINTS + i];
            for (int d = 0; d < 3; d++) {
                want[d] += point[(4 + d) * POINTS + i] * (double)cosl(2 * acosl(-1) * turns);
                want[3 + d] += point[(4 + d) * POINTS + i] * (double)sinl(2 * acosl(-1) * turns);
            }
        }
        for (int k = 0; k < 6; k++)
            ck_assert_double_eq_tol(sum[0][k * DIRECTIONS + a], want[k], 1e-11);
    }
}
END_TEST

/* ---- feeds ---- */

START_TEST(feeds_behind_are_counted)
{
    hf_feed feed;
    begin(HF_FEED_POINT, -5, 5, N_ANGLE);
    add_paraboloid(4, 20, 16);
    ck_assert_int_eq(hf_feed_make(&s.surface, &s.facets, s.position_m, &feed), 0);
    double edge = cos(2 * atan(20.0 / 32 * sqrt(PI / 12 / sin(PI / 12)))); /* 10 dB there */
    ck_assert_double_eq_tol(20 * feed.cos_power * log10(edge), -10, 1e-9);
    memcpy(s.surface.pattern.position_m, (double[]){0, 0, -7}, 3 * sizeof(double)); /* below all planes of facets */
    ck_assert_int_eq(hf_feed_make(&s.surface, &s.facets, s.position_m, &feed), s.facets.n_facet);
    memcpy(s.surface.pattern.position_m, (double[]){0, 0, 16}, 3 * sizeof(double));
    memcpy(s.surface.pattern.aim_m, (double[]){0, 0, 20}, 3 * sizeof(double)); /* it looks away */
    ck_assert_int_eq(hf_feed_make(&s.surface, &s.facets, s.position_m, &feed), s.facets.n_facet);
}
END_TEST

START_TEST(memory_may_fail)
{
    hf_feed feed;
    hf_far_field p;
    begin(HF_FEED_AUTO, -5, 5, N_ANGLE);
    add_paraboloid(2, 20, 16);
    const hf_pattern_surface surface = {&s.facets, s.position_m, NULL};
    hf_feed_make(&s.surface, &s.facets, s.position_m, &feed);
    fail_allocation_at(1);
    hf_status status = hf_pattern_create(&s.surface.pattern, &surface, &feed, LIGHT_M_PER_S, 1, &p);
    ck_assert(end_allocation_failure());
    ck_assert_int_eq(status, HF_NO_MEMORY);
    hf_pattern_free(&p);
}
END_TEST

Suite *suite_unit_pattern(void)
{
    Suite *suite = suite_create("unit/pattern");
    TCase *tcase = tcase_create("pattern");
    tcase_add_test(tcase, plate_is_a_sinc);
    tcase_add_test(tcase, disc_is_an_airy_pattern);
    tcase_add_test(tcase, disc_reflects_what_falls_on_it);
    tcase_add_test(tcase, paraboloid_has_the_gain_of_its_aperture);
    tcase_add_test(tcase, feed_beside_the_focus_moves_the_beam);
    tcase_add_test(tcase, cylinder_has_the_gain_of_its_aperture);
    tcase_add_test(tcase, a_width_has_two_sides);
    tcase_add_test(tcase, backs_of_facets_are_dark);
    tcase_add_test(tcase, random_errors_lose_what_ruze_says);
    tcase_add_test(tcase, small_errors_lose_what_ruze_says);
    tcase_add_test(tcase, pillows_lose_what_the_field_loses);
    tcase_add_test(tcase, beams_are_where_the_surface_sends_them);
    tcase_add_test(tcase, periods_have_their_grating_lobes);
    tcase_add_test(tcase, threads_change_no_bit);
    tcase_add_test(tcase, instruction_sets_change_no_bit);
    tcase_add_test(tcase, feeds_behind_are_counted);
    tcase_add_test(tcase, memory_may_fail);
    suite_add_tcase(suite, tcase);
    return suite;
}
