/* Implements support.h. Sections: temporary directories, skipped checks, files, programs, failing allocations, random
 * numbers. */
#include "support.h"

#include "base/clock.h"
#include "base/random.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <gsl/gsl_errno.h>
#include <inttypes.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

/* ---- Temporary directories ----
 * The runner makes one directory and removes it at its end. The process of each test makes its own directory inside.
 * So tests that fail or crash leave nothing behind, although none of their clean-up runs. */
static char run_directory[PATH_MAX];

void begin_test_run(void)
{
    gsl_set_error_handler_off(); /* hifdm.h requires it of every program */
    const char *parent = getenv("TMPDIR");
    snprintf(run_directory, sizeof run_directory, "%s/hifdm-test-XXXXXX", parent && *parent ? parent : "/tmp");
    if (!mkdtemp(run_directory)) {
        perror(run_directory);
        exit(EXIT_FAILURE);
    }
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *position)
{
    (void)info, (void)kind, (void)position;
    return remove(path);
}

void end_test_run(void)
{
    if (getenv("HIFDM_TEST_KEEP"))
        printf("kept: %s\n", run_directory);
    else
        nftw(run_directory, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

/* ---- What this machine lacks ----
 * Each test is a process of its own, so it writes its lines into a file of the run. A test that is repeated writes the
 * same line again. */
#define SKIPPED_MAX 256 /* maximum number of different lines */

void skip_for_machine(const char *check, const char *reason)
{
    char path[PATH_MAX + 16];
    snprintf(path, sizeof path, "%s/skipped", run_directory);
    FILE *file = fopen(path, "a");
    if (!file) ck_abort_msg("%s: %s", path, strerror(errno));
    fprintf(file, "%s: %s\n", check, reason);
    fclose(file);
}

void skip_for_tool(const char *check, const char *reason)
{
    const char *no_skip = getenv("HIFDM_NO_SKIP");
    if (no_skip && !strcmp(no_skip, "1")) ck_abort_msg("%s: %s, and HIFDM_NO_SKIP=1", check, reason);
    skip_for_machine(check, reason);
}

int tell_skipped(void)
{
    char path[PATH_MAX + 16], line[SKIPPED_MAX][200];
    const char *all = getenv("HIFDM_SKIPPED");
    int n = 0;
    snprintf(path, sizeof path, "%s/skipped", run_directory);
    FILE *file = fopen(path, "r"), *list = all && *all ? fopen(all, "a") : NULL;
    while (file && n < SKIPPED_MAX && fgets(line[n], sizeof line[n], file)) {
        int k = 0;
        while (strcmp(line[k], line[n]) != 0)
            k++;
        if (k < n) continue;
        printf("skipped: %s", line[n]);
        if (list) fputs(line[n], list);
        n++;
    }
    if (file) fclose(file);
    if (list) fclose(list);
    return n;
}

/* ---- Files ---- */
static const char *join(const char *directory, const char *name)
{
    static char ring[16][PATH_MAX];
    static unsigned next;
    char *path = ring[next++ % 16];
    if (snprintf(path, PATH_MAX, "%s/%s", directory, name) >= PATH_MAX)
        ck_abort_msg("path too long: %s/%s", directory, name);
    return path;
}

const char *source_path(const char *relative)
{
    const char *top = getenv("HIFDM_SOURCE_DIR");
    return join(top ? top : ".", relative);
}

const char *temp_path(const char *name)
{
    static char directory[PATH_MAX];
    static pid_t owner; /* a forked process must not use its parent's directory */
    if (owner != getpid()) {
        snprintf(directory, sizeof directory, "%s", join(run_directory, "XXXXXX"));
        if (!mkdtemp(directory)) ck_abort_msg("%s: %s", directory, strerror(errno));
        owner = getpid();
    }
    return join(directory, name);
}

void copy_without_folder(const char *text, char *said, size_t size)
{
    const char *folder = temp_path("");
    size_t length = strlen(folder), n = 0;
    for (const char *p = text ? text : ""; *p && n + 1 < size;) {
        if (!strncmp(p, folder, length))
            p += length;
        else
            said[n++] = *p++;
    }
    said[n] = '\0';
}

char *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file) ck_abort_msg("%s: %s", path, strerror(errno));
    size_t used = 0, room = 4096;
    char *text = malloc(room);
    while (text && (used += fread(text + used, 1, room - 1 - used, file)) == room - 1)
        text = realloc(text, room *= 2);
    if (!text || ferror(file)) ck_abort_msg("%s: cannot be read", path);
    fclose(file);
    text[used] = '\0';
    if (size) *size = used;
    return text;
}

void write_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    if (!file) ck_abort_msg("%s: %s", path, strerror(errno));
    bool written = fputs(text, file) != EOF;
    if (fclose(file) != 0 || !written) ck_abort_msg("%s: cannot be written", path);
}

/* ---- Programs ---- */
const char *hifdm_program(void)
{
    const char *program = getenv("HIFDM");
    return program ? program : "build/hifdm";
}

const char *python_program(void)
{
    const char *program = getenv("PYTHON");
    return program ? program : "/usr/bin/python3";
}

const char *installed_prefix(void)
{
    const char *prefix = getenv("HIFDM_PREFIX");
    return prefix ? prefix : source_path("build/prefix");
}

const char *c_compiler(void)
{
    const char *compiler = getenv("HIFDM_CC");
    return compiler ? compiler : "cc";
}

static double timeout_multiplier(void)
{
    const char *text = getenv("CK_TIMEOUT_MULTIPLIER");
    double multiplier = text ? strtod(text, NULL) : 1.0;
    return multiplier > 0.0 ? multiplier : 1.0;
}

/* Waits for a child. It polls, because waitpid has no time limit, and the alternatives need a signal handler of the
 * whole process. Returns the exit code as a shell does. */
static int wait_for(pid_t child, double timeout_s, bool *timed_out)
{
    const struct timespec pause = {.tv_nsec = 2000000};
    double deadline_s = hf_clock_s() + timeout_s;
    int state = 0;
    pid_t ended;
    *timed_out = false;
    while ((ended = waitpid(child, &state, *timed_out ? 0 : WNOHANG)) != child) {
        if (ended < 0 && errno != EINTR) ck_abort_msg("waitpid: %s", strerror(errno));
        if (hf_clock_s() > deadline_s && !*timed_out) {
            kill(child, SIGKILL);
            *timed_out = true;
        } else if (ended == 0) {
            nanosleep(&pause, NULL);
        }
    }
    return WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
}

/* Output goes to files and not to pipes, so that nothing must be read while waiting, and its length has no limit. */
struct command run_command(double timeout_s, const char *const argv[])
{
    static unsigned serial;
    char name[32];
    snprintf(name, sizeof name, "command-%u.out", serial);
    const char *out_path = temp_path(name);
    snprintf(name, sizeof name, "command-%u.err", serial++);
    const char *err_path = temp_path(name);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err_path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    pid_t child;
    int error = posix_spawnp(&child, argv[0], &actions, NULL, (char *const *)argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error) ck_abort_msg("%s: %s", argv[0], strerror(error));

    struct command command = {0};
    command.exit_code = wait_for(child, timeout_s * timeout_multiplier(), &command.timed_out);
    command.out = read_file(out_path, NULL);
    command.err = read_file(err_path, NULL);
    return command;
}

void free_command(struct command *command)
{
    free(command->out);
    free(command->err);
    *command = (struct command){0};
}

/* ---- Failing allocations ----
 * The counters are atomic, because the threads of a batch may allocate at the same time. */
static atomic_long n_allocation;
static atomic_long fail_at; /* value of n_allocation that fails; 0: none */

void fail_allocation_at(long n)
{
    atomic_store(&fail_at, atomic_load(&n_allocation) + n);
}

bool end_allocation_failure(void)
{
    long failed_at = atomic_exchange(&fail_at, 0);
    return failed_at != 0 && atomic_load(&n_allocation) >= failed_at;
}

long allocation_count(void)
{
    return atomic_load(&n_allocation);
}

static bool is_denied(void)
{
    if (atomic_fetch_add(&n_allocation, 1) + 1 != atomic_load(&fail_at)) return false;
    errno = ENOMEM;
    return true;
}

/* ld --wrap=NAME redirects calls of NAME to __wrap_NAME, and calls of __real_NAME to the C library. */
#define WRAP(type, name, parameters, arguments)                                                                        \
    type __real_##name parameters;                                                                                     \
    type __wrap_##name parameters;                                                                                     \
    type __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        return is_denied() ? NULL : __real_##name arguments;                                                           \
    }

WRAP(void *, malloc, (size_t size), (size))
WRAP(void *, calloc, (size_t count, size_t size), (count, size))
WRAP(void *, realloc, (void *old, size_t size), (old, size))
WRAP(void *, aligned_alloc, (size_t alignment, size_t size), (alignment, size))
WRAP(char *, strdup, (const char *text), (text))
WRAP(char *, strndup, (const char *text, size_t size), (text, size))

/* ---- Random numbers ---- */
uint64_t test_seed(void)
{
    const char *text = getenv("HIFDM_TEST_SEED");
    return text && *text ? strtoull(text, NULL, 0) : 20220817;
}

uint64_t rng_next(struct rng *rng)
{
    return hf_random_mix(rng->state += HF_RANDOM_STEP);
}

struct rng rng_start(uint64_t stream)
{
    struct rng seed = {test_seed()};
    struct rng rng = {rng_next(&seed) ^ stream};
    rng.state = rng_next(&rng);
    return rng;
}

double rng_uniform(struct rng *rng, double low, double high)
{
    double value = low + (high - low) * ((double)(rng_next(rng) >> 11) * 0x1p-53);
    return value < high ? value : low; /* rounding may reach `high` */
}

int rng_int(struct rng *rng, int low, int high)
{
    uint64_t span = (uint64_t)((int64_t)high - low) + 1;
    return (int)(low + (int64_t)(rng_next(rng) % span));
}
