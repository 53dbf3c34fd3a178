/* The tests make each system call, and each kind of HDF5 call, of the store fail once: in a new run, and in one that is
 * resumed after a kill. The store must then either return HF_IO with a message or work around the failure. Acknowledged
 * generations must still be stored, and the same run must reach its end with the same bits. The linker redirects these
 * calls of our own objects to calls.c. System calls inside HDF5 cannot be made to fail here; limits on the file size
 * stand in for them (cli/resume, unit/store_faults). */
#include "calls.h"
#include "evolution.h"

#include "base/file_out.h"
#include "store/compare.h"

#include <errno.h>
#include <limits.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- calls that fail ---- */

/* must_tell: 1 when the store cannot work around a failure of this call and must report it. */
static const struct {
    const char *name;
    int must_tell;
} calls[] = {{"open", 1},     {"write", 1},         {"writev", 1},    {"pwrite", 1},  {"read", 1},
             {"pread", 1},    {"close", 0},         {"fsync", 1},     {"rename", 1},  {"link", 0},
             {"unlink", 0},   {"ftruncate", 1},     {"lseek", 1},     {"flock", 1},   {"fstat", 0},
             {"stat", 0},     {"access", 1},        {"H5Fcreate", 1}, {"H5Fopen", 1}, {"H5Dcreate2", 1},
             {"H5Dopen2", 1}, {"H5Dset_extent", 1}, {"H5Dwrite", 1},  {"H5Dread", 1}, {"H5Awrite", 1},
             {"H5Aread", 1}};

/* ---- a run of six generations ---- */

enum { N_BEFORE_KILL = 4 };

/* Begins a new run, or resumes the unfinished one that is there, and takes it to its end. */
static hf_status run_it(const char *path, struct run *r, int *acknowledged, hf_messages *messages)
{
    hf_store *s = NULL;
    hf_store_state state;
    hf_status status = hf_store_look(path, any_case(), &r->net.scene, NULL, &state, messages);
    if (status != HF_OK || state == HF_STORE_FINISHED) return status;
    if (state == HF_STORE_UNFINISHED)
        status = hf_store_resume(path, &s, messages);
    else
        status = begin_new(path, r, &s, messages);
    int first = status == HF_OK ? hf_store_generations(s) : 0;
    if (status == HF_OK && first > 0) {
        hf_summary summary = {0};
        status = hf_store_restore(s, &r->ga, &summary, messages);
        if (status == HF_OK) {
            ck_assert_int_eq(hf_store_generations(s), first); /* every stored generation is restored */
            hf_optimiser_tell(&r->ga);
        }
    }
    if (status == HF_OK) status = store_some(s, r, first, N_GENERATION, acknowledged, messages);
    if (status == HF_OK) return hf_store_finish(s, &(hf_summary){.stage[HF_STAGE_SEARCH].exists = 1}, messages);
    hf_store_end(s);
    return status;
}

static void tell(void *context, const char *path, const char *how)
{
    (void)context;
    printf("%s%s\n", path, how);
}

static void demand_whole(const char *path, const char *whole)
{
    hf_comparison c = {0};
    hf_messages messages = {0};
    ck_assert_int_eq(hf_compare_files(path, whole, &c, tell, NULL, &messages), HF_OK);
    ck_assert_int_gt(c.n_data_set, 20);
}

/* A run that was killed after N_BEFORE_KILL generations. Returns its folder. */
static const char *leave_killed_run(const char **path)
{
    const char *folder = new_folder(path);
    pid_t child = fork();
    if (child == 0) {
        struct run r;
        hf_messages messages = {0};
        hf_store *s;
        int n;
        open_run(&r);
        if (begin_new(*path, &r, &s, &messages) == HF_OK) store_some(s, &r, 0, N_BEFORE_KILL, &n, &messages);
        _exit(9);
    }
    int state;
    ck_assert_int_eq(waitpid(child, &state, 0), child);
    ck_assert_int_eq(WEXITSTATUS(state), 9);
    return folder;
}

static void copy_files(const char *from, const char *to)
{
    char file[2][PATH_MAX];
    DIR *directory = opendir(from);
    ck_assert_ptr_nonnull(directory);
    for (const struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
        size_t size;
        if (entry->d_name[0] == '.') continue;
        snprintf(file[0], PATH_MAX, "%s/%s", from, entry->d_name);
        snprintf(file[1], PATH_MAX, "%s/%s", to, entry->d_name);
        char *bytes = read_file(file[0], &size);
        FILE *copy = fopen(file[1], "wb");
        ck_assert_ptr_nonnull(copy);
        ck_assert_uint_eq(fwrite(bytes, 1, size, copy), size);
        ck_assert_int_eq(fclose(copy), 0);
        free(bytes);
    }
    closedir(directory);
}

/* Makes the n-th call of this name fail in a new run or, if `killed` is a folder, in one that resumes the killed run
 * there; returns 1 when the run made that many. */
static int fail_once(int call, long n, const char *killed, const char *whole)
{
    struct run r;
    hf_messages messages = {0};
    int acknowledged = 0, again = 0;
    const char *path, *folder = new_folder(&path);
    if (killed) {
        copy_files(killed, folder);
        acknowledged = N_BEFORE_KILL;
    }
    open_run(&r);
    fail_call_at(calls[call].name, n, EIO, false);
    hf_status status = run_it(path, &r, &acknowledged, &messages);
    bool was_reached = end_call_failure();
    const char *said = messages.text ? messages.text : "";
    /* HF_EXISTS: a file that cannot be read is not recognised as a result file of ours */
    ck_assert_msg(status == HF_OK || status == HF_IO || status == HF_EXISTS, "%s %ld: status %d %s", calls[call].name,
                  n, status, said);
    ck_assert_msg((status != HF_OK) == (messages.n_error > 0), "%s %ld: status %d, said: %s", calls[call].name, n,
                  status, said);
    ck_assert_msg(was_reached || status == HF_OK, "%s", said);
    ck_assert_msg(!was_reached || !calls[call].must_tell || status != HF_OK, "call %ld of %s: nothing was said", n,
                  calls[call].name);
    hf_messages_free(&messages);
    close_run(&r);

    open_run(&r);
    hf_store_state state; /* it is finished when the call that failed came after the last rename */
    ck_assert_int_eq(hf_store_look(path, any_case(), &r.net.scene, NULL, &state, &messages), HF_OK);
    ck_assert(acknowledged == 0 || state != HF_STORE_NOTHING);
    if (state == HF_STORE_UNFINISHED) {
        hf_store *s;
        ck_assert_msg(hf_store_resume(path, &s, &messages) == HF_OK, "%s %ld, then: %s", calls[call].name, n,
                      messages.text);
        ck_assert_int_ge(hf_store_generations(s), acknowledged);
        hf_store_end(s);
    }
    ck_assert_msg(run_it(path, &r, &again, &messages) == HF_OK, "%s %ld, then: %s", calls[call].name, n, messages.text);
    hf_messages_free(&messages);
    demand_whole(path, whole);
    int leaves_more = !strcmp(calls[call].name, "rename") || !strcmp(calls[call].name, "stat"); /* the file is kept */
    if (!leaves_more) ck_assert_int_eq(count_files(folder), 1);
    close_run(&r);
    return was_reached;
}

/* The result of a run that nothing disturbed: its path, which the caller frees. */
static char *make_whole(void)
{
    struct run r;
    hf_messages messages = {0};
    int n = 0;
    const char *path;
    new_folder(&path);
    char *whole = strdup(path);
    ck_assert_ptr_nonnull(whole);
    open_run(&r);
    ck_assert_int_eq(run_it(whole, &r, &n, &messages), HF_OK);
    close_run(&r);
    return whole;
}

/* Returns the number after n. Of a hundred attributes that are written alike, every eleventh is enough, unless
 * HIFDM_STRESS is set. */
static int next_call(int n)
{
    enum { N_FIRST = 20, STRIDE = 11 };
    return n + (n < N_FIRST || getenv("HIFDM_STRESS") ? 1 : STRIDE);
}

/* All HDF5 ids that the store opened must be closed. Ids that a failed call leaves open inside HDF5 do not count. */
static void check_call(int call, bool was_killed)
{
    const char *path;
    char *whole = make_whole(), *killed = was_killed ? strdup(leave_killed_run(&path)) : NULL;
    for (int n = 1; fail_once(call, n, killed, whole); n = next_call(n))
        no_id_is_open();
    free(killed);
    free(whole);
}

START_TEST(a_new_run_survives_each_failing_call)
{
    check_call(_i, false);
}
END_TEST

START_TEST(a_resumed_run_survives_each_failing_call)
{
    check_call(_i, true);
}
END_TEST

/* A run that ends before its n-th change of a file, in a process of its own. False when it makes fewer. */
static bool die_at(const char *path, long n)
{
    pid_t child = fork();
    if (child == 0) {
        struct run r;
        hf_messages messages = {0};
        int acknowledged = 0;
        open_run(&r);
        die_before_change(n);
        hf_status status = run_it(path, &r, &acknowledged, &messages);
        _exit(status == HF_OK ? 0 : 1);
    }
    int state;
    ck_assert_int_eq(waitpid(child, &state, 0), child);
    ck_assert(WEXITSTATUS(state) == 9 || WEXITSTATUS(state) == 0);
    return WEXITSTATUS(state) == 9;
}

/* The table in store/store_file.h, one instant after the other, and each of the first ones once more in the run that
 * goes on: the next run comes to the same result, and nothing else is left. */
START_TEST(a_run_killed_before_each_change_leaves_nothing)
{
    struct run r;
    hf_messages messages = {0};
    int n = 0;
    long n_death = 0;
    char *whole = make_whole();
    for (bool dying = true; dying; n_death++) {
        const char *path, *folder = new_folder(&path);
        dying = die_at(path, n_death + 1);
        die_at(path, n_death / 2 + 1);
        open_run(&r);
        ck_assert_msg(run_it(path, &r, &n, &messages) == HF_OK, "%ld: %s", n_death, messages.text);
        close_run(&r);
        demand_whole(path, whole);
        ck_assert_msg(count_files(folder) == 1, "%d files after death %ld", count_files(folder), n_death + 1);
        hf_messages_free(&messages);
    }
    ck_assert_int_gt(n_death, 40);
    free(whole);
}
END_TEST

/* Calls that are interrupted, and transfers that end early, change nothing. */
START_TEST(a_run_whose_calls_are_disturbed)
{
    struct run r;
    hf_messages messages = {0};
    int n = 0;
    const char *path = NULL;
    char *whole = make_whole();
    if (_i)
        leave_killed_run(&path);
    else
        new_folder(&path);
    open_run(&r);
    disturb_calls(true);
    hf_status status = run_it(path, &r, &n, &messages);
    disturb_calls(false);
    ck_assert_msg(status == HF_OK && messages.n_error == 0, "%s", messages.text ? messages.text : "");
    close_run(&r);
    demand_whole(path, whole);
    hf_messages_free(&messages);
    free(whole);
}
END_TEST

/* The file goes to the disk before it gets its name, and its name after: both must be heard. */
START_TEST(a_finished_result_is_on_the_disk)
{
    struct run r;
    hf_messages messages = {0};
    hf_store *s;
    int n;
    const char *path;
    new_folder(&path);
    open_run(&r);
    ck_assert_int_eq(begin_new(path, &r, &s, &messages), HF_OK);
    ck_assert_int_eq(store_some(s, &r, 0, N_GENERATION, &n, &messages), HF_OK);
    fail_call_at("fsync", 1 + _i, EIO, false);
    ck_assert_int_eq(hf_store_finish(s, &(hf_summary){.stage[HF_STAGE_SEARCH].exists = 1}, &messages), HF_IO);
    ck_assert(end_call_failure());
    close_run(&r);
    hf_messages_free(&messages);
}
END_TEST

/* ---- files of exporters ---- */

static void put_text(const void *context, FILE *file)
{
    fputs(context, file);
}

/* Makes each call fail by which a new file gets its name, fsync included: the old file must stay, alone. */
START_TEST(an_exported_file_survives_each_failing_call)
{
    static const char *const name[] = {"open", "fstat", "fsync", "rename"};
    hf_messages messages = {0};
    const char *path, *folder = new_folder(&path);
    write_file(path, "old");
    fail_call_at(name[_i], 1, EIO, false);
    hf_status status = hf_file_out_write(path, put_text, "new", &messages);
    ck_assert(end_call_failure());
    ck_assert_int_eq(status, HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, "cannot write"));
    hf_messages_free(&messages);
    char *text = read_file(path, NULL);
    ck_assert_str_eq(text, "old");
    free(text);
    ck_assert_int_eq(count_files(folder), 1);
}
END_TEST

Suite *suite_fault_store_calls(void)
{
    Suite *suite = suite_create("fault/store_calls");
    TCase *tests = tcase_create("store_calls");
    suite_add_tcase(suite, tests);
    tcase_add_checked_fixture(tests, quiet, NULL);
    tcase_add_loop_test(tests, a_new_run_survives_each_failing_call, 0, N(calls));
    tcase_add_loop_test(tests, a_resumed_run_survives_each_failing_call, 0, N(calls));
    tcase_add_test(tests, a_run_killed_before_each_change_leaves_nothing);
    tcase_add_loop_test(tests, a_run_whose_calls_are_disturbed, 0, 2);
    tcase_add_loop_test(tests, a_finished_result_is_on_the_disk, 0, 2);
    tcase_add_loop_test(tests, an_exported_file_survives_each_failing_call, 0, 4);
    return suite;
}
