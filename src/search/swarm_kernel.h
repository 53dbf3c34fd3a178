/* swarm_kernel - implements the inner loops of swarm, and defines the arrays on which they work. The loops are compiled
 * once for each instruction set.
 *
 * A lane row is a model row plus n_pad: n_pad dummy rows in front make the free rows fill blocks of HF_SWARM_BLOCK. The
 * matrix is stored as square tiles of HF_SWARM_BLOCK by HF_SWARM_BLOCK entries. The tiles of a block row are
 * contiguous, from the first one with an entry (skyline) to the one on the diagonal. Inside a tile, the columns are
 * contiguous; see hf_swarm_place. Arrays are aligned to 64 bytes. */
#ifndef HIFDM_SWARM_KERNEL_H
#define HIFDM_SWARM_KERNEL_H

#include "base/arena.h"
#include "base/lane.h"

#include <hifdm/workspace.h>

#include <stddef.h>

/* Flags of the laws that the kernels support: Eqs. 5, 7 and 8, for a given force density, tension or length. */
#define HF_SWARM_LAWS                                                                                                  \
    (HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_GIVES_TENSION | HF_LAW_HAS_MULTIPLIER | HF_LAW_IS_RIGID |             \
     HF_LAW_MAY_PUSH)

#define HF_SWARM_BLOCK 4

typedef struct hf_swarm_kernels hf_swarm_kernels;

/* A cable seen from one of its nodes. */
typedef struct {
    int i_cable;
    int other; /* lane row of its other end */
} hf_swarm_incidence;

/* What all threads share, besides the model. */
typedef struct {
    const hf_model *model; /* borrowed: must outlive the plan */
    const hf_swarm_kernels *kernels;
    int n_pad;                     /* number of dummy rows in front, 0 to HF_SWARM_BLOCK - 1 */
    int n_block;                   /* number of block rows: n_pad + n_free = n_block * HF_SWARM_BLOCK */
    size_t n_tile;                 /* number of stored tiles */
    int *first_column;             /* [n_block], lane column of the first entry in a block row */
    size_t *tile_0;                /* [n_block], number that the tile of the block row in tile column 0 would have */
    unsigned char *has_entry;      /* [n_tile], 1 if D has an entry in the tile */
    int *incidence_start;          /* [n_free + 1], by model row */
    hf_swarm_incidence *incidence; /* [incidence_start[n_free]], of each node by rising cable */
    double *inverse_length;        /* [n_cable], 1 / length between target positions, 1/m */
    void *block;
} hf_swarm_plan;

/* X(type, name, number of items for a plan p of a model m, unit, meaning): one row per array of a lane. */
#define HF_SWARM_FIELDS(X)                                                                                             \
    X(double, matrix, p->n_tile *HF_SWARM_BLOCK *HF_SWARM_BLOCK *HF_LANES, "N/m",                                      \
      "D, then its factor: hf_swarm_place")                                                                            \
    X(double, position_m, ((size_t)p->n_pad + (size_t)m->n_node) * 3 * HF_LANES, "m", "[n_pad + n_node][3][8]")        \
    X(double, q_N_per_m, (size_t)m->n_cable *HF_LANES, "N/m", "[n_cable][8] force densities of this shape")            \
    X(double, next_q_N_per_m, (size_t)m->n_cable *HF_LANES, "N/m", "[n_cable][8] as the laws update them")             \
    X(double, length_m, (size_t)m->n_cable *HF_LANES, "m", "[n_cable][8] lengths of this shape")                       \
    X(double, target, (size_t)m->n_cable *HF_LANES, "by law", "[n_cable][8] T* (N), L* (m) or q (N/m)")                \
    X(unsigned char, law, m->n_cable, "", "[n_cable] hf_law in force, for all lanes: set by the caller")               \
    X(int, bad_row, HF_LANES, "", "[8] model row of the first pivot that was not positive, or -1")

/* The scratch of one thread. Apart from what the caller has written, its contents are undefined. */
typedef struct {
#define HF_SWARM_MEMBER(type, name, count, unit, meaning) type *name;
    HF_SWARM_FIELDS(HF_SWARM_MEMBER)
#undef HF_SWARM_MEMBER
    void *block;
} hf_swarm_lanes;

/* The measures of each lane, as defined by hf_form_result. They are undefined in a lane that is not finite or has a
 * bad_row. */
typedef struct {
    _Alignas(HF_ALIGNMENT) double tension_error[HF_LANES]; /* maximum |T/T*-1| of cables of law tension, or 0 */
    double length_error[HF_LANES];                         /* maximum |l/L*-1| of taut cables of law length, or 0 */
    double length_gap[HF_LANES];                           /* maximum |l/L*-1| if short slack cables count in part */
    double shortest_length_ratio[HF_LANES];                /* minimum l / length at target over all cables */
    double longest_length_ratio[HF_LANES];                 /* maximum l / length at target over all cables */
    double shortest_of_law[3][HF_LANES]; /* minimum for each supported law; INFINITY without a cable */
    double residual_N[HF_LANES];         /* set by hf_swarm_residual */
    double psi_m[HF_LANES];              /* set by hf_swarm_psi */
    unsigned char is_finite[HF_LANES];   /* 1 if every tension is a finite number */
} hf_swarm_measures;

/* Returns the index in `matrix` of lane 0 of entry (i, j); i and j are lane rows, first_column <= j <= i. In the
 * factor, a diagonal position holds the reciprocal of the diagonal entry. */
static inline size_t hf_swarm_place(const hf_swarm_plan *plan, int i, int j)
{
    size_t column = plan->tile_0[i / HF_SWARM_BLOCK] * HF_SWARM_BLOCK + (size_t)j;
    return (column * HF_SWARM_BLOCK + (size_t)(i % HF_SWARM_BLOCK)) * HF_LANES;
}

/* The kernels of one instruction set. swarm_lane.h describes each of them. */
struct hf_swarm_kernels {
    void (*assemble)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
    void (*factor)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
    void (*substitute)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
    void (*solve)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
    void (*measure)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes, hf_swarm_measures *measures);
    void (*residual)(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures);
    void (*psi)(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures);
};

/* The kernels of each instruction set. Machines other than x86-64 have the first one only. */
extern const hf_swarm_kernels hf_swarm_kernels_portable, hf_swarm_kernels_avx2, hf_swarm_kernels_avx512;

#endif
