/* packed_band - the Cholesky factor of a band matrix, packed for triangular solves of eight right-hand sides at a time.
 *
 * The factor is packed by blocks of HF_PACKED_ROWS rows, in the order in which the kernels read it. `row` has for each
 * block the columns from `width` before its first row to its last row; `column` has the rows from its first to `width`
 * after its last. The entries of the block's rows (columns) stand beside each other, zeros where the band ends. Each is
 * divided by the diagonal entry of its row (column). A row that begins as right-hand side / diagonal is then finished
 * by its last product. */
#ifndef HIFDM_PACKED_BAND_H
#define HIFDM_PACKED_BAND_H

#include "base/arena.h"
#include "base/lane.h"
#include "linalg/packed_band_kernel.h"

#include <stddef.h>

#define HF_PACKED_ROWS 8 /* rows that are worked on at a time */

typedef struct hf_packed_band {
    int n, n_block, width;       /* rows, their blocks, half-bandwidth */
    double *row, *column;        /* [n_block][width + HF_PACKED_ROWS][HF_PACKED_ROWS] factor, forward and backward */
    double *inverse_diagonal;    /* [n_block HF_PACKED_ROWS] */
    int *row_begin;              /* [n_block] skyline: the first place in a block of `row` that is not all zero, */
    int *column_end;             /* [n_block] and behind the last one of `column` */
    hf_packed_band_solve *solve; /* the kernel for this machine */
} hf_packed_band;

/* Returns a matrix of n rows without memory: hf_packed_band_lay_out takes it from an arena, and it needs no other
 * freeing. */
hf_packed_band hf_packed_band_of(int n, int half_bandwidth);
void hf_packed_band_lay_out(hf_arena *arena, hf_packed_band *band);

/* Packs a factor [n][half_bandwidth + 1] as hf_band_factor leaves it (linalg/band.h). */
void hf_packed_band_pack(hf_packed_band *band, const double *factor);

/* Returns the rows of `lanes` for the kernel and for hf_packed_band_back_solve: those of the matrix and zero rows. */
size_t hf_packed_band_rows(const hf_packed_band *band);

/* Solves in place for n_rhs right-hand sides, b [n_rhs][ldb] with ldb >= n. lanes [hf_packed_band_rows][HF_LANES] is
 * scratch of the calling thread whose first `width` rows are zero. */
void hf_packed_band_back_solve(const hf_packed_band *band, double *lanes, int n_rhs, double *b, size_t ldb);

#endif
