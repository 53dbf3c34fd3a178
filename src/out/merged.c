/* Reads a merged study and ranks its points:
 *
 *     tables of points ---> axes, figures of each stage ---> which figures vary ---> verdicts ---> ranking figure
 *       ---> best point ---> intervals that pass
 *
 * merged_groups.c continues with the groups of replicates. Contents: reading, what varies, verdicts, the best point,
 * columns of the requirements, rounding, intervals that pass. */
#include "out/merged.h"

#include "base/elementary.h"
#include "base/path.h"
#include "store/ledger.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAME_RATIO 1e-6    /* relative difference up to which values count as equal */
#define RESOLVED_M 1e-9    /* differences of lengths below this are rounding */
#define ROUNDING 1e-12     /* part of psi by which an objective may differ from it through rounding */
#define MARGIN_SHOWN 5e-4  /* relative margins below this print as 0.0 % */
#define REACHED_RATIO 1e-9 /* rounding of an objective, relative to its value after form-finding */

const char *hf_merged_stage_word(const hf_merged *m, hf_merged_stage stage)
{
    static const char *const other[] = {"tolerance", "load_cases", "requirements"};
    if (m && m->is_mixed && stage == HF_MERGED_REFINE) return "result";
    return stage < HF_MERGED_BUILT ? hf_stage_word[stage] : other[stage - HF_MERGED_BUILT];
}

/* ---- reading ---- */

#define GROUP_SIZE (HF_SET_NAME_SIZE + 32)
static const char *const key_of_stage[] = {"psi_m", "inner_tension_ratio", "boundary_tension_ratio", "residual_N",
                                           "n_slack"};
static const char *const key_as_built[] = {"psi_95_m", "yield", "yield_low", "yield_high"};
enum { N_KEY = sizeof key_of_stage / sizeof *key_of_stage, N_BUILT = sizeof key_as_built / sizeof *key_as_built };

bool hf_merged_is(const char *path)
{
    hf_series status = {0};
    bool is_study = hf_store_read_series(path, "/points/status", 1, &status, NULL) == HF_OK && status.n > 0;
    hf_series_free(&status);
    return is_study;
}

/* Reads a figure. A data set that is missing, or that does not have one value for each point, is skipped. */
static hf_status read_figure(hf_merged *m, hf_merged_stage stage, const char *group, const char *key,
                             hf_messages *messages)
{
    char path[GROUP_SIZE + HF_OBJECTIVE_NAME_SIZE];
    if (m->n_figure == HF_MERGED_FIGURE_MAX || strlen(key) >= HF_OBJECTIVE_NAME_SIZE) return HF_OK;
    hf_merged_figure *f = &m->figure[m->n_figure];
    *f = (hf_merged_figure){.stage = stage};
    strcpy(f->key, key);
    snprintf(path, sizeof path, "%s/%s", group, key);
    HF_TRY(hf_store_read_series(m->path, path, 1, &f->value, messages));
    if (f->value.n == m->n)
        m->n_figure++;
    else
        hf_series_free(&f->value);
    return HF_OK;
}

/* Reads all figures of a group whose names begin with `begin`. */
static hf_status read_group(hf_merged *m, hf_merged_stage stage, const char *group, const char *begin,
                            hf_messages *messages)
{
    hf_texts names = {0};
    hf_status status = hf_store_read_names(m->path, group, &names, messages);
    for (int i = 0; i < names.n && status == HF_OK; i++) {
        const char *name = hf_texts_at(&names, i);
        if (!strncmp(name, begin, strlen(begin))) status = read_figure(m, stage, group, name, messages);
    }
    hf_texts_free(&names);
    return status;
}

/* Reads the figures of each load case from the group of its name. Names that are too long for a load case are
 * skipped. */
static hf_status read_load_cases(hf_merged *m, hf_messages *messages)
{
    static const char *const key[] = {"psi_m", "n_slack", "n_loose", "tension_max_N"};
    static const char *const error[] = {"half_path", "gain_loss", "fit_", "facet_", "refocused", "fixed", "pointing"};
    char group[GROUP_SIZE];
    hf_texts names = {0};
    hf_status status = hf_store_read_names(m->path, "/points/load_cases", &names, messages);
    for (int i = 0; i < names.n && status == HF_OK; i++) {
        const char *name = hf_texts_at(&names, i);
        int from = m->n_figure;
        if (strlen(name) >= HF_SET_NAME_SIZE) continue;
        snprintf(group, sizeof group, "/points/load_cases/%s", name);
        for (size_t k = 0; k < sizeof key / sizeof *key && status == HF_OK; k++)
            status = read_figure(m, HF_MERGED_LOAD_CASES, group, key[k], messages);
        for (size_t k = 0; k < sizeof error / sizeof *error && status == HF_OK; k++)
            status = read_group(m, HF_MERGED_LOAD_CASES, group, error[k], messages);
        for (int k = from; k < m->n_figure; k++)
            strcpy(m->figure[k].load_case, name);
    }
    hf_texts_free(&names);
    return status;
}

static hf_status read_stage(hf_merged *m, hf_merged_stage stage, hf_messages *messages)
{
    char group[GROUP_SIZE], surface[GROUP_SIZE];
    snprintf(group, sizeof group, "/points/%s", hf_merged_stage_word(NULL, stage));
    snprintf(surface, sizeof surface, "/points/surface/%s", hf_merged_stage_word(NULL, stage));
    for (int k = 0; k < N_KEY; k++)
        HF_TRY(read_figure(m, stage, group, key_of_stage[k], messages));
    int n_before = m->n_figure;
    HF_TRY(read_group(m, stage, group, "objective_", messages));
    if (m->n_figure > n_before + 1) HF_TRY(read_figure(m, stage, group, "merit", messages));
    return read_group(m, stage, surface, "", messages);
}

/* Reads the verdicts on the requirements. If a part is missing or does not fit, the study has none. */
static hf_status read_requirements(hf_merged *m, hf_messages *messages)
{
#define REQUIREMENTS "/points/requirements"
    HF_TRY(hf_store_read_texts(m->path, REQUIREMENTS "/name", &m->row_name, messages));
    if (m->row_name.n == 0) return HF_OK;
    HF_TRY(hf_store_read_series(m->path, REQUIREMENTS "/verdict", m->row_name.n, &m->row_verdict, messages));
    HF_TRY(hf_store_read_series(m->path, REQUIREMENTS "/margin", m->row_name.n, &m->row_margin, messages));
    HF_TRY(hf_store_read_series(m->path, REQUIREMENTS "/relative_margin", m->row_name.n, &m->row_relative_margin,
                                messages));
    HF_TRY(hf_store_read_series(m->path, REQUIREMENTS "/value", m->row_name.n, &m->row_value, messages));
    HF_TRY(hf_store_read_series(m->path, REQUIREMENTS "/at_least", m->row_name.n, &m->row_at_least, messages));
    HF_TRY(hf_store_read_series(m->path, REQUIREMENTS "/at_most", m->row_name.n, &m->row_at_most, messages));
    if (m->row_verdict.n != m->n || m->row_margin.n != m->n || m->row_relative_margin.n != m->n) return HF_OK;
    m->n_row = m->row_name.n;
    HF_TRY(read_figure(m, HF_MERGED_REQUIREMENTS, REQUIREMENTS, "n_failed", messages));
    HF_TRY(read_figure(m, HF_MERGED_REQUIREMENTS, REQUIREMENTS, "n_undecided", messages));
    return read_figure(m, HF_MERGED_REQUIREMENTS, REQUIREMENTS, HF_MERGED_MARGIN, messages);
}

static hf_status read_axes(hf_merged *m, hf_messages *messages)
{
    char name[512];
    HF_TRY(hf_store_read_names(m->path, "/points/input", &m->input_name, messages));
    m->n_axis = m->input_name.n < HF_STUDY_AXIS_MAX ? m->input_name.n : HF_STUDY_AXIS_MAX;
    for (int a = 0; a < m->n_axis; a++) {
        snprintf(name, sizeof name, "/points/input/%s", hf_texts_at(&m->input_name, a));
        HF_TRY(hf_store_read_texts(m->path, name, &m->input_text[a], messages));
        if (!m->input_text[a].n) HF_TRY(hf_store_read_series(m->path, name, 0, &m->input[a], messages));
        if (m->input[a].n != m->n) hf_series_free(&m->input[a]);
        if (m->input_text[a].n != m->n) hf_texts_free(&m->input_text[a]);
        if (!strcmp(hf_texts_at(&m->input_name, a), HF_STUDY_REPLICATE)) m->replicate = a;
    }
    return HF_OK;
}

static hf_status read_points(hf_merged *m, hf_messages *messages)
{
    HF_TRY(hf_store_read_series(m->path, "/points/status", 1, &m->status, messages));
    HF_TRY(hf_store_read_texts(m->path, "/points/id", &m->id, messages));
    HF_TRY(hf_store_read_texts(m->path, "/points/reason", &m->reason, messages));
    HF_TRY(hf_store_read_texts(m->path, "/study/title", &m->title, messages));
    m->n = m->status.n;
    for (int i = 0; i < m->n; i++)
        if (!(m->status.value[i] >= 0 && m->status.value[i] <= SCHAR_MAX))
            return hf_error(messages, HF_IO,
                            "%s: this file is damaged, because the data set /points/status contains an unknown status",
                            m->path);
    if (m->id.n != m->n)
        return hf_error(messages, HF_IO,
                        "%s: this file is damaged, because the data set /points/id does not contain every point",
                        m->path);
    if (m->reason.n != m->n)
        return hf_error(messages, HF_IO,
                        "%s: this file is damaged, because the data set /points/reason does not contain every point",
                        m->path);
    return HF_OK;
}

/* Reads a number of nodes that all completed points agree on, otherwise 0. */
static hf_status read_count(const hf_merged *m, const char *name, int *count, hf_messages *messages)
{
    hf_series s = {0};
    bool is_first = true;
    hf_status status = hf_store_read_series(m->path, name, 1, &s, messages);
    for (int i = 0; i < m->n && s.n == m->n; i++) {
        if (!hf_merged_is_done(m, i)) continue;
        bool is_same = s.value[i] > 0 && s.value[i] <= INT_MAX && (is_first || s.value[i] == *count);
        *count = is_same ? (int)s.value[i] : 0;
        is_first = false;
        if (!is_same) break;
    }
    hf_series_free(&s);
    return status;
}

/* ---- what varies ---- */

bool hf_merged_is_done(const hf_merged *m, int i)
{
    return m->status.value[i] == HF_OK;
}

bool hf_merged_agree(const hf_merged *m, int a, int i, int j)
{
    const hf_series *s = &m->input[a];
    const hf_texts *t = &m->input_text[a];
    size_t n = (size_t)s->columns;
    if (s->n && memcmp(s->value + (size_t)i * n, s->value + (size_t)j * n, n * sizeof(double)) != 0) return false;
    return !t->n || !strcmp(hf_texts_at(t, i), hf_texts_at(t, j));
}

bool hf_merged_axis_varies(const hf_merged *m, int a)
{
    for (int i = 1; i < m->n; i++)
        if (!hf_merged_agree(m, a, 0, i)) return true;
    return false;
}

const hf_merged_figure *hf_merged_find(const hf_merged *m, hf_merged_stage stage, const char *key)
{
    for (int k = 0; k < m->n_figure; k++)
        if (m->figure[k].stage == stage && !strcmp(m->figure[k].key, key)) return &m->figure[k];
    return NULL;
}

bool hf_merged_is_beyond(const hf_merged *m, const hf_merged_figure *loss, int i)
{
    size_t kind = (size_t)(strstr(loss->key, "gain_loss_at_") - loss->key);
    for (int k = 0; k < m->n_figure; k++) {
        const hf_merged_figure *f = &m->figure[k];
        if (f->stage == loss->stage && !strcmp(f->load_case, loss->load_case) && !strncmp(f->key, loss->key, kind) &&
            !strcmp(f->key + kind, "half_path_rms_m"))
            return !isnan(f->value.value[i]);
    }
    return false;
}

/* Computes hf_merged_figure.is_same. */
static bool is_same(const hf_merged *m, const hf_merged_figure *f)
{
    double low = INFINITY, high = -INFINITY;
    int n_done = 0, n_value = 0;
    for (int i = 0; i < m->n; i++) {
        double value = f->value.value[i];
        if (!hf_merged_is_done(m, i)) continue;
        n_done++;
        if (isnan(value)) continue;
        n_value++;
        low = fmin(low, value);
        high = fmax(high, value);
    }
    double size = fmax(fabs(low), fabs(high));
    if (n_value == 0 || low == high) return n_value == 0 || n_value == n_done;
    if (n_value < n_done || isinf(size)) return false;
    return high - low <= SAME_RATIO * size || (size < RESOLVED_M && !strcmp(hf_ledger_unit(f->key), "m"));
}

/* Computes hf_merged_figure.is_psi. */
static bool is_psi(const hf_merged *m, const hf_merged_figure *f)
{
    const hf_merged_figure *psi = hf_merged_find(m, f->stage, "psi_m");
    if (!psi || strncmp(f->key, "objective_", 10) != 0 || strcmp(hf_ledger_unit(f->key), "m") != 0) return false;
    for (int i = 0; i < m->n; i++) {
        double value = f->value.value[i], of_psi = psi->value.value[i];
        if (hf_merged_is_done(m, i) && !(fabs(value - of_psi) <= ROUNDING * of_psi)) return false;
    }
    return true;
}

/* Where the refined design of a point is not the result, the figures of its search take their place. The stage is then
 * called the result. */
static void take_results(hf_merged *m, const hf_series *is_refined)
{
    for (int i = 0; i < m->n; i++)
        m->is_mixed |= hf_merged_is_done(m, i) && is_refined->value[i] != 1;
    for (int k = 0; k < m->n_figure; k++) {
        hf_merged_figure *f = &m->figure[k];
        const hf_merged_figure *searched = hf_merged_find(m, HF_MERGED_SEARCH, f->key);
        for (int i = 0; i < m->n && f->stage == HF_MERGED_REFINE && searched; i++)
            if (is_refined->value[i] != 1) f->value.value[i] = searched->value.value[i];
    }
}

/* Chooses the stage that is the result. It is the last one that any point has. */
static hf_status choose_main(hf_merged *m, hf_messages *messages)
{
    hf_series is_result = {0};
    HF_TRY(hf_store_read_series(m->path, "/points/refine/is_result", 1, &is_result, messages));
    bool is_refine = false, has_search = hf_merged_find(m, HF_MERGED_SEARCH, "psi_m") != NULL;
    for (int i = 0; i < is_result.n; i++)
        is_refine |= is_result.value[i] == 1;
    if (!has_search) is_refine = hf_merged_find(m, HF_MERGED_REFINE, "psi_m") != NULL;
    m->main = is_refine ? HF_MERGED_REFINE : has_search ? HF_MERGED_SEARCH : HF_MERGED_FORM;
    if (is_refine && has_search && is_result.n == m->n) take_results(m, &is_result);
    hf_series_free(&is_result);
    return HF_OK;
}

/* ---- verdicts ---- */

static hf_verdict verdict_of(const hf_merged *m, int i, int row)
{
    double verdict = m->row_verdict.value[(size_t)i * (size_t)m->n_row + (size_t)row];
    return verdict >= 0 && verdict < HF_VERDICT_NONE ? (hf_verdict)verdict : HF_VERDICT_NONE;
}

/* Returns the row that decides. Rows without a relative margin come last among those of the same verdict. */
static int tightest_of(const hf_merged *m, int i)
{
    static const hf_verdict order[] = {HF_VERDICT_FAIL, HF_VERDICT_UNDECIDED, HF_VERDICT_PASS};
    for (size_t k = 0; k < sizeof order / sizeof *order; k++) {
        int tightest = -1;
        double least = INFINITY;
        for (int row = 0; row < m->n_row; row++) {
            double margin = m->row_relative_margin.value[(size_t)i * (size_t)m->n_row + (size_t)row];
            if (verdict_of(m, i, row) != order[k] || (tightest >= 0 && !(margin < least))) continue;
            tightest = row;
            least = isnan(margin) ? (double)INFINITY : margin;
        }
        if (tightest >= 0) return tightest;
    }
    return -1;
}

static hf_merged_judgement judge(const hf_merged *m, int i)
{
    hf_merged_judgement j = {.verdict = HF_VERDICT_NONE, .of.relative_margin_min = (double)NAN, .tightest = -1};
    if (!hf_merged_is_done(m, i)) return j;
    for (int row = 0; row < m->n_row; row++) {
        hf_verdict verdict = verdict_of(m, i, row);
        j.of.n_required += verdict != HF_VERDICT_NONE;
        j.of.n_failed += verdict == HF_VERDICT_FAIL;
        j.of.n_undecided += verdict == HF_VERDICT_UNDECIDED;
    }
    if (j.of.n_required == 0) return j;
    j.verdict = hf_judgement_verdict(&j.of);
    j.tightest = tightest_of(m, i);
    return j;
}

bool hf_merged_is_judged(const hf_merged *m)
{
    for (int i = 0; i < m->n; i++)
        if (m->judgement[i].verdict != HF_VERDICT_NONE) return true;
    return false;
}

/* Compares two points by their verdicts, as hf_judgement_compare does. */
static int compare_verdicts(const hf_merged *m, int i, int j)
{
    return hf_judgement_compare(&m->judgement[i].of, &m->judgement[j].of);
}

bool hf_merged_is_margin(const hf_merged *m, int figure)
{
    return figure >= 0 && m->figure[figure].stage == HF_MERGED_REQUIREMENTS;
}

/* Returns the value of a figure that ranks, of which less is better. NaN ranks last. */
static double rank_value(const hf_merged *m, int figure, int i)
{
    double value = m->figure[figure].value.value[i];
    if (hf_merged_is_margin(m, figure)) value = -value;
    return isnan(value) ? (double)INFINITY : value;
}

double hf_merged_rank_value(const hf_merged *m, int i)
{
    return hf_merged_is_done(m, i) ? rank_value(m, m->lead, i) : (double)INFINITY;
}

/* ---- the best point ---- */

/* Appends a figure to the ranking, if it varies and there is room. */
static void try_lead(hf_merged *m, hf_merged_stage stage, const char *key)
{
    const hf_merged_figure *f = hf_merged_find(m, stage, key);
    if (m->leads.n < m->leads.most && f && !f->is_same) m->leads.figure[m->leads.n++] = (int)(f - m->figure);
}

/* Returns the rounding of an objective. Values below it do not rank points. */
static double rounding_of(const hf_merged *m, const char *objective)
{
    const hf_merged_figure *f = hf_merged_find(m, HF_MERGED_FORM, objective);
    double size = 0;
    for (int i = 0; f && m->main != HF_MERGED_FORM && i < m->n; i++)
        if (hf_merged_is_done(m, i)) size = fmax(size, fabs(f->value.value[i]));
    return REACHED_RATIO * size;
}

/* Returns the value of ranking figure k, without differences of rounding. */
static double rounded_value(const hf_merged *m, int k, int i)
{
    double value = rank_value(m, m->leads.figure[k], i), least = m->leads.floor[k];
    if (hf_merged_is_margin(m, m->leads.figure[k]) && fabs(value) < MARGIN_SHOWN) return 0;
    if (value == 0 || !isfinite(value)) return fmax(least, value);
    double unit = SAME_RATIO * pow(10, floor(log10(fabs(value))));
    return fmax(least, unit * round(value / unit));
}

/* Compares two points by their verdicts and then by the ranking figures: negative if i ranks first. */
static int compare(const hf_merged *m, int i, int j)
{
    int order = compare_verdicts(m, i, j);
    for (int k = 0; k < m->leads.n && order == 0; k++) {
        double a = rounded_value(m, k, i), b = rounded_value(m, k, j);
        order = (a > b) - (a < b);
    }
    return order;
}

bool hf_merged_ranks_before(const hf_merged *m, int i, int j)
{
    int order = compare(m, i, j);
    return order ? order < 0 : i < j;
}

/* Chooses the figures that rank points of equal verdicts. The smallest relative margin comes first, then the objective
 * where it is not psi alone, as merit if there are several, then psi of the as-built nets where known, then psi of the
 * result. The surface error decides where psi is the same everywhere. */
static void choose_leads(hf_merged *m)
{
    static const char *const error[] = {"facet_half_path_rms_m", "half_path_rms_m", "facet_fit_half_path_rms_m",
                                        "fit_half_path_rms_m"};
    const char *objective = NULL;
    bool has_other = false;
    m->leads.most = 1;
    try_lead(m, HF_MERGED_REQUIREMENTS, HF_MERGED_MARGIN);
    int n_before = m->leads.n;
    if (n_before) m->leads.floor[0] = -INFINITY;
    m->leads.most = n_before + 2;
    for (int k = 0; k < m->n_figure; k++) {
        if (m->figure[k].stage != m->main || strncmp(m->figure[k].key, "objective_", 10) != 0) continue;
        objective = objective ? "merit" : m->figure[k].key;
        has_other |= !m->figure[k].is_psi;
    }
    if (has_other) try_lead(m, m->main, objective);
    if (m->leads.n > n_before) m->leads.floor[n_before] = rounding_of(m, objective);
    try_lead(m, HF_MERGED_BUILT, "psi_95_m");
    try_lead(m, m->main, "psi_m");
    for (size_t k = 0; k < sizeof error / sizeof *error; k++)
        try_lead(m, m->main, error[k]);
}

/* Returns whether ranking figure k does not tell the best point from others: its value is rounding, or all points with
 * its verdicts have its margin. */
static bool is_indifferent(const hf_merged *m, int k)
{
    bool is_margin = hf_merged_is_margin(m, m->leads.figure[k]);
    double best = rounded_value(m, k, m->best);
    for (int i = 0; i < m->n && is_margin; i++)
        if (hf_merged_is_done(m, i) && compare_verdicts(m, i, m->best) == 0 && rounded_value(m, k, i) != best)
            return false;
    return is_margin || best <= m->leads.floor[k];
}

/* Chooses the ranking figure and the best point. Where nothing is required, the best point needs a value of that
 * figure. */
static void choose_best(hf_merged *m)
{
    choose_leads(m);
    bool is_judged = hf_merged_is_judged(m), varies = m->leads.n > 0;
    m->lead = m->leads.n ? m->leads.figure[0] : -1;
    m->best = -1;
    for (int i = 1; i < m->n && is_judged && !varies; i++)
        varies = compare_verdicts(m, 0, i) != 0;
    for (int i = 0; i < m->n && varies; i++)
        if (hf_merged_is_done(m, i) && (is_judged || isfinite(m->figure[m->lead].value.value[i])) &&
            (m->best < 0 || compare(m, i, m->best) < 0))
            m->best = i;
    for (int k = 1; m->best >= 0 && k < m->leads.n && is_indifferent(m, k - 1); k++)
        m->lead = m->leads.figure[k];
}

/* ---- columns of the requirements ---- */

int hf_merged_failing(const hf_merged *m, int row, int *n_judged)
{
    int n_failed = 0;
    *n_judged = 0;
    for (int i = 0; i < m->n; i++) {
        hf_verdict verdict = hf_merged_is_done(m, i) ? verdict_of(m, i, row) : HF_VERDICT_NONE;
        n_failed += verdict == HF_VERDICT_FAIL;
        *n_judged += verdict != HF_VERDICT_NONE;
    }
    return n_failed;
}

/* Points that a row fails, and points that it decides. */
typedef struct {
    int n_failed, n_decided;
} row_counts;

/* Returns whether the column of row a stands before that of row b. */
static bool is_before(const hf_merged *m, const row_counts *of, int a, int b)
{
    if (of[a].n_failed != of[b].n_failed) return of[a].n_failed > of[b].n_failed;
    if (of[a].n_decided != of[b].n_decided || m->best < 0) return of[a].n_decided > of[b].n_decided;
    const double *margin = m->row_relative_margin.value + (size_t)m->best * (size_t)m->n_row;
    return margin[a] < margin[b] || (isnan(margin[b]) && !isnan(margin[a]));
}

int hf_merged_required(const hf_merged *m, int row[HF_REQUIREMENT_ROWS_MAX])
{
    row_counts of[HF_REQUIREMENT_ROWS_MAX] = {{0}};
    int n = 0, n_judged;
    bool is_whole = m->row_value.n == m->n && m->row_at_least.n == m->n && m->row_at_most.n == m->n, has_any = false;
    if (!is_whole || m->n_row > HF_REQUIREMENT_ROWS_MAX) return 0;
    for (int i = 0; i < m->n * m->n_row; i++)
        has_any |= !isnan(m->row_value.value[i]) && hf_merged_is_done(m, i / m->n_row);
    for (int k = 0; k < m->n_row; k++)
        of[k].n_failed = hf_merged_failing(m, k, &n_judged);
    for (int i = 0; i < m->n; i++)
        if (m->judgement[i].tightest >= 0) of[m->judgement[i].tightest].n_decided++;
    for (; n < m->n_row && has_any; n++) {
        int k = n;
        for (; k > 0 && is_before(m, of, n, row[k - 1]); k--)
            row[k] = row[k - 1];
        row[k] = n;
    }
    return n;
}

const char *hf_merged_unit(const hf_merged *m, int row)
{
    hf_required_figure figure = hf_ledger_figure(hf_texts_at(&m->row_name, row));
    return figure < HF_REQUIRED_N_FIGURE ? hf_required_figure_unit[figure] : "";
}

double hf_merged_bound(const hf_merged *m, const hf_series *bound, int row)
{
    double first = (double)NAN;
    bool has_any = false;
    for (int i = 0; i < m->n; i++) {
        double value = bound->value[(size_t)i * (size_t)m->n_row + (size_t)row];
        if (!hf_merged_is_done(m, i)) continue;
        if (has_any && value != first && !(isnan(value) && isnan(first))) return (double)NAN;
        first = value;
        has_any = true;
    }
    return first;
}

/* ---- rounding ---- */

double hf_merged_rounding(const hf_merged *m)
{
    const char *key = m->figure[m->lead].key;
    return fmax(rounding_of(m, key), strcmp(hf_ledger_unit(key), "m") ? 0 : RESOLVED_M);
}

bool hf_merged_is_resolved(double a, double b, double rounding)
{
    if (isinf(a) || isinf(b)) return a != b;
    return fabs(a - b) > fmax(rounding, SAME_RATIO * fmax(fabs(a), fabs(b)));
}

/* ---- intervals that pass ---- */

typedef struct {
    double value;
    bool passes;
} tried;

static int by_value(const void *a, const void *b)
{
    return hf_compare_doubles(&((const tried *)a)->value, &((const tried *)b)->value);
}

int hf_merged_passing(const hf_merged *m, int axis, hf_merged_interval *interval, int most)
{
    const hf_series *s = &m->input[axis];
    int n = 0;
    if (!s->n || s->columns != 1 || !hf_merged_is_judged(m) || axis == m->replicate) return 0;
    for (int a = 0; a < m->n_axis; a++)
        if (a != axis && a != m->replicate && hf_merged_axis_varies(m, a)) return 0;
    tried *point = malloc((size_t)m->n * sizeof *point);
    for (int i = 0; i < m->n && point; i++)
        point[i] = (tried){s->value[i], m->judgement[i].verdict == HF_VERDICT_PASS};
    if (point) qsort(point, (size_t)m->n, sizeof *point, by_value);
    bool passed = false;
    for (int i = 0, next; point && i < m->n; i = next) {
        bool passes = true;
        for (next = i; next < m->n && !(point[next].value > point[i].value); next++)
            passes &= point[next].passes;
        if (passes && !passed && n == most) break;
        if (passes && !passed) interval[n++].low = point[i].value;
        if (passes) interval[n - 1].high = point[i].value;
        passed = passes;
    }
    free(point);
    return n;
}

const char *hf_merged_heading(const hf_merged *m)
{
    return m->title.n ? hf_texts_at(&m->title, 0) : hf_path_name(m->path);
}

hf_status hf_merged_read_points(const char *path, hf_merged *m, hf_messages *messages)
{
    *m = (hf_merged){.path = path, .lead = -1, .best = -1, .replicate = -1};
    HF_TRY(read_points(m, messages));
    HF_TRY(read_axes(m, messages));
    HF_TRY(read_count(m, "/points/form/n_inner_node", &m->n_inner_node, messages));
    HF_TRY(read_count(m, "/points/form/n_free", &m->n_free, messages));
    for (hf_merged_stage stage = HF_MERGED_FORM; stage < HF_MERGED_BUILT; stage++)
        HF_TRY(read_stage(m, stage, messages));
    for (int k = 0; k < N_BUILT; k++)
        HF_TRY(read_figure(m, HF_MERGED_BUILT, "/points/tolerance", key_as_built[k], messages));
    HF_TRY(read_load_cases(m, messages));
    HF_TRY(read_requirements(m, messages));
    HF_TRY(choose_main(m, messages));
    for (int k = 0; k < m->n_figure; k++) {
        m->figure[k].is_same = is_same(m, &m->figure[k]);
        m->figure[k].is_psi = is_psi(m, &m->figure[k]);
    }
    m->judgement = calloc((size_t)m->n + 1, sizeof *m->judgement);
    if (!m->judgement) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    for (int i = 0; i < m->n; i++)
        m->judgement[i] = judge(m, i);
    choose_best(m);
    return HF_OK;
}

void hf_merged_free(hf_merged *m)
{
    hf_texts_free(&m->id);
    hf_texts_free(&m->reason);
    hf_texts_free(&m->title);
    hf_texts_free(&m->input_name);
    hf_texts_free(&m->row_name);
    hf_series_free(&m->row_verdict);
    hf_series_free(&m->row_margin);
    hf_series_free(&m->row_relative_margin);
    hf_series_free(&m->row_value);
    hf_series_free(&m->row_at_least);
    hf_series_free(&m->row_at_most);
    free(m->judgement);
    free(m->group);
    hf_series_free(&m->status);
    for (int a = 0; a < HF_STUDY_AXIS_MAX; a++) {
        hf_series_free(&m->input[a]);
        hf_texts_free(&m->input_text[a]);
    }
    for (int k = 0; k < HF_MERGED_FIGURE_MAX; k++)
        hf_series_free(&m->figure[k].value);
}
