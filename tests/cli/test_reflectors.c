/* The reflectors that come with the program, from their files to results: held against an oracle in another language
 * that makes net and ring anew and solves the ring; what is told of rings that cannot be. */
#include "cli.h"

static const char *const example[] = {"configs/paraboloid-6m.yaml", "configs/paraboloid-offset-12m.yaml",
                                      "configs/cylinder-tied-8m.yaml"};
enum { N_EXAMPLE = sizeof example / sizeof *example, N_ROUND = 2 };

START_TEST(generators_agree_with_the_oracle)
{
    const char *path = keep(source_path(example[_i])), *out = temp("r.h5");
    HIFDM(0, "run", path, "-o", out);
    ck_assert_str_eq(said.err, "");
    const char *const oracle[] = {python_program(), keep(source_path("tests/verify/generators_oracle.py")), path, out,
                                  NULL};
    demand_exit(run_command(HANG_S, oracle), 0, "generators_oracle.py", __LINE__);
    OUT(_i < N_ROUND ? "ring: " : "net: 234 nodes");
}
END_TEST

/* On rigid ground tensions hold every node. On a stiff ring the net leaves its surface by a distance that falls with
 * the stiffness; on one of carbon fibre less, because there the truss deflects under the net. */
START_TEST(nets_are_held)
{
    const char *path = keep(source_path(example[_i]));
    SHELL(0, "sed '/^truss:/,/^$/d' \"$1\"", path);
    HIFDM(0, "run", file_with("rigid.yaml", said.out), "-o", temp("rigid.h5"));
    EXPECT(temp("rigid.h5"), "--", "a['form'].attrs['psi_m'] < 1e-9", "a['form'].attrs['n_slack'] == 0",
           "a['form'].attrs['position_bound_m'] < 1e-9", "'truss' not in a");
    if (_i == N_ROUND) return;
    HIFDM(0, "run", path, "-o", temp("elastic.h5"));
    OUT("  coupling      the truss deflects by up to ");
    HIFDM(0, "run", path, "-o", temp("stiff.h5"), "--set", "truss.E_Pa=130e11", "--set", "truss.G_Pa=5e11");
    HIFDM(0, "run", path, "-o", temp("stiffer.h5"), "--set", "truss.E_Pa=130e12", "--set", "truss.G_Pa=5e12");
    EXPECT(temp("elastic.h5"), temp("stiff.h5"), temp("stiffer.h5"), "--",
           "1e-3 < a['form'].attrs['psi_m'] < 100 * b['form'].attrs['psi_m']",
           "near(b['form'].attrs['psi_m'], 10 * c['form'].attrs['psi_m'], 0.02 * b['form'].attrs['psi_m'])");
}
END_TEST

#define DISH_ALONE "scene: {paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 4}}\n"
#define QUAD_DISH                                                                                                      \
    "scene: {paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 5, rear_distance_m: 1.8, grid: quad}}\n"
#define CYLINDER                                                                                                       \
    "scene: {parabolic_cylinder: {aperture_m: 8, length_m: 6, focal_length_m: 4, modules: [1, 1], cells_per_module: "  \
    "[8, 6], rear_distance_m: 2.5}}\n"

static const struct {
    const char *text, *error; /* behind "error: PATH" */
} impossible[] = {
    {DISH "truss: {ring: {height_m: 1.7}}\n", ":2:26: truss.ring.height_m: of 1.7 m puts the rear ring elsewhere than "
                                              "the rim of the rear net, which hangs on it: "
                                              "leave it out, or make it rear_distance_m, 1.8 m\n"},
    {DISH_ALONE "truss: {ring: {}}\n",
     ": truss.ring.height_m: is missing: the net has no rear rim that gives this height\n"},
    {DISH "truss: {ring: {cells_per_bay: 5}}\n", ":2:31: truss.ring.cells_per_bay: 5 must divide the 24 cells at the "
                                                 "rim into at least three bays\n"},
    {DISH "truss: {ring: {cells_per_bay: 12}}\n", ":2:31: truss.ring.cells_per_bay: 12 must divide the 24"},
    {DISH "truss: {ring: {longeron: {wall_m: 0.02}}}\n",
     ":2:35: truss.ring.longeron.wall_m: must not be more than half the diameter_m beside it\n"},
    {DISH "truss: {depth_m: 1, ring: {}}\n",
     ":2:18: truss.depth_m: has no effect beside truss.ring, which has no units; remove it\n"},
    {DISH "truss: {ring: {}, bud: {panels: 2}}\n", ":2:33: truss.bud.panels: has no effect beside truss.ring"},
    {DISH "truss: {ring: {}, import: {nodes: n, members: m}}\n", ": truss: has both ring and import; keep one\n"},
    {DISH "truss: {ring: {bracing: double}}\n", ":2:25: truss.ring.bracing: must be one of none single crossed, not"},
    {DISH "truss: {}\n", ": truss: needs a section ring to stand on under scene.paraboloid, or truss.import\n"},
    {SMALL_SCENE "truss: {ring: {}}\n", ": truss.ring: needs scene.paraboloid, under whose rim it stands\n"},
    {CYLINDER "truss: {}\n", ":1:137: scene.parabolic_cylinder.rear_distance_m: the truss over the modules has no "
                             "joints where the supports of the rear net are"},
    {"scene: {parabolic_cylinder: {aperture_m: 8, length_m: 6, focal_length_m: 4, modules: [1, 1], cells_per_module: "
     "[8, 6], rear_distance_m: 2}}\n",
     ":1:137: scene.parabolic_cylinder.rear_distance_m: of 2 m lets the nets meet in the middle"},
};
enum { N_IMPOSSIBLE = sizeof impossible / sizeof *impossible };

START_TEST(what_cannot_be_is_named)
{
    const char *path = file_with("c.yaml", impossible[_i].text);
    HIFDM(2, "check", path);
    ERRS("error: %s%s", path, impossible[_i].error);
}
END_TEST

/* Designs of a net that is held by force densities, on its ring: the lanes of a shared matrix find the shapes that
 * each design has by itself, round by round. */
START_TEST(designs_move_net_and_ring_in_lanes)
{
    static const char *const solver[] = {"optimize.solver=auto", "optimize.solver=fixed_point"};
    const char *path = keep(source_path("configs/paraboloid-6m.yaml")), *out[] = {temp("auto.h5"), temp("alone.h5")};
    HIFDM(0, "check", path, "--set", "optimize.generations=1");
    OUT("for a design of the first generation by chord;");
    for (int i = 0; i < 2; i++)
        HIFDM(0, "run", path, "-o", out[i], "--quiet", "--set", "optimize.generations=1", "--set",
              "optimize.refine=false", "--set", "coupling.tof_m=1e-10", "--set", "form.residual_tolerance=1e-12",
              "--set", solver[i]);
    EXPECT(out[0], out[1], "--", "(designs(a) == designs(b)).all()", "a['ga/psi_m'].shape == (1, 50)",
           "abs(a['ga/psi_m'][:] - b['ga/psi_m'][:]).max() < 1e-10",
           "abs(a['ga/boundary_tension_ratio'][:] - b['ga/boundary_tension_ratio'][:]).max() < 1e-8");
}
END_TEST

/* A double layer on a ring that deflects: psi and the evenness of the front vanish together, along a bent valley; with
 * limits on tensions as well. Without corrections of bent steps 200 steps leave evenness at 0.003. */
START_TEST(a_double_layer_is_designed)
{
    static const char *const limits[] = {"optimize.limits=[]",
                                         "optimize.limits=[{figure: tension, set: front, bounds: [9.9, 10.05]}]"};
    const char *out = temp("r.h5");
    const char *path = keep(source_path("configs/paraboloid-even.yaml"));
    HIFDM(0, "run", path, "-o", out, "--json", "--set", limits[_i], "--set", "optimize.refine_steps=40");
    EXPECT(out_as("r.json"), out, "--", "a['form']['psi_m'] > 2e-4", "a['refine']['psi_m'] < 1e-9",
           "a['refine']['sets']['front']['tension_ratio'] < 1 + 1e-6", "a['refine']['stop_reason'] == 'converged'",
           formatted("%d or 9.9 <= a['refine']['sets']['front']['min_N'] <= "
                     "a['refine']['sets']['front']['max_N'] <= 10.05",
                     _i == 0));
}
END_TEST

/* The objective facets leaves the rear net open, and where nodes of the front are within their surface. The program
 * reports both, with the node that moved farthest by the shapes in the file. It reports neither if an objective counts
 * these nodes, or if no variable moves them. A reflector of a hundredth of the size is no other. */
START_TEST(nodes_that_no_objective_counts_are_told)
{
    static const char *const silent[] = {"optimize.variables.0.set=tie",
                                         "optimize.objective=[{figure: facets, feed: fixed}, {figure: psi, weight: "
                                         "0.1}, {figure: length, set: rear, weight: 0.1}]"};
    static const char *const size[] = {"aperture_m: 6, focal_length_m: 3, rear_distance_m: 1.8",
                                       "aperture_m: 0.06, focal_length_m: 0.03, rear_distance_m: 0.018"};
    const char *out = temp("r.h5"),
               *path =
                   file_with("c.yaml", formatted("scene: {paraboloid: {rings: 4, %s}}\n"
                                                 "form: {pretension_N: 10, prestress: exact}\nsurface: {}\n"
                                                 "optimize: {method: lm, objective: [{figure: facets, feed: fixed}], "
                                                 "variables: [{set: all, vary: force_density, range: 50 %%}]}\n",
                                                 size[_i]));
    HIFDM(0, "run", path, "-o", out, "--json");
    EXPECT(out_as("r.json"), out, "--",
           "(lambda ids, moved: (lambda k: [w for w in a['warnings'] if f'node {ids[k]}, and ' in w and "
           "f'moved far from its position after form-finding, by {1e3 * moved[k]:.0f} mm, ' in w and 'set: rear, "
           "weight' in w])"
           "(max((k for k in range(len(ids)) if ids[k][0] == 'r'), key=lambda k: moved[k])))"
           "(b['scene/node/id'].asstr()[:], np.linalg.norm(b['refine/position_m'][:] - b['form/position_m'][:], "
           "axis=1))",
           "any('node f' in w and 'moved far within the surface, by ' in w for w in a['warnings'])",
           "a['form']['n_uncounted'] == a['form']['n_free'] == 2 * a['form']['n_inner_node']",
           /* of the front only within the paraboloid, whose normal at (x, y) is (-x/2f, -y/2f, 1) */
           formatted("(lambda at, move, normal, is_front: near(a['form']['uncounted_move_m'], np.linalg.norm(move - "
                     "(is_front * np.sum(move * normal, axis=1) / np.sum(normal ** 2, axis=1))[:, None] * normal, "
                     "axis=1).max(), 1e-9))(b['form/position_m'][:], b['refine/position_m'][:] - "
                     "b['form/position_m'][:], np.insert(b['form/position_m'][:, :2] / -%g, 2, 1, axis=1), "
                     "np.array([i[:1] == b'f' for i in b['scene/node/id'][:]]))",
                     _i ? 0.06 : 6.0));
    HIFDM(0, "show", out);
    OUT("; psi of 37 of 74 free nodes ");
    for (int k = 0; k < 2; k++) {
        HIFDM(0, "run", path, "-o", out, "--force", "--set", silent[k]);
        ck_assert_ptr_null(strstr(said.err, "moved far"));
    }
}
END_TEST

/* EA in kN where N is meant; 5 % is the largest strain that is not told. */
START_TEST(cables_stretched_too_far_are_told)
{
    const char *net = "scene: {paraboloid: {aperture_m: 4, focal_length_m: 2.4, rings: 3, rear_distance_m: 1.2}, "
                      "EA_inner_N: 8, EA_boundary_N: 8000}\nform: {pretension_N: 5, prestress: exact}\n",
               *path = file_with("c.yaml", net), *out = temp("r.h5");
    HIFDM(0, "run", path, "-o", out, "--json");
    EXPECT(out_as("r.json"), out, "--",
           "(lambda strain, ids: any(f\"cable '{ids[strain.argmax()]}' and {(strain > 0.05).sum() - 1} more are "
           "stretched by up to {100 * strain.max():.3g} %\" in w for w in a['warnings']))"
           "(b['form/tension_N'][:] / b['scene/cable/EA_N'][:], b['scene/cable/id'].asstr()[:])");
    HIFDM(0, "run", path, "-o", out, "--force", "--set", "scene.EA_inner_N=8000");
    ck_assert_ptr_null(strstr(said.err, "stretched"));
}
END_TEST

/* The cells of a quad net at its rim, 28 here, are counted when they are made. */
START_TEST(rings_under_quad_nets)
{
    const char *path = file_with("c.yaml", QUAD_DISH "truss: {ring: {cells_per_bay: 3}}\n");
    HIFDM(2, "check", path);
    ERR("error: truss.ring.cells_per_bay: bays of 3 cells must divide the rim of 28 cells into at least three equal "
        "parts\n");
    HIFDM(0, "check", path, "--set", "truss.ring.cells_per_bay=1");
    OUT("  truss         56 nodes, 112 members; ");
    OUT("; 56 attachments\n");
    HIFDM(4, "check", path, "--set", "truss.ring.cells_per_bay=1", "--set", "truss.joints=pinned");
    ERR(" can move along ");
}
END_TEST

/* Tensions that hold all nodes leave a psi of rounding, of which nothing is a part; and force densities alone have no
 * derivatives by the default variables, but by rows. */
START_TEST(nothing_is_below_rounding)
{
    const char *path = file_with("c.yaml", QUAD_DISH "form: {prestress: exact}\n"
                                                     "optimize: {population: 10, generations: 3}\n");
    HIFDM(0, "run", path, "-o", temp("r.h5"));
    static const char first_line[] = "psi 0.0000 mm (RMS position error of 69 of 138 free nodes)\n";
    ck_assert_int_eq(strncmp(said.out, first_line, sizeof first_line - 1), 0);
    HIFDM(0, "show", "--verbose", temp("r.h5"));
    OUT("  search        psi 0.0000 mm; found in generation ");
    HIFDM(0, "check", path, "--set", "optimize.method=ga+lm");
    ERR("warning: optimize: Levenberg-Marquardt needs derivatives; there are no derivatives by the default variables");
    HIFDM(2, "run", path, "--restart", "-o", temp("r.h5"), "--set", "optimize.method=lm");
    ERR("error: optimize: Levenberg-Marquardt needs derivatives; ");
    HIFDM(0, "run", path, "--restart", "-o", temp("r.h5"), "--set", "optimize.method=lm", "--set",
          "optimize.variables=[{set: boundary, vary: force_density, range: 10 %}]");
    OUT("  refine           0.0000 ");
}
END_TEST

Suite *suite_cli_reflectors(void)
{
    Suite *suite = suite_create("cli/reflectors");
    TCase *tcase = tcase_create("reflectors");
    tcase_add_loop_test(tcase, generators_agree_with_the_oracle, 0, N_EXAMPLE);
    tcase_add_loop_test(tcase, nets_are_held, 0, N_EXAMPLE);
    tcase_add_loop_test(tcase, what_cannot_be_is_named, 0, N_IMPOSSIBLE);
    tcase_add_test(tcase, designs_move_net_and_ring_in_lanes);
    tcase_add_loop_test(tcase, a_double_layer_is_designed, 0, 2);
    tcase_add_loop_test(tcase, nodes_that_no_objective_counts_are_told, 0, 2);
    tcase_add_test(tcase, cables_stretched_too_far_are_told);
    tcase_add_test(tcase, rings_under_quad_nets);
    tcase_add_test(tcase, nothing_is_below_rounding);
    suite_add_tcase(suite, tcase);
    return suite;
}
