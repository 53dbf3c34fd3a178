/* Measures the gain in the direction of the beam as a sum of currents with phases:
 *
 *     beam: feed, polarisation, order of quadrature
 *     shape -> quadrature points of all facets -> current and phase of each -> loss in dB, or residuals
 *     linearise: derivatives of current and phase by each point -> push: motion -> rates of the residuals
 *
 * Contents: the beam - a point - loss of a shape - an objective - derivatives */
#include "surface/gain.h"

#include "base/elementary.h"
#include "surface/facet_mesh.h"
#include "surface/pattern_feed.h"

#include <float.h>
#include <math.h>

#define ORDER_LN (-11.5) /* logarithm of the quadrature error, 1e-5 */
#define ERROR_PHASE 0.5  /* rad, by which errors of the shape may increase half of the phase across a facet */

/* ---- the beam ---- */

/* Returns half of the maximum phase across facet i along its sides, rad. */
static double phase_across(const hf_gain_beam *b, const hf_facets *facets, int i, const double *position_m)
{
    hf_facet_mesh m;
    double most_m = 0;
    hf_facet_mesh_take(facets, i, position_m, &m);
    for (int k = 0; k < 4; k++) {
        double toward[3], field[3], along[2] = {0};
        const double *side[2] = {m.corner[(k + 1) % 4], m.corner[(k + 3) % 4]};
        hf_feed_light(&b->feed, m.corner[k], toward, field);
        for (int d = 0; d < 3; d++)
            for (int s = 0; s < 2; s++)
                along[s] += (b->feed.beam[d] - toward[d]) * (side[s][d] - m.corner[k][d]);
        most_m = fmax(most_m, fmax(fabs(along[0]), fabs(along[1])));
    }
    return HF_PI / b->wavelength_m * most_m;
}

void hf_gain_polarisation(hf_polarisation polarisation, const double to[3], double co[3])
{
    const int along = polarisation == HF_POLARISATION_Y;
    for (int d = 0; d < 3; d++) /* as in the cuts */
        co[d] = (d == along) - to[along] / (1 + to[2]) * (to[d] + (d == 2));
}

void hf_gain_beam_make(const hf_surface_settings *s, const hf_facets *facets, const double *position_m,
                       double frequency_Hz, hf_gain_beam *b)
{
    double most = 0;
    *b = (hf_gain_beam){.wavelength_m = HF_LIGHT_M_PER_S / frequency_Hz, .polarisation = s->pattern.polarisation};
    hf_feed_make(s, facets, position_m, &b->feed);
    hf_gain_polarisation(b->polarisation, b->feed.beam, b->co);
    for (int i = 0; i < facets->n_facet; i++)
        most = fmax(most, phase_across(b, facets, i, position_m));
    b->order = hf_gauss_order(most + ERROR_PHASE, ORDER_LN, HF_GAIN_ORDER_MOST);
    hf_gauss_rule(b->order, b->at, b->weight);
}

/* ---- a point ---- */

/* Returns the current along the polarisation per du dv at point p. du and dv are the derivatives of the surface. *phase
 * is the phase in rad. */
static double current_at(const hf_gain_beam *b, const double p[3], const double du[3], const double dv[3],
                         double *phase)
{
    double up[3], toward[3], field[3], current[3];
    hf_cross(du, dv, up);
    double path_m = hf_feed_light(&b->feed, p, toward, field);
    hf_cross(up, field, current);
    *phase = 2 * HF_PI / b->wavelength_m * (hf_dot3(b->feed.beam, p) - path_m);
    return hf_dot3(toward, up) < 0 ? 2 * hf_dot3(b->co, current) : 0;
}

/* Computes point k of a facet, from positions or from a motion, and its derivatives by u and v. Returns its weight. */
static double point_of(const hf_gain_beam *b, const hf_facet_mesh *m, bool is_bent, int k, double p[3], double du[3],
                       double dv[3])
{
    int j = k % b->order, l = k / b->order;
    (is_bent ? hf_facet_mesh_lifted : hf_facet_mesh_at)(m, b->at[j], b->at[l], p, du, dv);
    return b->weight[j] * b->weight[l];
}

/* Adds point k of a facet to the sums: sum[0] is the current, sum[1] and sum[2] the current times its phase. Returns
 * the current. `phase` is its phase as a complex unit number. */
static double add_point(const hf_gain_beam *b, const hf_facet_mesh *m, bool is_bent, int k, double sum[3],
                        double phase[2])
{
    double p[3], du[3], dv[3], angle;
    double weight = point_of(b, m, is_bent, k, p, du, dv);
    double current = weight * current_at(b, p, du, dv, &angle), size = fabs(current), sign = current < 0 ? -1 : 1;
    phase[0] = sign * hf_cosine(angle);
    phase[1] = sign * hf_sine(angle);
    sum[0] += size;
    for (int c = 0; c < 2; c++)
        sum[1 + c] += size * phase[c];
    return size;
}

/* ---- loss of a shape ---- */

double hf_gain_loss_dB(const hf_gain_beam *b, const hf_pattern_surface *s)
{
    double sum[3] = {0}, phase[2];
    for (int i = 0; i < s->facets->n_facet; i++) {
        hf_facet_mesh m;
        hf_facet_mesh_take_bent(s->facets, i, s->position_m, s->sag_m, &m);
        for (int k = 0; k < b->order * b->order; k++)
            add_point(b, &m, s->sag_m, k, sum, phase);
    }
    double part = (sum[1] * sum[1] + sum[2] * sum[2]) / (sum[0] * sum[0]);
    return part < DBL_MIN ? INFINITY : -HF_DB_PER_LN * hf_logarithm(part);
}

/* ---- an objective ---- */

int hf_gain_points(const hf_gain_beam *beam, int n_facet)
{
    return beam->order * beam->order * n_facet;
}

void hf_gain_lay_out(hf_arena *arena, hf_gain *to)
{
    size_t n = (size_t)to->n;
    HF_GAIN_FIELDS(HF_ARENA_TAKE)
}

void hf_gain_measure(hf_gain *g, const double *position_m, double *residual)
{
    const int n = g->n, per_facet = n / g->n_facet;
    double sum[3] = {0}, phase[2];
    for (int i = 0; i < n; i++) {
        hf_facet_gathered f;
        hf_facet_gather(position_m, g->n_node, g->row + 4 * (i / per_facet), &f);
        g->size[i] = add_point(g->beam, &f.flat, false, i % per_facet, sum, phase);
        for (int c = 0; c < 2; c++)
            g->phase[c * n + i] = phase[c];
    }
    g->all = sum[0];
    for (int c = 0; c < 2; c++) {
        g->mean[c] = sum[1 + c] / g->all;
        for (int i = 0; i < n; i++)
            residual[c * n + i] = sqrt(g->size[i] / g->all) * (g->phase[c * n + i] - g->mean[c]);
    }
}

/* ---- derivatives ---- */

/* Computes the derivatives of phase and current by a point and by the sides of its area. By the vector product, the
 * current is 2 (du x dv) . (h x co), with the field h. */
static void derive_point(const hf_gain_beam *b, const double p[3], const double du[3], const double dv[3],
                         double by_place[6], double by_side[6])
{
    double toward[3], field[3], up[3], across[3], turned[3];
    hf_feed_light(&b->feed, p, toward, field);
    hf_cross(du, dv, up);
    hf_cross(field, b->co, across);
    hf_cross(b->co, up, turned);
    double sign = hf_dot3(up, across) < 0 ? -2 : 2;
    hf_cross(dv, across, by_side);
    hf_cross(across, du, by_side + 3);
    for (int d = 0; d < 3; d++) {
        double rate[3];
        hf_feed_light_rate(&b->feed, p, (const double[3]){d == 0, d == 1, d == 2}, rate);
        by_place[d] = 2 * HF_PI / b->wavelength_m * (b->feed.beam[d] - toward[d]);
        by_place[3 + d] = sign * hf_dot3(rate, turned);
        by_side[d] *= sign;
        by_side[3 + d] *= sign;
    }
}

void hf_gain_linearise(hf_gain *g, const double *position_m)
{
    const int n = g->n, per_facet = n / g->n_facet;
    for (int i = 0; i < n; i++) {
        hf_facet_gathered f;
        double p[3], du[3], dv[3], by_place[6] = {0}, by_side[6] = {0};
        hf_facet_gather(position_m, g->n_node, g->row + 4 * (i / per_facet), &f);
        double weight = point_of(g->beam, &f.flat, false, i % per_facet, p, du, dv);
        if (g->size[i] > 0) derive_point(g->beam, p, du, dv, by_place, by_side);
        for (int d = 0; d < 6; d++) {
            g->by_place[d * n + i] = by_place[d] * (d < 3 ? 1 : weight);
            g->by_side[d * n + i] = by_side[d] * weight;
        }
    }
}

/* Writes the rates of phase and current of each point into `rate`, and that of the mean phase into mean_rate. Returns
 * the rate of the sum of all currents. */
static double push_points(hf_gain *g, const double *move, double mean_rate[2])
{
    const int n = g->n, per_facet = n / g->n_facet;
    double all_rate = 0, *phase_rate = g->rate, *size_rate = g->rate + n;
    mean_rate[0] = mean_rate[1] = 0;
    for (int i = 0; i < n; i++) {
        hf_facet_gathered f;
        double p[3], du[3], dv[3], turn = 0, grow = 0;
        hf_facet_gather(move, g->n_node, g->row + 4 * (i / per_facet), &f);
        point_of(g->beam, &f.flat, false, i % per_facet, p, du, dv);
        for (int d = 0; d < 3; d++) {
            turn += g->by_place[d * n + i] * p[d];
            grow += g->by_place[(3 + d) * n + i] * p[d];
            grow += g->by_side[d * n + i] * du[d] + g->by_side[(3 + d) * n + i] * dv[d];
        }
        phase_rate[i] = turn;
        size_rate[i] = grow;
        all_rate += grow;
        mean_rate[0] += grow * g->phase[i] - g->size[i] * turn * g->phase[n + i];
        mean_rate[1] += grow * g->phase[n + i] + g->size[i] * turn * g->phase[i];
    }
    for (int c = 0; c < 2; c++)
        mean_rate[c] = (mean_rate[c] - g->mean[c] * all_rate) / g->all;
    return all_rate;
}

void hf_gain_push(hf_gain *g, const double *move, double *rate)
{
    const int n = g->n;
    double mean_rate[2], all_rate = push_points(g, move, mean_rate);
    for (int i = 0; i < n; i++) {
        double root = sqrt(g->size[i] / g->all), turn = g->rate[i];
        double grow = g->size[i] > 0 ? (g->rate[n + i] / g->size[i] - all_rate / g->all) / 2 : 0;
        rate[i] = root * (grow * (g->phase[i] - g->mean[0]) - turn * g->phase[n + i] - mean_rate[0]);
        rate[n + i] = root * (grow * (g->phase[n + i] - g->mean[1]) + turn * g->phase[i] - mean_rate[1]);
    }
}
