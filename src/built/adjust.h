/* adjust - finds a few turnbuckle adjustments that restore the figure of an as-built net (METHOD section 12).
 *
 * Input is an estimate of the errors of the net (built/estimate.h) and the list of cables that have a turnbuckle.
 * Output is an ordered list of adjustments in whole steps, each with the figure that it reaches and its uncertainty.
 * The adjustments are chosen on a linear model of the shape. The adjusted shape is then solved and linearised again
 * until the choice no longer changes. */
#pragma once

#include "built/estimate.h"
#include "built/turnbuckles.h"
#include <hifdm/objectives.h>

/* Specifies which turnbuckles can be adjusted, and for which figure. All pointers are borrowed. */
typedef struct {
    const hf_adjust_settings *settings;
    /* The figure: exactly one objective, made for the model of the as-built net. */
    const hf_objectives *objectives;
    int n_cable, *cable; /* [n_cable] cables that have a turnbuckle */
    /* [n_cable of the net] minimum tensions that adjustments must keep, N; NULL: only HF_ADJUST_TAUT limits them. */
    const double *min_N;
    int n_thread; /* number of threads; 0: all cores */
} hf_adjust_task;

/* Describes one adjustment. Adjustments are listed in the order in which they are to be made. */
typedef struct {
    int cable, steps;
    double turnbuckle_m;      /* change of its length; positive: the cable becomes longer */
    double before_N, after_N; /* tension of this cable immediately before and after its adjustment */
    double figure_m;          /* solved figure after this adjustment */
    double expected_m;        /* RMS of the figure over the posterior samples */
    /* Mean reduction of the figure over the posterior samples. It is negative for an adjustment that raises tensions so
     * that later ones are allowed. */
    double gain_m;
    double gain_sigma_m; /* standard deviation of that reduction over the samples */
    int n_slack;         /* slack cables after this adjustment */
} hf_adjust_turnbuckle;

typedef struct {
    double nominal_m;   /* figure of the nominal net */
    double estimated_m; /* figure of the estimated shape, over all nodes */
    double adjusted_m;  /* figure after all adjustments */
    /* Lowest figure found by a local search over all turnbuckles within their range, without rounding to steps and
     * without limits on tensions. */
    double best_m;
    double doubt_m[2];  /* RMS of the figure over the posterior samples, before and after all adjustments */
    double spread_m[2]; /* standard deviations of the figure over the same samples */
    int n_maybe_slack;  /* cables whose estimated tension is at most its standard deviation */
    /* Cables whose tension is below its required minimum before any adjustment. They must not lose more tension. */
    int n_low;
    double low_N; /* maximum of the tensions required of these cables, N */
    int n_round;  /* number of linear models used for the choice */
    /* True when tension limits, or a solved shape with too little tension, ruled out other adjustments with a lower
     * figure. */
    bool is_held_taut;
    bool is_settled; /* the choice has converged: the last linear model leads to no better one */
    hf_turnbuckles_end end;
    int n_turnbuckle;
    hf_adjust_turnbuckle *turnbuckle; /* [n_turnbuckle] the adjustments in their order */
    void *block;
} hf_adjustment;

/* Fraction of its design tension that adjustments must leave in each cable, by the linear model. A cable that has less
 * before any adjustment must keep what it has. */
#define HF_ADJUST_TAUT 0.02

/* Returns the maximum number of steps by which a turnbuckle may be adjusted either way, at most HF_ADJUST_STEPS_MAX.
 * Returns 0 when the range is smaller than one step. */
#define HF_ADJUST_STEPS_MAX 1e9
int hf_adjust_steps(const hf_adjust_settings *settings);

/* Finds the adjustments for an estimate on which hf_estimate_find has succeeded. Returns HF_OK, HF_NO_MEMORY or
 * HF_INTERRUPTED; HF_SINGULAR when the estimated shape has no stiffness; HF_NOT_FINITE when the figure of a shape has
 * no value; or the status of a shape that cannot be solved. The caller frees its block in any case. */
hf_status hf_adjust_find(hf_estimate *estimate, const hf_adjust_task *task, hf_adjustment *adjustment);
