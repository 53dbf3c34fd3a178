/* Reads a merged study and ranks its points:
 *
 *     tables of points ---> axes, figures of each stage ---> which figures vary ---> ranking figure ---> best point
 *       ---> whether the figure still falls at the end of an axis
 *
 * Contents: reading, what varies, the best point, the end of an axis, the required yield. */
#include "out/merged.h"

#include "base/path.h"
#include "store/ledger.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define SAME_RATIO 1e-6    /* relative difference up to which values count as equal */
#define RESOLVED_M 1e-9    /* differences of lengths below this are rounding */
#define REACHED_RATIO 1e-9 /* rounding of an objective, relative to its value after form-finding */

const char *const hf_merged_answer_word[HF_MERGED_N_ANSWER] = {"", "no", "open", "yes"};

const char *hf_merged_stage_word(hf_merged_stage stage)
{
    return stage < HF_MERGED_BUILT ? hf_stage_word[stage] : stage == HF_MERGED_BUILT ? "tolerance" : "load_cases";
}

/* ---- reading ---- */

#define GROUP_SIZE (HF_SET_NAME_SIZE + 32)
static const char *const key_of_stage[] = {"psi_m", "inner_tension_ratio", "boundary_tension_ratio", "residual_N",
                                           "n_slack"};
static const char *const key_as_built[] = {"psi_95_m", "yield", "yield_low", "yield_high", "required_yield"};
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
    snprintf(group, sizeof group, "/points/%s", hf_merged_stage_word(stage));
    snprintf(surface, sizeof surface, "/points/surface/%s", hf_merged_stage_word(stage));
    for (int k = 0; k < N_KEY; k++)
        HF_TRY(read_figure(m, stage, group, key_of_stage[k], messages));
    int n_before = m->n_figure;
    HF_TRY(read_group(m, stage, group, "objective_", messages));
    if (m->n_figure > n_before + 1) HF_TRY(read_figure(m, stage, group, "merit", messages));
    return read_group(m, stage, surface, "", messages);
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

/* ---- what varies ---- */

bool hf_merged_is_done(const hf_merged *m, int i)
{
    return m->status.value[i] == HF_OK;
}

/* Returns whether points i and j have the same value of axis a. */
static bool agree(const hf_merged *m, int a, int i, int j)
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
        if (!agree(m, a, 0, i)) return true;
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
    for (int i = 0; i < m->n; i++)
        if (hf_merged_is_done(m, i) && !(f->value.value[i] == psi->value.value[i])) return false;
    return true;
}

/* Chooses the stage that is the result. It is the search where that ran, unless a refinement continued it to the
 * result. */
static hf_status choose_main(hf_merged *m, hf_messages *messages)
{
    hf_series is_result = {0};
    HF_TRY(hf_store_read_series(m->path, "/points/refine/is_result", 1, &is_result, messages));
    bool is_refine = false, has_search = hf_merged_find(m, HF_MERGED_SEARCH, "psi_m") != NULL;
    for (int i = 0; i < is_result.n; i++)
        is_refine |= is_result.value[i] == 1;
    hf_series_free(&is_result);
    if (!has_search) is_refine = hf_merged_find(m, HF_MERGED_REFINE, "psi_m") != NULL;
    m->main = is_refine ? HF_MERGED_REFINE : has_search ? HF_MERGED_SEARCH : HF_MERGED_FORM;
    return HF_OK;
}

/* ---- the best point ---- */

/* Holds the figures that rank points: the first that varies, and a second one for points that are equal in it. */
typedef struct {
    int figure[2], n;
} leads;

/* Appends a figure to the ranking, if it varies and there is room. */
static void try_lead(const hf_merged *m, hf_merged_stage stage, const char *key, leads *to)
{
    const hf_merged_figure *f = hf_merged_find(m, stage, key);
    if (to->n < 2 && f && !f->is_same) to->figure[to->n++] = (int)(f - m->figure);
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

/* Returns whether point i ranks before `best`, which is -1 for none. */
static bool is_better(const hf_merged *m, const leads *by, double rounding, int i, int best)
{
    for (int k = 0; k < by->n && best >= 0; k++) {
        const double *value = m->figure[by->figure[k]].value.value;
        double floor = k ? 0 : rounding, a = fmax(value[i], floor), b = fmax(value[best], floor);
        if (fabs(a - b) > SAME_RATIO * fmax(fabs(a), fabs(b))) return a < b;
    }
    return best < 0;
}

/* Chooses the ranking figures and the best point. The objective comes first where it is not psi alone, as merit if
 * there are several. Otherwise it is psi of the as-built nets where known, then psi of the result. The surface error
 * decides where psi is the same everywhere. */
static void choose_best(hf_merged *m)
{
    static const char *const error[] = {"facet_half_path_rms_m", "half_path_rms_m", "facet_fit_half_path_rms_m",
                                        "fit_half_path_rms_m"};
    const char *objective = NULL;
    bool has_other = false;
    double rounding = 0;
    leads by = {.n = 0};
    for (int k = 0; k < m->n_figure; k++) {
        if (m->figure[k].stage != m->main || strncmp(m->figure[k].key, "objective_", 10) != 0) continue;
        objective = objective ? "merit" : m->figure[k].key;
        has_other |= !m->figure[k].is_psi;
    }
    if (has_other) try_lead(m, m->main, objective, &by);
    if (by.n) rounding = rounding_of(m, objective);
    try_lead(m, HF_MERGED_BUILT, "psi_95_m", &by);
    try_lead(m, m->main, "psi_m", &by);
    for (size_t k = 0; k < sizeof error / sizeof *error; k++)
        try_lead(m, m->main, error[k], &by);
    m->lead = by.n ? by.figure[0] : -1;
    m->best = -1;
    for (int i = 0; i < m->n && by.n; i++)
        if (hf_merged_is_done(m, i) && isfinite(m->figure[m->lead].value.value[i]) &&
            is_better(m, &by, rounding, i, m->best))
            m->best = i;
    bool is_rounding = m->best >= 0 && m->figure[m->lead].value.value[m->best] <= rounding;
    if (is_rounding && by.n > 1) m->lead = by.figure[1];
}

/* ---- the end of an axis ---- */

/* Returns whether point i agrees with the best point in all axes but this one. */
static bool is_on_curve(const hf_merged *m, int axis, int i)
{
    for (int a = 0; a < m->n_axis; a++)
        if (a != axis && !agree(m, a, i, m->best)) return false;
    return i != m->best;
}

/* Returns whether the ranking figure falls from point i to point j by more than rounding. */
static bool falls(const hf_merged *m, int i, int j)
{
    const hf_merged_figure *f = &m->figure[m->lead];
    double from = f->value.value[i], to = f->value.value[j], rounding = rounding_of(m, f->key);
    if (!strcmp(hf_ledger_unit(f->key), "m")) rounding = fmax(rounding, RESOLVED_M);
    return hf_merged_is_done(m, i) && from - to > fmax(rounding, SAME_RATIO * fmax(fabs(from), fabs(to)));
}

int hf_merged_falls_on(const hf_merged *m, int axis)
{
    const hf_series *s = &m->input[axis];
    int near = -1, next = -1, side = 0; /* the two points nearest to the best one, both on the same side of it */
    bool is_error = !strncmp(hf_texts_at(&m->input_name, axis), "tolerance.sigma_", 16);
    if (m->best < 0 || !s->n || s->columns != 1 || is_error) return 0;
    double at = s->value[m->best];
    for (int i = 0; i < m->n; i++) {
        double away = s->value[i] - at;
        if (away == 0 || !is_on_curve(m, axis, i)) continue;
        if (side && (away > 0) != (side > 0)) return 0;
        side = away > 0 ? 1 : -1;
        if (near < 0 || fabs(away) < fabs(s->value[near] - at)) {
            next = near;
            near = i;
        } else if (next < 0 || fabs(away) < fabs(s->value[next] - at)) {
            next = i;
        }
    }
    if (next < 0 || !falls(m, next, near) || !falls(m, near, m->best)) return 0;
    return -side;
}

/* ---- the required yield ---- */

static double built_value(const hf_merged *m, const char *key, int i)
{
    const hf_merged_figure *f = hf_merged_find(m, HF_MERGED_BUILT, key);
    return f && hf_merged_is_done(m, i) ? f->value.value[i] : (double)NAN;
}

hf_merged_answer hf_merged_meets_yield(const hf_merged *m, int i)
{
    double required = built_value(m, "required_yield", i);
    double low = built_value(m, "yield_low", i), high = built_value(m, "yield_high", i);
    if (!(required > 0) || isnan(low) || isnan(high)) return HF_MERGED_NOT_ASKED;
    return low >= required ? HF_MERGED_YES : high >= required ? HF_MERGED_OPEN : HF_MERGED_NO;
}

double hf_merged_required_yield(const hf_merged *m)
{
    double same = (double)NAN;
    for (int i = 0; i < m->n; i++) {
        double required = built_value(m, "required_yield", i);
        if (!isnan(required) && !isnan(same) && required != same) return (double)NAN;
        if (!isnan(required)) same = required;
    }
    return same;
}

const char *hf_merged_heading(const hf_merged *m)
{
    return m->title.n ? hf_texts_at(&m->title, 0) : hf_path_name(m->path);
}

hf_status hf_merged_read(const char *path, hf_merged *m, hf_messages *messages)
{
    *m = (hf_merged){.path = path, .lead = -1, .best = -1};
    HF_TRY(read_points(m, messages));
    HF_TRY(read_axes(m, messages));
    for (hf_merged_stage stage = HF_MERGED_FORM; stage < HF_MERGED_BUILT; stage++)
        HF_TRY(read_stage(m, stage, messages));
    for (int k = 0; k < N_BUILT; k++)
        HF_TRY(read_figure(m, HF_MERGED_BUILT, "/points/tolerance", key_as_built[k], messages));
    HF_TRY(read_load_cases(m, messages));
    for (int k = 0; k < m->n_figure; k++) {
        m->figure[k].is_same = is_same(m, &m->figure[k]);
        m->figure[k].is_psi = is_psi(m, &m->figure[k]);
    }
    HF_TRY(choose_main(m, messages));
    choose_best(m);
    return HF_OK;
}

void hf_merged_free(hf_merged *m)
{
    hf_texts_free(&m->id);
    hf_texts_free(&m->reason);
    hf_texts_free(&m->title);
    hf_texts_free(&m->input_name);
    hf_series_free(&m->status);
    for (int a = 0; a < HF_STUDY_AXIS_MAX; a++) {
        hf_series_free(&m->input[a]);
        hf_texts_free(&m->input_text[a]);
    }
    for (int k = 0; k < HF_MERGED_FIGURE_MAX; k++)
        hf_series_free(&m->figure[k].value);
}
