/* `hifdm explain` says what a word of the summary, of --json or of a warning means, and what to do about it. */
#include "app/cmd.h"

#include "app/cmd_help.h"
#include "base/text.h"
#include "out/print.h"
#include "out/words.h"

#include <string.h>

static void print_entry(const hf_word *w, const char *word, FILE *f)
{
    const char *unit = *w->units ? ", " : "";
    hf_print_line(f, "%s (%s%s%s)", word, w->kind, unit, w->units);
    hf_help_wrap(w->text, 4, 0, f);
}

/* Is entry i the first of its kind, or of its kind and word? */
static bool is_first(int i, bool of_word)
{
    const hf_word entry = hf_word_at(i);
    for (int k = 0; k < i; k++) {
        const hf_word w = hf_word_at(k);
        if (!strcmp(w.kind, entry.kind) && (!of_word || !strcmp(w.word, entry.word))) return false;
    }
    return true;
}

/* All words, kind by kind. */
static void print_words(FILE *f)
{
    for (int i = 0; i < hf_n_word; i++) {
        const hf_word kind = hf_word_at(i);
        if (!is_first(i, false) || !strcmp(kind.kind, "what to do")) continue;
        int column = fprintf(f, "%s:", kind.kind);
        for (int k = i; k < hf_n_word; k++) {
            const hf_word w = hf_word_at(k);
            if (strcmp(w.kind, kind.kind) || !is_first(k, true)) continue;
            if (k > i) column += fprintf(f, ",");
            if (column + 2 + (int)strlen(w.word) > 98) column = fprintf(f, "\n   ") - 1;
            column += fprintf(f, " %s", w.word);
        }
        fputc('\n', f);
    }
}

static hf_status command_explain(const hf_options *o, FILE *file, hf_messages *messages)
{
    const char *names[512];
    int n_name = 0, n_entry = 0;
    if (!o->file) {
        print_words(file);
        return HF_OK;
    }
    for (int i = 0; i < hf_n_word; i++) {
        const hf_word entry = hf_word_at(i);
        if (n_name < (int)(sizeof names / sizeof *names)) names[n_name++] = entry.word;
        if (!hf_word_is(i, o->file)) continue;
        print_entry(&entry, entry.word, file);
        n_entry++;
    }
    if (n_entry) return HF_OK;
    const char *near = hf_text_nearest(o->file, names, n_name);
    if (near) return hf_error(messages, HF_BAD_USAGE, "nothing is called '%s'; did you mean '%s'?", o->file, near);
    return hf_error(messages, HF_BAD_USAGE, "nothing is called '%s'; 'hifdm explain' lists all words", o->file);
}

const hf_command hf_cmd_explain = {
    .name = "explain",
    .argument = "[WORD]",
    .help = "say what a status, a warning, a figure or a term means, and what to do",
    .about =
        "WORD is one of the summary, of --json or of a message, or a whole warning in quotes. Without it all words "
        "are listed.",
    .examples = "hifdm explain straight_chain\n"
                "hifdm explain position_bound_m\n"
                "hifdm explain \"warning: slack in the form-finding shape, 1: c7\"",
    .run = command_explain,
};
