/* The kernels of quadratic programmes, on every instruction set that this machine has: the bits of loops over one
 * number at a time, with and without rests of four columns and of blocks of rows. */
#include "support.h"

#include "base/lane.h"
#include "linalg/dot.h"
#include "linalg/quadratic_kernel.h"

#include <math.h>
#include <string.h>

static const hf_quadratic_kernels *const kernel[HF_LANE_N_ISA] = {HF_LANE_EACH(&hf_quadratic_kernels)};

static const int sizes[] = {1, 2, 4, 5, 8, 11, 24, 37, 48};
enum { N_SIZES = sizeof sizes / sizeof *sizes, MAX_N = 48 };

static void draw(struct rng *rng, int n, double *x)
{
    for (int i = 0; i < n; i++)
        x[i] = rng_uniform(rng, -1, 1);
}

/* L X = the columns of the unit matrix from `first` on, column by column of L. */
static void invert_plainly(int n, int first, const double *l, double *x)
{
    memset(x, 0, (size_t)n * HF_LANES * sizeof(double));
    for (int lane = 0; lane < HF_LANES && first + lane < n; lane++) {
        x[HF_LANES * (first + lane) + lane] = 1;
        for (int k = first; k < n; k++) {
            x[HF_LANES * k + lane] /= l[k * n];
            for (int i = k + 1; i < n; i++)
                x[HF_LANES * i + lane] -= x[HF_LANES * k + lane] * l[k * n + i - k];
        }
    }
}

START_TEST(inverse_of_a_triangle)
{
    int n = sizes[_i];
    static double l[MAX_N * MAX_N], wanted[MAX_N * HF_LANES], strip[MAX_N * HF_LANES];
    struct rng rng = rng_start(1);
    draw(&rng, n * n, l);
    for (int k = 0; k < n; k++)
        l[k * n] += 3;
    for (int isa = 0; isa < HF_LANE_N_ISA; isa++)
        for (int first = 0; first < n && hf_lane_has_isa((hf_lane_isa)isa); first += HF_LANES) {
            invert_plainly(n, first, l, wanted);
            memset(strip, 0, sizeof strip);
            for (int lane = 0; lane < HF_LANES && first + lane < n; lane++)
                strip[HF_LANES * (first + lane) + lane] = 1;
            kernel[isa]->invert(n, first, l, strip);
            ck_assert_mem_eq(strip, wanted, (size_t)n * HF_LANES * sizeof(double));
            ck_assert_double_eq(strip[HF_LANES * first], 1 / l[first * n]);
        }
}
END_TEST

START_TEST(columns_turn_and_are_combined)
{
    int n = sizes[_i], ld = (n + HF_LANES - 1) / HF_LANES * HF_LANES;
    static double start[MAX_N * MAX_N], wanted[MAX_N * MAX_N], J[MAX_N * MAX_N];
    double angle[MAX_N], cosine[MAX_N], sine[MAX_N], sum[MAX_N];
    struct rng rng = rng_start(2);
    draw(&rng, n * ld, start);
    draw(&rng, n, angle);
    int first = n / 3, last = n - 2;
    memcpy(wanted, start, sizeof wanted);
    for (int i = 0; i < n; i++) {
        cosine[i] = cos(angle[i]);
        sine[i] = sin(angle[i]);
    }
    for (int i = last; i >= first; i--)
        for (int r = 0; r < ld; r++) {
            double *u = wanted + i * ld + r, *v = u + ld, old = *u;
            *u = cosine[i] * old + sine[i] * *v;
            *v = cosine[i] * *v - sine[i] * old;
        }
    for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
        if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
        memcpy(J, start, sizeof J);
        kernel[isa]->turn(ld, first, last, cosine, sine, J);
        ck_assert_mem_eq(J, wanted, (size_t)(n * ld) * sizeof(double));
        kernel[isa]->combine(ld, first, n, angle, J, sum);
        for (int r = 0; r < ld; r++) {
            double total = 0;
            for (int j = first; j < n; j++)
                total += angle[j] * J[j * ld + r];
            ck_assert_double_eq(sum[r], total);
        }
    }
}
END_TEST

START_TEST(inner_products_side_by_side)
{
    int n = sizes[_i], lda = n + 3;
    static double a[MAX_N * (MAX_N + 3)];
    double b[MAX_N], dot[MAX_N];
    struct rng rng = rng_start(3);
    draw(&rng, n * lda, a);
    draw(&rng, n, b);
    hf_dots((size_t)n, (size_t)n, a, (size_t)lda, b, dot);
    for (int r = 0; r < n; r++)
        ck_assert_double_eq(dot[r], hf_dot((size_t)n, a + r * lda, b));
}
END_TEST

Suite *suite_unit_quadratic_kernel(void)
{
    Suite *suite = suite_create("unit/quadratic_kernel");
    TCase *tests = tcase_create("quadratic_kernel");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, inverse_of_a_triangle, 0, N_SIZES);
    tcase_add_loop_test(tests, columns_turn_and_are_combined, 0, N_SIZES);
    tcase_add_loop_test(tests, inner_products_side_by_side, 0, N_SIZES);
    return suite;
}
