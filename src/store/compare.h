/* compare - compares two HDF5 files, data set by data set.
 *
 * Attributes are not compared. They hold times, the machine and the provenance, which differ between two runs of the
 * same case, and a summary of the data sets. If both files are results, the group /VTKHDF is not compared either,
 * because it follows from the other groups. */
#pragma once

#include <hifdm/status.h>

typedef struct {
    /* Two real numbers a and b are equal if |a - b| <= atol + rtol |b|. If both tolerances are 0, they are equal if all
     * their bits are equal or if both are NaN. Values of all other types must be equal exactly. */
    double rtol, atol;
    /* Numbers of data sets: all of them, and those that differ or that only one file has. */
    int n_data_set, n_different;
} hf_comparison;

/* Receives one data set that differs: its path, and a text with the first difference or with the reason why the values
 * cannot be compared. */
typedef void hf_compare_tell(void *context, const char *path, const char *how);

/* Compares the files a and b, and calls `tell` for each data set that differs. The caller sets the tolerances of
 * *comparison; the function sets its counts. Returns HF_OK if all data sets are equal within the tolerances, and
 * HF_DIFFERENT if not. Errors: HF_IO if a file cannot be read, HF_NO_MEMORY. */
hf_status hf_compare_files(const char *a, const char *b, hf_comparison *comparison, hf_compare_tell *tell,
                           void *context, hf_messages *messages);
