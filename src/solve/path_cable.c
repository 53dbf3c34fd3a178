/* Calls the functions of path_kernel.c for the best instruction set of the processor. */
#include "solve/path_cable.h"

#include "solve/path_kernel.h"

typedef struct {
    double (*measure)(int n_block, hf_path_cables *block);
    void (*set_scaling)(int n_block, hf_path_cables *block);
    void (*set_side)(int n_block, hf_path_cables *block, double target, bool corrected);
    double (*set_direction)(int n_block, hf_path_cables *block, bool corrects);
    void (*move)(int n_block, hf_path_cables *block, double part);
} path_kernels;

#define PATH_KERNELS(isa)                                                                                              \
    {                                                                                                                  \
        hf_path_measure_##isa, hf_path_set_scaling_##isa, hf_path_set_side_##isa, hf_path_set_direction_##isa,         \
            hf_path_move_##isa                                                                                         \
    }
static const path_kernels path_of_isa[HF_LANE_N_ISA] = {PATH_KERNELS(portable), PATH_KERNELS(avx2),
                                                        PATH_KERNELS(avx512)};

static const path_kernels *path_here(void)
{
    return &path_of_isa[hf_lane_best_isa()];
}

double hf_path_measure(int n_block, hf_path_cables *block)
{
    return path_here()->measure(n_block, block);
}

void hf_path_set_scaling(int n_block, hf_path_cables *block)
{
    path_here()->set_scaling(n_block, block);
}

void hf_path_set_side(int n_block, hf_path_cables *block, double target, bool corrected)
{
    path_here()->set_side(n_block, block, target, corrected);
}

double hf_path_set_direction(int n_block, hf_path_cables *block, bool corrects)
{
    return path_here()->set_direction(n_block, block, corrects);
}

void hf_path_move(int n_block, hf_path_cables *block, double part)
{
    path_here()->move(n_block, block, part);
}
