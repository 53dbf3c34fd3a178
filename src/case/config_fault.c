#include "case/config_fault.h"

#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void hf_config_fault_at(hf_config_faults *faults, size_t line, size_t column, const char *path, const char *what,
                        const char *detail)
{
    char where[48] = "";
    faults->failed = true;
    if (++faults->n > HF_FAULT_MAX_CASE) return;
    if (!faults->location && !faults->is_override) snprintf(where, sizeof where, ":%zu:%zu", line + 1, column + 1);
    hf_error(faults->messages, HF_BAD_CASE, "%s%s%s: %s: %s%s", faults->is_override ? "--set " : "", faults->origin,
             where, path, what, detail);
}

/* Writes "FILE:LINE:COLUMN: KEY", with the line of the key, or else that of its row, or neither; "--set KEY" for a key
 * of the command line. Returns true if the case contains the key. */
static bool write_location(const char *where_given, const char *file, const char *path, char *text, size_t size)
{
    hf_key key = {0};
    const char *where = "";
    if (where_given && hf_key_find(path, &key)) where = where_given + (size_t)key.i_location * HF_CONFIG_WHERE_SIZE;
    bool is_given = *where != '\0';
    if (!is_given && key.list)
        where = where_given + (size_t)hf_key_of_row(key.list, key.row, -1).i_location * HF_CONFIG_WHERE_SIZE;
    if (!strcmp(where, "--set"))
        snprintf(text, size, "--set %s", path);
    else
        snprintf(text, size, "%s:%s%s %s", file, where, *where ? ":" : "", path);
    return is_given;
}

bool hf_config_location(const hf_case *c, const char *key, char *text, size_t size)
{
    return write_location(c->where_given, c->path, key, text, size);
}

const char *hf_config_place(const hf_case *c, char place[HF_LOCATION_SIZE], const char *key_format, ...)
{
    char key[HF_KEY_SIZE];
    va_list arguments;
    va_start(arguments, key_format);
    vsnprintf(key, sizeof key, key_format, arguments);
    va_end(arguments);
    hf_config_location(c, key, place, HF_LOCATION_SIZE);
    return place;
}

void hf_config_fault_of(hf_config_faults *faults, const char *path, const char *what)
{
    char location[HF_PATH_SIZE + HF_CONFIG_WHERE_SIZE + HF_KEY_SIZE];
    write_location(faults->where_given, faults->path, path, location, sizeof location);
    faults->failed = true;
    hf_error(faults->messages, HF_BAD_CASE, "%s: %s", location, what);
}

void hf_config_fault_in_row(hf_config_faults *f, const char *list, int row, const char *key, const char *what)
{
    char path[HF_KEY_SIZE];
    snprintf(path, sizeof path, "%s.%d.%s", list, row, key);
    hf_config_fault_of(f, path, what);
}

bool hf_config_is_given(const hf_config_faults *f, const char *path)
{
    hf_key key;
    return hf_key_find(path, &key) && *hf_config_where(f, key.i_location);
}

bool hf_config_is_given_in_row(const hf_config_faults *f, const char *list, int row, const char *key)
{
    char path[HF_KEY_SIZE];
    snprintf(path, sizeof path, "%s.%d.%s", list, row, key);
    return hf_config_is_given(f, path);
}
