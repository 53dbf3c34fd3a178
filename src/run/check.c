/* Finds what a run would do. check.h describes the interface.
 *
 *     case -> problem -> counts, memory -> short trials: form-finding, as-built samples, first generation,
 *     Levenberg-Marquardt -> times
 *
 * Contents: counts, memory, times, a case, the points of a study. */
#include "run/check.h"

#include "base/clock.h"
#include "base/text.h"
#include "run/diagnose.h"
#include "run/feasible.h"
#include "run/load_case_stage.h"
#include "run/problem_parts.h"
#include "search/chord.h"
#include "search/refine.h"
#include "search/restart.h"
#include "search/swarm.h"
#include "solve/prestress.h"
#include <hifdm/pattern.h>

#include <math.h>

#define OPERATIONS_PER_S 8e9 /* speed of one core in a step of the refinement, see hf_refine_operations */
/* Expected steps of a refinement, counted on the cases of configs and of METHOD section 7. If one of the first
 * TRIAL_STEPS steps fails, the way to the optimum is curved, or an objective has a corner on it. */
#define STEPS_SMOOTH 8
#define STEPS_ROUGH 30
#define TRIAL_STEPS 3
#define STEP_MOST_S 3.0 /* counted time of a step above which no step is tried */
#define LONG_S 3600.0   /* above this time, or above LARGE_BYTES, advice is given */
#define LARGE_BYTES 2e9
#define TRIAL_S 1.0      /* approximate time of each trial */
#define TRIAL_MOST_S 5.0 /* time after which a trial of Levenberg-Marquardt ends with its present step */
/* Iterations of the first trial of form-finding, and the factor to the next. */
#define FIRST_TRIAL 16
#define TRIAL_GROWTH 4
/* Time for making the nets of the points of a study; for one with more than MANY points, only MAKING_FEW_S. */
#define MAKING_S 5.0
#define MANY 100000
#define MAKING_FEW_S 0.5
#define MADE_LEAST 1000 /* while no point can be run, at least so many are made */

/* ---- counts ---- */

static void widen(const hf_scene *s, int e, hf_check_family *family)
{
    double T = s->target[e] * hf_scene_length_at_target(s, e);
    family->lower_N = fmin(family->lower_N, T);
    family->upper_N = fmax(family->upper_N, T);
}

/* Finds the range of the tensions that hold the net in each family of cables: the named sets, then the groups. */
static void find_families(const hf_scene *s, hf_check *c)
{
    for (int k = 0; k < s->n_set + 2 && c->n_family < HF_CHECK_FAMILIES; k++) {
        bool is_set = k < s->n_set;
        hf_check_family family = {is_set ? s->set_name[k] : hf_group_word[k - s->n_set], INFINITY, -INFINITY};
        for (int i = is_set ? s->set_start[k] : 0; is_set && i < s->set_start[k + 1]; i++)
            if (hf_prestress_family(s, s->set_cable[i]) == k) widen(s, s->set_cable[i], &family);
        for (int e = 0; e < s->n_cable && !is_set; e++)
            if (s->group[e] == k - s->n_set && hf_prestress_family(s, e) == k) widen(s, e, &family);
        if (family.lower_N <= family.upper_N) c->family[c->n_family++] = family;
    }
}

static void count_net(hf_check *c)
{
    const hf_scene *s = &c->problem.scene;
    for (int i = 0; i < s->n_node; i++)
        c->n_role[s->role[i]]++;
    for (int e = 0; e < s->n_cable; e++) {
        c->n_group[s->group[e]]++;
        c->n_law[c->problem.model.law[e]]++;
    }
    if (c->problem.settings.form.prestress == HF_PRESTRESS_EXACT) find_families(s, c);
}

static void count_variables(hf_check *c)
{
    const hf_model *m = &c->problem.model;
    for (int row = 0; row < c->problem.settings.optimize.n_variable_row && m->variable; row++) {
        int last = 0;
        for (int k = 0; k < m->n_variable; k++) {
            if (m->variable[k].setting != row) continue;
            last = k;
            c->n_in_row[row]++;
        }
        c->unit_of_row[row] = hf_model_variable_unit(m, last);
    }
}

static void count_nets(hf_check *c)
{
    const hf_objectives_nets *nets = c->problem.objectives.nets;
    for (int i = 0; nets && i < hf_objectives_nets_count(nets); i++) {
        c->n_net += hf_objectives_are_over(&c->problem.objectives, i);
        c->n_sample += i >= nets->n_load_case;
    }
}

static void plan_far_field(hf_check *c)
{
    const hf_problem *p = &c->problem;
    const hf_pattern_surface theory = {&p->facets, p->scene.position_m, NULL};
    hf_feed feed;
    if (!p->surface.has_pattern) return;
    hf_feed_make(&p->surface, &p->facets, p->scene.position_m, &feed);
    for (int k = 0; k < p->surface.frequencies_Hz.n; k++) {
        hf_far_field plan;
        hf_pattern_plan(&p->surface.pattern, &theory, &feed, p->surface.frequencies_Hz.value[k], &plan);
        c->far_field[k] = (hf_check_far_field){plan.n_point, hf_pattern_angles(&plan)};
    }
}

/* ---- memory ---- */

/* Returns the bytes that Levenberg-Marquardt needs: sensitivities (twice as many with a truss), residuals of the inner
 * nodes, matrices of its steps, and the packed Newton matrix; or the band of the saddle-point system. */
static double refine_bytes(const hf_evaluator *v)
{
    const hf_model *m = v->model;
    if (hf_refine_is_sparse(v)) return 8 * 36.0 * m->n_free * (m->half_bandwidth + 1);
    size_t lanes, matrix = hf_chord_bytes(v, &lanes);
    double n = m->n_leader, column = 3.0 * m->n_free * (m->n_attachment ? 2 : 1) + 3.0 * m->n_inner_node;
    return 8 * n * (column + 4 * n) + (double)(matrix + lanes);
}

/* Computes the bytes that the evaluation of a population needs: `shared` once for all threads, `lanes` for each
 * thread. */
static hf_status engine_bytes(const hf_evaluator *v, size_t *shared, size_t *lanes)
{
    bool has_lanes;
    hf_solver solver = hf_batch_solver(v, &has_lanes);
    if (solver == HF_SOLVER_CHORD) {
        *shared = hf_chord_bytes(v, lanes);
    } else if (has_lanes) {
        hf_swarm_plan plan;
        HF_TRY(hf_swarm_plan_create(v->model, hf_lane_best_isa(), &plan));
        *lanes = hf_swarm_lanes_bytes(&plan);
        hf_arena_free_block(plan.block);
    }
    return HF_OK;
}

static hf_status find_memory(hf_check *c, const hf_evaluator *v)
{
    const hf_model *m = &c->problem.model;
    const hf_optimize_settings *o = &c->problem.settings.optimize;
    hf_model without = *m;
    without.has_newton = false;
    size_t shared = 0, lanes = 0;
    double workspaces = c->optimizes ? c->threads + 1 : 1, bare = (double)hf_workspace_bytes(&without);
    double population = c->evolves ? (double)o->population : 0, variables = 8.0 * m->n_variable;
    if (c->evolves) HF_TRY(engine_bytes(v, &shared, &lanes));
    c->memory = (hf_check_memory){
        .workspaces = workspaces * bare,
        .newton = workspaces * ((double)hf_workspace_bytes(m) - bare),
        .shared = (double)shared,
        .lanes = (double)lanes * c->threads,
        .population = 2 * population * (variables + (double)sizeof(hf_form_result)),
        .refine = c->refines ? refine_bytes(v) : 0,
        .generations = population * (variables + 70) * o->generations,
    };
    return HF_OK;
}

/* ---- times ---- */

double hf_check_together_s(double each_s, int n, int *threads)
{
    if (*threads > n) *threads = n;
    return each_s * ((n + *threads - 1) / *threads);
}

/* Builds and condenses the truss a second time to measure how long that takes. */
static hf_status time_truss(hf_check *c, hf_messages *messages)
{
    hf_carrier again;
    double begin_s = hf_clock_s();
    hf_status status = hf_config_carrier(&c->problem.settings, &c->problem.scene, &again, messages);
    c->truss_s = hf_clock_s() - begin_s;
    hf_carrier_free(&again);
    return status;
}

/* Tries the form-finding, each time with more iterations, until it ends or the next trial would take more than
 * TRIAL_S. The first iterations cost more than later ones, above all on a truss. */
static void time_form(hf_check *c)
{
    hf_problem *p = &c->problem;
    hf_form_settings form = p->settings.form;
    hf_form_result *r = &p->form;
    int most = p->settings.form.max_iterations;
    double trial_s = 0;
    for (int n = FIRST_TRIAL; !c->is_form_finished && trial_s * TRIAL_GROWTH < TRIAL_S; n *= TRIAL_GROWTH) {
        form.max_iterations = n < most ? n : most;
        double begin_s = hf_clock_thread_cpu_s();
        hf_evaluate_form(&p->model, &form, &p->workspace, NULL, r);
        trial_s = hf_clock_thread_cpu_s() - begin_s;
        c->is_form_finished = r->status != HF_NOT_CONVERGED || form.max_iterations >= most;
    }
    c->form_s = c->is_form_finished ? trial_s : trial_s / r->iterations * most;
    c->at_most_s += c->form_s;
}

/* Finds the time of the load cases, at the shape of form-finding. */
static hf_status time_load_cases(hf_check *c, hf_messages *messages)
{
    const hf_problem *p = &c->problem;
    double all_s;
    if (p->load_cases.n == 0 || p->form.status != HF_OK) return HF_OK;
    hf_status status = hf_load_case_stage_try(p, &p->workspace, TRIAL_S, &all_s);
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "out of memory for the load cases");
    if (status != HF_OK) return HF_OK;
    c->load_cases_s = all_s;
    c->at_most_s += all_s;
    return HF_OK;
}

/* Returns the maximum number of points of a front that rows with a share judge. */
static int count_judged(const hf_check *c)
{
    const hf_case *s = &c->problem.settings;
    bool has_share = false;
    for (int i = 0; i < s->n_requirement; i++)
        has_share |= !isnan(s->requirement[i].share);
    if (!has_share || s->optimize.n_front == 0 || !c->optimizes) return 0;
    return c->is_refine_result ? s->optimize.front_points : s->optimize.population;
}

/* Finds the time of the as-built samples, at the shape of form-finding. */
static void time_tolerance(hf_check *c)
{
    const hf_problem *p = &c->problem;
    hf_tolerance_trial *t = &c->tolerance;
    int threads = c->threads;
    if (!p->settings.has_tolerance || p->form.status != HF_OK) return;
    c->has_tolerance = hf_tolerance_stage_try(p, &p->workspace, TRIAL_S, t) == HF_OK;
    if (!c->has_tolerance) return;
    c->tolerance_threads = threads;
    c->tolerance_s =
        t->begin_s + hf_check_together_s(t->sample_s, p->settings.tolerance.samples, &c->tolerance_threads);
    c->n_judged = count_judged(c);
    c->judged_s = c->n_judged * c->tolerance_s;
    c->at_most_s += c->tolerance_s + c->judged_s;
    if (!t->scale_yields) return;
    double each_s = t->scale_s > 0 ? t->scale_s / t->scale_samples : t->scale_sample_s * t->scale_yields;
    c->yields_s = hf_check_together_s(each_s, t->scale_samples, &threads);
    c->at_most_s += c->yields_s;
}

/* Evaluates designs of the first generation in one thread: first one, then more while they are expected to end within
 * TRIAL_MOST_S. Returns the processor time of a design, s. */
static double time_design(hf_batch *batch, const hf_population *ga)
{
    int n_most[] = {1, HF_LANES, ga->n_individual}, n_done = 0;
    double design_s = 0;
    for (int i = 0; i < 3; i++) {
        int n = n_most[i] < ga->n_individual ? n_most[i] : ga->n_individual;
        if (design_s > 0) n = (int)fmin(n, TRIAL_MOST_S / design_s);
        if (n <= n_done) continue;
        double begin_s = hf_clock_thread_cpu_s();
        hf_batch_run(batch, n, ga->design, ga->pending, ga->result);
        design_s = (hf_clock_thread_cpu_s() - begin_s) / n;
        n_done = n;
    }
    return design_s;
}

/* The time of the whole search is that of one design, times the designs per thread, times the maximum number of
 * generations. */
static hf_status time_search(hf_check *c, const hf_evaluator *v, const hf_population *ga)
{
    const hf_optimize_settings *o = &c->problem.settings.optimize;
    hf_batch batch = {0};
    int threads = c->threads;
    hf_status status = hf_batch_create(v, 1, &batch);
    if (status == HF_OK) {
        c->solver = hf_batch_share(&batch, c->problem.initial);
        c->design_s = time_design(&batch, ga);
        c->search_s = hf_check_together_s(c->design_s, o->population, &threads) * o->generations;
        c->at_most_s += c->search_s;
    }
    hf_batch_free(&batch);
    return status;
}

/* The steps of a trial of Levenberg-Marquardt. */
typedef struct {
    double begin_s, merit; /* begin_s: when the first step began */
    int n_failed;          /* steps that did not lower the merit */
} step_trial;

/* Ends a trial that has taken its time. hf_refine_watcher describes the arguments. */
static hf_status watch_step(void *context, const hf_refine_progress *now)
{
    step_trial *t = context;
    if (now->iterations == 0) t->begin_s = hf_clock_s();
    if (now->iterations > 0 && now->iterations <= TRIAL_STEPS) t->n_failed += !(now->merit < t->merit);
    t->merit = now->merit;
    double took_s = hf_clock_s() - t->begin_s;
    bool is_long = took_s > (now->iterations >= TRIAL_STEPS ? TRIAL_S : TRIAL_MOST_S);
    return !now->is_last && now->iterations > 0 && is_long ? HF_INTERRUPTED : HF_OK;
}

/* Runs Levenberg-Marquardt from the initial design for about the time of a trial. If it has not ended then, the number
 * of its steps follows from whether the first ones failed. If counted operations predict that a step takes long,
 * nothing is run. */
static hf_status time_refine(hf_check *c, const hf_evaluator *v, const hf_population *ga)
{
    hf_problem *p = &c->problem;
    const hf_optimize_settings *o = &p->settings.optimize;
    hf_refine_result r;
    double begin_s = hf_clock_s(), step_s = hf_refine_operations(v) / OPERATIONS_PER_S;
    step_trial t = {.begin_s = begin_s};
    const hf_refine_watcher watcher = {.after = watch_step, .context = &t};
    c->n_step = STEPS_SMOOTH;
    c->is_step_tried = step_s <= STEP_MOST_S;
    if (c->is_step_tried) {
        hf_status status =
            hf_refine_run(v, ga->lower, ga->upper, o->refine_steps, NULL, &watcher, p->initial, &p->workspace, &r);
        if (status == HF_NO_MEMORY) return status;
        if (r.iterations == 0) return HF_OK;
        bool has_ended = status != HF_INTERRUPTED; /* also without a feasible design */
        c->is_refine_tried = has_ended && !c->evolves && !o->n_front;
        step_s = (hf_clock_s() - t.begin_s) / r.iterations;
        int expected = t.n_failed ? STEPS_ROUGH : STEPS_SMOOTH;
        c->n_step = has_ended || r.iterations > expected ? r.iterations : expected;
    }
    if (c->n_step > o->refine_steps) c->n_step = o->refine_steps;
    c->step_s = step_s;
    int n_run = o->n_front > 0 ? o->front_points : o->method == HF_OPTIMIZE_AUTO ? 1 + HF_RESTARTS : 1;
    c->refine_s = t.begin_s - begin_s + step_s * ((double)c->n_step * n_run);
    c->advises_fewer = c->refine_s > LONG_S || c->memory.refine > LARGE_BYTES;
    c->at_most_s += c->refine_s;
    return HF_OK;
}

static hf_status time_optimisation(hf_check *c, const hf_evaluator *v)
{
    const hf_problem *p = &c->problem;
    const hf_optimiser_kind *kind = hf_optimiser_plan_of(&p->settings.optimize).kind;
    hf_optimiser o = {0};
    hf_status status = hf_optimiser_create(kind, &p->settings.optimize, &p->model, p->initial, &o);
    if (status == HF_OK && kind) status = time_search(c, v, &o.population);
    if (status == HF_OK && c->refines) status = time_refine(c, v, &o.population);
    hf_optimiser_free(&o);
    return status;
}

/* ---- a case ---- */

/* Finds which stages run. */
static void find_stages(hf_check *c, const hf_evaluator *v)
{
    const hf_problem *p = &c->problem;
    const hf_optimize_settings *o = &p->settings.optimize;
    hf_optimiser_plan plan = hf_optimiser_plan_of(o);
    c->method = hf_evaluate_method(&p->model, &p->settings.form, &c->method_reason);
    c->optimizes = p->settings.has_optimize && p->model.n_variable > 0;
    c->evolves = c->optimizes && plan.kind;
    c->is_refine_result = plan.ends_with_refine;
    bool may_refine = plan.ends_with_refine || (o->refine != HF_REFINE_FALSE && !o->n_front);
    c->refines = c->optimizes && may_refine && hf_refine_applies(v);
}

hf_status hf_check_load(const hf_check_request *q, hf_check *c, hf_messages *messages)
{
    hf_problem *p = &c->problem;
    c->threads = q->threads;
    c->form_s = c->load_cases_s = c->design_s = c->step_s = (double)NAN;
    double begin_s = hf_clock_thread_cpu_s();
    HF_TRY(hf_problem_load(q->path, NULL, q->set, q->n_set, NULL, p, messages));
    HF_TRY(hf_problem_allocate(p, messages));
    c->at_most_s = hf_clock_thread_cpu_s() - begin_s;
    const hf_evaluator evaluator = hf_problem_evaluator(p);
    find_stages(c, &evaluator);
    hf_problem_limit_search(p);
    count_net(c);
    count_variables(c);
    count_nets(c);
    plan_far_field(c);
    if (p->settings.has_truss) HF_TRY(time_truss(c, messages));
    return find_memory(c, &evaluator) == HF_OK ? HF_OK : hf_error(messages, HF_NO_MEMORY, "out of memory");
}

hf_status hf_check_try(hf_check *c, hf_messages *messages)
{
    hf_problem *p = &c->problem;
    const hf_evaluator evaluator = hf_problem_evaluator(p);
    hf_form_result result;
    char advice[HF_FEASIBLE_ADVICE_SIZE];
    time_form(c);
    if (!c->is_form_finished) return HF_OK;
    HF_TRY(hf_problem_explain(p, messages));
    HF_TRY(time_load_cases(c, messages));
    if (!c->optimizes) {
        time_tolerance(c);
        return HF_OK;
    }
    HF_TRY(hf_problem_base(p, messages));
    HF_TRY(hf_reach_check(p, messages));
    HF_TRY(hf_feasible_check(p, NULL, advice, messages));
    hf_problem_warn_of_refine(p, messages);
    hf_problem_warn_of_front(p, messages);
    if (time_optimisation(c, &evaluator) != HF_OK) return hf_error(messages, HF_NO_MEMORY, "out of memory");
    if (!p->settings.has_tolerance) return HF_OK;
    /* the samples are those of the refined design, if the trial has found it: slack cables take longer */
    hf_evaluate(&evaluator, p->initial, &p->workspace, &p->point, &result);
    if (hf_status_has_shape(result.status)) time_tolerance(c);
    return HF_OK;
}

/* ---- the points of a study ---- */

hf_status hf_check_study_points(const hf_study *s, hf_problem *scratch, hf_check_points *t, hf_messages *messages)
{
    double end_s = hf_clock_s() + (s->n_point > MANY ? MAKING_FEW_S : MAKING_S);
    *t = (hf_check_points){.first = -1};
    for (; t->n_tried < s->n_point && (hf_clock_s() < end_s || (t->first < 0 && t->n_tried < MADE_LEAST));
         t->n_tried++) {
        int i = hf_study_spread(s, t->n_tried);
        hf_study_overrides o;
        hf_messages found = {0};
        hf_study_point_overrides(s, i, &o);
        hf_status status = hf_problem_load(s->base, NULL, o.set, o.n_set, NULL, scratch, &found);
        hf_problem_free(scratch);
        if (status == HF_OK && (t->first < 0 || i < t->first)) t->first = i;
        if (status != HF_OK && t->n_fault++ < HF_FAULT_MAX_POINT) hf_study_tell_faults(s, i, &found, messages);
        hf_messages_free(&found);
        if (status == HF_NO_MEMORY || status == HF_IO || status == HF_INTERRUPTED) return status;
    }
    if (t->n_fault > HF_FAULT_MAX_POINT)
        hf_error(messages, HF_BAD_CASE, "%s: sweep: %d more points have faults", s->path,
                 t->n_fault - HF_FAULT_MAX_POINT);
    return t->first < 0 ? HF_BAD_CASE : HF_OK;
}
