/* States of the net as built: by hand for few cables; heat alone is a pure scaling; gravity upside down. */
#include "flexible.h"
#include "laws.h"

#include <hifdm/built.h>

/* A net that is built, with a state of nothing and arrays for what it makes of the net. */
struct built_net {
    struct net design;
    double EA[400];
    hf_built built;
    hf_workspace work;
    hf_load_cases load_cases;
    hf_load_case *load_case;
    double *cut_m, *move_m, *load_N, *attachment_move_m;
};

static void build_design(struct built_net *b)
{
    hf_messages messages = {0};
    struct net *net = &b->design;
    net->scene.EA_N = b->EA;
    ck_assert_int_eq(hf_evaluate_form(&net->model, &net->form, &net->work, NULL, &net->result), HF_OK);
    ck_assert_msg(hf_built_make("x.yaml", &net->scene, &net->model, &net->form, &net->work, &b->built, &messages) ==
                      HF_OK,
                  "%s", messages.text);
    ck_assert_int_eq(hf_workspace_create(&b->built.model, &b->work), HF_OK);
    poison_workspace(&b->built.model, &b->work);
    ck_assert_int_eq(hf_load_cases_allocate(&net->scene, 0, 1, &b->load_cases), HF_OK);
    ck_assert_int_eq(hf_material_allocate(&net->scene, &b->load_cases.material), HF_OK);
    b->load_case = b->load_cases.load_case;
    size_t n = (size_t)net->model.n_node;
    b->cut_m = calloc((size_t)net->model.n_cable + 9 * n, sizeof *b->cut_m);
    ck_assert_ptr_nonnull(b->cut_m);
    b->move_m = b->cut_m + net->model.n_cable;
    b->load_N = b->move_m + 3 * n;
    b->attachment_move_m = b->load_N + 3 * n;
}

static void find_load_case(struct built_net *b)
{
    hf_built_net net;
    hf_form_result r;
    hf_built_load_case(&b->built, &b->load_cases.material, b->load_case,
                       b->design.model.n_attachment ? b->attachment_move_m : NULL, b->cut_m, b->move_m, b->load_N,
                       &net);
    ck_assert_int_eq(hf_built_solve(&b->built, &net, &b->work, &r), HF_OK);
}

static double position_m(const struct built_net *b, int i_node, int c)
{
    return b->work.position_m[c * b->design.model.n_node + b->design.model.row_of_node[i_node]];
}

static void close_built(struct built_net *b)
{
    free(b->cut_m);
    hf_load_cases_free(&b->load_cases);
    hf_workspace_free(&b->work);
    hf_built_free(&b->built);
    b->design.scene.EA_N = NULL;
    close_net(&b->design);
}

/* ---- by hand ---- */

static const struct hand_node line_node[] = {
    {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 0, -1}, HF_ROLE_INNER, {0}}, {{0, 0, -3}, HF_ROLE_SUPPORT, {0}}};
static const struct hand_cable line_cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 20},
                                               {{1, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 20}};

/* T = (L - l1 - l2) / (l1/EA1 + l2/EA2), of lengths l that have grown. */
START_TEST(two_cables_in_line_under_temperature)
{
    struct built_net b = {.EA = {2000, 5000}};
    OPEN_HAND(&b.design, line_node, line_cable, HF_METHOD_NEWTON);
    build_design(&b);
    double l[2];
    for (int e = 0; e < 2; e++) {
        b.load_cases.material.expansion_per_K[e] = e ? 2e-5 : -1e-6;
        b.load_case->rise_K[e] = -50 * (1 + e);
        l[e] = b.built.scene.target[e] * (1 + (e ? 2e-5 * -100 : -1e-6 * -50));
    }
    find_load_case(&b);
    double T = (3 - l[0] - l[1]) / (l[0] / 2000 + l[1] / 5000);
    for (int e = 0; e < 2; e++)
        ck_assert_double_eq_tol(b.work.tension_N[e], T, 1e-9);
    ck_assert_double_eq_tol(position_m(&b, 1, 2), -l[0] * (1 + T / 2000), 1e-13);
    close_built(&b);
}
END_TEST

/* Below a support and above another: T1 - T2 is the weight of the node and of half of both cables. With u down,
 * T = EA (length/l0 - 1): linear in u. */
START_TEST(a_node_hangs_by_its_weight)
{
    struct built_net b = {.EA = {2000, 5000}};
    OPEN_HAND(&b.design, line_node, line_cable, HF_METHOD_NEWTON);
    build_design(&b);
    const double *l0 = b.built.scene.target, g = 9.81;
    hf_material *t = &b.load_cases.material;
    t->node_mass_kg[1] = 0.5;
    t->node_mass_kg[0] = t->node_mass_kg[2] = 100; /* on supports */
    t->mass_kg_per_m[0] = 0.1;
    t->mass_kg_per_m[1] = 0.3;
    b.load_case->gravity_m_per_s2[2] = -g;
    b.load_case->force_N[3 * 1 + 2] = -1.5;
    b.load_case->support_displacement_m[3 * 2 + 2] = -0.001;
    find_load_case(&b);
    double weight = 1.5 + g * (0.5 + 0.1 * l0[0] / 2 + 0.3 * l0[1] / 2), k1 = 2000 / l0[0], k2 = 5000 / l0[1];
    double u = (weight + (k2 * (2.001 - l0[1]) - k1 * (1 - l0[0]))) / (k1 + k2);
    ck_assert_double_eq_tol(position_m(&b, 1, 2), -1 - u, 1e-13);
    ck_assert_double_eq_tol(b.work.tension_N[0] - b.work.tension_N[1], weight, 1e-9);
    ck_assert_double_eq_tol(b.work.tension_N[0], k1 * (1 + u - l0[0]), 1e-9);
    close_built(&b);
}
END_TEST

/* Three cables from a ring of radius 1 to the node in its middle, warm and pulled down: 3 T z/l = F, by bisection. */
START_TEST(three_cables_hold_a_node)
{
    struct built_net b = {.EA = {3000, 3000, 3000}};
    struct hand_node node[4] = {{.role = HF_ROLE_INNER}};
    struct hand_cable cable[3];
    for (int k = 0; k < 3; k++) {
        node[k + 1] = (struct hand_node){{cos(k * 2 * M_PI / 3), sin(k * 2 * M_PI / 3), 0}, HF_ROLE_SUPPORT, {0}};
        cable[k] = (struct hand_cable){{0, k + 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 8};
    }
    OPEN_HAND(&b.design, node, cable, HF_METHOD_NEWTON);
    build_design(&b);
    for (int e = 0; e < 3; e++) {
        b.load_cases.material.expansion_per_K[e] = 1e-5;
        b.load_case->rise_K[e] = 150;
    }
    b.load_case->force_N[2] = -2;
    find_load_case(&b);
    double l0 = 1 / (1 + 8.0 / 3000) * (1 + 1e-5 * 150), low = 0, high = 1;
    for (int i = 0; i < 60; i++) {
        double z = (low + high) / 2, l = sqrt(1 + z * z);
        *(3 * 3000 * (l / l0 - 1) * z / l > 2 ? &high : &low) = z;
    }
    ck_assert_double_eq_tol(position_m(&b, 0, 2), -low, 1e-11);
    ck_assert_double_eq_tol(position_m(&b, 0, 0), 0, 1e-12);
    for (int e = 0; e < 3; e++)
        ck_assert_double_eq_tol(b.work.tension_N[e], 3000 * (sqrt(1 + low * low) / l0 - 1), 1e-8);
    close_built(&b);
}
END_TEST

/* ---- exact properties of nets ---- */

/* One expansion everywhere, supports that expand alike: all places are multiplied by 1 + alpha dT, and tensions stay,
 * since strains and directions do. On a truss its deflection must grow as well, which it does not by itself: the
 * flexibility is that of the truss as it was made. So attachments are moved by what is missing. Places span up to 12 m,
 * to 1e-12 of it. */
START_TEST(uniform_heat_is_a_scaling)
{
    struct built_net b = {0};
    struct rng rng = rng_start(4100 + (uint64_t)_i);
    bool on_truss = _i % 2;
    double strain = (_i % 4 < 2 ? 1 : -1) * 2.5e-3;
    b.design.form = tight_form(HF_METHOD_NEWTON);
    b.design.form.residual_tolerance = 2e-13;
    random_tension_scene(&rng, &b.design.scene);
    for (int e = 0; e < b.design.scene.n_cable; e++)
        b.EA[e] = rng_uniform(&rng, 300, 1000);
    open_net(&b.design);
    b.design.form.coupling = (hf_coupling_settings){1e-15, HF_COUPLING_AUTO, 500};
    if (on_truss) attach_all(&b.design, &rng, 1e-5);
    build_design(&b);
    const hf_model *m = &b.design.model;
    for (int e = 0; e < m->n_cable; e++) {
        b.load_cases.material.expansion_per_K[e] = 2.5e-5;
        b.load_case->rise_K[e] = strain / 2.5e-5;
    }
    const double *rest = b.built.scene.position_m;
    for (int i = 0; i < 3 * m->n_node; i++)
        if (b.design.scene.role[i / 3] == HF_ROLE_SUPPORT) b.load_case->support_displacement_m[i] = strain * rest[i];
    for (int k = 0; k < 3 * m->n_attachment; k++)
        b.attachment_move_m[k] = strain * b.design.work.displacement_m[k];
    find_load_case(&b);
    double largest_N = b.built.model.reference_N;
    for (int i = 0; i < 3 * m->n_node; i++)
        ck_assert_double_eq_tol(b.work.position_m[i], (1 + strain) * b.built.position_m[i], 1e-12 * 12);
    for (int e = 0; e < m->n_cable; e++)
        ck_assert_double_eq_tol(b.work.tension_N[e], b.built.tension_N[e], 1e-11 * largest_N);
    close_built(&b);
}
END_TEST

/* A flat net in equilibrium in its plane: gravity up is the mirror image of gravity down. */
START_TEST(gravity_upside_down_mirrors_a_flat_net)
{
    enum { SIDE = 6, N = SIDE * SIDE };
    struct hand_node node[N];
    struct hand_cable cable[2 * N];
    struct rng rng = rng_start(4200 + (uint64_t)_i);
    struct built_net b = {0};
    double below[3 * N];
    int n_cable = 0;
    for (int k = 0; k < N; k++) {
        int i = k % SIDE, j = k / SIDE;
        bool is_support = i == 0 || j == 0 || i == SIDE - 1 || j == SIDE - 1;
        node[k] = (struct hand_node){{i + rng_uniform(&rng, -0.2, 0.2), j + rng_uniform(&rng, -0.2, 0.2), 0},
                                     is_support ? HF_ROLE_SUPPORT : HF_ROLE_INNER,
                                     {0}};
        for (int axis = 0; axis < 2; axis++) {
            if (axis == 0 ? i + 1 == SIDE : j + 1 == SIDE) continue;
            b.EA[n_cable] = rng_uniform(&rng, 1e3, 1e4);
            cable[n_cable++] = (struct hand_cable){
                {k, axis ? k + SIDE : k + 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, rng_uniform(&rng, 2, 20)};
        }
    }
    open_hand(&b.design, N, node, n_cable, cable, HF_METHOD_NEWTON);
    build_design(&b);
    for (int e = 0; e < n_cable; e++)
        b.load_cases.material.mass_kg_per_m[e] = rng_uniform(&rng, 0, 0.5);
    for (int i = 0; i < N; i++)
        b.load_cases.material.node_mass_kg[i] = rng_uniform(&rng, 0, 1);
    b.load_case->gravity_m_per_s2[2] = -9.81;
    find_load_case(&b);
    memcpy(below, b.work.position_m, sizeof below);
    b.load_case->gravity_m_per_s2[2] = 9.81;
    find_load_case(&b);
    double deepest = 0;
    for (int i = 0; i < N; i++) {
        ck_assert_double_eq_tol(b.work.position_m[i], below[i], 1e-10);
        ck_assert_double_eq_tol(b.work.position_m[N + i], below[N + i], 1e-10);
        ck_assert_double_eq_tol(b.work.position_m[2 * N + i], -below[2 * N + i], 1e-10);
        deepest = fmin(deepest, below[2 * N + i]);
    }
    ck_assert_double_lt(deepest, -0.01);
    close_built(&b);
}
END_TEST

Suite *suite_unit_built_load_case(void)
{
    Suite *suite = suite_create("unit/built_state");
    TCase *tcase = tcase_create("built_state");
    tcase_add_test(tcase, two_cables_in_line_under_temperature);
    tcase_add_test(tcase, a_node_hangs_by_its_weight);
    tcase_add_test(tcase, three_cables_hold_a_node);
    tcase_add_loop_test(tcase, uniform_heat_is_a_scaling, 0, 12);
    tcase_add_loop_test(tcase, gravity_upside_down_mirrors_a_flat_net, 0, 4);
    suite_add_tcase(suite, tcase);
    return suite;
}
