#include "case/config_key.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Returns the number of locations of a list: each row has one, and each key of each row has one. */
static int n_location_of(const hf_list *list)
{
    return list->max_row * (1 + list->n_field);
}

int hf_key_n_location(void)
{
    int n = hf_n_field + HF_OLD_FIELDS;
    for (int i = 0; i < hf_n_list + HF_OLD_LISTS; i++)
        n += n_location_of(&hf_list_table[i]);
    return n;
}

hf_key hf_key_of_row(const hf_list *list, int row, int i_field)
{
    hf_key key = {.list = list, .row = row};
    key.field = i_field < 0 ? NULL : &list->field[i_field];
    key.offset = list->offset + (size_t)row * list->row_size + (key.field ? key.field->offset : 0);
    key.i_location = hf_n_field + HF_OLD_FIELDS + row * (1 + list->n_field) + 1 + i_field;
    for (const hf_list *before = hf_list_table; before < list; before++)
        key.i_location += n_location_of(before);
    snprintf(key.path, sizeof key.path, "%s.%d%s%s", list->path, row, key.field ? "." : "",
             key.field ? key.field->path : "");
    return key;
}

/* Finds the key or the row with this path in a list. */
static bool find_in_list(const hf_list *list, const char *path, hf_key *key)
{
    size_t n = strlen(list->path), n_digit = 0;
    if (strncmp(path, list->path, n) != 0 || path[n] != '.') return false;
    path += n + 1;
    n_digit = strspn(path, "0123456789");
    int row = n_digit && n_digit < 6 ? atoi(path) : list->max_row;
    if (row >= list->max_row || (n_digit > 1 && *path == '0')) return false; /* a row number has only one spelling */
    path += n_digit;
    for (int i = *path ? 0 : -1; i < list->n_field; i++) {
        if (i >= 0 && (*path != '.' || strcmp(path + 1, list->field[i].path) != 0)) continue;
        *key = hf_key_of_row(list, row, i);
        return true;
    }
    return false;
}

bool hf_key_find(const char *path, hf_key *key)
{
    for (int i = 0; i < hf_n_field + HF_OLD_FIELDS; i++) {
        if (strcmp(hf_field_table[i].path, path) != 0) continue;
        *key = (hf_key){.field = &hf_field_table[i], .offset = hf_field_table[i].offset, .i_location = i};
        snprintf(key->path, sizeof key->path, "%s", path);
        return true;
    }
    for (int i = 0; i < hf_n_list + HF_OLD_LISTS; i++)
        if (find_in_list(&hf_list_table[i], path, key)) return true;
    return false;
}

const hf_list *hf_key_find_list(const char *path)
{
    for (int i = 0; i < hf_n_list + HF_OLD_LISTS; i++)
        if (!strcmp(hf_list_table[i].path, path)) return &hf_list_table[i];
    return NULL;
}

int hf_key_n_row(const hf_case *settings, const hf_list *list)
{
    return *(const int *)(const void *)((const char *)settings + list->count_offset);
}
