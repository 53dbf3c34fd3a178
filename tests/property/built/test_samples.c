/* Samples of nets as built, many at a time: random reflectors, and whole cases, tied nets and a net on its truss among
 * them, against hf_built_solve. */
#include "built_nets.h"

#include <hifdm/problem.h>

enum { N_SAMPLE = 8 };

/* The nearest to slack that a node is, in N/m, is a thousandth of tensions of 10 N over lengths of 1 m; forces balance
 * to 1e-10 N. */
#define NEAR_M 1e-7

struct sampling {
    const hf_built *built;
    struct errors errors;
    unsigned varies;
    hf_workspace reference; /* of room 0; there is one thread where it is used */
    double *cut_m, *EA_N, *move_m;
    int n_done, n_slack, n_loose;
};

static void make(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m, double *load_N)
{
    (void)load_N;
    make_errors(&((struct sampling *)context)->errors, i, cut_m, EA_N, support_displacement_m);
}

/* The same sample by the reference. */
static void solve_again(struct sampling *s, long i, hf_form_result *r)
{
    const hf_model *m = &s->built->model;
    bool has_EA = s->varies & HF_BUILT_VARIES_EA, has_supports = s->varies & HF_BUILT_VARIES_SUPPORTS;
    memcpy(s->cut_m, m->target, (size_t)m->n_cable * sizeof(double));
    memcpy(s->EA_N, m->EA_N, (size_t)m->n_cable * sizeof(double));
    memset(s->move_m, 0, 3 * (size_t)m->n_node * sizeof(double));
    make(s, i, s->cut_m, has_EA ? s->EA_N : NULL, has_supports ? s->move_m : NULL, NULL);
    hf_built_solve(s->built, &(hf_built_net){s->cut_m, s->EA_N, s->move_m, NULL}, &s->reference, r);
}

static void hold_against(void *context, long i, const hf_built_shape *shape, const hf_form_result *r)
{
    struct sampling *s = context;
    const hf_model *m = &s->built->model;
    hf_form_result again;
    solve_again(s, i, &again);
    s->n_done++;
    ck_assert_msg(r->status == again.status, "sample %ld: %s, by the reference %s", i, hf_status_word(r->status),
                  hf_status_word(again.status));
    if (r->status != HF_OK) return;
    s->n_slack += r->n_slack;
    s->n_loose += r->n_loose;
    ck_assert_int_eq(r->n_slack, again.n_slack);
    ck_assert_int_eq(r->n_loose, again.n_loose);
    for (int k = 0; k < 3 * m->n_node; k++)
        ck_assert_msg(fabs(shape->position_m[k] - s->reference.position_m[k]) < NEAR_M,
                      "sample %ld: row %d is %g m away; %d slack cables, %d loose nodes", i, k % m->n_node,
                      shape->position_m[k] - s->reference.position_m[k], r->n_slack, r->n_loose);
    for (int e = 0; e < m->n_cable; e++)
        ck_assert_double_eq_tol(shape->tension_N[e], s->reference.tension_N[e], 1e-6 * m->reference_N);
}

static void run_samples(const hf_built *built, struct errors errors, unsigned varies, struct sampling *s)
{
    const hf_model *m = &built->model;
    hf_built_batch *batch;
    *s = (struct sampling){.built = built, .errors = errors, .varies = varies};
    s->cut_m = calloc(2 * (size_t)m->n_cable + 3 * (size_t)m->n_node, sizeof(double));
    ck_assert_ptr_nonnull(s->cut_m);
    s->EA_N = s->cut_m + m->n_cable;
    s->move_m = s->EA_N + m->n_cable;
    ck_assert_int_eq(hf_workspace_create(m, &s->reference), HF_OK);
    ck_assert_int_eq(hf_built_batch_create(built, 1, &batch), HF_OK);
    hf_built_batch_run(batch, varies, 0, N_SAMPLE, make, hold_against, s);
    ck_assert_int_eq(s->n_done, N_SAMPLE);
    hf_built_batch_free(batch);
    hf_workspace_free(&s->reference);
    free(s->cut_m);
}

static double decades(struct rng *rng, double low, double high)
{
    return exp(rng_uniform(rng, log(low), log(high)));
}

static struct errors random_errors(struct rng *rng, const hf_built *built)
{
    return (struct errors){&built->model, rng_next(rng), decades(rng, 1e-6, 1e-2), rng_uniform(rng, 0, 0.2),
                           decades(rng, 1e-6, 1e-2)};
}

START_TEST(random_reflectors)
{
    struct rng rng = rng_start(7100 + (uint64_t)_i);
    struct net net = {.form = tight_form(HF_METHOD_NEWTON)};
    struct sampling s;
    hf_built built;
    hf_messages messages = {0};
    random_reflector_scene(&rng, &net.scene);
    double *EA = malloc((size_t)net.scene.n_cable * sizeof *EA);
    ck_assert_ptr_nonnull(EA);
    for (int e = 0; e < net.scene.n_cable; e++)
        EA[e] = decades(&rng, 1e4, 1e6);
    net.scene.EA_N = EA;
    open_net(&net);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_eq(hf_built_make("x.yaml", &net.scene, &net.model, &net.form, &net.work, &built, &messages), HF_OK);
    run_samples(&built, random_errors(&rng, &built), (unsigned)_i % 4, &s);
    hf_built_free(&built);
    close_design(&net);
    free(EA);
}
END_TEST

static const struct {
    const char *path, *set[4];
    double width_m;
} case_table[] = {
    {"configs/reflector.yaml", {NULL}, 1e-5},
    {"configs/reflector.yaml", {NULL}, 1e-4},
    {"configs/reflector.yaml", {NULL}, 1e-3},
    {"configs/cylinder-tied-8m.yaml", {NULL}, 1e-5},
    {"configs/cylinder-tied-8m.yaml", {NULL}, 3e-4},
    {"configs/paraboloid-6m.yaml", {NULL}, 1e-4},
    {"configs/straight-edges-truss.yaml",
     {"scene.parabolic_cylinder.boundary=outer_edge", "scene.parabolic_cylinder.scallop=0.1"},
     1e-5},
    {"configs/straight-edges-truss.yaml",
     {"scene.parabolic_cylinder.boundary=outer_edge", "scene.parabolic_cylinder.scallop=0.1"},
     3e-4},
};
enum { N_CASE = sizeof case_table / sizeof *case_table };

START_TEST(whole_cases)
{
    const char *set[10] = {"scene.EA_inner_N=1e5",          "scene.EA_boundary_N=2e5",     "form.stop=residual",
                           "form.residual_tolerance=1e-11", "form.length_tolerance=1e-12", "coupling.tof_m=1e-11"};
    int n_set = 6;
    hf_problem problem;
    struct sampling s;
    hf_built built;
    hf_messages messages = {0};
    for (int k = 0; k < 4 && case_table[_i].set[k]; k++)
        set[n_set++] = case_table[_i].set[k];
    ck_assert_msg(hf_problem_open(source_path(case_table[_i].path), set, n_set, 1, &problem, &messages) == HF_OK, "%s",
                  messages.text);
    ck_assert_msg(hf_built_make("x.yaml", &problem.scene, &problem.model, &problem.settings.form, &problem.workspace,
                                &built, &messages) == HF_OK,
                  "%s", messages.text);
    double width_m = case_table[_i].width_m;
    struct errors errors = {&built.model, 9000 + (uint64_t)_i, width_m, 0.05, width_m};
    run_samples(&built, errors, HF_BUILT_VARIES_EA | HF_BUILT_VARIES_SUPPORTS, &s);
    hf_built_free(&built);
    hf_problem_free(&problem);
    hf_messages_free(&messages);
}
END_TEST

Suite *suite_property_samples(void)
{
    Suite *suite = suite_create("property/samples");
    TCase *tcase = tcase_create("samples");
    tcase_add_loop_test(tcase, random_reflectors, 0, 16);
    tcase_add_loop_test(tcase, whole_cases, 0, N_CASE);
    suite_add_tcase(suite, tcase);
    return suite;
}
