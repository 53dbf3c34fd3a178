/* Packs a band factor and solves with it:
 *
 *     L of hf_band_factor -> pack: divide by the diagonal, copy into blocks, find the skyline -> packed factor
 *     b [n_rhs][ldb] -> eight columns at a time into lanes -> kernel: forward, backward -> back into b
 *
 * Contents: the matrix - packing - solving */
#include "linalg/packed_band.h"

#include <stdbool.h>
#include <string.h>

/* ---- the matrix ---- */

static hf_packed_band_solve *const solve_of_isa[] = {HF_LANE_EACH(hf_packed_band_solve)};

hf_packed_band hf_packed_band_of(int n, int half_bandwidth)
{
    return (hf_packed_band){.n = n,
                            .n_block = (n + HF_PACKED_ROWS - 1) / HF_PACKED_ROWS,
                            .width = half_bandwidth,
                            .solve = solve_of_isa[hf_lane_best_isa()]};
}

void hf_packed_band_lay_out(hf_arena *arena, hf_packed_band *to)
{
    size_t n_block = (size_t)to->n_block, n = n_block * HF_PACKED_ROWS;
    HF_PACKED_BAND_FIELDS(HF_ARENA_TAKE)
}

/* ---- packing ---- */

static void pack_entries(hf_packed_band *b, const double *factor)
{
    const int rows = HF_PACKED_ROWS;
    int n = b->n, ld = b->width + 1, places = b->width + rows;
    for (int j = 0; j < n; j++)
        b->inverse_diagonal[j] = 1 / factor[(ptrdiff_t)j * ld];
    for (int j = 0; j < n; j++)
        for (int d = 1; d < ld && j + d < n; d++) {
            double value = factor[(ptrdiff_t)j * ld + d];
            int i = j + d, row_0 = i / rows * rows, column_0 = j / rows * rows;
            ptrdiff_t in_row = (ptrdiff_t)row_0 * places + (ptrdiff_t)(j - row_0 + b->width) * rows + i - row_0;
            ptrdiff_t in_column = (ptrdiff_t)column_0 * places + (ptrdiff_t)(i - column_0) * rows + j - column_0;
            b->row[in_row] = value * b->inverse_diagonal[i];
            b->column[in_column] = value * b->inverse_diagonal[j];
        }
}

/* Returns true if any entry of one packed row or column of a block is not zero. */
static bool has_entry(const double *packed)
{
    for (int r = 0; r < HF_PACKED_ROWS; r++)
        if (packed[r] != 0) return true;
    return false;
}

static void find_skyline(hf_packed_band *b)
{
    int places = b->width + HF_PACKED_ROWS;
    for (int k = 0; k < b->n_block; k++) {
        const double *row = b->row + (ptrdiff_t)k * places * HF_PACKED_ROWS;
        const double *column = b->column + (ptrdiff_t)k * places * HF_PACKED_ROWS;
        int begin = 0, end = places;
        while (begin < b->width && !has_entry(row + begin * HF_PACKED_ROWS))
            begin++;
        while (end > HF_PACKED_ROWS && !has_entry(column + (end - 1) * HF_PACKED_ROWS))
            end--;
        b->row_begin[k] = begin;
        b->column_end[k] = end;
    }
}

void hf_packed_band_pack(hf_packed_band *b, const double *factor)
{
    pack_entries(b, factor);
    find_skyline(b);
}

/* ---- solving ---- */

size_t hf_packed_band_rows(const hf_packed_band *b)
{
    return (size_t)b->n + 2 * (size_t)b->width + HF_PACKED_ROWS;
}

void hf_packed_band_back_solve(const hf_packed_band *m, double *lanes, int n_rhs, double *b, size_t ldb)
{
    double *rows = lanes + (size_t)m->width * HF_LANES;
    size_t n = (size_t)m->n;
    memset(rows, 0, (n + (size_t)m->width + HF_PACKED_ROWS) * HF_LANES * sizeof *rows);
    for (int first = 0; first < n_rhs; first += HF_LANES) {
        int n_lane = n_rhs - first < HF_LANES ? n_rhs - first : HF_LANES;
        double *column = b + (size_t)first * ldb;
        for (int k = 0; k < n_lane; k++)
            for (size_t i = 0; i < n; i++)
                rows[i * HF_LANES + (size_t)k] = column[(size_t)k * ldb + i];
        m->solve(m, lanes);
        for (int k = 0; k < n_lane; k++)
            for (size_t i = 0; i < n; i++)
                column[(size_t)k * ldb + i] = rows[i * HF_LANES + (size_t)k];
    }
}
