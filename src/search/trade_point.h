/* trade_point - one point of a front (METHOD section 7): which objective is least, where its search begins, the least
 * under limits on the others, one that is best in all, and objectives that are met, such as even tensions: the size of
 * these has no slope there that a limit could follow, their squares have. */
#ifndef HIFDM_TRADE_POINT_H
#define HIFDM_TRADE_POINT_H

#include "search/trade.h"
#include "search/watch.h"

/* role [n_goal]: the first objective without corners, if there is one, is what is least; the others follow in their
 * order. */
void hf_trade_roles(const hf_goals *goals, int *role);

/* Of the starts the one with the least objective k of those that are feasible, or of those that have a shape, or any.
 * largest [n_objective] rises to what the feasible ones have. HF_OK or HF_NO_MEMORY. */
hf_status hf_trade_start(const hf_trade *trade, int k, hf_workspace *w, double *largest, const double **start);

/* One more point is done. */
void hf_trade_count(const hf_trade *trade);

/* How far two points are from each other, in parts of the ranges [n_objective] of the objectives. */
double hf_trade_distance(int n_objective, const double *range, const hf_front_point *a, const hf_front_point *b);

/* Levenberg-Marquardt from the design [n_gene], which is replaced. The status of the design is in the point; HF_OK,
 * HF_NO_MEMORY or HF_INTERRUPTED. */
hf_status hf_trade_point(const hf_trade *trade, const hf_watch_trade *limits, double *design, hf_workspace *w,
                         hf_front_point *point);

/* To replace the design [n_gene]: the objective `least` while the objective `met` rises by some 1e-8 of its range, by
 * the least sum of their squares with less and less weight of the former; met == least: the least sum of the squares of
 * all objectives in parts of their ranges. range: of each objective. HF_OK, also where the design stays as it is;
 * HF_NO_MEMORY or HF_INTERRUPTED. */
hf_status hf_trade_meet(const hf_trade *trade, int met, int least, const double *range, double *design,
                        hf_workspace *w);

/* The point whose objectives are all within `part` of their least among these n, in parts of what each rises to there
 * and in largest [n_objective]; of several the nearest; -1: there is none. */
int hf_trade_common(int n_objective, int n, const hf_front_point *const *point, const double *largest, double part);

#endif
