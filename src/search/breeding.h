/* breeding - makes designs from other designs. Its operators are the first generation, crossover along the difference
 * of two designs, and mutations. The genetic algorithms of METHOD section 7 differ in how they select parents and
 * survivors.
 *
 * An operator changes whole chains of boundary cables, or single genes. Crossover and mutation do not make linked genes
 * follow their leaders. After them, the caller calls hf_population_link. */
#pragma once

#include "base/random.h"

#include <hifdm/population.h>

/* The state of an optimiser begins with it. */
typedef struct {
    const hf_optimize_settings *settings; /* borrowed, like the model */
    const hf_model *model;
    double *draw; /* [n_individual][n_variable_group] scratch of each child; threads make several children at a time */
} hf_breeding;

/* How a crossover moves a design along the difference of two others. */
typedef struct {
    double step_max;      /* the step is uniform between 0 and this many differences */
    double share_octaves; /* the share of chains or genes that move is log-uniform between 2^-share_octaves and 1 */
    double by_chain;      /* probability that whole chains move, instead of single genes */
    double by_all;        /* probability that all genes move */
} hf_breeding_move;

/* Returns the scratch of individual i, [n_variable_group]: one number for each chain. */
double *hf_breeding_draws(const hf_breeding *breeding, int i);

/* Writes the first generation: Eq. 13 around the initial design, with one random number per chain. Individual 0 is the
 * initial design itself, so the best individual is never worse than the initial design. `breeding` points to an
 * hf_breeding. This is `first` of hf_optimiser_kind. */
void hf_breeding_first(void *breeding, hf_population *population);

/* Moves child [n_variable] of individual i along the difference from design `from` to design `to`, both [n_variable]. A
 * random share of its chains or genes moves, by a random number of differences from 0 to step_max. */
void hf_breeding_move_along(const hf_breeding *breeding, const hf_population *population, const hf_breeding_move *move,
                            const double *from, const double *to, int i, double *child, hf_random *random);

/* Moves all genes of child [n_variable] by one step in parts of the widths of their bounds, with probability `rate`. */
void hf_breeding_shift(const hf_population *population, double rate, double *child, hf_random *random);

/* Mutates child [n_variable] of individual i. Each chain takes a step with probability `rate`. In addition, `single`
 * genes on average take a step of their own. */
void hf_breeding_mutate(const hf_breeding *breeding, const hf_population *population, double rate, double single, int i,
                        double *child, hf_random *random);

/* Completes child i of the next generation, which began as individual `origin`: linked genes follow their leaders. A
 * child that equals its origin needs no evaluation, because it has the result of the origin. Sets rates and parents. */
void hf_breeding_finish(const hf_breeding *breeding, const hf_population *now, hf_population *next, int i, int origin,
                        double crossover_rate, double mutation_rate, int mother, int father);
