/* report_result - the page of one result: summary, net and shapes, histories, truss. */
#ifndef HIFDM_REPORT_RESULT_H
#define HIFDM_REPORT_RESULT_H

#include "base/file_out.h"
#include "base/json.h"
#include <hifdm/status.h>

/* Describes what a command adds to the page of a result. `write` writes the members of the object `key` in the data of
 * the page. */
typedef struct {
    const char *key;
    void (*write)(const void *context, hf_json *json);
    const void *context;
    hf_file_out_set *files; /* files of the command, which the page joins */
} hf_report_part;

/* Writes the page of the result file `path` to `output`. `other` is a result for comparison, `part` an addition; both
 * may be NULL. Returns HF_OK; HF_IO or HF_NO_MEMORY with a message. */
hf_status hf_report_result(const char *path, const char *other, const hf_report_part *part, const char *output,
                           hf_messages *messages);

#endif
