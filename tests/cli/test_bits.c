/* The bits of results: checksums of all numbers, by group of the result file, in tests/verify/data/bits.txt; the same
 * on every processor. The measures of the surface are left out: their best fit is GSL's. A change of bits is a
 * decision: whoever wants it replaces the lines by those that this test prints, and says why. tools/same_bits.sh
 * compares processors, compilers and LAPACKs, tools/aarch64.sh another architecture. */
#include "cli.h"

static const char *const cases[][5] = {
    {"straight-edges", "configs/straight-edges.yaml", "optimize.generations=20", "optimize.compare_lm=true", NULL},
    {"straight-edges-truss", "configs/straight-edges-truss.yaml", "optimize.generations=10", "optimize.compare_lm=true",
     NULL},
    {"reflector", "configs/reflector.yaml", "optimize.generations=10", "optimize.method=ga+lm", NULL},
    {"triangles_a", NULL, "optimize.generations=20", "optimize.method=ga+lm", NULL},
};
enum { N_CASE = sizeof cases / sizeof *cases };

static const char *triangles(void)
{
    static const char *const file[] = {"nodes.csv", "cables.csv"};
    for (int i = 0; i < 2; i++)
        SHELL(0, "cp \"$1\" \"$2\"", keep(source_path(formatted("tests/verify/data/limits/triangles_a_%s", file[i]))),
              temp(file[i]));
    return file_with("net.yaml", "scene: {import: {nodes: nodes.csv, cables: cables.csv}}\n"
                                 "form: {method: hifdm, stop: rms_change}\noptimize: {range_N: 1, seed: 7}\n");
}

START_TEST(checksums)
{
    const char *const *c = cases[_i];
    const char *path = c[1] ? keep(source_path(c[1])) : triangles(), *result = temp("r.h5");
    HIFDM(0, "run", path, "-o", result, "--quiet", "--set", c[2], "--set", c[3]);
    EXPECT(result, source_path("tests/verify/data/bits.txt"), "--", formatted("bits_are(a, b, '%s')", c[0]));
}
END_TEST

Suite *suite_cli_bits(void)
{
    Suite *suite = suite_create("cli/bits");
    TCase *tests = tcase_create("bits");
    tcase_add_loop_test(tests, checksums, 0, N_CASE);
    suite_add_tcase(suite, tests);
    return suite;
}
