/* Measures the objectives of a design as blocks of residuals, with their exact derivatives (METHOD section 7).
 *
 *     shape in the workspace
 *         | measure: residuals f of each objective, whose norm is its value (the smooth one for a maximum)
 *         v
 *     weight f of all objectives, one after the other;   merit = their norm
 *         | linearise: what the derivatives need of this shape
 *         | push: changes of positions, tensions and displacements by a variable -> change of the residuals
 *         v
 *     derivative [n_row] by that variable
 *
 * Objectives over nets made of the design, which are its load cases and samples of its errors:
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
 *     change of these residuals by a variable
 *
 * objectives_make.c creates the objectives. */
#include <hifdm/objectives.h>

#include "base/arena.h"
#include "base/elementary.h"
#include "linalg/dot.h"
#include "surface/cloud.h"
#include "surface/gain.h"
#include "solve/newton_matrix.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- points ---- */

static void lay_out_cloud(hf_arena *a, const hf_objectives *objectives, int k, hf_cloud *cloud)
{
    const hf_objective_settings *is = &objectives->objective[k].settings;
    bool has_facets = is->figure == HF_FIGURE_FACETS;
    *cloud = (hf_cloud){.kind = objectives->kind,
                        .focal_length_m = objectives->focal_length_m,
                        .along = is->along,
                        .feed = is->feed,
                        .n_node = objectives->model->n_node,
                        .n = objectives->objective[k].n_shape_row,
                        .n_facet = has_facets ? objectives->n_facet : 0,
                        .row = has_facets ? objectives->corner_row : objectives->model->inner_row};
    hf_cloud_lay_out(a, cloud);
}

static void lay_out_gain(hf_arena *a, const hf_objectives *objectives, int k, hf_gain *gain)
{
    *gain = (hf_gain){.beam = &objectives->beam[k],
                      .n_node = objectives->model->n_node,
                      .n = objectives->objective[k].n_shape_row / 2,
                      .n_facet = objectives->n_facet,
                      .row = objectives->corner_row};
    hf_gain_lay_out(a, gain);
}

static void lay_out_point(hf_arena *a, const hf_objectives *objectives, hf_objectives_point *p)
{
    const hf_model *m = objectives->model;
    size_t n_support = (size_t)(m->n_node - m->n_free), n_size = n_support; /* attachments are supports */
    for (int k = 0; k < objectives->n_objective; k++)
        if (objectives->objective[k].settings.figure == HF_FIGURE_RATIO &&
            n_size < (size_t)objectives->objective[k].n_shape_row)
            n_size = (size_t)objectives->objective[k].n_shape_row;
    p->psi_per_m = hf_arena_take(a, (size_t)m->n_inner_node, sizeof(double));
    p->force_N = hf_arena_take(a, 3 * n_support, sizeof(double));
    p->rate_N = hf_arena_take(a, 3 * n_support, sizeof(double));
    p->size = hf_arena_take(a, n_size, sizeof(double));
    p->row = hf_arena_take(a, (size_t)objectives->n_row, sizeof(double));
    size_t n_net = objectives->nets ? (size_t)hf_objectives_nets_count(objectives->nets) : 0;
    p->net_value = hf_arena_take(a, (size_t)objectives->n_objective * n_net, sizeof(double));
    p->net_norm = hf_arena_take(a, (size_t)objectives->n_objective * n_net, sizeof(double));
    p->net_part = hf_arena_take(a, (size_t)objectives->n_objective * n_net, sizeof(double));
    size_t n_sample = objectives->nets ? (size_t)objectives->nets->n_sample : 0;
    p->net_order = hf_arena_take(a, 2 * n_sample, sizeof(double));
    p->net_ranked = hf_arena_take(a, n_sample, sizeof *p->net_ranked);
    p->constraint = hf_arena_take(a, objectives->constraints ? (size_t)objectives->constraints->n : 0, sizeof(double));
    p->cloud = hf_arena_take(a, (size_t)objectives->n_objective, sizeof *p->cloud);
    p->gain = hf_arena_take(a, (size_t)objectives->n_objective, sizeof *p->gain);
    for (int k = 0; k < objectives->n_objective; k++) {
        hf_cloud cloud = {0};
        if (hf_objectives_is_on_surface(objectives->objective[k].settings.figure))
            lay_out_cloud(a, objectives, k, &cloud);
        if (a->block) p->cloud[k] = cloud;
        hf_gain gain = {0};
        if (objectives->objective[k].settings.figure == HF_FIGURE_GAIN) lay_out_gain(a, objectives, k, &gain);
        if (a->block) p->gain[k] = gain;
    }
}

hf_status hf_objectives_point_create(const hf_objectives *objectives, hf_objectives_point *point)
{
    hf_arena arena = {0};
    *point = (hf_objectives_point){0};
    if (!objectives) return HF_OK;
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out_point(&arena, objectives, point)));
    point->block = arena.block;
    point->free_nets = objectives->nets ? objectives->nets->close : NULL;
    const hf_constraints *c = objectives->constraints;
    point->free_constraints = c ? c->close : NULL;
    if (c) HF_TRY(c->open(c, &point->constraints));
    return objectives->nets ? objectives->nets->open(objectives->nets, &point->nets) : HF_OK;
}

void hf_objectives_point_free(hf_objectives_point *point)
{
    if (point->nets) point->free_nets(point->nets);
    if (point->constraints) point->free_constraints(point->constraints);
    hf_arena_free_block(point->block);
    *point = (hf_objectives_point){0};
}

/* ---- sizes of which the maximum counts ---- */

/* Returns x^7. */
static double seventh(double x)
{
    double square = x * x;
    return square * square * square * x;
}

/* Returns the maximum of n sizes s, and sets *norm to the smooth maximum P = (sum s^16)^(1/16). size [n] becomes s/P.
 * The residuals s^8/P^7 have the norm P. */
static double smooth_maximum(int n, double *size, double *norm)
{
    double largest = 0, sum = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, size[i]);
    for (int i = 0; i < n && largest > 0; i++) {
        double part = size[i] / largest, square = part * part, fourth = square * square, eighth = fourth * fourth;
        sum += eighth * eighth;
    }
    *norm = largest * sqrt(sqrt(sqrt(sqrt(sum))));
    for (int i = 0; i < n; i++)
        size[i] = largest > 0 ? size[i] / *norm : 0;
    return largest;
}

/* Replaces rate [n], the changes of the sizes s, by the changes of the residuals s^8/P^7. size [n] holds s/P. Returns
 * the change of P. */
static double push_smooth(int n, const double *size, double *rate)
{
    double norm_rate = 0;
    for (int i = 0; i < n; i++)
        norm_rate += seventh(size[i]) * seventh(size[i]) * size[i] * rate[i];
    for (int i = 0; i < n; i++)
        rate[i] = seventh(size[i]) * (8 * rate[i] - 7 * size[i] * norm_rate);
    return norm_rate;
}

void hf_objectives_pulls(const hf_model *m, const hf_workspace *w, hf_objectives_point *p)
{
    int n = m->n_node - m->n_free;
    memset(p->force_N, 0, 3 * (size_t)n * sizeof(double));
    for (int e = 0; e < m->n_cable; e++) {
        double u[3];
        if (!hf_newton_matrix_is_at_support(m, e)) continue;
        hf_newton_matrix_direction(m, w->position_m, e, u);
        for (int c = 0; c < 3; c++)
            u[c] *= w->tension_N[e];
        hf_newton_matrix_add_to_supports(m, e, u, p->force_N);
    }
    for (int i = 0; i < n; i++)
        p->size[i] = hf_norm(p->force_N[3 * i], p->force_N[3 * i + 1], p->force_N[3 * i + 2]);
}

/* ---- residuals ---- */

/* Sets the residuals f [3 n_inner_node] of psi. Returns psi, m. Loose nodes are left out, as in hf_metrics_psi_m. */
static double measure_psi(const hf_model *m, const hf_workspace *w, hf_objectives_point *p, double *f)
{
    int n = 0;
    for (int k = 0; k < m->n_inner_node; k++)
        n += !w->loose[m->inner_row[k]];
    for (int k = 0; k < m->n_inner_node; k++) {
        int row = m->inner_row[k];
        p->psi_per_m[k] = w->loose[row] ? 0 : 1 / sqrt(n);
        for (int c = 0; c < 3; c++, row += m->n_node)
            f[3 * k + c] = p->psi_per_m[k] > 0 ? p->psi_per_m[k] * (w->position_m[row] - m->position_m[row]) : 0;
    }
    return hf_metrics_psi_m(m, w);
}

static double mean_tension_N(const hf_objective *g, const hf_workspace *w)
{
    double sum = 0;
    for (int i = 0; i < g->n_cable; i++)
        sum += w->tension_N[g->cable[i]];
    return sum / g->n_cable;
}

/* Sets the residuals f of an objective of tension, length or evenness [n_cable], or of mass [1]. */
static void measure_cables(const hf_objective *g, const hf_model *m, const hf_workspace *w, double *f)
{
    const hf_objective_settings *s = &g->settings;
    double root = sqrt(g->n_cable), mean_N = s->figure == HF_FIGURE_EVENNESS ? mean_tension_N(g, w) : 0, mass_kg = 0;
    for (int i = 0; i < g->n_cable; i++) {
        double tension_N = w->tension_N[g->cable[i]], length_m = w->length_m[g->cable[i]];
        double target_m = isnan(s->target) ? m->length_m[g->cable[i]] : s->target;
        if (s->figure == HF_FIGURE_TENSION) f[i] = (tension_N - s->target) / root;
        if (s->figure == HF_FIGURE_LENGTH) f[i] = (length_m - target_m) / root;
        if (s->figure == HF_FIGURE_EVENNESS) f[i] = (tension_N / mean_N - 1) / root;
        if (s->figure == HF_FIGURE_MASS) mass_kg += length_m * s->mass_kg_per_m;
    }
    if (s->figure == HF_FIGURE_MASS) f[0] = mass_kg;
}

/* Sets the residuals f [n] of the n sizes in the point, which become parts of their smooth maximum. Returns the true
 * maximum. */
static double measure_largest(int n, hf_objectives_point *p, double *f)
{
    double norm, largest = smooth_maximum(n, p->size, &norm);
    for (int i = 0; i < n; i++)
        f[i] = norm * seventh(p->size[i]) * p->size[i];
    return largest;
}

/* Sets the sizes of which the maximum counts: of the forces on supports, or of the displacements of attachments. */
static void take_sizes(hf_figure_kind figure, const hf_model *m, const hf_workspace *w, hf_objectives_point *p)
{
    const double *d = w->displacement_m;
    if (figure == HF_FIGURE_PULL) hf_objectives_pulls(m, w, p);
    for (int i = 0; figure == HF_FIGURE_DEFLECTION && i < m->n_attachment; i++, d += 3)
        p->size[i] = hf_norm(d[0], d[1], d[2]);
}

/* Returns A B, the smooth ratio of the maximum to the minimum of n tensions. It is the product of the smooth maximum A
 * of T and B of 1/T, which *high and *low become. size [2n] becomes T/A and 1/(T B). */
static double smooth_ratio(const hf_objective *g, const hf_workspace *w, double *size, double *high, double *low)
{
    int n = g->n_cable;
    for (int i = 0; i < n; i++) {
        size[i] = w->tension_N[g->cable[i]];
        size[n + i] = 1 / size[i];
    }
    smooth_maximum(n, size, high);
    smooth_maximum(n, size + n, low);
    return *high * *low;
}

/* Sets the residuals f [2n] of a ratio, whose norm *norm is A B. With a slack cable or a strut there is no ratio, and f
 * is 0. Returns the true ratio. */
static double measure_ratio(const hf_objective *g, const hf_model *m, const hf_workspace *w, hf_objectives_point *p,
                            double *f, double *norm)
{
    double high, low, ratio = hf_metrics_set_ratio(m, w, g->n_cable, g->cable);
    *norm = ratio;
    memset(f, 0, (size_t)g->n_shape_row * sizeof *f);
    if (!isfinite(ratio)) return ratio;
    *norm = smooth_ratio(g, w, p->size, &high, &low);
    for (int i = 0; i < g->n_shape_row; i++)
        f[i] = sqrt(0.5) * *norm * seventh(p->size[i]) * p->size[i];
    return ratio;
}

/* Computes the residuals of objective k for one shape, without its weight, their norm and the value. Returns
 * HF_OK or HF_NO_MEMORY. The value and the norm differ for a maximum of several sizes and for a ratio. The value is
 * then the true one, and the norm the smooth one. */
static hf_status measure_shape(const hf_objectives *objectives, int k, const hf_workspace *w, hf_objectives_point *p,
                               double *f, double *value, double *norm)
{
    const hf_model *m = objectives->model;
    const hf_objective *g = &objectives->objective[k];
    hf_figure_kind figure = g->settings.figure;
    double largest = -1; /* of several sizes */
    if (figure == HF_FIGURE_PSI || figure == HF_FIGURE_RATIO) {
        *value = figure == HF_FIGURE_PSI ? (*norm = measure_psi(m, w, p, f)) : measure_ratio(g, m, w, p, f, norm);
        return HF_OK;
    }
    if (figure == HF_FIGURE_PULL || figure == HF_FIGURE_DEFLECTION) {
        take_sizes(figure, m, w, p);
        largest = measure_largest(g->n_shape_row, p, f);
    } else if (hf_objectives_is_on_surface(figure)) {
        HF_TRY(hf_cloud_measure(&p->cloud[k], w->position_m, f));
    } else if (figure == HF_FIGURE_GAIN) {
        hf_gain_measure(&p->gain[k], w->position_m, f);
    } else {
        measure_cables(g, m, w, f);
    }
    *norm = sqrt(hf_dot((size_t)g->n_shape_row, f, f));
    *value = largest < 0 ? *norm : largest;
    return HF_OK;
}

/* ---- which nets ---- */

bool hf_objectives_is_smooth(const hf_objective *objective)
{
    return !(objective->settings.quantile > 0) || objective->takes_tail;
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
    return (size_t)k * (size_t)hf_objectives_nets_count(objectives->nets) + (size_t)i_net;
}

/* ---- residuals over as-built nets ---- */

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
        if (shape && measure_shape(q->objectives, k, shape, q->point, f, &value, &norm) != HF_OK)
            q->status = HF_NO_MEMORY;
        q->point->net_value[place_of_net(q->objectives, k, i_net)] = isnan(value) ? (double)INFINITY : value;
        q->point->net_norm[place_of_net(q->objectives, k, i_net)] = isnan(norm) ? (double)INFINITY : norm;
    }
}

/* Finds the as-built nets of the design in the workspace. residual [n_row] receives the residuals of the objectives
 * over nets, without weights; net_value and net_norm of the point are set. Returns HF_OK, also if nets have no shape;
 * HF_NO_MEMORY. */
static hf_status measure_nets(const hf_objectives *objectives, const hf_workspace *w, hf_objectives_point *p,
                              double *residual)
{
    const hf_objectives_nets *nets = objectives->nets;
    measured_nets q = {objectives, p, residual, HF_OK};
    int n_load_case = nets->n_load_case, n_all = hf_objectives_nets_count(nets);
    hf_status status = nets->cut(p->nets, w);
    if (status == HF_NO_MEMORY) return status;
    for (int i = 0; i < n_all && status != HF_OK; i++)
        measure_net(&q, i, NULL);
    for (int i = 0; i < n_load_case && status == HF_OK; i++)
        if (hf_objectives_are_over(objectives, i)) nets->solve(p->nets, i, 1, measure_net, &q);
    for (int i = n_load_case; i < n_all && status == HF_OK; i += nets->n_sample) /* samples in one load case */
        if (hf_objectives_are_over(objectives, i)) nets->solve(p->nets, i, nets->n_sample, measure_net, &q);
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

/* Writes the largest value of each sample over its load cases, worst [n_sample], from value [n_net]. */
static void find_worst(const hf_objective *g, int n_sample, const double *value, double *worst)
{
    memcpy(worst, value, (size_t)n_sample * sizeof *worst);
    for (int s = n_sample; s < g->n_net; s++)
        worst[s % n_sample] = fmax(worst[s % n_sample], value[s]);
}

/* Returns the mean of the samples beyond the quantile, at least of one. part [n_net] becomes the weight of each net in
 * this mean; a sample counts in the load case in which it is worst. worst [2 n_sample] has the norms of the
 * samples, then scratch. */
static double mean_of_worst(const hf_objective *g, hf_objectives_point *p, int n_sample, const double *norm,
                            double *worst, double *part)
{
    double *weight = worst + n_sample, tail = fmax(1, (1 - g->settings.quantile) * n_sample);
    double mean = hf_tail_mean(n_sample, worst, tail, p->net_ranked, weight);
    for (int s = 0; s < g->n_net; s++) {
        bool is_worst = norm[s] >= worst[s % n_sample];
        part[s] = is_worst ? weight[s % n_sample] : 0;
        if (is_worst) weight[s % n_sample] = 0; /* the sample has been counted */
    }
    return mean;
}

/* Returns the factor of the residuals of a net that make up an objective of the norm `combined`: (S/P)^7 for a smooth
 * maximum P, sqrt(w C/S) for a mean of the worst samples C. S is the norm of the net, and part is S/P or w. */
static double factor_of(const hf_objective *g, double norm, double part, double combined)
{
    if (!g->takes_tail) return seventh(part);
    return norm > 0 ? sqrt(part * combined / norm) : 0;
}

/* Multiplies the residuals f of each net by its factor. */
static void scale_nets(const hf_objective *g, const double *norm, const double *part, double combined, double *f)
{
    for (int s = 0; s < g->n_net; s++) {
        double factor = factor_of(g, norm[s], part[s], combined);
        for (int i = 0; i < g->n_shape_row; i++)
            f[s * g->n_shape_row + i] *= factor;
    }
}

/* Combines the nets of objective k: sets *value and *norm. Except for a quantile, its residuals f [n_row of the
 * objective] are scaled so that they have this norm. */
static void gather_nets(const hf_objectives *objectives, int k, hf_objectives_point *p, double *f, double *value,
                        double *norm)
{
    const hf_objective *g = &objectives->objective[k];
    const double *of_net = p->net_value + place_of_net(objectives, k, g->first_net);
    const double *norm_of_net = p->net_norm + place_of_net(objectives, k, g->first_net);
    double *part = p->net_part + place_of_net(objectives, k, g->first_net);
    size_t n = (size_t)g->n_net;
    *value = hf_max_magnitude(n, of_net);
    *norm = hf_max_magnitude(n, norm_of_net);
    if (g->n_net == 1) return;
    if (g->settings.quantile > 0) {
        int n_sample = objectives->nets->n_sample;
        double *worst = p->net_order, *scratch = worst + n_sample;
        find_worst(g, n_sample, of_net, worst);
        *value = quantile_of(n_sample, worst, g->settings.quantile, scratch);
        find_worst(g, n_sample, norm_of_net, worst);
        *norm = g->takes_tail ? mean_of_worst(g, p, n_sample, norm_of_net, worst, part)
                              : quantile_of(n_sample, worst, g->settings.quantile, scratch);
        if (g->takes_tail && isfinite(*norm)) scale_nets(g, norm_of_net, part, *norm, f);
    } else if (isfinite(*norm) && g->settings.take == HF_TAKE_WORST) {
        memcpy(part, norm_of_net, n * sizeof *part);
        smooth_maximum(g->n_net, part, norm);
        scale_nets(g, norm_of_net, part, *norm, f);
    } else if (isfinite(*norm)) {
        *value = sqrt(hf_dot(n, of_net, of_net) / g->n_net);
        *norm = sqrt(hf_dot(n, norm_of_net, norm_of_net) / g->n_net);
        for (int i = 0; i < g->n_row; i++)
            f[i] /= sqrt(g->n_net);
    }
}

/* ---- all residuals ---- */

/* Sets f [n_row] to the weighted residuals, `value` [n_objective] (may be NULL) and *merit. with_nets: of all
 * objectives, else of those of the design itself alone. Returns HF_OK or HF_NO_MEMORY. */
static hf_status measure_all(const hf_objectives *objectives, const hf_workspace *w, hf_objectives_point *p,
                             bool with_nets, double *f, double *value, double *merit)
{
    double square = 0, norm = 0;
    if (objectives->nets && with_nets) HF_TRY(measure_nets(objectives, w, p, f));
    for (int k = 0; k < objectives->n_objective; k++) {
        const hf_objective *g = &objectives->objective[k];
        double one, *of_objective = f + g->first_row;
        if (g->n_net && !with_nets) continue;
        if (g->n_net)
            gather_nets(objectives, k, p, of_objective, value ? &value[k] : &one, &norm);
        else
            HF_TRY(measure_shape(objectives, k, w, p, of_objective, value ? &value[k] : &one, &norm));
        for (int i = 0; i < g->n_row; i++)
            of_objective[i] *= g->settings.weight;
        norm *= g->settings.weight;
        square += norm * norm;
    }
    *merit = objectives->n_objective == 1 ? norm : sqrt(square);
    return HF_OK;
}

hf_status hf_objectives_measure(const hf_objectives *objectives, const hf_workspace *w, hf_objectives_point *p,
                                double *value, double *merit)
{
    return measure_all(objectives, w, p, true, p->row, value, merit);
}

/* Prepares push_shape for objective k and the shape that was measured last. Returns HF_OK,
 * HF_NOT_FINITE or HF_NO_MEMORY. */
static hf_status linearise_shape(const hf_objectives *objectives, int k, const hf_workspace *w, hf_objectives_point *p)
{
    if (objectives->objective[k].settings.figure == HF_FIGURE_GAIN) hf_gain_linearise(&p->gain[k], w->position_m);
    return hf_objectives_is_on_surface(objectives->objective[k].settings.figure) ? hf_cloud_linearise(&p->cloud[k])
                                                                                 : HF_OK;
}

hf_status hf_objectives_linearise(const hf_objectives *objectives, bool with_nets, const hf_workspace *w,
                                  hf_objectives_point *p, double *residual)
{
    double merit;
    HF_TRY(measure_all(objectives, w, p, with_nets, residual, NULL, &merit));
    if (!isfinite(merit)) return HF_NOT_FINITE;
    for (int k = 0; k < objectives->n_objective; k++)
        if (!objectives->objective[k].n_net) HF_TRY(linearise_shape(objectives, k, w, p));
    return HF_OK;
}

/* ---- derivatives ---- */

static void push_psi(const hf_model *m, const hf_objectives_point *p, const double *move, double *rate)
{
    for (int k = 0; k < m->n_inner_node; k++)
        for (int c = 0; c < 3; c++)
            rate[3 * k + c] = p->psi_per_m[k] * move[c * m->n_node + m->inner_row[k]];
}

static double length_rate(const hf_model *m, const hf_workspace *w, int e, const double *move)
{
    double u[3], relative[3];
    hf_newton_matrix_direction(m, w->position_m, e, u);
    return hf_newton_matrix_length_rate(m, e, u, move, relative);
}

static void push_cables(const hf_objective *g, const hf_model *m, const hf_workspace *w, const hf_objectives_rate *by,
                        double *rate)
{
    double root = sqrt(g->n_cable), mean_N = 0, mean_rate_N = 0, sum_m = 0;
    hf_figure_kind figure = g->settings.figure;
    if (figure == HF_FIGURE_EVENNESS) {
        mean_N = mean_tension_N(g, w);
        for (int i = 0; i < g->n_cable; i++)
            mean_rate_N += by->tension_N[g->cable[i]] / g->n_cable;
    }
    for (int i = 0; i < g->n_cable; i++) {
        int e = g->cable[i];
        double rate_N = by->tension_N[e];
        if (figure == HF_FIGURE_TENSION) rate[i] = rate_N / root;
        if (figure == HF_FIGURE_LENGTH) rate[i] = length_rate(m, w, e, by->position_m) / root;
        if (figure == HF_FIGURE_EVENNESS)
            rate[i] = (rate_N - w->tension_N[e] * (mean_rate_N / mean_N)) / (mean_N * root);
        if (figure == HF_FIGURE_MASS) sum_m += length_rate(m, w, e, by->position_m);
    }
    if (figure == HF_FIGURE_MASS) rate[0] = g->settings.mass_kg_per_m * sum_m;
}

void hf_objectives_pull_rates(const hf_model *m, const hf_workspace *w, hf_objectives_point *p,
                              const hf_objectives_rate *by, double *rate)
{
    int n = m->n_node - m->n_free;
    memset(p->rate_N, 0, 3 * (size_t)n * sizeof(double));
    hf_objectives_pulls(m, w, p);
    for (int e = 0; e < m->n_cable; e++) {
        double pull[3];
        if (!hf_newton_matrix_is_at_support(m, e)) continue;
        hf_newton_matrix_pull_rate(m, w->position_m, e, w->tension_N[e], by->tension_N[e], by->position_m, pull);
        hf_newton_matrix_add_to_supports(m, e, pull, p->rate_N);
    }
    for (int i = 0; i < n; i++)
        rate[i] = hf_norm_rate(p->force_N + 3 * (size_t)i, p->rate_N + 3 * (size_t)i);
}

/* Computes the rates of the residuals of a maximum of n sizes. */
static void push_largest(int n, hf_figure_kind figure, const hf_model *m, const hf_workspace *w, hf_objectives_point *p,
                         const hf_objectives_rate *by, double *rate)
{
    double norm;
    if (figure == HF_FIGURE_PULL)
        hf_objectives_pull_rates(m, w, p, by, rate);
    else
        for (int i = 0; i < n; i++)
            rate[i] = hf_norm_rate(w->displacement_m + 3 * (size_t)i, by->displacement_m + 3 * (size_t)i);
    take_sizes(figure, m, w, p);
    smooth_maximum(n, p->size, &norm);
    push_smooth(n, p->size, rate);
}

static void push_ratio(const hf_objective *g, const hf_workspace *w, hf_objectives_point *p,
                       const hf_objectives_rate *by, double *rate)
{
    int n = g->n_cable;
    double high, low;
    smooth_ratio(g, w, p->size, &high, &low);
    for (int i = 0; i < n; i++) {
        double tension = w->tension_N[g->cable[i]];
        rate[i] = by->tension_N[g->cable[i]];
        rate[n + i] = -rate[i] / (tension * tension);
    }
    double high_rate = push_smooth(n, p->size, rate), low_rate = push_smooth(n, p->size + n, rate + n);
    for (int i = 0; i < n; i++) {
        double *of_high = &rate[i], *of_low = &rate[n + i];
        *of_high = sqrt(0.5) * (low * *of_high + high * low_rate * seventh(p->size[i]) * p->size[i]);
        *of_low = sqrt(0.5) * (high * *of_low + low * high_rate * seventh(p->size[n + i]) * p->size[n + i]);
    }
}

/* Computes the rates of the residuals of objective k for one shape, without its weight, from the rates `by`
 * of the shape. */
static void push_shape(const hf_objectives *objectives, int k, const hf_workspace *w, hf_objectives_point *p,
                       const hf_objectives_rate *by, double *rate)
{
    const hf_model *m = objectives->model;
    const hf_objective *g = &objectives->objective[k];
    hf_figure_kind figure = g->settings.figure;
    if (figure == HF_FIGURE_PSI)
        push_psi(m, p, by->position_m, rate);
    else if (figure == HF_FIGURE_PULL || figure == HF_FIGURE_DEFLECTION)
        push_largest(g->n_shape_row, figure, m, w, p, by, rate);
    else if (figure == HF_FIGURE_RATIO)
        push_ratio(g, w, p, by, rate);
    else if (hf_objectives_is_on_surface(figure))
        hf_cloud_push(&p->cloud[k], by->position_m, rate);
    else if (figure == HF_FIGURE_GAIN)
        hf_gain_push(&p->gain[k], by->position_m, rate);
    else
        push_cables(g, m, w, by, rate);
}

void hf_objectives_push(const hf_objectives *objectives, const hf_workspace *w, hf_objectives_point *p,
                        const hf_objectives_rate *by, double *rate)
{
    for (int k = 0; k < objectives->n_objective; k++) {
        const hf_objective *g = &objectives->objective[k];
        if (g->n_net) continue;
        push_shape(objectives, k, w, p, by, rate + g->first_row);
        for (int i = 0; i < g->n_row; i++)
            rate[g->first_row + i] *= g->settings.weight;
    }
}

/* ---- derivatives over as-built nets ---- */

hf_status hf_objectives_nets_linearise(const hf_objectives *objectives, int i_net, hf_objectives_point *p,
                                       const hf_workspace **shape)
{
    HF_TRY(objectives->nets->linearise(p->nets, i_net, shape));
    for (int k = 0; k < objectives->n_objective; k++) {
        double value, norm;
        if (!is_over(&objectives->objective[k], i_net)) continue;
        HF_TRY(measure_shape(objectives, k, *shape, p, p->row, &value, &norm));
        if (!isfinite(norm)) return HF_NOT_FINITE;
        HF_TRY(linearise_shape(objectives, k, *shape, p));
    }
    return HF_OK;
}

void hf_objectives_nets_push(const hf_objectives *objectives, int i_net, const hf_workspace *shape,
                             hf_objectives_point *p, const hf_objectives_rate *by, double *rate)
{
    for (int k = 0; k < objectives->n_objective; k++)
        if (is_over(&objectives->objective[k], i_net))
            push_shape(objectives, k, shape, p, by, rate + row_of_net(&objectives->objective[k], i_net));
}

/* Replaces rate, the changes dg of the residuals g of each net alone, by the changes of f = weight a g, the residuals
 * of the objective, with a of factor_of. dS is the component of dg along g.
 *
 *     smooth maximum         df = weight a dg + 7 f (dS/S - dP/P),    dP = sum of (S/P)^15 dS
 *     mean of the worst      df = weight a dg - f/2 (dS/S - dC/C),    dC = sum of w dS
 *
 * norm [n_net] has S, and part [n_net] has S/P or w. */
static void close_nets(const hf_objective *g, const double *norm, const double *part, const double *f, double *rate)
{
    double combined = 0, combined_rate = 0, power = g->takes_tail ? -0.5 : 7;
    size_t n = (size_t)g->n_shape_row;
    for (int s = 0; s < g->n_net; s++) {
        if (g->takes_tail && part[s] > 0) combined += part[s] * norm[s];
        if (!g->takes_tail && norm[s] > 0) combined = fmax(combined, norm[s] / part[s]);
    }
    for (int pass = 0; pass < 2; pass++)
        for (int s = 0; s < g->n_net; s++) {
            const double *of_net = f + (size_t)s * n;
            double *by_net = rate + (size_t)s * n, length = sqrt(hf_dot(n, of_net, of_net));
            double factor = factor_of(g, norm[s], part[s], combined), turn = 0;
            double norm_rate = length > 0 ? hf_dot(n, of_net, by_net) / length : 0;
            if (pass == 0) {
                combined_rate += (g->takes_tail ? part[s] : factor * factor * part[s]) * norm_rate;
                continue;
            }
            if (length > 0) turn = power * (norm_rate / norm[s] - combined_rate / combined);
            for (size_t i = 0; i < n; i++)
                by_net[i] = g->settings.weight * factor * by_net[i] + turn * of_net[i];
        }
}

void hf_objectives_nets_close(const hf_objectives *objectives, const hf_objectives_point *p, const double *residual,
                              double *rate)
{
    for (int k = 0; k < objectives->n_objective; k++) {
        const hf_objective *g = &objectives->objective[k];
        double *of_objective = rate + g->first_row;
        if (g->n_net == 0) continue;
        if (g->n_net > 1 && (g->takes_tail || g->settings.take == HF_TAKE_WORST)) {
            size_t at = place_of_net(objectives, k, g->first_net);
            close_nets(g, p->net_norm + at, p->net_part + at, residual + g->first_row, of_objective);
            continue;
        }
        for (int i = 0; i < g->n_row; i++)
            of_objective[i] *= g->settings.weight / sqrt(g->n_net);
    }
}
