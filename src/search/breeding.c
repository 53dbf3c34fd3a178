/* Implements the operators that make designs from other designs. breeding.h describes the interface.
 *
 *     first generation   initial design + reach x (one random number per chain)                       (Eq. 13)
 *     crossover          child + step x (to - from), for a random share of the chains or genes
 *     mutation           child + (step of the chain + step of the gene) x (upper bound - lower bound)
 *
 * Every gene that an operator changes is clamped to its bounds. */
#include "search/breeding.h"

#include "base/elementary.h"

#include <math.h>
#include <string.h>

/* Mutation steps are between 2^-MUTATION_OCTAVES and 1 times the width of the bounds, and their logarithm is uniformly
 * distributed. The proposed designs depend on this value. The test test_optimiser_ga passes with 5 and with 48. */
#define MUTATION_OCTAVES 16

double *hf_breeding_draws(const hf_breeding *g, int i)
{
    return g->draw + (size_t)i * (size_t)g->model->n_variable_group;
}

void hf_breeding_first(void *breeding, hf_population *p)
{
    const hf_breeding *g = breeding;
    for (int i = 0; i < p->n_individual; i++) {
        double *design = p->design + (size_t)i * (size_t)p->n_variable;
        double *draw = hf_breeding_draws(g, i);
        hf_random random = hf_random_stream(g->settings->seed, 0, i);
        for (int j = 0; j < g->model->n_variable_group; j++)
            draw[j] = i == 0 ? 0 : 2 * hf_random_uniform(&random) - 1;
        for (int k = 0; k < p->n_variable; k++) {
            double step = p->reach[k] * draw[g->model->variable_group[k]];
            design[k] = hf_population_clamp(p, k, p->initial[k] + step);
        }
        hf_population_link(p, g->model, design);
        p->pending[i] = 1;
        p->crossover_rate[i] = p->mutation_rate[i] = (double)NAN;
        p->parent[2 * i] = p->parent[2 * i + 1] = -1;
    }
}

void hf_breeding_move_along(const hf_breeding *g, const hf_population *p, const hf_breeding_move *move,
                            const double *from, const double *to, int i, double *child, hf_random *random)
{
    double *draw = hf_breeding_draws(g, i);
    double step = move->step_max * hf_random_uniform(random);
    double share = hf_power_of_two(-move->share_octaves * hf_random_uniform(random));
    bool by_chain = hf_random_uniform(random) < move->by_chain;
    if (move->by_all > 0 && hf_random_uniform(random) < move->by_all) share = 1;
    for (int j = 0; j < g->model->n_variable_group && by_chain; j++)
        draw[j] = hf_random_uniform(random);
    for (int k = 0; k < p->n_variable; k++) {
        double drawn = by_chain ? draw[g->model->variable_group[k]] : hf_random_uniform(random);
        if (drawn < share) child[k] = hf_population_clamp(p, k, child[k] + step * (to[k] - from[k]));
    }
}

/* Returns a step in parts of the width of the bounds. With probability `rate` the step has a random sign and size,
 * otherwise it is 0. */
static double mutation_step(double rate, hf_random *random)
{
    if (hf_random_uniform(random) >= rate) return 0;
    double sign = hf_random_uniform(random) < 0.5 ? -1 : 1;
    return sign * hf_power_of_two(-MUTATION_OCTAVES * hf_random_uniform(random));
}

void hf_breeding_shift(const hf_population *p, double rate, double *child, hf_random *random)
{
    double step = mutation_step(rate, random);
    for (int k = 0; k < p->n_variable && step != 0; k++)
        child[k] = hf_population_clamp(p, k, child[k] + step * (p->upper[k] - p->lower[k]));
}

/* The cables of a chain mutate together. Unequal changes drag the nodes along the chain, and psi rises steeply.
 * Independent steps of all genes therefore nearly always make psi worse. Measured: in 400 generations, they improve psi
 * by 1 um instead of 240 um. */
void hf_breeding_mutate(const hf_breeding *g, const hf_population *p, double rate, double single, int i, double *child,
                        hf_random *random)
{
    double *draw = hf_breeding_draws(g, i);
    single /= g->model->n_leader;
    for (int j = 0; j < g->model->n_variable_group; j++)
        draw[j] = mutation_step(rate, random);
    for (int k = 0; k < p->n_variable; k++) {
        if (g->model->variable_leader[k] != k) continue;
        double step = draw[g->model->variable_group[k]] + mutation_step(single, random);
        child[k] = hf_population_clamp(p, k, child[k] + step * (p->upper[k] - p->lower[k]));
    }
}

void hf_breeding_finish(const hf_breeding *g, const hf_population *now, hf_population *next, int i, int origin,
                        double crossover_rate, double mutation_rate, int mother, int father)
{
    size_t n = (size_t)now->n_variable;
    double *child = next->design + (size_t)i * n;
    hf_population_link(now, g->model, child);
    next->pending[i] = memcmp(child, now->design + (size_t)origin * n, n * sizeof *child) != 0;
    next->result[i] = now->result[origin];
    next->crossover_rate[i] = crossover_rate;
    next->mutation_rate[i] = mutation_rate;
    next->parent[2 * i] = mother;
    next->parent[2 * i + 1] = father;
}
