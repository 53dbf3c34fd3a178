/* options - reads the options of the command line. One table of rows serves the reading of the command line, the help,
 * the manual page and the completion for bash. */
#pragma once

#include "app/cmd.h"
#include "app/progress.h"
#include "out/export.h"
#include <stdint.h>

typedef enum { HF_HELP_TEXT, HF_HELP_MAN, HF_HELP_BASH } hf_help_form;

typedef enum { HF_NEW_UNSAID, HF_NEW_PARABOLOID, HF_NEW_CYLINDER, HF_NEW_IMPORT } hf_new_case;

struct hf_options {
    const hf_command *command;
    const hf_command *const *commands; /* [HF_N_COMMAND] all commands */
    int argc;                          /* the whole command line, for the provenance of results */
    char *const *argv;
    const char *file;                     /* the CASE or FILE; NULL for commands without one */
    const char *second;                   /* the other FILE of diff and report */
    const char *output;                   /* argument of -o */
    const char *point;                    /* argument of --point */
    const char *export_to[HF_N_EXPORTER]; /* file or folder of each exporter; NULL: not requested */
    const char *designs, *template_path;  /* arguments of --designs and --template */
    const char *jacobian, *residuals;     /* arguments of --jacobian and --residuals */
    const char *measured;                 /* argument of --measured */
    const char *result;                   /* argument of --result */
    const char *report;                   /* argument of --report */
    const char *stage;                    /* word of the stage of --stage, as hf_stage_word has it */
    const char *load_case;                /* argument of --load-case */
    const char **set;                     /* [n_set], "key=value" of each --set, owned */
    int n_set;
    const char *folder; /* argument of --dir */
    unsigned retry;     /* --retry as bits 1 << hf_point_state; 0: not given */
    int more;           /* argument of --more; 0: not given */
    int task, tasks;    /* arguments of --task and --tasks; -1 and 0: not given */
    int threads;        /* --threads or SLURM_CPUS_PER_TASK; 0: all cores */
    bool has_seed;
    uint64_t seed;
    double rtol, atol; /* arguments of --rtol and --atol */
    hf_progress_mode progress;
    bool json, quiet, verbose, force, strict;
    bool help;               /* true with --help */
    const hf_command *topic; /* the command to describe, for help; NULL: all commands */
    hf_help_form help_as;
    hf_new_case new_case; /* kind of case that the command new writes */
};

typedef struct hf_option hf_option;

/* An option on the command line, and where to put its value. */
typedef struct {
    const hf_option *option;
    const char *value; /* NULL for an option without an argument */
    hf_options *options;
    hf_messages *messages;
} hf_option_reading;

/* A row of the table. */
struct hf_option {
    const char *name, *letter; /* "--output", "-o" or NULL */
    const char *argument; /* N, FILE, DIR, KEY=VALUE, or the words themselves as in form|search|refine; NULL: none */
    const char *help;
    const char *commands; /* names of the commands that take it, separated by blanks; NULL: all */
    hf_status (*read)(const hf_option_reading *reading);
    size_t offset; /* offset of the member of hf_options that `read` sets */
    int number;    /* for `read`: the maximum of a number, or the choice that the option stands for; of a row without a
                      name: the exporter whose row gives name, argument and help */
};

extern const int hf_n_option;

/* Returns option i from 0 to hf_n_option - 1, in the order in which the help prints them. A name may occur more than
 * once, for different commands. */
hf_option hf_option_at(int i);

/* Returns true if the command takes the option. */
bool hf_option_goes_with(const hf_option *option, const hf_command *command);

/* Reads the command line into *options. Returns HF_OK, HF_NO_MEMORY, or HF_BAD_USAGE with a message that says what to
 * write instead. Call hf_options_free in any case. */
hf_status hf_options_parse(int argc, char *const *argv, const hf_command *const *commands, hf_options *options,
                           hf_messages *messages);

void hf_options_free(hf_options *options);
