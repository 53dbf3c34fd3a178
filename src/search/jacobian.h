/* jacobian - computes exact derivatives of the figures of a design with respect to each design variable, for optimisers
 * outside this program. The figures are psi, or each objective and the merit (the value of the weighted objectives).
 *
 * The derivative of an objective is that of the norm of its residuals (objectives.h), without its weight. For pull and
 * displacement, this norm is a smooth maximum, which the merit contains, and not the maximum itself. Linked design
 * variables are varied one by one. */
#pragma once

#include "search/residuals.h"

typedef struct {
    hf_model model; /* copy of the caller's model in which no design variables are linked */
    hf_evaluator v; /* copy of the caller's evaluator with this model */
    int n_figure;   /* 1 for psi_m; with objectives: each of them, then the merit */
    hf_sensitivity slopes;
    hf_residuals residuals;
    int *leader;      /* [n_variable], variable_leader of the model */
    double *rate;     /* [n_variable][residuals.n_row], derivatives of the residuals */
    double *gradient; /* [n_variable], scratch */
    void *block;
} hf_jacobian;

/* Prepares derivatives of designs of an evaluator to which hf_refine_applies; the evaluator is borrowed. A jacobian
 * must not be moved or copied, because it points into itself. Returns HF_OK or HF_NO_MEMORY; call hf_jacobian_free in
 * either case. */
hf_status hf_jacobian_create(const hf_evaluator *evaluator, hf_jacobian *jacobian);
void hf_jacobian_free(hf_jacobian *jacobian);

/* Computes derivative [n_figure][n_variable] at the shape in the workspace, in the unit of the figure per unit of the
 * design variable. The shape must be that of a feasible design that hf_evaluate has found. The derivative of a figure
 * that is 0 there is NaN. Returns HF_OK, HF_SINGULAR, HF_NOT_FINITE or HF_NO_MEMORY; all derivatives are NaN unless it
 * is HF_OK. */
hf_status hf_jacobian_find(hf_jacobian *jacobian, hf_workspace *workspace, double *derivative);
