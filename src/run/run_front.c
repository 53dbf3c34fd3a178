/* Finds the front of the objectives by Levenberg-Marquardt (METHOD section 7, fronts).
 *
 *     designs of an earlier front within the bounds, or the initial design
 *         | hf_front_refine_find: points between the ends, with progress to the observer
 *         v
 *     front -> summary; if it fails, the earlier front stays, with a warning */
#include "run/run_front.h"

#include "base/clock.h"
#include "run/no_design.h"
#include "run/problem_parts.h"
#include "search/front_refine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void hf_run_front_tell(const hf_front *front, double wall_s, hf_summary *s, hf_messages *messages)
{
    hf_front_tabulate(front, &s->front);
    s->front.wall_s = wall_s;
    s->has_front = true;
    if (s->front.n_failed > 0) {
        hf_status first = front->point[front->n_point - s->front.n_failed].status;
        hf_warning(messages, "optimize.front: %d of %d points of the front failed: the first with %s",
                   s->front.n_failed, front->n_point,
                   first == HF_OUT_OF_LIMITS ? "no way from its neighbours into its limits" : hf_status_text(first));
    }
}

/* Warns about points that stopped at the maximum number of steps. Points that stalled would gain nothing from more
 * steps. */
static void warn_of_steps(const hf_front *front, int max_iterations, hf_messages *messages)
{
    int n = 0;
    for (int i = 0; i < front->n_point; i++) {
        const hf_front_point *p = &front->point[i];
        n += p->status == HF_OK && !p->is_converged && p->iterations >= max_iterations;
    }
    if (n > 0)
        hf_warning(messages,
                   "optimize.front: %d of %d points of the front are not converged after %d steps: they have no "
                   "slope, and better designs are near; raise optimize.refine_steps",
                   n, front->n_point, max_iterations);
}

/* Writes why Levenberg-Marquardt has found no front. Returns text. */
static const char *explain(const hf_problem *p, hf_status status, int end, char *text, size_t size)
{
    char name[HF_OBJECTIVE_NAME_SIZE];
    const char *why = hf_status_text(status);
    char hint[HF_NO_DESIGN_HINT_SIZE];
    hf_no_design_cap(p, p->form.boundary_tension_ratio, hint);
    if (status == HF_OUT_OF_LIMITS)
        why = p->settings.optimize.n_limit > 0 ? "no way from its start into optimize.limits"
                                               : "no way from its start into the bounds of optimize.variables";
    if (end >= 0)
        snprintf(text, size,
                 "optimize.front.%d: Levenberg-Marquardt has found no design with the least %s, an end of the "
                 "front: %s%s",
                 end, hf_objectives_name(p->evaluator.objectives, end, name), why, hint);
    else
        snprintf(text, size, "optimize.front: Levenberg-Marquardt has found no front: %s%s", why, hint);
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
} progress;

static void tell(const progress *p, int n_point, long n_step, bool is_last)
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

static void tell_step(void *context, int n_point, long n_step)
{
    tell(context, n_point, n_step, false);
}

hf_status hf_run_front(const hf_run_request *q, hf_problem *p, const hf_population *bounds, hf_front *front,
                       hf_summary *s, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    progress told = {q, hf_clock_s(), o->front_points};
    hf_front_refine_watcher watcher = {.tell = tell_step, .context = &told, .is_telling = ATOMIC_FLAG_INIT};
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
    tell(&told, 0, 0, false);
    bool applies = hf_front_refine_applies(&p->evaluator);
    hf_status status = !start ? HF_NO_MEMORY : applies ? hf_front_refine_find(&task, &found, &end) : HF_BAD_CASE;
    free(start);
    if (status != HF_OK) hf_front_free(&found);
    if (status == HF_INTERRUPTED || (q->stop_requested && *q->stop_requested)) {
        hf_front_free(&found);
        return HF_INTERRUPTED;
    }
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "out of memory for the front");
    memcpy((status == HF_OK ? &found : front)->base, s->form.objective, sizeof front->base);
    if (status != HF_OK) {
        const char *why = text;
        if (applies)
            why = explain(p, status, end, text, sizeof text);
        else
            snprintf(text, sizeof text, HF_PROBLEM_REFINE_NEEDS, hf_problem_no_slopes(p));
        if (!has_earlier) return hf_error(messages, applies ? HF_NO_FEASIBLE : HF_BAD_CASE, "%s", why);
        hf_warning(messages, "%s; the front is that of the last generation", why);
        hf_run_front_tell(front, s->optimize_wall_s, s, messages);
        return HF_OK;
    }
    hf_front_free(front);
    *front = found;
    tell(&told, front->n_point, watcher.n_step, true);
    hf_run_front_tell(front, hf_clock_s() - told.start_s, s, messages);
    warn_of_steps(front, o->refine_steps, messages);
    return HF_OK;
}
