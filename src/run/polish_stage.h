/* polish_stage - Levenberg-Marquardt in a run: it says how far it is, and goes on after it was stopped or killed. */
#ifndef HIFDM_POLISH_STAGE_H
#define HIFDM_POLISH_STAGE_H

#include "search/polish.h"
#include <hifdm/run.h>

#define HF_POLISH_STAGE_TEXT 160

/* Start from `design` [n_gene], which becomes the best one, within the bounds of the population; the problem's
 * workspace is scratch. *wall_s: of all sessions. HF_INTERRUPTED: *request->stop_requested was set; the next
 * publication holds what was found, and stopped_at says in words how far it came. Else as hf_polish_run, or an error of
 * the store. */
hf_status hf_polish_stage_run(const hf_run_request *request, hf_problem *problem, const hf_population *bounds,
                              const hf_summary *summary, hf_store *store, double *design, hf_polish_result *result,
                              double *wall_s, char stopped_at[HF_POLISH_STAGE_TEXT], hf_messages *messages);

#endif
