/* Commands that write no file: `check`, `schema`, `help`, `version`, and `show` of files that are no results. */
#include "cli.h"

START_TEST(check_tells_what_will_run)
{
    HIFDM(0, "check", CHEN, "--threads", "2");
    ERR("warning: the stopping rule rms_change ended the iteration before equilibrium"); /* what the run will warn of */
    OUT("straight-edges.yaml: valid\n");
    OUT("121 nodes: 36 supports, 25 inner (psi counts these), 60 edge\n");
    OUT("220 cables by law in force: 100 tension, 120 length, 0 force density\n");
    OUT("85 unknowns, three right-hand sides; half-bandwidth 12; band Cholesky\n");
    OUT("note          30 straight chains of length-controlled cables\n");
    OUT("will run      form-finding: hifdm, solved by fixed point (asked for), stop: rms_change, at most 100000 "
        "iterations\n");
    OUT("optimisation: rule force_density, 120 variables, 50 individuals, at most 400 generations, seed 2022\n");
    OUT("skipped       load_cases (none given); truss (no truss section); loads (none given); general band matrix (no "
        "struts)\n");
    OUT("  memory        workspaces (2 threads)   ");
    OUT("                matrix shared by all threads           ");
    OUT("expected time form-finding: ");
    OUT("(ended by stop: rms_change after 67 iterations)\n");
    OUT("optimisation: ");
    OUT(" for a design of the first generation by chord; at most about ");
    SHELL(0, "cd \"$1\" && \"$0\" check \"$2\" && ls -A", temp("."), REFLECTOR);
    OUT("skipped       optimisation (no optimize section); load_cases (none given); truss (no truss section); loads "
        "(none "
        "given); general band "
        "matrix (no struts)\n");
    OUT("population                             none\n");
    OUT("  memory        workspace                              ");
    ck_assert_ptr_null(strstr(said.out, ".h5")); /* nothing was made */
    ck_assert_str_eq(said.err, "");
}
END_TEST

/* The method auto takes far fewer generations than the key allows, and the file holds only those. */
START_TEST(check_counts_the_generations_of_auto)
{
    const char *path = keep(source_path("configs/chen2022.yaml"));
    HIFDM(0, "check", path, "--set", "optimize.method=auto");
    OUT("50 individuals, at most 1 generation, seed 2022\n");
    OUT("result file   generations, at most                   33.1 kB\n");
    HIFDM(0, "check", path, "--set", "optimize.method=ga");
    OUT("result file   generations, at most                   13.2 MB\n");
}
END_TEST

/* The duration behind these words of the output. */
static double told_s(const char *words)
{
    static const struct {
        const char *word;
        double s;
    } unit[] = {{" us", 1e-6}, {" ms", 1e-3}, {" s", 1}, {" min ", 60}};
    const char *at = strstr(said.out, words);
    char *end;
    ck_assert_ptr_nonnull(at);
    double value = strtod(at + strlen(words), &end);
    for (size_t k = 0; k < sizeof unit / sizeof *unit; k++)
        if (!strncmp(end, unit[k].word, strlen(unit[k].word))) return value * unit[k].s;
    ck_abort_msg("no unit: %s", at);
}

/* A search for the yield measures the surface where a requirement is about it, which takes most of a sample's time. */
START_TEST(check_tells_how_long_yields_take)
{
    const char *text = "scene:\n  paraboloid: {aperture_m: 4, focal_length_m: 2.4, rings: 3, rear_distance_m: 1.2}\n"
                       "  EA_inner_N: 5000\n  EA_boundary_N: 5000\nform: {prestress: exact}\nsurface: {}\n"
                       "tolerance: {sigma_cut_m: 1e-5, find_scale: true}\n"
                       "requirements: [{figure: %s, at_most: 1e-3, share: 0.9}]\n";
    const char *words = "of 1000 nets more, most of them ended early: some ";
    HIFDM(0, "check", file_with("case.yaml", formatted(text, "surface")));
    double surface_s = told_s(words);
    HIFDM(0, "check", file_with("case.yaml", formatted(text, "psi")));
    OUT("tolerance.find_scale: up to 18 yields of 1000 nets more, most of them ended early: some ");
    double psi_s = told_s(words);
    ck_assert_double_lt(psi_s, surface_s / 2);
    HIFDM(0, "check", temp("case.yaml"), "--set", "requirements.0.at_most=1e-2"); /* nets far from their design */
    ck_assert_double_gt(told_s(words), 2 * psi_s);
}
END_TEST

/* Samples are tried at the shape of form-finding; first order of a large net is counted instead. */
START_TEST(check_tells_how_long_samples_take)
{
    const char *text = "scene:\n  paraboloid: {aperture_m: 4, focal_length_m: 2.4, rings: %d, rear_distance_m: 1.2}\n"
                       "  EA_inner_N: 5000\n  EA_boundary_N: 5000\nform: {prestress: exact}\n"
                       "tolerance:\n  sigma_cut_m: 1e-5\n  samples: 5000\n%s";
    HIFDM(0, "check", file_with("case.yaml", formatted(text, 3, "surface: {}\n")));
    OUT(" a net (the first ");
    OUT(" tried, best fits of the surface included); with first order about ");
    OUT(" for 5000 nets on ");
    HIFDM(0, "check", file_with("case.yaml", formatted(text, 3, "")));
    OUT(" tried); with first order about ");
    ck_assert_ptr_null(strstr(said.out, "tolerance.find_scale"));
    HIFDM(0, "check", file_with("case.yaml", formatted(text, 24, "")));
    OUT("as built: first order some ");
    OUT(" of processor time, counted; samples not tried\n");
}
END_TEST

/* 24 x 24 cells on 6 x 6 modules: unknowns and bandwidth grow, and so do memory and time. */
START_TEST(check_follows_the_size)
{
    HIFDM(0, "check", REFLECTOR, "--set", "scene.parabolic_cylinder.supports=perimeter", "--set",
          "scene.parabolic_cylinder.modules=[6,8]", "--set", "scene.parabolic_cylinder.cells_per_module=[4,4]", "--set",
          "form.method=iterative_fdm");
    OUT("825 nodes: 112 supports, 713 inner"); /* 25 x 33, 23 x 31 of them free */
    OUT("713 unknowns");
    OUT("half-bandwidth 24"); /* sorting has 23, but wider rows on the whole */
    OUT("form-finding: iterative_fdm");
}
END_TEST

START_TEST(check_of_an_ill_posed_case_says_so)
{
    HIFDM(4, "check", CHEN, "--set", "form.stop=residual");
    ERR("error: ill-posed: 30 straight chains");
    OUT("30 straight chains of length-controlled cables");
}
END_TEST

START_TEST(check_tells_of_struts_and_loads)
{
    const char *net = net_with("id,x_m,y_m,z_m,role,Fz_N\na,0,0,0,support,\nb,2,0,0,support,\nc,1,0,0,inner,-1\n",
                               "id,i,j,group,law,value\n1,a,c,inner,force_density,2\n2,c,b,inner,force_density,-1\n");
    HIFDM(0, "check", net);
    OUT("indefinite: band LU (dgbtrf)");
    OUT("2 force density (with struts)");
    ck_assert_ptr_null(strstr(said.out, "general band matrix (no struts)"));
    ck_assert_ptr_null(strstr(said.out, "loads (none given)"));
}
END_TEST

/* `run` skips the optimisation of a net without adjustable cables, so `check` must not announce it. */
START_TEST(check_announces_no_ga_without_genes)
{
    HIFDM(0, "check", file_with("c.yaml", SMALL_SCENE SMALL_GA), "--set",
          "scene.parabolic_cylinder.supports=perimeter");
    ck_assert_msg(!strstr(said.out, "0 variables"), "%s", said.out);
    HIFDM(0, "run", file_with("c.yaml", SMALL_SCENE SMALL_GA), "-o", temp("c.h5"), "--set",
          "scene.parabolic_cylinder.supports=perimeter");
    ERR("warning: optimize: hifdm skips the optimisation, because no boundary cable has a free end");
}
END_TEST

/* The reference is a case file itself: YAML with every key. */
START_TEST(schema_is_yaml_with_every_key)
{
    HIFDM(0, "schema");
    const char *schema = file_with("schema.yaml", said.out);
    EXPECT(
        schema, "--",
        "list(a) == ['title', 'scene', 'surface', 'form', 'optimize', 'tolerance', 'truss', 'coupling', "
        "'adjust', 'sweep', 'cables', 'nodes', 'load_cases', 'requirements']",
        "set(a['scene']) == {'parabolic_cylinder', 'paraboloid', 'import'}",
        "set(a['scene']['parabolic_cylinder']) == {'aperture_m', 'length_m', 'focal_length_m', 'modules', "
        "'cells_per_module', 'pitches_x_m', 'pitches_y_m', 'pattern', 'spacing', 'boundary', 'scallop', 'supports', "
        "'edge_tie_m', 'rear_distance_m', 'rear_focal_length_m', 'tie_direction', 'tie_law', 'tie_tension_N'}",
        "set(a['scene']['paraboloid']) == {'aperture_m', 'focal_length_m', 'offset_m', 'rings', 'grid', 'spacing', "
        "'rear_distance_m', 'rear_focal_length_m', 'tie_direction', 'tie_law', 'tie_tension_N'}",
        "set(a['scene']['import']) == {'nodes', 'cables', 'facets'}",
        "{k: v for k, v in a['surface'].items() if k != 'pattern'} == {'kind': 'auto', 'frequencies_Hz': [], "
        "'mesh_tension_N_per_m': 0}",
        "a['surface']['pattern'] == {'theta_deg': [-5, 5], 'n_theta': 721, 'phi_deg': [0, 90], 'feed': {'kind': "
        "'auto', "
        "'polarisation': 'x'}}",
        "set(a['form']) == {'method', 'pretension_N', 'prestress', 'stop', 'residual_tolerance', 'length_tolerance', "
        "'rms_tolerance_m', 'max_iterations', 'collapse_ratio', 'factor'}",
        "set(a['optimize']) == {'method', 'symmetry', 'solver', 'refine_steps', 'refine', 'rule', "
        "'population', "
        "'generations', 'range_N', 'min_tension_N', 'max_tension_N', "
        "'boundary_ratio_cap', 'seed', 'crossover_high', 'crossover_low', 'mutation_high', 'mutation_low', "
        "'variation', 'elites', 'store', 'store_every', "
        "'stagnation_tolerance_m', 'stagnation_generations', 'variables', 'objective', 'limits', "
        "'front', 'front_points', 'samples'}",
        "a['optimize']['variables'] == a['optimize']['objective'] == a['optimize']['limits'] == "
        "a['optimize']['front'] == []",
        "set(a['truss']) == {'depth_m', 'main_every', 'E_Pa', 'G_Pa', 'density_kg_per_m3', 'expansion_per_K', "
        "'hinge_mass_kg', 'theory', 'joints', 'supports', 'support_dofs', 'match_tolerance_m', 'bud', 'mbug', 'abug', "
        "'ring', 'import'}",
        "set(a['truss']['ring']) == {'cells_per_bay', 'bracing', 'held', 'held_at_deg', 'longeron', 'vertical', "
        "'diagonal'}",
        "all(set(a['truss']['ring'][u]) == {'diameter_m', 'wall_m'} for u in ('longeron', 'vertical', 'diagonal'))",
        "all(set(a['truss'][u]) == {'diameter_m', 'wall_m', 'panels', 'diagonals'} for u in ('bud', 'mbug', 'abug'))",
        "set(a['truss']['import']) == {'nodes', 'members'}",
        /* a default, or none where the key is required */
        "[k for k, v in a['scene']['parabolic_cylinder'].items() if v is None] == ['aperture_m', 'length_m', "
        "'focal_length_m', 'modules', 'cells_per_module']",
        "None not in {**a['form'], **a['optimize']}.values()", "a['form']['pretension_N'] == 10");
    OUT("# residual | rms_change\n");
    OUT("  # EA_inner_N:\n");
    OUT("  # strip_width_m:\n");
    OUT("# number > 0, <= 1000000000; N\n");
    OUT("\n  # up to 16 rows {key: value, ...} of these keys:\n  #   set: text or list of texts; required.\n");
    OUT("\n  #   range: number > 0, or a part like 30 %; may be left out.\n");
    OUT("\n  #   bounds: [low, high], of which one may be null; required.\n");
    OUT("\n  #   target: number; may be left out.\n");
    OUT("\n  #   mass_kg_per_m: number > 0; kg/m; may be left out.\n");
    OUT("\n  #   link: each | set | symmetry | scale; default each.\n");
}
END_TEST

/* With what is required filled in and two of the three scenes removed, the reference is a case that runs. */
START_TEST(schema_with_its_gaps_filled_is_a_case)
{
    SHELL(0, "\"$0\" schema | sed -e '/^  import:/,/^    facets:/d' -e '/^  paraboloid:/,/^    tie_tension_N:/d' "
             "-e '/^tolerance:/,/^truss:/{/^truss:/!d}' -e "
             "'/^  ring:/,/^  import:/d' -e "
             "'s/frequencies_Hz: \\[\\]/frequencies_Hz: [1e9]/' -e 's/aperture_m:/& 2/' -e 's/ length_m:/& 3/' "
             "-e 's/ focal_length_m:/& 2/' -e 's/modules:/& [2, 3]/' -e 's/cells_per_module:/& [2, 2]/' -e 's/scallop: "
             "0/scallop: 0.1/'");
    const char *path = file_with("filled.yaml", said.out);
    HIFDM(0, "check", path);
    OUT("optimisation: rule force_density");
}
END_TEST

START_TEST(help_lists_every_command_and_exit_status)
{
    HIFDM(0, "help");
    static const char *const parts[] = {
        "hifdm run ",    "hifdm check ",    "hifdm show ",    "hifdm report ", "hifdm export ",
        "hifdm schema ", "hifdm evaluate ", "hifdm recover ", "hifdm diff ",   "'hifdm help COMMAND' prints"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        OUT(parts[i]);
    OUT("\nexit status:\n  0   done\n  1   files differ\n  2   bad usage or case\n");
    OUT("\n  75  told to stop\n");
    char *help = said.out;
    said.out = NULL;
    HIFDM(0, "--help");
    ck_assert_str_eq(said.out, help);
    HIFDM(0, "-h");
    ck_assert_str_eq(said.out, help);
    free(help);
    HIFDM(0, "--version");
    ck_assert_int_eq(strncmp(said.out, "hifdm 0.", 8), 0);
}
END_TEST

START_TEST(show_refuses_what_is_no_result)
{
    HIFDM(5, "show", temp("missing.h5"));
    ERR("missing.h5: cannot open: No such file or directory");
    HIFDM(5, "show", REFLECTOR);
    ERR("reflector.yaml: this file is not a result file (HDF5) but a case. To check this file, use `hifdm check ");
    HIFDM(5, "report", REFLECTOR);
    ERR("reflector.yaml: this file is not a result file (HDF5) but a case. To check this file, use `hifdm check ");
    HIFDM(5, "show", temp("."));
    ERR("this is a folder, not a result file");
    const char *const make_other[] = {python_program(), "-c", "import h5py, sys; h5py.File(sys.argv[1], 'w')['x'] = 1",
                                      temp("other.h5"), NULL};
    demand_exit(run_command(HANG_S, make_other), 0, "make an HDF5 file", __LINE__);
    HIFDM(5, "show", temp("other.h5"));
    ERR("other.h5: this HDF5 file is damaged or is not a result of hifdm");
    HIFDM(0, "run", file_with("c.yaml", SMALL_SCENE), "-o", temp("whole.h5"));
    SHELL(0, "head -c 5000 <\"$1\" >\"$2\"", temp("whole.h5"), temp("half.h5"));
    HIFDM(5, "show", temp("half.h5"));
    ERR("half.h5: cannot open: truncated file");
    ck_assert_str_eq(said.out, "");
}
END_TEST

/* A node on three cables that rise and a tie below it, by hand: the tie takes 3 * 0.6 T. */
START_TEST(net_is_held_on_its_surface)
{
#define TRIPOD                                                                                                         \
    "id,x_m,y_m,z_m,role\na,0.8,0,0.6,support\nb,-0.4,0.69282032302755092,0.6,support\n"                               \
    "c,-0.4,-0.69282032302755092,0.6,support\nd,0,0,-2,support\nn,0,0,0,inner\n"
#define LEGS                                                                                                           \
    "id,i,j,group,law,value,set\nan,a,n,inner,tension,10,front\nbn,b,n,inner,tension,10,front\n"                       \
    "cn,c,n,inner,tension,10,front\n"
    const char *net = net_with(TRIPOD, LEGS "dn,d,n,inner,length,,tie\n"), *result = temp("r.h5");
    HIFDM(0, "check", net, "--set", "form.prestress=exact");
    OUT("prestress     exact; N: front 10 .. 10 (ratio 1), tie 18 .. 18 (ratio 1)\n");
    HIFDM(0, "run", net, "-o", result, "--set", "form.prestress=exact");
    EXPECT(result, "--", "a['form'].attrs['psi_m'] < 1e-15",
           "np.allclose(a['form/tension_N'][()], [10, 10, 10, 18], 1e-4)", "np.ptp(a['form/tension_N'][:3]) < 1e-12");
    net = net_with(TRIPOD, LEGS);
    HIFDM(2, "check", net, "--set", "form.prestress=exact");
    ERR("form.prestress: exact: no tensions above zero hold 1 of the 1 free nodes at their target positions: n. Each "
        "of these nodes lacks a cable that pulls it back onto the surface");
}
END_TEST

/* Why there are no measures of facets: cables that cross, or cables that enclose nothing. */
START_TEST(a_net_without_facets_says_why)
{
    const char *nodes = "id,x_m,y_m,z_m,role\na,1,1,0.1,support\nb,-1,1,0.1,support\nc,-1,-1,0.1,support\n"
                        "d,1,-1,0.1,support\nm,0.3,0,0.0045,inner\nn,-0.3,0,0.0045,inner\n";
#define STAR                                                                                                           \
    "id,i,j,group,law,value\nam,a,m,inner,tension,10\ndm,d,m,inner,tension,10\nbn,b,n,inner,tension,10\n"              \
    "cn,c,n,inner,tension,10\nmn,m,n,inner,tension,10\n"
#define SURFACE "--set", "surface.kind=paraboloid", "--set", "surface.focal_length_m=5"
    const char *cross = "warning: surface: as seen along the z axis, cables of the surface cross without a common "
                        "node, so hifdm cannot find the facets\n";
    HIFDM(0, "check", net_with(nodes, STAR), SURFACE);
    ck_assert_ptr_null(strstr(said.err, cross));
    HIFDM(0, "check", net_with(nodes, STAR "bm,b,m,inner,tension,1\nan,a,n,inner,tension,1\n"), SURFACE);
    ERR(cross);
#undef SURFACE
}
END_TEST

/* What would take more than a trial is counted, and comes with advice where it is beyond all bounds: of 25 rings it
 * took hours and gigabytes. */
START_TEST(check_of_many_variables_is_quick)
{
    const char *c = file_with("ring.yaml",
                              "scene:\n  paraboloid: {aperture_m: 9, focal_length_m: 6, rings: 4, rear_distance_m: 2}\n"
                              "form: {pretension_N: 10, prestress: exact}\n"
                              "optimize:\n  method: lm\n"
                              "  variables: [{set: all, vary: force_density, range: 50 %}]\n"
                              "  objective: [{figure: psi}, {figure: evenness, set: front, weight: 1e-4}]\n");
    HIFDM(0, "check", c);
    OUT(" a step; about ");
    OUT(" for 6 steps (at most 200)"); /* without damping, the model promises more after the first one */
    ck_assert(!strstr(said.out, "counted and not tried") && !strstr(said.out, "fewer of them by"));
    HIFDM(0, "check", c, "--set", "scene.paraboloid.rings=25"); /* a sparse system for all variables */
    OUT(" a step, counted and not tried; about ");
    ck_assert(!strstr(said.out, "fewer of them by"));
    HIFDM(0, "check", c, "--set", "scene.paraboloid.rings=25", "--set",
          "optimize.objective=[{figure: mass, mass_kg_per_m: 0.01}]");
    OUT("12901 variables: its time grows with their cube, its memory with their square; fewer of them by link: "
        "symmetry");
}
END_TEST

/* The trial is the whole form-finding, so that its figure is that of the run; a net on rigid ground has none. */
START_TEST(how_far_the_truss_gives_way_is_told)
{
    static const char says[] = "coupling: the truss deflects by up to ",
                      found[] = "  coupling      the truss deflects by up to ";
    const char *path = keep(source_path("configs/paraboloid-6m.yaml"));
    char told[16];
    HIFDM(0, "check", path);
    const char *at = strstr(said.out, says);
    ck_assert_msg(at, "%s", said.out);
    snprintf(told, sizeof told, "%.6s", at + strlen(says));
    HIFDM(0, "run", path, "-o", temp("r.h5"));
    OUT(formatted("%s%s mm at the attachments; ", found, told));
    HIFDM(0, "check", keep(source_path("configs/chen2022.yaml")));
    ck_assert_ptr_null(strstr(said.out, "deflects"));
}
END_TEST

Suite *suite_cli_check(void)
{
    Suite *suite = suite_create("cli/check");
    TCase *tcase = tcase_create("check");
    tcase_add_test(tcase, check_tells_how_long_yields_take);
    tcase_add_test(tcase, check_tells_how_long_samples_take);
    tcase_add_test(tcase, how_far_the_truss_gives_way_is_told);
    tcase_add_test(tcase, check_tells_what_will_run);
    tcase_add_test(tcase, check_counts_the_generations_of_auto);
    tcase_add_test(tcase, check_follows_the_size);
    tcase_add_test(tcase, check_of_an_ill_posed_case_says_so);
    tcase_add_test(tcase, check_of_many_variables_is_quick);
    tcase_add_test(tcase, check_tells_of_struts_and_loads);
    tcase_add_test(tcase, check_announces_no_ga_without_genes);
    tcase_add_test(tcase, schema_is_yaml_with_every_key);
    tcase_add_test(tcase, schema_with_its_gaps_filled_is_a_case);
    tcase_add_test(tcase, help_lists_every_command_and_exit_status);
    tcase_add_test(tcase, net_is_held_on_its_surface);
    tcase_add_test(tcase, a_net_without_facets_says_why);
    tcase_add_test(tcase, show_refuses_what_is_no_result);
    suite_add_tcase(suite, tcase);
    return suite;
}
