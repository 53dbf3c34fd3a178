/* run --point: a point of a front becomes a result like every other one. What it is made of is computed here again from
 * its shape. */
#include "cli.h"

#define NET SMALL_SCENE "  EA_inner_N: 47000\n  EA_boundary_N: 52000\n"
#define OPTIMIZE "optimize:\n  method: lm\n  front_points: 7\n"
#define PSI_AND_RATIO "  front: [{figure: psi}, {figure: ratio, set: boundary}]\n"
#define AS_BUILT                                                                                                       \
    "cables:\n  - {expansion_per_K: -2e-6}\nload_cases:\n  - {name: same, temperature_K: 0}\n"                         \
    "tolerance: {sigma_cut_m: 1e-4, samples: 200}\n"

static const char *front_of(const char *c, const char *name)
{
    const char *front = temp(name);
    HIFDM(0, "run", c, "-o", front, "--quiet");
    return front;
}

static const char *point(const char *front, int n)
{
    return keep(formatted("%s:%d", front, n));
}

START_TEST(a_point_becomes_a_result)
{
    const char *c = file_with("c.yaml", NET OPTIMIZE PSI_AND_RATIO), *front = front_of(c, "f.h5"), *path = temp("p.h5"),
               *cut = temp("cut.csv"), *table = temp("nodes"), *page = temp("p.html"), *printed;
    HIFDM(0, "show", front);
    OUT("                knee, point ");
    OUT(formatted("                to make a point the result, run the same command with --point %s:", front));
    HIFDM(0, "run", c, "--point", point(front, 3), "-o", path);
    OUT("psi ");
    OUT(formatted("  the result, point 3 of the front in %s\n", front));
    ck_assert(!strstr(said.out, "LM") && !strstr(said.out, "  front  "));
    printed = keep(said.out);
    HIFDM(0, "show", path);
    ck_assert_str_eq(said.out, printed);
    HIFDM(0, "show", path, "--verbose");
    OUT(formatted(": point 3 of the front in %s\n", front));
    HIFDM(0, "show", path, "--json");
    EXPECT(front, path, out_as("p.json"), "--", "a['front/objective'].shape == (7, 2)",
           "near(psi_m(b, b['refine/position_m'][:]), a['front/objective'][2, 0], 1e-9)",
           "near(ratio(b, b['refine/tension_N'][:], 1), a['front/objective'][2, 1], 1e-9)",
           "near(psi_m(b, b['form/position_m'][:]), a['front/initial'][0], 1e-9)",
           "np.array_equal(b['objective/refine'][:], a['front/objective'][2])",
           "np.array_equal(b['refine/design'][:], a['front/design'][2]) and 'front' not in b and 'search' not in b",
           "b['case'].attrs['front_point'] == 3 and attribute(b['case'], 'front_file') == a.filename",
           "attribute(b['case'], 'front_design_sha256') == sha256(a['front/design'][2].tobytes())",
           "c['refine']['front_point'] == 3 and c['refine']['front_file'] == a.filename",
           "c['refine']['stop_reason'] == 'taken' and c['refine']['is_result'] and c['refine']['steps'] == 0",
           "[g['value'] for g in c['refine']['objectives'].values()] == a['front/objective'][2].tolist()");
    HIFDM(0, "export", path, "--cutlist", cut, "--csv", table);
    EXPECT(path, cut, "--",
           "np.allclose([float(x['unstressed_length_m']) for x in b], a['refine/length_m'][:] / (1 + "
           "a['refine/tension_N'][:] / "
           "np.where(a['scene/cable/group'][:] == 1, 52000, 47000)), rtol=1e-12, atol=0)");
    HIFDM(0, "report", path, "-o", page);
    SHELL(0, "sed -n '/<script type=\"application.json\"/,/<\\/script>/p' \"$1\" | sed '1d;$d' >\"$2\"", page,
          temp("data.json"));
    EXPECT(temp("data.json"), "--", "a['summary']['refine']['front_point'] == 3",
           "[s['stage'] for s in a['shapes']] == ['form', 'refine']");
}
END_TEST

/* The net as built is cut for the point, not for the form-finding as beside a front: by the run, by tasks, and for
 * what was measured. */
START_TEST(what_is_built_is_built_for_the_point)
{
    const char *front = front_of(file_with("c.yaml", NET OPTIMIZE PSI_AND_RATIO), "f.h5"), *path = temp("p.h5"),
               *by_tasks = temp("t.h5"), *moves = temp("m.csv"),
               *c = file_with("d.yaml", NET OPTIMIZE PSI_AND_RATIO AS_BUILT);
    HIFDM(0, "run", c, "--point", point(front, 7), "-o", path);
    OUT("  as built      ");
    EXPECT(front, path, "--", "np.abs(b['load_cases/same/position_m'][:] - b['refine/position_m'][:]).max() < 1e-8",
           "np.abs(b['load_cases/same/position_m'][:] - b['form/position_m'][:]).max() > 1e-4",
           "near(b['load_cases/same'].attrs['psi_m'], a['front/objective'][6, 0], 1e-6)",
           "near(np.median(b['tolerance/sample/psi_m'][:]), a['front/objective'][6, 0], 0.1)");
    HIFDM(0, "tolerance", c, "--point", point(front, 7), "-o", by_tasks, "--task", "0", "--tasks", "2", "--quiet");
    HIFDM(0, "tolerance", c, "--point", point(front, 7), "-o", by_tasks, "--tasks", "2", "--quiet");
    HIFDM(0, "diff", path, by_tasks);
    HIFDM(0, "export", path, "--csv", temp("shape"));
    SHELL(0, "cut -d, -f1-4 \"$1\"/nodes.csv >\"$2\"", temp("shape"), temp("measured.csv"));
    HIFDM(0, "adjust",
          file_with("e.yaml", NET OPTIMIZE PSI_AND_RATIO AS_BUILT
                    "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, sigma_m: 1e-4}\n"),
          "--measured", temp("measured.csv"), "--result", path, "-o", moves);
    EXPECT(moves, "--", "all(abs(float(x['turnbuckle_m'])) < 1e-7 for x in a)");
}
END_TEST

/* What a front has beside its points is of none of them: run, check, summary and exports say so, once each. */
START_TEST(what_is_of_no_point_is_told)
{
    static const char beside[] =
        "a front is not a single design, so hifdm computes load cases and samples for the net after form-finding",
                      untaken[] =
                          ": no point of the Pareto front is selected, so hifdm uses the shape after form-finding, ";
    const char *c = file_with("d.yaml", NET OPTIMIZE PSI_AND_RATIO AS_BUILT), *front = temp("f.h5"),
               *path = temp("p.h5"), *cut = temp("cut.csv"), *said_at;
    HIFDM(0, "check", c);
    ERR(beside);
    HIFDM(0, "run", c, "-o", front);
    OUT("                load cases, as built: of the form-finding, not of a point of the front; a run with --point "
        "computes them for a "
        "point\n  load cases  ");
    said_at = strstr(said.err, beside);
    ck_assert(said_at && !strstr(said_at + 1, beside));
    ERRS("`hifdm run %s --point FRONT.h5:N -o point.h5`", c);
    HIFDM(0, "export", front, "--cutlist", cut, "--csv", temp("csv"));
    said_at = strstr(said.err, untaken);
    ck_assert(said_at && !strstr(said_at + 1, untaken));
    ERRS(", run `hifdm run %s --point %s:", c, front);
    HIFDM(0, "export", front, "--csv", temp("same"), "--load-case", "same");
    ERR(untaken);
    HIFDM(0, "export", front, "--cutlist", cut, "--stage", "form", "--force");
    ck_assert_str_eq(said.err, "");
    HIFDM(0, "export", front, "--vtk", temp("vtk"), "--front", temp("front.csv"));
    ck_assert_str_eq(said.err, "");
    SHELL(0, "cut -d, -f1-4 \"$1\"/nodes.csv >\"$2\"", temp("csv"), temp("measured.csv"));
    HIFDM(0, "adjust",
          file_with("e.yaml", NET OPTIMIZE PSI_AND_RATIO AS_BUILT
                    "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, sigma_m: 1e-4}\n"),
          "--measured", temp("measured.csv"), "--result", front, "-o", temp("m.csv"));
    ERR(untaken);
    HIFDM(0, "run", c, "--point", point(front, 3), "-o", path);
    ck_assert(!strstr(said.err, beside) && !strstr(said.out, "not of a point of the front"));
    HIFDM(0, "export", path, "--cutlist", cut, "--force");
    ck_assert_str_eq(said.err, "");
}
END_TEST

/* Fronts of generations, whose objectives were found by another solver, and of a net on its truss. */
START_TEST(points_of_generations_are_taken)
{
    const char *c = keep(source_path("configs/chen2022-truss.yaml")), *front = temp("f.h5"), *path = temp("p.h5");
#define GENERATIONS                                                                                                    \
    c, "--set", "optimize.generations=5", "--set", "optimize.front=[{figure: psi}, {figure: deflection}]"
    HIFDM(0, "run", GENERATIONS, "-o", front);
    HIFDM(0, "export", front, "--csv", temp("end"));
    ERR(": no point of the Pareto front is selected, so hifdm uses the end of the front with the minimum "
        "objective_0_psi. ");
    HIFDM(0, "run", GENERATIONS, "--point", point(front, 2), "-o", path);
    EXPECT(front, path, "--", "near(b['objective/refine'][0], a['front/objective'][1, 0], 1e-6)",
           "near(b['objective/refine'][1], a['front/objective'][1, 1], 1e-6)",
           "near(psi_m(b, b['refine/position_m'][:]), a['front/objective'][1, 0], 1e-6)",
           "near(np.linalg.norm(b['refine/position_m'][:][b['coupling/node'][:]] - "
           "b['scene/node/position_m'][:][b['coupling/node'][:]], axis=1).max(), a['front/objective'][1, 1], 1e-6)");
    HIFDM(0, "show", path);
    OUT(", in the result by ");
}
END_TEST

/* A finished one is known again, and nothing is taken for what it is not. */
START_TEST(a_wrong_point_is_refused)
{
    const char *c = file_with("c.yaml", NET OPTIMIZE PSI_AND_RATIO), *front = front_of(c, "f.h5"), *path = temp("p.h5"),
               *other = temp("q.h5");
    HIFDM(0, "run", c, "--point", point(front, 3), "-o", path, "--quiet");
    HIFDM(0, "run", c, "--point", point(front, 3), "-o", path, "--quiet");
    ERR(": this file is the finished result of this case. ");
    HIFDM(5, "run", c, "--point", point(front, 4), "-o", path);
    ERRS("The differences are: it has --point %s:3, and this run --point %s:4. ", front, front);
    HIFDM(5, "run", c, "-o", path);
    ERRS("The differences are: it has --point %s:3, and this run no --point. ", front);
    HIFDM(0, "run", c, "-o", front, "--set", "optimize.front_points=9", "--restart", "--quiet");
    HIFDM(5, "run", c, "--point", point(front, 3), "-o", path);
    ERRS("The differences are: it has --point %s:3, whose design is another one in the front that is there now. ",
         front);
    HIFDM(0, "run", c, "-o", front, "--restart", "--quiet");
    HIFDM(2, "run", c, "--point", point(front, 8), "-o", other);
    ERRS("error: %s: the front has points 1 to 7, but no point 8. `hifdm export %s --front FILE` lists these points\n",
         front, front);
    const char *const none[] = {front, "f.h5:", "f.h5:0", "f.h5:-1", "f.h5:1.5", ":3", "3"};
    for (int i = 0; i < 7; i++) {
        HIFDM(2, "run", c, "--point", none[i], "-o", other);
        ERRS("error: --point must be FILE:N, such as night.h5:7, not '%s'. FILE is a result with a Pareto front, and N "
             "is the number of a point\n",
             none[i]);
    }
    HIFDM(2, "run", c, "--point", point(path, 1), "-o", other);
    ERRS("error: %s: this result has no Pareto front. Use the result of a case with the list optimize.front\n", path);
    HIFDM(5, "run", c, "--point", point(temp("none.h5"), 1), "-o", other);
    HIFDM(5, "run", c, "--point", point(c, 1), "-o", other);
    ERRS("error: %s: this file is not a result of hifdm", c);
    HIFDM(5, "run", c, "--point", point(front, 3), "-o", front, "--restart");
    ERRS("error: %s: this file is an input of this run. Choose another name\n", front);
    ck_assert(!is_there(other));
}
END_TEST

/* The front of another case would give another net than its row says. */
START_TEST(a_front_of_another_case_is_refused)
{
    const char *c = file_with("c.yaml", NET OPTIMIZE PSI_AND_RATIO), *front = front_of(c, "f.h5"),
               *other = temp("q.h5");
    HIFDM(2, "run", file_with("g.yaml", NET OPTIMIZE), "--point", point(front, 3), "-o", other);
    ERRS("error: %s: the front has other objectives than %s: use the case file and the --set options of that front; "
         "different: optimize.front\n",
         front, temp("g.yaml"));
    HIFDM(2, "run", c, "--set", "optimize.front=[{figure: psi}, {figure: pull}]", "--point", point(front, 3), "-o",
          other);
    ERR(": the front has other objectives than ");
    HIFDM(2, "run", c, "--set", "optimize.variables=[{set: all, vary: force_density, range: 10 %}]", "--point",
          point(front, 3), "-o", other);
    ERR(": the front has other variables than ");
    HIFDM(2, "run", c, "--set", "form.pretension_N=11", "--point", point(front, 3), "-o", other);
    ERRS("error: %s: point 3 of the front has objective_1_ratio_boundary ", front);
    ERR(": use the case file and the --set options of that front; different: form.pretension_N\n");
    HIFDM(2, "run", file_with("b.yaml", NET OPTIMIZE PSI_AND_RATIO AS_BUILT), "--set", "form.pretension_N=11",
          "--point", point(front, 3), "-o", other);
    ERR("; different: form.pretension_N, cables\n");
    HIFDM(2, "run", c, "--set", "form.pretension_N=11", "--set", "form.collapse_ratio=2e-3", "--set",
          "form.max_iterations=99999", "--set", "form.residual_tolerance=2e-9", "--set", "form.rms_tolerance_m=2e-6",
          "--set", "form.length_tolerance=2e-9", "--set", "optimize.max_tension_N=1e5", "--set", "optimize.seed=8",
          "--set", "optimize.range_N=2", "--set", "optimize.refine_steps=199", "--point", point(front, 3), "-o", other);
    ERR("; different: form.pretension_N, form.residual_tolerance, form.length_tolerance, form.rms_tolerance_m, "
        "form.max_iterations, form.collapse_ratio, optimize.range_N, optimize.max_tension_N and 2 more\n");
    HIFDM(2, "run", c, "--set", "optimize.limits=[{figure: tension, set: boundary, bounds: [900, 901]}]", "--point",
          point(front, 3), "-o", other);
    ERRS("error: %s: point 3 of the front is not a feasible design of %s (", front, c);
    HIFDM(2, "run", c, "--set", "optimize.range_N=0.1", "--point", point(front, 3), "-o", other);
    ERRS("error: %s: point 3 of the front has ", front);
    ERRS(", but %s allows ", c);
    ck_assert(!is_there(other));
}
END_TEST

/* What is damaged in the file is told, and a design that has no shape is none. */
START_TEST(a_damaged_front_is_told)
{
    static const struct {
        const char *damage, *told;
        int code;
    } list[] = {{"f['front/design'][2] = np.nan", "is not a feasible design of ", 2},
                {"f['front/design'][2] = 0", "is not a feasible design of ", 2},
                {"f['front/objective'][2, 0] = np.nan", " has objective_0_psi nan", 2},
                {"f['front/status'][2] = 3", "failed and has no design", 2},
                {"del f['front/variable']", "/front/variable is not there", 5},
                {"f['front/mark'][2] = 1", "warning: ", 0}};
    const char *c = file_with("c.yaml", NET OPTIMIZE PSI_AND_RATIO), *front = front_of(c, "f.h5"), *path = temp("p.h5"),
               *copy = temp("g.h5");
    for (int i = 0; i < (int)(sizeof list / sizeof *list); i++) {
        SHELL(0, "cp \"$1\" \"$2\" && \"$4\" -c \"import h5py, numpy as np; f = h5py.File('$2', 'r+'); $3\"", front,
              copy, list[i].damage, python_program());
        HIFDM(list[i].code, "run", c, "--point", point(copy, 3), "-o", path, "--restart");
        ERR(list[i].told);
    }
    SHELL(0, "\"$2\" -c \"import h5py; del h5py.File('$1', 'r+')['case'].attrs['front_file']\"", path,
          python_program());
    HIFDM(0, "show", path, "--verbose"); /* taken from nowhere */
}
END_TEST

Suite *suite_cli_point(void)
{
    Suite *suite = suite_create("cli/point");
    TCase *tests = tcase_create("point");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, a_point_becomes_a_result);
    tcase_add_test(tests, what_is_built_is_built_for_the_point);
    tcase_add_test(tests, what_is_of_no_point_is_told);
    tcase_add_test(tests, points_of_generations_are_taken);
    tcase_add_test(tests, a_wrong_point_is_refused);
    tcase_add_test(tests, a_front_of_another_case_is_refused);
    tcase_add_test(tests, a_damaged_front_is_told);
    return suite;
}
