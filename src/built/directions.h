/* directions - quasi-random samples of errors (METHOD section 12). Sobol's sequence supplies the directions that
 * displace the net most, random numbers supply all others.
 *
 * GSL's sequence has at most 40 dimensions. Independent normal errors may be rotated. Their dimensions are the leading
 * right singular vectors of the linear model from errors to positions. Uniform errors may not be rotated, so their
 * dimensions are the single errors with the largest shares. */
#pragma once

#include "built/covariance.h"

#include <gsl/gsl_qrng.h>

#define HF_DIRECTIONS_MAX 40

typedef struct {
    const hf_built_errors *errors;
    int n;        /* dimensions of the sequence */
    double *axis; /* [n_error][n] orthonormal columns; NULL: the dimensions are single errors */
    int *error;   /* [n] the single errors */
    uint32_t shift[HF_DIRECTIONS_MAX];
    gsl_qrng *sequence; /* its next point is number `next`, so ascending requests cost one point each */
    long next;
    void *block;
} hf_directions;

/* Finds the dimensions. The result has the same bits for any number of threads. Returns HF_OK, HF_NO_MEMORY or
 * HF_INTERRUPTED; call hf_directions_free in any case. */
hf_status hf_directions_find(const hf_built_errors *errors, const hf_covariance *covariance, int n_thread,
                             hf_directions *directions);
void hf_directions_free(hf_directions *directions);

/* Computes the points first to first + count - 1 of the sequence into point [count][n]. Its numbers are in (0, 1),
 * after a digital shift by the seed. A point has the same bits in whatever order points are requested. Only one thread
 * at a time may call this. */
void hf_directions_points(hf_directions *directions, long first, int count, double *point);

/* Computes the numbers z of a sample. Those in the directions of the sequence come from its point [n], all others from
 * hf_built_errors_draw. */
void hf_directions_draw(const hf_directions *directions, long sample, const double *point, double *z);
