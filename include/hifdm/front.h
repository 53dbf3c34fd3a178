/* front - the designs of a Pareto front of optimize.front. No design of a Pareto front is better than another design in
 * all objectives.
 * Stability: internal. This header may change in any version.
 *
 * Levenberg-Marquardt and the genetic algorithm both produce a struct hf_front. The program stores, prints, compares
 * and draws the struct hf_front. Pipeline: hf_front_create -> objectives, designs and statuses of the points ->
 * hf_front_settle -> hf_front_tabulate.
 *
 * The objectives have the order and the units of the rows of optimize.front. All objectives of a Pareto front are
 * minimised. Points that are not on the Pareto front are marked but never omitted. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/requirements.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>
#include <stdbool.h>

HF_API_BEGIN

/* Each row X(enumerator, word) defines a status of a point relative to the Pareto front. */
#define HF_FRONT_MARKS(X)                                                                                              \
    X(ON, "on")               /* no other point is at least as good in all objectives and better in one */             \
    X(DOMINATED, "dominated") /* another point is at least as good in all objectives and better in one */              \
    X(FAILED, "failed")       /* the point has no feasible design; `status` contains the reason */
#define HF_FRONT_ENUMERATOR(name, word) HF_FRONT_##name,
/* Defines the status of a point relative to the Pareto front. */
typedef enum { HF_FRONT_MARKS(HF_FRONT_ENUMERATOR) HF_FRONT_N_MARK } hf_front_mark;
#undef HF_FRONT_ENUMERATOR
extern const char *const hf_front_mark_word[HF_FRONT_N_MARK + 1]; /* the last entry is NULL */

/* One point of a front. */
typedef struct {
    double objective[HF_FRONT_OBJECTIVES_MAX]; /* values of the objectives; NaN for a failed point */
    /* Slope of the front, >= 0. The slope for another objective is the decrease of the objective `minimised` per unit
     * increase of this other objective. The unit of the slope is the unit of the objective `minimised` divided by the
     * unit of the other objective. The slope is NaN for the objective `minimised` itself. If the method computes no
     * slope, all slopes are NaN. */
    double multiplier[HF_FRONT_OBJECTIVES_MAX];
    hf_status status;       /* status of the design of this point */
    hf_front_mark mark;     /* whether the point is on the front, dominated or failed */
    int steps;              /* number of steps of Levenberg-Marquardt; 0 for the genetic algorithm */
    bool is_converged;      /* true: Levenberg-Marquardt has converged; false: there is no multiplier */
    hf_judgement judgement; /* on the rows of `requirements`; n_required is 0 if there are none */
} hf_front_point;

/* Contains a Pareto front and its designs. */
typedef struct {
    int n_objective, n_variable, n_point; /* numbers of objectives, design variables and points */
    int minimised; /* objective that is minimised with limits on the others; -1: all are minimised */
    /* index of the knee (hf_front_settle): the point farthest below the line or plane through the ends; -1: none */
    int knee;
    double initial[HF_FRONT_OBJECTIVES_MAX]; /* objectives of the initial design; NaN: an objective has no value */
    hf_front_point *point; /* [n_point] points in ascending order of objective 0, then 1, then 2; failed points last */
    double *design;        /* [n_point][n_variable] designs as in hf_evaluate; NaN for a failed point */
    void *block;           /* owned memory behind `point` and `design` */
} hf_front;

/* Contains a Pareto front without its designs, as stored in a summary. The table contains n_row of the n_point points.
 * If the Pareto front has more than HF_FRONT_POINTS_MAX points, the table contains the ends, the knee and evenly spaced
 * other points. */
typedef struct {
    /* All counts except n_row refer to the whole Pareto front. The member `minimised` has the same meaning as in
     * hf_front. */
    int n_objective, n_point, n_row, n_on, n_dominated, n_failed, minimised;
    /* row of the knee, and row of the first minimum of each objective; -1: none */
    int knee, end[HF_FRONT_OBJECTIVES_MAX];
    double initial[HF_FRONT_OBJECTIVES_MAX]; /* objectives of the initial design */
    /* point that ranks first (hf_front_suggested), counted from 0, or -1; its values */
    int suggested;
    hf_front_point first;
    int n_verdict[HF_VERDICT_N];             /* number of points with each verdict; failed points have none */
    int n_unconverged;                       /* Levenberg-Marquardt: number of points whose design has not converged */
    double wall_s;                           /* wall-clock time of the computation */
    int index[HF_FRONT_POINTS_MAX];          /* index of each row in the front, counted from 0, in ascending order */
    hf_front_point row[HF_FRONT_POINTS_MAX]; /* [n_row] the points */
} hf_front_table;

/* Allocates a Pareto front of n_point points. The function sets all values of the new Pareto front to 0. Returns HF_OK
 * or HF_NO_MEMORY. Call hf_front_free even if hf_front_create fails. */
hf_status hf_front_create(int n_objective, int n_variable, int n_point, hf_front *front);
/* Frees points and designs. Sets `minimised` and `knee` to -1. */
void hf_front_free(hf_front *front);

/* Completes a Pareto front after the caller has set its objectives, designs and statuses. The function sorts the
 * points, marks failed and dominated points, and finds the knee. If two points are equal, the later point is marked as
 * dominated. */
void hf_front_settle(hf_front *front);

/* Sets all members of the table except wall_s. The caller must have completed the Pareto front with hf_front_settle. */
void hf_front_tabulate(const hf_front *front, hf_front_table *table);

/* Returns true if the objectives do not conflict. If one design is best in all objectives and no point has failed, the
 * objectives do not conflict. */
bool hf_front_agrees(const hf_front_table *table);

/* Returns the number, counted from 1, of the point that the user should examine first. The point is the knee or, if the
 * front has no knee, an end of the front. If requirements have been judged, it is the point that ranks first by its
 * verdicts (hf_judgement_compare). Points with equal numbers of failed and undecided requirements rank by whether they
 * are on the front and have converged, before their margins. Returns 0 if the Pareto front is empty. */
int hf_front_suggested(const hf_front_table *table);

/* Returns true if points have verdicts on rows of `requirements`. */
bool hf_front_is_judged(const hf_front_table *table);

/* Returns true if the objectives a [n_objective] dominate the objectives b [n_objective]. If no objective in `a` is
 * larger than in `b` and at least one objective is smaller, `a` dominates `b`. */
bool hf_front_dominates(int n_objective, const double *a, const double *b);

HF_API_END
