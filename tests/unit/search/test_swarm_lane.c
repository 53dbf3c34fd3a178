/* The kernels of swarm: against plain loops bit by bit, against LAPACK and the scalar iteration to roundoff, the same
 * bits on every instruction set of this machine, and no lane disturbed by another.
 *
 * Contents: nets with any matrix - solving - instruction sets - lanes apart - whole iterations. */
#include "nets.h"

#include "linalg/band.h"
#include "search/swarm.h"

#define ROUNDOFF 1e-14 /* of a few operations on numbers of size 1 */

/* ---- nets with any matrix: a cable per entry of the band, and one from each node to a support of its own ---- */

struct band_net {
    hf_model model; /* what a plan looks at, and nothing else */
    hf_swarm_plan plan;
    hf_swarm_lanes work;
};

static void open_plan(struct band_net *net, hf_lane_isa isa)
{
    ck_assert_int_eq(hf_swarm_plan_create(&net->model, isa, &net->plan), HF_OK);
}

/* Without the entries (i, j) that `is_left_out` wants out; it may be NULL. */
static void open_band_net(struct band_net *net, int n, int k, int (*is_left_out)(int i, int j))
{
    size_t room = (size_t)n * (size_t)(k + 1);
    *net = (struct band_net){.model = {.n_node = 2 * n, .n_free = n, .half_bandwidth = k, .reference_N = 10}};
    hf_model *m = &net->model;
    m->end_row = malloc(2 * room * sizeof(int));
    m->length_m = malloc(room * sizeof(double));
    m->load_N = malloc(6 * (size_t)n * sizeof(double));
    ck_assert(m->end_row && m->length_m && m->load_N);
    for (int i = 0; i < n; i++)
        for (int j = i > k ? i - k : 0; j <= i; j++) {
            if (i != j && is_left_out && is_left_out(i, j)) continue;
            int *end = m->end_row + 2 * m->n_cable;
            end[j % 2] = i, end[1 - j % 2] = i == j ? n + i : j; /* either end first */
            m->length_m[m->n_cable++] = 1 + 0.01 * j;
        }
    open_plan(net, HF_LANE_PORTABLE);
    ck_assert_int_eq(hf_swarm_lanes_create(&net->plan, &net->work), HF_OK);
}

static void close_band_net(struct band_net *net)
{
    hf_arena_free_block(net->plan.block);
    hf_arena_free(&net->work.arena);
    free(net->model.end_row);
    free(net->model.length_m);
    free(net->model.load_N);
}

/* Fills the workspace with NaN and other values that no kernel may read. */
static void poison(struct band_net *net)
{
    memset(net->work.arena.block, 0xff, hf_swarm_lanes_bytes(&net->plan));
}

/* Force densities, support positions and loads. Cables between nodes get q in (-1, 1), those to supports what makes
 * their node's diagonal exceed the sum of the row by 0.317, as in test_band.c: positive definite. */
static void fill(struct band_net *net, uint64_t stream)
{
    const hf_model *m = &net->model;
    hf_swarm_lanes *w = &net->work;
    struct rng rng = rng_start(stream);
    double *missing = calloc((size_t)m->n_free * HF_LANES, sizeof(double));
    ck_assert_ptr_nonnull(missing);
    poison(net);
    for (int pass = 0; pass < 2; pass++)
        for (int e = 0; e < m->n_cable; e++) {
            const int *end = m->end_row + 2 * e;
            int low = end[0] < end[1] ? end[0] : end[1], high = end[0] + end[1] - low;
            w->law[e] = (unsigned char)(e % 3);
            if (pass == 0 && high >= m->n_free) continue;
            if (pass == 1 && high < m->n_free) continue;
            for (int l = 0; l < HF_LANES; l++) {
                double *q = &w->q_N_per_m[e * HF_LANES + l];
                w->target[e * HF_LANES + l] = rng_uniform(&rng, 0.5, 2.385);
                if (pass == 1) {
                    *q = missing[low * HF_LANES + l] + 0.317;
                    continue;
                }
                *q = rng_uniform(&rng, -1, 1);
                missing[low * HF_LANES + l] += fabs(*q) - *q;
                missing[high * HF_LANES + l] += fabs(*q) - *q;
            }
        }
    for (int i = 0; i < 3 * m->n_node; i++)
        m->load_N[i] = rng_uniform(&rng, -2.385, 2.385);
    for (int i = (net->plan.n_pad + m->n_free) * 3 * HF_LANES; i < (net->plan.n_pad + m->n_node) * 3 * HF_LANES; i++)
        w->position_m[i] = rng_uniform(&rng, -1, 1);
    free(missing);
}

static double *position(const struct band_net *net, int row, int c, int lane)
{
    return &net->work.position_m[((net->plan.n_pad + row) * 3 + c) * HF_LANES + lane];
}

/* One lane's matrix as LAPACK wants it, [n][k+1], and right-hand sides, [3][n]; in the order of the cables. */
static void assemble_plainly(const struct band_net *net, int lane, double *band, double *b)
{
    const hf_model *m = &net->model;
    int n = m->n_free, k = m->half_bandwidth;
    memset(band, 0, (size_t)(n * (k + 1)) * sizeof(double));
    for (int c = 0; c < 3; c++)
        memcpy(b + c * n, m->load_N + c * m->n_node, (size_t)n * sizeof(double));
    for (int e = 0; e < m->n_cable; e++) {
        const int *end = m->end_row + 2 * e;
        int low = end[0] < end[1] ? end[0] : end[1], high = end[0] + end[1] - low;
        double q = net->work.q_N_per_m[e * HF_LANES + lane];
        band[low * (k + 1)] += q;
        if (high < n) {
            band[high * (k + 1)] += q;
            band[high - low + low * (k + 1)] -= q;
        } else {
            for (int c = 0; c < 3; c++)
                b[c * n + low] = fma(q, *position(net, high, c, lane), b[c * n + low]);
        }
    }
}

/* Cholesky as it stands in the textbook, but for the reciprocals on the diagonal, the order of the back substitution
 * and the products, which are fused with their sums: what the kernels must reproduce bit by bit. */
static void solve_plainly(int n, int k, double *band, double *b)
{
#define L(i, j) band[(i) - (j) + (j) * (k + 1)]
    for (int i = 0; i < n; i++) {
        int first = i > k ? i - k : 0;
        for (int j = first; j <= i; j++) {
            double sum = L(i, j);
            for (int s = j - k > first ? j - k : first; s < j; s++)
                sum = fma(-L(i, s), L(j, s), sum);
            L(i, j) = i == j ? 1 / sqrt(sum) : sum * L(j, j);
        }
        for (int c = 0; c < 3; c++) {
            for (int s = first; s < i; s++)
                b[c * n + i] = fma(-b[c * n + s], L(i, s), b[c * n + i]);
            b[c * n + i] *= L(i, i);
        }
    }
    for (int i = n - 1; i >= 0; i--)
        for (int c = 0; c < 3; c++) {
            b[c * n + i] *= L(i, i);
            for (int s = i - 1; s >= 0 && s >= i - k; s--)
                b[c * n + s] = fma(-L(i, s), b[c * n + i], b[c * n + s]);
        }
#undef L
}

/* ---- solving ---- */

static const int sizes[] = {1, 2, 3, 4, 5, 8, 13, 31, 64, 200}, widths[] = {0, 1, 2, 3, 4, 5, 11, 20, 33, 70};
enum { N_SIZES = sizeof sizes / sizeof *sizes, N_WIDTHS = sizeof widths / sizeof *widths, N_GRID = N_SIZES * N_WIDTHS };

static int is_left_out(int i, int j)
{
    return (i * 7 + j * 13) % 5 > 1 || i % 17 == 0; /* a ragged skyline with empty tiles, in separate pieces */
}

/* Rows sum to at most 2*70 + 0.317 beside a dominance of 0.317, so the condition number stays below 900 and |x| below
 * 150 / 0.317 (the right-hand side holds q times support position); relative to that, roundoff below 900 * 200 * 1e-16
 * = 2e-11 even if all of it added up; measured 2e-15. */
#define SOLVE_TOLERANCE 1e-12

static void assert_solution(const struct band_net *net, int lane, const double *x, double tolerance)
{
    int n = net->model.n_free;
    double size = 0;
    for (int i = 0; i < 3 * n; i++)
        size = fmax(size, fabs(x[i]));
    for (int i = 0; i < 3 * n; i++) {
        double found = *position(net, i % n, i / n, lane);
        if (tolerance > 0)
            ck_assert_double_eq_tol(found, x[i], tolerance * size);
        else
            ck_assert_msg(found == x[i], "lane %d row %d: %a, not %a", lane, i % n, found, x[i]);
    }
}

static void check_solutions(int n, int k, int (*left_out)(int i, int j), uint64_t stream)
{
    struct band_net net;
    open_band_net(&net, n, k, left_out);
    double *band = malloc((size_t)(n * (k + 1)) * sizeof(double)), *b = malloc(3 * (size_t)n * sizeof(double));
    ck_assert(band && b);
    fill(&net, stream);
    net.plan.kernels->solve(&net.plan, &net.work);
    for (int lane = 0; lane < HF_LANES; lane++) {
        int bad_row;
        ck_assert_int_eq(net.work.bad_row[lane], -1);
        assemble_plainly(&net, lane, band, b);
        ck_assert_int_eq(hf_band_solve(false, n, k, band, b, n, &bad_row), HF_OK);
        assert_solution(&net, lane, b, SOLVE_TOLERANCE);
        assemble_plainly(&net, lane, band, b);
        solve_plainly(n, k, band, b);
        assert_solution(&net, lane, b, 0);
    }
    free(band);
    free(b);
    close_band_net(&net);
}

START_TEST(full_bands_like_lapack_and_plain_loops)
{
    check_solutions(sizes[_i % N_SIZES], widths[_i / N_SIZES], NULL, (uint64_t)_i);
}
END_TEST

START_TEST(ragged_bands_like_lapack_and_plain_loops)
{
    check_solutions(sizes[_i % N_SIZES], widths[_i / N_SIZES], is_left_out, 1000 + (uint64_t)_i);
}
END_TEST

/* ---- instruction sets ---- */

static const hf_lane_isa isas[HF_LANE_N_ISA] = {HF_LANE_PORTABLE, HF_LANE_AVX2, HF_LANE_AVX512};

static int machine_has(hf_lane_isa isa)
{
    if (hf_lane_has_isa(isa)) return 1;
    char reason[64];
    snprintf(reason, sizeof reason, "no %s in this processor", hf_lane_isa_name(isa));
    skip_for_machine("unit/swarm_lane", reason);
    return 0;
}

static void iterate(struct band_net *net, hf_swarm_measures *measures)
{
    memset(measures, 0, sizeof *measures); /* its padding is compared */
    net->plan.kernels->solve(&net->plan, &net->work);
    net->plan.kernels->measure(&net->plan, &net->work, measures);
    net->plan.kernels->residual(&net->plan, &net->work, measures);
    net->plan.kernels->psi(&net->plan, &net->work, measures);
}

/* Equal bits, or both NaN. */
static int is_same(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

/* Compares all results of a step in the lanes whose bit is set in `lanes`. */
static void assert_same_lanes(const struct band_net *a, const hf_swarm_measures *a_measures, const struct band_net *b,
                              const hf_swarm_measures *b_measures, unsigned lanes)
{
    const hf_model *m = &a->model;
    const struct {
        const char *name;
        const double *a, *b;
        size_t count;
    } array[] = {{"position", a->work.position_m, b->work.position_m, 3 * (size_t)(a->plan.n_pad + m->n_node)},
                 {"length", a->work.length_m, b->work.length_m, (size_t)m->n_cable},
                 {"next q", a->work.next_q_N_per_m, b->work.next_q_N_per_m, (size_t)m->n_cable},
                 {"factor", a->work.matrix, b->work.matrix, a->plan.n_tile * HF_SWARM_BLOCK * HF_SWARM_BLOCK},
                 {"measure", a_measures->tension_error, b_measures->tension_error, 10}};
    for (size_t k = 0; k < sizeof array / sizeof *array; k++)
        for (size_t i = 0; i < array[k].count * HF_LANES; i++)
            if (lanes >> i % HF_LANES & 1)
                ck_assert_msg(is_same(array[k].a[i], array[k].b[i]), "%s %zu lane %zu: %a and %a", array[k].name,
                              i / HF_LANES, i % HF_LANES, array[k].a[i], array[k].b[i]);
    for (int l = 0; l < HF_LANES; l++) {
        if (!(lanes >> l & 1)) continue;
        ck_assert_int_eq(a->work.bad_row[l], b->work.bad_row[l]);
        ck_assert_int_eq(a_measures->is_finite[l], b_measures->is_finite[l]);
    }
}

/* Gives psi one inner node, the first row; the array of loads serves as its theoretical position. */
static void add_psi(hf_model *m)
{
    static int first_row = 0;
    m->inner_row = &first_row;
    m->n_inner_node = 1;
    m->position_m = m->load_N;
}

/* The same net, laws, targets and loads; `net` is not to be freed before `copy`. */
static void copy_band_net(struct band_net *copy, const struct band_net *net, hf_lane_isa isa)
{
    *copy = *net;
    open_plan(copy, isa);
    ck_assert_int_eq(hf_swarm_lanes_create(&copy->plan, &copy->work), HF_OK);
    memcpy(copy->work.arena.block, net->work.arena.block, hf_swarm_lanes_bytes(&net->plan));
}

static void close_copy(struct band_net *copy)
{
    hf_arena_free_block(copy->plan.block);
    hf_arena_free(&copy->work.arena);
}

/* Makes lane 2 indefinite and lane 4 not finite: these must also give equal results on every instruction set. */
static void spoil(struct band_net *net)
{
    const hf_model *m = &net->model;
    for (int e = 0; e < m->n_cable; e++) {
        net->work.q_N_per_m[e * HF_LANES + 2] *= -1;
        if (e % 11 == 3) net->work.q_N_per_m[e * HF_LANES + 4] = e % 2 ? INFINITY : (double)NAN;
    }
}

START_TEST(same_bits_on_every_instruction_set)
{
    struct band_net net, other;
    hf_swarm_measures measures, other_measures;
    open_band_net(&net, sizes[_i % N_SIZES], widths[_i / N_SIZES], _i % 2 ? is_left_out : NULL);
    add_psi(&net.model);
    fill(&net, 2000 + (uint64_t)_i);
    if (_i % 3 == 0) spoil(&net);
    for (int k = 1; k < HF_LANE_N_ISA; k++) {
        if (!machine_has(isas[k])) continue;
        copy_band_net(&other, &net, isas[k]);
        iterate(&other, &other_measures);
        struct band_net portable;
        copy_band_net(&portable, &net, HF_LANE_PORTABLE);
        iterate(&portable, &measures);
        assert_same_lanes(&portable, &measures, &other, &other_measures, 0xff);
        close_copy(&portable);
        close_copy(&other);
    }
    close_band_net(&net);
}
END_TEST

START_TEST(solve_is_assemble_factor_substitute)
{
    if (!machine_has(isas[_i])) return;
    struct band_net net, other;
    hf_swarm_measures none = {0};
    open_band_net(&net, 61, 13, is_left_out);
    fill(&net, 3000);
    memset(net.work.next_q_N_per_m, 0, (size_t)net.model.n_cable * HF_LANES * sizeof(double));
    memset(net.work.length_m, 0, (size_t)net.model.n_cable * HF_LANES * sizeof(double));
    copy_band_net(&other, &net, isas[_i]);
    other.plan.kernels->assemble(&other.plan, &other.work);
    other.plan.kernels->factor(&other.plan, &other.work);
    other.plan.kernels->substitute(&other.plan, &other.work);
    net.plan.kernels->solve(&net.plan, &net.work);
    assert_same_lanes(&net, &none, &other, &none, 0xff);
    close_copy(&other);
    close_band_net(&net);
}
END_TEST

/* ---- lanes apart ---- */

START_TEST(a_bad_lane_disturbs_no_other)
{
    if (!machine_has(isas[_i])) return;
    struct band_net good, bad;
    hf_swarm_measures good_measures, bad_measures;
    open_band_net(&good, 61, 13, is_left_out);
    add_psi(&good.model);
    fill(&good, 4000);
    copy_band_net(&bad, &good, isas[_i]);
    spoil(&bad);
    for (int e = 0; e < bad.model.n_cable; e++)
        bad.work.q_N_per_m[e * HF_LANES + 7] = bad.work.target[e * HF_LANES + 7] = (e % 2 ? 1e300 : 1e-300) * e;
    iterate(&good, &good_measures);
    iterate(&bad, &bad_measures);
    assert_same_lanes(&good, &good_measures, &bad, &bad_measures, 0x6b); /* all but 2, 4 and 7 */
    ck_assert_int_eq(bad.work.bad_row[2], 0);
    ck_assert(bad.work.bad_row[4] >= 0 || !bad_measures.is_finite[4]);
    for (int l = 0; l < HF_LANES; l++) {
        ck_assert_int_eq(good.work.bad_row[l], -1);
        ck_assert(good_measures.is_finite[l]);
    }
    close_copy(&bad);
    close_band_net(&good);
}
END_TEST

/* The row that LAPACK names, whatever its place in a block. */
START_TEST(the_first_bad_pivot_is_named)
{
    struct band_net net;
    double *band = malloc(23 * 6 * sizeof(double)), b[3 * 23];
    ck_assert_ptr_nonnull(band);
    open_band_net(&net, 23, 5, NULL);
    fill(&net, 5000);
    for (int e = 0; e < net.model.n_cable; e++) /* lane l: the support cable of row l + _i pulls the wrong way */
        for (int l = 0; l < HF_LANES; l++)
            if (net.model.end_row[2 * e] + net.model.end_row[2 * e + 1] == 23 + 2 * (l + _i))
                net.work.q_N_per_m[e * HF_LANES + l] -= 20;
    net.plan.kernels->solve(&net.plan, &net.work);
    for (int l = 0; l < HF_LANES; l++) {
        int bad_row;
        assemble_plainly(&net, l, band, b);
        ck_assert_int_eq(hf_band_solve(false, 23, 5, band, b, 23, &bad_row), HF_SINGULAR);
        ck_assert_int_eq(net.work.bad_row[l], bad_row);
        for (int row = 0; row < 23; row++)
            ck_assert_double_finite(*position(&net, row, 0, l)); /* nothing has blown up */
    }
    free(band);
    close_band_net(&net);
}
END_TEST

/* ---- whole iterations, against formfind ---- */

/* Individuals of a case: force densities of lane l are the model's but for a few percent. */
static void set_individual(struct net *net, int l)
{
    hf_form_prepare(&net->model, &net->work);
    memcpy(net->work.position_m, net->model.position_m, 3 * (size_t)net->model.n_node * sizeof(double));
    for (int e = 0; e < net->model.n_cable; e++)
        net->work.q_N_per_m[e] *= 1 + 0.01 * ((e * (l + 3)) % 7 - 3);
}

/* `steps` iterations of the scalar code, kept from stopping early; then the lane's. The paper's rule, because it lets a
 * straight chain pass. */
static void compare_lane(struct net *net, const hf_swarm_plan *plan, const hf_swarm_lanes *w,
                         const hf_swarm_measures *measures, int lane, int steps, double tolerance)
{
    const hf_model *m = &net->model;
    hf_workspace *scalar = &net->work, from_lane;
    set_individual(net, lane);
    hf_form_settings form = net->form;
    form.max_iterations = steps;
    form.rms_tolerance_m = 0;
    hf_form_find(m, &form, HF_STOP_RMS_CHANGE, scalar, NULL, &net->result);
    ck_assert_int_eq(net->result.status, HF_NOT_CONVERGED);
    ck_assert_int_eq(net->result.iterations, steps);
    ck_assert_int_eq(hf_workspace_create(m, &from_lane), HF_OK);
    hf_swarm_get(plan, w, lane, &from_lane);
    for (int i = 0; i < 3 * m->n_node; i++)
        ck_assert_double_eq_tol(from_lane.position_m[i], scalar->position_m[i], tolerance);
    for (int e = 0; e < m->n_cable; e++) {
        double q = scalar->q_N_per_m[e], next = w->next_q_N_per_m[e * HF_LANES + lane];
        ck_assert_double_eq_tol(from_lane.q_N_per_m[e], q, tolerance * q);
        ck_assert_double_eq_tol(from_lane.length_m[e], scalar->length_m[e], tolerance);
        ck_assert_double_eq_tol(from_lane.tension_N[e], scalar->tension_N[e], tolerance * q);
        if (scalar->law[e] == HF_LAW_TENSION) q = scalar->target[e] / scalar->length_m[e];
        if (scalar->law[e] == HF_LAW_LENGTH) q *= scalar->length_m[e] / scalar->target[e];
        ck_assert_double_eq_tol(next, q, tolerance * q);
    }
    const hf_form_result *r = &net->result;
    ck_assert(measures->is_finite[lane]);
    ck_assert_int_eq(w->bad_row[lane], -1);
    ck_assert_double_eq_tol(measures->tension_error[lane], r->tension_error, 10 * tolerance);
    ck_assert_double_eq_tol(measures->length_error[lane], r->length_error, 10 * tolerance);
    ck_assert_double_eq_tol(measures->residual_N[lane], r->residual_N, 100 * tolerance);
    ck_assert_double_eq_tol(measures->psi_m[lane], r->psi_m, tolerance);
    ck_assert_double_eq_tol(measures->shortest_length_ratio[lane], r->shortest_length_ratio, 10 * tolerance);
    hf_workspace_free(&from_lane);
}

/* Metres and N/m are of size 1 to 100 here and D is well conditioned: roundoff of a solve is some 1e-14, and an
 * iteration does not amplify the errors of the one before. Measured: 7e-15 after one iteration, 2e-14 after ten. */
#define STEP_TOLERANCE 1e-12

static void compare_with_formfind(struct net *net, int isa)
{
    hf_swarm_plan plan;
    hf_swarm_lanes w;
    hf_swarm_measures measures;
    ck_assert_int_eq(hf_swarm_plan_create(&net->model, isas[isa], &plan), HF_OK);
    ck_assert_int_eq(hf_swarm_lanes_create(&plan, &w), HF_OK);
    memset(w.arena.block, 0xff, hf_swarm_lanes_bytes(&plan));
    for (int l = 0; l < HF_LANES; l++) {
        set_individual(net, l);
        hf_swarm_put(&plan, &net->work, l, &w);
    }
    memcpy(w.law, net->work.law, (size_t)net->model.n_cable);
    for (int step = 1; step <= 10; step++) {
        plan.kernels->solve(&plan, &w);
        plan.kernels->measure(&plan, &w, &measures);
        plan.kernels->residual(&plan, &w, &measures);
        plan.kernels->psi(&plan, &w, &measures);
        for (int l = 0; l < HF_LANES && (step == 1 || step == 10); l++)
            compare_lane(net, &plan, &w, &measures, l, step, STEP_TOLERANCE);
        hf_swarm_update(&w);
    }
    hf_arena_free(&w.arena);
    hf_arena_free_block(plan.block);
}

START_TEST(iterations_like_formfind_on_the_papers_net)
{
    struct net net;
    if (!machine_has(isas[_i])) return;
    OPEN_CASE(&net, "configs/straight-edges.yaml");
    compare_with_formfind(&net, _i);
    close_net(&net);
}
END_TEST

START_TEST(iterations_like_formfind_on_a_scalloped_net)
{
    struct net net;
    if (!machine_has(isas[_i])) return;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    compare_with_formfind(&net, _i);
    close_net(&net);
}
END_TEST

/* Two free nodes on a line between supports at 0 and 3 m; equal q make all lengths 1 m. One law to each cable. */
START_TEST(measures_by_hand)
{
    struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                               {{1.1, 0, 0}, HF_ROLE_INNER, {0}},
                               {{2.2, 0, 0}, HF_ROLE_INNER, {0}},
                               {{3, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 8},
                                 {{1, 2}, HF_GROUP_INNER, HF_LAW_LENGTH, 0.8},
                                 {{2, 3}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 10}};
    static const double q[HF_LANES] = {10, 1, 0.001, 0.001, 10, 10, 10, 10},
                        wanted_m[HF_LANES] = {0.8, 1.25, 1.25, 0.8, 1, 1, 1, 1};
    struct net net;
    hf_swarm_plan plan;
    hf_swarm_lanes w;
    hf_swarm_measures m;
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    double pull = 0.001 / net.model.reference_N; /* of a cable with q = 0.001 */
    ck_assert(pull < HF_SLACK_RATIO && 1000 * pull < 1 && 1000 * pull > HF_SLACK_RATIO);
    ck_assert_int_eq(hf_swarm_plan_create(&net.model, hf_lane_best_isa(), &plan), HF_OK);
    ck_assert_int_eq(hf_swarm_lanes_create(&plan, &w), HF_OK);
    hf_form_prepare(&net.model, &net.work);
    memcpy(net.work.position_m, net.model.position_m, 12 * sizeof(double));
    memcpy(w.law, net.work.law, 3);
    for (int l = 0; l < HF_LANES; l++) {
        for (int e = 0; e < 3; e++)
            net.work.q_N_per_m[e] = q[l];
        net.work.target[1] = wanted_m[l];
        hf_swarm_put(&plan, &net.work, l, &w);
    }
    plan.kernels->solve(&plan, &w);
    plan.kernels->measure(&plan, &w, &m);
    plan.kernels->residual(&plan, &w, &m);
    ck_assert_double_eq_tol(m.tension_error[0], 0.25, ROUNDOFF); /* 10 N for 8 N */
    ck_assert_double_eq_tol(m.length_error[0], 0.25, ROUNDOFF);  /* 1 m for 0.8 m */
    ck_assert_double_eq_tol(m.length_gap[0], 0.25, ROUNDOFF);
    ck_assert_double_eq_tol(m.residual_N[0], 2, 10 * ROUNDOFF); /* 8 N against 10 N */
    ck_assert_double_eq_tol(m.shortest_of_law[HF_LAW_TENSION][0], 1 / 1.1, ROUNDOFF);
    ck_assert_double_eq_tol(m.shortest_of_law[HF_LAW_LENGTH][0], 1 / 1.1, ROUNDOFF);
    ck_assert_double_eq_tol(m.shortest_of_law[HF_LAW_FORCE_DENSITY][0], 1 / 0.8, ROUNDOFF);
    ck_assert_double_eq_tol(m.shortest_length_ratio[0], 1 / 1.1, ROUNDOFF);
    ck_assert_double_eq_tol(m.longest_length_ratio[0], 1 / 0.8, ROUNDOFF);
    ck_assert_double_eq_tol(w.next_q_N_per_m[0], 8, 10 * ROUNDOFF);
    ck_assert_double_eq_tol(w.next_q_N_per_m[HF_LANES], 12.5, 20 * ROUNDOFF);
    ck_assert_double_eq(w.next_q_N_per_m[2 * HF_LANES], 10);
    ck_assert_double_eq_tol(m.length_error[1], 0.2, ROUNDOFF); /* taut: as long as L*, neither more nor less */
    ck_assert_double_eq_tol(m.length_gap[1], 0.2, ROUNDOFF);
    ck_assert_double_eq(m.length_error[2],
                        0); /* slack: no length is wrong but one above L*; what pull is left counts */
    ck_assert_double_eq_tol(m.length_gap[2], 0.2 * pull, ROUNDOFF);
    ck_assert_double_eq(m.length_error[3], 0);
    ck_assert_double_eq_tol(m.length_gap[3], 0.25, ROUNDOFF);
    /* a force density and a length that are finite, a tension that is not */
    w.q_N_per_m[4] = 1e300;
    int a = net.model.end_row[0], b = net.model.end_row[1], row = a < b ? a : b;
    w.position_m[(plan.n_pad + row) * 3 * HF_LANES + 4] = 1e10;
    plan.kernels->measure(&plan, &w, &m);
    for (int l = 0; l < HF_LANES; l++)
        ck_assert_int_eq(m.is_finite[l], l != 4);
    hf_arena_free(&w.arena);
    hf_arena_free_block(plan.block);
    close_net(&net);
}
END_TEST

Suite *suite_unit_swarm_lane(void)
{
    Suite *suite = suite_create("unit/swarm_lane");
    TCase *solving = tcase_create("solving"), *isa = tcase_create("isa"), *apart = tcase_create("apart"),
          *whole = tcase_create("whole");
    tcase_add_checked_fixture(solving, without_guards, NULL); /* poison fills the whole block */
    tcase_add_loop_test(solving, full_bands_like_lapack_and_plain_loops, 0, N_GRID);
    tcase_add_loop_test(solving, ragged_bands_like_lapack_and_plain_loops, 0, N_GRID);
    tcase_add_checked_fixture(isa, without_guards, NULL);
    tcase_add_loop_test(isa, same_bits_on_every_instruction_set, 0, N_GRID);
    tcase_add_loop_test(isa, solve_is_assemble_factor_substitute, 0, HF_LANE_N_ISA);
    tcase_add_checked_fixture(apart, without_guards, NULL);
    tcase_add_loop_test(apart, a_bad_lane_disturbs_no_other, 0, HF_LANE_N_ISA);
    tcase_add_loop_test(apart, the_first_bad_pivot_is_named, 0, 15);
    tcase_add_checked_fixture(whole, without_guards, NULL);
    tcase_add_loop_test(whole, iterations_like_formfind_on_the_papers_net, 0, HF_LANE_N_ISA);
    tcase_add_loop_test(whole, iterations_like_formfind_on_a_scalloped_net, 0, HF_LANE_N_ISA);
    tcase_add_test(whole, measures_by_hand);
    suite_add_tcase(suite, solving);
    suite_add_tcase(suite, isa);
    suite_add_tcase(suite, apart);
    suite_add_tcase(suite, whole);
    return suite;
}
