/* Limits on tensions that no design at the target positions can meet, as the program reports them before a search. */
#include "cli.h"

/* Prestressed, with ties of 5.2 to 5.6 N at 10 N. With 20 % their minimum can be 6.266 N (verify/feasible). */
static const char *dish(const char *limits)
{
    return file_with("dish.yaml",
                     formatted("scene: {paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 3, rear_distance_m: "
                               "1.8}}\nform: {pretension_N: 10, prestress: exact}\noptimize:\n  refine_steps: 1\n  "
                               "generations: 20\n  variables: [{set: all, vary: force_density, range: 20 %%}]\n  "
                               "limits: [%s]\n",
                               limits));
}

#define TIE(lower) "{figure: tension, set: tie, bounds: [" lower ", null]}"
#define NO_DESIGN "no design at the target positions"

START_TEST(a_limit_out_of_reach_is_found_by_check_and_run)
{
    static const char *const method[] = {"optimize.method=lm", "optimize.method=ga"};
    const char *path = dish(TIE("6.5"));
    HIFDM(0, "check", path, "--set", method[_i]);
    ERRS("warning: %s:7:12: optimize.limits.0: " NO_DESIGN " meets this limit (tension of tie at least 6.5 N). There, "
         "the minimum tension is at most 6.266 N with form.pretension_N 10; raise form.pretension_N to 12.5 N, at "
         "which the initial design meets all limits on tensions. Designs away from the target positions may meet it\n",
         path);
    HIFDM(3, "run", path, "-o", temp("r.h5"), "--set", method[_i]);
    ERR("optimize.limits.0: " NO_DESIGN " meets this limit");
    ERR(". Raise form.pretension_N to 12.5 N, at which the initial design meets all limits on tensions, ");
    ck_assert_int_eq(count_of(said.err, "error: "), 1); /* and the summary does not repeat it */
    OUT("failed: no design met the constraints; the form-finding has psi ");
    HIFDM(0, "show", temp("r.h5"));
    OUT("failed: optimize: ");
}
END_TEST

START_TEST(the_advised_pretension_leads_to_a_design)
{
    static const char *const method[] = {"optimize.method=lm", "optimize.method=ga"};
    const char *path = dish(TIE("6.5"));
    HIFDM(0, "run", path, "-o", temp("r.h5"), "--set", "form.pretension_N=12.5", "--set", method[_i]);
    ck_assert_ptr_null(strstr(said.err, NO_DESIGN));
    HIFDM(0, "check", path, "--set", "form.pretension_N=10.38"); /* 6.5 / 6.266 of 10 N is enough for some design */
    ck_assert_ptr_null(strstr(said.err, NO_DESIGN));
    HIFDM(0, "check", path, "--set", "form.pretension_N=10.37");
    ERR(NO_DESIGN);
}
END_TEST

START_TEST(a_tension_that_is_too_high_needs_a_lower_pretension)
{
    HIFDM(0, "check", dish("{figure: tension, set: front, bounds: [null, 7]}"));
    ERR("There, the maximum tension is at least 8.084 N with form.pretension_N 10; lower form.pretension_N to 6.92 N");
}
END_TEST

START_TEST(limits_that_contradict_each_other_are_named_together)
{
    HIFDM(0, "check", dish(TIE("6.2") ", {figure: tension, set: front, bounds: [null, 9]}"));
    ERR("optimize.limits.0: " NO_DESIGN
        " meets these limits together: tension of tie at least 6.2 N (optimize.limits.0), tension "
        "of front at most 9 N (optimize.limits.1). Each would have to be loosened by 0.87 N; loosen one of them or "
        "widen the "
        "design variables");
}
END_TEST

/* Met by the initial design, by another design, or by all ratios; or no tensions hold the net where it is drawn. */
START_TEST(limits_within_reach_are_met_in_silence)
{
    static const char *const limits[] = {TIE("5"), TIE("6.2"), "{figure: ratio, set: tie, bounds: [1, 1.01]}"};
    HIFDM(0, "check", dish(limits[_i]));
    ck_assert_str_eq(said.err, "");
    HIFDM(0, "check", dish(limits[_i]), "--set", "form.prestress=given", "--set",
          "optimize.variables=[{set: "
          "boundary, vary: force_density, range: 1 %}]");
    ck_assert_ptr_null(strstr(said.err, NO_DESIGN));
}
END_TEST

/* A row on the nominal load case is a limit, also one in all load cases or one that most samples must meet. A row about
 * another load case, or about the best samples, is none: the tensions there are not those at the target positions. */
START_TEST(required_tensions_are_compared_too)
{
    static const char *const row[] = {"{figure: tension, set: tie, at_least: 6.5}",
                                      "{figure: tension, set: tie, within: [6.5, 60], load_case: all}",
                                      "{figure: tension, set: tie, at_least: 6.5, search: off}",
                                      "{figure: tension, set: tie, at_least: 6.5, share: 0.9}",
                                      "{figure: tension, set: tie, at_least: 6.5, load_case: pulled}",
                                      "{figure: tension, set: tie, at_least: 6.5, share: 0.4}",
                                      "{figure: tension, set: tie, at_least: 6.2}"};
    HIFDM(0, "check", dish(""), "--set", "scene.EA_inner_N=2e4", "--set", "scene.EA_boundary_N=2e4", "--set",
          "load_cases=[{name: pulled, force_N: [0, 0, 1e-3]}]", "--set", "tolerance.sigma_cut_m=1e-6", "--set",
          formatted("requirements=[%s]", row[_i]));
    if (_i < 4)
        ERR("warning: --set requirements.0: " NO_DESIGN " meets this limit (tension of tie at least 6.5 N). There, the "
            "minimum tension is at most 6.266 N with form.pretension_N 10; raise form.pretension_N to 12.5 N");
    else
        ck_assert_ptr_null(strstr(said.err, NO_DESIGN));
}
END_TEST

START_TEST(a_given_tension_beyond_a_limit_is_named)
{
    HIFDM(0, "check", dish("{figure: tension, set: front, bounds: [15, null]}"), "--set", "form.prestress=given",
          "--set", "optimize.variables=[{set: front, vary: tension, range: 3}, {set: tie, vary: tension, range: 3}]");
    ERR("optimize.limits.0: no design meets this limit (tension of front at least 15 N), because cable '");
    ERR("' has a tension of at most 13 N in every design");
    ck_assert_ptr_null(strstr(said.err, NO_DESIGN));
}
END_TEST

Suite *suite_cli_feasible(void)
{
    Suite *suite = suite_create("cli/feasible");
    TCase *tests = tcase_create("feasible");
    tcase_set_timeout(tests, HANG_S);
    tcase_add_loop_test(tests, a_limit_out_of_reach_is_found_by_check_and_run, 0, 2);
    tcase_add_loop_test(tests, the_advised_pretension_leads_to_a_design, 0, 2);
    tcase_add_test(tests, a_tension_that_is_too_high_needs_a_lower_pretension);
    tcase_add_test(tests, limits_that_contradict_each_other_are_named_together);
    tcase_add_loop_test(tests, limits_within_reach_are_met_in_silence, 0, 3);
    tcase_add_loop_test(tests, required_tensions_are_compared_too, 0, 7);
    tcase_add_test(tests, a_given_tension_beyond_a_limit_is_named);
    suite_add_tcase(suite, tests);
    return suite;
}
