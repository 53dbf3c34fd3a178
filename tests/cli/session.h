/* session - starts programs that a test kills, stops or disturbs while they run, and reads the files that they
 * leave. */
#pragma once

#include "cli.h"

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <sys/wait.h>

extern char **environ;

/* A genetic algorithm on SMALL_SCENE that does little else than store. Its evaluations take about 20 us per
 * generation. */
#define STORING_GA                                                                                                     \
    "optimize: {population: 20, generations: %d, seed: 7, stagnation_generations: 1000000, "                           \
    "refine_steps: 3}\n"

static inline const char *storing_case(const char *name, int generations)
{
    return file_with(name, formatted(SMALL_SCENE STORING_GA, generations));
}

/* ---- a program that a test kills, stops or disturbs ----
 * No test waits for a fixed time. It waits for a mark that the program leaves in a folder, and for its end. */

typedef struct {
    pid_t id;
    int changes;  /* inotify of the folder */
    int life;     /* closed when the program ends */
    int err;      /* output of a held program; -1: it is not held */
    int n_change; /* changes seen so far */
    bool has_ended;
    int state; /* as waitpid returns it, after the end */
} session;

/* Makes a full pipe. A process that writes into it waits until another one has read. */
static inline void make_full_pipe(int end[2])
{
    static const char zeros[4096];
    ck_assert_int_eq(pipe(end), 0);
    ck_assert_int_eq(fcntl(end[1], F_SETFL, O_NONBLOCK), 0);
    for (size_t n = sizeof zeros; n > 0;)
        if (write(end[1], zeros, n) < 0) n /= 2;
    ck_assert_int_eq(fcntl(end[1], F_SETFL, 0), 0);
}

/* Starts the program (argv[0], its full path). Its output goes to the files "out" and "err" of the directory of the
 * test. The test can wait for changes in `folder`, which must exist. A held program stays in the first line that it
 * writes to its standard error, until let_go: `run --progress line` stays there after it has stored a generation. */
static inline session start_session(const char *folder, bool is_held, const char *const argv[])
{
    session s = {.err = -1, .changes = inotify_init1(IN_CLOEXEC)};
    int life[2], err[2];
    ck_assert_int_ge(s.changes, 0);
    ck_assert_int_ge(inotify_add_watch(s.changes, folder, IN_ALL_EVENTS & ~(IN_ACCESS | IN_CLOSE_NOWRITE | IN_OPEN)),
                     0);
    ck_assert_int_eq(pipe(life), 0);
    if (is_held) make_full_pipe(err);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addclose(&actions, life[0]);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, temp_path("out"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (is_held) {
        posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
        posix_spawn_file_actions_addclose(&actions, err[0]);
        posix_spawn_file_actions_addclose(&actions, err[1]);
    } else {
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, temp_path("err"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    }
    /* The program must react to SIGHUP. With nohup before `make test` it would ignore SIGHUP. */
    posix_spawnattr_t heard;
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGHUP);
    posix_spawnattr_init(&heard);
    posix_spawnattr_setsigdefault(&heard, &set);
    posix_spawnattr_setflags(&heard, POSIX_SPAWN_SETSIGDEF);
    ck_assert_int_eq(posix_spawn(&s.id, argv[0], &actions, &heard, (char *const *)argv, environ), 0);
    posix_spawnattr_destroy(&heard);
    posix_spawn_file_actions_destroy(&actions);
    close(life[1]);
    s.life = life[0];
    if (is_held) {
        close(err[1]);
        s.err = err[0];
    }
    return s;
}

static inline session start_program(const char *const argv[])
{
    return start_session(temp_path(""), false, argv);
}

/* Starts `hifdm run` of a genetic algorithm, held after the first generation of this process. */
static inline session start_held_run(const char *case_path, const char *path, const char *const more[])
{
    const char *argv[32] = {hifdm_program(), "run", case_path, "-o", path, "--progress", "line"};
    for (int n = 7; more && *more; more++)
        argv[n++] = *more;
    return start_session(temp_path(""), true, argv);
}

/* Starts `hifdm sweep` into this folder; `threads` may be NULL. */
static inline session start_sweep(const char *study, const char *folder, const char *threads)
{
    const char *argv[] = {hifdm_program(), "sweep", study, "--dir", folder, "--quiet", threads ? "--threads" : NULL,
                          threads,         NULL};
    mkdir(folder, 0777);
    return start_session(folder, false, argv);
}

/* Sleeps until something has changed in the folder. Returns the number of changes, or 0 if the program has ended. */
static inline int wait_for_change(session *s)
{
    struct pollfd on[] = {{.fd = s->changes, .events = POLLIN}, {.fd = s->life}};
    char events[16384];
    int n = 0, found;
    while ((found = poll(on, 2, (int)(1e3 * HANG_S))) < 0)
        ck_assert_int_eq(errno, EINTR);
    ck_assert_msg(found > 0, "the program hangs");
    if (!(on[0].revents & POLLIN)) return 0;
    ssize_t size = read(s->changes, events, sizeof events);
    for (ssize_t at = 0; at < size; n++) {
        struct inotify_event event;
        memcpy(&event, events + at, sizeof event);
        at += (ssize_t)(sizeof event + event.len);
    }
    s->n_change += n;
    return n;
}

/* Waits until is_so(path). Returns false if the program ends before. */
static inline bool wait_until(session *s, bool (*is_so)(const char *path), const char *path)
{
    while (!is_so(path))
        if (!wait_for_change(s)) return is_so(path);
    return true;
}

/* Waits until is_so(path) and stops the program (SIGSTOP) in this state. SIGKILL ends it, SIGCONT lets it continue.
 * Returns false if the program ends before. */
static inline bool freeze_when(session *s, bool (*is_so)(const char *path), const char *path)
{
    while (wait_until(s, is_so, path)) {
        kill(s->id, SIGSTOP);
        ck_assert_int_eq(waitpid(s->id, &s->state, WUNTRACED), s->id);
        s->has_ended = !WIFSTOPPED(s->state);
        if (s->has_ended) return false;
        if (is_so(path)) return true;
        kill(s->id, SIGCONT);
        if (!wait_for_change(s)) return false;
    }
    return false;
}

/* Reads the output of a held program from now until its end into the file "err". */
static inline void let_go(session *s)
{
    char part[4096];
    ssize_t n;
    int file = open(temp_path("err"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ck_assert_int_ge(file, 0);
    while ((n = read(s->err, part, sizeof part)) > 0)
        for (ssize_t i = 0; i < n; i++) /* without the bytes that filled the pipe */
            if (part[i]) ck_assert_int_eq(write(file, part + i, 1), 1);
    close(file);
    close(s->err);
    s->err = -1;
}

/* Waits for the end and returns the exit code as a shell does: 128 + number if killed by a signal. */
static inline int end_of(session *s)
{
    if (s->err >= 0) let_go(s);
    if (!s->has_ended) ck_assert_int_eq(waitpid(s->id, &s->state, 0), s->id);
    close(s->changes);
    close(s->life);
    s->has_ended = true;
    return WIFSIGNALED(s->state) ? 128 + WTERMSIG(s->state) : WEXITSTATUS(s->state);
}

static inline int end_by(session *s, int number)
{
    kill(s->id, number);
    kill(s->id, SIGCONT);
    return end_of(s);
}

/* ---- marks ---- */

static inline bool has_generations(const char *path)
{
    struct stat info;
    return stat(formatted("%s.journal", path), &info) == 0 && info.st_size >= 1000;
}

/* Returns true if the output of the program in this file contains `part`. */
static inline bool says(const char *path, const char *part)
{
    char *text = read_file(path, NULL);
    bool found = strstr(text, part) != NULL;
    free(text);
    return found;
}

/* Returns the first file in this folder whose name fits the pattern, or NULL. */
static inline const char *file_like(const char *folder, const char *pattern)
{
    static char path[PATH_MAX];
    glob_t found;
    bool is_found = glob(formatted("%s/%s", folder, pattern), 0, NULL, &found) == 0;
    if (is_found) snprintf(path, sizeof path, "%s", found.gl_pathv[0]);
    globfree(&found);
    return is_found ? path : NULL;
}

/* Returns true if a point of the sweep in this folder is being computed. */
static inline bool has_begun_point(const char *folder)
{
    char path[PATH_MAX];
    const char *journal = file_like(folder, "*.h5.journal");
    if (!journal) return false;
    snprintf(path, sizeof path, "%.*s", (int)(strlen(journal) - strlen(".journal")), journal);
    return is_there(path) && has_generations(path);
}

/* Return true if the form-finding or the refinement of a run with --progress jsonl has begun. `err`: its output. */
static inline bool says_form(const char *err)
{
    return says(err, "\"phase\": \"form\"");
}

static inline bool says_refine(const char *err)
{
    return says(err, "\"phase\": \"refine\"");
}

/* Waits until the run has stored a generation in the journal of `path`. */
static inline void wait_for_generations(session *s, const char *path)
{
    if (!wait_until(s, has_generations, path)) ck_abort_msg("no generation was stored: exit code %d", end_of(s));
}

/* Returns the number of generations up to that of the last whole record in the journal of `path`, 0 without a record.
 * *end (may be NULL) is where that record ends. The format is read independently: 72 bytes of header, then {"HFDJ",
 * length, crc, generation}, where length counts from generation. */
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

/* Returns the number of generations that `hifdm show` reports for the visible file. */
static inline int generations_in_file(const char *path)
{
    HIFDM(0, "show", path, "--json");
    const char *key = "\"generations\": ", *at = strstr(said.out, key);
    return at ? atoi(at + strlen(key)) : 0;
}

/* Draws the samples of a case and kills the program n_kill times, each time after more changes in the folder of its
 * result. Then lets it finish, and checks that only the result is left. Returns its path. */
static inline const char *sample_with_kills(const char *path_of_case, int n_kill)
{
    const char *folder = temp("folder"), *path = keep(formatted("%s/b.h5", folder));
    const char *const argv[] = {hifdm_program(), "tolerance", path_of_case, "-o", path,
                                "--quiet",       "--threads", "1",          NULL};
    ck_assert_int_eq(mkdir(folder, 0777), 0);
    for (int kills = 0; kills < n_kill; kills++) {
        session s = start_session(folder, false, argv);
        for (int k = 0; k < 4 + 3 * kills && wait_for_change(&s) >= 0 && !s.has_ended;)
            k = s.n_change;
        end_by(&s, SIGKILL);
    }
    HIFDM(0, "tolerance", path_of_case, "-o", path, "--quiet");
    SHELL(0, "test \"$(ls \"$1\")\" = b.h5", folder);
    return path;
}
