/* Implements constraints.h. Contents: the constraints - figures of a net - measuring a design - derivatives of a
 * figure - derivatives of all constraints - making. */
#include "built/constraints.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "built/required_radio.h"
#include "linalg/dot.h"
#include "solve/newton_matrix.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One constraint at one net. */
typedef struct {
    int k, column;
    double item, weight; /* weight: derivative of the constraint by the figure */
} term;

/* Working memory of a thread. */
typedef struct {
    const hf_built_constraints *c;
    void *nets;             /* NULL: there are none */
    hf_cloud *cloud;        /* [n_column] of the columns that measure a surface */
    double *residual;       /* [n_column][n_point] of the clouds at the present net */
    double *residual_rate;  /* [n_point] scratch */
    size_t n_point;         /* maximum number of points of a cloud */
    hf_surface_design fits; /* best fits to the design */
    hf_surface_paths paths; /* errors of the present net, if has_paths */
    bool has_paths;
    hf_antenna *antenna;       /* [n_antenna] antennas whose best fits start from the design */
    hf_antenna_figures *radio; /* [n_antenna] figures of the present net, of the groups that are measured */
    unsigned *has_radio;       /* [n_antenna] these groups */
    double *gradient;          /* [n_column][n_node][3] of figures at a frequency at the present net */
    const hf_workspace *design;
    bool is_smooth;
    hf_status status;
    double *distance; /* [n][n_sample] of each sample, or in the first entry that of the design in its load case */
    int *worst_state; /* [n][n_sample] load case of this distance */
    double *weight;   /* [n][n_sample] derivative of each constraint by these distances */
    hf_ranked *order; /* [n_sample] scratch */
    term *list;       /* [n] scratch */
    double *move_m, *tension_rate; /* [HF_OBJECTIVES_AT_ONCE][3][n_node], [...][n_cable] */
    hf_arena arena;
    void *block;
} constraints_room;

/* ---- the constraints ---- */

static bool is_judged(const hf_requirement_settings *r)
{
    return r->search == HF_SEARCH_ON && r->figure != HF_REQUIRED_LOOSE;
}

unsigned hf_built_constraints_states(const hf_required *q, bool is_many)
{
    unsigned states = 0;
    for (int i = 0; i < q->n; i++)
        if (is_judged(&q->row[i]) && !isnan(q->row[i].share) == is_many) states |= q->states[i];
    return states;
}

static bool is_over_samples(const hf_built_constraints *c, int k)
{
    return c->state[k] < 0;
}

/* Returns whether constraint k is about a net in load case `state`. */
static bool is_about(const hf_built_constraints *c, int k, int state, bool is_many)
{
    if (is_over_samples(c, k) != is_many) return false;
    return is_many ? c->required->states[c->row[k]] >> state & 1u : c->state[k] == state;
}

/* Returns the place of the distance of constraint k in the arrays of a room. */
static size_t place_of(const hf_built_constraints *c, int k, int i_sample)
{
    size_t n = c->nets && c->nets->as.n_sample > 0 ? (size_t)c->nets->as.n_sample : 1;
    return (size_t)k * n + (size_t)i_sample;
}

/* ---- figures of a net ---- */

static bool is_of_surface(const hf_required_column *c)
{
    return hf_required_is_of(c->figure, HF_REQUIRED_OF_SURFACE);
}

/* Returns the tension of the set of which the row allows `most` cables to be slack: the most + 1 st one from below.
 * *item becomes its cable. */
static double brink_N(const hf_required_column *c, const hf_workspace *w, int most, double *item)
{
    double best_N = -INFINITY;
    for (int i = 0; i < c->n_cable; i++) {
        double T = w->tension_N[c->cable[i]];
        int n_below = 0;
        for (int k = 0; k < c->n_cable && n_below <= most; k++)
            n_below += w->tension_N[c->cable[k]] < T;
        if (n_below > most || T < best_N) continue;
        best_N = T;
        *item = c->cable[i];
    }
    return best_N;
}

/* Returns the minimum tension of the set if no cable may be slack, which brink_N finds in more time. */
static double taut_N(const hf_required_column *c, const hf_workspace *w, int most, double *item)
{
    return most > 0 ? brink_N(c, w, most, item) : hf_required_extreme_N(c, w->tension_N, true, item);
}

static hf_required_net net_of(const constraints_room *r, const hf_workspace *w)
{
    return (hf_required_net){r->c->model, w->position_m, w->tension_N};
}

/* Forgets what was measured of the net before. */
static void begin_net(constraints_room *r)
{
    r->has_paths = false;
    memset(r->has_radio, 0, (size_t)r->c->required->n_antenna * sizeof *r->has_radio);
}

/* Measures the group of figures of a column at a frequency, unless the present net already has it. */
static void measure_radio(constraints_room *r, const hf_required_column *q, const hf_workspace *w)
{
    const hf_required_net net = net_of(r, w);
    unsigned what[HF_REQUIREMENT_ROWS_MAX] = {0}, group = hf_required_radio_group(q);
    if (r->has_radio[q->antenna] & group) return;
    what[q->antenna] = group;
    if (hf_required_radio_measure(r->c->required, r->antenna, what, &net, r->radio) != HF_OK) r->status = HF_NO_MEMORY;
    r->has_radio[q->antenna] |= group;
}

/* Returns the figure of a column, and its cable or support in *item. NaN: it has no value. The errors of the surface
 * are measured once for each net, from the best fit to the design. */
static double figure_of(constraints_room *r, int column, const hf_workspace *w, double *item)
{
    const hf_built_constraints *c = r->c;
    const hf_required_column *q = &c->required->column[column];
    if (is_of_surface(q) && !r->has_paths) {
        if (hf_surface_measure_near(&r->fits, c->surface, c->facets, c->model, w->position_m, w->tension_N,
                                    &r->paths) != HF_OK)
            r->status = HF_NO_MEMORY;
        r->has_paths = true;
    }
    if (q->antenna >= 0) measure_radio(r, q, w);
    const hf_required_shape shape = {.model = c->model,
                                     .position_m = w->position_m,
                                     .tension_N = w->tension_N,
                                     .displacement_m = w->displacement_m,
                                     .paths = r->paths,
                                     .radio = r->radio};
    return hf_required_figure_of(c->required, q, &shape, item);
}

/* Returns how far the figure is beyond one bound of a row, in the unit of the figure; NAN without the bound. */
static double beyond(constraints_room *r, int i_row, bool is_high, const hf_workspace *w, double *item)
{
    const hf_required *q = r->c->required;
    const hf_requirement_settings *row = &q->row[i_row];
    int column = is_high ? q->high[i_row] : q->low[i_row];
    if (column < 0) return (double)NAN;
    double slack_N = HF_SLACK_RATIO * r->c->model->reference_N;
    if (row->figure == HF_REQUIRED_SLACK)
        return is_high ? slack_N - taut_N(&q->column[column], w, (int)row->at_most, item) : (double)NAN;
    double value = figure_of(r, column, w, item);
    double distance = is_high ? value - row->at_most : row->at_least - value;
    return isfinite(distance) ? distance : (double)INFINITY;
}

/* Returns the unit of a distance from a bound. */
static double unit_of(const hf_required_column *column, double bound, const hf_model *m)
{
    if (column->figure == HF_REQUIRED_SLACK) return HF_SLACK_RATIO * m->reference_N;
    if (column->figure == HF_REQUIRED_GAIN) return 1; /* a ratio in dB, whose zero means nothing */
    if (bound != 0) return fabs(bound);
    return column->figure == HF_REQUIRED_TENSION || column->figure == HF_REQUIRED_PULL ? m->reference_N : 1;
}

/* Returns the factor of distances from one bound of constraint k. A constraint about samples is the distance from the
 * nearer of two bounds; with bounds other than 0 it is relative to each, as margins are, in its own unit. */
static double scale_of(const hf_built_constraints *c, int k, bool is_high)
{
    const hf_required *q = c->required;
    const hf_requirement_settings *row = &q->row[c->row[k]];
    if (!is_over_samples(c, k) || !hf_required_has_two_bounds(row)) return 1;
    int column = is_high ? q->high[c->row[k]] : q->low[c->row[k]];
    return column < 0 ? 1 : c->unit[k] / unit_of(&q->column[column], is_high ? row->at_most : row->at_least, c->model);
}

/* Returns the distance of constraint k for a net, over both bounds of its row if it is about samples. */
static double distance_of(constraints_room *r, int k, const hf_workspace *w, bool *is_high, double *item)
{
    const hf_built_constraints *c = r->c;
    double most = -INFINITY, at;
    if (!w) return HF_BUILT_NO_VALUE * c->unit[k];
    for (int high = 0; high < 2; high++) {
        if (!is_over_samples(c, k) && c->is_high[k] != high) continue;
        double distance = scale_of(c, k, high) * beyond(r, c->row[k], high, w, &at);
        if (!(distance > most)) continue;
        most = distance;
        *is_high = high;
        *item = at;
    }
    return isfinite(most) ? most : HF_BUILT_NO_VALUE * c->unit[k];
}

/* ---- measuring a design ---- */

/* Returns the load case of a net, and in *i_sample the number of its sample, -1 for the design. */
static int state_of_net(const hf_built_constraints *c, int i_net, int *i_sample)
{
    const hf_objectives_nets *nets = &c->nets->as;
    *i_sample = -1;
    if (i_net < nets->n_load_case) return 1 + i_net;
    int state = (i_net - nets->n_load_case) / nets->n_sample;
    *i_sample = (i_net - nets->n_load_case) % nets->n_sample;
    return state == 0 ? 0 : 1 + c->nets->as.sample_load_case[state];
}

static void measure_net(void *context, int i_net, const hf_workspace *shape)
{
    constraints_room *r = context;
    const hf_built_constraints *c = r->c;
    bool is_high = false;
    double item;
    int i_sample, state = state_of_net(c, i_net, &i_sample);
    begin_net(r);
    for (int k = 0; k < c->as.n; k++) {
        if (!is_about(c, k, state, i_sample >= 0)) continue;
        size_t at = place_of(c, k, i_sample < 0 ? 0 : i_sample);
        double distance = distance_of(r, k, shape, &is_high, &item);
        if (!(distance > r->distance[at])) continue;
        r->distance[at] = distance;
        r->worst_state[at] = state;
    }
}

/* Combines the samples of constraint k: their quantile or, smooth, the mean of the worst ones with its derivatives by
 * the distances. */
static double gather(constraints_room *r, int k)
{
    const hf_built_constraints *c = r->c;
    const double *distance = r->distance + place_of(c, k, 0);
    int n = c->nets->as.n_sample;
    double tail = (1 - c->required->row[c->row[k]].share) * n;
    double mean = hf_tail_mean(n, distance, fmax(1, tail), r->order, r->weight + place_of(c, k, 0));
    int whole = (int)floor(tail * (1 + 1e-12));
    return r->is_smooth ? mean : r->order[whole < n ? whole : n - 1].value;
}

static hf_status measure_design(void *room, const hf_workspace *w, bool is_smooth, double *value)
{
    constraints_room *r = room;
    const hf_built_constraints *c = r->c;
    const hf_objectives_nets *nets = c->nets ? &c->nets->as : NULL;
    size_t n_distance = place_of(c, c->as.n, 0);
    double item;
    bool is_high = false;
    hf_status status = HF_OK;
    r->is_smooth = is_smooth;
    r->design = w;
    r->status = HF_OK;
    begin_net(r);
    if (c->needs_surface)
        HF_TRY(hf_surface_design_make(c->surface, c->facets, c->model, w->position_m, w->tension_N, &r->fits));
    if (c->needs_radio) {
        const hf_required_net net = net_of(r, w);
        HF_TRY(hf_required_radio_near(c->required, &net, r->antenna));
    }
    for (size_t i = 0; i < n_distance; i++)
        r->distance[i] = -INFINITY;
    for (int k = 0; k < c->as.n; k++)
        if (is_about(c, k, 0, false)) r->distance[place_of(c, k, 0)] = distance_of(r, k, w, &is_high, &item);
    if (nets) status = nets->cut(r->nets, w);
    if (status == HF_NO_MEMORY) return status;
    unsigned nominal = hf_built_constraints_states(c->required, false),
             many = hf_built_constraints_states(c->required, true);
    for (int state = 0; nets && state < c->required->n_state; state++) {
        int first =
            nets->n_load_case + (c->state_of_samples[state] < 0 ? 0 : c->state_of_samples[state]) * nets->n_sample;
        if (state > 0 && nominal >> state & 1u) {
            if (status == HF_OK)
                nets->solve(r->nets, state - 1, 1, measure_net, r);
            else
                measure_net(r, state - 1, NULL);
        }
        if (!(many >> state & 1u)) continue;
        if (status == HF_OK) nets->solve(r->nets, first, nets->n_sample, measure_net, r);
        for (int i = 0; i < nets->n_sample && status != HF_OK; i++)
            measure_net(r, first + i, NULL);
    }
    for (int k = 0; k < c->as.n; k++)
        value[k] = is_over_samples(c, k) ? gather(r, k) : r->distance[place_of(c, k, 0)];
    return r->status;
}

/* ---- derivatives of a figure ---- */

static double psi_rate(const hf_model *m, const hf_workspace *w, const double *move)
{
    double sum = 0, square = 0;
    for (int k = 0; k < 3 * m->n_inner_node; k++) {
        int at = k % 3 * m->n_node + m->inner_row[k / 3];
        double d = w->position_m[at] - m->position_m[at];
        square += d * d;
        sum += d * move[at];
    }
    return square > 0 ? sum / sqrt(square * m->n_inner_node) : 0;
}

/* Returns the rate of the force of the net on a support. */
static double support_rate(const hf_required *q, const hf_model *m, const hf_workspace *w, int node,
                           const hf_objectives_rate *by)
{
    double force[3] = {0}, force_rate[3] = {0}, u[3], pull_rate[3];
    for (int k = q->support_start[node]; k < q->support_start[node + 1]; k++) {
        int e = q->support_cable[k], sign = m->end_row[2 * e] == m->row_of_node[node] ? 1 : -1;
        hf_newton_matrix_direction(m, w->position_m, e, u);
        hf_newton_matrix_pull_rate(m, w->position_m, e, w->tension_N[e], by->tension_N[e], by->position_m, pull_rate);
        for (int c = 0; c < 3; c++) {
            force[c] += sign * w->tension_N[e] * u[c];
            force_rate[c] += sign * pull_rate[c];
        }
    }
    return hf_norm_rate(force, force_rate);
}

static double mass_rate(const hf_required *q, const hf_required_column *c, const hf_model *m, const hf_workspace *w,
                        const hf_objectives_rate *by)
{
    double sum = 0, u[3], relative[3];
    for (int i = 0; i < c->n_cable; i++) {
        int e = c->cable[i];
        double length = hf_newton_matrix_direction(m, w->position_m, e, u);
        double longer = hf_newton_matrix_length_rate(m, e, u, by->position_m, relative);
        double EA_N = q->scene->EA_N ? q->scene->EA_N[e] : 0, grow = EA_N > 0 ? 1 + w->tension_N[e] / EA_N : 1;
        double change = longer / grow - (EA_N > 0 ? length / (grow * grow) * by->tension_N[e] / EA_N : 0);
        sum += q->mass_kg_per_m[e] * change;
    }
    return sum;
}

/* Returns the rate of maximum over minimum tension. */
static double ratio_rate(const hf_required_column *c, const hf_workspace *w, const hf_objectives_rate *by)
{
    double low, high;
    double least_N = hf_required_extreme_N(c, w->tension_N, true, &low);
    double most_N = hf_required_extreme_N(c, w->tension_N, false, &high);
    return (by->tension_N[(int)high] - most_N / least_N * by->tension_N[(int)low]) / least_N;
}

static double surface_rate(constraints_room *r, int column, const double *move_m)
{
    size_t n = (size_t)r->cloud[column].n;
    const double *residual = r->residual + (size_t)column * r->n_point;
    hf_cloud_push(&r->cloud[column], move_m, r->residual_rate);
    double norm = sqrt(hf_dot(n, residual, residual));
    return norm > 0 ? hf_dot(n, residual, r->residual_rate) / norm : 0;
}

/* Returns the rate of a figure at a frequency, whose gradient is known, for a motion [3][n_node] by row. */
static double radio_rate(const constraints_room *r, int column, const double *move_m)
{
    const hf_model *m = r->c->model;
    const double *gradient = r->gradient + 3 * (size_t)column * (size_t)m->n_node;
    double sum = 0;
    for (int row = 0; row < m->n_node; row++)
        for (int d = 0; d < 3; d++)
            sum += gradient[3 * m->node_of_row[row] + d] * move_m[d * m->n_node + row];
    return sum;
}

/* Returns the rate of the figure of a column whose value belongs to `item`, from the rates `by` of the net. A surface
 * has been measured and linearised at this shape. */
static double figure_rate(constraints_room *r, int column, double item, const hf_workspace *w,
                          const hf_objectives_rate *by_design, const hf_objectives_rate *by)
{
    const hf_model *m = r->c->model;
    const hf_required_column *c = &r->c->required->column[column];
    switch (c->figure) {
    case HF_REQUIRED_PSI:
        return psi_rate(m, w, by->position_m);
    case HF_REQUIRED_SURFACE:
    case HF_REQUIRED_FACETS:
        return surface_rate(r, column, by->position_m);
    case HF_REQUIRED_GAIN_LOSS:
    case HF_REQUIRED_GAIN:
    case HF_REQUIRED_POINTING:
        return radio_rate(r, column, by->position_m);
    case HF_REQUIRED_TENSION:
    case HF_REQUIRED_SLACK: /* the tension of a slack cable stays 0, but that of the design shows the way out */
        return (w->tension_N[(int)item] > 0 ? by : by_design)->tension_N[(int)item];
    case HF_REQUIRED_RATIO:
        return ratio_rate(c, w, by);
    case HF_REQUIRED_DEFLECTION:
        for (int k = 0; k < m->n_attachment; k++)
            if (m->node_of_row[m->attachment_row[k]] == (int)item)
                return hf_norm_rate(w->displacement_m + 3 * (size_t)k, by->displacement_m + 3 * (size_t)k);
        return 0;
    case HF_REQUIRED_PULL:
        return support_rate(r->c->required, m, w, (int)item, by);
    case HF_REQUIRED_MASS:
        return mass_rate(r->c->required, c, m, w, by);
    case HF_REQUIRED_LOOSE:
    case HF_REQUIRED_N_FIGURE:
        break;
    }
    return 0;
}

/* ---- derivatives of all constraints ---- */

/* Prepares the cloud of a column for derivatives at this shape. Returns false if it has no best fit, and therefore no
 * derivatives. */
static bool linearise_cloud(constraints_room *r, int column, const hf_workspace *w)
{
    hf_cloud *cloud = &r->cloud[column];
    return hf_cloud_measure(cloud, w->position_m, r->residual + (size_t)column * r->n_point) == HF_OK &&
           hf_cloud_linearise(cloud) == HF_OK;
}

/* Prepares a column for derivatives at this shape. Returns false if it has none. */
static bool linearise_column(constraints_room *r, int column, const hf_workspace *w)
{
    const hf_required *q = r->c->required;
    const hf_required_net net = net_of(r, w);
    bool exists = true;
    if (is_of_surface(&q->column[column])) return linearise_cloud(r, column, w);
    if (q->column[column].antenna >= 0 &&
        hf_required_radio_gradient(q, &q->column[column], r->antenna, &net,
                                   r->gradient + 3 * (size_t)column * (size_t)r->c->model->n_node, &exists) != HF_OK) {
        r->status = HF_NO_MEMORY;
        return false;
    }
    return exists;
}

/* Lists the constraints that depend on this net and have derivatives. A sample counts only in the load case in which it
 * is worst. */
static int list_terms(constraints_room *r, int state, int i_sample, const hf_workspace *w)
{
    const hf_built_constraints *c = r->c;
    const hf_required *q = c->required;
    int n = 0;
    for (int k = 0; k < c->as.n; k++) {
        if (!is_about(c, k, state, i_sample >= 0)) continue;
        size_t at = place_of(c, k, i_sample < 0 ? 0 : i_sample);
        double weight = i_sample < 0 ? 1 : r->weight[at], item = -1;
        bool is_high = false;
        if (weight == 0) continue;
        if (i_sample >= 0 && r->worst_state[at] != state) continue;
        distance_of(r, k, w, &is_high, &item);
        weight *= scale_of(c, k, is_high);
        bool rises = is_high && q->row[c->row[k]].figure != HF_REQUIRED_SLACK;
        int column = is_high ? q->high[c->row[k]] : q->low[c->row[k]];
        if (!linearise_column(r, column, w)) continue;
        r->list[n++] = (term){k, column, item, rises ? weight : -weight};
    }
    return n;
}

/* Adds the rates of the listed constraints, at the design or, is_net, at the net linearised last. */
static hf_status add_rates(constraints_room *r, int n_term, const hf_workspace *w, bool is_net, int n_rate,
                           hf_constraints_spread *spread, const void *context, double *rate)
{
    const hf_built_constraints *c = r->c;
    const hf_model *m = c->model;
    hf_objectives_rate by[HF_OBJECTIVES_AT_ONCE], of_net[HF_OBJECTIVES_AT_ONCE];
    for (int first = 0; first < n_rate && n_term > 0; first += HF_OBJECTIVES_AT_ONCE) {
        int n = n_rate - first < HF_OBJECTIVES_AT_ONCE ? n_rate - first : HF_OBJECTIVES_AT_ONCE;
        for (int j = 0; j < n; j++) {
            double *move = r->move_m + 3 * (size_t)j * (size_t)m->n_node;
            double *tension = r->tension_rate + (size_t)j * (size_t)m->n_cable;
            by[j] = (hf_objectives_rate){move, tension, spread(context, first + j, move, tension)};
        }
        if (is_net) c->nets->as.follow(r->nets, n, by, of_net);
        for (int j = 0; j < n; j++)
            for (const term *t = r->list; t < r->list + n_term; t++)
                rate[(size_t)t->k * (size_t)n_rate + (size_t)(first + j)] +=
                    t->weight * figure_rate(r, t->column, t->item, w, &by[j], is_net ? &of_net[j] : &by[j]);
    }
    return r->status;
}

static bool has_weight(const constraints_room *r, int state, int i_sample)
{
    const hf_built_constraints *c = r->c;
    for (int k = 0; k < c->as.n; k++)
        if (is_about(c, k, state, i_sample >= 0) && (i_sample < 0 || r->weight[place_of(c, k, i_sample)] > 0))
            return true;
    return false;
}

static hf_status linearise_design(void *room, int n_rate, hf_constraints_spread *spread, const void *context,
                                  double *rate)
{
    constraints_room *r = room;
    const hf_built_constraints *c = r->c;
    const hf_objectives_nets *nets = c->nets ? &c->nets->as : NULL;
    const hf_workspace *shape;
    begin_net(r);
    int n_all = nets ? hf_objectives_nets_count(nets) : 0;
    memset(rate, 0, (size_t)c->as.n * (size_t)n_rate * sizeof *rate);
    int n = list_terms(r, 0, -1, r->design);
    HF_TRY(add_rates(r, n, r->design, false, n_rate, spread, context, rate));
    for (int i = 0; i < n_all; i++) {
        int i_sample, state = state_of_net(c, i, &i_sample);
        if (!has_weight(r, state, i_sample)) continue;
        hf_status status = nets->linearise(r->nets, i, &shape);
        if (status == HF_NO_MEMORY) return status;
        if (status != HF_OK) continue; /* a net without a shape has no derivatives */
        begin_net(r);
        n = list_terms(r, state, i_sample, shape);
        HF_TRY(add_rates(r, n, shape, true, n_rate, spread, context, rate));
    }
    return HF_OK;
}

/* ---- making ---- */

static void close_room(void *room)
{
    constraints_room *r = room;
    if (!r) return;
    if (r->c->nets) r->c->nets->as.close(r->nets);
    hf_arena_free(&r->arena);
    hf_arena_free_block(r->block);
}

/* Returns the number of points of the cloud of a column. */
static size_t count_points(const hf_built_constraints *c, int column)
{
    bool is_facets = c->required->column[column].figure == HF_REQUIRED_FACETS;
    return (size_t)(is_facets ? hf_cloud_facet_points(c->n_facet) : c->model->n_inner_node);
}

/* Lays out the clouds of the columns that measure a surface. */
static hf_status make_clouds(constraints_room *r)
{
    const hf_built_constraints *c = r->c;
    const hf_required *q = c->required;
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < q->n_column; k++) {
            bool is_facets = q->column[k].figure == HF_REQUIRED_FACETS;
            if (!is_of_surface(&q->column[k])) continue;
            r->cloud[k] = (hf_cloud){.kind = c->surface->kind,
                                     .focal_length_m = c->surface->focal_length_m,
                                     .along = HF_ALONG_HALF_PATH,
                                     .feed = q->column[k].feed,
                                     .n_node = c->model->n_node,
                                     .n = (int)count_points(c, k),
                                     .n_facet = is_facets ? c->n_facet : 0,
                                     .row = is_facets ? c->corner_row : c->model->inner_row};
            hf_cloud_lay_out(&r->arena, &r->cloud[k]);
        }
        if (pass == 0) HF_TRY(hf_arena_allocate(&r->arena));
    }
    return HF_OK;
}

static hf_status open_room(const hf_constraints *as, void **room)
{
    const hf_built_constraints *c = (const void *)as;
    const hf_model *m = c->model;
    size_t n = place_of(c, c->as.n, 0), n_sample = c->nets ? (size_t)c->nets->as.n_sample + 1 : 1;
    size_t n_column = (size_t)c->required->n_column, many = HF_OBJECTIVES_AT_ONCE;
    constraints_room r = {.c = c}, *kept;
    for (int k = 0; k < c->required->n_column; k++)
        if (is_of_surface(&c->required->column[k]) && r.n_point < count_points(c, k)) r.n_point = count_points(c, k);
    hf_status status = HF_ARENA_ARRAYS(
        &r.block, HF_ARRAY(kept, 1), HF_ARRAY(r.cloud, n_column), HF_ARRAY(r.residual, n_column * r.n_point),
        HF_ARRAY(r.residual_rate, r.n_point), HF_ARRAY(r.distance, n), HF_ARRAY(r.weight, n),
        HF_ARRAY(r.antenna, c->required->n_antenna), HF_ARRAY(r.radio, c->required->n_antenna),
        HF_ARRAY(r.has_radio, c->required->n_antenna),
        HF_ARRAY(r.gradient, c->needs_radio ? 3 * n_column * (size_t)m->n_node : 0), HF_ARRAY(r.worst_state, n),
        HF_ARRAY(r.order, n_sample), HF_ARRAY(r.list, c->as.n), HF_ARRAY(r.move_m, 3 * many * (size_t)m->n_node),
        HF_ARRAY(r.tension_rate, many * (size_t)m->n_cable));
    *room = kept;
    if (status != HF_OK) return status;
    *kept = r;
    HF_TRY(make_clouds(kept));
    return c->nets ? c->nets->as.open(&c->nets->as, &kept->nets) : HF_OK;
}

/* Writes a constraint as a limit on each cable or attachment. Returns false if it is none: it is about a load case or
 * samples, or its figure is not one of single cables or attachments. */
static bool write_limit(const hf_built_constraints *c, int k, hf_limit *to)
{
    const hf_required *q = c->required;
    const hf_requirement_settings *r = &q->row[c->row[k]];
    const hf_required_column *column = &q->column[c->is_high[k] ? q->high[c->row[k]] : q->low[c->row[k]]];
    double bound = c->is_high[k] ? r->at_most : r->at_least;
    *to = (hf_limit){.lower = -INFINITY, .upper = INFINITY, .n_cable = column->n_cable, .cable = column->cable};
    *(c->is_high[k] ? &to->upper : &to->lower) = bound;
    if (c->state[k] != 0) return false;
    if (r->figure == HF_REQUIRED_SLACK) {
        to->lower = HF_SLACK_RATIO * c->model->reference_N;
        to->upper = INFINITY;
        return bound < 1;
    }
    if (r->figure == HF_REQUIRED_RATIO) to->kind = HF_LIMIT_RATIO;
    if (r->figure == HF_REQUIRED_DEFLECTION) to->kind = HF_LIMIT_DEFLECTION;
    return r->figure == HF_REQUIRED_TENSION || (c->is_high[k] && to->kind != HF_LIMIT_TENSION);
}

/* Adds a constraint. It is only counted while there is no memory. */
static void add(hf_built_constraints *c, int i_row, int state, bool is_high)
{
    const hf_required *q = c->required;
    const hf_requirement_settings *r = &q->row[i_row];
    int k = c->as.n++, column = is_high ? q->high[i_row] : q->low[i_row];
    if (!c->row) return;
    c->row[k] = i_row;
    c->state[k] = state;
    c->is_high[k] = is_high;
    c->unit[k] = unit_of(&q->column[column], is_high ? r->at_most : r->at_least, c->model);
}

static void list(hf_built_constraints *c)
{
    const hf_required *q = c->required;
    c->as.n = 0;
    for (int i = 0; i < q->n; i++) {
        const hf_requirement_settings *r = &q->row[i];
        if (!is_judged(r)) continue;
        bool is_count = r->figure == HF_REQUIRED_SLACK; /* only its upper bound constrains */
        if (!isnan(r->share) && (q->high[i] >= 0 || !is_count)) add(c, i, -1, q->high[i] >= 0);
        for (int state = 0; state < q->n_state && isnan(r->share); state++)
            for (int is_high = is_count; is_high < 2; is_high++)
                if (q->states[i] >> state & 1u && (is_high ? q->high[i] : q->low[i]) >= 0) add(c, i, state, is_high);
    }
}

hf_status hf_built_constraints_make(const hf_required *q, const hf_model *m, const hf_built_nets *nets,
                                    const hf_surface_settings *surface, const hf_facets *facets,
                                    hf_built_constraints *c)
{
    *c = (hf_built_constraints){
        .as = {.open = open_room, .close = close_room, .measure = measure_design, .linearise = linearise_design},
        .required = q,
        .model = m,
        .nets = nets,
        .surface = surface,
        .facets = facets,
        .n_facet = facets ? facets->n_facet : 0};
    list(c);
    HF_TRY(HF_ARENA_ARRAYS(&c->block, HF_ARRAY(c->corner_row, 4 * (size_t)c->n_facet), HF_ARRAY(c->row, c->as.n),
                           HF_ARRAY(c->state, c->as.n), HF_ARRAY(c->is_high, c->as.n), HF_ARRAY(c->unit, c->as.n),
                           HF_ARRAY(c->limit, c->as.n), HF_ARRAY(c->as_limit, c->as.n)));
    list(c);
    for (int i = 0; i < 4 * c->n_facet; i++)
        c->corner_row[i] = m->row_of_node[facets->corner[i]];
    c->as.unit = c->unit;
    c->as.limit = c->as_limit;
    for (int k = 0; k < c->as.n; k++) {
        c->as_limit[k] = write_limit(c, k, &c->limit[k]) ? &c->limit[k] : NULL;
        double most_m = q->row[c->row[k]].at_most;
        bool is_psi = q->row[c->row[k]].figure == HF_REQUIRED_PSI && c->state[k] == 0 && c->is_high[k];
        if (is_psi && (c->as.psi_most_m == 0 || most_m < c->as.psi_most_m)) {
            c->as.psi_most_m = most_m;
            c->as.psi = k;
        }
        c->needs_surface |= hf_required_is_of(q->row[c->row[k]].figure, HF_REQUIRED_OF_SURFACE);
        c->needs_radio |= hf_required_is_of(q->row[c->row[k]].figure, HF_REQUIRED_OF_RADIO);
    }
    for (int state = 0; state < q->n_state; state++) {
        c->state_of_samples[state] = state == 0 ? 0 : -1;
        for (int s = 1; nets && s < nets->as.n_sample_state; s++)
            if (nets->as.sample_load_case[s] == state - 1) c->state_of_samples[state] = s;
    }
    return HF_OK;
}
