/* What a row of a ledger holds of a point's summary: its numbers, and the goals of each stage as one text, since what
 * they are called may differ from point to point. Contents: numbers - fields - goals */
#include "store/ledger.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- numbers ---- */

const hf_hdf5_member *hf_ledger_column(int i)
{
    for (int part = 0; part < HF_LAYOUT_N_PART; part++)
        for (int k = 0; k < hf_layout_summary[part].n; k++)
            if (hf_layout_summary[part].member[k].kind != HF_KIND_CHARS && i-- == 0)
                return &hf_layout_summary[part].member[k];
    return NULL;
}

int hf_ledger_n_column(void)
{
    int n = 0;
    for (int part = 0; part < HF_LAYOUT_N_PART; part++)
        for (int k = 0; k < hf_layout_summary[part].n; k++)
            n += hf_layout_summary[part].member[k].kind != HF_KIND_CHARS;
    return n;
}

bool hf_ledger_is_circumstance(const hf_hdf5_member *column)
{
    size_t n = strlen(column->name);
    return !strcmp(column->name, "threads") || (n > 2 && !strcmp(column->name + n - 2, "_s"));
}

/* Did the run reach the stage to which this number belongs? */
static bool applies(const hf_hdf5_member *column, const hf_summary *s)
{
    if (s->form.status == HF_NOT_EVALUATED) return false;
    if (!strcmp(column->object, "/truss")) return s->has_truss;
    if ((!strcmp(column->object, "/coupling") || strstr(column->name, "coupling_")) && !s->has_coupling) return false;
    if (!strcmp(column->object, "/ga")) return s->has_optimize;
    if (!strcmp(column->object, "/polish")) return s->has_polish;
    if (!strcmp(column->object, "/tolerance")) return s->has_tolerance;
    return true;
}

static int print_number(const hf_hdf5_member *column, const hf_summary *s, char *text, size_t size)
{
    const void *from = (const char *)s + column->offset;
    switch (column->kind->class) {
    case HF_HDF5_REAL:
        return snprintf(text, size, "%.17g", *(const double *)from);
    case HF_HDF5_LONG:
        return snprintf(text, size, "%ld", *(const long *)from);
    case HF_HDF5_UINT64:
        return snprintf(text, size, "%" PRIu64, *(const uint64_t *)from);
    default:
        return snprintf(text, size, "%d", hf_hdf5_int_value(column, s));
    }
}

/* ---- fields ---- */

/* The place of the goals of each stage in a merge: the group, and what their names begin with. */
const char *const hf_ledger_goals_place[HF_LAYOUT_N_GOALS_STAGE][2] = {
    {"/form", ""}, {"/ga", "best_"}, {"/polish", ""}};

int hf_ledger_n_field(void)
{
    return hf_ledger_n_column() + HF_LAYOUT_N_GOALS_STAGE;
}

int hf_ledger_field_name(int i, char *text, size_t size)
{
    const hf_hdf5_member *column = hf_ledger_column(i);
    if (column) return snprintf(text, size, "%s/%s", column->object, column->name);
    const char *const *place = hf_ledger_goals_place[i - hf_ledger_n_column()];
    return snprintf(text, size, "%s/%sgoals", place[0], place[1]);
}

/* "goal_0_psi=0.001 goal_1_tension_edge=3" */
static int print_goals(const hf_summary *s, int stage, char *text, size_t size)
{
    const double *goal = hf_layout_goals(s, stage);
    size_t used = 0;
    for (int k = 0; goal && k < s->goals.n && used < size; k++)
        used += (size_t)snprintf(text + used, size - used, "%s%s=%.17g", k ? " " : "", s->goals.name[k], goal[k]);
    return (int)used;
}

int hf_ledger_print_field(int i, const hf_summary *s, char *text, size_t size)
{
    const hf_hdf5_member *column = hf_ledger_column(i);
    if (column) return applies(column, s) ? print_number(column, s, text, size) : 0;
    return s->form.status == HF_NOT_EVALUATED ? 0 : print_goals(s, i - hf_ledger_n_column(), text, size);
}

/* ---- goals ---- */

bool hf_ledger_next_goal(const char **text, char name[HF_GOAL_NAME_SIZE], double *value)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    const char *p = *text + (**text == ' ');
    size_t n = strspn(p, letters);
    char *end;
    if (strncmp(p, "goal_", 5) != 0 || n >= HF_GOAL_NAME_SIZE || p[n] != '=') return false;
    memcpy(name, p, n);
    name[n] = '\0';
    *value = strtod(p + n + 1, &end);
    *text = end;
    return end > p + n + 1;
}

const char *hf_ledger_goal_unit(const char *name)
{
    const char *word = name + strcspn(name, "0123456789");
    word += strspn(word, "0123456789_");
    for (int kind = 0; hf_goal_word[kind]; kind++) {
        size_t n = strlen(hf_goal_word[kind]);
        if (!strncmp(word, hf_goal_word[kind], n) && (!word[n] || word[n] == '_')) return hf_goal_unit[kind];
    }
    return "";
}
