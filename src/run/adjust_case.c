/* Finds the turnbuckle adjustments of a case. adjust_case.h describes the interface.
 *
 *      case, design -> as-built net -> prior of the errors -> estimate from measured positions -> adjustments -> what
 *      else the measured net shows -> the adjusted net in other load cases
 *
 * Contents: chi^2 - outliers - other aims - the prior - estimate - figure measured - load cases - interface */
#include "run/adjust_case.h"

#include "base/arena.h"
#include "base/text.h"
#include "case/config_fault.h"
#include "net/cable_pick.h"
#include "run/load_case_stage.h"
#include "run/requirements_stage.h"
#include "solve/limits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Above this chi^2 per coordinate, the measurement is of another net: the sigmas would have to be ten times larger. */
#define FOREIGN 100.0
#define ROUNDING 0.005 /* relative rounding of numbers in messages */
/* The minimum sigma, as a part of the sigma of the errors: weights above 1e9 times theirs exceed double precision. */
#define SIGMA_LEAST 3e-5
#define MISFIT 5.0 /* standard deviations above which a sum of squares is not due to chance */
#define TOLD 0.05  /* a smaller part of an error is not reported, because it may be rounding */

typedef hf_adjust_case job;

/* ---- chi^2 ---- */

double hf_adjust_case_chi_square(const hf_adjust_case *j)
{
    return 2 * j->estimate.misfit / (3.0 * j->measured.n_node);
}

bool hf_adjust_case_fits(const hf_adjust_case *j)
{
    return hf_adjust_case_chi_square(j) <= 1 + MISFIT * sqrt(2 / (3.0 * j->measured.n_node));
}

/* ---- outliers ---- */

/* Compares two items for qsort: in descending order of size, and equal ones by their index. */
static int by_size(const void *a, const void *b)
{
    const hf_adjust_case_sized *p = a, *q = b;
    if (p->size != q->size) return p->size > q->size ? -1 : 1;
    return p->at < q->at ? -1 : p->at > q->at;
}

/* Sorts the n items of the scratch list into `at`, the largest first. */
static void sort(const hf_adjust_case *j, int n, int *at)
{
    qsort(j->sized, (size_t)n, sizeof *j->sized, by_size);
    for (int k = 0; k < n; k++)
        at[k] = j->sized[k].at;
}

double hf_adjust_case_sigmas(const hf_adjust_case *j, int e)
{
    return j->prior.sigma_m[e] > 0 ? j->estimate.cut_m[e] / j->prior.sigma_m[e] : 0;
}

double hf_adjust_case_off_m(const hf_adjust_case *j, int row)
{
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double d = j->measured.position_m[3 * row + c] - j->estimate.work.position_m[c * j->net->model.n_node + row];
        square += d * d;
    }
    return sqrt(square);
}

double hf_adjust_case_off_sigmas(const hf_adjust_case *j, int row)
{
    return hf_adjust_case_off_m(j, row) * sqrt(j->measured.weight_per_m2[3 * row]);
}

/* Lists the measured nodes that are far from the estimated shape. Returns the row of the node that is farthest in parts
 * of its sigma. */
static int find_places(hf_adjust_case *j)
{
    double most = -1;
    int worst = 0;
    j->n_far = 0;
    for (int row = 0; row < j->net->model.n_node; row++) {
        if (!j->measured.line[row]) continue;
        double off = hf_adjust_case_off_sigmas(j, row);
        if (off > HF_ADJUST_CASE_OFF) j->sized[j->n_far++] = (hf_adjust_case_sized){off, row};
        if (off <= most) continue;
        most = off;
        worst = row;
    }
    sort(j, j->n_far, j->far_row);
    return worst;
}

/* Lists the cables whose errors stand out, after the estimate. Returns HF_OK, HF_SINGULAR or HF_NO_MEMORY. */
static hf_status find_cables(hf_adjust_case *j)
{
    j->n_out = 0;
    for (int e = 0; e < j->net->model.n_cable; e++) {
        double size = fabs(hf_adjust_case_sigmas(j, e));
        /* Nearly all of a shared error is that of the spool or of the temperature. */
        bool is_shared = fabs(hf_estimate_own_m(&j->estimate, e)) < TOLD * fabs(j->estimate.cut_m[e]);
        if (size > HF_ADJUST_CASE_STANDS_OUT && !is_shared) j->sized[j->n_out++] = (hf_adjust_case_sized){size, e};
    }
    sort(j, j->n_out, j->out);
    HF_TRY(hf_estimate_belief(&j->estimate, j->n_out, j->out, j->by_places_m));
    for (int k = 0; k < j->n_out; k++) {
        double own_m = hf_estimate_own_m(&j->estimate, j->out[k]), part = j->by_places_m[k];
        j->by_places_m[k] = part >= TOLD ? j->estimate.cut_m[j->out[k]] + own_m / part - own_m : (double)NAN;
    }
    return HF_OK;
}

/* ---- other aims ---- */

/* Makes the objective of one figure of an as-built net. Returns HF_OK, HF_BAD_CASE or HF_NO_MEMORY. Free *objectives
 * even after a failure. */
static hf_status make_objectives(const hf_adjust_case *j, const hf_built *b, hf_figure_kind figure,
                                 hf_objectives *objectives, hf_messages *messages)
{
    const hf_problem *p = &j->problem;
    hf_optimize_settings wanted = {.n_term = 1};
    wanted.term[0] = (hf_objective_settings){.figure = figure, .feed = HF_FIXED, .weight = 1};
    return hf_objectives_create(&b->scene, &b->model, &wanted, &p->surface, &p->facets, NULL, objectives, messages);
}

/* Copies the positions from which psi is measured into the model of an as-built net: those of the net without errors,
 * or the target positions. */
static void take_aim(const hf_adjust_case *j, hf_aim aim, hf_built *b)
{
    hf_model *m = &b->model;
    const double *from = aim == HF_AIM_DESIGN ? b->position_m : j->problem.model.position_m;
    for (int c = 0; c < 3; c++)
        memcpy(m->position_m + c * m->n_node, from + c * m->n_node, (size_t)m->n_free * sizeof(double));
}

/* Returns the number of adjustments that reach the range. */
static int count_at_range(const hf_adjustment *a, const hf_adjust_settings *s)
{
    int n = 0;
    for (int k = 0; k < a->n_turnbuckle; k++)
        n += abs(a->turnbuckle[k].steps) == hf_adjust_steps(s);
    return n;
}

/* Computes the RMS distance of the inner nodes of the design from their target positions, and of a net with errors from
 * the design. */
static void find_psi_of_design(hf_adjust_case *j)
{
    const hf_model *m = &j->net->model;
    double design = 0, errors = 0;
    for (int k = 0; k < m->n_inner_node; k++) {
        int row = m->inner_row[k];
        for (int c = 0; c < 3; c++) {
            double d = j->built.position_m[c * m->n_node + row] - j->problem.model.position_m[c * m->n_node + row];
            design += d * d;
        }
        errors += j->expected_m[row] * j->expected_m[row];
    }
    j->design_psi_m = m->n_inner_node > 0 ? sqrt(design / m->n_inner_node) : 0;
    j->error_psi_m = m->n_inner_node > 0 ? sqrt(errors / m->n_inner_node) : 0;
}

/* Finds the adjustments for another figure and aim, and stores what they would reach. */
static hf_status try_instead(hf_adjust_case *j, hf_figure_kind figure, hf_aim aim)
{
    hf_adjust_settings settings = *j->task.settings;
    hf_adjust_task task = j->task;
    hf_objectives objectives = {0};
    hf_adjustment found = {0};
    settings.figure = figure;
    settings.aim = aim;
    settings.target_m = 0;
    task.settings = &settings;
    task.objectives = &objectives;
    take_aim(j, aim, j->net);
    hf_status status = make_objectives(j, j->net, figure, &objectives, NULL);
    if (status == HF_OK) status = hf_adjust_find(&j->estimate, &task, &found);
    if (status == HF_OK)
        j->instead[j->n_instead++] = (hf_adjust_case_instead){
            figure, aim, found.estimated_m, found.adjusted_m, found.n_turnbuckle, count_at_range(&found, &settings)};
    hf_arena_free_block(found.block);
    hf_objectives_free(&objectives);
    take_aim(j, j->task.settings->aim, j->net);
    /* An aim without a shape is not offered. */
    return status == HF_INTERRUPTED || status == HF_NO_MEMORY ? status : HF_OK;
}

/* Tries other figures and aims, after the adjustments are found. It does so if psi of the design exceeds that of the
 * errors, or if most adjustments reach the range. Returns HF_OK, HF_INTERRUPTED or HF_NO_MEMORY. */
static hf_status find_instead(hf_adjust_case *j)
{
    const hf_adjust_settings *s = j->task.settings;
    find_psi_of_design(j);
    j->n_at_range = count_at_range(&j->adjustment, s);
    bool has_own_psi = j->design_psi_m > j->error_psi_m, is_far = 2 * j->n_at_range > j->adjustment.n_turnbuckle;
    bool is_psi = s->figure == HF_FIGURE_PSI;
    if (!is_far && !(has_own_psi && is_psi)) return HF_OK;
    if (!is_psi || s->aim != HF_AIM_DESIGN) HF_TRY(try_instead(j, HF_FIGURE_PSI, HF_AIM_DESIGN));
    if (has_own_psi && !(is_psi && s->aim == HF_AIM_TARGET)) HF_TRY(try_instead(j, HF_FIGURE_PSI, HF_AIM_TARGET));
    if (!is_psi || !j->problem.settings.has_surface) return HF_OK;
    hf_figure_kind figure = j->problem.facets.n_facet > 0 ? HF_FIGURE_FACETS : HF_FIGURE_SURFACE;
    return try_instead(j, figure, HF_AIM_TARGET);
}

/* ---- the prior ---- */

/* Checks that no sigma is so small beside the errors that differences of positions are only rounding. Returns HF_OK or
 * HF_BAD_CASE. */
static hf_status check_sigmas(const job *j, double error_m, hf_messages *messages)
{
    const hf_model *m = &j->net->model;
    double least = SIGMA_LEAST * error_m, rest = j->problem.settings.tolerance.sigma_support_m;
    if (rest > 0 && rest < least * (1 - ROUNDING))
        return hf_error(messages, HF_BAD_CASE,
                        "%s: the value tolerance.sigma_support_m of %.3g m is too small for cable errors of %.3g m. "
                        "Use at least %.3g m, or 0",
                        j->path, rest, error_m, least * (1 + ROUNDING));
    for (int i = 0; i < m->n_node; i++) {
        int row = m->row_of_node[i];
        double sigma = 1 / sqrt(j->measured.weight_per_m2[3 * row]);
        if (!j->measured.line[row] || sigma >= least * (1 - ROUNDING)) continue;
        return hf_error(
            messages, HF_BAD_CASE,
            "%s:%d: the value sigma_m of %.3g m is too small for cable errors of %.3g m. Use at least %.3g m",
            j->measured_path, j->measured.line[row], sigma, error_m, least * (1 + ROUNDING));
    }
    return HF_OK;
}

static hf_status make_prior(job *j, hf_messages *messages)
{
    const hf_case *c = &j->problem.settings;
    hf_material material;
    hf_status status = hf_config_material(c, &j->problem.scene, &material, messages);
    if (status == HF_OK) {
        hf_tolerance_settings t = c->tolerance;
        if (j->load_case && j->loaded.load_case->has_temperature)
            t.sigma_temperature_K = hypot(t.sigma_temperature_K, t.sigma_load_case_temperature_K);
        status = hf_prior_make(j->net, &t, t.sigma_temperature_K > 0 ? material.expansion_per_K : NULL, &j->prior);
        if (status == HF_NO_MEMORY)
            hf_error(messages, status, "out of memory for the cable errors of the case %s", c->path);
    }
    hf_material_free(&material);
    return status;
}

/* Makes the prior of the errors from the section tolerance, and checks that it leaves something to estimate. */
static hf_status find_prior(job *j, hf_messages *messages)
{
    double largest = 0;
    HF_TRY(make_prior(j, messages));
    if (j->problem.settings.tolerance.n_truss)
        hf_warning(messages,
                   "%s: hifdm adjust does not estimate the temperatures in tolerance.truss. hifdm adjust assumes that "
                   "the truss has its manufacturing temperature. Measure the net at the manufacturing temperature of "
                   "the truss, or include the displacements of the truss in tolerance.sigma_support_m",
                   j->path);
    for (int e = 0; e < j->net->model.n_cable; e++)
        largest = fmax(largest, j->prior.sigma_m[e]);
    if (largest > 0) return check_sigmas(j, largest, messages);
    return hf_error(messages, HF_BAD_CASE,
                    "%s: tolerance: the section defines no cable errors that hifdm can estimate. Add the key "
                    "sigma_cut_m, sigma_cut_ratio, sigma_EA_ratio or sigma_temperature_K",
                    j->path);
}

/* ---- estimate ---- */

static hf_status check_sections(const hf_case *c, const char *path, hf_messages *messages)
{
    char location[HF_LOCATION_SIZE];
    if (!c->has_adjust)
        hf_error(messages, HF_BAD_CASE,
                 "%s: the case has no `adjust` section. Add, for example, `adjust: {set: NAME, range_m: 0.002, step_m: "
                 "0.0001}`, where NAME is the set of cables with turnbuckles",
                 path);
    if (!c->has_tolerance)
        hf_error(messages, HF_BAD_CASE,
                 "%s: the case has no `tolerance` section. Add, for example, `tolerance: {sigma_cut_m: 0.0001}`, where "
                 "sigma_cut_m is the standard deviation of the cutting lengths",
                 path);
    if (c->has_adjust && c->adjust.figure != HF_FIGURE_PSI && !c->has_surface)
        hf_error(messages, HF_BAD_CASE, "%s: the value %s needs a target surface. Add a `surface` section",
                 hf_config_place(c, location, "adjust.figure"), hf_adjust_figure_word[c->adjust.figure]);
    return messages->n_error ? HF_BAD_CASE : HF_OK;
}

static hf_status pick_cables(job *j, hf_messages *messages)
{
    char location[HF_LOCATION_SIZE];
    const hf_case *c = &j->problem.settings;
    int n = hf_cable_pick_some(&j->problem.scene, c->adjust.set, hf_config_place(c, location, "adjust.set"), j->cable,
                               messages);
    j->task = (hf_adjust_task){&c->adjust, &j->objectives, n, j->cable, j->least_N, j->threads};
    return n > 0 ? HF_OK : HF_BAD_CASE;
}

/* Finds the minimum tensions that optimize.limits and `requirements` demand of the net in the load case in which it was
 * measured; 0 for cables without a demand. */
static hf_status find_least(job *j, hf_messages *messages)
{
    const hf_problem *p = &j->problem;
    hf_limits limits;
    hf_required required = {0};
    hf_material masses = {0};
    hf_status status = hf_limits_create(&p->scene, &p->model, &p->settings.optimize, &limits, messages);
    if (status == HF_OK) status = hf_requirements_stage_rows(p, &masses, &required, messages);
    for (int k = 0; k < limits.n && status == HF_OK; k++)
        for (int i = 0; i < limits.row[k].n_cable && limits.row[k].kind == HF_LIMIT_TENSION; i++) {
            double *least_N = &j->least_N[limits.row[k].cable[i]];
            *least_N = fmax(*least_N, limits.row[k].lower);
        }
    for (int k = 0; k < required.n && status == HF_OK; k++) {
        const hf_requirement_settings *row = &required.row[k];
        if (row->figure != HF_REQUIRED_TENSION || required.low[k] < 0 ||
            !(required.states[k] >> (1 + j->i_load_case) & 1u))
            continue;
        const hf_required_column *cables = &required.column[required.low[k]];
        for (int i = 0; i < cables->n_cable; i++)
            j->least_N[cables->cable[i]] = fmax(j->least_N[cables->cable[i]], row->at_least);
    }
    hf_required_free(&required);
    hf_material_free(&masses);
    hf_arena_free_block(limits.block);
    return status;
}

static hf_status explain_failure(const job *j, hf_status status, const char *what, hf_messages *messages)
{
    if (status == HF_OK || status == HF_INTERRUPTED) return status;
    return hf_error(messages, status, "%s: %s: %s", j->path, what, hf_status_text(status));
}

/* Reports a measurement that the net and its tolerances cannot explain; `row` is the worst node. If the measurement
 * cannot be of this net, the run fails, because adjustments would do harm. Returns HF_OK or HF_BAD_CASE. */
static hf_status check_misfit(const job *j, int row, hf_messages *messages)
{
    double distance_m = hf_adjust_case_off_m(j, row), chi = hf_adjust_case_chi_square(j);
    if (hf_adjust_case_fits(j)) return HF_OK;
    const char *id = j->net->scene.node_id[j->net->model.node_of_row[row]];
    if (chi > FOREIGN)
        return hf_error(
            messages, HF_BAD_CASE,
            "%s: this measurement does not belong to this net, because chi^2 is %.3g per coordinate instead of about "
            "1. The worst node '%s' (line %d) is %.3g mm from the nearest possible shape. Check for swapped ids, "
            "displaced supports (tolerance.sigma_support_m), another design or another load case. If only sigma_m or "
            "the sigmas of the `tolerance` section are wrong, these values are too small by a factor of %.2g",
            j->measured_path, chi, id, j->measured.line[row], distance_m * 1e3, sqrt(chi));
    hf_warning(
        messages,
        "%s: these positions do not fit the net and its tolerances, because chi^2 is %.3g per coordinate instead of "
        "about 1. The worst node '%s' (line %d) is %.3g mm from the nearest possible shape. Possible causes are a "
        "sigma that is too small, displaced supports (tolerance.sigma_support_m), or another design of the net",
        j->measured_path, chi, id, j->measured.line[row], distance_m * 1e3);
    return HF_OK;
}

/* Estimates the errors of cutting lengths, and checks the measurement before and after. Returns HF_OK or the status of
 * the failure, with a message. */
static hf_status estimate_errors(job *j, hf_messages *messages)
{
    const hf_tolerance_settings *t = &j->problem.settings.tolerance;
    hf_saddle_prior prior = {j->prior.own_m, t->sigma_support_m, j->measured.weight_per_m2, j->prior.n_shared,
                             j->prior.shared_m};
    hf_estimate *p = &j->estimate;
    HF_TRY(
        explain_failure(j, hf_estimate_create(j->net, &prior, j->measured.position_m, p), "the nominal net", messages));
    HF_TRY(hf_estimate_expect(p, j->expected_m));
    HF_TRY(hf_measured_check(j->measured_path, j->net, j->expected_m, &j->measured, messages));
    HF_TRY(explain_failure(j, hf_estimate_find(p), "the estimated net", messages));
    HF_TRY(check_misfit(j, find_places(j), messages));
    if (!p->is_settled)
        hf_warning(messages,
                   "%s: the estimate did not converge in %d steps, so the values below belong to the last step",
                   j->measured_path, p->n_step);
    return HF_OK;
}

/* ---- figure of the measurement ---- */

/* Returns psi of the measured inner nodes, m; NaN without any, and for other figures. */
static double measured_psi_m(const job *j)
{
    const hf_model *m = &j->net->model;
    double square = 0;
    int n = 0;
    for (int k = 0; k < m->n_inner_node; k++) {
        int row = m->inner_row[k];
        if (!j->measured.line[row]) continue;
        for (int c = 0; c < 3; c++) {
            double d = j->measured.position_m[3 * row + c] - m->position_m[c * m->n_node + row];
            square += d * d;
        }
        n++;
    }
    return n > 0 && j->problem.settings.adjust.figure == HF_FIGURE_PSI ? sqrt(square / n) : (double)NAN;
}

/* ---- load cases ---- */

/* What a prediction needs of one net. */
typedef struct {
    hf_objectives objectives;
    hf_objectives_point point;
    hf_workspace work;
    hf_form_result form;
    double *cut_m, *move_m; /* [n_cable], [3][n_node] by row */
    void *block;
} prediction_room;

/* Makes the design in a load case. */
static hf_status load(const job *j, int i_load_case, hf_built_loaded *to, hf_messages *messages)
{
    const hf_built_rest rest = {j->rest_m, NULL};
    hf_built_loaded_select(&j->problem.load_cases, i_load_case, &rest, j->problem.model.n_attachment, to);
    return explain_failure(j, hf_built_loaded_make(&j->built, NULL, 1, to, messages), "the net in a load case",
                           messages);
}

/* Sets the net that was measured: that of the design, or the design in the load case of the measurement. */
static hf_status find_net(job *j, hf_messages *messages)
{
    const hf_problem *p = &j->problem;
    size_t n = 3 * (size_t)p->load_cases.n * (size_t)p->model.n_attachment;
    j->net = &j->built;
    if (n > 0) {
        hf_status status = HF_ARENA_ARRAYS(&j->rest_block, HF_ARRAY(j->rest_m, n));
        if (status == HF_OK) status = hf_load_case_stage_rest(p, j->rest_m, NULL);
        HF_TRY(explain_failure(j, status, "the truss in the load cases", messages));
    }
    if (!j->load_case) return HF_OK;
    HF_TRY(load(j, j->i_load_case, &j->loaded, messages));
    j->net = &j->loaded.built;
    if (j->loaded.has_shape) return HF_OK;
    return hf_error(messages, HF_NOT_CONVERGED, "%s: the design has no equilibrium in load case '%s'", j->path,
                    j->load_case);
}

/* Returns the length of cable e in load case i_load_case, -1: none, relative to its length without load case. */
static double stretch_of(const job *j, int i_load_case, int e)
{
    const hf_load_cases *c = &j->problem.load_cases;
    double rise_K = i_load_case < 0 ? 0 : c->load_case[i_load_case].rise_K[e];
    return rise_K != 0 ? 1 + c->material.expansion_per_K[e] * rise_K : 1;
}

/* Solves the net with the estimated errors in a load case, before or after the adjustments, and measures its figure. A
 * net without a shape has none. */
static hf_status measure_net(const job *j, const hf_built *b, int i_load_case, bool is_adjusted, prediction_room *r,
                             double *figure_m)
{
    const hf_model *m = &b->model;
    const hf_estimate *p = &j->estimate;
    const hf_adjustment *a = &j->adjustment;
    double merit;
    for (int e = 0; e < m->n_cable; e++)
        r->cut_m[e] = p->cut_m[e];
    for (int k = 0; k < a->n_turnbuckle && is_adjusted; k++)
        r->cut_m[a->turnbuckle[k].cable] += a->turnbuckle[k].turnbuckle_m;
    for (int e = 0; e < m->n_cable; e++) /* the estimate is of lengths in the load case of the measurement */
        r->cut_m[e] = m->target[e] + r->cut_m[e] * stretch_of(j, i_load_case, e) / stretch_of(j, j->i_load_case, e);
    for (int row = m->n_free; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            r->move_m[c * m->n_node + row] = p->rest_m[3 * row + c];
    hf_built_solve(b, &(hf_built_net){.cut_m = r->cut_m, .support_displacement_m = r->move_m}, &r->work, &r->form);
    *figure_m = (double)NAN;
    return r->form.status == HF_OK ? hf_objectives_measure(&r->objectives, &r->work, &r->point, figure_m, &merit)
                                   : HF_OK;
}

/* Predicts the figure, the minimum tension and the slack cables after the adjustments in a load case, -1: none. */
static hf_status predict_in(const job *j, hf_built *b, int i_load_case, hf_adjust_case_prediction *to)
{
    const hf_model *m = &b->model;
    const hf_adjust_settings *s = j->task.settings;
    prediction_room r = {0};
    take_aim(j, s->aim, b);
    hf_status status =
        HF_ARENA_ARRAYS(&r.block, HF_ARRAY(r.cut_m, m->n_cable), HF_ARRAY(r.move_m, 3 * (size_t)m->n_node));
    if (status == HF_OK) status = make_objectives(j, b, s->figure, &r.objectives, NULL);
    if (status == HF_OK) status = hf_objectives_point_create(&r.objectives, &r.point);
    if (status == HF_OK) status = hf_workspace_create(m, &r.work);
    if (status == HF_OK) status = measure_net(j, b, i_load_case, false, &r, &to->estimated_m);
    if (status == HF_OK) status = measure_net(j, b, i_load_case, true, &r, &to->adjusted_m);
    if (status == HF_OK && r.form.status == HF_OK) {
        to->n_slack = r.form.n_slack;
        to->tension_min_N = INFINITY;
        for (int e = 0; e < m->n_cable; e++)
            to->tension_min_N = fmin(to->tension_min_N, r.work.tension_N[e]);
    }
    hf_workspace_free(&r.work);
    hf_objectives_point_free(&r.point);
    hf_objectives_free(&r.objectives);
    hf_arena_free_block(r.block);
    return status;
}

/* Returns the bits of the load cases for which a prediction is given: bit 0 without load case, bit 1 + k for load case
 * k. They are those of the requirements. Returns 0 if the adjustments are found without load case and no requirement
 * names one. */
static unsigned predicted_states(const job *j)
{
    const hf_problem *p = &j->problem;
    unsigned states = 1;
    for (int i = 0; i < p->settings.n_requirement; i++)
        for (int k = 0; k < p->load_cases.n; k++) {
            const char *of = p->settings.requirement[i].load_case;
            if (!strcmp(of, "all") || !strcmp(of, p->load_cases.load_case[k].name)) states |= 2u << k;
        }
    return states == 1 && !j->load_case ? 0 : states;
}

static hf_status predict_all(job *j, hf_messages *messages)
{
    unsigned states = predicted_states(j);
    hf_status status = HF_OK;
    for (int k = -1; k < j->problem.load_cases.n && status == HF_OK; k++) {
        if (!(states >> (k + 1) & 1u)) continue;
        hf_adjust_case_prediction *to = &j->prediction[j->n_prediction++];
        *to =
            (hf_adjust_case_prediction){k < 0 ? "nominal" : j->problem.load_cases.load_case[k].name, NAN, NAN, NAN, 0};
        hf_built_loaded loaded = {0};
        if (k >= 0) status = load(j, k, &loaded, messages);
        if (status == HF_OK && (k < 0 || loaded.has_shape))
            status = predict_in(j, k < 0 ? &j->built : &loaded.built, k, to);
        hf_built_loaded_free(&loaded);
    }
    return status;
}

/* ---- interface ---- */

void hf_adjust_case_free(hf_adjust_case *j)
{
    hf_arena_free_block(j->adjustment.block);
    hf_arena_free_block(j->prior.block);
    hf_objectives_free(&j->objectives);
    hf_estimate_free(&j->estimate);
    hf_arena_free_block(j->measured.block);
    hf_built_loaded_free(&j->loaded);
    hf_arena_free_block(j->rest_block);
    hf_built_free(&j->built);
    hf_problem_free(&j->problem);
    hf_arena_free_block(j->block);
}

/* Finds the load case of the measurement. */
static hf_status find_load_case(job *j, hf_messages *messages)
{
    const hf_load_cases *c = &j->problem.load_cases;
    const char *name[HF_LOAD_CASES_MAX];
    char hint[HF_TEXT_HINT_SIZE];
    j->i_load_case = -1;
    if (!j->load_case) return HF_OK;
    for (int k = 0; k < c->n; k++)
        name[k] = c->load_case[k].name;
    j->i_load_case = hf_text_index(j->load_case, name, c->n);
    if (j->i_load_case >= 0) return HF_OK;
    if (c->n == 0)
        return hf_error(
            messages, HF_BAD_USAGE,
            "--load-case %s: the case %s has no load cases. Add the load case of the measurement to the list "
            "`load_cases`",
            j->load_case, j->path);
    hf_text_hint(j->load_case, name, c->n, hint);
    if (!*hint) snprintf(hint, sizeof hint, ". Its first load case is '%.64s'", name[0]);
    return hf_error(messages, HF_BAD_USAGE, "--load-case %s: the list `load_cases` of %s has no such load case%s",
                    j->load_case, j->path, hint);
}

hf_status hf_adjust_case_load(const char *path, const char *const *set, int n_set, const char *load_case, job *j,
                              hf_messages *messages)
{
    j->path = path;
    j->load_case = load_case;
    HF_TRY(hf_problem_load(path, NULL, set, n_set, NULL, &j->problem, messages));
    HF_TRY(find_load_case(j, messages));
    return check_sections(&j->problem.settings, path, messages);
}

hf_status hf_adjust_case_read(const char *measured_path, int threads, job *j, hf_messages *messages)
{
    const hf_problem *p = &j->problem;
    size_t n_cable = (size_t)p->scene.n_cable, n_node = (size_t)p->scene.n_node;
    j->measured_path = measured_path;
    j->threads = threads;
    if (HF_ARENA_ARRAYS(&j->block, HF_ARRAY(j->cable, n_cable), HF_ARRAY(j->least_N, n_cable),
                        HF_ARRAY(j->expected_m, n_node), HF_ARRAY(j->out, n_cable), HF_ARRAY(j->by_places_m, n_cable),
                        HF_ARRAY(j->far_row, n_node), HF_ARRAY(j->sized, n_cable > n_node ? n_cable : n_node)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for %d cables", p->scene.n_cable);
    HF_TRY(pick_cables(j, messages));
    return hf_measured_read(measured_path, &p->scene, &p->model, p->settings.adjust.sigma_m, &j->measured, messages);
}

hf_status hf_adjust_case_find(job *j, hf_messages *messages)
{
    const hf_adjust_settings *s = &j->problem.settings.adjust;
    HF_TRY(find_net(j, messages));
    take_aim(j, s->aim, j->net);
    HF_TRY(find_prior(j, messages));
    HF_TRY(find_least(j, messages));
    if (s->figure == HF_FIGURE_FACETS && j->problem.facets.n_facet == 0)
        return hf_error(messages, HF_BAD_CASE,
                        "%s: the value facets of adjust.figure needs facets, but this net has no facets",
                        j->problem.settings.path);
    HF_TRY(make_objectives(j, j->net, s->figure, &j->objectives, messages));
    HF_TRY(estimate_errors(j, messages));
    j->measured_m = measured_psi_m(j);
    HF_TRY(explain_failure(j, find_cables(j), "the estimated net", messages));
    HF_TRY(explain_failure(j, hf_adjust_find(&j->estimate, &j->task, &j->adjustment), "the adjusted net", messages));
    HF_TRY(explain_failure(j, find_instead(j), "the net with other adjustments", messages));
    return explain_failure(j, predict_all(j, messages), "the adjusted net in other load cases", messages);
}
