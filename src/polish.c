/* Contents: the problem - bounds by a change of variable - residuals - sensitivities - the run */
#include "polish.h"

#include "arena.h"
#include "band.h"
#include "newton.h"
#include "symmetry.h"
#include <hifdm/metrics.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define START_INSIDE 0.9    /* of the half range: at a bound itself the change of variable has no slope */
#define STEP_TOLERANCE 1e-9 /* relative, of the variables */
#define PSI_TOLERANCE 1e-14 /* relative change of psi^2 */
#define INFEASIBLE 1e3      /* residual (m) of a design without a shape: any step to it is refused */

/* ---- the problem ---- */

typedef struct {
    const hf_evaluator *v;
    const double *lower_N, *upper_N;
    hf_workspace *w;
    const double *start_N; /* [n_gene]: linked genes share the step from here */
    double *design_N;      /* [n_gene] of the last evaluation */
    int *gene;             /* [n_leader] gene of each variable */
    int *variable_of_gene; /* [n_gene] */
    double *best_N;        /* [n_gene] */
    double *sensitivity;   /* [n_leader][3 n_free] right-hand sides, then dx/dT */
    double best_psi_m;
    int evaluations;
} problem;

int hf_polish_applies(const hf_evaluator *v)
{
    return v->model->has_newton && v->rule != HF_RULE_SEEDED && v->model->n_gene > 0;
}

static void lay_out(hf_arena *a, problem *p)
{
    const hf_model *m = p->v->model;
    size_t k = (size_t)m->n_gene;
    p->design_N = hf_arena_take(a, k, sizeof(double));
    p->best_N = hf_arena_take(a, k, sizeof(double));
    p->gene = hf_arena_take(a, k, sizeof(int));
    p->variable_of_gene = hf_arena_take(a, k, sizeof(int));
    p->sensitivity = hf_arena_take(a, (size_t)m->n_leader * 3 * (size_t)m->n_free, sizeof(double));
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

static void to_design(const problem *p, const gsl_vector *variable)
{
    const hf_model *m = p->v->model;
    for (size_t i = 0; i < variable->size; i++) {
        int k = p->gene[i];
        double half = (p->upper_N[k] - p->lower_N[k]) / 2, middle = (p->upper_N[k] + p->lower_N[k]) / 2;
        p->design_N[k] = middle + half * sin(gsl_vector_get(variable, i));
    }
    if (m->n_leader < m->n_gene) hf_symmetry_follow(m->n_gene, m->gene_leader, p->start_N, p->design_N);
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

/* ---- residuals: distances of the inner nodes over the root of their number, so that the sum of squares is psi^2 ----
 * */

static int residuals(const gsl_vector *variable, void *context, gsl_vector *f)
{
    problem *p = context;
    const hf_model *m = p->v->model;
    hf_form_result r;
    to_design(p, variable);
    p->evaluations++;
    gsl_vector_set_zero(f); /* rows beyond the inner nodes only satisfy GSL, which wants no fewer rows than variables */
    if (hf_evaluate(p->v, p->design_N, p->w, &r) != HF_OK) {
        gsl_vector_set(f, 0, INFEASIBLE);
        return GSL_SUCCESS;
    }
    if (r.psi_m < p->best_psi_m) {
        p->best_psi_m = r.psi_m;
        memcpy(p->best_N, p->design_N, (size_t)m->n_gene * sizeof(double));
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

/* Add -dg/dT of gene k at the workspace's shape: the change of the nodal forces for one newton of T'. */
static void add_force_of_gene(const problem *p, int k, double *force)
{
    const hf_model *m = p->v->model;
    int e = m->gene_cable[k], a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    double length = p->w->length_m[e];
    if (p->v->rule == HF_RULE_FORCE_DENSITY) length = hf_evaluate_design_length_m(m, e);
    for (int c = 0; c < 3; c++) {
        double pull = (p->w->position_m[c * m->n_node + b] - p->w->position_m[c * m->n_node + a]) / length;
        if (a < m->n_free) force[3 * a + c] += pull;
        if (b < m->n_free) force[3 * b + c] -= pull;
    }
}

static int jacobian(const gsl_vector *variable, void *context, gsl_matrix *J)
{
    problem *p = context;
    const hf_model *m = p->v->model;
    size_t n_dof = 3 * (size_t)m->n_free;
    hf_form_result r;
    gsl_matrix_set_zero(J);
    to_design(p, variable);
    if (hf_evaluate(p->v, p->design_N, p->w, &r) != HF_OK || hf_newton_factor(m, p->w, NULL) != HF_OK)
        return GSL_SUCCESS;
    memset(p->sensitivity, 0, (size_t)m->n_leader * n_dof * sizeof(double));
    for (int k = 0; k < m->n_gene; k++)
        add_force_of_gene(p, k, p->sensitivity + (size_t)p->variable_of_gene[k] * n_dof);
    hf_band_back_solve((int)n_dof, 3 * m->half_bandwidth + 2, m->n_leader, p->w->newton_band, p->sensitivity,
                       (int)n_dof);
    double scale = 1 / sqrt(m->n_inner_node);
    for (size_t k = 0; k < variable->size; k++) {
        double weight = scale * slope(p, variable, k);
        const double *moved = p->sensitivity + k * n_dof;
        for (int i = 0; i < m->n_inner_node; i++)
            for (int c = 0; c < 3; c++)
                gsl_matrix_set(J, (size_t)(3 * i + c), k, weight * moved[3 * m->inner_row[i] + c]);
    }
    return GSL_SUCCESS;
}

/* ---- the run ---- */

static hf_status minimise(problem *p, int max_iterations, const double *start_N, hf_polish_result *result)
{
    const hf_model *m = p->v->model;
    size_t n_variable = (size_t)m->n_leader, n_row = 3 * (size_t)m->n_inner_node;
    if (n_row < n_variable) n_row = n_variable;
    gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
    parameters.solver = gsl_multifit_nlinear_solver_qr;
    gsl_multifit_nlinear_fdf fdf = {.f = residuals, .df = jacobian, .n = n_row, .p = n_variable, .params = p};
    gsl_multifit_nlinear_workspace *solver =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, n_row, n_variable);
    gsl_vector *variable = gsl_vector_alloc(n_variable);
    if (!solver || !variable) {
        gsl_multifit_nlinear_free(solver);
        gsl_vector_free(variable);
        return HF_NO_MEMORY;
    }
    to_variable(p, start_N, variable);
    int info = 0;
    gsl_error_handler_t *before = gsl_set_error_handler_off(); /* "no progress" is an answer here */
    gsl_multifit_nlinear_init(variable, &fdf, solver);
    int status = gsl_multifit_nlinear_driver((size_t)max_iterations, STEP_TOLERANCE, 0, PSI_TOLERANCE, NULL, NULL,
                                             &info, solver);
    gsl_set_error_handler(before);
    result->iterations = (int)gsl_multifit_nlinear_niter(solver);
    /* GSL_ENOPROG: no step lowers psi any more, which is convergence to rounding */
    result->converged = status == GSL_SUCCESS || status == GSL_ENOPROG;
    gsl_multifit_nlinear_free(solver);
    gsl_vector_free(variable);
    return HF_OK;
}

hf_status hf_polish_run(const hf_evaluator *evaluator, const double *lower_N, const double *upper_N, int max_iterations,
                        double *design_N, hf_workspace *workspace, hf_polish_result *result)
{
    size_t bytes = (size_t)evaluator->model->n_gene * sizeof(double);
    problem p = {.v = evaluator, .lower_N = lower_N, .upper_N = upper_N, .start_N = design_N, .w = workspace};
    hf_form_result start;
    *result = (hf_polish_result){0};
    HF_TRY(hf_evaluate(evaluator, design_N, workspace, &start));
    hf_arena arena = {0};
    lay_out(&arena, &p);
    HF_TRY(hf_arena_allocate(&arena));
    lay_out(&arena, &p);
    number_variables(&p);
    memcpy(p.best_N, design_N, bytes);
    p.best_psi_m = result->start_psi_m = start.psi_m;
    hf_status status = minimise(&p, max_iterations, design_N, result);
    result->psi_m = p.best_psi_m;
    result->evaluations = p.evaluations;
    memcpy(design_N, p.best_N, bytes);
    hf_arena_free(&arena);
    return status;
}
