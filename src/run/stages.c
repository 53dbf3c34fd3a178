/* Implements stages.h: measures of a shape, its far field, the refinement, and the front. */
#include "run/stages.h"

#include "base/clock.h"
#include "run/diagnose.h"
#include "run/problem_parts.h"
#include "search/front_refine.h"
#include "search/parallel.h"
#include "solve/limits.h"
#include "surface/facet_mesh.h"
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

/* The threads and the stop flag of a far field. */
typedef struct {
    int n_thread;
    const volatile sig_atomic_t *stop;
} pattern_means;

/* Computes the far field at frequency i into its part of the table. Returns HF_OK, HF_NO_MEMORY or HF_INTERRUPTED. */
static hf_status solve_frequency(const hf_problem *p, const hf_pattern_surface *surface, const hf_feed *feed, int i,
                                 pattern_means by, hf_pattern_table *t)
{
    hf_far_field pattern;
    const hf_pattern_settings *s = &p->surface.pattern;
    const size_t at = (size_t)i * (size_t)(t->n_cut * t->n_theta);
    hf_status status = hf_pattern_create(s, surface, feed, t->frequency_Hz[i], by.n_thread, &pattern);
    pattern.stop = by.stop;
    if (status == HF_OK) {
        hf_parallel_each(by.n_thread, HF_PATTERN_BLOCKS, hf_pattern_sum_block, &pattern);
        if (by.stop && *by.stop) status = HF_INTERRUPTED;
    }
    if (status == HF_OK) {
        hf_pattern_finish(&pattern, t->co_dBi + at, t->cross_dBi + at);
    }
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
                   "at the end "
                   "of theta_deg: the beam may be outside, and its width and sidelobes are unknown; widen theta_deg",
                   n, n_all, hf_stage_word[stage], phi_deg, GHz);
    else
        hf_warning(messages,
                   "surface.pattern: in %d of %d cuts of stage %s, such as phi %g deg at %g GHz, steps of %.3g deg are "
                   "coarse: fewer than %g steps are within the width of the beam. Its maximum may be missed, and width "
                   "and sidelobes are unknown; raise n_theta, or narrow theta_deg",
                   n, n_all, hf_stage_word[stage], phi_deg, GHz, (s->theta_deg[1] - s->theta_deg[0]) / (s->n_theta - 1),
                   HF_PATTERN_WIDTH_STEPS);
}

static void sum_up_pattern(const hf_pattern_settings *s, const hf_pattern_table *t, const hf_feed *feed,
                           hf_pattern_summary *to)
{
    *to = (hf_pattern_summary){.n_frequency = t->n_frequency, .n_cut = t->n_cut, .feed = *feed};
    memcpy(to->frequency_Hz, t->frequency_Hz, (size_t)t->n_frequency * sizeof(double));
    memcpy(to->phi_deg, t->phi_deg, (size_t)t->n_cut * sizeof(double));
    for (int k = 0; k < t->n_frequency * t->n_cut; k++)
        to->figure[k] = hf_pattern_figures(t->n_theta, s->theta_deg, t->co_dBi + (size_t)k * (size_t)t->n_theta);
}

static hf_status solve_pattern(const hf_problem *p, const hf_pattern_surface *surface, pattern_means by,
                               hf_pattern_table *t, hf_pattern_summary *to)
{
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
        HF_TRY(solve_frequency(p, surface, &feed, i, by, t));
    sum_up_pattern(s, t, &feed, to);
    return HF_OK;
}

static hf_status hf_pattern_stage(const hf_problem *p, hf_stage stage, const hf_workspace *w, int n_thread,
                                  const volatile sig_atomic_t *stop, hf_store *store, hf_summary *summary,
                                  hf_messages *messages)
{
    hf_arena arena = {0}, sags = {0};
    hf_facet_shape shape;
    hf_pattern_table table = {0};
    hf_pattern_summary *to = summary->stage[stage].pattern;
    double pull_ratio = 0, mesh_N_per_m = p->surface.mesh_tension_N_per_m, *sag_m = NULL;
    if (!p->surface.has_pattern) return HF_OK;
    if (n_thread <= 0) n_thread = hf_parallel_cores();
    if (!to) to = summary->stage[stage].pattern = calloc(1, sizeof *to);
    if (!to) return hf_error(messages, HF_NO_MEMORY, "out of memory for the far field");
    hf_status status = hf_facet_shape_take(&p->model, w->position_m, w->tension_N, &shape, &arena);
    if (status == HF_OK && mesh_N_per_m > 0)
        status = hf_facet_mesh_make_sags(mesh_N_per_m, &p->facets, &shape, &sags, &sag_m, &pull_ratio);
    if (status == HF_OK && pull_ratio <= HF_FACET_PULL_MOST) {
        const hf_pattern_surface surface = {&p->facets, shape.position_m, sag_m};
        status = solve_pattern(p, &surface, (pattern_means){n_thread, stop}, &table, to);
    }
    if (status == HF_OK && table.block) doubt_pattern(&p->surface.pattern, to, stage, messages);
    if (status == HF_NO_MEMORY) hf_error(messages, status, "out of memory for the far field");
    if (status == HF_OK && table.block) status = hf_store_pattern(store, stage, &table, to, messages);
    hf_pattern_table_free(&table);
    hf_arena_free(&sags);
    hf_arena_free(&arena);
    return status;
}

/* ---- measures ---- */

/* Measures a shape that a run reports.
 *
 *     shape in the workspace
 *         | tensions of the named sets
 *         | section surface: surface and facets, then the far field (pattern_stage.c), with warnings
 *         v
 *     summary of this stage */

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

/* ---- refinement ---- */

/* Runs the refinement of a design by Levenberg-Marquardt, so that an interrupted run resumes it.
 *
 *     state of an earlier session in the store, if there is one
 *         |
 *         v
 *     hf_refine_run; after each step: store its state, publish the file, notify the observer, check the stop flag
 *         |
 *         v
 *     refined design, with a warning if it has not converged */

#define PUBLISH_AFTER_S 1.0 /* a shorter refinement publishes no file between steps */
#define LATELY 10           /* steps whose gain a warning about convergence reports */

typedef struct {
    const hf_run_request *request;
    const hf_problem *problem;
    const hf_summary *summary;
    hf_store *store;
    hf_messages *messages;
    double begin_s, earlier_s;         /* start of this session, and duration of earlier ones, s */
    int first_iteration, n_evaluation; /* first step of this session; evaluations of earlier ones */
    double merit[LATELY + 1];          /* merits of the last steps: step i in [i % (LATELY + 1)] */
    hf_refine_progress now;
} refine_job;

static bool is_stopped(const hf_run_request *q)
{
    return q->stop_requested && *q->stop_requested;
}

static void tell_refine_step(const refine_job *j)
{
    const hf_run_request *q = j->request;
    const hf_refine_progress *now = &j->now;
    if (!q->observer) return;
    const hf_run_progress progress = {.phase = HF_RUN_REFINE,
                                      .step = now->iterations,
                                      .max_steps = now->max_iterations,
                                      .first_step = j->first_iteration,
                                      .is_last = now->is_last,
                                      .evaluations = now->evaluations - j->n_evaluation,
                                      .best_psi_m = now->psi_m,
                                      .merit = j->problem->objectives.n_objective ? now->merit : (double)NAN,
                                      .elapsed_s = hf_clock_s() - j->begin_s};
    q->observer(q->observer_context, &progress);
}

/* Stores a step, publishes the file if the refinement takes long, then notifies the observer, which thus hears of
 * stored steps only. Returns HF_OK, HF_INTERRUPTED, or an error of the store. */
static hf_status between_steps(void *context, const hf_refine_progress *now)
{
    refine_job *j = context;
    if (j->now.n_state == 0) {
        j->first_iteration = now->iterations;
        j->n_evaluation = now->evaluations;
    }
    double wall_s = j->earlier_s + hf_clock_s() - j->begin_s;
    j->now = *now;
    j->merit[now->iterations % (LATELY + 1)] = now->merit;
    HF_TRY(hf_store_refine(j->store, wall_s, now->n_state, now->state, j->messages));
    if (wall_s > PUBLISH_AFTER_S) HF_TRY(hf_store_publish(j->store, j->summary, false, j->messages));
    tell_refine_step(j);
    return is_stopped(j->request) ? HF_INTERRUPTED : HF_OK;
}

/* Warns if the steps ended before convergence, because such a result looks like a converged one. */
static void warn_of_refine_steps(const refine_job *j, const hf_refine_result *r)
{
    int n = r->iterations - j->first_iteration < LATELY ? r->iterations - j->first_iteration : LATELY;
    double before = j->merit[(r->iterations - n) % (LATELY + 1)];
    const char *what = j->problem->objectives.n_objective ? "the merit" : "psi";
    if (r->stop != HF_REFINE_MAX_ITERATIONS) return;
    if (n > 0 && before > 0)
        hf_warning(j->messages,
                   "Levenberg-Marquardt is not converged after %d steps, and the last %d lowered %s by %.2g %%: better "
                   "designs exist near this one; raise optimize.refine_steps",
                   r->iterations, n, what, 100 * (1 - j->now.merit / before));
    else
        hf_warning(j->messages, "Levenberg-Marquardt is not converged after %d steps; raise optimize.refine_steps",
                   r->iterations);
}

/* Writes into stopped_at where the refinement has stopped, for the message of an interrupted run. */
static void tell_stop(const refine_job *j, char stopped_at[HF_REFINE_STAGE_TEXT])
{
    int n = snprintf(stopped_at, HF_REFINE_STAGE_TEXT, " after %d steps of the refinement", j->now.iterations);
    if (j->now.iterations == 0) return;
    n += snprintf(stopped_at + n, HF_REFINE_STAGE_TEXT - (size_t)n, ", at psi %.4f mm", j->now.psi_m * 1e3);
    if (j->problem->objectives.n_objective && isfinite(j->now.merit))
        snprintf(stopped_at + n, HF_REFINE_STAGE_TEXT - (size_t)n, " and a merit of %.6g", j->now.merit);
}

hf_status hf_refine_stage_run(const hf_run_request *q, hf_problem *p, const hf_population *bounds,
                              const hf_summary *summary, hf_store *store, double *design, hf_refine_result *result,
                              double *wall_s, char stopped_at[HF_REFINE_STAGE_TEXT], hf_messages *messages)
{
    refine_job j = {
        .request = q, .problem = p, .summary = summary, .store = store, .messages = messages, .begin_s = hf_clock_s()};
    hf_refine_watcher watcher = {.after = between_steps, .context = &j};
    HF_TRY(hf_store_restore_refine(store, &j.earlier_s, &watcher.n_state, &watcher.state, messages));
    hf_status status = hf_refine_run(&p->evaluator, bounds->lower, bounds->upper, p->settings.optimize.refine_steps,
                                     NULL, &watcher, design, &p->workspace, result);
    *wall_s = j.earlier_s + hf_clock_s() - j.begin_s;
    tell_stop(&j, stopped_at);
    if (status == HF_OK && !is_stopped(q) && hf_optimiser_plan_of(&p->settings.optimize).ends_with_refine)
        warn_of_refine_steps(&j, result);
    return status;
}

/* ---- front ---- */

/* Finds the front of the objectives by Levenberg-Marquardt (METHOD section 7, fronts).
 *
 *     designs of an earlier front within the bounds, or the initial design
 *         | hf_front_refine_find: points between the ends, with progress to the observer
 *         v
 *     front -> summary; if it fails, the earlier front stays, with a warning */

hf_status hf_run_front_tell(const hf_front *front, double wall_s, hf_summary *s, hf_messages *messages)
{
    if (!s->front) s->front = calloc(1, sizeof *s->front);
    if (!s->front) return hf_error(messages, HF_NO_MEMORY, "out of memory for the front");
    hf_front_tabulate(front, s->front);
    s->front->wall_s = wall_s;
    if (s->front->n_failed > 0) {
        hf_status first = front->point[front->n_point - s->front->n_failed].status;
        hf_warning(messages, "optimize.front: %d of %d points of the front failed; the first reason: %s",
                   s->front->n_failed, front->n_point,
                   first == HF_OUT_OF_LIMITS ? "the refinement did not reach its limits from the neighbouring points"
                                             : hf_status_text(first));
    }
    return HF_OK;
}

/* Warns about points that stopped at the maximum number of steps. Points that stalled would gain nothing from more
 * steps. */
static void warn_of_front_steps(const hf_front *front, int max_iterations, hf_messages *messages)
{
    int n = 0;
    for (int i = 0; i < front->n_point; i++) {
        const hf_front_point *p = &front->point[i];
        n += p->status == HF_OK && !p->is_converged && p->steps >= max_iterations;
    }
    if (n > 0)
        hf_warning(
            messages,
            "optimize.front: %d of %d points of the front are not converged after %d steps: they have no slope, and "
            "better designs exist near them; raise optimize.refine_steps",
            n, front->n_point, max_iterations);
}

/* Writes why Levenberg-Marquardt has found no front. Returns text. */
static const char *explain_no_front(const hf_problem *p, hf_status status, int end, char *text, size_t size)
{
    char name[HF_OBJECTIVE_NAME_SIZE];
    const char *why = hf_status_text(status);
    char hint[HF_NO_DESIGN_HINT_SIZE];
    hf_no_design_cap(p, p->form.boundary_tension_ratio, hint);
    if (status == HF_OUT_OF_LIMITS)
        why = p->settings.optimize.n_limit > 0 ? "it did not reach optimize.limits from its start"
                                               : "it did not reach the bounds of optimize.variables from its start";
    if (end >= 0)
        snprintf(text, size,
                 "optimize.front.%d: Levenberg-Marquardt found no design with the minimum %s, which is an end of the "
                 "front: %s%s",
                 end, hf_objectives_name(p->evaluator.objectives, end, name), why, hint);
    else
        snprintf(text, size, "optimize.front: Levenberg-Marquardt found no front: %s%s", why, hint);
    return text;
}

/* Returns the designs of the earlier front within the bounds, or else the initial design: [n][n_variable], n at least
 * 1. The caller frees them. Returns NULL if there is no memory. */
static double *make_starts(const hf_problem *p, const hf_population *bounds, const hf_front *earlier, int *n)
{
    int n_variable = p->model.n_variable;
    double *start = malloc((size_t)(earlier->n_point + 1) * (size_t)n_variable * sizeof *start);
    *n = 0;
    for (int i = 0; i <= earlier->n_point && start; i++) {
        const double *design = i < earlier->n_point ? earlier->design + (size_t)i * (size_t)n_variable : p->initial;
        bool is_wanted = i < earlier->n_point ? earlier->point[i].mark == HF_FRONT_ON : *n == 0;
        for (int k = 0; k < n_variable && is_wanted; k++)
            start[(size_t)*n * (size_t)n_variable + (size_t)k] = hf_population_clamp(bounds, k, design[k]);
        *n += is_wanted;
    }
    return start;
}

/* What the observer of the run needs to know about the search for a front. */
typedef struct {
    const hf_run_request *request;
    double start_s;
    int n_point; /* maximum number of points */
} front_progress;

static void tell_front(const front_progress *p, int n_point, long n_step, bool is_last)
{
    const hf_run_request *q = p->request;
    const hf_run_progress now = {.phase = HF_RUN_REFINE,
                                 .is_last = is_last,
                                 .best_psi_m = (double)NAN,
                                 .elapsed_s = hf_clock_s() - p->start_s,
                                 .merit = (double)NAN,
                                 .points = n_point,
                                 .points_all = p->n_point,
                                 .steps = n_step};
    if (q->observer) q->observer(q->observer_context, &now);
}

static void tell_front_step(void *context, int n_point, long n_step)
{
    tell_front(context, n_point, n_step, false);
}

hf_status hf_run_front(const hf_run_request *q, hf_problem *p, const hf_population *bounds, hf_front *front,
                       hf_summary *s, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    front_progress told = {q, hf_clock_s(), o->front_points};
    hf_front_refine_watcher watcher = {.tell = tell_front_step, .context = &told, .is_telling = ATOMIC_FLAG_INIT};
    hf_front_refine task = {.evaluator = &p->evaluator,
                            .lower = bounds->lower,
                            .upper = bounds->upper,
                            .n_point = o->front_points,
                            .max_iterations = o->refine_steps,
                            .n_thread = p->batch.n_thread,
                            .stop = q->stop_requested,
                            .watcher = q->observer ? &watcher : NULL};
    char text[HF_NO_DESIGN_SIZE];
    int end = -1, has_earlier = front->n_point > 0;
    double *start = make_starts(p, bounds, front, &task.n_start);
    hf_front found = {0};
    task.start = start;
    tell_front(&told, 0, 0, false);
    bool applies = hf_front_refine_applies(&p->evaluator);
    hf_status status = !start ? HF_NO_MEMORY : applies ? hf_front_refine_find(&task, &found, &end) : HF_BAD_CASE;
    free(start);
    if (status != HF_OK) hf_front_free(&found);
    if (status == HF_INTERRUPTED || (q->stop_requested && *q->stop_requested)) {
        hf_front_free(&found);
        return HF_INTERRUPTED;
    }
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "out of memory for the front");
    memcpy((status == HF_OK ? &found : front)->initial, s->stage[HF_STAGE_FORM].result.objective,
           sizeof front->initial);
    if (status != HF_OK) {
        const char *why = text;
        if (applies)
            why = explain_no_front(p, status, end, text, sizeof text);
        else
            snprintf(text, sizeof text, HF_PROBLEM_REFINE_NEEDS, hf_problem_no_slopes(p));
        if (!has_earlier) return hf_error(messages, applies ? HF_NO_FEASIBLE : HF_BAD_CASE, "%s", why);
        hf_warning(messages, "%s; the front is that of the last generation", why);
        return hf_run_front_tell(front, s->stage[HF_STAGE_SEARCH].wall_s, s, messages);
    }
    hf_front_free(front);
    *front = found;
    tell_front(&told, front->n_point, watcher.n_step, true);
    HF_TRY(hf_run_front_tell(front, hf_clock_s() - told.start_s, s, messages));
    warn_of_front_steps(front, o->refine_steps, messages);
    return HF_OK;
}
