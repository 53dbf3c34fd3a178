/* report_pattern - the far field of a shape on the page of its result. */
#ifndef HIFDM_REPORT_PATTERN_H
#define HIFDM_REPORT_PATTERN_H

#include <hifdm/pattern.h>
#include <stdio.h>

/* Writes one JSON object: stage, feed, theta_deg, and for each frequency and cut its figures and the gains at these
 * angles. When a table has more angles than a screen can show, each gain is the maximum over a few neighbouring angles.
 * Figures outside the range of the angles are null. */
void hf_report_pattern_write(const char *stage, const hf_pattern_summary *figures, const hf_pattern_table *table,
                             FILE *file);

#endif
