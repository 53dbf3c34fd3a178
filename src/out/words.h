/* words - what every status, warning, figure and term means, and what to do about it: one table for `hifdm explain`.
 * Figures and statuses come from the lists that define them (result.h, summary.h, surface.h, tolerance.h, status.h);
 * what these lists do not say stands beside them in words.c, words_warning.c, words_case.c and
 * words_adjust.c. */
#ifndef HIFDM_WORDS_H
#define HIFDM_WORDS_H

#include <stdbool.h>

typedef struct {
    const char *word;
    const char *kind; /* what it is: "term", "status", "warning", "figure of form, optimize, polish", ... */
    const char *units, *text;
    const char *says; /* of a warning: words of it that no other has; else NULL */
} hf_word;

/* Entry i of 0..hf_word_count()-1; a word may have several, of different kinds. */
int hf_word_count(void);
hf_word hf_word_at(int i);

/* Warnings. */
extern const hf_word hf_words_warning[];
extern const int hf_n_words_warning;

/* Words of case files and cut lists. */
extern const hf_word hf_words_case[];
extern const int hf_n_words_case;

/* Those of `hifdm adjust`, which are the last. */
extern const hf_word hf_words_adjust[];
extern const int hf_n_words_adjust;

/* Does entry i belong to `word`, or to a whole warning that a user copied? */
bool hf_word_is(int i, const char *word);

/* A letter as words are compared: small, and a blank for "-" and "_". */
int hf_word_letter(char letter);

/* Is `word` its word, but for capitals, for what stands between the parts ("-", "_" or a blank), for an s of the plural
 * behind it, and for the unit of a figure that is left out? */
bool hf_word_is_like(int i, const char *word);

#endif
