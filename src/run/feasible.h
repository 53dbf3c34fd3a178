/* feasible - finds limits on tensions that no design at the target positions can meet, before a search (METHOD section
 * 11).
 *
 *     limits that the initial design breaks (none: all is well, and nothing is computed)
 *         |
 *         v
 *     tensions that designs can have: fixed by a law, within bounds of a design variable, or free above zero
 *         | linear programme: minimum amount by which the limits must be loosened
 *         v
 *     0: no warning;  otherwise the best value of each limit alone, or the limits that contradict each other
 *         | form.prestress: exact: solved again with other pretensions
 *         v
 *     advice: pretension with which the initial design meets all limits
 *
 * Links between design variables are ignored, and the tensions of cables that keep a length are free. Nodes at supports
 * that designs displace need no equilibrium. So a warning never appears because of such a simplification. If no
 * tensions at all hold the net at its target positions, there is nothing to compare, and no warning either. */
#pragma once

#include <hifdm/problem.h>

/* A bound on the tensions of a set of cables, from optimize.limits or `requirements`. An open bound is infinite. */
typedef struct {
    const char *list; /* list of the case, "optimize.limits"; or a key if row is below 0 */
    int row;          /* row of the list */
    const char *set;  /* name of the cables; "" means all */
    int n_cable;
    const int *cable;        /* [n_cable] */
    double lower_N, upper_N; /* bounds on each tension */
    double ratio;            /* bound on maximum over minimum tension */
} hf_feasible_bound;

#define HF_FEASIBLE_BOUNDS_MAX 64 /* maximum number of bounds */
#define HF_FEASIBLE_ADVICE_SIZE 160

/* Warns about bounds that no design at the target positions can meet. The problem has its initial design, and its
 * workspace has the shape of that. `source` is that of hf_problem_load. If the initial design breaks a bound, advice
 * receives what to change, such as "raise form.pretension_N to 20.8 N, at which the initial design meets all limits",
 * or "" if no pretension is known to help. Returns HF_OK or HF_NO_MEMORY, with a message. */
hf_status hf_feasible_check_bounds(const hf_problem *problem, const hf_problem_source *source, int n_bound,
                                   const hf_feasible_bound *bound, char advice[HF_FEASIBLE_ADVICE_SIZE],
                                   hf_messages *messages);

/* Does the same for the bounds on tensions by optimize.limits, optimize.boundary_ratio_cap and the rows of
 * `requirements` on the nominal net. */
hf_status hf_feasible_check(const hf_problem *problem, const hf_problem_source *source,
                            char advice[HF_FEASIBLE_ADVICE_SIZE], hf_messages *messages);
