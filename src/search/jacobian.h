/* jacobian - exact derivatives of the figures of a design by each of its genes: of psi, or of each goal and of the
 * merit. For optimisers other than ours.
 *
 * The derivative of a goal is that of the norm of its residuals (goals.h), without its weight: of pull and displacement
 * that of the smooth largest, which the merit has, and not of the largest itself. A gene changes alone, also where
 * genes are linked. */
#ifndef HIFDM_JACOBIAN_H
#define HIFDM_JACOBIAN_H

#include "search/residuals.h"

typedef struct {
    hf_model model; /* that of the caller, with genes that are not linked */
    hf_evaluator v; /* that of the caller, of this model */
    int n_figure;   /* 1: psi_m; with goals one more than these: each goal, then the merit */
    hf_sensitivity slopes;
    hf_residuals residuals;
    int *leader;      /* [n_gene] of the model */
    double *rate;     /* [n_gene][residuals.n_row] */
    double *gradient; /* [n_gene] scratch */
    void *block;
} hf_jacobian;

/* For designs of an evaluator for which hf_polish_applies, which is borrowed. A jacobian is neither moved nor copied.
 * HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_jacobian_create(const hf_evaluator *evaluator, hf_jacobian *jacobian);
void hf_jacobian_free(hf_jacobian *jacobian);

/* derivative [n_figure][n_gene] at the shape in the workspace, which hf_evaluate has found for a feasible design, in
 * the unit of the figure per unit of the gene; NaN of a figure that is 0 there. HF_OK, HF_SINGULAR, HF_NOT_FINITE or
 * HF_NO_MEMORY; otherwise than with HF_OK all are NaN. */
hf_status hf_jacobian_find(hf_jacobian *jacobian, hf_workspace *workspace, double *derivative);

#endif
