/* Batches: only what is pending is evaluated, and the bits depend neither on threads nor on how designs are grouped. */
#include "population.h"
#include "small_ga.h"

#include "search/parallel.h"
#include <hifdm/batch.h>
#include <sched.h>
#include <string.h>
#include <unistd.h>

/* The small reflector and designs up to 0.5 N around its boundary pretensions. */
static void open_designs(struct run *r, int rule)
{
    OPEN_CASE(&r->net, SMALL_REFLECTOR);
    draw_designs(r, 1, 0.5);
    evaluate_by(r, rule, HF_SOLVER_AUTO);
}

static void evaluate(struct run *r, int n_thread, int n_at_once, hf_form_result result[N_DESIGN])
{
    hf_batch batch;
    memset(result, 0, N_DESIGN * sizeof *result); /* padding included: results are compared as bytes */
    ck_assert_int_eq(hf_batch_create(&r->evaluator, n_thread, &batch), HF_OK);
    for (int i = 0; i < batch.n_thread; i++)
        poison_workspace(&r->net.model, &batch.workspace[i]);
    for (int i = 0; i < N_DESIGN; i += n_at_once)
        hf_batch_run(&batch, i + n_at_once < N_DESIGN ? n_at_once : N_DESIGN - i,
                     r->design + i * r->net.model.n_variable, NULL, result + i);
    ck_assert_double_gt(batch.cpu_s, 0);
    hf_batch_free(&batch);
}

static void assert_same_results(const hf_form_result *a, const hf_form_result *b)
{
    for (int i = 0; i < N_DESIGN; i++) {
        ck_assert_int_eq(a[i].status, b[i].status);
        ck_assert_int_eq(a[i].iterations, b[i].iterations);
        ck_assert_mem_eq(&a[i].psi_m, &b[i].psi_m, sizeof(double)); /* bits: NaN is equal to itself */
        ck_assert_mem_eq(&a[i].residual_N, &b[i].residual_N, sizeof(double));
        ck_assert_mem_eq(&a[i].boundary_tension_ratio, &b[i].boundary_tension_ratio, sizeof(double));
    }
}

START_TEST(threads_and_grouping_do_not_change_a_bit)
{
    struct run r;
    hf_form_result alone[N_DESIGN], other[N_DESIGN];
    open_designs(&r, _i);
    evaluate(&r, 1, 1, alone);
    for (int i = 0; i < N_DESIGN; i++) { /* the same as without a batch */
        hf_form_result direct;
        hf_evaluate(&r.evaluator, r.design + i * r.net.model.n_variable, &r.net.work, NULL, &direct);
        ck_assert_mem_eq(&direct.psi_m, &alone[i].psi_m, sizeof(double));
    }
    static const int n_thread[] = {1, 2, 3, 7};
    for (size_t k = 0; k < sizeof n_thread / sizeof *n_thread; k++) {
        evaluate(&r, n_thread[k], N_DESIGN, other);
        assert_same_results(alone, other);
        evaluate(&r, n_thread[k], 4, other);
        assert_same_results(alone, other);
    }
    close_net(&r.net);
}
END_TEST

START_TEST(only_pending_designs_are_evaluated)
{
    struct run r;
    hf_batch batch;
    hf_form_result result[N_DESIGN];
    unsigned char pending[N_DESIGN];
    open_designs(&r, HF_RULE_FORCE_DENSITY);
    for (int i = 0; i < N_DESIGN; i++) {
        result[i] = (hf_form_result){.status = HF_NOT_EVALUATED, .iterations = -7};
        pending[i] = i % 3 == 0;
    }
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 2, &batch), HF_OK);
    hf_batch_run(&batch, N_DESIGN, r.design, pending, result);
    for (int i = 0; i < N_DESIGN; i++) {
        ck_assert_int_eq(result[i].status, pending[i] ? HF_OK : HF_NOT_EVALUATED);
        ck_assert_int_eq(result[i].iterations == -7, !pending[i]);
    }
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

/* A bad candidate among good ones: its own status, and no trace in the others. */
START_TEST(one_failure_stays_alone)
{
    struct run r;
    hf_form_result good[N_DESIGN], mixed[N_DESIGN];
    open_designs(&r, HF_RULE_TENSION);
    for (int k = 0; k < N_DESIGN * r.net.model.n_variable; k++) /* nearly the found tensions: equilibrium exists */
        r.design[k] = r.net.work.tension_N[r.net.model.variable_cable[k % r.net.model.n_variable]] + 1e-3 * (k % 7);
    evaluate(&r, 2, N_DESIGN, good);
    for (int i = 0; i < N_DESIGN; i++)
        ck_assert_int_eq(good[i].status, HF_OK);
    r.design[11 * r.net.model.n_variable] *= 50;
    evaluate(&r, 2, N_DESIGN, mixed);
    ck_assert_int_eq(mixed[11].status, HF_COLLAPSED);
    mixed[11] = good[11];
    assert_same_results(good, mixed);
    close_net(&r.net);
}
END_TEST

START_TEST(default_is_a_thread_per_core)
{
    struct run r;
    hf_batch batch;
    open_designs(&r, HF_RULE_FORCE_DENSITY);
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 0, &batch), HF_OK);
    ck_assert_int_eq(batch.n_thread, hf_batch_default_threads());
    ck_assert_int_ge(batch.n_thread, 1);
    ck_assert_int_le(batch.n_thread, (int)sysconf(_SC_NPROCESSORS_ONLN)); /* fewer where the process may not use all */
    hf_batch_free(&batch);
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 3, &batch), HF_OK);
    ck_assert_int_eq(batch.n_thread, 3);
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

/* Batches inside hf_parallel_for share its threads: every item runs once, with the bits of a batch outside of it. */
enum { N_ITEM = 7 };
struct item_work {
    struct run *run;
    int n_thread, n_call[N_ITEM];
    hf_status status[N_ITEM];
    hf_form_result result[N_ITEM][N_DESIGN];
};

static void work_on_item(void *context, int i)
{
    struct item_work *w = context;
    hf_batch batch;
    w->n_call[i]++;
    w->status[i] = hf_batch_create(&w->run->evaluator, w->n_thread, &batch);
    if (w->status[i] == HF_OK) {
        hf_batch_share(&batch, w->run->design);
        hf_batch_run(&batch, i % 2 ? N_DESIGN : 5, w->run->design, NULL, w->result[i]);
        hf_batch_run(&batch, N_DESIGN, w->run->design, NULL, w->result[i]); /* reuses the first call's workspaces */
    }
    hf_batch_free(&batch);
}

START_TEST(batches_that_share_threads_do_not_change_a_bit)
{
    struct run r;
    hf_batch batch;
    hf_form_result alone[N_DESIGN];
    static struct item_work w;
    open_designs(&r, HF_RULE_FORCE_DENSITY);
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 1, &batch), HF_OK);
    hf_batch_share(&batch, r.design);
    hf_batch_run(&batch, N_DESIGN, r.design, NULL, alone);
    hf_batch_free(&batch);
    for (int n_thread = 1; n_thread <= 4; n_thread++) {
        memset(&w, 0, sizeof w);
        w.run = &r;
        w.n_thread = n_thread;
        hf_parallel_for(n_thread, n_thread == 4 ? 1 : N_ITEM, work_on_item,
                        &w); /* with 4 threads and one item, three threads have no item of their own */
        for (int i = 0; i < (n_thread == 4 ? 1 : N_ITEM); i++) {
            ck_assert_int_eq(w.n_call[i], 1);
            ck_assert_int_eq(w.status[i], HF_OK);
            assert_same_results(alone, w.result[i]);
        }
    }
    close_net(&r.net);
}
END_TEST

/* While the next generation is made, another thread reads the one that was told: its contents must not change. */
enum { N_INDIVIDUAL = 12, N_GENERATION = 6 };

static int n_bred; /* generations */

static void breed_and_count(void *state, const hf_population *now, hf_population *next, int i)
{
    hf_optimiser_ga.propose(state, now, next, i);
    __atomic_add_fetch(&n_bred, 1, __ATOMIC_SEQ_CST);
}

struct reader {
    hf_optimiser ga;
    bool is_beside; /* breeding goes on in another thread */
    double design[N_INDIVIDUAL * MAX_VARIABLE], rate[N_INDIVIDUAL];
    int parent[2 * N_INDIVIDUAL], n_call, is_same;
};

static void note(struct reader *r, const hf_optimiser *ga)
{
    r->ga = *ga;
    r->is_same = 1;
    memcpy(r->design, ga->population.design, N_INDIVIDUAL * (size_t)ga->population.n_variable * sizeof(double));
    memcpy(r->rate, ga->population.mutation_rate, sizeof r->rate);
    memcpy(r->parent, ga->population.parent, sizeof r->parent);
}

/* After the next generation is bred, where that does not wait for the reader. */
static void read_late(void *context)
{
    struct reader *r = context;
    while (r->is_beside && r->ga.population.stop_reason == HF_POPULATION_RUNNING &&
           __atomic_load_n(&n_bred, __ATOMIC_SEQ_CST) < (r->ga.population.generation + 1) * N_INDIVIDUAL)
        sched_yield();
    r->n_call++;
    r->is_same = memcmp(r->design, r->ga.population.design,
                        N_INDIVIDUAL * (size_t)r->ga.population.n_variable * sizeof(double)) == 0 &&
                 memcmp(r->rate, r->ga.population.mutation_rate, sizeof r->rate) == 0 &&
                 memcmp(r->parent, r->ga.population.parent, sizeof r->parent) == 0;
}

START_TEST(a_generation_can_be_read_while_the_next_is_bred)
{
    struct run r;
    double best_psi_m[2] = {0};
    hf_optimize_settings settings = small_ga(N_INDIVIDUAL, N_GENERATION);
    settings.seed = 5;
    settings.min_tension_N = 0;
    open_designs(&r, HF_RULE_FORCE_DENSITY);
    for (int n_thread = 0; n_thread <= 3; n_thread++) { /* 0: one, and nothing beside */
        hf_batch batch;
        hf_optimiser ga;
        static struct reader reader;
        hf_optimiser_kind counting = hf_optimiser_ga;
        counting.propose = breed_and_count;
        n_bred = 0;
        reader.n_call = 0;
        reader.is_beside = n_thread > 1;
        ck_assert_int_eq(hf_batch_create(&r.evaluator, n_thread ? n_thread : 1, &batch), HF_OK);
        ck_assert_int_eq(hf_optimiser_create(&counting, &settings, &r.net.model, r.design, &ga), HF_OK);
        hf_batch_share(&batch, r.design);
        hf_batch_run(&batch, N_INDIVIDUAL, ga.population.design, ga.population.pending, ga.population.result);
        do {
            hf_optimiser_tell(&ga);
            note(&reader, &ga);
        } while (hf_batch_next(&batch, &ga, n_thread ? read_late : NULL, &reader) && reader.is_same);
        ck_assert(reader.is_same);
        ck_assert_int_eq(reader.n_call, n_thread ? N_GENERATION : 0);
        ck_assert_int_eq(ga.population.generation, N_GENERATION - 1);
        best_psi_m[n_thread > 0] = ga.population.result[ga.population.best].psi_m;
        ck_assert_msg(n_thread == 0 || best_psi_m[0] == best_psi_m[1], "%d threads: %.17g, not %.17g", n_thread,
                      best_psi_m[1], best_psi_m[0]);
        ck_assert_double_lt(best_psi_m[0], ga.population.best_psi_m[0]); /* the search has improved the best */
        hf_optimiser_free(&ga);
        hf_batch_free(&batch);
    }
    close_net(&r.net);
}
END_TEST

/* No heap in our own code once the batch is made (what OpenMP does inside its library is not seen here). */
START_TEST(nothing_is_allocated)
{
    struct run r;
    hf_batch batch;
    hf_form_result result[N_DESIGN];
    open_designs(&r, HF_RULE_FORCE_DENSITY);
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 2, &batch), HF_OK);
    long before = allocation_count();
    hf_batch_run(&batch, N_DESIGN, r.design, NULL, result);
    ck_assert_int_eq(allocation_count(), before);
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

Suite *suite_unit_batch(void)
{
    Suite *suite = suite_create("unit/batch");
    TCase *tests = tcase_create("batch");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, threads_and_grouping_do_not_change_a_bit, 0, 3);
    tcase_add_test(tests, only_pending_designs_are_evaluated);
    tcase_add_test(tests, one_failure_stays_alone);
    tcase_add_test(tests, default_is_a_thread_per_core);
    tcase_add_test(tests, batches_that_share_threads_do_not_change_a_bit);
    tcase_add_test(tests, a_generation_can_be_read_while_the_next_is_bred);
    tcase_add_test(tests, nothing_is_allocated);
    return suite;
}
