/* Designs on an elastic truss: the population solver against hf_evaluate, threads, sensitivities. */
#include "flexible.h"
#include "population.h"

#include "linalg/band.h"
#include "solve/coupling.h"
#include "solve/schur.h"
#include "solve/newton_matrix.h"
#include "search/refine.h"
#include <hifdm/batch.h>

static const double scale_m_per_N[] = {1e-6, 1e-5, 1e-4}; /* the last one needs the modes of (I + F S)^-1 */

static void open_designs(struct run *r, int rule, double scale)
{
    struct rng rng = {11};
    open_run(r, rule);
    attach_all(&r->net, &rng, scale);
    r->net.form.coupling = (hf_coupling_settings){1e-10, HF_COUPLING_ACCELERATED, 200};
}

/* The chord run stops at 1e-9 N and 1e-10 m, hf_evaluate there or earlier: where the net is softest, some 0.1 N/m, that
 * is 1e-8 m of position; psi, a mean, agrees far better. */
START_TEST(chord_gives_what_evaluate_gives)
{
    struct run r;
    hf_batch batch;
    open_designs(&r, _i / 3, scale_m_per_N[_i % 3]);
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 1, &batch), HF_OK);
    ck_assert_int_eq(hf_batch_share(&batch, r.initial), HF_SOLVER_CHORD);
    for (int i = 0; i < N_DESIGN; i++) {
        hf_form_result chord, alone;
        const hf_model *m = &r.net.model;
        hf_workspace *w = hf_batch_run_one(&batch, design(&r, i), &chord);
        ck_assert_int_eq(chord.status, HF_OK);
        ck_assert_int_eq(chord.coupling.stop_reason, HF_COUPLING_CONVERGED);
        ck_assert_int_le(chord.iterations, 20);
        ck_assert_double_le(chord.residual_N, TOLERANCE * m->reference_N * 1.001);
        hf_form_result again = chord; /* scalar code measures the gap of the truss at the returned shape */
        ck_assert_double_le(hf_coupling_measure(m, w, &again), 1.01e-10);
        ck_assert_double_eq(again.coupling.deflection_max_m, chord.coupling.deflection_max_m);
        ck_assert_int_eq(hf_evaluate(&r.evaluator, design(&r, i), &r.net.work, NULL, &alone), HF_OK);
        ck_assert_double_eq_tol(chord.psi_m, alone.psi_m, 1e-9);
        ck_assert_double_eq_tol(chord.coupling.deflection_max_m, alone.coupling.deflection_max_m, 1e-9);
        for (int k = 0; k < 3 * m->n_node; k++)
            ck_assert_double_eq_tol(w->position_m[k], r.net.work.position_m[k], 1e-8);
    }
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

/* Holds for every solver: chord, the lanes' fallback, the paper's rule. */
START_TEST(threads_and_grouping_do_not_change_a_bit)
{
    static const int solver[] = {HF_SOLVER_CHORD, HF_SOLVER_NEWTON, HF_SOLVER_FIXED_POINT, HF_SOLVER_AUTO};
    static const int n_thread[] = {1, 2, 7};
    static hf_form_result result[3][N_DESIGN];
    struct run r;
    open_designs(&r, _i == 3 ? HF_RULE_SEEDED : HF_RULE_FORCE_DENSITY, 1e-5);
    if (_i > 1) r.net.form.coupling.tof_m = 1e-7;
    if (_i > 1) r.net.form.residual_tolerance = 1e-6; /* these converge as slowly as the paper's iteration */
    r.evaluator.solver = (hf_solver)solver[_i];
    memset(result, 0, sizeof result);
    for (int k = 0; k < 3; k++) {
        hf_batch batch;
        int n_at_once = k == 1 ? 5 : N_DESIGN;
        ck_assert_int_eq(hf_batch_create(&r.evaluator, n_thread[k], &batch), HF_OK);
        hf_batch_share(&batch, r.initial);
        for (int i = 0; i < N_DESIGN; i += n_at_once)
            hf_batch_run(&batch, N_DESIGN - i < n_at_once ? N_DESIGN - i : n_at_once, design(&r, i), NULL,
                         result[k] + i);
        hf_batch_free(&batch);
    }
    for (int i = 0; i < N_DESIGN; i++) {
        ck_assert_int_eq(result[0][i].status, HF_OK);
        ck_assert_double_gt(result[0][i].coupling.deflection_max_m, 1e-5);
        for (int k = 1; k < 3; k++)
            ck_assert_mem_eq(&result[0][i], &result[k][i], sizeof result[0][i]);
    }
    close_net(&r.net);
}
END_TEST

/* The shared matrix with supports that cannot move gives the bits of fixed ones. */
START_TEST(a_rigid_truss_changes_no_bit_of_a_design)
{
    struct run fixed, rigid;
    hf_batch batch[2];
    hf_form_result result[2];
    open_run(&fixed, HF_RULE_FORCE_DENSITY);
    open_designs(&rigid, HF_RULE_FORCE_DENSITY, 0);
    struct run *run[] = {&fixed, &rigid};
    for (int k = 0; k < 2; k++) {
        ck_assert_int_eq(hf_batch_create(&run[k]->evaluator, 1, &batch[k]), HF_OK);
        ck_assert_int_eq(hf_batch_share(&batch[k], run[k]->initial), HF_SOLVER_CHORD);
    }
    for (int i = 0; i < N_DESIGN; i++) {
        hf_workspace *w[2];
        for (int k = 0; k < 2; k++)
            w[k] = hf_batch_run_one(&batch[k], design(run[k], i), &result[k]);
        ck_assert(result[0].psi_m == result[1].psi_m && result[0].iterations == result[1].iterations);
        ck_assert_mem_eq(w[0]->position_m, w[1]->position_m, 3 * sizeof(double) * (size_t)fixed.net.model.n_node);
    }
    for (int k = 0; k < 2; k++) {
        hf_batch_free(&batch[k]);
        close_net(&run[k]->net);
    }
}
END_TEST

/* A design that the shared matrix cannot serve gets what it would get alone. */
START_TEST(strangers_are_evaluated_alone)
{
    struct run r;
    hf_form_result result[N_DESIGN], alone;
    hf_batch batch;
    open_designs(&r, HF_RULE_TENSION, 1e-5);
    design(&r, 3)[0] *= 50;
    ck_assert_int_eq(hf_batch_create(&r.evaluator, 2, &batch), HF_OK);
    ck_assert_int_eq(hf_batch_share(&batch, r.initial), HF_SOLVER_CHORD);
    hf_batch_run(&batch, N_DESIGN, r.design, NULL, result);
    hf_evaluate(&r.evaluator, design(&r, 3), &r.net.work, NULL, &alone);
    for (int i = 0; i < N_DESIGN; i++)
        ck_assert_int_eq(result[i].status, i == 3 ? alone.status : HF_OK);
    ck_assert_int_ne(alone.status, HF_OK);
    hf_batch_free(&batch);
    close_net(&r.net);
}
END_TEST

/* dx/dT_k of net and truss by hf_schur, into [3 n_free] and [3 n_attachment], at the shape of the base design. */
static void sensitivity(struct run *r, int k, hf_schur *schur, double *dx, double *dr)
{
    const hf_model *m = &r->net.model;
    hf_workspace *w = &r->net.work;
    hf_form_result at;
    double *more = schur->column, pull[3 * MAX_ATTACHMENT] = {0};
    int e = m->variable_cable[k], n = 3 * m->n_free, band = 3 * m->half_bandwidth + 2;
    const int *end = m->end_row + 2 * e;
    ck_assert_int_eq(hf_evaluate(&r->evaluator, r->initial, w, NULL, &at), HF_OK);
    ck_assert_int_eq(hf_newton_matrix_factor(m, w, NULL), HF_OK);
    ck_assert_int_eq(hf_schur_factor(m, w, hf_newton_matrix_block, schur), HF_OK);
    memset(dx, 0, (size_t)n * sizeof *dx);
    for (int c = 0; c < 3; c++) {
        double f = (w->position_m[c * m->n_node + end[1]] - w->position_m[c * m->n_node + end[0]]) /
                   hf_evaluate_design_length_m(m, e);
        for (int side = 0; side < 2; side++) {
            if (end[side] < m->n_free) dx[3 * end[side] + c] += side ? -f : f;
            for (int i = 0; i < m->n_attachment; i++)
                if (m->attachment_row[i] == end[side]) pull[3 * i + c] += side ? -f : f;
        }
    }
    hf_band_back_solve(n, band, 1, w->newton_band, dx, n);
    hf_schur_pull(m, w, hf_newton_matrix_block, dx, pull);
    hf_schur_displace(m, schur, pull, dr);
    memset(more, 0, (size_t)n * sizeof *more);
    hf_schur_push(m, w, hf_newton_matrix_block, dr, more);
    hf_band_back_solve(n, band, 1, w->newton_band, more, n);
    for (int i = 0; i < n; i++)
        dx[i] += more[i];
}

/* Against central differences over 2e-3 N of shapes to 1e-11 N and 1e-13 m: 1e-6 of the largest, where the third
 * derivative and the shapes' errors meet. Forgetting the truss would be off by per cents. */
START_TEST(sensitivities_are_finite_differences)
{
    struct run r;
    hf_schur schur;
    double step_N = 1e-3, kept;
    open_designs(&r, HF_RULE_FORCE_DENSITY, 1e-4);
    r.net.form.coupling.tof_m = 1e-13;
    r.net.form.residual_tolerance = 1e-12;
    const hf_model *m = &r.net.model;
    size_t n = 3 * (size_t)m->n_node;
    double *dx = malloc(3 * n * sizeof *dx), *up = dx + n, *down = up + n, dr[3 * MAX_ATTACHMENT], largest_dx = 0;
    ck_assert_ptr_nonnull(dx);
    ck_assert_int_eq(hf_schur_create(m, &schur), HF_OK);
    for (int k = 0; k < m->n_variable; k += 5) {
        hf_form_result at;
        sensitivity(&r, k, &schur, dx, dr);
        kept = r.initial[k];
        for (int side = 0; side < 2; side++) {
            r.initial[k] = kept + (side ? -step_N : step_N);
            ck_assert_int_eq(hf_evaluate(&r.evaluator, r.initial, &r.net.work, NULL, &at), HF_OK);
            memcpy(side ? down : up, r.net.work.position_m, n * sizeof *dx);
        }
        r.initial[k] = kept;
        for (int i = 0; i < 3 * m->n_free; i++)
            largest_dx = fmax(largest_dx, fabs(dx[i]));
        for (int i = 0; i < 3 * m->n_node; i++) {
            int row = i % m->n_node, c = i / m->n_node;
            double found = (up[i] - down[i]) / (2 * step_N);
            if (row < m->n_free) ck_assert_double_eq_tol(found, dx[3 * row + c], 1e-6 * largest_dx);
        }
        for (int a = 0; a < 3 * m->n_attachment; a++) {
            int i = a % 3 * m->n_node + m->attachment_row[a / 3];
            ck_assert_double_eq_tol((up[i] - down[i]) / (2 * step_N), dr[a], 1e-6 * largest_dx);
        }
    }
    hf_arena_free(&schur.arena);
    free(dx);
    close_net(&r.net);
}
END_TEST

/* Karush, Kuhn, Tucker by central differences of the coupled psi, as unit/refine has it for fixed supports: a
 * sensitivity that forgets the truss leaves some per cent of the start's slope; 1e-3 is asked for. */
START_TEST(refined_design_has_no_coupled_slope_left)
{
    struct run r;
    hf_refine_result result;
    double lower[MAX_VARIABLE], upper[MAX_VARIABLE], slope[2][MAX_VARIABLE], step = 1e-5;
    open_designs(&r, _i, 1e-4);
    double range_N = _i == HF_RULE_TENSION ? 0.02 : 1;
    int n = r.net.model.n_variable, n_free = 0;
    r.net.form.coupling.tof_m = 1e-12;
    r.net.form.residual_tolerance = 1e-11;
    for (int k = 0; k < n; k++) {
        lower[k] = r.initial[k] - range_N;
        upper[k] = r.initial[k] + range_N;
    }
    for (int when = 0; when < 2; when++) {
        if (when)
            ck_assert_int_eq(
                hf_refine_run(&r.evaluator, lower, upper, 300, NULL, NULL, r.initial, &r.net.work, &result), HF_OK);
        for (int k = 0; k < n; k++) {
            double kept = r.initial[k], psi_m[2];
            for (int side = 0; side < 2; side++) {
                hf_form_result at;
                r.initial[k] = kept + (side ? step : -step);
                ck_assert_int_eq(hf_evaluate(&r.evaluator, r.initial, &r.net.work, NULL, &at), HF_OK);
                psi_m[side] = at.psi_m;
            }
            r.initial[k] = kept;
            slope[when][k] = (psi_m[1] - psi_m[0]) / (2 * step);
        }
    }
    double scale = 0;
    for (int k = 0; k < n; k++)
        scale = fmax(scale, fabs(slope[0][k]));
    for (int k = 0; k < n; k++) {
        double half = (upper[k] - lower[k]) / 2, at = (r.initial[k] - lower[k]) / half - 1;
        int is_free = fabs(at) < 0.999;
        n_free += is_free;
        ck_assert_msg((is_free ? fabs(slope[1][k]) : slope[1][k] * at) < 1e-3 * scale, "gene %d at %g: %g of %g m/N", k,
                      at, slope[1][k], scale);
    }
    ck_assert_double_lt(result.merit, result.start_merit);
    ck_assert_int_gt(n_free, 0);
    close_net(&r.net);
}
END_TEST

Suite *suite_unit_coupling_designs(void)
{
    Suite *suite = suite_create("unit/coupling_designs");
    TCase *tests = tcase_create("coupling_designs");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, chord_gives_what_evaluate_gives, 0, 6);
    tcase_add_loop_test(tests, threads_and_grouping_do_not_change_a_bit, 0, 4);
    tcase_add_test(tests, a_rigid_truss_changes_no_bit_of_a_design);
    tcase_add_test(tests, strangers_are_evaluated_alone);
    tcase_add_test(tests, sensitivities_are_finite_differences);
    tcase_add_loop_test(tests, refined_design_has_no_coupled_slope_left, 0, 2);
    return suite;
}
