/* config_key - finds keys of a case by their paths, such as "form.stop", also in rows of lists
 * ("optimize.objective.0.set"). */
#pragma once

#include <hifdm/config.h>
#include <stdbool.h>
#include <stddef.h>

/* The entries of keys.md, which the Makefile embeds: pattern, description, pattern, description, ..., "". */
extern const char hf_config_help_text[];

#define HF_KEY_SIZE 160 /* maximum size of a path with its NUL */

/* Old keys and lists, which stand behind the others in the tables. They are read and converted (config_rename.h), and
 * no list of keys has them. */
enum { HF_OLD_FIELDS = 2, HF_OLD_LISTS = 1 };

typedef struct {
    char path[HF_KEY_SIZE];
    const hf_field *field; /* its row of the table; NULL: a whole row such as "optimize.variables.0" */
    size_t offset;         /* offset in hf_case */
    int i_location;        /* index of its location, below hf_key_n_location() */
    const hf_list *list;   /* list of a row or of a key in a row, else NULL */
    int row;
} hf_key;

/* Finds the key or the row with this path. The row may be beyond the rows that a case has. */
bool hf_key_find(const char *path, hf_key *key);

/* Returns key i_field of a row of a list in the table; with i_field -1, the row itself. */
hf_key hf_key_of_row(const hf_list *list, int row, int i_field);

/* Returns the number of keys and rows that a case can have. It is the number of locations; a key hf_field_table[i] has
 * the location i. */
int hf_key_n_location(void);

const hf_list *hf_key_find_list(const char *path); /* NULL if there is none */
int hf_key_n_row(const hf_case *settings, const hf_list *list);
