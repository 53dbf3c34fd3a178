/* run --more: a finished refinement continues as if it had never ended, and nothing is lost if it does not end. */
#include "session.h"

#define NET                                                                                                            \
    "scene:\n  paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 3, rear_distance_m: 1.8}\n"                       \
    "  EA_inner_N: 4.0e4\n  EA_boundary_N: 4.0e4\n"                                                                    \
    "form: {pretension_N: 10, prestress: exact}\nsurface: {frequencies_Hz: [1e9]}\n"
#define LATER                                                                                                          \
    "cables: [{expansion_per_K: -1e-6}]\n"                                                                             \
    "truss: {expansion_per_K: 0, ring: {cells_per_bay: 2, bracing: single, held: bay}}\n"                              \
    "load_cases: [{name: cold, temperature_K: -100}]\ntolerance: {sigma_cut_m: 1.0e-5, samples: 50}\n"                 \
    "requirements:\n  - {figure: facets, at_most: 0.03, load_case: all, share: 0.9, search: off}\n"                    \
    "  - {figure: tension, at_least: 1}\n"
#define OPTIMIZE                                                                                                       \
    "optimize:\n  population: 8\n  generations: 6\n"                                                                   \
    "  variables: [{set: all, vary: force_density, range: 50 %}]\n  objective: [{figure: facets, feed: fixed}]\n"

static const char *case_of(const char *name, const char *parts, const char *method, int steps)
{
    return file_with(name, keep(formatted("%s%s  method: %s\n  refine_steps: %d\n", parts, OPTIMIZE, method, steps)));
}

/* All data sets of the two are equal, and all attributes of the refinement but its times. */
static void demand_twins(const char *continued, const char *whole)
{
    EXPECT(continued, whole, "--", "differing(a, b) in (['case/text'], ['case/overrides', 'case/text'])",
           "str({k: v for k, v in a['refine'].attrs.items() if k[-2:] != '_s'}) == "
           "str({k: v for k, v in b['refine'].attrs.items() if k[-2:] != '_s'})",
           "a.attrs['warnings'].split(b'Levenberg')[0] == b.attrs['warnings'].split(b'Levenberg')[0]",
           "a.attrs['finished'] and a.attrs['status'] == b.attrs['status'] and a.attrs['sessions'] == 2",
           "sorted(a) == sorted(b) and sorted(a['refine'].attrs) == sorted(b['refine'].attrs)");
}

/* With a search before the refinement, and with all stages that follow it. */
START_TEST(more_steps_give_the_bits_of_one_run)
{
    static const char *const method[] = {"lm", "ga+lm"};
    const char *part = temp("part.h5"), *whole = temp("whole.h5"), *first = temp("first.h5");
    const char *three = case_of("three.yaml", NET LATER, method[_i], 3);
    HIFDM(0, "run", three, "-o", part, "--quiet");
    SHELL(0, "cp \"$1\" \"$2\"", part, first);
    HIFDM(0, "run", three, "-o", part, "--quiet", "--more", "2", "--threads", "1");
    HIFDM(0, "run", case_of("five.yaml", NET LATER, method[_i], 5), "-o", whole, "--quiet", "--threads", "2");
    demand_twins(part, whole);
    EXPECT(part, first, "--", "a['refine'].attrs['steps'] == 5 and b['refine'].attrs['steps'] == 3",
           "a['refine'].attrs['merit'] < b['refine'].attrs['merit']",
           "a['refine'].attrs['wall_s'] > b['refine'].attrs['wall_s']");
    HIFDM(0, "run", three, "-o", part);
    ERR("this file is the finished result of this case");
    SHELL(0, "test -z \"$(ls \"$1\" | grep -E 'journal|tmp|before')\"", temp("."));
}
END_TEST

/* The predicted gain of a run that has ended early is near what more steps gain. */
START_TEST(a_settled_run_continues_and_a_converged_one_does_not)
{
    const char *c = case_of("c.yaml", NET, "lm", 200), *path = temp("r.h5"), *before = temp("before.h5");
    HIFDM(0, "run", c, "-o", path);
    OUT("settled after ");
    OUT(": the last five gained less than 0.01 %, the model predicts at most ");
    SHELL(0, "cp \"$1\" \"$2\"", path, before);
    HIFDM(0, "run", c, "-o", path, "--more", "200");
    OUT("converged after ");
    EXPECT(path, before, "--",
           "b['refine'].attrs['predicted_gain'] < 1e-4 and a['refine'].attrs['predicted_gain'] == 0",
           "0 < 1 - a['refine'].attrs['merit'] / b['refine'].attrs['merit'] < b['refine'].attrs['predicted_gain']",
           "b['refine'].attrs['steps'] + 2 < a['refine'].attrs['steps'] < 40");
    SHELL(0, "cp \"$1\" \"$2\"", path, before);
    HIFDM(0, "run", c, "-o", path, "--more", "3");
    ERRS("warning: %s: --more changes nothing, because the refinement has converged", path);
    OUT("converged after ");
    SHELL(0, "cmp \"$1\" \"$2\"", path, before);
}
END_TEST

/* Better designs are claimed only if the model predicts them and the last steps have gained something. */
START_TEST(better_designs_are_claimed_only_if_they_are_near)
{
    const char *c = case_of("c.yaml", NET, "lm", 3), *path = temp("r.h5");
    HIFDM(0, "run", c, "-o", path);
    ERR("Levenberg-Marquardt has not converged after 3 steps. Better designs are near: the last 3 steps lowered the "
        "merit by ");
    ERR(" %; the model predicts at most ");
    ERR(" % less. Continue with the option --more N");
    HIFDM(0, "run", c, "-o", path, "--more", "5", "--json"); /* the model predicts less than 0.01 % */
    ERR("Levenberg-Marquardt has not converged after 8 steps: the last 5 steps lowered the merit by ");
    ck_assert(!strstr(said.err, "Better designs are near") && !strstr(said.err, "--more"));
    EXPECT(out_as("r.json"), "--", "0 < a['refine']['predicted_gain'] < 1e-4",
           "a['refine']['stop_reason'] == 'max_iterations'");
}
END_TEST

/* An objective after the best fit jumps where the fit finds another minimum. The model does not know of that, and its
 * prediction is no claim. */
START_TEST(a_model_that_its_steps_refute_is_no_claim)
{
    const char *c = case_of("c.yaml", NET, "lm", 200), *path = temp("r.h5"),
               *refocused = "optimize.objective=[{figure: facets, feed: refocused}]";
    HIFDM(0, "run", c, "-o", path, "--set", refocused);
    OUT(": the last five gained less than 0.01 %, although the model predicts at most ");
    HIFDM(0, "run", c, "-o", path, "--set", refocused, "--more", "12");
    ERR("the last 10 steps lowered the merit by ");
    ck_assert(!strstr(said.err, "Better designs are near"));
    EXPECT(path, "--", "a['refine'].attrs['predicted_gain'] > 1e-4", "a['refine'].attrs['algorithm_stop'] == 2");
}
END_TEST

START_TEST(what_cannot_continue_is_refused)
{
    const char *c = case_of("c.yaml", NET, "lm", 3), *path = temp("r.h5"), *ga = temp("ga.h5");
    HIFDM(2, "run", c, "-o", path, "--more", "3");
    ERRS("error: %s: the option --more continues a finished result, but this file does not exist. Run the command "
         "without --more first",
         path);
    ck_assert(!is_there(path));
    static const char *const wrong[] = {"0", "-1", "1.5", "many", ""};
    for (int i = 0; i < 5; i++) {
        HIFDM(2, "run", c, "-o", path, "--more", wrong[i]);
        ERR("error: --more must be from 1 to 100000, not '");
    }
    HIFDM(2, "run", c, "-o", path, "--more", "3", "--restart");
    ERR("error: the option '--more' continues a finished result, so it cannot be combined with '--restart'");
    HIFDM(2, "run", c, "-o", path, "--more", "3", "--point", "f.h5:1");
    ERR("error: the option '--more' continues a finished result, so it cannot be combined with '--point'");
    HIFDM(2, "tolerance", c, "--more", "3");
    ERR("'--more' is not an option of this command");
    const char *search = case_of("ga.yaml", NET "", "ga\n  refine: false", 3);
    HIFDM(0, "run", search, "-o", ga, "--quiet");
    HIFDM(2, "run", search, "-o", ga, "--more", "3");
    ERRS("error: %s: this result has no refinement that --more could continue. Set optimize.method to lm", ga);
    const char *none = case_of("none.yaml", NET "requirements: [{figure: facets, at_most: 1e-6}]\n", "lm", 3);
    HIFDM(3, "run", none, "-o", temp("none.h5"), "--quiet");
    HIFDM(2, "run", none, "-o", temp("none.h5"), "--more", "3");
    ERRS("error: %s: this result has no refinement that --more could continue, because no design met the constraints. "
         "Loosen requirements or limits, or change the start, and run again",
         temp("none.h5"));
    HIFDM(0, "run", c, "-o", path, "--quiet");
    HIFDM(5, "run", c, "-o", path, "--more", "3", "--set", "form.pretension_N=11");
    ERR("finished result of another case. The differences are: form.pretension_N.");
    SHELL(0, "\"$2\" -c \"import h5py; del h5py.File('$1', 'r+')['refine_state']\"", path, python_program());
    HIFDM(5, "run", c, "-o", path, "--more", "3");
    ERR("the option --more needs the state of the refinement, but an earlier version wrote this result without it");
}
END_TEST

/* The finished result remains, whatever ends the run. */
START_TEST(a_stopped_run_leaves_the_finished_result)
{
    const char *c = case_of("c.yaml", NET, "lm", 3), *path = temp("r.h5"), *before = temp("before.h5"),
               *whole = temp("whole.h5"), *refocused = "optimize.objective=[{figure: facets, feed: refocused}]",
               *rings = "scene.paraboloid.rings=6";
    const char *const argv[] = {hifdm_program(), "run",     c,       "-o",  path,     "--progress", "jsonl",
                                "--set",         refocused, "--set", rings, "--more", "20",         NULL};
    HIFDM(0, "run", c, "-o", path, "--quiet", "--set", refocused, "--set", rings);
    SHELL(0, "cp \"$1\" \"$2\"", path, before);
    for (int kills = 0; kills < 2; kills++) {
        session s = start_program(argv);
        ck_assert(wait_until(&s, says_refine, temp("err")));
        ck_assert_int_eq(end_by(&s, kills ? SIGKILL : SIGTERM), kills ? 128 + SIGKILL : 75);
        if (!kills)
            ck_assert(says(temp("err"), " of the refinement") && says(temp("err"), "The earlier result is unchanged"));
        SHELL(0, "cmp \"$1\" \"$2\"", path, before);
    }
    HIFDM(0, "run", c, "-o", path, "--quiet", "--set", refocused, "--set", rings, "--more", "1");
    HIFDM(0, "run", case_of("four.yaml", NET, "lm", 4), "-o", whole, "--quiet", "--set", refocused, "--set", rings);
    demand_twins(path, whole);
    SHELL(0, "test -z \"$(ls -A \"$1\" | grep -E 'journal|tmp')\"", temp("."));
}
END_TEST

Suite *suite_cli_more(void)
{
    Suite *suite = suite_create("cli/more");
    TCase *tcase = tcase_create("more");
    tcase_add_loop_test(tcase, more_steps_give_the_bits_of_one_run, 0, 2);
    tcase_add_test(tcase, a_settled_run_continues_and_a_converged_one_does_not);
    tcase_add_test(tcase, better_designs_are_claimed_only_if_they_are_near);
    tcase_add_test(tcase, a_model_that_its_steps_refute_is_no_claim);
    tcase_add_test(tcase, what_cannot_continue_is_refused);
    tcase_add_test(tcase, a_stopped_run_leaves_the_finished_result);
    suite_add_tcase(suite, tcase);
    return suite;
}
