/* report_page - the page around the data that a report shows. */
#ifndef HIFDM_REPORT_PAGE_H
#define HIFDM_REPORT_PAGE_H

#include <stdio.h>

/* The whole page: write_data writes one JSON object, which the scripts of the page read; answer is what a reader
 * without scripts sees, or NULL. */
void hf_report_page_write(const char *title, const char *answer, void (*write_data)(const void *context, FILE *file),
                          const void *context, FILE *file);

/* The page without its data, made of src/out/report/ by the Makefile: to the end of the style, from there to the data,
 * the script. */
extern const char hf_report_page_head[], hf_report_page_body[], hf_report_page_script[];

#endif
