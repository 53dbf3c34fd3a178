/* dot - the inner product of two vectors, summed in the order of their entries. */
#ifndef HIFDM_DOT_H
#define HIFDM_DOT_H

#include <stddef.h>

double hf_dot(size_t n, const double *a, const double *b);

/* dot [n_row]: the same of each row of a [n_row][lda] with b [n], and the same bits. */
void hf_dots(size_t n_row, size_t n, const double *a, size_t lda, const double *b, double *dot);

#endif
