/* How a new user begins: `hifdm new` writes cases that run at once, `hifdm explain` knows every word that is said. */
#include "cli.h"

/* ---- hifdm new ---- */

static const struct {
    const char *option;
    int n_file;
} begun[] = {{NULL, 1}, {"--paraboloid", 1}, {"--cylinder", 1}, {"--import", 3}};

START_TEST(every_new_case_runs_without_a_warning)
{
    const char *name = temp("dish"), *path = temp("dish.yaml"),
               *other[2] = {temp("dish_nodes.csv"), temp("dish_cables.csv")};
    const char *option = begun[_i].option;
    if (option)
        HIFDM(0, "new", name, option);
    else
        HIFDM(0, "new", path); /* the name with its ending is taken for what it is */
    ck_assert_int_eq(count_of(said.out, " is written\n"), begun[_i].n_file);
    for (int k = 0; k < 2; k++)
        ck_assert_int_eq(is_there(other[k]), begun[_i].n_file == 3);
    HIFDM(0, "check", path);
    ck_assert_str_eq(said.err, "");
    HIFDM(0, "run", path, "-o", temp("dish.h5"), "--json");
    ck_assert_str_eq(said.err, "");
    EXPECT(out_as("dish.json"), "--", "a['warnings'] == [] and a['status'] == 'ok'",
           "a['refine']['objectives'] and a['refine']['merit'] < a['form']['merit'] if 'merit' in a['refine'] else "
           "a['refine']['psi_m'] < 0.99 * a['form']['psi_m']");
    HIFDM(0, "show", temp("dish.h5"));
    OUT("\n  case          dish\n");
}
END_TEST

/* What the new case has as a comment: errors that leave no cable slack, as it says, at 100 N also those of
 * 0.1 mm. */
START_TEST(what_a_new_case_suggests_is_good)
{
    static const char tight[] = "not a['tolerance']['with_slack_cables']";
    const char *out = temp("d.h5");
    HIFDM(0, "new", temp("dish"));
    SHELL(0,
          "cd \"$1\" && sed -i -E 's/^# (tolerance:.*samples: )1000/\\160/' dish.yaml && "
          "grep -c '^tolerance:' dish.yaml",
          temp(""));
    ck_assert_str_eq(said.out, "1\n");
    HIFDM(0, "run", temp("dish.yaml"), "-o", out, "--json");
    ck_assert_str_eq(said.err, "");
    EXPECT(out_as("d.json"), "--", tight, "a['refine']['merit'] < a['form']['merit']",
           /* the gain by physical optics rises with both feeds at both frequencies, and no node moves far */
           "all(new > old for feed in ('refocused', 'fixed') for new, old in zip(*(a[n]['surface'][feed + '_gain_dBi'] "
           "for n in ('refine', 'form'))))",
           "a['refine']['surface']['refocused_gain_dBi'][1] > a['form']['surface']['refocused_gain_dBi'][1] + 0.005",
           "a['refine']['psi_m'] < 1e-3");
    HIFDM(0, "run", temp("dish.yaml"), "-o", out, "--force", "--json", "--set", "tolerance.sigma_cut_m=1e-4", "--set",
          "form.pretension_N=100");
    EXPECT(out_as("d.json"), "--", tight);
    HIFDM(0, "run", temp("dish.yaml"), "-o", out, "--force", "--json", "--set", "tolerance.sigma_cut_m=1e-4");
    EXPECT(out_as("d.json"), "--", "a['tolerance']['with_slack_cables'] > 50");
}
END_TEST

/* An objective for a fixed feed lowers the gain with a refocused feed, and the summary reports this. The objective of a
 * new case does not. */
START_TEST(a_objective_that_costs_the_best_fit_is_told)
{
    static const char better[] = "for a refocused feed, the net of the form-finding is better";
    const char *out = temp("d.h5"), *path = temp("dish.yaml");
    HIFDM(0, "new", temp("dish"));
    HIFDM(0, "run", path, "-o", out, "--set", "optimize.objective=[{figure: facets, feed: fixed}]");
    ck_assert_int_eq(count_of(said.out, better), 1);
    EXPECT(file_with("said.txt", said.out), out, "--",
           "(lambda dB: dB['form'] < dB['refine'] and ('better: gain loss %.3g dB at 10 GHz. To minimise this error, "
           "use {figure: facets, feed: refocused} and {figure: psi, weight: 0.3}' % dB['form']).encode() in a)"
           "({n: b['surface/' + n + '/refocused_gain_loss_dB'][1] for n in ('form', 'refine')})");
    HIFDM(0, "run", path, "-o", out, "--force");
    ck_assert_str_eq(said.err, ""); /* nothing moves far */
    ck_assert_int_eq(count_of(said.out, better), 0);
}
END_TEST

/* The initial design under the rule of the case is another shape than the first row of the table: the summary, its
 * details and the file have the same psi of it, whichever stage is the result. */
START_TEST(the_gain_is_over_what_it_says)
{
    static const char gained[] =
        "(lambda of: abs(of - 1e3 * b['search'].attrs['initial_psi_m']) <= 5.1e-5 and abs(of - 1e3 * "
        "b['form'].attrs['psi_m']) %s)(float(a.split(b'lower than for the initial design (')[%d].split(b' mm)')[0]))";
    const char *out = temp("net.h5");
    HIFDM(0, "new", temp("net"), "--import");
    HIFDM(0, "run", temp("net.yaml"), "-o", out);
    EXPECT(file_with("said.txt", said.out), out, "--", keep(formatted(gained, "> 1", 1)));
    HIFDM(0, "show", out, "--verbose");
    OUT(" mm); found in generation");
    EXPECT(file_with("said.txt", said.out), out, "--", keep(formatted(gained, "> 1", 1)),
           keep(formatted(gained, "> 1", 2)));
    HIFDM(0, "run", temp("net.yaml"), "-o", out, "--force", "--set", "optimize.method=ga+lm");
    EXPECT(file_with("said.txt", said.out), out, "--", keep(formatted(gained, "> 1", 1)));
    HIFDM(0, "run", temp("net.yaml"), "-o", out, "--force", "--set", "optimize.method=lm");
    EXPECT(file_with("said.txt", said.out), out, "--", /* without a search psi of the initial design is unknown */
           "(lambda line: abs(float(line.split()[1]) - 1e3 * b['refine'].attrs['psi_m']) <= 5.1e-5 and abs(float("
           "line.split(b' nodes) after refinement, ')[1].split(b' lower than after form-finding (')[1]"
           ".split(b' mm)')[0]) - 1e3 * b['form'].attrs['psi_m']) <= 5.1e-5)(a.splitlines()[0])");
    HIFDM(0, "run", keep(source_path("configs/chen2022.yaml")), "-o", out, "--force", "--set",
          "optimize.generations=1");
    EXPECT(file_with("said.txt", said.out), out, "--", keep(formatted(gained, "<= 5.1e-5", 1)));
}
END_TEST

START_TEST(nothing_is_replaced)
{
    const char *table = file_with("mine_cables.csv", "precious\n"), *mine = temp("mine");
    HIFDM(5, "new", mine, "--import");
    ERRS("error: the file %s already exists", table);
    ck_assert(!is_there(temp("mine.yaml")) && !is_there(temp("mine_nodes.csv")));
    char *text = read_file(table, NULL);
    ck_assert_str_eq(text, "precious\n");
    free(text);
    HIFDM(0, "new", mine);
    HIFDM(5, "new", mine, "--cylinder");
    ERRS("error: the file %s.yaml already exists", mine);
    static const char *const bad[] = {"a b", "../.x", "-", "folder/", "q'", "@", "\xc3\xa9"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        HIFDM(2, "new", keep(formatted("%s/%s", temp("x"), bad[i])));
        ERR("the name of a new case may contain only letters, digits");
    }
    HIFDM(2, "new", temp("two"), "--paraboloid", "--cylinder");
    ERR("the option --cylinder cannot be combined with the export option before it");
    ck_assert(!is_there(temp("two.yaml")));
    HIFDM(2, "new");
    ERR("'hifdm new' needs the argument NAME");
}
END_TEST

/* ---- hifdm explain ---- */

/* The words that explain lists, with their texts: never nothing, never "the same". Each figure of JSON, each status and
 * each warning in the sources has an entry. Each figure of the glossary is in the sources. */
static const char look_up[] =
    "import json, re, subprocess, sys\n"
    "program, source, *results = sys.argv[1:]\n"
    "def explain(*word): return subprocess.run([program, 'explain', *word], capture_output=True, text=True)\n"
    "listed = explain().stdout\n"
    "words = {w.strip() for part in re.split(r'^[^ ].*?: ', listed, flags=re.M) for w in part.split(',')}\n"
    "words.discard('')\n"
    "seen = set()\n"
    "def demand(word, what):\n"
    "    if word in seen: return\n"
    "    seen.add(word)\n"
    "    got = explain(word)\n"
    "    if got.returncode: print(what, word, 'has no entry')\n"
    "    texts = [t.strip() for t in re.split(r'^[^ ].*$', got.stdout, flags=re.M) if t.strip()]\n"
    "    if not any(len(t) >= 12 and not t.startswith(('the same', 'The same')) for t in texts):\n"
    "        print(what, word, 'is told as', texts)\n"
    "for word in words: demand(word, 'listed')\n"
    "# objects whose names are those of the user, or of keys\n"
    "named = {'objectives', 'sets', 'load_cases', 'objective', 'multiplier', 'initial', 'kind_share', 'errors_m'}\n"
    "keys = set()\n"
    "def walk(o):\n"
    "    for v in o if isinstance(o, list) else []: walk(v)\n"
    "    for k, v in o.items() if isinstance(o, dict) else []:\n"
    "        keys.add(k)\n"
    "        for inner in v.values() if k in named and isinstance(v, dict) else [v]: walk(inner)\n"
    "for path in results: walk(json.load(open(path)))\n"
    "for key in sorted(keys): demand(key, 'figure')\n"
    "print(len(words), len(keys))\n"
    "status = open(source + '/include/hifdm/status.h').read()\n"
    "for word in re.findall(r'X\\([A-Z_]+, \\d+, \"(\\w+)\"', status): demand(word, 'status')\n"
    "import glob\n"
    "for file in glob.glob(source + '/src/*/*.c'):\n"
    "    text = open(file).read()\n"
    "    for call in re.findall(r'hf_warning\\(\\s*[^,\"]+,\\s*((?:\"(?:[^\"\\\\]|\\\\.)*\"\\s*)+)', text):\n"
    "        said = ''.join(re.findall(r'\"((?:[^\"\\\\]|\\\\.)*)\"', call))\n"
    "        if said in ('%s', '%.*s'): continue\n"
    "        if explain('warning: ' + said).returncode: print('warning', said, 'has no entry')\n"
    "files = glob.glob(source + '/src/*/*.[ch]') + glob.glob(source + '/include/hifdm/*.h')\n"
    "sources = ' '.join(open(file).read() for file in files)\n"
    "written = ' '.join(re.findall(r'\"(?:[^\"\\\\\\n]|\\\\.)*\"|X\\([^\"\\n]*', sources))\n"
    "kind = ''\n"
    "for part in re.split('^(?=##)', open(source + '/src/manual/glossary.md').read(), flags=re.M):\n"
    "    if part.startswith('## '): kind = (re.findall('^`(.*?)`', part, re.M) + [''])[0]\n"
    "    if not part.startswith('### ') or not re.match('figure|column|object', kind): continue\n"
    "    word, *others = part[4:].split('\\n')\n"
    "    former = [name for line in others if line.startswith('- Formerly: ') for name in line[12:].split(', ')]\n"
    "    names = [name.removeprefix('fit_').replace(' ', '_') for name in [word, *former]]\n"
    "    if not any(re.search(rf'\\b{re.escape(name)}\\b', written) for name in names):\n"
    "        print('entry', word, 'is no figure')\n";

START_TEST(every_word_is_explained)
{
    const char *chen = temp("chen.h5"), *front = temp("front.h5"), *built = temp("built.h5"),
               *states = temp("states.h5");
    const char *json[5];
    HIFDM(0, "run", keep(source_path("configs/chen2022-truss.yaml")), "-o", chen, "--json", "--set",
          "optimize.generations=3", "--set",
          "optimize.objective=[{figure: psi}, {figure: tension, set: edge, target: 30}]", "--set",
          "optimize.limits=[{figure: tension, set: boundary, bounds: [8, 200]}]", "--set", "surface={}");
    json[0] = out_as("chen.json");
    HIFDM(0, "run", keep(source_path("configs/chen2022.yaml")), "-o", front, "--json", "--set", "optimize.method=lm",
          "--set", "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}]", "--set",
          "optimize.front_points=5");
    json[1] = out_as("front.json");
    HIFDM(0, "run",
          file_with("built.yaml", SMALL_SCENE
                    "  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\ntolerance: {sigma_cut_m: 1e-4, "
                    "samples: 50, find_scale: true}\nrequirements: [{figure: psi, at_most: 1, share: 0.9}]\n"),
          "-o", built, "--json");
    json[2] = out_as("built.json");
    HIFDM(0, "run", keep(source_path("configs/paraboloid-load-cases.yaml")), "-o", states, "--json");
    json[3] = out_as("states.json");
    const char *measured = temp("m.csv");
    HIFDM(0, "export", built, "--csv", temp("shape"));
    SHELL(0,
          "awk -F, 'NR == 1 { print \"id,x_m,y_m,z_m\" } NR > 1 { print $1 \",\" $2 \",\" $3 \",\" "
          "$4 + (NR % 5 - 2) * 1e-4 }' \"$1\"/nodes.csv >\"$2\"",
          temp("shape"), measured);
    HIFDM(0, "adjust",
          file_with("workshop.yaml", SMALL_SCENE
                    "  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\ntolerance: {sigma_cut_m: 1e-4, sigma_cut_ratio: 1e-4, "
                    "batch: 0.5}\nadjust: {set: inner, range_m: 1e-3, step_m: 1e-4, sigma_m: 2e-4}\n"),
          "--measured", measured, "--json", "-o", temp("moves.csv"), "--result", built);
    json[4] = out_as("workshop.json");
    SHELL(0, "OMP_WAIT_POLICY=passive \"$1\" \"$2\" \"$0\" \"$3\" \"$4\" \"$5\" \"$6\" \"$7\" \"$8\"", python_program(),
          file_with("look_up.py", look_up), keep(source_path("")), json[0], json[1], json[2], json[3], json[4]);
    int n_word = 0, n_key = 0, end = 0;
    sscanf(said.out, "%d %d\n%n", &n_word, &n_key, &end);
    ck_assert_msg(n_word > 200 && n_key > 150 && !said.out[end], "%s", said.out);
}
END_TEST

/* What the summary and the report say, as a newcomer would type it: plural, with capitals, without units. */
START_TEST(words_of_the_summary_are_explained)
{
    static const char *const word[] = {"drift",
                                       "gives way",
                                       "Linear theory",
                                       "on its truss",
                                       "half-path RMS",
                                       "loss of gain",
                                       "after best fit",
                                       "the result",
                                       "variables",
                                       "free nodes",
                                       "inner nodes",
                                       "attachments",
                                       "rounds",
                                       "last step",
                                       "pretensions",
                                       "form-finding's tensions",
                                       "ties",
                                       "dB",
                                       "stopped by",
                                       "settled",
                                       "dominated",
                                       "slope",
                                       "first sidelobe",
                                       "half power",
                                       "physical optics",
                                       "objectives",
                                       "unstressed length",
                                       "turnbuckle moves",
                                       "normal rms",
                                       "stages",
                                       "mesh tension",
                                       "slack cables",
                                       "Facets",
                                       "members",
                                       "d psi / d T"};
    for (size_t k = 0; k < sizeof word / sizeof *word; k++)
        HIFDM(0, "explain", word[k]);
    HIFDM(0, "explain", "give way");
    OUT("deflection (term, m)\n    Formerly \"gives way\", \"give way\".\n");
    HIFDM(0, "explain", "at bounds");
    OUT("a wider range only moves these nodes farther");
    OUT("What to do: If only a few design variables are at bounds");
    HIFDM(2, "explain", "nonsenses");
}
END_TEST

START_TEST(explain_helps_with_slips)
{
    HIFDM(0, "explain", "straight_chain");
    OUT("straight_chain (status; exit status 4)\n    A straight chain of cables with fixed lengths");
    OUT("\n    What to do: Set a scallop");
    HIFDM(0, "explain", "warning: these cables of the form-finding shape are slack (1): c7");
    OUT("slack_cables (warning)\n");
    ck_assert_int_eq(count_of(said.out, "("), 1);
    static const char *const as_said[][2] = {
        {"Straight-Chain", "straight_chain (status; exit status 4)"},
        {"levenberg marquardt", "LM (term)"},
        {"lm", "LM (term)"},
        {"ruze", "Ruze (term)"},
        {"chi^2", "chi_square (term)"},
        {"no: truss", "truss (bound_reason)"},
        {"ea", "EA (term, N)"},
        {"slack-cable", "slack cable (term)"},
        {"exit status 75", "75 (exit status)\n    told to stop\ninterrupted (status"},
        {"75", "75 (exit status)\n"}};
    for (size_t i = 0; i < sizeof as_said / sizeof *as_said; i++) {
        HIFDM(0, "explain", as_said[i][0]);
        OUT(as_said[i][1]);
    }
    HIFDM(0, "explain", "best", "fit");
    OUT("best fit (term)\n");
    HIFDM(0, "explain", "drift", "facets"); /* nothing together */
    OUT("drift (term)\n");
    OUT("facets (term, m)\n");
    HIFDM(0, "explain", "turnbuckle", "cut list"); /* a term of two words stays one, quoted or not */
    OUT("turnbuckle (term)\n");
    OUT("cut list (term)\n");
    const char *quoted = file_with("quoted.txt", said.out);
    HIFDM(0, "explain", "turnbuckle", "cut", "list");
    EXPECT(quoted, file_with("plain.txt", said.out), "--", "a == b");
    HIFDM(2, "explain", "drift gobbledygook");
    OUT("drift (term)\n");
    ERR("the glossary has no entry 'gobbledygook'. ");
    HIFDM(0, "explain", "good to"); /* names of earlier versions */
    ck_assert_int_eq(count_of(said.out, "1 dB gain loss (term)\n"), 1);
    HIFDM(0, "explain", "good_to_Hz");
    OUT("gain_loss_1dB_Hz (figure of a merged study, Hz)\n    Formerly \"good_to_Hz\".\n");
    HIFDM(0, "explain", "adjustment_m");
    OUT("unstressed_minus_target_m (column of cut lists, m)\n");
    HIFDM(0, "explain", "boundary ratio");
    OUT("boundary_tension_ratio");
    static const char *const asked[] = {"goal",    "facets",   "evenness",   "limits",   "range", "rings",
                                        "cutlist", "cut list", "turnbuckle", "gain",     "RMS",   "sweep",
                                        "point",   "merge",    "psi_by_cut", "by a turn"};
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++)
        HIFDM(0, "explain", asked[i]);
    HIFDM(0, "explain", "front_points");
    OUT("optimize.front_points (key of the case file)\n");
    HIFDM(0, "explain", "requirements.at_most");
    OUT("requirements.at_most (key of the case file");
    HIFDM(2, "explain", "best", "fitt");
    ERR("the glossary has no entry 'best fitt'; did you mean 'best fit'?");
    HIFDM(2, "explain", "rope");
    ERR("the glossary has no entry 'rope'. 'hifdm explain' lists all entries");
    HIFDM(2, "explain", "residul_N");
    ERR("the glossary has no entry 'residul_N'; did you mean 'residual_N'?");
    HIFDM(2, "explain", "gobbledygook");
    ERR("'hifdm explain' lists all entries");
}
END_TEST

/* On a terminal, where people read. */
START_TEST(messages_say_where_to_read_on)
{
    SHELL(0, "command -v script >/dev/null && echo yes || true", "");
    if (!strstr(said.out, "yes")) {
        skip_for_tool("cli/begin: messages on a terminal", "no script");
        return;
    }
    const char *chen = keep(source_path("configs/straight-edges.yaml"));
    SHELL(4, "script -qec \"\\\"$0\\\" run \\\"$1\\\" -o \\\"$2\\\" --set form.stop=residual\" /dev/null", chen,
          temp("c.h5"));
    OUT("`hifdm explain WORD` explains: straight_chain, loaded_chains\r\n");
    SHELL(0, "script -qec \"\\\"$0\\\" run \\\"$1\\\" -o \\\"$2\\\" --set optimize.generations=1\" /dev/null", chen,
          temp("c.h5"));
    OUT("`hifdm explain WORD` explains: loaded_chains, stopped_early\r\n");
    HIFDM(0, "show", temp("c.h5"));
    ck_assert_ptr_null(strstr(said.err, "explain"));
}
END_TEST

Suite *suite_cli_begin(void)
{
    Suite *suite = suite_create("cli/begin");
    TCase *tcase = tcase_create("begin");
    tcase_add_loop_test(tcase, every_new_case_runs_without_a_warning, 0, sizeof begun / sizeof *begun);
    tcase_add_test(tcase, what_a_new_case_suggests_is_good);
    tcase_add_test(tcase, a_objective_that_costs_the_best_fit_is_told);
    tcase_add_test(tcase, the_gain_is_over_what_it_says);
    tcase_add_test(tcase, nothing_is_replaced);
    tcase_add_test(tcase, every_word_is_explained);
    tcase_add_test(tcase, words_of_the_summary_are_explained);
    tcase_add_test(tcase, explain_helps_with_slips);
    tcase_add_test(tcase, messages_say_where_to_read_on);
    suite_add_tcase(suite, tcase);
    return suite;
}
