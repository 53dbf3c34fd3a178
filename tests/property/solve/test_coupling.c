/* Random nets on random elastic foundations: the plain loop, the accelerated loop, one matrix for both and the
 * population solver find the same shape, and moving net, loads and foundation together as a rigid body moves the shape
 * in the same way. */
#include "flexible.h"
#include "laws.h"
#include "population.h"

#include <hifdm/batch.h>

/* Flexibilities over two decades: the plain loop contracts by 0.5 or better. */
static double random_scale(struct rng *rng)
{
    return exp(rng_uniform(rng, log(1e-6), log(1e-4)));
}

static void open_random(struct net *net, struct rng *rng, int is_tension)
{
    *net = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
    if (is_tension)
        random_tension_scene(rng, &net->scene);
    else
        random_reflector_scene(rng, &net->scene);
    open_net(net);
}

/* 1e-9 m: forces to 1e-10 N where the net is softest, some 0.1 N/m. */
START_TEST(plain_and_accelerated_agree)
{
    struct rng rng = rng_start(300 + (uint64_t)_i);
    struct net net;
    open_random(&net, &rng, _i % 2);
    attach_all(&net, &rng, random_scale(&rng));
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_PLAIN, 1e-12), HF_OK);
    double *plain = copy_shape(&net);
    int n_plain = net.result.coupling.iterations;
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_ACCELERATED, 1e-12), HF_OK);
    ck_assert_int_le(net.result.coupling.iterations, n_plain + 1);
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        ck_assert_double_eq_tol(found_m(&net, k / 3, k % 3), plain[k], 1e-9);
    free(plain);
    close_net(&net);
}
END_TEST

/* Nets of all laws on trusses from stiff to so soft that the supports leave. Where the loop ends, the shape in one
 * matrix is the same; where it does not, there is a shape all the same, or the cables of law tension have shrunk. */
START_TEST(one_matrix_serves_all)
{
    struct rng rng = rng_start(600 + (uint64_t)_i);
    struct net net = {.form = tight_form(HF_METHOD_NEWTON)};
    double EA_N[256], stiffness = exp(rng_uniform(&rng, log(1e2), log(1e6))), tof_m = 1e-10;
    random_tension_scene(&rng, &net.scene);
    ck_assert_int_le(net.scene.n_cable, 256);
    int share = rng_int(&rng, 1, 4);
    for (int e = 0; e < net.scene.n_cable; e++) {
        double length = hf_scene_length_at_target(&net.scene, e);
        EA_N[e] = stiffness;
        if (rng_int(&rng, 0, 3) >= share) continue;
        net.scene.law[e] = HF_LAW_ELASTIC;
        net.scene.target[e] = length / (1 + rng_uniform(&rng, 5, 15) / stiffness);
    }
    net.scene.EA_N = EA_N;
    open_net(&net);
    attach_all(&net, &rng, exp(rng_uniform(&rng, log(1e-6), log(1e-1))));
    bool is_looped = find_coupled(&net, HF_COUPLING_ACCELERATED, tof_m) == HF_OK;
    double *loop = copy_shape(&net);
    hf_status status = find_at_once(&net, tof_m);
    ck_assert_msg(status == HF_OK || (status == HF_TRUSS_TOO_SOFT && !is_looped), "%s", hf_status_word(status));
    ck_assert_int_le(net.result.iterations, 20); /* 13 seen */
    for (int k = 0; k < 3 * net.scene.n_node && is_looped; k++)
        ck_assert_double_eq_tol(found_m(&net, k / 3, k % 3), loop[k], 1e-8);
    double *at_once = copy_shape(&net);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_AUTO, tof_m), status);
    for (int k = 0; k < 3 * net.scene.n_node && status == HF_OK; k++)
        ck_assert_double_eq_tol(found_m(&net, k / 3, k % 3), at_once[k], 1e-8);
    free(at_once);
    free(loop);
    close_net(&net);
}
END_TEST

/* The designs of one population, solved together by chord and one at a time by hf_evaluate. */
START_TEST(chord_agrees)
{
    struct rng rng = rng_start(400 + (uint64_t)_i);
    struct run r = {.net = {.form = tight_form(HF_METHOD_HIFDM)}};
    hf_batch batch;
    random_reflector_scene(&rng, &r.net.scene);
    open_net(&r.net);
    start_run(&r, HF_RULE_FORCE_DENSITY);
    attach_all(&r.net, &rng, random_scale(&rng));
    r.net.form.coupling = (hf_coupling_settings){1e-11, HF_COUPLING_ACCELERATED, 200};
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 1, &batch), HF_OK);
    ck_assert_int_eq(hf_batch_share(&batch, r.initial), HF_SOLVER_CHORD);
    for (int i = 0; i < 8; i++) {
        hf_form_result chord, alone;
        hf_workspace *w = hf_batch_run_one(&batch, design(&r, i), &chord);
        ck_assert_int_eq(chord.status, HF_OK);
        ck_assert_int_eq(hf_evaluate(&r.evaluator, design(&r, i), &r.net.work, NULL, &alone), HF_OK);
        for (int k = 0; k < 3 * r.net.model.n_node; k++) /* 1e-9 N over some 0.1 N/m */
            ck_assert_double_eq_tol(w->position_m[k], r.net.work.position_m[k], 1e-8);
    }
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

/* Net, loads and foundation turned and shifted together: F -> R F R'. The shape turns with them. */
START_TEST(rotation_takes_everything_along)
{
    struct rng rng = rng_start(500 + (uint64_t)_i), again;
    struct net here, there;
    double turn[3][3], shift[3], scale = random_scale(&rng);
    random_rotation(&rng, turn);
    for (int c = 0; c < 3; c++)
        shift[c] = rng_uniform(&rng, -3, 3);
    again = rng;
    open_random(&here, &rng, 1);
    there = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
    random_tension_scene(&again, &there.scene);
    map_scene(&there.scene, turn, shift);
    open_net(&there);
    int node[MAX_ATTACHMENT], n = list_supports(&here, node);
    hf_messages messages = {0};
    double *f = random_flexibility(&rng, n, scale), *g = calloc((size_t)(9 * n * n), sizeof *g);
    ck_assert_ptr_nonnull(g);
    for (int i = 0; i < 3 * n; i++)
        for (int j = 0; j < 3 * n; j++)
            for (int k = 0; k < 9; k++)
                g[i * 3 * n + j] +=
                    turn[i % 3][k / 3] * f[(i / 3 * 3 + k / 3) * 3 * n + j / 3 * 3 + k % 3] * turn[j % 3][k % 3];
    struct net *net[] = {&here, &there};
    for (int k = 0; k < 2; k++) {
        ck_assert_int_eq(hf_model_attach(&net[k]->model, n, node, k ? g : f, &messages), HF_OK);
        hf_workspace_free(&net[k]->work);
        ck_assert_int_eq(hf_workspace_create(&net[k]->model, &net[k]->work), HF_OK);
        ck_assert_int_eq(find_coupled(net[k], HF_COUPLING_ACCELERATED, 1e-12), HF_OK);
    }
    ck_assert_double_gt(here.result.coupling.deflection_max_m, 1e-6);
    for (int i = 0; i < here.scene.n_node; i++)
        for (int c = 0; c < 3; c++) {
            double expected = shift[c];
            for (int d = 0; d < 3; d++)
                expected += turn[c][d] * found_m(&here, i, d);
            ck_assert_double_eq_tol(found_m(&there, i, c), expected, 1e-9);
        }
    free(f);
    free(g);
    close_net(&here);
    close_net(&there);
}
END_TEST

Suite *suite_property_coupling(void)
{
    Suite *suite = suite_create("property/coupling");
    TCase *tests = tcase_create("coupling");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, plain_and_accelerated_agree, 0, 12);
    tcase_add_loop_test(tests, one_matrix_serves_all, 0, 30);
    tcase_add_loop_test(tests, chord_agrees, 0, 6);
    tcase_add_loop_test(tests, rotation_takes_everything_along, 0, 4);
    return suite;
}
