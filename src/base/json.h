/* json - JSON on a stream. The writer knows whether a comma is due; the functions for the page of `hifdm report` write
 * compact lists instead. */
#ifndef HIFDM_JSON_H
#define HIFDM_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Begin with {.file = ...}; the rest is the writer's own. */
typedef struct {
    FILE *file;
    bool is_due;      /* a comma, before the next item */
    const char *line; /* the indentation of a new line before the next item; NULL: no new line */
} hf_json;

/* key: NULL for what stands in a list or outermost. bracket: '{' or '[', then '}' or ']'. */
void hf_json_open(hf_json *json, const char *key, char bracket);
void hf_json_close(hf_json *json, char bracket);

/* The next item begins a new line with this indentation, which is borrowed. */
void hf_json_line(hf_json *json, const char *indentation);

void hf_json_text(hf_json *json, const char *key, const char *text);
/* 17 digits; NaN is null, and what is infinite the text "Infinity" or "-Infinity", which float() of Python and Number()
 * of JavaScript read. */
void hf_json_number(hf_json *json, const char *key, double value);
void hf_json_integer(hf_json *json, const char *key, int64_t value);
void hf_json_unsigned(hf_json *json, const char *key, uint64_t value);
void hf_json_bool(hf_json *json, const char *key, bool value);
void hf_json_list(hf_json *json, const char *key, const double *value, int n); /* n numbers as hf_json_value has them */

/* Those lines of `lines` (may be NULL) that start with `prefix`, without it, as a list of texts. */
void hf_json_lines(hf_json *json, const char *key, const char *prefix, const char *lines);

/* How the object of a command ends: its warnings, its errors if it has failed, the brace and a newline. */
void hf_json_end(hf_json *json, bool has_failed, const char *messages);

/* ---- without a writer: compact, for the page ---- */

/* A '<' in a text is written as \u003c, so that an object can stand in the script of an HTML page. A byte that is not
 * UTF-8 is written as \ufffd. */
void hf_json_string(const char *text, FILE *file);
void hf_json_value(double value, int digits, FILE *file); /* null unless finite */

/* ,"key":[...] with the comma in front: n texts; of n numbers every stride-th and the last. */
void hf_json_strings(const char *key, const char *const *text, int n, FILE *file);
void hf_json_values(const char *key, const double *value, int n, int stride, int digits, FILE *file);

/* ,"key":{"f32":"..."} with the comma in front: numbers one after the other as base64 of their bytes, the lowest first.
 * The type is "i32", of whole numbers that an int32_t holds, "f32" or "f64", as in names of the typed arrays of
 * JavaScript and numpy. */
typedef struct {
    FILE *file;
    char type;     /* i or f */
    int n_byte;    /* of a number */
    unsigned bits; /* those that wait to become letters, the lowest n_bit */
    int n_bit;
} hf_json_packed;
hf_json_packed hf_json_pack(const char *key, const char *type, FILE *file);
void hf_json_pack_value(hf_json_packed *packed, double value);
void hf_json_pack_end(hf_json_packed *packed);
void hf_json_pack_values(const char *key, const char *type, const double *value, int n, FILE *file); /* all of it */

#endif
