/* Quasi-definite band matrices of 6 x 6 blocks against dense LU, over random sizes. */
#include "support.h"

#include "linalg/block_band.h"
#include "linalg/block_band_kernel.h"
#include "linalg/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_BLOCKS = 9, MAX_N = HF_BLOCK * MAX_BLOCKS };

/* Sums random positive definite springs between near nodes and to the ground. The sum is positive definite. */
static void draw_spd(int n, int width, double *a, struct rng *rng)
{
    memset(a, 0, MAX_N * MAX_N / 4 * sizeof *a);
    for (int i = 0; i < n; i++)
        for (int j = i; j < n && j <= i + width; j++) {
            double u[3];
            for (int c = 0; c < 3; c++)
                u[c] = rng_uniform(rng, -1, 1);
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++) {
                    double k = u[r] * u[c] + 0.1 * (r == c);
                    a[(3 * i + r) * MAX_N / 2 + 3 * i + c] += k;
                    a[(3 * j + r) * MAX_N / 2 + 3 * j + c] += i == j ? 0 : k;
                    if (i == j) continue;
                    a[(3 * i + r) * MAX_N / 2 + 3 * j + c] -= k;
                    a[(3 * j + r) * MAX_N / 2 + 3 * i + c] -= k;
                }
        }
}

/* [X M; M -G], where X and G are zero in some runs. */
START_TEST(factor_and_solution)
{
    struct rng rng = rng_start((uint64_t)_i);
    static double part[3][MAX_N * MAX_N / 4], dense[MAX_N * MAX_N], kept[MAX_N * MAX_N];
    int n = 1 + (int)rng_uniform(&rng, 0, MAX_BLOCKS), width = (int)rng_uniform(&rng, 0, 5), pivot[MAX_N];
    double share[2] = {_i % 3 == 0 ? 0 : pow(10, rng_uniform(&rng, -6, 6)),
                       _i % 4 == 0 ? 0 : pow(10, rng_uniform(&rng, -6, 6))};
    double x[MAX_N], b[MAX_N], right[MAX_N];
    hf_block_band band;
    for (int k = 0; k < 3; k++)
        draw_spd(n, width, part[k], &rng);
    ck_assert_int_eq(hf_block_band_create(n, width, &band), HF_OK);
    hf_block_band_clear(&band);
    memset(dense, 0, sizeof dense);
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double block[HF_BLOCK][HF_BLOCK];
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++) {
                    int at = (3 * i + r) * MAX_N / 2 + 3 * j + c;
                    block[r][c] = share[0] * part[0][at];
                    block[r][3 + c] = block[3 + r][c] = part[1][at];
                    block[3 + r][3 + c] = -share[1] * part[2][at];
                }
            if (i - j <= band.half_bandwidth) hf_block_band_add(&band, i, j, block);
            for (int r = 0; r < HF_BLOCK; r++)
                for (int c = 0; c < HF_BLOCK; c++) {
                    dense[(HF_BLOCK * j + c) * HF_BLOCK * n + HF_BLOCK * i + r] = block[r][c];
                    dense[(HF_BLOCK * i + r) * HF_BLOCK * n + HF_BLOCK * j + c] = block[r][c];
                }
        }
    n *= HF_BLOCK;
    memcpy(kept, dense, sizeof kept);
    for (int i = 0; i < n; i++)
        x[i] = b[i] = right[i] = rng_uniform(&rng, -1, 1);
    ck_assert_int_eq(hf_block_band_factor(&band), HF_OK);
    hf_block_band_solve(&band, x);
    ck_assert_int_eq(hf_dense_factor(n, dense, pivot), 0);
    hf_dense_solve(n, dense, pivot, 1, b);
    double largest = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, fabs(b[i]));
    /* The condition is up to 1e7 times that of the parts. */
    for (int i = 0; i < n; i++)
        ck_assert_double_eq_tol(x[i], b[i], 1e-6 * largest);
    for (int i = 0; i < n; i++) { /* a small residual, compared with its terms */
        double sum = right[i], terms = fabs(right[i]);
        for (int j = 0; j < n; j++) {
            sum -= kept[j * n + i] * x[j];
            terms += fabs(kept[j * n + i] * x[j]);
        }
        ck_assert_double_le(fabs(sum), 1e-8 * terms);
    }
    hf_arena_free_block(band.block);
}
END_TEST

/* All lengths up to some vectors, so that the rows after the last whole vector count, too. */
START_TEST(all_instruction_sets_give_the_same_bits)
{
    static const hf_block_band_kernels *const of_isa[] = {HF_LANE_EACH(&hf_block_band_kernels)};
    enum { LD = 40 };
    struct rng rng = rng_start((uint64_t)_i);
    double w[HF_BLOCK * LD], a[HF_BLOCK * 2], x[LD], start[2 * LD];
    for (int i = 0; i < HF_BLOCK * LD; i++)
        w[i] = rng_uniform(&rng, -1, 1);
    for (int i = 0; i < 2 * LD; i++)
        start[i] = rng_uniform(&rng, -1, 1);
    for (int i = 0; i < LD; i++)
        x[i] = rng_uniform(&rng, -1, 1);
    for (int i = 0; i < 2 * HF_BLOCK; i++)
        a[i] = rng_uniform(&rng, -1, 1);
    for (int n = 0; n <= LD; n++) {
        double to[HF_LANE_N_ISA][2 * LD], one[HF_LANE_N_ISA][2 * LD], dot[HF_LANE_N_ISA][HF_BLOCK];
        for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
            if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
            memcpy(to[isa], start, sizeof start);
            memcpy(one[isa], start, sizeof start);
            of_isa[isa]->subtract(2, n, w, LD, a, 2, to[isa], LD);
            of_isa[isa]->subtract(1, n, w, LD, a, 2, one[isa], LD);
            of_isa[isa]->dot(n, w, LD, x, dot[isa]);
            ck_assert_mem_eq(to[isa], to[0], sizeof *to);
            ck_assert_mem_eq(one[isa], to[0], LD * sizeof(double));
            ck_assert_mem_eq(dot[isa], dot[0], sizeof *dot);
        }
        for (int r = 0; r < LD; r++) { /* and the right ones */
            double left = start[r], sum = 0;
            for (int k = 0; k < HF_BLOCK && r < n; k++)
                left -= w[k * LD + r] * a[2 * k];
            ck_assert_double_eq_tol(to[0][r], left, 1e-14);
            for (int i = 0; r < HF_BLOCK && i < n; i++)
                sum += w[r * LD + i] * x[i];
            if (r < HF_BLOCK) ck_assert_double_eq_tol(dot[0][r], sum, 1e-13);
        }
    }
}
END_TEST

START_TEST(a_singular_block_is_refused)
{
    hf_block_band band;
    double block[HF_BLOCK][HF_BLOCK] = {{0}};
    ck_assert_int_eq(hf_block_band_create(2, 1, &band), HF_OK);
    for (int i = 0; i < HF_BLOCK; i++)
        block[i][i] = 1;
    hf_block_band_add(&band, 0, 0, block);
    block[2][2] = 0;
    hf_block_band_add(&band, 1, 1, block);
    ck_assert_int_eq(hf_block_band_factor(&band), HF_SINGULAR);
    hf_block_band_clear(&band);
    block[2][2] = NAN;
    hf_block_band_add(&band, 0, 0, block);
    ck_assert_int_eq(hf_block_band_factor(&band), HF_SINGULAR);
    hf_arena_free_block(band.block);
}
END_TEST

Suite *suite_unit_block_band(void)
{
    Suite *suite = suite_create("unit/linalg/block_band");
    TCase *tcase = tcase_create("block_band");
    tcase_add_loop_test(tcase, factor_and_solution, 0, 60);
    tcase_add_loop_test(tcase, all_instruction_sets_give_the_same_bits, 0, 5);
    tcase_add_test(tcase, a_singular_block_is_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
