/* The parts of the table reader that the tests of the import (test_scene_import) do not reach: wide tables, lookups,
 * ids written and read back. */
#include "support.h"

#include "base/csv.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

enum { WIDE = 5000 };

START_TEST(a_table_may_be_as_wide_as_asked)
{
    hf_messages messages = {0};
    hf_csv table;
    FILE *file = fopen(temp_path("wide.csv"), "w");
    ck_assert_ptr_nonnull(file);
    for (int line = 0; line < 3; line++)
        for (int c = 0; c < WIDE; c++)
            fprintf(file, "%s%d%s", line ? "" : "c", line * WIDE + c, c + 1 < WIDE ? "," : "\n");
    fclose(file);
    ck_assert_int_eq(hf_csv_read(temp_path("wide.csv"), WIDE, &table, &messages), HF_OK);
    ck_assert(table.n_column == WIDE && table.n_row == 2 && table.line[1] == 3);
    ck_assert_str_eq(table.header[WIDE - 1], "c4999");
    ck_assert_double_eq(hf_csv_number(&table, 1, 7, NULL, "c7"), 2 * WIDE + 7);
    hf_csv_free(&table);
    ck_assert_int_eq(hf_csv_read(temp_path("wide.csv"), WIDE - 1, &table, &messages), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "wide.csv:1: too many columns\n"));
    hf_csv_free(&table);
    hf_messages_free(&messages);
}
END_TEST

START_TEST(ids_are_found_and_survive_writing)
{
    static const char *const id[] = {"b", " a ", "\"q\"", "x,y", "#1", "tab\t", "Knoten-\xc3\xa9"};
    enum { N = sizeof id / sizeof *id };
    hf_messages messages = {0};
    hf_csv table;
    FILE *file = fopen(temp_path("ids.csv"), "w");
    ck_assert_ptr_nonnull(file);
    fputs("id\n", file);
    for (int i = 0; i < N; i++) {
        hf_csv_write_id(id[i], file);
        fputc('\n', file);
    }
    fclose(file);
    ck_assert_msg(hf_csv_read(temp_path("ids.csv"), 8, &table, &messages) == HF_OK, "%s", messages.text);
    ck_assert_int_eq(hf_csv_index(&table, 0), HF_OK);
    ck_assert_int_eq(hf_csv_know(&table, N, id), HF_OK);
    for (int i = 0; i < N; i++) {
        ck_assert_int_eq(hf_csv_reference(&table, i, 0, "row", "none", &table), i);
        ck_assert_int_eq(hf_csv_find_known(&table, id[i]), i);
    }
    ck_assert_int_eq(hf_csv_find_known(&table, "c"), -1);
    ck_assert_int_eq(hf_csv_close_faults(&table), HF_OK);
    hf_csv_free(&table);
}
END_TEST

/* ---- cells that spreadsheets run ---- */

static const struct {
    const char *id, *written;
} guarded[] = {
    {"=1+1", "'=1+1"},
    {"-a", "'-a"},
    {"+a", "'+a"},
    {"@SUM(A1)", "'@SUM(A1)"},
    {"=cmd|' /C calc'!A0", "'=cmd|' /C calc'!A0"},
    {"=a,\"b\"", "\"'=a,\"\"b\"\"\""},
    {"\xef\xbc\x9d\x31", "'\xef\xbc\x9d\x31"},
    {"\xef\xbc\x8b\x31", "'\xef\xbc\x8b\x31"},
    {"\xef\xbc\x8d\x31", "'\xef\xbc\x8d\x31"},
    {"\xef\xbc\xa0\x31", "'\xef\xbc\xa0\x31"},
    {" =1", "\"' =1\""},
    {"\ta", "\"'\ta\""},
    {"'=1", "''=1"},
    {"''-", "'''-"},
    {"'-1.5", "''-1.5"},
    {"-1.5", "-1.5"}, /* numbers, and apostrophes in front of anything else */
    {"+7e-3", "+7e-3"},
    {"'a", "'a"},
    {"''", "''"},
    {"a=1", "a=1"},
    {"a;=1", "\"a;=1\""},
};
enum { N_GUARDED = sizeof guarded / sizeof *guarded };

/* Writes ids as the cells of one column and demands them back. Returns what stands in the file. */
static char *round_trip(const char *const *id, int n)
{
    hf_messages messages = {0};
    hf_csv table;
    FILE *file = fopen(temp_path("ids.csv"), "w");
    ck_assert_ptr_nonnull(file);
    for (int i = -1; i < n; i++) {
        hf_csv_write_id(i < 0 ? "=header" : id[i], file);
        fputs(",2\n", file); /* so that no line is empty */
    }
    fclose(file);
    ck_assert_msg(hf_csv_read(temp_path("ids.csv"), 2, &table, &messages) == HF_OK, "%s", messages.text);
    ck_assert_str_eq(table.header[0], "=header");
    ck_assert_int_eq(table.n_row, n);
    for (int i = 0; i < n; i++)
        ck_assert_msg(!strcmp(hf_csv_cell(&table, i, 0), id[i]), "seed %ju, %d: '%s' came back as '%s'",
                      (uintmax_t)test_seed(), i, id[i], hf_csv_cell(&table, i, 0));
    hf_csv_free(&table);
    return read_file(temp_path("ids.csv"), NULL);
}

START_TEST(formulas_are_written_as_texts)
{
    char line[64], *text = round_trip(&guarded[_i].id, 1);
    snprintf(line, sizeof line, "'=header,2\n%s,2\n", guarded[_i].written);
    ck_assert_str_eq(text, line);
    free(text);
}
END_TEST

/* Ids of the bytes that matter here. No cell that is not a number begins with what a spreadsheet runs. */
START_TEST(every_id_comes_back)
{
    static const char *const part[] = {
        "'",    "=", "+", "-", "@", "\xef\xbc\x9d", "\xef\xbc\xa0", "1", ".", " ", "\t", "\"", ",",
        "\"\"", "a", "#", ";", "e"};
    enum { N = 4000, N_PART = sizeof part / sizeof *part };
    static char text[N][32];
    const char *id[N];
    struct rng rng = rng_start(12);
    for (int i = 0; i < N; i++) {
        for (int k = rng_int(&rng, 0, 7); k > 0; k--)
            strcat(text[i], part[rng_int(&rng, 0, N_PART - 1)]);
        id[i] = text[i];
    }
    char *all = round_trip(id, N);
    for (char *rest = all, *line; (line = strtok_r(rest, "\n", &rest));) {
        char *cell = line + (*line == '"');
        double number;
        line[strcspn(line, ",")] = '\0';
        ck_assert_msg(!strchr("=+-@\t\xef", *cell + !*cell) || hf_text_double(cell, &number), "seed %ju: %s",
                      (uintmax_t)test_seed(), cell);
        ck_assert_msg(*cell != ' ' || !strchr("=+-@\xef", cell[strspn(cell, " \t")]) || !cell[strspn(cell, " \t")],
                      "seed %ju: %s", (uintmax_t)test_seed(), cell);
    }
    free(all);
}
END_TEST

Suite *suite_unit_csv(void)
{
    Suite *suite = suite_create("unit/csv");
    TCase *tests = tcase_create("csv");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, a_table_may_be_as_wide_as_asked);
    tcase_add_test(tests, ids_are_found_and_survive_writing);
    tcase_add_loop_test(tests, formulas_are_written_as_texts, 0, N_GUARDED);
    tcase_add_test(tests, every_id_comes_back);
    return suite;
}
