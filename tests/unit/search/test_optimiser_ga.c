/* The genetic algorithm on functions that cost nothing: bounds, rates, elites, stopping, and what its random numbers
 * depend on. The "model" is no more than its genes and their groups. */
#include "support.h"

#include <hifdm/optimiser.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N_VARIABLE = 6, N_GROUP = 3, N = 20 };

static int group_of[N_VARIABLE] = {0, 0, 1, 1, 2, 2};
static int leader_of[N_VARIABLE] = {0, 1, 2, 3, 4, 5};
static const hf_model model = {.n_variable = N_VARIABLE,
                               .n_variable_group = N_GROUP,
                               .variable_group = group_of,
                               .variable_leader = leader_of,
                               .n_leader = N_VARIABLE};
static const double initial[N_VARIABLE] = {10, 12, 14, 0.4, 20, 29.7};

/* METHOD section 7; bounds that cut the ranges of the genes 3 (0.4 - 1 is below 0.1) and 5 (29.7 + 1 is above 30). */
static const hf_optimize_settings plain = {.population = N,
                                           .generations = 60,
                                           .range_N = 1,
                                           .min_tension_N = 0.1,
                                           .max_tension_N = 30,
                                           .seed = 2022,
                                           .crossover_high = 0.9,
                                           .crossover_low = 0.6,
                                           .mutation_high = 0.1,
                                           .mutation_low = 0.001,
                                           .variation = HF_VARIATION_CHAIN,
                                           .elites = 2,
                                           .stagnation_tolerance_m = 0,
                                           .stagnation_generations = 1000};

static hf_optimiser create(const hf_optimize_settings *settings)
{
    hf_optimiser ga;
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, settings, &model, initial, &ga), HF_OK);
    return ga;
}

/* Distance to a point inside the bounds, made of group steps 0.5, -0.3 and 0.2 from the base. */
static double distance_m(const double *design)
{
    static const double step[N_GROUP] = {0.5, -0.3, 0.2};
    double sum = 0;
    for (int k = 0; k < N_VARIABLE; k++) {
        double d = design[k] - (initial[k] + step[group_of[k]]);
        sum += d * d;
    }
    return sqrt(sum);
}

static void evaluate_pending(hf_optimiser *ga)
{
    for (int i = 0; i < ga->population.n_individual; i++)
        if (ga->population.pending[i])
            ga->population.result[i] = (hf_form_result){.status = HF_OK,
                                                        .psi_m = distance_m(ga->population.design + i * N_VARIABLE),
                                                        .merit = distance_m(ga->population.design + i * N_VARIABLE)};
}

START_TEST(first_generation_surrounds_the_base)
{
    hf_optimiser ga = create(&plain);
    double lowest[N_VARIABLE], highest[N_VARIABLE];
    ck_assert_mem_eq(ga.population.design, initial, sizeof initial); /* individual 0 */
    for (int k = 0; k < N_VARIABLE; k++)
        lowest[k] = INFINITY, highest[k] = -INFINITY;
    for (int i = 0; i < N; i++) {
        const double *d = ga.population.design + i * N_VARIABLE;
        ck_assert_int_eq(ga.population.pending[i], 1);
        ck_assert_double_nan(ga.population.crossover_rate[i]);
        ck_assert_int_eq(ga.population.parent[2 * i], -1);
        ck_assert_double_eq_tol(d[0] - initial[0], d[1] - initial[1], 1e-14); /* one number for the group (Eq. 13) */
        for (int k = 0; k < N_VARIABLE; k++) {
            ck_assert(d[k] >= fmax(initial[k] - 1, 0.1) && d[k] <= fmin(initial[k] + 1, 30));
            lowest[k] = fmin(lowest[k], d[k]), highest[k] = fmax(highest[k], d[k]);
        }
    }
    for (int k = 0; k < 3; k++) /* 20 uniform numbers in (-1, 1): all on one side with probability 1e-6 */
        ck_assert(lowest[k] < initial[k] - 0.3 && highest[k] > initial[k] + 0.3);
    hf_optimiser_free(&ga);
}
END_TEST

START_TEST(telling_finds_best_mean_and_worst)
{
    hf_optimiser ga = create(&plain);
    for (int i = 0; i < N; i++)
        ga.population.result[i] = (hf_form_result){.status = HF_COLLAPSED, .psi_m = (double)NAN, .merit = (double)NAN};
    ga.population.result[5] = (hf_form_result){.status = HF_OK, .psi_m = 3, .merit = 3};
    ga.population.result[7] = (hf_form_result){.status = HF_OK, .psi_m = 2, .merit = 2};
    ga.population.result[9] = (hf_form_result){.status = HF_OK, .psi_m = 2, .merit = 2};
    hf_optimiser_tell(&ga);
    ck_assert_int_eq(ga.population.best, 7); /* of equals the first */
    ck_assert_double_eq_tol(ga.population.mean_psi_m, 7.0 / 3, 1e-15);
    ck_assert_double_eq(ga.population.worst_psi_m, 3);
    ck_assert_double_eq(ga.population.best_psi_m[0], 2);
    ck_assert_int_eq(ga.population.n_infeasible, N - 3);
    ck_assert_int_eq((int)ga.population.n_evaluation, N);
    ck_assert_int_eq((int)ga.population.n_evaluation_infeasible, N - 3);
    ck_assert_int_eq(ga.population.stop_reason, HF_POPULATION_RUNNING);
    ck_assert_int_eq(hf_optimiser_next(&ga), 1);
    for (int i = 2; i < N; i++) /* all after the elites have feasible parents */
        for (int side = 0; side < 2; side++) {
            int parent = ga.population.parent[2 * i + side];
            ck_assert(parent == 5 || parent == 7 || parent == 9);
        }
    hf_optimiser_free(&ga);
}
END_TEST

START_TEST(nothing_feasible_goes_on_looking)
{
    hf_optimiser ga = create(&plain);
    for (int i = 0; i < N; i++)
        ga.population.result[i] =
            (hf_form_result){.status = HF_RATIO_CAP, .psi_m = (double)NAN, .merit = (double)NAN, .violation = 1};
    hf_optimiser_tell(&ga);
    ck_assert_int_eq(ga.population.best, -1);
    ck_assert_double_nan(ga.population.best_psi_m[0]);
    ck_assert_int_eq(hf_optimiser_next(&ga), 1);
    for (int i = 2; i < N; i++)
        ck_assert_double_eq(ga.population.mutation_rate[i], 0.1);
    hf_optimiser_free(&ga);
}
END_TEST

/* METHOD section 7, with psi' the better parent. A result of psi = mean - (mean - best) f has the rates high - (high -
 * low) f; those above the mean the high ones. (A printed variant has it the other way round: it disturbs the best
 * most.) */
START_TEST(rates_follow_srinivas_and_patnaik)
{
    hf_optimiser ga = create(&plain);
    double psi[N];
    for (int i = 0; i < N; i++) {
        psi[i] = 1 + 0.1 * ((i * 7) % N);
        ga.population.result[i] = (hf_form_result){.status = HF_OK, .psi_m = psi[i], .merit = psi[i]};
    }
    hf_optimiser_tell(&ga);
    double mean = ga.population.mean_psi_m, best = 1;
    int n_low = 0, n_between = 0, n_high = 0;
    ck_assert_double_eq_tol(mean, 1.95, 1e-14);
    ck_assert_int_eq(hf_optimiser_next(&ga), 1);
    for (int i = 2; i < N; i++) {
        double better = fmin(psi[ga.population.parent[2 * i]], psi[ga.population.parent[2 * i + 1]]);
        double f = better <= mean ? (mean - better) / (mean - best) : 0;
        ck_assert_double_eq_tol(ga.population.crossover_rate[i], 0.9 - 0.3 * f, 1e-14);
        ck_assert_double_eq_tol(ga.population.mutation_rate[i], 0.1 - 0.099 * f, 1e-14);
        n_low += better == best, n_high += f == 0, n_between += f > 0 && better > best;
    }
    ck_assert(n_low + n_between > 0 && n_low + n_between + n_high == N - 2);
    hf_optimiser_free(&ga);
}
END_TEST

/* 60 generations, each looked at in full. */
START_TEST(every_generation_obeys_the_rules)
{
    hf_optimiser ga = create(&plain);
    double *parents = malloc(N * N_VARIABLE * sizeof *parents), best = INFINITY;
    hf_form_result told[N];
    ck_assert_ptr_nonnull(parents);
    for (;;) {
        evaluate_pending(&ga);
        hf_optimiser_tell(&ga);
        ck_assert_double_le(ga.population.best_psi_m[ga.population.generation], best); /* elites: never worse */
        best = ga.population.best_psi_m[ga.population.generation];
        memcpy(parents, ga.population.design, N * N_VARIABLE * sizeof *parents);
        memcpy(told, ga.population.result, sizeof told);
        int best_parent = ga.population.best;
        if (!hf_optimiser_next(&ga)) break;
        ck_assert_int_eq(ga.population.parent[0], best_parent);
        for (int i = 0; i < N; i++) {
            const double *child = ga.population.design + i * N_VARIABLE,
                         *mother = parents + ga.population.parent[2 * i] * N_VARIABLE;
            int is_equal = !memcmp(child, mother, N_VARIABLE * sizeof *child);
            if (i < plain.elites) ck_assert(is_equal);
            ck_assert_int_eq(ga.population.pending[i], !is_equal);
            if (is_equal) ck_assert_double_eq(ga.population.result[i].psi_m, told[ga.population.parent[2 * i]].psi_m);
            for (int k = 0; k < N_VARIABLE; k++)
                ck_assert(child[k] >= fmax(initial[k] - 1, 0.1) && child[k] <= fmin(initial[k] + 1, 30));
        }
        ck_assert_double_le(told[ga.population.parent[0]].psi_m,
                            told[ga.population.parent[2]].psi_m); /* elites in order, and not one of them twice */
        ck_assert_int_ne(ga.population.parent[0], ga.population.parent[2]);
    }
    ck_assert_int_eq(ga.population.stop_reason, HF_POPULATION_GENERATIONS);
    ck_assert_int_eq(ga.population.generation, 59);
    ck_assert_double_lt(best, 0.5 * distance_m(initial)); /* it searches: measured 0.1 of the base's distance */
    free(parents);
    hf_optimiser_free(&ga);
}
END_TEST

/* Without crossover a child is its mother but for mutations, which raise a tension as often as they lower it: of
 * 878 that stay clear of the bounds, 50 % with a standard deviation of 1.7 %. */
START_TEST(mutations_go_both_ways)
{
    hf_optimize_settings s = plain;
    double parents[N * N_VARIABLE];
    int n_up = 0, n_down = 0;
    s.crossover_high = s.crossover_low = 0;
    s.mutation_high = s.mutation_low = 0.3;
    hf_optimiser ga = create(&s);
    for (;;) {
        evaluate_pending(&ga);
        hf_optimiser_tell(&ga);
        memcpy(parents, ga.population.design, sizeof parents);
        if (!hf_optimiser_next(&ga)) break;
        for (int i = 0; i < N * N_VARIABLE; i++) {
            int k = i % N_VARIABLE;
            double was_N = parents[ga.population.parent[2 * (i / N_VARIABLE)] * N_VARIABLE + k];
            if (k == 3 || k == 5 || fabs(was_N - initial[k]) > 0.5) continue; /* a step may be cut at a bound */
            n_up += ga.population.design[i] > was_N;
            n_down += ga.population.design[i] < was_N;
        }
    }
    ck_assert_int_gt(n_up + n_down, 500);
    ck_assert_msg(fabs(n_up / (double)(n_up + n_down) - 0.5) < 0.1, "%d up, %d down", n_up, n_down);
    hf_optimiser_free(&ga);
}
END_TEST

/* Roulette: over many draws the best of a population is a parent more often than an average one, that more than the
 * worst; the fitness ratios are about 50 : 25 : 1, so the order is certain. */
START_TEST(better_individuals_have_more_children)
{
    int n_child[3] = {0};
    for (uint64_t seed = 0; seed < 50; seed++) {
        hf_optimize_settings s = plain;
        s.seed = seed;
        hf_optimiser ga = create(&s);
        for (int i = 0; i < N; i++)
            ga.population.result[i] = (hf_form_result){.status = HF_OK, .psi_m = 2 + 0.1 * i, .merit = 2 + 0.1 * i};
        hf_optimiser_tell(&ga);
        hf_optimiser_next(&ga);
        for (int k = 2 * plain.elites; k < 2 * N; k++) {
            n_child[0] += ga.population.parent[k] == 0, n_child[1] += ga.population.parent[k] == N / 2,
                n_child[2] += ga.population.parent[k] == N - 1;
        }
        hf_optimiser_free(&ga);
    }
    ck_assert(n_child[0] > n_child[1] && n_child[1] > n_child[2] && n_child[2] > 0);
}
END_TEST

/* One best individual and one worst, the others infeasible: with a floor of 0.02 the fitnesses are 1.02 and 0.02. The
 * worst is then 0.0192 of the parents: 138 of 7200 draws, with a standard deviation of 12. Floors of 0.0133 and 0.03
 * would give 94 and 204. */
START_TEST(worst_individual_keeps_its_floor)
{
    int n_worst = 0, n_draw = 0;
    for (uint64_t seed = 0; seed < 200; seed++) {
        hf_optimize_settings s = plain;
        s.seed = seed;
        hf_optimiser ga = create(&s);
        for (int i = 0; i < N; i++)
            ga.population.result[i] =
                (hf_form_result){.status = HF_COLLAPSED, .psi_m = (double)NAN, .merit = (double)NAN};
        ga.population.result[4] = (hf_form_result){.status = HF_OK, .psi_m = 1, .merit = 1};
        ga.population.result[11] = (hf_form_result){.status = HF_OK, .psi_m = 7, .merit = 7};
        hf_optimiser_tell(&ga);
        ck_assert(hf_optimiser_next(&ga));
        for (int k = 2 * s.elites; k < 2 * N; k++, n_draw++)
            n_worst += ga.population.parent[k] == 11;
        hf_optimiser_free(&ga);
    }
    ck_assert_int_eq(n_draw, 7200);
    ck_assert(n_worst > 105 && n_worst < 172);
}
END_TEST

/* ---- the variation `difference` ---- */

static hf_optimize_settings by_difference(void)
{
    hf_optimize_settings s = plain;
    s.variation = HF_VARIATION_DIFFERENCE;
    s.elites = 1;
    return s;
}

static double best_after(const hf_optimize_settings *s, int generations)
{
    hf_optimize_settings some = *s;
    some.generations = generations;
    hf_optimiser ga = create(&some);
    do {
        evaluate_pending(&ga);
        hf_optimiser_tell(&ga);
    } while (hf_optimiser_next(&ga));
    double best = ga.population.best_psi_m[ga.population.generation];
    hf_optimiser_free(&ga);
    return best;
}

/* A child stands where it is not worse than what stood there; else that stays, bit for bit, and the trial is noted. */
START_TEST(nobody_gives_way_to_a_worse_child)
{
    hf_optimize_settings s = by_difference();
    hf_optimiser ga = create(&s);
    const hf_population *p = &ga.population;
    double before[N * N_VARIABLE], trial[N];
    hf_form_result was[N];
    int n_kept = 0, n_new = 0;
    evaluate_pending(&ga);
    hf_optimiser_tell(&ga);
    for (;;) {
        memcpy(before, p->design, sizeof before);
        memcpy(was, p->result, sizeof was);
        if (!hf_optimiser_next(&ga)) break;
        evaluate_pending(&ga);
        for (int i = 0; i < N; i++) {
            trial[i] = p->result[i].psi_m;
            ck_assert_double_eq(p->result[i].psi_m,
                                distance_m(p->design + i * N_VARIABLE)); /* also where not pending */
        }
        hf_optimiser_tell(&ga);
        for (int i = 0; i < N; i++) {
            bool is_kept = p->parent[2 * i] == i && p->parent[2 * i + 1] == -1;
            const double *design = p->design + i * N_VARIABLE;
            ck_assert_double_eq(p->trial_psi_m[i], trial[i]);
            ck_assert_double_eq(p->result[i].psi_m, fmin(trial[i], was[i].psi_m));
            ck_assert_int_eq(is_kept, !p->pending[i] || trial[i] > was[i].psi_m);
            if (is_kept) ck_assert_mem_eq(design, before + i * N_VARIABLE, N_VARIABLE * sizeof *design);
            for (int k = 0; k < N_VARIABLE; k++)
                ck_assert(design[k] >= p->lower[k] && design[k] <= p->upper[k]);
            n_kept += is_kept;
            n_new += !is_kept;
        }
    }
    ck_assert_int_gt(n_kept, 100);
    ck_assert_int_gt(n_new, 100);
    hf_optimiser_free(&ga);
}
END_TEST

/* Counts children of the second generations of 100 seeds. Nothing mutates, except all genes together. If `is_at_limit`,
 * one individual is above a cap. */
typedef struct {
    int n, from_centre, from_elite, all_moved;
} leaders;

static leaders look_at_crossovers(bool is_at_limit)
{
    hf_optimize_settings s = by_difference();
    leaders found = {0};
    s.crossover_high = s.crossover_low = 1;
    s.mutation_high = s.mutation_low = 0;
    s.elites = 1;
    for (s.seed = 1; s.seed <= 100; s.seed++) {
        hf_optimiser ga = create(&s);
        const hf_population *p = &ga.population, *before = &ga.next;
        int best[3];
        double centre[N_VARIABLE] = {0};
        evaluate_pending(&ga);
        if (is_at_limit) ga.population.result[7] = (hf_form_result){.status = HF_RATIO_CAP, .violation = 1};
        hf_optimiser_tell(&ga);
        for (int e = 0; e < 3; e++) {
            best[e] = -1;
            for (int i = 0; i < N; i++)
                if ((e < 1 || i != best[0]) && (e < 2 || i != best[1]) &&
                    (best[e] < 0 || hf_population_is_better(p, i, best[e])))
                    best[e] = i;
            for (int k = 0; k < N_VARIABLE; k++)
                centre[k] += p->design[best[e] * N_VARIABLE + k] / 3;
        }
        ck_assert(hf_optimiser_next(&ga));
        for (int i = 0; i < N; i++) {
            const double *child = p->design + i * N_VARIABLE, *elite = before->design + best[0] * N_VARIABLE;
            int n_centre = 0, n_elite = 0;
            if (p->parent[2 * i] == p->parent[2 * i + 1]) continue; /* no crossover */
            for (int k = 0; k < N_VARIABLE; k++) {
                if (k == 3 || k == 5) continue; /* often at a bound */
                n_centre += child[k] == centre[k];
                n_elite += child[k] == elite[k];
            }
            found.n++;
            found.from_centre += n_centre > 0;
            found.from_elite += n_elite > 0;
            found.all_moved += n_centre + n_elite == 0;
        }
        hf_optimiser_free(&ga);
    }
    return found;
}

/* A gene that a crossover does not move is that of the leader. */
START_TEST(crossovers_begin_at_the_mean_of_the_best_or_at_an_elite)
{
    leaders inside = look_at_crossovers(false), at_limit = look_at_crossovers(true);
    double part = (double)inside.from_centre / (inside.from_centre + inside.from_elite);
    ck_assert_double_ge(part, 0.65); /* 0.7 of some 1400 */
    ck_assert_double_le(part, 0.75);
    ck_assert_double_ge(1.0 * at_limit.all_moved / at_limit.n, 0.5);
    ck_assert_double_le(1.0 * inside.all_moved / inside.n, 0.35);
}
END_TEST

/* Without crossover and other mutations, some children differ from their individual in all genes, by one part of the
 * width of the bounds. */
START_TEST(all_genes_may_take_one_step)
{
    hf_optimize_settings s = by_difference();
    int n_moved = 0, n_child = 0;
    s.crossover_high = s.crossover_low = s.mutation_high = s.mutation_low = 0;
    for (s.seed = 1; s.seed <= 100; s.seed++) {
        hf_optimiser ga = create(&s);
        const hf_population *p = &ga.population;
        evaluate_pending(&ga);
        hf_optimiser_tell(&ga);
        ck_assert(hf_optimiser_next(&ga));
        for (int i = 0; i < N; i++) {
            double part = 0;
            for (int k = 0; k < N_VARIABLE && p->pending[i]; k++) {
                double child = p->design[i * N_VARIABLE + k], was = ga.next.design[i * N_VARIABLE + k];
                if (child == p->lower[k] || child == p->upper[k]) continue; /* clamped */
                double step = (child - was) / (p->upper[k] - p->lower[k]);
                if (part != 0) ck_assert_double_eq_tol(step, part, 1e-13);
                part = step;
            }
            n_moved += p->pending[i];
            n_child++;
        }
        hf_optimiser_free(&ga);
    }
    ck_assert_int_ge(n_moved, n_child * 35 / 1000); /* 5 % of 2000 */
    ck_assert_int_le(n_moved, n_child * 65 / 1000);
}
END_TEST

/* Of genes that want unequal steps within their groups, which no step of whole groups gives. */
START_TEST(difference_gets_nearer_than_chain)
{
    hf_optimize_settings chain = plain, difference = by_difference();
    int n_nearer = 0;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        chain.seed = difference.seed = seed;
        n_nearer += best_after(&difference, 60) < 0.1 * best_after(&chain, 60);
    }
    ck_assert_int_ge(n_nearer, 15); /* measured 20 */
}
END_TEST

/* Feasible is what lies within 0.05 of the point that is sought; the violation is how far the way there is. */
START_TEST(a_population_outside_its_limits_finds_the_way_in)
{
    hf_optimize_settings s = by_difference();
    s.stagnation_generations = 10;
    hf_optimiser ga = create(&s);
    hf_population *p = &ga.population;
    double least = INFINITY;
    do {
        for (int i = 0; i < N; i++) {
            double far_m = distance_m(p->design + i * N_VARIABLE);
            if (!p->pending[i]) continue;
            p->result[i] = (hf_form_result){.status = HF_OK, .psi_m = 1 + far_m, .merit = 1 + far_m};
            if (far_m > 0.05)
                p->result[i] = (hf_form_result){
                    .status = HF_RATIO_CAP, .psi_m = (double)NAN, .merit = (double)NAN, .violation = far_m};
        }
        hf_optimiser_tell(&ga);
        ck_assert_double_le(p->least_violation[p->generation], least);
        least = p->least_violation[p->generation];
    } while (hf_optimiser_next(&ga));
    ck_assert_int_ge(p->best, 0);
    ck_assert_double_eq(least, 0);
    hf_optimiser_free(&ga);
}
END_TEST

/* ---- stopping ---- */

/* Of results that are all alike. */
static hf_population_stop stop_after(const hf_optimize_settings *s, hf_status status, int *generation)
{
    hf_optimiser ga = create(s);
    do {
        for (int i = 0; i < N; i++)
            ga.population.result[i] = (hf_form_result){.status = status,
                                                       .psi_m = status == HF_OK ? 1 : (double)NAN,
                                                       .merit = status == HF_OK ? 1 : (double)NAN,
                                                       .violation = status == HF_OK ? 0 : 2};
        hf_optimiser_tell(&ga);
    } while (hf_optimiser_next(&ga));
    *generation = ga.population.generation;
    hf_population_stop reason = ga.population.stop_reason;
    hf_optimiser_free(&ga);
    return reason;
}

START_TEST(search_ends_for_a_reason)
{
    hf_optimize_settings s = plain;
    int generation;
    ck_assert_int_eq(stop_after(&s, HF_COLLAPSED, &generation), HF_POPULATION_ALL_INFEASIBLE);
    ck_assert_int_eq(generation, 0); /* the base and all around it have no shape */
    ck_assert_int_eq(stop_after(&s, HF_RATIO_CAP, &generation), HF_POPULATION_ALL_INFEASIBLE);
    ck_assert_int_eq(generation, 59);
    s.stagnation_generations = 7;
    ck_assert_int_eq(stop_after(&s, HF_RATIO_CAP, &generation), HF_POPULATION_ALL_INFEASIBLE);
    ck_assert_int_eq(generation, 7);
    s.stagnation_tolerance_m = 1e-9;
    ck_assert_int_eq(stop_after(&s, HF_OK, &generation), HF_POPULATION_STAGNATION);
    ck_assert_int_eq(generation, 7); /* a window of 7 needs 7 generations behind it */
    s.generations = 5;
    ck_assert_int_eq(stop_after(&s, HF_OK, &generation), HF_POPULATION_GENERATIONS);
    ck_assert_int_eq(generation, 4);
}
END_TEST

Suite *suite_unit_optimiser_ga(void)
{
    Suite *suite = suite_create("unit/optimiser_ga");
    TCase *tests = tcase_create("ga");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, first_generation_surrounds_the_base);
    tcase_add_test(tests, telling_finds_best_mean_and_worst);
    tcase_add_test(tests, nothing_feasible_goes_on_looking);
    tcase_add_test(tests, rates_follow_srinivas_and_patnaik);
    tcase_add_test(tests, every_generation_obeys_the_rules);
    tcase_add_test(tests, mutations_go_both_ways);
    tcase_add_test(tests, better_individuals_have_more_children);
    tcase_add_test(tests, worst_individual_keeps_its_floor);
    tcase_add_test(tests, nobody_gives_way_to_a_worse_child);
    tcase_add_test(tests, crossovers_begin_at_the_mean_of_the_best_or_at_an_elite);
    tcase_add_test(tests, all_genes_may_take_one_step);
    tcase_add_test(tests, difference_gets_nearer_than_chain);
    tcase_add_test(tests, a_population_outside_its_limits_finds_the_way_in);
    tcase_add_test(tests, search_ends_for_a_reason);
    return suite;
}
