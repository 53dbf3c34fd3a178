/* config_fault - faults of a case, each with its location: file, line and column, or the --set argument. */
#pragma once

#include "case/config_key.h"

#define HF_CONFIG_WHERE_SIZE 64
#define HF_CONFIG_FAULTY_SIZE 4096 /* bytes behind the locations of where_given, for the keys with faults */

typedef struct {
    hf_messages *messages;
    const char *path;     /* path of the case file */
    const char *origin;   /* what is being read: the case file, or a --set argument */
    bool is_override;     /* true: a --set argument is being read */
    const char *location; /* location of a value that is only checked, for messages; NULL otherwise */
    char *where_given;    /* [hf_key_n_location()][HF_CONFIG_WHERE_SIZE], "line:col", "--set" or "" of keys and rows */
    bool failed;
    int n; /* faults reported by hf_config_fault_at; those beyond HF_FAULT_MAX_CASE are only counted */
} hf_config_faults;

/* Reports a fault at line and column of the text that is being read, counted from 0: "<path>: <what><detail>". */
void hf_config_fault_at(hf_config_faults *faults, size_t line, size_t column, const char *path, const char *what,
                        const char *detail);

/* Reports a fault of several keys or of a missing key. The message contains the location of the key if the
 * case contains it. */
void hf_config_fault_of(hf_config_faults *faults, const char *path, const char *what);

/* Notes that the values of a key, a row or a section cannot be used, because they are missing or were rejected. */
void hf_config_note_unread(hf_config_faults *faults, const char *path);

/* Returns true if all values of this key, row or section were read, so that they can be compared with others. */
bool hf_config_is_read(const hf_case *settings, const char *path_format, ...) HF_PRINTF(2, 3);

/* Returns true if no fault of this key, row or section was reported. */
bool hf_config_is_sound(const hf_case *settings, const char *path_format, ...) HF_PRINTF(2, 3);

/* Reports a fault of a key in a row, such as key "set" of row 0 of the list "optimize.objective". */
void hf_config_fault_in_row(hf_config_faults *faults, const char *list, int row, const char *key, const char *what);

/* Writes the location of a key to `place`, for the beginning of a message (hf_config_location). `key_format` is a
 * format of the key, such as "cables.%d.set". Returns `place`. */
const char *hf_config_place(const hf_case *settings, char place[HF_LOCATION_SIZE], const char *key_format, ...)
    HF_PRINTF(3, 4);

/* Return true if the case contains this key. */
bool hf_config_is_given(const hf_config_faults *faults, const char *path);
bool hf_config_is_given_in_row(const hf_config_faults *faults, const char *list, int row, const char *key);

/* Returns the location with index i_location, "" if it is not given. A key hf_field_table[i] has the index i. */
static inline char *hf_config_where(const hf_config_faults *faults, int i_location)
{
    return faults->where_given + (size_t)i_location * HF_CONFIG_WHERE_SIZE;
}
