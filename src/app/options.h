/* options - the options of the command line. One table of rows serves the reading of the command line, the help, the
 * manual page and the completion for bash. */
#ifndef HIFDM_OPTIONS_H
#define HIFDM_OPTIONS_H

#include "app/cmd.h"
#include "app/progress.h"
#include "out/export.h"
#include <stdint.h>

typedef enum { HF_HELP_TEXT, HF_HELP_MAN, HF_HELP_BASH } hf_help_form;

typedef enum { HF_NEW_UNSAID, HF_NEW_PARABOLOID, HF_NEW_CYLINDER, HF_NEW_IMPORT } hf_new_case;

struct hf_options {
    const hf_command *command;
    int argc; /* the whole command line, for the provenance of results */
    char *const *argv;
    const char *file;                     /* the CASE or FILE, NULL for commands without one */
    const char *second;                   /* the other FILE of diff and report */
    const char *output;                   /* -o */
    const char *point;                    /* --point */
    const char *export_to[HF_N_EXPORTER]; /* file or folder by exporter; NULL: not asked for */
    const char *designs, *template_path;  /* --designs, --template */
    const char *jacobian;                 /* --jacobian */
    const char *measured;                 /* --measured */
    const char *result;                   /* --result */
    const char *report;                   /* --report */
    const char *stage;                    /* --stage */
    const char *state;                    /* --case */
    const char **set;                     /* [n_set] --set key=value, owned */
    int n_set;
    const char *folder; /* --dir */
    unsigned retry;     /* --retry, bits 1 << hf_point_state; 0 = not given */
    int task, tasks;    /* --task I --tasks N: -1, 0 = not given */
    int threads;        /* 0 = all cores; SLURM_CPUS_PER_TASK where --threads is not given */
    bool has_seed;
    uint64_t seed;
    double rtol, atol; /* of diff */
    hf_progress_mode progress;
    bool json, quiet, verbose, force;
    bool help;               /* --help */
    const hf_command *topic; /* of help; NULL = all commands */
    hf_help_form help_as;
    hf_new_case new_case; /* of new */
};

typedef struct hf_option hf_option;

/* A row of the table. */
struct hf_option {
    const char *name, *letter; /* "--output", "-o" or NULL */
    const char *argument; /* N, FILE, DIR, KEY=VALUE, the words themselves as in form|optimize|polish, NULL: none */
    const char *help;
    const char *commands; /* names of the commands that take it, separated by blanks; NULL: all */
    hf_status (*read)(const hf_option *option, const char *value, hf_options *options, hf_messages *messages);
    size_t offset;               /* in hf_options, for `read` */
    const hf_exporter *exporter; /* NULL, or the exporter whose row gives name, argument and help */
};

extern const int hf_n_option;

/* Option i of 0..hf_n_option-1, in the order in which help prints them. A name may come more than once, for different
 * commands. */
hf_option hf_option_at(int i);

bool hf_option_goes_with(const hf_option *option, const hf_command *command);

/* HF_BAD_USAGE with a message that says what to write instead. Free with hf_options_free in any case. */
hf_status hf_options_parse(int argc, char *const *argv, hf_options *options, hf_messages *messages);

void hf_options_free(hf_options *options);

#endif
