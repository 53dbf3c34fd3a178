/* quadratic - strictly convex quadratic programmes with a few hundred variables: the minimum of x'Hx/2 + g'x subject to
 * limits a'x >= b. The method is the dual method of Goldfarb and Idnani (Math. Program. 27, 1983). It starts at the
 * unconstrained minimum and adds one violated limit after the other. So the caller only has to find the limit that is
 * violated most; no list of all limits is needed. */
#pragma once

#include "base/arena.h"

#include <stdbool.h>

/* One limit, normal' x >= bound. `kind` belongs to the caller. */
typedef struct {
    double *normal; /* [n] */
    int only;       /* index of its only nonzero entry (a bound of a variable); -1: not known */
    double bound;
    int kind;
} hf_quadratic_limit;

/* An active limit: it holds with equality. */
typedef struct {
    int kind;          /* kind of the limit; 0 for bounds taken from the last solution */
    int only;          /* as in hf_quadratic_limit */
    double sign;       /* nonzero entry of the normal if only >= 0; 1 or -1 for a bound */
    double bound;      /* value of normal' x */
    double multiplier; /* never negative at a solution */
} hf_quadratic_active;

/* Writes the limit that x violates most into *limit and returns true. Returns false if x violates no limit beyond
 * rounding. On entry limit->normal is n zeros, and limit->only is -1. */
typedef bool hf_quadratic_worst(void *context, const double *x, hf_quadratic_limit *limit);

/* The arrays of a programme; ld is n rounded up to whole vectors. */
#define HF_QUADRATIC_FIELDS(X)                                                                                         \
    X(double, inverse, n *ld, "[n][ld] scratch: columns of J, with J J' = H^-1; 0 from row n on")                      \
    X(double, triangle, n *n, "[n][n] scratch: the factor of H, then R, the active normals in terms of J")             \
    X(double, x, ld, "the solution; 0 from n on")                                                                      \
    X(hf_quadratic_active, active, n, "the first n_active are in use")                                                 \
    X(int, side, n, "active bound in the last solution: 1 lower, -1 upper, 0 none")                                    \
    X(int, order, n, "order of the variables in the factor; those at a bound at the start are last")                   \
    X(double, scratch, 6 * ld, "")                                                                                     \
    X(double, strip, n *HF_LANES, "[n][HF_LANES] scratch: columns of L^-1 that are computed together")
typedef struct {
    int n, ld, n_active; /* n_active: limits that hold with equality */
    HF_QUADRATIC_FIELDS(HF_ARENA_MEMBER)
    void *block;
} hf_quadratic;

/* Allocates the arrays for n variables. Returns HF_OK or HF_NO_MEMORY. The caller frees its block. */
hf_status hf_quadratic_create(int n, hf_quadratic *quadratic);

/* Solves a programme. hessian [n][n]: the lower triangle is read, by rows. gradient [n]. low, high [n]: bounds of x.
 * `worst` must report these bounds like any other limit, with kind 0. The bounds that were active in the last solution
 * are active at the start, so that a similar programme takes few steps. The solution is quadratic->x. Returns HF_OK.
 * Returns HF_SINGULAR if the hessian is not positive definite. Returns HF_DIFFERENT if no x satisfies all limits, or if
 * the maximum number of steps is reached. */
hf_status hf_quadratic_solve(hf_quadratic *quadratic, const double *hessian, const double *gradient, const double *low,
                             const double *high, hf_quadratic_worst *worst, void *context);

/* Computes sum [ld] = weight[0] column 0 + weight[1] column 1 + ... of J [n][ld], added in this order. ld must be a
 * multiple of HF_LANES. */
void hf_quadratic_combine(int ld, int n, const double *weight, const double *J, double *sum);
