/* Where a result may be written and where not. Whatever happens, files that existed before are unchanged, byte by byte.
 */
#include "cli.h"

/* Exit code 5, the given words, and nothing new in the test's directory. */
#define REFUSED(path, ...)                                                                                             \
    do {                                                                                                               \
        HIFDM(5, "run", file_with("c.yaml", SMALL_SCENE), "-o", path);                                                 \
        ERRS(__VA_ARGS__);                                                                                             \
        ck_assert_str_eq(said.out, "");                                                                                \
    } while (0)

/* Names in the test's directory that are neither a result nor made by these tests. */
static void demand_no_leftovers(void)
{
    SHELL(0, "find \"$1\" -name '*tmp*'", temp(""));
    ck_assert_str_eq(said.out, "");
}

START_TEST(existing_output_is_not_replaced)
{
    const char *path = temp("mine.h5");
    write_file(path, "mine");
    REFUSED(path,
            "error: %s: this file exists and is not a result of hifdm. Use --restart (in a sweep: --retry failed) to "
            "replace the file, or use -o to choose another name\n",
            path);
    ck_assert(file_is(path, "mine"));
    HIFDM(2, "run", file_with("bad.yaml", "scene: 1\n"), "-o", path, "--force");
    ck_assert(file_is(path, "mine"));
    HIFDM(4, "run", CHEN, "--set", "form.stop=residual", "-o", path, "--force"); /* after form-finding */
    ck_assert(file_is(path, "mine"));
    HIFDM(0, "run", file_with("c.yaml", SMALL_SCENE), "-o", path, "--force");
    EXPECT(path, "--", "'form' in a");
    demand_no_leftovers();
    HIFDM(2, "run", path, "-o", temp("other.h5"));
    ERR("mine.h5: this file is an HDF5 file, not a case file. For a result file, use hifdm show, report or export\n");
    SHELL(0, "head -c 30000 \"$1\" >\"$1.cut\" && mv \"$1.cut\" \"$1\"", path);
    REFUSED(path, "error: %s: this file exists and is cut off: a truncated HDF5 file. Use --restart", path);
}
END_TEST

/* Told before the work, not after: the run would take hours. */
START_TEST(output_is_looked_at_before_the_work)
{
    const char *path = temp("mine.h5");
    write_file(path, "mine");
    const char *const argv[] = {hifdm_program(),
                                "run",
                                CHEN,
                                "-o",
                                path,
                                "--set",
                                "optimize.generations=1000000",
                                "--set",
                                "optimize.stagnation_generations=1000000",
                                NULL};
    demand_exit(run_command(HANG_S, argv), 5, "existing output", __LINE__);
    ERR("Use --restart (in a sweep: --retry failed) to replace the file");
    ck_assert(file_is(path, "mine"));
}
END_TEST

START_TEST(output_that_cannot_be_is_told)
{
    write_file(temp("file"), "mine");
    REFUSED(temp("no/such/r.h5"), "error: %s: the folder %s does not exist.", temp("no/such/r.h5"), temp("no/such"));
    REFUSED(temp("file/r.h5"), "error: %s: the folder %s does not exist.", temp("file/r.h5"), temp("file"));
    REFUSED(temp("."), "error: %s: this is a folder. Use -o to choose a file name\n", temp("."));
    REFUSED("/dev/full", "error: /dev/full: this is not a regular file. Use -o to choose a file name\n");
    REFUSED("/dev/null", "error: /dev/null: this is not a regular file. Use -o to choose a file name\n");
    REFUSED("/proc/hifdm.h5", "error: /proc/hifdm.h5: cannot "); /* nobody can make a file there, root included */
    ck_assert(file_is(temp("file"), "mine"));
    HIFDM(5, "run", file_with("c.yaml", SMALL_SCENE), "-o", temp("file/r.h5"), "--force");
    HIFDM(5, "run", file_with("c.yaml", SMALL_SCENE), "-o", "/dev/full", "--force");
    demand_no_leftovers();
}
END_TEST

/* Root may write anywhere, so this can only be seen as somebody else. */
START_TEST(read_only_folder_is_told)
{
    if (geteuid() == 0) {
        skip_for_machine("cli/output: a folder that is read-only", "root may write there");
        return;
    }
    SHELL(0, "mkdir -m 555 \"$1\"", temp("locked"));
    REFUSED(temp("locked/r.h5"), "cannot write into the folder %s: Permission denied", temp("locked"));
}
END_TEST

/* Makes a folder whose path has more than 1100 bytes: a name may have 255, a path 4095. */
static const char *deep_folder(void)
{
    char folder[1300];
    int n = snprintf(folder, sizeof folder, "%s", temp("deep"));
    for (; n < 1100; n += 101)
        snprintf(folder + n, sizeof folder - (size_t)n, "/%0100d", 0);
    SHELL(0, "mkdir -p \"$1\"", folder);
    return keep(folder);
}

/* To the last letter, or not at all. */
START_TEST(long_names_are_not_cut)
{
    char name[1400];
    snprintf(name, sizeof name, "%s/long-name.h5", deep_folder());
    struct command command = run_hifdm("run", file_with("c.yaml", SMALL_SCENE), "-o", name);
    if (command.exit_code == 0)
        ck_assert_msg(is_there(name), "%s", command.out);
    else
        ck_assert_int_eq(command.exit_code, 5);
    free_command(&command);
    SHELL(0, "find \"$1\" -type f ! -name long-name.h5", temp("deep"));
    ck_assert_str_eq(said.out, "");
}
END_TEST

/* Every command that writes takes a path as long as the system does, and refuses a longer one before the work. */
START_TEST(paths_are_as_long_as_the_system_has_them)
{
    static const char *const refused[] = {"run \"$1\" -o",       "evaluate \"$1\" --template",
                                          "report \"$2\" -o",    "export \"$2\" --csv",
                                          "export \"$2\" --vtk", "export \"$2\" --cutlist"};
    const char *deep = deep_folder();
    const char *c = file_with("c.yaml", SMALL_SCENE "  EA_inner_N: 47000\n  EA_boundary_N: 47000\n"),
               *out = temp("r.h5");
    HIFDM(0, "run", c, "-o", out);
    SHELL(0,
          "p=\"$3\"/$(printf '%0200d' 0) && mkdir \"$p\" && \"$0\" evaluate \"$1\" --template \"$p\"/t.csv && "
          "\"$0\" report \"$2\" -o \"$p\"/r.html && "
          "\"$0\" export \"$2\" --csv \"$p\"/csv --vtk \"$p\"/vtk --cutlist \"$p\"/c.csv && cd \"$p\" && ls . csv vtk",
          c, out, deep);
    OUT("/c_totals.csv\n"); /* the line that says so is not cut either */
    OUT("\nc.csv\nc_mm.csv\nc_nodes.csv\nc_totals.csv\ncsv\nr.html\nt.csv\nvtk\n");
    OUT("csv:\ncables.csv\nnodes.csv\n");
    OUT("vtk:\nform.hdf\ntarget.hdf\n");
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        SHELL(5, formatted("cd \"$3\" && \"$0\" %s $(printf '%%05000d' 0)", refused[i]), c, out, deep);
        ERR("0: the path is too long\n");
    }
    const char *study = file_with("s.yaml", "base: c.yaml\nsweep: {form.pretension_N: [9, 10]}\n");
    HIFDM(5, "sweep", study, "--dir", deep);
    ERR("0: the path is longer than the maximum of 1023 bytes\n");
    HIFDM(0, "sweep", study, "--dir", temp("s.d"));
    HIFDM(5, "merge", study, "--dir", temp("s.d"), "-o", formatted("%s/m.h5", deep));
    ERR("/m.h5: the path is longer than the maximum of 1023 bytes\n");
    SHELL(0, "ls \"$1\"", deep);
    ck_assert_int_eq(count_of(said.out, "\n"), 1); /* the folder made above, and nothing else */
    demand_no_leftovers();
}
END_TEST

/* Not even by force: a result never replaces what it is made of. */
START_TEST(the_case_itself_is_not_replaced)
{
    static const char text[] = SMALL_SCENE;
    const char *path = file_with("c.yaml", text);
    HIFDM(5, "run", path, "-o", path);
    ck_assert(file_is(path, text));
    struct command command = run_hifdm("run", path, "-o", path, "--force");
    ck_assert_int_ne(command.exit_code, 0);
    free_command(&command);
    ck_assert(file_is(path, text));
}
END_TEST

static const char *a_swept_study(void)
{
    file_with("c.yaml", SMALL_SCENE SMALL_GA);
    const char *study = file_with("s.yaml", "base: c.yaml\nsweep: {form.pretension_N: [9, 10]}\n");
    HIFDM(0, "sweep", study, "--dir", temp("s.d"), "--quiet");
    return study;
}

#define MERGE_INTO(name) "\"$0\" merge \"$1\" --dir \"$2/s.d\" -o \"$2/" name "\""

/* A merge replaces ordinary files alone, as a run does, and waits for nobody. */
START_TEST(a_merge_into_no_ordinary_file)
{
    static const char *const make[][2] = {{"mkfifo", "test -p"}, {"mkdir", "test -d"}, {"mknod", "test -c"}};
    const char *study = a_swept_study(), *folder = temp("");
    for (int i = 0; i < 3; i++) {
        if (i == 2 && !can_make_devices()) {
            skip_for_machine("cli/output: a merge into a device", "this user cannot make one");
            continue;
        }
        SHELL(0, formatted("cd \"$1\" && rm -rf x && %s x%s", make[i][0], i == 2 ? " c 1 3" : ""), folder);
        for (int force = 0; force < 2; force++) {
            SHELL(0, formatted(MERGE_INTO("x") "%s; test $? = 5 && %s \"$2/x\"", force ? " --force" : "", make[i][1]),
                  study, folder);
            ERRS("x: this is %s. Use -o to choose a file name\n", i == 1 ? "a folder" : "not a regular file");
        }
    }
}
END_TEST

/* Nor what it is made of, by whatever name. */
START_TEST(a_merge_spares_what_it_is_made_of)
{
    static const char *const input[] = {
        "s.yaml",     "c.yaml", "nodes.csv", "$(cd \"$2\"; ls s.d/*.h5 | head -1)", "$(cd \"$2\"; ls s.d/points-*)",
        "s.d/claims", "link"};
    const char *folder = temp("");
    net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0,support\nc,1,0.5,0.1,inner\n",
             "id,i,j,group,law,value\n1,a,c,inner,tension,10\n2,b,c,inner,tension,10\n");
    file_with("c.yaml", "scene:\n  import: {nodes: nodes.csv, cables: cables.csv}\n");
    const char *study = file_with("s.yaml", "base: c.yaml\nsweep: {form.max_iterations: [900, 1000], files: all}\n");
    HIFDM(0, "sweep", study, "--dir", temp("s.d"), "--quiet");
    SHELL(0, "ln -s c.yaml \"$1/link\"", folder);
    for (size_t i = 0; i < sizeof input / sizeof *input; i++)
        for (int force = 0; force < 2; force++) {
            SHELL(5,
                  formatted("name=%s; cp \"$2/$name\" \"$2/copy\"; " MERGE_INTO(
                                "$name") "%s; code=$?; "
                                         "cmp \"$2/$name\" \"$2/copy\" && exit $code",
                            input[i], force ? " --force" : ""),
                  study, folder);
            ERR(". Choose another name\n");
            ERR(i >= 3 && i < 6 ? ": this file belongs to the sweep in " : ": this file is an input of this merge. ");
        }
    SHELL(0, MERGE_INTO("s.d/all.h5") " && " MERGE_INTO("s.d/all.h5") " --force", study, folder); /* a merge may go */
}
END_TEST

/* An export never replaces the result that it is made from, whatever file of the export has its name. */
START_TEST(an_export_spares_its_result)
{
    static const char *const to[][2] = {{"r.h5", "--cutlist r.h5"},         {"r.h5", "--cutlist link"},
                                        {"x_nodes.csv", "--cutlist x.csv"}, {"x_totals.csv", "--cutlist x.csv"},
                                        {"x/nodes.csv", "--csv x"},         {"x/cables.csv", "--csv x/"},
                                        {"x/form.hdf", "--vtk x"}};
    const char *result = temp("one.h5"),
               *c = file_with("c.yaml", SMALL_SCENE "  EA_inner_N: 4e4\n  EA_boundary_N: 4e4\n");
    HIFDM(0, "run", c, "-o", result, "--quiet");
    for (size_t i = 0; i < sizeof to / sizeof *to; i++) {
        SHELL(5,
              formatted("rm -rf \"$2\"; mkdir -p \"$2/x\" && cd \"$2\" && cp \"$1\" %s && ln -s r.h5 link; "
                        "\"$0\" export %s %s --force; code=$?; cmp %s \"$1\" && exit $code",
                        to[i][0], to[i][0], to[i][1], to[i][0]),
              result, temp("e"));
        ERR(": this file is the result itself. Choose another name\n");
        SHELL(0, "find \"$1\" -type f", temp("e")); /* nothing but the result */
        ck_assert_int_eq(count_of(said.out, "\n"), 1);
    }
}
END_TEST

/* ---- standard output that takes nothing: every command that prints says so by its exit code ---- */

static const char *const printing[] = {"run \"$1\" -o \"$2\"",
                                       "run \"$1\" -o \"$2\" --json",
                                       "check \"$1\"",
                                       "schema",
                                       "help",
                                       "help --man",
                                       "version",
                                       "show \"$3\"",
                                       "show \"$3\" --json",
                                       "report \"$3\" --force -o \"$4.html\"",
                                       "export \"$3\" --csv \"$4\""};
enum { N_PRINTING = sizeof printing / sizeof *printing };

START_TEST(full_or_closed_standard_output_is_an_error)
{
    const char *path = file_with("c.yaml", SMALL_SCENE), *done = temp("done.h5");
    HIFDM(0, "run", path, "-o", done, "--quiet");
    static const char *const to[] = {">/dev/full", ">&-"};
    for (int i = 0; i < 2; i++) {
        const char *script = keep(formatted("exec \"$0\" %s %s", printing[_i], to[i]));
        SHELL(5, script, path, temp("new.h5"), done, temp("csv"));
        ck_assert_str_eq(said.err, "error: cannot write to standard output\n");
        if (is_there(temp("new.h5"))) EXPECT(temp("new.h5"), "--", "'form' in a"); /* the result is whole */
        SHELL(0, "rm -rf \"$1\" \"$2\"", temp("new.h5"), temp("csv"));
    }
}
END_TEST

/* With its standard streams closed the program gets their numbers for its own files: words must not end up there. */
START_TEST(closed_streams_do_not_spoil_the_result)
{
    const char *out = temp("o.h5"), *again = temp("p.h5");
    SHELL(5, "exec \"$0\" run \"$1\" -o \"$2\" --set optimize.generations=3 <&- >&- 2>&-", CHEN, out);
    HIFDM(0, "run", CHEN, "-o", again, "--set", "optimize.generations=3");
    EXPECT(out, again, "--", "differing(a, b) == []");
}
END_TEST

/* ---- a disk that is full: 5, words, no file; the limit on file size stands for it, its signal ignored ---- */

static const char *const limits[] = {"1", "8", "16", "40"}; /* blocks of 512 or 1024 bytes */

START_TEST(full_disk_leaves_nothing_and_does_not_crash)
{
    const char *path = temp("full.h5"), *script = "trap '' XFSZ; ulimit -f $3; exec \"$0\" run \"$1\" -o \"$2\" "
                                                  "--set optimize.generations=25 2>&1 | tail -n 1; exit 0";
    SHELL(0, script, CHEN, path, limits[_i]);
    ck_assert_msg(strstr(said.out, "error: ") == said.out && strstr(said.out, "File too large"), "%s", said.out);
    ck_assert(!is_there(path)); /* there is no room for the shape, so there is nothing to go on with */
    write_file(path, "mine");
    SHELL(5,
          "trap '' XFSZ; ulimit -f $3; exec \"$0\" run \"$1\" -o \"$2\" --restart --set optimize.generations=25 "
          ">/dev/null 2>/dev/null",
          CHEN, path, limits[_i]);
    ck_assert(file_is(path, "mine"));
    demand_no_leftovers();
}
END_TEST

/* However far it gets, all files are there or none, and then the same command goes well without --force. */
START_TEST(full_disk_leaves_no_part_of_an_export)
{
    static const char *const blocks[] = {"1", "8", "16", "40"};
    const char *result = temp("c.h5"), *csv = temp("csv"), *vtk = temp("vtk");
    HIFDM(0, "run", CHEN, "-o", result, "--set", "optimize.generations=2");
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) {
        SHELL(5, "trap '' XFSZ; ulimit -f $4; exec \"$0\" export \"$1\" --csv \"$2\" --vtk \"$3\"", result, csv, vtk,
              blocks[i]);
        ERR("File too large");
        SHELL(0, "ls -A \"$1\"; ls -A \"$2\" 2>/dev/null; true", csv, vtk);
        ck_assert_str_eq(said.out, "");
    }
    HIFDM(0, "export", result, "--csv", csv, "--vtk", vtk);
    SHELL(0, "ls -A \"$1\" \"$2\" | wc -w", csv, vtk);
    ck_assert_str_eq(said.out, "8\n");
    HIFDM(5, "export", result, "--csv", csv, "--cutlist", temp("csv/nodes.csv"), "--force");
    ERR("two output files would have this name");
}
END_TEST

Suite *suite_cli_output(void)
{
    Suite *suite = suite_create("cli/output");
    TCase *tcase = tcase_create("output");
    tcase_add_test(tcase, existing_output_is_not_replaced);
    tcase_add_test(tcase, output_is_looked_at_before_the_work);
    tcase_add_test(tcase, output_that_cannot_be_is_told);
    tcase_add_test(tcase, read_only_folder_is_told);
    tcase_add_test(tcase, long_names_are_not_cut);
    tcase_add_test(tcase, paths_are_as_long_as_the_system_has_them);
    tcase_add_test(tcase, the_case_itself_is_not_replaced);
    tcase_add_test(tcase, a_merge_into_no_ordinary_file);
    tcase_add_test(tcase, a_merge_spares_what_it_is_made_of);
    tcase_add_test(tcase, an_export_spares_its_result);
    tcase_add_loop_test(tcase, full_or_closed_standard_output_is_an_error, 0, N_PRINTING);
    tcase_add_test(tcase, closed_streams_do_not_spoil_the_result);
    tcase_add_loop_test(tcase, full_disk_leaves_nothing_and_does_not_crash, 0, sizeof limits / sizeof *limits);
    tcase_add_test(tcase, full_disk_leaves_no_part_of_an_export);
    suite_add_tcase(suite, tcase);
    return suite;
}
