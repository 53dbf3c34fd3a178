/* text - reads whole files, reads numbers independently of the locale, checks UTF-8, makes texts of unknown origin safe
 * to show, and finds the word nearest to a misspelt one. */
#pragma once

#include <hifdm/status.h>
#include <stdbool.h>
#include <stdint.h>

/* Maximum number of faults in the user's input that are reported in full. A last message counts the others. */
enum {
    HF_FAULT_MAX = 20,       /* of one kind, in a table, a net or a truss */
    HF_FAULT_MAX_CASE = 100, /* in a case file */
    HF_FAULT_MAX_POINT = 10  /* points of a sweep, each with all its faults */
};

/* Reads a whole file into a NUL-terminated string that the caller frees. Returns HF_OK. Returns `code` if the file does
 * not exist or may not be read, if it is a folder, a pipe, a device or a socket, or if it is longer than 1 GiB. Returns
 * HF_IO or HF_NO_MEMORY if the machine cannot read it now. */
hf_status hf_text_read_file(const char *path, hf_status code, char **text, size_t *length, hf_messages *messages);

/* Return true if the whole string is one decimal number. hf_text_uint64 accepts no sign. nan, inf, hexadecimal numbers
 * and numbers that overflow are refused. */
bool hf_text_double(const char *text, double *value);

/* Writes the number times 10^decimals, rounded once to the nearest double: "1234.5" with decimals = -3 is 1.2345. */
bool hf_text_decimal(const char *text, int decimals, double *value);
bool hf_text_uint64(const char *text, uint64_t *value);

/* Returns true for well-formed UTF-8 without control characters other than tab. Results store ids and
 * titles as UTF-8. */
bool hf_text_is_utf8(const char *text);

/* Returns the length in bytes of the UTF-8 character at `text` and writes its code point. Returns 0 for a stray byte,
 * an overlong form, a surrogate, or a code point beyond U+10FFFF. The final NUL is a character of one byte. */
int hf_text_character(const char *text, uint32_t *code);

/* Returns true for a character that controls a terminal or reorders a line and shows nothing: control characters (C0,
 * DEL, C1), line and paragraph separators, marks and overrides of the writing direction. */
bool hf_text_is_hidden(uint32_t code);

/* Writes a text from a file, a name or the command line in a form that is safe to show. Hidden characters and bytes
 * that are not UTF-8 become \n, \t, \r, \x1b, \u202e and the like. A backslash stays as it is, so a second call changes
 * nothing. Writes whole characters, at most `size` bytes with the final NUL. Returns the length without this limit. */
size_t hf_text_escape(const char *text, char *escaped, size_t size);

/* Appends an item to a list in text[size], with `between` in front unless the list is empty. Appends `more` instead and
 * returns false if the item, and `more` behind it, do not fit. */
bool hf_text_append(char *text, size_t size, const char *between, const char *item, const char *more);

/* Removes an incomplete UTF-8 sequence from the end of a text that snprintf(3) has truncated. */
void hf_text_trim_utf8(char *text);

/* Returns the first error in lines of messages (NULL: none), without "error: " but with all lines behind it. Returns
 * `otherwise` if no line is an error. */
const char *hf_text_first_error(const char *lines, const char *otherwise);

/* Returns the number of the first line of a YAML text at which more than HF_TEXT_NESTING_MAX brackets are open; 0 if
 * there is none. Brackets in quotes count too. libyaml takes minutes to read thousands of open brackets. */
#define HF_TEXT_NESTING_MAX 100
int hf_text_too_deep(const char *text);

/* Returns the index of a word among n words, or -1. */
int hf_text_index(const char *word, const char *const *words, int n);

/* Returns the candidate with the smallest edit distance to `word`. Returns NULL if none is near enough to be
 * a typing error. */
const char *hf_text_nearest(const char *word, const char *const *candidates, int n_candidate);

/* Writes the nearest candidate as the end of an error message: "; did you mean 'tension'?". Writes "" if
 * none is near. */
#define HF_TEXT_HINT_SIZE 160
void hf_text_hint(const char *word, const char *const *candidates, int n_candidate, char hint[HF_TEXT_HINT_SIZE]);

/* Returns true for a number with a decimal comma, such as 1,5. */
bool hf_text_has_decimal_comma(const char *text);
