/* watch - what limits a step of Levenberg-Marquardt beside the bounds of its variables: tensions between bounds, ratios
 * of tensions, displacements of attachments. Each is linear in a step to first order, and `bend` is what it was beyond
 * that at the last trial, so that a step that breaks a limit can be solved again. */
#ifndef HIFDM_WATCH_H
#define HIFDM_WATCH_H

#include "linalg/quadratic.h"
#include "search/sensitivity.h"

typedef struct {
    int cable, attachment;  /* whose tension, or displacement; the other is -1 */
    int ratio;              /* the cap that counts it; -1: none */
    int kind;               /* HF_WATCH_BOUND or HF_WATCH_ROW */
    double lower, upper;    /* infinite where only a cap limits it */
    double from, to;        /* what a step keeps it between, see hf_watch_aim */
    double value, bend;     /* at the best variables; beyond the linear model at the last trial */
    double predicted, unit; /* by the linear model; violations are relative to the unit */
} hf_watched;

typedef struct {
    const hf_evaluator *v; /* borrowed; with the limits */
    int n, n_variable, n_cap;
    bool has_cap;     /* the first of them is that of the boundary */
    hf_watched *item; /* [n] */
    double *rate;     /* [n][n_variable] of value per variable */
    double *cap;      /* [n_cap] largest over least of the tensions that it counts */
    double *ratio;    /* [n_cap] the same at the best variables */
    double *aim;      /* [n_cap] what a step keeps it below */
    void *block;
} hf_watch;

/* Watch the cap and the limits of the evaluator, and the bounds [n_gene] of genes that set a tension. HF_OK or
 * HF_NO_MEMORY; free in either case. */
hf_status hf_watch_create(const hf_evaluator *evaluator, const hf_sensitivity *slopes, const double *lower,
                          const double *upper, hf_watch *watch);
void hf_watch_free(hf_watch *watch);

/* Does the shape in the workspace keep everything that is watched? */
bool hf_watch_keeps(const hf_watch *watch, const hf_workspace *workspace);

/* Take the shape in the workspace as the best. */
void hf_watch_linearise(hf_watch *watch, const hf_sensitivity *slopes, const hf_workspace *workspace);

/* A step shall go this part of the way from the best variables into limits that they break; 1, as after
 * hf_watch_linearise: it shall keep all limits. */
void hf_watch_aim(hf_watch *watch, double part);

/* How far the shape in the workspace is beyond what is watched, in all: the violation by which designs are ranked, and
 * that of the bounds of tensions. */
double hf_watch_violation(const hf_watch *watch, const hf_workspace *workspace);

/* Forget what was beyond the linear model; or learn it from the shape that the step x has led to. */
void hf_watch_forget(hf_watch *watch);
void hf_watch_learn(hf_watch *watch, const double *x, const hf_workspace *workspace);

/* The limit that the step x breaks by more than `worst`, and by the most of all, over its unit; false: none does. Its
 * kind says whether it is a bound of a gene, the cap on the boundary ratio, or a row of optimize.limits. */
enum { HF_WATCH_BOUND = 1, HF_WATCH_CAP, HF_WATCH_ROW };
bool hf_watch_worst(hf_watch *watch, const double *x, double worst, hf_quadratic_limit *limit);

#endif
