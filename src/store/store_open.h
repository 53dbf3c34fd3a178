/* store_open - opens a result file to read. */
#pragma once

#include "store/hdf5.h"

/* hf_store_open_result takes the lock of HDF5 and opens a result file of hifdm to read. The status of the returned
 * hf_hdf5 says whether it is open. hf_store_close_result follows in any case; it closes the file, releases the lock and
 * returns the status. */
hf_hdf5 hf_store_open_result(const char *path, hf_messages *messages);
hf_status hf_store_close_result(hf_hdf5 *io);

/* Returns HF_EXISTS. The message says that the file is damaged or of another version, and how to replace it. */
hf_status hf_store_fail_damaged(const char *path, hf_messages *messages);
