/* block_band - symmetric quasi-definite band matrices of 6 x 6 blocks: factor L D L' without exchange of blocks, and
 * solve. A matrix [X M; M' -G] with positive semidefinite X and G has such a factor in any order of its blocks if M
 * restricted to the first blocks is nonsingular there (Vanderbei, SIAM J. Optim. 5, 1995). D has the pivot blocks.
 *
 * Column c of the matrix is at band[c * ld], from the first row of its block on: entry (r,c) is at
 * band[c * ld + r - 6 (c / 6)]. Rows of the diagonal block above the diagonal are read, too. */
#pragma once

#include "base/arena.h"

#include <stdbool.h>

#define HF_BLOCK 6

#define HF_BLOCK_BAND_FIELDS(X)                                                                                        \
    X(double, band, (size_t)to->n *HF_BLOCK *(size_t)to->ld, "the matrix, then L")                                     \
    X(double, inverse, (size_t)to->n *HF_BLOCK *HF_BLOCK, "[n][6][6] inverses of the pivot blocks")                    \
    X(double, scratch, HF_BLOCK *(size_t)to->ld, "")
typedef struct {
    int n, half_bandwidth; /* in blocks */
    int ld;                /* 6 (half_bandwidth + 1) */
    HF_BLOCK_BAND_FIELDS(HF_ARENA_MEMBER)
    void *block;
} hf_block_band;

/* Allocates a matrix of n blocks, all entries 0. Returns HF_OK or HF_NO_MEMORY. The caller frees its block. */
hf_status hf_block_band_create(int n, int half_bandwidth, hf_block_band *matrix);

/* Sets all entries to 0. */
void hf_block_band_clear(hf_block_band *matrix);

/* Adds a block to block (i,j) of the matrix, i >= j. */
static inline void hf_block_band_add(hf_block_band *matrix, int i, int j, double block[HF_BLOCK][HF_BLOCK])
{
    for (int c = 0; c < HF_BLOCK; c++) {
        double *column = matrix->band + (size_t)(HF_BLOCK * j + c) * (size_t)matrix->ld + HF_BLOCK * (i - j);
        for (int r = 0; r < HF_BLOCK; r++)
            column[r] += block[r][c];
    }
}

/* Replaces the matrix by its factor. Returns HF_OK, or HF_SINGULAR if a pivot block is singular. */
hf_status hf_block_band_factor(hf_block_band *matrix);

/* Replaces x [6 n] by the solution. */
void hf_block_band_solve(const hf_block_band *factor, double *x);
