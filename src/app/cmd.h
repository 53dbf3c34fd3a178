/* cmd - lists the commands of `hifdm`. The file cmd_NAME.c holds the command NAME: its row and its function. A new
 * command needs such a file, and its name in HF_COMMANDS. Its options are rows in options.c. */
#pragma once

#include <hifdm/status.h>
#include <stdbool.h>
#include <stdio.h>

typedef struct hf_options hf_options;

typedef struct {
    const char *name;
    /* Examples: "CASE"; "A B" for two files; "[COMMAND]" for an optional one; "[WORD...]" for any number; NULL for
     * none. */
    const char *argument;
    const char *help;     /* one line */
    const char *about;    /* a paragraph on what the help of the options does not say; NULL: none */
    const char *examples; /* command lines, separated by '\n'; NULL: none */
    bool reads_results;   /* main runs it in a copy of the program: hf_reader_watch */
    bool uses_threads;    /* main prepares OpenMP before it calls run */
    /* Runs the command. Its output goes to `file`. The returned status becomes the exit status of the program. */
    hf_status (*run)(const hf_options *options, FILE *file, hf_messages *messages);
} hf_command;

/* X(name): the commands, in the order in which the help lists them. */
#define HF_COMMANDS(X)                                                                                                 \
    X(new)                                                                                                             \
    X(run)                                                                                                             \
    X(check)                                                                                                           \
    X(evaluate)                                                                                                        \
    X(tolerance)                                                                                                       \
    X(adjust)                                                                                                          \
    X(sweep)                                                                                                           \
    X(status)                                                                                                          \
    X(merge)                                                                                                           \
    X(show)                                                                                                            \
    X(recover)                                                                                                         \
    X(diff)                                                                                                            \
    X(report)                                                                                                          \
    X(export)                                                                                                          \
    X(explain)                                                                                                         \
    X(schema)                                                                                                          \
    X(help)                                                                                                            \
    X(version)

#define HF_COMMAND_ROW(name) extern const hf_command hf_cmd_##name;
HF_COMMANDS(HF_COMMAND_ROW)
#undef HF_COMMAND_ROW

#define HF_COMMAND_COUNT(name) +1
enum { HF_N_COMMAND = HF_COMMANDS(HF_COMMAND_COUNT) };
#undef HF_COMMAND_COUNT

extern const hf_command *const hf_command_table[HF_N_COMMAND];
