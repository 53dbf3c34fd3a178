#include "case/config_rename.h"

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
    {"optimize.objective[].goal", "optimize.objective[].figure"},
    {"optimize.objective[].state", "optimize.objective[].load_case"},
    {"optimize.limits[].limit", "optimize.limits[].figure"},
    {"optimize.objectives", "optimize.front"},
    {"optimize.front[].goal", "optimize.front[].figure"},
    {"optimize.front[].state", "optimize.front[].load_case"},
    {"optimize.polish_iterations", "optimize.refine_steps"},
    {"tolerance.yield", "tolerance.required_yield"},

    {"adjust.aim=theory", "adjust.aim=target_positions"},
    {"optimize.objective[].figure=displacement", "optimize.objective[].figure=deflection"},
    {"optimize.objective[].over=states", "optimize.objective[].load_case=all"},
    {"optimize.limits[].figure=displacement", "optimize.limits[].figure=deflection"},
    {"optimize.front[].figure=displacement", "optimize.front[].figure=deflection"},
    {"optimize.front[].over=states", "optimize.front[].load_case=all"},
    {"tolerance.require[].measure=least_tension_N", "tolerance.require[].measure=tension_min_N"},
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

bool hf_config_rename(hf_config_faults *f, size_t line, size_t column, const char *old, char now[HF_KEY_SIZE])
{
    char where[48] = "", what[2 * HF_PATH_SIZE];
    bool is_old = false;
    snprintf(now, HF_KEY_SIZE, "%s", old);
    for (size_t i = 0; i < sizeof renamed / sizeof *renamed; i++)
        is_old |= replace(renamed[i][0], renamed[i][1], now);
    if (!is_old) return false;
    if (!f->location && !f->is_override) snprintf(where, sizeof where, ":%zu:%zu", line + 1, column + 1);
    snprintf(what, sizeof what, "%s%s%s: %s is now %s: rename it, because version 0.4 refuses the old name",
             f->is_override ? "--set " : "", f->origin, where, old, now);
    /* A study is read before its first point, which has the same text. */
    if (!f->messages || !f->messages->text || !strstr(f->messages->text, what)) hf_warning(f->messages, "%s", what);
    return true;
}

void hf_config_old_name(const char *now, char old[HF_KEY_SIZE])
{
    snprintf(old, HF_KEY_SIZE, "%s", now);
    for (size_t i = sizeof renamed / sizeof *renamed; i-- > 0;)
        replace(renamed[i][1], renamed[i][0], old);
}
