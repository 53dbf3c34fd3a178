/* The net as built: cut at the design's shape it has this shape; cables in line by hand; cables that cannot be cut. */
#include "built_nets.h"

/* Residuals of 1e-11 of the tensions, over the least stiffness of nets of 10 N and lengths of about 1 m, are 1e-11 m;
 * two shapes are found, and stiffnesses vary by a few decades. */
START_TEST(a_net_cut_at_its_shape_has_this_shape)
{
    double EA[MAX_BUILT_CABLE];
    struct net net;
    hf_built built;
    hf_workspace w;
    hf_form_result r;
    open_design(&net, _i / 2, EA, _i % 2);
    make_built(&net, &built, &w);
    ck_assert_int_eq(hf_built_solve(&built, &(hf_built_net){0}, &w, &r), HF_OK);
    for (int i = 0; i < 3 * net.model.n_node; i++) {
        ck_assert_double_eq_tol(w.position_m[i], net.work.position_m[i], 1e-9);
        ck_assert(built.position_m[i] == net.work.position_m[i]);
    }
    for (int e = 0; e < net.model.n_cable; e++)
        ck_assert_double_eq_tol(w.tension_N[e], net.work.tension_N[e], 1e-6 * built.model.reference_N);
    hf_workspace_free(&w);
    hf_built_free(&built);
    close_design(&net);
}
END_TEST

/* Two cables in line between supports at distance L: T = (L + move - l1 - l2) / (l1/EA1 + l2/EA2). */
START_TEST(two_cables_in_line)
{
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0, 0}, HF_ROLE_INNER, {0}}, {{3, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 20},
                                              {{1, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 20}};
    double EA[2] = {2000, 5000}, wrong[2] = {2000, NAN}, cut[2], move[9] = {0};
    struct net net;
    hf_built built;
    hf_workspace w;
    hf_form_result r;
    OPEN_HAND(&net, node, cable, HF_METHOD_NEWTON);
    net.scene.EA_N = EA;
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    make_built(&net, &built, &w);
    for (int e = 0; e < 2; e++) {
        ck_assert_double_eq_tol(built.scene.target[e], net.work.length_m[e] / (1 + 20 / EA[e]), 1e-15);
        cut[e] = built.scene.target[e] - 0.001 * (1 + e);
    }
    move[net.model.row_of_node[2]] = 0.004;
    ck_assert_int_eq(hf_built_solve(&built, &(hf_built_net){.cut_m = cut, .support_displacement_m = move}, &w, &r),
                     HF_OK);
    double T = (3.004 - cut[0] - cut[1]) / (cut[0] / EA[0] + cut[1] / EA[1]);
    ck_assert_double_eq_tol(w.tension_N[0], T, 1e-8); /* rounding of lengths of 3 m, 1e-15, times EA/l0 */
    ck_assert_double_eq_tol(w.tension_N[1], T, 1e-8);
    ck_assert_double_eq_tol(w.position_m[net.model.row_of_node[1]], cut[0] * (1 + T / EA[0]), 1e-12);
    hf_workspace_free(&w);
    hf_built_free(&built);

    net.scene.EA_N = wrong;
    hf_messages messages = {0};
    ck_assert_int_eq(hf_built_make("x.yaml", &net.scene, &net.model, &net.form, &net.work, &built, &messages),
                     HF_BAD_CASE);
    ck_assert_str_eq(
        messages.text,
        "error: x.yaml: 1 inner cable has no stiffness EA, which the as-built net needs. One of these cables is "
        "'c1'. Add the key scene.EA_inner_N, or add the column EA_N to the table of an imported net\n");
    hf_messages_free(&messages);
    hf_built_free(&built);
    close_design(&net);
}
END_TEST

Suite *suite_unit_built(void)
{
    Suite *suite = suite_create("unit/built");
    TCase *tcase = tcase_create("built");
    tcase_add_loop_test(tcase, a_net_cut_at_its_shape_has_this_shape, 0, 12);
    tcase_add_test(tcase, two_cables_in_line);
    suite_add_tcase(suite, tcase);
    return suite;
}
