/* store_read - opens a result file, and reads what the program needs in addition to <hifdm/store.h>. */
#pragma once

#include "store/layout.h"
#include <hifdm/store.h>

/* Writes the provenance of the file into text[size], as lines "key: value". Attributes of variable length, which
 * earlier versions wrote, are left out. Errors as in <hifdm/store.h>. */
hf_status hf_store_read_provenance(const char *path, char *text, size_t size, hf_messages *messages);

/* Reads the case that the file was made from. path: of the case; the files that it names are looked up beside it.
 * Returns false after a failure, or if this version does not know all keys of the case. The caller calls hf_case_free
 * in any case. */
bool hf_store_parse_case(hf_hdf5 *io, const char *path, hf_case *settings);

/* Reads the case with the path of the result in place of its own. Keys that this version does not know are damage. */
void hf_store_read_case(hf_hdf5 *io, hf_case *settings);

/* hf_store_read_finished reads a summary like hf_store_read_summary. If the content of the file is at fault, and not
 * the machine, it returns HF_EXISTS with a hint. hf_store_fail_damaged returns HF_EXISTS with this hint. */
hf_status hf_store_read_finished(const char *path, hf_summary *summary, hf_messages *messages);
hf_status hf_store_fail_damaged(const char *path, hf_messages *messages);

/* hf_store_open_result takes the lock of HDF5 and opens a result file of hifdm to read. The status of the returned
 * hf_hdf5 says whether it is open. hf_store_close_result follows in any case; it closes the file, releases the lock and
 * returns the status. */
hf_hdf5 hf_store_open_result(const char *path, hf_messages *messages);
hf_status hf_store_close_result(hf_hdf5 *io);
