/* A search with linked genes: every design, the shape found and the refined optimum are symmetric. */
#include "nets.h"

#include <hifdm/batch.h>
#include <hifdm/optimiser.h>
#include "search/refine.h"
#include "net/symmetry.h"

enum { N_VARIABLE = 120, N_CABLE = 220, N_GENERATION = 15 };

struct search {
    struct net net;
    hf_evaluator evaluator;
    hf_batch batch;
    hf_optimiser ga;
    double start_q[N_CABLE], initial[N_VARIABLE];
};

/* The tolerance is tight so that what is seen of the shape is symmetry and not where the solver stopped. */
static void open_search(struct search *s)
{
    hf_messages messages = {0};
    int planes;
    OPEN_CASE(&s->net, "configs/straight-edges.yaml", "optimize.symmetry=xy", "optimize.population=16",
              "optimize.generations=15", "form.residual_tolerance=1e-12");
    hf_model *m = &s->net.model;
    ck_assert(m->n_variable == N_VARIABLE && m->n_cable == N_CABLE);
    ck_assert_int_eq(hf_symmetry_apply(&s->net.scene, &s->net.settings.optimize, m, &planes, &messages), HF_OK);
    ck_assert_int_eq(m->n_leader, 30);
    ck_assert_int_eq(find_shape(&s->net), HF_OK);
    memcpy(s->start_q, s->net.work.q_N_per_m, sizeof s->start_q);
    for (int k = 0; k < m->n_variable; k++)
        s->initial[k] = s->net.work.tension_N[m->variable_cable[k]];
    hf_symmetry_average(m, s->initial);
    s->evaluator = (hf_evaluator){.model = m,
                                  .form = &s->net.form,
                                  .start_q_N_per_m = s->start_q,
                                  .rule = HF_RULE_FORCE_DENSITY,
                                  .solver = HF_SOLVER_AUTO,
                                  .boundary_ratio_cap = 100};
    ck_assert_int_eq(hf_batch_create(&s->evaluator, 2, &s->batch), HF_OK);
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, &s->net.settings.optimize, m, s->initial, &s->ga), HF_OK);
}

static void close_search(struct search *s)
{
    hf_optimiser_free(&s->ga);
    hf_batch_free(&s->batch);
    close_net(&s->net);
}

/* To the bit. */
static void demand_symmetric_design(const struct search *s, const double *design)
{
    for (int k = 0; k < N_VARIABLE; k++)
        ck_assert_double_eq(design[k], design[s->net.model.variable_leader[k]]);
}

/* The generator numbers nodes j * 11 + i, so the mirror images are known. The largest difference of a position from
 * that of its image, m. */
static double asymmetry_m(const hf_model *m, const hf_workspace *w)
{
    double largest = 0;
    for (int j = 0; j < 11; j++)
        for (int i = 0; i < 11; i++) {
            int row = m->row_of_node[j * 11 + i], by_x = m->row_of_node[j * 11 + 10 - i],
                by_y = m->row_of_node[(10 - j) * 11 + i];
            const double *x = w->position_m, *y = x + m->n_node, *z = y + m->n_node;
            double d[] = {x[row] + x[by_x], y[row] - y[by_x],      z[row] - z[by_x],
                          x[row] - x[by_y], y[row] + y[by_y] - 12, z[row] - z[by_y]};
            for (int c = 0; c < 6; c++)
                largest = fmax(largest, fabs(d[c]));
        }
    return largest;
}

static void evolve(struct search *s)
{
    do {
        hf_batch_run(&s->batch, s->ga.population.n_individual, s->ga.population.design, s->ga.population.pending,
                     s->ga.population.result);
        hf_optimiser_tell(&s->ga);
        for (int i = 0; i < s->ga.population.n_individual; i++) {
            const double *design = s->ga.population.design + i * N_VARIABLE;
            demand_symmetric_design(s, design);
            for (int k = 0; k < N_VARIABLE; k++)
                ck_assert(design[k] >= s->ga.population.lower[k] && design[k] <= s->ga.population.upper[k]);
        }
    } while (hf_optimiser_next(&s->ga));
}

/* 1e-9 m: a residual of 1e-11 N on a net whose softest mode gives about 1 m/N (condition 5e6, stiffness 1e6 N/m). */
START_TEST(what_a_symmetric_search_finds_is_symmetric)
{
    struct search s;
    hf_form_result found;
    hf_refine_result refined;
    double design[N_VARIABLE];
    open_search(&s);
    demand_symmetric_design(&s, s.initial);
    ck_assert_int_eq(hf_batch_share(&s.batch, s.initial), HF_SOLVER_CHORD);
    evolve(&s);
    ck_assert_double_lt(s.ga.population.best_psi_m[s.ga.population.generation],
                        s.ga.population.best_psi_m[0]); /* it moved */
    memcpy(design, s.ga.population.design + s.ga.population.best * N_VARIABLE, sizeof design);
    ck_assert_int_eq(hf_evaluate(&s.evaluator, design, &s.net.work, NULL, &found), HF_OK);
    ck_assert_double_lt(asymmetry_m(&s.net.model, &s.net.work), 1e-9);
    ck_assert_int_eq(hf_refine_run(&s.evaluator, s.ga.population.lower, s.ga.population.upper, 20, NULL, NULL, design,
                                   &s.net.work, &refined),
                     HF_OK);
    ck_assert_double_lt(refined.merit, found.psi_m);
    demand_symmetric_design(&s, design);
    ck_assert_int_eq(hf_evaluate(&s.evaluator, design, &s.net.work, NULL, &found), HF_OK);
    ck_assert_double_lt(asymmetry_m(&s.net.model, &s.net.work), 1e-9);
    close_search(&s);
}
END_TEST

/* The optimum of a symmetric, well-posed net is symmetric: with 22 variables Levenberg-Marquardt ends where it ends
 * with all 88, only sooner. 1e-7: both stop at a relative change of psi^2 of 1e-14 or when no step helps any more. */
START_TEST(refining_linked_variables_reaches_the_free_optimum)
{
    double psi_m[2];
    for (int linked = 0; linked < 2; linked++) {
        struct net net;
        hf_messages messages = {0};
        hf_refine_result refined;
        int planes;
        double start_q[1000], design[200], lower[200], upper[200];
        OPEN_CASE(&net, SMALL_REFLECTOR);
        ck_assert(net.model.n_variable <= 200 && net.model.n_cable <= 1000);
        int wanted = linked ? HF_SYMMETRY_XY : HF_SYMMETRY_NONE;
        ck_assert_int_eq(hf_symmetry_apply(&net.scene, &(hf_optimize_settings){.symmetry = (hf_symmetry)wanted},
                                           &net.model, &planes, &messages),
                         HF_OK);
        ck_assert_int_eq(find_shape(&net), HF_OK);
        memcpy(start_q, net.work.q_N_per_m, (size_t)net.model.n_cable * sizeof(double));
        for (int k = 0; k < net.model.n_variable; k++)
            design[k] = net.work.tension_N[net.model.variable_cable[k]];
        hf_symmetry_average(&net.model, design);
        for (int k = 0; k < net.model.n_variable; k++)
            lower[k] = design[k] - 1, upper[k] = design[k] + 1;
        hf_evaluator v = {.model = &net.model,
                          .form = &net.form,
                          .start_q_N_per_m = start_q,
                          .rule = HF_RULE_FORCE_DENSITY,
                          .solver = HF_SOLVER_NEWTON,
                          .boundary_ratio_cap = 100};
        ck_assert_int_eq(hf_refine_run(&v, lower, upper, 200, NULL, NULL, design, &net.work, &refined), HF_OK);
        psi_m[linked] = refined.merit;
        ck_assert_double_lt(refined.merit, refined.start_merit);
        close_net(&net);
    }
    ck_assert_double_eq_tol(psi_m[1] / psi_m[0], 1, 1e-7);
}
END_TEST

Suite *suite_property_symmetry(void)
{
    Suite *suite = suite_create("property/symmetry");
    TCase *tests = tcase_create("symmetry");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, what_a_symmetric_search_finds_is_symmetric);
    tcase_add_test(tests, refining_linked_variables_reaches_the_free_optimum);
    return suite;
}
