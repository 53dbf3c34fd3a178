/* Searches a design by generations.
 *
 *     initial design, batch and optimiser; generations that an earlier session has stored
 *         |
 *         v
 *     each generation is ranked, then stored while the next one is bred and evaluated
 *         |
 *         v
 *     best individual: shape, measures, store */
#include "run/stages.h"

#include "base/clock.h"
#include "run/problem_parts.h"
#include "search/repair.h"
#include "solve/certificate.h"
#include "store/store_internal.h"

#include <math.h>

/* Time for which generations may wait for the journal, s. The computation of that time is lost if the process is
 * killed. The tests of resuming and of interrupting pass from 0 to 0.5. */
#define HOLD_S 0.05

hf_status hf_stage_begin(hf_run *r, hf_summary *s, hf_messages *messages)
{
    hf_problem *p = &r->problem;
    hf_form_result *form = &s->stage[HF_STAGE_FORM].result;
    if (p->model.n_variable == 0) {
        hf_warning(messages, "optimize: hifdm skips the optimisation, because no boundary cable has a free end");
        return HF_OK;
    }
    if (hf_places_keep(p, &r->places) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the target positions");
    HF_TRY(hf_problem_base(p, messages));
    HF_TRY(hf_reach_check(p, messages));
    HF_TRY(hf_feasible_check(p, r->request->input.source, r->advice, messages));
    if (p->objectives.n_objective &&
        hf_objectives_measure(&p->objectives, &p->workspace, &p->point, form->objective, &form->merit) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the objectives");
    hf_problem_limit_search(p);
    HF_TRY(hf_store_restore_initial(r->store, p->model.n_variable, p->initial, messages));
    if (hf_problem_batch(p, r->request->control.threads) != HF_OK ||
        hf_optimiser_create(r->plan.kind, &p->settings.optimize, &p->model, p->initial, &r->optimiser) != HF_OK ||
        hf_optimiser_repair(&r->optimiser, &p->evaluator) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for %d individuals of %d design variables on %d threads",
                        p->settings.optimize.population, p->model.n_variable, p->batch.n_thread);
    s->threads = p->batch.n_thread;
    r->design = p->initial;
    if (!r->taken.design) hf_problem_warn_of_front(p, messages);
    return HF_OK;
}

/* ---- generations ---- */

/* The generations of this session. */
typedef struct {
    hf_run *run;
    hf_summary *summary;
    hf_messages *messages;
    hf_population told; /* copy of the state after hf_optimiser_tell, for `keep` */
    hf_status status;   /* of keeping it */
    double start_s, store_cpu_s;
    int first_generation;
    long first_evaluation;
    double earlier_wall_s, earlier_cpu_s, earlier_store_s; /* of earlier sessions, as published */
} search;

/* Restores the generations of earlier sessions. If there are none, publishes a file without generations at once,
 * because a journal is always read together with a published file. */
static hf_status begin_generations(search *q)
{
    hf_run *r = q->run;
    hf_summary *s = q->summary;
    const hf_population *p = &r->optimiser.population;
    HF_TRY(hf_store_variables(r->store, &r->problem.model, p, q->messages));
    HF_TRY(hf_store_restore(r->store, &r->optimiser, s, q->messages));
    r->may_publish = true;
    if (hf_store_generations(r->store) == 0) return hf_store_publish(r->store, s, true, q->messages);
    hf_optimiser_tell(&r->optimiser);
    q->earlier_wall_s = s->stage[HF_STAGE_SEARCH].wall_s;
    q->earlier_cpu_s = s->search.cpu_s;
    q->earlier_store_s = s->search.store_cpu_s;
    q->first_generation = p->generation + 1;
    q->first_evaluation = p->n_evaluation;
    return HF_OK;
}

static void note_best(const hf_population *p, hf_summary *s)
{
    hf_form_result *best = &s->stage[HF_STAGE_SEARCH].result;
    if (p->best < 0) return;
    if (best->status == HF_OK && !(hf_population_merit(p, &p->result[p->best]) < hf_population_merit(p, best))) return;
    *best = p->result[p->best];
    s->search.best_generation = p->generation;
    s->search.best_individual = p->best;
}

/* Writes the state of the generations into the summary, which files published between generations contain as well. */
static void sum_up_generations(const search *q)
{
    const hf_population *p = &q->run->optimiser.population;
    hf_summary *s = q->summary;
    s->stage[HF_STAGE_SEARCH].exists = true;
    s->stage[HF_STAGE_SEARCH].wall_s = q->earlier_wall_s + hf_clock_s() - q->start_s;
    s->search.cpu_s = q->earlier_cpu_s + q->run->problem.batch.cpu_s + q->store_cpu_s;
    s->search.store_cpu_s = q->earlier_store_s + q->store_cpu_s;
    s->search.generations = p->generation + 1;
    s->search.evaluations = p->n_evaluation;
    s->search.infeasible = p->n_evaluation_infeasible;
    s->search.algorithm_stop = p->stop_reason;
}

static void tell_generation(const search *q)
{
    const hf_population *p = &q->told;
    bool is_front = q->run->problem.settings.optimize.n_front > 0; /* which has no best design */
    hf_run_report(&q->run->request->control,
                  (hf_run_progress){.phase = HF_RUN_SEARCH,
                                    .generation = p->generation + 1,
                                    .generations = p->generation_limit,
                                    .first_generation = q->first_generation,
                                    .is_last = p->stop_reason != HF_POPULATION_RUNNING,
                                    .evaluations = p->n_evaluation - q->first_evaluation,
                                    .best_psi_m = is_front ? (double)NAN : p->best_psi_m[p->generation],
                                    .merit = NAN,
                                    .elapsed_s = q->summary->stage[HF_STAGE_SEARCH].wall_s - q->earlier_wall_s});
}

/* Stores a generation, publishes it when due, then notifies the observer, which thus hears of stored generations
 * only. */
static void keep(void *context)
{
    search *q = context;
    hf_store *store = q->run->store;
    double start_s = hf_clock_thread_cpu_s();
    q->status = hf_store_generation(store, &q->run->problem.model, &q->told, q->messages);
    if (q->status == HF_OK) q->status = hf_store_publish(store, q->summary, false, q->messages);
    if (q->status == HF_OK) tell_generation(q);
    q->store_cpu_s += hf_clock_thread_cpu_s() - start_s;
}

/* Warns if the children of the first generation have a model in which no design meets some limit. */
static void doubt(const search *q)
{
    const hf_optimiser *o = &q->run->optimiser;
    hf_repair_doubt found;
    if (q->told.generation == 0 && q->told.best < 0 && o->repair && hf_repair_doubts(o->repair, &found))
        hf_no_design_expected(&q->run->problem, &found, q->messages);
}

/* Evolves until the optimiser has ended. Returns HF_OK; HF_INTERRUPTED, with all generations stored; or an error of the
 * store. */
static hf_status evolve(search *q)
{
    hf_run *r = q->run;
    const hf_population *p = &r->optimiser.population;
    q->start_s = hf_clock_s();
    HF_TRY(hf_store_hold(r->store, HOLD_S, q->messages));
    bool more = true;
    if (q->first_generation > 0)
        more = hf_batch_next(&r->problem.batch, &r->optimiser, NULL, NULL);
    else
        hf_batch_run(&r->problem.batch, p->n_individual, p->design, p->pending, p->result);
    while (more) {
        hf_optimiser_tell(&r->optimiser);
        if (p->generation == 0) q->summary->search.initial_psi_m = p->result[0].psi_m;
        note_best(p, q->summary);
        sum_up_generations(q);
        q->told = *p;
        bool stops = hf_run_must_stop(r) && p->stop_reason == HF_POPULATION_RUNNING;
        if (stops)
            keep(q);
        else
            more = hf_batch_next(&r->problem.batch, &r->optimiser, keep, q);
        HF_TRY(q->status);
        if (stops) break;
        doubt(q);
    }
    HF_TRY(hf_store_hold(r->store, 0, q->messages));
    if (more) return HF_INTERRUPTED;
    sum_up_generations(q);
    return HF_OK;
}

/* ---- the stage ---- */

/* Stores the shape of the best individual. That is in the last generation (elitism), and evaluating it again for its
 * shape gives the same bits. */
static hf_status store_best(hf_run *r, hf_summary *s, hf_messages *messages)
{
    hf_form_result *best = &s->stage[HF_STAGE_SEARCH].result; /* receives figures that individuals do not store */
    hf_workspace *w = hf_batch_run_one(&r->problem.batch, r->design, best);
    hf_certify(&r->problem.model, w, best);
    hf_stage_count_at_bounds(&r->optimiser.population, r->design, &s->search.n_at_lower, &s->search.n_at_upper);
    hf_problem_warn(&r->problem, "search", w, best, messages);
    HF_TRY(hf_stage_measure(r, HF_STAGE_SEARCH, w, s, messages));
    if (r->problem.settings.optimize.n_front == 0) HF_TRY(hf_stage_take(r, w, messages)); /* a front has no result */
    return hf_store_shape(r->store, HF_STAGE_SEARCH, &r->problem.model, w, r->design, messages);
}

hf_status hf_stage_search(hf_run *r, hf_summary *s, hf_messages *messages)
{
    const hf_population *p = &r->optimiser.population;
    search q = {.run = r, .summary = s, .messages = messages};
    hf_result_blank(&s->stage[HF_STAGE_SEARCH].result);
    s->stage[HF_STAGE_SEARCH].result.status = HF_NO_FEASIBLE;
    HF_TRY(hf_problem_share(&r->problem, messages));
    s->search.solver = r->problem.solver;
    HF_TRY(begin_generations(&q));
    if (hf_run_must_stop(r)) return HF_INTERRUPTED;
    HF_TRY(evolve(&q));
    int start = hf_population_nearest(p); /* a refinement can find a feasible design from it */
    if (p->best < 0 && (start < 0 || !hf_stage_wants_refine(r, s)))
        return hf_no_design_evolved(
            &r->problem, p, start < 0 ? NULL : p->design + (size_t)start * (size_t)p->n_variable, r->advice, messages);
    r->design = p->design + (size_t)start * (size_t)p->n_variable;
    return p->best >= 0 ? store_best(r, s, messages) : HF_OK;
}
