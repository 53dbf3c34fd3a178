/* report - a result file as one HTML page that needs neither network nor server nor WebGL. */
#ifndef HIFDM_REPORT_H
#define HIFDM_REPORT_H

#include "out/export.h"

/* The page of request->file, a result or a merged study, beside `other`, a result to compare a result with, or NULL; to
 * request->output, or the name of the file with .html in this folder. `said`: one line for people on what was written.
 * HF_EXISTS unless request->force, HF_IO, HF_NO_MEMORY, HF_BAD_USAGE. The same file gives the same bytes. */
hf_status hf_report(const hf_export_request *request, const char *other, char *said, size_t size,
                    hf_messages *messages);

#endif
