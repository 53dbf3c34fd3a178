/* linear - the first-order answer of a net as built to its errors: where nodes go, and what tensions do, when cables
 * are cut a little wrong (METHOD section 12). One factor of the Hessian at the nominal shape serves all.
 *
 * Places are listed by dof 3*row + c over all nodes, [3 n_node]: free nodes first, then attachments, then the supports
 * on rigid ground. Everything is constant once it is made, so threads share it, each with scratch of its own. */
#ifndef HIFDM_LINEAR_H
#define HIFDM_LINEAR_H

#include "linalg/packed_band.h"
#include "solve/schur.h"
#include <hifdm/built.h>

typedef struct {
    const hf_built *built;
    size_t n_dof;              /* 3 n_node */
    size_t n_scratch;          /* doubles of scratch for one right-hand side */
    double *unit;              /* [n_cable][3] direction of the cable, from its first end to the second */
    double *stiffness_N_per_m; /* [n_cable] EA/l0; 0 of slack cables */
    double *cut_N_per_m;       /* [n_cable] dT/dl0 at held places, -EA l/l0^2; 0 of slack cables */
    double *ratio_N;           /* [n_cable] the same by the ratio of the length, l0 dT/dl0. That by EA is the tension */
    double *block_N_per_m;     /* [n_cable][9] stiffness between the ends */
    hf_workspace work;         /* the shape and its factor */
    hf_schur schur;            /* net and truss together; nothing without a truss */
    bool is_factored;          /* false: the last factor failed */
    int n_factor;              /* how often it was factored: another number is another shape */
    void *block;
} hf_built_linear;

/* Factor at the nominal shape of `built`, which is borrowed. HF_OK; HF_SINGULAR when something is loose there;
 * HF_NO_MEMORY. Free it in any case. */
hf_status hf_built_linear_make(const hf_built *built, hf_built_linear *linear);

/* The same at another shape of the net, that which hf_built_solve leaves in a workspace. Loose nodes stay where they
 * are. At the same shape as before nothing is done. */
hf_status hf_built_linear_take(hf_built_linear *linear, const hf_workspace *shape);
void hf_built_linear_free(hf_built_linear *linear);

/* Errors to moves. strain_N [n][n_cable] (NULL: none): what the errors change in the tensions at held places, such as
 * cut_N_per_m times the error of a length. move_m [n][n_dof]: in, how far supports are off where they rest, other
 * entries without meaning; out, how far all nodes move. scratch: [n][n_scratch]. */
void hf_built_linear_apply(const hf_built_linear *linear, int n, const double *strain_N, double *move_m,
                           double *scratch);

/* The same, eight at a time where n is large: with the factor of linear->work, packed, and lanes of the calling thread
 * (linalg/packed_band.h). by: NULL: hf_built_linear_apply. load_N [n][n_dof] (NULL: none): what is added to the loads
 * of nodes. */
typedef struct {
    const hf_packed_band *matrix;
    double *lanes;
} hf_built_lanes;
void hf_built_linear_apply_by(const hf_built_linear *linear, const hf_built_lanes *by, int n, const double *strain_N,
                              const double *load_N, double *move_m, double *scratch);

/* What such a move and strain [n_cable] (may be NULL) change in the tensions, change_N [n_cable]. */
void hf_built_linear_tension(const hf_built_linear *linear, const double *strain_N, const double *move_m,
                             double *change_N);

/* The transpose: from derivatives with respect to places, slope [n][n_dof], to those with respect to what apply takes:
 * strain [n][n_cable], and in place where supports rest; the entries of free nodes mean nothing then. */
void hf_built_linear_transpose(const hf_built_linear *linear, int n, double *slope, double *strain, double *scratch);

#endif
