/* Form-finding of nets small enough to solve by hand: FDM, Eq. 7, Eq. 8, and the reason reported for each stop. */
#include "nets.h"

#include "linalg/band.h"

/* Roundoff of one small solve with numbers of size 1. */
#define ROUNDOFF 1e-14

/* One free node (2 in the list) between two supports; loads and cables vary. */
#define BETWEEN(x1, fx, fy, fz)                                                                                        \
    {                                                                                                                  \
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{x1, 0, 0}, HF_ROLE_SUPPORT, {0}},                                         \
        {                                                                                                              \
            {0.7, 0.2, 0.1}, HF_ROLE_INNER,                                                                            \
            {                                                                                                          \
                fx, fy, fz                                                                                             \
            }                                                                                                          \
        }                                                                                                              \
    }
#define TWO_CABLES(group, law, value_0, value_1)                                                                       \
    {                                                                                                                  \
        {{0, 2}, group, law, value_0},                                                                                 \
        {                                                                                                              \
            {2, 1}, group, law, value_1                                                                                \
        }                                                                                                              \
    }

static void assert_at(const struct net *net, int i_node, double x, double y, double z, double tolerance)
{
    ck_assert_double_eq_tol(found_m(net, i_node, 0), x, tolerance);
    ck_assert_double_eq_tol(found_m(net, i_node, 1), y, tolerance);
    ck_assert_double_eq_tol(found_m(net, i_node, 2), z, tolerance);
}

/* D = 2, so x = (0 + 2)/2 and z = -1/2. */
START_TEST(fdm_by_hand)
{
    struct hand_node node[] = BETWEEN(2, 0, 0, -1);
    struct hand_cable cable[] = TWO_CABLES(HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1, 1);
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    assert_at(&net, 2, 1, 0, -0.5, ROUNDOFF);
    assert_at(&net, 1, 2, 0, 0, ROUNDOFF); /* the support stays */
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_DIRECT);
    ck_assert_int_eq(net.result.iterations, 1);
    ck_assert_double_le(net.result.residual_N, ROUNDOFF);
    for (int e = 0; e < 2; e++) {
        ck_assert_double_eq_tol(net.work.length_m[e], sqrt(1.25), ROUNDOFF);
        ck_assert_double_eq_tol(net.work.tension_N[e], sqrt(1.25), ROUNDOFF);
    }
    ck_assert_double_eq_tol(net.result.psi_m, sqrt(0.09 + 0.04 + 0.36), ROUNDOFF);
    close_net(&net);
}
END_TEST

/* All components of the load, unequal force densities: x = (3*2 + 0.25)/4, y = -0.5/4, z = 0.125/4. */
START_TEST(fdm_by_hand_in_every_direction)
{
    struct hand_node node[] = BETWEEN(2, 0.25, -0.5, 0.125);
    struct hand_cable cable[] = TWO_CABLES(HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1, 3);
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_FDM);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    assert_at(&net, 2, 1.5625, -0.125, 0.03125, ROUNDOFF);
    close_net(&net);
}
END_TEST

/* A strut: (2*0 - 1*2)/(2 - 1) = -2, outside of its supports. */
START_TEST(struts_push)
{
    struct hand_node node[] = BETWEEN(2, 0, 0, 0);
    struct hand_cable cable[] = TWO_CABLES(HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 2, -1);
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    assert_at(&net, 2, -2, 0, 0, ROUNDOFF);
    ck_assert_double_eq_tol(net.work.tension_N[1], -4, ROUNDOFF);
    ck_assert_int_eq(net.result.n_slack, 0);
    close_net(&net);
}
END_TEST

/* n equal force densities under equal loads: a parabola, z_i = -P i (n-i) / (2 q). */
START_TEST(hanging_chain_is_a_parabola)
{
    enum { N = 20 };
    struct hand_node node[N + 1];
    struct hand_cable cable[N];
    struct net net;
    for (int i = 0; i <= N; i++)
        node[i] = (struct hand_node){{i, 0, 0}, i % N ? HF_ROLE_INNER : HF_ROLE_SUPPORT, {0, 0, -0.375}};
    for (int e = 0; e < N; e++)
        cable[e] = (struct hand_cable){{e, e + 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 2.5};
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    for (int i = 0; i <= N; i++)
        assert_at(&net, i, i, 0, -0.375 * i * (N - i) / 5, 1e-12); /* condition N^2 = 400 */
    close_net(&net);
}
END_TEST

/* Eq. 8: two links of 1.3 m over a span of 2.4 m hang 0.5 m deep; T = P L / (2 * 0.5). The iteration gains a factor
 * (1.2/1.3)^2 per step, so 1e-11 in length is some 300 steps; the depth is 2.6 times as sensitive as the length. */
START_TEST(length_law_by_hand)
{
    struct hand_node node[] = BETWEEN(2.4, 0, 0, -4);
    struct hand_cable cable[] = TWO_CABLES(HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1.3, 1.3);
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_CONVERGED);
    assert_at(&net, 2, 1.2, 0, -0.5, 1e-10);
    for (int e = 0; e < 2; e++)
        ck_assert_double_eq_tol(net.work.tension_N[e], 5.2, 1e-9);
    ck_assert_double_eq_tol(net.result.boundary_tension_ratio, 1, 1e-9);
    ck_assert_double_nan(net.result.inner_tension_ratio); /* no inner cable */
    close_net(&net);
}
END_TEST

/* What the case file promises: no taut cable is further from its length than length_tolerance, whatever its tension. */
START_TEST(converged_means_within_the_tolerances)
{
    static const double load[] = {4, 0.4, 0.05}; /* tension at 0.5, 0.05 and 0.0065 of the reference: all taut */
    struct hand_node node[] = BETWEEN(2.4, 0, 0, -load[_i]);
    struct hand_cable cable[] = TWO_CABLES(HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1.3, 1.3);
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.result.n_slack, 0);
    ck_assert_double_le(net.result.length_error, net.form.length_tolerance);
    ck_assert_double_le(net.result.residual_N, net.form.residual_tolerance * net.model.reference_N);
    close_net(&net);
}
END_TEST

/* Eq. 7 with equal tensions looks for Fermat's point: in a 3-4-5 triangle the distances sum to sqrt(25 + 12 sqrt 3).
 * With a residual of 1e-11 of 10 N the sum, at its minimum, is right to roundoff. */
START_TEST(tension_law_finds_fermats_point)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{4, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{0, 3, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 1, 0.5}, HF_ROLE_INNER, {0}}};
    static const struct hand_cable cable[] = {{{0, 3}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{3, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{2, 3}, HF_GROUP_INNER, HF_LAW_TENSION, 10}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    double sum = net.work.length_m[0] + net.work.length_m[1] + net.work.length_m[2];
    ck_assert_double_eq_tol(sum, sqrt(25 + 12 * sqrt(3)), 1e-14);
    ck_assert_double_le(net.result.tension_error, 1e-9);
    ck_assert_double_eq_tol(net.result.inner_tension_ratio, 1, 1e-9);
    close_net(&net);
}
END_TEST

/* A slack cable: 1.5 m of it over a span of 2 m in two pieces of 1.5; nothing pulls, so its tension must go to zero. */
START_TEST(slack_cables_are_counted)
{
    struct hand_node node[] = BETWEEN(2, 0, 0, 0);
    struct hand_cable cable[] = TWO_CABLES(HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1.5, 1.5);
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.result.n_slack, 2);
    ck_assert_double_eq(net.result.length_error, 0); /* slack cables obey their law */
    ck_assert_double_le(fabs(net.work.tension_N[0]), 1e-3 * 10);
    close_net(&net);
}
END_TEST

/* Three pulls of which one exceeds the sum of the others: the node runs to that support. */
START_TEST(collapse_names_its_cable)
{
    struct hand_node node[] = BETWEEN(2, 0, 0, 0);
    struct hand_cable cable[] = TWO_CABLES(HF_GROUP_INNER, HF_LAW_TENSION, 4, 10);
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_COLLAPSED);
    ck_assert_int_eq(net.result.status, HF_COLLAPSED);
    ck_assert_int_eq(net.result.culprit, 1);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_ILL_POSED);
    ck_assert_double_nan(net.result.psi_m);
    ck_assert_double_nan(net.result.residual_N);
    ck_assert_double_nan(net.result.inner_tension_ratio);
    ck_assert_double_nan(net.result.shortest_length_ratio);
    close_net(&net);
}
END_TEST

/* A free node without a cable (the scene check would refuse it), and force densities that cancel. */
START_TEST(singular_names_its_row)
{
    static const struct hand_node loose[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0, 0}, HF_ROLE_INNER, {0}}, {{2, 0, 0}, HF_ROLE_INNER, {0}}};
    static const struct hand_cable one[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1}};
    struct hand_node node[] = BETWEEN(2, 0, 0, 0);
    struct hand_cable cancel[] = TWO_CABLES(HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1, -1);
    struct net net;
    OPEN_HAND(&net, loose, one, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_SINGULAR);
    ck_assert_int_eq(net.model.node_of_row[net.result.culprit], 2);
    ck_assert_double_nan(net.result.psi_m);
    close_net(&net);
    OPEN_HAND(&net, node, cancel, HF_METHOD_HIFDM);
    ck_assert(net.model.has_strut);
    ck_assert_int_eq(find_shape(&net), HF_SINGULAR);
    ck_assert_int_eq(net.result.culprit, 0);
    close_net(&net);
}
END_TEST

START_TEST(overflow_is_told)
{
    struct hand_node node[] = BETWEEN(2, 0, 0, 1e308);
    struct hand_cable cable[] = TWO_CABLES(HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1e-3, 1e-3);
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(find_shape(&net), HF_NOT_FINITE);
    ck_assert_int_eq(net.result.culprit, 0);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_ILL_POSED);
    close_net(&net);
}
END_TEST

/* Calling the parts in the order of the header gives hf_form_find's shape to the bit: Eqs. 7 and 8 in one net. */
START_TEST(the_parts_are_the_iteration)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{4, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{0, 3, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 1, 0.5}, HF_ROLE_INNER, {0}},
                                            {{2, 1, 0.1}, HF_ROLE_INNER, {0.3}}};
    static const struct hand_cable cable[] = {{{0, 3}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{3, 4}, HF_GROUP_INNER, HF_LAW_TENSION, 7},
                                              {{4, 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 2.3},
                                              {{2, 3}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 2.6},
                                              {{4, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1.5}};
    struct net net;
    double whole_m[15], whole_q[5], length_gap;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    net.form.max_iterations = 5;
    ck_assert_int_eq(find_shape(&net), HF_NOT_CONVERGED);
    memcpy(whole_m, net.work.position_m, sizeof whole_m);
    memcpy(whole_q, net.work.q_N_per_m, sizeof whole_q);
    poison_workspace(&net.model, &net.work);
    hf_form_prepare(&net.model, &net.work);
    memcpy(net.work.position_m, net.model.position_m, sizeof whole_m);
    for (int k = 1;; k++) {
        hf_form_result now = {.status = HF_OK};
        int bad_row;
        hf_form_assemble(&net.model, &net.work);
        hf_form_assemble_loads(&net.model, &net.work);
        ck_assert_int_eq(hf_band_solve(false, net.model.n_free, net.model.half_bandwidth, net.work.band,
                                       net.work.position_m, net.model.n_node, &bad_row),
                         HF_OK);
        hf_form_measure_cables(&net.model, &net.form, &net.work, &now, &length_gap);
        ck_assert_int_eq(now.status, HF_OK);
        if (k == net.form.max_iterations) break;
        hf_form_update(&net.model, &net.work);
    }
    ck_assert_mem_eq(net.work.position_m, whole_m, sizeof whole_m);
    ck_assert_mem_eq(net.work.q_N_per_m, whole_q, sizeof whole_q);
    ck_assert_double_eq(hf_form_residual_N(&net.model, &net.work), net.result.residual_N);
    close_net(&net);
}
END_TEST

START_TEST(words_of_stop_reasons)
{
    ck_assert_str_eq(hf_stop_reason_word(HF_STOPPED_DIRECT), "direct");
    ck_assert_str_eq(hf_stop_reason_word(HF_STOPPED_RMS_CHANGE), "rms_change");
    ck_assert_str_eq(hf_stop_reason_word(HF_STOPPED_ILL_POSED), "ill_posed");
    ck_assert_str_eq(hf_stop_reason_word(99), "unknown");
}
END_TEST

Suite *suite_unit_formfind(void)
{
    Suite *suite = suite_create("unit/formfind");
    TCase *tests = tcase_create("formfind");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, fdm_by_hand);
    tcase_add_test(tests, fdm_by_hand_in_every_direction);
    tcase_add_test(tests, struts_push);
    tcase_add_test(tests, hanging_chain_is_a_parabola);
    tcase_add_test(tests, length_law_by_hand);
    tcase_add_loop_test(tests, converged_means_within_the_tolerances, 0, 3);
    tcase_add_test(tests, tension_law_finds_fermats_point);
    tcase_add_test(tests, slack_cables_are_counted);
    tcase_add_test(tests, collapse_names_its_cable);
    tcase_add_test(tests, singular_names_its_row);
    tcase_add_test(tests, overflow_is_told);
    tcase_add_test(tests, the_parts_are_the_iteration);
    tcase_add_test(tests, words_of_stop_reasons);
    return suite;
}
