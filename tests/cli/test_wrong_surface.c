/* What cannot be taken as it is printed is said: a net that is not on the surface it is measured against, what is
 * hardly meant (cables twice, mm for m, a flat rim), tension ratios of nets with slack cables. */
#include "cli.h"

/* ---- slack cables ---- */

/* A net in which the cable `ad` is too long to pull. */
#define SLACK_NODES                                                                                                    \
    "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0.1,support\nc,1,2,0,support\nd,1,0.7,0.05,inner\n"                   \
    "e,1,1.2,0.05,inner\n"
#define SLACK_CABLES                                                                                                   \
    "id,i,j,group,law,value\nad,a,d,boundary,length,9\nbd,b,d,inner,tension,10\nde,d,e,inner,tension,10\n"             \
    "ea,e,a,inner,tension,10\nec,e,c,inner,tension,12\n"

/* The same in the summary, in JSON and in the file, whatever a solver leaves of the tension. */
START_TEST(ratio_with_a_slack_cable_is_infinite)
{
    static const char *const method[] = {"newton", "hifdm"};
    const char *path = net_with(SLACK_NODES, SLACK_CABLES), *out = temp("s.h5");
    HIFDM(0, "run", path, "-o", out, "-v", "--set", formatted("form.method=%s", method[_i]));
    OUT("             inf        1.2000          -");
    OUT("  1 slack cable;");
    OUT("tension ratio 1.2000 inside, inf on the boundary (1 slack cable); ");
    HIFDM(0, "show", out, "--json");
    EXPECT(out_as("s.json"), out, "--", "a['form']['boundary_tension_ratio'] == 'Infinity'",
           "float(a['form']['boundary_tension_ratio']) == np.inf", "a['form']['slack_cables'] == 1",
           "a['form']['inner_tension_ratio'] == b['form'].attrs['inner_tension_ratio']",
           "b['form'].attrs['boundary_tension_ratio'] == np.inf", "b['form'].attrs['n_slack'] == 1");
    HIFDM(0, "report", out, "-o", temp("s.html"));
    char *page = read_file(temp("s.html"), NULL);
    demand_part(page, "\"boundary_tension_ratio\": \"Infinity\"", __LINE__);
    free(page);
}
END_TEST

/* ---- the kind of the surface ---- */

/* A net of 5 x 5 nodes over the square from -2 to 2 m, f = 4 m, as a grid of cables; its rim is fixed. */
static const char *grid_net(bool is_round, const char *more)
{
    char nodes[4096] = "id,x_m,y_m,z_m,role\n", cables[4096] = "id,i,j,group,law,value\n";
    for (int i = 0; i < 25; i++) {
        int x = i % 5 - 2, y = i / 5 - 2, is_rim = abs(x) == 2 || abs(y) == 2;
        size_t n = strlen(nodes), m = strlen(cables);
        snprintf(nodes + n, sizeof nodes - n, "n%d,%d,%d,%g,%s\n", i, x, y, (x * x + is_round * y * y) / 16.0,
                 is_rim ? "support" : "inner");
        if (x < 2 && abs(y) < 2)
            m += (size_t)snprintf(cables + m, sizeof cables - m, "x%d,n%d,n%d,inner,tension,\n", i, i, i + 1);
        if (y < 2 && abs(x) < 2) snprintf(cables + m, sizeof cables - m, "y%d,n%d,n%d,inner,tension,\n", i, i, i + 5);
    }
    net_with(nodes, cables);
    return file_with("grid.yaml",
                     formatted("scene:\n  import: {nodes: nodes.csv, cables: cables.csv}\nsurface:\n%s", more));
}

/* Found from the nodes, or as the case says; told in every place. */
START_TEST(surface_of_an_imported_net_has_a_kind)
{
    static const char *const kind[] = {"parabolic_cylinder", "paraboloid"};
    const char *out = temp("k.h5"), *word = file_with("kind", kind[_i]);
    for (int given = 0; given < 2; given++) {
        char more[128] = "  focal_length_m: 4\n";
        if (given) snprintf(more, sizeof more, "  kind: %s\n  focal_length_m: 4\n", kind[_i]);
        HIFDM(0, "run", grid_net(_i, more), "-o", out, "--force", "--json");
        EXPECT(
            out, out_as("k.json"), word, "--", "b['form']['surface']['kind'] == c.decode()",
            "a['surface'].attrs['kind'] == 1 + (c == b'paraboloid')",
            "near(np.sqrt(np.mean([(p[2] - (p[0]**2 + (c == b'paraboloid') * p[1]**2) / 16)**2 / (1 + (p[0]**2 + "
            "(c == b'paraboloid') * p[1]**2) / 64) for p in a['form/position_m'][:][a['scene/node/role'][:] == 1]])), "
            "b['form']['surface']['normal_rms_m'], 1e-15)");
        HIFDM(0, "show", out, "--verbose");
        OUT(_i ? "surface, paraboloid: half-path RMS " : "surface, parabolic cylinder: half-path RMS ");
    }
    HIFDM(0, "export", out, "--vtk", temp("vtk"));
}
END_TEST

/* 2/3 of the heights y^2/16 of the nine inner nodes are 1/16 m, the others 0: RMS sqrt(2/3)/16 m = 51.03 mm. */
START_TEST(net_beside_its_surface_is_refused)
{
    const char *path = grid_net(true, "  kind: parabolic_cylinder\n  focal_length_m: 4\n");
    HIFDM(2, "run", path, NOWHERE);
    ERRS("error: %s:5:19: surface.focal_length_m: the inner nodes are not on the parabolic_cylinder with f = 4 m. The "
         "RMS height error of the inner nodes is 51.03 mm, and node 'n6', line 8 has the maximum error of 62.5 mm. The "
         "RMS height error is 51.03 mm for the parabolic_cylinder z = x^2/(4f), and 0 mm for the paraboloid z = (x^2 + "
         "y^2)/(4f). Give surface.kind: paraboloid\n",
         path);
    HIFDM(2, "check", path);
    ERR("surface.focal_length_m: the inner nodes are not on the parabolic_cylinder");
    path = grid_net(false, "  kind: auto\n");
    HIFDM(2, "check", path, "--set", "surface.kind=paraboloid", "--set", "surface.focal_length_m=4");
    ERR("error: --set surface.focal_length_m: the inner nodes are not on the paraboloid with f = 4 m. The RMS height "
        "error of the inner nodes is 51.03 mm");
    ERR("Give surface.kind: parabolic_cylinder\n");
    path = grid_net(false, "  kind: auto\n  focal_length_m: 8\n"); /* neither: another focal length */
    HIFDM(2, "check", path);
    ERR("The vertex of the target surface is the origin, and its axis is z\n");
    const char *small = file_with("s.yaml", SMALL_SCENE "surface:\n  kind: paraboloid\n");
    HIFDM(2, "check", small);
    ERRS("error: %s:4:9: surface.kind: the inner nodes are not on the paraboloid with f = 2 m. ", small);
    ERR("Give surface.kind: parabolic_cylinder\n");
}
END_TEST

/* Heights are off by (4 - f)/(16 f) at two of three inner nodes, and the depth is 1/f: 2 % of it where 4 - f = 0.392.
 *  */
START_TEST(small_differences_from_the_surface_are_allowed)
{
    const char *path = grid_net(false, "  kind: auto\n");
    HIFDM(0, "check", path, "--set", "surface.focal_length_m=3.61");
    HIFDM(2, "check", path, "--set", "surface.focal_length_m=3.60");
    HIFDM(2, "check", path, "--set", "surface.kind=round", "--set", "surface.focal_length_m=4");
    ERR("surface.kind: must be one of auto parabolic_cylinder paraboloid, not round\n");
}
END_TEST

/* ---- what is hardly meant ---- */

START_TEST(cables_between_the_same_nodes_are_told)
{
    char cables[2048] = SLACK_CABLES "twin,d,b,inner,force_density,0.01\n";
    HIFDM(3, "check", net_with(SLACK_NODES, cables));
    ERRS("warning: %s:7: cable 'twin' joins the same two nodes as cable 'bd'\n", temp("cables.csv"));
    ck_assert_int_eq(count_of(said.err, "joins the same"), 1);
    for (int i = 0; i < 9; i++)
        snprintf(cables + strlen(cables), sizeof cables - strlen(cables), "t%d,e,d,inner,force_density,0.01\n", i);
    HIFDM(0, "check", net_with(SLACK_NODES, cables));
    ck_assert_int_eq(count_of(said.err, "joins the same"), 5);
    ERR("warning: scene: 5 more cables join the same two nodes as another cable\n");
}
END_TEST

START_TEST(far_nodes_are_told)
{
    const char *nodes = SLACK_NODES "f,1,1000,0.1,support\ng,200,0,0,support\n";
    HIFDM(0, "check", net_with(nodes, SLACK_CABLES "ef,e,f,inner,tension,1\neg,e,g,inner,tension,1\n"));
    ERRS("warning: %s:7: node 'f' is 999 m from the middle of the net, ", temp("nodes.csv"));
    ERRS("warning: %s:8: node 'g' is 199 m from the middle of the net, ", temp("nodes.csv"));
    ck_assert_int_eq(count_of(said.err, "times as far as the other nodes. Are all coordinates in m?\n"), 2);
    ERR("warning: scene: the net is 1000 m across. Are all lengths in m?\n");
    HIFDM(0, "check", net_with(SLACK_NODES, SLACK_CABLES));
    ck_assert_ptr_null(strstr(said.err, "as far as"));
    ck_assert_ptr_null(strstr(said.err, "across"));
}
END_TEST

START_TEST(lengths_in_another_unit_are_told)
{
    static const char nodes[] = "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0.1,inner\nc,2,0,0,support\n"
                                "d,1,1,0,support\n";
    char cables[2048] = "id,i,j,group,law,value,EA_N\nab,a,b,inner,length,1005,\nbc,b,c,inner,elastic,0.498,1e4\n";
    HIFDM(0, "check", net_with(nodes, formatted("%sbd,b,d,inner,elastic,1.5,1e4\n", cables)));
    ERRS("warning: %s:2: cable 'ab' is 1005 m long by its law, which is 1e+03 times the distance between its nodes. Is "
         "this length in m?\n",
         temp("cables.csv"));
    ERRS("warning: %s:3: cable 'bc' is 0.498 m long by its law, which is 0.496 times ", temp("cables.csv"));
    ck_assert_int_eq(count_of(said.err, "by its law"), 2);
    for (int i = 0; i < 6; i++)
        snprintf(cables + strlen(cables), sizeof cables - strlen(cables), "t%d,b,d,inner,length,1600,\n", i);
    HIFDM(0, "check", net_with(nodes, cables));
    ck_assert_int_eq(count_of(said.err, "by its law"), 5);
    ERR("warning: scene: 3 more cables have lengths that differ from the distances between their nodes\n");
}
END_TEST

START_TEST(frequencies_in_another_unit_are_refused)
{
    const char *path = file_with("f.yaml", SMALL_SCENE "surface:\n  frequencies_Hz: [1e9, 6]\n");
    HIFDM(2, "check", path);
    ERR("f.yaml:");
    ERR("surface.frequencies_Hz: is 6 Hz, and below 1 MHz there are no reflectors: was GHz meant? 6 GHz is 6e9\n");
    HIFDM(0, "check", path, "--set", "surface.frequencies_Hz=[1e6]");
    HIFDM(2, "check", keep(source_path("configs/paraboloid-even.yaml")), "--set",
          "optimize.objective=[{figure: gain, frequency_Hz: 32}]", "--set", "surface.frequencies_Hz=[1e9]", "--set",
          "surface.pattern.phi_deg=[0]");
    ERR("optimize.objective.0.frequency_Hz: is 32 Hz, and ");
}
END_TEST

/* 50 N/m where 50 % was meant. */
START_TEST(a_range_beyond_the_values_is_told)
{
    static const char row[] = SMALL_SCENE "optimize: {method: lm, variables: [{set: boundary, vary: force_density, "
                                          "range: %s}]}\n";
    const char *path = file_with("r.yaml", formatted(row, "500"));
    HIFDM(0, "check", path);
    ERR("optimize.variables.0.range: the range 500 is ");
    ERR(" times the maximum value of this row, ");
    ERR(". For a relative range, write 500 %\n");
    ck_assert_int_eq(count_of(said.err, "For a relative range"), 1);
    HIFDM(0, "check", file_with("r.yaml", formatted(row, "50 %")));
    ck_assert_ptr_null(strstr(said.err, "For a relative range"));
    HIFDM(0, "check", file_with("r.yaml", formatted(row, "500, bounds: [1, 600]")));
    ck_assert_ptr_null(strstr(said.err, "For a relative range"));
}
END_TEST

START_TEST(lengths_that_exact_tensions_replace_are_told)
{
    const char *path = file_with("p.yaml", "scene:\n  EA_inner_N: 5e4\n  EA_boundary_N: 5e4\n"
                                           "  paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 2, "
                                           "rear_distance_m: 1}\nform: {prestress: exact}\n");
    HIFDM(0, "run", path, "-o", temp("p.h5"), "--quiet"); /* its ties are as long as theory has them */
    ck_assert_ptr_null(strstr(said.err, "is not used"));
    HIFDM(0, "export", temp("p.h5"), "--cutlist", temp("cut.csv"));
    HIFDM(0, "check",
          file_with("again.yaml", "scene: {import: {nodes: cut_nodes.csv, cables: cut.csv}}\n"
                                  "form: {prestress: exact}\n"));
    ck_assert_int_eq(count_of(said.err, "is not used, nor are those of others"), 1);
    HIFDM(0, "check", temp("again.yaml"), "--set", "form.prestress=given");
    ck_assert_ptr_null(strstr(said.err, "is not used"));
}
END_TEST

START_TEST(focal_length_out_of_proportion_is_told)
{
    const char *path = file_with("f.yaml", SMALL_SCENE);
    HIFDM(0, "check", path, "--set", "scene.parabolic_cylinder.focal_length_m=41");
    ERR("warning: --set scene.parabolic_cylinder.focal_length_m: the focal length of 41 m is 20 times the aperture of "
        "2 m, but the usual maximum for reflectors is 20 times. Is this value in m?\n");
    HIFDM(0, "check", path, "--set", "scene.parabolic_cylinder.focal_length_m=40");
    ck_assert_ptr_null(strstr(said.err, "in m?"));
    path = grid_net(true, "  kind: paraboloid\n  focal_length_m: 4000\n");
    HIFDM(2, "check", path); /* and it is not on this surface */
    ERRS("warning: %s:5:19: surface.focal_length_m: the focal length of 4000 m is 1000 times the aperture of 4 m, ",
         path);
}
END_TEST

/* A net with its rim in one plane, nothing to pull it off, is flat; with a tie, a load or a strut it is not. */
START_TEST(net_that_collapses_to_the_plane_of_its_supports_is_told)
{
#define BOWL "id,x_m,y_m,z_m,role,Fz_N\na,1,0,1,support,\nb,-1,0,1,support,\nc,0,1,1,support,\nd,0,-1,1,support,\n"
#define STAR "id,i,j,group,law,value\nae,a,e,inner,tension,1\nbe,b,e,inner,tension,1\nce,c,e,inner,tension,1\n"
#define FLAT "warning: scene: all supports are in one plane, and no load, tie or strut holds the net away from there. "
    HIFDM(0, "run", net_with(BOWL "e,0,0,0.7,inner,\n", STAR "de,d,e,inner,tension,1\n"), "-o", temp("b.h5"), "--json");
    ERR(FLAT "With any tensions, the net collapses there, so the inner nodes are at least 300 mm RMS from "
             "their target positions. Put supports on the surface, tie the net to another net, or add loads\n");
    EXPECT(out_as("b.json"), temp("b.h5"), "--", "near(a['form']['psi_m'], 0.3, 1e-9)",
           "any('With any tensions, the net collapses there' in w for w in a['warnings'])",
           "'With any tensions, the net collapses there' in attribute(b, 'warnings')");
    static const char *const other[][2] = {
        {BOWL "e,0,0,0.7,inner,-1\n", STAR "de,d,e,inner,tension,1\n"},
        {BOWL "e,0,0,0.7,inner,\nf,0,0,0,support,\n", STAR "de,d,e,inner,tension,1\nef,e,f,inner,tension,1\n"},
        {BOWL "e,0,0,0.7,inner,\n", STAR "de,d,e,inner,force_density,-0.1\n"},
        {BOWL "e,0,0,0.999,inner,\n", STAR "de,d,e,inner,tension,1\n"},
    };
    for (int i = 0; i < 4; i++) {
        HIFDM(0, "check", net_with(other[i][0], other[i][1]));
        ck_assert_ptr_null(strstr(said.err, "all supports are"));
    }
    HIFDM(0, "check",
          net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,1,inner\nc,2,0,0,support\n",
                   "id,i,j,group,law,value\nab,a,b,inner,tension,\nbc,b,c,inner,tension,\n"));
    ERR("warning: scene: all supports are on one line, ");
}
END_TEST

Suite *suite_cli_wrong_surface(void)
{
    Suite *suite = suite_create("cli/wrong_surface");
    TCase *tests = tcase_create("wrong_surface");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, surface_of_an_imported_net_has_a_kind, 0, 2);
    tcase_add_test(tests, net_beside_its_surface_is_refused);
    tcase_add_test(tests, small_differences_from_the_surface_are_allowed);
    tcase_add_test(tests, cables_between_the_same_nodes_are_told);
    tcase_add_test(tests, far_nodes_are_told);
    tcase_add_test(tests, lengths_in_another_unit_are_told);
    tcase_add_test(tests, frequencies_in_another_unit_are_refused);
    tcase_add_test(tests, a_range_beyond_the_values_is_told);
    tcase_add_test(tests, lengths_that_exact_tensions_replace_are_told);
    tcase_add_test(tests, focal_length_out_of_proportion_is_told);
    tcase_add_test(tests, net_that_collapses_to_the_plane_of_its_supports_is_told);
    tcase_add_loop_test(tests, ratio_with_a_slack_cable_is_infinite, 0, 2);
    return suite;
}
