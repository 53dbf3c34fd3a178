/* Refinements from other starts: never worse, counted by their shapes, without memory, interrupted. */
#include "population.h"

#include "search/restart.h"
#include <hifdm/optimiser.h>

enum { N_STEP = 200 };

static struct {
    struct run r;
    hf_optimize_settings settings;
    hf_optimiser optimiser;
    hf_batch batch;
    double design[MAX_VARIABLE];
    hf_refine_result result;
    hf_optima optima;
} d;

/* A net whose first refinement has ended at d.design, and the first generation of a search. */
static void begin(double range_N, uint64_t seed)
{
    hf_population *p = &d.optimiser.population;
    open_run(&d.r, HF_RULE_FORCE_DENSITY);
    ck_assert_int_eq(hf_batch_create(&d.r.evaluator, 2, &d.batch), HF_OK);
    d.settings = d.r.net.settings.optimize;
    d.settings.population = 12;
    d.settings.range_N = range_N;
    d.settings.seed = seed;
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, &d.settings, &d.r.net.model, d.r.initial, &d.optimiser),
                     HF_OK);
    for (int i = 0; i < p->n_individual; i++)
        hf_evaluate(&d.r.evaluator, p->design + (size_t)i * (size_t)p->n_variable, &d.r.net.work, NULL, &p->result[i]);
    hf_optimiser_tell(&d.optimiser);
    memcpy(d.design, p->design + (size_t)p->best * (size_t)p->n_variable, (size_t)p->n_variable * sizeof(double));
    ck_assert_int_eq(
        hf_refine_run(&d.r.evaluator, p->lower, p->upper, N_STEP, NULL, NULL, d.design, &d.r.net.work, &d.result),
        HF_OK);
}

static hf_status restart(const hf_refine_watcher *watcher)
{
    return hf_restart_run(&d.batch, &d.optimiser.population, N_STEP, watcher, d.design, &d.r.net.work, &d.result,
                          &d.optima);
}

static void end(void)
{
    hf_optimiser_free(&d.optimiser);
    hf_batch_free(&d.batch);
    close_net(&d.r.net);
}

START_TEST(the_best_optimum_is_kept)
{
    begin(0.5 * (_i + 1), 40 + (uint64_t)_i);
    const hf_population *p = &d.optimiser.population;
    double first_m = d.result.merit;
    hf_form_result r;
    int n_evaluation = d.result.evaluations, n = 0;
    ck_assert_int_eq(restart(NULL), HF_OK);
    ck_assert_int_gt(d.result.evaluations, n_evaluation);
    ck_assert_int_eq(hf_evaluate(&d.r.evaluator, d.design, &d.r.net.work, NULL, &r), HF_OK);
    ck_assert_double_le(r.merit, first_m);
    ck_assert_double_eq_tol(r.merit, d.optima.merit[0], 1e-12);
    ck_assert_double_eq_tol(r.merit, d.result.merit, 1e-12);
    for (int k = 0; k < p->n_variable; k++) {
        ck_assert_double_ge(d.design[k], p->lower[k]);
        ck_assert_double_le(d.design[k], p->upper[k]);
    }
    for (int i = 0; i < d.optima.n; i++) {
        ck_assert_int_gt(d.optima.count[i], 0);
        if (i > 0) ck_assert_double_ge(d.optima.merit[i], d.optima.merit[i - 1]);
        n += d.optima.count[i];
    }
    ck_assert_int_ge(n, 2);
    ck_assert_int_le(n, 4);
    end();
}
END_TEST

/* A refinement that has to leave a design is no optimum. */
START_TEST(unfinished_refinements_do_not_count)
{
    begin(1, 40);
    double before[MAX_VARIABLE], merit_m = d.result.merit;
    memcpy(before, d.design, sizeof before);
    ck_assert_int_eq(
        hf_restart_run(&d.batch, &d.optimiser.population, 1, NULL, d.design, &d.r.net.work, &d.result, &d.optima),
        HF_OK);
    ck_assert_mem_eq(before, d.design, (size_t)d.optimiser.population.n_variable * sizeof(double));
    ck_assert_int_eq(d.optima.n, 1);
    ck_assert_int_eq(d.optima.count[0], 1);
    ck_assert_double_eq(d.result.merit, merit_m);
    end();
}
END_TEST

/* A merit that the run can pass, and one that it cannot. */
START_TEST(a_merit_to_beat_ends_only_runs_that_cannot_pass_it)
{
    begin(1, 40);
    const hf_population *p = &d.optimiser.population;
    for (int k = 0; k < 2; k++) {
        hf_refine_watcher watcher = {.beat = d.result.merit * (k == 0 ? 1.0001 : 0.5)};
        double design[MAX_VARIABLE];
        hf_refine_result result;
        memcpy(design, p->design + (size_t)p->best * (size_t)p->n_variable, (size_t)p->n_variable * sizeof(double));
        ck_assert_int_eq(
            hf_refine_run(&d.r.evaluator, p->lower, p->upper, N_STEP, NULL, &watcher, design, &d.r.net.work, &result),
            HF_OK);
        ck_assert_int_le(result.iterations, d.result.iterations);
        if (k == 0) ck_assert_mem_eq(design, d.design, (size_t)p->n_variable * sizeof(double));
        if (result.is_beaten) ck_assert_int_eq(result.stop, HF_REFINE_SETTLED);
        if (result.is_beaten) ck_assert_int_eq(k, 1);
    }
    end();
}
END_TEST

static hf_status stop_at(void *context, const hf_refine_progress *now)
{
    int *left = context;
    (void)now;
    return (*left)-- > 0 ? HF_OK : HF_INTERRUPTED;
}

START_TEST(a_watcher_can_stop_it)
{
    begin(1, 40);
    for (int n = 0; n < 4; n++) {
        int left = n;
        ck_assert_int_eq(restart(&(hf_refine_watcher){.after = stop_at, .context = &left}), HF_INTERRUPTED);
    }
    end();
}
END_TEST

START_TEST(memory_may_fail)
{
    begin(1, 40);
    hf_refine_result result = d.result;
    double design[MAX_VARIABLE];
    memcpy(design, d.design, sizeof design);
    for (int n = 1;; n++) {
        fail_allocation_at(n);
        hf_status status = restart(NULL);
        bool has_failed = end_allocation_failure();
        ck_assert_int_eq(status, has_failed ? HF_NO_MEMORY : HF_OK);
        if (!has_failed) break;
        ck_assert_int_lt(n, 1000);
        memcpy(d.design, design, sizeof design);
        d.result = result;
    }
    end();
}
END_TEST

Suite *suite_unit_restart(void)
{
    Suite *suite = suite_create("unit/restart");
    TCase *tests = tcase_create("restart");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, the_best_optimum_is_kept, 0, 6);
    tcase_add_test(tests, unfinished_refinements_do_not_count);
    tcase_add_test(tests, a_merit_to_beat_ends_only_runs_that_cannot_pass_it);
    tcase_add_test(tests, a_watcher_can_stop_it);
    tcase_add_test(tests, memory_may_fail);
    return suite;
}
