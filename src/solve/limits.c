/* Checks a shape against the limits of designs: the rows of optimize.limits and the cap on the boundary tension ratio.
 *
 *     settings -> rows with their cables
 *     rows, shape -> violation: 0, or by how much the shape is beyond the limits, by which designs are ranked
 *     rows, shape -> the limits that the shape reaches or breaks, for messages and results */
#include "solve/limits.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "base/text.h"
#include "net/cable_pick.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- from the rows ---- */

/* Reads a row. `cable` receives its cables. */
static hf_status read_row(const hf_scene *scene, const hf_model *m, const hf_limit_settings *s, int row, int *cable,
                          hf_limit *to, hf_messages *messages)
{
    char where[HF_LOCATION_SIZE];
    to->kind = s->figure;
    to->lower = s->lower;
    to->upper = s->upper;
    if (s->figure == HF_LIMIT_DEFLECTION) {
        if (m->n_attachment > 0) return HF_OK;
        return hf_error(
            messages, HF_BAD_CASE,
            "%s: a deflection limit needs a truss, because this limit applies to the attachments of a truss",
            hf_messages_location(messages, where, "optimize.limits.%d.figure", row));
    }
    hf_messages_location(messages, where, "optimize.limits.%d.set", row);
    to->cable = cable;
    to->n_cable = hf_cable_pick_some(scene, s->set, where, cable, messages);
    return to->n_cable ? HF_OK : HF_BAD_CASE;
}

hf_status hf_limits_create(const hf_scene *scene, const hf_model *m, const hf_optimize_settings *s, hf_limits *l,
                           hf_messages *messages)
{
    int *cable;
    *l = (hf_limits){0};
    if (s->n_limit == 0) return HF_OK;
    if (HF_ARENA_ARRAYS(&l->block, HF_ARRAY(l->row, s->n_limit),
                        HF_ARRAY(cable, (size_t)s->n_limit * (size_t)m->n_cable)) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "optimize.limits: out of memory");
    l->n = s->n_limit;
    hf_status status = HF_OK;
    for (int i = 0; i < l->n; i++) { /* reports all faults */
        int *of_row = cable + (size_t)i * (size_t)m->n_cable;
        if (read_row(scene, m, &s->limit[i], i, of_row, &l->row[i], messages) != HF_OK) status = HF_BAD_CASE;
    }
    return status;
}

/* ---- violations ---- */

/* Returns the sum over the cables of 1 - T/t below t and 1 - cap t/T above cap t, where t^2 = min T max T / cap. The
 * sum counts every cable, so it falls even if several cables share the maximum or minimum tension and no single one
 * changes the ratio. In t, a minimum tension below slack_N counts as slack_N. */
static double ratio_violation(const hf_model *m, int n, const int *cable, const double *tension_N, double cap)
{
    double low = INFINITY, high = 0, sum = 0, slack_N = HF_SLACK_RATIO * m->reference_N;
    for (int i = 0; i < n; i++) {
        low = fmin(low, tension_N[cable[i]]);
        high = fmax(high, tension_N[cable[i]]);
    }
    if (low >= slack_N && high <= cap * low) return 0;
    double least = sqrt(fmax(low, slack_N) * high / cap), most = cap * least;
    for (int i = 0; i < n; i++) {
        double tension = tension_N[cable[i]];
        if (tension < least) sum += 1 - tension / least;
        if (tension > most) sum += 1 - most / tension;
    }
    return sum > 0 ? sum : 1 - low / slack_N; /* a slack cable, but a cap so large that no tension is below t */
}

#define LIMIT_ROUNDING 1e-9 /* a violation below this part of its unit is rounding */

/* Returns by how much a value is outside of its bounds, divided by `unit`; 0 within rounding. */
static double outside(double lower, double upper, double value, double unit)
{
    double beyond = fmax(lower - value, value - upper) / unit;
    return beyond > LIMIT_ROUNDING ? beyond : 0;
}

double hf_limits_tension_violation(const hf_model *m, double tension_N, double lower, double upper)
{
    return outside(lower, upper, tension_N, m->reference_N);
}

/* Returns the number of values of a row that limits tensions or displacements. */
static int n_value(const hf_limit *row, const hf_model *m)
{
    return row->kind == HF_LIMIT_TENSION ? row->n_cable : m->n_attachment;
}

static double value_of(const hf_limit *row, const hf_workspace *w, int i)
{
    if (row->kind == HF_LIMIT_TENSION) return w->tension_N[row->cable[i]];
    const double *d = w->displacement_m + 3 * (ptrdiff_t)i;
    return hf_norm(d[0], d[1], d[2]);
}

static double row_violation(const hf_limit *row, const hf_model *m, const hf_workspace *w)
{
    double sum = 0, unit = row->kind == HF_LIMIT_TENSION ? m->reference_N : row->upper;
    if (row->kind == HF_LIMIT_RATIO) return ratio_violation(m, row->n_cable, row->cable, w->tension_N, row->upper);
    for (int i = 0; i < n_value(row, m); i++)
        sum += outside(row->lower, row->upper, value_of(row, w, i), unit);
    return sum;
}

double hf_limits_violation(const hf_evaluator *v, const hf_workspace *w)
{
    const hf_model *m = v->model;
    double sum = 0, cap = v->boundary_ratio_cap;
    for (int i = 0; v->limits && i < v->limits->n; i++)
        sum += row_violation(&v->limits->row[i], m, w);
    if (isfinite(cap) && hf_metrics_set_ratio(m, w, m->n_boundary, m->boundary_cable) > cap)
        sum += ratio_violation(m, m->n_boundary, m->boundary_cable, w->tension_N, cap);
    return sum;
}

/* ---- limits that a shape reaches ---- */

/* Returns by how much a value is beyond its bound, relative to the bound, or to `unit` if the bound is 0. sign is 1 for
 * an upper bound and -1 for a lower one. A value within the bound gives a negative result. */
static double beyond(double value, double bound, double sign, double unit)
{
    double size = fabs(bound) > 0 ? fabs(bound) : unit;
    return isfinite(bound) ? sign * (value - bound) / size : -INFINITY;
}

/* Counts a value at or beyond its bound, and keeps the one with the maximum excess. */
static void count(hf_limit_held *h, int cable, int attachment, double value, double bound, double excess)
{
    if (!(excess >= -HF_LIMITS_AT)) return;
    if (h->n++ > 0 && !(excess > h->beyond)) return;
    *h = (hf_limit_held){h->row, h->n, cable, -1, attachment, value, bound, excess};
}

static void count_ratio(const hf_model *m, const hf_workspace *w, int n, const int *cable, double cap, hf_limit_held *h)
{
    int low = -1, high = -1;
    double ratio = hf_metrics_set_ratio(m, w, n, cable);
    for (int i = 0; i < n; i++) {
        if (low < 0 || w->tension_N[cable[i]] < w->tension_N[low]) low = cable[i];
        if (high < 0 || w->tension_N[cable[i]] > w->tension_N[high]) high = cable[i];
    }
    count(h, high, -1, ratio, cap, beyond(ratio, cap, 1, 1));
    h->other = low;
}

/* Ratios and displacements are not below zero, so they have no lower side. */
static void count_row(const hf_limit *row, const hf_model *m, const hf_workspace *w, double sign, hf_limit_held *h)
{
    bool is_tension = row->kind == HF_LIMIT_TENSION;
    double bound = sign > 0 ? row->upper : row->lower;
    if (!is_tension && sign < 0) return;
    if (row->kind == HF_LIMIT_RATIO) {
        count_ratio(m, w, row->n_cable, row->cable, bound, h);
        return;
    }
    for (int i = 0; i < n_value(row, m); i++) {
        double value = value_of(row, w, i), excess = beyond(value, bound, sign, is_tension ? m->reference_N : 1);
        count(h, is_tension ? row->cable[i] : -1, is_tension ? -1 : i, value, bound, excess);
    }
}

int hf_limits_held(const hf_evaluator *v, const hf_workspace *w, hf_limit_held held[HF_LIMITS_HELD])
{
    const hf_model *m = v->model;
    int n = 0;
    hf_limit_held cap = {.row = HF_LIMITS_CAP};
    if (isfinite(v->boundary_ratio_cap))
        count_ratio(m, w, m->n_boundary, m->boundary_cable, v->boundary_ratio_cap, &cap);
    if (cap.n > 0) held[n++] = cap;
    for (int i = 0; v->limits && i < 2 * v->limits->n; i++) {
        hf_limit_held one = {.row = i / 2};
        count_row(&v->limits->row[i / 2], m, w, i % 2 ? 1 : -1, &one);
        if (one.n > 0) held[n++] = one;
    }
    return n;
}

const char *hf_limits_name(const hf_scene *scene, const hf_model *m, const hf_limit_held *h, char *text, size_t size)
{
    if (h->attachment >= 0)
        snprintf(text, size, "deflection of node %s", scene->node_id[m->node_of_row[m->attachment_row[h->attachment]]]);
    else if (h->other >= 0)
        snprintf(text, size, "ratio of cable %s to %s", scene->cable_id[h->cable], scene->cable_id[h->other]);
    else
        snprintf(text, size, "tension of cable %s", scene->cable_id[h->cable]);
    hf_text_trim_utf8(text);
    return text;
}

const char *hf_limits_name_broken(const hf_evaluator *e, const hf_scene *scene, const hf_workspace *w, char *text,
                                  size_t size)
{
    hf_limit_held held[HF_LIMITS_HELD];
    char limit[32] = "boundary_ratio_cap";
    int worst = -1, n = hf_limits_held(e, w, held);
    for (int i = 0; i < n; i++)
        if (held[i].beyond > (worst < 0 ? HF_LIMITS_AT : held[worst].beyond)) worst = i;
    *text = '\0';
    if (worst < 0) return text;
    const hf_limit_held *h = &held[worst];
    if (h->row != HF_LIMITS_CAP) snprintf(limit, sizeof limit, "optimize.limits.%d", h->row);
    snprintf(text, size, ": ");
    hf_limits_name(scene, e->model, h, text + 2, size - 2);
    size_t used = strlen(text);
    snprintf(text + used, size - used, " is %.6g, but the bound of %s is %g", h->value, limit, h->bound);
    return text;
}
