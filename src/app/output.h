/* output - what the program says to a reader that may have stopped to read: a request to stop (base/signals.h) is heard
 * while it waits. */
#ifndef HIFDM_OUTPUT_H
#define HIFDM_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Write all of the text to a descriptor. 0, or -1 with errno: EINTR when the program was told to stop and nobody
 * reads. */
int hf_output_write(int file, const char *text, size_t n);

/* May colours go there? To terminals alone, and not where the user wants none (NO_COLOR, or TERM is dumb). */
bool hf_output_has_colour(int file);

/* A stream that writes so to standard output; the one of stdio when there is no memory for it. */
FILE *hf_output_stream(void);

#endif
