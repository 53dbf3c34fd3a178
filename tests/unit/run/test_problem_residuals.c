/* Residuals of designs in blocks: random nets with limits, trusses and objectives, against differences of shapes; the
 * products against the Jacobian. */
#include "support.h"

#include <hifdm/problem.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N_TRIAL = 16, N_SET = 20, SET_SIZE = 512 };

struct opened {
    hf_problem p;
    int n_row, n_variable;
    double *design, *residual, *jacobian, *moved; /* [n_variable], [n_row], [n_row][n_variable], [4][n_row] */
};

static int count_rows(const hf_problem *p, unsigned blocks)
{
    char name[HF_OBJECTIVE_NAME_SIZE];
    int n_row = 0;
    for (int i = 0, n; (n = hf_problem_block(p, i, name)) >= 0; i++)
        n_row += blocks >> i & 1 ? n : 0;
    return n_row;
}

static void open_case(struct opened *o, const char *const *set, int n_set)
{
    hf_messages messages = {0};
    hf_status status = hf_problem_open(source_path("configs/reflector.yaml"), set, n_set, 1, &o->p, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    hf_messages_free(&messages);
    o->n_row = count_rows(&o->p, ~0u);
    o->n_variable = o->p.model.n_variable;
    size_t n_row = (size_t)o->n_row, n = (size_t)o->n_variable;
    o->design = calloc(n, sizeof(double));
    o->residual = calloc(n_row, sizeof(double));
    o->jacobian = calloc(n_row * n, sizeof(double));
    o->moved = calloc(4 * n_row, sizeof(double));
    ck_assert(o->design && o->residual && o->jacobian && o->moved);
    memcpy(o->design, o->p.initial, n * sizeof(double));
}

static void close_case(struct opened *o)
{
    free(o->design);
    free(o->residual);
    free(o->jacobian);
    free(o->moved);
    hf_problem_free(&o->p);
}

static void find(struct opened *o, unsigned blocks, double *residual, double *jacobian)
{
    hf_messages messages = {0};
    hf_status status = hf_problem_residuals(&o->p, o->design, blocks, residual, jacobian, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    ck_assert_ptr_null(messages.text);
}

/* ---- random nets ---- */

static const char *const variables[] = {
    "optimize.rule=force_density",
    "optimize.symmetry=xy",
    "optimize.variables=[{set: boundary, vary: tension, range: 30 %}, {set: boundary, vary: support_xyz, range: 0.1}]",
    ("optimize.variables=[{set: inner, vary: force_density, range: 20 %, link: set}, {set: boundary, vary: tension, "
     "range: 20 %}]"),
    "optimize.variables=[{set: boundary, vary: length, range: 1 %}]",
};
static const char *const objectives[] = {
    "{figure: psi, weight: %.3f}",
    "{figure: tension, set: boundary, target: 11, weight: %.3f}",
    "{figure: evenness, set: all, weight: %.3f}",
    "{figure: surface, feed: refocused, weight: %.3f}",
    "{figure: facets, along: half_path, weight: %.3f}",
    "{figure: length, set: inner, weight: %.3f}",
};
enum { N_VARIABLES = sizeof variables / sizeof *variables, N_OBJECTIVE = sizeof objectives / sizeof *objectives };

/* A limit that every design breaks, so that a shape beyond its limits has residuals. */
static const char broken_limits[] = "optimize.limits=[{figure: tension, set: all, bounds: [1e3, 2e3]}]";

static void open_random(struct opened *o, struct rng *rng, int trial)
{
    char text[N_SET][SET_SIZE], term[128];
    const char *set[N_SET];
    int n = 0, n_term = 0;
    snprintf(text[n++], SET_SIZE, "scene.parabolic_cylinder.modules=[%d, 2]", rng_int(rng, 2, 3));
    snprintf(text[n++], SET_SIZE, "scene.parabolic_cylinder.aperture_m=%.6f", rng_uniform(rng, 1.5, 2.5));
    snprintf(text[n++], SET_SIZE, "scene.parabolic_cylinder.length_m=%.6f", rng_uniform(rng, 1.5, 2.5));
    snprintf(text[n++], SET_SIZE, "scene.parabolic_cylinder.focal_length_m=%.6f", rng_uniform(rng, 2, 4));
    snprintf(text[n++], SET_SIZE, "form.pretension_N=%.6f", rng_uniform(rng, 8, 12));
    snprintf(text[n++], SET_SIZE, "form.residual_tolerance=1e-13");
    snprintf(text[n++], SET_SIZE, "form.length_tolerance=1e-13");
    snprintf(text[n++], SET_SIZE, "%s", variables[trial % N_VARIABLES]);
    if (trial % 2) snprintf(text[n++], SET_SIZE, "truss.depth_m=1");
    if (trial % 2) snprintf(text[n++], SET_SIZE, "coupling.tof_m=1e-12");
    if (trial % 3 == 0) snprintf(text[n++], SET_SIZE, "%s", broken_limits);
    strcpy(text[n], "optimize.objective=[");
    for (int i = 0; i < N_OBJECTIVE && trial % 4; i++) {
        if (rng_int(rng, 0, 1)) continue;
        snprintf(term, sizeof term, objectives[i], rng_uniform(rng, 0.1, 10));
        strcat(strcat(text[n], n_term++ ? ", " : ""), term);
    }
    strcat(text[n], "]");
    n += n_term > 0;
    for (int i = 0; i < n; i++)
        set[i] = text[i];
    open_case(o, set, n);
    for (int k = 0; k < o->n_variable; k++)
        o->design[k] += o->p.model.variable_cable[k] < 0 ? rng_uniform(rng, -0.01, 0.01)
                                                         : o->design[k] * rng_uniform(rng, -1e-3, 1e-3);
    ck_assert_int_eq(o->p.objectives.n_objective, n_term);
}

/* ---- tests ---- */

/* Central differences of fourth order. Each block is compared with its largest derivative. */
static void check_column(struct opened *o, int k, const double *largest)
{
    static const double at[4] = {-2, -1, 1, 2}, weight[4] = {1, -8, 8, -1};
    char name[HF_OBJECTIVE_NAME_SIZE];
    double kept = o->design[k], step = o->p.model.variable_cable[k] < 0 ? 3e-4 : 3e-4 * kept;
    for (int q = 0; q < 4; q++) {
        o->design[k] = kept + at[q] * step;
        find(o, ~0u, o->moved + q * o->n_row, NULL);
    }
    o->design[k] = kept;
    for (int block = 0, row = 0, n; (n = hf_problem_block(&o->p, block, name)) >= 0; block++)
        for (int end = row + n; row < end; row++) {
            double slope = 0;
            for (int q = 0; q < 4; q++)
                slope += weight[q] * o->moved[q * o->n_row + row] / (12 * step);
            ck_assert_msg(fabs(slope - o->jacobian[row * o->n_variable + k]) <= 2e-7 * largest[block],
                          "variable %d, %s row %d: %g, not %g of up to %g", k, name, row,
                          o->jacobian[row * o->n_variable + k], slope, largest[block]);
        }
}

START_TEST(derivatives_are_those_of_differences)
{
    struct opened o;
    struct rng rng = rng_start((uint64_t)_i);
    char name[HF_OBJECTIVE_NAME_SIZE];
    double largest[HF_DESIGN_ROWS_MAX + 2] = {0};
    open_random(&o, &rng, _i);
    find(&o, ~0u, o.residual, o.jacobian);
    for (int block = 0, row = 0, n; (n = hf_problem_block(&o.p, block, name)) >= 0; row += n, block++)
        for (int i = row * o.n_variable; i < (row + n) * o.n_variable; i++)
            largest[block] = fmax(largest[block], fabs(o.jacobian[i]));
    for (int k = 0; k < o.n_variable; k++)
        check_column(&o, k, largest);
    close_case(&o);
}
END_TEST

/* The residuals are those of the merit, with limits that hold and limits that do not. */
START_TEST(the_norm_is_the_merit)
{
    struct opened o;
    struct rng rng = rng_start((uint64_t)_i);
    hf_form_result r;
    double square = 0;
    open_random(&o, &rng, _i);
    unsigned blocks = hf_problem_objective_blocks(&o.p);
    int n = count_rows(&o.p, blocks);
    find(&o, blocks, o.residual, NULL);
    for (int i = 0; i < n; i++)
        square += o.residual[i] * o.residual[i];
    hf_batch_run(&o.p.batch, 1, o.design, NULL, &r);
    ck_assert_int_eq(r.status, _i % 3 ? HF_OK : HF_OUT_OF_LIMITS);
    hf_evaluator free_of_limits = o.p.evaluator;
    free_of_limits.limits = NULL;
    ck_assert_int_eq(hf_evaluate(&free_of_limits, o.design, &o.p.workspace, &o.p.point, &r), HF_OK);
    ck_assert_double_eq_tol(sqrt(square), r.merit, 1e-12 * r.merit);
    close_case(&o);
}
END_TEST

START_TEST(products_are_those_of_the_jacobian)
{
    struct opened o;
    struct rng rng = rng_start((uint64_t)_i);
    hf_messages messages = {0};
    open_random(&o, &rng, _i);
    char name[HF_OBJECTIVE_NAME_SIZE];
    int n_block = 0;
    while (hf_problem_block(&o.p, n_block, name) >= 0)
        n_block++;
    double *vector = o.residual, *product = o.moved;
    for (int trial = 0; trial < 4; trial++) {
        unsigned blocks = trial ? (unsigned)rng_int(&rng, 1, (1 << n_block) - 1) : ~0u;
        int n_row = count_rows(&o.p, blocks);
        find(&o, blocks, o.residual, o.jacobian);
        for (int i = 0; i < n_row; i++)
            vector[i] = rng_uniform(&rng, -1, 1);
        product = realloc(product, (size_t)o.n_variable * sizeof *product);
        o.moved = product;
        ck_assert_int_eq(hf_problem_vjp(&o.p, o.design, blocks, vector, product, &messages), HF_OK);
        for (int k = 0; k < o.n_variable; k++) {
            double sum = 0, size = 0;
            for (int i = 0; i < n_row; i++) {
                sum += vector[i] * o.jacobian[i * o.n_variable + k];
                size += fabs(vector[i] * o.jacobian[i * o.n_variable + k]);
            }
            ck_assert_double_le(fabs(product[k] - sum), 1e-12 * size);
        }
    }
    close_case(&o);
}
END_TEST

/* Selected blocks have the bits that they have among all blocks. */
START_TEST(selected_blocks_are_rows_of_all)
{
    struct opened o;
    struct rng rng = rng_start(1);
    char name[HF_OBJECTIVE_NAME_SIZE];
    open_random(&o, &rng, 1);
    find(&o, ~0u, o.residual, o.jacobian);
    for (int block = 0, row = 0, n; (n = hf_problem_block(&o.p, block, name)) >= 0; row += n, block++) {
        double *jacobian = calloc((size_t)n * (size_t)o.n_variable, sizeof(double));
        find(&o, 1u << block, o.moved, jacobian);
        ck_assert_mem_eq(o.moved, o.residual + row, (size_t)n * sizeof(double));
        ck_assert_mem_eq(jacobian, o.jacobian + row * o.n_variable, (size_t)(n * o.n_variable) * sizeof(double));
        free(jacobian);
    }
    ck_assert_int_eq(hf_problem_block(&o.p, -1, name), -1);
    close_case(&o);
}
END_TEST

/* The blocks of the shape are its positions and tensions, in the order of the scene. */
START_TEST(the_last_blocks_are_the_shape)
{
    struct opened o;
    hf_form_result r;
    char name[HF_OBJECTIVE_NAME_SIZE];
    open_case(&o, NULL, 0);
    const hf_model *m = &o.p.model;
    ck_assert_int_eq(hf_problem_block(&o.p, 0, name), 3 * m->n_inner_node);
    ck_assert_str_eq(name, "psi_m");
    ck_assert_int_eq(hf_problem_block(&o.p, 1, name), 3 * m->n_node);
    ck_assert_str_eq(name, "position_m");
    ck_assert_int_eq(hf_problem_block(&o.p, 2, name), m->n_cable);
    ck_assert_str_eq(name, "tension_N");
    find(&o, 6, o.residual, NULL);
    ck_assert_int_eq(hf_evaluate(&o.p.evaluator, o.design, &o.p.workspace, &o.p.point, &r), HF_OK);
    hf_model_positions(m, o.p.workspace.position_m, o.moved);
    ck_assert_mem_eq(o.residual, o.moved, 3 * (size_t)m->n_node * sizeof(double));
    ck_assert_mem_eq(o.residual + 3 * m->n_node, o.p.workspace.tension_N, (size_t)m->n_cable * sizeof(double));
    close_case(&o);
}
END_TEST

START_TEST(designs_without_a_shape_are_refused)
{
    static const char *const set[] = {"optimize.variables=[{set: boundary, vary: support_xyz, range: 0.1}]"};
    struct opened o;
    hf_messages messages = {0};
    open_case(&o, set, 1);
    o.design[0] = 1e300;
    hf_status status = hf_problem_residuals(&o.p, o.design, ~0u, o.residual, o.jacobian, &messages);
    ck_assert(!hf_status_has_shape(status) && status != HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "error: the design has no residuals: "));
    ck_assert_ptr_nonnull(strstr(messages.text, ". Use a design that is nearer to the initial design"));
    ck_assert_int_eq(hf_problem_vjp(&o.p, o.design, ~0u, o.residual, o.moved, &messages), status);
    o.design[0] = 0;
    find(&o, ~0u, o.residual, o.jacobian); /* the problem still works */
    hf_messages_free(&messages);
    close_case(&o);
}
END_TEST

START_TEST(designs_without_derivatives_are_refused)
{
    static const char *const set[] = {"optimize.rule=seeded"};
    struct opened o;
    hf_messages messages = {0};
    open_case(&o, set, 1);
    ck_assert_int_eq(hf_problem_residuals(&o.p, o.design, 1, o.residual, NULL, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "there are no derivatives under optimize.rule seeded"));
    ck_assert_int_eq(hf_problem_vjp(&o.p, o.design, 1, o.residual, o.moved, &messages), HF_BAD_CASE);
    hf_messages_free(&messages);
    close_case(&o);
}
END_TEST

Suite *suite_unit_problem_residuals(void)
{
    Suite *suite = suite_create("unit/problem_residuals");
    TCase *tests = tcase_create("problem_residuals");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, derivatives_are_those_of_differences, 0, N_TRIAL);
    tcase_add_loop_test(tests, the_norm_is_the_merit, 0, N_TRIAL);
    tcase_add_loop_test(tests, products_are_those_of_the_jacobian, 0, N_TRIAL);
    tcase_add_test(tests, selected_blocks_are_rows_of_all);
    tcase_add_test(tests, the_last_blocks_are_the_shape);
    tcase_add_test(tests, designs_without_a_shape_are_refused);
    tcase_add_test(tests, designs_without_derivatives_are_refused);
    return suite;
}
