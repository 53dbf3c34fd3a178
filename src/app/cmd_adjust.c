/* `hifdm adjust` estimates the errors of cutting lengths from measured positions of the as-built net. It then finds the
 * fewest turnbuckle adjustments that restore the figure of the net.
 *
 * in : nodes.csv id,x_m,y_m,z_m[,sigma_m]; the sections tolerance (sizes of errors) and adjust (cables that have a
 *      turnbuckle) of the case.
 * out: order,cable,set,move_mm,tension_before_N,tension_after_N,predicted_rms_mm,expected_rms_mm. One row per
 *      adjustment, in the order in which they are made. A value above 0 makes the cable longer.
 *
 *      case, design -> as-built net -> prior of the errors -> estimate from measured positions -> adjustments -> table
 *
 * Contents: the prior - estimate - figure of the measurement - the command */
#include "app/cmd.h"

#include "app/cmd_adjust.h"
#include "app/built_design.h"
#include "base/arena.h"
#include "base/file_out.h"
#include "net/cable_pick.h"
#include "out/export.h"
#include "run/tolerance_stage.h"
#include "solve/limits.h"

#include <math.h>
#include <string.h>

/* Above this chi^2 per coordinate, the measurement is of another net: the sigmas would have to be ten times larger. */
#define FOREIGN 100.0
#define ROUNDING 0.005 /* relative rounding of numbers in messages */
/* The minimum sigma, as a part of the sigma of the errors: weights above 1e9 times theirs exceed double precision. */
#define SIGMA_LEAST 3e-5

typedef hf_adjust_job job;

static void job_free(job *j)
{
    hf_adjust_free(&j->adjustment);
    hf_prior_free(&j->prior);
    hf_objectives_free(&j->objectives);
    hf_estimate_free(&j->estimate);
    hf_measured_free(&j->measured);
    hf_built_free(&j->built);
    hf_problem_free(&j->problem);
    hf_arena_free_block(j->block);
}

/* ---- the prior ---- */

/* Checks that no sigma is so small beside the errors that differences of positions are only rounding. Returns HF_OK or
 * HF_BAD_CASE. */
static hf_status check_sigmas(const job *j, const char *path, double error_m, hf_messages *messages)
{
    const hf_model *m = &j->built.model;
    double least = SIGMA_LEAST * error_m, rest = j->problem.settings.tolerance.sigma_support_m;
    if (rest > 0 && rest < least * (1 - ROUNDING))
        return hf_error(messages, HF_BAD_CASE,
                        "%s: tolerance.sigma_support_m of %.3g m is too small for cable errors of %.3g m: use at least "
                        "%.3g, or 0",
                        path, rest, error_m, least * (1 + ROUNDING));
    for (int i = 0; i < m->n_node; i++) {
        int row = m->row_of_node[i];
        double sigma = 1 / sqrt(j->measured.weight_per_m2[3 * row]);
        if (!j->measured.line[row] || sigma >= least * (1 - ROUNDING)) continue;
        return hf_error(messages, HF_BAD_CASE,
                        "%s:%d: sigma_m of %.3g m is too small for cable errors of %.3g m: use at least %.3g",
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
        const double *expansion = c->tolerance.sigma_temperature_K > 0 ? material.expansion_per_K : NULL;
        status = hf_prior_make(&j->built, &c->tolerance, expansion, &j->prior);
        if (status == HF_NO_MEMORY) hf_error(messages, status, "out of memory for the errors of %s", c->path);
    }
    hf_material_free(&material);
    return status;
}

/* Makes the prior of the errors from the section tolerance, and checks that it leaves something to estimate. */
static hf_status find_prior(job *j, const char *path, hf_messages *messages)
{
    double largest = 0;
    HF_TRY(make_prior(j, messages));
    if (j->problem.settings.tolerance.n_truss)
        hf_warning(
            messages,
            "%s: tolerance.truss is not estimated: adjust assumes that the truss is as it was made. Measure when "
            "it has the temperature of the workshop, or include its displacements in tolerance.sigma_support_m",
            path);
    for (int e = 0; e < j->built.model.n_cable; e++)
        largest = fmax(largest, j->prior.sigma_m[e]);
    if (largest > 0) return check_sigmas(j, path, largest, messages);
    return hf_error(messages, HF_BAD_CASE,
                    "%s: tolerance: cables have no errors that could be estimated; add sigma_cut_m, sigma_cut_ratio, "
                    "sigma_EA_ratio or sigma_temperature_K",
                    path);
}

/* ---- estimate ---- */

static hf_status check_sections(const hf_case *c, const char *path, hf_messages *messages)
{
    char location[HF_PATH_SIZE + 64];
    if (!c->has_adjust)
        hf_error(
            messages, HF_BAD_CASE,
            "%s: has no section adjust: add adjust: {set: NAME, range_m: 0.002, step_m: 0.0001} with the cables that "
            "have turnbuckles, the range of an adjustment and its step",
            path);
    if (!c->has_tolerance)
        hf_error(
            messages, HF_BAD_CASE,
            "%s: has no section tolerance: add tolerance: {sigma_cut_m: 0.0001}, the standard deviation of cutting",
            path);
    hf_config_location(c, "adjust.figure", location, sizeof location);
    if (c->has_adjust && c->adjust.figure != HF_FIGURE_PSI && !c->has_surface)
        hf_error(messages, HF_BAD_CASE, "%s: %s needs a target surface: add a section surface", location,
                 hf_adjust_figure_word[c->adjust.figure]);
    return messages->n_error ? HF_BAD_CASE : HF_OK;
}

static hf_status pick_cables(job *j, hf_messages *messages)
{
    char location[HF_PATH_SIZE + 64];
    const hf_case *c = &j->problem.settings;
    hf_config_location(c, "adjust.set", location, sizeof location);
    int n = hf_cable_pick_some(&j->problem.scene, c->adjust.set, location, j->cable, messages);
    j->task = (hf_adjust_task){&c->adjust, &j->objectives, n, j->cable, j->least_N, j->threads};
    return n > 0 ? HF_OK : HF_BAD_CASE;
}

/* Finds the minimum tensions that tolerance.require and optimize.limits demand; 0 for cables without a demand. */
static hf_status find_least(job *j, hf_messages *messages)
{
    const hf_case *c = &j->problem.settings;
    hf_limits limits;
    hf_status status = hf_limits_create(&j->problem.scene, &j->problem.model, &c->optimize, &limits, messages);
    for (int e = 0; e < j->problem.scene.n_cable; e++)
        for (int k = 0; k < c->tolerance.n_require; k++) {
            const hf_require_settings *row = &c->tolerance.require[k];
            if (row->measure == HF_TOLERANCE_LEAST_TENSION && row->at_least > j->least_N[e])
                j->least_N[e] = row->at_least;
        }
    for (int k = 0; k < limits.n && status == HF_OK; k++)
        for (int i = 0; i < limits.row[k].n_cable && limits.row[k].kind == HF_LIMIT_TENSION; i++) {
            double *least_N = &j->least_N[limits.row[k].cable[i]];
            *least_N = fmax(*least_N, limits.row[k].lower);
        }
    hf_limits_free(&limits);
    return status;
}

static hf_status find_figure(job *j, hf_messages *messages)
{
    const hf_problem *p = &j->problem;
    if (p->settings.adjust.figure == HF_FIGURE_FACETS && p->facets.n_facet == 0)
        return hf_error(messages, HF_BAD_CASE, "%s: adjust.figure: facets: this net has no facets", p->settings.path);
    return hf_adjust_make_objectives(j, p->settings.adjust.figure, &j->objectives, messages);
}

/* Makes the as-built net. psi is then measured from the positions that are the aim of the adjustments. */
static hf_status make_net(job *j, const hf_options *o, hf_messages *messages)
{
    hf_problem *p = &j->problem;
    HF_TRY(hf_built_design_make(o, p, &j->built, messages));
    hf_adjust_take_aim(j, p->settings.adjust.aim);
    return HF_OK;
}

static hf_status explain_failure(hf_status status, const char *what, const char *path, hf_messages *messages)
{
    if (status == HF_OK || status == HF_INTERRUPTED) return status;
    return hf_error(messages, status, "%s: %s: %s", path, what, hf_status_text(status));
}

/* Reports a measurement that the net and its tolerances cannot explain; `row` is the worst node. If it cannot be of this net, the run fails,
 * because adjustments would do harm. Returns HF_OK or HF_BAD_CASE. */
static hf_status check_misfit(const job *j, int row, hf_messages *messages)
{
    double distance_m = hf_adjust_off_m(j, row), chi = hf_adjust_chi_square(j);
    if (hf_adjust_fits(j)) return HF_OK;
    const char *id = j->built.scene.node_id[j->built.model.node_of_row[row]];
    if (chi > FOREIGN)
        return hf_error(
            messages, HF_BAD_CASE,
            "%s: this measurement does not belong to this net: chi^2 is %.3g per coordinate instead of 1; the worst "
            "is node '%s' (line %d), %.3g mm from the nearest possible shape. Look for swapped ids, displaced supports "
            "(tolerance.sigma_support_m), another design or another load case; if only sigma_m or the sigmas of "
            "section "
            "tolerance are wrong, they are wrong by a factor of %.2g",
            j->measured_path, chi, id, j->measured.line[row], distance_m * 1e3, sqrt(chi));
    hf_warning(
        messages,
        "%s: these positions do not fit the net and its tolerances: chi^2 is %.3g per coordinate instead of 1; the "
        "worst is node '%s' (line %d), %.3g mm off. Either sigma_m or a sigma of section tolerance is too small, "
        "supports are displaced (tolerance.sigma_support_m), or it is another design",
        j->measured_path, chi, id, j->measured.line[row], distance_m * 1e3);
    return HF_OK;
}

/* Estimates the errors of cutting lengths, and checks the measurement before and after. Returns HF_OK or the status of
 * the failure, with a message. */
static hf_status estimate_errors(job *j, const hf_options *o, hf_messages *messages)
{
    const hf_tolerance_settings *t = &j->problem.settings.tolerance;
    hf_saddle_prior prior = {j->prior.own_m, t->sigma_support_m, j->measured.weight_per_m2, j->prior.n_shared,
                             j->prior.shared_m};
    hf_estimate *p = &j->estimate;
    HF_TRY(explain_failure(hf_estimate_create(&j->built, &prior, j->measured.position_m, p), "the nominal net", o->file,
                           messages));
    HF_TRY(hf_estimate_expect(p, j->expected_m));
    HF_TRY(hf_measured_check(o->measured, &j->built, j->expected_m, &j->measured, messages));
    HF_TRY(explain_failure(hf_estimate_find(p), "the estimated net", o->file, messages));
    HF_TRY(check_misfit(j, hf_adjust_find_places(j), messages));
    if (!p->is_settled)
        hf_warning(messages, "%s: the estimate did not converge in %d steps: the figures below belong to the last step",
                   o->measured, p->n_step);
    return HF_OK;
}

/* ---- figure of the measurement ---- */

/* Returns psi of the measured inner nodes, m; NaN without any, and for other figures. */
static double measured_psi_m(const job *j)
{
    const hf_model *m = &j->built.model;
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

/* ---- the command ---- */

static hf_status allocate_job(job *j, hf_messages *messages)
{
    size_t n_cable = (size_t)j->problem.scene.n_cable, n_node = (size_t)j->problem.scene.n_node;
    hf_status status =
        HF_ARENA_ARRAYS(&j->block, HF_ARRAY(j->cable, n_cable), HF_ARRAY(j->least_N, n_cable),
                        HF_ARRAY(j->expected_m, n_node), HF_ARRAY(j->out, n_cable), HF_ARRAY(j->by_places_m, n_cable),
                        HF_ARRAY(j->far_row, n_node), HF_ARRAY(j->sized, n_cable > n_node ? n_cable : n_node));
    return status == HF_OK ? HF_OK : hf_error(messages, status, "out of memory for %zu cables", n_cable);
}

static hf_status check_output(const job *j, const hf_options *o, const char *output, hf_messages *messages)
{
    if (!output) return HF_OK;
    HF_TRY(hf_problem_spare_inputs(&j->problem, o->measured, output, messages));
    if (o->result) HF_TRY(hf_file_out_spare(o->result, "an input of this run", output, messages));
    HF_TRY(hf_export_claim_file(output, o->force, messages));
    return hf_file_out_try(output, messages);
}

static hf_status check_outputs(const job *j, const hf_options *o, hf_messages *messages)
{
    if (o->report && !o->result)
        return hf_error(messages, HF_BAD_USAGE,
                        "--report %s needs --result FILE, the result of this case (hifdm run %s writes it)", o->report,
                        o->file);
    if (o->output && o->report && !strcmp(o->output, o->report))
        return hf_error(messages, HF_BAD_USAGE, "-o and --report both name %s: use different names", o->output);
    HF_TRY(check_output(j, o, o->output, messages));
    HF_TRY(hf_file_out_spare(o->output, "the table of adjustments", o->report ? o->report : "", messages));
    return check_output(j, o, o->report, messages);
}

static hf_status execute(job *j, const hf_options *o, hf_messages *messages)
{
    HF_TRY(hf_problem_load(o->file, NULL, o->set, o->n_set, NULL, &j->problem, messages));
    const hf_problem *p = &j->problem;
    j->measured_path = o->measured;
    j->threads = o->threads;
    HF_TRY(check_sections(&p->settings, o->file, messages));
    HF_TRY(hf_built_design_check(o, &p->settings, messages));
    HF_TRY(hf_tolerance_stage_check(p, false, messages));
    HF_TRY(check_outputs(j, o, messages));
    HF_TRY(allocate_job(j, messages));
    HF_TRY(pick_cables(j, messages));
    HF_TRY(hf_measured_read(o->measured, &p->scene, &p->model, p->settings.adjust.sigma_m, &j->measured, messages));
    HF_TRY(make_net(j, o, messages));
    HF_TRY(find_prior(j, o->file, messages));
    HF_TRY(find_least(j, messages));
    HF_TRY(find_figure(j, messages));
    HF_TRY(estimate_errors(j, o, messages));
    j->measured_m = measured_psi_m(j);
    HF_TRY(explain_failure(hf_adjust_find_cables(j), "the estimated net", o->file, messages));
    HF_TRY(
        explain_failure(hf_adjust_find(&j->estimate, &j->task, &j->adjustment), "the adjusted net", o->file, messages));
    HF_TRY(explain_failure(hf_adjust_find_instead(j), "the net with other adjustments", o->file, messages));
    static hf_file_out_set files; /* both table and page are written, or neither */
    hf_status status = HF_OK;
    if (o->output) status = hf_file_out_set_write(&files, o->output, hf_adjust_print_table, j, messages);
    if (status == HF_OK) status = hf_adjust_print_page(j, o, &files, messages);
    return hf_file_out_set_end(&files, status, messages);
}

/* Runs the command. Returns HF_OK, also if no adjustment is worthwhile. Returns HF_BAD_USAGE, HF_BAD_CASE for a faulty
 * case or table, HF_EXISTS, HF_IO, HF_NO_MEMORY, or the status of a shape that failed. */
static hf_status command_adjust(const hf_options *o, FILE *file, hf_messages *messages)
{
    if (!o->measured) return hf_error(messages, HF_BAD_USAGE, "'hifdm adjust' needs --measured FILE");
    static job j; /* too large for a small stack */
    memset(&j, 0, sizeof j);
    hf_status status = execute(&j, o, messages);
    if (o->json)
        hf_adjust_print_json(&j, o, status, messages->text, file);
    else if (status == HF_OK && !o->quiet)
        hf_adjust_print_summary(&j, o, file);
    job_free(&j);
    return status;
}

const hf_command hf_cmd_adjust = {
    .name = "adjust",
    .argument = "CASE",
    .help = "which turnbuckles to adjust, given measured positions of the as-built net",
    .about = "hifdm estimates the errors of the cut lengths from the measured positions of nodes and the section "
             "tolerance. Then it selects the fewest adjustments of the cables in adjust.set that reduce the figure. "
             "They are multiples of a step and stay within a range. The table lists them in the order in which you "
             "make them, with the tension of the cable before and after each, and the figure predicted after it.",
    .examples = "hifdm adjust case.yaml --measured nodes.csv -o moves.csv\n"
                "hifdm adjust case.yaml --measured nodes.csv --result case.h5 --report moves.html\n"
                "hifdm adjust case.yaml --result case.h5 --measured nodes.csv --set adjust.aim=target_positions\n"
                "hifdm adjust case.yaml --measured nodes.csv --json --set adjust.max_adjustments=5",
    .reads_results = true,
    .uses_threads = true,
    .run = command_adjust,
};
