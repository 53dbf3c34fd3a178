/* `hifdm adjust` estimates the errors of cutting lengths from measured positions of the as-built net. It then finds the
 * fewest turnbuckle adjustments that restore the figure of the net.
 *
 * in : nodes.csv id,x_m,y_m,z_m[,sigma_m]; the sections tolerance (sizes of errors) and adjust (cables that have a
 *      turnbuckle) of the case.
 * out: order,cable,set,turnbuckle_mm,tension_before_N,tension_after_N,predicted_rms_mm,expected_rms_mm. One row per
 *      adjustment, in the order in which they are made. A value above 0 makes the cable longer.
 *
 * Contents: the table - for people - for programs - the page - the command */
#include "app/built_design.h"
#include "app/output.h"

#include "base/csv.h"
#include "out/print.h"
#include "out/report.h"
#include "run/adjust_case.h"
#include "run/tolerance_stage.h"

#include <math.h>
#include <string.h>

#define SEEMS_OFF 2.0 /* sigmas above which a shared number is reported; there are few such numbers */
#define NAMED_MAX 10  /* maximum number of cables, and of shared numbers, in the summary */
#define NODES_MAX 3   /* maximum number of nodes in the summary */

typedef hf_adjust_case job;

/* ---- the table ---- */

static void print_table(const void *context, FILE *f)
{
    const job *j = context;
    const hf_adjustment *a = &j->adjustment;
    fputs("order,cable,set,turnbuckle_mm,tension_before_N,tension_after_N,predicted_rms_mm,expected_rms_mm\n", f);
    for (int k = 0; k < a->n_turnbuckle; k++) {
        const hf_adjust_turnbuckle *turned = &a->turnbuckle[k];
        fprintf(f, "%d,", k + 1);
        hf_csv_write_id(j->built.scene.cable_id[turned->cable], f);
        fprintf(f, ",%s,%.10g,%.6g,%.6g,%.6g,%.6g\n", j->task.settings->set, turned->turnbuckle_m * 1e3,
                turned->before_N, turned->after_N, turned->figure_m * 1e3, turned->expected_m * 1e3);
    }
}

/* ---- for people ---- */

/* Returns the word of an aim. Figures other than psi aim at the target surface. */
static const char *aim_word(hf_figure_kind figure, hf_aim aim)
{
    return hf_aim_word[figure == HF_FIGURE_PSI ? aim : HF_AIM_TARGET];
}

/* Prints the surface or positions from which the figure is measured. */
static void print_aim(const job *j, FILE *f)
{
    const hf_adjust_settings *s = j->task.settings;
    hf_print_text counted = hf_print_counted(j->built.model.n_inner_node, j->built.model.n_free);
    const char *where = j->load_case ? " in the nominal load case" : "";
    const char *of = *counted.text ? " of " : "";
    if (s->figure != HF_FIGURE_PSI)
        hf_print_line(f,
                      "%s: RMS along the normal of the target surface (the gain loss follows from the half-path RMS)",
                      hf_adjust_figure_word[s->figure]);
    else if (s->aim == HF_AIM_DESIGN)
        hf_print_line(
            f, "psi%s%s is measured from the design (adjust.aim), which is %.4f mm RMS from the target positions%s", of,
            counted.text, j->design_psi_m * 1e3, where);
    else
        hf_print_line(
            f, "psi%s%s is measured from the target positions (adjust.aim); the design is %.4f mm RMS from them%s", of,
            counted.text, j->design_psi_m * 1e3, where);
}

static void print_instead(const job *j, FILE *f)
{
    if (!j->n_instead) return;
    if (2 * j->n_at_range > j->adjustment.n_turnbuckle)
        hf_print_line(f,
                      "%d of %d adjustments are as large as adjust.range_m allows. Results with another figure or aim:",
                      j->n_at_range, j->adjustment.n_turnbuckle);
    else
        hf_print_line(f,
                      "the design is %.4f mm RMS from the target positions, and errors displace the nodes by %.4f mm "
                      "RMS. Results with another figure or aim:",
                      j->design_psi_m * 1e3, j->error_psi_m * 1e3);
    for (int k = 0; k < j->n_instead; k++) {
        const hf_adjust_case_instead *other = &j->instead[k];
        char name[64];
        snprintf(name, sizeof name, other->figure == HF_FIGURE_PSI ? "figure: psi, aim: %s" : "figure: %s",
                 other->figure == HF_FIGURE_PSI ? hf_aim_word[other->aim] : hf_adjust_figure_word[other->figure]);
        hf_print_line(f, "  adjust: {%s} changes %s from %.4f to %.4f mm by %d adjustment%s, %d at range_m", name,
                      hf_adjust_figure_word[other->figure], other->before_m * 1e3, other->after_m * 1e3,
                      other->n_turnbuckle, other->n_turnbuckle == 1 ? "" : "s", other->n_at_range);
    }
}

static const char *const end_word[] = {"target", "max_adjustments", "doubt", "none"};

/* Prints why there are no more adjustments. */
static void print_end(const job *j, FILE *f)
{
    const hf_adjust_settings *s = j->task.settings;
    switch (j->adjustment.end) {
    case HF_TURNBUCKLES_TARGET:
        if (j->adjustment.doubt_m[1] > s->target_m)
            hf_print_line(
                f, "no further adjustment: the most probable net meets target_m, but the expected value is %.4f mm",
                j->adjustment.doubt_m[1] * 1e3);
        else
            hf_print_line(f, "no further adjustment: target_m is met");
        break;
    case HF_TURNBUCKLES_ALL:
        hf_print_line(f, "no further adjustment: all %d are made (adjust.max_adjustments)", s->max_adjustments);
        break;
    case HF_TURNBUCKLES_DOUBT:
        hf_print_line(f, "no further adjustment: the measurement cannot resolve the gain of the next one");
        break;
    case HF_TURNBUCKLES_NONE:
        hf_print_line(f, "no further adjustment: none%s gains anything",
                      j->adjustment.is_held_taut ? " that the tensions allow" : "");
        break;
    }
    if (j->adjustment.is_held_taut)
        hf_print_line(f, "the adjustments leave each cable its minimum tension and make no other cable slack");
    if (j->adjustment.n_low)
        hf_print_line(f, "%d cable%s less than the required %.4g N already and may not lose tension",
                      j->adjustment.n_low, j->adjustment.n_low == 1 ? " has" : "s have", j->adjustment.low_N);
}

static const char *too_what(double error_m)
{
    return error_m > 0 ? " too long" : " too short";
}

/* Prints the cables that stand out. The sigma of a cable holds its estimate back, so its true error is larger. The
 * positions alone show how large. */
static void print_outliers(const job *j, FILE *f)
{
    for (int k = 0; k < j->n_out && k < NAMED_MAX; k++) {
        int e = j->out[k];
        double error = j->estimate.cut_m[e], alone = j->by_places_m[k];
        char by_positions[64] = "";
        if (isfinite(alone))
            snprintf(by_positions, sizeof by_positions, "; the positions alone indicate %.3g mm%s", fabs(alone) * 1e3,
                     error * alone < 0 ? too_what(alone) : "");
        hf_print_line(f, "cable '%s' seems %.3g mm%s, %.1f sigma%s", j->built.scene.cable_id[e], fabs(error) * 1e3,
                      too_what(error), fabs(hf_adjust_case_sigmas(j, e)), by_positions);
    }
    if (j->n_out > NAMED_MAX)
        hf_print_line(f, "and %d more cables beyond %g sigma", j->n_out - NAMED_MAX, HF_ADJUST_CASE_STANDS_OUT);
    if (j->n_out)
        hf_print_line(
            f, "  such errors are estimated too small (hifdm explain outlier): measure again after the adjustments");
}

/* Prints the measured nodes that are far from the estimated shape. */
static void print_places(const job *j, FILE *f)
{
    if (!j->n_far) return;
    hf_print_line(
        f,
        "%d of %d measured nodes %s more than %g sigma off the estimated shape and count fully (hifdm explain "
        "outlier); the worst:",
        j->n_far, j->measured.n_node, j->n_far == 1 ? "is" : "are", HF_ADJUST_CASE_OFF);
    for (int k = 0; k < j->n_far && k < NODES_MAX; k++) {
        int row = j->far_row[k];
        hf_print_line(f, "node '%s' (line %d): %.3g mm, %.1f sigma",
                      j->built.scene.node_id[j->built.model.node_of_row[row]], j->measured.line[row],
                      hf_adjust_case_off_m(j, row) * 1e3, hf_adjust_case_off_sigmas(j, row));
    }
}

/* Prints the numbers that the cables of a spool, or all cables, share, if they are not due to chance. */
static void print_numbers(const job *j, FILE *f)
{
    int n_off = 0;
    for (int k = 0; k < j->prior.n_shared; k++) {
        const hf_prior_number *n = &j->prior.number[k];
        double z = j->estimate.shared[k], error = z * n->sigma;
        if (fabs(z) <= SEEMS_OFF || n_off++ >= NAMED_MAX) continue;
        if (n->kind == HF_ERROR_TEMPERATURE)
            hf_print_line(f, "cables seem %.3g K %s than %s, %.1f sigma", fabs(error), error < 0 ? "colder" : "warmer",
                          j->load_case ? "in the load case" : "when they were cut", fabs(z));
        else
            hf_print_line(f, "spool '%s' seems to have an error of %+.3g of its %s, %.1f sigma", n->set, error,
                          n->kind == HF_ERROR_EA_BATCH ? "EA" : "lengths", fabs(z));
    }
    if (n_off > NAMED_MAX) hf_print_line(f, "and %d more shared errors beyond %g sigma", n_off - NAMED_MAX, SEEMS_OFF);
}

static void print_adjustments(const job *j, FILE *f)
{
    const hf_adjustment *a = &j->adjustment;
    int n_doubtful = 0;
    if (a->n_turnbuckle)
        hf_print_line(f, "turnbuckle adjustments for the workshop, in this order; above 0 lengthens the cable:");
    if (a->n_turnbuckle)
        hf_print_line(f, "%5s  %-20s %13s  %10s %10s  %10s %11s", "order", "cable", "turnbuckle mm", "N before",
                      "N after", "RMS mm", "expected mm");
    for (int k = 0; k < a->n_turnbuckle; k++) {
        const hf_adjust_turnbuckle *turned = &a->turnbuckle[k];
        char slack[32] = "", gain[64] = "";
        if (turned->n_slack) snprintf(slack, sizeof slack, "  %d slack", turned->n_slack);
        bool is_doubtful = turned->gain_m < turned->gain_sigma_m;
        if (is_doubtful)
            snprintf(gain, sizeof gain, "  gains %.4f +- %.4f", turned->gain_m * 1e3, turned->gain_sigma_m * 1e3);
        n_doubtful += is_doubtful;
        hf_print_line(f, "%5d  %-20s %+13.6g  %10.4g %10.4g  %10.4f %11.4f%s%s", k + 1,
                      j->built.scene.cable_id[turned->cable], turned->turnbuckle_m * 1e3, turned->before_N,
                      turned->after_N, turned->figure_m * 1e3, turned->expected_m * 1e3, slack, gain);
    }
    if (n_doubtful)
        hf_print_line(
            f,
            "the measurement cannot resolve the gain of %d of these adjustments at %s position in the order (hifdm "
            "explain gain_sigma_m)",
            n_doubtful, n_doubtful == 1 ? "its" : "their");
}

/* Prints the adjusted net in other load cases than that of the measurement. */
static void print_predictions(const job *j, FILE *f)
{
    if (!j->n_prediction) return;
    hf_print_line(f, "%-26s %13s %13s %10s %6s", "predicted in load case", "mm before", "mm after", "min N", "slack");
    for (int k = 0; k < j->n_prediction; k++) {
        const hf_adjust_case_prediction *p = &j->prediction[k];
        hf_print_line(f, "  %-24s %13.4f %13.4f %10.4g %6d", p->load_case, p->estimated_m * 1e3, p->adjusted_m * 1e3,
                      p->tension_min_N, p->n_slack);
    }
}

static void print_summary(const job *j, const hf_options *o, FILE *f)
{
    const hf_adjustment *a = &j->adjustment;
    const hf_tolerance_settings *t = &j->problem.settings.tolerance;
    const char *figure = hf_adjust_figure_word[j->task.settings->figure];
    if (!hf_adjust_case_fits(j))
        hf_print_line(f, "the measurement does not fit this net: do not trust the adjustments below");
    hf_print_line(f, "%d of %d nodes measured, chi^2 %.3g per coordinate (1 is expected); supports %s",
                  j->measured.n_node, j->built.model.n_node, hf_adjust_case_chi_square(j),
                  t->sigma_support_m > 0 ? "are estimated"
                                         : "are assumed at their positions in the case (no tolerance.sigma_support_m)");
    if (j->load_case)
        hf_print_line(f, "measured in load case '%s', for which all values up to the table of load cases are given",
                      j->load_case);
    print_aim(j, f);
    if (isfinite(j->measured_m)) hf_print_line(f, "%s measured    %.4f mm", figure, j->measured_m * 1e3);
    hf_print_line(f,
                  "%s estimated   %.4f mm; expected %.4f +- %.4f mm over all nets that fit the measurement; of the "
                  "design %.4f mm",
                  figure, a->estimated_m * 1e3, a->doubt_m[0] * 1e3, a->spread_m[0] * 1e3, a->nominal_m * 1e3);
    print_numbers(j, f);
    print_outliers(j, f);
    print_places(j, f);
    print_adjustments(j, f);
    hf_print_line(f,
                  "%s after %d adjustment%s %.4f mm; expected %.4f +- %.4f mm; a search over adjustments of all %d "
                  "cables, without minimum tensions, reached %.4f mm",
                  figure, a->n_turnbuckle, a->n_turnbuckle == 1 ? "" : "s", a->adjusted_m * 1e3, a->doubt_m[1] * 1e3,
                  a->spread_m[1] * 1e3, j->task.n_cable, a->best_m * 1e3);
    if (a->n_maybe_slack)
        hf_print_line(
            f,
            "%d of %d cables may be slack; positions do not show by how much a slack cable is too long (hifdm explain "
            "maybe_slack)",
            a->n_maybe_slack, j->built.model.n_cable);
    print_end(j, f);
    print_predictions(j, f);
    print_instead(j, f);
    if (o->output) hf_print_line(f, "adjustments in %s; above 0, the turnbuckle lets the cable out", o->output);
    if (o->report) hf_print_line(f, "report page: %s", o->report);
}

/* ---- for programs ---- */

static void print_json_adjustments(const job *from, hf_json *j)
{
    const hf_adjustment *a = &from->adjustment;
    hf_json_open_rows(j, "adjustments");
    for (int k = 0; k < a->n_turnbuckle; k++) {
        const hf_adjust_turnbuckle *turned = &a->turnbuckle[k];
        hf_json_open_row(j);
        hf_json_text(j, "cable", from->built.scene.cable_id[turned->cable]);
        HF_JSON_NUMBERS(j, {"steps", turned->steps}, {"turnbuckle_m", turned->turnbuckle_m},
                        {"tension_before_N", turned->before_N}, {"tension_after_N", turned->after_N},
                        {"predicted_m", turned->figure_m}, {"expected_m", turned->expected_m},
                        {"gain_m", turned->gain_m}, {"gain_sigma_m", turned->gain_sigma_m}, {"slack", turned->n_slack});
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
    hf_json_open_rows(j, "stand_out");
    for (int k = 0; k < from->n_out; k++) {
        hf_json_open_row(j);
        hf_json_text(j, "cable", from->built.scene.cable_id[from->out[k]]);
        HF_JSON_NUMBERS(j, {"error_m", from->estimate.cut_m[from->out[k]]},
                        {"sigmas", fabs(hf_adjust_case_sigmas(from, from->out[k]))},
                        {"by_positions_m", from->by_places_m[k]});
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
    hf_json_open_rows(j, "off_shape");
    for (int k = 0; k < from->n_far; k++) {
        hf_json_open_row(j);
        hf_json_text(j, "node", from->built.scene.node_id[from->built.model.node_of_row[from->far_row[k]]]);
        hf_json_number(j, "distance_m", hf_adjust_case_off_m(from, from->far_row[k]));
        hf_json_number(j, "sigmas", hf_adjust_case_off_sigmas(from, from->far_row[k]));
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

static void print_json_instead(const job *from, hf_json *j)
{
    hf_json_open_rows(j, "instead");
    for (int k = 0; k < from->n_instead; k++) {
        const hf_adjust_case_instead *other = &from->instead[k];
        hf_json_open_row(j);
        hf_json_text(j, "figure", hf_adjust_figure_word[other->figure]);
        hf_json_text(j, "aim", aim_word(other->figure, other->aim));
        HF_JSON_NUMBERS(j, {"before_m", other->before_m}, {"after_m", other->after_m},
                        {"adjustment_count", other->n_turnbuckle}, {"at_range", other->n_at_range});
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

static void print_json_predictions(const job *from, hf_json *j)
{
    hf_json_open_rows(j, "predictions");
    for (int k = 0; k < from->n_prediction; k++) {
        const hf_adjust_case_prediction *p = &from->prediction[k];
        hf_json_open_row(j);
        hf_json_text(j, "load_case", p->load_case);
        HF_JSON_NUMBERS(j, {"estimated_m", p->estimated_m}, {"adjusted_m", p->adjusted_m},
                        {"tension_min_N", p->tension_min_N}, {"slack", p->n_slack});
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

static void print_json_numbers(const job *from, hf_json *j)
{
    hf_json_open_rows(j, "shared");
    for (int k = 0; k < from->prior.n_shared; k++) {
        const hf_prior_number *n = &from->prior.number[k];
        hf_json_open_row(j);
        hf_json_text(j, "kind",
                     n->kind == HF_ERROR_TEMPERATURE ? "temperature_K"
                     : n->kind == HF_ERROR_EA_BATCH  ? "EA_ratio"
                                                     : "cut_ratio");
        if (n->set) hf_json_text(j, "set", n->set);
        hf_json_number(j, "error", from->estimate.shared[k] * n->sigma);
        hf_json_number(j, "sigmas", fabs(from->estimate.shared[k]));
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

/* Prints all findings except the error of each cable. */
static void print_json_findings(const job *from, hf_json *j)
{
    const hf_adjustment *a = &from->adjustment;
    hf_json_line(j, " ");
    hf_json_text(j, "figure", hf_adjust_figure_word[from->task.settings->figure]);
    hf_json_text(j, "aim", aim_word(from->task.settings->figure, from->task.settings->aim));
    if (from->load_case) hf_json_text(j, "load_case", from->load_case);
    hf_json_integer(j, "measured_nodes", from->measured.n_node);
    hf_json_number(j, "chi_square", hf_adjust_case_chi_square(from));
    hf_json_bool(j, "fits", hf_adjust_case_fits(from));
    HF_JSON_NUMBERS(j, {"cables", from->task.n_cable}, {"nominal_m", a->nominal_m}, {"measured_m", from->measured_m},
                    {"estimated_m", a->estimated_m}, {"adjusted_m", a->adjusted_m}, {"best_m", a->best_m});
    hf_json_line(j, " ");
    HF_JSON_NUMBERS(j, {"estimated_expected_m", a->doubt_m[0]}, {"estimated_sigma_m", a->spread_m[0]},
                    {"adjusted_expected_m", a->doubt_m[1]}, {"adjusted_sigma_m", a->spread_m[1]});
    hf_json_line(j, " ");
    hf_json_text(j, "end", end_word[a->end]);
    hf_json_bool(j, "held_taut", a->is_held_taut);
    hf_json_integer(j, "maybe_slack", a->n_maybe_slack);
    hf_json_bool(j, "supports_estimated", from->problem.settings.tolerance.sigma_support_m > 0);
    HF_JSON_NUMBERS(j, {"design_psi_m", from->design_psi_m}, {"error_psi_m", from->error_psi_m},
                    {"at_range", from->n_at_range}, {"estimate_steps", from->estimate.n_step}, {"rounds", a->n_round});
    hf_json_bool(j, "settled", from->estimate.is_settled && a->is_settled);
    print_json_adjustments(from, j);
    print_json_instead(from, j);
    if (from->n_prediction) print_json_predictions(from, j);
    print_json_numbers(from, j);
}

static void print_json(const job *from, const hf_options *o, hf_status status, const char *messages, FILE *f)
{
    hf_json j = {.file = f};
    hf_json_open(&j, NULL, '{');
    hf_json_text(&j, "status", hf_status_word(status));
    if (status == HF_OK) {
        print_json_findings(from, &j);
        hf_json_open_line(&j, " ", "errors_m", '{');
        for (int e = 0; e < from->built.model.n_cable; e++) {
            if (e % 4 == 0) hf_json_line(&j, "  ");
            hf_json_number(&j, from->built.scene.cable_id[e], from->estimate.cut_m[e]);
        }
        hf_json_close(&j, '}');
    }
    hf_json_line(&j, " ");
    hf_json_text(&j, "version", hf_store_version());
    hf_json_text(&j, "case", from->problem.settings.path);
    if (o->result) hf_json_text(&j, "result", o->result);
    if (status == HF_OK && o->output) hf_json_text(&j, "file", o->output);
    hf_json_end(&j, status != HF_OK, messages);
}

/* ---- the page ---- */

static void write_part(const void *context, hf_json *j)
{
    const job *from = context;
    const hf_adjust_settings *s = from->task.settings;
    hf_json_text(j, "set", s->set);
    hf_json_number(j, "target_m", s->target_m);
    hf_json_bool(j, "fits", hf_adjust_case_fits(from));
    print_json_findings(from, j);
    hf_json_pack_values("error_m", "f64", from->estimate.cut_m, from->built.model.n_cable, j->file);
}

/* ---- the command ---- */

static hf_status check_outputs(const job *j, const hf_options *o, hf_messages *messages)
{
    if (o->report && !o->result)
        return hf_error(messages, HF_BAD_USAGE,
                        "the option --report %s needs --result FILE with the result of this case. To compute this "
                        "result, use 'hifdm run %s'",
                        o->report, o->file);
    if (o->output && o->report && !strcmp(o->output, o->report))
        return hf_error(messages, HF_BAD_USAGE,
                        "the options -o and --report both name the file %s. Use different names", o->output);
    HF_TRY(hf_output_check(o, &j->problem, o->measured, o->output, messages));
    HF_TRY(hf_file_out_spare(o->output, "the table of adjustments", o->report ? o->report : "", messages));
    return hf_output_check(o, &j->problem, o->measured, o->report, messages);
}

static hf_status execute(job *j, const hf_options *o, hf_messages *messages)
{
    static hf_file_out_set files; /* both table and page are written, or neither */
    const hf_report_part part = {"adjust", write_part, j, &files};
    HF_TRY(hf_adjust_case_load(o->file, o->set, o->n_set, o->load_case, j, messages));
    HF_TRY(hf_built_design_check(o, &j->problem.settings, messages));
    HF_TRY(check_outputs(j, o, messages));
    HF_TRY(hf_adjust_case_read(o->measured, o->threads, j, messages));
    HF_TRY(hf_built_design_make(o, &j->problem, &j->built, messages));
    HF_TRY(hf_adjust_case_find(j, messages));
    hf_status status = HF_OK;
    if (o->output) status = hf_file_out_set_write(&files, o->output, print_table, j, messages);
    if (status == HF_OK && o->report) status = hf_report_result(o->result, NULL, &part, o->report, messages);
    return hf_file_out_set_end(&files, status, messages);
}

/* Runs the command. Returns HF_OK, also if no adjustment is worthwhile. Returns HF_BAD_USAGE, HF_BAD_CASE for a faulty
 * case or table, HF_EXISTS, HF_IO, HF_NO_MEMORY, or the status of a shape that failed. */
static hf_status command_adjust(const hf_options *o, FILE *file, hf_messages *messages)
{
    if (!o->measured) return hf_error(messages, HF_BAD_USAGE, "'hifdm adjust' needs the option --measured FILE");
    static job j; /* too large for a small stack */
    memset(&j, 0, sizeof j);
    hf_status status = execute(&j, o, messages);
    if (o->json)
        print_json(&j, o, status, messages->text, file);
    else if (status == HF_OK && !o->quiet)
        print_summary(&j, o, file);
    hf_adjust_case_free(&j);
    return status;
}

const hf_command hf_cmd_adjust = {
    .name = "adjust",
    .argument = "CASE",
    .help = "compute turnbuckle adjustments from measured node positions of the as-built net",
    .about = "hifdm estimates the errors of the cutting lengths from the measured node positions and the `tolerance` "
             "section of the case. From these errors, hifdm selects a few adjustments that minimise the RMS error "
             "adjust.figure. hifdm considers only cables in the set adjust.set. Each adjustment is a multiple of the "
             "step adjust.step_m within the range adjust.range_m. Make the adjustments in the order of the table. Each "
             "row of the table gives the cable tension before and after the adjustment. The row also gives the "
             "predicted RMS error after the adjustment.",
    .examples = "hifdm adjust case.yaml --measured nodes.csv -o moves.csv\n"
                "hifdm adjust case.yaml --measured nodes.csv --result case.h5 --report moves.html\n"
                "hifdm adjust case.yaml --result case.h5 --measured nodes.csv --set adjust.aim=target_positions\n"
                "hifdm adjust case.yaml --measured nodes.csv --json --set adjust.max_adjustments=5",
    .reads_results = true,
    .uses_threads = true,
    .run = command_adjust,
};
