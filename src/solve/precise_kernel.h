/* precise_kernel - a measure of HF_LANES cables side by side at twice the precision, compiled once for each instruction
 * set; precise.c chooses one at run time. All give the same bits. */
#ifndef HIFDM_PRECISE_KERNEL_H
#define HIFDM_PRECISE_KERNEL_H

#include "base/lane.h"

#include <stdbool.h>

/* Numbers of twice the precision are [2][HF_LANES]: the leading parts, then the rest. A lane without a cable has any
 * values with from != to. */
typedef struct {
    double from[3][2][HF_LANES], to[3][2][HF_LANES];                      /* coordinates of the ends, m */
    double T[2][HF_LANES];                                                /* given tension or multiplier, N */
    double target[HF_LANES], EA[HF_LANES];                                /* EA: 1 where the law has none */
    double is_spring[HF_LANES], is_elastic[HF_LANES], is_slack[HF_LANES]; /* 1 or 0 */

    double length[HF_LANES], unit[3][HF_LANES]; /* from here on what the kernel sets */
    double over[2][HF_LANES];                   /* length less target, or less target (1 + T/EA) */
    double q[HF_LANES];                         /* pull over length, N/m */
    double pull[3][2][HF_LANES];                /* on the first end, N */
} hf_precise_lanes;

/* by_law: elastic cables pull with what their law gives at their length, else with T. */
typedef void hf_precise_measure(hf_precise_lanes *lanes, bool by_law);
hf_precise_measure hf_precise_measure_portable, hf_precise_measure_avx2, hf_precise_measure_avx512;

#endif
