/* watch - keeps a step of Levenberg-Marquardt within limits other than the bounds of its variables. They are bounds of
 * tensions, constraints by requirements, and limits on ratios of tensions, on deflections of attachments and on
 * objectives. Each limit is linear in
 * the step to first order. `bend` is what the value was beyond the linear model at the last trial. With it, a step that
 * breaks a limit is solved again. */
#pragma once

#define HF_WATCH_INSIDE 1e-9 /* relative distance that a step keeps from its limits [1e-11; 1e-7 fails] */

#include "linalg/quadratic.h"
#include "search/sensitivity.h"

/* A point of a Pareto front: one objective of the evaluator is minimised under limits on the others. */
typedef struct {
    int least;
    const double *most; /* [n_objective], limits above 0; INFINITY: none */
} hf_watch_front;

/* Returns true if an objective exceeds its limit by more than `part` of it. Returns false if front is NULL. */
bool hf_watch_breaks(const hf_watch_front *front, const hf_objectives *objectives, double part,
                     const double *objective);

typedef struct {
    /* An item is the tension of a cable, the deflection of an attachment, the force on a support, or an objective. The
     * indices that it does not need are -1. */
    int cable, attachment;
    int support, objective; /* goal: objective that the item limits; with no other index, the item itself */
    int constraint;         /* constraint by a requirement, or -1 */
    int ratio;              /* index of the cap to which the item belongs, or -1 */
    int kind;               /* HF_WATCH_BOUND, HF_WATCH_ROW, HF_WATCH_LEVEL or HF_WATCH_OBJECTIVE */
    double lower, upper;    /* bounds; infinite if only a cap limits the item */
    double from, to;        /* bounds of the next step, see hf_watch_aim */
    double value, bend;     /* value at the best variables; its excess over the linear model at the last trial */
    double now;             /* value at the shape that was measured last */
    double predicted, unit; /* value by the linear model; unit of violations */
} hf_watched;

/* The arrays of hf_watch for a model m, with n_column = 1 + n_class. ld is n, rounded up to whole vectors. */
#define HF_WATCH_FIELDS(X)                                                                                             \
    X(hf_watched, item, to->n, "all items")                                                                            \
    X(double, rate, n_column *(size_t)to->ld, "[n_column][ld] values with `bend`, then rates by each variable")        \
    X(double, weight, n_column, "weights of the columns of `rate`: 1, then a step")                                    \
    X(double, predicted, to->ld, "values after a step by the linear model")                                            \
    X(double, by_item, n_column, "[n_class] scratch")                                                                  \
    X(double, cap, to->n_cap, "limit on the ratio of maximum to minimum of its items")                                 \
    X(double, ratio, to->n_cap, "ratio of maximum to minimum at the best variables")                                   \
    X(double, aim, to->n_cap, "limit on the ratio in the next step")                                                   \
    X(double, move_m, to->front ? 3 * (size_t)m->n_node : 0, "[3][n_node] scratch for forces on supports")             \
    X(double, tension_rate, to->front ? m->n_cable : 0, "[n_cable] the same")                                          \
    X(double, pull_rate, to->front ? m->n_node - m->n_free : 0, "[n_support] the same")

typedef struct {
    const hf_evaluator *v; /* borrowed; its limits are watched */
    /* The first n_cap_of_limits caps are those of the boundary and of optimize.limits, the others those of
     * objectives. */
    int n, ld, n_class, n_cap, n_cap_of_limits;
    bool has_cap; /* true if the first cap is that of the boundary tension ratio */
    HF_WATCH_FIELDS(HF_ARENA_MEMBER)
    const hf_watch_front *front;   /* NULL: no objective is limited */
    const double *objective;       /* [n_objective], objectives of the measured shape; borrowed; NULL without `front` */
    hf_objectives_point *point;    /* scratch for forces on supports; borrowed; NULL without `front` */
    const double *objective_rate;  /* [n_objective][n_class], rates of objectives without corners, borrowed */
    const double *constraint;      /* [n_constraint], distances of the measured shape; borrowed; NULL: none */
    const double *constraint_rate; /* [n_constraint][n_class], their rates, borrowed */
    double level;                  /* value of a minimised objective with corners, or the logarithm of a ratio */
    void *block;
} hf_watch;

/* Watches the cap and the limits of the evaluator, and the bounds lower and upper [n_variable] of design variables that
 * set a tension. If `front` is not NULL, it also watches the objectives, after the caller has set
 * `objective`, objective_rate and `point`. Returns HF_OK or HF_NO_MEMORY; the caller frees its block. */
hf_status hf_watch_create(const hf_evaluator *evaluator, const hf_sensitivity *slopes, const double *lower,
                          const double *upper, const hf_watch_front *front, hf_watch *watch);

/* Returns true if the shape in the workspace keeps all limits. */
bool hf_watch_keeps(hf_watch *watch, const hf_workspace *workspace);

/* Returns true if the shape that was measured last breaks the cap on the boundary tension ratio. */
bool hf_watch_breaks_cap(const hf_watch *watch);

/* Makes the shape in the workspace the best one, and computes the rates of all items there. */
void hf_watch_linearise(hf_watch *watch, const hf_sensitivity *slopes, const hf_workspace *workspace);

/* Returns where the rate of an item by a class of linked variables is. */
static inline double *hf_watch_rate(const hf_watch *watch, ptrdiff_t i_item, int i_class)
{
    return watch->rate + (ptrdiff_t)(1 + i_class) * watch->ld + i_item;
}

/* Sets the limits of the next step: it goes this part of the way from the best variables into the limits that they
 * break. With part 1, as after hf_watch_linearise, it keeps all limits. */
void hf_watch_aim(hf_watch *watch, double part);

/* Returns the total violation of the shape in the workspace. It is the violation by which designs are ranked, plus
 * those of the bounds of tensions and of the limits on objectives. */
double hf_watch_violation(hf_watch *watch, const hf_workspace *workspace);

/* hf_watch_forget sets `bend` of all items to 0. hf_watch_learn computes it from the shape in the workspace, to which
 * the step x has led. */
void hf_watch_forget(hf_watch *watch);
void hf_watch_learn(hf_watch *watch, const double *x, const hf_workspace *workspace);

/* Finds the limit that the step x violates most, relative to its unit, and by more than `worst`. Returns false if there
 * is none. If the minimised objective has corners, x has one more entry, the increase of its level, and no size may
 * exceed the level. The kind of the limit is
 *
 *     HF_WATCH_BOUND             for a bound of a design variable that sets a tension,
 *     HF_WATCH_CAP               for the cap on the boundary tension ratio,
 *     HF_WATCH_ROW               for a row of optimize.limits,
 *     HF_WATCH_LEVEL             for the level of an objective,
 *     HF_WATCH_OBJECTIVE or above     for the limit on an objective. */
enum { HF_WATCH_BOUND = 1, HF_WATCH_CAP, HF_WATCH_ROW, HF_WATCH_LEVEL, HF_WATCH_OBJECTIVE };
bool hf_watch_worst(hf_watch *watch, const double *x, double worst, hf_quadratic_limit *limit);

/* Finds the items of cap k with the minimum and the maximum of these values [n]; -1 if the cap has no item. */
void hf_watch_extremes(const hf_watch *watch, int i_cap, const double *value, int *low, int *high);

/* Returns by how much a limit of kind HF_WATCH_OBJECTIVE or above is relaxed per unit of the limit on objective *goal,
 * to which it belongs. */
double hf_watch_relief(const hf_watch *watch, int kind, int *objective);
