/* The test makes each allocation of hf_problem_open fail once. The call must return HF_NO_MEMORY with a message or,
 * where the memory only makes the batch faster, a batch that gives the same shapes. It must leak nothing (the run under
 * the sanitizers checks that). */
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

START_TEST(opening_a_problem)
{
    const char *path = write_case(_i);
    double psi_m = NAN;
    long n, n_refused = 0;
    for (n = 0;; n++) { /* n = 0: no allocation fails; its psi is what the others are compared with */
        hf_problem p;
        hf_messages messages = {0};
        hf_form_result base = {.status = HF_NOT_EVALUATED};
        fail_allocation_at(n ? n : 1L << 40);
        hf_status status = hf_problem_open(path, NULL, 0, 2, &p, &messages);
        bool failed = end_allocation_failure();
        if (status == HF_OK) hf_batch_run(&p.batch, 1, p.base_N, NULL, &base);
        char said[256];
        snprintf(said, sizeof said, "%s", messages.text ? messages.text : "");
        int n_error = messages.n_error;
        hf_problem_free(&p);
        hf_messages_free(&messages);
        if (status == HF_OK) { /* 1e-9 m: another solver stops elsewhere within the tolerances of the case */
            ck_assert_int_eq(base.status, HF_OK);
            if (n == 0) psi_m = base.psi_m;
            ck_assert_double_eq_tol(base.psi_m, psi_m, 1e-9);
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
