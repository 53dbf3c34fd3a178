/* Finds the front of the objectives (METHOD section 7, fronts).
 *
 *     last generation, or the initial design
 *         | Levenberg-Marquardt, if the method ends with it: hf_front_refine_find, points between the ends
 *         v
 *     front -> summary, store; if it fails, the earlier front stays, with a warning */
#include "run/stages.h"

#include "base/clock.h"
#include "run/problem_parts.h"
#include "run/tolerance_stage.h"
#include "search/front_refine.h"
#include "search/pareto.h"
#include "solve/certificate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages ---- */

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
        hf_warning(messages,
                   "optimize.front: %d of %d points of the front have not converged after %d steps. These points have "
                   "no slope, and better designs exist near them. Raise optimize.refine_steps",
                   n, front->n_point, max_iterations);
}

/* Writes why Levenberg-Marquardt has found no front. */
static void explain_no_front(const hf_problem *p, hf_status status, int end, char text[HF_NO_DESIGN_SIZE])
{
    char name[HF_OBJECTIVE_NAME_SIZE], hint[HF_NO_DESIGN_HINT_SIZE];
    const char *why = hf_status_text(status);
    const size_t size = HF_NO_DESIGN_SIZE;
    hf_no_design_cap(p, p->form.boundary_tension_ratio, hint);
    if (!hf_front_refine_applies(&p->evaluator)) {
        snprintf(text, size, HF_PROBLEM_REFINE_NEEDS, hf_problem_no_slopes(p));
        return;
    }
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
}

/* ---- requirements ---- */

/* The points of a front while they are judged. */
typedef struct {
    hf_run *run;
    hf_requirements_stage stage;
    hf_requirement_verdict *verdict; /* [stage.required.n] of one point */
    int n_design;                    /* points that have not failed; those that have are the last ones */
    double begin_s;
} judge;

/* Gives the verdicts of a shape on the rows without a share. A design without an as-built net fails in load cases. */
static hf_status judge_nominal(judge *q, hf_workspace *w, hf_form_result *result)
{
    hf_problem *p = &q->run->problem;
    const hf_model *m = &p->model;
    hf_surface_measures measures = {0};
    hf_messages unread = {0};
    hf_status status = HF_OK;
    if (q->stage.required.nominal == 0) return HF_OK;
    hf_requirements_stage_forget(&q->stage);
    hf_certify(m, w, result);
    if (hf_required_needs_surface(&q->stage.required, false, 0))
        status = hf_surface_measure(&p->surface, &p->facets, m, w->position_m, w->tension_N, &measures);
    if (status == HF_OK) status = hf_requirements_stage_take(&q->stage, 0, m, w, result, &measures, &unread);
    if (status == HF_OK) status = hf_load_case_stage_measure(p, w, &q->stage, &unread);
    hf_messages_free(&unread);
    hf_requirements_stage_judge_design(&q->stage, q->verdict);
    return status == HF_NO_MEMORY ? status : HF_OK;
}

/* Gives the verdicts of a shape on the rows with a share. A design without an as-built net fails. */
static hf_status judge_samples(judge *q, const hf_workspace *w, int i)
{
    const hf_required *of = &q->stage.required;
    const hf_tolerance_design design = {w, i, q->n_design, q->begin_s};
    hf_messages unread = {0};
    hf_status status = HF_OK;
    if (of->n_share > 0) status = hf_tolerance_stage_judge(q->run, &design, q->verdict, &unread);
    hf_messages_free(&unread);
    if (status == HF_NO_MEMORY || status == HF_INTERRUPTED || status == HF_IO) return status;
    for (int k = 0; k < of->n_share && status != HF_OK; k++) {
        q->verdict[of->share[k]].verdict = HF_VERDICT_FAIL;
        q->verdict[of->share[k]].relative_margin = -INFINITY;
    }
    return HF_OK;
}

static hf_status judge_point(judge *q, int i)
{
    hf_run *r = q->run;
    hf_front *front = &r->front;
    hf_form_result result;
    hf_workspace *w =
        hf_batch_run_one(&r->problem.batch, front->design + (size_t)i * (size_t)front->n_variable, &result);
    if (!hf_status_has_shape(result.status)) return HF_OK;
    hf_requirements_stage_clear(&q->stage, q->verdict);
    HF_TRY(judge_nominal(q, w, &result));
    HF_TRY(judge_samples(q, w, i));
    front->point[i].judgement = hf_requirements_judge(q->stage.required.n, q->verdict);
    return HF_OK;
}

static bool is_judged(const hf_run *r)
{
    return r->requirements.required.n > 0 && !hf_tolerance_stage_is_task(r->request);
}

/* Gives the verdicts of all points on the rows of `requirements`; n_design of them have not failed. */
static hf_status judge_front(hf_run *r, int n_design, hf_messages *messages)
{
    judge q = {.run = r, .begin_s = hf_clock_s(), .n_design = n_design};
    int n = r->requirements.required.n;
    if (!is_judged(r)) return HF_OK;
    hf_status status = hf_requirements_stage_open(&r->problem, &q.stage, messages);
    if (status == HF_OK && !(q.verdict = calloc((size_t)n, sizeof *q.verdict))) status = HF_NO_MEMORY;
    for (int i = 0; i < r->front.n_point && status == HF_OK; i++) {
        if (hf_run_must_stop(r)) status = HF_INTERRUPTED;
        if (status == HF_OK && r->front.point[i].status == HF_OK) status = judge_point(&q, i);
    }
    if (status == HF_INTERRUPTED)
        snprintf(r->stopped_at, sizeof r->stopped_at, " while it judged the points of the front, which are stored");
    if (status == HF_NO_MEMORY) hf_error(messages, status, "out of memory for the requirements");
    if (status == HF_IO) hf_error(messages, status, "the samples of a point of the front cannot be kept");
    free(q.verdict);
    hf_requirements_stage_free(&q.stage);
    return status;
}

/* ---- the front ---- */

/* Writes the table of the front into the summary, warns about points that failed, and stores the front. wall_s is the
 * time that it took, s. */
static hf_status keep_front(hf_run *r, double wall_s, hf_summary *s, hf_messages *messages)
{
    hf_front *front = &r->front;
    memcpy(front->initial, s->stage[HF_STAGE_FORM].result.objective, sizeof front->initial);
    if (!s->front) s->front = calloc(1, sizeof *s->front);
    if (!s->front) return hf_error(messages, HF_NO_MEMORY, "out of memory for the front");
    s->front->wall_s = wall_s;
    hf_front_tabulate(front, s->front);
    /* A session that is interrupted while it judges the points keeps the front. */
    if (is_judged(r)) HF_TRY(hf_store_front(r->store, &r->problem.scene, &r->problem.model, s, front, messages));
    HF_TRY(judge_front(r, front->n_point - s->front->n_failed, messages));
    hf_front_tabulate(front, s->front);
    if (s->front->n_failed > 0) {
        hf_status first = front->point[front->n_point - s->front->n_failed].status;
        hf_warning(messages,
                   "optimize.front: %d of %d points of the front failed. The first failure has this reason: %s",
                   s->front->n_failed, front->n_point,
                   first == HF_OUT_OF_LIMITS ? "the refinement did not reach its limits from the neighbouring points"
                                             : hf_status_text(first));
    }
    return hf_store_front(r->store, &r->problem.scene, &r->problem.model, s, front, messages);
}

/* ---- Levenberg-Marquardt ---- */

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

/* The search for a front, as its observer needs it. */
typedef struct {
    const hf_run_control *control;
    double start_s;
    int n_point; /* maximum number of points */
} front_progress;

static void tell_front(const front_progress *q, int n_point, long n_step, bool is_last)
{
    hf_run_report(q->control, (hf_run_progress){.phase = HF_RUN_REFINE,
                                                .is_last = is_last,
                                                .best_psi_m = (double)NAN,
                                                .elapsed_s = hf_clock_s() - q->start_s,
                                                .merit = (double)NAN,
                                                .points = n_point,
                                                .points_all = q->n_point,
                                                .steps = n_step});
}

static void tell_front_step(void *context, int n_point, long n_step)
{
    tell_front(context, n_point, n_step, false);
}

/* Finds a front and makes it r->front. The search starts from the designs of the earlier front, or else from the
 * initial design. *end is the end of the front without a design, or -1. Returns the status of the search; the earlier
 * front stays if it fails. */
static hf_status search_front(hf_run *r, int *end)
{
    hf_problem *p = &r->problem;
    const hf_optimize_settings *o = &p->settings.optimize;
    const hf_population *bounds = &r->optimiser.population;
    const hf_run_control *control = &r->request->control;
    front_progress progress = {control, hf_clock_s(), o->front_points};
    hf_front_refine_watcher watcher = {.tell = tell_front_step, .context = &progress, .is_telling = ATOMIC_FLAG_INIT};
    hf_front_refine task = {.evaluator = &p->evaluator,
                            .lower = bounds->lower,
                            .upper = bounds->upper,
                            .n_point = o->front_points,
                            .max_iterations = o->refine_steps,
                            .n_thread = p->batch.n_thread,
                            .stop = control->stop_requested,
                            .watcher = control->observer ? &watcher : NULL};
    hf_front found = {0};
    double *start = make_starts(p, bounds, &r->front, &task.n_start);
    task.start = start;
    tell_front(&progress, 0, 0, false);
    hf_status status = HF_NO_MEMORY;
    if (start) status = hf_front_refine_applies(&p->evaluator) ? hf_front_refine_find(&task, &found, end) : HF_BAD_CASE;
    free(start);
    if (hf_run_must_stop(r)) status = HF_INTERRUPTED;
    hf_front_free(status == HF_OK ? &r->front : &found);
    if (status != HF_OK) return status;
    r->front = found;
    tell_front(&progress, found.n_point, watcher.n_step, true);
    return HF_OK;
}

/* ---- the stage ---- */

/* Takes the front that an earlier session has found and stored by Levenberg-Marquardt, if there is one. */
static hf_status take_stored(hf_run *r, double *took_s, bool *is_taken, hf_messages *messages)
{
    hf_front stored;
    HF_TRY(hf_store_restore_front(r->store, r->problem.model.n_variable, &stored, took_s, messages));
    *is_taken = stored.n_point > 0 && stored.minimised >= 0; /* that of the genetic algorithm has no such objective */
    hf_front_free(*is_taken ? &r->front : &stored);
    if (*is_taken) r->front = stored;
    return HF_OK;
}

/* Finds the front by Levenberg-Marquardt and keeps it. */
static hf_status refine_front(hf_run *r, hf_summary *s, hf_messages *messages)
{
    char why[HF_NO_DESIGN_SIZE];
    int end = -1;
    bool has_earlier = r->front.n_point > 0;
    bool is_stored;
    double begin_s = hf_clock_s(), took_s;
    HF_TRY(take_stored(r, &took_s, &is_stored, messages));
    hf_status status = is_stored ? HF_OK : search_front(r, &end);
    if (!is_stored) took_s = hf_clock_s() - begin_s;
    if (status == HF_INTERRUPTED)
        snprintf(r->stopped_at, sizeof r->stopped_at,
                 " in the refinement of the front, which restarts and repeats %.0f s", took_s);
    if (status == HF_INTERRUPTED) return status;
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "out of memory for the front");
    if (status == HF_OK) {
        HF_TRY(keep_front(r, took_s, s, messages));
        warn_of_front_steps(&r->front, r->problem.settings.optimize.refine_steps, messages);
        return HF_OK;
    }
    explain_no_front(&r->problem, status, end, why);
    if (!has_earlier) return hf_error(messages, status == HF_BAD_CASE ? status : HF_NO_FEASIBLE, "%s", why);
    hf_warning(messages, "%s. The result contains the front of the last generation", why);
    return keep_front(r, s->stage[HF_STAGE_SEARCH].wall_s, s, messages);
}

hf_status hf_stage_front(hf_run *r, hf_summary *s, hf_messages *messages)
{
    if (r->plan.kind && hf_pareto_front(&r->optimiser.population, &r->front) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the front");
    if (r->plan.ends_with_refine) return refine_front(r, s, messages);
    return keep_front(r, s->stage[HF_STAGE_SEARCH].wall_s, s, messages);
}
