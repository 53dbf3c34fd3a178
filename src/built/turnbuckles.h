/* turnbuckles - selects a few turnbuckles and whole numbers of steps that minimise a sum of squares (METHOD section
 * 12).
 *
 * The residuals are r + J a for adjustments a = step * whole number; the functions read only J'J, J'r and r'r.
 * Turnbuckles are added greedily, with refits and exchanges. Tensions are linear in the adjustments, too, and none may
 * fall further than its room. A choice requests the changes of tension only for the turnbuckles that it uses. */
#pragma once

#include <hifdm/status.h>
#include <stdbool.h>

/* Computes the changes of all tensions per metre of turnbuckle i, rate_N_per_m [n_tension]. */
typedef void hf_turnbuckles_rates(void *context, int i, double *rate_N_per_m);

/* Describes a problem. All pointers are borrowed. */
typedef struct {
    int n;               /* number of turnbuckles */
    const double *gram;  /* [n][n] J'J */
    const double *slope; /* [n] J'r */
    double square;       /* r'r */
    double step_m;
    int steps_max;        /* maximum number of steps of one turnbuckle, either way */
    int n_max;            /* maximum number of adjusted turnbuckles */
    double target;        /* the search ends when the root of the sum of squares is at most this */
    int n_sample;         /* number of posterior samples of r */
    const double *sample; /* [n_sample][n] J' times the difference of each sample from r */
    int n_tension;        /* number of tensions; 0: tensions set no limits */
    const double *room_N; /* [n_tension] how far each tension may fall, >= 0 */
    double reference_N;   /* typical tension, the scale of rounding where room_N is 0 */
    hf_turnbuckles_rates *rates;
    void *context; /* argument of rates */
} hf_turnbuckles_problem;

typedef enum {
    HF_TURNBUCKLES_TARGET, /* the target is met */
    HF_TURNBUCKLES_ALL,    /* n_max turnbuckles are adjusted */
    HF_TURNBUCKLES_DOUBT,  /* the gain of a further one is below its standard deviation over the samples */
    HF_TURNBUCKLES_NONE    /* a further one has no gain */
} hf_turnbuckles_end;

/* Chooses the steps [n]; they are 0 for turnbuckles that are not adjusted. Sets *is_held when tension limits ruled out
 * a better choice. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_turnbuckles_choose(const hf_turnbuckles_problem *problem, int *steps, hf_turnbuckles_end *end,
                                bool *is_held);

/* Returns the sum of squares after these steps. */
double hf_turnbuckles_square(const hf_turnbuckles_problem *problem, const int *steps);

/* Returns the turnbuckle to adjust next, among those with steps[i] != done[i]. It is the one after which the sum of
 * squares is smallest, among those that keep all tensions within their room if there are any.
 *
 * change_N [number of steps other than 0][n_tension] is the change of tension by each adjustment, in the order of
 * `steps`. done [n] and fall_N [n_tension], the fall of each tension, are updated. */
int hf_turnbuckles_next(const hf_turnbuckles_problem *problem, const int *steps, const double *change_N, int *done,
                        double *fall_N);

/* Computes the best adjustments adjustment_m [n] without rounding to steps and without limits on tensions, within
 * steps_max * step_m. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_turnbuckles_best(const hf_turnbuckles_problem *problem, double *adjustment_m);
