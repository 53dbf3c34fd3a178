/* The loops of block_band. block_band_kernel.h describes the interface. */
#define HF_LANE_VECTORS
#include "linalg/block_band_kernel.h"

enum { COLUMNS = 6 };

typedef vec row_vec __attribute__((aligned(8)));

INLINE void subtract_columns(int n_column, int n, const double *w, size_t ld, const double *a, size_t ld_a, double *to,
                             size_t ld_to)
{
    vec by[2][COLUMNS];
    int r = 0;
    foreach (c, n_column)
        foreach (k, COLUMNS)
            by[c][k] = splat(a[(size_t)k * ld_a + (size_t)c]);
    for (; r + WIDTH <= n; r += WIDTH) {
        vec sum[2];
        foreach (c, n_column)
            sum[c] = *(const row_vec *)(to + (size_t)c * ld_to + r);
        foreach (k, COLUMNS) {
            vec of_w = *(const row_vec *)(w + (size_t)k * ld + r);
            foreach (c, n_column)
                sum[c] = less_product(sum[c], of_w, by[c][k]);
        }
        foreach (c, n_column)
            *(row_vec *)(to + (size_t)c * ld_to + r) = sum[c];
    }
    for (; r < n; r++)
        foreach (c, n_column) {
            double *at = to + (size_t)c * ld_to + r;
            foreach (k, COLUMNS)
                *at = fma(-w[(size_t)k * ld + (size_t)r], a[(size_t)k * ld_a + (size_t)c], *at);
        }
}

static void subtract(int n_column, int n, const double *w, size_t ld, const double *a, size_t ld_a, double *to,
                     size_t ld_to)
{
    if (n_column == 2)
        subtract_columns(2, n, w, ld, a, ld_a, to, ld_to);
    else
        subtract_columns(1, n, w, ld, a, ld_a, to, ld_to);
}

/* Eight accumulators for each column: row r belongs to accumulator r mod 8, whatever the width of a vector is. */
static void dot(int n, const double *w, size_t ld, const double *x, double *to)
{
    foreach (k, COLUMNS) {
        const double *column = w + (size_t)k * ld;
        double lane[HF_LANES];
        vec sum[PARTS];
        int r = 0;
        foreach (p, PARTS)
            sum[p] = splat(0);
        for (; r + HF_LANES <= n; r += HF_LANES)
            foreach (p, PARTS)
                sum[p] = plus_product(sum[p], *(const row_vec *)(column + r + p * WIDTH),
                                      *(const row_vec *)(x + r + p * WIDTH));
        foreach (p, PARTS)
            *(row_vec *)(lane + p * WIDTH) = sum[p];
        for (int i = 0; r < n; r++, i++)
            lane[i] = fma(column[r], x[r], lane[i]);
        to[k] = ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
    }
}

const hf_block_band_kernels HF_KERNEL(hf_block_band_kernels) = {subtract, dot};
