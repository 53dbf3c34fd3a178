/* The chord population solver: the answers of hf_evaluate, to the same bits whatever else is in the batch.
 * Contents: its answers - independence - designs that fail - choice and fallback. */
#include "laws.h"
#include "population.h"
#include "verified.h"

#include "linalg/band.h"
#include "search/chord.h"
#include "solve/newton_matrix.h"
#include <hifdm/batch.h>

#include <math.h>
#include <stdlib.h>

/* All designs in batches of n_at_once. */
static void evaluate(struct run *r, int n_thread, int n_at_once, hf_form_result result[N_DESIGN])
{
    hf_batch batch;
    memset(result, 0, N_DESIGN * sizeof *result); /* padding included: results are compared as bytes */
    ck_assert_int_eq(hf_batch_create(&r->evaluator, n_thread, &batch), HF_OK);
    ck_assert_int_eq(hf_batch_share(&batch, r->initial), HF_SOLVER_CHORD);
    for (int i = 0; i < batch.n_thread; i++)
        poison_workspace(&r->net.model, &batch.workspace[i]);
    for (int i = 0; i < N_DESIGN; i += n_at_once)
        hf_batch_run(&batch, N_DESIGN - i < n_at_once ? N_DESIGN - i : n_at_once, design(r, i), NULL, result + i);
    hf_batch_free(&batch);
}

static void assert_same(const hf_form_result *a, const hf_form_result *b, int n)
{
    for (int i = 0; i < n; i++)
        ck_assert_msg(!memcmp(a + i, b + i, sizeof *a), "design %d: %s psi %.17g m, or %s psi %.17g m", i,
                      hf_status_word(a[i].status), a[i].psi_m, hf_status_word(b[i].status), b[i].psi_m);
}

/* ---- its answers ---- */

/* Verified: the nodal forces under the laws of the design, worked out from the positions, are within the tolerance; by
 * Newton the same shape: both within 1e-9 N, which moves nodes by 1e-8 m where the net is softest, some 0.1 N/m. */
static void assert_answers(struct run *r)
{
    const hf_model *m = &r->net.model;
    hf_batch batch;
    unsigned char law[MAX_CABLE];
    double target[MAX_CABLE];
    ck_assert_int_eq(hf_batch_create(&r->evaluator, 1, &batch), HF_OK);
    ck_assert_int_eq(hf_batch_share(&batch, r->initial), HF_SOLVER_CHORD);
    memcpy(law, m->law, (size_t)m->n_cable);
    memcpy(target, m->target, (size_t)m->n_cable * sizeof *target);
    for (int i = 0; i < N_DESIGN; i++) {
        hf_form_result by_chord, by_newton;
        hf_workspace *w = hf_batch_run_one(&batch, design(r, i), &by_chord);
        ck_assert_int_eq(by_chord.status, HF_OK);
        for (int k = 0; k < m->n_variable; k++) {
            int e = m->variable_cable[k], by_density = r->evaluator.rule == HF_RULE_FORCE_DENSITY;
            law[e] = by_density ? HF_LAW_FORCE_DENSITY : HF_LAW_TENSION;
            target[e] = design(r, i)[k] / (by_density ? hf_evaluate_design_length_m(m, e) : 1);
        }
        struct verified v = verify_shape(m, w, law, target);
        ck_assert_double_le(v.residual_N, 1.001 * TOLERANCE * m->reference_N);
        ck_assert_double_eq_tol(v.residual_N, by_chord.residual_N, 1e-12);
        ck_assert_int_eq(hf_evaluate(&r->evaluator, design(r, i), &r->net.work, NULL, &by_newton), HF_OK);
        ck_assert_double_eq_tol(by_chord.psi_m, by_newton.psi_m, 1e-8);
        ck_assert_double_eq_tol(by_chord.inner_tension_ratio, by_newton.inner_tension_ratio, 1e-8);
        ck_assert_double_eq_tol(by_chord.boundary_tension_ratio, by_newton.boundary_tension_ratio, 1e-7);
        ck_assert_double_eq_tol(by_chord.shortest_length_ratio, by_newton.shortest_length_ratio, 1e-7);
        ck_assert_double_le(largest_move_m(m, w->position_m, r->net.work.position_m), 1e-8);
        ck_assert_int_eq(by_chord.n_slack, by_newton.n_slack);
        ck_assert_int_eq(by_chord.stop_reason, HF_STOPPED_CONVERGED);
    }
    hf_batch_free(&batch);
}

START_TEST(answers_are_newtons)
{
    struct run r;
    open_run(&r, _i);
    assert_answers(&r);
    close_net(&r.net);
}
END_TEST

static int count_down(void *context)
{
    int *n_left = context;
    return --*n_left;
}

/* The kernels measure a shape as the scalar code does, which they are made to leave it to by serves_all; both up to
 * some roundings of coordinates of 10 m, 1e-15 m, times force densities of some 100 N/m. */
START_TEST(figures_are_those_of_the_scalar_code)
{
    struct run r;
    hf_chord chord;
    hf_chord_lanes lanes;
    hf_form_result result[2][N_DESIGN];
    open_run(&r, _i);
    ck_assert_int_eq(hf_chord_create(&r.evaluator, r.initial, &r.net.work, NULL, &chord), HF_OK);
    ck_assert_int_eq(hf_chord_lanes_create(&chord, &lanes), HF_OK);
    ck_assert(chord.serves_all);
    for (int k = 0; k < 2; k++) {
        int n_left = N_DESIGN;
        chord.serves_all = k == 0;
        hf_chord_run(&chord, &lanes, &r.net.work, NULL, count_down, &n_left, false, r.design, result[k]);
    }
    for (int i = 0; i < N_DESIGN; i++) {
        const hf_form_result *a = &result[0][i], *b = &result[1][i];
        ck_assert(a->status == HF_OK && b->status == HF_OK && a->stop_reason == b->stop_reason);
        ck_assert(a->iterations == b->iterations && a->culprit == b->culprit && a->n_slack == b->n_slack);
        ck_assert_double_eq_tol(a->psi_m, b->psi_m, 1e-15);
        ck_assert_double_eq_tol(a->residual_N, b->residual_N, 1e-12);
        ck_assert_double_eq_tol(a->tension_error, b->tension_error, 1e-15);
        ck_assert_double_eq_tol(a->inner_tension_ratio, b->inner_tension_ratio, 1e-14);
        ck_assert_double_eq_tol(a->boundary_tension_ratio, b->boundary_tension_ratio, 1e-14);
        ck_assert_double_eq_tol(a->shortest_length_ratio, b->shortest_length_ratio, 1e-15);
        ck_assert(a->length_error == b->length_error && a->n_loose == 0 && isnan(a->condition));
    }
    hf_arena_free(&lanes.arena);
    hf_arena_free(&chord.arena);
    close_net(&r.net);
}
END_TEST

/* A shape that is refused has the status and the culprit that the scalar code gives it: the first cable at fault. */
START_TEST(faults_are_named)
{
    struct run r;
    hf_batch batch;
    hf_form_result result[N_DESIGN];
    int first = 0;
    open_run(&r, HF_RULE_FORCE_DENSITY);
    while (r.net.model.law[first] != HF_LAW_TENSION)
        first++;
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 2, &batch), HF_OK);
    ck_assert_int_eq(hf_batch_share(&batch, r.initial), HF_SOLVER_CHORD);
    r.net.form.collapse_ratio = 10;
    hf_batch_run(&batch, N_DESIGN, r.design, NULL, result);
    for (int i = 0; i < N_DESIGN; i++) {
        ck_assert_int_eq(result[i].status, HF_COLLAPSED);
        ck_assert_int_eq(result[i].culprit, first);
        ck_assert_double_nan(result[i].psi_m);
    }
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

/* Other sizes and bandwidths, with loads and all laws. */
START_TEST(answers_are_newtons_on_random_nets)
{
    struct run r = {.net = {.form = tight_form(HF_METHOD_HIFDM)}};
    struct rng rng = rng_start(40 + (uint64_t)_i);
    random_reflector_scene(&rng, &r.net.scene);
    if (_i % 2) mix_laws(&rng, &r.net.scene);
    open_net(&r.net);
    start_run(&r, HF_RULE_FORCE_DENSITY);
    assert_answers(&r);
    close_net(&r.net);
}
END_TEST

/* The solve for any right-hand sides agrees with LAPACK to rounding times the condition number, 1e7 at most here. */
START_TEST(many_right_hand_sides)
{
    struct run r;
    struct rng rng = rng_start((uint64_t)_i);
    open_run(&r, HF_RULE_FORCE_DENSITY);
    const hf_model *m = &r.net.model;
    int n = 3 * m->n_free, n_rhs = 1 + 6 * _i; /* 1, 7, 13: less than one pass of 8, and more than one */
    size_t ld = (size_t)n + 3;
    double *b = malloc((size_t)n_rhs * ld * sizeof *b), *x = malloc((size_t)n_rhs * ld * sizeof *x), largest = 0;
    for (size_t i = 0; i < (size_t)n_rhs * ld; i++)
        b[i] = x[i] = rng_uniform(&rng, -1, 1);
    ck_assert_int_eq(hf_evaluate(&r.evaluator, r.design, &r.net.work, NULL, &(hf_form_result){0}), HF_OK);
    ck_assert_int_eq(hf_newton_matrix_factor(m, &r.net.work, NULL), HF_OK);
    hf_packed_band packed = hf_newton_matrix_packed(m);
    hf_arena arena = {0};
    double *lanes;
    ck_assert_int_eq(
        HF_ARENA_MAKE(&arena, (hf_packed_band_lay_out(&arena, &packed),
                               lanes = hf_arena_take(&arena, hf_packed_band_rows(&packed) * HF_LANES, sizeof *lanes))),
        HF_OK);
    hf_packed_band_pack(&packed, r.net.work.newton_band);
    hf_packed_band_back_solve(&packed, lanes, n_rhs, x, ld);
    for (int k = 0; k < n_rhs; k++) {
        double *want = b + (size_t)k * ld, *got = x + (size_t)k * ld;
        ck_assert_mem_eq(want + n, got + n, 3 * sizeof(double)); /* the rows after the n of a column are not touched */
        hf_band_back_solve(n, 3 * m->half_bandwidth + 2, 1, r.net.work.newton_band, want, n);
        for (int i = 0; i < n; i++)
            largest = fmax(largest, fabs(want[i]));
        for (int i = 0; i < n; i++)
            ck_assert_double_eq_tol(got[i], want[i], 1e-9 * largest);
    }
    ck_assert_double_gt(largest, 0);
    hf_arena_free(&arena);
    free(b);
    free(x);
    close_net(&r.net);
}
END_TEST

/* ---- independence ---- */

START_TEST(threads_and_grouping_do_not_change_a_bit)
{
    struct run r;
    hf_form_result alone[N_DESIGN], other[N_DESIGN];
    open_run(&r, _i);
    evaluate(&r, 1, 1, alone);
    static const int n_thread[] = {1, 2, 3, 7}, n_at_once[] = {N_DESIGN, 4, 9};
    for (int k = 0; k < 4 * 3; k++) {
        evaluate(&r, n_thread[k / 3], n_at_once[k % 3], other);
        assert_same(alone, other, N_DESIGN);
    }
    close_net(&r.net);
}
END_TEST

START_TEST(order_does_not_change_a_bit)
{
    struct run r;
    hf_form_result forward[N_DESIGN], backward[N_DESIGN];
    open_run(&r, _i);
    size_t bytes = (size_t)r.net.model.n_variable * sizeof(double);
    evaluate(&r, 1, N_DESIGN, forward);
    for (int i = 0; i < N_DESIGN / 2; i++) {
        double kept[MAX_VARIABLE];
        memcpy(kept, design(&r, i), bytes);
        memcpy(design(&r, i), design(&r, N_DESIGN - 1 - i), bytes);
        memcpy(design(&r, N_DESIGN - 1 - i), kept, bytes);
    }
    evaluate(&r, 1, N_DESIGN, backward);
    for (int i = 0; i < N_DESIGN; i++)
        assert_same(forward + i, backward + N_DESIGN - 1 - i, 1);
    close_net(&r.net);
}
END_TEST

/* ---- designs that fail ---- */

/* Designs far from the base, without an equilibrium, or with a NaN: each gets the result that hf_evaluate gives it
 * alone. No bit of any other design changes, not even of those that are loaded into the same lane afterwards. */
START_TEST(strangers_disturb_nobody)
{
    static const struct {
        int at;
        double factor;
        hf_status status[2]; /* force_density, tension */
    } stranger[] = {{3, 6, {HF_OK, HF_COLLAPSED}},
                    {5, 0.01, {HF_OK, HF_COLLAPSED}},
                    {11, 1e200, {HF_COLLAPSED, HF_COLLAPSED}},
                    {12, NAN, {HF_NOT_FINITE, HF_NOT_FINITE}}};
    struct run r;
    hf_form_result good[N_DESIGN], mixed[N_DESIGN];
    open_run(&r, _i);
    evaluate(&r, 1, N_DESIGN, good);
    for (size_t k = 0; k < sizeof stranger / sizeof *stranger; k++)
        design(&r, stranger[k].at)[1] *= stranger[k].factor;
    for (int n_thread = 1; n_thread <= 2; n_thread++) {
        evaluate(&r, n_thread, N_DESIGN, mixed);
        for (size_t k = 0; k < sizeof stranger / sizeof *stranger; k++) {
            int i = stranger[k].at;
            hf_form_result direct;
            hf_status status = hf_evaluate(&r.evaluator, design(&r, i), &r.net.work, NULL, &direct);
            ck_assert_int_eq(status, stranger[k].status[_i]);
            ck_assert_int_eq(mixed[i].status, status);
            if (status == HF_OK)
                ck_assert_double_eq_tol(mixed[i].psi_m, direct.psi_m, 1e-8);
            else
                ck_assert_double_nan(mixed[i].psi_m);
            mixed[i] = good[i];
        }
        assert_same(good, mixed, N_DESIGN);
    }
    close_net(&r.net);
}
END_TEST

START_TEST(ratio_cap_is_kept)
{
    struct run r;
    hf_form_result free_of_it[N_DESIGN], capped[N_DESIGN];
    int n_capped = 0;
    open_run(&r, HF_RULE_FORCE_DENSITY);
    evaluate(&r, 2, N_DESIGN, free_of_it);
    r.evaluator.boundary_ratio_cap = free_of_it[7].boundary_tension_ratio;
    evaluate(&r, 2, N_DESIGN, capped);
    for (int i = 0; i < N_DESIGN; i++) {
        int is_above = free_of_it[i].boundary_tension_ratio > r.evaluator.boundary_ratio_cap;
        n_capped += is_above;
        ck_assert_int_eq(capped[i].status, is_above ? HF_RATIO_CAP : HF_OK);
        if (is_above)
            ck_assert_double_nan(capped[i].psi_m);
        else
            assert_same(free_of_it + i, capped + i, 1);
    }
    ck_assert_int_gt(n_capped, 0);
    ck_assert_int_lt(n_capped, N_DESIGN);
    close_net(&r.net);
}
END_TEST

/* ---- choice and fallback ---- */

START_TEST(applies_where_it_can_serve)
{
    struct run r;
    hf_batch batch;
    open_run(&r, HF_RULE_FORCE_DENSITY);
    static const int solver[] = {HF_SOLVER_AUTO, HF_SOLVER_CHORD, HF_SOLVER_NEWTON, HF_SOLVER_FIXED_POINT};
    static const int shared[] = {HF_SOLVER_CHORD, HF_SOLVER_CHORD, HF_SOLVER_NEWTON, HF_SOLVER_FIXED_POINT};
    for (int k = 0; k < 4; k++) {
        r.evaluator.solver = (hf_solver)solver[k];
        ck_assert_int_eq(hf_batch_create(&r.evaluator, 2, &batch), HF_OK);
        ck_assert_int_eq(hf_batch_share(&batch, r.initial), shared[k]);
        hf_batch_free(&batch);
    }
    ck_assert(hf_chord_applies(&r.evaluator));
    r.evaluator.rule = HF_RULE_SEEDED;
    ck_assert(!hf_chord_applies(&r.evaluator));
    r.evaluator.rule = HF_RULE_TENSION;
    ck_assert(hf_chord_applies(&r.evaluator));
    for (int e = 0; e < r.net.model.n_cable; e++) /* an inner cable whose length is prescribed needs its multiplier */
        if (r.net.model.group[e] == HF_GROUP_INNER) {
            r.net.model.law[e] = HF_LAW_LENGTH;
            break;
        }
    ck_assert(!hf_chord_applies(&r.evaluator));
    close_net(&r.net);
}
END_TEST

/* A base without a shape, and no memory: each design on its own, to the bits of hf_evaluate. */
START_TEST(nothing_to_share)
{
    struct run r;
    hf_batch batch;
    open_run(&r, HF_RULE_TENSION);
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 2, &batch), HF_OK);
    r.initial[0] *= 50;
    ck_assert_int_eq(hf_batch_share(&batch, r.initial), HF_SOLVER_NEWTON);
    r.initial[0] /= 50;
    for (long n = 1;; n++) {
        fail_allocation_at(n);
        hf_solver solver = hf_batch_share(&batch, r.initial);
        if (!end_allocation_failure()) {
            ck_assert_int_eq(solver, HF_SOLVER_CHORD);
            ck_assert_int_gt(n, 3);
            break;
        }
        hf_form_result direct, result;
        ck_assert_int_eq(solver, HF_SOLVER_NEWTON);
        hf_batch_run(&batch, 1, r.design, NULL, &result);
        ck_assert_int_eq(hf_evaluate(&r.evaluator, r.design, &r.net.work, NULL, &direct), HF_OK);
        ck_assert_double_eq(result.psi_m, direct.psi_m);
    }
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

START_TEST(nothing_is_allocated)
{
    struct run r;
    hf_batch batch;
    hf_form_result result[N_DESIGN];
    open_run(&r, HF_RULE_FORCE_DENSITY);
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 2, &batch), HF_OK);
    hf_batch_share(&batch, r.initial);
    long before = allocation_count();
    hf_batch_run(&batch, N_DESIGN, r.design, NULL, result);
    ck_assert_int_eq(allocation_count(), before);
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

Suite *suite_unit_chord(void)
{
    Suite *suite = suite_create("unit/chord");
    TCase *tests = tcase_create("chord");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, answers_are_newtons, 0, 2);
    tcase_add_loop_test(tests, answers_are_newtons_on_random_nets, 0, 8);
    tcase_add_loop_test(tests, figures_are_those_of_the_scalar_code, 0, 2);
    tcase_add_test(tests, faults_are_named);
    tcase_add_loop_test(tests, many_right_hand_sides, 0, 3);
    tcase_add_loop_test(tests, threads_and_grouping_do_not_change_a_bit, 0, 2);
    tcase_add_loop_test(tests, order_does_not_change_a_bit, 0, 2);
    tcase_add_loop_test(tests, strangers_disturb_nobody, 0, 2);
    tcase_add_test(tests, ratio_cap_is_kept);
    tcase_add_test(tests, applies_where_it_can_serve);
    tcase_add_test(tests, nothing_to_share);
    tcase_add_test(tests, nothing_is_allocated);
    return suite;
}
