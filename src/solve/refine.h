/* refine - the equilibrium near a shape that was found, to twice the precision, and the cables there: what the proof of
 * bound.c is about (METHOD section 3).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_REFINE_H
#define HIFDM_REFINE_H

#include "linalg/twofold.h"
#include <hifdm/formfind.h>

/* In HF_BOUND_ITEMS (workspace.h) is room for these. */
typedef struct {
    hf_twofold T;         /* multiplier, N; 0 of a slack cable */
    hf_twofold over;      /* length less the wanted length at T, m; of cables with a multiplier */
    double unit[3];       /* from the first end to the second */
    double length;        /* m */
    double along, across; /* of the matrix, N/m */
    double change, last;  /* of T: since the last measure, and in the last step, N */
    double near_over;     /* `over` after these changes */
    double is_taut;       /* 1 or 0; 1 of a cable without a multiplier */
} hf_refined_cable;

typedef struct {
    const hf_model *m;
    hf_workspace *w;
    hf_refined_cable *cable; /* [n_cable] */
    hf_twofold *x;           /* [3][n_node] refined shape */
    hf_twofold *force;       /* [3 n_free] out of balance, by dof */
    double *move, *step;     /* [3 n_free] by dof: since the last measure, and the last step */
    double *near_N;          /* [3 n_free] forces out of balance after the moves */
    double *sum;             /* [n_free] scratch */
    double wanted;           /* relative errors at which refinement ends */
    double condition;        /* estimate, of the matrix that is factored */
    bool is_first_matrix;    /* it is the one with which refinement began */
} hf_refined;

/* Begin at the shape in the workspace, whose matrix of this condition is factored there. */
void hf_refine_open(const hf_model *model, hf_workspace *workspace, double condition, hf_refined *refined);

/* Go to the equilibrium. HF_BOUND_PROVEN, then with the forces by law, or the reason why it does not get there.
 * has_factor: a matrix is factored. */
hf_bound_reason hf_refine_approach(hf_refined *refined, bool has_factor);

/* A guess of a number below the least eigenvalue of the matrix that is factored, N/m. */
double hf_refine_guess(const hf_refined *refined);

/* The block of a cable from its along, across and unit, for hf_newton_matrix_assemble_blocks. */
void hf_refine_block(const hf_model *model, const hf_workspace *workspace, int i_cable, double block[3][3]);

/* Largest sum of a figure of the taut cables at a free node. */
typedef double hf_refined_figure(const hf_refined *refined, int i_cable);
double hf_refine_largest_sum(const hf_refined *refined, hf_refined_figure *figure);

static inline bool hf_refine_is_fixed(const hf_model *model, int i_cable)
{
    return model->end_row[2 * i_cable] >= model->n_free && model->end_row[2 * i_cable + 1] >= model->n_free;
}

#endif
