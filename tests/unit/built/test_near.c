/* Nets near the nominal one: which way finds which nets, and that each gives up where it must. */
#include "built_nets.h"

#include "built/near.h"

struct near_run {
    double EA[MAX_BUILT_CABLE], cut_m[MAX_BUILT_CABLE], move_m[3 * MAX_BUILT_CABLE];
    struct net net;
    hf_built built;
    hf_workspace w;
    hf_near near;
    hf_near_lanes lanes;
    hf_built_net sample;
};

static void open_near(struct near_run *run, int trial, bool on_truss)
{
    open_design(&run->net, trial, run->EA, on_truss);
    make_built(&run->net, &run->built, &run->w);
    ck_assert_int_eq(hf_near_create(&run->built, &run->w, &run->near), HF_OK);
    ck_assert_int_eq(hf_near_lanes_create(&run->near, &run->lanes), HF_OK);
}

static void close_near(struct near_run *run)
{
    hf_near_lanes_free(&run->lanes);
    hf_near_free(&run->near);
    hf_workspace_free(&run->w);
    hf_built_free(&run->built);
    close_design(&run->net);
}

static void make_near(struct near_run *run, double width_m, long i)
{
    const hf_model *m = &run->built.model;
    struct errors errors = {m, 8000, width_m, 0, width_m};
    memcpy(run->cut_m, m->target, (size_t)m->n_cable * sizeof(double));
    memset(run->move_m, 0, sizeof run->move_m);
    make_errors(&errors, i, run->cut_m, NULL, run->move_m);
    run->sample = (hf_built_net){run->cut_m, m->EA_N, run->move_m, NULL};
}

/* In all lanes, of which the first is looked at. */
static hf_near_verdict go_in_lane(struct near_run *run, hf_form_result *r)
{
    for (int lane = 0; lane < HF_LANES; lane++)
        hf_near_load(&run->near, &run->lanes, lane, &run->sample);
    for (;;) {
        hf_near_look(&run->near, &run->lanes);
        hf_near_verdict verdict = hf_near_settle(&run->near, &run->lanes, 0, &run->sample, &run->w, r);
        if (verdict != HF_NEAR_GOES_ON) return verdict;
        hf_near_step(&run->near, &run->lanes);
    }
}

/* Errors of 1 um change tensions of nets like these by a few per cent: a few chord steps. */
START_TEST(small_errors_are_found_in_lanes)
{
    struct near_run run;
    hf_form_result r, again, reference;
    open_near(&run, _i / 2, _i % 2);
    const hf_model *m = &run.built.model;
    double *found = malloc(3 * (size_t)m->n_node * sizeof *found);
    ck_assert_ptr_nonnull(found);
    for (int i = 0; i < 4; i++) {
        make_near(&run, 1e-6, i);
        ck_assert_int_eq(go_in_lane(&run, &r), HF_NEAR_FOUND);
        ck_assert_int_gt(r.iterations, 1);
        ck_assert_double_le(r.residual_N, run.built.form.residual_tolerance * m->reference_N);
        memcpy(found, run.w.position_m, 3 * (size_t)m->n_node * sizeof *found);
        ck_assert(hf_near_find(&run.near, &run.sample, &run.w, &again));
        ck_assert_int_le(again.iterations, r.iterations);
        ck_assert_double_eq_tol(again.psi_m, r.psi_m, 1e-9);
        ck_assert_int_eq(hf_built_solve(&run.built, &run.sample, &run.w, &reference), HF_OK);
        for (int k = 0; k < 3 * m->n_node; k++)
            ck_assert_double_eq_tol(found[k], run.w.position_m[k], 1e-9);
        ck_assert_double_eq_tol(r.psi_m, reference.psi_m, 1e-9);
        ck_assert_double_eq_tol(r.inner_tension_ratio, reference.inner_tension_ratio, 1e-5);
        ck_assert_double_eq_tol(r.shortest_length_ratio, reference.shortest_length_ratio, 1e-8);
    }
    free(found);
    close_near(&run);
}
END_TEST

/* Errors of 30 mm over lengths of about 1 m leave cables slack. Loose nodes are those of the reference. */
START_TEST(large_errors_are_found_by_newton)
{
    struct near_run run;
    hf_form_result r, reference;
    int n_slack = 0, n_loose = 0, n_missed = 0;
    open_near(&run, _i / 2, _i % 2);
    for (int i = 0; i < 8; i++) {
        make_near(&run, 3e-2, i);
        ck_assert_int_eq(go_in_lane(&run, &r), HF_NEAR_LOST);
        bool is_found = hf_near_find(&run.near, &run.sample, &run.w, &r);
        hf_built_solve(&run.built, &run.sample, &run.w, &reference);
        n_loose += reference.n_loose > 0;
        if (!is_found) {
            n_missed += reference.status == HF_OK;
            continue;
        }
        n_slack += r.n_slack;
        ck_assert_int_eq(reference.status, HF_OK);
        ck_assert_int_eq(r.n_loose, reference.n_loose);
        ck_assert_int_eq(r.n_slack, reference.n_slack);
        double rounding_N = 1e-10; /* of lengths of metres, 1e-15, times EA/l0, when the shape is measured once more */
        if (!r.n_loose)            /* whose cables are as long as their places are exact */
            ck_assert_double_le(r.residual_N,
                                run.built.form.residual_tolerance * run.built.model.reference_N + rounding_N);
        if (isnan(reference.psi_m))
            ck_assert(isnan(r.psi_m)); /* all inner nodes are loose */
        else
            ck_assert_double_eq_tol(r.psi_m, reference.psi_m, 1e-9);
    }
    ck_assert_int_le(n_missed, 1);
    ck_assert_int_gt(n_slack, 0);
    if (_i / 2 % 4 == 3) ck_assert_int_gt(n_loose, 0); /* without loads */
    close_near(&run);
}
END_TEST

START_TEST(no_memory_for_the_matrix)
{
    struct near_run run;
    open_near(&run, 0, _i);
    for (long n = 1;; n++) {
        hf_near near;
        hf_near_lanes lanes = {0};
        fail_allocation_at(n);
        hf_status status = hf_near_create(&run.built, &run.w, &near);
        if (status == HF_OK) status = hf_near_lanes_create(&near, &lanes);
        bool has_failed = end_allocation_failure();
        hf_near_lanes_free(&lanes);
        hf_near_free(&near);
        ck_assert_int_eq(status, has_failed ? HF_NO_MEMORY : HF_OK);
        if (!has_failed) break;
    }
    close_near(&run);
}
END_TEST

Suite *suite_unit_near(void)
{
    Suite *suite = suite_create("unit/near");
    TCase *tcase = tcase_create("near");
    tcase_add_loop_test(tcase, small_errors_are_found_in_lanes, 0, 8);
    tcase_add_loop_test(tcase, large_errors_are_found_by_newton, 0, 8);
    tcase_add_loop_test(tcase, no_memory_for_the_matrix, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
