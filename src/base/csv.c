/* Contents: faults - cells that look like formulas - splitting lines - reading - columns and cells - ids - writing */
#include "base/csv.h"

#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define ID_MAX 255

void hf_csv_free(hf_csv *t)
{
    free(t->text);
    free(t->header);
    free(t->cell);
    free(t->line);
    free(t->own);
    free(t->known);
    *t = (hf_csv){0};
}

/* ---- faults ---- */

void hf_csv_fault(hf_csv *t, int line, const char *id, const char *what, const char *detail)
{
    if (++t->n_fault > HF_FAULT_MAX) return;
    if (id)
        hf_error(t->messages, HF_BAD_CASE, "%s:%d: '%s': %s%s", t->path, line, id, what, detail);
    else
        hf_error(t->messages, HF_BAD_CASE, "%s:%d: %s%s", t->path, line, what, detail);
}

hf_status hf_csv_close_faults(hf_csv *t)
{
    if (t->n_comma > 1)
        hf_error(t->messages, HF_BAD_CASE, "%s: %d more numbers have decimal commas instead of decimal points", t->path,
                 t->n_comma - 1);
    t->n_comma = 0;
    if (t->n_fault > HF_FAULT_MAX)
        hf_error(t->messages, HF_BAD_CASE, "%s: hifdm found %d more faults in this file", t->path,
                 t->n_fault - HF_FAULT_MAX);
    return t->n_fault ? HF_BAD_CASE : HF_OK;
}

hf_status hf_csv_no_memory(const hf_csv *t)
{
    return hf_error(t->messages, HF_NO_MEMORY, "%s: out of memory", t->path);
}

/* ---- cells that look like formulas ----
 * Spreadsheets take a cell for a formula if it starts with = + - @, also as full-width letters, or with a tab or an end
 * of line. Some drop leading blanks first. An apostrophe in front makes the cell a text. The writer puts one apostrophe
 * before such a cell, and the reader removes one. Both also do so if the cell already begins with apostrophes, so that
 * reading back is exact. */

static bool is_formula(const char *text)
{
    static const char *const wide[] = {"\xef\xbc\x9d", "\xef\xbc\x8b", "\xef\xbc\x8d", "\xef\xbc\xa0"};
    if (*text && strchr("\t\r\n", *text)) return true;
    text += strspn(text, " \t");
    for (int k = 0; k < 4; k++)
        if (!strncmp(text, wide[k], 3)) return true;
    return *text && strchr("=+-@", *text);
}

static bool is_guarded(const char *text)
{
    return *text == '\'' && is_formula(text + strspn(text, "'"));
}

/* Returns true if the text needs an apostrophe. Numbers need none, although they may begin with a sign. */
static bool needs_guard(const char *text)
{
    double number;
    return is_guarded(text) || (is_formula(text) && !hf_text_double(text, &number));
}

/* ---- splitting lines ---- */

/* Removes blanks at the end of a field. */
static char *trim(char *field)
{
    size_t n = strlen(field);
    while (n && (field[n - 1] == ' ' || field[n - 1] == '\t'))
        field[--n] = '\0';
    return field;
}

/* Removes the quotes of a field such as "quoted ""field""" in place, and moves *p past its closing quote. Returns NULL
 * if there is no closing quote, or if another character than a comma follows it. */
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
    *p += strspn(*p, " \t");
    return **p == '\0' || **p == ',' ? start : NULL;
}

/* Splits one line into at most column_max fields and returns their number. Returns -1 if quotes do not match, and
 * column_max + 1 if there are too many fields. */
static int split(char *line, char **field, int column_max)
{
    int n = 0;
    for (char *p = line;;) {
        if (n == column_max) return column_max + 1;
        p += strspn(p, " \t");
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
        if (!quoted) start = trim(start);
        field[n++] = start + is_guarded(start);
        if (last) return n;
        p++;
    }
}

/* Returns the next line without its end, or NULL after the last one. A line ends with LF, CRLF, or CRCRLF (a file that
 * was converted twice). */
static char *next_line(char **rest)
{
    char *line = *rest;
    if (!*line) return NULL;
    char *end = strchr(line, '\n');
    *rest = end ? end + 1 : line + strlen(line);
    if (end) *end = '\0';
    size_t n = strlen(line);
    while (n && line[n - 1] == '\r')
        line[--n] = '\0';
    return line;
}

/* ---- reading ---- */

static bool add_row(hf_csv *t, char **field, int line)
{
    if (t->n_row == t->row_capacity) {
        int capacity = t->row_capacity ? 2 * t->row_capacity : 64;
        char **cell = realloc(t->cell, (size_t)capacity * (size_t)t->n_column * sizeof *cell);
        if (!cell) return false;
        t->cell = cell;
        int *lines = realloc(t->line, (size_t)capacity * sizeof *lines);
        if (!lines) return false;
        t->line = lines;
        t->row_capacity = capacity;
    }
    memcpy(t->cell + (size_t)t->n_row * (size_t)t->n_column, field, (size_t)t->n_column * sizeof *field);
    t->line[t->n_row++] = line;
    return true;
}

/* Returns a description of the separator if a header line has another one than commas, else NULL. */
static const char *other_separator(const char *line)
{
    if (strpbrk(line, ",\"")) return NULL;
    return strchr(line, ';') ? "';', and numbers have points" : strchr(line, '\t') ? "tabs" : NULL;
}

/* Consecutive lines with the same wrong number of fields. They are reported as one fault. */
typedef struct {
    int n_field, first_line, n_line;
} uneven_lines;

static void tell_uneven(hf_csv *t, const uneven_lines *u)
{
    char more[64] = "", what[192];
    bool may_have_commas = u->n_field > t->n_column + 1; /* probably decimal commas in several columns */
    if (u->n_line > 1) snprintf(more, sizeof more, ", here and on %d more lines", u->n_line - 1);
    snprintf(what, sizeof what, "%d fields where the header has %d%s%s", u->n_field, t->n_column, more,
             may_have_commas ? ": decimal commas? Numbers have points" : "");
    if (u->n_line > 0) hf_csv_fault(t, u->first_line, NULL, what, "");
}

static void note_uneven(hf_csv *t, int n_field, int line, uneven_lines *u)
{
    if (u->n_line > 0 && u->n_field != n_field) {
        tell_uneven(t, u);
        u->n_line = 0;
    }
    if (u->n_line == 0) *u = (uneven_lines){n_field, line, 0};
    u->n_line++;
}

/* Adds one line that is not a comment to the table. Returns false if memory runs out. */
static bool take_line(hf_csv *t, char *line, int n_line, char **field, int column_max, uneven_lines *uneven)
{
    const char *fault = strchr(line, '\r')       ? "a carriage return within the line; lines end with LF or CRLF"
                        : !hf_text_is_utf8(line) ? "not UTF-8 text, or a control character; save the file as UTF-8"
                                                 : NULL;
    int n = fault ? 0 : split(line, field, column_max);
    if (n < 0) fault = "a quoted field does not end on this line";
    if (n > column_max) fault = "too many columns";
    if (fault)
        hf_csv_fault(t, n_line, NULL, fault, "");
    else if (t->n_column == 0) {
        memcpy(t->header, field, (size_t)(t->n_column = n) * sizeof *field);
        t->header_line = n_line;
    } else if (n != t->n_column)
        note_uneven(t, n, n_line, uneven);
    else
        return add_row(t, field, n_line);
    return true;
}

/* Returns true for UTF-16 text. It has a byte order mark, or a zero among its first two bytes. */
static bool is_utf16(const char *text, size_t length)
{
    if (length < 2) return false;
    return !memcmp(text, "\xFF\xFE", 2) || !memcmp(text, "\xFE\xFF", 2) || !text[0] != !text[1];
}

hf_status hf_csv_read(const char *path, int column_max, hf_csv *t, hf_messages *messages)
{
    size_t length;
    *t = (hf_csv){.path = path, .messages = messages};
    HF_TRY(hf_text_read_file(path, HF_BAD_CASE, &t->text, &length, messages));
    if (is_utf16(t->text, length))
        return hf_error(messages, HF_BAD_CASE, "%s: this file contains UTF-16 text. Save the file as CSV UTF-8", path);
    if (strlen(t->text) != length) return hf_error(messages, HF_BAD_CASE, "%s: this file is not a text file", path);
    t->header = malloc(2 * (size_t)column_max * sizeof *t->header); /* the second half holds the fields of one line */
    if (!t->header) return hf_csv_no_memory(t);
    char *rest = t->text, *line, **field = t->header + column_max;
    uneven_lines uneven = {0};
    if (!strncmp(rest, "\xEF\xBB\xBF", 3)) rest += 3; /* byte order mark of spreadsheet programs */
    for (int n_line = 1; (line = next_line(&rest)) != NULL; n_line++) {
        if (line[strspn(line, " \t")] == '\0' || *line == '#') continue;
        const char *separator = t->n_column == 0 && t->n_fault == 0 ? other_separator(line) : NULL;
        if (separator) {
            hf_csv_fault(t, n_line, NULL, "columns are separated by commas, not by ", separator);
            return hf_csv_close_faults(t);
        }
        if (!take_line(t, line, n_line, field, column_max, &uneven)) return hf_csv_no_memory(t);
    }
    tell_uneven(t, &uneven);
    if (t->n_column == 0)
        hf_csv_fault(t, 1, NULL, "the file is empty: a header line is needed", "");
    else if (t->n_row == 0 && t->n_fault == 0)
        hf_csv_fault(t, 1, NULL, "there is a header, but no rows", "");
    return hf_csv_close_faults(t);
}

char *hf_csv_cell(const hf_csv *t, int row, int column)
{
    return t->cell[(size_t)row * (size_t)t->n_column + (size_t)column];
}

/* ---- columns and cells ---- */

/* Units of length in column names. For mm and cm the decimal point of the text is moved; in and ft are multiplied
 * by a factor. */
static const struct {
    const char *suffix;
    int decimals;
    double factor;
} unit[] = {{"_m", 0, 1}, {"_mm", -3, 1}, {"_cm", -2, 1}, {"_in", 0, 0.0254}, {"_ft", 0, 0.3048}};
enum { N_UNIT = sizeof unit / sizeof *unit, METRE = 0 };

/* Returns the unit (index into `unit`) in which the column `head` contains the quantity `name`, or -1
 * for another quantity. */
static int unit_of(const hf_csv *t, const char *head, const char *name)
{
    size_t n = strlen(name), stem = n - strlen(unit[METRE].suffix);
    if (!strcmp(head, name)) return METRE;
    if (t->names_are_ids || n <= strlen(unit[METRE].suffix) || strcmp(name + stem, unit[METRE].suffix) != 0) return -1;
    if (strncmp(head, name, stem) != 0) return -1;
    for (int u = 0; u < N_UNIT; u++)
        if (!strcmp(head + stem, unit[u].suffix)) return u;
    return -1;
}

static int find_name(const hf_csv *t, const char *head, const char *const *names, int n_name)
{
    int named = hf_text_index(head, names, n_name);
    if (named >= 0) return named;
    for (int k = 0; k < n_name; k++)
        if (unit_of(t, head, names[k]) >= 0) return k;
    return -1;
}

int hf_csv_column(const hf_csv *t, const char *name)
{
    return hf_text_index(name, (const char *const *)t->header, t->n_column);
}

/* Returns true if the first line contains at least one of the names. Otherwise it is no header. */
static bool has_header(const hf_csv *t, const char *const *names, int n_name)
{
    for (int c = 0; c < t->n_column; c++)
        if (find_name(t, t->header[c], names, n_name) >= 0) return true;
    return false;
}

#define LIST_SIZE 256

/* Writes names with commas between them into `list`: all n names, or those with where[k] < 0 if `where` is not NULL.
 * Returns their number. */
static int list_names(const char *const *names, int n, const int *where, char list[LIST_SIZE])
{
    int n_listed = 0;
    *list = '\0';
    for (int k = 0; k < n; k++) {
        size_t at = strlen(list);
        if (where && where[k] >= 0) continue;
        snprintf(list + at, LIST_SIZE - at, "%s%s", n_listed++ ? "," : "", names[k]);
    }
    return n_listed;
}

/* Reports required columns that are missing. If several are missing, the columns probably have other names, so the
 * message lists all required ones. */
static hf_status demand_columns(hf_csv *t, const char *const *names, int n_required, const int *where)
{
    char missing[LIST_SIZE], list[LIST_SIZE], what[2 * LIST_SIZE];
    int n_missing = list_names(names, n_required, where, missing);
    list_names(names, n_required, NULL, list);
    if (n_missing == 1) hf_csv_fault(t, t->header_line, NULL, "a column is missing: ", missing);
    snprintf(what, sizeof what, "the first line has to name the columns: %s%s", list,
             n_missing < n_required ? "; missing are " : "");
    if (n_missing > 1) hf_csv_fault(t, t->header_line, NULL, what, n_missing < n_required ? missing : "");
    return hf_csv_close_faults(t);
}

/* Reports coordinates in two different units, because they are probably a mistake. */
static void demand_one_unit(hf_csv *t, const char *const *names, int n_required, const int *where)
{
    const char *first = NULL, *own;
    for (int k = 0; k < n_required; k++) {
        size_t n = strlen(names[k]);
        if (where[k] < 0 || n < 2 || strcmp(names[k] + n - 2, unit[METRE].suffix) != 0) continue;
        own = t->header[where[k]] + n - 2;
        if (!first) first = own;
        if (strcmp(own, first) == 0) continue;
        char what[LIST_SIZE];
        snprintf(what, sizeof what, "lengths are in one unit, %s or %s: ", first + 1, own + 1);
        hf_csv_fault(t, t->header_line, NULL, what, t->header[where[k]]);
        return;
    }
}

static bool is_ours(const hf_csv *t, const char *name)
{
    for (const char *const *ours = t->ours; ours && *ours; ours++)
        if (!strcmp(*ours, name)) return true;
    return false;
}

hf_status hf_csv_find_columns(hf_csv *t, const char *const *names, int n_name, int n_required, int *where)
{
    for (int k = 0; k < n_name; k++)
        where[k] = -1;
    if (n_required && !has_header(t, names, n_name)) return demand_columns(t, names, n_required, where);
    for (int c = 0; c < t->n_column; c++) {
        int k = find_name(t, t->header[c], names, n_name);
        if (k < 0 && !is_ours(t, t->header[c])) {
            char hint[HF_TEXT_HINT_SIZE];
            hf_text_hint(t->header[c], names, n_name, hint);
            hf_warning(t->messages, "%s:%d: column '%s' is not used%s", t->path, t->header_line, t->header[c], hint);
        } else if (k >= 0 && where[k] >= 0) {
            hf_csv_fault(t, t->header_line, NULL, "this column stands twice: ", names[k]);
        } else if (k >= 0) {
            where[k] = c;
        }
    }
    demand_one_unit(t, names, n_required, where);
    return demand_columns(t, names, n_required, where);
}

double hf_csv_number(hf_csv *t, int row, int column, const char *id, const char *name)
{
    double value = NAN;
    const char *text = hf_csv_cell(t, row, column);
    char what[512]; /* ids may be long */
    int u = unit_of(t, t->header[column], name);
    if (u > METRE) name = t->header[column];
    snprintf(what, sizeof what, "%s must be a finite number, not ", name);
    if (hf_text_decimal(text, u > METRE ? unit[u].decimals : 0, &value))
        return u > METRE ? value * unit[u].factor : value;
    if (!hf_text_has_decimal_comma(text)) {
        hf_csv_fault(t, t->line[row], id, what, *text ? text : "empty");
        return NAN;
    }
    snprintf(what, sizeof what, "%s has a decimal comma, and numbers have points: ", name);
    if (t->n_comma++ == 0) hf_csv_fault(t, t->line[row], id, what, text);
    return NAN;
}

int hf_csv_word(hf_csv *t, int row, int column, const char *id, const char *const *words, int n_word)
{
    const char *text = hf_csv_cell(t, row, column);
    for (int k = 0; k < n_word; k++)
        if (!strcasecmp(words[k], text)) return k;
    char what[160], given[400], hint[HF_TEXT_HINT_SIZE];
    int n = snprintf(what, sizeof what, "%s must be one of", t->header[column]);
    for (int k = 0; k < n_word; k++)
        n += snprintf(what + n, sizeof what - (size_t)n, " %s", words[k]);
    snprintf(what + n, sizeof what - (size_t)n, ", not ");
    hf_text_hint(text, words, n_word, hint);
    snprintf(given, sizeof given, "%.200s%s", *text ? text : "empty", hint);
    hf_csv_fault(t, t->line[row], id, what, given);
    return 0;
}

/* ---- ids ---- */

/* An id and its row in the table, or its index in a list. */
struct hf_csv_id {
    const char *id;
    int row;
};

static int compare_ids(const void *a, const void *b)
{
    const struct hf_csv_id *x = a, *y = b;
    int order = strcmp(x->id, y->id);
    return order ? order : (x->row > y->row) - (x->row < y->row);
}

static int compare_with_id(const void *key, const void *item)
{
    return strcmp(key, ((const struct hf_csv_id *)item)->id);
}

/* Sorts ids, every stride-th of a list, into new memory. */
static hf_status sort_ids(const hf_csv *t, int n, const char *const *id, int stride, struct hf_csv_id **sorted)
{
    *sorted = malloc((size_t)n * sizeof **sorted);
    if (!*sorted) return hf_csv_no_memory(t);
    for (int i = 0; i < n; i++)
        (*sorted)[i] = (struct hf_csv_id){id[(ptrdiff_t)i * stride], i};
    qsort(*sorted, (size_t)n, sizeof **sorted, compare_ids);
    return HF_OK;
}

static int find_id(const struct hf_csv_id *sorted, int n, const char *id)
{
    const struct hf_csv_id *hit = bsearch(id, sorted, (size_t)n, sizeof *sorted, compare_with_id);
    return hit ? hit->row : -1;
}

hf_status hf_csv_index(hf_csv *t, int column)
{
    for (int r = 0; r < t->n_row; r++) {
        const char *id = hf_csv_cell(t, r, column);
        if (!*id) hf_csv_fault(t, t->line[r], NULL, "the id is empty", "");
        if (strlen(id) > ID_MAX) hf_csv_fault(t, t->line[r], NULL, "the id is longer than 255 bytes", "");
    }
    HF_TRY(sort_ids(t, t->n_row, (const char *const *)t->cell + column, t->n_column, &t->own));
    for (int k = 1; k < t->n_row; k++) {
        const struct hf_csv_id *id = t->own + k;
        if (!*id->id || strcmp(id->id, id[-1].id) != 0) continue;
        char what[64];
        snprintf(what, sizeof what, "this id was used before, on line %d", t->line[id[-1].row]);
        hf_csv_fault(t, t->line[id->row], id->id, what, "");
        t->has_doubles = true;
    }
    return HF_OK;
}

hf_status hf_csv_know(hf_csv *t, int n, const char *const *id)
{
    t->n_known = n;
    return sort_ids(t, n, id, 1, &t->known);
}

int hf_csv_find_known(const hf_csv *t, const char *id)
{
    return find_id(t->known, t->n_known, id);
}

/* Returns true if this unknown name was reported before. Records it otherwise, while there is room. */
static bool is_reported(hf_csv *t, const char *name)
{
    if (hf_text_index(name, t->unknown, t->n_unknown) >= 0) return true;
    if (t->n_unknown < HF_CSV_UNKNOWN_MAX) t->unknown[t->n_unknown++] = name;
    return false;
}

/* If `of` has duplicate ids, one of those may be the misspelt id. Each unknown name is then reported once, although
 * several rows may contain it. */
int hf_csv_reference(hf_csv *t, int row, int column, const char *id, const char *what, const hf_csv *of)
{
    const char *name = hf_csv_cell(t, row, column);
    int at = find_id(of->own, of->n_row, name);
    if (at >= 0) return at;
    if (!of->has_doubles || !is_reported(t, name)) hf_csv_fault(t, t->line[row], id, what, *name ? name : "(empty)");
    return 0;
}

char *hf_csv_keep(int n_list, const hf_csv_texts *list)
{
    size_t size = 1;
    for (int k = 0; k < n_list; k++)
        for (int i = 0; i < list[k].n; i++)
            size += strlen(list[k].text[i]) + 1;
    char *all = malloc(size), *to = all;
    for (int k = 0; all && k < n_list; k++)
        for (int i = 0; i < list[k].n; i++) {
            list[k].text[i] = strcpy(to, list[k].text[i]);
            to += strlen(to) + 1;
        }
    return all;
}

/* ---- writing ---- */

void hf_csv_write_id(const char *id, FILE *f)
{
    size_t n = strlen(id);
    const char *guard = needs_guard(id) ? "'" : "";
    bool plain = !strpbrk(id, ",;\"\t\r\n") && id[0] != '#' && id[0] != ' ' &&
                 (n == 0 || (id[n - 1] != ' ' && id[n - 1] != '\t'));
    if (plain) {
        fprintf(f, "%s%s", guard, id);
        return;
    }
    fprintf(f, "\"%s", guard);
    for (; *id; id++) {
        if (*id == '"') fputc('"', f);
        fputc(*id, f);
    }
    fputc('"', f);
}
