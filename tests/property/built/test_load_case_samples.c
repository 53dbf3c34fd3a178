/* Samples of random nets in load cases, against hf_built_solve of a net with the same errors and the cutting lengths,
 * supports and loads of the load case (METHOD section 14). With and without a truss, by both methods of sampling. */
#include "built_nets.h"

#include "built/montecarlo.h"

enum { N_SAMPLE = 12, N_LOAD_CASE = 2 };

static const char *const name[N_LOAD_CASE] = {"hot", "pushed"};

#define ROW(kind, low, high)                                                                                           \
    {                                                                                                                  \
        .figure = HF_REQUIRED_##kind, .load_case = "all", .at_least = low, .at_most = high, .share = 0.5, .within = {  \
            -INFINITY,                                                                                                 \
            INFINITY                                                                                                   \
        }                                                                                                              \
    }
static const hf_requirement_settings row_table[] = {ROW(PSI, NAN, 1),          ROW(TENSION, 1, 100), ROW(RATIO, NAN, 9),
                                                    ROW(SLACK, NAN, 0),        ROW(LOOSE, NAN, 0),   ROW(PULL, NAN, 50),
                                                    ROW(DEFLECTION, NAN, 1e-3)};
enum { N_ROW = sizeof row_table / sizeof *row_table };

typedef struct {
    struct net net;
    double EA[MAX_BUILT_CABLE];
    hf_built built;
    hf_workspace work; /* of the reference */
    hf_tolerance_settings settings;
    hf_load_cases cases;
    hf_required required;
    double attachment_move_m[N_LOAD_CASE * 3 * MAX_ATTACHMENT], by_weight_m[N_LOAD_CASE * 3 * MAX_ATTACHMENT];
    hf_montecarlo m;
    double *z, *cut_m, *EA_N, *load_cut_m, *move_m, *load_move_m, *load_N, *spare_m;
    const hf_montecarlo_load_case *now;
    int n_done, n_slack, n_loose;
} study;

static void make_load_cases(study *s, struct rng *rng, double part)
{
    const hf_scene *scene = &s->net.scene;
    hf_material *t = &s->cases.material;
    ck_assert_int_eq(hf_load_cases_allocate(scene, 0, N_LOAD_CASE, &s->cases), HF_OK);
    ck_assert_int_eq(hf_material_allocate(scene, t), HF_OK);
    for (int e = 0; e < scene->n_cable; e++) {
        t->expansion_per_K[e] = rng_uniform(rng, -1e-5, 2e-5);
        t->mass_kg_per_m[e] = rng_uniform(rng, 0, 0.02);
    }
    for (int i = 0; i < scene->n_node; i++)
        t->node_mass_kg[i] = rng_uniform(rng, 0, 0.01);
    for (int k = 0; k < N_LOAD_CASE; k++) {
        hf_load_case *c = &s->cases.load_case[k];
        c->name = name[k];
        for (int e = 0; e < scene->n_cable; e++)
            c->rise_K[e] = part * rng_uniform(rng, -60, 40);
        for (int i = 0; i < 3 * scene->n_node; i++) {
            if (scene->role[i / 3] == HF_ROLE_SUPPORT)
                c->support_displacement_m[i] = part * rng_uniform(rng, -1e-3, 1e-3);
            c->force_N[i] = part * rng_uniform(rng, -0.5, 0.5);
        }
        c->gravity_m_per_s2[2] = k ? -9.81 : 0;
        c->has_temperature = true;
    }
    for (int i = 0; i < N_LOAD_CASE * 3 * MAX_ATTACHMENT; i++) {
        s->attachment_move_m[i] = part * rng_uniform(rng, -1e-4, 1e-4);
        s->by_weight_m[i] = rng_uniform(rng, -1e-4, 1e-4);
    }
}

static void open_study(study *s, int trial)
{
    struct rng rng = rng_start(8100 + (uint64_t)trial);
    bool on_truss = trial % 2;
    hf_messages messages = {0};
    *s = (study){.settings = {.sigma_cut_m = 1e-5,
                              .sigma_cut_ratio = 1e-5,
                              .sigma_EA_ratio = trial % 3 ? 0.01 : 0,
                              .sigma_support_m = trial % 4 == 3 ? 0 : 1e-5,
                              .sigma_load_case_temperature_K = trial % 7 == 3 ? 0 : 5,
                              .sigma_gravity_ratio = trial % 7 == 4 ? 0 : 0.1,
                              .sigma_force_ratio = trial % 7 == 5 ? 0 : 0.1,
                              .batch = 0.3,
                              .samples = N_SAMPLE,
                              .seed = 7,
                              .sampling = trial / 2 % 2 ? HF_SAMPLING_SOBOL : HF_SAMPLING_RANDOM}};
    if (trial % 5 == 4) s->settings.sigma_cut_m = 2e-2; /* with slack cables */
    open_design(&s->net, trial, s->EA, on_truss);
    make_built(&s->net, &s->built, &s->work);
    make_load_cases(s, &rng, trial % 5 == 2 ? 10 : 1);
    ck_assert_int_eq(
        hf_required_create(on_truss ? N_ROW : N_ROW - 1, row_table, &s->net.scene, &s->cases, NULL, &s->required),
        HF_OK);
    ck_assert_int_eq(hf_montecarlo_create(&s->settings, &s->built, NULL, NULL, NULL, 1, &s->m), HF_OK);
    const hf_built_rest rest = {s->attachment_move_m, s->by_weight_m}, none = {NULL, NULL};
    ck_assert_msg(hf_montecarlo_require(&s->m, &s->required, on_truss ? &rest : &none, &messages) == HF_OK, "%s",
                  messages.text);
    ck_assert_int_eq(s->m.n_load_case, N_LOAD_CASE);
    size_t n_cable = (size_t)s->built.model.n_cable, n = 3 * (size_t)s->built.model.n_node;
    s->z = calloc(s->m.n_z + 3 * n_cable + 4 * n, sizeof *s->z);
    ck_assert_ptr_nonnull(s->z);
    s->cut_m = s->z + s->m.n_z;
    s->EA_N = s->cut_m + n_cable;
    s->load_cut_m = s->EA_N + n_cable;
    s->move_m = s->load_cut_m + n_cable;
    s->load_move_m = s->move_m + n;
    s->load_N = s->load_move_m + n;
    s->spare_m = s->load_N + n;
}

static void close_study(study *s)
{
    free(s->z);
    hf_montecarlo_free(&s->m);
    hf_required_free(&s->required);
    hf_load_cases_free(&s->cases);
    hf_workspace_free(&s->work);
    hf_built_free(&s->built);
    close_design(&s->net);
}

static unsigned vary_now(const study *s)
{
    return hf_built_loaded_vary(&s->now->net, &s->m.errors);
}

static double error_of(const study *s, long i, hf_load_error kind)
{
    return hf_built_errors_of_load(&s->m.errors, i, kind, s->now->state - 1);
}

/* Sets load_N to the loads of sample i in the present load case: gravity and forces have other values. */
static void load_sample(study *s, long i)
{
    const hf_model *m = &s->built.model;
    hf_load_case c = *s->now->net.load_case;
    double force_N[3 * MAX_BUILT_CABLE]; /* there are fewer nodes than cables */
    hf_built_net unused;
    for (int k = 0; k < 3 * m->n_node; k++)
        force_N[k] = c.force_N[k] * (1 + error_of(s, i, HF_LOAD_ERROR_FORCE));
    c.force_N = force_N;
    c.gravity_m_per_s2[2] *= 1 + error_of(s, i, HF_LOAD_ERROR_GRAVITY);
    double *cut_m = s->EA_N, *move_m = s->spare_m; /* unread */
    hf_built_load_case(&s->built, &s->cases.material, &c, NULL, cut_m, move_m, s->load_N, &unused);
}

/* Draws the numbers of sample i anew and applies them to the nominal cutting lengths. */
static void apply_errors(study *s, long i, double *cut_m, double *EA_N, double *move_m)
{
    double point[64];
    if (s->m.directions.n) {
        ck_assert_int_le(s->m.directions.n, 64);
        hf_directions_points(&s->m.directions, i, 1, point);
        hf_directions_draw(&s->m.directions, i, point, s->z);
    } else {
        hf_built_errors_draw(&s->m.errors, i, s->z);
    }
    memcpy(cut_m, s->built.scene.target, (size_t)s->built.model.n_cable * sizeof *cut_m);
    hf_built_errors_apply(&s->m.errors, 1, s->z, cut_m, EA_N, move_m);
    const hf_load_case *c = s->now->net.load_case;
    double warmer_K = error_of(s, i, HF_LOAD_ERROR_TEMPERATURE), heavier = error_of(s, i, HF_LOAD_ERROR_GRAVITY);
    for (int e = 0; e < s->built.model.n_cable; e++)
        cut_m[e] *= 1 + s->cases.material.expansion_per_K[e] * (c->rise_K[e] + warmer_K);
    if (c->gravity_m_per_s2[2] == 0) heavier = 0;
    const hf_model *m = &s->built.model;
    for (int k = 0; k < 3 * m->n_attachment && heavier != 0; k++)
        move_m[k % 3 * m->n_node + m->attachment_row[k / 3]] +=
            heavier * s->by_weight_m[3 * (s->now->state - 1) * m->n_attachment + k];
}

static void make(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m, double *load_N)
{
    study *s = context;
    apply_errors(s, i, cut_m, EA_N, support_displacement_m);
    if (!load_N) return;
    load_sample(s, i);
    memcpy(load_N, s->load_N, 3 * (size_t)s->built.model.n_node * sizeof *load_N);
}

/* Finds sample i by the reference, in the nominal net with the changes of the load case. */
static void solve_again(study *s, long i, hf_form_result *r)
{
    const hf_model *m = &s->built.model;
    size_t n = 3 * (size_t)m->n_node;
    hf_built_net net;
    int k = s->now->state - 1;
    hf_built_load_case(&s->built, &s->cases.material, s->now->net.load_case,
                       m->n_attachment ? s->attachment_move_m + 3 * k * m->n_attachment : NULL, s->load_cut_m,
                       s->load_move_m, s->load_N, &net);
    if (i >= 0) load_sample(s, i);
    memcpy(s->move_m, s->load_move_m, n * sizeof(double));
    memcpy(s->EA_N, s->built.model.EA_N, (size_t)m->n_cable * sizeof(double));
    if (i >= 0) {
        apply_errors(s, i, s->cut_m, s->m.varies & HF_BUILT_VARIES_EA ? s->EA_N : NULL,
                     vary_now(s) & HF_BUILT_VARIES_SUPPORTS ? s->move_m : NULL);
        net = (hf_built_net){s->cut_m, s->EA_N, s->move_m, s->load_N};
    }
    hf_built_solve(&s->built, &net, &s->work, r);
}

/* Loose nodes, and nodes that a nearly slack cable holds, have next to no stiffness (tests/property/built/
 * test_samples.c). */
static double near_m(const hf_form_result *r)
{
    return r->n_slack ? 1e-7 : 1e-9;
}

static void demand_shape(const study *s, const char *what, long i, const double *position_m, const double *tension_N,
                         const hf_form_result *r)
{
    const hf_model *m = &s->built.model;
    for (int k = 0; k < 3 * m->n_node; k++)
        ck_assert_msg(fabs(position_m[k] - s->work.position_m[k]) < near_m(r),
                      "%s, %s %ld: row %d is %g m away; %d slack cables, %d loose nodes", s->now->net.load_case->name,
                      what, i, k % m->n_node, position_m[k] - s->work.position_m[k], r->n_slack, r->n_loose);
    for (int e = 0; e < m->n_cable; e++)
        ck_assert_double_eq_tol(tension_N[e], s->work.tension_N[e], 1e-6 * m->reference_N);
}

/* Returns the value of the column in the present load case. */
static double value_of(const study *s, long i, hf_required_figure figure, bool is_minimum)
{
    const double *row = s->m.row + i * s->m.n_value;
    for (int k = 0; k < s->required.n_column; k++)
        if (s->required.column[k].figure == figure && s->required.column[k].is_minimum == is_minimum)
            return row[hf_montecarlo_value_at(&s->required, s->now->state, false) + (size_t)k];
    ck_abort_msg("no such column");
    return 0;
}

/* Demands that the displacements by the truss lead from the resting positions, which move_m changes, to the shape.
 * Returns the maximum. */
static double demand_displacements(const hf_model *m, const double *position_m, const double *displacement_m,
                                   const double *move_m)
{
    double most_m = 0;
    for (int k = 0; k < m->n_attachment; k++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            int at = c * m->n_node + m->attachment_row[k];
            double rest_m = m->position_m[at] + move_m[at];
            ck_assert_double_eq_tol(displacement_m[3 * k + c], position_m[at] - rest_m, 1e-9);
            square += pow(position_m[at] - rest_m, 2);
        }
        most_m = fmax(most_m, sqrt(square));
    }
    return most_m;
}

/* Demands that the row of sample i has the figures of its shape. */
static void demand_row(const study *s, long i, const hf_built_shape *is, const hf_form_result *r)
{
    const hf_model *m = &s->built.model;
    double least_N = INFINITY, most_N = -INFINITY, square = 0;
    for (int e = 0; e < m->n_cable; e++) {
        least_N = fmin(least_N, is->tension_N[e]);
        most_N = fmax(most_N, is->tension_N[e]);
    }
    for (int k = 0; k < m->n_inner_node; k++)
        for (int c = 0; c < 3; c++) {
            int at = c * m->n_node + m->inner_row[k];
            square += pow(is->position_m[at] - m->position_m[at], 2);
        }
    double near_N = 1e-9 * m->reference_N; /* the row has loads that were added up in another order */
    ck_assert_double_eq_tol(value_of(s, i, HF_REQUIRED_TENSION, true), least_N, near_N);
    ck_assert_double_eq_tol(value_of(s, i, HF_REQUIRED_TENSION, false), most_N, near_N);
    ck_assert_double_eq_tol(value_of(s, i, HF_REQUIRED_PSI, false), sqrt(square / m->n_inner_node), 1e-12);
    ck_assert_double_eq(value_of(s, i, HF_REQUIRED_SLACK, false), r->n_slack);
    ck_assert_double_eq(value_of(s, i, HF_REQUIRED_LOOSE, false), r->n_loose);
    if (least_N < HF_SLACK_RATIO * m->reference_N)
        ck_assert(isinf(value_of(s, i, HF_REQUIRED_RATIO, false)));
    else
        ck_assert_double_eq_tol(value_of(s, i, HF_REQUIRED_RATIO, false), most_N / least_N, 1e-7 * most_N / least_N);
}

static void hold_against(void *context, long i, const hf_built_shape *shape, const hf_form_result *r)
{
    study *s = context;
    hf_form_result again;
    solve_again(s, i, &again);
    s->n_done++;
    ck_assert_int_eq(r->status, HF_OK);
    ck_assert_int_eq(again.status, HF_OK);
    ck_assert_int_eq(r->n_slack, again.n_slack);
    ck_assert_int_eq(r->n_loose, again.n_loose);
    s->n_slack += r->n_slack;
    s->n_loose += r->n_loose;
    demand_shape(s, "sample", i, shape->position_m, shape->tension_N, r);
    demand_row(s, i, shape, r);
    if (!s->built.model.n_attachment) return;
    double deflection_m = demand_displacements(&s->built.model, s->work.position_m, s->work.displacement_m, s->move_m);
    for (int k = 0; k < 3 * s->built.model.n_node; k++)
        s->move_m[k] -= s->load_move_m[k]; /* the net in the load case has these already */
    demand_displacements(&s->now->net.built.model, shape->position_m, shape->displacement_m, s->move_m);
    ck_assert_double_eq_tol(value_of(s, i, HF_REQUIRED_DEFLECTION, false), deflection_m, 1e-9);
}

START_TEST(samples_in_load_cases_are_those_of_the_reference)
{
    static study s;
    open_study(&s, _i);
    ck_assert_int_eq(hf_montecarlo_run(&s.m, 1, 0, N_SAMPLE), HF_OK);
    for (int k = 0; k < N_LOAD_CASE; k++) {
        s.now = &s.m.load_case[k];
        ck_assert_int_eq(s.now->state, 1 + k);
        hf_built_batch_run(s.now->net.batch, vary_now(&s), 0, N_SAMPLE, make, hold_against, &s);
    }
    ck_assert_int_eq(s.n_done, N_LOAD_CASE * N_SAMPLE);
    if (_i % 5 == 4) ck_assert_int_gt(s.n_slack, 0);
    close_study(&s);
}
END_TEST

/* Without errors, the net of a load case has the shape of the load case, as it is stored and as it is solved. */
START_TEST(a_net_in_a_load_case_is_that_of_the_load_case)
{
    static study s;
    hf_workspace w;
    open_study(&s, _i);
    for (int k = 0; k < N_LOAD_CASE; k++) {
        hf_form_result loaded, again;
        s.now = &s.m.load_case[k];
        const hf_built *b = &s.now->net.built;
        solve_again(&s, -1, &loaded);
        ck_assert_int_eq(loaded.status, HF_OK);
        demand_shape(&s, "nominal", -1, b->position_m, b->tension_N, &loaded);
        ck_assert_int_eq(hf_workspace_create(&b->model, &w), HF_OK);
        poison_workspace(&b->model, &w);
        ck_assert_int_eq(hf_built_solve(b, &(hf_built_net){NULL, NULL, NULL, NULL}, &w, &again), HF_OK);
        demand_shape(&s, "solved", -1, w.position_m, w.tension_N, &loaded);
        ck_assert_int_eq(again.n_slack, loaded.n_slack); /* the limit of slack cables is that of the design */
        ck_assert_double_eq_tol(again.psi_m, loaded.psi_m, near_m(&loaded));
        hf_workspace_free(&w);
    }
    close_study(&s);
}
END_TEST

Suite *suite_property_load_case_samples(void)
{
    Suite *suite = suite_create("property/load_case_samples");
    TCase *tcase = tcase_create("samples in load cases");
    tcase_add_loop_test(tcase, samples_in_load_cases_are_those_of_the_reference, 0, 20);
    tcase_add_loop_test(tcase, a_net_in_a_load_case_is_that_of_the_load_case, 0, 20);
    suite_add_tcase(suite, tcase);
    return suite;
}
