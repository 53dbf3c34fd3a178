/* What the program says, from help to pages, against tests/cli/transcripts; see transcript.py. `make transcripts`
 * writes these files; the commit shows what a change makes the program say. */
#include "cli.h"

#include <dirent.h>

static const char *const transcripts[] = {"adjust", "bad_nets",  "bad_values", "help",
                                          "nets",   "reflector", "search",     "study"};
enum { N_TRANSCRIPT = sizeof transcripts / sizeof *transcripts };

#define TRANSCRIPT(exit_code, file)                                                                                    \
    SHELL(exit_code, "exec \"$1\" \"$2\" \"$3\" \"$0\" \"$4\" ${HIFDM_TRANSCRIPTS:+--write}", python_program(),        \
          keep(source_path("tests/cli/transcript.py")), file, temp("work"))

START_TEST(it_says_what_it_said)
{
    TRANSCRIPT(0, keep(source_path(formatted("tests/cli/transcripts/%s.txt", transcripts[_i]))));
}
END_TEST

START_TEST(every_transcript_is_in_the_list)
{
    DIR *folder = opendir(source_path("tests/cli/transcripts"));
    ck_assert_ptr_nonnull(folder);
    for (const struct dirent *entry; (entry = readdir(folder));) {
        if (!strstr(entry->d_name, ".txt")) continue;
        int i = 0;
        while (i < N_TRANSCRIPT && strcmp(entry->d_name, formatted("%s.txt", transcripts[i])))
            i++;
        ck_assert_msg(i < N_TRANSCRIPT, "%s is not in the list", entry->d_name);
    }
    closedir(folder);
}
END_TEST

/* Another word, another number, an exit status, a line more and a line less are noticed; times are not. */
START_TEST(a_difference_is_noticed)
{
    static const struct {
        const char *text;
        int exit_code;
    } rows[] = {
        {"$ echo it took 3.2 s, 1.00004 N\nit took TIME, 1.00005 N\n", 0},
        {"$ echo 1e-12 2\n-3e-11 2\n", 0},
        {"$ echo wall_s: 1e-9\nwall_s: TIME\n", 0},
        {"$ echo wall_s: -1e-9\nwall_s: TIME\n", 1},
        {"$ echo wall_s: 1e9\nwall_s: TIME\n", 1},
        {"$ echo 12\n13\n", 1},
        {"$ echo position_bound_m: 1e-12\nposition_bound_m: 1.5e-12\n", 0},
        {"$ echo position_bound_m: 1e-12\nposition_bound_m: 3e-12\n", 1},
        {"nothing\n", 1},
        {"$ echo 1.00004 N\n1.00014 N\n", 1},
        {"$ echo 1.00004 N\n-1.00004 N\n", 1},
        {"$ echo one\ntwo\n", 1},
        {"$ echo one\n", 1},
        {"$ echo one\none\ntwo\n", 1},
        {"$ false\n", 1},
        {"$ false\n[exit 1]\n", 0},
        {"$ echo one >&2\none\n", 1},
        {"$ hifdm help run | head -1\nhifdm run CASE [OPTION]...\n", 0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        SHELL(0, "rm -rf \"$1\" \"$1.tools\"", temp("work"));
        SHELL(rows[i].exit_code, "exec \"$1\" \"$2\" \"$3\" \"$0\" \"$4\"", python_program(),
              keep(source_path("tests/cli/transcript.py")), file_with("t.txt", rows[i].text), temp("work"));
    }
}
END_TEST

Suite *suite_cli_transcripts(void)
{
    Suite *suite = suite_create("cli/transcripts");
    TCase *tests = tcase_create("transcripts");
    tcase_add_loop_test(tests, it_says_what_it_said, 0, N_TRANSCRIPT);
    tcase_add_test(tests, every_transcript_is_in_the_list);
    tcase_add_test(tests, a_difference_is_noticed);
    suite_add_tcase(suite, tests);
    return suite;
}
