/* `hifdm export`: the columns of the two CSV files, their numbers bit by bit, and the way back in. */
#include "cli.h"

#define NODES_HEADER "id,x_m,y_m,z_m,x0_m,y0_m,z0_m,role\n"
#define CABLES_HEADER "id,i,j,group,law,length_m,tension_N,q_N_per_m,set\n"

static const char *run_once(void)
{
    const char *out = temp("c.h5");
    HIFDM(0, "run", CHEN, "-o", out, "--quiet", "--set", "optimize.generations=3");
    return out;
}

static void demand_first_line(const char *path, const char *line)
{
    char *text = read_file(path, NULL);
    ck_assert_msg(strncmp(text, line, strlen(line)) == 0, "%s: %.80s", path, text);
    free(text);
}

static void demand_values_of(const char *out, const char *folder, const char *stage)
{
    const char *nodes = keep(formatted("%s/nodes.csv", folder)), *cables = keep(formatted("%s/cables.csv", folder));
    demand_first_line(nodes, NODES_HEADER);
    demand_first_line(cables, CABLES_HEADER);
    EXPECT(out, nodes, cables, stage, "--", "len(b) == 121", "len(c) == 220",
           "column(b, 'x_m', 'y_m', 'z_m').tobytes() == a[d.decode()]['position_m'][:].tobytes()",
           "column(b, 'x0_m', 'y0_m', 'z0_m').tobytes() == a['scene/node/position_m'][:].tobytes()",
           "all(column(c, n).tobytes() == a[d.decode()][n][:].tobytes() for n in ('length_m', 'tension_N', "
           "'q_N_per_m'))",
           "[r['id'] for r in b] == texts(a['scene/node/id'])", "[r['id'] for r in c] == texts(a['scene/cable/id'])",
           "[(r['i'], r['j']) for r in c] == [(b[i]['id'], b[j]['id']) for i, j in a['scene/cable/end'][:]]",
           "[['support', 'inner', 'edge'].index(r['role']) for r in b] == a['scene/node/role'][:].tolist()",
           "[['inner', 'boundary'].index(r['group']) for r in c] == a['scene/cable/group'][:].tolist()",
           "[['tension', 'length', 'force_density'].index(r['law']) for r in c] == a[d.decode()]['law'][:].tolist()");
}

/* Read back as double they are the stored numbers, which 17 significant digits guarantee and 16 do not. */
START_TEST(csv_holds_the_stored_numbers)
{
    const char *out = run_once();
    HIFDM(0, "export", out, "--csv", temp("best"));
    OUT("121 nodes and 220 cables of the refinement shape in ");
    demand_values_of(out, temp("best"), file_with("stage", "refine"));
    HIFDM(0, "export", out, "--csv", temp("form"), "--stage", "form");
    OUT("form-finding shape");
    demand_values_of(out, temp("form"), file_with("stage", "form"));
    HIFDM(0, "export", out, "--csv", temp("opt"), "--stage", "refine");
    SHELL(0, "diff -r \"$1\" \"$2\"", temp("best"), temp("opt"));
    SHELL(1, "cmp -s \"$1\"/nodes.csv \"$2\"/nodes.csv", temp("best"), temp("form"));
    SHELL(0, "ls -A \"$1\" | tr '\\n' ' '", temp("best"));
    ck_assert_str_eq(said.out, "cables.csv nodes.csv "); /* and nothing temporary */
}
END_TEST

/* The found shape is the classical one for its force densities, so a user who names these `value` and sets the law gets
 * it again; 1e-11 m: roundings of positions of a few metres, times the condition of a band of 85 unknowns. */
START_TEST(exported_shape_can_be_imported)
{
    const char *out = run_once(), *back = temp("back.h5"), *folder = temp("net");
    HIFDM(0, "export", out, "--csv", folder, "--stage", "form");
    SHELL(0, "cd \"$1\" && sed -i -E -e '1s/q_N_per_m/value/' -e 's/,(tension|length),/,force_density,/' cables.csv",
          folder);
    const char *path = file_with("back.yaml", "scene:\n  import: {nodes: net/nodes.csv, cables: net/cables.csv}\n");
    HIFDM(0, "run", path, "-o", back, "--quiet");
    ck_assert_str_eq(said.err, ""); /* the columns that are not used are the program's own */
    EXPECT(out, back, "--", "np.abs(a['form/position_m'][:] - b['form/position_m'][:]).max() < 1e-11",
           "np.allclose(a['form/tension_N'], b['form/tension_N'], rtol=1e-10)",
           "psi_m(b, b['form/position_m'][:]) < 1e-11", "(a['form/q_N_per_m'][:] == b['form/q_N_per_m'][:]).all()");
}
END_TEST

/* Quotes, commas, blanks at the ends, a '#' in front, letters beyond ASCII. */
START_TEST(odd_ids_survive_the_round_trip)
{
    static const char nodes[] = "id,x_m,y_m,z_m,role\n"
                                "\"#1, \"\"west\"\"\",0,0,0,support\n"
                                "\" b \",2,0,0,support\n"
                                "Knoten-\xc3\xa9\xe4\xb8\xad,1,0.5,0.1,inner\n"
                                "\"c,\",1,1.7,0,support\n";
    static const char cables[] = "id,i,j,group,law,value\n"
                                 "\"\"\"1\"\"\",\"#1, \"\"west\"\"\",Knoten-\xc3\xa9\xe4\xb8\xad,inner,tension,10\n"
                                 "2;3,\" b \",Knoten-\xc3\xa9\xe4\xb8\xad,inner,tension,10\n"
                                 "\" \",Knoten-\xc3\xa9\xe4\xb8\xad,\"c,\",boundary,tension,12\n";
    HIFDM(0, "run", net_with(nodes, cables), "-o", temp("odd.h5"));
    HIFDM(0, "export", temp("odd.h5"), "--csv", temp("odd"));
    EXPECT(
        temp("odd.h5"), temp("odd/nodes.csv"), temp("odd/cables.csv"), "--",
        "[r['id'] for r in b] == texts(a['scene/node/id']) == ['#1, \"west\"', ' b ', 'Knoten-\\u00e9\\u4e2d', 'c,']",
        "[r['id'] for r in c] == texts(a['scene/cable/id']) == ['\"1\"', '2;3', ' ']", "c[0]['i'] == '#1, \"west\"'");
    SHELL(0, "cd \"$1\" && sed -i -e '1s/tension_N/value/' cables.csv", temp("odd"));
    const char *path = file_with("again.yaml", "scene:\n  import: {nodes: odd/nodes.csv, cables: odd/cables.csv}\n");
    HIFDM(0, "run", path, "-o", temp("again.h5"));
    EXPECT(temp("odd.h5"), temp("again.h5"), "--", "texts(a['scene/node/id']) == texts(b['scene/node/id'])",
           "(a['scene/cable/end'][:] == b['scene/cable/end'][:]).all()");
}
END_TEST

/* Sets of cables: what check counts, the result file holds, and the table that is written reads back as. */
START_TEST(sets_survive_the_round_trip)
{
    const char *nodes = "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0.1,0,inner\nc,2,0,0,support\nd,1,2,0,support\n";
    const char *cables = "id,i,j,group,law,value,set\nab,a,b,inner,tension,10,tie;front\nbc,b,c,inner,tension,10,\n"
                         "bd,b,d,boundary,tension,12,front\n";
    const char *path = net_with(nodes, cables);
    HIFDM(0, "check", path);
    OUT("                sets: 2 inner, 1 boundary, 2 front, 1 tie\n");
    HIFDM(0, "run", path, "-o", temp("sets.h5"));
    HIFDM(0, "export", temp("sets.h5"), "--csv", temp("sets"));
    EXPECT(temp("sets.h5"), temp("sets/cables.csv"), "--", "[r['set'] for r in b] == ['front tie', '', 'front']",
           "texts(a['scene/set/name']) == ['front', 'tie']", "a['scene/set/start'][:].tolist() == [0, 2, 3]",
           "a['scene/set/cable'][:].tolist() == [0, 2, 0]");
    SHELL(0, "cd \"$1\" && sed -i -e '1s/tension_N/value/' cables.csv", temp("sets"));
    const char *again = file_with("again.yaml", "scene:\n  import: {nodes: sets/nodes.csv, cables: sets/cables.csv}\n");
    HIFDM(0, "run", again, "-o", temp("again.h5"));
    EXPECT(temp("sets.h5"), temp("again.h5"), "--", "texts(b['scene/set/name']) == ['front', 'tie']",
           "all((a['scene/set'][k][:] == b['scene/set'][k][:]).all() for k in ('start', 'cable'))");
}
END_TEST

START_TEST(existing_csv_is_not_replaced)
{
    const char *out = run_once(), *nodes = temp("mine/nodes.csv"), *cables = temp("mine/cables.csv");
    HIFDM(0, "export", out, "--csv", temp("mine"));
    write_file(nodes, "mine");
    HIFDM(5, "export", out, "--csv", temp("mine"));
    ERRS("error: the file %s already exists. Use --force to replace it", nodes);
    ck_assert(file_is(nodes, "mine"));
    HIFDM(0, "export", out, "--csv", temp("mine"), "--force");
    demand_first_line(nodes, NODES_HEADER);
    /* neither of the two is written when one cannot be: a new nodes.csv would not belong to the old cables.csv */
    write_file(cables, "mine");
    ck_assert_int_eq(unlink(nodes), 0);
    HIFDM(5, "export", out, "--csv", temp("mine"));
    ERRS("error: the file %s already exists. Use --force to replace it", cables);
    ck_assert(file_is(cables, "mine"));
    ck_assert(!is_there(nodes));
}
END_TEST

START_TEST(what_cannot_be_exported_is_told)
{
    const char *form_only = temp("f.h5"), *csv = temp("csv");
    HIFDM(0, "run", file_with("f.yaml", SMALL_SCENE), "-o", form_only, "--quiet");
    HIFDM(2, "export", form_only, "--csv", csv, "--stage", "search");
    ERR("this run has no search shape. Use --stage form");
    HIFDM(2, "export", form_only, "--vtk", temp("no_vtk"), "--cutlist", temp("no.csv"));
    ERR("error: "); /* refused as a whole: no folder is left for what was not written */
    ck_assert(!is_there(temp("no_vtk")) && !is_there(temp("no.csv")));
    const char *lm = temp("lm.h5");
    HIFDM(0, "run", file_with("lm.yaml", SMALL_SCENE "optimize: {method: lm}\n"), "-o", lm, "--quiet");
    HIFDM(2, "export", lm, "--csv", csv, "--stage", "search");
    ERR("this run has no search shape. Use --stage refine");
    HIFDM(2, "export", form_only);
    ERR("error: 'hifdm export' needs --csv DIR, --vtk DIR, --cutlist FILE, --front FILE, --pattern FILE or --rf DIR\n");
    HIFDM(2, "export", form_only, "--csv", csv, "--stage", "best");
    ERR("error: --stage must be form, search or refine, not 'best'\n");
    HIFDM(5, "export", temp("missing.h5"), "--csv", csv);
    ERR("missing.h5: cannot open: No such file or directory");
    HIFDM(5, "export", REFLECTOR, "--csv", csv);
    ERR("reflector.yaml: this file is not a result of hifdm");
    ck_assert(!is_there(csv));
    HIFDM(5, "export", form_only, "--csv", temp("no/such/folder"));
    ERR("no/such/folder: cannot create this folder: No such file or directory");
    HIFDM(5, "export", form_only, "--csv", form_only); /* below an ordinary file */
    ERR("f.h5/nodes.csv");
    ERR("Not a directory");
}
END_TEST

/* A mesh that outweighs its cables has no shape: nothing flat stands in for it, and no reason but this is given. */
START_TEST(a_mesh_without_shape_is_not_exported)
{
    const char *out = temp("h.h5"), *rf = temp("rf");
    HIFDM(0, "run",
          file_with("h.yaml", SMALL_SCENE "surface: {mesh_tension_N_per_m: 500, frequencies_Hz: [1e10], pattern: "
                                          "{n_theta: 11, feed: {cos_power: 1}}}\n"),
          "-o", out);
    ERR("so hifdm reports neither facet errors nor a far field");
    OUT("gain loss at 10 GHz: - dB for a refocused feed, - dB for a fixed feed (Ruze)");
    HIFDM(2, "export", out, "--rf", rf);
    ERR("pillows of the form-finding shape are unknown, because the mesh pulls on a cable");
    ck_assert(!is_there(rf));
    HIFDM(2, "export", out, "--pattern", temp("p.csv"));
    ERR("this shape has no far field, because the mesh pulls on a cable");
    ck_assert(!is_there(temp("p.csv")));
}
END_TEST

/* Facets are written as a table, and a case that names this table has the same ones and the same errors. A table with
 * fewer leaves the others out; a wrong one is refused by its line. */
START_TEST(facets_are_written_and_named)
{
    const char *out = temp("f.h5"), *folder = temp("net"), *again = temp("again.h5");
    HIFDM(0, "run", keep(source_path("configs/reflector.yaml")), "-o", out, "--quiet");
    HIFDM(0, "export", out, "--csv", folder);
    const char *path = file_with("net/case.yaml", "scene: {import: {nodes: nodes.csv, cables: cut.csv, facets: "
                                                  "facets.csv}}\nsurface: {focal_length_m: 7.2}\n"
                                                  "form: {method: fdm}\n");
    SHELL(0,
          "cd \"$1\" && sed -E '1s/.*/id,i,j,group,law,value/; 1!s/,(tension|length),.*,([^,]*),[^,]*$/,force_density,"
          "\\2/' cables.csv >cut.csv && head -1 facets.csv && wc -l <facets.csv",
          folder);
    OUT("id,a,b,c,d\n");
    HIFDM(0, "run", path, "-o", again, "--quiet");
    EXPECT(out, again, "--", "a['surface/form'].attrs['n_facet'] == b['surface/form'].attrs['n_facet'] == 480",
           "'facet' not in a['scene'] and b['scene/facet'].shape == (480, 4)",
           "near(a['surface/form'].attrs['facet_normal_rms_m'], b['surface/form'].attrs['facet_normal_rms_m'], 1e-9)");
    SHELL(0, "cd \"$1\" && head -3 facets.csv >two.csv", folder);
    HIFDM(0, "run", path, "-o", again, "--quiet", "--force", "--set",
          formatted("scene.import.facets=%s", temp("net/two.csv")));
    EXPECT(again, "--", "a['surface/form'].attrs['n_facet'] == 2");
    SHELL(0, "cd \"$1\" && echo 'wrong,n0_0,n1_0,n1_2,' >>two.csv", folder);
    HIFDM(2, "check", path, "--set", formatted("scene.import.facets=%s", temp("net/two.csv")));
    ERR("two.csv:4: 'wrong': no cable joins its nodes ");
    HIFDM(2, "check", path, "--set", "scene.import.facets=none.csv");
    ERR("none.csv: ");
}
END_TEST

Suite *suite_cli_export(void)
{
    Suite *suite = suite_create("cli/export");
    TCase *tcase = tcase_create("export");
    tcase_add_test(tcase, csv_holds_the_stored_numbers);
    tcase_add_test(tcase, exported_shape_can_be_imported);
    tcase_add_test(tcase, odd_ids_survive_the_round_trip);
    tcase_add_test(tcase, sets_survive_the_round_trip);
    tcase_add_test(tcase, existing_csv_is_not_replaced);
    tcase_add_test(tcase, what_cannot_be_exported_is_told);
    tcase_add_test(tcase, a_mesh_without_shape_is_not_exported);
    tcase_add_test(tcase, facets_are_written_and_named);
    suite_add_tcase(suite, tcase);
    return suite;
}
