/* store_read - reads from a result file what the program needs in addition to <hifdm/store.h>. */
#pragma once

#include "store/layout.h"
#include "store/store_open.h"
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

/* Reads a summary like hf_store_read_summary. If the content of the file is at fault, and not the machine, the function
 * returns HF_EXISTS with the hint of hf_store_fail_damaged. */
hf_status hf_store_read_finished(const char *path, hf_summary *summary, hf_messages *messages);
