/* Implements the genetic algorithm for a Pareto front of two or three objectives. NSGA-II selects the survivors (Deb,
 * Pratap, Agarwal & Meyarivan, IEEE Trans. Evol. Comput. 6, 2002). Children are made as in the variation `difference`
 * of optimiser_ga.c.
 *
 *     N individuals -> first front -> random weights -> best individual by them -> crossover -> mutation -> child
 *     N individuals + N children -> fronts -> whole fronts, then the best spread part of the next front -> N survivors
 *
 * hf_pareto_keep selects the part of the front that does not fit as a whole. Infeasible designs rank after all feasible
 * ones, by their violation. The best individual by the weights moves along the difference of two others, or towards
 * another one. Because each child draws its own weights, the population moves towards all parts of the front, as in
 * decomposition (Zhang & Li, IEEE Trans. Evol. Comput. 11, 2007), but without neighbourhoods.
 *
 * Contents: state - origins of children - weights - a child - survival */
#include <hifdm/optimiser.h>

#include "base/arena.h"
#include "search/breeding.h"
#include "search/pareto.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Measured on the nets of METHOD section 7, which also lists the results of other constants. */
static const hf_breeding_move crossover = {.step_max = 3.0, .share_octaves = 4.0, .by_chain = 0.7};
#define BY_APPROACH 0.4 /* share of crossovers towards another individual; the others use the difference of two */
#define BY_SUM 0.5      /* share of children that weigh the sum of the objectives; the others weigh their maximum */
#define SUM_SHARE 0.01  /* part of the sum that is added to the maximum, so that no dominated design is the best */
#define RATE 0.2        /* mutation rate of a chain, as a part of mutation_high */
#define SINGLES 10.0    /* mean number of genes that mutate alone, divided by the rate of a chain */

/* ---- state ---- */

typedef struct {
    hf_breeding breeding;
    hf_pareto both; /* individual i, and its child at i + N; `begin` uses the first N alone */
    int *rank;      /* [2 N], number of the front */
    int *member;    /* [2 N], in a generation the first front, later the survivors */
    int n_leader;   /* number of members of the first front */
    /* The minimum and the range of each objective on the first front. */
    double least[HF_FRONT_OBJECTIVES_MAX], range[HF_FRONT_OBJECTIVES_MAX];
} front_breeder;

static hf_status create_breeder(const hf_optimize_settings *s, const hf_model *m, void **state)
{
    front_breeder g = {.breeding = {.settings = s, .model = m},
                       .both = {.n = 2 * s->population, .n_objective = s->n_front}},
                  *itself;
    size_t n = (size_t)s->population;
    /* The struct itself comes first: its address is then that of the block, and free(state) frees everything. */
    HF_TRY(HF_ARENA_ARRAYS(state, HF_ARRAY(itself, 1), HF_PARETO_ARRAYS(g.both),
                           HF_ARRAY(g.breeding.draw, n * (size_t)m->n_variable_group), HF_ARRAY(g.rank, 2 * n),
                           HF_ARRAY(g.member, 2 * n)));
    *itself = g;
    return HF_OK;
}

/* ---- origins of children ---- */

/* Copies the objectives and violations of a generation into `both`, from index `at` on. */
static void take_values(front_breeder *g, const hf_population *p, int at)
{
    for (int i = 0; i < p->n_individual; i++)
        hf_pareto_set(&g->both, at + i, p->result[i].objective, hf_population_violation(&p->result[i]));
}

/* Finds the first front of the present generation, and the range of each objective on it. */
static void begin_front(void *state, const hf_population *now)
{
    front_breeder *g = state;
    hf_pareto present = g->both;
    present.n = now->n_individual;
    take_values(g, now, 0);
    hf_pareto_rank(&present, g->rank);
    g->n_leader = 0;
    for (int i = 0; i < now->n_individual; i++)
        if (g->rank[i] == 0) g->member[g->n_leader++] = i;
    for (int j = 0; j < g->both.n_objective; j++) {
        double low = INFINITY, high = -INFINITY;
        for (int k = 0; k < g->n_leader; k++) {
            double value = hf_pareto_value(&g->both, g->member[k])[j];
            low = fmin(low, value);
            high = fmax(high, value);
        }
        g->least[j] = low;
        g->range[j] = high > low ? high - low : 1;
    }
}

/* ---- weights ---- */

typedef struct {
    double of[HF_FRONT_OBJECTIVES_MAX]; /* weight of each objective; their sum is 1 */
    bool by_sum;                        /* true: weigh the sum of the objectives; false: weigh their maximum */
} weights;

/* Draws weights with the sum 1, all of which are equally likely. */
static weights draw_weights(int n_objective, hf_random *random)
{
    weights w = {.by_sum = hf_random_uniform(random) < BY_SUM};
    double a = hf_random_uniform(random), b = n_objective > 2 ? hf_random_uniform(random) : 1;
    w.of[0] = fmin(a, b);
    w.of[1] = fmax(a, b) - w.of[0];
    w.of[2] = 1 - fmax(a, b);
    return w;
}

/* Returns true if individual a is better than b by these weights. Infeasible individuals come last, by their
 * violation. */
static bool is_better_by(const front_breeder *g, const weights *w, int a, int b)
{
    double value[2];
    const int which[2] = {a, b};
    if (g->both.violation[a] > 0 || g->both.violation[b] > 0) return g->both.violation[a] < g->both.violation[b];
    for (int k = 0; k < 2; k++) {
        const double *objective = hf_pareto_value(&g->both, which[k]);
        double largest = 0, sum = 0;
        for (int j = 0; j < g->both.n_objective; j++) {
            double part = w->of[j] * (objective[j] - g->least[j]) / g->range[j];
            largest = fmax(largest, part);
            sum += part;
        }
        value[k] = w->by_sum ? sum : largest + SUM_SHARE * sum;
    }
    return value[0] < value[1];
}

/* ---- a child ---- */

/* Returns a random number from 0 to n - 1. */
static int pick(int n, hf_random *random)
{
    return (int)(hf_random_uniform(random) * n);
}

/* Makes a child with random numbers of its own stream. A child that equals the individual from which it began is not
 * evaluated, and does not survive beside that individual. */
static void propose_child(void *state, const hf_population *now, hf_population *next, int i)
{
    const front_breeder *g = state;
    const hf_optimize_settings *s = g->breeding.settings;
    size_t n = (size_t)now->n_variable;
    hf_random random = hf_random_stream(s->seed, now->generation + 1, i);
    weights w = draw_weights(g->both.n_objective, &random);
    int leader = g->member[pick(g->n_leader, &random)];
    for (int k = 0; k < g->n_leader; k++)
        if (is_better_by(g, &w, g->member[k], leader)) leader = g->member[k];
    int a = pick(now->n_individual, &random), b = pick(now->n_individual, &random);
    int to = is_better_by(g, &w, a, b) ? a : b, from = a + b - to;
    bool approaches = hf_random_uniform(&random) < BY_APPROACH;
    if (approaches) to = a, from = leader;
    double *child = next->design + (size_t)i * n;
    memcpy(child, now->design + (size_t)leader * n, n * sizeof *child);
    if (hf_random_uniform(&random) < s->crossover_high && to != from)
        hf_breeding_move_along(&g->breeding, now, &crossover, now->design + (size_t)from * n,
                               now->design + (size_t)to * n, i, child, &random);
    double rate = RATE * s->mutation_high;
    hf_breeding_mutate(&g->breeding, now, rate, SINGLES * rate, i, child, &random);
    hf_breeding_finish(&g->breeding, now, next, i, leader, s->crossover_high, rate, leader, to);
}

/* ---- survival ---- */

/* Fills member [N] with the survivors of both generations, front after front. */
static void choose_survivors(front_breeder *g, const hf_population *now)
{
    int n = now->n_individual, n_front = hf_pareto_rank(&g->both, g->rank), n_kept = 0;
    for (int i = 0; i < n; i++)
        if (!now->pending[i]) g->rank[n + i] = n_front; /* a copy of its origin comes last */
    for (int front = 0; n_kept < n; front++) {
        int n_member = 0, *member = g->member + n_kept;
        for (int i = 0; i < 2 * n; i++)
            if (g->rank[i] == front) member[n_member++] = i;
        hf_pareto_keep(&g->both, n_member, member, n - n_kept);
        n_kept = n_kept + n_member < n ? n_kept + n_member : n;
    }
}

/* A child that survives keeps its index. Surviving individuals of the previous generation take the indices of the other
 * children, in order. */
static void survive_front(void *state, const hf_population *before, hf_population *now)
{
    front_breeder *g = state;
    int n = now->n_individual, place = 0;
    take_values(g, before, 0);
    take_values(g, now, n);
    choose_survivors(g, now);
    int *lives = g->rank; /* the ranks are no longer needed */
    memset(lives, 0, 2 * (size_t)n * sizeof *lives);
    for (int k = 0; k < n; k++)
        lives[g->member[k]] = 1;
    for (int i = 0; i < n; i++) {
        if (!lives[i]) continue;
        while (lives[n + place])
            place++;
        hf_population_take_over(before, i, now, place++);
    }
}

const hf_optimiser_kind hf_optimiser_nsga = {create_breeder, hf_breeding_first, begin_front,
                                             propose_child,  survive_front,     free};
