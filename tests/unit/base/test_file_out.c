/* Files that appear whole or not at all. Calls of the system that fail: tests/fault/test_store_calls.c. */
#include "support.h"

#include "base/file_out.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
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

START_TEST(what_cannot_get_its_name_leaves_nothing)
{
    hf_messages messages = {0};
    hf_file_out f;
    const char *folder = temp_path("folder");
    ck_assert_int_eq(mkdir(folder, 0777), 0);
    ck_assert_int_eq(hf_file_out_write(folder, put_text, "x", &messages), HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, "cannot write"));
    ck_assert_int_eq(hf_file_out_begin(folder, &f, &messages), HF_OK);
    ck_assert_int_eq(access(f.temporary, F_OK), -1);
    ck_assert_int_eq(messages.n_error, 1);
    hf_messages_free(&messages);
}
END_TEST

/* A temporary name that is taken, even by a link that leads nowhere, is not written through. */
START_TEST(a_taken_temporary_name_is_refused)
{
    hf_messages messages = {0};
    hf_file_out f;
    const char *path = temp_path("out"), *victim = temp_path("victim");
    ck_assert_int_eq(hf_file_out_begin(path, &f, &messages), HF_OK);
    ck_assert_int_eq(symlink(victim, f.temporary), 0);
    ck_assert_int_eq(hf_file_out_write(path, put_text, "x", &messages), HF_IO);
    ck_assert_int_eq(access(victim, F_OK), -1);
    ck_assert_int_eq(access(path, F_OK), -1);
    ck_assert_int_eq(hf_file_out_clear(f.temporary), 0);
    ck_assert_int_eq(hf_file_out_clear(f.temporary), 0); /* nothing is there any more */
    ck_assert_int_eq(hf_file_out_write(path, put_text, "x", &messages), HF_OK);
    hf_messages_free(&messages);
}
END_TEST

START_TEST(a_path_may_be_too_long)
{
    hf_messages messages = {0};
    hf_file_out f;
    char path[HF_FILE_OUT_SIZE];
    memset(path, 'x', sizeof path);
    path[sizeof path - 1] = '\0';
    ck_assert_int_eq(hf_file_out_begin(path, &f, &messages), HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, "the path is too long"));
    hf_messages_free(&messages);
}
END_TEST

/* Looked at before the work: a folder that is not there, a name with no room for the ending of the temporary one. */
START_TEST(a_file_that_cannot_be_is_told_before)
{
    hf_messages messages = {0};
    char name[256];
    memset(name, 'x', 255); /* the longest that file systems allow */
    name[255] = '\0';
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
    const char *new = temp_path("new"), *path = temp_path("path");
    write_file(new, "new");
    write_file(path, "old");
    ck_assert_int_eq(hf_file_out_add(new, path), -1);
    ck_assert_int_eq(errno, EEXIST);
    ck_assert_int_eq(unlink(path), 0);
    ck_assert_int_eq(hf_file_out_add(new, path), 0);
    ck_assert_int_eq(access(new, F_OK), -1);
    char *text = read_file(path, NULL);
    ck_assert_str_eq(text, "new");
    free(text);
    ck_assert_int_eq(hf_file_out_sync(path), 0);
    ck_assert_int_eq(hf_file_out_sync(new), -1);
    ck_assert_int_eq(errno, ENOENT);
}
END_TEST

Suite *suite_unit_file_out(void)
{
    Suite *suite = suite_create("unit/file_out");
    TCase *tc = tcase_create("file_out");
    tcase_add_test(tc, a_file_appears_whole_and_replaces);
    tcase_add_test(tc, what_cannot_get_its_name_leaves_nothing);
    tcase_add_test(tc, a_taken_temporary_name_is_refused);
    tcase_add_test(tc, a_path_may_be_too_long);
    tcase_add_test(tc, a_file_that_cannot_be_is_told_before);
    tcase_add_test(tc, adding_never_replaces);
    suite_add_tcase(suite, tc);
    return suite;
}
