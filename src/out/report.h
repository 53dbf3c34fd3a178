/* report - a result file as one HTML page that needs neither network nor server nor WebGL. */
#ifndef HIFDM_REPORT_H
#define HIFDM_REPORT_H

#include "out/export.h"

/* request->file, a result or a merged study -> request->output, or the name of the file with .html in this folder.
 * `said`: one line for people on what was written. HF_EXISTS unless request->force, HF_IO, HF_NO_MEMORY. The same file
 * gives the same bytes. */
hf_status hf_report(const hf_export_request *request, char *said, size_t size, hf_messages *messages);

/* ---- between report and report_study ---- */

/* The whole page: write_data writes one JSON object. */
void hf_report_write(const char *title, void (*write_data)(const void *context, FILE *file), const void *context,
                     FILE *file);

int hf_report_is_study(const char *path); /* a file with a table of points; says nothing about any other */
hf_status hf_report_study(const char *path, const char *output, hf_messages *messages);

/* The page without its data, made of src/report/ by the Makefile: to the end of the style, from there to the data, the
 * script. */
extern const char hf_report_page_head[], hf_report_page_body[], hf_report_page_script[];

#endif
