/* Estimates the errors of a shape and certifies bounds for them (METHOD section 3).
 *
 *     shape and tensions in the workspace
 *         | residual / maximum sum of tensions at a node         -> backward_error
 *         | Newton matrix (newton.c), or D: factor and one step  -> condition, position_error_m
 *         | bound.c, with this factor                            -> position_bound_m, psi_bound_m, bound_reason */
#include "solve/certificate.h"

#include "base/elementary.h"
#include "linalg/band.h"
#include "solve/bound.h"
#include "solve/newton.h"

#include <math.h>
#include <string.h>

/* Returns the maximum sum of tensions at one free node, N. The backward error is the nodal residual divided by it. pull
 * [n_node] is scratch. */
static double largest_pull_N(const hf_model *m, const hf_workspace *w, double *pull)
{
    double largest = 0;
    memset(pull, 0, (size_t)m->n_node * sizeof *pull);
    for (int e = 0; e < m->n_cable; e++)
        for (int k = 0; k < 2; k++)
            pull[m->end_row[2 * e + k]] += fabs(w->tension_N[e]);
    for (int i = 0; i < m->n_free; i++)
        largest = fmax(largest, pull[i]);
    return largest;
}

/* Sets condition and position_error_m with D. D is assembled and factored again: its norm is needed, and the band holds
 * the factor of the form-finding. */
static void certify_linear(const hf_model *m, hf_workspace *w, hf_form_result *r)
{
    int n = m->n_free, k = m->half_bandwidth, bad_row;
    double *step = w->certificate_work, norm;
    hf_form_residual_N(m, w);
    hf_form_assemble(m, w);
    norm = hf_band_norm(n, k, w->band, step);
    if (!m->has_strut) {
        if (hf_band_factor(n, k, w->band) != 0) return;
        r->condition = hf_band_condition(n, k, w->band, norm, step, w->certificate_integer_work);
        memcpy(step, w->force_N, 3 * (size_t)m->n_node * sizeof *step);
        hf_band_back_solve(n, k, 3, w->band, step, m->n_node);
    } else {
        memcpy(step, w->force_N, 3 * (size_t)m->n_node * sizeof *step);
        if (hf_band_solve_indefinite(n, k, w->band, w->general_band, w->pivot, step, m->n_node, &bad_row) != HF_OK)
            return;
    }
    double largest = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, hf_norm(step[i], step[m->n_node + i], step[2 * m->n_node + i]));
    if (!hf_workspace_iterates(m, w) && !m->n_attachment) r->position_error_m = largest;
    if (m->has_strut)
        r->condition =
            hf_band_condition_indefinite(n, k, w->general_band, w->pivot, norm, step, w->certificate_integer_work);
}

void hf_certify(const hf_model *m, hf_workspace *w, hf_form_result *r)
{
    r->position_error_m = r->condition = r->backward_error = (double)NAN;
    r->position_bound_m = r->psi_bound_m = (double)NAN;
    r->bound_reason = HF_BOUND_NONE;
    if (r->status != HF_OK && r->status != HF_NOT_CONVERGED) return;
    r->backward_error = r->residual_N / largest_pull_N(m, w, m->has_newton ? w->newton_trial_m : w->certificate_work);
    double least_N_per_m = 0;
    if (m->has_newton)
        least_N_per_m = hf_newton_certify(m, w, r);
    else
        certify_linear(m, w, r);
    hf_bound_prove(m, !isnan(r->condition), least_N_per_m, w, r);
}
