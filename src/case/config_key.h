/* config_key - the keys of a case by their paths, "form.stop", and those in rows of lists, "optimize.goals.0.set". */
#ifndef HIFDM_CONFIG_KEY_H
#define HIFDM_CONFIG_KEY_H

#include <hifdm/config.h>
#include <stdbool.h>
#include <stddef.h>

#define HF_KEY_SIZE 160 /* of a path with its NUL */

typedef struct {
    char path[HF_KEY_SIZE];
    const hf_field *field; /* its row of the table; NULL: this is a whole row, "optimize.variables.0" */
    size_t offset;         /* in hf_case */
    int i_place;           /* of its place among those of all keys, below hf_key_n_place() */
    const hf_list *list;   /* of a key of a row, or a row; else NULL */
    int row;
} hf_key;

/* Find the key, or the row, of this path. A row may be beyond those that a case has. */
bool hf_key_find(const char *path, hf_key *key);

/* Key i_field of a row of a list of the table; i_field -1: the row. */
hf_key hf_key_of_row(const hf_list *list, int row, int i_field);

/* Number of keys, and of rows, that a case can have. A key hf_field_table[i] has the place i. */
int hf_key_n_place(void);

const hf_list *hf_key_find_list(const char *path); /* or NULL */
int hf_key_n_row(const hf_case *settings, const hf_list *list);

#endif
