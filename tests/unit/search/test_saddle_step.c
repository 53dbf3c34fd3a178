/* Steps by the saddle-point system against the dense normal equations, on random points of nets with and without truss;
 * its active limits against the dual method. */
#include "support.h"

#include "linalg/dense.h"
#include "linalg/quadratic.h"
#include "search/residuals.h"
#include "search/saddle_step.h"
#include <hifdm/problem.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const of[][5] = {
    {"optimize.variables=[{set: all, vary: force_density, range: 50 %}]"},
    {"optimize.variables=[{set: all, vary: tension, range: 50 %}]",
     "optimize.objective=[{figure: psi}, {figure: evenness, set: inner, weight: 1e-3}]"},
    {"optimize.variables=[{set: all, vary: force_density, range: 50 %}]",
     "optimize.objective=[{figure: psi}, {figure: evenness, set: inner, weight: 1e-3}, {figure: tension, set: "
     "boundary, "
     "target: 20, weight: 1e-4}, {figure: evenness, set: boundary, weight: 0.01}]",
     "truss.depth_m=1", "coupling.tof_m=1e-13"},
};
enum { N_OF = sizeof of / sizeof *of };

struct step {
    hf_problem problem;
    hf_evaluator v;
    hf_residuals residuals;
    hf_sensitivity slopes;
    hf_saddle_step saddle;
    int n;
    double *rate, *gradient, *hessian, *down, *up, *unit, *x;
    int *side;
};

static double *zeros(int n)
{
    double *x = calloc((size_t)n, sizeof *x);
    ck_assert_ptr_nonnull(x);
    return x;
}

/* Opens case i at a random design, and makes both models there. */
static void open_step(struct step *t, int i, struct rng *rng)
{
    const char *set[12] = {"scene.parabolic_cylinder.modules=[3, 2]", "form.residual_tolerance=1e-13"};
    hf_messages messages = {0};
    hf_form_result r;
    int n = 2;
    for (int k = 0; k < 5 && of[i][k]; k++)
        set[n++] = of[i][k];
    ck_assert_msg(hf_problem_open(source_path("configs/reflector.yaml"), set, n, 1, &t->problem, &messages) == HF_OK,
                  "%s", messages.text);
    hf_messages_free(&messages);
    t->v = t->problem.evaluator;
    t->v.by_density = true;
    t->v.boundary_ratio_cap = INFINITY;
    ck_assert(hf_saddle_step_applies(&t->v));
    ck_assert_int_eq(hf_residuals_create(&t->v, &t->residuals), HF_OK);
    ck_assert_int_eq(hf_sensitivity_create(&t->v, &t->slopes), HF_OK);
    ck_assert_int_eq(hf_saddle_step_create(&t->v, t->residuals.n_row, &t->saddle), HF_OK);
    t->n = t->problem.model.n_variable;
    n = t->n;
    t->rate = zeros(n * t->residuals.n_row);
    t->gradient = zeros(n);
    t->hessian = zeros(n * n);
    t->down = zeros(n);
    t->up = zeros(n);
    t->unit = zeros(n);
    t->x = zeros(n);
    t->side = calloc((size_t)n, sizeof *t->side);
    for (int k = 0; k < n; k++) {
        t->unit[k] = t->problem.initial[k];
        t->x[k] = t->problem.initial[k] * rng_uniform(rng, 0.8, 1.25);
        t->down[k] = -INFINITY;
        t->up[k] = INFINITY;
    }
    hf_workspace *w = &t->problem.workspace;
    ck_assert_int_eq(hf_evaluate(&t->v, t->x, w, hf_residuals_point(&t->residuals), &r), HF_OK);
    ck_assert_int_eq(hf_sensitivity_find(&t->slopes, w), HF_OK);
    ck_assert_int_eq(hf_residuals_find(&t->residuals, w), HF_OK);
    ck_assert_int_eq(hf_residuals_rates(&t->residuals, &t->slopes, w, t->rate, t->gradient), HF_OK);
    hf_saddle_step_linearise(&t->saddle, w, t->residuals.value);
    for (int e = 0; e < t->problem.model.n_cable; e++) {
        t->saddle.cable[e].low = -INFINITY;
        t->saddle.cable[e].high = INFINITY;
    }
}

static void close_step(struct step *t)
{
    free(t->rate);
    free(t->gradient);
    free(t->hessian);
    free(t->down);
    free(t->up);
    free(t->unit);
    free(t->x);
    free(t->side);
    hf_saddle_step_free(&t->saddle);
    hf_sensitivity_free(&t->slopes);
    hf_residuals_free(&t->residuals);
    hf_problem_free(&t->problem);
}

/* Sets `hessian` to J'J with the damping that the last step has used. */
static void make_hessian(struct step *t)
{
    int n = t->n, n_row = t->residuals.n_row;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = i == j ? t->saddle.cable[t->problem.model.variable_cable[i]].damping : 0;
            for (int k = 0; k < n_row; k++)
                sum += t->rate[i * n_row + k] * t->rate[j * n_row + k];
            t->hessian[i * n + j] = sum;
        }
}

static double largest_of(int n, const double *x)
{
    double largest = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, fabs(x[i]));
    return largest;
}

/* The rates of the residuals by the step are compared with J x, and the step with that of the normal equations. Their
 * condition is that of J squared, so only heavily damped steps agree closely. */
START_TEST(steps_are_those_of_the_normal_equations)
{
    struct step t;
    struct rng rng = rng_start((uint64_t)_i);
    open_step(&t, _i % N_OF, &rng);
    for (int again = 0; again < 3; again++) {
        double gain, damping = pow(10, 2.0 - 2 * again), tolerance = again == 0 ? 1e-9 : again == 1 ? 1e-8 : 1e-6;
        ck_assert_int_eq(hf_saddle_step_solve(&t.saddle, damping, t.down, t.up, t.unit, t.side, t.x, &gain), HF_OK);
        make_hessian(&t);
        int *pivot = calloc((size_t)t.n, sizeof *pivot);
        double *dense = zeros(t.n), promised = 0, largest = 0;
        for (int i = 0; i < t.n; i++)
            dense[i] = -t.gradient[i];
        ck_assert_int_eq(hf_dense_factor(t.n, t.hessian, pivot), 0);
        hf_dense_solve(t.n, t.hessian, pivot, 1, dense);
        for (int i = 0; i < t.n; i++)
            ck_assert_double_eq_tol(t.x[i], dense[i], tolerance * largest_of(t.n, dense));
        largest = largest_of(t.residuals.n_row, t.saddle.rate);
        for (int k = 0; k < t.residuals.n_row; k++) {
            double sum = 0;
            for (int i = 0; i < t.n; i++)
                sum += t.rate[i * t.residuals.n_row + k] * t.x[i];
            promised -= (t.residuals.value[k] + sum / 2) * sum;
            ck_assert_double_eq_tol(t.saddle.rate[k], sum, 1e-9 * largest);
        }
        ck_assert_double_eq_tol(gain, promised, 1e-9 * promised);
        ck_assert_double_gt(gain, 0);
        free(pivot);
        free(dense);
    }
    close_step(&t);
}
END_TEST

struct bounded {
    const struct step *step;
    double *tension_rate; /* [n_cable][n] */
};

static bool worst_limit(void *context, const double *x, hf_quadratic_limit *limit)
{
    const struct bounded *b = context;
    const struct step *t = b->step;
    const hf_model *m = &t->problem.model;
    double worst = 1e-12;
    bool found = false;
    for (int i = 0; i < t->n; i++)
        for (int up = 0; up < 2; up++) {
            double excess = (up ? x[i] - t->up[i] : t->down[i] - x[i]) / t->unit[i];
            if (!(excess > worst)) continue;
            worst = excess;
            found = true;
            limit->kind = 0;
            limit->only = i;
            limit->bound = up ? -t->up[i] : t->down[i];
        }
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &t->saddle.cable[e];
        double change = 0;
        for (int i = 0; i < t->n; i++)
            change += b->tension_rate[e * t->n + i] * x[i];
        for (int high = 0; high < 2; high++) {
            double excess = (high ? change - c->high : c->low - change) / c->tension_N;
            if (!(excess > worst)) continue;
            worst = excess;
            found = true;
            limit->kind = 1 + e;
            limit->only = -1;
            limit->bound = high ? -c->high : c->low;
        }
    }
    if (!found) return false;
    if (limit->only >= 0) {
        limit->normal[limit->only] = limit->bound == t->down[limit->only] ? 1 : -1;
        return true;
    }
    double sign = limit->bound == t->saddle.cable[limit->kind - 1].low ? 1 : -1;
    for (int i = 0; i < t->n; i++)
        limit->normal[i] = sign * b->tension_rate[(limit->kind - 1) * t->n + i];
    return true;
}

/* Bounds that cut off many steps, and limits of some tensions. Where the active set does not settle, more damping makes
 * it settle, as in a run. */
START_TEST(limits_are_those_of_the_dual_method)
{
    struct step t;
    struct rng rng = rng_start(100 + (uint64_t)_i);
    open_step(&t, _i % N_OF, &rng);
    const hf_model *m = &t.problem.model;
    struct bounded b = {&t, zeros(m->n_cable * t.n)};
    hf_quadratic dense;
    double gain, free_gain, damping = 10;
    int n_bound = 0, n_limit = 0;
    hf_status status;
    ck_assert_int_eq(hf_saddle_step_solve(&t.saddle, damping, t.down, t.up, t.unit, t.side, t.x, &free_gain), HF_OK);
    double typical = largest_of(t.n, t.x) / 2;
    for (int k = 0; k < t.n; k++) {
        t.down[k] = -typical * rng_uniform(&rng, 0.01, 2);
        t.up[k] = typical * rng_uniform(&rng, 0.01, 2);
    }
    for (int e = 0; e < m->n_cable; e++) {
        hf_sensitivity_tension(&t.slopes, e, b.tension_rate + e * t.n);
        hf_saddle_cable *c = &t.saddle.cable[e];
        if (c->variable < 0 || e % 4) continue;
        c->low = -fabs(c->change_N) * rng_uniform(&rng, 0.2, 2);
        c->high = fabs(c->change_N) * rng_uniform(&rng, 0.2, 2);
    }
    while ((status = hf_saddle_step_solve(&t.saddle, damping, t.down, t.up, t.unit, t.side, t.x, &gain)) ==
           HF_DIFFERENT)
        damping *= 4;
    ck_assert_int_eq(status, HF_OK);
    ck_assert_double_lt(damping, 1e4);
    make_hessian(&t);
    ck_assert_int_eq(hf_quadratic_create(t.n, &dense), HF_OK);
    ck_assert_int_eq(hf_quadratic_solve(&dense, t.hessian, t.gradient, t.down, t.up, worst_limit, &b), HF_OK);
    for (int i = 0; i < t.n; i++) {
        ck_assert_double_eq_tol(t.x[i], dense.x[i], 1e-7 * largest_of(t.n, dense.x));
        n_bound += t.side[i] == 1 || t.side[i] == -1;
        n_limit += t.side[i] == 2 || t.side[i] == -2;
    }
    ck_assert_int_gt(n_bound, 0);
    ck_assert_int_gt(n_limit, 0);
    ck_assert_double_lt(gain, free_gain);
    hf_arena_free_block(dense.block);
    free(b.tension_rate);
    close_step(&t);
}
END_TEST

START_TEST(what_is_not_in_the_model_is_refused)
{
    const char *const refused[] = {
        "optimize.variables=[{set: inner, vary: tension, range: 1 %}]", /* the others have a length */
        "optimize.variables=[{set: boundary, vary: tension, range: 1 %, link: set}]",
        "optimize.objective=[{figure: mass, mass_kg_per_m: 0.01}]",
        "optimize.limits=[{figure: ratio, bounds: [null, 3]}]"};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        hf_problem p;
        hf_messages messages = {0};
        ck_assert_msg(hf_problem_open(source_path("configs/reflector.yaml"), &refused[i], 1, 1, &p, &messages) == HF_OK,
                      "%s", messages.text);
        ck_assert_msg(!hf_saddle_step_applies(&p.evaluator), "%s", refused[i]);
        hf_messages_free(&messages);
        hf_problem_free(&p);
    }
}
END_TEST

Suite *suite_unit_saddle_step(void)
{
    Suite *suite = suite_create("unit/search/saddle_step");
    TCase *tcase = tcase_create("saddle_step");
    tcase_add_loop_test(tcase, steps_are_those_of_the_normal_equations, 0, 12);
    tcase_add_loop_test(tcase, limits_are_those_of_the_dual_method, 0, 12);
    tcase_add_test(tcase, what_is_not_in_the_model_is_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
