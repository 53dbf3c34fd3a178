/* precise_kernel - measures HF_LANES cables side by side at twice the precision. It is compiled once for each
 * instruction set, and precise.c chooses one at run time. All instruction sets give the same bits. */
#pragma once

#include "base/lane.h"

#include <stdbool.h>

/* Inputs and outputs of the kernel for HF_LANES cables. A number of twice the precision is [2][HF_LANES]: the leading
 * parts, then the remainders. A lane without a cable has any values with from != to. */
typedef struct {
    double from[3][2][HF_LANES], to[3][2][HF_LANES];                      /* coordinates of the ends, m */
    double T[2][HF_LANES];                                                /* given tension or multiplier, N */
    double target[HF_LANES], EA[HF_LANES];                                /* by law: N, m or N/m; EA in N, or 1 */
    double is_spring[HF_LANES], is_elastic[HF_LANES], is_slack[HF_LANES]; /* 1 or 0 */

    double length[HF_LANES], unit[3][HF_LANES]; /* outputs from here on; length in m */
    double over[2][HF_LANES];                   /* length - target, or length - target (1 + T/EA), m */
    double q[HF_LANES];                         /* pull over length, N/m */
    double pull[3][2][HF_LANES];                /* on the first end, N */
} hf_precise_lanes;

/* Measures the cables in the lanes. With by_law, elastic cables pull with the tension that their law gives at their
 * length, else with T. */
typedef void hf_precise_measure(hf_precise_lanes *lanes, bool by_law);
hf_precise_measure HF_LANE_EACH(hf_precise_measure);
