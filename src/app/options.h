/* options - the command line, from two tables that module help prints, too. */
#ifndef HIFDM_OPTIONS_H
#define HIFDM_OPTIONS_H

#include <hifdm/status.h>
#include <stdint.h>
#include <stdio.h>

typedef enum {
    HF_COMMAND_RUN, /* these four, to SWEEP, use threads */
    HF_COMMAND_CHECK,
    HF_COMMAND_EVALUATE,
    HF_COMMAND_SWEEP,
    HF_COMMAND_STATUS,
    HF_COMMAND_MERGE,
    HF_COMMAND_SHOW,
    HF_COMMAND_REPORT,
    HF_COMMAND_RECOVER,
    HF_COMMAND_DIFF,
    HF_COMMAND_EXPORT,
    HF_COMMAND_SCHEMA,
    HF_COMMAND_HELP,
    HF_COMMAND_VERSION
} hf_command;

typedef struct {
    const char *name, *argument, *help; /* argument: CASE, [COMMAND] if it may be left out, NULL */
    hf_command command;
} hf_command_row;

/* argument: N, FILE, DIR, KEY=VALUE, the words themselves as in form|optimize|polish, NULL. */
typedef struct {
    const char *name, *letter, *argument, *help;
    unsigned commands; /* bits of the commands that take it */
    int id;
} hf_option_row;

extern const hf_command_row hf_command_table[];
extern const int hf_n_command;
extern const hf_option_row hf_option_table[]; /* a name may come more than once, for different commands */
extern const int hf_n_option;

int hf_option_goes_with(const hf_option_row *option, const hf_command_row *command);

typedef enum { HF_HELP_TEXT, HF_HELP_MAN, HF_HELP_BASH } hf_help_form;

typedef struct {
    hf_command command;
    const char *file;                    /* the CASE or FILE, NULL for commands without one */
    const char *second;                  /* the other FILE of diff */
    const char *output;                  /* -o */
    const char *csv;                     /* --csv */
    const char *vtk, *cutlist;           /* --vtk, --cutlist */
    const char *designs, *template_path; /* --designs, --template */
    const char *stage;                   /* --stage */
    const char **set;                    /* [n_set] --set key=value, owned */
    int n_set;
    const char *folder; /* --dir */
    unsigned retry;     /* --retry, bits 1 << hf_point_state; 0 = not given */
    int task, tasks;    /* --task I --tasks N: -1, 0 = not given */
    int threads;        /* 0 = all cores; SLURM_CPUS_PER_TASK where --threads is not given */
    int has_seed;
    uint64_t seed;
    double rtol, atol; /* of diff */
    int progress;      /* hf_progress_mode */
    int json, quiet, force;
    int help;                    /* --help */
    const hf_command_row *topic; /* of help; NULL = all commands */
    hf_help_form help_as;
} hf_options;

/* HF_BAD_USAGE with a message that says what to write instead. Free with hf_options_free in any case. */
hf_status hf_options_parse(int argc, char *const *argv, hf_options *options, hf_messages *messages);

void hf_options_free(hf_options *options);

#endif
