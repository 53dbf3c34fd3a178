/* `hifdm evaluate`: the tables that it reads and writes, faults in tables, and that it gives the GA's own figures. */
#include "cli.h"

#define HEADER "id,status,psi_m,residual_N,inner_tension_ratio,boundary_tension_ratio,iterations,violation,merit\n"

/* One free node on three boundary cables and one inner one. c4 joins two supports, so it is no gene. */
static const char nodes[] = "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,4,0,0,support\nc,2,3,0,support\nm,2,1,0,inner\n";
static const char cables[] = "id,i,j,group,law,value\nc1,a,m,boundary,tension,10\n\"c,2\",b,m,boundary,tension,10\n"
                             "c3,c,m,boundary,tension,9\nc4,a,b,boundary,tension,10\n";

/* Generation g of a result file as a table for `evaluate`. */
static const char *designs_of(const char *result, int generation, const char *name)
{
    static const char script[] = "import csv, h5py, sys\n"
                                 "f = h5py.File(sys.argv[1])\n"
                                 "id = [i.decode() for i in f['scene/cable/id'][:]]\n"
                                 "out = csv.writer(open(sys.argv[3], 'w', newline=''))\n"
                                 "out.writerow(['id'] + [id[e] for e in f['variable/cable'][:]])\n"
                                 "p, g = f['search/population'], int(sys.argv[2])\n"
                                 "for i, row in enumerate(p['design'][:][p['design_row'][g]]):\n"
                                 "    out.writerow(['row %d' % i] + [repr(float(t)) for t in row])\n";
    const char *path = temp(name);
    const char *const argv[] = {python_program(), "-c", script, result, keep(formatted("%d", generation)), path, NULL};
    demand_exit(run_command(HANG_S, argv), 0, "write the designs", __LINE__);
    return path;
}

static const char *const settings[] = {"optimize.generations=8", "optimize.symmetry=auto", "optimize.solver=newton"};

/* The same evaluator, start and shared matrix: the same bits. */
START_TEST(stored_designs_give_the_stored_results)
{
    const char *out = temp("c.h5"), *table = temp("r.csv");
    HIFDM(0, "run", CHEN, "-o", out, "--quiet", "--set", "optimize.generations=8", "--set", settings[_i]);
    const char *designs = designs_of(out, 7, "d.csv");
    HIFDM(0, "evaluate", CHEN, "--designs", designs, "-o", table, "--set", settings[_i], "--threads", "2");
    OUT("50 designs, 50 feasible; best psi ");
    OUT(_i == 2 ? " by newton on 2 threads; results in " : " by chord on 2 threads; results in ");
    EXPECT(out, table, "--", "[r['id'] for r in b] == ['row %d' % i for i in range(50)]",
           "{r['status'] for r in b} == {'ok'}",
           "all(column(b, n).tobytes() == a['search/population/' + n][7].tobytes() for n in ('psi_m', 'residual_N', "
           "'inner_tension_ratio', 'boundary_tension_ratio'))",
           "column(b, 'iterations').tolist() == a['search/population/iterations'][7].tolist()");
    /* without -o the table, and nothing else, goes to standard output; threads change nothing */
    HIFDM(0, "evaluate", CHEN, "--designs", designs, "--set", settings[_i], "--threads", "1");
    ck_assert(file_is(table, said.out));
}
END_TEST

START_TEST(symmetric_runs_store_who_follows_whom)
{
    const char *out = temp("s.h5"), *plain = temp("p.h5");
    HIFDM(0, "run", CHEN, "-o", out, "--json", "--set", "optimize.generations=4", "--set", "optimize.symmetry=xy");
    EXPECT(out_as("s.json"), out, "--", "a['search']['independent_variables'] == 30",
           "len(set(b['variable/leader'][:].tolist())) == 30",
           "(designs(b) == designs(b)[:, :, b['variable/leader'][:]]).all()", "designs(b).shape == (4, 50, 120)");
    HIFDM(0, "show", out, "-v");
    OUT("symmetry: planes x and y; 30 of 120 design variables are independent\n");
    HIFDM(0, "check", CHEN, "--set", "optimize.symmetry=auto");
    OUT("symmetry: auto, planes x and y; 30 independent variables of 120\n");
    HIFDM(0, "run", CHEN, "-o", plain, "--set", "optimize.generations=2");
    ck_assert_ptr_null(strstr(said.out, "symmetry"));
    EXPECT(plain, "--", "'leader' not in a['variable']");
}
END_TEST

START_TEST(a_net_without_the_symmetry_is_refused)
{
    HIFDM(2, "run", net_with(nodes, cables), NOWHERE, "--set", "optimize.symmetry=xy");
    ERR("error: --set optimize.symmetry: the net is not symmetric about the plane y = 1.5 m. 4 cables have no mirror "
        "image with the same ends, roles, loads, group, law and target: c1, c,2, c3, c4\n");
    ck_assert(!is_there(temp("nowhere.h5")));
    HIFDM(0, "check", net_with(nodes, cables), "--set", "optimize.symmetry=auto");
    OUT("symmetry: auto, plane x; 2 independent variables of 3\n");
}
END_TEST

/* Any order of columns, ids of their own or the number of the row; no optimize section, so no cap. */
START_TEST(tables_may_be_written_in_many_ways)
{
    const char *net = net_with(nodes, cables);
    HIFDM(0, "evaluate", net, "--designs", file_with("a.csv", "c3,\"c,2\",c1\n9,10,10\n# gap\n 9e-2 ,0.1,0.1\n"));
    ck_assert_str_eq(said.err, "");
    const char *first = out_as("a_out.csv");
    ck_assert_int_eq(strncmp(said.out, HEADER, strlen(HEADER)), 0);
    HIFDM(0, "evaluate", net, "--designs",
          file_with("b.csv", "c1,c3,id,\"c,2\",c_1\n.1,.09,\"second, \",.1,?\n10,9,,10,\n"));
    ck_assert_str_eq(said.err,
                     formatted("warning: %s:1: column 'c_1' is not used; did you mean 'c1'?\n", temp("b.csv")));
    EXPECT(first, out_as("b_out.csv"), "--", "[r['id'] for r in a] == ['1', '2']",
           "[r['id'] for r in b] == ['second, ', '']", "[r['status'] for r in a] == ['ok', 'ok']",
           "all(a[1 - i][k] == b[i][k] for i in (0, 1) for k in a[0] if k != 'id')",
           "float(a[1]['boundary_tension_ratio']) > 50");
}
END_TEST

/* Ids of cables that end like units of length are none. */
START_TEST(ids_have_no_units)
{
    const char *net = net_with(nodes, "id,i,j,group,law,value\nrib_m,a,m,boundary,tension,10\n"
                                      "rib_in,b,m,boundary,tension,10\nc3,c,m,boundary,tension,9\n");
    const char *table = file_with("a.csv", "rib_m,rib_in,c3\n8,9,10\n");
    HIFDM(0, "evaluate", net, "--designs", table);
    ck_assert_str_eq(said.err, "");
    const char *mistyped = file_with("b.csv", "rib_mm,rib_in,c3\n8,9,10\n");
    HIFDM(2, "evaluate", net, "--designs", mistyped);
    ERRS("error: %s:1: a column is missing: rib_m\n", mistyped);
}
END_TEST

/* With the section its cap holds: a row that breaks it is no error. */
START_TEST(infeasible_rows_are_results)
{
    const char *net = net_with(nodes, cables), *table = temp("t.csv");
    HIFDM(0, "evaluate", net, "--designs", file_with("d.csv", "c1,\"c,2\",c3\n10,10,9\n1,1,9e3\n"), "-o", table,
          "--json", "--set", "optimize.boundary_ratio_cap=5");
    EXPECT(out_as("t.json"), table, "--", "a['status'] == 'ok' and a['designs'] == 2 and a['feasible'] == 1",
           "a['best_row'] == 1 and a['best_psi_m'] == float(b[0]['psi_m'])", "a['file'].endswith('t.csv')",
           "a['warnings'] == [] and 'errors' not in a", "[r['status'] for r in b] == ['ok', 'ratio_cap']",
           "b[1]['psi_m'] == b[1]['inner_tension_ratio'] == 'nan'");
}
END_TEST

START_TEST(a_template_is_a_table_of_the_base_design)
{
    const char *path = temp("t.csv");
    HIFDM(0, "evaluate", REFLECTOR, "--template", path);
    OUT("88 adjustable cables; their tensions after form-finding in ");
    HIFDM(0, "evaluate", REFLECTOR, "--designs", path);
    const char *result = out_as("r.csv");
    HIFDM(0, "run", REFLECTOR, "-o", temp("r.h5"), "--json");
    /* the found shape is in equilibrium under its own tensions; 1e-6: it was found to a residual of 1e-6 N */
    EXPECT(result, out_as("r.json"), "--", "len(a) == 1 and a[0]['id'] == 'initial' and a[0]['status'] == 'ok'",
           "abs(float(a[0]['psi_m']) / b['form']['psi_m'] - 1) < 1e-6");
    HIFDM(5, "evaluate", REFLECTOR, "--template", path);
    ERRS("error: the file %s already exists. Use --force to replace it\n", path);
}
END_TEST

START_TEST(faults_are_told_together)
{
    const char *bad = file_with("bad.csv", "id,c1,\"c,2\",c2\nx,10,9,9\n,-1,zero,9\ny,0,1e999\nz,nan,\"\",1\n");
    HIFDM(2, "evaluate", net_with(nodes, cables), "--designs", bad);
    ck_assert_str_eq(said.out, "");
    static const char *const parts[] = {"warning: %s:1: column 'c2' is not used; did you mean",
                                        "error: %s:1: a column is missing: c3\n",
                                        "error: %s:3: '': c1 must be above zero, not -1\n",
                                        "error: %s:3: '': c,2 must be a finite number, not zero\n",
                                        "error: %s:4: 3 fields where the header has 4\n",
                                        "error: %s:5: 'z': c1 must be a finite number, not nan\n",
                                        "error: %s:5: 'z': c,2 must be a finite number, not empty\n"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        char part[1024];
        const char *gap = strstr(parts[i], "%s");
        snprintf(part, sizeof part, "%.*s%s%s", (int)(gap - parts[i]), parts[i], bad, gap + 2);
        ERR(part);
    }
    ck_assert_int_eq(count_of(said.err, "error: "), 6);
    HIFDM(2, "evaluate", net_with(nodes, cables), "--designs", temp("missing.csv"), "--json", "-o", temp("o.csv"));
    EXPECT(out_as("e.json"), "--", "a['status'] == 'bad_case' and len(a['errors']) == 1",
           "a['errors'][0].endswith('missing.csv: cannot open: No such file or directory')");
    ck_assert(!is_there(temp("o.csv")));
}
END_TEST

START_TEST(a_net_without_a_base_is_refused)
{
    const char *designs = file_with("d.csv", "c1,\"c,2\",c3\n10,10,9\n"), *net = net_with(nodes, cables);
    HIFDM(3, "evaluate", net, "--designs", designs, "-o", temp("o.csv"), "--set", "form.method=hifdm", "--set",
          "form.max_iterations=1");
    ERR("error: form-finding did not converge in 1 iteration.");
    HIFDM(4, "evaluate", CHEN, "--template", temp("o.csv"), "--set", "form.stop=residual");
    ERR("error: ill-posed: 30 straight chains");
    HIFDM(2, "evaluate", REFLECTOR, "--template", temp("o.csv"), "--set",
          "scene.parabolic_cylinder.supports=perimeter");
    ERR("no boundary cable has a free end, so the case has no design variables");
    ck_assert(!is_there(temp("o.csv")));
}
END_TEST

START_TEST(nothing_is_overwritten_unasked)
{
    const char *designs = file_with("d.csv", "c1,\"c,2\",c3\n10,10,9\n"), *net = net_with(nodes, cables);
    const char *out = file_with("o.csv", "mine");
    HIFDM(5, "evaluate", net, "--designs", designs, "-o", out);
    ERRS("error: the file %s already exists. Use --force to replace it\n", out);
    ck_assert(file_is(out, "mine"));
    HIFDM(0, "evaluate", net, "--designs", designs, "-o", out, "--force", "--quiet");
    ck_assert_str_eq(said.out, "");
    ck_assert(!file_is(out, "mine"));
    HIFDM(5, "evaluate", net, "--designs", designs, "-o", designs, "--force");
    ERR("d.csv: this file is an input of this run");
    HIFDM(5, "evaluate", net, "--designs", designs, "-o", temp("no/o.csv"));
    ERR("cannot write: No such file or directory\n");
}
END_TEST

Suite *suite_cli_evaluate_designs(void)
{
    Suite *suite = suite_create("cli/evaluate_designs");
    TCase *tcase = tcase_create("evaluate_designs");
    tcase_add_loop_test(tcase, stored_designs_give_the_stored_results, 0, 3);
    tcase_add_test(tcase, symmetric_runs_store_who_follows_whom);
    tcase_add_test(tcase, a_net_without_the_symmetry_is_refused);
    tcase_add_test(tcase, tables_may_be_written_in_many_ways);
    tcase_add_test(tcase, ids_have_no_units);
    tcase_add_test(tcase, infeasible_rows_are_results);
    tcase_add_test(tcase, a_template_is_a_table_of_the_base_design);
    tcase_add_test(tcase, faults_are_told_together);
    tcase_add_test(tcase, a_net_without_a_base_is_refused);
    tcase_add_test(tcase, nothing_is_overwritten_unasked);
    suite_add_tcase(suite, tcase);
    return suite;
}
