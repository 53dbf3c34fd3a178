/* What the options of `hifdm run` do, and where the result is written without them. */
#include "cli.h"

static const char small_case[] = "title: small\n" SMALL_SCENE SMALL_GA;
static const char small_form_case[] = SMALL_SCENE;

START_TEST(without_o_the_file_is_named_after_the_case)
{
    const char *folder = temp("here"), *path = file_with("my.reflector.yaml", small_case);
    SHELL(0, "mkdir \"$1\" && cd \"$1\" && \"$0\" run \"$2\"", folder, path);
    OUT("results       my.reflector.h5\n");
    ck_assert(is_there(temp("here/my.reflector.h5"))); /* in the current folder, not in the case's */
    ck_assert(!is_there(temp("my.reflector.h5")));
}
END_TEST

START_TEST(quiet_prints_nothing_but_warnings)
{
    HIFDM(0, "run", file_with("c.yaml", small_case), "-o", temp("q.h5"), "--quiet");
    ck_assert_str_eq(said.out, "");
    ck_assert_str_eq(said.err, "");
    HIFDM(0, "run", CHEN, "-o", temp("w.h5"), "--quiet", "--set", "optimize.generations=2");
    ck_assert_str_eq(said.out, "");
    ERR("warning: the stopping rule rms_change ended the iteration before equilibrium");
}
END_TEST

START_TEST(set_may_be_repeated_and_the_last_wins)
{
    const char *out = temp("s.h5");
    HIFDM(0, "run", file_with("c.yaml", small_case), "-o", out, "--json", "--set", "form.pretension_N=12", "--set",
          "optimize.generations=5", "--set", "optimize.population=9", "--set", "form.pretension_N=14", "--set",
          "scene.parabolic_cylinder.modules=[3, 2]", "--set", "title=other words");
    EXPECT(out, "--", "a['search/population/psi_m'].shape == (5, 9)", "attribute(a, 'title') == 'other words'",
           /* cables of law tension; nodal forces hold to 1e-7, single tensions to a few times that */
           "np.allclose(a['form/tension_N'][:][a['scene/cable/group'][:] == 0], 14, rtol=1e-6, atol=0)",
           "a['scene/node/id'].shape == (7 * 5,)",
           "texts(a['case/overrides']) == 'form.pretension_N=12\\noptimize.generations=5\\noptimize.population=9\\n' "
           "'form.pretension_N=14\\nscene.parabolic_cylinder.modules=[3, 2]\\ntitle=other words\\n'");
}
END_TEST

START_TEST(a_case_without_optimize_runs_no_ga)
{
    const char *path = file_with("f.yaml", small_form_case), *out = temp("f.h5");
    HIFDM(0, "run", path, "-o", out, "--json");
    EXPECT(out_as("f.json"), out, "--", "'form' in a", "'search' not in a", "'refine' not in a", "'search' not in b",
           "'ga' not in b", "not b.attrs['has_optimize']");
    ck_assert_str_eq(said.err, "");
    /* a key of the section brings it along */
    HIFDM(0, "run", path, "-o", out, "--force", "--json", "--set", "optimize.generations=2");
    EXPECT(out_as("f.json"), out, "--", "a['search']['generations'] == 2", "'search' in b");
}
END_TEST

START_TEST(seed_option_wins_over_the_case)
{
    const char *path = file_with("c.yaml", small_case), *a = temp("a.h5"), *b = temp("b.h5");
    HIFDM(0, "run", path, "-o", a, "--json", "--seed", "18446744073709551615");
    EXPECT(out_as("a.json"), a, "--", "a['seed'] == 2**64 - 1", "b.attrs['seed'] == 2**64 - 1");
    HIFDM(0, "run", path, "-o", b, "--json", "--set", "optimize.seed=18446744073709551615");
    EXPECT(a, b, "--", "differing(a, b) == ['case/overrides']");
    HIFDM(0, "run", file_with("f.yaml", small_form_case), "-o", temp("f.h5"), "--seed", "1");
    ERR("warning: the option --seed has no effect, because the case has no `optimize` section\n");
}
END_TEST

START_TEST(threads_option_is_obeyed)
{
    HIFDM(0, "run", file_with("c.yaml", small_case), "-o", temp("t.h5"), "--json", "--threads", "3");
    EXPECT(out_as("t.json"), "--", "a['threads'] == 3");
    HIFDM(0, "check", file_with("c.yaml", small_case), "--threads", "5");
    OUT("(5 threads)");
}
END_TEST

/* Options may stand anywhere behind the command, long ones joined to their value by '='. */
START_TEST(options_may_be_written_both_ways)
{
    const char *path = file_with("c.yaml", small_case), *out = temp("o.h5");
    HIFDM(0, "run", "--threads=2", formatted("--output=%s", out), "--set=form.pretension_N=11", path, "--json");
    EXPECT(out_as("o.json"), out, "--", "a['threads'] == 2", "'form.pretension_N=11' in texts(b['case/overrides'])");
}
END_TEST

/* After "--" a word is a file, whatever it begins with. */
START_TEST(files_may_begin_with_a_hyphen)
{
    const char *folder = temp("");
    file_with("-c.yaml", small_form_case);
    SHELL(2, "cd \"$1\" && \"$0\" run -c.yaml", folder);
    ERR("unknown option '-c.yaml'");
    SHELL(0, "cd \"$1\" && \"$0\" run --json -- -c.yaml && test -e -c.h5", folder);
    OUT("\"file\": \"./-c.h5\"");
    SHELL(0, "cd \"$1\" && \"$0\" run --restart -o --new.h5 -- -c.yaml && test -e --new.h5", folder);
    SHELL(0, "cd \"$1\" && \"$0\" diff --rtol 1 -- -c.h5 --new.h5", folder);
    SHELL(2, "cd \"$1\" && \"$0\" show -- -c.h5 --json", folder);
    ERR("'--json' is an unexpected argument of 'hifdm show'");
    SHELL(5, "cd \"$1\" && \"$0\" show -- --", folder);
    ERR("error: --: cannot open");
    SHELL(2, "cd \"$1\" && \"$0\" show --", folder);
    ERR("'hifdm show' needs the argument FILE");
    HIFDM(2, "explain", "--", "-c.yaml");
    ERR("the glossary has no entry '-c.yaml'");
}
END_TEST

/* On a terminal, on standard error, and only there. */
START_TEST(progress_is_shown_on_a_terminal_only)
{
    static const char script[] =
        "import os, pty, subprocess, sys\n"
        "ours, theirs = pty.openpty()\n"
        "code = subprocess.run(sys.argv[1:], stderr=theirs, stdout=subprocess.DEVNULL).returncode\n"
        "os.close(theirs)\n"
        "try:\n"
        "    print(os.read(ours, 65536))\n"
        "except OSError:\n" /* Linux: nothing was written and the other end is closed */
        "    print('nothing')\n"
        "sys.exit(code)\n";
    const char *path = file_with("c.yaml", small_case), *out = temp("p.h5");
    const char *const loud[] = {python_program(), "-c", script, hifdm_program(), "run", path, "-o", out, NULL};
    demand_exit(run_command(HANG_S, loud), 0, "run on a terminal", __LINE__);
    OUT("generation ");
    OUT("best psi");
    const char *const quiet[] = {python_program(), "-c",      script, hifdm_program(), "run", path, "-o", out,
                                 "--force",        "--quiet", NULL};
    demand_exit(run_command(HANG_S, quiet), 0, "run --quiet on a terminal", __LINE__);
    OUT("nothing");
    HIFDM(0, "run", path, "-o", out, "--force");
    ck_assert_str_eq(said.err, "");
}
END_TEST

Suite *suite_cli_options(void)
{
    Suite *suite = suite_create("cli/options");
    TCase *tcase = tcase_create("options");
    tcase_add_test(tcase, without_o_the_file_is_named_after_the_case);
    tcase_add_test(tcase, quiet_prints_nothing_but_warnings);
    tcase_add_test(tcase, set_may_be_repeated_and_the_last_wins);
    tcase_add_test(tcase, a_case_without_optimize_runs_no_ga);
    tcase_add_test(tcase, seed_option_wins_over_the_case);
    tcase_add_test(tcase, threads_option_is_obeyed);
    tcase_add_test(tcase, options_may_be_written_both_ways);
    tcase_add_test(tcase, files_may_begin_with_a_hyphen);
    tcase_add_test(tcase, progress_is_shown_on_a_terminal_only);
    suite_add_tcase(suite, tcase);
    return suite;
}
