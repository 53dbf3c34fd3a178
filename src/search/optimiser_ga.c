/* The adaptive real-coded genetic algorithm (Eqs. 11-13).
 *
 * Selection: roulette on psi_worst - psi. Crossover and mutation: intermediate recombination and the multi-scale
 * mutation of the breeder GA (Muehlenbein & Schlierkamp-Voosen 1993), acting on the chains of boundary cables
 * (model->gene_group) and, rarely, on single cables. Rates: Srinivas & Patnaik (1994), minimising.
 * Contents: state - the first generation - adaptive rates - selection - variation - the next generation */
#include <hifdm/optimiser.h>

#include "base/arena.h"
#include "base/elementary.h"
#include "base/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Intermediate recombination, one draw per chain, reaches this far beyond the parents, so that the population's spread
 * does not shrink by recombination alone. The designs proposed depend on it; test_optimiser_ga passes with 0 and with
 * 0.75. */
#define RECOMBINATION_REACH 0.25
/* Mutation steps run from the whole range down to 2^-MUTATION_OCTAVES of it, all scales equally likely. The designs
 * proposed depend on it; test_optimiser_ga passes with 5 and with 48. */
#define MUTATION_OCTAVES 16
/* Even the worst individual keeps about this share of the best one's fitness. A test fails at 0.0133 and at 0.03. */
#define FITNESS_FLOOR 0.02

/* ---- state ---- */

typedef struct {
    const hf_optimize_settings *settings; /* borrowed, as the model */
    const hf_model *model;
    const int *gene_leader; /* of the model; NULL when no genes are linked */
    int n_leader;
    double *fitness, *group_draw; /* scratch: [n_individual], [n_gene_group] */
} breeder;

/* The struct itself comes first, so that its address is that of the block, and free(state) frees all. */
static breeder *lay_out(hf_arena *a, breeder *g)
{
    breeder *itself = hf_arena_take(a, 1, sizeof *itself);
    g->group_draw = hf_arena_take(a, (size_t)g->model->n_gene_group, sizeof(double));
    g->fitness = hf_arena_take(a, (size_t)g->settings->population, sizeof(double));
    return itself;
}

static hf_status create(const hf_optimize_settings *s, const hf_model *m, void **state)
{
    breeder g = {.settings = s, .model = m};
    hf_arena arena = {0};
    g.gene_leader = m->n_leader < m->n_gene ? m->gene_leader : NULL;
    g.n_leader = g.gene_leader ? m->n_leader : m->n_gene;
    breeder *itself;
    HF_TRY(HF_ARENA_MAKE(&arena, itself = lay_out(&arena, &g)));
    *itself = g;
    *state = itself;
    return HF_OK;
}

/* Does the gene follow no other gene? */
static bool leads(const breeder *g, int k)
{
    return !g->gene_leader || g->gene_leader[k] == k;
}

/* ---- the first generation ---- */

/* Eq. 13 around the base, with one random number per chain (see mutate). Individual 0 is the base itself, so that the
 * result is never worse than the base. */
static void first(void *state, hf_population *p)
{
    const breeder *g = state;
    const hf_optimize_settings *s = g->settings;
    for (int i = 0; i < p->n_individual; i++) {
        double *design_N = p->design_N + (size_t)i * (size_t)p->n_gene;
        hf_random random = hf_random_stream(s->seed, 0, i);
        for (int j = 0; j < g->model->n_gene_group; j++)
            g->group_draw[j] = i == 0 ? 0 : 2 * hf_random_uniform(&random) - 1;
        for (int k = 0; k < p->n_gene; k++) {
            double step = s->range_N * g->group_draw[g->model->gene_group[k]];
            design_N[k] = hf_population_clamp(p, k, p->base_N[k] + step);
        }
        hf_population_link(p, g->model, design_N);
        p->pending[i] = 1;
        p->crossover_rate[i] = p->mutation_rate[i] = (double)NAN;
        p->parent[2 * i] = p->parent[2 * i + 1] = -1;
    }
}

/* ---- adaptive rates (Srinivas & Patnaik 1994, minimising): the better an individual, the less it is disturbed ---- */

static double adaptive(const hf_population *p, double high, double low, double psi_m)
{
    double best = p->result[p->best].psi_m, spread = p->mean_psi_m - best;
    if (!(psi_m <= p->mean_psi_m) || !(spread > 0)) return high;
    return high - (high - low) * (p->mean_psi_m - psi_m) / spread;
}

/* ---- selection ---- */

static void set_fitness(const hf_population *p, double *fitness)
{
    double spread = p->best < 0 ? 0 : p->worst_psi_m - p->result[p->best].psi_m;
    for (int i = 0; i < p->n_individual; i++) {
        const hf_form_result *r = &p->result[i];
        if (p->best < 0)
            fitness[i] = 1;
        else if (r->status != HF_OK)
            fitness[i] = 0;
        else
            fitness[i] = spread > 0 ? (p->worst_psi_m - r->psi_m) / spread + FITNESS_FLOOR : 1;
    }
}

static int spin_roulette(const double *fitness, int n, hf_random *random)
{
    double total = 0;
    for (int i = 0; i < n; i++)
        total += fitness[i];
    double left = hf_random_uniform(random) * total;
    int last = 0;
    for (int i = 0; i < n; i++) {
        if (!(fitness[i] > 0)) continue;
        last = i;
        left -= fitness[i];
        if (left < 0) break;
    }
    return last;
}

/* ---- variation ---- */

static void recombine(const breeder *g, const hf_population *p, const double *a, const double *b, double *child,
                      hf_random *random)
{
    for (int j = 0; j < g->model->n_gene_group; j++)
        g->group_draw[j] = hf_random_uniform(random) * (1 + 2 * RECOMBINATION_REACH) - RECOMBINATION_REACH;
    for (int k = 0; k < p->n_gene; k++) {
        double share = g->group_draw[g->model->gene_group[k]];
        child[k] = hf_population_clamp(p, k, a[k] + share * (b[k] - a[k]));
    }
}

/* A step with a random sign and scale, relative to the range; 0 with probability 1 - rate. */
static double mutation_step(double rate, hf_random *random)
{
    if (hf_random_uniform(random) >= rate) return 0;
    double sign = hf_random_uniform(random) < 0.5 ? -1 : 1;
    return sign * hf_power_of_two(-MUTATION_OCTAVES * hf_random_uniform(random));
}

/* The cables of a chain mutate together. An unequal change drags the chain's nodes along it, which raises psi steeply,
 * so that independent steps of every gene nearly always make psi worse (measured: 400 generations then gain 1 um
 * instead of 240 um). Single genes mutate as well, on average `rate` of them per individual. */
static void mutate(const breeder *g, const hf_population *p, double rate, double *child, hf_random *random)
{
    double single = rate / g->n_leader;
    for (int j = 0; j < g->model->n_gene_group; j++)
        g->group_draw[j] = mutation_step(rate, random);
    for (int k = 0; k < p->n_gene; k++) {
        if (!leads(g, k)) continue;
        double step = g->group_draw[g->model->gene_group[k]] + mutation_step(single, random);
        child[k] = hf_population_clamp(p, k, child[k] + step * (p->upper_N[k] - p->lower_N[k]));
    }
}

/* Make one child of two parents, all by random numbers of its own stream. A child equal to its first parent needs no
 * evaluation: it takes that parent's result. */
static void breed(const breeder *g, const hf_population *now, hf_population *next, int i)
{
    const hf_optimize_settings *s = g->settings;
    size_t n = (size_t)now->n_gene;
    hf_random random = hf_random_stream(s->seed, now->generation + 1, i);
    int a = spin_roulette(g->fitness, now->n_individual, &random);
    int b = spin_roulette(g->fitness, now->n_individual, &random);
    const double *mother = now->design_N + (size_t)a * n, *father = now->design_N + (size_t)b * n;
    double *child = next->design_N + (size_t)i * n;
    double psi_m = fmin(now->result[a].psi_m, now->result[b].psi_m); /* fmin ignores the NaN of an infeasible parent */
    double pc = now->best < 0 ? s->crossover_high : adaptive(now, s->crossover_high, s->crossover_low, psi_m);
    double pm = now->best < 0 ? s->mutation_high : adaptive(now, s->mutation_high, s->mutation_low, psi_m);
    if (hf_random_uniform(&random) < pc)
        recombine(g, now, mother, father, child, &random);
    else
        memcpy(child, mother, n * sizeof *child);
    mutate(g, now, pm, child, &random);
    hf_population_link(now, g->model, child);
    next->pending[i] = memcmp(child, mother, n * sizeof *child) != 0;
    next->result[i] = now->result[a];
    next->crossover_rate[i] = pc;
    next->mutation_rate[i] = pm;
    next->parent[2 * i] = a;
    next->parent[2 * i + 1] = b;
}

/* ---- the next generation ---- */

/* The best individual that is not taken, by repeated selection (elites are few). */
static int next_elite(const hf_population *p, const unsigned char *taken)
{
    int best = -1;
    for (int i = 0; i < p->n_individual; i++)
        if (!taken[i] && (best < 0 || hf_population_is_better(p, i, best))) best = i;
    return best;
}

static void keep_elites(const breeder *g, const hf_population *now, hf_population *next)
{
    size_t n = (size_t)now->n_gene;
    unsigned char *taken = next->pending; /* what is pending is set by breed() */
    memset(taken, 0, (size_t)now->n_individual);
    for (int e = 0; e < g->settings->elites; e++) {
        int i = next_elite(now, taken);
        taken[i] = 1;
        memcpy(next->design_N + (size_t)e * n, now->design_N + (size_t)i * n, n * sizeof(double));
        next->result[e] = now->result[i];
        next->crossover_rate[e] = next->mutation_rate[e] = 0;
        next->parent[2 * e] = next->parent[2 * e + 1] = i;
    }
    memset(next->pending, 0, (size_t)now->n_individual);
}

static void breed_all(void *state, const hf_population *now, hf_population *next)
{
    const breeder *g = state;
    set_fitness(now, g->fitness);
    keep_elites(g, now, next);
    for (int i = g->settings->elites; i < now->n_individual; i++)
        breed(g, now, next, i);
}

const hf_optimiser_kind hf_optimiser_ga = {create, first, breed_all, free};
