/* The paper's iteration in lanes gives the results of the scalar code, whichever designs share a pass. */
#include "population.h"

#include <hifdm/batch.h>

static void open_designs(struct run *r, int rule, double range_N)
{
    OPEN_CASE(&r->net, SMALL_REFLECTOR);
    draw_designs(r, 7, range_N);
    for (int i = 0; i < N_DESIGN * r->net.model.n_variable; i++)
        r->design[i] = fmax(0.05, r->design[i]);
    evaluate_by(r, rule, HF_SOLVER_FIXED_POINT);
}

static void evaluate(struct run *r, int n_thread, int backwards, hf_form_result result[N_DESIGN])
{
    hf_batch batch;
    unsigned char pending[N_DESIGN];
    ck_assert_int_eq(hf_batch_create(&r->evaluator, n_thread, &batch), HF_OK);
    ck_assert_int_eq(hf_batch_share(&batch, r->design), HF_SOLVER_FIXED_POINT);
    if (!backwards) hf_batch_run(&batch, N_DESIGN, r->design, NULL, result);
    for (int i = N_DESIGN - 1; backwards && i >= 0; i--) { /* one by one, the last first */
        memset(pending, 0, sizeof pending);
        pending[i] = 1;
        hf_batch_run(&batch, N_DESIGN, r->design, pending, result);
    }
    hf_batch_free(&batch);
}

/* Status and iterations are those of the scalar code. Measures differ by roundoff, which does not grow over some
 * hundred iterations because they contract: 1e-9 of their size is allowed. */
START_TEST(results_are_those_of_the_scalar_code)
{
    struct run r;
    hf_form_result result[N_DESIGN], alone;
    open_designs(&r, _i % 3, _i < 3 ? 0.5 : 9); /* the wide range includes designs without a shape */
    r.net.form.residual_tolerance = 1e-7;
    r.net.form.max_iterations = 3000;
    evaluate(&r, 2, 0, result);
    for (int i = 0; i < N_DESIGN; i++) {
        hf_evaluate(&r.evaluator, r.design + i * r.net.model.n_variable, &r.net.work, NULL, &alone);
        ck_assert_int_eq(result[i].status, alone.status);
        ck_assert_int_eq(result[i].stop_reason, alone.stop_reason);
        ck_assert_int_le(abs(result[i].iterations - alone.iterations), 1);
        if (alone.status != HF_OK) {
            ck_assert(isnan(result[i].psi_m));
            continue;
        }
        if (result[i].iterations != alone.iterations) continue; /* roundoff at the threshold */
        ck_assert_double_eq_tol(result[i].psi_m, alone.psi_m, 1e-9 * alone.psi_m);
        ck_assert_double_eq_tol(result[i].boundary_tension_ratio, alone.boundary_tension_ratio, 1e-9);
        ck_assert_double_eq_tol(result[i].residual_N, alone.residual_N, 1e-9);
    }
    close_net(&r.net);
}
END_TEST

/* Lanes that run out of iterations ask the path whether the design has a shape, as the scalar code does: of the designs
 * under rule tension some collapse, later than after 20 iterations. */
START_TEST(designs_without_a_shape_are_named_before_they_get_there)
{
    struct run r;
    hf_form_result result[N_DESIGN], alone;
    int n_collapsed = 0;
    open_designs(&r, HF_RULE_TENSION, 9);
    r.net.form.residual_tolerance = 1e-10;
    r.net.form.max_iterations = 20;
    evaluate(&r, 2, 0, result);
    for (int i = 0; i < N_DESIGN; i++) {
        hf_evaluate(&r.evaluator, r.design + i * r.net.model.n_variable, &r.net.work, NULL, &alone);
        ck_assert_int_eq(result[i].status, alone.status);
        ck_assert_int_eq(result[i].stop_reason, alone.stop_reason);
        ck_assert_int_eq(result[i].iterations, alone.iterations);
        n_collapsed += alone.status == HF_COLLAPSED && alone.iterations > 20;
    }
    ck_assert_int_gt(n_collapsed, 0);
    close_net(&r.net);
}
END_TEST

START_TEST(neighbours_and_threads_do_not_change_a_bit)
{
    struct run r;
    hf_form_result result[N_DESIGN], other[N_DESIGN];
    open_designs(&r, _i, 0.5);
    r.net.form.residual_tolerance = 1e-7;
    evaluate(&r, 1, 0, result);
    for (int k = 0; k < 3; k++) {
        evaluate(&r, k == 0 ? 1 : k == 1 ? 2 : 5, k == 0, other);
        for (int i = 0; i < N_DESIGN; i++) {
            ck_assert_int_eq(result[i].status, other[i].status);
            ck_assert_int_eq(result[i].iterations, other[i].iterations);
            ck_assert_mem_eq(&result[i].psi_m, &other[i].psi_m, sizeof(double));
            ck_assert_mem_eq(&result[i].residual_N, &other[i].residual_N, sizeof(double));
        }
    }
    close_net(&r.net);
}
END_TEST

/* Another base, and no designs at all. */
START_TEST(a_batch_may_share_again_and_be_empty)
{
    struct run r;
    hf_batch batch;
    hf_form_result result;
    open_designs(&r, HF_RULE_FORCE_DENSITY, 0.5);
    r.evaluator.solver = HF_SOLVER_AUTO;
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 2, &batch), HF_OK);
    ck_assert_int_eq(hf_batch_share(&batch, r.design), HF_SOLVER_CHORD);
    ck_assert_int_eq(hf_batch_share(&batch, r.design + r.net.model.n_variable), HF_SOLVER_CHORD);
    hf_batch_run(&batch, 0, NULL, NULL, NULL);
    hf_batch_run(&batch, 1, r.design, NULL, &result);
    ck_assert_int_eq(result.status, HF_OK);
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

Suite *suite_unit_swarm(void)
{
    Suite *suite = suite_create("unit/swarm");
    TCase *tests = tcase_create("swarm");
    tcase_add_loop_test(tests, results_are_those_of_the_scalar_code, 0, 6);
    tcase_add_test(tests, designs_without_a_shape_are_named_before_they_get_there);
    tcase_add_loop_test(tests, neighbours_and_threads_do_not_change_a_bit, 0, 3);
    tcase_add_test(tests, a_batch_may_share_again_and_be_empty);
    suite_add_tcase(suite, tests);
    return suite;
}
