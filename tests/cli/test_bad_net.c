/* What the program says of imported nets with faults: file, line and id of every fault in one run, exit code 2. */
#include "cli.h"

#define NODES                                                                                                          \
    "id,x_m,y_m,z_m,role\n"                                                                                            \
    "a,0,0,0,support\n"                                                                                                \
    "b,2,0,0,support\n"                                                                                                \
    "c,1,0.5,0.1,inner\n"                                                                                              \
    "d,1,1.7,0,support\n"
#define CABLES                                                                                                         \
    "id,i,j,group,law,value\n"                                                                                         \
    "ac,a,c,inner,tension,10\n"                                                                                        \
    "bc,b,c,inner,tension,10\n"                                                                                        \
    "cd,c,d,boundary,tension,12\n"

static const struct {
    const char *nodes, *cables, *error; /* what is said, with @ for the folder; ended by "\n" */
} faulty[] = {
    {"id,x_m,z_m,role\na,0,0,support\n", CABLES, "error: @nodes.csv:1: a column is missing: y_m\n"},
    {NODES, "id,i,j,grp,law,value\nac,a,c,inner,tension,10\n",
     "warning: @cables.csv:1: column 'grp' is not used\nerror: @cables.csv:1: a column is missing: group\n"},
    {"# measured in May\n\nid,x,y_m,z_m,role\na,0,0,0,support\n", CABLES,
     "warning: @nodes.csv:3: column 'x' is not used\n"
     "error: @nodes.csv:3: a column is missing: x_m\n"},
    {"id,x_m,y_m,z_m,role,x_m\na,0,0,0,support,1\n", CABLES, "error: @nodes.csv:1: this column stands twice: x_m\n"},
    {NODES, CABLES "ce,c,e,inner,tension,10\n", "error: @cables.csv:5: 'ce': there is no node with the id e\n"},
    {NODES "a,5,5,5,inner\n", CABLES "ac,a,d,inner,tension,1\n",
     "error: @nodes.csv:6: 'a': this id was used before, on line 2\n"
     "error: @cables.csv:5: 'ac': this id was used before, on line 2\n"},
    {NODES ",5,5,5,inner\n", CABLES, "error: @nodes.csv:6: the id is empty\n"},
    {NODES "e,nan,inf,1e999,inner\n", CABLES,
     "error: @nodes.csv:6: 'e': x_m must be a finite number, not nan\n"
     "error: @nodes.csv:6: 'e': y_m must be a finite number, not inf\n"
     "error: @nodes.csv:6: 'e': z_m must be a finite number, not 1e999\n"},
    {NODES "e,1,\"2,5\",0x1p3,Inner\n", CABLES,
     "error: @nodes.csv:6: 'e': y_m has a decimal comma, and numbers have points: 2,5\n"
     "error: @nodes.csv:6: 'e': z_m must be a finite number, not 0x1p3\n"},
    {NODES "e,1,2,0,iner\n", CABLES,
     "error: @nodes.csv:6: 'e': role must be one of support inner edge, not iner; did you mean 'inner'?\n"},
    {NODES "e,1,2,0,inner,7\n", CABLES, "error: @nodes.csv:6: 6 fields where the header has 5\n"},
    {NODES "\"e,1,2,0,inner\n", CABLES, "error: @nodes.csv:6: a quoted field does not end on this line\n"},
    {NODES "c2,1,0.5,0.1,inner\n", CABLES "cc,c,c2,inner,tension,1\ndd,d,d,inner,tension,1\n",
     "error: @cables.csv:5: cable 'cc' has zero length: its two nodes are at the same position\n"
     "error: @cables.csv:6: cable 'dd' joins a node to itself\n"},
    {NODES "e,9,9,9,inner\nf,9,8,9,edge\n", CABLES "ef,e,f,inner,tension,1\n",
     "error: @nodes.csv:6: node 'e' has no path of cables to a support; connect it or remove it\n"
     "error: @nodes.csv:7: node 'f' has no path of cables to a support; connect it or remove it\n"},
    {NODES, CABLES "e,a,c,inner,tension,0\nf,a,c,inner,length,-1\ng,a,c,inner,force_density,\n",
     "error: @cables.csv:5: 'e': value must be above zero for the law tension\n"
     "error: @cables.csv:6: 'f': value must be above zero for the law length\n"
     "error: @cables.csv:7: 'g': the law force_density needs a value in N/m\n"},
    {NODES, "id,i,j,group,law,value,EA_N\nac,a,c,inner,elastic,1e-300,1e5\nbc,b,c,inner,tension,10,\n",
     "error: @cables.csv:2: 'ac': value, the unstressed length, is less than 1e-12 of the distance of its ends for the "
     "law elastic\n"},
    {NODES, CABLES "e,a,c,inner,rubber,1\n",
     "error: @cables.csv:5: 'e': law must be one of tension length force_density elastic, not rubber\n"},
    {"", CABLES, "error: @nodes.csv:1: the file is empty: a header line is needed\n"},
    {"id,x_m,y_m,z_m,role\n", "", /* the faults of both files */
     "error: @nodes.csv:1: there is a header, but no rows\n"
     "error: @cables.csv:1: the file is empty: a header line is needed\n"},
    {"id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0,support\n", "id,i,j,group,law,value\nab,a,b,inner,tension,1\n",
     "error: scene: the net has no free nodes, because every node is a support\n"},
    {"id,x_m,y_m,z_m,role\na,0,0,0,inner\nb,1,0,0,inner\n", "id,i,j,group,law,value\nab,a,b,inner,tension,1\n",
     "error: scene: no node has the role 'support', so the net has no supports. Give the role 'support' to the nodes "
     "that do not move\n"},
    /* names of one's own */
    {NODES, "Name,From,To,group,law,value\nac,a,c,inner,tension,10\n",
     "warning: @cables.csv:1: column 'Name' is not used\n"
     "error: @cables.csv:1: the first line has to name the columns: id,i,j,group,law,value; missing are id,i,j\n"},
    {"\xff\xfei", CABLES, "error: @nodes.csv: this file contains UTF-16 text. Save the file as CSV UTF-8\n"},
    {"id,x_m,y_m,z_m,role\na,0,0,0,support\rb,1,0,0,support\n", CABLES,
     "error: @nodes.csv:2: a carriage return within the line; lines end with LF or CRLF\n"},
    {NODES "\x01,1,2,0,inner\n", CABLES,
     "error: @nodes.csv:6: not UTF-8 text, or a control character; save the file as UTF-8\n"},
    /* as a spreadsheet in half of Europe saves it */
    {"id;x_m;y_m;z_m;role\na;0;0;0;support\n", CABLES,
     "error: @nodes.csv:1: columns are separated by commas, not by ';', and numbers have points\n"},
    {"id,x_m,y_m,z_m,role\na,0,5,0,5,0,5,support\n", CABLES,
     "error: @nodes.csv:2: 8 fields where the header has 5: decimal commas? Numbers have points\n"},
    {"id\tx_m\ty_m\tz_m\trole\na\t0\t0\t0\tsupport\n", CABLES,
     "error: @nodes.csv:1: columns are separated by commas, not by tabs\n"},
    /* one mistake is told once */
    {"id,x_m,y_m,z_m,role\na,0,5,0,5,0,5,support\nb,0,6,0,5,0,5,support\nc,0,7,0,5,0,5,inner\nd,1,inner\n", CABLES,
     "error: @nodes.csv:2: 8 fields where the header has 5, here and on 2 more lines: decimal commas? Numbers have "
     "points\nerror: @nodes.csv:5: 3 fields where the header has 5\n"},
    {NODES "e,\"1,5\",\"2,5\",\"0,1\",inner\n", CABLES,
     "error: @nodes.csv:6: 'e': x_m has a decimal comma, and numbers have points: 1,5\nerror: @nodes.csv: 2 more "
     "numbers have decimal commas instead of decimal points\n"},
    /* that cables name the node `e` may be a consequence, and is told once; the node `f` is another matter */
    {NODES "d,5,5,5,inner\n", CABLES "ce,c,e,inner,tension,10\nde,d,e,inner,tensoin,10\ncf,c,f,inner,tension,10\n",
     "error: @nodes.csv:6: 'd': this id was used before, on line 5\n"
     "error: @cables.csv:5: 'ce': there is no node with the id e\n"
     "error: @cables.csv:6: 'de': law must be one of tension length force_density elastic, not tensoin; did you mean "
     "'tension'?\n"
     "error: @cables.csv:7: 'cf': there is no node with the id f\n"},
    {"a,0,0,0,support\nb,1,0,0,support\n", CABLES,
     "error: @nodes.csv:1: the first line has to name the columns: id,x_m,y_m,z_m,role\n"},
    /* texts in a result file are UTF-8, and so is JSON; this is Latin-1 */
    {NODES "caf\xe9,1,0.6,0.1,inner\n", CABLES "ce,c,caf\xe9,inner,tension,10\nde,d,caf\xe9,inner,tension,10\n",
     "error: @nodes.csv:6: "},
};
enum { N_FAULTY = sizeof faulty / sizeof *faulty };

/* Line by line, since the folder comes in between. */
START_TEST(faults_are_told_with_file_line_and_id)
{
    const char *path = net_with(faulty[_i].nodes, faulty[_i].cables), *folder = temp("");
    HIFDM(2, "run", path, "-o", temp("n.h5"));
    for (const char *line = faulty[_i].error; *line; line += strcspn(line, "\n"), line += *line == '\n') {
        int length = (int)strcspn(line, "\n"), head = (int)strcspn(line, "@\n");
        if (line[head] == '@')
            ERRS("%.*s%s%.*s", head, line, folder, length - head - 1, line + head + 1);
        else
            ERRS("%.*s\n", length, line);
    }
    ck_assert_int_ge(count_of(said.err, "\n"), count_of(faulty[_i].error, "\n"));
    ck_assert(!is_there(temp("n.h5")));
}
END_TEST

/* The path comes first in a message: were it cut, line and id would be missing. */
START_TEST(long_paths_leave_room_for_line_and_id)
{
    char folder[900];
    int n = snprintf(folder, sizeof folder, "%s", temp("deep"));
    for (; n < 700; n += 101)
        snprintf(folder + n, sizeof folder - (size_t)n, "/%0100d", 0);
    const char *path = net_with(NODES "c2,1,0.5,0.1,inner\n", CABLES "cc,c,c2,inner,tension,1\n");
    SHELL(0, "mkdir -p \"$1\" && mv \"$2\"/*.csv \"$2\"/net.yaml \"$1\"", folder, temp(""));
    SHELL(2, "\"$0\" check \"$1\"/net.yaml", folder);
    ERRS("error: %s/cables.csv:5: cable 'cc' has zero length", folder);
    ck_assert(!is_there(path));
}
END_TEST

START_TEST(long_lists_of_faults_are_cut)
{
    char cables[4096] = CABLES;
    for (int i = 0; i < 60; i++)
        snprintf(cables + strlen(cables), sizeof cables - strlen(cables), "x%d,a,c,inner,tension,zero\n", i);
    HIFDM(2, "check", net_with(NODES, cables));
    ck_assert_int_eq(count_of(said.err, "value must be a finite number, not zero"), 20);
    ERR("cables.csv: hifdm found 40 more faults in this file\n");
}
END_TEST

/* Long ids may be cut in messages and warnings; a letter of two bytes is not, or the JSON object would be none. Of ids
 * with and without a letter of one byte in front, one would be cut in the middle wherever the limits are. */
START_TEST(words_are_cut_between_letters)
{
    char id[251] = "x", nodes[2048], cables[16384];
    for (size_t i = 1; i + 2 < sizeof id; i += 2)
        memcpy(id + i, "\xc3\xa9", 3);
    for (int from = 0; from < 2; from++) {
        snprintf(nodes, sizeof nodes, "%s%s,9,9,9,inner\n", NODES, id + from);
        HIFDM(2, "run", net_with(nodes, CABLES), NOWHERE, "--json");
        EXPECT(out_as("error.json"), "--", "len(a['errors']) == 1");

        snprintf(cables, sizeof cables, "%s", CABLES); /* cables too long to carry anything: five are named as slack */
        for (int i = 0; i < 6; i++)
            snprintf(cables + strlen(cables), sizeof cables - strlen(cables), "%s%d,a,c,inner,length,5\n", id + from,
                     i);
        snprintf(nodes, sizeof nodes, "%.19s,%s%s", NODES, id + from,
                 "\na,0,0,0,support,1\nb,2,0,0,support,1\n"
                 "c,1,0.5,0.1,inner,1\nd,1,1.7,0,support,1\n");
        HIFDM(0, "run", net_with(nodes, cables), "-o", temp("long.h5"), "--force", "--json");
        EXPECT(out_as("run.json"), "--", "len([w for w in a['warnings'] if 'slack' in w]) == 1",
               "len([w for w in a['warnings'] if 'by its law' in w]) == 5", "len(a['warnings']) == 15");
        HIFDM(0, "show", temp("long.h5"), "--json");
        EXPECT(out_as("show.json"), "--", "len(a['warnings']) >= 1");
    }
}
END_TEST

START_TEST(missing_files_of_a_net_are_told)
{
    const char *path = net_with(NODES, CABLES);
    HIFDM(2, "check", path, "--set", "scene.import.nodes=/no/nodes.csv", "--set", "scene.import.cables=/no/cables.csv");
    ERR("error: /no/nodes.csv: cannot open: No such file or directory\n");
    ERR("error: /no/cables.csv: cannot open: No such file or directory\n");
    HIFDM(0, "check", path); /* relative to the case file, wherever the program is started */
}
END_TEST

/* What spreadsheets do to a file without breaking it. */
START_TEST(other_ways_to_write_a_table_are_read)
{
    static const char nodes[] = "\xEF\xBB\xBFrole, z_m ,id,x_m,y_m,note\r\n"
                                "\r\n"
                                "Support,0,a,0,0,\r\n"
                                "# a comment\r\n"
                                " support , +0.0 ,\"b\",2e0,0,\"a, note\"\r\n"
                                "inner,.1,c,1.,0.5,\r\n"
                                "support,0e5,d,1,17e-1,last";
    HIFDM(0, "run", net_with(nodes, CABLES), "-o", temp("one.h5"));
    ERR("nodes.csv:1: column 'note' is not used");
    HIFDM(0, "run", net_with(NODES, CABLES), "-o", temp("two.h5"));
    EXPECT(temp("one.h5"), temp("two.h5"), "--", "[n for n in differing(a, b) if not n.startswith('case/')] == []");
}
END_TEST

/* Random numbers between bounds need two of them. */
START_TEST(an_open_range_is_for_derivatives_alone)
{
    net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0,inner\nc,2,0,0,support\n",
             "id,i,j,group,law,value\nab,a,b,boundary,tension,10\nbc,b,c,inner,tension,10\n");
    const char *c =
        file_with("open.yaml", "scene:\n  import: {nodes: nodes.csv, cables: cables.csv}\n"
                               "optimize: {variables: [{set: all, vary: force_density, bounds: [1, .inf]}]}\n");
    HIFDM(2, "run", c, "-o", temp("open.h5"));
    ERRS("error: %s:3:24: optimize.variables.0: the design variable 'ab' has no bound on one side. Add the missing "
         "bound or a range for the genetic algorithm, or use optimize.method: lm\n",
         c);
    HIFDM(0, "run", c, "-o", temp("lm.h5"), "--set", "optimize.method=lm");
}
END_TEST

/* Nothing to start the optimisation from: the shape that was found is kept. */
START_TEST(a_shape_with_a_slack_boundary_cable_is_kept)
{
    const char *path = temp("slack.h5");
    net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,1,0,0,edge\nc,2,0,0,support\nd,1,1,0,inner\ne,1,3,0,support\n",
             "id,i,j,group,law,value,EA_N\nab,a,b,boundary,elastic,1.0,1e4\nbc,b,c,boundary,elastic,9.2,1e4\n"
             "bd,b,d,inner,tension,10,\nde,d,e,inner,tension,10,\nbc2,c,b,inner,elastic,1.0,1e4\n");
    const char *c = file_with("slack.yaml", "scene:\n  import: {nodes: nodes.csv, cables: cables.csv}\n" SMALL_GA);
    HIFDM(3, "run", c, "-o", path);
    ERR("error: optimize: boundary cable 'bc' has no tension after form-finding, so the search cannot start. Use a "
        "shorter length or a law that keeps this cable taut");
    OUT("\n  form          ");
    EXPECT(path, "--", "a.attrs['finished'] == 1", "a['form/tension_N'].shape == (5,)", "'search' not in a",
           "'ga' not in a");
    HIFDM(3, "run", c, "-o", path);
    ERR("is the finished result of this case");
    ERR("has no tension after form-finding");
    HIFDM(0, "export", path, "--csv", temp("csv"));
}
END_TEST

/* Values that no net has: what is named is a cable, and a quotient is no row of digits. */
START_TEST(numbers_that_run_away_are_told)
{
    const char *net = net_with(NODES, "id,i,j,group,law,value,EA_N\nac,a,c,inner,tension,10,\n"
                                      "bc,b,c,inner,elastic,1e308,1e5\ncd,c,d,boundary,tension,12,\n");
    HIFDM(4, "run", net, "-o", temp("far.h5"));
    ERR("error: ill-posed: the tension of cable 'ac' is no longer a finite number\n");
    net_with(NODES "e,1e200,0,0,inner\n", CABLES "ce,c,e,inner,tension,10\nbe,b,e,inner,tension,10\n");
    HIFDM(4, "check", net);
    ERR("node 'e' is 1e+200 m from the middle of the net, which is 5.88e+199 times as far as the other nodes");
}
END_TEST

/* form.pretension_N is told where a cable takes it: one whose law is tension and whose value is empty. */
START_TEST(a_pretension_that_no_cable_takes_is_not_told)
{
    static const char cables[] = "id,i,j,group,law,value\nac,a,c,inner,tension,10\nbc,b,c,inner,tension,\n"
                                 "cd,c,d,boundary,force_density,12\n";
    HIFDM(0, "run", net_with(NODES, CABLES), "-o", temp("own.h5"));
    OUT("4 nodes (1 free), 3 cables; each cable has a law of its own\n");
    HIFDM(0, "show", temp("own.h5"));
    OUT("; each cable has a law of its own\n");
    HIFDM(0, "report", temp("own.h5"), "-o", temp("own.html"));
    HIFDM(0, "run", net_with(NODES, cables), "-o", temp("one.h5"));
    OUT("; pretension 10 N\n");
    HIFDM(0, "report", temp("one.h5"), "-o", temp("one.html"));
    EXPECT(data_of(temp("own.html"), "own.json"), data_of(temp("one.html"), "one.json"), "--",
           "a['pretension_N'] is None and b['pretension_N'] == 10");
}
END_TEST

Suite *suite_cli_bad_net(void)
{
    Suite *suite = suite_create("cli/bad_net");
    TCase *tcase = tcase_create("bad_net");
    tcase_add_loop_test(tcase, faults_are_told_with_file_line_and_id, 0, N_FAULTY);
    tcase_add_test(tcase, long_lists_of_faults_are_cut);
    tcase_add_test(tcase, long_paths_leave_room_for_line_and_id);
    tcase_add_test(tcase, words_are_cut_between_letters);
    tcase_add_test(tcase, missing_files_of_a_net_are_told);
    tcase_add_test(tcase, an_open_range_is_for_derivatives_alone);
    tcase_add_test(tcase, a_shape_with_a_slack_boundary_cable_is_kept);
    tcase_add_test(tcase, numbers_that_run_away_are_told);
    tcase_add_test(tcase, a_pretension_that_no_cable_takes_is_not_told);
    tcase_add_test(tcase, other_ways_to_write_a_table_are_read);
    suite_add_tcase(suite, tcase);
    return suite;
}
