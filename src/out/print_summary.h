/* print_summary - parts of hf_print_summary that are used elsewhere, too. */
#pragma once

#include "out/print.h"

/* Prints the verdict and a table of the requirements: all that are not passed and the tightest others, with `verbose`
 * all. Prints nothing without requirements. */
void hf_print_requirements(const hf_summary *summary, hf_print_style style, FILE *file);

/* Prints the answer in one line without its newline: psi or the objectives, their reduction, and the frequency of 1 dB
 * gain loss. When a run failed after its form-finding, the line begins with the reason and names the design that the
 * figures describe. */
void hf_print_answer(const hf_summary *summary, FILE *file);

/* Prints "gain loss at 2/6 GHz: 0.1/0.9 dB for a fixed feed, ... after best fit" without a newline, of the facets where
 * there are some. Prints nothing without surface.frequencies_Hz. */
void hf_print_gain_loss(const hf_summary *summary, FILE *file);

/* Prints a block for each stage: how it ended, tension ratios of sets, certificates, the surface, times. */
void hf_print_details(const hf_summary *summary, FILE *file);

/* Prints a line for each limit that the design of a stage reaches. */
void hf_print_held(const hf_held_limits *held, FILE *file);

/* Prints a line with the distinct optima of a refinement from several starts: their merits, and how many of the
 * refinements found each. */
void hf_print_optima(const hf_summary *summary, FILE *file);

/* Prints an objective by its name in the file with its value: in SI units as in merit and weights, or lengths in mm. */
void hf_print_objective(const char *before, const char *name, double value, bool in_SI, FILE *file);

/* Prints a line with the merit of a result and the values of its objectives, or the objectives of a front. */
void hf_print_objectives(const hf_summary *summary, const hf_form_result *result, FILE *file);

/* Prints ", 56.9 % lower than for the initial design (19.7793 mm)", the change of psi from that `of` another shape.
 * Prints nothing if psi of that shape is unknown or too small. */
void hf_print_gained(double psi_m, double initial_psi_m, const char *of, FILE *file);

/* Prints how an iteration ended: "converged after 13 iterations", "not converged after 400 iterations". */
void hf_print_iterations(const hf_form_result *result, FILE *file);

/* Prints how the refinement ended: "converged after 7 steps", "stalled after 12 steps: shorter steps gain nothing". */
void hf_print_steps(const hf_refine_summary *refine, FILE *file);

/* Prints how the genetic algorithm ended: "after 12 generations", "by stagnation after 9 generations". */
void hf_print_generations(const hf_search_summary *search, FILE *file);

typedef enum { HF_PRINT_SHORT, HF_PRINT_NORMAL, HF_PRINT_VERBOSE } hf_print_amount;

/* Prints psi of the as-built net and the yield; the normal amount adds the cables with the largest shares, the verbose
 * one all measures and the control variate. */
void hf_print_tolerance(const hf_summary *summary, hf_print_amount amount, FILE *file);
