/* precise - the equilibrium near a shape that was found, to twice the precision, and the cables there: the shape that
 * the proof of bound.c is about (METHOD section 3).
 * Stability: internal; may change in any version. */
#ifndef HIFDM_PRECISE_H
#define HIFDM_PRECISE_H

#include "solve/flexibility.h"
#include <hifdm/formfind.h>

/* HF_BOUND_ITEMS (workspace.h) has room for all of these. The rows that move are the free nodes and, on a truss, the
 * attachments: n_moving of them. */
typedef struct {
    hf_twofold T;         /* multiplier, N; 0 of a slack cable */
    hf_twofold over;      /* length less the wanted length at T, m; of cables with a multiplier */
    double unit[3];       /* from the first end to the second */
    double length;        /* m */
    double along, across; /* of the matrix, N/m */
    double change, last;  /* of T: since the last measure, and in the last step, N */
    double near_over;     /* `over` after these changes */
    double is_taut;       /* 1 or 0; 1 of a cable without a multiplier */
} hf_precise_cable;

/* The unknowns s of the truss (flexibility.h), each [rank]. */
typedef struct {
    hf_flexibility flexibility;
    hf_twofold *s, *gap;       /* precise, and L' b - s for the pull b on the attachments */
    hf_twofold *rest_m;        /* [n] (F - L L') b: what rounding has taken from L, so that r = L s + rest is F b */
    double *move, *step;       /* of s: since the last measure, and the last step */
    double *near_gap;          /* gap after the moves */
    hf_newton_block *block_of; /* of the matrix that is factored */
} hf_precise_truss;

typedef struct {
    const hf_model *m;
    hf_workspace *w;
    int n_moving;
    hf_precise_cable *cable; /* [n_cable] */
    hf_twofold *x;           /* [3][n_node] precise shape */
    hf_twofold *force;       /* [3 n_moving] by dof: out of balance at free nodes, the pull on attachments */
    double *move, *step;     /* [3 n_moving] by dof: since the last measure, and the last step */
    double *near_N;          /* [3 n_moving] forces out of balance after the moves; of attachments the change of pull */
    double *sum;             /* [n_moving] scratch */
    double wanted;           /* relative errors at which refinement ends */
    double condition;        /* estimate, of the matrix that is factored */
    bool is_first_matrix;    /* it is the one with which refinement began */
    hf_precise_truss truss;  /* of a net on a truss */
} hf_precise;

/* Begins at the shape in the workspace, whose matrix of this condition is factored there. Returns false when the
 * flexibility of the truss is that of no elastic structure. */
bool hf_precise_open(const hf_model *model, hf_workspace *workspace, double condition, hf_precise *precise);

/* Go to the equilibrium. HF_BOUND_PROVEN, then with the forces by law, or the reason why it does not get there.
 * has_factor: a matrix is factored. */
hf_bound_reason hf_precise_approach(hf_precise *precise, bool has_factor);

/* A guess of a number below the least eigenvalue of the matrix that is factored, N/m. */
double hf_precise_guess(const hf_precise *precise);

/* The block of a cable from its along, across and unit, for hf_newton_matrix_assemble_blocks. */
void hf_precise_block(const hf_model *model, const hf_workspace *workspace, int i_cable, double block[3][3]);

/* Returns the largest sum of a figure of the taut cables at a row that moves. */
typedef double hf_precise_figure(const hf_precise *precise, int i_cable);
double hf_precise_largest_sum(const hf_precise *precise, hf_precise_figure *figure);

/* Such a figure: the stiffness of a cable in the matrix of `along` and `across`, N/m. The norm of that matrix is at
 * least as large as the largest sum. */
double hf_precise_matrix_sum(const hf_precise *precise, int i_cable);

/* Whether neither end of the cable moves. */
static inline bool hf_precise_is_fixed(const hf_model *model, int i_cable)
{
    int n_moving = model->n_free + model->n_attachment;
    return model->end_row[2 * i_cable] >= n_moving && model->end_row[2 * i_cable + 1] >= n_moving;
}

#endif
