/* Goals of nets as built: the same for any threads and interruptions, what survives better, what a case must give. */
#include "session.h"

#define SURVIVE                                                                                                        \
    SMALL_SCENE "  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n"                                                            \
                "tolerance: {sigma_cut_m: 1e-4, samples: 64, sampling: random}\n"                                      \
                "load_cases: [{name: pushed, force_N: [0, 0, 0.2], role: inner}]\n"                                    \
                "optimize: {method: %s, range_N: 4, population: 12, generations: 8, refine: false, samples: 64, "      \
                "%s: [%s]}\n"

static const char *survive_case(const char *name, const char *method, const char *objectives)
{
    return file_with(name, formatted(SURVIVE, method, "objective", objectives));
}

/* By one thread and by three, and as a run that goes on from an earlier one. */
START_TEST(threads_change_nothing)
{
    static const char *const method[] = {"lm", "ga", "ga+lm"},
                             *const objectives[] = {
                                 "{figure: psi, over: samples}, {figure: psi, load_case: pushed, weight: 0.1}",
                                 "{figure: psi, over: samples, quantile: 0.95}",
                                 "{figure: psi, over: samples, take: worst}"};
    const char *c = survive_case("c.yaml", method[_i], objectives[_i]), *one = temp("a.h5"), *many = temp("b.h5");
    HIFDM(0, "run", c, "-o", one, "--quiet", "--threads", "1");
    HIFDM(0, "run", c, "-o", many, "--quiet", "--threads", "3");
    HIFDM(0, "diff", one, many);
}
END_TEST

/* Killed in the genetic algorithm, in Levenberg-Marquardt, and among the samples, each time by another number of
 * threads and from what the last kill left: the bits of a run that nobody disturbed. */
START_TEST(killed_runs_go_on_to_the_same_bits)
{
    static const struct {
        const char *method, *list, *rows;
    } seek[] = {
        {"ga+lm", "objective", "{figure: psi, over: samples}, {figure: psi, load_case: pushed, weight: 0.1}"},
        {"ga", "objective", "{figure: psi, over: samples, quantile: 0.95}, {figure: psi, load_case: all, weight: 0.5}"},
        {"ga+lm", "objective", "{figure: psi, load_case: all, take: worst}, {figure: psi, over: samples, take: worst}"},
        {"ga", "front", "{figure: psi, over: samples, quantile: 0.9}, {figure: ratio, set: boundary}"},
    };
    const char *c = file_with("c.yaml", formatted(SURVIVE, seek[_i].method, seek[_i].list, seek[_i].rows)),
               *path = temp("a.h5"), *whole = temp("b.h5"), *samples = keep(formatted("%s.tolerance", path));
    const char *const longer = "optimize.generations=30", *const more = "tolerance.samples=15000";
    const struct {
        const char *threads, *at;
        bool (*is_so)(const char *at);
    } kill_when[] = {{"2", path, has_generations}, {"3", temp("err"), says_refine}, {"1", samples, has_generations}};
    HIFDM(0, "run", c, "-o", whole, "--quiet", "--threads", "1", "--set", longer, "--set", more);
    for (int k = 0; k < 3; k++) {
        const char *const argv[] = {
            hifdm_program(), "run",   c,       "-o",   path,    "--threads", kill_when[k].threads,
            "--progress",    "jsonl", "--set", longer, "--set", more,        NULL};
        if (kill_when[k].is_so == says_refine && !strcmp(seek[_i].method, "ga")) continue;
        session s = start_program(argv);
        ck_assert_msg(freeze_when(&s, kill_when[k].is_so, kill_when[k].at), "kill %d: the run has ended before", k);
        ck_assert_int_eq(end_by(&s, SIGKILL), 128 + SIGKILL);
        ck_assert(is_there(keep(formatted("%s.journal", path))) || is_there(path));
    }
    HIFDM(0, "run", c, "-o", path, "--threads", "2", "--set", longer, "--set", more, "--progress", "jsonl");
    ck_assert(!strstr(said.err, "\"phase\": \"search\", \"generation\": 1,")); /* they were not computed again */
    HIFDM(0, "diff", path, whole);
    SHELL(0, "test \"$(ls \"$1\"*)\" = \"$1\"", path); /* no journals are left */
    EXPECT(path, whole, "--", "a.attrs['sessions'] > 1", "differing(a, b) == []");
}
END_TEST

/* The goal over the samples of `tolerance` is its figure, and its optimum is better in it than that of psi. */
START_TEST(what_is_sought_is_found)
{
    static const char *const objective[] = {"{figure: psi, over: samples}",
                                            "{figure: psi, over: samples, quantile: 0.95}"},
                             *const method[] = {"lm", "ga"}, *const stage[] = {"refine", "search"},
                             *const figure[] = {"rms_psi_m", "psi_95_m"};
    const char *psi = temp("a.h5"), *survives = temp("b.h5");
    HIFDM(0, "run", survive_case("p.yaml", method[_i], "{figure: psi}"), "-o", psi, "--quiet");
    HIFDM(0, "run", survive_case("s.yaml", method[_i], objective[_i]), "-o", survives, "--quiet");
    EXPECT(survives, psi, "--",
           formatted("near(a['objective/%s'][0], a['tolerance'].attrs['%s'], 1e-7)", stage[_i], figure[_i]),
           formatted("a['tolerance'].attrs['%s'] < b['tolerance'].attrs['%s']", figure[_i], figure[_i]));
}
END_TEST

/* Samples in all load cases: the refinement lowers the quantile, with the derivatives of the mean of the worst samples,
 * and the name of the term says of what it is. A front by Levenberg-Marquardt takes no quantile. */
START_TEST(a_quantile_over_load_cases_is_refined)
{
    const char *c = survive_case("c.yaml", "lm", "{figure: psi, over: samples, load_case: all, quantile: 0.9}");
    const char *path = temp("q.h5");
    HIFDM(0, "run", c, "-o", path, "--json");
    EXPECT(out_as("q.json"), "--",
           "(lambda name: a['refine']['objectives'][name]['value'] < a['form']['objectives'][name]['value'] and "
           "a['refine']['merit'] >= a['refine']['objectives'][name]['value'] and a['refine']['merit'] < "
           "a['form']['merit'])('objective_0_psi_all_samples_quantile')");
    HIFDM(2, "check", c, "--set", "optimize.objective=[]", "--set",
          "optimize.front=[{figure: psi}, {figure: psi, over: samples, quantile: 0.9}]");
    ERR("optimize.front.1.quantile: needs method: ga in optimize.front");
}
END_TEST

START_TEST(faults_of_nets_are_named)
{
    static const char *const fault[][3] = {
        {"lm", "{figure: psi, load_case: pushd}", "load_case: is no load case of `load_cases`; did you mean 'pushed'?"},
        {"ga", "{figure: psi, load_case: all, quantile: 0.9}", "quantile: has a meaning for over: samples alone"},
        {"lm", "{figure: psi, take: worst}", "take: has a meaning for load_case: all and over: samples alone"},
    };
    HIFDM(2, "check", survive_case("c.yaml", fault[_i][0], fault[_i][1]));
    ERR(fault[_i][2]);
    ERR("c.yaml:");
}
END_TEST

START_TEST(what_nets_need_is_named)
{
    static const char scene[] = SMALL_SCENE "optimize: {method: lm, objective: [%s]}\n%s";
    HIFDM(2, "check", file_with("c.yaml", formatted(scene, "{figure: psi, load_case: all}", "")));
    ERR("load_case: needs load cases of the as-built net");
    HIFDM(2, "check", file_with("c.yaml", formatted(scene, "{figure: psi, over: samples}", "")));
    ERR("over: samples needs a section tolerance");
    HIFDM(2, "check",
          file_with("c.yaml", formatted(scene, "{figure: psi, over: samples}", "tolerance: {sigma_cut_m: 1e-5}\n")));
    ERR("have no stiffness EA");
}
END_TEST

START_TEST(quantiles_have_no_derivatives)
{
    const char *c = survive_case("c.yaml", "ga", "{figure: psi, over: samples, quantile: 0.9}"), *d = temp("d.csv");
    HIFDM(0, "evaluate", c, "--template", d);
    HIFDM(2, "evaluate", c, "--designs", d, "--jacobian", temp("j.csv"));
    ERR("optimize.objective.0.quantile: quantiles have no derivatives. Use `take: mean` or `take: worst`\n");
}
END_TEST

Suite *suite_cli_survive(void)
{
    Suite *suite = suite_create("cli/survive");
    TCase *tests = tcase_create("survive");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, threads_change_nothing, 0, 3);
    tcase_add_loop_test(tests, killed_runs_go_on_to_the_same_bits, 0, 4);
    tcase_add_loop_test(tests, what_is_sought_is_found, 0, 2);
    tcase_add_test(tests, a_quantile_over_load_cases_is_refined);
    tcase_add_loop_test(tests, faults_of_nets_are_named, 0, 3);
    tcase_add_test(tests, what_nets_need_is_named);
    tcase_add_test(tests, quantiles_have_no_derivatives);
    return suite;
}
