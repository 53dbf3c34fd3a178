/* cmd_sweep - `hifdm sweep`, `status`, `merge`: the points of a study: run them, count them, merge them. */
#ifndef HIFDM_CMD_SWEEP_H
#define HIFDM_CMD_SWEEP_H

#include "app/options.h"

#include <signal.h>

/* Run the points of this task that are missing, or in the states of --retry. HF_POINTS_FAILED when some failed, which
 * stops no other; HF_INTERRUPTED when *stop_requested was seen: runs end after a generation, no point begins. */
hf_status hf_cmd_sweep(const hf_options *options, int argc, char *const *argv,
                       const volatile sig_atomic_t *stop_requested, FILE *file, hf_messages *messages);

/* How many points are in which state, and why some failed. */
hf_status hf_cmd_status(const hf_options *options, FILE *file, hf_messages *messages);

/* hf_merge of what there is. */
hf_status hf_cmd_merge(const hf_options *options, FILE *file, hf_messages *messages);

#endif
