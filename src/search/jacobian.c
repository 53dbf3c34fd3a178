/* Computes derivatives of the figures of a design. jacobian.h describes the interface.
 *
 *     shape -> sensitivities dx/dv, dT/dv -> residuals f, df/dv -> derivatives of psi, or of objectives and merit */
#include "search/jacobian.h"

#include "linalg/dot.h"

#include <math.h>

hf_status hf_jacobian_create(const hf_evaluator *evaluator, hf_jacobian *j)
{
    *j = (hf_jacobian){.model = *evaluator->model, .v = *evaluator};
    j->v.model = &j->model;
    j->n_figure = j->v.objectives ? j->v.objectives->n_objective + 1 : 1;
    HF_TRY(hf_residuals_create(&j->v, &j->residuals));
    size_t n = (size_t)j->model.n_variable;
    HF_TRY(HF_ARENA_ARRAYS(&j->block, HF_ARRAY(j->leader, n), HF_ARRAY(j->rate, n * (size_t)j->residuals.n_row),
                           HF_ARRAY(j->gradient, n)));
    for (int k = 0; k < j->model.n_variable; k++)
        j->leader[k] = k;
    j->model.variable_leader = j->leader;
    j->model.n_leader = j->model.n_variable;
    return hf_sensitivity_create(&j->v, &j->slopes);
}

void hf_jacobian_free(hf_jacobian *j)
{
    hf_sensitivity_free(&j->slopes);
    hf_residuals_free(&j->residuals);
    hf_arena_free_block(j->block);
    *j = (hf_jacobian){0};
}

/* Returns the derivative of the norm of n residuals f by a variable: f' df/dv / |f|, or NaN if the norm is 0. */
static double norm_rate(int n, const double *residual, const double *rate)
{
    double norm = sqrt(hf_dot((size_t)n, residual, residual));
    return norm > 0 ? hf_dot((size_t)n, residual, rate) / norm : (double)NAN;
}

hf_status hf_jacobian_find(hf_jacobian *j, hf_workspace *w, double *derivative)
{
    const hf_objectives *objectives = j->v.objectives;
    const double *value = j->residuals.value;
    int n = j->model.n_variable;
    for (int i = 0; i < j->n_figure * n; i++)
        derivative[i] = (double)NAN;
    HF_TRY(hf_sensitivity_find(&j->slopes, w));
    HF_TRY(hf_residuals_find(&j->residuals, w));
    HF_TRY(hf_residuals_rates(&j->residuals, &j->slopes, w, j->rate, j->gradient));
    for (int k = 0; k < n; k++) {
        const double *rate = j->rate + (size_t)k * (size_t)j->residuals.n_row;
        for (int i = 0, row = 0; i < j->n_figure - 1; row += objectives->objective[i++].n_row)
            derivative[i * n + k] = norm_rate(objectives->objective[i].n_row, value + row, rate + row) /
                                    objectives->objective[i].settings.weight;
        derivative[(j->n_figure - 1) * n + k] = norm_rate(j->residuals.n_row, value, rate);
    }
    return HF_OK;
}
