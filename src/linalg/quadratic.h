/* quadratic - a strictly convex quadratic programme in a few hundred variables: the least of x'Hx/2 + g'x under linear
 * limits a'x >= b, by the dual method of Goldfarb and Idnani (Math. Program. 27, 1983): it starts at the free minimum
 * and takes in one violated limit after the other, so a caller names the worst limit instead of listing all. */
#ifndef HIFDM_QUADRATIC_H
#define HIFDM_QUADRATIC_H

#include <hifdm/status.h>
#include <stdbool.h>

/* One limit, normal' x >= bound. `kind` is the caller's. */
typedef struct {
    double *normal; /* [n] */
    int only;       /* its only entry that is not zero, as of a bound of a variable; -1: not known */
    double bound;
    int kind;
} hf_quadratic_limit;

/* A limit that holds with equality. */
typedef struct {
    int kind;          /* 0 of bounds that held the answer before */
    int only;          /* of its normal; -1: not known */
    double sign;       /* that entry, 1 or -1 of a bound of a variable */
    double bound;      /* normal' x */
    double multiplier; /* > 0 */
} hf_quadratic_active;

/* Write the limit that x violates most into *limit, whose `normal` is n zeros and `only` -1 on entry; false when x
 * violates none beyond rounding. */
typedef bool hf_quadratic_worst(void *context, const double *x, hf_quadratic_limit *limit);

typedef struct {
    int n, ld;                   /* ld: n, and as many more as make whole vectors */
    double *inverse;             /* [n][ld] scratch: columns J, with J J' = H^-1; 0 from n on */
    double *triangle;            /* [n][n] scratch: R, the active normals in terms of J */
    double *x;                   /* [ld] the answer; 0 from n on */
    int n_active;                /* limits that hold with equality */
    hf_quadratic_active *active; /* [n] */
    int *side;                   /* [n] the bound of each variable that held the last answer: 1 low, -1 high, 0 none */
    int *order;                  /* [n] of the variables in the factor: those held from the start are last */
    double *scratch;             /* [6 ld] */
    double *strip;               /* [n][HF_LANES] scratch: columns that are worked on side by side */
    void *block;
} hf_quadratic;

/* HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_quadratic_create(int n, hf_quadratic *quadratic);
void hf_quadratic_free(hf_quadratic *quadratic);

/* hessian [n][n]: its lower triangle by rows is read. low, high [n]: bounds of x, which `worst` names like any other
 * limit, of kind 0; those that held the last answer are where this one begins, so that a programme much like the last
 * one takes few steps. HF_OK; HF_SINGULAR when the hessian is not positive definite; HF_DIFFERENT when no x obeys all
 * limits. */
hf_status hf_quadratic_solve(hf_quadratic *quadratic, const double *hessian, const double *gradient, const double *low,
                             const double *high, hf_quadratic_worst *worst, void *context);

/* sum [ld] = weight[0] column 0 + weight[1] column 1 + ... of J [n][ld], added up in this order; ld: a multiple of
 * HF_LANES. */
void hf_quadratic_combine(int ld, int n, const double *weight, const double *J, double *sum);

#endif
