/* Triangular solves with a packed factor, compiled once for each instruction set:
 *
 *     lanes: right-hand sides -> forward solve, blocks in rising order -> backward solve, falling order -> solutions
 *
 * Both solves process a block of ROWS rows at a time. The rows of a block share the loads of the solved rows, and each
 * row has one accumulator. The edges need no code of their own, because zero rows precede and follow the right-hand
 * sides:
 *
 *     lanes   | width zero rows | n rows: right-hand sides, then solutions | width + ROWS rows |
 *
 * Up to ROWS - 1 rows after the last row are computed but not used. The order of operations in a lane is
 * always the same. Products are fused with the sums that they are added to (lane.h). So all instruction sets
 * give the same bits. */
#define HF_LANE_VECTORS
#include "linalg/packed_band.h"

#include <stddef.h>

enum { ROWS = HF_PACKED_ROWS };

/* Subtracts the product of the packed entries and `solved` from rows `first` to `last` of s. `packed` contains the
 * entries of the block in the column (forward) or row (backward) of the solved row. */
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

/* Solves the block of rows from j on. The most distant solved rows are subtracted first. */
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

/* Solves forward, then backward. All lanes of a block are processed before the next block, so that each solve reads the
 * packed factor once. */
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
