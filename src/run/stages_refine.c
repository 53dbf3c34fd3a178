/* Refines a design by Levenberg-Marquardt, or takes a point of an earlier front as the design.
 *
 *     best design so far, and the state of an earlier session in the store, if there is one
 *         |
 *         v
 *     hf_refine_run; after each step: store its state, publish the file, notify the observer, check the stop flag
 *         |
 *         v
 *     refined design, with a warning if it has not converged: shape, measures, store */
#include "run/stages.h"

#include "base/clock.h"
#include "run/problem_parts.h"
#include "search/refine.h"
#include "search/restart.h"
#include "solve/certificate.h"

#include <math.h>
#include <stdlib.h>

#define PUBLISH_AFTER_S 1.0 /* a shorter refinement publishes no file between steps */
#define LATELY 10           /* steps whose gain a warning about convergence reports */
#define WORTH 1e-4          /* smaller gains are not reported as a reason to continue [as for settled runs, refine.c] */

/* ---- the design ---- */

/* Evaluates the design of the stage for its shape. Returns HF_OK, whatever the status of the design is, or
 * HF_INTERRUPTED. */
static hf_status evaluate_design(hf_run *r, const double *design, hf_summary *s)
{
    hf_evaluate(&r->problem.evaluator, design, &r->problem.workspace, &r->problem.point,
                &s->stage[HF_STAGE_REFINE].result);
    return hf_run_must_stop(r) ? HF_INTERRUPTED : HF_OK;
}

/* Completes and stores the stage: its result is that of this design, and the workspace holds its shape. */
static hf_status keep_design(hf_run *r, const double *design, hf_summary *s, hf_messages *messages)
{
    hf_workspace *w = &r->problem.workspace;
    hf_certify(&r->problem.model, w, &s->stage[HF_STAGE_REFINE].result);
    s->stage[HF_STAGE_REFINE].exists = true;
    HF_TRY(hf_stage_measure(r, HF_STAGE_REFINE, w, s, messages));
    if (s->refine.is_result) HF_TRY(hf_stage_take(r, w, messages));
    return hf_store_shape(r->store, HF_STAGE_REFINE, &r->problem.model, w, design, messages);
}

hf_status hf_stage_point(hf_run *r, hf_summary *s, hf_messages *messages)
{
    const hf_population *p = &r->optimiser.population;
    const double *design = r->taken.design;
    hf_stage_summary *to = &s->stage[HF_STAGE_REFINE];
    double start_s = hf_clock_s();
    HF_TRY(evaluate_design(r, design, s));
    HF_TRY(hf_take_point_check(&r->problem, &r->taken, p, &to->result, messages));
    hf_problem_warn(&r->problem, "point's", &r->problem.workspace, &to->result, messages);
    to->wall_s = hf_clock_s() - start_s;
    s->refine.is_result = true;
    s->refine.evaluations = 1;
    s->refine.algorithm_stop = HF_REFINE_TAKEN;
    s->refine.predicted_gain = NAN;
    hf_stage_count_at_bounds(p, design, &s->refine.n_at_lower, &s->refine.n_at_upper);
    return keep_design(r, design, s, messages);
}

/* ---- steps ---- */

/* The steps of this session. */
typedef struct {
    hf_run *run;
    const hf_summary *summary;
    hf_messages *messages;
    double begin_s, earlier_s;         /* start of this session, and duration of earlier ones, s */
    int first_iteration, n_evaluation; /* first step of this session; evaluations of earlier ones */
    double merit[LATELY + 1];          /* merits of the last steps: step i in [i % (LATELY + 1)] */
    hf_refine_progress now;
} steps;

static bool has_merit(const steps *q)
{
    return q->run->problem.objectives.n_objective > 0;
}

static void tell_step(const steps *q)
{
    const hf_refine_progress *now = &q->now;
    hf_run_report(&q->run->request->control, (hf_run_progress){.phase = HF_RUN_REFINE,
                                                               .step = now->iterations,
                                                               .max_steps = now->max_iterations,
                                                               .first_step = q->first_iteration,
                                                               .is_last = now->is_last,
                                                               .evaluations = now->evaluations - q->n_evaluation,
                                                               .best_psi_m = now->psi_m,
                                                               .merit = has_merit(q) ? now->merit : (double)NAN,
                                                               .violation = now->violation,
                                                               .elapsed_s = hf_clock_s() - q->begin_s});
}

/* Stores a step, publishes the file if the refinement takes long, then notifies the observer, which thus hears of
 * stored steps only. Returns HF_OK, HF_INTERRUPTED, or an error of the store. */
static hf_status between_steps(void *context, const hf_refine_progress *now)
{
    steps *q = context;
    if (q->now.n_state == 0) {
        q->first_iteration = now->iterations;
        q->n_evaluation = now->evaluations;
    }
    double wall_s = q->earlier_s + hf_clock_s() - q->begin_s;
    q->now = *now;
    q->merit[now->iterations % (LATELY + 1)] = now->merit;
    HF_TRY(hf_store_refine(q->run->store, wall_s, now->n_state, now->state, q->messages));
    if (wall_s > PUBLISH_AFTER_S) HF_TRY(hf_store_publish(q->run->store, q->summary, false, q->messages));
    tell_step(q);
    return hf_run_must_stop(q->run) ? HF_INTERRUPTED : HF_OK;
}

/* Warns if the steps ended before convergence, because such a result looks like a converged one. Better designs are
 * claimed only if the model predicts them and the last steps have confirmed the model. At a corner of an objective, the
 * model predicts gains that no step reaches. */
static void warn_of_steps(const steps *q, const hf_refine_result *r)
{
    int n = r->iterations - q->first_iteration < LATELY ? r->iterations - q->first_iteration : LATELY;
    double before = q->merit[(r->iterations - n) % (LATELY + 1)];
    double gain = n > 0 && before > 0 ? 1 - q->now.merit / before : 0;
    const hf_run_request *request = q->run->request;
    const char *what = has_merit(q) ? "the merit" : "psi";
    char lately[96] = "", predicted[96] = "";
    if (r->stop != HF_REFINE_MAX_ITERATIONS) return;
    if (n == 1 && gain >= 0)
        snprintf(lately, sizeof lately, ": the last step lowered %s by %.2g %%", what, 100 * gain);
    else if (n > 0 && gain >= 0)
        snprintf(lately, sizeof lately, ": the last %d steps lowered %s by %.2g %%", n, what, 100 * gain);
    if (isfinite(r->predicted_gain))
        snprintf(predicted, sizeof predicted, "; the model predicts at most %.3g %% less", 100 * r->predicted_gain);
    if (r->predicted_gain > WORTH && gain > WORTH)
        hf_warning(q->messages,
                   "Levenberg-Marquardt has not converged after %d step%s. Better designs are near%s%s. %s",
                   r->iterations, r->iterations == 1 ? "" : "s", lately, predicted,
                   request->part.of_sweep || request->output.no_file ? "Raise optimize.refine_steps"
                                                                     : "Continue with the option --more N");
    else
        hf_warning(q->messages, "Levenberg-Marquardt has not converged after %d step%s%s%s", r->iterations,
                   r->iterations == 1 ? "" : "s", lately, predicted);
}

/* Notes where the refinement has stopped, for the message of an interrupted run. */
static void note_stop(const steps *q, char stopped_at[HF_STOPPED_AT_SIZE])
{
    int n = snprintf(stopped_at, HF_STOPPED_AT_SIZE, " after %d steps of the refinement", q->now.iterations);
    if (q->now.iterations == 0) return;
    if (q->now.violation > 0) {
        snprintf(stopped_at + n, HF_STOPPED_AT_SIZE - (size_t)n, ", outside the limits or requirements");
        return;
    }
    n += snprintf(stopped_at + n, HF_STOPPED_AT_SIZE - (size_t)n, ", at psi %.4f mm", q->now.psi_m * 1e3);
    if (has_merit(q) && isfinite(q->now.merit))
        snprintf(stopped_at + n, HF_STOPPED_AT_SIZE - (size_t)n, " and a merit of %.6g", q->now.merit);
}

/* Refines r->design within the bounds. Returns HF_INTERRUPTED if the run was told to stop; the next publication has the
 * steps so far. Otherwise returns the status of hf_refine_run, or an error of the store. */
static hf_status find_steps(hf_run *r, hf_summary *s, hf_refine_result *outcome, hf_messages *messages)
{
    hf_problem *p = &r->problem;
    const hf_optimize_settings *settings = &p->settings.optimize;
    const hf_population *bounds = &r->optimiser.population;
    steps q = {.run = r, .summary = s, .messages = messages, .begin_s = hf_clock_s()};
    int n_more = r->request->part.more_steps, most = n_more ? r->steps_before + n_more : settings->refine_steps;
    hf_refine_watcher watcher = {.after = between_steps, .context = &q, .is_more = n_more > 0};
    hf_run_report(&r->request->control, (hf_run_progress){.phase = HF_RUN_REFINE, .best_psi_m = NAN, .merit = NAN});
    HF_TRY(hf_store_restore_refine(r->store, &q.earlier_s, &watcher.n_state, &watcher.state, messages));
    hf_status status = hf_refine_run(&p->evaluator, bounds->lower, bounds->upper, most, NULL, &watcher, r->design,
                                     &p->workspace, outcome);
    s->stage[HF_STAGE_REFINE].wall_s = q.earlier_s + hf_clock_s() - q.begin_s;
    if (hf_run_must_stop(r)) {
        note_stop(&q, r->stopped_at);
        return HF_INTERRUPTED;
    }
    if (status == HF_OK) warn_of_steps(&q, outcome);
    return status;
}

/* ---- restarts ---- */

/* Notifies the observer of a step of a restart. Returns HF_INTERRUPTED if the run must stop. */
static hf_status between_restarted_steps(void *context, const hf_refine_progress *now)
{
    steps *q = context;
    q->now = *now;
    q->now.is_last = false;
    tell_step(q);
    return hf_run_must_stop(q->run) ? HF_INTERRUPTED : HF_OK;
}

/* Refines from other starts after a refinement that has ended with this status, if the method asks for it. They are not
 * stored: a resumed run takes them again. Returns HF_OK, HF_INTERRUPTED, HF_NO_MEMORY, or `status` if no design is
 * feasible. */
static hf_status restart_steps(hf_run *r, hf_summary *s, hf_status status, hf_refine_result *outcome,
                               hf_messages *messages)
{
    hf_problem *p = &r->problem;
    hf_stage_summary *to = &s->stage[HF_STAGE_REFINE];
    steps q = {.run = r, .summary = s, .messages = messages, .begin_s = hf_clock_s()};
    hf_refine_watcher watcher = {.after = between_restarted_steps, .context = &q};
    if (p->settings.optimize.method != HF_OPTIMIZE_AUTO) return status;
    if (status == HF_OK ? outcome->stop == HF_REFINE_MAX_ITERATIONS : !hf_status_has_shape(status)) return status;
    free(to->optima); /* of an earlier session */
    to->optima = calloc(1, sizeof *to->optima);
    if (!to->optima) return HF_NO_MEMORY;
    status = hf_restart_run(&p->batch, &r->optimiser.population, p->settings.optimize.refine_steps, &watcher, r->design,
                            &p->workspace, outcome, to->optima);
    to->wall_s += hf_clock_s() - q.begin_s;
    if (to->optima->n > 0) return status;
    free(to->optima);
    to->optima = NULL;
    return status;
}

/* ---- the stage ---- */

/* Returns true if the search has found a feasible design. */
static bool has_searched(const hf_summary *s)
{
    return s->stage[HF_STAGE_SEARCH].exists && s->stage[HF_STAGE_SEARCH].result.status == HF_OK;
}

bool hf_stage_wants_refine(const hf_run *r, const hf_summary *s)
{
    const hf_optimize_settings *o = &r->problem.settings.optimize;
    if (o->n_front > 0 || !hf_refine_applies(&r->problem.evaluator)) return false;
    if (r->plan.ends_with_refine || o->refine == HF_REFINE_TRUE) return true;
    return o->refine == HF_REFINE_AUTO &&
           (!has_searched(s) || hf_refine_is_cheap(&r->problem.evaluator, s->search.evaluations));
}

/* Returns true if no feasible design of the search is better than the refined one. */
static bool is_best(const hf_run *r, const hf_summary *s)
{
    const hf_population *p = &r->optimiser.population;
    const hf_form_result *refined = &s->stage[HF_STAGE_REFINE].result;
    if (!has_searched(s)) return true;
    return refined->status == HF_OK &&
           hf_population_merit(p, refined) <= hf_population_merit(p, &s->stage[HF_STAGE_SEARCH].result);
}

/* Reports that no feasible design was found. If the search has found one, this is a warning. */
static hf_status tell_no_design(hf_run *r, const hf_summary *s, hf_status status, hf_messages *messages)
{
    char why[HF_NO_DESIGN_SIZE];
    if (r->plan.kind && !has_searched(s))
        return hf_no_design_evolved(&r->problem, &r->optimiser.population, r->design, r->advice, messages);
    hf_no_design_to_refine(&r->problem, r->optimiser.population.initial, r->design, status, r->advice, why);
    if (!r->plan.kind) return hf_error(messages, HF_NO_FEASIBLE, "%s", why);
    hf_warning(messages, "%s", why);
    return HF_OK;
}

hf_status hf_stage_refine(hf_run *r, hf_summary *s, hf_messages *messages)
{
    const hf_population *bounds = &r->optimiser.population;
    hf_refine_result outcome;
    hf_problem_warn_of_refine(&r->problem, messages);
    if (!hf_stage_wants_refine(r, s)) return HF_OK;
    for (int k = 0; k < bounds->n_variable; k++) /* the initial design may violate the bounds */
        r->design[k] = hf_population_clamp(bounds, k, r->design[k]);
    hf_status status = find_steps(r, s, &outcome, messages);
    status = restart_steps(r, s, status, &outcome, messages);
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "out of memory for the sensitivities");
    if (status == HF_INTERRUPTED || status == HF_IO || status == HF_EXISTS) return status;
    if (status != HF_OK) return tell_no_design(r, s, status, messages);
    HF_TRY(evaluate_design(r, r->design, s));
    s->refine.is_result = is_best(r, s);
    s->refine.steps = outcome.iterations;
    s->refine.evaluations = outcome.evaluations;
    s->refine.algorithm_stop = outcome.stop;
    s->refine.predicted_gain = outcome.predicted_gain;
    s->refine.n_at_lower = outcome.n_at_lower;
    s->refine.n_at_upper = outcome.n_at_upper;
    s->refine.n_at_limit = outcome.n_at_limit;
    s->refine.is_at_cap = outcome.is_at_cap;
    return keep_design(r, r->design, s, messages);
}
