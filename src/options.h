/* options - the command line, from one table that also prints the help. */
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
} hf_options;

/* HF_BAD_USAGE with a message that says what to write instead. Free with hf_options_free in any case. */
hf_status hf_options_parse(int argc, char *const *argv, hf_options *options, hf_messages *messages);

void hf_options_help(FILE *file);
void hf_options_free(hf_options *options);

#endif
