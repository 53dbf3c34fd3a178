/* config_rename - the names of keys and words before version 0.3. */
#pragma once

#include "case/config_fault.h"

/* Writes the new name of a key, "optimize.goals.0.goal", or of a key with its word, "adjust.aim=theory", into `now`.
 * If `old` is an old name, warns once with the line and the column, counted from 0, and returns true. Otherwise `now`
 * is a copy. */
bool hf_config_rename(hf_config_faults *faults, size_t line, size_t column, const char *old, char now[HF_KEY_SIZE]);

/* Writes the name that a key, or a key with its word, had in version 0.2. */
void hf_config_old_name(const char *now, char old[HF_KEY_SIZE]);
