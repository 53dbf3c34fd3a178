/* measure_stage - what is told of each shape that is reported. */
#ifndef HIFDM_MEASURE_STAGE_H
#define HIFDM_MEASURE_STAGE_H

#include <hifdm/problem.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>

#include <signal.h>

/* The shape in the workspace as that of `stage`: tensions of its sets and, for a case with a section `surface`, the
 * surface and its far field, the last by n_thread threads (0: all cores) until *stop. HF_OK, HF_NO_MEMORY;
 * HF_INTERRUPTED without the far field. */
hf_status hf_measure_stage(const hf_problem *problem, hf_stage stage, const hf_workspace *workspace, int n_thread,
                           const volatile sig_atomic_t *stop, hf_store *store, hf_summary *summary,
                           hf_messages *messages);

/* Limits at which a found design is, whose shape the workspace holds. */
void hf_measure_limits(const hf_problem *problem, hf_stage stage, const hf_workspace *workspace, hf_summary *summary);

#endif
