#include "case/config_rename.h"

#include "base/elementary.h"
#include "case/config_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Old and new names; [] is the number of a row. A list stands before its rows, which are in the new list. Version 0.4
 * refuses the old names. */
static const char *const renamed[][2] = {
    {"adjust.moves", "adjust.max_adjustments"},
    {"cases", "load_cases"},
    {"load_cases[].move_m", "load_cases[].support_displacement_m"},
    {"optimize.compare_lm", "optimize.refine"},
    {"optimize.goals", "optimize.objective"},
    {"optimize.objective[].fit", "optimize.objective[].feed"},
    {"optimize.objective[].goal", "optimize.objective[].figure"},
    {"optimize.objective[].state", "optimize.objective[].load_case"},
    {"optimize.limits[].limit", "optimize.limits[].figure"},
    {"optimize.objectives", "optimize.front"},
    {"optimize.front[].fit", "optimize.front[].feed"},
    {"optimize.front[].goal", "optimize.front[].figure"},
    {"optimize.front[].state", "optimize.front[].load_case"},
    {"optimize.polish_iterations", "optimize.refine_steps"},

    {"adjust.aim=theory", "adjust.aim=target_positions"},
    {"optimize.objective[].feed=best", "optimize.objective[].feed=refocused"},
    {"optimize.objective[].feed=none", "optimize.objective[].feed=fixed"},
    {"optimize.objective[].figure=displacement", "optimize.objective[].figure=deflection"},
    {"optimize.objective[].over=states", "optimize.objective[].load_case=all"},
    {"optimize.limits[].figure=displacement", "optimize.limits[].figure=deflection"},
    {"optimize.front[].feed=best", "optimize.front[].feed=refocused"},
    {"optimize.front[].feed=none", "optimize.front[].feed=fixed"},
    {"optimize.front[].figure=displacement", "optimize.front[].figure=deflection"},
    {"optimize.front[].over=states", "optimize.front[].load_case=all"},
};

/* Returns the rest of `name` behind the pattern, or NULL if it does not begin with it. *row is set to the number of the
 * row with its point, n_row characters. */
static const char *behind(const char *pattern, const char *name, const char **row, int *n_row)
{
    for (; *pattern; pattern++) {
        if (*pattern == '[') {
            *row = name;
            *n_row = *name == '.' ? 1 + (int)strspn(name + 1, "0123456789") : 0;
            name += *n_row;
            pattern++;
        } else if (*pattern != *name++) {
            return NULL;
        }
    }
    return *name == '\0' || *name == '.' || *name == '=' ? name : NULL;
}

/* Replaces the beginning of a name. Returns true if it is `from`. */
static bool replace(const char *from, const char *to, char name[HF_KEY_SIZE])
{
    char now[HF_KEY_SIZE];
    const char *row = "", *rest;
    int n_row = 0, n_list = (int)strcspn(to, "[");
    if (!(rest = behind(from, name, &row, &n_row))) return false;
    snprintf(now, sizeof now, "%.*s%.*s%s%s", n_list, to, n_row, row, to[n_list] ? to + n_list + 2 : "", rest);
    memcpy(name, now, sizeof now);
    return true;
}

/* A study is read before its first point, which has the same text. */
static void warn_once(hf_config_faults *f, const char *what)
{
    if (!f->messages || !f->messages->text || !strstr(f->messages->text, what)) hf_warning(f->messages, "%s", what);
}

bool hf_config_rename(hf_config_faults *f, size_t line, size_t column, const char *old, char now[HF_KEY_SIZE])
{
    char where[48] = "", what[2 * HF_PATH_SIZE];
    bool has_word = strchr(old, '='), is_old = false;
    snprintf(now, HF_KEY_SIZE, "%s", old);
    for (size_t i = 0; i < sizeof renamed / sizeof *renamed; i++)
        if (replace(renamed[i][0], renamed[i][1], now)) is_old |= !has_word || strchr(renamed[i][1], '=');
    if (!is_old) return false;
    if (!f->location && !f->is_override) snprintf(where, sizeof where, ":%zu:%zu", line + 1, column + 1);
    snprintf(what, sizeof what, "%s%s%s: %s is now %s: rename it, because version 0.4 refuses the old name",
             f->is_override ? "--set " : "", f->origin, where, old, now);
    warn_once(f, what);
    return true;
}

void hf_config_old_name(const char *now, char old[HF_KEY_SIZE])
{
    snprintf(old, HF_KEY_SIZE, "%s", now);
    for (size_t i = sizeof renamed / sizeof *renamed; i-- > 0;)
        replace(renamed[i][1], renamed[i][0], old);
}

/* ---- tolerance.require ---- */

#define ROW(word, figure, feed, is_ruze) {HF_REQUIRED_##figure, HF_##feed, is_ruze},
static const struct {
    hf_required_figure figure;
    hf_focus feed;
    bool is_ruze;
} converted[] = {HF_OLD_MEASURES(ROW)};
#undef ROW

#define SHARE_DEFAULT 0.95
#define RUZE_MOST_DB 3.0 /* the old losses were infinite above */

/* Returns the RMS half-path error from which a gain loss follows by Ruze's formula at the highest frequency. */
static double rms_of_loss(const hf_case *c, double loss_dB)
{
    if (isnan(loss_dB)) return loss_dB;
    return HF_LIGHT_M_PER_S / (4 * HF_PI * hf_config_highest_Hz(c)) * sqrt(fmin(loss_dB, RUZE_MOST_DB) / HF_DB_PER_LN);
}

/* Copies the location of a key of an old row to that of the new one. */
static void move_location(hf_config_faults *f, int row, const char *old, const char *now)
{
    char path[HF_KEY_SIZE];
    hf_key from, to;
    snprintf(path, sizeof path, "tolerance.require.%d%s", row, old);
    bool is_known = hf_key_find(path, &from);
    snprintf(path, sizeof path, "requirements.%d%s", row, now);
    if (is_known && hf_key_find(path, &to))
        memcpy(hf_config_where(f, to.i_location), hf_config_where(f, from.i_location), HF_CONFIG_WHERE_SIZE);
}

/* Converts a row and adds its text to the warning. */
static void convert(hf_case *c, hf_config_faults *f, int i, double share, char *text, size_t size)
{
    const hf_require_settings *old = &c->tolerance.require[i];
    hf_requirement_settings *r = &c->requirement[i];
    *r = (hf_requirement_settings){.figure = converted[old->measure].figure,
                                   .feed = converted[old->measure].feed,
                                   .frequency_Hz = (double)NAN,
                                   .load_case = "nominal",
                                   .at_least = old->at_least,
                                   .at_most = old->at_most,
                                   .within = {-INFINITY, INFINITY},
                                   .share = share,
                                   .search = HF_SEARCH_OFF};
    if (converted[old->measure].is_ruze) {
        r->at_least = rms_of_loss(c, old->at_least);
        r->at_most = rms_of_loss(c, old->at_most);
    }
    size_t n = strlen(text);
    n += (size_t)snprintf(text + n, size - n, "%s{figure: %s", i ? ", " : "", hf_required_figure_word[r->figure]);
    if (r->feed == HF_FIXED) n += (size_t)snprintf(text + n, size - n, ", feed: fixed");
    if (!isnan(r->at_least)) n += (size_t)snprintf(text + n, size - n, ", at_least: %.10g", r->at_least);
    if (!isnan(r->at_most)) n += (size_t)snprintf(text + n, size - n, ", at_most: %.10g", r->at_most);
    snprintf(text + n, size - n, ", share: %.10g, search: off}", share);
    move_location(f, i, "", "");
    move_location(f, i, ".measure", ".figure");
    move_location(f, i, ".at_least", ".at_least");
    move_location(f, i, ".at_most", ".at_most");
}

void hf_config_rename_require(hf_case *c, hf_config_faults *f)
{
    hf_tolerance_settings *t = &c->tolerance;
    bool has_yield = t->required_yield > 0;
    char place[HF_LOCATION_SIZE], text[HF_REQUIRE_ROWS_MAX * HF_KEY_SIZE] = "", what[2 * HF_PATH_SIZE + sizeof text];
    if (f->failed || (t->n_require == 0 && !has_yield)) return;
    hf_config_place(c, place, t->n_require ? "tolerance.require.0" : "tolerance.required_yield");
    if (t->n_require == 0 || c->n_requirement > 0) {
        hf_config_fault_of(f, t->n_require ? "tolerance.require.0" : "tolerance.required_yield",
                           "is an old key; write it as figure, bound and share of the rows of `requirements`");
        return;
    }
    for (int i = 0; i < t->n_require; i++) {
        if (converted[t->require[i].measure].is_ruze && c->surface.frequencies_Hz.n == 0)
            hf_config_fault_in_row(f, "tolerance.require", i, "measure", "needs surface.frequencies_Hz");
        if (f->failed) return;
        convert(c, f, i, has_yield ? t->required_yield : SHARE_DEFAULT, text, sizeof text);
    }
    c->n_requirement = t->n_require;
    t->find_scale |= has_yield;
    snprintf(
        what, sizeof what,
        "%s: this list is now `requirements`. Write `requirements: [%s]`%s instead, because version 0.4 refuses the "
        "old keys",
        place, text, has_yield ? " and `find_scale: true` in tolerance" : "");
    warn_once(f, what);
}
