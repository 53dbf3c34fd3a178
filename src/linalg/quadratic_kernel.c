/* The kernels of quadratic, compiled once for each instruction set.
 *
 *     invert    triangle L, columns of the unit matrix in strip -> four columns of L per pass -> columns of L^-1
 *     turn      columns of J, cosines and sines -> Givens rotations of neighbouring columns -> J, in place
 *     combine   columns of J, weights -> weighted sum of the columns */
#define HF_LANE_EIGHT
#include "linalg/quadratic_kernel.h"

#include <stddef.h>

enum { COLUMNS = 4, BLOCKS = 4 }; /* columns of L per pass over strip; blocks of eight rows processed together */

/* ---- the inverse of a triangle ---- */

/* Finishes rows k to k + n_column - 1 of strip, and subtracts their products from the rows below. */
INLINE void pass_columns(int n, int k, int n_column, const double *triangle, double *strip)
{
    const double *l[COLUMNS]; /* entry (i, k + c) of L is l[c][i] */
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

static void invert(int n, int first, const double *triangle, double *strip)
{
    int k = first;
    for (; k + COLUMNS <= n; k += COLUMNS)
        pass_columns(n, k, COLUMNS, triangle, strip);
    for (; k < n; k++)
        pass_columns(n, k, 1, triangle, strip);
}

/* ---- columns ---- */

/* Rotates the columns in n_block blocks of eight rows. Column i stays in registers and becomes column i + 1 of
 * the next pair. */
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

static void turn(int ld, int first, int last, const double *cosine, const double *sine, double *J)
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

static void combine(int ld, int first, int end, const double *weight, const double *J, double *sum)
{
    int row = 0;
    for (; row + BLOCKS * HF_LANES <= ld; row += BLOCKS * HF_LANES)
        combine_rows(BLOCKS, ld, first, end, weight, J + row, sum + row);
    for (; row < ld; row += HF_LANES)
        combine_rows(1, ld, first, end, weight, J + row, sum + row);
}

const hf_quadratic_kernels HF_KERNEL(hf_quadratic_kernels) = {invert, turn, combine};
