/* Laws of the whole search, GA and batch together, on 3 x 3 modules of the paper's net, where the boundary tensions
 * matter: on what a run depends, that it respects bounds and cap, and that psi falls. */
#include "nets.h"

#include <hifdm/batch.h>
#include <hifdm/optimiser.h>

enum { MAX_VARIABLE = 200, MAX_CABLE = 400, N_GENERATION = 12, MAX_POPULATION = 30 };

struct search {
    struct net net;
    hf_optimize_settings settings;
    hf_evaluator evaluator;
    double start_q[MAX_CABLE], initial[MAX_VARIABLE];
    hf_form_result base; /* of the initial design */
};

struct trace {
    int n;
    double best_psi_m[N_GENERATION], sum_N[N_GENERATION]; /* sum over all genes of the generation: changes with any */
    double first_design_N[MAX_POPULATION];                /* gene 1 of generation 0 */
    long n_evaluation, n_infeasible;
};

/* The cap lies just above the ratio of the form-found net, so that some designs exceed it and others do not. */
static void open_search(struct search *s)
{
    OPEN_CASE(&s->net, "configs/straight-edges.yaml", "scene.parabolic_cylinder.modules=[3, 3]",
              "optimize.population=16", "optimize.generations=12");
    const hf_model *m = &s->net.model;
    ck_assert(m->n_variable <= MAX_VARIABLE && m->n_cable <= MAX_CABLE);
    ck_assert_int_eq(find_shape(&s->net), HF_OK);
    s->settings = s->net.settings.optimize;
    memcpy(s->start_q, s->net.work.q_N_per_m, (size_t)m->n_cable * sizeof(double));
    for (int k = 0; k < m->n_variable; k++)
        s->initial[k] = s->net.work.tension_N[m->variable_cable[k]];
    s->evaluator = (hf_evaluator){.model = m,
                                  .form = &s->net.form,
                                  .start_q_N_per_m = s->start_q,
                                  .rule = HF_RULE_FORCE_DENSITY,
                                  .solver = HF_SOLVER_AUTO,
                                  .boundary_ratio_cap = 1e9};
    ck_assert_int_eq(hf_evaluate(&s->evaluator, s->initial, &s->net.work, NULL, &s->base), HF_OK);
    s->evaluator.boundary_ratio_cap = 1.05 * s->base.boundary_tension_ratio;
}

static struct trace run(struct search *s, int n_thread)
{
    struct trace t = {0};
    hf_batch batch;
    hf_optimiser ga;
    ck_assert_int_eq(hf_batch_create(&s->evaluator, n_thread, &batch), HF_OK);
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, &s->settings, &s->net.model, s->initial, &ga), HF_OK);
    for (int i = 0; i < ga.population.n_individual && i < MAX_POPULATION; i++)
        t.first_design_N[i] = ga.population.design[i * ga.population.n_variable + 1];
    do {
        hf_batch_run(&batch, ga.population.n_individual, ga.population.design, ga.population.pending,
                     ga.population.result);
        hf_optimiser_tell(&ga);
        t.best_psi_m[t.n] = ga.population.best_psi_m[ga.population.generation];
        for (int k = 0; k < ga.population.n_individual * ga.population.n_variable; k++)
            t.sum_N[t.n] += ga.population.design[k];
        t.n++;
        for (int i = 0; i < ga.population.n_individual; i++) {
            ck_assert(ga.population.result[i].status == HF_OK || ga.population.result[i].status == HF_RATIO_CAP);
            if (ga.population.result[i].status != HF_OK) continue;
            ck_assert_double_le(ga.population.result[i].boundary_tension_ratio, s->evaluator.boundary_ratio_cap);
        }
    } while (hf_optimiser_next(&ga));
    t.n_evaluation = ga.population.n_evaluation;
    t.n_infeasible = ga.population.n_evaluation_infeasible;
    hf_optimiser_free(&ga);
    hf_batch_free(&batch);
    return t;
}

static void assert_same_run(const struct trace *a, const struct trace *b)
{
    ck_assert_int_eq(a->n, b->n);
    ck_assert_int_eq((int)a->n_evaluation, (int)b->n_evaluation);
    ck_assert_mem_eq(a->best_psi_m, b->best_psi_m, sizeof a->best_psi_m);
    ck_assert_mem_eq(a->sum_N, b->sum_N, sizeof a->sum_N);
}

START_TEST(threads_do_not_change_a_bit)
{
    struct search s;
    open_search(&s);
    struct trace one = run(&s, 1), two = run(&s, 2), five = run(&s, 5);
    ck_assert_int_eq(one.n, N_GENERATION);
    assert_same_run(&one, &two);
    assert_same_run(&one, &five);
    close_net(&s.net);
}
END_TEST

START_TEST(seed_decides)
{
    struct search s;
    open_search(&s);
    struct trace one = run(&s, 2), again = run(&s, 2);
    s.settings.seed++;
    struct trace other = run(&s, 2);
    assert_same_run(&one, &again);
    ck_assert_double_ne(one.sum_N[0], other.sum_N[0]);
    close_net(&s.net);
}
END_TEST

/* Random numbers depend on (seed, generation, individual), so a larger population begins with the smaller one. */
START_TEST(individuals_do_not_depend_on_their_number)
{
    struct search s;
    open_search(&s);
    struct trace few = run(&s, 2);
    s.settings.population = MAX_POPULATION;
    struct trace many = run(&s, 2);
    ck_assert_mem_eq(few.first_design_N, many.first_design_N, 16 * sizeof(double));
    close_net(&s.net);
}
END_TEST

/* Individual 0 is the form-found net itself: the search starts there and gains (measured: 0.6 % under this cap). */
START_TEST(search_starts_at_the_found_shape_and_gains)
{
    struct search s;
    open_search(&s);
    struct trace t = run(&s, 2);
    double psi_m = s.base.psi_m;
    ck_assert_double_le(t.best_psi_m[0], psi_m);
    for (int i = 1; i < t.n; i++)
        ck_assert_double_le(t.best_psi_m[i], t.best_psi_m[i - 1]);
    ck_assert_double_lt(t.best_psi_m[t.n - 1], 0.998 * psi_m);
    ck_assert(t.n_infeasible > 0 && t.n_infeasible < t.n_evaluation);    /* the cap excluded some designs */
    ck_assert_int_le((int)t.n_evaluation, 16 + (N_GENERATION - 1) * 15); /* the elite is not evaluated again */
    close_net(&s.net);
}
END_TEST

Suite *suite_property_search(void)
{
    Suite *suite = suite_create("property/search");
    TCase *tests = tcase_create("search");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, threads_do_not_change_a_bit);
    tcase_add_test(tests, seed_decides);
    tcase_add_test(tests, individuals_do_not_depend_on_their_number);
    tcase_add_test(tests, search_starts_at_the_found_shape_and_gains);
    return suite;
}
