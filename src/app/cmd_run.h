/* cmd_run - runs the commands `hifdm run` and `hifdm tolerance`. */
#pragma once

#include "app/cmd.h"

/* Runs the case, stores its result and prints the summary. The commands differ by options->command. Returns the status
 * of hf_run_case, or HF_BAD_USAGE. */
hf_status hf_cmd_run_case(const hf_options *options, FILE *file, hf_messages *messages);
