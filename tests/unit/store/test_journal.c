/* The journal of a run, by itself: damage, and the lock that it is. */
#include "calls.h"
#include "support.h"

#include "base/path.h"
#include "store/journal.h"
#include "store/samples.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *result_path(void)
{
    static char path[4096];
    snprintf(path, sizeof path, "%s", temp_path("run.h5"));
    return path;
}

static void append(hf_journal *j, int generation, char letter, hf_messages *m)
{
    char payload[1000];
    memset(payload, letter, sizeof payload);
    const struct iovec piece[] = {{payload, 400}, {payload + 400, 600}};
    ck_assert_int_eq(hf_journal_append(j, generation, piece, 2, m), HF_OK);
}

static void open_new(hf_journal *j, hf_messages *m)
{
    ck_assert_int_eq(hf_journal_open(result_path(), false, j, m), HF_OK);
    ck_assert_int_eq(hf_journal_restart(j, "this run", m), HF_OK);
}

static hf_status count(void *context, int generation, const void *payload, size_t bytes)
{
    int *n = context;
    ck_assert_int_eq(generation, *n);
    ck_assert_uint_eq(bytes, 1000);
    for (size_t i = 0; i < bytes; i++)
        ck_assert_int_eq(((const char *)payload)[i], (char)('a' + generation));
    ++*n;
    return HF_OK;
}

/* One bit of head or payload is another: the record and those after it count for nothing, and that is told. */
START_TEST(a_spoilt_record_is_told)
{
    static const off_t at[] = {4, 6, 8, 12, 16, 500, 1015}; /* length, CRC, generation, payload */
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        hf_journal j;
        hf_messages m = {0};
        int n = 0;
        char byte;
        open_new(&j, &m);
        off_t second = (off_t)j.size + 1016;
        for (int g = 0; g < 3; g++)
            append(&j, g, (char)('a' + g), &m);
        ck_assert_int_eq(j.size, second + 2 * 1016);
        ck_assert_int_eq(pread(j.file, &byte, 1, second + at[k]), 1);
        byte ^= 1;
        ck_assert_int_eq(pwrite(j.file, &byte, 1, second + at[k]), 1);
        ck_assert_int_eq(hf_journal_replay(&j, "this run", count, &n, &m), HF_OK);
        ck_assert_int_eq(n, 1);
        ck_assert_int_eq(m.n_warning, 1);
        ck_assert_ptr_nonnull(strstr(m.text, "is damaged, so hifdm ignores its last 2032 bytes"));
        hf_journal_close(&j, true);
        hf_messages_free(&m);
    }
}
END_TEST

static void demand_locked(void)
{
    hf_journal other;
    hf_messages m = {0};
    ck_assert_int_ne(hf_journal_open(result_path(), true, &other, &m), HF_OK);
    ck_assert_ptr_nonnull(strstr(m.text, "another process is writing this result"));
    hf_journal_close(&other, false);
    hf_messages_free(&m);
}

START_TEST(the_lock_is_kept_while_the_journal_is_rotated)
{
    hf_journal j;
    hf_messages m = {0};
    int n = 0;
    open_new(&j, &m);
    demand_locked();
    for (int i = 0; i < 2; i++) {
        append(&j, 0, 'a', &m);
        ck_assert_int_eq(hf_journal_rotate(&j, &m), HF_OK);
        ck_assert(hf_journal_is_empty(&j));
        demand_locked();
    }
    append(&j, 0, 'a', &m);
    hf_journal_close(&j, false);
    ck_assert_int_eq(hf_journal_open(result_path(), false, &j, &m), HF_OK); /* the lock went with it */
    ck_assert_int_eq(hf_journal_replay(&j, "this run", count, &n, &m), HF_OK);
    ck_assert_int_eq(n, 1);
    hf_journal_close(&j, true);
    ck_assert_int_ne(access(temp_path("run.h5.journal"), F_OK), 0);
    hf_messages_free(&m);
}
END_TEST

/* The lock of a file that has lost its name to another one is not the lock of the result. */
static void move_another_there(void)
{
    write_file(temp_path("another"), "");
    ck_assert_int_eq(rename(temp_path("another"), temp_path("run.h5.journal")), 0);
}

START_TEST(a_name_that_moves_before_the_lock_is_opened_again)
{
    hf_journal j;
    hf_messages m = {0};
    before_call("flock", move_another_there);
    ck_assert_int_eq(hf_journal_open(result_path(), false, &j, &m), HF_OK);
    ck_assert(hf_path_leads_to(j.path, j.file));
    demand_locked();
    hf_journal_close(&j, true);
    hf_messages_free(&m);
}
END_TEST

/* A restart removes a file or a link that is no journal. A folder stays, and the message says why. */
START_TEST(what_is_no_journal_is_replaced_or_told)
{
    hf_journal j;
    hf_messages m = {0};
    char expected[3 * 4096];
    write_file(temp_path("run.h5.journal"), "notes of mine");
    ck_assert_int_eq(hf_journal_open(result_path(), false, &j, &m), HF_EXISTS);
    hf_journal_close(&j, false);
    ck_assert_int_eq(hf_journal_open(result_path(), true, &j, &m), HF_OK);
    ck_assert_ptr_nonnull(strstr(m.text, "run.h5.journal was not a journal of hifdm, so hifdm replaced this file\n"));
    hf_journal_close(&j, true);
    hf_messages_free(&m);
    ck_assert_int_eq(mkdir(temp_path("run.h5.journal"), 0700), 0);
    ck_assert_int_eq(hf_journal_open(result_path(), true, &j, &m), HF_IO);
    snprintf(expected, sizeof expected, "error: %s: cannot remove %s.journal: Is a directory\n", result_path(),
             result_path());
    ck_assert_str_eq(m.text, expected);
    hf_journal_close(&j, false);
    hf_messages_free(&m);
}
END_TEST

/* Every HF_JOURNAL_SYNC_S, if there is news; that the disk refuses is an error. */
START_TEST(what_is_appended_goes_to_the_disk)
{
    hf_journal j;
    hf_messages m = {0};
    open_new(&j, &m);
    ck_assert_int_eq(hf_journal_tend(&j, 100, &m), HF_OK); /* starts the clock */
    append(&j, 0, 'a', &m);
    fail_call_at("fdatasync", 1, EIO, false);
    ck_assert_int_eq(hf_journal_tend(&j, 100 + 0.9 * HF_JOURNAL_SYNC_S, &m), HF_OK);
    ck_assert_int_eq(hf_journal_tend(&j, 100 + 1.1 * HF_JOURNAL_SYNC_S, &m), HF_IO);
    ck_assert(end_call_failure());
    append(&j, 1, 'b', &m);
    ck_assert_int_eq(hf_journal_tend(&j, 100 + 2.2 * HF_JOURNAL_SYNC_S, &m), HF_OK);
    fail_call_at("fdatasync", 1, EIO, false);
    ck_assert_int_eq(hf_journal_tend(&j, 100 + 3.3 * HF_JOURNAL_SYNC_S, &m), HF_OK); /* no news */
    ck_assert(!end_call_failure());
    hf_journal_close(&j, true);
    hf_messages_free(&m);
}
END_TEST

/* Nothing has gone wrong with the machine when the scratch file is too short, and errno says nothing. */
START_TEST(samples_that_are_gone_are_told)
{
    hf_messages m = {0};
    hf_samples s;
    static double row[4 * HF_TOLERANCE_COLUMNS];
    volatile sig_atomic_t stop = 0;
    ck_assert_int_eq(hf_samples_open(NULL, result_path(), -1, 0, "", false, 4, 4, HF_TOLERANCE_COLUMNS, &s, &m), HF_OK);
    s.stop = &stop;
    ck_assert_int_eq(hf_samples_add(&s, 0, row), HF_OK);
    ck_assert_int_eq(hf_samples_read(&s, 0, 4, row), HF_OK);
    stop = 1;
    ck_assert_int_eq(hf_samples_read(&s, 0, 4, row), HF_INTERRUPTED);
    stop = 0;
    ck_assert_ptr_null(m.text);
    ck_assert_int_eq(ftruncate(s.rows, 8), 0);
    errno = ENOSPC;
    ck_assert_int_eq(hf_samples_read(&s, 0, 4, row), HF_IO);
    ck_assert_str_eq(m.text, "error: samples.tolerance: cannot read the scratch file of samples: it ends too early\n");
    hf_samples_close(&s);
    hf_messages_free(&m);
}
END_TEST

/* Records that wait are written together and in their order: on demand, when there is no room for one more, before one
 * that never fits, and at the end. */
START_TEST(records_wait_together)
{
    hf_journal j;
    hf_messages m = {0};
    static char large[HF_JOURNAL_HELD];
    int n = 0, fit = HF_JOURNAL_HELD / 1016;
    open_new(&j, &m);
    int64_t empty = j.size;
    append(&j, 0, 'a', &m);
    ck_assert_int_eq(j.size, empty + 1016); /* none waits yet */
    j.hold_s = 1e9;
    for (int g = 1; g < 4; g++)
        append(&j, g, (char)('a' + g), &m);
    ck_assert_int_eq(j.size, empty + 1016);
    ck_assert_int_eq(hf_journal_write(&j, &m), HF_OK);
    ck_assert_int_eq(j.size, empty + 4 * 1016);
    for (int g = 4; g < 4 + fit; g++)
        append(&j, g, (char)('a' + g), &m);
    ck_assert_int_eq(j.size, empty + 4 * 1016);
    append(&j, 4 + fit, (char)('a' + 4 + fit), &m);
    ck_assert_int_eq(j.size, empty + (4 + fit) * 1016);
    hf_journal_close(&j, false);
    ck_assert_int_eq(hf_journal_open(result_path(), false, &j, &m), HF_OK);
    ck_assert_int_eq(hf_journal_replay(&j, "this run", count, &n, &m), HF_OK);
    ck_assert_int_eq(n, 5 + fit);
    j.hold_s = 1e9;
    append(&j, n, (char)('a' + n), &m);
    int64_t before = j.size;
    const struct iovec piece = {large, sizeof large};
    ck_assert_int_eq(hf_journal_append(&j, 7, &piece, 1, &m), HF_OK);
    ck_assert_int_eq(j.size, before + 1016 + 16 + (int64_t)sizeof large);
    ck_assert(!hf_journal_is_empty(&j));
    ck_assert_int_eq(hf_journal_rotate(&j, &m), HF_OK);
    append(&j, 0, 'a', &m);
    ck_assert(!hf_journal_is_empty(&j) && j.size == empty);
    ck_assert_int_eq(hf_journal_rotate(&j, &m), HF_OK);
    ck_assert(hf_journal_is_empty(&j) && hf_journal_write(&j, &m) == HF_OK && j.size == empty);
    ck_assert_int_eq(m.n_warning, 0);
    hf_journal_close(&j, true);
}
END_TEST

Suite *suite_unit_journal(void)
{
    Suite *suite = suite_create("unit/journal");
    TCase *tests = tcase_create("journal");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, a_spoilt_record_is_told);
    tcase_add_test(tests, the_lock_is_kept_while_the_journal_is_rotated);
    tcase_add_test(tests, a_name_that_moves_before_the_lock_is_opened_again);
    tcase_add_test(tests, what_is_no_journal_is_replaced_or_told);
    tcase_add_test(tests, what_is_appended_goes_to_the_disk);
    tcase_add_test(tests, records_wait_together);
    tcase_add_test(tests, samples_that_are_gone_are_told);
    return suite;
}
