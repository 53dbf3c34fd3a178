/* chord_kernel - the inner loops of chord, compiled once for each instruction set; chord.c chooses one at run time. */
#ifndef HIFDM_CHORD_KERNEL_H
#define HIFDM_CHORD_KERNEL_H

#include "base/lane.h"
#include <hifdm/evaluate.h>

typedef struct hf_chord_kernels hf_chord_kernels;

#define HF_CHORD_ROWS 6       /* rows of the flexibility that are worked on at a time */
#define HF_CHORD_MODES_MAX 48 /* the largest n_mode */

/* Laws that the kernels serve: the target is the tension or the force density, with no unknown but the positions. */
#define HF_CHORD_LAWS (HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_GIVES_TENSION | HF_LAW_MAY_PUSH)

/* What all threads share; constant after hf_chord_create. The factor is packed in the order in which the kernel `solve`
 * reads it. */
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

/* The kernels of one instruction set; the comment below says what each does. */
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

/* forces: writes the nodal forces of every lane into force_N and the pull on the truss into pull_N; residual_squared is
 *         per lane the square of the largest nodal force over the reference tension.
 * couple: gap_squared is per lane the square (m^2) of the largest gap F f - r of the truss; writes into move_m the
 *         change of r that closes the gap.
 * move:   adds move_m to displacement_m and to the supports in x_m, and its effect to force_N.
 * solve:  turns force_N into the Newton step, in place.
 * step:   adds that step to x_m. */
HF_CHORD_KERNELS(portable)
HF_CHORD_KERNELS(avx2)
HF_CHORD_KERNELS(avx512)

#endif
