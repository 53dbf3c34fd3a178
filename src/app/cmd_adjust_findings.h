/* cmd_adjust_findings - finds what a measured net shows besides its adjustments: the cables and nodes that stand out,
 * and what adjustments with another aim would reach. */
#ifndef HIFDM_CMD_ADJUST_FINDINGS_H
#define HIFDM_CMD_ADJUST_FINDINGS_H

#include "app/cmd_adjust_print.h"

/* Lists the cables and nodes that stand out, after the estimate. Returns HF_OK, HF_SINGULAR or HF_NO_MEMORY. */
hf_status hf_adjust_find_outliers(hf_adjust_job *job);

/* Makes the objective of one figure of the as-built net. Returns HF_OK, HF_BAD_CASE or HF_NO_MEMORY; free goals in any
 * case. */
hf_status hf_adjust_make_objectives(const hf_adjust_job *job, hf_figure_kind figure, hf_objectives *objectives,
                                    hf_messages *messages);

/* Copies the positions from which psi is measured into the model of the as-built net: those of the design, or the
 * target positions. */
void hf_adjust_take_aim(hf_adjust_job *job, hf_aim aim);

/* Tries other figures and aims, after the adjustments are found. It does so if psi of the design exceeds that of the
 * errors, or if most adjustments reach the range. Returns HF_OK, HF_INTERRUPTED or HF_NO_MEMORY. */
hf_status hf_adjust_find_instead(hf_adjust_job *job);

#endif
