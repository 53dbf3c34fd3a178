/* `hifdm diff` says what differs and where; progress for programs. */
#include "session.h"

START_TEST(differences_are_named)
{
    const char *c = file_with("c.yaml", SMALL_SCENE SMALL_GA), *a = temp("a.h5"), *b = temp("b.h5");
    HIFDM(0, "run", c, "-o", a, "--quiet", "--threads", "1");
    HIFDM(0, "run", c, "-o", b, "--quiet", "--threads", "3");
    HIFDM(0, "diff", a, b);
    OUT(" data sets, 0 differ; attributes (times, machine, provenance, summary) are not compared\n");
    SHELL(0,
          "\"$1\" -c 'import h5py, sys; f = h5py.File(sys.argv[1], \"a\"); f[\"search/population/psi_m\"][2, 4] *= 1 + "
          "1e-9; "
          "f[\"form/law\"][3] = 2; del f[\"refine/law\"], f[\"VTKHDF\"]; "
          "f[\"more\"] = 1' \"$2\"",
          python_program(), b);
    HIFDM(1, "diff", a, b);
    OUT("/search/population/psi_m [2, 4]: 0.0");
    OUT("/form/law [3]: ");
    OUT(", force_density in ");
    OUT(formatted("/refine/law is not in %s\n", b));
    OUT(formatted("/more is not in %s\n", a));
    OUT("4 differ;");
    HIFDM(1, "diff", a, b, "--rtol", "1e-8");
    OUT("3 differ;");
    HIFDM(5, "diff", a, c);
    HIFDM(2, "diff", a);
    HIFDM(2, "diff", a, b, "--rtol", "-1");
}
END_TEST

/* In a result /VTKHDF is what its other groups say; a file of `export --vtk` has nothing else. */
START_TEST(exports_are_compared)
{
    const char *a = temp("a.h5"), *b = temp("b.h5"), *of_a = temp("a"), *of_b = temp("b");
    HIFDM(0, "run", file_with("c.yaml", SMALL_SCENE), "-o", a, "--quiet");
    HIFDM(0, "run", temp("c.yaml"), "-o", b, "--quiet", "--set", "form.pretension_N=7");
    HIFDM(0, "export", a, "--vtk", of_a);
    HIFDM(0, "export", b, "--vtk", of_b);
    HIFDM(0, "diff", temp("a/target.hdf"), temp("b/target.hdf"));
    HIFDM(1, "diff", temp("a/form.hdf"), temp("b/form.hdf"));
    OUT("/VTKHDF/CellData/tension_N [0]: ");
}
END_TEST

/* A pipe that nobody writes into is not waited for. */
START_TEST(what_is_no_file_is_named)
{
    const char *c = file_with("c.yaml", SMALL_SCENE), *a = temp("a.h5"), *pipe = temp("pipe");
    HIFDM(0, "run", c, "-o", a, "--quiet");
    SHELL(0, "mkfifo \"$1\"", pipe);
    HIFDM(5, "diff", a, pipe);
    ERRS("error: %s: this file is not a result of hifdm, because it is not an HDF5 file\n", pipe);
    HIFDM(5, "diff", pipe, a);
    ERRS("error: %s: this file is not a result of hifdm, because it is not an HDF5 file\n", pipe);
    HIFDM(5, "diff", a, temp(""));
    ERR("this is a folder, not a result file\n");
    HIFDM(5, "diff", a, temp("none.h5"));
    ERRS("error: %s: cannot open: No such file or directory\n", temp("none.h5"));
}
END_TEST

/* |a-b| <= R |b|: the second file is what the first is held against. */
START_TEST(the_tolerance_is_relative_to_the_second_file)
{
    const char *c = file_with("c.yaml", SMALL_SCENE), *a = temp("a.h5"), *b = temp("b.h5");
    HIFDM(0, "run", c, "-o", a, "--quiet");
    SHELL(0,
          "cp \"$2\" \"$3\" && \"$1\" -c 'import h5py, sys; h5py.File(sys.argv[1], \"a\")[\"form/tension_N\"][2] *= "
          "1.25' "
          "\"$3\"",
          python_program(), a, b);
    HIFDM(0, "diff", a, b, "--rtol", "0.22");
    HIFDM(1, "diff", b, a, "--rtol", "0.22");
    HIFDM(0, "diff", b, a, "--rtol", "0.26");
    HIFDM(1, "diff", a, b, "--rtol", "0.19");
    SHELL(0,
          "\"$1\" -c 'import h5py, sys; h5py.File(sys.argv[1], \"a\")[\"form/tension_N\"][2] = float(\"inf\")' \"$2\"",
          python_program(), b);
    HIFDM(1, "diff", a, b, "--rtol", "0.26"); /* no number is near infinity */
}
END_TEST

START_TEST(progress_for_programs)
{
    const char *c = file_with("c.yaml", SMALL_SCENE SMALL_GA);
    HIFDM(0, "run", c, "-o", temp("a.h5"), "--progress", "jsonl");
    ERR("{\"phase\": \"form\"}\n{\"phase\": \"search\", \"generation\": 1, \"generations\": 3,");
    ERR("\"generation\": 3, \"generations\": 3, \"first_generation\": 0, \"evaluations\": ");
    ERR("{\"phase\": \"refine\"}\n");
    HIFDM(0, "run", c, "-o", temp("a.h5"), "--restart");
    ck_assert_str_eq(said.err, ""); /* short runs are quiet where nobody watches */
    HIFDM(0, "run", c, "-o", temp("a.h5"), "--restart", "--progress", "line");
    ERR("\r\033[Kgeneration 1/3  best psi ");
    EXPECT(file_with("err.txt", said.err), temp("a.h5"), "--",
           "('generation 1/3  best psi %.4f mm' % (b['search/population/best_psi_m'][0] * 1e3)).encode() in a");
    HIFDM(2, "run", c, "-o", temp("a.h5"), "--progress", "loud");
    ERR("--progress must be auto, none, line, log or jsonl, not 'loud'");
}
END_TEST

Suite *suite_cli_diff(void)
{
    Suite *suite = suite_create("cli/diff");
    TCase *tcase = tcase_create("diff");
    tcase_add_test(tcase, differences_are_named);
    tcase_add_test(tcase, exports_are_compared);
    tcase_add_test(tcase, the_tolerance_is_relative_to_the_second_file);
    tcase_add_test(tcase, what_is_no_file_is_named);
    tcase_add_test(tcase, progress_for_programs);
    suite_add_tcase(suite, tcase);
    return suite;
}
