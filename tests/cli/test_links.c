/* Links, temporary names and leftovers, for every command that writes: nothing but the output that was named changes.
 *
 * The scripts get: $1 case, $2 result, $3 study of one point, $4 its folder, $5 an empty folder for the output, $6
 * another one, $7 a table of designs, $8 the name of the output in $5, $9 that of a file of the user elsewhere. */
#include "session.h"

static const struct writing {
    const char *words, *output; /* output NULL: the result file of the study's point */
} writing[] = {{"run \"$1\" -o \"$5/x.h5\" --restart", "x.h5"},
               {"sweep \"$3\" --dir \"$5\"", NULL},
               {"merge \"$3\" --dir \"$4\" -o \"$5/x.h5\" --force", "x.h5"},
               {"export \"$2\" --csv \"$5\" --force", "nodes.csv"},
               {"export \"$2\" --csv \"$5\" --force", "cables.csv"},
               {"export \"$2\" --vtk \"$5\" --force", "form.hdf"},
               {"export \"$2\" --cutlist \"$5/x.csv\" --force", "x.csv"},
               {"export \"$2\" --cutlist \"$5/x.csv\" --force", "x_totals.csv"},
               {"report \"$2\" -o \"$5/x.html\" --force", "x.html"},
               {"evaluate \"$1\" --template \"$5/x.csv\" --force", "x.csv"},
               {"evaluate \"$1\" --designs \"$7\" -o \"$5/x.csv\" --force", "x.csv"}};
enum { N_WRITING = sizeof writing / sizeof *writing };

static const char *the_case, *result, *the_study, *point_folder, *point_file, *designs;

/* What the command reads, with values that all of them accept. */
static void prepare(const struct writing *w)
{
    the_case = file_with("c.yaml", SMALL_SCENE "  EA_inner_N: 47000\n  EA_boundary_N: 47000\n" SMALL_GA);
    the_study = file_with("study.yaml", "base: c.yaml\nsweep: {form.pretension_N: [9]}\n");
    result = temp("r.h5");
    point_folder = temp("s.d");
    designs = temp("designs.csv");
    if (strstr(w->words, "$2")) HIFDM(0, "run", the_case, "-o", result, "--quiet");
    if (strstr(w->words, "$7")) HIFDM(0, "evaluate", the_case, "--template", designs, "--quiet");
    if (!strstr(w->words, "$3")) return;
    HIFDM(0, "sweep", the_study, "--dir", point_folder, "--quiet");
    SHELL(0, "cd \"$1\" && printf %s *.h5", point_folder);
    point_file = keep(said.out);
}

/* Run `script`, in which the command is CMD and the output's path OUT, in empty folders. */
static void play(int exit_code, const struct writing *w, const char *script, int line)
{
    const char *whole = keep(formatted("rm -rf \"$5\" \"$6\" \"$9\"; mkdir \"$5\" \"$6\"; printf mine >\"$9\"; "
                                       "OUT=\"$5/$8\"; cmd() { \"$0\" %s; }; %s",
                                       w->words, script));
    const char *const argv[] = {"sh",      "-c",         whole,     hifdm_program(),
                                the_case,  result,       the_study, point_folder,
                                temp("o"), temp("real"), designs,   w->output ? w->output : point_file,
                                temp("m"), NULL};
    demand_exit(run_command(50.0, argv), exit_code, keep(formatted("%s: %s", w->words, script)), line);
}

#define NO_LEFTOVERS "test -z \"$(find \"$5\" \"$6\" -name '*.tmp' -o -name '*.journal')\""

/* The link stays, and the file that it leads to is the output: an old file or none. */
START_TEST(own_links_are_followed)
{
    prepare(&writing[_i]);
    const struct writing *w = &writing[_i];
    const char *check =
        "cmd \"$@\" && test -L \"$OUT\" && test -f \"$6/y\" && test -s \"$6/y\" && ! grep -qx old \"$6/y\" && "
        "ls -A \"$6\" && " NO_LEFTOVERS;
    play(0, w, keep(formatted("ln -s ../real/y \"$OUT\"; printf '%s' >\"$6/y\"; %s", w->output ? "old" : "", check)),
         __LINE__);
    OUT("y\n");
    play(0, w, keep(formatted("ln -s ../real/y \"$OUT\"; %s", check)), __LINE__);
    play(0, w, keep(formatted("ln -s \"$5/z\" \"$OUT\"; ln -s ../real/y \"$5/z\"; %s", check)), __LINE__);
}
END_TEST

/* A link of another user is not followed, so that nobody can have others overwrite their own files. */
START_TEST(links_of_others_are_refused)
{
    if (geteuid() != 0) { /* unit/file_out pretends to be another user */
        skip_for_machine("cli/links: links of other users", "only root can make them");
        return;
    }
    prepare(&writing[_i]);
    for (int i = 0; i < 2; i++) {
        play(0, &writing[_i],
             keep(formatted(
                 "ln -s %s \"$OUT\"; chown -h 4711 \"$OUT\"; ! cmd \"$@\" >\"$6/said\" 2>&1 && test -L \"$OUT\" && "
                 "%s && " NO_LEFTOVERS " && cat \"$6/said\"",
                 i ? "../real/y" : "\"$9\"", i ? "test ! -e \"$6/y\"" : "test \"$(cat \"$9\")\" = mine")),
             __LINE__);
        if (writing[_i].output)
            OUT("this symbolic link belongs to another user. Give the name of the file to which the link points");
    }
}
END_TEST

/* Nor does force replace one that leads to a device. */
START_TEST(links_of_others_to_devices_are_refused)
{
    if (!can_make_devices()) {
        skip_for_machine("cli/links: links of other users to devices", "this user cannot make them");
        return;
    }
    if (!writing[_i].output) return; /* the name of the point's file is known after the sweep */
    prepare(&writing[_i]);
    play(0, &writing[_i],
         "mknod \"$6/nul\" c 1 3 && ln -s \"$6/nul\" \"$OUT\"; chown -h 4711 \"$OUT\"; "
         "! cmd \"$@\" >\"$6/said\" 2>&1 && test -L \"$OUT\" && test -c \"$6/nul\" && cat \"$6/said\"",
         __LINE__);
    OUT("this symbolic link belongs to another user. Give the name of the file to which the link points");
}
END_TEST

/* The folder of an output may be a link, too, with something behind it that hides the link. */
static const struct writing in_folder[] = {{"run \"$1\" -o \"$5/out/x.h5\"", ""},
                                           {"run \"$1\" -o \"$5/out//./x.h5\" --restart", ""},
                                           {"sweep \"$3\" --dir \"$5/out/\"", ""},
                                           {"sweep \"$3\" --dir \"$5/out/sub\"", ""},
                                           {"merge \"$3\" --dir \"$4\" -o \"$5/out/x.h5\" --force", ""},
                                           {"export \"$2\" --csv \"$5/out\" --force", ""},
                                           {"export \"$2\" --csv \"$5/out/\" --force", ""},
                                           {"export \"$2\" --vtk \"$5/out/.\" --force", ""},
                                           {"export \"$2\" --vtk \"$5/out/.//\"", ""},
                                           {"export \"$2\" --cutlist \"$5/out/x.csv\"", ""},
                                           {"report \"$2\" -o \"$5/out/x.html\" --force", ""},
                                           {"evaluate \"$1\" --template \"$5/out/x.csv\"", ""}};
enum { N_IN_FOLDER = sizeof in_folder / sizeof *in_folder };

START_TEST(folders_that_are_links_of_others_are_refused)
{
    static const char script[] = "chmod 1777 \"$5\"; ln -s ../real \"$5/out\"; chown -h %s \"$5/out\"; "
                                 "mkdir \"$6/sub\"; cmd \"$@\" >\"$9\" 2>&1; code=$?; ls -AR \"$6\"; exit $code";
    if (geteuid() != 0) { /* unit/file_out pretends to be another user */
        skip_for_machine("cli/links: folders that are links of other users", "only root can make them");
        return;
    }
    const char *empty = keep(formatted("%s:\nsub\n\n%s/sub:\n", temp("real"), temp("real")));
    prepare(&in_folder[_i]);
    play(5, &in_folder[_i], keep(formatted(script, "4711")), __LINE__);
    ck_assert_str_eq(said.out, empty);
    SHELL(0, "cat \"$1\"", temp("m"));
    OUT(keep(formatted("%s: this symbolic link belongs to another user. Give the name of the folder to which the link",
                       temp("o/out"))));
    play(0, &in_folder[_i], keep(formatted(script, "0")), __LINE__);
    ck_assert_str_ne(said.out, empty);
}
END_TEST

/* Names that earlier versions used, also with the number of the process, are the user's, be they files or links. A file
 * under a name of ours whose process is gone is removed, also if it is a second name of a file. */
START_TEST(files_of_the_user_stay_and_leftovers_go)
{
    static const char script[] =
        "cd \"$5\"; for n in \"$8.journal.new\" \"$8.1.tmp\" \".$8.tmp\"; do printf mine >\"$n\"; done; "
        "ln -s \"$9\" \"$8.journal.tmp\"; ln -s ../real/none \".$8.2.tmp\"; : >\".$8.hifdm-$(printf %%032d 1).tmp\"; "
        "ln \"$9\" \".$8.hifdm-$(printf %%032d 2).tmp\"; %s "
        "(p=$(exec sh -c 'echo $PPID'); ln -s \"$9\" \"$8.$p.tmp\"; exec \"$0\" %s) >/dev/null && "
        "test ! -e \"$6/none\" && ls -A | grep -c -e 'tmp$' -e 'new$' && cat \"$8.journal.new\" \"$8.1.tmp\" "
        "\".$8.tmp\" "
        "\"$9\" && test -s \"$8\"";
    prepare(&writing[_i]);
    const struct writing *w = &writing[_i];
    bool has_journal = !strncmp(w->words, "run", 3) || !strncmp(w->words, "sweep", 5);
    play(0, w, keep(formatted(script, has_journal ? ": >\"$8.journal\";" : "", w->words)), __LINE__);
    ck_assert_str_eq(said.out, "6\nmineminemine"
                               "mine");
}
END_TEST

/* ---- locks ---- */

static const char *const in_the_way[] = {"ln -s \"$2\" \"$1\"", "ln -s none \"$1\"", "ln \"$2\" \"$1\"",
                                         "ln \"$3\" \"$1\"",    "mkfifo \"$1\"",     "mkdir \"$1\""};
enum { N_IN_THE_WAY = sizeof in_the_way / sizeof *in_the_way };

static void demand_untouched(void)
{
    ck_assert(file_is(temp("mine"), "mine"));
    ck_assert(file_is(temp("empty"), ""));
    ck_assert(!is_there(temp("none")));
}

/* The journal is appended to and the claims are locked: neither through a name that leads elsewhere. */
START_TEST(locks_lead_nowhere_else)
{
    const char *c = file_with("c.yaml", SMALL_SCENE SMALL_GA), *path = temp("x.h5"), *journal = temp("x.h5.journal");
    const char *mine = file_with("mine", "mine"), *empty = file_with("empty", "");
    SHELL(0, in_the_way[_i], journal, mine, empty);
    HIFDM(5, "run", c, "-o", path);
    ERRS("error: %s: %s is not a journal of hifdm, but the file has the name of a journal", path, journal);
    demand_untouched();
    struct command again = run_hifdm("run", c, "-o", path, "--restart", "--quiet");
    ck_assert_int_eq(again.exit_code, _i == N_IN_THE_WAY - 1 ? 5 : 0); /* a folder is not removed */
    free_command(&again);
    demand_untouched();
    const char *study = file_with("study.yaml", "base: c.yaml\nsweep: {form.pretension_N: [9]}\n");
    SHELL(0, "mkdir \"$1\"", temp("s.d"));
    SHELL(0, in_the_way[_i], temp("s.d/claims"), mine, empty);
    HIFDM(5, "sweep", study, "--dir", temp("s.d"));
    ERRS("error: %s: this is not a regular file. Remove it\n", temp("s.d/claims"));
    demand_untouched();
    ck_assert(!is_there(temp("s.d/none")));
}
END_TEST

/* Two names of one result have one lock. */
START_TEST(a_link_has_the_lock_of_its_file)
{
    const char *c = storing_case("c.yaml", 1000000), *path = temp("run.h5"), *link = temp("link.h5");
    const char *const argv[] = {hifdm_program(), "run", c, "-o", path, "--quiet", NULL};
    SHELL(0, "ln -s run.h5 \"$1\"", link);
    session s = start_program(argv);
    wait_for_generations(&s, path);
    HIFDM(5, "run", c, "-o", link);
    ERR("another process is writing this result");
    HIFDM(5, "recover", link);
    ck_assert_int_eq(end_by(&s, SIGKILL), 128 + SIGKILL);
    HIFDM(0, "recover", link);
    SHELL(0, "test -L \"$1\" && cd \"$(dirname \"$1\")\" && ls -A *.h5* .*.tmp 2>/dev/null; true", link);
    ck_assert_str_eq(said.out, "link.h5\nrun.h5\n");
}
END_TEST

Suite *suite_cli_links(void)
{
    Suite *suite = suite_create("cli/links");
    TCase *tcase = tcase_create("links");
    tcase_add_loop_test(tcase, own_links_are_followed, 0, N_WRITING);
    tcase_add_loop_test(tcase, links_of_others_are_refused, 0, N_WRITING);
    tcase_add_loop_test(tcase, links_of_others_to_devices_are_refused, 0, N_WRITING);
    tcase_add_loop_test(tcase, folders_that_are_links_of_others_are_refused, 0, N_IN_FOLDER);
    tcase_add_loop_test(tcase, files_of_the_user_stay_and_leftovers_go, 0, N_WRITING);
    tcase_add_loop_test(tcase, locks_lead_nowhere_else, 0, N_IN_THE_WAY);
    tcase_add_test(tcase, a_link_has_the_lock_of_its_file);
    suite_add_tcase(suite, tcase);
    return suite;
}
