/* measure_stage - measures each shape that a run reports. */
#ifndef HIFDM_MEASURE_STAGE_H
#define HIFDM_MEASURE_STAGE_H

#include <hifdm/problem.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>

#include <signal.h>

/* Measures the shape in the workspace as that of `stage`: the tensions of its sets, the limits that a design reaches and, for a case with a section
 * `surface`, the surface and its far field. n_thread threads (0: all cores) compute the far field until *stop is set.
 * Returns HF_OK; HF_NO_MEMORY; HF_INTERRUPTED without the far field; or an error of the store. */
hf_status hf_measure_stage(const hf_problem *problem, hf_stage stage, const hf_workspace *workspace, int n_thread,
                           const volatile sig_atomic_t *stop, hf_store *store, hf_summary *summary,
                           hf_messages *messages);

#endif
