/* Implements the adaptive real-coded genetic algorithm of Eqs. 11 to 13, in two variations.
 *
 *     generation -> fitness -> two parents by roulette -> crossover -> mutation -> child, clamped to the bounds
 *     individuals and evaluated children -> survivors -> next generation
 *
 * Both variations select parents by roulette with the fitness psi_worst - psi. Both have the multi-scale mutation of
 * the breeder GA (Muehlenbein & Schlierkamp-Voosen 1993), which changes chains of boundary cables
 * (model->variable_group) and single cables. Their rates are those of Srinivas & Patnaik (1994) for minimisation.
 *
 * Variation `difference`: a crossover moves an elite, or the mean of the best individuals, along the difference of two
 * parents, as in differential evolution (Storn & Price 1997). A child replaces the individual of the same index unless
 * the child is worse (hf_population_keep_better).
 *
 * Variation `chain`: a crossover is an intermediate recombination. The children replace the whole generation except the
 * elites.
 *
 * Contents: state - adaptive rates - selection - variation - the next generation */
#include <hifdm/optimiser.h>

#include "base/arena.h"
#include "search/breeding.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The crossover of the variation `difference`. Its constants were measured on the nets of METHOD section 7, which also
 * lists the results of other constants. */
static const hf_breeding_move crossover = {.step_max = 2.0, .share_octaves = 2.3, .by_chain = 0.6};
#define SINGLES 10.0 /* single genes mutate this many times as often as in the variation `chain` */
#define LEADERS 3    /* individuals whose mean is the centre of the population */
#define CENTRED 0.7  /* probability that a crossover moves the centre, instead of an elite */
#define SHIFTED 0.05 /* probability that a mutation moves all genes by one step */
/* Probability that a crossover moves all genes while limits bind. At several limits, a design often becomes better only
 * if all values at the limits change together. */
#define MOVED_AT_LIMITS 0.5
/* Intermediate recombination draws one number per chain, which reaches this far beyond both parents. So recombination
 * alone does not shrink the spread of the population. The proposed designs depend on this constant. The test
 * test_optimiser_ga passes with 0 and with 0.75. */
#define RECOMBINATION_REACH 0.25
/* Even the worst individual has about this part of the fitness of the best one. A test fails with 0.0133 and with
 * 0.03. */
#define FITNESS_FLOOR 0.02

/* ---- state ---- */

typedef struct {
    hf_breeding breeding;
    /* Shared by the children of a generation; `begin` computes it before the first child. */
    double *fitness; /* [n_individual] */
    double total_fitness, best_merit, mean_merit;
    int *elite; /* [n_listed], indices of the best individuals, best first */
    int n_listed;
    double *centre; /* [n_variable], mean of the best individuals */
    hf_breeding_move move;
    unsigned char *taken; /* [n_individual], scratch */
} breeder;

static hf_status create(const hf_optimize_settings *s, const hf_model *m, void **state)
{
    breeder g = {.breeding = {.settings = s, .model = m}, .move = crossover}, *itself;
    size_t n = (size_t)s->population;
    g.n_listed = s->elites > LEADERS ? s->elites : LEADERS;
    if (g.n_listed > s->population) g.n_listed = s->population;
    /* The struct itself comes first: its address is then that of the block, and free(state) frees everything. */
    HF_TRY(HF_ARENA_ARRAYS(state, HF_ARRAY(itself, 1), HF_ARRAY(g.breeding.draw, n * (size_t)m->n_variable_group),
                           HF_ARRAY(g.fitness, n), HF_ARRAY(g.taken, n), HF_ARRAY(g.elite, g.n_listed),
                           HF_ARRAY(g.centre, m->n_variable)));
    *itself = g;
    return HF_OK;
}

/* ---- adaptive rates ---- */

/* Returns the rate of crossover or mutation between `low` and `high` (M10), after Srinivas & Patnaik (1994) for
 * minimisation. `merit` is that of the better parent: the better it is, the less the parents are disturbed. */
static double adaptive(const breeder *g, double high, double low, double merit)
{
    double spread = g->mean_merit - g->best_merit;
    if (isinf(g->mean_merit)) return low;
    if (!(merit <= g->mean_merit) || !(spread > 0)) return high;
    return high - (high - low) * (g->mean_merit - merit) / spread;
}

/* ---- selection ---- */

/* Returns what is minimised: the merit, or the violation while no design is feasible. An individual for which it is NaN
 * or INFINITY cannot be a parent. */
static double merit_of(const hf_population *p, int i)
{
    return p->best >= 0 ? p->result[i].merit : hf_population_violation(&p->result[i]);
}

/* Sets the fitness of each individual, and the merits on which the adaptive rates depend. */
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
    g->mean_merit = n > 1 ? sum / n : n == 1 ? INFINITY : (double)NAN; /* a single parent gets low rates */
}

/* Returns a random individual, with a probability in proportion to its fitness. */
static int spin_roulette(const breeder *g, hf_random *random)
{
    double left = hf_random_uniform(random) * g->total_fitness;
    int last = 0;
    for (int i = 0; i < g->breeding.settings->population; i++) {
        if (!(g->fitness[i] > 0)) continue;
        last = i;
        left -= g->fitness[i];
        if (left < 0) break;
    }
    return last;
}

/* ---- variation ---- */

/* Makes child [n_variable] = a + share (b - a) from designs a and b, with one random share per chain (`draw`). */
static void recombine(const breeder *g, const hf_population *p, const double *a, const double *b, double *draw,
                      double *child, hf_random *random)
{
    for (int j = 0; j < g->breeding.model->n_variable_group; j++)
        draw[j] = hf_random_uniform(random) * (1 + 2 * RECOMBINATION_REACH) - RECOMBINATION_REACH;
    for (int k = 0; k < p->n_variable; k++) {
        double share = draw[g->breeding.model->variable_group[k]];
        child[k] = hf_population_clamp(p, k, a[k] + share * (b[k] - a[k]));
    }
}

/* Makes child [n_variable] of individual i: the centre or an elite, moved along the difference from the worse of the
 * parents a and b to the better one. */
static void move_leader(const breeder *g, const hf_population *p, int a, int b, int i, double *child, hf_random *random)
{
    size_t n = (size_t)p->n_variable;
    int better = hf_population_is_better(p, a, b) ? a : b, worse = a + b - better;
    const double *to = p->design + (size_t)better * n, *from = p->design + (size_t)worse * n;
    int elite = g->elite[(int)(hf_random_uniform(random) * g->breeding.settings->elites)];
    bool is_centred = hf_random_uniform(random) < CENTRED;
    memcpy(child, is_centred ? g->centre : p->design + (size_t)elite * n, n * sizeof *child);
    hf_breeding_move_along(&g->breeding, p, &g->move, from, to, i, child, random);
}

/* Makes one child with random numbers of its own stream. */
static void breed(const breeder *g, const hf_population *now, hf_population *next, int i)
{
    const hf_optimize_settings *s = g->breeding.settings;
    bool by_chain = s->variation == HF_VARIATION_CHAIN;
    size_t n = (size_t)now->n_variable;
    hf_random random = hf_random_stream(s->seed, now->generation + 1, i);
    int a = spin_roulette(g, &random);
    int b = spin_roulette(g, &random);
    /* The child without crossover is a copy of this individual. In the variation `difference`, it is the best
     * individual instead of an infeasible one, because the best one is nearest to the limits. */
    int itself = by_chain ? a : now->result[i].status == HF_OK ? i : g->elite[0];
    const double *mother = now->design + (size_t)a * n, *father = now->design + (size_t)b * n;
    const double *same = now->design + (size_t)itself * n;
    double *child = next->design + (size_t)i * n;
    double merit = fmin(merit_of(now, a), merit_of(now, b)); /* fmin ignores the NaN of an infeasible parent */
    double pc = adaptive(g, s->crossover_high, s->crossover_low, merit);
    double pm = adaptive(g, s->mutation_high, s->mutation_low, merit);
    if (hf_random_uniform(&random) >= pc || (!by_chain && a == b))
        memcpy(child, same, n * sizeof *child);
    else if (by_chain)
        recombine(g, now, mother, father, hf_breeding_draws(&g->breeding, i), child, &random);
    else
        move_leader(g, now, a, b, i, child, &random);
    if (!by_chain) hf_breeding_shift(now, SHIFTED, child, &random);
    hf_breeding_mutate(&g->breeding, now, pm, by_chain ? pm : SINGLES * pm, i, child, &random);
    hf_breeding_finish(&g->breeding, now, next, i, itself, pc, pm, a, b);
}

/* ---- the next generation ---- */

/* Lists the best individuals by repeated selection; there are few elites. */
static void list_elites(const breeder *g, const hf_population *p)
{
    memset(g->taken, 0, (size_t)p->n_individual);
    for (int e = 0; e < g->n_listed; e++) {
        int best = -1;
        for (int i = 0; i < p->n_individual; i++)
            if (!g->taken[i] && (best < 0 || hf_population_is_better(p, i, best))) best = i;
        g->taken[best] = 1;
        g->elite[e] = best;
    }
}

/* Computes the mean of the best individuals that can be parents, or copies the best one if there are none. */
static void find_centre(const breeder *g, const hf_population *p)
{
    size_t n = (size_t)p->n_variable;
    int leaders = 0;
    while (leaders < LEADERS && leaders < g->n_listed && isfinite(merit_of(p, g->elite[leaders])))
        leaders++;
    if (leaders == 0) leaders = 1;
    memset(g->centre, 0, n * sizeof *g->centre);
    for (int e = 0; e < leaders; e++)
        for (size_t k = 0; k < n; k++)
            g->centre[k] += p->design[(size_t)g->elite[e] * n + k] / leaders;
}

/* Copies elite e to individual e of the next generation. */
static void keep_elite(const breeder *g, const hf_population *now, hf_population *next, int e)
{
    hf_population_take_over(now, g->elite[e], next, e);
    next->crossover_rate[e] = next->mutation_rate[e] = 0;
    next->parent[2 * e + 1] = g->elite[e];
    next->pending[e] = 0;
}

static void begin(void *state, const hf_population *now)
{
    breeder *g = state;
    set_fitness(g, now);
    list_elites(g, now);
    if (g->breeding.settings->variation == HF_VARIATION_CHAIN) return;
    find_centre(g, now);
    g->move.by_all = hf_population_meets_limits(now) ? 0 : MOVED_AT_LIMITS;
}

static void propose(void *state, const hf_population *now, hf_population *next, int i)
{
    const breeder *g = state;
    if (g->breeding.settings->variation == HF_VARIATION_CHAIN && i < g->breeding.settings->elites)
        keep_elite(g, now, next, i);
    else
        breed(g, now, next, i);
}

/* In the variation `difference`, a child replaces an individual unless the child is worse. */
static void survive(void *state, const hf_population *before, hf_population *now)
{
    const breeder *g = state;
    if (g->breeding.settings->variation == HF_VARIATION_DIFFERENCE) hf_population_keep_better(before, now);
}

const hf_optimiser_kind hf_optimiser_ga = {create, hf_breeding_first, begin, propose, survive, free};
