/* Measures objectives over nets made of the design: its load cases, and samples of its errors (METHOD section 7).
 *
 *     shape of the design
 *         | cut its pieces, solve the nets (functions of hf_objectives_nets)
 *         v
 *     residuals, value and norm of each net
 *         | gather: mean (root of the mean of squares), worst (smooth maximum P), or a quantile
 *         v
 *     residuals of the objective, with its value and norm
 *         | linearise and push net by net, then close: the chain rule of mean and worst
 *         v
 *     change of these residuals by a variable */
#include <hifdm/objectives.h>

#include "base/elementary.h"
#include "linalg/dot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- which nets ---- */

bool hf_objectives_is_smooth(const hf_objective_settings *objective)
{
    return !(objective->quantile > 0);
}

static bool is_over(const hf_objective *g, int i_net)
{
    return i_net >= g->first_net && i_net < g->first_net + g->n_net;
}

bool hf_objectives_are_over(const hf_objectives *objectives, int i_net)
{
    for (int k = 0; k < objectives->n_objective; k++)
        if (is_over(&objectives->objective[k], i_net)) return true;
    return false;
}

/* Returns the row at which the residuals of net i_net begin. */
static int row_of_net(const hf_objective *g, int i_net)
{
    return g->first_row + (i_net - g->first_net) * g->n_shape_row;
}

static size_t place_of_net(const hf_objectives *objectives, int k, int i_net)
{
    return (size_t)k * ((size_t)objectives->nets->n_load_case + (size_t)objectives->nets->n_sample) + (size_t)i_net;
}

/* ---- residuals ---- */

typedef struct {
    const hf_objectives *objectives;
    hf_objectives_point *point;
    double *residual;
    hf_status status;
} measured_nets;

/* Measures the objectives over net i_net. A net without a shape, or without a value, counts as the worst: both are
 * infinite. */
static void measure_net(void *context, int i_net, const hf_workspace *shape)
{
    measured_nets *q = context;
    for (int k = 0; k < q->objectives->n_objective; k++) {
        const hf_objective *g = &q->objectives->objective[k];
        double *f = q->residual + row_of_net(g, i_net), value = INFINITY, norm = INFINITY;
        if (!is_over(g, i_net)) continue;
        memset(f, 0, (size_t)g->n_shape_row * sizeof *f);
        if (shape && hf_objectives_measure_shape(q->objectives, k, shape, q->point, f, &value, &norm) != HF_OK)
            q->status = HF_NO_MEMORY;
        q->point->net_value[place_of_net(q->objectives, k, i_net)] = isnan(value) ? (double)INFINITY : value;
        q->point->net_norm[place_of_net(q->objectives, k, i_net)] = isnan(norm) ? (double)INFINITY : norm;
    }
}

hf_status hf_objectives_nets_measure(const hf_objectives *objectives, const hf_workspace *w, hf_objectives_point *p,
                                     double *residual)
{
    const hf_objectives_nets *nets = objectives->nets;
    measured_nets q = {objectives, p, residual, HF_OK};
    int n_load_case = nets->n_load_case, n_sample = nets->n_sample;
    bool has_samples = n_sample > 0 && hf_objectives_are_over(objectives, n_load_case);
    hf_status status = nets->cut(p->nets, w);
    if (status == HF_NO_MEMORY) return status;
    for (int i = 0; i < n_load_case + n_sample && status != HF_OK; i++)
        measure_net(&q, i, NULL);
    for (int i = 0; i < n_load_case && status == HF_OK; i++)
        if (hf_objectives_are_over(objectives, i)) nets->solve(p->nets, i, 1, measure_net, &q);
    if (has_samples && status == HF_OK) nets->solve(p->nets, n_load_case, n_sample, measure_net, &q);
    return q.status;
}

/* Returns the value that the fraction `part` of n values does not exceed, an order statistic as in built/statistics.h.
 * order [n] is scratch. */
static double quantile_of(int n, const double *value, double part, double *order)
{
    int rank = (int)ceil(part * n);
    memcpy(order, value, (size_t)n * sizeof *order);
    qsort(order, (size_t)n, sizeof *order, hf_compare_doubles);
    return order[rank > 0 ? rank - 1 : 0];
}

/* Multiplies the residuals f of each net by (S/P)^7 and returns their norm P. S is the norm of a net and P the smooth
 * maximum of all S. part [n_net] becomes S/P. */
static double scale_worst(const hf_objective *g, const double *norm, double *part, double *f)
{
    double smooth;
    memcpy(part, norm, (size_t)g->n_net * sizeof *part);
    hf_objectives_smooth_maximum(g->n_net, part, &smooth);
    for (int s = 0; s < g->n_net; s++)
        for (int i = 0; i < g->n_shape_row; i++)
            f[s * g->n_shape_row + i] *= hf_objectives_seventh(part[s]);
    return smooth;
}

static double largest_of(int n, const double *value)
{
    double largest = 0;
    for (int s = 0; s < n; s++)
        largest = fmax(largest, value[s]);
    return largest;
}

void hf_objectives_nets_gather(const hf_objectives *objectives, int k, hf_objectives_point *p, double *f, double *value,
                               double *norm)
{
    const hf_objective *g = &objectives->objective[k];
    const double *of_net = p->net_value + place_of_net(objectives, k, g->first_net);
    const double *norm_of_net = p->net_norm + place_of_net(objectives, k, g->first_net);
    double *part = p->net_part + place_of_net(objectives, k, g->first_net);
    size_t n = (size_t)g->n_net;
    *value = largest_of(g->n_net, of_net);
    *norm = largest_of(g->n_net, norm_of_net);
    if (g->n_net == 1) return;
    if (g->settings.quantile > 0) {
        *value = quantile_of(g->n_net, of_net, g->settings.quantile, part);
        *norm = quantile_of(g->n_net, norm_of_net, g->settings.quantile, part);
    } else if (isfinite(*norm) && g->settings.take == HF_TAKE_WORST) {
        *norm = scale_worst(g, norm_of_net, part, f);
    } else if (isfinite(*norm)) {
        *value = sqrt(hf_dot(n, of_net, of_net) / g->n_net);
        *norm = sqrt(hf_dot(n, norm_of_net, norm_of_net) / g->n_net);
        for (int i = 0; i < g->n_row; i++)
            f[i] /= sqrt(g->n_net);
    }
}

/* ---- derivatives ---- */

hf_status hf_objectives_nets_linearise(const hf_objectives *objectives, int i_net, hf_objectives_point *p,
                                       const hf_workspace **shape)
{
    HF_TRY(objectives->nets->linearise(p->nets, i_net, shape));
    for (int k = 0; k < objectives->n_objective; k++) {
        double value, norm;
        if (!is_over(&objectives->objective[k], i_net)) continue;
        HF_TRY(hf_objectives_measure_shape(objectives, k, *shape, p, p->row, &value, &norm));
        if (!isfinite(norm)) return HF_NOT_FINITE;
        HF_TRY(hf_objectives_linearise_shape(objectives, k, *shape, p));
    }
    return HF_OK;
}

void hf_objectives_nets_push(const hf_objectives *objectives, int i_net, const hf_workspace *shape,
                             hf_objectives_point *p, const hf_objectives_rate *by, double *rate)
{
    for (int k = 0; k < objectives->n_objective; k++)
        if (is_over(&objectives->objective[k], i_net))
            hf_objectives_push_shape(objectives, k, shape, p, by, rate + row_of_net(&objectives->objective[k], i_net));
}

/* Replaces rate, the changes dg of the residuals g of each net alone, by the changes of f = weight (S/P)^7 g, the
 * residuals of the objective. They are df = weight (S/P)^7 dg + 7 f (dS/S - dP/P) with dP = sum (S/P)^15 dS. dS is the
 * component of dg along g. norm [n_net] has S and part [n_net] has S/P. */
static void close_worst(const hf_objective *g, const double *norm, const double *part, const double *f, double *rate)
{
    double smooth = 0, smooth_rate = 0;
    size_t n = (size_t)g->n_shape_row;
    for (int s = 0; s < g->n_net; s++)
        if (norm[s] > 0) smooth = fmax(smooth, norm[s] / part[s]);
    for (int pass = 0; pass < 2; pass++)
        for (int s = 0; s < g->n_net; s++) {
            const double *of_net = f + (size_t)s * n;
            double *by_net = rate + (size_t)s * n, length = sqrt(hf_dot(n, of_net, of_net));
            double seventh = hf_objectives_seventh(part[s]), turn = 0;
            double norm_rate = length > 0 ? hf_dot(n, of_net, by_net) / length : 0;
            if (pass == 0) {
                smooth_rate += seventh * seventh * part[s] * norm_rate;
                continue;
            }
            if (length > 0) turn = 7 * (norm_rate / norm[s] - smooth_rate / smooth);
            for (size_t i = 0; i < n; i++)
                by_net[i] = g->settings.weight * seventh * by_net[i] + turn * of_net[i];
        }
}

void hf_objectives_nets_close(const hf_objectives *objectives, const hf_objectives_point *p, const double *residual,
                              double *rate)
{
    for (int k = 0; k < objectives->n_objective; k++) {
        const hf_objective *g = &objectives->objective[k];
        double *of_objective = rate + g->first_row;
        if (g->n_net == 0) continue;
        if (g->settings.take == HF_TAKE_WORST && g->n_net > 1) {
            size_t at = place_of_net(objectives, k, g->first_net);
            close_worst(g, p->net_norm + at, p->net_part + at, residual + g->first_row, of_objective);
            continue;
        }
        for (int i = 0; i < g->n_row; i++)
            of_objective[i] *= g->settings.weight / sqrt(g->n_net);
    }
}
