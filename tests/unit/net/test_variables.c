/* Variables of a case as the engine takes them: what a net does not have is refused by name, and bounds that are open
 * on one side bound a run of Levenberg-Marquardt. */
#include "nets.h"

#include <hifdm/problem.h>
#include <hifdm/run.h>

static hf_status open_bowl(const char *rows, const char *more, hf_problem *p, hf_messages *said)
{
    static char variables[512];
    snprintf(variables, sizeof variables, "optimize.variables=%s", rows);
    const char *const set[] = {"scene.paraboloid.rings=2", "optimize.method=lm", variables, more};
    return hf_problem_open(source_path("configs/paraboloid-6m.yaml"), set, more ? 4 : 3, 1, p, said);
}

static const struct {
    const char *rows, *more, *said;
} refused[] = {
    {"[{set: frnt, vary: tension, range: 1}]", NULL,
     "optimize.variables.0: there is no set of cables 'frnt'; did you mean 'front'?"},
    {"[{set: all, vary: tension, range: 1}, {set: tie, vary: length, range: 1}]", NULL, "is varied by row 0 already"},
    {"[{set: front_edge, vary: support_z, range: 1}, {set: front_edge, vary: support_xyz, range: 1}]", NULL,
     "is varied by row 0 already"},
    {"[{set: front, vary: unstressed_length, range: 1 %}]", NULL,
     "only cables of law elastic have an unstressed length"},
    {"[{set: tie, vary: support_z, range: 1}]", NULL,
     "set tie has 7 cables, but no support at their ends that holds a free node: there is nothing to vary"},
    {"[{set: front, vary: tension, bounds: [-5, -2]}]", NULL, "nothing above 0 N: a cable has a tension and a length"},
    {"[{set: tie, vary: length, bounds: [null, 0]}]", NULL, "nothing above 0 m: a cable has a tension and a length"},
    {"[{set: tie, vary: tension, range: 1}]", "optimize.goals=[{goal: tension, set: ties, target: 3}]",
     "optimize.goals.0: there is no set of cables 'ties'; did you mean 'tie'?"},
    {"[{set: tie, vary: tension, range: 1}]", "optimize.limits=[{limit: ratio, set: ties, bounds: [1, 3]}]",
     "optimize.limits.0: there is no set of cables 'ties'; did you mean 'tie'?"},
};
enum { N_REFUSED = sizeof refused / sizeof *refused };

START_TEST(what_a_net_does_not_have_is_named)
{
    hf_problem p;
    hf_messages said = {0};
    ck_assert_int_eq(open_bowl(refused[_i].rows, refused[_i].more, &p, &said), HF_BAD_CASE);
    ck_assert_msg(said.text && strstr(said.text, refused[_i].said), "%s", said.text ? said.text : "nothing is said");
    hf_problem_free(&p);
    hf_messages_free(&said);
}
END_TEST

/* Bounds far away are as good as none, and a bound at the start is one. */
static hf_summary *run_bowl(const char *bounds)
{
    static hf_summary s;
    char output[HF_OUTPUT_SIZE], variables[256];
    hf_messages said = {0};
    snprintf(variables, sizeof variables, "optimize.variables=[{set: front_edge, vary: support_z, bounds: %s}]",
             bounds);
    const char *const set[] = {"scene.paraboloid.rings=2", "optimize.method=lm", variables};
    hf_run_request request = {
        .case_path = source_path("configs/paraboloid-6m.yaml"), .set = set, .n_set = 3, .no_file = true, .threads = 1};
    ck_assert_msg(hf_run_case(&request, &s, output, &said) == HF_OK, "%s", said.text);
    hf_messages_free(&said);
    ck_assert_int_eq(s.polish_stop, HF_POLISH_CONVERGED);
    return &s;
}

START_TEST(supports_open_on_one_side_keep_to_the_other)
{
    static const char *const bounds[2][2] = {{"[null, 0]", "[-0.1, 0]"}, {"[0, null]", "[0, 0.1]"}};
    double open_m = run_bowl(bounds[_i][0])->polish.merit;
    ck_assert_double_eq_tol(open_m, run_bowl(bounds[_i][1])->polish.merit, 1e-9 * open_m);
}
END_TEST

Suite *suite_unit_variables(void)
{
    Suite *suite = suite_create("unit/variables");
    TCase *tests = tcase_create("variables");
    tcase_add_loop_test(tests, what_a_net_does_not_have_is_named, 0, N_REFUSED);
    tcase_add_loop_test(tests, supports_open_on_one_side_keep_to_the_other, 0, 2);
    suite_add_tcase(suite, tests);
    return suite;
}
