/* The program and LAPACK: only commands that factor something have one in their memory, and where none can be loaded
 * they say so. */
#include "cli.h"

/* The program starts with the sanitizer's library first, so that none can be loaded before it. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_PRELOAD 0
#else
#define HAS_PRELOAD 1
#endif

/* In a folder with dish.yaml and its finished result dish.h5, cut.yaml with cut.h5, the study study.yaml with
 * merged.h5, and tables. */
static const char *const factors_nothing[] = {
    "version",
    "help",
    "help run",
    "schema",
    "explain",
    "explain psi",
    "new a --paraboloid",
    "new b --cylinder",
    "new c --import",
    "show dish.h5",
    "show cut.h5 --verbose",
    "show merged.h5",
    "diff dish.h5 dish.h5",
    "report dish.h5 -o a.html",
    "report dish.h5 cut.h5 -o b.html",
    "report cut.h5 -o c.html",
    "export dish.h5 --csv csv --vtk vtk",
    "export cut.h5 --cutlist cutlist.csv --rf rf",
    "recover dish.h5",
    "status study.yaml --dir points",
    "merge study.yaml --dir points -o merged.h5",
    "run dish.yaml -o dish.h5", /* again */
};
static const char *const factors_something[] = {
    "run dish.yaml -o again.h5",
    "check dish.yaml",
    "evaluate dish.yaml --designs table.csv",
    "tolerance cut.yaml -o tolerance.h5",
    "adjust cut.yaml --measured measured.csv",
    "sweep study.yaml --dir others",
};
enum {
    N_NOTHING = sizeof factors_nothing / sizeof *factors_nothing,
    N_SOMETHING = sizeof factors_something / sizeof *factors_something
};

static const char *prepare(void)
{
    const char *library = temp("maps.so"), *folder = temp(".");
    SHELL(0, "cc -shared -fPIC -O1 -w \"$1\" -o \"$2\" -ldl", keep(source_path("tests/cli/maps.c")), library);
    file_with("dish.yaml", SMALL_SCENE SMALL_GA);
    file_with("cut.yaml",
              ON_TRUSS "tolerance: {sigma_cut_m: 0.0001, samples: 20}\n"
                       "adjust: {set: inner, range_m: 0.002, step_m: 0.0001, max_adjustments: 3, sigma_m: 0.0001}\n"
                       "surface: {frequencies_Hz: [2e9]}\n");
    file_with("study.yaml", "base: dish.yaml\nsweep:\n  form.pretension_N: [8, 12]\n");
    SHELL(
        0,
        "cd \"$1\" && \"$0\" run dish.yaml -o dish.h5 --quiet && \"$0\" run cut.yaml -o cut.h5 --quiet && "
        "\"$0\" sweep study.yaml --dir points --quiet && \"$0\" merge study.yaml --dir points -o merged.h5 --quiet && "
        "\"$0\" export cut.h5 --csv before && cut -d, -f1-4 before/nodes.csv >measured.csv && "
        "\"$0\" evaluate dish.yaml --template table.csv --quiet",
        folder);
    return library;
}

/* Runs a command; returns how many of its processes have ended, and in *n_blas how many had a LAPACK or BLAS. GSL's own
 * is of GSL. */
static int count_processes(const char *command, const char *library, int *n_blas)
{
    SHELL(0,
          "cd \"$1\" && rm -f maps.[0-9]* && MAPS=maps LD_PRELOAD=\"$2\" \"$0\" $3 >/dev/null || exit 1; "
          "for f in maps.[0-9]*; do grep -v gslcblas \"$f\" | grep -c '/lib[^/]*\\(lapack\\|blas\\)[^/]*$' || :; done",
          temp("."), library, command);
    int n = 0;
    *n_blas = 0;
    for (const char *line = said.out; *line; line = strchr(line, '\n') + 1, n++)
        *n_blas += atoi(line) > 0;
    return n;
}

START_TEST(commands_that_factor_nothing_map_no_blas)
{
    const char *library = prepare();
    int n_blas;
    if (!HAS_PRELOAD) return;
    for (int i = 0; i < N_NOTHING; i++) {
        const char *command = factors_nothing[i];
        int n = count_processes(command, library, &n_blas);
        bool has_child = strstr(command, ".h5") != NULL; /* that reads it */
        ck_assert_msg(n == 1 + has_child, "%s: %d processes", command, n);
        ck_assert_msg(n_blas == 0, "%s: %d of %d processes have a BLAS", command, n_blas, n);
    }
}
END_TEST

/* Or the test above would see nothing. */
START_TEST(commands_that_factor_have_one)
{
    const char *library = prepare();
    int n_blas;
    if (!HAS_PRELOAD) return;
    for (int i = 0; i < N_SOMETHING; i++) {
        int n = count_processes(factors_something[i], library, &n_blas);
        ck_assert_msg(n_blas >= 1, "%s: none of %d processes has a BLAS", factors_something[i], n);
    }
}
END_TEST

static bool begins_one_of(const char *name, size_t length, const char *const *command, int n)
{
    for (int i = 0; i < n; i++)
        if (!strncmp(command[i], name, length) && strcspn(command[i], " ") == length) return true;
    return false;
}

START_TEST(every_command_is_in_a_list)
{
    int n = 0;
    HIFDM(0, "help");
    for (const char *line = said.out; (line = strstr(line, "\n  hifdm ")) != NULL; n++) {
        line += strlen("\n  hifdm ");
        size_t length = strcspn(line, " ");
        ck_assert_msg(begins_one_of(line, length, factors_nothing, N_NOTHING) ||
                          begins_one_of(line, length, factors_something, N_SOMETHING),
                      "%.*s", (int)length, line);
    }
    ck_assert_int_ge(n, 18);
}
END_TEST

/* Libraries of these names that are none. Nothing is left behind, and no point of a sweep counts as failed. */
START_TEST(no_lapack)
{
    const char *folder = temp("none"), *case_file = file_with("dish.yaml", SMALL_SCENE SMALL_GA);
    const char *study = file_with("study.yaml", "base: dish.yaml\nsweep:\n  form.pretension_N: [8, 12]\n");
    const char *result = temp("dish.h5"), *points = temp("points");
    SHELL(0,
          "mkdir \"$1\" && cd \"$1\" && echo 'int nothing;' >a.c && "
          "for l in liblapack.so.3 libopenblas.so.0; do cc -shared -fPIC a.c -o $l; done",
          folder);
    SHELL(5, "LD_LIBRARY_PATH=\"$1\" \"$0\" run \"$2\" -o \"$3\" --quiet", folder, case_file, result);
    ERR("error: hifdm cannot load LAPACK: liblapack.so.3 has not all routines that are needed; libopenblas.so.0 has "
        "not all routines that are needed. Install it (Debian: liblapack3)\n");
    ck_assert(!is_there(result));
    SHELL(5, "LD_LIBRARY_PATH=\"$1\" \"$0\" sweep \"$2\" --dir \"$3\" --quiet", folder, study, points);
    ERR("error: hifdm cannot load LAPACK: ");
    HIFDM(0, "status", study, "--dir", points, "--json");
    OUT("\"failed\": 0");
    HIFDM(0, "run", case_file, "-o", result, "--quiet");
    HIFDM(0, "sweep", study, "--dir", points, "--quiet");
}
END_TEST

START_TEST(results_name_the_lapack)
{
    const char *case_file = file_with("dish.yaml", SMALL_SCENE), *result = temp("dish.h5");
    HIFDM(0, "run", case_file, "-o", result, "--quiet");
    EXPECT(result, "--", "a.attrs['lapack'].startswith(b'/')", "b'.so' in a.attrs['lapack']");
}
END_TEST

Suite *suite_cli_blas(void)
{
    Suite *suite = suite_create("cli/blas");
    TCase *tests = tcase_create("blas");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, commands_that_factor_nothing_map_no_blas);
    tcase_add_test(tests, commands_that_factor_have_one);
    tcase_add_test(tests, every_command_is_in_a_list);
    tcase_add_test(tests, no_lapack);
    tcase_add_test(tests, results_name_the_lapack);
    return suite;
}
