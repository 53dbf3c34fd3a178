/* moves - which few cables to turn, by how many steps each, so that the sum of squares of linear residuals is least: a
 * choice in whole numbers, made greedily with refits and exchanges (METHOD section 12).
 *
 * Residuals are r + J a for moves a = step * whole number; J'J and J'r are all that is read of them. Tensions are
 * linear in moves, too, and none may fall further than it has room: their rates are asked for of the few cables that a
 * choice takes alone. */
#ifndef HIFDM_MOVES_H
#define HIFDM_MOVES_H

#include <hifdm/status.h>
#include <stdbool.h>

/* Write what a metre of cable i adds to each tension, rate_N_per_m [n_tension]. */
typedef void hf_moves_rates(void *context, int i, double *rate_N_per_m);

/* All borrowed. */
typedef struct {
    int n;               /* cables that can be turned */
    const double *gram;  /* [n][n] J'J */
    const double *slope; /* [n] J'r */
    double square;       /* r'r */
    double step_m;
    int steps_max;        /* of one cable, either way */
    int moves_max;        /* cables that are turned */
    double target;        /* enough when the root of the sum of squares is below it */
    int n_sample;         /* of what r may be instead, as far as is known */
    const double *sample; /* [n_sample][n] J' (difference of r) */
    int n_tension;        /* 0: moves are not limited by them */
    const double *room_N; /* [n_tension] how far each may fall, >= 0 */
    double reference_N;   /* a tension as there are many: rounding is measured by it, where there is no room */
    hf_moves_rates *rates;
    void *context; /* of rates */
} hf_moves_problem;

typedef enum {
    HF_MOVES_TARGET, /* the target is met */
    HF_MOVES_ALL,    /* moves_max cables are turned */
    HF_MOVES_DOUBT,  /* a further one gains less than its standard deviation by the samples */
    HF_MOVES_NONE    /* no further one gains anything */
} hf_moves_end;

/* steps [n]: 0 of cables that are not turned. *is_held: other steps were better but for tensions. HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_moves_choose(const hf_moves_problem *problem, int *steps, hf_moves_end *end, bool *is_held);

/* The sum of squares after these steps. */
double hf_moves_square(const hf_moves_problem *problem, const int *steps);

/* Of the steps that are not done yet, the one after which the sum of squares is least, of those that keep tensions up
 * if there are some: its cable. change_N [steps other than 0][n_tension]: what each adds to tensions, in their order.
 * done [n] and fall_N [n_tension], how far tensions fell, are brought up to date. */
int hf_moves_next(const hf_moves_problem *problem, const int *steps, const double *change_N, int *done, double *fall_N);

/* The best moves of all n cables without steps, within steps_max * step_m, whatever tensions do: move_m [n]. HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_moves_best(const hf_moves_problem *problem, double *move_m);

#endif
