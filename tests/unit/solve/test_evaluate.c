/* Evaluation of a design under the three rules: its bounds, and that the result does not depend on what the workspace
 * held before. */
#include "population.h"

#include "solve/limits.h"

/* The small reflector, form-found to 1e-10; the design is its boundary pretensions. */
static void open_design(struct run *r, int rule)
{
    OPEN_CASE(&r->net, SMALL_REFLECTOR, "form.residual_tolerance=1e-10", "form.length_tolerance=1e-10");
    draw_designs(r, 1, 0);
    evaluate_by(r, rule, HF_SOLVER_AUTO);
}

static void disturb(struct run *r, double range_N)
{
    struct rng rng = rng_start(17);
    for (int k = 0; k < r->net.model.n_variable; k++)
        r->design[k] = r->initial[k] + rng_uniform(&rng, -range_N, range_N);
}

static hf_status evaluate(struct run *r, hf_form_result *result)
{
    return hf_evaluate(&r->evaluator, r->design, &r->net.work, NULL, result);
}

/* The converged HIFDM shape is the equilibrium of its own tensions, whatever holds them: q T/l is the same in all
 * three. Both were found to 1e-10 of the residual; what that means in position is its ratio to the net's stiffness:
 * below 1e-6 m of some 0.01 m is measured and held. */
START_TEST(base_design_gives_back_the_found_shape)
{
    struct run r;
    hf_form_result result;
    open_design(&r, _i);
    ck_assert_int_eq(evaluate(&r, &result), HF_OK);
    if (_i == HF_RULE_SEEDED)
        ck_assert_double_eq_tol(result.psi_m, r.net.result.psi_m, 1e-4); /* stops early */
    else
        ck_assert_double_eq_tol(result.psi_m, r.net.result.psi_m, 1e-8);
    close_net(&r.net);
}
END_TEST

START_TEST(force_density_rule_holds_q)
{
    struct run r;
    hf_form_result result;
    open_design(&r, HF_RULE_FORCE_DENSITY);
    disturb(&r, 1);
    ck_assert_int_eq(evaluate(&r, &result), HF_OK);
    const hf_model *m = &r.net.model;
    for (int k = 0; k < m->n_variable; k++) {
        int e = m->variable_cable[k];
        ck_assert_double_eq(r.net.work.q_N_per_m[e], r.design[k] / m->target[e]); /* T'/L*, held: no roundoff */
    }
    for (int e = 0; e < m->n_cable; e++)
        if (m->group[e] == HF_GROUP_INNER) ck_assert_double_eq_tol(r.net.work.tension_N[e], 10, 1e-7);
    ck_assert_int_eq(result.stop_reason, HF_STOPPED_CONVERGED);
    close_net(&r.net);
}
END_TEST

/* L* is what the cable was cut to, not the theoretical length, where the two differ. */
START_TEST(prescribed_lengths_count)
{
    struct run r;
    hf_form_result result;
    open_design(&r, HF_RULE_FORCE_DENSITY);
    const hf_model *m = &r.net.model;
    for (int k = 0; k < m->n_variable; k++)
        m->target[m->variable_cable[k]] *= 1.0625;
    ck_assert_int_eq(evaluate(&r, &result), HF_OK);
    for (int k = 0; k < m->n_variable; k++) {
        int e = m->variable_cable[k];
        ck_assert_double_eq(r.net.work.q_N_per_m[e], r.design[k] / (1.0625 * m->length_m[e]));
    }
    close_net(&r.net);
}
END_TEST

START_TEST(tension_rule_holds_tensions)
{
    struct run r;
    hf_form_result result;
    open_design(&r, HF_RULE_TENSION);
    disturb(&r, 0.01); /* small: equilibrium must exist */
    ck_assert_int_eq(evaluate(&r, &result), HF_OK);
    const hf_model *m = &r.net.model; /* residual 1e-10 of 10 N: the tensions are far closer than 1e-6 */
    for (int k = 0; k < m->n_variable; k++)
        ck_assert_double_eq_tol(r.net.work.tension_N[m->variable_cable[k]], r.design[k], 1e-6);
    close_net(&r.net);
}
END_TEST

/* The literal reading of the paper: first force densities T'/L*, inner ones as at the theoretical shape, Eqs. 7 and 8,
 * stopped by the change of psi. Done here step by step with the same solver: the same bits. */
START_TEST(seeded_rule_is_the_papers_iteration)
{
    struct run r;
    hf_form_result result, expected;
    open_design(&r, HF_RULE_SEEDED);
    disturb(&r, 1);
    ck_assert_int_eq(evaluate(&r, &result), HF_OK);
    const hf_model *m = &r.net.model;
    hf_form_prepare(m, &r.net.work);
    for (int k = 0; k < m->n_variable; k++)
        r.net.work.q_N_per_m[m->variable_cable[k]] = r.design[k] / m->target[m->variable_cable[k]];
    ck_assert_int_eq(hf_form_find(m, &r.net.form, HF_STOP_RMS_CHANGE, &r.net.work, NULL, &expected), HF_OK);
    ck_assert_int_eq(result.stop_reason, HF_STOPPED_RMS_CHANGE);
    ck_assert_int_eq(result.iterations, expected.iterations);
    ck_assert_double_eq(result.psi_m, expected.psi_m);
    close_net(&r.net);
}
END_TEST

/* A strictly convex problem has one answer: the start, here 10 times too stiff or soft per cable, changes nothing
 * beyond the tolerance. */
START_TEST(force_density_rule_does_not_depend_on_the_start)
{
    struct run r;
    hf_form_result result, other;
    open_design(&r, HF_RULE_FORCE_DENSITY);
    disturb(&r, 1);
    ck_assert_int_eq(evaluate(&r, &result), HF_OK);
    struct rng rng = rng_start(18);
    for (int e = 0; e < r.net.model.n_cable; e++)
        r.start_q[e] *= exp(rng_uniform(&rng, -2.3, 2.3));
    ck_assert_int_eq(evaluate(&r, &other), HF_OK);
    ck_assert_double_eq_tol(result.psi_m, other.psi_m, 1e-8);
    close_net(&r.net);
}
END_TEST

START_TEST(ratio_above_the_cap_is_infeasible)
{
    struct run r;
    hf_form_result result;
    open_design(&r, HF_RULE_FORCE_DENSITY);
    disturb(&r, 3);
    ck_assert_int_eq(evaluate(&r, &result), HF_OK);
    double ratio = result.boundary_tension_ratio, psi_m = result.psi_m;
    ck_assert_double_gt(ratio, 1);
    r.evaluator.boundary_ratio_cap = ratio;
    ck_assert_int_eq(evaluate(&r, &result), HF_OK);
    ck_assert_double_eq(result.psi_m, psi_m);
    ck_assert_double_eq(result.violation, 0);
    r.evaluator.boundary_ratio_cap = 0.999 * ratio;
    ck_assert_int_eq(evaluate(&r, &result), HF_RATIO_CAP);
    ck_assert_int_eq(result.status, HF_RATIO_CAP);
    ck_assert_double_nan(result.psi_m);
    ck_assert_double_eq(result.boundary_tension_ratio, ratio);
    ck_assert(result.violation > 0 && result.violation < 0.002); /* the ratio is 1/1000 above, by two cables or few */
    close_net(&r.net);
}
END_TEST

/* One boundary pretension far above what its neighbours can balance: no equilibrium under the rule tension. */
START_TEST(impossible_designs_are_a_status_not_a_number)
{
    struct run r;
    hf_form_result result;
    open_design(&r, HF_RULE_TENSION);
    r.design[0] = 50 * r.initial[0];
    ck_assert_int_eq(evaluate(&r, &result), HF_COLLAPSED);
    ck_assert_double_nan(result.psi_m);
    close_net(&r.net);
}
END_TEST

START_TEST(not_converged_has_no_psi)
{
    struct run r;
    hf_form_result result;
    open_design(&r, HF_RULE_FORCE_DENSITY);
    disturb(&r, 1);
    r.net.form.max_iterations = 2;
    ck_assert_int_eq(evaluate(&r, &result), HF_NOT_CONVERGED);
    ck_assert_double_nan(result.psi_m); /* it must not compete with converged ones */
    close_net(&r.net);
}
END_TEST

/* Bits must not depend on what the workspace was used for before: NaN, or another design that failed. */
START_TEST(stale_workspace_gives_the_same_bits)
{
    struct run r;
    hf_form_result first, second;
    open_design(&r, _i);
    disturb(&r, 0.01);
    poison_workspace(&r.net.model, &r.net.work);
    evaluate(&r, &first);
    size_t bytes = 3 * (size_t)r.net.model.n_node * sizeof(double);
    double *shape = malloc(bytes), kept = r.design[0];
    ck_assert_ptr_nonnull(shape);
    memcpy(shape, r.net.work.position_m, bytes);
    r.design[0] *= 50;
    evaluate(&r, &second);
    r.design[0] = kept;
    evaluate(&r, &second);
    ck_assert_int_eq(first.iterations, second.iterations);
    ck_assert_double_eq(first.psi_m, second.psi_m);
    ck_assert_double_eq(first.residual_N, second.residual_N);
    ck_assert_mem_eq(shape, r.net.work.position_m, bytes);
    free(shape);
    close_net(&r.net);
}
END_TEST

START_TEST(nothing_is_allocated)
{
    struct run r;
    hf_form_result result;
    open_design(&r, _i);
    long before = allocation_count();
    evaluate(&r, &result);
    ck_assert_int_eq(allocation_count(), before);
    close_net(&r.net);
}
END_TEST

/* Each value of a row counts, the first and the last as well, and values within the bounds count nothing. */
START_TEST(each_value_beyond_a_limit_counts)
{
    enum { N = 3 };
    double tension_N[N], displacement_m[3 * N] = {0};
    int cable[N] = {2, 0, 1};
    const hf_model m = {.n_attachment = N, .reference_N = 10};
    const hf_workspace w = {.tension_N = tension_N, .displacement_m = displacement_m};
    hf_limit row[] = {{.kind = HF_LIMIT_TENSION, .n_cable = N, .cable = cable, .lower = 5, .upper = 20},
                      {.kind = HF_LIMIT_DEFLECTION, .lower = 0, .upper = 0.01}};
    const hf_limits limits = {.n = 2, .row = row};
    const hf_evaluator v = {.model = &m, .limits = &limits, .boundary_ratio_cap = INFINITY};
    double beyond[2 * N], all = 0;
    for (int i = -1; i < 2 * N; i++) { /* -1: none is beyond */
        for (int k = 0; k < N; k++) {
            tension_N[k] = i == k ? 20 + 3.0 * (k + 1) : 6 + k;
            displacement_m[3 * k + k] = i == N + k ? -0.02 * (k + 1) : 0.009;
        }
        if (i < 0)
            ck_assert_double_eq(hf_limits_violation(&v, &w), 0);
        else
            all += beyond[i] = hf_limits_violation(&v, &w);
    }
    for (int k = 0; k < N; k++) {
        ck_assert_double_eq_tol(beyond[k], 0.3 * (k + 1), 1e-12);         /* of the reference tension */
        ck_assert_double_eq_tol(beyond[N + k], 2.0 * (k + 1) - 1, 1e-12); /* of the limit */
        tension_N[k] = 20 + 3.0 * (k + 1);
        displacement_m[3 * k + k] = -0.02 * (k + 1);
    }
    ck_assert_double_eq_tol(hf_limits_violation(&v, &w), all, 1e-12);
}
END_TEST

Suite *suite_unit_evaluate(void)
{
    Suite *suite = suite_create("unit/evaluate");
    TCase *tests = tcase_create("evaluate");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, base_design_gives_back_the_found_shape, 0, 3);
    tcase_add_test(tests, force_density_rule_holds_q);
    tcase_add_test(tests, prescribed_lengths_count);
    tcase_add_test(tests, tension_rule_holds_tensions);
    tcase_add_test(tests, seeded_rule_is_the_papers_iteration);
    tcase_add_test(tests, force_density_rule_does_not_depend_on_the_start);
    tcase_add_test(tests, ratio_above_the_cap_is_infeasible);
    tcase_add_test(tests, each_value_beyond_a_limit_counts);
    tcase_add_test(tests, impossible_designs_are_a_status_not_a_number);
    tcase_add_test(tests, not_converged_has_no_psi);
    tcase_add_loop_test(tests, stale_workspace_gives_the_same_bits, 0, 3);
    tcase_add_loop_test(tests, nothing_is_allocated, 0, 3);
    return suite;
}
