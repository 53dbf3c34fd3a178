/* print_summary - parts of hf_print_summary, which a page shows too or other files write. */
#ifndef HIFDM_PRINT_SUMMARY_H
#define HIFDM_PRINT_SUMMARY_H

#include "out/print.h"

/* What the result is good for, in one line without its end: psi or goals, gained over what, good to how many GHz.
 * Before it, of a run that failed after its form-finding, why, and that this is not of what was asked for. */
void hf_print_answer(const hf_summary *summary, FILE *file);

/* "loss of gain at 2/6 GHz: 0.1/0.9 dB, after best fit ...": of the facets where there are some, without an end of the
 * line; nothing without surface.frequencies_Hz. */
void hf_print_gain_loss(const hf_summary *summary, FILE *file);

/* A block for each stage: how it ended, ratios of sets, certificates, the surface, times. */
void hf_print_details(const hf_summary *summary, FILE *file);

/* A line for each limit that the design of a stage is at. */
void hf_print_held(const hf_held_limits *held, FILE *file);

/* An objective by its name in the file, with its value, of lengths in mm. */
void hf_print_objective(const char *before, const char *name, double value, FILE *file);

/* A line: the merit of a result, and the values of the goals behind it, or those of objectives. */
void hf_print_goals(const hf_summary *summary, const hf_form_result *result, FILE *file);

/* ", 56.90 % below the 19.7793 mm of ...": psi beside that of the base design, which is the form-finding's shape unless
 * optimize.rule finds another one for the same tensions. Nothing without a base. */
void hf_print_gained(const hf_summary *summary, double psi_m, double base_psi_m, FILE *file);

#endif
