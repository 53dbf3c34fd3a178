/* run_front - the stage of a run that finds the front of optimize.front by Levenberg-Marquardt. */
#ifndef HIFDM_RUN_FRONT_H
#define HIFDM_RUN_FRONT_H

#include <hifdm/optimiser.h>
#include <hifdm/problem.h>
#include <hifdm/run.h>
#include <hifdm/summary.h>

/* Finds *front. If that holds an earlier front, the search starts from its designs, else from the initial design. The
 * earlier front is freed; if the search fails, it stays, with a warning. The summary receives the table of the front.
 * The observer of the request receives the number of points found so far, beginning with 0. Returns HF_OK; without an
 * earlier front HF_NO_FEASIBLE if an end has no design, or HF_BAD_CASE if designs have no derivatives; HF_NO_MEMORY;
 * each with a message; HF_INTERRUPTED. */
hf_status hf_run_front(const hf_run_request *request, hf_problem *problem, const hf_population *bounds, hf_front *front,
                       hf_summary *summary, hf_messages *messages);

/* Writes the table of a front into the summary, and warns about points that failed. wall_s is the time that it took,
 * s. */
hf_status hf_run_front_tell(const hf_front *front, double wall_s, hf_summary *summary, hf_messages *messages);

#endif
