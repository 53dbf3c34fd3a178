/* reader - runs commands that read HDF5 files in a copy of the program. HDF5 crashes on some damaged files, and no
 * check detects them beforehand. The first process waits for the copy, and reports the file that was damaged. */
#pragma once

#include "app/options.h"

/* Makes the copy. Returns false in the copy, which does the work and then ends like the program. Also returns false if
 * no copy can be made. Returns true in the first process after the copy has ended: *exit_status is then that of the
 * copy, or that of HF_IO after a message. */
bool hf_reader_watch(const hf_options *options, int *exit_status, hf_messages *messages);
