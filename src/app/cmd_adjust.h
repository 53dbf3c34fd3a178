/* cmd_adjust - what the files of `hifdm adjust` share: its data, what a measured net shows besides its adjustments, and
 * the output: the table for the workshop, the summary for people, the JSON object for programs, and the page. */
#ifndef HIFDM_CMD_ADJUST_H
#define HIFDM_CMD_ADJUST_H

#include "app/options.h"
#include "base/json.h"
#include "built/adjust.h"
#include "built/measured.h"
#include "built/prior.h"
#include "run/problem_parts.h"

#define HF_ADJUST_STANDS_OUT 3.0 /* sigmas above which an error is reported */
#define HF_ADJUST_OFF 4.0 /* sigmas above which a measured position is reported; one in a thousand is by chance */
/* The maximum number of other aims. */
enum { HF_ADJUST_INSTEAD = 3 };

/* What adjustments with another figure or aim would reach. */
typedef struct {
    hf_figure_kind figure;
    hf_aim aim;
    double before_m, after_m; /* value of the figure at the estimated shape, and after the adjustments */
    int n_move, n_at_range;
} hf_adjust_instead;

/* An item of a list that is sorted by size. */
typedef struct {
    double size;
    int at;
} hf_adjust_sized;

/* The data of the command. */
typedef struct {
    hf_problem problem;
    hf_built built;
    hf_measured measured;
    const char *measured_path;
    int threads;
    hf_estimate estimate;
    hf_objectives objectives;
    hf_adjustment adjustment;
    hf_adjust_task task;
    int *cable; /* [n_cable], cables of the task */
    hf_prior prior;
    double *least_N;                  /* [n_cable], minimum tensions that the case demands */
    double *expected_m;               /* [n_node], RMS displacement of each node by errors */
    double measured_m;                /* psi of the measured inner nodes; NaN for other figures */
    int n_out, *out;                  /* [n_out], cables whose errors stand out, worst first */
    double *by_places_m;              /* [n_out], errors by positions alone, without own sigmas; NaN: not known */
    int n_far, *far_row;              /* [n_far], rows of measured nodes far from the estimated shape, worst first */
    hf_adjust_sized *sized;           /* [max(n_cable, n_node)], scratch */
    double design_psi_m, error_psi_m; /* psi of the design from target positions; RMS of the effect of errors */
    int n_at_range;                   /* number of adjustments that reach the range */
    int n_instead;
    hf_adjust_instead instead[HF_ADJUST_INSTEAD]; /* [n_instead], other aims */
    void *block;
} hf_adjust_job;

/* Returns chi^2 per coordinate. Its mean is 1 if the sigmas of errors and positions are right, whatever was
 * measured. */
double hf_adjust_chi_square(const hf_adjust_job *job);

/* Returns true if chi^2 can be due to chance. */
bool hf_adjust_fits(const hf_adjust_job *job);

/* Returns the estimated error of a cable divided by its sigma; 0 for a cable without a sigma. */
double hf_adjust_sigmas(const hf_adjust_job *job, int cable);

/* Returns the distance of a measured node from the estimated shape, m. */
double hf_adjust_off_m(const hf_adjust_job *job, int row);

/* ---- findings ---- */

/* Lists the measured nodes that are far from the estimated shape. Returns the row of the node that is farthest in parts
 * of its sigma. */
int hf_adjust_find_places(hf_adjust_job *job);

/* Lists the cables whose errors stand out, after the estimate. Returns HF_OK, HF_SINGULAR or HF_NO_MEMORY. */
hf_status hf_adjust_find_cables(hf_adjust_job *job);

/* Makes the objective of one figure of the as-built net. Returns HF_OK, HF_BAD_CASE or HF_NO_MEMORY; free goals in any
 * case. */
hf_status hf_adjust_make_objectives(const hf_adjust_job *job, hf_figure_kind figure, hf_objectives *objectives,
                                    hf_messages *messages);

/* Copies the positions from which psi is measured into the model of the as-built net: those of the design, or the
 * target positions. */
void hf_adjust_take_aim(hf_adjust_job *job, hf_aim aim);

/* Tries other figures and aims, after the adjustments are found. It does so if psi of the design exceeds that of the
 * errors, or if most adjustments reach the range. Returns HF_OK, HF_INTERRUPTED or HF_NO_MEMORY. */
hf_status hf_adjust_find_instead(hf_adjust_job *job);

/* ---- output ---- */

/* Prints the table. It is a function for hf_file_out_write; `context` is the job. */
void hf_adjust_print_table(const void *context, FILE *file);
/* Prints the summary for people. */
void hf_adjust_print_summary(const hf_adjust_job *job, const hf_options *options, FILE *file);
/* Prints the JSON object, also after a failure (`status`, `messages`). */
void hf_adjust_print_json(const hf_adjust_job *job, const hf_options *options, hf_status status, const char *messages,
                          FILE *file);

/* Adds the page of options->result with the adjustments to `files`, if options->report is set. Returns HF_OK, HF_IO or
 * HF_NO_MEMORY. */
hf_status hf_adjust_print_page(const hf_adjust_job *job, const hf_options *options, hf_file_out_set *files,
                               hf_messages *messages);

#endif
