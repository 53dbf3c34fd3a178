/* directions - quasi-random samples of errors: Sobol's sequence in those directions that move the shape most, and
 * random numbers in all others (METHOD section 12).
 *
 * GSL's sequence has at most 40 dimensions. Normal errors may be turned: the dimensions are the leading right singular
 * vectors of the first-order answer. Uniform ones may not: the dimensions are the errors with the largest shares. */
#ifndef HIFDM_DIRECTIONS_H
#define HIFDM_DIRECTIONS_H

#include "built/covariance.h"

#include <gsl/gsl_qrng.h>

#define HF_DIRECTIONS_MAX 40

typedef struct {
    const hf_built_errors *errors;
    int n;        /* dimensions of the sequence */
    double *axis; /* [n_error][n] orthonormal columns; NULL: the dimensions are single errors */
    int *error;   /* [n] these errors */
    uint32_t shift[HF_DIRECTIONS_MAX];
    gsl_qrng *sequence; /* it has given the points before `next`: who asks in order pays for each of them once */
    long next;
    void *block;
} hf_directions;

/* HF_OK or HF_NO_MEMORY; free in any case. The same bits for any number of threads. */
hf_status hf_directions_find(const hf_built_errors *errors, const hf_covariance *covariance, int n_thread,
                             hf_directions *directions);
void hf_directions_free(hf_directions *directions);

/* Points `first` to first + count - 1 of the sequence, point [count][n], after a digital shift by the seed: numbers in
 * (0, 1). The same bits in whatever order they are asked for; by one thread at a time. */
void hf_directions_points(hf_directions *directions, long first, int count, double *point);

/* The numbers z of a sample, hf_built_errors_draw's where the point [n] has no say. */
void hf_directions_draw(const hf_directions *directions, long sample, const double *point, double *z);

#endif
