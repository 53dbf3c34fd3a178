/* packed_band - the Cholesky factor of a band matrix, packed for triangular solves with eight right-hand sides at a
 * time.
 *
 * The factor is packed in blocks of HF_PACKED_ROWS rows, in the order in which the kernels read it. For each block,
 * `row` contains the columns from `width` before its first row to its last row. `column` contains the rows from its
 * first row to `width` after its last row. The entries of the rows (columns) of a block are adjacent, with zeros
 * outside the band. Each entry is divided by the diagonal entry of its row (column). So a solve starts each row with
 * right-hand side / diagonal, and the row is finished after its last product; no division follows. */
#pragma once

#include "base/arena.h"
#include "base/lane.h"

#include <stddef.h>

#define HF_PACKED_ROWS 8 /* rows that are processed together */

struct hf_packed_band;

/* Solves in place for eight right-hand sides, one in each lane. lanes [hf_packed_band_rows][HF_LANES]; the rows before
 * and after the right-hand sides must be zero. packed_band_kernel.c is compiled once for each instruction set. All give
 * the same bits (base/lane.h). */
typedef void hf_packed_band_solve(const struct hf_packed_band *band, double *lanes);
hf_packed_band_solve HF_LANE_EACH(hf_packed_band_solve);

/* The arrays of a matrix `to` of n_block blocks, which have n rows together. */
#define HF_PACKED_BAND_FIELDS(X)                                                                                       \
    X(double, row, n *(size_t)(to->width + HF_PACKED_ROWS),                                                            \
      "[n_block][width + HF_PACKED_ROWS][HF_PACKED_ROWS], for the forward solve")                                      \
    X(double, column, n *(size_t)(to->width + HF_PACKED_ROWS), "the same for the backward solve")                      \
    X(double, inverse_diagonal, n, "0 from the number of rows on")                                                     \
    X(int, row_begin, n_block, "skyline: columns of a block before this one are zero in `row`")                        \
    X(int, column_end, n_block, "skyline: rows of a block from this one on are zero in `column`")

typedef struct hf_packed_band {
    int n, n_block, width;       /* rows, blocks of rows, half-bandwidth */
    hf_packed_band_solve *solve; /* the kernel for this machine */
    HF_PACKED_BAND_FIELDS(HF_ARENA_MEMBER)
} hf_packed_band;

/* hf_packed_band_of returns a matrix of n rows without arrays. hf_packed_band_lay_out takes the arrays from an arena;
 * they are freed with the arena. */
hf_packed_band hf_packed_band_of(int n, int half_bandwidth);
void hf_packed_band_lay_out(hf_arena *arena, hf_packed_band *band);

/* Packs a factor [n][half_bandwidth + 1] that hf_band_factor has computed (linalg/band.h). */
void hf_packed_band_pack(hf_packed_band *band, const double *factor);

/* Returns the number of rows of `lanes` that the kernel and hf_packed_band_back_solve need: the rows of the matrix and
 * zero rows before and after. */
size_t hf_packed_band_rows(const hf_packed_band *band);

/* Solves in place for n_rhs right-hand sides, b [n_rhs][ldb] with ldb >= n. lanes [hf_packed_band_rows][HF_LANES] is
 * scratch of the calling thread. Its first `width` rows must be zero. */
void hf_packed_band_back_solve(const hf_packed_band *band, double *lanes, int n_rhs, double *b, size_t ldb);
