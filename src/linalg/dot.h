/* dot - the inner product of two vectors, summed in the order of their entries. */
#ifndef HIFDM_DOT_H
#define HIFDM_DOT_H

#include <stddef.h>

double hf_dot(size_t n, const double *a, const double *b);

#endif
