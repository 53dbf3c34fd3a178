/* Damaged files: HDF5 crashes on some, and may read others for ever. What is made to do so here is a call of it, by a
 * library that is loaded first. */
#include "cli.h"

/* H5Dread that aborts in a copy of the program at call number AT; with HANG it waits, with LOOP it computes for ever,
 * with KILLED it ends as one whose memory the system takes. A limit of 60 s becomes one of 1 s. */
static const char reader[] = "#define _GNU_SOURCE\n"
                             "#include <dlfcn.h>\n#include <fcntl.h>\n#include <signal.h>\n#include <stdlib.h>\n"
                             "#include <unistd.h>\n"
                             "#include <sys/resource.h>\n"
                             "typedef int call(long, long, long, long, long, void *);\n"
                             "typedef int limit(int, const struct rlimit *);\n"
                             "static int first;\n"
                             "__attribute__((constructor)) static void begin(void) { first = getpid(); }\n"
                             "int setrlimit(__rlimit_resource_t what, const struct rlimit *wanted)\n{\n"
                             "    struct rlimit less = *wanted;\n"
                             "    if (what == RLIMIT_CPU && less.rlim_cur != RLIM_INFINITY) less.rlim_cur -= 59;\n"
                             "    return ((limit *)dlsym(RTLD_NEXT, \"setrlimit\"))(what, &less);\n}\n"
                             "int H5Dread(long a, long b, long c, long d, long e, void *f)\n{\n"
                             "    static int n;\n"
                             "    const char *mark = getenv(\"HANG\");\n"
                             "    if (getpid() != first && ++n == atoi(getenv(\"AT\"))) {\n"
                             "        while (getenv(\"LOOP\")) {}\n"
                             "        if (getenv(\"KILLED\")) raise(SIGKILL);\n"
                             "        if (!mark) abort();\n"
                             "        open(mark, O_CREAT | O_WRONLY, 0600);\n"
                             "        for (;;) pause();\n"
                             "    }\n"
                             "    return ((call *)dlsym(RTLD_NEXT, \"H5Dread\"))(a, b, c, d, e, f);\n}\n";

/* The path of the library. A sanitizer that is not loaded first does not mind here. */
static const char *make_library(void)
{
    const char *source = file_with("reader.c", reader), *library = temp("reader.so");
    SHELL(0, "cc -shared -fPIC -o \"$2\" \"$1\" -ldl", source, library);
    return library;
}

#define WITH_LIBRARY                                                                                                   \
    "export ASAN_OPTIONS=\"$ASAN_OPTIONS:verify_asan_link_order=0:detect_leaks=0\" LD_PRELOAD=\"$1\" AT=\"$2\"; "

/* Makes an unfinished result of a finished one. As unfinished ones it has none of the links that lead from the names of
 * version 0.2 to those of today. */
static const char *unfinished(const char *path)
{
    static const char deed[] = "import h5py, sys\n"
                               "f = h5py.File(sys.argv[1], 'a')\n"
                               "f.attrs.modify('finished', 0)\n"
                               "groups = [f]\n"
                               "f.visititems(lambda name, x: groups.append(x) if isinstance(x, h5py.Group) else None)\n"
                               "for g in groups:\n"
                               "    for name in [n for n in g if isinstance(g.get(n, getlink=True), h5py.SoftLink)]:\n"
                               "        del g[name]\n";
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(), deed, path);
    return path;
}

START_TEST(a_crash_of_hdf5_names_the_file)
{
    const char *library = make_library(), *c = file_with("c.yaml", SMALL_SCENE SMALL_GA);
    const char *a = temp("a.h5"), *b = temp("b.h5");
    HIFDM(0, "run", c, "-o", a, "--quiet");
    HIFDM(0, "run", c, "-o", b, "--quiet");
    SHELL(5, WITH_LIBRARY "exec \"$0\" diff \"$3\" \"$4\"", library, "1", a, b);
    ERRS("error: %s: this file is damaged. The process that read the file was ended by signal 6 (Aborted), beside %s\n",
         a, b);
    SHELL(5, WITH_LIBRARY "exec \"$0\" diff \"$3\" \"$4\"", library, "2", a, b);
    ERRS("error: %s: this file is damaged. The process that read the file was ended by signal 6 (Aborted), beside %s\n",
         b, a);
    SHELL(5, WITH_LIBRARY "exec \"$0\" report \"$3\" -o \"$4\"", library, "3", a, temp("page.html"));
    ERRS("error: %s: this file is damaged. The process that read the file was ended by signal 6", a);
    ck_assert(!is_there(temp("page.html")));
    SHELL(5, WITH_LIBRARY "exec \"$0\" export \"$3\" --csv \"$4\"", library, "9", a, temp("csv"));
    ERRS("error: %s: this file is damaged. The process that read the file was ended by signal 6", a);
    SHELL(5, WITH_LIBRARY "exec \"$0\" run \"$4\" -o \"$3\"", library, "5", unfinished(a), c);
    ERRS("error: %s: this file exists and is damaged. The process that read the file was ended by signal 6 (Aborted). "
         "Use --restart",
         a);
    HIFDM(0, "diff", b, b);
    OUT(" 0 differ;");
    SHELL(0, "exec \"$1\" -c \"$2\" \"$0\" show \"$3\"", python_program(), /* as some launchers leave it */
          "import os, signal, sys\nsignal.signal(signal.SIGCHLD, signal.SIG_IGN)\nos.execv(sys.argv[1], sys.argv[1:])",
          b);
    OUT("\n  form            39.2743 ");
}
END_TEST

/* Both processes end; else this test would wait for the one that still holds the output. */
START_TEST(a_signal_ends_the_reader)
{
    const char *library = make_library(), *c = file_with("c.yaml", SMALL_SCENE), *a = temp("a.h5");
    HIFDM(0, "run", c, "-o", a, "--quiet");
    SHELL(0,
          WITH_LIBRARY "export HANG=\"$4\"; \"$0\" diff \"$3\" \"$3\" & unset LD_PRELOAD; "
                       "while test ! -e \"$4\"; do sleep 0.01; done; kill $!; wait $!; echo $?",
          library, "1", a, temp("mark"));
    ck_assert_str_eq(said.out, "143\n");
}
END_TEST

/* Signal 24 is SIGXCPU. */
START_TEST(a_read_without_end_is_ended)
{
    const char *library = make_library(), *c = file_with("c.yaml", SMALL_SCENE SMALL_GA), *a = temp("a.h5");
    HIFDM(0, "run", c, "-o", a, "--quiet");
    SHELL(5, "export LOOP=1; " WITH_LIBRARY "exec \"$0\" export \"$3\" --csv \"$4\"", library, "4", a, temp("csv"));
    ERRS("error: %s: this file is damaged. The process that read the file was ended by signal 24 (CPU time limit "
         "exceeded)\n",
         a);
    SHELL(5, "export LOOP=1; " WITH_LIBRARY "exec \"$0\" run \"$4\" -o \"$3\"", library, "1", unfinished(a), c);
    ERRS("error: %s: this file exists and is damaged. The process that read the file was ended by signal 24 (CPU time "
         "limit exceeded). Use --restart",
         a);
}
END_TEST

#define STUDY "base: c.yaml\nsweep:\n  form.pretension_N: [8, 9]\n"

/* A merge is made of the ledger, so it does not notice; a sweep leaves the file alone and runs the other points. */
START_TEST(a_damaged_point_stops_no_other)
{
    file_with("c.yaml", SMALL_SCENE SMALL_GA);
    const char *study = file_with("s.yaml", STUDY), *folder = temp("s.d"), *merged = temp("m.h5");
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet");
    SHELL(0, "cd \"$1\"; set -- *.h5; head -c 3000 \"$1\" >t && mv t \"$1\"; echo \"$1\"", folder);
    said.out[strcspn(said.out, "\n")] = '\0';
    const char *point = keep(formatted("%s/%s", folder, said.out));
    HIFDM(0, "merge", study, "--dir", folder, "-o", merged);
    OUT("2 points, 2 of them done, 0 failed");
    HIFDM(5, "show", point);
    ERR(point);
    SHELL(0, "rm \"$1\"/points-*.tsv", folder);
    HIFDM(3, "sweep", study, "--dir", folder, "--quiet");
    HIFDM(0, "status", study, "--dir", folder);
    OUT("done      1\n  failed    1\n");
    OUT(formatted(
        "%s: this file exists and is cut off: a truncated HDF5 file. Use --restart (in a sweep: --retry failed)",
        point));
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet", "--retry", "failed");
    HIFDM(0, "show", point);
}
END_TEST

/* HDF5 1.10 loses memory when a checksum is wrong: not ours to mend. */
static void allow_leaks(void)
{
    const char *options = getenv("ASAN_OPTIONS");
    setenv("ASAN_OPTIONS", formatted("%s:detect_leaks=0", options ? options : ""), 1);
}

/* A data set that a run reads only when it writes its result: its header does not have its checksum. */
START_TEST(damage_that_is_found_late_is_no_fault_of_the_machine)
{
    allow_leaks();
    const char *c = file_with("c.yaml", SMALL_SCENE SMALL_GA), *a = temp("a.h5");
    const char *study = file_with("s.yaml", "base: c.yaml\nsweep:\n  form.pretension_N: [8, 10]\n"),
               *folder = temp("s.d");
    const char *spoil = "\"$1\" -c 'import h5py, sys\nwith h5py.File(sys.argv[1], \"r\") as f: "
                        "at = h5py.h5o.get_info(f[\"scene/cable/group\"].id).addr\n"
                        "with open(sys.argv[1], \"r+b\") as f:\n f.seek(at + 20); b = f.read(1); f.seek(at + 20); "
                        "f.write(bytes([b[0] ^ 1]))' \"$2\"";
    HIFDM(0, "run", c, "-o", a, "--quiet");
    SHELL(0, spoil, python_program(), unfinished(a));
    for (int i = 0; i < 2; i++) {
        HIFDM(5, "run", c, "-o", a, "--quiet");
        ERR("this file is damaged or belongs to another version of hifdm. Use --restart ");
    }
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet");
    SHELL(0, "rm \"$1\"/*.tsv; ls \"$1\"/*.h5 | head -1", folder);
    const char *point = keep(formatted("%.*s", (int)strcspn(said.out, "\n"), said.out));
    SHELL(0, spoil, python_program(), unfinished(point));
    HIFDM(3, "sweep", study, "--dir", folder, "--quiet");
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet", "--retry", "failed");
    SHELL(0,
          "rm \"$2\"/*.tsv; \"$1\" -c 'import h5py, sys; f = h5py.File(sys.argv[1], \"a\"); del "
          "f[\"form\"].attrs[\"psi_m\"]' "
          "\"$3\"",
          python_program(), folder, point);
    HIFDM(3, "sweep", study, "--dir", folder, "--quiet");
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet", "--retry", "failed");
}
END_TEST

/* The threads of a sweep let a process look that is older than they are. Finished points take 12 reads, others more. */
START_TEST(a_crash_in_a_sweep_fails_its_point)
{
    const char *library = make_library();
    file_with("c.yaml", SMALL_SCENE SMALL_GA);
    const char *study = file_with("s.yaml", STUDY), *folder = temp("s.d");
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet");
    SHELL(0, "cd \"$1\"; rm points-*.tsv; set -- *.h5; echo \"$1\"", folder);
    said.out[strcspn(said.out, "\n")] = '\0';
    const char *point = unfinished(keep(formatted("%s/%s", folder, said.out)));
    SHELL(3, WITH_LIBRARY "exec \"$0\" sweep \"$3\" --dir \"$4\" --quiet", library, "16", study, folder);
    HIFDM(0, "status", study, "--dir", folder);
    OUT("done      1\n  failed    1\n");
    OUT(formatted("%s: this file exists and is damaged. The process that read the file was ended by signal 6 "
                  "(Aborted). Use --restart",
                  point));
}
END_TEST

/* The system ends processes when memory is short: that says nothing about the file, nor about the point of a sweep. */
START_TEST(a_reader_that_is_killed_blames_no_file)
{
    const char *library = make_library(), *c = file_with("c.yaml", SMALL_SCENE SMALL_GA), *a = temp("a.h5");
    HIFDM(0, "run", c, "-o", a, "--quiet");
    SHELL(5, "export KILLED=1; " WITH_LIBRARY "exec \"$0\" report \"$3\" -o \"$4\"", library, "3", a,
          temp("page.html"));
    ERRS("error: %s: the process that read this file was ended by signal 9 (Killed); is there enough memory, and time "
         "(ulimit -t)?\n",
         a);
    SHELL(5, "export KILLED=1; " WITH_LIBRARY "exec \"$0\" run \"$4\" -o \"$3\"", library, "5", unfinished(a), c);
    ERRS("error: %s: the process that read this file was ended by signal 9 (Killed); is there enough memory, and time "
         "(ulimit -t)?\n",
         a);
    const char *study = file_with("s.yaml", STUDY), *folder = temp("s.d");
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet");
    SHELL(0, "cd \"$1\"; rm points-*.tsv; set -- *.h5; echo \"$1\"", folder);
    said.out[strcspn(said.out, "\n")] = '\0';
    const char *point = unfinished(keep(formatted("%s/%s", folder, said.out)));
    /* As above, only the reader of the unfinished point gets as far as that. */
    SHELL(5, "export KILLED=1; " WITH_LIBRARY "exec \"$0\" sweep \"$3\" --dir \"$4\" --quiet", library, "16", study,
          folder);
    ERRS(": %s: the process that read this file was ended by signal 9 (Killed); is there enough memory, and time "
         "(ulimit -t)?\n",
         point);
    HIFDM(0, "status", study, "--dir", folder, "--json");
    OUT("\"failed\": 0");
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet");
    HIFDM(0, "show", point);
}
END_TEST

START_TEST(a_merge_survives_what_it_would_replace)
{
    static const char opener[] = "#include <stdlib.h>\n"
                                 "long H5Fopen(const char *n, unsigned f, long a) { abort(); }\n";
    const char *source = file_with("opener.c", opener), *library = temp("opener.so");
    SHELL(0, "cc -shared -fPIC -o \"$2\" \"$1\" -ldl", source, library);
    file_with("c.yaml", SMALL_SCENE SMALL_GA);
    const char *study = file_with("s.yaml", STUDY), *folder = temp("s.d"), *merged = temp("m.h5");
    HIFDM(0, "run", temp("c.yaml"), "-o", merged, "--quiet");
    SHELL(0, "mkdir \"$1\" && cp \"$2\" \"$2.mine\"", folder, merged);
    SHELL(5, WITH_LIBRARY "exec \"$0\" merge \"$3\" --dir \"$4\" -o \"$5\"", library, "1", study, folder, merged);
    ERRS("error: %s: this file exists and is damaged. The process that read the file was ended by signal 6 (Aborted). "
         "Use --force to replace the file, or use -o",
         merged);
    SHELL(0, "cmp \"$1\" \"$1.mine\"", merged);
    SHELL(0, WITH_LIBRARY "exec \"$0\" merge \"$3\" --dir \"$4\" -o \"$5\" --force", library, "1", study, folder,
          merged);
}
END_TEST

Suite *suite_cli_damaged(void)
{
    Suite *suite = suite_create("cli/damaged");
    TCase *tcase = tcase_create("damaged");
    tcase_add_test(tcase, a_crash_of_hdf5_names_the_file);
    tcase_add_test(tcase, a_signal_ends_the_reader);
    tcase_add_test(tcase, a_read_without_end_is_ended);
    tcase_add_test(tcase, a_damaged_point_stops_no_other);
    tcase_add_test(tcase, a_merge_survives_what_it_would_replace);
    tcase_add_test(tcase, damage_that_is_found_late_is_no_fault_of_the_machine);
    tcase_add_test(tcase, a_crash_in_a_sweep_fails_its_point);
    tcase_add_test(tcase, a_reader_that_is_killed_blames_no_file);
    suite_add_tcase(suite, tcase);
    return suite;
}
