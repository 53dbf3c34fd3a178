/* report - writes a result or a merged study as one HTML page that needs no network, server or WebGL. */
#pragma once

#include "base/json.h"
#include "out/export.h"

/* Writes the page of request->file, a result or a merged study. `other` is a second result for comparison, or NULL. The
 * page goes to request->output, or to the name of the file with the ending .html in the current folder. `said`
 * receives one line that reports what was written. The same file gives the same bytes. Returns HF_OK; HF_EXISTS unless
 * request->force; HF_IO, HF_NO_MEMORY or HF_BAD_USAGE. */
hf_status hf_report(const hf_export_request *request, const char *other, hf_messages *messages);

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

/* Writes the page of the merged study `path` to `output`: the inputs of each point, its figures, and a link to its
 * result. Returns HF_OK; HF_IO or HF_NO_MEMORY with a message. */
hf_status hf_report_study(const char *path, const char *output, hf_messages *messages);

/* The content of a page. write_data must write one JSON object, which the scripts of the page read. `answer` is shown
 * when scripts are off; it may be NULL. */
typedef struct {
    const char *title, *answer;
    void (*write_data)(const void *context, FILE *file);
    const void *context;
} hf_report_page;

/* Writes the HTML around the data of an hf_report_page. */
void hf_report_page_write(const void *page, FILE *file);

/* The page without its data, which the Makefile makes from src/out/report/: up to the end of the style, from there to
 * the data, and the script. */
extern const char hf_report_page_head[], hf_report_page_body[], hf_report_page_script[];
