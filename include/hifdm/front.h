/* front - what optimize.objectives asks for: designs of which none is better than another in all objectives. Levenberg-
 * Marquardt and the genetic algorithm hand over the same struct, which is stored, printed, compared and drawn.
 * Stability: internal; may change in any version.
 *
 * Objectives are the goals of optimize.objectives in their order and units; less is better. A point is marked where it
 * is no part of the front, and never left out. */
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
    X(DOMINATED, "dominated") /* another is */                                                                         \
    X(FAILED, "failed")       /* it has no feasible design; `status` says why */
#define HF_FRONT_ENUMERATOR(name, word) HF_FRONT_##name,
typedef enum { HF_FRONT_MARKS(HF_FRONT_ENUMERATOR) HF_FRONT_N_MARK } hf_front_mark;
#undef HF_FRONT_ENUMERATOR
extern const char *const hf_front_mark_word[HF_FRONT_N_MARK + 1]; /* the last is NULL */

typedef struct {
    double objective[HF_OBJECTIVES_MAX]; /* NaN of a failed point */
    /* The slope of the front: by how much objective `minimised` gets less for one unit more of each other objective, in
     * their units, >= 0; of `minimised` itself, and where the method knows none, NaN. */
    double multiplier[HF_OBJECTIVES_MAX];
    hf_status status; /* of its design */
    hf_front_mark mark;
    int iterations;    /* of Levenberg-Marquardt; of the genetic algorithm 0 */
    bool is_converged; /* Levenberg-Marquardt ended here because no step promised more; else it has no multiplier */
} hf_front_point;

typedef struct {
    int n_objective, n_gene, n_point;
    int minimised;                  /* the objective whose least is sought under limits on the others; -1: all */
    int knee;                       /* the point farthest below the line of the ends (hf_front_settle), or -1 */
    double base[HF_OBJECTIVES_MAX]; /* of the shape after form-finding; NaN where it has none */
    hf_front_point *point;          /* [n_point] ascending by objective 0, then 1, then 2; failed ones last */
    double *design;                 /* [n_point][n_gene] in the meaning of hf_evaluate; NaN of a failed point */
    void *block;                    /* owns point and design */
} hf_front;

/* A front without its designs, as a summary has it: n_row of n_point points. Of more than HF_FRONT_POINTS_MAX these are
 * the ends, the knee, and of the others as many as there is room for, evenly spaced in their order. */
typedef struct {
    int n_objective, n_point, n_row, n_on, n_dominated, n_failed, minimised;
    int knee, end[HF_OBJECTIVES_MAX]; /* rows: the knee, and the first point with the least of each objective; or -1 */
    double base[HF_OBJECTIVES_MAX];
    int n_unconverged; /* of Levenberg-Marquardt: points with a design that is not known to be an optimum */
    double wall_s;     /* of finding it */
    int place[HF_FRONT_POINTS_MAX]; /* of each row in the front, from 0, ascending */
    hf_front_point row[HF_FRONT_POINTS_MAX];
} hf_front_table;

/* A front of n_point points with all values 0. HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_front_create(int n_objective, int n_gene, int n_point, hf_front *front);
void hf_front_free(hf_front *front);

/* When objectives, designs and statuses are there: sort the points, mark those that are dominated (the later of two
 * that are equal, too) or have failed, and find the knee. */
void hf_front_settle(hf_front *front);

/* All of the table but the time; of a front that is settled. */
void hf_front_tabulate(const hf_front *front, hf_front_table *table);

/* Do the objectives not conflict: is one design best in all of them, as far as was found? */
bool hf_front_agrees(const hf_front_table *table);

/* The number, from 1, of a point to look at first: the knee, else an end; 0 where the front has none. */
int hf_front_suggested(const hf_front_table *table);

/* Is a as good as b in all objectives, and better in one? */
bool hf_front_dominates(int n_objective, const double *a, const double *b);

HF_API_END
#endif
