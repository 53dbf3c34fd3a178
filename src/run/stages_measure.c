/* Measures the shape of a stage: its sets, its limits, its surface and its far field; makes it the result.
 *
 *     shape in the workspace
 *         | tensions of the named sets, limits that a design reaches
 *         | section surface: surface and facets, then the far field, with warnings
 *         v
 *     summary of this stage */
#include "run/stages.h"

#include "search/parallel.h"
#include "solve/coupling.h"
#include "solve/limits.h"
#include "surface/antenna_shape.h"
#include <hifdm/metrics.h>
#include <hifdm/pattern.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- far field ---- */

/* Computes the far field of one shape (METHOD section 13).
 *
 *     positions and tensions -> facets, with the sags of the mesh
 *     feed of the net at the target positions
 *         | each frequency: integral over the facets, by all threads
 *         v
 *     table of co and cross components -> store
 *     gain, width and sidelobes of each cut -> summary */

/* Computes the far field at frequency i into its part of the table. Returns HF_OK, HF_NO_MEMORY or HF_INTERRUPTED. */
static hf_status solve_frequency(const hf_run *r, const hf_pattern_surface *surface, const hf_feed *feed, int i,
                                 hf_pattern_table *t)
{
    hf_far_field pattern;
    const hf_run_control *control = &r->request->control;
    const int n_thread = control->threads > 0 ? control->threads : hf_parallel_cores();
    const size_t at = (size_t)i * (size_t)(t->n_cut * t->n_theta);
    hf_status status =
        hf_pattern_create(&r->problem.surface.pattern, surface, feed, t->frequency_Hz[i], n_thread, &pattern);
    pattern.stop = control->stop_requested;
    if (status == HF_OK) {
        hf_parallel_each(n_thread, HF_PATTERN_BLOCKS, hf_pattern_sum_block, &pattern);
        if (hf_run_must_stop(r)) status = HF_INTERRUPTED;
    }
    if (status == HF_OK) hf_pattern_finish(&pattern, t->co_dBi + at, t->cross_dBi + at);
    hf_pattern_free(&pattern);
    return status;
}

/* Warns about cuts without width and sidelobes. The message gives the number of these cuts and the reason for the first
 * one. */
static void doubt_pattern(const hf_pattern_settings *s, const hf_pattern_summary *to, hf_stage stage,
                          hf_messages *messages)
{
    int n = 0, first = -1, n_all = to->n_frequency * to->n_cut;
    for (int k = 0; k < n_all; k++)
        if (to->figure[k].doubt && n++ == 0) first = k;
    if (n == 0) return;
    double GHz = to->frequency_Hz[first / to->n_cut] / 1e9, phi_deg = to->phi_deg[first % to->n_cut];
    if (to->figure[first].doubt == HF_CUT_AT_END)
        hf_warning(messages,
                   "surface.pattern: in %d of %d cuts of stage %s, such as phi %g deg at %g GHz, the maximum gain is "
                   "at the end of theta_deg. The beam may be outside the range of theta_deg, so its width and "
                   "sidelobes are unknown. Widen theta_deg",
                   n, n_all, hf_stage_word[stage], phi_deg, GHz);
    else
        hf_warning(messages,
                   "surface.pattern: in %d of %d cuts of stage %s, such as phi %g deg at %g GHz, the steps of %.3g deg "
                   "are coarse. Fewer than %g steps are within the beam width, so hifdm may miss the maximum gain. The "
                   "beam width and the sidelobes are unknown. Raise n_theta, or narrow theta_deg",
                   n, n_all, hf_stage_word[stage], phi_deg, GHz, (s->theta_deg[1] - s->theta_deg[0]) / (s->n_theta - 1),
                   HF_PATTERN_WIDTH_STEPS);
}

static hf_status solve_pattern(const hf_run *r, const hf_pattern_surface *surface, hf_pattern_table *t,
                               hf_pattern_summary *to)
{
    const hf_problem *p = &r->problem;
    const hf_pattern_settings *s = &p->surface.pattern;
    const hf_double_list *frequencies = &p->surface.frequencies_Hz;
    hf_feed feed;
    HF_TRY(hf_pattern_table_create(frequencies->n, s->phi_deg.n, s->n_theta, t));
    memcpy(t->frequency_Hz, frequencies->value, (size_t)frequencies->n * sizeof(double));
    memcpy(t->phi_deg, s->phi_deg.value, (size_t)s->phi_deg.n * sizeof(double));
    for (int i = 0; i < s->n_theta; i++)
        t->theta_deg[i] = s->theta_deg[0] + (s->theta_deg[1] - s->theta_deg[0]) * i / (s->n_theta - 1);
    hf_feed_make(&p->surface, &p->facets, p->scene.position_m, &feed);
    for (int i = 0; i < frequencies->n; i++)
        HF_TRY(solve_frequency(r, surface, &feed, i, t));
    *to = (hf_pattern_summary){.n_frequency = t->n_frequency, .n_cut = t->n_cut, .feed = feed};
    memcpy(to->frequency_Hz, t->frequency_Hz, (size_t)t->n_frequency * sizeof(double));
    memcpy(to->phi_deg, t->phi_deg, (size_t)t->n_cut * sizeof(double));
    for (int k = 0; k < t->n_frequency * t->n_cut; k++)
        to->figure[k] = hf_pattern_figures(t->n_theta, s->theta_deg, t->co_dBi + (size_t)k * (size_t)t->n_theta);
    return HF_OK;
}

/* Computes, judges and stores the far field of a case that asks for it. */
static hf_status measure_pattern(hf_run *r, hf_stage stage, const hf_workspace *w, hf_summary *summary,
                                 hf_messages *messages)
{
    const hf_problem *p = &r->problem;
    hf_antenna_shape shape;
    hf_pattern_table table = {0};
    hf_pattern_summary *to = summary->stage[stage].pattern;
    if (!p->surface.has_pattern) return HF_OK;
    if (!to) to = summary->stage[stage].pattern = calloc(1, sizeof *to);
    if (!to) return hf_error(messages, HF_NO_MEMORY, "out of memory for the far field");
    hf_status status = hf_antenna_shape_take(p->surface.mesh_tension_N_per_m, &p->facets, &p->model, w->position_m,
                                             w->tension_N, &shape);
    if (status == HF_OK && shape.exists) status = solve_pattern(r, &shape.surface, &table, to);
    if (status == HF_OK && table.block) doubt_pattern(&p->surface.pattern, to, stage, messages);
    if (status == HF_NO_MEMORY) hf_error(messages, status, "out of memory for the far field");
    if (status == HF_OK && table.block) status = hf_store_pattern(r->store, stage, &table, to, messages);
    hf_pattern_table_free(&table);
    hf_antenna_shape_free(&shape);
    return status;
}

/* ---- measures ---- */

#define RUZE_OFF_DB 0.1     /* difference of losses that causes a warning */
#define MESH_PULL_DOUBT 0.3 /* N l / T above which the figures of the facets cause a warning */

/* Sets the minimum and maximum tension and their ratio for the named sets of cables, up to HF_SUMMARY_SETS of them. */
static hf_status measure_sets(const hf_problem *p, const hf_workspace *w, hf_stage_summary *s)
{
    const hf_scene *scene = &p->scene;
    if (scene->n_set == 0) return HF_OK;
    if (!s->sets) s->sets = calloc(1, sizeof *s->sets);
    hf_set_tensions *to = s->sets;
    if (!to) return HF_NO_MEMORY;
    to->n = scene->n_set < HF_SUMMARY_SETS ? scene->n_set : HF_SUMMARY_SETS;
    for (int k = 0; k < to->n; k++) {
        const int *cable = scene->set_cable + scene->set_start[k];
        int n = scene->set_start[k + 1] - scene->set_start[k];
        snprintf(to->name[k], sizeof to->name[k], "%s", scene->set_name[k]);
        to->min_N[k] = INFINITY;
        to->max_N[k] = -INFINITY;
        for (int i = 0; i < n; i++) {
            to->min_N[k] = fmin(to->min_N[k], w->tension_N[cable[i]]);
            to->max_N[k] = fmax(to->max_N[k], w->tension_N[cable[i]]);
        }
        to->ratio[k] = hf_metrics_set_ratio(&p->model, w, n, cable);
    }
    return HF_OK;
}

/* Notes which limits a design reaches. */
static hf_status measure_limits(const hf_problem *p, const hf_workspace *w, hf_stage_summary *s)
{
    hf_limit_held held[HF_LIMITS_HELD];
    int n = hf_limits_held(&p->evaluator, w, held);
    if (s->held) s->held->n = 0;
    if (n == 0) return HF_OK;
    if (!s->held) s->held = calloc(1, sizeof *s->held);
    hf_held_limits *to = s->held;
    if (!to) return HF_NO_MEMORY;
    to->n = n;
    for (int i = 0; i < to->n; i++) {
        to->row[i] = held[i].row;
        to->count[i] = held[i].n;
        to->value[i] = held[i].value;
        to->bound[i] = held[i].bound;
        hf_limits_name(&p->scene, &p->model, &held[i], to->name[i], sizeof to->name[i]);
    }
    return HF_OK;
}

/* Warns if Ruze's formula is off by more than RUZE_OFF_DB at a frequency where physical optics loses at most
 * HF_SURFACE_GOOD_TO_DB. */
static void doubt_ruze(const hf_surface_settings *s, const hf_surface_measures *m, hf_stage stage,
                       hf_messages *messages)
{
    for (int k = 0; k < 2 * s->frequencies_Hz.n; k++) {
        bool is_fixed = k % 2;
        double loss_dB = (is_fixed ? m->fixed_gain_loss_dB : m->refocused_gain_loss_dB)[k / 2];
        double ruze_dB = hf_surface_ruze_dB(is_fixed ? m->fixed_half_path_rms_m : m->refocused_half_path_rms_m,
                                            s->frequencies_Hz.value[k / 2]);
        if (!(loss_dB <= HF_SURFACE_GOOD_TO_DB) || !(fabs(ruze_dB - loss_dB) > RUZE_OFF_DB)) continue;
        hf_warning(
            messages,
            "surface: Ruze's formula differs from physical optics by %.2g dB here: at %g GHz, with a %s feed, the "
            "shape of stage %s loses %.3g dB, but Ruze's formula gives %.3g dB. Use the loss by physical optics",
            fabs(ruze_dB - loss_dB), s->frequencies_Hz.value[k / 2] / 1e9, is_fixed ? "fixed" : "refocused",
            hf_stage_word[stage], loss_dB, ruze_dB);
    }
}

hf_status hf_stage_measure(hf_run *r, hf_stage stage, const hf_workspace *w, hf_summary *s, hf_messages *messages)
{
    const hf_problem *p = &r->problem;
    char words[64];
    hf_surface_measures *measures = &s->stage[stage].surface;
    if (measure_sets(p, w, &s->stage[stage]) != HF_OK ||
        (stage != HF_STAGE_FORM && measure_limits(p, w, &s->stage[stage]) != HF_OK))
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the results of a shape");
    if (!p->settings.has_surface) return HF_OK;
    if (hf_surface_measure(&p->surface, &p->facets, &p->model, w->position_m, w->tension_N, measures) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the surface errors");
    if (isnan(hf_metrics_psi_m(&p->model, w))) hf_surface_blank(measures);
    const hf_surface_fit *fit = &measures->fit;
    doubt_ruze(&p->surface, measures, stage, messages);
    if (measures->mesh_pull_ratio > MESH_PULL_DOUBT)
        hf_warning(messages,
                   "surface: in the shape of stage %s, the mesh pulls on %s. hifdm computes the pillows to first order "
                   "in the ratio N l / tension%s. Raise the cable tensions, or lower surface.mesh_tension_N_per_m",
                   hf_stage_word[stage], hf_facet_mesh_pull_words(measures->mesh_pull_ratio, words),
                   measures->mesh_pull_ratio <= HF_FACET_PULL_MOST ? ""
                   : p->surface.has_pattern
                       ? ", which does not hold here, so hifdm reports neither facet errors nor a far field"
                       : ", which does not hold here, so hifdm reports no facet errors");
    if (!fit->converged)
        hf_warning(messages,
                   "surface: the best fit to the shape of stage %s did not converge in %d steps, so the results of "
                   "this fit are missing",
                   hf_stage_word[stage], fit->iterations);
    hf_status status = measure_pattern(r, stage, w, s, messages);
    if (status == HF_INTERRUPTED)
        hf_warning(messages, "surface.pattern: the run was interrupted, so the shape of stage %s has no far field",
                   hf_stage_word[stage]);
    return status;
}

/* ---- the result ---- */

hf_status hf_stage_take(hf_run *r, hf_workspace *w, hf_messages *messages)
{
    const hf_problem *p = &r->problem;
    if (p->settings.has_truss) { /* its forces and displacements under the net of this shape */
        hf_carrier_state_free(&r->truss);
        hf_coupling_forces(&p->model, w);
        hf_status status = hf_carrier_load(&p->carrier, w->attachment_force_N, NULL, &r->truss);
        if (status != HF_OK) return hf_error(messages, status, "out of memory for the forces in the truss");
    }
    r->shape = w;
    return p->load_cases.n ? hf_load_case_stage_take(p, w, &r->cases, messages) : HF_OK;
}

void hf_stage_count_at_bounds(const hf_population *p, const double *design, int *at_lower, int *at_upper)
{
    *at_lower = *at_upper = 0; /* a resumed run has the counts of the session before */
    for (int k = 0; k < p->n_variable; k++) {
        *at_lower += design[k] <= p->lower[k];
        *at_upper += design[k] >= p->upper[k];
    }
}
