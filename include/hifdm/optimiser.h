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
 * hf_batch_next does the first and the last step of the loop with all threads. A generation stays as it is while the
 * next one is proposed: a copy of the struct hf_population, made after hf_optimiser_tell, may be read until the
 * hf_optimiser_next after that.
 *
 * A new optimiser is one file src/search/optimiser_NAME.c, a row of HF_OPTIMISER_LIST and a word in settings.h. */
#ifndef HIFDM_OPTIMISER_H
#define HIFDM_OPTIMISER_H

#include <hifdm/population.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What makes one optimiser different from another. A store keeps the population and nothing else, and a run that goes
 * on calls `next` again for generations whose results the journal has. So what `next` proposes depends only on the
 * settings, the model, the population as it was told (best_psi_m has the past) and random numbers by (seed, generation,
 * individual); `state` holds constants, and scratch whose contents mean nothing between calls. */
typedef struct {
    hf_status (*create)(const hf_optimize_settings *settings, const hf_model *model, void **state); /* or NO_MEMORY */
    void (*first)(void *state, hf_population *population); /* propose generation 0: all but the results */
    /* Propose the generation after `now` in the arrays of `next`, with the results of those that are not pending. */
    void (*next)(void *state, const hf_population *now, hf_population *next);
    void (*free)(void *state); /* NULL, too */
} hf_optimiser_kind;

typedef struct {
    hf_population population;
    hf_population next; /* which `next` writes to; means nothing to others */
    const hf_optimiser_kind *kind;
    const hf_optimize_settings *settings; /* borrowed */
    void *state;
} hf_optimiser;

/* Settings and model are borrowed; base_N: [n_gene] pretensions T after form-finding. kind NULL: a population with
 * bounds, which nobody fills. HF_OK or HF_NO_MEMORY. Free in any case. */
hf_status hf_optimiser_create(const hf_optimiser_kind *kind, const hf_optimize_settings *settings,
                              const hf_model *model, const double *base_N, hf_optimiser *optimiser);

/* Take the results of this generation in. */
void hf_optimiser_tell(hf_optimiser *optimiser);

/* Propose the next generation; false when stop_reason says that there is none. */
bool hf_optimiser_next(hf_optimiser *optimiser);

void hf_optimiser_free(hf_optimiser *optimiser);

/* ---- the methods of a case ---- */

/* By hf_optimize_method: X(method, optimiser of its generations or `none`, is the design of Levenberg-Marquardt the
 * result, or only reported beside it?) */
#define HF_OPTIMISER_LIST(X) X(GA, ga, false) X(LM, none, true) X(GA_LM, ga, true)

typedef struct {
    const hf_optimiser_kind *kind; /* NULL: no generations */
    bool ends_with_polish;         /* Levenberg-Marquardt makes the result */
} hf_optimiser_plan;

hf_optimiser_plan hf_optimiser_plan_of(hf_optimize_method method);

#define HF_OPTIMISER_DECLARE(method, optimiser, ends_with_polish)                                                      \
    extern const hf_optimiser_kind hf_optimiser_##optimiser;
HF_OPTIMISER_LIST(HF_OPTIMISER_DECLARE)
#undef HF_OPTIMISER_DECLARE

#ifdef __cplusplus
}
#endif
#endif
