/* Tests of the test helpers: a test that uses a broken helper proves nothing. */
#include "support.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

START_TEST(files_are_read_back_whole)
{
    char text[10001]; /* longer than read_file's first buffer of 4096 */
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    const char *path = temp_path("a.txt");
    const size_t lengths[] = {0, 1, 4094, 4095, 4096, 10000};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        size_t size;
        write_file(path, text + (sizeof text - 1 - lengths[i]));
        char *back = read_file(path, &size);
        ck_assert_uint_eq(size, lengths[i]);
        ck_assert_uint_eq(strlen(back), lengths[i]);
        free(back);
    }
}
END_TEST

START_TEST(temporary_directory_is_new)
{
    const char *fork = getenv("CK_FORK");
    if (fork && strcmp(fork, "no") == 0) return; /* one process, one directory */
    ck_assert_int_ne(access(temp_path("made-by-another-test"), F_OK), 0);
    write_file(temp_path("made-by-another-test"), "");
}
END_TEST

START_TEST(commands_give_output_and_exit_code)
{
    const char *const argv[] = {"sh", "-c", "echo to out; echo to err >&2; exit 7", NULL};
    struct command command = run_command(HANG_S, argv);
    ck_assert_int_eq(command.exit_code, 7);
    ck_assert(!command.timed_out);
    ck_assert_str_eq(command.out, "to out\n");
    ck_assert_str_eq(command.err, "to err\n");
    free_command(&command);
}
END_TEST

START_TEST(commands_that_hang_are_killed)
{
    const char *const argv[] = {"sleep", "600", NULL};
    struct command command = run_command(0.05, argv);
    ck_assert(command.timed_out);
    ck_assert_int_eq(command.exit_code, 128 + 9);
    free_command(&command);
}
END_TEST

/* The compiler must not see through the allocation, or it drops it. */
static void *volatile kept[3];

START_TEST(only_the_nth_allocation_fails)
{
    bool got[3];
    long before = allocation_count();
    fail_allocation_at(2);
    kept[0] = malloc(17);
    kept[1] = calloc(3, 5);
    kept[2] = strdup("text");
    bool reached = end_allocation_failure();
    long made = allocation_count() - before;
    for (int i = 0; i < 3; i++) {
        got[i] = kept[i] != NULL;
        free(kept[i]);
    }
    ck_assert(reached && got[0] && !got[1] && got[2]);
    ck_assert_int_eq(made, 3);

    fail_allocation_at(2);
    kept[0] = malloc(17);
    reached = end_allocation_failure();
    free(kept[0]);
    ck_assert(!reached);
}
END_TEST

START_TEST(random_streams_repeat_and_differ)
{
    struct rng a = rng_start(3), again = rng_start(3), b = rng_start(4);
    for (int i = 0; i < 1000; i++) {
        uint64_t value = rng_next(&a);
        ck_assert(value == rng_next(&again));
        ck_assert(value != rng_next(&b));
        double uniform = rng_uniform(&a, -2.385, 1.25);
        ck_assert(uniform >= -2.385 && uniform < 1.25);
        ck_assert_double_eq(uniform, rng_uniform(&again, -2.385, 1.25));
        int integer = rng_int(&a, -3, 4);
        ck_assert(integer >= -3 && integer <= 4);
        ck_assert_int_eq(integer, rng_int(&again, -3, 4));
    }
}
END_TEST

Suite *suite_unit_support(void)
{
    Suite *suite = suite_create("unit/support");
    TCase *tests = tcase_create("support");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, files_are_read_back_whole);
    tcase_add_loop_test(tests, temporary_directory_is_new, 0, 2);
    tcase_add_test(tests, commands_give_output_and_exit_code);
    tcase_add_test(tests, commands_that_hang_are_killed);
    tcase_add_test(tests, only_the_nth_allocation_fails);
    tcase_add_test(tests, random_streams_repeat_and_differ);
    return suite;
}
