/* Command lines that are wrong: exit code 2, one line that says what to write instead, nothing else. */
#include "cli.h"

static const struct {
    const char *argv[6], *error;
} wrong[] = {
    {{NULL}, "error: the command is missing. 'hifdm help' lists all commands\n"},
    {{"rnu", "CASE"}, "error: unknown command 'rnu'; did you mean 'run'?\n"},
    {{"exprot", "CASE"}, "error: unknown command 'exprot'; did you mean 'export'?\n"},
    {{"Check", "CASE"}, "error: unknown command 'Check'; did you mean 'check'?\n"},
    {{"frobnicate"}, "error: unknown command 'frobnicate'. 'hifdm help' lists the valid names\n"},
    {{""}, "error: unknown command ''. 'hifdm help' lists the valid names\n"},
    {{"--quiet"}, "error: unknown command '--quiet'. 'hifdm help' lists the valid names\n"},
    {{"run"}, "error: 'hifdm run' needs the argument CASE\n"},
    {{"show", "--json"}, "error: 'hifdm show' needs the argument FILE\n"},
    {{"run", "CASE", "CASE"}, "error: 'CASE' is an unexpected argument of 'hifdm run'\n"},
    {{"help", "rnu"}, "error: unknown command 'rnu'; did you mean 'run'?\n"},
    {{"help", "frobnicate"}, "error: unknown command 'frobnicate'. 'hifdm help' lists the valid names\n"},
    {{"help", "run", "x"}, "error: 'x' is an unexpected argument of 'hifdm help'\n"},
    {{"run", "CASE", "--hlep"}, "error: unknown option '--hlep'; did you mean '--help'?\n"},
    {{"schema", "x"}, "error: 'x' is an unexpected argument of 'hifdm schema'\n"},
    {{"run", "CASE", "--thread", "2"}, "error: unknown option '--thread'; did you mean '--threads'?\n"},
    {{"run", "CASE", "--jsn"}, "error: unknown option '--jsn'; did you mean '--json'?\n"},
    {{"run", "CASE", "-x"}, "error: unknown option '-x'. 'hifdm help run' lists the valid names\n"},
    {{"run", "CASE", "--nonsense"}, "error: unknown option '--nonsense'. 'hifdm help run' lists the valid names\n"},
    {{"show", "FILE", "--set", "a=1"},
     "error: '--set' is not an option of this command. 'hifdm help show' lists the options of the command\n"},
    {{"check", "CASE", "--force"},
     "error: '--force' is not an option of this command. 'hifdm help check' lists the options of the command\n"},
    {{"run", "CASE", "-o"}, "error: the option '-o' must be followed by FILE\n"},
    {{"run", "CASE", "-o", ""}, "error: the option '--output' must be followed by FILE, not by an empty string\n"},
    {{"sweep", "STUDY", "--dir="}, "error: the option '--dir' must be followed by DIR, not by an empty string\n"},
    {{"export", "FILE", "--csv", ""}, "error: the option '--csv' must be followed by DIR, not by an empty string\n"},
    {{"run", "CASE", "--threads"}, "error: the option '--threads' must be followed by N\n"},
    {{"run", "CASE", "--threads", "0"}, "error: --threads must be from 1 to 4096, not '0'\n"},
    {{"run", "CASE", "--threads", "-1"}, "error: --threads must be from 1 to 4096, not '-1'\n"},
    {{"run", "CASE", "--threads", "abc"}, "error: --threads must be from 1 to 4096, not 'abc'\n"},
    {{"run", "CASE", "--threads", "2.5"}, "error: --threads must be from 1 to 4096, not '2.5'\n"},
    {{"run", "CASE", "--threads", "4097"}, "error: --threads must be from 1 to 4096, not '4097'\n"},
    {{"run", "CASE", "--threads="}, "error: --threads must be from 1 to 4096, not ''\n"},
    {{"check", "CASE", "--threads", "99999999999999999999"},
     "error: --threads must be from 1 to 4096, not '99999999999999999999'\n"},
    {{"run", "CASE", "--seed", "-1"}, "error: --seed must be a whole number from 0 to 2^64-1, not '-1'\n"},
    {{"run", "CASE", "--seed", "1e3"}, "error: --seed must be a whole number from 0 to 2^64-1, not '1e3'\n"},
    {{"run", "CASE", "--seed", "18446744073709551616"},
     "error: --seed must be a whole number from 0 to 2^64-1, not '18446744073709551616'\n"},
    {{"evaluate", "CASE"},
     "error: 'hifdm evaluate' needs either the option --designs FILE or the option --template FILE\n"},
    {{"evaluate", "CASE", "--designs=D", "--template=T"},
     "error: 'hifdm evaluate' needs either the option --designs FILE or the option --template FILE\n"},
    {{"evaluate", "CASE", "--template=T", "-o", "O"}, "error: the options -o and --template cannot be combined\n"},
    {{"evaluate", "CASE", "--designs=D", "--json"},
     "error: the option --json needs -o FILE, because JSON and the table cannot share the standard output\n"},
    {{"evaluate", "CASE", "--seed", "1"},
     "error: '--seed' is not an option of this command. 'hifdm help evaluate' lists the options of the command\n"},
    {{"run", "CASE", "--json=yes"}, "error: '--json' has no value\n"},
};
enum { N_WRONG = sizeof wrong / sizeof *wrong };

START_TEST(wrong_command_lines_are_told)
{
    const char *argv[8] = {hifdm_program()};
    for (int k = 0; k < 6; k++)
        argv[k + 1] = wrong[_i].argv[k];
    demand_exit(run_command(HANG_S, argv), 2, wrong[_i].error, __LINE__);
    ck_assert_str_eq(said.err, wrong[_i].error);
    ck_assert_str_eq(said.out, "");
}
END_TEST

/* --set is part of the case, so its faults are told like those of the file, all of them. */
START_TEST(wrong_settings_are_told_together)
{
    HIFDM(2, "run", REFLECTOR, "-o", temp("r.h5"), "--set", "form.pretention_N=1", "--set", "optimize.sed=1", "--set",
          "form.max_iterations=ten", "--set", "form.pretension_N", "--set", "=1", "--set", "form.stop=", "--set",
          "form.pretension_N=-3", "--set", "form=5", "--set", "scene.parabolic_cylinder.modules=[1, x]");
    ck_assert_str_eq(
        said.err,
        "error: --set form.pretention_N=1: pretention_N: unknown key; did you mean 'pretension_N'?\n"
        "error: --set optimize.sed=1: sed: unknown key; did you mean 'seed'?\n"
        "error: --set form.max_iterations=ten: form.max_iterations: must be a whole number, not ten\n"
        "error: --set form.pretension_N: must be key=value, like form.pretension_N=12\n"
        "error: --set =1: must be key=value, like form.pretension_N=12\n"
        "error: --set form.stop=: form.stop: there is no value after the '='\n"
        "error: --set form.pretension_N=-3: form.pretension_N: must be above 0 and at most 1000000000, not -3\n"
        "error: --set form=5: form: must be a section of key: value lines ({} takes every default)\n"
        "error: --set scene.parabolic_cylinder.modules=[1, x]: scene.parabolic_cylinder.modules: must be a whole "
        "number, not x\n");
    ck_assert(!is_there(temp("r.h5")));
}
END_TEST

/* A script that asked for JSON gets JSON. */
START_TEST(errors_are_in_the_json_object)
{
    HIFDM(2, "run", temp("missing.yaml"), "--json", NOWHERE);
    EXPECT(out_as("e.json"), "--", "a['status'] == 'bad_case'", "len(a['errors']) == 1",
           "a['errors'][0].endswith('missing.yaml: cannot open: No such file or directory')", "'form' not in a",
           "'optimize' not in a", "'file' not in a");
    HIFDM(2, "run", REFLECTOR, NOWHERE, "--json", "--set", "form.stop=\"never\"", "--set", "form.method=magic");
    EXPECT(out_as("f.json"), "--", "len(a['errors']) == 2", "'form.stop=\"never\"' in a['errors'][0]");
}
END_TEST

Suite *suite_cli_usage(void)
{
    Suite *suite = suite_create("cli/usage");
    TCase *tcase = tcase_create("usage");
    tcase_add_loop_test(tcase, wrong_command_lines_are_told, 0, N_WRONG);
    tcase_add_test(tcase, wrong_settings_are_told_together);
    tcase_add_test(tcase, errors_are_in_the_json_object);
    suite_add_tcase(suite, tcase);
    return suite;
}
