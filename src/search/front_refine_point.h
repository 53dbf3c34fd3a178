/* front_refine_point - finds one point of a Pareto front (METHOD section 7). It chooses the role of each objective and
 * the design from which a search begins. It finds the minimum under limits on the other objectives, and a design that
 * is best in all of them.
 *
 * Some objectives can be 0, such as evenness of tensions. Their size has no slope there that a limit could follow, but
 * their square has one. Such an objective is called `met`. */
#ifndef HIFDM_FRONT_REFINE_POINT_H
#define HIFDM_FRONT_REFINE_POINT_H

#include "search/front_refine.h"
#include "search/watch.h"

/* Sets role [n_objective]: first the objective to minimise, which is the first one without corners if there is one,
 * then the others in their order. */
void hf_front_refine_roles(const hf_objectives *objectives, int *role);

/* Finds the start with the minimum of objective k among the feasible starts. If none is feasible, *start is the first
 * one with a shape, or the first of all. largest [n_objective] rises to the maxima of the feasible starts. Returns
 * HF_OK or HF_NO_MEMORY. */
hf_status hf_front_refine_start(const hf_front_refine *task, int k, hf_workspace *w, double *largest,
                                const double **start);

/* Counts one more finished point for the watcher. */
void hf_front_refine_count(const hf_front_refine *task);

/* Returns the distance of two points, in parts of the ranges [n_objective] of the objectives. */
double hf_front_refine_distance(int n_objective, const double *range, const hf_front_point *a, const hf_front_point *b);

/* Finds one point by Levenberg-Marquardt from the design [n_variable], which is replaced. The point receives the status
 * of the design, its objectives and multipliers. Returns HF_OK, HF_NO_MEMORY or HF_INTERRUPTED. */
hf_status hf_front_refine_point(const hf_front_refine *task, const hf_watch_front *limits, double *design,
                                hf_workspace *w, hf_front_point *point);

/* Replaces the design [n_variable] by one that minimises the objective `least` while the objective `met` rises by about
 * 1e-8 of its range. It minimises the sum of their squares, with a decreasing weight of `least`. If met == least, it
 * minimises the sum of the squares of all objectives. range [n_objective] scales them. Returns HF_OK, also if the
 * design does not change, HF_NO_MEMORY or HF_INTERRUPTED. */
hf_status hf_front_refine_meet(const hf_front_refine *task, int met, int least, const double *range, double *design,
                               hf_workspace *w);

/* Returns the index of the point [n] whose objectives are all within `part` of their minima over the n points, or -1.
 * The differences are in parts of the range from the minimum to the maximum over the points and largest [n_objective].
 * Of several such points, it is the nearest to the minima. */
int hf_front_refine_common(int n_objective, int n, const hf_front_point *const *point, const double *largest,
                           double part);

#endif
