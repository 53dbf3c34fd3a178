/* Repairs of proposed designs: most children come within the limits, in bounds and linked; the others stay as they are;
 * limits, derivatives and memory may be missing. */
#include "population.h"

#include "search/repair.h"
#include <hifdm/optimiser.h>

static struct {
    struct run r;
    hf_optimize_settings settings;
    hf_optimiser optimiser;
    hf_repair *repair;
} d;

enum { N_CHILD = 32, N_PROBE = N_CHILD / 8 };

static void evaluate_generation(void)
{
    hf_population *p = &d.optimiser.population;
    for (int i = 0; i < N_CHILD; i++)
        hf_evaluate(&d.r.evaluator, p->design + (size_t)i * (size_t)p->n_variable, &d.r.net.work, NULL, &p->result[i]);
}

/* A net with a generation of designs up to range_N around its initial one, of which the cap excludes about half. */
static void begin(hf_rule rule, double range_N)
{
    hf_population *p = &d.optimiser.population;
    open_run(&d.r, (int)rule);
    d.settings = d.r.net.settings.optimize;
    d.settings.population = N_CHILD;
    d.settings.range_N = range_N;
    d.settings.variation = HF_VARIATION_CHAIN;
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, &d.settings, &d.r.net.model, d.r.initial, &d.optimiser),
                     HF_OK);
    evaluate_generation();
    double least = INFINITY, largest = 0;
    for (int i = 0; i < N_CHILD; i++) {
        least = fmin(least, p->result[i].boundary_tension_ratio);
        largest = fmax(largest, p->result[i].boundary_tension_ratio);
    }
    d.r.evaluator.boundary_ratio_cap = (least + largest) / 2;
    evaluate_generation();
    hf_optimiser_tell(&d.optimiser);
}

static void end(void)
{
    hf_repair_free(d.repair);
    hf_optimiser_free(&d.optimiser);
    close_net(&d.r.net);
}

/* Proposes a generation: random designs within the bounds. */
static void propose(uint64_t seed)
{
    hf_population *p = &d.optimiser.next;
    struct rng rng = rng_start(seed);
    for (int i = 0; i < N_CHILD * p->n_variable; i++) {
        int k = i % p->n_variable;
        p->design[i] = rng_uniform(&rng, p->lower[k], p->upper[k]);
    }
}

static int count_infeasible(const hf_population *p, int first, int stride)
{
    hf_form_result r;
    int n = 0;
    for (int i = first; i < N_CHILD; i += stride)
        n += hf_evaluate(&d.r.evaluator, p->design + (size_t)i * (size_t)p->n_variable, &d.r.net.work, NULL, &r) !=
             HF_OK;
    return n;
}

START_TEST(most_children_come_within_the_cap)
{
    static const hf_rule rule[] = {HF_RULE_FORCE_DENSITY, HF_RULE_TENSION};
    begin(rule[_i], _i ? 0.01 : 0.8);
    hf_population *next = &d.optimiser.next;
    size_t size = (size_t)next->n_variable * sizeof(double);
    static double before[N_CHILD * MAX_VARIABLE];
    ck_assert_int_eq(hf_repair_create(&d.r.evaluator, &d.optimiser.population, &d.repair), HF_OK);
    ck_assert_ptr_nonnull(d.repair);
    propose(7);
    memcpy(before, next->design, N_CHILD * size);
    int n_before = count_infeasible(next, 0, 1);
    hf_repair_begin(d.repair, &d.optimiser.population);
    for (int i = N_CHILD; i-- > 0;)
        hf_repair_child(d.repair, next, i);
    int n_probe = count_infeasible(next, 0, 8), n_after = count_infeasible(next, 0, 1) - n_probe;
    ck_assert_int_gt(n_before, N_CHILD / 2);
    ck_assert_msg(n_after <= 2, "%d of %d before, %d after", n_before, N_CHILD, n_after);
    for (int i = 0; i < N_CHILD; i++)
        for (int k = 0; k < next->n_variable; k++) {
            double value = next->design[i * next->n_variable + k];
            ck_assert(value >= next->lower[k] && value <= next->upper[k]);
            if (i % 8 == 0) ck_assert_double_eq(value, before[i * next->n_variable + k]);
        }
    memcpy(next->design, before, N_CHILD * size); /* in another order, the bits are the same */
    static double repaired[MAX_VARIABLE];
    for (int i = 0; i < N_CHILD; i++) {
        hf_repair_child(d.repair, next, i);
        if (i == 5) memcpy(repaired, next->design + (size_t)i * (size_t)next->n_variable, size);
    }
    memcpy(next->design + (size_t)5 * (size_t)next->n_variable, before + (size_t)5 * (size_t)next->n_variable, size);
    hf_repair_child(d.repair, next, 5);
    ck_assert_mem_eq(repaired, next->design + (size_t)5 * (size_t)next->n_variable, size);
    end();
}
END_TEST

/* A constraint as a requirement makes it: the tension of a cable is at most so much. */
static struct {
    int cable;
    double most_N, tension_N;
    bool has_no_rates;
} required;

static hf_status open_nothing(const hf_constraints *c, void **room)
{
    (void)c;
    *room = &required;
    return HF_OK;
}

static void close_nothing(void *room)
{
    (void)room;
}

static hf_status measure(void *room, const hf_workspace *w, bool is_smooth, double *value)
{
    (void)room, (void)is_smooth;
    required.tension_N = w->tension_N[required.cable];
    *value = required.tension_N - required.most_N;
    return HF_OK;
}

static hf_status linearise(void *room, int n_rate, hf_constraints_spread *spread, const void *context, double *rate)
{
    static double move[4096], tension_rate[4096];
    (void)room;
    for (int j = 0; j < n_rate; j++) {
        spread(context, j, move, tension_rate);
        rate[j] = required.has_no_rates ? 0 : tension_rate[required.cable];
    }
    return HF_OK;
}

static const double unit = 1;
static const hf_constraints one_constraint = {
    .n = 1, .unit = &unit, .open = open_nothing, .close = close_nothing, .measure = measure, .linearise = linearise};

/* The claim is made for a cap far below the least ratio of a generation, and no other design has a ratio below the one
 * that it names. It is not made for a cap that designs meet, nor before there is a model. */
START_TEST(a_cap_out_of_reach_is_known)
{
    static const hf_rule rule[] = {HF_RULE_FORCE_DENSITY, HF_RULE_TENSION};
    hf_form_result r;
    double least = INFINITY;
    hf_repair_doubt found;
    begin(rule[_i], _i ? 0.001 : 0.1);
    hf_population *p = &d.optimiser.population, *next = &d.optimiser.next;
    ck_assert_int_eq(hf_repair_create(&d.r.evaluator, p, &d.repair), HF_OK);
    ck_assert(!hf_repair_doubts(d.repair, &found));
    hf_repair_begin(d.repair, p);
    ck_assert(hf_repair_is_active(d.repair) && !hf_repair_doubts(d.repair, &found));
    hf_repair_free(d.repair);
    const double factor = _i ? 1.05 : 1.3, cap = _i ? 1.02 : 1.1;
    d.r.evaluator.boundary_ratio_cap = cap;
    p->lower[0] = p->upper[0] = factor * d.r.initial[0]; /* one tension is higher than the others */
    for (int i = 0; i < N_CHILD; i++)
        p->design[i * p->n_variable] = p->lower[0];
    evaluate_generation();
    hf_optimiser_tell(&d.optimiser);
    ck_assert_int_eq(hf_repair_create(&d.r.evaluator, p, &d.repair), HF_OK);
    hf_repair_begin(d.repair, p);
    ck_assert(hf_repair_doubts(d.repair, &found));
    double ratio = found.limit.value;
    ck_assert_double_gt(ratio, cap);
    ck_assert(found.limit.row == HF_LIMITS_CAP && found.limit.cable >= 0 && found.limit.other >= 0);
    for (uint64_t seed = 1; seed <= 20; seed++) {
        propose(test_seed() + seed);
        for (int i = 0; i < N_CHILD; i++)
            hf_repair_child(d.repair, next, i);
        for (int i = 0; i < N_CHILD; i++) {
            hf_evaluate(&d.r.evaluator, next->design + (size_t)i * (size_t)next->n_variable, &d.r.net.work, NULL, &r);
            least = fmin(least, r.boundary_tension_ratio);
        }
    }
    ck_assert_msg(least > 0.99 * ratio, "%g < %g", least, ratio);
    end();
}
END_TEST

/* The tension of a cable changes by up to 0.1 N. A requirement that asks for a change of 5 N is out of reach. There is
 * no claim if it is so far away that samples may lack a shape, if there are no rates, or if it is within reach. */
START_TEST(only_a_requirement_out_of_reach_is_named)
{
    static const struct {
        double change_N;
        bool has_no_rates, is_named;
    } of[] = {{5, false, true}, {50, false, false}, {5, true, false}, {0.02, false, false}};
    hf_repair_doubt found;
    begin(HF_RULE_FORCE_DENSITY, 0.1);
    hf_population *now = &d.optimiser.population;
    hf_objectives objectives = {.model = &d.r.net.model, .constraints = &one_constraint};
    d.r.evaluator.boundary_ratio_cap = INFINITY;
    required.cable = d.r.net.model.variable_cable[0];
    required.has_no_rates = of[_i].has_no_rates;
    hf_form_result r;
    hf_evaluate(&d.r.evaluator, now->design + (size_t)now->best * (size_t)now->n_variable, &d.r.net.work, NULL, &r);
    required.most_N = d.r.net.work.tension_N[required.cable] - of[_i].change_N;
    d.r.evaluator.objectives = &objectives;
    ck_assert_int_eq(hf_repair_create(&d.r.evaluator, now, &d.repair), HF_OK);
    now->trial_status[0] = HF_OUT_OF_LIMITS;
    hf_repair_begin(d.repair, now);
    ck_assert(hf_repair_is_active(d.repair));
    ck_assert_int_eq(hf_repair_doubts(d.repair, &found), of[_i].is_named);
    if (of[_i].is_named) ck_assert(found.constraint == 0 && found.limit.value > 4 && found.limit.value < 5);
    d.r.evaluator.objectives = NULL;
    required.has_no_rates = false;
    end();
}
END_TEST

START_TEST(children_come_within_requirements)
{
    begin(HF_RULE_FORCE_DENSITY, 0.8);
    hf_population *now = &d.optimiser.population, *next = &d.optimiser.next;
    hf_objectives objectives = {.model = &d.r.net.model, .constraints = &one_constraint};
    d.r.evaluator.boundary_ratio_cap = INFINITY;
    required.cable = d.r.net.model.variable_cable[0];
    propose(9);
    double sum = 0;
    for (int i = 0; i < N_CHILD; i++) {
        hf_form_result r;
        hf_evaluate(&d.r.evaluator, next->design + (size_t)i * (size_t)next->n_variable, &d.r.net.work, NULL, &r);
        sum += d.r.net.work.tension_N[required.cable];
    }
    required.most_N = sum / N_CHILD - 0.1;
    d.r.evaluator.objectives = &objectives;
    ck_assert_int_eq(hf_repair_create(&d.r.evaluator, now, &d.repair), HF_OK);
    ck_assert_ptr_nonnull(d.repair);
    now->trial_status[0] = HF_OUT_OF_LIMITS;
    hf_repair_begin(d.repair, now);
    ck_assert(hf_repair_is_active(d.repair));
    d.r.evaluator.objectives = NULL;
    int n_before = 0, n_after = 0;
    for (int i = 0; i < N_CHILD; i++) {
        for (int is_after = 0; is_after < 2; is_after++) {
            hf_form_result r;
            if (is_after) hf_repair_child(d.repair, next, i);
            hf_evaluate(&d.r.evaluator, next->design + (size_t)i * (size_t)next->n_variable, &d.r.net.work, NULL, &r);
            *(is_after ? &n_after : &n_before) += d.r.net.work.tension_N[required.cable] > required.most_N;
        }
    }
    ck_assert_msg(n_before > N_CHILD / 2 && n_after <= N_PROBE + 2, "%d before, %d after", n_before, n_after);
    end();
}
END_TEST

START_TEST(children_stay_where_no_limit_binds)
{
    begin(HF_RULE_FORCE_DENSITY, 0.8);
    hf_population *now = &d.optimiser.population, *next = &d.optimiser.next;
    static double before[N_CHILD * MAX_VARIABLE];
    ck_assert_int_eq(hf_repair_create(&d.r.evaluator, now, &d.repair), HF_OK);
    for (int i = 0; i < N_CHILD; i++)
        now->trial_status[i] = _i ? HF_NOT_CONVERGED : HF_OK; /* without a shape there is no limit either */
    propose(8);
    memcpy(before, next->design, (size_t)N_CHILD * (size_t)next->n_variable * sizeof(double));
    hf_repair_begin(d.repair, now);
    for (int i = 0; i < N_CHILD; i++)
        hf_repair_child(d.repair, next, i);
    ck_assert_mem_eq(before, next->design, (size_t)N_CHILD * (size_t)next->n_variable * sizeof(double));
    end();
}
END_TEST

START_TEST(some_nets_have_no_repair)
{
    begin(_i == 0 ? HF_RULE_SEEDED : HF_RULE_FORCE_DENSITY, 0.8);
    if (_i == 1) d.r.evaluator.boundary_ratio_cap = INFINITY;
    if (_i == 2) d.optimiser.population.n_individual = 1; /* a model costs more than one evaluation */
    ck_assert_int_eq(hf_repair_create(&d.r.evaluator, &d.optimiser.population, &d.repair), HF_OK);
    ck_assert_ptr_null(d.repair);
    d.optimiser.population.n_individual = N_CHILD;
    end();
}
END_TEST

START_TEST(memory_may_fail)
{
    begin(HF_RULE_FORCE_DENSITY, 0.8);
    for (int n = 1;; n++) {
        fail_allocation_at(n);
        hf_status status = hf_optimiser_repair(&d.optimiser, &d.r.evaluator);
        bool has_failed = end_allocation_failure();
        ck_assert_int_eq(status, has_failed ? HF_NO_MEMORY : HF_OK);
        ck_assert_int_lt(n, 100);
        if (!has_failed) break;
        ck_assert_ptr_null(d.optimiser.repair);
    }
    ck_assert_ptr_nonnull(d.optimiser.repair);
    end();
}
END_TEST

Suite *suite_unit_repair(void)
{
    Suite *suite = suite_create("unit/repair");
    TCase *tests = tcase_create("repair");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, most_children_come_within_the_cap, 0, 2);
    tcase_add_loop_test(tests, a_cap_out_of_reach_is_known, 0, 2);
    tcase_add_loop_test(tests, only_a_requirement_out_of_reach_is_named, 0, 4);
    tcase_add_test(tests, children_come_within_requirements);
    tcase_add_loop_test(tests, children_stay_where_no_limit_binds, 0, 2);
    tcase_add_loop_test(tests, some_nets_have_no_repair, 0, 3);
    tcase_add_test(tests, memory_may_fail);
    return suite;
}
