/* sensitivity - computes exact derivatives of the shape of a net by the variables of a design (METHOD section 7, M11).
 * Each variable takes one solve with the factored Newton matrix. A variable is a design variable, or a class of linked
 * design variables that change by the same step. With a truss, the attachments move, too.
 *
 * In the matrix, a cable of law length is a stiff spring. The derivative of its length is then wrong by a part of
 * 1/HF_NEWTON_STIFFENING. A second solve removes this error, and a third one the rounding errors of the spring. */
#ifndef HIFDM_SENSITIVITY_H
#define HIFDM_SENSITIVITY_H

#include "linalg/packed_band.h"
#include "solve/schur.h"
#include <hifdm/evaluate.h>

typedef struct {
    const hf_evaluator *v;
    int n;                  /* number of classes of linked design variables; v is the step of a class */
    size_t n_dof;           /* coordinates: 3*row + c of free nodes, 3*attachment + c, supports that are varied */
    int *class_of_variable; /* [n_variable], class of each design variable */
    int *variable_of_cable; /* [n_cable], design variable, or -1 */
    int *place_of_row;      /* [n_node], first coordinate of a free node or attachment; -1: fixed */
    int *base_of_row;       /* [n_node], first coordinate of a support that is varied; the truss may also move it */
    double *move;           /* [n][n_dof], dx/dv, m per unit of v */
    int n_rigid, *rigid;    /* [n_rigid], cables of law length */
    int *rigid_of_cable;    /* [n_cable], index in `rigid`, or -1 */
    double *multiplier;     /* [n][n_rigid], dT/dv of these cables beyond what the stiff spring gives */
    struct hf_strained *strained; /* [n_cable], scratch: the cables at the shape of `move` */
    double *answer;               /* [n][3 n_free], scratch: change of `move` by truss or refinement */
    double *gap;                  /* [3 n_attachment], scratch */
    double *pull;                 /* [n][3 n_attachment], scratch: change of the forces on the truss */
    hf_packed_band matrix;        /* Newton matrix of the net with fixed supports */
    double *lanes;                /* [v->n_thread][n_lane], scratch of the solves */
    size_t n_lane;
    hf_schur schur; /* used with a truss only */
    void *block;
} hf_sensitivity;

/* Allocates the derivatives for an evaluator. Returns HF_OK or HF_NO_MEMORY; call hf_sensitivity_free in either
 * case. */
hf_status hf_sensitivity_create(const hf_evaluator *evaluator, hf_sensitivity *sensitivity);
void hf_sensitivity_free(hf_sensitivity *sensitivity);

/* Computes `move` at the shape in the workspace, which hf_evaluate must have found. Returns HF_OK or HF_SINGULAR. */
hf_status hf_sensitivity_find(hf_sensitivity *sensitivity, hf_workspace *workspace);

/* Computes rate [n], dT/dv of cable i_cable in N per unit of the step of each class. */
void hf_sensitivity_tension(const hf_sensitivity *sensitivity, int i_cable, double *rate);

/* Returns the displacement [3] of an attachment by the truss, per unit of the step of a class. */
static inline const double *hf_sensitivity_displacement(const hf_sensitivity *sensitivity, int i_class,
                                                        int i_attachment)
{
    return sensitivity->move + (size_t)i_class * sensitivity->n_dof +
           3 * ((size_t)sensitivity->v->model->n_free + (size_t)i_attachment);
}

/* Computes the derivatives by the step of one class: `move` [3][n_node] of the positions by row, and tension_rate
 * [n_cable]. */
void hf_sensitivity_spread(const hf_sensitivity *sensitivity, int i_class, double *move, double *tension_rate);

#endif
