/* The fields of a ledger row, made from the summary of a point. First come its numbers. Then come lists as texts: for
 * each stage the objectives and the surface errors, one for the load cases and one for the requirements. They are texts
 * because the values may differ from point to point. Sections: numbers, lists, fields, reading lists. */
#include "store/ledger.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers ---- */

bool hf_ledger_column(int i, hf_ledger_number *number)
{
    for (hf_layout_part part = 0; part < HF_LAYOUT_N_PART; part++) {
        const hf_layout_members *p = &hf_layout_summary[part];
        for (const hf_result_field *f = p->field; f < p->field + p->n; f++)
            if (f->kind != HF_RESULT_CHARS && i-- == 0) {
                *number = (hf_ledger_number){p->object, part, f};
                return true;
            }
    }
    return false;
}

int hf_ledger_n_column(void)
{
    hf_ledger_number number;
    int n = 0;
    while (hf_ledger_column(n, &number))
        n++;
    return n;
}

bool hf_ledger_is_circumstance(const hf_ledger_number *number)
{
    const char *name = number->field->name;
    size_t n = strlen(name);
    return !strcmp(name, "threads") || (n > 2 && !strcmp(name + n - 2, "_s"));
}

static int print_number(const hf_ledger_number *number, const hf_summary *s, char *text, size_t size)
{
    const void *from = (const char *)hf_layout_owner(s, number->part) + number->field->offset;
    switch (hf_layout_kind_of(number->field)->class) {
    case HF_HDF5_REAL:
        return snprintf(text, size, "%.17g", *(const double *)from);
    case HF_HDF5_LONG:
        return snprintf(text, size, "%ld", *(const long *)from);
    case HF_HDF5_UINT64:
        return snprintf(text, size, "%" PRIu64, *(const uint64_t *)from);
    default:
        return snprintf(text, size, "%d", hf_layout_int(from, number->field->size));
    }
}

/* ---- lists ---- */

const hf_ledger_list hf_ledger_list_of[HF_LEDGER_N_LIST] = {
    {"objectives", "/form", "objective_"},   {"objectives", "/search", "objective_"},
    {"objectives", "/refine", "objective_"}, {"errors", "/surface/form", ""},
    {"errors", "/surface/search", ""},       {"errors", "/surface/refine", ""},
    {"figures", HF_LEDGER_LOAD_CASES, ""},   {"verdicts", HF_LEDGER_REQUIREMENTS, ""}};

/* Writes the objectives of a stage: "objective_0_psi=0.001 objective_1_tension_edge=3". Returns the length. */
static int print_objectives(const hf_summary *s, int stage, char *text, size_t size)
{
    const double *objective = hf_layout_objectives(s, stage);
    size_t used = 0;
    for (int k = 0; objective && k < s->objectives.n && used < size; k++)
        used +=
            (size_t)snprintf(text + used, size - used, "%s%s=%.17g", k ? " " : "", s->objectives.name[k], objective[k]);
    return (int)used;
}

/* Writes the surface errors of a shape: "facet_half_path_rms_m=0.001 facet_gain_loss_1dB_Hz=3e9
 * facet_gain_loss_at_2.5_GHz_dB=0.1 facet_fit_half_path_rms_m=... refocused_gain_loss_at_2.5_GHz_dB=0.1".
 * before: prefix of each name, of a load case its name and a dot. Returns the length. */
static int print_errors(const hf_double_list *at, const hf_surface_measures *m, const char *before, char *text,
                        size_t size)
{
    size_t used = 0;
    if (!m->is_measured) return 0;
    hf_surface_errors e = hf_surface_errors_of(m, m->n_facet > 0);
    for (int is_fit = 0; is_fit < 2 && used < size; is_fit++) {
        double rms_m = is_fit ? e.fit_half_path_rms_m : e.half_path_rms_m;
        const double *loss_dB = is_fit ? e.fit_gain_loss_dB : e.gain_loss_dB;
        char kind[HF_SET_NAME_SIZE + 16];
        snprintf(kind, sizeof kind, "%s%s%s", before, m->n_facet > 0 ? "facet_" : "", is_fit ? "fit_" : "");
        used += (size_t)snprintf(text + used, size - used, "%s%shalf_path_rms_m=%.17g %sgain_loss_1dB_Hz=%.17g",
                                 is_fit ? " " : "", kind, rms_m, kind,
                                 hf_surface_frequency_of_loss_Hz(rms_m, HF_SURFACE_GOOD_TO_DB));
        for (int k = 0; k < at->n && used < size; k++)
            used += (size_t)snprintf(text + used, size - used, " %sgain_loss_at_%.9g_GHz_dB=%.17g", kind,
                                     at->value[k] / 1e9, loss_dB[k]);
    }
    for (int k = 0; m->n_facet > 0 && k < at->n && used < size; k++)
        used += (size_t)snprintf(text + used, size - used,
                                 " %srefocused_gain_loss_at_%.9g_GHz_dB=%.17g %sfixed_gain_loss_at_%.9g_GHz_dB=%.17g "
                                 "%spointing_at_%.9g_GHz_deg=%.17g",
                                 before, at->value[k] / 1e9, m->refocused_gain_loss_dB[k], before, at->value[k] / 1e9,
                                 m->fixed_gain_loss_dB[k], before, at->value[k] / 1e9, m->pointing_deg[k]);
    return (int)used;
}

/* Writes the load cases: "cold.psi_m=0.001 cold.n_slack=3 ... sun.psi_m=...". Figures of a load case without a shape
 * are NaN. Returns the length. */
static int print_load_cases(const hf_summary *s, char *text, size_t size)
{
    size_t used = 0;
    for (int k = 0; k < s->n_load_case && used < size; k++) {
        const hf_load_case_summary *load_case = &s->load_case[k];
        const hf_form_result *r = &load_case->result;
        const double none = (double)NAN;
        bool has = r->status == HF_OK;
        char before[HF_SET_NAME_SIZE + 1];
        snprintf(before, sizeof before, "%s.", load_case->name);
        used += (size_t)snprintf(text + used, size - used,
                                 "%s%spsi_m=%.17g %sn_slack=%g %sn_loose=%g %stension_max_N=%.17g", k ? " " : "",
                                 before, has ? r->psi_m : none, before, has ? r->n_slack : none, before,
                                 has ? r->n_loose : none, before, load_case->tension_max_N);
        if (!load_case->surface.is_measured || used + 1 >= size) continue;
        text[used++] = ' ';
        used += (size_t)print_errors(&s->surface.frequencies_Hz, &load_case->surface, before, text + used, size - used);
    }
    return (int)used;
}

/* Writes the verdicts: "n_failed=1 n_undecided=0 relative_margin_min=-0.1 verdict_0=1 value_0=4.5 at_least_0=5 ...".
 * Returns the length. */
static int print_verdicts(const hf_summary *s, char *text, size_t size)
{
    if (s->n_requirement == 0) return 0;
    hf_judgement of = hf_summary_judge(s);
    size_t used = (size_t)snprintf(text, size, "n_failed=%d n_undecided=%d relative_margin_min=%.17g", of.n_failed,
                                   of.n_undecided, of.relative_margin_min);
    for (int i = 0; i < s->n_requirement && used < size; i++) {
        const hf_requirement_verdict *v = &s->requirement[i];
        used += (size_t)snprintf(text + used, size - used,
                                 " verdict_%d=%d value_%d=%.17g at_least_%d=%.17g at_most_%d=%.17g margin_%d=%.17g "
                                 "relative_margin_%d=%.17g",
                                 i, (int)v->verdict, i, v->value, i, v->row.at_least, i, v->row.at_most, i, v->margin,
                                 i, v->relative_margin);
    }
    return (int)used;
}

/* Writes the names of the requirements: "tension of tie, all load cases;slack_cables". Returns the length. */
static int print_names(const hf_summary *s, char *text, size_t size)
{
    char name[HF_LEDGER_REQUIREMENT_SIZE];
    size_t used = 0;
    for (int i = 0; i < s->n_requirement && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i ? ";" : "",
                                 hf_requirement_name(&s->requirement[i].row, name, sizeof name));
    return (int)used;
}

hf_required_figure hf_ledger_figure(const char *requirement)
{
    size_t n = strcspn(requirement, " ,;");
    hf_required_figure figure = 0;
    while (figure < HF_REQUIRED_N_FIGURE && (strlen(hf_required_figure_word[figure]) != n ||
                                             strncmp(requirement, hf_required_figure_word[figure], n) != 0))
        figure++;
    return figure;
}

/* ---- fields ---- */

int hf_ledger_names_field(void)
{
    return hf_ledger_n_column() + HF_LEDGER_N_LIST;
}

int hf_ledger_n_field(void)
{
    return hf_ledger_names_field() + 1;
}

int hf_ledger_field_name(int i, char *text, size_t size)
{
    hf_ledger_number number;
    if (hf_ledger_column(i, &number)) return snprintf(text, size, "%s/%s", number.object, number.field->name);
    if (i == hf_ledger_names_field()) return snprintf(text, size, HF_LEDGER_REQUIREMENTS "/names");
    const hf_ledger_list *list = &hf_ledger_list_of[i - hf_ledger_n_column()];
    return snprintf(text, size, "%s/%s", list->group, list->field);
}

int hf_ledger_print_field(int i, const hf_summary *s, char *text, size_t size)
{
    hf_ledger_number number;
    int list = i - hf_ledger_n_column(), stage = list % HF_N_STAGE;
    if (!s->stage[HF_STAGE_FORM].exists) return 0;
    if (hf_ledger_column(i, &number)) return hf_layout_has(s, number.part) ? print_number(&number, s, text, size) : 0;
    if (i == hf_ledger_names_field()) return print_names(s, text, size);
    if (list == HF_LEDGER_LIST_REQUIREMENTS) return print_verdicts(s, text, size);
    if (list == HF_LEDGER_LIST_CASES) return print_load_cases(s, text, size);
    if (list == stage) return print_objectives(s, stage, text, size);
    return print_errors(&s->surface.frequencies_Hz, &s->stage[stage].surface, "", text, size);
}

/* ---- reading lists ---- */

bool hf_ledger_next_value(int list, const char **text, char name[HF_OBJECTIVE_NAME_SIZE], double *value)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.+";
    const char *p = *text + (**text == ' '), *begin = hf_ledger_list_of[list].begin;
    char then[HF_OBJECTIVE_NAME_SIZE], now[2 * HF_OBJECTIVE_NAME_SIZE];
    size_t n = strspn(p, letters);
    char *end;
    if (n == 0 || n >= HF_OBJECTIVE_NAME_SIZE || p[n] != '=' || *p == '.') return false;
    snprintf(then, sizeof then, "%.*s", (int)n, p);
    snprintf(name, HF_OBJECTIVE_NAME_SIZE, "%s", hf_renamed_figure(then, now, sizeof now));
    if (strncmp(name, begin, strlen(begin)) != 0) return false;
    *value = strtod(p + n + 1, &end);
    *text = end;
    return end > p + n + 1;
}

const char *hf_ledger_unit(const char *name)
{
    static const char *const unit[][2] = {{"_N_per_m", "N/m"}, {"_kg", "kg"}, {"_N", "N"},    {"_m", "m"},
                                          {"_Hz", "Hz"},       {"_dB", "dB"}, {"_deg", "deg"}};
    size_t n = strlen(name);
    if (!strncmp(name, "objective_", 10)) return hf_ledger_objective_unit(name);
    for (int i = 0; i < HF_HDF5_COUNT(unit); i++)
        if (n > strlen(unit[i][0]) && !strcmp(name + n - strlen(unit[i][0]), unit[i][0])) return unit[i][1];
    return "";
}

const char *hf_ledger_objective(const char *name)
{
    name += strcspn(name, "0123456789");
    return name + strspn(name, "0123456789_");
}

const char *hf_ledger_objective_unit(const char *name)
{
    const char *word = hf_ledger_objective(name);
    for (int kind = 0; hf_figure_kind_word[kind]; kind++) {
        size_t n = strlen(hf_figure_kind_word[kind]);
        if (!strncmp(word, hf_figure_kind_word[kind], n) && (!word[n] || word[n] == '_'))
            return hf_figure_kind_unit[kind];
    }
    return "";
}
