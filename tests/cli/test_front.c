/* Fronts of optimize.front on the surface of the program: summary, JSON, file, table, and what is refused. */
#include "session.h"

#define FRONT                                                                                                          \
    keep(source_path("configs/chen2022.yaml")), "--set", "optimize.method=lm", "--set",                                \
        "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}]", "--set", "optimize.front_points=7"

START_TEST(a_front_is_printed_stored_and_told)
{
    const char *file = temp("f.h5"), *printed, *json;
    HIFDM(0, "run", FRONT, "-o", file);
    ck_assert_int_eq(
        strncmp(said.out, "Pareto front of 7 points: minimum psi 4.2834 mm, minimum ratio_boundary 4.56\n", 77), 0);
    OUT("  front         7 points, 0 dominated, 0 failed, 1 not converged; ");
    OUT("; slope: change of objective_0_psi in mm per unit of objective_1_ratio_boundary\n");
    OUT("                objectives objective_0_psi 6.60003 mm, objective_1_ratio_boundary 4.84161\n");
    ck_assert(!strstr(said.out, "merit") && !strstr(said.out, "weight") && !strstr(said.out, " writes all"));
    OUT("                initial         objective_0_psi 6.60003 mm, objective_1_ratio_boundary 4.84161\n");
    OUT("                end, point 1    objective_0_psi 4.28338 mm, objective_1_ratio_boundary 5.23668; slope 0\n");
    OUT("                end, point 7    objective_0_psi 11.6996 mm, objective_1_ratio_boundary 4.55962; not "
        "converged\n");
    OUT("                knee, point 4   objective_0_psi ");
    printed = keep(said.out);
    HIFDM(0, "show", file);
    ck_assert_str_eq(said.out, printed);
    EXPECT(
        file_with("s.txt", printed), file, "--",
        "('knee, point 4   objective_0_psi %.6g mm, objective_1_ratio_boundary %.6g; slope %.4g\\n' % (1e3 * "
        "b['front/objective'][3, 0], b['front/objective'][3, 1], -1e3 * b['front/multiplier'][3, 1])) in a.decode()");
    HIFDM(0, "show", file, "--json");
    json = out_as("s.json");
    EXPECT(file, json, "--", "b['front']['n_point'] == 7 and b['front']['minimised'] == 'objective_0_psi'",
           "b['front']['n_listed'] == 7 and [p['id'] for p in b['front']['points']] == [1, 2, 3, 4, 5, 6, 7]",
           "'merit' not in b['form'] and 'weight' not in b['form']['objectives']['objective_0_psi']",
           "'weight' not in a['objective']",
           "[p['objective']['objective_0_psi'] for p in b['front']['points']] == list(a['front/objective'][:, 0])",
           "[p['multiplier']['objective_1_ratio_boundary'] for p in b['front']['points']][:6] == "
           "list(a['front/multiplier'][:6, 1])",
           "b['front']['points'][6]['multiplier']['objective_1_ratio_boundary'] is None",
           "all(p['mark'] == 'on' and p['status'] == 'ok' for p in b['front']['points'])",
           "list(b['front']['initial'].values()) == list(a['front/initial'])",
           "b['front']['knee'] == a['front'].attrs['knee']",
           "a['front/design'].shape == (7, 74) and a['front/design'].attrs['units'] == 'N'",
           "np.all(np.diff(a['front/objective'][:, 0]) > 0) and np.all(np.diff(a['front/objective'][:, 1]) < 0)");
}
END_TEST

#define ROWS                                                                                                           \
    "--set", "cables=[{expansion_per_K: 1e-5}]", "--set", "load_cases=[{name: cold, temperature_K: -20}]", "--set",    \
        "requirements=[{figure: psi, at_most: 5.2e-3, search: off}, {figure: tension, set: boundary, at_least: 9.6, "  \
        "search: off}, {figure: slack_cables, at_most: 0, load_case: all, search: off}]"

/* The points of a front have the verdicts that runs of these points have. A point that fails is not the first one while
 * another passes. A point that fails, or has not converged, does not become a result without a warning. */
START_TEST(points_of_a_front_have_verdicts)
{
    const char *file = temp("f.h5"), *point = temp("p.h5"), *json;
    HIFDM(0, "run", FRONT, ROWS, "-o", file, "--verbose");
    OUT("verdict: pass; 4 of 7 points of the front pass, 3 fail; point ");
    OUT("  net after form-finding: fail; 2 of 3 requirements pass, 1 fails\n");
    OUT("; fails 1 of 3; not converged\n");
    OUT("; passes\n");
    OUT("; requirements: 4 pass, 3 fail, 0 undecided; ");
    OUT("                first, point ");
    HIFDM(0, "show", file, "--json");
    json = out_as("s.json");
    EXPECT(file, json, "--", "(a['front/requirements'][:] == 3).all()",
           "(a['front/requirements_undecided'][:] == 0).all()",
           "(a['front/requirements_failed'][:] == (a['front/objective'][:, 0] > 5.2e-3)).all()",
           "[p['verdict'] for p in b['front']['points']] == ['fail' if k else 'pass' for k in "
           "a['front/requirements_failed'][:]]",
           "b['front']['n_pass'] == sum(a['front/requirements_failed'][:] == 0) and b['front']['n_pass'] + "
           "b['front']['n_fail'] == 7",
           "[p['relative_margin_min'] for p in b['front']['points']] == list(a['front/relative_margin_min'][:])",
           "b['front']['first'] == 1 + np.argmax(a['front/relative_margin_min'][:])");
    for (int i = 1; i <= 7; i += 3) { /* an end, the knee, and the other end, which has not converged */
        HIFDM(0, "run", FRONT, ROWS, "--point", formatted("%s:%d", file, i), "-o", point, "--restart");
        ck_assert(!strstr(said.err, "fails 1 of 3 requirements, but point ") == (i < 7));
        ck_assert(!strstr(said.err, "point 7 of the front has not converged, so better designs exist near it") ==
                  (i < 7));
        EXPECT(file, point, file_with("i", formatted("%d", i - 1)), "--",
               "sum(b['requirements/verdict'][:] == b'fail') == a['front/requirements_failed'][int(c)]",
               "near(np.nanmin(b['requirements/relative_margin'][:]), a['front/relative_margin_min'][int(c)], 1e-9)");
    }
    HIFDM(0, "export", file, "--front", temp("f.csv"));
    EXPECT(temp("f.csv"), file, "--",
           "list(a[0])[4:9] == ['converged', 'requirements_failed', 'requirements_undecided', 'relative_margin_min', "
           "'objective_0_psi']",
           "[int(r['requirements_failed']) for r in a] == list(b['front/requirements_failed'][:])");
}
END_TEST

/* NSGA-II judges its points, too. */
START_TEST(generations_have_verdicts)
{
    const char *file = temp("f.h5");
    HIFDM(0, "run", keep(source_path("configs/chen2022.yaml")), "--set",
          "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}]", "--set", "optimize.generations=40", "--set",
          "optimize.population=20", "--set", "tolerance.samples=100", "--set", "tolerance.sigma_cut_m=1e-4", "--set",
          "requirements=[{figure: psi, at_most: 5.5e-3, search: off}]", "-o", file, "--verbose");
    OUT("  minimum psi, NSGA-II: ");
    ck_assert(!strstr(said.out, "the result, NSGA"));
    EXPECT(file, "--", "(a['front/requirements'][:] == 1).all()",
           "(a['front/requirements_failed'][:] == (a['front/objective'][:, 0] > 5.5e-3)).all()",
           "0 < sum(a['front/requirements_failed'][:]) < 20");
}
END_TEST

/* Rows with a share have the verdicts that the samples of runs of these points have. A point that meets the row about
 * the nominal net fails in its samples. */
START_TEST(points_of_a_front_are_judged_by_samples)
{
#define SHARES                                                                                                         \
    "--set", "tolerance.samples=120", "--set", "tolerance.sigma_cut_m=2e-4", "--set",                                  \
        "requirements=[{figure: psi, at_most: 6.6e-3, share: 0.8, search: off}, "                                      \
        "{figure: psi, at_most: 8.5e-3, search: off}]"
    const char *file = temp("f.h5"), *point = temp("p.h5");
    HIFDM(0, "run", FRONT, SHARES, "-o", file, "--strict");
    OUT("verdict: pass; ");
    ck_assert(!strstr(said.out, "as built")); /* of the net after form-finding, which is no point */
    HIFDM(0, "show", file, "--json");
    EXPECT(file, out_as("s.json"), "--", "(a['front/requirements'][:] == 2).all()", "b['verdict'] == 'pass'",
           "0 < b['front']['n_pass'] < 7", "b['front']['n_fail'] > 0",
           "sum(a['front/requirements_failed'][:] > 0) > sum(a['front/objective'][:, 0] > 8.5e-3)",
           "b['front']['points'][b['front']['first'] - 1]['verdict'] == 'pass'");
    for (int i = 1; i <= 7; i++) {
        HIFDM(0, "run", FRONT, SHARES, "--point", formatted("%s:%d", file, i), "-o", point, "--restart");
        EXPECT(file, point, file_with("i", formatted("%d", i - 1)), "--",
               "sum(b['requirements/verdict'][:] == b'fail') == a['front/requirements_failed'][int(c)]",
               "sum(b['requirements/verdict'][:] == b'undecided') == a['front/requirements_undecided'][int(c)]",
               "near(np.nanmin(b['requirements/relative_margin'][:]), a['front/relative_margin_min'][int(c)], 1e-6)");
    }
    HIFDM(0, "check", FRONT, SHARES);
    OUT("\n                verdicts of up to 7 points of the front by samples: about ");
    HIFDM(6, "run", FRONT, SHARES, "-o", file, "--restart", "--strict", "--set", "requirements.0.at_most=1e-3");
    ERR("every point of the front fails a requirement; point ");
    OUT("verdict: fail; 0 of 7 points of the front pass, 7 fail; point ");
}
END_TEST

static bool says_tolerance(const char *err)
{
    return says(err, "{\"phase\": \"tolerance\"");
}

/* A session that is interrupted while it judges the points keeps the front, and the next one only judges it. */
START_TEST(a_front_survives_an_interrupt_while_it_is_judged)
{
#define MANY FRONT, SHARES, "--set", "tolerance.samples=1500", "--progress", "jsonl", "-o"
    const char *path = temp("f.h5"), *whole = temp("whole.h5");
    const char *const argv[] = {hifdm_program(), "run", MANY, path, NULL};
    session s = start_program(argv);
    ck_assert(wait_until(&s, says_tolerance, temp("err")));
    ck_assert_int_eq(end_by(&s, SIGTERM), 75);
    ck_assert(says(temp("err"), "the run was interrupted while it judged the points of the front, which are stored"));
    HIFDM(0, "show", path);
    OUT("unfinished: Pareto front of 7 points: minimum psi 4.2834 mm");
    HIFDM(0, "run", MANY, path);
    ck_assert(!strstr(said.err, "\"phase\": \"refine\""));
    HIFDM(0, "run", MANY, whole);
    ck_assert(strstr(said.err, "\"phase\": \"refine\""));
    HIFDM(0, "diff", path, whole);
    OUT(", 0 differ");
}
END_TEST

/* Points that are done grow from none to all; each has the steps that the file tells, and others lead to them. */
START_TEST(a_front_says_how_far_it_is)
{
    const char *file = temp("f.h5");
    HIFDM(0, "run", FRONT, "-o", file, "--progress", "jsonl");
    ERR("{\"phase\": \"form\"}\n{\"phase\": \"refine\", \"point\": 0, \"points\": 7, \"steps\": 0, \"elapsed_s\": ");
    EXPECT(
        file_with("said.txt", said.err), file, "--",
        "(lambda said: said[-1]['point'] == said[-1]['points'] == 7 and said[-1]['steps'] >= "
        "sum(b['front/steps'][:]) and all(p['point'] <= q['point'] and p['steps'] <= q['steps'] and "
        "p['elapsed_s'] <= q['elapsed_s'] for p, q in zip(said, said[1:])))([__import__('json').loads(line) for line "
        "in a.decode().splitlines() if 'points' in line and line[0] == '{'])");
    HIFDM(0, "run", FRONT, "-o", file, "--restart", "--progress", "line");
    ERR("\r\033[Kfront: point 0/7  0 steps of Levenberg-Marquardt  ");
    HIFDM(0, "run", FRONT, "-o", file, "--restart", "--progress", "log");
    ck_assert(!strstr(said.err, "front: point")); /* shorter than 30 s */
}
END_TEST

/* Where the second objective is the least one the slope is its change, by the first. */
START_TEST(a_slope_says_of_what_it_is)
{
    HIFDM(0, "run", FRONT, "--set", "optimize.front=[{figure: ratio, set: boundary}, {figure: psi}]", "-o",
          temp("f.h5"));
    OUT("; slope: change of objective_1_psi in mm per unit of objective_0_ratio_boundary\n");
}
END_TEST

/* psi can be met, where its size has no slope: the evenness beside it is the least that two goals find together. */
START_TEST(the_least_beside_an_objective_that_is_met)
{
#define MET                                                                                                            \
    "scene:\n  paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 3, rear_distance_m: 1.8}\n"                       \
    "form: {pretension_N: 10}\noptimize:\n  method: lm\n"                                                              \
    "  variables: [{set: all, vary: force_density, range: 50 %}]\n"
    const char *front = temp("f.h5"), *both = temp("b.h5");
    HIFDM(0, "run",
          file_with("f.yaml", MET "  front: [{figure: psi}, {figure: evenness, set: all}]\n  front_points: 5\n"), "-o",
          front, "--quiet");
    HIFDM(0, "run",
          file_with("b.yaml", MET "  objective: [{figure: psi}, {figure: evenness, set: all, weight: 1e-4}]\n"), "-o",
          both, "--quiet");
    EXPECT(front, both, "--", "a['front/objective'][0, 0] < 2e-6 * a['front/objective'][-1, 0]",
           "near(a['front/objective'][0, 1], b['objective/refine'][1], 1e-3)",
           "a['front/objective'][0, 1] < 0.95 * b['objective/form'][1]",
           "np.isnan(a['front/multiplier'][0]).all()"); /* its limit is none of the front */
}
END_TEST

/* psi and the distance from the surface are nothing at one design, and so are the lengths of the ties: what differs
 * between such designs is rounding, and no front. With evenness beside them there is one. */
START_TEST(objectives_that_do_not_conflict_are_told)
{
#define TWO MET "surface: {focal_length_m: 3}\n"
    static const char *const objectives[] = {
        "optimize.front=[{figure: psi}, {figure: surface}]",
        "optimize.front=[{figure: psi}, {figure: length, set: tie}]",
        "optimize.front=[{figure: psi}, {figure: length, set: tie}, {figure: evenness, set: front}]"};
    const char *c = file_with("c.yaml", TWO), *front = temp("f.h5"), *page = temp("f.html");
    for (int i = 0; i < 3; i++) {
        HIFDM(0, "run", c, "--set", objectives[i], "-o", front, "--restart");
        ck_assert_int_eq(strncmp(said.out, "one design is best in all objectives: psi 0.0000 mm, ", 53), 0);
        OUT("  front         the objectives do not conflict: one design is best in all of them\n");
        OUT("                best, point 1   objective_0_psi ");
        ck_assert(!strstr(said.out, "slope") && !strstr(said.out, " end, "));
        EXPECT(front, "--", "a['front/status'].shape == (1,)",
               "np.all(a['front/objective'][0, :2] < [1e-5 * a['front/initial'][0], 1e-8])",
               "np.isnan(a['front/multiplier'][:]).all() and a['front'].attrs['knee'] == -1");
    }
    HIFDM(0, "report", front, "-o", page);
    HIFDM(0, "run", c, "--set", "optimize.front=[{figure: psi}, {figure: evenness, set: all}]", "--set",
          "optimize.front_points=3", "-o", front, "--restart");
    ck_assert(!strstr(said.out, "conflict"));
    OUT(" end, point 3    ");
}
END_TEST

/* Of three objectives an end that is met has the least of the others beside it, as two goals find it. */
START_TEST(the_least_beside_a_third_objective_that_is_met)
{
    const char *front = temp("f.h5"), *both = temp("b.h5");
    HIFDM(0, "run",
          file_with("f.yaml", MET "  front: [{figure: evenness, set: all}, {figure: tension, set: tie, target: 10}, "
                                  "{figure: psi}]\n  front_points: 6\n"),
          "-o", front, "--quiet");
    for (int i = 0; i < 2; i++) {
        HIFDM(0, "run",
              file_with("b.yaml",
                        i ? MET "  objective: [{figure: psi}, {figure: tension, set: tie, target: 10, weight: 1e-6}]\n"
                          : MET "  objective: [{figure: psi}, {figure: evenness, set: all, weight: 1e-4}]\n"),
              "-o", both, "--quiet", "--restart");
        EXPECT(
            front, both, "--",
            keep(formatted("near(min(p[%d] for p in a['front/objective'][:] if p[2] < 1e-6), b['objective/refine'][1], "
                           "1e-3)",
                           i)));
    }
}
END_TEST

/* More points than are listed: the ends and the knee are those of all. */
START_TEST(a_front_of_many_points_is_thinned)
{
    const char *file = temp("f.h5"), *json, *page = temp("f.html"), *data = temp("data.json");
    HIFDM(0, "run", FRONT, "--set", "optimize.method=ga", "--set",
          "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}, {figure: pull}]", "--set",
          "optimize.generations=20", "--set", "optimize.population=700", "--set", "optimize.store=best", "-o", file,
          "--json");
    json = out_as("r.json");
    HIFDM(0, "show", file);
    OUT("                --json and the report show 512 of 700 points; hifdm export --front writes all\n");
    HIFDM(0, "show", file, "--json");
    EXPECT(file, json, out_as("s.json"), "--", "b['front'] == c['front'] and b['front']['n_point'] == 700",
           "len(b['front']['points']) == b['front']['n_listed'] == 512",
           "all(list(p['objective'].values()) == a['front/objective'][p['id'] - 1].tolist() for p in "
           "b['front']['points'])",
           "[min(p['objective'][k] for p in b['front']['points']) for k in b['front']['initial']] == "
           "a['front/objective'][:].min(axis=0).tolist()",
           "b['front']['points'][b['front']['knee']]['id'] - 1 == a['front'].attrs['knee']");
    HIFDM(0, "report", file, "-o", page);
    SHELL(0, "sed -n '/<script type=\"application.json\"/,/<\\/script>/p' \"$1\" | sed '1d;$d' >\"$2\"", page, data);
    EXPECT(data, json, "--", "a['summary']['front'] == b['front']");
}
END_TEST

/* The page draws what it finds in its data. */
START_TEST(a_report_has_the_front)
{
    const char *file = temp("f.h5"), *page = temp("f.html");
    HIFDM(0, "run", FRONT, "-o", file, "--quiet");
    HIFDM(0, "report", file, "-o", page);
    SHELL(0, "sed -n '/<script type=\"application.json\"/,/<\\/script>/p' \"$1\" | sed '1d;$d' >\"$2\"", page,
          temp("data.json"));
    EXPECT(temp("data.json"), "--", "len(a['summary']['front']['points']) == 7", "a['summary']['front']['knee'] > 0",
           "a['overrides'][0].split('\\n')[0] == 'optimize.method=lm'",
           "set(a['summary']['front']['initial']) == {'objective_0_psi', 'objective_1_ratio_boundary'}");
}
END_TEST

/* The table is one of designs: evaluating it gives the objectives again. Threads change nothing. */
START_TEST(a_table_of_the_front_is_one_of_designs)
{
    const char *file = temp("f.h5"), *other = temp("g.h5"), *table = temp("f.csv"), *again = temp("r.csv");
    HIFDM(0, "run", FRONT, "-o", file, "--threads", "1", "--quiet");
    HIFDM(0, "run", FRONT, "-o", other, "--threads", "2", "--quiet");
    HIFDM(0, "diff", file, other);
    HIFDM(0, "export", file, "--front", table);
    OUT("7 points of the front of 2 objectives in ");
    HIFDM(0, "evaluate", FRONT, "--designs", table, "-o", again);
    EXPECT(table, again, "--",
           "list(a[0])[:8] == ['id', 'mark', 'status', 'steps', 'converged', 'objective_0_psi', "
           "'objective_1_ratio_boundary', "
           "'slope_objective_1_ratio_boundary']",
           "len(a) == 7 and a[0]['id'] == '1' and a[6]['slope_objective_1_ratio_boundary'] == ''",
           "all(near(float(x[k]), float(y[k]), 1e-6) for x, y in zip(a, b) for k in ('objective_0_psi', "
           "'objective_1_ratio_boundary'))");
    HIFDM(5, "export", file, "--front", table);
    ERR("already exists. Use --force to replace it\n");
}
END_TEST

START_TEST(a_run_without_objectives_has_no_front)
{
    const char *file = temp("f.h5");
    HIFDM(0, "run", keep(source_path("configs/chen2022.yaml")), "--set", "optimize.method=lm", "-o", file);
    HIFDM(2, "export", file, "--front", temp("f.csv"));
    ERR("this run has no Pareto front, because the case has no list optimize.front\n");
    ck_assert(!is_there(temp("f.csv")));
}
END_TEST

START_TEST(a_check_says_what_will_be_followed)
{
    HIFDM(0, "check", FRONT);
    OUT("                front of objective_0_psi and objective_1_ratio_boundary: 7 points, each by "
        "Levenberg-Marquardt\n");
    OUT("                Levenberg-Marquardt: rule force_density, at most 200 steps, for each point\n");
    HIFDM(2, "check", FRONT, "--set", "optimize.front=[{figure: psi}, {figure: ratio, set: edges}]");
    ERR("error: --set optimize.front.1.set: this net has no cable set 'edges'; did you mean 'edge'?\n");
    HIFDM(2, "check", FRONT, "--set", "optimize.front=[{figure: psi}, {figure: deflection}]");
    ERR("error: --set optimize.front.1: deflection: needs a truss that deflects, but this net has none\n");
    HIFDM(0, "check", FRONT, "--set", "optimize.front=[{figure: psi}, {figure: pull}, {figure: evenness}]");
    OUT("                front of objective_0_psi, objective_1_pull and objective_2_evenness: 7 points, each by "
        "Levenberg-Marquardt\n");
    HIFDM(2, "check", FRONT, "--set", "optimize.front=[{figure: psi}, {figure: pull}, {figure: evenness}]", "--set",
          "optimize.front_points=3");
    ERR("optimize.front_points: must be at least 4 with three objectives, for the ends alone\n");
}
END_TEST

#define THREE                                                                                                          \
    keep(source_path("configs/straight-edges.yaml")), "--set", "optimize.generations=5", "--set",                      \
        "scene.parabolic_cylinder.modules=[3, 3]", "--set",                                                            \
        "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}, {figure: pull}]"

/* Generations give the front of the last of them, each individual's objectives are in the file, and the table is one of
 * designs. */
START_TEST(generations_end_in_a_front)
{
    const char *file = temp("f.h5"), *table = temp("f.csv"), *again = temp("r.csv"), *json;
    HIFDM(0, "run", THREE, "-o", file, "--verbose");
    OUT(": the end of the front with the minimum objective_0_psi; found in generation ");
    OUT(" points, 0 dominated, 0 failed; ");
    HIFDM(0, "show", file, "--json");
    json = out_as("s.json");
    EXPECT(
        file, json, "--", "'minimised' not in b['front'] and len(b['front']['points']) > 9",
        "all(p['mark'] == 'on' and p['steps'] == 0 for p in b['front']['points'])",
        "a['search/population/objective_2'].shape == (5, 50) and a['search/population/objective_0'].attrs['units'] == "
        "''",
        "a['search/population'].attrs['n_objective'] == 3 and a['search/population/best_merit'][-1] == "
        "min(a['front/objective'][:, 0])",
        "all(np.all(np.isin(a['front/objective'][:, k], a['search/population/objective_%d' % k][-1])) for k in "
        "range(3))",
        "not any(np.all(q <= p) for p in a['front/objective'][:] for q in a['front/objective'][:] if np.any(q != p))",
        "a['search'].attrs['psi_m'] == a['front/objective'][0, 0]");
    HIFDM(0, "export", file, "--front", table);
    HIFDM(0, "evaluate", THREE, "--designs", table, "-o", again);
    EXPECT(table, again, "--",
           "all(near(float(x[k]), float(y[k]), 1e-6) for x, y in zip(a, b) for k in ('objective_0_psi', "
           "'objective_2_pull'))");
}
END_TEST

/* A front of three objectives by Levenberg-Marquardt: printed, stored, told, a table, the same by any number of
 * threads, and from the front of generations. */
START_TEST(three_objectives_have_a_front_with_slopes)
{
    static const char objectives[] =
        "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}, {figure: evenness, set: boundary}]";
    const char *file = temp("f.h5"), *other = temp("g.h5"), *table = temp("f.csv"), *again = temp("r.csv"), *json;
    HIFDM(0, "run", FRONT, "--set", objectives, "--set", "optimize.front_points=12", "-o", file, "--threads", "1");
    OUT("  front         12 points, 0 dominated, 0 failed");
    OUT("; slope: change of objective_0_psi in mm per unit of objective_1_ratio_boundary; slope: change of "
        "objective_0_psi in mm per "
        "unit of "
        "objective_2_evenness_boundary\n");
    HIFDM(0, "run", FRONT, "--set", objectives, "--set", "optimize.front_points=12", "-o", other, "--threads", "2",
          "--quiet");
    HIFDM(0, "diff", file, other);
    HIFDM(0, "show", file, "--json");
    json = out_as("s.json");
    EXPECT(file, json, "--", "a['front/objective'].shape == a['front/multiplier'].shape == (12, 3)",
           "np.array_equal([list(p['objective'].values()) for p in b['front']['points']], a['front/objective'][:])",
           "sum(np.all(m[1:] > 0) for m in a['front/multiplier'][:]) >= 1",
           "np.isnan(a['front/multiplier'][:, 0]).all() and np.nanmin(a['front/multiplier'][:, 1:]) >= 0");
    HIFDM(0, "export", file, "--front", table);
    HIFDM(0, "evaluate", FRONT, "--set", objectives, "--designs", table, "-o", again);
    EXPECT(
        table, again, "--",
        "'slope_objective_1_ratio_boundary' in a[0] and 'slope_objective_2_evenness_boundary' in a[0] and len(a) == 12",
        "all(near(float(x[k]), float(y[k]), 1e-6) for x, y in zip(a, b) for k in x if k.startswith('goal_'))");
    HIFDM(0, "run", FRONT, "--set", objectives, "--set", "optimize.method=ga+lm", "--set", "optimize.generations=3",
          "-o", other, "--force");
    OUT("  front         7 points, ");
}
END_TEST

/* From the generations' front Levenberg-Marquardt goes on, whose points are better. */
START_TEST(levenberg_marquardt_follows_generations)
{
    const char *file = temp("f.h5"), *before = temp("g.h5");
    HIFDM(0, "run", FRONT, "--set", "optimize.method=ga+lm", "--set", "optimize.generations=3", "-o", file);
    OUT("  front         7 points, 0 dominated, 0 failed, 1 not converged; ");
    HIFDM(0, "run", FRONT, "--set", "optimize.method=ga", "--set", "optimize.generations=3", "-o", before);
    EXPECT(file, before, "--", "np.array_equal(a['search/population/design'], b['search/population/design'])",
           "np.all(a['front/objective'][:].min(axis=0) < b['front/objective'][:].min(axis=0))");
    HIFDM(0, "check", FRONT, "--set", "optimize.method=ga");
    OUT("                front of objective_0_psi and objective_1_ratio_boundary: that of the last generation\n");
    ck_assert(!strstr(said.out, "Levenberg-Marquardt: rule"));
}
END_TEST

/* No design keeps the figure: the ends are not there, and the run says so. */
START_TEST(limits_that_no_design_keeps_leave_no_front)
{
    const char *file = temp("f.h5");
    HIFDM(3, "run", FRONT, "-o", file, "--set", "optimize.limits=[{figure: tension, set: edge, bounds: [500, 600]}]");
    ERR("error: optimize.front.0: Levenberg-Marquardt found no design with the minimum objective_0_psi, which is an "
        "end "
        "of "
        "the "
        "front: it did not reach optimize.limits from its start\n");
    HIFDM(0, "show", file);
    ck_assert(!strstr(said.out, "  front "));
}
END_TEST

/* A point at which the steps ran out is told, and has no slope. */
START_TEST(points_that_have_not_converged_say_so)
{
    const char *file = temp("f.h5"), *json, *table = temp("f.csv");
    HIFDM(0, "run", FRONT, "-o", file, "--set", "optimize.refine_steps=2");
    ERR(" of 7 points of the front have not converged after 2 steps. These points have no slope, and better designs "
        "exist near them. Raise optimize.refine_steps\n");
    OUT(" failed, ");
    OUT(" not converged; ");
    HIFDM(0, "show", file, "--json");
    json = out_as("f.json");
    EXPECT(file, json, "--", "[p['converged'] for p in b['front']['points']] == list(a['front/converged'][:] != 0)",
           "b['front']['n_not_converged'] == np.sum(a['front/converged'][:] == 0) > 0",
           "np.isnan(a['front/multiplier'][:][a['front/converged'][:] == 0]).all()");
    HIFDM(0, "export", file, "--front", table);
    SHELL(0, "head -1 \"$1\" | grep -q ^id,mark,status,steps,converged,objective_0_psi,", table);
    HIFDM(0, "run", FRONT, "-o", file, "--force");
    ck_assert(!strstr(said.err, "Raise optimize.refine_steps"));
}
END_TEST

/* Levenberg-Marquardt needs derivatives, which rule seeded has not: what the generations found is kept. */
START_TEST(generations_keep_their_front)
{
    const char *file = temp("f.h5"), *before = temp("g.h5");
    HIFDM(0, "run", FRONT, "--set", "optimize.method=ga+lm", "--set", "optimize.generations=3", "--set",
          "optimize.rule=seeded", "-o", file);
    ERR("warning: optimize: Levenberg-Marquardt needs ");
    ERR(". The result contains the front of the last generation\n");
    OUT("  front         ");
    HIFDM(0, "run", FRONT, "--set", "optimize.method=ga", "--set", "optimize.generations=3", "--set",
          "optimize.rule=seeded", "-o", before);
    EXPECT(file, before, "--", "np.array_equal(a['front/design'], b['front/design'])",
           "np.array_equal(a['front/initial'], b['front/initial'])");
}
END_TEST

/* Both ends keep a maximum of the objective psi, and the design with the minimum ratio has all of it. */
START_TEST(a_required_psi_limits_the_front)
{
    const char *path = keep(source_path("configs/chen2022.yaml")), *out = temp("r.h5");
    HIFDM(0, "run", path, "-o", out, "--quiet", "--set", "optimize.method=lm", "--set",
          "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}]", "--set",
          "requirements=[{figure: psi, at_most: 5e-3}]");
    EXPECT(out, "--", "a['front/status'][:].tolist() == [0] * 21", "a['front/objective'][:, 0].max() <= 5e-3",
           "a['front/objective'][:, 0].max() > 4.9e-3", "abs(a['front/objective'][:, 0].min() - 4.28338e-3) < 1e-8",
           "a['front/objective'][:, 1].min() < 4.72");
    HIFDM(3, "run", path, "-o", temp("o.h5"), "--set", "optimize.method=lm", "--set",
          "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}]", "--set",
          "requirements=[{figure: psi, at_most: 4e-3}]");
    ERR("found no design with the minimum objective_0_psi");
}
END_TEST

Suite *suite_cli_front(void)
{
    Suite *suite = suite_create("cli/front");
    TCase *tests = tcase_create("front");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, a_front_is_printed_stored_and_told);
    tcase_add_test(tests, points_of_a_front_have_verdicts);
    tcase_add_test(tests, generations_have_verdicts);
    tcase_add_test(tests, points_of_a_front_are_judged_by_samples);
    tcase_add_test(tests, a_front_survives_an_interrupt_while_it_is_judged);
    tcase_add_test(tests, a_front_says_how_far_it_is);
    tcase_add_test(tests, a_slope_says_of_what_it_is);
    tcase_add_test(tests, the_least_beside_an_objective_that_is_met);
    tcase_add_test(tests, objectives_that_do_not_conflict_are_told);
    tcase_add_test(tests, the_least_beside_a_third_objective_that_is_met);
    tcase_add_test(tests, a_front_of_many_points_is_thinned);
    tcase_add_test(tests, a_report_has_the_front);
    tcase_add_test(tests, a_table_of_the_front_is_one_of_designs);
    tcase_add_test(tests, a_run_without_objectives_has_no_front);
    tcase_add_test(tests, a_check_says_what_will_be_followed);
    tcase_add_test(tests, generations_end_in_a_front);
    tcase_add_test(tests, three_objectives_have_a_front_with_slopes);
    tcase_add_test(tests, levenberg_marquardt_follows_generations);
    tcase_add_test(tests, limits_that_no_design_keeps_leave_no_front);
    tcase_add_test(tests, points_that_have_not_converged_say_so);
    tcase_add_test(tests, generations_keep_their_front);
    tcase_add_test(tests, a_required_psi_limits_the_front);
    return suite;
}
