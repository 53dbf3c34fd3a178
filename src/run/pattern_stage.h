/* pattern_stage - the far field of each shape that is reported, for cases with surface.pattern. */
#ifndef HIFDM_PATTERN_STAGE_H
#define HIFDM_PATTERN_STAGE_H

#include <hifdm/problem.h>
#include <hifdm/store.h>

/* Find the pattern of the shape in the workspace at all frequencies on n_thread threads (0: all cores), with the feed
 * of the theoretical net; its figures go into the summary, all of it into the store (NULL: nowhere). A shape whose
 * cables cannot hold the mesh has none. HF_OK, HF_NO_MEMORY, or an error of the store, with a message; HF_INTERRUPTED,
 * when *stop is set (stop may be NULL), and nothing is kept. */
hf_status hf_pattern_stage(const hf_problem *problem, hf_stage stage, const hf_workspace *workspace, int n_thread,
                           const volatile sig_atomic_t *stop, hf_store *store, hf_summary *summary,
                           hf_messages *messages);

#endif
