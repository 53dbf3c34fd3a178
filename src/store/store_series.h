/* store_series - reads any data set of a result file or of a merged study by its name, as numbers or as texts. It also
 * lists the names and the external links of a group. Reports use it. */
#pragma once

#include "store/store_read.h"

/* A data set of numbers of any kind, enumerations included. */
typedef struct {
    int n; /* rows; 0 = there is no data set of this name, or it is empty */
    int columns;
    double *value; /* [n][columns], owned */
} hf_series;

/* Reads a data set of numbers. name: from the root, such as "/form/history/psi_m". columns: expected number of columns,
 * 0 = any. Returns HF_OK also if there is no such data set; after a failure as the calls of store.h. The caller calls
 * hf_series_free in any case. */
hf_status hf_store_read_series(const char *path, const char *name, int columns, hf_series *series,
                               hf_messages *messages);
void hf_series_free(hf_series *series);

/* n texts in rows of the same length, each ending with a NUL. */
typedef struct {
    int n;
    size_t length; /* bytes of each row, NUL included */
    char *text;    /* [n][length], owned */
} hf_texts;

const char *hf_texts_at(const hf_texts *texts, int i);
void hf_texts_free(hf_texts *texts);

/* The three calls below take names from the root. If there is no such object, they return HF_OK with n = 0. After a
 * failure they return HF_IO or HF_NO_MEMORY with a message. The caller calls hf_texts_free in any case. */

/* Reads a data set [n] of texts of fixed length; a scalar text counts as [1]. Unsigned 64-bit numbers are read as their
 * digits. A data set of another type gives n = 0. */
hf_status hf_store_read_texts(const char *path, const char *name, hf_texts *texts, hf_messages *messages);

/* Reads the names of the links in a group, sorted. */
hf_status hf_store_read_names(const char *path, const char *group, hf_texts *names, hf_messages *messages);

/* Reads the files that the external links of a group lead to, one for each of `names`; "" if there is no such link. */
hf_status hf_store_read_links(const char *path, const char *group, const hf_texts *names, hf_texts *files,
                              hf_messages *messages);
