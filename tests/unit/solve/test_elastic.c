/* The law elastic: potential, derivative, its two limits, slack cables, and where the law may be used. */
#include "laws.h"

#include "search/chord.h"
#include "solve/newton_matrix.h"
#include "net/symmetry.h"
#include <hifdm/batch.h>

/* A random saddle net. Every third cable is elastic, with an unstrained length that gives it about the 10 N of the
 * others in the theoretical shape; every fourth is a boundary cable. */
static void open_mixed(struct net *net, int trial, double EA_N, double *EA)
{
    struct rng rng = rng_start(300 + (uint64_t)trial);
    *net = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
    random_tension_scene(&rng, &net->scene);
    for (int e = 0; e < net->scene.n_cable; e++) {
        EA[e] = EA_N;
        net->scene.group[e] = e % 4 == 1 ? HF_GROUP_BOUNDARY : HF_GROUP_INNER;
        if (e % 3) continue;
        net->scene.law[e] = HF_LAW_ELASTIC;
        net->scene.target[e] = hf_scene_length_at_target(&net->scene, e) / (1 + net->scene.target[e] / EA_N);
    }
    net->scene.EA_N = EA;
    open_net(net);
}

/* Pi at the workspace's positions, in long double. */
static long double energy(const hf_model *m, const hf_workspace *w)
{
    long double sum = 0;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        long double square = 0;
        for (int c = 0; c < 3; c++) {
            long double d = (long double)w->position_m[c * m->n_node + b] - w->position_m[c * m->n_node + a];
            square += d * d;
        }
        long double l = sqrtl(square), target = w->target[e], over = l - target;
        if (w->law[e] == HF_LAW_TENSION) sum += target * l;
        if (w->law[e] == HF_LAW_ELASTIC && over > 0) sum += m->EA_N[e] * over * over / (2 * target);
    }
    for (int i = 0; m->load_N && i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            sum -= (long double)m->load_N[c * m->n_node + i] * w->position_m[c * m->n_node + i];
    return sum;
}

/* The found shape is where Pi is smallest: the gradient by central differences vanishes, and Pi grows along every
 * random direction. 80-bit differences over 1e-5 m of some 10 N m: 1e-18 * 10 / 1e-5 = 1e-12 N of rounding; third
 * derivatives of up to 1e4 N/m^2 (EA/l^2) times (1e-5)^2 are 1e-6 N. */
START_TEST(found_shape_has_the_least_energy)
{
    double EA[400];
    struct net net;
    open_mixed(&net, _i, 2000, EA);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    const hf_model *m = &net.model;
    double step = 1e-5;
    long double least = energy(m, &net.work);
    for (int i = 0; i < 3 * m->n_free; i++) {
        double *x = net.work.position_m + i % 3 * m->n_node + i / 3, kept = *x;
        *x = kept + step;
        long double up = energy(m, &net.work);
        *x = kept - step;
        long double down = energy(m, &net.work);
        *x = kept;
        ck_assert_double_eq_tol((double)((up - down) / (2 * step)), 0, 2e-6);
        ck_assert(up > least && down > least);
    }
    close_net(&net);
}
END_TEST

/* The Newton matrix is the second difference of Pi. L L' of its factor, dense, against differences over 1e-4 m:
 * fourth derivatives of 1e5 N/m^3 times (1e-4)^2 / 12 are 1e-4 N/m of entries of up to 4000 N/m. */
START_TEST(matrix_is_the_second_derivative_of_the_energy)
{
    double EA[400];
    struct net net;
    open_mixed(&net, _i, 2000, EA);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_eq(hf_newton_matrix_factor(&net.model, &net.work, NULL), HF_OK);
    const hf_model *m = &net.model;
    int n = 3 * m->n_free, ld = 3 * m->half_bandwidth + 3;
    double h = 1e-4;
    struct rng rng = rng_start(310 + (uint64_t)_i);
    for (int trial = 0; trial < 60; trial++) {
        int i = rng_int(&rng, 0, n - 1), j = trial % 3 ? i - i % 3 + rng_int(&rng, 0, 2) : rng_int(&rng, 0, n - 1);
        int high = i > j ? i : j, low = i > j ? j : i;
        double entry = 0;
        for (int k = high - ld + 1 > 0 ? high - ld + 1 : 0; k <= low; k++)
            if (high - k < ld && low - k < ld)
                entry += net.work.newton_band[high - k + k * ld] * net.work.newton_band[low - k + k * ld];
        double *x = net.work.position_m + i % 3 * m->n_node + i / 3;
        double *y = net.work.position_m + j % 3 * m->n_node + j / 3;
        double x0 = *x, y0 = *y;
        long double sum = 0;
        for (int s = 0; s < 4; s++) {
            int to_x = s & 1 ? 1 : -1, to_y = s & 2 ? 1 : -1;
            *x += to_x * h;
            *y += to_y * h;
            sum += to_x * to_y * energy(m, &net.work);
            *x = x0;
            *y = y0;
        }
        ck_assert_double_eq_tol(entry, (double)(sum / (4 * (long double)h * h)), 1e-3);
    }
    close_net(&net);
}
END_TEST

/* A bow of two cables under a load: stiffer and stiffer, its shape and tensions tend to those of the law length, by a
 * constant over EA. */
START_TEST(stiff_cables_keep_their_length)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1.1, 0, -0.1}, HF_ROLE_INNER, {0, 0, -12.5}},
                                            {{2.2, 0, 0.2}, HF_ROLE_SUPPORT, {0}}};
    struct hand_cable cable[] = {{{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1.3},
                                 {{1, 2}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 1.2}};
    struct net rigid, net;
    OPEN_HAND(&rigid, node, cable, HF_METHOD_NEWTON);
    ck_assert_int_eq(hf_evaluate_form(&rigid.model, &rigid.form, &rigid.work, NULL, &rigid.result), HF_OK);
    cable[0].law = cable[1].law = HF_LAW_ELASTIC;
    double before_m = INFINITY;
    for (double EA = 1e3; EA < 1e13; EA *= 100) {
        double both[2] = {EA, EA}, move_m = 0;
        net = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
        hand_scene(&net.scene, 3, node, 2, cable);
        net.scene.EA_N = both;
        open_net(&net);
        ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
        for (int c = 0; c < 3; c++)
            move_m = fmax(move_m, fabs(found_m(&net, 1, c) - found_m(&rigid, 1, c)));
        ck_assert_double_le(move_m, fmax(before_m / 80, 1e-10)); /* a hundredth, until the tolerance of 1e-11 */
        for (int e = 0; e < 2; e++) /* the angles change by some 12 N / EA, and 1/sin^2 of them */
            ck_assert_double_eq_tol(net.work.tension_N[e], rigid.work.tension_N[e], 1000 / EA + 1e-8);
        before_m = move_m;
        close_net(&net);
    }
    close_net(&rigid);
}
END_TEST

/* A third cable that is too long has no tension, and no influence. */
START_TEST(slack_cables_are_legal_and_counted)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 0, -0.3}, HF_ROLE_INNER, {0, 0, -20}},
                                            {{2, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 0, -1}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_ELASTIC, 1.05},
                                              {{1, 2}, HF_GROUP_INNER, HF_LAW_ELASTIC, 1.05},
                                              {{1, 3}, HF_GROUP_INNER, HF_LAW_ELASTIC, 1.5}};
    double EA[] = {500, 500, 500}, z_m[2];
    for (int with_third = 0; with_third < 2; with_third++) {
        struct net net = {.form = tight_form(HF_METHOD_AUTO)};
        hand_scene(&net.scene, with_third ? 4 : 3, node, with_third ? 3 : 2, cable);
        net.scene.EA_N = EA;
        open_net(&net);
        ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
        z_m[with_third] = found_m(&net, 1, 2);
        ck_assert_int_eq(net.result.n_slack, with_third);
        if (with_third) ck_assert_double_eq(net.work.tension_N[2], 0);
        close_net(&net);
    }
    ck_assert_double_eq_tol(z_m[0], z_m[1], 1e-12); /* rounding of 1 m, times a condition of 1e3 */
}
END_TEST

/* The paper's iteration comes to the same shape, for cables that give way as much as the shape does. */
START_TEST(fixed_point_agrees_with_newton)
{
    double EA[400];
    struct net net;
    open_mixed(&net, _i, 50, EA);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    double *newton = malloc(3 * (size_t)net.model.n_node * sizeof *newton);
    ck_assert_ptr_nonnull(newton);
    memcpy(newton, net.work.position_m, 3 * (size_t)net.model.n_node * sizeof *newton);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    for (int i = 0; i < 3 * net.model.n_node; i++) /* 1e-11 of 10 N over a stiffness of some N/m */
        ck_assert_double_eq_tol(net.work.position_m[i], newton[i], 1e-9);
    free(newton);
    close_net(&net);
}
END_TEST

/* Mirror images are equally stiff. */
START_TEST(stiffness_counts_for_symmetry)
{
    static const struct hand_node node[] = {
        {{-1, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 0, 0.1}, HF_ROLE_INNER, {0}}, {{1, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_ELASTIC, 0.9},
                                              {{1, 2}, HF_GROUP_BOUNDARY, HF_LAW_ELASTIC, 0.9}};
    for (int differ = 0; differ < 2; differ++) {
        double EA[] = {500, differ ? 501 : 500};
        int planes = -1;
        hf_messages messages = {0};
        struct net net = {.form = tight_form(HF_METHOD_AUTO)};
        hand_scene(&net.scene, 3, node, 2, cable);
        net.scene.EA_N = EA;
        open_net(&net);
        ck_assert_int_eq(hf_symmetry_apply(&net.scene, &(hf_optimize_settings){.symmetry = HF_SYMMETRY_AUTO},
                                           &net.model, &planes, &messages),
                         HF_OK);
        ck_assert_int_eq(planes & HF_PLANE_X, differ ? 0 : HF_PLANE_X);
        ck_assert_int_eq(net.model.n_leader, differ ? 2 : 1);
        close_net(&net);
    }
}
END_TEST

/* Chord and lanes do not know the law: a population falls back, and gets the same results as one by one. */
START_TEST(populations_fall_back)
{
    double EA[400];
    struct net net;
    open_mixed(&net, 0, 2000, EA);
    hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result);
    int n_variable = net.model.n_variable;
    ck_assert_int_gt(n_variable, 0);
    double *base = malloc(3 * (size_t)n_variable * sizeof *base),
           *start = malloc((size_t)net.model.n_cable * sizeof *start);
    ck_assert(base && start);
    memcpy(start, net.work.q_N_per_m, (size_t)net.model.n_cable * sizeof *start);
    for (int k = 0; k < 3 * n_variable; k++)
        base[k] = net.work.tension_N[net.model.variable_cable[k % n_variable]] * (1 + 0.01 * (k / n_variable));
    static const int solver[] = {HF_SOLVER_AUTO, HF_SOLVER_CHORD, HF_SOLVER_FIXED_POINT};
    static const int used[] = {HF_SOLVER_NEWTON, HF_SOLVER_NEWTON, HF_SOLVER_FIXED_POINT};
    hf_evaluator v = {.model = &net.model,
                      .form = &net.form,
                      .start_q_N_per_m = start,
                      .rule = HF_RULE_FORCE_DENSITY,
                      .solver = (hf_solver)solver[_i],
                      .boundary_ratio_cap = 1e3};
    ck_assert(!hf_chord_applies(&v));
    hf_batch batch;
    hf_form_result together[3], alone;
    ck_assert_int_eq(hf_batch_create(&v, 2, &batch), HF_OK);
    ck_assert_int_eq(hf_batch_share(&batch, base), used[_i]);
    net.form.max_iterations = 3000;
    hf_batch_run(&batch, 3, base, NULL, together);
    for (int i = 0; i < 3; i++) {
        hf_evaluate(&v, base + i * n_variable, &net.work, NULL, &alone);
        ck_assert_int_eq(together[i].status, alone.status);
        ck_assert_mem_eq(&together[i].residual_N, &alone.residual_N, sizeof alone.residual_N);
        if (_i < 2) ck_assert_int_eq(alone.status, HF_OK);
    }
    hf_batch_free(&batch);
    free(base);
    free(start);
    close_net(&net);
}
END_TEST

/* Largest force out of balance in the workspace's shape: elastic cables pull with EA (l/l0 - 1). */
static double imbalance_by_law_N(const struct net *net)
{
    const hf_model *m = &net->model;
    double largest = 0;
    for (int i = 0; i < m->n_free; i++) {
        double force[3];
        for (int c = 0; c < 3; c++)
            force[c] = m->load_N ? m->load_N[c * m->n_node + i] : 0;
        for (int k = 0; k < 2 * m->n_cable; k++) {
            if (m->end_row[k] != i) continue;
            double d[3], square = 0;
            for (int c = 0; c < 3; c++) {
                d[c] =
                    net->work.position_m[c * m->n_node + m->end_row[k ^ 1]] - net->work.position_m[c * m->n_node + i];
                square += d[c] * d[c];
            }
            hf_law_cable cable = hf_workspace_cable(m, &net->work, k / 2);
            for (int c = 0; c < 3; c++)
                force[c] += hf_law_tension_N(cable, sqrt(square)) * d[c] / sqrt(square);
        }
        largest = fmax(largest, hypot(hypot(force[0], force[1]), force[2]));
    }
    return largest;
}

/* Wherever the iteration stopped: the multipliers that it balances are not what the cables pull with there. */
START_TEST(the_residual_has_cables_at_the_tension_of_their_law)
{
    double EA[400];
    struct net net;
    open_mixed(&net, 0, 1e5, EA);
    net.form.method = HF_METHOD_HIFDM;
    for (net.form.max_iterations = 1; net.form.max_iterations < 30; net.form.max_iterations *= 3) {
        hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result);
        double by_law_N = imbalance_by_law_N(&net);
        ck_assert_double_eq_tol(net.result.residual_N, by_law_N, 1e-9 * by_law_N + 1e-9);
        ck_assert_double_gt(by_law_N, 1.01 * hf_form_residual_N(&net.model, &net.work));
    }
    close_net(&net);
}
END_TEST

Suite *suite_unit_elastic(void)
{
    Suite *suite = suite_create("unit/elastic");
    TCase *tests = tcase_create("elastic");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, found_shape_has_the_least_energy, 0, 3);
    tcase_add_loop_test(tests, matrix_is_the_second_derivative_of_the_energy, 0, 3);
    tcase_add_test(tests, stiff_cables_keep_their_length);
    tcase_add_test(tests, slack_cables_are_legal_and_counted);
    tcase_add_loop_test(tests, fixed_point_agrees_with_newton, 0, 3);
    tcase_add_test(tests, stiffness_counts_for_symmetry);
    tcase_add_test(tests, the_residual_has_cables_at_the_tension_of_their_law);
    tcase_add_loop_test(tests, populations_fall_back, 0, 3);
    return suite;
}
