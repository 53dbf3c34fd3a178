/* lane - the form-finding iteration for eight individuals of one net at a time, one in each SIMD lane.
 *
 * The eight share the net, its numbering and the laws; each has its own force densities, targets and support positions.
 * Every array below ends in [HF_LANES]: place k belongs to individual k, and no operation mixes lanes. Meaningless
 * numbers, NaN or an indefinite matrix in one lane do not change a bit in the others. A lane without an individual
 * holds a copy of another one.
 *
 * One iteration:    hf_lane_solve(plan, w);                  force densities -> positions (Eqs. 2, 5)
 *                   hf_lane_measure(plan, w, &measures);     lengths, errors, the next force densities (Eqs. 4, 7, 8)
 *                   hf_lane_residual(plan, w, &measures);
 *                   ... hf_lane_get each individual that has ended ...
 *                   hf_lane_update(w);
 *                   ... hf_lane_put the individuals that take their lanes ...
 *
 * All instruction sets give the same bits: there are always eight lanes, one order of operations, and only IEEE + - * /
 * and square root. Multiply-adds are never fused; lane_kernel.c gives the measured price of this.
 *
 * A lane row is a model row plus n_pad: n_pad dummy rows in front make the free rows fill blocks of HF_LANE_BLOCK. The
 * matrix is stored as square tiles of HF_LANE_BLOCK by HF_LANE_BLOCK entries. The tiles of one block row are
 * contiguous, from the first that has an entry (skyline) to the one on the diagonal; inside a tile the columns are
 * contiguous: see hf_lane_place. Arrays are aligned to 64 bytes. */
#ifndef HIFDM_LANE_H
#define HIFDM_LANE_H

#include "base/arena.h"

#include <hifdm/workspace.h>

#include <stdbool.h>
#include <stddef.h>

/* Laws that the kernels serve: Eqs. 5, 7 and 8 towards a given force density, tension or length. */
#define HF_LANE_LAWS                                                                                                   \
    (HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_GIVES_TENSION | HF_LAW_HAS_MULTIPLIER | HF_LAW_IS_RIGID |             \
     HF_LAW_MAY_PUSH)

#define HF_LANES 8
#define HF_LANE_BLOCK 4

/* Names of the instruction sets, slowest first. */
typedef enum { HF_LANE_PORTABLE, HF_LANE_AVX2, HF_LANE_AVX512 } hf_lane_isa;
#define HF_LANE_N_ISA 3

typedef struct hf_lane_kernels hf_lane_kernels;

/* A cable seen from one of its nodes. */
typedef struct {
    int i_cable;
    int other; /* lane row at its other end */
} hf_lane_incidence;

/* What all threads share besides the model. */
typedef struct {
    const hf_model *model; /* not owned: must outlive the plan */
    const hf_lane_kernels *kernels;
    int n_pad;                    /* dummy rows in front, 0..HF_LANE_BLOCK-1 */
    int n_block;                  /* of rows: n_pad + n_free = n_block * HF_LANE_BLOCK */
    size_t n_tile;                /* stored, all together */
    int *first_column;            /* [n_block] lane column of the first entry in a block row */
    size_t *tile_0;               /* [n_block] number that the tile of a block row in tile column 0 would have */
    unsigned char *has_entry;     /* [n_tile] by number of the tile: has D an entry there? */
    int *incidence_start;         /* [n_free + 1] by model row */
    hf_lane_incidence *incidence; /* [incidence_start[n_free]], of each node by rising cable */
    double *inverse_length;       /* [n_cable] 1 / theoretical length, 1/m */
    void *block;
} hf_lane_plan;

/* X(type, name, number of items for a plan p of a model m, unit, meaning) */
#define HF_LANE_FIELDS(X)                                                                                              \
    X(double, matrix, p->n_tile *HF_LANE_BLOCK *HF_LANE_BLOCK *HF_LANES, "N/m", "D, then its factor: hf_lane_place")   \
    X(double, position_m, ((size_t)p->n_pad + (size_t)m->n_node) * 3 * HF_LANES, "m", "[n_pad + n_node][3][8]")        \
    X(double, q_N_per_m, (size_t)m->n_cable *HF_LANES, "N/m", "[n_cable][8] force densities of this shape")            \
    X(double, next_q_N_per_m, (size_t)m->n_cable *HF_LANES, "N/m", "[n_cable][8] as the laws update them")             \
    X(double, length_m, (size_t)m->n_cable *HF_LANES, "m", "[n_cable][8] lengths of this shape")                       \
    X(double, target, (size_t)m->n_cable *HF_LANES, "by law", "[n_cable][8] T* (N), L* (m) or q (N/m)")                \
    X(unsigned char, law, m->n_cable, "", "[n_cable] hf_law in force, for all lanes: set by the caller")               \
    X(int, bad_row, HF_LANES, "", "[8] model row of the first pivot that was not positive, or -1")

/* The scratch of one thread. Its contents mean nothing except what the caller has put in. */
typedef struct {
#define HF_LANE_MEMBER(type, name, count, unit, meaning) type *name;
    HF_LANE_FIELDS(HF_LANE_MEMBER)
#undef HF_LANE_MEMBER
    void *block;
} hf_lane_workspace;

/* The measures of each lane, with the meanings of hf_form_result. They mean nothing in a lane that is not finite or has
 * a bad_row. */
typedef struct {
    _Alignas(HF_ALIGNMENT) double tension_error[HF_LANES]; /* max |T/T*-1| over cables of law tension, 0 without one */
    double length_error[HF_LANES];                         /* max |l/L*-1| over taut cables of law length, or 0 */
    double length_gap[HF_LANES];                           /* the same; a slack cable counts by its part of the pull */
    double shortest_length_ratio[HF_LANES];                /* min l / theoretical l over all cables */
    double longest_length_ratio[HF_LANES];                 /* max of the same */
    double shortest_of_law[3][HF_LANES];                   /* the minimum by hf_law, infinite without one */
    double residual_N[HF_LANES];                           /* set by hf_lane_residual */
    double psi_m[HF_LANES];                                /* set by hf_lane_psi */
    unsigned char is_finite[HF_LANES];                     /* every tension is a finite number */
} hf_lane_measures;

/* ---- set-up ---- */

bool hf_lane_has_isa(hf_lane_isa isa); /* can this machine run it? */
hf_lane_isa hf_lane_best_isa(void);    /* the fastest that this machine can run */
const char *hf_lane_isa_name(hf_lane_isa isa);

/* Make the plan of a model without struts, with the kernels of an instruction set that this machine has. Returns HF_OK
 * or HF_NO_MEMORY; free in either case. */
hf_status hf_lane_plan_create(const hf_model *model, hf_lane_isa isa, hf_lane_plan *plan);
void hf_lane_plan_free(hf_lane_plan *plan);

/* hf_lane_workspace_take lays the fields out in the caller's arena. hf_lane_workspace_create allocates a block for
 * them: HF_OK or HF_NO_MEMORY; free in either case. One workspace serves all plans of the same model. */
void hf_lane_workspace_take(hf_arena *arena, const hf_lane_plan *plan, hf_lane_workspace *workspace);
size_t hf_lane_workspace_bytes(const hf_lane_plan *plan);
hf_status hf_lane_workspace_create(const hf_lane_plan *plan, hf_lane_workspace *workspace);
void hf_lane_workspace_free(hf_lane_workspace *workspace);

/* Copy the force densities, targets and support positions of one individual into a lane. The caller sets the laws. */
void hf_lane_put(const hf_lane_plan *plan, const hf_workspace *from, int lane, hf_lane_workspace *workspace);

/* Copy the shape of a lane into a workspace, after hf_lane_measure: positions, force densities, lengths and
 * tensions. */
void hf_lane_get(const hf_lane_plan *plan, const hf_lane_workspace *workspace, int lane, hf_workspace *to);

/* Index into `matrix` of lane 0 of entry (i, j); i and j are lane rows, first_column <= j <= i. A diagonal place of the
 * factor holds the reciprocal of the diagonal entry. */
static inline size_t hf_lane_place(const hf_lane_plan *plan, int i, int j)
{
    size_t column = plan->tile_0[i / HF_LANE_BLOCK] * HF_LANE_BLOCK + (size_t)j;
    return (column * HF_LANE_BLOCK + (size_t)(i % HF_LANE_BLOCK)) * HF_LANES;
}

/* ---- kernels ---- */

struct hf_lane_kernels {
    void (*assemble)(const hf_lane_plan *plan, hf_lane_workspace *workspace);
    void (*factor)(const hf_lane_plan *plan, hf_lane_workspace *workspace);
    void (*substitute)(const hf_lane_plan *plan, hf_lane_workspace *workspace);
    void (*solve)(const hf_lane_plan *plan, hf_lane_workspace *workspace);
    void (*measure)(const hf_lane_plan *plan, hf_lane_workspace *workspace, hf_lane_measures *measures);
    void (*residual)(const hf_lane_plan *plan, const hf_lane_workspace *workspace, hf_lane_measures *measures);
    void (*psi)(const hf_lane_plan *plan, const hf_lane_workspace *workspace, hf_lane_measures *measures);
};

/* The kernels of each instruction set; machines other than x86-64 have only the first. */
extern const hf_lane_kernels hf_lane_kernels_portable, hf_lane_kernels_avx2, hf_lane_kernels_avx512;

/* Write D, from the force densities, into the tiles of `matrix` that have entries, and the right-hand sides (loads, and
 * the pull of the supports) into the free rows of position_m. */
void hf_lane_assemble(const hf_lane_plan *plan, hf_lane_workspace *workspace);

/* Replace D by its Cholesky factor. A pivot that is not positive sets bad_row; its row and column are taken out, so
 * that the numbers of the lane stay bounded. */
void hf_lane_factor(const hf_lane_plan *plan, hf_lane_workspace *workspace);

/* Replace the right-hand sides in the free rows of position_m by the solutions. */
void hf_lane_substitute(const hf_lane_plan *plan, hf_lane_workspace *workspace);

/* Assemble, factor and substitute. The forward substitution is done while the factor is in the cache: the bits are
 * those of the three calls, in less time. */
void hf_lane_solve(const hf_lane_plan *plan, hf_lane_workspace *workspace);

/* Compute lengths, errors against the laws and the next force densities. Sets all measures but residual_N and psi_m. */
void hf_lane_measure(const hf_lane_plan *plan, hf_lane_workspace *workspace, hf_lane_measures *measures);

/* Set residual_N: the largest force out of balance at a free node with every cable at the tension of its law. Call it
 * after hf_lane_measure. */
void hf_lane_residual(const hf_lane_plan *plan, const hf_lane_workspace *workspace, hf_lane_measures *measures);

/* Set psi_m, the root mean square of Eq. 10. */
void hf_lane_psi(const hf_lane_plan *plan, const hf_lane_workspace *workspace, hf_lane_measures *measures);

/* Make the next force densities the present ones. */
void hf_lane_update(hf_lane_workspace *workspace);

#endif
