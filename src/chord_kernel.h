/* chord_kernel - the loops of chord, compiled once per instruction set; chord picks at run time. */
#ifndef HIFDM_CHORD_KERNEL_H
#define HIFDM_CHORD_KERNEL_H

#include "chord.h"

/* The Makefile compiles chord_kernel.c with -DHF_ISA=avx512 and so on; the names end in it. */
#define HF_JOIN_(a, b) a##_##b
#define HF_JOIN(a, b) HF_JOIN_(a, b)
#define HF_KERNEL(name) HF_JOIN(name, HF_ISA)

#define HF_CHORD_KERNELS(isa)                                                                                          \
    void hf_chord_forces_##isa(const hf_chord *chord, const hf_chord_lanes *l, double residual_squared[HF_LANES]);     \
    void hf_chord_solve_##isa(const hf_chord *chord, const hf_chord_lanes *l);                                         \
    void hf_chord_step_##isa(const hf_chord *chord, const hf_chord_lanes *l);

/* forces: nodal forces of every lane into force_N, squares of the largest over the reference
 * tension per lane. solve: force_N -> Newton step, in
 * place. step: x_m += that. */
HF_CHORD_KERNELS(portable)
HF_CHORD_KERNELS(avx2)
HF_CHORD_KERNELS(avx512)

#endif
