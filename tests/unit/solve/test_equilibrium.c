/* The paper's iteration under the verdict of the path: a shape on the way is no reason to refuse a net. */
#include "laws.h"
#include "verified.h"

#include "solve/equilibrium.h"
#include <hifdm/evaluate.h>

/* A net of all laws in which a cable of law tension shrinks to 2e-6 of its theoretical length on the way of the paper's
 * iteration, below collapse_ratio from the 17th to about the 300th; in the answer it has 0.026. */
START_TEST(nodes_that_part_again_have_not_collapsed)
{
    struct net net, answer;
    OPEN_CASE(&answer, "tests/verify/data/parting/case.yaml", "form.residual_tolerance=1e-12",
              "form.length_tolerance=1e-12");
    ck_assert_int_eq(hf_evaluate_form(&answer.model, &answer.form, &answer.work, NULL, &answer.result), HF_OK);
    OPEN_CASE(&net, "tests/verify/data/parting/case.yaml", "form.method=hifdm", "form.residual_tolerance=1e-12",
              "form.length_tolerance=1e-12");
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_gt(net.result.iterations, 1000); /* its own shape, not that of the path */
    ck_assert_int_eq(net.result.n_slack, answer.result.n_slack);
    ck_assert_double_le(net.result.position_bound_m, 1e-8);
    ck_assert_double_le(largest_move_m(&net.model, answer.work.position_m, net.work.position_m),
                        net.result.position_bound_m + answer.result.position_bound_m);
    close_net(&net);
    close_net(&answer);
}
END_TEST

/* The same while the cable is short: out of iterations, not collapsed, and the shape is that of the last one. */
START_TEST(out_of_iterations_on_the_way)
{
    struct net net;
    OPEN_CASE(&net, "tests/verify/data/parting/case.yaml", "form.method=hifdm", "form.max_iterations=100");
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_NOT_CONVERGED);
    ck_assert_int_eq(net.result.culprit, -1);
    ck_assert_double_lt(net.result.shortest_length_ratio, 1e-3);
    for (int e = 0; e < net.model.n_cable; e++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            const double *x = net.work.position_m + c * net.model.n_node;
            square += pow(x[net.model.end_row[2 * e + 1]] - x[net.model.end_row[2 * e]], 2);
        }
        ck_assert_double_eq_tol(net.work.length_m[e], sqrt(square), 1e-12);
        ck_assert_double_eq(net.work.tension_N[e], net.work.q_N_per_m[e] * net.work.length_m[e]);
    }
    close_net(&net);
}
END_TEST

/* Nets without a shape, with as many iterations as the paper's iteration takes to say so: its verdict stands, since
 * nothing is left for another way. */
START_TEST(a_refusal_with_the_last_iteration_stands)
{
    int n_refused = 0;
    for (int i = 0; i < 40; i++) {
        const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                         {{2, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                         {{0.9, 0, -0.1}, HF_ROLE_INNER, {0, 0, i % 2 ? -0.7 * i : 0}}};
        const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                           {{1, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10 + 4.0 * i}};
        struct net net;
        OPEN_HAND(&net, node, cable, HF_METHOD_NEWTON);
        for (int n = 1; n <= 6; n++) {
            hf_form_result by_iteration;
            net.form.max_iterations = n;
            hf_form_prepare(&net.model, &net.work);
            hf_form_find(&net.model, &net.form, HF_STOP_RESIDUAL, &net.work, NULL, &by_iteration);
            if (by_iteration.iterations < n) break;
            bool is_refused = by_iteration.status != HF_OK && by_iteration.status != HF_NOT_CONVERGED;
            hf_form_prepare(&net.model, &net.work);
            hf_equilibrium_find(&net.model, &net.form, &net.work, NULL, &net.result);
            ck_assert_int_eq(net.result.iterations, n);
            ck_assert_int_eq(net.result.status, by_iteration.status);
            ck_assert_int_eq(net.result.culprit, by_iteration.culprit);
            n_refused += is_refused;
        }
        close_net(&net);
    }
    ck_assert_int_gt(n_refused, 3);
}
END_TEST

Suite *suite_unit_equilibrium(void)
{
    Suite *suite = suite_create("unit/solve/equilibrium");
    TCase *tests = tcase_create("equilibrium");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, nodes_that_part_again_have_not_collapsed);
    tcase_add_test(tests, out_of_iterations_on_the_way);
    tcase_add_test(tests, a_refusal_with_the_last_iteration_stands);
    return suite;
}
