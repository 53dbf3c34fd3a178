#include "search/jacobian.h"

#include "base/arena.h"
#include "linalg/dot.h"

#include <math.h>

static void lay_out(hf_arena *a, hf_jacobian *j)
{
    const hf_model *m = &j->model;
    j->leader = hf_arena_take(a, (size_t)m->n_gene, sizeof(int));
    j->residual = hf_arena_take(a, (size_t)j->n_row, sizeof(double));
    j->rate = hf_arena_take(a, (size_t)j->n_row, sizeof(double));
    j->move_m = hf_arena_take(a, 3 * (size_t)m->n_node, sizeof(double));
    j->tension_rate = hf_arena_take(a, (size_t)m->n_cable, sizeof(double));
}

hf_status hf_jacobian_create(const hf_evaluator *evaluator, hf_jacobian *j)
{
    hf_arena arena = {0};
    *j = (hf_jacobian){.model = *evaluator->model, .v = *evaluator};
    j->v.model = &j->model;
    j->n_figure = j->v.goals ? j->v.goals->n_goal + 1 : 1;
    j->n_row = j->v.goals ? j->v.goals->n_row : 3 * j->model.n_inner_node;
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, j)));
    j->block = arena.block;
    for (int k = 0; k < j->model.n_gene; k++)
        j->leader[k] = k;
    j->model.gene_leader = j->leader;
    j->model.n_leader = j->model.n_gene;
    return hf_sensitivity_create(&j->v, &j->slopes);
}

void hf_jacobian_free(hf_jacobian *j)
{
    hf_arena arena = {.block = j->block};
    hf_sensitivity_free(&j->slopes);
    hf_arena_free(&arena);
    *j = (hf_jacobian){0};
}

/* Residuals of psi, whose norm it is. No node of a feasible design is loose. */
static void take_psi(const hf_jacobian *j, const hf_workspace *w)
{
    const hf_model *m = &j->model;
    double part = 1 / sqrt(m->n_inner_node);
    for (int i = 0; i < j->n_row; i++) {
        int at = i % 3 * m->n_node + m->inner_row[i / 3];
        j->residual[i] = part * (w->position_m[at] - m->position_m[at]);
    }
}

/* The changes of the residuals for one unit of gene k. */
static void push(hf_jacobian *j, hf_workspace *w, int k)
{
    const hf_model *m = &j->model;
    hf_sensitivity_spread(&j->slopes, k, j->move_m, j->tension_rate);
    if (j->v.goals) {
        const hf_goals_rate by = {j->move_m, j->tension_rate, hf_sensitivity_displacement(&j->slopes, k, 0)};
        hf_goals_push(j->v.goals, w, w->goals, &by, j->rate);
        return;
    }
    double part = 1 / sqrt(m->n_inner_node);
    for (int i = 0; i < j->n_row; i++)
        j->rate[i] = part * j->move_m[i % 3 * m->n_node + m->inner_row[i / 3]];
}

/* The change of the norm of n residuals. */
static double norm_rate(int n, const double *residual, const double *rate)
{
    double norm = sqrt(hf_dot((size_t)n, residual, residual));
    return norm > 0 ? hf_dot((size_t)n, residual, rate) / norm : (double)NAN;
}

static hf_status linearise(hf_jacobian *j, hf_workspace *w)
{
    HF_TRY(hf_sensitivity_find(&j->slopes, w));
    if (j->v.goals) return hf_goals_linearise(j->v.goals, w, w->goals, j->residual);
    take_psi(j, w);
    return HF_OK;
}

hf_status hf_jacobian_find(hf_jacobian *j, hf_workspace *w, double *derivative)
{
    const hf_goals *goals = j->v.goals;
    int n = j->model.n_gene;
    for (int i = 0; i < j->n_figure * n; i++)
        derivative[i] = (double)NAN;
    HF_TRY(linearise(j, w));
    for (int k = 0; k < n; k++) {
        push(j, w, k);
        for (int i = 0, row = 0; i < j->n_figure - 1; row += goals->goal[i++].n_row)
            derivative[i * n + k] =
                norm_rate(goals->goal[i].n_row, j->residual + row, j->rate + row) / goals->goal[i].wanted.weight;
        derivative[(j->n_figure - 1) * n + k] = norm_rate(j->n_row, j->residual, j->rate);
    }
    return HF_OK;
}
