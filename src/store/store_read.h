/* store_read - the reading half of what <hifdm/store.h> declares, and what a report reads besides. */
#ifndef HIFDM_STORE_READ_H
#define HIFDM_STORE_READ_H

#include "store/hdf5_io.h"
#include <hifdm/store.h>

/* A data set of numbers of any kind, enumerations too. */
typedef struct {
    int n; /* rows; 0 = the file has none of this name, or an empty one */
    int columns;
    double *value; /* [n][columns] */
    void *block;
} hf_series;

/* name: from the root, like "/form/history/psi_m"; columns 0 = as it has. HF_OK also when there is none; else as the
 * calls of store.h. Free with hf_series_free in any case. */
hf_status hf_store_read_series(const char *path, const char *name, int columns, hf_series *series,
                               hf_messages *messages);
void hf_series_free(hf_series *series);

/* Where the file comes from, as lines "key: value" in the order of the file's root; those that a program before this
 * one did not write in a safe way are left out. */
hf_status hf_store_read_provenance(const char *path, char *text, size_t size, hf_messages *messages);

/* The case that the file was made from. Free it with hf_case_free in any case. */
void hf_store_read_case(hf_hdf5 *io, hf_case *settings);

/* More nodes or members than any scene has; keeps a damaged file from asking for all memory. */
#define HF_STORE_COUNT_MAX 20000000

/* A file of ours, open for reading; its status says whether. The caller closes it in any case. */
hf_hdf5 hf_store_open_result(const char *path, hf_messages *messages);

/* The n and m ids of two data sets, set in id_a and id_b, and the block that they point into (caller frees). */
void hf_store_read_ids(hf_hdf5 *io, hid_t group, const char *name_a, int n, const char **id_a, const char *name_b,
                       int m, const char **id_b, void **text);

/* Is there something of this name? From the root; HDF5 has to be asked for every group on the way. */
int hf_store_is_there(hf_hdf5 *io, const char *name);

#endif
