/* Runs a whole case, as `hifdm run` does.
 *
 *     case, net, truss, model (problem_parts.c); the result file is opened, resumed or found finished
 *         | form-finding: shape, certificate, measures
 *         | search: generations, each stored when it is evaluated
 *         | refinement by Levenberg-Marquardt; or a front; or a point taken from an earlier front
 *         | load cases of the as-built net (load_case_stage.c)
 *         | tolerance: samples of the as-built net (tolerance_stage.c)
 *         v
 *     doubts about the result, summary, finished file
 *
 * Each stage measures and stores its shape. A run that is stopped publishes its file, and the same command resumes
 * it. */
#include <hifdm/run.h>

#include "base/clock.h"
#include "base/path.h"
#include "base/text.h"
#include "linalg/lapack.h"
#include "run/load_case_stage.h"
#include "run/stages.h"
#include "run/diagnose.h"
#include "run/problem_parts.h"
#include "run/take_point.h"
#include "run/tolerance_stage.h"
#include "search/pareto.h"
#include "solve/certificate.h"
#include "solve/coupling.h"
#include "store/store_read.h"
#include <hifdm/metrics.h>
#include <hifdm/store.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const hf_run_phase_word[4] = {"form", "search", "refine", "tolerance"};

#define HISTORY_MAX 1000000 /* maximum number of iterations in the history */

/* Everything a run owns. */
typedef struct {
    const hf_run_request *request;
    hf_problem problem;
    hf_carrier_state truss;    /* of the truss, under the shape of the result */
    const hf_workspace *shape; /* workspace that holds that shape */
    hf_places places;          /* after form-finding, if an optimisation follows */
    hf_load_case_stage cases;  /* as-built net of the design, if there are load cases */
    hf_history history;
    hf_store *store;
    hf_optimiser optimiser;
    hf_front front;         /* front of optimize.front */
    hf_taken_point taken;   /* point taken instead of a search for a front */
    hf_optimiser_plan plan; /* the stages and algorithms of optimize.method */
    int first_generation;   /* of this session */
    long first_evaluation;
    char stopped_at[HF_REFINE_STAGE_TEXT];                 /* how far an interrupted stage came, for the message */
    double store_cpu_s;                                    /* processor time for storing generations */
    double earlier_wall_s, earlier_cpu_s, earlier_store_s; /* of earlier sessions, as published */
} run;

static void run_free(run *r, hf_messages *messages)
{
    hf_store_abandon(r->store, messages); /* NULL once it is finished */
    hf_optimiser_free(&r->optimiser);
    hf_front_free(&r->front);
    free(r->taken.design);
    free(r->history.psi_m);
    hf_carrier_state_free(&r->truss);
    hf_places_free(&r->places);
    hf_load_case_stage_free(&r->cases);
    hf_problem_free(&r->problem);
}

static bool must_stop(const run *r)
{
    return r->request->stop_requested && *r->request->stop_requested;
}

static void observe(const run *r, hf_run_progress progress)
{
    if (r->request->observer) r->request->observer(r->request->observer_context, &progress);
}

/* Publishes all finished generations of a run that was told to stop; the same command resumes from them. Returns
 * HF_INTERRUPTED, or an error of the store. */
static hf_status stop_here(run *r, const hf_summary *s, hf_messages *messages)
{
    HF_TRY(hf_store_publish(r->store, s, true, messages));
    return HF_INTERRUPTED;
}

/* Measures a shape that is reported, and stops the run if the measurement was interrupted. An interrupted form-finding
 * is stopped by find_form, after its shape is stored. */
static hf_status measure_shape(run *r, hf_stage stage, const hf_workspace *w, hf_summary *s, hf_messages *messages)
{
    const hf_run_request *q = r->request;
    hf_status status = hf_measure_stage(&r->problem, stage, w, q->threads, q->stop_requested, r->store, s, messages);
    return status == HF_INTERRUPTED && stage != HF_STAGE_FORM ? stop_here(r, s, messages) : status;
}

/* Sets r->truss to the forces and displacements of the truss, if there is one, under the net of this shape. */
static hf_status load_truss(run *r, hf_workspace *w, hf_messages *messages)
{
    const hf_problem *p = &r->problem;
    if (!p->settings.has_truss) return HF_OK;
    hf_carrier_state_free(&r->truss);
    hf_coupling_forces(&p->model, w);
    hf_status status = hf_carrier_load(&p->carrier, w->attachment_force_N, &r->truss);
    return status == HF_OK ? HF_OK : hf_error(messages, status, "out of memory for the forces in the truss");
}

/* Makes the shape in the workspace the result, unless a later stage finds another. */
static hf_status take_result(run *r, hf_workspace *w, hf_messages *messages)
{
    HF_TRY(load_truss(r, w, messages));
    r->shape = w;
    return r->problem.load_cases.n ? hf_load_case_stage_take(&r->problem, w, &r->cases, messages) : HF_OK;
}

/* ---- form-finding ---- */

static hf_status create_history(const hf_form_settings *s, bool has_truss, hf_history *h)
{
    h->capacity = s->max_iterations < HISTORY_MAX ? s->max_iterations : HISTORY_MAX;
    size_t n = (size_t)h->capacity, n_coupling = has_truss ? (size_t)s->coupling.max_iterations : 0;
    double *block = calloc(5 * n + 3 * n_coupling, sizeof *block);
    if (!block) return HF_NO_MEMORY;
    h->psi_m = block;
    h->residual_N = block + n;
    h->inner_tension_ratio = block + 2 * n;
    h->boundary_tension_ratio = block + 3 * n;
    h->length_error = block + 4 * n;
    double *more = block + 5 * n;
    h->coupling = (hf_coupling_history){(int)n_coupling, 0, more, more + n_coupling, more + 2 * n_coupling};
    return HF_OK;
}

static hf_status find_form(run *r, hf_summary *s, hf_messages *messages)
{
    hf_problem *p = &r->problem;
    const hf_form_settings *form = &p->settings.form;
    HF_TRY(hf_problem_allocate(p, messages));
    p->workspace.stop = r->request->stop_requested;
    if (create_history(form, p->model.n_attachment > 0, &r->history) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for a net of %d nodes", p->model.n_node);
    observe(r, (hf_run_progress){.phase = HF_RUN_FORM, .best_psi_m = NAN, .merit = NAN});
    double start_s = hf_clock_s();
    hf_evaluate_form(&p->model, form, &p->workspace, &r->history, &p->form);
    s->stage[HF_STAGE_FORM].wall_s = hf_clock_s() - start_s;
    s->stage[HF_STAGE_FORM].result = p->form;
    for (int k = 0; k < HF_DESIGN_ROWS_MAX; k++) /* measured in prepare_optimize, with the initial design */
        s->stage[HF_STAGE_FORM].result.objective[k] = (double)NAN;
    hf_status status = hf_problem_explain(p, messages);
    if (status != HF_OK && status != HF_NOT_CONVERGED) return status;
    hf_status measured = measure_shape(r, HF_STAGE_FORM, &p->workspace, s, messages);
    if (measured != HF_OK && measured != HF_INTERRUPTED) return measured;
    HF_TRY(hf_store_form(r->store, &p->model, &p->workspace, &r->history, messages));
    if (measured == HF_INTERRUPTED) return stop_here(r, s, messages);
    HF_TRY(take_result(r, &p->workspace, messages));
    return status;
}

/* ---- optimisation ---- */

/* Prepares the initial design with its objectives, the batch and the optimiser. It allocates everything that the
 * generations need before the first one. */
static hf_status prepare_optimize(run *r, hf_summary *s, hf_messages *messages)
{
    hf_problem *p = &r->problem;
    if (hf_places_keep(p, &r->places) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the target positions");
    HF_TRY(hf_problem_base(p, messages));
    HF_TRY(hf_reach_check(p, messages));
    const hf_objectives *objectives = &p->objectives;
    if (objectives->n_objective &&
        hf_objectives_measure(objectives, &p->workspace, &p->point, s->stage[HF_STAGE_FORM].result.objective,
                              &s->stage[HF_STAGE_FORM].result.merit) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the objectives");
    HF_TRY(hf_store_restore_initial(r->store, p->model.n_variable, p->initial, messages));
    if (hf_problem_batch(p, r->request->threads) != HF_OK ||
        hf_optimiser_create(r->plan.kind, &p->settings.optimize, &p->model, p->initial, &r->optimiser) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for %d individuals of %d design variables on %d threads",
                        p->settings.optimize.population, p->model.n_variable, p->batch.n_thread);
    return HF_OK;
}

static double *best_design(const hf_population *p)
{
    return p->design + (size_t)p->best * (size_t)p->n_variable;
}

static void count_at_bounds(const hf_population *p, const double *design, int *at_lower, int *at_upper)
{
    *at_lower = *at_upper = 0; /* a resumed run has the counts of the session before */
    for (int k = 0; k < p->n_variable; k++) {
        *at_lower += design[k] <= p->lower[k];
        *at_upper += design[k] >= p->upper[k];
    }
}

static void note_best(const hf_population *p, hf_summary *s)
{
    if (p->best < 0) return;
    if (s->stage[HF_STAGE_SEARCH].result.status == HF_OK &&
        !(hf_population_merit(p, &p->result[p->best]) < hf_population_merit(p, &s->stage[HF_STAGE_SEARCH].result)))
        return;
    s->stage[HF_STAGE_SEARCH].result = p->result[p->best];
    s->search.best_generation = p->generation;
    s->search.best_individual = p->best;
}

/* Stores the shape of the best individual. That is in the last generation (elitism), and evaluating it again for its
 * shape gives the same bits. */
static hf_status store_best(run *r, hf_summary *s, hf_messages *messages)
{
    const double *design = best_design(&r->optimiser.population);
    hf_form_result again;
    hf_workspace *w = hf_batch_run_one(&r->problem.batch, design, &again);
    hf_certify(&r->problem.model, w, &again);
    s->stage[HF_STAGE_SEARCH].result = again; /* the same bits, with the figures that individuals do not store */
    count_at_bounds(&r->optimiser.population, design, &s->search.n_at_lower, &s->search.n_at_upper);
    hf_problem_warn(&r->problem, "search", w, &s->stage[HF_STAGE_SEARCH].result, messages);
    HF_TRY(measure_shape(r, HF_STAGE_SEARCH, w, s, messages));
    if (r->problem.settings.optimize.n_front == 0) HF_TRY(take_result(r, w, messages)); /* a front has no result */
    return hf_store_shape(r->store, HF_STAGE_SEARCH, &r->problem.model, w, design, messages);
}

/* Writes the state of the generations into the summary, which files published between generations contain as well. */
static void sum_up(const run *r, double start_s, hf_summary *s)
{
    const hf_population *p = &r->optimiser.population;
    s->stage[HF_STAGE_SEARCH].exists = true;
    s->stage[HF_STAGE_SEARCH].wall_s = r->earlier_wall_s + hf_clock_s() - start_s;
    s->search.cpu_s = r->earlier_cpu_s + r->problem.batch.cpu_s + r->store_cpu_s;
    s->search.store_cpu_s = r->earlier_store_s + r->store_cpu_s;
    s->search.generations = p->generation + 1;
    s->search.evaluations = p->n_evaluation;
    s->search.infeasible = p->n_evaluation_infeasible;
    s->search.algorithm_stop = p->stop_reason;
}

/* A generation that is stored while the next one is bred and evaluated. */
typedef struct {
    run *r;
    hf_population population; /* copy of the state after hf_optimiser_tell */
    const hf_summary *summary;
    hf_messages *messages;
    hf_status status;
} told;

static void observe_generation(const told *t)
{
    const hf_population *p = &t->population;
    observe(t->r, (hf_run_progress){.phase = HF_RUN_SEARCH,
                                    .generation = p->generation + 1,
                                    .generations = p->generation_limit,
                                    .first_generation = t->r->first_generation,
                                    .is_last = p->stop_reason != HF_POPULATION_RUNNING,
                                    .evaluations = p->n_evaluation - t->r->first_evaluation,
                                    .best_psi_m = p->best_psi_m[p->generation],
                                    .merit = NAN,
                                    .elapsed_s = t->summary->stage[HF_STAGE_SEARCH].wall_s - t->r->earlier_wall_s});
}

/* Stores a generation, publishes it when due, then notifies the observer, which thus hears of stored generations
 * only. */
static void keep(void *context)
{
    told *t = context;
    double start_s = hf_clock_thread_cpu_s();
    t->status = hf_store_generation(t->r->store, &t->r->problem.model, &t->population, t->messages);
    if (t->status == HF_OK) t->status = hf_store_publish(t->r->store, t->summary, false, t->messages);
    if (t->status == HF_OK) observe_generation(t);
    t->r->store_cpu_s += hf_clock_thread_cpu_s() - start_s;
}

/* Restores the generations of earlier sessions. If there are none, publishes a file without generations at once,
 * because a journal is always read together with a published file. */
static hf_status begin_generations(run *r, hf_summary *s, hf_messages *messages)
{
    const hf_population *p = &r->optimiser.population;
    HF_TRY(hf_store_variables(r->store, &r->problem.model, p, messages));
    HF_TRY(hf_store_restore(r->store, &r->optimiser, s, messages));
    if (hf_store_generations(r->store) == 0) return hf_store_publish(r->store, s, true, messages);
    hf_optimiser_tell(&r->optimiser);
    r->earlier_wall_s = s->stage[HF_STAGE_SEARCH].wall_s;
    r->earlier_cpu_s = s->search.cpu_s;
    r->earlier_store_s = s->search.store_cpu_s;
    r->first_generation = p->generation + 1;
    r->first_evaluation = p->n_evaluation;
    return HF_OK;
}

/* Evaluates the first generation of this session. Returns false if there is none. */
static bool evaluate_first(run *r)
{
    const hf_population *p = &r->optimiser.population;
    if (r->first_generation > 0) return hf_batch_next(&r->problem.batch, &r->optimiser, NULL, NULL);
    hf_batch_run(&r->problem.batch, p->n_individual, p->design, p->pending, p->result);
    return true;
}

static hf_status evolve(run *r, hf_summary *s, hf_messages *messages)
{
    const hf_population *p = &r->optimiser.population;
    s->stage[HF_STAGE_SEARCH].result.status = HF_NO_FEASIBLE;
    HF_TRY(hf_problem_share(&r->problem, messages));
    s->search.solver = r->problem.solver;
    HF_TRY(begin_generations(r, s, messages));
    if (must_stop(r)) return stop_here(r, s, messages);
    double start_s = hf_clock_s();
    bool more = evaluate_first(r);
    while (more) {
        hf_optimiser_tell(&r->optimiser);
        if (p->generation == 0) s->search.initial_psi_m = p->result[0].psi_m;
        note_best(p, s);
        sum_up(r, start_s, s);
        told now = {r, *p, s, messages, HF_OK};
        bool stops = must_stop(r) && p->stop_reason == HF_POPULATION_RUNNING;
        if (stops)
            keep(&now);
        else
            more = hf_batch_next(&r->problem.batch, &r->optimiser, keep, &now);
        HF_TRY(now.status);
        if (stops) return stop_here(r, s, messages);
    }
    sum_up(r, start_s, s);
    if (p->best >= 0) return store_best(r, s, messages);
    return hf_no_design_evolved(&r->problem, p, messages);
}

/* Completes and stores the refinement: the result of the stage is that of this design, and the workspace holds its
 * shape. */
static hf_status keep_refine(run *r, hf_workspace *w, const double *design, hf_summary *s, hf_messages *messages)
{
    hf_certify(&r->problem.model, w, &s->stage[HF_STAGE_REFINE].result);
    s->stage[HF_STAGE_REFINE].exists = true;
    HF_TRY(measure_shape(r, HF_STAGE_REFINE, w, s, messages));
    if (s->refine.is_result) HF_TRY(take_result(r, w, messages));
    return hf_store_shape(r->store, HF_STAGE_REFINE, &r->problem.model, w, design, messages);
}

/* Takes a point of an earlier front as the design. */
static hf_status take_point(run *r, hf_summary *s, hf_messages *messages)
{
    hf_workspace *w = &r->problem.workspace;
    const hf_population *p = &r->optimiser.population;
    const double *design = r->taken.design;
    double start_s = hf_clock_s();
    hf_evaluate(&r->problem.evaluator, design, w, &r->problem.point, &s->stage[HF_STAGE_REFINE].result);
    if (must_stop(r)) return stop_here(r, s, messages);
    HF_TRY(hf_take_point_check(&r->problem, &r->taken, p, &s->stage[HF_STAGE_REFINE].result, messages));
    hf_problem_warn(&r->problem, "point's", w, &s->stage[HF_STAGE_REFINE].result, messages);
    s->stage[HF_STAGE_REFINE].wall_s = hf_clock_s() - start_s;
    s->refine.is_result = true;
    s->refine.evaluations = 1;
    s->refine.algorithm_stop = HF_REFINE_TAKEN;
    count_at_bounds(p, design, &s->refine.n_at_lower, &s->refine.n_at_upper);
    return keep_refine(r, w, design, s, messages);
}

/* Refines the best individual, or the initial design if no search was run. */
static hf_status refine(run *r, hf_summary *s, hf_messages *messages)
{
    hf_workspace *w = &r->problem.workspace;
    const hf_population *p = &r->optimiser.population;
    hf_refine_result outcome;
    double *design = r->problem.initial;
    if (s->stage[HF_STAGE_SEARCH].exists && p->best >= 0) design = best_design(p);
    for (int k = 0; k < p->n_variable; k++) /* the initial design may violate the bounds */
        design[k] = hf_population_clamp(p, k, design[k]);
    observe(r, (hf_run_progress){.phase = HF_RUN_REFINE, .best_psi_m = NAN, .merit = NAN});
    hf_status status = hf_refine_stage_run(r->request, &r->problem, p, s, r->store, design, &outcome,
                                           &s->stage[HF_STAGE_REFINE].wall_s, r->stopped_at, messages);
    if (must_stop(r)) return stop_here(r, s, messages);
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "out of memory for the sensitivities");
    if (status == HF_IO || status == HF_EXISTS) return status;
    if (status != HF_OK) {
        char why[HF_NO_DESIGN_SIZE];
        hf_no_design_to_refine(&r->problem, design, status, why);
        if (!r->plan.kind) return hf_error(messages, HF_NO_FEASIBLE, "%s", why);
        hf_warning(messages, "%s", why);
        return HF_OK;
    }
    hf_evaluate(&r->problem.evaluator, design, w, &r->problem.point, &s->stage[HF_STAGE_REFINE].result);
    if (must_stop(r)) return stop_here(r, s, messages); /* the evaluation may have been interrupted */
    s->refine.is_result = r->plan.ends_with_refine;
    s->refine.steps = outcome.iterations;
    s->refine.evaluations = outcome.evaluations;
    s->refine.algorithm_stop = outcome.stop;
    s->refine.n_at_lower = outcome.n_at_lower;
    s->refine.n_at_upper = outcome.n_at_upper;
    s->refine.n_at_limit = outcome.n_at_limit;
    s->refine.is_at_cap = outcome.is_at_cap;
    return keep_refine(r, w, design, s, messages);
}

/* Returns true if a refinement is to be run: as the result, on request, or by default if it is cheap. */
static bool wants_refine(const run *r, const hf_summary *s)
{
    hf_refine_choice compare = r->problem.settings.optimize.refine;
    if (r->plan.ends_with_refine || compare == HF_REFINE_TRUE) return true;
    return compare == HF_REFINE_AUTO && hf_refine_is_cheap(&r->problem.evaluator, s->search.evaluations);
}

/* Finds the front by Levenberg-Marquardt and stores it. */
static hf_status follow_front(run *r, hf_summary *s, hf_messages *messages)
{
    double begin_s = hf_clock_s();
    hf_status status = hf_run_front(r->request, &r->problem, &r->optimiser.population, &r->front, s, messages);
    if (must_stop(r)) {
        snprintf(r->stopped_at, sizeof r->stopped_at,
                 " in the refinement of the front, which restarts and repeats %.0f s", hf_clock_s() - begin_s);
        return stop_here(r, s, messages);
    }
    HF_TRY(status);
    return hf_store_front(r->store, &r->problem.scene, &r->problem.model, s, &r->front, messages);
}

/* Finds and stores the front of the objectives. With a search it is that of the last generation, from which
 * Levenberg-Marquardt starts if the method ends with it. Otherwise Levenberg-Marquardt finds it alone. */
static hf_status find_front(run *r, hf_summary *s, hf_messages *messages)
{
    hf_problem_warn_of_front(&r->problem, messages);
    if (!r->plan.kind) return follow_front(r, s, messages);
    HF_TRY(evolve(r, s, messages));
    if (must_stop(r)) return stop_here(r, s, messages);
    if (hf_pareto_front(&r->optimiser.population, &r->front) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the front");
    if (r->plan.ends_with_refine) return follow_front(r, s, messages);
    memcpy(r->front.initial, s->stage[HF_STAGE_FORM].result.objective, sizeof r->front.initial);
    HF_TRY(hf_run_front_tell(&r->front, s->stage[HF_STAGE_SEARCH].wall_s, s, messages));
    return hf_store_front(r->store, &r->problem.scene, &r->problem.model, s, &r->front, messages);
}

static hf_status optimize(run *r, hf_summary *s, hf_messages *messages)
{
    r->plan = hf_optimiser_plan_of(&r->problem.settings.optimize);
    HF_TRY(prepare_optimize(r, s, messages));
    s->threads = r->problem.batch.n_thread;
    if (r->taken.design) return take_point(r, s, messages);
    if (r->problem.settings.optimize.n_front > 0) return find_front(r, s, messages);
    if (r->plan.kind) HF_TRY(evolve(r, s, messages));
    if (must_stop(r)) return stop_here(r, s, messages);
    if (hf_refine_applies(&r->problem.evaluator)) return wants_refine(r, s) ? refine(r, s, messages) : HF_OK;
    hf_problem_warn_of_refine(&r->problem, messages);
    return HF_OK;
}

/* ---- the whole run ---- */

/* Sets output to the path given by -o, or else to the name of the case with .h5 in the current folder. Returns HF_OK,
 * or HF_IO if the path is too long. */
static hf_status choose_output(const hf_run_request *o, char output[HF_OUTPUT_SIZE], hf_messages *messages)
{
    if (hf_path_choose(o->output, o->case_path, ".h5", output, HF_OUTPUT_SIZE)) return HF_OK;
    return hf_error(messages, HF_IO, "%s: the path is too long", o->output ? o->output : o->case_path);
}

/* Runs form-finding and optimisation as the case requires. No optimisation follows a form-finding that fails or does
 * not converge. */
static hf_status stages(run *r, hf_summary *s, hf_messages *messages)
{
    HF_TRY(find_form(r, s, messages));
    if (must_stop(r)) return HF_INTERRUPTED;
    if (r->problem.settings.has_optimize && r->problem.model.n_variable == 0)
        hf_warning(messages, "optimize: skipped, because no boundary cable has a free end");
    else if (r->problem.settings.has_optimize)
        return optimize(r, s, messages);
    return HF_OK;
}

/* Returns true if the run writes its file. A run that did not converge or found no feasible design writes one that
 * shows how far it came. */
static bool leaves_result(hf_status status)
{
    return status == HF_OK || status == HF_NOT_CONVERGED || status == HF_NO_FEASIBLE;
}

/* Returns true for faults of the machine and for files in the way. The same command may succeed once they are
 * removed. */
static bool is_of_machine(hf_status status)
{
    return status == HF_IO || status == HF_NO_MEMORY || status == HF_EXISTS;
}

/* Returns true if the result keeps the design although its samples failed. That is so only if another attempt would
 * fail, too; the result then contains the reason. */
static bool outlives_samples(const hf_run_request *q, hf_status status)
{
    return status != HF_OK && status != HF_INTERRUPTED && !is_of_machine(status) && !hf_tolerance_stage_is_task(q);
}

/* Publishes the stages that are stored, unfinished, so that the same command resumes after them. If the disk is full,
 * the file published before and the journals remain. */
static void keep_unfinished(const run *r, const hf_summary *s, hf_status status, const char *output,
                            hf_messages *messages)
{
    hf_messages unwanted = {0}; /* the failure that led here has its own message */
    bool is_kept = r->store && hf_store_publish(r->store, s, true, &unwanted) == HF_OK;
    if (is_kept && status != HF_INTERRUPTED && !r->request->of_sweep)
        hf_warning(messages, "%s: is unfinished; run the same command again to resume", output);
    hf_messages_free(&unwanted);
}

/* Returns the stored summary and status of a result that is already finished, with the errors that explain the
 * status. */
static hf_status repeat_finished(const hf_run_request *q, const char *output, hf_summary *s, hf_messages *messages)
{
    HF_TRY(hf_store_read_finished(output, s, messages));
    if (s->tolerance) hf_tolerance_stage_end(q, output);
    hf_warning(messages, "%s: is the finished result of this case; use --restart to compute it again", output);
    for (const char *line = s->warnings; *line; line += strcspn(line, "\n"), line += *line == '\n')
        if (!strncmp(line, "error: ", 7)) hf_error(messages, s->status, "%.*s", (int)strcspn(line + 7, "\n"), line + 7);
    return s->status;
}

/* Copies the messages into text, errors first. If there is no room for all lines, warnings are lost and not the reason
 * of a failure. */
static void keep_messages(const hf_messages *messages, char text[HF_WARNINGS_SIZE])
{
    size_t n = 0, length;
    *text = '\0';
    for (int of_errors = 1; of_errors >= 0; of_errors--)
        for (const char *line = messages->text; line && *line && n < HF_WARNINGS_SIZE; line += length) {
            length = strcspn(line, "\n") + 1; /* each line has an end */
            bool is_error = strncmp(line, "error: ", 7) == 0;
            if (is_error == of_errors) n += (size_t)snprintf(text + n, HF_WARNINGS_SIZE - n, "%.*s", (int)length, line);
        }
    hf_text_trim_utf8(text);
}

/* Sets *state and opens the store. No store is opened for a finished result, nor for one task of several, which has
 * none. */
static hf_status open_store(run *r, char *output, hf_store_state *state, hf_messages *messages)
{
    const hf_run_request *q = r->request;
    const hf_case *settings = &r->problem.settings;
    const hf_scene *scene = &r->problem.scene;
    const hf_truss *truss = settings->has_truss ? &r->problem.carrier.truss : NULL;
    HF_TRY(choose_output(q, output, messages));
    HF_TRY(hf_problem_spare_inputs(&r->problem, settings->taken.point ? settings->taken.path : NULL, output, messages));
    if (!q->restart) HF_TRY(hf_store_look(output, settings, scene, truss, state, messages));
    if (*state == HF_STORE_FINISHED) return HF_OK;
    HF_TRY(hf_tolerance_stage_look(q, &r->problem, output, messages));
    if (hf_tolerance_stage_is_task(q)) return HF_OK;
    HF_TRY(hf_lapack_load(messages)); /* the file records which one it is */
    if (*state == HF_STORE_UNFINISHED) return hf_store_resume(output, &r->store, messages);
    return hf_store_create(output, q->restart, settings, scene, truss, q->argc, q->argv, &r->store, messages);
}

static hf_status execute(run *r, hf_summary *s, char *output, hf_messages *messages)
{
    const hf_run_request *q = r->request;
    hf_case *settings = &r->problem.settings;
    HF_TRY(hf_problem_load(q->case_path, q->source, q->set, q->n_set, q->stop_requested, &r->problem, messages));
    if (settings->has_sweep && !q->of_sweep)
        return hf_error(messages, HF_BAD_USAGE, "%s: has a section sweep; run it by 'hifdm sweep %s'", q->case_path,
                        q->case_path);
    HF_TRY(hf_tolerance_stage_check(&r->problem, q->of_tolerance, messages));
    if (q->has_seed) settings->optimize.seed = q->seed;
    if (q->has_seed && !settings->has_optimize)
        hf_warning(messages, "--seed has no effect, because the case has no section optimize");
    if (q->point) HF_TRY(hf_take_point_read(q->point, &r->problem, &r->taken, messages));
    hf_problem_describe(&r->problem, s);
    hf_store_state state = HF_STORE_NOTHING;
    if (!q->no_file) HF_TRY(open_store(r, output, &state, messages));
    if (state == HF_STORE_FINISHED) return repeat_finished(q, output, s, messages);
    hf_status status = stages(r, s, messages);
    bool has_design = status == HF_OK;
    if (status == HF_OK && r->problem.load_cases.n)
        status = hf_load_case_stage_run(&r->problem, &r->cases, r->store, q->stop_requested, s, messages);
    const hf_tolerance_stage stage = {q, &r->problem, r->shape, output, r->store};
    bool keeps_design = false;
    if (status == HF_OK && settings->has_tolerance) {
        status = hf_tolerance_stage_run(&stage, s, messages);
        keeps_design = outlives_samples(q, status);
        if (keeps_design) hf_warning(messages, "tolerance: the result has the design alone, without samples");
    }
    if (has_design && (status == HF_INTERRUPTED || is_of_machine(status)))
        keep_unfinished(r, s, status, output, messages);
    if (status == HF_INTERRUPTED && (r->store || hf_tolerance_stage_is_task(q)))
        hf_error(messages, status, "%s: interrupted%s; run the same command again to resume", output, r->stopped_at);
    if ((!leaves_result(status) && !keeps_design) || hf_tolerance_stage_is_task(q)) return status;
    hf_result_doubt_truss(&r->problem, &r->truss, r->shape, messages);
    hf_result_doubt_strain(&r->problem, r->shape, messages);
    hf_result_doubt_uncounted(&r->problem, &r->places, r->shape, messages);
    if (s->has_truss) HF_TRY(hf_store_truss(r->store, &r->problem.carrier, &r->truss, messages));
    keep_messages(messages, s->warnings);
    s->finished = true;
    s->status = status;
    hf_status finish = hf_store_complete(r->store, s, messages);
    hf_store *store = r->store;
    r->store = NULL;
    if (finish == HF_OK && q->unsettled)
        *q->unsettled = store;
    else
        finish = hf_store_settle(store, messages);
    if (finish == HF_OK && s->tolerance) hf_tolerance_stage_end(q, output);
    return finish != HF_OK ? finish : status;
}

hf_status hf_run_case(const hf_run_request *request, hf_summary *summary, char output[HF_OUTPUT_SIZE],
                      hf_messages *messages)
{
    run *r = calloc(1, sizeof *r);
    if (request->unsettled) *request->unsettled = NULL;
    *summary = (hf_summary){.stage[HF_STAGE_FORM].result.status = HF_NOT_EVALUATED, .threads = 1};
    snprintf(summary->version, sizeof summary->version, "%s", hf_store_version());
    output[0] = '\0';
    if (!r) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", request->case_path);
    r->request = request;
    hf_status status = execute(r, summary, output, messages);
    bool is_kept = leaves_result(status) || (summary->finished && summary->status == status);
    if (!is_kept || hf_tolerance_stage_is_task(request)) output[0] = '\0';
    run_free(r, messages);
    free(r);
    return status;
}
