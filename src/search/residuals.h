/* residuals - computes the residuals that Levenberg-Marquardt minimises, and their derivatives by the variables of a
 * design (METHOD section 7). They are those of the objectives, or of psi if there are no objectives. Tables of
 * derivatives use them, too. */
#pragma once

#include "search/sensitivity.h"

/* The working memory of a thread, if there are objectives. */
typedef struct {
    hf_objectives_point point;
    hf_status status;
    double *move_m, *tension_rate; /* [HF_OBJECTIVES_AT_ONCE][3][n_node], [HF_OBJECTIVES_AT_ONCE][n_cable], scratch */
    double *value;                 /* [n_row], scratch; in the first room that of hf_residuals */
} hf_residuals_room;

typedef struct {
    const hf_evaluator *v; /* borrowed */
    int n_row;
    double *value;           /* [n_row], f; |f| is the merit */
    int n_room;              /* number of threads */
    hf_residuals_room *room; /* [n_room] */
    void *block;
} hf_residuals;

/* Allocates the residuals of an evaluator. Returns HF_OK or HF_NO_MEMORY; call hf_residuals_free in either case. */
hf_status hf_residuals_create(const hf_evaluator *evaluator, hf_residuals *residuals);
void hf_residuals_free(hf_residuals *residuals);

/* Returns the memory for the objectives in which the calling thread may evaluate designs; NULL without objectives.
 * hf_residuals_find overwrites it. */
static inline hf_objectives_point *hf_residuals_point(const hf_residuals *residuals)
{
    return residuals->n_room ? &residuals->room[0].point : NULL;
}

/* Computes the residuals at the shape in the workspace, which must be feasible, and linearises the objectives in every
 * room. Returns HF_OK, HF_NOT_FINITE if an objective has no value, or HF_NO_MEMORY. */
hf_status hf_residuals_find(hf_residuals *residuals, const hf_workspace *workspace);

/* Computes rate [slopes->n][n_row], the derivatives of the residuals by all variables of `slopes`, which must be of the
 * same shape. gradient [slopes->n] receives that of |f|^2/2. All threads share the work. Returns HF_OK, or the status
 * of an as-built net without derivatives. */
hf_status hf_residuals_rates(const hf_residuals *residuals, const hf_sensitivity *slopes, const hf_workspace *workspace,
                             double *rate, double *gradient);
