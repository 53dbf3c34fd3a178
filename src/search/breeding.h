/* breeding - how designs are made from designs: the first generation, moves along the difference of two, mutation. The
 * optimisers of METHOD section 7 differ in who the parents are and who lives on.
 *
 * Every change is one of whole chains of boundary cables, or of genes each for itself. Linked genes follow their leader
 * only after hf_population_link, with which the caller ends. */
#ifndef HIFDM_BREEDING_H
#define HIFDM_BREEDING_H

#include "base/random.h"

#include <hifdm/population.h>
#include <stdbool.h>

typedef struct {
    const hf_model *model; /* borrowed */
    double *draw;          /* [n_individual][n_gene_group] scratch of each child, as several are bred at a time */
} hf_breeding;

/* A design that moves by a part of the difference of two others. */
typedef struct {
    double step_max;      /* it moves by 0 to so many differences */
    double share_octaves; /* 2^-share_octaves of the chains, or genes, to all of them are moved; log-uniform */
    double by_chain;      /* so many of the moves are of whole chains, the others of each gene for itself */
} hf_breeding_move;

/* Does the gene follow no other gene? */
bool hf_breeding_leads(const hf_breeding *breeding, int i_gene);
int hf_breeding_n_leader(const hf_breeding *breeding);

/* A number for each chain of individual i. */
double *hf_breeding_draws(const hf_breeding *breeding, int i);

/* Eq. 13 around the base, with one random number per chain. Individual 0 is the base itself, so that the result is
 * never worse than the base. */
void hf_breeding_first(const hf_breeding *breeding, uint64_t seed, hf_population *population);

/* Move child [n_gene], of individual i, by some part of the way from one design to another, and beyond. */
void hf_breeding_move_along(const hf_breeding *breeding, const hf_population *population, const hf_breeding_move *move,
                            const double *from, const double *to, int i, double *child, hf_random *random);

/* Each chain takes a step with probability `rate`, and on average `single` genes take one alone. */
void hf_breeding_mutate(const hf_breeding *breeding, const hf_population *population, double rate, double single, int i,
                        double *child, hf_random *random);

#endif
