/* print - what people read: the summary of a result, durations and sizes with units. */
#ifndef HIFDM_PRINT_H
#define HIFDM_PRINT_H

#include <hifdm/summary.h>

/* The summary in a few lines. path: of the result file, or NULL. */
void hf_print_summary(const hf_summary *summary, const char *path, FILE *file);

/* "85 us", "1.3 ms", "2.7 s", "4 min 10 s" */
void hf_print_duration(double seconds, char *text, size_t size);

/* "640 B", "1.2 MB" */
void hf_print_bytes(double bytes, char *text, size_t size);

#endif
