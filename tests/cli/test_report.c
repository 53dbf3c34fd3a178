/* `hifdm report` writes one page that is complete, small, harmless, and holds the stored numbers. tests/browser tests
 * what the page looks like. */
#include "cli.h"

#define HOSTILE "</script><img src=x onerror=alert(1)><!-- & \\\" ]]>"

/* The tags that a browser's parser finds; <script> and <style> must open and close as often as they should. */
static const char well_formed[] = "import sys\n"
                                  "from html.parser import HTMLParser\n"
                                  "class Page(HTMLParser):\n"
                                  "    void, open, seen = {'meta'}, [], []\n"
                                  "    def handle_starttag(self, tag, attributes):\n"
                                  "        self.seen.append(tag)\n"
                                  "        assert not any(n.startswith('on') or n in ('src', 'srcset') for n, _ in "
                                  "attributes), attributes\n"
                                  "        if tag not in self.void: self.open.append(tag)\n"
                                  "    def handle_endtag(self, tag):\n"
                                  "        assert self.open.pop() == tag, tag\n"
                                  "page = Page()\n"
                                  "text = open(sys.argv[1], encoding='utf-8').read()\n"
                                  "page.feed(text); page.close()\n"
                                  "assert not page.open, page.open\n"
                                  "assert page.seen.count('script') == 2 and page.seen.count('style') == 1, page.seen\n"
                                  "assert 'img' not in page.seen and text.startswith('<!doctype html>')\n"
                                  "assert 'http://' not in text.replace('http://www.w3.org/2000/svg', '')\n"
                                  "assert 'https://' not in text and '@import' not in text and 'url(' not in "
                                  "text.replace('url(#', '')\n";

static void demand_well_formed(const char *page)
{
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(), well_formed, page);
}

/* The page keeps positions as they are, displacements and tensions in single precision. */
START_TEST(page_holds_the_stored_numbers)
{
    const char *out = temp("c.h5"), *page = temp("c.html");
    HIFDM(0, "run", CHEN, "-o", out, "--quiet", "--set", "optimize.generations=4");
    HIFDM(0, "report", out, "-o", page);
    OUT("c.h5: report in ");
    OUT(" kB)\n");
    demand_well_formed(page);
    EXPECT(data_of(page, "c.json"), out, "--", "[s['stage'] for s in a['shapes']] == ['form', 'search', 'refine']",
           "a['net']['node_id'] == texts(b['scene/node/id']) and a['net']['cable_id'] == texts(b['scene/cable/id'])",
           "a['net']['end'] == b['scene/cable/end'][:].ravel().tolist()",
           "a['net']['position_m'] == b['scene/node/position_m'][:].ravel().tolist()",
           "all(np.allclose(s['displacement_m'], (b[g]['position_m'][:] - b['scene/node/position_m'][:]).ravel(), "
           "rtol=1e-7, atol=0) for s, g in zip(a['shapes'], ('form', 'search', 'refine')))",
           "all(np.allclose(s[n], b[g][n][:], rtol=1e-7, atol=0) for s, g in zip(a['shapes'], ('form', 'search', "
           "'refine')) for n in ('tension_N', 'length_m'))",
           "len(a['history']['psi_m']) == a['history']['n'] == 67 and a['history']['stride'] == 1",
           "np.allclose(a['history']['psi_m'], b['form/history/psi_m'], rtol=1e-8)",
           "np.allclose(a['search']['best_psi_m'], b['search/population/best_psi_m'], rtol=1e-8)",
           "a['search']['n_infeasible'] == b['search/population/n_infeasible'][:].tolist()",
           "a['summary']['form']['psi_m'] == b['form'].attrs['psi_m']", "a['seed'] == '2022'",
           "len(a['summary']['warnings']) == 2",
           "{'host', 'compiler', 'git_describe', 'started_utc', 'sha256'} <= {p.split(': ')[0] for p in "
           "a['provenance']}",
           "'truss' not in a and 'coupling' not in a");
    SHELL(0, "test \"$(wc -c <\"$1\")\" -lt 1000000", page);
}
END_TEST

/* The answer of the page is the first line of the summary, also without scripts; then the gain losses. */
START_TEST(page_begins_with_the_answer)
{
    const char *out = temp("w.h5"), *page = temp("w.html"), *text = temp("w.txt");
    const char *path = file_with("w.yaml", SMALL_SCENE "surface: {frequencies_Hz: [2e9, 6e9]}\n");
    HIFDM(0, "run", path, "-o", out, "--quiet");
    HIFDM(0, "report", out, "-o", page);
    demand_well_formed(page);
    SHELL(0, "\"$0\" show \"$1\" >\"$2\"", out, text);
    EXPECT(data_of(page, "w.json"), text, page, "--",
           "a['answer'].startswith('psi ') and '; gain loss at 6 GHz ' in a['answer']",
           "b.decode().split('\\n')[0] == a['answer']", "a['gain_loss'].startswith('gain loss at 2/6 GHz: ')",
           "16 * ' ' + a['gain_loss'] in b.decode().split('\\n')",
           "'<noscript><p>' + a['answer'] + '</p></noscript>' in c.decode()");
    HIFDM(0, "run", file_with("n.yaml", SMALL_SCENE), "-o", out, "--quiet", "--force");
    HIFDM(0, "report", out, "-o", page, "--force");
    EXPECT(data_of(page, "n.json"), "--", "a['gain_loss'] == ''");
}
END_TEST

/* After a failed optimisation the form-finding's figures are no answer: the error leads, on the page, too. */
START_TEST(a_failed_optimisation_says_so_first)
{
    const char *out = temp("f.h5"), *page = temp("f.html"), *text = temp("f.txt"), *told = temp("f.run");
    const char *const method[] = {"lm", "ga"};
    const char *path = file_with("f.yaml", SMALL_SCENE "optimize: {range_N: 1e-6, population: 4, generations: 2, "
                                                       "boundary_ratio_cap: 1.0001}\n");
    for (int i = 0; i < 2; i++) {
        HIFDM(3, "run", path, "-o", out, "--force", "--set", keep(formatted("optimize.method=%s", method[i])));
        write_file(told, said.out);
        HIFDM(0, "report", out, "-o", page, "--force");
        demand_well_formed(page);
        SHELL(0, "\"$0\" show \"$1\" >\"$2\"", out, text);
        EXPECT(data_of(page, "f.json"), text, told, "--", "a['summary']['status'] == 'no_feasible'",
               "len(a['summary']['errors']) == 1",
               "a['answer'].startswith(f\"failed: {a['summary']['errors'][0]}; the form-finding has psi \")",
               "b.decode().split('\\n')[0] == a['answer']",
               /* after a run, the error is printed below its summary */
               "c.decode().startswith('failed: no design met the constraints; the form-finding has psi ')");
    }
    const char *const argv[] = {
        python_program(), "-c",
        "import h5py, sys, numpy as np; f = h5py.File(sys.argv[1], 'a')\n"
        "f.attrs['warnings'] = np.array(b'warning: error: a\\n', h5py.string_dtype('utf-8', 64))",
        out, NULL};
    demand_exit(run_command(20.0, argv), 0, "h5py", __LINE__);
    HIFDM(0, "show", out);
    ck_assert_int_eq(strncmp(said.out, "failed: no design met the constraints; the form-finding has psi ", 64), 0);
    HIFDM(3, "run", CHEN, "-o", out, "--force", "--quiet", "--set", "optimize.method=lm", "--set",
          "optimize.boundary_ratio_cap=1.0001", "--set", "optimize.range_N=1e-6");
    EXPECT(out, "--", "attribute(a, 'warnings').startswith('error: optimize: ')", /* what has no room is at the end */
           "'\\nwarning: ' in attribute(a, 'warnings')");
}
END_TEST

/* Of a long history a thousand values at most, the first and the last among them. */
START_TEST(long_histories_are_thinned)
{
    const char *out = temp("l.h5");
    HIFDM(0, "run",
          file_with("l.yaml", SMALL_SCENE "optimize: {population: 2, generations: 2501, stagnation_generations: 9999, "
                                          "refine_steps: 1}\n"),
          "-o", out, "--quiet");
    HIFDM(0, "report", out, "-o", temp("l.html"));
    EXPECT(data_of(temp("l.html"), "l.json"), out, "--", "a['search']['n'] == 2501 and a['search']['stride'] == 3",
           "len(a['search']['best_psi_m']) == 835",
           "near(a['search']['best_psi_m'][-1], b['search/population/best_psi_m'][-1], 1e-8)",
           "near(a['search']['mean_psi_m'][1], b['search/population/mean_psi_m'][3], 1e-8)");
}
END_TEST

/* What a case says is text wherever it appears: title, ids, warnings. */
START_TEST(nothing_in_a_case_becomes_markup)
{
    static const char nodes[] = "id,x_m,y_m,z_m,role\n"
                                "</script><img src=a>,0,0,0,support\n"
                                "</title><script>,2,0,0,support\n"
                                "<!--,1,0.5,0.1,inner\n"
                                "&lt;,1,1.7,0,support\n";
    static const char cables[] = "id,i,j,group,law,value\n"
                                 "</script ><img onerror=b>,</script><img src=a>,<!--,inner,tension,10\n"
                                 "<script>,</title><script>,<!--,inner,tension,10\n"
                                 "]]>,<!--,&lt;,inner,tension,0.0001\n";
    const char *path = net_with(nodes, cables), *out = temp("h.h5"), *page = temp("h.html");
    char *text = read_file(path, NULL);
    path = file_with("hostile.yaml", formatted("title: \"" HOSTILE "\"\n%s", text));
    free(text);
    HIFDM(0, "run", path, "-o", out);
    ERR("warning: "); /* a slack cable, named */
    HIFDM(0, "report", out, "-o", page);
    demand_well_formed(page);
    EXPECT(data_of(page, "h.json"), out, "--",
           "a['title'] == '</script><img src=x onerror=alert(1)><!-- & \"' + ' ]]>'",
           "a['net']['node_id'] == texts(b['scene/node/id']) and '<!--' in a['net']['node_id']",
           "a['net']['cable_id'] == texts(b['scene/cable/id'])");
    text = read_file(page, NULL);
    demand_part(text, "<title>&#60;/script&#62;&#60;img src=x onerror=alert(1)&#62;&#60;!-- &#38; ", __LINE__);
    free(text);
}
END_TEST

/* A stage that did not run is not on the page; neither is a shape that does not exist. */
START_TEST(missing_stages_are_absent)
{
    const char *out = temp("f.h5");
    HIFDM(0, "run", file_with("f.yaml", SMALL_SCENE), "-o", out, "--quiet");
    HIFDM(0, "report", out, "-o", temp("f.html"));
    EXPECT(data_of(temp("f.html"), "f.json"), "--", "[s['stage'] for s in a['shapes']] == ['form']",
           "'search' not in a", "'search' not in a['summary']", "a['title'] == 'f.yaml'");
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(),
          "import h5py, sys\nf = h5py.File(sys.argv[1], 'r+'); del f['form/tension_N'], f['form/history']", out);
    HIFDM(0, "report", out, "-o", temp("s.html"));
    demand_well_formed(temp("s.html"));
    EXPECT(data_of(temp("s.html"), "s.json"), "--", "a['shapes'] == []", "'history' not in a");
    HIFDM(3, "run", CHEN, "-o", temp("n.h5"), "--quiet", "--set", "form.max_iterations=3");
    HIFDM(0, "report", temp("n.h5"), "-o", temp("n.html"));
    EXPECT(data_of(temp("n.html"), "n.json"), "--",
           "[s['stage'] for s in a['shapes']] == ['form'] and 'search' not in a",
           "'did not converge in 3 iterations' in a['summary']['errors'][0]");
}
END_TEST

/* A line of the provenance is an attribute, whatever the attribute holds. */
START_TEST(an_attribute_forges_no_line)
{
    const char *out = temp("f.h5");
    HIFDM(0, "run", file_with("f.yaml", SMALL_SCENE), "-o", out, "--quiet");
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(),
          "import h5py, sys\nf = h5py.File(sys.argv[1], 'r+')\n"
          "f.attrs.create('host', b'here\\nrng: forged\\nsha256: forged', dtype=h5py.string_dtype('utf-8', 40))",
          out);
    HIFDM(0, "report", out, "-o", temp("f.html"));
    EXPECT(data_of(temp("f.html"), "f.json"), "--",
           "[p for p in a['provenance'] if p.startswith('host: here')] == "
           "['host: here\\\\nrng: forged\\\\nsha256: forged']",
           "len([p for p in a['provenance'] if p.startswith(('rng: ', 'sha256: '))]) == 2",
           "not any(p.endswith(': forged') and not p.startswith('host') for p in a['provenance'])");
}
END_TEST

START_TEST(truss_is_shown_when_there_is_one)
{
    const char *out = temp("t.h5");
    HIFDM(0, "run", keep(source_path("configs/straight-edges-truss.yaml")), "-o", out, "--quiet");
    HIFDM(0, "report", out, "-o", temp("t.html"));
    EXPECT(data_of(temp("t.html"), "t.json"), out, "--",
           "a['truss']['n_node'] == 132 and a['truss']['n_member'] == 336",
           "a['truss']['position_m'] == b['truss/node/position_m'][:].ravel().tolist()",
           "a['truss']['end'] == b['truss/member/end'][:].ravel().tolist()",
           "np.allclose(a['truss']['displacement_m'], b['truss/node/displacement'][:, :3].ravel(), rtol=1e-7, atol=0)");
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(),
          "import h5py, sys\nh5py.File(sys.argv[1], 'r+')['truss/member/end'][2, 1] = 132", out);
    HIFDM(5, "report", out, "-o", temp("t.html"), "--force");
    ERR("t.h5: this file is damaged, because the data set /truss/member/end refers to a missing node");
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(),
          "import h5py, sys\nf = h5py.File(sys.argv[1], 'r+'); del f['truss/member/end']; f['truss/member/end'] = "
          "'pinned'",
          out);
    HIFDM(5, "report", out, "-o", temp("t.html"), "--force");
    ERR("t.h5: this file is damaged: /truss/member/end is of another type");
}
END_TEST

/* A merged study as `hifdm merge` lays it out: three points, of which one failed and one is missing. With a second
 * argument it has the names and the format of version 0.2. */
static const char make_study[] =
    "import h5py, numpy as np, sys\n"
    "f = h5py.File(sys.argv[1], 'w')\n"
    "old = len(sys.argv) > 2\n"
    "f.attrs.create('program', b'hifdm', dtype=h5py.string_dtype('utf-8', 5)); f.attrs['format_version'] = "
    "np.int32(2 if old else 3)\n"
    "search, objective = ('points/ga/best_', 'goal_') if old else ('points/search/', 'objective_')\n"
    "text = lambda v: np.array([t.encode() for t in v], dtype=h5py.string_dtype('utf-8', max(map(len, v)) or 1))\n"
    "f['points/id'] = text(['a1', 'b2', 'c3'])\n"
    "f['points/reason'] = text(['', '</script><b>no', ''])\n"
    "f['points/status'] = np.array([0, 1, 7], dtype=h5py.enum_dtype({'ok': 0, 'not_converged': 1, 'not_evaluated': 7}, "
    "basetype='i1'))\n"
    "f['points/input/form.pretension_N'] = [8.0, 10.000000000000002, 12.5]\n"
    "f['points/input/optimize.seed'] = np.array([1, 2**53 + 1, 2**64 - 1], dtype='u8')\n"
    "f['points/input/form.method'] = text(['hifdm', 'newton', 'hifdm'])\n"
    "f['points/input/scene.parabolic_cylinder.modules'] = np.array([[5, 5], [5, 6], [5, 7]], dtype='i4')\n"
    "f['points/form/psi_m'] = [0.006, np.nan, np.nan]\n"
    "f['points/form/n_slack'] = np.array([2, 0, 0], dtype='i4')\n"
    "f[search + 'psi_m'] = [0.005, np.nan, np.nan]\n"
    "f['points/form/' + objective + '0_psi'] = [0.006, np.nan, np.nan]\n"
    "f[search + objective + '1_tension_edge'] = [3.5, np.nan, np.nan]\n"
    "f[search + objective * 50] = [1.0, 2.0, 3.0]\n" /* no objective of ours */
    "f['points/surface/' + ('optimize' if old else 'search') + '/fit_' + ('good_to' if old else 'gain_loss_1dB') + "
    "'_Hz'] = [4e9, np.nan, np.nan]\n"
    "f['points/' + ('cases' if old else 'load_cases') + '/best_goal_1/n_slack'] = np.array([1, 0, 0], dtype='i4')\n"
    "f['runs/a1'] = h5py.ExternalLink('s.d/a1.h5', '/')\n"
    "f['runs/b2'] = h5py.ExternalLink('s.d/b2.h5', '/')\n";

START_TEST(merged_study_is_a_page_of_points)
{
    const char *merged = temp("s.h5"), *page = temp("s.html");
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(), make_study, merged);
    SHELL(0, "mkdir \"$1\" && touch \"$1/a1.h5\" \"$1/a1.html\"", temp("s.d"));
    HIFDM(0, "report", merged, "-o", page);
    demand_well_formed(page);
    const char *data = data_of(page, "s.json");
    EXPECT(data, "--", "a['title'] == 's.h5' and a['study']['n'] == 3 and a['study']['id'] == ['a1', 'b2', 'c3']",
           "a['study']['status'] == ['ok', 'not_converged', 'not_evaluated']",
           "a['study']['reason'] == ['', '</script><b>no', '']",
           "a['study']['file'] == ['s.d/a1.h5', '', ''] and a['study']['page'] == ['s.d/a1.html', '', '']",
           "{i['name']: i.get('texts') or i['values'] for i in a['study']['input']} == {'form.method': ['hifdm', "
           "'newton', 'hifdm'], 'form.pretension_N': [8, 10.000000000000002, 12.5], 'optimize.seed': ['1', "
           "'9007199254740993', "
           "'18446744073709551615'], 'scene.parabolic_cylinder.modules': [5, 5, 5, 6, 5, 7]}",
           "a['study']['output'] == [{'stage': 'form', 'psi_m': [0.006, None, None], 'n_slack': [2, 0, 0], "
           "'objective_0_psi': [0.006, None, None]}, {'stage': 'search', 'psi_m': [0.005, None, None], "
           "'objective_1_tension_edge': [3.5, None, None], 'fit_gain_loss_1dB_Hz': [4e9, None, None]}]",
           "a['study']['main'] == 'search'",
           "[(g['stage'], g['key'], g['unit']) for g in a['study']['figure'] if g['stage'].startswith('load')] == "
           "[('load case best_goal_1', 'n_slack', '')]");
    /* that of version 0.2 has the same page */
    SHELL(0, "cp \"$1\" \"$1.new\"", page);
    SHELL(0, "\"$1\" -c \"$2\" \"$3\" old", python_program(), make_study, merged);
    HIFDM(0, "report", merged, "-o", page, "--force");
    SHELL(0, "cmp \"$1\" \"$1.new\"", page);
    /* from another folder: absolute paths */
    SHELL(0, "mkdir \"$1\"", temp("elsewhere"));
    HIFDM(0, "report", merged, "-o", temp("elsewhere/s.html"));
    EXPECT(data_of(temp("elsewhere/s.html"), "e.json"), "--",
           "a['study']['file'][0].startswith('/') and a['study']['file'][0].endswith('/s.d/a1.h5')");
    /* damaged: fewer names than points, an axis that is no number, a status without a word */
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(),
          "import h5py, sys\nf = h5py.File(sys.argv[1], 'r+'); f.create_group('points/input/x')", merged);
    HIFDM(5, "report", merged, "-o", page, "--force");
    ERR("s.h5: ");
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(),
          "import h5py, sys\nf = h5py.File(sys.argv[1], 'r+'); del f['points/id'], f['points/input/x']", merged);
    HIFDM(5, "report", merged, "-o", page, "--force");
    ERR("s.h5: this file is damaged, because the data set /points/id does not contain every point");
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(), make_study, merged);
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(),
          "import h5py, sys\nf = h5py.File(sys.argv[1], 'r+'); f['points/status'][1] = -1", merged);
    HIFDM(5, "report", merged, "-o", page, "--force");
    ERR("s.h5: this file is damaged, because the data set /points/status");
}
END_TEST

/* Beside another result: both cases and summaries, and shapes where the nets are the same. */
START_TEST(two_results_are_compared)
{
    const char *first = temp("a.h5"), *second = temp("b.h5"), *page = temp("ab.html");
    const char *scene = file_with("r.yaml", SMALL_SCENE);
    HIFDM(0, "run", scene, "-o", first, "--quiet");
    HIFDM(0, "run", scene, "--set", "form.pretension_N=12", "-o", second, "--quiet");
    HIFDM(0, "report", first, second, "-o", page);
    demand_well_formed(page);
    EXPECT(data_of(page, "ab.json"), "--",
           "a['other']['summary']['file'].endswith('/b.h5') and a['other']['case_text'] == a['case_text']",
           "a['other']['overrides'] == ['form.pretension_N=12\\n'] and a['overrides'] == ['']",
           "[s['stage'] for s in a['other']['shapes']] == ['form']",
           "abs(a['other']['summary']['form']['psi_m'] - a['summary']['form']['psi_m']) < 1e-9",
           "abs(a['other']['shapes'][0]['tension_N'][0] / a['shapes'][0]['tension_N'][0] - 1.2) < 1e-6");
    HIFDM(0, "run", scene, "--set", "scene.parabolic_cylinder.modules=[3, 3]", "-o", second, "--restart", "--quiet");
    HIFDM(0, "report", first, second, "-o", page, "--force");
    EXPECT(data_of(page, "ab.json"), "--", "'shapes' not in a['other'] and a['other']['summary']['form']['psi_m'] > 0");
    SHELL(0, "cd \"$(dirname \"$1\")\" && mkdir x && cd x && \"$0\" report ../a.h5 ../b.h5 && ls -A", first);
    OUT("../a.h5 and ../b.h5: report in a_b.html");
    OUT("\na_b.html\n"); /* a.html is the page of a.h5 alone */
    HIFDM(5, "report", first, second, "-o", second, "--force");
    ERR("b.h5: this file is the result to compare with. Choose another name");
    HIFDM(5, "report", first, temp("missing.h5"), "-o", page, "--force");
    ERR("missing.h5: cannot open: No such file or directory");
    SHELL(0, "\"$1\" -c \"$2\" \"$3\"", python_program(), make_study, temp("s.h5"));
    HIFDM(2, "report", first, temp("s.h5"), "-o", page, "--force");
    ERR("s.h5 is a merged study, but hifdm report compares only two results");
}
END_TEST

START_TEST(files_are_not_replaced_unasked)
{
    const char *out = temp("r.h5"), *page = temp("r.html");
    HIFDM(0, "run", file_with("r.yaml", SMALL_SCENE), "-o", out, "--quiet");
    write_file(page, "mine");
    HIFDM(5, "report", out, "-o", page);
    ERRS("error: the file %s already exists. Use --force to replace it", page);
    ck_assert(file_is(page, "mine"));
    HIFDM(0, "report", out, "-o", page, "--force");
    SHELL(0, "cp \"$1\" \"$1.1\"", page);
    HIFDM(0, "report", out, "-o", page, "--force");
    SHELL(0, "cmp \"$1\" \"$1.1\"", page); /* the same file gives the same bytes */
    HIFDM(5, "report", out, "-o", out, "--force");
    ERR("r.h5: this file is the result itself. Choose another name");
    HIFDM(0, "show", out);
    SHELL(0, "cd \"$(dirname \"$1\")\" && mkdir x && cd x && \"$0\" report ../r.h5 && ls -A", out);
    OUT("report in r.html");
    OUT("\nr.html\n"); /* the default name, in the current folder; nothing temporary */
    HIFDM(5, "report", out, "-o", temp("no/such/folder.html"));
    ERR("cannot write: No such file or directory");
    HIFDM(5, "report", temp("missing.h5"));
    ERR("missing.h5: cannot open: No such file or directory");
    HIFDM(5, "report", CHEN, "-o", temp("y.html"));
    ERR("straight-edges.yaml: this file is not a result file (HDF5) but a case");
    HIFDM(2, "report");
    ERR("'hifdm report' needs the argument FILE");
    ck_assert(!is_there(temp("y.html")));
}
END_TEST

Suite *suite_cli_report(void)
{
    Suite *suite = suite_create("cli/report");
    TCase *tcase = tcase_create("report");
    tcase_add_test(tcase, page_holds_the_stored_numbers);
    tcase_add_test(tcase, page_begins_with_the_answer);
    tcase_add_test(tcase, a_failed_optimisation_says_so_first);
    tcase_add_test(tcase, long_histories_are_thinned);
    tcase_add_test(tcase, nothing_in_a_case_becomes_markup);
    tcase_add_test(tcase, missing_stages_are_absent);
    tcase_add_test(tcase, an_attribute_forges_no_line);
    tcase_add_test(tcase, truss_is_shown_when_there_is_one);
    tcase_add_test(tcase, merged_study_is_a_page_of_points);
    tcase_add_test(tcase, two_results_are_compared);
    tcase_add_test(tcase, files_are_not_replaced_unasked);
    suite_add_tcase(suite, tcase);
    return suite;
}
