/* The kernels over cables and attachments of nets side by side: against the law and a matrix, and the same bits from
 * all instruction sets. */
#include "built_nets.h"

#include "built/pull_kernel.h"

enum { N_NODE = 12, N_PULL = 17 };

static hf_pull_find *const kernel[HF_LANE_N_ISA] = {hf_pull_find_portable, hf_pull_find_avx2, hf_pull_find_avx512};

struct pulls {
    _Alignas(64) double x_m[3 * N_NODE * HF_LANES], cut_m[N_PULL * HF_LANES], stiffness_N_per_m[N_PULL * HF_LANES];
    _Alignas(64) double tension_N[HF_LANE_N_ISA][N_PULL * HF_LANES], q_N_per_m[HF_LANE_N_ISA][N_PULL * HF_LANES];
    int end_row[2 * N_PULL];
};

/* Cables about as long as they are cut, every fifth without length, one of them cut to nothing but rounding. */
static void fill_pulls(struct pulls *p)
{
    struct rng rng = rng_start(77);
    for (int i = 0; i < 3 * N_NODE * HF_LANES; i++)
        p->x_m[i] = rng_uniform(&rng, -1, 1);
    for (int e = 0; e < N_PULL; e++) {
        int a = rng_int(&rng, 0, N_NODE - 1);
        p->end_row[2 * e] = a;
        p->end_row[2 * e + 1] = e % 5 == 4 ? a : (a + rng_int(&rng, 1, N_NODE - 1)) % N_NODE;
        for (int k = 0; k < HF_LANES; k++) {
            p->cut_m[e * HF_LANES + k] = rng_uniform(&rng, 0.1, 2);
            p->stiffness_N_per_m[e * HF_LANES + k] = rng_uniform(&rng, 1e2, 1e6);
        }
    }
}

START_TEST(tensions_are_those_of_the_law)
{
    static struct pulls p;
    hf_model m = {.n_node = N_NODE, .n_cable = N_PULL, .end_row = p.end_row};
    int n_slack = 0;
    fill_pulls(&p);
    for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
        if (!hf_lane_has_isa((hf_lane_isa)isa)) {
            skip_for_machine("unit/pull_kernel", hf_lane_isa_name((hf_lane_isa)isa));
            continue;
        }
        kernel[isa](&m, p.x_m, p.cut_m, p.stiffness_N_per_m, p.tension_N[isa], p.q_N_per_m[isa]);
        ck_assert_mem_eq(p.tension_N[isa], p.tension_N[0], sizeof p.tension_N[0]);
        ck_assert_mem_eq(p.q_N_per_m[isa], p.q_N_per_m[0], sizeof p.q_N_per_m[0]);
    }
    for (int i = 0; i < N_PULL * HF_LANES; i++) {
        int e = i / HF_LANES, lane = i % HF_LANES;
        double d[3];
        for (int c = 0; c < 3; c++)
            d[c] = p.x_m[(c * N_NODE + p.end_row[2 * e + 1]) * HF_LANES + lane] -
                   p.x_m[(c * N_NODE + p.end_row[2 * e]) * HF_LANES + lane];
        double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), cut = p.cut_m[i];
        hf_law_cable cable = {HF_LAW_ELASTIC, cut, p.stiffness_N_per_m[i] * cut, cut};
        double T = hf_law_tension_N(cable, length);
        ck_assert_double_eq_tol(p.tension_N[0][i], T, 1e-14 * cable.EA_N); /* rounding of lengths of a few metres */
        ck_assert_double_eq_tol(p.q_N_per_m[0][i] * length, p.tension_N[0][i], 1e-15 * T + 1e-300);
        n_slack += T == 0;
    }
    ck_assert_int_gt(n_slack, HF_LANES); /* both kinds were there */
    ck_assert_int_lt(n_slack, (N_PULL - 4) * HF_LANES);
}
END_TEST

/* The rows that fill up are zero in the matrix. */
START_TEST(products_are_those_of_the_matrix)
{
    enum { N = 13, N_PAD = 16 };
    static hf_pull_multiply *const multiply[HF_LANE_N_ISA] = {hf_pull_multiply_portable, hf_pull_multiply_avx2,
                                                              hf_pull_multiply_avx512};
    static _Alignas(64) double packed[N_PAD * N], in[N * HF_LANES], out[HF_LANE_N_ISA][N_PAD * HF_LANES];
    double matrix[N][N];
    struct rng rng = rng_start(78);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            packed[(i / HF_PULL_ROWS * N + j) * HF_PULL_ROWS + i % HF_PULL_ROWS] = matrix[i][j] =
                rng_uniform(&rng, -1, 1);
    for (int i = 0; i < N * HF_LANES; i++)
        in[i] = rng_uniform(&rng, -1, 1);
    for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
        if (!hf_lane_has_isa((hf_lane_isa)isa)) continue; /* the test above says so */
        multiply[isa](N, packed, in, out[isa]);
        ck_assert_mem_eq(out[isa], out[0], sizeof out[0]);
    }
    for (int i = 0; i < N_PAD * HF_LANES; i++) {
        double sum = 0;
        for (int j = 0; j < N && i / HF_LANES < N; j++)
            sum += matrix[i / HF_LANES][j] * in[j * HF_LANES + i % HF_LANES];
        ck_assert_double_eq_tol(out[0][i], sum, 1e-14);
    }
}
END_TEST

Suite *suite_unit_pull_kernel(void)
{
    Suite *suite = suite_create("unit/pull_kernel");
    TCase *tcase = tcase_create("pull_kernel");
    tcase_add_test(tcase, tensions_are_those_of_the_law);
    tcase_add_test(tcase, products_are_those_of_the_matrix);
    suite_add_tcase(suite, tcase);
    return suite;
}
