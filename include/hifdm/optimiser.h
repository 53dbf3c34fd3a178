/* optimiser - proposes the designs of a population, one generation at a time (ask and tell).
 * Stability: stable.
 *
 * An optimiser starts no threads, opens no files and prints nothing. Pipeline:
 *
 *     hf_optimiser_create(...);               // proposes generation 0; its individual 0 is the initial design
 *     hf_population *p = &optimiser.population;
 *     do {
 *         evaluate every individual with p->pending[i] != 0: design p->design + i*n_variable into p->result[i];
 *         hf_optimiser_tell(&optimiser);      // ranks; p->stop_reason says whether this was the last generation
 *     } while (hf_optimiser_next(&optimiser)); // proposes the next one
 *
 * hf_batch_next executes the first and the last step of this loop with all threads. Each thread proposes individuals
 * and evaluates them. A generation does not change while the optimiser proposes the next generation. A program may
 * therefore read a copy of the struct hf_population that the program makes after hf_optimiser_tell. The copy is valid
 * until the next call of hf_optimiser_next returns.
 *
 * To add an optimiser, write a file src/search/optimiser_NAME.c and add one row to HF_OPTIMISER_LIST. Also add one row
 * to HF_OPTIMIZE_METHODS in settings.h. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/evaluate.h>
#include <hifdm/population.h>

HF_API_BEGIN

/* Contains the functions of one optimiser. The functions of this header call the functions in this struct. A store
 * contains only the population, not the state of the optimiser. If the journal contains the results of a generation, a
 * resumed run proposes this generation again. A proposal must therefore depend only on the settings, the model, the
 * population after hf_optimiser_tell and random numbers. Each random number must depend only on the seed, the
 * generation and the individual. The members best_psi_m and best_merit of the population contain the values of earlier
 * generations. The argument `state` contains constants and scratch data. The scratch data have no meaning between
 * generations. */
typedef struct {
    /* Creates the state of the optimiser. Returns HF_OK or HF_NO_MEMORY. */
    hf_status (*create)(const hf_optimize_settings *settings, const hf_model *model, void **state);
    /* Proposes generation 0. Fills all arrays of the generation except the results. */
    void (*first)(void *state, hf_population *population);
    /* Prepares the data that all proposals of the generation after `now` share. */
    void (*begin)(void *state, const hf_population *now);
    /* Proposes individual i of the next generation in the arrays of `next`. If an individual needs no evaluation, the
     * function sets its result and sets its entry in `pending` to 0. Several threads call this function at the same
     * time, for different individuals and in any order. */
    void (*propose)(void *state, const hf_population *now, hf_population *next, int i);
    /* Selects the survivors after all individuals of `now` have been evaluated. The survivors come from `now` and
     * `before` and form the generation. If the pointer `survive` is NULL, all individuals of `now` survive. */
    void (*survive)(void *state, const hf_population *before, hf_population *now);
    void (*free)(void *state); /* frees the state, which may be NULL */
} hf_optimiser_kind;

/* Contains an optimiser and its present generation. */
typedef struct {
    hf_population population;      /* the present generation */
    hf_population next;            /* internal: the arrays of the next generation, to which kind->propose writes */
    const hf_optimiser_kind *kind; /* functions of the optimiser; NULL: the optimiser cannot propose designs */
    const hf_optimize_settings *settings; /* settings of the search; borrowed */
    void *state;                          /* state that the functions of the optimiser use */
    struct hf_repair *repair;             /* internal: moves proposals into the limits; NULL: does not */
    bool is_fresh; /* internal: the generation has been proposed, but hf_optimiser_tell has not been called for it */
} hf_optimiser;

/* Creates an optimiser and proposes generation 0. The array initial [n_variable] contains the values of the design
 * variables after form-finding. The optimiser borrows settings and model until hf_optimiser_free is called. If kind is
 * NULL, the population has bounds, but no designs. Returns HF_OK or HF_NO_MEMORY. Call hf_optimiser_free even if
 * hf_optimiser_create fails. */
hf_status hf_optimiser_create(const hf_optimiser_kind *kind, const hf_optimize_settings *settings,
                              const hf_model *model, const double *initial, hf_optimiser *optimiser);

/* Makes the optimiser move its proposals into the limits and below the cap of this evaluator before they are evaluated.
 * The move follows a linear model of the limited values at the best design of each generation. If the case has no
 * derivatives or no limits, or if such a model takes longer than a generation, this function has no effect. The
 * optimiser borrows the evaluator until hf_optimiser_free is called. Call the function before the first call of
 * hf_optimiser_next. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_optimiser_repair(hf_optimiser *optimiser, const hf_evaluator *evaluator);

/* Reads the results that the caller has written to population.result. Selects the survivors and ranks them
 * (hf_population_rank). */
void hf_optimiser_tell(hf_optimiser *optimiser);

/* Proposes the next generation, which becomes the present generation. If stop_reason is not HF_POPULATION_RUNNING, the
 * function returns false and has no effect. */
bool hf_optimiser_next(hf_optimiser *optimiser);

/* Begins the next generation so that several threads can propose its individuals. Returns false if there is no next
 * generation (hf_optimiser_next). If the function returns true, call hf_optimiser_propose for each individual and then
 * call hf_optimiser_end. */
bool hf_optimiser_begin(hf_optimiser *optimiser);
/* Proposes individual i in the arrays of optimiser->next. The individual may be evaluated as soon as this function
 * returns. Several threads may call this function at the same time for different individuals. */
void hf_optimiser_propose(hf_optimiser *optimiser, int i);
/* Makes optimiser->next the present generation. The caller must have called hf_optimiser_propose for all individuals of
 * the generation. */
void hf_optimiser_end(hf_optimiser *optimiser);

/* Frees the population and the state. The function frees neither the settings nor the model. */
void hf_optimiser_free(hf_optimiser *optimiser);

/* ---- the methods of a case ---- */

/* Reasons why Levenberg-Marquardt ended:
 *
 *   CONVERGED        no step within the limits is predicted to lower the merit
 *   STALLED          steps are predicted to lower the merit, but none does, however short; or the result is the start,
 *                    because no better design was found or could be measured
 *   MAX_ITERATIONS   the maximum number of steps was reached
 *   SETTLED          the last five steps together lowered the merit by less than 1e-4 of it, and changed no weighted
 *                    objective by more than 1e-3 of the merit
 *   TAKEN            the algorithm did not run: the design is a point of a front */
typedef enum {
    HF_REFINE_CONVERGED,
    HF_REFINE_STALLED,
    HF_REFINE_MAX_ITERATIONS,
    HF_REFINE_SETTLED,
    HF_REFINE_TAKEN
} hf_refine_stop;
extern const char *const hf_refine_stop_word[5]; /* "converged", "stalled", "max_iterations", "settled", "taken" */

/* HF_OPTIMA_MAX is the maximum number of refinements of one run. */
#define HF_OPTIMA_MAX 8

/* Contains the distinct local optima that the refinements of a run found, best first. Two optima are distinct if their
 * shapes are. */
typedef struct {
    int n;                       /* number of distinct optima */
    int count[HF_OPTIMA_MAX];    /* [n] number of refinements that found the optimum */
    double merit[HF_OPTIMA_MAX]; /* [n] merit of the optimum: psi (m) if there are no objectives */
} hf_optima;

/* Each row X(method, optimiser of its generations or `none`, ends_with_refine) describes one hf_optimize_method. */
#define HF_OPTIMISER_LIST(X) X(GA, ga, false) X(LM, none, true) X(GA_LM, ga, true) X(AUTO, ga, true)

/* Algorithms that a method uses. */
typedef struct {
    const hf_optimiser_kind *kind; /* optimiser of the generations; NULL: the method has none */
    bool ends_with_refine;         /* true: always refined; false: as optimize.refine states */
} hf_optimiser_plan;

/* Returns the algorithms of settings->method. If the case has optimize.front, hf_optimiser_nsga replaces
 * hf_optimiser_ga. */
hf_optimiser_plan hf_optimiser_plan_of(const hf_optimize_settings *settings);

#define HF_OPTIMISER_DECLARE(method, optimiser, ends_with_refine)                                                      \
    extern const hf_optimiser_kind hf_optimiser_##optimiser;
HF_OPTIMISER_LIST(HF_OPTIMISER_DECLARE)
extern const hf_optimiser_kind hf_optimiser_nsga; /* NSGA-II for optimize.front */
#undef HF_OPTIMISER_DECLARE

HF_API_END
