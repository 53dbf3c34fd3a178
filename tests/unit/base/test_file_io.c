/* Transfers to the last byte, locks, whose fault an error is, and what is no ordinary file. */
#include "calls.h"
#include "support.h"

#include "base/file_io.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

enum { N = 1000 };

static char bytes[N];

static int new_file(void)
{
    int file = hf_file_io_open(temp_path("bytes"), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC);
    ck_assert_int_ge(file, 0);
    for (int i = 0; i < N; i++)
        bytes[i] = (char)(i * 7);
    return file;
}

static void demand_bytes(int file)
{
    char back[N + 10];
    ck_assert_int_eq(lseek(file, 0, SEEK_SET), 0);
    ck_assert_int_eq(hf_file_io_read(file, back, sizeof back), N);
    ck_assert(!memcmp(back, bytes, N));
    memset(back, 0, sizeof back);
    ck_assert_int_eq(hf_file_io_read_at(file, back, sizeof back, 300), N - 300);
    ck_assert(!memcmp(back, bytes + 300, N - 300));
}

START_TEST(transfers_that_are_interrupted_or_end_early)
{
    char *empty = bytes + 10;
    for (int how = 0; how < 3; how++) {
        struct iovec piece[] = {{bytes, 1}, {empty, 0}, {bytes + 1, 2}, {bytes + 3, N - 3}, {empty, 0}};
        disturb_calls(true);
        int file = new_file(), failed = 1;
        if (how == 0) failed = hf_file_io_write(file, bytes, N);
        if (how == 1) failed = hf_file_io_write_at(file, bytes, N, 0);
        if (how == 2) failed = hf_file_io_write_pieces(file, piece, 5);
        ck_assert_int_eq(failed, 0);
        ck_assert_int_eq(hf_file_io_sync(file, false), 0);
        ck_assert_int_eq(hf_file_io_sync(file, true), 0);
        demand_bytes(file);
        ck_assert_int_eq(hf_file_io_cut(file, 0), 0);
        ck_assert_int_eq(hf_file_io_read(file, bytes, 1), 0);
        ck_assert_int_eq(hf_file_io_close(file), 0);
        disturb_calls(false);
    }
}
END_TEST

START_TEST(what_fails_says_why)
{
    static const char *const name[] = {"write", "pwrite", "writev", "read", "pread", "fsync", "fdatasync", "ftruncate"};
    int file = new_file(), result = 0;
    struct iovec piece = {bytes, N};
    fail_call_at(name[_i], 1, EDQUOT, false);
    if (_i == 0) result = hf_file_io_write(file, bytes, N);
    if (_i == 1) result = hf_file_io_write_at(file, bytes, N, 0);
    if (_i == 2) result = hf_file_io_write_pieces(file, &piece, 1);
    if (_i == 3) result = (int)hf_file_io_read(file, bytes, N);
    if (_i == 4) result = (int)hf_file_io_read_at(file, bytes, N, 0);
    if (_i == 5) result = hf_file_io_sync(file, false);
    if (_i == 6) result = hf_file_io_sync(file, true);
    if (_i == 7) result = hf_file_io_cut(file, 0);
    int why = errno;
    ck_assert(end_call_failure());
    ck_assert_int_eq(result, -1);
    ck_assert_int_eq(why, EDQUOT);
    fail_call_at("close", 1, EIO, false);
    ck_assert_int_eq(hf_file_io_close(file), -1);
    ck_assert(end_call_failure());
}
END_TEST

/* Some file systems have nothing to sync. */
START_TEST(a_sync_that_there_is_not)
{
    static const int why[] = {EINVAL, ENOSYS, EOPNOTSUPP};
    int file = new_file();
    for (int i = 0; i < 3; i++) {
        fail_call_at("fsync", 1, why[i], false);
        ck_assert_int_eq(hf_file_io_sync(file, false), 0);
        ck_assert(end_call_failure());
    }
    hf_file_io_close(file);
}
END_TEST

START_TEST(locks)
{
    static const struct {
        int why;
        hf_lock lock;
    } refusal[] = {{EWOULDBLOCK, HF_LOCK_TAKEN}, {EACCES, HF_LOCK_TAKEN}, {ENOSYS, HF_LOCK_NONE},
                   {EOPNOTSUPP, HF_LOCK_NONE},   {EINVAL, HF_LOCK_NONE},  {ENOLCK, HF_LOCK_FAILED},
                   {EIO, HF_LOCK_FAILED}};
    int file = new_file(), other = hf_file_io_open(temp_path("bytes"), O_RDWR | O_CLOEXEC);
    for (size_t i = 0; i < sizeof refusal / sizeof *refusal; i++) {
        fail_call_at("flock", 1, refusal[i].why, false);
        fail_call_at("fcntl", 1, refusal[i].why, false);
        hf_lock whole = hf_file_io_lock(file), byte = hf_file_io_lock_byte(file, 7);
        ck_assert(end_call_failure());
        ck_assert_int_eq(whole, refusal[i].lock);
        ck_assert_int_eq(byte, refusal[i].lock);
    }
    disturb_calls(true);
    ck_assert_int_eq(hf_file_io_lock(file), HF_LOCK_OURS);
    ck_assert_int_eq(hf_file_io_lock(other), HF_LOCK_TAKEN);
    ck_assert_int_eq(hf_file_io_lock_byte(file, 7), HF_LOCK_OURS);
    disturb_calls(false);
    pid_t child = fork();
    if (child == 0)
        _exit(hf_file_io_lock_byte(other, 7) == HF_LOCK_TAKEN && hf_file_io_lock_byte(other, 8) == 0 ? 0 : 1);
    int state;
    ck_assert_int_eq(waitpid(child, &state, 0), child);
    ck_assert_int_eq(state, 0);
    hf_file_io_unlock_byte(file, 7);
    child = fork();
    if (child == 0) _exit(hf_file_io_lock_byte(other, 7) == HF_LOCK_OURS ? 0 : 1);
    ck_assert_int_eq(waitpid(child, &state, 0), child);
    ck_assert_int_eq(state, 0);
    close(file);
    close(other);
}
END_TEST

/* ---- texts ---- */

/* A text that is not there is the fault of who named it; one that the machine cannot read now is not. */
START_TEST(whose_fault_it_is_that_a_text_cannot_be_read)
{
    static const struct {
        int why;
        hf_status status;
    } fault[] = {{ENOENT, HF_BAD_CASE}, {EACCES, HF_BAD_CASE},  {EISDIR, HF_BAD_CASE}, {ELOOP, HF_BAD_CASE},
                 {EMFILE, HF_IO},       {ENFILE, HF_IO},        {EIO, HF_IO},          {ESTALE, HF_IO},
                 {ENOLCK, HF_IO},       {ENOMEM, HF_NO_MEMORY}, {ETIMEDOUT, HF_IO}};
    const char *path = temp_path("text");
    write_file(path, "some words");
    for (size_t i = 0; i < sizeof fault / sizeof *fault; i++)
        for (int k = 0; k < 2; k++) {
            hf_messages messages = {0};
            char *text;
            size_t length;
            fail_call_at(k ? "read" : "open", 1, fault[i].why, false);
            hf_status status = hf_text_read_file(path, HF_BAD_CASE, &text, &length, &messages);
            ck_assert(end_call_failure());
            ck_assert_int_eq(status, fault[i].status);
            ck_assert_ptr_null(text);
            ck_assert_ptr_nonnull(strstr(messages.text, strerror(fault[i].why)));
            hf_messages_free(&messages);
        }
}
END_TEST

static void *read_text(const char *path, hf_status expected, const char *words)
{
    hf_messages messages = {0};
    char *text;
    size_t length;
    ck_assert_int_eq(hf_text_read_file(path, HF_BAD_CASE, &text, &length, &messages), expected);
    if (words) ck_assert_ptr_nonnull(strstr(messages.text, words));
    hf_messages_free(&messages);
    return text;
}

/* Nobody writes to the pipe, and /dev/zero has no end: neither is read. */
START_TEST(what_is_no_ordinary_file_is_named_and_not_read)
{
    static const struct {
        const char *name, *words;
    } other[] = {{"pipe", "pipe: this is a pipe. Give the name of a regular file"},
                 {"folder", "folder: this is a folder. Give"},
                 {"socket", "socket: this is a socket. Give"},
                 {"zero", "zero: this is a device. Give"},
                 {"long", "long: this file is larger than 1024 MB"}};
    struct sockaddr_un address = {.sun_family = AF_UNIX, .sun_path = "socket"}; /* a name of at most 107 bytes */
    ck_assert_int_eq(chdir(temp_path("")), 0);
    ck_assert_int_eq(mkfifo("pipe", 0600), 0);
    ck_assert_int_eq(mkdir("folder", 0700), 0);
    ck_assert_int_eq(bind(socket(AF_UNIX, SOCK_STREAM, 0), (const struct sockaddr *)&address, sizeof address), 0);
    ck_assert_int_eq(symlink("/dev/zero", "zero"), 0);
    write_file("long", "");
    ck_assert_int_eq(truncate("long", (off_t)(1 << 30) + 1), 0);
    for (size_t i = 0; i < sizeof other / sizeof *other; i++) {
        fail_call_at("read", 1, EIO, false);
        ck_assert_ptr_null(read_text(other[i].name, HF_BAD_CASE, other[i].words));
        ck_assert(!end_call_failure()); /* it was not even tried */
    }
}
END_TEST

/* Those of /proc have a size of 0. */
START_TEST(a_file_may_be_longer_than_its_size)
{
    char *text = read_text("/proc/self/status", HF_OK, NULL);
    ck_assert_ptr_nonnull(strstr(text, "VmRSS"));
    free(text);
}
END_TEST

Suite *suite_unit_file_io(void)
{
    Suite *suite = suite_create("unit/file_io");
    TCase *tests = tcase_create("file_io");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, transfers_that_are_interrupted_or_end_early);
    tcase_add_loop_test(tests, what_fails_says_why, 0, 8);
    tcase_add_test(tests, a_sync_that_there_is_not);
    tcase_add_test(tests, locks);
    tcase_add_test(tests, whose_fault_it_is_that_a_text_cannot_be_read);
    tcase_add_test(tests, what_is_no_ordinary_file_is_named_and_not_read);
    tcase_add_test(tests, a_file_may_be_longer_than_its_size);
    return suite;
}
