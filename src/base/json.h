/* json - writes JSON to a stream. The writer hf_json puts commas where they are needed. The functions for the page of
 * `hifdm report` write compact lists. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* A writer. The caller sets {.file = ...}; the other members are internal. */
typedef struct {
    FILE *file;
    bool is_due;      /* the next item needs a comma before it */
    const char *line; /* indentation of a new line before the next item; NULL: no new line */
} hf_json;

typedef struct {
    const char *key;
    double value;
} hf_json_pair;

/* Begin and end an object or a list. `key` is NULL for an item of a list and for the outermost object. `bracket` is '{'
 * or '[' to open, '}' or ']' to close. */
void hf_json_open(hf_json *json, const char *key, char bracket);
void hf_json_close(hf_json *json, char bracket);

/* Begins a new line before the next item, with this indentation. The text is borrowed. */
void hf_json_line(hf_json *json, const char *indentation);
/* Begins an object or a list on a new line. */
void hf_json_open_line(hf_json *json, const char *indentation, const char *key, char bracket);

/* hf_json_open_rows begins a list on a line of its own, whose items are objects on lines of their own;
 * hf_json_open_row begins one of these. */
void hf_json_open_rows(hf_json *json, const char *key);
void hf_json_open_row(hf_json *json);

void hf_json_text(hf_json *json, const char *key, const char *text);
/* Writes 17 significant digits. NaN becomes null. Infinite values become the texts "Infinity" and "-Infinity", which
 * float() in Python and Number() in JavaScript can read. */
void hf_json_number(hf_json *json, const char *key, double value);
/* Writes numbers by hf_json_number: HF_JSON_NUMBERS(json, {key, value}, {key, value}). Whole numbers up to 2^53 are
 * written as by hf_json_integer. */
#define HF_JSON_NUMBERS(json, ...) hf_json_numbers(json, (const hf_json_pair[]){__VA_ARGS__, {NULL, 0}})
void hf_json_numbers(hf_json *json, const hf_json_pair *pair);
void hf_json_integer(hf_json *json, const char *key, int64_t value);
void hf_json_unsigned(hf_json *json, const char *key, uint64_t value);
void hf_json_bool(hf_json *json, const char *key, bool value);
void hf_json_list(hf_json *json, const char *key, const double *value, int n); /* n numbers as by hf_json_number */

/* Writes a list of texts: the lines of `lines` that start with `prefix`, without this prefix. `lines` may be NULL. */
void hf_json_lines(hf_json *json, const char *key, const char *prefix, const char *lines);

/* Ends the JSON object of a command: its warnings, its errors if it has failed, the brace and a newline. */
void hf_json_end(hf_json *json, bool has_failed, const char *messages);

/* ---- compact lists without a writer, for the page ---- */

/* Writes a text in quotes. A '<' becomes \u003c, so that the text can be part of a script in an HTML page. A byte that
 * is not UTF-8 becomes \ufffd. */
void hf_json_string(const char *text, FILE *file);
void hf_json_value(double value, int digits, FILE *file); /* NaN: null; infinite: "Infinity" or "-Infinity" */

/* Write ,"key":[...] with the comma in front. hf_json_strings writes n texts. hf_json_values writes every stride-th of
 * n numbers, and always the last one. */
void hf_json_strings(const char *key, const char *const *text, int n, FILE *file);
void hf_json_values(const char *key, const double *value, int n, int stride, int digits, FILE *file);

/* Writes ,"key":{"f32":"..."} with the comma in front. The text is the base64 form of the bytes of all numbers, lowest
 * byte first. The type is "i32" (whole numbers in the range of int32_t), "f32" or "f64", similar to the names of typed
 * arrays in JavaScript and numpy. */
typedef struct {
    FILE *file;
    char type;     /* 'i' or 'f' */
    int n_byte;    /* bytes of a number */
    unsigned bits; /* the lowest n_bit bits are not yet written */
    int n_bit;
} hf_json_packed;
hf_json_packed hf_json_pack(const char *key, const char *type, FILE *file);
void hf_json_pack_value(hf_json_packed *packed, double value);
void hf_json_pack_end(hf_json_packed *packed);
void hf_json_pack_values(const char *key, const char *type, const double *value, int n, FILE *file); /* all steps */
