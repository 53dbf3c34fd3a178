/* polish - Levenberg-Marquardt on the genes, with exact sensitivities, within limits (METHOD section 7). It measures
 * how good the design of the genetic algorithm is, and can improve it. Each step is the least of the damped quadratic
 * model of merit^2 within the bounds, the cap on the boundary tension ratio and the limits of the case, which are
 * linear limits of a quadratic programme: an active bound is met exactly, and no penalty bends the way to the
 * optimum. */
#ifndef HIFDM_POLISH_H
#define HIFDM_POLISH_H

#include "search/watch.h"
#include <hifdm/optimiser.h>
#include <hifdm/evaluate.h>

typedef struct {
    int iterations, evaluations;
    double start_merit, merit; /* psi, m, unless the evaluator has goals; NaN: the start is outside the limits */
    hf_polish_stop stop;
    int n_at_lower, n_at_upper; /* genes at their bounds */
    int n_at_limit;             /* limits of optimize.limits that the design is at, cable by cable */
    bool is_at_cap;             /* the design is at the cap on the boundary tension ratio */
    /* Of hf_polish_trade: by how much the least goal gets less for one unit more of the limit of each other, in their
     * units, to first order; NaN of the least itself, and where they are not known. */
    double multiplier[HF_DESIGN_ROWS_MAX];
} hf_polish_result;

/* A run between two iterations. */
typedef struct {
    int iterations, max_iterations, evaluations;
    bool is_last;
    double merit, psi_m; /* of the best design so far; while none is within the limits, of the nearest */
    size_t n_state;
    const double *state; /* [n_state] with it the same run goes on with the same bits; of a trade none */
} hf_polish_progress;

typedef struct {
    /* Called before the first iteration and after each, in the thread of the run, which ends with what it returns
     * unless that is HF_OK. */
    hf_status (*after)(void *context, const hf_polish_progress *now);
    void *context;
    size_t n_state;
    const double *state; /* of an earlier run with the same arguments, else it is ignored; NULL: from the start */
} hf_polish_watcher;

/* Can designs of this evaluator be polished? The net must be convex, and the rule not seeded. */
bool hf_polish_applies(const hf_evaluator *evaluator);

/* Floating-point operations of one step, counted: some 2e9 of them take a second of a core. */
double hf_polish_operations(const hf_evaluator *evaluator);

/* Is a run from a design of the genetic algorithm cheap beside its n_evaluation evaluations? By counted operations, so
 * that the answer does not depend on the machine: at most a tenth of theirs, or too few to notice. */
bool hf_polish_is_cheap(const hf_evaluator *evaluator, long n_evaluation);

/* Start from the design [n_gene] within [lower, upper], which has a shape, and replace it by the best one found, which
 * is feasible and never worse. A start that breaks limits is led into them first, step by step. Linked genes keep
 * their differences. watcher: NULL for none. workspace is scratch. Returns HF_OK, HF_NO_MEMORY, HF_INTERRUPTED, what
 * the watcher returned, or the status of a start from which no feasible design was found. */
hf_status hf_polish_run(const hf_evaluator *evaluator, const double *lower, const double *upper, int max_iterations,
                        const hf_polish_watcher *watcher, double *design, hf_workspace *workspace,
                        hf_polish_result *result);

/* The same for one goal of the evaluator, the least of `trade`, while others keep their limits; merits are its value,
 * of a ratio the logarithm. A goal with corners is least where no linear model of its sizes promises less.
 * HF_OUT_OF_LIMITS where no way into the limits was found. */
hf_status hf_polish_trade(const hf_evaluator *evaluator, const double *lower, const double *upper, int max_iterations,
                          const hf_watch_trade *trade, const hf_polish_watcher *watcher, double *design,
                          hf_workspace *workspace, hf_polish_result *result);

#endif
