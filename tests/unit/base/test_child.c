#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
/* Children that a server makes: how they end, by whom they can be ordered, and when. */
#include "support.h"

#include "base/child.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static volatile struct {
    int parent; /* of the last child */
    int n;      /* words that were as they should be */
} * shared;

static void begin(void)
{
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    ck_assert_ptr_ne((void *)shared, MAP_FAILED);
    hf_child_server_begin();
}

static void end(void)
{
    hf_child_server_end();
    ck_assert(waitpid(-1, NULL, 0) < 0 && errno == ECHILD);
}

/* What a child does: the first letter says. */
static void work(const char *text)
{
    shared->parent = getppid();
    if (*text == 'a') abort();
    if (*text == 'k') raise(SIGKILL);
    if (*text == 'u') raise(SIGUSR2);
    if (*text == 'e') _exit(7);
    if (*text == 's') kill(0, SIGTERM);
    if (*text == 'l') {
        hf_child_limit_cpu(1);
        while (clock() < 30 * CLOCKS_PER_SEC) {
        }
    }
    for (int i = 0; i < 1000; i++)
        free(malloc((size_t)(1 + i * 97 % 5000)));
    shared->n += !strcmp(text, "words");
}

static hf_child_end ask(const char *text)
{
    hf_child_end how = {.is_known = false};
    ck_assert(hf_child_ask(work, text, &how) && how.is_known);
    return how;
}

START_TEST(an_end_is_known)
{
    char words[128];
    begin();
    ck_assert_int_eq(ask("words").exit_status, 0);
    ck_assert_int_eq(shared->n, 1);
    ck_assert_int_eq(ask("exit").exit_status, 7);
    ck_assert_int_eq(ask("abort").signal, SIGABRT);
    ck_assert(!ask("abort").is_sent);
    hf_child_describe(ask("loop"), words, sizeof words);
    ck_assert_str_eq(words, "signal 24 (CPU time limit exceeded)");
    end();
}
END_TEST

/* By the system without memory, by somebody, and by a limit of the user's, which is lower than the child's own. */
START_TEST(an_end_from_outside_is_known)
{
    char words[128];
    begin();
    hf_child_describe(ask("kill"), words, sizeof words);
    ck_assert_str_eq(words, "signal 9 (Killed); is there enough memory, and time (ulimit -t)?");
    hf_child_describe(ask("user"), words, sizeof words);
    ck_assert_str_eq(words, "signal 12 (User defined signal 2); try again");
    end();
    struct rlimit limit;
    ck_assert_int_eq(getrlimit(RLIMIT_CPU, &limit), 0);
    limit.rlim_cur = 1;
    ck_assert_int_eq(setrlimit(RLIMIT_CPU, &limit), 0);
    hf_child_server_begin();
    hf_child_describe(ask("loop"), words, sizeof words);
    ck_assert_str_eq(words, "signal 24 (CPU time limit exceeded); raise the limit (ulimit -t)");
    end();
}
END_TEST

static void ignore(int number)
{
    (void)number;
}

/* One that is meant for the whole group, as Ctrl-C is. */
START_TEST(a_signal_for_the_group_ends_no_child)
{
    ck_assert_int_eq(setpgid(0, 0), 0);
    begin();
    signal(SIGTERM, ignore);
    ck_assert_int_eq(ask("signal").exit_status, 0);
    ck_assert_int_eq(ask("words").exit_status, 0);
    end();
}
END_TEST

START_TEST(without_a_server_nothing_is_done)
{
    hf_child_end how;
    char *longest = malloc(HF_CHILD_TEXT_SIZE + 1);
    memset(longest, 'x', HF_CHILD_TEXT_SIZE + 1);
    longest[HF_CHILD_TEXT_SIZE] = '\0';
    begin();
    ck_assert(!hf_child_ask(work, longest, &how));
    ck_assert_int_eq(ask(longest + 1).exit_status, 0);
    hf_child_server_begin();
    hf_child_server_end();
    ck_assert_int_eq(ask("words").exit_status, 0);
    ck_assert_int_eq(kill(shared->parent, SIGKILL), 0);
    ck_assert(!hf_child_ask(work, "words", &how));
    ck_assert(!hf_child_ask(work, "words", &how));
    end();
    ck_assert(!hf_child_ask(work, "words", &how));
    for (int descriptor = 0; descriptor < 3; descriptor++) /* that of a server that has ended is closed once */
        ck_assert_int_ge(fcntl(descriptor, F_GETFD), 0);
    free(longest);
}
END_TEST

/* Where children are not waited for, as below some shells, the server does wait. */
START_TEST(an_end_is_known_where_children_are_ignored)
{
    signal(SIGCHLD, SIG_IGN);
    begin();
    ck_assert_int_eq(ask("abort").signal, SIGABRT);
    end();
}
END_TEST

static void *allocate(void *stop)
{
    while (!__atomic_load_n((int *)stop, __ATOMIC_SEQ_CST))
        for (int i = 0; i < 100; i++)
            free(malloc((size_t)(1 + i * 131 % 9000)));
    return NULL;
}

static void *ask_often(void *unused)
{
    for (int i = 0; i < 20; i++)
        ck_assert_int_eq(ask("words").exit_status, 0);
    return unused;
}

/* Locks of malloc are held by some thread at most instants: under the address sanitizer, a child of this process would
 * wait for them for ever. */
START_TEST(threads_ask_while_others_allocate)
{
    enum { N = 3 };
    pthread_t asking[N], allocating[N];
    int stop = 0;
    begin();
    for (int i = 0; i < N; i++)
        ck_assert(pthread_create(&allocating[i], NULL, allocate, &stop) == 0 &&
                  pthread_create(&asking[i], NULL, ask_often, NULL) == 0);
    for (int i = 0; i < N; i++)
        pthread_join(asking[i], NULL);
    __atomic_store_n(&stop, 1, __ATOMIC_SEQ_CST);
    for (int i = 0; i < N; i++)
        pthread_join(allocating[i], NULL);
    ck_assert_int_eq(shared->n, 20 * N);
    end();
}
END_TEST

static hf_child_end run_shell(const char *script)
{
    const char *const command[] = {"/bin/sh", "-c", "eval \"$1\"", "sh", NULL};
    return hf_child_wait(hf_child_spawn(command, script));
}

/* The signals of a child's parent do not end the program, and neither do those that a thread of its parent blocks. */
START_TEST(another_program_is_a_child)
{
    const char *const nothing[] = {"/bin/no-such-program", NULL};
    const char *const longest[HF_CHILD_WORDS + 1] = {"/bin/sh", "-c", "test $# = 5", "sh", "1", "2", "3", "4"};
    sigset_t blocked;
    ck_assert_int_eq(run_shell("exit 0").exit_status, 0);
    ck_assert_int_eq(run_shell("kill -TERM $$; kill -INT $$; kill -HUP $$; kill -USR1 $$; exit 7").exit_status, 7);
    ck_assert_int_eq(run_shell("kill -ABRT $$").signal, SIGABRT);
    sigfillset(&blocked);
    ck_assert_int_eq(pthread_sigmask(SIG_BLOCK, &blocked, NULL), 0);
    hf_child_end how = run_shell("kill -XCPU $$");
    ck_assert(how.signal == SIGXCPU && !how.is_sent);
    ck_assert_int_lt(hf_child_spawn(nothing, ""), 0);
    ck_assert_int_eq(hf_child_wait(hf_child_spawn(longest, "5")).exit_status, 0);
}
END_TEST

Suite *suite_unit_child(void)
{
    Suite *suite = suite_create("unit/child");
    TCase *tests = tcase_create("child");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, an_end_is_known);
    tcase_add_test(tests, a_signal_for_the_group_ends_no_child);
    tcase_add_test(tests, without_a_server_nothing_is_done);
    tcase_add_test(tests, an_end_from_outside_is_known);
    tcase_add_test(tests, an_end_is_known_where_children_are_ignored);
    tcase_add_test(tests, another_program_is_a_child);
    tcase_add_test(tests, threads_ask_while_others_allocate);
    return suite;
}
