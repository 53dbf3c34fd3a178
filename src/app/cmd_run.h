/* cmd_run - what `hifdm run` does, and `hifdm tolerance`. */
#ifndef HIFDM_CMD_RUN_H
#define HIFDM_CMD_RUN_H

#include "app/cmd.h"

/* Run the case, store and print its result. The commands differ by options->command. */
hf_status hf_cmd_run_case(const hf_options *options, FILE *file, hf_messages *messages);

#endif
