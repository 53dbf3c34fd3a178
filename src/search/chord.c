/* Contents: choice of instruction set - shared matrix - lanes - the matrix alone - the run */
#include "search/chord.h"

#include "base/arena.h"
#include "solve/coupling.h"
#include "solve/newton_matrix.h"
#include "solve/schur.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* These decide how long a lane goes on before its design is evaluated on its own, which reaches the same shape within
 * the tolerance by another way. No test of search (unit and property) fails at the values measured: ITERATIONS_MAX 20
 * and 180, PATIENCE 1 and 10, CONTRACTION 0.3 and 0.95, MODES_LEFT 0.005 and 0.5. */
#define ITERATIONS_MAX 60
#define PATIENCE 3      /* steps before CONTRACTION is asked for */
#define MODES_LEFT 0.05 /* what may be left out of the inverse of the coupling (hf_schur_modes) */
#define CONTRACTION 0.7 /* a residual must fall at least by this factor per step */

/* ---- choice of instruction set ---- */

static const hf_chord_kernels *choose_kernels(void)
{
#define TABLE(isa)                                                                                                     \
    {                                                                                                                  \
        hf_chord_forces_##isa, hf_chord_solve_##isa, hf_chord_step_##isa, hf_chord_couple_##isa, hf_chord_move_##isa   \
    }
    static const hf_chord_kernels portable = TABLE(portable), avx2 = TABLE(avx2), avx512 = TABLE(avx512);
#undef TABLE
    switch (hf_lane_best_isa()) {
    case HF_LANE_AVX512:
        return &avx512;
    case HF_LANE_AVX2:
        return &avx2;
    default:
        return &portable;
    }
}

/* ---- shared matrix ---- */

static bool is_between_supports(const hf_model *m, int e)
{
    return m->end_row[2 * e] >= m->n_free && m->end_row[2 * e + 1] >= m->n_free;
}

bool hf_chord_applies(const hf_evaluator *v)
{
    const hf_model *m = v->model;
    if (!m->has_newton || v->rule == HF_RULE_SEEDED || m->n_gene == 0) return false;
    int n_other = 0; /* cables whose laws the kernels do not serve */
    for (int e = 0; e < m->n_cable; e++)
        n_other += !hf_law_is_served(m->law[e], HF_CHORD_LAWS);
    for (int k = 0; k < m->n_gene; k++) /* the rule replaces the law of a gene's cable */
        n_other -= !hf_law_is_served(m->law[m->gene_cable[k]], HF_CHORD_LAWS);
    for (int e = 0; e < m->n_cable; e++) /* a cable between two supports moves no node */
        n_other -= !hf_law_is_served(m->law[e], HF_CHORD_LAWS) && is_between_supports(m, e);
    for (int k = 0; k < m->n_tie; k++) /* but such a cable pulls on a truss */
        n_other += !hf_law_is_served(m->law[m->tie[k] / 2], HF_CHORD_LAWS) && is_between_supports(m, m->tie[k] / 2);
    return n_other == 0;
}

static void lay_out(hf_arena *a, hf_chord *c)
{
    const hf_model *m = c->evaluator->model;
    size_t n = (size_t)c->n_dof + 4, w = (size_t)c->width; /* rows are read four at a time */
    c->row = hf_arena_take(a, n * w, sizeof(double));
    c->column = hf_arena_take(a, n * w, sizeof(double));
    c->inverse_diagonal = hf_arena_take(a, n, sizeof(double));
    c->base_m = hf_arena_take(a, 3 * (size_t)m->n_node, sizeof(double));
    c->row_begin = hf_arena_take(a, n / 4, sizeof(int));
    c->column_end = hf_arena_take(a, n / 4, sizeof(int));
    c->gene_of_cable = hf_arena_take(a, (size_t)m->n_cable, sizeof(int));
    if (c->n_pull == 0) return;
    size_t n_pull = (size_t)c->n_pull;
    c->pull_of_row = hf_arena_take(a, (size_t)m->n_node, sizeof(int));
    c->flexibility = hf_arena_take(a, n_pull * (size_t)c->n_pull_pad, sizeof(double));
    c->mode = hf_arena_take(a, 2 * n_pull * HF_CHORD_MODES_MAX, sizeof(double));
    c->tie_block = hf_arena_take(a, 9 * (size_t)m->n_tie, sizeof(double));
    c->base_displacement_m = hf_arena_take(a, n_pull, sizeof(double));
}

static void pack_factor(const hf_workspace *w, hf_chord *c)
{
    size_t ld = 3 * (size_t)c->evaluator->model->half_bandwidth + 3, width = (size_t)c->width;
    for (size_t j = 0; j < (size_t)c->n_dof; j++) {
        c->inverse_diagonal[j] = 1 / w->newton_band[j * ld];
        for (size_t d = 1; d < ld && j + d < (size_t)c->n_dof; d++) {
            double value = w->newton_band[d + j * ld];
            c->column[j * width + d - 1] = value;
            c->row[(j + d) * width + width - d] = value;
        }
    }
}

/* Is any of the four packed rows (or columns) at `block` not zero at place i of the part that they share? */
static bool has_entry(const double *block, size_t width, int i)
{
    return block[i + 3] != 0 || block[width + (size_t)i + 2] != 0 || block[2 * width + (size_t)i + 1] != 0 ||
           block[3 * width + (size_t)i] != 0;
}

static void find_skyline(hf_chord *c)
{
    size_t width = (size_t)c->width;
    for (int b = 0; 4 * b < c->n_dof; b++) {
        const double *row = c->row + 4 * (size_t)b * width, *column = c->column + 4 * (size_t)b * width;
        int begin = 0, end = c->width - 3;
        while (begin < c->width - 3 && !has_entry(row, width, begin))
            begin++;
        while (end > 0 && !has_entry(column, width, end - 1))
            end--;
        c->row_begin[b] = begin;
        c->column_end[b] = end;
    }
}

void hf_chord_pack(const hf_workspace *w, hf_chord *chord)
{
    pack_factor(w, chord);
    find_skyline(chord);
}

static hf_chord dimensions(const hf_evaluator *v)
{
    int half_bandwidth = 3 * v->model->half_bandwidth + 2, n_pull = 3 * v->model->n_attachment;
    return (hf_chord){.evaluator = v,
                      .n_dof = 3 * v->model->n_free,
                      .width = (half_bandwidth + 3) / 4 * 4,
                      .n_pull = n_pull,
                      .n_pull_pad = (n_pull + HF_CHORD_ROWS - 1) / HF_CHORD_ROWS * HF_CHORD_ROWS};
}

/* Pack what the lanes need of the truss. The workspace holds the shape of the base and its factored matrix. */
static hf_status pack_truss(const hf_model *m, hf_workspace *w, hf_chord *c)
{
    size_t n = (size_t)c->n_pull;
    hf_schur schur;
    for (int row = 0; row < m->n_node; row++)
        c->pull_of_row[row] = -1;
    for (int i = 0; i < m->n_attachment; i++)
        c->pull_of_row[m->attachment_row[i]] = 3 * i;
    for (size_t i = 0; i < n; i++) /* the rows that fill up stay zero */
        for (size_t j = 0; j < n; j++)
            c->flexibility[(i / HF_CHORD_ROWS * n + j) * HF_CHORD_ROWS + i % HF_CHORD_ROWS] =
                m->flexibility_m_per_N[i * n + j];
    for (int k = 0; k < m->n_tie; k++) {
        double block[3][3];
        hf_newton_matrix_block(m, w, m->tie[k] / 2, block);
        memcpy(c->tie_block + 9 * k, block, sizeof block);
    }
    memcpy(c->base_displacement_m, w->displacement_m, n * sizeof(double));
    hf_status status = hf_schur_create(m, &schur);
    if (status == HF_OK) status = hf_schur_factor(m, w, hf_newton_matrix_block, &schur);
    if (status == HF_OK) c->n_mode = hf_schur_modes(&schur, MODES_LEFT, HF_CHORD_MODES_MAX, c->mode);
    hf_schur_free(&schur);
    return status;
}

static hf_status allocate(hf_chord *chord)
{
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, chord)));
    chord->block = arena.block;
    chord->kernels = choose_kernels();
    return HF_OK;
}

hf_status hf_chord_create(const hf_evaluator *v, const double *base_N, hf_workspace *w, hf_chord *chord)
{
    const hf_model *m = v->model;
    hf_form_result base;
    *chord = dimensions(v);
    HF_TRY(hf_evaluate(v, base_N, w, &base));
    HF_TRY(hf_newton_matrix_factor(m, w, NULL));
    HF_TRY(allocate(chord));
    hf_chord_pack(w, chord);
    memcpy(chord->base_m, w->position_m, 3 * (size_t)m->n_node * sizeof(double));
    for (int e = 0; e < m->n_cable; e++)
        chord->gene_of_cable[e] = -1;
    for (int k = 0; k < m->n_gene; k++)
        chord->gene_of_cable[m->gene_cable[k]] = k;
    return chord->n_pull ? pack_truss(m, w, chord) : HF_OK;
}

void hf_chord_free(hf_chord *chord)
{
    free(chord->block);
    *chord = (hf_chord){0};
}

/* ---- lanes ---- */

static void lay_out_lanes(hf_arena *a, const hf_chord *c, hf_chord_lanes *l)
{
    const hf_model *m = c->evaluator->model;
    l->x_m = hf_arena_take(a, 3 * (size_t)m->n_node * HF_LANES, sizeof(double));
    l->force_N = hf_arena_take(a, ((size_t)c->n_dof + 2 * (size_t)c->width + 8) * HF_LANES, sizeof(double));
    l->gene = hf_arena_take(a, (size_t)m->n_gene * HF_LANES, sizeof(double));
    l->pull_N = hf_arena_take(a, (size_t)c->n_pull * HF_LANES, sizeof(double));
    l->displacement_m = hf_arena_take(a, (size_t)c->n_pull_pad * HF_LANES, sizeof(double));
    l->move_m = hf_arena_take(a, (size_t)c->n_pull_pad * HF_LANES, sizeof(double));
}

size_t hf_chord_bytes(const hf_evaluator *evaluator, size_t *lanes_bytes)
{
    hf_chord chord = dimensions(evaluator);
    hf_chord_lanes lanes;
    hf_arena shared = {0}, own = {0};
    lay_out(&shared, &chord);
    lay_out_lanes(&own, &chord, &lanes);
    *lanes_bytes = own.used;
    return shared.used;
}

hf_status hf_chord_lanes_create(const hf_chord *chord, hf_chord_lanes *lanes)
{
    *lanes = (hf_chord_lanes){0};
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out_lanes(&arena, chord, lanes)));
    lanes->block = arena.block;
    return HF_OK;
}

void hf_chord_lanes_free(hf_chord_lanes *lanes)
{
    free(lanes->block);
    *lanes = (hf_chord_lanes){0};
}

/* ---- the matrix alone ---- */

hf_status hf_chord_create_matrix(const hf_evaluator *v, hf_chord *chord, hf_chord_lanes *lanes)
{
    *lanes = (hf_chord_lanes){0};
    *chord = dimensions(v);
    chord->n_pull = chord->n_pull_pad = 0;
    HF_TRY(allocate(chord));
    return hf_chord_lanes_create(chord, lanes);
}

void hf_chord_back_solve(const hf_chord *chord, const hf_chord_lanes *l, int n_rhs, double *b, size_t ldb)
{
    double *rows = l->force_N + (size_t)chord->width * HF_LANES;
    size_t n = (size_t)chord->n_dof;
    memset(rows, 0, (n + (size_t)chord->width + 8) * HF_LANES * sizeof *rows);
    for (int first = 0; first < n_rhs; first += HF_LANES) {
        int n_lane = n_rhs - first < HF_LANES ? n_rhs - first : HF_LANES;
        double *column = b + (size_t)first * ldb;
        for (int k = 0; k < n_lane; k++)
            for (size_t i = 0; i < n; i++)
                rows[i * HF_LANES + (size_t)k] = column[(size_t)k * ldb + i];
        chord->kernels->solve(chord, l);
        for (int k = 0; k < n_lane; k++)
            for (size_t i = 0; i < n; i++)
                column[(size_t)k * ldb + i] = rows[i * HF_LANES + (size_t)k];
    }
}

/* ---- the run ---- */

/* How far a lane is from equilibrium. */
typedef struct {
    double residual_N; /* largest nodal force out of balance */
    double gap_m;      /* largest |F f - r| of the truss; 0 without one */
    double excess_N;   /* the larger of the residual and the gap in units of its tolerance */
} standing;

/* One call of hf_chord_run, with the state of its lanes. */
typedef struct {
    const hf_chord *chord;
    hf_chord_lanes *lanes;
    hf_workspace *w;
    const double *design_N;
    hf_form_result *result;
    int steps[HF_LANES];
    double excess_before_N[HF_LANES];
    standing at[HF_LANES];
} chord_run;

static void load(void *solver, int lane, int i_design)
{
    chord_run *s = solver;
    const hf_chord *c = s->chord;
    const hf_model *m = c->evaluator->model;
    const double *design_N = s->design_N + (size_t)i_design * (size_t)m->n_gene;
    hf_chord_lanes *l = s->lanes;
    for (int i = 0; i < 3 * m->n_node; i++)
        l->x_m[(size_t)i * HF_LANES + (size_t)lane] = c->base_m[i];
    for (int i = 0; i < c->n_pull; i++)
        l->displacement_m[(size_t)i * HF_LANES + (size_t)lane] = c->base_displacement_m[i];
    for (int k = 0; k < m->n_gene; k++)
        l->gene[(size_t)k * HF_LANES + (size_t)lane] =
            hf_evaluate_design_target(c->evaluator, m->gene_cable[k], design_N[k]);
    s->steps[lane] = 0;
    s->excess_before_N[lane] = INFINITY;
}

/* Copy the lane's shape into the workspace and measure it there, by the scalar code, into the result. */
static void unload(const chord_run *s, int lane, const double *design_N, hf_form_result *r)
{
    const hf_chord *c = s->chord;
    const hf_chord_lanes *l = s->lanes;
    const hf_model *m = c->evaluator->model;
    hf_workspace *w = s->w;
    hf_evaluate_prepare(c->evaluator, design_N, w);
    for (int i = 0; i < 3 * m->n_node; i++)
        w->position_m[i] = l->x_m[(size_t)i * HF_LANES + (size_t)lane];
    for (int i = 0; i < c->n_pull; i++)
        w->displacement_m[i] = l->displacement_m[(size_t)i * HF_LANES + (size_t)lane];
    hf_form_measure(m, c->evaluator->form, w, r);
    r->iterations = s->steps[lane];
    if (c->n_pull) hf_coupling_accept(m, w, s->steps[lane], s->at[lane].gap_m, r);
    hf_evaluate_judge(c->evaluator, r);
}

/* Compute the forces of net and truss in all lanes, and from them `at`. */
static void look(void *solver)
{
    chord_run *s = solver;
    const hf_chord *c = s->chord;
    double squared[HF_LANES], reference_N = c->evaluator->model->reference_N;
    const hf_form_settings *form = c->evaluator->form;
    c->kernels->forces(c, s->lanes, squared);
    for (int lane = 0; lane < HF_LANES; lane++) {
        double residual_N = reference_N * sqrt(squared[lane]);
        s->at[lane] = (standing){residual_N, 0, residual_N};
    }
    if (c->n_pull == 0) return;
    c->kernels->couple(c, s->lanes, squared);
    double scale = form->residual_tolerance * reference_N / form->coupling.tof_m;
    for (int lane = 0; lane < HF_LANES; lane++) {
        standing *at = &s->at[lane];
        at->gap_m = sqrt(squared[lane]);
        double gap_N = scale * at->gap_m;
        if (!(gap_N <= at->excess_N)) at->excess_N = gap_N; /* keeps a NaN */
    }
}

/* Store the result of a lane that has converged. A lane whose residual falls goes on (false); the design of any other
 * is evaluated on its own. */
static bool settle(void *solver, int lane, int i_design)
{
    chord_run *s = solver;
    const hf_evaluator *v = s->chord->evaluator;
    const double *design_N = s->design_N + (size_t)i_design * (size_t)v->model->n_gene;
    double excess_N = s->at[lane].excess_N;
    if (excess_N <= v->form->residual_tolerance * v->model->reference_N) {
        unload(s, lane, design_N, s->result + i_design);
        return true;
    }
    bool contracts = s->steps[lane] < PATIENCE || excess_N < CONTRACTION * s->excess_before_N[lane];
    if (contracts && isfinite(excess_N) && s->steps[lane] < ITERATIONS_MAX) {
        s->excess_before_N[lane] = excess_N;
        s->steps[lane]++;
        return false;
    }
    hf_evaluate(v, design_N, s->w, s->result + i_design);
    return true;
}

static void step(void *solver)
{
    chord_run *s = solver;
    const hf_chord_kernels *k = s->chord->kernels;
    if (s->chord->n_pull) k->move(s->chord, s->lanes);
    k->solve(s->chord, s->lanes);
    k->step(s->chord, s->lanes);
}

void hf_chord_run(const hf_chord *chord, hf_chord_lanes *lanes, hf_workspace *w, hf_lane_next *next, void *context,
                  const double *design_N, hf_form_result *r)
{
    static const hf_lane_solver work = {load, look, settle, step};
    chord_run s = {.chord = chord, .lanes = lanes, .w = w, .design_N = design_N, .result = r};
    hf_lane_schedule_run(&work, &s, next, context);
}
