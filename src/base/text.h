/* text - files read whole, strict numbers that no locale changes, UTF-8, what people may be shown of foreign texts, and
 * the nearest word to a misspelt one. */
#ifndef HIFDM_TEXT_H
#define HIFDM_TEXT_H

#include <hifdm/status.h>
#include <stdbool.h>
#include <stdint.h>

/* How many faults of what the user wrote are spelled out; a last message counts the rest. */
enum {
    HF_FAULT_MAX = 20,       /* of one kind: in a table, a net or a truss */
    HF_FAULT_MAX_CASE = 100, /* of a case file */
    HF_FAULT_MAX_POINT = 10  /* points of a sweep, each with all its faults */
};

/* The whole file as a NUL-terminated string that the caller frees. HF_OK; `code` when there is no such file, when it is
 * a folder, a pipe, a device or a socket, or longer than 1 GiB; HF_IO or HF_NO_MEMORY when the machine cannot read it
 * now. */
hf_status hf_text_read_file(const char *path, hf_status code, char **text, size_t *length, hf_messages *messages);

/* True when the whole string is one decimal number, without sign for hf_text_uint64. nan, inf, hexadecimal numbers and
 * numbers that overflow are refused. */
bool hf_text_double(const char *text, double *value);

/* The same times 10^decimals, as the double nearest to that decimal number: 1234.5 and -3 is 1.2345. */
bool hf_text_decimal(const char *text, int decimals, double *value);
bool hf_text_uint64(const char *text, uint64_t *value);

/* Is the text well-formed UTF-8 without control characters other than tab? Results keep ids and titles as UTF-8. */
bool hf_text_is_utf8(const char *text);

/* Bytes of the UTF-8 character at `text`, whose code point is set; 0 when there is none: a stray byte, an overlong
 * form, a surrogate, beyond U+10FFFF. The final NUL is a character of one byte. */
int hf_text_character(const char *text, uint32_t *code);

/* Is it a character that commands a terminal or reorders a line instead of showing something? Control characters (C0,
 * DEL, C1), line and paragraph separators, marks and overrides of the direction of writing. */
bool hf_text_is_hidden(uint32_t code);

/* What people are shown of a text that comes from a file, a name or the command line: hidden characters and bytes that
 * are not UTF-8 as \n, \t, \r, \x1b, \u202e. A backslash stays as it is, so escaping twice changes nothing. Writes at
 * most `size` bytes, whole characters and the final NUL; returns the length that there is without that limit. */
size_t hf_text_escape(const char *text, char *escaped, size_t size);

/* Remove an incomplete UTF-8 sequence from the end of a text that snprintf has cut. */
void hf_text_trim_utf8(char *text);

/* The number of the first line of a YAML text that has more than HF_TEXT_NESTING_MAX brackets open at once, quoted ones
 * included; 0 when there is none. libyaml takes minutes to read thousands of open brackets. */
#define HF_TEXT_NESTING_MAX 100
int hf_text_too_deep(const char *text);

/* The candidate nearest to `word` by edit distance, or NULL when none is near enough to be a typing error. */
const char *hf_text_nearest(const char *word, const char *const *candidates, int n_candidate);

/* The same as words behind an error: "; did you mean 'tension'?", or "" when none is near. */
#define HF_TEXT_HINT_SIZE 160
void hf_text_hint(const char *word, const char *const *candidates, int n_candidate, char hint[HF_TEXT_HINT_SIZE]);

/* Is it a number with a comma for its point, such as 1,5? */
bool hf_text_has_decimal_comma(const char *text);

#endif
