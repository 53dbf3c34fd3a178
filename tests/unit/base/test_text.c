/* Strict numbers, whole files, nearest words. */
#include "support.h"

#include "base/text.h"

#include <float.h>
#include <locale.h>
#include <stdlib.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* strtod rounds correctly, as the compiler does: exact. */
static const struct {
    const char *text;
    double value;
} good_double[] = {
    {"2.385", 2.385},  {"-2.385", -2.385}, {"+7", 7},      {"0", 0},
    {".5", 0.5},       {"5.", 5},          {"1e-6", 1e-6}, {"1E+3", 1000},
    {"-1.25e2", -125}, {"00012", 12},      {"1e-400", 0},  {"1.7976931348623157e308", DBL_MAX},
    {"0.1", 0.1},
};

START_TEST(decimal_numbers_are_taken)
{
    double value = -1;
    ck_assert(hf_text_double(good_double[_i].text, &value));
    ck_assert_double_eq(value, good_double[_i].value);
}
END_TEST

/* The double nearest to the decimal number, which a division of the nearest double by 1000 is not always. */
START_TEST(a_point_is_moved_in_the_text)
{
    static const char *const bad[] = {"", "1,5", "1e", "1e999", "1e99999999999999999999", "nan"};
    char text[64], moved[64];
    double value, expected;
    int n_other = 0;
    for (int k = 1; k < 20000; k++) {
        snprintf(text, sizeof text, "%d.%d%s", 37 * k, k % 10, k % 3 ? "" : "e1");
        snprintf(moved, sizeof moved, "%d.%de%s", 37 * k, k % 10, k % 3 ? "-3" : "-2");
        ck_assert(hf_text_decimal(text, -3, &value) && hf_text_double(moved, &expected));
        ck_assert_double_eq(value, expected);
        n_other += hf_text_double(text, &expected) && expected * 1e-3 != value;
    }
    ck_assert_int_gt(n_other, 0);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        ck_assert_msg(!hf_text_decimal(bad[k], -3, &value), "%s", bad[k]);
    ck_assert(hf_text_decimal("1e-99999999999999999999", -3, &value) && value == 0);
    ck_assert(hf_text_decimal("0e99999999999999999999", -3, &value) && value == 0);
}
END_TEST

static const char *const bad_double[] = {
    "",     " ",   "1 ",   " 1",    "1,5",   "1e",     "1e+",   "e5", ".",     "+",        "--1",   "nan",       "inf",
    "-inf", "NaN", "0x10", "0x1p3", "1e400", "-1e400", "1_000", "1f", "1.2.3", "infinity", "1e5.5", "\302\2401", "one",
};

START_TEST(everything_else_is_refused)
{
    double value;
    ck_assert_msg(!hf_text_double(bad_double[_i], &value), "'%s'", bad_double[_i]);
}
END_TEST

/* An application that links the library may have chosen such a locale; the test makes one, so that none need be
 * installed. Where localedef is missing, nothing can be tested. */
START_TEST(a_decimal_comma_changes_nothing)
{
    const char *source = temp_path("comma.src");
    write_file(source, "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \"\"\ngrouping -1\nEND LC_NUMERIC\n");
    const char *const argv[] = {
        "sh", "-c", "localedef -c -i \"$0\" -f ANSI_X3.4-1968 \"$1\"", source, temp_path("comma"), NULL};
    struct command command = run_command(HANG_S, argv);
    free_command(&command);
    char *folder = strdup(source);
    ck_assert_ptr_nonnull(folder);
    *strrchr(folder, '/') = '\0';
    setenv("LOCPATH", folder, 1);
    free(folder);
    if (!setlocale(LC_ALL, "comma")) {
        skip_for_tool("unit/text: a decimal comma", "no localedef");
        return;
    }
    double value = 0, other = 0, system = strtod("2.385", NULL);
    int point = hf_text_double("2.385", &value), comma = hf_text_double("2,385", &other);
    setlocale(LC_ALL, "C");
    ck_assert_double_eq(system, 2); /* the locale was in force */
    ck_assert(point && !comma);
    ck_assert_double_eq(value, 2.385);
}
END_TEST

START_TEST(whole_numbers)
{
    uint64_t value = 1;
    ck_assert(hf_text_uint64("0", &value) && value == 0);
    ck_assert(hf_text_uint64("2022", &value) && value == 2022);
    ck_assert(hf_text_uint64("18446744073709551615", &value) && value == UINT64_MAX);
    static const char *const bad[] = {"", "-1", "+1", "1.0", "1e3", "0x10", " 1", "1 ", "18446744073709551616", "x"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        ck_assert_msg(!hf_text_uint64(bad[i], &value), "'%s'", bad[i]);
}
END_TEST

START_TEST(nearest_word_is_a_likely_typing_error)
{
    static const char *const words[] = {"pretension_N", "residual_tolerance", "length_tolerance", "method", "stop"};
    ck_assert_str_eq(hf_text_nearest("pretention_N", words, 5), "pretension_N");
    ck_assert_str_eq(hf_text_nearest("PRETENSION_n", words, 5), "pretension_N");
    ck_assert_str_eq(hf_text_nearest("lenght_tolerance", words, 5), "length_tolerance");
    ck_assert_str_eq(hf_text_nearest("metod", words, 5), "method");
    ck_assert_str_eq(hf_text_nearest("sop", words, 5), "stop");
    ck_assert_str_eq(hf_text_nearest("stopp", words, 5), "stop");
    ck_assert_str_eq(hf_text_nearest("pretension", words, 5), "pretension_N"); /* without its unit */
    ck_assert_str_eq(hf_text_nearest("length", words, 5), "length_tolerance");
    ck_assert_ptr_null(hf_text_nearest("_N", words, 5));
    ck_assert_ptr_null(hf_text_nearest("colour", words, 5));
    ck_assert_ptr_null(hf_text_nearest("", words, 5));
    ck_assert_ptr_null(hf_text_nearest("stop", words, 0));
    char longer[200]; /* longer than the table of the edit distance */
    memset(longer, 'm', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    ck_assert_ptr_null(hf_text_nearest(longer, words, 5));
}
END_TEST

/* Around the first buffer (16384 bytes) and its double. */
START_TEST(files_of_any_length_are_whole)
{
    static const size_t lengths[] = {0, 1, 16382, 16383, 16384, 32767, 32768, 100000};
    size_t n = lengths[_i], length;
    char *text = malloc(n + 1), *back;
    ck_assert_ptr_nonnull(text);
    for (size_t i = 0; i < n; i++)
        text[i] = (char)('a' + i % 23);
    text[n] = '\0';
    write_file(temp_path("a.txt"), text);
    hf_messages m = {0};
    ck_assert_int_eq(hf_text_read_file(temp_path("a.txt"), HF_IO, &back, &length, &m), HF_OK);
    ck_assert_uint_eq(length, n);
    ck_assert_str_eq(back, text);
    ck_assert_ptr_null(m.text);
    free(back);
    free(text);
}
END_TEST

START_TEST(files_that_cannot_be_read_are_named)
{
    char *text;
    size_t length;
    hf_messages m = {0};
    ck_assert_int_eq(hf_text_read_file(temp_path("none.yaml"), HF_BAD_CASE, &text, &length, &m), HF_BAD_CASE);
    ck_assert_ptr_null(text);
    ck_assert_ptr_nonnull(strstr(m.text, "none.yaml: cannot open: No such file"));
    hf_messages_free(&m);
    temp_path("x"); /* the folder exists now */
    ck_assert_int_eq(hf_text_read_file(temp_path("."), HF_IO, &text, &length, &m), HF_IO);
    ck_assert_ptr_null(text);
    ck_assert_ptr_nonnull(strstr(m.text, "this is a folder. Give the name of a regular file"));
    hf_messages_free(&m);
}
END_TEST

START_TEST(a_cut_letter_is_taken_away_whole)
{
    static const struct {
        const char *text, *trimmed;
    } cases[] = {{"abc", "abc"},
                 {"ab\xc3", "ab"},
                 {"ab\xc3\xa9", "ab\xc3\xa9"},
                 {"a\xe4\xb8", "a"},
                 {"a\xe4\xb8\xad", "a\xe4\xb8\xad"},
                 {"\xf0\x9f\x98", ""},
                 {"", ""},
                 {"x\xf0", "x"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[16];
        snprintf(text, sizeof text, "%s", cases[i].text);
        hf_text_trim_utf8(text);
        ck_assert_str_eq(text, cases[i].trimmed);
    }
}
END_TEST

static const struct {
    const char *text, *shown;
} escape[] = {
    {"", ""},
    {"plain, \xc3\xa9 \xe4\xb8\xad \xf0\x9f\x98\x80 \\ 'q'", "plain, \xc3\xa9 \xe4\xb8\xad \xf0\x9f\x98\x80 \\ 'q'"},
    {"\x1b[31mred\x07\x7f\x01", "\\x1b[31mred\\x07\\x7f\\x01"},
    {"a\nb\tc\rd", "a\\nb\\tc\\rd"},
    {"\xc2\x80\xc2\x9b\xc2\x9f\xc2\xa0", "\\u0080\\u009b\\u009f\xc2\xa0"},
    {"\xe2\x80\xaa\xe2\x80\xae\xe2\x81\xa6\xe2\x81\xa9", "\\u202a\\u202e\\u2066\\u2069"},
    {"\xe2\x80\x8e\xe2\x80\x8f\xd8\x9c\xe2\x80\xa8\xe2\x80\xa9", "\\u200e\\u200f\\u061c\\u2028\\u2029"},
    {"\xe2\x80\x8d\xe2\x80\xaf\xe2\x81\xaa", "\xe2\x80\x8d\xe2\x80\xaf\xe2\x81\xaa"}, /* neighbours of those */
    {"\xffz\xc3x\xc0\xaf\xed\xa0\x80", "\\xffz\\xc3x\\xc0\\xaf\\xed\\xa0\\x80"},
    {"cut \xe2\x80", "cut \\xe2\\x80"},
    {"\\x1b", "\\x1b"},
};
enum { N_ESCAPE = sizeof escape / sizeof *escape };

START_TEST(hidden_characters_are_shown)
{
    char shown[100];
    ck_assert_uint_eq(hf_text_escape(escape[_i].text, shown, sizeof shown), strlen(escape[_i].shown));
    ck_assert_str_eq(shown, escape[_i].shown);
    ck_assert_uint_eq(hf_text_escape(escape[_i].text, NULL, 0), strlen(shown));
}
END_TEST

/* Bytes in which rare ones are frequent: what is shown is UTF-8 without hidden characters, stays as it is when escaped
 * again, and is cut at whole characters where room ends. */
START_TEST(whatever_is_escaped_can_be_shown)
{
    static const char *const part[] = {"\xe2\x80", "\xe2\x81", "\xc2", "\xd8\x9c", "\x1b", "\\", "a", "\xf0\x9f"};
    for (uint64_t trial = 0; trial < 3000; trial++) {
        struct rng rng = rng_start(trial);
        char text[64] = "", shown[300], again[300], cut[300];
        for (int n = rng_int(&rng, 0, 12); n > 0; n--) {
            size_t used = strlen(text);
            if (rng_int(&rng, 0, 1))
                snprintf(text + used, sizeof text - used, "%s", part[rng_int(&rng, 0, 7)]);
            else
                snprintf(text + used, sizeof text - used, "%c", rng_int(&rng, 1, 255));
        }
        size_t length = hf_text_escape(text, shown, sizeof shown), room = (size_t)rng_int(&rng, 1, (int)length + 2);
        ck_assert_uint_eq(strlen(shown), length);
        uint32_t code;
        for (const char *p = shown; *p; p += hf_text_character(p, &code))
            ck_assert_msg(hf_text_character(p, &code) > 0 && !hf_text_is_hidden(code), "%d: %s", (int)trial, shown);
        ck_assert_uint_eq(hf_text_escape(shown, again, sizeof again), length);
        ck_assert_str_eq(again, shown);
        ck_assert_uint_eq(hf_text_escape(text, cut, room), length);
        ck_assert(strlen(cut) < room && !strncmp(cut, shown, strlen(cut)) && hf_text_is_utf8(cut));
        ck_assert(strlen(cut) == length || strlen(cut) + 7 > room);
    }
}
END_TEST

START_TEST(a_list_ends_with_more_where_it_is_full)
{
    static const char *const item[] = {"front", "rear", "tie", "edge"};
    for (size_t size = 6; size < 40; size++) {
        char text[40] = "", whole[40] = "";
        bool fits = true;
        for (int k = 0; k < 4; k++) {
            if (fits) fits = hf_text_append(text, size, ", ", item[k], ", ...");
            snprintf(whole + strlen(whole), sizeof whole - strlen(whole), "%s%s", k ? ", " : "", item[k]);
        }
        ck_assert_uint_lt(strlen(text), size);
        if (fits) ck_assert_str_eq(text, whole);
        if (!fits) ck_assert_str_eq(text + strlen(text) - 5, ", ...");
        if (!fits) ck_assert_int_eq(strncmp(text, whole, strlen(text) - 5), 0);
        ck_assert(fits == (size > strlen(whole) + 5));
    }
}
END_TEST

Suite *suite_unit_text(void)
{
    Suite *suite = suite_create("unit/text");
    TCase *tests = tcase_create("text");
    tcase_add_loop_test(tests, hidden_characters_are_shown, 0, N_ESCAPE);
    tcase_add_test(tests, whatever_is_escaped_can_be_shown);
    tcase_add_test(tests, a_cut_letter_is_taken_away_whole);
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, a_point_is_moved_in_the_text);
    tcase_add_loop_test(tests, decimal_numbers_are_taken, 0, sizeof good_double / sizeof *good_double);
    tcase_add_loop_test(tests, everything_else_is_refused, 0, sizeof bad_double / sizeof *bad_double);
    tcase_add_test(tests, a_decimal_comma_changes_nothing);
    tcase_add_test(tests, whole_numbers);
    tcase_add_test(tests, a_list_ends_with_more_where_it_is_full);
    tcase_add_test(tests, nearest_word_is_a_likely_typing_error);
    tcase_add_loop_test(tests, files_of_any_length_are_whole, 0, 8);
    tcase_add_test(tests, files_that_cannot_be_read_are_named);
    return suite;
}
