/* Contents: faults - words and whole numbers - numbers - texts - all types */
#include "case/config_value.h"

#include "base/path.h"
#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef struct {
    hf_config_faults *faults;
    yaml_document_t *document;
    const char *case_path;
} setter;

static void refuse(setter *s, const yaml_node_t *node, const hf_field *f, const char *what, const char *detail)
{
    hf_config_fault_at(s->faults, node->start_mark.line, node->start_mark.column, f->path, what, detail);
}

/* Returns the number of items of a list, or -1 if the node is no list. */
static long n_item(const yaml_node_t *node)
{
    if (node->type != YAML_SEQUENCE_NODE) return -1;
    return node->data.sequence.items.top - node->data.sequence.items.start;
}

static const yaml_node_t *item_of(setter *s, const yaml_node_t *list, int i)
{
    return yaml_document_get_node(s->document, list->data.sequence.items.start[i]);
}

static bool is_plain(const yaml_node_t *node)
{
    return node->type == YAML_SCALAR_NODE && node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
}

const yaml_node_t *hf_config_earlier_key(yaml_document_t *document, const yaml_node_t *mapping,
                                         const yaml_node_pair_t *pair)
{
    const yaml_node_t *key = yaml_document_get_node(document, pair->key);
    for (const yaml_node_pair_t *p = mapping->data.mapping.pairs.start; p < pair; p++) {
        const yaml_node_t *earlier = yaml_document_get_node(document, p->key);
        if (earlier->type == key->type && !strcmp(hf_config_text(earlier), hf_config_text(key))) return earlier;
    }
    return NULL;
}

void hf_config_range_words(const hf_field *f, char words[HF_CONFIG_RANGE_SIZE])
{
    char low[48];
    if (f->min == HF_ABOVE_ZERO)
        snprintf(low, sizeof low, "must be above 0");
    else
        snprintf(low, sizeof low, "must be at least %.10g", f->min);
    if (f->max >= 1e300)
        snprintf(words, HF_CONFIG_RANGE_SIZE, "%s, not ", low);
    else
        snprintf(words, HF_CONFIG_RANGE_SIZE, "%s and at most %.10g, not ", low, f->max);
}

static void refuse_range(setter *s, const yaml_node_t *node, const hf_field *f)
{
    char what[HF_CONFIG_RANGE_SIZE];
    hf_config_range_words(f, what);
    refuse(s, node, f, what, hf_config_text(node));
}

bool hf_config_is_in_range(const hf_field *f, const char *text)
{
    uint64_t whole;
    double value;
    if (f->type == HF_FIELD_DOUBLE || f->type == HF_FIELD_AMOUNT)
        return hf_text_double(text, &value) && value >= f->min && value <= f->max;
    bool is_whole = f->type == HF_FIELD_INT || f->type == HF_FIELD_UINT64;
    return is_whole && hf_text_uint64(text, &whole) && (double)whole >= f->min && (double)whole <= f->max;
}

/* Every member of hf_case that an HF_FIELD_WORD sets has an enumeration type with the size of int. Its values are not
 * negative, so the int with the same bytes has the same value. */
_Static_assert(sizeof(hf_method) == sizeof(int) && sizeof(hf_diagonals) == sizeof(int), "enumerations are int-sized");

static void set_word(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    char what[256] = "must be one of", given[512], hint[HF_TEXT_HINT_SIZE];
    int n = 0;
    if (node->type == YAML_SCALAR_NODE)
        for (int k = 0; f->words[k]; k++)
            if (!strcmp(f->words[k], hf_config_text(node))) {
                memcpy(to, &k, sizeof k);
                return;
            }
    for (; f->words[n]; n++) {
        strcat(what, " ");
        strcat(what, f->words[n]);
    }
    strcat(what, ", not ");
    if (node->type == YAML_SCALAR_NODE) {
        hf_text_hint(hf_config_text(node), f->words, n, hint);
        snprintf(given, sizeof given, "%.300s%s", hf_config_text(node), hint);
    }
    refuse(s, node, f, what, node->type == YAML_SCALAR_NODE ? given : "a list or section");
}

static void set_uint64(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    if (!is_plain(node) || !hf_text_uint64(hf_config_text(node), to))
        refuse(s, node, f, "must be a whole number from 0 to 18446744073709551615", "");
}

static void set_int(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    uint64_t value = 0;
    double real = 0;
    if (!is_plain(node))
        refuse(s, node, f, "must be a whole number", "");
    else if (!hf_text_uint64(hf_config_text(node), &value) && !hf_text_double(hf_config_text(node), &real))
        refuse(s, node, f, "must be a whole number, not ", hf_config_text(node));
    else if (strpbrk(hf_config_text(node), ".eE"))
        refuse(s, node, f, "must be a whole number, not ", hf_config_text(node));
    else if (hf_config_text(node)[0] == '-' || (double)value < f->min || (double)value > f->max)
        refuse_range(s, node, f);
    else
        *(int *)to = (int)value;
}

static void set_pair(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    if (n_item(node) != 2) {
        refuse(s, node, f, "must be a list of two whole numbers, like [5, 5]", "");
        return;
    }
    for (int k = 0; k < 2; k++)
        set_int(s, item_of(s, node, k), f, (int *)to + k);
}

/* Returns true for a number with a unit, such as "10 N". Letters of an exponent or of digits in another base
 * are no unit. */
static bool has_unit(const char *text)
{
    char number[64];
    double value;
    size_t n = strspn(text, "+-.0123456789"), blanks = strspn(text + n, " ");
    const char *unit = text + n + blanks;
    snprintf(number, sizeof number, "%.*s", (int)n, text);
    return n < sizeof number && hf_text_double(number, &value) && isalpha((unsigned char)*unit) &&
           !isdigit((unsigned char)unit[1]);
}

/* Returns true for ".inf", "nan", or a number too large for a double. */
static bool is_not_finite(const char *text)
{
    double value = 0;
    const char *word = text + strspn(text, "+-");
    if (*word == '.') word++;
    if (!strcasecmp(word, "inf") || !strcasecmp(word, "nan")) return true;
    return !hf_text_double(text, &value) && isinf(value);
}

static void refuse_number(setter *s, const yaml_node_t *node, const hf_field *f)
{
    if (node->type != YAML_SCALAR_NODE)
        refuse(s, node, f, "must be a number", "");
    else if (is_not_finite(hf_config_text(node)))
        refuse(s, node, f, "must be a finite number, not ", hf_config_text(node));
    else
        refuse(s, node, f, "must be a number, not a text",
               *f->unit && has_unit(hf_config_text(node)) ? "; the unit is in the key's name" : "");
}

static void set_double(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    double value;
    if (is_plain(node) && hf_text_has_decimal_comma(hf_config_text(node)))
        refuse(s, node, f, "has a decimal comma, and numbers have points: ", hf_config_text(node));
    else if (!is_plain(node) || !hf_text_double(hf_config_text(node), &value))
        refuse_number(s, node, f);
    else if (value < f->min || value > f->max)
        refuse_range(s, node, f);
    else
        memcpy(to, &value, sizeof value);
}

/* Sets a list of numbers from a list or from one number. */
static void set_list(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    hf_double_list *list = to;
    long n = node->type == YAML_SEQUENCE_NODE ? n_item(node) : 1;
    list->n = 0;
    if (node->type == YAML_MAPPING_NODE || n > HF_LIST_MAX) {
        refuse(s, node, f, "must be a list of at most 32 numbers, like [1, 2.5]", "");
    } else if (node->type != YAML_SEQUENCE_NODE) {
        set_double(s, node, f, &list->value[list->n++]);
    } else {
        for (; list->n < n; list->n++)
            set_double(s, item_of(s, node, list->n), f, &list->value[list->n]);
    }
}

/* Writes the number of a text such as "30 %" or "30%". Returns false if the text does not end with "%". */
static bool is_percentage(const char *text, char number[64])
{
    size_t n = strlen(text);
    if (n == 0 || text[n - 1] != '%') return false;
    for (n--; n > 0 && text[n - 1] == ' ';)
        n--;
    snprintf(number, 64, "%.*s", (int)(n < 63 ? n : 0), text);
    return true;
}

static void set_amount(setter *s, const yaml_node_t *node, const hf_field *f, void *amount)
{
    double *to = amount;
    char number[64];
    double value;
    bool is_part = node->type == YAML_SCALAR_NODE && is_percentage(hf_config_text(node), number);
    if (!is_part && !is_plain(node))
        refuse(s, node, f, "must be a number, or a part like 30 %", "");
    else if (!hf_text_double(is_part ? number : hf_config_text(node), &value))
        refuse(s, node, f, "must be a number, or a part like 30 %, not ", hf_config_text(node));
    else if (value < f->min || value > f->max)
        refuse_range(s, node, f);
    else {
        to[is_part] = is_part ? value / 100 : value;
        to[!is_part] = (double)NAN;
    }
}

/* Returns true if the node leaves a bound open. */
static bool is_open(const yaml_node_t *node, bool is_upper)
{
    const char *const word[] = {"null", "~", ".", is_upper ? ".inf" : "-.inf"};
    for (size_t k = 0; is_plain(node) && k < sizeof word / sizeof *word; k++)
        if (!strcmp(hf_config_text(node), word[k])) return true;
    return false;
}

static void set_bounds(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    double bound[2] = {(double)NAN, (double)NAN};
    if (n_item(node) != 2) {
        refuse(s, node, f, "must be two bounds, like [1, 20]", "");
        return;
    }
    for (int k = 0; k < 2; k++) {
        if (is_open(item_of(s, node, k), k == 1))
            bound[k] = k ? (double)INFINITY : -(double)INFINITY;
        else
            set_double(s, item_of(s, node, k), f, &bound[k]);
    }
    if (isnan(bound[0]) || isnan(bound[1])) return;
    if (isinf(bound[0]) && isinf(bound[1]))
        refuse(s, node, f, "leaves both sides open; give one bound at least", "");
    else if (bound[0] >= bound[1])
        refuse(s, node, f, "the lower bound must be below the upper one", "");
    else
        memcpy(to, bound, sizeof bound);
}

static void set_vector(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    double part[3] = {(double)NAN, (double)NAN, (double)NAN};
    if (n_item(node) != 3) {
        refuse(s, node, f, "must be a list of three numbers, along x, y and z, like [0, 0, -1]", "");
        return;
    }
    for (int k = 0; k < 3; k++)
        set_double(s, item_of(s, node, k), f, &part[k]);
    if (!isnan(part[0] + part[1] + part[2])) memcpy(to, part, sizeof part);
}

static void set_text(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    size_t size = (size_t)f->max;
    if (node->type != YAML_SCALAR_NODE || (f->min > 0 && !*hf_config_text(node))) {
        refuse(s, node, f, "must be a text", "");
        return;
    }
    /* Paths in a case file are relative to that file, paths on the command line to the current folder. */
    const char *beside = size == HF_PATH_SIZE && !s->faults->is_override ? s->case_path : "";
    if (!hf_path_beside(beside, hf_config_text(node), to, size)) refuse(s, node, f, "is too long", "");
}

/* Joins the names of a list of sets by +, for hf_cable_pick. */
static void set_sets(setter *s, const yaml_node_t *node, const hf_field *f, void *to)
{
    char *joined = to, what[80];
    const char *last = "", *next;
    if (n_item(node) < 1) {
        set_text(s, node, f, to);
        return;
    }
    *joined = '\0';
    for (int i = 0; i < n_item(node); i++)
        if (item_of(s, node, i)->type != YAML_SCALAR_NODE || !*hf_config_text(item_of(s, node, i))) {
            refuse(s, item_of(s, node, i), f, "must be a list of names, like [front, rear]", "");
            return;
        }
    do {
        next = NULL;
        for (int i = 0; i < n_item(node); i++) {
            const char *name = hf_config_text(item_of(s, node, i));
            if (strcmp(name, last) > 0 && (!next || strcmp(name, next) < 0)) next = name;
        }
        if (next && !hf_text_append(joined, (size_t)f->max, "+", next, "")) {
            snprintf(what, sizeof what, "the names must have at most %d letters together", (int)f->max - 1);
            refuse(s, node, f, what, "");
            return;
        }
        last = next;
    } while (next);
}

void hf_config_value(hf_config_faults *faults, yaml_document_t *document, const yaml_node_t *node, const hf_field *f,
                     const char *case_path, void *to)
{
    static void (*const set[])(setter *, const yaml_node_t *, const hf_field *, void *) = {
        [HF_FIELD_DOUBLE] = set_double, [HF_FIELD_DOUBLE_LIST] = set_list, [HF_FIELD_AMOUNT] = set_amount,
        [HF_FIELD_BOUNDS] = set_bounds, [HF_FIELD_VECTOR] = set_vector,    [HF_FIELD_UINT64] = set_uint64,
        [HF_FIELD_INT] = set_int,       [HF_FIELD_INT_PAIR] = set_pair,    [HF_FIELD_WORD] = set_word,
        [HF_FIELD_TEXT] = set_text,     [HF_FIELD_SET] = set_sets,
    };
    setter s = {faults, document, case_path};
    set[f->type](&s, node, f, to);
}

void hf_config_no_value(const hf_field *field, void *to)
{
    static const int n_nan[] = {[HF_FIELD_DOUBLE] = 1, [HF_FIELD_AMOUNT] = 2, [HF_FIELD_VECTOR] = 3};
    double *number = to;
    for (int k = 0; k < n_nan[field->type]; k++)
        number[k] = (double)NAN;
    if (field->type != HF_FIELD_BOUNDS) return;
    number[0] = -(double)INFINITY;
    number[1] = (double)INFINITY;
}
