/* Verdicts on the requirements of shipped cases against an oracle in another language, which recomputes them from the
 * samples and shapes in the result file: samples in load cases, samples of an optimised net on its truss, and nominal
 * figures in load cases. */
#include "../cli/cli.h"

static const struct {
    const char *path, *set[2], *verdicts;
    bool is_form; /* without the optimisation of the case */
} row[] = {
    {"configs/dish-8m.yaml", {NULL}, "\npass 9\n", false},
    {"configs/dish-8m.yaml", {"form.pretension_N=24", "tolerance.samples=400"}, "\nfail 3 pass 5 undecided 1\n", true},
    {"configs/dish-8m.yaml",
     {"requirements=[{figure: gain, at_least: 55, load_case: all}, {figure: gain_loss, feed: fixed, frequency_Hz: "
      "20e9, "
      "at_most: 0.5, load_case: cold}, {figure: gain_loss, frequency_Hz: 20e9, at_most: 1, share: 0.95, load_case: "
      "all},"
      " {figure: pointing, frequency_Hz: 3e9, at_most: 0.02, share: 0.95}]",
      "tolerance.samples=100"},
     "\nfail 2 pass 1 undecided 1\n",
     true},
    {"configs/survive.yaml", {"optimize.samples=16", "tolerance.samples=200"}, "\npass 4 undecided 1\n", false},
    {"configs/paraboloid-load-cases.yaml", {NULL}, "\nfail 2 pass 7\n", false},
    {"tests/verify/data/load-case-errors.yaml", {NULL}, "\nfail 1 pass 1\n", false},
    {"configs/paraboloid-load-cases.yaml", {"form.pretension_N=40", "truss.E_Pa=200e9"}, NULL, false},
};

START_TEST(verdicts_agree_with_the_oracle)
{
    const char *result = temp("r.h5"), *oracle = keep(source_path("tests/verify/requirements_oracle.py"));
    const char *path = keep(source_path(row[_i].path)), *form = temp("form.yaml");
    if (row[_i].is_form) SHELL(0, "sed '/^optimize:/,$d' \"$1\" > \"$2\"", path, form);
    HIFDM(0, "run", row[_i].is_form ? form : path, "-o", result, "--quiet", row[_i].set[0] ? "--set" : NULL,
          row[_i].set[0], "--set", row[_i].set[1]);
    const char *const check[] = {python_program(), oracle, result, NULL};
    demand_exit(run_command(HANG_S, check), 0, "requirements_oracle.py", __LINE__);
    if (row[_i].verdicts) OUT(row[_i].verdicts);
}
END_TEST

Suite *suite_verify_requirements(void)
{
    Suite *suite = suite_create("verify/requirements");
    TCase *tcase = tcase_create("verdicts");
    tcase_add_loop_test(tcase, verdicts_agree_with_the_oracle, 0, (int)(sizeof row / sizeof *row));
    suite_add_tcase(suite, tcase);
    return suite;
}
