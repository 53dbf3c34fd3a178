/* The net on its truss as a user runs it: what is printed and stored, threads, and what goes wrong. */
#include "cli.h"

#define TRUSS keep(source_path("configs/chen2022-truss.yaml"))

/* Supports of the stored shape are where the truss of the same file goes under their pull; 1e-6 m is tof_m. */
START_TEST(run_show_and_file)
{
    const char *out = temp("t.h5");
    HIFDM(0, "run", TRUSS, "-o", out, "--set", "truss.E_Pa=1e10");
    OUT("  on its truss  attachments give way by up to ");
    OUT("stopped by tof\n");
    HIFDM(0, "show", out);
    OUT("  on its truss  attachments give way by up to ");
    HIFDM(0, "show", out, "--json");
    EXPECT(
        out_as("s.json"), out, "--", "a['coupling']['stop_reason'] == 'tof'", "a['coupling']['step_m'] <= 1e-6",
        "a['coupling']['iterations'] == len(b['coupling/history/step_m']) > 1",
        "b['coupling/history/psi_m'][-1] == a['form']['psi_m']", "b['coupling/history/max_displacement_m'][0] == 0",
        "(b['coupling/node'][:] == b['truss/attachment/net_node'][:]).all()",
        "abs(np.linalg.norm(b['coupling/displacement_m'][:], axis=1).max() - a['coupling']['max_displacement_m']) "
        "< 1e-15 and a['coupling']['max_displacement_m'] > 1e-4",
        "abs(b['form/position_m'][:][b['coupling/node'][:]] - b['scene/node/position_m'][:][b['coupling/node'][:]] - "
        "b['coupling/displacement_m'][:]).max() < 1e-14",
        "abs(b['truss/node/displacement'][:][b['truss/attachment/truss_node'][:], :3] - "
        "b['coupling/displacement_m'][:]).max() < 1e-6");
}
END_TEST

/* The genetic algorithm and Levenberg-Marquardt on a truss, for any number of threads. */
START_TEST(data_sets_do_not_depend_on_the_number_of_threads)
{
    const char *file[3], *threads[] = {"1", "2", "7"};
    for (int k = 0; k < 3; k++) {
        file[k] = temp(formatted("%s.h5", threads[k]));
        HIFDM(0, "run", TRUSS, "-o", file[k], "--threads", threads[k], "--quiet", "--set", "truss.E_Pa=1e10", "--set",
              "optimize.generations=15", "--set", "optimize.polish_iterations=3");
    }
    EXPECT(file[0], file[1], file[2], "--", "differing(a, b) == []", "differing(a, c) == []",
           "a['ga'].attrs['solver'] == 1", /* chord */
           "a['ga'].attrs['best_coupling_max_displacement_m'] > 1e-4", "a['polish'].attrs['coupling_step_m'] <= 1e-6",
           "abs(a['ga/best/position_m'][:] - a['scene/node/position_m'][:])[a['coupling/node'][:]].max() > 1e-4",
           "a['ga'].attrs['best_psi_m'] < a['ga'].attrs['base_psi_m']");
}
END_TEST

/* Tubes of jelly. */
START_TEST(a_truss_that_is_too_soft_is_named)
{
    HIFDM(4, "run", TRUSS, NOWHERE, "--set", "truss.E_Pa=1e5", "--set", "coupling.scheme=plain");
    ERR("error: the truss is too soft for the pretension of its net: after ");
    ERR("try coupling.scheme: accelerated");
    HIFDM(4, "run", TRUSS, NOWHERE, "--set", "truss.E_Pa=1e5");
    ERR("error: the truss is too soft for the pretension of its net: after ");
    ERR(" an attachment would still move beyond all bounds; stiffen the truss");
    ck_assert(!is_there(temp("nowhere.h5")));
}
END_TEST

START_TEST(limits_and_keys)
{
    const char *out = temp("t.h5");
    HIFDM(3, "run", TRUSS, "-o", out, "--set", "truss.E_Pa=1e10", "--set", "coupling.max_iterations=2", "--set",
          "coupling.tof_m=1e-9");
    ERR("the net and its truss did not come to rest in 2 form-findings");
    ERR(" times the step before; raise ");
    HIFDM(3, "run", TRUSS, NOWHERE, "--set", "truss.E_Pa=1e10", "--set", "coupling.max_iterations=1", "--set",
          "coupling.tof_m=1e-9");
    ck_assert_msg(!strstr(said.err, "nan") && strstr(said.err, " m; raise "), "%s", said.err); /* no step before it */
    HIFDM(0, "check", TRUSS, "--set", "coupling.tof_m=1e-3");
    OUT("coupling with the truss: accelerated, tof 0.001 m, at most 200 form-findings\n");
    HIFDM(2, "check", TRUSS, "--set", "coupling.tof_m=0");
    ERR("coupling.tof_m: must be above 0");
    HIFDM(2, "check", TRUSS, "--set", "coupling.scheme=fast");
    ERR("coupling.scheme: ");
    const char *path = file_with("c.yaml", SMALL_SCENE "coupling: {tof_m: 1e-9}\n");
    HIFDM(0, "run", path, "-o", temp("c.h5"), "--json");
    EXPECT(out_as("s.json"), temp("c.h5"), "--", "'coupling' not in a", "'coupling' not in b");
}
END_TEST

Suite *suite_cli_coupling(void)
{
    Suite *suite = suite_create("cli/coupling");
    TCase *tests = tcase_create("coupling");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, run_show_and_file);
    tcase_add_test(tests, data_sets_do_not_depend_on_the_number_of_threads);
    tcase_add_test(tests, a_truss_that_is_too_soft_is_named);
    tcase_add_test(tests, limits_and_keys);
    return suite;
}
