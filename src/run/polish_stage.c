/* Runs the refinement of a design by Levenberg-Marquardt, so that an interrupted run resumes it.
 *
 *     state of an earlier session in the store, if there is one
 *         |
 *         v
 *     hf_refine_run; after each step: store its state, publish the file, notify the observer, check the stop flag
 *         |
 *         v
 *     refined design, with a warning if it has not converged */
#include "run/polish_stage.h"

#include "base/clock.h"

#include <math.h>

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

static void tell_step(const refine_job *j)
{
    const hf_run_request *q = j->request;
    const hf_refine_progress *now = &j->now;
    if (!q->observer) return;
    const hf_run_progress progress = {.phase = HF_RUN_REFINE,
                                      .iteration = now->iterations,
                                      .iterations = now->max_iterations,
                                      .first_iteration = j->first_iteration,
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
    tell_step(j);
    return is_stopped(j->request) ? HF_INTERRUPTED : HF_OK;
}

/* Warns if the steps ended before convergence, because such a result looks like a converged one. */
static void warn_of_steps(const refine_job *j, const hf_refine_result *r)
{
    int n = r->iterations - j->first_iteration < LATELY ? r->iterations - j->first_iteration : LATELY;
    double before = j->merit[(r->iterations - n) % (LATELY + 1)];
    const char *what = j->problem->objectives.n_objective ? "the merit" : "psi";
    if (r->stop != HF_REFINE_MAX_ITERATIONS) return;
    if (n > 0 && before > 0)
        hf_warning(j->messages,
                   "Levenberg-Marquardt is not converged after %d steps, of which the last %d lowered %s by %.2g %%: "
                   "better designs are near; raise optimize.refine_steps",
                   r->iterations, n, what, 100 * (1 - j->now.merit / before));
    else
        hf_warning(j->messages, "Levenberg-Marquardt is not converged after %d steps; raise optimize.refine_steps",
                   r->iterations);
}

/* Writes into stopped_at where the refinement has stopped, for the message of an interrupted run. */
static void tell_stop(const refine_job *j, char stopped_at[HF_REFINE_STAGE_TEXT])
{
    int n = snprintf(stopped_at, HF_REFINE_STAGE_TEXT, " after %d steps of Levenberg-Marquardt", j->now.iterations);
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
                                     &watcher, design, &p->workspace, result);
    *wall_s = j.earlier_s + hf_clock_s() - j.begin_s;
    tell_stop(&j, stopped_at);
    if (status == HF_OK && !is_stopped(q) && hf_optimiser_plan_of(&p->settings.optimize).ends_with_refine)
        warn_of_steps(&j, result);
    return status;
}
