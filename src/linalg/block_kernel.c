/* The loops of dissection. block_kernel.h describes the interface. */
#define HF_LANE_VECTORS
#include "linalg/block_kernel.h"

enum { COLUMNS = 6 };

typedef vec row_vec __attribute__((aligned(8)));

/* Subtracts from n_vec vectors of each column. */
INLINE void subtract_rows(int n_vec, int n_term, const double *w, size_t ld, const double *a, size_t ld_a, double *to,
                          size_t ld_to)
{
    vec sum[COLUMNS][2];
    foreach (c, COLUMNS)
        foreach (v, n_vec)
            sum[c][v] = *(const row_vec *)(to + (size_t)c * ld_to + v * WIDTH);
    for (int k = 0; k < n_term; k++, w += ld, a += ld_a)
        foreach (c, COLUMNS) {
            vec by = splat(a[c]);
            foreach (v, n_vec)
                sum[c][v] = less_product(sum[c][v], *(const row_vec *)(w + v * WIDTH), by);
        }
    foreach (c, COLUMNS)
        foreach (v, n_vec)
            *(row_vec *)(to + (size_t)c * ld_to + v * WIDTH) = sum[c][v];
}

static void subtract(int n, int n_term, const double *w, size_t ld, const double *a, size_t ld_a, double *to,
                     size_t ld_to)
{
    int r = 0;
    for (; r + 2 * WIDTH <= n; r += 2 * WIDTH)
        subtract_rows(2, n_term, w + r, ld, a, ld_a, to + r, ld_to);
    for (; r < n; r += WIDTH)
        subtract_rows(1, n_term, w + r, ld, a, ld_a, to + r, ld_to);
}

static void spread(int n, const double *w, size_t ld, const double *x, double *to)
{
    int r = 0;
    for (; r + WIDTH <= n; r += WIDTH) {
        vec sum = *(const row_vec *)(to + r);
        foreach (k, COLUMNS)
            sum = less_product(sum, *(const row_vec *)(w + (size_t)k * ld + r), splat(x[k]));
        *(row_vec *)(to + r) = sum;
    }
    for (; r < n; r++)
        foreach (k, COLUMNS)
            to[r] = fma(-w[(size_t)k * ld + (size_t)r], x[k], to[r]);
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

const hf_block_kernels HF_KERNEL(hf_block_kernels) = {subtract, spread, dot};
