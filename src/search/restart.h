/* restart - refines a design again from other starts, because Levenberg-Marquardt ends at the local optimum of its
 * start (METHOD section 7). Local optima of cable nets often differ in a few design variables, each of which is at its
 * lower bound in one optimum and at its upper bound in another. A start is therefore the best optimum so far with one
 * such variable at its other bound: that of the lowest merit. When no such start helps, the last start is the
 * individual of the search that is farthest from the optimum. */
#pragma once

#include "search/refine.h"
#include <hifdm/batch.h>

#define HF_RESTARTS 3 /* maximum number of further refinements */

/* Refines `design` [n_variable], at which a refinement has ended with *result, again from other starts. `population`
 * has the bounds and, if it has individuals, the last generation of the search. `optimum` receives the distinct optima,
 * best first; two optima are distinct if their shapes are. A run that has stalled has no optimum, and one that has
 * settled has that of nearly the same merit, if there is one. A run that is not expected to lower the best merit by
 * 1e-6 of it ends early, and has no new optimum. `design` and *result become those of the best optimum; their numbers
 * of evaluations are those of all refinements. Each refinement takes at most max_iterations steps, and a design that it
 * had to leave for that reason is not an optimum. The threads of the batch rank the starts. `watcher` hears of the
 * steps, or is NULL; it has no state. If `design` breaks limits or its refinement has stalled, the first start is the
 * initial design. Returns HF_OK, HF_NO_MEMORY, the status that the watcher returned, or that of `design` if none is
 * feasible. */
hf_status hf_restart_run(hf_batch *batch, const hf_population *population, int max_iterations,
                         const hf_refine_watcher *watcher, double *design, hf_workspace *workspace,
                         hf_refine_result *result, hf_optima *optimum);
