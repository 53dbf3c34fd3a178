/* Runs of a net on its truss: what is printed and stored, that threads change nothing, and the messages of failures. */
#include "cli.h"

#include <hifdm/config.h>

#include <hdf5.h>

#define TRUSS keep(source_path("configs/straight-edges-truss.yaml"))

/* Supports of the stored shape are where the truss of the same file goes under their pull; 1e-8 m is tof_m. */
START_TEST(run_show_and_file)
{
    const char *out = temp("t.h5");
    HIFDM(0, "run", TRUSS, "-o", out, "--set", "truss.E_Pa=1e10");
    OUT("  coupling      the truss deflects by up to ");
    OUT("; converged after ");
    HIFDM(0, "show", out);
    OUT("  coupling      the truss deflects by up to ");
    HIFDM(0, "show", out, "--json");
    EXPECT(
        out_as("s.json"), out, "--", "a['coupling']['stop_reason'] == 'converged'", "a['coupling']['step_m'] <= 1e-8",
        "a['coupling']['iterations'] == len(b['coupling/history/step_m']) > 1",
        "b['coupling/history/psi_m'][-1] == a['form']['psi_m']", "b['coupling/history/deflection_max_m'][0] == 0",
        "(b['coupling/node'][:] == b['truss/attachment/net_node'][:]).all()",
        "abs(np.linalg.norm(b['coupling/displacement_m'][:], axis=1).max() - a['coupling']['deflection_max_m']) "
        "< 1e-15 and a['coupling']['deflection_max_m'] > 1e-4",
        "abs(b['form/position_m'][:][b['coupling/node'][:]] - b['scene/node/position_m'][:][b['coupling/node'][:]] - "
        "b['coupling/displacement_m'][:]).max() < 1e-14",
        "abs(b['truss/node/displacement'][:][b['truss/attachment/truss_node'][:], :3] - "
        "b['coupling/displacement_m'][:]).max() < 1e-8");
}
END_TEST

/* A data set of doubles, for the caller to free; *n numbers. */
static double *read_doubles(hid_t file, const char *name, int *n)
{
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
    *n = (int)H5Sget_simple_extent_npoints(space);
    double *value = malloc((size_t)*n * sizeof *value);
    ck_assert_ptr_nonnull(value);
    ck_assert_int_ge(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, value), 0);
    H5Sclose(space);
    H5Dclose(set);
    return value;
}

/* The pull that the file stores, solved once more by the frame of the same case. */
static void load_stored_pull(const char *path, const char *const *overrides, int n_override, hid_t file)
{
    hf_messages messages = {0};
    hf_case settings;
    hf_scene scene;
    hf_carrier carrier;
    hf_carrier_state state;
    ck_assert_int_eq(hf_config_load(path, overrides, n_override, &settings, &messages), HF_OK);
    ck_assert_int_eq(hf_config_scene(&settings, &scene, &messages), HF_OK);
    ck_assert_int_eq(hf_config_carrier(&settings, &scene, &carrier, &messages), HF_OK);
    int n_force, n_stored;
    double *force_N = read_doubles(file, "/coupling/force_N", &n_force), largest = 0;
    double *stored = read_doubles(file, "/truss/node/displacement", &n_stored);
    ck_assert_int_eq(n_force, 3 * carrier.n_attachment);
    ck_assert_int_eq(n_stored, 6 * carrier.truss.n_node);
    ck_assert_int_eq(hf_carrier_load(&carrier, force_N, NULL, &state), HF_OK);
    for (int k = 0; k < n_stored; k++)
        largest = fmax(largest, fabs(state.displacement[k]));
    for (int k = 0; k < n_stored; k++)
        ck_assert_double_eq_tol(stored[k], state.displacement[k], 1e-12 * largest);
    free(stored);
    free(force_N);
    hf_carrier_state_free(&state);
    hf_carrier_free(&carrier);
    hf_scene_free(&scene);
    hf_case_free(&settings);
    hf_messages_free(&messages);
}

/* /truss held against /coupling, for a net in equilibrium: the pull is that of the cables of /form, /truss is what the
 * frame does under it, and the attachments are there. Attachments are displaced by r when the pull f is found; F f - r
 * is the last step, which is what tof_m bounds: 1e-11 m, where a pull 0.1 % too large moves them by 8e-7 m more. The
 * tensions stored are those of the last solve, within residual_tolerance 1e-9 of the law's, of cables at 10 N. */
START_TEST(the_stored_truss_stands_under_the_stored_pull)
{
    static const char *const set[] = {"truss.E_Pa=1e10", "form.stop=residual", "coupling.tof_m=1e-11",
                                      "scene.parabolic_cylinder.boundary=outer_edge",
                                      "scene.parabolic_cylinder.scallop=0.1"};
    const char *out = temp("t.h5");
    HIFDM(0, "run", TRUSS, "-o", out, "--set", set[0], "--set", set[1], "--set", set[2], "--set", set[3], "--set",
          set[4]);
    EXPECT(out_as("said.txt"), out, "--",
           "('deflects by up to %.4f mm' % (b['coupling'].attrs['deflection_max_m'] * 1e3)).encode() in a");
    hid_t file = H5Fopen(out, H5F_ACC_RDONLY, H5P_DEFAULT);
    ck_assert_int_ge(file, 0);
    load_stored_pull(TRUSS, set, 5, file);
    H5Fclose(file);
    EXPECT(out, "--", "a['coupling'].attrs['step_m'] <= 1e-11",
           "abs(a['truss/node/displacement'][:][a['truss/attachment/truss_node'][:], :3] - "
           "a['coupling/displacement_m'][:]).max() <= 1e-11 < 1e-4 * a['coupling'].attrs['deflection_max_m']",
           /* sum over the cables at each attachment of T times the unit vector away from it */
           "abs(sum(np.where((a['scene/cable/end'][:, k] == a['coupling/node'][:][:, None])[:, :, None], "
           "((1 - 2 * k) * a['form/tension_N'][:] / a['form/length_m'][:])[:, None] * "
           "(a['form/position_m'][:][a['scene/cable/end'][:, 1]] - "
           "a['form/position_m'][:][a['scene/cable/end'][:, 0]]), 0).sum(axis=1) for k in (0, 1)) - "
           "a['coupling/force_N'][:]).max() < 1e-7");
}
END_TEST

/* The genetic algorithm and Levenberg-Marquardt on a truss, for any number of threads. */
START_TEST(data_sets_do_not_depend_on_the_number_of_threads)
{
    const char *file[3], *threads[] = {"1", "2", "7"};
    for (int k = 0; k < 3; k++) {
        file[k] = temp(formatted("%s.h5", threads[k]));
        HIFDM(0, "run", TRUSS, "-o", file[k], "--threads", threads[k], "--quiet", "--set", "truss.E_Pa=1e10", "--set",
              "optimize.generations=15", "--set", "optimize.refine_steps=3");
    }
    EXPECT(file[0], file[1], file[2], "--", "differing(a, b) == []", "differing(a, c) == []",
           "a['search'].attrs['solver'] == 1", /* chord */
           "a['search'].attrs['coupling_deflection_max_m'] > 1e-4", "a['refine'].attrs['coupling_step_m'] <= 1e-6",
           "abs(a['search/position_m'][:] - a['scene/node/position_m'][:])[a['coupling/node'][:]].max() > 1e-4",
           "a['search'].attrs['psi_m'] < a['search'].attrs['initial_psi_m']");
}
END_TEST

/* Tubes so soft that the coupling diverges. */
START_TEST(a_truss_that_is_too_soft_is_named)
{
    HIFDM(4, "run", TRUSS, NOWHERE, "--set", "truss.E_Pa=1e5");
    ERR("error: the truss is too soft for the coupling with its net. After ");
    ERR(" an attachment still moves without bound. Stiffen the truss (truss.E_Pa and its tubes), lower "
        "form.pretension_N, or solve both in one matrix: coupling.scheme: auto, form.method: newton");
    HIFDM(4, "run", TRUSS, NOWHERE, "--set", "truss.E_Pa=1e5", "--set", "form.method=newton");
    ERR("error: the truss is too soft for its net, so net and truss together have no equilibrium. Stiffen the truss "
        "(truss.E_Pa and its tubes) or lower form.pretension_N");
    ck_assert(!is_there(temp("nowhere.h5")));
}
END_TEST

START_TEST(limits_and_keys)
{
    const char *out = temp("t.h5");
    HIFDM(3, "run", TRUSS, "-o", out, "--set", "truss.E_Pa=1e10", "--set", "coupling.max_iterations=2", "--set",
          "coupling.tof_m=1e-9");
    ERR("the coupling of net and truss did not converge in 2 form-findings");
    ERR(" times the previous step. Raise ");
    HIFDM(3, "run", TRUSS, NOWHERE, "--set", "truss.E_Pa=1e10", "--set", "coupling.max_iterations=1", "--set",
          "coupling.tof_m=1e-9");
    ck_assert_msg(!strstr(said.err, "nan") && strstr(said.err, " m. Raise "), "%s", said.err); /* no step before it */
    HIFDM(0, "check", TRUSS, "--set", "coupling.tof_m=1e-3");
    OUT("coupling with the truss: accelerated, tof 0.001 m, at most 200 form-findings\n");
    HIFDM(0, "check", TRUSS, "--set", "form.method=auto", "--set", "form.stop=residual", "--set",
          "scene.parabolic_cylinder.boundary=outer_edge", "--set", "scene.parabolic_cylinder.scallop=0.1");
    OUT("tof 1e-08 m, at most 200 form-findings; in one matrix where they are slow\n");
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
    tcase_add_test(tests, the_stored_truss_stands_under_the_stored_pull);
    tcase_add_test(tests, data_sets_do_not_depend_on_the_number_of_threads);
    tcase_add_test(tests, a_truss_that_is_too_soft_is_named);
    tcase_add_test(tests, limits_and_keys);
    return suite;
}
