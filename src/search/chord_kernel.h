/* chord_kernel - implements the inner loops of chord. They are compiled once for each instruction set, and chord.c
 * chooses one at run time. */
#ifndef HIFDM_CHORD_KERNEL_H
#define HIFDM_CHORD_KERNEL_H

#include "base/arena.h"
#include "base/lane.h"
#include "linalg/packed_band.h"
#include <hifdm/evaluate.h>

typedef struct hf_chord_kernels hf_chord_kernels;

#define HF_CHORD_ROWS 8       /* rows of the flexibility that are multiplied at a time */
#define HF_CHORD_MODES_MAX 48 /* maximum of n_mode */

/* Flags of the laws that the kernels support: a given tension or force density, so that the positions are the only
 * unknowns. */
#define HF_CHORD_LAWS (HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_GIVES_TENSION | HF_LAW_MAY_PUSH)

/* A cable seen from one of its nodes. */
typedef struct {
    int slot;  /* row of its force density in `variable` */
    int other; /* model row of its other end */
} hf_chord_incidence;

/* What all threads share. It is constant after hf_chord_create. */
typedef struct hf_chord {
    const hf_evaluator *evaluator;
    const hf_chord_kernels *kernels;
    hf_packed_band matrix;    /* factored Newton matrix of the initial design, 3 rows per free node */
    double *base_m;           /* [3][n_node], shape from which the lanes start */
    int *variable_of_cable;   /* [n_cable], design variable of the cable, or -1 */
    double *variable_divisor; /* [n_variable], divisor of the design variable: a length (m) or 1 */
    double *inverse_length;   /* [n_cable], 1 / length between target positions, 1/m */
    int *slot_of_cable;       /* [n_cable], row of its q in `variable`: its design variable or n_variable + cable */
    int n_pulled, *pulled;    /* [n_pulled], cables with a given tension */
    unsigned char *is_pulled; /* [n_cable], 1 for cables with a given tension */
    int *place_of_row;        /* [n_node], free node, or n_free + attachment, or -1 */
    int *incidence_start;     /* [n_free + n_attachment + 1], first incidence of each node, by place_of_row */
    hf_chord_incidence *incidence; /* [incidence_start[n_free + n_attachment]], of each node by rising cable */
    bool serves_all;               /* true if all cables without a design variable have laws of HF_CHORD_LAWS */

    /* Net and truss together. Without attachments, all of these are empty. n_pull is 3 n_attachment, and n_pull_pad is
     * n_pull rounded up to a multiple of HF_CHORD_ROWS. */
    int n_pull, n_pull_pad, n_mode;
    double *flexibility; /* [n_pull_pad / HF_CHORD_ROWS][n_pull][HF_CHORD_ROWS], m/N, flexibility F by blocks of rows */
    double *mode;        /* [n_mode][2][n_pull], left and right: (I + F S)^-1 = I + sum of left right' */
    double *tie_block;   /* [n_tie][9], N/m, stiffness of cables from attachments; used if the other end is free */
    double *base_displacement_m; /* [n_pull], m, displacements of the attachments in the initial design */
    void *block;
} hf_chord;

/* The scratch of one thread. */
typedef struct {
    double *x_m;     /* [3][n_node][HF_LANES], positions */
    double *force_N; /* [hf_packed_band_rows][HF_LANES], forces on free nodes; after the solve the step, m */
    double
        *variable;  /* [n_variable + n_cable][HF_LANES], q (N/m) or T (N) of design variables, then q of other cables */
    double *pull_N; /* [n_pull][HF_LANES], forces of the net on the attachments */
    double *displacement_m, *move_m; /* [n_pull_pad][HF_LANES], displacements of attachments; their next change */
    void *block;
} hf_chord_lanes;

/* The figures of the shape in each lane, as defined by hf_form_result and hf_metrics_tension_ratio. They are undefined
 * in a lane without a shape. */
typedef struct {
    _Alignas(HF_ALIGNMENT) double psi_m[HF_LANES];
    /* The extreme tensions of each hf_group; INFINITY and -INFINITY if it has no cables. */
    double lowest_N[2][HF_LANES], highest_N[2][HF_LANES];
    double tension_error[HF_LANES];
    /* The minimum of l / length at target over cables with a given tension, and over the others. */
    double shortest_pulled[HF_LANES], shortest_other[HF_LANES];
    double longest[HF_LANES];
} hf_chord_measures;

/* The kernels of one instruction set. The comment below describes each of them. */
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

/* forces:  computes the nodal forces of every lane into force_N, the forces on the attachments into pull_N and the
 *          force densities into `variable`. residual_squared receives, per lane, the square of the maximum nodal force
 *          divided by the reference tension.
 * couple:  computes the change of r that closes the gap F f - r of the truss into move_m. gap_squared receives, per
 *          lane, the square of the maximum gap, m^2.
 * move:    adds move_m to displacement_m and to the attachments in x_m, and its effect on the forces to force_N.
 * step:    adds force_N, which matrix.solve has replaced by the Newton step, to the free nodes in x_m.
 * measure: measures the shapes in x_m with the force densities that `forces` computed there. */
HF_CHORD_KERNELS(portable)
HF_CHORD_KERNELS(avx2)
HF_CHORD_KERNELS(avx512)

#endif
