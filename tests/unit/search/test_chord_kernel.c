/* The kernels of chord: they give the same bits on every instruction set, their triangular solve agrees with LAPACK's,
 * and no lane changes another. An instruction set that this machine lacks is named and skipped. */
#include "flexible.h"
#include "laws.h"

#include "linalg/band.h"
#include "search/chord.h"

enum { PORTABLE, AVX2, AVX512, N_ISA };
static const hf_chord_kernels *const isa[N_ISA] = {HF_LANE_EACH(&hf_chord_kernels)};
static hf_packed_band_solve *const solve[N_ISA] = {HF_LANE_EACH(hf_packed_band_solve)};

static int has_isa(int i)
{
    int has = hf_lane_has_isa((hf_lane_isa)i);
    char reason[64];
    snprintf(reason, sizeof reason, "no %s in this processor", hf_lane_isa_name((hf_lane_isa)i));
    if (!has) skip_for_machine("unit/chord_kernel", reason);
    return has;
}

struct kernel_run {
    struct net net;
    hf_evaluator evaluator;
    double start_q[600], initial[100];
    hf_chord chord;
    hf_chord_lanes lanes;
    size_t n_x, n_force; /* doubles */
};

/* A random reflector (loads and all laws for odd trials), lanes with shapes and genes of their own near the base. */
static void open_kernel(struct kernel_run *r, int trial, int rule)
{
    struct rng rng = rng_start(60 + (uint64_t)trial);
    *r = (struct kernel_run){.net = {.form = tight_form(HF_METHOD_HIFDM)}};
    random_reflector_scene(&rng, &r->net.scene);
    open_net(&r->net);
    if (trial % 2) attach_all(&r->net, &rng, 3e-5); /* the others stand on fixed supports */
    r->net.form.coupling = (hf_coupling_settings){1e-9, HF_COUPLING_ACCELERATED, 200};
    const hf_model *m = &r->net.model;
    ck_assert(m->n_cable <= 600 && m->n_variable <= 100);
    ck_assert_int_eq(find_shape(&r->net), HF_OK);
    memcpy(r->start_q, r->net.work.q_N_per_m, (size_t)m->n_cable * sizeof(double));
    for (int k = 0; k < m->n_variable; k++)
        r->initial[k] = r->net.work.tension_N[m->variable_cable[k]];
    r->evaluator = (hf_evaluator){.model = m,
                                  .form = &r->net.form,
                                  .start_q_N_per_m = r->start_q,
                                  .rule = (hf_rule)rule,
                                  .solver = HF_SOLVER_CHORD,
                                  .boundary_ratio_cap = 1e9};
    ck_assert_int_eq(hf_chord_create(&r->evaluator, r->initial, &r->net.work, NULL, &r->chord), HF_OK);
    ck_assert_int_eq(hf_chord_lanes_create(&r->chord, &r->lanes), HF_OK);
    r->n_x = 3 * (size_t)m->n_node * HF_LANES;
    r->n_force = hf_packed_band_rows(&r->chord.matrix) * HF_LANES;
}

static void fill_lanes(struct kernel_run *r, uint64_t stream)
{
    struct rng rng = rng_start(stream);
    for (size_t i = 0; i < r->n_x; i++)
        r->lanes.x_m[i] = r->chord.base_m[i / HF_LANES] + rng_uniform(&rng, -0.01, 0.01);
    for (int i = 0; i < r->net.model.n_variable * HF_LANES; i++)
        r->lanes.variable[i] = r->initial[i / HF_LANES] * rng_uniform(&rng, 0.9, 1.1);
    for (int i = 0; i < r->chord.n_pull * HF_LANES; i++)
        r->lanes.displacement_m[i] = r->chord.base_displacement_m[i / HF_LANES] + rng_uniform(&rng, -1e-4, 1e-4);
}

static void close_kernel(struct kernel_run *r)
{
    hf_arena_free(&r->lanes.arena);
    hf_arena_free(&r->chord.arena);
    close_net(&r->net);
}

static double *copy(const double *a, size_t n)
{
    double *b = malloc(n * sizeof *b);
    ck_assert_ptr_nonnull(b);
    memcpy(b, a, n * sizeof *b);
    return b;
}

/* Three passes, each from what the one before left. */
static void work(struct kernel_run *r, int i, double squared[HF_LANES])
{
    for (int pass = 0; pass < 3; pass++) {
        isa[i]->forces(&r->chord, &r->lanes, squared);
        if (r->chord.n_pull) {
            double gap[HF_LANES];
            isa[i]->couple(&r->chord, &r->lanes, gap);
            isa[i]->move(&r->chord, &r->lanes);
            for (int k = 0; k < HF_LANES; k++)
                squared[k] += gap[k];
        }
        solve[i](&r->chord.matrix, r->lanes.force_N);
        isa[i]->step(&r->chord, &r->lanes);
    }
}

START_TEST(instruction_sets_give_the_same_bits)
{
    double squared[HF_LANES], again[HF_LANES];
    hf_chord_measures measures, other_measures;
    for (int rule = HF_RULE_FORCE_DENSITY; rule <= HF_RULE_TENSION; rule++) {
        struct kernel_run r;
        open_kernel(&r, _i, rule);
        fill_lanes(&r, 1);
        work(&r, PORTABLE, squared);
        isa[PORTABLE]->measure(&r.chord, &r.lanes, &measures);
        double *x = copy(r.lanes.x_m, r.n_x), *force = copy(r.lanes.force_N, r.n_force);
        for (int i = AVX2; i < N_ISA; i++) {
            if (!has_isa(i)) continue;
            fill_lanes(&r, 1);
            work(&r, i, again);
            isa[i]->measure(&r.chord, &r.lanes, &other_measures);
            ck_assert_mem_eq(&measures, &other_measures, sizeof measures);
            ck_assert_mem_eq(squared, again, sizeof squared);
            ck_assert_mem_eq(x, r.lanes.x_m, r.n_x * sizeof *x);
            ck_assert_mem_eq(force, r.lanes.force_N, r.n_force * sizeof *force);
        }
        free(x);
        free(force);
        close_kernel(&r);
    }
}
END_TEST

/* Both substitute with the same factor; orders of summation differ: rounding times the condition of the factor, some
 * 1e-13 of the largest step (observed: 1e-15). */
START_TEST(solve_is_lapacks)
{
    struct kernel_run r;
    double squared[HF_LANES];
    open_kernel(&r, _i, HF_RULE_FORCE_DENSITY);
    int n = r.chord.matrix.n, column = 3 * r.net.model.half_bandwidth + 3;
    fill_lanes(&r, 2);
    isa[PORTABLE]->forces(&r.chord, &r.lanes, squared);
    double *f = r.lanes.force_N + r.chord.matrix.width * HF_LANES,
           *expected = malloc((size_t)n * HF_LANES * sizeof *expected);
    ck_assert_ptr_nonnull(expected);
    for (int k = 0; k < n * HF_LANES; k++)
        expected[k % HF_LANES * n + k / HF_LANES] = f[k];
    /* the factor is still in the workspace that hf_chord_create had */
    hf_band_back_solve(n, column - 1, HF_LANES, r.net.work.newton_band, expected, n);
    solve[PORTABLE](&r.chord.matrix, r.lanes.force_N);
    double most = largest(expected, n * HF_LANES);
    for (int k = 0; k < n * HF_LANES; k++)
        ck_assert_double_eq_tol(f[k], expected[k % HF_LANES * n + k / HF_LANES], 1e-12 * most);
    free(expected);
    close_kernel(&r);
}
END_TEST

/* A lane is filled with NaNs and then gets a sound design: no NaN may remain where a later pass reads, and the results
 * of the other lanes must not change. */
START_TEST(a_lane_recovers_from_NaN)
{
    struct kernel_run r;
    double squared[HF_LANES], again[HF_LANES];
    int bad = _i / 3 % HF_LANES;
    if (!has_isa(_i % 3)) return;
    open_kernel(&r, _i, HF_RULE_FORCE_DENSITY);
    fill_lanes(&r, 3);
    work(&r, _i % 3, squared);
    double *x = copy(r.lanes.x_m, r.n_x);
    fill_lanes(&r, 3);
    r.lanes.x_m[bad] = (double)NAN; /* one coordinate of one node: no number is the largest force */
    isa[_i % 3]->forces(&r.chord, &r.lanes, again);
    ck_assert_double_nan(again[bad]);
    fill_lanes(&r, 3);
    for (size_t i = (size_t)bad; i < r.n_x; i += HF_LANES)
        r.lanes.x_m[i] = (double)NAN;
    work(&r, _i % 3, again);
    ck_assert_double_nan(again[bad]);
    for (size_t i = 0; i < r.n_x; i++)
        if ((int)(i % HF_LANES) != bad) ck_assert_mem_eq(x + i, r.lanes.x_m + i, sizeof(double));
    fill_lanes(&r, 3);
    work(&r, _i % 3, again);
    ck_assert_mem_eq(squared, again, sizeof squared);
    ck_assert_mem_eq(x, r.lanes.x_m, r.n_x * sizeof *x);
    free(x);
    close_kernel(&r);
}
END_TEST

/* The residual that a lane is judged by is the largest nodal force over the reference tension, squared. */
START_TEST(residual_is_the_largest_force)
{
    struct kernel_run r;
    double squared[HF_LANES];
    open_kernel(&r, _i, HF_RULE_TENSION);
    fill_lanes(&r, 4);
    isa[PORTABLE]->forces(&r.chord, &r.lanes, squared);
    const double *f = r.lanes.force_N + r.chord.matrix.width * HF_LANES;
    for (int lane = 0; lane < HF_LANES; lane++) {
        double most = 0;
        for (int i = 0; i < r.net.model.n_free; i++) {
            const double *p = f + 3 * i * HF_LANES + lane;
            most = fmax(most, p[0] * p[0] + p[HF_LANES] * p[HF_LANES] + p[2 * HF_LANES] * p[2 * HF_LANES]);
        }
        double reference = r.net.model.reference_N; /* three products and two sums: a few roundings */
        ck_assert_double_eq_tol(squared[lane], most / (reference * reference), 1e-14 * squared[lane]);
        ck_assert_double_gt(squared[lane], 0);
    }
    close_kernel(&r);
}
END_TEST

enum { N_NODE = 12, N_PULL = 17 };

struct pulls {
    _Alignas(64) double x_m[3 * N_NODE * HF_LANES], cut_m[N_PULL * HF_LANES], stiffness_N_per_m[N_PULL * HF_LANES];
    _Alignas(64) double tension_N[N_ISA][N_PULL * HF_LANES], q_N_per_m[N_ISA][N_PULL * HF_LANES];
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
    for (int i = 0; i < N_ISA; i++) {
        if (!has_isa(i)) continue;
        isa[i]->pull(&m, p.x_m, p.cut_m, p.stiffness_N_per_m, p.tension_N[i], p.q_N_per_m[i]);
        ck_assert_mem_eq(p.tension_N[i], p.tension_N[0], sizeof p.tension_N[0]);
        ck_assert_mem_eq(p.q_N_per_m[i], p.q_N_per_m[0], sizeof p.q_N_per_m[0]);
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
    static _Alignas(64) double packed[N_PAD * N], in[N * HF_LANES], out[N_ISA][N_PAD * HF_LANES];
    double matrix[N][N];
    struct rng rng = rng_start(78);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            packed[(i / HF_CHORD_ROWS * N + j) * HF_CHORD_ROWS + i % HF_CHORD_ROWS] = matrix[i][j] =
                rng_uniform(&rng, -1, 1);
    for (int i = 0; i < N * HF_LANES; i++)
        in[i] = rng_uniform(&rng, -1, 1);
    for (int i = 0; i < N_ISA; i++) {
        if (!hf_lane_has_isa((hf_lane_isa)i)) continue; /* the test above says so */
        isa[i]->multiply(N_PAD, N, packed, in, out[i]);
        ck_assert_mem_eq(out[i], out[0], sizeof out[0]);
    }
    for (int i = 0; i < N_PAD * HF_LANES; i++) {
        double sum = 0;
        for (int j = 0; j < N && i / HF_LANES < N; j++)
            sum += matrix[i / HF_LANES][j] * in[j * HF_LANES + i % HF_LANES];
        ck_assert_double_eq_tol(out[0][i], sum, 1e-14);
    }
}
END_TEST

Suite *suite_unit_chord_kernel(void)
{
    Suite *suite = suite_create("unit/chord_kernel");
    TCase *tests = tcase_create("chord_kernel");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, instruction_sets_give_the_same_bits, 0, 6);
    tcase_add_loop_test(tests, solve_is_lapacks, 0, 6);
    tcase_add_loop_test(tests, a_lane_recovers_from_NaN, 0, 9);
    tcase_add_loop_test(tests, residual_is_the_largest_force, 0, 2);
    tcase_add_test(tests, tensions_are_those_of_the_law);
    tcase_add_test(tests, products_are_those_of_the_matrix);
    return suite;
}
