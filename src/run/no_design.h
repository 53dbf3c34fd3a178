/* no_design - explains with counts and names why a run has no design, and what would change that. */
#ifndef HIFDM_NO_DESIGN_H
#define HIFDM_NO_DESIGN_H

#include <hifdm/population.h>
#include <hifdm/problem.h>

#define HF_NO_DESIGN_SIZE 1024
#define HF_NO_DESIGN_HINT_SIZE 192

/* Reports that no individual of any generation was feasible. Returns HF_NO_FEASIBLE, with a message. */
hf_status hf_no_design_evolved(hf_problem *problem, const hf_population *population, hf_messages *messages);

/* Writes why Levenberg-Marquardt refused to start from this design [n_variable] with this status. Overwrites the shape
 * in the problem's workspace. Returns text. */
const char *hf_no_design_to_refine(hf_problem *problem, const double *design, hf_status status,
                                   char text[HF_NO_DESIGN_SIZE]);

/* Writes "; 10 is the default of ..." if the ratio exceeds a cap that the case does not set, because its author may not
 * know that cap. Otherwise writes "". Returns text. */
const char *hf_no_design_cap(const hf_problem *problem, double boundary_tension_ratio,
                             char text[HF_NO_DESIGN_HINT_SIZE]);

#endif
