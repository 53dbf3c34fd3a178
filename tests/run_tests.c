/* The test program: run_tests [WORD...] runs the suites of suites.list.h whose room/name contains a word, or all
 * suites. The word =room/name stands for that suite alone.
 *
 * HIFDM_TEST_JOBS=N runs N suites at a time, each in its own process. Without it all suites run in this process.
 * HIFDM_TEST_STOP=1 ends the run at the first suite that fails. The variables of check work, too: CK_FORK=no for a
 * debugger, CK_RUN_SUITE, CK_RUN_CASE, CK_VERBOSITY=verbose. */
#define _DEFAULT_SOURCE /* for MAP_ANONYMOUS */
#include "support.h"

#include "base/clock.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

static const struct {
    const char *name;
    Suite *(*create)(void);
} suites[] = {
#define SUITE(kind, name) {#kind "/" #name, suite_##kind##_##name},
#define MIRROR(kind, room, name) {#kind "/" #room "/" #name, suite_##kind##_##name},
#include "suites.list.h"
#undef MIRROR
#undef SUITE
};
enum { N_SUITE = sizeof suites / sizeof suites[0] };

/* The outcome of a suite, shared by the processes. */
typedef struct {
    pid_t runner; /* 0: not running */
    FILE *words;  /* its output, printed when it has ended */
    bool has_ended;
    int n_run, n_failed;
    double start_s;
} outcome;

static bool is_wanted(const char *name, int n_word, char **words)
{
    for (int i_word = 0; i_word < n_word; i_word++)
        if (words[i_word][0] == '=' ? !strcmp(name, words[i_word] + 1) : strstr(name, words[i_word]) != NULL)
            return true;
    return n_word == 0;
}

/* Failures, to be printed at the end of the run, because the tail of a log should list them. Forked runners share the
 * file. */
static FILE *failures;

/* Adds the failures of a suite as check prints them. check has no other way to list the names of the tests. */
static void note_failures(SRunner *runner)
{
    fflush(stdout);
    int kept = dup(STDOUT_FILENO);
    if (kept < 0 || !failures) return;
    dup2(fileno(failures), STDOUT_FILENO);
    srunner_print(runner, CK_NORMAL);
    fflush(stdout);
    dup2(kept, STDOUT_FILENO);
    close(kept);
}

static void run_suite(int i_suite, outcome *o)
{
    SRunner *runner = srunner_create(suites[i_suite].create());
    srunner_run_all(runner, CK_ENV);
    o->n_run = srunner_ntests_run(runner);
    o->n_failed = srunner_ntests_failed(runner);
    if (o->n_failed > 0) note_failures(runner);
    o->has_ended = true;
    srunner_free(runner);
}

static void start_suite(int i_suite, outcome *o)
{
    fflush(stdout);
    o->start_s = hf_clock_s();
    o->words = tmpfile();
    pid_t runner = o->words ? fork() : -1;
    if (runner < 0) {
        perror(suites[i_suite].name);
        exit(EXIT_FAILURE);
    }
    if (runner > 0) {
        o->runner = runner;
        return;
    }
    prctl(PR_SET_PDEATHSIG, SIGTERM); /* check then ends its test */
    dup2(fileno(o->words), STDOUT_FILENO);
    dup2(fileno(o->words), STDERR_FILENO);
    run_suite(i_suite, o);
    fflush(stdout);
    _exit(EXIT_SUCCESS);
}

static void tell(FILE *words)
{
    char part[4096];
    rewind(words);
    for (size_t n; (n = fread(part, 1, sizeof part, words)) > 0;)
        fwrite(part, 1, n, stdout);
    fclose(words);
    fflush(stdout);
}

static void tell_suite(int i_suite, outcome *o)
{
    if (!o->has_ended) {
        o->n_run = o->n_failed = 1;
        if (failures) fprintf(failures, "%s: its runner was killed\n", suites[i_suite].name);
        if (failures) fflush(failures);
    }
    o->runner = 0;
    printf("%s, %.1f s: ", suites[i_suite].name, hf_clock_s() - o->start_s);
    tell(o->words);
}

/* Waits until one of the running suites has ended. Returns true if it failed. */
static bool end_suite(outcome *all)
{
    pid_t ended;
    while ((ended = wait(NULL)) < 0 && errno == EINTR) {
    }
    for (int i = 0; i < N_SUITE; i++) {
        if (ended <= 0 || all[i].runner != ended) continue;
        tell_suite(i, &all[i]);
        return all[i].n_failed > 0;
    }
    return false;
}

static void run_beside(int n_job, bool stops, const bool *wanted, outcome *all)
{
    int n_running = 0;
    bool has_failed = false;
    for (int i = 0; i < N_SUITE && !(stops && has_failed); i++) {
        if (!wanted[i]) continue;
        start_suite(i, &all[i]);
        if (++n_running < n_job) continue;
        has_failed |= end_suite(all);
        n_running--;
    }
    for (int i = 0; i < N_SUITE && stops && has_failed; i++)
        if (all[i].runner > 0) kill(all[i].runner, SIGTERM);
    for (; n_running > 0; n_running--)
        end_suite(all);
}

int main(int argc, char **argv)
{
    const char *jobs = getenv("HIFDM_TEST_JOBS"), *stop = getenv("HIFDM_TEST_STOP");
    int n_job = jobs ? atoi(jobs) : 1, n_run = 0, n_failed = 0;
    bool wanted[N_SUITE], stops = stop && !strcmp(stop, "1");
    outcome *all = mmap(NULL, N_SUITE * sizeof *all, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED) {
        perror("mmap");
        return EXIT_FAILURE;
    }
    begin_test_run();
    failures = tmpfile();
    for (int i = 0; i < N_SUITE; i++)
        wanted[i] = is_wanted(suites[i].name, argc - 1, argv + 1);
    if (n_job > 1) run_beside(n_job, stops, wanted, all);
    for (int i = 0; i < N_SUITE; i++) {
        if (n_job <= 1 && wanted[i] && !(stops && n_failed > 0)) run_suite(i, &all[i]);
        n_run += all[i].n_run;
        n_failed += all[i].n_failed;
    }
    int n_skipped = tell_skipped();
    end_test_run();

    if (n_failed > 0 && failures) {
        printf("what failed, once more:\n");
        tell(failures);
    }
    if (n_failed > 0) printf("random numbers of this run: HIFDM_TEST_SEED=%" PRIu64 "\n", test_seed());
    if (n_run == 0) printf("no test ran\n");
    printf("%d passed, %d failed, ", n_run - n_failed, n_failed);
    printf(n_skipped ? "%d skipped: see above\n" : "nothing skipped\n", n_skipped);
    return n_run > 0 && n_failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
