/* ga - adaptive real-coded genetic algorithm, ask/tell: no threads, no files, no printing (Eqs. 11-13).
 *
 *     hf_ga_create(...);                     // individual 0 of generation 0 is the base design itself
 *     do {
 *         evaluate every individual with ga.pending[i] != 0: design ga.design_N + i*n_gene into ga.result[i];
 *         hf_ga_tell(&ga);                   // ranks; ga.stop_reason says whether this was the last generation
 *     } while (hf_ga_next(&ga));             // breeds the next one
 *
 * hf_batch_next does the first and the last step of the loop with all threads. A generation stays as it is while the
 * next one is bred: a copy of the struct, made after hf_ga_tell, may be read until the hf_ga_next after that.
 *
 * Selection: roulette on psi_worst - psi. Crossover and mutation: intermediate recombination and the multi-scale
 * mutation of the breeder GA (Muehlenbein & Schlierkamp-Voosen 1993), acting on the chains of boundary cables
 * (model->gene_group) and, rarely, on single cables. Rates: Srinivas & Patnaik (1994), minimising.
 * Every random number depends on (seed, generation, individual) only. */
#ifndef HIFDM_GA_H
#define HIFDM_GA_H

#include <hifdm/model.h>
#include <hifdm/result.h>
#include <hifdm/settings.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum { HF_GA_RUNNING, HF_GA_STAGNATION, HF_GA_GENERATIONS, HF_GA_ALL_INFEASIBLE } hf_ga_stop;
extern const char *const hf_ga_stop_word[4]; /* "running", "stagnation", "generations", "all_infeasible" */

typedef struct {
    const hf_optimize_settings *settings;       /* borrowed */
    int n_gene, n_individual, generation;       /* generation counts from 0 */
    double *lower_N, *upper_N;                  /* [n_gene] bounds on T' */
    double *design_N;                           /* [n_individual][n_gene] boundary pretensions T' of this generation */
    hf_form_result *result;                     /* [n_individual]; known already where pending is 0 */
    unsigned char *pending;                     /* [n_individual] 1 = must be evaluated */
    double *crossover_rate, *mutation_rate;     /* [n_individual] rates that bred the individual; NaN in generation 0 */
    int *parent;                                /* [n_individual][2] in the generation before; -1 in generation 0 */
    int best;                                   /* index after tell; -1 while nothing is feasible */
    double *best_psi_m;                         /* [settings->generations] best of each generation, NaN while none */
    double mean_psi_m, worst_psi_m;             /* of the feasible individuals, after tell */
    int n_infeasible;                           /* in this generation, after tell */
    long n_evaluation, n_evaluation_infeasible; /* so far */
    hf_ga_stop stop_reason;

    const int *gene_group;  /* borrowed from the model */
    const int *gene_leader; /* the same; NULL when no genes are linked */
    int n_group, n_leader;
    double *base_N; /* [n_gene] */
    /* of the generation that is being bred */
    double *next_design_N, *next_crossover_rate, *next_mutation_rate;
    hf_form_result *next_result;
    unsigned char *next_pending;
    int *next_parent;
    double *fitness, *group_draw; /* scratch */
    void *block;
} hf_ga;

/* model: borrowed for its genes, their groups and leaders. base_N: [n_gene] pretensions T after form-finding; bounds
 * are T -+ range_N within [min, max]_tension_N. Genes with the same leader share the step from T, and the bounds on it.
 * HF_OK or HF_NO_MEMORY. Free in any case. */
hf_status hf_ga_create(const hf_optimize_settings *settings, const hf_model *model, const double *base_N, hf_ga *ga);

/* Take the results of this generation in: best, mean, worst, stop_reason. */
void hf_ga_tell(hf_ga *ga);

/* Breed the next generation; 0 when stop_reason says that there is none. */
int hf_ga_next(hf_ga *ga);

void hf_ga_free(hf_ga *ga);

#ifdef __cplusplus
}
#endif
#endif
