#include "linalg/dot.h"

enum { AT_ONCE = 8 };

double hf_dot(size_t n, const double *a, const double *b)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Computes eight sums at the same time, because each addition to a single sum waits for the one before. */
void hf_dots(size_t n_row, size_t n, const double *restrict a, size_t lda, const double *restrict b,
             double *restrict dot)
{
    size_t row = 0;
    for (; row + AT_ONCE <= n_row; row += AT_ONCE, a += AT_ONCE * lda) {
        double sum[AT_ONCE] = {0};
        for (size_t i = 0; i < n; i++)
            for (size_t k = 0; k < AT_ONCE; k++)
                sum[k] += a[k * lda + i] * b[i];
        for (size_t k = 0; k < AT_ONCE; k++)
            dot[row + k] = sum[k];
    }
    for (; row < n_row; row++, a += lda)
        dot[row] = hf_dot(n, a, b);
}
