/* Prints the summary of a result. Contents: the answer, the table of stages, surface, front, load cases and truss, the
 * whole summary. */
#include "out/print_summary.h"
#include "base/text.h"
#include "store/ledger.h"
#include <hifdm/store.h>

#include <math.h>
#include <string.h>

/* ---- the answer ---- */

#define OBJECTIVES_SHOWN 4     /* objectives in the first line */
#define FREQUENCY_MOST_HZ 1e12 /* higher frequencies come from errors that are only rounding */
#define BETTER_FIT 1.01        /* ratio of surface errors that is worth a line */
#define MORE_LOSS_DB 0.001     /* more gain loss that is worth a line */
#define SAME_SCALE 1e-9        /* relative difference of factors by rounding */
#define MOVED_M 1e-6           /* displacement of uncounted nodes that is worth a word */

/* Returns the result of a stage, and that of the form-finding without one (HF_N_STAGE). */
static const hf_form_result *result_of(const hf_summary *s, hf_stage stage)
{
    return &s->stage[stage == HF_N_STAGE ? HF_STAGE_FORM : stage].result;
}

static bool has_merit(const hf_summary *s)
{
    return s->objectives.n > 0 && !s->objectives.is_front;
}

/* Formats a gain loss by physical optics. */
static hf_print_text optics_text(double loss_dB, int digits)
{
    hf_print_text t = {"-"};
    if (isfinite(loss_dB)) snprintf(t.text, sizeof t.text, "%.*g", digits, hf_print_loss_dB(loss_dB));
    return t;
}

/* Prints the gain loss by physical optics at the highest frequency of the case. Without one, prints the frequency of
 * 1 dB gain loss by Ruze's formula, from the errors of the facets where they are measured, otherwise from those of the
 * nodes. Without a surface it uses psi, which to first order is at least the half-path RMS of the nodes (METHOD section
 * 9). */
static void print_frequency(const hf_summary *s, hf_stage stage, double psi_m, FILE *f)
{
    const hf_surface_measures *m = &s->stage[stage].surface;
    bool has_facets = m->is_measured && m->n_facet > 0 && isfinite(m->facet_half_path_rms_m);
    hf_surface_errors e = {.half_path_rms_m = psi_m, .fit_half_path_rms_m = (double)NAN};
    int k = hf_print_highest_optics(s, m);
    if (k >= 0) {
        fprintf(f, "; gain loss at %g GHz %s dB for a refocused feed, %s dB for a fixed feed (physical optics)",
                s->surface.frequencies_Hz.value[k] / 1e9, optics_text(m->refocused_gain_loss_dB[k], 3).text,
                optics_text(m->fixed_gain_loss_dB[k], 3).text);
        return;
    }
    if (m->is_measured) e = hf_surface_errors_of(m, has_facets);
    if (has_facets && isfinite(m->refocused_half_path_rms_m)) {
        e.half_path_rms_m = m->fixed_half_path_rms_m;
        e.fit_half_path_rms_m = m->refocused_half_path_rms_m;
    }
    double raw_Hz = hf_surface_frequency_of_loss_Hz(e.half_path_rms_m, HF_SURFACE_GOOD_TO_DB);
    double fit_Hz = hf_surface_frequency_of_loss_Hz(e.fit_half_path_rms_m, HF_SURFACE_GOOD_TO_DB);
    if (!(raw_Hz < FREQUENCY_MOST_HZ)) return;
    fprintf(f, "; %g dB gain loss at ", HF_SURFACE_GOOD_TO_DB);
    if (fit_Hz < FREQUENCY_MOST_HZ) fprintf(f, "%.3g GHz for a refocused feed, at ", fit_Hz / 1e9);
    fprintf(f, "%.3g GHz for a fixed feed", raw_Hz / 1e9);
    fputs(has_facets       ? " (Ruze, from the facets)"
          : m->is_measured ? " (Ruze, from the nodes)"
                           : " (Ruze, from psi)",
          f);
}

/* Prints the reduction of psi by the optimisation. A search evaluates the initial design under its rule, so that design
 * differs from the best one only in the tensions. Without a search only psi after form-finding is known. It may differ,
 * for example if boundary cables keep their lengths in the form-finding. */
static void print_gained(const hf_summary *s, hf_stage stage, FILE *f)
{
    const hf_form_result *r = result_of(s, stage);
    bool is_searched = s->stage[HF_STAGE_SEARCH].exists && isfinite(s->search.initial_psi_m);
    if (stage == HF_STAGE_FORM || s->objectives.is_front) return;
    if (stage == HF_STAGE_SEARCH || is_searched)
        hf_print_gained(r->psi_m, s->search.initial_psi_m, "for the initial design", f);
    else
        hf_print_gained(r->psi_m, s->stage[HF_STAGE_FORM].result.psi_m, "after form-finding", f);
}

/* Prints the value of an objective, lengths in mm. */
static void print_objective_value(double value, const char *unit, FILE *f)
{
    if (!isfinite(value))
        fputc('-', f);
    else if (!strcmp(unit, "m"))
        fputs(hf_print_decimals(value * 1e3).text, f);
    else
        fprintf(f, "%.4g", value);
}

static void print_objective_unit(const char *unit, FILE *f)
{
    if (*unit) fprintf(f, " %s", !strcmp(unit, "m") ? "mm" : unit);
}

/* Returns whether psi of the design itself is an objective. */
static bool minimises_psi(const hf_summary *s)
{
    for (int k = 0; k < s->objectives.n; k++)
        if (!strcmp(hf_ledger_objective(s->objectives.name[k]), hf_figure_kind_word[HF_FIGURE_PSI])) return true;
    return false;
}

/* Returns "11 of 59 free nodes" if psi does not count all of them, else "". */
static hf_print_text counted_text(const hf_summary *s, const hf_form_result *r)
{
    hf_print_text t = hf_print_counted(s->n_inner_node, s->n_free);
    if (*t.text && r->n_loose) hf_text_append(t.text, sizeof t.text, ", ", "without loose ones", "");
    return t;
}

/* Prints the objectives of the form-finding and of the result, in their units: "facets 1.7436 -> 1.4720 mm". */
static void print_objectives_gained(const hf_summary *s, const hf_form_result *r, FILE *f)
{
    for (int k = 0; k < s->objectives.n && k < OBJECTIVES_SHOWN; k++) {
        const char *unit = hf_ledger_objective_unit(s->objectives.name[k]);
        fprintf(f, "%s%s ", k ? ", " : "", hf_ledger_objective(s->objectives.name[k]));
        print_objective_value(s->stage[HF_STAGE_FORM].result.objective[k], unit, f);
        fputs(" -> ", f);
        print_objective_value(r->objective[k], unit, f);
        print_objective_unit(unit, f);
    }
    if (s->objectives.n > OBJECTIVES_SHOWN) fprintf(f, " and %d more", s->objectives.n - OBJECTIVES_SHOWN);
    hf_print_text counted = counted_text(s, r);
    bool is_part = *counted.text != '\0';
    if (minimises_psi(s)) {
        fprintf(f, " (form-finding -> result%s%s)", is_part ? "; psi of " : "", counted.text);
        return;
    }
    fprintf(f, " (form-finding -> result); psi %s%s%s", is_part ? "of " : "", counted.text, is_part ? " " : "");
    print_objective_value(s->stage[HF_STAGE_FORM].result.psi_m, "m", f);
    fputs(" -> ", f);
    print_objective_value(r->psi_m, "m", f);
    fputs(" mm, which includes displacements within the surface", f);
}

/* Prints "Pareto front of 21 points: minimum psi 4.2834 mm, minimum ratio_boundary 4.56". */
static void print_front_answer(const hf_summary *s, FILE *f)
{
    const char *before = "";
    bool is_one = hf_front_agrees(s->front);
    if (is_one)
        fputs("one design is best in all objectives:", f);
    else
        fprintf(f, "Pareto front of %d points:", s->front->n_point);
    for (int k = 0; k < s->front->n_objective; k++) {
        const char *unit = hf_ledger_objective_unit(s->objectives.name[k]);
        if (s->front->end[k] < 0) continue;
        fprintf(f, "%s%s %s ", before, is_one ? "" : " minimum", hf_ledger_objective(s->objectives.name[k]));
        print_objective_value(s->front->row[s->front->end[k]].objective[k], unit, f);
        print_objective_unit(unit, f);
        before = ",";
    }
}

/* Prints why a run failed after a successful form-finding, and which design its figures describe. When the user has
 * the error already, or the stored warnings contain none, for example because they were cut, it prints the text of the
 * status. */
static void print_failure(const hf_summary *s, hf_stage stage, bool has_error, FILE *f)
{
    char why[HF_WARNINGS_SIZE], shown[HF_WARNINGS_SIZE];
    const char *status = hf_status_text(s->status);
    const char *line = has_error ? status : hf_text_first_error(s->warnings, status);
    if (!s->finished || s->status == HF_OK || s->stage[HF_STAGE_FORM].result.status != HF_OK) return;
    snprintf(why, sizeof why, "%.*s", (int)strcspn(line, "\n"), line);
    hf_text_escape(why, shown, sizeof shown);
    fprintf(f, "failed: %s; ", shown);
    if (!s->front) fputs(stage == HF_STAGE_FORM ? "the form-finding has " : "the design has ", f);
}

static void print_answer(const hf_summary *s, bool has_error, FILE *f)
{
    hf_stage stage = hf_store_result_stage(s);
    const hf_form_result *r = result_of(s, stage);
    if (!s->finished) fputs("unfinished: ", f);
    print_failure(s, stage, has_error, f);
    if (r->status == HF_NOT_CONVERGED) fputs("not converged: ", f);
    if (r->status != HF_OK && r->status != HF_NOT_CONVERGED) {
        fprintf(f, "no shape: %s", hf_status_text(r->status));
        return;
    }
    if (s->front) {
        print_front_answer(s, f);
        return;
    }
    bool is_psi_all = s->objectives.n == 1 && minimises_psi(s);
    if ((has_merit(s) || s->taken.point) && stage != HF_STAGE_FORM && !is_psi_all) {
        print_objectives_gained(s, r, f);
    } else if (r->status == HF_OK && !isfinite(r->psi_m)) { /* loose nodes have no psi: their positions were assigned */
        fputs("no psi: no taut cable holds an inner node", f);
        return;
    } else {
        hf_print_text counted = counted_text(s, r);
        fprintf(f, "psi %s mm (RMS position error of %s)%s", hf_print_decimals(r->psi_m * 1e3).text,
                *counted.text ? counted.text : "the inner nodes", stage == HF_STAGE_REFINE ? " after refinement" : "");
        print_gained(s, stage, f);
    }
    if (r->status == HF_OK) print_frequency(s, stage, r->psi_m, f);
}

void hf_print_answer(const hf_summary *s, FILE *f)
{
    print_answer(s, false, f);
}

/* ---- the table of stages ---- */

static void print_bound(const hf_form_result *r, FILE *f)
{
    char text[32] = "-";
    if (r->bound_reason == HF_BOUND_CERTIFIED)
        snprintf(text, sizeof text, "%.1e m", r->position_bound_m);
    else if (r->bound_reason != HF_BOUND_NONE)
        snprintf(text, sizeof text, "no: %s", hf_bound_reason_word((int)r->bound_reason));
    fprintf(f, "  %-12s", text);
}

/* Prints the row of a stage except how it ended. at_bounds is the number of variables at their bounds, negative for a
 * shape without a design. */
static void print_figures(const hf_summary *s, const char *name, const hf_form_result *r, int at_bounds, FILE *f)
{
    char bounds[40] = "-";
    if (at_bounds >= 0) snprintf(bounds, sizeof bounds, "%d of %d", at_bounds, s->n_variable);
    fprintf(f, "  %-13s %9s  %14s  %12s", name, hf_print_decimals(r->psi_m * 1e3).text,
            hf_print_decimals(r->boundary_tension_ratio).text, hf_print_decimals(r->inner_tension_ratio).text);
    if (has_merit(s)) fprintf(f, "  %12.6g", r->merit);
    fprintf(f, "  %9s", bounds);
    print_bound(r, f);
    if (r->n_slack) fprintf(f, "  %d slack cable%s;", r->n_slack, r->n_slack == 1 ? "" : "s");
    if (r->n_loose) fprintf(f, "  %d loose node%s;", r->n_loose, r->n_loose == 1 ? "" : "s");
}

static void print_search(const hf_summary *s, bool is_result, FILE *f)
{
    if (s->stage[HF_STAGE_SEARCH].result.status != HF_OK) {
        fprintf(f, "  search        no feasible design in %ld evaluations%s\n", s->search.evaluations,
                s->finished ? "" : " so far");
        return;
    }
    bool is_ga = !strcmp(hf_summary_algorithm(s, HF_STAGE_SEARCH), "ga");
    int n_at_bound = s->finished ? s->search.n_at_lower + s->search.n_at_upper : -1; /* counted at the end */
    print_figures(s, "search", &s->stage[HF_STAGE_SEARCH].result, n_at_bound, f);
    if (s->objectives.is_front)
        fprintf(f, "  minimum %s, ", hf_ledger_objective(s->objectives.name[0]));
    else if (is_result)
        fputs("  the result, ", f);
    else
        fputs("  ", f);
    fprintf(f, "%s: ", is_ga ? "GA" : "NSGA-II");
    hf_print_generations(&s->search, f);
    if (s->search.infeasible)
        fprintf(f, ", %ld of %ld designs infeasible", s->search.infeasible, s->search.evaluations);
    if (!s->finished) {
        fputs(" so far\n", f);
        return;
    }
    fprintf(f, ", %s\n", hf_print_duration(s->stage[HF_STAGE_SEARCH].wall_s).text);
}

static void print_refine(const hf_summary *s, bool is_result, FILE *f)
{
    int n_at_bound = s->refine.n_at_lower + s->refine.n_at_upper;
    if (s->taken.point) {
        print_figures(s, "point", &s->stage[HF_STAGE_REFINE].result, n_at_bound, f);
        hf_print_line(f, "  the result, point %d of the front in %s", s->taken.point, s->taken.path);
        return;
    }
    print_figures(s, "refine", &s->stage[HF_STAGE_REFINE].result, n_at_bound, f);
    fprintf(f, "  %s, LM: ", is_result ? "the result" : "no better than the search");
    hf_print_steps(&s->refine, f);
    fprintf(f, ", %s\n", hf_print_duration(s->stage[HF_STAGE_REFINE].wall_s).text);
    hf_print_optima(s, f);
}

static void print_stages(const hf_summary *s, hf_stage result, bool is_short, FILE *f)
{
    fprintf(f, "  %-13s %9s  %14s  %12s%s  %9s  %s\n", "stage", "psi mm", "boundary ratio", "ratio inside",
            has_merit(s) ? "         merit" : "", "at bounds", "certified to");
    print_figures(s, "form", &s->stage[HF_STAGE_FORM].result, -1, f);
    fputs("  ", f);
    hf_print_iterations(&s->stage[HF_STAGE_FORM].result, f);
    fprintf(f, ", %s\n", hf_print_duration(s->stage[HF_STAGE_FORM].wall_s).text);
    if (s->stage[HF_STAGE_SEARCH].exists) print_search(s, result == HF_STAGE_SEARCH, f);
    if (s->stage[HF_STAGE_SEARCH].exists && (!is_short || result == HF_STAGE_SEARCH))
        hf_print_held(s->stage[HF_STAGE_SEARCH].held, f);
    if (s->stage[HF_STAGE_REFINE].exists) print_refine(s, result == HF_STAGE_REFINE, f);
    if (s->stage[HF_STAGE_REFINE].exists && (!is_short || result == HF_STAGE_REFINE))
        hf_print_held(s->stage[HF_STAGE_REFINE].held, f);
    if (s->objectives.n > 0 && !is_short) hf_print_objectives(s, result_of(s, result), f);
}

/* ---- surface ---- */

/* Formats a gain loss. One without a value is outside the range of Ruze's formula if the surface error has a value,
 * otherwise it is unknown. */
static hf_print_text loss_text(double rms_m, double loss_dB, int digits)
{
    hf_print_text t = {"-"};
    if (isfinite(rms_m) && isnan(loss_dB))
        snprintf(t.text, sizeof t.text, "above %g", HF_RUZE_MOST_DB);
    else if (isfinite(loss_dB))
        snprintf(t.text, sizeof t.text, "%.*g", digits, hf_print_loss_dB(loss_dB));
    return t;
}

static void print_losses(const hf_summary *s, double rms_m, const double *loss_dB, FILE *f)
{
    for (int k = 0; k < s->surface.frequencies_Hz.n; k++)
        fprintf(f, "%s%s", k ? "/" : "", loss_text(rms_m, loss_dB[k], 3).text);
}

static void print_optics(const hf_summary *s, const double *loss_dB, FILE *f)
{
    for (int k = 0; k < s->surface.frequencies_Hz.n; k++)
        fprintf(f, "%s%s", k ? "/" : "", optics_text(loss_dB[k], 3).text);
}

static void print_beam(const hf_summary *s, const hf_surface_measures *m, FILE *f)
{
    fputs("; beam off by ", f);
    for (int k = 0; k < s->surface.frequencies_Hz.n; k++)
        fprintf(f, "%s%s", k ? "/" : "", hf_print_decimals(m->pointing_deg[k]).text);
    fputs(" deg for a fixed feed", f);
}

/* Prints the losses by physical optics, then those by Ruze's formula and the angles of the beam. */
static void print_both_feeds(const hf_summary *s, const hf_surface_measures *m, FILE *f)
{
    print_optics(s, m->refocused_gain_loss_dB, f);
    fputs(" dB for a refocused feed, ", f);
    print_optics(s, m->fixed_gain_loss_dB, f);
    fputs(" dB for a fixed feed (physical optics; by Ruze ", f);
    print_losses(s, m->refocused_half_path_rms_m, m->refocused_ruze_loss_dB, f);
    fputs(" and ", f);
    print_losses(s, m->fixed_half_path_rms_m, m->fixed_ruze_loss_dB, f);
    fputs(" dB)", f);
    print_beam(s, m, f);
}

void hf_print_gain_loss(const hf_summary *s, FILE *f)
{
    hf_stage stage = hf_store_result_stage(s);
    if (stage == HF_N_STAGE || !s->stage[stage].surface.is_measured || s->surface.frequencies_Hz.n == 0) return;
    const hf_surface_measures *m = &s->stage[stage].surface;
    fputs("gain loss at ", f);
    for (int k = 0; k < s->surface.frequencies_Hz.n; k++)
        fprintf(f, "%s%g", k ? "/" : "", s->surface.frequencies_Hz.value[k] / 1e9);
    fputs(" GHz: ", f);
    hf_surface_errors e = hf_surface_errors_of(m, m->n_facet > 0);
    if (hf_print_highest_optics(s, m) >= 0) {
        print_both_feeds(s, m, f);
        return;
    }
    print_losses(s, e.fit_half_path_rms_m, e.fit_gain_loss_dB, f);
    fputs(" dB for a refocused feed, ", f);
    print_losses(s, e.half_path_rms_m, e.gain_loss_dB, f);
    fputs(" dB for a fixed feed (Ruze)", f);
}

/* Prints a line when the optimisation has made the reflector worse for a refocused feed: its gain loss by physical
 * optics, or without one its error after the best fit. This happens with objectives that measure the reflector for a
 * fixed feed, not repointed and refocused. */
static void print_better_fit(const hf_summary *s, hf_stage stage, FILE *f)
{
    const hf_surface_measures *before = &s->stage[HF_STAGE_FORM].surface, *m = &s->stage[stage].surface;
    if (stage == HF_STAGE_FORM || s->front || s->stage[HF_STAGE_FORM].result.status != HF_OK || !before->is_measured)
        return;
    bool has_facets = m->n_facet > 0;
    int k = hf_print_highest_optics(s, m);
    double rms_m = hf_surface_errors_of(m, has_facets).fit_half_path_rms_m,
           before_m = hf_surface_errors_of(before, has_facets).fit_half_path_rms_m;
    double before_Hz = hf_surface_frequency_of_loss_Hz(before_m, HF_SURFACE_GOOD_TO_DB);
    bool is_worse = k >= 0 ? m->refocused_gain_loss_dB[k] > before->refocused_gain_loss_dB[k] + MORE_LOSS_DB
                           : before_Hz < FREQUENCY_MOST_HZ && rms_m > BETTER_FIT * before_m;
    if (!is_worse) return;
    fputs("                for a refocused feed, the net of the form-finding is better: ", f);
    if (k >= 0)
        fprintf(f, "gain loss %s dB at %g GHz", optics_text(before->refocused_gain_loss_dB[k], 3).text,
                s->surface.frequencies_Hz.value[k] / 1e9);
    else
        fprintf(f, "%g dB gain loss at %.3g GHz", HF_SURFACE_GOOD_TO_DB, before_Hz / 1e9);
    fprintf(f, ". To minimise this error, use {figure: %s, feed: refocused} and {figure: psi, weight: 0.3}\n",
            has_facets ? "facets" : "surface");
}

/* Prints the surface errors of the nodes of the result and of its facets, if there are any, and the gain losses. The
 * short form leaves those to the answer. */
static void print_errors(const hf_summary *s, hf_stage stage, bool is_short, FILE *f)
{
    const hf_surface_measures *m = &s->stage[stage].surface;
    if (!m->is_measured) return;
    fprintf(f, "  surface       half-path RMS of the nodes %s mm for a fixed feed, %s mm after best fit",
            hf_print_decimals(m->half_path_rms_m * 1e3).text, hf_print_decimals(m->fit.half_path_rms_m * 1e3).text);
    if (m->n_facet)
        fprintf(f, "; of %d facets %s mm, %s mm after best fit", m->n_facet,
                hf_print_decimals(m->facet_half_path_rms_m * 1e3).text,
                hf_print_decimals(m->facet_fit_half_path_rms_m * 1e3).text);
    if (is_short && hf_print_highest_optics(s, m) >= 0) print_beam(s, m, f);
    fputc('\n', f);
    if (is_short) return;
    if (s->surface.frequencies_Hz.n > 0) {
        fputs("                ", f);
        hf_print_gain_loss(s, f);
        fputc('\n', f);
    }
    print_better_fit(s, stage, f);
}

/* ---- front, load cases, truss ---- */

/* Returns the factor of objective k for display and sets *unit, "unit" when it has none. */
static double front_unit(const hf_summary *s, int k, const char **unit)
{
    double scale = hf_print_scale(hf_ledger_objective_unit(s->objectives.name[k]), unit);
    if (!**unit) *unit = "unit";
    return scale;
}

static void print_slope_head(const hf_summary *s, int k, FILE *f)
{
    const char *of, *per;
    bool is_plain = front_unit(s, s->front->minimised, &of) == 1;
    front_unit(s, k, &per);
    fprintf(f, "; slope: change of %s%s%s per %s of %s", s->objectives.name[s->front->minimised],
            is_plain ? "" : " in ", is_plain ? "" : of, per, s->objectives.name[k]);
}

/* Prints the verdicts of a point: "; passes", "; fails 2 of 5" or "; 1 of 5 undecided". */
static void print_front_verdict(const hf_judgement *of, FILE *f)
{
    hf_verdict verdict = hf_judgement_verdict(of);
    if (verdict == HF_VERDICT_PASS) fputs("; passes", f);
    if (verdict == HF_VERDICT_FAIL) fprintf(f, "; fails %d of %d", of->n_failed, of->n_required);
    if (verdict == HF_VERDICT_UNDECIDED) fprintf(f, "; %d of %d undecided", of->n_undecided, of->n_required);
}

/* Prints one line of the front: the values of a point and, where known, the changes of the minimised objective per unit
 * of the others. number is that of the point, from 1. Without a point, it is the initial design. */
static void print_front_values(const hf_summary *s, const char *name, int number, const double *objective,
                               const hf_front_point *p, FILE *f)
{
    const hf_front_table *t = s->front;
    char what[32];
    snprintf(what, sizeof what, number ? "%s, point %d" : "%s", name, number);
    fprintf(f, "                %-15s", what);
    for (int k = 0; k < t->n_objective; k++)
        hf_print_objective(k ? ", " : " ", s->objectives.name[k], objective[k], false, f);
    for (int k = 0; k < t->n_objective && p && t->minimised >= 0; k++) {
        const char *unit;
        if (k == t->minimised || !isfinite(p->multiplier[k])) continue;
        double scale = front_unit(s, t->minimised, &unit) / front_unit(s, k, &unit);
        fprintf(f, "; slope %.4g", p->multiplier[k] > 0 ? -p->multiplier[k] * scale : 0.0);
    }
    if (p) print_front_verdict(&p->judgement, f);
    if (p && t->minimised >= 0 && !p->is_converged) fputs("; not converged", f);
    fputc('\n', f);
}

static void print_front_point(const hf_summary *s, const char *name, int row, FILE *f)
{
    const hf_front_point *p = &s->front->row[row];
    print_front_values(s, name, s->front->index[row] + 1, p->objective, p, f);
}

/* Prints the point that ranks first by its verdicts, unless it is already printed as the knee or an end. */
static void print_front_first(const hf_summary *s, bool is_short, FILE *f)
{
    const hf_front_table *t = s->front;
    bool is_shown = t->knee >= 0 && t->index[t->knee] == t->suggested;
    for (int k = 0; k < t->n_objective && !is_short; k++)
        is_shown |= t->end[k] >= 0 && t->index[t->end[k]] == t->suggested;
    if (!is_shown) print_front_values(s, "first", t->suggested + 1, t->first.objective, &t->first, f);
}

/* Prints how many points pass. */
static void print_front_verdicts(const hf_summary *s, FILE *f)
{
    const int *n = s->front->n_verdict;
    fprintf(f, "; requirements: %d pass, %d fail, %d undecided", n[HF_VERDICT_PASS], n[HF_VERDICT_FAIL],
            n[HF_VERDICT_UNDECIDED]);
}

/* Prints the numbers of points of the front and the units of the slopes. */
static void print_front_counts(const hf_summary *s, FILE *f)
{
    const hf_front_table *t = s->front;
    char rough[40] = "";
    if (t->n_unconverged > 0) snprintf(rough, sizeof rough, ", %d not converged", t->n_unconverged);
    fprintf(f, "  front         %d points, %d dominated, %d failed%s", t->n_point, t->n_dominated, t->n_failed, rough);
    if (hf_front_is_judged(t)) print_front_verdicts(s, f);
    fprintf(f, "; %s", hf_print_duration(t->wall_s).text);
    for (int k = 0; k < t->n_objective && t->minimised >= 0; k++)
        if (k != t->minimised) print_slope_head(s, k, f);
    fputc('\n', f);
    if (t->n_row < t->n_point)
        fprintf(f, "                --json and the report show %d of %d points; hifdm export --front writes all\n",
                t->n_row, t->n_point);
}

static void print_front(const hf_summary *s, const char *path, bool is_short, FILE *f)
{
    const hf_front_table *t = s->front;
    bool is_one = hf_front_agrees(t);
    int point = hf_front_suggested(t);
    if (is_one)
        fputs("  front         the objectives do not conflict: one design is best in all of them\n", f);
    else
        print_front_counts(s, f);
    if (isfinite(t->initial[0]) && !is_short) print_front_values(s, "initial", 0, t->initial, NULL, f);
    if (is_one) print_front_point(s, "best", t->end[0], f);
    for (int k = 0; k < t->n_objective && !is_one && !is_short; k++)
        if (t->end[k] >= 0) print_front_point(s, "end", t->end[k], f);
    if (t->knee >= 0) print_front_point(s, "knee", t->knee, f);
    if (hf_front_is_judged(t) && !is_one) print_front_first(s, is_short, f);
    if (path && s->finished && point)
        hf_print_line(
            f, "                to make a point the result, run the same command with --point %s:%d -o point%d.h5",
            path, point, point);
}

/* Prints which parts of the result belong to the shape of the form-finding and to no point of the front. */
static void print_form_parts(const hf_summary *s, hf_stage result, FILE *f)
{
    bool is_form = result == HF_STAGE_FORM;
    char parts[64] = "";
    if (is_form && s->stage[HF_STAGE_FORM].surface.is_measured) strcpy(parts, "surface");
    if (is_form && s->stage[HF_STAGE_FORM].pattern) hf_text_append(parts, sizeof parts, ", ", "pattern", "");
    if (s->n_load_case > 0) hf_text_append(parts, sizeof parts, ", ", "load cases", "");
    if (s->tolerance) hf_text_append(parts, sizeof parts, ", ", "as built", "");
    if (!*parts) return;
    fprintf(
        f,
        "                %s: of the form-finding, not of a point of the front; a run with --point computes them for "
        "a point\n",
        parts);
}

/* Prints a value, or a dash of this width for NaN. */
static void print_if_finite(const char *format, double value, int width, FILE *f)
{
    if (isfinite(value))
        fprintf(f, format, value);
    else
        fprintf(f, "%*s", width, "-");
}

/* Prints the surface errors of a load case or, with frequencies, the gain losses at the highest one, for a refocused
 * feed and for a fixed feed. */
static void print_load_case_surface(const hf_summary *s, const hf_surface_measures *m, bool has_optics, FILE *f)
{
    const hf_double_list *at = &s->surface.frequencies_Hz;
    hf_surface_errors e = hf_surface_errors_of(m, m->n_facet > 0);
    int highest = 0;
    for (int k = 1; k < at->n; k++)
        if (at->value[k] > at->value[highest]) highest = k;
    for (int is_fixed = 0; is_fixed < 2; is_fixed++) {
        double rms_m = is_fixed ? e.half_path_rms_m : e.fit_half_path_rms_m;
        const double *loss_dB = is_fixed ? e.gain_loss_dB : e.fit_gain_loss_dB;
        const double *optics_dB = is_fixed ? m->fixed_gain_loss_dB : m->refocused_gain_loss_dB;
        if (at->n == 0) {
            rms_m = is_fixed ? m->half_path_rms_m : m->fit.converged ? m->fit.half_path_rms_m : (double)NAN;
            print_if_finite(" %9.4f", rms_m * 1e3, 10, f);
        } else {
            fprintf(f, "%10s",
                    has_optics ? optics_text(optics_dB[highest], 4).text : loss_text(rms_m, loss_dB[highest], 4).text);
        }
    }
}

/* Prints a line for each load case of the as-built net. */
static void print_load_cases(const hf_summary *s, FILE *f)
{
    bool has_surface = s->surface.focal_length_m > 0, has_truss = s->has_truss, has_loose = false;
    bool has_loss = has_surface && s->surface.frequencies_Hz.n > 0, has_optics = false;
    if (s->n_load_case == 0) return;
    for (int k = 0; k < s->n_load_case; k++)
        has_optics |= hf_print_highest_optics(s, &s->load_case[k].surface) >= 0;
    fprintf(f, "  load cases    %-16s %9s %15s%s %8s %9s %5s %5s%s\n", "as-built net", "psi mm", "displacement mm",
            has_loss      ? " refocused     fixed"
            : has_surface ? "  best fit half-path"
                          : "",
            "min N", "max N", "slack", "loose", has_truss ? " member N" : "");
    for (int k = 0; k < s->n_load_case; k++) {
        const hf_load_case_summary *load_case = &s->load_case[k];
        const hf_form_result *r = &load_case->result;
        if (r->status != HF_OK) {
            fprintf(f, "                %-16s no shape: %s\n", load_case->name, hf_status_text(r->status));
            continue;
        }
        has_loose |= r->n_loose > 0;
        fprintf(f, "                %-16s", load_case->name);
        print_if_finite(" %9.4f", r->psi_m * 1e3, 10, f);
        fprintf(f, " %15.4f", load_case->displacement_rms_m * 1e3);
        if (has_surface) print_load_case_surface(s, &load_case->surface, has_optics, f);
        fprintf(f, " %8.4f %9.4f %5d %5d", load_case->tension_min_N, load_case->tension_max_N, r->n_slack, r->n_loose);
        if (has_truss) fprintf(f, " %8.4g", load_case->member_force_max_N);
        fputc('\n', f);
    }
    if (has_loss)
        fprintf(f, "                gain loss in dB at %g GHz for a refocused feed and for a fixed feed (%s)\n",
                hf_surface_highest_Hz(&s->surface) / 1e9, has_optics ? "physical optics" : "Ruze");
    if (has_loose)
        fputs("                psi leaves out the loose nodes; the other columns include them where they hang\n", f);
}

/* Prints the worst psi and the extreme tensions of all load cases in one line. */
static void print_worst_load_cases(const hf_summary *s, FILE *f)
{
    const hf_load_case_summary *psi = NULL, *low = NULL, *high = NULL;
    int n_failed = 0, n_slack = 0, n_loose = 0;
    for (int k = 0; k < s->n_load_case; k++) {
        const hf_load_case_summary *l = &s->load_case[k];
        bool has_shape = l->result.status == HF_OK;
        n_failed += !has_shape;
        if (!has_shape) continue;
        if (isfinite(l->result.psi_m) && (!psi || l->result.psi_m > psi->result.psi_m)) psi = l;
        if (!low || l->tension_min_N < low->tension_min_N) low = l;
        if (!high || l->tension_max_N > high->tension_max_N) high = l;
        if (l->result.n_slack > n_slack) n_slack = l->result.n_slack;
        if (l->result.n_loose > n_loose) n_loose = l->result.n_loose;
    }
    if (s->n_load_case == 0) return;
    fprintf(f, "  load cases    worst of %d:", s->n_load_case);
    if (psi) fprintf(f, " psi %.4f mm (%s);", psi->result.psi_m * 1e3, psi->name);
    if (low)
        fprintf(f, " tension %.4f N (%s) to %.4f N (%s);", low->tension_min_N, low->name, high->tension_max_N,
                high->name);
    fprintf(f, " %d slack, %d loose, %d without a shape\n", n_slack, n_loose, n_failed);
}

/* Prints the far field of the result, one line for each frequency and cut. */
static void print_pattern(const hf_pattern_summary *s, FILE *f)
{
    static const char *const of_feed[] = {"", "a point", "a line", "a plane wave"};
    if (!s || s->n_frequency == 0) return;
    fprintf(f, "  pattern       %7s %7s %9s %10s %13s %15s %8s   physical optics, feed: %s", "GHz", "phi deg",
            "gain dBi", "beam deg", "half power", "first sidelobe", "highest", of_feed[s->feed.kind]);
    if (s->feed.kind != HF_FEED_PLANE_WAVE) fprintf(f, ", cos^%.3g", s->feed.cos_power);
    fputc('\n', f);
    for (int k = 0; k < s->n_frequency * s->n_cut; k++) {
        const hf_cut_figures *c = &s->figure[k];
        fprintf(f, "                %7.4g %7.4g %9.3f %10.4f", s->frequency_Hz[k / s->n_cut] / 1e9,
                s->phi_deg[k % s->n_cut], c->gain_dBi, fabs(c->beam_deg) < 5e-5 ? 0 : c->beam_deg); /* no -0 */
        print_if_finite(" %9.4f deg", c->half_power_width_deg, 14, f);
        print_if_finite(" %12.2f dB", c->first_sidelobe_dB, 16, f);
        print_if_finite(" %8.2f", c->highest_sidelobe_dB, 9, f);
        fputc('\n', f);
    }
}

/* Prints the deflections of the truss at the attachments. */
static void print_deflection(const hf_summary *s, hf_stage result, FILE *f)
{
    const hf_coupling_result *r = &s->stage[HF_STAGE_FORM].result.coupling, *end = &result_of(s, result)->coupling;
    fprintf(f, "the truss deflects by up to %.4f mm at the attachments", r->deflection_max_m * 1e3);
    if (end != r && end->iterations > 0) fprintf(f, ", in the result by %.4f mm", end->deflection_max_m * 1e3);
}

static void print_truss(const hf_summary *s, hf_stage result, bool is_short, FILE *f)
{
    fprintf(f, "  truss         %d nodes, %d members; %.2f kg", s->truss.n_node, s->truss.n_member, s->truss.mass_kg);
    if (is_short && s->has_coupling) {
        fputs("; ", f);
        print_deflection(s, result, f);
    }
    fputc('\n', f);
}

/* Prints the deflections of the truss and the convergence of the coupling in the form-finding. */
static void print_coupling(const hf_summary *s, hf_stage result, FILE *f)
{
    const hf_coupling_result *r = &s->stage[HF_STAGE_FORM].result.coupling;
    static const char *const ended[] = {"", "converged", "not converged", "diverged", "ended without a shape"};
    fputs("  coupling      ", f);
    print_deflection(s, result, f);
    fprintf(f, "; %s after %d iteration%s, last step %.1e m\n",
            r->stop_reason <= HF_COUPLING_NET ? ended[r->stop_reason] : "", r->iterations,
            r->iterations == 1 ? "" : "s", r->step_m);
}

/* ---- the whole summary ---- */

static void print_end(const hf_summary *s, const char *path, hf_print_style style, bool is_short, FILE *f)
{
    if (!path) return;
    if (s->finished && is_short) {
        hf_print_line(f, "  results       %s; details: hifdm show --verbose %s; a page with charts: hifdm report %s",
                      path, path, path);
        return;
    }
    if (!is_short) hf_print_line(f, "  results       %s", path);
    if (s->finished && !style.verbose)
        hf_print_line(f, "  more          details: hifdm show --verbose %s; a page with charts: hifdm report %s", path,
                      path);
    if (!s->finished)
        hf_print_line(f, "  unfinished    to resume, run `hifdm run %s -o %s` with the same options again",
                      s->case_path, path);
}

/* Prints nodes, cables and design variables, and how far the optimisation moved nodes that it does not count. */
static void print_net(const hf_summary *s, hf_stage result, FILE *f)
{
    fprintf(f, "%d nodes (%d free), %d cables", s->n_node, s->n_free, s->n_cable);
    if (s->stage[HF_STAGE_SEARCH].exists || s->stage[HF_STAGE_REFINE].exists || s->front)
        fprintf(f, ", %d design variables", s->n_variable);
    if (s->has_own_tensions)
        fputs("; each cable has a law of its own", f);
    else
        fprintf(f, "; pretension %g N%s", s->pretension_N, s->scale_min > 0 ? " before optimisation" : "");
    if (s->scale_min > 0) fprintf(f, "; the result scales variables by %.4g", s->scale_min);
    if (s->scale_min > 0 && s->scale_max > s->scale_min * (1 + SAME_SCALE)) fprintf(f, " to %.4g", s->scale_max);
    bool is_moved = isfinite(s->uncounted_move_m) && s->uncounted_move_m > MOVED_M;
    if (s->n_uncounted > 0 && result != HF_STAGE_FORM && result != HF_N_STAGE && is_moved)
        fprintf(f, "; the optimisation moved %d nodes by up to %.4g mm in uncounted directions", s->n_uncounted,
                s->uncounted_move_m * 1e3);
    fputc('\n', f);
}

/* Prints what remains below a table of verdicts: at most 12 lines. --verbose prints the long form. */
static void print_short(const hf_summary *s, const char *path, hf_print_style style, FILE *f)
{
    hf_stage result = hf_store_result_stage(s);
    char title[2 * sizeof s->title];
    hf_text_escape(*s->title ? s->title : s->case_path, title, sizeof title);
    fprintf(f, "  case          %s; ", title);
    print_net(s, result, f);
    if (s->has_truss) print_truss(s, result, true, f);
    if (s->front) { /* load cases and samples are those of no point of the front */
        print_front(s, path, true, f);
    } else {
        print_stages(s, result, true, f);
        print_errors(s, result, true, f);
        print_worst_load_cases(s, f);
        if (s->tolerance) hf_print_tolerance(s, HF_PRINT_SHORT, f);
    }
    print_end(s, path, style, true, f);
}

static void print_long(const hf_summary *s, const char *path, hf_print_style style, FILE *f)
{
    hf_stage result = hf_store_result_stage(s);
    hf_print_line(f, "  case          %s", *s->title ? s->title : s->case_path);
    fputs("  net           ", f);
    print_net(s, result, f);
    if (s->has_truss) print_truss(s, result, false, f);
    print_stages(s, result, false, f);
    if (s->has_coupling) print_coupling(s, result, f);
    print_errors(s, result, false, f);
    if (style.verbose) hf_print_details(s, f);
    if (s->front) print_front(s, path, false, f);
    if (s->front) print_form_parts(s, result, f);
    if (result != HF_N_STAGE) print_pattern(s->stage[result].pattern, f);
    print_load_cases(s, f);
    if (s->tolerance) hf_print_tolerance(s, style.verbose ? HF_PRINT_VERBOSE : HF_PRINT_NORMAL, f);
    print_end(s, path, style, false, f);
}

void hf_print_summary(const hf_summary *s, const char *path, hf_print_style style, FILE *f)
{
    hf_print_requirements(s, style, f);
    if (style.has_colour) fputs(HF_PRINT_BOLD, f);
    print_answer(s, style.has_error, f);
    fputs(style.has_colour ? HF_PRINT_PLAIN "\n" : "\n", f);
    bool is_short = s->n_requirement > 0 && !style.verbose;
    (is_short ? print_short : print_long)(s, path, style, f);
}
