/* The ill-posed stand-in for the paper's reflector, configs/straight-edges.yaml: its figures at the paper's stop, and
 * that it is refused under the stopping rule residual.
 *
 * Source: Chen, Dong, Song, Chen, Li, Aerospace 2022, 9, 239: psi 6.6 mm, inner ratio 1.0011, boundary ratio 4.8445.
 * The paper prints neither topology nor focal length; METHOD section 10 gives the figures of this stand-in, measured
 * with an independent prototype: 6.60 mm, 1.0013, 4.23 in 67 iterations, and for 10x12 modules with f = 17.6 m 6.60
 * mm, 1.0026, 3.21 in 37. Held to half a unit of their last digit. */
#include "figures.h"
#include "nets.h"

#include <hifdm/batch.h>
#include <hifdm/optimiser.h>

START_TEST(stand_in_at_the_papers_stop)
{
    struct net net;
    OPEN_CASE(&net, "configs/straight-edges.yaml");
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_RMS_CHANGE);
    VERIFY(net.result.iterations, 67, 0, "stand-in: iterations");
    VERIFY(1e3 * net.result.psi_m, 6.60, 0.5e-2, "stand-in: psi, mm");
    VERIFY(net.result.inner_tension_ratio, 1.0013, 0.5e-4, "stand-in: ratio inside");
    VERIFY(net.result.boundary_tension_ratio, 4.23, 0.5e-2, "stand-in: boundary ratio");
    ck_assert_int_eq(net.result.n_loaded_chain, 30); /* the figures come with a warning */
    close_net(&net);
}
END_TEST

/* The same figures to the digits of the program's own first measurement: any change of the numbers shows. Operations
 * may be ordered otherwise by another LAPACK; 67 iterations amplify that to some 1e-12. */
START_TEST(nothing_has_changed)
{
    struct net net;
    OPEN_CASE(&net, "configs/straight-edges.yaml");
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_double_eq_tol(1e3 * net.result.psi_m, 6.602655, 0.5e-6);
    ck_assert_double_eq_tol(net.result.inner_tension_ratio, 1.001262, 0.5e-6);
    ck_assert_double_eq_tol(net.result.boundary_tension_ratio, 4.231525, 0.5e-6);
    close_net(&net);
}
END_TEST

/* psi goes with 1/f^2, and f is printed to 0.05 m: 2 * 0.05/17.6 * 6.6 mm = 0.04 mm. */
START_TEST(finer_net_with_its_own_focal_length)
{
    struct net net;
    OPEN_CASE(&net, "configs/straight-edges.yaml", "scene.parabolic_cylinder.modules=[10, 12]",
              "scene.parabolic_cylinder.focal_length_m=17.6");
    ck_assert_int_eq(find_shape(&net), HF_OK);
    VERIFY(net.result.iterations, 37, 0, "10 x 12 modules: iterations");
    VERIFY(1e3 * net.result.psi_m, 6.60, 4e-2, "10 x 12 modules: psi, mm");
    VERIFY(net.result.inner_tension_ratio, 1.0026, 0.5e-4, "10 x 12 modules: ratio inside");
    VERIFY(net.result.boundary_tension_ratio, 3.21, 0.5e-2, "10 x 12 modules: boundary ratio");
    close_net(&net);
}
END_TEST

/* METHOD section 4: straight boundary chains under lateral load have no finite tension. The program must say so, name
 * them all, and give no number. */
START_TEST(converging_it_is_refused)
{
    struct net net;
    OPEN_CASE(&net, "configs/straight-edges.yaml", "form.stop=residual");
    ck_assert_int_eq(find_shape(&net), HF_STRAIGHT_CHAIN);
    ck_assert_int_eq(net.model.n_chain, 30);
    ck_assert_int_eq(net.result.n_loaded_chain, 30);
    ck_assert(net.result.culprit >= 0 && net.result.culprit < 30);
    ck_assert_double_nan(net.result.psi_m);
    for (int i = 0; i < 30; i++) {
        char name[64];
        int a, b, c;
        ck_assert(hf_form_chain_is_loaded(&net.model, &net.work, i));
        hf_model_chain_name(&net.model, &net.scene, i, name, sizeof name); /* n4_0-n4_1 + n4_1-n4_2: along y */
        ck_assert_msg(sscanf(name, "n%d_%*d-n%d_%*d + n%d_", &a, &b, &c) == 3 && a == b && b == c, "%s", name);
    }
    close_net(&net);
}
END_TEST

/* METHOD section 10: the local optimum within +-1 N is 6.34 mm, by Levenberg-Marquardt on the prototype. A short search
 * comes near it (measured: 6.43 mm after these 60 generations; 6.36 mm after the paper's 50 x 400) and none gets
 * below. */
START_TEST(search_comes_near_the_optimum)
{
    struct net net;
    hf_batch batch;
    hf_optimiser ga;
    OPEN_CASE(&net, "configs/straight-edges.yaml", "optimize.population=16", "optimize.generations=60");
    ck_assert_int_eq(find_shape(&net), HF_OK);
    const hf_model *m = &net.model;
    double start_q[220], initial[120];
    ck_assert(m->n_cable == 220 && m->n_variable == 120);
    memcpy(start_q, net.work.q_N_per_m, sizeof start_q);
    for (int k = 0; k < m->n_variable; k++)
        initial[k] = net.work.tension_N[m->variable_cable[k]];
    const hf_optimize_settings *o = &net.settings.optimize;
    hf_evaluator evaluator = {.model = m,
                              .form = &net.form,
                              .start_q_N_per_m = start_q,
                              .rule = o->rule,
                              .solver = o->solver,
                              .boundary_ratio_cap = o->boundary_ratio_cap};
    ck_assert_int_eq(hf_batch_create(&evaluator, 2, &batch), HF_OK);
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, o, m, initial, &ga), HF_OK);
    do {
        hf_batch_run(&batch, ga.population.n_individual, ga.population.design, ga.population.pending,
                     ga.population.result);
        hf_optimiser_tell(&ga);
    } while (hf_optimiser_next(&ga));
    ck_assert_int_eq(ga.population.stop_reason, HF_POPULATION_GENERATIONS);
    ck_assert_double_ge(1e3 * ga.population.best_psi_m[ga.population.generation], 6.34 - 0.5e-2);
    ck_assert_double_le(1e3 * ga.population.best_psi_m[ga.population.generation], 6.48);
    hf_optimiser_free(&ga);
    hf_batch_free(&batch);
    close_net(&net);
}
END_TEST

Suite *suite_verify_straight_edges(void)
{
    Suite *suite = suite_create("verify/straight_edges");
    TCase *tests = tcase_create("straight_edges");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, stand_in_at_the_papers_stop);
    tcase_add_test(tests, nothing_has_changed);
    tcase_add_test(tests, finer_net_with_its_own_focal_length);
    tcase_add_test(tests, converging_it_is_refused);
    tcase_add_test(tests, search_comes_near_the_optimum);
    return suite;
}
