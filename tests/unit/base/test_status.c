/* Codes, their texts, and messages. */
#include "support.h"

#include <hifdm/status.h>
#include <stdlib.h>
#include <string.h>

/* Written out a second time, because result files hold these numbers and scripts these exit codes. */
static const struct {
    int value, exit_code;
    const char *word;
} known[] = {
    {0, 0, "ok"},         {1, 3, "not_converged"}, {2, 4, "singular"},   {3, 4, "straight_chain"},
    {4, 4, "collapsed"},  {5, 4, "not_finite"},    {6, 4, "ratio_cap"},  {7, 3, "not_evaluated"},
    {20, 2, "bad_usage"}, {21, 2, "bad_case"},     {30, 5, "no_memory"}, {31, 5, "io"},
    {32, 5, "exists"},
};
enum { N_KNOWN = sizeof known / sizeof *known };

START_TEST(numbers_words_and_exit_codes_stay)
{
    int n_listed = 0;
#define COUNT(...) n_listed++;
    HF_STATUS_LIST(COUNT)
#undef COUNT
    ck_assert_int_ge(n_listed, N_KNOWN);
    for (int i = 0; i < N_KNOWN; i++) {
        hf_status status = (hf_status)known[i].value;
        ck_assert_str_eq(hf_status_word(status), known[i].word);
        ck_assert_int_eq(hf_status_exit_code(status), known[i].exit_code);
        ck_assert(strlen(hf_status_text(status)) > 0);
    }
}
END_TEST

START_TEST(words_are_single_and_different)
{
    static const char *const word[] = {
#define WORD(name, value, word, ...) word,
        HF_STATUS_LIST(WORD)
#undef WORD
    };
    int n = sizeof word / sizeof *word;
    for (int i = 0; i < n; i++) {
        ck_assert_ptr_null(strpbrk(word[i], " \t\n,;"));
        for (int j = 0; j < i; j++)
            ck_assert_str_ne(word[i], word[j]);
    }
}
END_TEST

START_TEST(foreign_values_are_unknown)
{
    ck_assert_str_eq(hf_status_word((hf_status)19), "unknown");
    ck_assert_str_eq(hf_status_text((hf_status)19), "unknown status");
    ck_assert_int_eq(hf_status_exit_code((hf_status)19), 5);
}
END_TEST

static int n_call;

static hf_status answer(hf_status status)
{
    n_call++;
    return status;
}

static hf_status try_twice(hf_status first, hf_status second)
{
    HF_TRY(answer(first));
    HF_TRY(answer(second));
    return HF_OK;
}

START_TEST(try_returns_the_first_failure_and_evaluates_once)
{
    n_call = 0;
    ck_assert_int_eq(try_twice(HF_IO, HF_BAD_CASE), HF_IO);
    ck_assert_int_eq(n_call, 1);
    ck_assert_int_eq(try_twice(HF_OK, HF_BAD_CASE), HF_BAD_CASE);
    ck_assert_int_eq(n_call, 3);
    ck_assert_int_eq(try_twice(HF_OK, HF_OK), HF_OK);
}
END_TEST

START_TEST(messages_are_lines_in_order)
{
    hf_messages m = {0};
    ck_assert_int_eq(hf_error(&m, HF_IO, "%s:%d: no", "a.csv", 7), HF_IO);
    hf_warning(&m, "odd");
    ck_assert_int_eq(hf_error(&m, HF_BAD_CASE, "worse"), HF_BAD_CASE);
    ck_assert_str_eq(m.text, "error: a.csv:7: no\nwarning: odd\nerror: worse\n");
    ck_assert_uint_eq(m.length, strlen(m.text));
    ck_assert_int_eq(m.n_error, 2);
    ck_assert_int_eq(m.n_warning, 1);
    hf_messages_free(&m);
    ck_assert_ptr_null(m.text);
    ck_assert_int_eq(m.n_error, 0);
}
END_TEST

/* Lengths around the first capacity (256) and beyond twice of it: the two ways in which the buffer grows. */
START_TEST(messages_of_any_length_are_whole)
{
    char body[1200];
    for (int first = 230; first <= 260; first++)
        for (int second = 1; second <= 1100; second += 157) {
            hf_messages m = {0};
            memset(body, 'x', sizeof body);
            hf_warning(&m, "%.*s", first, body);
            hf_error(&m, HF_IO, "%.*s", second, body);
            ck_assert_uint_eq(strlen(m.text), strlen("warning: \nerror: \n") + (size_t)(first + second));
            ck_assert_uint_eq(m.length, strlen(m.text));
            ck_assert_int_eq(m.text[m.length - 1], '\n');
            ck_assert(m.capacity > m.length);
            hf_messages_free(&m);
        }
}
END_TEST

/* Whatever a name holds, a message is one line, and no terminal obeys it. */
START_TEST(messages_show_what_names_hide)
{
    hf_messages m = {0};
    hf_error(&m, HF_IO, "%s: no", "a\nerror: forged\x1b[2J\xe2\x80\xae\xff");
    hf_warning(&m, "plain");
    ck_assert_str_eq(m.text, "error: a\\nerror: forged\\x1b[2J\\u202e\\xff: no\nwarning: plain\n");
    ck_assert_uint_eq(m.length, strlen(m.text));
    hf_messages_free(&m);
    char body[700]; /* grows to four times its length, in a list of any length */
    for (size_t before = 0; before < 600; before += 37)
        for (size_t n = 1; n < sizeof body; n += 61) {
            memset(body, 'x', before);
            body[before] = '\0';
            hf_warning(&m, "%s", body);
            memset(body, '\x1b', n);
            body[n] = '\0';
            hf_error(&m, HF_IO, "%s", body);
            ck_assert_uint_eq(strlen(m.text), strlen("warning: \nerror: \n") + before + 4 * n);
            ck_assert_uint_eq(m.length, strlen(m.text));
            ck_assert_ptr_null(strchr(m.text, '\x1b'));
            hf_messages_free(&m);
        }
}
END_TEST

START_TEST(without_memory_lines_are_lost_but_counted)
{
    char body[400];
    memset(body, 'x', sizeof body - 1);
    body[sizeof body - 1] = '\0';
    hf_messages m = {0};
    hf_warning(&m, "kept");
    fail_allocation_at(1);
    hf_status status = hf_error(&m, HF_IO, "%s", body);
    ck_assert(end_allocation_failure());
    ck_assert_int_eq(status, HF_IO);
    ck_assert_int_eq(m.n_error, 1);
    ck_assert_str_eq(m.text, "warning: kept\n");
    memset(body, '\x1b', 200); /* there is room for the body, but not for what is shown of it */
    body[200] = '\0';
    fail_allocation_at(1);
    hf_error(&m, HF_IO, "%s", body);
    ck_assert(end_allocation_failure());
    ck_assert_str_eq(m.text, "warning: kept\n");
    hf_error(&m, HF_IO, "again");
    ck_assert_str_eq(m.text, "warning: kept\nerror: again\n");
    hf_messages_free(&m);
}
END_TEST

Suite *suite_unit_status(void)
{
    Suite *suite = suite_create("unit/status");
    TCase *tests = tcase_create("status");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, numbers_words_and_exit_codes_stay);
    tcase_add_test(tests, words_are_single_and_different);
    tcase_add_test(tests, foreign_values_are_unknown);
    tcase_add_test(tests, try_returns_the_first_failure_and_evaluates_once);
    tcase_add_test(tests, messages_are_lines_in_order);
    tcase_add_test(tests, messages_of_any_length_are_whole);
    tcase_add_test(tests, messages_show_what_names_hide);
    tcase_add_test(tests, without_memory_lines_are_lost_but_counted);
    return suite;
}
