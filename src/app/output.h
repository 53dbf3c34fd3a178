/* output - checks the names of results and of output files, and writes to readers that may have stopped reading. A
 * request to stop (base/signals.h) is noticed while the program waits for such a reader. */
#pragma once

#include "app/options.h"
#include <hifdm/problem.h>

#define HF_OUTPUT_CLEAR_LINE "\r\033[K" /* clears the line of a terminal on which the progress is */

/* Checks the name of an output before the work begins; `path` may be NULL. Refuses a file that exists unless
 * options->force, that is an input (`table`, options->result, or one of the case), or that cannot be written. Returns
 * HF_OK, HF_EXISTS or HF_IO. */
hf_status hf_output_check(const hf_options *options, const hf_problem *problem, const char *table, const char *path,
                          hf_messages *messages);

/* Refuses an input that is a case or a study by its name, and prints which command to use. Returns HF_OK or HF_IO. */
hf_status hf_output_refuse_case(const char *file, hf_messages *messages);

/* Writes all of the text [n] to a descriptor. Returns 0, or -1 with errno. errno is EINTR if the program was asked to
 * stop and nobody reads. */
int hf_output_write(int file, const char *text, size_t n);

/* Returns true if colours may be written there: to terminals only, and not if the user does not want any (NO_COLOR is
 * set, or TERM is dumb). */
bool hf_output_has_colour(int file);

/* Returns a stream that writes in this way to standard output, or stdout itself if memory runs out. */
FILE *hf_output_stream(void);
