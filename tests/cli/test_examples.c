/* Code that users may copy works: the examples under tools/, built as a user builds them, and the code in the README
 * and the manual. */
#include "cli.h"

/* Two generations of the paper's case, which most of the examples name. */
static const char *chen_result(void)
{
    const char *out = temp("chen2022.h5");
    HIFDM(0, "run", CHEN, "-o", out, "--quiet", "--set", "optimize.generations=2", "--set", "optimize.refine_steps=2");
    return out;
}

/* ---- Python ---- */

/* A whole PNG with something in it; matplotlib keeps its caches in the test's own folder. */
#define READ_EXAMPLE_PY                                                                                                \
    "MPLCONFIGDIR=\"$1\" \"$2\" \"$3\" \"$4\" -o \"$5\" && "                                                           \
    "[ \"$(head -c 8 \"$5\" | od -An -tx1 | tr -d ' ')\" = 89504e470d0a1a0a ] && [ $(wc -c <\"$5\") -gt 20000 ]"

static bool has_matplotlib(void)
{
    const char *const argv[] = {python_program(), "-c", "import matplotlib", NULL};
    struct command command = run_command(HANG_S, argv);
    int exit_code = command.exit_code;
    free_command(&command);
    return exit_code == 0;
}

START_TEST(python_reads_and_draws_a_result)
{
    const char *out = chen_result(), *example = keep(source_path("tools/read_example.py"));
    if (!has_matplotlib()) { /* then it says what is missing */
        SHELL(1, "\"$1\" \"$2\" \"$3\"", python_program(), example, out);
        ERR("No module named 'matplotlib'");
        skip_for_tool("cli/examples: the picture of read_example.py", "no matplotlib");
        return;
    }
    SHELL(0, READ_EXAMPLE_PY, temp("cache"), python_program(), example, out, temp("picture.png"));
    OUT("12 m x 10 m parabolic cylinder, straight module edges\n  121 nodes, 220 cables\n");
    OUT("warning: the stopping rule rms_change ended the iteration before equilibrium");
    EXPECT(out, file_with("said.txt", said.out), "--",
           "('form-finding: psi %.4f mm' % (a['form'].attrs['psi_m'] * 1e3)).encode() in b",
           "('search: psi %.4f mm' % (a['search'].attrs['psi_m'] * 1e3)).encode() in b",
           "('refinement: psi %.4f mm' % (a['refine'].attrs['psi_m'] * 1e3)).encode() in b",
           "('2 generations, best psi %.4f -> %.4f mm' % tuple(a['search/population/best_psi_m'][:] * 1e3)).encode() "
           "in b");
    const char *form = temp("form.h5");
    HIFDM(0, "run", file_with("form.yaml", SMALL_SCENE), "-o", form, "--quiet");
    SHELL(0, READ_EXAMPLE_PY, temp("cache"), python_program(), example, form, temp("form.png"));
    ck_assert_ptr_null(strstr(said.out, "generations"));
}
END_TEST

/* ---- C ---- */

/* As the comment at the top of each example says, plus warnings. $1 prefix, $2 compiler, $3 source, $4 program. */
#define BUILD_SHARED                                                                                                   \
    "PKG_CONFIG_PATH=\"$1/lib/pkgconfig\"; export PKG_CONFIG_PATH; $2 -std=c11 -Wall -Wextra -Wpedantic -Werror "      \
    "\"$3\" $(pkg-config --cflags --libs hifdm) -lm -Wl,-rpath,\"$1/lib\" -o \"$4\""
#define BUILD_STATIC                                                                                                   \
    "PKG_CONFIG_PATH=\"$1/lib/pkgconfig\"; export PKG_CONFIG_PATH; $2 -std=c11 \"$3\" "                                \
    "$(pkg-config --static --cflags --libs hifdm | sed 's/-lhifdm/-l:libhifdm.a/') -o \"$4\""

static const char *built(const char *script, const char *name)
{
    const char *program = temp(name);
    const char *prefix = keep(installed_prefix()), *source = keep(source_path(formatted("tools/%s.c", name)));
    SHELL(0, script, prefix, c_compiler(), source, program);
    ck_assert_str_eq(said.err, "");
    return program;
}

/* The last line of the example: psi found, psi after form-finding, number of designs and cables. */
START_TEST(own_optimiser_finds_a_better_net)
{
    const char *program = built(BUILD_SHARED, "own_optimiser");
    SHELL(0, "OMP_WAIT_POLICY=passive \"$1\" \"$2\" | tail -n 1", program, CHEN);
    EXPECT(file_with("said.txt", said.out), chen_result(), "--", "len(a.split()) == 14",
           "abs(float(a.split()[4]) - b['form'].attrs['psi_m'] * 1e3) < 6e-5" /* four decimals */,
           /* it may go farther than range_N of the case, so it gets below the optimum in there */
           "float(a.split()[1]) < 6.3", "a.split()[9] == b'1920'");
}
END_TEST

/* The OpenMP that is read again is told how to wait; what the user has set is left alone. */
START_TEST(a_program_may_wait_quietly)
{
    static const char run[] =
        "env -u OMP_WAIT_POLICY -u GOMP_SPINCOUNT OMP_DISPLAY_ENV=VERBOSE $3 \"$1\" \"$2\" 2>&1 | "
        "grep -e GOMP_SPINCOUNT -e OMP_WAIT_POLICY | tr -d \"' \"";
    const char *program = built(BUILD_SHARED, "own_optimiser"), *path = file_with("small.yaml", SMALL_SCENE);
    SHELL(0, run, program, path, "");
    ck_assert_ptr_nonnull(strstr(said.out, "OMP_WAIT_POLICY=PASSIVE\n"));
    ck_assert_ptr_nonnull(strstr(said.out, "GOMP_SPINCOUNT=2000\n"));
    SHELL(0, run, program, path, "GOMP_SPINCOUNT=5");
    ck_assert_str_eq(said.out, "OMP_WAIT_POLICY=PASSIVE\nGOMP_SPINCOUNT=5\n");
    SHELL(0, run, program, path, "OMP_WAIT_POLICY=active");
    ck_assert_ptr_nonnull(strstr(said.out, "OMP_WAIT_POLICY=ACTIVE\n"));
    ck_assert_ptr_null(strstr(said.out, "2000"));
}
END_TEST

START_TEST(own_optimiser_tells_what_is_wrong)
{
    const char *program = built(BUILD_STATIC, "own_optimiser");
    SHELL(2, "\"$1\" \"$2\"", program, file_with("wrong.yaml", "scene: {}\nfrom: {}\n"));
    ERR("wrong.yaml:2:1: from: unknown key; did you mean 'form'?");
    SHELL(0, "OMP_WAIT_POLICY=passive \"$1\" \"$2\" | tail -n 1", program, file_with("small.yaml", SMALL_SCENE));
    OUT("psi ");
    SHELL(0, "OMP_WAIT_POLICY=passive \"$1\" \"$2\" | tail -n 1", program,
          keep(source_path("configs/straight-edges-truss.yaml")));
    OUT("psi ");
}
END_TEST

START_TEST(c_reads_a_result)
{
    const char *program = built(BUILD_SHARED, "read_example"), *out = chen_result();
    SHELL(0, "\"$1\" \"$2\"", program, out);
    EXPECT(file_with("said.txt", said.out), out, "--",
           "('psi %.4f mm after form-finding' % (b['form'].attrs['psi_m'] * 1e3)).encode() in a",
           "('psi %.4f mm after the search' % (b['search'].attrs['psi_m'] * 1e3)).encode() in a",
           "('psi %.4f mm after the refinement' % (b['refine'].attrs['psi_m'] * 1e3)).encode() in a",
           "a.count(b' is off by ') == 3",
           "('is off by %.4f mm' % (np.linalg.norm(b['form/position_m'][:] - b['scene/node/position_m'][:], axis=1)"
           "[b['scene/node/role'][:] == 1].max() * 1e3)).encode() in a.splitlines()[4]");
    SHELL(5, "\"$1\" \"$2\"", program, CHEN);
    ERR("is not an HDF5 file");
}
END_TEST

/* ---- C++ ---- */

static const char cpp_program[] =
    "#include <hifdm/hifdm.h>\n"
    "#include <cstdio>\n"
    "int main(int, char **argv)\n"
    "{\n"
    "    hf_messages said = {};\n"
    "    hf_problem p = {};\n"
    "    hf_status status = hf_problem_open(argv[1], nullptr, 0, 0, &p, &said);\n"
    "    std::printf(\"%d variables, psi %.4f mm\\n\", p.model.n_variable, p.form.psi_m * 1e3);\n"
    "    if (p.settings.form.method != HF_METHOD_HIFDM) std::puts(\"another method\");\n"
    "    hf_problem_free(&p);\n"
    "    hf_messages_free(&said);\n"
    "    return hf_status_exit_code(status);\n"
    "}\n";

#define BUILD_CPP                                                                                                      \
    "PKG_CONFIG_PATH=\"$1/lib/pkgconfig\"; export PKG_CONFIG_PATH; $2 -std=c++11 -Wall -Wextra -Wpedantic -Werror "    \
    "\"$3\" $(pkg-config --cflags --libs hifdm) -Wl,-rpath,\"$1/lib\" -o \"$4\""

/* The C++ compiler that belongs to ours: gcc, clang or cc with the same flags. */
START_TEST(the_library_serves_cpp)
{
    char compiler[512], *cc;
    snprintf(compiler, sizeof compiler, "%s", c_compiler());
    size_t word = strcspn(compiler, " ");
    const char *flags = keep(compiler + word);
    compiler[word] = '\0';
    if ((cc = strstr(compiler, "gcc")))
        memcpy(cc, "g++", 3);
    else
        strcpy(compiler, strstr(compiler, "clang") ? "clang++" : "c++");
    const char *const argv[] = {compiler, "--version", NULL};
    struct command there = run_command(HANG_S, argv);
    int exit_code = there.exit_code;
    free_command(&there);
    if (exit_code != 0) {
        skip_for_tool("cli/examples: the headers in C++", "no C++ compiler");
        return;
    }
    const char *program = temp("from_cpp");
    SHELL(0, BUILD_CPP, keep(installed_prefix()), keep(formatted("%s%s", compiler, flags)),
          file_with("from_cpp.cpp", cpp_program), program);
    ck_assert_str_eq(said.err, "");
    SHELL(0, "OMP_WAIT_POLICY=passive \"$1\" \"$2\"", program, CHEN);
    EXPECT(file_with("said.txt", said.out), chen_result(), "--", "a.split()[0] == b'%d' % b['ga/gene_cable'].shape[0]",
           "abs(float(a.split()[3]) - b['form'].attrs['psi_m'] * 1e3) < 6e-5", "b'another' not in a");
}
END_TEST

/* ---- README and manual ---- */

/* Every indented piece of the README that imports something is run twice, in a folder with the files that it names;
 * those with our package are run by tests/python/manual.py. */
START_TEST(pieces_of_readme_in_python_run)
{
    static const char run_pieces[] =
        "import re, subprocess, sys\n"
        "text = '\\n'.join(open(p).read() for p in sys.argv[1:])\n"
        "pieces = [re.sub('^    ', '', p, flags=re.M) for p in re.findall('(?:^    .*\\n)+', text, flags=re.M)]\n"
        "pieces = [p for p in pieces if re.search('^import (?!hifdm)', p, flags=re.M)]\n"
        "for p in pieces * 2:\n"
        "    subprocess.run([sys.executable, '-c', p], check=True)\n"
        "print(len(pieces))\n";
    const char *folder = temp("here"), *out = chen_result(), *script = file_with("pieces.py", run_pieces);
    SHELL(0, "mkdir -p \"$1/results\" && cp \"$2\" \"$1/results/\" && cp \"$3\" \"$1/case.yaml\"", folder, out,
          REFLECTOR);
    SHELL(0, "cd \"$1\" && PATH=$(dirname \"$0\"):$PATH OMP_WAIT_POLICY=passive \"$2\" \"$3\" \"$4\"", folder,
          python_program(), script, keep(source_path("README.md")));
    ck_assert_str_eq(said.out, "1\n"); /* pieces */
}
END_TEST

/* The pieces in C show lines of the examples that are built above. */
START_TEST(pieces_of_the_manual_in_c_are_those_of_the_examples)
{
    static const char compare[] =
        "import re, sys\n"
        "library, result_file, *examples = (open(p).read() for p in sys.argv[1:])\n"
        "pieces = re.findall('^```c\\n(.*?)^```', library + '\\n' + result_file, flags=re.M | re.S)\n"
        "lines = {' '.join(line.split()) for example in examples for line in example.splitlines()}\n"
        "print(len(pieces), [line for p in pieces for line in p.splitlines() if ' '.join(line.split()) not in "
        "lines])\n";
    SHELL(0, "\"$1\" \"$2\" \"$3\" \"$4\" \"$5\" \"$6\"", python_program(), file_with("compare.py", compare),
          keep(source_path("src/manual/library.md")), keep(source_path("src/manual/result-file.md")),
          keep(source_path("tools/own_optimiser.c")), keep(source_path("tools/read_example.c")));
    ck_assert_str_eq(said.out, "2 []\n");
}
END_TEST

/* Four meshes with edges that sag inward by 10 %. */
static const char recipe_nodes[] =
    "id,x_m,y_m,z_m,role\n"
    "sw,-1,-1,0.1,support\nse,1,-1,0.1,support\nne,1,1,0.1,support\nnw,-1,1,0.1,support\n"
    "s,0,-0.8,0,edge\ne,0.8,0,0.064,edge\nn,0,0.8,0,edge\nw,-0.8,0,0.064,edge\n"
    "c,0,0,0,inner\n";
static const char recipe_cables[] = "id,i,j,group,law,value,EA_N\n"
                                    "1,sw,s,boundary,length,,1e5\n2,s,se,boundary,length,,1e5\n"
                                    "3,se,e,boundary,length,,1e5\n4,e,ne,boundary,length,,1e5\n"
                                    "5,ne,n,boundary,length,,1e5\n6,n,nw,boundary,length,,1e5\n"
                                    "7,nw,w,boundary,length,,1e5\n8,w,sw,boundary,length,,1e5\n"
                                    "9,s,c,inner,tension,,1e5\n10,c,n,inner,tension,,1e5\n"
                                    "11,w,c,inner,tension,,1e5\n12,c,e,inner,tension,,1e5\n";

/* The case file and the commands of the first recipe, with a net such as a user may have. */
START_TEST(recipe_for_a_net_of_ones_own_works)
{
    static const char follow[] = "import re, subprocess, sys\n"
                                 "pieces = re.findall('(?:^    .*\\n)+', open(sys.argv[1]).read(), flags=re.M)\n"
                                 "case, = (p for p in pieces if 'import: {nodes' in p)\n"
                                 "commands, = (p for p in pieces if 'hifdm check net.yaml' in p)\n"
                                 "open('net.yaml', 'w').write(re.sub('^    ', '', case, flags=re.M))\n"
                                 "sys.exit(subprocess.run(['sh', '-euc', commands]).returncode)\n";
    const char *folder = temp("here");
    SHELL(0, "mkdir -p \"$1\"", folder);
    file_with("here/net_nodes.csv", recipe_nodes);
    file_with("here/net_cables.csv", recipe_cables);
    SHELL(0, "cd \"$1\" && PATH=$(dirname \"$0\"):$PATH OMP_WAIT_POLICY=passive \"$2\" \"$3\" \"$4\"", folder,
          python_program(), file_with("follow.py", follow), keep(source_path("README.md")));
    SHELL(0, "cd \"$1\" && wc -c net.h5 net.html net/nodes.csv net/search.hdf cut.csv", folder);
    HIFDM(0, "show", keep(formatted("%s/net.h5", folder)));
    OUT("9 nodes (5 free), 12 cables, 8 design variables");
}
END_TEST

/* The study of the second recipe, looked at but not run: 192 points of 400 generations are too many for a test. */
START_TEST(recipe_for_a_sweep_names_a_study_that_can_run)
{
    static const char take[] = "import re, sys\n"
                               "pieces = re.findall('(?:^    .*\\n)+', open(sys.argv[1]).read(), flags=re.M)\n"
                               "study, = (p for p in pieces if p.startswith('    base: chen2022.yaml\\n    sweep:'))\n"
                               "template, = re.findall(r'sbatch .* (\\S+) study.yaml', ''.join(pieces))\n"
                               "open(sys.argv[2] + '/study.yaml', 'w').write(re.sub('^    ', '', study, flags=re.M))\n"
                               "print(template)\n";
    const char *folder = temp("here");
    SHELL(0, "mkdir -p \"$1\" && cp \"$2\" \"$1/\"", folder, keep(source_path("configs/chen2022.yaml")));
    SHELL(0, "\"$1\" \"$2\" \"$3\" \"$4\"", python_program(), file_with("take.py", take),
          keep(source_path("README.md")), folder);
    ck_assert_str_eq(said.out, "tools/slurm/sweep.sbatch\n");
    ck_assert(is_there(keep(source_path("tools/slurm/sweep.sbatch"))));
    SHELL(0, "cd \"$1\" && \"$0\" status study.yaml", folder);
    OUT("192 points");
}
END_TEST

/* The case of ten lines prints what stands below it, but for times and for the names of files. */
START_TEST(first_case_says_what_the_readme_shows)
{
    static const char follow[] =
        "import re, subprocess, sys\n"
        "readme = open(sys.argv[2]).read()\n"
        "assert readme.count('\\n') <= 200, 'the README is to be short'\n"
        "pieces = [re.sub('^    ', '', p, flags=re.M) for p in re.findall('(?:^    .*\\n)+', readme, flags=re.M)]\n"
        "case, = (p for p in pieces if p.startswith('title: '))\n"
        "shown, = (p for p in pieces if '\\n  case  ' in p)\n"
        "assert case.count('\\n') == 10, 'the case is to have ten lines'\n"
        "open('dish.yaml', 'w').write(case)\n"
        "said = subprocess.run([sys.argv[1], 'run', 'dish.yaml'], capture_output=True, text=True)\n"
        "plain = lambda text: [re.sub(r'[\\d.]+ (us|ms|s)$', 'TIME', line) for line in text.splitlines()]\n"
        "said_lines = [line for line in plain(said.stdout) if not re.match('  (results|more) ', line)]\n"
        "sys.stdout.write('\\n'.join(a + ' | ' + b for a, b in zip(said_lines, plain(shown)) if a != b))\n"
        "assert not said.stderr and len(said_lines) == len(plain(shown)), said\n";
    const char *folder = temp("here");
    SHELL(0, "mkdir -p \"$1\"", folder);
    SHELL(0, "cd \"$1\" && OMP_WAIT_POLICY=passive \"$2\" \"$3\" \"$0\" \"$4\"", folder, python_program(),
          file_with("follow.py", follow), keep(source_path("README.md")));
    ck_assert_str_eq(said.out, "");
}
END_TEST

Suite *suite_cli_examples(void)
{
    Suite *suite = suite_create("cli/examples");
    TCase *tcase = tcase_create("examples");
    tcase_add_test(tcase, python_reads_and_draws_a_result);
    tcase_add_test(tcase, own_optimiser_finds_a_better_net);
    tcase_add_test(tcase, a_program_may_wait_quietly);
    tcase_add_test(tcase, own_optimiser_tells_what_is_wrong);
    tcase_add_test(tcase, c_reads_a_result);
    tcase_add_test(tcase, the_library_serves_cpp);
    tcase_add_test(tcase, pieces_of_readme_in_python_run);
    tcase_add_test(tcase, pieces_of_the_manual_in_c_are_those_of_the_examples);
    tcase_add_test(tcase, recipe_for_a_net_of_ones_own_works);
    tcase_add_test(tcase, first_case_says_what_the_readme_shows);
    tcase_add_test(tcase, recipe_for_a_sweep_names_a_study_that_can_run);
    suite_add_tcase(suite, tcase);
    return suite;
}
