/* The result files of a sweep: base cases that change and change back, files that are removed, emptied or spoilt. */
#include "cli.h"

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
                                       "stagnation_generations: 30000, polish_iterations: 1}\n");
    const char *path = file_with("study.yaml", "base: base.yaml\nsweep:\n  optimize.seed: [1]\n");
    SHELL(0,
          "\"$0\" sweep \"$1\" --dir \"$2\" --quiet & until cat \"$2\"/*.h5 2>/dev/null | grep -q .; do sleep 0.01; "
          "done; kill -KILL $!; wait $!; ls \"$2\"/*.h5.journal",
          path, folder);
    return path;
}

/* Each row is what the run behind its link says. */
static void rows_are_of_their_files(const char *merged, int n)
{
    EXPECT(merged, "--", keep(formatted("len(a['runs']) == %d", n)), "(a['points/status'][:] == 0).all()",
           "[a['runs'][i]['ga'].attrs['best_psi_m'] for i in texts(a['points/id'])] == "
           "a['points/ga/best_psi_m'][:].tolist()",
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
    OUT("1 points run");
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
    OUT("of the missing ones, 2 were done, but their files are gone");
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

Suite *suite_cli_sweep_files(void)
{
    Suite *suite = suite_create("cli/sweep_files");
    TCase *tcase = tcase_create("sweep_files");
    tcase_add_test(tcase, a_base_case_that_changes_back);
    tcase_add_test(tcase, a_base_case_that_changes_under_begun_points);
    tcase_add_test(tcase, a_row_without_its_file_is_missing);
    suite_add_tcase(suite, tcase);
    return suite;
}
