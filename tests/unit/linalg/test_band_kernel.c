/* The band kernels: the same bits on every instruction set that this machine has, and LAPACK's results but for
 * rounding, over sizes with and without rests of four columns and of eight rows. */
#include "support.h"

#include "base/lane.h"
#include "linalg/band.h"
#include "linalg/band_kernel.h"
#include "linalg/lapack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const hf_band_kernels *const kernel[HF_LANE_N_ISA] = {HF_LANE_EACH(&hf_band_kernels)};

static const int sizes[] = {1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 64, 85, 131};
static const int widths[] = {0, 1, 2, 3, 4, 5, 7, 8, 12, 15, 16, 21, 33, 65};
enum { N_SIZES = sizeof sizes / sizeof *sizes, N_WIDTHS = sizeof widths / sizeof *widths, N_RHS = 5, GUARD = 4 };

typedef struct {
    int n, k, ld; /* ld: of the right-hand sides; what lies behind row n - 1 must stay */
    size_t n_band, n_b;
    double *band, *b;
} problem;

static problem allocate(int n, int k)
{
    problem p = {.n = n, .k = k, .ld = n + GUARD, .n_band = (size_t)n * ((size_t)k + 1)};
    p.n_b = N_RHS * (size_t)p.ld;
    p.band = malloc(p.n_band * sizeof(double));
    p.b = malloc(p.n_b * sizeof(double));
    ck_assert(p.band && p.b);
    return p;
}

static void release(problem *p)
{
    free(p->band);
    free(p->b);
}

/* Positive definite by diagonals that exceed the sums of their rows; entries outside the matrix are not numbers. */
static problem draw(int n, int k, uint64_t stream)
{
    struct rng rng = rng_start(stream);
    problem p = allocate(n, k);
    for (int j = 0; j < n; j++)
        for (int d = 0; d <= k; d++) {
            double value = d == 0 ? 2 * k + 0.25 : rng_uniform(&rng, -1, 1);
            p.band[d + j * (k + 1)] = j + d < n ? value : (double)NAN;
        }
    for (size_t i = 0; i < p.n_b; i++)
        p.b[i] = rng_uniform(&rng, -1, 1);
    return p;
}

static problem copy(const problem *from)
{
    problem p = allocate(from->n, from->k);
    memcpy(p.band, from->band, p.n_band * sizeof(double));
    memcpy(p.b, from->b, p.n_b * sizeof(double));
    return p;
}

static problem solved(const problem *from, int isa)
{
    problem p = copy(from);
    ck_assert_int_eq(kernel[isa]->factor(p.n, p.k, p.band, 0, p.n), 0);
    kernel[isa]->back_solve(p.n, p.k, N_RHS, p.band, p.b, p.ld);
    return p;
}

/* Every row of the matrix has a sum of absolute values below 4 k + 0.25 and an excess of 0.25 at least: the condition
 * is below 16 k + 1 < 1042, and rounding below 1042 * n k * 1.1e-16 < 1e-9 if all of it added up; measured 1e-14. */
START_TEST(lapack_and_every_instruction_set_agree)
{
    int k = widths[_i % N_WIDTHS], n = sizes[_i / N_WIDTHS], ldab = k + 1;
    problem p = draw(n, k, (uint64_t)_i), ours = solved(&p, HF_LANE_PORTABLE), theirs = copy(&p);
    ck_assert_int_eq(hf_lapack_load(NULL), HF_OK);
    ck_assert_int_eq(hf_band_factor_lapack(n, k, theirs.band), 0);
    hf_band_back_solve_lapack(n, k, N_RHS, theirs.band, theirs.b, theirs.ld);
    for (int i = 0; i < n * ldab; i++)
        if (!isnan(p.band[i])) ck_assert_double_eq_tol(ours.band[i], theirs.band[i], 1e-12 * (k + 1));
    for (size_t i = 0; i < p.n_b; i++) {
        ck_assert_double_eq_tol(ours.b[i], theirs.b[i], 1e-12);
        if ((int)(i % (size_t)p.ld) >= n) ck_assert_double_eq(ours.b[i], p.b[i]);
    }
    for (int isa = HF_LANE_AVX2; isa < HF_LANE_N_ISA; isa++) {
        if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
        problem again = solved(&p, isa);
        ck_assert_msg(!memcmp(again.band, ours.band, p.n_band * sizeof(double)), "factor: %s",
                      hf_lane_isa_name((hf_lane_isa)isa));
        ck_assert_msg(!memcmp(again.b, ours.b, p.n_b * sizeof(double)), "solution: %s",
                      hf_lane_isa_name((hf_lane_isa)isa));
        release(&again);
    }
    release(&p);
    release(&ours);
    release(&theirs);
}
END_TEST

/* The first pivot that is not positive is named, wherever it lies in a block of columns. */
START_TEST(bad_pivot)
{
    for (int bad = 0; bad < 11; bad++)
        for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
            if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
            problem p = draw(11, 5, 3);
            p.band[bad * 6] = _i ? (double)NAN : -1;
            ck_assert_int_eq(kernel[isa]->factor(p.n, p.k, p.band, 0, p.n), bad + 1);
            release(&p);
        }
}
END_TEST

/* Solutions do not depend on how many right-hand sides are solved together. */
START_TEST(right_hand_sides_alone)
{
    problem p = draw(37, 9, 5), together = solved(&p, HF_LANE_PORTABLE);
    for (int r = 0; r < N_RHS; r++)
        kernel[HF_LANE_PORTABLE]->back_solve(p.n, p.k, 1, together.band, p.b + r * p.ld, p.ld);
    ck_assert(!memcmp(p.b, together.b, p.n_b * sizeof(double)));
    release(&p);
    release(&together);
}
END_TEST

/* Products of rows with whole numbers are exact; the upper triangle is not written but for tiles on the diagonal. */
START_TEST(products_of_rows)
{
    enum { N = 11, LD = 40 };
    double a[N * LD], gram[N * N], first[N * N];
    for (int i = 0; i < N * LD; i++)
        a[i] = i * 7919 % 23 - 11;
    for (int n_column = 1; n_column < LD; n_column += 5)
        for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
            if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
            for (int row = 0; row < N; row += 8) /* rows 0 to 7, then the others */
                kernel[isa]->gram(row, row ? N : 8, n_column, a, LD, gram, N);
            for (int i = 0; i < N; i++)
                for (int j = 0; j <= i; j++) {
                    double sum = 0;
                    for (int c = 0; c < n_column; c++)
                        sum += a[i * LD + c] * a[j * LD + c];
                    ck_assert_double_eq(gram[i * N + j], sum);
                }
        }
    for (int i = 0; i < N * LD; i++)
        a[i] *= 1.0 / 3;
    for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
        if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
        kernel[isa]->gram(0, N, LD, a, LD, isa ? gram : first, N);
        for (int i = 0; i < N && isa; i++)
            ck_assert(!memcmp(gram + i * N, first + i * N, ((size_t)i + 1) * sizeof(double)));
    }
}
END_TEST

Suite *suite_unit_band_kernel(void)
{
    Suite *suite = suite_create("unit/band_kernel");
    TCase *tests = tcase_create("band_kernel");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, lapack_and_every_instruction_set_agree, 0, N_SIZES * N_WIDTHS);
    tcase_add_loop_test(tests, bad_pivot, 0, 2);
    tcase_add_test(tests, right_hand_sides_alone);
    tcase_add_test(tests, products_of_rows);
    return suite;
}
