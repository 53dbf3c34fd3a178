/* Measures a shape that a run reports.
 *
 *     shape in the workspace
 *         | tensions of the named sets
 *         | section surface: surface and facets, then the far field (pattern_stage.c), with warnings
 *         v
 *     summary of this stage */
#include "run/measure_stage.h"

#include "run/pattern_stage.h"
#include "surface/facet_mesh.h"
#include "solve/limits.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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

hf_status hf_measure_stage(const hf_problem *p, hf_stage stage, const hf_workspace *w, int n_thread,
                           const volatile sig_atomic_t *stop, hf_store *store, hf_summary *s, hf_messages *messages)
{
    char words[64];
    hf_surface_measures *measures = &s->stage[stage].surface;
    if (measure_sets(p, w, &s->stage[stage]) != HF_OK ||
        (stage != HF_STAGE_FORM && measure_limits(p, w, &s->stage[stage]) != HF_OK))
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the measures of a shape");
    if (!p->settings.has_surface) return HF_OK;
    if (hf_surface_measure(&p->surface, &p->facets, &p->model, w->position_m, w->tension_N, measures) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the measures of the surface");
    if (isnan(hf_metrics_psi_m(&p->model, w))) hf_surface_blank(measures);
    const hf_surface_fit *fit = &measures->fit;
    if (measures->mesh_pull_ratio > MESH_PULL_DOUBT)
        hf_warning(messages,
                   "surface: in the shape of stage %s the mesh pulls on %s; the pillows are computed to first order in "
                   "N l / tension%s. Raise the tensions of the cables, or lower surface.mesh_tension_N_per_m",
                   hf_stage_word[stage], hf_facet_mesh_pull_words(measures->mesh_pull_ratio, words),
                   measures->mesh_pull_ratio <= HF_FACET_PULL_MOST ? ""
                   : p->surface.has_pattern ? ", so the facets have neither errors nor a far field"
                                            : ", so the facets have no errors");
    if (!fit->converged)
        hf_warning(messages,
                   "surface: the best fit to the shape of stage %s did not converge in %d steps, so it has no value",
                   hf_stage_word[stage], fit->iterations);
    hf_status status = hf_pattern_stage(p, stage, w, n_thread, stop, store, s, messages);
    if (status == HF_INTERRUPTED)
        hf_warning(messages, "surface.pattern: interrupted: the shape of stage %s has no far field",
                   hf_stage_word[stage]);
    return status;
}
