/* Contents: layout - first derivatives - tensions */
#include "search/sensitivity.h"

#include "base/arena.h"
#include "solve/newton_matrix.h"

#include <math.h>
#include <string.h>

/* ---- layout ---- */

static void lay_out(hf_arena *a, hf_sensitivity *s)
{
    const hf_model *m = s->v->model;
    size_t n = (size_t)s->n;
    s->variable_of_gene = hf_arena_take(a, (size_t)m->n_gene, sizeof(int));
    s->gene_of_cable = hf_arena_take(a, (size_t)m->n_cable, sizeof(int));
    s->place_of_row = hf_arena_take(a, (size_t)m->n_node, sizeof(int));
    s->move = hf_arena_take(a, n * s->n_dof, sizeof(double));
    s->answer = hf_arena_take(a, m->n_attachment ? n * 3 * (size_t)m->n_free : 0, sizeof(double));
    s->pull = hf_arena_take(a, n * 3 * (size_t)m->n_attachment, sizeof(double));
}

static void number(hf_sensitivity *s)
{
    const hf_model *m = s->v->model;
    int n = 0;
    for (int k = 0; k < m->n_gene; k++)
        s->variable_of_gene[k] = m->gene_leader[k] == k ? n++ : s->variable_of_gene[m->gene_leader[k]];
    for (int e = 0; e < m->n_cable; e++)
        s->gene_of_cable[e] = -1;
    for (int k = 0; k < m->n_gene; k++)
        s->gene_of_cable[m->gene_cable[k]] = k;
    for (int row = 0; row < m->n_node; row++)
        s->place_of_row[row] = row < m->n_free ? 3 * row : -1;
    for (int i = 0; i < m->n_attachment; i++)
        s->place_of_row[m->attachment_row[i]] = 3 * (m->n_free + i);
}

hf_status hf_sensitivity_create(const hf_evaluator *v, hf_sensitivity *s)
{
    const hf_model *m = v->model;
    hf_arena arena = {0};
    *s = (hf_sensitivity){.v = v, .n = m->n_leader, .n_dof = 3 * ((size_t)m->n_free + (size_t)m->n_attachment)};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, s)));
    s->block = arena.block;
    number(s);
    if (m->n_attachment) HF_TRY(hf_schur_create(m, &s->schur));
    return hf_chord_create_matrix(v, &s->matrix, &s->lanes);
}

void hf_sensitivity_free(hf_sensitivity *s)
{
    hf_arena arena = {.block = s->block};
    hf_chord_lanes_free(&s->lanes);
    hf_chord_free(&s->matrix);
    hf_schur_free(&s->schur);
    hf_arena_free(&arena);
    *s = (hf_sensitivity){0};
}

/* ---- first derivatives ---- */

/* Add -dg/dT of gene k at the workspace's shape: the change of the nodal forces for one newton of T', and of the pull
 * on the truss. */
static void add_force_of_gene(const hf_sensitivity *s, const hf_workspace *w, int k, double *force, double *on_truss)
{
    const hf_model *m = s->v->model;
    int e = m->gene_cable[k], a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    double length = w->length_m[e];
    if (s->v->rule == HF_RULE_FORCE_DENSITY) length = hf_evaluate_design_length_m(m, e);
    for (int c = 0; c < 3; c++) {
        double pull = (w->position_m[c * m->n_node + b] - w->position_m[c * m->n_node + a]) / length;
        if (a < m->n_free) force[3 * a + c] += pull;
        if (b < m->n_free) force[3 * b + c] -= pull;
        for (int t = 0; t < m->n_tie; t++)
            if (m->tie[t] / 2 == e) on_truss[3 * m->tie_attachment[t] + c] += m->tie[t] % 2 ? -pull : pull;
    }
}

/* Turn the moves with fixed supports into those of net and truss together. */
static void let_truss_answer(hf_sensitivity *s, const hf_workspace *w)
{
    const hf_model *m = s->v->model;
    size_t n_free = 3 * (size_t)m->n_free, n_attachment = 3 * (size_t)m->n_attachment;
    size_t n = (size_t)s->n;
    memset(s->answer, 0, n * n_free * sizeof(double));
    for (size_t k = 0; k < n; k++) {
        double *free_nodes = s->move + k * s->n_dof, *supports = free_nodes + n_free,
               *pull = s->pull + k * n_attachment;
        hf_schur_pull(m, w, hf_newton_matrix_block, free_nodes, pull);
        hf_schur_displace(m, &s->schur, pull, supports);
        hf_schur_push(m, w, hf_newton_matrix_block, supports, s->answer + k * n_free);
    }
    hf_chord_back_solve(&s->matrix, &s->lanes, (int)n, s->answer, n_free);
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < n_free; i++)
            s->move[k * s->n_dof + i] += s->answer[k * n_free + i];
}

hf_status hf_sensitivity_find(hf_sensitivity *s, hf_workspace *w)
{
    const hf_model *m = s->v->model;
    memset(s->pull, 0, 3 * (size_t)s->n * (size_t)m->n_attachment * sizeof(double));
    memset(s->move, 0, (size_t)s->n * s->n_dof * sizeof(double));
    HF_TRY(hf_newton_matrix_factor(m, w, NULL));
    if (m->n_attachment) HF_TRY(hf_schur_factor(m, w, hf_newton_matrix_block, &s->schur));
    for (int k = 0; k < m->n_gene; k++) {
        size_t i = (size_t)s->variable_of_gene[k];
        add_force_of_gene(s, w, k, s->move + i * s->n_dof, s->pull + 3 * i * (size_t)m->n_attachment);
    }
    hf_chord_pack(w, &s->matrix);
    hf_chord_back_solve(&s->matrix, &s->lanes, s->n, s->move, s->n_dof);
    if (m->n_attachment) let_truss_answer(s, w);
    return HF_OK;
}

/* ---- tensions ---- */

/* What the other end of cable e moves by relative to the first. */
static void relative_move(const hf_sensitivity *s, int e, const double *move, double relative[3])
{
    const hf_model *m = s->v->model;
    int a = s->place_of_row[m->end_row[2 * e]], b = s->place_of_row[m->end_row[2 * e + 1]];
    for (int c = 0; c < 3; c++)
        relative[c] = (b >= 0 ? move[b + c] : 0) - (a >= 0 ? move[a + c] : 0);
}

void hf_sensitivity_tension(const hf_sensitivity *s, const hf_workspace *w, int e, double *rate)
{
    const hf_model *m = s->v->model;
    double u[3], relative[3], length = hf_newton_matrix_direction(m, w->position_m, e, u);
    double k = hf_newton_matrix_stiffness(hf_workspace_cable(m, w, e), length, w->tension_N[e]);
    for (int i = 0; i < s->n; i++) {
        relative_move(s, e, s->move + (size_t)i * s->n_dof, relative);
        rate[i] = k * (u[0] * relative[0] + u[1] * relative[1] + u[2] * relative[2]);
    }
    int gene = s->gene_of_cable[e];
    if (gene < 0) return;
    bool is_density = s->v->rule == HF_RULE_FORCE_DENSITY;
    rate[s->variable_of_gene[gene]] += is_density ? length / hf_evaluate_design_length_m(m, e) : 1;
}
