/* Laws of HIFDM (Eqs. 7 and 8 together) on random scalloped reflectors.
 *
 * Iterated to 1e-10 of the pretension and of the lengths. The shape is soft sideways, some 0.1 N/m: out of a residual
 * of 1e-9 N come up to 1e-8 m, and two runs are compared to that (observed: below 1e-10 m). HIFDM_TEST_SEED=...
 * replays a run; the number after the test's name is the trial. */
#include "laws.h"

enum { N_TRIAL = 10, N_MAX = 81 };
#define TOLERANCE_M 1e-8

static struct net random_net(int trial)
{
    struct rng rng = rng_start((uint64_t)trial);
    struct net net = {.form = tight_form(HF_METHOD_HIFDM)};
    net.form.residual_tolerance = net.form.length_tolerance = 1e-10;
    random_reflector_scene(&rng, &net.scene);
    return net;
}

static void find(struct net *net)
{
    open_net(net);
    ck_assert_msg(find_shape(net) == HF_OK, "%s", hf_status_word(net->result.status));
}

/* The optimality conditions of the convex programme: equilibrium, l <= L*, T >= 0, and either l = L* or T = 0. */
START_TEST(optimality_conditions_hold)
{
    struct net net = random_net(_i);
    find(&net);
    const hf_scene *s = &net.scene;
    double *x = copy_shape(&net), force[3 * N_MAX] = {0};
    for (int e = 0; e < s->n_cable; e++) {
        const int *end = s->end + 2 * e;
        double length_m = length_between(x, end), tension_N = net.work.tension_N[e];
        if (s->law[e] == HF_LAW_LENGTH) {
            double excess = length_m / s->target[e] - 1; /* NaN nowhere: law length has a target */
            ck_assert_double_le(excess, 1e-10);
            ck_assert_double_ge(tension_N, 0);
            ck_assert_double_le(fabs(excess) * fmin(tension_N / 10, 1), 1e-10);
        } else {
            tension_N = 10;
            ck_assert_double_eq_tol(net.work.tension_N[e], 10, 1e-7);
        }
        for (int c = 0; c < 3; c++) {
            double pull = tension_N / length_m * (x[3 * end[1] + c] - x[3 * end[0] + c]);
            force[3 * end[0] + c] += pull;
            force[3 * end[1] + c] -= pull;
        }
    }
    for (int i = 0; i < s->n_node; i++)
        if (s->role[i] != HF_ROLE_SUPPORT) ck_assert_double_le(largest(force + 3 * i, 3), 1.1e-9);
    free(x);
    close_net(&net);
}
END_TEST

/* With the boundary tensions as multipliers the Lagrangian sum T* l + sum T (l - L*) is convex and lowest here. */
START_TEST(the_shape_is_the_minimum)
{
    struct net net = random_net(_i);
    struct rng rng = rng_start(1000 + (uint64_t)_i);
    find(&net);
    const hf_scene *s = &net.scene;
    double *x = copy_shape(&net), other[3 * N_MAX];
    for (int trial = 0; trial < 100; trial++) {
        double step = pow(10, rng_uniform(&rng, -4, -1)), more = 0;
        for (int k = 0; k < 3 * s->n_node; k++)
            other[k] = x[k] + (s->role[k / 3] == HF_ROLE_SUPPORT ? 0 : rng_uniform(&rng, -step, step));
        for (int e = 0; e < s->n_cable; e++) {
            double tension_N = s->law[e] == HF_LAW_LENGTH ? net.work.tension_N[e] : 10;
            more += tension_N * (length_between(other, s->end + 2 * e) - length_between(x, s->end + 2 * e));
        }
        ck_assert_double_ge(more, -1e-9 * step * 3 * s->n_node); /* residual times step */
    }
    free(x);
    close_net(&net);
}
END_TEST

START_TEST(start_does_not_matter)
{
    struct net net = random_net(_i), other = random_net(_i);
    struct rng rng = rng_start(2000 + (uint64_t)_i);
    find(&net);
    open_net(&other);
    hf_form_prepare(&other.model, &other.work);
    for (int e = 0; e < other.model.n_cable; e++)
        other.work.q_N_per_m[e] *= exp(rng_uniform(&rng, -0.5, 0.5));
    hf_form_find(&other.model, &other.form, HF_STOP_RESIDUAL, &other.work, NULL, &other.result);
    ck_assert_int_eq(other.result.status, HF_OK);
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        ck_assert_double_eq_tol(found_m(&net, k / 3, k % 3), found_m(&other, k / 3, k % 3), TOLERANCE_M);
    close_net(&net);
    close_net(&other);
}
END_TEST

/* psi, tension ratios and the shape itself survive renaming, turning and shifting. */
START_TEST(order_and_frame_do_not_matter)
{
    struct net net = random_net(_i), other = random_net(_i);
    struct rng rng = rng_start(3000 + (uint64_t)_i);
    double m[3][3], t[3] = {rng_uniform(&rng, -5, 5), rng_uniform(&rng, -5, 5), rng_uniform(&rng, -5, 5)};
    int to[N_MAX];
    random_rotation(&rng, m);
    map_scene(&other.scene, m, t);
    shuffle_scene(&rng, &other.scene, to);
    find(&net);
    find(&other);
    for (int i = 0; i < net.scene.n_node; i++)
        for (int c = 0; c < 3; c++) {
            double expected = t[c];
            for (int d = 0; d < 3; d++)
                expected += m[c][d] * found_m(&net, i, d);
            ck_assert_double_eq_tol(found_m(&other, to[i], c), expected, TOLERANCE_M);
        }
    ck_assert_double_eq_tol(net.result.psi_m, other.result.psi_m, TOLERANCE_M);
    ck_assert_double_eq_tol(net.result.boundary_tension_ratio, other.result.boundary_tension_ratio, 1e-6);
    close_net(&net);
    close_net(&other);
}
END_TEST

/* The reflector is symmetric in x, so its shape and its tensions are. */
START_TEST(symmetry_is_kept)
{
    struct net net = random_net(_i);
    find(&net);
    for (int i = 0; i < net.scene.n_node; i++) {
        int mirror = -1, a, j, nx = 0;
        while (net.scene.position_m[3 * nx + 3] > net.scene.position_m[3 * nx])
            nx++; /* the first row ends at nx */
        ck_assert_int_eq(sscanf(net.scene.node_id[i], "n%d_%d", &a, &j), 2);
        mirror = j * (nx + 1) + nx - a;
        ck_assert_double_eq_tol(found_m(&net, i, 0), -found_m(&net, mirror, 0), TOLERANCE_M);
        ck_assert_double_eq_tol(found_m(&net, i, 1), found_m(&net, mirror, 1), TOLERANCE_M);
        ck_assert_double_eq_tol(found_m(&net, i, 2), found_m(&net, mirror, 2), TOLERANCE_M);
    }
    close_net(&net);
}
END_TEST

/* Twice the pretension: the same shape, twice the boundary tensions. */
START_TEST(pretension_scales_tensions_only)
{
    struct net net = random_net(_i), tighter = random_net(_i);
    struct rng rng = rng_start(4000 + (uint64_t)_i);
    double factor = exp(rng_uniform(&rng, -2, 2));
    tighter.form.pretension_N *= factor;
    find(&net);
    find(&tighter);
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        ck_assert_double_eq_tol(found_m(&net, k / 3, k % 3), found_m(&tighter, k / 3, k % 3), TOLERANCE_M);
    for (int e = 0; e < net.scene.n_cable; e++) /* 1e-6 of 10 N: the multipliers converge last */
        ck_assert_double_eq_tol(net.work.tension_N[e], tighter.work.tension_N[e] / factor, 1e-5);
    close_net(&net);
    close_net(&tighter);
}
END_TEST

Suite *suite_property_hifdm(void)
{
    Suite *suite = suite_create("property/hifdm");
    TCase *tests = tcase_create("hifdm");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, optimality_conditions_hold, 0, N_TRIAL);
    tcase_add_loop_test(tests, the_shape_is_the_minimum, 0, N_TRIAL);
    tcase_add_loop_test(tests, start_does_not_matter, 0, N_TRIAL);
    tcase_add_loop_test(tests, order_and_frame_do_not_matter, 0, N_TRIAL);
    tcase_add_loop_test(tests, symmetry_is_kept, 0, N_TRIAL);
    tcase_add_loop_test(tests, pretension_scales_tensions_only, 0, N_TRIAL);
    return suite;
}
