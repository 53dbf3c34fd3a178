/* Two generations and their ranking, without an optimiser: bounds, linked genes, order, stop words. */
#include "support.h"

#include <hifdm/population.h>
#include <math.h>
#include <string.h>

enum { N_VARIABLE = 3, N = 4, N_GENERATION = 5 };

static int leader[N_VARIABLE] = {0, 1, 0};
static const hf_model free_model = {.n_variable = N_VARIABLE, .n_leader = N_VARIABLE};
static const hf_model linked_model = {.n_variable = N_VARIABLE, .n_leader = 2, .variable_leader = leader};
static const double initial[N_VARIABLE] = {10, 20, 1.5};
static const hf_optimize_settings settings = {.population = N,
                                              .generations = N_GENERATION,
                                              .range_N = 1,
                                              .min_tension_N = 1,
                                              .max_tension_N = 20.25,
                                              .stagnation_tolerance_m = 0.5,
                                              .stagnation_generations = 2};

static void open_population(const hf_model *model, hf_population *p, hf_population *next)
{
    ck_assert_int_eq(hf_population_create(&settings, model, initial, p, next), HF_OK);
}

START_TEST(bounds_are_the_range_within_the_limits)
{
    hf_population p, next;
    open_population(&free_model, &p, &next);
    static const double lower[N_VARIABLE] = {9, 19, 1}, upper[N_VARIABLE] = {11, 20.25, 2.5};
    for (int k = 0; k < N_VARIABLE; k++) {
        ck_assert_double_eq(p.initial[k], initial[k]);
        ck_assert_double_eq(p.lower[k], lower[k]);
        ck_assert_double_eq(p.upper[k], upper[k]);
        ck_assert_double_eq(hf_population_clamp(&p, k, 0), lower[k]);
        ck_assert_double_eq(hf_population_clamp(&p, k, 100), upper[k]);
        ck_assert_double_eq(hf_population_clamp(&p, k, initial[k]), initial[k]);
    }
    for (int i = 0; i < N * N_VARIABLE; i++)
        ck_assert_double_eq(p.design[i], 0);
    ck_assert_int_eq(p.generation, 0);
    ck_assert_int_eq(p.best, -1);
    ck_assert_int_eq(p.stop_reason, HF_POPULATION_RUNNING);
    hf_population_free(&p);
    ck_assert_ptr_null(p.block);
}
END_TEST

/* Gene 2 is linked to gene 0 and can only go down by 0.5 N, so gene 0 can, too. Gene 1 is not linked. The other way
 * round, gene 0 lets gene 2 go up by 0.75 N. */
START_TEST(linked_genes_share_step_and_bounds)
{
    hf_population p, next;
    open_population(&linked_model, &p, &next);
    ck_assert_double_eq(p.lower[0], 9.5);
    ck_assert_double_eq(p.lower[2], 1);
    ck_assert_double_eq(p.upper[0], 11);
    ck_assert_double_eq(p.upper[2], 2.5);
    ck_assert_double_eq(p.lower[1], 19);
    double design[N_VARIABLE] = {10.75, 19.5, 7};
    hf_population_link(&p, &linked_model, design);
    ck_assert_double_eq(design[0], 10.75);
    ck_assert_double_eq(design[1], 19.5);
    ck_assert_double_eq(design[2], 2.25);
    hf_population_link(&p, &free_model, memcpy(design, (double[]){1, 2, 3}, sizeof design));
    ck_assert_double_eq(design[2], 3); /* not linked in this model */
    hf_population_free(&p);
    hf_optimize_settings tight = settings;
    tight.max_tension_N = 10.75;
    ck_assert_int_eq(hf_population_create(&tight, &linked_model, initial, &p, &next), HF_OK);
    ck_assert_double_eq(p.upper[0], 10.75);
    ck_assert_double_eq(p.upper[2], 2.25);
    hf_population_free(&p);
}
END_TEST

START_TEST(advancing_exchanges_the_generations)
{
    hf_population p, next;
    open_population(&free_model, &p, &next);
    hf_population before = p, after = next;
    ck_assert_ptr_eq(p.best_psi_m, next.best_psi_m); /* both generations share one history */
    hf_population_advance(&p, &next);
    ck_assert_int_eq(p.generation, 1);
    ck_assert(p.design == after.design && next.design == before.design);
    ck_assert(p.result == after.result && next.result == before.result);
    ck_assert(p.pending == after.pending && next.pending == before.pending);
    ck_assert(p.parent == after.parent && next.parent == before.parent);
    ck_assert(p.crossover_rate == after.crossover_rate && next.crossover_rate == before.crossover_rate);
    ck_assert(p.mutation_rate == after.mutation_rate && next.mutation_rate == before.mutation_rate);
    ck_assert(p.lower == before.lower && p.block == before.block);
    hf_population_free(&p);
}
END_TEST

/* psi 3, infeasible, 2, 2: index 2 is the best, and index 1 the worst whatever its psi. */
static void tell(hf_population *p, double psi_0_m)
{
    static const double psi_m[N] = {3, 0, 2, 2};
    for (int i = 0; i < N; i++)
        p->result[i] = (hf_form_result){
            .status = i == 1 ? HF_COLLAPSED : HF_OK, .psi_m = i ? psi_m[i] : psi_0_m, .merit = i ? psi_m[i] : psi_0_m};
    memcpy(p->pending, (unsigned char[]){1, 1, 0, 1}, N);
    hf_population_note_trials(p);
    hf_population_rank(&settings, p);
}

START_TEST(ranking_counts_what_was_evaluated)
{
    hf_population p, next;
    open_population(&free_model, &p, &next);
    tell(&p, 3);
    ck_assert_int_eq(p.best, 2);
    ck_assert_double_eq_tol(p.mean_psi_m, 7.0 / 3, 1e-15);
    ck_assert_double_eq(p.worst_psi_m, 3);
    ck_assert_int_eq(p.n_infeasible, 1);
    ck_assert_int_eq((int)p.n_evaluation, 3); /* the individual that was not pending does not count */
    ck_assert_int_eq((int)p.n_evaluation_infeasible, 1);
    static const int order[N] = {2, 3, 0, 1};
    for (int a = 0; a < N; a++)
        for (int b = 0; b < N; b++)
            ck_assert_int_eq(hf_population_is_better(&p, order[a], order[b]), a < b);
    hf_population_free(&p);
}
END_TEST

/* Over a window of two generations psi must fall by 0.5: from 2 to 1.5 is enough, to 1.75 is not. */
START_TEST(stagnation_is_too_small_a_gain)
{
    for (int enough = 0; enough < 2; enough++) {
        hf_population p, next;
        open_population(&free_model, &p, &next);
        tell(&p, 3);
        hf_population_advance(&p, &next);
        tell(&p, 3);
        ck_assert_int_eq(p.stop_reason, HF_POPULATION_RUNNING);
        hf_population_advance(&p, &next);
        tell(&p, enough ? 1.5 : 1.75);
        ck_assert_int_eq(p.stop_reason, enough ? HF_POPULATION_RUNNING : HF_POPULATION_STAGNATION);
        hf_population_free(&p);
    }
}
END_TEST

START_TEST(every_stop_has_its_word)
{
    ck_assert_str_eq(hf_population_stop_word[HF_POPULATION_RUNNING], "running");
    ck_assert_str_eq(hf_population_stop_word[HF_POPULATION_STAGNATION], "stagnation");
    ck_assert_str_eq(hf_population_stop_word[HF_POPULATION_GENERATIONS], "generations");
    ck_assert_str_eq(hf_population_stop_word[HF_POPULATION_ALL_INFEASIBLE], "all_infeasible");
}
END_TEST

Suite *suite_unit_population(void)
{
    Suite *suite = suite_create("unit/population");
    TCase *tests = tcase_create("population");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, bounds_are_the_range_within_the_limits);
    tcase_add_test(tests, linked_genes_share_step_and_bounds);
    tcase_add_test(tests, advancing_exchanges_the_generations);
    tcase_add_test(tests, ranking_counts_what_was_evaluated);
    tcase_add_test(tests, stagnation_is_too_small_a_gain);
    tcase_add_test(tests, every_stop_has_its_word);
    return suite;
}
