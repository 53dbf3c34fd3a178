/* What a result claims, on random nets of all laws, on rigid supports and on trusses, stopped at sixteen places by all
 * methods: bounds are never below the error, and nothing is called converged that is not. */
#include "../../bounds.h"

START_TEST(bounds_are_never_below_the_error)
{
    hold_bounds(4000, 96, false, 0.4, 10);
}
END_TEST

START_TEST(bounds_on_trusses_are_never_below_the_error)
{
    hold_bounds(5000, 96, true, 0.3, 10);
}
END_TEST

/* The same without the oracle: the answer is the library's own, to the smallest tolerances. */
START_TEST(errors_on_trusses_are_within_the_bounds)
{
    enum { N_NET = 50 };
    int n_compared = 0;
    for (int k = 0; k < N_NET; k++) {
        struct rng rng = rng_start(6000 + (uint64_t)(N_NET * _i + k));
        struct net net;
        open_kind(&rng, k % BOUND_KINDS, &net);
        attach_some_way(&net, &rng, k);
        set_stop(BOUND_STOPS - 1, &net.form);
        hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result);
        double own_m = net.result.position_bound_m, *answer = copy_positions(&net.model, &net.work);
        for (int stop = 0; stop < BOUND_STOPS - 1 && !isnan(own_m); stop++) {
            set_stop(stop, &net.form);
            hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result);
            if (net.result.bound_reason != HF_BOUND_CERTIFIED) continue;
            double error_m = largest_move_m(&net.model, net.work.position_m, answer);
            ck_assert_msg(error_m <= net.result.position_bound_m + own_m, "net %d, stop %d: %g m, bound %g m", k, stop,
                          error_m, net.result.position_bound_m);
            n_compared++;
        }
        free(answer);
        close_net(&net);
    }
    ck_assert_int_ge(n_compared, 300);
}
END_TEST

/* The rounding of forces and of the positions of attachments, beside the tolerances. */
static void check_claim(const struct net *net, int k, int stop)
{
    const hf_form_result *r = &net->result;
    const hf_model *m = &net->model;
    struct verified v = verify_shape(m, &net->work, net->work.law, net->work.target);
    double pull_N = r->residual_N / r->backward_error, tolerance = net->form.residual_tolerance;
    if (!isfinite(pull_N)) pull_N = 0;
    ck_assert_msg(v.residual_N <= 1.01 * tolerance * m->reference_N + 1e-13 * pull_N, "net %d, stop %d: %g N of %g", k,
                  stop, v.residual_N, m->reference_N);
    ck_assert_msg(v.length_gap <= 1.01 * net->form.length_tolerance + 1e-14, "net %d, stop %d: lengths off by %g", k,
                  stop, v.length_gap);
    ck_assert_double_ge(v.least_tension_N, -1e-12 * m->reference_N);
    ck_assert_msg(v.truss_m <= 1.01 * net->form.coupling.tof_m + 1e-14, "net %d, stop %d: attachments off by %g m", k,
                  stop, v.truss_m);
}

/* Nothing is called converged whose forces, lengths and attachments do not obey the tolerances when they are computed
 * anew, and a shape with loose or drifting nodes has neither a position error nor a bound. */
START_TEST(what_converged_obeys_its_tolerances)
{
    enum { N_NET = 24 };
    int n_converged = 0, n_other = 0;
    for (int k = 0; k < N_NET; k++) {
        struct rng rng = rng_start(7000 + (uint64_t)(N_NET * _i + k));
        struct net net;
        open_kind(&rng, k % BOUND_KINDS, &net);
        if (_i % 2) attach_some_way(&net, &rng, k);
        for (int stop = 0; stop < BOUND_STOPS; stop++) {
            const hf_form_result *r = &net.result;
            set_stop(stop, &net.form);
            hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result);
            bool is_converged = r->status == HF_OK;
            *(is_converged ? &n_converged : &n_other) += 1;
            if (is_converged) check_claim(&net, k, stop);
            if (r->n_loose || r->n_drifting || !(is_converged || r->status == HF_NOT_CONVERGED)) {
                ck_assert_double_nan(r->position_error_m);
                ck_assert_double_nan(r->position_bound_m);
                ck_assert_double_nan(r->psi_bound_m);
                ck_assert_int_ne(r->bound_reason, HF_BOUND_CERTIFIED);
            }
        }
        close_net(&net);
    }
    ck_assert_int_ge(n_converged, 100);
    ck_assert_int_ge(n_other, 50);
}
END_TEST

Suite *suite_property_bound(void)
{
    Suite *suite = suite_create("property/solve/bound");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 300);
    tcase_add_test(tests, bounds_are_never_below_the_error);
    tcase_add_test(tests, bounds_on_trusses_are_never_below_the_error);
    tcase_add_loop_test(tests, errors_on_trusses_are_within_the_bounds, 0, 4);
    tcase_add_loop_test(tests, what_converged_obeys_its_tolerances, 0, 4);
    suite_add_tcase(suite, tests);
    return suite;
}
