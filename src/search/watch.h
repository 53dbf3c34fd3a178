/* watch - what limits a step of Levenberg-Marquardt beside the bounds of its variables: tensions between bounds, ratios
 * of tensions, displacements of attachments. Each is linear in a step to first order, and `bend` is what it was beyond
 * that at the last trial, so that a step that breaks a limit can be solved again. */
#ifndef HIFDM_WATCH_H
#define HIFDM_WATCH_H

#include "linalg/quadratic.h"
#include "search/sensitivity.h"

/* Of the goals of an evaluator one is to be least while the others stay below limits. */
typedef struct {
    int least;
    const double *most; /* [n_goal], above 0; INFINITY: no limit */
} hf_watch_trade;

/* Is a goal beyond its limit by more than this part of it? Without a trade (NULL) none is. */
bool hf_watch_breaks(const hf_watch_trade *trade, const hf_goals *goals, double part, const double *goal);

typedef struct {
    int cable, attachment;  /* whose tension, or displacement; else -1 */
    int support, goal;      /* whose pull; the goal that it limits, and measures where all others are -1 */
    int ratio;              /* the cap that counts it; -1: none */
    int kind;               /* HF_WATCH_BOUND, HF_WATCH_ROW, HF_WATCH_LEVEL or HF_WATCH_GOAL */
    double lower, upper;    /* infinite where only a cap limits it */
    double from, to;        /* what a step keeps it between, see hf_watch_aim */
    double value, bend;     /* at the best variables; beyond the linear model at the last trial */
    double now;             /* of the shape that was looked at last */
    double predicted, unit; /* by the linear model; violations are relative to the unit */
} hf_watched;

typedef struct {
    const hf_evaluator *v;                     /* borrowed; with the limits */
    int n, n_variable, n_cap, n_cap_of_limits; /* the others are of goals */
    bool has_cap;                              /* the first of them is that of the boundary */
    hf_watched *item;                          /* [n] */
    int ld;                                    /* n, and as many more as make whole vectors */
    double *rate;                /* [1 + n_variable][ld] values, as far as they are known; of them per variable */
    double *weight;              /* [1 + n_variable] 1, and a step */
    double *predicted;           /* [ld] of the step, by the linear model */
    double *by_item;             /* [n_variable] scratch */
    double *cap;                 /* [n_cap] largest over least of the tensions that it counts */
    double *ratio;               /* [n_cap] the same at the best variables */
    double *aim;                 /* [n_cap] what a step keeps it below */
    const hf_watch_trade *trade; /* or NULL */
    const double *goal;          /* with a trade: [n_goal] of the shape that is looked at; borrowed, as the next */
    const double *goal_rate;     /* [n_goal][n_variable] of goals without corners, at the best variables */
    double level;                /* of a goal with corners that is to be least: its value; of a ratio the logarithm */
    double *move_m, *tension_rate, *pull_rate; /* scratch of pulls: [3][n_node], [n_cable], [n_support] */
    void *block;
} hf_watch;

/* Watch the cap and the limits of the evaluator, and the bounds [n_gene] of genes that set a tension; with a trade
 * (else NULL) the goals as well, when their values and rates have been set. HF_OK or HF_NO_MEMORY; free in either case.
 */
hf_status hf_watch_create(const hf_evaluator *evaluator, const hf_sensitivity *slopes, const double *lower,
                          const double *upper, const hf_watch_trade *trade, hf_watch *watch);
void hf_watch_free(hf_watch *watch);

/* Does the shape in the workspace keep everything that is watched? */
bool hf_watch_keeps(hf_watch *watch, hf_workspace *workspace);

/* Take the shape in the workspace as the best. */
void hf_watch_linearise(hf_watch *watch, const hf_sensitivity *slopes, hf_workspace *workspace);

/* A step shall go this part of the way from the best variables into limits that they break; 1, as after
 * hf_watch_linearise: it shall keep all limits. */
void hf_watch_aim(hf_watch *watch, double part);

/* How far the shape in the workspace is beyond what is watched, in all: the violation by which designs are ranked, and
 * that of the bounds of tensions and of goals. */
double hf_watch_violation(hf_watch *watch, hf_workspace *workspace);

/* Forget what was beyond the linear model; or learn it from the shape that the step x has led to. */
void hf_watch_forget(hf_watch *watch);
void hf_watch_learn(hf_watch *watch, const double *x, hf_workspace *workspace);

/* The limit that the step x breaks by more than `worst`, and by the most of all, over its unit; false: none does. Its
 * kind says whether it is a bound of a gene, the cap on the boundary ratio, a row of optimize.limits, or a goal. Where
 * a goal with corners is to be least, x has one entry more, by which its level rises, and the level is a limit: no
 * size is above it. */
enum { HF_WATCH_BOUND = 1, HF_WATCH_CAP, HF_WATCH_ROW, HF_WATCH_LEVEL, HF_WATCH_GOAL };
bool hf_watch_worst(hf_watch *watch, const double *x, double worst, hf_quadratic_limit *limit);

/* How far a limit of kind HF_WATCH_GOAL or above gives way for one unit more of *goal, whose limit it is. */
double hf_watch_relief(const hf_watch *watch, int kind, int *goal);

#endif
