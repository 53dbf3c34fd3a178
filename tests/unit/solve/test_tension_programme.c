/* Linear programmes in the tensions that hold a net, with answers by hand. */
#include "nets.h"

#include "solve/tension_programme.h"

/* A node in a plane cross: cables 0 and 1 are in line, and so are 2 and 3. `load_N` pulls along the first two. */
static void open_cross(struct net *net, double load_N)
{
    const struct hand_node node[] = {{{-1, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                     {{2, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                     {{0, -1, 0}, HF_ROLE_SUPPORT, {0}},
                                     {{0, 3, 0}, HF_ROLE_SUPPORT, {0}},
                                     {{0, 0, 0}, HF_ROLE_INNER, {load_N, 0, 0}}};
    static const struct hand_cable cable[] = {{{0, 4}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{4, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{4, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{3, 4}, HF_GROUP_INNER, HF_LAW_TENSION, 10}};
    *net = (struct net){.form = tight_form(HF_METHOD_AUTO)};
    hand_scene(&net->scene, 5, node, 4, cable);
    open_net(net);
}

enum { N_CABLE = 4 };
static const double start_N[N_CABLE] = {10, 10, 10, 10};

/* y0 is the amount by which the tensions of cables 0 and 2 must be below 20 and 30 N. */
static hf_status find_amount(const struct net *net, const double *lower_N, const double *upper_N, double enough_N,
                             double *amount_N, double multiplier[2])
{
    static const hf_tension_row row[] = {{0, 1, 20, {0, -1}, {1, 0}}, {2, 1, 30, {0, -1}, {1, 0}}};
    const double cost[] = {1};
    const hf_tension_programme programme = {&net->model, lower_N, upper_N, start_N, NULL, 2, 1, row, cost, enough_N};
    return hf_tension_programme_solve(&programme, amount_N, multiplier);
}

/* Cable 1 takes at most 15 N, and with it cable 0: 5 N less than 20. Cable 2 can have its 30 N less 5. */
START_TEST(the_tightest_line_decides)
{
    static const double lower_N[] = {0, 0, 0, 0}, upper_N[] = {100, 15, 100, 26};
    struct net net;
    double amount_N, multiplier[2];
    open_cross(&net, 0);
    ck_assert_int_eq(find_amount(&net, lower_N, upper_N, -INFINITY, &amount_N, multiplier), HF_OK);
    ck_assert_double_eq_tol(amount_N, 5, 1e-6);
    ck_assert_double_eq_tol(multiplier[0], 1, 1e-6);
    ck_assert_double_eq_tol(multiplier[1], 0, 1e-6);
    close_net(&net);
}
END_TEST

/* A load of 3 N along the line makes cable 0 take 3 N more than cable 1. */
START_TEST(loads_take_part)
{
    static const double lower_N[] = {0, 0, 0, 0}, upper_N[] = {INFINITY, 15, INFINITY, INFINITY};
    struct net net;
    double amount_N, multiplier[2];
    open_cross(&net, 3);
    ck_assert_int_eq(find_amount(&net, lower_N, upper_N, -INFINITY, &amount_N, multiplier), HF_OK);
    ck_assert_double_eq_tol(amount_N, 2, 1e-6);
    close_net(&net);
}
END_TEST

START_TEST(it_stops_where_the_amount_is_enough)
{
    static const double lower_N[] = {0, 0, 0, 0}, upper_N[] = {100, 100, 100, 100};
    struct net net;
    double amount_N, multiplier[2];
    open_cross(&net, 0);
    ck_assert_int_eq(find_amount(&net, lower_N, upper_N, 0, &amount_N, multiplier), HF_OK);
    ck_assert_double_le(amount_N, 0);
    ck_assert_double_gt(amount_N, -70); /* not at the minimum, which leaves 100 N */
    close_net(&net);
}
END_TEST

/* Fixed tensions that differ hold no node, and neither do ranges that do not overlap. An open node needs no hold. */
START_TEST(nets_without_equilibrium_are_refused)
{
    static const double lower_N[][N_CABLE] = {{9, 8, 0, 0}, {11, 1, 1, 1}},
                        upper_N[][N_CABLE] = {{9, 8, 50, 50}, {20, 10, 20, 20}};
    struct net net;
    double amount_N, multiplier[2];
    open_cross(&net, 0);
    ck_assert_int_eq(find_amount(&net, lower_N[_i], upper_N[_i], -INFINITY, &amount_N, multiplier), HF_NOT_CONVERGED);
    const bool is_open[] = {true};
    const hf_tension_row row = {0, 1, 20, {0, -1}, {1, 0}};
    const double cost[] = {1};
    const hf_tension_programme open = {&net.model, lower_N[_i], upper_N[_i], start_N, is_open,
                                       1,          1,           &row,        cost,    -INFINITY};
    ck_assert_int_eq(hf_tension_programme_solve(&open, &amount_N, NULL), HF_OK);
    ck_assert_double_eq_tol(amount_N, 20 - upper_N[_i][0], 1e-6);
    close_net(&net);
}
END_TEST

START_TEST(memory_may_fail)
{
    static const double lower_N[] = {0, 0, 0, 0}, upper_N[] = {100, 15, 100, 26};
    struct net net;
    double amount_N, multiplier[2];
    open_cross(&net, 0);
    fail_allocation_at(1);
    hf_status status = find_amount(&net, lower_N, upper_N, -INFINITY, &amount_N, multiplier);
    ck_assert(end_allocation_failure());
    ck_assert_int_eq(status, HF_NO_MEMORY);
    close_net(&net);
}
END_TEST

Suite *suite_unit_tension_programme(void)
{
    Suite *suite = suite_create("unit/tension_programme");
    TCase *tests = tcase_create("tension_programme");
    tcase_add_test(tests, the_tightest_line_decides);
    tcase_add_test(tests, loads_take_part);
    tcase_add_test(tests, it_stops_where_the_amount_is_enough);
    tcase_add_loop_test(tests, nets_without_equilibrium_are_refused, 0, 2);
    tcase_add_test(tests, memory_may_fail);
    suite_add_tcase(suite, tests);
    return suite;
}
