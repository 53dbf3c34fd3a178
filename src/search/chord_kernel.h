/* chord_kernel - the loops of chord, compiled once per instruction set; chord picks at run time. */
#ifndef HIFDM_CHORD_KERNEL_H
#define HIFDM_CHORD_KERNEL_H

#include "search/lane.h"
#include <hifdm/evaluate.h>

typedef struct hf_chord_kernels hf_chord_kernels;

#define HF_CHORD_ROWS 6 /* of the flexibility that are worked on at a time */
#define HF_CHORD_MODES_MAX 48

/* Laws that the kernels serve: the target is the tension or the force density, with no unknown but the positions. */
#define HF_CHORD_LAWS (HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_GIVES_TENSION | HF_LAW_MAY_PUSH)

/* What all threads share; constant after hf_chord_create. The factor is packed in the order in which
 * hf_chord_solve reads it. */
typedef struct hf_chord {
    const hf_evaluator *evaluator;
    const hf_chord_kernels *kernels;
    int n_dof, width;         /* rows of the matrix; entries of a packed row, a multiple of 4 */
    double *row, *column;     /* [n_dof][width] factor by rows (forward) and by columns (backward) */
    double *inverse_diagonal; /* [n_dof] */
    int *row_begin,
        *column_end;    /* [n_dof / 4, rounded up] skyline: the part of a block's shared entries not all zero */
    double *base_m;     /* [3][n_node] shape the lanes start from */
    int *gene_of_cable; /* [n_cable] or -1 */

    /* Net and truss together; all empty without attachments. n_pull is 3 n_attachment, filled up to n_pull_pad. */
    int n_pull, n_pull_pad, n_mode;
    int *pull_of_row;    /* [n_node] 3 * attachment, or -1 */
    double *flexibility; /* [n_pull_pad / HF_CHORD_ROWS][n_pull][HF_CHORD_ROWS] rows of F side by side */
    double *mode;        /* [n_mode][2][n_pull] (I + F S)^-1 = I + sum mode[0] mode[1]', where F S is large */
    double *tie_block; /* [n_tie][9] stiffness of the cables at attachments; read where the other end is a free node */
    double *base_displacement_m; /* [n_pull] */
    void *block;
} hf_chord;

/* Scratch of one thread. */
typedef struct {
    double *x_m;                     /* [3][n_node][HF_LANES] */
    double *force_N;                 /* [n_pad + n_dof + n_pad][HF_LANES], zero rows around for the solve */
    double *gene;                    /* [n_gene][HF_LANES] q (N/m) or T (N) by rule */
    double *pull_N;                  /* [n_pull][HF_LANES] of the net on the truss */
    double *displacement_m, *move_m; /* [n_pull_pad][HF_LANES] of the attachments; what the next step adds */
    void *block;
} hf_chord_lanes;

/* Of one instruction set; what they do stands below. */
struct hf_chord_kernels {
    void (*forces)(const hf_chord *chord, const hf_chord_lanes *l, double residual_squared[HF_LANES]);
    void (*solve)(const hf_chord *chord, const hf_chord_lanes *l);
    void (*step)(const hf_chord *chord, const hf_chord_lanes *l);
    void (*couple)(const hf_chord *chord, const hf_chord_lanes *l, double gap_squared[HF_LANES]);
    void (*move)(const hf_chord *chord, const hf_chord_lanes *l);
};

/* The Makefile compiles chord_kernel.c with -DHF_ISA=avx512 and so on; the names end in it. */
#define HF_JOIN_(a, b) a##_##b
#define HF_JOIN(a, b) HF_JOIN_(a, b)
#define HF_KERNEL(name) HF_JOIN(name, HF_ISA)

#define HF_CHORD_KERNELS(isa)                                                                                          \
    void hf_chord_forces_##isa(const hf_chord *chord, const hf_chord_lanes *l, double residual_squared[HF_LANES]);     \
    void hf_chord_couple_##isa(const hf_chord *chord, const hf_chord_lanes *l, double gap_squared[HF_LANES]);          \
    void hf_chord_move_##isa(const hf_chord *chord, const hf_chord_lanes *l);                                          \
    void hf_chord_solve_##isa(const hf_chord *chord, const hf_chord_lanes *l);                                         \
    void hf_chord_step_##isa(const hf_chord *chord, const hf_chord_lanes *l);

/* forces: nodal forces of every lane into force_N, squares of the largest over the reference tension per lane; pull_N.
 * couple: gap F f - r of the truss, squares of the largest (m^2) per lane, and what r has to move for it into move_m.
 * move: displacement_m and the supports in x_m by that, and what it changes in force_N.
 * solve: force_N -> Newton step, in place. step: x_m += that. */
HF_CHORD_KERNELS(portable)
HF_CHORD_KERNELS(avx2)
HF_CHORD_KERNELS(avx512)

#endif
