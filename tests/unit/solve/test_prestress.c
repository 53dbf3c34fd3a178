/* Tensions that hold every node at its target position. */
#include "nets.h"

#include "solve/prestress.h"

#include <hifdm/evaluate.h>

/* The net after form.prestress: exact, solved; messages of a failure must contain `words`. */
static hf_status hold_and_solve(struct net *net, const char *words)
{
    hf_messages messages = {0};
    hf_status status = hf_prestress_hold(&net->scene, &net->form, NULL, &messages);
    if (words) ck_assert_msg(messages.text && strstr(messages.text, words), "%s", messages.text);
    if (!words) ck_assert_msg(status == HF_OK, "%s", messages.text);
    hf_messages_free(&messages);
    if (status != HF_OK) return status;
    open_net(net);
    ck_assert_int_eq(hf_evaluate_form(&net->model, &net->form, &net->work, NULL, &net->result), HF_OK);
    return HF_OK;
}

#define HOLD_HAND(pointer, nodes, cables, words)                                                                       \
    (*(pointer) = (struct net){.form = tight_form(HF_METHOD_AUTO)},                                                    \
     hand_scene(&(pointer)->scene, (int)(sizeof(nodes) / sizeof *(nodes)), nodes,                                      \
                (int)(sizeof(cables) / sizeof *(cables)), cables),                                                     \
     hold_and_solve(pointer, words))

static double pull_N(const struct net *net, int e)
{
    ck_assert_int_eq(net->scene.law[e], HF_LAW_FORCE_DENSITY);
    return net->work.tension_N[e];
}

/* A node in a plane cross: cables in line are equal, and nearest to what they want in the mean. */
START_TEST(cables_in_line_share_the_mean)
{
    static const struct hand_node node[] = {{{-1, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{2, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{0, -1, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{0, 3, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{0, 0, 0}, HF_ROLE_INNER, {0}}};
    static const struct hand_cable cable[] = {{{0, 4}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{4, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 12},
                                              {{4, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 5},
                                              {{3, 4}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 7.0 / 3}};
    struct net net;
    HOLD_HAND(&net, node, cable, NULL);
    ck_assert_double_eq_tol(pull_N(&net, 0), 11, 1e-12);
    ck_assert_double_eq_tol(pull_N(&net, 1), 11, 1e-12);
    ck_assert_double_eq_tol(pull_N(&net, 2), 6, 1e-12);
    ck_assert_double_eq_tol(pull_N(&net, 3), 6, 1e-12);
    ck_assert_double_le(net.result.psi_m, 1e-15);
    close_net(&net);
}
END_TEST

/* A load of 30 N along the cables: the nearest tensions would be -4 and 26 N, so the one stays at the least tension. */
START_TEST(no_cable_pushes)
{
    static const struct hand_node node[] = {
        {{-1, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{2, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 0, 0}, HF_ROLE_INNER, {30, 0, 0}}};
    static const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{2, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 12}};
    struct net net;
    HOLD_HAND(&net, node, cable, NULL);
    ck_assert_double_gt(pull_N(&net, 1), 30 * HF_SLACK_RATIO);
    ck_assert_double_lt(pull_N(&net, 1), 1);
    ck_assert_double_eq_tol(pull_N(&net, 0) - pull_N(&net, 1), 30, 1e-11);
    ck_assert_double_le(net.result.psi_m, 1e-14);
    close_net(&net);
}
END_TEST

/* Three cables of 1 m that rise by 0.6, and a tie below their node: statically determinate, the tie takes 3 T 0.6. */
static const struct hand_node tripod[] = {{{0.8, 0, 0.6}, HF_ROLE_SUPPORT, {0}},
                                          {{-0.4, 0.69282032302755092, 0.6}, HF_ROLE_SUPPORT, {0}},
                                          {{-0.4, -0.69282032302755092, 0.6}, HF_ROLE_SUPPORT, {0}},
                                          {{0, 0, -2}, HF_ROLE_SUPPORT, {0}},
                                          {{0, 0, 0}, HF_ROLE_INNER, {0}}};
#define LEG(i, law, target)                                                                                            \
    {                                                                                                                  \
        {i, 4}, HF_GROUP_INNER, law, target                                                                            \
    }

START_TEST(tie_takes_what_balance_needs)
{
    static const struct hand_cable cable[] = {LEG(0, HF_LAW_TENSION, 10), LEG(1, HF_LAW_TENSION, 10),
                                              LEG(2, HF_LAW_TENSION, 10), LEG(3, HF_LAW_LENGTH, 2)};
    struct net net;
    HOLD_HAND(&net, tripod, cable, NULL);
    for (int e = 0; e < 3; e++)
        ck_assert_double_eq_tol(pull_N(&net, e), 10, 1e-3);
    ck_assert_double_eq_tol(pull_N(&net, 3), 3 * 0.6 * pull_N(&net, 0), 1e-12);
    ck_assert_double_le(net.result.psi_m, 1e-15);
    close_net(&net);
}
END_TEST

/* Its family, of law length, takes what balance needs; of this cable that is nothing. */
START_TEST(cable_between_supports_wants_the_pretension)
{
    static const struct hand_cable cable[] = {LEG(0, HF_LAW_TENSION, 15),
                                              LEG(1, HF_LAW_TENSION, 15),
                                              LEG(2, HF_LAW_TENSION, 15),
                                              LEG(3, HF_LAW_LENGTH, 2),
                                              {{0, 1}, HF_GROUP_INNER, HF_LAW_LENGTH, 1}};
    struct net net;
    HOLD_HAND(&net, tripod, cable, NULL);
    ck_assert_double_gt(pull_N(&net, 3), 20);
    ck_assert_double_eq_tol(pull_N(&net, 4), net.form.pretension_N, 1e-12);
    close_net(&net);
}
END_TEST

/* Where no law gives a tension, all want the pretension. */
START_TEST(lengths_alone_want_the_pretension)
{
    static const struct hand_cable cable[] = {LEG(0, HF_LAW_LENGTH, 1), LEG(1, HF_LAW_LENGTH, 1),
                                              LEG(2, HF_LAW_LENGTH, 1), LEG(3, HF_LAW_LENGTH, 2)};
    struct net net;
    HOLD_HAND(&net, tripod, cable, NULL);
    /* least of 3 (T - 10)^2 + (1.8 T - 10)^2 */
    double T = (3 * 10 + 1.8 * 10) / (3 + 1.8 * 1.8);
    ck_assert_double_eq_tol(pull_N(&net, 0), T, 1e-11);
    ck_assert_double_eq_tol(pull_N(&net, 3), 1.8 * T, 1e-11);
    close_net(&net);
}
END_TEST

/* Without the tie nothing pulls the node back; the scene stays as it was. */
START_TEST(node_without_a_tie_is_named)
{
    static const struct hand_cable cable[] = {LEG(0, HF_LAW_TENSION, 10), LEG(1, HF_LAW_TENSION, 10),
                                              LEG(2, HF_LAW_TENSION, 10)};
    struct net net;
    ck_assert_int_eq(HOLD_HAND(&net, tripod, cable, "hold 1 of the 1 free nodes at their target positions: n4"),
                     HF_BAD_CASE);
    ck_assert_int_eq(net.scene.law[0], HF_LAW_TENSION);
    hf_scene_free(&net.scene);
}
END_TEST

/* Tensions beyond the range of doubles are no answer. */
START_TEST(numbers_that_overflow_are_refused)
{
    static const struct hand_cable cable[] = {LEG(0, HF_LAW_TENSION, 1e308), LEG(1, HF_LAW_TENSION, 1e308),
                                              LEG(2, HF_LAW_TENSION, 1e308), LEG(3, HF_LAW_TENSION, 1e308)};
    struct net net;
    ck_assert_int_eq(HOLD_HAND(&net, tripod, cable, "form.prestress: exact"), HF_BAD_CASE);
    hf_scene_free(&net.scene);
}
END_TEST

/* A strut may push: a load towards the tie's support is held by the one strut below. */
/* The scene stays as it was. */
START_TEST(it_is_told_to_stop)
{
    static const struct hand_node node[] = {
        {{-1, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{2, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 0, 0}, HF_ROLE_INNER, {0}}};
    static const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{2, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 12}};
    const volatile sig_atomic_t stop = 1;
    hf_messages messages = {0};
    struct net net = {.form = tight_form(HF_METHOD_AUTO)};
    hand_scene(&net.scene, 3, node, 2, cable);
    ck_assert_int_eq(hf_prestress_hold(&net.scene, &net.form, &stop, &messages), HF_INTERRUPTED);
    ck_assert_msg(strstr(messages.text, "interrupted before hifdm found the tensions") != NULL, "%s", messages.text);
    ck_assert(net.scene.law[0] == HF_LAW_TENSION && net.scene.target[1] == 12);
    hf_messages_free(&messages);
    hf_scene_free(&net.scene);
}
END_TEST

START_TEST(struts_push)
{
    static const struct hand_node node[] = {
        {{0, 0, -1}, HF_ROLE_SUPPORT, {0}}, {{0, 0, 1}, HF_ROLE_SUPPORT, {0}}, {{0, 0, 0}, HF_ROLE_INNER, {0, 0, -8}}};
    static const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, -5},
                                              {{2, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 9}};
    struct net net;
    HOLD_HAND(&net, node, cable, NULL);
    ck_assert_double_eq_tol(pull_N(&net, 1) - pull_N(&net, 0), 8, 1e-12);
    /* from -5 and 9, which differ by 14, both come half of the 6 that are too many */
    ck_assert_double_eq_tol(pull_N(&net, 0), -2, 1e-12);
    ck_assert_double_eq_tol(pull_N(&net, 1), 6, 1e-12);
    close_net(&net);
}
END_TEST

Suite *suite_unit_prestress(void)
{
    Suite *suite = suite_create("unit/solve/prestress");
    TCase *tests = tcase_create("prestress");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, cables_in_line_share_the_mean);
    tcase_add_test(tests, no_cable_pushes);
    tcase_add_test(tests, tie_takes_what_balance_needs);
    tcase_add_test(tests, cable_between_supports_wants_the_pretension);
    tcase_add_test(tests, lengths_alone_want_the_pretension);
    tcase_add_test(tests, node_without_a_tie_is_named);
    tcase_add_test(tests, numbers_that_overflow_are_refused);
    tcase_add_test(tests, it_is_told_to_stop);
    tcase_add_test(tests, struts_push);
    return suite;
}
