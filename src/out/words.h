/* words - reads the entries of `hifdm explain` from src/manual/glossary.md, which is part of the program: the meaning
 * of every status, warning, figure and term, and what to do about it. */
#pragma once

#include <stdbool.h>

/* An entry. A list is a row of strings, one behind the other, and ends with an empty string. */
typedef struct {
    const char *word;
    const char *section;     /* title of the section of the page */
    const char *kind;        /* kind of word: "term", "status", "warning", "figure of tolerance", ... */
    const char *unit;        /* "" if there is none */
    const char *exit_status; /* of a command that ends with this status; "" for other words */
    const char *also;        /* list of other words for the same thing */
    const char *formerly;    /* list of names in earlier versions */
    const char *message;     /* list of texts; a message with one of them belongs to this entry */
    const char *text;        /* paragraphs, separated by '\n' */
} hf_word;

/* hf_word_at returns entry i of 0 ... hf_word_count() - 1. A word may have several entries of different kinds. */
int hf_word_count(void);
hf_word hf_word_at(int i);

/* Returns the item behind this one: for (const char *p = list; *p; p = hf_word_next(p)). */
const char *hf_word_next(const char *item);

/* Returns true if `word` is a word or a name of entry i, or a message that belongs to it. */
bool hf_word_is(int i, const char *word);

/* Returns true if one of these messages belongs to entry i. */
bool hf_word_is_in(int i, const char *messages);

/* Returns true if hf_word_is would be true but for capitals, separators ("-", "_" or a blank), a plural s, and the unit
 * of a figure. Messages do not count. */
bool hf_word_is_like(int i, const char *word);

/* Returns a letter for comparison: in lower case, with a blank for "-" and "_". */
int hf_word_letter(char letter);

/* Reads a glossary by the rules at the top of glossary.md. The entries point into `text`, which is changed. Returns the
 * number of entries, at most `size`. *fault is the number of the first line that breaks a rule, counted from 1, or 0
 * if no line does; the other lines are read nevertheless. */
int hf_words_read(char *text, hf_word *entry, int size, int *fault);

/* The text of glossary.md, which the Makefile embeds. The first call of another function changes it. */
extern char hf_words_text[];
