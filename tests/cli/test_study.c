/* A study is as easy to act on as a run: what `check` says before, what `show` says behind, its surface. */
#include "cli.h"

#define NET                                                                                                            \
    "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n  paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 3, "     \
    "rear_distance_m: 1.8}\nform: {prestress: exact}\ntruss: {ring: {cells_per_bay: 2, held: bay, longeron: "          \
    "{diameter_m: 0.03, wall_m: 0.001}}}\n"
#define SURFACE "surface: {frequencies_Hz: [2.5e9, 20e9]}\n"
#define TOLERANCE "tolerance: {sigma_cut_m: 5e-5, samples: 40}\n"
#define LM                                                                                                             \
    "optimize: {method: lm, variables: [{set: all, vary: force_density, range: 50 %}], objective: [{figure: psi}, "    \
    "{figure: "                                                                                                        \
    "tension, set: tie, target: 8, weight: 1e-4}]}\n"
#define AXIS "sweep:\n  form.pretension_N: [5, 10, 20]\n  scene.EA_boundary_N: [2e5]\n"

static void sweep_and_merge(const char *path, const char *folder, const char *merged)
{
    HIFDM(0, "sweep", path, "--dir", folder, "--quiet");
    HIFDM(0, "merge", path, "--dir", folder, "-o", merged, "--quiet");
}

/* Of each stage, bit by bit what the file of the point has; also when the points came one by one. */
START_TEST(errors_of_the_surface_are_columns_of_a_merge)
{
    const char *path = file_with("s.yaml", NET SURFACE LM AXIS), *merged = temp("s.h5"), *later = temp("later.h5");
    sweep_and_merge(path, temp("s.d"), merged);
#define RUNS "for i, k in enumerate(texts(a['points/id'])) for s in ('form', 'refine') "
    EXPECT(merged, "--", "[n for n in ('form', 'search', 'refine') if n in a['points/surface']] == ['form', 'refine']",
           "all(a['points/surface'][s][n][i] == a['runs'][k]['surface'][s].attrs[n] " RUNS
           "for n in ('facet_half_path_rms_m', 'facet_fit_half_path_rms_m'))",
           "all(np.array_equal(a['points/surface'][s]['facet_' + f + 'gain_loss_at_%s_GHz_dB' % ('2.5', '20')[q]][i], "
           "a['runs'][k]['surface'][s]['facet_' + f + 'gain_loss_dB'][q], equal_nan=True) " RUNS
           "for f in ('', 'fit_') for q in (0, 1))",
           /* the frequency at which Ruze's formula costs 1 dB: 4.3429 (4 pi e / lambda)^2 */
           "all(near(10 / np.log(10) * (4 * np.pi * a['points/surface'][s]['facet_' + f + 'half_path_rms_m'][i] * "
           "a['points/surface'][s]['facet_' + f + 'gain_loss_1dB_Hz'][i] / 299792458)**2, 1, 1e-9) " RUNS
           "for f in ('', 'fit_'))",
           "[attribute(a['points/surface/form/facet_' + n], 'units') for n in ('half_path_rms_m', 'gain_loss_1dB_Hz', "
           "'gain_loss_at_20_GHz_dB')] == ['m', 'Hz', 'dB']");
    for (int task = 0; task < 3; task++)
        HIFDM(0, "sweep", path, "--dir", temp("later.d"), "--task", keep(formatted("%d", task)), "--tasks", "3");
    HIFDM(0, "status", path, "--dir", temp("later.d"));
    OUT("done      3");
    HIFDM(0, "merge", path, "--dir", temp("later.d"), "-o", later, "--quiet");
    EXPECT(merged, later, "--", "differing(a, b) == []");
    /* without facets of the surface there is no group */
    sweep_and_merge(file_with("none.yaml", NET AXIS), temp("none.d"), temp("none.h5"));
    EXPECT(temp("none.h5"), "--", "'surface' not in a['points']");
}
END_TEST

/* The figures of each load case are those of single runs, and a figure of one is not printed as one of all. */
START_TEST(load_cases_are_columns_of_a_merge)
{
    const char *cases = keep(source_path("configs/paraboloid-load-cases.yaml")), *merged = temp("s.h5"),
               *page = temp("s.html");
    const char *of_heat =
        file_with("s.yaml", keep(formatted("base: %s\nsweep: {load_cases.0.temperature_K: [-120, -30]}\n", cases)));
    sweep_and_merge(of_heat, temp("s.d"), merged);
    HIFDM(0, "run", cases, "-o", temp("one.h5"), "--quiet");
    HIFDM(0, "run", cases, "-o", temp("two.h5"), "--quiet", "--set", "load_cases.0.temperature_K=-30");
#define STATES "for i, r in enumerate((b, c)) for s in ('cold', 'sun', 'cup_up', 'cup_down', 'spun') "
    EXPECT(merged, temp("one.h5"), temp("two.h5"), "--",
           "a['points/input/load_cases.0.temperature_K'][:].tolist() == [-120, -30]",
           "all(a['points/load_cases'][s][n][i] == r['load_cases'][s].attrs[n] " STATES
           "for n in ('psi_m', 'n_slack', 'n_loose', 'tension_max_N'))",
           "all(a['points/load_cases'][s][n][i] == r['load_cases'][s]['surface'].attrs[n] " STATES
           "for n in ('facet_half_path_rms_m', 'facet_fit_half_path_rms_m'))",
           "all(np.array_equal(a['points/load_cases'][s]['facet_' + f + 'gain_loss_at_%d_GHz_dB' % (2, 10)[q]][i], "
           "r['load_cases'][s]['surface']['facet_' + f + 'gain_loss_dB'][q], equal_nan=True) " STATES
           "for f in ('', 'fit_') for q in (0, 1))",
           "[attribute(a['points/load_cases/cold/' + n], 'units') for n in ('psi_m', 'tension_max_N', 'n_slack')] == "
           "['m', 'N', '']",
           "a['points/load_cases/cold/n_slack'][0] > a['points/load_cases/cold/n_slack'][1]");
    HIFDM(0, "show", merged, "--verbose");
    OUT("design slack 0");
    OUT("cold psi  cold slack");
    ck_assert_ptr_null(strstr(said.out, ", slack 0"));
    HIFDM(0, "show", merged, "--json");
    const char *json = out_as("s.json");
    HIFDM(0, "report", merged, "-o", page);
    EXPECT(merged, json, data_of(page, "p.json"), "--",
           "all([p['load_cases'][s][n] for p in b['points']] == a['points/load_cases'][s][n][:].tolist() for s in "
           "a['points/load_cases'] "
           "for n in ('psi_m', 'n_slack', 'facet_half_path_rms_m'))",
           "[o['n_slack'] for o in c['study']['output'] if o['stage'] == 'load case cold'] == "
           "[a['points/load_cases/cold/n_slack'][:].tolist()]",
           "[f.get('same') for f in c['study']['figure'] if f['stage'] in ('load case cold', 'load case sun') and "
           "f['key'] == "
           "'psi_m'] == [None, True]");
}
END_TEST

/* Every number of the table is that of the file, the best row has the minimum psi of 95 %, and lines fit. */
START_TEST(a_merged_study_is_shown_as_a_table)
{
    const char *path = file_with("s.yaml", "title: How hard\n" NET SURFACE LM TOLERANCE AXIS);
    const char *merged = temp("s.h5");
    sweep_and_merge(path, temp("s.d"), merged);
    HIFDM(0, "show", merged);
    OUT("How hard\n  points        3: 3 done, 0 failed, 0 missing\n  axes          form.pretension_N\n");
    OUT("EA boundary 200000 N");
    OUT("refocused loss");
    ck_assert_msg(!strstr(said.out, "1 dB gain loss"), "%s", said.out); /* Ruze stands behind physical optics */
    OUT("objective tension tie");
    ck_assert_msg(!strstr(said.out, " psi  psi"), "%s", said.out); /* the objective psi is psi */
    EXPECT(merged, out_as("s.txt"), "--",
           "max(len(line) for line in b.decode().splitlines() if 'hifdm report' not in line) <= 100",
           "[r.split()[1 if r[0] == '*' else 0] for r in b.decode().splitlines() if r[:1] in '* ' and "
           "r.split()[-1:] and r.split()[-1][-1].isdigit() and r.split()[1 if r[0] == '*' else 0] in ('5', '10', "
           "'20')][:3] == ['5', '10', '20']",
           "('%.4f' % (1e3 * a['points/tolerance/psi_95_m'][:].min())) in [r for r in b.decode().splitlines() if r[:1] "
           "== '*'][0].split()",
           "all('%.4f' % (1e3 * v) in b.decode() for n in ('form', 'refine') for v in a['points'][n]['psi_m'][:])",
           "all('%.4f' % (1e3 * v) in b.decode() for v in "
           "a['points/surface/refine/facet_half_path_rms_m'][:])");
    HIFDM(0, "show", merged, "--json");
    EXPECT(merged, out_as("s.json"), "--", "[p['id'] for p in b['points']] == texts(a['points/id'])",
           "b['best_by'] == 'psi_95_m' and b['result'] == 'refine' and b['title'] == 'How hard'",
           "b['best'] == texts(a['points/id'])[int(np.argmin(a['points/tolerance/psi_95_m'][:]))]",
           "[p['input']['form.pretension_N'] for p in b['points']] == [5, 10, 20]",
           "[p['refine']['facet_gain_loss_1dB_Hz'] for p in b['points']] == "
           "a['points/surface/refine/facet_gain_loss_1dB_Hz'][:].tolist()",
           "[p['tolerance']['psi_95_m'] for p in b['points']] == a['points/tolerance/psi_95_m'][:].tolist()");
}
END_TEST

/* Verdicts and margins of each point are those of its run, and the points rank by them, not by psi. The share of the
 * first row is an axis, so its name leaves the share out. */
START_TEST(points_rank_by_their_requirements)
{
    const char *path = file_with(
        "s.yaml", NET "tolerance: {sigma_cut_m: 5e-5, samples: 60}\nrequirements: [{figure: tension, set: tie, "
                      "at_least: 2, share: 0.9}, {figure: psi, at_most: 3.7e-4, share: 0.5}, {figure: slack_cables, "
                      "at_most: 0}]\nsweep: {form.pretension_N: [4, 8, 10, 12, 14, 18], requirements.0.share: [0.5, "
                      "0.9], files: all}\n");
    const char *merged = temp("s.h5"), *page = temp("s.html");
    sweep_and_merge(path, temp("s.d"), merged);
    HIFDM(0, "show", merged, "--json");
    const char *json = out_as("s.json");
    HIFDM(0, "show", merged);
    const char *shown = out_as("s.txt");
    OUT("\n  ranked by     failed requirements, then undecided ones, then smallest relative margin\n");
    HIFDM(0, "show", merged, "--verbose");
    const char *all = out_as("all.txt");
    HIFDM(0, "report", merged, "-o", page);
#define OF "a['points/requirements']"
#define RUN_OF "a['runs'][k]['requirements']"
    EXPECT(
        merged, json, shown, all, data_of(page, "p.json"), "--",
        "texts(" OF "['name']) == ['tension of tie', 'psi, 50 % of samples', 'slack_cables']",
        "all(np.array_equal(" OF "[n][i], " RUN_OF "[n][:], equal_nan=True) for i, k in "
        "enumerate(texts(a['points/id'])) for n in ('margin', 'relative_margin'))",
        "all([('pass', 'fail', 'undecided', 'none')[v] for v in " OF "['verdict'][i]] == texts(" RUN_OF
        "['verdict']) for i, k in enumerate(texts(a['points/id'])))",
        "np.array_equal(" OF "['n_failed'][:], (" OF "['verdict'][:] == 1).sum(1))",
        "np.array_equal(" OF "['n_undecided'][:], (" OF "['verdict'][:] == 2).sum(1))",
        "np.array_equal(" OF "['relative_margin_min'][:], np.nanmin(" OF "['relative_margin'][:], 1))",
        "set(p['verdict'] for p in b['points']) == {'pass', 'fail', 'undecided'} == set(e['study']['verdict'])",
        "b['best'] == texts(a['points/id'])[np.lexsort((-" OF "['relative_margin_min'][:], " OF
        "['n_undecided'][:], " OF "['n_failed'][:]))[0]]",
        "b['best'] != texts(a['points/id'])[int(np.argmin(a['points/form/psi_m'][:]))] and 'closest' not in b",
        "b['passing'] == int(((" OF "['n_failed'][:] == 0) & (" OF "['n_undecided'][:] == 0)).sum()) > 0",
        "b['advice'].startswith('%d of 12 points pass; ' % b['passing']) and b['advice'] == e['study']['advice']",
        /* the required figures stand in the table, and no other figure does */
        "all(np.array_equal(" OF "[n][i], " RUN_OF "[n][:], equal_nan=True) for i, k in "
        "enumerate(texts(a['points/id'])) for n in ('value', 'at_least', 'at_most'))",
        "all('%.4g' % (f * v) in c.decode().split() for k, f in enumerate((1, 1e3, 1)) for v in " OF "['value'][:, k])",
        "all(w in c.decode() for w in ('at least 2 N', 'at most 0.37 mm', 'slack_cables'))",
        "not any(w in c.decode() for w in ('psi form', 'psi of 95 %', 'ratio inside', 'yield'))",
        "all('%.1f' % (100 * v) in d.decode() for v in a['points/tolerance/yield'][:])", "'psi of 95 %' in d.decode()",
        "[[r['value'], r['at_least'], r['at_most']] for r in b['points'][3]['requirements']['rows']] == "
        "[[None if np.isnan(v) else v for v in (" OF "['value'][3, k], " OF "['at_least'][3, k], " OF
        "['at_most'][3, k])] for k in range(3)]",
        "sorted(r['name'] for r in e['study']['required']) == sorted(texts(" OF "['name']))",
        "all(r['values'] == " OF "['value'][:, texts(" OF "['name']).index(r['name'])].tolist() for r in "
        "e['study']['required'])",
        "b['best_by'] == 'relative_margin_min' and e['study']['best'] == texts(a['points/id']).index(b['best'])",
        "max(len(line) for line in c.decode().splitlines() if 'hifdm report' not in line) <= 100");
}
END_TEST

/* Five requirements have a column: those that fail, then those that decide points, then those that are tightest at the
 * best point. --verbose shows all. */
START_TEST(the_tightest_requirements_have_columns)
{
    const char *path = file_with(
        "s.yaml", NET "requirements: [{figure: psi, at_most: 100}, {figure: tension, set: tie, at_least: 6}, {figure: "
                      "slack_cables, at_most: 0}, {figure: tension, set: front, at_most: 1e3}, {figure: ratio, "
                      "at_most: 500}, {figure: tension, set: front, at_least: 1}, {figure: loose_nodes, at_most: 0}]\n"
                      "sweep: {form.pretension_N: [4, 40]}\n");
    sweep_and_merge(path, temp("s.d"), temp("s.h5"));
    HIFDM(0, "report", temp("s.h5"), "-o", temp("s.html"));
    HIFDM(0, "show", temp("s.h5"));
    const char *shown = out_as("s.txt");
    OUT("\n  columns       the 5 tightest of 7 requirements; --verbose: all, and other figures, such as psi\n");
    HIFDM(0, "show", temp("s.h5"), "--verbose");
    EXPECT(temp("s.h5"), data_of(temp("s.html"), "p.json"), shown, out_as("all.txt"), "--",
           "[r['name'] for r in b['study']['required']] == ['tension of tie', 'tension of front', 'ratio', 'psi', "
           "'tension "
           "of front', 'slack_cables', 'loose_nodes']",
           "'slack_cables' not in c.decode() and 'loose_nodes' not in c.decode()",
           "'slack_cables' in d.decode() and 'loose_nodes' in d.decode()");
}
END_TEST

/* A row with the bound 0 has no relative margin. If only such a row fails, no positive margin may deny it. */
START_TEST(a_failed_point_has_no_positive_margin)
{
    const char *path =
        file_with("s.yaml", NET "requirements: [{figure: tension, set: tie, at_most: 0}, {figure: psi, at_most: 1}]\n"
                                "sweep: {form.pretension_N: [4, 8]}\n");
    sweep_and_merge(path, temp("s.d"), temp("s.h5"));
    EXPECT(temp("s.h5"), "--", "a['points/requirements/n_failed'][:].tolist() == [1, 1]",
           "np.isnan(a['points/requirements/relative_margin_min'][:]).all()",
           "(a['points/requirements/relative_margin'][:, 1] > 0.9).all()");
}
END_TEST

/* The point with the smallest psi of 95 % has too little tension, so it is not the best while another point passes. */
START_TEST(a_point_that_fails_is_not_the_best)
{
    const char *path = file_with(
        "s.yaml", NET "tolerance: {sigma_cut_m: 5e-5, samples: 60}\nrequirements: "
                      "[{figure: tension, at_least: 1.5, share: 0.9}]\nsweep:\n  form.pretension_N: [8, 24, 30]\n");
    sweep_and_merge(path, temp("s.d"), temp("s.h5"));
    HIFDM(0, "show", temp("s.h5"), "--json");
    EXPECT(temp("s.h5"), out_as("s.json"), "--", "np.argmin(a['points/tolerance/psi_95_m'][:]) == 0",
           "[p['verdict'] for p in b['points']] == ['fail', 'pass', 'pass']",
           "b['best'] == texts(a['points/id'])[2] and b['best_by'] == 'relative_margin_min'",
           "b['advice'] == '2 of 3 points pass: pretension between the points 24 and 30 N'");
    HIFDM(0, "show", temp("s.h5"));
    OUT("best (*)      passes, ");
    OUT("ranked by     failed requirements, then undecided ones, then smallest relative margin");
}
END_TEST

/* Refined designs lie at the bound of psi. Their margins are rounding, so the objective ranks them. */
START_TEST(margins_of_rounding_do_not_rank)
{
    const char *path = file_with(
        "s.yaml", NET "optimize: {method: lm, range_N: 4, objective: [{figure: evenness, set: boundary}]}\n"
                      "requirements: [{figure: psi, at_most: 1}]\nsweep:\n  requirements.0.at_most: [3.3e-4, 3.5e-4, "
                      "3.4e-4]\n");
    sweep_and_merge(path, temp("s.d"), temp("s.h5"));
    HIFDM(0, "show", temp("s.h5"), "--json");
    const char *json = out_as("s.json");
    HIFDM(0, "show", temp("s.h5"));
    OUT("ranked by     failed requirements, then undecided ones, then objective evenness boundary");
    EXPECT(temp("s.h5"), json, "--", "[p['verdict'] for p in b['points']] == ['pass'] * 3",
           "(abs(a['points/requirements/relative_margin_min'][:]) < 5e-4).all()",
           "np.argmin(a['points/refine/merit'][:]) == 1 == texts(a['points/id']).index(b['best'])",
           "b['best_by'] == 'objective_0_evenness_boundary'");
}
END_TEST

/* Objectives that no point reaches: their merit decides which is best, however small psi's part in it is. */
START_TEST(objectives_say_which_point_is_best)
{
    sweep_and_merge(
        file_with("s.yaml",
                  "title: How hard\n" NET "optimize: {method: lm, variables: [{set: tie, vary: "
                  "force_density, range: 50 %}], objective: [{figure: psi}, {figure: tension, set: tie, target: "
                  "0.1, weight: 10}]}\n" TOLERANCE AXIS),
        temp("s.d"), temp("s.h5"));
    HIFDM(0, "show", temp("s.h5"), "--json");
    EXPECT(temp("s.h5"), out_as("s.json"), "--", "b['best_by'] == 'merit'",
           "b['best'] == texts(a['points/id'])[int(np.argmin(a['points/refine/merit'][:]))]",
           "np.argmin(a['points/refine/merit'][:]) != np.argmin(a['points/tolerance/psi_95_m'][:])");
    HIFDM(0, "show", temp("s.h5"));
    OUT("minimum merit: ");
}
END_TEST

/* Only where the figure that says which is best falls towards the end, and of what is no error. */
START_TEST(a_best_point_at_the_end_of_an_axis_is_told)
{
    static const char end[] = "the end of its axis: add points ";
    const char *merged = temp("s.h5");
    sweep_and_merge(file_with("s.yaml", NET "sweep:\n  form.pretension_N: [20, 5, 10]\n  scene.EA_boundary_N: [2e5, "
                                            "2.0001e5]\n"),
                    temp("s.d"), merged);
    HIFDM(0, "show", merged); /* a truss deflects less under less pull; the other axis changes nothing */
    OUT("\n                psi still falls at pretension 5 N, the end of its axis: add points below it\n");
    ck_assert_int_eq(count_of(said.out, end), 1);
    EXPECT(merged, "--",
           "(lambda psi, n: np.ptp([p for p, k in zip(psi, n) if k == 5]) < 1e-9 and max(psi[n == 5]) < "
           "min(psi[n == 10]) and max(psi[n == 10]) < min(psi[n == 20]))(a['points/form/psi_m'][:], "
           "a['points/input/form.pretension_N'][:])");
    HIFDM(0, "report", merged, "-o", temp("s.html"));
    EXPECT(data_of(temp("s.html"), "s.json"), "--",
           "{i['name']: i.get('extend') for i in a['study']['input']} == {'form.pretension_N': 'below', "
           "'scene.EA_boundary_N': None}");
    /* fewer errors are always better; a best point within */
    sweep_and_merge(file_with("t.yaml", NET "tolerance: {sigma_cut_m: 1e-5, samples: 40}\nsweep:\n  "
                                            "tolerance.sigma_cut_m: [1e-5, 3e-5, 9e-5]\n"),
                    temp("t.d"), temp("t.h5"));
    HIFDM(0, "show", temp("t.h5"));
    OUT("best (*)      minimum psi of 95 %: ");
    EXPECT(temp("t.h5"), "--", "(np.diff(a['points/tolerance/psi_95_m'][:]) > 0).all()");
    ck_assert_int_eq(count_of(said.out, end), 0);
    sweep_and_merge(file_with("u.yaml", NET TOLERANCE "sweep:\n  form.pretension_N: [1, 3, 5, 8, 12, 20, 30]\n"),
                    temp("u.d"), temp("u.h5"));
    HIFDM(0, "show", temp("u.h5"));
    ck_assert_int_eq(count_of(said.out, end), 0);
    EXPECT(temp("u.h5"), "--", "0 < np.argmin(a['points/tolerance/psi_95_m'][:]) < 6");
}
END_TEST

START_TEST(failed_points_are_told_and_never_the_best)
{
    const char *path =
        file_with("s.yaml", SMALL_SCENE "form: {method: hifdm, stop: residual}\nsweep:\n"
                                        "  form.max_iterations: [2, 100000]\n  form.pretension_N: [8, 9]\n");
    HIFDM(3, "sweep", path, "--dir", temp("s.d"), "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("s.d"), "-o", temp("s.h5"), "--quiet");
    HIFDM(0, "show", temp("s.h5"));
    OUT("points        4: 2 done, 2 failed, 0 missing");
    OUT("failed        2 not_converged: form-finding did not converge in 2 iterations");
    ck_assert_msg(!strstr(said.out, "\n*               2 "), "%s", said.out);
}
END_TEST

/* Points of different nets count different numbers of nodes, so the study names none. */
START_TEST(nodes_that_psi_counts_are_named)
{
    const char *path = file_with("s.yaml", NET "sweep:\n  scene.paraboloid.rings: [2, 3]\n");
    sweep_and_merge(path, temp("s.d"), temp("s.h5"));
    HIFDM(0, "show", temp("s.h5"));
    ck_assert_msg(!strstr(said.out, "psi counts"), "%s", said.out);
    path = file_with("t.yaml", NET AXIS);
    sweep_and_merge(path, temp("t.d"), temp("t.h5"));
    HIFDM(0, "show", temp("t.h5"));
    OUT("\n  psi counts    19 of 38 free nodes\n");
}
END_TEST

/* A file may name its axes, and words on them, as it likes: nothing of it commands a terminal. */
START_TEST(odd_names_are_shown_escaped)
{
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(),
          "import h5py, numpy as np, sys\n"
          "f = h5py.File(sys.argv[1], 'w')\n"
          "f.attrs.create('program', b'hifdm', dtype=h5py.string_dtype('utf-8', 5)); f.attrs['format_version'] = "
          "np.int32(3)\n"
          "text = lambda v: np.array([t.encode() for t in v], dtype=h5py.string_dtype('utf-8', 99))\n"
          "p = f.create_group('points')\n"
          "p['id'] = text(['a', 'b']); p['reason'] = text(['', '\\x1b[31mno']); f['study/title'] = "
          "text(['\\x1b[2Jhello'])\n"
          "p['status'] = np.array([0, 1], dtype=h5py.enum_dtype({'ok': 0, 'not_converged': 1}, basetype='i1'))\n"
          "for name in ('5.weight', 'objective_x.1psi', '_N', 'a' * 300, '\\x1b[31m_m'):\n"
          "    p['input/' + name] = [1.0, 2.0]\n"
          "p['input/words'] = text(['\\u202eabc', 'x'])\n"
          "p['form/psi_m'] = [0.001, np.nan]; p['form/objective_0_' + 'z' * 90] = [1.0, np.inf]\n",
          temp("odd.h5"));
    HIFDM(0, "show", temp("odd.h5"));
    OUT("\\x1b[2Jhello\n");
    OUT("failed        1 not_converged: \\x1b[31mno");
    OUT("\\u202eabc");
    ck_assert_msg(!strchr(said.out, '\x1b') && !strstr(said.out, "\xe2\x80\xae"), "%s", said.out);
    HIFDM(0, "report", temp("odd.h5"), "-o", temp("odd.html"));
}
END_TEST

/* Of a large study the best points, or all. */
START_TEST(a_large_study_shows_its_best)
{
    const char *path =
        file_with("s.yaml", NET "sweep:\n  form.pretension_N: {from: 1, to: 40, n: 70}\n  files: none\n");
    sweep_and_merge(path, temp("s.d"), temp("s.h5"));
    HIFDM(0, "show", temp("s.h5"));
    OUT("the 32 best of 70 points; --verbose: all");
    OUT("best (*)      minimum psi: ");
    OUT("\n  ranked by     psi\n");
    EXPECT(temp("s.h5"), out_as("s.txt"), "--",
           "[r[1:].split()[1] for r in b.decode().splitlines() if r[1:].split() and r[1:].split()[0][0].isdigit()] == "
           "['%.4f' % (1e3 * v) for v in sorted(a['points/form/psi_m'][:])[:32]]");
    HIFDM(0, "show", temp("s.h5"), "--verbose");
    ck_assert_ptr_null(strstr(said.out, "best of"));
}
END_TEST

START_TEST(check_says_what_a_sweep_would_do)
{
    const char *path =
        file_with("s.yaml", "base: base.yaml\ntitle: How hard\nsweep:\n  form.pretension_N: {from: 5, to: "
                            "40, n: 9}\n  scene.EA_boundary_N: [1e5, 2e5]\n");
    file_with("base.yaml", NET SURFACE TOLERANCE);
    SHELL(0, "cd \"$1\" && \"$0\" check s.yaml --threads 2", temp(""));
    OUT("s.yaml: valid\n  study         How hard\n  base case     base.yaml\n"
        "  axes          form.pretension_N: 9 values, 5 .. 40 N\n"
        "                scene.EA_boundary_N: 100000, 200000 N\n"
        "  points        18\n");
    OUT(": form.pretension_N=5, scene.EA_boundary_N=100000\n");
    OUT(": form.pretension_N=40, scene.EA_boundary_N=200000\n");
    OUT("0 done, 0 failed, 0 running, 18 to run");
    OUT("18 points to run, each at most some ");
    OUT(" on average, on ");
    OUT("the first point, ");
    SHELL(0, "cd \"$1\" && ls && test ! -e s.d", temp("")); /* nothing is written */
    SHELL(0, "cd \"$1\" && \"$0\" sweep s.yaml --quiet && \"$0\" check s.yaml", temp(""));
    OUT("18 done, 0 failed, 0 running, 0 to run");
    OUT("all points have been run");
    HIFDM(2, "check", path, "--set", "form.pretension_N=3");
    ERR("s.yaml: the --set option does not work with a study");
}
END_TEST

/* No more threads than points: two of them side by side take as long as one. */
START_TEST(check_counts_threads_that_have_a_point)
{
    const char *path = file_with("s.yaml", NET "sweep:\n  form.pretension_N: [5, 6]\n");
    char one[32] = "", all[32] = "";
    HIFDM(0, "check", path, "--threads", "64");
    const char *line = strstr(said.out, "2 points to run, each");
    ck_assert_msg(line && sscanf(line,
                                 "2 points to run, each at most some %31[^o]on average, on 2 threads: at most "
                                 "about %31[^\n]",
                                 one, all) == 2,
                  "%s", said.out);
    ck_assert_str_eq(one, formatted("%s ", all));
    /* three points on two threads: two rounds; durations are printed as "1.2 ms" */
    HIFDM(0, "check", file_with("s.yaml", NET "sweep:\n  form.pretension_N: [5, 6, 7]\n"), "--threads", "2");
    double one_is, all_is;
    char one_unit[8], all_unit[8];
    line = strstr(said.out, "3 points to run, each");
    ck_assert_msg(line && sscanf(line,
                                 "3 points to run, each at most some %lf %7s on average, on 2 threads: at most "
                                 "about %lf %7s",
                                 &one_is, one_unit, &all_is, all_unit) == 4,
                  "%s", said.out);
    double rounding = strcmp(one_unit, "us") ? 0.151 : 1.51; /* of both numbers */
    if (!strcmp(one_unit, all_unit)) ck_assert_msg(fabs(all_is - 2 * one_is) <= rounding, "%s", said.out);
}
END_TEST

/* Points that are not missing, and yet not done: with the command that runs them. */
START_TEST(check_tells_what_is_not_done)
{
    const char *base = SMALL_SCENE "form: {method: hifdm, stop: residual}\n";
    const char *study = "base: base.yaml\nsweep:\n  form.max_iterations: [100000, 2]\n  form.pretension_N: [8, 9]\n";
    file_with("base.yaml", base);
    file_with("s.yaml", study);
    SHELL(3, "cd \"$1\" && \"$0\" sweep s.yaml --quiet", temp(""));
    SHELL(0, "cd \"$1\" && \"$0\" check s.yaml --threads 2", temp(""));
    OUT("2 done, 2 failed, 0 running, 0 to run");
    OUT("nothing is missing; 2 failed: `hifdm sweep s.yaml --retry failed`\n2 points to run anew, each at most some ");
    ck_assert_ptr_null(strstr(said.out, "all points have been run"));
    file_with("s.yaml",
              "base: base.yaml\nsweep:\n  form.max_iterations: [100000, 2]\n  form.pretension_N: [8, 9, 10]\n");
    SHELL(0, "cd \"$1\" && \"$0\" check s.yaml --threads 2", temp(""));
    OUT("2 points to run, each at most some ");
    OUT("\n2 failed: `hifdm sweep s.yaml --retry missing,failed` runs these, too\n");
    /* another base case: what was run before is of the old one */
    file_with("s.yaml", study);
    file_with("base.yaml", formatted("title: other\n%s", base));
    SHELL(0, "cd \"$1\" && \"$0\" check s.yaml --threads 2", temp(""));
    OUT("4 outdated: of another version of base.yaml\n");
    OUT("nothing is missing; 4 outdated: `hifdm sweep s.yaml --retry outdated`\n4 points to run anew, each at most ");
    SHELL(3, "cd \"$1\" && \"$0\" sweep s.yaml --retry outdated --quiet", temp("")); /* that command does it */
    SHELL(0, "cd \"$1\" && \"$0\" check s.yaml", temp(""));
    OUT("nothing is missing; 2 failed: ");
}
END_TEST

/* All of them with their lines: of the study, of its base, and what only the nets of the points show. */
START_TEST(check_tells_the_faults_of_a_study)
{
    const char *path = file_with("s.yaml", "base: base.yaml\nsweep:\n  form.pretension_N: [5, x]\n  form.pretesion_N: "
                                           "[1]\n");
    file_with("base.yaml", NET);
    HIFDM(2, "check", path);
    ERR("s.yaml:3:26: sweep: form.pretension_N: must be a number");
    ERR("s.yaml:4:3: sweep: unknown key 'form.pretesion_N'; did you mean 'form.pretension_N'?");
    file_with("s.yaml", "base: base.yaml\nsweep:\n  form.pretension_N: [5, 6]\n");
    file_with("base.yaml", NET "surfce: {}\n");
    HIFDM(2, "check", path);
    ERR("base.yaml:7:1: surfce: unknown key");
    ERR("did you mean 'surface'?");
    file_with("base.yaml", NET);
    file_with("s.yaml", "base: base.yaml\nsweep:\n  scene.paraboloid.focal_length_m: [3, 4]\n  "
                        "scene.paraboloid.rear_distance_m: [0.001, 1.8]\n");
    HIFDM(3, "check", path);
    OUT("2 of these cannot be run");
    OUT("\npoint "); /* the first that can be run is checked as a case */
    ERR("point scene.paraboloid.focal_length_m=3, scene.paraboloid.rear_distance_m=0.001");
    ERR("point scene.paraboloid.focal_length_m=4, scene.paraboloid.rear_distance_m=0.001");
    ERR("2 of the 4 tested points cannot be run");
    file_with("s.yaml", "base: base.yaml\nsweep:\n  scene.paraboloid.rear_distance_m: [0.001, 0.002]\n");
    HIFDM(2, "check", path);
    ERR("point scene.paraboloid.rear_distance_m=0.001");
    file_with("s.yaml", "base: nowhere.yaml\nsweep:\n  form.pretension_N: [5, 6]\n");
    HIFDM(2, "check", path);
    ERR("nowhere.yaml");
}
END_TEST

/* Values that differ by less than rounding from the next one, but not from the one after that, still have an order. */
START_TEST(the_best_of_many_points_are_different)
{
    const char *path = file_with("s.yaml", "scene: {paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 2}}\n"
                                           "sweep: {form.pretension_N: {from: 5, to: 9, n: 70}}\n");
    sweep_and_merge(path, temp("s.d"), temp("s.h5"));
    SHELL(0,
          "\"$1\" -c 'import h5py, sys\nwith h5py.File(sys.argv[1], \"r+\") as f:\n    f[\"points/form/psi_m\"][:] = "
          "[1 - 8e-7 * min(k % 6, 3) + k // 6 for k in range(70)]' \"$2\"",
          python_program(), temp("s.h5"));
    HIFDM(0, "show", temp("s.h5"));
    EXPECT(out_as("s.txt"), "--",
           "len(set(a.decode().splitlines()) - {''}) == len([l for l in a.decode().splitlines() "
           "if l])",
           "'32 best' in a.decode()");
}
END_TEST

/* Only the replicates of lm are identical, so those of the other methods are worth running. */
START_TEST(replicates_compare_methods)
{
    const char *path = file_with("s.yaml", "base: base.yaml\nsweep: {optimize.method: [ga, lm], replicates: 3}\n");
    file_with("base.yaml",
              NET "optimize: {population: 8, generations: 4, elites: 2, refine: false, range_N: 2, method: lm}\n");
    sweep_and_merge(path, temp("s.d"), temp("s.h5"));
    HIFDM(0, "show", temp("s.h5"), "--json");
    EXPECT(out_as("s.json"), "--",
           "[len(set(p['result']['psi_m'] for p in a['points'][k:k + 3])) for k in (0, 3)] == [2, 1]");
    file_with("s.yaml", "base: base.yaml\nsweep: {form.pretension_N: [8, 9], replicates: 3}\n");
    HIFDM(2, "sweep", path);
    ERR("all replicates would be identical, because the method lm uses no random numbers");
}
END_TEST

/* Any threads, shards and interruptions give the same merge, whose groups are recomputed from its points. */
START_TEST(replicates_show_the_scatter_of_the_search)
{
    const char *path = file_with("s.yaml", "base: base.yaml\nsweep:\n  form.pretension_N: [5, 5.5, 20]\n"),
               *whole = temp("whole.h5"), *shards = temp("shards.h5"), *killed = temp("killed.h5"),
               *page = temp("s.html");
    file_with("base.yaml", NET "optimize: {variables: [{set: all, vary: force_density, range: 20 %}], population: 8, "
                               "generations: 30, elites: 2, refine: false, objective: [{figure: psi}]}\n");
    HIFDM(0, "sweep", path, "--dir", temp("whole.d"), "--threads", "1", "--quiet");
    path = file_with("s.yaml", "base: base.yaml\nsweep:\n  form.pretension_N: [5, 5.5, 20]\n  replicates: 6\n");
    HIFDM(0, "check", path);
    OUT("\n                replicate: 1, 2, 3, 4, 5, 6\n  points        18, each with a seed of its own\n");
    HIFDM(0, "sweep", path, "--dir", temp("whole.d"), "--threads", "1");
    OUT("15 points run"); /* the first replicates are the points of before */
    HIFDM(0, "merge", path, "--dir", temp("whole.d"), "-o", whole, "--quiet");
    for (int task = 2; task >= 0; task--)
        HIFDM(0, "sweep", path, "--dir", temp("shards.d"), "--threads", keep(formatted("%d", task + 1)), "--task",
              keep(formatted("%d", task)), "--tasks", "3", "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("shards.d"), "-o", shards, "--quiet");
    SHELL(0,
          "\"$0\" sweep \"$1\" --dir \"$2\" --threads 2 --quiet & sleep 0.3; kill -9 $!; wait $!; exec \"$0\" sweep "
          "\"$1\" --dir \"$2\" --threads 2 --quiet",
          path, temp("killed.d"));
    HIFDM(0, "merge", path, "--dir", temp("killed.d"), "-o", killed, "--quiet");
    EXPECT(whole, shards, killed, "--", "differing(a, b) == []", "differing(a, c) == []",
           "a['points/input/replicate'][:].tolist() == 3 * [1, 2, 3, 4, 5, 6]",
           "len(set(a['points/seed'][:].tolist())) == 18");
    HIFDM(0, "show", whole, "--json");
    const char *json = out_as("s.json");
    HIFDM(0, "show", whole);
    OUT("\n  scatter       pretension 5.5 N and pretension 5 N ");
    const char *shown = out_as("s.txt");
    HIFDM(0, "show", whole, "--verbose");
    OUT("  pretension  replicate  ");
    HIFDM(0, "report", whole, "-o", page);
#define PSI "a['points/search/psi_m'][:].reshape(3, 6)"
#define GROUPS "b['replicates']['groups']"
    EXPECT(whole, json, shown, data_of(page, "p.json"), "--", "b['replicates']['figure'] == 'psi_m'",
           "np.allclose([[g[k] for k in ('minimum', 'lower_quartile', 'median', 'upper_quartile', 'maximum')] for g "
           "in " GROUPS "], np.quantile(" PSI ", (0, .25, .5, .75, 1), axis=1).T, rtol=1e-14, atol=0)",
           "[g['best'] for g in " GROUPS "] == [texts(a['points/id'])[6 * k + i] for k, i in enumerate(" PSI
           ".argmin(1))]",
           "[g['rank'] for g in " GROUPS "] == (np.median(" PSI ", 1).argsort().argsort() + 1).tolist() == [2, 1, 3]",
           "[g['input'] for g in " GROUPS "] == [{'form.pretension_N': v} for v in (5, 5.5, 20)]",
           "[g['n'] for g in " GROUPS "] == [6, 6, 6]",
           "near(b['replicates']['differ_p'], __import__('scipy.stats').stats.mannwhitneyu(" PSI "[0], " PSI
           "[1], alternative='two-sided', method='exact').pvalue, 1e-12)",
           "b['replicates']['differ'] == (b['replicates']['differ_p'] < 0.01) == ('differ by more' in "
           "b['replicates']['scatter'] and 'not' not in b['replicates']['scatter'])",
           "all('%.4f' % (1e3 * g[k]) in c.decode() for g in " GROUPS " for k in ('minimum', 'median', 'maximum'))",
           "d['study']['replicates'] == b['replicates']",
           "max(len(line) for line in c.decode().splitlines() if 'hifdm report' not in line) <= 100");
}
END_TEST

START_TEST(show_of_what_is_no_result_says_what_to_do)
{
    const char *path = file_with("s.yaml", "base: base.yaml\nsweep:\n  form.pretension_N: [5]\n");
    HIFDM(5, "show", path);
    ERR("s.yaml: this file is not a result file (HDF5) but a study. To check this file, use `hifdm check ");
    ERR("`hifdm merge ");
    HIFDM(5, "show", file_with("base.yaml", NET));
    ERR("base.yaml: this file is not a result file (HDF5) but a case. To check this file, use `hifdm check ");
    HIFDM(5, "show", file_with("other.txt", "words\n"));
}
END_TEST

/* With seed 4 and cap 4.7, one step of the refinement leads to nothing better than the search has; with 4.9 it
 * does. */
START_TEST(a_search_among_the_results_is_not_called_refinement)
{
    const char *base = source_path("configs/chen2022.yaml"),
               *path = file_with("s.yaml", formatted("base: %s\nsweep:\n  optimize.boundary_ratio_cap: [4.7, 4.9]\n"
                                                     "  optimize.refine_steps: [1]\n  optimize.generations: [60]\n"
                                                     "  optimize.seed: [4]\n",
                                                     base)),
               *merged = temp("m.h5"), *page = temp("m.html");
    HIFDM(0, "sweep", path, "--dir", temp("m.d"), "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("m.d"), "-o", merged, "--quiet");
    HIFDM(0, "show", merged);
    OUT(" psi result");
    ck_assert(!strstr(said.out, "psi refine"));
    HIFDM(0, "show", merged, "--json");
    EXPECT(merged, out_as("m.json"), "--", "a['points/refine/is_result'][:].tolist() == [0, 1]",
           "b['result'] == 'result'", "[list(p).count('refine') for p in b['points']] == [0, 0]",
           "[p['result']['psi_m'] for p in b['points']] == [a['points/search/psi_m'][0], a['points/refine/psi_m'][1]]",
           "[p['search']['psi_m'] for p in b['points']] == a['points/search/psi_m'][:].tolist()",
           "b['best'] == texts(a['points/id'])[1]");
    HIFDM(0, "report", merged, "-o", page);
    EXPECT(page, "--", "b'\"main\":\"result\"' in a.replace(b' ', b'')");
}
END_TEST

Suite *suite_cli_study(void)
{
    Suite *suite = suite_create("cli/study");
    TCase *tcase = tcase_create("study");
    tcase_add_test(tcase, errors_of_the_surface_are_columns_of_a_merge);
    tcase_add_test(tcase, load_cases_are_columns_of_a_merge);
    tcase_add_test(tcase, a_merged_study_is_shown_as_a_table);
    tcase_add_test(tcase, points_rank_by_their_requirements);
    tcase_add_test(tcase, the_tightest_requirements_have_columns);
    tcase_add_test(tcase, a_failed_point_has_no_positive_margin);
    tcase_add_test(tcase, a_point_that_fails_is_not_the_best);
    tcase_add_test(tcase, margins_of_rounding_do_not_rank);
    tcase_add_test(tcase, objectives_say_which_point_is_best);
    tcase_add_test(tcase, a_best_point_at_the_end_of_an_axis_is_told);
    tcase_add_test(tcase, failed_points_are_told_and_never_the_best);
    tcase_add_test(tcase, nodes_that_psi_counts_are_named);
    tcase_add_test(tcase, odd_names_are_shown_escaped);
    tcase_add_test(tcase, a_large_study_shows_its_best);
    tcase_add_test(tcase, check_says_what_a_sweep_would_do);
    tcase_add_test(tcase, check_counts_threads_that_have_a_point);
    tcase_add_test(tcase, check_tells_what_is_not_done);
    tcase_add_test(tcase, check_tells_the_faults_of_a_study);
    tcase_add_test(tcase, the_best_of_many_points_are_different);
    tcase_add_test(tcase, replicates_compare_methods);
    tcase_add_test(tcase, replicates_show_the_scatter_of_the_search);
    tcase_add_test(tcase, a_search_among_the_results_is_not_called_refinement);
    tcase_add_test(tcase, show_of_what_is_no_result_says_what_to_do);
    suite_add_tcase(suite, tcase);
    return suite;
}
