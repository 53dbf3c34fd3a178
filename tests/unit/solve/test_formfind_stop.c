/* When form-finding stops and what it reports then: rules, bounds, chains, history. Also: it does not allocate, and
 * does not read what an earlier call left in the workspace. */
#include "nets.h"

/* A small scalloped reflector: converges in some 300 iterations at the default tolerances. */

START_TEST(iterations_are_bounded)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR, "form.max_iterations=5");
    ck_assert_int_eq(find_shape(&net), HF_NOT_CONVERGED);
    ck_assert_int_eq(net.result.iterations, 5);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_MAX_ITERATIONS);
    ck_assert(isfinite(net.result.psi_m) && net.result.psi_m > 0); /* a shape there is */
    ck_assert_double_gt(net.result.residual_N, net.form.residual_tolerance * net.model.reference_N);
    close_net(&net);
}
END_TEST

START_TEST(residual_rule_holds_both_tolerances)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_CONVERGED);
    ck_assert_double_le(net.result.residual_N, 1e-7 * 10);
    ck_assert_double_le(net.result.length_error, 1e-7);
    ck_assert_double_le(net.result.tension_error,
                        1e-6); /* follows from the residual, by a factor that depends on the net */
    close_net(&net);
}
END_TEST

/* One iteration fewer must break one of the tolerances: the rule stops at the first shape that obeys. */
START_TEST(residual_rule_stops_at_the_first_chance)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    net.form.max_iterations = net.result.iterations - 1;
    ck_assert_int_eq(find_shape(&net), HF_NOT_CONVERGED);
    ck_assert(net.result.residual_N > 1e-6 || net.result.length_error > 1e-7);
    close_net(&net);
}
END_TEST

struct record {
    double psi_m[400], residual_N[400], inner[400], boundary[400], length_error[400];
    hf_history history;
};

static hf_history *open_record(struct record *r, int capacity)
{
    r->history = (hf_history){capacity, 0, r->psi_m, r->residual_N, r->inner, r->boundary, r->length_error, {0}};
    return &r->history;
}

/* The paper's rule: psi changes by less than rms_tolerance_m for the first time at the stop. */
START_TEST(rms_rule_stops_at_the_first_small_change)
{
    static struct record r;
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR, "form.stop=rms_change", "form.rms_tolerance_m=1e-7");
    hf_form_prepare(&net.model, &net.work);
    ck_assert_int_eq(
        hf_form_find(&net.model, &net.form, HF_STOP_RMS_CHANGE, &net.work, open_record(&r, 400), &net.result), HF_OK);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_RMS_CHANGE);
    int n = net.result.iterations;
    ck_assert_int_gt(n, 3);
    for (int i = 1; i < n; i++)
        ck_assert_int_eq(fabs(r.psi_m[i] - r.psi_m[i - 1]) < 1e-7, i == n - 1);
    ck_assert(isfinite(net.result.residual_N)); /* the residual is reported, though the rule does not use it */
    close_net(&net);
}
END_TEST

START_TEST(history_ends_in_the_result)
{
    static struct record r;
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    hf_form_result plain;
    ck_assert_int_eq(find_shape(&net), HF_OK);
    plain = net.result;
    hf_form_prepare(&net.model, &net.work);
    hf_form_find(&net.model, &net.form, net.form.stop, &net.work, open_record(&r, 400), &net.result);
    int last = r.history.n - 1;
    ck_assert_int_eq(r.history.n, net.result.iterations);
    ck_assert_int_eq(net.result.iterations, plain.iterations); /* recording the history changes nothing */
    ck_assert_double_eq(net.result.psi_m, plain.psi_m);
    ck_assert_double_eq(r.psi_m[last], plain.psi_m);
    ck_assert_double_eq(r.residual_N[last], plain.residual_N);
    ck_assert_double_eq(r.inner[last], plain.inner_tension_ratio);
    ck_assert_double_eq(r.boundary[last], plain.boundary_tension_ratio);
    ck_assert_double_eq(r.length_error[last], plain.length_error);
    close_net(&net);
}
END_TEST

START_TEST(history_keeps_within_its_capacity)
{
    static struct record r;
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    r.psi_m[7] = 77;
    hf_form_prepare(&net.model, &net.work);
    ck_assert_int_eq(hf_form_find(&net.model, &net.form, net.form.stop, &net.work, open_record(&r, 7), &net.result),
                     HF_OK);
    ck_assert_int_eq(r.history.n, 7);
    ck_assert_double_eq(r.psi_m[7], 77);
    close_net(&net);
}
END_TEST

/* ---- straight chains ---- */

/* Two links of 1 m along x between supports 2 m apart, and a cable of 10 N that pulls their node along y. */
static struct net pulled_chain(double pull_N)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0, 0}, HF_ROLE_EDGE, {0}},
                                            {{2, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 1, 0}, HF_ROLE_INNER, {0}},
                                            {{1, 2, 0}, HF_ROLE_SUPPORT, {0}}, {{1, -2, 0}, HF_ROLE_SUPPORT, {0}}};
    const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1},
                                       {{1, 2}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1},
                                       {{1, 3}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, pull_N / 2},
                                       {{3, 4}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, pull_N / 2},
                                       {{1, 5}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 5}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(net.model.n_chain, 1);
    return net;
}

START_TEST(loaded_straight_chain_is_ill_posed)
{
    struct net net = pulled_chain(10);
    ck_assert_int_eq(find_shape(&net), HF_STRAIGHT_CHAIN);
    ck_assert_int_eq(net.result.culprit, 0);
    ck_assert_int_eq(net.result.n_loaded_chain, 1);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_ILL_POSED);
    ck_assert_double_nan(net.result.boundary_tension_ratio);
    ck_assert(hf_form_chain_is_loaded(&net.model, &net.work, 0));
    ck_assert_int_lt(net.result.iterations, net.form.max_iterations); /* told when the load has settled */
    close_net(&net);
}
END_TEST

/* Pulls of 10 N along +y and -y at the node: the straight chain carries nothing across and is no trouble. */
START_TEST(unloaded_straight_chain_is_fine)
{
    struct net net = pulled_chain(20); /* 10 N/m over 1 m against 5 N/m over 2 m */
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.result.n_loaded_chain, 0);
    ck_assert(!hf_form_chain_is_loaded(&net.model, &net.work, 0));
    close_net(&net);
}
END_TEST

/* A pull along the chain is shared by its two links, at finite tensions: T0 - T1 = 2 N. */
START_TEST(straight_chain_carries_loads_along_it)
{
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0, 0}, HF_ROLE_INNER, {2, 0, 0}}, {{2, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1},
                                              {{1, 2}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(net.model.n_chain, 1);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.result.n_loaded_chain, 0);
    ck_assert_double_eq_tol(net.work.tension_N[0] - net.work.tension_N[1], 2, 1e-9); /* 1e-11 of 10 N */
    close_net(&net);
}
END_TEST

/* Under the paper's rule the figures stand, with a count that says what they are worth. */
START_TEST(rms_rule_counts_loaded_chains)
{
    struct net net = pulled_chain(10);
    net.form.stop = HF_STOP_RMS_CHANGE;
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.result.n_loaded_chain, 1);
    ck_assert(isfinite(net.result.boundary_tension_ratio));
    close_net(&net);
}
END_TEST

/* ---- house rules ---- */

START_TEST(nothing_is_allocated)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    long before = allocation_count();
    find_shape(&net);
    ck_assert_int_eq(allocation_count(), before);
    close_net(&net);
}
END_TEST

/* The model is shared by threads: not one byte of it may change. */
START_TEST(model_stays_as_it_was)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    hf_model *m = &net.model, before = *m;
    /* position_m to the end of the block is what a solver could write to by mistake; all arrays lie in one block */
    size_t size = (size_t)((unsigned char *)(m->chain_of_row + m->n_node) - (unsigned char *)m->block);
    unsigned char *copy = malloc(size);
    ck_assert_ptr_nonnull(copy);
    memcpy(copy, m->block, size);
    find_shape(&net);
    ck_assert_mem_eq(copy, m->block, size);
    ck_assert_mem_eq(&before, m, sizeof before);
    free(copy);
    close_net(&net);
}
END_TEST

START_TEST(stale_contents_do_no_harm)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    size_t bytes = 3 * (size_t)net.model.n_node * sizeof(double);
    double *first = malloc(bytes);
    ck_assert_ptr_nonnull(first);
    find_shape(&net); /* on a poisoned workspace */
    memcpy(first, net.work.position_m, bytes);
    find_shape(&net); /* on the contents of the run before */
    ck_assert_mem_eq(net.work.position_m, first, bytes);
    poison_workspace(&net.model, &net.work);
    find_shape(&net);
    ck_assert_mem_eq(net.work.position_m, first, bytes);
    free(first);
    close_net(&net);
}
END_TEST

/* A shape from elsewhere in equilibrium, one of whose cables has another length than wanted. */
START_TEST(a_shape_of_wrong_lengths_is_none)
{
    struct net net;
    int e = 0;
    OPEN_CASE(&net, SMALL_REFLECTOR, "form.residual_tolerance=1e-9", "form.length_tolerance=1e-9");
    ck_assert_int_eq(find_shape(&net), HF_OK);
    net.form.residual_tolerance = net.form.length_tolerance = 1e-7;
    ck_assert_int_eq(hf_form_measure(&net.model, &net.form, &net.work, &net.result), HF_OK);
    while (net.model.law[e] != HF_LAW_LENGTH)
        e++;
    net.work.target[e] *= 1 + 1e-6;
    ck_assert_int_eq(hf_form_measure(&net.model, &net.form, &net.work, &net.result), HF_NOT_CONVERGED);
    ck_assert_double_le(net.result.residual_N, 1e-7 * net.model.reference_N);
    close_net(&net);
}
END_TEST

Suite *suite_unit_formfind_stop(void)
{
    Suite *suite = suite_create("unit/formfind_stop");
    TCase *tests = tcase_create("formfind_stop");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, iterations_are_bounded);
    tcase_add_test(tests, residual_rule_holds_both_tolerances);
    tcase_add_test(tests, residual_rule_stops_at_the_first_chance);
    tcase_add_test(tests, rms_rule_stops_at_the_first_small_change);
    tcase_add_test(tests, history_ends_in_the_result);
    tcase_add_test(tests, history_keeps_within_its_capacity);
    tcase_add_test(tests, loaded_straight_chain_is_ill_posed);
    tcase_add_test(tests, unloaded_straight_chain_is_fine);
    tcase_add_test(tests, straight_chain_carries_loads_along_it);
    tcase_add_test(tests, rms_rule_counts_loaded_chains);
    tcase_add_test(tests, nothing_is_allocated);
    tcase_add_test(tests, model_stays_as_it_was);
    tcase_add_test(tests, stale_contents_do_no_harm);
    tcase_add_test(tests, a_shape_of_wrong_lengths_is_none);
    return suite;
}
