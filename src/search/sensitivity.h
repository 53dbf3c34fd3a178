/* sensitivity - exact derivatives of a net's shape with respect to the pretensions of a design (METHOD section 7, M11):
 * one solve with the factored Newton matrix per variable. A variable is a gene, or a class of genes that a symmetry
 * links and that change by the same step. With a truss the supports move, too. */
#ifndef HIFDM_SENSITIVITY_H
#define HIFDM_SENSITIVITY_H

#include "search/chord.h"
#include "solve/schur.h"

typedef struct {
    const hf_evaluator *v;
    int n;                 /* variables */
    size_t n_dof;          /* 3 n_free + 3 n_attachment: dof 3*row + c of free nodes, then 3*attachment + c */
    int *variable_of_gene; /* [n_gene] */
    int *gene_of_cable;    /* [n_cable], -1: no gene */
    int *place_of_row;     /* [n_node] first of a row's three dofs, -1: fixed */
    double *move;          /* [n][n_dof] dx/dv, m/N */
    double *answer;        /* [n][3 n_free] scratch: what the moving truss adds to `move` */
    double *pull;          /* [n][3 n_attachment] scratch: change of the pull on the truss */
    hf_chord matrix;       /* of the net with fixed supports */
    hf_chord_lanes lanes;
    hf_schur schur; /* only with a truss */
    void *block;
} hf_sensitivity;

/* HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_sensitivity_create(const hf_evaluator *evaluator, hf_sensitivity *sensitivity);
void hf_sensitivity_free(hf_sensitivity *sensitivity);

/* Compute `move` at the shape in the workspace, which hf_evaluate has found. HF_OK or HF_SINGULAR. */
hf_status hf_sensitivity_find(hf_sensitivity *sensitivity, hf_workspace *workspace);

/* Tension of cable i_cable: rate [n] dT/dv, N/N. */
void hf_sensitivity_tension(const hf_sensitivity *sensitivity, const hf_workspace *workspace, int i_cable,
                            double *rate);

#endif
