/* Computes the derivatives of a figure of a shape by the positions of the nodes, in one pass backwards:
 *
 *     figure -> derivatives by the current and the phase of each point
 *       -> by position and area of each point, and by position and direction of the feed
 *       -> refocused feed: by the best fit, which follows the points
 *       -> by the corners of the facets
 *
 * The pointing follows from the slope of ln |F|^2, which is 0 in the direction of the beam (implicit function).
 *
 * Contents: a point - gain - refocused feed - pointing - facets */
#include "surface/antenna.h"

#include "base/elementary.h"
#include "linalg/dense.h"
#include "surface/facet_mesh.h"
#include "surface/pattern_feed.h"

#include <math.h>
#include <string.h>

#define VIEW_STEP 1e-4 /* step of differences of slopes, over the width of the beam */

/* Derivatives of a figure by the points of a shape and by its feed. */
typedef struct {
    const hf_antenna *a;
    hf_antenna_points q;
    double *by;                    /* [6][n_point] by the position and the vector of area of each point */
    double by_feed[3], by_turn[3]; /* by shifts and turns of the feed */
} pull;

/* ---- a point ---- */

/* The light of a point in a direction: angle of its phase to that of the field, and current along the polarisation. */
typedef struct {
    double cosine, sine, size;
} glint;

static glint glint_of(const hf_antenna *a, const hf_antenna_points *q, const double direction[3],
                      const double center_m[3], const double phase[2], const double co[3], size_t i)
{
    const size_t n = (size_t)a->n_point;
    double along_m = -q->path_m[i], angle;
    glint g = {.size = 0};
    for (size_t d = 0; d < 3; d++) {
        along_m += direction[d] * (q->x[d * n + i] - center_m[d]);
        g.size += co[d] * q->current[d * n + i];
    }
    angle = 2 * HF_PI / a->beam.wavelength_m * along_m;
    g.cosine = hf_cosine(angle) * phase[0] + hf_sine(angle) * phase[1];
    g.sine = hf_sine(angle) * phase[0] - hf_cosine(angle) * phase[1];
    return g;
}

/* Adds the derivatives by point i and by the feed. The current is 2 up x field, and the phase is that of the way to
 * the point and on in the direction. A turn of the feed turns the field, and moves the point against it. */
static void pull_point(pull *g, const hf_feed *feed, const double direction[3], size_t i, const double by_current[3],
                       double by_phase)
{
    const size_t n = (size_t)g->a->n_point;
    const double *x = g->q.x, p[3] = {x[i], x[n + i], x[2 * n + i]}, up[3] = {x[3 * n + i], x[4 * n + i], x[5 * n + i]};
    const double by_path = -2 * HF_PI / g->a->beam.wavelength_m * by_phase;
    double toward[3], field[3], by_up[3], by_field[3], by_light[3], arm[3], turned[3], other[3];
    double path_m = hf_feed_light(feed, p, toward, field);
    if (!(hf_dot3(toward, up) < 0)) return;
    hf_cross(field, by_current, by_up);
    hf_cross(by_current, up, by_field);
    for (int d = 0; d < 3; d++) {
        double rate[3];
        hf_feed_light_rate(feed, p, (const double[3]){d == 0, d == 1, d == 2}, rate);
        by_light[d] = 2 * hf_dot3(rate, by_field);
        arm[d] = path_m * toward[d];
    }
    hf_cross(field, by_field, turned);
    hf_cross(arm, by_light, other);
    for (size_t d = 0; d < 3; d++) {
        g->by_turn[d] += 2 * turned[d] - other[d];
        by_light[d] += by_path * toward[d];
        g->by_feed[d] -= by_light[d];
        g->by[d * n + i] += by_light[d] - by_path * direction[d];
        g->by[(3 + d) * n + i] += 2 * by_up[d];
    }
}

/* ---- gain ---- */

static void pull_gain(pull *g, const hf_feed *feed)
{
    const hf_antenna *a = g->a;
    const double *field = g->q.field, size = sqrt(field[0] * field[0] + field[1] * field[1]);
    const double phase[2] = {field[0] / size, field[1] / size}, by_size = 2 * HF_DB_PER_LN / size;
    for (size_t i = 0; i < (size_t)a->n_point; i++) {
        glint l = glint_of(a, &g->q, feed->beam, (const double[3]){0}, phase, a->beam.co, i);
        double by_current[3];
        for (int d = 0; d < 3; d++)
            by_current[d] = by_size * l.cosine * a->beam.co[d];
        pull_point(g, feed, feed->beam, i, by_current, -by_size * l.size * l.sine);
    }
}

/* ---- refocused feed ---- */

/* Returns the derivatives by the point at which the feed is aimed. The turn of the axis a towards it also turns the
 * polarisation about a, because that one keeps its projection. */
static void pull_aim(const pull *g, const hf_feed *feed, const double vector_m[3], double by_aim[3])
{
    const double *axis = feed->axis;
    double turn[3], twist[3], part = hf_dot3(g->a->beam.feed.co, axis), along;
    memcpy(turn, g->by_turn, sizeof turn);
    if (feed->kind == HF_FEED_LINE) turn[0] = turn[2] = 0;
    hf_cross(turn, axis, by_aim);
    hf_cross(axis, feed->co, twist);
    for (int d = 0; d < 3 && feed->kind == HF_FEED_POINT; d++)
        by_aim[d] -= part / sqrt(1 - part * part) * hf_dot3(turn, axis) * twist[d];
    along = hf_dot3(by_aim, axis);
    for (int d = 0; d < 3; d++)
        by_aim[d] = (by_aim[d] - along * axis[d]) / hf_dot3(vector_m, axis);
    if (feed->kind == HF_FEED_LINE) by_aim[1] = 0;
}

/* Adds the derivatives by the best fit. It moves the points and their areas, and the feed by its focal length. */
static bool pull_fit(pull *g, const hf_surface_pose *pose, double by_longer)
{
    const size_t n = (size_t)g->a->n_point;
    const double *x = g->q.x, *by = g->by;
    double c = pose->curvature_per_m;
    hf_surface_motion by_fit = {.curve = -by_longer / (4 * c * c)};
    for (size_t i = 0; i < n; i++) {
        double of_place[3], of_area[3], arm[3], to[3], up[3], to_up[3];
        for (size_t d = 0; d < 3; d++) {
            arm[d] = x[d * n + i] - pose->center_m[d];
            to[d] = by[d * n + i];
            up[d] = x[(3 + d) * n + i];
            to_up[d] = by[(3 + d) * n + i];
        }
        hf_cross(arm, to, of_place);
        hf_cross(up, to_up, of_area);
        for (int d = 0; d < 3; d++) {
            by_fit.move[d] += to[d];
            by_fit.turn[d] += of_place[d] + of_area[d];
        }
    }
    return hf_surface_pose_pull(pose, (int)n, x, g->a->root_weight, &by_fit, g->by);
}

/* Turns vectors [3][n] from the frame of a pose back into that of the net. */
static void turn_back(const hf_surface_pose *pose, size_t n, double *vector)
{
    for (size_t i = 0; i < n; i++) {
        double v[3] = {vector[i], vector[n + i], vector[2 * n + i]};
        for (size_t d = 0; d < 3; d++)
            vector[d * n + i] = pose->turn[0][d] * v[0] + pose->turn[1][d] * v[1] + pose->turn[2][d] * v[2];
    }
}

static hf_status pull_refocused(pull *g, bool *exists)
{
    const hf_antenna *a = g->a;
    const size_t n = (size_t)a->n_point;
    hf_surface_pose pose;
    hf_feed feed;
    double vector_m[3], by_aim[3] = {0}, by_longer = 0, all = 0;
    HF_TRY(hf_antenna_fit(a, g->q.x, &pose, exists));
    if (!*exists || !isfinite(hf_antenna_refocused_dBi(a, &pose, NULL, &g->q, &feed))) {
        *exists = false;
        return HF_OK;
    }
    pull_gain(g, &feed);
    if (feed.kind != HF_FEED_PLANE_WAVE) {
        hf_antenna_aim_vector(a, g->q.x, 1 / (4 * pose.curvature_per_m) - a->focal_length_m, NULL, vector_m);
        pull_aim(g, &feed, vector_m, by_aim);
        by_longer = g->by_feed[2] - by_aim[2];
    }
    for (size_t i = 0; i < n; i++)
        all += a->root_weight[i] * a->root_weight[i];
    for (size_t i = 0; i < n; i++) /* the feed is aimed at the weighted mean of the points */
        for (size_t d = 0; d < 3; d++)
            g->by[d * n + i] += a->root_weight[i] * a->root_weight[i] / all * by_aim[d];
    *exists = pull_fit(g, &pose, by_longer);
    turn_back(&pose, n, g->by);
    turn_back(&pose, n, g->by + 3 * n);
    return HF_OK;
}

/* ---- pointing ---- */

/* Computes the second derivatives of ln |F|^2 at the maximum of the beam, 00, 01 and 11, from differences of slopes. */
static void bend_exactly(const pull *g, const double s[3], const hf_antenna_view *v, double bend[3])
{
    const double step = VIEW_STEP / sqrt(fmax(-v->bend[0], -v->bend[2]));
    double rate[2][2];
    for (int k = 0; k < 2; k++) {
        double slope[2][2];
        for (int side = 0; side < 2; side++) {
            hf_antenna_view at;
            double near[3], size;
            for (int d = 0; d < 3; d++)
                near[d] = s[d] + (side ? step : -step) * v->e[k][d];
            size = hf_norm(near[0], near[1], near[2]);
            for (int d = 0; d < 3; d++)
                near[d] /= size;
            hf_antenna_look(g->a, &g->q, near, &at);
            memcpy(slope[side], at.slope, sizeof at.slope);
        }
        for (int j = 0; j < 2; j++)
            rate[k][j] = (slope[1][j] - slope[0][j]) / (2 * step);
    }
    bend[0] = rate[0][0];
    bend[1] = (rate[0][1] + rate[1][0]) / 2;
    bend[2] = rate[1][1];
}

/* Adds the derivatives of the slope of ln |F|^2 along the vector `along`, by points that do not move the maximum. With
 * F' / F = j mu there, the slope changes by 2 Re (dF' - j mu dF)/F. */
static void pull_slope(pull *g, const double s[3], const hf_antenna_view *v, const double along[3])
{
    const hf_antenna *a = g->a;
    const size_t n = (size_t)a->n_point;
    const double wave = 2 * HF_PI / a->beam.wavelength_m, by_size = 2 / v->size, *center_m = a->start.center_m;
    const int axis = a->beam.polarisation == HF_POLARISATION_Y;
    double co[3], co_rate[3], mu = hf_dot3(along, v->e[0]) * v->middle[0] + hf_dot3(along, v->e[1]) * v->middle[1];
    double part = s[axis] / (1 + s[2]), by = (along[axis] - part * along[2]) / (1 + s[2]);
    hf_gain_polarisation(a->beam.polarisation, s, co);
    for (int d = 0; d < 3; d++)
        co_rate[d] = -by * (s[d] + (d == 2)) - part * along[d];
    for (size_t i = 0; i < n; i++) {
        glint l = glint_of(a, &g->q, s, center_m, v->phase, co, i);
        double arm = -mu, twist = 0, by_current[3];
        for (size_t d = 0; d < 3; d++) {
            arm += wave * along[d] * (g->q.x[d * n + i] - center_m[d]);
            twist += co_rate[d] * g->q.current[d * n + i];
            g->by[d * n + i] -= by_size * wave * along[d] * l.size * l.sine;
        }
        for (int d = 0; d < 3; d++)
            by_current[d] = by_size * (l.cosine * co_rate[d] - arm * l.sine * co[d]);
        pull_point(g, &a->beam.feed, s, i, by_current, -by_size * (twist * l.sine + arm * l.size * l.cosine));
    }
}

/* A beam in the direction of the feed has the minimum pointing, so its derivatives are 0. */
static bool pull_pointing(pull *g)
{
    const double *beam = g->a->beam.feed.beam;
    hf_antenna_view v;
    double s[3], bend[3], along[3], by[2], chord = 0, off[3];
    memcpy(s, beam, sizeof s);
    hf_antenna_light(g->a, &g->a->beam.feed, &g->q);
    if (!hf_antenna_aim(g->a, &g->q, s, &v)) return false;
    hf_antenna_look(g->a, &g->q, s, &v);
    for (int d = 0; d < 3; d++)
        off[d] = s[d] - beam[d];
    chord = hf_norm(off[0], off[1], off[2]);
    if (!(chord > 0)) return true;
    bend_exactly(g, s, &v, bend);
    for (int k = 0; k < 2; k++) /* the angle is 2 asin (chord/2) */
        by[k] = -hf_dot3(off, v.e[k]) / (chord * sqrt(1 - chord * chord / 4)) / HF_RAD_PER_DEG;
    double down = bend[0] * bend[2] - bend[1] * bend[1];
    double turn[2] = {(bend[2] * by[0] - bend[1] * by[1]) / down, (bend[0] * by[1] - bend[1] * by[0]) / down};
    for (int d = 0; d < 3; d++)
        along[d] = turn[0] * v.e[0][d] + turn[1] * v.e[1][d];
    pull_slope(g, s, &v, along);
    return true;
}

/* ---- facets ---- */

/* Adds the derivatives by the points of a facet to those by its corners. */
static void pull_facet(const pull *g, const hf_pattern_surface *shape, int i, double *gradient)
{
    const hf_gain_beam *b = &g->a->beam;
    const size_t n = (size_t)g->a->n_point;
    const int per_facet = b->order * b->order;
    hf_facet_mesh m;
    hf_facet_mesh_take_bent(shape->facets, i, shape->position_m, shape->sag_m, &m);
    for (int k = 0; k < per_facet; k++) {
        double u = b->at[k % b->order], v = b->at[k / b->order];
        double weight = b->weight[k % b->order] * b->weight[k / b->order];
        const double part[4] = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v}, by_u[4] = {v - 1, 1 - v, v, -v},
                     by_v[4] = {u - 1, -u, u, 1 - u};
        double p[3], du[3], dv[3], up[3], to_u[3], to_v[3];
        const double *by = g->by + i * per_facet + k;
        (shape->sag_m ? hf_facet_mesh_lifted : hf_facet_mesh_at)(&m, u, v, p, du, dv);
        for (size_t d = 0; d < 3; d++)
            up[d] = weight * by[(3 + d) * n];
        hf_cross(dv, up, to_u);
        hf_cross(up, du, to_v);
        for (int j = 0; j < 4; j++)
            for (size_t d = 0; d < 3; d++)
                gradient[3 * (size_t)shape->facets->corner[4 * i + j] + d] +=
                    part[j] * by[d * n] + by_u[j] * to_u[d] + by_v[j] * to_v[d];
    }
}

hf_status hf_antenna_gradient(const hf_antenna *a, unsigned group, const hf_pattern_surface *shape, int n_node,
                              double *gradient, bool *exists)
{
    pull g = {.a = a};
    double *scratch;
    void *block;
    hf_status status = HF_OK;
    memset(gradient, 0, 3 * (size_t)n_node * sizeof *gradient);
    *exists = false;
    if (a->is_too_coarse) return HF_OK;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(scratch, hf_antenna_scratch(a)), HF_ARRAY(g.by, 6 * (size_t)a->n_point)));
    g.q = hf_antenna_points_of(a, shape, scratch);
    if (group == HF_ANTENNA_REFOCUSED) {
        status = pull_refocused(&g, exists);
    } else if (group == HF_ANTENNA_POINTING) {
        *exists = pull_pointing(&g);
    } else {
        hf_antenna_light(a, &a->beam.feed, &g.q);
        *exists = g.q.field[0] != 0 || g.q.field[1] != 0;
        if (*exists) pull_gain(&g, &a->beam.feed);
    }
    for (int i = 0; i < shape->facets->n_facet && *exists; i++)
        pull_facet(&g, shape, i, gradient);
    hf_arena_free_block(block);
    return status;
}
