/* Measures a shape as a reflector: errors at the inner nodes, best fit, facets, gain losses:
 *
 *     shape -> raw RMS errors and percentiles -> best fit to the nodes -> facets (facet_rms)
 *       -> gain, loss and pointing by physical optics over the facets (antenna) -> Ruze losses
 *
 * The errors of a similar shape of the same net follow from the fits of the first one (surface_near).
 *
 * Contents: gain losses - percentiles - a shape - a shape near another one */
#include "surface/surface_measure.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "net/target_surface.h"
#include "surface/antenna.h"
#include "surface/facet_mesh.h"

#include <math.h>
#include <stdlib.h>

#define LONG_WAVE_M 1e4 /* wavelength for errors without a frequency; it only sets the number of quadrature points */

/* ---- gain losses ---- */

static double note_loss(const hf_double_list *frequencies_Hz, double half_path_rms_m, double *loss_dB)
{
    for (int k = 0; k < frequencies_Hz->n; k++)
        loss_dB[k] = hf_surface_gain_loss_dB(half_path_rms_m, frequencies_Hz->value[k]);
    return hf_surface_frequency_of_loss_Hz(half_path_rms_m, HF_RUZE_MOST_DB);
}

/* ---- percentiles ---- */

/* Returns a percentile of n sorted values, 0 <= part <= 1, interpolated linearly. */
static double percentile(const double *sorted, int n, double part)
{
    double place = part * (n - 1);
    int below = (int)place;
    if (below >= n - 1) return sorted[n - 1];
    return sorted[below] + (place - below) * (sorted[below + 1] - sorted[below]);
}

/* ---- a shape ---- */

/* Copies the inner nodes of the shape to inner_m [3][n]. */
static void take_nodes(const hf_model *m, const double *position_m, double *inner_m)
{
    size_t n = (size_t)m->n_inner_node;
    for (size_t c = 0; c < 3; c++)
        for (size_t k = 0; k < n; k++)
            inner_m[c * n + k] = position_m[(int)c * m->n_node + m->inner_row[k]];
}

/* Sets the distances of the inner nodes inner_m [3][n] from their target positions, and the raw RMS values of `to`. */
static void measure_errors(const hf_surface_settings *s, const hf_model *m, const double *inner_m, double *deviation_m,
                           hf_surface_measures *to)
{
    int n = m->n_inner_node;
    double curvature = 1 / (4 * s->focal_length_m), up = 0, normal = 0, half_path = 0;
    for (int k = 0; k < n; k++) {
        double square = 0, d = 0, p[3], slope[2];
        for (int c = 0; c < 3; c++) {
            p[c] = inner_m[c * n + k];
            d = p[c] - m->position_m[c * m->n_node + m->inner_row[k]];
            square += d * d;
        }
        deviation_m[k] = sqrt(square);
        up += d * d; /* d is the z component here */
        double dz = hf_target_surface_height_above(s->kind, curvature, p, slope);
        double weight = 1 / (1 + slope[0] * slope[0] + slope[1] * slope[1]);
        normal += dz * dz * weight;
        half_path += dz * dz * weight * weight;
    }
    to->z_rms_m = sqrt(up / n);
    to->normal_rms_m = sqrt(normal / n);
    to->half_path_rms_m = sqrt(half_path / n);
}

/* Computes the figures by physical optics of a shape at one frequency, 0: only its errors weighted by the illumination.
 * target_m [n_node][3]: target positions. */
static hf_status measure_antenna(const hf_surface_settings *s, const hf_pattern_surface *shape, const double *target_m,
                                 double frequency_Hz, hf_antenna_figures *is)
{
    hf_antenna antenna;
    double *scratch;
    void *block = NULL;
    hf_status status = hf_antenna_make(s, shape->facets, target_m,
                                       frequency_Hz > 0 ? frequency_Hz : HF_LIGHT_M_PER_S / LONG_WAVE_M, &antenna);
    if (status == HF_OK) status = HF_ARENA_ARRAYS(&block, HF_ARRAY(scratch, hf_antenna_scratch(&antenna)));
    if (status == HF_OK) status = hf_antenna_measure(&antenna, HF_ANTENNA_ALL, shape, scratch, is);
    hf_arena_free_block(block);
    hf_antenna_free(&antenna);
    return status;
}

/* Sets the figures of both feeds. They are NaN without facets, and if the mesh has no shape. */
static hf_status measure_feeds(const hf_surface_settings *s, const hf_facets *facets, const hf_model *m,
                               const hf_facet_shape *shape, hf_surface_measures *to)
{
    hf_arena sags = {0};
    hf_antenna_figures is = {0};
    double *target_m, *sag_m = NULL, pull_ratio = 0;
    void *block;
    to->refocused_half_path_rms_m = to->fixed_half_path_rms_m = (double)NAN;
    for (int k = 0; k < s->frequencies_Hz.n; k++)
        to->refocused_gain_dBi[k] = to->refocused_gain_loss_dB[k] = to->refocused_ruze_loss_dB[k] =
            to->fixed_gain_dBi[k] = to->fixed_gain_loss_dB[k] = to->fixed_ruze_loss_dB[k] = to->pointing_deg[k] =
                (double)NAN;
    if (facets->n_facet == 0) return HF_OK;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(target_m, 3 * (size_t)m->n_node)));
    hf_model_positions(m, m->position_m, target_m);
    hf_status status = HF_OK;
    if (s->mesh_tension_N_per_m > 0)
        status = hf_facet_mesh_make_sags(s->mesh_tension_N_per_m, facets, shape, &sags, &sag_m, &pull_ratio);
    const hf_pattern_surface surface = {facets, shape->position_m, sag_m};
    for (int k = -1; k < s->frequencies_Hz.n && status == HF_OK && pull_ratio <= HF_FACET_PULL_MOST; k++) {
        status = measure_antenna(s, &surface, target_m, k < 0 ? 0 : s->frequencies_Hz.value[k], &is);
        if (status != HF_OK) break;
        if (k < 0) {
            to->refocused_half_path_rms_m = is.refocused.half_path_rms_m;
            to->fixed_half_path_rms_m = is.fixed.half_path_rms_m;
            continue;
        }
        to->refocused_gain_dBi[k] = is.refocused.gain_dBi;
        to->refocused_gain_loss_dB[k] = is.refocused.gain_loss_dB;
        to->fixed_gain_dBi[k] = is.fixed.gain_dBi;
        to->fixed_gain_loss_dB[k] = is.fixed.gain_loss_dB;
        to->pointing_deg[k] = is.pointing_deg;
    }
    note_loss(&s->frequencies_Hz, to->refocused_half_path_rms_m, to->refocused_ruze_loss_dB);
    note_loss(&s->frequencies_Hz, to->fixed_half_path_rms_m, to->fixed_ruze_loss_dB);
    hf_arena_free(&sags);
    hf_arena_free_block(block);
    return status;
}

hf_status hf_surface_measure(const hf_surface_settings *s, const hf_facets *facets, const hf_model *m,
                             const double *position_m, const double *tension_N, hf_surface_measures *measures)
{
    size_t n = (size_t)m->n_inner_node;
    void *block;
    *measures = (hf_surface_measures){0};
    double *inner_m, *deviation_m;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(inner_m, 3 * n), HF_ARRAY(deviation_m, n)));
    hf_facet_shape shape = {0};
    hf_surface_measures all = {.is_measured = true};
    take_nodes(m, position_m, inner_m);
    measure_errors(s, m, inner_m, deviation_m, &all);
    qsort(deviation_m, n, sizeof *deviation_m, hf_compare_doubles);
    all.deviation_p50_m = percentile(deviation_m, (int)n, 0.50);
    all.deviation_p90_m = percentile(deviation_m, (int)n, 0.90);
    all.deviation_p95_m = percentile(deviation_m, (int)n, 0.95);
    all.deviation_p99_m = percentile(deviation_m, (int)n, 0.99);
    all.deviation_max_m = deviation_m[n - 1];
    all.faceting_rms_m =
        s->strip_width_m > 0 ? s->strip_width_m * s->strip_width_m / (24 * sqrt(5) * s->focal_length_m) : (double)NAN;
    hf_status status = hf_surface_fit_points(s->kind, s->focal_length_m, (int)n, inner_m, NULL, &all.fit);
    if (status == HF_OK) status = hf_facet_shape_take(m, position_m, tension_N, &shape);
    if (status == HF_OK) status = hf_facet_measure(s, facets, &shape, &all);
    if (status == HF_OK) status = measure_feeds(s, facets, m, &shape, &all);
    const hf_double_list *at = &s->frequencies_Hz;
    all.ruze_limit_Hz = note_loss(at, all.half_path_rms_m, all.gain_loss_dB);
    all.fit.ruze_limit_Hz = note_loss(at, all.fit.half_path_rms_m, all.fit_gain_loss_dB);
    all.facet_ruze_limit_Hz = note_loss(at, all.facet_half_path_rms_m, all.facet_gain_loss_dB);
    all.facet_fit_ruze_limit_Hz = note_loss(at, all.facet_fit_half_path_rms_m, all.facet_fit_gain_loss_dB);
    hf_arena_free_block(shape.block);
    hf_arena_free_block(block);
    if (status == HF_OK) *measures = all;
    return status;
}

/* ---- a shape near another one ---- */

hf_status hf_surface_design_make(const hf_surface_settings *s, const hf_facets *facets, const hf_model *m,
                                 const double *position_m, const double *tension_N, hf_surface_design *design)
{
    void *block;
    hf_facet_shape shape;
    hf_surface_fit fit;
    hf_fit_parameters parameters;
    double *inner_m;
    *design = (hf_surface_design){0};
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(inner_m, 3 * (size_t)m->n_inner_node)));
    take_nodes(m, position_m, inner_m);
    hf_status status =
        hf_surface_fit_find(s->kind, s->focal_length_m, m->n_inner_node, inner_m, NULL, &fit, &parameters);
    hf_arena_free_block(block);
    HF_TRY(status);
    design->nodes = hf_surface_pose_of(s->kind, s->focal_length_m, &fit, &parameters);
    if (!facets || facets->n_facet == 0) return HF_OK;
    status = hf_facet_shape_take(m, position_m, tension_N, &shape);
    if (status == HF_OK) status = hf_facet_fit(s, facets, &shape, &fit, &parameters);
    hf_arena_free_block(shape.block);
    HF_TRY(status);
    design->facets = hf_surface_pose_of(s->kind, s->focal_length_m, &fit, &parameters);
    return HF_OK;
}

static hf_status measure_nodes(const hf_surface_design *design, const hf_surface_settings *s, const hf_model *m,
                               const double *position_m, hf_surface_paths *to)
{
    int n = m->n_inner_node;
    void *block;
    hf_surface_fit fit;
    double *inner_m, sum = 0, curvature = 1 / (4 * s->focal_length_m);
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(inner_m, 3 * (size_t)n)));
    take_nodes(m, position_m, inner_m);
    for (int k = 0; k < n; k++) {
        double p[3] = {inner_m[k], inner_m[n + k], inner_m[2 * (size_t)n + (size_t)k]}, slope[2];
        double above = hf_target_surface_height_above(s->kind, curvature, p, slope);
        double path = above / (1 + slope[0] * slope[0] + slope[1] * slope[1]);
        sum += path * path;
    }
    to->nodes_m = sqrt(sum / n);
    hf_status status = HF_OK;
    if (!hf_surface_fit_near(&design->nodes, n, inner_m, NULL, &to->nodes_fit_m)) {
        status = hf_surface_fit_points(s->kind, s->focal_length_m, n, inner_m, NULL, &fit);
        to->nodes_fit_m = fit.half_path_rms_m;
    }
    hf_arena_free_block(block);
    return status;
}

hf_status hf_surface_measure_near(const hf_surface_design *design, const hf_surface_settings *s,
                                  const hf_facets *facets, const hf_model *m, const double *position_m,
                                  const double *tension_N, hf_surface_paths *to)
{
    hf_facet_shape shape;
    *to = (hf_surface_paths){NAN, NAN, NAN, NAN};
    HF_TRY(measure_nodes(design, s, m, position_m, to));
    if (!facets || facets->n_facet == 0) return HF_OK;
    hf_status status = hf_facet_shape_take(m, position_m, tension_N, &shape);
    if (status == HF_OK)
        status = hf_facet_measure_near(&design->facets, s, facets, &shape, &to->facets_m, &to->facets_fit_m);
    hf_arena_free_block(shape.block);
    return status;
}
