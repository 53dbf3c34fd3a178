/* The parts of the table reader that the tests of the import (test_scene_import) do not reach: wide tables, lookups,
 * ids written and read back. */
#include "support.h"

#include "base/csv.h"
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
    hf_csv_named *index = hf_csv_index(&table, 0);
    ck_assert_ptr_nonnull(index);
    for (int i = 0; i < N; i++)
        ck_assert_int_eq(hf_csv_row_of(index, table.n_row, id[i]), i);
    ck_assert_int_eq(hf_csv_row_of(index, table.n_row, "c"), -1);
    ck_assert_int_eq(hf_csv_close_faults(&table), HF_OK);
    free(index);
    hf_csv_free(&table);
}
END_TEST

Suite *suite_unit_csv(void)
{
    Suite *suite = suite_create("unit/csv");
    TCase *tests = tcase_create("csv");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, a_table_may_be_as_wide_as_asked);
    tcase_add_test(tests, ids_are_found_and_survive_writing);
    return suite;
}
