/* Nodes that no taut cable holds: counted, placed, left out of psi; equilibria that are not unique say so. */
#include "nets.h"

#include <hifdm/evaluate.h>

static const hf_method method[] = {HF_METHOD_AUTO, HF_METHOD_HIFDM, HF_METHOD_NEWTON};

/* Two supports 2 m apart with a slack node between them, whose theoretical place is out of reach of its cables of
 * 1.05 m; and a node that three cables of given tension hold. */
static void open_pair(struct net *net, hf_law law, hf_method by, double EA[])
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},  {{2, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 0, 0.5}, HF_ROLE_INNER, {0}},  {{0, 4, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{2, 4, 0}, HF_ROLE_SUPPORT, {0}},  {{1, 6, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 4.5, 0.1}, HF_ROLE_INNER, {0}}};
    struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, law, 1.05},
                                 {{2, 1}, HF_GROUP_INNER, law, 1.05},
                                 {{3, 6}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                 {{4, 6}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                 {{5, 6}, HF_GROUP_INNER, HF_LAW_TENSION, 10}};
    *net = (struct net){.form = tight_form((int)by)};
    hand_scene(&net->scene, 7, node, 5, cable);
    for (int e = 0; e < 5; e++)
        EA[e] = 1e5;
    if (law == HF_LAW_ELASTIC) net->scene.EA_N = EA;
    open_net(net);
}

/* The nearest place within 1.05 m of both supports is (1, 0, sqrt(1.05^2 - 1)). */
START_TEST(loose_node_is_placed_and_left_out)
{
    struct net net;
    double EA[5];
    open_pair(&net, _i % 2 ? HF_LAW_ELASTIC : HF_LAW_LENGTH, method[_i / 2], EA);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_eq(net.result.n_loose, 1);
    ck_assert_int_eq(net.result.n_slack, 2);
    ck_assert_int_eq(net.result.n_drifting, 0);
    ck_assert_double_eq_tol(found_m(&net, 2, 0), 1, 1e-8);
    ck_assert_double_eq_tol(found_m(&net, 2, 1), 0, 1e-8);
    ck_assert_double_eq_tol(found_m(&net, 2, 2), sqrt(1.05 * 1.05 - 1), 1e-8);
    double dx = found_m(&net, 6, 0) - 1, dy = found_m(&net, 6, 1) - 4.5, dz = found_m(&net, 6, 2) - 0.1;
    ck_assert_double_eq_tol(net.result.psi_m, sqrt(dx * dx + dy * dy + dz * dz), 1e-12);
    ck_assert_double_le(net.result.residual_N, 1e-8);  /* 1e5 N by the rounding of a length */
    ck_assert_double_nan(net.result.position_error_m); /* it may hang elsewhere as well */
    ck_assert_double_le(net.result.condition, 1e6);
    ck_assert_int_eq(net.result.bound_reason, HF_BOUND_LOOSE);
    ck_assert_double_nan(net.result.position_bound_m);
    close_net(&net);
}
END_TEST

/* The same net with a load on that node has taut cables there: an equilibrium like any other. */
START_TEST(loaded_node_is_not_loose)
{
    struct net net;
    double EA[5], *load = calloc(21, sizeof *load);
    ck_assert_ptr_nonnull(load);
    open_pair(&net, _i % 2 ? HF_LAW_ELASTIC : HF_LAW_LENGTH, HF_METHOD_AUTO, EA);
    hf_workspace_free(&net.work);
    hf_model_free(&net.model);
    load[3 * 2 + 2] = -1;
    net.scene.load_N = load;
    open_net(&net);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_eq(net.result.n_loose, 0);
    ck_assert_double_lt(found_m(&net, 2, 2), 0);
    net.scene.load_N = NULL;
    free(load);
    close_net(&net);
}
END_TEST

/* One free node without load at a slack cable: nothing is held, psi is of no node. It stays where theory has it. */
START_TEST(net_of_loose_nodes_has_no_psi)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 1, 0.1}, HF_ROLE_INNER, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_LENGTH, 1.3}};
    struct net net;
    OPEN_HAND(&net, node, cable, (int)method[_i]);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_eq(net.result.n_loose, 1);
    ck_assert_double_nan(net.result.psi_m);
    for (int c = 0; c < 3; c++)
        ck_assert_double_eq_tol(found_m(&net, 1, c), node[1].position_m[c], 1e-9);
    close_net(&net);
}
END_TEST

/* A load equal to the tension that it hangs on, or two equal tensions in line: the node may be anywhere along them. */
START_TEST(equilibrium_that_is_not_unique_says_so)
{
    static const struct hand_node hanging[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 0, -1}, HF_ROLE_INNER, {0, 0, -3}}, {{0, 0, -3}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_node in_line[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 0, -1}, HF_ROLE_INNER, {0}}, {{0, 0, -3}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 3},
                                              {{1, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 3}};
    struct net net;
    open_hand(&net, _i % 2 ? 3 : 2, _i % 2 ? in_line : hanging, _i % 2 ? 2 : 1, cable, (int)method[_i / 2]);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_eq(net.result.n_drifting, 1);
    ck_assert_int_eq(net.model.node_of_row[net.result.culprit], 1);
    ck_assert_double_nan(net.result.position_error_m);
    close_net(&net);
}
END_TEST

/* Beside a node that is held from all sides, before and behind it. */
START_TEST(one_of_two_nodes_drifts)
{
    static const struct hand_node drifting[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 0, -1}, HF_ROLE_INNER, {0}}, {{0, 0, -3}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_node held[] = {{{5, 0, 0}, HF_ROLE_INNER, {0}},
                                            {{6, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{4, 1, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{4, -1, 0}, HF_ROLE_SUPPORT, {0}}};
    int first = _i ? 4 : 0, second = _i ? 0 : 3; /* where the nodes of each begin */
    struct hand_node node[7];
    memcpy(node + first, drifting, sizeof drifting);
    memcpy(node + second, held, sizeof held);
    const struct hand_cable cable[] = {{{first, first + 1}, HF_GROUP_INNER, HF_LAW_TENSION, 3},
                                       {{first + 1, first + 2}, HF_GROUP_INNER, HF_LAW_TENSION, 3},
                                       {{second, second + 1}, HF_GROUP_INNER, HF_LAW_TENSION, 4},
                                       {{second, second + 2}, HF_GROUP_INNER, HF_LAW_TENSION, 3},
                                       {{second, second + 3}, HF_GROUP_INNER, HF_LAW_TENSION, 3}};
    struct net net;
    open_hand(&net, 7, node, 5, cable, HF_METHOD_NEWTON);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_eq(net.result.n_drifting, 1);
    ck_assert_int_eq(net.model.node_of_row[net.result.culprit], first + 1);
    close_net(&net);
}
END_TEST

/* A net to be built holds its nodes: a design with a loose one is refused, and the node is named. */
START_TEST(design_with_a_loose_node_is_infeasible)
{
    struct net net;
    double EA[5], start_q[5] = {1, 1, 5, 5, 5}, design[1] = {0};
    open_pair(&net, HF_LAW_ELASTIC, HF_METHOD_AUTO, EA);
    hf_evaluator v = {.model = &net.model,
                      .form = &net.form,
                      .start_q_N_per_m = start_q,
                      .rule = HF_RULE_FORCE_DENSITY,
                      .solver = HF_SOLVER_NEWTON,
                      .boundary_ratio_cap = 1e9};
    ck_assert_int_eq(net.model.n_variable, 0);
    ck_assert_int_eq(hf_evaluate(&v, design, &net.work, NULL, &net.result), HF_SINGULAR);
    ck_assert_int_eq(net.model.node_of_row[net.result.culprit], 2);
    ck_assert_double_nan(net.result.psi_m);
    close_net(&net);
}
END_TEST

Suite *suite_unit_loose(void)
{
    Suite *suite = suite_create("unit/solve/loose");
    TCase *tests = tcase_create("loose");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, loose_node_is_placed_and_left_out, 0, 6);
    tcase_add_loop_test(tests, loaded_node_is_not_loose, 0, 2);
    tcase_add_loop_test(tests, net_of_loose_nodes_has_no_psi, 0, 3);
    tcase_add_loop_test(tests, equilibrium_that_is_not_unique_says_so, 0, 6);
    tcase_add_loop_test(tests, one_of_two_nodes_drifts, 0, 2);
    tcase_add_test(tests, design_with_a_loose_node_is_infeasible);
    return suite;
}
