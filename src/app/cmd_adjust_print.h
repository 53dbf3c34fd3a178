/* cmd_adjust_print - what `hifdm adjust` says: the table for the workshop, the summary for people, the object for
 * programs, the page. */
#ifndef HIFDM_CMD_ADJUST_PRINT_H
#define HIFDM_CMD_ADJUST_PRINT_H

#include "app/options.h"
#include "base/json.h"
#include "built/adjust.h"
#include "built/measured.h"
#include "built/prior.h"
#include "run/problem_parts.h"

#define HF_ADJUST_STANDS_OUT 3.0 /* sigmas of an error that is named */
#define HF_ADJUST_OFF 4.0        /* the same of a measured place; one of a thousand is so by chance */
enum { HF_ADJUST_INSTEAD = 3 };

/* What moves would do that aim at something else. */
typedef struct {
    hf_goal_kind figure;
    hf_aim aim;
    double before_m, after_m; /* its figure, of the estimated shape and after the moves */
    int n_move, n_at_range;
} hf_adjust_instead;

/* All that the command works on. */
typedef struct {
    hf_problem problem;
    hf_built built;
    hf_measured measured;
    const char *measured_path;
    int threads;
    hf_estimate estimate;
    hf_goals goals;
    hf_adjustment adjustment;
    hf_adjust_task task;
    int *cable; /* [n_cable] of the task */
    hf_prior prior;
    double *least_N;     /* [n_cable] tensions that are asked for */
    double *expected_m;  /* [n_node] */
    double measured_m;   /* psi of the inner nodes that were measured; NaN for other figures */
    int n_out, *out;     /* [n_out] cables whose errors stand out, the worst first */
    double *by_places_m; /* [n_out] their errors if sigmas of their own did not hold them back; NaN: not known */
    int n_far, *far_row; /* [n_far] measured nodes that are off the estimated shape, the worst first */
    double design_psi_m, error_psi_m; /* of the design, from theory; RMS of what errors make of it */
    int n_at_range;                   /* moves that are as far as the range allows */
    int n_instead;
    hf_adjust_instead instead[HF_ADJUST_INSTEAD]; /* [n_instead] */
    void *block;
} hf_adjust_job;

/* Chi^2 by coordinate: its mean is 1 when the sigmas of errors and places are right, whatever was measured. */
double hf_adjust_chi_square(const hf_adjust_job *job);

/* Is it what chance makes of it? */
bool hf_adjust_fits(const hf_adjust_job *job);

/* Estimated error of a cable over its sigma; 0 of one without a sigma. */
double hf_adjust_sigmas(const hf_adjust_job *job, int cable);

/* How far a measured node is from the estimated shape. */
double hf_adjust_off_m(const hf_adjust_job *job, int row);

/* Moves that are as far as the range allows. */
int hf_adjust_at_range(const hf_adjustment *adjustment, const hf_adjust_settings *settings);

/* For hf_file_out_write; context: the job. */
void hf_adjust_print_table(const void *context, FILE *file);
void hf_adjust_print_summary(const hf_adjust_job *job, const hf_options *options, FILE *file);
void hf_adjust_print_json(const hf_adjust_job *job, const hf_options *options, hf_status status, const char *messages,
                          FILE *file);

/* Adds the page of options->result with the moves on it to `files`, if options->report asks for it. HF_OK, HF_IO,
 * HF_NO_MEMORY. */
hf_status hf_adjust_print_page(const hf_adjust_job *job, const hf_options *options, hf_file_out_set *files,
                               hf_messages *messages);

#endif
