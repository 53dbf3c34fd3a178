/* optimiser - proposes the designs of a population generation by generation (ask/tell): no threads, files or printing.
 * Stability: stable.
 *
 *     hf_optimiser_create(...);               // generation 0 is proposed; its individual 0 is the base design
 *     hf_population *p = &optimiser.population;
 *     do {
 *         evaluate every individual with p->pending[i] != 0: design p->design_N + i*n_gene into p->result[i];
 *         hf_optimiser_tell(&optimiser);      // ranks; p->stop_reason says whether this was the last generation
 *     } while (hf_optimiser_next(&optimiser)); // proposes the next one
 *
 * hf_batch_next does the first and the last step of the loop with all threads, each of which proposes individuals and
 * evaluates them. A generation stays as it is while the next one is proposed: a copy of the struct hf_population, made
 * after hf_optimiser_tell, may be read until the hf_optimiser_next after that.
 *
 * A new optimiser needs a file src/search/optimiser_NAME.c, a row of HF_OPTIMISER_LIST and a word in settings.h. */
#ifndef HIFDM_OPTIMISER_H
#define HIFDM_OPTIMISER_H

#include <hifdm/api.h>
#include <hifdm/population.h>

HF_API_BEGIN

/* The functions of one optimiser. A store keeps only the population, and a resumed run proposes the generations again
 * whose results are in the journal. Therefore a proposal depends only on the settings, the model, the population after
 * hf_optimiser_tell (best_psi_m holds the earlier generations) and random numbers by (seed, generation, individual).
 * `state` holds constants, and scratch whose contents mean nothing between generations. */
typedef struct {
    /* Make the state. HF_OK or HF_NO_MEMORY. */
    hf_status (*create)(const hf_optimize_settings *settings, const hf_model *model, void **state);
    /* Propose generation 0: fill all arrays of the generation but the results. */
    void (*first)(void *state, hf_population *population);
    /* Prepare what all proposals of the generation after `now` need. */
    void (*begin)(void *state, const hf_population *now);
    /* Propose individual i of that generation in the arrays of `next`, with its result when it is not pending. Several
     * threads call this at once, each for other individuals, in any order. */
    void (*propose)(void *state, const hf_population *now, hf_population *next, int i);
    /* Choose, once `now` is evaluated, what stands in it of its own individuals and of those before. NULL: its own. */
    void (*survive)(void *state, const hf_population *before, hf_population *now);
    void (*free)(void *state); /* state may be NULL */
} hf_optimiser_kind;

typedef struct {
    hf_population population;
    hf_population next; /* internal: the arrays that kind->propose writes to */
    const hf_optimiser_kind *kind;
    const hf_optimize_settings *settings; /* borrowed */
    void *state;
    bool is_fresh; /* internal: evaluated since it was proposed, and not yet told */
} hf_optimiser;

/* Settings and model are borrowed until hf_optimiser_free. base_N: [n_gene] pretensions T after form-finding. With kind
 * NULL the population has its bounds, but no designs. Returns HF_OK or HF_NO_MEMORY; call hf_optimiser_free in either
 * case. */
hf_status hf_optimiser_create(const hf_optimiser_kind *kind, const hf_optimize_settings *settings,
                              const hf_model *model, const double *base_N, hf_optimiser *optimiser);

/* Take the results that the caller has written into population.result: choose the survivors, and rank them. */
void hf_optimiser_tell(hf_optimiser *optimiser);

/* Propose the next generation. Returns false, and does nothing, when stop_reason says that there is none. */
bool hf_optimiser_next(hf_optimiser *optimiser);

/* The same in steps, for several threads: after hf_optimiser_begin, which returns false when there is none,
 * hf_optimiser_propose for each individual, which may be evaluated at once: design and result are those of
 * optimiser->next. After hf_optimiser_end this is the present generation. */
bool hf_optimiser_begin(hf_optimiser *optimiser);
void hf_optimiser_propose(hf_optimiser *optimiser, int i);
void hf_optimiser_end(hf_optimiser *optimiser);

void hf_optimiser_free(hf_optimiser *optimiser);

/* ---- the methods of a case ---- */

/* How Levenberg-Marquardt ended. CONVERGED: no step within the limits promises a lower psi. STALLED: one does, but even
 * a short one does not keep the promise. MAX_ITERATIONS: neither yet. SETTLED: the last ten steps lowered the merit by
 * less than 1e-6 of it, and changed no goal (weight x value) by 1e-5 of the merit. TAKEN: it did not run, the design is
 * a point of a front. */
typedef enum {
    HF_POLISH_CONVERGED,
    HF_POLISH_STALLED,
    HF_POLISH_MAX_ITERATIONS,
    HF_POLISH_SETTLED,
    HF_POLISH_TAKEN
} hf_polish_stop;
extern const char *const hf_polish_stop_word[5]; /* "converged", "stalled", "max_iterations", "settled", "taken" */

/* One row for each hf_optimize_method: X(method, optimiser of its generations or `none`, ends_with_polish). */
#define HF_OPTIMISER_LIST(X) X(GA, ga, false) X(LM, none, true) X(GA_LM, ga, true)

typedef struct {
    const hf_optimiser_kind *kind; /* NULL: no generations */
    bool ends_with_polish;         /* the design of Levenberg-Marquardt is the result; else it is only reported */
} hf_optimiser_plan;

/* Of the settings' method; the generations of a front are those of hf_optimiser_nsga. */
hf_optimiser_plan hf_optimiser_plan_of(const hf_optimize_settings *settings);

#define HF_OPTIMISER_DECLARE(method, optimiser, ends_with_polish)                                                      \
    extern const hf_optimiser_kind hf_optimiser_##optimiser;
HF_OPTIMISER_LIST(HF_OPTIMISER_DECLARE)
extern const hf_optimiser_kind hf_optimiser_nsga; /* of optimize.objectives, in place of ga */
#undef HF_OPTIMISER_DECLARE

HF_API_END
#endif
