/* Implements required.h. Contents: columns, figures of a shape, error bounds, margins, verdicts. */
#include "built/required.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "built/required_radio.h"
#include "net/cable_pick.h"
#include "solve/newton_matrix.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- columns ---- */

/* Returns the bits of the load cases that a row selects. */
static unsigned states_of(const hf_required *q, const hf_requirement_settings *r)
{
    if (!strcmp(r->load_case, "all")) return (1u << q->n_state) - 1;
    int state = 0;
    while (state + 1 < q->n_state && strcmp(hf_required_state_name(q, state), r->load_case) != 0)
        state++;
    return 1u << state;
}

/* Returns the antenna of a row, and adds it if its frequency is new; -1 for a figure without a frequency. */
static int antenna_of(hf_required *q, const hf_requirement_settings *r)
{
    int k = 0;
    if (!hf_required_is_of(r->figure, HF_REQUIRED_OF_RADIO)) return -1;
    while (k < q->n_antenna && q->frequency_Hz[k] != r->frequency_Hz)
        k++;
    if (k == q->n_antenna) q->frequency_Hz[q->n_antenna++] = r->frequency_Hz;
    return k;
}

/* Returns the column that a bound of row r needs, and adds it if it is new. `cable` are the cables of its set. */
static int column_of(hf_required *q, const hf_requirement_settings *r, bool is_minimum, int n_cable, const int *cable,
                     unsigned states)
{
    hf_required_column c = {.figure = r->figure,
                            .antenna = antenna_of(q, r),
                            .frequency_Hz = r->frequency_Hz,
                            .is_minimum = is_minimum && r->figure == HF_REQUIRED_TENSION,
                            .feed = r->feed,
                            .set = r->set,
                            .n_cable = n_cable,
                            .cable = cable};
    int k = 0;
    for (; k < q->n_column; k++) {
        const hf_required_column *old = &q->column[k];
        if (old->figure == c.figure && old->antenna == c.antenna && old->is_minimum == c.is_minimum &&
            old->feed == c.feed && !strcmp(old->set, c.set)) /* by name, because data sets have it */
            break;
    }
    if (k == q->n_column) q->column[q->n_column++] = c;
    *(isnan(r->share) ? &q->column[k].nominal : &q->column[k].many) |= states;
    return k;
}

static bool needs_pull(int n, const hf_requirement_settings *row)
{
    bool needs = false;
    for (int i = 0; i < n; i++)
        needs |= row[i].figure == HF_REQUIRED_PULL;
    return needs;
}

/* Lists the cables of each support, so that the pull of a sample does not look at all cables for each support. */
static void list_supports(const hf_scene *s, hf_required *q)
{
    int n = 0;
    for (int i = 0; i < s->n_node; i++) {
        q->support_start[i] = n;
        for (int e = 0; e < s->n_cable && s->role[i] == HF_ROLE_SUPPORT; e++)
            if (s->end[2 * e] == i || s->end[2 * e + 1] == i) q->support_cable[n++] = e;
    }
    q->support_start[s->n_node] = n;
}

hf_status hf_required_create(int n, const hf_requirement_settings *row, const hf_scene *scene,
                             const hf_load_cases *load_cases, const double *mass_kg_per_m, hf_required *q)
{
    int *cable;
    *q = (hf_required){.n = n,
                       .row = row,
                       .n_state = 1 + load_cases->n,
                       .scene = scene,
                       .load_cases = load_cases,
                       .mass_kg_per_m = mass_kg_per_m};
    if (n == 0) return HF_OK;
    bool has_pull = needs_pull(n, row);
    HF_TRY(HF_ARENA_ARRAYS(&q->block, HF_ARRAY(cable, (size_t)n * (size_t)scene->n_cable),
                           HF_ARRAY(q->support_start, has_pull ? scene->n_node + 1 : 0),
                           HF_ARRAY(q->support_cable, has_pull ? 2 * scene->n_cable : 0)));
    if (has_pull) list_supports(scene, q);
    for (int i = 0; i < n; i++, cable += scene->n_cable) {
        const hf_requirement_settings *r = &row[i];
        int n_cable = hf_required_is_of(r->figure, HF_REQUIRED_OF_SET) ? hf_cable_pick(scene, r->set, cable) : 0;
        q->states[i] = states_of(q, r);
        q->low[i] = isnan(r->at_least) ? -1 : column_of(q, r, true, n_cable, cable, q->states[i]);
        q->high[i] = isnan(r->at_most) ? -1 : column_of(q, r, false, n_cable, cable, q->states[i]);
        *(isnan(r->share) ? &q->nominal : &q->many) |= q->states[i];
        if (!isnan(r->share)) q->share[q->n_share++] = i;
    }
    return HF_OK;
}

void hf_required_free(hf_required *q)
{
    for (int k = 0; k < q->n_antenna && q->antenna; k++)
        hf_antenna_free(&q->antenna[k]);
    hf_arena_free_block(q->antenna_block);
    hf_arena_free_block(q->block);
    *q = (hf_required){0};
}

const char *hf_required_state_name(const hf_required *q, int state)
{
    return state ? q->load_cases->load_case[state - 1].name : "nominal";
}

const char *hf_required_column_name(const hf_required_column *c, char name[HF_REQUIRED_NAME_SIZE])
{
    bool has_feed = hf_required_is_of(c->figure, HF_REQUIRED_OF_FEED);
    const char *extreme = c->figure != HF_REQUIRED_TENSION ? "" : c->is_minimum ? "_min" : "_max";
    int n = snprintf(name, HF_REQUIRED_NAME_SIZE, "%s%s%s%s%s%s", hf_required_figure_word[c->figure], extreme,
                     has_feed ? "_" : "", has_feed ? hf_focus_word[c->feed] : "", *c->set ? "_" : "", c->set);
    if (c->frequency_Hz > 0) snprintf(name + n, HF_REQUIRED_NAME_SIZE - (size_t)n, "_%.9gGHz", c->frequency_Hz / 1e9);
    return name;
}

static bool is_needed(const hf_required_column *c, bool is_many, int state)
{
    return (is_many ? c->many : c->nominal) >> state & 1u;
}

bool hf_required_needs_surface(const hf_required *q, bool is_many, int state)
{
    bool needs = false;
    for (int k = 0; k < q->n_column; k++)
        needs |=
            is_needed(&q->column[k], is_many, state) && hf_required_is_of(q->column[k].figure, HF_REQUIRED_OF_SURFACE);
    return needs;
}

/* ---- figures of a shape ---- */

double hf_required_extreme_N(const hf_required_column *c, const double *all_N, bool is_minimum, double *item)
{
    double worst_N = is_minimum ? INFINITY : -INFINITY;
    for (int i = 0; i < c->n_cable; i++) {
        double tension_N = all_N[c->cable[i]];
        if (is_minimum ? tension_N >= worst_N : tension_N <= worst_N) continue;
        worst_N = tension_N;
        *item = c->cable[i];
    }
    return worst_N;
}

/* As hf_metrics_is_slack: a strut has a negative tension and is not slack. */
static bool is_slack(const hf_required_shape *s, int e)
{
    return fabs(s->tension_N[e]) < HF_SLACK_RATIO * s->model->reference_N;
}

static double count_slack(const hf_required_column *c, const hf_required_shape *s, double *item)
{
    int n = 0;
    for (int i = 0; i < c->n_cable; i++)
        if (is_slack(s, c->cable[i]) && n++ == 0) *item = c->cable[i];
    return n;
}

/* Returns the ratio of maximum to minimum tension, INFINITY with a slack cable, NaN with a strut. *item is the cable of
 * the minimum. */
static double ratio_of(const hf_required_column *c, const hf_required_shape *s, double *item)
{
    double at_most, least_N = hf_required_extreme_N(c, s->tension_N, true, item),
                    most_N = hf_required_extreme_N(c, s->tension_N, false, &at_most);
    if (least_N < 0 && !is_slack(s, (int)*item)) return (double)NAN;
    return is_slack(s, (int)*item) ? (double)INFINITY : most_N / least_N;
}

/* Returns the maximum displacement of an attachment by the forces of the net, m. *item is its node. */
static double deflection_m(const hf_required_shape *s, double *item)
{
    const hf_model *m = s->model;
    const double *d = s->displacement_m;
    double most_m = -1;
    for (int k = 0; k < m->n_attachment; k++, d += 3) {
        double size_m = hf_norm(d[0], d[1], d[2]);
        if (size_m <= most_m) continue;
        most_m = size_m;
        *item = m->node_of_row[m->attachment_row[k]];
    }
    return most_m < 0 ? (double)NAN : most_m;
}

/* Returns the maximum force of the net on a support, N. *item is its node. */
static double pull_N(const hf_required *q, const hf_required_shape *s, double *item)
{
    const hf_model *m = s->model;
    double most_N = -1;
    for (int row = m->n_free; row < m->n_node; row++) {
        double force[3] = {0}, unit[3];
        const int *start = q->support_start + m->node_of_row[row];
        for (int k = start[0]; k < start[1]; k++) {
            int e = q->support_cable[k], end = m->end_row[2 * e] == row ? 0 : 1;
            hf_newton_matrix_direction(m, s->position_m, e, unit);
            for (int c = 0; c < 3; c++)
                force[c] += (end ? -1 : 1) * s->tension_N[e] * unit[c];
        }
        double size_N = hf_norm(force[0], force[1], force[2]);
        if (size_N <= most_N) continue;
        most_N = size_N;
        *item = m->node_of_row[row];
    }
    return most_N < 0 ? (double)NAN : most_N;
}

static double mass_kg(const hf_required *q, const hf_required_column *c, const hf_required_shape *s)
{
    const hf_model *m = s->model;
    double sum = 0, unit[3];
    for (int i = 0; i < c->n_cable; i++) {
        int e = c->cable[i];
        double length_m = hf_newton_matrix_direction(m, s->position_m, e, unit),
               EA_N = q->scene->EA_N ? q->scene->EA_N[e] : 0;
        sum += q->mass_kg_per_m[e] * (EA_N > 0 ? length_m / (1 + s->tension_N[e] / EA_N) : length_m);
    }
    return sum;
}

double hf_required_figure_of(const hf_required *q, const hf_required_column *c, const hf_required_shape *s,
                             double *item)
{
    const hf_surface_paths *p = &s->paths;
    switch (c->figure) { /* no default label, so that the compiler reports a figure that is missing */
    case HF_REQUIRED_PSI:
        return hf_metrics_psi_of_m(s->model, s->position_m, s->loose);
    case HF_REQUIRED_SURFACE:
        return c->feed == HF_FIXED ? p->nodes_m : p->nodes_fit_m;
    case HF_REQUIRED_FACETS:
        return c->feed == HF_FIXED ? p->facets_m : p->facets_fit_m;
    case HF_REQUIRED_GAIN_LOSS:
    case HF_REQUIRED_GAIN:
    case HF_REQUIRED_POINTING:
        return hf_required_radio_of(c, s->radio);
    case HF_REQUIRED_TENSION:
        return hf_required_extreme_N(c, s->tension_N, c->is_minimum, item);
    case HF_REQUIRED_RATIO:
        return ratio_of(c, s, item);
    case HF_REQUIRED_SLACK:
        return count_slack(c, s, item);
    case HF_REQUIRED_LOOSE:
        return s->n_loose;
    case HF_REQUIRED_DEFLECTION:
        return deflection_m(s, item);
    case HF_REQUIRED_PULL:
        return pull_N(q, s, item);
    case HF_REQUIRED_MASS:
        return mass_kg(q, c, s);
    case HF_REQUIRED_N_FIGURE:
        break;
    }
    return (double)NAN;
}

void hf_required_measure(const hf_required *q, bool is_many, int state, const hf_required_shape *s, double *value,
                         double *item)
{
    for (int k = 0; k < q->n_column; k++) {
        item[k] = -1;
        value[k] = is_needed(&q->column[k], is_many, state) ? hf_required_figure_of(q, &q->column[k], s, &item[k])
                                                            : (double)NAN;
    }
}

/* ---- error bounds ---- */

/* Returns a bound on the error of the tension of cable e. Two ends that are off by bound_m each change its length by at
 * most twice as much. The tension of a cable of law length follows from the shape in no such simple way. A search and a
 * load case change the target values of the model, so the cable has those of the workspace. */
static double tension_error_N(const hf_model *m, const hf_required_shape *s, int e, double bound_m)
{
    double off_m = 2 * bound_m, unit[3];
    hf_law_cable cable = hf_workspace_cable(m, s->work, e);
    switch (cable.law) {
    case HF_LAW_TENSION:
        return fabs(s->tension_N[e] - cable.target);
    case HF_LAW_FORCE_DENSITY:
        return fabs(s->tension_N[e] - cable.target * hf_newton_matrix_direction(m, s->position_m, e, unit)) +
               fabs(cable.target) * off_m;
    case HF_LAW_ELASTIC:
        return cable.EA_N / cable.target * off_m;
    default:
        return (double)NAN;
    }
}

/* Returns the maximum bound over the cables of a set, NaN if one has none. */
static double set_error_N(const hf_required_column *c, const hf_required_shape *s, double bound_m)
{
    double most_N = 0;
    for (int i = 0; i < c->n_cable; i++) {
        double error_N = tension_error_N(s->model, s, c->cable[i], bound_m);
        if (!(error_N <= most_N)) most_N = error_N;
        if (isnan(most_N)) break;
    }
    return most_N;
}

/* Returns the number of cables of which the error of the tension decides whether they are slack, NaN if one has no
 * bound. */
static double count_doubtful(const hf_required_column *c, const hf_required_shape *s, double bound_m)
{
    int n = 0;
    for (int i = 0; i < c->n_cable; i++) {
        double error_N = tension_error_N(s->model, s, c->cable[i], bound_m);
        if (isnan(error_N)) return error_N;
        n += fabs(fabs(s->tension_N[c->cable[i]]) - HF_SLACK_RATIO * s->model->reference_N) < error_N;
    }
    return n;
}

/* Bounds the error of the force on support `row`. Besides its tension, the direction of a cable may be off. NaN if a
 * tension has no bound. */
static double pull_error_N(const hf_required *q, const hf_required_shape *s, int row, double bound_m)
{
    const hf_model *m = s->model;
    const int *start = q->support_start + m->node_of_row[row];
    double sum_N = 0, unit[3];
    for (int k = start[0]; k < start[1]; k++) {
        int e = q->support_cable[k];
        sum_N += tension_error_N(m, s, e, bound_m) +
                 2 * bound_m * fabs(s->tension_N[e]) / hf_newton_matrix_direction(m, s->position_m, e, unit);
    }
    return sum_N;
}

/* Bounds the error of the mass. The length of a cable may be off, and the tension by which it is longer than
 * unstressed. */
static double mass_error_kg(const hf_required *q, const hf_required_column *c, const hf_required_shape *s,
                            double bound_m)
{
    double sum_kg = 0, unit[3];
    for (int i = 0; i < c->n_cable; i++) {
        int e = c->cable[i];
        double EA_N = q->scene->EA_N ? q->scene->EA_N[e] : 0, off_m = 2 * bound_m;
        if (EA_N > 0)
            off_m += hf_newton_matrix_direction(s->model, s->position_m, e, unit) *
                     tension_error_N(s->model, s, e, bound_m) / EA_N;
        sum_kg += off_m * q->mass_kg_per_m[e];
    }
    return sum_kg;
}

static double error_of(const hf_required *q, const hf_required_column *c, const hf_required_shape *s, double bound_m,
                       double psi_bound_m, double value)
{
    const hf_model *m = s->model;
    double error_N, least_N, most_N, at;
    switch (c->figure) {
    case HF_REQUIRED_PSI:
        return psi_bound_m;
    case HF_REQUIRED_SURFACE: /* an RMS is a norm, which changes by at most the norm of the change; a fit lowers it */
    case HF_REQUIRED_FACETS:
    case HF_REQUIRED_DEFLECTION:
        return bound_m;
    case HF_REQUIRED_GAIN_LOSS:
    case HF_REQUIRED_GAIN:
    case HF_REQUIRED_POINTING:
        return hf_required_radio_of(c, s->radio_error);
    case HF_REQUIRED_TENSION:
        return set_error_N(c, s, bound_m);
    case HF_REQUIRED_RATIO:
        error_N = set_error_N(c, s, bound_m);
        least_N = hf_required_extreme_N(c, s->tension_N, true, &at);
        return error_N < least_N ? (value + 1) * error_N / (least_N - error_N) : (double)NAN;
    case HF_REQUIRED_SLACK: /* a cable whose tension is within its error of the limit may count or not */
        return count_doubtful(c, s, bound_m);
    case HF_REQUIRED_LOOSE:
        return 0;
    case HF_REQUIRED_PULL:
        most_N = 0;
        for (int row = m->n_free; row < m->n_node && !isnan(most_N); row++) {
            error_N = pull_error_N(q, s, row, bound_m);
            if (!(error_N <= most_N)) most_N = error_N;
        }
        return most_N;
    case HF_REQUIRED_MASS:
        return mass_error_kg(q, c, s, bound_m);
    case HF_REQUIRED_N_FIGURE:
        break;
    }
    return (double)NAN;
}

void hf_required_bound_errors(const hf_required *q, int state, const hf_required_shape *s, double bound_m,
                              double psi_bound_m, const double *value, double *error)
{
    for (int k = 0; k < q->n_column; k++)
        error[k] = is_needed(&q->column[k], false, state)
                       ? error_of(q, &q->column[k], s, bound_m, psi_bound_m, value[k])
                       : (double)NAN;
}

/* ---- margins ---- */

/* Returns the margin of a value at one bound of a row. A value that does not exist is infinitely far outside. */
static double margin_of(const hf_requirement_settings *r, bool is_high, double value)
{
    double margin = is_high ? r->at_most - value : value - r->at_least;
    return isnan(margin) ? -(double)INFINITY : margin;
}

bool hf_required_has_two_bounds(const hf_requirement_settings *r)
{
    return isfinite(r->at_least * r->at_most) && r->at_least * r->at_most != 0;
}

double hf_required_distance(const hf_requirement_settings *r, bool is_high, double value)
{
    double bound = is_high ? r->at_most : r->at_least;
    return margin_of(r, is_high, value) / (hf_required_has_two_bounds(r) ? fabs(bound) : 1);
}

double hf_required_margin(const hf_required *q, int i, const double *value, size_t stride, int *state, int *column)
{
    const hf_requirement_settings *r = &q->row[i];
    double least = INFINITY;
    for (int k = 0; k < q->n_state; k++)
        for (int is_high = 0; is_high < 2; is_high++) {
            int at = is_high ? q->high[i] : q->low[i];
            if (at < 0 || !(q->states[i] >> k & 1u)) continue;
            double margin = hf_required_distance(r, is_high, value[(size_t)k * stride + (size_t)at]);
            if (margin >= least && !(isinf(least) && least > 0)) continue;
            least = margin;
            *state = k;
            *column = at;
        }
    return least;
}

/* ---- verdicts ---- */

/* Returns the id of the cable or support that `item` of a column stands for, "" for none. The item of a net without a
 * shape is NaN. */
static const char *id_of(const hf_required *q, int column, double item)
{
    if (!(item >= 0)) return "";
    return hf_required_is_of(q->column[column].figure, HF_REQUIRED_OF_SET) ? q->scene->cable_id[(int)item]
                                                                           : q->scene->node_id[(int)item];
}

void hf_required_note(const hf_required *q, int i, bool is_worst, const double *value, const double *item,
                      size_t stride, hf_requirement_verdict *to)
{
    const hf_requirement_settings *r = &q->row[i];
    int state = 0, column = 0;
    hf_required_margin(q, i, value, stride, &state, &column);
    size_t at = (size_t)state * stride + (size_t)column;
    bool is_high = q->high[i] == column && (q->low[i] != column || !(hf_required_distance(r, false, value[at]) <
                                                                     hf_required_distance(r, true, value[at])));
    double margin = margin_of(r, is_high, value[at]);
    if (is_worst) {
        to->worst_margin = margin;
        to->worst_value = value[at];
        snprintf(to->worst_load_case, sizeof to->worst_load_case, "%s", hf_required_state_name(q, state));
        snprintf(to->worst_item, sizeof to->worst_item, "%s", id_of(q, column, item[at]));
        return;
    }
    to->value = value[at];
    to->bound = is_high ? r->at_most : r->at_least;
    to->margin = margin;
    to->relative_margin = to->bound != 0 ? margin / fabs(to->bound) : (double)NAN;
}

/* Judges by all load cases, because the error bound of one with a larger margin may be larger. */
void hf_required_judge_nominal(const hf_required *q, int i, const double *value, const double *item,
                               const double *error, hf_requirement_verdict *to)
{
    const hf_requirement_settings *r = &q->row[i];
    size_t n = (size_t)q->n_column;
    int state = 0, column = 0;
    bool fails = false, is_close = false;
    hf_required_note(q, i, false, value, item, n, to);
    hf_required_note(q, i, true, value, item, n, to);
    hf_required_margin(q, i, value, n, &state, &column);
    to->error_bound = error[(size_t)state * n + (size_t)column];
    for (int k = 0; k < q->n_state; k++)
        for (int is_high = 0; is_high < 2; is_high++) {
            int c = is_high ? q->high[i] : q->low[i];
            if (c < 0 || !(q->states[i] >> k & 1u)) continue;
            size_t at = (size_t)k * n + (size_t)c;
            double margin = margin_of(r, is_high, value[at]);
            double off = isnan(error[at]) ? 0 : error[at];
            fails |= !(margin >= -off);
            is_close |= off > 0 && margin < off;
        }
    to->verdict = fails ? HF_VERDICT_FAIL : is_close ? HF_VERDICT_UNDECIDED : HF_VERDICT_PASS;
}
