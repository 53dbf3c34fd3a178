/* hifdm adjust against tests/verify/adjust_oracle.py: the estimated errors, and the figure and tension after each move.
 * The oracle has sensitivities by differences of shapes known to 1e-9 N: of errors of 0.1 mm they leave some 1e-9 m. */
#include "support.h"

#include <stdio.h>
#include <stdlib.h>

static void ask(const char *const *words)
{
    struct command c = run_command(HANG_S, words);
    ck_assert_msg(c.exit_code == 0, "%s %s: exit code %d\n%s%s", words[0], words[1], c.exit_code, c.out, c.err);
    printf("%s", c.out);
    free_command(&c);
}
#define ASK(...) ask((const char *const[]){__VA_ARGS__, NULL})

START_TEST(an_adjusted_net_is_that_of_the_oracle)
{
    static char file[7][4096];
    static const char *const name[7] = {"case.yaml", "r.h5",         "cut.csv",    "cut_nodes.csv",
                                        "shape",     "measured.csv", "answer.json"};
    for (int k = 0; k < 7; k++)
        snprintf(file[k], sizeof file[k], "%s", temp_path(name[k]));
    write_file(file[0], "scene:\n"
                        "  EA_inner_N: 20000\n"
                        "  EA_boundary_N: 20000\n"
                        "  parabolic_cylinder: {aperture_m: 2, length_m: 2, focal_length_m: 2, modules: [2, 2], "
                        "cells_per_module: [2, 2], scallop: 0.1}\n"
                        "form: {residual_tolerance: 1e-11}\n"
                        "tolerance: {sigma_cut_m: 0.0001, sigma_cut_ratio: 0.0003, sigma_EA_ratio: 0.05, batch: 0.7, "
                        "sigma_temperature_K: 20}\n"
                        "cables: [{set: inner, expansion_per_K: 1e-5}, {set: boundary, expansion_per_K: 2e-5}]\n"
                        "adjust: {set: inner, range_m: 0.001, step_m: 0.00005, max_adjustments: 5}\n");
    const char *hifdm = hifdm_program(), *oracle = source_path("tests/verify/adjust_oracle.py");
    const char *python = python_program();
    ASK(hifdm, "run", file[0], "-o", file[1], "--quiet");
    ASK(hifdm, "export", file[1], "--csv", file[4], "--cutlist", file[2]);
    ASK(python, oracle, "measure", file[2], file[3], file[4], file[5], "7");
    ASK("sh", "-c", "exec \"$0\" adjust \"$1\" --measured \"$2\" --set adjust.aim=$4 --json >\"$3\"", hifdm, file[0],
        file[5], file[6], _i ? "design" : "theory");
    ASK(python, oracle, "check", file[2], file[3], file[4], file[5], file[6]);
}
END_TEST

Suite *suite_verify_adjust(void)
{
    Suite *suite = suite_create("verify/adjust");
    TCase *tcase = tcase_create("adjust");
    tcase_set_timeout(tcase, HANG_S);
    tcase_add_loop_test(tcase, an_adjusted_net_is_that_of_the_oracle, 0, 2); /* both aims */
    suite_add_tcase(suite, tcase);
    return suite;
}
