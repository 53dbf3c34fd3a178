/* The rows optimize.variables, goals and limits of a case on the surface of the program: tables of designs, summaries
 * and files. */
#include "cli.h"

/* One free node on two boundary cables and a stay whose support moves. c4 joins two supports, so it has no gene. */
static const char nodes[] =
    "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,4,0,0,support\nc,2,3,1,support\nm,1.7,1,0.3,inner\n";
static const char cables[] = "id,i,j,group,law,value,set\nc1,a,m,boundary,tension,10,edge\n"
                             "\"c,2\",b,m,boundary,tension,10,edge\nc3,c,m,boundary,tension,9,stay\n"
                             "c4,a,b,boundary,tension,10,\n";

#define VARIABLES                                                                                                      \
    "optimize.variables=[{set: edge, vary: force_density, range: 50 %}, {set: stay, vary: support_xyz, range: 0.5}]"
#define OBJECTIVES "optimize.objective=[{figure: psi}, {figure: tension, set: edge, target: 9, weight: 0.1}]"

/* ---- hifdm evaluate ---- */

START_TEST(a_template_has_a_column_for_each_variable)
{
    const char *net = net_with(nodes, cables), *path = temp("t.csv");
    HIFDM(0, "evaluate", net, "--template", path, "--set", VARIABLES);
    OUT("5 variables; their values after form-finding in ");
    EXPECT(path, "--", "list(a[0]) == ['id', 'c1', 'c,2', 'c.x', 'c.y', 'c.z']", "len(a) == 1",
           "[a[0][k] for k in ('id', 'c.x', 'c.y', 'c.z')] == ['initial', '0', '0', '0']",
           "3 < float(a[0]['c1']) < 6"); /* N/m of a cable of about 2 m with 10 N */
    HIFDM(0, "evaluate", net, "--template", path, "--force", "--set",
          "optimize.variables=[{set: edge, vary: length, range: 0.1}]");
    EXPECT(path, "--", "list(a[0]) == ['id', 'c1', 'c,2']", "1 < float(a[0]['c1']) < 3");
}
END_TEST

/* The node is the mean of its three neighbours, weighted by the force densities. */
START_TEST(variables_and_objectives_of_any_kind_are_evaluated)
{
    const char *net = net_with(nodes, cables), *table = temp("r.csv");
    const char *designs = file_with("d.csv", "c.z,c1,\"c,2\",c.y,id,c.x,c3\n-.5,4,5,-1e-1,low,0,3\n.25,4,4,0,,.1,3\n");
    HIFDM(
        0, "evaluate", net, "--designs", designs, "-o", table, "--set",
        "optimize.variables=[{set: edge, vary: force_density, range: 50 %}, {set: stay, vary: support_xyz, range: 1}, "
        "{set: stay, vary: force_density, range: 90 %}]",
        "--set", OBJECTIVES);
    OUT("2 designs, 2 feasible; best merit ");
#define HELD "held(q, [[0, 0, 0], [4, 0, 0], c])"
#define EACH "for r, q, c in zip(a, ([4, 5, 3], [4, 4, 3]), ([2, 2.9, .5], [2.1, 3, 1.25])))"
    EXPECT(table, "--", "list(a[0])[-4:] == ['violation', 'merit', 'objective_0_psi', 'objective_1_tension_edge']",
           "[r['id'] for r in a] == ['low', '']",
           "all(near(float(r['objective_0_psi']), np.linalg.norm(" HELD "[0] - [1.7, 1, .3]), 1e-14) " EACH,
           "all(near(float(r['objective_1_tension_edge']), np.sqrt(np.mean((" HELD "[1][:2] - 9)**2)), 1e-14) " EACH,
           "all(near(float(r['merit'])**2, float(r['objective_0_psi'])**2 + (float(r['objective_1_tension_edge']) / "
           "10)**2, "
           "1e-14) for r in a)",
           "all(r['psi_m'] == r['objective_0_psi'] for r in a)");
}
END_TEST

/* The best is that of the least merit; without a shape there are no goals, beyond a limit there are. */
START_TEST(the_best_is_that_of_the_merit)
{
    const char *net = net_with(nodes, cables), *table = temp("r.csv");
    HIFDM(0, "evaluate", net, "--designs", file_with("d.csv", "c1,\"c,2\"\n4.5,3.5\n5.5,5.5\n2,2\n"), "-o", table,
          "--json", "--set", "optimize.variables=[{set: edge, vary: force_density, range: 50 %}]", "--set",
          "optimize.objective=[{figure: psi, weight: 1e-9}, {figure: tension, set: edge, target: 12}]", "--set",
          "optimize.limits=[{figure: tension, set: edge, bounds: [7, 30]}]");
    EXPECT(out_as("r.json"), table, "--", "a['best_row'] == 2 and float(b[0]['psi_m']) < float(b[1]['psi_m'])",
           "a['best_merit'] == float(b[1]['merit']) < float(b[0]['merit'])",
           "a['best_objectives'] == {k: float(b[1][k]) for k in ('objective_0_psi', 'objective_1_tension_edge')}",
           "a['best_psi_m'] == float(b[1]['psi_m'])", "b[2]['status'] == 'out_of_limits'",
           "b[2]['merit'] == b[2]['psi_m'] == 'nan' and near(float(b[2]['objective_1_tension_edge']), 5.9792, 1e-4)");
}
END_TEST

/* Objectives are weighed by whoever asks: their values are those of the same goals, and there is no merit of them. */
START_TEST(objectives_are_evaluated_without_a_merit)
{
    const char *net = net_with(nodes, cables), *table = temp("r.csv"), *slopes = temp("j.csv");
    const char *designs = file_with("d.csv", "c1,\"c,2\"\n4.5,3.5\n5.5,5.5\n");
    const char *edge = "optimize.variables=[{set: edge, vary: force_density, range: 50 %}]";
    HIFDM(0, "evaluate", net, "--designs", designs, "-o", table, "--jacobian", slopes, "--json", "--set", edge, "--set",
          "optimize.front=[{figure: psi}, {figure: tension, set: edge, target: 12}]", "--set", "optimize.method=lm");
    const char *json = out_as("r.json"), *objectives = temp("g.csv"), *objective_slopes = temp("gj.csv");
    HIFDM(0, "evaluate", net, "--designs", designs, "-o", objectives, "--jacobian", objective_slopes, "--set", edge,
          "--set", "optimize.objective=[{figure: psi}, {figure: tension, set: edge, target: 12}]");
    EXPECT(table, objectives, json, "--",
           "list(a[0])[-3:] == ['violation', 'objective_0_psi', 'objective_1_tension_edge']",
           "'merit' not in a[0] and [{k: r[k] for k in a[0]} for r in b] == a and 'merit' in b[0]",
           "c['feasible'] == 2 and not [k for k in c if k.startswith('best')]");
    EXPECT(slopes, objective_slopes, "--",
           "[r['figure'] for r in a] == ['objective_0_psi', 'objective_1_tension_edge'] * 2",
           "a == [r for r in b if r['figure'] != 'merit'] and len(b) == 6");
    HIFDM(0, "evaluate", net, "--designs", designs, "-o", table, "--force", "--set", edge, "--set",
          "optimize.front=[{figure: psi}, {figure: tension, set: edge, target: 12}]", "--set", "optimize.method=lm");
    OUT("2 designs, 2 feasible; ");
}
END_TEST

START_TEST(values_of_cables_are_above_zero)
{
    const char *bad = file_with("d.csv", "c1,\"c,2\",c.x,c.y,c.z\n4,-4,-1,0,-0.0\n4,4,one,0,0\n0,4,0,0,0\n");
    HIFDM(2, "evaluate", net_with(nodes, cables), "--designs", bad, "--set", VARIABLES);
    ERRS("error: %s:2: c,2 must be above zero, not -4\n", bad);
    ERRS("error: %s:3: c.x must be a finite number, not one\n", bad);
    ERRS("error: %s:4: c1 must be above zero, not 0\n", bad);
    ck_assert_int_eq(count_of(said.err, "error: "), 3);
}
END_TEST

START_TEST(a_cable_called_like_a_variable_of_a_support_is_refused)
{
    HIFDM(2, "evaluate",
          net_with(nodes, "id,i,j,group,law,value,set\nc1,a,m,boundary,tension,10,edge\n"
                          "c.y,b,m,boundary,tension,10,edge\nc3,c,m,boundary,tension,9,stay\n"),
          "--template", temp("t.csv"), "--set", VARIABLES);
    ERR("error: optimize.variables: cable 'c.y' has the same name as a design variable of a support. Rename the "
        "cable\n");
    ck_assert(!is_there(temp("t.csv")));
}
END_TEST

/* The answer stays as it was; the derivatives are those of its own figures. c.x is linked to nothing, c1 to c,2. */
START_TEST(derivatives_come_beside_the_results)
{
    const char *net = net_with(nodes, cables), *table = temp("r.csv"), *slopes = temp("j.csv");
    const char *designs =
        file_with("d.csv", "id,c1,\"c,2\",c.x,c.y,c.z\nat,4,5,0,.1,0\nup,4.0001,5,0,.1,0\ndown,3.9999,5,0,.1,0\n"
                           "right,4,5,1e-4,.1,0\nleft,4,5,-1e-4,.1,0\nfar,4,5,0,0,1e300\n");
    HIFDM(
        0, "evaluate", net, "--designs", designs, "-o", table, "--jacobian", slopes, "--json", "--set",
        "optimize.variables=[{set: edge, vary: force_density, range: 50 %, link: set}, {set: stay, vary: support_xyz, "
        "range: 0.5}]",
        "--set", OBJECTIVES, "--set", "form.residual_tolerance=1e-13");
#define SLOPE(figure, up, down, variable)                                                                              \
    "near(float(next(r for r in b if r['id'] == 'at' and r['figure'] == '" figure "')['" variable "']), (lambda of: "  \
    "(float(of['" up "']['" figure "']) - float(of['" down "']['" figure                                               \
    "'])) / 2e-4)({r['id']: r for r in a}), 1e-7)"
    EXPECT(table, slopes, out_as("r.json"), "--", "list(b[0]) == ['id', 'figure', 'c1', 'c,2', 'c.x', 'c.y', 'c.z']",
           "[r['figure'] for r in b] == ['objective_0_psi', 'objective_1_tension_edge', 'merit'] * 5",
           "[r['id'] for r in b[::3]] == ['at', 'up', 'down', 'right', 'left'] and a[5]['status'] != 'ok'",
           SLOPE("objective_0_psi", "up", "down", "c1"), SLOPE("objective_1_tension_edge", "up", "down", "c1"),
           SLOPE("merit", "up", "down", "c1"), SLOPE("merit", "right", "left", "c.x"),
           SLOPE("objective_1_tension_edge", "right", "left", "c.x"), "c['jacobian'].endswith('j.csv')");
    HIFDM(0, "evaluate", net, "--designs", file_with("e.csv", "c1,\"c,2\",c3\n10,10,9\n"), "--jacobian", slopes,
          "--force");
    EXPECT(slopes, "--", "[list(r.values())[:2] for r in a] == [['1', 'psi_m']]",
           "list(a[0])[2:] == ['c1', 'c,2', 'c3']");
}
END_TEST

/* The table of residuals, beside that of derivatives: the gradients of the figures follow from it. A design beyond a
 * limit has rows, one without a shape has none. */
START_TEST(residuals_come_beside_the_results)
{
    const char *net = net_with(nodes, cables), *table = temp("r.csv"), *slopes = temp("j.csv"), *rows = temp("f.csv");
    const char *designs =
        file_with("d.csv", "id,c1,\"c,2\",c.x,c.y,c.z\nat,4,5,0,.1,0\nfar,4,5,0,0,1e300\nlow,2,2,0,0,0\n");
    HIFDM(0, "evaluate", net, "--designs", designs, "-o", table, "--jacobian", slopes, "--residuals", rows, "--json",
          "--set", VARIABLES, "--set", OBJECTIVES, "--set",
          "optimize.limits=[{figure: tension, set: edge, bounds: [7, 30]}]");
#define ROWS(id, block) "[r for r in c if r['id'] == '" id "' and r['block'] == '" block "']"
    EXPECT(
        table, slopes, rows, out_as("r.json"), "--", "[r['status'] for r in a][::2] == ['ok', 'out_of_limits']",
        "list(c[0]) == ['id', 'block', 'row', 'value', 'c1', 'c,2', 'c.x', 'c.y', 'c.z']",
        "{r['id'] for r in c} == {'at', 'low'} and a[1]['status'] != 'ok'", "d['residuals'].endswith('f.csv')",
        "[r['row'] for r in " ROWS(
            "at", "position_m") "] == [n + x for n in ('a', 'b', 'c', 'm') for x in ('.x', '.y', '.z')]",
        "[r['row'] for r in " ROWS("low", "tension_N") "][:2] == ['c1', 'c,2']",
        "near(sum(float(r['value'])**2 for r in c if r['id'] == 'at' and r['block'][:9] == 'objective')**.5, "
        "float(a[0]['merit']), 1e-9)",
        "near(sum(float(r['value']) * float(r['c1']) for r in c if r['id'] == 'at' and r['block'][:9] == 'objective'), "
        "float(a[0]['merit']) * float(next(r for r in b if r['figure'] == 'merit')['c1']), 1e-9)");
    HIFDM(2, "evaluate", net, "--template", temp("t.csv"), "--residuals", rows);
    ERR("error: the option --residuals needs --designs FILE\n");
    HIFDM(2, "evaluate", net, "--designs", designs, "--jacobian", slopes, "--residuals", slopes);
    ERR("error: the options --residuals and --jacobian must name different files\n");
    HIFDM(2, "evaluate", net, "--designs", designs, "-o", rows, "--residuals", rows);
    ERR("error: the options --residuals and -o must name different files\n");
    HIFDM(5, "evaluate", net, "--designs", designs, "--residuals", rows);
    ERRS("error: the file %s already exists. Use --force to replace it\n", rows);
    rows = temp("seeded.csv");
    HIFDM(2, "evaluate", net, "--designs", file_with("e.csv", "c1,\"c,2\",c3\n10,10,9\n"), "--residuals", rows, "--set",
          "optimize.rule=seeded");
    ERR("error: there are no derivatives under optimize.rule seeded\n");
    ck_assert(!is_there(rows));
}
END_TEST

START_TEST(derivatives_are_refused_where_there_are_none)
{
    const char *net = net_with(nodes, cables), *designs = file_with("d.csv", "c1,\"c,2\",c3\n10,10,9\n");
    const char *slopes = temp("j.csv");
    HIFDM(2, "evaluate", net, "--designs", designs, "--jacobian", slopes, "--set", "optimize.rule=seeded");
    ERR("error: there are no derivatives under optimize.rule seeded\n");
    ck_assert(!is_there(slopes));
    HIFDM(2, "evaluate", net, "--template", temp("t.csv"), "--jacobian", slopes);
    ERR("error: the option --jacobian needs --designs FILE\n");
    HIFDM(2, "evaluate", net, "--designs", designs, "-o", slopes, "--jacobian", slopes);
    ERR("error: the options --jacobian and -o must name different files\n");
    const char *table = temp("r.csv"), *other = temp("./r.csv");
    HIFDM(2, "evaluate", net, "--designs", designs, "-o", table, "--jacobian", other);
    ERR("error: the options --jacobian and -o must name different files\n");
    SHELL(0, "cp \"$1\" \"$2\" && ln -s r.csv \"$3\"", designs, table, temp("link.csv"));
    other = temp("link.csv");
    HIFDM(5, "evaluate", net, "--designs", designs, "-o", table, "--jacobian", other, "--force");
    ERR("link.csv: this file is the table of results. Choose another name\n");
    HIFDM(5, "evaluate", net, "--designs", designs, "--jacobian", designs, "--force");
    ERR("d.csv: this file is an input of this run");
}
END_TEST

/* ---- hifdm run and show ---- */

START_TEST(runs_tell_what_became_of_each_objective)
{
    const char *net = net_with(nodes, cables), *out = temp("r.h5");
    HIFDM(0, "run", net, "-o", out, "--json", "--set", VARIABLES, "--set", OBJECTIVES, "--set", "optimize.method=ga+lm",
          "--set", "optimize.generations=4", "--set", "optimize.population=8", "--set", "optimize.elites=2");
    const char *json = out_as("r.json");
    EXPECT(
        json, out, "--",
        "[list(a[s]['objectives']) for s in ('form', 'search', 'refine')] == "
        "[['objective_0_psi', 'objective_1_tension_edge']] * 3",
        "texts(b['objective/name']) == list(a['form']['objectives']) and b['objective/weight'][:].tolist() == [1, .1]",
        "all([g['value'] for g in a[s]['objectives'].values()] == b['objective'][s][:].tolist() for s in ('form', "
        "'search', "
        "'refine'))",
        "all(near(a[s]['merit'], np.linalg.norm([g['value'] * g['weight'] for g in a[s]['objectives'].values()]), "
        "1e-14) "
        "for s in ('form', 'search', 'refine'))",
        "a['form']['objectives']['objective_0_psi']['value'] == a['form']['psi_m']", /* before: of the found shape */
        "a['form']['merit'] > a['search']['merit'] >= a['refine']['merit'] > 0",
        "a['search']['merit'] == b['search/population/best_merit'][-1]");
    HIFDM(0, "show", out);
    OUT("ratio inside         merit  at bounds");
    /* before and after, in their units; psi, which is wanted too, is not told once more */
    EXPECT(json, file_with("show.txt", said.out), "--",
           "b.decode().startswith('psi %.4f -> %.4f mm, tension_edge %.4g -> %.4g N (form-finding -> result); 1 dB "
           "gain loss at ' % tuple(x for g, by in "
           "(('objective_0_psi', 1e3), ('objective_1_tension_edge', 1)) for x in (by * "
           "a['form']['objectives'][g]['value'], by * "
           "a['refine']['objectives'][g]['value'])))");
    ck_assert_int_eq(count_of(said.out, "                merit 0."), 1); /* the result's, with its goals */
    HIFDM(0, "show", out, "--verbose");
    OUT(" 4 cables, 5 design variables; ");
    OUT(" (weight 1), objective_1_tension_edge ");
    OUT(" (weight 0.1)\n");
    ck_assert_int_eq(count_of(said.out, "                merit 0."), 4);
    HIFDM(0, "report", out, "-o", temp("r.html")); /* its page has the object of --json */
    EXPECT(temp("r.html"), "--", "a.count(b'\"objective_1_tension_edge\": {\"value\": ') == 3");
    HIFDM(0, "show", out, "--json");
    EXPECT(json, out_as("s.json"), "--",
           "all(a[s]['objectives'] == b[s]['objectives'] and a[s]['merit'] == b[s]['merit'] for s in "
           "('form', 'search', 'refine'))");
    HIFDM(0, "run", net, "-o", out, "--restart", "--json", "--set", VARIABLES, "--set", "optimize.method=lm");
    EXPECT(out_as("p.json"), out, "--",
           "'objectives' not in a['form'] and 'merit' not in a['refine'] and 'objectives' not in b");
}
END_TEST

START_TEST(objectives_of_damaged_files_are_not_shown)
{
    static const char *const deed[] = {"f['objective/name'][0] = b'\\x1b[1m'", "del f['objective/refine']",
                                       "del f['objective/weight']; f['objective/weight'] = np.ones(17)"};
    static const char *const why[] = {"/objective/name does not name objectives", "/objective/refine is not there",
                                      "/objective/weight has other dimensions"};
    const char *out = temp("r.h5");
    HIFDM(0, "run", net_with(nodes, cables), "-o", out, "--set", VARIABLES, "--set", OBJECTIVES, "--set",
          "optimize.method=lm");
    const char *script =
        keep(formatted("import h5py, sys, numpy as np\nf = h5py.File(sys.argv[1], 'a')\n%s", deed[_i]));
    const char *const argv[] = {python_program(), "-c", script, out, NULL};
    demand_exit(run_command(HANG_S, argv), 0, deed[_i], __LINE__);
    HIFDM(5, "show", out);
    ERR(why[_i]);
}
END_TEST

/* The edge wants 12 N, and may have 11; or its force densities may not rise so far. */
#define PULLED "optimize.objective=[{figure: tension, set: edge, target: 12}]"
#define EDGE(range) "optimize.variables=[{set: edge, vary: force_density, range: " range "}]"

START_TEST(what_holds_a_design_has_names)
{
    const char *net = net_with(nodes, cables), *out = temp("r.h5");
    HIFDM(0, "run", net, "-o", out, "--json", "--set", EDGE("50 %"), "--set", PULLED, "--set",
          "optimize.limits=[{figure: tension, set: stay, bounds: [1, null]}, {figure: tension, set: edge, bounds: "
          "[null, 11]}, {figure: ratio, set: edge, bounds: [1, 1.5]}]",
          "--set", "optimize.method=lm");
    const char *json = out_as("r.json");
    EXPECT(json, out, "--", "[(h['row'], h['count'], h['bound']) for h in a['refine']['at_limits']] == [(1, 2, 11)]",
           "a['refine']['at_limits'][0]['name'] in ('tension of cable c1', 'tension of cable c,2')",
           "all(11 - 1e-7 < h['value'] <= 11 for h in a['refine']['at_limits'])",
           "all([h[k] for h in a['refine']['at_limits']] == b['at_limit/refine'][k][:].tolist() for k in ('row', "
           "'count', 'bound', 'value'))",
           "texts(b['at_limit/refine/name']) == [h['name'] for h in a['refine']['at_limits']]");
    HIFDM(0, "show", out);
    OUT("                at a limit (optimize.limits.1): tension of cable c");
    OUT(" and 1 more at 11\n");
    HIFDM(0, "show", out, "--json");
    EXPECT(json, out_as("s.json"), "--", "a['refine'] == b['refine']");
    HIFDM(0, "run", net, "-o", out, "--restart", "--json", "--set", EDGE("1 %"), "--set", PULLED, "--set",
          "optimize.generations=30");
    EXPECT(out_as("g.json"), out, "--", "a['search']['at_lower_bound'] + a['search']['at_upper_bound'] == 2",
           "'at_limits' not in a['search'] and 'at_limit' not in b",
           "attribute(b['search'], 'n_at_upper') == a['search']['at_upper_bound'] == 2");
    HIFDM(0, "show", out, "-v");
    OUT("                0 of 2 design variables at their lower bounds, 2 at their upper bounds\n");
}
END_TEST

START_TEST(a_limit_that_nothing_keeps_has_a_name)
{
    static const char *const method[] = {"optimize.method=lm", "optimize.method=ga"};
    static const char *const begin[] = {"has no feasible start: ", "exceed optimize.limits or "};
    HIFDM(3, "run", net_with(nodes, cables), "-o", temp("r.h5"), "--set", EDGE("1 %"), "--set", PULLED, "--set",
          "optimize.limits=[{figure: tension, set: edge, bounds: [5, 100]}, {figure: tension, set: stay, bounds: [50, "
          "60]}]",
          "--set", method[_i], "--set", "optimize.generations=3");
    ERR(begin[_i]);
    ERR(" tension of cable c3 is 9, but the bound of optimize.limits.1 is 50");
}
END_TEST

/* ---- what no variable changes ---- */

/* Two nets; only the first, which hangs between c1, c2 and c3, is varied. d4 is slack. */
static const char two_nets[] =
    "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,4,0,0,support\nc,2,3,1,support\nm,1.7,1,0.3,inner\n"
    "d,10,0,0,support\ne,12,0,0,support\nf,11,2,0,support\ng,11,3,0,support\nn,11,0.5,0.2,edge\n";
static const char two_cables[] =
    "id,i,j,group,law,value,set,EA_N\nc1,a,m,boundary,tension,10,edge,\nc2,b,m,boundary,tension,10,edge,\n"
    "c3,c,m,boundary,tension,9,stay,\nd1,d,n,inner,tension,10,far,\nd2,e,n,inner,tension,11,far,\n"
    "d3,f,n,inner,force_density,9,far,\nd4,g,n,inner,elastic,9,loose,1000\n";

START_TEST(rows_that_no_variable_reaches_are_named)
{
    net_with(two_nets, two_cables);
    const char *path = file_with("two.yaml", "scene:\n"
                                             "  import: {nodes: nodes.csv, cables: cables.csv}\n"
                                             "optimize:\n"
                                             "  method: lm\n"
                                             "  variables:\n"
                                             "    - {set: edge, vary: force_density, range: 50 %}\n"
                                             "    - {set: loose, vary: unstressed_length, range: 10 %}\n"
                                             "  objective:\n"
                                             "    - {figure: mass, set: far, mass_kg_per_m: 0.1}\n"
                                             "    - {figure: tension, set: stay, target: 3}\n"
                                             "    - {figure: psi}\n"
                                             "    - {figure: pull}\n"
                                             "    - {figure: mass, set: stay, mass_kg_per_m: 0.1, weight: 0.1}\n"
                                             "  limits:\n"
                                             "    - {figure: tension, set: all, bounds: [null, 90]}\n"
                                             "    - {figure: ratio, set: far, bounds: [1, 5]}\n");
    HIFDM(0, "run", path, "-o", temp("two.h5"));
    ERRS("warning: %s:7:7: optimize.variables.1: this row has no effect at the initial design, because its "
         "cables, or the cables at its supports, are slack\n",
         path);
    ERRS("warning: %s:9:7: optimize.objective.0: no design variable of this case changes objective_0_mass_far: all of "
         "its "
         "cables keep their lengths\n",
         path);
    ERRS("warning: %s:10:7: optimize.objective.1: no design variable of this case changes objective_1_tension_stay: "
         "all of "
         "its cables keep their tensions\n",
         path);
    ERRS("warning: %s:16:7: optimize.limits.1: no design variable of this case changes the limited quantity: all of "
         "its cables keep their tensions\n",
         path);
    ck_assert_int_eq(count_of(said.err, "no design variable of this case"), 3);
    EXPECT(temp("two.h5"), "--", "attribute(a, 'warnings').count('no design variable of this case') == 3",
           "np.allclose(a['objective/form'][:2], a['objective/refine'][:2], rtol=1e-12)",
           "all(a['objective/form'][i] != a['objective/refine'][i] for i in (2, 4))");
}
END_TEST

START_TEST(nothing_is_sought_that_no_variable_reaches)
{
    static const char *const want[] = {
        "optimize.objective=[{figure: length, set: far, target: 1}, {figure: evenness, set: far}]",
        "optimize.front=[{figure: psi}, {figure: mass, set: far, mass_kg_per_m: 1}]",
        "optimize.variables=[{set: far, vary: tension, range: 1}]"};
    static const char *const why[] = {
        ("error: --set optimize.objective.0: no design variable of this case changes objective_0_length_far: all of "
         "its cables keep their lengths. Add a design variable that changes this objective, or remove the "
         "objective\nerror: --set optimize.objective.1: no design variable of this case changes "
         "objective_1_evenness_far: all of its cables keep their tensions. Add a design variable that changes this "
         "objective, or remove the objective\n"),
        ("error: --set optimize.front.1: no design variable of this case changes objective_1_mass_far: all of its "
         "cables keep their lengths. Add a design variable that changes this objective, or remove the objective\n"),
        ("error: --set optimize.variables.0: no design variable of this case changes psi: none of its nodes moves. Add "
         "a design variable that changes psi, or use another objective in the list optimize.objective\n")};
    static const char *const command[] = {"run", "check"};
    const char *net = net_with(two_nets, two_cables), *out = temp("none.h5");
    for (int k = 0; k < 2; k++) {
        const char *const argv[] = {hifdm_program(),      command[k],      net,      "--set",
                                    EDGE("50 %"),         "--set",         want[_i], "--set",
                                    "optimize.method=lm", k ? NULL : "-o", out,      NULL};
        demand_exit(run_command(HANG_S, argv), 2, command[k], __LINE__);
        ERR(why[_i]);
        ck_assert(!is_there(out));
    }
}
END_TEST

/* At a flat net no height of a support changes a length, to first order; a little beside it does. */
START_TEST(a_objective_that_stands_still_at_one_point_is_no_fault)
{
    const char *flat = net_with("id,x_m,y_m,z_m,role\na,-1,0,0,support\nb,1,0,0,support\nc,0,1,0,support\n"
                                "d,0,-1,0,support\nm,0,0,0,inner\n",
                                "id,i,j,group,law,value\nma,m,a,boundary,tension,10\nmb,m,b,boundary,tension,10\n"
                                "mc,m,c,boundary,tension,10\nmd,m,d,boundary,tension,10\n");
    HIFDM(0, "check", flat, "--set", "optimize.variables=[{set: all, vary: support_z, range: 0.1}]", "--set",
          "optimize.objective=[{figure: mass, mass_kg_per_m: 1}]");
    ck_assert(!strstr(said.err, "no design variable"));
}
END_TEST

/* With force densities a support that moves along z takes the node along z only. */
START_TEST(a_move_along_z_counts)
{
    HIFDM(0, "check",
          net_with("id,x_m,y_m,z_m,role\na,-1,0,0,support\nb,1,0,0,support\nc,0,1,0,support\nd,0,-1,0,support\n"
                   "m,0,0,0.1,inner\n",
                   "id,i,j,group,law,value\nma,m,a,boundary,force_density,10\nmb,m,b,boundary,force_density,10\n"
                   "mc,m,c,boundary,force_density,10\nmd,m,d,boundary,force_density,10\n"),
          "--set", "optimize.variables=[{set: all, vary: support_z, range: 0.1}]", "--set",
          "optimize.objective=[{figure: psi}]");
    ck_assert(!strstr(said.err, "no design variable"));
}
END_TEST

/* The ends of the cable in the middle move by as much, in opposite directions. */
START_TEST(ends_that_move_apart_lengthen_a_cable)
{
    HIFDM(0, "check",
          net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,3,0,0,support\nm,1,0,0,inner\nn,2,0,0,inner\n",
                   "id,i,j,group,law,value,set\nam,a,m,boundary,force_density,10,\n"
                   "mn,m,n,inner,force_density,10,middle\nnb,n,b,boundary,force_density,10,\n"),
          "--set", "optimize.variables=[{set: middle, vary: force_density, range: 10 %}]", "--set",
          "optimize.objective=[{figure: length, set: middle, target: 1.1}]");
    ck_assert(!strstr(said.err, "no design variable"));
}
END_TEST

/* A design that a cap refuses of which its author knows nothing: c4 holds the ratio at 22 whatever the others do. */
START_TEST(a_cap_that_the_case_does_not_give_is_told_as_the_default)
{
    static const char *const how[] = {"optimize.method=lm", "optimize.method=ga",
                                      "optimize.front=[{figure: psi}, {figure: evenness, set: edge}]",
                                      "optimize.limits=[{figure: tension, set: stay, bounds: [1, 90]}]"};
    static const char *const what[] = {
        ": at the nearest design, the boundary tension ratio exceeds optimize.boundary_ratio_cap: ratio of cable c4 to "
        "c3 is 22.2222, but the "
        "bound of boundary_ratio_cap is 10",
        " are above boundary_ratio_cap 10. The nearest design has the ratio 22.22. Raise optimize.boundary_ratio_cap, "
        "or widen "
        "the ranges and bounds of optimize.variables",
        "",
        " ratio of cable c4 to c3 is 22.2222, but the bound of boundary_ratio_cap is 10. Loosen the limits, or widen "};
    const char *hint =
        "; 10 is the default of optimize.boundary_ratio_cap: if the net may have a larger ratio, set this key in the "
        "case\n";
    const char *net = net_with(nodes, "id,i,j,group,law,value,set\nc1,a,m,boundary,tension,10,edge\n"
                                      "\"c,2\",b,m,boundary,tension,10,edge\nc3,c,m,boundary,tension,9,stay\n"
                                      "c4,a,b,boundary,tension,200,\n");
    const char *method = _i == 2 ? "optimize.method=lm" : how[0 + (_i > 0)];
    HIFDM(3, "run", net, "-o", temp("r.h5"), "--set", EDGE("1 %"), "--set", method, "--set", how[_i], "--set",
          "optimize.generations=3");
    ERR(what[_i]);
    ERR(hint);
    HIFDM(3, "run", net, "-o", temp("r.h5"), "--restart", "--set", EDGE("1 %"), "--set", method, "--set", how[_i],
          "--set", "optimize.generations=3", "--set", "optimize.boundary_ratio_cap=11");
    ck_assert(!strstr(said.err, "default"));
}
END_TEST

START_TEST(check_names_variables_objectives_and_limits)
{
    const char *net = net_with(nodes, cables);
    HIFDM(0, "check", net, "--set", EDGE("1 %"), "--set", PULLED, "--set",
          "optimize.limits=[{figure: tension, set: edge, bounds: [5, 100]}]");
    OUT("                variables.0: force_density of edge: 2 in N/m, range 1 %\n");
    OUT("                objective.0: tension of edge, target ");
    OUT("                limits.0: tension of edge, bounds 5 .. 100\n");
    OUT("                boundary_ratio_cap 10 (the default)\n");
    HIFDM(0, "check", net, "--set", "optimize.boundary_ratio_cap=6");
    OUT("                boundary_ratio_cap 6\n");
}
END_TEST

/* ---- the gain ---- */

/* Two bands. What the goals lose the far field, which is summed otherwise, has less, but for 2e-4 dB that the optimum
 * changes of the area. */
START_TEST(the_gain_is_a_objective)
{
#define BANDS                                                                                                          \
    "--set", "surface.frequencies_Hz=[1e9, 2e9]", "--set", "surface.pattern.theta_deg=[-2, 2]", "--set",               \
        "optimize.objective=[{figure: gain}, {figure: gain, frequency_Hz: 1e9, weight: 0.5}]"
#define LOST(stage, objective) "(1 - a['" stage "']['objectives']['" objective "']['value']**2)"
#define GAIN(stage, cut) "a['" stage "']['pattern'][" cut "]['gain_dBi']"
#define SAME(objective, cut)                                                                                           \
    "near(" GAIN("refine", cut) " - " GAIN("form", cut) ", 10 * np.log10(" LOST("refine", objective) " / " LOST(       \
        "form", objective) "), 3e-4)"
    const char *designs = temp("d.csv"), *table = temp("r.csv"), *slopes = temp("j.csv");
    HIFDM(0, "run", CHEN, "-o", temp("g.h5"), "--json", "--set", "optimize.method=lm", BANDS);
    EXPECT(out_as("run.json"), "--", SAME("objective_0_gain", "2"), SAME("objective_1_gain", "0"),
           GAIN("refine", "2") " > 0.008 + " GAIN("form", "2"),
           "near(a['refine']['merit']**2, a['refine']['objectives']['objective_0_gain']['value']**2 + "
           "a['refine']['objectives']['objective_1_gain']['value']**2 / 4, 1e-15)");
    HIFDM(0, "check", CHEN, BANDS);
    OUT("                objective.0: gain at 2 GHz, weight 1\n");
    OUT("                objective.1: gain at 1 GHz, weight 0.5\n");
    HIFDM(0, "evaluate", CHEN, "--template", designs, BANDS);
    HIFDM(0, "evaluate", CHEN, "--designs", designs, "-o", table, "--jacobian", slopes, BANDS);
    EXPECT(table, slopes, "--", "[r['figure'] for r in b] == ['objective_0_gain', 'objective_1_gain', 'merit']",
           "all(float(r['n0_0-n0_1']) != 0 for r in b)",
           "0 < float(a[0]['objective_1_gain']) < float(a[0]['objective_0_gain'])");
    HIFDM(2, "check", CHEN, "--set", "surface.frequencies_Hz=[1e9]", "--set", "optimize.objective=[{figure: gain}]");
    ERR("error: --set optimize.objective.0: gain: needs a section surface.pattern with the feed of the "
        "reflector\n");
    HIFDM(2, "check", CHEN, BANDS, "--set", "optimize.objective.1.frequency_Hz=3e11");
    ERR("optimize.objective.1: gain: its facets are too coarse for this frequency");
}
END_TEST

Suite *suite_cli_rows(void)
{
    Suite *suite = suite_create("cli/rows");
    TCase *tests = tcase_create("rows");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, a_template_has_a_column_for_each_variable);
    tcase_add_test(tests, variables_and_objectives_of_any_kind_are_evaluated);
    tcase_add_test(tests, the_best_is_that_of_the_merit);
    tcase_add_test(tests, objectives_are_evaluated_without_a_merit);
    tcase_add_test(tests, values_of_cables_are_above_zero);
    tcase_add_test(tests, a_cable_called_like_a_variable_of_a_support_is_refused);
    tcase_add_test(tests, derivatives_come_beside_the_results);
    tcase_add_test(tests, residuals_come_beside_the_results);
    tcase_add_test(tests, derivatives_are_refused_where_there_are_none);
    tcase_add_test(tests, runs_tell_what_became_of_each_objective);
    tcase_add_loop_test(tests, objectives_of_damaged_files_are_not_shown, 0, 3);
    tcase_add_test(tests, what_holds_a_design_has_names);
    tcase_add_test(tests, check_names_variables_objectives_and_limits);
    tcase_add_test(tests, the_gain_is_a_objective);
    tcase_add_test(tests, rows_that_no_variable_reaches_are_named);
    tcase_add_loop_test(tests, nothing_is_sought_that_no_variable_reaches, 0, 3);
    tcase_add_test(tests, a_objective_that_stands_still_at_one_point_is_no_fault);
    tcase_add_test(tests, a_move_along_z_counts);
    tcase_add_test(tests, ends_that_move_apart_lengthen_a_cable);
    tcase_add_loop_test(tests, a_cap_that_the_case_does_not_give_is_told_as_the_default, 0, 4);
    tcase_add_loop_test(tests, a_limit_that_nothing_keeps_has_a_name, 0, 2);
    return suite;
}
