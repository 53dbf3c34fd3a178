/* Keys, words and options of version 0.2: each is accepted with a warning that names the new one, and the result is
 * that of the new names, to the bit. */
#include "cli.h"

#define IS_NOW(old, now) old " is now " now ": rename it, because version 0.4 refuses the old name\n"

/* A case: its lines in version 0.2 and now, and what is said of the first ones. */
typedef struct {
    const char *old, *now, *said[3];
} line;

static const line scene[] = {{ON_TRUSS, ON_TRUSS, {NULL}},
                             {"surface: {}\n", "surface: {}\n", {NULL}},
                             {"cables: [{expansion_per_K: 1e-6}]\n", "cables: [{expansion_per_K: 1e-6}]\n", {NULL}}};

static const line load_cases[] = {
    {"cases:\n", "load_cases:\n", {"1: " IS_NOW("cases", "load_cases")}},
    {"  - {name: cold, temperature_K: -20, part: net}\n", "  - {name: cold, temperature_K: -20, part: net}\n", {NULL}},
    {"  - {name: moved, move_m: [0, 0, 1e-3]}\n",
     "  - {name: moved, support_displacement_m: [0, 0, 1e-3]}\n",
     {"19: " IS_NOW("load_cases.1.move_m", "load_cases.1.support_displacement_m")}}};

static const line rows[] = {
    {"adjust: {set: inner, range_m: 0.002, step_m: 1e-4, moves: 3, aim: theory}\n",
     "adjust: {set: inner, range_m: 0.002, step_m: 1e-4, max_adjustments: 3, aim: target_positions}\n",
     {"52: " IS_NOW("adjust.moves", "adjust.max_adjustments"),
      "67: " IS_NOW("adjust.aim=theory", "adjust.aim=target_positions")}},
    {"tolerance: {sigma_cut_m: 1e-5, samples: 20, yield: 0.5,\n",
     "tolerance: {sigma_cut_m: 1e-5, samples: 20, find_scale: true}\n",
     {NULL}},
    {"  require: [{measure: least_tension_N, at_least: 0}]}\n",
     "requirements: [{figure: tension, at_least: 0, share: 0.5, search: off}]\n",
     {"13: tolerance.require.0: this list is now `requirements`. Write `requirements: [{figure: tension, at_least: 0, "
      "share: 0.5, search: off}]` and `find_scale: true` in tolerance instead, because version 0.4 refuses the old "
      "keys\n"}},
    {"optimize:\n", "optimize:\n", {NULL}},
    {"  population: 6\n", "  population: 6\n", {NULL}},
    {"  generations: 3\n", "  generations: 3\n", {NULL}},
    {"  compare_lm: true\n", "  refine: true\n", {"3: " IS_NOW("optimize.compare_lm", "optimize.refine")}},
    {"  polish_iterations: 2\n",
     "  refine_steps: 2\n",
     {"3: " IS_NOW("optimize.polish_iterations", "optimize.refine_steps")}},
    {"  goals:\n", "  objective:\n", {"3: " IS_NOW("optimize.goals", "optimize.objective")}},
    {"    - {goal: psi, state: cold}\n",
     "    - {figure: psi, load_case: cold}\n",
     {"8: " IS_NOW("optimize.objective.0.goal", "optimize.objective.0.figure"),
      "19: " IS_NOW("optimize.objective.0.state", "optimize.objective.0.load_case")}},
    {"    - {figure: displacement, weight: 0.1}\n",
     "    - {figure: deflection, weight: 0.1}\n",
     {"16: " IS_NOW("optimize.objective.1.figure=displacement", "optimize.objective.1.figure=deflection")}},
    {"    - {goal: psi, over: states, take: worst}\n",
     "    - {figure: psi, load_case: all, take: worst}\n",
     {"8: " IS_NOW("optimize.objective.2.goal", "optimize.objective.2.figure"),
      "25: " IS_NOW("optimize.objective.2.over=states", "optimize.objective.2.load_case=all")}},
    {"    - {figure: facets, fit: none, weight: 0.1}\n",
     "    - {figure: facets, feed: fixed, weight: 0.1}\n",
     {"29: " IS_NOW("optimize.objective.3.fit=none", "optimize.objective.3.feed=fixed")}},
    {"    - {figure: facets, fit: best, weight: 0.1}\n",
     "    - {figure: facets, feed: refocused, weight: 0.1}\n",
     {"29: " IS_NOW("optimize.objective.4.fit=best", "optimize.objective.4.feed=refocused")}},
    {"  limits: [{limit: displacement, bounds: [0, 1]}]\n",
     "  limits: [{figure: deflection, bounds: [0, 1]}]\n",
     {"20: " IS_NOW("optimize.limits.0.limit=displacement", "optimize.limits.0.figure=deflection")}}};

static const line front[] = {
    {"optimize:\n", "optimize:\n", {NULL}},
    {"  population: 6\n", "  population: 6\n", {NULL}},
    {"  generations: 3\n", "  generations: 3\n", {NULL}},
    {"  objectives:\n", "  front:\n", {"3: " IS_NOW("optimize.objectives", "optimize.front")}},
    {"    - {figure: psi, over: states}\n",
     "    - {figure: psi, load_case: all}\n",
     {"27: " IS_NOW("optimize.front.0.over=states", "optimize.front.0.load_case=all")}},
    {"    - {figure: surface, fit: none}\n",
     "    - {figure: surface, feed: fixed}\n",
     {"30: " IS_NOW("optimize.front.1.fit=none", "optimize.front.1.feed=fixed")}},
    {"    - {goal: displacement, state: moved}\n",
     "    - {figure: deflection, load_case: moved}\n",
     {"14: " IS_NOW("optimize.front.2.goal=displacement", "optimize.front.2.figure=deflection"),
      "28: " IS_NOW("optimize.front.2.state", "optimize.front.2.load_case")}}};

/* ---- a case ---- */

#define TEXT_SIZE 8192
typedef struct {
    char old[TEXT_SIZE], now[TEXT_SIZE], said[TEXT_SIZE]; /* the case in both versions, and its warnings */
    int n_line;
} both;

static void add_lines(both *b, const char *path, const line *of, int n)
{
    for (; n > 0; n--, of++) {
        for (int k = 0; k < 3 && of->said[k]; k++)
            strcat(b->said, formatted("warning: %s:%d:%s", path, b->n_line + 1, of->said[k]));
        strcat(b->old, of->old);
        strcat(b->now, of->now);
        b->n_line += count_of(of->old, "\n");
    }
}
#define ADD(lines) add_lines(&b, old, lines, sizeof lines / sizeof *lines)

/* Writes old.yaml and now.yaml of a case with a weighted list or a front. Returns the warnings of the former. */
static const char *write_both(bool is_front)
{
    static both b;
    const char *old = temp("old.yaml");
    b = (both){0};
    ADD(scene);
    ADD(load_cases);
    if (is_front)
        ADD(front);
    else
        ADD(rows);
    file_with("old.yaml", b.old);
    file_with("now.yaml", b.now);
    return b.said;
}

/* The last command gave these warnings of old names, and no others. */
static void warns(const char *warnings)
{
    ck_assert_int_eq(count_of(said.err, " is now "), count_of(warnings, "\n"));
    for (const char *p = warnings; *p; p += strcspn(p, "\n") + 1)
        ERRS("%.*s\n", (int)strcspn(p, "\n"), p);
}

START_TEST(an_old_case_has_the_result_of_the_new_one)
{
    const char *warnings = write_both(_i), *old = temp("old.yaml"), *now = temp("now.yaml");
    HIFDM(0, "run", old, "-o", temp("old.h5"), "--quiet");
    warns(warnings);
    HIFDM(0, "run", now, "-o", temp("now.h5"), "--quiet");
    ck_assert_int_eq(count_of(said.err, " is now "), 0);
    EXPECT(temp("old.h5"), temp("now.h5"), "--", "differing(a, b) == ['case/text']",
           _i ? "'front' in a" : "'front' not in a and a['goals/weight'].shape == (5,)");
    /* the result of an old case is read without a warning */
    HIFDM(0, "show", temp("old.h5"));
    ck_assert_int_eq(count_of(said.err, " is now "), 0);
    HIFDM(0, "check", old);
    warns(warnings);
}
END_TEST

START_TEST(overrides_may_have_old_names)
{
    static const char *const set[][3] = {
        {"optimize.compare_lm=false", "optimize.compare_lm", "optimize.refine"},
        {"cases.1.move_m=[0, 0, 2]", "cases.1.move_m", "load_cases.1.support_displacement_m"},
        {"optimize.goals.1.weight=2", "optimize.goals.1.weight", "optimize.objective.1.weight"},
        {"optimize.objective.0.over=states", "optimize.objective.0.over=states", "optimize.objective.0.load_case=all"},
        {"adjust.aim=theory", "adjust.aim=theory", "adjust.aim=target_positions"},
        {"optimize.goals.3.fit=best", "optimize.goals.3.fit=best", "optimize.objective.3.feed=refocused"},
        {"optimize.goals=[{figure: mass, mass_kg_per_m: 1}]", "optimize.goals", "optimize.objective"}};
    write_both(false);
    for (size_t k = 0; k < sizeof set / sizeof *set; k++) {
        HIFDM(0, "check", temp("now.yaml"), "--set", set[k][0]);
        warns(keep(formatted("warning: --set %s: " IS_NOW("%s", "%s"), set[k][0], set[k][1], set[k][2])));
    }
    HIFDM(2, "check", temp("now.yaml"), "--set", "optimize.polish_iterations=0");
    ERR("error: --set optimize.polish_iterations=0: optimize.refine_steps: must be at least 1");
}
END_TEST

/* ---- tolerance.require ---- */

#define BUILT                                                                                                          \
    SMALL_SCENE "  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\nsurface: {frequencies_Hz: [2e8, 1e9]}\n"                     \
                "tolerance: {sigma_cut_m: 1e-4, samples: 40%s}\n"

/* Each measure becomes a figure with its feed. A loss at 1 GHz becomes the RMS that Ruze's formula gives it: 1 dB is
 * c sqrt(ln 10 / 10) / (4 pi f) = 11.448 mm. Above 3 dB, the losses were infinite. Without required_yield the share is
 * 0.95, and 40 samples are too few for a pass, but no error. */
START_TEST(old_requirements_become_rows)
{
    static const char *const row[][2] = {
        {"psi_m, at_most: 0.123456789", "psi, at_most: 0.123456789"},
        {"half_path_rms_m, at_most: 1, at_least: 0", "surface, feed: fixed, at_least: 0, at_most: 1"},
        {"fit_half_path_rms_m, at_most: 1", "surface, at_most: 1"},
        {"facet_half_path_rms_m, at_most: 1", "facets, feed: fixed, at_most: 1"},
        {"facet_fit_half_path_rms_m, at_most: 1", "facets, at_most: 1"},
        {"gain_loss_dB, at_most: 1", "surface, feed: fixed, at_most: 0.01144771"},
        {"facet_fit_gain_loss_dB, at_most: 4", "facets, at_most: 0.01982801"},
        {"pattern_loss_dB, at_most: 9", "gain_loss, feed: fixed, at_most: 9"},
        {"tension_min_N, at_least: 1", "tension, at_least: 1"},
        {"n_slack, at_most: 0", "slack_cables, at_most: 0"},
        {"n_loose, at_most: 0", "loose_nodes, at_most: 0"}};
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        const char *c = file_with("c.yaml", formatted(BUILT, keep(formatted(", require: [{measure: %s}]", row[k][0]))));
        HIFDM(0, "check", c);
        ERRS("%s:6:55: tolerance.require.0: this list is now `requirements`. Write `requirements: [{figure: %s", c,
             row[k][1]);
        ERR(", share: 0.95, search: off}]` instead, because version 0.4 refuses the old keys\n");
        ck_assert_int_eq(count_of(said.err, "warning: "), 1);
    }
    HIFDM(0, "run", temp("c.yaml"), "-o", temp("a.h5"));
    OUT("verdict: ");
    EXPECT(temp("a.h5"), "--", "a['requirements/share'][0] == 0.95 and a['requirements/at_most'][0] == 0",
           "texts(a['requirements/load_case']) == ['nominal']", "np.isnan(a['tolerance'].attrs['sigma_scale'])");
}
END_TEST

START_TEST(faults_of_old_requirements)
{
    static const char *const fault[][2] = {
        {", required_yield: 0.9",
         "6:61: tolerance.required_yield: is an old key; write it as figure, bound and share of the rows of "},
        {", require: [{measure: psi_m, at_most: 1}]}\nrequirements: [{figure: psi, at_most: 1}]\nnodes: []\n#",
         "6:55: tolerance.require.0: is an old key"},
        {", require: [{at_most: 1}]", "6:55: tolerance.require.0.measure: is missing"},
        {", require: [{measure: psi_m}]", "6:65: requirements.0.figure: has no bound"}};
    for (size_t k = 0; k < sizeof fault / sizeof *fault; k++) {
        HIFDM(2, "check", file_with("f.yaml", formatted(BUILT, fault[k][0])));
        ERRS("f.yaml:%s", fault[k][1]);
    }
}
END_TEST

/* The second name is the error, whichever it is. */
static const struct {
    const char *text, *error;
} twice[] = {
    {"optimize: {compare_lm: true,\n  refine: true}\n",
     "8:11: optimize.refine: is set twice: remove one, here or at 7:24\n"},
    {"optimize: {refine: true,\n  compare_lm: true}\n",
     "8:15: optimize.refine: is set twice: remove one, here or at 7:20\n"},
    {"optimize: {goals: [],\n  objective: []}\n",
     "8:14: optimize.objective: is set twice: remove one, here or at 7:19\n"},
    {"optimize: {front: [],\n  objectives: []}\n", "8:15: optimize.front: is set twice: remove one, here or at 7:19\n"},
    {"cases: [{name: a, force_N: [0, 0, 1]}]\nload_cases: []\n",
     "8:13: load_cases: is set twice: remove one, here or at 7:9\n"},
    {"optimize: {objective: [{figure: psi,\n  goal: psi}]}\n",
     "8:9: optimize.objective.0.figure: is set twice: remove one, here or at 7:33\n"},
    {"cases: [{name: a, force_N: [0, 0, 1]}]\noptimize: {objective: [{figure: psi, load_case: a,\n  over: states}]}\n",
     "9:9: optimize.objective.0.load_case: is set twice: remove one, here or at 8:49\n"},
    {"cases: [{name: a, force_N: [0, 0, 1]}]\noptimize: {objective: [{figure: psi, over: states,\n  state: a}]}\n",
     "9:10: optimize.objective.0.load_case: is set twice: remove one, here or at 8:44\n"},
    {"optimize: {refine: true}\noptimize.compare_lm: true\n",
     "8:22: optimize.refine: is set twice: remove one, here or at 7:20\n"},
    {"optimize: {goals: [{figure: psi}]}\noptimize.objective: [{figure: psi}]\n",
     "8:21: optimize.objective: is set twice: remove one, here or at 7:20\n"}};

START_TEST(both_names_of_a_key_are_an_error)
{
    const char *path = file_with("c.yaml", keep(formatted(ON_TRUSS "%s", twice[_i].text)));
    HIFDM(2, "check", path);
    ERRS("error: %s:%s", path, twice[_i].error);
}
END_TEST

START_TEST(reserved_names_of_load_cases)
{
    static const char *const name[] = {"name", "nominal", "all"};
    for (int k = 0; k < 3; k++) {
        const char *path =
            file_with("c.yaml", keep(formatted(ON_TRUSS "load_cases: [{name: %s, force_N: [0, 0, 1]}]\n", name[k])));
        HIFDM(2, "check", path);
        ERRS("error: %s:7:21: load_cases.0.name: must be another word than name, nominal and all\n", path);
    }
}
END_TEST

/* ---- a study ---- */

#define BASE                                                                                                           \
    EA_SCENE                                                                                                           \
    "adjust: {set: inner, range_m: 0.002, step_m: 1e-4%s}\noptimize: {generations: 2, seed: 7, method: ga+lm%s}\n"

/* Results have the new names, and points keep the ids that they have in version 0.2. */
START_TEST(axes_may_have_old_names)
{
    file_with("old_base.yaml", keep(formatted(BASE, ", moves: 2", ", compare_lm: true")));
    const char *old = file_with("old.yaml", "base: old_base.yaml\nsweep:\n  optimize.polish_iterations: [1, 2]\n"
                                            "  optimize.population: [6]\n  adjust.aim: [theory, design]\n");
    const char *now = file_with("now.yaml", "base: old_base.yaml\nsweep:\n  optimize.refine_steps: [1, 2]\n"
                                            "  optimize.population: [6]\n  adjust.aim: [target_positions, design]\n");
    const char *folder = temp("s.d"), *merged = temp("s.h5"), *base = temp("old_base.yaml");
    const char *of_base = keep(
        formatted("warning: %s:5:52: " IS_NOW("adjust.moves", "adjust.max_adjustments") "warning: %s:6:52: " IS_NOW(
                      "optimize.compare_lm", "optimize.refine"),
                  base, base));
    const char *of_axes = keep(formatted(
        "warning: %s:3:3: " IS_NOW("optimize.polish_iterations", "optimize.refine_steps") "warning: %s:5:16: " IS_NOW(
            "adjust.aim=theory", "adjust.aim=target_positions"),
        old, old));
    HIFDM(0, "check", old);
    warns(keep(formatted("%s%s", of_axes, of_base)));
    OUT("optimize.refine_steps: 1, 2");
    OUT("adjust.aim: target_positions, design");
    OUT("first 1296171d1d9f: adjust.aim=target_positions, optimize.refine_steps=1, optimize.population=6\n");
    HIFDM(0, "sweep", old, "--dir", folder, "--quiet");
    warns(keep(formatted("%s%s", of_axes, of_base)));
    HIFDM(0, "status", now, "--dir", folder);
    OUT("done      4");
    warns(of_base);
    HIFDM(0, "merge", old, "--dir", folder, "-o", merged, "--quiet");
    EXPECT(merged, "--", "a['points/input/optimize.refine_steps'][:].tolist() == [1, 2, 1, 2]",
           "texts(a['points/input/adjust.aim']) == ['target_positions'] * 2 + ['design'] * 2",
           "sorted(a['points/input']) == ['adjust.aim', 'optimize.population', 'optimize.refine_steps']");
}
END_TEST

START_TEST(old_words_of_axes)
{
    const char *path = file_with("s.yaml", ON_TRUSS "load_cases: [{name: a, force_N: [0, 0, 1]}]\n" SMALL_GA
                                                    "optimize.goals: [{figure: psi}]\n"
                                                    "sweep:\n  optimize.goals.0.over: [design, states]\n");
    HIFDM(0, "sweep", path, "--dir", temp("s.d"), "--quiet");
    ERRS("warning: %s:11:35: " IS_NOW("optimize.objective.0.over=states", "optimize.objective.0.load_case=all"), path);
    HIFDM(0, "merge", path, "--dir", temp("s.d"), "-o", temp("s.h5"), "--quiet");
    EXPECT(temp("s.h5"), "--", "texts(a['points/input/optimize.objective.0.over']) == ['design', 'states']",
           "a['points/form/psi_m'][0] == a['points/form/psi_m'][1]",
           "sum('load_cases_mean' in n for n in contents(a)) == 3");
    static const char *const feed[] = {"goals.0.fit: [none, best]", "objective.0.feed: [fixed, refocused]"};
    for (int k = 0; k < 2; k++) { /* the point has the id that it has in version 0.2 */
        HIFDM(0, "check",
              file_with("u.yaml", formatted(ON_TRUSS "surface: {}\n" SMALL_GA "optimize.objective: [{figure: facets}]\n"
                                                     "sweep:\n  optimize.%s\n",
                                            feed[k])));
        OUT("first 6924eac3372e: optimize.objective.0.feed=fixed\n");
    }
    path = file_with("t.yaml", ON_TRUSS SMALL_GA "sweep: {optimize.compare_lm: [true],\n  optimize.refine: [false]}\n");
    HIFDM(2, "check", path);
    ERRS("error: %s:9:3: sweep.optimize.refine: is an axis already, on line 8\n", path);
}
END_TEST

/* ---- options ---- */

START_TEST(options_may_have_old_names)
{
    const char *result = temp("r.h5");
    write_both(false);
    HIFDM(0, "run", temp("now.yaml"), "-o", result, "--quiet");
    HIFDM(0, "export", result, "--csv", temp("now"), "--load-case", "cold");
    ck_assert_str_eq(said.err, "");
    for (int k = 0; k < 2; k++) {
        HIFDM(0, "export", result, "--csv", temp("old"), "--force", k ? "--case=cold" : "--case", k ? NULL : "cold");
        ck_assert_str_eq(said.err, "warning: " IS_NOW("--case", "--load-case"));
        SHELL(0, "diff -r \"$1\" \"$2\"", temp("now"), temp("old"));
    }
    static const char *const stage[][2] = {{"optimize", "search"}, {"polish", "refine"}};
    for (int k = 0; k < 2; k++) {
        HIFDM(0, "export", result, "--csv", temp("now"), "--force", "--stage", stage[k][1]);
        ck_assert_str_eq(said.err, "");
        HIFDM(0, "export", result, "--csv", temp("old"), "--force", "--stage", stage[k][0]);
        ck_assert_str_eq(said.err, formatted("warning: " IS_NOW("--stage %s", "--stage %s"), stage[k][0], stage[k][1]));
        SHELL(0, "diff -r \"$1\" \"$2\"", temp("now"), temp("old"));
    }
    HIFDM(2, "export", result, "--csv", temp("no"), "--stage", "best");
    ERR("error: --stage must be form, search or refine, not 'best'\n");
    HIFDM(2, "run", temp("now.yaml"), "--case", "cold");
    ERR("error: '--case' is not an option of this command. 'hifdm help run' lists the options of the command\n");
    HIFDM(0, "help", "export");
    ck_assert_ptr_null(strstr(said.out, "--case"));
}
END_TEST

Suite *suite_cli_old_names(void)
{
    Suite *suite = suite_create("cli/old_names");
    TCase *tests = tcase_create("old names");
    tcase_add_loop_test(tests, an_old_case_has_the_result_of_the_new_one, 0, 2);
    tcase_add_test(tests, overrides_may_have_old_names);
    tcase_add_loop_test(tests, both_names_of_a_key_are_an_error, 0, (int)(sizeof twice / sizeof *twice));
    tcase_add_test(tests, old_requirements_become_rows);
    tcase_add_test(tests, faults_of_old_requirements);
    tcase_add_test(tests, reserved_names_of_load_cases);
    tcase_add_test(tests, axes_may_have_old_names);
    tcase_add_test(tests, old_words_of_axes);
    tcase_add_test(tests, options_may_have_old_names);
    suite_add_tcase(suite, tests);
    return suite;
}
