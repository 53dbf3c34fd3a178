/* The kernels of quadratic, compiled once for each instruction set. */
#define HF_LANE_EIGHT
#include "linalg/quadratic_kernel.h"

#include "base/lane.h"

#include <stddef.h>

enum { COLUMNS = 4, BLOCKS = 4 }; /* of L, whose entries pass once for all of them; of eight rows, side by side */

/* ---- the inverse of a triangle ---- */

/* Finish rows k and on, n_column of them, and take them off the rows below. */
INLINE void pass_columns(int n, int k, int n_column, const double *triangle, double *strip)
{
    const double *l[COLUMNS]; /* entry (i, k + c) is l[c][i] */
    lanes x[COLUMNS];
    for (int c = 0; c < n_column; c++) {
        l[c] = triangle + (ptrdiff_t)(k + c) * n - (k + c);
        x[c] = lanes_load(strip + HF_LANES * (k + c));
        for (int b = 0; b < c; b++)
            x[c] -= x[b] * l[b][k + c];
        x[c] /= l[c][k + c];
        lanes_store(strip + HF_LANES * (k + c), x[c]);
    }
    for (int i = k + n_column; i < n; i++) {
        lanes rest = lanes_load(strip + HF_LANES * i);
        for (int c = 0; c < n_column; c++)
            rest -= x[c] * l[c][i];
        lanes_store(strip + HF_LANES * i, rest);
    }
}

void HF_KERNEL(hf_quadratic_invert)(int n, int first, const double *triangle, double *strip)
{
    int k = first;
    for (; k + COLUMNS <= n; k += COLUMNS)
        pass_columns(n, k, COLUMNS, triangle, strip);
    for (; k < n; k++)
        pass_columns(n, k, 1, triangle, strip);
}

/* ---- columns ---- */

/* Column i + 1 stays in registers while it becomes the first of the next pair. */
INLINE void turn_rows(int n_block, int ld, int first, int last, const double *cosine, const double *sine, double *J)
{
    lanes v[BLOCKS];
    for (int b = 0; b < n_block; b++)
        v[b] = lanes_load(J + (ptrdiff_t)(last + 1) * ld + HF_LANES * b);
    for (int i = last; i >= first; i--) {
        double *column = J + (ptrdiff_t)i * ld;
        for (int b = 0; b < n_block; b++) {
            lanes u = lanes_load(column + HF_LANES * b);
            lanes_store(column + ld + HF_LANES * b, cosine[i] * v[b] - sine[i] * u);
            v[b] = cosine[i] * u + sine[i] * v[b];
        }
    }
    for (int b = 0; b < n_block; b++)
        lanes_store(J + (ptrdiff_t)first * ld + HF_LANES * b, v[b]);
}

void HF_KERNEL(hf_quadratic_turn)(int ld, int first, int last, const double *cosine, const double *sine, double *J)
{
    int row = 0;
    if (last < first) return;
    for (; row + BLOCKS * HF_LANES <= ld; row += BLOCKS * HF_LANES)
        turn_rows(BLOCKS, ld, first, last, cosine, sine, J + row);
    for (; row < ld; row += HF_LANES)
        turn_rows(1, ld, first, last, cosine, sine, J + row);
}

INLINE void combine_rows(int n_block, int ld, int first, int end, const double *weight, const double *J, double *sum)
{
    lanes total[BLOCKS];
    for (int b = 0; b < n_block; b++)
        total[b] = (lanes){0};
    for (int j = first; j < end; j++)
        for (int b = 0; b < n_block; b++)
            total[b] += weight[j] * lanes_load(J + (ptrdiff_t)j * ld + HF_LANES * b);
    for (int b = 0; b < n_block; b++)
        lanes_store(sum + HF_LANES * b, total[b]);
}

void HF_KERNEL(hf_quadratic_combine)(int ld, int first, int end, const double *weight, const double *J, double *sum)
{
    int row = 0;
    for (; row + BLOCKS * HF_LANES <= ld; row += BLOCKS * HF_LANES)
        combine_rows(BLOCKS, ld, first, end, weight, J + row, sum + row);
    for (; row < ld; row += HF_LANES)
        combine_rows(1, ld, first, end, weight, J + row, sum + row);
}
