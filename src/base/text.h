/* text - reading files and strict, locale-independent numbers; shared by the case file and the CSV import. */
#ifndef HIFDM_TEXT_H
#define HIFDM_TEXT_H

#include <hifdm/status.h>
#include <stdint.h>

/* Whole file as a NUL-terminated string (caller frees). `code` is the status given when it cannot be read. */
hf_status hf_text_read_file(const char *path, hf_status code, char **text, size_t *length, hf_messages *messages);

/* The whole string must be one decimal number; 1 when it is, 0 otherwise. hf_text_double takes no nan, no inf and no
 * hexadecimal, and refuses what overflows. */
int hf_text_double(const char *text, double *value);
int hf_text_uint64(const char *text, uint64_t *value);

/* Well-formed UTF-8 without control characters other than tab? Results keep ids and titles as UTF-8. */
int hf_text_is_utf8(const char *text);

/* snprintf may have cut a text in the middle of a letter: take the rest of that letter away. */
void hf_text_trim_utf8(char *text);

/* The first line of a YAML text with more than HF_TEXT_NESTING_MAX brackets open at once, quoted ones included, or 0:
 * libyaml takes minutes over thousands. */
#define HF_TEXT_NESTING_MAX 100
int hf_text_too_deep(const char *text);

/* The candidate nearest to `word` by edit distance, or NULL when none is near enough to be a typing error. */
const char *hf_text_nearest(const char *word, const char *const *candidates, int n_candidate);

#endif
