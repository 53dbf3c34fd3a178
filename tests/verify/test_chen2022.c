/* configs/chen2022.yaml and configs/chen2022-truss.yaml beside the figures that the paper prints.
 *
 * Source: Chen, Dong, Song, Chen, Li, Aerospace 2022, 9, 239. HIFDM: psi 6.6 mm, tension ratios 1.0011 and 4.8445; GA
 * of 50 x 400: 4.3 mm, 1.001, 5.608, changes around 1 N; on the truss 8.38 mm. Focal length, scallop and edge tie are
 * calibrated on 6.6 mm, 4.8445 and 4.3 mm, the truss on 8.38 mm; the windows say how near the case has to stay. 5.608
 * is not met: results/chen2022/search.md has the best of a search.
 *
 * configs/chen2022-dense.yaml has the figures of the fixed net at the paper's own stop, where 5.608 is met. The windows
 * are those of results/chen2022/dense.md. */
#include "figures.h"
#include "nets.h"

#include <hifdm/run.h>

#define DENSE source_path("configs/chen2022-dense.yaml")

static void run_with_warnings(const char *path, const char *const *set, int n_set, hf_summary *s)
{
    char output[HF_OUTPUT_SIZE];
    hf_messages said = {0};
    hf_run_request request = {
        .input = {path, .set = set, .n_set = n_set}, .output.no_file = true, .control.threads = 1};
    hf_summary_free(s); /* of the run before */
    ck_assert_msg(hf_run_case(&request, s, output, &said) == HF_OK, "%s", said.text);
    hf_messages_free(&said);
}

static void run(const char *path, const char *const *set, int n_set, hf_summary *s)
{
    run_with_warnings(path, set, n_set, s);
    ck_assert_str_eq(s->warnings, ""); /* well-posed */
}

START_TEST(the_net_gives_the_printed_figures)
{
    static hf_summary s;
    run(source_path("configs/chen2022.yaml"), NULL, 0, &s);
    ck_assert_int_eq(s.stage[HF_STAGE_FORM].result.stop_reason, HF_STOPPED_CONVERGED);
    ck_assert_int_eq(s.stage[HF_STAGE_FORM].result.n_loaded_chain + s.stage[HF_STAGE_FORM].result.n_slack, 0);
    VERIFY(1e3 * s.stage[HF_STAGE_FORM].result.psi_m, 6.6, 0.02, "psi after HIFDM, mm (calibrated)");
    VERIFY(s.stage[HF_STAGE_FORM].result.inner_tension_ratio, 1.0011, 0.0015, "tension ratio inside");
    VERIFY(s.stage[HF_STAGE_FORM].result.boundary_tension_ratio, 4.8445, 0.05,
           "tension ratio on the boundary (calibrated)");
    ck_assert_int_eq(s.search.generations, 400);
    VERIFY(1e3 * s.stage[HF_STAGE_SEARCH].result.psi_m, 4.3, 0.1, "psi after the genetic algorithm, mm (calibrated)");
    VERIFY(1 - s.stage[HF_STAGE_SEARCH].result.psi_m / s.search.initial_psi_m, 0.348, 0.01,
           "reduction of psi by the genetic algorithm");
    VERIFY(s.stage[HF_STAGE_SEARCH].result.inner_tension_ratio, 1.001, 0.0015, "tension ratio inside then");
    ck_assert_double_gt(s.stage[HF_STAGE_SEARCH].result.boundary_tension_ratio,
                        s.stage[HF_STAGE_FORM].result.boundary_tension_ratio); /* as 5.608 */
    NOT_MET(s.stage[HF_STAGE_SEARCH].result.boundary_tension_ratio, 5.608, "tension ratio on the boundary then");
}
END_TEST

/* The optimum does not hang on one seed. */
START_TEST(other_seeds_find_the_same)
{
    static hf_summary s;
    char seed[32];
    snprintf(seed, sizeof seed, "optimize.seed=%d", _i + 1);
    run(source_path("configs/chen2022.yaml"), (const char *const[]){seed, "optimize.refine=false"}, 2, &s);
    VERIFY(1e3 * s.stage[HF_STAGE_SEARCH].result.psi_m, 4.3, 0.1, "psi after the genetic algorithm, mm, %s", seed);
    ck_assert_double_gt(s.stage[HF_STAGE_SEARCH].result.boundary_tension_ratio,
                        s.stage[HF_STAGE_FORM].result.boundary_tension_ratio); /* as 5.608 */
}
END_TEST

/* The loop of Fig. 17, ended at 1 mm as there: four comparisons of two displacements are five form-findings. */
START_TEST(on_the_truss)
{
    static hf_summary s;
    run(source_path("configs/chen2022-truss.yaml"), NULL, 0, &s);
    VERIFY(1e3 * s.stage[HF_STAGE_FORM].result.psi_m, 8.38, 0.005, "psi on the truss, mm (calibrated)");
    VERIFY(s.truss.mass_kg, 200, 10, "mass of the truss, kg");
    run(source_path("configs/chen2022-truss.yaml"),
        (const char *const[]){"coupling.scheme=plain", "coupling.tof_m=1e-3"}, 2, &s);
    VERIFY(s.stage[HF_STAGE_FORM].result.coupling.iterations - 1, 4, 0, "rounds of net and truss to 1 mm");
    double psi_m = s.stage[HF_STAGE_FORM].result.psi_m;
    run(source_path("configs/chen2022-truss.yaml"), (const char *const[]){"form.pretension_N=20"}, 1, &s);
    ck_assert_double_gt(s.stage[HF_STAGE_FORM].result.psi_m, psi_m); /* Fig. 22 */
}
END_TEST

/* Most of the gain is not that of the search: the same tensions, solved anew, already have it. So has equilibrium. */
START_TEST(at_the_papers_own_stop)
{
    static hf_summary s;
    const hf_form_result *form = &s.stage[HF_STAGE_FORM].result, *search = &s.stage[HF_STAGE_SEARCH].result;
    run_with_warnings(DENSE, NULL, 0, &s);
    ck_assert_int_eq(form->stop_reason, HF_STOPPED_RMS_CHANGE);
    VERIFY(1e3 * form->psi_m, 6.6, 0.0132, "psi at the paper's stop, mm (calibrated)");
    VERIFY(form->inner_tension_ratio, 1.0011, 0.0002, "tension ratio inside at the paper's stop");
    VERIFY(form->boundary_tension_ratio, 4.8445, 0.0097, "tension ratio on the boundary (calibrated)");
    VERIFY(1e3 * search->psi_m, 4.3, 0.086, "psi after the genetic algorithm, mm");
    VERIFY(search->inner_tension_ratio, 1.001, 0.0005, "tension ratio inside then");
    VERIFY(search->boundary_tension_ratio, 5.608, 0.112, "tension ratio on the boundary then");
    double gain_m = form->psi_m - search->psi_m;
    run_with_warnings(DENSE, (const char *const[]){"optimize.range_N=1e-9", "optimize.generations=1"}, 2, &s);
    ck_assert_double_gt(form->psi_m - search->psi_m, 0.8 * gain_m);
    run(DENSE,
        (const char *const[]){"form.stop=residual", "form.method=auto", "optimize.rule=force_density",
                              "optimize.generations=1"},
        4, &s);
    NOT_MET(form->inner_tension_ratio, 1.0011, "tension ratio inside at equilibrium");
    ck_assert_double_lt(form->psi_m, 6.6e-3 - 0.8 * gain_m);
}
END_TEST

Suite *suite_verify_chen2022(void)
{
    Suite *suite = suite_create("verify/chen2022");
    TCase *tests = tcase_create("chen2022");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, the_net_gives_the_printed_figures);
    tcase_add_loop_test(tests, other_seeds_find_the_same, 0, 2);
    tcase_add_test(tests, on_the_truss);
    tcase_add_test(tests, at_the_papers_own_stop);
    return suite;
}
