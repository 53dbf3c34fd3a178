/* store_series - any data set of a result file or of a merged study by its name, as numbers or as texts; what a group
 * holds and where its links lead. Reports read by this. */
#ifndef HIFDM_STORE_SERIES_H
#define HIFDM_STORE_SERIES_H

#include "store/store_read.h"

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

/* n texts of the same length, each ending in a NUL. */
typedef struct {
    int n;
    size_t length; /* of each, with its NUL */
    char *text;    /* [n][length] */
    void *block;
} hf_texts;

const char *hf_texts_at(const hf_texts *texts, int i);
void hf_texts_free(hf_texts *texts);

/* All three: names from the root, HF_OK with n = 0 when there is no such thing; else HF_IO or HF_NO_MEMORY, with a
 * message. Free with hf_texts_free in any case. */

/* A data set [n] of texts of fixed length (a single text counts as [1]), or of unsigned 64-bit numbers, whose
 * digits they are; n = 0 also when it is of another type. */
hf_status hf_store_read_texts(const char *path, const char *name, hf_texts *texts, hf_messages *messages);

/* The names of what is in a group, sorted. */
hf_status hf_store_read_names(const char *path, const char *group, hf_texts *names, hf_messages *messages);

/* The files that the external links of a group lead to, one for each of `names`; "" where there is no such link. */
hf_status hf_store_read_links(const char *path, const char *group, const hf_texts *names, hf_texts *files,
                              hf_messages *messages);

#endif
