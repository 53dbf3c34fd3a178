/* The test makes each allocation of hf_problem_open fail once. The call must return HF_NO_MEMORY with a message or a
 * batch that gives the same bits. It must leak nothing (the run under the sanitizers checks that). */
#include "nets.h"

#include <hifdm/problem.h>

static const char *write_case(int with_truss)
{
    static const char net[] = "scene: {parabolic_cylinder: {aperture_m: 2, length_m: 2, focal_length_m: 2, modules: "
                              "[2, 2], cells_per_module: [2, 2], scallop: 0.1}}\n"
                              "optimize: {symmetry: auto}\n";
    char text[512];
    snprintf(text, sizeof text, "%s%s", net, with_truss ? "truss: {}\n" : "");
    const char *path = temp_path("c.yaml");
    write_file(path, text);
    return path;
}

/* A design beside the base, which each solver finds by other steps. */
static void evaluate_one(hf_problem *p, hf_form_result *r)
{
    double design[64];
    ck_assert_int_le(p->model.n_variable, 64);
    for (int k = 0; k < p->model.n_variable; k++)
        design[k] = p->initial[k] * (1 + 0.03 * (k % 3));
    hf_batch_run(&p->batch, 1, design, NULL, r);
}

START_TEST(opening_a_problem)
{
    const char *path = write_case(_i);
    double psi_m = NAN;
    long n, n_refused = 0;
    for (n = 0;; n++) { /* n = 0: no allocation fails; its psi is what the others are compared with */
        hf_problem p;
        hf_messages messages = {0};
        hf_form_result found = {.status = HF_NOT_EVALUATED};
        fail_allocation_at(n ? n : 1L << 40);
        hf_status status = hf_problem_open(path, NULL, 0, 2, &p, &messages);
        bool failed = end_allocation_failure();
        if (status == HF_OK) evaluate_one(&p, &found);
        char said[256];
        snprintf(said, sizeof said, "%s", messages.text ? messages.text : "");
        int n_error = messages.n_error;
        hf_problem_free(&p);
        hf_messages_free(&messages);
        if (status == HF_OK) {
            ck_assert_int_eq(found.status, HF_OK);
            if (n == 0) psi_m = found.psi_m;
            ck_assert_msg(found.psi_m == psi_m, "allocation %ld: psi %.17g, not %.17g", n, found.psi_m, psi_m);
        } else {
            ck_assert_msg(status == HF_NO_MEMORY, "allocation %ld: %s: %s", n, hf_status_word(status), said);
            ck_assert_int_eq(n_error, 1);
            ck_assert_msg(strstr(said, "out of memory") != NULL, "allocation %ld: %s", n, said);
            n_refused++;
        }
        if (n > 0 && !failed) break;
    }
    ck_assert_int_ge(n_refused, 12);
}
END_TEST

Suite *suite_fault_problem(void)
{
    Suite *suite = suite_create("fault/problem");
    TCase *tests = tcase_create("problem");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, opening_a_problem, 0, 2);
    return suite;
}
