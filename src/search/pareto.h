/* pareto - designs with two or three objectives, all to be least: in what order fronts follow each other, and which
 * designs of a crowded front to keep (METHOD section 7).
 *
 * Designs that are beyond their limits come after all that are within them, by their violation alone (Deb 2000). One of
 * which an objective or the violation is not a number comes last, as one without a shape does. */
#ifndef HIFDM_PARETO_H
#define HIFDM_PARETO_H

#include "base/arena.h"

#include <hifdm/front.h>
#include <hifdm/population.h>
#include <stdbool.h>

typedef struct {
    int n, n_objective;
    double *value;     /* [n][HF_OBJECTIVES_MAX] */
    double *violation; /* [n] 0: within the limits; INFINITY: without a shape */
    double *room;      /* [n] scratch */
    int *scratch;      /* [n][HF_PARETO_SCRATCH] */
} hf_pareto;

enum { HF_PARETO_SCRATCH = 2 * HF_OBJECTIVES_MAX + 1 };

/* Take the arrays of a struct whose sizes are set. */
void hf_pareto_lay_out(hf_arena *arena, hf_pareto *pareto);

/* The objectives [n_objective] and the violation of design i. */
void hf_pareto_set(hf_pareto *pareto, int i, const double *objective, double violation);

static inline const double *hf_pareto_value(const hf_pareto *pareto, int i)
{
    return pareto->value + (size_t)i * HF_OBJECTIVES_MAX;
}

/* Is design a as good as b in all objectives and better in one, or nearer to the limits? */
bool hf_pareto_dominates(const hf_pareto *pareto, int a, int b);

/* rank [n]: 0 of those that no other dominates, 1 of those that no other but these dominates, and so on. Returns the
 * number of fronts. Efficient non-dominated sort (Zhang, Tian, Cheng & Jin, IEEE Trans. Evol. Comput. 19, 2015):
 * O(n log n) with two objectives, at most O(n^2) with three. */
int hf_pareto_rank(const hf_pareto *pareto, int *rank);

/* Reorder member [n_member], designs of one front, so that the first n_keep are those that cover it best: one after the
 * other the design goes that has the least room between its neighbours. The ends of each objective stay while there is
 * room for anything. At most O(n_member^2). */
void hf_pareto_keep(const hf_pareto *pareto, int n_member, int *member, int n_keep);

/* The front of the feasible individuals of a population: none dominates another, and none is equal to another in all
 * objectives. HF_OK or HF_NO_MEMORY; free the front in either case. */
hf_status hf_pareto_front(const hf_population *population, hf_front *front);

#endif
