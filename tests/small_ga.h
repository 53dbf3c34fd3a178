/* small_ga - settings of a small genetic algorithm, for tests that need generations but no good search. Nothing in them
 * ends a run early, and only the range limits a design variable. */
#pragma once

#include <hifdm/optimiser.h>

static inline hf_optimize_settings small_ga(int n_individual, int n_generation)
{
    return (hf_optimize_settings){.population = n_individual,
                                  .generations = n_generation,
                                  .stagnation_generations = n_generation,
                                  .range_N = 1,
                                  .min_tension_N = -1e6,
                                  .max_tension_N = 1e6,
                                  .crossover_high = 0.9,
                                  .crossover_low = 0.5,
                                  .mutation_high = 0.3,
                                  .mutation_low = 0.1,
                                  .elites = 1};
}
