#include "search/breeding.h"

#include "base/elementary.h"

#include <math.h>

/* Mutation steps run from the whole range down to 2^-MUTATION_OCTAVES of it, all scales equally likely. The designs
 * proposed depend on it; test_optimiser_ga passes with 5 and with 48. */
#define MUTATION_OCTAVES 16

bool hf_breeding_leads(const hf_breeding *g, int k)
{
    const hf_model *m = g->model;
    return m->n_leader >= m->n_gene || !m->gene_leader || m->gene_leader[k] == k;
}

int hf_breeding_n_leader(const hf_breeding *g)
{
    const hf_model *m = g->model;
    return m->n_leader < m->n_gene && m->gene_leader ? m->n_leader : m->n_gene;
}

double *hf_breeding_draws(const hf_breeding *g, int i)
{
    return g->draw + (size_t)i * (size_t)g->model->n_gene_group;
}

void hf_breeding_first(const hf_breeding *g, uint64_t seed, hf_population *p)
{
    for (int i = 0; i < p->n_individual; i++) {
        double *design_N = p->design_N + (size_t)i * (size_t)p->n_gene;
        double *draw = hf_breeding_draws(g, i);
        hf_random random = hf_random_stream(seed, 0, i);
        for (int j = 0; j < g->model->n_gene_group; j++)
            draw[j] = i == 0 ? 0 : 2 * hf_random_uniform(&random) - 1;
        for (int k = 0; k < p->n_gene; k++) {
            double step = p->reach[k] * draw[g->model->gene_group[k]];
            design_N[k] = hf_population_clamp(p, k, p->base_N[k] + step);
        }
        hf_population_link(p, g->model, design_N);
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
    for (int j = 0; j < g->model->n_gene_group && by_chain; j++)
        draw[j] = hf_random_uniform(random);
    for (int k = 0; k < p->n_gene; k++) {
        double drawn = by_chain ? draw[g->model->gene_group[k]] : hf_random_uniform(random);
        if (drawn < share) child[k] = hf_population_clamp(p, k, child[k] + step * (to[k] - from[k]));
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
 * instead of 240 um). */
void hf_breeding_mutate(const hf_breeding *g, const hf_population *p, double rate, double single, int i, double *child,
                        hf_random *random)
{
    double *draw = hf_breeding_draws(g, i);
    single /= hf_breeding_n_leader(g);
    for (int j = 0; j < g->model->n_gene_group; j++)
        draw[j] = mutation_step(rate, random);
    for (int k = 0; k < p->n_gene; k++) {
        if (!hf_breeding_leads(g, k)) continue;
        double step = draw[g->model->gene_group[k]] + mutation_step(single, random);
        child[k] = hf_population_clamp(p, k, child[k] + step * (p->upper_N[k] - p->lower_N[k]));
    }
}
