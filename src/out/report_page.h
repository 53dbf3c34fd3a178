/* report_page - the HTML around the data of a report. */
#ifndef HIFDM_REPORT_PAGE_H
#define HIFDM_REPORT_PAGE_H

#include <stdio.h>

/* Writes the whole page. write_data must write one JSON object, which the scripts of the page read. `answer` is shown
 * when scripts are off; it may be NULL. */
void hf_report_page_write(const char *title, const char *answer, void (*write_data)(const void *context, FILE *file),
                          const void *context, FILE *file);

/* The page without its data, which the Makefile makes from src/out/report/: up to the end of the style, from there to
 * the data, and the script. */
extern const char hf_report_page_head[], hf_report_page_body[], hf_report_page_script[];

#endif
