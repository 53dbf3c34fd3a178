#include "run/run_front.h"

#include "base/clock.h"
#include "run/problem_parts.h"
#include "search/trade.h"

#include <stdlib.h>
#include <string.h>

void hf_run_front_tell(const hf_front *front, double wall_s, hf_summary *s, hf_messages *messages)
{
    hf_front_tabulate(front, &s->front);
    s->front.wall_s = wall_s;
    s->has_front = true;
    if (s->front.n_failed > 0)
        hf_warning(messages, "optimize.objectives: %d of %d points of the front failed: the first with %s",
                   s->front.n_failed, front->n_point,
                   hf_status_text(front->point[front->n_point - s->front.n_failed].status));
}

/* The designs of the earlier front within the bounds, or the base design: [n][n_gene], n at least 1. */
static double *make_starts(const hf_problem *p, const hf_population *bounds, const hf_front *earlier, int *n)
{
    int n_gene = p->model.n_gene;
    double *start = malloc((size_t)(earlier->n_point + 1) * (size_t)n_gene * sizeof *start);
    *n = 0;
    for (int i = 0; i <= earlier->n_point && start; i++) {
        const double *design = i < earlier->n_point ? earlier->design + (size_t)i * (size_t)n_gene : p->base_N;
        bool is_wanted = i < earlier->n_point ? earlier->point[i].mark == HF_FRONT_ON : *n == 0;
        for (int k = 0; k < n_gene && is_wanted; k++)
            start[(size_t)*n * (size_t)n_gene + (size_t)k] = hf_population_clamp(bounds, k, design[k]);
        *n += is_wanted;
    }
    return start;
}

hf_status hf_run_front(hf_problem *p, const hf_population *bounds, const volatile sig_atomic_t *stop, hf_front *front,
                       hf_summary *s, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    hf_trade trade = {.evaluator = &p->evaluator,
                      .lower = bounds->lower_N,
                      .upper = bounds->upper_N,
                      .n_point = o->front_points,
                      .max_iterations = o->polish_iterations,
                      .n_thread = p->batch.n_thread,
                      .stop = stop};
    if (!hf_trade_applies(&p->evaluator)) return hf_error(messages, HF_BAD_CASE, "%s", HF_PROBLEM_POLISH_NEEDS);
    double start_s = hf_clock_s(), *start = make_starts(p, bounds, front, &trade.n_start);
    hf_front found = {0};
    trade.start = start;
    hf_status status = start ? hf_trade_find(&trade, &found) : HF_NO_MEMORY;
    free(start);
    if (status == HF_INTERRUPTED || (stop && *stop)) {
        hf_front_free(&found);
        return HF_INTERRUPTED;
    }
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "out of memory for the front");
    if (status != HF_OK)
        return hf_error(messages, HF_NO_FEASIBLE, "optimize.objectives: an end of the front has no feasible design: %s",
                        hf_status_text(status));
    hf_front_free(front);
    *front = found;
    memcpy(front->base, s->form.goal, sizeof front->base);
    hf_run_front_tell(front, hf_clock_s() - start_s, s, messages);
    return HF_OK;
}
