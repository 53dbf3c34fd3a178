/* precise - the equilibrium near a found shape at twice the precision, and the cables there. certificate.c certifies
 * its bounds at this precise shape (METHOD section 3).
 * Stability: internal; may change in any version. */
#pragma once

#include "solve/flexibility.h"

/* A cable at the precise shape. HF_BOUND_ITEMS (workspace.h) has room for the arrays below. The moving rows are the
 * free nodes and, on a truss, the attachments; n_moving is their number. */
typedef struct {
    hf_twofold T;         /* multiplier, N; 0 of a slack cable */
    hf_twofold over;      /* length minus the length that the law requires at T, m; cables with a multiplier */
    double unit[3];       /* unit vector from the first end to the second */
    double length;        /* m */
    double along, across; /* stiffness in the matrix, N/m */
    double change, last;  /* change of T since the last measurement, and in the last step, N */
    double near_over;     /* `over` after these changes, m */
    double is_taut;       /* 1 or 0; always 1 without a multiplier */
} hf_precise_cable;

/* The unknowns s of the truss (flexibility.h) and arrays that belong to them. Arrays are [rank] unless noted. */
typedef struct {
    hf_flexibility flexibility;
    hf_twofold *s, *gap;       /* precise s, and L' b - s for the pull b on the attachments */
    hf_twofold *rest_m;        /* [n] (F - L L') b: rounding error of L, so that r = L s + rest_m is F b, m */
    double *move, *step;       /* change of s since the last measurement, and in the last step */
    double *near_gap;          /* gap after these changes */
    hf_newton_block *block_of; /* blocks of the factored matrix */
} hf_precise_truss;

typedef struct {
    const hf_model *m;
    hf_workspace *w;
    int n_moving;
    hf_precise_cable *cable; /* [n_cable] */
    hf_twofold *x;           /* [3][n_node] precise shape, m */
    hf_twofold *force;       /* [3 n_moving] by dof, N: out of balance at free nodes, pull on attachments */
    double *move, *step;     /* [3 n_moving] by dof, m: since the last measurement, and in the last step */
    double *near_N;          /* [3 n_moving] by dof, N: force after these changes; of attachments the change of pull */
    double *sum;             /* [n_moving] scratch */
    double wanted;           /* relative error at which the iteration ends */
    double condition;        /* estimated condition of the factored matrix */
    bool is_first_matrix;    /* no matrix has been factored here yet */
    hf_precise_truss truss;  /* used for a net on a truss */
} hf_precise;

/* Starts at the shape in the workspace. `condition` is that of the matrix whose factor the workspace holds. Returns
 * false if the flexibility of the truss has a negative eigenvalue, which no elastic structure has. */
bool hf_precise_open(const hf_model *model, hf_workspace *workspace, double condition, hf_precise *precise);

/* Computes the precise equilibrium. has_factor: the workspace holds the factor of a matrix. Returns
 * HF_BOUND_CERTIFIED if it is found; elastic cables then pull by their law. Otherwise returns the reason why not. */
hf_bound_reason hf_precise_approach(hf_precise *precise, bool has_factor);

/* Returns a guess of a lower bound of the minimum eigenvalue of the factored matrix, N/m. */
double hf_precise_guess(const hf_precise *precise);

/* Sets block [3][3] to the stiffness of a cable from its along, across and unit, N/m, for
 * hf_newton_matrix_assemble_blocks. */
void hf_precise_block(const hf_model *model, const hf_workspace *workspace, int i_cable, double block[3][3]);

/* Returns a figure of a cable. hf_precise_largest_sum returns the maximum sum of that figure over the taut cables at a
 * moving row. */
typedef double hf_precise_figure(const hf_precise *precise, int i_cable);
double hf_precise_largest_sum(const hf_precise *precise, hf_precise_figure *figure);

/* Returns the stiffness of a cable in the factored matrix, along + across, N/m. It is a figure for
 * hf_precise_largest_sum; the norm of the matrix is at least as large as that sum. */
double hf_precise_matrix_sum(const hf_precise *precise, int i_cable);

/* Returns true if neither end of the cable moves. */
static inline bool hf_precise_is_fixed(const hf_model *model, int i_cable)
{
    int n_moving = model->n_free + model->n_attachment;
    return model->end_row[2 * i_cable] >= n_moving && model->end_row[2 * i_cable + 1] >= n_moving;
}
