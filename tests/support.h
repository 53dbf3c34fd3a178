/* support - what every test may use: the list of suites, files, programs, failing allocations, random numbers.
 *
 * A helper aborts the running test (ck_abort_msg) if it cannot do its work, so callers check nothing. The caller frees
 * the strings that helpers return, unless a comment says otherwise. */
#pragma once

#include <check.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SUITE(kind, name) Suite *suite_##kind##_##name(void);
#define MIRROR(kind, room, name) SUITE(kind, name)
#include "suites.list.h"
#undef MIRROR
#undef SUITE

/* ---- Files ----
 * The paths are in a ring of static buffers, and each is valid until 16 further calls. */
const char *source_path(const char *relative); /* below HIFDM_SOURCE_DIR, else the current directory */
/* Returns the path of a file in the directory of this test, which is removed after the run (HIFDM_TEST_KEEP=1 keeps
 * it). With CK_FORK=no all tests share one directory. */
const char *temp_path(const char *name);
char *read_file(const char *path, size_t *size); /* whole file with a final NUL; size may be NULL */
void write_file(const char *path, const char *text);

/* Copies `text` (may be NULL) into said[size] without the folder of temp_path. A text that is too long is cut off. */
void copy_without_folder(const char *text, char *said, size_t size);

/* ---- Programs ---- */
struct command {
    int exit_code; /* as a shell returns it: 128 + number if killed by a signal */
    bool timed_out;
    char *out; /* its whole standard output, ending with a NUL */
    char *err;
};

const char *hifdm_program(void);  /* $HIFDM, else build/hifdm */
const char *python_program(void); /* $PYTHON, else /usr/bin/python3; has h5py and yaml */

const char *installed_prefix(void); /* $HIFDM_PREFIX, else build/prefix; `make install` makes it */
const char *c_compiler(void);       /* $HIFDM_CC, else cc; with the flags that link our library */

/* Runs argv without a standard input, and waits for it. argv ends with NULL; argv[0] is searched in PATH. After
 * timeout_s, times CK_TIMEOUT_MULTIPLIER as for the limits of check itself, the program is killed. */
struct command run_command(double timeout_s, const char *const argv[]);
void free_command(struct command *command);

/* A time limit that only a program that hangs reaches, on a busy machine as well. It is below the 300 s that `make
 * test` allows for one test. */
#define HANG_S 250.0

/* run_hifdm("check", case_file) */
#define run_hifdm(...) run_command(HANG_S, (const char *const[]){hifdm_program(), __VA_ARGS__, NULL})

/* ---- What this machine lacks ----
 * A test skips a check by one of these calls, never by a bare return. The runner lists the skipped checks at its end
 * and adds them to the file HIFDM_SKIPPED, from which .ci/run makes its closing summary. */
/* Skips a check that this machine cannot do, because of its processor or its user. */
void skip_for_machine(const char *check, const char *reason);
/* Skips a check that needs a program which can be installed. With HIFDM_NO_SKIP=1 the check fails. */
void skip_for_tool(const char *check, const char *reason);

/* ---- Failing allocations ----
 * The linker redirects malloc, calloc, realloc, aligned_alloc, strdup and strndup of the library and of the tests to
 * support.c. It cannot redirect those inside shared libraries (HDF5, libyaml, GSL, OpenMP). The assertions of check
 * allocate, too, so there must be none between the two calls.
 *
 *     for (long n = 1;; n++) {
 *         fail_allocation_at(n);
 *         hf_status status = hf_workspace_create(&model, &workspace);
 *         if (!end_allocation_failure())
 *             break; ... status is OK: fewer than n allocations were made
 *         ck_assert_int_eq(status, HF_NO_MEMORY);
 *     } */
void fail_allocation_at(long n);   /* the n-th one from now returns NULL (1 is the next) */
bool end_allocation_failure(void); /* ends the failure; true: the n-th one was reached */
long allocation_count(void);       /* made by this process so far; must not grow in hot paths */

/* ---- Arrays of arenas ----
 * tests/guards.c puts guards behind them. Tests of the arena itself switch them off by without_guards. */
void without_guards(void);

/* ---- Random numbers for property tests ----
 * The whole run has one seed, always the same unless HIFDM_TEST_SEED is set. The runner prints it if a test failed.
 * Each trial has its own stream of random numbers: struct rng rng = rng_start(trial). */
struct rng {
    uint64_t state;
};

uint64_t test_seed(void);
struct rng rng_start(uint64_t stream);
uint64_t rng_next(struct rng *rng);
double rng_uniform(struct rng *rng, double low, double high); /* in [low, high) */
int rng_int(struct rng *rng, int low, int high);              /* in low..high, both included */

/* ---- For run_tests.c ---- */
void begin_test_run(void);
void end_test_run(void);
int tell_skipped(void); /* prints the skipped checks and returns their number; before end_test_run */
