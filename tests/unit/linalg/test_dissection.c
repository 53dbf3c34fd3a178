/* Quasi-definite matrices of 6 x 6 blocks by nested dissection against dense LU, on random graphs. */
#include "support.h"

#include "linalg/block_kernel.h"
#include "linalg/dense.h"
#include "linalg/dissection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_BLOCKS = 60, MAX_N = HF_BLOCK * MAX_BLOCKS, MAX_EDGES = 8 * MAX_BLOCKS };

struct graph {
    int n, n_edge, end[2 * MAX_EDGES];
    double position[3 * MAX_BLOCKS];
};

/* Draws points in a flat box and joins near ones. Some graphs have equal points, double edges or several parts. */
static void draw_graph(struct graph *g, int i, struct rng *rng)
{
    double reach = rng_uniform(rng, 0.05, 0.6);
    g->n = 1 + (int)rng_uniform(rng, 0, MAX_BLOCKS);
    g->n_edge = 0;
    for (int k = 0; k < 3 * g->n; k++)
        g->position[k] = i % 5 == 0 ? 1 : rng_uniform(rng, 0, k % 3 < 2 ? 1 : 0.1);
    for (int a = 0; a < g->n; a++)
        for (int b = 0; b < a; b++) {
            double square = 0;
            for (int c = 0; c < 3; c++)
                square += pow(g->position[3 * a + c] - g->position[3 * b + c], 2);
            bool is_near = i % 5 == 0 ? rng_uniform(rng, 0, 1) < reach / 4 : square < reach * reach;
            for (int copies = is_near ? 1 + (i % 7 == 0) : 0; copies > 0 && g->n_edge < MAX_EDGES; copies--) {
                g->end[2 * g->n_edge] = copies > 1 ? a : b;
                g->end[2 * g->n_edge++ + 1] = copies > 1 ? b : a;
            }
        }
}

/* Adds `part` times a random spring between blocks i and j to entry (r,c) of their blocks, or one to the ground. */
static void draw_spring(double part, bool is_double, double block[HF_BLOCK][HF_BLOCK], int row, int column,
                        struct rng *rng)
{
    double u[3];
    for (int c = 0; c < 3; c++)
        u[c] = rng_uniform(rng, -1, 1);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            double k = part * (u[r] * u[c] + 0.1 * (r == c));
            block[row + r][column + c] += k;
            if (is_double) block[column + c][row + r] += k;
        }
}

static void add_dense(int n, int i, int j, double sign, double block[HF_BLOCK][HF_BLOCK], double *dense)
{
    for (int r = 0; r < HF_BLOCK; r++)
        for (int c = 0; c < HF_BLOCK; c++)
            dense[(HF_BLOCK * j + c) * HF_BLOCK * n + HF_BLOCK * i + r] += sign * block[r][c];
}

/* [X M; M -G], where X and G are zero in some runs. */
START_TEST(factor_and_solution)
{
    struct rng rng = rng_start((uint64_t)_i);
    static struct graph g;
    static double dense[MAX_N * MAX_N], kept[MAX_N * MAX_N];
    static int pivot[MAX_N];
    static double x[MAX_N], b[MAX_N], right[MAX_N];
    double share[2] = {_i % 3 == 0 ? 0 : pow(10, rng_uniform(&rng, -6, 6)),
                       _i % 4 == 0 ? 0 : pow(10, rng_uniform(&rng, -6, 6))};
    hf_dissection matrix;
    draw_graph(&g, _i, &rng);
    ck_assert_int_eq(hf_dissection_create(g.n, g.position, g.n_edge, g.end, &matrix), HF_OK);
    for (int again = 0; again < 2; again++) { /* the second time over the first factor */
        memset(dense, 0, sizeof dense);
        hf_dissection_clear(&matrix);
        for (int e = -g.n; e < g.n_edge; e++) {
            double block[HF_BLOCK][HF_BLOCK] = {{0}}, minus[HF_BLOCK][HF_BLOCK];
            int i = e < 0 ? -1 - e : g.end[2 * e], j = e < 0 ? i : g.end[2 * e + 1];
            draw_spring(share[0], false, block, 0, 0, &rng);
            draw_spring(1, true, block, 0, 3, &rng);
            draw_spring(-share[1], false, block, 3, 3, &rng);
            for (int k = 0; k < HF_BLOCK * HF_BLOCK; k++)
                minus[k / HF_BLOCK][k % HF_BLOCK] = -block[k / HF_BLOCK][k % HF_BLOCK];
            hf_dissection_add(&matrix, i, i, block);
            add_dense(g.n, i, i, 1, block, dense);
            if (e < 0) continue;
            hf_dissection_add(&matrix, j, j, block);
            hf_dissection_add(&matrix, i, j, minus);
            add_dense(g.n, j, j, 1, block, dense);
            add_dense(g.n, i, j, 1, minus, dense);
            for (int k = 0; k < HF_BLOCK * HF_BLOCK; k++) /* its transpose */
                minus[k / HF_BLOCK][k % HF_BLOCK] = -block[k % HF_BLOCK][k / HF_BLOCK];
            add_dense(g.n, j, i, 1, minus, dense);
        }
        int n = HF_BLOCK * g.n;
        memcpy(kept, dense, sizeof kept);
        for (int i = 0; i < n; i++)
            x[i] = b[i] = right[i] = rng_uniform(&rng, -1, 1);
        ck_assert_int_eq(hf_dissection_factor(&matrix), HF_OK);
        hf_dissection_solve(&matrix, x);
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
    }
    hf_dissection_free(&matrix);
}
END_TEST

/* A long strip needs far fewer entries than its order by numbers along the strip would. */
START_TEST(cuts_keep_the_fronts_small)
{
    enum { ACROSS = 60, ALONG = 80, N = ACROSS * ALONG };
    static int end[4 * N];
    static double position[3 * N];
    hf_dissection matrix;
    int n_edge = 0;
    size_t largest = 0;
    for (int i = 0; i < N; i++) {
        position[3 * i] = i / ACROSS;
        position[3 * i + 1] = i % ACROSS;
        for (int k = 0; k < 2; k++) {
            if (k == 0 ? i % ACROSS == ACROSS - 1 : i / ACROSS == ALONG - 1) continue;
            end[2 * n_edge] = i;
            end[2 * n_edge++ + 1] = i + (k == 0 ? 1 : ACROSS);
        }
    }
    ck_assert_int_eq(hf_dissection_create(N, position, n_edge, end, &matrix), HF_OK);
    for (int i = 0; i < matrix.n_front; i++)
        if ((size_t)matrix.front[i].n_row > largest) largest = (size_t)matrix.front[i].n_row;
    ck_assert_uint_le(largest, 2 * ACROSS);
    ck_assert_int_le(matrix.front[matrix.n_front - 1].n_pivot, ACROSS); /* the first cut is the shortest one */
    ck_assert_uint_lt(matrix.n_entry, HF_BLOCK * HF_BLOCK * N * (ACROSS + 1) * 6 / 10);
    hf_dissection_free(&matrix);
}
END_TEST

/* All lengths up to some vectors, and all numbers of terms up to some blocks. */
START_TEST(all_instruction_sets_give_the_same_bits)
{
    static const hf_block_kernels *const of_isa[] = {HF_LANE_EACH(&hf_block_kernels)};
    enum { LD = 40, TERMS = 18 };
    struct rng rng = rng_start((uint64_t)_i);
    double w[TERMS * LD], a[TERMS * 7], x[LD], start[HF_BLOCK * LD];
    for (int i = 0; i < TERMS * LD; i++)
        w[i] = rng_uniform(&rng, -1, 1);
    for (int i = 0; i < HF_BLOCK * LD; i++)
        start[i] = rng_uniform(&rng, -1, 1);
    for (int i = 0; i < LD; i++)
        x[i] = rng_uniform(&rng, -1, 1);
    for (int i = 0; i < TERMS * 7; i++)
        a[i] = rng_uniform(&rng, -1, 1);
    for (int n = 0; n <= LD; n++) {
        double to[HF_LANE_N_ISA][HF_BLOCK * LD], one[HF_LANE_N_ISA][LD], dot[HF_LANE_N_ISA][HF_BLOCK];
        int rows = n / HF_LANES * HF_LANES, terms = n % (TERMS + 1);
        for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
            if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
            memcpy(to[isa], start, sizeof start);
            memcpy(one[isa], start, sizeof *one);
            of_isa[isa]->subtract(rows, terms, w, LD, a, 7, to[isa], LD);
            of_isa[isa]->spread(n, w, LD, a, one[isa]);
            of_isa[isa]->dot(n, w, LD, x, dot[isa]);
            ck_assert_mem_eq(to[isa], to[0], sizeof *to);
            ck_assert_mem_eq(one[isa], one[0], sizeof *one);
            ck_assert_mem_eq(dot[isa], dot[0], sizeof *dot);
        }
        for (int r = 0; r < LD; r++) { /* and the right ones */
            double left = start[r], sum = 0;
            for (int c = 0; c < HF_BLOCK; c++) {
                double entry = start[c * LD + r];
                for (int k = 0; k < terms && r < rows; k++)
                    entry -= w[k * LD + r] * a[7 * k + c];
                ck_assert_double_eq_tol(to[0][c * LD + r], entry, 1e-13);
            }
            for (int k = 0; k < HF_BLOCK && r < n; k++)
                left -= w[k * LD + r] * a[k];
            ck_assert_double_eq_tol(one[0][r], left, 1e-14);
            for (int i = 0; r < HF_BLOCK && i < n; i++)
                sum += w[r * LD + i] * x[i];
            if (r < HF_BLOCK) ck_assert_double_eq_tol(dot[0][r], sum, 1e-13);
        }
    }
}
END_TEST

START_TEST(a_singular_block_is_refused)
{
    static const int end[] = {0, 1};
    static const double position[6] = {0};
    hf_dissection matrix;
    double block[HF_BLOCK][HF_BLOCK] = {{0}};
    ck_assert_int_eq(hf_dissection_create(2, position, 1, end, &matrix), HF_OK);
    for (int i = 0; i < HF_BLOCK; i++)
        block[i][i] = 1;
    hf_dissection_add(&matrix, 0, 0, block);
    block[2][2] = 0;
    hf_dissection_add(&matrix, 1, 1, block);
    ck_assert_int_eq(hf_dissection_factor(&matrix), HF_SINGULAR);
    hf_dissection_clear(&matrix);
    block[2][2] = NAN;
    hf_dissection_add(&matrix, 0, 0, block);
    ck_assert_int_eq(hf_dissection_factor(&matrix), HF_SINGULAR);
    hf_dissection_free(&matrix);
}
END_TEST

Suite *suite_unit_dissection(void)
{
    Suite *suite = suite_create("unit/linalg/dissection");
    TCase *tcase = tcase_create("dissection");
    tcase_add_loop_test(tcase, factor_and_solution, 0, 84);
    tcase_add_test(tcase, cuts_keep_the_fronts_small);
    tcase_add_loop_test(tcase, all_instruction_sets_give_the_same_bits, 0, 5);
    tcase_add_test(tcase, a_singular_block_is_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
