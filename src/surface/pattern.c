/* Computes the far field of a surface by physical optics:
 *
 *     plan: pieces and quadrature order of each facet, number of Chebyshev nodes in theta
 *     for each of 32 blocks of facets, in any thread:
 *       facet -> pieces -> quadrature points with current and path -> sums at the nodes (kernel points)
 *         -> interpolate to all angles, move to its position (kernel spread) -> sums of the block
 *     finish: add blocks in order -> co and cross polarisation -> gain in dBi -> figures of a cut
 *
 * Contents: orders - layout - a facet - a block - gain - figures of a cut - tables */
#include <hifdm/pattern.h>

#include "base/arena.h"
#include "base/elementary.h"
#include "surface/facet_mesh.h"
#include "surface/pattern_feed.h"
#include "surface/pattern_kernel.h"

#include <math.h>

enum { GAUSS_MOST = 64, GAUSS_MORE = 2, LOOKS = 16, PIECES_MOST = 100000 };
#define GAUSS_LN (-21.0)      /* logarithm of the accepted quadrature error */
#define NODE_LN (-22.0)       /* logarithm of the accepted error of interpolation between angles */
#define GAUSS_PHASE_MOST 77.0 /* half phase across a piece; GAUSS_MOST - GAUSS_MORE points reach the accepted error */

static const hf_pattern_kernels *const kernels_of_isa[] = {HF_LANE_EACH(&hf_pattern_kernels)};

/* ---- orders ---- */

/* Returns the smallest number of Chebyshev nodes on [-1, 1] from which exp(j phase x) is interpolated with an error
 * below exp(NODE_LN). The omitted coefficients J_n(phase) are below (z exp(r) / (1 + r))^n, with z = phase/n < 1 and
 * r^2 = 1 - z^2 (Kapteyn). */
static int node_order(double phase, int most)
{
    int n = (int)fmin(phase, most) + 1;
    for (; n < most; n++) {
        double z = fmax(phase, 1e-3) / n, r = sqrt(1 - z * z);
        if (n * (hf_logarithm(z / (1 + r)) + r) < NODE_LN) break;
    }
    return n < most ? n : most;
}

/* ---- layout ---- */

static double theta_of(const hf_pattern_settings *s, double part)
{
    return HF_RAD_PER_DEG * (s->theta_deg[0] + (s->theta_deg[1] - s->theta_deg[0]) * part);
}

static void direction_of(double theta, double phi, double to[3])
{
    double sine = hf_sine(theta);
    to[0] = sine * hf_cosine(phi);
    to[1] = sine * hf_sine(phi);
    to[2] = hf_cosine(theta);
}

/* Return angle i and Chebyshev node i as a share of the range of theta. */
static double part_of_angle(const hf_far_field *p, int i)
{
    return (double)i / (p->settings->n_theta - 1);
}

static double part_of_node(const hf_far_field *p, int i)
{
    return (1 - hf_cosine(HF_PI * (i + 0.5) / p->n_node)) / 2;
}

static void fill_directions(const hf_far_field *p, bool are_nodes, int n, int n_padded, double *direction)
{
    for (int c = 0; c < p->settings->phi_deg.n; c++)
        for (int i = 0; i < n; i++) {
            double to[3], part = are_nodes ? part_of_node(p, i) : part_of_angle(p, i);
            direction_of(theta_of(p->settings, part), HF_RAD_PER_DEG * p->settings->phi_deg.value[c], to);
            for (int d = 0; d < 3; d++)
                direction[(3 * c + d) * n_padded + i] = to[d];
        }
}

/* Computes the Lagrange polynomials of the nodes at the angles, in barycentric form. */
static void fill_between(const hf_far_field *p)
{
    for (int a = 0; a < p->settings->n_theta; a++) {
        double total = 0, x = part_of_angle(p, a);
        int hit = -1;
        for (int i = 0; i < p->n_node; i++) {
            double gap = x - part_of_node(p, i), weight = hf_sine(HF_PI * (i + 0.5) / p->n_node);
            if (gap == 0) hit = i;
            total += p->between[i * p->n_padded + a] = (i % 2 ? -weight : weight) / gap;
        }
        for (int i = 0; i < p->n_node; i++)
            p->between[i * p->n_padded + a] = hit < 0 ? p->between[i * p->n_padded + a] / total : i == hit;
    }
}

static int whole_lanes(int n)
{
    return (n + HF_LANES - 1) / HF_LANES * HF_LANES;
}

/* ---- a facet ---- */

static void take_facet(const hf_far_field *p, int i, hf_facet_mesh *m)
{
    hf_facet_mesh_take_bent(p->surface.facets, i, p->surface.position_m, p->surface.sag_m, m);
}

/* Returns half of the maximum phase across a facet along u and along v, rad. The phase is k (direction - toward) along
 * its sides, with `toward` at its corners. The directions are LOOKS + 1 angles of each cut, with a margin for the
 * angles between them. *radius_m: maximum distance of a corner from the middle. */
static double phase_of(const hf_far_field *p, const hf_facet_mesh *m, double *radius_m)
{
    double most = 0, longest = 0, middle[3], du[3], dv[3], wave = 2 * HF_PI / p->wavelength_m;
    const hf_pattern_settings *s = p->settings;
    hf_facet_mesh_at(m, 0.5, 0.5, middle, du, dv);
    *radius_m = 0;
    for (int k = 0; k < 4; k++) {
        const double *corner = m->corner[k], *next = m->corner[(k + 1) % 4], *last = m->corner[(k + 3) % 4];
        double toward[3], field[3], side[2][3];
        *radius_m = fmax(*radius_m, hf_distance(corner, middle));
        longest = fmax(longest, hf_distance(corner, next));
        hf_feed_light(&p->feed, corner, toward, field);
        for (int d = 0; d < 3; d++) {
            side[0][d] = next[d] - corner[d];
            side[1][d] = last[d] - corner[d];
        }
        for (int c = 0; c < s->phi_deg.n; c++)
            for (int i = 0; i <= LOOKS; i++) {
                double to[3];
                direction_of(theta_of(s, (double)i / LOOKS), HF_RAD_PER_DEG * s->phi_deg.value[c], to);
                for (int d = 0; d < 3; d++)
                    to[d] -= toward[d];
                most = fmax(most, fmax(fabs(hf_dot3(to, side[0])), fabs(hf_dot3(to, side[1]))));
            }
    }
    double between = longest * (theta_of(s, 1) - theta_of(s, 0)) / (2 * LOOKS);
    return wave * (most + between) / 2;
}

/* Returns the number of pieces of a facet along u and along v. *order: quadrature points of a piece along both. */
static int pieces_of(double phase, int *order)
{
    int n = (int)fmin(phase / GAUSS_PHASE_MOST, PIECES_MOST) + 1,
        wanted = hf_gauss_order(phase / n, GAUSS_LN, GAUSS_MOST) + GAUSS_MORE;
    *order = wanted < GAUSS_MOST ? wanted : GAUSS_MOST;
    return n;
}

/* Computes a point of a facet, and the current 2 n x H there per du dv. Returns the path, m. */
static double current_at(const hf_far_field *p, const hf_facet_mesh *m, double u, double v, double place[3],
                         double to[3])
{
    double du[3], dv[3], up[3], toward[3], field[3];
    (p->surface.sag_m ? hf_facet_mesh_lifted : hf_facet_mesh_at)(m, u, v, place, du, dv);
    hf_cross(du, dv, up);
    double path_m = hf_feed_light(&p->feed, place, toward, field), lit = hf_dot3(toward, up) < 0 ? 2 : 0;
    hf_cross(up, field, to);
    for (int d = 0; d < 3; d++)
        to[d] *= lit;
    return path_m;
}

/* Computes the quadrature points of a piece. a, b: smallest u and v of the piece; size: its extent along both. Writes
 * the middle of the piece and the path to it, both in wavelengths. Returns the number of points. */
static int put_points(const hf_far_field *p, const hf_facet_mesh *m, double a, double b, double size, int order,
                      double *point, double middle[3], double *path)
{
    int n = order * order;
    double place[3], current[3], toward[3];
    const double *at = p->gauss_at + order * GAUSS_MOST, *weight = p->gauss_weight + order * GAUSS_MOST;
    hf_facet_mesh_at(m, a + size / 2, b + size / 2, middle, place, current);
    *path = hf_feed_light(&p->feed, middle, toward, current) / p->wavelength_m;
    for (int i = 0; i < n; i++) {
        int j = i % order, k = i / order;
        double path_m = current_at(p, m, a + size * at[j], b + size * at[k], place, current);
        for (int d = 0; d < 3; d++) {
            point[d * n + i] = (place[d] - middle[d]) / p->wavelength_m;
            point[(4 + d) * n + i] = weight[j] * weight[k] * size * size * current[d];
        }
        point[3 * n + i] = path_m / p->wavelength_m - *path;
    }
    for (int d = 0; d < 3; d++)
        middle[d] /= p->wavelength_m;
    return n;
}

/* ---- a block ---- */

static int first_of(const hf_far_field *p, int i)
{
    return (int)((long)p->surface.facets->n_facet * i / HF_PATTERN_BLOCKS);
}

static void sum_piece(const hf_far_field *p, int n_point, const double *point, const double middle[3], double path,
                      double *local, double *sum)
{
    const hf_pattern_kernels *kernel = kernels_of_isa[hf_lane_best_isa()];
    for (int c = 0; c < p->settings->phi_deg.n && !(p->stop && *p->stop); c++) {
        ptrdiff_t n = p->n_padded, n_node = p->n_node_padded;
        const double *direction = p->direction + 3 * c * n;
        kernel->points(n_point, point, p->n_node_padded, p->node_direction + 3 * c * n_node, local);
        kernel->spread(p->n_node, p->n_node_padded, local, p->between, middle, path, p->n_padded, direction,
                       sum + 6 * c * n);
    }
}

void hf_pattern_sum_block(void *pattern, int room, int i)
{
    const hf_far_field *p = pattern;
    double *local = p->local + (ptrdiff_t)room * 6 * p->n_node_padded;
    double *point = p->point + (ptrdiff_t)room * HF_PATTERN_POINT * GAUSS_MOST * GAUSS_MOST;
    double *sum = p->sum + (ptrdiff_t)i * p->settings->phi_deg.n * 6 * p->n_padded;
    for (int k = first_of(p, i); k < first_of(p, i + 1) && !(p->stop && *p->stop); k++) {
        hf_facet_mesh m;
        double radius_m, middle[3], path;
        int order;
        take_facet(p, k, &m);
        int n_piece = pieces_of(phase_of(p, &m, &radius_m), &order);
        double size = 1.0 / n_piece;
        for (int j = 0; j < n_piece * n_piece && !(p->stop && *p->stop); j++) {
            int n = put_points(p, &m, size * (j % n_piece), size * (j / n_piece), size, order, point, middle, &path);
            sum_piece(p, n, point, middle, path, local, sum);
        }
    }
}

void hf_pattern_plan(const hf_pattern_settings *s, const hf_pattern_surface *surface, const hf_feed *feed,
                     double frequency_Hz, hf_far_field *p)
{
    double radius_m, widest_m = 0, half = HF_RAD_PER_DEG * (s->theta_deg[1] - s->theta_deg[0]) / 2;
    *p = (hf_far_field){.settings = s, .surface = *surface, .feed = *feed};
    p->wavelength_m = HF_LIGHT_M_PER_S / frequency_Hz;
    for (int i = 0; i < surface->facets->n_facet; i++) {
        hf_facet_mesh m;
        int order;
        take_facet(p, i, &m);
        int n_piece = pieces_of(phase_of(p, &m, &radius_m), &order);
        widest_m = fmax(widest_m, radius_m / n_piece);
        p->n_point += (long)n_piece * n_piece * order * order;
    }
    p->n_padded = whole_lanes(s->n_theta);
    /* the pattern of a facet of radius r has harmonics of theta only up to k r, and a few more that decay fast */
    p->n_node = node_order((2 * HF_PI * widest_m / p->wavelength_m + 10) * half, s->n_theta);
    if (2 * p->n_node > s->n_theta) p->n_node = 0;
    p->n_node_padded = p->n_node ? whole_lanes(p->n_node) : p->n_padded;
}

int hf_pattern_angles(const hf_far_field *p)
{
    return p->settings->phi_deg.n * (p->n_node ? p->n_node : p->settings->n_theta);
}

hf_status hf_pattern_create(const hf_pattern_settings *s, const hf_pattern_surface *surface, const hf_feed *feed,
                            double frequency_Hz, int n_thread, hf_far_field *p)
{
    hf_pattern_plan(s, surface, feed, frequency_Hz, p);
    p->n_thread = n_thread;
    size_t n_cut = (size_t)s->phi_deg.n, n = (size_t)p->n_padded, n_node = (size_t)p->n_node_padded;
    size_t rooms = (size_t)n_thread, table = (GAUSS_MOST + 1) * GAUSS_MOST;
    HF_TRY(HF_ARENA_ARRAYS(&p->block, HF_ARRAY(p->gauss_at, table), HF_ARRAY(p->gauss_weight, table),
                           HF_ARRAY(p->direction, 3 * n_cut * n), HF_ARRAY(p->node_direction, 3 * n_cut * n_node),
                           HF_ARRAY(p->between, (size_t)p->n_node * n),
                           HF_ARRAY(p->sum, HF_PATTERN_BLOCKS * n_cut * 6 * n), HF_ARRAY(p->local, rooms * 6 * n_node),
                           HF_ARRAY(p->point, rooms * HF_PATTERN_POINT * GAUSS_MOST * GAUSS_MOST)));
    for (int k = 1; k <= GAUSS_MOST; k++)
        hf_gauss_rule(k, p->gauss_at + k * GAUSS_MOST, p->gauss_weight + k * GAUSS_MOST);
    fill_directions(p, false, s->n_theta, p->n_padded, p->direction);
    fill_directions(p, p->n_node > 0, p->n_node ? p->n_node : s->n_theta, p->n_node_padded, p->node_direction);
    if (p->n_node) fill_between(p);
    return HF_OK;
}

void hf_pattern_free(hf_far_field *p)
{
    hf_arena_free_block(p->block);
    *p = (hf_far_field){0};
}

/* ---- gain ---- */

/* Computes the co and cross polarisation vectors at theta, phi, by Ludwig's third definition. */
static void polarisations(hf_polarisation along, double theta, double phi, double co[3], double cross[3])
{
    double c = hf_cosine(phi), s = hf_sine(phi);
    const double by_theta[3] = {hf_cosine(theta) * c, hf_cosine(theta) * s, -hf_sine(theta)}, by_phi[3] = {-s, c, 0};
    for (int d = 0; d < 3; d++) {
        double x = c * by_theta[d] - s * by_phi[d], y = s * by_theta[d] + c * by_phi[d];
        co[d] = along == HF_POLARISATION_X ? x : y;
        cross[d] = along == HF_POLARISATION_X ? y : x;
    }
}

static double in_dB(double scale, const double vector[3], const double *sum, ptrdiff_t n)
{
    double re = 0, im = 0;
    for (int d = 0; d < 3; d++) {
        re += vector[d] * sum[d * n];
        im += vector[d] * sum[(3 + d) * n];
    }
    return HF_DB_PER_LN * hf_logarithm(fmax(scale * (re * re + im * im), 1e-300));
}

void hf_pattern_finish(hf_far_field *p, double *co_dBi, double *cross_dBi)
{
    const hf_pattern_settings *s = p->settings;
    const ptrdiff_t n = p->n_padded, all = 6 * n * s->phi_deg.n;
    double scale = p->feed.scale / (p->wavelength_m * p->wavelength_m);
    for (int i = 1; i < HF_PATTERN_BLOCKS; i++)
        for (ptrdiff_t k = 0; k < all; k++)
            p->sum[k] += p->sum[i * all + k];
    for (int c = 0; c < s->phi_deg.n; c++)
        for (int i = 0; i < s->n_theta; i++) {
            double co[3], cross[3];
            const double *sum = p->sum + 6 * n * c + i;
            polarisations(s->polarisation, theta_of(s, part_of_angle(p, i)), HF_RAD_PER_DEG * s->phi_deg.value[c], co,
                          cross);
            co_dBi[c * s->n_theta + i] = in_dB(scale, co, sum, n);
            cross_dBi[c * s->n_theta + i] = in_dB(scale, cross, sum, n);
        }
}

/* ---- figures of a cut ---- */

/* Returns where the cut falls below `level`, going from angle i in steps of `step`, as a fractional index. Returns NaN
 * if it does not. */
static double crossing(int n, const double *gain, int i, int step, double level)
{
    for (; i + step >= 0 && i + step < n; i += step)
        if (gain[i + step] < level) return i + step * (gain[i] - level) / (gain[i] - gain[i + step]);
    return (double)NAN;
}

/* Returns the first local maximum beyond the minimum beside angle i, or -INFINITY. */
static double next_maximum(int n, const double *gain, int i, int step)
{
    while (i + step >= 0 && i + step < n && gain[i + step] <= gain[i])
        i += step;
    while (i + step >= 0 && i + step < n && gain[i + step] >= gain[i])
        i += step;
    return i > 0 && i < n - 1 ? gain[i] : -INFINITY;
}

/* Returns the highest local maximum beyond the minimum beside angle i, or -INFINITY. */
static double highest_beyond(int n, const double *gain, int i, int step)
{
    double most = -INFINITY;
    while (i + step >= 0 && i + step < n && gain[i + step] <= gain[i])
        i += step;
    for (; i + step > 0 && i + step < n - 1; i += step)
        if (gain[i + step] >= gain[i] && gain[i + step] >= gain[i + 2 * step]) most = fmax(most, gain[i + step]);
    return most;
}

hf_cut_figures hf_pattern_figures(int n, const double theta_deg[2], const double *gain)
{
    int top = 0;
    double step = (theta_deg[1] - theta_deg[0]) / (n - 1), beside = 0, more = 0;
    for (int i = 1; i < n; i++)
        if (gain[i] > gain[top]) top = i;
    if (top > 0 && top < n - 1) {
        double bend = 2 * gain[top] - gain[top - 1] - gain[top + 1], rise = gain[top + 1] - gain[top - 1];
        if (bend > 0) beside = rise / (2 * bend), more = rise * rise / (8 * bend);
    }
    hf_cut_figures f = {.gain_dBi = gain[top] + more, .beam_deg = theta_deg[0] + step * (top + beside)};
    double half = f.gain_dBi - HF_DB_PER_LN * HF_LN_2;
    f.half_power_width_deg = step * (crossing(n, gain, top, 1, half) - crossing(n, gain, top, -1, half));
    double first = fmax(next_maximum(n, gain, top, 1), next_maximum(n, gain, top, -1));
    double highest = fmax(highest_beyond(n, gain, top, 1), highest_beyond(n, gain, top, -1));
    f.first_sidelobe_dB = isfinite(first) ? first - f.gain_dBi : (double)NAN;
    f.highest_sidelobe_dB = isfinite(highest) ? highest - f.gain_dBi : (double)NAN;
    if (top == 0 || top == n - 1)
        f.doubt = HF_CUT_AT_END;
    else if (f.half_power_width_deg < HF_PATTERN_WIDTH_STEPS * step)
        f.doubt = HF_CUT_COARSE;
    if (f.doubt) f.half_power_width_deg = f.first_sidelobe_dB = f.highest_sidelobe_dB = (double)NAN;
    return f;
}

/* ---- tables ---- */

hf_status hf_pattern_table_create(int n_frequency, int n_cut, int n_theta, hf_pattern_table *t)
{
    size_t n = (size_t)n_frequency * (size_t)n_cut * (size_t)n_theta;
    *t = (hf_pattern_table){.n_frequency = n_frequency, .n_cut = n_cut, .n_theta = n_theta};
    return HF_ARENA_ARRAYS(&t->block, HF_ARRAY(t->frequency_Hz, n_frequency), HF_ARRAY(t->phi_deg, n_cut),
                           HF_ARRAY(t->theta_deg, n_theta), HF_ARRAY(t->co_dBi, n), HF_ARRAY(t->cross_dBi, n));
}

void hf_pattern_table_free(hf_pattern_table *t)
{
    hf_arena_free_block(t->block);
    *t = (hf_pattern_table){0};
}
