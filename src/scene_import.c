/* Contents: CSV table - columns - lookup of ids - nodes - cables */
#include "scene_import.h"

#include "text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FAULT_MAX 20 /* faults that are spelled out, per file */
#define COLUMN_MAX 64
#define ID_MAX 255

/* ---- CSV table: the text is cut up in place, cells point into it ---- */

typedef struct {
    const char *path;
    char *text;
    int n_column, n_row, row_capacity, header_line;
    char *header[COLUMN_MAX];
    char **cell; /* [n_row][n_column] */
    int *line;   /* [n_row] line number in the file */
    int n_fault;
    hf_messages *messages;
} table;

static void table_free(table *t)
{
    free(t->text);
    free(t->cell);
    free(t->line);
}

/* One fault, at a line, about an id where there is one. */
static void fault(table *t, int line, const char *id, const char *what, const char *detail)
{
    if (++t->n_fault > FAULT_MAX) return;
    if (id)
        hf_error(t->messages, HF_BAD_CASE, "%s:%d: '%s': %s%s", t->path, line, id, what, detail);
    else
        hf_error(t->messages, HF_BAD_CASE, "%s:%d: %s%s", t->path, line, what, detail);
}

static hf_status close_faults(table *t)
{
    if (t->n_fault > FAULT_MAX)
        hf_error(t->messages, HF_BAD_CASE, "%s: and %d more faults", t->path, t->n_fault - FAULT_MAX);
    return t->n_fault ? HF_BAD_CASE : HF_OK;
}

static char *trim(char *field)
{
    while (*field == ' ' || *field == '\t')
        field++;
    size_t n = strlen(field);
    while (n && (field[n - 1] == ' ' || field[n - 1] == '\t'))
        field[--n] = '\0';
    return field;
}

/* Take a "quoted ""field""" apart in place; *p moves past its closing quote. NULL when it does not close. */
static char *unquote(char **p)
{
    char *start = *p + 1, *to = start, *from = start;
    for (; *from; from++) {
        if (*from == '"') {
            if (from[1] != '"') break;
            from++;
        }
        *to++ = *from;
    }
    if (*from != '"') return NULL;
    *to = '\0';
    *p = from + 1;
    while (**p == ' ' || **p == '\t')
        ++*p;
    return **p == '\0' || **p == ',' ? start : NULL;
}

/* Cut one line into at most COLUMN_MAX fields; -1 when quotes do not match, COLUMN_MAX + 1 when there are too many. */
static int split(char *line, char *field[COLUMN_MAX])
{
    int n = 0;
    for (char *p = line;;) {
        if (n == COLUMN_MAX) return COLUMN_MAX + 1;
        while (*p == ' ' || *p == '\t')
            p++;
        char *start = p;
        int quoted = *p == '"';
        if (quoted) {
            start = unquote(&p);
            if (!start) return -1;
        } else {
            p += strcspn(p, ",");
        }
        int last = *p == '\0';
        *p = '\0';
        field[n++] = quoted ? start : trim(start);
        if (last) return n;
        p++;
    }
}

/* Next line of the text, without its end (LF or CRLF); NULL after the last. */
static char *next_line(char **rest)
{
    char *line = *rest;
    if (!*line) return NULL;
    char *end = strchr(line, '\n');
    *rest = end ? end + 1 : line + strlen(line);
    if (end) *end = '\0';
    size_t n = strlen(line);
    if (n && line[n - 1] == '\r') line[n - 1] = '\0';
    return line;
}

static int add_row(table *t, char **field, int line)
{
    if (t->n_row == t->row_capacity) {
        int capacity = t->row_capacity ? 2 * t->row_capacity : 64;
        char **cell = realloc(t->cell, (size_t)capacity * (size_t)t->n_column * sizeof *cell);
        if (!cell) return 0;
        t->cell = cell;
        int *lines = realloc(t->line, (size_t)capacity * sizeof *lines);
        if (!lines) return 0;
        t->line = lines;
        t->row_capacity = capacity;
    }
    memcpy(t->cell + (size_t)t->n_row * (size_t)t->n_column, field, (size_t)t->n_column * sizeof *field);
    t->line[t->n_row++] = line;
    return 1;
}

static hf_status table_read(table *t)
{
    size_t length;
    HF_TRY(hf_text_read_file(t->path, HF_BAD_CASE, &t->text, &length, t->messages));
    if (strlen(t->text) != length) return hf_error(t->messages, HF_BAD_CASE, "%s: not a text file", t->path);
    char *rest = t->text, *line, *field[COLUMN_MAX];
    if (!strncmp(rest, "\xEF\xBB\xBF", 3)) rest += 3; /* byte order mark of spreadsheet programs */
    for (int n_line = 1; (line = next_line(&rest)) != NULL; n_line++) {
        if (line[strspn(line, " \t")] == '\0' || *line == '#') continue;
        if (!hf_text_is_utf8(line)) {
            fault(t, n_line, NULL, "not UTF-8 text; save the file as UTF-8", "");
            continue;
        }
        int n = split(line, field);
        char counts[64];
        snprintf(counts, sizeof counts, "%d fields where the header has %d", n, t->n_column);
        if (n < 0)
            fault(t, n_line, NULL, "a quoted field does not end on this line", "");
        else if (n > COLUMN_MAX)
            fault(t, n_line, NULL, "too many columns", "");
        else if (t->n_column == 0) {
            memcpy(t->header, field, (size_t)(t->n_column = n) * sizeof *field);
            t->header_line = n_line;
        } else if (n != t->n_column)
            fault(t, n_line, NULL, counts, "");
        else if (!add_row(t, field, n_line))
            return hf_error(t->messages, HF_NO_MEMORY, "%s: out of memory", t->path);
    }
    if (t->n_column == 0)
        fault(t, 1, NULL, "the file is empty: a header line is needed", "");
    else if (t->n_row == 0 && t->n_fault == 0)
        fault(t, 1, NULL, "there is a header, but no rows", "");
    return close_faults(t);
}

static char *cell(const table *t, int row, int column)
{
    return t->cell[(size_t)row * (size_t)t->n_column + (size_t)column];
}

/* ---- columns ---- */

/* Where each known column stands (-1 = absent); the first n_required must be there. Unknown ones are warned about. */
static hf_status find_columns(table *t, const char *const *names, int n_name, int n_required, int *where)
{
    for (int k = 0; k < n_name; k++)
        where[k] = -1;
    for (int c = 0; c < t->n_column; c++) {
        int k = 0;
        while (k < n_name && strcmp(names[k], t->header[c]))
            k++;
        if (k == n_name) {
            const char *near = hf_text_nearest(t->header[c], names, n_name);
            hf_warning(t->messages, "%s:%d: column '%s' is not used%s%s%s", t->path, t->header_line, t->header[c],
                       near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
        } else if (where[k] >= 0) {
            fault(t, t->header_line, NULL, "this column stands twice: ", names[k]);
        } else {
            where[k] = c;
        }
    }
    for (int k = 0; k < n_required; k++)
        if (where[k] < 0) fault(t, t->header_line, NULL, "a column is missing: ", names[k]);
    return close_faults(t);
}

static double read_number(table *t, int row, int column, const char *id, const char *name)
{
    double value = NAN;
    const char *text = cell(t, row, column);
    char what[96];
    snprintf(what, sizeof what, "%s must be a finite number, not ", name);
    if (!hf_text_double(text, &value)) fault(t, t->line[row], id, what, *text ? text : "empty");
    return value;
}

static int read_word(table *t, int row, int column, const char *id, const char *const *words, int n_word)
{
    const char *text = cell(t, row, column);
    for (int k = 0; k < n_word; k++)
        if (!strcmp(words[k], text)) return k;
    char what[160];
    int n = snprintf(what, sizeof what, "%s must be one of", t->header[column]);
    for (int k = 0; k < n_word; k++)
        n += snprintf(what + n, sizeof what - (size_t)n, " %s", words[k]);
    snprintf(what + n, sizeof what - (size_t)n, ", not ");
    fault(t, t->line[row], id, what, *text ? text : "empty");
    return 0;
}

/* ---- lookup of ids ---- */

typedef struct {
    const char *id;
    int row;
} named;

static int compare_named(const void *a, const void *b)
{
    const named *x = a, *y = b;
    int order = strcmp(x->id, y->id);
    return order ? order : (x->row > y->row) - (x->row < y->row);
}

static int compare_id(const void *key, const void *item)
{
    return strcmp(key, ((const named *)item)->id);
}

/* Sorted ids of a table (caller frees), or NULL; empty and duplicate ids are faults. */
static named *index_ids(table *t, int column)
{
    named *index = malloc((size_t)t->n_row * sizeof *index);
    if (!index) return NULL;
    for (int r = 0; r < t->n_row; r++) {
        index[r] = (named){cell(t, r, column), r};
        if (!*index[r].id) fault(t, t->line[r], NULL, "the id is empty", "");
        if (strlen(index[r].id) > ID_MAX) fault(t, t->line[r], NULL, "the id is longer than 255 bytes", "");
    }
    qsort(index, (size_t)t->n_row, sizeof *index, compare_named);
    for (int r = 1; r < t->n_row; r++)
        if (*index[r].id && !strcmp(index[r].id, index[r - 1].id)) {
            char what[64];
            snprintf(what, sizeof what, "this id was used before, on line %d", t->line[index[r - 1].row]);
            fault(t, t->line[index[r].row], index[r].id, what, "");
        }
    return index;
}

/* ---- nodes ---- */

enum { NODE_ID, NODE_X, NODE_Y, NODE_Z, NODE_ROLE, NODE_FX, NODE_FY, NODE_FZ, N_NODE_COLUMN };
static const char *const node_column[N_NODE_COLUMN] = {"id", "x_m", "y_m", "z_m", "role", "Fx_N", "Fy_N", "Fz_N"};

static int read_nodes(table *t, const int *where, hf_scene *s)
{
    int any_load = 0;
    for (int r = 0; r < t->n_row; r++) {
        const char *id = cell(t, r, where[NODE_ID]);
        for (int c = 0; c < 3; c++) {
            s->position_m[3 * r + c] = read_number(t, r, where[NODE_X + c], id, node_column[NODE_X + c]);
            if (where[NODE_FX + c] < 0 || !*cell(t, r, where[NODE_FX + c])) continue; /* empty = no load */
            s->load_N[3 * r + c] = read_number(t, r, where[NODE_FX + c], id, node_column[NODE_FX + c]);
            any_load |= s->load_N[3 * r + c] != 0;
        }
        s->role[r] = (unsigned char)read_word(t, r, where[NODE_ROLE], id, hf_role_word, 3);
        s->node_id[r] = id;
        s->node_line[r] = t->line[r];
    }
    return any_load;
}

/* ---- cables ---- */

enum { CABLE_ID, CABLE_I, CABLE_J, CABLE_GROUP, CABLE_LAW, CABLE_VALUE, CABLE_EA, N_CABLE_COLUMN };
static const char *const cable_column[N_CABLE_COLUMN] = {"id", "i", "j", "group", "law", "value", "EA_N"};

static void read_target(table *t, const int *where, int r, const char *id, hf_scene *s)
{
    s->target[r] = NAN;
    if (*cell(t, r, where[CABLE_VALUE])) {
        s->target[r] = read_number(t, r, where[CABLE_VALUE], id, "value");
        if (s->law[r] != HF_LAW_FORCE_DENSITY && s->target[r] <= 0)
            fault(t, t->line[r], id, "value must be above zero for the law ", hf_law_word[s->law[r]]);
        if (s->law[r] == HF_LAW_FORCE_DENSITY && s->target[r] == 0)
            fault(t, t->line[r], id, "value must not be zero for the law force_density", "");
    } else if (s->law[r] == HF_LAW_LENGTH) {
        s->target[r] = hf_scene_theoretical_length(s, r);
    } else if (s->law[r] == HF_LAW_FORCE_DENSITY) {
        fault(t, t->line[r], id, "the law force_density needs a value in N/m", "");
    }
}

static void read_cables(table *t, const int *where, const table *nodes, const named *node_index, hf_scene *s)
{
    for (int r = 0; r < t->n_row; r++) {
        const char *id = cell(t, r, where[CABLE_ID]);
        s->cable_id[r] = id;
        s->cable_line[r] = t->line[r];
        for (int k = 0; k < 2; k++) {
            const char *end = cell(t, r, where[CABLE_I + k]);
            const named *hit = bsearch(end, node_index, (size_t)nodes->n_row, sizeof *node_index, compare_id);
            if (!hit) fault(t, t->line[r], id, "there is no node with the id ", *end ? end : "(empty)");
            s->end[2 * r + k] = hit ? hit->row : 0;
        }
        s->group[r] = (unsigned char)read_word(t, r, where[CABLE_GROUP], id, hf_group_word, 2);
        s->law[r] = (unsigned char)read_word(t, r, where[CABLE_LAW], id, hf_law_word, 3);
        read_target(t, where, r, id, s);
        if (!s->EA_N) continue;
        s->EA_N[r] = NAN;
        if (!*cell(t, r, where[CABLE_EA])) continue;
        s->EA_N[r] = read_number(t, r, where[CABLE_EA], id, "EA_N");
        if (s->EA_N[r] <= 0) fault(t, t->line[r], id, "EA_N must be above zero", "");
    }
}

/* ---- together ---- */

/* The ids still point into the two texts: move them to one block that the scene owns. */
static hf_status keep_ids(hf_scene *s)
{
    size_t size = strlen(s->nodes_file) + strlen(s->cables_file) + 2;
    for (int i = 0; i < s->n_node; i++)
        size += strlen(s->node_id[i]) + 1;
    for (int e = 0; e < s->n_cable; e++)
        size += strlen(s->cable_id[e]) + 1;
    char *text = s->text = malloc(size);
    if (!text) return HF_NO_MEMORY;
    const char **all[] = {&s->nodes_file, &s->cables_file};
    for (int i = 0; i < 2 + s->n_node + s->n_cable; i++) {
        const char **id = i < 2 ? all[i] : i < 2 + s->n_node ? &s->node_id[i - 2] : &s->cable_id[i - 2 - s->n_node];
        *id = strcpy(text, *id);
        text += strlen(text) + 1;
    }
    return HF_OK;
}

static hf_status build(table *nodes, table *cables, named **node_index, named **cable_index, hf_scene *s)
{
    int node_where[N_NODE_COLUMN] = {0}, cable_where[N_CABLE_COLUMN] = {0};
    /* both files are looked at before giving up, so that one run shows the faults of both */
    hf_status node_status = table_read(nodes), cable_status = table_read(cables);
    if (node_status == HF_OK) node_status = find_columns(nodes, node_column, N_NODE_COLUMN, NODE_FX, node_where);
    if (cable_status == HF_OK) cable_status = find_columns(cables, cable_column, N_CABLE_COLUMN, CABLE_EA, cable_where);
    HF_TRY(node_status);
    HF_TRY(cable_status);
    int with_load = node_where[NODE_FX] >= 0 || node_where[NODE_FY] >= 0 || node_where[NODE_FZ] >= 0;
    hf_status status = hf_scene_allocate(s, nodes->n_row, cables->n_row, with_load, cable_where[CABLE_EA] >= 0, 1);
    if (status == HF_OK) *node_index = index_ids(nodes, node_where[NODE_ID]);
    if (status == HF_OK) *cable_index = index_ids(cables, cable_where[CABLE_ID]);
    if (!*node_index || !*cable_index) return hf_error(nodes->messages, HF_NO_MEMORY, "%s: out of memory", nodes->path);
    if (!read_nodes(nodes, node_where, s)) s->load_N = NULL; /* columns of zeros are no load */
    read_cables(cables, cable_where, nodes, *node_index, s);
    node_status = close_faults(nodes);
    cable_status = close_faults(cables);
    HF_TRY(node_status);
    HF_TRY(cable_status);
    s->nodes_file = nodes->path;
    s->cables_file = cables->path;
    if (keep_ids(s) != HF_OK) return hf_error(nodes->messages, HF_NO_MEMORY, "%s: out of memory", nodes->path);
    return HF_OK;
}

hf_status hf_scene_import(const char *nodes_path, const char *cables_path, hf_scene *scene, hf_messages *messages)
{
    *scene = (hf_scene){0};
    table nodes = {.path = nodes_path, .messages = messages}, cables = {.path = cables_path, .messages = messages};
    named *node_index = NULL, *cable_index = NULL;
    hf_status status = build(&nodes, &cables, &node_index, &cable_index, scene);
    free(node_index);
    free(cable_index);
    table_free(&nodes);
    table_free(&cables);
    if (status != HF_OK) hf_scene_free(scene); /* its ids would point into freed text */
    return status;
}
