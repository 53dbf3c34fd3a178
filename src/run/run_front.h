/* run_front - the stage of a run that follows the front of optimize.objectives by Levenberg-Marquardt. */
#ifndef HIFDM_RUN_FRONT_H
#define HIFDM_RUN_FRONT_H

#include <hifdm/optimiser.h>
#include <hifdm/problem.h>
#include <hifdm/run.h>
#include <hifdm/summary.h>

/* Find *front, which may hold an earlier one: its designs are then where the search begins, else the base design. The
 * earlier one is freed, unless the search fails: then it stays, and is told, with a warning. The summary gets the table
 * of the front; its form has the objectives of the base. HF_OK; without an earlier one HF_NO_FEASIBLE where an end has
 * no design, or HF_BAD_CASE where designs have no derivatives; HF_NO_MEMORY; each with a message; HF_INTERRUPTED. The
 * request's observer is told how many points there are, from none on. */
hf_status hf_run_front(const hf_run_request *request, hf_problem *problem, const hf_population *bounds, hf_front *front,
                       hf_summary *summary, hf_messages *messages);

/* What a front that was found, by whichever method, says in the summary. */
void hf_run_front_tell(const hf_front *front, double wall_s, hf_summary *summary, hf_messages *messages);

#endif
