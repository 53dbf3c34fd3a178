/* Keeps a step of Levenberg-Marquardt within limits other than the bounds of its variables. watch.h describes the
 * interface.
 *
 *     hf_watch_create      cap, rows of optimize.limits, bounds of tensions, objectives -> items
 *     hf_watch_linearise   shape -> value and rate of each item
 *     hf_watch_worst       step x -> predicted values -> the limit that is violated most, for the quadratic programme
 *     hf_watch_learn       shape at the end of the step -> what each item is beyond the linear model (`bend`)
 *
 * Contents: items - shapes - a step */
#include "search/watch.h"

#include "base/elementary.h"
#include "base/lane.h"
#include "solve/limits.h"

#include <math.h>
#include <string.h>

/* ---- items ---- */

/* An item without an index and without a limit. */
static const hf_watched no_item = {-1, -1, -1, -1, -1, -1, .lower = -INFINITY, .upper = INFINITY};

/* Adds an item. It is only counted while there is no memory. */
static void add(hf_watch *q, hf_watched item)
{
    if (q->item) q->item[q->n] = item;
    q->n++;
}

/* Adds n copies of an item in which *index, one of its members, is the entry of `list`, or without a list the number of
 * the copy. */
static void add_each(hf_watch *q, hf_watched *item, int *index, int n, const int *list)
{
    for (int i = 0; i < n; i++) {
        *index = list ? list[i] : i;
        add(q, *item);
    }
}

/* Adds a cap on a ratio, and returns its index. */
static int add_cap(hf_watch *q, double cap)
{
    if (q->cap) q->cap[q->n_cap] = cap;
    return q->n_cap++;
}

/* Adds the items of a row of optimize.limits. */
static void add_row(const hf_evaluator *v, const hf_limit *row, hf_watch *q)
{
    hf_watched item = no_item;
    item.kind = HF_WATCH_ROW;
    if (row->kind == HF_LIMIT_RATIO)
        item.ratio = add_cap(q, row->upper);
    else
        item.upper = row->upper;
    /* A deflection has no lower bound: its derivative vanishes at 0, and no size is below 0. */
    if (row->kind == HF_LIMIT_TENSION) item.lower = row->lower;
    if (row->kind == HF_LIMIT_DEFLECTION)
        add_each(q, &item, &item.attachment, v->model->n_attachment, NULL);
    else
        add_each(q, &item, &item.cable, row->n_cable, row->cable);
}

/* Adds the items of objective k: those of its limit or, if it is minimised and has corners, those of its level. */
static void add_objective(const hf_evaluator *v, const hf_watch_front *front, int k, hf_watch *q)
{
    const hf_objective *g = &v->objectives->objective[k];
    const hf_model *m = v->model;
    bool is_least = k == front->least, is_ratio = g->settings.figure == HF_FIGURE_RATIO;
    double most = is_least ? INFINITY : front->most[k];
    bool has_corners = hf_objectives_is_maximum(g->settings.figure);
    if (is_least ? !has_corners : !isfinite(most)) return;
    hf_watched item = no_item;
    item.objective = k;
    item.kind = is_least ? HF_WATCH_LEVEL : HF_WATCH_OBJECTIVE;
    if (is_ratio)
        item.ratio = add_cap(q, most);
    else
        item.upper = most;
    if (is_ratio) add_each(q, &item, &item.cable, g->n_cable, g->cable);
    if (g->settings.figure == HF_FIGURE_PULL) add_each(q, &item, &item.support, m->n_node - m->n_free, NULL);
    if (g->settings.figure == HF_FIGURE_DEFLECTION) add_each(q, &item, &item.attachment, m->n_attachment, NULL);
    if (!has_corners) add(q, item);
}

/* Lists all items. They are only counted while there is no memory. */
static void list(const hf_evaluator *v, const hf_sensitivity *s, const double *lower, const double *upper, hf_watch *q)
{
    const hf_model *m = v->model;
    q->n = q->n_cap = 0;
    q->has_cap = isfinite(v->boundary_ratio_cap);
    int cap = q->has_cap ? add_cap(q, v->boundary_ratio_cap) : -1;
    for (int e = 0; e < m->n_cable; e++) {
        int variable = s->variable_of_cable[e];
        bool is_in_ratio = cap >= 0 && m->group[e] == HF_GROUP_BOUNDARY;
        if (variable >= 0 && (m->links_tensions || hf_evaluate_sets(v, variable) != HF_SETS_TENSION)) variable = -1;
        if (variable < 0 && !is_in_ratio) continue;
        hf_watched item = no_item;
        item.cable = e;
        item.kind = HF_WATCH_BOUND;
        if (is_in_ratio) item.ratio = cap;
        if (variable >= 0) item.lower = lower[variable], item.upper = upper[variable];
        add(q, item);
    }
    for (int i = 0; v->limits && i < v->limits->n; i++)
        add_row(v, &v->limits->row[i], q);
    const hf_constraints *constraints = v->objectives ? v->objectives->constraints : NULL;
    for (int k = 0; constraints && k < constraints->n; k++) {
        hf_watched item = no_item;
        if (!hf_objectives_judges(v->objectives, k)) continue;
        if (constraints->limit && constraints->limit[k]) {
            add_row(v, constraints->limit[k], q);
            continue;
        }
        item.constraint = k;
        item.kind = HF_WATCH_ROW;
        item.upper = 0;
        add(q, item);
    }
    q->n_cap_of_limits = q->n_cap;
    for (int k = 0; q->front && k < v->objectives->n_objective; k++)
        add_objective(v, q->front, k, q);
}

hf_status hf_watch_create(const hf_evaluator *v, const hf_sensitivity *s, const double *lower, const double *upper,
                          const hf_watch_front *front, hf_watch *to)
{
    const hf_model *m = v->model;
    size_t n_column = 1 + (size_t)s->n;
    *to = (hf_watch){.v = v, .n_class = s->n, .front = front};
    list(v, s, lower, upper, to);
    to->ld = (to->n + HF_LANES - 1) / HF_LANES * HF_LANES;
    HF_TRY(HF_ARENA_ARRAYS(&to->block, HF_WATCH_FIELDS(HF_ARENA_ITEM)));
    list(v, s, lower, upper, to);
    return HF_OK;
}

bool hf_watch_breaks(const hf_watch_front *front, const hf_objectives *objectives, double part, const double *objective)
{
    for (int k = 0; front && k < objectives->n_objective; k++)
        if (k != front->least && objective[k] > (1 + part) * front->most[k]) return true;
    return false;
}

/* ---- shapes ---- */

/* Measures the items at the shape in the workspace. */
static void look(hf_watch *q, const hf_workspace *w)
{
    if (q->front) hf_objectives_pulls(q->v->model, w, q->point);
    for (int i = 0; i < q->n; i++) {
        hf_watched *t = &q->item[i];
        const double *d = w->displacement_m + 3 * (ptrdiff_t)(t->attachment < 0 ? 0 : t->attachment);
        if (t->constraint >= 0)
            t->now = q->constraint[t->constraint];
        else if (t->cable >= 0)
            t->now = w->tension_N[t->cable];
        else if (t->attachment >= 0)
            t->now = hf_norm(d[0], d[1], d[2]);
        else
            t->now = t->support >= 0 ? q->point->size[t->support] : q->objective[t->objective];
    }
}

/* Returns the ratio of maximum to minimum of the values that belong to cap k, or INFINITY if the minimum is not above
 * 0. */
static double ratio_of(const hf_watch *q, int k)
{
    double least = INFINITY, largest = -INFINITY;
    for (int i = 0; i < q->n; i++) {
        if (q->item[i].ratio != k) continue;
        least = fmin(least, q->item[i].now);
        largest = fmax(largest, q->item[i].now);
    }
    return least > 0 ? largest / least : (double)INFINITY;
}

bool hf_watch_breaks_cap(const hf_watch *q)
{
    return q->has_cap && ratio_of(q, 0) > q->cap[0];
}

bool hf_watch_keeps(hf_watch *q, const hf_workspace *w)
{
    look(q, w);
    for (int k = 0; k < q->n_cap; k++)
        if (ratio_of(q, k) > q->cap[k]) return false;
    for (int i = 0; i < q->n; i++)
        if (q->item[i].now < q->item[i].lower || q->item[i].now > q->item[i].upper) return false;
    return true;
}

double hf_watch_violation(hf_watch *q, const hf_workspace *w)
{
    const hf_objectives *g = q->v->objectives;
    double sum = hf_limits_violation(q->v, w);
    look(q, w);
    for (int k = 0; q->constraint && k < g->constraints->n; k++)
        if (hf_objectives_judges(g, k)) sum += fmax(0, q->constraint[k]) / g->constraints->unit[k];
    for (int k = q->n_cap_of_limits; k < q->n_cap; k++)
        if (isfinite(q->cap[k])) sum += fmax(0, ratio_of(q, k) / q->cap[k] - 1);
    for (int i = 0; i < q->n; i++) {
        const hf_watched *t = &q->item[i];
        if (t->kind == HF_WATCH_BOUND)
            sum += hf_limits_tension_violation(q->v->model, w->tension_N[t->cable], t->lower, t->upper);
        if (t->kind == HF_WATCH_OBJECTIVE) sum += fmax(0, t->now - t->upper) / t->unit;
    }
    return sum;
}

/* Computes the rates of the magnitude of the displacement of an attachment. */
static void displacement_rates(const hf_watched *t, const hf_sensitivity *s, const hf_workspace *w, double *rate)
{
    const double *d = w->displacement_m + 3 * (ptrdiff_t)t->attachment;
    for (int j = 0; j < s->n; j++) {
        const double *move = hf_sensitivity_displacement(s, j, t->attachment);
        rate[j] = t->value > 0 ? (d[0] * move[0] + d[1] * move[1] + d[2] * move[2]) / t->value : 0;
    }
}

/* Computes the rates of the forces on all supports that are watched, variable by variable. */
static void pull_rates(hf_watch *q, const hf_sensitivity *s, const hf_workspace *w)
{
    for (int j = 0; j < s->n; j++) {
        const hf_objectives_rate by = {q->move_m, q->tension_rate, hf_sensitivity_displacement(s, j, 0)};
        hf_sensitivity_spread(s, j, q->move_m, q->tension_rate);
        hf_objectives_pull_rates(q->v->model, w, q->point, &by, q->pull_rate);
        for (int i = 0; i < q->n; i++)
            if (q->item[i].support >= 0) *hf_watch_rate(q, i, j) = q->pull_rate[q->item[i].support];
    }
}

void hf_watch_linearise(hf_watch *q, const hf_sensitivity *s, const hf_workspace *w)
{
    bool has_pull = false;
    look(q, w);
    for (int i = 0; i < q->n; i++) {
        hf_watched *t = &q->item[i];
        const double *rate = q->by_item;
        t->value = t->now;
        t->unit = t->cable >= 0 ? fabs(t->value) : isfinite(t->upper) ? t->upper : t->lower;
        if (t->kind == HF_WATCH_LEVEL) t->unit = fmax(t->value, 1);
        if (t->constraint >= 0) {
            t->unit = q->v->objectives->constraints->unit[t->constraint];
            rate = q->constraint_rate + (size_t)t->constraint * (size_t)q->n_class;
        } else if (t->cable >= 0) {
            hf_sensitivity_tension(s, t->cable, q->by_item);
        } else if (t->attachment >= 0) {
            displacement_rates(t, s, w, q->by_item);
        } else if (t->support < 0) {
            rate = q->objective_rate + (size_t)t->objective * (size_t)q->n_class;
        }
        for (int j = 0; j < q->n_class && t->support < 0; j++)
            *hf_watch_rate(q, i, j) = rate[j];
        has_pull |= t->support >= 0;
    }
    if (has_pull) pull_rates(q, s, w);
    for (int k = 0; k < q->n_cap; k++)
        q->ratio[k] = ratio_of(q, k);
    hf_watch_aim(q, 1);
}

/* Returns the value at a part of the way from a value to its limit; exactly the limit if the part is 1. */
static double on_the_way(double value, double limit, double part)
{
    return part < 1 && isfinite(value) ? value + part * (limit - value) : limit;
}

void hf_watch_aim(hf_watch *q, double part)
{
    for (int k = 0; k < q->n_cap; k++)
        q->aim[k] = q->ratio[k] > q->cap[k] ? on_the_way(q->ratio[k], q->cap[k], part) : q->cap[k];
    for (int i = 0; i < q->n; i++) {
        hf_watched *t = &q->item[i];
        t->from = t->value < t->lower ? on_the_way(t->value, t->lower, part) : t->lower;
        t->to = t->value > t->upper ? on_the_way(t->value, t->upper, part) : t->upper;
    }
}

void hf_watch_forget(hf_watch *q)
{
    for (int i = 0; i < q->n; i++)
        q->item[i].bend = 0;
}

/* ---- a step ---- */

/* Computes the values that the linear model gives for the step x. */
static void predict(hf_watch *q, const double *x)
{
    q->weight[0] = 1;
    memcpy(q->weight + 1, x, (size_t)q->n_class * sizeof *x);
    for (int i = 0; i < q->n; i++)
        q->rate[i] = q->item[i].value + q->item[i].bend;
    hf_quadratic_combine(q->ld, 1 + q->n_class, q->weight, q->rate, q->predicted);
    for (int i = 0; i < q->n; i++)
        q->item[i].predicted = q->predicted[i];
}

void hf_watch_learn(hf_watch *q, const double *x, const hf_workspace *w)
{
    predict(q, x);
    look(q, w);
    for (int i = 0; i < q->n; i++)
        q->item[i].bend += q->item[i].now - q->item[i].predicted;
}

/* Returns the rate of an item by variable j. */
static double rate_of(const hf_watch *q, const hf_watched *t, int j)
{
    return *hf_watch_rate(q, t - q->item, j);
}

/* Returns HF_WATCH_OBJECTIVE plus the index of the item, by which hf_watch_relief finds it again. */
static int kind_of_objective(const hf_watch *q, const hf_watched *t)
{
    return HF_WATCH_OBJECTIVE + (int)(t - q->item);
}

double hf_watch_relief(const hf_watch *q, int kind, int *objective)
{
    const hf_watched *t = &q->item[kind - HF_WATCH_OBJECTIVE];
    *objective = t->objective;
    return t->ratio >= 0 ? t->value : 1; /* the limit is high <= cap low */
}

void hf_watch_extremes(const hf_watch *q, int k, const double *value, int *low, int *high)
{
    *low = *high = -1;
    for (int i = 0; i < q->n; i++) {
        if (q->item[i].ratio != k) continue;
        if (*low < 0 || value[i] < value[*low]) *low = i;
        if (*high < 0 || value[i] > value[*high]) *high = i;
    }
}

/* Tests the limit high <= cap low of cap k for the maximum and the minimum of its predicted values. If it is violated
 * by more than *worst, writes it to *limit, updates *worst and returns true. */
static bool breaks_cap(const hf_watch *q, int k, double *worst, hf_quadratic_limit *limit)
{
    double cap = q->aim[k] * (1 - HF_WATCH_INSIDE);
    int i_low, i_high;
    hf_watch_extremes(q, k, q->predicted, &i_low, &i_high);
    if (i_low < 0 || !isfinite(cap)) return false;
    const hf_watched *low = &q->item[i_low], *high = &q->item[i_high];
    double excess = (high->predicted - cap * low->predicted) / fabs(high->predicted);
    if (!(excess > *worst)) return false;
    *worst = excess;
    for (int j = 0; j < q->n_class; j++)
        limit->normal[j] = cap * rate_of(q, low, j) - rate_of(q, high, j);
    limit->bound = high->value + high->bend - cap * (low->value + low->bend);
    limit->kind = q->has_cap && k == 0 ? HF_WATCH_CAP : high->objective < 0 ? HF_WATCH_ROW : kind_of_objective(q, low);
    return true;
}

/* Returns the size of a value for the level of an objective. For a tension, it is the linearised logarithm, because the
 * level of a ratio is a difference of logarithms. Otherwise it is the value itself. */
static double size_of(const hf_watched *t, double value)
{
    return t->cable >= 0 ? log(t->value + t->bend) + (value - t->value - t->bend) / (t->value + t->bend) : value;
}

/* Tests the limit size <= level of the maximum size, or high - low <= level for logarithms of tensions. The last entry
 * of x is the increase of the level. Writes *limit and *worst like breaks_cap. */
static bool breaks_level(const hf_watch *q, const double *x, double *worst, hf_quadratic_limit *limit)
{
    const hf_watched *high = NULL, *low = NULL;
    for (int i = 0; i < q->n; i++) {
        const hf_watched *t = &q->item[i];
        if (t->kind != HF_WATCH_LEVEL) continue;
        if (!high || size_of(t, t->predicted) > size_of(high, high->predicted)) high = t;
        if (t->cable >= 0 && (!low || size_of(t, t->predicted) < size_of(low, low->predicted))) low = t;
    }
    if (!high) return false;
    double excess =
        size_of(high, high->predicted) - (low ? size_of(low, low->predicted) : 0) - q->level - x[q->n_class];
    excess /= low ? 1 : high->unit;
    if (!(excess > *worst)) return false;
    *worst = excess;
    for (int j = 0; j < q->n_class; j++) {
        double up = rate_of(q, high, j);
        limit->normal[j] = low ? rate_of(q, low, j) / (low->value + low->bend) - up / (high->value + high->bend) : -up;
    }
    limit->normal[q->n_class] = 1;
    limit->bound =
        size_of(high, high->value + high->bend) - (low ? size_of(low, low->value + low->bend) : 0) - q->level;
    limit->kind = HF_WATCH_LEVEL;
    return true;
}

bool hf_watch_worst(hf_watch *q, const double *x, double worst, hf_quadratic_limit *limit)
{
    const hf_watched *held = NULL;
    double sign = 0;
    bool is_broken = false;
    predict(q, x);
    for (int i = 0; i < q->n; i++) {
        const hf_watched *t = &q->item[i];
        double below = (t->from + HF_WATCH_INSIDE * t->unit - t->predicted) / t->unit;
        double above = (t->predicted - t->to + HF_WATCH_INSIDE * t->unit) / t->unit;
        if (!(fmax(below, above) > worst)) continue;
        worst = fmax(below, above);
        sign = below > above ? 1 : -1;
        held = t;
    }
    for (int k = 0; k < q->n_cap; k++)
        if (breaks_cap(q, k, &worst, limit)) is_broken = true;
    if (q->front && breaks_level(q, x, &worst, limit)) is_broken = true;
    if (is_broken || !held) return is_broken;
    double inside = HF_WATCH_INSIDE * held->unit, bound = sign > 0 ? held->from : held->to;
    for (int j = 0; j < q->n_class; j++)
        limit->normal[j] = sign * rate_of(q, held, j);
    limit->bound = sign * (bound - held->value - held->bend) + inside;
    limit->kind = held->kind == HF_WATCH_OBJECTIVE ? kind_of_objective(q, held) : held->kind;
    return true;
}
