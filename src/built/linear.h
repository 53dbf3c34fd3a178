/* linear - the linear model of an as-built net: displacements of nodes and changes of tensions by small errors (METHOD
 * section 12, M38).
 *
 * One factor of the Hessian at a shape serves all right-hand sides. Vectors [n_dof] have the entry 3*row + c for
 * coordinate c of a node. Free nodes come first, then attachments, then supports on rigid ground. Between calls of
 * hf_built_linear_take the model is constant. Threads share it, each with its own scratch. */
#pragma once

#include "linalg/packed_band.h"
#include "solve/schur.h"
#include <hifdm/built.h>

typedef struct {
    const hf_built *built;
    size_t n_dof;              /* 3 n_node */
    size_t n_scratch;          /* doubles of scratch for one right-hand side */
    double *unit;              /* [n_cable][3] direction from the first end to the second */
    double *stiffness_N_per_m; /* [n_cable] EA/l0; 0 of slack cables */
    double *cut_N_per_m;       /* [n_cable] dT/dl0 at fixed positions, -EA l/l0^2; 0 of slack cables */
    double *ratio_N;           /* [n_cable] l0 dT/dl0, for relative errors of lengths; EA dT/dEA is the tension */
    double *block_N_per_m;     /* [n_cable][9] stiffness matrix between the ends */
    hf_workspace work;         /* the shape and the factor of its Hessian */
    hf_schur schur;            /* net and truss together; empty without a truss */
    bool is_factored;          /* false: the last factorisation failed */
    int n_factor;              /* number of factorisations; it changes with the shape */
    void *block;
} hf_built_linear;

/* Returns n_scratch, which may be needed before the linear model exists. */
static inline size_t hf_built_linear_scratch(const hf_model *model)
{
    return 3 * (size_t)model->n_node + (model->n_attachment ? 3 * (size_t)(model->n_free + model->n_attachment) : 0);
}

/* Factors the Hessian at the nominal shape of `built`, which is borrowed. Returns HF_OK; HF_SINGULAR when the net has
 * no stiffness there; HF_NO_MEMORY. Call hf_built_linear_free in any case. */
hf_status hf_built_linear_make(const hf_built *built, hf_built_linear *linear);

/* Factors the Hessian at another shape of the net, as hf_built_solve leaves it in a workspace. Springs hold loose nodes
 * in their positions. Does nothing when the shape is the same as before. Returns HF_OK or HF_SINGULAR. */
hf_status hf_built_linear_take(hf_built_linear *linear, const hf_workspace *shape);
void hf_built_linear_free(hf_built_linear *linear);

/* Computes displacements from errors, for n right-hand sides. strain_N [n][n_cable] are the changes of tension at fixed
 * positions, such as cut_N_per_m times the error of a length; load_N [n][n_dof] are added to the loads of nodes. Both
 * may be NULL: none. move_m [n][n_dof] contains the displacements of supports where they rest on entry, and those of
 * all nodes on return. Entries of free nodes are ignored on entry. scratch is [n][n_scratch]. `by` makes it faster for
 * large n: it has the factor of linear->work packed for eight right-hand sides, and lanes of the calling thread
 * (linalg/packed_band.h). `by` may be NULL. */
typedef struct {
    const hf_packed_band *matrix;
    double *lanes;
} hf_built_lanes;
void hf_built_linear_apply(const hf_built_linear *linear, const hf_built_lanes *by, int n, const double *strain_N,
                           const double *load_N, double *move_m, double *scratch);

/* Computes the changes of tension change_N [n_cable] by the displacements move_m [n_dof] and the strains strain_N
 * [n_cable] (NULL: none). */
void hf_built_linear_tension(const hf_built_linear *linear, const double *strain_N, const double *move_m,
                             double *change_N);

/* Computes the transpose of hf_built_linear_apply for n right-hand sides. slope [n][n_dof] contains derivatives with
 * respect to positions on entry. On return it contains those with respect to the resting positions of supports; entries
 * of free nodes are then meaningless. strain [n][n_cable] receives the derivatives with respect to strain_N. */
void hf_built_linear_transpose(const hf_built_linear *linear, int n, double *slope, double *strain, double *scratch);
