/* lane - the eight SIMD lanes that chord and swarm give a design each, and the instruction sets that kernels are
 * compiled for.
 *
 * All instruction sets give the same bits: there are always eight lanes, one order of operations, and only IEEE + - * /
 * and square root. Lanes never fuse multiply-adds (swarm_kernel.c gives the measured price of this); the kernels of a
 * single band do, everywhere. */
#ifndef HIFDM_LANE_H
#define HIFDM_LANE_H

#include <stdbool.h>

#define HF_LANES 8

/* Names of the instruction sets, slowest first. */
typedef enum { HF_LANE_PORTABLE, HF_LANE_AVX2, HF_LANE_AVX512 } hf_lane_isa;
#define HF_LANE_N_ISA 3

bool hf_lane_has_isa(hf_lane_isa isa); /* can this machine run it? */
hf_lane_isa hf_lane_best_isa(void);    /* the fastest that this machine can run */
const char *hf_lane_isa_name(hf_lane_isa isa);

#endif
