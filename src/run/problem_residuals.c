/* Computes the residuals of a design in blocks, their derivatives, and products with these derivatives (problem.h).
 *
 *     design -> shape -> hf_jacobian: f, df/dv, dx/dv, dT/dv -> rows of the requested blocks
 *
 * The objectives give only derivatives along a variable (hf_objectives_push). A product therefore takes one solve per
 * variable, like the derivatives themselves, but it stores one column of them at a time. */
#include <hifdm/problem.h>

#include "linalg/dot.h"
#include "search/jacobian.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct {
    const hf_problem *p;
    unsigned blocks;
    int n_row;                     /* of the requested blocks */
    hf_evaluator v;                /* without limits: a shape beyond a limit has residuals, too */
    hf_residuals alone;            /* used without derivatives, which need far more memory */
    hf_jacobian jacobian;          /* used with derivatives */
    hf_residuals *residuals;       /* those of either */
    double *value;                 /* [n_row] residuals, or their derivatives by one variable */
    double *move_m, *tension_rate; /* [3][n_node], [n_cable] derivatives of the shape by one variable */
    void *block;
} derivation;

/* Returns the number of blocks of objectives. Without objectives, psi is the only one. */
static int n_objective_block(const hf_problem *p)
{
    return p->objectives.n_objective ? p->objectives.n_objective : 1;
}

int hf_problem_block(const hf_problem *p, int i, char name[HF_OBJECTIVE_NAME_SIZE])
{
    int n = p->objectives.n_objective, last = n_objective_block(p) + 1;
    if (i < 0 || i > last) return -1;
    if (i < n) {
        hf_objectives_name(&p->objectives, i, name);
        return p->objectives.objective[i].n_row;
    }
    snprintf(name, HF_OBJECTIVE_NAME_SIZE, "%s", i == last ? "tension_N" : i == last - 1 ? "position_m" : "psi_m");
    return i == last ? p->model.n_cable : 3 * (i == last - 1 ? p->model.n_node : p->model.n_inner_node);
}

unsigned hf_problem_objective_blocks(const hf_problem *p)
{
    return (1u << n_objective_block(p)) - 1;
}

/* Copies the rows of the requested blocks to `to` [n_row]. The rows of the objectives are `row`; positions [3][n_node]
 * and tensions [n_cable], or their derivatives, are in the order of the model. */
static void gather(const derivation *d, const double *row, const double *position, const double *tension, double *to)
{
    char name[HF_OBJECTIVE_NAME_SIZE];
    int last = n_objective_block(d->p) + 1;
    for (int i = 0, n; (n = hf_problem_block(d->p, i, name)) >= 0; i++) {
        bool is_selected = d->blocks >> i & 1;
        if (is_selected && i == last - 1)
            hf_model_positions(&d->p->model, position, to);
        else if (is_selected)
            memcpy(to, i == last ? tension : row, (size_t)n * sizeof(double));
        to += is_selected ? n : 0;
        row += i < last - 1 ? n : 0;
    }
}

static bool has_objectives(const derivation *d)
{
    return d->blocks & hf_problem_objective_blocks(d->p);
}

/* Allocates what d->blocks need, and finds the shape of the design and its residuals d->value. */
static hf_status begin(derivation *d, hf_problem *p, const double *design, unsigned blocks, bool with_derivatives)
{
    const hf_model *m = &p->model;
    char name[HF_OBJECTIVE_NAME_SIZE];
    hf_form_result r;
    *d = (derivation){.p = p, .blocks = blocks, .v = p->evaluator};
    d->v.boundary_ratio_cap = INFINITY;
    d->v.limits = NULL;
    d->residuals = with_derivatives ? &d->jacobian.residuals : &d->alone;
    for (int i = 0, n; (n = hf_problem_block(p, i, name)) >= 0; i++)
        d->n_row += blocks >> i & 1 ? n : 0;
    HF_TRY(with_derivatives ? hf_jacobian_create(&d->v, &d->jacobian) : hf_residuals_create(&d->v, &d->alone));
    HF_TRY(HF_ARENA_ARRAYS(&d->block, HF_ARRAY(d->value, d->n_row), HF_ARRAY(d->move_m, 3 * (size_t)m->n_node),
                           HF_ARRAY(d->tension_rate, m->n_cable)));
    hf_evaluator of_shape = d->v;
    of_shape.objectives = NULL; /* hf_residuals_find measures them */
    HF_TRY(hf_evaluate(&of_shape, design, &p->workspace, NULL, &r));
    if (has_objectives(d)) HF_TRY(hf_residuals_find(d->residuals, &p->workspace));
    gather(d, d->residuals->value, p->workspace.position_m, p->workspace.tension_N, d->value);
    return HF_OK;
}

/* Prepares the columns of all variables. */
static hf_status differentiate(derivation *d, hf_problem *p)
{
    hf_jacobian *j = &d->jacobian;
    HF_TRY(hf_sensitivity_find(&j->slopes, &p->workspace));
    if (!has_objectives(d)) return HF_OK;
    return hf_residuals_rates(&j->residuals, &j->slopes, &p->workspace, j->rate, j->gradient);
}

/* Sets d->value to the derivatives of the residuals by variable k. */
static void find_column(derivation *d, int k)
{
    const hf_jacobian *j = &d->jacobian;
    hf_sensitivity_spread(&j->slopes, k, d->move_m, d->tension_rate);
    gather(d, j->rate + (size_t)k * (size_t)j->residuals.n_row, d->move_m, d->tension_rate, d->value);
}

/* Frees the memory, and adds the message for a failure. Returns `status`. */
static hf_status end(derivation *d, hf_status status, hf_messages *messages)
{
    int n = d->p->model.n_variable;
    hf_residuals_free(&d->alone);
    hf_jacobian_free(&d->jacobian);
    hf_arena_free_block(d->block);
    if (status == HF_OK) return HF_OK;
    if (status == HF_NO_MEMORY)
        return hf_error(messages, status, "out of memory for the residuals of a design of %d variables", n);
    return hf_error(messages, status,
                    "the design has no residuals: %s. Use a design that is nearer to the initial design",
                    hf_status_text(status));
}

hf_status hf_problem_residuals(hf_problem *p, const double *design, unsigned blocks, double *residual, double *jacobian,
                               hf_messages *messages)
{
    derivation d;
    size_t n = (size_t)p->model.n_variable;
    HF_TRY(hf_problem_has_slopes(p, messages));
    hf_status status = begin(&d, p, design, blocks, jacobian != NULL);
    if (status == HF_OK) memcpy(residual, d.value, (size_t)d.n_row * sizeof(double));
    if (status == HF_OK && jacobian) status = differentiate(&d, p);
    for (size_t k = 0; k < n && status == HF_OK && jacobian; k++) {
        find_column(&d, (int)k);
        for (size_t i = 0; i < (size_t)d.n_row; i++)
            jacobian[i * n + k] = d.value[i];
    }
    return end(&d, status, messages);
}

hf_status hf_problem_vjp(hf_problem *p, const double *design, unsigned blocks, const double *vector, double *product,
                         hf_messages *messages)
{
    derivation d;
    HF_TRY(hf_problem_has_slopes(p, messages));
    hf_status status = begin(&d, p, design, blocks, true);
    if (status == HF_OK) status = differentiate(&d, p);
    for (int k = 0; k < p->model.n_variable && status == HF_OK; k++) {
        find_column(&d, k);
        product[k] = hf_dot((size_t)d.n_row, d.value, vector);
    }
    return end(&d, status, messages);
}
