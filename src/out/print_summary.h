/* print_summary - parts of hf_print_summary that are used elsewhere, too. */
#ifndef HIFDM_PRINT_SUMMARY_H
#define HIFDM_PRINT_SUMMARY_H

#include "out/print.h"

/* Prints the answer in one line without its newline: psi or the objectives, their reduction, and the frequency of 1 dB
 * gain loss. When a run failed after its form-finding, the line begins with the reason and names the design that the
 * figures describe. */
void hf_print_answer(const hf_summary *summary, FILE *file);

/* Prints "loss of gain at 2/6 GHz: 0.1/0.9 dB, after best fit ..." without a newline, of the facets where there are
 * some. Prints nothing without surface.frequencies_Hz. */
void hf_print_gain_loss(const hf_summary *summary, FILE *file);

/* Prints a block for each stage: how it ended, tension ratios of sets, certificates, the surface, times. */
void hf_print_details(const hf_summary *summary, FILE *file);

/* Prints a line for each limit that the design of a stage reaches. */
void hf_print_held(const hf_held_limits *held, FILE *file);

/* Prints an objective by its name in the file with its value, lengths in mm. */
void hf_print_objective(const char *before, const char *name, double value, FILE *file);

/* Prints a line with the merit of a result and the values of its objectives, or the objectives of a front. */
void hf_print_objectives(const hf_summary *summary, const hf_form_result *result, FILE *file);

/* Prints ", 56.90 % below the 19.7793 mm of ...", the change of psi from the initial design. That is the shape of the
 * form-finding, unless optimize.rule gives another shape for the same tensions. Prints nothing without an initial
 * design. */
void hf_print_gained(const hf_summary *summary, double psi_m, double base_psi_m, FILE *file);

#endif
