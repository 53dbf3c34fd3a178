/* The primal-dual path: nets that no other method solves, what it says of nets without a shape, its bounds. */
#include "laws.h"
#include "verified.h"

#include "solve/interior.h"
#include <hifdm/evaluate.h>

enum { MOST_STEPS = 60 };

/* ---- all laws ---- */

/* A random net of all laws under load. `part` of the inner cables are elastic, of stiffnesses over two of ten decades,
 * cut too long or too short by up to `cut`: some are slack. */
static void open_all_laws(struct net *net, int trial, double *EA)
{
    struct rng rng = rng_start(700 + (uint64_t)trial);
    *net = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
    net->form.residual_tolerance = net->form.length_tolerance = 1e-10;
    hf_scene *s = &net->scene;
    if (trial % 2) {
        random_tension_scene(&rng, s);
    } else {
        random_reflector_scene(&rng, s);
        mix_laws(&rng, s);
    }
    double middle_N = pow(10, rng_uniform(&rng, 1.5, 9.5)), part = rng_uniform(&rng, 0.1, 0.8);
    double cut = pow(10, rng_uniform(&rng, -6, -2));
    for (int e = 0; e < s->n_cable; e++) {
        EA[e] = middle_N * pow(10, rng_uniform(&rng, -1, 1));
        if (s->group[e] == HF_GROUP_BOUNDARY || rng_uniform(&rng, 0, 1) > part) continue;
        s->law[e] = HF_LAW_ELASTIC;
        s->target[e] = hf_scene_length_at_target(s, e) / (1 + 10 / EA[e]) * (1 + cut * rng_uniform(&rng, -1, 1));
    }
    s->EA_N = EA;
    open_net(net);
}

/* Largest force out of balance when every cable pulls with q l, and largest error of that tension against its law, N,
 * in long double; a length error counts with the stiffness of an elastic cable, or with 1e3 N/m. */
static double largest_error_N(const struct net *net)
{
    const hf_model *m = &net->model;
    const hf_workspace *w = &net->work;
    long double *force = calloc(3 * (size_t)m->n_node, sizeof *force), most = 0;
    ck_assert_ptr_nonnull(force);
    for (int k = 0; k < 3 * m->n_node && m->load_N; k++)
        force[k] = m->load_N[k];
    for (int e = 0; e < m->n_cable; e++) {
        const int *end = m->end_row + 2 * e;
        long double d[3], square = 0, q = w->q_N_per_m[e];
        for (int c = 0; c < 3; c++) {
            d[c] = (long double)w->position_m[c * m->n_node + end[1]] - w->position_m[c * m->n_node + end[0]];
            square += d[c] * d[c];
            force[c * m->n_node + end[0]] += q * d[c];
            force[c * m->n_node + end[1]] -= q * d[c];
        }
        long double l = sqrtl(square), T = q * l, target = w->target[e], error = 0;
        switch ((hf_law)w->law[e]) {
        case HF_LAW_TENSION:
            error = T - target;
            break;
        case HF_LAW_FORCE_DENSITY:
            error = T - target * l;
            break;
        case HF_LAW_LENGTH:
            error = T < 0 ? T : 1e3L * (T > 0 || l > target ? l - target : 0);
            if (l < target) error *= fminl(1, T / m->reference_N);
            break;
        case HF_LAW_ELASTIC: /* relative to the length: 1e-10 of it may be 1e-10 EA */
            error = 1e3L * (l / (target * (1 + T / w->EA_N[e])) - 1);
            if (error < 0) error *= fminl(1, T / m->reference_N);
            if (T < 0) error = T;
            break;
        }
        most = fmaxl(most, fabsl(error));
    }
    for (int i = 0; i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            most = fmaxl(most, fabsl(force[c * m->n_node + i]));
    free(force);
    return (double)most;
}

/* Number of cables at a row that have a force. */
static int n_taut(const struct net *net, int row)
{
    int n = 0;
    for (int k = 0; k < 2 * net->model.n_cable; k++)
        n += net->model.end_row[k] == row && net->work.q_N_per_m[k / 2] > 0;
    return n;
}

/* Stiff cables that are cut too short pull with tensions whose rounding alone may exceed the tolerance: then a cable is
 * named. */
static int is_rounding(const struct net *net)
{
    double largest_N = 0;
    for (int e = 0; e < net->model.n_cable; e++)
        largest_N = fmax(largest_N, net->work.tension_N[e]);
    double floor_N = 100 * DBL_EPSILON * largest_N;
    return floor_N > net->form.residual_tolerance * net->model.reference_N && net->result.culprit >= 0 &&
           net->result.n_drifting == 0 && largest_error_N(net) <= floor_N;
}

/* Solved, with nodes that no cable holds or without. */
START_TEST(nets_of_all_laws_are_solved)
{
    double EA[400];
    struct net net;
    int n_loose = 0;
    open_all_laws(&net, _i, EA);
    hf_status status = hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result);
    if (status == HF_NOT_CONVERGED && is_rounding(&net)) {
        close_net(&net);
        return;
    }
    ck_assert_int_eq(status, HF_OK);
    for (int i = 0; i < net.model.n_free; i++)
        n_loose += n_taut(&net, i) == 0;
    ck_assert_int_eq(net.result.n_loose, n_loose);
    ck_assert_int_le(net.result.iterations, MOST_STEPS);
    ck_assert_double_le(largest_error_N(&net), 2e-7); /* 1e-10 of 1e3 N per unit of length error, and of forces */
    close_net(&net);
}
END_TEST

/* ---- against Newton's method ---- */

START_TEST(shape_is_that_of_newton)
{
    struct net net;
    int n_step = 0, culprit = 7;
    OPEN_CASE(&net, SMALL_REFLECTOR, "form.method=newton", "form.residual_tolerance=1e-11",
              "form.length_tolerance=1e-11");
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    double *shape = copy_positions(&net.model, &net.work);
    poison_workspace(&net.model, &net.work);
    net.work.stop = NULL;
    hf_form_prepare(&net.model, &net.work);
    ck_assert_int_eq(hf_interior_run(&net.model, &net.form, &net.work, false, MOST_STEPS, &n_step, &culprit), HF_OK);
    ck_assert_int_eq(culprit, -1);
    ck_assert_int_le(n_step, 12);
    ck_assert_double_le(largest_move_m(&net.model, shape, net.work.position_m), 1e-9);
    free(shape);
    close_net(&net);
}
END_TEST

/* A net a hundred times as long as wide: on the way of the paper's iteration nodes come together, in the answer they do
 * not. */
START_TEST(shape_behind_a_narrow_place_is_found)
{
    struct rng rng = rng_start(730 + (uint64_t)_i);
    struct net net = {.form = tight_form(HF_METHOD_NEWTON)};
    random_reflector_scene(&rng, &net.scene);
    const double wide[3][3] = {{1, 0, 0}, {0, 100, 0}, {0, 0, 1}}, none[3] = {0};
    map_scene(&net.scene, wide, none);
    for (int e = 0; e < net.scene.n_cable; e++)
        if (net.scene.law[e] == HF_LAW_LENGTH) net.scene.target[e] = hf_scene_length_at_target(&net.scene, e);
    net.form.residual_tolerance = net.form.length_tolerance = 1e-9;
    open_net(&net);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_le(net.result.iterations, MOST_STEPS);
    struct verified v = verify_shape(&net.model, &net.work, net.scene.law, net.scene.target);
    ck_assert_double_le(v.residual_N, 1.01e-9 * net.model.reference_N);
    ck_assert_double_le(v.length_gap, 1.01e-9);
    close_net(&net);
}
END_TEST

/* ---- nets without a shape ---- */

/* A straight chain of lengths under load, and two elastic cables that have nothing to do with it. */
START_TEST(chain_beside_an_elastic_pair_is_named)
{
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0, 0}, HF_ROLE_INNER, {0, 0, -1}}, {{2, 0, 0}, HF_ROLE_SUPPORT, {0}},
        {{0, 5, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 5, 0}, HF_ROLE_INNER, {0, 0, -1}}, {{2, 5, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_LENGTH, 1},
                                              {{1, 2}, HF_GROUP_INNER, HF_LAW_LENGTH, 1},
                                              {{3, 4}, HF_GROUP_INNER, HF_LAW_ELASTIC, 1},
                                              {{4, 5}, HF_GROUP_INNER, HF_LAW_ELASTIC, 1}};
    double EA[] = {NAN, NAN, 1000, 1000};
    struct net net = {.form = tight_form(HF_METHOD_NEWTON)};
    hand_scene(&net.scene, 6, node, 4, cable);
    net.scene.EA_N = EA;
    open_net(&net);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_STRAIGHT_CHAIN);
    ck_assert_int_eq(net.result.culprit, 0);
    ck_assert_int_eq(net.result.n_loaded_chain, 1);
    ck_assert_int_le(net.result.iterations, MOST_STEPS);
    close_net(&net);
}
END_TEST

/* Two cables of 0.9 m between supports 2 m apart, without load: no shape, whatever the tension. */
START_TEST(chain_that_is_too_short_is_named)
{
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0, 0}, HF_ROLE_INNER, {0}}, {{2, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_LENGTH, 0.9},
                                              {{1, 2}, HF_GROUP_INNER, HF_LAW_LENGTH, 0.9}};
    struct net net;
    double sum_m, span_m;
    OPEN_HAND(&net, node, cable, _i ? HF_METHOD_NEWTON : HF_METHOD_HIFDM);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_STRAIGHT_CHAIN);
    ck_assert_int_eq(net.result.culprit, 0);
    ck_assert_int_le(net.result.iterations, 70);
    ck_assert(hf_form_chain_is_short(&net.model, &net.work, 0, &sum_m, &span_m));
    ck_assert_double_eq(sum_m, 1.8);
    ck_assert_double_eq(span_m, 2);
    close_net(&net);
}
END_TEST

/* A load of 50 N on a node that is held by two cables of 10 N: it moves away without end. */
START_TEST(node_that_is_not_held_is_named)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{2, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 0.1, 0}, HF_ROLE_INNER, {0, 0, -50}}};
    static const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{2, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_NEWTON);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_SINGULAR);
    ck_assert_int_eq(net.model.node_of_row[net.result.culprit], 2);
    ck_assert_int_le(net.result.iterations, MOST_STEPS);
    close_net(&net);
}
END_TEST

/* A ring of 16 cables of 1 N between four supports, pulled inwards with 10 N at each node: it runs together. */
START_TEST(collapse_takes_few_steps)
{
    enum { N = 16 };
    struct hand_node node[2 * N];
    struct hand_cable cable[2 * N];
    for (int i = 0; i < N; i++) {
        double angle = 2 * acos(-1) * i / N;
        node[i] = (struct hand_node){{cos(angle), sin(angle), 0.01 * (i % 3)}, HF_ROLE_INNER, {0}};
        node[N + i] = (struct hand_node){{3 * cos(angle), 3 * sin(angle), 0}, HF_ROLE_SUPPORT, {0}};
        cable[i] = (struct hand_cable){{i, (i + 1) % N}, HF_GROUP_INNER, HF_LAW_TENSION, 10};
        cable[N + i] = (struct hand_cable){{i, N + i}, HF_GROUP_INNER, HF_LAW_TENSION, 1};
    }
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_NEWTON);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_COLLAPSED);
    ck_assert_int_lt(net.result.culprit, N);
    ck_assert_int_le(net.result.iterations, MOST_STEPS);
    close_net(&net);
}
END_TEST

/* ---- bounds ---- */

START_TEST(steps_are_bounded)
{
    struct net net;
    int n_step = 2, culprit;
    OPEN_CASE(&net, SMALL_REFLECTOR, "form.method=newton", "form.residual_tolerance=1e-11");
    hf_form_prepare(&net.model, &net.work);
    ck_assert_int_eq(hf_interior_run(&net.model, &net.form, &net.work, false, 3, &n_step, &culprit), HF_NOT_CONVERGED);
    ck_assert_int_eq(n_step, 5);
    close_net(&net);
}
END_TEST

START_TEST(stop_is_obeyed)
{
    struct net net;
    int n_step = 0, culprit;
    volatile sig_atomic_t stop = 1;
    OPEN_CASE(&net, SMALL_REFLECTOR, "form.method=newton");
    hf_form_prepare(&net.model, &net.work);
    net.work.stop = &stop;
    ck_assert_int_eq(hf_interior_run(&net.model, &net.form, &net.work, false, MOST_STEPS, &n_step, &culprit),
                     HF_INTERRUPTED);
    ck_assert_int_eq(n_step, 0);
    close_net(&net);
}
END_TEST

Suite *suite_unit_interior(void)
{
    Suite *suite = suite_create("unit/solve/interior");
    TCase *tests = tcase_create("interior");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, nets_of_all_laws_are_solved, 0, 60);
    tcase_add_test(tests, shape_is_that_of_newton);
    tcase_add_loop_test(tests, shape_behind_a_narrow_place_is_found, 0, 4);
    tcase_add_test(tests, chain_beside_an_elastic_pair_is_named);
    tcase_add_loop_test(tests, chain_that_is_too_short_is_named, 0, 2);
    tcase_add_test(tests, node_that_is_not_held_is_named);
    tcase_add_test(tests, collapse_takes_few_steps);
    tcase_add_test(tests, steps_are_bounded);
    tcase_add_test(tests, stop_is_obeyed);
    return suite;
}
