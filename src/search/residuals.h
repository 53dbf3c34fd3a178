/* residuals - what Levenberg-Marquardt and tables of derivatives want to be zero: the residuals of a design's goals, or
 * without goals those of psi, and their derivatives by its variables (METHOD section 7). */
#ifndef HIFDM_RESIDUALS_H
#define HIFDM_RESIDUALS_H

#include "search/sensitivity.h"

/* What a thread needs with goals; the point of the first one is that of the workspace. */
typedef struct {
    hf_goals_point own, *point;
    hf_status status;
    double *move_m, *tension_rate; /* [at once][3][n_node], [at once][n_cable] scratch */
    double *value;                 /* [n_row] scratch of the others */
} hf_residuals_room;

typedef struct {
    const hf_evaluator *v; /* borrowed */
    int n_row;
    double *value;           /* [n_row] f; |f| is the merit */
    int n_room;              /* threads */
    hf_residuals_room *room; /* [n_room] */
    void *block;
} hf_residuals;

/* HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_residuals_create(const hf_evaluator *evaluator, hf_residuals *residuals);
void hf_residuals_free(hf_residuals *residuals);

/* Take those of the shape in the workspace, which is feasible, in every room. HF_OK, or why goals have none. */
hf_status hf_residuals_find(hf_residuals *residuals, hf_workspace *workspace);

/* rate [slopes->n][n_row] by all variables of `slopes`, which were found at the same shape, and the gradient
 * [slopes->n] of |f|^2/2, by all threads. HF_OK, or why the nets of a design have none. */
hf_status hf_residuals_rates(const hf_residuals *residuals, const hf_sensitivity *slopes, const hf_workspace *workspace,
                             double *rate, double *gradient);

#endif
