/* Both triangular solves take ROWS rows at a time, a block. The rows of a block share the loads of what is already
 * solved, and each row has one accumulator. Edges need no code of their own, because zero rows stand before and after
 * the right-hand sides:
 *
 *     lanes   | width zero rows | n rows: right-hand sides, then solutions | width + ROWS rows |
 *
 * Up to ROWS - 1 rows after the last are computed without being used. The order of operations in a lane is always the
 * same, and products are fused with the sums that they go into (lane.h), so all instruction sets give the same bits. */
#define HF_LANE_VECTORS
#include "linalg/packed_band_kernel.h"

#include "base/lane.h"
#include "linalg/packed_band.h"

#include <stddef.h>

enum { ROWS = HF_PACKED_ROWS };

/* WIDTH lanes of a row, from lane p on. */
INLINE vec *lanes_of(double *rows, ptrdiff_t row, int p)
{
    return (vec *)(void *)(rows + row * HF_LANES + p);
}

/* s[r] less the products of row k of a packed block with what is solved there, from row `first` to row `last`. */
INLINE void eliminate(vec s[ROWS], const double *packed, int first, int last, vec solved)
{
    foreach (r, ROWS)
        if (first <= r && r <= last) s[r] = less_product(s[r], splat(packed[r]), solved);
}

INLINE void begin_rows(const hf_packed_band *band, double *rows, int j, int p, vec s[ROWS])
{
    foreach (r, ROWS)
        s[r] = *lanes_of(rows, j + r, p) * band->inverse_diagonal[j + r];
}

INLINE void forward(const hf_packed_band *band, double *rows, int j, int p)
{
    int w = band->width;
    const double *packed = band->row + (ptrdiff_t)j * (w + ROWS);
    vec s[ROWS];
    begin_rows(band, rows, j, p, s);
    for (int k = band->row_begin[j / ROWS]; k < w; k++)
        eliminate(s, packed + k * ROWS, 0, ROWS - 1, *lanes_of(rows, j - w + k, p));
    foreach (k, ROWS) {
        *lanes_of(rows, j + k, p) = s[k];
        eliminate(s, packed + (w + k) * ROWS, k + 1, ROWS - 1, s[k]);
    }
}

/* The farthest rows come first. */
INLINE void backward(const hf_packed_band *band, double *rows, int j, int p)
{
    const double *packed = band->column + (ptrdiff_t)j * (band->width + ROWS);
    vec s[ROWS];
    begin_rows(band, rows, j, p, s);
    for (int k = band->column_end[j / ROWS] - 1; k >= ROWS; k--)
        eliminate(s, packed + k * ROWS, 0, ROWS - 1, *lanes_of(rows, j + k, p));
    foreach (i, ROWS) {
        int k = ROWS - 1 - i;
        *lanes_of(rows, j + k, p) = s[k];
        eliminate(s, packed + k * ROWS, 0, k - 1, s[k]);
    }
}

/* Both halves of a block of rows before the next one, so that the matrix is read once. */
void HF_KERNEL(hf_packed_band_solve)(const hf_packed_band *band, double *lanes)
{
    double *rows = lanes + band->width * HF_LANES;
    for (int j = 0; j < band->n; j += ROWS)
        for (int p = 0; p < HF_LANES; p += WIDTH)
            forward(band, rows, j, p);
    for (int j = (band->n - 1) / ROWS * ROWS; j >= 0; j -= ROWS)
        for (int p = 0; p < HF_LANES; p += WIDTH)
            backward(band, rows, j, p);
}
