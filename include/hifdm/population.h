/* population - the designs of one generation and their results.
 * Stability: stable.
 *
 * An optimiser proposes the designs, a batch evaluates them and a store keeps them. How the next generation is made is
 * left to the optimiser (optimiser.h). */
#ifndef HIFDM_POPULATION_H
#define HIFDM_POPULATION_H

#include <hifdm/api.h>
#include <hifdm/model.h>
#include <hifdm/result.h>
#include <hifdm/settings.h>

#include <stdbool.h>

HF_API_BEGIN

typedef enum {
    HF_POPULATION_RUNNING,
    HF_POPULATION_STAGNATION,
    HF_POPULATION_GENERATIONS,
    HF_POPULATION_ALL_INFEASIBLE
} hf_population_stop;
extern const char *const hf_population_stop_word[4]; /* "running", "stagnation", "generations", "all_infeasible" */

typedef struct {
    int n_gene, n_individual;
    int n_objective;           /* of optimize.objectives; 0: there are none */
    bool has_rows;             /* the genes are those of optimize.variables, in the unit of each; else pretensions */
    int generation;            /* number of the present generation, from 0 */
    int generation_limit;      /* the largest number of generations */
    double *base_N;            /* [n_gene] pretensions T after form-finding */
    double *lower_N, *upper_N; /* [n_gene] bounds on the pretensions T' of a design */
    double *reach;             /* [n_gene] how far the first designs spread from the base */

    /* Written by the optimiser; the results of pending designs by the batch. */
    double *design_N;                       /* [n_individual][n_gene] boundary pretensions T' */
    hf_form_result *result;                 /* [n_individual]; valid from the start where pending is 0 */
    unsigned char *pending;                 /* [n_individual] 1: must be evaluated */
    double *crossover_rate, *mutation_rate; /* [n_individual] rates of the trial; NaN where there are none */
    int *parent;                            /* [n_individual][2] in the generation before; -1 where there are none;
                                               k, -1: individual k of the generation before, which was kept */

    /* Written by hf_optimiser_tell: what the evaluation of the proposed design gave, kept or not. */
    hf_status *trial_status; /* [n_individual] */
    double *trial_psi_m;     /* [n_individual] */

    /* Written by hf_population_rank. */
    int best;                                   /* index; -1 while no design is feasible */
    double *best_merit;                         /* [generation_limit] hf_population_merit of the best, or NaN */
    double *best_psi_m;                         /* [generation_limit] psi of these; the same without goals */
    double *least_violation;                    /* [generation_limit] of each generation */
    double mean_psi_m, worst_psi_m;             /* of the feasible individuals */
    int n_infeasible;                           /* in this generation */
    long n_evaluation, n_evaluation_infeasible; /* in all generations so far */
    long n_evaluation_above_cap;                /* of the infeasible ones: those that have a shape */
    hf_population_stop stop_reason;

    void *block;
} hf_population;

/* Make a population whose designs are all zero. The bounds are T -+ range_N within [min, max]_tension_N; genes with the
 * same leader share the step from T, and the bounds on that step. `next` has its own arrays for a second generation,
 * and shares the other arrays and the block with `population`. Returns HF_OK or HF_NO_MEMORY; free `population`, and
 * not `next`, in either case. */
hf_status hf_population_create(const hf_optimize_settings *settings, const hf_model *model, const double *base_N,
                               hf_population *population, hf_population *next);
void hf_population_free(hf_population *population);

/* Write the trials from the results as they were evaluated. */
void hf_population_note_trials(hf_population *population);

/* Let individual k of the generation before stand in place of individual i. */
void hf_population_take_over(const hf_population *before, int k, hf_population *population, int i);

/* Let each individual of the generation before stand in its place where the trial there is worse, or was not
 * evaluated. */
void hf_population_keep_better(const hf_population *before, hf_population *population);

/* Exchange the arrays of the two generations and count the generation: `next` becomes the present one. */
void hf_population_advance(hf_population *population, hf_population *next);

/* Set best, mean, worst, counts and stop_reason from the results of this generation, which must be complete. */
void hf_population_rank(const hf_optimize_settings *settings, hf_population *population);

/* How far a result is beyond its limits: 0 when it is feasible, INFINITY without a shape, else its violation. */
double hf_population_violation(const hf_form_result *result);

/* What is to be least of a feasible result: its merit, or the first of its objectives. */
double hf_population_merit(const hf_population *population, const hf_form_result *result);

/* Is individual a better than b? Of feasible ones by merit, or by their objectives in turn, of infeasible ones, which
 * come last, by violation; of equals the lower index comes first. */
bool hf_population_is_better(const hf_population *population, int a, int b);

/* The value of the gene within its bounds that is nearest to value_N. */
static inline double hf_population_clamp(const hf_population *population, int i_gene, double value_N)
{
    double low = population->lower_N[i_gene], high = population->upper_N[i_gene];
    return value_N < low ? low : value_N > high ? high : value_N;
}

/* Change the genes of design_N [n_gene] that follow a leader: each takes the leader's step from T, within its own
 * bounds. */
void hf_population_link(const hf_population *population, const hf_model *model, double *design_N);

HF_API_END
#endif
