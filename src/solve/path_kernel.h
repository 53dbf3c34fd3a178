/* path_kernel - the functions of path_cable.h, compiled once for each instruction set. path_cable.c chooses one at run
 * time. */
#ifndef HIFDM_PATH_KERNEL_H
#define HIFDM_PATH_KERNEL_H

#include "solve/path_cable.h"

/* The Makefile compiles path_kernel.c with -DHF_ISA=avx512 and so on. The names of its functions end in it. */
#define HF_PATH_KERNELS(isa)                                                                                           \
    double hf_path_measure_##isa(int n_block, hf_path_cables *block);                                                  \
    void hf_path_set_scaling_##isa(int n_block, hf_path_cables *block);                                                \
    void hf_path_set_side_##isa(int n_block, hf_path_cables *block, double target, bool corrected);                    \
    double hf_path_set_direction_##isa(int n_block, hf_path_cables *block, bool corrects);                             \
    void hf_path_move_##isa(int n_block, hf_path_cables *block, double part);

HF_PATH_KERNELS(portable)
HF_PATH_KERNELS(avx2)
HF_PATH_KERNELS(avx512)

#endif
