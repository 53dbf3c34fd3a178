/* What an observer of a run receives, phase by phase: numbers that never fall and end at those of the summary. */
#include "support.h"

#include <hifdm/run.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char case_text[] = "scene: {parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2,\n"
                                "  modules: [1, 2], cells_per_module: [2, 2], scallop: 0.1}, EA_inner_N: 47000,\n"
                                "  EA_boundary_N: 47000}\n"
                                "form: {pretension_N: 20}\n"
                                "optimize: {method: ga+lm, range_N: 2, population: 8, generations: 4, seed: 3}\n"
                                "tolerance: {sigma_cut_m: 1e-4, samples: 1000, find_scale: true}\n"
                                "requirements: [{figure: psi, at_most: 0.1255, share: 0.9}]\n";

enum { N_PHASE = HF_RUN_TOLERANCE + 1 };

struct told {
    int n[N_PHASE], n_last[N_PHASE], n_scale;
    hf_run_progress last[N_PHASE];
    bool is_wrong;
};

static void observe(void *context, const hf_run_progress *now)
{
    struct told *t = context;
    const hf_run_progress *last = &t->last[now->phase];
    for (int later = (int)now->phase + 1; later < N_PHASE; later++)
        t->is_wrong |= t->n[later] > 0;
    if (t->n[now->phase]++)
        t->is_wrong |= now->generation < last->generation || now->step < last->step || now->samples < last->samples ||
                       now->evaluations < last->evaluations || now->elapsed_s < last->elapsed_s ||
                       now->best_psi_m > last->best_psi_m;
    t->is_wrong |= now->best_psi_m == 0;
    t->n_last[now->phase] += now->is_last;
    t->n_scale += now->sigma_scale > 0;
    t->last[now->phase] = *now;
}

START_TEST(an_observer_is_told_each_phase)
{
    static hf_summary s;
    struct told t = {.is_wrong = false};
    char output[HF_OUTPUT_SIZE];
    hf_messages messages = {0};
    write_file(temp_path("case.yaml"), case_text);
    hf_run_request request = {.input.case_path = temp_path("case.yaml"),
                              .output.no_file = true,
                              .control = {.threads = 2, .observer = observe, .observer_context = &t}};
    hf_status status = hf_run_case(&request, &s, output, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text ? messages.text : "no message");
    const hf_run_progress *search = &t.last[HF_RUN_SEARCH], *refine = &t.last[HF_RUN_REFINE],
                          *samples = &t.last[HF_RUN_TOLERANCE];
    ck_assert(!t.is_wrong);
    ck_assert_int_gt(t.n[HF_RUN_FORM], 0);
    ck_assert(search->is_last && t.n_last[HF_RUN_SEARCH] == 1);
    ck_assert_int_eq(search->generation, s.search.generations);
    ck_assert_int_eq(search->evaluations, s.search.evaluations);
    ck_assert_double_eq(search->best_psi_m, s.stage[HF_STAGE_SEARCH].result.psi_m);
    ck_assert(refine->is_last && t.n_last[HF_RUN_REFINE] == 1);
    ck_assert_int_eq(refine->step, s.refine.steps);
    ck_assert_double_eq(refine->best_psi_m, s.stage[HF_STAGE_REFINE].result.psi_m);
    ck_assert_int_eq(samples->samples, 1000);
    ck_assert_int_eq(samples->samples_all, 1000);
    ck_assert_int_eq(samples->evaluations, 1000);
    ck_assert_int_eq(t.n_last[HF_RUN_TOLERANCE], 1);
    ck_assert_int_gt(t.n_scale, 1); /* the search for the factor of the errors goes on behind the samples */
    ck_assert_double_gt(samples->sigma_scale, 0);
    hf_messages_free(&messages);
}
END_TEST

static void stop_in_samples(void *context, const hf_run_progress *now)
{
    if (now->phase == HF_RUN_TOLERANCE && !now->is_last) *(volatile sig_atomic_t *)context = 1;
}

/* The message must not repeat how far the refinement came, which has ended. */
START_TEST(a_stop_in_the_samples_is_not_one_of_the_refinement)
{
    static hf_summary s;
    volatile sig_atomic_t stop = 0;
    char output[HF_OUTPUT_SIZE];
    hf_messages messages = {0};
    write_file(temp_path("case.yaml"), case_text);
    hf_run_request request = {
        .input.case_path = temp_path("case.yaml"),
        .output.path = temp_path("run.h5"),
        .control = {
            .threads = 1, .stop_requested = &stop, .observer = stop_in_samples, .observer_context = (void *)&stop}};
    ck_assert_int_eq(hf_run_case(&request, &s, output, &messages), HF_INTERRUPTED);
    ck_assert_msg(strstr(messages.text, "the run was interrupted. Run the same") != NULL, "%s", messages.text);
    hf_messages_free(&messages);
    hf_summary_free(&s);
}
END_TEST

Suite *suite_unit_run(void)
{
    Suite *suite = suite_create("unit/run/run");
    TCase *tcase = tcase_create("progress");
    tcase_add_test(tcase, an_observer_is_told_each_phase);
    tcase_add_test(tcase, a_stop_in_the_samples_is_not_one_of_the_refinement);
    suite_add_tcase(suite, tcase);
    return suite;
}
