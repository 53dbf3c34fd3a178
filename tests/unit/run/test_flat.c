/* The flat interface: a net of arrays with each allocation failing once, what is said without a case, and the program
 * that reads an earlier result. What it computes is held to the program in tests/python. */
#include "support.h"

#include <hifdm/flat.h>
#include <hifdm/status.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A square on four supports, its rim a boundary: one design variable for each of the four outer cables. */
static const double position_m[][3] = {{-2, 0, 0.5}, {2, 0, 0.5},   {0, -2, -0.5}, {0, 2, -0.5}, {-1, 0, 0.2},
                                       {1, 0, 0.2},  {0, -1, -0.2}, {0, 1, -0.2},  {0, 0, 0}};
static const unsigned char role[] = {0, 0, 0, 0, 1, 1, 1, 1, 1};
static const int end[][2] = {{0, 4}, {1, 5}, {2, 6}, {3, 7}, {4, 8}, {5, 8}, {6, 8}, {7, 8}};
static const unsigned char group[] = {1, 1, 1, 1, 0, 0, 0, 0}, law[8] = {0};
static const double load_N[9][3] = {[8] = {0, 0, -0.1}};
static const char *const node_id[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};
static const char *const set_name[] = {"x", "y"};
static const int set_start[] = {0, 2, 4}, set_cable[] = {4, 5, 6, 7};
static const char text[] =
    "scene: {import: {nodes: nodes.csv, cables: cables.csv}}\nform: {pretension_N: 10, residual_tolerance: 1e-12}\n";
enum { N_DESIGN = 3, N_VARIABLE = 4 };

/* Everything once; the first status that is not HF_OK. psi_m: of the last design. */
static int work(hf_flat *flat, double *psi_m)
{
    double design[N_DESIGN * N_VARIABLE], figure[16 * N_DESIGN], slope[N_DESIGN * N_VARIABLE];
    hf_flat_nodes(flat, 9, position_m[0], role, load_N[0], node_id);
    hf_flat_cables(flat, 8, end[0], group, law, NULL, NULL, NULL);
    hf_flat_sets(flat, 2, set_name, set_start, set_cable);
    int status = hf_flat_open_net(flat, "arrays", text, 0, NULL, 1);
    if (status == HF_OK) status = hf_flat_form(flat);
    if (status != HF_OK) return status;
    hf_flat_reals(flat, "initial", design);
    for (int i = N_VARIABLE; i < N_DESIGN * N_VARIABLE; i++)
        design[i] = design[i - N_VARIABLE] * 1.01;
    status = hf_flat_evaluate(flat, N_DESIGN, design, figure);
    if (status == HF_OK) status = hf_flat_slopes(flat, N_DESIGN, design, slope);
    double residual[15], jacobian[15 * N_VARIABLE];
    if (status == HF_OK) status = hf_flat_residuals(flat, design, 1, residual, jacobian);
    if (status == HF_OK) status = hf_flat_vjp(flat, design, 1, residual, slope);
    if (status == HF_OK) status = hf_flat_shape(flat, design);
    *psi_m = figure[N_DESIGN + N_DESIGN - 1];
    if (status == HF_OK && figure[0] != HF_OK) status = (int)figure[0];
    return status == HF_OK ? hf_flat_run(flat, NULL, 0, NULL, NULL) : status;
}

START_TEST(every_allocation_may_fail)
{
    double first_m = NAN, psi_m = NAN;
    int n_refused = 0;
    for (long n = 0;; n++) { /* n = 0: none fails */
        int status = HF_NO_MEMORY;
        fail_allocation_at(n ? n : 1L << 40);
        hf_flat *flat = hf_flat_create();
        if (flat) status = work(flat, &psi_m);
        bool failed = end_allocation_failure();
        char said[256] = "out of memory";
        if (flat) snprintf(said, sizeof said, "%s", hf_flat_messages(flat));
        if (status == HF_OK) ck_assert_ptr_nonnull(hf_flat_text(flat, "summary", 0));
        hf_flat_free(flat);
        if (n == 0) first_m = psi_m;
        if (status == HF_OK)
            ck_assert_double_eq_tol(psi_m, first_m, 1e-9);
        else
            ck_assert_msg(status == HF_NO_MEMORY && strstr(said, "out of memory"), "allocation %ld: %s: %s", n,
                          hf_status_word((hf_status)status), said);
        n_refused += status != HF_OK;
        ck_assert_msg(n > 0 || status == HF_OK, "%s", said);
        if (n > 0 && !failed) break;
    }
    ck_assert_int_ge(n_refused, 30);
}
END_TEST

START_TEST(what_is_read_has_its_size)
{
    hf_flat *flat = hf_flat_create();
    double psi_m;
    ck_assert_int_eq(hf_flat_form(flat), HF_BAD_USAGE);
    ck_assert_str_eq(hf_flat_messages(flat), "error: open a case first\n");
    ck_assert_ptr_null(hf_flat_text(flat, "node_id", 0));
    ck_assert_int_eq(hf_flat_reals(flat, "initial", NULL), 0);
    ck_assert_msg(work(flat, &psi_m) == HF_OK, "%s", hf_flat_messages(flat));
    ck_assert_int_eq(hf_flat_reals(flat, "position_m", NULL), 27);
    ck_assert_int_eq(hf_flat_reals(flat, "initial", NULL), N_VARIABLE);
    ck_assert_int_eq(hf_flat_reals(flat, "EA_N", NULL), 0);
    ck_assert_int_eq(hf_flat_reals(flat, "nothing", NULL), -1);
    ck_assert_int_eq(hf_flat_ints(flat, "set_start", NULL), 3);
    ck_assert_int_eq(hf_flat_ints(flat, "nothing", NULL), -1);
    ck_assert_str_eq(hf_flat_text(flat, "variable", 3), "3");
    ck_assert_str_eq(hf_flat_text(flat, "node_id", 8), "i");
    ck_assert_ptr_null(hf_flat_text(flat, "node_id", 9));
    ck_assert_ptr_null(hf_flat_text(flat, "variable", N_VARIABLE));
    ck_assert_str_eq(hf_flat_text(flat, "slope", 0), "psi_m");
    ck_assert_int_eq(hf_flat_open(flat, "again.yaml", 0, NULL, 1), HF_BAD_USAGE);
    hf_flat_free(flat);
    ck_assert_int_eq(hf_flat_code("law", "elastic"), 3);
    ck_assert_int_eq(hf_flat_code("law", "spring"), -1);
    ck_assert_int_eq(hf_flat_code("status", "bad_usage"), HF_BAD_USAGE);
    ck_assert_int_eq(hf_flat_code("status", "interrupted"), HF_INTERRUPTED);
    ck_assert_int_eq(hf_flat_code("status", "unknown"), -1);
    ck_assert_str_eq(hf_flat_word("phase", 3), "tolerance");
    ck_assert_ptr_null(hf_flat_word("phase", 4));
}
END_TEST

/* Names of version 0.2 are unknown. A program that uses them stops at hf_flat_interface. */
START_TEST(old_names_are_unknown)
{
    static const struct {
        const char *list, *then, *now;
    } word[] = {{"phase", "optimize", "search"},
                {"phase", "polish", "refine"},
                {"stop_reason", "residual", "converged"},
                {"coupling_stop", "tof", "converged"},
                {"bound_reason", "proven", "certified"}};
    double psi_m;
    hf_flat *flat = hf_flat_create();
    ck_assert_int_eq(hf_flat_interface(), 2);
    for (size_t i = 0; i < sizeof word / sizeof *word; i++) {
        ck_assert_int_eq(hf_flat_code(word[i].list, word[i].then), -1);
        ck_assert_int_ge(hf_flat_code(word[i].list, word[i].now), 0);
    }
    ck_assert_msg(work(flat, &psi_m) == HF_OK, "%s", hf_flat_messages(flat));
    ck_assert_ptr_null(hf_flat_text(flat, "gene", 0));
    ck_assert_ptr_null(hf_flat_text(flat, "gene_unit", 0));
    ck_assert_str_eq(hf_flat_text(flat, "variable_unit", 0), "N");
    ck_assert_ptr_null(hf_flat_text(flat, "objective", 0)); /* this case has none */
    ck_assert_int_eq(hf_flat_ints(flat, "gene_cable", NULL), -1);
    ck_assert_int_eq(hf_flat_ints(flat, "gene_leader", NULL), -1);
    ck_assert_int_eq(hf_flat_ints(flat, "variable_cable", NULL), N_VARIABLE);
    ck_assert_int_ge(hf_flat_ints(flat, "variable_leader", NULL), 0);
    ck_assert_int_eq(hf_flat_reals(flat, "theoretical_m", NULL), -1);
    ck_assert_int_eq(hf_flat_reals(flat, "base", NULL), -1);
    ck_assert_int_eq(hf_flat_reals(flat, "target_position_m", NULL), 27);
    hf_flat_free(flat);
}
END_TEST

/* Other designs between a shape and its reading; a stop that comes when no run goes on. */
START_TEST(calls_leave_no_trace)
{
    double psi_m, initial[N_VARIABLE], other[2 * N_VARIABLE], before[2][27], result[128], figure[16 * 2],
        slope[2 * N_VARIABLE];
    hf_flat *flat = hf_flat_create();
    ck_assert_msg(work(flat, &psi_m) == HF_OK, "%s", hf_flat_messages(flat));
    hf_flat_reals(flat, "initial", initial);
    for (int i = 0; i < 2 * N_VARIABLE; i++)
        other[i] = initial[i % N_VARIABLE] * (i % 2 ? 1.2 : 0.7);
    ck_assert_int_eq(hf_flat_form(flat), HF_OK);
    hf_flat_reals(flat, "position_m", before[0]);
    hf_flat_reals(flat, "tension_N", before[1]);
    ck_assert_int_eq(hf_flat_evaluate(flat, 2, other, figure), HF_OK);
    ck_assert_int_eq(hf_flat_slopes(flat, 2, other, slope), HF_OK);
    hf_flat_reals(flat, "position_m", result);
    ck_assert_mem_eq(result, before[0], sizeof before[0]);
    hf_flat_reals(flat, "tension_N", result);
    ck_assert_mem_eq(result, before[1], 8 * sizeof *result);
    hf_flat_stop(flat);
    ck_assert_int_eq(hf_flat_run(flat, NULL, 0, NULL, NULL), HF_OK);
    hf_flat_free(flat);
}
END_TEST

static int run_again(hf_flat *flat, const char *path, const char *script)
{
    const char *const command[] = {"/bin/sh", "-c", script, "sh", path, NULL};
    hf_flat_set_reader(command);
    return hf_flat_run(flat, path, 0, NULL, NULL);
}

/* A program reads the earlier result. If it crashes, the file is damaged. If it fails, a copy of this process reads. */
START_TEST(a_program_reads_an_earlier_result)
{
    double psi_m;
    char path[4096];
    hf_flat *flat = hf_flat_create();
    ck_assert_msg(work(flat, &psi_m) == HF_OK, "%s", hf_flat_messages(flat));
    snprintf(path, sizeof path, "%s", temp_path("flat.h5"));
    ck_assert_int_eq(run_again(flat, path, "kill -SEGV $$"), HF_OK); /* there is none */
    ck_assert_int_eq(run_again(flat, path, "kill -SEGV $$"), HF_EXISTS);
    ck_assert_ptr_nonnull(
        strstr(hf_flat_messages(flat), "is damaged. The process that read the file was ended by signal 11"));
    ck_assert_int_eq(run_again(flat, path, "kill -KILL $$"), HF_IO);
    ck_assert_ptr_nonnull(strstr(hf_flat_messages(flat), "the process that read this file was ended by signal 9"));
    ck_assert_int_eq(run_again(flat, path, "test \"$1\" = \"$2\" || kill -SEGV $$"), HF_OK);
    ck_assert_int_eq(run_again(flat, path, "exit 3"), HF_OK);
    hf_flat_set_reader((const char *const[]){"/bin/no-such-program", NULL});
    ck_assert_int_eq(hf_flat_run(flat, path, 0, NULL, NULL), HF_OK);
    hf_flat_read(path);
    hf_flat_free(flat);
}
END_TEST

Suite *suite_unit_flat(void)
{
    Suite *suite = suite_create("unit/run/flat");
    TCase *tests = tcase_create("flat");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, every_allocation_may_fail);
    tcase_add_test(tests, what_is_read_has_its_size);
    tcase_add_test(tests, old_names_are_unknown);
    tcase_add_test(tests, calls_leave_no_trace);
    tcase_add_test(tests, a_program_reads_an_earlier_result);
    return suite;
}
