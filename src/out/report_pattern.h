/* report_pattern - the far field of a shape on the page of its result. */
#ifndef HIFDM_REPORT_PATTERN_H
#define HIFDM_REPORT_PATTERN_H

#include <hifdm/pattern.h>
#include <stdio.h>

/* One JSON object: stage, feed, theta_deg, and of each frequency and cut its figures and the gain at these angles. Of a
 * table with more angles than a screen can show it has the highest gain of each few neighbours. Figures that the angles
 * do not reach are null. */
void hf_report_pattern_write(const char *stage, const hf_pattern_summary *figures, const hf_pattern_table *table,
                             FILE *file);

#endif
