/* refine - refines a design by Levenberg-Marquardt, with exact sensitivities and within limits (METHOD section 7). It
 * shows how far a design of the genetic algorithm is from an optimum, and can improve it.
 *
 * Each step is the minimum of the damped quadratic model of merit^2 within linear limits. The limits are the bounds,
 * the cap on the boundary tension ratio, and the limits of the case. The step is the solution of a quadratic programme,
 * so it meets an active bound exactly, and no penalty slows the convergence.
 *
 * An objective with corners is the maximum of several sizes, such as forces on supports, or a ratio of tensions. It has
 * no derivative where two sizes are equal. */
#pragma once

#include "search/watch.h"
#include <hifdm/optimiser.h>
#include <hifdm/evaluate.h>

typedef struct {
    int iterations, evaluations;
    /* The merits of start and result: psi (m) if there are no objectives. Without a front, start_merit is NaN if the
     * start is infeasible. */
    double start_merit, merit;
    hf_refine_stop stop;
    bool is_beaten; /* the run ended early because it was not expected to pass the merit of the watcher's `beat` */
    /* Part of the merit by which the linear model, without damping and within the limits, would still lower it. It is 0
     * if the run has converged, and NaN for a point of a front or if the model has no solution. */
    double predicted_gain;
    int n_at_lower, n_at_upper; /* design variables at their lower and upper bounds */
    int n_at_limit;             /* cables and attachments at limits of optimize.limits; a ratio counts once */
    bool is_at_cap;             /* the design is at the cap on the boundary tension ratio */
    /* Set with a front: the decrease of the minimised objective per unit of the limit on each other objective, in
     * their units, to first order. It is NaN for the minimised objective, and where it is not known. */
    double multiplier[HF_DESIGN_ROWS_MAX];
} hf_refine_result;

/* The state of a run between two iterations. */
typedef struct {
    int iterations, max_iterations, evaluations;
    bool is_last;
    double merit, psi_m; /* values of the best design so far, or of the nearest one while none is feasible */
    double violation;    /* of the nearest design while none is feasible, as hf_watch_violation; otherwise 0 */
    size_t n_state;
    const double *state; /* [n_state], to resume the run with the same bits; NULL for a point of a front */
} hf_refine_progress;

typedef struct {
    /* Called before the first iteration and after each iteration, in the thread of the run. If it returns anything but
     * HF_OK, the run ends with that status. */
    hf_status (*after)(void *context, const hf_refine_progress *now);
    void *context;
    size_t n_state;
    const double *state; /* state of an earlier run with the same arguments, ignored if it does not fit; NULL: none */
    bool is_more;        /* continue the state of a run that has settled; this run ends only for the other reasons */
    double beat;         /* a run that the model expects to remain above this merit settles early; 0: none */
} hf_refine_watcher;

/* Returns true if designs of this evaluator can be refined. The net must have a Newton matrix, there must be design
 * variables, the rule must not be `seeded`, and no objective may be a quantile. */
bool hf_refine_applies(const hf_evaluator *evaluator);

/* Returns true if steps are solved by one sparse saddle-point system (saddle_step.h), because that takes far fewer
 * counted operations than dense derivatives by each variable. A step that breaks the cap on the boundary tension ratio
 * makes the run continue with dense derivatives. */
bool hf_refine_is_sparse(const hf_evaluator *evaluator);

/* Returns the counted floating-point operations of one step. A core performs some 8e9 of them per second. */
double hf_refine_operations(const hf_evaluator *evaluator);

/* Returns true if a run from a design of the genetic algorithm is cheap. It then takes at most a tenth of the
 * operations of the n_evaluation evaluations, or too few to be noticed. The operations are counted, so the result does
 * not depend on the machine. */
bool hf_refine_is_cheap(const hf_evaluator *evaluator, long n_evaluation);

/* Returns true if the derivatives of one shape take at most as many operations as three generations of a population,
 * and at most 80 MB. */
bool hf_refine_model_is_cheap(const hf_evaluator *evaluator, int population);

/* Returns the number of generations of a population that take about as many operations as one run, at least 1. */
int hf_refine_generations(const hf_evaluator *evaluator, int population);

/* Refines the design [n_variable], which has a shape and is within lower and upper [n_variable]. It is replaced by the
 * best design found, which is feasible and never worse. A start outside the limits is first moved into them. Linked
 * design variables keep their differences. watcher: NULL for none. workspace is scratch. Returns HF_OK, HF_NO_MEMORY,
 * HF_INTERRUPTED, the status that the watcher returned, or the status of the start if no feasible design was found. The
 * design is then the nearest one to the limits.
 *
 * front: NULL, or a point of a Pareto front is sought. One objective of the evaluator, `front->least`, is then
 * minimised under limits on the others. All merits are values of this objective; for a ratio, they are its logarithm.
 * The minimum of an objective with corners is a point at which no linear model of its sizes promises a lower value.
 * Returns HF_OUT_OF_LIMITS if the limits on objectives cannot be met. */
hf_status hf_refine_run(const hf_evaluator *evaluator, const double *lower, const double *upper, int max_iterations,
                        const hf_watch_front *front, const hf_refine_watcher *watcher, double *design,
                        hf_workspace *workspace, hf_refine_result *result);
