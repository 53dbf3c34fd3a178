/* population - the designs of one generation and their results: what an optimiser proposes, a batch evaluates and a
 * store keeps. It knows nothing of the way in which the next generation is made.
 * Stability: stable. */
#ifndef HIFDM_POPULATION_H
#define HIFDM_POPULATION_H

#include <hifdm/model.h>
#include <hifdm/result.h>
#include <hifdm/settings.h>

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    HF_POPULATION_RUNNING,
    HF_POPULATION_STAGNATION,
    HF_POPULATION_GENERATIONS,
    HF_POPULATION_ALL_INFEASIBLE
} hf_population_stop;
extern const char *const hf_population_stop_word[4]; /* "running", "stagnation", "generations", "all_infeasible" */

typedef struct {
    int n_gene, n_individual;
    int generation;            /* of which all below is; from 0 */
    int generation_limit;      /* number of generations that there can be */
    double *base_N;            /* [n_gene] pretensions T after form-finding */
    double *lower_N, *upper_N; /* [n_gene] bounds on the pretensions T' of a design */

    /* As the optimiser has made the generation, with the results of the batch. */
    double *design_N;                       /* [n_individual][n_gene] boundary pretensions T' */
    hf_form_result *result;                 /* [n_individual]; known already where pending is 0 */
    unsigned char *pending;                 /* [n_individual] 1 = must be evaluated */
    double *crossover_rate, *mutation_rate; /* [n_individual] rates that made the design; NaN where there are none */
    int *parent;                            /* [n_individual][2] in the generation before; -1 where there are none */

    /* After hf_population_rank. */
    int best;                                   /* index; -1 while no design is feasible */
    double *best_psi_m;                         /* [generation_limit] best of each generation, NaN while none */
    double mean_psi_m, worst_psi_m;             /* of the feasible individuals */
    int n_infeasible;                           /* in this generation */
    long n_evaluation, n_evaluation_infeasible; /* in all generations so far */
    hf_population_stop stop_reason;

    void *block;
} hf_population;

/* All designs are zero at first. The bounds are T -+ range_N within [min, max]_tension_N; genes with the same leader
 * share the step from T, and the bounds on it. `next` has arrays of its own for a second generation, and shares the
 * others and the block. HF_OK or HF_NO_MEMORY. Free `population`, not `next`, in any case. */
hf_status hf_population_create(const hf_optimize_settings *settings, const hf_model *model, const double *base_N,
                               hf_population *population, hf_population *next);
void hf_population_free(hf_population *population);

/* `next` becomes the present generation, with the next number, and its arrays those of the one after. */
void hf_population_advance(hf_population *population, hf_population *next);

/* The results of this generation are there: best, mean, worst, counts, stop_reason. */
void hf_population_rank(const hf_optimize_settings *settings, hf_population *population);

/* Is individual a better than b? Infeasible ones come last, ties go to the lower index. */
bool hf_population_is_better(const hf_population *population, int a, int b);

/* The value within the bounds of a gene. */
static inline double hf_population_clamp(const hf_population *population, int i_gene, double value_N)
{
    double low = population->lower_N[i_gene], high = population->upper_N[i_gene];
    return value_N < low ? low : value_N > high ? high : value_N;
}

/* Give the genes of design_N [n_gene] that follow a leader its step, within their bounds. */
void hf_population_link(const hf_population *population, const hf_model *model, double *design_N);

#ifdef __cplusplus
}
#endif
#endif
