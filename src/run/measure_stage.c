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

#define MESH_PULL_DOUBT 0.3 /* N l / T above which the figures of the facets cause a warning */

/* Sets the minimum and maximum tension and their ratio for the named sets of cables, up to HF_SUMMARY_SETS of them. */
static void measure_sets(const hf_problem *p, hf_stage stage, const hf_workspace *w, hf_summary *s)
{
    const hf_scene *scene = &p->scene;
    hf_set_tensions *to = &s->sets[stage];
    to->n = scene->n_set < HF_SUMMARY_SETS ? scene->n_set : HF_SUMMARY_SETS;
    for (int k = 0; k < to->n; k++) {
        const int *cable = scene->set_cable + scene->set_start[k];
        int n = scene->set_start[k + 1] - scene->set_start[k];
        snprintf(to->name[k], sizeof to->name[k], "%s", scene->set_name[k]);
        to->least_N[k] = INFINITY;
        to->largest_N[k] = -INFINITY;
        for (int i = 0; i < n; i++) {
            to->least_N[k] = fmin(to->least_N[k], w->tension_N[cable[i]]);
            to->largest_N[k] = fmax(to->largest_N[k], w->tension_N[cable[i]]);
        }
        to->ratio[k] = hf_metrics_set_ratio(&p->model, w, n, cable);
    }
}

void hf_measure_limits(const hf_problem *p, hf_stage stage, const hf_workspace *w, hf_summary *s)
{
    hf_limit_held held[HF_LIMITS_HELD];
    hf_held_limits *to = &s->held[stage];
    to->n = hf_limits_held(&p->evaluator, w, held);
    for (int i = 0; i < to->n; i++) {
        to->row[i] = held[i].row;
        to->count[i] = held[i].n;
        to->value[i] = held[i].value;
        to->bound[i] = held[i].bound;
        hf_limits_name(&p->scene, &p->model, &held[i], to->name[i], sizeof to->name[i]);
    }
}

hf_status hf_measure_stage(const hf_problem *p, hf_stage stage, const hf_workspace *w, int n_thread,
                           const volatile sig_atomic_t *stop, hf_store *store, hf_summary *s, hf_messages *messages)
{
    char words[64];
    measure_sets(p, stage, w, s);
    if (!p->settings.has_surface) return HF_OK;
    if (hf_surface_measure(&p->surface, &p->facets, &p->model, w->position_m, w->tension_N, &s->measures[stage]) !=
        HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the measures of the surface");
    if (isnan(hf_metrics_psi_m(&p->model, w))) hf_surface_blank(&s->measures[stage]);
    const hf_surface_fit *fit = &s->measures[stage].fit;
    if (s->measures[stage].mesh_pull_ratio > MESH_PULL_DOUBT)
        hf_warning(messages,
                   "surface: in the shape of stage %s the mesh pulls on %s; the pillow is of first order in "
                   "N l over the tension%s. Raise the tension of the cables, or lower "
                   "surface.mesh_tension_N_per_m",
                   hf_stage_word[stage], hf_facet_mesh_pull_words(s->measures[stage].mesh_pull_ratio, words),
                   s->measures[stage].mesh_pull_ratio <= HF_FACET_PULL_MOST ? ""
                   : p->surface.has_pattern ? ", and facets have neither errors nor a far field here"
                                            : ", and facets have no errors here");
    if (!fit->converged)
        hf_warning(messages,
                   "surface: the best fit to the shape of stage %s did not converge in %d steps; it has no value",
                   hf_stage_word[stage], fit->iterations);
    hf_status status = hf_pattern_stage(p, stage, w, n_thread, stop, store, s, messages);
    if (status == HF_INTERRUPTED)
        hf_warning(messages, "surface.pattern: told to stop: the shape of stage %s has no far field",
                   hf_stage_word[stage]);
    return status;
}
