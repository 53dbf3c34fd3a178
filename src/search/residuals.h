/* residuals - what Levenberg-Marquardt and tables of derivatives want to be zero: the residuals of a design's goals, or
 * without goals those of psi, and their derivatives by its variables (METHOD section 7). */
#ifndef HIFDM_RESIDUALS_H
#define HIFDM_RESIDUALS_H

#include "search/sensitivity.h"

typedef struct {
    const hf_evaluator *v; /* borrowed */
    int n_row;
    double *value;                 /* [n_row] f; |f| is the merit */
    double *move_m, *tension_rate; /* [3][n_node], [n_cable] scratch with goals */
    void *block;
} hf_residuals;

/* HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_residuals_create(const hf_evaluator *evaluator, hf_residuals *residuals);
void hf_residuals_free(hf_residuals *residuals);

/* Take those of the shape in the workspace, which is feasible. HF_OK, or why goals have none. */
hf_status hf_residuals_find(hf_residuals *residuals, hf_workspace *workspace);

/* rate [n_row] for one unit of a variable of `slopes`, which were found at the same shape. */
void hf_residuals_rate(hf_residuals *residuals, const hf_sensitivity *slopes, hf_workspace *workspace, int i_variable,
                       double *rate);

#endif
