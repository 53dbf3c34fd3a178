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
     "--set optimize.variables.0.set: this net has no cable set 'frnt'; did you mean 'front'?"},
    {"[{set: all, vary: tension, range: 1}, {set: tie, vary: length, range: 1}]", NULL,
     "is already a design variable of optimize.variables.0"},
    {"[{set: front_edge, vary: support_z, range: 1}, {set: front_edge, vary: support_xyz, range: 1}]", NULL,
     "is already a design variable of optimize.variables.0"},
    {"[{set: front, vary: unstressed_length, range: 1 %}]", NULL,
     "only cables with the law elastic have an unstressed length"},
    {"[{set: tie, vary: support_z, range: 1}]", NULL,
     "set tie has 7 cables, but no support at their ends that holds a free node. Choose another set"},
    {"[{set: front, vary: tension, bounds: [-5, -2]}]", NULL,
     "no value above 0 N, but tensions and lengths of cables must be above zero"},
    {"[{set: tie, vary: length, bounds: [null, 0]}]", NULL,
     "no value above 0 m, but tensions and lengths of cables must be above zero"},
    {"[{set: tie, vary: tension, range: 1}]", "optimize.objective=[{figure: tension, set: ties, target: 3}]",
     "--set optimize.objective.0.set: this net has no cable set 'ties'; did you mean 'tie'?"},
    {"[{set: tie, vary: tension, range: 1}]", "optimize.limits=[{figure: ratio, set: ties, bounds: [1, 3]}]",
     "--set optimize.limits.0.set: this net has no cable set 'ties'; did you mean 'tie'?"},
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

static hf_summary *run_bowl(const char *rows, const char *more)
{
    static hf_summary s;
    char output[HF_OUTPUT_SIZE], variables[256];
    hf_messages said = {0};
    snprintf(variables, sizeof variables, "optimize.variables=%s", rows);
    const char *const set[] = {"scene.paraboloid.rings=3", "optimize.method=lm", variables, more};
    hf_run_request request = {.input = {source_path("configs/paraboloid-6m.yaml"), .set = set, .n_set = more ? 4 : 3},
                              .output.no_file = true,
                              .control.threads = 1};
    hf_summary_free(&s); /* of the run before */
    ck_assert_msg(hf_run_case(&request, &s, output, &said) == HF_OK, "%s", said.text);
    hf_messages_free(&said);
    ck_assert_int_eq(s.refine.algorithm_stop, HF_REFINE_CONVERGED);
    return &s;
}

/* Bounds far away are as good as none, and a bound at the start is one. */
START_TEST(supports_open_on_one_side_keep_to_the_other)
{
    static const char *const bounds[2][2] = {{"[null, 0]", "[-0.1, 0]"}, {"[0, null]", "[0, 0.1]"}};
    double merit[2];
    for (int k = 0; k < 2; k++) {
        char rows[128];
        snprintf(rows, sizeof rows, "[{set: front_edge, vary: support_z, bounds: %s}]", bounds[_i][k]);
        merit[k] = run_bowl(rows, NULL)->stage[HF_STAGE_REFINE].result.merit;
    }
    ck_assert_double_eq_tol(merit[0], merit[1], 1e-9 * merit[1]);
}
END_TEST

#define ALL "[{set: all, vary: force_density, range: 40 %}]"

/* Both nets of a reflector and their ties, on a ring that gives way: as many force densities as it takes. psi cannot be
 * less than the places are known. */
START_TEST(a_double_net_is_designed_onto_its_surface)
{
    const hf_summary *s = run_bowl(ALL, NULL);
    ck_assert_double_gt(s->stage[HF_STAGE_FORM].result.psi_m, 4e-4);
    ck_assert_double_lt(s->stage[HF_STAGE_REFINE].result.psi_m, 1e-9);
}
END_TEST

/* 1.05 mm at the start, inside and outside. Attachments where the ring is held do not move at all. */
START_TEST(a_limit_on_displacements_is_met)
{
    static const char *const limit[] = {"[{figure: deflection, bounds: [0, 1.2e-3]}]",
                                        "[{figure: deflection, bounds: [0, 1.03e-3]}]"};
    char limits[96];
    snprintf(limits, sizeof limits, "optimize.limits=%s", limit[_i]);
    const hf_summary *s = run_bowl(ALL, limits);
    ck_assert_double_gt(s->stage[HF_STAGE_FORM].result.coupling.deflection_max_m, 1e-3);
    ck_assert_double_le(s->stage[HF_STAGE_REFINE].result.coupling.deflection_max_m, _i ? 1.03e-3 : 1.2e-3);
}
END_TEST

Suite *suite_unit_variables(void)
{
    Suite *suite = suite_create("unit/variables");
    TCase *tests = tcase_create("variables");
    tcase_add_loop_test(tests, what_a_net_does_not_have_is_named, 0, N_REFUSED);
    tcase_add_loop_test(tests, supports_open_on_one_side_keep_to_the_other, 0, 2);
    tcase_add_test(tests, a_double_net_is_designed_onto_its_surface);
    tcase_add_loop_test(tests, a_limit_on_displacements_is_met, 0, 2);
    suite_add_tcase(suite, tests);
    return suite;
}
