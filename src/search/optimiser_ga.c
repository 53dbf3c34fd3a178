/* The adaptive real-coded genetic algorithm (Eqs. 11-13), in two variations.
 *
 * Both: roulette on psi_worst - psi; the multi-scale mutation of the breeder GA (Muehlenbein & Schlierkamp-Voosen
 * 1993), acting on the chains of boundary cables (model->gene_group) and on single cables; rates of Srinivas & Patnaik
 * (1994), minimising.
 * Difference: a crossover moves an elite along the difference of two parents, as differential evolution does (Storn &
 * Price 1997), and a child takes the place of an individual that is no better (hf_population_survive).
 * Chain: intermediate recombination; whole generations are replaced, but for the elites.
 * Contents: state - adaptive rates - selection - variation - the next generation */
#include <hifdm/optimiser.h>

#include "base/arena.h"
#include "search/breeding.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the variation `difference`; measured on the nets of METHOD section 7, which says what others give. */
static const hf_breeding_move crossover = {.step_max = 2.0, .share_octaves = 2.3, .by_chain = 0.6};
#define SINGLES 10.0 /* genes that mutate alone are so many times as frequent as in the variation `chain` */
/* Intermediate recombination, one draw per chain, reaches this far beyond the parents, so that the population's spread
 * does not shrink by recombination alone. The designs proposed depend on it; test_optimiser_ga passes with 0 and with
 * 0.75. */
#define RECOMBINATION_REACH 0.25
/* Even the worst individual keeps about this share of the best one's fitness. A test fails at 0.0133 and at 0.03. */
#define FITNESS_FLOOR 0.02

/* ---- state ---- */

typedef struct {
    const hf_optimize_settings *settings; /* borrowed, as the model */
    hf_breeding breeding;
    /* What the children of a generation share, made before the first of them: */
    double *fitness; /* [n_individual] */
    double total_fitness, best_merit, mean_merit;
    int *elite;           /* [elites] the best, in order */
    unsigned char *taken; /* [n_individual] scratch */
} breeder;

/* The struct itself comes first, so that its address is that of the block, and free(state) frees all. */
static breeder *lay_out(hf_arena *a, breeder *g)
{
    breeder *itself = hf_arena_take(a, 1, sizeof *itself);
    size_t n = (size_t)g->settings->population;
    g->breeding.draw = hf_arena_take(a, n * (size_t)g->breeding.model->n_gene_group, sizeof(double));
    g->fitness = hf_arena_take(a, n, sizeof(double));
    g->taken = hf_arena_take(a, n, 1);
    g->elite = hf_arena_take(a, (size_t)g->settings->elites, sizeof(int));
    return itself;
}

static hf_status create(const hf_optimize_settings *s, const hf_model *m, void **state)
{
    breeder g = {.settings = s, .breeding = {.model = m}};
    hf_arena arena = {0};
    breeder *itself;
    HF_TRY(HF_ARENA_MAKE(&arena, itself = lay_out(&arena, &g)));
    *itself = g;
    *state = itself;
    return HF_OK;
}

static void first(void *state, hf_population *p)
{
    const breeder *g = state;
    hf_breeding_first(&g->breeding, g->settings->seed, p);
}

/* ---- adaptive rates (Srinivas & Patnaik 1994, minimising): the better an individual, the less it is disturbed ---- */

static double adaptive(const breeder *g, double high, double low, double merit)
{
    double spread = g->mean_merit - g->best_merit;
    if (isinf(g->mean_merit)) return low;
    if (!(merit <= g->mean_merit) || !(spread > 0)) return high;
    return high - (high - low) * (g->mean_merit - merit) / spread;
}

/* ---- selection ---- */

/* What is to be least: psi, or while no design is feasible the violation. NaN or INFINITY: it is no parent. */
static double merit_of(const hf_population *p, int i)
{
    return p->best >= 0 ? p->result[i].merit : hf_population_violation(&p->result[i]);
}

static void set_fitness(breeder *g, const hf_population *p)
{
    double best = INFINITY, worst = -INFINITY, sum = 0;
    int n = 0;
    for (int i = 0; i < p->n_individual; i++) {
        double merit = merit_of(p, i);
        if (!isfinite(merit)) continue;
        best = fmin(best, merit);
        worst = fmax(worst, merit);
        sum += merit;
        n++;
    }
    for (int i = 0; i < p->n_individual; i++) {
        double merit = merit_of(p, i);
        g->fitness[i] = n == 0 ? 1 : !isfinite(merit) ? 0 : 1;
        if (isfinite(merit) && worst > best) g->fitness[i] = (worst - merit) / (worst - best) + FITNESS_FLOOR;
    }
    g->total_fitness = 0;
    for (int i = 0; i < p->n_individual; i++)
        g->total_fitness += g->fitness[i];
    g->best_merit = best;
    g->mean_merit = n > 1 ? sum / n : n == 1 ? INFINITY : (double)NAN; /* one alone is not to be lost */
}

static int spin_roulette(const breeder *g, hf_random *random)
{
    double left = hf_random_uniform(random) * g->total_fitness;
    int last = 0;
    for (int i = 0; i < g->settings->population; i++) {
        if (!(g->fitness[i] > 0)) continue;
        last = i;
        left -= g->fitness[i];
        if (left < 0) break;
    }
    return last;
}

/* ---- variation ---- */

static void recombine(const breeder *g, const hf_population *p, const double *a, const double *b, double *draw,
                      double *child, hf_random *random)
{
    for (int j = 0; j < g->breeding.model->n_gene_group; j++)
        draw[j] = hf_random_uniform(random) * (1 + 2 * RECOMBINATION_REACH) - RECOMBINATION_REACH;
    for (int k = 0; k < p->n_gene; k++) {
        double share = draw[g->breeding.model->gene_group[k]];
        child[k] = hf_population_clamp(p, k, a[k] + share * (b[k] - a[k]));
    }
}

/* An elite, moved by some part of the way from the worse of two parents to the better one, and beyond. */
static void move_elite(const breeder *g, const hf_population *p, int a, int b, int i, double *child, hf_random *random)
{
    size_t n = (size_t)p->n_gene;
    int better = hf_population_is_better(p, a, b) ? a : b, worse = a + b - better;
    const double *to = p->design_N + (size_t)better * n, *from = p->design_N + (size_t)worse * n;
    int leader = g->elite[(int)(hf_random_uniform(random) * g->settings->elites)];
    memcpy(child, p->design_N + (size_t)leader * n, n * sizeof *child);
    hf_breeding_move_along(&g->breeding, p, &crossover, from, to, i, child, random);
}

/* Make one child, all by random numbers of its own stream. A child equal to a design of the generation before needs no
 * evaluation: it takes that one's result. */
static void breed(const breeder *g, const hf_population *now, hf_population *next, int i)
{
    const hf_optimize_settings *s = g->settings;
    bool by_chain = s->variation == HF_VARIATION_CHAIN;
    size_t n = (size_t)now->n_gene;
    hf_random random = hf_random_stream(s->seed, now->generation + 1, i);
    int a = spin_roulette(g, &random);
    int b = spin_roulette(g, &random);
    /* What a child is that no crossover makes. From outside the limits the way in leads past the best. */
    int itself = by_chain ? a : now->result[i].status == HF_OK ? i : g->elite[0];
    const double *mother = now->design_N + (size_t)a * n, *father = now->design_N + (size_t)b * n;
    const double *same = now->design_N + (size_t)itself * n;
    double *child = next->design_N + (size_t)i * n;
    double merit = fmin(merit_of(now, a), merit_of(now, b)); /* fmin ignores the NaN of an infeasible parent */
    double pc = adaptive(g, s->crossover_high, s->crossover_low, merit);
    double pm = adaptive(g, s->mutation_high, s->mutation_low, merit);
    if (hf_random_uniform(&random) >= pc || (!by_chain && a == b))
        memcpy(child, same, n * sizeof *child);
    else if (by_chain)
        recombine(g, now, mother, father, hf_breeding_draws(&g->breeding, i), child, &random);
    else
        move_elite(g, now, a, b, i, child, &random);
    hf_breeding_mutate(&g->breeding, now, pm, by_chain ? pm : SINGLES * pm, i, child, &random);
    hf_population_link(now, g->breeding.model, child);
    next->pending[i] = memcmp(child, same, n * sizeof *child) != 0;
    next->result[i] = now->result[itself];
    next->crossover_rate[i] = pc;
    next->mutation_rate[i] = pm;
    next->parent[2 * i] = a;
    next->parent[2 * i + 1] = b;
}

/* ---- the next generation ---- */

/* The best individuals, by repeated selection (elites are few). */
static void list_elites(const breeder *g, const hf_population *p)
{
    memset(g->taken, 0, (size_t)p->n_individual);
    for (int e = 0; e < g->settings->elites; e++) {
        int best = -1;
        for (int i = 0; i < p->n_individual; i++)
            if (!g->taken[i] && (best < 0 || hf_population_is_better(p, i, best))) best = i;
        g->taken[best] = 1;
        g->elite[e] = best;
    }
}

/* The elite e lives on, in place e. */
static void keep_elite(const breeder *g, const hf_population *now, hf_population *next, int e)
{
    size_t n = (size_t)now->n_gene;
    int i = g->elite[e];
    memcpy(next->design_N + (size_t)e * n, now->design_N + (size_t)i * n, n * sizeof(double));
    next->result[e] = now->result[i];
    next->crossover_rate[e] = next->mutation_rate[e] = 0;
    next->parent[2 * e] = next->parent[2 * e + 1] = i;
    next->pending[e] = 0;
}

static void begin(void *state, const hf_population *now)
{
    breeder *g = state;
    set_fitness(g, now);
    list_elites(g, now);
}

static void propose(void *state, const hf_population *now, hf_population *next, int i)
{
    const breeder *g = state;
    if (g->settings->variation == HF_VARIATION_CHAIN && i < g->settings->elites)
        keep_elite(g, now, next, i);
    else
        breed(g, now, next, i);
}

/* In the variation `difference` an individual gives way to a child that is not worse. */
static void survive(void *state, const hf_population *before, hf_population *now)
{
    const breeder *g = state;
    if (g->settings->variation == HF_VARIATION_DIFFERENCE) hf_population_keep_better(before, now);
}

const hf_optimiser_kind hf_optimiser_ga = {create, first, begin, propose, survive, free};
