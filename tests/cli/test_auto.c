/* `optimize.method: auto`: refinements from several starts. */
#include "cli.h"

/* Net C of METHOD section 13, whose optima have five values of psi. */
static const char *net_c(void)
{
    return keep(formatted("scene:\n  import: {nodes: %s, cables: %s}\n"
                          "form: {method: hifdm, pretension_N: 10, stop: rms_change, rms_tolerance_m: 1e-6, "
                          "residual_tolerance: 1e-8, max_iterations: 1500}\n"
                          "optimize: {method: auto, range_N: 1, boundary_ratio_cap: 6}\n",
                          keep(source_path("tests/verify/data/limits/triangles_c_nodes.csv")),
                          keep(source_path("tests/verify/data/limits/triangles_c_cables.csv"))));
}

/* The best value known, from each of 20 seeds. A single refinement of the same designs ends above it. */
START_TEST(finds_the_best_optimum_from_each_seed)
{
    const char *c = file_with("c.yaml", net_c()), *out = temp("c.h5");
    for (int seed = 2 * _i + 1; seed <= 2 * _i + 2; seed++) {
        HIFDM(0, "run", c, "-o", out, "--force", "--json", "--seed", keep(formatted("%d", seed)));
        EXPECT(out_as("c.json"), out, "--", "near(a['refine']['psi_m'], 3.8678978e-3, 1e-10)",
               "a['refine']['is_result'] is True", "a['refine']['optima'][0]['merit'] == a['refine']['psi_m']",
               "2 <= sum(o['count'] for o in a['refine']['optima']) <= 4",
               "[o['merit'] for o in a['refine']['optima']] == b['optima/refine/merit'][:].tolist()",
               "sorted(b['optima/refine/merit'][:]) == b['optima/refine/merit'][:].tolist()",
               "[o['count'] for o in a['refine']['optima']] == b['optima/refine/count'][:].tolist()");
    }
}
END_TEST

START_TEST(one_refinement_does_not)
{
    const char *c = file_with("c.yaml", net_c());
    HIFDM(0, "run", c, "-o", temp("one.h5"), "--json", "--set", "optimize.method=ga+lm", "--set",
          "optimize.generations=1");
    EXPECT(out_as("one.json"), "--", "a['refine']['psi_m'] > 3.8681e-3", "'optima' not in a['refine']");
}
END_TEST

/* One seed, one result: with any number of threads, and shown again. */
START_TEST(threads_change_nothing)
{
    const char *c = file_with("c.yaml", net_c());
    HIFDM(0, "run", c, "-o", temp("a.h5"), "--quiet", "--threads", "1");
    HIFDM(0, "run", c, "-o", temp("b.h5"), "--quiet", "--threads", "3");
    HIFDM(0, "diff", temp("a.h5"), temp("b.h5"));
    HIFDM(0, "show", temp("a.h5"));
    OUT("                distinct optima: psi 3.8679 mm (");
    OUT(" of 4 refinements)");
}
END_TEST

/* Where there is one optimum, one is reported. */
START_TEST(one_optimum_is_one)
{
    HIFDM(0, "run", keep(source_path("configs/chen2022.yaml")), "-o", temp("f.h5"), "--json", "--set",
          "optimize.method=auto");
    EXPECT(out_as("f.json"), "--", "near(a['refine']['psi_m'], 4.28338e-3, 1e-8)", "len(a['refine']['optima']) == 1",
           "a['refine']['optima'][0]['count'] == 4");
}
END_TEST

/* In a flat valley, the restarts end when the model promises no lower psi: 97 evaluations instead of 182. */
START_TEST(restarts_without_prospect_end_early)
{
    HIFDM(0, "run", keep(source_path("configs/straight-edges.yaml")), "-o", temp("e.h5"), "--json", "--set",
          "optimize.method=auto", "--set", "optimize.boundary_ratio_cap=4.25");
    EXPECT(out_as("e.json"), "--", "near(a['refine']['psi_m'], 6.3451888e-3, 1e-10)",
           "[o['count'] for o in a['refine']['optima']] == [4]", "a['refine']['evaluations'] < 120",
           "a['refine']['stop_reason'] == 'converged'");
}
END_TEST

#define EXACT_DISH DISH "form: {pretension_N: 10, prestress: exact}\n"

/* The first refinement, from outside the limits, stalls 28 % above what the initial design leads to. */
START_TEST(a_stalled_refinement_is_not_the_last_word)
{
    const char *c = file_with("d.yaml", EXACT_DISH "optimize:\n  method: auto\n"
                                                   "  variables: [{set: front, vary: force_density, range: 30 %}]\n"
                                                   "  objective: [{figure: tension, set: front, target: 12}]\n"
                                                   "  limits: [{figure: tension, set: tie, bounds: [3, 4.15]}]\n");
    HIFDM(0, "run", c, "-o", temp("d.h5"), "--json");
    EXPECT(out_as("d.json"), "--", "a['refine']['merit'] < 1.8032");
}
END_TEST

/* The continuation has a list of optima of its own. */
START_TEST(more_steps_renew_the_optima)
{
    const char *c = file_with("m.yaml", EXACT_DISH "optimize:\n  method: auto\n"
                                                   "  variables: [{set: all, vary: force_density, range: 50 %}]\n"
                                                   "  objective: [{figure: ratio, set: front}]\n"
                                                   "  limits: [{figure: tension, set: tie, bounds: [2, 6]}]\n");
    const char *out = temp("m.h5");
    HIFDM(0, "run", c, "-o", out, "--quiet");
    for (int i = 0; i < 2; i++) {
        HIFDM(0, "run", c, "-o", out, "--more", "100", "--json");
        EXPECT(out_as("m.json"), out, "--", "a['refine']['optima'][0]['merit'] == a['refine']['merit']",
               "b['optima/refine/merit'][0] == a['refine']['merit']");
    }
}
END_TEST

/* Without derivatives it is the method ga, with all its generations. */
START_TEST(without_derivatives_it_is_a_search)
{
    HIFDM(0, "run", REFLECTOR, "-o", temp("s.h5"), "--json", "--set", "optimize.method=auto", "--set",
          "optimize.rule=seeded", "--set", "optimize.generations=5");
    EXPECT(out_as("s.json"), "--", "'refine' not in a", "a['search']['generations'] == 5");
}
END_TEST

/* A refinement that is not finished is continued, not restarted. */
START_TEST(an_unfinished_refinement_has_no_optimum)
{
    const char *c = file_with("c.yaml", net_c());
    HIFDM(0, "run", c, "-o", temp("u.h5"), "--json", "--set", "optimize.refine_steps=2");
    ERR("has not converged after 2 steps");
    EXPECT(out_as("u.json"), "--", "'optima' not in a['refine']", "a['refine']['stop_reason'] == 'max_iterations'");
}
END_TEST

Suite *suite_cli_auto(void)
{
    Suite *suite = suite_create("cli/auto");
    TCase *tests = tcase_create("auto");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, finds_the_best_optimum_from_each_seed, 0, 10);
    tcase_add_test(tests, one_refinement_does_not);
    tcase_add_test(tests, threads_change_nothing);
    tcase_add_test(tests, one_optimum_is_one);
    tcase_add_test(tests, restarts_without_prospect_end_early);
    tcase_add_test(tests, a_stalled_refinement_is_not_the_last_word);
    tcase_add_test(tests, more_steps_renew_the_optima);
    tcase_add_test(tests, without_derivatives_it_is_a_search);
    tcase_add_test(tests, an_unfinished_refinement_has_no_optimum);
    return suite;
}
