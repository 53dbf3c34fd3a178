/* Reads the entries of `hifdm explain` from the embedded glossary, and finds them by words and messages.
 *
 *     lines of glossary.md -> texts of entries, moved up within the same memory -> table of entries */
#include "out/words.h"

#include <ctype.h>
#include <string.h>

/* ---- the glossary ---- */

/* The state of hf_words_read. */
typedef struct {
    hf_word *entry; /* [size] */
    int n, size;
    const char *section, *kind; /* of the current section; kind is NULL before its line, "" in a section without one */
    char *end;                  /* end of the text that is kept, at most the begin of the line that is read */
    char *text;                 /* text of the current entry; NULL if there is none */
    bool is_open, is_gap;       /* there is a current entry; the line before this one was empty */
} reading;

/* Returns what follows `begin` in a line, or NULL if the line begins otherwise. */
static const char *after(const char *line, const char *begin)
{
    size_t n = strlen(begin);
    return strncmp(line, begin, n) ? NULL : line + n;
}

static char *keep(reading *r, const char *text, size_t length)
{
    char *kept = r->end;
    memmove(kept, text, length);
    kept[length] = '\0';
    r->end += length + 1;
    return kept;
}

static const char *keep_list(reading *r, const char *values)
{
    const char *list = r->end;
    for (const char *comma; (comma = strstr(values, ", ")) != NULL; values = comma + 2)
        keep(r, values, (size_t)(comma - values));
    keep(r, values, strlen(values));
    keep(r, "", 0);
    return list;
}

/* Adds `text` in backticks to the list of messages, which is the last text kept. Returns false without backticks. */
static bool keep_message(reading *r, hf_word *w, const char *quoted)
{
    size_t n = strlen(quoted);
    if (n < 3 || quoted[0] != '`' || quoted[n - 1] != '`') return false;
    if (*w->message) r->end--;
    const char *message = keep(r, quoted + 1, n - 2);
    if (!*w->message) w->message = message;
    keep(r, "", 0);
    return true;
}

/* Removes the backticks around single words. Returns false if one has no partner. */
static bool unquote(char *text)
{
    char *to = text;
    for (const char *p = text; *p;) {
        size_t n = *p == '`' ? strcspn(p + 1, "`") : strcspn(p, "`"), quotes = *p == '`' ? 2 : 0;
        bool is_single = quotes && !memchr(p + 1, ' ', n);
        if (quotes && !p[n + 1]) return false;
        memmove(to, p + is_single, n + (is_single ? 0 : quotes));
        to += n + (is_single ? 0 : quotes);
        p += n + quotes;
    }
    *to = '\0';
    return true;
}

/* Ends the current entry. Returns false if it has no text or a fault in it. */
static bool end_entry(reading *r)
{
    bool is_whole = !r->is_open || (r->text && unquote(r->text));
    r->is_open = false;
    return is_whole;
}

static bool begin_entry(reading *r, const char *word)
{
    bool is_whole = end_entry(r);
    if (!r->kind || !*r->kind || !*word || r->n == r->size) return false;
    r->entry[r->n++] = (hf_word){keep(r, word, strlen(word)), r->section, r->kind, "", "", "", "", "", ""};
    r->text = NULL;
    r->is_open = true;
    return is_whole;
}

/* Reads "Key: values". Returns false for another key, and for one behind the messages, which are the last. */
static bool read_attribute(reading *r, hf_word *w, const char *line)
{
    const char *values;
    if ((values = after(line, "Message contains: ")) != NULL) return keep_message(r, w, values);
    if (*w->message) return false;
    if ((values = after(line, "Unit: ")) != NULL)
        w->unit = keep(r, values, strlen(values));
    else if ((values = after(line, "Exit status: ")) != NULL)
        w->exit_status = keep(r, values, strlen(values));
    else if ((values = after(line, "Also: ")) != NULL)
        w->also = keep_list(r, values);
    else if ((values = after(line, "Formerly: ")) != NULL)
        w->formerly = keep_list(r, values);
    return values != NULL;
}

/* Returns false if the line breaks a rule. */
static bool read_line(reading *r, const char *line)
{
    hf_word *w = r->is_open ? &r->entry[r->n - 1] : NULL;
    const char *rest;
    if ((rest = after(line, "### ")) != NULL) return begin_entry(r, rest);
    if ((rest = after(line, "## ")) != NULL) {
        bool is_whole = end_entry(r);
        r->section = keep(r, rest, strlen(rest));
        r->kind = NULL;
        return is_whole;
    }
    if (w && (rest = after(line, "- ")) != NULL) return !r->text && read_attribute(r, w, rest);
    if (w && *line) {
        if (r->text) r->end[-1] = r->is_gap ? '\n' : ' ';
        char *kept = keep(r, line, strlen(line));
        if (!r->text) w->text = r->text = kept;
    } else if (*line && r->section && !r->kind) {
        r->kind = *line == '`' ? keep(r, line + 1, strcspn(line + 1, "`")) : "";
    }
    r->is_gap = !*line;
    return true;
}

int hf_words_read(char *text, hf_word *entry, int size, int *fault)
{
    reading r = {.entry = entry, .size = size, .end = text};
    int number = 0;
    *fault = 0;
    for (char *line = text, *next; *line; line = next) {
        size_t n = strcspn(line, "\n");
        next = line + n + (line[n] != '\0');
        line[n] = '\0';
        number++;
        if (!read_line(&r, line) && !*fault) *fault = number;
    }
    if (!end_entry(&r) && !*fault) *fault = number;
    return r.n;
}

/* ---- the entries ---- */

enum { WORDS_MAX = 1024 };
static hf_word table[WORDS_MAX];
static int n_table; /* 0 before the glossary is read */

int hf_word_count(void)
{
    int fault; /* a test demands that there is none */
    if (!n_table) n_table = hf_words_read(hf_words_text, table, WORDS_MAX, &fault);
    return n_table;
}

hf_word hf_word_at(int i)
{
    hf_word_count();
    return table[i];
}

const char *hf_word_next(const char *item)
{
    return item + strlen(item) + 1;
}

/* Returns true if `word` is the same as the word of an entry, or as one of its other names. */
static bool has_name(const hf_word *w, const char *word, int (*compare)(const char *known, const char *word))
{
    const char *list[] = {w->also, w->formerly};
    bool found = !compare(w->word, word);
    for (int k = 0; k < 2; k++)
        for (const char *p = list[k]; *p; p = hf_word_next(p))
            found |= !compare(p, word);
    return found;
}

bool hf_word_is(int i, const char *word)
{
    const hf_word w = hf_word_at(i);
    return has_name(&w, word, strcmp) || hf_word_is_in(i, word);
}

bool hf_word_is_in(int i, const char *messages)
{
    for (const char *p = hf_word_at(i).message; *p; p = hf_word_next(p))
        if (strstr(messages, p)) return true;
    return false;
}

int hf_word_letter(char letter)
{
    return letter == '-' || letter == '_' ? ' ' : tolower((unsigned char)letter);
}

/* Returns true if the rest of the name of a figure is a unit, which users leave out. */
static bool is_unit(const char *rest)
{
    static const char *const unit[] = {"_m", "_N", "_dB", "_deg", "_s", "_kg", "_Hz"};
    for (size_t k = 0; k < sizeof unit / sizeof *unit; k++)
        if (!strcmp(rest, unit[k])) return true;
    return false;
}

/* Compares two words like strcmp, but for capitals, separators, a plural s and units. */
static int compare_loosely(const char *known, const char *word)
{
    while (*known && hf_word_letter(*known) == hf_word_letter(*word))
        known++, word++;
    return !((!*known || is_unit(known)) && (!*word || !strcmp(word, "s")));
}

bool hf_word_is_like(int i, const char *word)
{
    const hf_word w = hf_word_at(i);
    return has_name(&w, word, compare_loosely);
}
