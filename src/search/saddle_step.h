/* saddle_step - steps of Levenberg-Marquardt for nets with many variables, without derivatives by each variable (METHOD
 * section 7). Displacements and multipliers of equilibrium are unknowns of one sparse saddle-point system, which has
 * six unknowns per node and the pattern of the net. Each variable belongs to one cable, so it is eliminated cable by
 * cable. Bounds of variables and of tensions are held by an active set.
 *
 * The model is |f + J x|^2/2 + damping |f|^2 |dT/T0|^2/(2 n). dT are the changes of the tensions by the n variables at
 * fixed nodes, T0 is the reference tension, and f in the damping are the residuals at the shape of the model, so the
 * damping vanishes with them. Objectives may be psi, tensions and evenness. */
#pragma once

#include "linalg/dissection.h"
#include "search/watch.h"

/* A cable in the model. The change of its tension is dT = direct x + along d, where x is the step of its variable and d
 * the change of its length. */
typedef struct {
    double unit[3], tension_N;
    double across, along, direct; /* N/m, N/m, N per unit of the variable */
    int variable;                 /* design variable, or -1 */
    double curvature, slope;      /* of the objectives by dT */
    double damping;               /* curvature by x that damping adds */
    double low, high;             /* limits of dT */
    double down, up, unit_of_x;   /* limits of x, and its magnitude */
    int side;                     /* active limit: -1 down, 1 up, -2 low, 2 high, 0 none */
    int factored_side, next;      /* `side` in the factor, and in the next active set */
    double excess;                /* violation or slope for which it changes */
    double dd, dm, mm, m, d;      /* model without x, see saddle_step.c */
    double x, change_N;           /* the step: x and dT */
} hf_saddle_cable;

/* The rows of one objective in the model. The rate of row i is `part` times dT of a cable, minus for evenness
 * `of_mean` T times the change of the mean tension; or `part` times a displacement. */
typedef struct {
    hf_figure_kind figure;
    int first_row, n, border;
    const int *index; /* [n] cables, or rows of nodes */
    double part, of_mean;
    double square; /* sum of the squares of of_mean T */
} hf_saddle_rows;

/* The arrays of hf_saddle_step for a model m. */
#define HF_SADDLE_STEP_FIELDS(X)                                                                                       \
    X(hf_saddle_cable, cable, m->n_cable, "all cables")                                                                \
    X(hf_saddle_rows, rows, to->n_rows, "the objectives, or psi")                                                      \
    X(double, weight, m->n_free, "curvature of the objectives by the displacement of a free node")                     \
    X(double, stiffness, m->n_free, "scratch: sum of the force densities at a node")                                   \
    X(double, coefficient, (size_t)to->border *(size_t)m->n_cable, "[border][n_cable] couples dT and the border")      \
    X(double, column, 2 * (size_t)to->border * n_dof, "[2][border][n][6] solutions for the border, its columns")       \
    X(double, corner, (size_t)to->border *(size_t)to->border, "[border][border] Schur complement, factored")           \
    X(int, pivot, to->border, "its rows")                                                                              \
    X(double, base, to->n_row, "f at the shape of the model")                                                          \
    X(double, residual, to->n_row, "f at a step of zero, by the model")                                                \
    X(double, rate, to->n_row, "J x of the last step")                                                                 \
    X(bool, is_held, n_dof, "[n][6] rows without an unknown: of supports, and of supports of the truss")               \
    X(double, all, n_dof, "[n][6] right-hand side, then displacements and multipliers")                                \
    X(double, border_value, to->border, "those of the border")

typedef struct {
    const hf_evaluator *v; /* borrowed */
    int n;                 /* rows of unknowns: nodes of the net, then other blocks of the truss */
    int border;            /* two unknowns for each objective of evenness: mean tension and its multiplier */
    int n_row, n_rows;     /* residuals, and objectives to which they belong */
    HF_SADDLE_STEP_FIELDS(HF_ARENA_MEMBER)
    hf_dissection matrix;
    double unit;             /* m, of displacements in the matrix; 1/unit is that of multipliers */
    double factored_damping; /* damping of the factor; -1: none */
    void *block;
} hf_saddle_step;

/* Returns true if steps of this evaluator can be solved in this way. The cap on the boundary tension ratio is not in
 * the model: the caller must notice steps that break it. Nor are requirements: the caller must replace them. */
bool hf_saddle_step_applies(const hf_evaluator *evaluator);

/* Allocates the step. Returns HF_OK or HF_NO_MEMORY; call hf_saddle_step_free in either case. */
hf_status hf_saddle_step_create(const hf_evaluator *evaluator, int n_row, hf_saddle_step *step);
void hf_saddle_step_free(hf_saddle_step *step);

/* Makes the model at the shape in the workspace, whose residuals are f [n_row]. */
void hf_saddle_step_linearise(hf_saddle_step *step, const hf_workspace *workspace, const double *f);

/* Sets limits of the tension of each cable from the items of `watch`. */
void hf_saddle_step_limit(hf_saddle_step *step, const hf_watch *watch);

/* Finds the step x [n_variable] that minimises the model with this damping within down and up [n_variable] and the
 * limits of tensions. unit [n_variable]: magnitudes of the variables. side [n_variable]: the active limits at which the
 * search begins, then those of the step, as in hf_saddle_cable. *gain receives the decrease of |f|^2/2 that the model
 * promises. Returns HF_OK, HF_SINGULAR, or HF_DIFFERENT if the active set does not settle; x is then the last step,
 * which may break limits. */
hf_status hf_saddle_step_solve(hf_saddle_step *step, double damping, const double *down, const double *up,
                               const double *unit, int *side, double *x, double *gain);

/* Makes f [n_row] the residuals at the end of the last step, without new rates. NULL: those of the model again. */
void hf_saddle_step_bend(hf_saddle_step *step, const double *f);

/* Adds to `bend` of each item by how much its tension at the end of the last step, which `watch` has measured, is
 * beyond the model. */
void hf_saddle_step_learn(const hf_saddle_step *step, hf_watch *watch);

/* Returns the norm of the changes of the residuals if each variable changes by its unit [n_variable] alone. They are
 * estimated at fixed nodes or, for a cable without an objective, with only its ends free. */
double hf_saddle_step_spread(const hf_saddle_step *step, const double *unit);
