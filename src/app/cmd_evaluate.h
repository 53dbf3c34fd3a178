/* cmd_evaluate - `hifdm evaluate`: a table of designs, for optimisers and surveys of the user's own.
 *
 * in : a column for each boundary cable with a free end, named by its id, in any order; optionally `id`, which names
 *      rows. One design per row: boundary pretensions in N.
 * out: id,status,psi_m,residual_N,inner_tension_ratio,boundary_tension_ratio,iterations, a row for each design in the
 *      same order, with 17 significant digits and nan where there is no value. Without an id column rows are numbered
 * from 1. */
#ifndef HIFDM_CMD_EVALUATE_H
#define HIFDM_CMD_EVALUATE_H

#include "app/options.h"

/* Evaluate options->designs into options->output, or into `file` without one; or write options->template_path, such a
 * table with the tensions after form-finding as its one row. A line for people or, with options->json, one object
 * about it goes to `file`. HF_OK also when designs are infeasible; HF_BAD_CASE for a faulty case or table, HF_EXISTS,
 * HF_IO, HF_NO_MEMORY, or the status of a form-finding that failed. */
hf_status hf_cmd_evaluate(const hf_options *options, FILE *file, hf_messages *messages);

#endif
