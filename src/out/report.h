/* report - writes a result or a merged study as one HTML page that needs no network, server or WebGL. */
#ifndef HIFDM_REPORT_H
#define HIFDM_REPORT_H

#include "out/export.h"

/* Writes the page of request->file, a result or a merged study. `other` is a second result for comparison, or NULL. The
 * page goes to request->output, or to the name of the file with the ending .html in the current folder. said [size]
 * receives one line that reports what was written. The same file gives the same bytes. Returns HF_OK; HF_EXISTS unless
 * request->force; HF_IO, HF_NO_MEMORY or HF_BAD_USAGE. */
hf_status hf_report(const hf_export_request *request, const char *other, char *said, size_t size,
                    hf_messages *messages);

#endif
