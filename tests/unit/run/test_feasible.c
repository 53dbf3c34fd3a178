/* Bounds on tensions from any list of a case, and memory that fails while they are compared. What the warnings say is
 * tested in cli/feasible, and what they compute in verify/feasible. */
#include "nets.h"

#include "run/feasible.h"

#include <hifdm/problem.h>

static const char text[] = "scene: {paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 2, rear_distance_m: 1.8}}\n"
                           "form: {pretension_N: 10, prestress: exact}\n"
                           "optimize: {method: lm, variables: [{set: all, vary: force_density, range: 20 %}]}\n";

static void open_dish(hf_problem *p)
{
    const char *path = temp_path("dish.yaml");
    hf_messages said = {0};
    write_file(path, text);
    ck_assert_msg(hf_problem_open(path, NULL, 0, 1, p, &said) == HF_OK, "%s", said.text);
    hf_messages_free(&said);
}

START_TEST(bounds_of_another_list_are_compared_too)
{
    static hf_problem p;
    hf_messages said = {0};
    char advice[HF_FEASIBLE_ADVICE_SIZE];
    const int cable[] = {0, 1};
    const hf_feasible_bound bound[] = {{"requirements", 3, "hub", 2, cable, 50, INFINITY, INFINITY},
                                       {"requirements", 4, "hub", 2, cable, 5, 60, 10}};
    open_dish(&p);
    ck_assert_int_eq(hf_feasible_check_bounds(&p, NULL, 2, bound, advice, &said), HF_OK);
    ck_assert_int_eq(said.n_warning, 1);
    ck_assert_ptr_nonnull(strstr(said.text, "requirements.3: no design at the target positions meets this limit "
                                            "(tension of hub at least 50 N). There, the minimum tension is at most "));
    ck_assert_ptr_nonnull(strstr(advice, "raise form.pretension_N to "));
    ck_assert_int_eq(hf_feasible_check_bounds(&p, NULL, 1, bound + 1, advice, &said), HF_OK);
    ck_assert_int_eq(said.n_warning, 1);
    ck_assert_str_eq(advice, "");
    hf_messages_free(&said);
    hf_problem_free(&p);
}
END_TEST

START_TEST(memory_may_fail)
{
    static hf_problem p;
    const int cable[] = {0, 1};
    const hf_feasible_bound bound = {"requirements", 3, "hub", 2, cable, 50, INFINITY, 1.5};
    open_dish(&p);
    for (long n = 1;; n++) {
        hf_messages said = {0};
        char advice[HF_FEASIBLE_ADVICE_SIZE];
        fail_allocation_at(n);
        hf_status status = hf_feasible_check_bounds(&p, NULL, 1, &bound, advice, &said);
        bool failed = end_allocation_failure();
        hf_messages_free(&said);
        ck_assert(status == HF_OK || (failed && status == HF_NO_MEMORY));
        if (!failed) break;
    }
    hf_problem_free(&p);
}
END_TEST

Suite *suite_unit_feasible(void)
{
    Suite *suite = suite_create("unit/feasible");
    TCase *tests = tcase_create("feasible");
    tcase_add_test(tests, bounds_of_another_list_are_compared_too);
    tcase_add_test(tests, memory_may_fail);
    suite_add_tcase(suite, tests);
    return suite;
}
