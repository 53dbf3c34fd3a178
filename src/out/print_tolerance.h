/* print_tolerance - prints the samples of the as-built net in a few lines. */
#ifndef HIFDM_PRINT_TOLERANCE_H
#define HIFDM_PRINT_TOLERANCE_H

#include "out/print.h"

/* Prints psi, yield and the cables with the largest shares. `verbose` adds all measures and the control variate. */
void hf_print_tolerance(const hf_tolerance_summary *tolerance, bool verbose, FILE *file);

#endif
