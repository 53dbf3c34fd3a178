/* Laws of the tension law (Eq. 7, iterative FDM) on random quad nets with a fixed perimeter.
 *
 * Iterated to 1e-11 of 10 N. The softest mode of these nets, with tensions near 10 N and cables near 1 m, is stiffer
 * than 0.1 N/m, so positions are right to about 1e-9 m; two runs are compared to 1e-8 m (observed: some 1e-10).
 * HIFDM_TEST_SEED=... replays a run; the number after the test's name is the trial. */
#include "laws.h"

enum { N_TRIAL = 20, N_MAX = 64 };
#define TOLERANCE_M 1e-8

static struct net random_net(int trial)
{
    struct rng rng = rng_start((uint64_t)trial);
    struct net net = {.form = tight_form(HF_METHOD_HIFDM)};
    random_tension_scene(&rng, &net.scene);
    return net;
}

/* Pi = sum T* l - sum P.x, J (METHOD section 2). */
static double potential_J(const hf_scene *s, const double *shape)
{
    double sum = 0;
    for (int e = 0; e < s->n_cable; e++)
        sum += s->target[e] * length_between(shape, s->end + 2 * e);
    for (int k = 0; k < 3 * s->n_node && s->load_N; k++)
        if (s->role[k / 3] != HF_ROLE_SUPPORT) sum -= s->load_N[k] * shape[k];
    return sum;
}

/* Every cable pulls with its T* along its direction: summed here from the scene, in its own order. */
START_TEST(nodes_are_in_equilibrium)
{
    struct net net = random_net(_i);
    open_net(&net);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    const hf_scene *s = &net.scene;
    double *x = copy_shape(&net), force[3 * N_MAX];
    memcpy(force, s->load_N, 3 * (size_t)s->n_node * sizeof(double));
    for (int e = 0; e < s->n_cable; e++)
        for (int c = 0; c < 3; c++) {
            int a = s->end[2 * e], b = s->end[2 * e + 1];
            double pull = s->target[e] / length_between(x, s->end + 2 * e) * (x[3 * b + c] - x[3 * a + c]);
            force[3 * a + c] += pull;
            force[3 * b + c] -= pull;
        }
    for (int i = 0; i < s->n_node; i++)
        if (s->role[i] != HF_ROLE_SUPPORT) ck_assert_double_le(largest(force + 3 * i, 3), 1.1e-10); /* 1e-11 of 10 N */
    for (int e = 0; e < s->n_cable; e++)
        ck_assert_double_eq_tol(net.work.tension_N[e], s->target[e], 1e-8);
    free(x);
    close_net(&net);
}
END_TEST

/* METHOD section 2: Eq. 7 lowers Pi in every iteration. Allowed to rise by roundoff of a sum of 100 terms of 10 J. */
START_TEST(energy_falls_monotonically)
{
    struct net net = random_net(_i);
    double before = INFINITY, first = 0;
    open_net(&net);
    for (int k = 1; k <= 30; k++) {
        net.form.max_iterations = k;
        find_shape(&net);
        double *x = copy_shape(&net), now = potential_J(&net.scene, x);
        free(x);
        ck_assert_msg(now <= before + 1e-11, "iteration %d: %.15g J after %.15g J", k, now, before);
        if (k == 1) first = now;
        before = now;
    }
    ck_assert_double_lt(before, first - 1e-9); /* it does fall */
    close_net(&net);
}
END_TEST

/* Pi is convex: no other shape has less of it. */
START_TEST(the_shape_is_the_minimum)
{
    struct net net = random_net(_i), same = random_net(_i);
    struct rng rng = rng_start(1000 + (uint64_t)_i);
    double *x = shape_of(&net), other[3 * N_MAX];
    double lowest = potential_J(&same.scene, x);
    for (int trial = 0; trial < 100; trial++) {
        double step = pow(10, rng_uniform(&rng, -4, 0));
        for (int k = 0; k < 3 * same.scene.n_node; k++) {
            int is_support = same.scene.role[k / 3] == HF_ROLE_SUPPORT;
            other[k] = x[k] + (is_support ? 0 : rng_uniform(&rng, -step, step));
        }
        ck_assert_double_ge(potential_J(&same.scene, other), lowest - 1e-11);
    }
    free(x);
    hf_scene_free(&same.scene);
}
END_TEST

START_TEST(start_does_not_matter)
{
    struct net net = random_net(_i), other = random_net(_i);
    struct rng rng = rng_start(2000 + (uint64_t)_i);
    double *a = shape_of(&net);
    open_net(&other);
    hf_form_prepare(&other.model, &other.work);
    for (int e = 0; e < other.model.n_cable; e++)
        other.work.q_N_per_m[e] *= exp(rng_uniform(&rng, -1.5, 1.5));
    hf_form_find(&other.model, &other.form, HF_STOP_RESIDUAL, &other.work, NULL, &other.result);
    ck_assert_int_eq(other.result.status, HF_OK);
    double *b = copy_shape(&other);
    for (int k = 0; k < 3 * other.scene.n_node; k++)
        ck_assert_double_eq_tol(a[k], b[k], TOLERANCE_M);
    free(a);
    free(b);
    close_net(&other);
}
END_TEST

START_TEST(order_of_nodes_and_cables_does_not_matter)
{
    struct net net = random_net(_i), shuffled = random_net(_i);
    struct rng rng = rng_start(3000 + (uint64_t)_i);
    int to[N_MAX], n = net.scene.n_node;
    shuffle_scene(&rng, &shuffled.scene, to);
    double *a = shape_of(&net), *b = shape_of(&shuffled);
    for (int k = 0; k < 3 * n; k++)
        ck_assert_double_eq_tol(a[k], b[3 * to[k / 3] + k % 3], TOLERANCE_M);
    free(a);
    free(b);
}
END_TEST

/* Turn, shift and enlarge: tensions are forces, so the shape follows if loads turn but do not grow. */
START_TEST(net_follows_similarity_of_space)
{
    struct net net = random_net(_i), moved = random_net(_i);
    struct rng rng = rng_start(4000 + (uint64_t)_i);
    double rotation[3][3], m[3][3], t[3], size = exp(rng_uniform(&rng, -0.7, 0.7));
    int n = net.scene.n_node;
    random_rotation(&rng, rotation);
    for (int c = 0; c < 3; c++) {
        t[c] = rng_uniform(&rng, -5, 5);
        for (int d = 0; d < 3; d++)
            m[c][d] = size * rotation[c][d];
    }
    map_scene(&moved.scene, m, t);
    for (int k = 0; k < 3 * n; k++)
        moved.scene.load_N[k] /= size;
    double *a = shape_of(&net), *b = shape_of(&moved);
    for (int i = 0; i < n; i++)
        for (int c = 0; c < 3; c++) {
            double expected = m[c][0] * a[3 * i] + m[c][1] * a[3 * i + 1] + m[c][2] * a[3 * i + 2] + t[c];
            ck_assert_double_eq_tol(b[3 * i + c], expected, TOLERANCE_M * fmax(1, size));
        }
    free(a);
    free(b);
}
END_TEST

START_TEST(scaling_T_and_P_together_leaves_the_shape)
{
    struct net net = random_net(_i), scaled = random_net(_i);
    struct rng rng = rng_start(5000 + (uint64_t)_i);
    double factor = exp(rng_uniform(&rng, -2, 2));
    int n = net.scene.n_node;
    for (int e = 0; e < scaled.scene.n_cable; e++)
        scaled.scene.target[e] *= factor;
    for (int k = 0; k < 3 * n; k++)
        scaled.scene.load_N[k] *= factor;
    scaled.form.pretension_N *= factor; /* what the residual is relative to */
    double *a = shape_of(&net), *b = shape_of(&scaled);
    for (int k = 0; k < 3 * n; k++)
        ck_assert_double_eq_tol(a[k], b[k], TOLERANCE_M);
    free(a);
    free(b);
}
END_TEST

Suite *suite_property_tension(void)
{
    Suite *suite = suite_create("property/tension");
    TCase *tests = tcase_create("tension");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, nodes_are_in_equilibrium, 0, N_TRIAL);
    tcase_add_loop_test(tests, energy_falls_monotonically, 0, N_TRIAL);
    tcase_add_loop_test(tests, the_shape_is_the_minimum, 0, N_TRIAL);
    tcase_add_loop_test(tests, start_does_not_matter, 0, N_TRIAL);
    tcase_add_loop_test(tests, order_of_nodes_and_cables_does_not_matter, 0, N_TRIAL);
    tcase_add_loop_test(tests, net_follows_similarity_of_space, 0, N_TRIAL);
    tcase_add_loop_test(tests, scaling_T_and_P_together_leaves_the_shape, 0, N_TRIAL);
    return suite;
}
