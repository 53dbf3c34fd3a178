/* Result files of earlier versions are read: by show, export, report and diff. old_result.py makes them from text. */
#include "cli.h"

static const char *result_of(const char *version, const char *name)
{
    const char *path = temp(name);
    const char *const argv[] = {python_program(),
                                keep(source_path("tests/cli/old_result.py")),
                                "file",
                                keep(source_path(keep(formatted("tests/cli/data/result-%s.json", version)))),
                                path,
                                NULL};
    demand_exit(run_command(HANG_S, argv), 0, "old_result.py", __LINE__);
    return path;
}

static const char *old_result(const char *name)
{
    return result_of("0.1.0", name);
}

START_TEST(results_of_0_1_0_are_shown_and_exported)
{
    const char *old = old_result("old.h5"), *csv = temp("csv"), *vtk = temp("vtk"), *cuts = temp("cuts.csv");
    HIFDM(0, "show", old);
    OUT("a small dish with every group that a file can have\n");
    OUT("cold ");
    HIFDM(0, "show", old, "--json");
    EXPECT(out_as("s.json"), old, "--", "a['form']['psi_m'] == b['form'].attrs['psi_m'] > 0",
           "a['search']['psi_m'] == b['ga'].attrs['best_psi_m']", "a['refine']['psi_m'] == b['polish'].attrs['psi_m']",
           "a['truss']['mass_kg'] == b['truss'].attrs['mass_kg']",
           "a['load_cases']['cold']['slack_cables'] == b['cases/cold'].attrs['n_slack'] == 13",
           "a['form']['surface']['half_path_rms_m'] == b['surface/form'].attrs['half_path_rms_m']",
           "a['tolerance']['samples'] == len(b['tolerance/sample/psi_m']) == 12");
    HIFDM(0, "export", old, "--csv", csv);
    HIFDM(0, "export", old, "--vtk", vtk);
    OUT(": target.hdf target_facets.hdf form.hdf form_facets.hdf search.hdf search_facets.hdf refine.hdf "
        "refine_facets.hdf truss.hdf load_case_1.hdf (cold)\n"); /* the net has one ring: since 0.2.0 it has facets */
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

/* Writes the case that a result contains. */
static const char *case_of(const char *result)
{
    const char *path = temp("stored.yaml");
    SHELL(0,
          "\"$1\" -c 'import h5py, sys; open(sys.argv[2], \"wb\").write(h5py.File(sys.argv[1])[\"case/text\"][()])' "
          "\"$2\" \"$3\"",
          python_program(), result, path);
    return path;
}

/* The names differ in all parts of the file: variables, search, refinement, load cases, objectives, samples. Of the
 * search, the last generation differs, because the genetic algorithm has other crossovers and mutations. */
START_TEST(results_of_0_2_0_are_read_by_their_own_names)
{
    const char *old = result_of("0.2.0", "old.h5"), *now = temp("now.h5");
    HIFDM(0, "run", case_of(old), "-o", now, "--quiet");
    struct command command = run_hifdm("diff", now, old, "--rtol", "1e-6", "--atol", "1e-9");
    ck_assert_msg(
        command.exit_code == 1 && strstr(command.out, "235 data sets, 36 differ") &&
            strstr(command.out, "/search/population/design has other dimensions") &&
            strstr(command.out, "/search/population/design_row is not in ") &&
            strstr(command.out, "/refine_state is not in ") && count_of(command.out, "/search/population/") == 7 &&
            count_of(command.out, "/requirements/") == 22 && count_of(command.out, "/tolerance/require_") == 4,
        "%s%s", command.out, command.err);
    free_command(&command);
    HIFDM(0, "show", old, "--json");
    const char *a = out_as("a.json");
    HIFDM(0, "show", now, "--json");
    const char *b = out_as("b.json");
    EXPECT(a, b, "--",
           "set(b) - set(a) == {'requirements', 'verdict'} and all(set(a[k]) == set(b[k]) for k in a if "
           "isinstance(a[k], dict))",
           "close(a['search']['psi_m'], b['search']['psi_m']) and a['search']['generations'] == 3",
           "close(a['refine']['objectives']['objective_1_tension_front_edge']['value'], "
           "b['refine']['objectives']['objective_1_tension_front_edge']['value'])",
           "a['refine']['steps'] == b['refine']['steps'] == 2 and a['refine']['is_result']",
           "close(a['load_cases']['cold']['member_force_max_N'], b['load_cases']['cold']['member_force_max_N'])",
           "close(a['refine']['sets']['tie']['min_N'], b['refine']['sets']['tie']['min_N'])",
           "a['tolerance']['yield'] == b['tolerance']['yield'] > 0 and a['coupling']['stop_reason'] == 'converged'");
    HIFDM(0, "report", old, "-o", temp("old.html"));
    HIFDM(0, "export", old, "--csv", temp("csv"), "--stage", "search");
}
END_TEST

/* Programs for files of 0.2 find every data set and attribute that they read, by links and copies, except the rows of
 * tolerance.require, which /requirements replaces, and the designs of the population, which have other dimensions. */
START_TEST(new_results_hold_the_names_of_0_2)
{
    const char *old = result_of("0.2.0", "old.h5"), *now = temp("now.h5");
    HIFDM(0, "run", case_of(old), "-o", now, "--quiet");
    EXPECT(old, now, "--",
           "all(n.startswith(('tolerance/require_', 'ga/design')) or n.endswith('_yield') "
           "for n in missing_names(a, b))",
           "b.get('ga/best/position_m', getlink=True).path == '/search/position_m'",
           "(b['ga/best/position_m'][:] == b['search/position_m'][:]).all()",
           "b['ga'].attrs['best_psi_m'] == b['search'].attrs['psi_m']",
           "b['ga'].attrs['optimize_stop'] == b['search'].attrs['algorithm_stop']",
           "b['polish'].attrs['polish_iterations'] == b['refine'].attrs['steps'] == 2",
           "(b['cases/cold/tension_N'][:] == b['load_cases/cold/tension_N'][:]).all()",
           "b['search'].attrs['algorithm'] == b'ga' and b['refine'].attrs['algorithm'] == b'lm'");
}
END_TEST

Suite *suite_cli_versions(void)
{
    Suite *suite = suite_create("cli/versions");
    TCase *tests = tcase_create("versions");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, results_of_0_1_0_are_shown_and_exported);
    tcase_add_test(tests, results_of_0_1_0_are_compared);
    tcase_add_test(tests, results_of_0_2_0_are_read_by_their_own_names);
    tcase_add_test(tests, new_results_hold_the_names_of_0_2);
    return suite;
}
