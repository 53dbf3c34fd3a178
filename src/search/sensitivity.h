/* sensitivity - computes exact derivatives of the shape of a net by the variables of a design (METHOD section 7, M11).
 * Each variable takes one solve with the factored Newton matrix. A variable is a design variable, or a class of linked
 * design variables that change by the same step. With a truss, the attachments move, too.
 *
 * In the matrix, a cable of law length is a stiff spring. The derivative of its length is then wrong by a part of
 * 1/HF_NEWTON_STIFFENING. A second solve removes this error, and a third one the rounding errors of the spring. */
#pragma once

#include "linalg/packed_band.h"
#include "solve/schur.h"
#include <hifdm/evaluate.h>

/* The arrays of hf_sensitivity for a model m: first the indices, from which the sizes of the others follow. n is the
 * number of variables, and n_room that of threads. */
#define HF_SENSITIVITY_INDICES(X)                                                                                      \
    X(int, class_of_variable, m->n_variable, "class of each design variable")                                          \
    X(int, variable_of_cable, m->n_cable, "design variable, or -1")                                                    \
    X(int, place_of_row, m->n_node, "first coordinate of a free node or attachment; -1: fixed")                        \
    X(int, base_of_row, m->n_node, "first coordinate of a support that is varied; the truss may also move it")         \
    X(int, rigid, m->n_cable, "[n_rigid] cables of law length")                                                        \
    X(int, rigid_of_cable, m->n_cable, "index in `rigid`, or -1")
#define HF_SENSITIVITY_FIELDS(X)                                                                                       \
    X(double, move, n * to->n_dof, "[n][n_dof] dx/dv, m per unit of v")                                                \
    X(double, multiplier, n *(size_t)to->n_rigid, "[n][n_rigid] dT/dv beyond what the stiff spring gives")             \
    X(hf_strained, strained, m->n_cable, "scratch: the cables at the shape of `move`")                                 \
    X(double, answer, m->n_attachment || to->n_rigid ? 3 * n * (size_t)m->n_free : 0,                                  \
      "[n][3 n_free] scratch: change of `move` by truss or refinement")                                                \
    X(double, gap, 3 * (size_t)m->n_attachment, "scratch")                                                             \
    X(double, pull, 3 * n * (size_t)m->n_attachment, "[n][3 n_attachment] scratch: change of the forces on the truss") \
    X(double, lanes, n_room * to->n_lane, "[n_room][n_lane] scratch of the solves")

/* A cable at the shape in the workspace. */
typedef struct {
    double unit[3], stiffness_N_per_m;
    double direct;    /* dT/dv by its own design variable at fixed nodes, or 0 */
    int rigid, class; /* index in `rigid`, and class of the cable; -1: none */
} hf_strained;

typedef struct {
    const hf_evaluator *v;
    int n;        /* number of classes of linked design variables; v is the step of a class */
    int n_rigid;  /* number of cables of law length */
    size_t n_dof; /* coordinates: 3*row + c of free nodes, 3*attachment + c, supports that are varied */
    size_t n_lane;
    HF_SENSITIVITY_INDICES(HF_ARENA_MEMBER)
    HF_SENSITIVITY_FIELDS(HF_ARENA_MEMBER)
    hf_packed_band matrix; /* Newton matrix of the net with fixed supports */
    hf_schur schur;        /* used with a truss only */
    hf_arena arena;
    void *block; /* of the indices */
} hf_sensitivity;

/* Allocates the derivatives for an evaluator. Returns HF_OK or HF_NO_MEMORY; call hf_sensitivity_free in either
 * case. */
hf_status hf_sensitivity_create(const hf_evaluator *evaluator, hf_sensitivity *sensitivity);
void hf_sensitivity_free(hf_sensitivity *sensitivity);

/* Allocates only the indices, for steps that need no derivatives by each variable. Its n is 0. Returns like
 * hf_sensitivity_create. */
hf_status hf_sensitivity_number(const hf_evaluator *evaluator, hf_sensitivity *sensitivity);

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

/* The same as an hf_constraints_spread; the context is the hf_sensitivity. */
const double *hf_sensitivity_follow(const void *sensitivity, int i_class, double *move, double *tension_rate);
