/* store_read - opening a result file, and what the program reads in addition to <hifdm/store.h>. */
#ifndef HIFDM_STORE_READ_H
#define HIFDM_STORE_READ_H

#include "store/layout.h"
#include <hifdm/store.h>

/* The provenance of the file, as lines "key: value". Attributes of variable length, from older versions of the program,
 * are left out. */
hf_status hf_store_read_provenance(const char *path, char *text, size_t size, hf_messages *messages);

/* The case that the file was made from; false when this version does not know all its keys. path: of the case, beside
 * which the files that it names are looked for. Free it with hf_case_free in any case. */
bool hf_store_parse_case(hf_hdf5 *io, const char *path, hf_case *settings);

/* The same, with the result's own path; keys that this version does not know are damage. */
void hf_store_read_case(hf_hdf5 *io, hf_case *settings);

/* As hf_store_read_summary. HF_EXISTS, with a hint, if the content of the file is at fault, and not the machine. */
hf_status hf_store_read_finished(const char *path, hf_summary *summary, hf_messages *messages);
hf_status hf_store_fail_damaged(const char *path, hf_messages *messages);

/* A file of ours, open for reading; its status says whether. The caller closes it in any case. */
hf_hdf5 hf_store_open_result(const char *path, hf_messages *messages);

#endif
