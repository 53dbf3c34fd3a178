/* Prints a merged study as text. Contents: columns, cells, the table, verdicts, lines, the whole text. */
#include "out/print_study.h"

#include "base/json.h"
#include "base/text.h"
#include "store/ledger.h"
#include <hifdm/surface.h>

#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#define WIDTH 100       /* maximum characters of a line of the table */
#define POINTS_MOST 64  /* maximum number of points that are all shown */
#define POINTS_BEST 32  /* points shown of a larger study, the best ones */
#define REASON_MOST 400 /* characters of a reason */
#define CELL_SIZE HF_PRINT_TIGHTEST_SIZE
#define NAME_MOST 60    /* characters of the name of a requirement */
#define REQUIRED_MOST 5 /* requirements with a column; --verbose shows all */
#define INTERVALS_MOST 8
#define WORD_MOST 24 /* characters of a word that is the value of an axis */
#define SMALL_M 0.1  /* an axis of smaller lengths is shown in millimetres */

/* ---- columns ---- */

typedef enum { OF_AXIS, OF_STATUS, OF_FIGURE, OF_VERDICT, OF_TIGHTEST, OF_REQUIRED, OF_GROUP } column_kind;

/* Describes a column of the table. Its head has lines of the name, which '\n' separates, and below them the unit. */
typedef struct {
    column_kind kind;
    int index; /* of the axis, the figure, the requirement or the statistic of a group */
    char head[2 * HF_AXIS_NAME_SIZE];
    char unit[HF_PRINT_BOUND_SIZE]; /* of a requirement its bounds */
    double scale;                   /* factor of the values for this unit */
    int width, n_line;              /* n_line: of the name */
} column;

typedef struct {
    const hf_merged *m;
    column column[HF_STUDY_AXIS_MAX + HF_MERGED_FIGURE_MAX + HF_REQUIREMENT_ROWS_MAX + 4];
    int n_column, n_axis; /* n_axis: the first columns are axes */
    bool of_groups;       /* true: a row is a group of replicates, given by its first point; false: a point */
    bool is_all;          /* true: all points or groups are rows; false: those of `best` */
    int n_row, best[POINTS_BEST];
    int n_required, required[HF_REQUIREMENT_ROWS_MAX]; /* requirements in the order of their columns */
    bool is_short; /* only the first requirements and the ranking figure have a column */
} table;

/* Makes a name printable, which may contain any characters, with blanks for "_". */
static void show_name(char name[HF_AXIS_NAME_SIZE])
{
    char shown[HF_AXIS_NAME_SIZE];
    hf_text_trim_utf8(name);
    hf_text_escape(name, shown, sizeof shown);
    strcpy(name, shown);
    for (char *p = name; *p; p++)
        if (*p == '_') *p = ' ';
}

/* Sets `name` to the name of an axis for people, such as "pretension" for form.pretension_N. Returns the unit of its
 * values. */
static const char *name_axis(const char *key, char name[HF_AXIS_NAME_SIZE])
{
    const char *dot = strrchr(key, '.'), *unit = hf_ledger_unit(key);
    const char *from = dot ? dot + 1 : key;
    const char *row = dot;
    while (row && row > key && row[-1] >= '0' && row[-1] <= '9')
        row--;
    if (row && row < dot && row > key && row[-1] == '.') /* a key of a row, such as objective.1.weight */
        for (from = row - 1; from > key && from[-1] != '.';)
            from--;
    const char *end = strstr(from, "_N_per_m");
    if (!end) end = strrchr(from, '_');
    int n = (int)(*unit && end ? end - from : (ptrdiff_t)strlen(from));
    snprintf(name, HF_AXIS_NAME_SIZE, "%.*s", n, from);
    show_name(name);
    return unit;
}

/* Returns the column of an axis. */
static column axis_column(const hf_merged *m, int a)
{
    const hf_series *s = &m->input[a];
    column c = {.kind = OF_AXIS, .index = a, .scale = 1};
    const char *unit = name_axis(hf_texts_at(&m->input_name, a), c.head);
    double most = 0;
    for (int i = 0; i < s->n * s->columns; i++)
        most = fmax(most, fabs(s->value[i]));
    if (strcmp(unit, "m") != 0 || (s->n && most < SMALL_M)) c.scale = hf_print_scale(unit, &unit);
    snprintf(c.unit, sizeof c.unit, "%s", unit);
    return c;
}

const char *hf_print_objective_words(const char *key, char words[HF_AXIS_NAME_SIZE])
{
    snprintf(words, HF_AXIS_NAME_SIZE, "%s", hf_ledger_objective(key));
    show_name(words);
    return words;
}

/* Prepends the load case to the name of its figure. The slack cables of the design get the word "design" when load
 * cases have slack cables, too. */
static void name_load_case(const hf_merged *m, const hf_merged_figure *f, char name[HF_AXIS_NAME_SIZE])
{
    char plain[HF_AXIS_NAME_SIZE];
    bool is_design = hf_merged_find(m, HF_MERGED_LOAD_CASES, f->key) && !strcmp(f->key, "n_slack") && !*f->load_case;
    if (!*f->load_case && !is_design) return;
    strcpy(plain, name);
    snprintf(name, HF_AXIS_NAME_SIZE, "%.31s %.31s", is_design ? "design" : f->load_case, plain);
}

/* Formats the name of a figure: "objective tension edge" for objective_1_tension_edge, "fitted loss 10 GHz" for
 * facet_fit_gain_loss_at_10_GHz_dB. */
static void name_figure(const hf_merged *m, const hf_merged_figure *f, char name[HF_AXIS_NAME_SIZE])
{
    static const char *const word[][2] = {{"psi_95_m", "psi of 95 %"},
                                          {"merit", "merit"},
                                          {HF_MERGED_MARGIN, "smallest margin"},
                                          {"yield", "yield"},
                                          {"inner_tension_ratio", "ratio inside"},
                                          {"boundary_tension_ratio", "boundary ratio"},
                                          {"n_slack", "slack"},
                                          {"n_loose", "loose"},
                                          {"tension_max_N", "T max"}};
    char at[32];
    bool of_facets = !strncmp(f->key, "facet_", 6);
    const char *rest = of_facets ? f->key + 6 : f->key, *fitted = strncmp(rest, "fit_", 4) ? "" : "fitted ";
    if (*fitted) rest += 4;
    snprintf(name, HF_AXIS_NAME_SIZE, "%.*s", HF_AXIS_NAME_SIZE - 1, f->key);
    if (!strcmp(f->key, "psi_m")) {
        snprintf(name, HF_AXIS_NAME_SIZE, m->main == HF_MERGED_FORM || *f->load_case ? "psi" : "psi %s",
                 hf_merged_stage_word(m, f->stage));
    } else if (!strncmp(f->key, "objective_", 10)) {
        char words[HF_AXIS_NAME_SIZE];
        snprintf(name, HF_AXIS_NAME_SIZE, "objective %.*s", HF_AXIS_NAME_SIZE - 11,
                 hf_print_objective_words(f->key, words));
    } else if (sscanf(f->key, "refocused_gain_loss_at_%31s", at) == 1 ||
               sscanf(f->key, "fixed_gain_loss_at_%31s", at) == 1) {
        snprintf(name, HF_AXIS_NAME_SIZE, "%s loss %.*s", *f->key == 'r' ? "refocused" : "fixed feed",
                 (int)strlen(at) - 3, at);
    } else if (sscanf(f->key, "pointing_at_%31s", at) == 1) {
        snprintf(name, HF_AXIS_NAME_SIZE, "fixed feed beam %.*s", (int)strlen(at) - 4, at);
    } else if (!strcmp(rest, "half_path_rms_m")) {
        snprintf(name, HF_AXIS_NAME_SIZE, "%s%s", fitted, of_facets ? "facets" : "half path");
    } else if (!strcmp(rest, "gain_loss_1dB_Hz")) {
        snprintf(name, HF_AXIS_NAME_SIZE, "%s1 dB gain loss", fitted);
    } else if (!strncmp(rest, "gain_loss_at_", 13)) {
        snprintf(name, HF_AXIS_NAME_SIZE, "%sloss %.*s", fitted, (int)strlen(rest + 13) - 3, rest + 13);
    }
    for (size_t k = 0; k < sizeof word / sizeof *word; k++)
        if (!strcmp(f->key, word[k][0])) strcpy(name, word[k][1]);
    name_load_case(m, f, name);
    show_name(name);
}

static column figure_column(const hf_merged *m, int k)
{
    const hf_merged_figure *f = &m->figure[k];
    column c = {.kind = OF_FIGURE, .index = k};
    const char *unit;
    c.scale = hf_print_scale(hf_ledger_unit(f->key), &unit);
    if (!strcmp(f->key, "yield") || f->stage == HF_MERGED_REQUIREMENTS) {
        unit = "%";
        c.scale = 100;
    }
    snprintf(c.unit, sizeof c.unit, "%s", unit);
    name_figure(m, f, c.head);
    return c;
}

/* Returns whether the study has the gain loss by physical optics beside this figure by Ruze's formula. */
static bool is_behind_optics(const hf_merged *m, const hf_merged_figure *f)
{
    if (!strstr(f->key, "gain_loss") || !strncmp(f->key, "refocused_", 10) || !strncmp(f->key, "fixed_", 6))
        return false;
    for (int k = 0; k < m->n_figure; k++)
        if (m->figure[k].stage == f->stage && !strcmp(m->figure[k].load_case, f->load_case) &&
            !strncmp(m->figure[k].key, "refocused_gain_loss_at_", 23))
            for (int i = 0; i < m->n; i++)
                if (isfinite(m->figure[k].value.value[i])) return true;
    return false;
}

/* Returns whether the table has this figure of a load case. Of the surface it has the gain losses or, without
 * frequencies, the errors. */
static bool is_shown_of_load_case(const hf_merged *m, const hf_merged_figure *f)
{
    if (strstr(f->key, "gain_loss_1dB_Hz")) return false;
    if (!strstr(f->key, "half_path_rms_m")) return true;
    for (int k = 0; k < m->n_figure; k++)
        if (!strcmp(m->figure[k].load_case, f->load_case) && strstr(m->figure[k].key, "gain_loss_at_")) return false;
    return true;
}

/* Returns whether the table has this figure. It has psi of every stage, and of the result everything but the
 * residual. */
static bool is_shown(const hf_merged *m, const hf_merged_figure *f)
{
    if (f->is_psi || !strcmp(f->key, "residual_N") || is_behind_optics(m, f)) return false;
    if (f->stage == HF_MERGED_REQUIREMENTS) return false; /* beside the verdict */
    if (f->stage == HF_MERGED_LOAD_CASES) return is_shown_of_load_case(m, f);
    if (f->stage == HF_MERGED_BUILT) return !strcmp(f->key, "psi_95_m") || !strcmp(f->key, "yield");
    return f->stage == m->main || !strcmp(f->key, "psi_m");
}

/* Returns the rank of a figure in the table: the ranking figure, psi, the as-built net, the surface, objectives, other
 * figures, load cases. */
enum { RANK_REST = 10, RANK_LOAD_CASES, N_RANK };
static int rank_of(const hf_merged *m, int k)
{
    const hf_merged_figure *f = &m->figure[k];
    bool is_fit = !strncmp(f->key, "facet_fit_", 10) || !strncmp(f->key, "fit_", 4);
    if (k == m->lead) return 0;
    if (*f->load_case) return RANK_LOAD_CASES;
    if (!strcmp(f->key, "psi_m")) return 1;
    if (f->stage == HF_MERGED_BUILT) return 2;
    if (strstr(f->key, "half_path_rms_m")) return is_fit ? 4 : 3;
    if (strstr(f->key, "gain_loss_1dB_Hz")) return is_fit ? 6 : 5;
    if (!strncmp(f->key, "refocused_", 10)) return 5;
    if (!strncmp(f->key, "fixed_", 6)) return 6;
    if (!strncmp(f->key, "pointing_at_", 12)) return 7;
    if (strstr(f->key, "gain_loss_at_")) return is_fit ? 8 : 7;
    return strncmp(f->key, "objective_", 10) ? RANK_REST : RANK_REST - 1;
}

/* ---- cells ---- */

/* Formats the value of an axis at point i. A long word is cut. */
static void print_axis_value(const hf_merged *m, const column *c, int i, char text[CELL_SIZE])
{
    const hf_series *s = &m->input[c->index];
    char shown[8 * WORD_MOST];
    *text = '\0';
    for (int k = 0; k < s->columns && s->n; k++) {
        size_t used = strlen(text);
        snprintf(text + used, CELL_SIZE - used, "%s%.6g", k ? " x " : "",
                 c->scale * s->value[(size_t)i * (size_t)s->columns + (size_t)k]);
    }
    if (s->n || !m->input_text[c->index].n) return;
    hf_text_escape(hf_texts_at(&m->input_text[c->index], i), shown, sizeof shown);
    bool is_long = strlen(shown) > WORD_MOST;
    snprintf(text, CELL_SIZE, "%.*s", is_long ? WORD_MOST - 3 : WORD_MOST, shown);
    hf_text_trim_utf8(text);
    if (is_long) strcat(text, "...");
}

/* Formats a value of a figure in the unit of its column. */
static void print_value(const hf_merged_figure *f, const column *c, double value, char text[CELL_SIZE])
{
    if (isnan(value))
        strcpy(text, "-");
    else if (isinf(value))
        strcpy(text, value > 0 ? "inf" : "-inf");
    else if (!strcmp(c->unit, "mm") || strstr(f->key, "tension_ratio"))
        strcpy(text, hf_print_decimals(value).text);
    else if (!strcmp(c->unit, "%"))
        snprintf(text, CELL_SIZE, f->stage == HF_MERGED_REQUIREMENTS ? "%+.1f" : "%.1f", value);
    else
        snprintf(text, CELL_SIZE, !strncmp(f->key, "n_", 2) ? "%g" : "%#.4g", value);
}

/* Formats a figure at point i. A gain loss without a value is above the range of Ruze's formula, if the surface error
 * has a value. */
static void print_figure(const hf_merged *m, const column *c, int i, char text[CELL_SIZE])
{
    const hf_merged_figure *f = &m->figure[c->index];
    double value = hf_merged_is_done(m, i) ? c->scale * f->value.value[i] : (double)NAN;
    bool is_loss = strstr(f->key, "gain_loss_at_") != NULL; /* by physical optics, one without a value is unknown */
    print_value(f, c, value, text);
    if (hf_merged_is_done(m, i) && isnan(value) && is_loss && hf_merged_is_beyond(m, f, i))
        snprintf(text, CELL_SIZE, "above %g", HF_RUZE_MOST_DB);
}

/* Returns the group that begins with point i. */
static const hf_merged_group *group_at(const hf_merged *m, int i)
{
    int low = 0, high = m->n_group - 1;
    while (low < high) {
        int k = (low + high + 1) / 2;
        if (m->group[k].first > i)
            high = k - 1;
        else
            low = k;
    }
    return &m->group[low];
}

static column statistic_column(const hf_merged *m, int k)
{
    column c = figure_column(m, m->lead);
    c.kind = OF_GROUP;
    c.index = k;
    snprintf(c.head, sizeof c.head, "%s", hf_merged_statistic_word[k]);
    c.head[strcspn(c.head, "_")] = c.head[strcspn(c.head, "_")] ? '\n' : '\0';
    return c;
}

static void print_statistic(const hf_merged *m, const column *c, int i, char text[CELL_SIZE])
{
    const hf_merged_group *g = group_at(m, i);
    if (c->index < HF_MERGED_N_STATISTIC)
        print_value(&m->figure[m->lead], c, c->scale * g->statistic[c->index], text);
    else
        snprintf(text, CELL_SIZE, "%d", g->n_run);
}

const char *hf_print_study_verdict(const hf_merged *m, int i, char text[HF_AXIS_NAME_SIZE])
{
    const hf_merged_judgement *j = &m->judgement[i];
    int n = j->verdict == HF_VERDICT_FAIL ? j->of.n_failed : j->of.n_undecided;
    if (j->verdict == HF_VERDICT_NONE)
        strcpy(text, "-");
    else if (j->verdict == HF_VERDICT_PASS)
        strcpy(text, hf_verdict_word[j->verdict]);
    else
        snprintf(text, HF_AXIS_NAME_SIZE, "%s (%d of %d)", hf_verdict_word[j->verdict], n, j->of.n_required);
    return text;
}

/* Returns the unit of a requirement for people. Sets *scale to the factor of its values. */
static const char *required_unit(const hf_merged *m, int row, double *scale)
{
    const char *unit;
    *scale = hf_print_scale(hf_merged_unit(m, row), &unit);
    return unit;
}

/* Formats the margin of a requirement at point i: "-12.3 %" or, without a relative margin, "+0.5 N". */
static void print_margin(const hf_merged *m, int row, int i, char text[CELL_SIZE])
{
    size_t at = (size_t)i * (size_t)m->n_row + (size_t)row;
    double relative = m->row_relative_margin.value[at];
    double scale;
    const char *unit = required_unit(m, row, &scale);
    if (isfinite(relative))
        snprintf(text, CELL_SIZE, "%+.1f %%", 100 * relative);
    else
        snprintf(text, CELL_SIZE, "%+.4g%s%s", scale * m->row_margin.value[at], *unit ? " " : "", unit);
}

const char *hf_print_study_tightest(const hf_merged *m, int i, char text[HF_PRINT_TIGHTEST_SIZE])
{
    int row = m->judgement[i].tightest;
    char shown[8 * HF_LEDGER_REQUIREMENT_SIZE], margin[CELL_SIZE];
    strcpy(text, "-");
    if (row < 0) return text;
    hf_text_escape(hf_texts_at(&m->row_name, row), shown, sizeof shown);
    bool is_long = strlen(shown) > NAME_MOST;
    if (is_long) shown[NAME_MOST - 3] = '\0';
    hf_text_trim_utf8(shown);
    print_margin(m, row, i, margin);
    snprintf(text, HF_PRINT_TIGHTEST_SIZE, "%.*s%s %.30s", NAME_MOST, shown, is_long ? "..." : "", margin);
    return text;
}

/* Returns the column of a requirement. The lines of its head are the parts of its name, such as "tension", "of tie",
 * "all load cases" and "95 % of samples". */
static column required_column(const hf_merged *m, int row)
{
    column c = {.kind = OF_REQUIRED, .index = row};
    char name[8 * HF_LEDGER_REQUIREMENT_SIZE];
    const char *unit = required_unit(m, row, &c.scale);
    double at_least = hf_merged_bound(m, &m->row_at_least, row), at_most = hf_merged_bound(m, &m->row_at_most, row);
    hf_text_escape(hf_texts_at(&m->row_name, row), name, sizeof name);
    snprintf(c.head, sizeof c.head, "%.*s", (int)sizeof c.head - 1, name);
    hf_text_trim_utf8(c.head);
    size_t figure = strcspn(c.head, " ,");
    if (c.head[figure] == ' ') c.head[figure] = '\n';
    for (char *comma = c.head; (comma = strstr(comma, ", ")) != NULL;) {
        memmove(comma, comma + 1, strlen(comma));
        *comma = '\n';
    }
    if (isnan(at_least) && isnan(at_most)) /* an axis has the bounds */
        snprintf(c.unit, sizeof c.unit, "%s", unit);
    else
        hf_print_bound(hf_merged_unit(m, row), at_least, at_most, c.unit);
    return c;
}

/* Formats the value of a requirement at point i. */
static void print_required(const hf_merged *m, const column *c, int i, char text[CELL_SIZE])
{
    double value = c->scale * m->row_value.value[(size_t)i * (size_t)m->n_row + (size_t)c->index];
    strcpy(text, "-");
    /* the figures of a point without a design are those of its net after form-finding */
    if (!isnan(value) && hf_merged_is_done(m, i)) snprintf(text, CELL_SIZE, "%.4g", value);
}

static void print_cell(const hf_merged *m, const column *c, int i, char text[CELL_SIZE])
{
    if (c->kind == OF_GROUP) {
        print_statistic(m, c, i, text);
        return;
    }
    if (c->kind == OF_REQUIRED) {
        print_required(m, c, i, text);
        return;
    }
    if (c->kind == OF_VERDICT) hf_print_study_verdict(m, i, text);
    if (c->kind == OF_TIGHTEST) hf_print_study_tightest(m, i, text);
    if (c->kind == OF_VERDICT || c->kind == OF_TIGHTEST) return;
    if (c->kind == OF_AXIS)
        print_axis_value(m, c, i, text);
    else if (c->kind == OF_FIGURE)
        print_figure(m, c, i, text);
    else if (m->status.value[i] == HF_NOT_EVALUATED)
        strcpy(text, "missing");
    else
        snprintf(text, CELL_SIZE, "%s", hf_status_word((hf_status)m->status.value[i]));
}

/* ---- the table ---- */

static int point_of(const table *t, int row)
{
    int k = t->is_all ? row : t->best[row];
    return t->of_groups ? t->m->group[k].first : k;
}

/* Returns line k of a head, counted from the last one, and its length in *n; "" above the first one. */
static const char *head_line(const column *c, int k, int *n)
{
    const char *end = c->head + strlen(c->head), *begin;
    for (begin = end;; end = --begin) {
        while (begin > c->head && begin[-1] != '\n')
            begin--;
        if (k-- == 0 || begin == c->head) break;
    }
    *n = k < 0 ? (int)(end - begin) : 0;
    return begin;
}

/* Appends a column that is wide enough for its head and all its cells. */
static void add_column(table *t, column c)
{
    char text[CELL_SIZE];
    c.n_line = 1;
    for (const char *p = c.head; (p = strchr(p, '\n')) != NULL; p++)
        c.n_line++;
    for (int k = 0, n; k < c.n_line; k++) {
        head_line(&c, k, &n);
        if (n > c.width) c.width = n;
    }
    if ((int)strlen(c.unit) > c.width) c.width = (int)strlen(c.unit);
    for (int k = 0; k < t->n_row; k++) {
        print_cell(t->m, &c, point_of(t, k), text);
        if ((int)strlen(text) > c.width) c.width = (int)strlen(text);
    }
    t->column[t->n_column++] = c;
}

static void add_columns(table *t)
{
    const hf_merged *m = t->m;
    bool all_done = true;
    for (int a = 0; a < m->n_axis; a++)
        if (hf_merged_axis_varies(m, a)) add_column(t, axis_column(m, a));
    t->n_axis = t->n_column;
    for (int i = 0; i < m->n; i++)
        all_done &= hf_merged_is_done(m, i);
    if (!all_done) add_column(t, (column){.kind = OF_STATUS, .head = "status"});
    const hf_merged_figure *margin = hf_merged_find(m, HF_MERGED_REQUIREMENTS, HF_MERGED_MARGIN);
    if (m->n_row > 0) add_column(t, (column){.kind = OF_VERDICT, .head = "verdict"});
    if (m->n_row > 0 && margin && !t->is_short) add_column(t, figure_column(m, (int)(margin - m->figure)));
    if (m->n_row > 0) add_column(t, (column){.kind = OF_TIGHTEST, .head = "tightest requirement and its margin"});
    for (int k = 0; k < t->n_required && !(t->is_short && k == REQUIRED_MOST); k++)
        add_column(t, required_column(m, t->required[k]));
    for (int rank = 0; rank < (t->is_short ? 1 : N_RANK); rank++)
        for (int k = 0; k < m->n_figure; k++)
            if (is_shown(m, &m->figure[k]) && !m->figure[k].is_same && rank_of(m, k) == rank)
                add_column(t, figure_column(m, k));
}

/* Adds the axes of the groups, the number of replicates and the statistics of the ranking figure. */
static void add_group_columns(table *t)
{
    const hf_merged *m = t->m;
    for (int a = 0; a < m->n_axis; a++)
        if (a != m->replicate && hf_merged_axis_varies(m, a)) add_column(t, axis_column(m, a));
    t->n_axis = t->n_column;
    add_column(t, (column){.kind = OF_GROUP, .index = HF_MERGED_N_STATISTIC, .head = "replicates"});
    for (int k = 0; k < HF_MERGED_N_STATISTIC; k++)
        add_column(t, statistic_column(m, k));
}

/* Returns whether a block that begins with column `from` contains column k. */
static bool is_in_block(const table *t, int from, int to, int k)
{
    return k < t->n_axis || (k >= from && k < to);
}

/* Prints the axes and the columns from `from` to to - 1. */
static void print_block(const table *t, int from, int to, hf_print_style style, FILE *f)
{
    const hf_merged *m = t->m;
    char text[CELL_SIZE];
    int n_line = 1, best = !t->of_groups ? m->best : m->best_group >= 0 ? m->group[m->best_group].first : -1;
    for (int k = 0; k < t->n_column; k++)
        if (is_in_block(t, from, to, k) && t->column[k].n_line > n_line) n_line = t->column[k].n_line;
    for (int line = -1 - n_line; line < t->n_row; line++) {
        int i = line < 0 ? -1 : point_of(t, line), n = 0;
        bool is_best = i >= 0 && i == best;
        fputs(is_best && style.has_colour ? HF_PRINT_BOLD : "", f);
        fputs(is_best ? "*" : " ", f);
        for (int k = 0; k < t->n_column; k++) {
            const column *c = &t->column[k];
            if (!is_in_block(t, from, to, k)) continue;
            if (i >= 0) print_cell(t->m, c, i, text);
            const char *shown = i >= 0 ? text : line == -1 ? c->unit : head_line(c, -2 - line, &n);
            if (line >= -1) n = (int)strlen(shown);
            fprintf(f, " %*.*s", c->width + 1, n, shown);
        }
        fputs(is_best && style.has_colour ? HF_PRINT_PLAIN "\n" : "\n", f);
    }
}

/* Prints the table in blocks. Columns that do not fit into a line continue in the next block, beside the axes again. */
static void print_blocks(const table *t, hf_print_style style, FILE *f)
{
    int axes = 1;
    for (int k = 0; k < t->n_axis; k++)
        axes += t->column[k].width + 2;
    int from = t->n_axis, to;
    do {
        int wide = axes;
        for (to = from; to < t->n_column && (to == from || wide + t->column[to].width + 2 <= WIDTH); to++)
            wide += t->column[to].width + 2;
        print_block(t, from, to, style, f);
        from = to;
        if (from < t->n_column) fputc('\n', f);
    } while (from < t->n_column);
}

/* ---- verdicts ---- */

const char *hf_print_study_ranking(const hf_merged *m, char text[HF_PRINT_RANKING_SIZE])
{
    char lead[HF_AXIS_NAME_SIZE] = "";
    bool is_margin = hf_merged_is_margin(m, m->lead);
    if (m->lead >= 0) name_figure(m, &m->figure[m->lead], lead);
    snprintf(text, HF_PRINT_RANKING_SIZE, "%s%s%s",
             !hf_merged_is_judged(m) ? "" : "failed requirements, then undecided ones",
             hf_merged_is_judged(m) && *lead ? ", then " : "", is_margin ? "smallest relative margin" : lead);
    return text;
}

/* Appends the interval of an axis between two points that pass: " between the points 25 and 40 N". */
static size_t add_interval(const column *c, const hf_merged_interval *in, bool is_first, char *text, size_t size)
{
    const char *blank = *c->unit ? " " : "", *before = is_first ? "" : ", and";
    int n = in->low < in->high
                ? snprintf(text, size, "%s between the points %.6g and %.6g%s%s", before, c->scale * in->low,
                           c->scale * in->high, blank, c->unit)
                : snprintf(text, size, "%s at the point %.6g%s%s", before, c->scale * in->low, blank, c->unit);
    return (size_t)n < size ? (size_t)n : size - 1;
}

/* Appends the rows that fail at all points: "; at every point fails: mass". */
static size_t add_failing(const hf_merged *m, char *text, size_t size)
{
    size_t used = 0;
    int n = 0, n_judged;
    for (int row = 0; row < m->n_row; row++) {
        int n_failed = hf_merged_failing(m, row, &n_judged);
        if (n_failed == 0 || n_failed < n_judged || used >= size / 2) continue;
        used += (size_t)snprintf(text + used, size - used, "%s%.*s", n++ ? "; " : "; at every point fails: ", NAME_MOST,
                                 hf_texts_at(&m->row_name, row));
        hf_text_trim_utf8(text);
        used = strlen(text);
    }
    return used;
}

const char *hf_print_study_advice(const hf_merged *m, char text[HF_PRINT_ADVICE_SIZE])
{
    int count[HF_VERDICT_N] = {0};
    hf_merged_interval interval[INTERVALS_MOST];
    *text = '\0';
    if (!hf_merged_is_judged(m)) return text;
    for (int i = 0; i < m->n; i++)
        count[m->judgement[i].verdict]++;
    int n_pass = count[HF_VERDICT_PASS];
    size_t used = (size_t)snprintf(text, HF_PRINT_ADVICE_SIZE, n_pass ? "%d of %d points pass%s" : "no point passes",
                                   n_pass, m->n, n_pass == 1 ? "es" : "");
    if (!n_pass) used += add_failing(m, text + used, HF_PRINT_ADVICE_SIZE - used);
    for (int a = 0; a < m->n_axis; a++) {
        int n = hf_merged_axis_varies(m, a) ? hf_merged_passing(m, a, interval, INTERVALS_MOST) : 0;
        column c = axis_column(m, a);
        if (n > 0) used += (size_t)snprintf(text + used, HF_PRINT_ADVICE_SIZE - used, ": %s", c.head);
        for (int k = 0; k < n; k++)
            used += add_interval(&c, &interval[k], k == 0, text + used, HF_PRINT_ADVICE_SIZE - used);
    }
    if (count[HF_VERDICT_UNDECIDED])
        snprintf(text + used, HF_PRINT_ADVICE_SIZE - used, "; %d %s undecided", count[HF_VERDICT_UNDECIDED],
                 count[HF_VERDICT_UNDECIDED] == 1 ? "is" : "are");
    return text;
}

/* ---- lines ---- */

/* Prints items after a title, with line breaks at WIDTH. */
typedef struct {
    FILE *file;
    const char *title;
    int used;
} items;

static void add_item(items *t, const char *text)
{
    char shown[20 * HF_AXIS_NAME_SIZE];
    hf_text_escape(text, shown, sizeof shown);
    int n = (int)strlen(shown);
    if (t->used && t->used + n + 3 > WIDTH) {
        fputs(",\n", t->file);
        t->used = 0;
    }
    if (!t->used)
        t->used = fprintf(t->file, "  %-13s ", t->title);
    else
        t->used += fprintf(t->file, ", ");
    t->used += fprintf(t->file, "%s", shown);
    t->title = "";
}

static void end_items(const items *t)
{
    if (t->used) fputc('\n', t->file);
}

static void print_item(const hf_merged *m, const column *c, int i, items *t)
{
    char text[5 * HF_AXIS_NAME_SIZE], cell[CELL_SIZE];
    print_cell(m, c, i, cell);
    snprintf(text, sizeof text, "%s %s%s%s", c->head, cell, *c->unit ? " " : "", c->unit);
    add_item(t, text);
}

/* Prints axes and figures that are the same at all points. Load cases show only psi and slack cables. */
static void print_same(const table *t, FILE *f)
{
    const hf_merged *m = t->m;
    items line = {.file = f, .title = "at all points"};
    int i = 0;
    while (i < m->n - 1 && !hf_merged_is_done(m, i))
        i++;
    for (int a = 0; a < m->n_axis; a++) {
        column c = axis_column(m, a);
        if (!hf_merged_axis_varies(m, a)) print_item(m, &c, i, &line);
    }
    for (int k = 0; k < m->n_figure && hf_merged_is_done(m, i) && !t->is_short; k++) {
        column c = figure_column(m, k);
        const hf_merged_figure *figure = &m->figure[k];
        if (*figure->load_case && strcmp(figure->key, "psi_m") != 0 && strcmp(figure->key, "n_slack") != 0) continue;
        if (figure->is_same && is_shown(m, figure) && !(isnan(figure->value.value[i]) && !strcmp(c.unit, "%")))
            print_item(m, &c, i, &line);
    }
    end_items(&line);
}

/* Adds whether the best point passes. */
static void add_verdict(const hf_merged *m, items *line)
{
    const hf_merged_judgement *j = &m->judgement[m->best];
    char text[2 * HF_AXIS_NAME_SIZE];
    if (j->verdict == HF_VERDICT_PASS)
        snprintf(text, sizeof text, "passes");
    else if (j->verdict == HF_VERDICT_FAIL)
        snprintf(text, sizeof text, "fails %d of %d", j->of.n_failed, j->of.n_required);
    else
        snprintf(text, sizeof text, "%d of %d %s undecided", j->of.n_undecided, j->of.n_required,
                 j->of.n_undecided == 1 ? "is" : "are");
    add_item(line, text);
}

/* Prints the best point, and axes that should be extended beyond it. */
static void print_best(const table *t, FILE *f)
{
    const hf_merged *m = t->m;
    items line = {.file = f, .title = "best (*)"};
    bool is_judged = hf_merged_is_judged(m);
    if (m->best < 0) return;
    char text[5 * HF_AXIS_NAME_SIZE], cell[CELL_SIZE], words[HF_PRINT_RANKING_SIZE];
    if (is_judged) add_verdict(m, &line);
    column lead = {.scale = 1};
    if (m->lead >= 0) {
        lead = figure_column(m, m->lead);
        print_cell(m, &lead, m->best, cell);
        snprintf(text, sizeof text, "%s%s%s%s%s%s", is_judged ? "" : "minimum ", lead.head, is_judged ? " " : ": ",
                 cell, *lead.unit ? " " : "", lead.unit);
        add_item(&line, text);
    }
    for (int k = 0; k < t->n_axis; k++)
        print_item(m, &t->column[k], m->best, &line);
    end_items(&line);
    for (int k = 0; k < t->n_axis; k++) {
        const column *c = &t->column[k];
        int side = hf_merged_improves_on(m, c->index);
        if (side == 0) continue;
        print_cell(m, c, m->n_group ? m->group[m->best_group].first : m->best, cell);
        hf_print_line(f, "  %-13s %s still %s at %s %s%s%s, the end of its axis: add points %s it", "",
                      m->n_group ? "the median" : lead.head, hf_merged_is_margin(m, m->lead) ? "rises" : "falls",
                      c->head, cell, *c->unit ? " " : "", c->unit, side > 0 ? "above" : "below");
    }
    hf_print_line(f, "  %-13s %s", "ranked by", hf_print_study_ranking(m, words));
}

/* Appends the values of the axes of a group: "pretension 10 N, range 2 N". */
static void add_group_name(const hf_merged *m, int k, char *text, size_t size)
{
    bool is_first = true;
    for (int a = 0; a < m->n_axis; a++) {
        char cell[CELL_SIZE], item[5 * HF_AXIS_NAME_SIZE];
        column c = axis_column(m, a);
        if (a == m->replicate || !hf_merged_axis_varies(m, a)) continue;
        print_cell(m, &c, m->group[k].first, cell);
        snprintf(item, sizeof item, "%s %s%s%s", c.head, cell, *c.unit ? " " : "", c.unit);
        hf_text_append(text, size, is_first ? "" : ", ", item, "");
        is_first = false;
    }
}

const char *hf_print_study_scatter(const hf_merged *m, char text[HF_PRINT_ADVICE_SIZE])
{
    *text = '\0';
    if (m->second_group < 0) return text;
    const hf_merged_group *a = &m->group[m->best_group], *b = &m->group[m->second_group];
    bool differ = m->differ_p < HF_MERGED_DIFFER_P,
         is_few = !differ && (a->n_run < HF_MERGED_DIFFER_N || b->n_run < HF_MERGED_DIFFER_N);
    char tail[256];
    add_group_name(m, m->best_group, text, HF_PRINT_ADVICE_SIZE / 2 - 128);
    hf_text_append(text, HF_PRINT_ADVICE_SIZE, " and ", "", "");
    add_group_name(m, m->second_group, text, HF_PRINT_ADVICE_SIZE - sizeof tail);
    snprintf(tail, sizeof tail, "%s by more than the scatter of the search (Mann-Whitney U test, p = %.2g%s)%s",
             differ ? " differ" : " are not shown to differ", m->differ_p, differ ? "" : ", not below 0.01",
             is_few ? "; use at least 5 replicates, because fewer cannot show a difference" : "");
    hf_text_append(text, HF_PRINT_ADVICE_SIZE, tail, "", "");
    return text;
}

/* Prints the group with the best median, and whether it differs from the second. */
static void print_scatter(const hf_merged *m, FILE *f)
{
    char text[HF_PRINT_ADVICE_SIZE], cell[3][CELL_SIZE], name[HF_PRINT_ADVICE_SIZE] = "";
    if (m->best_group < 0) return;
    const hf_merged_group *g = &m->group[m->best_group];
    column c = figure_column(m, m->lead);
    for (int k = 0; k < 3; k++)
        print_value(&m->figure[m->lead], &c, c.scale * g->statistic[k + 1], cell[k]);
    add_group_name(m, m->best_group, name, sizeof name);
    hf_print_line(f, "  %-13s %s: %s%s%s, quartiles %s and %s%s%s", "best median", c.head, cell[1], *c.unit ? " " : "",
                  c.unit, cell[0], cell[2], *name ? ", " : "", name);
    const char *line = hf_print_study_scatter(m, text), *title = "scatter";
    for (int n; *line; line += n + (line[n] == ' ')) {
        n = (int)strlen(line) <= WIDTH - 16 ? (int)strlen(line) : WIDTH - 16;
        while (n > 1 && line[n] && line[n] != ' ')
            n--;
        hf_print_line(f, "  %-13s %.*s", title, n, line);
        title = "";
    }
}

static void print_advice(const hf_merged *m, FILE *f)
{
    char text[HF_PRINT_ADVICE_SIZE];
    if (*hf_print_study_advice(m, text)) hf_print_line(f, "  %-13s %s", "advice", text);
}

/* Prints the number of failed points for each status, with the reason of the first one. */
static void print_failures(const hf_merged *m, FILE *f)
{
    bool is_printed[SCHAR_MAX + 1] = {[HF_OK] = true, [HF_NOT_EVALUATED] = true};
    const char *title = "failed";
    for (int i = 0; i < m->n; i++) {
        int status = (int)m->status.value[i], n = 0;
        char shown[HF_LEDGER_REASON_MAX];
        if (is_printed[status]) continue;
        is_printed[status] = true;
        for (int k = i; k < m->n; k++)
            n += (int)m->status.value[k] == status;
        hf_text_escape(hf_texts_at(&m->reason, i), shown, sizeof shown);
        bool is_long = strlen(shown) > REASON_MOST;
        if (is_long) shown[REASON_MOST] = '\0';
        hf_text_trim_utf8(shown);
        fprintf(f, "  %-13s %d %s: %s%s\n", title, n, hf_status_word((hf_status)status), shown, is_long ? "..." : "");
        title = "";
    }
}

static void print_head(const hf_merged *m, FILE *f)
{
    int n_done = 0, n_missing = 0;
    items axes = {.file = f, .title = "axes"};
    for (int i = 0; i < m->n; i++) {
        n_done += hf_merged_is_done(m, i);
        n_missing += m->status.value[i] == HF_NOT_EVALUATED;
    }
    fprintf(f, "  %-13s %d: %d done, %d failed, %d missing\n", "points", m->n, n_done, m->n - n_done - n_missing,
            n_missing);
    for (int a = 0; a < m->n_axis; a++) {
        if (hf_merged_axis_varies(m, a)) add_item(&axes, hf_texts_at(&m->input_name, a));
    }
    end_items(&axes);
    hf_print_text counted = hf_print_counted(m->n_inner_node, m->n_free);
    if (*counted.text) fprintf(f, "  %-13s %s\n", "psi counts", counted.text);
}

/* ---- the whole text ---- */

/* Selects the groups that are rows: all or, of many, those that rank first. */
static void choose_groups(table *t, bool all)
{
    const hf_merged *m = t->m;
    t->of_groups = true;
    t->is_all = all || m->n_group <= POINTS_MOST;
    t->n_row = t->is_all ? m->n_group : POINTS_BEST;
    for (int k = 0; k < m->n_group && !t->is_all; k++)
        if (m->group[k].rank < POINTS_BEST) t->best[m->group[k].rank] = k;
}

/* Prints the statistics of the groups. */
static void print_groups(table *t, hf_print_style style, FILE *f)
{
    const hf_merged *m = t->m;
    *t = (table){.m = m};
    choose_groups(t, style.verbose);
    add_group_columns(t);
    column c = figure_column(m, m->lead);
    fputc('\n', f);
    hf_print_line(f, "  %s of the replicates:", c.head);
    print_blocks(t, style, f);
    if (!t->is_all) hf_print_line(f, "  the %d best of %d medians; --verbose: all", t->n_row, m->n_group);
    if (!style.verbose) hf_print_line(f, "  %-13s --verbose", "all points");
}

/* Selects the rows: all points or, in a large study, those that rank first. */
static void choose_rows(table *t, bool all)
{
    const hf_merged *m = t->m;
    t->n_row = m->n;
    t->is_all = all || m->n <= POINTS_MOST || m->best < 0;
    for (int k = 0, last = -1; k < POINTS_BEST && !t->is_all; k++) {
        int next = -1;
        for (int i = 0; i < m->n; i++)
            if (hf_merged_is_done(m, i) && (last < 0 || hf_merged_ranks_before(m, last, i)) &&
                (next < 0 || hf_merged_ranks_before(m, i, next)))
                next = i;
        t->n_row = next < 0 ? k : k + 1;
        if (next < 0) break;
        t->best[k] = last = next;
    }
}

/* Prints the table of the points. */
static void print_points(const table *t, hf_print_style style, FILE *f)
{
    if (t->n_column > t->n_axis) {
        fputc('\n', f);
        print_blocks(t, style, f);
    }
    if (t->is_short && t->n_required <= REQUIRED_MOST)
        hf_print_line(f, "  %-13s all requirements; --verbose: other figures, such as psi", "columns");
    else if (t->is_short)
        hf_print_line(f, "  %-13s the %d tightest of %d requirements; --verbose: all, and other figures, such as psi",
                      "columns", REQUIRED_MOST, t->n_required);
    if (!t->is_all) hf_print_line(f, "  the %d best of %d points; --verbose: all", t->n_row, t->m->n);
}

void hf_print_study(const hf_merged *m, hf_print_style style, FILE *f)
{
    static table t;
    t = (table){.m = m};
    t.n_required = hf_merged_required(m, t.required);
    t.is_short = t.n_required > 0 && !style.verbose;
    choose_rows(&t, style.verbose);
    add_columns(&t);
    if (style.has_colour) fputs(HF_PRINT_BOLD, f);
    hf_print_line(f, "%s", hf_merged_heading(m));
    if (style.has_colour) fputs(HF_PRINT_PLAIN, f);
    print_head(m, f);
    print_advice(m, f);
    print_best(&t, f);
    print_scatter(m, f);
    print_same(&t, f);
    print_failures(m, f);
    if (!m->n_group || style.verbose) print_points(&t, style, f);
    if (m->n_group) print_groups(&t, style, f);
    hf_print_line(f, "  %-13s a page to look at: hifdm report %s", "more", m->path);
}
