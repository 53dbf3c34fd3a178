/* words - one table for `hifdm explain`: the meaning of every status, warning, figure and term, and what to do about
 * it.
 *
 * Entries of figures and statuses come from the lists that define them (result.h, summary.h, surface.h, tolerance.h,
 * status.h). Entries beyond these lists are in words.c, words_warning.c, words_case.c and words_adjust.c. */
#ifndef HIFDM_WORDS_H
#define HIFDM_WORDS_H

#include <stdbool.h>

typedef struct {
    const char *word;
    const char *kind; /* kind of word: "term", "status", "warning", "figure of form, optimize, polish", ... */
    const char *units, *text;
    const char *says; /* text that only messages of this entry contain; may be NULL */
} hf_word;

/* hf_word_at returns entry i of 0 ... hf_word_count() - 1. A word may have several entries of different kinds. */
int hf_word_count(void);
hf_word hf_word_at(int i);

/* Warnings. */
extern const hf_word hf_words_warning[];
extern const int hf_n_words_warning;

/* Words of case files and cut lists. */
extern const hf_word hf_words_case[];
extern const int hf_n_words_case;

/* Words of `hifdm adjust`, the last entries. */
extern const hf_word hf_words_adjust[];
extern const int hf_n_words_adjust;

/* Returns whether entry i belongs to `word`, which may also be a whole warning. */
bool hf_word_is(int i, const char *word);

/* Returns a letter for comparison: in lower case, with a blank for "-" and "_". */
int hf_word_letter(char letter);

/* Returns whether `word` is the word of entry i, apart from capitals, separators ("-", "_" or a blank), a plural s, and
 * the unit of a figure. */
bool hf_word_is_like(int i, const char *word);

#endif
