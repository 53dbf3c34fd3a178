/* Laws of classical FDM (Eqs. 1-6) on random nets in tension under load: D is positive definite, one solve each.
 *
 * With up to 60 nodes and force densities over a decade the condition of D stays below 1e5, so roundoff stays below
 * 1e5 * 1e-16 of the largest coordinate: each law is held to 1e-11 of it (observed: below 1e-13).
 * HIFDM_TEST_SEED=... replays a run; the number after the test's name is the trial. */
#include "laws.h"

#include <gsl/gsl_linalg.h>

enum { N_TRIAL = 40 };
#define TOLERANCE 1e-11

static struct net random_net(int trial)
{
    struct rng rng = rng_start((uint64_t)trial);
    struct net net = {.form = tight_form(HF_METHOD_HIFDM)};
    random_fdm_scene(&rng, &net.scene);
    return net;
}

static void assert_same_shape(const double *a, const double *b, int n_node)
{
    double allowed = TOLERANCE * fmax(1, largest(a, 3 * n_node));
    for (int k = 0; k < 3 * n_node; k++)
        ck_assert_double_eq_tol(a[k], b[k], allowed);
}

/* Independent of the library's order of nodes and sums. Backward error: relative to |q| (|x_i| + |x_j|). */
START_TEST(nodes_are_in_equilibrium)
{
    struct net net = random_net(_i);
    open_net(&net);
    ck_assert_int_eq(find_shape(&net), HF_OK);
    const hf_scene *s = &net.scene;
    double *x = copy_shape(&net), size = largest(x, 3 * s->n_node), most = 0;
    for (int i = 0; i < s->n_node; i++) {
        double force[3], scale = 0;
        memcpy(force, s->load_N + 3 * i, sizeof force);
        for (int e = 0; e < s->n_cable; e++)
            for (int side = 0; side < 2; side++) {
                if (s->end[2 * e + side] != i) continue;
                const double *other = x + 3 * s->end[2 * e + 1 - side];
                for (int c = 0; c < 3; c++)
                    force[c] += s->target[e] * (other[c] - x[3 * i + c]);
                scale += s->target[e] * size;
            }
        if (s->role[i] == HF_ROLE_SUPPORT) continue;
        double rest = hypot(hypot(force[0], force[1]), force[2]);
        ck_assert_double_le(rest, 1e-13 * scale);
        most = fmax(most, rest);
    }
    ck_assert_double_eq_tol(net.result.residual_N, most, 1e-12 * size); /* what the library says of itself */
    free(x);
    close_net(&net);
}
END_TEST

START_TEST(scaling_q_and_P_together_leaves_the_shape)
{
    struct net net = random_net(_i), scaled = random_net(_i);
    struct rng rng = rng_start(1000 + (uint64_t)_i);
    double factor = exp(rng_uniform(&rng, -3, 3));
    int n = net.scene.n_node;
    for (int e = 0; e < scaled.scene.n_cable; e++)
        scaled.scene.target[e] *= factor;
    for (int k = 0; k < 3 * n; k++)
        scaled.scene.load_N[k] *= factor;
    double *a = shape_of(&net), *b = shape_of(&scaled);
    assert_same_shape(a, b, n);
    free(a);
    free(b);
}
END_TEST

/* x(t P1 + (1-t) P2) = t x(P1) + (1-t) x(P2) */
START_TEST(shape_is_affine_in_P)
{
    struct net one = random_net(_i), two = random_net(_i), mix = random_net(_i);
    struct rng rng = rng_start(2000 + (uint64_t)_i);
    double t = rng_uniform(&rng, -1, 2);
    int n = one.scene.n_node;
    for (int k = 0; k < 3 * n; k++) {
        two.scene.load_N[k] = rng_uniform(&rng, -2, 2);
        mix.scene.load_N[k] = t * one.scene.load_N[k] + (1 - t) * two.scene.load_N[k];
    }
    double *a = shape_of(&one), *b = shape_of(&two), *c = shape_of(&mix);
    for (int k = 0; k < 3 * n; k++)
        a[k] = t * a[k] + (1 - t) * b[k];
    assert_same_shape(a, c, n);
    free(a);
    free(b);
    free(c);
}
END_TEST

/* Any affine map: shifting, turning, stretching supports and loads does the same to the net. */
START_TEST(moving_supports_and_loads_moves_the_net)
{
    struct net net = random_net(_i), moved = random_net(_i);
    struct rng rng = rng_start(3000 + (uint64_t)_i);
    double m[3][3], t[3];
    int n = net.scene.n_node;
    for (int c = 0; c < 3; c++) {
        t[c] = rng_uniform(&rng, -3, 3);
        for (int d = 0; d < 3; d++)
            m[c][d] = _i % 2 ? c == d : rng_uniform(&rng, -1, 1); /* odd: a shift alone */
    }
    map_scene(&moved.scene, m, t);
    double *a = shape_of(&net), *b = shape_of(&moved);
    for (int i = 0; i < n; i++) {
        double p[3] = {a[3 * i], a[3 * i + 1], a[3 * i + 2]};
        for (int c = 0; c < 3; c++)
            a[3 * i + c] = m[c][0] * p[0] + m[c][1] * p[1] + m[c][2] * p[2] + t[c];
    }
    assert_same_shape(a, b, n);
    free(a);
    free(b);
}
END_TEST

START_TEST(order_of_nodes_and_cables_does_not_matter)
{
    struct net net = random_net(_i), shuffled = random_net(_i);
    struct rng rng = rng_start(4000 + (uint64_t)_i);
    int to[64], n = net.scene.n_node;
    shuffle_scene(&rng, &shuffled.scene, to);
    double *a = shape_of(&net), *b = shape_of(&shuffled), back[3 * 64];
    for (int i = 0; i < n; i++)
        memcpy(back + 3 * i, b + 3 * to[i], 3 * sizeof(double));
    assert_same_shape(a, back, n);
    free(a);
    free(b);
}
END_TEST

/* Eqs. 1, 2, 5 written down as matrices of all nodes, solved by GSL's dense Cholesky in the scene's own order. */
START_TEST(band_agrees_with_dense_gsl)
{
    struct net net = random_net(_i);
    const hf_scene *s = &net.scene;
    int n = s->n_node, n_free = 0, place[64];
    for (int i = 0; i < n; i++)
        place[i] = s->role[i] == HF_ROLE_SUPPORT ? -1 : n_free++;
    gsl_matrix *d = gsl_matrix_calloc((size_t)n_free, (size_t)n_free);
    gsl_vector *b[3];
    for (int c = 0; c < 3; c++)
        b[c] = gsl_vector_calloc((size_t)n_free);
    for (int i = 0; i < n; i++)
        for (int c = 0; c < 3 && place[i] >= 0; c++)
            gsl_vector_set(b[c], (size_t)place[i], s->load_N[3 * i + c]);
    for (int e = 0; e < s->n_cable; e++)
        for (int side = 0; side < 2; side++) {
            int me = s->end[2 * e + side], other = s->end[2 * e + 1 - side];
            if (place[me] < 0) continue;
            *gsl_matrix_ptr(d, (size_t)place[me], (size_t)place[me]) += s->target[e];
            if (place[other] >= 0)
                *gsl_matrix_ptr(d, (size_t)place[me], (size_t)place[other]) -= s->target[e];
            else
                for (int c = 0; c < 3; c++)
                    *gsl_vector_ptr(b[c], (size_t)place[me]) += s->target[e] * s->position_m[3 * other + c];
        }
    ck_assert_int_eq(gsl_linalg_cholesky_decomp1(d), 0);
    double dense[3 * 64];
    memcpy(dense, s->position_m, 3 * (size_t)n * sizeof(double));
    for (int c = 0; c < 3; c++) {
        gsl_linalg_cholesky_svx(d, b[c]);
        for (int i = 0; i < n; i++)
            if (place[i] >= 0) dense[3 * i + c] = gsl_vector_get(b[c], (size_t)place[i]);
        gsl_vector_free(b[c]);
    }
    gsl_matrix_free(d);
    double *shape = shape_of(&net);
    assert_same_shape(dense, shape, n);
    free(shape);
}
END_TEST

Suite *suite_property_fdm(void)
{
    Suite *suite = suite_create("property/fdm");
    TCase *tests = tcase_create("fdm");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, nodes_are_in_equilibrium, 0, N_TRIAL);
    tcase_add_loop_test(tests, scaling_q_and_P_together_leaves_the_shape, 0, N_TRIAL);
    tcase_add_loop_test(tests, shape_is_affine_in_P, 0, N_TRIAL);
    tcase_add_loop_test(tests, moving_supports_and_loads_moves_the_net, 0, N_TRIAL);
    tcase_add_loop_test(tests, order_of_nodes_and_cables_does_not_matter, 0, N_TRIAL);
    tcase_add_loop_test(tests, band_agrees_with_dense_gsl, 0, N_TRIAL);
    return suite;
}
