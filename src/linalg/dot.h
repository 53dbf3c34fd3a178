/* dot - inner products of vectors, summed in the order of the entries, and sums of multiples of vectors. */
#pragma once

#include <stddef.h>
#include <string.h>

double hf_dot(size_t n, const double *a, const double *b);

/* Computes dot [n_row]: the inner product of each row of a [n_row][lda] with b [n], with the bits of hf_dot. */
void hf_dots(size_t n_row, size_t n, const double *a, size_t lda, const double *b, double *dot);

/* Compute y += factor x and y -= factor x for vectors [n]. */
static inline void hf_add(size_t n, double factor, const double *restrict x, double *restrict y)
{
    for (size_t i = 0; i < n; i++)
        y[i] += factor * x[i];
}

static inline void hf_subtract(size_t n, double factor, const double *restrict x, double *restrict y)
{
    for (size_t i = 0; i < n; i++)
        y[i] -= factor * x[i];
}

/* Computes y = x for vectors [n]. If x is NULL, y becomes 0. */
static inline void hf_copy(size_t n, const double *restrict x, double *restrict y)
{
    if (x)
        memcpy(y, x, n * sizeof *y);
    else
        memset(y, 0, n * sizeof *y);
}
