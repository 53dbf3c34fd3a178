/* What must not be replaced stays, even if the system cannot tell what is there: tests/fault/attack.py found these. */
#include "cli.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_PRELOAD 0 /* the sanitizer's library must be loaded first */
#else
#define HAS_PRELOAD 1
#endif

static const char *sick_machine(void)
{
    const char *library = temp("sick.so");
    SHELL(0, "cc -shared -fPIC -O1 -w \"$1\" -o \"$2\" -ldl", keep(source_path("tests/cli/sick_machine.c")), library);
    return library;
}

/* A result, a table of designs, a swept study, and links: all that the commands below are given. */
static const char *folder_of_files(void)
{
    const char *folder = temp("f");
    SHELL(0, "mkdir \"$1\"", folder);
    file_with("f/c.yaml", EA_SCENE SMALL_GA);
    file_with("f/s.yaml", "base: c.yaml\nsweep: {form.pretension_N: [9, 10]}\n");
    SHELL(0,
          "cd \"$1\" && \"$0\" run c.yaml -o a.h5 --quiet && \"$0\" evaluate c.yaml --template d.csv && "
          "\"$0\" sweep s.yaml --quiet && ln -s a.h5 link.h5 && ln -s s.d/$(cd s.d; ls *.h5 | head -1) point.h5",
          folder);
    return folder;
}

static const struct {
    const char *how, *words, *spared; /* the call that fails, the command, and what it must not replace */
} blind[] = {
    {"stat 5 1 link.h5", "report a.h5 -o link.h5 --force", "a.h5"},
    {"stat 12 1 a.h5", "export a.h5 --cutlist a.h5 --force", "a.h5"},
    {"lstat 5 1 d.csv", "export a.h5 --cutlist d.csv", "d.csv"},
    {"lstat 5 1 link.h5", "report a.h5 -o link.h5 --force", "a.h5"},
    {"stat 5 1 d.csv", "evaluate c.yaml --designs d.csv -o d.csv --force", "d.csv"},
    {"stat 5 1 s.yaml", "new s", "s.yaml"},
    {"stat 5 1 a.h5", "merge s.yaml -o a.h5", "a.h5"},
    {"stat 5 2 point.h5", "merge s.yaml -o point.h5 --force", "point.h5"},
    {"lstat 5 1 a.h5", "run c.yaml -o a.h5 --set form.pretension_N=12 --quiet", "a.h5"},
};
enum { N_BLIND = sizeof blind / sizeof *blind };

START_TEST(nothing_is_replaced_blindly)
{
    const char *folder = folder_of_files(), *library = sick_machine();
    for (int i = 0; i < N_BLIND; i++) {
        SHELL(5,
              keep(formatted(
                  "cd \"$1\" && cp -L %s copy || exit 9; (export SICK='%s' LD_PRELOAD=\"$2\"; exec \"$0\" %s); "
                  "s=$?; cmp %s copy && exit $s",
                  blind[i].spared, blind[i].how, blind[i].words, blind[i].spared)),
              folder, library);
        ERR("error: ");
        SHELL(0, "cd \"$1\" && test -L link.h5 && test -L point.h5 && ! ls -A | grep 'tmp$'", folder);
    }
}
END_TEST

/* A finished result that cannot be read now is no damaged file. Of what is damaged nobody knows whether it was one. */
START_TEST(a_restart_keeps_what_it_cannot_read)
{
    const char *path = file_with("c.yaml", SMALL_SCENE SMALL_GA), *result = temp("a.h5"), *whole = temp("whole.h5");
    const char *library = sick_machine(), *damaged = temp("damaged.h5"), *earlier = temp("a.h5.before-restart");
    HIFDM(0, "run", path, "-o", whole, "--quiet");
    SHELL(0, "cp \"$1\" \"$2\"; head -c 9000 \"$1\" >\"$3\"", whole, result, damaged);
    SHELL(5, "SICK='flock 5 2 a.h5' LD_PRELOAD=\"$3\" \"$0\" run \"$1\" -o \"$2\" --restart --quiet", path, result,
          library);
    ERR("Input/output error");
    SHELL(0, "cmp \"$1\" \"$2\"; rm \"$1\"", result, whole);
    SHELL(0, "cp \"$1\" \"$2\"", damaged, result);
    SHELL(5, "SICK='writev 28 2 a.h5.journal' LD_PRELOAD=\"$3\" \"$0\" run \"$1\" -o \"$2\" --restart --quiet", path,
          result, library);
    ERR("the earlier result is ");
    SHELL(0, "cmp \"$1\" \"$2\"", earlier, damaged);
    HIFDM(0, "run", path, "-o", result, "--quiet");
    HIFDM(0, "diff", whole, result);
    ck_assert(!is_there(earlier));
}
END_TEST

/* A kill between the two changes of names leaves both names to the earlier result. */
START_TEST(a_restart_goes_on_after_a_kill_between_two_names)
{
    const char *path = file_with("c.yaml", SMALL_SCENE SMALL_GA), *result = temp("a.h5"), *whole = temp("whole.h5");
    HIFDM(0, "run", path, "-o", result, "--quiet");
    SHELL(0, "cp \"$1\" \"$2\"; ln \"$1\" \"$1.before-restart\"", result, whole);
    HIFDM(0, "run", path, "-o", result, "--restart", "--quiet");
    HIFDM(0, "diff", whole, result);
    ck_assert(!is_there(temp("a.h5.before-restart")));
}
END_TEST

/* So does a kill between the last change of names and what is removed after it; no unlink leaves the same. Without the
 * journal, which says whose it is, a file with that name stays. */
START_TEST(a_run_that_ended_before_it_cleaned_up)
{
    static const char *const again[] = {"--quiet", "--restart"};
    const char *path = file_with("c.yaml", SMALL_SCENE SMALL_GA), *result = temp("a.h5"), *library = sick_machine();
    HIFDM(0, "run", path, "-o", result, "--quiet");
    for (int i = 0; i < 2; i++) {
        SHELL(0, "SICK='unlink 13 1 a.h5' LD_PRELOAD=\"$3\" \"$0\" run \"$1\" -o \"$2\" --restart --quiet", path,
              result, library);
        ERR(": cannot remove the earlier result ");
        ck_assert(is_there(temp("a.h5.before-restart")) && is_there(temp("a.h5.journal")));
        HIFDM(0, "run", path, "-o", result, again[i]);
        ck_assert(!is_there(temp("a.h5.before-restart")) && !is_there(temp("a.h5.journal")));
    }
    write_file(temp("a.h5.before-restart"), "precious");
    HIFDM(5, "run", path, "-o", result, "--restart");
    HIFDM(0, "run", path, "-o", result);
    ck_assert(file_is(temp("a.h5.before-restart"), "precious"));
}
END_TEST

/* Exit status 1 would be an answer. */
START_TEST(a_difference_that_cannot_be_told_is_an_error)
{
    const char *path = file_with("c.yaml", SMALL_SCENE), *a = temp("a.h5"), *b = temp("b.h5");
    HIFDM(0, "run", path, "-o", a, "--quiet");
    HIFDM(0, "run", path, "-o", b, "--quiet", "--set", "form.pretension_N=12");
    HIFDM(1, "diff", a, b);
    SHELL(5, "exec \"$0\" diff \"$1\" \"$2\" >/dev/full", a, b);
    ck_assert_str_eq(said.err, "error: cannot write to standard output\n");
}
END_TEST

START_TEST(a_sweep_tells_what_it_leaves)
{
    const char *folder = folder_of_files(), *library = sick_machine();
    SHELL(0, "cd \"$1\" && rm -r s.d point.h5 && SICK='unlink 13 1 .tmp' LD_PRELOAD=\"$2\" \"$0\" sweep s.yaml --quiet",
          folder, library);
    ERR(": cannot remove the temporary file s.d/.");
    SHELL(0, "cd \"$1\" && ls -A s.d | grep -q 'tmp$' && \"$0\" sweep s.yaml --quiet", folder);
}
END_TEST

/* A result that the system cannot show is not missing. */
START_TEST(points_are_not_missing_because_nobody_sees_them)
{
    static const char *const words[] = {"status s.yaml", "merge s.yaml -o m.h5", "sweep s.yaml --quiet"};
    const char *folder = folder_of_files(), *library = sick_machine();
    for (int i = 0; i < 3; i++) {
        SHELL(5, keep(formatted("cd \"$1\"; export SICK='stat 5 1 s.d/' LD_PRELOAD=\"$2\"; exec \"$0\" %s", words[i])),
              folder, library);
        ERR(".h5: cannot get the status of this file: Input/output error");
    }
    SHELL(5, "cd \"$1\"; export SICK='realpath 5 1 s.d' LD_PRELOAD=\"$2\"; exec \"$0\" merge s.yaml -o m.h5", folder,
          library);
    ERR("m.h5: cannot create links to s.d: Input/output error");
}
END_TEST

/* HDF5 1.10 crashes when its set-up gets no memory: from what the loader needs on, in steps of less than that takes. */
START_TEST(little_memory_ends_in_words)
{
    const char *folder = folder_of_files();
    if (!HAS_PRELOAD) return; /* sanitizers map terabytes */
    SHELL(
        0,
        "cd \"$1\"; for kb in $(seq 30000 64 44000); do (ulimit -v $kb; exec \"$0\" merge s.yaml -o m.h5) >out 2>err; "
        "s=$?; case $s in 0) ;; 1 | 5 | 127) test -s err ;; *) false ;; esac || { echo \"$kb: $s\" >&2; exit 1; }; "
        "done",
        folder);
}
END_TEST

Suite *suite_cli_spared(void)
{
    Suite *suite = suite_create("cli/spared");
    TCase *tcase = tcase_create("spared");
    if (HAS_PRELOAD) tcase_add_test(tcase, nothing_is_replaced_blindly);
    if (HAS_PRELOAD) tcase_add_test(tcase, a_restart_keeps_what_it_cannot_read);
    if (HAS_PRELOAD) tcase_add_test(tcase, a_sweep_tells_what_it_leaves);
    if (HAS_PRELOAD) tcase_add_test(tcase, points_are_not_missing_because_nobody_sees_them);
    if (HAS_PRELOAD) tcase_add_test(tcase, a_run_that_ended_before_it_cleaned_up);
    tcase_add_test(tcase, a_restart_goes_on_after_a_kill_between_two_names);
    tcase_add_test(tcase, a_difference_that_cannot_be_told_is_an_error);
    tcase_add_test(tcase, little_memory_ends_in_words);
    suite_add_tcase(suite, tcase);
    return suite;
}
