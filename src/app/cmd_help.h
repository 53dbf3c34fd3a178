/* cmd_help - declares what the three forms of `hifdm help` share: text, manual page and completion. All three are made
 * from the tables of commands, of options, and of the keys of a case file. */
#pragma once

#include "app/options.h"

#define HF_HELP_SUMMARY "shape and pretension of the cable net of a large deployable mesh reflector"
#define HF_HELP_N_EXIT 8

extern const struct hf_help_exit {
    const char *code, *meaning;
} hf_help_exit_table[HF_HELP_N_EXIT];

/* Prints the words of `text` in lines of at most 100 characters. The first line begins at `column`, the others at
 * `indent`. */
void hf_help_wrap(const char *text, int indent, int column, FILE *file);

/* Print the manual page for man(1), and the completion script for bash. The caller checks the stream for errors. */
void hf_help_man(const hf_command *const *commands, FILE *file);
void hf_help_bash(const hf_command *const *commands, FILE *file);

static inline const char *hf_help_space_before(const char *word)
{
    return word ? " " : "";
}

static inline const char *hf_help_or_nothing(const char *word)
{
    return word ? word : "";
}
