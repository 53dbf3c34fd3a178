#include "case/config_fault.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

void hf_config_fault_at(hf_config_faults *faults, size_t line, size_t column, const char *path, const char *what,
                        const char *detail)
{
    faults->failed = true;
    if (++faults->n > HF_FAULT_MAX_CASE) return;
    if (faults->place)
        hf_error(faults->messages, HF_BAD_CASE, "%s: %s: %s%s", faults->place, path, what, detail);
    else if (faults->is_override)
        hf_error(faults->messages, HF_BAD_CASE, "--set %s: %s: %s%s", faults->origin, path, what, detail);
    else
        hf_error(faults->messages, HF_BAD_CASE, "%s:%zu:%zu: %s: %s%s", faults->origin, line + 1, column + 1, path,
                 what, detail);
}

bool hf_config_place(const hf_case *c, const char *key, char *text, size_t size)
{
    const char *where = "";
    for (int i = 0; c->where_given && i < hf_n_field; i++)
        if (!strcmp(hf_field_table[i].path, key)) where = c->where_given + (size_t)i * HF_CONFIG_WHERE_SIZE;
    if (!strcmp(where, "--set"))
        snprintf(text, size, "--set %s", key);
    else
        snprintf(text, size, "%s:%s%s %s", c->path, where, *where ? ":" : "", key);
    return *where != '\0';
}

void hf_config_fault_of(hf_config_faults *faults, const char *path, const char *what)
{
    const char *where = "";
    for (int i = 0; i < hf_n_field; i++)
        if (!strcmp(hf_field_table[i].path, path)) where = hf_config_where(faults, i);
    faults->failed = true;
    if (!strcmp(where, "--set"))
        hf_error(faults->messages, HF_BAD_CASE, "--set %s: %s", path, what);
    else
        hf_error(faults->messages, HF_BAD_CASE, "%s:%s%s %s: %s", faults->path, where, *where ? ":" : "", path, what);
}
