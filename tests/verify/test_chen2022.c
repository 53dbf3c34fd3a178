/* configs/chen2022.yaml and configs/chen2022-truss.yaml beside the figures that the paper prints.
 *
 * Source: Chen, Dong, Song, Chen, Li, Aerospace 2022, 9, 239. HIFDM: psi 6.6 mm, tension ratios 1.0011 and 4.8445; GA
 * of 50 x 400: 4.3 mm, 1.001, 5.608, changes around 1 N; on the truss 8.38 mm. Focal length, scallop and edge tie are
 * calibrated on 6.6 mm, 4.8445 and 4.3 mm, the truss on 8.38 mm; the windows say how near the case has to stay. 5.608
 * is not met: results/chen2022/search.md has the best of a search. */
#include "figures.h"
#include "nets.h"

#include <hifdm/run.h>

static void run(const char *path, const char *const *set, int n_set, hf_summary *s)
{
    char output[HF_OUTPUT_SIZE];
    hf_messages said = {0};
    hf_run_request request = {
        .input = {path, .set = set, .n_set = n_set}, .output.no_file = true, .control.threads = 1};
    hf_summary_free(s); /* of the run before */
    ck_assert_msg(hf_run_case(&request, s, output, &said) == HF_OK, "%s", said.text);
    ck_assert_str_eq(s->warnings, ""); /* well-posed */
    hf_messages_free(&said);
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

Suite *suite_verify_chen2022(void)
{
    Suite *suite = suite_create("verify/chen2022");
    TCase *tests = tcase_create("chen2022");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, the_net_gives_the_printed_figures);
    tcase_add_loop_test(tests, other_seeds_find_the_same, 0, 2);
    tcase_add_test(tests, on_the_truss);
    return suite;
}
