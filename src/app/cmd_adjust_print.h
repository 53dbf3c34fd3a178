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
    double *least_N;    /* [n_cable] tensions that are asked for */
    double *expected_m; /* [n_node] */
    double measured_m;  /* psi of the inner nodes that were measured; NaN for other figures */
    void *block;
} hf_adjust_job;

/* Chi^2 by coordinate: its mean is 1 when the sigmas of errors and places are right, whatever was measured. */
double hf_adjust_chi_square(const hf_adjust_job *job);

/* Is it what chance makes of it? */
bool hf_adjust_fits(const hf_adjust_job *job);

/* For hf_file_out_write; context: the job. */
void hf_adjust_print_table(const void *context, FILE *file);
void hf_adjust_print_summary(const hf_adjust_job *job, const hf_options *options, FILE *file);
void hf_adjust_print_json(const hf_adjust_job *job, const hf_options *options, hf_status status, const char *messages,
                          FILE *file);

/* The page of options->result with the moves on it, if options->report asks for it. HF_OK, HF_IO, HF_NO_MEMORY. */
hf_status hf_adjust_print_page(const hf_adjust_job *job, const hf_options *options, hf_messages *messages);

#endif
