/* Newton's method and its certificate. Contents: scenes - reaching the residual - against other methods - certificate.
 *
 * The tolerance is 1e-9 of the pretension (10 N) and of the lengths. The tests add up the forces again; the rounding of
 * forces of 10 N can change the sum by 1e-14 N, so they allow a thousandth more. */
#include "laws.h"
#include "verified.h"

#include "net/scene_import.h"
#include "solve/certificate.h"
#include <hifdm/evaluate.h>

#define TOLERANCE 1e-9
#define ROUNDED (1.001 * TOLERANCE)

/* ---- scenes ---- */

enum { REFLECTOR, DEEP_41X49, DEEP_31X37, SHALLOW_21X25, LOADED, SPATIAL, MIXED, IMPORTED, N_SCENE };

#define CELLS(n) "configs/reflector.yaml", "scene.parabolic_cylinder.cells_per_module=[" #n ", " #n "]"
#define FOCAL_LENGTH(m) "scene.parabolic_cylinder.focal_length_m=" #m

/* The scene as a user would hand it over, through two CSV files. */
static void through_files(hf_scene *scene)
{
    hf_messages messages = {0};
    const char *nodes_path = temp_path("nodes.csv"), *cables_path = temp_path("cables.csv");
    FILE *nodes = fopen(nodes_path, "w"), *cables = fopen(cables_path, "w");
    ck_assert(nodes && cables);
    fputs("id,x_m,y_m,z_m,role,Fx_N,Fy_N,Fz_N\n", nodes);
    for (int i = 0; i < scene->n_node; i++) {
        const double *x = scene->position_m + 3 * i, *P = scene->load_N + 3 * i;
        fprintf(nodes, "%s,%.17g,%.17g,%.17g,%s,%.17g,%.17g,%.17g\n", scene->node_id[i], x[0], x[1], x[2],
                hf_role_word[scene->role[i]], P[0], P[1], P[2]);
    }
    fputs("id,i,j,group,law,value\n", cables);
    for (int e = 0; e < scene->n_cable; e++) {
        fprintf(cables, "%s,%s,%s,%s,%s,", scene->cable_id[e], scene->node_id[scene->end[2 * e]],
                scene->node_id[scene->end[2 * e + 1]], hf_group_word[scene->group[e]], hf_law_word[scene->law[e]]);
        if (!isnan(scene->target[e])) fprintf(cables, "%.17g", scene->target[e]);
        fputc('\n', cables);
    }
    ck_assert_int_eq(fclose(nodes) | fclose(cables), 0);
    hf_scene_free(scene);
    hf_status status = hf_scene_import(nodes_path, cables_path, (const double[2]){0}, scene, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
}

static void open_scene(struct net *net, int which)
{
    struct rng rng = rng_start((uint64_t)which);
    switch (which) {
    case REFLECTOR:
        OPEN_CASE(net, "configs/reflector.yaml");
        break;
    case DEEP_41X49:
        OPEN_CASE(net, CELLS(4), FOCAL_LENGTH(5));
        break;
    case DEEP_31X37:
        OPEN_CASE(net, CELLS(3), FOCAL_LENGTH(5));
        break;
    case SHALLOW_21X25:
        OPEN_CASE(net, CELLS(2), FOCAL_LENGTH(15));
        break;
    default:
        *net = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
        if (which == LOADED || which == SPATIAL)
            random_tension_scene(&rng, &net->scene);
        else
            random_reflector_scene(&rng, &net->scene);
        for (int k = 0; k < 3 * net->scene.n_node && which == LOADED; k++)
            net->scene.load_N[k] *= 5;
        if (which >= MIXED) mix_laws(&rng, &net->scene);
        if (which == IMPORTED) through_files(&net->scene);
        open_net(net);
    }
    net->form.method = HF_METHOD_NEWTON;
    net->form.residual_tolerance = net->form.length_tolerance = TOLERANCE;
    net->form.max_iterations = 100000;
}

static hf_status find(struct net *net)
{
    return hf_evaluate_form(&net->model, &net->form, &net->work, NULL, &net->result);
}

/* ---- reaching the residual ---- */

START_TEST(reaches_the_residual)
{
    struct net net;
    open_scene(&net, _i);
    ck_assert_int_eq(hf_evaluate_method(&net.model, &net.form, NULL), HF_METHOD_NEWTON);
    ck_assert_msg(find(&net) == HF_OK, "%s", hf_status_word(net.result.status));
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_CONVERGED);
    struct verified v = verify_shape(&net.model, &net.work, net.scene.law, net.scene.target);
    ck_assert_double_le(v.residual_N, ROUNDED * net.model.reference_N);
    ck_assert_double_eq_tol(v.residual_N, net.result.residual_N, 1e-12);
    ck_assert_double_le(v.length_gap, ROUNDED);
    ck_assert_double_ge(v.least_tension_N, 0);
    ck_assert_int_le(net.result.iterations, 60); /* 31 fixed-point ones and at most 30 steps; Eq. 7 takes thousands */
    close_net(&net);
}
END_TEST

/* The converged figures of METHOD section 3, here without their thousands of iterations; half a unit of the last
 * digit. */
START_TEST(reaches_the_published_psi)
{
    static const double psi_mm[] = {41.487, 30.455, 6.6497}, digit_mm[] = {5e-4, 5e-4, 5e-5};
    static const double boundary_ratio[] = {1.15766, 1.15356, 1.01223};
    struct net net;
    open_scene(&net, DEEP_41X49 + _i);
    ck_assert_int_eq(find(&net), HF_OK);
    ck_assert_double_eq_tol(1e3 * net.result.psi_m, psi_mm[_i], digit_mm[_i]);
    ck_assert_double_eq_tol(net.result.boundary_tension_ratio, boundary_ratio[_i], 5e-6);
    close_net(&net);
}
END_TEST

/* ---- against other methods ---- */

/* The softest mode has some 0.1 N/m: a residual of 1e-8 N is up to 1e-7 m. Both are run to 1e-11 of 10 N, 1e-10 N,
 * which is 1e-9 m; the slow iteration stops 10 times farther off than that, hence 1e-8 m (as in tests/property). */
START_TEST(agrees_with_the_fixed_point)
{
    struct net net;
    open_scene(&net, _i);
    net.form.residual_tolerance = net.form.length_tolerance = 1e-11;
    ck_assert_int_eq(find(&net), HF_OK);
    double *by_newton = copy_positions(&net.model, &net.work), psi_m = net.result.psi_m;
    int iterations = net.result.iterations;
    ck_assert_msg(find_shape(&net) == HF_OK, "%s", hf_status_word(net.result.status));
    ck_assert_double_le(largest_move_m(&net.model, by_newton, net.work.position_m), 1e-8);
    ck_assert_double_eq_tol(net.result.psi_m, psi_m, 1e-8);
    ck_assert_int_lt(iterations, net.result.iterations);
    free(by_newton);
    close_net(&net);
}
END_TEST

/* Convergence is quadratic: five digits, 1e-6 to 1e-11, take one or two steps and a solve; linear takes hundreds. */
START_TEST(last_digits_are_cheap)
{
    struct net net;
    open_scene(&net, _i);
    net.form.residual_tolerance = net.form.length_tolerance = 1e-6;
    ck_assert_int_eq(find(&net), HF_OK);
    int before = net.result.iterations;
    net.form.residual_tolerance = net.form.length_tolerance = 1e-11;
    ck_assert_int_eq(find(&net), HF_OK);
    if (before > 30) ck_assert_int_le(net.result.iterations - before, 3); /* else the fixed point reached 1e-6 */
    close_net(&net);
}
END_TEST

/* ---- certificate ---- */

/* A shape of the slow iteration, stopped early, against the Newton shape at 1e-12: what remains of a Newton step is
 * second order, so the estimate is near the truth when both are small; a factor of 10 is promised. */
START_TEST(position_error_is_the_true_error)
{
    static const int scene[] = {REFLECTOR, SHALLOW_21X25, LOADED, SPATIAL, MIXED};
    struct net net;
    open_scene(&net, scene[_i]);
    net.form.residual_tolerance = net.form.length_tolerance = 1e-12;
    ck_assert_int_eq(find(&net), HF_OK);
    double *truth = copy_positions(&net.model, &net.work);
    ck_assert_double_le(net.result.position_error_m, 1e-9);
    net.form.method = HF_METHOD_HIFDM;
    for (double tolerance = 1e-3; tolerance > 1e-9; tolerance /= 10) {
        net.form.residual_tolerance = net.form.length_tolerance = tolerance;
        ck_assert_int_eq(find(&net), HF_OK);
        double error_m = largest_move_m(&net.model, truth, net.work.position_m);
        ck_assert_msg(error_m <= 10 * net.result.position_error_m && net.result.position_error_m <= 10 * error_m,
                      "tolerance %g: %g m, estimated as %g m", tolerance, error_m, net.result.position_error_m);
    }
    free(truth);
    close_net(&net);
}
END_TEST

/* One node is moved by 0.1 um, along each axis: what is left of a Newton step is second order, and the classical shape
 * is linear in its force densities. */
START_TEST(a_known_move_is_the_position_error)
{
    static const int scene[] = {REFLECTOR, LOADED, SPATIAL, MIXED};
    const double move_m = 1e-7;
    struct net net;
    if (_i < 4)
        open_scene(&net, scene[_i]);
    else
        OPEN_CASE(&net, "configs/straight-edges.yaml", "form.method=fdm");
    net.form.residual_tolerance = net.form.length_tolerance = 1e-12;
    ck_assert_int_eq(find(&net), HF_OK);
    for (int c = 0; c < 3; c++) {
        double *x = net.work.position_m + c * net.model.n_node + net.model.n_free / 2, before = *x;
        *x += move_m;
        hf_certify(&net.model, &net.work, &net.result);
        ck_assert_double_eq_tol(net.result.position_error_m, move_m, 1e-2 * move_m);
        *x = before;
    }
    close_net(&net);
}
END_TEST

START_TEST(backward_error_is_residual_over_pull)
{
    struct net net;
    open_scene(&net, MIXED);
    ck_assert_int_eq(find(&net), HF_OK);
    const hf_model *m = &net.model;
    double most = 0;
    for (int i = 0; i < m->n_free; i++) {
        double pull = 0;
        for (int e = 0; e < m->n_cable; e++)
            if (m->end_row[2 * e] == i || m->end_row[2 * e + 1] == i) pull += net.work.tension_N[e];
        most = fmax(most, pull);
    }
    ck_assert_double_eq_tol(net.result.backward_error, net.result.residual_N / most, 1e-12 * net.result.backward_error);
    close_net(&net);
}
END_TEST

Suite *suite_unit_newton(void)
{
    Suite *suite = suite_create("unit/newton");
    TCase *tests = tcase_create("newton");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, reaches_the_residual, 0, N_SCENE);
    tcase_add_loop_test(tests, reaches_the_published_psi, 0, 3);
    tcase_add_loop_test(tests, agrees_with_the_fixed_point, LOADED - 1, N_SCENE);
    tcase_add_loop_test(tests, last_digits_are_cheap, 0, N_SCENE);
    tcase_add_loop_test(tests, position_error_is_the_true_error, 0, 5);
    tcase_add_loop_test(tests, a_known_move_is_the_position_error, 0, 5);
    tcase_add_test(tests, backward_error_is_residual_over_pull);
    return suite;
}
