/* `hifdm check` reports whether a case is valid, and what a run of it would do: the solvers, the memory and about how
 * long it takes. It runs short trials only, never the whole optimisation. */
#include "app/cmd.h"

#include "app/cmd_check_study.h"
#include "app/options.h"
#include "base/clock.h"
#include "case/study.h"
#include "net/symmetry.h"
#include "out/print.h"
#include "out/print_summary.h"
#include "run/diagnose.h"
#include "run/problem_parts.h"
#include "run/tolerance_stage.h"
#include "search/chord.h"
#include "search/refine.h"
#include "search/swarm.h"
#include "solve/prestress.h"
#include <hifdm/batch.h>
#include <hifdm/pattern.h>
#include <hifdm/run.h>

#include <limits.h>
#include <math.h>

#define OPERATIONS_PER_S 2e9 /* speed of one core, as in search/refine.c */
#define LONG_S 3600.0        /* above this time, or above LARGE_BYTES, advice is printed */
#define LARGE_BYTES 2e9
#define TRIAL_S 1.0 /* approximate wall-clock time of the trial of form-finding */

/* Prints how many cables obey each law. The three laws of the paper are always listed, the others only if a cable has
 * them. */
static void print_laws(const hf_model *m, FILE *f)
{
    int count[HF_N_LAW] = {0};
    for (int e = 0; e < m->n_cable; e++)
        count[m->law[e]]++;
    fprintf(f, "                %d cables by law in force:", m->n_cable);
    for (int law = 0; law < HF_N_LAW; law++) {
        if (law > HF_LAW_FORCE_DENSITY && count[law] == 0) continue;
        fprintf(f, "%s %d ", law ? "," : "", count[law]);
        for (const char *c = hf_law_word[law]; *c; c++)
            fputc(*c == '_' ? ' ' : *c, f);
        if (law == HF_LAW_FORCE_DENSITY && m->has_strut) fputs(" (with struts)", f);
    }
    fputc('\n', f);
}

#define SETS_NAMED 12

/* Prints how many cables are in each set, the groups first. */
static void print_sets(const hf_scene *s, FILE *f)
{
    int count[2] = {0};
    for (int e = 0; e < s->n_cable; e++)
        count[s->group[e]]++;
    fprintf(f, "                sets: %d %s, %d %s", count[0], hf_group_word[0], count[1], hf_group_word[1]);
    for (int k = 0; k < s->n_set && k < SETS_NAMED; k++)
        fprintf(f, ", %d %s", s->set_start[k + 1] - s->set_start[k], s->set_name[k]);
    if (s->n_set > SETS_NAMED) fprintf(f, " and %d more sets", s->n_set - SETS_NAMED);
    fputc('\n', f);
}

static void widen(const hf_scene *s, int e, double range[2])
{
    double T = s->target[e] * hf_scene_length_at_target(s, e);
    range[0] = fmin(range[0], T);
    range[1] = fmax(range[1], T);
}

/* Prints the range of the tensions that hold the net (form.prestress: exact) for each family of cables. */
static void print_prestress(const hf_scene *s, FILE *f)
{
    fputs("  prestress     exact; N:", f);
    for (int k = 0, n = 0; k < s->n_set + 2 && n < SETS_NAMED; k++) {
        double range[2] = {INFINITY, -INFINITY};
        for (int i = k < s->n_set ? s->set_start[k] : 0; k < s->n_set && i < s->set_start[k + 1]; i++)
            if (hf_prestress_family(s, s->set_cable[i]) == k) widen(s, s->set_cable[i], range);
        for (int e = 0; e < s->n_cable && k >= s->n_set; e++)
            if (s->group[e] == k - s->n_set && hf_prestress_family(s, e) == k) widen(s, e, range);
        if (!(range[0] <= range[1])) continue;
        fprintf(f, "%s %s %.4g .. %.4g", n++ ? "," : "", k < s->n_set ? s->set_name[k] : hf_group_word[k - s->n_set],
                range[0], range[1]);
        if (range[0] > 0) fprintf(f, " (ratio %.4g)", range[1] / range[0]);
    }
    fputc('\n', f);
}

static void print_scene(const hf_problem *p, FILE *f)
{
    const hf_model *m = &p->model;
    int count[3] = {0};
    for (int i = 0; i < m->n_node; i++)
        count[p->scene.role[i]]++;
    fprintf(f, "  scene         %d nodes: %d supports, %d inner (psi counts these), %d edge\n", m->n_node,
            count[HF_ROLE_SUPPORT], count[HF_ROLE_INNER], count[HF_ROLE_EDGE]);
    print_laws(m, f);
    print_sets(&p->scene, f);
    fprintf(f, "  equations     %d unknowns, three right-hand sides; half-bandwidth %d; %s\n", m->n_free,
            m->half_bandwidth,
            m->has_strut   ? "indefinite: band LU (dgbtrf)"
            : m->by_lapack ? "band Cholesky by LAPACK (dpbtrf)"
                           : "band Cholesky");
    if (m->n_chain) fprintf(f, "  note          %d straight chains of length-controlled cables\n", m->n_chain);
}

/* Prints the names of the load cases of the as-built net. */
static void print_load_cases(const hf_load_cases *s, FILE *f)
{
    fprintf(f, "                %d load case%s of the as-built net:", s->n, s->n == 1 ? "" : "s");
    for (int k = 0; k < s->n; k++)
        fprintf(f, "%s %s", k ? "," : "", s->load_case[k].name);
    fputc('\n', f);
}

/* Prints size and cost of the truss. The truss is built and condensed a second time to measure how long that takes. */
static hf_status print_truss(const hf_problem *p, FILE *f, hf_messages *messages)
{
    const hf_carrier *c = &p->carrier;
    hf_carrier again;
    char wall[32], matrix[32];
    double begin_s = hf_clock_s();
    hf_status status = hf_config_carrier(&p->settings, &p->scene, &again, messages);
    hf_print_duration(hf_clock_s() - begin_s, wall, sizeof wall);
    hf_carrier_free(&again);
    hf_print_bytes((double)c->frame.n_dof * (c->frame.half_bandwidth + 1) * sizeof(double), matrix, sizeof matrix);
    fprintf(f, "  truss         %d nodes, %d members; %.2f kg; %d attachments\n", c->truss.n_node, c->truss.n_member,
            c->mass_kg, c->n_attachment);
    fprintf(f, "                %d unknowns, half-bandwidth %d, %s; condition %.1e; built and condensed once in %s\n",
            c->frame.n_dof, c->frame.half_bandwidth, matrix, c->frame.condition, wall);
    return status;
}

/* Returns true if Levenberg-Marquardt runs, or may run. */
static bool refines(const hf_problem *p, const hf_evaluator *v)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    bool is_result = hf_optimiser_plan_of(o).ends_with_refine;
    bool is_wanted = is_result || o->refine != HF_REFINE_FALSE;
    return v && is_wanted && (is_result || !o->n_front) && hf_refine_applies(v);
}

/* Prints the objectives of a front by name. */
static void print_front(const hf_problem *p, FILE *f)
{
    char name[HF_OBJECTIVE_NAME_SIZE];
    fprintf(f, "                front of");
    for (int k = 0; k < p->objectives.n_objective; k++)
        fprintf(f, "%s %s",
                k == 0                              ? ""
                : k + 1 < p->objectives.n_objective ? ","
                                                    : " and",
                hf_objectives_name(&p->objectives, k, name));
    if (hf_optimiser_plan_of(&p->settings.optimize).ends_with_refine)
        fprintf(f, ": %d points, each by Levenberg-Marquardt\n", p->settings.optimize.front_points);
    else
        fprintf(f, ": that of the last generation\n");
}

static const char *set_or_all(const char *set)
{
    return *set ? set : "all";
}

/* Prints ", bounds 5 .. 12", or nothing if both sides are open. */
static void print_bounds(double lower, double upper, FILE *f)
{
    if (isfinite(lower) || isfinite(upper)) fprintf(f, ", bounds %g .. %g", lower, upper);
}

/* Prints the rows of optimize.variables with their numbers of design variables. */
static void print_variables(const hf_problem *p, FILE *f)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    const hf_model *m = &p->model;
    for (int row = 0; row < o->n_variable_row && m->variable; row++) {
        const hf_variable_settings *s = &o->variable_row[row];
        int n = 0, last = 0;
        for (int k = 0; k < m->n_variable; k++) {
            if (m->variable[k].setting != row) continue;
            last = k;
            n++;
        }
        const char *unit = hf_model_variable_unit(m, last);
        fprintf(f, "                variables.%d: %s of %s: %d in %s", row, hf_vary_word[s->vary], s->set, n, unit);
        if (!isnan(s->range_ratio)) fprintf(f, ", range %g %%", 100 * s->range_ratio);
        if (isnan(s->range_ratio) && !isnan(s->range)) fprintf(f, ", range %g", s->range);
        print_bounds(s->lower, s->upper, f);
        fputs(s->link == HF_LINK_SET ? ", as one\n" : "\n", f);
    }
}

/* Prints the as-built nets over which an objective is taken. */
static void print_nets(const hf_objective_settings *s, FILE *f)
{
    bool takes_all = hf_objective_takes_load_cases(s);
    if (*s->load_case && !takes_all) fprintf(f, ", in load case %s", s->load_case);
    if (!takes_all && s->over == HF_OVER_DESIGN) return;
    fprintf(f, " over %s, ", takes_all ? "all load cases" : hf_over_word[s->over]);
    if (s->quantile > 0)
        fprintf(f, "quantile %g", s->quantile);
    else
        fprintf(f, "%s", hf_take_word[s->take]);
}

/* Prints how many as-built nets are solved for each design. */
static void print_cost_of_nets(const hf_problem *p, FILE *f)
{
    const hf_objectives_nets *nets = p->objectives.nets;
    int n = 0, n_sample = 0;
    for (int i = 0; nets && i < nets->n_load_case + nets->n_sample; i++) {
        n += hf_objectives_are_over(&p->objectives, i);
        n_sample += i >= nets->n_load_case;
    }
    if (!nets) return;
    fprintf(f, "                each design is cut and solved as %d net%s as built", n, n == 1 ? "" : "s");
    if (n_sample)
        fprintf(f, ", %d of them samples, seed %llu", n_sample, (unsigned long long)p->settings.tolerance.seed);
    fputc('\n', f);
}

/* Prints objectives, limits and the cap on the boundary tension ratio, which also holds if the case does not set it. */
static void print_wishes(const hf_problem *p, FILE *f)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    char location[PATH_MAX];
    for (int k = 0; k < o->n_term && !o->n_front; k++) {
        const hf_objective_settings *s = &o->term[k];
        fprintf(f, "                objective.%d: %s", k, hf_figure_kind_word[s->figure]);
        if (p->objectives.objective[k].cable) fprintf(f, " of %s", set_or_all(s->set));
        if (!isnan(s->target)) fprintf(f, ", target %g", s->target);
        if (s->figure == HF_FIGURE_GAIN)
            fprintf(f, " at %g GHz",
                    (s->frequency_Hz > 0 ? s->frequency_Hz : hf_surface_highest_Hz(&p->surface)) / 1e9);
        print_nets(s, f);
        fprintf(f, ", weight %g\n", s->weight);
    }
    print_cost_of_nets(p, f);
    for (int k = 0; k < o->n_limit; k++) {
        const hf_limit_settings *s = &o->limit[k];
        fprintf(f, "                limits.%d: %s", k, hf_limit_word[s->figure]);
        if (s->figure != HF_LIMIT_DEFLECTION) fprintf(f, " of %s", set_or_all(s->set));
        print_bounds(s->lower, s->upper, f);
        fputc('\n', f);
    }
    bool is_given = hf_config_location(&p->settings, "optimize.boundary_ratio_cap", location, sizeof location);
    fprintf(f, "                boundary_ratio_cap %g%s\n", o->boundary_ratio_cap, is_given ? "" : " (the default)");
}

static void print_tolerance(const hf_case *c, FILE *f)
{
    const hf_tolerance_settings *t = &c->tolerance;
    const double sigma[] = {t->sigma_cut_m, t->sigma_cut_ratio, t->sigma_EA_ratio, t->sigma_support_m,
                            t->sigma_temperature_K};
    static const char *const of[][2] = {
        {"cuts", " m"}, {"cuts", " of the length"}, {"EA", " of it"}, {"supports", " m"}, {"temperature", " K"}};
    if (!c->has_tolerance) return;
    fprintf(f, "                as built: %d nets (%s numbers, %s errors, seed %llu)", t->samples,
            hf_sampling_word[t->sampling], hf_distribution_word[t->distribution], (unsigned long long)t->seed);
    int n = 0;
    for (int k = 0; k < (int)(sizeof sigma / sizeof *sigma); k++)
        if (sigma[k] > 0) fprintf(f, "%s %s %g%s", n++ ? "," : ";", of[k][0], sigma[k], of[k][1]);
    for (int k = 0; k < t->n_truss; k++)
        fprintf(f, "%s temperature of %s %g K", n++ ? "," : ";", hf_part_word[HF_PART_TRUSS + t->truss[k].part],
                t->truss[k].sigma_temperature_K);
    fprintf(f, "\n");
}

/* Prints the size of the sums of the far field at each frequency. */
static void print_pattern(const hf_problem *p, FILE *f)
{
    const hf_double_list *at = &p->surface.frequencies_Hz;
    const hf_pattern_surface theory = {&p->facets, p->scene.position_m, NULL};
    hf_feed feed;
    if (!p->surface.has_pattern) return;
    hf_feed_make(&p->surface, &p->facets, p->scene.position_m, &feed);
    for (int k = 0; k < at->n; k++) {
        hf_far_field plan;
        hf_pattern_plan(&p->surface.pattern, &theory, &feed, at->value[k], &plan);
        fprintf(f, "                far field at %g GHz: %ld points of quadrature by %d angles\n", at->value[k] / 1e9,
                plan.n_point, hf_pattern_angles(&plan));
    }
}

/* Prints what would run. v is NULL without an optimisation. */
static void print_plan(const hf_problem *p, const hf_evaluator *v, FILE *f)
{
    const hf_case *c = &p->settings;
    const hf_optimize_settings *o = &c->optimize;
    const char *why;
    hf_method method = hf_evaluate_method(&p->model, &c->form, &why);
    fprintf(f, "  will run      form-finding: %s, solved by %s (%s), stop: %s, at most %d iterations\n",
            hf_method_word[c->form.method], method == HF_METHOD_NEWTON ? "newton" : "fixed point", why,
            hf_stop_rule_word[c->form.stop], c->form.max_iterations);
    const hf_coupling_settings *coupling = &c->form.coupling;
    bool is_auto = coupling->scheme == HF_COUPLING_AUTO;
    if (p->model.n_attachment)
        fprintf(f, "                coupling with the truss: %s, tof %g m, at most %d form-findings%s\n",
                hf_coupling_scheme_word[is_auto ? HF_COUPLING_ACCELERATED : coupling->scheme], coupling->tof_m,
                coupling->max_iterations,
                is_auto && method == HF_METHOD_NEWTON ? "; in one matrix where they are slow" : "");
    bool optimizes = v != NULL, evolves = optimizes && hf_optimiser_plan_of(o).kind;
    if (evolves)
        fprintf(
            f,
            "                optimisation: rule %s, %d variables, %d individuals, at most %d generations, seed %llu\n",
            hf_rule_word[o->rule], p->model.n_variable, o->population, o->generations, (unsigned long long)o->seed);
    bool is_result = hf_optimiser_plan_of(o).ends_with_refine;
    bool is_front = optimizes && o->n_front > 0;
    if (is_front) print_front(p, f);
    if (optimizes) print_variables(p, f);
    if (optimizes) print_wishes(p, f);
    if (refines(p, v))
        fprintf(f, "                Levenberg-Marquardt: rule %s, at most %d iterations, %s\n", hf_rule_word[o->rule],
                o->refine_steps,
                is_front                      ? "for each point"
                : is_result                   ? "the result"
                : o->refine == HF_REFINE_AUTO ? "for comparison, where it is cheap"
                                              : "for comparison");
    if (optimizes && o->symmetry != HF_SYMMETRY_NONE)
        fprintf(f, "                symmetry: %s, %s; %d independent variables of %d\n", hf_symmetry_word[o->symmetry],
                hf_symmetry_planes_text(p->planes), p->model.n_leader, p->model.n_variable);
    if (p->load_cases.n) print_load_cases(&p->load_cases, f);
    print_tolerance(c, f);
    print_pattern(p, f);
    fprintf(f, "  skipped       %s%s%s%s%s\n",
            evolves           ? ""
            : optimizes       ? "genetic algorithm (method: lm); "
            : c->has_optimize ? "optimisation (no boundary cable has a free end); "
                              : "optimisation (no optimize section); ",
            p->load_cases.n ? "" : "load_cases (none given); ", c->has_truss ? "" : "truss (no truss section); ",
            p->model.load_N ? "" : "loads (none given); ", p->model.has_strut ? "" : "general band matrix (no struts)");
}

static void print_allocation(const char *title, const char *what, double bytes, const char *without, FILE *f)
{
    char text[32];
    hf_print_bytes(bytes, text, sizeof text);
    fprintf(f, "  %-13s %-38s %s\n", title, what, bytes > 0 ? text : without);
}

/* Returns the bytes that Levenberg-Marquardt needs: sensitivities (twice as many with a truss), residuals of the inner
 * nodes, matrices of its steps, and the packed Newton matrix. */
static double refine_bytes(const hf_problem *p, const hf_evaluator *v)
{
    const hf_model *m = &p->model;
    size_t lanes, matrix;
    if (!refines(p, v)) return 0;
    matrix = hf_chord_bytes(v, &lanes);
    double n = m->n_leader, column = 3.0 * m->n_free * (m->n_attachment ? 2 : 1) + 3.0 * m->n_inner_node;
    return 8 * n * (column + 4 * n) + (double)(matrix + lanes);
}

/* Computes the bytes that the evaluation of a population needs: `shared` once for all threads, `lanes` for each
 * thread. */
static hf_status engine_bytes(const hf_evaluator *v, size_t *shared, size_t *lanes)
{
    bool has_lanes;
    hf_solver solver = hf_batch_solver(v, &has_lanes);
    *shared = *lanes = 0;
    if (solver == HF_SOLVER_CHORD) {
        *shared = hf_chord_bytes(v, lanes);
    } else if (has_lanes) {
        hf_swarm_plan plan;
        HF_TRY(hf_swarm_plan_create(v->model, hf_lane_best_isa(), &plan));
        *lanes = hf_swarm_lanes_bytes(&plan);
        hf_arena_free(&plan.arena);
    }
    return HF_OK;
}

/* Prints the memory that a run would allocate. Items that it would not allocate are listed with the reason. */
static hf_status print_memory(const hf_problem *p, const hf_evaluator *v, int threads, FILE *f)
{
    const hf_model *m = &p->model;
    hf_model without = *m;
    without.has_newton = false;
    size_t lanes = 0, shared = 0;
    bool evolves = v && hf_optimiser_plan_of(&p->settings.optimize).kind;
    if (evolves) HF_TRY(engine_bytes(v, &shared, &lanes));
    double workspaces = v ? threads + 1 : 1, bare = (double)hf_workspace_bytes(&without);
    double population = evolves ? (double)p->settings.optimize.population : 0, variables = 8.0 * m->n_variable;
    double newton = (double)hf_workspace_bytes(m) - bare;
    const char *without_ga = v ? "none (no genetic algorithm)" : "none (no optimisation)";
    char what[64];
    if (v)
        snprintf(what, sizeof what, "workspaces (%d thread%s)", threads, threads == 1 ? "" : "s");
    else
        snprintf(what, sizeof what, "workspace");
    print_allocation("memory", what, workspaces * bare, "none", f);
    print_allocation("", "Newton matrices in them", workspaces * newton, "none (no law iterates, or struts)", f);
    print_allocation("", "matrix shared by all threads", (double)shared, evolves ? "none" : without_ga, f);
    print_allocation("", "lanes of designs", (double)lanes * threads, evolves ? "none" : without_ga, f);
    print_allocation("", "population", 2 * population * (variables + (double)sizeof(hf_form_result)), "none", f);
    print_allocation("", "sensitivities of Levenberg-Marquardt", refine_bytes(p, v), "none", f);
    if (evolves)
        print_allocation("result file", "generations, at most",
                         population * (variables + 70) * p->settings.optimize.generations, "", f);
    return HF_OK;
}

/* Evaluates the first generation in one thread and measures the time. The time printed for the whole optimisation is
 * that of one design, times the designs per thread, times the maximum number of generations. */
static hf_status print_ga_time(const hf_problem *p, const hf_evaluator *v, int threads, const hf_population *ga,
                               double *most_s, FILE *f)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    hf_batch batch = {0};
    hf_status status = hf_batch_create(v, 1, &batch);
    if (status == HF_OK) {
        char one[32], all[32];
        hf_solver solver = hf_batch_share(&batch, p->initial);
        double begin_s = hf_clock_s();
        hf_batch_run(&batch, ga->n_individual, ga->design, ga->pending, ga->result);
        double each_s = (hf_clock_s() - begin_s) / ga->n_individual;
        hf_print_duration(each_s, one, sizeof one);
        double all_s = hf_check_together_s(each_s, o->population, &threads) * o->generations;
        hf_print_duration(all_s, all, sizeof all);
        *most_s += all_s;
        fprintf(f, "                optimisation: %s for a design of the first generation by %s; at most about %s\n",
                one, hf_solver_word[solver], all);
    }
    hf_batch_free(&batch);
    return status;
}

/* Prints advice if a refinement takes long, or much memory. */
static void print_fewer(const hf_problem *p, const hf_evaluator *v, double all_s, FILE *f)
{
    if (all_s > LONG_S || refine_bytes(p, v) > LARGE_BYTES)
        fprintf(f,
                "                %d variables: its time grows with their cube, its memory with their square; fewer of "
                "them by link: symmetry or set, or by sets (optimize.variables)\n",
                p->model.n_leader);
}

/* Runs two steps of Levenberg-Marquardt from the initial design and prints the time of one. If counted operations
 * predict more time than that of a trial, nothing is run, and the prediction is printed. */
static hf_status print_refine_time(hf_problem *p, const hf_evaluator *v, const hf_population *ga, double *most_s,
                                   FILE *f)
{
    hf_refine_result r;
    char one[32], all[32];
    int n_point = p->settings.optimize.n_front > 0 ? p->settings.optimize.front_points : 1;
    double n_step = (double)p->settings.optimize.refine_steps * n_point;
    double begin_s = hf_clock_s(), foretold_s = hf_refine_operations(v) / OPERATIONS_PER_S;
    if (foretold_s > TRIAL_S) {
        hf_print_duration(foretold_s, one, sizeof one);
        hf_print_duration(foretold_s * n_step, all, sizeof all);
        fprintf(f,
                "                Levenberg-Marquardt: some %s an iteration, counted and not tried; at most about %s, "
                "mostly far less\n",
                one, all);
        print_fewer(p, v, foretold_s * n_step, f);
        *most_s += foretold_s * n_step;
        return HF_OK;
    }
    hf_status status = hf_refine_run(v, ga->lower, ga->upper, 2, NULL, NULL, p->initial, &p->workspace, &r);
    if (status == HF_NO_MEMORY) return status;
    if (status != HF_OK || r.iterations == 0) return HF_OK;
    double each_s = (hf_clock_s() - begin_s) / r.iterations;
    hf_print_duration(each_s, one, sizeof one);
    hf_print_duration(each_s * n_step, all, sizeof all);
    fprintf(f, "                Levenberg-Marquardt: %s an iteration; at most about %s, mostly far less\n", one, all);
    print_fewer(p, v, each_s * n_step, f);
    *most_s += each_s * n_step;
    return HF_OK;
}

static hf_status print_optimize_time(hf_problem *p, const hf_evaluator *v, int threads, double *most_s, FILE *f)
{
    const hf_optimiser_kind *kind = hf_optimiser_plan_of(&p->settings.optimize).kind;
    hf_optimiser o = {0};
    hf_status status = hf_optimiser_create(kind, &p->settings.optimize, &p->model, p->initial, &o);
    if (status == HF_OK && kind) status = print_ga_time(p, v, threads, &o.population, most_s, f);
    if (status == HF_OK && refines(p, v)) status = print_refine_time(p, v, &o.population, most_s, f);
    hf_optimiser_free(&o);
    return status;
}

/* Prints the time of the as-built samples, at the shape of form-finding. */
static void print_tolerance_time(const hf_problem *p, int threads, FILE *f)
{
    int n = p->settings.tolerance.samples;
    hf_tolerance_trial trial;
    char begin[32], one[32], all[32];
    if (!p->settings.has_tolerance || p->form.status != HF_OK) return;
    if (hf_tolerance_stage_try(p, &p->workspace, TRIAL_S, &trial) != HF_OK) return;
    hf_print_duration(trial.begin_s, begin, sizeof begin);
    hf_print_duration(trial.sample_s, one, sizeof one);
    int used = threads;
    hf_print_duration(trial.begin_s + hf_check_together_s(trial.sample_s, n, &used), all, sizeof all);
    if (trial.n_tried)
        fprintf(
            f,
            "                as built: %s a net (the first %d tried%s); with first order about %s for %d nets on %d "
            "thread%s\n",
            one, trial.n_tried, p->settings.has_surface ? ", best fits of the surface included" : "", all, n, used,
            used == 1 ? "" : "s");
    else
        fprintf(f, "                as built: first order some %s of processor time, counted; samples not tried\n",
                begin);
    if (!trial.scale_yields) return;
    fprintf(f, "                tolerance.required_yield: up to %d yields of %d nets more, most of them ended early",
            trial.scale_yields, trial.scale_samples);
    double each_s = trial.scale_s > 0 ? trial.scale_s / trial.scale_samples : trial.scale_sample_s * trial.scale_yields;
    hf_print_duration(hf_check_together_s(each_s, trial.scale_samples, &threads), all, sizeof all);
    if (trial.n_tried) fprintf(f, ": %s %s", trial.scale_s > 0 ? "some" : "with errors as they are at most about", all);
    fputc('\n', f);
}

/* Tries the form-finding: three iterations measure the time of one, then as many run as fit into TRIAL_S. Also prints
 * the times of the other stages. */
static hf_status print_time(hf_problem *p, const hf_evaluator *v, int threads, double *most_s, FILE *f,
                            hf_messages *messages)
{
    hf_form_settings form = p->settings.form;
    hf_form_result *r = &p->form;
    char text[32];
    form.max_iterations = form.max_iterations < 3 ? form.max_iterations : 3;
    double begin_s = hf_clock_s();
    hf_evaluate_form(&p->model, &form, &p->workspace, NULL, r);
    double iteration_s = (hf_clock_s() - begin_s) / r->iterations, affordable = TRIAL_S / iteration_s;
    form.max_iterations =
        affordable < p->settings.form.max_iterations ? (int)affordable + 1 : p->settings.form.max_iterations;
    begin_s = hf_clock_s();
    hf_evaluate_form(&p->model, &form, &p->workspace, NULL, r);
    *most_s = hf_clock_s() - begin_s;
    hf_print_duration(*most_s, text, sizeof text);
    if (r->status == HF_NOT_CONVERGED && form.max_iterations < p->settings.form.max_iterations) {
        *most_s = iteration_s * p->settings.form.max_iterations;
        hf_print_duration(*most_s, text, sizeof text);
        fprintf(f, "  expected time form-finding: not finished after %d iteration%s; at most %s\n", r->iterations,
                r->iterations == 1 ? "" : "s", text);
        return HF_OK;
    }
    fprintf(f, "  expected time form-finding: %s (", text);
    hf_print_iterations(r, f);
    fputs(")\n", f);
    if (r->coupling.iterations > 0)
        fprintf(f, "                coupling: the truss deflects by up to %.4f mm at the attachments\n",
                r->coupling.deflection_max_m * 1e3);
    HF_TRY(hf_problem_explain(p, messages));
    print_tolerance_time(p, threads, f);
    if (!v) return HF_OK;
    HF_TRY(hf_problem_base(p, messages));
    HF_TRY(hf_reach_check(p, messages));
    hf_problem_warn_of_refine(p, messages);
    hf_problem_warn_of_front(p, messages);
    if (print_optimize_time(p, v, threads, most_s, f) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory");
    return HF_OK;
}

static hf_status check(hf_problem *p, const hf_check_request *q, double *most_s, FILE *f, hf_messages *messages)
{
    HF_TRY(hf_problem_load(q->path, NULL, q->set, q->n_set, NULL, p, messages));
    HF_TRY(hf_tolerance_stage_check(p, false, messages));
    HF_TRY(hf_problem_allocate(p, messages));
    hf_evaluator evaluator = hf_problem_evaluator(p);
    const hf_evaluator *v = p->settings.has_optimize && p->model.n_variable > 0 ? &evaluator : NULL;
    hf_print_line(f, "%s: valid", q->name);
    print_scene(p, f);
    if (p->settings.form.prestress == HF_PRESTRESS_EXACT) print_prestress(&p->scene, f);
    if (p->settings.has_truss) HF_TRY(print_truss(p, f, messages));
    print_plan(p, v, f);
    if (print_memory(p, v, q->threads, f) != HF_OK) return hf_error(messages, HF_NO_MEMORY, "out of memory");
    return print_time(p, v, q->threads, most_s, f, messages);
}

hf_status hf_check_case(const hf_check_request *request, double *most_s, FILE *file, hf_messages *messages)
{
    static hf_problem p;
    p = (hf_problem){0};
    *most_s = 0;
    hf_status status = check(&p, request, most_s, file, messages);
    hf_problem_free(&p);
    return status;
}

/* Runs the command. Returns HF_OK, HF_BAD_CASE with all faults, the status of the trial if it finds the scene
 * ill-posed, or that of another failure. */
static hf_status command_check(const hf_options *options, FILE *file, hf_messages *messages)
{
    double most_s;
    hf_check_request request = {.path = options->file,
                                .name = options->file,
                                .set = options->set,
                                .n_set = options->n_set,
                                .threads = options->threads ? options->threads : hf_batch_default_threads()};
    if (hf_study_is(options->file)) return hf_check_study(&request, file, messages);
    return hf_check_case(&request, &most_s, file, messages);
}

const hf_command hf_cmd_check = {
    .name = "check",
    .argument = "CASE",
    .help = "validate; print what will run, what is skipped, sizes, memory and expected time; of a study its points",
    .about = "The form-finding is tried, the optimisation is not, and nothing is written. All errors of the case are "
             "told in one go, with file, line and column.\n"
             "Of a study: axes, the number of points, the first and the last of them, what is done already; the nets "
             "of the points are made, and the first point is checked as a case is.",
    .examples = "hifdm check case.yaml --threads 64\n"
                "hifdm check study.yaml",
    .uses_threads = true,
    .run = command_check,
};
