/* reader - commands that read files of HDF5 do so in a copy of the program: HDF5 crashes on some damaged files, which
 * no check can know before. The first process waits, and tells which file it was. */
#ifndef HIFDM_READER_H
#define HIFDM_READER_H

#include "app/options.h"

/* False in the copy, which is to do the work and to end as the program does; there, too, when no copy can be made. True
 * in the first process, when the copy has ended: *exit_status is that of the copy, or 5 with a message. */
bool hf_reader_watch(const hf_options *options, int *exit_status, hf_messages *messages);

#endif
