/* Net and truss in one matrix: the shape of the loop, answers on soft trusses, and what is refused. */
#include "flexible.h"
#include "laws.h"

#include "solve/joint.h"

/* A random net on a random foundation. Its cables are elastic, at about 10 N in the theoretical shape; if mixed, one of
 * three keeps its tension, and one its force density. */
static double *open_elastic(struct net *net, struct rng *rng, bool is_mixed, double EA_N, double scale_m_per_N)
{
    *net = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
    random_tension_scene(rng, &net->scene);
    double *stiffness = malloc((size_t)net->scene.n_cable * sizeof *stiffness);
    ck_assert_ptr_nonnull(stiffness);
    for (int e = 0; e < net->scene.n_cable; e++) {
        double length = hf_scene_length_at_target(&net->scene, e);
        bool is_spring = is_mixed && e % 3 == 1;
        stiffness[e] = EA_N;
        if (is_mixed && e % 3 == 2) continue;
        net->scene.law[e] = is_spring ? HF_LAW_FORCE_DENSITY : HF_LAW_ELASTIC;
        net->scene.target[e] = is_spring ? 10 / length : length / (1 + 10 / EA_N);
    }
    net->scene.EA_N = stiffness;
    open_net(net);
    attach_all(net, rng, scale_m_per_N);
    return stiffness;
}

static void open_reflector(struct net *net, double scale_m_per_N)
{
    struct rng rng = {5}; /* a fixed seed, because the outcome depends on how soft the truss is */
    OPEN_CASE(net, SMALL_REFLECTOR, "form.method=newton", "form.residual_tolerance=1e-12",
              "form.length_tolerance=1e-12");
    attach_all(net, &rng, scale_m_per_N);
}

/* The shape in the workspace, measured by the code of the paper's iteration and of the loop: the energy is convex, so
 * that an equilibrium of net and truss is the answer. */
static void assert_at_rest(struct net *net, double tof_m)
{
    hf_form_result r = {0};
    ck_assert_int_eq(net->result.status, HF_OK);
    ck_assert_int_eq(net->result.coupling.stop_reason, HF_COUPLING_CONVERGED);
    ck_assert_int_eq(hf_form_measure(&net->model, &net->form, &net->work, &r), HF_OK);
    ck_assert_double_le(hf_coupling_measure(&net->model, &net->work, &r), tof_m);
    ck_assert_double_eq(r.coupling.step_m, net->result.coupling.step_m);
    ck_assert_double_eq(r.coupling.deflection_max_m, net->result.coupling.deflection_max_m);
    for (int i = 0; i < 3 * net->model.n_attachment; i++) {
        int at = i % 3 * net->model.n_node + net->model.attachment_row[i / 3];
        ck_assert_double_eq(net->work.position_m[at], net->model.position_m[at] + net->work.displacement_m[i]);
    }
}

/* Without forces the truss has the attachments at their theoretical places, wherever they are. */
START_TEST(gap_is_a_distance)
{
    struct net net;
    open_reflector(&net, 1e-5);
    const hf_model *m = &net.model;
    size_t n = 3 * (size_t)(m->n_free + m->n_attachment);
    double *force = calloc(n, sizeof *force), square = 1, mean_m = hf_joint_mean_length_m(m);
    ck_assert_ptr_nonnull(force);
    hf_form_prepare(m, &net.work);
    hf_form_set_supports(m, &net.work);
    double *x = net.work.position_m + m->attachment_row[1];
    x[0] += 2e-3;
    x[m->n_node] -= 3e-3;
    x[2 * m->n_node] += 6e-3;
    ck_assert_double_eq(hf_joint_gap_m(m, &net.work, net.work.position_m, force, &square), 0); /* they are supports */
    net.work.n_moving = m->n_free + m->n_attachment;
    ck_assert_double_eq_tol(hf_joint_gap_m(m, &net.work, net.work.position_m, force, &square), 7e-3, 1e-12);
    ck_assert_double_eq_tol(square, 1 + 49e-6 / (mean_m * mean_m), 1e-12);
    free(force);
    close_net(&net);
}
END_TEST

/* Trusses on which the plain loop converges; all to 1e-12 m. */
static void assert_the_loops_shape(struct net *net)
{
    ck_assert_int_eq(find_coupled(net, HF_COUPLING_PLAIN, 1e-12), HF_OK);
    double *loop = copy_shape(net);
    ck_assert_int_eq(find_at_once(net, 1e-12), HF_OK);
    assert_at_rest(net, 1e-12);
    ck_assert_int_le(net->result.coupling.iterations, 20);
    ck_assert_double_lt(net->result.position_error_m, 1e-9);
    ck_assert_double_gt(net->result.coupling.deflection_max_m, 1e-5);
    for (int k = 0; k < 3 * net->scene.n_node; k++)
        ck_assert_double_eq_tol(found_m(net, k / 3, k % 3), loop[k], 1e-9);
    free(loop);
}

START_TEST(the_loops_shape_of_a_reflector)
{
    static const double scale[] = {1e-6, 1e-5, 1e-4};
    struct net net;
    open_reflector(&net, scale[_i]);
    assert_the_loops_shape(&net);
    close_net(&net);
}
END_TEST

START_TEST(the_loops_shape_of_elastic_nets)
{
    struct rng rng = rng_start(20 + (uint64_t)_i);
    struct net net;
    double *EA_N = open_elastic(&net, &rng, _i % 2, 1000, 1e-5);
    assert_the_loops_shape(&net);
    close_net(&net);
    free(EA_N);
}
END_TEST

/* Cables of 1e5 N/m and more on springs of 1e2 to 1e4 N/m. */
START_TEST(stiff_cables_on_a_soft_truss)
{
    static const double scale[] = {1e-4, 1e-3, 1e-2};
    struct rng rng = rng_start(30 + (uint64_t)_i);
    struct net net;
    double *EA_N = open_elastic(&net, &rng, false, 1e5, scale[_i % 3]);
    find_at_once(&net, 1e-12);
    assert_at_rest(&net, 1e-12);
    ck_assert_int_le(net.result.coupling.iterations, 20);
    close_net(&net);
    free(EA_N);
}
END_TEST

/* Two elastic cables in line, 2 m in all and cut to 1.98 m, each end on a spring of 1/c in all directions. The cut is
 * taken up by cables and springs, T (l0/EA + 2 c) = 0.02 m. The springs are up to 1e6 times softer than the cables, so
 * that a round of the loop would multiply errors by that. */
START_TEST(one_line_by_hand)
{
    static const double c_m_per_N[] = {1e-9, 1e-5, 1e-3, 1e-1};
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1.2, 0, 0}, HF_ROLE_INNER, {0}}, {{2, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_ELASTIC, 1.2 * 0.99},
                                              {{2, 1}, HF_GROUP_INNER, HF_LAW_ELASTIC, 0.8 * 0.99}};
    double EA_N[] = {2e7, 2e7}, c = c_m_per_N[_i], F[36] = {0};
    struct net net = {.form = tight_form(HF_METHOD_NEWTON)};
    hf_messages messages = {0};
    for (int i = 0; i < 6; i++)
        F[7 * i] = c;
    hand_scene(&net.scene, 3, node, 2, cable);
    net.scene.EA_N = EA_N;
    open_net(&net);
    ck_assert_int_eq(hf_model_attach(&net.model, 2, (int[]){2, 0}, F, &messages), HF_OK);
    hf_workspace_free(&net.work);
    ck_assert_int_eq(hf_workspace_create(&net.model, &net.work), HF_OK);
    find_at_once(&net, 1e-12);
    assert_at_rest(&net, 1e-12);
    double T = 0.02 / (1.98 / 2e7 + 2 * c);
    ck_assert_double_eq_tol(net.work.tension_N[0], T, 1e-8 * T); /* 1e-16 m of a cable of 1e7 N/m */
    ck_assert_double_eq_tol(net.work.tension_N[1], T, 1e-8 * T);
    ck_assert_double_eq_tol(found_m(&net, 0, 0), c * T, 1e-11);
    ck_assert_double_eq_tol(found_m(&net, 2, 0), 2 - c * T, 1e-11);
    close_net(&net);
}
END_TEST

START_TEST(a_rigid_truss_is_a_support)
{
    struct net alone, rigid;
    struct rng rng = rng_start(1);
    OPEN_CASE(&alone, SMALL_REFLECTOR, "form.method=newton");
    OPEN_CASE(&rigid, SMALL_REFLECTOR, "form.method=newton");
    attach_all(&rigid, &rng, 0);
    ck_assert_int_eq(find_coupled(&alone, HF_COUPLING_AUTO, 1e-9), HF_OK);
    ck_assert_int_eq(find_at_once(&rigid, 1e-9), HF_OK);
    ck_assert_int_eq(alone.result.coupling.iterations, 0);
    ck_assert_double_eq(rigid.result.coupling.deflection_max_m, 0);
    for (int k = 0; k < 3 * alone.model.n_node; k++)
        ck_assert_double_eq_tol(alone.work.position_m[k], rigid.work.position_m[k], 1e-12);
    close_net(&alone);
    close_net(&rigid);
}
END_TEST

/* Supports that would have to move by more than the width of the net: its cables of law tension shrink to nothing. */
START_TEST(too_soft)
{
    struct net net;
    open_reflector(&net, 1e-1);
    ck_assert_int_eq(find_at_once(&net, 1e-9), HF_TRUSS_TOO_SOFT);
    ck_assert_int_eq(net.result.coupling.stop_reason, HF_COUPLING_DIVERGED);
    ck_assert(isnan(net.result.psi_m));
    close_net(&net);
}
END_TEST

START_TEST(ill_posed_nets_keep_their_name)
{
    struct net net;
    struct rng rng = rng_start(2);
    OPEN_CASE(&net, "configs/straight-edges.yaml", "form.method=newton", "form.stop=residual");
    attach_all(&net, &rng, 0);
    ck_assert_int_eq(find_at_once(&net, 1e-6), HF_STRAIGHT_CHAIN);
    ck_assert_int_eq(net.result.coupling.stop_reason, HF_COUPLING_NET);
    close_net(&net);
}
END_TEST

START_TEST(a_limit_is_a_limit)
{
    struct net net;
    open_reflector(&net, 1e-4);
    net.form.max_iterations = _i;
    ck_assert_int_eq(find_at_once(&net, 1e-9), HF_NOT_CONVERGED);
    ck_assert_int_eq(net.result.coupling.stop_reason, HF_COUPLING_NET);
    ck_assert_int_le(net.result.iterations, _i);
    ck_assert_double_gt(net.result.coupling.step_m, 1e-9);
    close_net(&net);
}
END_TEST

START_TEST(a_stop_is_a_stop)
{
    struct rng rng = rng_start(3);
    static const volatile sig_atomic_t stop = 1;
    struct net net;
    double *EA_N = open_elastic(&net, &rng, false, 1e5, 1e-3);
    net.work.stop = &stop;
    ck_assert_int_eq(find_at_once(&net, 1e-9), HF_INTERRUPTED);
    close_net(&net);
    free(EA_N);
}
END_TEST

/* ---- either way ---- */

/* On a stiff truss the loop ends at once, and auto is the accelerated loop to the bit. */
START_TEST(auto_is_the_loop_on_stiff_trusses)
{
    struct net net;
    open_reflector(&net, 1e-5);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_ACCELERATED, 1e-9), HF_OK);
    double *loop = copy_shape(&net);
    int n_step = net.result.iterations;
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_AUTO, 1e-9), HF_OK);
    ck_assert_int_eq(net.result.iterations, n_step);
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        ck_assert_double_eq(found_m(&net, k / 3, k % 3), loop[k]);
    free(loop);
    close_net(&net);
}
END_TEST

/* Here the loop leads away, after some rounds or at the first: the shape is that in one matrix. */
START_TEST(auto_leaves_the_loop_on_soft_trusses)
{
    struct net net;
    open_reflector(&net, _i ? 1e-2 : 3e-3);
    ck_assert_int_eq(find_at_once(&net, 1e-10), HF_OK);
    double *at_once = copy_shape(&net);
    int n_step = net.result.iterations;
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_AUTO, 1e-10), HF_OK);
    assert_at_rest(&net, 1e-10);
    ck_assert_int_gt(net.result.iterations, n_step);
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        ck_assert_double_eq_tol(found_m(&net, k / 3, k % 3), at_once[k], 1e-8);
    free(at_once);
    close_net(&net);
}
END_TEST

/* A row for each iteration and step with a shape, and in that of the coupling for each round or step with the truss.
 * Recording changes no bit. */
START_TEST(history_tells_every_step)
{
    enum { ROOM = 1000 };
    static double form[5][ROOM], step_m[ROOM], psi_m[ROOM], max_m[ROOM];
    hf_history history = {ROOM, 0, form[0], form[1], form[2], form[3], form[4], {ROOM, 0, step_m, psi_m, max_m}};
    struct rng rng = rng_start(50);
    struct net net;
    double *EA_N = NULL;
    if (_i)
        EA_N = open_elastic(&net, &rng, true, 1e5, 3e-2);
    else
        open_reflector(&net, 1e-2);
    find_coupled(&net, HF_COUPLING_AUTO, 1e-10);
    assert_at_rest(&net, 1e-10);
    hf_form_result without = net.result;
    double *shape = copy_shape(&net);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, &history, &net.result), HF_OK);
    ck_assert_int_eq(net.result.iterations, without.iterations);
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        ck_assert_double_eq(found_m(&net, k / 3, k % 3), shape[k]);
    int n = history.n, n_round = history.coupling.n;
    int n_without_shape = net.result.iterations - n, n_empty_round = net.result.coupling.iterations - n_round;
    ck_assert(_i == 0 ? n_without_shape >= 0 && n_without_shape <= 2 : n_without_shape == 0);
    ck_assert(_i == 0 ? n_empty_round >= 0 && n_empty_round <= 2 : n_empty_round == 0);
    ck_assert_double_eq_tol(history.psi_m[n - 1], net.result.psi_m, 1e-12);
    ck_assert_double_le(history.residual_N[n - 1], 1e-9 * net.model.reference_N);
    ck_assert_double_gt(history.residual_N[0], history.residual_N[n - 1]);
    ck_assert_double_le(step_m[n_round - 1], 1e-10);
    ck_assert_double_eq(psi_m[n_round - 1], history.psi_m[n - 1]);
    ck_assert_double_eq_tol(max_m[n_round - 1], net.result.coupling.deflection_max_m, 1e-12);
    for (int k = 0; k < n_round; k++)
        ck_assert(isfinite(step_m[k]) && isfinite(psi_m[k]));
    free(shape);
    close_net(&net);
    free(EA_N);
}
END_TEST

Suite *suite_unit_joint(void)
{
    Suite *suite = suite_create("unit/joint");
    TCase *tests = tcase_create("joint");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, gap_is_a_distance);
    tcase_add_loop_test(tests, the_loops_shape_of_a_reflector, 0, 3);
    tcase_add_loop_test(tests, the_loops_shape_of_elastic_nets, 0, 6);
    tcase_add_loop_test(tests, stiff_cables_on_a_soft_truss, 0, 9);
    tcase_add_loop_test(tests, one_line_by_hand, 0, 4);
    tcase_add_test(tests, a_rigid_truss_is_a_support);
    tcase_add_test(tests, too_soft);
    tcase_add_test(tests, ill_posed_nets_keep_their_name);
    tcase_add_loop_test(tests, a_limit_is_a_limit, 1, 8);
    tcase_add_test(tests, a_stop_is_a_stop);
    tcase_add_test(tests, auto_is_the_loop_on_stiff_trusses);
    tcase_add_loop_test(tests, auto_leaves_the_loop_on_soft_trusses, 0, 2);
    tcase_add_loop_test(tests, history_tells_every_step, 0, 2);
    return suite;
}
