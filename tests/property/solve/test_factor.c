/* form.factor: one solve by either factorisation is the exact solution of a matrix that is off by rounding, and the
 * positions of both agree to rounding times the condition number. On the nets of configs/ and on random ones. */
#include "nets.h"

#include <hifdm/batch.h>
#include <hifdm/evaluate.h>
#include <hifdm/problem.h>

/* Those that converge by Newton's method, and by the paper's iteration within their limit. */
static const struct {
    const char *name;
    bool by_newton, by_paper;
} config[] = {{"chen2022", true, true},        {"cylinder-tied-8m", true, true},
              {"paraboloid-6m", true, true},   {"paraboloid-offset-12m", true, false},
              {"reflector", true, true},       {"paraboloid-even", true, true},
              {"straight-edges", false, false}};
enum { N_CONFIG = sizeof config / sizeof *config, N_RANDOM = 60, MOST_NODES = 300 };

#define BACKWARD_ERROR 1e-15 /* per unknown */
#define AGREEMENT 1e-12      /* over the condition number */

/* Nodes in a row, each with cables to some of the eight nodes before it; force densities over six decades. */
static void open_random(struct net *net, uint64_t stream)
{
    struct rng rng = rng_start(stream);
    static struct hand_node node[MOST_NODES];
    static struct hand_cable cable[9 * MOST_NODES];
    int n_node = 6 + (int)rng_uniform(&rng, 0, MOST_NODES - 6), n_cable = 0;
    for (int i = 0; i < n_node; i++) {
        node[i] = (struct hand_node){.role = i < 4 || i >= n_node - 2 ? HF_ROLE_SUPPORT : HF_ROLE_INNER};
        for (int c = 0; c < 3; c++) {
            node[i].position_m[c] = 0.1 * i * (c == 0) + rng_uniform(&rng, -1, 1);
            if (node[i].role == HF_ROLE_INNER) node[i].load_N[c] = rng_uniform(&rng, -5, 5);
        }
        for (int back = 1; back <= 8 && back <= i; back++)
            if (back == 1 || rng_uniform(&rng, 0, 1) < 0.4)
                cable[n_cable++] = (struct hand_cable){
                    {i - back, i}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, pow(10, rng_uniform(&rng, -3, 3))};
    }
    open_hand(net, n_node, node, n_cable, cable, HF_METHOD_FDM);
}

/* |b - D x| over |D| |x| + |b| in the norm of the largest entry, the largest of x, y and z, in long double, of the
 * shape in the workspace. Takes the band. */
static double backward_error(struct net *net)
{
    const hf_model *m = &net->model;
    hf_workspace *w = &net->work;
    size_t size = 3 * (size_t)m->n_node * sizeof(double);
    int n = m->n_free, column = m->half_bandwidth + 1;
    double *x = malloc(size), worst = 0;
    ck_assert_ptr_nonnull(x);
    memcpy(x, w->position_m, size);
    hf_form_assemble(m, w);
    hf_form_assemble_loads(m, w);
    for (int c = 0; c < 3; c++) {
        const double *b = w->position_m + c * m->n_node, *at = x + c * m->n_node;
        double largest_rest = 0, largest_b = 0, largest_x = 0, norm = 0;
        for (int i = 0; i < n; i++) {
            long double rest = b[i];
            double sum = 0;
            for (int j = 0; j < n; j++) {
                int low = i < j ? i : j, d = abs(i - j);
                if (d >= column) continue;
                rest -= (long double)w->band[d + low * column] * at[j];
                sum += fabs(w->band[d + low * column]);
            }
            largest_rest = fmax(largest_rest, (double)fabsl(rest));
            largest_b = fmax(largest_b, fabs(b[i]));
            largest_x = fmax(largest_x, fabs(at[i]));
            norm = fmax(norm, sum);
        }
        worst = fmax(worst, largest_rest / (norm * largest_x + largest_b));
    }
    memcpy(w->position_m, x, size);
    free(x);
    return worst;
}

/* Solves once by each factorisation, and compares. */
static void compare_solves(struct net *net, const char *name)
{
    hf_model *m = &net->model;
    size_t n = 3 * (size_t)m->n_node;
    double *own = malloc(n * sizeof *own), largest = 0, difference = 0;
    ck_assert_ptr_nonnull(own);
    for (int by_lapack = 0; by_lapack < 2; by_lapack++) {
        m->by_lapack = by_lapack;
        ck_assert_int_eq(find_shape(net), HF_OK);
        ck_assert_int_eq(net->result.iterations, 1);
        double error = backward_error(net);
        ck_assert_msg(error <= BACKWARD_ERROR * m->n_free, "%s: %d unknowns, backward error %g", name, m->n_free,
                      error);
        if (!by_lapack) memcpy(own, net->work.position_m, n * sizeof *own);
    }
    bool same_bits = !memcmp(own, net->work.position_m, n * sizeof *own);
    for (size_t i = 0; i < n; i++) {
        largest = fmax(largest, fabs(own[i]));
        difference = fmax(difference, fabs(own[i] - net->work.position_m[i]));
    }
    ck_assert_int_eq(hf_evaluate_form(m, &net->form, &net->work, NULL, &net->result), HF_OK);
    ck_assert_msg(difference <= AGREEMENT * net->result.condition * largest, "%s: off by %g m, condition %g", name,
                  difference, net->result.condition);
    if (m->n_free > 50) ck_assert_msg(!same_bits, "%s: both ways are one", name);
    free(own);
}

START_TEST(one_solve_on_nets_of_configs)
{
    struct net net;
    char path[96];
    snprintf(path, sizeof path, "configs/%s.yaml", config[_i].name);
    OPEN_CASE(&net, path, "form.method=fdm");
    compare_solves(&net, config[_i].name);
    close_net(&net);
}
END_TEST

START_TEST(one_solve_on_random_nets)
{
    struct net net;
    char name[32];
    open_random(&net, (uint64_t)_i);
    snprintf(name, sizeof name, "random net %d", _i);
    compare_solves(&net, name);
    close_net(&net);
}
END_TEST

/* The whole form-finding by either, with Newton's method and with the paper's iteration. */
START_TEST(form_finding_with_either)
{
    static const char *const method[] = {"form.method=newton", "form.method=hifdm"};
    struct net net[2];
    char path[96];
    snprintf(path, sizeof path, "configs/%s.yaml", config[_i / 2].name);
    if (_i % 2 ? !config[_i / 2].by_paper : !config[_i / 2].by_newton) return;
    double difference = 0, largest = 0;
    for (int k = 0; k < 2; k++) {
        OPEN_CASE(&net[k], path, method[_i % 2], "form.stop=residual", k ? "form.factor=lapack" : "form.factor=own");
        ck_assert_int_eq(net[k].model.by_lapack, k);
        ck_assert_int_eq(hf_evaluate_form(&net[k].model, &net[k].form, &net[k].work, NULL, &net[k].result), HF_OK);
    }
    ck_assert_int_eq(net[0].result.iterations, net[1].result.iterations);
    for (int i = 0; i < 3 * net[0].model.n_node; i++) {
        largest = fmax(largest, fabs(net[0].work.position_m[i]));
        difference = fmax(difference, fabs(net[0].work.position_m[i] - net[1].work.position_m[i]));
    }
    ck_assert_msg(difference > 0 && difference <= AGREEMENT * net[0].result.condition * largest,
                  "%s, %s: off by %g m, condition %g", path, method[_i % 2], difference, net[0].result.condition);
    close_net(&net[0]);
    close_net(&net[1]);
}
END_TEST

/* No design shares a factor or a lane with another: the batch has the bits of one evaluation after the other. */
START_TEST(designs_are_solved_one_by_one)
{
    static const char *const solver[] = {"optimize.solver=auto", "optimize.solver=newton",
                                         "optimize.solver=fixed_point"};
    static const hf_solver used[] = {HF_SOLVER_NEWTON, HF_SOLVER_NEWTON, HF_SOLVER_FIXED_POINT};
    hf_problem p;
    hf_messages messages = {0};
    enum { N = 20 };
    const char *const set[] = {solver[_i], "form.factor=lapack"};
    bool has_lanes;
    ck_assert_msg(hf_problem_open(source_path("configs/chen2022.yaml"), set, 2, 2, &p, &messages) == HF_OK, "%s",
                  messages.text);
    ck_assert(p.model.by_lapack);
    ck_assert_int_eq(hf_batch_solver(&p.evaluator, &has_lanes), used[_i]);
    ck_assert(!has_lanes);
    ck_assert_int_eq(p.solver, used[_i]);
    size_t n_variable = (size_t)p.model.n_variable;
    double *design = malloc(N * n_variable * sizeof *design);
    hf_form_result r[N], alone;
    struct rng rng = rng_start(5);
    ck_assert_ptr_nonnull(design);
    for (size_t i = 0; i < N * n_variable; i++)
        design[i] = p.initial[i % n_variable] * rng_uniform(&rng, 0.95, 1.05);
    hf_batch_run(&p.batch, N, design, NULL, r);
    for (int i = 0; i < N; i++) {
        hf_evaluate(&p.evaluator, design + (size_t)i * n_variable, &p.workspace, &p.point, &alone);
        ck_assert_int_eq(r[i].status, alone.status);
        ck_assert_msg(!memcmp(&r[i].psi_m, &alone.psi_m, sizeof(double)), "design %d: %a, alone %a", i, r[i].psi_m,
                      alone.psi_m);
    }
    free(design);
    hf_problem_free(&p);
    hf_messages_free(&messages);
}
END_TEST

Suite *suite_property_factor(void)
{
    Suite *suite = suite_create("property/factor");
    TCase *tests = tcase_create("factor");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, one_solve_on_nets_of_configs, 0, N_CONFIG);
    tcase_add_loop_test(tests, one_solve_on_random_nets, 0, N_RANDOM);
    tcase_add_loop_test(tests, form_finding_with_either, 0, 2 * N_CONFIG);
    tcase_add_loop_test(tests, designs_are_solved_one_by_one, 0, 3);
    return suite;
}
