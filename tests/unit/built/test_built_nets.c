/* Goals over nets as built of a design: their derivatives against differences, on fixed supports and on a truss, their
 * values against the states and samples of other modules, and what they must be where nothing differs. */
#include "built_nets.h"

#include "base/elementary.h"
#include "built/montecarlo.h"
#include "run/load_case_stage.h"
#include "run/problem_parts.h"
#include "search/residuals.h"

enum { MAX_TRIED = 3 };
#define MOVE_M 2.5e-4 /* of the node that a step moves most: differences of order 4 are off by some (MOVE_M/l)^4 */
#define AGREEMENT 1e-7

static const char all_objectives[] =
    "optimize.objective=[{figure: psi}, {figure: psi, load_case: cold}, {figure: psi, load_case: up, weight: 2}, "
    "{figure: psi, load_case: all}, {figure: psi, load_case: all, take: worst}, {figure: psi, over: samples, weight: "
    "3}, "
    "{figure: psi, over: samples, take: worst, weight: 2}, {figure: tension, set: directrix, target: 12, load_case: "
    "moved}, "
    "{figure: ratio, set: generatrix, over: samples}, {figure: pull, load_case: all, take: worst}, "
    "{figure: length, set: inner, load_case: all}, {figure: evenness, over: samples, take: worst}, "
    "{figure: gain, load_case: up}, {figure: gain, over: samples, take: worst}, "
    "{figure: psi, over: samples, load_case: all, quantile: 0.6, weight: 2}, "
    "{figure: pull, over: samples, load_case: cold, quantile: 0.5}]";

static void open_problem(hf_problem *p, bool on_truss, const char *variables, const char *objectives)
{
    const char *set[16] = {
        "nodes=[{mass_kg: 0.002}]",
        "load_cases=[{name: cold, temperature_K: -20, part: net}, {name: up, gravity_m_per_s2: 9.81}, {name: moved, "
        "support_displacement_m: [0, 0, 0.01], force_N: [0, 0, -0.01], role: inner}]",
        "tolerance.sigma_cut_ratio=1e-6",
        "tolerance.sigma_support_m=1e-5",
        "tolerance.seed=5",
        "optimize.samples=6",
        "surface.frequencies_Hz=[0.5e9]",
        "surface.pattern.n_theta=3",
        objectives,
    };
    int n = 9;
    if (on_truss) set[n++] = "truss.expansion_per_K=1e-6";
    if (on_truss)
        set[n++] = "tolerance.truss=[{part: bud, sigma_temperature_K: 5}, {part: truss, sigma_temperature_K: 3}]";
    if (objectives == all_objectives) set[n++] = "optimize.method=lm"; /* so that quantiles have derivatives */
    if (variables) set[n++] = variables;
    if (variables) set[n++] = "optimize.symmetry=none";
    open_built_problem(p, on_truss, set);
}

/* ---- derivatives ---- */

struct differed {
    hf_problem p;
    hf_sensitivity slopes;
    hf_residuals residuals;
    double *design, *exact, *gradient, *found[4];
};

static void residuals_at(struct differed *d, int i, double step, double *residual)
{
    const hf_model *m = &d->p.model;
    hf_form_result result;
    for (int k = 0; k < m->n_variable; k++)
        d->design[k] = d->p.initial[k] + (d->slopes.class_of_variable[k] == i ? step : 0);
    ck_assert_int_eq(hf_evaluate(&d->p.evaluator, d->design, &d->p.workspace, &d->p.point, &result), HF_OK);
    ck_assert_int_eq(hf_objectives_linearise(&d->p.objectives, true, &d->p.workspace, &d->p.point, residual), HF_OK);
}

static double largest_move(const struct differed *d, int i)
{
    const double *move = d->slopes.move + (size_t)i * d->slopes.n_dof;
    double most = 0;
    for (size_t k = 0; k < d->slopes.n_dof; k++)
        most = fmax(most, fabs(move[k]));
    return most;
}

/* |x - y| of the rows of a goal; y: NULL for zero. */
static double distance(const hf_objective *g, const double *x, const double *y)
{
    double square = 0;
    for (int r = g->first_row; r < g->first_row + g->n_row; r++)
        square += (x[r] - (y ? y[r] : 0)) * (x[r] - (y ? y[r] : 0));
    return sqrt(square);
}

/* Central differences over `step` and twice that, together of order 4, in found[0]. */
static void differ(struct differed *d, int i, double step)
{
    for (int k = 0; k < 4; k++)
        residuals_at(d, i, step * (k < 2 ? 1 : 2) * (k % 2 ? -1 : 1), d->found[k]);
    for (int r = 0; r < d->residuals.n_row; r++)
        d->found[0][r] = (8 * (d->found[0][r] - d->found[1][r]) - (d->found[2][r] - d->found[3][r])) / (12 * step);
}

static void open_differed(struct differed *d, bool on_truss, const char *variables, const char *objectives)
{
    hf_form_result result;
    open_problem(&d->p, on_truss, variables, objectives);
    d->p.evaluator.solver = HF_SOLVER_NEWTON;
    ck_assert_int_eq(hf_sensitivity_create(&d->p.evaluator, &d->slopes), HF_OK);
    ck_assert_int_eq(hf_residuals_create(&d->p.evaluator, &d->residuals), HF_OK);
    size_t n = (size_t)d->slopes.n, n_row = (size_t)d->residuals.n_row;
    d->design = calloc((size_t)d->p.model.n_variable + n + n * n_row + 4 * n_row, sizeof *d->design);
    ck_assert_ptr_nonnull(d->design);
    d->gradient = d->design + d->p.model.n_variable;
    d->exact = d->gradient + n;
    for (size_t k = 0; k < 4; k++)
        d->found[k] = d->exact + n * n_row + k * n_row;
    ck_assert_int_eq(hf_evaluate(&d->p.evaluator, d->p.initial, &d->p.workspace, &d->p.point, &result), HF_OK);
    ck_assert_int_eq(hf_sensitivity_find(&d->slopes, &d->p.workspace), HF_OK);
    ck_assert_int_eq(hf_residuals_find(&d->residuals, &d->p.workspace), HF_OK);
    ck_assert_int_eq(hf_residuals_rates(&d->residuals, &d->slopes, &d->p.workspace, d->exact, d->gradient), HF_OK);
}

static void close_differed(struct differed *d)
{
    hf_residuals_free(&d->residuals);
    hf_sensitivity_free(&d->slopes);
    hf_problem_free(&d->p);
    free(d->design);
}

static const char *const varied[] = {
    NULL, /* the pretensions of the boundary */
    "optimize.variables=[{set: directrix, vary: tension, range: 1}]",
    "optimize.variables=[{set: edge_tie, vary: length, range: 0.01}]",
    "optimize.variables=[{set: edge_tie, vary: support_z, range: 0.01, link: each}]",
};
/* The room and the net are there: what is asked for is the linear answer. */
START_TEST(a_net_without_memory_is_told)
{
    hf_problem p;
    hf_form_result result;
    const hf_workspace *shape;
    open_problem(&p, false, NULL, "optimize.objective=[{figure: psi, over: samples}]");
    const hf_objectives_nets *nets = p.objectives.nets;
    ck_assert_int_eq(hf_evaluate(&p.evaluator, p.initial, &p.workspace, &p.point, &result), HF_OK);
    ck_assert_int_eq(nets->cut(p.point.nets, &p.workspace), HF_OK);
    fail_allocation_at(1);
    hf_status status = hf_objectives_nets_linearise(&p.objectives, nets->n_load_case, &p.point, &shape);
    ck_assert(end_allocation_failure());
    ck_assert_int_eq(status, HF_NO_MEMORY);
    hf_problem_free(&p);
}
END_TEST

/* A load that no cable can hold. */
START_TEST(a_net_without_a_shape_is_told)
{
    hf_problem p;
    hf_form_result result;
    const hf_workspace *shape;
    open_problem(&p, false, NULL, "optimize.objective=[{figure: psi, load_case: all}]");
    const hf_objectives_nets *nets = p.objectives.nets;
    for (int i = 0; i < nets->n_load_case; i++) {
        hf_load_case *load_case = &p.load_cases.load_case[i];
        ck_assert_int_eq(hf_evaluate(&p.evaluator, p.initial, &p.workspace, &p.point, &result), HF_OK);
        ck_assert_int_eq(nets->cut(p.point.nets, &p.workspace), HF_OK);
        ck_assert_int_eq(hf_objectives_nets_linearise(&p.objectives, i, &p.point, &shape), HF_OK);
        ck_assert_ptr_nonnull(shape);
        load_case->force_N[3 * p.model.inner_row[0]] = 1e30;
        ck_assert_int_eq(hf_objectives_nets_linearise(&p.objectives, i, &p.point, &shape), HF_NOT_FINITE);
        ck_assert_ptr_null(shape);
        ck_assert_int_ne(hf_evaluate(&p.evaluator, p.initial, &p.workspace, &p.point, &result), HF_OK);
        load_case->force_N[3 * p.model.inner_row[0]] = 0;
    }
    hf_problem_free(&p);
}
END_TEST

START_TEST(derivatives_are_those_of_differences)
{
    struct differed d = {0};
    bool on_truss = _i % 2;
    open_differed(&d, on_truss, varied[_i / 2], all_objectives);
    const hf_objectives *objectives = &d.p.objectives;
    int n_row = d.residuals.n_row, stride = 1 + d.slopes.n / MAX_TRIED;
    double largest[HF_DESIGN_ROWS_MAX] = {0};
    for (int k = 0; k < objectives->n_objective; k++)
        for (int i = 0; i < d.slopes.n; i += stride)
            largest[k] = fmax(largest[k], distance(&objectives->objective[k], d.exact + (ptrdiff_t)i * n_row, NULL));
    for (int i = 0; i < d.slopes.n; i += stride) {
        differ(&d, i, MOVE_M / largest_move(&d, i));
        for (int k = 0; k < objectives->n_objective; k++) {
            double off = distance(&objectives->objective[k], d.exact + (ptrdiff_t)i * n_row, d.found[0]);
            ck_assert_msg(off <= AGREEMENT * largest[k], "%s%s, variable %d, goal %d: off by %g of %g",
                          varied[_i / 2] ? varied[_i / 2] : "pretensions", on_truss ? ", truss" : "", i, k, off,
                          largest[k]);
        }
    }
    close_differed(&d);
}
END_TEST

/* ---- values ---- */

static const char value_objectives[] =
    "optimize.objective=[{figure: psi}, {figure: psi, over: samples}, {figure: psi, over: samples, take: worst}, "
    "{figure: psi, over: samples, quantile: 0.5}, {figure: psi, load_case: cold}, {figure: psi, load_case: up}, "
    "{figure: psi, load_case: moved}, {figure: psi, load_case: all}, {figure: psi, load_case: all, take: worst}, "
    "{figure: pull, over: samples}, {figure: pull}]";

static void evaluate_base(hf_problem *p, hf_form_result *r)
{
    ck_assert_int_eq(hf_evaluate(&p->evaluator, p->initial, &p->workspace, &p->point, r), HF_OK);
}

static void assert_near(double value, double wanted)
{
    ck_assert_msg(fabs(value - wanted) <= 1e-9 * wanted, "%.17g, not %.17g", value, wanted);
}

/* The same samples by the module behind `tolerance`. */
START_TEST(values_over_samples_are_those_of_tolerances)
{
    hf_problem p;
    hf_form_result r;
    hf_built built;
    hf_montecarlo t;
    hf_messages messages = {0};
    double square = 0, psi[6], by_heat[2 * 3 * 100];
    open_problem(&p, _i, NULL, value_objectives);
    ck_assert_int_le(p.model.n_attachment, 100);
    ck_assert_int_eq(hf_load_case_stage_rest_by_heat(&p, by_heat), HF_OK);
    const hf_built_heat heat = {NULL, by_heat};
    evaluate_base(&p, &r);
    ck_assert_int_eq(hf_built_make("x.yaml", &p.scene, &p.model, &p.settings.form, &p.workspace, &built, &messages),
                     HF_OK);
    ck_assert_int_eq(hf_montecarlo_create(&p.settings.tolerance, &built, NULL, NULL, &heat, 1, &t), HF_OK);
    ck_assert_int_eq(hf_montecarlo_run(&t, 1, 0, 6), HF_OK);
    for (int i = 0; i < 6; i++) {
        double value = t.row[i * HF_TOLERANCE_COLUMNS + HF_TOLERANCE_FIRST + HF_TOLERANCE_PSI];
        int at = i;
        for (; at > 0 && psi[at - 1] > value; at--)
            psi[at] = psi[at - 1];
        psi[at] = value;
        square += value * value / 6;
    }
    assert_near(r.objective[1], sqrt(square));
    assert_near(r.objective[2], psi[5]);
    assert_near(r.objective[3], psi[2]);
    ck_assert_double_gt(psi[5], 1.00001 * psi[0]);
    hf_montecarlo_free(&t);
    hf_built_free(&built);
    hf_problem_free(&p);
}
END_TEST

/* The same states by the reference, hf_built_solve. */
START_TEST(values_of_load_cases_are_those_of_cases)
{
    hf_problem p;
    hf_form_result r, of_load_case;
    hf_load_case_stage cases = {0};
    hf_built_net net;
    hf_messages messages = {0};
    double square = 0, worst = 0, rest_m[3 * 3 * 100] = {0};
    open_problem(&p, _i, NULL, value_objectives);
    size_t n = 3 * (size_t)p.model.n_attachment;
    ck_assert_uint_le(3 * n, sizeof rest_m / sizeof *rest_m);
    if (n) ck_assert_int_eq(hf_load_case_stage_rest(&p, rest_m, NULL), HF_OK);
    evaluate_base(&p, &r);
    ck_assert_int_eq(hf_load_case_stage_take(&p, &p.workspace, &cases, &messages), HF_OK);
    for (int k = 0; k < 3; k++) {
        hf_built_load_case(&cases.built, &p.load_cases.material, &p.load_cases.load_case[k],
                           n ? rest_m + (size_t)k * n : NULL, cases.cut_m, cases.move_m, cases.load_N, &net);
        ck_assert_int_eq(hf_built_solve(&cases.built, &net, &cases.workspace, &of_load_case), HF_OK);
        assert_near(r.objective[4 + k], of_load_case.psi_m);
        ck_assert_double_gt(fabs(of_load_case.psi_m - r.objective[0]), 1e-6);
        square += of_load_case.psi_m * of_load_case.psi_m / 3;
        worst = fmax(worst, of_load_case.psi_m);
    }
    assert_near(r.objective[7], sqrt(square));
    assert_near(r.objective[8], worst);
    hf_load_case_stage_free(&cases);
    hf_problem_free(&p);
}
END_TEST

static void forget_errors(hf_problem *p)
{
    hf_tolerance_settings *t = &p->settings.tolerance;
    t->sigma_cut_m = t->sigma_cut_ratio = t->sigma_EA_ratio = t->sigma_support_m = 0;
    t->n_truss = 0;
}

/* Without errors, and in states in which nothing is different, every net is the design. */
START_TEST(nets_that_do_not_differ_are_the_design)
{
    hf_problem p;
    hf_form_result r;
    open_problem(&p, _i, NULL, value_objectives);
    forget_errors(&p);
    for (int k = 0; k < p.load_cases.n; k++) {
        hf_load_case *s = &p.load_cases.load_case[k];
        memset(s->rise_K, 0, (size_t)p.model.n_cable * sizeof(double));
        memset(s->force_N, 0, 3 * (size_t)p.model.n_node * sizeof(double));
        memset(s->support_displacement_m, 0, 3 * (size_t)p.model.n_node * sizeof(double));
        memset(s->gravity_m_per_s2, 0, sizeof s->gravity_m_per_s2);
    }
    evaluate_base(&p, &r);
    for (int k = 1; k < 9; k++) /* on a truss its own weight has moved the attachments of state `up` before */
        if (k < 4 || p.model.n_attachment == 0) assert_near(r.objective[k], r.objective[0]);
    assert_near(r.objective[9], r.objective[10]);
    hf_problem_free(&p);
}
END_TEST

static const char sampled_objectives[] =
    "optimize.objective=[{figure: psi, over: samples, load_case: up}, {figure: psi, over: samples, load_case: moved}, "
    "{figure: psi, over: samples, load_case: all, take: worst}, {figure: psi, over: samples, load_case: all, quantile: "
    "0.6}, {figure: psi, load_case: up}, {figure: psi, load_case: moved}, {figure: psi, load_case: all, take: worst}, "
    "{figure: psi}]";

/* Without errors, the samples in a load case are the load case. */
START_TEST(samples_in_load_cases_without_errors)
{
    hf_problem p;
    hf_form_result r;
    open_problem(&p, _i, NULL, sampled_objectives);
    forget_errors(&p);
    evaluate_base(&p, &r);
    assert_near(r.objective[0], r.objective[4]);
    assert_near(r.objective[1], r.objective[5]);
    assert_near(r.objective[2], fmax(r.objective[6], r.objective[7]));
    assert_near(r.objective[3], r.objective[2]);
    hf_problem_free(&p);
}
END_TEST

/* The quantile and, as merit where derivatives are needed, the mean of the worst samples, from the values of the nets.
 * A sample has its largest value of all load cases. */
START_TEST(quantiles_over_load_cases)
{
    enum { N = 6, N_STATE = 4 }; /* the nominal load case and three others */
    static const char *const method[] = {"optimize.method=ga", "optimize.method=lm"};
    static const double quantile[] = {0.4, 0.6, 0.95};
    hf_problem p;
    hf_form_result r;
    char objective[200];
    double q = quantile[_i / 2], worst[N] = {0}, tail = 0, left = fmax(1, (1 - q) * N);
    bool is_lm = _i % 2;
    snprintf(objective, sizeof objective,
             "optimize.objective=[{figure: psi, over: samples, load_case: all, quantile: %g}]", q);
    open_problem(&p, false, method[is_lm], objective);
    evaluate_base(&p, &r);
    ck_assert_int_eq(hf_objectives_nets_count(p.objectives.nets), 3 + N_STATE * N);
    for (int s = 0; s < N_STATE * N; s++)
        worst[s % N] = fmax(worst[s % N], p.point.net_value[3 + s]);
    qsort(worst, N, sizeof *worst, hf_compare_doubles);
    for (int i = N - 1; i >= 0 && left > 0; i--, left--)
        tail += worst[i] * fmin(1, left) / fmax(1, (1 - q) * N);
    ck_assert_double_gt(worst[N - 1], 1.00001 * worst[0]);
    assert_near(r.objective[0], worst[(int)ceil(q * N) - 1]);
    assert_near(r.merit, is_lm ? tail : r.objective[0]);
    hf_problem_free(&p);
}
END_TEST

/* A design is judged alike after any other, and by any room. */
START_TEST(values_do_not_depend_on_earlier_designs)
{
    hf_problem p;
    hf_form_result first, other, again;
    open_problem(&p, _i, NULL, value_objectives);
    evaluate_base(&p, &first);
    double *design = malloc((size_t)p.model.n_variable * sizeof *design);
    ck_assert_ptr_nonnull(design);
    for (int k = 0; k < p.model.n_variable; k++)
        design[k] = p.initial[k] * (1 + 0.02 * (k % 5));
    ck_assert_int_eq(hf_evaluate(&p.evaluator, design, &p.workspace, &p.point, &other), HF_OK);
    evaluate_base(&p, &again);
    ck_assert_mem_eq(first.objective, again.objective, sizeof first.objective);
    hf_batch_run_one(&p.batch, design, &again); /* by chord, in another workspace */
    for (int k = 0; k < p.objectives.n_objective; k++)
        ck_assert_msg(fabs(again.objective[k] - other.objective[k]) <= 1e-8 * other.objective[k], "goal %d: %g and %g",
                      k, again.objective[k], other.objective[k]);
    free(design);
    hf_problem_free(&p);
}
END_TEST

Suite *suite_unit_built_nets(void)
{
    Suite *suite = suite_create("unit/built/built_nets");
    TCase *tcase = tcase_create("built_nets");
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, derivatives_are_those_of_differences, 0, 2 * (int)(sizeof varied / sizeof *varied));
    tcase_add_test(tcase, a_net_without_memory_is_told);
    tcase_add_test(tcase, a_net_without_a_shape_is_told);
    tcase_add_loop_test(tcase, values_over_samples_are_those_of_tolerances, 0, 2);
    tcase_add_loop_test(tcase, values_of_load_cases_are_those_of_cases, 0, 2);
    tcase_add_loop_test(tcase, nets_that_do_not_differ_are_the_design, 0, 2);
    tcase_add_loop_test(tcase, samples_in_load_cases_without_errors, 0, 2);
    tcase_add_loop_test(tcase, quantiles_over_load_cases, 0, 6);
    tcase_add_loop_test(tcase, values_do_not_depend_on_earlier_designs, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
