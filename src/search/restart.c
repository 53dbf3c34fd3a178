/* Implements restart.h. Sections: optima, starts, refinements. */
#include "search/restart.h"

#include "base/arena.h"

#include <math.h>
#include <string.h>

/* With three restarts, each of 20 seeds reaches the best optimum of net C, whose optima differ in a few variables. */
#define FAILURES 2        /* starts at other bounds that may fail before another individual is tried */
#define SAME_SHAPE 1e-6   /* largest difference of positions within one optimum, relative to the size of the net */
#define SAME_MERIT 1e-4   /* the same for the merit if a run has settled, because it has not converged to a shape */
#define ZERO 1e-10        /* merits below this part of the first one are rounding: such optima count as one */
#define BETTER_RATIO 1e-9 /* part of the merit by which a better optimum is better */
#define WORTH_RATIO 1e-6  /* the same for a refinement to go on with small steps */
#define AT_ONCE 64        /* starts that the threads rank together */
#define RANKED_MIN 64     /* even if so many cost more than RANKING */
#define RANKING 0.2       /* operations of one ranking, in those of one refinement */

/* ---- optima ---- */

typedef struct {
    const hf_evaluator *v;
    hf_batch *batch;
    const hf_population *bounds;
    hf_workspace *w;
    hf_objectives_point *point;
    hf_optima *optimum;
    double *shape_m;         /* [HF_OPTIMA_MAX][3][n_node] positions of the optima */
    double *start;           /* [n_variable] */
    double *tried;           /* [AT_ONCE][n_variable] starts that are ranked together, ... */
    hf_form_result *outcome; /* [AT_ONCE] ... and their results */
    int *variable;           /* [n_variable] variables at a bound; the first ones are ranked */
    double *flipped;         /* [n_variable] rank of the start at the other bound of this variable; INFINITY: none */
    double *best;            /* [n_variable] the best design, or one outside the limits if none is feasible */
    double best_merit;       /* INFINITY if none is feasible */
    double zero;             /* merit that is rounding */
    double size_m;
    int ranked_max; /* maximum number of starts that one ranking evaluates */
    int n_ranked;   /* starts evaluated so far for rankings */
    void *block;
} restart;

static double distance_m(const restart *q, const double *a)
{
    double most = 0;
    for (int i = 0; i < 3 * q->v->model->n_node; i++)
        most = fmax(most, fabs(a[i] - q->w->position_m[i]));
    return most;
}

/* Counts the optimum whose shape is in the workspace, unless its run has stalled. A new one is inserted by its merit,
 * unless its run ended early. */
static void count(restart *q, double merit, const hf_refine_result *to)
{
    hf_optima *o = q->optimum;
    size_t n = 3 * (size_t)q->v->model->n_node;
    int at = o->n;
    double near = to->stop == HF_REFINE_CONVERGED ? 0 : to->is_beaten ? WORTH_RATIO : SAME_MERIT;
    if (to->stop != HF_REFINE_CONVERGED && to->stop != HF_REFINE_SETTLED) return;
    for (int i = 0; i < o->n; i++) {
        bool is_same = fabs(merit - o->merit[i]) <= fmax(q->zero, near * merit);
        if (!is_same && distance_m(q, q->shape_m + (size_t)i * n) > SAME_SHAPE * q->size_m) continue;
        o->count[i]++;
        if (merit == q->best_merit) o->merit[i] = merit;
        return;
    }
    if (to->is_beaten) return;
    for (; at > 0 && merit < o->merit[at - 1]; at--) {
        o->merit[at] = o->merit[at - 1];
        o->count[at] = o->count[at - 1];
        memcpy(q->shape_m + (size_t)at * n, q->shape_m + (size_t)(at - 1) * n, n * sizeof(double));
    }
    memcpy(q->shape_m + (size_t)at * n, q->w->position_m, n * sizeof(double));
    o->merit[at] = merit;
    o->count[at] = 1;
    o->n++;
}

/* ---- starts ---- */

/* Returns the other bound of variable k of the best design, or NaN if the variable is at no bound, or is linked to
 * another one. */
static double other_bound(const restart *q, int k)
{
    double low = q->bounds->lower[k], high = q->bounds->upper[k];
    double other = q->best[k] <= low ? high : q->best[k] >= high ? low : (double)NAN;
    return q->v->model->variable_leader[k] == k && isfinite(other) && low < high ? other : (double)NAN;
}

/* Writes the best design with variable k at its other bound. */
static void flip(const restart *q, int k, double *design)
{
    memcpy(design, q->best, (size_t)q->bounds->n_variable * sizeof *design);
    design[k] = other_bound(q, k);
    hf_population_link(q->bounds, q->v->model, design);
}

static void rank_together(restart *q, int n, const int *variable)
{
    for (int i = 0; i < n; i++)
        flip(q, variable[i], q->tried + (size_t)i * (size_t)q->bounds->n_variable);
    hf_batch_run(q->batch, n, q->tried, NULL, q->outcome);
    q->n_ranked += n;
    for (int i = 0; i < n; i++) {
        const hf_form_result *r = &q->outcome[i];
        q->flipped[variable[i]] = r->status == HF_OK ? -1 / (1 + r->merit) : hf_population_violation(r);
    }
}

/* Ranks the starts at another bound by their merit, those within the constraints first. If there are more than
 * ranked_max, it ranks as many, evenly spread. */
static void rank_flips(restart *q)
{
    int n = 0;
    for (int k = 0; k < q->bounds->n_variable; k++) {
        q->flipped[k] = INFINITY;
        if (!isnan(other_bound(q, k))) q->variable[n++] = k;
    }
    int n_ranked = n < q->ranked_max ? n : q->ranked_max;
    for (int i = 0; i < n_ranked; i++)
        q->variable[i] = q->variable[((long)(i + 1) * n - 1) / n_ranked];
    for (int i = 0; i < n_ranked; i += AT_ONCE)
        rank_together(q, n_ranked - i < AT_ONCE ? n_ranked - i : AT_ONCE, q->variable + i);
}

/* Writes the next start at another bound. Returns false if there is none. */
static bool next_flip(restart *q, double *design)
{
    int k = -1;
    for (int i = 0; i < q->bounds->n_variable; i++)
        if (isfinite(q->flipped[i]) && (k < 0 || q->flipped[i] < q->flipped[k])) k = i;
    if (k < 0) return false;
    q->flipped[k] = INFINITY;
    flip(q, k, design);
    return true;
}

/* Writes the individual with a shape that is farthest from the best design, by variables relative to their bounds.
 * Returns false if there is none. */
static bool next_individual(const restart *q, double *design)
{
    const hf_population *p = q->bounds;
    double most = 0;
    int far = -1;
    for (int i = 0; i < p->n_individual; i++) {
        const double *of = p->design + (size_t)i * (size_t)p->n_variable;
        double sum = 0;
        for (int k = 0; k < p->n_variable; k++) {
            double range = p->upper[k] - p->lower[k], by = (of[k] - q->best[k]) / range;
            sum += isfinite(by) ? by * by : 0;
        }
        if (!(sum > most) || !hf_status_has_shape(p->result[i].status)) continue;
        most = sum;
        far = i;
    }
    if (far >= 0)
        memcpy(design, p->design + (size_t)far * (size_t)p->n_variable, (size_t)p->n_variable * sizeof *design);
    return far >= 0;
}

/* ---- refinements ---- */

static hf_status create(restart *q)
{
    const hf_model *m = q->v->model;
    size_t n = (size_t)q->bounds->n_variable;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    HF_TRY(HF_ARENA_ARRAYS(&q->block, HF_ARRAY(q->shape_m, HF_OPTIMA_MAX * 3 * (size_t)m->n_node),
                           HF_ARRAY(q->start, n), HF_ARRAY(q->tried, AT_ONCE * n), HF_ARRAY(q->outcome, AT_ONCE),
                           HF_ARRAY(q->variable, n), HF_ARRAY(q->flipped, n), HF_ARRAY(q->best, n)));
    q->ranked_max = (int)fmax(RANKED_MIN, RANKING * hf_refine_generations(q->v, 1));
    for (int i = 0; i < 3 * m->n_node; i++) {
        low[i / m->n_node] = fmin(low[i / m->n_node], q->w->position_m[i]);
        high[i / m->n_node] = fmax(high[i / m->n_node], q->w->position_m[i]);
    }
    for (int d = 0; d < 3; d++)
        q->size_m = fmax(q->size_m, high[d] - low[d]);
    return HF_OK;
}

/* Refines q->start and counts its optimum. *is_better: it is better than the best one, and becomes it. A run that ended
 * early is at most 1e-6 better, and does not replace an optimum. */
static hf_status refine(restart *q, int max_iterations, const hf_refine_watcher *watcher, hf_refine_result *result,
                        bool *is_better)
{
    const hf_population *p = q->bounds;
    hf_refine_result to = {0};
    hf_form_result r;
    hf_refine_watcher racing = watcher ? *watcher : (hf_refine_watcher){0};
    racing.beat = q->best_merit * (1 - WORTH_RATIO);
    *is_better = false;
    for (int k = 0; k < p->n_variable; k++)
        q->start[k] = hf_population_clamp(p, k, q->start[k]);
    hf_status status = hf_refine_run(q->v, p->lower, p->upper, max_iterations, NULL, &racing, q->start, q->w, &to);
    result->evaluations += to.evaluations;
    if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
    if (status != HF_OK || to.stop == HF_REFINE_MAX_ITERATIONS) return HF_OK;
    hf_evaluate(q->v, q->start, q->w, q->point, &r);
    if (r.status != HF_OK) return HF_OK;
    *is_better = !to.is_beaten && !(r.merit >= q->best_merit * (1 - BETTER_RATIO) - q->zero);
    if (*is_better) q->best_merit = r.merit;
    count(q, r.merit, &to);
    if (!*is_better) return HF_OK;
    to.evaluations = result->evaluations;
    *result = to;
    memcpy(q->best, q->start, (size_t)p->n_variable * sizeof *q->best);
    return HF_OK;
}

/* Refines from one start after the other, until a few have failed. */
static hf_status refine_all(restart *q, int max_iterations, const hf_refine_watcher *watcher, hf_refine_result *result)
{
    bool is_better = true;
    for (int i = 0, n_failed = 0; i < HF_RESTARTS; i++, n_failed += !is_better) {
        if (is_better) rank_flips(q);
        bool is_initial = i == 0 && (isinf(q->best_merit) || result->stop == HF_REFINE_STALLED);
        bool is_last = !is_initial && (n_failed >= FAILURES || !next_flip(q, q->start));
        if (is_initial) memcpy(q->start, q->bounds->initial, (size_t)q->bounds->n_variable * sizeof *q->start);
        if (is_last && !next_individual(q, q->start)) return HF_OK;
        HF_TRY(refine(q, max_iterations, watcher, result, &is_better));
        if (is_last) return HF_OK;
    }
    return HF_OK;
}

hf_status hf_restart_run(hf_batch *batch, const hf_population *p, int max_iterations, const hf_refine_watcher *watcher,
                         double *design, hf_workspace *w, hf_refine_result *result, hf_optima *optimum)
{
    const hf_evaluator *v = batch->evaluator;
    restart q = {.v = v, .batch = batch, .bounds = p, .w = w, .optimum = optimum};
    hf_objectives_point point = {0};
    hf_form_result r;
    *optimum = (hf_optima){0};
    q.point = &point;
    hf_status status = v->objectives ? hf_objectives_point_create(v->objectives, &point) : HF_OK;
    if (status == HF_OK) hf_evaluate(v, design, w, &point, &r);
    if (status == HF_OK) status = create(&q);
    if (status == HF_OK) {
        memcpy(q.best, design, (size_t)p->n_variable * sizeof *design);
        q.best_merit = r.status == HF_OK ? r.merit : (double)INFINITY;
        if (isfinite(result->start_merit)) q.zero = ZERO * result->start_merit;
        if (r.status == HF_OK) count(&q, r.merit, result);
        status = refine_all(&q, max_iterations, watcher, result);
        result->evaluations += q.n_ranked;
        if (status == HF_OK) memcpy(design, q.best, (size_t)p->n_variable * sizeof *design);
        if (status == HF_OK && isinf(q.best_merit)) status = r.status;
    }
    hf_objectives_point_free(&point);
    hf_arena_free_block(q.block);
    return status;
}
