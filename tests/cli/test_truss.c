/* Cases with a truss: what run, show, check and export say and store; faults of the section. */
#include "session.h"

#define TRUSS keep(source_path("configs/straight-edges-truss.yaml"))

START_TEST(run_show_check_and_file)
{
    const char *out = temp("t.h5");
    HIFDM(0, "run", TRUSS, "-o", out);
    OUT("  truss         132 nodes, 336 members; 202.07 kg\n");
    HIFDM(0, "show", out);
    OUT("  truss         132 nodes, 336 members; 202.07 kg\n");
    HIFDM(0, "show", out, "--json");
    EXPECT(out_as("s.json"), out, "--", "a['truss']['nodes'] == 132", "a['truss']['members'] == 336",
           "abs(a['truss']['mass_kg'] - 200) < 10", "b['truss'].attrs['mass_kg'] == a['truss']['mass_kg']",
           "b['truss/node/position_m'].shape == (132, 3)", "b['truss/node/fixed'][:].sum() == 48",
           "b['truss/member/end'][:].max() == 131", "b['truss/member/A_m2'].attrs['units'] == 'm2'",
           "len(b['truss/attachment/net_node']) == 36",
           "abs(b['scene/node/position_m'][:][b['truss/attachment/net_node'][:]] - "
           "b['truss/node/position_m'][:][b['truss/attachment/truss_node'][:]]).max() < 1e-12");
    HIFDM(0, "check", TRUSS);
    OUT("  truss         132 nodes, 336 members; 202.07 kg; 36 attachments\n");
    OUT("744 unknowns, half-bandwidth ");
    ck_assert_ptr_null(strstr(said.out, "truss (no truss section)"));
}
END_TEST

/* The pull of the stored shape on the attachments, the reactions and the end forces of the members hold each other. To
 * 1e-9 of the sum of tensions: rounding times the truss's condition number of 2e6. */
static void demand_balance(const char *out, const char *stage)
{
    EXPECT(
        out, file_with("stage", stage), "--",
        "all((s := a[b.decode()], x := s['position_m'][:], e := a['scene/cable/end'][:], "
        "t := s['q_N_per_m'][:][:, None] * (x[e[:, 1]] - x[e[:, 0]]), pull := x * 0, "
        "np.add.at(pull, e[:, 0], t) is None, np.add.at(pull, e[:, 1], -t) is None, "
        "f := pull[a['truss/attachment/net_node'][:]].sum(0), r := a['truss/node/reaction'][:], "
        "abs(f + r[:, :3].sum(0)).max() < 1e-9 * abs(t).sum())[-1:])",
        "(a['truss/node/reaction'][:][a['truss/node/fixed'][:] == 0] == 0).all()",
        "(a['truss/node/displacement'][:][a['truss/node/fixed'][:] == 1] == 0).all()",
        "abs(a['truss/node/displacement'][:]).max() > 1e-6",
        /* the stored truss is the one on which the net found its shape */
        "abs((s := a[b.decode()])['position_m'][:][n := a['truss/attachment/net_node'][:]] - "
        "a['scene/node/position_m'][:][n] - a['truss/node/displacement'][:][a['truss/attachment/truss_node'][:], :3])"
        ".max() < 1e-6 * abs(a['truss/node/displacement'][:, :3]).max()",
        "a['truss/member/end_force'].shape == (len(a['truss/member/id']), 12)",
        "abs(a['truss/member/end_force'][:, 0] + a['truss/member/end_force'][:, 6]).max() == 0");
}

START_TEST(forces_in_the_truss)
{
    const char *out = temp("t.h5");
    HIFDM(0, "run", TRUSS, "-o", out, "--quiet", "--set", "coupling.tof_m=1e-12");
    demand_balance(out, "form");
    const char *path = file_with("c.yaml", SMALL_SCENE SMALL_GA "truss: {}\ncoupling: {tof_m: 1e-12}\n");
    HIFDM(0, "run", path, "-o", out, "--force", "--quiet", "--set", "optimize.refine=false");
    demand_balance(out, "search");
    HIFDM(0, "run", path, "-o", out, "--force", "--quiet", "--set", "optimize.method=ga+lm");
    demand_balance(out, "polish");
}
END_TEST

START_TEST(a_case_without_a_truss_has_nothing_of_it)
{
    const char *path = file_with("c.yaml", SMALL_SCENE), *out = temp("c.h5");
    HIFDM(0, "run", path, "-o", out, "--json");
    EXPECT(out_as("s.json"), out, "--", "'truss' not in a", "'truss' not in b");
    HIFDM(0, "check", path);
    OUT("truss (no truss section)");
    HIFDM(0, "export", out, "--csv", temp("csv"));
    SHELL(0, "ls -A \"$1\" | tr '\\n' ' '", temp("csv"));
    ck_assert_str_eq(said.out, "cables.csv nodes.csv ");
}
END_TEST

/* What `export` writes, `truss.import` reads: the same truss, to the bit. */
START_TEST(exported_truss_can_be_imported)
{
    const char *path = file_with("c.yaml", SMALL_SCENE "truss: {theory: timoshenko, mbug: {panels: 2}}\n");
    const char *one = temp("one.h5"), *two = temp("two.h5"), *folder = temp("csv");
    HIFDM(0, "run", path, "-o", one, "--quiet");
    HIFDM(0, "export", one, "--csv", folder);
    OUT("members of the truss in");
    const char *again = file_with("again.yaml", SMALL_SCENE
                                  "truss: {import: {nodes: csv/truss_nodes.csv, members: csv/members.csv}}\n");
    HIFDM(0, "run", again, "-o", two, "--quiet");
    ck_assert_ptr_null(strstr(said.err, "is not used")); /* displacements and end forces are the program's own */
    EXPECT(one, two, "--",
           "all((a['truss'][k + n][:] == b['truss'][k + n][:]).all() for k in ('node/', 'member/') "
           "for n in a['truss'][k] if n not in ('displacement', 'reaction', 'end_force'))",
           "list(a['truss/member']) == list(b['truss/member'])",
           "a['truss'].attrs['mass_kg'] == b['truss'].attrs['mass_kg']");
    SHELL(0, "sed -i '0,/,all,/s//,ux uy uz ry,/' \"$1/truss_nodes.csv\"", folder); /* the first fixed node turns */
    HIFDM(0, "run", again, "-o", two, "--quiet", "--restart");
    HIFDM(0, "export", two, "--csv", temp("turns"));
    EXPECT(keep(formatted("%s/truss_nodes.csv", folder)), temp("turns/truss_nodes.csv"), two, "--",
           "[r['fixed'] for r in a] == [r['fixed'] for r in b]", "sum(r['fixed'] == 'ux uy uz ry' for r in a) == 1",
           "sorted(c['truss/node/fixed'][:].sum(axis=1).tolist())[-2:] == [6, 6]",
           "4 in c['truss/node/fixed'][:].sum(axis=1)");
    HIFDM(5, "run", again, "-o", keep(formatted("%s/members.csv", folder)), "--force");
    ERR("is an input of this run");
    HIFDM(5, "export", one, "--csv", folder);
    ERR("already exists. Use --force");
}
END_TEST

/* A result of other truss tables is another case's: finished, or stopped on its way. */
START_TEST(changed_truss_tables_are_another_case)
{
    static const char *const edits[] = {"s/,130000000000,/,120000000000,/", "2s/^[^,]*/renamed/"};
    const char *path = file_with("c.yaml", SMALL_SCENE "truss: {mbug: {panels: 2}}\n"), *folder = temp("csv");
    const char *out = temp("t.h5"), *part = temp("part.h5");
    HIFDM(0, "run", path, "-o", temp("one.h5"), "--quiet");
    HIFDM(0, "export", temp("one.h5"), "--csv", folder);
    path = file_with("c.yaml", SMALL_SCENE "truss: {import: {nodes: csv/truss_nodes.csv, members: csv/members.csv}}\n"
                                           "optimize: {population: 20, generations: 100000, seed: 7, "
                                           "stagnation_generations: 100000, boundary_ratio_cap: 1000}\n");
    HIFDM(0, "run", path, "-o", out, "--quiet", "--set", "optimize.generations=2");
    HIFDM(0, "run", path, "-o", out, "--quiet", "--set", "optimize.generations=2");
    session s = start_held_run(path, part, NULL);
    wait_for_generations(&s, part);
    ck_assert_int_eq(end_by(&s, SIGTERM), 75);
    HIFDM(0, "show", part);
    OUT("unfinished");
    SHELL(0, "sed -i \"$2\" \"$1/members.csv\"", folder, edits[_i]);
    HIFDM(5, "run", path, "-o", out, "--quiet", "--set", "optimize.generations=2");
    ERR("finished result of another case");
    ERR("tables of the net or of the truss");
    HIFDM(5, "run", path, "-o", part, "--quiet");
    ERR("unfinished result of another case");
}
END_TEST

static const struct {
    int exit_code;
    const char *section, *says;
} faulty[] = {
    {2, "truss: {depth_m: 0}\n", "truss.depth_m: must be above 0"},
    {2, "truss: {depht_m: 1}\n", "did you mean 'depth_m'?"},
    {2, "truss: {bud: {wall_m: 0.02}}\n", "c.yaml:3:23: truss.bud.wall_m: must not be more than half the diameter_m"},
    {2, "truss: {import: {nodes: n.csv}}\n", "truss.import.members: is missing and has no default"},
    {2, "truss: {depth_m: 1, import: {nodes: n.csv, members: m.csv}}\n",
     "truss.depth_m: has no effect beside truss.import"},
    {2, "truss: {import: {nodes: n.csv, members: m.csv}}\n", "n.csv: cannot open"},
    {4, "truss: {joints: pinned}\n", "error: truss: node '"},
    {4, "truss: {joints: pinned}\n", "without force, because the truss is a mechanism"},
};
enum { N_FAULTY = sizeof faulty / sizeof *faulty };

START_TEST(faults_of_the_section)
{
    char text[1024];
    snprintf(text, sizeof text, "%s%s", SMALL_SCENE, faulty[_i].section);
    const char *path = file_with("c.yaml", text);
    HIFDM(faulty[_i].exit_code, "run", path, NOWHERE);
    ERR(faulty[_i].says);
    HIFDM(faulty[_i].exit_code, "check", path);
    ERR(faulty[_i].says);
    ck_assert(!is_there(temp("nowhere.h5")));
}
END_TEST

/* An imported net has no modules to generate a truss over, and its supports must have attachments. */
START_TEST(imported_net)
{
    const char *path =
        net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0,support\nc,1,0.5,0.1,inner\nd,1,1.7,0,support\n",
                 "id,i,j,group,law,value\nac,a,c,inner,tension,10\nbc,b,c,inner,tension,10\ncd,c,d,inner,tension,12\n");
    HIFDM(2, "check", path, "--set", "truss.depth_m=1");
    ERR("truss: needs scene.parabolic_cylinder to be generated over, or truss.import");
    const char *nodes = file_with("tn.csv", "id,x_m,y_m,z_m,fixed\nA,0,0,0,\nB,2,0,0,\nC,1,1.6,0,\nG,1,1,-2,all\n");
    const char *members =
        file_with("m.csv", "id,i,j,E_Pa,A_m2,G_Pa,Iy_m4,Iz_m4,J_m4\n1,A,G,7e10,1e-4,3e10,1e-8,1e-8,2e-8\n"
                           "2,B,G,7e10,1e-4,3e10,1e-8,1e-8,2e-8\n3,C,G,7e10,1e-4,3e10,1e-8,1e-8,2e-8\n");
    const char *set_nodes = keep(formatted("truss.import.nodes=%s", nodes));
    const char *set_members = keep(formatted("truss.import.members=%s", members));
    HIFDM(2, "check", path, "--set", set_nodes, "--set", set_members);
    ERR("truss: net support 'd' has no attachment, because the nearest truss node 'C' is 0.1 m away");
    HIFDM(0, "check", path, "--set", set_nodes, "--set", set_members, "--set", "truss.match_tolerance_m=0.11");
    OUT("  truss         4 nodes, 3 members; 0.00 kg; 3 attachments\n");
}
END_TEST

/* At three times the pretension 0.1 m of a dish of 9 m give way, no small displacement where psi is to be zero; beside
 * the psi that form-finding's tensions leave, or at 10 N, it is small enough. */
START_TEST(a_truss_that_turns_far_is_told)
{
    const char *c = file_with(
                   "ring.yaml",
                   "scene:\n  paraboloid: {aperture_m: 9, focal_length_m: 6, offset_m: 5.5, rings: 6, rear_distance_m: "
                   "2.4}\nform: {pretension_N: 10, prestress: exact}\n"
                   "truss:\n  ring: {cells_per_bay: 2, bracing: single, held: bay}\n"),
               *out = temp("r.h5"), *variables = "optimize.variables=[{set: all, vary: force_density, range: 50 %}]";
    HIFDM(0, "run", c, "-o", out);
    ck_assert_str_eq(said.err, "");
    OUT(" cables; pretension 10 N\n"); /* nothing is optimised: no variables */
    HIFDM(0, "run", c, "-o", out, "--restart", "--set", "optimize.method=lm", "--set", variables);
    ck_assert_str_eq(said.err, "");
    EXPECT(out_as("said.txt"), out, "--",
           "('in the result by %.4f mm' % (b['refine'].attrs['coupling_deflection_max_m'] * 1e3)).encode() in a");
    HIFDM(0, "run", c, "-o", out, "--restart", "--set", "form.pretension_N=30");
    ck_assert_str_eq(said.err, "");
    HIFDM(0, "run", c, "-o", out, "--restart", "--set", "optimize.method=lm", "--set", variables, "--set",
          "form.pretension_N=30");
    ERR("warning: truss: the attachments deflect by ");
    ERR(" mm in the result, so the linear theory");
}
END_TEST

Suite *suite_cli_truss(void)
{
    Suite *suite = suite_create("cli/truss");
    TCase *tests = tcase_create("truss");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, run_show_check_and_file);
    tcase_add_test(tests, forces_in_the_truss);
    tcase_add_test(tests, a_case_without_a_truss_has_nothing_of_it);
    tcase_add_test(tests, exported_truss_can_be_imported);
    tcase_add_loop_test(tests, changed_truss_tables_are_another_case, 0, 2);
    tcase_add_loop_test(tests, faults_of_the_section, 0, N_FAULTY);
    tcase_add_test(tests, a_truss_that_turns_far_is_told);
    tcase_add_test(tests, imported_net);
    return suite;
}
