/* What the program says of case files with faults: file, line, column and remedy of every fault in one run, exit code
 * 2, and no result is made. tests/unit/case/test_config_faults.c tests the faults one by one. */
#include "cli.h"

START_TEST(all_faults_of_a_file_are_told_in_one_run)
{
    const char *path = file_with("c.yaml", "title: x\n"
                                           "scene:\n"
                                           "  parabolic_cylinder:\n"
                                           "    aperture_m: 10 m\n"
                                           "    focal_length_m: -1\n"
                                           "    modules: [5, 5.5]\n"
                                           "    cells_per_module: 2\n"
                                           "    boundry: outer_edge\n"
                                           "form:\n"
                                           "  stop: Residual\n"
                                           "  pretension_N: 10\n"
                                           "  pretension_N: 11\n"
                                           "optimise: {}\n"
                                           "pretension_N: 1\n"
                                           "optimize: {population: 1, range_N: .nan, seed: 1e3}\n");
    HIFDM(2, "run", path, "-o", temp("c.h5"));
    static const char *const faults[] = {
        ":4:17: scene.parabolic_cylinder.aperture_m: must be a number, not a text; the unit is in the key's name\n",
        ":5:21: scene.parabolic_cylinder.focal_length_m: must be above 0 and at most 1000000000, not -1\n",
        ":6:18: scene.parabolic_cylinder.modules: must be a whole number, not 5.5\n",
        ":7:23: scene.parabolic_cylinder.cells_per_module: must be a list of two whole numbers, like [5, 5]\n",
        ":8:5: boundry: unknown key; did you mean 'boundary'?\n",
        ":10:9: form.stop: must be one of residual rms_change, not Residual; did you mean 'residual'?\n",
        ":12:3: pretension_N: this key stands here already, on line 11\n",
        ":13:1: optimise: unknown key; did you mean 'optimize'?\n",
        ":14:1: pretension_N: unknown key; did you mean 'form.pretension_N'?\n",
        ":15:24: optimize.population: must be at least 2 and at most 100000, not 1\n",
        ":15:36: optimize.range_N: must be a finite number, not .nan\n",
        ":15:48: optimize.seed: must be a whole number from 0 to 18446744073709551615\n",
        ": scene.parabolic_cylinder.length_m: is missing and has no default\n",
    };
    const size_t n = sizeof faults / sizeof *faults;
    for (size_t i = 0; i < n; i++)
        ERRS("error: %s%s", path, faults[i]);
    ck_assert_int_eq(count_of(said.err, "\n"), (int)n); /* nothing else */
    ck_assert(!is_there(temp("c.h5")));
    char *first = said.err;
    said.err = NULL;
    HIFDM(2, "check", path);
    ck_assert_str_eq(said.err, first);
    free(first);
}
END_TEST

/* Keys of a generator that ask for what cannot be made are named with their line. */
START_TEST(impossible_nets_are_refused)
{
    const char *path = file_with("c.yaml", "scene:\n"
                                           "  parabolic_cylinder:\n"
                                           "    aperture_m: 10\n"
                                           "    length_m: 12\n"
                                           "    focal_length_m: 5\n"
                                           "    modules: [2, 3]\n"
                                           "    cells_per_module: [2, 2]\n"
                                           "    pitches_x_m: [4, 5]\n"
                                           "    scallop: 0.39\n"
                                           "    edge_tie_m: 4\n");
    HIFDM(2, "check", path);
    ERRS("error: %s:8:18: scene.parabolic_cylinder.pitches_x_m: must add up to aperture_m, 10 m, and do to 9 m\n",
         path);
    HIFDM(2, "check", path, "--set", "scene.parabolic_cylinder.pitches_x_m=[4, 6]");
    ERRS("error: %s:10:17: scene.parabolic_cylinder.edge_tie_m: of 4 m must be shorter than the smallest module, 4 m\n",
         path);
    HIFDM(2, "check", path, "--set", "scene.parabolic_cylinder.pitches_x_m=[4, 6]", "--set",
          "scene.parabolic_cylinder.edge_tie_m=0.1");
    ERRS("error: %s:9:14: scene.parabolic_cylinder.scallop: of 0.39 moves edge nodes by 2.", path);
    HIFDM(2, "check", path, "--set", "scene.parabolic_cylinder.pitches_x_m=[4, 4, 2]");
    ERR("error: --set scene.parabolic_cylinder.pitches_x_m: must have a value for each of the 2 modules along x, and "
        "has "
        "3\n");
    HIFDM(2, "check", path, "--set", "scene.parabolic_cylinder.pitches_x_m=[10, 0]");
    ERR("scene.parabolic_cylinder.pitches_x_m: must be above 0 and at most 10000, not 0\n");
    HIFDM(2, "check", path, "--set", "scene.parabolic_cylinder.pattern=hexagon");
    ERR("scene.parabolic_cylinder.pattern: must be one of quad triangle diagonal alternating, not hexagon\n");
}
END_TEST

/* Rows of what varies, of goals and limits; tests/unit/case/test_config_rows.c has all their faults. */
START_TEST(faults_of_rows_are_told)
{
    const char *path = file_with("c.yaml", SMALL_SCENE "optimize:\n"
                                                       "  variables:\n"
                                                       "    - {set: boundary, vary: tensions, range: 30 %}\n"
                                                       "    - {set: edge, vary: length, range_N: 1}\n"
                                                       "  objective:\n"
                                                       "    - {weight: 0}\n");
    HIFDM(2, "run", path, "-o", temp("c.h5"));
    ERRS("error: %s:5:29: optimize.variables.0.vary: must be one of tension force_density length unstressed_length "
         "support_z support_normal support_xyz, not tensions; did you mean 'tension'?\n",
         path);
    ERRS("error: %s:6:33: range_N: unknown key; did you mean 'range'?\n", path);
    ERRS("error: %s:8:16: optimize.objective.0.weight: must be above 0, not 0\n", path);
    ERRS("error: %s:8:7: optimize.objective.0.figure: is missing and has no default\n", path);
    ck_assert_int_eq(count_of(said.err, "\n"), 4);
    ck_assert(!is_there(temp("c.h5")));
    path = file_with("c.yaml", SMALL_SCENE "optimize: {variables: [{set: edge, vary: length, range: 1}]}\n");
    HIFDM(2, "check", path, "--set", "optimize.variables.1.range=2", "--set", "optimize.variables.0.range=x");
    ERR("error: --set optimize.variables.1.range=2: optimize.variables.1.range: there is no such row: "
        "optimize.variables has 1, numbered from 0\n");
    ERR("error: --set optimize.variables.0.range=x: optimize.variables.0.range: must be a number, or a part like 30 %, "
        "not x\n");
}
END_TEST

/* What the net of the case does not have is told like what its reader finds, of all rows at once. */
START_TEST(rows_that_the_net_cannot_serve_have_their_places)
{
    const char *path =
        file_with("c.yaml", SMALL_SCENE "optimize:\n"
                                        "  symmetry: x\n"
                                        "  variables:\n"
                                        "    - {set: egde, vary: length, range: 1 %}\n"
                                        "    - {set: edge, vary: force_density, range: 1 %}\n"
                                        "    - set: boundary\n"
                                        "      vary: tension\n"
                                        "      range: 1\n"
                                        "    - {set: inner, vary: unstressed_length, range: 1 %}\n"
                                        "  limits:\n"
                                        "    - {figure: deflection, bounds: [0, 1]}\n"
                                        "    - {figure: ratio, set: diagonal, bounds: [1, 2]}\n"
                                        "  objective: [{figure: psi},\n"
                                        "    {figure: tension, set: tie, target: 1}, {figure: facets}]\n");
    HIFDM(2, "run", path, "-o", temp("c.h5"));
    ERRS("error: %s:6:13: optimize.variables.0.set: this net has no cable set 'egde'; did you mean 'edge'?\n", path);
    ERRS("error: %s:8:12: optimize.variables.2.set: cable 'n0_0-n1_0' is already a design variable of "
         "optimize.variables.1\n",
         path);
    ERRS("error: %s:11:26: optimize.variables.3.vary: cable 'n1_0-n1_1' of set inner has the law tension, but only "
         "cables with the law elastic have an unstressed length\n",
         path);
    ERRS("error: %s:13:16: optimize.limits.0.figure: a deflection limit needs a truss, because this limit applies to "
         "the attachments of a truss\n",
         path);
    ERRS("error: %s:14:28: optimize.limits.1.set: this net has no cable set 'diagonal'. The sets of this net are all, ",
         path);
    ERRS("error: %s:16:28: optimize.objective.1.set: this net has no cable set 'tie'. The sets of this net are all, "
         "inner, boundary",
         path);
    ERRS("error: %s:16:45: optimize.objective.2: facets: needs a target surface: add a section surface", path);
    ck_assert_int_eq(count_of(said.err, "\n"), 7);
    ck_assert(!is_there(temp("c.h5")));
    HIFDM(2, "check", path, "--set", "optimize.objective=[{figure: evenness, set: tie}]", "--set",
          "optimize.variables.0.set=edgy");
    ERR("error: --set optimize.objective.0.set: this net has no cable set 'tie'");
    ERR("error: --set optimize.variables.0.set: this net has no cable set 'edgy'; did you mean 'edge'?\n");
    path = file_with("c.yaml", SMALL_SCENE "optimize:\n"
                                           "  variables: [{set: edge, vary: length, range: 1 %, bounds: [9, 10]}]\n");
    HIFDM(2, "run", path, "-o", temp("c.h5"));
    ERRS("error: %s:4:15: optimize.variables.0: the design variable 'n0_0-n1_0' has the value ", path);
    ERR(" m after form-finding. The range around this value does not overlap the bounds of the design variable\n");
}
END_TEST

static const struct {
    const char *text, *error; /* behind "error: PATH" */
} unreadable[] = {
    {"", ":1:1: case: the file is empty\n"},
    {"# nothing\n", ":1:1: case: the file is empty\n"},
    {"just words\n", ":1:1: case: must be key: value lines\n"},
    {"- a\n- b\n", ":1:1: case: must be key: value lines\n"},
    {"title: \"no end\nscene: {}\n", ":3:1: YAML: found unexpected end of stream\n"},
    {"title: x\n\tscene: {}\n", ":2:1: YAML: a tab: lines are set in by blanks, and no tab stands before a value\n"},
    {"title: {a: 1\n", ":2:1: YAML: did not find expected ',' or '}'\n"},
    {SMALL_SCENE "---\n" SMALL_SCENE, ":3:1: YAML: a second document in this file; one case per file\n"},
    {SMALL_SCENE "title: *nowhere\n", ":3:8: YAML: found undefined alias\n"},
    {"title: x\n", ": scene: needs either parabolic_cylinder or paraboloid or import\n"},
    /* the place of what no reader of YAML accepts: Latin-1, and a control character */
    {SMALL_SCENE "title: \xfc"
                 "ber\n",
     ":3:8: YAML: invalid leading UTF-8 octet\n"},
    {SMALL_SCENE "title: \x01\n", ":3:8: YAML: control characters are not allowed\n"},
};
enum { N_UNREADABLE = sizeof unreadable / sizeof *unreadable };

START_TEST(impossible_paraboloids_are_refused)
{
    const char *path = file_with("c.yaml", "scene:\n"
                                           "  paraboloid:\n"
                                           "    aperture_m: 10\n"
                                           "    focal_length_m: 5\n"
                                           "    rings: 4\n"
                                           "    rear_distance_m: 2.5\n"
                                           "    tie_law: elastic\n");
    HIFDM(2, "check", path);
    ERRS("error: %s:6:22: scene.paraboloid.rear_distance_m: of 2.5 m lets the nets meet in the middle, where they come "
         "2.5 m nearer than at the rim\n",
         path);
    ERRS("error: %s:7:14: scene.paraboloid.tie_law: elastic needs scene.EA_inner_N, the stiffness of the ties\n", path);
    HIFDM(0, "check", path, "--set", "scene.paraboloid.rear_distance_m=2.6", "--set", "scene.EA_inner_N=1e5");
}
END_TEST

START_TEST(what_is_no_case_is_told)
{
    const char *path = file_with("c.yaml", unreadable[_i].text);
    HIFDM(2, "check", path);
    ERRS("error: %s%s", path, unreadable[_i].error);
    ck_assert_str_eq(said.out, "");
}
END_TEST

START_TEST(what_is_no_file_is_told)
{
    HIFDM(2, "run", temp("missing.yaml"), NOWHERE);
    ERRS("error: %s: cannot open: No such file or directory\n", temp("missing.yaml"));
    HIFDM(2, "run", temp("."), NOWHERE);
    ERR(": this is a folder. Give the name of a regular file\n");
    HIFDM(2, "run", "", NOWHERE);
    ERR("error: ");
    HIFDM(2, "check",
          file_with("binary.yaml", "\x7f"
                                   "ELF\x01\x02"));
    ERR("YAML: control characters are not allowed\n");
    SHELL(0, "head -c 2000000 /dev/zero | tr '\\0' x >\"$1\"; rm \"$2\"", temp("long.yaml"), temp("binary.yaml"));
    HIFDM(2, "check", temp("long.yaml"));
    ERR("this file is larger than 1024 kB, so it is not a case file\n");
    SHELL(0, "rm \"$1\"", temp("long.yaml"));
    SHELL(2, "\"$0\" check - </dev/null"); /* '-' is a file name like any other */
    ERR("error: -: cannot open: No such file or directory\n");
    SHELL(0, "cd \"$1\" && ls | grep -v '^command-' | wc -l | tr -d '\\n'", temp("."));
    ck_assert_str_eq(said.out, "0");
}
END_TEST

/* Every command that reads a text, of the file $2; $3 is in what each says. */
static const char read_it[] =
    "cd \"$1\" && f=\"$2\"; no=0\n"
    "scene() { printf 'scene:\\n  import: {nodes: %s, cables: %s%s}\\nsurface: {focal_length_m: 1}\\n' \"$@\"; }\n"
    "scene \"$f\" cables.csv '' >n.yaml; scene nodes.csv \"$f\" '' >e.yaml; scene nodes.csv cables.csv \", facets: "
    "$f\" "
    ">f.yaml\n"
    "printf 'base: %s\\nsweep: {form.pretension_N: [1, 2]}\\n' \"$f\" >b.yaml\n"
    "(cat full.yaml; printf 'load_cases:\\n  - {name: a, nodes: %s}\\n' \"$f\") >s.yaml\n"
    "(cat full.yaml; printf 'truss: {import: {nodes: %s, members: %s}}\\n' \"$f\" \"$f\") >t.yaml\n"
    "while read -r line; do\n"
    "    \"$0\" $line >out.txt 2>err.txt </dev/null\n"
    "    s=$?; if [ $s = 0 ] || [ $s -gt 5 ] || grep -q -e SECRET out.txt err.txt || ! grep -q \"$3\" err.txt; then\n"
    "        echo \"$s: hifdm $line\"; cat out.txt err.txt; no=1; fi\n"
    "done <<EOF\n"
    "run $f\ncheck $f\nevaluate $f --template x.csv\ntolerance $f\nadjust $f --measured $f\nsweep $f\nstatus $f\n"
    "merge $f\ncheck n.yaml\ncheck e.yaml\ncheck f.yaml\ncheck b.yaml\nsweep b.yaml\nmerge b.yaml --dir .\n"
    "check s.yaml\ncheck t.yaml\nevaluate full.yaml --designs $f\nadjust full.yaml --stage form --measured $f\nEOF\n"
    "exit $no";

static void make_readers(void)
{
    net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0,support\nc,1,1,0,inner\nd,1,2,0,support\n",
             "id,i,j,group,law,value\n1,a,c,inner,tension,\n2,b,c,inner,tension,\n3,c,d,inner,tension,\n");
    file_with("full.yaml",
              EA_SCENE "tolerance: {sigma_cut_m: 1e-4}\nadjust: {set: inner, range_m: 0.002, step_m: 0.0001}\n");
}

/* Pipes that nobody writes to, devices without an end: named before a byte is read of them, by each reader. */
START_TEST(what_is_no_ordinary_file_is_refused)
{
    const char *folder = temp("");
    make_readers();
    SHELL(0, "cd \"$1\" && mkfifo pipe && mkdir folder && truncate -s 1073741825 long", folder);
    static const char *const file[][2] = {{"pipe", "this is a pipe. Give the name of a regular file"},
                                          {"folder", "this is a folder. Give the name of a regular file"},
                                          {"/dev/zero", "this is a device. Give the name of a regular file"},
                                          {"long", "this file is larger than 1024 MB"}};
    SHELL(0, read_it, folder, file[_i][0], file[_i][1]);
    ck_assert_str_eq(said.out, "");
}
END_TEST

/* A file that is named by mistake, or by a program for somebody else, is not told in messages. */
START_TEST(what_is_no_case_is_not_quoted)
{
    static const char *const text[] = {
        "SECRETuser:SECRET$6$abc:19000:0:99999:7:::\nSECRETdaemon:*:19000:0:99999:7:::\n",
        "SECRETkey: SECRETvalue\nSECRETother: [SECRETa, SECRETb]\n",
        "[SECRETsection]\nSECRETpassword = \"SECRETx\"\n",
        "-----BEGIN SECRET KEY-----\nSECRETMIIEow\n-----END SECRET KEY-----\n",
        "SECRETuser,SECRETpw\nSECRETbob,SECRET123\n",
        "{\"SECRETkey\": {\"SECRETb\": 1}, \"SECRETkey\": 2}\n",
        "SECRETk: *SECRETalias\n",
        "\"SECRETkey: unclosed\n",
    };
    make_readers();
    file_with("it", text[_i]);
    SHELL(0, read_it, temp(""), "it", "error: ");
    ck_assert_str_eq(said.out, "");
}
END_TEST

START_TEST(settings_that_contradict_each_other_are_told)
{
    const char *path = file_with("c.yaml", SMALL_SCENE "optimize:\n"
                                                       "  population: 10\n"
                                                       "  elites: 10\n"
                                                       "  min_tension_N: 5\n"
                                                       "  max_tension_N: 5\n"
                                                       "  crossover_low: 0.95\n"
                                                       "  mutation_low: 0.2\n");
    HIFDM(2, "check", path);
    ERRS("error: %s:5:11: optimize.elites: must be below optimize.population\n", path);
    ERRS("error: %s:6:18: optimize.min_tension_N: must be below optimize.max_tension_N\n", path);
    ERRS("error: %s:8:18: optimize.crossover_low: must not be above optimize.crossover_high\n", path);
    ERRS("error: %s:9:17: optimize.mutation_low: must not be above optimize.mutation_high\n", path);
    ck_assert_int_eq(count_of(said.err, "\n"), 4);
    path = file_with("d.yaml", SMALL_SCENE "optimize:\n"
                                           "  rule: seeded\n"
                                           "  refine: true\n");
    HIFDM(2, "check", path);
    ERRS("error: %s:5:11: optimize.refine: cannot be true with optimize.rule seeded", path);
    HIFDM(0, "check", path, "--set", "optimize.refine=auto");
}
END_TEST

/* Anchors that refer to themselves, and one used twice, end where the keys end. */
START_TEST(aliases_do_not_lead_astray)
{
    HIFDM(2, "check", file_with("a.yaml", "scene: &s {parabolic_cylinder: *s}\n"));
    ERR(":1:12: parabolic_cylinder: unknown key");
    HIFDM(2, "check", file_with("b.yaml", "&r form: {}\nscene: &s {import: {nodes: n, cables: *s}}\n"));
    ERR(":2:8: scene.import.cables: must be a text\n");
}
END_TEST

Suite *suite_cli_bad_case(void)
{
    Suite *suite = suite_create("cli/bad_case");
    TCase *tcase = tcase_create("bad_case");
    tcase_add_test(tcase, all_faults_of_a_file_are_told_in_one_run);
    tcase_add_test(tcase, impossible_nets_are_refused);
    tcase_add_test(tcase, faults_of_rows_are_told);
    tcase_add_test(tcase, rows_that_the_net_cannot_serve_have_their_places);
    tcase_add_test(tcase, impossible_paraboloids_are_refused);
    tcase_add_loop_test(tcase, what_is_no_case_is_told, 0, N_UNREADABLE);
    tcase_add_test(tcase, what_is_no_file_is_told);
    tcase_add_loop_test(tcase, what_is_no_ordinary_file_is_refused, 0, 4);
    tcase_add_loop_test(tcase, what_is_no_case_is_not_quoted, 0, 8);
    tcase_add_test(tcase, settings_that_contradict_each_other_are_told);
    tcase_add_test(tcase, aliases_do_not_lead_astray);
    suite_add_tcase(suite, tcase);
    return suite;
}
