/* cmd_adjust_findings - what a measured net tells beside its moves: cables and places that stand out, and what the
 * moves would reach if they aimed at something else. */
#ifndef HIFDM_CMD_ADJUST_FINDINGS_H
#define HIFDM_CMD_ADJUST_FINDINGS_H

#include "app/cmd_adjust_print.h"

/* After the estimate. HF_OK, HF_SINGULAR, HF_NO_MEMORY. */
hf_status hf_adjust_find_outliers(hf_adjust_job *job);

/* Goals of a figure of the net as built. HF_OK, HF_BAD_CASE, HF_NO_MEMORY. */
hf_status hf_adjust_make_goals(const hf_adjust_job *job, hf_goal_kind figure, hf_goals *goals, hf_messages *messages);

/* The places that psi is measured from, into the model of the net as built. */
void hf_adjust_take_aim(hf_adjust_job *job, hf_aim aim);

/* After the moves. Other figures and aims are tried where the psi of the design is beyond that which errors make, or
 * most moves are as far as the range allows. HF_OK, HF_INTERRUPTED, HF_NO_MEMORY. */
hf_status hf_adjust_find_instead(hf_adjust_job *job);

#endif
