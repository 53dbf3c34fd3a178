/* swarm - runs the paper's iteration for many designs, eight at a time in the SIMD lanes of `lane`. It does what
 * hf_evaluate does with the solver fixed_point, about fifteen times faster. A lane that has finished takes the next
 * design. No operation mixes lanes, so a result depends neither on the designs in the other lanes nor on the thread.
 *
 * The eight share the net, its numbering and the laws. Each has its own force densities, targets and support positions.
 * Every array below ends in [HF_LANES], with entry k for lane k. Meaningless numbers, NaN or an indefinite matrix in
 * one lane do not change a bit in the others. A lane without a design holds a copy of another one.
 *
 *     One iteration, by the kernels of the plan:
 *
 *         solve(plan, w)                  force densities -> positions (Eqs. 2, 5)
 *         measure(plan, w, &measures)     lengths, errors, next force densities (Eqs. 4, 7, 8)
 *         residual(plan, w, &measures)
 *         ... hf_swarm_get each design that has ended ...
 *         hf_swarm_update(w)
 *         ... hf_swarm_put the designs that take their lanes ...
 *
 * A lane row is a model row plus n_pad: n_pad dummy rows in front make the free rows fill blocks of HF_SWARM_BLOCK. The
 * matrix is stored as square tiles of HF_SWARM_BLOCK by HF_SWARM_BLOCK entries. The tiles of a block row are
 * contiguous, from the first one with an entry (skyline) to the one on the diagonal. Inside a tile, the columns are
 * contiguous; see hf_swarm_place. Arrays are aligned to 64 bytes. */
#pragma once

#include "base/arena.h"
#include "base/lane.h"
#include "search/lane_schedule.h"

#include <hifdm/evaluate.h>

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

/* The arrays that all threads share, for a plan `to` of a model m. A block row has at most n_widest tiles. */
#define HF_SWARM_PLAN_FIELDS(X)                                                                                        \
    X(int, first_column, to->n_block, "lane column of the first entry in a block row")                                 \
    X(size_t, tile_0, to->n_block, "number that the tile of the block row in tile column 0 would have")                \
    X(unsigned char, has_entry, (size_t)to->n_block *n_widest, "[n_tile], 1 if D has an entry in the tile")            \
    X(int, incidence_start, (size_t)m->n_free + 1, "by model row")                                                     \
    X(hf_swarm_incidence, incidence, 2 * (size_t)m->n_cable,                                                           \
      "[incidence_start[n_free]], of each node by rising cable")                                                       \
    X(double, inverse_length, m->n_cable, "1 / length between target positions, 1/m")

/* What all threads share, besides the model. */
typedef struct {
    const hf_model *model; /* borrowed: must outlive the plan */
    const hf_swarm_kernels *kernels;
    int n_pad;     /* number of dummy rows in front, 0 to HF_SWARM_BLOCK - 1 */
    int n_block;   /* number of block rows: n_pad + n_free = n_block * HF_SWARM_BLOCK */
    size_t n_tile; /* number of stored tiles */
    HF_SWARM_PLAN_FIELDS(HF_ARENA_MEMBER)
    void *block;
} hf_swarm_plan;

/* X(type, name, number of items for a plan `plan` of a model m, unit, meaning): one row per array of a lane. */
#define HF_SWARM_FIELDS(X)                                                                                             \
    X(double, matrix, plan->n_tile *HF_SWARM_BLOCK *HF_SWARM_BLOCK *HF_LANES, "N/m",                                   \
      "D, then its factor: hf_swarm_place")                                                                            \
    X(double, position_m, ((size_t)plan->n_pad + (size_t)m->n_node) * 3 * HF_LANES, "m", "[n_pad + n_node][3][8]")     \
    X(double, q_N_per_m, (size_t)m->n_cable *HF_LANES, "N/m", "[n_cable][8] force densities of this shape")            \
    X(double, next_q_N_per_m, (size_t)m->n_cable *HF_LANES, "N/m", "[n_cable][8] as the laws update them")             \
    X(double, length_m, (size_t)m->n_cable *HF_LANES, "m", "[n_cable][8] lengths of this shape")                       \
    X(double, target, (size_t)m->n_cable *HF_LANES, "by law", "[n_cable][8] T* (N), L* (m) or q (N/m)")                \
    X(unsigned char, law, m->n_cable, "", "[n_cable] hf_law in force, for all lanes: set by the caller")               \
    X(int, bad_row, HF_LANES, "", "[8] model row of the first pivot that was not positive, or -1")

/* The scratch of one thread. Apart from what the caller has written, its contents are undefined. */
typedef struct {
    HF_SWARM_FIELDS(HF_ARENA_MEMBER)
    hf_arena arena;
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
    double residual_N[HF_LANES];         /* set by `residual` */
    double psi_m[HF_LANES];              /* set by `psi` */
    unsigned char is_finite[HF_LANES];   /* 1 if every tension is a finite number */
} hf_swarm_measures;

/* Returns the index in `matrix` of lane 0 of entry (i, j); i and j are lane rows, first_column <= j <= i. In the
 * factor, a diagonal position holds the reciprocal of the diagonal entry. */
static inline size_t hf_swarm_place(const hf_swarm_plan *plan, int i, int j)
{
    size_t column = plan->tile_0[i / HF_SWARM_BLOCK] * HF_SWARM_BLOCK + (size_t)j;
    return (column * HF_SWARM_BLOCK + (size_t)(i % HF_SWARM_BLOCK)) * HF_LANES;
}

/* The kernels of one instruction set.
 *
 * assemble:   assembles D from the force densities in the tiles of `matrix` that have entries. Writes the right-hand
 *             sides (loads, and the forces from supports) into the free rows of position_m.
 * factor:     replaces D by its Cholesky factor. A pivot that is not positive sets bad_row. Its row and column are
 *             removed, so that the numbers of the lane stay bounded.
 * substitute: replaces the right-hand sides in the free rows of position_m by the solutions.
 * solve:      assembles, factors and substitutes, with the bits of the three calls in less time: the forward
 *             substitution runs while the factor is in the cache.
 * measure:    computes lengths, errors against the laws and the next force densities. Sets all measures except
 *             residual_N and psi_m.
 * residual:   sets residual_N, the maximum force out of balance at a free node with every cable at the tension of its
 *             law. Call it after `measure`.
 * psi:        sets psi_m, the root mean square of Eq. 10. */
struct hf_swarm_kernels {
    void (*assemble)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
    void (*factor)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
    void (*substitute)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
    void (*solve)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);
    void (*measure)(const hf_swarm_plan *plan, hf_swarm_lanes *lanes, hf_swarm_measures *measures);
    void (*residual)(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures);
    void (*psi)(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, hf_swarm_measures *measures);
};

extern const hf_swarm_kernels HF_LANE_EACH(hf_swarm_kernels);

/* ---- the iteration in the lanes ---- */

/* Makes the plan of a model without struts, with the kernels of an instruction set that this machine has. Returns HF_OK
 * or HF_NO_MEMORY; the caller frees its block. */
hf_status hf_swarm_plan_create(const hf_model *model, hf_lane_isa isa, hf_swarm_plan *plan);

/* hf_swarm_lanes_create allocates the fields in one block, and returns HF_OK or HF_NO_MEMORY; the caller frees its
 * arena. hf_swarm_lanes_bytes returns the size of the block. The same lanes serve all plans of one model. */
size_t hf_swarm_lanes_bytes(const hf_swarm_plan *plan);
hf_status hf_swarm_lanes_create(const hf_swarm_plan *plan, hf_swarm_lanes *lanes);

/* Copies the force densities, targets and support positions of one design from a workspace into a lane. The caller sets
 * the laws. */
void hf_swarm_put(const hf_swarm_plan *plan, const hf_workspace *from, int lane, hf_swarm_lanes *lanes);

/* Copies the shape of a lane into a workspace, after `measure`: positions, force densities, lengths and
 * tensions. */
void hf_swarm_get(const hf_swarm_plan *plan, const hf_swarm_lanes *lanes, int lane, hf_workspace *to);

/* Makes the next force densities the present ones. */
void hf_swarm_update(hf_swarm_lanes *lanes);

/* ---- many designs ---- */

/* Evaluates the designs whose indices next(context) returns, until it returns -1. The evaluator has no objectives.
 * design: [][n_variable]; result: []. A design without a shape has its status in the result. If its lane fails and the
 * model has no Newton matrix, the result does not identify the cable or node at fault. */
void hf_swarm_run(const hf_evaluator *evaluator, const hf_swarm_plan *plan, hf_swarm_lanes *lanes,
                  hf_workspace *workspace, hf_lane_next *next, void *context, const double *design,
                  hf_form_result *result);
