/* config_fault - the faults of a case, each with its place: file, line and column, or the --set argument. */
#ifndef HIFDM_CONFIG_FAULT_H
#define HIFDM_CONFIG_FAULT_H

#include "case/config_key.h"

#define HF_CONFIG_WHERE_SIZE 64

typedef struct {
    hf_messages *messages;
    const char *path;   /* of the case file */
    const char *origin; /* what is being read: the case file, or a --set argument */
    bool is_override;   /* the latter */
    const char *place;  /* of a value that is only checked: messages give it instead of origin, line and column */
    char
        *where_given; /* [hf_key_n_place()][HF_CONFIG_WHERE_SIZE] places of keys and rows: "line:col", "--set", or "" */
    bool failed;
    int n; /* faults reported by hf_config_fault_at; those beyond HF_FAULT_MAX_CASE are only counted */
} hf_config_faults;

/* Report a fault of what is read at this place, which counts from 0: "<path>: <what><detail>". */
void hf_config_fault_at(hf_config_faults *faults, size_t line, size_t column, const char *path, const char *what,
                        const char *detail);

/* Report a fault of several keys, or a missing key, with the place of the key when the case contains it. */
void hf_config_fault_of(hf_config_faults *faults, const char *path, const char *what);

/* The same of a key of a row: list "optimize.goals", key "set". */
void hf_config_fault_in_row(hf_config_faults *faults, const char *list, int row, const char *key, const char *what);

/* Does the case give this key? */
bool hf_config_is_given(const hf_config_faults *faults, const char *path);
bool hf_config_is_given_in_row(const hf_config_faults *faults, const char *list, int row, const char *key);

/* Place i_place of hf_key: hf_field_table[i] has the place i; "" when it is not given. */
static inline char *hf_config_where(const hf_config_faults *faults, int i_place)
{
    return faults->where_given + (size_t)i_place * HF_CONFIG_WHERE_SIZE;
}

#endif
