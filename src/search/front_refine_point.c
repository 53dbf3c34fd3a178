/* Finds one point of a Pareto front. front_refine_point.h describes the interface.
 *
 *     hf_front_refine_start    best start for an objective
 *     hf_front_refine_meet     sums of squares, if the minimum of an objective is 0 -> a design to begin from
 *     hf_front_refine_point    Levenberg-Marquardt under limits on the other objectives -> objectives, multipliers
 *     hf_front_refine_common   points at the ends -> one that is best in all objectives */
#include "search/front_refine_point.h"

#include "search/refine.h"

#include <math.h>
#include <stddef.h>

/* The weights of `least` next to an objective whose minimum is 0 (`met`), both in parts of their ranges. `met` then
 * rises by about the square of the weight. With the last weight alone, a search that begins where `met` is 0 may find
 * no way along a curved valley. */
static const double weight[] = {1e-2, 1e-4};
enum { N_WEIGHT = sizeof weight / sizeof *weight };

#define SAME 1e-9 /* a range below this part of an objective counts as none */

void hf_front_refine_roles(const hf_objectives *objectives, int *role)
{
    int main = 0, n = 0;
    while (main < objectives->n_objective && hf_objectives_is_maximum(objectives->objective[main].settings.figure))
        main++;
    if (main == objectives->n_objective) main = 0;
    role[n++] = main;
    for (int k = 0; k < objectives->n_objective; k++)
        if (k != main) role[n++] = k;
}

hf_status hf_front_refine_start(const hf_front_refine *t, int k, hf_workspace *w, double *largest, const double **start)
{
    int best_rank = -1;
    double least = INFINITY;
    *start = t->start;
    for (int i = 0; i < t->n_start; i++) {
        const double *design = t->start + (size_t)i * (size_t)t->evaluator->model->n_variable;
        hf_form_result r;
        hf_status status = hf_evaluate(t->evaluator, design, w, &r);
        if (status == HF_NO_MEMORY) return status;
        for (int g = 0; g < t->evaluator->objectives->n_objective && status == HF_OK; g++)
            largest[g] = fmax(largest[g], r.objective[g]);
        int rank = status == HF_OK ? 2 : hf_status_has_shape(status);
        double value = status == HF_OK ? r.objective[k] : i;
        if (rank < best_rank || (rank == best_rank && !(value < least))) continue;
        best_rank = rank;
        least = value;
        *start = design;
    }
    return HF_OK;
}

void hf_front_refine_count(const hf_front_refine *t)
{
    if (t->watcher) atomic_fetch_add(&t->watcher->n_point, 1);
}

double hf_front_refine_distance(int n_objective, const double *range, const hf_front_point *a, const hf_front_point *b)
{
    double square = 0;
    for (int k = 0; k < n_objective; k++) {
        double part = range[k] > 0 ? (b->objective[k] - a->objective[k]) / range[k] : 0;
        square += part * part;
    }
    return sqrt(square);
}

/* Counts a step of the search, and reports the progress unless another thread is reporting. */
static hf_status tell_step(void *context, const hf_refine_progress *now)
{
    hf_front_refine_watcher *w = context;
    if (now->iterations == 0) return HF_OK;
    atomic_fetch_add(&w->n_step, 1);
    if (atomic_flag_test_and_set(&w->is_telling)) return HF_OK;
    w->tell(w->context, atomic_load(&w->n_point), atomic_load(&w->n_step));
    atomic_flag_clear(&w->is_telling);
    return HF_OK;
}

hf_status hf_front_refine_point(const hf_front_refine *t, const hf_watch_front *limits, double *design, hf_workspace *w,
                                hf_front_point *point)
{
    hf_refine_result r;
    hf_form_result result;
    const hf_refine_watcher watcher = {.after = tell_step, .context = t->watcher};
    *point = (hf_front_point){.objective = {NAN, NAN, NAN}, .multiplier = {NAN, NAN, NAN}};
    hf_status status = hf_refine_front(t->evaluator, t->lower, t->upper, t->max_iterations, limits,
                                       t->watcher ? &watcher : NULL, design, w, &r);
    if (status == HF_OK) status = hf_evaluate(t->evaluator, design, w, &result);
    if (t->stop && *t->stop) return HF_INTERRUPTED;
    if (status == HF_NO_MEMORY) return status;
    point->status = status;
    point->steps = r.iterations;
    point->is_converged = status == HF_OK && r.stop == HF_REFINE_CONVERGED;
    for (int k = 0; k < t->evaluator->objectives->n_objective && status == HF_OK; k++) {
        point->objective[k] = result.objective[k];
        if (point->is_converged) point->multiplier[k] = r.multiplier[k];
    }
    return HF_OK;
}

hf_status hf_front_refine_meet(const hf_front_refine *t, int met, int least, const double *range, double *design,
                               hf_workspace *w)
{
    hf_evaluator evaluator = *t->evaluator;
    hf_objectives objectives = *evaluator.objectives;
    hf_refine_result result;
    const hf_refine_watcher watcher = {.after = tell_step, .context = t->watcher};
    evaluator.objectives = &objectives;
    for (int i = met == least ? N_WEIGHT - 1 : 0; i < N_WEIGHT; i++) {
        for (int k = 0; k < objectives.n_objective; k++) {
            double part = k == met || met == least ? 1 : k == least ? weight[i] : 0;
            objectives.objective[k].settings.weight = range[k] > 0 ? part / range[k] : 0;
        }
        hf_status status = hf_refine_run(&evaluator, t->lower, t->upper, t->max_iterations,
                                         t->watcher ? &watcher : NULL, design, w, &result);
        if (status == HF_NO_MEMORY || status == HF_INTERRUPTED) return status;
    }
    return HF_OK;
}

int hf_front_refine_common(int n_objective, int n, const hf_front_point *const *point, const double *largest,
                           double part)
{
    int common = -1;
    double least[HF_FRONT_OBJECTIVES_MAX], most[HF_FRONT_OBJECTIVES_MAX];
    for (int k = 0; k < n_objective; k++) {
        least[k] = INFINITY;
        most[k] = largest[k];
        for (int i = 0; i < n; i++) {
            if (point[i]->status != HF_OK) continue;
            least[k] = fmin(least[k], point[i]->objective[k]);
            most[k] = fmax(most[k], point[i]->objective[k]);
        }
    }
    for (int i = 0; i < n; i++) {
        double above = point[i]->status == HF_OK ? 0 : INFINITY;
        for (int k = 0; k < n_objective && point[i]->status == HF_OK; k++)
            if (most[k] - least[k] > SAME * most[k])
                above = fmax(above, (point[i]->objective[k] - least[k]) / (most[k] - least[k]));
        if (!(above <= part) || (common >= 0 && !(above < part))) continue;
        common = i;
        part = above;
    }
    return common;
}
