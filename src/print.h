/* print - what people read: summary, progress, schema. */
#ifndef HIFDM_PRINT_H
#define HIFDM_PRINT_H

#include <hifdm/summary.h>

/* The summary in a few lines. path: of the result file, or NULL. */
void hf_print_summary(const hf_summary *summary, const char *path, FILE *file);

/* One line that overwrites itself, at most some ten times a second; call for every generation with the time since the
 * start. hf_print_progress_end clears it. */
void hf_print_progress(const hf_ga *ga, double elapsed_s, FILE *file);
void hf_print_progress_end(FILE *file);

/* The reference of the case file, as a commented YAML file. */
void hf_print_schema(FILE *file);

/* "85 us", "1.3 ms", "2.7 s", "4 min 10 s" */
void hf_print_duration(double seconds, char *text, size_t size);

/* "640 B", "1.2 MB" */
void hf_print_bytes(double bytes, char *text, size_t size);

#endif
