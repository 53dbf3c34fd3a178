/* sensitivity - exact derivatives of a net's shape with respect to the genes of a design (METHOD section 7, M11): one
 * solve with the factored Newton matrix per variable. A variable is a gene, or a class of linked genes that change by
 * the same step. With a truss the supports move, too.
 *
 * A cable of law length is a stiff spring in the matrix. One more solve takes out what that leaves of the derivative of
 * its length, a part of 1/HF_NEWTON_STIFFENING, and a third what the spring rounds off. */
#ifndef HIFDM_SENSITIVITY_H
#define HIFDM_SENSITIVITY_H

#include "linalg/packed_band.h"
#include "solve/schur.h"
#include <hifdm/evaluate.h>

typedef struct {
    const hf_evaluator *v;
    int n;                 /* variables */
    size_t n_dof;          /* dof 3*row + c of free nodes, then 3*attachment + c, then those of supports that move */
    int *variable_of_gene; /* [n_gene] */
    int *gene_of_cable;    /* [n_cable], -1: no gene */
    int *place_of_row;     /* [n_node] first of a row's three dofs as a free node or an attachment, -1: fixed */
    int *base_of_row;      /* [n_node] the same as a support that genes move, which a truss may displace besides */
    double *move;          /* [n][n_dof] dx/dv, m per unit of the variable */
    int n_rigid, *rigid;   /* [n_rigid] cables of law length */
    int *rigid_of_cable;   /* [n_cable] -1: none */
    double *multiplier;    /* [n][n_rigid] dT/dv of these beyond what the stiff spring gives */
    struct hf_strained *strained; /* [n_cable] scratch: the cables at the shape of `move` */
    double *answer;               /* [n][3 n_free] scratch: what the moving truss, or refinement, adds to `move` */
    double *gap;                  /* [3 n_attachment] scratch */
    double *pull;                 /* [n][3 n_attachment] scratch: change of the pull on the truss */
    hf_packed_band matrix;        /* of the net with fixed supports */
    double *lanes;                /* [v->n_thread][n_lane] scratch of its solves */
    size_t n_lane;
    hf_schur schur; /* only with a truss */
    void *block;
} hf_sensitivity;

/* HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_sensitivity_create(const hf_evaluator *evaluator, hf_sensitivity *sensitivity);
void hf_sensitivity_free(hf_sensitivity *sensitivity);

/* Compute `move` at the shape in the workspace, which hf_evaluate has found. HF_OK or HF_SINGULAR. */
hf_status hf_sensitivity_find(hf_sensitivity *sensitivity, hf_workspace *workspace);

/* Tension of cable i_cable: rate [n] dT/dv, N per unit of the variable. */
void hf_sensitivity_tension(const hf_sensitivity *sensitivity, int i_cable, double *rate);

/* The displacement [3] of an attachment by the truss, for one unit of variable i_variable. */
static inline const double *hf_sensitivity_displacement(const hf_sensitivity *sensitivity, int i_variable,
                                                        int i_attachment)
{
    return sensitivity->move + (size_t)i_variable * sensitivity->n_dof +
           3 * ((size_t)sensitivity->v->model->n_free + (size_t)i_attachment);
}

/* Of variable i_variable alone: the moves of all nodes, [3][n_node] by row, and tension_rate [n_cable]. */
void hf_sensitivity_spread(const hf_sensitivity *sensitivity, int i_variable, double *move, double *tension_rate);

#endif
