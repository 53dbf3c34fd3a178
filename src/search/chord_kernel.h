/* chord_kernel - the inner loops of chord, compiled once for each instruction set; chord.c chooses one at run time. */
#ifndef HIFDM_CHORD_KERNEL_H
#define HIFDM_CHORD_KERNEL_H

#include "base/arena.h"
#include "base/lane.h"
#include "linalg/packed_band.h"
#include <hifdm/evaluate.h>

typedef struct hf_chord_kernels hf_chord_kernels;

#define HF_CHORD_ROWS 8       /* rows of the flexibility that are worked on at a time */
#define HF_CHORD_MODES_MAX 48 /* the largest n_mode */

/* Laws that the kernels serve: the target is the tension or the force density, with no unknown but the positions. */
#define HF_CHORD_LAWS (HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_GIVES_TENSION | HF_LAW_MAY_PUSH)

/* A cable seen from one of its nodes. */
typedef struct {
    int slot;  /* of its force density */
    int other; /* model row at its other end */
} hf_chord_incidence;

/* What all threads share; constant after hf_chord_create. */
typedef struct hf_chord {
    const hf_evaluator *evaluator;
    const hf_chord_kernels *kernels;
    hf_packed_band matrix;  /* Newton matrix of the base design, 3 rows for each free node */
    double *base_m;         /* [3][n_node] shape the lanes start from */
    int *gene_of_cable;     /* [n_cable] or -1 */
    double *gene_divisor;   /* [n_gene] what a pretension is divided by: length (m) or 1 by rule */
    double *inverse_length; /* [n_cable] 1 / theoretical length, 1/m */
    int *slot_of_cable;     /* [n_cable] row of its force density in `gene`: that of its gene, or n_gene + the cable */
    int n_pulled, *pulled;  /* [n_pulled] cables whose tension is given, */
    unsigned char *is_pulled;      /* [n_cable] and whether one is */
    int *place_of_row;             /* [n_node] free rows, then attachments; -1: neither */
    int *incidence_start;          /* [n_free + n_attachment + 1] by place */
    hf_chord_incidence *incidence; /* [incidence_start[n_free + n_attachment]], of each place by rising cable */
    bool serves_all;               /* no cable between supports has a law that the kernels do not serve */

    /* Net and truss together; all empty without attachments. n_pull is 3 n_attachment, filled up to n_pull_pad. */
    int n_pull, n_pull_pad, n_mode;
    double *flexibility; /* [n_pull_pad / HF_CHORD_ROWS][n_pull][HF_CHORD_ROWS] rows of F side by side */
    double *mode;        /* [n_mode][2][n_pull] (I + F S)^-1 = I + sum mode[0] mode[1]', where F S is large */
    double *tie_block; /* [n_tie][9] stiffness of the cables at attachments; read where the other end is a free node */
    double *base_displacement_m; /* [n_pull] */
    void *block;
} hf_chord;

/* Scratch of one thread. */
typedef struct {
    double *x_m;     /* [3][n_node][HF_LANES] */
    double *force_N; /* [hf_packed_band_rows][HF_LANES] those of free nodes in the rows of the matrix */
    double *gene;    /* [n_gene + n_cable][HF_LANES] q (N/m) or T (N) of genes by rule; q of the other cables */
    double *pull_N;  /* [n_pull][HF_LANES] of the net on the truss */
    double *displacement_m, *move_m; /* [n_pull_pad][HF_LANES] of the attachments; what the next step adds */
    void *block;
} hf_chord_lanes;

/* The figures of the shape in each lane, with the meanings of hf_form_result and hf_metrics_tension_ratio. They mean
 * nothing in a lane that is not a shape. */
typedef struct {
    _Alignas(HF_ALIGNMENT) double psi_m[HF_LANES];
    double lowest_N[2][HF_LANES], highest_N[2][HF_LANES]; /* tension by hf_group; +-INFINITY without cables */
    double tension_error[HF_LANES];
    double shortest_pulled[HF_LANES],
        shortest_other[HF_LANES]; /* l / theoretical l of cables of given tension or not */
    double longest[HF_LANES];
} hf_chord_measures;

/* The kernels of one instruction set; the comment below says what each does. */
struct hf_chord_kernels {
    void (*forces)(const hf_chord *chord, const hf_chord_lanes *l, double residual_squared[HF_LANES]);
    void (*step)(const hf_chord *chord, const hf_chord_lanes *l);
    void (*couple)(const hf_chord *chord, const hf_chord_lanes *l, double gap_squared[HF_LANES]);
    void (*move)(const hf_chord *chord, const hf_chord_lanes *l);
    void (*measure)(const hf_chord *chord, const hf_chord_lanes *l, hf_chord_measures *measures);
};

#define HF_CHORD_KERNELS(isa)                                                                                          \
    void hf_chord_forces_##isa(const hf_chord *chord, const hf_chord_lanes *l, double residual_squared[HF_LANES]);     \
    void hf_chord_couple_##isa(const hf_chord *chord, const hf_chord_lanes *l, double gap_squared[HF_LANES]);          \
    void hf_chord_move_##isa(const hf_chord *chord, const hf_chord_lanes *l);                                          \
    void hf_chord_step_##isa(const hf_chord *chord, const hf_chord_lanes *l);                                          \
    void hf_chord_measure_##isa(const hf_chord *chord, const hf_chord_lanes *l, hf_chord_measures *measures);

/* forces: writes the nodal forces of every lane into force_N, the pull on the truss into pull_N and the force densities
 *         into gene; residual_squared is per lane the square of the largest nodal force over the reference tension.
 * couple: gap_squared is per lane the square (m^2) of the largest gap F f - r of the truss; writes into move_m the
 *         change of r that closes the gap.
 * move:   adds move_m to displacement_m and to the supports in x_m, and its effect to force_N.
 * step:   adds force_N, which matrix.solve has turned into the Newton step, to x_m.
 * measure: of the shapes in x_m with the force densities that `forces` found there. */
HF_CHORD_KERNELS(portable)
HF_CHORD_KERNELS(avx2)
HF_CHORD_KERNELS(avx512)

#endif
