/* What happens to the result files of a sweep when the base case changes and changes back, and when files are removed,
 * emptied or damaged. */
#include "session.h"

#define SMALLER_GA "optimize: {population: 4, generations: 2, seed: 7}\n"

static const char *study_of(const char *base)
{
    file_with("base.yaml", base);
    return file_with("study.yaml",
                     "base: base.yaml\nsweep:\n  form.pretension_N: [8, 12]\n  optimize.range_N: [0.5, 1]\n");
}

/* A study whose one point was killed in the middle of its genetic algorithm, with generations in its journal. */
static const char *begun_study(const char *folder)
{
    file_with("base.yaml", SMALL_SCENE "optimize: {population: 20, generations: 30000, seed: 7, "
                                       "stagnation_generations: 30000, refine_steps: 1}\n");
    const char *path = file_with("study.yaml", "base: base.yaml\nsweep:\n  optimize.seed: [1]\n");
    for (;;) { /* anew when the point was done first */
        session s = start_sweep(path, folder, NULL);
        bool has_begun = freeze_when(&s, has_begun_point, folder);
        end_by(&s, SIGKILL);
        if (has_begun) return path;
        SHELL(0, "rm \"$1\"/*.h5", folder);
    }
}

/* Each row is what the run behind its link says. */
static void rows_are_of_their_files(const char *merged, int n)
{
    EXPECT(merged, "--", keep(formatted("len(a['runs']) == %d", n)), "(a['points/status'][:] == 0).all()",
           "[a['runs'][i]['search'].attrs['psi_m'] for i in texts(a['points/id'])] == "
           "a['points/search/psi_m'][:].tolist()",
           "[texts(a['runs'][i]['case/text']) == texts(a['study/base_text']) for i in a['runs']] == "
           "[True] * len(a['runs'])");
}

START_TEST(a_base_case_that_changes_back)
{
    const char *folder = temp("s.d"), *merged = temp("s.h5");
    HIFDM(0, "sweep", study_of(SMALL_SCENE SMALL_GA), "--dir", folder, "--quiet");
    HIFDM(0, "sweep", study_of(SMALL_SCENE SMALLER_GA), "--dir", folder, "--quiet", "--retry", "outdated");
    HIFDM(0, "merge", temp("study.yaml"), "--dir", folder, "-o", merged);
    rows_are_of_their_files(merged, 4);
    HIFDM(0, "show", merged);
    OUT("4 done, 0 failed, 0 missing");
    HIFDM(5, "export", merged, "--csv", temp("csv"));
    ERRS("error: %s: this file is the merged table of a sweep. Use `hifdm report` to read the table", merged);
    study_of(SMALL_SCENE SMALL_GA);
    HIFDM(0, "status", temp("study.yaml"), "--dir", folder);
    OUT("done      4");
    HIFDM(0, "merge", temp("study.yaml"), "--dir", folder, "-o", merged);
    rows_are_of_their_files(merged, 4);
}
END_TEST

/* Points of the old base that were begun are nothing to the new one. */
START_TEST(a_base_case_that_changes_under_begun_points)
{
    const char *folder = temp("s.d"), *path = begun_study(folder);
    HIFDM(0, "status", path, "--dir", folder);
    OUT("of the missing ones, 1 were begun and will go on");
    file_with("base.yaml", SMALL_SCENE SMALL_GA);
    HIFDM(0, "status", path, "--dir", folder);
    OUT("missing   1");
    ck_assert_ptr_null(strstr(said.out, "begun"));
    HIFDM(0, "sweep", path, "--dir", folder);
    OUT("1 point run");
    HIFDM(0, "merge", path, "--dir", folder, "-o", temp("s.h5"));
    rows_are_of_their_files(temp("s.h5"), 1);
}
END_TEST

START_TEST(a_row_without_its_file_is_missing)
{
    const char *path = study_of(SMALL_SCENE SMALL_GA), *folder = temp("s.d"), *merged = temp("s.h5");
    HIFDM(0, "sweep", path, "--dir", folder, "--quiet");
    SHELL(0, "cd \"$1\" && set -- *.h5 && rm $1 && : >$2", folder);
    HIFDM(0, "status", path, "--dir", folder);
    OUT("missing   2");
    OUT("of the missing ones, 2 were done, but their files are gone or unfinished");
    ck_assert_ptr_null(strstr(said.out, "begun"));
    HIFDM(0, "merge", path, "--dir", folder, "-o", merged);
    EXPECT(merged, "--", "len(a['runs']) == 2", "sorted(a['points/status'][:].tolist()) == [0, 0, 7, 7]",
           "[a['runs'][i].attrs['finished'] for i in a['runs']] == [1, 1]");
    HIFDM(0, "sweep", path, "--dir", folder);
    OUT("2 points run");
    HIFDM(0, "merge", path, "--dir", folder, "-o", merged);
    rows_are_of_their_files(merged, 4);
    /* without files, the row is all there is */
    file_with("study.yaml", "base: base.yaml\nsweep:\n  files: none\n  form.pretension_N: [8, 12]\n");
    HIFDM(0, "sweep", path, "--dir", temp("none.d"), "--quiet");
    HIFDM(0, "status", path, "--dir", temp("none.d"));
    OUT("done      2");
}
END_TEST

/* The second run of a point whose file was lost is killed: the row of the first does not make it done. */
START_TEST(a_second_run_that_was_killed_goes_on)
{
    const char *folder = temp("s.d"), *path = begun_study(folder);
    HIFDM(0, "sweep", path, "--dir", folder, "--quiet");
    SHELL(0, "rm \"$1\"/*.h5", folder);
    begun_study(folder);
    HIFDM(0, "status", path, "--dir", folder);
    OUT("missing   1");
    OUT("1 were begun and will go on");
    HIFDM(0, "sweep", path, "--dir", folder);
    OUT("1 point run");
    HIFDM(0, "merge", path, "--dir", folder, "-o", temp("s.h5"));
    rows_are_of_their_files(temp("s.h5"), 1);
}
END_TEST

/* What a failed point says to do in a sweep is what helps. */
static void retry_helps(const char *path, const char *folder, const char *why)
{
    HIFDM(3, "sweep", path, "--dir", folder);
    ck_assert_ptr_null(strstr(said.err, "HDF5-DIAG"));
    HIFDM(0, "status", path, "--dir", folder);
    OUT(why);
    OUT("(in a sweep: --retry failed)");
    OUT("--retry failed' runs these anew");
    HIFDM(0, "sweep", path, "--dir", folder, "--retry", "failed");
    OUT("1 point run");
    HIFDM(0, "merge", path, "--dir", folder, "-o", temp("s.h5"));
    rows_are_of_their_files(temp("s.h5"), 1);
    SHELL(0, "! ls \"$1\"/*.journal", folder);
}

START_TEST(a_begun_point_with_a_foreign_journal)
{
    const char *folder = temp("s.d"), *path = begun_study(folder);
    SHELL(0, "cd \"$1\" && j=$(echo *.journal) && rm $j && echo 'a diary' >../diary && ln -s ../diary $j", folder);
    retry_helps(path, folder,
                "is not a journal of hifdm, but the file has the name of a journal. Delete this file, use --restart");
    ck_assert(file_is(temp("diary"), "a diary\n")); /* only its second name went */
}
END_TEST

START_TEST(a_begun_point_with_a_cut_file)
{
    const char *folder = temp("s.d"), *path = begun_study(folder);
    SHELL(0, "truncate -s 1000 \"$1\"/*.h5", folder);
    retry_helps(path, folder, "is cut off: a truncated HDF5 file. Use --restart");
}
END_TEST

/* A point that is computed but whose file cannot get its name, in the thread that waits for the disk, has failed; the
 * others have not. */
START_TEST(a_name_that_is_taken_meanwhile)
{
    const char *folder = temp("s.d"), *path = temp("study.yaml");
    file_with("base.yaml", SMALL_SCENE "optimize: {population: 20, generations: 6000, seed: 7, "
                                       "stagnation_generations: 6000, refine_steps: 1}\n");
    file_with("study.yaml", "base: base.yaml\nsweep:\n  optimize.generations: [6000, 5999, 5998]\n");
    for (;;) { /* anew when all were done first */
        session s = start_sweep(path, folder, NULL);
        if (freeze_when(&s, has_begun_point, folder)) {
            const char *journal = keep(file_like(folder, "*.h5.journal"));
            SHELL(0, "echo mine >\"$1/x\"; mv \"$1/x\" \"${2%.journal}\"", folder, journal);
            ck_assert_int_eq(end_by(&s, SIGCONT), 3);
            SHELL(0, "grep -q mine \"${1%.journal}\"", journal);
            break;
        }
        ck_assert_int_eq(end_of(&s), 0);
        SHELL(0, "rm -r \"$1\"", folder);
    }
    HIFDM(0, "status", path, "--dir", folder);
    OUT("failed    1");
    OUT("done      2");
    OUT("another process created, replaced or removed this file during the run; this run's result is ");
    HIFDM(0, "sweep", path, "--dir", folder, "--retry", "failed");
    HIFDM(0, "status", path, "--dir", folder);
    OUT("done      3");
}
END_TEST

START_TEST(a_foreign_journal_goes_with_restart_only)
{
    const char *c = file_with("c.yaml", SMALL_SCENE SMALL_GA), *path = temp("run.h5");
    file_with("run.h5.journal", "a diary");
    HIFDM(5, "run", c, "-o", path);
    ERRS("error: %s: %s.journal is not a journal of hifdm, but the file has the name of a journal. Delete this file, "
         "use --restart",
         path, path);
    ck_assert(file_is(temp("run.h5.journal"), "a diary"));
    HIFDM(0, "run", c, "-o", path, "--restart");
    ERRS("warning: %s: %s.journal was not a journal of hifdm, so hifdm replaced this file", path, path);
    ck_assert(!is_there(temp("run.h5.journal")));
    EXPECT(path, "--", "a.attrs['finished'] == 1");
}
END_TEST

/* A pipe that nobody writes into is not waited for. */
START_TEST(what_is_no_file_in_the_folder_is_named)
{
    static const char *const name[] = {"points-zz-1.tsv", "claims"}, *const make[] = {"mkfifo", "mkdir"};
    const char *path = study_of(SMALL_SCENE SMALL_GA), *folder = temp("s.d");
    const char *there = keep(formatted("%s/%s", folder, name[_i]));
    for (int k = 0; k < 2; k++) {
        SHELL(0, "mkdir -p \"$1\" && $3 \"$2\"", folder, there, make[k]);
        HIFDM(5, "status", path, "--dir", folder);
        ERRS("error: %s: this is not a regular file. Remove it\n", there);
        HIFDM(5, "merge", path, "--dir", folder, "-o", temp("s.h5"));
        ERRS("error: %s: this is not a regular file. Remove it\n", there);
        HIFDM(5, "sweep", path, "--dir", folder);
        ERRS("error: %s: this is not a regular file. Remove it\n", there);
        SHELL(0, "rm -r \"$1\"", there);
    }
    HIFDM(0, "sweep", path, "--dir", folder, "--quiet");
    SHELL(0, "mkfifo \"$1\"", temp("pipe.h5"));
    HIFDM(5, "merge", path, "--dir", folder, "-o", temp("pipe.h5"));
    ERRS("error: %s: this is not a regular file. Use -o to choose a file name", temp("pipe.h5"));
}
END_TEST

/* 40 GB, none of them on the disk. */
START_TEST(a_table_that_is_too_long_is_not_read)
{
    const char *path = study_of(SMALL_SCENE SMALL_GA), *folder = temp("s.d"), *there = temp("s.d/points-x-1.tsv");
    static const char *const command[] = {"status", "merge", "sweep"};
    SHELL(0, "mkdir \"$1\" && truncate -s 40G \"$2\"", folder, there);
    for (int k = 0; k < 3; k++) {
        HIFDM(5, command[k], path, "--dir", folder);
        ERRS("error: %s: this file is larger than 4096 MB, so it is not a table of hifdm. Remove it\n", there);
    }
}
END_TEST

Suite *suite_cli_sweep_files(void)
{
    Suite *suite = suite_create("cli/sweep_files");
    TCase *tcase = tcase_create("sweep_files");
    tcase_add_test(tcase, a_base_case_that_changes_back);
    tcase_add_test(tcase, a_base_case_that_changes_under_begun_points);
    tcase_add_test(tcase, a_row_without_its_file_is_missing);
    tcase_add_test(tcase, a_second_run_that_was_killed_goes_on);
    tcase_add_test(tcase, a_begun_point_with_a_foreign_journal);
    tcase_add_test(tcase, a_begun_point_with_a_cut_file);
    tcase_add_test(tcase, a_name_that_is_taken_meanwhile);
    tcase_add_test(tcase, a_foreign_journal_goes_with_restart_only);
    tcase_add_loop_test(tcase, what_is_no_file_in_the_folder_is_named, 0, 2);
    tcase_add_test(tcase, a_table_that_is_too_long_is_not_read);
    suite_add_tcase(suite, tcase);
    return suite;
}
