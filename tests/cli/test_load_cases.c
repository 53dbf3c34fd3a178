/* `load_cases`: named states of the net as built, from the case file to the summary, JSON, the result file, the exports
 * and the report. tests/unit/case/test_config_load_cases.c has the faults of rows, tests/verify/test_load_cases.c the
 * figures. */
#include "cli.h"

#define EXAMPLE keep(source_path("configs/paraboloid-load-cases.yaml"))

static const char *run_example(void)
{
    const char *out = temp("e.h5");
    HIFDM(0, "run", EXAMPLE, "-o", out);
    return out;
}

START_TEST(load_cases_are_printed_stored_and_shown)
{
    const char *out = run_example(), *again = temp("again.h5");
    ERR("warning: load_cases: in load case 'cold', ");
    HIFDM(0, "show", out, "--verbose");
    OUT("  load cases    as-built net        psi mm displacement mm refocused     fixed    min N     max N slack loose "
        "member N\n");
    OUT("gain loss in dB at 10 GHz for a refocused feed and for a fixed feed (physical optics)\n");
    OUT("psi leaves out the loose nodes; the other columns include them where they hang\n");
    EXPECT(out, out_as("s.txt"), "--",
           "all([r.split() for r in b.decode().splitlines() if r.split()[:1] == [n]][0][3:5] == ['%.4g' % "
           "a['load_cases'][n]['surface'][feed + '_gain_loss_dB'][1] for feed in ('refocused', 'fixed')] for n in "
           "texts(a['load_cases/name']))");
    OUT("\n                cold      ");
    HIFDM(0, "show", out, "--json");
    EXPECT(out_as("s.json"), out, "--", "list(a['load_cases']) == ['cold', 'sun', 'cup_up', 'cup_down', 'spun']",
           "texts(b['load_cases/name']) == list(a['load_cases'])",
           "all(c['status'] == 'ok' for c in a['load_cases'].values())",
           "all(c['psi_m'] == b['load_cases/' + n].attrs['psi_m'] for n, c in a['load_cases'].items())",
           "a['load_cases']['cold']['slack_cables'] > 0 and a['load_cases']['spun']['slack_cables'] == 0",
           "all(c['tension_min_N'] == min(b[f'load_cases/{n}/tension_N']) for n, c in a['load_cases'].items())",
           "all(c['surface']['n_facet'] == a['form']['surface']['n_facet'] for c in a['load_cases'].values())",
           /* with nothing else than a force across, the truss carries the sum of it */
           "near(sum(b['load_cases/spun/truss/node/reaction'][:, 0]), "
           "-0.01 * sum(b['scene/node/role'][:] == 1), 1e-6)",
           "b['load_cases/spun/truss/node/displacement'].shape == b['truss/node/displacement'].shape");
    /* weights are carried by the truss, either way round */
    EXPECT(out, "--",
           "near(sum(a['load_cases/cup_up/truss/node/reaction'][:, 2]), 9.81 * a['truss'].attrs['mass_kg'] + "
           "9.81 * 0.002 * len(a['scene/node/role']) + 9.81 * sum(a['form/length_m'][:] / (1 + "
           "a['form/tension_N'][:] / 8e4) * np.where(np.isin(np.arange(len(a['form/length_m'])), "
           "a['scene/set/cable'][a['scene/set/start'][4]:]), 0.0005, 0.0015)), 1e-4)",
           "near(sum(a['load_cases/cup_down/truss/node/reaction'][:, 2]), "
           "-sum(a['load_cases/cup_up/truss/node/reaction'][:, 2]), "
           "1e-6)",
           "texts(a['scene/set/name'])[4] == 'tie'");
    HIFDM(0, "run", EXAMPLE, "-o", again, "--quiet", "--threads", "2");
    HIFDM(0, "diff", out, again);
    HIFDM(0, "run", EXAMPLE, "-o", out, "--quiet");
    ERR("is the finished result of this case");
    HIFDM(0, "check", EXAMPLE);
    OUT("5 load cases of the as-built net: cold, sun, cup_up, cup_down, spun\n");
}
END_TEST

START_TEST(a_load_case_is_exported)
{
    const char *out = run_example(), *csv = temp("csv"), *vtk = temp("vtk");
    HIFDM(0, "export", out, "--csv", csv, "--load-case", "sun");
    OUT("cables of the sun shape in ");
    EXPECT(out, keep(formatted("%s/cables.csv", csv)), keep(formatted("%s/members.csv", csv)), "--",
           "[float(r['tension_N']) for r in b] == list(a['load_cases/sun/tension_N'])",
           "[float(r['Nx_i_N']) for r in c] == list(a['load_cases/sun/truss/member/end_force'][:, 0])");
    HIFDM(0, "export", out, "--vtk", vtk);
    OUT("load_case_1.hdf (cold) load_case_2.hdf (sun) load_case_3.hdf (cup_up) load_case_4.hdf (cup_down) "
        "load_case_5.hdf (spun)\n");
    SHELL(0,
          "cd \"$1\" && for k in 1 2 3 4 5; do mv load_case_$k.hdf load_case_$k.h5; test -e load_case_facets_$k.hdf || "
          "exit 1; mv load_case_truss_$k.hdf load_case_truss_$k.h5 || exit 1; done",
          vtk);
    EXPECT(out, keep(formatted("%s/load_case_2.h5", vtk)), keep(formatted("%s/load_case_truss_2.h5", vtk)), "--",
           "np.array_equal(a['load_cases/sun/position_m'], b['VTKHDF/Points'])",
           "np.array_equal(a['load_cases/sun/tension_N'], b['VTKHDF/CellData/tension_N'])",
           "np.array_equal(-a['load_cases/sun/truss/member/end_force'][:, 0], c['VTKHDF/CellData/axial_force_N'])");
    HIFDM(2, "export", out, "--csv", temp("no"), "--load-case", "moon");
    ERRS("error: %s: this result has no load case 'moon'. The load cases of this result are cold, sun, cup_up, "
         "cup_down, spun\n",
         out);
    HIFDM(2, "export", out, "--csv", temp("no"), "--load-case", "sun", "--stage", "form");
    HIFDM(2, "export", out, "--cutlist", temp("no.csv"), "--load-case", "sun");
    ERR("error: the option --load-case cannot be combined with --cutlist, because that option exports the design that "
        "all load cases share\n");
    ck_assert(!is_there(temp("no")) && !is_there(temp("no.csv")));
    HIFDM(0, "report", out, "-o", temp("page.html"));
    SHELL(0, "grep -c '\"stage\":\"load case ' \"$1\"", temp("page.html"));
    ck_assert_str_eq(said.out, "5\n");
}
END_TEST

/* Goals over states of a net on a truss are the errors that the states have in the same file. */
START_TEST(objectives_over_load_cases_are_those_of_the_load_cases)
{
    HIFDM(0, "run", keep(source_path("configs/paraboloid-load-cases.yaml")), "-o", temp("goals.h5"), "--quiet", "--set",
          "optimize.objective=[{figure: psi, load_case: all, take: worst}, {figure: psi, load_case: sun}, {figure: "
          "psi, load_case: cup_up}]",
          "--set", "optimize.method=lm", "--set", "optimize.refine_steps=1", "--set",
          "optimize.variables=[{set: all, vary: force_density, range: 1 %}]", "--set", "requirements=[]");
    EXPECT(temp("goals.h5"), "--", "a['refine'].attrs['is_result'] == 1",
           "near(a['objective/refine'][0], max(s.attrs['psi_m'] for s in a['load_cases'].values() if hasattr(s, "
           "'keys')), 1e-6)",
           "near(a['objective/refine'][1], a['load_cases/sun'].attrs['psi_m'], 1e-6)",
           "near(a['objective/refine'][2], a['load_cases/cup_up'].attrs['psi_m'], 1e-6)");
}
END_TEST

/* A table of nodes belongs to the run as much as the case does. */
START_TEST(another_table_is_another_run)
{
    const char *c = file_with("c.yaml", SMALL_SCENE "  EA_inner_N: 1e5\n  EA_boundary_N: 1e5\nload_cases:\n"
                                                    "  - {name: pulled, nodes: n.csv}\n");
    file_with("n.csv", "id,Fz_N\nn1_1,0.01\n");
    HIFDM(0, "run", c, "-o", temp("a.h5"), "--quiet");
    file_with("n.csv", "id,Fz_N\nn1_1,0.02\n");
    HIFDM(5, "run", c, "-o", temp("a.h5"), "--quiet");
    ERR("exists");
    HIFDM(5, "run", c, "-o", temp("n.csv"), "--restart");
    ERR("this file is an input of this run. Choose another name\n");
    HIFDM(0, "run", c, "-o", temp("b.h5"), "--quiet");
    EXPECT(temp("a.h5"), temp("b.h5"), "--",
           "1.9 < b['load_cases/pulled'].attrs['displacement_rms_m'] / "
           "a['load_cases/pulled'].attrs['displacement_rms_m'] < 2.1");
}
END_TEST

/* Of the design that the run found, not of the form-finding before it. */
START_TEST(the_optimised_design_is_built)
{
    const char *c =
        file_with("c.yaml", SMALL_SCENE "  EA_inner_N: 1e5\n  EA_boundary_N: 1e5\n" SMALL_GA
                                        "load_cases:\n  - {name: still, support_displacement_m: [0, 0, 0]}\n");
    const char *of[][2] = {{"ga", "search"}, {"ga+lm", "refine"}};
    for (int k = 0; k < 2; k++) {
        const char *out = temp(k ? "b.h5" : "a.h5");
        HIFDM(0, "run", c, "-o", out, "--quiet", "--set", keep(formatted("optimize.method=%s", of[k][0])), "--set",
              "optimize.refine=false");
        EXPECT(out, "--",
               keep(formatted("np.abs(a['load_cases/still/position_m'][:] - a['%s/position_m'][:]).max() < 1e-8",
                              of[k][1])),
               "np.abs(a['load_cases/still/position_m'][:] - a['form/position_m'][:]).max() > 1e-6");
    }
}
END_TEST

/* Its own weight bends this ring by decimetres, and the net with it. With supports held there, tensions are thousands
 * of newtons, and the loop of net and truss leads away from any shape; one matrix finds it. */
START_TEST(a_truss_may_bend_by_its_weight)
{
    const char *c =
        file_with("c.yaml", "scene:\n"
                            "  paraboloid: {aperture_m: 8, focal_length_m: 6, rings: 6, rear_distance_m: 2}\n"
                            "  EA_inner_N: 1e5\n"
                            "  EA_boundary_N: 1e5\n"
                            "form: {pretension_N: 10, prestress: exact}\n"
                            "truss: {ring: {height_m: 2}}\n"
                            "cables: [{mass_kg_per_m: 0.001}]\n"
                            "load_cases:\n"
                            "  - {name: ground, gravity_m_per_s2: 9.81}\n"
                            "  - {name: light, gravity_m_per_s2: 0.00981}\n");
    HIFDM(0, "run", c, "-o", temp("a.h5"), "--quiet");
    EXPECT(temp("a.h5"), "--", "a['load_cases/ground'].attrs['n_slack'] > 0",
           "0.1 < a['load_cases/ground'].attrs['displacement_rms_m'] < 0.3",
           "a['load_cases/ground'].attrs['residual_N'] < 1e-5",
           "near(a['load_cases/light'].attrs['displacement_rms_m'], 6.3e-5, 2e-6)");
}
END_TEST

/* A state without a shape is a warning: others have one. */
START_TEST(a_load_case_without_a_shape_does_not_stop_the_others)
{
    const char *c =
        file_with("c.yaml", SMALL_SCENE
                  "  EA_inner_N: 1e5\n  EA_boundary_N: 1e5\nform: {method: fdm, "
                  "max_iterations: 20}\nload_cases:\n  - {name: far, support_displacement_m: [0, 0, 0], force_N: [1e4, "
                  "1e4, 1e5]}\n  - {name: still, support_displacement_m: [0, 0, 0]}\n");
    HIFDM(0, "run", c, "-o", temp("a.h5"));
    OUT("                far              no shape: ");
    ERR("warning: load_cases: no equilibrium was found in load case 'far': ");
    HIFDM(0, "show", temp("a.h5"), "--json");
    EXPECT(out_as("s.json"), temp("a.h5"), "--", "a['load_cases']['far']['tension_min_N'] is None",
           "'position_m' not in b['load_cases/far']", "a['load_cases']['still']['status'] == 'ok'");
    HIFDM(5, "export", temp("a.h5"), "--csv", temp("csv"), "--load-case", "far");
    ERR("this result has no shape of the load case 'far'\n");
    HIFDM(0, "export", temp("a.h5"), "--vtk", temp("vtk"));
    OUT(" load_case_2.hdf (still)\n");
    HIFDM(0, "report", temp("a.h5"), "-o", temp("page.html"));
}
END_TEST

/* So cold that every cable hangs slack: where its nodes are says nothing of a surface. */
START_TEST(a_net_that_hangs_loose_has_no_surface)
{
    const char *out = temp("loose.h5");
    HIFDM(0, "check", EXAMPLE, "--set", "load_cases.0.temperature_K=293");
    ERR("load_cases.0.temperature_K: 293 K is the rise from the temperature at which the cables were cut.");
    HIFDM(0, "check", EXAMPLE, "--set", "load_cases.0.temperature_K=-400");
    ERR("load_cases.0.temperature_K: -400 K is the rise from the temperature at which the cables were cut. Cables cut "
        "at "
        "20 degC would be below absolute zero\n");
    HIFDM(0, "check", EXAMPLE, "--set", "load_cases.0.temperature_K=200");
    ck_assert_ptr_null(strstr(said.err, " is the rise from "));
    HIFDM(0, "run", EXAMPLE, "-o", out, "--set", "load_cases.0.temperature_K=-600", "--set",
          "load_cases.1.temperature_K=-600");
    HIFDM(0, "show", out, "--verbose");
    EXPECT(out, out_as("s.txt"), "--", "a['load_cases/cold'].attrs['n_loose'] == a['form'].attrs['n_free']",
           "all(np.isnan(a['load_cases/cold/surface'].attrs[n]) for n in ('half_path_rms_m', 'fit_half_path_rms_m', "
           "'facet_half_path_rms_m', 'facet_fit_half_path_rms_m'))",
           "np.isnan(a['load_cases/cold/surface/fit_gain_loss_dB'][:]).all()",
           "[[r.split()[k] for k in (1, 3, 4)] for r in b.decode().splitlines() if r.split()[:1] == ['cold']] == "
           "[['-'] * 3]");
}
END_TEST

START_TEST(without_cases_there_is_nothing)
{
    const char *c = file_with("c.yaml", SMALL_SCENE);
    HIFDM(0, "run", c, "-o", temp("a.h5"), "--json");
    EXPECT(out_as("s.json"), temp("a.h5"), "--", "'load_cases' not in a", "'load_cases' not in b");
    HIFDM(2, "export", temp("a.h5"), "--csv", temp("no"), "--load-case", "cold");
    ERR("this run has no load cases\n");
    HIFDM(0, "check", c);
    OUT("load_cases (none given); ");
}
END_TEST

Suite *suite_cli_load_cases(void)
{
    Suite *suite = suite_create("cli/load_cases");
    TCase *tcase = tcase_create("cases");
    tcase_add_test(tcase, load_cases_are_printed_stored_and_shown);
    tcase_add_test(tcase, a_load_case_is_exported);
    tcase_add_test(tcase, another_table_is_another_run);
    tcase_add_test(tcase, objectives_over_load_cases_are_those_of_the_load_cases);
    tcase_add_test(tcase, the_optimised_design_is_built);
    tcase_add_test(tcase, a_truss_may_bend_by_its_weight);
    tcase_add_test(tcase, a_load_case_without_a_shape_does_not_stop_the_others);
    tcase_add_test(tcase, a_net_that_hangs_loose_has_no_surface);
    tcase_add_test(tcase, without_cases_there_is_nothing);
    suite_add_tcase(suite, tcase);
    return suite;
}
