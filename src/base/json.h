/* json - the pieces of a JSON object on a stream: "key": value, without commas between them. */
#ifndef HIFDM_JSON_H
#define HIFDM_JSON_H

#include <stdio.h>

/* A '<' in a text is written as \u003c, so that an object can stand in the script of an HTML page. */
void hf_json_string(const char *text, FILE *file);        /* without a key */
void hf_json_value(double value, int digits, FILE *file); /* without a key; null unless finite */
void hf_json_text(const char *key, const char *text, FILE *file);
void hf_json_number(const char *key, double value, FILE *file); /* null unless finite */

/* ,"key":[...] with the comma in front: n texts; of n numbers every stride-th and the last. */
void hf_json_strings(const char *key, const char *const *text, int n, FILE *file);
void hf_json_values(const char *key, const double *value, int n, int stride, int digits, FILE *file);

/* Those lines of `lines` (may be NULL) that start with `prefix`, without it, as a list of strings. */
void hf_json_lines(const char *key, const char *prefix, const char *lines, FILE *file);

#endif
