/* Levenberg-Marquardt on the boundary pretensions: known optima, optimality by finite differences, bounds and cap.
 *
 * straight-edges within +-1 N of its base: 6.345 mm; free, from the base: 3.54 mm (METHOD section 10). */
#include "laws.h"
#include "population.h"

#include "search/refine.h"
#include <hifdm/batch.h>
#include <hifdm/optimiser.h>

struct refine_run {
    struct run r;
    double lower[MAX_VARIABLE], upper[MAX_VARIABLE];
};

static void set_bounds(struct refine_run *p, double range_N)
{
    for (int k = 0; k < p->r.net.model.n_variable; k++) {
        p->lower[k] = fmax(p->r.initial[k] - range_N, 1e-3);
        p->upper[k] = p->r.initial[k] + range_N;
    }
}

/* As `hifdm run configs/straight-edges.yaml` starts, but each evaluation to 1e-10. */
static void open_chen(struct refine_run *p, double range_N)
{
    OPEN_CASE(&p->r.net, "configs/straight-edges.yaml");
    start_run(&p->r, HF_RULE_FORCE_DENSITY);
    p->r.evaluator.boundary_ratio_cap = p->r.net.settings.optimize.boundary_ratio_cap;
    set_bounds(p, range_N);
}

static void open_small(struct refine_run *p, int rule, double range_N)
{
    open_run(&p->r, rule);
    set_bounds(p, range_N);
}

static hf_status refine(struct refine_run *p, int max_iterations, double *design, hf_refine_result *result)
{
    return hf_refine_run(&p->r.evaluator, p->lower, p->upper, max_iterations, NULL, NULL, design, &p->r.net.work,
                         result);
}

static double psi_of(struct refine_run *p, const double *design)
{
    hf_form_result result;
    ck_assert_int_eq(hf_evaluate(&p->r.evaluator, design, &p->r.net.work, NULL, &result), HF_OK);
    return result.merit;
}

static void assert_within_bounds(const struct refine_run *p, const double *design)
{
    for (int k = 0; k < p->r.net.model.n_variable; k++) {
        ck_assert_double_ge(design[k], p->lower[k]);
        ck_assert_double_le(design[k], p->upper[k]);
    }
}

/* Known to a micrometre: the optimum is flat, so a descent that stops early or points astray ends above it. */
START_TEST(reaches_the_known_optimum)
{
    struct refine_run p;
    hf_refine_result result;
    open_chen(&p, 1);
    double *design = p.r.initial, start_m = psi_of(&p, design);
    ck_assert_int_eq(refine(&p, 200, design, &result), HF_OK);
    ck_assert_double_eq_tol(1e3 * result.merit, 6.345, 1e-3);
    ck_assert_double_eq_tol(result.start_merit, start_m, 1e-12);
    ck_assert_double_eq_tol(psi_of(&p, design), result.merit, 1e-12);
    ck_assert_int_eq(result.stop, HF_REFINE_CONVERGED);
    ck_assert_int_le(result.iterations, 60); /* observed: 30; without exact derivatives or scaling far more */
    assert_within_bounds(&p, design);
    /* once more for one step: it starts by leaving the bounds, which is uphill, and must not end there */
    double optimum_m = result.merit;
    ck_assert_int_eq(refine(&p, 1, design, &result), HF_OK);
    ck_assert_double_le(result.merit, optimum_m);
    ck_assert_double_le(psi_of(&p, design), optimum_m);
    close_net(&p.r.net);
}
END_TEST

/* The free optimum, 3.54 mm, has some tensions driven to infinity (METHOD section 10): with room for 1000 N, 500
 * steps come within 0.05 mm of it (observed: 3.577), and nothing goes below. */
START_TEST(approaches_the_free_optimum)
{
    struct refine_run p;
    hf_refine_result result;
    open_chen(&p, 1000);
    p.r.evaluator.boundary_ratio_cap = 1e9;
    ck_assert_int_eq(refine(&p, 500, p.r.initial, &result), HF_OK);
    ck_assert_double_ge(1e3 * result.merit, 3.535);
    ck_assert_double_le(1e3 * result.merit, 3.59);
    close_net(&p.r.net);
}
END_TEST

/* Karush, Kuhn, Tucker by central differences of hf_evaluate: no slope where a pretension is free, downhill only out
 * of the bounds elsewhere. A wrong sensitivity ends where its own zero is: slopes of the order of those at the
 * start, 2e-4 m/N. Observed with the right ones: 1e-12 m/N, which is rounding of psi over 2e-5 N; 1e-4 of the start
 * is asked for. */
START_TEST(optimum_has_no_slope_left)
{
    struct refine_run p;
    hf_refine_result result;
    if (_i == HF_RULE_TENSION)
        open_small(&p, _i, 0.02);
    else
        open_chen(&p, 1);
    int n = p.r.net.model.n_variable, n_free = 0;
    double slope[2][MAX_VARIABLE], step = 1e-5, *design = p.r.initial;
    for (int when = 0; when < 2; when++) {
        if (when) ck_assert_int_eq(refine(&p, 300, design, &result), HF_OK);
        for (int k = 0; k < n; k++) {
            double kept = design[k], up, down;
            design[k] = kept + step;
            up = psi_of(&p, design);
            design[k] = kept - step;
            down = psi_of(&p, design);
            design[k] = kept;
            slope[when][k] = (up - down) / (2 * step);
        }
    }
    double scale = largest(slope[0], n);
    for (int k = 0; k < n; k++) {
        double half = (p.upper[k] - p.lower[k]) / 2, at = (design[k] - p.lower[k]) / half - 1;
        if (fabs(at) < 0.999) {
            n_free++;
            ck_assert_msg(fabs(slope[1][k]) < 1e-4 * scale, "gene %d: %g m/N left of %g", k, slope[1][k], scale);
        } else {
            ck_assert_msg(slope[1][k] * at < 1e-4 * scale, "gene %d: %g m/N into the bound", k, slope[1][k]);
        }
    }
    ck_assert_double_lt(result.merit, result.start_merit);
    ck_assert_int_gt(n_free, 0);
    close_net(&p.r.net);
}
END_TEST

/* For every iteration limit and every start, also at an optimum, psi does not rise and the bounds hold. */
START_TEST(never_worse_than_its_start)
{
    struct refine_run p;
    hf_refine_result result;
    open_small(&p, HF_RULE_FORCE_DENSITY, 0.5);
    for (int i = 0; i < 6; i++) {
        double *x = design(&p.r, i), before_m = psi_of(&p, x);
        for (int again = 0; again < 2; again++) {
            ck_assert_int_eq(refine(&p, again ? 300 : 1 + i, x, &result), HF_OK);
            ck_assert_double_eq(result.start_merit, before_m);
            ck_assert_double_le(result.merit, before_m);
            before_m = psi_of(&p, x);
            ck_assert_double_eq(before_m, result.merit);
            assert_within_bounds(&p, x);
            ck_assert_int_gt(result.evaluations, 0);
            if (!again) ck_assert_int_le(result.iterations, 1 + i);
        }
    }
    close_net(&p.r.net);
}
END_TEST

/* With room for 400 N the best designs have boundary ratios around 9; a cap of 5 stands in the way, and costs little:
 * psi is flat there. */
START_TEST(ratio_cap_is_kept)
{
    struct refine_run p;
    hf_refine_result open, capped;
    hf_form_result end;
    double design[MAX_VARIABLE];
    open_chen(&p, 400);
    for (int has_cap = 0; has_cap < 2; has_cap++) {
        p.r.evaluator.boundary_ratio_cap = has_cap ? 5 : 1e9;
        memcpy(design, p.r.initial, sizeof design);
        ck_assert_int_eq(refine(&p, 300, design, has_cap ? &capped : &open), HF_OK);
        ck_assert_int_eq(hf_evaluate(&p.r.evaluator, design, &p.r.net.work, NULL, &end), HF_OK);
        if (has_cap)
            ck_assert_double_le(end.boundary_tension_ratio, 5);
        else
            ck_assert_double_gt(end.boundary_tension_ratio, 5);
    }
    ck_assert_double_lt(capped.merit, capped.start_merit);
    ck_assert_double_ge(capped.merit, (1 - 1e-5) * open.merit);
    close_net(&p.r.net);
}
END_TEST

START_TEST(infeasible_start_is_told)
{
    struct refine_run p;
    hf_refine_result result;
    double kept[MAX_VARIABLE];
    open_small(&p, HF_RULE_TENSION, 1);
    p.r.initial[0] *= 50;
    memcpy(kept, p.r.initial, sizeof kept);
    ck_assert_int_eq(refine(&p, 20, p.r.initial, &result), HF_COLLAPSED);
    ck_assert_mem_eq(kept, p.r.initial, (size_t)p.r.net.model.n_variable * sizeof *kept); /* untouched */
    ck_assert_int_eq(result.iterations, 0);
    p.r.evaluator.boundary_ratio_cap = 1 + 1e-9;
    memcpy(p.r.initial, design(&p.r, 0), sizeof kept);
    ck_assert_int_eq(hf_refine_run(&p.r.evaluator, design(&p.r, 0), design(&p.r, 0), 20, NULL, NULL, p.r.initial,
                                   &p.r.net.work, &result),
                     HF_RATIO_CAP);
    ck_assert_mem_eq(p.r.initial, design(&p.r, 0), (size_t)p.r.net.model.n_variable * sizeof *kept); /* no way in */
    close_net(&p.r.net);
}
END_TEST

/* A start above the cap is led below it, and counts as infeasible whatever its psi. */
START_TEST(start_outside_the_limits_is_led_in)
{
    struct refine_run p;
    hf_refine_result result;
    hf_form_result end;
    open_small(&p, HF_RULE_TENSION, 1);
    p.r.evaluator.boundary_ratio_cap = 1 + 1e-9;
    ck_assert_int_eq(hf_evaluate(&p.r.evaluator, design(&p.r, 0), &p.r.net.work, NULL, &end), HF_RATIO_CAP);
    ck_assert_int_eq(refine(&p, 20, design(&p.r, 0), &result), HF_OK);
    ck_assert_int_eq(hf_evaluate(&p.r.evaluator, design(&p.r, 0), &p.r.net.work, NULL, &end), HF_OK);
    ck_assert_double_eq(end.merit, result.merit);
    close_net(&p.r.net);
}
END_TEST

/* A short GA, then LM, ends where LM ends from the base: 1e-6 m, of an optimum 0.25 mm below the base. */
START_TEST(after_the_ga_the_same_optimum)
{
    struct refine_run p;
    hf_refine_result from_base, from_ga;
    hf_optimiser ga;
    hf_batch batch;
    open_chen(&p, 1);
    p.r.net.settings.optimize.generations = 30;
    ck_assert_int_eq(hf_batch_create(&p.r.evaluator, 2, &batch), HF_OK);
    ck_assert_int_eq(
        hf_optimiser_create(&hf_optimiser_ga, &p.r.net.settings.optimize, &p.r.net.model, p.r.initial, &ga), HF_OK);
    hf_batch_share(&batch, p.r.initial);
    do {
        hf_batch_run(&batch, ga.population.n_individual, ga.population.design, ga.population.pending,
                     ga.population.result);
        hf_optimiser_tell(&ga);
    } while (hf_optimiser_next(&ga));
    double *best_N = ga.population.design + ga.population.best * ga.population.n_variable,
           best_m = ga.population.result[ga.population.best].psi_m;
    ck_assert_int_eq(refine(&p, 200, best_N, &from_ga), HF_OK);
    ck_assert_int_eq(refine(&p, 200, p.r.initial, &from_base), HF_OK);
    ck_assert_double_eq_tol(from_ga.merit, from_base.merit, 1e-6);
    ck_assert_double_le(from_ga.merit, best_m);
    hf_optimiser_free(&ga);
    hf_batch_free(&batch);
    close_net(&p.r.net);
}
END_TEST

START_TEST(applies_to_convex_nets_and_rules_only)
{
    struct refine_run p;
    open_small(&p, HF_RULE_FORCE_DENSITY, 1);
    ck_assert(hf_refine_applies(&p.r.evaluator));
    p.r.evaluator.rule = HF_RULE_SEEDED;
    ck_assert(!hf_refine_applies(&p.r.evaluator));
    p.r.evaluator.rule = HF_RULE_TENSION;
    ck_assert(hf_refine_applies(&p.r.evaluator));
    p.r.net.model.has_newton = 0;
    ck_assert(!hf_refine_applies(&p.r.evaluator));
    p.r.net.model.has_newton = 1;
    close_net(&p.r.net);
}
END_TEST

/* Levenberg-Marquardt varies T/L* of each cable. So its steps from one shape, away from bounds, are the same whether
 * the design variables are tensions or force densities. 1e-9: the shape of the end by tensions is found to a tolerance.
 */
START_TEST(steps_do_not_depend_on_the_rule)
{
    struct refine_run p;
    hf_refine_result by_tension, by_density;
    double design_N[MAX_VARIABLE], density_N[MAX_VARIABLE];
    open_small(&p, HF_RULE_TENSION, 1e3);
    const hf_workspace *w = &p.r.net.work;
    memcpy(design_N, design(&p.r, 0), (size_t)p.r.net.model.n_variable * sizeof(double));
    double start_m = psi_of(&p, design_N);
    for (int k = 0; k < p.r.net.model.n_variable; k++) {
        int e = p.r.net.model.variable_cable[k];
        density_N[k] = w->tension_N[e] / w->length_m[e] * hf_evaluate_divisor(&p.r.evaluator, k);
    }
    ck_assert_int_eq(refine(&p, 1, design_N, &by_tension), HF_OK);
    p.r.evaluator.rule = HF_RULE_FORCE_DENSITY;
    ck_assert_int_eq(refine(&p, 1, density_N, &by_density), HF_OK);
    ck_assert_double_lt(by_tension.merit, 0.995 * start_m);
    ck_assert_double_eq_tol(by_density.merit, by_tension.merit, 1e-9 * start_m);
    close_net(&p.r.net);
}
END_TEST

/* ---- going on ---- */

/* Where a run was between its steps, [n][n_state]. */
struct trace {
    int n;
    size_t n_state;
    double *state;
};

static hf_status note_state(void *context, const hf_refine_progress *now)
{
    struct trace *t = context;
    t->n_state = now->n_state;
    t->state = realloc(t->state, (size_t)(t->n + 1) * now->n_state * sizeof(double));
    ck_assert_ptr_nonnull(t->state);
    memcpy(t->state + (size_t)t->n++ * now->n_state, now->state, now->n_state * sizeof(double));
    return HF_OK;
}

/* From `start`; the watcher may be NULL. */
static hf_refine_result watch_refine(struct refine_run *p, const double *start, const hf_refine_watcher *watcher,
                                     double *end)
{
    hf_refine_result result;
    memcpy(end, start, (size_t)p->r.net.model.n_variable * sizeof *end);
    ck_assert_int_eq(
        hf_refine_run(&p->r.evaluator, p->lower, p->upper, 40, NULL, watcher, end, &p->r.net.work, &result), HF_OK);
    return result;
}

static void open_for_steps(struct refine_run *p, int i)
{
    if (i == 2) {
        open_small(p, HF_RULE_TENSION, 1);
        memcpy(p->r.initial, design(&p->r, 0), (size_t)p->r.net.model.n_variable * sizeof(double));
        p->r.evaluator.boundary_ratio_cap = 1 + 1e-9; /* far off */
    } else {
        open_chen(p, i == 1 ? 400 : 1);
        if (i == 1) p->r.evaluator.boundary_ratio_cap = 5; /* stands in the way */
    }
}

/* Within the bounds, at the cap, and from outside: from between any two steps a run goes on to the same bits. What is
 * no state of it is ignored. */
START_TEST(goes_on_from_any_step_to_the_same_bits)
{
    struct refine_run p;
    double end_N[MAX_VARIABLE], again_N[MAX_VARIABLE];
    struct trace trace = {0};
    const hf_refine_watcher watcher = {.after = note_state, .context = &trace};
    open_for_steps(&p, _i);
    size_t size = (size_t)p.r.net.model.n_variable * sizeof(double);
    const hf_refine_result whole = watch_refine(&p, p.r.initial, &watcher, end_N);
    ck_assert_int_eq(trace.n, whole.iterations + 1);
    ck_assert_int_ge(trace.n, 4);
    for (int k = 0; k <= trace.n; k++) {
        const hf_refine_watcher from = {.n_state = trace.n_state,
                                        .state = trace.state + (size_t)(k % trace.n) * trace.n_state};
        if (k == trace.n) trace.state[trace.n_state - 1] = (double)NAN; /* damaged: it begins anew */
        const hf_refine_result again = watch_refine(&p, p.r.initial, &from, again_N);
        ck_assert_mem_eq(again_N, end_N, size);
        ck_assert(again.iterations == whole.iterations && again.evaluations == whole.evaluations);
        ck_assert(again.stop == whole.stop && again.merit == whole.merit);
        ck_assert(again.start_merit == whole.start_merit || (isnan(again.start_merit) && isnan(whole.start_merit)));
    }
    free(trace.state);
    close_net(&p.r.net);
}
END_TEST

static hf_status end_at_two(void *context, const hf_refine_progress *now)
{
    *(int *)context = now->iterations;
    return now->iterations == 2 ? HF_IO : HF_OK;
}

/* What its watcher returns ends it, and the design is as it was. */
START_TEST(its_watcher_ends_it)
{
    struct refine_run p;
    hf_refine_result result;
    int iterations = 0;
    double start_N[MAX_VARIABLE];
    const hf_refine_watcher watcher = {.after = end_at_two, .context = &iterations};
    open_chen(&p, 1);
    size_t size = (size_t)p.r.net.model.n_variable * sizeof(double);
    memcpy(start_N, p.r.initial, size);
    ck_assert_int_eq(
        hf_refine_run(&p.r.evaluator, p.lower, p.upper, 40, NULL, &watcher, p.r.initial, &p.r.net.work, &result),
        HF_IO);
    ck_assert_int_eq(iterations, 2);
    ck_assert_mem_eq(start_N, p.r.initial, size);
    close_net(&p.r.net);
}
END_TEST

/* Behind the last step the inner nodes' theoretical positions are elsewhere, so the best design is worse than its start
 * was. */
static hf_status shift_target(void *context, const hf_refine_progress *now)
{
    hf_model *m = context;
    for (int i = 0; i < m->n_free && now->iterations == 3; i++)
        m->position_m[2 * m->n_node + i] += 1;
    return HF_OK;
}

/* When the best design's own evaluation is worse than the start was, the start stays, and its shape is the one in the
 * workspace. */
START_TEST(the_start_stays_when_the_end_is_worse)
{
    struct refine_run p;
    hf_refine_result result;
    hf_form_result start;
    double start_N[MAX_VARIABLE];
    open_chen(&p, 1);
    const hf_model *m = &p.r.net.model;
    const hf_refine_watcher watcher = {.after = shift_target, .context = &p.r.net.model};
    memcpy(start_N, p.r.initial, (size_t)m->n_variable * sizeof(double));
    ck_assert_int_eq(
        hf_refine_run(&p.r.evaluator, p.lower, p.upper, 3, NULL, &watcher, p.r.initial, &p.r.net.work, &result), HF_OK);
    ck_assert_mem_eq(start_N, p.r.initial, (size_t)m->n_variable * sizeof(double));
    ck_assert_int_eq(result.stop, HF_REFINE_STALLED);
    double *end_m = malloc(3 * (size_t)m->n_node * sizeof *end_m);
    ck_assert_ptr_nonnull(end_m);
    memcpy(end_m, p.r.net.work.position_m, 3 * (size_t)m->n_node * sizeof *end_m);
    ck_assert_int_eq(hf_evaluate(&p.r.evaluator, start_N, &p.r.net.work, NULL, &start), HF_OK);
    ck_assert_double_eq(result.merit, start.merit);
    for (int i = 0; i < 3 * m->n_node; i++)
        ck_assert_double_eq_tol(end_m[i], p.r.net.work.position_m[i], 1e-9);
    free(end_m);
    close_net(&p.r.net);
}
END_TEST

Suite *suite_unit_refine(void)
{
    Suite *suite = suite_create("unit/polish");
    TCase *tests = tcase_create("polish");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, reaches_the_known_optimum);
    tcase_add_test(tests, approaches_the_free_optimum);
    tcase_add_loop_test(tests, optimum_has_no_slope_left, 0, 2);
    tcase_add_test(tests, never_worse_than_its_start);
    tcase_add_test(tests, ratio_cap_is_kept);
    tcase_add_test(tests, infeasible_start_is_told);
    tcase_add_test(tests, start_outside_the_limits_is_led_in);
    tcase_add_test(tests, after_the_ga_the_same_optimum);
    tcase_add_loop_test(tests, goes_on_from_any_step_to_the_same_bits, 0, 3);
    tcase_add_test(tests, its_watcher_ends_it);
    tcase_add_test(tests, the_start_stays_when_the_end_is_worse);
    tcase_add_test(tests, applies_to_convex_nets_and_rules_only);
    tcase_add_test(tests, steps_do_not_depend_on_the_rule);
    return suite;
}
