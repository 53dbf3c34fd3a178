/* compare - two result files, data set by data set. Attributes are not compared: they hold times, machine and
 * provenance, which differ between two runs of the same case, and a summary of what is in the data sets. Nor is /VTKHDF
 * of two results, which follows from the rest of each. */
#ifndef HIFDM_COMPARE_H
#define HIFDM_COMPARE_H

#include <hifdm/status.h>

typedef struct {
    double rtol, atol; /* numbers a, b are equal when |a - b| <= atol + rtol |b|; both 0: to the last bit, NaN = NaN */
    int n_data_set, n_different;
} hf_comparison;

/* Called for each data set that differs, with its path and a text: the first difference, or that it is missing. */
typedef void hf_compare_tell(void *context, const char *path, const char *how);

/* HF_OK: all are equal within the tolerances; HF_DIFFERENT; HF_IO when a file cannot be read; HF_NO_MEMORY. */
hf_status hf_compare_files(const char *a, const char *b, hf_comparison *comparison, hf_compare_tell *tell,
                           void *context, hf_messages *messages);

#endif
