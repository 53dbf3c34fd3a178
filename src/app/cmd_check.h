/* cmd_check - `hifdm check`: validate a case and say what a run of it would do, without running the optimisation. */
#ifndef HIFDM_CMD_CHECK_H
#define HIFDM_CMD_CHECK_H

#include "app/options.h"

/* Prints the plan on `file`. HF_OK; HF_BAD_CASE with all faults; an ill-posed status when the trial finds the scene
 * ill-posed. A form-finding that would take long is tried for about a second only. */
hf_status hf_cmd_check(const hf_options *options, FILE *file, hf_messages *messages);

#endif
