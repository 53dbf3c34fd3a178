/* Somebody else writes the result file while a run goes on, or a restart does not get far: no file is lost. */
#include "session.h"

#include <time.h>

/* Another file takes the name of the result while the run goes on. The result is kept, and the message says where. */
START_TEST(a_file_made_meanwhile_is_not_replaced)
{
    const char *path = temp("both.h5"), *c = storing_case("c.yaml", 1000);
    session s = start_held_run(c, path, NULL);
    wait_for_generations(&s, path);
    write_file(temp("mine"), "mine");
    SHELL(0, "mv \"$1\" \"$2\"", temp("mine"), path);
    ck_assert_int_eq(end_of(&s), 5);
    ck_assert(file_is(path, "mine"));
    char *err = read_file(temp_path("err"), NULL), *where = strstr(err, "this run's result is ");
    ck_assert_msg(where != NULL, "%s", err);
    where += strlen("this run's result is ");
    where[strcspn(where, "\n")] = '\0';
    SHELL(0, "mv \"$1\" \"$2\"", where, temp("kept.h5"));
    EXPECT(temp("kept.h5"), "--", "a['search/population/psi_m'].shape[0] > 1");
    free(err);
}
END_TEST

/* A restart that fails, or is told to stop, before there is a shape leaves the old result. */
START_TEST(a_restart_replaces_nothing_before_it_has_a_shape)
{
    const char *path = temp("old.h5");
    write_file(path, "mine");
    const char *const argv[] = {hifdm_program(),
                                "run",
                                REFLECTOR,
                                "-o",
                                path,
                                "--restart",
                                "--set",
                                "form.method=hifdm",
                                "--set",
                                "form.max_iterations=10000000",
                                "--set",
                                "form.residual_tolerance=1e-13",
                                "--set",
                                "scene.parabolic_cylinder.cells_per_module=[6, 6]",
                                "--progress",
                                "jsonl",
                                NULL};
    session s = start_program(argv);
    ck_assert(wait_until(&s, says_form, temp("err")));
    ck_assert_int_eq(end_by(&s, SIGTERM), 75);
    ck_assert(file_is(path, "mine"));
}
END_TEST

/* The sums of a far field, of an hour here, end as well. */
START_TEST(a_far_field_is_told_to_stop)
{
    const char *path = temp("far.h5");
    const char *c = file_with("far.yaml", "scene:\n  paraboloid: {aperture_m: 4, focal_length_m: 2, rings: 5}\n"
                                          "surface:\n  frequencies_Hz: [2e13]\n  pattern: {}\n");
    const char *const argv[] = {hifdm_program(), "run", c, "-o", path, "--progress", "jsonl", NULL};
    session s = start_program(argv);
    ck_assert(wait_until(&s, says_form, temp("err")));
    nanosleep(&(struct timespec){.tv_nsec = 500000000}, NULL); /* form-finding takes a thousandth of it */
    ck_assert_int_eq(end_by(&s, SIGTERM), 75);
    ck_assert(says(temp("err"), "the shape of stage form has no far field"));
    HIFDM(0, "show", path); /* the shape is kept */
    OUT("unfinished");
    HIFDM(0, "run", c, "-o", temp("near.h5"), "--quiet", "--set", "surface.frequencies_Hz=[2e9]");
    EXPECT(path, temp("near.h5"), "--",
           "(a['form/position_m'][:] == b['form/position_m'][:]).all() and 'pattern' not in a",
           "a['form'].attrs['psi_m'] == b['form'].attrs['psi_m']");
    const char *less = file_with("far.yaml", "scene:\n  paraboloid: {aperture_m: 4, focal_length_m: 2, rings: 5}\n"
                                             "surface:\n  frequencies_Hz: [2e9]\n  pattern: {}\n");
    HIFDM(5, "run", less, "-o", path);
    ERR("unfinished result of another case");
}
END_TEST

/* Processor time of a program, s. */
static double processor_s(pid_t id)
{
    unsigned long user = 0, system = 0;
    char *text = read_file(formatted("/proc/%d/stat", (int)id), NULL), *after = strrchr(text, ')');
    ck_assert(after && sscanf(after + 1, " %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user, &system) == 2);
    free(text);
    return (double)(user + system) / (double)sysconf(_SC_CLK_TCK);
}

/* Three factorisations of seconds each hold the net. That one is left while it goes on, unit/linalg/band shows. */
START_TEST(exact_tensions_are_told_to_stop)
{
    const double begun_s = 1.5; /* of eleven: not long after the case is read */
    const char *path = temp("run.h5");
    const char *c = file_with("c.yaml", "scene:\n  paraboloid: {aperture_m: 40, focal_length_m: 20, rings: 80, "
                                        "rear_distance_m: 12}\nform: {prestress: exact}\n");
    const char *const argv[] = {hifdm_program(), "run", c, "-o", path, "--progress", "jsonl", NULL};
    session s = start_program(argv);
    while (processor_s(s.id) < begun_s)
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    ck_assert_int_eq(end_by(&s, SIGTERM), 75);
    ck_assert(says(temp("err"), "form.prestress: exact: the run was interrupted before hifdm found the tensions"));
    SHELL(0, "ls \"$1\"* 2>/dev/null; true", path);
    ck_assert_str_eq(said.out, "");
}
END_TEST

/* Who asks twice does not wait for the end of a generation. It hears both before it goes on. */
START_TEST(a_second_signal_ends_it_at_once)
{
    const char *path = temp("run.h5");
    session s = start_held_run(storing_case("c.yaml", 1000), path, NULL);
    ck_assert(freeze_when(&s, has_generations, path));
    kill(s.id, SIGINT); /* two different ones: of the same, the second may be lost */
    int code = end_by(&s, SIGTERM);
    ck_assert_msg(code == 128 + SIGINT || code == 128 + SIGTERM, "exit code %d", code);
}
END_TEST

/* Nobody reads what it says, before or after. */
static int end_unread(session *s)
{
    int err = s->err;
    s->err = -1;
    int code = end_by(s, SIGTERM);
    close(err);
    return code;
}

static bool is_done(const char *path)
{
    return is_there(path) && !is_there(formatted("%s.journal", path));
}

/* A reader that has stopped to read holds the program, but one signal is enough: while it computes, and when all that
 * is left is to print. */
START_TEST(a_signal_is_heard_while_nobody_reads)
{
    const char *path = temp("run.h5"), *c = storing_case("c.yaml", 60);
    session s = start_held_run(c, path, NULL);
    wait_for_generations(&s, path);
    ck_assert_int_eq(end_unread(&s), 75);
    ck_assert_int_lt(generations_in_file(path), 10); /* it stops soon, of 60 */
    HIFDM(0, "run", c, "-o", path, "--quiet");
    HIFDM(0, "run", c, "-o", temp("whole.h5"), "--quiet");
    HIFDM(0, "diff", path, temp("whole.h5"));
    const char *const argv[] = {
        "/bin/sh",        "-c", "exec \"$0\" run \"$1\" -o \"$2\" --progress none >&2", hifdm_program(), c,
        temp("other.h5"), NULL};
    s = start_session(temp_path(""), true, argv);
    ck_assert(wait_until(&s, is_done, temp("other.h5")));
    ck_assert_int_eq(end_unread(&s), 75);
    HIFDM(0, "diff", temp("other.h5"), path);
}
END_TEST

/* As nohup does it. */
START_TEST(an_ignored_signal_stays_ignored)
{
    const char *path = temp("run.h5"), *c = storing_case("c.yaml", 100);
    const char *const argv[] = {
        "/bin/sh", "-c", "trap '' HUP; exec \"$0\" run \"$1\" -o \"$2\" --progress line", hifdm_program(), c,
        path,      NULL};
    session s = start_session(temp_path(""), true, argv);
    wait_for_generations(&s, path);
    ck_assert_int_eq(end_by(&s, SIGHUP), 0);
}
END_TEST

Suite *suite_cli_interrupt(void)
{
    Suite *suite = suite_create("cli/interrupt");
    TCase *tcase = tcase_create("interrupt");
    tcase_add_test(tcase, a_file_made_meanwhile_is_not_replaced);
    tcase_add_test(tcase, a_restart_replaces_nothing_before_it_has_a_shape);
    tcase_add_test(tcase, a_far_field_is_told_to_stop);
    tcase_add_test(tcase, exact_tensions_are_told_to_stop);
    tcase_add_test(tcase, a_second_signal_ends_it_at_once);
    tcase_add_test(tcase, a_signal_is_heard_while_nobody_reads);
    tcase_add_test(tcase, an_ignored_signal_stays_ignored);
    suite_add_tcase(suite, tcase);
    return suite;
}
