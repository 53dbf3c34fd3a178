/* What every test may use: the list of suites, files, the program, failing allocations, random numbers.
 *
 * Helpers abort the running test (ck_abort_msg) when they cannot do their work, so callers check nothing. Strings they
 * return are the caller's to free unless said otherwise. */
#ifndef HIFDM_TESTS_SUPPORT_H
#define HIFDM_TESTS_SUPPORT_H

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
 * Paths are in a ring of static buffers: valid until 16 further calls. */
const char *source_path(const char *relative);   /* below HIFDM_SOURCE_DIR, else the current directory */
const char *temp_path(const char *name);         /* in a directory that is this test's own and vanishes after the run
                                                  (HIFDM_TEST_KEEP=1 keeps it); with CK_FORK=no all tests share one */
char *read_file(const char *path, size_t *size); /* whole file and a final NUL; size may be NULL */
void write_file(const char *path, const char *text);

/* Copies `text` (may be NULL) into said[size], cut off where it is full, without the folder of temp_path. */
void copy_without_folder(const char *text, char *said, size_t size);

/* ---- Programs ---- */
struct command {
    int exit_code; /* as a shell gives it: 128 + number if killed by a signal */
    bool timed_out;
    char *out; /* all of its standard output, NUL-terminated */
    char *err;
};

const char *hifdm_program(void);  /* $HIFDM, else build/hifdm */
const char *python_program(void); /* $PYTHON, else /usr/bin/python3: has h5py and yaml */

const char *installed_prefix(void); /* $HIFDM_PREFIX, else build/prefix: what `make install` makes */
const char *c_compiler(void);       /* $HIFDM_CC, else cc: with the flags it needs to link our library */

/* Runs argv (ended by NULL; argv[0] is looked up in PATH) without a standard input, and waits for it. After
 * timeout_s, times CK_TIMEOUT_MULTIPLIER as for check's own limits, it is killed. */
struct command run_command(double timeout_s, const char *const argv[]);
void free_command(struct command *command);

/* A limit that only a hang reaches, on a busy machine as well, below the 300 s that `make test` grants one test. */
#define HANG_S 250.0

/* run_hifdm("check", case_file) */
#define run_hifdm(...) run_command(HANG_S, (const char *const[]){hifdm_program(), __VA_ARGS__, NULL})

/* ---- What this machine lacks ----
 * A check that cannot be done here is skipped by one of these, never by a bare return: the runner names it at its end,
 * and adds the line to the file HIFDM_SKIPPED, from which .ci/run makes its closing summary. */
void skip_for_machine(const char *check,
                      const char *reason);                 /* its processor, its user: nothing can be done about it */
void skip_for_tool(const char *check, const char *reason); /* what can be installed: with HIFDM_NO_SKIP=1 it fails */

/* ---- Failing allocations ----
 * The linker leads malloc, calloc, realloc, aligned_alloc, strdup and strndup of the library AND of the tests through
 * here; those inside shared libraries (HDF5, libyaml, GSL, OpenMP) are out of reach. check's assertions allocate too:
 * make none between the two calls.
 *
 *     for (long n = 1;; n++) {
 *         fail_allocation_at(n);
 *         hf_status status = hf_workspace_create(&model, &workspace);
 *         if (!end_allocation_failure())
 *             break; ... status is OK: fewer than n allocations were made
 *         ck_assert_int_eq(status, HF_NO_MEMORY);
 *     } */
void fail_allocation_at(long n);   /* the n-th from now (1 is the next) returns NULL, the others succeed */
bool end_allocation_failure(void); /* back to normal; true if the n-th was reached */
long allocation_count(void);       /* made by this process so far: for "the hot path allocates nothing" */

/* ---- Arrays of arenas ----
 * tests/guards.c puts guards behind them; without_guards: for tests of the arena itself. */
void without_guards(void);

/* ---- Random numbers for property tests ----
 * One seed for the whole run, the same every time unless HIFDM_TEST_SEED says otherwise; the runner prints it when a
 * test failed. A stream of it per trial: struct rng rng = rng_start(trial). */
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
int tell_skipped(void); /* how many, before end_test_run; prints a line for each */

#endif
