/* Limits of Newton's method: what it refuses, the nets that it is not used for, its bounds on steps. Also: the contents
 * of a used workspace do not change a bit of the result. */
#include "laws.h"
#include "verified.h"

#include <hifdm/evaluate.h>

static hf_status find(struct net *net)
{
    return hf_evaluate_form(&net->model, &net->form, &net->work, NULL, &net->result);
}

static void open_small(struct net *net)
{
    OPEN_CASE(net, SMALL_REFLECTOR, "form.method=newton", "form.residual_tolerance=1e-9", "form.length_tolerance=1e-9");
}

/* No finite tension holds it: refused under its name, the chain a straight one, and no number to mistake for an
 * answer. */
START_TEST(straight_chain_is_named)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR, "form.method=newton", "scene.parabolic_cylinder.scallop=0");
    ck_assert_int_eq(find(&net), HF_STRAIGHT_CHAIN);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_ILL_POSED);
    ck_assert_int_ge(net.result.culprit, 0);
    ck_assert_int_lt(net.result.culprit, net.model.n_chain);
    ck_assert(hf_form_chain_is_loaded(&net.model, &net.work, net.result.culprit));
    ck_assert_double_nan(net.result.psi_m);
    ck_assert_double_nan(net.result.position_error_m);
    ck_assert_double_nan(net.result.condition);
    ck_assert_double_nan(net.result.backward_error);
    close_net(&net);
}
END_TEST

/* Three cables of 10 N to supports and a fourth of 50 N: nothing balances it, the node runs into that support. */
START_TEST(collapse_is_named)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_INNER, {0}},
                                            {{1, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{-1, 0.2, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{0, 1, 0.3}, HF_ROLE_SUPPORT, {0}},
                                            {{0, -1, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{0, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{0, 3}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{0, 4}, HF_GROUP_INNER, HF_LAW_TENSION, 50}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_NEWTON);
    ck_assert_int_eq(find(&net), HF_COLLAPSED);
    ck_assert_int_eq(net.result.culprit, 3);
    ck_assert_double_nan(net.result.psi_m);
    close_net(&net);
}
END_TEST

/* Newton's steps lead away from this net, and the path takes 11: 46 in all when none is given up before the last. */
START_TEST(steps_that_lead_away_are_given_up)
{
    struct net net;
    OPEN_CASE(&net, "configs/reflector.yaml", "form.method=newton", "scene.parabolic_cylinder.modules=[2, 3]",
              "scene.parabolic_cylinder.cells_per_module=[10, 8]", "scene.parabolic_cylinder.scallop=0.05");
    ck_assert_int_eq(find(&net), HF_OK);
    ck_assert_int_le(net.result.iterations, 30);
    close_net(&net);
}
END_TEST

/* Edges with a sag of 1e-4 of their span carry tensions decades above the pretension; Eqs. 7 and 8 do not get there in
 * 100000 iterations. */
START_TEST(flat_edges_are_solved)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR, "form.method=newton", "form.residual_tolerance=1e-9",
              "form.length_tolerance=1e-10", "scene.parabolic_cylinder.scallop=1e-4", "form.max_iterations=300");
    ck_assert_int_eq(net.model.n_chain, 0);
    ck_assert_int_gt(net.model.n_any_chain, 0);
    ck_assert_int_eq(find(&net), HF_OK);
    ck_assert_double_gt(net.result.boundary_tension_ratio, 10);
    struct verified v = verify_shape(&net.model, &net.work, net.scene.law, net.scene.target);
    ck_assert_double_le(v.residual_N, 1.01e-9 * net.model.reference_N);
    ck_assert_double_le(v.length_gap, 1.01e-10);
    close_net(&net);
}
END_TEST

/* Two nodes 1e-10 m apart at coordinates of 1 m: the direction of their cable is rounded to 1e-6, and so are 10 N. */
START_TEST(what_rounding_leaves_is_named)
{
    static const struct hand_node node[] = {
        {{1, 1, 0.3}, HF_ROLE_INNER, {0}},      {{1 + 1e-10, 1, 0.3}, HF_ROLE_INNER, {0}},
        {{0, 1, 0.1}, HF_ROLE_SUPPORT, {0}},    {{2, 1, 0}, HF_ROLE_SUPPORT, {0}},
        {{1, 0, 0}, HF_ROLE_SUPPORT, {0}},      {{1, 2.3, 0}, HF_ROLE_SUPPORT, {0}},
        {{1.1, -0.2, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 2, 0.7}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {
        {{0, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10},         {{1, 3}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
        {{0, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1e11}, {{0, 4}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
        {{0, 5}, HF_GROUP_INNER, HF_LAW_TENSION, 10},         {{1, 6}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
        {{1, 7}, HF_GROUP_INNER, HF_LAW_TENSION, 10}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_NEWTON);
    net.form.residual_tolerance = 1e-9;
    ck_assert_int_eq(find(&net), HF_NOT_CONVERGED);
    ck_assert_int_eq(net.result.culprit, 2);
    ck_assert_int_le(net.result.iterations, 500); /* it gives up soon */
    close_net(&net);
}
END_TEST

static const struct hand_node chain_node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                              {{1, 0.3, 0}, HF_ROLE_INNER, {0, 0, -1.25}},
                                              {{2, 0, 0.2}, HF_ROLE_SUPPORT, {0}},
                                              {{1, -1, 0}, HF_ROLE_SUPPORT, {0}}};

/* Struts: not convex. Force densities everywhere: one linear solve. Both ask for newton and get what serves them, to
 * rounding: 1e-14 of some newtons. */
START_TEST(not_for_newton)
{
    double q = _i ? -0.5 : 2.385;
    const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 2.385},
                                       {{1, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1.25},
                                       {{1, 3}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, q}};
    const char *why = NULL;
    struct net net;
    OPEN_HAND(&net, chain_node, cable, HF_METHOD_NEWTON);
    ck_assert(!net.model.has_newton);
    ck_assert_int_eq(hf_evaluate_method(&net.model, &net.form, &why), HF_METHOD_HIFDM);
    ck_assert_ptr_nonnull(strstr(why, _i ? "struts" : "one solve"));
    ck_assert_int_eq(find(&net), HF_OK);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_DIRECT);
    ck_assert_int_eq(net.result.iterations, 1);
    ck_assert_double_eq_tol(net.result.condition, 1, 1e-15); /* one free node */
    ck_assert_double_le(net.result.position_error_m, 1e-14);
    struct verified v = verify_shape(&net.model, &net.work, net.scene.law, net.scene.target);
    ck_assert_double_le(v.residual_N, 1e-13);
    close_net(&net);
}
END_TEST

/* Two free nodes in a row: D = [[a + b, -b], [-b, b + c]], condition in the 1-norm by hand; LAPACK's estimate is exact
 * for two rows. The solution is exact to rounding, and says so. */
START_TEST(linear_nets_are_certified)
{
    static const double q[2][3] = {{2, 3, 5}, {2, -1, 5}}, condition[2] = {121.0 / 31, 25.0 / 3};
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 0.2, 0}, HF_ROLE_INNER, {0, 0, -1}},
                                            {{2, 0, 0.1}, HF_ROLE_INNER, {0.3, 0, 0}},
                                            {{3, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, q[_i][0]},
                                       {{1, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, q[_i][1]},
                                       {{2, 3}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, q[_i][2]}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_FDM);
    ck_assert_int_eq(find(&net), HF_OK);
    ck_assert_double_eq_tol(net.result.condition, condition[_i], 1e-13);
    ck_assert_double_le(net.result.position_error_m, 1e-14);
    ck_assert_double_le(net.result.backward_error, 1e-15);
    close_net(&net);
}
END_TEST

/* A strut with a cable under law tension beside it iterates, but not by Newton. */
START_TEST(strut_beside_a_tension_falls_back)
{
    const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                       {{1, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 11},
                                       {{1, 3}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, -0.5}};
    struct net net;
    OPEN_HAND(&net, chain_node, cable, HF_METHOD_NEWTON);
    ck_assert_int_eq(hf_evaluate_method(&net.model, &net.form, NULL), HF_METHOD_HIFDM);
    ck_assert_int_eq(find(&net), HF_OK);
    struct verified v = verify_shape(&net.model, &net.work, net.scene.law, net.scene.target);
    ck_assert_double_le(v.residual_N, 1.001e-11 * net.model.reference_N);
    close_net(&net);
}
END_TEST

START_TEST(auto_picks_newton_for_the_residual_only)
{
    struct net net;
    open_small(&net);
    net.form.method = HF_METHOD_AUTO;
    ck_assert_int_eq(hf_evaluate_method(&net.model, &net.form, NULL), HF_METHOD_NEWTON);
    net.form.stop = HF_STOP_RMS_CHANGE;
    ck_assert_int_eq(hf_evaluate_method(&net.model, &net.form, NULL), HF_METHOD_HIFDM);
    close_net(&net);
}
END_TEST

/* Whatever the limit: never more than it by more than one block of Newton steps (30) and a solve, and honest about
 * it. */
START_TEST(iterations_are_bounded)
{
    struct net net;
    open_small(&net);
    ck_assert_int_eq(find(&net), HF_OK);
    int enough = net.result.iterations;
    double psi_m = net.result.psi_m;
    ck_assert_int_gt(enough, 6); /* the first fixed-point iterations alone do not do it */
    for (int limit = 1; limit <= enough + 10; limit++) {
        net.form.max_iterations = limit;
        hf_status status = find(&net);
        ck_assert(status == HF_OK || (limit < enough && status == HF_NOT_CONVERGED));
        ck_assert_int_le(net.result.iterations, limit + 31);
        if (limit >= enough) /* nothing was cut short: the same bits */
            ck_assert_double_eq(net.result.psi_m, psi_m);
        else if (status == HF_OK) /* 1e-8 N over 0.1 N/m */
            ck_assert_double_eq_tol(net.result.psi_m, psi_m, 1e-7);
        else
            ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_MAX_ITERATIONS);
    }
    close_net(&net);
}
END_TEST

START_TEST(stale_workspace_gives_the_same_bits)
{
    struct net net;
    open_small(&net);
    hf_form_result first, second;
    memset(&first, 0, sizeof first);
    memset(&second, 0, sizeof second);
    size_t bytes = 3 * (size_t)net.model.n_node * sizeof(double);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &first), HF_OK);
    double *shape = copy_positions(&net.model, &net.work);
    for (int pass = 0; pass < 2; pass++) { /* after its own results, and after rubbish */
        if (pass) poison_workspace(&net.model, &net.work);
        ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &second), HF_OK);
        ck_assert_mem_eq(shape, net.work.position_m, bytes);
        ck_assert_int_eq(first.iterations, second.iterations);
        ck_assert_double_eq(first.psi_m, second.psi_m);
        ck_assert_double_eq(first.residual_N, second.residual_N);
        ck_assert_double_eq(first.condition, second.condition);
        ck_assert_double_eq(first.position_error_m, second.position_error_m);
        ck_assert_double_eq(first.backward_error, second.backward_error);
    }
    free(shape);
    close_net(&net);
}
END_TEST

START_TEST(nothing_is_allocated)
{
    struct net net;
    open_small(&net);
    long before = allocation_count();
    find(&net);
    ck_assert_int_eq(allocation_count(), before);
    ck_assert_int_eq(net.result.status, HF_OK);
    close_net(&net);
}
END_TEST

Suite *suite_unit_newton_limits(void)
{
    Suite *suite = suite_create("unit/newton_limits");
    TCase *tests = tcase_create("newton_limits");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, straight_chain_is_named);
    tcase_add_test(tests, collapse_is_named);
    tcase_add_test(tests, flat_edges_are_solved);
    tcase_add_test(tests, steps_that_lead_away_are_given_up);
    tcase_add_test(tests, what_rounding_leaves_is_named);
    tcase_add_loop_test(tests, not_for_newton, 0, 2);
    tcase_add_loop_test(tests, linear_nets_are_certified, 0, 2);
    tcase_add_test(tests, strut_beside_a_tension_falls_back);
    tcase_add_test(tests, auto_picks_newton_for_the_residual_only);
    tcase_add_test(tests, iterations_are_bounded);
    tcase_add_test(tests, stale_workspace_gives_the_same_bits);
    tcase_add_test(tests, nothing_is_allocated);
    return suite;
}
