/* refine_stage - the refinement by Levenberg-Marquardt in a run. It reports its progress and resumes after an
 * interruption or a crash. */
#ifndef HIFDM_REFINE_STAGE_H
#define HIFDM_REFINE_STAGE_H

#include "search/refine.h"
#include <hifdm/run.h>

#define HF_REFINE_STAGE_TEXT 160

/* Refines `design` [n_variable], which becomes the best design, within the bounds of the population. The problem's
 * workspace is scratch. *wall_s becomes the time of all sessions, s. Returns HF_INTERRUPTED if *request->stop_requested
 * was set: the next publication has the steps so far, and stopped_at says where it stopped. Otherwise returns the
 * status of hf_refine_run, or an error of the store. */
hf_status hf_refine_stage_run(const hf_run_request *request, hf_problem *problem, const hf_population *bounds,
                              const hf_summary *summary, hf_store *store, double *design, hf_refine_result *result,
                              double *wall_s, char stopped_at[HF_REFINE_STAGE_TEXT], hf_messages *messages);

#endif
