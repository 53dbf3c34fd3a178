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

/* ---- keys with faults: after the locations stands a list of texts that ends with an empty one ---- */

/* The first letter of such a text: what was not read must not be compared; the rest was read and does not fit. */
enum { UNREAD = '-', UNFIT = '!' };

static bool is_inside(const char *path, const char *outer)
{
    size_t n = strlen(outer);
    return n == 0 || (!strncmp(path, outer, n) && (path[n] == '\0' || path[n] == '.'));
}

/* Notes a fault. If the list is full, no key counts as read. */
static void note(char *where_given, char kind, const char *path)
{
    if (!where_given) return;
    char *start = where_given + (size_t)hf_key_n_location() * HF_CONFIG_WHERE_SIZE, *end = start;
    while (*end)
        end += strlen(end) + 1;
    size_t left = HF_CONFIG_FAULTY_SIZE - (size_t)(end - start);
    if (left > strlen(path) + 5)
        snprintf(end, left, "%c%s", kind, path);
    else if (left > 2)
        snprintf(end, left, "%c", UNREAD);
}

static bool has_fault(const hf_case *c, bool of_unread, const char *path_format, va_list arguments)
{
    char path[HF_KEY_SIZE];
    if (!c->where_given) return true;
    vsnprintf(path, sizeof path, path_format, arguments);
    const char *one = c->where_given + (size_t)hf_key_n_location() * HF_CONFIG_WHERE_SIZE;
    for (; *one; one += strlen(one) + 1)
        if ((*one == UNREAD || !of_unread) && (is_inside(path, one + 1) || is_inside(one + 1, path))) return true;
    return false;
}

void hf_config_note_unread(hf_config_faults *faults, const char *path)
{
    note(faults->where_given, UNREAD, path);
}

bool hf_config_is_read(const hf_case *c, const char *path_format, ...)
{
    va_list arguments;
    va_start(arguments, path_format);
    bool has = has_fault(c, true, path_format, arguments);
    va_end(arguments);
    return !has;
}

bool hf_config_is_sound(const hf_case *c, const char *path_format, ...)
{
    va_list arguments;
    va_start(arguments, path_format);
    bool has = has_fault(c, false, path_format, arguments);
    va_end(arguments);
    return !has;
}

/* ---- messages ---- */

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
    note(faults->where_given, UNFIT, path);
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
