/* Stages after the search fail because of the machine: the result stays unfinished, the stages before and the samples
 * stay, and the same command resumes to the bits of an undisturbed run. */
#include "cli.h"

#include <errno.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_PRELOAD 0 /* the sanitizer's library must be loaded first */
#else
#define HAS_PRELOAD 1
#endif

#define SAMPLES "tolerance: {sigma_cut_m: 1e-4, samples: 3000}\n"
#define STATES                                                                                                         \
    "cables:\n  - {expansion_per_K: -1e-6}\nload_cases:\n  - {name: cold, temperature_K: -100, part: net}\n"           \
    "  - {name: hot, temperature_K: 100, part: net}\n"
#define SEARCH "optimize: {population: 6, generations: 3, seed: 7, method: ga+lm, refine_steps: 3}\n"

static const char *sick_machine(void)
{
    const char *library = temp("sick.so");
    SHELL(0, "cc -shared -fPIC -O1 -w \"$1\" -o \"$2\" -ldl", keep(source_path("tests/cli/sick_machine.c")), library);
    return library;
}

static const struct {
    const char *sections, *how; /* what the case asks for; the call that fails, as sick_machine.c reads it */
    bool keeps_samples;
} late[] = {
    {SAMPLES, "writev 28 1 .tolerance.journal", false},
    {SAMPLES, "writev 28 2 .tolerance.journal", true},
    {SAMPLES, "pwrite 28 2 /#", true},
    {SAMPLES, "open 24 1 .tolerance.journal", false},
    {SEARCH SAMPLES, "writev 122 2 .tolerance.journal", true},
    {SEARCH STATES SAMPLES, "writev 28 2 .tolerance.journal", true},
};
enum { N_LATE = sizeof late / sizeof *late };

START_TEST(a_late_stage_that_fails_is_resumed)
{
    const char *path = file_with("c.yaml", keep(formatted("%s%s", EA_SCENE, late[_i].sections)));
    const char *undisturbed = temp("u.h5"), *result = temp("a.h5"), *library = sick_machine();
    const char *journal = keep(formatted("%s.tolerance.journal", result));
    HIFDM(0, "run", path, "-o", undisturbed, "--quiet");
    SHELL(5, "SICK=\"$3\" LD_PRELOAD=\"$4\" \"$0\" run \"$1\" -o \"$2\" --quiet", path, result, late[_i].how, library);
    ERR("this result is unfinished. Run the same command again to resume");
    EXPECT(result, "--", "not a.attrs['finished']", "len(a['form/length_m']) > 0", "'tolerance' not in a");
    if (late[_i].keeps_samples) ck_assert(is_there(journal));
    HIFDM(0, "run", path, "-o", result, "--quiet");
    HIFDM(0, "diff", undisturbed, result);
    EXPECT(result, "--", "a.attrs['finished']", "len(a['tolerance/sample/psi_m']) == 3000");
    EXPECT(result, undisturbed, "--", "attributes(a) == attributes(b)",
           "'search' not in a or a['search'].attrs['n_at_lower'] > 0");
    SHELL(0, "test \"$(ls -A \"$1\"*)\" = \"$1\"", result);
}
END_TEST

/* What a late stage leaves is no damaged file: all that reads results takes it as far as it goes. */
START_TEST(an_unfinished_result_is_read)
{
    static const struct {
        const char *sections, *format;
    } of[] = {{"truss: {E_Pa: 2e9}\nform: {pretension_N: 20}\n" SEARCH STATES SAMPLES, "--cutlist"},
              {"optimize: {population: 8, generations: 3, seed: 7, front: [{figure: psi}, {figure: ratio, set: "
               "boundary}]}\n" SAMPLES,
               "--front"}};
    const char *path = file_with("c.yaml", keep(formatted("%s%s", EA_SCENE, of[_i].sections)));
    const char *result = temp("a.h5"), *library = sick_machine();
    SHELL(5, "SICK='writev 28 1 .tolerance.journal' LD_PRELOAD=\"$3\" \"$0\" run \"$1\" -o \"$2\" --quiet", path,
          result, library);
    HIFDM(0, "show", result);
    OUT("unfinished: ");
    HIFDM(0, "show", result, "--json");
    HIFDM(0, "report", result, "-o", temp("a.html"));
    HIFDM(0, "export", result, "--csv", temp("csv"), "--vtk", temp("vtk"), of[_i].format, temp("table.csv"));
    if (_i == 0) ERR("the export has no truss, because this run is unfinished");
    HIFDM(0, "diff", result, result);
    HIFDM(0, "recover", result);
    HIFDM(0, "run", path, "-o", result, "--quiet");
    HIFDM(0, "export", result, "--csv", temp("csv"), "--force");
    if (_i == 0) OUT("members of the truss");
}
END_TEST

/* A full disk after --restart: the earlier finished result stays until the new one is finished. */
START_TEST(a_restart_keeps_the_finished_result)
{
    const char *path = file_with("c.yaml", EA_SCENE SEARCH), *result = temp("a.h5"), *whole = temp("whole.h5");
    const char *earlier = temp("a.h5.before-restart"), *library = sick_machine();
    const char *restarted =
        "SICK='writev 28 2 a.h5.journal' LD_PRELOAD=\"$3\" \"$0\" run \"$1\" -o \"$2\" --restart --quiet";
    HIFDM(0, "run", path, "-o", whole, "--quiet");
    HIFDM(0, "run", path, "-o", result, "--quiet");
    for (int i = 0; i < 2; i++) { /* the second one replaces an unfinished result */
        SHELL(5, restarted, path, result, library);
        ERR("the earlier result is ");
        HIFDM(0, "diff", whole, earlier);
        HIFDM(0, "show", result);
        OUT("unfinished: ");
    }
    HIFDM(0, "run", path, "-o", result, "--quiet");
    HIFDM(0, "diff", whole, result);
    ck_assert(!is_there(earlier));
    HIFDM(0, "run", path, "-o", result, "--restart", "--quiet");
    ck_assert(!is_there(earlier));
    write_file(earlier, "precious");
    HIFDM(5, "run", path, "-o", result, "--restart", "--quiet");
    ERR("hifdm needs this name for the earlier result");
    HIFDM(0, "diff", whole, result);
    SHELL(0, "test \"$(cat \"$1\")\" = precious", earlier);
}
END_TEST

/* A file that cannot be removed is reported, and the next command removes it. */
START_TEST(a_temporary_file_that_stays_is_reported)
{
    const char *path = file_with("c.yaml", EA_SCENE), *result = temp("a.h5"), *library = sick_machine();
    SHELL(0, "SICK='unlink 13 1 .tmp' LD_PRELOAD=\"$3\" \"$0\" run \"$1\" -o \"$2\" --quiet", path, result, library);
    ERR("cannot remove the temporary file ");
    ERR("Permission denied");
    SHELL(0, "ls -A \"$(dirname \"$1\")\" | grep -q 'tmp$'", result);
    HIFDM(0, "run", path, "-o", result, "--quiet");
    SHELL(0, "test \"$(ls -A \"$(dirname \"$1\")\" | grep a.h5)\" = a.h5", result);
}
END_TEST

/* Commands with two outputs: no disk for the second one leaves none, so that the same command can be given again. */
START_TEST(two_files_or_none)
{
    const char *path = file_with("c.yaml", EA_SCENE SEARCH), *library = sick_machine(), *designs = temp("d.csv");
    const char *table = temp("e.csv"), *slopes = temp("j.csv");
    HIFDM(0, "evaluate", path, "--template", designs, "--quiet");
    for (int i = 0; i < 2; i++) {
        const char *how = keep(formatted("SICK=fsync 28 1 %s", i ? "j.csv" : "e.csv"));
        SHELL(5,
              "exec env \"$5\" LD_PRELOAD=\"$6\" \"$0\" evaluate \"$1\" --designs \"$2\" -o \"$3\" --jacobian \"$4\"",
              path, designs, table, slopes, how, library);
        ERR("No space left on device");
        ck_assert(!is_there(table) && !is_there(slopes));
    }
    HIFDM(0, "evaluate", path, "--designs", designs, "-o", table, "--jacobian", slopes, "--quiet");
    ck_assert(is_there(table) && is_there(slopes));
}
END_TEST

/* The nodes of a result, every fifth of them 0.4 mm too high. */
static const char *measured_of(const char *result)
{
    const char *folder = temp("nodes"), *path = temp("m.csv");
    HIFDM(0, "export", result, "--csv", folder);
    char *text = read_file(keep(formatted("%s/nodes.csv", folder)), NULL);
    FILE *to = fopen(path, "w");
    int row = 0;
    ck_assert_ptr_nonnull(to);
    fputs("id,x_m,y_m,z_m\n", to);
    for (char *line = strchr(text, '\n') + 1; *line; line = strchr(line, '\n') + 1, row++) {
        char id[64];
        double x, y, z;
        if (sscanf(line, "%63[^,],%lf,%lf,%lf", id, &x, &y, &z) == 4)
            fprintf(to, "%s,%.17g,%.17g,%.17g\n", id, x, y, row % 5 == 2 ? z + 4e-4 : z);
    }
    ck_assert_int_eq(fclose(to), 0);
    free(text);
    return path;
}

START_TEST(moves_and_page_or_none)
{
    const char *path =
        file_with("c.yaml", EA_SCENE "tolerance: {sigma_cut_m: 1e-3, samples: 50}\nadjust: {set: inner, "
                                     "range_m: 0.002, step_m: 1e-4, max_adjustments: 2, sigma_m: 1e-4}\n");
    const char *result = temp("a.h5"), *moves = temp("moves.csv"), *page = temp("moves.html"),
               *library = sick_machine();
    HIFDM(0, "run", path, "-o", result, "--quiet");
    const char *measured = measured_of(result);
    SHELL(5,
          "SICK='fsync 28 1 moves.html' LD_PRELOAD=\"$6\" \"$0\" adjust \"$1\" --measured \"$2\" --result \"$3\" -o "
          "\"$4\" "
          "--report \"$5\" --quiet",
          path, measured, result, moves, page, library);
    ck_assert(!is_there(moves) && !is_there(page));
    HIFDM(0, "adjust", path, "--measured", measured, "--result", result, "-o", moves, "--report", page, "--quiet");
    ck_assert(is_there(moves) && is_there(page));
}
END_TEST

Suite *suite_cli_late_stages(void)
{
    Suite *suite = suite_create("cli/late_stages");
    TCase *tcase = tcase_create("late_stages");
    if (HAS_PRELOAD) tcase_add_loop_test(tcase, a_late_stage_that_fails_is_resumed, 0, N_LATE);
    if (HAS_PRELOAD) tcase_add_loop_test(tcase, an_unfinished_result_is_read, 0, 2);
    if (HAS_PRELOAD) tcase_add_test(tcase, a_restart_keeps_the_finished_result);
    if (HAS_PRELOAD) tcase_add_test(tcase, a_temporary_file_that_stays_is_reported);
    if (HAS_PRELOAD) tcase_add_test(tcase, two_files_or_none);
    if (HAS_PRELOAD) tcase_add_test(tcase, moves_and_page_or_none);
    suite_add_tcase(suite, tcase);
    return suite;
}
