/* A case opened by one call: the same bits as the steps one by one and as a run, every refusal with its words and
 * freed by the one call, and from several threads at once. */
#include "nets.h"

#include <hifdm/problem.h>
#include <hifdm/run.h>
#include <pthread.h>

enum { N_DESIGN = 12 };

/* Where psi of N_DESIGN designs around the base goes, bit by bit. */
struct outcome {
    hf_status status;
    double form_psi_m, psi_m[N_DESIGN];
};

static void evaluate_designs(hf_problem *p, struct outcome *outcome)
{
    hf_form_result result[N_DESIGN];
    size_t n_variable = (size_t)p->model.n_variable;
    double *design = malloc((N_DESIGN * n_variable + 1) * sizeof *design);
    for (size_t i = 0; i < N_DESIGN; i++)
        for (size_t k = 0; k < n_variable; k++)
            design[i * n_variable + k] = p->initial[k] * (1 + 0.01 * (double)i);
    hf_batch_run(&p->batch, N_DESIGN, design, NULL, result);
    for (int i = 0; i < N_DESIGN; i++)
        outcome->psi_m[i] = result[i].psi_m;
    outcome->form_psi_m = p->form.psi_m;
    free(design);
}

static struct outcome open_and_evaluate(const char *path, int n_thread)
{
    static const char *const set[] = {"form.pretension_N=12"};
    struct outcome outcome = {0};
    hf_problem p;
    hf_messages said = {0};
    outcome.status = hf_problem_open(path, set, 1, n_thread, &p, &said);
    if (outcome.status == HF_OK) evaluate_designs(&p, &outcome);
    hf_problem_free(&p);
    hf_messages_free(&said);
    return outcome;
}

/* ---- what it gives ---- */

static const char *const cases[] = {"configs/straight-edges.yaml", "configs/straight-edges-truss.yaml",
                                    "configs/reflector.yaml"};
enum { N_CASE = sizeof cases / sizeof *cases };

START_TEST(opening_gives_what_a_run_finds)
{
    char output[HF_OUTPUT_SIZE];
    static hf_summary s;
    static const char *const set[] = {"optimize.generations=1", "optimize.refine_steps=1"};
    hf_messages said = {0};
    hf_problem p;
    hf_run_request request = {
        .input = {source_path(cases[_i]), .set = set, .n_set = 2}, .output.no_file = true, .control.threads = 2};
    ck_assert_msg(hf_run_case(&request, &s, output, &said) == HF_OK, "%s", said.text);
    ck_assert_msg(hf_problem_open(source_path(cases[_i]), set, 2, 2, &p, &said) == HF_OK, "%s", said.text);
    ck_assert_mem_eq(&p.form.psi_m, &s.stage[HF_STAGE_FORM].result.psi_m, sizeof(double));
    ck_assert_int_eq(p.form.iterations, s.stage[HF_STAGE_FORM].result.iterations);
    ck_assert_int_eq(p.model.n_variable, s.n_variable);
    ck_assert_int_eq(p.batch.n_thread, 2);
    for (int k = 0; k < p.model.n_variable; k++)
        ck_assert_double_gt(p.initial[k], 0);
    if (s.stage[HF_STAGE_SEARCH].exists) { /* the base design is individual 0 */
        hf_form_result base;
        hf_batch_run(&p.batch, 1, p.initial, NULL, &base);
        ck_assert_mem_eq(&base.psi_m, &s.search.initial_psi_m, sizeof(double));
        ck_assert_int_eq(p.solver, s.search.solver);
    }
    hf_problem_free(&p);
    hf_messages_free(&said);
}
END_TEST

START_TEST(threads_do_not_change_a_bit)
{
    struct outcome one = open_and_evaluate(source_path(cases[_i]), 1), four;
    four = open_and_evaluate(source_path(cases[_i]), 4);
    ck_assert_int_eq(one.status, HF_OK);
    ck_assert_double_gt(one.psi_m[0], 0);
    ck_assert_mem_eq(&one, &four, sizeof one);
}
END_TEST

/* Every boundary cable between two supports: nothing to design, and still a shape. */
START_TEST(a_net_without_genes_is_opened)
{
    hf_problem p;
    hf_messages said = {0};
    const char *path = temp_path("c.yaml");
    write_file(path, "scene: {parabolic_cylinder: {aperture_m: 2, length_m: 2, focal_length_m: 2, modules: [1, 1], "
                     "cells_per_module: [3, 3], supports: perimeter}}\n");
    ck_assert_msg(hf_problem_open(path, NULL, 0, 2, &p, &said) == HF_OK, "%s", said.text);
    ck_assert_int_eq(p.model.n_variable, 0);
    ck_assert_int_eq(p.solver, HF_SOLVER_AUTO);
    ck_assert_double_gt(p.form.psi_m, 0);
    hf_problem_free(&p);
    hf_messages_free(&said);
}
END_TEST

/* ---- refusals ---- */

#define SMALL_NET(more)                                                                                                \
    "scene: {parabolic_cylinder: {aperture_m: 4, length_m: 5, focal_length_m: 5, modules: [2, 2], cells_per_module: "  \
    "[2, 2]" more "}}\n"

static const struct refusal {
    const char *text; /* NULL: there is no such file */
    hf_status status;
    const char *words;
} refusals[] = {
    {NULL, HF_BAD_CASE, "No such file"},
    {"scene: {}\nfrom: {}\n", HF_BAD_CASE, "from: unknown key"},
    {SMALL_NET(""), HF_STRAIGHT_CHAIN, "ill-posed: 4 straight chains"},
    {SMALL_NET(", scallop: 0.1") "form: {max_iterations: 3, stop: residual, method: hifdm}\n", HF_NOT_CONVERGED,
     "did not converge in 3 iterations"},
    {SMALL_NET(", scallop: 0.1") "optimize: {method: lm, rule: seeded}\n", HF_BAD_CASE, "Levenberg-Marquardt needs"},
    {SMALL_NET(", scallop: 0.1") "optimize: {min_tension_N: 1e4, max_tension_N: 2e4}\n", HF_BAD_CASE,
     "does not overlap the interval from min_tension_N"},
    {SMALL_NET(", scallop: 0.1") "truss: {bud: {diameter_m: 1e-4, wall_m: 4e-5}, mbug: {diameter_m: 1e-4, wall_m: "
                                 "4e-5}, abug: {diameter_m: 1e-4, wall_m: 4e-5}}\ncoupling: {scheme: accelerated}\n",
     HF_TRUSS_TOO_SOFT, "the truss is too soft"},
};
enum { N_REFUSAL = sizeof refusals / sizeof *refusals };

START_TEST(a_refusal_has_words_and_leaves_nothing)
{
    const struct refusal *r = &refusals[_i];
    const char *path = temp_path("refused.yaml");
    static const hf_problem zero;
    static hf_problem p;
    hf_messages said = {0};
    if (r->text) write_file(path, r->text);
    hf_status status = hf_problem_open(path, NULL, 0, 2, &p, &said);
    ck_assert_msg(status == r->status, "%s: %s", hf_status_word(status), said.text);
    ck_assert_msg(strstr(said.text, r->words), "%s", said.text);
    ck_assert_int_ge(said.n_error, 1);
    ck_assert_ptr_null(p.batch.workspace);
    if (status == HF_NOT_CONVERGED) ck_assert_double_gt(p.form.residual_N, 0);
    hf_problem_free(&p);
    ck_assert_mem_eq(&p, &zero, sizeof p);
    hf_problem_free(&p); /* of a problem that is all zero: nothing */
    hf_messages_free(&said);
}
END_TEST

/* ---- several at once ---- */

struct job {
    const char *path;
    struct outcome outcome;
};

static void *open_in_thread(void *context)
{
    struct job *j = context;
    j->outcome = open_and_evaluate(j->path, 2);
    return NULL;
}

START_TEST(two_threads_open_at_once)
{
    char path[N_CASE][HF_PATH_SIZE];
    struct outcome alone[N_CASE];
    for (int i = 0; i < N_CASE; i++) {
        snprintf(path[i], sizeof path[i], "%s", source_path(cases[i]));
        alone[i] = open_and_evaluate(path[i], 2);
        ck_assert_int_eq(alone[i].status, HF_OK);
    }
    for (int round = 0; round < 4; round++) {
        struct job job[2] = {{.path = path[round % N_CASE]}, {.path = path[(round + 1) % N_CASE]}};
        pthread_t thread[2];
        for (int k = 0; k < 2; k++)
            ck_assert_int_eq(pthread_create(&thread[k], NULL, open_in_thread, &job[k]), 0);
        for (int k = 0; k < 2; k++)
            ck_assert_int_eq(pthread_join(thread[k], NULL), 0);
        for (int k = 0; k < 2; k++)
            ck_assert_mem_eq(&job[k].outcome, &alone[(round + k) % N_CASE], sizeof(struct outcome));
    }
}
END_TEST

Suite *suite_unit_problem(void)
{
    Suite *suite = suite_create("unit/run/problem");
    TCase *tests = tcase_create("problem");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, opening_gives_what_a_run_finds, 0, N_CASE);
    tcase_add_loop_test(tests, threads_do_not_change_a_bit, 0, N_CASE);
    tcase_add_test(tests, a_net_without_genes_is_opened);
    tcase_add_loop_test(tests, a_refusal_has_words_and_leaves_nothing, 0, N_REFUSAL);
    tcase_add_test(tests, two_threads_open_at_once);
    return suite;
}
