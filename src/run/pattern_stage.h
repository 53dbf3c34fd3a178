/* pattern_stage - computes the far field of each shape that a run reports, for cases with surface.pattern. */
#ifndef HIFDM_PATTERN_STAGE_H
#define HIFDM_PATTERN_STAGE_H

#include <hifdm/problem.h>
#include <hifdm/store.h>

/* Computes the far field of the shape in the workspace at all frequencies, on n_thread threads (0: all cores). The feed
 * is that of the net at the target positions. The figures go into the summary, the whole field into the store (NULL:
 * not stored). A shape whose cables cannot hold the mesh has no far field. Returns HF_OK; HF_NO_MEMORY or an error of
 * the store, with a message; HF_INTERRUPTED if *stop is set (stop may be NULL), and then nothing is kept. */
hf_status hf_pattern_stage(const hf_problem *problem, hf_stage stage, const hf_workspace *workspace, int n_thread,
                           const volatile sig_atomic_t *stop, hf_store *store, hf_summary *summary,
                           hf_messages *messages);

#endif
