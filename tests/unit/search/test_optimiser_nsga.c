/* The optimiser of fronts on functions that cost nothing and whose fronts are known. The "model" is no more than its
 * genes and their groups. */
#include "support.h"

#include "hypervolume.h"

#include <hifdm/optimiser.h>
#include <math.h>
#include <string.h>

enum { N_VARIABLE = 6, N_GROUP = 3, N = 40 };

static int group_of[N_VARIABLE] = {0, 0, 1, 1, 2, 2};
static int itself[N_VARIABLE] = {0, 1, 2, 3, 4, 5}, leader_of[N_VARIABLE] = {0, 1, 2, 3, 0, 5};
static const hf_model free_variables = {.n_variable = N_VARIABLE,
                                        .n_variable_group = N_GROUP,
                                        .variable_group = group_of,
                                        .variable_leader = itself,
                                        .n_leader = N_VARIABLE};
static const hf_model linked_genes = {.n_variable = N_VARIABLE,
                                      .n_variable_group = N_GROUP,
                                      .variable_group = group_of,
                                      .variable_leader = leader_of,
                                      .n_leader = 5};
static const double initial[N_VARIABLE] = {10, 12, 14, 10, 20, 15};
static const hf_optimize_settings plain = {.population = N,
                                           .generations = 100,
                                           .range_N = 1,
                                           .min_tension_N = 0.1,
                                           .max_tension_N = 30,
                                           .seed = 2022,
                                           .crossover_high = 0.9,
                                           .mutation_high = 0.1,
                                           .elites = 2,
                                           .stagnation_tolerance_m = 1,
                                           .stagnation_generations = 3,
                                           .n_front = 2};

static hf_optimiser create(const hf_optimize_settings *settings, const hf_model *model)
{
    hf_optimiser o;
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_nsga, settings, model, initial, &o), HF_OK);
    return o;
}

/* Square of the distance to base + step in all genes, over that of 1 in each. */
static double square(const double *design, double step)
{
    double sum = 0;
    for (int k = 0; k < N_VARIABLE; k++)
        sum += (design[k] - initial[k] - step) * (design[k] - initial[k] - step) / N_VARIABLE;
    return sum;
}

/* A problem: objectives of a design. */
typedef void objectives(const double *design, hf_form_result *r);

/* The front is the way from base - 0.5 to base + 0.5, at t of it {t^2, (1 - t)^2}: bent inwards. */
static void inwards(const double *design, hf_form_result *r)
{
    r->objective[0] = square(design, -0.5);
    r->objective[1] = square(design, 0.5);
}

/* The same front, bent outwards (Fonseca & Fleming 1995). */
static void outwards(const double *design, hf_form_result *r)
{
    r->objective[0] = 1 - exp(-4 * square(design, -0.5));
    r->objective[1] = 1 - exp(-4 * square(design, 0.5));
}

static void evaluate(hf_optimiser *o, objectives *f)
{
    for (int i = 0; i < o->population.n_individual; i++) {
        hf_form_result *r = &o->population.result[i];
        if (!o->population.pending[i]) continue;
        *r = (hf_form_result){.status = HF_OK, .psi_m = 1, .merit = 1};
        f(o->population.design + i * N_VARIABLE, r);
    }
}

static double volume_of(const hf_population *p, const double reference[3])
{
    double point[N][3];
    int n = 0;
    for (int i = 0; i < p->n_individual; i++) {
        if (p->result[i].status != HF_OK) continue;
        memcpy(point[n], p->result[i].objective, sizeof point[n]);
        if (p->n_objective == 2) point[n][2] = 0;
        n++;
    }
    return hypervolume(n, point, reference);
}

static double evolve(hf_optimiser *o, objectives *f, const double reference[3])
{
    do {
        evaluate(o, f);
        hf_optimiser_tell(o);
    } while (hf_optimiser_next(o));
    return volume_of(&o->population, reference);
}

/* Below (1, 1) the front {t^2, (1 - t)^2} dominates 5/6, and {1 - e^(-4 t^2), 1 - e^(-4 (1 - t)^2)} what its sum by the
 * trapezoidal rule says. N points, spread as well as can be, leave about 1/(2 N) of it uncovered. */
START_TEST(known_fronts_are_covered)
{
    static const double one[3] = {1, 1, 1};
    double bent = 0, before = 0;
    for (int i = 1; i <= 100000; i++) {
        double t = i * 1e-5, x = 1 - exp(-4 * t * t), y = 1 - exp(-4 * (1 - t) * (1 - t));
        bent += (x - before) * (1 - y);
        before = x;
    }
    bent += 1 - before; /* what the end dominates alone */
    for (int seed = 1; seed <= 3; seed++) {
        hf_optimize_settings s = plain;
        s.seed = (uint64_t)seed;
        hf_optimiser in = create(&s, &free_variables), out = create(&s, &free_variables);
        ck_assert_double_ge(evolve(&in, inwards, one), 0.98 * 5 / 6);
        ck_assert_double_le(volume_of(&in.population, one), 5.0 / 6);
        ck_assert_double_ge(evolve(&out, outwards, one), 0.95 * bent);
        ck_assert_double_le(volume_of(&out.population, one), bent + 1e-4);
        ck_assert_int_eq(in.population.stop_reason, HF_POPULATION_GENERATIONS); /* a front does not stagnate */
        hf_optimiser_free(&in);
        hf_optimiser_free(&out);
    }
}
END_TEST

/* Distances to three points: the front is the triangle between them. */
static void triangle(const double *design, hf_form_result *r)
{
    for (int j = 0; j < 3; j++) {
        r->objective[j] = 0;
        for (int k = 0; k < N_VARIABLE; k++)
            r->objective[j] += pow(design[k] - initial[k] - (group_of[k] == j ? 0.5 : 0), 2);
    }
}

/* At weights a the triangle has goal[j] = (sum a_k^2 - 2 a_j + 1)/2, since each corner is 1/sqrt(2) from the base. */
static double volume_of_triangle(const double reference[3])
{
    enum { STEPS = 20, ALL = (STEPS + 1) * (STEPS + 2) / 2 };
    double point[ALL][3];
    int n = 0;
    for (int i = 0; i <= STEPS; i++)
        for (int k = 0; i + k <= STEPS; k++, n++) {
            double a[3] = {(double)i / STEPS, (double)k / STEPS, (double)(STEPS - i - k) / STEPS};
            for (int j = 0; j < 3; j++)
                point[n][j] = 0.5 * (a[0] * a[0] + a[1] * a[1] + a[2] * a[2] - 2 * a[j] + 1);
        }
    return hypervolume(n, point, reference);
}

START_TEST(fronts_of_three_objectives_are_surfaces)
{
    static const double reference[3] = {1.1, 1.1, 1.1};
    hf_optimize_settings s = plain;
    s.n_front = 3;
    hf_optimiser o = create(&s, &free_variables);
    ck_assert_double_ge(evolve(&o, triangle, reference), 0.83 * volume_of_triangle(reference));
    hf_optimiser_free(&o);
}
END_TEST

static bool is_same_design(const hf_population *a, int i, const hf_population *b, int k)
{
    return !memcmp(a->design + i * N_VARIABLE, b->design + k * N_VARIABLE, N_VARIABLE * sizeof(double));
}

/* Nobody lives on twice, all who live on are at a place of their own, and the ends of the front are never lost. */
START_TEST(every_generation_keeps_the_rules)
{
    const hf_model *const models[] = {&free_variables, &linked_genes};
    hf_optimiser o = create(&plain, models[_i]);
    hf_population *p = &o.population, *before = &o.next;
    double least[2] = {INFINITY, INFINITY};
    do {
        evaluate(&o, inwards);
        hf_optimiser_tell(&o);
        double now[2] = {INFINITY, INFINITY};
        for (int i = 0; i < N; i++) {
            for (int k = 0; k < i && p->generation > 0; k++)
                ck_assert(!is_same_design(p, i, p, k));
            for (int k = 0; k < N_VARIABLE; k++)
                ck_assert(fabs(p->design[i * N_VARIABLE + k] - initial[k]) <= 1 + 1e-12);
            if (_i) ck_assert_double_eq_tol(p->design[i * N_VARIABLE + 4] - 20, p->design[i * N_VARIABLE] - 10, 1e-12);
            for (int j = 0; j < 2; j++)
                now[j] = fmin(now[j], p->result[i].objective[j]);
            int kept = p->parent[2 * i];
            if (p->generation == 0 || p->parent[2 * i + 1] >= 0) continue;
            ck_assert(kept >= 0 && kept < N && is_same_design(p, i, before, kept));
            ck_assert_mem_eq(p->result[i].objective, before->result[kept].objective, 2 * sizeof(double));
        }
        for (int j = 0; j < 2; j++) {
            ck_assert_double_le(now[j], least[j]);
            least[j] = now[j];
        }
        ck_assert_double_eq(p->result[p->best].objective[0], now[0]); /* the best is the end of the first objective */
        ck_assert_double_eq(p->best_merit[p->generation], now[0]);
    } while (hf_optimiser_next(&o));
    hf_optimiser_free(&o);
}
END_TEST

/* As after a kill: another optimiser with a copy of the population, asked in another order. */
START_TEST(proposals_depend_on_the_population_alone)
{
    hf_optimiser a = create(&plain, &free_variables), b = create(&plain, &free_variables);
    for (int g = 0; g < 5; g++) {
        evaluate(&a, inwards);
        hf_optimiser_tell(&a);
        hf_optimiser_next(&a);
    }
    evaluate(&a, inwards);
    hf_optimiser_tell(&a);
    memcpy(b.population.design, a.population.design, N * N_VARIABLE * sizeof(double));
    memcpy(b.population.result, a.population.result, N * sizeof(hf_form_result));
    b.population.generation = a.population.generation;
    b.is_fresh = false;
    hf_optimiser_tell(&b);
    ck_assert(hf_optimiser_begin(&b) && hf_optimiser_next(&a));
    for (int i = N - 1; i >= 0; i--)
        hf_optimiser_propose(&b, i);
    hf_optimiser_end(&b);
    ck_assert_mem_eq(a.population.design, b.population.design, N * N_VARIABLE * sizeof(double));
    ck_assert_mem_eq(a.population.pending, b.population.pending, N);
    hf_optimiser_free(&a);
    hf_optimiser_free(&b);
}
END_TEST

/* Only near base + 0.9 in all genes, where no design of the first generation is; goals are not numbers elsewhere. */
static void far_away(const double *design, hf_form_result *r)
{
    double beyond = square(design, 0.9) - 0.01;
    inwards(design, r);
    if (!(beyond > 0)) return;
    *r = (hf_form_result){.status = HF_OUT_OF_LIMITS, .violation = beyond, .psi_m = NAN, .merit = NAN};
    r->objective[0] = r->objective[1] = NAN;
}

START_TEST(a_population_outside_its_limits_finds_its_way_in)
{
    static const double reference[3] = {4, 1, 1};
    hf_optimiser o = create(&plain, &free_variables);
    evaluate(&o, far_away);
    hf_optimiser_tell(&o);
    ck_assert_int_eq(o.population.best, -1);
    ck_assert(hf_optimiser_next(&o));
    ck_assert_double_gt(evolve(&o, far_away, reference), 0);
    ck_assert_int_eq(o.population.n_infeasible, 0);
    ck_assert_double_eq_tol(o.population.result[o.population.best].objective[0], 1.3 * 1.3, 0.02); /* at base + 0.8 */
    hf_optimiser_free(&o);
}
END_TEST

/* Without a shape anywhere, and with an objective that is not a number although the status is ok. */
START_TEST(nothing_to_begin_from_is_no_fault)
{
    hf_optimiser o = create(&plain, &free_variables);
    for (int i = 0; i < N; i++)
        o.population.result[i] = (hf_form_result){.status = HF_COLLAPSED, .psi_m = NAN, .merit = NAN};
    hf_optimiser_tell(&o);
    ck_assert_int_eq(o.population.stop_reason, HF_POPULATION_ALL_INFEASIBLE);
    hf_optimiser_free(&o);
    o = create(&plain, &free_variables);
    evaluate(&o, inwards);
    for (int i = 1; i < N; i++)
        o.population.result[i].objective[i % 2] = NAN;
    hf_optimiser_tell(&o);
    ck_assert(hf_optimiser_next(&o));
    evaluate(&o, inwards);
    hf_optimiser_tell(&o);
    int n_number = 0;
    for (int i = 0; i < N; i++)
        n_number += isfinite(o.population.result[i].objective[0]) && isfinite(o.population.result[i].objective[1]);
    ck_assert_int_ge(n_number, N / 2); /* all children that are not the base again, and the base */
    hf_optimiser_free(&o);
}
END_TEST

Suite *suite_unit_optimiser_nsga(void)
{
    Suite *suite = suite_create("unit/optimiser_nsga");
    TCase *tests = tcase_create("nsga");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, known_fronts_are_covered);
    tcase_add_test(tests, fronts_of_three_objectives_are_surfaces);
    tcase_add_loop_test(tests, every_generation_keeps_the_rules, 0, 2);
    tcase_add_test(tests, proposals_depend_on_the_population_alone);
    tcase_add_test(tests, a_population_outside_its_limits_finds_its_way_in);
    tcase_add_test(tests, nothing_to_begin_from_is_no_fault);
    return suite;
}
