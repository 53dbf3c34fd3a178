/* front - the designs of a Pareto front of optimize.front: none is better than another in all objectives.
 * Stability: internal; may change in any version.
 *
 * Levenberg-Marquardt and the genetic algorithm produce the same struct, which is stored, printed, compared and drawn.
 * Pipeline: hf_front_create -> objectives, designs and statuses of the points -> hf_front_settle -> hf_front_tabulate.
 *
 * Objectives are those of optimize.front in their order and units; they are minimised. A point that is not on the
 * front is marked and never left out. */
#ifndef HIFDM_FRONT_H
#define HIFDM_FRONT_H

#include <hifdm/api.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>
#include <stdbool.h>

HF_API_BEGIN

/* X(enumerator, word): what a point is. */
#define HF_FRONT_MARKS(X)                                                                                              \
    X(ON, "on")               /* no other point is as good in all objectives and better in one */                      \
    X(DOMINATED, "dominated") /* another point is as good in all objectives and better in one */                       \
    X(FAILED, "failed")       /* it has no feasible design; `status` has the reason */
#define HF_FRONT_ENUMERATOR(name, word) HF_FRONT_##name,
/* What a point is. */
typedef enum { HF_FRONT_MARKS(HF_FRONT_ENUMERATOR) HF_FRONT_N_MARK } hf_front_mark;
#undef HF_FRONT_ENUMERATOR
extern const char *const hf_front_mark_word[HF_FRONT_N_MARK + 1]; /* the last entry is NULL */

/* A point of a front. */
typedef struct {
    double objective[HF_FRONT_OBJECTIVES_MAX]; /* values of the objectives; NaN for a failed point */
    /* The slope of the front, >= 0: the decrease of objective `minimised` for an increase of each other objective by
     * one unit, in their units. NaN for `minimised` itself, and where the method computes no slope. */
    double multiplier[HF_FRONT_OBJECTIVES_MAX];
    hf_status status;   /* status of its design */
    hf_front_mark mark; /* what the point is */
    int steps;          /* steps of Levenberg-Marquardt; 0 for the genetic algorithm */
    bool is_converged;  /* Levenberg-Marquardt has converged; otherwise there is no multiplier */
} hf_front_point;

/* A front with its designs. */
typedef struct {
    int n_objective, n_variable, n_point;    /* numbers of objectives, design variables and points */
    int minimised;                           /* objective that is minimised under limits on the others; -1: all are */
    int knee;                                /* point farthest below the line of the ends (hf_front_settle); -1: none */
    double initial[HF_FRONT_OBJECTIVES_MAX]; /* objectives of the initial design; NaN: no value */
    hf_front_point *point;                   /* [n_point] by objective 0, then 1, then 2, ascending; failed ones last */
    double *design; /* [n_point][n_variable] designs as of hf_evaluate; NaN for a failed point */
    void *block;    /* owned memory behind point and design */
} hf_front;

/* A front without its designs, as in a summary: n_row of n_point points. If there are more than HF_FRONT_POINTS_MAX
 * points, the rows are the ends, the knee, and as many evenly spaced others as fit. */
typedef struct {
    /* Counts of the front, and `minimised` as in hf_front. */
    int n_objective, n_point, n_row, n_on, n_dominated, n_failed, minimised;
    int knee, end[HF_FRONT_OBJECTIVES_MAX];  /* rows of the knee and of the first minimum of each objective; -1: none */
    double initial[HF_FRONT_OBJECTIVES_MAX]; /* objectives of the initial design */
    int n_unconverged;                       /* Levenberg-Marquardt: points with a design that has not converged */
    double wall_s;                           /* time of the computation */
    int index[HF_FRONT_POINTS_MAX];          /* index of each row in the front, from 0, ascending */
    hf_front_point row[HF_FRONT_POINTS_MAX]; /* [n_row] the points */
} hf_front_table;

/* Allocates a front of n_point points with all values 0. Returns HF_OK or HF_NO_MEMORY. Call hf_front_free in either
 * case. */
hf_status hf_front_create(int n_objective, int n_variable, int n_point, hf_front *front);
/* Frees points and designs; `minimised` and `knee` become -1. */
void hf_front_free(hf_front *front);

/* Completes a front whose objectives, designs and statuses are set. It sorts the points, marks those that have failed
 * or are dominated, and finds the knee. Of two equal points the later one is marked as dominated. */
void hf_front_settle(hf_front *front);

/* Sets all members of the table except wall_s from a front that is settled. */
void hf_front_tabulate(const hf_front *front, hf_front_table *table);

/* Returns true if the objectives do not conflict: one design is best in all of them, and no point has failed. */
bool hf_front_agrees(const hf_front_table *table);

/* Returns the number, from 1, of the point to examine first: the knee, otherwise an end; 0 if the front is empty. */
int hf_front_suggested(const hf_front_table *table);

/* Returns true if the objectives a [n_objective] are nowhere above b [n_objective] and somewhere below. */
bool hf_front_dominates(int n_objective, const double *a, const double *b);

HF_API_END
#endif
