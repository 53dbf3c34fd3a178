/* adjust - from the estimated errors of the net as built to the fewest moves of turnbuckles that bring its figure back:
 * chosen on a linear model of the shape, whose predictions are solved and linearised again until the choice stays
 * (METHOD section 12). */
#ifndef HIFDM_ADJUST_H
#define HIFDM_ADJUST_H

#include "built/estimate.h"
#include "built/moves.h"
#include <hifdm/goals.h>

/* What may be turned, and what for. Borrowed. */
typedef struct {
    const hf_adjust_settings *settings;
    const hf_goals *goals; /* the figure, of one goal and of the model of the net as built */
    int n_cable, *cable;   /* [n_cable] that can be turned */
    const double
        *least_N; /* [n_cable of the net] tensions below which no move takes a cable; NULL: HF_ADJUST_TAUT alone */
    int n_thread; /* 0: all cores */
} hf_adjust_task;

/* One move, in the order in which they are made. Longer cables have a move above 0. */
typedef struct {
    int cable, steps;
    double move_m;
    double before_N, after_N; /* tension of the cable, right before and after its move */
    double figure_m;          /* of the shape after this move, solved */
    double expected_m;        /* RMS of it over what errors and measurement leave open */
    double gain_m;       /* how far this move lowers the figure, mean over that; below 0: it makes room for others */
    double gain_sigma_m; /* the standard deviation */
    int n_slack;         /* cables in this shape */
} hf_adjust_move;

typedef struct {
    double nominal_m;   /* figure of the nominal net */
    double estimated_m; /* of the estimated shape, all nodes */
    double adjusted_m;  /* after the moves */
    double best_m;      /* lowest that a local search found: any moves within the range, whatever tensions */
    double doubt_m[2];  /* RMS over what errors and measurement leave open, of the estimated and the adjusted shape */
    double spread_m[2]; /* standard deviation of these figures */
    int n_maybe_slack;  /* cables whose estimated tension is less than its standard deviation */
    int n_low;          /* cables that have less than is asked for without moves: they may not lose more */
    double low_N;       /* the most that is asked for of one of them */
    int n_round;        /* linear models */
    bool is_held_taut;  /* other moves were better but for tensions that fall too low, or cables that go slack */
    bool is_settled;    /* the last of them chose nothing better than the moves that it was linearised at */
    hf_moves_end end;
    int n_move;
    hf_adjust_move *move; /* [n_move] */
    void *block;
} hf_adjustment;

/* The part of its tension in the design that moves leave a cable, by the linear model; of one that has less without
 * moves, what it has. */
#define HF_ADJUST_TAUT 0.02

/* How many steps a cable may be turned either way; 0 when the range is smaller than a step. */
#define HF_ADJUST_STEPS_MAX 1e9
int hf_adjust_steps(const hf_adjust_settings *settings);

/* The estimate is found. HF_OK, HF_NO_MEMORY, HF_SINGULAR, or the status of a shape that failed. Free it in any
 * case. */
hf_status hf_adjust_find(hf_estimate *estimate, const hf_adjust_task *task, hf_adjustment *adjustment);
void hf_adjust_free(hf_adjustment *adjustment);

#endif
