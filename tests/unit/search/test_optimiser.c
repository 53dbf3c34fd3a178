/* The table of methods, and ask and tell, by an optimiser that only counts: each generation lowers every design by
 * 1 N. */
#include "support.h"

#include <hifdm/optimiser.h>
#include <string.h>

enum { N_VARIABLE = 2, N = 3, N_GENERATION = 4 };

static const hf_model model = {.n_variable = N_VARIABLE, .n_leader = N_VARIABLE};
static const double initial[N_VARIABLE] = {10, 20};
static const hf_optimize_settings settings = {
    .population = N, .generations = N_GENERATION, .range_N = 100, .max_tension_N = 100, .stagnation_generations = 100};

static struct calls {
    int n_create, n_first, n_next, n_free;
    hf_status answer; /* of create */
} calls;

static hf_status count_create(const hf_optimize_settings *s, const hf_model *m, void **state)
{
    ck_assert(s == &settings && m == &model);
    calls.n_create++;
    if (calls.answer == HF_OK) *state = &calls;
    return calls.answer;
}

static void propose_first(void *state, hf_population *p)
{
    ck_assert_ptr_eq(state, &calls);
    calls.n_first++;
    for (int i = 0; i < N; i++) {
        memcpy(p->design + i * N_VARIABLE, initial, sizeof initial);
        p->pending[i] = 1;
    }
}

static void begin_next(void *state, const hf_population *now)
{
    ck_assert_ptr_eq(state, &calls);
    ck_assert_int_eq(now->stop_reason, HF_POPULATION_RUNNING);
    calls.n_next++;
}

static void propose(void *state, const hf_population *now, hf_population *next, int i)
{
    ck_assert_ptr_eq(state, &calls);
    ck_assert(now->design != next->design);
    for (int k = i * N_VARIABLE; k < (i + 1) * N_VARIABLE; k++)
        next->design[k] = now->design[k] - 1;
    next->pending[i] = 1;
}

static void count_free(void *state)
{
    ck_assert(state == &calls || !state);
    calls.n_free++;
}

static const hf_optimiser_kind counting = {count_create, propose_first, begin_next, propose, NULL, count_free};

START_TEST(generations_are_asked_for_and_told)
{
    hf_optimiser o;
    hf_population *p = &o.population;
    calls = (struct calls){0};
    ck_assert_int_eq(hf_optimiser_create(&counting, &settings, &model, initial, &o), HF_OK);
    int n_told = 0;
    do {
        ck_assert_int_eq(p->generation, n_told);
        for (int i = 0; i < N; i++) {
            ck_assert_int_eq(p->pending[i], 1);
            ck_assert_double_eq(p->design[i * N_VARIABLE], initial[0] - n_told);
            p->result[i] = (hf_form_result){
                .status = HF_OK, .psi_m = p->design[i * N_VARIABLE], .merit = p->design[i * N_VARIABLE]};
        }
        hf_optimiser_tell(&o);
        n_told++;
        ck_assert_double_eq(p->best_psi_m[p->generation], initial[0] - p->generation);
    } while (hf_optimiser_next(&o));
    ck_assert_int_eq(n_told, N_GENERATION);
    ck_assert_int_eq(p->stop_reason, HF_POPULATION_GENERATIONS);
    ck_assert_int_eq((int)p->n_evaluation, N * N_GENERATION);
    ck_assert(!hf_optimiser_next(&o)); /* nor is there one later */
    ck_assert(calls.n_create == 1 && calls.n_first == 1 && calls.n_next == N_GENERATION - 1 && calls.n_free == 0);
    hf_optimiser_free(&o);
    ck_assert_int_eq(calls.n_free, 1);
}
END_TEST

/* A copy of the population, made after telling, keeps its designs while the next generation is proposed. */
START_TEST(a_told_generation_stays_while_the_next_is_proposed)
{
    hf_optimiser o;
    calls = (struct calls){0};
    ck_assert_int_eq(hf_optimiser_create(&counting, &settings, &model, initial, &o), HF_OK);
    for (int i = 0; i < N; i++)
        o.population.result[i] = (hf_form_result){.status = HF_OK, .psi_m = 5, .merit = 5};
    hf_optimiser_tell(&o);
    hf_population before = o.population;
    ck_assert(hf_optimiser_next(&o));
    ck_assert_double_eq(before.design[0], initial[0]);
    ck_assert_double_eq(before.result[0].psi_m, 5);
    ck_assert_int_eq(before.generation, 0);
    hf_optimiser_free(&o);
}
END_TEST

START_TEST(a_failing_optimiser_is_freed)
{
    hf_optimiser o;
    calls = (struct calls){.answer = HF_NO_MEMORY};
    ck_assert_int_eq(hf_optimiser_create(&counting, &settings, &model, initial, &o), HF_NO_MEMORY);
    ck_assert_int_eq(calls.n_first, 0);
    hf_optimiser_free(&o);
    ck_assert_int_eq(calls.n_free, 1);
    ck_assert_ptr_null(o.population.block);
}
END_TEST

START_TEST(without_an_optimiser_there_are_only_bounds)
{
    hf_optimiser o;
    ck_assert_int_eq(hf_optimiser_create(NULL, &settings, &model, initial, &o), HF_OK);
    ck_assert_double_eq(o.population.lower[0], 0);
    ck_assert_double_eq(o.population.upper[1], 100);
    ck_assert_double_eq(o.population.design[0], 0);
    hf_optimiser_free(&o);
}
END_TEST

/* What a word of optimize.method stands for; the word and its number come from one list. */
START_TEST(every_method_has_its_plan)
{
    static const struct {
        const char *word;
        hf_optimize_method method;
        const hf_optimiser_kind *kind;
        bool ends_with_refine;
    } expected[] = {{"ga", HF_OPTIMIZE_GA, &hf_optimiser_ga, false},
                    {"lm", HF_OPTIMIZE_LM, NULL, true},
                    {"ga+lm", HF_OPTIMIZE_GA_LM, &hf_optimiser_ga, true},
                    {"auto", HF_OPTIMIZE_AUTO, &hf_optimiser_ga, true}};
    ck_assert_int_eq(HF_OPTIMIZE_N_METHOD, sizeof expected / sizeof *expected);
    for (int i = 0; i < HF_OPTIMIZE_N_METHOD; i++) {
        hf_optimize_settings s = {.method = expected[i].method};
        hf_optimiser_plan plan = hf_optimiser_plan_of(&s);
        ck_assert_str_eq(hf_optimize_method_word[expected[i].method], expected[i].word);
        ck_assert(plan.kind == expected[i].kind);
        ck_assert_int_eq(plan.ends_with_refine, expected[i].ends_with_refine);
        s.n_front = 2;
        ck_assert(hf_optimiser_plan_of(&s).kind == (expected[i].kind ? &hf_optimiser_nsga : NULL));
    }
    ck_assert_ptr_null(hf_optimize_method_word[HF_OPTIMIZE_N_METHOD]); /* any other word is refused by the case file */
}
END_TEST

Suite *suite_unit_optimiser(void)
{
    Suite *suite = suite_create("unit/optimiser");
    TCase *tests = tcase_create("optimiser");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, generations_are_asked_for_and_told);
    tcase_add_test(tests, a_told_generation_stays_while_the_next_is_proposed);
    tcase_add_test(tests, a_failing_optimiser_is_freed);
    tcase_add_test(tests, without_an_optimiser_there_are_only_bounds);
    tcase_add_test(tests, every_method_has_its_plan);
    return suite;
}
