/* Factors symmetric band matrices of 6 x 6 blocks. block_band.h describes the interface.
 *
 *     for each block column: invert its pivot block P -> W = A P^-1 -> subtract W A' from the columns that follow
 *     solve: forward with L = W, multiply by P^-1, backward with L' */
#include "linalg/block_band.h"

#include "linalg/block_band_kernel.h"
#include "linalg/dense.h"

#include <math.h>
#include <string.h>

static const hf_block_band_kernels *const kernels_of_isa[] = {HF_LANE_EACH(&hf_block_band_kernels)};

hf_status hf_block_band_create(int n, int half_bandwidth, hf_block_band *to)
{
    if (half_bandwidth > n - 1) half_bandwidth = n - 1;
    *to = (hf_block_band){.n = n, .half_bandwidth = half_bandwidth, .ld = HF_BLOCK * (half_bandwidth + 1)};
    return HF_ARENA_ARRAYS(&to->block, HF_BLOCK_BAND_FIELDS(HF_ARENA_ITEM));
}

void hf_block_band_clear(hf_block_band *m)
{
    memset(m->band, 0, (size_t)m->n * HF_BLOCK * (size_t)m->ld * sizeof *m->band);
}

/* Computes the inverse of a pivot block, of which rows and columns are first scaled to entries of at most 1. Returns
 * false if it is singular. */
static bool invert(double p[HF_BLOCK][HF_BLOCK], double *inverse)
{
    double scaled[HF_BLOCK * HF_BLOCK], scale[HF_BLOCK];
    int pivot[HF_BLOCK];
    for (int r = 0; r < HF_BLOCK; r++) {
        double most = 0;
        for (int c = 0; c < HF_BLOCK; c++)
            most = fmax(most, fabs(p[r][c]));
        if (!(most > 0) || !isfinite(most)) return false;
        scale[r] = 1 / sqrt(most);
    }
    for (int r = 0; r < HF_BLOCK; r++)
        for (int c = 0; c < HF_BLOCK; c++) {
            scaled[HF_BLOCK * c + r] = scale[r] * p[r][c] * scale[c];
            inverse[HF_BLOCK * c + r] = r == c;
        }
    if (hf_dense_factor(HF_BLOCK, scaled, pivot)) return false;
    hf_dense_solve(HF_BLOCK, scaled, pivot, HF_BLOCK, inverse);
    for (int r = 0; r < HF_BLOCK; r++)
        for (int c = 0; c < HF_BLOCK; c++)
            inverse[HF_BLOCK * c + r] *= scale[r] * scale[c];
    return true;
}

/* Returns the number of rows below the diagonal block of block column j. */
static int rows_below(const hf_block_band *m, int j)
{
    int n = m->n - 1 - j;
    return HF_BLOCK * (n < m->half_bandwidth ? n : m->half_bandwidth);
}

hf_status hf_block_band_factor(hf_block_band *m)
{
    const hf_block_band_kernels *kernels = kernels_of_isa[hf_lane_best_isa()];
    size_t ld = (size_t)m->ld;
    for (int j = 0; j < m->n; j++) {
        double *column = m->band + HF_BLOCK * (size_t)j * ld, *below = column + HF_BLOCK, *w = m->scratch;
        double *inverse = m->inverse + HF_BLOCK * HF_BLOCK * (size_t)j, pivot[HF_BLOCK][HF_BLOCK];
        double minus[HF_BLOCK * HF_BLOCK];
        int n = rows_below(m, j);
        for (int r = 0; r < HF_BLOCK; r++)
            for (int c = 0; c < HF_BLOCK; c++)
                pivot[r][c] = column[(size_t)c * ld + (size_t)r];
        if (!invert(pivot, inverse)) return HF_SINGULAR;
        for (int k = 0; k < HF_BLOCK * HF_BLOCK; k++)
            minus[k] = -inverse[k];
        for (int c = 0; c < HF_BLOCK; c++)
            memset(w + (size_t)c * ld, 0, (size_t)n * sizeof *w);
        for (int c = 0; c < HF_BLOCK; c += 2)
            kernels->subtract(2, n, below, ld, minus + c, HF_BLOCK, w + (size_t)c * ld, ld);
        for (int i = 0; i < n; i += 2) {
            int first = i / HF_BLOCK * HF_BLOCK;
            double *to = m->band + (HF_BLOCK * (size_t)(j + 1) + (size_t)i) * ld;
            kernels->subtract(2, n - first, w + first, ld, below + i, ld, to, ld);
        }
        for (int c = 0; c < HF_BLOCK; c++)
            memcpy(below + (size_t)c * ld, w + (size_t)c * ld, (size_t)n * sizeof *w);
    }
    return HF_OK;
}

void hf_block_band_solve(const hf_block_band *m, double *x)
{
    const hf_block_band_kernels *kernels = kernels_of_isa[hf_lane_best_isa()];
    size_t ld = (size_t)m->ld;
    for (int j = 0; j < m->n; j++) {
        const double *below = m->band + HF_BLOCK * (size_t)j * ld + HF_BLOCK;
        double *at = x + HF_BLOCK * (ptrdiff_t)j;
        kernels->subtract(1, rows_below(m, j), below, ld, at, 1, at + HF_BLOCK, ld);
    }
    for (int j = m->n - 1; j >= 0; j--) {
        const double *below = m->band + HF_BLOCK * (size_t)j * ld + HF_BLOCK;
        const double *inverse = m->inverse + HF_BLOCK * HF_BLOCK * (size_t)j;
        double *at = x + HF_BLOCK * (ptrdiff_t)j, value[HF_BLOCK], sum[HF_BLOCK];
        memcpy(value, at, sizeof value);
        kernels->dot(rows_below(m, j), below, ld, at + HF_BLOCK, sum);
        for (int c = 0; c < HF_BLOCK; c++) {
            double product = 0;
            for (int k = 0; k < HF_BLOCK; k++)
                product += inverse[HF_BLOCK * c + k] * value[k];
            at[c] = product - sum[c];
        }
    }
}
