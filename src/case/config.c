/* Loads a case file:
 *
 *     text -> defaults of all keys -> YAML tree -> values (config_value), rows of lists
 *       -> overrides (--set) -> checks that involve several keys (config_check) -> completion
 *       -> the sweep section is removed from the text -> SHA-256 of text and overrides
 *
 * Contents: looking up keys - setting one value - walking the YAML tree - overrides - load */
#include "base/sha256.h"
#include "base/text.h"
#include "case/config_check.h"
#include "case/config_rename.h"
#include "case/config_suggest.h"
#include "case/config_value.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#define CASE_MAX (1 << 20) /* maximum size of a case file, bytes */

typedef struct {
    hf_case *c;
    hf_config_faults faults;
    yaml_mark_t cut[2]; /* start and end of the sweep section, if there is one */
    yaml_document_t *document;
    int n_noted;   /* faults whose key was noted as not read */
    bool walked;   /* true: the file was readable YAML, so missing keys can be reported */
    bool is_study; /* true: the file has the key `base`; it is a study, and no key of a case is missing */
    bool no_memory;
} loader;

static void complain(loader *l, yaml_mark_t mark, const char *path, const char *what, const char *detail)
{
    hf_config_fault_at(&l->faults, mark.line, mark.column, path, what, detail);
}

/* Notes that the faults since the last call are of this key. */
static void note_faults(loader *l, const char *path)
{
    if (l->faults.n > l->n_noted) hf_config_note_unread(&l->faults, path);
    l->n_noted = l->faults.n;
}

/* ---- looking up keys ---- */

static const hf_section *find_section(const char *path)
{
    for (int i = 0; i < hf_n_section; i++)
        if (!strcmp(hf_section_table[i].path, path)) return &hf_section_table[i];
    return NULL;
}

/* Notes that the case has this section, if the path is that of a section that can be omitted. */
static void note_section(loader *l, const char *path)
{
    const hf_section *section = find_section(path);
    if (section && section->present_offset != SIZE_MAX) *(bool *)((char *)l->c + section->present_offset) = true;
}

/* Returns the part of `path` below `prefix` if `path` is a direct child of it, else NULL. */
static const char *child_of(const char *path, const char *prefix)
{
    size_t n = strlen(prefix);
    if (n) {
        if (strncmp(path, prefix, n) || path[n] != '.') return NULL;
        path += n + 1;
    }
    return strchr(path, '.') ? NULL : path;
}

/* Returns the known key below `prefix` that is nearest to this key, or NULL. */
static const char *nearest_key(const char *prefix, const char *key)
{
    hf_key of;
    const hf_list *row = hf_key_find(prefix, &of) && !of.field ? of.list : NULL;
    const char *names[128];
    int n = 0;
    for (int i = 0; i < hf_n_field && n < 128; i++)
        if (child_of(hf_field_table[i].path, prefix)) names[n++] = child_of(hf_field_table[i].path, prefix);
    for (int i = 0; i < hf_n_section && n < 128; i++)
        if (child_of(hf_section_table[i].path, prefix)) names[n++] = child_of(hf_section_table[i].path, prefix);
    for (int i = 0; i < hf_n_list && n < 128; i++)
        if (child_of(hf_list_table[i].path, prefix)) names[n++] = child_of(hf_list_table[i].path, prefix);
    for (int i = 0; row && i < row->n_field && n < 128; i++)
        names[n++] = row->field[i].path;
    return hf_text_nearest(key, names, n);
}

/* Returns the path of a key with this name in any section, or NULL. */
static const char *key_elsewhere(const char *key)
{
    for (int i = 0; i < hf_n_field; i++) {
        const char *dot = strrchr(hf_field_table[i].path, '.');
        if (dot && !strcmp(dot + 1, key)) return hf_field_table[i].path;
    }
    return NULL;
}

static void complain_unknown(loader *l, yaml_mark_t mark, const char *prefix, const char *key)
{
    const char *near = nearest_key(prefix, key), *meant = hf_config_suggestion(prefix, key);
    char detail[2 * HF_KEY_SIZE] = "", meant_path[HF_KEY_SIZE];
    if (!*prefix && !strcmp(key, "base")) {
        l->is_study = true;
        snprintf(detail, sizeof detail, "; a file with a base is a study, for 'hifdm sweep'");
    } else if (*key && !key[strspn(key, "0123456789")]) {
        snprintf(detail, sizeof detail, "; is it behind a decimal comma? Numbers have points");
    } else if (meant) {
        snprintf(detail, sizeof detail, "; did you mean %s%s", meant, strchr(meant, '?') ? "" : "?");
    } else if (near) {
        snprintf(detail, sizeof detail, "; did you mean '%s'?", near);
    } else if (key_elsewhere(key)) {
        snprintf(detail, sizeof detail, "; did you mean '%s'?", key_elsewhere(key));
    }
    complain(l, mark, key, "unknown key", *detail ? detail : " (hifdm schema lists all keys)");
    snprintf(meant_path, sizeof meant_path, "%s%s%s", prefix, *prefix && near ? "." : "", near ? near : "");
    note_faults(l, *meant_path ? meant_path : key_elsewhere(key) ? key_elsewhere(key) : key);
}

/* Reports a --set path in a list that is no key of a row: the row number is wrong, or it is a whole row. Returns false
 * and reports nothing if the path is in no list, or if its row exists and only the key is misspelt. */
static bool complain_of_row(loader *l, yaml_mark_t mark, const char *path)
{
    char what[128];
    hf_key of;
    for (const hf_list *list = hf_list_table; list < hf_list_table + hf_n_list; list++) {
        size_t n = strlen(list->path);
        const char *dot = strrchr(path, '.');
        char row[HF_KEY_SIZE];
        if (strncmp(path, list->path, n) != 0 || path[n] != '.') continue;
        snprintf(row, sizeof row, "%.*s", (int)(dot - path), path);
        if (hf_key_find(row, &of) && !of.field) return false; /* only the key is misspelt */
        snprintf(what, sizeof what, "is no key of a row, which is %s.N.KEY with N from 0 to %d", list->path,
                 list->max_row - 1);
        complain(l, mark, path, what, "");
        return true;
    }
    return false;
}

/* ---- setting one value ---- */

static void set_location(loader *l, const yaml_node_t *node, int i_location)
{
    char *where = hf_config_where(&l->faults, i_location);
    if (l->faults.is_override)
        snprintf(where, HF_CONFIG_WHERE_SIZE, "--set");
    else
        snprintf(where, HF_CONFIG_WHERE_SIZE, "%zu:%zu", node->start_mark.line + 1, node->start_mark.column + 1);
}

static void with_document(loader *l, const char *text, size_t length,
                          void (*use)(loader *, const yaml_node_t *, const void *), const void *context);
static void use_default(loader *l, const yaml_node_t *root, const void *context);

/* Reports a key that the file sets twice, once by its old name. */
static bool is_given_already(loader *l, const yaml_node_t *node, const hf_key *key)
{
    const char *where = hf_config_where(&l->faults, key->i_location);
    if (!*where || l->faults.is_override) return false;
    complain(l, node->start_mark, key->path, "is set twice: remove one, here or at ", where);
    return true;
}

static void set_value(loader *l, const yaml_node_t *node, const hf_key *key)
{
    hf_field field = *key->field;
    field.path = key->path;
    hf_config_value(&l->faults, l->document, node, &field, l->c->path, (char *)l->c + key->offset);
}

/* Sets a key to the value of a node, or to the word that replaces it. */
static void set_key(loader *l, const yaml_node_t *node, const hf_key *key, const char *word)
{
    if (key->list && l->walked && key->row >= hf_key_n_row(l->c, key->list)) {
        char what[128];
        snprintf(what, sizeof what, "there is no such row: %s has %d, numbered from 0", key->list->path,
                 hf_key_n_row(l->c, key->list));
        complain(l, node->start_mark, key->path, what, "");
        return;
    }
    if (is_given_already(l, node, key)) return;
    set_location(l, node, key->i_location);
    if (word)
        with_document(l, word, strlen(word), use_default, key);
    else
        set_value(l, node, key);
}

/* ---- walking the YAML tree ---- */

static void walk(loader *l, const yaml_node_t *mapping, const char *prefix);

/* Sets all keys of a row to their defaults. */
static void clear_row(loader *l, const hf_list *list, int row)
{
    for (int i = 0; i < list->n_field; i++) {
        const hf_key key = hf_key_of_row(list, row, i);
        const char *text = key.field->default_value;
        hf_config_no_value(key.field, (char *)l->c + key.offset);
        if (text && *text) with_document(l, text, strlen(text), use_default, &key);
        *hf_config_where(&l->faults, key.i_location) = '\0';
    }
}

static void read_rows(loader *l, const yaml_node_t *node, const hf_list *list)
{
    int *n_row = (int *)(void *)((char *)l->c + list->count_offset);
    hf_key first = hf_key_of_row(list, 0, -1);
    char what[64];
    snprintf(first.path, sizeof first.path, "%s", list->path);
    if (is_given_already(l, node, &first)) return;
    set_location(l, node, first.i_location); /* that of its first row, if it has rows */
    *n_row = 0;
    if (node->type != YAML_SEQUENCE_NODE) {
        complain(l, node->start_mark, list->path, "must be a list of rows, each a line '- {key: value, ...}'", "");
        return;
    }
    for (const int *item = node->data.sequence.items.start; item < node->data.sequence.items.top; item++) {
        const yaml_node_t *row = yaml_document_get_node(l->document, *item);
        if (*n_row == list->max_row) {
            snprintf(what, sizeof what, "there are more than %d rows", list->max_row);
            complain(l, row->start_mark, list->path, what, "");
            return;
        }
        const hf_key key = hf_key_of_row(list, (*n_row)++, -1);
        memset((char *)l->c + key.offset, 0, list->row_size);
        clear_row(l, list, key.row);
        *hf_config_where(&l->faults, key.i_location) = '\0';
        if (row->type != YAML_MAPPING_NODE) {
            complain(l, row->start_mark, key.path, "must be a row {key: value, ...}", "");
            note_faults(l, key.path);
        } else {
            set_location(l, row, key.i_location);
            walk(l, row, key.path);
        }
    }
}

static void take(loader *l, const yaml_node_t *value, yaml_mark_t key_mark, const char *prefix, const char *key)
{
    char given[HF_KEY_SIZE], old[2 * HF_KEY_SIZE], path[HF_KEY_SIZE], *word = NULL;
    yaml_mark_t mark = value->start_mark;
    hf_key found;
    bool fits = snprintf(given, sizeof given, "%s%s%s", prefix, *prefix ? "." : "", key) < HF_KEY_SIZE;
    if (value->type == YAML_SCALAR_NODE) snprintf(old, sizeof old, "%s=%s", given, hf_config_text(value));
    if (value->type == YAML_SCALAR_NODE && hf_config_rename(&l->faults, mark.line, mark.column, old, path)) {
        word = strchr(path, '=');
        *word++ = '\0';
    } else {
        hf_config_rename(&l->faults, key_mark.line, key_mark.column, given, path);
    }
    const hf_list *list = fits ? hf_key_find_list(path) : NULL;
    if (fits && hf_key_find(path, &found) && found.field) {
        set_key(l, value, &found, word);
    } else if (list) {
        read_rows(l, value, list);
    } else if (!strcmp(path, "sweep") && !l->faults.is_override) {
        l->c->has_sweep = true;
        l->cut[0] = key_mark;
        l->cut[1] = value->end_mark;
    } else if (!fits || !find_section(path)) {
        if (!fits || !complain_of_row(l, key_mark, path)) complain_unknown(l, key_mark, prefix, key);
    } else if (value->type != YAML_MAPPING_NODE) {
        complain(l, key_mark, path, "must be a section of key: value lines", " ({} takes every default)");
    } else {
        walk(l, value, path);
    }
    note_faults(l, path);
}

static void walk(loader *l, const yaml_node_t *mapping, const char *prefix)
{
    note_section(l, prefix);
    for (yaml_node_pair_t *p = mapping->data.mapping.pairs.start; p < mapping->data.mapping.pairs.top; p++) {
        const yaml_node_t *key = yaml_document_get_node(l->document, p->key);
        const yaml_node_t *value = yaml_document_get_node(l->document, p->value);
        if (key->type != YAML_SCALAR_NODE) {
            complain(l, key->start_mark, *prefix ? prefix : "case", "a key must be a plain word", "");
            note_faults(l, prefix);
            continue;
        }
        const char *word = hf_config_text(key);
        const yaml_node_t *earlier = hf_config_earlier_key(l->document, mapping, p);
        if (earlier) {
            char line[48];
            snprintf(line, sizeof line, "%zu", earlier->start_mark.line + 1);
            complain(l, key->start_mark, word, "this key stands here already, on line ", line);
            note_faults(l, prefix);
        } else {
            take(l, value, key->start_mark, prefix, word);
        }
    }
}

/* Returns the location where the parser stopped. For a byte that is not UTF-8 the parser gives only an offset. */
static yaml_mark_t problem_mark(const yaml_parser_t *parser, const char *text)
{
    yaml_mark_t mark = parser->problem_mark;
    if (parser->error != YAML_READER_ERROR) return mark;
    mark.line = mark.column = 0;
    for (size_t i = 0; i < parser->problem_offset && text[i]; i++) {
        mark.column++;
        if (text[i] != '\n') continue;
        mark.line++;
        mark.column = 0;
    }
    return mark;
}

/* Returns true if there is a tab among the leading blanks of the line, or at the location itself. */
static bool has_tab_at(const char *text, yaml_mark_t at)
{
    for (size_t line = 0; line < at.line && text; line++)
        text = strchr(text, '\n') ? strchr(text, '\n') + 1 : NULL;
    if (!text) return false;
    size_t blanks = strspn(text, " \t"), n = strcspn(text, "\n");
    return memchr(text, '\t', blanks) || (at.column < n && text[at.column] == '\t');
}

/* Reports the problem of a parser. A parser without a problem text is out of memory; `error` does not
 * always show it. */
static void complain_of_yaml(loader *l, const yaml_parser_t *parser, const char *text)
{
    yaml_mark_t at = problem_mark(parser, text);
    if (parser->problem && has_tab_at(text, at))
        complain(l, at, "YAML", "a tab: lines are set in by blanks, and no tab stands before a value", "");
    else if (parser->problem)
        complain(l, problem_mark(parser, text), "YAML", parser->problem, "");
    else
        l->no_memory = true;
}

/* Parses `text` as one YAML document and calls `use` with its root. */
static void with_document(loader *l, const char *text, size_t length,
                          void (*use)(loader *, const yaml_node_t *, const void *), const void *context)
{
    yaml_document_t *outer = l->document; /* the outer document, while the defaults of its rows are read */
    yaml_parser_t parser;
    yaml_document_t document, next;
    if (!yaml_parser_initialize(&parser)) {
        l->no_memory = true;
        return;
    }
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);
    if (!yaml_parser_load(&parser, &document)) {
        complain_of_yaml(l, &parser, text);
    } else {
        l->document = &document;
        use(l, yaml_document_get_root_node(&document), context);
        yaml_document_delete(&document);
        if (!yaml_parser_load(&parser, &next)) {
            complain_of_yaml(l, &parser, text);
        } else {
            if (yaml_document_get_root_node(&next))
                complain(l, next.start_mark, "YAML", "a second document in this file", "; one case per file");
            yaml_document_delete(&next);
        }
    }
    l->document = outer;
    yaml_parser_delete(&parser);
}

/* Returns true if the file has a key of a case, or no key at all. Otherwise it is another file. Messages must not quote
 * its keys, because they may be secret. */
static bool has_key_of_case(loader *l, const yaml_node_t *root)
{
    yaml_node_pair_t *p = root->data.mapping.pairs.start, *end = root->data.mapping.pairs.top;
    bool is_empty = p == end;
    for (; p < end; p++) {
        const yaml_node_t *key = yaml_document_get_node(l->document, p->key);
        const char *word = hf_config_text(key);
        if (!strcmp(word, "sweep") || !strcmp(word, "base")) return true;
        if (hf_config_suggestion("", word) || nearest_key("", word) || key_elsewhere(word)) return true;
    }
    return is_empty;
}

static void use_root(loader *l, const yaml_node_t *root, const void *context)
{
    (void)context;
    yaml_mark_t start = {0};
    if (!root)
        complain(l, start, "case", "the file is empty", "");
    else if (root->type != YAML_MAPPING_NODE)
        complain(l, root->start_mark, "case", "must be key: value lines", "");
    else if (!has_key_of_case(l, root))
        complain(l, root->start_mark, "case", "no key in this file is one of a case", " (hifdm schema lists all keys)");
    else {
        walk(l, root, "");
        l->walked = true;
    }
}

static void use_default(loader *l, const yaml_node_t *root, const void *context)
{
    yaml_mark_t start = {0};
    const hf_key *key = context;
    if (root)
        set_value(l, root, key);
    else
        complain(l, start, key->path, "has no value", "");
}

/* ---- overrides ---- */

static void use_override(loader *l, const yaml_node_t *root, const void *context)
{
    char path[HF_KEY_SIZE];
    yaml_mark_t start = {0};
    snprintf(path, sizeof path, "%s", (const char *)context);
    char *dot = strrchr(path, '.');
    if (!root) {
        complain(l, start, path, "there is no value after the '='", "");
        return;
    }
    if (dot) *dot = '\0';
    take(l, root, start, dot ? path : "", dot ? dot + 1 : path);
    if (dot) note_section(l, path); /* a key inside a section makes the section present */
}

static void apply_override(loader *l, const char *argument)
{
    char path[HF_KEY_SIZE];
    const char *equals = strchr(argument, '=');
    const char *fault = NULL;
    if (!equals || equals == argument || equals - argument >= HF_KEY_SIZE)
        fault = "must be key=value, like form.pretension_N=12";
    else if (strchr(argument, '\n')) /* a result stores one override per line */
        fault = "must be on one line";
    if (fault) {
        l->faults.failed = true;
        hf_config_note_unread(&l->faults, "");
        hf_error(l->faults.messages, HF_BAD_CASE, "--set %s: %s", argument, fault);
        return;
    }
    snprintf(path, sizeof path, "%.*s", (int)(equals - argument), argument);
    l->faults.origin = argument;
    l->faults.is_override = true;
    with_document(l, equals + 1, strlen(equals + 1), use_override, path);
    note_faults(l, path);
    l->faults.is_override = false;
    l->faults.origin = l->c->path;
}

/* Returns the start of the next line. YAML 1.1 breaks lines at CR LF, CR, LF, NEL, LS and PS. */
static char *after_line(char *text)
{
    for (; *text; text++) {
        const unsigned char *c = (const unsigned char *)text;
        if (c[0] == '\r') return text + (c[1] == '\n' ? 2 : 1);
        if (c[0] == '\n') return text + 1;
        if (c[0] == 0xC2 && c[1] == 0x85) return text + 2;
        if (c[0] == 0xE2 && c[1] == 0x80 && (c[2] == 0xA8 || c[2] == 0xA9)) return text + 3;
    }
    return text;
}

/* Removes the lines of the sweep section from the text. The rest is the case of one point; it is stored and digested.
 * It does not change when the sweep gets more points. */
static void cut_sweep(loader *l)
{
    hf_case *c = l->c;
    size_t line = 0, last = l->cut[1].line + (l->cut[1].column > 0);
    char *from = c->text, *to;
    if (!c->has_sweep) return;
    if (l->cut[0].column > 0) {
        complain(l, l->cut[0], "sweep", "must stand on lines of its own", "");
        return;
    }
    for (; line < l->cut[0].line && *from; line++)
        from = after_line(from);
    for (to = from; line < last && *to; line++)
        to = after_line(to);
    memmove(from, to, strlen(to) + 1);
    c->text_length -= (size_t)(to - from);
}

/* Joins the overrides to one text, and digests case text and overrides. Returns HF_OK or HF_NO_MEMORY. */
static hf_status seal(hf_case *c, const char *const *overrides, int n_override)
{
    size_t size = 1;
    for (int i = 0; i < n_override; i++)
        size += strlen(overrides[i]) + 1;
    c->overrides = calloc(size, 1);
    char *all = malloc(c->text_length + size);
    if (!c->overrides || !all) {
        free(all);
        return HF_NO_MEMORY;
    }
    for (int i = 0; i < n_override; i++) {
        strcat(c->overrides, overrides[i]);
        strcat(c->overrides, "\n");
    }
    memcpy(all, c->text, c->text_length);
    memcpy(all + c->text_length, c->overrides, size - 1);
    hf_sha256(all, c->text_length + size - 1, c->sha256);
    free(all);
    return HF_OK;
}

/* ---- load ---- */

/* Sets all other members of `settings` from settings->text and the overrides. */
static hf_status parse(hf_case *settings, const char *const *overrides, int n_override, hf_messages *messages)
{
    const char *path = settings->path;
    if (settings->text_length > 4 && !memcmp(settings->text, "\x89HDF", 4))
        return hf_error(
            messages, HF_BAD_CASE,
            "%s: this file is an HDF5 file, not a case file. For a result file, use hifdm show, report or export",
            path);
    if (settings->text_length > CASE_MAX)
        return hf_error(messages, HF_BAD_CASE, "%s: this file is larger than %d kB, so it is not a case file", path,
                        CASE_MAX >> 10);
    if (hf_text_too_deep(settings->text))
        return hf_error(messages, HF_BAD_CASE, "%s:%d:1: the YAML text has more than %d nested brackets", path,
                        hf_text_too_deep(settings->text), HF_TEXT_NESTING_MAX);
    loader l = {.c = settings, .faults = {.messages = messages, .path = path, .origin = path}};
    l.faults.where_given = settings->where_given =
        calloc((size_t)hf_key_n_location() * HF_CONFIG_WHERE_SIZE + HF_CONFIG_FAULTY_SIZE, 1);
    if (!l.faults.where_given) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    hf_key key;
    for (int i = 0; i < hf_n_field; i++) {
        const char *text = hf_field_table[i].default_value;
        if (text && *text && hf_key_find(hf_field_table[i].path, &key))
            with_document(&l, text, strlen(text), use_default, &key);
    }
    with_document(&l, settings->text, settings->text_length, use_root, NULL);
    for (int i = 0; i < n_override; i++)
        apply_override(&l, overrides[i]);
    if (l.walked && !l.is_study && !l.no_memory) {
        hf_config_rename_require(settings, &l.faults);
        hf_config_check(settings, &l.faults);
    } else {
        hf_config_note_unread(&l.faults, "");
    }
    hf_config_complete(settings);
    cut_sweep(&l);
    hf_status sealed = seal(settings, overrides, n_override);
    if (l.no_memory) sealed = HF_NO_MEMORY;
    if (sealed != HF_OK) return hf_error(messages, sealed, "%s: out of memory", path);
    if (l.faults.n > HF_FAULT_MAX_CASE)
        hf_error(messages, HF_BAD_CASE, "%s: hifdm found %d more faults in this file", path,
                 l.faults.n - HF_FAULT_MAX_CASE);
    return l.faults.failed ? HF_BAD_CASE : HF_OK;
}

hf_status hf_config_load(const char *path, const char *const *overrides, int n_override, hf_case *settings,
                         hf_messages *messages)
{
    *settings = (hf_case){0};
    if (snprintf(settings->path, sizeof settings->path, "%s", path) >= HF_PATH_SIZE)
        return hf_error(messages, HF_BAD_CASE, "%s: the path is too long", path);
    HF_TRY(hf_text_read_file(path, HF_BAD_CASE, &settings->text, &settings->text_length, messages));
    return parse(settings, overrides, n_override, messages);
}

hf_status hf_config_parse(const char *path, const char *text, const char *const *overrides, int n_override,
                          hf_case *settings, hf_messages *messages)
{
    *settings = (hf_case){0};
    snprintf(settings->path, sizeof settings->path, "%s", path);
    settings->text = strdup(text);
    if (!settings->text) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    settings->text_length = strlen(text);
    return parse(settings, overrides, n_override, messages);
}

hf_status hf_config_check_value(const char *path, const char *value, const char *location, hf_messages *messages)
{
    hf_key key;
    if (!hf_key_find(path, &key) || !key.field)
        return hf_error(messages, HF_BAD_CASE, "%s: %s: unknown key", location, path);
    hf_case *scratch = calloc(1, sizeof *scratch);
    loader l = {.c = scratch, .faults = {.messages = messages, .origin = location, .location = location}};
    if (scratch)
        with_document(&l, value, strlen(value), use_default, &key);
    else
        l.no_memory = true;
    hf_status status = l.faults.failed ? HF_BAD_CASE : HF_OK;
    if (l.no_memory) status = hf_error(messages, HF_NO_MEMORY, "%s: out of memory", location);
    free(scratch);
    return status;
}

void hf_case_free(hf_case *settings)
{
    free(settings->text);
    free(settings->overrides);
    free(settings->where_given);
    *settings = (hf_case){0};
}
