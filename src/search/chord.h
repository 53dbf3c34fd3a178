/* chord - evaluates designs near one initial design by Newton steps that share one matrix. The matrix is factored once,
 * at the initial design, and read by all threads. Each triangular solve serves eight designs, one in each SIMD lane.
 *
 * A design has converged when its own nodal forces are below the tolerance. The shared matrix only affects how many
 * steps that takes. The kernels measure the final shape, too. If the shape has a fault, the scalar code of formfind
 * measures it again and identifies the fault. If the residual of a design does not fall fast enough, hf_evaluate solves
 * the design instead. No operation mixes lanes, so a result depends neither on the designs in the other lanes nor on
 * the thread. */
#pragma once

#include "base/arena.h"
#include "base/lane.h"
#include "linalg/packed_band.h"
#include "search/lane_schedule.h"
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

/* The arrays of hf_chord for a model m. Those of net and truss together are empty without attachments. */
#define HF_CHORD_FIELDS(X)                                                                                             \
    X(double, base_m, 3 * (size_t)m->n_node, "[3][n_node] shape from which the lanes start")                           \
    X(int, variable_of_cable, m->n_cable, "design variable of the cable, or -1")                                       \
    X(double, variable_divisor, m->n_variable, "divisor of the design variable: a length (m) or 1")                    \
    X(double, inverse_length, m->n_cable, "1 / length between target positions, 1/m")                                  \
    X(int, slot_of_cable, m->n_cable, "row of its q in `variable`: its design variable or n_variable + cable")         \
    X(int, pulled, m->n_cable, "[n_pulled] cables with a given tension")                                               \
    X(unsigned char, is_pulled, m->n_cable, "1 for cables with a given tension")                                       \
    X(int, place_of_row, m->n_node, "free node, or n_free + attachment, or -1")                                        \
    X(int, incidence_start, (size_t)m->n_free + (size_t)m->n_attachment + 1, "first incidence of each node, by place") \
    X(hf_chord_incidence, incidence, 2 * (size_t)m->n_cable, "of each node by rising cable")                           \
    X(double, flexibility, n_pull *(size_t)to->n_pull_pad,                                                             \
      "[n_pull_pad / HF_CHORD_ROWS][n_pull][HF_CHORD_ROWS] m/N, flexibility F by blocks of rows")                      \
    X(double, mode, 2 * n_pull * HF_CHORD_MODES_MAX,                                                                   \
      "[n_mode][2][n_pull] left and right: (I + F S)^-1 = I + sum of left right'")                                     \
    X(double, tie_block, 9 * (size_t)m->n_tie,                                                                         \
      "[n_tie][9] N/m, stiffness of cables from attachments; used if the other end is free")                           \
    X(double, base_displacement_m, n_pull, "displacements of the attachments in the initial design")

/* What all threads share. It is constant after hf_chord_create. */
typedef struct hf_chord {
    const hf_evaluator *evaluator;
    const hf_chord_kernels *kernels;
    hf_packed_band matrix; /* factored Newton matrix of the initial design, 3 rows per free node */
    int n_pulled;
    bool serves_all;                /* true if all cables without a design variable have laws of HF_CHORD_LAWS */
    int n_pull, n_pull_pad, n_mode; /* 3 n_attachment; that rounded up to a multiple of HF_CHORD_ROWS; modes */
    HF_CHORD_FIELDS(HF_ARENA_MEMBER)
    hf_arena arena;
} hf_chord;

/* The arrays of hf_chord_lanes for a chord c of a model m. */
#define HF_CHORD_LANES_FIELDS(X)                                                                                       \
    X(double, x_m, 3 * (size_t)m->n_node * HF_LANES, "[3][n_node][HF_LANES] positions")                                \
    X(double, force_N, hf_packed_band_rows(&c->matrix) * HF_LANES,                                                     \
      "[hf_packed_band_rows][HF_LANES] forces on free nodes; after the solve the step, m")                             \
    X(double, variable, ((size_t)m->n_variable + (size_t)m->n_cable) * HF_LANES,                                       \
      "[n_variable + n_cable][HF_LANES] q (N/m) or T (N) of design variables, then q of other cables")                 \
    X(double, pull_N, (size_t)c->n_pull *HF_LANES, "[n_pull][HF_LANES] forces of the net on the attachments")          \
    X(double, displacement_m, (size_t)c->n_pull_pad *HF_LANES, "[n_pull_pad][HF_LANES] of the attachments")            \
    X(double, move_m, (size_t)c->n_pull_pad *HF_LANES, "[n_pull_pad][HF_LANES] their next change")

/* The scratch of one thread. */
typedef struct {
    HF_CHORD_LANES_FIELDS(HF_ARENA_MEMBER)
    double *load_N; /* [3][n_node][HF_LANES] loads of each lane, borrowed; NULL: all lanes have those of the model */
    hf_arena arena;
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

/* How far the lanes of one thread are from equilibrium, and how they came there. */
typedef struct {
    int steps[HF_LANES];
    double residual_N[HF_LANES]; /* maximum nodal force out of balance */
    double gap_m[HF_LANES];      /* maximum |F f - r| of an attachment; 0 without a truss */
    /* The maximum of residual_N and of gap_m scaled to the same tolerance; now and one step before. */
    double excess_N[HF_LANES], excess_before_N[HF_LANES];
    bool is_measured; /* true if `now` holds the figures of the present shapes */
    hf_chord_measures now;
} hf_chord_progress;

/* The kernels of one instruction set.
 *
 * pull:    computes the tension T = k (l - l0) of each taut elastic cable, 0 of each slack one, and q = T/l. cut_m
 *          (l0), stiffness_N_per_m (k = EA/l0), tension_N and q_N_per_m are [n_cable][HF_LANES], and all arrays are
 *          aligned to HF_ALIGNMENT. It serves nets whose cables are all elastic.
 * multiply: computes out [n_pad][HF_LANES] = A in [n][HF_LANES] for a matrix A of n columns and n_pad rows, a multiple
 *          of HF_CHORD_ROWS; `packed` is [n_pad / HF_CHORD_ROWS][n][HF_CHORD_ROWS]. `in` and `out` must not overlap.
 * forces:  computes the nodal forces of every lane into force_N, the forces on the attachments into pull_N and the
 *          force densities into `variable`. residual_squared receives, per lane, the square of the maximum nodal force
 *          divided by the reference tension.
 * couple:  computes the change of r that closes the gap F f - r of the truss into move_m. gap_squared receives, per
 *          lane, the square of the maximum gap, m^2.
 * move:    adds move_m to displacement_m and to the attachments in x_m, and its effect on the forces to force_N.
 * step:    adds force_N, which matrix.solve has replaced by the Newton step, to the free nodes in x_m.
 * measure: measures the shapes in x_m with the force densities that `forces` computed there. */
struct hf_chord_kernels {
    void (*pull)(const hf_model *model, const double *x_m, const double *cut_m, const double *stiffness_N_per_m,
                 double *tension_N, double *q_N_per_m);
    void (*multiply)(int n_pad, int n, const double *packed, const double *in, double *out);
    void (*forces)(const hf_chord *chord, const hf_chord_lanes *l, double residual_squared[HF_LANES]);
    void (*step)(const hf_chord *chord, const hf_chord_lanes *l);
    void (*couple)(const hf_chord *chord, const hf_chord_lanes *l, double gap_squared[HF_LANES]);
    void (*move)(const hf_chord *chord, const hf_chord_lanes *l);
    void (*measure)(const hf_chord *chord, const hf_chord_lanes *l, hf_chord_measures *measures);
};

extern const hf_chord_kernels HF_LANE_EACH(hf_chord_kernels);

/* Returns true if chord can solve the designs of this evaluator. Each design variable must set a tension or a force
 * density. All other cables must have a law of HF_CHORD_LAWS, except those between two fixed supports. The net must
 * have a Newton matrix (a convex energy), and form.factor must not be `lapack`. */
bool hf_chord_applies(const hf_evaluator *evaluator);

/* Evaluates the initial design [n_variable], factors its Newton matrix and packs it for the lanes. workspace and point
 * are scratch. Returns HF_OK, HF_NO_MEMORY, or another status if the initial design has no shape or no positive
 * definite matrix. The caller frees its arena in any case. */
hf_status hf_chord_create(const hf_evaluator *evaluator, const double *initial, hf_workspace *workspace,
                          hf_objectives_point *point, hf_chord *chord);

/* Makes the shared matrix at the shape that the workspace holds, whatever the laws of its cables. This serves nets
 * without design variables: the caller writes the force density of cable e into row n_variable + e of `variable` of the
 * lanes. inverse [n_pull_pad / HF_CHORD_ROWS][n_pull][HF_CHORD_ROWS] receives (I + F S)^-1 in place of its modes; NULL
 * makes the modes. Returns HF_OK, HF_NO_MEMORY or HF_SINGULAR. The caller frees its arena in any case. */
hf_status hf_chord_create_here(const hf_evaluator *evaluator, hf_workspace *workspace, double *inverse,
                               hf_chord *chord);

/* Returns the size in bytes of the shared matrix for this evaluator. *lanes_bytes is set to the size of the lanes of
 * one thread. */
size_t hf_chord_bytes(const hf_evaluator *evaluator, size_t *lanes_bytes);

/* Allocates the lanes of one thread. Returns HF_OK or HF_NO_MEMORY; the caller frees its arena. */
hf_status hf_chord_lanes_create(const hf_chord *chord, hf_chord_lanes *lanes);

/* The steps of a lane, which hf_chord_run and built/near.h share. hf_chord_begin starts a lane with the displacements
 * of the initial shape. hf_chord_look computes the forces in all lanes and sets residual, gap and excess.
 * hf_chord_goes_on returns true, and counts a step, if the lane shall take one more because its excess falls fast
 * enough; this is not required of the first `patience` steps. hf_chord_report measures all lanes unless they are
 * measured, and writes the figures of a converged lane. */
void hf_chord_begin(const hf_chord *chord, const hf_chord_lanes *lanes, int lane, hf_chord_progress *progress);
void hf_chord_look(const hf_chord *chord, const hf_chord_lanes *lanes, hf_chord_progress *progress);
bool hf_chord_goes_on(int lane, int patience, hf_chord_progress *progress);
void hf_chord_report(const hf_chord *chord, const hf_chord_lanes *lanes, int lane, hf_chord_progress *progress,
                     hf_form_result *result);

/* Evaluates the designs whose indices next(context) returns, until it returns -1. design: [][n_variable]; result: [].
 * If keeps_shape is true, the workspace holds the last shape afterwards; otherwise it is scratch. `point` is scratch of
 * the objectives, as for hf_evaluate. */
void hf_chord_run(const hf_chord *chord, hf_chord_lanes *lanes, hf_workspace *workspace, hf_objectives_point *point,
                  hf_lane_next *next, void *context, bool keeps_shape, const double *design, hf_form_result *result);
