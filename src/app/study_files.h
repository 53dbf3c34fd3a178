/* study_files - finds and reads the files of a study, for the commands sweep, status, merge and check: the study itself
 * and the state of its points. */
#pragma once

#include "app/options.h"
#include "store/ledger.h"

/* Sets `name` to `given` or, if that is NULL, to the name of the study with another ending, in the current folder.
 * Returns HF_OK or HF_IO. */
hf_status hf_study_files_name(const char *given, const char *study, const char *ending, char name[HF_PATH_SIZE],
                              hf_messages *messages);

/* Finds the folder of the results, and reads the study o->file and the state of its points. Without the folder, all
 * points are missing or, with demand_folder, the status is HF_IO. Returns HF_OK or the status of the failure. Free
 * study and points in any case. */
hf_status hf_study_files_read(const hf_options *o, bool demand_folder, char folder[HF_PATH_SIZE], hf_study *study,
                              hf_points *points, hf_messages *messages);
