#include "search/residuals.h"

#include "base/arena.h"

#include <math.h>

static void lay_out(hf_arena *a, hf_residuals *r)
{
    const hf_model *m = r->v->model;
    r->value = hf_arena_take(a, (size_t)r->n_row, sizeof(double));
    r->move_m = hf_arena_take(a, r->v->goals ? 3 * (size_t)m->n_node : 0, sizeof(double));
    r->tension_rate = hf_arena_take(a, r->v->goals ? (size_t)m->n_cable : 0, sizeof(double));
}

hf_status hf_residuals_create(const hf_evaluator *v, hf_residuals *r)
{
    hf_arena arena = {0};
    *r = (hf_residuals){.v = v, .n_row = v->goals ? v->goals->n_row : 3 * v->model->n_inner_node};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, r)));
    r->block = arena.block;
    return HF_OK;
}

void hf_residuals_free(hf_residuals *r)
{
    hf_arena arena = {.block = r->block};
    hf_arena_free(&arena);
    *r = (hf_residuals){0};
}

/* No node of a feasible design is loose. */
hf_status hf_residuals_find(hf_residuals *r, hf_workspace *w)
{
    const hf_model *m = r->v->model;
    if (r->v->goals) return hf_goals_linearise(r->v->goals, w, w->goals, r->value);
    double part = 1 / sqrt(m->n_inner_node);
    for (int i = 0; i < r->n_row; i++) {
        int at = i % 3 * m->n_node + m->inner_row[i / 3];
        r->value[i] = part * (w->position_m[at] - m->position_m[at]);
    }
    return HF_OK;
}

void hf_residuals_rate(hf_residuals *r, const hf_sensitivity *slopes, hf_workspace *w, int i_variable, double *rate)
{
    const hf_model *m = r->v->model;
    if (r->v->goals) {
        const hf_goals_rate by = {r->move_m, r->tension_rate, hf_sensitivity_displacement(slopes, i_variable, 0)};
        hf_sensitivity_spread(slopes, i_variable, r->move_m, r->tension_rate);
        hf_goals_push(r->v->goals, w, w->goals, &by, rate);
        return;
    }
    const double *move = slopes->move + (size_t)i_variable * slopes->n_dof;
    double part = 1 / sqrt(m->n_inner_node);
    for (int i = 0; i < r->n_row; i++)
        rate[i] = part * move[3 * m->inner_row[i / 3] + i % 3];
}
