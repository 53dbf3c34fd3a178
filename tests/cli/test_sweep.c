/* hifdm sweep, status and merge as a user runs them: shards, retries, interruptions. h5py and h5dump read the files. */
#include "session.h"

/* Four points of a small genetic algorithm: milliseconds, but each with a result file. */
static const char *study(void)
{
    file_with("base.yaml", SMALL_SCENE SMALL_GA);
    return file_with("study.yaml",
                     "base: base.yaml\nsweep:\n  form.pretension_N: [8, 12]\n  optimize.range_N: [0.5, 1]\n");
}

/* One of its two points does not converge. */
static const char *study_with_failure(void)
{
    file_with("base.yaml", SMALL_SCENE "form: {method: hifdm, stop: residual}\n");
    return file_with("study.yaml",
                     "base: base.yaml\nsweep:\n  form.max_iterations: [2, 100000]\n  form.pretension_N: [8]\n");
}

/* The tables are equal, and the run behind every link; n links. */
static void equal_merges(const char *one, const char *other, int n)
{
    EXPECT(one, other, "--", "differing(a, b) == []", keep(formatted("len(a['runs']) == len(b['runs']) == %d", n)),
           "[i for i in a['runs'] if differing(a['runs'][i], b['runs'][i])] == []", "len(contents(a)) > 30");
}

START_TEST(sweep_status_and_merge)
{
    const char *path = study(), *folder = temp("s.d"), *merged = temp("s.h5");
    HIFDM(5, "status", path, "--dir", folder);
    ERRS("error: %s: there is no such folder of results. Run 'hifdm sweep' to create the folder, or use the --dir "
         "option to select another folder\n",
         folder);
    SHELL(0, "cd \"$1\" && \"$0\" status \"$2\"", temp(""), path); /* not begun */
    OUT("missing   4");
    HIFDM(0, "sweep", path, "--dir", folder);
    OUT("4 points run in");
    HIFDM(0, "status", path, "--dir", folder, "--json");
    EXPECT(out_as("status.json"), "--",
           "a == {'points': 4, 'missing': 0, 'running': 0, 'done': 4, 'failed': 0, "
           "'outdated': 0, 'failures': []}");
    HIFDM(0, "merge", path, "--dir", folder, "-o", merged);
    EXPECT(merged, "--", "a['points/input/form.pretension_N'][:].tolist() == [8, 8, 12, 12]",
           "a['points/input/optimize.range_N'][:].tolist() == [0.5, 1, 0.5, 1]",
           "attribute(a['points/input/form.pretension_N'], 'units') == 'N'",
           "a['points/status'][:].tolist() == [0] * 4", "a['points/form/pretension_N'][:].tolist() == [8, 8, 12, 12]",
           "len(set(a['points/seed'][:])) == 4", "attribute(a['points/search/psi_m'], 'units') == 'm'",
           /* every row is what the run behind its link says */
           "[a['runs'][i].attrs['seed'] for i in texts(a['points/id'])] == a['points/seed'][:].tolist()",
           "[a['runs'][i]['search'].attrs['psi_m'] for i in texts(a['points/id'])] == "
           "a['points/search/psi_m'][:].tolist()",
           "[a['runs'].get(i, getlink=True).filename for i in a['runs']] == "
           "[f\"s.d/{i}-{attribute(a, 'fingerprint')[:8]}.h5\" for i in a['runs']]",
           /* nothing of the moment is in a data set */
           "[n for n in contents(a) if n.endswith('_s') or 'threads' in n] == []");
    SHELL(0, "h5dump -d /points/form/psi_m \"$1\" && h5ls -r \"$1\"", merged);
    OUT("External Link");
    SHELL(0, "cp \"$1\" \"$1.old\"", merged); /* a misspelt folder does not empty the table */
    HIFDM(5, "merge", path, "--dir", temp("sd"), "-o", merged, "--force");
    ERRS("error: %s: there is no such folder of results. ", temp("sd"));
    SHELL(0, "cmp \"$1\" \"$1.old\"", merged);
    HIFDM(0, "sweep", path, "--dir", folder);
    OUT("0 points run");
}
END_TEST

/* A point of a sweep is the run that its overrides describe. */
START_TEST(a_point_is_a_run)
{
    const char *path = study(), *merged = temp("s.h5"), *alone = temp("alone.h5");
    HIFDM(0, "sweep", path, "--dir", temp("s.d"), "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("s.d"), "-o", merged, "--quiet");
    SHELL(
        0,
        "seed=$(h5dump -d /points/seed \"$1\" | sed -n 's/ *(0): \\([0-9]*\\).*/\\1/p') && \"$0\" run \"$2\" -o \"$3\" "
        "--quiet --set form.pretension_N=8 --set optimize.range_N=0.5 --set optimize.seed=$seed",
        merged, temp("base.yaml"), alone);
    EXPECT(merged, alone, "--",
           "[n for n in differing(a['runs'][texts(a['points/id'])[0]], b) if n != 'case/overrides'] == []");
}
END_TEST

START_TEST(shards_and_threads_make_the_same_whole)
{
    const char *path = study(), *whole = temp("whole.h5"), *shards = temp("shards.h5");
    HIFDM(0, "sweep", path, "--dir", temp("whole.d"), "--threads", "1", "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("whole.d"), "-o", whole);
    HIFDM(0, "sweep", path, "--dir", temp("s.d"), "--task", "2", "--tasks", "3", "--threads", "5", "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("s.d"), "-o", shards); /* while three are missing */
    OUT("4 points, 1 of them done");
    EXPECT(shards, "--", "a['points/status'][:].tolist() == [7, 7, 0, 7]", "len(a['runs']) == 1",
           "np.isnan(a['points/search/psi_m'][:]).tolist() == [True, True, False, True]");
    SHELL(0,
          "SLURM_ARRAY_TASK_ID=10 SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_MIN=10 SLURM_ARRAY_TASK_MAX=14 "
          "SLURM_ARRAY_TASK_STEP=2 SLURM_CPUS_PER_TASK=3 exec \"$0\" sweep \"$1\" --dir \"$2\"",
          path, temp("s.d"));
    OUT("2 points run");
    OUT("on 3 threads");
    SHELL(0, "SLURM_ARRAY_TASK_ID=1 exec \"$0\" sweep \"$1\" --dir \"$2\" --tasks 3", path, temp("s.d"));
    OUT("1 point run");
    HIFDM(0, "merge", path, "--dir", temp("s.d"), "-o", shards); /* replaces the merge of before */
    equal_merges(whole, shards, 4);
}
END_TEST

START_TEST(tasks_that_would_leave_points_out_are_refused)
{
    const char *path = study();
    HIFDM(2, "sweep", path, "--task", "3", "--tasks", "3");
    ERR("task 3 of 3 does not exist, because the tasks are numbered from 0");
    HIFDM(2, "sweep", path, "--task", "1");
    HIFDM(2, "sweep", path, "--tasks", "2");
    SHELL(2,
          "SLURM_ARRAY_TASK_ID=5 SLURM_ARRAY_TASK_COUNT=2 SLURM_ARRAY_TASK_MIN=3 SLURM_ARRAY_TASK_MAX=5 "
          "exec \"$0\" sweep \"$1\"",
          path);
    ERR("the task numbers of the Slurm array have gaps");
    HIFDM(2, "sweep", path, "--retry", "everything");
    ERR("must be a list of missing, failed and outdated");
}
END_TEST

/* A weight that is an axis can be drawn against each objective: the merge has a column for each of them in each stage,
 * with the values of the files of the points. */
START_TEST(objectives_are_columns_of_a_merge)
{
    const char *path =
                   file_with("study.yaml", SMALL_SCENE "optimize:\n"
                                                       "  population: 6\n"
                                                       "  generations: 2\n"
                                                       "  method: ga+lm\n"
                                                       "  objective: [{figure: psi}, {figure: evenness, set: edge}]\n"
                                                       "sweep:\n"
                                                       "  combine: zip\n"
                                                       "  optimize.objective.1.weight: [1e-5, 1e-3, 1e-1]\n"
                                                       "  optimize.objective.1.set: [edge, edge, directrix]\n"),
               *folder = temp("s.d"), *merged = temp("s.h5"), *page = temp("s.html");
    HIFDM(0, "sweep", path, "--dir", folder);
    HIFDM(0, "merge", path, "--dir", folder, "-o", merged);
#define COLUMN(name, stage, prefix)                                                                                    \
    "all((lambda got, run: (got == run['objective/" stage "'][j]) if texts(run['objective/name'])[j] == '" name        \
    "' else "                                                                                                          \
    "np.isnan(got))(a['points/" prefix name "'][i], a['runs/' + k]) for i, k in enumerate(texts(a['points/id'])) for " \
    "j in [min(1, int('" name "'[10]))])"
    EXPECT(merged, "--", "a['points/input/optimize.objective.1.weight'][:].tolist() == [1e-5, 1e-3, 1e-1]",
           COLUMN("objective_0_psi", "form", "form/"), COLUMN("objective_0_psi", "search", "search/"),
           COLUMN("objective_0_psi", "refine", "refine/"), COLUMN("objective_1_evenness_edge", "form", "form/"),
           COLUMN("objective_1_evenness_edge", "search", "search/"),
           COLUMN("objective_1_evenness_edge", "refine", "refine/"),
           COLUMN("objective_1_evenness_directrix", "refine", "refine/"),
           "np.isnan(a['points/refine/objective_1_evenness_directrix'][:]).tolist() == [True, True, False]",
           "a['points/refine/objective_1_evenness_edge'][1] < a['points/refine/objective_1_evenness_edge'][0]",
           "attribute(a['points/refine/objective_0_psi'], 'units') == 'm'",
           "attribute(a['points/form/objective_1_evenness_edge'], 'units') == ''");
    HIFDM(0, "report", merged, "-o", page);
    EXPECT(page, "--", "a.count(b'\"objective_1_evenness_edge\":[') == 3 and a.count(b'\"objective_0_psi\":[') == 3");
}
END_TEST

/* Amounts are numbers in the merged file unless one of them is a part; lists are texts. */
START_TEST(keys_of_rows_are_swept_and_merged)
{
    const char *path = file_with("study.yaml", SMALL_SCENE "surface: {}\n"
                                                           "optimize:\n"
                                                           "  population: 6\n"
                                                           "  generations: 3\n"
                                                           "  variables:\n"
                                                           "    - {set: boundary, vary: force_density, range: 1}\n"
                                                           "    - {set: inner, vary: tension, range: 1}\n"
                                                           "sweep:\n"
                                                           "  combine: zip\n"
                                                           "  optimize.variables.0.range: [0.5, 1e-1]\n"
                                                           "  optimize.variables.1.range: [0.5, 30%]\n"
                                                           "  surface.frequencies_Hz: [[1e9, 2e9], [3e9]]\n"),
               *folder = temp("s.d"), *merged = temp("s.h5");
    HIFDM(0, "sweep", path, "--dir", folder);
    HIFDM(0, "merge", path, "--dir", folder, "-o", merged);
    EXPECT(merged, "--", "a['points/input/optimize.variables.0.range'][:].tolist() == [0.5, 0.1]",
           "texts(a['points/input/optimize.variables.1.range']) == ['0.5', '30 %']",
           "texts(a['points/input/surface.frequencies_Hz']) == ['[1e9,2e9]', '[3e9]']");
}
END_TEST

START_TEST(a_failed_point_stops_no_other)
{
    const char *path = study_with_failure(), *folder = temp("s.d"), *merged = temp("s.h5");
    HIFDM(3, "sweep", path, "--dir", folder);
    OUT("2 points run");
    OUT("1 of them failed");
    ERR("error: 1 point failed. 'hifdm status' lists the reasons");
    HIFDM(0, "status", path, "--dir", folder);
    OUT("failed    1");
    OUT("form.max_iterations=2, form.pretension_N=8: form-finding did not converge in 2 iterations");
    HIFDM(3, "sweep", path, "--dir", folder); /* still failed, and left alone */
    OUT("0 points run");
    HIFDM(3, "sweep", path, "--dir", folder, "--retry", "failed,missing");
    OUT("1 point run");
    HIFDM(0, "merge", path, "--dir", folder, "-o", merged);
    EXPECT(merged, "--", "a['points/status'][:].tolist() == [1, 0]", "len(a['runs']) == 0",
           "texts(a['points/reason'])[0].startswith('form-finding did not converge')",
           "a['points/input/form.max_iterations'][:].tolist() == [2, 100000]");
}
END_TEST

/* A corner of the axes that is no case: the others are run and merged. */
START_TEST(an_impossible_point_stops_no_other)
{
    const char *folder = temp("s.d"), *merged = temp("s.h5");
    file_with("base.yaml", SMALL_SCENE SMALL_GA);
    const char *path =
        file_with("study.yaml", "base: base.yaml\nsweep:\n  optimize.elites: [6, 1]\n  form.pretension_N: [8, 9]\n");
    HIFDM(3, "check", path);
    ERR("point form.pretension_N=8, optimize.elites=6: --set optimize.elites: must be below optimize.population");
    HIFDM(3, "sweep", path, "--dir", folder);
    OUT("4 points run");
    OUT("2 of them failed");
    HIFDM(0, "status", path, "--dir", folder);
    OUT("done      2");
    OUT("failed    2");
    OUT("form.pretension_N=9, optimize.elites=6: --set optimize.elites: must be below optimize.population");
    HIFDM(0, "merge", path, "--dir", folder, "-o", merged);
    OUT("4 points, 2 of them done, 2 failed");
    EXPECT(merged, "--", "sorted(a['points/status'][:].tolist()) == [0, 0, 21, 21]", "len(a['runs']) == 2",
           "sum(r.startswith('--set optimize.elites: must be below') for r in texts(a['points/reason'])) "
           "== 2");
}
END_TEST

/* A folder stands where the result file of a point should: that point fails, and can be run again when it is gone. */
START_TEST(what_failed_can_be_run_again)
{
    const char *path = study(), *folder = temp("s.d"), *merged = temp("s.h5"), *clean = temp("clean.h5");
    HIFDM(0, "sweep", path, "--dir", temp("clean.d"), "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("clean.d"), "-o", clean);
    SHELL(0, "id=$(basename $(ls \"$1\"/*.h5 | head -n 1)) && mkdir -p \"$2/$id\" && echo \"$2/$id\" >\"$3\"",
          temp("clean.d"), folder, temp("blocked"));
    HIFDM(3, "sweep", path, "--dir", folder);
    OUT("4 points run");
    HIFDM(0, "status", path, "--dir", folder);
    OUT("is a folder");
    SHELL(0, "rmdir $(cat \"$1\")", temp("blocked"));
    HIFDM(0, "sweep", path, "--dir", folder, "--retry", "failed");
    OUT("1 point run");
    HIFDM(0, "merge", path, "--dir", folder, "-o", merged);
    equal_merges(clean, merged, 4);
}
END_TEST

START_TEST(results_of_another_base_case_are_not_mixed_in)
{
    const char *path = study(), *folder = temp("s.d");
    HIFDM(0, "sweep", path, "--dir", folder, "--quiet");
    file_with("base.yaml", SMALL_SCENE "form: {residual_tolerance: 1e-10}\n" SMALL_GA);
    HIFDM(5, "sweep", path, "--dir", folder);
    ERR("the base case has changed since 4 points were run");
    HIFDM(0, "status", path, "--dir", folder);
    OUT("outdated  4");
    HIFDM(5, "merge", path, "--dir", folder, "-o", temp("merged.h5"));
    ERR("4 points are outdated, because the base case has changed since. Run 'hifdm sweep ");
    ck_assert(!is_there(temp("merged.h5")));
    HIFDM(0, "merge", path, "--dir", folder, "-o", temp("merged.h5"), "--force");
    HIFDM(0, "sweep", path, "--dir", folder, "--retry", "outdated,missing");
    OUT("4 points run");
    HIFDM(0, "status", path, "--dir", folder);
    OUT("done      4");
}
END_TEST

START_TEST(results_of_other_tables_are_not_mixed_in)
{
    static const char nodes[] = "id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0,support\nc,1,0.5,0.1,inner\n"
                                "d,1,1.7,0,support\n";
    const char *path = file_with("study.yaml", "base: net.yaml\nsweep:\n  form.pretension_N: [10, 11]\n");
    net_with(nodes, "id,i,j,group,law,value\n1,a,c,inner,tension,\n2,b,c,inner,tension,10\n3,c,d,inner,tension,12\n");
    HIFDM(0, "sweep", path, "--dir", temp("s.d"), "--quiet");
    net_with(nodes, "id,i,j,group,law,value\n1,a,c,inner,tension,\n2,b,c,inner,tension,11\n3,c,d,inner,tension,12\n");
    HIFDM(0, "status", path, "--dir", temp("s.d"));
    OUT("outdated  2");
}
END_TEST

START_TEST(a_case_with_a_sweep_of_its_own)
{
    const char *path = file_with("one.yaml", SMALL_SCENE "sweep:\n  form.pretension_N: [8, 9, 10]\n  files: all\n");
    HIFDM(2, "run", path, NOWHERE);
    ERR("this file has a `sweep` section. Run the study with 'hifdm sweep ");
    HIFDM(0, "check", path);
    HIFDM(0, "sweep", path, "--dir", temp("s.d"), "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("s.d"), "-o", temp("s.h5"));
    EXPECT(temp("s.h5"), "--", "len(a['runs']) == 3", "a['points/form/pretension_N'][:].tolist() == [8, 9, 10]",
           "'sweep' not in texts(a['runs'][texts(a['points/id'])[0]]['case/text'])");
    /* another point more: the three are not run again */
    file_with("one.yaml", SMALL_SCENE "sweep:\n  form.pretension_N: [7, 8, 9, 10]\n  files: all\n");
    HIFDM(0, "sweep", path, "--dir", temp("s.d"));
    OUT("1 point run");
    HIFDM(2, "run", study(), NOWHERE);
    ERR("a file with a base is a study, for 'hifdm sweep'");
    ck_assert_msg(!strstr(said.err, "needs either"), "%s", said.err); /* a study has no scene of its own */
}
END_TEST

/* One of six points is done, or two: the others are not. */
static bool is_in_the_middle(const char *folder)
{
    int n = 0;
    const char *rows = file_like(folder, "points-*.tsv");
    if (!rows) return false;
    char *text = read_file(rows, NULL);
    n = count_of(text, "\tok\t");
    free(text);
    return n == 1 || n == 2;
}

/* Told to stop in the middle: exit code 75, and the same command finishes, to the same results. */
START_TEST(a_stopped_sweep_goes_on)
{
    file_with("base.yaml", SMALL_SCENE "optimize: {population: 100, generations: 1000, stagnation_generations: 1000, "
                                       "refine_steps: 1}\n");
    const char *path = file_with("study.yaml", "base: base.yaml\nsweep:\n  optimize.seed: {from: 1, to: 6, n: 6}\n");
    HIFDM(0, "sweep", path, "--dir", temp("whole.d"), "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("whole.d"), "-o", temp("whole.h5"));
    int code = 0;
    while (code == 0) { /* anew when it was over first */
        SHELL(0, "rm -rf \"$1\"", temp("s.d"));
        session s = start_sweep(path, temp("s.d"), "1");
        code = end_by(&s, freeze_when(&s, is_in_the_middle, temp("s.d")) ? SIGTERM : SIGCONT);
    }
    ck_assert_int_eq(code, 75);
    ck_assert(says(temp("err"), ". Run the same command again to resume"));
    HIFDM(0, "status", path, "--dir", temp("s.d"));
    OUT("running   0");
    HIFDM(0, "sweep", path, "--dir", temp("s.d"));
    HIFDM(0, "merge", path, "--dir", temp("s.d"), "-o", temp("s.h5"));
    equal_merges(temp("whole.h5"), temp("s.h5"), 6);
}
END_TEST

/* Killed six times, each after a random number of changes in its folder: it goes on with what is missing, to the same
 * results. */
START_TEST(a_killed_sweep_goes_on)
{
    file_with("base.yaml", SMALL_SCENE "optimize: {population: 60, generations: 300, stagnation_generations: 300, "
                                       "refine_steps: 1}\n");
    const char *path = file_with("study.yaml", "base: base.yaml\nsweep:\n  optimize.seed: {from: 1, to: 6, n: 6}\n");
    HIFDM(0, "sweep", path, "--dir", temp("whole.d"), "--quiet");
    HIFDM(0, "merge", path, "--dir", temp("whole.d"), "-o", temp("whole.h5"));
    struct rng rng = rng_start(0);
    int most = 300;
    for (int n_killed = 0; n_killed < 6;) {
        session s = start_sweep(path, temp("s.d"), NULL);
        int n_change = rng_int(&rng, 1, most);
        while (s.n_change < n_change && wait_for_change(&s)) {
        }
        if (end_by(&s, SIGKILL) == 128 + SIGKILL) {
            n_killed++;
        } else { /* on a busy machine several changes are seen as one */
            SHELL(0, "rm -r \"$1\"", temp("s.d"));
            most = most / 2 + 1;
        }
    }
    HIFDM(0, "status", path, "--dir", temp("s.d"));
    OUT("running   0");
    OUT("failed    0");
    HIFDM(0, "sweep", path, "--dir", temp("s.d"));
    HIFDM(0, "merge", path, "--dir", temp("s.d"), "-o", temp("s.h5"));
    equal_merges(temp("whole.h5"), temp("s.h5"), 6);
}
END_TEST

/* Two sweeps of the same points at once: no point is run twice. */
START_TEST(two_sweeps_share_the_points)
{
    file_with("base.yaml", SMALL_SCENE);
    const char *path = file_with("study.yaml", "base: base.yaml\nsweep:\n"
                                               "  form.pretension_N: {from: 1, to: 5, n: 2000}\n");
    SHELL(
        0,
        "\"$0\" sweep \"$1\" --dir \"$2\" --quiet --threads 2 & \"$0\" sweep \"$1\" --dir \"$2\" --quiet --threads 2; "
        "wait; cat \"$2\"/points-*.tsv | grep -vc '^#'",
        path, temp("s.d"));
    ck_assert_str_eq(said.out, "2000\n");
}
END_TEST

/* The row of a finished run was lost: it is read from the result file, which is not touched. */
START_TEST(a_finished_result_is_not_run_again)
{
    const char *path = study(), *folder = temp("s.d");
    HIFDM(0, "sweep", path, "--dir", folder, "--quiet");
    HIFDM(0, "merge", path, "--dir", folder, "-o", temp("before.h5"));
    SHELL(0, "cd \"$1\" && rm points-* && sha256sum *.h5 >sums", folder);
    HIFDM(0, "status", path, "--dir", folder);
    OUT("missing   4");
    HIFDM(0, "sweep", path, "--dir", folder);
    SHELL(0, "cd \"$1\" && sha256sum -c --quiet sums", folder);
    HIFDM(0, "merge", path, "--dir", folder, "-o", temp("after.h5"));
    equal_merges(temp("before.h5"), temp("after.h5"), 4);
}
END_TEST

START_TEST(merge_replaces_only_merges)
{
    const char *path = study(), *precious = file_with("precious.h5", "not a merge\n");
    SHELL(0, "mkdir \"$1\"", temp("s.d"));
    HIFDM(5, "merge", path, "--dir", temp("s.d"), "-o", precious);
    ERR("exists and is not a merged study");
    ck_assert(file_is(precious, "not a merge\n"));
    HIFDM(0, "merge", path, "--dir", temp("s.d"), "-o", precious, "--force"); /* of four missing points */
    EXPECT(precious, "--", "a['points/status'][:].tolist() == [7] * 4");
    HIFDM(5, "merge", path, "--dir", temp("s.d"), "-o", temp("no/such/folder.h5"));
}
END_TEST

START_TEST(the_shipped_studies_are_valid)
{
    SHELL(0, "mkdir \"$1\"", temp("s.d"));
    HIFDM(0, "status", keep(source_path("configs/pretension-sweep.yaml")), "--dir", temp("s.d"));
    OUT("64 points");
    /* the truss deflects: more at each step, and the shape is worse in the end */
    const char *truss = keep(source_path("configs/pretension-truss.yaml"));
    HIFDM(0, "sweep", truss, "--dir", temp("t.d"), "--quiet");
    HIFDM(0, "merge", truss, "--dir", temp("t.d"), "-o", temp("t.h5"));
    EXPECT(temp("t.h5"), "--", "(np.diff(a['points/coupling/deflection_max_m'][:]) > 0).all()",
           "(np.diff(a['points/form/psi_m'][:]) > 0).all()", "(a['points/truss/mass_kg'][:] > 0).all()",
           "len(a['runs']) == 0", "'points/search' not in a");
}
END_TEST

Suite *suite_cli_sweep(void)
{
    Suite *suite = suite_create("cli/sweep");
    TCase *tcase = tcase_create("sweep");
    tcase_add_test(tcase, sweep_status_and_merge);
    tcase_add_test(tcase, keys_of_rows_are_swept_and_merged);
    tcase_add_test(tcase, a_point_is_a_run);
    tcase_add_test(tcase, objectives_are_columns_of_a_merge);
    tcase_add_test(tcase, shards_and_threads_make_the_same_whole);
    tcase_add_test(tcase, tasks_that_would_leave_points_out_are_refused);
    tcase_add_test(tcase, a_failed_point_stops_no_other);
    tcase_add_test(tcase, an_impossible_point_stops_no_other);
    tcase_add_test(tcase, what_failed_can_be_run_again);
    tcase_add_test(tcase, results_of_another_base_case_are_not_mixed_in);
    tcase_add_test(tcase, results_of_other_tables_are_not_mixed_in);
    tcase_add_test(tcase, a_case_with_a_sweep_of_its_own);
    tcase_add_test(tcase, a_stopped_sweep_goes_on);
    tcase_add_test(tcase, a_killed_sweep_goes_on);
    tcase_add_test(tcase, two_sweeps_share_the_points);
    tcase_add_test(tcase, a_finished_result_is_not_run_again);
    tcase_add_test(tcase, merge_replaces_only_merges);
    tcase_add_test(tcase, the_shipped_studies_are_valid);
    suite_add_tcase(suite, tcase);
    return suite;
}
