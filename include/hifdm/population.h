/* population - the designs of one generation and their results.
 * Stability: stable.
 *
 * An optimiser (optimiser.h) proposes the designs, a batch evaluates them, and a store saves them. The functions of
 * this header rank the results. The optimiser alone determines how the next generation is made. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/model.h>
#include <hifdm/result.h>
#include <hifdm/settings.h>

#include <stdbool.h>

HF_API_BEGIN

/* These constants are the reasons why the genetic algorithm ended (optimize.stagnation_generations,
 * optimize.generations). */
typedef enum {
    HF_POPULATION_RUNNING,       /* the algorithm has not ended */
    HF_POPULATION_STAGNATION,    /* the best merit no longer decreases */
    HF_POPULATION_GENERATIONS,   /* the maximum number of generations has been evaluated */
    HF_POPULATION_ALL_INFEASIBLE /* the algorithm ended without a feasible individual */
} hf_population_stop;
extern const char *const hf_population_stop_word[4]; /* "running", "stagnation", "generations", "all_infeasible" */

/* Contains one generation and statistics of all generations so far. */
typedef struct {
    int n_variable, n_individual; /* number of design variables and of individuals */
    int n_objective;              /* number of rows of optimize.front; 0: there are none */
    bool has_rows;  /* true: design variables of optimize.variables, each in its own unit; false: pretensions in N */
    int generation; /* index of the present generation, counted from 0 */
    int generation_limit;  /* maximum number of generations */
    double *initial;       /* [n_variable] initial design, the values after form-finding (tensions T of Eq. 13) */
    double *lower, *upper; /* [n_variable] bounds on the values of the design variables (T' of Eq. 13) */
    double *reach;         /* [n_variable] maximum distance of the designs of generation 0 from `initial` */

    /* The optimiser writes the following arrays. The batch writes the results of designs that are marked as pending. */
    double *design; /* [n_individual][n_variable] values of the design variables */
    /* [n_individual] results; a result is valid from the start if `pending` is 0 for its individual */
    hf_form_result *result;
    unsigned char *pending;                 /* [n_individual] 1: the design must be evaluated */
    double *crossover_rate, *mutation_rate; /* [n_individual] rates with which the trial was made; NaN: none */
    /* [n_individual][2] indices of the parents in the previous generation; -1: none. The pair (k, -1) means that
     * individual k of the previous generation was kept. */
    int *parent;
    bool is_moved; /* true: the journal must contain the designs, because hf_optimiser_repair has moved some of them */

    /* hf_optimiser_tell writes the following arrays. The arrays describe each proposed design, whether or not it
     * survived. */
    hf_status *trial_status; /* [n_individual] status of the proposed design */
    double *trial_psi_m;     /* [n_individual] psi of the proposed design */

    /* hf_population_rank writes the following members. */
    int best;                /* index of the best individual; -1: none is feasible */
    double *best_merit;      /* [generation_limit] hf_population_merit of the best individual; NaN: none is feasible */
    double *best_psi_m;      /* [generation_limit] psi of the best individual */
    double *least_violation; /* [generation_limit] minimum violation of the individuals */
    double mean_psi_m, worst_psi_m;             /* mean and maximum psi over the feasible individuals */
    int n_infeasible;                           /* number of infeasible individuals in this generation */
    long n_evaluation, n_evaluation_infeasible; /* number of designs evaluated so far, and number of infeasible ones */
    long n_evaluation_above_cap;                /* number of infeasible designs so far that have a shape */
    hf_population_stop stop_reason;             /* reason why the generations end after this one */

    void *block; /* owned memory behind the arrays */
} hf_population;

/* Creates a population whose designs are all zero. The function copies the initial design from the array initial
 * [n_variable]. For boundary pretensions, the bounds are `initial` minus and plus range_N, within [min_tension_N,
 * max_tension_N]. For other variables, the row of optimize.variables gives the bounds. Design variables with the same
 * leader have common bounds on their step because they change by the same step. The population `next` has its own
 * arrays for a second generation. The population `next` shares the other arrays and the memory block with `population`.
 * Returns HF_OK or HF_NO_MEMORY. Free `population` even if hf_population_create fails. Do not free `next`. */
hf_status hf_population_create(const hf_optimize_settings *settings, const hf_model *model, const double *initial,
                               hf_population *population, hf_population *next);
/* Frees the arrays of the population and the arrays of `next`. */
void hf_population_free(hf_population *population);

/* Copies the status and psi of each result to trial_status and trial_psi_m. */
void hf_population_note_trials(hf_population *population);

/* Replaces individual i with individual k of the previous generation. Copies the design and the result of individual k,
 * and records k as the parent. */
void hf_population_take_over(const hf_population *before, int k, hf_population *population, int i);

/* Restores individuals of the previous generation. The function restores an individual if the trial with the same index
 * is worse or was not evaluated. */
void hf_population_keep_better(const hf_population *before, hf_population *population);

/* Makes `next` the present generation. Exchanges the arrays of the two generations and increments
 * population->generation. */
void hf_population_advance(hf_population *population, hf_population *next);

/* Uses the results of this generation to set the best, mean and worst values, the counts and stop_reason. All results
 * of the generation must be available. */
void hf_population_rank(const hf_optimize_settings *settings, hf_population *population);

/* Returns the amount by which a result violates its constraints. For a feasible result, the function returns 0. For a
 * result without a shape, the function returns INFINITY. For all other results, the function returns
 * result->violation. */
double hf_population_violation(const hf_form_result *result);

/* Returns the minimised quantity of a feasible result. The minimised quantity is the merit or, for a Pareto front, the
 * first objective. */
double hf_population_merit(const hf_population *population, const hf_form_result *result);

/* Returns true if individual a is better than individual b. Feasible individuals are ordered by merit or, for a Pareto
 * front, by the objectives in turn. Feasible individuals come before infeasible individuals. Infeasible individuals are
 * ordered by violation (Deb 2000). If two individuals are equal, the individual with the lower index is better. */
bool hf_population_is_better(const hf_population *population, int a, int b);

/* Returns the best individual of a ranked population. If no individual is feasible, returns the individual with the
 * smallest violation. Returns -1 if no individual has a shape. */
int hf_population_nearest(const hf_population *population);

/* Returns true if all designs that were evaluated last are within the limits or have no shape. */
bool hf_population_meets_limits(const hf_population *population);

/* Returns the value within the bounds of design variable i_variable that is closest to value_N. */
static inline double hf_population_clamp(const hf_population *population, int i_variable, double value_N)
{
    double low = population->lower[i_variable], high = population->upper[i_variable];
    return value_N < low ? low : value_N > high ? high : value_N;
}

/* Updates the design variables in the array design [n_variable] that follow a leader. The function sets each following
 * variable to its value in `initial` plus the step of its leader, within the bounds of the variable. */
void hf_population_link(const hf_population *population, const hf_model *model, double *design);

HF_API_END
