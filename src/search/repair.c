/* Moves proposed designs into the limits. repair.h describes the interface.
 *
 *     best design -> shape -> values and rates of the limited items
 *     child -> predicted values -> limit that is broken most -> mirrored child -> predicted values -> ...
 *
 * Contents: memory - the model of a generation - limits - no design - a child */
#include "search/repair.h"

#include "base/arena.h"
#include "net/symmetry.h"
#include "search/refine.h"
#include "search/watch.h"

#include <math.h>
#include <string.h>

/* A mirrored child is as far inside a limit as it was outside. If children were moved to the limit itself, half of them
 * would break it by the curvature of the values: measured on configs/chen2022.yaml with a cap of 4.6, which then had
 * 9.24 mm after 5000 evaluations instead of 9.19 mm. */
#define MIRROR 2.0
#define PASSES 30  /* limits at which one child is mirrored */
#define PROBES 8   /* one individual in so many is not moved */
#define DOUBT 0.01 /* part of a value by which all designs must break a limit by the model */
/* Units by which a requirement is missed above which samples or load cases may lack a shape, and so derivatives. A
 * missing one counts as HF_BUILT_NO_VALUE units. */
#define UNKNOWN 10
#define ROUNDING 1e-9 /* part of a value by which it may break a limit */

/* The arrays for n classes of linked design variables, n_item limited items and n_child individuals. */
#define REPAIR_FIELDS(X)                                                                                               \
    X(double, width2, n, "square of the width of the bounds of each class")                                            \
    X(double, down, n, "step from the base to the lower bound of each class")                                          \
    X(double, up, n, "step from the base to its upper bound")                                                          \
    X(double, base, n_variable, "copy of the design of the model")                                                     \
    X(double, constraint_rate, n_constraint *n, "[n_constraint][n] rates of the constraints by requirements")          \
    X(double, weight, n_child *(1 + n), "[n_child][1 + n] scratch: 1, then the step from the base")                    \
    X(double, normal, n_child *n, "[n_child][n] scratch: rates of a broken limit")                                     \
    X(double, moved, n_child *n, "[n_child][n] scratch: sum of the moves")                                             \
    X(double, value, n_child *ld, "[n_child][ld] scratch: predicted values")

struct hf_repair {
    hf_evaluator v; /* without objectives, unless there are constraints by requirements */
    const double *lower, *upper, *initial;
    bool has_model; /* of `base` */
    bool is_active; /* the children of this generation are moved */
    hf_workspace w;
    hf_objectives_point point; /* not used without constraints */
    hf_sensitivity slopes;
    hf_watch watch;
    REPAIR_FIELDS(HF_ARENA_MEMBER)
    void *block;
};

/* ---- memory ---- */

void hf_repair_free(hf_repair *q)
{
    if (!q) return;
    hf_arena_free_block(q->block);
    hf_arena_free_block(q->watch.block);
    hf_sensitivity_free(&q->slopes);
    hf_objectives_point_free(&q->point);
    hf_workspace_free(&q->w);
    hf_arena_free_block(q); /* the struct is the first item of its block */
}

static hf_status allocate(hf_repair *to, int n_individual)
{
    HF_TRY(hf_workspace_create(to->v.model, &to->w));
    HF_TRY(hf_sensitivity_create(&to->v, &to->slopes));
    if (to->v.objectives) HF_TRY(hf_objectives_point_create(to->v.objectives, &to->point));
    HF_TRY(hf_watch_create(&to->v, &to->slopes, to->lower, to->upper, NULL, &to->watch));
    size_t n = (size_t)to->slopes.n, ld = (size_t)to->watch.ld, n_child = (size_t)n_individual;
    size_t n_variable = (size_t)to->v.model->n_variable;
    size_t n_constraint = to->v.objectives ? (size_t)to->v.objectives->constraints->n : 0;
    HF_TRY(HF_ARENA_ARRAYS(&to->block, REPAIR_FIELDS(HF_ARENA_ITEM)));
    to->watch.constraint = to->point.constraint;
    to->watch.constraint_rate = to->constraint_rate;
    return HF_OK;
}

/* Computes the widths of the bounds. A class has the least width of its design variables. */
static void find_widths(hf_repair *q)
{
    const hf_model *m = q->v.model;
    for (int j = 0; j < q->slopes.n; j++)
        q->width2[j] = INFINITY;
    for (int k = 0; k < m->n_variable; k++) {
        double width = (q->upper[k] - q->lower[k]) / hf_symmetry_weight(m, q->initial, k);
        double *of_class = &q->width2[q->slopes.class_of_variable[k]];
        *of_class = fmin(*of_class, width * width);
    }
}

hf_status hf_repair_create(const hf_evaluator *v, const hf_population *p, hf_repair **repair)
{
    hf_repair *q;
    void *block;
    hf_evaluator limits_only = *v;
    if (!v->objectives || !v->objectives->constraints) limits_only.objectives = NULL;
    *repair = NULL;
    if (!hf_refine_applies(&limits_only) || !hf_refine_model_is_cheap(v, p->n_individual)) return HF_OK;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(q, 1)));
    q->v = limits_only;
    q->lower = p->lower;
    q->upper = p->upper;
    q->initial = p->initial;
    hf_status status = allocate(q, p->n_individual);
    if (status == HF_OK && q->watch.n > 0) {
        find_widths(q);
        *repair = q;
    } else {
        hf_repair_free(q);
    }
    return status;
}

/* ---- the model of a generation ---- */

/* Computes the rates of the values of all items at the shape in the workspace. Returns false if there are none. */
static bool linearise(hf_repair *q)
{
    const hf_objectives *g = q->v.objectives;
    if (hf_sensitivity_find(&q->slopes, &q->w) != HF_OK) return false;
    if (g && g->constraints->linearise(q->point.constraints, q->slopes.n, hf_sensitivity_follow, &q->slopes,
                                       q->constraint_rate) != HF_OK)
        return false;
    hf_watch_linearise(&q->watch, &q->slopes, &q->w);
    for (int i = 0; i < q->watch.n; i++)
        q->watch.rate[i] = q->watch.item[i].value;
    return true;
}

void hf_repair_begin(hf_repair *q, const hf_population *now)
{
    hf_form_result r;
    int at = hf_population_nearest(now);
    q->is_active = false;
    if (at < 0 || hf_population_meets_limits(now)) return;
    const double *design = now->design + (size_t)at * (size_t)now->n_variable;
    size_t bytes = (size_t)now->n_variable * sizeof *design;
    if (!q->has_model || memcmp(q->base, design, bytes) != 0) {
        hf_evaluate(&q->v, design, &q->w, q->v.objectives ? &q->point : NULL, &r);
        q->has_model = hf_status_has_shape(r.status) && linearise(q);
        memcpy(q->base, design, bytes);
    }
    q->is_active = q->has_model;
}

bool hf_repair_is_active(const hf_repair *q)
{
    return q->is_active;
}

/* ---- limits ---- */

/* A broken limit: plus * value[item] + minus * value[other] should be higher by `by`. */
typedef struct {
    int item, other; /* other is -1 for a bound */
    double plus, minus, by;
    double part; /* `by` relative to the value */
} broken;

static void look_at_bounds(const hf_watch *t, const double *value, broken *worst)
{
    for (int i = 0; i < t->n; i++) {
        const hf_watched *item = &t->item[i];
        double below = item->lower - value[i], above = value[i] - item->upper, by = fmax(below, above);
        if (by > worst->part * item->unit) *worst = (broken){i, -1, below > above ? 1 : -1, 0, by, by / item->unit};
    }
}

static void look_at_cap(const hf_watch *t, int k, const double *value, broken *worst)
{
    int low, high;
    hf_watch_extremes(t, k, value, &low, &high);
    if (low < 0 || !isfinite(t->cap[k])) return;
    double by = value[high] - t->cap[k] * value[low];
    if (by > worst->part * fabs(value[high])) *worst = (broken){low, high, t->cap[k], -1, by, by / fabs(value[high])};
}

/* ---- no design ---- */

/* Computes the steps from the base to the bounds. A class has the smallest steps of its design variables. Returns false
 * if linked variables have no common step. */
static bool find_steps(const hf_repair *q)
{
    const hf_model *m = q->v.model;
    for (int j = 0; j < q->slopes.n; j++) {
        q->down[j] = -INFINITY;
        q->up[j] = INFINITY;
    }
    for (int k = 0; k < m->n_variable; k++) {
        int j = q->slopes.class_of_variable[k];
        double weight = hf_symmetry_weight(m, q->initial, k);
        q->down[j] = fmax(q->down[j], (q->lower[k] - q->base[k]) / weight);
        q->up[j] = fmin(q->up[j], (q->upper[k] - q->base[k]) / weight);
    }
    for (int j = 0; j < q->slopes.n; j++)
        if (!(q->down[j] <= q->up[j])) return false;
    return true;
}

/* Returns the minimum of plus * value[a] + minus * value[b] over all designs within the bounds, by the model. */
static double lowest(const hf_repair *q, double plus, int a, double minus, int b)
{
    double sum = plus * q->watch.item[a].value + minus * q->watch.item[b].value;
    for (int j = 0; j < q->slopes.n; j++) {
        double rate = plus * *hf_watch_rate(&q->watch, a, j) + minus * *hf_watch_rate(&q->watch, b, j);
        if (rate != 0) sum += rate * (rate > 0 ? q->down[j] : q->up[j]);
    }
    return sum;
}

/* Returns true if the ratio of the values `high` and `low` exceeds this cap in all designs. */
static bool is_above(const hf_repair *q, int high, int low, double cap)
{
    return lowest(q, 1, high, -cap, low) > DOUBT * q->watch.item[high].value;
}

/* Returns the largest cap that the ratio exceeds in all designs. It is at least `cap`. */
static double lowest_ratio(const hf_repair *q, int high, int low, double cap)
{
    double above = cap, below = q->watch.item[high].value / q->watch.item[low].value;
    for (int i = 0; i < 30; i++) {
        double middle = 0.5 * (above + below);
        *(is_above(q, high, low, middle) ? &above : &below) = middle;
    }
    return above;
}

/* Looks for the two values of cap k whose ratio exceeds the cap most in all designs. Those that keep it at the base do
 * not exceed it. */
static bool doubts_cap(const hf_repair *q, int k, hf_repair_doubt *doubt)
{
    const hf_watch *t = &q->watch;
    double ratio = t->cap[k];
    for (int high = 0; high < t->n && isfinite(ratio); high++)
        for (int low = 0; low < t->n && t->item[high].ratio == k; low++) {
            const hf_watched *of = &t->item[low];
            if (of->ratio != k || !(of->value > 0) || !(t->item[high].value > ratio * of->value)) continue;
            if (!is_above(q, high, low, ratio)) continue;
            ratio = lowest_ratio(q, high, low, ratio);
            doubt->limit = (hf_limit_held){.row = k == 0 && t->has_cap ? HF_LIMITS_CAP : 0,
                                           .cable = t->item[high].cable,
                                           .other = of->cable,
                                           .attachment = -1,
                                           .value = ratio,
                                           .bound = t->cap[k]};
        }
    return ratio > t->cap[k];
}

/* Looks at the bounds of a value. Rates of 0 are those of a slack cable, or of a net without a shape in a load case. */
static bool doubts_bound(const hf_repair *q, int i, hf_repair_doubt *doubt)
{
    const hf_watched *item = &q->watch.item[i];
    double least = lowest(q, 1, i, 0, i), most = -lowest(q, -1, i, 0, i), margin = DOUBT * item->unit;
    bool is_unknown = item->constraint >= 0 ? item->value > UNKNOWN * item->unit : !(item->value > 0);
    if (is_unknown || !(least < most)) return false;
    bool is_above = isfinite(item->upper) && least > item->upper + margin;
    if (!is_above && !(isfinite(item->lower) && most < item->lower - margin)) return false;
    doubt->limit = (hf_limit_held){.cable = item->cable,
                                   .other = -1,
                                   .attachment = item->attachment,
                                   .value = is_above ? least : most,
                                   .bound = is_above ? item->upper : item->lower};
    doubt->constraint = item->constraint;
    return true;
}

bool hf_repair_doubts(const hf_repair *q, hf_repair_doubt *doubt)
{
    doubt->constraint = -1;
    if (!q->is_active || !find_steps(q)) return false;
    for (int k = 0; k < q->watch.n_cap; k++)
        if (doubts_cap(q, k, doubt)) return true;
    for (int i = 0; i < q->watch.n; i++)
        if (doubts_bound(q, i, doubt)) return true;
    return false;
}

/* ---- a child ---- */

/* Adds the move that mirrors a child at a broken limit to its step and to `moved`. Returns false if no variable changes
 * the values. */
static bool mirror(const hf_repair *q, const broken *limit, double *normal, double *step, double *moved)
{
    int other = limit->other < 0 ? limit->item : limit->other; /* of a bound, `minus` is 0 */
    double along = 0;
    for (int j = 0; j < q->slopes.n; j++) {
        normal[j] = limit->plus * *hf_watch_rate(&q->watch, limit->item, j) +
                    limit->minus * *hf_watch_rate(&q->watch, other, j);
        along += q->width2[j] * normal[j] * normal[j];
    }
    if (!(along > 0 && isfinite(along))) return false;
    for (int j = 0; j < q->slopes.n; j++) {
        double move = MIRROR * limit->by / along * q->width2[j] * normal[j];
        step[j] += move;
        moved[j] += move;
    }
    return true;
}

/* Finds the limit that a step from the base breaks most. Returns false if it breaks none. */
static bool find_worst(const hf_repair *q, const double *weight, double *value, broken *worst)
{
    *worst = (broken){.part = ROUNDING, .item = -1};
    hf_quadratic_combine(q->watch.ld, 1 + q->slopes.n, weight, q->watch.rate, value);
    look_at_bounds(&q->watch, value, worst);
    for (int k = 0; k < q->watch.n_cap; k++)
        look_at_cap(&q->watch, k, value, worst);
    return worst->item >= 0;
}

void hf_repair_child(const hf_repair *q, hf_population *next, int i)
{
    const hf_model *m = q->v.model;
    size_t n = (size_t)q->slopes.n;
    double *child = next->design + (size_t)i * (size_t)next->n_variable;
    double *weight = q->weight + (size_t)i * (1 + n), *step = weight + 1, *moved = q->moved + (size_t)i * n;
    double *value = q->value + (size_t)i * (size_t)q->watch.ld;
    broken worst;
    if (!q->is_active || i % PROBES == 0) return;
    weight[0] = 1;
    for (int k = 0; k < next->n_variable; k++)
        if (m->variable_leader[k] == k)
            step[q->slopes.class_of_variable[k]] = (child[k] - q->base[k]) / hf_symmetry_weight(m, q->initial, k);
    memset(moved, 0, n * sizeof *moved);
    for (int pass = 0; pass < PASSES && find_worst(q, weight, value, &worst); pass++)
        if (!mirror(q, &worst, q->normal + (size_t)i * n, step, moved)) break;
    for (int k = 0; k < next->n_variable; k++) {
        double by = hf_symmetry_weight(m, q->initial, k) * moved[q->slopes.class_of_variable[k]];
        child[k] = hf_population_clamp(next, k, child[k] + by);
    }
    hf_population_link(next, m, child);
}
