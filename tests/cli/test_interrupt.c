/* A run that is stopped in the middle, or that somebody else overtakes: no half-written file under the final name. */
#include "cli.h"

#include <fcntl.h>
#include <glob.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <time.h>

extern char **environ;

#define FOREVER                                                                                                        \
    "--set", "optimize.generations=1000000", "--set", "optimize.stagnation_generations=1000000", "--set",              \
        "optimize.population=20"

/* Something the program has written beside `path`: it is in the middle of its work. */
static bool has_begun(const char *path)
{
    glob_t found;
    bool begun = glob(formatted("%s.*", path), 0, NULL, &found) == 0;
    globfree(&found);
    return begun;
}

/* Start the program and wait until it has made its temporary file. */
static pid_t start(const char *path, const char *const argv[])
{
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, temp("out"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, temp("err"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    pid_t child;
    ck_assert_int_eq(posix_spawn(&child, argv[0], &actions, NULL, (char *const *)argv, environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    for (int i = 0; i < 4000 && !has_begun(path); i++)
        nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    ck_assert_msg(has_begun(path), "no run began");
    return child;
}

static int end_of(pid_t child)
{
    int state;
    ck_assert_int_eq(waitpid(child, &state, 0), child);
    return WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
}

static const int deadly[] = {SIGKILL, SIGINT, SIGTERM, SIGHUP};
enum { N_DEADLY = sizeof deadly / sizeof *deadly };

START_TEST(stopped_runs_leave_no_result)
{
    const char *path = temp("new.h5");
    const char *const argv[] = {hifdm_program(), "run", CHEN, "-o", path, FOREVER, NULL};
    pid_t child = start(path, argv);
    ck_assert_int_eq(kill(child, deadly[_i]), 0);
    ck_assert_int_eq(end_of(child), deadly[_i] == SIGKILL ? 128 + SIGKILL : 75);
    ck_assert(!is_there(path));
    if (deadly[_i] != SIGKILL) ck_assert_msg(!has_begun(path), "a temporary file stays after signal %d", deadly[_i]);
    HIFDM(0, "run", file_with("c.yaml", SMALL_SCENE), "-o", path); /* what is left does not stand in the way */
}
END_TEST

START_TEST(stopped_runs_leave_an_old_result_as_it_was)
{
    const char *path = temp("old.h5");
    write_file(path, "mine");
    const char *const argv[] = {hifdm_program(), "run", CHEN, "-o", path, "--force", FOREVER, NULL};
    pid_t child = start(path, argv);
    ck_assert_int_eq(kill(child, deadly[_i]), 0);
    ck_assert_int_eq(end_of(child), deadly[_i] == SIGKILL ? 128 + SIGKILL : 75);
    ck_assert(file_is(path, "mine"));
}
END_TEST

/* The name was free when the run began. Its result is kept, and the message says where. */
START_TEST(a_file_made_meanwhile_is_not_replaced)
{
    const char *path = temp("both.h5");
    const char *const argv[] = {hifdm_program(),           "run", CHEN, "-o", path, "--quiet", "--set",
                                "optimize.generations=80", NULL};
    pid_t child = start(path, argv);
    write_file(path, "mine");
    ck_assert_int_eq(end_of(child), 5);
    ck_assert(file_is(path, "mine"));
    char *err = read_file(temp("err"), NULL), *where = strstr(err, "this run's result is ");
    ck_assert_msg(where != NULL, "%s", err);
    where += strlen("this run's result is ");
    where[strcspn(where, "\n")] = '\0';
    SHELL(0, "mv \"$1\" \"$2\"", where, temp("kept.h5"));
    EXPECT(temp("kept.h5"), "--", "a['ga/psi_m'].shape[0] > 1");
    free(err);
}
END_TEST

/* Two runs into one name at the same time: with --force the later one wins, and what is there is whole. */
START_TEST(runs_into_the_same_name_do_not_mix)
{
    const char *path = temp("same.h5");
    SHELL(0,
          "\"$0\" run \"$1\" -o \"$2\" --force --quiet --seed 1 --set optimize.generations=30 2>/dev/null & one=$!\n"
          "\"$0\" run \"$1\" -o \"$2\" --force --quiet --seed 2 --set optimize.generations=30 2>/dev/null & two=$!\n"
          "wait $one && wait $two",
          CHEN, path);
    EXPECT(path, "--", "a.attrs['seed'] in (1, 2)", "a['ga/psi_m'].shape == (30, 50)");
    ck_assert(!has_begun(path));
}
END_TEST

Suite *suite_cli_interrupt(void)
{
    Suite *suite = suite_create("cli/interrupt");
    TCase *tcase = tcase_create("interrupt");
    tcase_add_loop_test(tcase, stopped_runs_leave_no_result, 0, N_DEADLY);
    tcase_add_loop_test(tcase, stopped_runs_leave_an_old_result_as_it_was, 0, N_DEADLY);
    tcase_add_test(tcase, a_file_made_meanwhile_is_not_replaced);
    tcase_add_test(tcase, runs_into_the_same_name_do_not_mix);
    suite_add_tcase(suite, tcase);
    return suite;
}
