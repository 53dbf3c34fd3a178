/* psi, tension ratios and slack of shapes written into a workspace by hand. */
#include "nets.h"

/* Two inner nodes, one edge node, two supports. */
static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                        {{1, 0, 0}, HF_ROLE_INNER, {0}},
                                        {{2, 0, 0}, HF_ROLE_EDGE, {0}},
                                        {{3, 0, 0}, HF_ROLE_INNER, {0}},
                                        {{4, 0, 0}, HF_ROLE_SUPPORT, {0}}};
static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                          {{1, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                          {{2, 3}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 10},
                                          {{3, 4}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 10}};

static void open_by_hand(struct net *net)
{
    OPEN_HAND(net, node, cable, HF_METHOD_HIFDM);
    hf_form_prepare(&net->model, &net->work);
    memcpy(net->work.position_m, net->model.position_m, 3 * (size_t)net->model.n_node * sizeof(double));
}

static void move(struct net *net, int i_node, double dx, double dy, double dz)
{
    double *p = net->work.position_m + net->model.row_of_node[i_node];
    int n = net->model.n_node;
    p[0] += dx, p[n] += dy, p[2 * n] += dz;
}

/* sqrt((3^2 + 4^2 + 12^2 + 0) / 2) = 13/sqrt(2), to roundoff of numbers of size 13. */
START_TEST(psi_is_the_rms_of_inner_nodes_in_space)
{
    struct net net;
    open_by_hand(&net);
    ck_assert_double_eq(hf_metrics_psi_m(&net.model, &net.work), 0);
    move(&net, 1, 3, -4, 12);
    ck_assert_double_eq_tol(hf_metrics_psi_m(&net.model, &net.work), 13 / sqrt(2), 1e-14);
    move(&net, 2, 5, 5, 5); /* edge nodes and supports do not count */
    move(&net, 4, 5, 5, 5);
    ck_assert_double_eq_tol(hf_metrics_psi_m(&net.model, &net.work), 13 / sqrt(2), 1e-14);
    move(&net, 3, 0, 0, -13);
    ck_assert_double_eq_tol(hf_metrics_psi_m(&net.model, &net.work), 13, 1e-14);
    close_net(&net);
}
END_TEST

static double ratio(struct net *net, int group, double t0, double t1, double t2, double t3)
{
    const double tension[] = {t0, t1, t2, t3};
    memcpy(net->work.tension_N, tension, sizeof tension);
    return hf_metrics_tension_ratio(&net->model, &net->work, (hf_group)group);
}

START_TEST(ratio_is_largest_over_smallest_of_the_group)
{
    struct net net;
    open_by_hand(&net);
    ck_assert_double_eq(ratio(&net, HF_GROUP_INNER, 2, 7, 100, 1), 3.5);
    ck_assert_double_eq(ratio(&net, HF_GROUP_BOUNDARY, 2, 7, 100, 25), 4);
    ck_assert_double_eq(ratio(&net, HF_GROUP_BOUNDARY, 0, -1, 3, 3), 1); /* the other group does not matter */
    close_net(&net);
}
END_TEST

/* What solvers leave of the tension of a slack cable is 0 or 1e-22 N: one says the same as the other. */
START_TEST(ratio_with_a_slack_cable_is_infinite)
{
    struct net net;
    open_by_hand(&net);
    static const double left[] = {0, 1e-22, -1e-22, 0.0099};
    for (int i = 0; i < 4; i++) {
        ck_assert_double_eq(ratio(&net, HF_GROUP_INNER, left[i], 7, 1, 1), INFINITY);
        ck_assert_double_eq(ratio(&net, HF_GROUP_INNER, 7, left[i], 1, 1), INFINITY);
        ck_assert_double_eq(ratio(&net, HF_GROUP_INNER, left[i], left[i], 1, 1), INFINITY);
        ck_assert_double_nan(ratio(&net, HF_GROUP_INNER, left[i], -1, 1, 1));
    }
    ck_assert_double_eq(ratio(&net, HF_GROUP_INNER, 0.0101, 0.0202, 1, 1), 2);
    close_net(&net);
}
END_TEST

START_TEST(ratio_without_positive_tensions_is_nan)
{
    struct net net;
    open_by_hand(&net);
    ck_assert_double_nan(ratio(&net, HF_GROUP_INNER, 7, -1, 1, 1));
    ck_assert_double_nan(ratio(&net, HF_GROUP_INNER, 7, (double)NAN, 1, 1));
    ck_assert_double_nan(hf_metrics_tension_ratio(&net.model, &net.work, 7)); /* an empty group */
    close_net(&net);
}
END_TEST

/* Slack is below 1e-3 of the reference, 10 N here: below 0.01 N. */
START_TEST(slack_is_relative_to_the_reference)
{
    struct net net;
    open_by_hand(&net);
    ck_assert_double_eq(net.model.reference_N, 10);
    ratio(&net, HF_GROUP_INNER, 0, 0.0099, 0.0101, 10);
    ck_assert_int_eq(hf_metrics_slack_count(&net.model, &net.work), 2);
    ck_assert(hf_metrics_is_slack(&net.model, &net.work, 0));
    ck_assert(hf_metrics_is_slack(&net.model, &net.work, 1));
    ck_assert(!hf_metrics_is_slack(&net.model, &net.work, 2));
    ratio(&net, HF_GROUP_INNER, -0.5, 1, 1, 1); /* a strut is not slack */
    ck_assert_int_eq(hf_metrics_slack_count(&net.model, &net.work), 0);
    close_net(&net);
}
END_TEST

Suite *suite_unit_metrics(void)
{
    Suite *suite = suite_create("unit/metrics");
    TCase *tests = tcase_create("metrics");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, psi_is_the_rms_of_inner_nodes_in_space);
    tcase_add_test(tests, ratio_is_largest_over_smallest_of_the_group);
    tcase_add_test(tests, ratio_with_a_slack_cable_is_infinite);
    tcase_add_test(tests, ratio_without_positive_tensions_is_nan);
    tcase_add_test(tests, slack_is_relative_to_the_reference);
    return suite;
}
