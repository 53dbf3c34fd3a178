/* Files that appear whole or not at all. Calls of the system that fail: tests/fault/test_store_calls.c. */
#include "calls.h"
#include "support.h"

#include "base/file_io.h"
#include "base/file_out.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void put_text(const void *context, FILE *file)
{
    fputs(context, file);
}

START_TEST(a_file_appears_whole_and_replaces)
{
    hf_messages messages = {0};
    const char *path = temp_path("out.csv");
    for (int i = 0; i < 2; i++) {
        ck_assert_int_eq(hf_file_out_write(path, put_text, i ? "second\n" : "first\n", &messages), HF_OK);
        char *text = read_file(path, NULL);
        ck_assert_str_eq(text, i ? "second\n" : "first\n");
        free(text);
    }
    ck_assert_ptr_null(messages.text);
}
END_TEST

static int count_in(const char *folder)
{
    struct dirent **entry;
    int n = scandir(folder, &entry, NULL, NULL);
    ck_assert_int_ge(n, 2);
    for (int i = 0; i < n; i++)
        free(entry[i]);
    free(entry);
    return n - 2; /* . and .. */
}

/* An empty folder of the test's own; *path is a name in it. */
static const char *own_folder(const char *name, const char *file, char path[4096])
{
    const char *folder = temp_path(name);
    ck_assert_int_eq(mkdir(folder, 0777), 0);
    snprintf(path, 4096, "%s/%s", folder, file);
    return folder;
}

static void demand_text(const char *path, const char *wanted)
{
    char *text = read_file(path, NULL);
    ck_assert_str_eq(text, wanted);
    free(text);
}

START_TEST(what_cannot_get_its_name_leaves_nothing)
{
    hf_messages messages = {0};
    char path[4096];
    const char *folder = own_folder("a", "folder", path);
    ck_assert_int_eq(mkdir(path, 0777), 0);
    ck_assert_int_eq(hf_file_out_write(path, put_text, "x", &messages), HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, "cannot write"));
    ck_assert_int_eq(messages.n_error, 1);
    ck_assert_int_eq(count_in(folder), 1);
    hf_messages_free(&messages);
}
END_TEST

/* Another name each time, hidden, in the folder of the output. */
START_TEST(temporary_names_cannot_be_guessed)
{
    hf_messages messages = {0};
    hf_file_out a, b;
    char path[4096], begin[4200];
    const char *folder = own_folder("b", "out.csv", path);
    ck_assert_int_eq(hf_file_out_begin(path, &a, &messages), HF_OK);
    ck_assert_int_eq(hf_file_out_begin(path, &b, &messages), HF_OK);
    ck_assert_str_ne(a.temporary, b.temporary);
    int n = snprintf(begin, sizeof begin, "%s/.out.csv.hifdm-", folder);
    ck_assert_int_eq(strncmp(a.temporary, begin, (size_t)n), 0);
    ck_assert_str_eq(a.temporary + n + 32, ".tmp");
    ck_assert_int_eq(count_in(folder), 2); /* the second has not taken the first for a leftover */
    hf_file_out_drop(&a, NULL);
    ck_assert_int_eq(hf_file_out_publish(&b, &messages), HF_OK);
    ck_assert_int_eq(count_in(folder), 1);
    ck_assert_ptr_null(messages.text);
}
END_TEST

/* What a killed process left goes, what a living one is writing and what belongs to the user stays. */
START_TEST(leftovers_are_removed_and_nothing_else)
{
    static const char *const of_user[] = {"out.csv.tmp",
                                          "out.csv.123.tmp",
                                          "out.csv.journal.tmp",
                                          ".out.csv.tmp",
                                          ".out.csv.hifdm-.tmp",
                                          ".out.csv.hifdm-0123456789abcdef0123456789abcde.tmp",
                                          ".out.csv.hifdm-0123456789abcdef0123456789abcdefa.tmp",
                                          ".out.csv.hifdm-0123456789abcdef0123456789abcdeg.tmp",
                                          ".out.csv.hifdm-0123456789abcdef0123456789abcdef.tmp.h5",
                                          ".other.csv.hifdm-0123456789abcdef0123456789abcdef.tmp"};
    hf_messages messages = {0};
    hf_file_out alive;
    char path[4096], name[4400];
    const char *folder = own_folder("c", "out.csv", path);
    for (size_t i = 0; i < sizeof of_user / sizeof *of_user; i++) {
        snprintf(name, sizeof name, "%s/%s", folder, of_user[i]);
        write_file(name, "mine");
    }
    int n = count_in(folder);
    snprintf(name, sizeof name, "%s/.out.csv.hifdm-%s.tmp", folder, "0123456789abcdef0123456789abcdef");
    ck_assert_int_eq(symlink(path, name), 0); /* no file, so not of ours */
    pid_t child = fork();
    if (child == 0) {
        hf_file_out f;
        hf_file_out_begin(path, &f, &messages);
        _exit(9);
    }
    int state;
    ck_assert_int_eq(waitpid(child, &state, 0), child);
    ck_assert_int_eq(count_in(folder), n + 2);
    ck_assert_int_eq(hf_file_out_begin(path, &alive, &messages), HF_OK);
    ck_assert_int_eq(count_in(folder), n + 2);
    ck_assert_int_eq(hf_file_out_write(path, put_text, "x", &messages), HF_OK);
    ck_assert_int_eq(count_in(folder), n + 3);
    hf_file_out_drop(&alive, NULL);
    ck_assert_int_eq(count_in(folder), n + 2);
}
END_TEST

START_TEST(a_path_may_be_too_long)
{
    hf_messages messages = {0};
    hf_file_out f;
    char path[HF_FILE_OUT_SIZE + 1], name[256];
    for (size_t i = 0; i < sizeof path; i++)
        path[i] = i % 100 == 99 ? '/' : 'x';
    path[sizeof path - 1] = '\0';
    ck_assert_int_eq(hf_file_out_begin(path, &f, &messages), HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, "the path is too long"));
    hf_messages_free(&messages);
    path[sizeof path - 2] = '\0'; /* there is no room for a temporary name */
    ck_assert_int_eq(hf_file_out_begin(path, &f, &messages), HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, strerror(ENAMETOOLONG)));
    hf_messages_free(&messages);
    memset(name, 'y', 255); /* as long as a name may be */
    name[255] = '\0';
    ck_assert_int_eq(chdir(temp_path("")), 0);
    ck_assert_int_eq(hf_file_out_write(name, put_text, "x", &messages), HF_OK);
    demand_text(name, "x");
    ck_assert_ptr_null(messages.text);
}
END_TEST

/* Looked at before the work: a folder that is not there, a name that is too long. */
START_TEST(a_file_that_cannot_be_is_told_before)
{
    hf_messages messages = {0};
    char name[257];
    memset(name, 'x', 256); /* one more than file systems allow */
    name[256] = '\0';
    ck_assert_int_eq(hf_file_out_try(temp_path("no/such"), &messages), HF_IO);
    ck_assert_int_eq(hf_file_out_try(temp_path(name), &messages), HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, "File name too long"));
    hf_messages_free(&messages);
    ck_assert_int_eq(hf_file_out_try(temp_path("good"), &messages), HF_OK);
    ck_assert_int_eq(hf_file_out_try(temp_path("good"), &messages), HF_OK); /* the first one left nothing behind */
    ck_assert_int_eq(access(temp_path("good"), F_OK), -1);
    ck_assert_ptr_null(messages.text);
}
END_TEST

START_TEST(adding_never_replaces)
{
    hf_file_out f;
    char path[4096];
    const char *folder = own_folder("d", "out", path);
    write_file(path, "old");
    ck_assert_int_eq(hf_file_out_make(path, &f), 0);
    ck_assert_int_eq(write(f.file, "new", 3), 3);
    ck_assert_int_eq(hf_file_out_add(&f, path, NULL), -1);
    ck_assert_int_eq(errno, EEXIST);
    ck_assert_int_eq(unlink(path), 0);
    ck_assert_int_eq(hf_file_io_sync(f.file, false), 0);
    ck_assert_int_eq(hf_file_out_add(&f, path, NULL), 0);
    ck_assert_int_eq(count_in(folder), 1);
    demand_text(path, "new");
    ck_assert_int_eq(hf_file_out_sync_folder(path), 0);
    snprintf(f.path, sizeof f.path, "%s/no/such", folder);
    ck_assert_int_eq(hf_file_out_sync_folder(f.path), -1);
    ck_assert_int_eq(errno, ENOENT);
}
END_TEST

/* ---- links ---- */

/* The temporary name of a long name has its first 200 bytes, the mark and 32 digits, whatever its length is. */
START_TEST(temporary_names_of_long_names)
{
    static const int length[] = {1, 183, 184, 185, 199, 200, 201, 240};
    hf_messages messages = {0};
    for (size_t i = 0; i < sizeof length / sizeof *length; i++) {
        char name[256] = "", path[4096], want[300], folder[16];
        int kept = length[i] < 200 ? length[i] : 200;
        memset(name, 'n', (size_t)length[i]);
        snprintf(folder, sizeof folder, "long%d", length[i]);
        own_folder(folder, name, path);
        hf_file_out f;
        ck_assert_int_eq(hf_file_out_begin(path, &f, &messages), HF_OK);
        const char *temporary = strrchr(f.temporary, '/') + 1;
        snprintf(want, sizeof want, ".%.*s.hifdm-", kept, name);
        ck_assert_msg(!strncmp(temporary, want, strlen(want)), "%s does not begin with %s", temporary, want);
        ck_assert_uint_eq(strlen(temporary), strlen(want) + 32 + strlen(".tmp"));
        hf_file_out_drop(&f, NULL);
    }
}
END_TEST

/* The name of a temporary file may get another file while it is written: the open one is not left for that. */
/* A file system without links: whenever the process ends, the name leads to the whole file or to none. */
START_TEST(adding_without_links_is_whole_or_not)
{
    for (int n = 1; n < 8; n++) {
        char path[4096];
        snprintf(path, sizeof path, "%s.%d", temp_path("out"), n);
        pid_t child = fork();
        if (child == 0) {
            hf_file_out f;
            if (hf_file_out_make(path, &f) != 0 || write(f.file, "new", 3) != 3) _exit(1);
            fail_call_at("link", 1, EPERM, true);
            die_before_change(n);
            _exit(hf_file_out_add(&f, path, NULL) != 0);
        }
        int state;
        ck_assert_int_eq(waitpid(child, &state, 0), child);
        ck_assert(WIFEXITED(state) && WEXITSTATUS(state) != 1);
        if (access(path, F_OK) == 0) demand_text(path, "new");
        if (WEXITSTATUS(state) == 0) ck_assert_int_eq(access(path, F_OK), 0);
    }
}
END_TEST

START_TEST(a_library_opens_the_file_that_was_made)
{
    hf_file_out f;
    char path[4096], name[HF_FILE_OUT_NAME_SIZE], moved[4200];
    struct stat made, opened;
    const char *folder = own_folder("e", "out", path), *victim = temp_path("victim");
    write_file(victim, "mine");
    ck_assert_int_eq(hf_file_out_make(path, &f), 0);
    snprintf(moved, sizeof moved, "%s/moved", folder);
    ck_assert_int_eq(rename(f.temporary, moved), 0);
    ck_assert_int_eq(symlink(victim, f.temporary), 0);
    hf_file_out_name(&f, name);
    ck_assert_int_eq(stat(name, &opened), 0);
    ck_assert_int_eq(fstat(f.file, &made), 0);
    ck_assert(opened.st_ino == made.st_ino && opened.st_dev == made.st_dev);
    hf_file_out_drop(&f, NULL);
    demand_text(victim, "mine");
}
END_TEST

START_TEST(own_links_stand_for_what_they_lead_to)
{
    hf_messages messages = {0};
    char path[4096], target[HF_FILE_OUT_SIZE];
    const char *folder = own_folder("f", "link", path), *real = temp_path("real");
    ck_assert_int_eq(symlink("second", path), 0);
    snprintf(target, sizeof target, "%s/second", folder);
    ck_assert_int_eq(symlink(real, target), 0);
    for (int i = 0; i < 2; i++) { /* there is no file, then there is one */
        ck_assert_int_eq(hf_file_out_target(path, target, &messages), HF_OK);
        ck_assert_str_eq(target, real);
        ck_assert_int_eq(hf_file_out_write(path, put_text, i ? "two" : "one", &messages), HF_OK);
        demand_text(real, i ? "two" : "one");
        ck_assert_int_eq(count_in(folder), 2);
    }
    ck_assert_int_eq(symlink(temp_path("circle"), temp_path("circle")), 0);
    ck_assert_int_eq(hf_file_out_write(temp_path("circle"), put_text, "x", &messages), HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, strerror(ELOOP)));
    hf_messages_free(&messages);
}
END_TEST

/* The linker leads geteuid of the library here. */
static uid_t pretended_user;
uid_t __real_geteuid(void);
uid_t __wrap_geteuid(void);
uid_t __wrap_geteuid(void)
{
    return pretended_user ? pretended_user : __real_geteuid();
}

/* What user `who` makes of a link: root's are followed, those of others are not. */
START_TEST(links_of_others_are_refused)
{
    hf_messages messages = {0};
    struct stat info;
    const char *link = temp_path("their_link"), *victim = temp_path("their_victim");
    write_file(victim, "mine");
    ck_assert_int_eq(symlink(victim, link), 0);
    ck_assert_int_eq(lstat(link, &info), 0);
    if (info.st_uid == 0 && lchown(link, 4711, (gid_t)-1) != 0) ck_abort_msg("root cannot give a link away");
    pretended_user = 815;
    hf_status file = hf_file_out_write(link, put_text, "x", &messages);
    hf_status folder = hf_file_out_folder(link, &messages);
    pretended_user = 0;
    ck_assert_int_eq(file, HF_IO);
    ck_assert_int_eq(folder, HF_IO);
    ck_assert_int_eq(messages.n_error, 2);
    ck_assert_ptr_nonnull(strstr(messages.text, "their_link: this symbolic link belongs to another user"));
    hf_messages_free(&messages);
    demand_text(victim, "mine");
    ck_assert_int_eq(lstat(link, &info), 0);
    ck_assert(S_ISLNK(info.st_mode));
}
END_TEST

static void demand_refused(hf_status status, const char *name, hf_messages *messages)
{
    ck_assert_int_eq(status, HF_IO);
    ck_assert_ptr_nonnull(messages->text);
    ck_assert_msg(strstr(messages->text, name) != NULL, "%s is not in %s", name, messages->text);
    hf_messages_free(messages);
}

/* The link may be a folder on the way, or have something behind it that hides it. Further up it is refused only where
 * everybody may write. */
START_TEST(folders_behind_links_of_others_are_refused)
{
    static const char *const hidden[] = {"/", "/.", "//", "/./", "/.//."};
    hf_messages messages = {0};
    struct stat info;
    char link[4096], path[4200], target[HF_FILE_OUT_SIZE];
    const char *folder = own_folder("shared", "their", link), *victim = temp_path("victims");
    ck_assert_int_eq(chmod(folder, 01777), 0);
    ck_assert_int_eq(mkdir(victim, 0777), 0);
    ck_assert_int_eq(symlink(victim, link), 0);
    ck_assert_int_eq(lstat(link, &info), 0);
    if (info.st_uid == 0 && lchown(link, 4711, (gid_t)-1) != 0) ck_abort_msg("root cannot give a link away");
    for (size_t i = 0; i < sizeof hidden / sizeof *hidden; i++) {
        snprintf(path, sizeof path, "%s%s", link, hidden[i]);
        pretended_user = 815;
        hf_status status = hf_file_out_folder(path, &messages);
        pretended_user = 0;
        demand_refused(status, "shared/their: this symbolic link belongs to another user", &messages);
    }
    for (int is_shared = 1; is_shared >= 0; is_shared--) {
        ck_assert_int_eq(chmod(folder, is_shared ? 01777 : 0755), 0);
        snprintf(path, sizeof path, "%s/file", link);
        pretended_user = 815;
        hf_status file = hf_file_out_target(path, target, &messages);
        pretended_user = 0;
        if (is_shared) demand_refused(file, "shared/their: this symbolic link", &messages);
        if (!is_shared) ck_assert_int_eq(file, HF_OK);
        snprintf(path, sizeof path, "%s/sub", link);
        pretended_user = 815;
        hf_status below = hf_file_out_folder(path, &messages);
        pretended_user = 0;
        if (is_shared) demand_refused(below, "shared/their: this symbolic link", &messages);
        if (!is_shared) ck_assert_int_eq(below, HF_OK);
    }
    ck_assert_int_eq(count_in(victim), 1);
    ck_assert_int_eq(hf_file_out_folder(temp_path("new/.//"), &messages), HF_OK);
    ck_assert_int_eq(access(temp_path("new"), F_OK), 0);
}
END_TEST

/* Whatever the link leads to: a device is no reason to replace the link. */
START_TEST(links_of_others_to_devices_are_refused)
{
    hf_messages messages = {0};
    struct stat info;
    char target[HF_FILE_OUT_SIZE];
    const char *link = temp_path("their_device");
    ck_assert_int_eq(symlink("/dev/full", link), 0);
    ck_assert_int_eq(hf_file_out_target(link, target, &messages), HF_OK);
    ck_assert_str_eq(target, link);
    ck_assert_int_eq(lstat(link, &info), 0);
    if (info.st_uid == 0 && lchown(link, 4711, (gid_t)-1) != 0) ck_abort_msg("root cannot give a link away");
    pretended_user = 815;
    hf_status status = hf_file_out_target(link, target, &messages);
    pretended_user = 0;
    demand_refused(status, "their_device: this symbolic link belongs to another user", &messages);
}
END_TEST

/* A device or a FIFO is not replaced by a file of its name. */
START_TEST(only_ordinary_files_are_replaced)
{
    hf_messages messages = {0};
    hf_file_out f;
    struct stat info;
    const char *pipe = temp_path("pipe"), *link = temp_path("to_pipe");
    ck_assert_int_eq(mkfifo(pipe, 0600), 0);
    ck_assert_int_eq(symlink(pipe, link), 0);
    demand_refused(hf_file_out_begin(pipe, &f, &messages), "pipe: this is not a regular file. Choose", &messages);
    demand_refused(hf_file_out_write(link, put_text, "x", &messages), "to_pipe: this is not a regular", &messages);
    ck_assert_int_eq(lstat(pipe, &info), 0);
    ck_assert(S_ISFIFO(info.st_mode));
    ck_assert_int_eq(lstat(link, &info), 0);
    ck_assert(S_ISLNK(info.st_mode));
}
END_TEST

/* A file that stays is never one that others could have put there. */
START_TEST(kept_files_are_ordinary_ones_with_one_name)
{
    bool was_there;
    const char *kept = temp_path("kept"), *other = temp_path("other"), *victim = temp_path("nothing");
    for (int i = 0; i < 2; i++) {
        int file = hf_file_out_keep(kept, &was_there);
        ck_assert_int_ge(file, 0);
        ck_assert_int_eq(was_there, i);
        close(file);
    }
    ck_assert_int_eq(link(kept, other), 0);
    ck_assert_int_eq(hf_file_out_keep(other, &was_there), -1);
    ck_assert_int_eq(errno, EEXIST);
    ck_assert_int_eq(unlink(other), 0);
    ck_assert_int_eq(symlink(victim, other), 0);
    ck_assert_int_eq(hf_file_out_keep(other, &was_there), -1);
    ck_assert_int_eq(errno, EEXIST);
    ck_assert_int_eq(hf_file_out_create(other), -1);
    ck_assert_int_eq(errno, EEXIST);
    ck_assert_int_eq(access(victim, F_OK), -1);
    ck_assert_int_eq(unlink(other), 0);
    ck_assert_int_eq(mkfifo(other, 0600), 0);
    ck_assert_int_eq(hf_file_out_keep(other, &was_there), -1);
    ck_assert_int_eq(errno, EEXIST);
    ck_assert_int_eq(unlink(other), 0);
    ck_assert_int_eq(mkdir(other, 0700), 0);
    ck_assert_int_eq(hf_file_out_keep(other, &was_there), -1);
    ck_assert_int_eq(errno, EEXIST);
}
END_TEST

/* The files of a set appear together. If something fails, whichever file it is, none is left. */
START_TEST(files_of_a_set_appear_together)
{
    static const char *const file[] = {"a", "b", "c"};
    char path[4096];
    for (int fails = -2; fails < 3; fails++) { /* -2: nothing; -1: no file, but the work of the caller */
        hf_file_out_set set = {0};
        hf_messages messages = {0};
        const char *folder = own_folder("set", "", path);
        for (int i = 0; i < 3; i++) {
            snprintf(path, sizeof path, "%s/%s", folder, file[i]);
            ck_assert_int_eq(hf_file_out_set_write(&set, path, put_text, file[i], &messages), HF_OK);
        }
        if (fails >= 0) fail_call_at("fsync", fails + 1, EIO, false);
        hf_status before = fails == -1 ? HF_BAD_CASE : HF_OK;
        ck_assert_int_eq(hf_file_out_set_end(&set, before, &messages), fails >= 0 ? HF_IO : before);
        if (fails >= 0) ck_assert(end_call_failure());
        ck_assert_int_eq(messages.n_error, fails >= 0);
        ck_assert_int_eq(count_in(folder), fails == -2 ? 3 : 0);
        for (int i = 0; i < 3 && fails == -2; i++) {
            snprintf(path, sizeof path, "%s/%s", folder, file[i]);
            demand_text(path, file[i]);
            ck_assert_int_eq(unlink(path), 0);
        }
        ck_assert_int_eq(rmdir(folder), 0);
        hf_messages_free(&messages);
    }
}
END_TEST

/* Gigabytes of samples belong on the disk of the result, where there is room for them. */
START_TEST(scratch_files_are_beside_the_result)
{
    char link[64], at[4096];
    const char *path = temp_path("result.h5");
    const char *beside[] = {path, "result.h5"};
    for (int i = 0; i < 2; i++) {
        int file = hf_file_out_scratch(beside[i]);
        ck_assert_int_ge(file, 0);
        snprintf(link, sizeof link, "/proc/self/fd/%d", file);
        ssize_t n = readlink(link, at, sizeof at - 1);
        ck_assert_int_gt((int)n, 0);
        at[n] = '\0';
        char *folder = realpath(i ? "." : temp_path("."), NULL);
        ck_assert_msg(!strncmp(at, folder, strlen(folder)) && at[strlen(folder)] == '/', "%s", at);
        free(folder);
        ck_assert_int_eq((int)pwrite(file, "x", 1, 5), 1);
        close(file);
    }
    ck_assert_int_eq(hf_file_out_scratch(temp_path("missing/result.h5")), -1);
    ck_assert_int_eq(errno, ENOENT);
}
END_TEST

Suite *suite_unit_file_out(void)
{
    Suite *suite = suite_create("unit/file_out");
    TCase *tc = tcase_create("file_out");
    tcase_add_test(tc, a_file_appears_whole_and_replaces);
    tcase_add_test(tc, files_of_a_set_appear_together);
    tcase_add_test(tc, what_cannot_get_its_name_leaves_nothing);
    tcase_add_test(tc, temporary_names_cannot_be_guessed);
    tcase_add_test(tc, leftovers_are_removed_and_nothing_else);
    tcase_add_test(tc, temporary_names_of_long_names);
    tcase_add_test(tc, a_path_may_be_too_long);
    tcase_add_test(tc, a_file_that_cannot_be_is_told_before);
    tcase_add_test(tc, adding_never_replaces);
    tcase_add_test(tc, adding_without_links_is_whole_or_not);
    tcase_add_test(tc, a_library_opens_the_file_that_was_made);
    tcase_add_test(tc, own_links_stand_for_what_they_lead_to);
    tcase_add_test(tc, links_of_others_are_refused);
    tcase_add_test(tc, folders_behind_links_of_others_are_refused);
    tcase_add_test(tc, links_of_others_to_devices_are_refused);
    tcase_add_test(tc, only_ordinary_files_are_replaced);
    tcase_add_test(tc, kept_files_are_ordinary_ones_with_one_name);
    tcase_add_test(tc, scratch_files_are_beside_the_result);
    suite_add_tcase(suite, tc);
    return suite;
}
