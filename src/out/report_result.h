/* report_result - the page of one result: summary, net and shapes, histories, truss. */
#ifndef HIFDM_REPORT_RESULT_H
#define HIFDM_REPORT_RESULT_H

#include <hifdm/status.h>

/* Writes the page of the result file `path` to `output`, beside the result `other` unless that is NULL.
 * HF_OK, HF_IO or HF_NO_MEMORY with a message. */
hf_status hf_report_result(const char *path, const char *other, const char *output, hf_messages *messages);

#endif
