/* `hifdm check` reports whether a case is valid, and what a run of it would do: the solvers, the memory and about how
 * long it takes.
 *
 *     study -> make the nets of as many points as time allows -> axes, points, results so far -> check of one point
 *
 * Sections: a case, a study. */
#include "app/options.h"
#include "app/study_files.h"
#include "base/clock.h"
#include "base/text.h"
#include "net/symmetry.h"
#include "out/print.h"
#include "out/print_summary.h"
#include "run/check.h"
#include "run/problem_nets.h"

#include <limits.h>
#include <math.h>
#include <string.h>

/* ---- a case ---- */

/* Prints how many cables obey each law. The three laws of the paper are always listed, the others only if a cable has
 * them. */
static void print_laws(const hf_check *c, FILE *f)
{
    fprintf(f, "                %d cables by law in force:", c->problem.model.n_cable);
    for (int law = 0; law < HF_N_LAW; law++) {
        if (law > HF_LAW_FORCE_DENSITY && c->n_law[law] == 0) continue;
        fprintf(f, "%s %d ", law ? "," : "", c->n_law[law]);
        for (const char *word = hf_law_word[law]; *word; word++)
            fputc(*word == '_' ? ' ' : *word, f);
        if (law == HF_LAW_FORCE_DENSITY && c->problem.model.has_strut) fputs(" (with struts)", f);
    }
    fputc('\n', f);
}

#define POINTS_TIMED 5 /* maximum number of points of a study whose stages are tried */
#define TIMING_S 5.0   /* time after which no further point is tried */
#define SETS_NAMED 12

/* Prints how many cables are in each set, the groups first. */
static void print_sets(const hf_check *c, FILE *f)
{
    const hf_scene *s = &c->problem.scene;
    fprintf(f, "                sets: %d %s, %d %s", c->n_group[0], hf_group_word[0], c->n_group[1], hf_group_word[1]);
    for (int k = 0; k < s->n_set && k < SETS_NAMED; k++)
        fprintf(f, ", %d %s", s->set_start[k + 1] - s->set_start[k], s->set_name[k]);
    if (s->n_set > SETS_NAMED) fprintf(f, " and %d more sets", s->n_set - SETS_NAMED);
    fputc('\n', f);
}

/* Prints the range of the tensions that hold the net (form.prestress: exact) for each family of cables. */
static void print_prestress(const hf_check *c, FILE *f)
{
    fputs("  prestress     exact; N:", f);
    for (const hf_check_family *k = c->family; k < c->family + c->n_family; k++) {
        fprintf(f, "%s %s %.4g .. %.4g", k > c->family ? "," : "", k->name, k->lower_N, k->upper_N);
        if (k->lower_N > 0) fprintf(f, " (ratio %.4g)", k->upper_N / k->lower_N);
    }
    fputc('\n', f);
}

static void print_scene(const hf_check *c, FILE *f)
{
    const hf_model *m = &c->problem.model;
    fprintf(f, "  scene         %d nodes: %d supports, %d inner (psi counts these), %d edge\n", m->n_node,
            c->n_role[HF_ROLE_SUPPORT], c->n_role[HF_ROLE_INNER], c->n_role[HF_ROLE_EDGE]);
    print_laws(c, f);
    print_sets(c, f);
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

/* Prints size and cost of the truss. */
static void print_truss(const hf_check *check, FILE *f)
{
    const hf_carrier *c = &check->problem.carrier;
    fprintf(f, "  truss         %d nodes, %d members; %.2f kg; %d attachments\n", c->truss.n_node, c->truss.n_member,
            c->mass_kg, c->n_attachment);
    fprintf(f, "                %d unknowns, half-bandwidth %d, %s; condition %.1e; built and condensed once in %s\n",
            c->frame.n_dof, c->frame.half_bandwidth,
            hf_print_bytes((double)c->frame.n_dof * (c->frame.half_bandwidth + 1) * sizeof(double)).text,
            c->frame.condition, hf_print_duration(check->truss_s).text);
}

/* Prints the objectives of a front by name. */
static void print_front(const hf_check *c, FILE *f)
{
    const hf_problem *p = &c->problem;
    char name[HF_OBJECTIVE_NAME_SIZE];
    fprintf(f, "                front of");
    for (int k = 0; k < p->objectives.n_objective; k++)
        fprintf(f, "%s %s",
                k == 0                              ? ""
                : k + 1 < p->objectives.n_objective ? ","
                                                    : " and",
                hf_objectives_name(&p->objectives, k, name));
    if (c->is_refine_result)
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
static void print_variables(const hf_check *c, FILE *f)
{
    const hf_optimize_settings *o = &c->problem.settings.optimize;
    for (int row = 0; row < o->n_variable_row && c->problem.model.variable; row++) {
        const hf_variable_settings *s = &o->variable_row[row];
        fprintf(f, "                variables.%d: %s of %s: %d in %s", row, hf_vary_word[s->vary], s->set,
                c->n_in_row[row], c->unit_of_row[row]);
        if (!isnan(s->range_ratio)) fprintf(f, ", range %g %%", 100 * s->range_ratio);
        if (isnan(s->range_ratio) && !isnan(s->range)) fprintf(f, ", range %g", s->range);
        print_bounds(s->lower, s->upper, f);
        fputs(s->link == HF_LINK_SET ? ", as one\n" : s->link == HF_LINK_SCALE ? ", by one factor\n" : "\n", f);
    }
}

/* Prints the as-built nets over which an objective is taken. */
static void print_nets(const hf_objective_settings *s, FILE *f)
{
    bool takes_all = hf_objective_takes_load_cases(s), takes_samples = s->over == HF_OVER_SAMPLES;
    if (*s->load_case && !takes_all) fprintf(f, ", in load case %s", s->load_case);
    if (!takes_all && !takes_samples) return;
    fprintf(f, " over %s%s%s, ", takes_all ? "all load cases" : "", takes_all && takes_samples ? " of " : "",
            takes_samples ? hf_over_word[s->over] : "");
    if (s->quantile > 0)
        fprintf(f, "quantile %g", s->quantile);
    else
        fprintf(f, "%s", hf_take_word[s->take]);
}

/* Prints how many as-built nets are solved for each design. */
static void print_cost_of_nets(const hf_check *c, FILE *f)
{
    if (!c->problem.objectives.nets) return;
    fprintf(f, "                each design is cut and solved as %d net%s as built", c->n_net,
            c->n_net == 1 ? "" : "s");
    if (c->n_sample)
        fprintf(f, ", %d of them from %d samples, seed %llu", c->n_sample, c->problem.objectives.nets->n_sample,
                (unsigned long long)c->problem.settings.tolerance.seed);
    fputc('\n', f);
}

/* Prints how many rows of `requirements` constrain the optimisation, and which do not. */
static void print_constraints(const hf_problem *p, FILE *f)
{
    const hf_case *c = &p->settings;
    char others[HF_REQUIREMENT_ROWS_MAX * 64] = "", reason[64];
    int n = 0;
    for (int i = 0; i < c->n_requirement; i++) {
        const hf_requirement_settings *r = &c->requirement[i];
        bool is_constraint = hf_problem_is_constrained_by(p, i);
        n += is_constraint;
        if (is_constraint) continue;
        snprintf(reason, sizeof reason, "requirements.%d (%s)", i,
                 r->search == HF_SEARCH_OFF       ? "search: off"
                 : r->figure == HF_REQUIRED_SLACK ? "slack_cables without at_most"
                                                  : "loose_nodes never constrains");
        hf_text_append(others, sizeof others, ", ", reason, "");
    }
    if (c->n_requirement)
        fprintf(f, "                requirements: %d of %d row%s the optimisation%s%s\n", n, c->n_requirement,
                c->n_requirement == 1 ? " constrains" : "s constrain", *others ? "; not " : "", others);
}

/* Prints objectives, limits and the cap on the boundary tension ratio, which also holds if the case does not set it. */
static void print_wishes(const hf_check *c, FILE *f)
{
    const hf_problem *p = &c->problem;
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
    print_cost_of_nets(c, f);
    for (int k = 0; k < o->n_limit; k++) {
        const hf_limit_settings *s = &o->limit[k];
        fprintf(f, "                limits.%d: %s", k, hf_limit_word[s->figure]);
        if (s->figure != HF_LIMIT_DEFLECTION) fprintf(f, " of %s", set_or_all(s->set));
        print_bounds(s->lower, s->upper, f);
        fputc('\n', f);
    }
    print_constraints(p, f);
    bool is_given = hf_config_location(&p->settings, "optimize.boundary_ratio_cap", location, sizeof location);
    fprintf(f, "                boundary_ratio_cap %g%s\n", o->boundary_ratio_cap, is_given ? "" : " (the default)");
}

static void print_tolerance(const hf_case *c, FILE *f)
{
    const hf_tolerance_settings *t = &c->tolerance;
    const double sigma[] = {t->sigma_cut_m,         t->sigma_cut_ratio,     t->sigma_EA_ratio,
                            t->sigma_support_m,     t->sigma_temperature_K, t->sigma_load_case_temperature_K,
                            t->sigma_gravity_ratio, t->sigma_force_ratio};
    static const char *const of[][2] = {
        {"cuts", " m"},        {"cuts", " of the length"},          {"EA", " of it"},      {"supports", " m"},
        {"temperature", " K"}, {"temperature of load cases", " K"}, {"gravity", " of it"}, {"forces", " of them"}};
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
static void print_pattern(const hf_check *c, FILE *f)
{
    const hf_double_list *at = &c->problem.surface.frequencies_Hz;
    for (int k = 0; k < at->n && c->problem.surface.has_pattern; k++)
        fprintf(f, "                far field at %g GHz: %ld points of quadrature by %d angles\n", at->value[k] / 1e9,
                c->far_field[k].n_point, c->far_field[k].n_angle);
}

/* Prints how the optimisation runs. */
static void print_optimisation(const hf_check *c, FILE *f)
{
    const hf_problem *p = &c->problem;
    const hf_optimize_settings *o = &p->settings.optimize;
    if (!c->optimizes) return;
    if (c->evolves)
        fprintf(
            f,
            "                optimisation: rule %s, %d variables, %d individuals, at most %d generation%s, seed %llu\n",
            hf_rule_word[o->rule], p->model.n_variable, o->population, o->generations, o->generations == 1 ? "" : "s",
            (unsigned long long)o->seed);
    if (o->n_front) print_front(c, f);
    print_variables(c, f);
    print_wishes(c, f);
    if (c->refines)
        fprintf(f, "                Levenberg-Marquardt: rule %s, at most %d steps, %s\n", hf_rule_word[o->rule],
                o->refine_steps,
                o->n_front                      ? "for each point"
                : o->method == HF_OPTIMIZE_AUTO ? "from up to four starts; the best design is the result"
                : !c->evolves                   ? "the result"
                : c->is_refine_result || o->refine == HF_REFINE_TRUE
                    ? "the better design is the result"
                    : "where it is cheap; the better design is the result");
    if (o->symmetry != HF_SYMMETRY_NONE)
        fprintf(f, "                symmetry: %s, %s; %d independent variables of %d\n", hf_symmetry_word[o->symmetry],
                hf_symmetry_planes_text(p->planes), p->model.n_leader, p->model.n_variable);
}

/* Prints what would run. */
static void print_plan(const hf_check *check, FILE *f)
{
    const hf_problem *p = &check->problem;
    const hf_case *c = &p->settings;
    bool is_newton = check->method == HF_METHOD_NEWTON;
    fprintf(f, "  will run      form-finding: %s, solved by %s (%s), stop: %s, at most %d iterations\n",
            hf_method_word[c->form.method], is_newton ? "newton" : "fixed point", check->method_reason,
            hf_stop_rule_word[c->form.stop], c->form.max_iterations);
    const hf_coupling_settings *coupling = &c->form.coupling;
    bool is_auto = coupling->scheme == HF_COUPLING_AUTO;
    if (p->model.n_attachment)
        fprintf(f, "                coupling with the truss: %s, tof %g m, at most %d form-findings%s\n",
                hf_coupling_scheme_word[is_auto ? HF_COUPLING_ACCELERATED : coupling->scheme], coupling->tof_m,
                coupling->max_iterations, is_auto && is_newton ? "; in one matrix where they are slow" : "");
    print_optimisation(check, f);
    if (p->load_cases.n) print_load_cases(&p->load_cases, f);
    print_tolerance(c, f);
    print_pattern(check, f);
    fprintf(f, "  skipped       %s%s%s%s%s\n",
            check->evolves     ? ""
            : check->optimizes ? "genetic algorithm (method: lm); "
            : c->has_optimize  ? "optimisation (no boundary cable has a free end); "
                               : "optimisation (no optimize section); ",
            p->load_cases.n ? "" : "load_cases (none given); ", c->has_truss ? "" : "truss (no truss section); ",
            p->model.load_N ? "" : "loads (none given); ", p->model.has_strut ? "" : "general band matrix (no struts)");
}

static void print_allocation(const char *title, const char *what, double bytes, const char *without, FILE *f)
{
    fprintf(f, "  %-13s %-38s %s\n", title, what, bytes > 0 ? hf_print_bytes(bytes).text : without);
}

/* Prints the memory that a run would allocate. Items that it would not allocate are listed with the reason. */
static void print_memory(const hf_check *c, FILE *f)
{
    const hf_check_memory *m = &c->memory;
    const char *without = c->evolves ? "none" : c->optimizes ? "none (no genetic algorithm)" : "none (no optimisation)";
    char what[64] = "workspace";
    if (c->optimizes) snprintf(what, sizeof what, "workspaces (%d thread%s)", c->threads, c->threads == 1 ? "" : "s");
    print_allocation("memory", what, m->workspaces, "none", f);
    print_allocation("", "Newton matrices in them", m->newton, "none (no law iterates, or struts)", f);
    print_allocation("", "matrix shared by all threads", m->shared, without, f);
    print_allocation("", "lanes of designs", m->lanes, without, f);
    print_allocation("", "population", m->population, "none", f);
    print_allocation("", "sensitivities of Levenberg-Marquardt", m->refine, "none", f);
    if (c->evolves) print_allocation("result file", "generations, at most", m->generations, "", f);
}

static void print_form_time(const hf_check *c, FILE *f)
{
    const hf_form_result *r = &c->problem.form;
    if (!c->is_form_finished) {
        fprintf(f, "  expected time form-finding: not finished after %d iteration%s; at most %s\n", r->iterations,
                r->iterations == 1 ? "" : "s", hf_print_duration(c->form_s).text);
        return;
    }
    fprintf(f, "  expected time form-finding: %s (", hf_print_duration(c->form_s).text);
    hf_print_iterations(r, f);
    fputs(")\n", f);
    if (r->coupling.iterations > 0)
        fprintf(f, "                coupling: the truss deflects by up to %.4f mm at the attachments\n",
                r->coupling.deflection_max_m * 1e3);
}

/* Prints the time of the as-built samples. */
static void print_tolerance_time(const hf_check *c, FILE *f)
{
    const hf_tolerance_trial *t = &c->tolerance;
    char states[48] = "";
    if (!c->has_tolerance) return;
    if (t->n_load_case) snprintf(states, sizeof states, " in %d load cases", 1 + t->n_load_case);
    if (t->n_tried)
        fprintf(
            f,
            "                as built: %s a net%s (the first %d tried%s); with first order about %s for %d nets on %d "
            "thread%s\n",
            hf_print_duration(t->sample_s).text, states, t->n_tried,
            c->problem.settings.has_surface ? ", best fits of the surface included" : "",
            hf_print_duration(c->tolerance_s).text, c->problem.settings.tolerance.samples, c->tolerance_threads,
            c->tolerance_threads == 1 ? "" : "s");
    else
        fprintf(f, "                as built: first order some %s of processor time, counted; samples not tried\n",
                hf_print_duration(t->begin_s).text);
    if (c->n_judged)
        fprintf(f, "                verdicts of up to %d points of the front by samples: about %s\n", c->n_judged,
                hf_print_duration(c->judged_s).text);
    if (!t->scale_yields) return;
    fprintf(f, "                tolerance.find_scale: up to %d yields of %d nets more, most of them ended early",
            t->scale_yields, t->scale_samples);
    if (t->n_tried)
        fprintf(f, ": %s %s", t->scale_s > 0 ? "some" : "with errors as they are at most about",
                hf_print_duration(c->yields_s).text);
    fputc('\n', f);
}

static void print_refine_time(const hf_check *c, FILE *f)
{
    const hf_optimize_settings *o = &c->problem.settings.optimize;
    char points[32] = "";
    if (o->n_front) snprintf(points, sizeof points, " for each of %d points", o->front_points);
    fprintf(f, "                Levenberg-Marquardt: %s%s a step%s; about %s for %s%d step%s%s (at most %d)\n",
            c->is_step_tried ? "" : "some ", hf_print_duration(c->step_s).text,
            c->is_step_tried ? "" : ", counted and not tried", hf_print_duration(c->refine_s).text,
            c->is_refine_tried ? "" : "some ", c->n_step, c->n_step == 1 ? "" : "s", points, o->refine_steps);
    if (c->advises_fewer)
        fprintf(f,
                "                %d variables: its time grows with their cube, its memory with their square; fewer of "
                "them by link: symmetry or set, or by sets (optimize.variables)\n",
                c->problem.model.n_leader);
}

/* Checks and tries a case, and prints what it finds. *c must be zero on entry. Returns HF_OK, HF_BAD_CASE with all
 * faults, the status of an ill-posed scene, or that of another failure. Free c->problem in any case. */
static hf_status check_case(const hf_check_request *request, const char *name, hf_check *c, FILE *f,
                            hf_messages *messages)
{
    const hf_case *settings = &c->problem.settings;
    HF_TRY(hf_check_load(request, c, messages));
    hf_status status = hf_check_try(c, messages);
    hf_print_line(f, status == HF_OK ? "%s: valid" : "%s: the case file has no faults, but a run of it would fail",
                  name);
    print_scene(c, f);
    if (settings->form.prestress == HF_PRESTRESS_EXACT) print_prestress(c, f);
    if (settings->has_truss) print_truss(c, f);
    print_plan(c, f);
    print_memory(c, f);
    print_form_time(c, f);
    if (!isnan(c->load_cases_s))
        fprintf(f, "                load cases: %s\n", hf_print_duration(c->load_cases_s).text);
    print_tolerance_time(c, f);
    if (!isnan(c->design_s))
        fprintf(f, "                optimisation: %s for a design of the first generation by %s; at most about %s\n",
                hf_print_duration(c->design_s).text, hf_solver_word[c->solver], hf_print_duration(c->search_s).text);
    if (!isnan(c->step_s)) print_refine_time(c, f);
    return status;
}

/* ---- a study ---- */

#define VALUES_TOLD 6 /* maximum number of values that are listed for an axis; else the first and the last */

static void print_axes(const hf_study *s, FILE *f)
{
    for (int a = 0; a < s->n_axis; a++) {
        const hf_study_axis *axis = &s->axis[a];
        char text[1024] = "";
        for (int k = 0; k < axis->n_value && axis->n_value <= VALUES_TOLD; k++)
            hf_text_append(text, sizeof text, ", ", hf_study_axis_value(axis, k), "");
        if (axis->n_value > VALUES_TOLD)
            snprintf(text, sizeof text, "%d values%s, %s .. %s", axis->n_value, axis->is_sampled ? ", sampled" : "",
                     hf_study_axis_value(axis, 0), hf_study_axis_value(axis, axis->n_value - 1));
        hf_text_trim_utf8(text);
        hf_print_line(f, "  %-13s %s: %s%s%s", a ? "" : "axes", axis->key.path, text, *axis->key.field->unit ? " " : "",
                      axis->key.field->unit);
    }
}

static void print_points(const hf_study *s, FILE *f)
{
    char text[512];
    hf_print_line(f, "  %-13s %d%s%s", "points", s->n_point, s->is_zip ? ", the axes side by side" : "",
                  s->derives_seed ? ", each with a seed of its own" : "");
    for (int is_last = 0; is_last < 2; is_last++) {
        int i = is_last ? s->n_point - 1 : 0;
        hf_study_point_text(s, i, text, sizeof text);
        hf_print_line(f, "  %-13s %s %s: %s", "", is_last ? "last " : "first", s->id[i], text);
    }
}

/* Prints the number of points in each state, from the folder of the results. */
static hf_status print_done(const hf_study *s, int count[HF_N_POINT_STATE], FILE *f, hf_messages *messages)
{
    char folder[HF_PATH_SIZE];
    hf_points points = {0};
    HF_TRY(hf_study_files_name(NULL, s->path, ".d", folder, messages));
    hf_status status = hf_ledger_read(folder, s, &points, messages);
    if (status == HF_OK) {
        memcpy(count, points.count, sizeof points.count);
        hf_print_line(f, "  %-13s in %s, %s: %d done, %d failed, %d running, %d to run", "results", folder,
                      hf_study_has_files(s) ? "a file for each point" : "a row for each point and no files",
                      count[HF_POINT_DONE], count[HF_POINT_FAILED], count[HF_POINT_RUNNING], count[HF_POINT_MISSING]);
        if (count[HF_POINT_OUTDATED])
            hf_print_line(f, "  %-13s %d outdated: of another version of %s", "", count[HF_POINT_OUTDATED], s->base);
    }
    hf_points_free(&points);
    return status;
}

/* Finds the mean time of the first point and of others that are spread over the study. Points with slack cables, for
 * example, take longer. */
static double time_points(const hf_study *s, int i_first, double first_s)
{
    static hf_check other; /* too large for a small stack */
    double mean_s = first_s;
    int n = 1;
    double end_s = hf_clock_s() + TIMING_S;
    for (int k = 0; k < s->n_point && n < POINTS_TIMED && hf_clock_s() < end_s; k++) {
        int i = hf_study_spread(s, k);
        hf_study_overrides o;
        hf_messages unread = {0};
        if (i == i_first) continue;
        hf_study_point_overrides(s, i, &o);
        const hf_check_request request = {.path = s->base, .set = o.set, .n_set = o.n_set, .threads = 1};
        other = (hf_check){0};
        if (hf_check_load(&request, &other, &unread) == HF_OK && hf_check_try(&other, &unread) == HF_OK)
            mean_s += (other.at_most_s - mean_s) / ++n;
        hf_problem_free(&other.problem);
        hf_messages_free(&unread);
    }
    return mean_s;
}

static void print_time(int n, const char *what, double each_s, int threads, FILE *f)
{
    double all_s = hf_check_together_s(each_s, n, &threads);
    fprintf(f, "%d point%s to run%s, each at most some %s on average, on %d thread%s: at most about %s\n", n,
            n == 1 ? "" : "s", what, hf_print_duration(each_s).text, threads, threads == 1 ? "" : "s",
            hf_print_duration(all_s).text);
}

/* Prints what a sweep runs by default, and what it runs again with --retry. */
static void print_left(const hf_study *s, const int count[HF_N_POINT_STATE], double each_s, int threads, FILE *f)
{
    static const hf_point_state other[] = {HF_POINT_FAILED, HF_POINT_OUTDATED, HF_POINT_RUNNING};
    int n_missing = count[HF_POINT_MISSING], n_anew = count[HF_POINT_FAILED] + count[HF_POINT_OUTDATED];
    char others[128] = "", retry[64] = "", item[32];
    if (n_missing) print_time(n_missing, "", each_s, threads, f);
    if (n_missing && n_anew) strcpy(retry, hf_point_state_word[0]);
    for (size_t k = 0; k < sizeof other / sizeof *other; k++) {
        const char *word = hf_point_state_word[other[k]];
        if (!count[other[k]]) continue;
        snprintf(item, sizeof item, "%d %s", count[other[k]], word);
        hf_text_append(others, sizeof others, ", ", item, "");
        if (other[k] != HF_POINT_RUNNING) hf_text_append(retry, sizeof retry, ",", word, "");
    }
    if (n_anew)
        hf_print_line(f, "%s%s: `hifdm sweep %s --retry %s`%s", n_missing ? "" : "nothing is missing; ", others,
                      s->path, retry, n_missing ? " runs these, too" : "");
    else if (!n_missing && *others)
        hf_print_line(f, "nothing is missing; %s", others);
    else if (!n_missing)
        fprintf(f, "all points have been run\n");
    if (!n_missing && n_anew) print_time(n_anew, " anew", each_s, threads, f);
}

static hf_status check_points(const hf_check_request *request, const hf_study *s, hf_check *check, FILE *f,
                              hf_messages *messages)
{
    char text[512];
    hf_study_overrides o;
    int count[HF_N_POINT_STATE] = {0};
    hf_check_points t;
    HF_TRY(hf_check_study_points(s, &check->problem, &t, messages));
    hf_print_line(f, t.n_fault ? "%s: the study has no faults, but some of its points cannot be run" : "%s: valid",
                  request->path);
    if (*s->title) hf_print_line(f, "  %-13s %s", "study", s->title);
    hf_print_line(f, "  %-13s %s", "base case", s->base);
    print_axes(s, f);
    print_points(s, f);
    if (t.n_tried < s->n_point) fprintf(f, "  %-13s the nets of %d of them were made\n", "", t.n_tried);
    if (t.n_fault) fprintf(f, "  %-13s %d of these cannot be run\n", "", t.n_fault);
    HF_TRY(print_done(s, count, f, messages));
    hf_study_point_overrides(s, t.first, &o);
    snprintf(text, sizeof text, t.first ? "point %s" : "the first point, %s", s->id[t.first]);
    const hf_check_request first = {.path = s->base, .set = o.set, .n_set = o.n_set, .threads = 1};
    hf_status status = check_case(&first, text, check, f, messages);
    bool has_more = count[HF_POINT_MISSING] + count[HF_POINT_FAILED] + count[HF_POINT_OUTDATED] > 0;
    double each_s = has_more ? time_points(s, t.first, check->at_most_s) : 0;
    print_left(s, count, each_s, request->threads, f);
    if (status != HF_OK || t.n_fault == 0) return status;
    return hf_error(messages, HF_POINTS_FAILED,
                    "%s: sweep: %d of the %d tested points cannot be run. A sweep counts points that cannot be run as "
                    "failed, and runs all other points",
                    s->path, t.n_fault, t.n_tried);
}

/* Checks a study; request->n_set must be 0. *check must be zero on entry, and receives the check of its first point.
 * Returns HF_OK, HF_BAD_USAGE, HF_BAD_CASE with all faults of study, base case and points, or HF_POINTS_FAILED if some
 * points cannot be run. Free check->problem in any case. */
static hf_status check_study(const hf_check_request *request, hf_check *check, FILE *f, hf_messages *messages)
{
    static hf_study study;
    if (request->n_set)
        return hf_error(messages, HF_BAD_USAGE,
                        "%s: the --set option does not work with a study. Change the base case or an axis of the study",
                        request->path);
    hf_status status = hf_study_read(request->path, &study, messages);
    if (status == HF_OK) status = check_points(request, &study, check, f, messages);
    hf_study_free(&study);
    return status;
}

/* Runs the command. Returns HF_OK, HF_BAD_CASE with all faults, the status of the trial if it finds the scene
 * ill-posed, or that of another failure. */
static hf_status command_check(const hf_options *o, FILE *file, hf_messages *messages)
{
    static hf_check check; /* too large for a small stack */
    const hf_check_request request = {.path = o->file,
                                      .set = o->set,
                                      .n_set = o->n_set,
                                      .threads = o->threads ? o->threads : hf_batch_default_threads()};
    hf_status status = hf_study_is(o->file) ? check_study(&request, &check, file, messages)
                                            : check_case(&request, o->file, &check, file, messages);
    hf_problem_free(&check.problem);
    return status;
}

const hf_command hf_cmd_check = {
    .name = "check",
    .argument = "CASE",
    .help = "check a case or a study, and print its stages, problem sizes, memory and run time",
    .about =
        "hifdm check runs the form-finding but not the optimisation. The command writes no files. hifdm check "
        "reports all errors of the case at once, each with its file, line and column.\nFor a study, hifdm check "
        "prints the axes, the number of points, the first and last points, and the finished points. hifdm check builds "
        "the nets of as many points as time allows. hifdm check fully checks the first point that can be run.",
    .examples = "hifdm check case.yaml --threads 64\n"
                "hifdm check study.yaml",
    .uses_threads = true,
    .run = command_check,
};
