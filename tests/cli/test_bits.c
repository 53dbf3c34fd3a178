/* Checksums of all numbers in results, by group of the result file, against tests/verify/data/bits.txt; they are the
 * same on every processor. `make bits` writes that file. A change of bits is a decision, and the commit says why.
 *
 * Every file of configs/ is here, so a new one needs a row. Overrides of cases, and shares and edits of studies, keep
 * the suite within some seconds, and within a minute where fused multiply-adds are emulated. Four kinds of data sets
 * are left out (bits() in expect.py): texts of the case; measures of the surface, whose best fit is GSL's; verdicts,
 * whose intervals have last bits of the C library; and condition numbers, which LAPACK estimates. tools/same_bits.sh
 * compares processors, compilers and LAPACKs, tools/aarch64.sh another architecture. */
#include "cli.h"

#include <dirent.h>

typedef struct {
    const char *name;   /* of configs/NAME.yaml */
    const char *tasks;  /* of a study: the share of its points that runs is 1/tasks */
    const char *set[3]; /* overrides of a case, in order; of a study: an edit of its file and base, by sed */
} bits_row;

static const bits_row rows[] = {
    {"chen2022", NULL, {NULL, NULL}},
    {"chen2022-dense", NULL, {"optimize.generations=40", NULL}},
    {"chen2022-truss", NULL, {NULL, NULL}},
    {"chen2022-search", "5", {"s/generations: 400/generations: 40/", NULL}},
    {"chen2022-search-truss", "1", {NULL, NULL}},
    {"cylinder-tied-8m", NULL, {NULL, NULL}},
    {"dish-8m",
     NULL,
     {"requirements=[{figure: facets, at_most: 2.5e-3, load_case: all, share: 0.95}, {figure: tension, set: tie, "
      "at_least: 1, load_case: all, share: 0.95}, {figure: gain_loss, at_most: 2}]",
      "tolerance.samples=400", "scene.paraboloid.rings=5"}},
    {"paraboloid-6m", NULL, {NULL, NULL}},
    {"paraboloid-load-cases", NULL, {NULL, NULL}},
    {"paraboloid-even", NULL, {NULL, NULL}},
    {"paraboloid-offset-12m", NULL, {NULL, NULL}},
    {"pretension-night", "36", {"s/samples: .2000./samples: [200]/", NULL}},
    {"pretension-night-12m", "12", {"s/rings: 10/rings: 4/; s/samples: .200./samples: [20]/", NULL}},
    {"pretension-sweep", "16", {NULL, NULL}},
    {"pretension-truss", "4", {NULL, NULL}},
    {"reflector", NULL, {"optimize.generations=10", "optimize.method=ga+lm"}},
    {"straight-edges", NULL, {"optimize.generations=20", "optimize.refine=true"}},
    {"straight-edges-truss", NULL, {"optimize.generations=10", "optimize.refine=true"}},
    {"survive", NULL, {"optimize.samples=16", "tolerance.samples=200"}},
    {"triangles_a", NULL, {"optimize.generations=20", "optimize.method=ga+lm"}}, /* no file: triangles() makes it */
};
enum { N_ROW = sizeof rows / sizeof *rows };

static const char *triangles(void)
{
    static const char *const file[] = {"nodes.csv", "cables.csv"};
    for (int i = 0; i < 2; i++)
        SHELL(0, "cp \"$1\" \"$2\"", keep(source_path(formatted("tests/verify/data/limits/triangles_a_%s", file[i]))),
              temp(file[i]));
    return file_with("net.yaml", "scene: {import: {nodes: nodes.csv, cables: cables.csv}}\n"
                                 "form: {method: hifdm, stop: rms_change}\noptimize: {range_N: 1, seed: 7}\n");
}

static const char *run_case(const bits_row *row)
{
    const char *file = keep(formatted("configs/%s.yaml", row->name)), *result = temp("r.h5");
    const char *path = strcmp(row->name, "triangles_a") ? keep(source_path(file)) : triangles();
    HIFDM(0, "run", path, "-o", result, "--quiet", row->set[0] ? "--set" : NULL, row->set[0],
          row->set[1] ? "--set" : NULL, row->set[1], row->set[2] ? "--set" : NULL, row->set[2]);
    return result;
}

static const char *run_study(const bits_row *row)
{
    SHELL(0, "cp \"$1\"/*.yaml \"$2\" && sed -i -e \"$3\" \"$2\"/*.yaml", keep(source_path("configs")), temp("."),
          row->set[0] ? row->set[0] : "");
    const char *study = temp(formatted("%s.yaml", row->name)), *folder = temp("s.d"), *result = temp("s.h5");
    HIFDM(0, "sweep", study, "--dir", folder, "--quiet", "--task", "0", "--tasks", row->tasks);
    HIFDM(0, "merge", study, "--dir", folder, "-o", result, "--quiet");
    return result;
}

START_TEST(checksums)
{
    const bits_row *row = &rows[_i];
    const char *result = row->tasks ? run_study(row) : run_case(row), *folder = getenv("HIFDM_BITS");
    if (folder)
        EXPECT(result, "--", formatted("write_bits(a, '%s', '%s')", folder, row->name));
    else
        EXPECT(result, source_path("tests/verify/data/bits.txt"), "--", formatted("bits_are(a, b, '%s')", row->name));
}
END_TEST

START_TEST(every_case_of_configs_has_checksums)
{
    DIR *folder = opendir(source_path("configs"));
    ck_assert_ptr_nonnull(folder);
    int n = 0;
    for (const struct dirent *entry; (entry = readdir(folder));) {
        const char *end = strstr(entry->d_name, ".yaml");
        if (!end || end[5]) continue;
        int i = 0;
        while (i < N_ROW && strcmp(entry->d_name, formatted("%s.yaml", rows[i].name)))
            i++;
        ck_assert_msg(i < N_ROW, "configs/%s has no row here", entry->d_name);
        n++;
    }
    closedir(folder);
    ck_assert_int_eq(n, N_ROW - 1); /* all but triangles_a */
}
END_TEST

Suite *suite_cli_bits(void)
{
    Suite *suite = suite_create("cli/bits");
    TCase *tests = tcase_create("bits");
    tcase_add_loop_test(tests, checksums, 0, N_ROW);
    tcase_add_test(tests, every_case_of_configs_has_checksums);
    suite_add_tcase(suite, tests);
    return suite;
}
