/* Reads a study file:
 *
 *     YAML -> base, title, sweep section -> axes as lists or ranges -> number of values of each axis
 *       -> number of points -> values (lists, even ranges, samples), each checked -> hf_study_make_points
 *
 * Contents: faults - axes given as lists - axes given as ranges - the sweep section - the file */
#include "case/study.h"

#include "base/path.h"
#include "base/text.h"
#include "case/config_rename.h"
#include "case/config_value.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#define STUDY_MAX (16 << 20) /* maximum size of a study file, bytes */
#define VALUE_SIZE 4200      /* bytes of one value as text: a path with every character escaped */

typedef enum { SAMPLE_NONE, SAMPLE_LATIN_HYPERCUBE, SAMPLE_SOBOL } sampling;

/* How an axis was given. It is kept until all axes are known and their points are counted. */
typedef struct {
    const yaml_node_t *list; /* NULL: a range {from, to, ...} */
    bool is_faulty;          /* true: the axis has no values */
    double from, to;
    bool is_log;
    int n;
    sampling sample;
    yaml_mark_t mark;
} source;

typedef struct {
    hf_study *study;
    hf_messages *messages;
    hf_config_faults faults; /* of the study, for old names */
    yaml_document_t *document;
    bool failed, no_memory;
    int n; /* n of the sweep section; 0: not given */
    uint64_t seed;
    source source[HF_STUDY_AXIS_MAX]; /* [n_axis], source of each axis */
} reader;

/* ---- faults ---- */

static void fault(reader *r, yaml_mark_t mark, const char *key, const char *format, ...) HF_PRINTF(4, 5);
static void fault(reader *r, yaml_mark_t mark, const char *key, const char *format, ...)
{
    char what[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    hf_text_trim_utf8(what);
    r->failed = true;
    hf_error(r->messages, HF_BAD_CASE, "%s:%zu:%zu: sweep%s%s: %s", r->study->path, mark.line + 1, mark.column + 1,
             *key ? "." : "", key, what);
}

static const yaml_node_t *node_at(reader *r, int index)
{
    return yaml_document_get_node(r->document, index);
}

static void fault_unknown(reader *r, yaml_mark_t mark, const char *key, const char *word, const char *const *names,
                          int n_name)
{
    const char *near = hf_text_nearest(word, names, n_name);
    if (near)
        fault(r, mark, key, "unknown key '%s'; did you mean '%s'?", word, near);
    else
        fault(r, mark, key, "unknown key '%s'%s", word, *key ? "" : " (hifdm schema lists all keys)");
}

/* Returns true and reports a fault if the mapping has this key before `pair`. */
static bool is_repeated(reader *r, const yaml_node_t *mapping, const yaml_node_pair_t *pair, const char *path)
{
    const yaml_node_t *key = node_at(r, pair->key), *earlier = hf_config_earlier_key(r->document, mapping, pair);
    if (earlier)
        fault(r, key->start_mark, path, "'%s' stands here already, on line %zu", hf_config_text(key),
              earlier->start_mark.line + 1);
    return earlier;
}

static bool read_number(reader *r, const yaml_node_t *node, const char *key, const char *name, double *value)
{
    if (hf_text_double(hf_config_text(node), value)) return true;
    fault(r, node->start_mark, key, "%s must be a number, not '%s'", name, hf_config_text(node));
    return false;
}

static void read_count(reader *r, const yaml_node_t *node, const char *key, int *n)
{
    uint64_t value = 0;
    if (!hf_text_uint64(hf_config_text(node), &value) || value < 1 || value > HF_STUDY_POINT_MAX)
        fault(r, node->start_mark, key, "n must be a whole number from 1 to %d, not '%s'", HF_STUDY_POINT_MAX,
              hf_config_text(node));
    else
        *n = (int)value;
}

/* Returns the index of a word; 0 after reporting a fault. */
static int read_word(reader *r, const yaml_node_t *node, const char *key, const char *name, const char *const *words,
                     int n_word)
{
    char list[200] = "";
    for (int k = 0; k < n_word; k++) {
        if (!strcmp(hf_config_text(node), words[k])) return k;
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", k ? ", " : "", words[k]);
    }
    fault(r, node->start_mark, key, "%s must be one of %s, not '%s'", name, list, hf_config_text(node));
    return 0;
}

/* ---- axes given as lists ---- */

/* Writes the value as YAML on one line. Returns false if it is neither a scalar nor a list of scalars. */
static bool value_text(reader *r, const yaml_node_t *node, char *text)
{
    size_t used = 0;
    if (node->type == YAML_SCALAR_NODE) return snprintf(text, VALUE_SIZE, "%s", hf_config_text(node)) < VALUE_SIZE;
    if (node->type != YAML_SEQUENCE_NODE) return false;
    for (const int *item = node->data.sequence.items.start; item < node->data.sequence.items.top; item++) {
        if (node_at(r, *item)->type != YAML_SCALAR_NODE) return false;
        used += (size_t)snprintf(text + used, VALUE_SIZE - used, "%s%s", used ? "," : "[",
                                 hf_config_text(node_at(r, *item)));
        if (used + 2 >= VALUE_SIZE) return false;
    }
    snprintf(text + used, VALUE_SIZE - used, "]");
    return true;
}

/* Writes a text as a quoted YAML scalar. Paths are relative to the study file. */
static bool quote(const reader *r, const hf_field *field, const char *value, char *text)
{
    char whole[2 * HF_PATH_SIZE];
    const char *beside = field->max == HF_PATH_SIZE ? r->study->path : "";
    if (!hf_path_beside(beside, value, whole, sizeof whole)) return false;
    *text++ = '"';
    for (const char *p = whole; *p; p++) {
        if (*p == '"' || *p == '\\') *text++ = '\\';
        *text++ = *p;
    }
    strcpy(text, "\"");
    return true;
}

/* Sets value k of the axis. A study may have a million values, so numbers that are within their range are not
 * parsed as YAML. */
static void set_value(reader *r, hf_study_axis *axis, int k, const char *value, bool is_canonical, yaml_mark_t mark)
{
    const char *key = axis->key.path, *to = key, *canonical = value;
    char text[VALUE_SIZE], old[2 * HF_KEY_SIZE] = "", now[HF_KEY_SIZE];
    if (axis->key.field->type == HF_FIELD_WORD) snprintf(old, sizeof old, "%s=%s", key, value);
    if (*old && hf_config_rename(&r->faults, mark.line, mark.column, old, now)) {
        value = strchr(now, '=') + 1;
        now[value - now - 1] = '\0';
        to = now;
        if (!strcmp(to, key)) canonical = value; /* over: states becomes another key, and the axis keeps its word */
    }
    hf_field_type type = axis->key.field->type;
    bool is_text = type == HF_FIELD_TEXT || (type == HF_FIELD_SET && *value != '['); /* a list of sets is no text */
    bool fits =
        is_text ? quote(r, axis->key.field, value, text) : snprintf(text, sizeof text, "%s", value) < VALUE_SIZE;
    bool is_one_line = !strchr(value, '\n');
    hf_status status = fits && is_one_line ? HF_OK : HF_BAD_CASE;
    if (status == HF_OK && to == key && !hf_config_is_in_range(axis->key.field, text)) {
        char location[HF_PATH_SIZE + 128];
        snprintf(location, sizeof location, "%s:%zu:%zu: sweep", r->study->path, mark.line + 1, mark.column + 1);
        status = hf_config_check_value(key, text, location, r->messages);
    }
    if (!fits) fault(r, mark, key, "is too long");
    if (!is_one_line) fault(r, mark, key, "a value must be on one line");
    if (status != HF_OK) {
        r->no_memory |= status == HF_NO_MEMORY;
        r->failed = true;
        return;
    }
    size_t size = strlen(to) + strlen(text) + 2;
    char *set = axis->set[k] = malloc(size);
    if (set) snprintf(set, size, "%s=%s", to, text);
    axis->canonical[k] = set && is_canonical ? strdup(set) : hf_study_canonical(&axis->key, canonical);
    r->no_memory |= !set || !axis->canonical[k];
}

static bool reserve_values(reader *r, hf_study_axis *axis)
{
    axis->set = calloc((size_t)axis->n_value, sizeof *axis->set);
    axis->canonical = calloc((size_t)axis->n_value, sizeof *axis->canonical);
    if (axis->set && axis->canonical) return true;
    r->no_memory = true;
    return false;
}

static void read_list(reader *r, hf_study_axis *axis, const yaml_node_t *list, source *to)
{
    long n = list->data.sequence.items.top - list->data.sequence.items.start;
    to->list = list;
    to->mark = list->start_mark;
    to->is_faulty = n < 1 || n > HF_STUDY_POINT_MAX;
    if (to->is_faulty)
        fault(r, list->start_mark, axis->key.path, "needs from 1 to %d values", HF_STUDY_POINT_MAX);
    else
        to->n = (int)n;
}

static void fill_list(reader *r, hf_study_axis *axis, const yaml_node_t *list)
{
    char text[VALUE_SIZE];
    if (!reserve_values(r, axis)) return;
    for (int k = 0; k < axis->n_value; k++) {
        const yaml_node_t *node = node_at(r, list->data.sequence.items.start[k]);
        if (value_text(r, node, text))
            set_value(r, axis, k, text, false, node->start_mark);
        else
            fault(r, node->start_mark, axis->key.path, "a value must be one number, word or pair like [5, 5]");
    }
}

/* ---- axes given as ranges ---- */

/* Reads an end of a range; it must be within the range of the key. An end of 0 is accepted for keys that must be above
 * 0: samples do not reach it, and every value is checked later. */
static bool read_end(reader *r, const hf_key *key, const yaml_node_t *node, const char *name, double *value)
{
    const hf_field *f = key->field;
    char words[HF_CONFIG_RANGE_SIZE];
    if (!read_number(r, node, key->path, name, value)) return false;
    if (*value <= f->max && *value >= (f->min == HF_ABOVE_ZERO ? 0 : f->min)) return true;
    hf_config_range_words(f, words);
    fault(r, node->start_mark, key->path, "%s %s%s", name, words, hf_config_text(node));
    return false;
}

static void read_range_key(reader *r, const hf_key *of, const yaml_node_t *key, const yaml_node_t *value, source *to,
                           bool given[2])
{
    static const char *const names[] = {"from", "to", "n", "spacing", "sample"};
    static const char *const spacings[] = {"linear", "log"};
    static const char *const samplings[] = {"latin_hypercube", "sobol"}; /* in the order of `sampling` */
    const char *word = hf_config_text(key), *path = of->path;
    if (!strcmp(word, "from"))
        given[0] = read_end(r, of, value, word, &to->from);
    else if (!strcmp(word, "to"))
        given[1] = read_end(r, of, value, word, &to->to);
    else if (!strcmp(word, "n"))
        read_count(r, value, path, &to->n);
    else if (!strcmp(word, "spacing"))
        to->is_log = read_word(r, value, path, word, spacings, 2) == 1;
    else if (!strcmp(word, "sample"))
        to->sample = (sampling)((int)SAMPLE_LATIN_HYPERCUBE + read_word(r, value, path, word, samplings, 2));
    else
        fault_unknown(r, key->start_mark, path, word, names, 5);
}

static void read_range(reader *r, hf_study_axis *axis, const yaml_node_t *mapping, source *to)
{
    const char *path = axis->key.path;
    const hf_field_type type = axis->key.field->type;
    bool given[2] = {false, false}, failed_before = r->failed;
    to->mark = mapping->start_mark;
    to->is_faulty = true;
    if (type == HF_FIELD_WORD || type == HF_FIELD_TEXT || type == HF_FIELD_SET || type == HF_FIELD_INT_PAIR ||
        type == HF_FIELD_BOUNDS || type == HF_FIELD_VECTOR) {
        fault(r, to->mark, path, "is no number, so it needs a list of values");
        return;
    }
    for (yaml_node_pair_t *p = mapping->data.mapping.pairs.start; p < mapping->data.mapping.pairs.top; p++)
        if (!is_repeated(r, mapping, p, path))
            read_range_key(r, &axis->key, node_at(r, p->key), node_at(r, p->value), to, given);
    if (r->failed != failed_before) return;
    if (!given[0] || !given[1])
        fault(r, to->mark, path, "a range needs from and to");
    else if (to->is_log && (to->from <= 0 || to->to <= 0))
        fault(r, to->mark, path, "spacing: log needs from and to above 0");
    else if (to->sample && to->n)
        fault(r, to->mark, path, "sampled axes share the n of the sweep section");
    else
        to->is_faulty = false;
}

/* Sets the values of a range at x[0], x[stride], ... in 0..1, or in even steps if x is NULL. */
static void fill_range(reader *r, int a, const double *x, int stride)
{
    hf_study_axis *axis = &r->study->axis[a];
    const source *from = &r->source[a];
    char text[40];
    if (!reserve_values(r, axis)) return;
    bool failed_before = r->failed;
    r->failed = false;
    for (int i = 0; i < axis->n_value && !r->failed; i++) { /* reports only the first bad value of a range */
        double part = x ? x[(size_t)i * (size_t)stride] : axis->n_value > 1 ? i / (axis->n_value - 1.0) : 0;
        hf_study_range_value(axis->key.field, from->from, from->to, from->is_log, part, text);
        set_value(r, axis, i, text, true, from->mark);
    }
    r->failed |= failed_before;
}

/* Sets the values of all sampled axes of one kind, as one joint axis. */
static void fill_sampled(reader *r, sampling kind)
{
    int member[HF_STUDY_AXIS_MAX], n_member = 0;
    for (int a = 0; a < r->study->n_axis; a++)
        if (!r->source[a].is_faulty && r->source[a].sample == kind) member[n_member++] = a;
    if (!n_member) return;
    double *x = malloc((size_t)r->n * (size_t)n_member * sizeof *x);
    if (!x || (kind == SAMPLE_SOBOL ? hf_study_sobol(r->n, n_member, x)
                                    : hf_study_latin_hypercube(r->n, n_member, r->seed, x)) != HF_OK)
        r->no_memory = true;
    for (int k = 0; k < n_member && !r->no_memory; k++)
        fill_range(r, member[k], x + k, n_member);
    free(x);
}

/* ---- the sweep section ---- */

/* Counts the values of each axis before any value is made. */
static void count_values(reader *r)
{
    for (int a = 0; a < r->study->n_axis; a++) {
        source *from = &r->source[a];
        hf_study_axis *axis = &r->study->axis[a];
        if (from->is_faulty) continue;
        axis->is_sampled = from->sample != SAMPLE_NONE;
        axis->n_value = from->n ? from->n : r->n;
        from->is_faulty = axis->n_value == 0;
        if (from->is_faulty && axis->is_sampled)
            fault(r, from->mark, "", "sampled axes need n in the sweep section");
        else if (from->is_faulty)
            fault(r, from->mark, axis->key.path, "needs n, here or for all ranges in the sweep section");
    }
}

static void fill_axes(reader *r)
{
    for (int a = 0; a < r->study->n_axis; a++)
        if (r->source[a].is_faulty)
            continue;
        else if (r->source[a].list)
            fill_list(r, &r->study->axis[a], r->source[a].list);
        else if (r->source[a].sample == SAMPLE_NONE)
            fill_range(r, a, NULL, 0);
    fill_sampled(r, SAMPLE_LATIN_HYPERCUBE);
    fill_sampled(r, SAMPLE_SOBOL);
}

/* Reports an unknown key. In a row, the suggestions are the keys of its list. */
static void fault_no_axis(reader *r, const yaml_node_t *key, const char *word, const char *const *names, int n)
{
    const char *dot = strrchr(word, '.'), *of_row[64];
    char prefix[HF_KEY_SIZE];
    hf_key row;
    snprintf(prefix, sizeof prefix, "%.*s", dot ? (int)(dot - word) : 0, word);
    if (hf_key_find_list(word) || hf_key_find(word, &row)) {
        fault(r, key->start_mark, word, "has many keys; an axis is one key of one row, like %s.0.%s",
              hf_list_table[0].path, hf_list_table[0].field[0].path);
    } else if (hf_key_find(prefix, &row) && !row.field) {
        for (n = 0; n < row.list->n_field && n < 64; n++)
            of_row[n] = row.list->field[n].path;
        fault_unknown(r, key->start_mark, prefix, dot + 1, of_row, n);
    } else {
        fault_unknown(r, key->start_mark, "", word, names, n);
    }
}

/* Appends an axis. Returns false after reporting a fault if there are too many. */
static bool add_axis(reader *r, const yaml_node_t *key, const hf_key *of)
{
    hf_study *s = r->study;
    if (s->n_axis == HF_STUDY_AXIS_MAX) {
        fault(r, key->start_mark, of->path, "more than %d axes", HF_STUDY_AXIS_MAX);
        return false;
    }
    s->axis[s->n_axis++] =
        (hf_study_axis){.key = *of, .line = (int)key->start_mark.line + 1, .column = (int)key->start_mark.column + 1};
    return true;
}

/* Reads the number of replicates as an axis of the whole numbers up to it. */
static void read_replicates(reader *r, const yaml_node_t *key, const yaml_node_t *value)
{
    static const hf_field field = {HF_STUDY_REPLICATE, HF_FIELD_INT, 0, 1, HF_STUDY_REPLICATES_MAX, "", "", NULL};
    hf_study *s = r->study;
    uint64_t n = 0;
    if (!hf_text_uint64(hf_config_text(value), &n) || n < 2 || n > HF_STUDY_REPLICATES_MAX) {
        fault(r, value->start_mark, hf_config_text(key), "must be a whole number from 2 to %d, not '%s'",
              HF_STUDY_REPLICATES_MAX, hf_config_text(value));
    } else if (add_axis(r, key, &(hf_key){.path = HF_STUDY_REPLICATE, .field = &field})) {
        s->n_replicate = (int)n;
        s->axis[s->n_axis - 1].is_replicate = true;
        r->source[s->n_axis - 1] = (source){.from = 1, .to = (double)n, .n = (int)n, .mark = value->start_mark};
    }
}

static void read_axis(reader *r, const yaml_node_t *key, const yaml_node_t *value)
{
    static const char *const reserved[] = {"n", "combine", "seed", "files", "replicates"};
    const char *names[256];
    char path[HF_KEY_SIZE];
    hf_study *s = r->study;
    hf_key found;
    int n = 0;
    hf_config_rename(&r->faults, key->start_mark.line, key->start_mark.column, hf_config_text(key), path);
    for (int i = 0; i < hf_n_field && n < 250; i++)
        names[n++] = hf_field_table[i].path;
    for (int i = 0; i < 5; i++)
        names[n++] = reserved[i];
    if (!hf_key_find(path, &found) || !found.field) {
        fault_no_axis(r, key, path, names, n);
        return;
    }
    for (int a = 0; a < s->n_axis; a++)
        if (!strcmp(s->axis[a].key.path, path)) {
            fault(r, key->start_mark, path, "is an axis already, on line %d", s->axis[a].line);
            return;
        }
    if (!add_axis(r, key, &found)) return;
    hf_study_axis *axis = &s->axis[s->n_axis - 1];
    source *to = &r->source[s->n_axis - 1];
    to->is_faulty = value->type == YAML_SCALAR_NODE;
    if (value->type == YAML_SEQUENCE_NODE)
        read_list(r, axis, value, to);
    else if (value->type == YAML_MAPPING_NODE)
        read_range(r, axis, value, to);
    else
        fault(r, value->start_mark, path, "must be a list of values, or {from, to, n}");
}

static void read_sweep(reader *r, const yaml_node_t *mapping)
{
    static const char *const combines[] = {"product", "zip"};
    hf_study *s = r->study;
    if (mapping->type != YAML_MAPPING_NODE) {
        fault(r, mapping->start_mark, "", "must be a section of axes, like form.pretension_N: [8, 10, 12]");
        return;
    }
    for (yaml_node_pair_t *p = mapping->data.mapping.pairs.start; p < mapping->data.mapping.pairs.top; p++) {
        const yaml_node_t *key = node_at(r, p->key), *value = node_at(r, p->value);
        const char *word = hf_config_text(key);
        if (is_repeated(r, mapping, p, "")) continue;
        if (!strcmp(word, "n"))
            read_count(r, value, "", &r->n);
        else if (!strcmp(word, "combine"))
            s->is_zip = read_word(r, value, "", word, combines, 2) == 1;
        else if (!strcmp(word, "files"))
            s->files = (hf_study_files)read_word(r, value, "", word, hf_study_files_word, 3);
        else if (!strcmp(word, "seed")) {
            if (!hf_text_uint64(hf_config_text(value), &r->seed))
                fault(r, value->start_mark, "", "seed must be a whole number from 0 to 2^64-1, not '%s'",
                      hf_config_text(value));
        } else if (!strcmp(word, "replicates"))
            read_replicates(r, key, value);
        else
            read_axis(r, key, value);
    }
    for (int a = 0; a < s->n_axis && s->n_replicate; a++)
        if (!strcmp(s->axis[a].key.path, "optimize.seed"))
            fault(r, r->source[a].mark, "optimize.seed",
                  "each replicate has a seed of its own. Remove this axis, or the key replicates");
    if (!s->n_axis && !r->failed) fault(r, mapping->start_mark, "", "has no axis");
    count_values(r);
    if (!r->failed && hf_study_count_points(s, r->messages) != HF_OK)
        r->failed = true;
    else
        fill_axes(r);
}

/* ---- the file ---- */

static void read_base(reader *r, const yaml_node_t *node)
{
    hf_study *s = r->study;
    const char *name = hf_config_text(node);
    if (!*name)
        fault(r, node->start_mark, "", "base must be the name of a case file");
    else if (!hf_path_beside(s->path, name, s->base, sizeof s->base))
        fault(r, node->start_mark, "", "base is too long");
}

static void read_title(reader *r, const yaml_node_t *node)
{
    const char *text = hf_config_text(node);
    size_t size = sizeof r->study->title;
    if (node->type != YAML_SCALAR_NODE || strchr(text, '\n'))
        fault(r, node->start_mark, "", "title must be a text on one line");
    else if (snprintf(r->study->title, size, "%s", text) >= (int)size)
        fault(r, node->start_mark, "", "title is longer than %zu bytes", size - 1);
}

static const char *const root_name[] = {"base", "title", "sweep"};
enum { N_ROOT_NAME = sizeof root_name / sizeof *root_name };

/* Finds the values of the root_name, the last one of each. */
static void find_names(yaml_document_t *document, const yaml_node_t *root, const yaml_node_t *found[N_ROOT_NAME])
{
    if (!root || root->type != YAML_MAPPING_NODE) return;
    for (yaml_node_pair_t *p = root->data.mapping.pairs.start; p < root->data.mapping.pairs.top; p++) {
        int k = hf_text_index(hf_config_text(yaml_document_get_node(document, p->key)), root_name, N_ROOT_NAME);
        if (k >= 0) found[k] = yaml_document_get_node(document, p->value);
    }
}

static void read_root(reader *r, const yaml_node_t *root)
{
    const yaml_node_t *found[N_ROOT_NAME] = {0};
    yaml_mark_t start = {0};
    if (!root || root->type != YAML_MAPPING_NODE) {
        fault(r, start, "", "the file must be key: value lines");
        return;
    }
    find_names(r->document, root, found);
    const yaml_node_t *base = found[0], *title = found[1], *sweep = found[2];
    for (yaml_node_pair_t *p = root->data.mapping.pairs.start; base && p < root->data.mapping.pairs.top; p++) {
        const yaml_node_t *key = node_at(r, p->key);
        if (is_repeated(r, root, p, "")) continue;
        if (hf_text_index(hf_config_text(key), root_name, N_ROOT_NAME) < 0)
            fault_unknown(r, key->start_mark, "", hf_config_text(key), root_name, N_ROOT_NAME);
    }
    snprintf(r->study->base, sizeof r->study->base, "%s", r->study->path);
    if (base) read_base(r, base);
    if (base && title) read_title(r, title);
    if (sweep)
        read_sweep(r, sweep);
    else
        fault(r, start, "", "is missing: there is no section with axes in this file");
}

static int compare_axes(const void *a, const void *b)
{
    const hf_study_axis *x = a, *y = b;
    char old_x[HF_KEY_SIZE], old_y[HF_KEY_SIZE];
    hf_config_old_name(x->key.path, old_x);
    hf_config_old_name(y->key.path, old_y);
    return strcmp(old_x, old_y);
}

/* Parses a text as YAML. Returns false if it is none, with *problem and its *mark, or if memory ran out, with NULL. The
 * caller deletes the document. */
static bool load_yaml(const char *text, size_t length, yaml_document_t *document, const char **problem,
                      yaml_mark_t *mark)
{
    yaml_parser_t parser;
    *problem = NULL;
    if (!yaml_parser_initialize(&parser)) return false;
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);
    bool is_loaded = yaml_parser_load(&parser, document);
    *problem = parser.problem; /* `error` does not always show that there is no memory */
    *mark = parser.problem_mark;
    yaml_parser_delete(&parser);
    return is_loaded;
}

static void parse(reader *r, const char *text, size_t length)
{
    const char *problem;
    yaml_mark_t mark;
    yaml_document_t document;
    if (load_yaml(text, length, &document, &problem, &mark)) {
        r->document = &document;
        read_root(r, yaml_document_get_root_node(&document));
        yaml_document_delete(&document);
    } else if (problem) {
        fault(r, mark, "", "YAML: %s", problem);
    } else {
        r->no_memory = true;
    }
    r->document = NULL;
}

bool hf_study_is(const char *path)
{
    char *text;
    size_t length;
    const char *problem;
    yaml_mark_t mark;
    yaml_document_t document;
    const yaml_node_t *found[N_ROOT_NAME] = {0};
    if (hf_text_read_file(path, HF_BAD_CASE, &text, &length, NULL) != HF_OK) return false;
    if (length <= STUDY_MAX && !hf_text_too_deep(text) && load_yaml(text, length, &document, &problem, &mark)) {
        find_names(&document, yaml_document_get_root_node(&document), found);
        yaml_document_delete(&document);
    }
    free(text);
    return found[0] || found[2]; /* base, sweep */
}

hf_status hf_study_read(const char *path, hf_study *study, hf_messages *messages)
{
    char *text;
    size_t length;
    *study = (hf_study){0};
    if (snprintf(study->path, sizeof study->path, "%s", path) >= HF_PATH_SIZE)
        return hf_error(messages, HF_BAD_CASE, "%s: the path is too long", path);
    HF_TRY(hf_text_read_file(path, HF_BAD_CASE, &text, &length, messages));
    reader r = {.study = study, .messages = messages, .seed = 1};
    r.faults = (hf_config_faults){.messages = messages, .origin = study->path};
    hf_status status = HF_OK;
    if (length > STUDY_MAX)
        status = hf_error(messages, HF_BAD_CASE, "%s: this file is larger than %d MB, so it is not a study", path,
                          STUDY_MAX >> 20);
    else if (hf_text_too_deep(text))
        status = hf_error(messages, HF_BAD_CASE, "%s:%d:1: the YAML text has too many nested brackets", path,
                          hf_text_too_deep(text));
    else
        parse(&r, text, length);
    free(text);
    HF_TRY(status);
    if (r.no_memory) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    if (r.failed) return HF_BAD_CASE;
    qsort(study->axis, (size_t)study->n_axis, sizeof *study->axis, compare_axes);
    return hf_study_make_points(study, messages);
}
