/* output - writes to readers that may have stopped reading. A request to stop (base/signals.h) is noticed while the
 * program waits for such a reader. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Writes all of the text [n] to a descriptor. Returns 0, or -1 with errno. errno is EINTR if the program was asked to
 * stop and nobody reads. */
int hf_output_write(int file, const char *text, size_t n);

/* Returns true if colours may be written there: to terminals only, and not if the user does not want any (NO_COLOR is
 * set, or TERM is dumb). */
bool hf_output_has_colour(int file);

/* Returns a stream that writes in this way to standard output, or stdout itself if memory runs out. */
FILE *hf_output_stream(void);
