/* Derivatives of psi, goals and merit by each gene, against differences of hf_evaluate. */
#include "support.h"

#include "search/jacobian.h"
#include "search/refine.h"
#include <hifdm/problem.h>
#include <stdlib.h>

#define SMALL                                                                                                          \
    "scene.parabolic_cylinder.modules=[2, 2]", "scene.parabolic_cylinder.aperture_m=2",                                \
        "scene.parabolic_cylinder.length_m=2", "form.residual_tolerance=1e-12", "form.length_tolerance=1e-12"
#define N_SET 14

static const struct {
    const char *set[N_SET];
    double step;      /* of differences: m of supports, else a part of the value */
    double tolerance; /* of the largest of a figure. Lengths are met to 1e-13, which is noise in differences */
} of[] = {
    {{SMALL, "optimize.rule=force_density"}, 1e-3, 1e-7},
    {{SMALL, "optimize.rule=tension", "optimize.symmetry=xy"}, 3e-5, 1e-7},
    {{SMALL,
      "optimize.variables=[{set: boundary, vary: tension, range: 30 %, link: set}, {set: inner, vary: force_density, "
      "range: 30 %}, {set: boundary, vary: support_xyz, range: 0.1}]",
      "optimize.objective=[{figure: psi, weight: 3}, {figure: tension, set: boundary, target: 11, weight: 0.1}, "
      "{figure: "
      "evenness, "
      "set: inner}, {figure: length, set: inner, weight: 20}, {figure: mass, mass_kg_per_m: 0.01}, {figure: pull, "
      "weight: "
      "0.01}]"},
     1e-4,
     1e-7},
#define ON_TRUSS                                                                                                       \
    "optimize.objective=[{figure: surface, feed: refocused}, {figure: facets, along: half_path, weight: 2}, {figure: " \
    "deflection, "                                                                                                     \
    "weight: 10}]",                                                                                                    \
        "truss.depth_m=1", "coupling.tof_m=1e-12"
    {{SMALL, "optimize.variables=[{set: boundary, vary: length, range: 1 %}]", ON_TRUSS, "form.length_tolerance=1e-13",
      "form.residual_tolerance=1e-13"},
     1e-3,
     1e-6},
    {{SMALL,
      "optimize.variables=[{set: boundary, vary: force_density, range: 10 %}, {set: boundary, vary: support_xyz, "
      "range: 0.1}]",
      "optimize.objective=[{figure: gain}, {figure: gain, frequency_Hz: 2e9, weight: 2}, {figure: psi}]",
      "surface.frequencies_Hz=[0.8e9]", "surface.pattern.n_theta=3", "truss.depth_m=1", "coupling.tof_m=1e-12"},
     3e-4,
     1e-7},
    {{SMALL,
      "optimize.variables=[{set: inner, vary: tension, range: 1 %}, {set: boundary, vary: force_density, range: 10 %}, "
      "{set: boundary, vary: support_normal, range: 0.1}]",
      ON_TRUSS},
     1e-4,
     1e-7},
};
enum { N_OF = sizeof of / sizeof *of };

static void open_problem(hf_problem *p, int i)
{
    hf_messages messages = {0};
    int n = 0;
    while (n < N_SET && of[i].set[n])
        n++;
    hf_status status = hf_problem_open(source_path("configs/reflector.yaml"), of[i].set, n, 1, p, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    hf_messages_free(&messages);
}

/* The figures of a design: psi, or its goals and its merit. Where the merit has another norm of a goal than its value,
 * the value is left out. */
static void measure(hf_problem *p, const double *design, double *figure)
{
    hf_form_result r;
    int n_objective = p->objectives.n_objective;
    ck_assert_int_eq(hf_evaluate(&p->evaluator, design, &p->workspace, &p->point, &r), HF_OK);
    for (int k = 0; k < n_objective; k++)
        figure[k] = r.objective[k];
    figure[n_objective] = r.merit;
}

static bool is_smooth(const hf_problem *p, int i)
{
    hf_figure_kind kind = i < p->objectives.n_objective ? p->objectives.objective[i].settings.figure : HF_FIGURE_PSI;
    return kind != HF_FIGURE_PULL && kind != HF_FIGURE_DEFLECTION;
}

/* Central differences of fourth order. */
static void difference(hf_problem *p, double *design, int k, double step, double *slope)
{
    static const double at[4] = {-2, -1, 1, 2}, weight[4] = {1, -8, 8, -1};
    double kept = design[k], figure[HF_DESIGN_ROWS_MAX + 1];
    for (int i = 0; i <= p->objectives.n_objective; i++)
        slope[i] = 0;
    for (int q = 0; q < 4; q++) {
        design[k] = kept + at[q] * step;
        measure(p, design, figure);
        for (int i = 0; i <= p->objectives.n_objective; i++)
            slope[i] += weight[q] * figure[i] / (12 * step);
    }
    design[k] = kept;
}

START_TEST(derivatives_are_those_of_differences)
{
    hf_problem p;
    hf_jacobian j;
    struct rng rng = rng_start((uint64_t)_i);
    double slope[HF_DESIGN_ROWS_MAX + 1], figure[HF_DESIGN_ROWS_MAX + 1], largest[HF_DESIGN_ROWS_MAX + 1] = {0};
    open_problem(&p, _i);
    ck_assert(hf_refine_applies(&p.evaluator));
    ck_assert_int_eq(hf_jacobian_create(&p.evaluator, &j), HF_OK);
    int n = p.model.n_variable, n_figure = p.objectives.n_objective + 1;
    ck_assert_int_eq(j.n_figure, n_figure);
    double *derivative = malloc(sizeof *derivative * (size_t)(n_figure * n)), *design = p.initial;
    ck_assert(derivative && n > 0);
    for (int k = 0; k < n; k++)
        design[k] = p.model.variable_cable[k] < 0 ? rng_uniform(&rng, -0.01, 0.01)
                                                  : design[k] * rng_uniform(&rng, 0.999, 1.001);
    measure(&p, design, figure);
    ck_assert_int_eq(hf_jacobian_find(&j, &p.workspace, derivative), HF_OK);
    for (int i = 0; i < n_figure * n; i++)
        largest[i / n] = fmax(largest[i / n], fabs(derivative[i]));
    for (int k = 0; k < n; k++) {
        difference(&p, design, k, p.model.variable_cable[k] < 0 ? of[_i].step : of[_i].step * design[k], slope);
        for (int i = 0; i < n_figure; i++) {
            if (is_smooth(&p, i))
                ck_assert_double_eq_tol(derivative[i * n + k], slope[i], of[_i].tolerance * largest[i]);
        }
    }
    free(derivative);
    hf_jacobian_free(&j);
    hf_problem_free(&p);
}
END_TEST

/* At a value of 0 a norm has no derivative. */
START_TEST(a_objective_that_is_met_has_no_derivative)
{
    hf_problem p;
    hf_jacobian j;
    hf_form_result r;
    hf_messages messages = {0};
    const char *const set[] = {SMALL, "optimize.objective=[{figure: psi}, {figure: mass, mass_kg_per_m: 1e-170}]"};
    hf_status status = hf_problem_open(source_path("configs/reflector.yaml"), set, 6, 1, &p, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    ck_assert_int_eq(hf_jacobian_create(&p.evaluator, &j), HF_OK);
    double derivative[3 * 64];
    int n = p.model.n_variable;
    ck_assert_int_le(n, 64);
    ck_assert_int_eq(hf_evaluate(&p.evaluator, p.initial, &p.workspace, &p.point, &r), HF_OK);
    ck_assert_int_eq(hf_jacobian_find(&j, &p.workspace, derivative), HF_OK);
    for (int k = 0; k < n; k++) {
        ck_assert(isfinite(derivative[k]) && isnan(derivative[n + k]));
        ck_assert_double_eq_tol(derivative[2 * n + k], derivative[k], 1e-12 * fabs(derivative[k]));
    }
    hf_jacobian_free(&j);
    hf_problem_free(&p);
}
END_TEST

Suite *suite_unit_jacobian(void)
{
    Suite *suite = suite_create("unit/jacobian");
    TCase *tests = tcase_create("jacobian");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, derivatives_are_those_of_differences, 0, N_OF);
    tcase_add_test(tests, a_objective_that_is_met_has_no_derivative);
    return suite;
}
