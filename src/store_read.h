/* store_read - the reading half of what <hifdm/store.h> declares, and what a report reads besides. */
#ifndef HIFDM_STORE_READ_H
#define HIFDM_STORE_READ_H

#include <hifdm/store.h>

/* A data set of numbers of any kind, one or `columns` per row. */
typedef struct {
    int n;         /* rows; 0 = the file has none of this name, or an empty one */
    double *value; /* [n][columns] */
    void *block;
} hf_series;

/* name: from the root, like "/form/history/psi_m". HF_OK also when there is none; else as the calls of store.h. Free
 * with hf_series_free in any case. */
hf_status hf_store_read_series(const char *path, const char *name, int columns, hf_series *series,
                               hf_messages *messages);
void hf_series_free(hf_series *series);

/* Where the file comes from, as lines "key: value" in the order of the file's root; those that a program before this
 * one did not write in a safe way are left out. */
hf_status hf_store_read_provenance(const char *path, char *text, size_t size, hf_messages *messages);

#endif
