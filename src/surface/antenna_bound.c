/* Computes bounds of the change of the figures of a shape, to first order, for nodes that move by at most delta:
 *
 *     each point moves by at most delta -> changes of its phase, current, half-path error
 *       -> fixed feed: gain, spread; slope of the gain at the maximum of the beam -> pointing
 *       -> refocused feed: the same in the frame of the best fit; derivatives of the gain by the parameters of the fit
 *            -> gain
 *
 * The spread after the best fit is a minimum over the parameters of the fit. Its derivative therefore does not contain
 * theirs. Contents: a point - gain - spread - pointing - a shape */
#include "surface/antenna.h"

#include "base/elementary.h"
#include "surface/facet_mesh.h"
#include "surface/pattern_feed.h"

#include <math.h>
#include <string.h>

#define FIT_STEP 1e-6 /* step of central differences by the parameters of a fit, which are of order one */
#define TWIST_MOST 2  /* maximum change of the unit vector of polarisation per rad, for directions above the horizon */

/* A shape with its points, and how much they move. */
typedef struct {
    const hf_antenna *a;
    double delta_m;
    double *side_m; /* [n_point] weight of the point times the lengths of du and dv */
    double *moved;  /* [6][n_point] points of a moved fit */
} moves;

/* ---- a point ---- */

/* Writes the lengths of the sides of the area of each point. Points that fill the last lanes have none. */
static void measure_sides(moves *b, const hf_pattern_surface *s)
{
    const hf_gain_beam *beam = &b->a->beam;
    const int per_facet = beam->order * beam->order;
    for (int i = 0; i < per_facet * s->facets->n_facet; i++) {
        hf_facet_mesh m;
        int j = i % beam->order, l = i / beam->order % beam->order;
        double p[3], du[3], dv[3];
        hf_facet_mesh_take(s->facets, i / per_facet, s->position_m, &m);
        hf_facet_mesh_at(&m, beam->at[j], beam->at[l], p, du, dv);
        b->side_m[i] = beam->weight[j] * beam->weight[l] * (sqrt(hf_dot3(du, du)) + sqrt(hf_dot3(dv, dv)));
    }
}

/* What is known of a point: its current, the angle of its phase to that of the field, and bounds of the changes of
 * phase and current. */
typedef struct {
    double size, current, cosine, sine, turn, grow;
} change;

static change change_at(const moves *b, const hf_feed *feed, const hf_antenna_points *q, const double s[3],
                        const double co[3], const double phase[2], size_t i)
{
    const size_t n = (size_t)b->a->n_point;
    const double p[3] = {q->x[i], q->x[n + i], q->x[2 * n + i]}, wave = 2 * HF_PI / b->a->beam.wavelength_m;
    const double c[3] = {q->current[i], q->current[n + i], q->current[2 * n + i]};
    double toward[3], field[3], square = 0, rates = 0, area = 0;
    double path_m = hf_feed_light(feed, p, toward, field), angle = wave * (hf_dot3(s, p) - path_m);
    for (int d = 0; d < 3; d++) {
        double rate[3], up = q->x[(size_t)(3 + d) * n + i];
        hf_feed_light_rate(feed, p, (const double[3]){d == 0, d == 1, d == 2}, rate);
        rates += hf_dot3(rate, rate);
        square += (s[d] - toward[d]) * (s[d] - toward[d]);
        area += up * up;
    }
    change to = {.size = hf_dot3(co, c), .current = sqrt(hf_dot3(c, c)), .turn = wave * sqrt(square) * b->delta_m};
    to.cosine = hf_cosine(angle) * phase[0] + hf_sine(angle) * phase[1];
    to.sine = hf_sine(angle) * phase[0] - hf_cosine(angle) * phase[1];
    if (to.current > 0) /* du and dv change by at most 2 delta */
        to.grow = 2 * b->delta_m * (2 * b->side_m[i] * sqrt(hf_dot3(field, field)) + sqrt(area * rates));
    return to;
}

/* ---- gain ---- */

static double bound_gain_dB(const moves *b, const hf_feed *feed, const hf_antenna_points *q)
{
    double size = sqrt(q->field[0] * q->field[0] + q->field[1] * q->field[1]), sum = 0;
    const double phase[2] = {q->field[0] / size, q->field[1] / size};
    for (size_t i = 0; i < (size_t)b->a->n_point; i++) {
        change c = change_at(b, feed, q, feed->beam, b->a->beam.co, phase, i);
        sum += fabs(c.size * c.sine) * c.turn + fabs(c.cosine) * c.grow;
    }
    return 2 * HF_DB_PER_LN * sum / size;
}

/* Returns the change of the refocused gain for a step of parameter k of the fit, or of the aim of the feed along k - 6,
 * over the step. x: points in the frame of the net. */
static double rate_of_gain(const moves *b, const double *x, const hf_surface_pose *pose, int k, hf_antenna_points *q)
{
    double gain_dBi[2];
    hf_feed feed;
    for (int side = 0; side < 2; side++) {
        double step[HF_FIT_N_PARAMETER + 3] = {0};
        step[k] = side ? FIT_STEP : -FIT_STEP;
        hf_surface_pose moved = hf_surface_pose_moved(pose, step);
        memcpy(b->moved, x, 6 * (size_t)b->a->n_point * sizeof *x);
        hf_antenna_points at = {.x = b->moved, .current = q->current, .path_m = q->path_m};
        gain_dBi[side] = hf_antenna_refocused_dBi(b->a, &moved, step + HF_FIT_N_PARAMETER, &at, &feed);
    }
    return (gain_dBi[1] - gain_dBi[0]) / (2 * FIT_STEP);
}

/* Returns the bound of the change of the gain by the best fit and by the aim of the feed, which follow the points. */
static double bound_refocusing_dB(const moves *b, const double *x, const hf_surface_pose *pose, hf_antenna_points *q)
{
    double gradient[HF_FIT_N_PARAMETER + 3];
    for (int k = 0; k < HF_FIT_N_PARAMETER + 3; k++)
        gradient[k] = rate_of_gain(b, x, pose, k, q);
    const double *by_aim = gradient + HF_FIT_N_PARAMETER;
    return hf_surface_pose_bound(pose, b->a->n_point, x, b->a->root_weight, gradient, b->delta_m) +
           sqrt(hf_dot3(by_aim, by_aim)) * b->delta_m;
}

/* ---- spread ---- */

static void bound_spread(const moves *b, double curvature, const double *x, double rms_m, hf_antenna_feed *to)
{
    const hf_antenna *a = b->a;
    const size_t n = (size_t)a->n_point;
    double all = 0, sum = 0, phase = 4 * HF_PI / a->beam.wavelength_m;
    for (size_t i = 0; i < n; i++) {
        double d[4], p[3] = {x[i], x[n + i], x[2 * n + i]}, weight = a->root_weight[i] * a->root_weight[i];
        hf_fit_error(a->kind, 1, curvature, p, d);
        all += weight;
        sum += weight * hf_dot3(d, d);
    }
    to->half_path_rms_m = b->delta_m * sqrt(sum / all);
    to->ruze_loss_dB = 2 * HF_DB_PER_LN * phase * phase * rms_m * to->half_path_rms_m;
}

/* ---- pointing ---- */

/* At the maximum of |F|^2, the slope is 2 Re(F'/F) = 0. It changes by 2 Re((dF' - (F'/F) dF)/F), and the maximum moves
 * by this change over the second derivative. */
static double bound_pointing_deg(const moves *b, const hf_antenna_points *q)
{
    const hf_antenna *a = b->a;
    const size_t n = (size_t)a->n_point;
    const double wave = 2 * HF_PI / a->beam.wavelength_m;
    hf_antenna_view v;
    double s[3], co[3], sum[2] = {0};
    memcpy(s, a->beam.feed.beam, sizeof s);
    if (!hf_antenna_aim(a, q, s, &v)) return (double)NAN;
    hf_antenna_look(a, q, s, &v);
    hf_gain_polarisation(a->beam.polarisation, s, co);
    double phase[2] = {v.phase[0], v.phase[1]}, turn = wave * hf_dot3(s, a->start.center_m);
    phase[0] = v.phase[0] * hf_cosine(turn) - v.phase[1] * hf_sine(turn); /* the view is relative to this centre */
    phase[1] = v.phase[0] * hf_sine(turn) + v.phase[1] * hf_cosine(turn);
    for (size_t i = 0; i < n; i++) {
        change c = change_at(b, &a->beam.feed, q, s, co, phase, i);
        double p[3] = {q->x[i] - a->start.center_m[0], q->x[n + i] - a->start.center_m[1],
                       q->x[2 * n + i] - a->start.center_m[2]};
        for (int k = 0; k < 2; k++) {
            double arm = fabs(wave * hf_dot3(v.e[k], p) - v.middle[k]);
            sum[k] += arm * (c.grow * fabs(c.sine) + fabs(c.size * c.cosine) * c.turn) +
                      fabs(c.size * c.sine) * wave * b->delta_m + TWIST_MOST * (c.grow + c.current * c.turn);
        }
    }
    double half = (v.bend[0] + v.bend[2]) / 2, apart = (v.bend[0] - v.bend[2]) / 2;
    double least = -half - sqrt(apart * apart + v.bend[1] * v.bend[1]); /* smaller curvature of the beam */
    return 2 * sqrt(sum[0] * sum[0] + sum[1] * sum[1]) / v.size / least / HF_RAD_PER_DEG;
}

/* ---- a shape ---- */

hf_status hf_antenna_bound(const hf_antenna *a, unsigned what, const hf_pattern_surface *shape, double position_error_m,
                           hf_antenna_figures *to)
{
    moves b = {.a = a, .delta_m = position_error_m};
    const size_t n = (size_t)a->n_point;
    hf_antenna_figures is;
    hf_surface_pose pose = {0};
    bool is_found = false;
    double *scratch, *x;
    void *block;
    hf_antenna_blank(to);
    if (a->is_too_coarse) return HF_OK;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(scratch, hf_antenna_scratch(a)), HF_ARRAY(x, 6 * n),
                           HF_ARRAY(b.moved, 6 * n), HF_ARRAY(b.side_m, n)));
    hf_status status = hf_antenna_measure(a, what, shape, scratch, &is);
    hf_antenna_points q = hf_antenna_points_of(a, shape, scratch);
    memcpy(x, q.x, 6 * n * sizeof *x);
    measure_sides(&b, shape);
    hf_antenna_light(a, &a->beam.feed, &q);
    if (what & HF_ANTENNA_FIXED) {
        bound_spread(&b, 1 / (4 * a->focal_length_m), q.x, is.fixed.half_path_rms_m, &to->fixed);
        to->fixed.gain_dBi = to->fixed.gain_loss_dB = bound_gain_dB(&b, &a->beam.feed, &q);
    }
    if (what & HF_ANTENNA_POINTING) to->pointing_deg = bound_pointing_deg(&b, &q);
    if (status == HF_OK && what & HF_ANTENNA_REFOCUSED) status = hf_antenna_fit(a, x, &pose, &is_found);
    if (status == HF_OK && is_found && pose.n == HF_FIT_N_PARAMETER) {
        hf_feed feed;
        double more_dB = bound_refocusing_dB(&b, x, &pose, &q);
        hf_antenna_refocused_dBi(a, &pose, NULL, &q, &feed);
        bound_spread(&b, pose.curvature_per_m, q.x, is.refocused.half_path_rms_m, &to->refocused);
        to->refocused.gain_dBi = to->refocused.gain_loss_dB = bound_gain_dB(&b, &feed, &q) + more_dB;
    }
    hf_arena_free_block(block);
    return status;
}
