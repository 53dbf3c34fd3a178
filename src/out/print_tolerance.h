/* print_tolerance - the samples of the net as built, in a few lines. */
#ifndef HIFDM_PRINT_TOLERANCE_H
#define HIFDM_PRINT_TOLERANCE_H

#include "out/print.h"

/* In few lines what an engineer asks for first; `verbose`: all measures, the control by first order. */
void hf_print_tolerance(const hf_tolerance_summary *tolerance, bool verbose, FILE *file);

#endif
