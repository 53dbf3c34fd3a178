/* Names and texts that try to command a terminal, reorder a line or forge a message: whatever people read shows them
 * escaped, what programs read keeps them. */
#include "cli.h"

/* ESC, bell, DEL, a C1 control, an override of the direction, an isolate, line separators, an end of line. */
#define EVIL "\x1b[31m\x07\x7f\xc2\x9b\xe2\x80\xae\xe2\x81\xa6\xe2\x80\xa8\nerror: forged"
#define EVIL_YAML "\\e[31m\\a\\x7f\\x9b\\u202e\\u2066\\L\\nerror: forged"
#define EVIL_PYTHON "\\x1b[31m\\a\\x7f\\x9b\\u202e\\u2066\\u2028\\nerror: forged"
#define EVIL_SHOWN "\\x1b[31m\\x07\\x7f\\u009b\\u202e\\u2066\\u2028\\nerror: forged"
#define EVIL_CELL "\x7f\xc2\x9b\xe2\x80\xae" /* what a cell of a table may hold of it */
#define EVIL_CELL_SHOWN "\\x7f\\u009b\\u202e"

/* Nothing but ends of lines and visible characters; written out a second time, apart from the code. */
static void demand_visible(const char *text, const char *words)
{
    static const char *const hidden[] = {"\xe2\x80\x8e", "\xe2\x80\x8f", "\xe2\x80\xa8", "\xe2\x80\xa9", "\xe2\x80\xaa",
                                         "\xe2\x80\xab", "\xe2\x80\xac", "\xe2\x80\xad", "\xe2\x80\xae", "\xe2\x81\xa6",
                                         "\xe2\x81\xa7", "\xe2\x81\xa8", "\xe2\x81\xa9", "\xd8\x9c"};
    for (const char *p = text; *p; p++) {
        ck_assert_msg((unsigned char)*p >= 0x20 || *p == '\n', "%s: a byte %d in\n%s", words, *p, text);
        ck_assert_msg(*p != 0x7f && strncmp(p, "\xc2\x9b", 2) != 0 && (unsigned char)*p != 0xff, "%s: %s", words, text);
    }
    for (size_t i = 0; i < sizeof hidden / sizeof *hidden; i++)
        ck_assert_msg(!strstr(text, hidden[i]), "%s: a hidden character in\n%s", words, text);
    ck_assert_msg(strncmp(text, "error: forged", 13) != 0 && !strstr(text, "\nerror: forged"), "%s: %s", words, text);
}

#define SHOWN(exit_code, ...)                                                                                          \
    do {                                                                                                               \
        HIFDM(exit_code, __VA_ARGS__);                                                                                 \
        demand_visible(said.out, #__VA_ARGS__);                                                                        \
        demand_visible(said.err, #__VA_ARGS__);                                                                        \
    } while (0)

START_TEST(the_command_line_is_shown)
{
    SHOWN(2, EVIL);
    ERR("error: unknown command '" EVIL_SHOWN "'");
    SHOWN(2, "run", "--" EVIL);
    ERR(EVIL_SHOWN);
    SHOWN(2, "run", EVIL, EVIL);
    ERR("error: '" EVIL_SHOWN "' is an unexpected argument");
    SHOWN(2, "run", CHEN, "--threads", EVIL);
    SHOWN(2, "run", CHEN, "--set", EVIL);
    SHOWN(2, "run", CHEN, "--set", "form.method=" EVIL);
    SHOWN(2, "run", CHEN, "--progress", EVIL);
    SHOWN(2, "sweep", EVIL, "--retry", EVIL);
    SHOWN(2, "run", EVIL "\xff");
    ERR("error: " EVIL_SHOWN "\\xff: cannot open");
    SHOWN(2, "check", EVIL);
    SHOWN(2, "sweep", EVIL);
    SHOWN(5, "show", EVIL);
    SHOWN(5, "diff", EVIL, EVIL);
    SHOWN(5, "report", EVIL);
    SHOWN(5, "export", EVIL, "--csv", EVIL);
    SHOWN(5, "recover", EVIL);
}
END_TEST

/* A title and names of files, over every command that takes a case or a result. */
START_TEST(titles_and_files_are_shown)
{
    const char *path = file_with(EVIL "\xff.yaml", SMALL_SCENE "  EA_inner_N: 1e5\n  EA_boundary_N: 1e5\n" SMALL_GA
                                                               "title: \"" EVIL_YAML "\"\n");
    const char *out = temp(EVIL ".h5"), *other = temp("other.h5"), *csv = temp(EVIL ".csv");
    SHOWN(0, "check", path);
    OUT(EVIL_SHOWN "\\xff.yaml: valid\n");
    SHOWN(0, "run", path, "-o", out);
    OUT("\n  case          " EVIL_SHOWN "\n");
    OUT("/" EVIL_SHOWN ".h5\n");
    SHOWN(0, "run", path, "-o", out);
    SHOWN(0, "show", out);
    OUT(EVIL_SHOWN "\n");
    HIFDM(0, "show", out, "--json");
    demand_visible(said.out, "show --json");
    EXPECT(out_as("show.json"), out, "--", "a['file'].endswith('/' + '" EVIL_PYTHON ".h5')",
           "a['case'].endswith('\\ufffd.yaml')", "attribute(b, 'title') == '" EVIL_PYTHON "'");
    SHOWN(0, "run", path, "-o", other, "--set", "optimize.seed=8", "--quiet");
    SHOWN(1, "diff", out, other);
    OUT(EVIL_SHOWN ".h5");
    SHOWN(0, "export", out, "--csv", temp(EVIL), "--vtk", temp(EVIL), "--cutlist", csv);
    OUT(EVIL_SHOWN);
    SHOWN(5, "export", out, "--csv", temp(EVIL));
    ERR(EVIL_SHOWN "/nodes.csv already exists");
    SHOWN(0, "evaluate", path, "--template", csv, "--force");
    SHOWN(0, "evaluate", path, "--designs", csv, "-o", temp(EVIL "2.csv"));
    SHOWN(0, "report", out, "-o", temp(EVIL ".html"));
}
END_TEST

START_TEST(studies_are_shown)
{
    file_with(EVIL ".yaml", SMALL_SCENE "form: {method: hifdm, stop: residual, max_iterations: 2}\n");
    const char *path = file_with(EVIL "s.yaml", "base: \"" EVIL_YAML ".yaml\"\nsweep:\n  title: [\"\\u202ea\", b]\n"
                                                "  form.pretension_N: [8, 9]\n");
    const char *folder = temp(EVIL ".d"), *merged = temp(EVIL ".h5");
    SHOWN(3, "sweep", path, "--dir", folder);
    OUT("results in ");
    SHOWN(0, "status", path, "--dir", folder);
    OUT(EVIL_SHOWN);
    HIFDM(0, "status", path, "--dir", folder, "--json");
    demand_visible(said.out, "status --json");
    EXPECT(out_as("status.json"), "--", "a['failed'] == 4", "'\\u202e' in a['failures'][0]['point']");
    SHOWN(0, "merge", path, "--dir", folder, "-o", merged);
    OUT(EVIL_SHOWN ".h5: 4 points");
    SHOWN(0, "report", merged, "-o", temp(EVIL ".html"));
    SHOWN(2, "sweep", file_with("faulty.yaml", "base: \"" EVIL_YAML ".yaml\"\nsweep:\n  \"" EVIL_YAML "\": [1]\n"));
    SHOWN(2, "sweep", file_with("lost.yaml", "base: \"" EVIL_YAML "\"\nsweep:\n  form.pretension_N: [1]\n"));
}
END_TEST

/* Keys and words of a case, ids of a net. */
START_TEST(faults_are_shown)
{
    SHOWN(2, "check",
          file_with("keys.yaml", SMALL_SCENE "\"" EVIL_YAML "\": 1\nform: {\"" EVIL_YAML "\": \"" EVIL_YAML
                                             "\", method: \"" EVIL_YAML "\"}\n"));
    ERR(":3:1: " EVIL_SHOWN ": unknown key");
    ERR(", not " EVIL_SHOWN "\n");
    SHOWN(2, "check",
          file_with("import.yaml", "scene:\n  import: {nodes: \"" EVIL_YAML "\", cables: \"" EVIL_YAML "\"}\n"));
    const char *net = net_with("id,x_m,y_m,z_m,role," EVIL_CELL "\na" EVIL_CELL ",0,0,0,support,\nb" EVIL_CELL
                               ",1,0,0.1,inner,\nc,2,0,0,support,\n",
                               "id,i,j,group,law,value\nab" EVIL_CELL ",a" EVIL_CELL ",b" EVIL_CELL
                               ",inner,tension,10\nbc,b" EVIL_CELL ",c,inner,tension,10\n");
    SHOWN(0, "run", net, "-o", temp("net.h5"));
    ERR("column '" EVIL_CELL_SHOWN "' is not used");
    HIFDM(0, "export", temp("net.h5"), "--csv", temp("net"));
    EXPECT(temp("net/nodes.csv"), "--", "a[0]['id'] == 'a\\x7f\\x9b\\u202e'");
    SHOWN(0, "show", temp("net.h5"));
    SHOWN(2, "export", temp("net.h5"), "--cutlist", temp("cut.csv"));
    ERR("One of these cables is 'ab" EVIL_CELL_SHOWN "'");
    net_with("id,x_m,y_m,z_m,role\na" EVIL_CELL ",nan,0,0,support\na" EVIL_CELL ",0,0,0," EVIL_CELL "\n",
             "id,i,j,group,law,value\nab," EVIL_CELL ",b,inner,tension,10\n");
    SHOWN(2, "run", net, NOWHERE);
    ERR("'a" EVIL_CELL_SHOWN "'");
}
END_TEST

/* A result file of someone else: the warnings in it are printed, and each stays a line. */
START_TEST(warnings_of_a_file_are_shown)
{
    const char *out = temp("a.h5");
    HIFDM(0, "run", file_with("a.yaml", SMALL_SCENE), "-o", out, "--quiet");
    const char *const argv[] = {
        python_program(), "-c",
        "import h5py, sys, numpy as np; f = h5py.File(sys.argv[1], 'a')\n"
        "f.attrs['warnings'] = "
        "np.array('warning: \\x1b[31m\\u202e\\nwarning: two\\n'.encode(), h5py.string_dtype('utf-8', 64))\n",
        out, NULL};
    demand_exit(run_command(20.0, argv), 0, "h5py", __LINE__);
    SHOWN(0, "show", out);
    OUT("\nwarning: \\x1b[31m\\u202e\nwarning: two\n");
}
END_TEST

/* What a spreadsheet would run is written so that it does not, and comes back: a net out and in again, with designs. */
START_TEST(formulas_are_no_formulas_in_tables)
{
    const char *net =
        net_with("id,x_m,y_m,z_m,role\n=1+1,0,0,0,support\n'@a,1,0,0.1,inner\n-c,2,0,0,support\n-2,1,1,0,support\n",
                 "id,i,j,group,law,value,EA_N\n=cmd|' /C calc'!A0,=1+1,'@a,inner,tension,10,1e5\n"
                 "+b,'@a,-c,boundary,tension,9,1e5\n-2,-2,'@a,boundary,tension,8,1e5\n");
    const char *out = temp("net.h5"), *again = temp("again.h5"), *designs = temp("d.csv");
    HIFDM(0, "run", net, "-o", out, "--quiet");
    EXPECT(out, "--", "texts(a['scene/node/id']) == ['=1+1', '@a', '-c', '-2']",
           "texts(a['scene/cable/id']) == [\"=cmd|' /C calc'!A0\", '+b', '-2']");
    HIFDM(0, "export", out, "--csv", temp("out"));
    EXPECT(temp("out/nodes.csv"), temp("out/cables.csv"), keep(source_path("src/manual/net-tables.md")), "--",
           "[r['id'] for r in a] == [\"'=1+1\", \"'@a\", \"'-c\", '-2']",
           "[r['j'] for r in b] == [\"'@a\", \"'-c\", \"'@a\"]",
           /* the expression of the manual */
           "[__import__('re').sub(next(l for l in c.decode().split('`') if l.startswith('re.sub')).split('\"')[1], '', "
           "r['id']) for r in a] == ['=1+1', '@a', '-c', '-2']");
    HIFDM(0, "evaluate", net, "--template", designs);
    SHELL(0, "head -n 1 \"$1\"", designs);
    ck_assert_str_eq(said.out, "id,'+b,-2\n");
    HIFDM(0, "evaluate", net, "--designs", designs);
    HIFDM(0, "export", out, "--cutlist", temp("cut.csv"));
    SHELL(0, "mv \"$1\" \"$2\"; mv \"$3\" \"$4\"", temp("cut.csv"), temp("cables.csv"), temp("cut_nodes.csv"),
          temp("nodes.csv"));
    HIFDM(0, "run", net, "-o", again, "--quiet");
    EXPECT(out, again, "--", "all(texts(a[f'scene/{k}/id']) == texts(b[f'scene/{k}/id']) for k in ('node', 'cable'))");
}
END_TEST

Suite *suite_cli_words(void)
{
    Suite *suite = suite_create("cli/words");
    TCase *tests = tcase_create("words");
    tcase_add_test(tests, the_command_line_is_shown);
    tcase_add_test(tests, titles_and_files_are_shown);
    tcase_add_test(tests, studies_are_shown);
    tcase_add_test(tests, faults_are_shown);
    tcase_add_test(tests, warnings_of_a_file_are_shown);
    tcase_add_test(tests, formulas_are_no_formulas_in_tables);
    suite_add_tcase(suite, tests);
    return suite;
}
