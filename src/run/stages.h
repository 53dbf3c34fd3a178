/* stages - what the stages of a run do with a shape or a design: measures, far field, refinement, front. */
#ifndef HIFDM_STAGES_H
#define HIFDM_STAGES_H

#include "search/refine.h"
#include <hifdm/optimiser.h>
#include <hifdm/problem.h>
#include <hifdm/run.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>
#include <signal.h>

/* ---- measures ---- */

/* Measures the shape in the workspace as that of `stage`: the tensions of its sets, the limits that a design reaches
 * and, for a case with a section `surface`, the surface and its far field. n_thread threads (0: all cores) compute
 * the far field until *stop is set. Returns HF_OK; HF_NO_MEMORY; HF_INTERRUPTED without the far field; or an error
 * of the store. */
hf_status hf_measure_stage(const hf_problem *problem, hf_stage stage, const hf_workspace *workspace, int n_thread,
                           const volatile sig_atomic_t *stop, hf_store *store, hf_summary *summary,
                           hf_messages *messages);

/* ---- refinement ---- */

#define HF_REFINE_STAGE_TEXT 160

/* Refines `design` [n_variable], which becomes the best design, within the bounds of the population. The problem's
 * workspace is scratch. *wall_s becomes the time of all sessions, s. Returns HF_INTERRUPTED if *request->stop_requested
 * was set: the next publication has the steps so far, and stopped_at says where it stopped. Otherwise returns the
 * status of hf_refine_run, or an error of the store. */
hf_status hf_refine_stage_run(const hf_run_request *request, hf_problem *problem, const hf_population *bounds,
                              const hf_summary *summary, hf_store *store, double *design, hf_refine_result *result,
                              double *wall_s, char stopped_at[HF_REFINE_STAGE_TEXT], hf_messages *messages);

/* ---- front ---- */

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
