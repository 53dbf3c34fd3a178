/* What cannot be taken as it is printed is said: a net that is not on the surface it is measured against, tension
 * ratios of nets with slack cables. */
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
    HIFDM(0, "run", path, "-o", out, "--set", formatted("form.method=%s", method[_i]));
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
        HIFDM(0, "show", out);
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
    ERRS("error: %s:5:19: surface.focal_length_m: the inner nodes are not on the parabolic_cylinder with f = 4 m: RMS "
         "of "
         "their heights above it 51.03 mm, farthest 'n6', line 8, 62.5 mm (above the parabolic_cylinder z = x^2/(4f) "
         "the "
         "RMS is 51.03 mm, above the paraboloid z = (x^2 + y^2)/(4f) 0 mm); give surface.kind: paraboloid\n",
         path);
    HIFDM(2, "check", path);
    ERR("surface.focal_length_m: the inner nodes are not on the parabolic_cylinder");
    path = grid_net(false, "  kind: auto\n");
    HIFDM(2, "check", path, "--set", "surface.kind=paraboloid", "--set", "surface.focal_length_m=4");
    ERR("error: --set surface.focal_length_m: the inner nodes are not on the paraboloid with f = 4 m: RMS of their "
        "heights "
        "above it 51.03 mm");
    ERR("give surface.kind: parabolic_cylinder\n");
    path = grid_net(false, "  kind: auto\n  focal_length_m: 8\n"); /* neither: another focal length */
    HIFDM(2, "check", path);
    ERR("its vertex is the origin, its axis z, its focal length this one\n");
    const char *small = file_with("s.yaml", SMALL_SCENE "surface:\n  kind: paraboloid\n");
    HIFDM(2, "check", small);
    ERRS("error: %s:4:9: surface.kind: the inner nodes are not on the paraboloid with f = 2 m: ", small);
    ERR("give surface.kind: parabolic_cylinder\n");
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

Suite *suite_cli_wrong_surface(void)
{
    Suite *suite = suite_create("cli/wrong_surface");
    TCase *tests = tcase_create("wrong_surface");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, surface_of_an_imported_net_has_a_kind, 0, 2);
    tcase_add_test(tests, net_beside_its_surface_is_refused);
    tcase_add_test(tests, small_differences_from_the_surface_are_allowed);
    tcase_add_loop_test(tests, ratio_with_a_slack_cable_is_infinite, 0, 2);
    return suite;
}
