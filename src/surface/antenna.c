/* Computes the figures of a shape as a reflector antenna:
 *
 *     shape -> quadrature points with their vectors of area
 *       -> half-path errors -> weighted spread, fixed feed
 *       -> best fit (surface_near) -> weighted spread, refocused feed
 *       -> currents with the fixed feed -> gain; Newton's method over the direction -> pointing
 *       -> points in the frame of the best fit -> currents with the refocused feed -> gain
 *     derivatives of the gain and of the pointing: antenna_gradient.c
 *
 * Contents: points - currents - errors - best fit - pointing - a shape - the antenna */
#include "surface/antenna.h"

#include "base/elementary.h"
#include "linalg/dense.h"
#include "net/target_surface.h"
#include "surface/antenna_kernel.h"
#include "surface/facet_mesh.h"

#include <math.h>
#include <string.h>

static const hf_antenna_kernels *const kernels_of_isa[] = {HF_LANE_EACH(&hf_antenna_kernels)};

#define ORDER_LEAST 4 /* with 3 the weighted errors of facets are off by 2e-4 of their size; with 4 by 1e-7 */
#define NEWTON_STEPS_MAX 20
#define NEWTON_SETTLED 1e-11 /* rad; a beam is wider than 1e-4 rad */
#define COHERENT_LEAST 0.5   /* part of the power density of the currents in phase that makes a beam the main beam */

/* ---- points ---- */

/* Computes the points of all facets, x [6][n]: position, then the vector of area in the direction of the normal. Points
 * that fill the last lanes have no area. */
static void put_points(const hf_antenna *a, const hf_pattern_surface *s, double *x)
{
    const hf_gain_beam *b = &a->beam;
    const size_t n = (size_t)a->n_point;
    const int per_facet = b->order * b->order;
    for (int i = 0; i < a->facets->n_facet; i++) {
        hf_facet_mesh m;
        hf_facet_mesh_take_bent(a->facets, i, s->position_m, s->sag_m, &m);
        for (int k = 0; k < per_facet; k++) {
            int j = k % b->order, l = k / b->order;
            double p[3] = {0}, du[3], dv[3], up[3], weight = b->weight[j] * b->weight[l];
            (s->sag_m ? hf_facet_mesh_lifted : hf_facet_mesh_at)(&m, b->at[j], b->at[l], p, du, dv);
            hf_cross(du, dv, up);
            double *to = x + i * per_facet + k;
            for (size_t d = 0; d < 3; d++) {
                to[d * n] = p[d];
                to[(3 + d) * n] = weight * up[d];
            }
        }
    }
    for (size_t i = (size_t)(per_facet * a->facets->n_facet); i < n; i++)
        for (size_t d = 0; d < 3; d++) {
            x[d * n + i] = x[d * n + i - 1];
            x[(3 + d) * n + i] = 0;
        }
}

/* Moves the points along z to the target surface. Their areas seen along z do not change. */
static void drop_points(const hf_antenna *a, double *x)
{
    const size_t n = (size_t)a->n_point;
    for (size_t i = 0; i < n; i++) {
        double p[3] = {x[i], x[n + i], x[2 * n + i]}, slope[2];
        x[2 * n + i] -= hf_target_surface_height_above(a->kind, 1 / (4 * a->focal_length_m), p, slope);
        for (size_t d = 0; d < 2; d++)
            x[(3 + d) * n + i] = -slope[d] * x[5 * n + i];
    }
}

/* Moves the points into the frame of a pose. */
static void turn_points(const hf_surface_pose *q, size_t n, double *x)
{
    for (size_t i = 0; i < n; i++) {
        double p[3], up[3];
        for (size_t d = 0; d < 3; d++) {
            p[d] = x[d * n + i] - q->center_m[d] - q->shift_m[d];
            up[d] = x[(3 + d) * n + i];
        }
        for (size_t d = 0; d < 3; d++) {
            x[d * n + i] = hf_dot3(q->turn[d], p) + q->center_m[d];
            x[(3 + d) * n + i] = hf_dot3(q->turn[d], up);
        }
    }
}

/* ---- currents ---- */

void hf_antenna_light(const hf_antenna *a, const hf_feed *feed, hf_antenna_points *q)
{
    double sum[3];
    kernels_of_isa[hf_lane_best_isa()]->light(feed, a->beam.co, a->beam.wavelength_m, a->n_point, q->x, q->current,
                                              q->path_m, sum);
    memcpy(q->field, sum, sizeof q->field);
    q->in_phase = sum[2];
}

static double gain_dBi(const hf_antenna *a, const hf_antenna_points *q)
{
    double power = q->field[0] * q->field[0] + q->field[1] * q->field[1];
    double gain = a->beam.feed.scale * power / (a->beam.wavelength_m * a->beam.wavelength_m);
    return gain > 1e-300 ? HF_DB_PER_LN * hf_logarithm(gain) : (double)NAN;
}

/* Computes the mean of the points, weighted by their illumination at the target positions. */
static void find_middle(const hf_antenna *a, const double *x, double middle_m[3])
{
    const size_t n = (size_t)a->n_point;
    double all = 0, sum[3] = {0};
    for (size_t i = 0; i < n; i++) {
        double weight = a->root_weight[i] * a->root_weight[i];
        all += weight;
        for (size_t d = 0; d < 3; d++)
            sum[d] += weight * x[d * n + i];
    }
    for (int d = 0; d < 3; d++)
        middle_m[d] = sum[d] / all;
}

/* The point has moved with the weighted mean of the points, as seen from the feed. */
void hf_antenna_aim_vector(const hf_antenna *a, const double *x, double longer_m, const double *beside_m,
                           double vector_m[3])
{
    const hf_feed *f = &a->beam.feed;
    double middle_m[3], along = 0;
    find_middle(a, x, middle_m);
    for (int d = 0; d < 3; d++)
        along += (a->middle_m[d] - f->position_m[d]) * f->axis[d];
    for (int d = 0; d < 3; d++) {
        double move_m = middle_m[d] + ((beside_m ? beside_m[d] : 0) - a->middle_m[d] - (d == 2 ? longer_m : 0));
        vector_m[d] = along * f->axis[d] + move_m;
    }
    if (f->kind == HF_FEED_LINE) vector_m[1] = 0;
}

/* Turns the axis of a feed into the direction of a vector. */
static void aim(const double vector_m[3], hf_feed *feed)
{
    double part, size = hf_norm(vector_m[0], vector_m[1], vector_m[2]);
    for (int d = 0; d < 3; d++)
        feed->axis[d] = vector_m[d] / size;
    if (feed->kind == HF_FEED_LINE) return;
    part = hf_dot3(feed->co, feed->axis);
    for (int d = 0; d < 3; d++)
        feed->co[d] = (feed->co[d] - part * feed->axis[d]) / sqrt(1 - part * part);
}

double hf_antenna_refocused_dBi(const hf_antenna *a, const hf_surface_pose *pose, const double *beside_m,
                                hf_antenna_points *q, hf_feed *feed)
{
    double vector_m[3], longer_m = 1 / (4 * pose->curvature_per_m) - a->focal_length_m;
    *feed = a->beam.feed;
    turn_points(pose, (size_t)a->n_point, q->x);
    hf_antenna_aim_vector(a, q->x, longer_m, beside_m, vector_m);
    feed->position_m[2] += longer_m;
    if (feed->kind != HF_FEED_PLANE_WAVE) aim(vector_m, feed);
    hf_antenna_light(a, feed, q);
    return gain_dBi(a, q);
}

/* ---- errors ---- */

/* Returns the weighted RMS of the half-path errors about their mean, against the surface of this curvature. The gain
 * does not depend on the mean. */
static double spread_m(const hf_antenna *a, double curvature, const double *x)
{
    const size_t n = (size_t)a->n_point;
    double all = 0, sum = 0, square = 0;
    for (size_t i = 0; i < n; i++) {
        double p[3] = {x[i], x[n + i], x[2 * n + i]}, t[2], weight = a->root_weight[i] * a->root_weight[i];
        double e = hf_target_surface_height_above(a->kind, curvature, p, t) / (1 + t[0] * t[0] + t[1] * t[1]);
        all += weight;
        sum += weight * e;
        square += weight * e * e;
    }
    return sqrt(fmax(square / all - sum / all * (sum / all), 0));
}

static void judge(const hf_antenna *a, const hf_antenna_points *q, double curvature, hf_antenna_feed *to)
{
    to->half_path_rms_m = spread_m(a, curvature, q->x);
    to->ruze_loss_dB = hf_surface_gain_loss_dB(to->half_path_rms_m, HF_LIGHT_M_PER_S / a->beam.wavelength_m);
    to->gain_dBi = gain_dBi(a, q);
    to->gain_loss_dB = a->smooth_dBi - to->gain_dBi;
}

/* ---- best fit ---- */

hf_status hf_antenna_fit(const hf_antenna *a, const double *x, hf_surface_pose *pose, bool *is_found)
{
    hf_surface_fit fit;
    hf_fit_parameters parameters;
    double rms_m;
    *is_found = hf_surface_pose_near(&a->start, a->n_point, x, a->root_weight, pose, &rms_m);
    if (*is_found) return HF_OK;
    HF_TRY(hf_surface_fit_find(a->kind, a->focal_length_m, a->n_point, x, a->root_weight, &fit, &parameters));
    *is_found = fit.converged;
    *pose = hf_surface_pose_of(a->kind, a->focal_length_m, &fit, &parameters);
    return HF_OK;
}

/* ---- pointing ---- */

/* Computes two unit vectors across s. */
static void across(const double s[3], double e[2][3])
{
    int k = fabs(s[0]) < fabs(s[1]) ? 0 : 1;
    double axis[3] = {k == 0, k == 1, 0}, size;
    hf_cross(s, axis, e[0]);
    size = sqrt(hf_dot3(e[0], e[0]));
    for (int d = 0; d < 3; d++)
        e[0][d] /= size;
    hf_cross(s, e[0], e[1]);
}

/* Turns s by the tangent vector step[0] e[0] + step[1] e[1]. */
static void turn_direction(double s[3], double e[2][3], const double step[2])
{
    for (int d = 0; d < 3; d++)
        s[d] += step[0] * e[0][d] + step[1] * e[1][d];
    double size = sqrt(hf_dot3(s, s));
    for (int d = 0; d < 3; d++)
        s[d] /= size;
}

/* Turns s so that the weighted paths to a point of each facet have no slope across it. The paths in metres, unlike
 * phases, have no whole turns that are lost, so this direction is in the main beam for any tilt of the shape. Returns
 * false if the points are on a line. */
static bool level_paths(const hf_antenna *a, const hf_antenna_points *q, double s[3])
{
    const size_t n = (size_t)a->n_point;
    const int per_facet = a->beam.order * a->beam.order;
    double e[2][3], matrix[9] = {0}, right[3] = {0};
    int pivot[3];
    across(s, e);
    for (int k = 0; k < a->facets->n_facet; k++) {
        size_t i = (size_t)(k * per_facet + per_facet / 2);
        const double *c = a->start.center_m, weight = a->root_weight[i] * a->root_weight[i];
        double p[3] = {q->x[i] - c[0], q->x[n + i] - c[1], q->x[2 * n + i] - c[2]};
        double row[3] = {1, hf_dot3(e[0], p), hf_dot3(e[1], p)}, path = hf_dot3(s, p) - q->path_m[i];
        for (int j = 0; j < 3; j++) {
            right[j] -= weight * row[j] * path;
            for (int l = 0; l < 3; l++)
                matrix[3 * j + l] += weight * row[j] * row[l];
        }
    }
    if (hf_dense_factor(3, matrix, pivot) != 0) return false;
    hf_dense_solve(3, matrix, pivot, 1, right);
    turn_direction(s, e, right + 1);
    return true;
}

static void multiply(const double a[2], const double b[2], double to[2])
{
    double re = a[0] * b[0] - a[1] * b[1];
    to[1] = a[0] * b[1] + a[1] * b[0];
    to[0] = re;
}

void hf_antenna_look(const hf_antenna *a, const hf_antenna_points *q, const double s[3], hf_antenna_view *v)
{
    hf_antenna_sums sum;
    double co[3], one_over[2], rate[2][2];
    const int along = a->beam.polarisation == HF_POLARISATION_Y;
    across(s, v->e);
    hf_gain_polarisation(a->beam.polarisation, s, co);
    kernels_of_isa[hf_lane_best_isa()]->look(s, v->e, co, a->start.center_m, a->beam.wavelength_m, a->n_point, q->x,
                                             q->current, q->path_m, &sum);
    const double *F = sum.moment[0];
    v->size = sqrt(F[0] * F[0] + F[1] * F[1]);
    for (int c = 0; c < 2; c++) {
        v->phase[c] = F[c] / v->size;
        one_over[c] = (c ? -1 : 1) * v->phase[c] / v->size;
    }
    for (int k = 0; k < 2; k++) { /* F' = co' . N + j (first moment) */
        double down = 1 + s[2], part = s[along] / down, by = (v->e[k][along] - part * v->e[k][2]) / down;
        double of[2] = {-sum.moment[1 + k][1], sum.moment[1 + k][0]};
        for (int d = 0; d < 3; d++)
            for (int c = 0; c < 2; c++)
                of[c] -= (by * (s[d] + (d == 2)) + part * v->e[k][d]) * sum.current[d][c];
        multiply(of, one_over, rate[k]);
        v->slope[k] = 2 * rate[k][0];
        v->middle[k] = rate[k][1];
    }
    for (int k = 0; k < 3; k++) { /* F'' is - (second moment), up to terms smaller by the size over the wavelength */
        double of[2], square[2];
        multiply(sum.moment[3 + k], one_over, of);
        multiply(rate[k / 2], rate[(k + 1) / 2], square);
        v->bend[k] = 2 * (-of[0] - square[0]);
    }
}

/* Returns the angle between two unit vectors whose difference has this length. */
static double angle_of_chord(double chord)
{
    double half = chord / 2, angle = half;
    for (int k = 0; k < 6 && half < 0.99; k++)
        angle -= (hf_sine(angle) - half) / hf_cosine(angle);
    return 2 * angle;
}

bool hf_antenna_aim(const hf_antenna *a, const hf_antenna_points *q, double s[3], hf_antenna_view *v)
{
    if (!level_paths(a, q, s)) return false;
    for (int k = 0; k < NEWTON_STEPS_MAX; k++) {
        hf_antenna_look(a, q, s, v);
        double down = v->bend[0] * v->bend[2] - v->bend[1] * v->bend[1], step[2];
        if (!(v->bend[0] < 0 && down > 0)) return false;
        step[0] = -(v->bend[2] * v->slope[0] - v->bend[1] * v->slope[1]) / down;
        step[1] = -(v->bend[0] * v->slope[1] - v->bend[1] * v->slope[0]) / down;
        turn_direction(s, v->e, step);
        if (fmax(fabs(step[0]), fabs(step[1])) < NEWTON_SETTLED)
            return v->size * v->size >= COHERENT_LEAST * q->in_phase * q->in_phase;
    }
    return false;
}

static double pointing_deg(const hf_antenna *a, const hf_antenna_points *q)
{
    hf_antenna_view v;
    double s[3];
    memcpy(s, a->beam.feed.beam, sizeof s);
    return hf_antenna_aim(a, q, s, &v) ? angle_of_chord(hf_distance(s, a->beam.feed.beam)) / HF_RAD_PER_DEG
                                       : (double)NAN;
}

/* ---- a shape ---- */

size_t hf_antenna_scratch(const hf_antenna *a)
{
    return 10 * (size_t)a->n_point;
}

hf_antenna_points hf_antenna_points_of(const hf_antenna *a, const hf_pattern_surface *shape, double *scratch)
{
    const size_t n = (size_t)a->n_point;
    hf_antenna_points q = {.x = scratch, .current = scratch + 6 * n, .path_m = scratch + 9 * n};
    put_points(a, shape, q.x);
    return q;
}

void hf_antenna_blank(hf_antenna_figures *to)
{
    const hf_antenna_feed none = {NAN, NAN, NAN, NAN};
    *to = (hf_antenna_figures){none, none, NAN};
}

hf_status hf_antenna_measure(const hf_antenna *a, unsigned what, const hf_pattern_surface *shape, double *scratch,
                             hf_antenna_figures *to)
{
    hf_surface_pose pose;
    hf_feed feed;
    bool is_found = false;
    hf_antenna_blank(to);
    if (a->is_too_coarse) return HF_OK;
    hf_antenna_points q = hf_antenna_points_of(a, shape, scratch);
    if (what & HF_ANTENNA_REFOCUSED) HF_TRY(hf_antenna_fit(a, q.x, &pose, &is_found));
    if (what & (HF_ANTENNA_FIXED | HF_ANTENNA_POINTING)) hf_antenna_light(a, &a->beam.feed, &q);
    if (what & HF_ANTENNA_FIXED) judge(a, &q, 1 / (4 * a->focal_length_m), &to->fixed);
    if (what & HF_ANTENNA_POINTING) to->pointing_deg = pointing_deg(a, &q);
    if (!is_found) return HF_OK;
    hf_antenna_refocused_dBi(a, &pose, NULL, &q, &feed);
    judge(a, &q, pose.curvature_per_m, &to->refocused);
    return HF_OK;
}

/* ---- the antenna ---- */

/* Makes the best fit to a shape the start of other fits. */
static hf_status start_from(hf_antenna *a, const hf_pattern_surface *shape, double *scratch)
{
    hf_surface_pose pose;
    bool is_found;
    hf_antenna_points q = hf_antenna_points_of(a, shape, scratch);
    a->start = hf_surface_pose_of_target(a->kind, a->focal_length_m, a->n_point, q.x);
    HF_TRY(hf_antenna_fit(a, q.x, &pose, &is_found));
    if (is_found) a->start = pose;
    return HF_OK;
}

hf_status hf_antenna_near(const hf_antenna *a, const hf_pattern_surface *design, double *scratch, hf_antenna *near)
{
    *near = *a;
    return a->is_too_coarse ? HF_OK : start_from(near, design, scratch);
}

hf_status hf_antenna_make(const hf_surface_settings *s, const hf_facets *facets, const double *position_m,
                          double frequency_Hz, hf_antenna *a)
{
    const hf_pattern_surface target = {facets, position_m, NULL};
    double *scratch;
    void *block;
    *a = (hf_antenna){.facets = facets, .kind = s->kind, .focal_length_m = s->focal_length_m};
    hf_gain_beam_make(s, facets, position_m, frequency_Hz, &a->beam);
    a->is_too_coarse = a->beam.order >= HF_GAIN_ORDER_MOST;
    if (a->beam.order < ORDER_LEAST) {
        a->beam.order = ORDER_LEAST;
        hf_gauss_rule(a->beam.order, a->beam.at, a->beam.weight);
    }
    a->n_point = (a->beam.order * a->beam.order * facets->n_facet + HF_LANES - 1) / HF_LANES * HF_LANES;
    if (a->is_too_coarse) return HF_OK;
    const size_t n = (size_t)a->n_point;
    HF_TRY(HF_ARENA_ARRAYS(&a->block, HF_ARRAY(a->root_weight, n)));
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(scratch, hf_antenna_scratch(a))));
    hf_antenna_points q = hf_antenna_points_of(a, &target, scratch);
    drop_points(a, q.x);
    hf_antenna_light(a, &a->beam.feed, &q);
    a->smooth_dBi = gain_dBi(a, &q);
    for (size_t i = 0; i < n; i++) {
        const double current[3] = {q.current[i], q.current[n + i], q.current[2 * n + i]};
        a->root_weight[i] = sqrt(fabs(hf_dot3(a->beam.co, current)));
    }
    find_middle(a, q.x, a->middle_m);
    hf_status status = start_from(a, &target, scratch);
    hf_arena_free_block(block);
    return status;
}

void hf_antenna_free(hf_antenna *a)
{
    hf_arena_free_block(a->block);
    *a = (hf_antenna){0};
}
