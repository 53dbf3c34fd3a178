/* pareto - ranks designs with two or three objectives, and selects the designs to keep of a crowded front (METHOD
 * section 7). All objectives are minimised.
 *
 * Designs that break their limits come after all feasible designs, by their violation alone (Deb 2000). A design with
 * an objective or a violation that is not a number comes last, like a design without a shape. */
#pragma once

#include "base/arena.h"

#include <hifdm/front.h>
#include <hifdm/population.h>
#include <stdbool.h>

typedef struct {
    int n, n_objective;
    double *value;     /* [n][HF_FRONT_OBJECTIVES_MAX], objectives of each design */
    double *violation; /* [n], 0: feasible; INFINITY: without a shape */
    double *room;      /* [n], scratch */
    int *scratch;      /* [n][HF_PARETO_SCRATCH] */
} hf_pareto;

enum { HF_PARETO_SCRATCH = 2 * HF_FRONT_OBJECTIVES_MAX + 1 };

/* Lists the arrays of a hf_pareto whose n is set, for HF_ARENA_ARRAYS. */
#define HF_PARETO_ARRAYS(p)                                                                                            \
    HF_ARRAY((p).value, (size_t)(p).n *HF_FRONT_OBJECTIVES_MAX), HF_ARRAY((p).violation, (p).n),                       \
        HF_ARRAY((p).room, (p).n), HF_ARRAY((p).scratch, (size_t)(p).n *HF_PARETO_SCRATCH)

/* Sets the objectives [n_objective] and the violation of design i. */
void hf_pareto_set(hf_pareto *pareto, int i, const double *objective, double violation);

/* Returns the objectives of design i. */
static inline const double *hf_pareto_value(const hf_pareto *pareto, int i)
{
    return pareto->value + (size_t)i * HF_FRONT_OBJECTIVES_MAX;
}

/* Returns true if design a dominates design b: it is as good in all objectives and better in one, or its violation is
 * smaller. */
bool hf_pareto_dominates(const hf_pareto *pareto, int a, int b);

/* Computes rank [n]: 0 for designs that no other dominates, 1 for those that only designs of rank 0 dominate, and so
 * on. Returns the number of fronts. The method is the efficient non-dominated sort (Zhang, Tian, Cheng & Jin, IEEE
 * Trans. Evol. Comput. 19, 2015). It takes O(n log n) operations with two objectives, and at most O(n^2) with three. */
int hf_pareto_rank(const hf_pareto *pareto, int *rank);

/* Reorders member [n_member], the designs of one front, so that the first n_keep are those to keep. The design with the
 * minimum room between its neighbours is removed, again and again, so that the rest covers the front well. The ends of
 * each objective are removed last. An infeasible front keeps its order. The cost is at most O(n_member^2). */
void hf_pareto_keep(const hf_pareto *pareto, int n_member, int *member, int n_keep);

/* Makes the front of the feasible individuals of a population. No point of it dominates another, and no two are equal
 * in all objectives. Returns HF_OK or HF_NO_MEMORY; free the front in either case. */
hf_status hf_pareto_front(const hf_population *population, hf_front *front);
