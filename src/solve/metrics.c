/* Measures the quality of a shape: psi (Eqs. 9, 10), tension ratios and slack cables (METHOD section 9). */
#include <hifdm/metrics.h>

#include <math.h>

double hf_metrics_psi_of_m(const hf_model *m, const double *position_m, const unsigned char *loose)
{
    double sum = 0;
    int n = 0;
    const double *x = position_m, *y = x + m->n_node, *z = y + m->n_node;
    const double *x0 = m->position_m, *y0 = x0 + m->n_node, *z0 = y0 + m->n_node;
    for (int k = 0; k < m->n_inner_node; k++) {
        int row = m->inner_row[k];
        if (loose && loose[row]) continue;
        n++;
        double dx = x[row] - x0[row], dy = y[row] - y0[row], dz = z[row] - z0[row];
        sum += dx * dx + dy * dy + dz * dz;
    }
    return n > 0 ? sqrt(sum / n) : (double)NAN;
}

double hf_metrics_psi_m(const hf_model *m, const hf_workspace *w)
{
    return hf_metrics_psi_of_m(m, w->position_m, w->loose);
}

/* The minimum and maximum tension of the cables seen so far that are neither slack nor struts. */
typedef struct {
    double low, high;
    bool any_slack, any_strut;
} spread;

static void widen(const hf_model *m, const hf_workspace *w, int e, spread *s)
{
    double tension = w->tension_N[e];
    if (hf_metrics_is_slack(m, w, e)) {
        s->any_slack = true;
    } else if (!(tension > 0)) {
        s->any_strut = true;
    } else {
        if (tension < s->low) s->low = tension;
        if (tension > s->high) s->high = tension;
    }
}

static double ratio_of(const spread *s)
{
    if (s->any_strut) return (double)NAN;
    if (s->any_slack) return INFINITY;
    return s->high > 0 ? s->high / s->low : (double)NAN;
}

double hf_metrics_tension_ratio(const hf_model *m, const hf_workspace *w, hf_group group)
{
    spread s = {INFINITY, -INFINITY, false, false};
    for (int e = 0; e < m->n_cable; e++)
        if (m->group[e] == group) widen(m, w, e, &s);
    return ratio_of(&s);
}

double hf_metrics_set_ratio(const hf_model *m, const hf_workspace *w, int n, const int *cable)
{
    spread s = {INFINITY, -INFINITY, false, false};
    for (int i = 0; i < n; i++)
        widen(m, w, cable[i], &s);
    return ratio_of(&s);
}

bool hf_metrics_is_slack(const hf_model *m, const hf_workspace *w, int i_cable)
{
    /* A strut has a negative tension and is not slack, hence the absolute value. */
    return fabs(w->tension_N[i_cable]) < HF_SLACK_RATIO * m->reference_N;
}

int hf_metrics_slack_count(const hf_model *m, const hf_workspace *w)
{
    int n = 0;
    for (int e = 0; e < m->n_cable; e++)
        n += hf_metrics_is_slack(m, w, e);
    return n;
}
