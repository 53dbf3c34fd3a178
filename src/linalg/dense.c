#include "linalg/dense.h"

#include "linalg/dot.h"

#include <math.h>
#include <string.h>

static void swap(double *a, double *b)
{
    double kept = *a;
    *a = *b;
    *b = kept;
}

void hf_dense_multiply(int n, const double *a, const double *b, double *c)
{
    memset(c, 0, (size_t)n * (size_t)n * sizeof *c);
    for (int j = 0; j < n; j++)
        for (int k = 0; k < n; k++)
            hf_subtract((size_t)n, -b[j * n + k], a + k * n, c + j * n);
}

int hf_dense_factor(int n, double *a, int *pivot)
{
    for (int k = 0; k < n; k++) {
        double *column = a + k * n;
        int best = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(column[i]) > fabs(column[best])) best = i;
        pivot[k] = best;
        if (!(fabs(column[best]) > 0)) return k + 1;
        for (int j = 0; j < n && best != k; j++)
            swap(a + j * n + k, a + j * n + best);
        double inverse = 1 / column[k];
        for (int i = k + 1; i < n; i++)
            column[i] *= inverse;
        for (int j = k + 1; j < n; j++)
            hf_subtract((size_t)(n - k - 1), a[j * n + k], column + k + 1, a + j * n + k + 1);
    }
    return 0;
}

void hf_dense_solve(int n, const double *factor, const int *pivot, int n_rhs, double *b)
{
    for (int r = 0; r < n_rhs; r++, b += n) {
        for (int k = 0; k < n; k++)
            swap(b + k, b + pivot[k]);
        for (int k = 0; k < n; k++)
            hf_subtract((size_t)(n - k - 1), b[k], factor + k * n + k + 1, b + k + 1);
        for (int k = n - 1; k >= 0; k--) {
            b[k] /= factor[k * n + k];
            hf_subtract((size_t)k, b[k], factor + k * n, b);
        }
    }
}
