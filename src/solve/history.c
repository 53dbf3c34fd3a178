/* Adds rows to the history of a form-finding and to that of its coupling. */
#include "solve/history.h"

#include "solve/newton_matrix.h"
#include <hifdm/metrics.h>

void hf_history_add(hf_history *h, const hf_model *m, const hf_workspace *w, double psi_m, double residual_N,
                    double length_error)
{
    if (h->n == h->capacity) return;
    h->psi_m[h->n] = psi_m;
    h->residual_N[h->n] = residual_N;
    h->inner_tension_ratio[h->n] = hf_metrics_tension_ratio(m, w, HF_GROUP_INNER);
    h->boundary_tension_ratio[h->n] = hf_metrics_tension_ratio(m, w, HF_GROUP_BOUNDARY);
    h->length_error[h->n++] = length_error;
}

void hf_history_add_coupling(hf_history *history, double step_m, double psi_m, double max_displacement_m)
{
    hf_coupling_history *h = history ? &history->coupling : NULL;
    if (!h || h->n == h->capacity) return;
    h->step_m[h->n] = step_m;
    h->psi_m[h->n] = psi_m;
    h->deflection_max_m[h->n++] = max_displacement_m;
}

/* Returns the maximum distance of an attachment from its target position, m. */
static double max_displacement_m(const hf_model *m, const hf_workspace *w)
{
    double largest = 0;
    for (int row = m->n_free; row < m->n_free + m->n_attachment; row++) {
        double square = 0;
        for (int at = row; at < 3 * m->n_node; at += m->n_node) {
            double d = w->position_m[at] - m->position_m[at];
            square += d * d;
        }
        if (!(square <= largest)) largest = square; /* a NaN stays */
    }
    return sqrt(largest);
}

void hf_history_add_step(const hf_model *m, hf_workspace *w, double residual_N, double length_error, double gap_m)
{
    double u[3], psi_m;
    if (!w->history) return;
    for (int e = 0; e < m->n_cable; e++) {
        double length = hf_newton_matrix_direction(m, w->position_m, e, u);
        w->tension_N[e] = hf_newton_matrix_tension_N(hf_workspace_cable(m, w, e), length, w->tension_N[e]);
    }
    psi_m = hf_metrics_psi_m(m, w);
    hf_history_add(w->history, m, w, psi_m, residual_N, length_error);
    if (w->n_moving > m->n_free) hf_history_add_coupling(w->history, gap_m, psi_m, max_displacement_m(m, w));
}
