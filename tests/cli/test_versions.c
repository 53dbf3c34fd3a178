/* Result files of earlier versions are read: by show, export, report and diff. old_result.py makes them from text. */
#include "cli.h"

static const char *old_result(const char *name)
{
    const char *path = temp(name);
    const char *const argv[] = {python_program(),
                                keep(source_path("tests/cli/old_result.py")),
                                "file",
                                keep(source_path("tests/cli/data/result-0.1.0.json")),
                                path,
                                NULL};
    demand_exit(run_command(HANG_S, argv), 0, "old_result.py", __LINE__);
    return path;
}

START_TEST(results_of_0_1_0_are_shown_and_exported)
{
    const char *old = old_result("old.h5"), *csv = temp("csv"), *vtk = temp("vtk"), *cuts = temp("cuts.csv");
    HIFDM(0, "show", old);
    OUT("a small dish with every group that a file can have\n");
    OUT("cold ");
    HIFDM(0, "show", old, "--json");
    EXPECT(out_as("s.json"), old, "--", "a['form']['psi_m'] == b['form'].attrs['psi_m'] > 0",
           "a['optimize']['psi_m'] == b['ga'].attrs['best_psi_m']",
           "a['polish']['psi_m'] == b['polish'].attrs['psi_m']", "a['truss']['mass_kg'] == b['truss'].attrs['mass_kg']",
           "a['cases']['cold']['slack_cables'] == b['cases/cold'].attrs['n_slack'] == 13",
           "a['form']['surface']['half_path_rms_m'] == b['surface/form'].attrs['half_path_rms_m']",
           "a['tolerance']['samples'] == len(b['tolerance/sample/psi_m']) == 12");
    HIFDM(0, "export", old, "--csv", csv);
    HIFDM(0, "export", old, "--vtk", vtk);
    OUT(": theoretical.hdf theoretical_facets.hdf form.hdf form_facets.hdf optimize.hdf optimize_facets.hdf polish.hdf "
        "polish_facets.hdf truss.hdf case_1.hdf (cold)\n"); /* the net has one ring: since 0.2.0 it has facets */
    HIFDM(0, "export", old, "--cutlist", cuts);
    EXPECT(old, keep(formatted("%s/cables.csv", csv)), cuts, "--",
           "list(column(b, 'tension_N')) == list(column(c, 'tension_N')) == a['polish/tension_N'][:].tolist()");
    HIFDM(0, "export", old, "--csv", temp("cold"), "--load-case", "cold");
    HIFDM(0, "report", old, "-o", temp("old.html"));
    char *page = read_file(temp("old.html"), NULL);
    demand_part(page, "a small dish with every group that a file can have", __LINE__);
    free(page);
}
END_TEST

START_TEST(results_of_0_1_0_are_compared)
{
    const char *old = old_result("old.h5"), *same = old_result("same.h5"), *c = temp("old.yaml"), *now = temp("now.h5");
    HIFDM(0, "diff", old, same);
    OUT("167 data sets, 0 differ;");
    SHELL(0,
          "\"$1\" -c 'import h5py, sys; f = h5py.File(sys.argv[1], \"a\"); open(sys.argv[2], \"wb\").write("
          "f[\"case/text\"][()]); f[\"form/tension_N\"][1] = 7' \"$2\" \"$3\"",
          python_program(), same, c);
    HIFDM(1, "diff", old, same);
    OUT("/form/tension_N [1]: ");
    /* with this version's result of the same case: what both have is the same but for the order of sums */
    HIFDM(0, "run", c, "-o", now, "--quiet");
    struct command command = run_hifdm("diff", now, old, "--rtol", "1e-6", "--atol", "1e-9");
    ck_assert_msg(command.exit_code <= 1 && !strstr(command.out, "/form/"), "%s%s", command.out, command.err);
    free_command(&command);
}
END_TEST

Suite *suite_cli_versions(void)
{
    Suite *suite = suite_create("cli/versions");
    TCase *tests = tcase_create("versions");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, results_of_0_1_0_are_shown_and_exported);
    tcase_add_test(tests, results_of_0_1_0_are_compared);
    return suite;
}
