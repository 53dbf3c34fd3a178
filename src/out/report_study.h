/* report_study - the page of a merged study: the inputs of each point, its figures, and a link to its result. */
#ifndef HIFDM_REPORT_STUDY_H
#define HIFDM_REPORT_STUDY_H

#include <hifdm/status.h>

/* Writes the page of the merged study `path` to `output`. Returns HF_OK; HF_IO or HF_NO_MEMORY with a message. */
hf_status hf_report_study(const char *path, const char *output, hf_messages *messages);

#endif
