/* `hifdm help`: the help on each command, the manual page, and the completion for bash. */
#include "cli.h"

#define PREFIX_FILE(name) keep(formatted("%s/" name, installed_prefix()))

START_TEST(every_command_has_its_help)
{
    SHELL(0, "\"$0\" help | sed -n 's/^  hifdm \\([a-z]*\\).*/\\1/p'");
    char *commands = strdup(said.out);
    ck_assert_int_ge(count_of(commands, "\n"), 9);
    for (char *rest = commands, *name; (name = strtok_r(rest, "\n", &rest));) {
        HIFDM(0, "help", name);
        OUT(formatted("hifdm %s", name));
        OUT("\nOptions, anywhere behind the command; after -- all words are files:\n");
        OUT("  -h, --help              print this\n");
        if (strcmp(name, "version") != 0) OUT("\nExamples:\n  ");
        char *help = strdup(said.out);
        HIFDM(0, name, "--help");
        ck_assert_str_eq(said.out, help);
        HIFDM(0, name, "-h");
        ck_assert_str_eq(said.out, help);
        free(help);
    }
    free(commands);
    HIFDM(0, "help", "run");
    OUT("  --set KEY=VALUE         override one key of the case");
    ck_assert_ptr_null(strstr(said.out, "--csv"));
}
END_TEST

/* --help is looked at before what else may be missing or wrong behind it, and nothing is run. */
START_TEST(help_needs_nothing_else)
{
    HIFDM(0, "evaluate", "--help");
    OUT("--template FILE");
    HIFDM(0, "run", file_with("c.yaml", SMALL_SCENE), "-o", temp("no.h5"), "--help");
    ck_assert(!is_there(temp("no.h5")));
    HIFDM(0, "help", "run", "--help");
    OUT("hifdm help [COMMAND]");
}
END_TEST

START_TEST(lines_are_not_too_long_and_end_in_no_blank)
{
    SHELL(0, "for c in '' $(\"$0\" help | sed -n 's/^  hifdm \\([a-z]*\\).*/\\1/p'); do \"$0\" help $c; done");
    SHELL(1, "grep -nE '.{101}| $' \"$1\"", file_with("all.txt", said.out));
    HIFDM(0, "help", "check"); /* a line that the text ends by itself */
    OUT(" line and column.\n  For a study, hifdm check prints");
    HIFDM(0, "help", "report");
    OUT("With a second result, the page");
}
END_TEST

static bool has_program(const char *name)
{
    const char *const argv[] = {"sh", "-c", "command -v \"$0\"", name, NULL};
    struct command command = run_command(HANG_S, argv);
    int exit_code = command.exit_code;
    free_command(&command);
    return exit_code == 0;
}

/* Both renderers of Debian say what is wrong with a page; one of them must be there. */
START_TEST(manual_page_renders_without_warnings)
{
    const char *page = PREFIX_FILE("share/man/man1/hifdm.1");
    HIFDM(0, "help", "--man");
    ck_assert_msg(file_is(page, said.out), "make install puts another page in place than hifdm prints");
    static const char *const parts[] = {"\n.SH NAME\n",
                                        "\n.SS hifdm run CASE\n",
                                        "\\fB\\-\\-set\\fR \\fIKEY=VALUE\\fR",
                                        "\n.SH CASE FILE\n",
                                        "\\fBform.pretension_N\\fR, \\fIN\\fR",
                                        "\\fBoptimize.variables\\fR, rows\\fI\\fR\n",
                                        "\\fBoptimize.variables.N.vary\\fR\\fI\\fR\n",
                                        "Required in its row.\n",
                                        "\n.SH EXIT STATUS\n",
                                        "\\fB75\\fR\ntold to stop\n"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        OUT(parts[i]);
    if (!(has_program("man") && has_program("groff")) && !has_program("mandoc"))
        skip_for_tool("cli/help: warnings of the manual page", "neither man with groff nor mandoc");
    SHELL(0,
          "if command -v man >/dev/null && command -v groff >/dev/null; then\n"
          "  LC_ALL=C.UTF-8 MANROFFSEQ= MANWIDTH=80 man --warnings -E UTF-8 -l -Tutf8 -Z \"$1\" 2>&1 >/dev/null\n"
          "fi\n"
          "if command -v mandoc >/dev/null; then mandoc -T lint -W error \"$1\"; fi\n",
          page);
    ck_assert_str_eq(said.out, "");
    ck_assert_str_eq(said.err, "");
}
END_TEST

/* Words as bash hands them over, taken apart at '=', the last one being completed; what comes out, sorted. */
static const struct {
    const char *words, *completions;
} completion[] = {
    {"hifdm e", "evaluate explain export "},
    {"hifdm run --th", "--threads "},
    {"hifdm schema -", "--help "},
    {"hifdm show --", "--help --json --verbose "},
    {"hifdm help ru", "run "},
    {"hifdm explain straight", "straight_chain "},
    {"hifdm new --c", "--cylinder "},
    {"hifdm new d", ""},
    {"hifdm run ''", "case.yaml dir "},
    {"hifdm check ''", "case.yaml dir "},
    {"hifdm evaluate ''", "case.yaml dir "},
    {"hifdm adjust ''", "case.yaml dir "},
    {"hifdm sweep ''", "case.yaml dir "},
    {"hifdm status ''", "case.yaml dir "},
    {"hifdm merge ''", "case.yaml dir "},
    {"hifdm show ''", "dir result.h5 "},
    {"hifdm diff ''", "dir result.h5 "},
    {"hifdm report ''", "dir result.h5 "},
    {"hifdm export ''", "dir result.h5 "},
    {"hifdm show r", "result.h5 "},
    {"hifdm run x.yaml -o re", "result.h5 "},
    {"hifdm run --output = re", "result.h5 "},
    {"hifdm run --output =", "case.yaml dir result.h5 "},
    {"hifdm export x.h5 --csv ''", "dir "},
    {"hifdm export x.h5 --stage ''", "form refine search "},
    {"hifdm export x.h5 --stage = s", "search "},
    {"hifdm run x.yaml --threads ''", ""},
    {"hifdm run x.yaml --set form.pret", "form.pretension_N= "},
    {"hifdm run x.yaml --set = form.pret", "form.pretension_N= "},
    {"hifdm run x.yaml --set form.stop =", "residual rms_change "},
    {"hifdm run x.yaml --set optimize.method = ga", "ga ga+lm "},
    {"hifdm run x.yaml --set = optimize.method = l", "lm "},
    {"hifdm run x.yaml --set form.pretension_N =", ""},
    {"hifdm run x.yaml --set optimize.lim",
     "optimize.limits.0.bounds= optimize.limits.0.figure= optimize.limits.0.set= "
     "optimize.limits= "},
    {"hifdm run x.yaml --set optimize.variables.7.vary = support", "support_normal support_xyz support_z "},
};
enum { N_COMPLETION = sizeof completion / sizeof *completion };

START_TEST(bash_completes)
{
    static const char script[] = "set -u; cd \"$1\"; mkdir -p dir; touch case.yaml result.h5; . \"$0\"\n"
                                 "eval \"COMP_WORDS=($2)\"; COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
                                 "_hifdm\n"
                                 "printf '%s\\n' \"${COMPREPLY[@]}\" | sort | tr '\\n' ' '\n";
    const char *completer = PREFIX_FILE("share/bash-completion/completions/hifdm"), *folder = temp("there");
    SHELL(0, "mkdir -p \"$1\"", folder);
    const char *const argv[] = {"bash", "-c", script, completer, folder, completion[_i].words, NULL};
    demand_exit(run_command(HANG_S, argv), 0, completion[_i].words, __LINE__);
    const char *got = strcmp(said.out, " ") ? said.out : ""; /* printf prints one empty line for no argument */
    ck_assert_msg(!strcmp(got, completion[_i].completions), "%s: got '%s', not '%s'", completion[_i].words, got,
                  completion[_i].completions);
    ck_assert_str_eq(said.err, "");
}
END_TEST

START_TEST(completion_is_sound_bash)
{
    const char *completer = PREFIX_FILE("share/bash-completion/completions/hifdm");
    HIFDM(0, "help", "--bash");
    ck_assert(file_is(completer, said.out));
    SHELL(0, "bash -n \"$1\"", completer);
    ck_assert_str_eq(said.err, "");
    SHELL(0, "bash --norc -c '. \"$1\" && complete -p hifdm' bash \"$1\"", completer);
    ck_assert_str_eq(said.out, "complete -F _hifdm hifdm\n");
}
END_TEST

Suite *suite_cli_help(void)
{
    Suite *suite = suite_create("cli/help");
    TCase *tcase = tcase_create("help");
    tcase_add_test(tcase, every_command_has_its_help);
    tcase_add_test(tcase, help_needs_nothing_else);
    tcase_add_test(tcase, lines_are_not_too_long_and_end_in_no_blank);
    tcase_add_test(tcase, manual_page_renders_without_warnings);
    tcase_add_loop_test(tcase, bash_completes, 0, N_COMPLETION);
    tcase_add_test(tcase, completion_is_sound_bash);
    suite_add_tcase(suite, tcase);
    return suite;
}
