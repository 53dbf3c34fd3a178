/* `hifdm explain` prints the meaning of a word of the summary, of --json or of a warning, and what to do about it.
 *
 *     words of the command line -> exit status? -> entries of that word -> keys of the case file -> similar entries
 *                               -> nothing found: a suggestion, or one term after the other */
#include "app/cmd_help.h"

#include "base/text.h"
#include "out/print.h"
#include "out/words.h"

#include <hifdm/config.h>

#include <string.h>

#define SHORT 4 /* number of letters up to which a suggestion must begin with the same two letters */

/* Prints "word (kind, unit)", earlier names, and the text. */
static void print_entry(const hf_word *w, FILE *f)
{
    const char *unit = *w->unit ? ", " : "", *status = *w->exit_status ? "; exit status " : "";
    hf_print_line(f, "%s (%s%s%s%s%s)", w->word, w->kind, unit, w->unit, status, w->exit_status);
    for (const char *p = w->formerly; *p; p = hf_word_next(p))
        fprintf(f, "%s\"%s\"%s", p == w->formerly ? "    Formerly " : ", ", p, *hf_word_next(p) ? "" : ".\n");
    hf_help_wrap(w->text, 4, 0, f);
}

/* Prints all words, section by section. */
static void print_words(FILE *f)
{
    int column = 0;
    for (int i = 0; i < hf_word_count(); i++) {
        const hf_word w = hf_word_at(i);
        bool is_first = i == 0 || w.section != hf_word_at(i - 1).section;
        if (is_first) column = fprintf(f, "%s%s:", i ? "\n" : "", w.section);
        if (!is_first) column += fprintf(f, ",");
        if (column + 2 + (int)strlen(w.word) > 98) column = fprintf(f, "\n   ") - 1;
        column += fprintf(f, " %s", w.word);
    }
    fputc('\n', f);
}

/* Prints the entries of a word, or of similar ones if is_like is true. Returns false if there is none. */
static bool print_entries(const char *word, bool is_like, FILE *f)
{
    int n = 0;
    for (int i = 0; i < hf_word_count(); i++) {
        if (!(is_like ? hf_word_is_like(i, word) : hf_word_is(i, word))) continue;
        const hf_word w = hf_word_at(i);
        print_entry(&w, f);
        n++;
    }
    return n > 0;
}

/* Prints an exit status ("75" or "exit status 75") and the statuses with this exit code. Returns false if there is
 * none. */
static bool print_exit_status(const char *word, FILE *f)
{
    static const char begin[] = "exit status ";
    const char *code = strncmp(word, begin, strlen(begin)) ? word : word + strlen(begin);
    for (int k = 0; k < HF_HELP_N_EXIT; k++) {
        const struct hf_help_exit *e = &hf_help_exit_table[k];
        if (strcmp(e->code, code) != 0) continue;
        hf_print_line(f, "%s (exit status)", code);
        hf_help_wrap(e->meaning, 4, 0, f);
        for (int i = 0; i < hf_word_count(); i++) {
            const hf_word w = hf_word_at(i);
            if (!strcmp(w.exit_status, code)) print_entry(&w, f);
        }
        return true;
    }
    return false;
}

/* Prints the keys of the case file with this name, or with this last part: path, unit and help. Returns false if there
 * is none. */
static bool print_keys(const char *word, FILE *f)
{
    size_t length = strlen(word);
    int n = 0;
    for (int l = -1; l < hf_n_list; l++) {
        const hf_list *list = l < 0 ? NULL : &hf_list_table[l];
        const hf_field *field = list ? list->field : hf_field_table;
        for (const hf_field *end = field + (list ? list->n_field : hf_n_field); field < end; field++) {
            char path[160];
            snprintf(path, sizeof path, "%s%s%s", list ? list->path : "", list ? "." : "", field->path);
            size_t all = strlen(path);
            const char *tail = all >= length ? path + (all - length) : "";
            if (!length || strcmp(tail, word) != 0 || (tail > path && tail[-1] != '.')) continue;
            hf_print_line(f, "%s (key of the case file%s%s)", path, *field->unit ? ", " : "", field->unit);
            hf_help_wrap(hf_config_help(path, NULL), 4, 0, f);
            n++;
        }
    }
    if (n) fputs("    'hifdm schema' prints the values and defaults of all keys\n", f);
    return n > 0;
}

/* Joins the words of the command line by blanks, because few users quote a term such as "best fit". */
static const char *join_words(const hf_options *o, char *joined, size_t size)
{
    size_t used = 0;
    bool words_alone = false; /* after "--" */
    *joined = '\0';
    for (int i = 2; i < o->argc && used < size; i++)
        if (!words_alone && !strcmp(o->argv[i], "--"))
            words_alone = true;
        else if (words_alone || o->argv[i][0] != '-' || !o->argv[i][1])
            used += (size_t)snprintf(joined + used, size - used, "%s%s", used ? " " : "", o->argv[i]);
    return joined;
}

static bool explain_word(const char *word, FILE *f)
{
    return print_exit_status(word, f) || print_entries(word, false, f) || print_keys(word, f) ||
           print_entries(word, true, f);
}

/* Explains the longest term that consists of the first words. Returns its length, or 0 if there is none. */
static size_t explain_first(const char *words, FILE *f)
{
    char some[1024];
    for (size_t n = strlen(words); n > 0; n--) {
        if (words[n] && words[n] != ' ') continue;
        snprintf(some, sizeof some, "%.*s", (int)n, words);
        if (explain_word(some, f)) return n;
    }
    return 0;
}

/* Explains words that do not form a term together, one term after the other. */
static hf_status explain_each(const char *all, FILE *f, hf_messages *messages)
{
    char unknown[1024] = "";
    bool is_any = false;
    for (const char *rest = all + strspn(all, " "); *rest; rest += strspn(rest, " ")) {
        size_t n = explain_first(rest, f);
        is_any |= n > 0;
        if (n == 0) {
            n = strcspn(rest, " ");
            if (!*unknown) snprintf(unknown, sizeof unknown, "%.*s", (int)n, rest);
        }
        rest += n;
    }
    if (!*unknown) return HF_OK;
    return hf_error(messages, HF_BAD_USAGE, "the glossary has no entry '%.64s'. 'hifdm explain' lists all entries",
                    is_any ? unknown : all);
}

static hf_status command_explain(const hf_options *o, FILE *file, hf_messages *messages)
{
    static const char no_proof[] = "no: "; /* the table has this prefix before a bound_reason */
    char joined[1024];
    const char *names[1024], *all = join_words(o, joined, sizeof joined), *word = all;
    int n_name = 0;
    if (!o->file) {
        print_words(file);
        return HF_OK;
    }
    if (!strncmp(word, no_proof, strlen(no_proof))) word += strlen(no_proof);
    if (explain_word(word, file)) return HF_OK;
    for (int i = 0; i < hf_word_count() && n_name < (int)(sizeof names / sizeof *names); i++)
        names[n_name++] = hf_word_at(i).word;
    const char *near = hf_text_nearest(all, names, n_name);
    bool is_likely = near && (strlen(word) > SHORT || (hf_word_letter(near[0]) == hf_word_letter(word[0]) &&
                                                       hf_word_letter(near[1]) == hf_word_letter(word[1])));
    if (is_likely)
        return hf_error(messages, HF_BAD_USAGE, "the glossary has no entry '%.64s'; did you mean '%s'?", all, near);
    return explain_each(all, file, messages);
}

const hf_command hf_cmd_explain = {
    .name = "explain",
    .argument = "[WORD...]",
    .help = "explain a status, a warning, a quantity or a term, and suggest an action",
    .about = "WORD is a term of the summary, of the JSON output or of a message, or a complete warning in quotes. "
             "Without the argument WORD, hifdm explain lists all entries of the glossary.",
    .examples = "hifdm explain straight_chain\n"
                "hifdm explain position_bound_m\n"
                "hifdm explain \"warning: these cables of the form-finding shape are slack (1): c7\"",
    .run = command_explain,
};
