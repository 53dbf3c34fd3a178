/* help - what `hifdm help` prints: overview, one command, manual page, completion for bash; all from the tables of
 * options and config_table, so that nothing is written down twice. */
#ifndef HIFDM_HELP_H
#define HIFDM_HELP_H

#include "app/options.h"

/* options->topic and options->help_as say what. Write errors stay with the stream. */
void hf_help(const hf_options *options, FILE *file);

#endif
