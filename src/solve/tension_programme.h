/* tension_programme - linear programmes in the tensions that hold a net at its target positions (METHOD section 11).
 *
 * At fixed positions equilibrium is linear in the tensions, A T + P = 0 (prestress.h). With a few shared variables y
 * the programme is
 *
 *     minimise  c'y   subject to   A T + P = 0,   lower <= T <= upper,   sign T + g'y >= h for each row
 *
 * A row has one cable. The method is the primal-dual interior-point method of Mehrotra (SIAM J. Optim. 2, 1992). Each
 * iteration factors one band matrix, that of a net of linear springs, and takes one more solution for each shared
 * variable. From 10 to 20 iterations suffice, so a net of 1500 nodes takes less than a second. A general simplex method
 * takes minutes, because most vertices of such programmes are degenerate. */
#pragma once

#include <hifdm/model.h>

#define HF_TENSION_SHARED_MAX 20 /* maximum number of shared variables */

/* One row: sign T of the cable + by[0] y[shared[0]] + by[1] y[shared[1]] >= bound_N. A negative index means none. */
typedef struct {
    int cable;
    double sign, bound_N;
    int shared[2];
    double by[2];
} hf_tension_row;

/* A programme. It borrows its arrays. lower_N must be finite. lower_N == upper_N fixes a tension. */
typedef struct {
    const hf_model *model;
    const double *lower_N, *upper_N; /* [n_cable] bounds; the upper ones may be infinite */
    const double *start_N;           /* [n_cable] tensions with which the iteration starts */
    const bool *is_open;             /* [n_free] rows of nodes that need no equilibrium; NULL: none */
    int n_row, n_shared;
    const hf_tension_row *row; /* [n_row] */
    const double *cost;        /* [n_shared] c */
    double enough_N;           /* stops as soon as y[0] is at most this; -INFINITY: at the minimum */
} hf_tension_programme;

/* Solves a programme. shared_N [n_shared] receives y, with errors of about 1e-6 of the reference tension. multiplier
 * [n_row] receives the multipliers of the rows, which are not negative (NULL: not needed). Returns HF_OK.
 * Returns HF_NOT_CONVERGED if no tensions within the bounds hold the net, if c'y has no minimum, or if rounding hides
 * the answer. Returns HF_NO_MEMORY. */
hf_status hf_tension_programme_solve(const hf_tension_programme *programme, double *shared_N, double *multiplier);
