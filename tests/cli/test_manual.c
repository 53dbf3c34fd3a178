/* Every command in the pages of src/manual does what the page says: its exit status, and the figures in the text. The
 * table of faults in src/manual/faults.md has a row for each stage and command. */
#include "cli.h"

#define BLOCKS "cd \"$1\" && exec \"$2\" tools/docs/blocks.py --program \"$0\" --work \"$3\""
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
/* Python cannot load a library with sanitizers. */
#define PAGES " $(find src/manual -name '*.md' ! -name python.md ! -name own-optimiser.md)"
#else
#define PAGES ""
#endif
#define WHERE keep(source_path(".")), python_program(), temp("manual")

START_TEST(commands_of_the_manual_do_what_it_says)
{
    SHELL(0, BLOCKS PAGES, WHERE);
    OUT("src/manual/tutorial.md: its commands do what it says");
}
END_TEST

/* What the test above would not see if its program did not look. */
START_TEST(a_page_that_is_wrong_is_named)
{
    static const char *const page[][2] = {
        {"```console\n$ false\n```\n", "exit status 1 and not 0: false"},
        {"```console status=3\n$ true\n```\n", "exit status 0 and not 3: true"},
        {"```console\n$ echo psi 1.2\n```\npsi is {out}`1.3`\n", "\"1.3\" is not printed"},
        {"```console by=Makefile\n$ no such line\n```\n", "Makefile does not run no such line"},
    };
    for (int k = 0; k < 4; k++) {
        SHELL(1, BLOCKS " \"$4\"", WHERE, file_with("wrong.md", page[k][0]));
        ERR(page[k][1]);
    }
}
END_TEST

#define TABLE "cd \"$1\" && exec \"$2\" tests/fault/table.py --check"

/* The table of faults; `make release-check` measures it. */
START_TEST(the_fault_table_has_every_stage_and_command)
{
    SHELL(0, TABLE " --program \"$0\"", WHERE);
}
END_TEST

/* A manual without a row, one with a row too many, and a program with a command and a section that have none. */
START_TEST(a_fault_table_that_lacks_a_row_is_named)
{
    const char *copy = temp("copy.md"), *program = temp("program"), *manual = keep(source_path("src/manual/faults.md"));
    SHELL(0, "sed 's/; load cases;/;/' \"$1\" >\"$2\"", manual, copy);
    SHELL(1, TABLE " --program \"$0\" --manual \"$4\"", WHERE, copy);
    ERR(", load cases");
    SHELL(0, "sed 's/; load cases;/; load cases; surface;/' \"$1\" >\"$2\"", manual, copy);
    SHELL(1, TABLE " --program \"$0\" --manual \"$4\"", WHERE, copy);
    ERR("surface is no cell of ");
    write_file(program, "#!/bin/sh\n\"$HIFDM\" \"$@\"\n[ \"$1\" != help ] || echo '  hifdm fold CASE fold it'\n"
                        "[ \"$1\" != schema ] || echo 'folding:'\n");
    SHELL(1, "chmod +x \"$4\" && export HIFDM=\"$0\" && " TABLE " --program \"$4\"", WHERE, program);
    ERR("the command `fold` has no row");
    ERR("the section `folding` is not in tests/fault/faults.py");
}
END_TEST

Suite *suite_cli_manual(void)
{
    Suite *suite = suite_create("cli/manual");
    TCase *tcase = tcase_create("manual");
    tcase_add_test(tcase, commands_of_the_manual_do_what_it_says);
    tcase_add_test(tcase, a_page_that_is_wrong_is_named);
    tcase_add_test(tcase, the_fault_table_has_every_stage_and_command);
    tcase_add_test(tcase, a_fault_table_that_lacks_a_row_is_named);
    suite_add_tcase(suite, tcase);
    return suite;
}
