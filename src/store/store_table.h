/* store_table - what a report reads of a merged study: texts, names, and where links lead. */
#ifndef HIFDM_STORE_TABLE_H
#define HIFDM_STORE_TABLE_H

#include "store/store_read.h"

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

/* A data set [n] of texts of fixed length, or of unsigned 64-bit numbers, whose digits they are; n = 0 also when it is
 * of another type. */
hf_status hf_store_read_texts(const char *path, const char *name, hf_texts *texts, hf_messages *messages);

/* The names of what is in a group, sorted. */
hf_status hf_store_read_names(const char *path, const char *group, hf_texts *names, hf_messages *messages);

/* The files that the external links of a group lead to, one for each of `names`; "" where there is no such link. */
hf_status hf_store_read_links(const char *path, const char *group, const hf_texts *names, hf_texts *files,
                              hf_messages *messages);

#endif
