/* session - starts programs that a test kills, stops or disturbs while they run, and reads the files they leave. */
#ifndef HIFDM_TESTS_SESSION_H
#define HIFDM_TESTS_SESSION_H

#include "cli.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>

extern char **environ;

/* A genetic algorithm on SMALL_SCENE that does little else than store: its evaluations take some 20 us a generation. */
#define STORING_GA                                                                                                     \
    "optimize: {population: 20, generations: %d, seed: 7, stagnation_generations: 1000000, "                           \
    "polish_iterations: 3}\n"

static inline const char *storing_case(const char *name, int generations)
{
    return file_with(name, formatted(SMALL_SCENE STORING_GA, generations));
}

static inline void sleep_s(double seconds)
{
    struct timespec t = {.tv_sec = (time_t)seconds, .tv_nsec = (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&t, NULL);
}

/* Start the program, its words in the files "out" and "err" of the test's directory. */
static inline pid_t start_program(const char *const argv[])
{
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, temp_path("out"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, temp_path("err"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawnattr_t heard; /* SIGHUP, which nohup before `make test` would have it ignore */
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGHUP);
    posix_spawnattr_init(&heard);
    posix_spawnattr_setsigdefault(&heard, &set);
    posix_spawnattr_setflags(&heard, POSIX_SPAWN_SETSIGDEF);
    pid_t child;
    ck_assert_int_eq(posix_spawn(&child, argv[0], &actions, &heard, (char *const *)argv, environ), 0);
    posix_spawnattr_destroy(&heard);
    posix_spawn_file_actions_destroy(&actions);
    return child;
}

/* As a shell says it: 128 + number when killed. */
static inline int end_of(pid_t child)
{
    int state;
    ck_assert_int_eq(waitpid(child, &state, 0), child);
    return WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
}

/* Wait until the run has stored a generation in the journal of `path`. */
static inline void wait_for_generations(const char *path)
{
    struct stat info = {0};
    const char *journal = keep(formatted("%s.journal", path));
    for (int i = 0; i < 8000 && info.st_size < 1000; i++) {
        sleep_s(0.003);
        if (stat(journal, &info) != 0) info.st_size = 0;
    }
    ck_assert_msg(info.st_size >= 1000, "no generation was stored");
}

/* What the journal of `path` holds: one more than its last whole record's generation, 0 without a record; *end (may be
 * NULL) is where that record ends. Reads the format by itself: 72 bytes of header, then {"HFDJ", length, crc,
 * generation}, where length counts from generation. */
static inline int generations_in_journal(const char *path, size_t *end)
{
    size_t size = 0, at = 72;
    int n = 0;
    const char *journal = formatted("%s.journal", path);
    if (end) *end = 0;
    if (!is_there(journal)) return 0;
    char *bytes = read_file(journal, &size);
    while (at + 16 <= size) {
        uint32_t length;
        int32_t generation;
        memcpy(&length, bytes + at + 4, sizeof length);
        memcpy(&generation, bytes + at + 12, sizeof generation);
        if (memcmp(bytes + at, "HFDJ", 4) != 0 || at + 12 + length > size) break;
        n = generation + 1;
        at += 12 + length;
    }
    free(bytes);
    if (end) *end = at;
    return n;
}

/* What `hifdm show` says that the visible file holds. */
static inline int generations_in_file(const char *path)
{
    HIFDM(0, "show", path, "--json");
    const char *key = "\"generations\": ", *at = strstr(said.out, key);
    return at ? atoi(at + strlen(key)) : 0;
}

#endif
