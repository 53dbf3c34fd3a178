/* Laws of form.prestress: exact on random tied double nets: a triangulated grid over a dish, its image behind it, a tie
 * from each node to its image, the rim supported. HIFDM_TEST_SEED=... replays a run. */
#include "laws.h"

#include "solve/prestress.h"

#include <hifdm/evaluate.h>

enum { N_TRIAL = 12, SIDE_MAX = 7, NODE_MAX = 2 * SIDE_MAX * SIDE_MAX, CABLE_MAX = 7 * SIDE_MAX * SIDE_MAX };

struct double_net {
    int nx, ny, n_cable;
    struct hand_node node[NODE_MAX];
    struct hand_cable cable[CABLE_MAX];
};

static void add_cable(struct double_net *d, int a, int b, double wanted_N)
{
    int is_fixed = d->node[a].role == HF_ROLE_SUPPORT && d->node[b].role == HF_ROLE_SUPPORT;
    if (!is_fixed) d->cable[d->n_cable++] = (struct hand_cable){{a, b}, HF_GROUP_INNER, HF_LAW_TENSION, wanted_N};
}

/* The curvature of its image differs from that of the dish, and nodes are off the grid by up to `jitter_m`. */
static void random_double_net(struct rng *rng, double jitter_m, struct double_net *d)
{
    d->nx = rng_int(rng, 4, SIDE_MAX);
    d->ny = rng_int(rng, 4, SIDE_MAX);
    d->n_cable = 0;
    int n = d->nx * d->ny;
    double bend = rng_uniform(rng, 0.03, 0.1), image_bend = bend * rng_uniform(rng, 0.7, 1.4);
    for (int k = 0; k < n; k++) {
        int i = k % d->nx, j = k / d->nx, is_rim = i == 0 || j == 0 || i == d->nx - 1 || j == d->ny - 1;
        double x = i - (d->nx - 1) / 2.0 + rng_uniform(rng, -jitter_m, jitter_m);
        double y = j - (d->ny - 1) / 2.0 + rng_uniform(rng, -jitter_m, jitter_m), r2 = x * x + y * y;
        hf_role role = is_rim ? HF_ROLE_SUPPORT : HF_ROLE_INNER;
        d->node[k] = (struct hand_node){{x, y, bend * r2}, role, {0}};
        d->node[n + k] = (struct hand_node){{x, y, -4 - image_bend * r2}, role, {0}};
    }
    for (int k = 0; k < 2 * n; k++) {
        int i = k % d->nx, j = k % n / d->nx, has_right = i + 1 < d->nx, has_above = j + 1 < d->ny;
        if (has_right) add_cable(d, k, k + 1, rng_uniform(rng, 8, 12));
        if (has_above) add_cable(d, k, k + d->nx, rng_uniform(rng, 8, 12));
        if (has_right && has_above) add_cable(d, k, k + d->nx + 1, rng_uniform(rng, 8, 12));
        if (k < n) add_cable(d, k, k + n, rng_uniform(rng, 1, 3));
    }
}

static hf_status hold_net(struct net *net, const struct double_net *d)
{
    hf_messages messages = {0};
    *net = (struct net){.form = tight_form(HF_METHOD_AUTO)};
    hand_scene(&net->scene, 2 * d->nx * d->ny, d->node, d->n_cable, d->cable);
    hf_status status = hf_prestress_hold(&net->scene, &net->form, NULL, &messages);
    hf_messages_free(&messages);
    return status;
}

static double held_N(const struct net *net, int e)
{
    return net->scene.target[e] * hf_scene_length_at_target(&net->scene, e);
}

/* No free node moves when the net is solved, and no cable is slack. */
START_TEST(the_solver_finds_the_surface)
{
    struct rng rng = rng_start((uint64_t)_i);
    struct double_net d;
    struct net net;
    random_double_net(&rng, 0.1, &d);
    ck_assert_int_eq(hold_net(&net, &d), HF_OK);
    open_net(&net);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_double_le(net.result.psi_m, 1e-12);
    ck_assert_int_eq(net.result.n_slack, 0);
    close_net(&net);
}
END_TEST

static double distance_from_wishes(const struct net *net, const struct double_net *wished)
{
    double sum = 0;
    for (int e = 0; e < wished->n_cable; e++)
        sum += pow(held_N(net, e) - wished->cable[e].target, 2);
    return sum;
}

/* The tensions are the nearest to what is wanted: those for other wishes hold the same net, and are farther away. */
START_TEST(no_other_tensions_are_nearer)
{
    struct rng rng = rng_start(100 + (uint64_t)_i);
    struct double_net d, other;
    struct net net, rival;
    random_double_net(&rng, 0.1, &d);
    ck_assert_int_eq(hold_net(&net, &d), HF_OK);
    for (int k = 0; k < 10; k++) {
        other = d;
        double change_N = pow(10, rng_uniform(&rng, -3, 1));
        for (int e = 0; e < d.n_cable; e++)
            other.cable[e].target += change_N * rng_uniform(&rng, -0.5, 0.5);
        if (hold_net(&rival, &other) == HF_OK)
            ck_assert_double_lt(distance_from_wishes(&net, &d), distance_from_wishes(&rival, &d) + 1e-12);
        else
            ck_assert_double_gt(change_N, 1);
        hf_scene_free(&rival.scene);
    }
    hf_scene_free(&net.scene);
}
END_TEST

/* Without its ties nothing holds a curved net on its surface. */
START_TEST(missing_ties_are_seen)
{
    struct rng rng = rng_start(200 + (uint64_t)_i);
    struct double_net d;
    struct net net;
    random_double_net(&rng, 0, &d);
    for (int e = d.n_cable - 1; e >= 0; e--)
        if (d.cable[e].end[1] - d.cable[e].end[0] == d.nx * d.ny) d.cable[e] = d.cable[--d.n_cable];
    ck_assert_int_eq(hold_net(&net, &d), HF_BAD_CASE);
    ck_assert_int_eq(net.scene.law[0], HF_LAW_TENSION);
    hf_scene_free(&net.scene);
}
END_TEST

Suite *suite_property_prestress(void)
{
    Suite *suite = suite_create("property/prestress");
    TCase *tests = tcase_create("prestress");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, the_solver_finds_the_surface, 0, N_TRIAL);
    tcase_add_loop_test(tests, no_other_tensions_are_nearer, 0, N_TRIAL);
    tcase_add_loop_test(tests, missing_ties_are_seen, 0, N_TRIAL);
    return suite;
}
