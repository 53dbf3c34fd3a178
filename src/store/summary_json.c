/* Writes a summary as one JSON object, stage by stage. Most members come from the lists in <hifdm/summary.h> and
 * <hifdm/result.h>. */
#include <hifdm/summary.h>

#include "base/json.h"
#include "store/layout.h"

#include <math.h>
#include <string.h>

/* ---- figures by the lists ---- */

static void write_field(const hf_result_field *field, const void *owner, hf_json *j)
{
    const void *value = (const char *)owner + field->offset;
    const hf_hdf5_kind *kind = hf_layout_kind_of(field);
    const char *key = hf_result_key(field);
    if (kind == HF_KIND_REAL)
        hf_json_number(j, key, *(const double *)value);
    else if (kind == HF_KIND_LONG)
        hf_json_integer(j, key, *(const long *)value);
    else if (field->size == sizeof(bool))
        hf_json_bool(j, key, *(const bool *)value);
    else if (kind->n_word)
        hf_json_text(j, key, hf_hdf5_word(kind, hf_layout_int(value, field->size)));
    else
        hf_json_integer(j, key, hf_layout_int(value, field->size));
}

/* Writes the members of an object with the places `from` to `to`, in that order. */
static void write_fields(const hf_result_field *field, int n, int from, int to, const void *owner, hf_json *j)
{
    for (int place = from; place <= to; place++)
        for (int i = 0; i < n; i++)
            if (field[i].json == place) write_field(&field[i], owner, j);
}

enum { LAST_PLACE = 9 };

static void write_part(const hf_summary *s, hf_layout_part part, hf_json *j)
{
    const hf_layout_members *p = &hf_layout_summary[part];
    write_fields(p->field, p->n, 1, LAST_PLACE, hf_layout_owner(s, part), j);
}

/* ---- stages ---- */

static void write_result(const hf_form_result *r, hf_json *j)
{
    write_fields(hf_result_field_of, HF_RESULT_N, 1, HF_RESULT_JSON_COUNTS - 1, r, j);
    if (r->coupling.iterations > 0) hf_json_number(j, "deflection_max_m", r->coupling.deflection_max_m);
    write_fields(hf_result_field_of, HF_RESULT_N, HF_RESULT_JSON_COUNTS, LAST_PLACE, r, j);
}

/* Writes the member "surface" of a stage, after its others. Writes nothing if the surface was not measured. */
static void write_surface(const hf_summary *s, const hf_surface_measures *m, hf_json *j)
{
    if (!m->is_measured) return;
    hf_json_open_line(j, "  ", "surface", '{');
    hf_json_text(j, "kind", hf_surface_kind_word[s->surface.kind]);
    write_fields(hf_layout_surface, HF_LAYOUT_N_SURFACE, 1, LAST_PLACE, m, j);
    hf_json_list(j, "frequency_Hz", s->surface.frequencies_Hz.value, s->surface.frequencies_Hz.n);
#define LOSS(member, unit, description) hf_json_list(j, #member, m->member, s->surface.frequencies_Hz.n);
    HF_SURFACE_LOSS_LIST(LOSS)
    hf_json_close(j, '}');
}

/* Writes the member "pattern" of a stage: an object for each frequency and cut. Writes nothing without
 * surface.pattern. */
static void write_pattern(const hf_pattern_summary *s, hf_json *j)
{
    if (!s) return;
    hf_json_open_line(j, "  ", "pattern", '[');
    for (int k = 0; k < s->n_frequency * s->n_cut; k++) {
        const hf_cut_figures *f = &s->figure[k];
        hf_json_open_line(j, "   ", NULL, '{');
        HF_JSON_NUMBERS(j, {"frequency_Hz", s->frequency_Hz[k / s->n_cut]}, {"phi_deg", s->phi_deg[k % s->n_cut]},
                        {"gain_dBi", f->gain_dBi}, {"beam_deg", f->beam_deg},
                        {"half_power_width_deg", f->half_power_width_deg}, {"first_sidelobe_dB", f->first_sidelobe_dB},
                        {"highest_sidelobe_dB", f->highest_sidelobe_dB});
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

/* Writes the member "sets" of a stage: an object for each named set of cables. */
static void write_sets(const hf_set_tensions *s, hf_json *j)
{
    if (!s || s->n == 0) return;
    hf_json_open_line(j, "  ", "sets", '{');
    for (int k = 0; k < s->n; k++) {
        hf_json_open(j, s->name[k], '{');
        HF_JSON_NUMBERS(j, {"min_N", s->min_N[k]}, {"max_N", s->max_N[k]}, {"tension_ratio", s->ratio[k]});
        hf_json_close(j, '}');
    }
    hf_json_close(j, '}');
}

/* Writes the member "at_limits" of a stage: the limits that its shape is at. */
static void write_held(const hf_held_limits *h, hf_json *j)
{
    if (!h || h->n == 0) return;
    hf_json_open_line(j, "  ", "at_limits", '[');
    for (int i = 0; i < h->n; i++) {
        hf_json_open(j, NULL, '{');
        hf_json_integer(j, "row", h->row[i]);
        hf_json_text(j, "name", h->name[i]);
        HF_JSON_NUMBERS(j, {"value", h->value[i]}, {"bound", h->bound[i]}, {"count", h->count[i]});
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

/* Writes the member "optima" of a stage: the distinct optima of its refinements, best first. */
static void write_optima(const hf_optima *o, hf_json *j)
{
    if (!o) return;
    hf_json_open_line(j, "  ", "optima", '[');
    for (int i = 0; i < o->n; i++) {
        hf_json_open(j, NULL, '{');
        hf_json_number(j, "merit", o->merit[i]);
        hf_json_integer(j, "count", o->count[i]);
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

/* Writes the members "merit" and "objectives" of a stage: value and weight of each term of the objective. Objectives
 * of a front have only values. */
static void write_objectives(const hf_summary *s, const hf_form_result *r, hf_json *j)
{
    if (s->objectives.n == 0) return;
    hf_json_line(j, "  ");
    if (!s->objectives.is_front) hf_json_number(j, "merit", r->merit);
    hf_json_open(j, "objectives", '{');
    for (int k = 0; k < s->objectives.n; k++) {
        hf_json_open(j, s->objectives.name[k], '{');
        hf_json_number(j, "value", r->status == HF_OK ? r->objective[k] : (double)NAN);
        if (!s->objectives.is_front) hf_json_number(j, "weight", s->objectives.weight[k]);
        hf_json_close(j, '}');
    }
    hf_json_close(j, '}');
}

/* Writes a stage: its result, what only this stage has, and the measures of its shape. */
static void write_stage(const hf_summary *s, hf_stage stage, hf_json *j)
{
    const hf_stage_summary *of = &s->stage[stage];
    hf_json_open_line(j, " ", hf_stage_word[stage], '{');
    write_result(&of->result, j);
    if (stage == HF_STAGE_FORM)
        hf_json_text(j, "stop_reason", hf_stop_reason_word((int)of->result.stop_reason));
    else
        hf_json_text(j, "algorithm", hf_summary_algorithm(s, stage));
    if (stage == HF_STAGE_FORM) write_part(s, HF_LAYOUT_FORM, j);
    if (stage == HF_STAGE_SEARCH) write_part(s, HF_LAYOUT_SEARCH, j);
    if (stage == HF_STAGE_REFINE) write_part(s, HF_LAYOUT_REFINE, j);
    hf_json_number(j, "wall_s", of->wall_s);
    if (stage == HF_STAGE_REFINE && s->taken.point) {
        hf_json_text(j, "front_file", s->taken.path);
        hf_json_integer(j, "front_point", s->taken.point);
    }
    write_surface(s, &of->surface, j);
    write_pattern(of->pattern, j);
    write_sets(of->sets, j);
    write_held(of->held, j);
    write_optima(of->optima, j);
    write_objectives(s, &of->result, j);
    hf_json_close(j, '}');
}

/* Writes the values of all objectives of a front by their names. */
static void write_front_values(const hf_summary *s, const char *key, const double *value, hf_json *j)
{
    hf_json_open(j, key, '{');
    for (int k = 0; k < s->front->n_objective; k++)
        hf_json_number(j, s->objectives.name[k], value[k]);
    hf_json_close(j, '}');
}

static void write_front(const hf_summary *s, hf_json *j)
{
    const hf_front_table *t = s->front;
    hf_json_open_line(j, " ", "front", '{');
    HF_JSON_NUMBERS(j, {"n_point", t->n_point}, {"n_listed", t->n_row}, {"n_dominated", t->n_dominated},
                    {"n_failed", t->n_failed});
    if (t->minimised >= 0) hf_json_integer(j, "n_not_converged", t->n_unconverged);
    if (hf_front_is_judged(t)) {
        HF_JSON_NUMBERS(j, {"n_pass", t->n_verdict[HF_VERDICT_PASS]}, {"n_fail", t->n_verdict[HF_VERDICT_FAIL]},
                        {"n_undecided", t->n_verdict[HF_VERDICT_UNDECIDED]}, {"first", hf_front_suggested(t)});
    }
    if (t->minimised >= 0) hf_json_text(j, "minimised", s->objectives.name[t->minimised]);
    if (t->knee >= 0) hf_json_integer(j, "knee", t->knee);
    hf_json_number(j, "wall_s", t->wall_s);
    hf_json_line(j, "  ");
    write_front_values(s, "initial", t->initial, j);
    hf_json_open_line(j, "  ", "points", '[');
    for (int i = 0; i < t->n_row; i++) {
        const hf_front_point *p = &t->row[i];
        hf_json_open_line(j, "   ", NULL, '{');
        hf_json_integer(j, "id", t->index[i] + 1); /* as in the table of hifdm export --front */
        write_front_values(s, "objective", p->objective, j);
        if (t->minimised >= 0) write_front_values(s, "multiplier", p->multiplier, j);
        hf_json_text(j, "status", hf_status_word(p->status));
        hf_json_text(j, "mark", hf_front_mark_word[p->mark]);
        hf_json_integer(j, "steps", p->steps);
        if (t->minimised >= 0) hf_json_bool(j, "converged", p->is_converged);
        if (p->judgement.n_required > 0) {
            hf_json_text(j, "verdict", hf_verdict_word[hf_judgement_verdict(&p->judgement)]);
            HF_JSON_NUMBERS(j, {"requirements", p->judgement.n_required},
                            {"requirements_failed", p->judgement.n_failed},
                            {"requirements_undecided", p->judgement.n_undecided},
                            {"relative_margin_min", p->judgement.relative_margin_min});
        }
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
    hf_json_close(j, '}');
}

/* Writes the member "load_cases": an object for each load case of the as-built net. */
static void write_load_cases(const hf_summary *s, hf_json *j)
{
    if (s->n_load_case == 0) return;
    hf_json_open_line(j, " ", "load_cases", '{');
    for (int k = 0; k < s->n_load_case; k++) {
        const hf_load_case_summary *load_case = &s->load_case[k];
        hf_json_open_line(j, "  ", load_case->name, '{');
        write_result(&load_case->result, j);
        write_fields(hf_layout_load_case, HF_LAYOUT_N_LOAD_CASE, 1, LAST_PLACE, load_case, j);
        write_surface(s, &load_case->surface, j);
        hf_json_close(j, '}');
    }
    hf_json_close(j, '}');
}

/* Returns the figures of a measure with NaN for infinite gain losses, which are those beyond Ruze's formula. */
static hf_tolerance_figures known_figures(const hf_tolerance_figures *f, const char *measure)
{
    hf_tolerance_figures known = *f;
    double *value[] = {&known.min, &known.max};
    if (!strstr(measure, "loss_dB")) return known;
    for (int k = 0; k < 2; k++)
        if (isinf(*value[k])) *value[k] = (double)NAN;
    for (int k = 0; k < HF_TOLERANCE_QUANTILES; k++) {
        if (isinf(known.value[k])) known.value[k] = (double)NAN;
        if (isinf(known.low[k])) known.low[k] = (double)NAN;
        if (isinf(known.high[k])) known.high[k] = (double)NAN;
    }
    return known;
}

static void write_figures(const hf_tolerance_figures *f, const char *measure, hf_json *j)
{
    hf_json_open_line(j, "  ", measure, '{');
    HF_JSON_NUMBERS(j, {"mean", f->mean}, {"mean_low", f->mean_low}, {"mean_high", f->mean_high},
                    {"deviation", f->deviation}, {"min", f->min}, {"max", f->max});
    hf_json_list(j, "quantile", f->value, HF_TOLERANCE_QUANTILES);
    hf_json_list(j, "quantile_low", f->low, HF_TOLERANCE_QUANTILES);
    hf_json_list(j, "quantile_high", f->high, HF_TOLERANCE_QUANTILES);
    hf_json_close(j, '}');
}

/* Writes the members "verdict" and "requirements": the verdict on all rows, and an object for each row. */
static void write_verdicts(const hf_summary *s, hf_json *j)
{
    if (s->n_requirement == 0) return;
    hf_judgement all = hf_summary_judge(s);
    hf_json_line(j, " ");
    hf_json_text(j, "verdict", hf_verdict_word[hf_judgement_verdict(&all)]);
    hf_json_open(j, "requirements", '[');
    for (int i = 0; i < s->n_requirement; i++) {
        hf_json_open_line(j, "  ", NULL, '{');
        hf_layout_write_verdict(&s->requirement[i], j);
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

static void write_shares(const hf_tolerance_summary *t, hf_json *j)
{
    hf_json_open_line(j, "  ", "kind_share", '{');
    for (int k = 0; k < HF_TOLERANCE_KINDS; k++)
        if (t->kind_share[k] > 0) hf_json_number(j, hf_tolerance_kind_word[k], t->kind_share[k]);
    hf_json_close(j, '}');
    hf_json_open_line(j, "  ", "cable_share", '[');
    for (int k = 0; k < t->n_ranked; k++) {
        hf_json_open(j, NULL, '{');
        hf_json_text(j, "cable", t->ranked_id[k]);
        hf_json_number(j, "share", t->ranked_share[k]);
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

static void write_tolerance(const hf_summary *s, hf_json *j)
{
    const hf_tolerance_summary *t = s->tolerance;
    hf_json_open_line(j, " ", "tolerance", '{');
    write_part(s, HF_LAYOUT_TOLERANCE, j);
    hf_json_list(j, "quantiles", hf_tolerance_quantile, HF_TOLERANCE_QUANTILES);
    for (int k = 0; k < HF_TOLERANCE_N_MEASURE; k++)
        if (t->figure[k].is_measured) {
            const hf_tolerance_figures known = known_figures(&t->figure[k], hf_tolerance_measure_word[k]);
            write_figures(&known, hf_tolerance_measure_word[k], j);
        }
    write_shares(t, j);
    hf_json_list(j, "histogram_range_m", (const double[]){t->bin_low_m, t->bin_high_m}, 2);
    hf_json_list(j, "histogram", t->bin, HF_TOLERANCE_BINS);
    hf_json_close(j, '}');
}

void hf_summary_write_json(const hf_summary *s, hf_status status, const char *messages, const char *path, FILE *f)
{
    const hf_form_result *form = &s->stage[HF_STAGE_FORM].result;
    hf_json writer = {.file = f}, *j = &writer;
    hf_json_open(j, NULL, '{');
    hf_json_text(j, "status", hf_status_word(status));
    hf_json_bool(j, "finished", s->finished);
    write_verdicts(s, j);
    if (s->has_truss) {
        hf_json_open_line(j, " ", "truss", '{');
        write_part(s, HF_LAYOUT_TRUSS, j);
        hf_json_close(j, '}');
    }
    if (s->stage[HF_STAGE_FORM].exists) write_stage(s, HF_STAGE_FORM, j);
    if (s->has_coupling && form->coupling.iterations > 0) {
        hf_json_open_line(j, " ", "coupling", '{');
        write_part(s, HF_LAYOUT_FORM_COUPLING, j);
        hf_json_close(j, '}');
    }
    for (hf_stage stage = HF_STAGE_SEARCH; stage < HF_N_STAGE; stage++)
        if (s->stage[stage].exists) write_stage(s, stage, j);
    if (s->front) write_front(s, j);
    write_load_cases(s, j);
    if (s->tolerance) write_tolerance(s, j);
    hf_json_line(j, " ");
    hf_json_integer(j, "threads", s->threads);
    hf_json_unsigned(j, "seed", s->seed);
    hf_json_text(j, "version", s->version);
    hf_json_line(j, " ");
    hf_json_text(j, "case", s->case_path);
    if (path) hf_json_text(j, "file", path);
    hf_json_end(j, status != HF_OK, messages);
}
