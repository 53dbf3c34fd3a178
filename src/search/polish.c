/* Contents: the problem - bounds by a change of variable - residuals - sensitivities - the run */
#include "search/polish.h"

#include "base/arena.h"
#include "linalg/band.h"
#include "net/symmetry.h"
#include "search/chord.h"
#include "solve/newton_matrix.h"
#include "solve/schur.h"
#include <hifdm/metrics.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multilarge_nlinear.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Measured with test_polish: it passes with START_INSIDE 0.999, STALL_ITERATIONS 15 and STALL_GAIN 1e-9. With
 * START_INSIDE 0.3 the run under a ratio cap fails; with STALL_ITERATIONS 2 or STALL_GAIN 1e-5 runs end where psi still
 * has a slope. */
#define START_INSIDE 0.9   /* of the half range: at a bound itself the change of variable has no slope */
#define STALL_ITERATIONS 5 /* an optimum is reached when psi has gained over these */
#define STALL_GAIN 1e-7    /* less than this, relative */
/* Residual (m) of a design without a shape: a step to it is refused when this is more than the residual before, which
 * is less than the size of the net. test_polish passes from 1e-6 to 1e9. */
#define INFEASIBLE 1e3

/* ---- the problem ---- */

typedef struct {
    const hf_evaluator *v;
    const double *lower_N, *upper_N;
    hf_workspace *w;
    const double *start_N; /* [n_gene]: linked genes share the step from here */
    double *design_N;      /* [n_gene] of the last evaluation */
    int *gene;             /* [n_leader] gene of each variable */
    int *variable_of_gene; /* [n_gene] */
    double *trial_N;       /* [n_gene] */
    double *best_N;        /* [n_gene] */
    double *sensitivity;   /* [n_leader][3 n_free] right-hand sides, then dx/dT, then the rows of J' */
    hf_chord matrix;       /* of the net with fixed supports */
    hf_chord_lanes lanes;
    hf_schur schur; /* this and the next three only with a truss */
    double *answer; /* [n_leader][3 n_free] what the moving truss adds to `sensitivity` */
    double *pull,
        *move_m; /* [n_leader][3 n_attachment] change of the pull on the truss; [3 n_attachment] how it moves */
    double best_psi_m;
    int evaluations;
    bool has_shape;   /* status and workspace belong to design_N */
    bool is_linear;   /* ... and so do the rows of J' */
    hf_status status; /* of the last evaluation */
    hf_form_result result;
} problem;

bool hf_polish_applies(const hf_evaluator *v)
{
    return v->model->has_newton && v->rule != HF_RULE_SEEDED && v->model->n_gene > 0;
}

static void lay_out(hf_arena *a, problem *p)
{
    const hf_model *m = p->v->model;
    size_t k = (size_t)m->n_gene;
    p->design_N = hf_arena_take(a, k, sizeof(double));
    p->trial_N = hf_arena_take(a, k, sizeof(double));
    p->best_N = hf_arena_take(a, k, sizeof(double));
    p->gene = hf_arena_take(a, k, sizeof(int));
    p->variable_of_gene = hf_arena_take(a, k, sizeof(int));
    p->sensitivity = hf_arena_take(a, (size_t)m->n_leader * 3 * (size_t)m->n_free, sizeof(double));
    p->answer = m->n_attachment ? hf_arena_take(a, (size_t)m->n_leader * 3 * (size_t)m->n_free, sizeof(double)) : NULL;
    p->pull = hf_arena_take(a, (size_t)m->n_leader * 3 * (size_t)m->n_attachment, sizeof(double));
    p->move_m = hf_arena_take(a, 3 * (size_t)m->n_attachment, sizeof(double));
}

/* One variable for the genes that a symmetry links. */
static void number_variables(problem *p)
{
    const hf_model *m = p->v->model;
    int n = 0;
    for (int k = 0; k < m->n_gene; k++) {
        if (m->gene_leader[k] == k) p->gene[n++] = k;
        p->variable_of_gene[k] = m->gene_leader[k] == k ? n - 1 : p->variable_of_gene[m->gene_leader[k]];
    }
}

/* ---- bounds: T = middle + half sin(variable) ---- */

static void to_design(const problem *p, const gsl_vector *variable, double *design_N)
{
    const hf_model *m = p->v->model;
    for (size_t i = 0; i < variable->size; i++) {
        int k = p->gene[i];
        double half = (p->upper_N[k] - p->lower_N[k]) / 2, middle = (p->upper_N[k] + p->lower_N[k]) / 2;
        design_N[k] = middle + half * sin(gsl_vector_get(variable, i));
    }
    if (m->n_leader < m->n_gene) hf_symmetry_follow(m->n_gene, m->gene_leader, p->start_N, design_N);
}

static double slope(const problem *p, const gsl_vector *variable, size_t i)
{
    int k = p->gene[i];
    return (p->upper_N[k] - p->lower_N[k]) / 2 * cos(gsl_vector_get(variable, i));
}

static void to_variable(const problem *p, const double *design_N, gsl_vector *variable)
{
    for (size_t i = 0; i < variable->size; i++) {
        int k = p->gene[i];
        double half = (p->upper_N[k] - p->lower_N[k]) / 2, middle = (p->upper_N[k] + p->lower_N[k]) / 2;
        double place = half > 0 ? (design_N[k] - middle) / half : 0;
        gsl_vector_set(variable, i, asin(fmax(-START_INSIDE, fmin(START_INSIDE, place))));
    }
}

/* ---- residuals: distances of the inner nodes over the root of their number: their squares add up to psi^2 ---- */

/* Find the shape of these variables in the workspace, unless it is there already. */
static hf_status evaluate(problem *p, const gsl_vector *variable)
{
    size_t bytes = (size_t)p->v->model->n_gene * sizeof(double);
    to_design(p, variable, p->trial_N);
    if (p->has_shape && memcmp(p->trial_N, p->design_N, bytes) == 0) return p->status;
    memcpy(p->design_N, p->trial_N, bytes);
    p->evaluations++;
    p->has_shape = true;
    p->is_linear = false;
    p->status = hf_evaluate(p->v, p->design_N, p->w, &p->result);
    if (p->status == HF_OK && p->result.psi_m < p->best_psi_m) {
        p->best_psi_m = p->result.psi_m;
        memcpy(p->best_N, p->design_N, bytes);
    }
    return p->status;
}

static int residuals(const gsl_vector *variable, void *context, gsl_vector *f)
{
    problem *p = context;
    const hf_model *m = p->v->model;
    gsl_vector_set_zero(f); /* rows beyond the inner nodes only satisfy GSL, which wants no fewer rows than variables */
    if (evaluate(p, variable) != HF_OK) {
        gsl_vector_set(f, 0, INFEASIBLE);
        return GSL_SUCCESS;
    }
    double scale = 1 / sqrt(m->n_inner_node);
    for (int i = 0; i < m->n_inner_node; i++)
        for (int c = 0; c < 3; c++) {
            int at = c * m->n_node + m->inner_row[i];
            gsl_vector_set(f, (size_t)(3 * i + c), scale * (p->w->position_m[at] - m->position_m[at]));
        }
    return GSL_SUCCESS;
}

/* ---- sensitivities ---- */

/* Add -dg/dT of gene k at the workspace's shape: the change of the nodal forces for one newton of T', and of the pull
 * on the truss. */
static void add_force_of_gene(const problem *p, int k, double *force, double *on_truss)
{
    const hf_model *m = p->v->model;
    int e = m->gene_cable[k], a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    double length = p->w->length_m[e];
    if (p->v->rule == HF_RULE_FORCE_DENSITY) length = hf_evaluate_design_length_m(m, e);
    for (int c = 0; c < 3; c++) {
        double pull = (p->w->position_m[c * m->n_node + b] - p->w->position_m[c * m->n_node + a]) / length;
        if (a < m->n_free) force[3 * a + c] += pull;
        if (b < m->n_free) force[3 * b + c] -= pull;
        for (int t = 0; t < m->n_tie; t++)
            if (m->tie[t] / 2 == e) on_truss[3 * m->tie_attachment[t] + c] += m->tie[t] % 2 ? -pull : pull;
    }
}

/* Turn the sensitivities with fixed supports into those of net and truss together. */
static void let_truss_answer(problem *p)
{
    const hf_model *m = p->v->model;
    size_t n_dof = 3 * (size_t)m->n_free;
    memset(p->answer, 0, (size_t)m->n_leader * n_dof * sizeof(double));
    for (int k = 0; k < m->n_leader; k++) {
        double *pull = p->pull + (size_t)(3 * k * m->n_attachment);
        hf_schur_pull(m, p->w, p->sensitivity + (size_t)k * n_dof, pull);
        hf_schur_displace(m, &p->schur, pull, p->move_m);
        hf_schur_push(m, p->w, p->move_m, p->answer + (size_t)k * n_dof);
    }
    hf_chord_back_solve(&p->matrix, &p->lanes, m->n_leader, p->answer, n_dof);
    for (size_t i = 0; i < (size_t)m->n_leader * n_dof; i++)
        p->sensitivity[i] += p->answer[i];
}

/* Write the columns of J at these variables into the rows of p->sensitivity; all are zero where there is no shape. */
static void linearise(problem *p, const gsl_vector *variable)
{
    const hf_model *m = p->v->model;
    size_t n_dof = 3 * (size_t)m->n_free;
    hf_status status = evaluate(p, variable);
    if (p->is_linear) return;
    p->is_linear = true;
    memset(p->pull, 0, 3 * (size_t)m->n_leader * (size_t)m->n_attachment * sizeof(double));
    memset(p->sensitivity, 0, (size_t)m->n_leader * n_dof * sizeof(double));
    if (status != HF_OK || hf_newton_matrix_factor(m, p->w, NULL) != HF_OK) return;
    if (m->n_attachment && hf_schur_factor(m, p->w, &p->schur) != HF_OK) return;
    for (int k = 0; k < m->n_gene; k++)
        add_force_of_gene(p, k, p->sensitivity + (size_t)p->variable_of_gene[k] * n_dof,
                          p->pull + (size_t)(3 * p->variable_of_gene[k] * m->n_attachment));
    hf_chord_pack(p->w, &p->matrix);
    hf_chord_back_solve(&p->matrix, &p->lanes, m->n_leader, p->sensitivity, n_dof);
    if (m->n_attachment) let_truss_answer(p);
    double scale = 1 / sqrt(m->n_inner_node);
    for (size_t k = 0; k < variable->size; k++) {
        double weight = scale * slope(p, variable, k), *moved = p->sensitivity + k * n_dof;
        for (int i = 0; i < m->n_inner_node; i++) /* in place: inner_row rises */
            for (int c = 0; c < 3; c++)
                moved[3 * i + c] = weight * moved[3 * m->inner_row[i] + c];
    }
}

/* Compute v = J u or J' u, and J' J where GSL asks for it. */
static int linear_model(CBLAS_TRANSPOSE_t transpose, const gsl_vector *variable, const gsl_vector *u, void *context,
                        gsl_vector *v, gsl_matrix *JTJ)
{
    problem *p = context;
    size_t n_dof = 3 * (size_t)p->v->model->n_free, n_row = 3 * (size_t)p->v->model->n_inner_node;
    int n_variable = (int)variable->size;
    linearise(p, variable);
    gsl_matrix_const_view Jt = gsl_matrix_const_view_array_with_tda(p->sensitivity, variable->size, n_row, n_dof);
    if (transpose == CblasTrans) {
        gsl_vector_const_view head = gsl_vector_const_subvector(u, 0, n_row);
        gsl_blas_dgemv(CblasNoTrans, 1, &Jt.matrix, &head.vector, 0, v);
    } else {
        gsl_vector_set_zero(v);
        gsl_vector_view head = gsl_vector_subvector(v, 0, n_row);
        gsl_blas_dgemv(CblasTrans, 1, &Jt.matrix, u, 0, &head.vector);
    }
    if (JTJ) hf_band_gram(n_variable, (int)n_row, p->sensitivity, (int)n_dof, JTJ->data, (int)JTJ->tda);
    return GSL_SUCCESS;
}

/* ---- the run ---- */

/* Iterate until psi stalls, no step lowers it any more, or the iteration limit is reached. */
static void iterate(problem *p, int max_iterations, gsl_multilarge_nlinear_workspace *solver, hf_polish_result *result)
{
    double past_psi_m[STALL_ITERATIONS];
    while (!result->converged && result->iterations < max_iterations) {
        double *past_m = &past_psi_m[result->iterations % STALL_ITERATIONS];
        bool is_filled = result->iterations >= STALL_ITERATIONS;
        if (is_filled && *past_m - p->best_psi_m <= STALL_GAIN * p->best_psi_m) result->converged = true;
        *past_m = p->best_psi_m;
        if (result->converged) return;
        result->iterations++;
        /* GSL_ENOPROG: no step lowers psi any more, which is convergence to rounding */
        if (gsl_multilarge_nlinear_iterate(solver) != GSL_SUCCESS) result->converged = true;
    }
}

static hf_status minimise(problem *p, int max_iterations, const double *start_N, hf_polish_result *result)
{
    const hf_model *m = p->v->model;
    size_t n_variable = (size_t)m->n_leader, n_row = 3 * (size_t)m->n_inner_node;
    if (n_row < n_variable) n_row = n_variable;
    gsl_multilarge_nlinear_parameters parameters = gsl_multilarge_nlinear_default_parameters();
    gsl_multilarge_nlinear_fdf fdf = {.f = residuals, .df = linear_model, .n = n_row, .p = n_variable, .params = p};
    gsl_multilarge_nlinear_workspace *solver =
        gsl_multilarge_nlinear_alloc(gsl_multilarge_nlinear_trust, &parameters, n_row, n_variable);
    gsl_vector *variable = gsl_vector_alloc(n_variable);
    if (!solver || !variable) {
        if (solver) gsl_multilarge_nlinear_free(solver);
        gsl_vector_free(variable);
        return HF_NO_MEMORY;
    }
    to_variable(p, start_N, variable);
    gsl_multilarge_nlinear_init(variable, &fdf, solver);
    iterate(p, max_iterations, solver, result);
    gsl_multilarge_nlinear_free(solver);
    gsl_vector_free(variable);
    return HF_OK;
}

hf_status hf_polish_run(const hf_evaluator *evaluator, const double *lower_N, const double *upper_N, int max_iterations,
                        double *design_N, hf_workspace *w, hf_polish_result *result)
{
    size_t bytes = (size_t)evaluator->model->n_gene * sizeof(double);
    problem p = {.v = evaluator, .lower_N = lower_N, .upper_N = upper_N, .start_N = design_N, .w = w};
    hf_form_result start;
    *result = (hf_polish_result){0};
    HF_TRY(hf_evaluate(evaluator, design_N, w, &start));
    hf_arena arena = {0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, &p)));
    number_variables(&p);
    memcpy(p.best_N, design_N, bytes);
    p.best_psi_m = result->start_psi_m = start.psi_m;
    hf_status status = evaluator->model->n_attachment ? hf_schur_create(evaluator->model, &p.schur) : HF_OK;
    if (status == HF_OK) status = hf_chord_create_matrix(evaluator, &p.matrix, &p.lanes);
    if (status == HF_OK) status = minimise(&p, max_iterations, design_N, result);
    result->psi_m = p.best_psi_m;
    result->evaluations = p.evaluations;
    memcpy(design_N, p.best_N, bytes);
    hf_chord_lanes_free(&p.lanes);
    hf_chord_free(&p.matrix);
    hf_schur_free(&p.schur);
    hf_arena_free(&arena);
    return status;
}
