/* The paper's iteration under the verdict of the path: a shape on the way is no reason to refuse a net. */
#include "laws.h"
#include "verified.h"

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

Suite *suite_unit_equilibrium(void)
{
    Suite *suite = suite_create("unit/solve/equilibrium");
    TCase *tests = tcase_create("equilibrium");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, nodes_that_part_again_have_not_collapsed);
    tcase_add_test(tests, out_of_iterations_on_the_way);
    return suite;
}
