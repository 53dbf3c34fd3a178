/* The first-order answer to errors: against differences of nets that are solved, on rigid ground and on a truss; its
 * transpose; by hand. */
#include "flexible.h"
#include "laws.h"

#include "built/linear.h"

enum { MAX_CABLE = 400 };

typedef struct {
    struct net net;
    double EA[MAX_CABLE];
    hf_built built;
    hf_workspace work;
    hf_built_linear linear;
} bench;

/* A random saddle of 10 N and EA of 1e3 to 1e4 N; every second one on a truss that gives way. */
static void open_bench(bench *b, int trial)
{
    struct rng rng = rng_start(1700 + (uint64_t)trial);
    hf_messages messages = {0};
    b->net = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
    b->net.form.residual_tolerance = 1e-12;
    random_tension_scene(&rng, &b->net.scene);
    for (int e = 0; e < b->net.scene.n_cable; e++)
        b->EA[e] = rng_uniform(&rng, 1e3, 1e4);
    b->net.scene.EA_N = b->EA;
    open_net(&b->net);
    b->net.form.coupling = (hf_coupling_settings){1e-14, HF_COUPLING_AUTO, 500};
    if (trial % 2) attach_all(&b->net, &rng, 1e-3);
    ck_assert_int_eq(hf_evaluate_form(&b->net.model, &b->net.form, &b->net.work, NULL, &b->net.result), HF_OK);
    ck_assert_msg(hf_built_make("x.yaml", &b->net.scene, &b->net.model, &b->net.form, &b->net.work, &b->built,
                                &messages) == HF_OK,
                  "%s", messages.text);
    ck_assert_int_eq(hf_workspace_create(&b->built.model, &b->work), HF_OK);
    ck_assert_int_eq(hf_built_linear_make(&b->built, &b->linear), HF_OK);
}

static void close_bench(bench *b)
{
    hf_built_linear_free(&b->linear);
    hf_workspace_free(&b->work);
    hf_built_free(&b->built);
    b->net.scene.EA_N = NULL;
    close_net(&b->net);
}

/* Errors of all kinds, times `scale`: place [n_dof] and tension [n_cable] of the net that is solved. */
static void solve_with(bench *b, double scale, const double *cut, const double *EA, const double *move, double *place,
                       double *tension)
{
    const hf_model *m = &b->built.model;
    double cut_m[MAX_CABLE], EA_N[MAX_CABLE], *off = calloc(3 * (size_t)m->n_node, sizeof *off);
    hf_form_result r;
    for (int e = 0; e < m->n_cable; e++) {
        cut_m[e] = b->built.scene.target[e] + scale * cut[e];
        EA_N[e] = b->EA[e] * (1 + scale * EA[e]);
    }
    for (int i = 0; i < 3 * m->n_node; i++)
        off[i % 3 * m->n_node + i / 3] = scale * move[i];
    hf_built_net net = {.cut_m = cut_m, .EA_N = EA_N, .support_displacement_m = off};
    ck_assert_int_eq(hf_built_solve(&b->built, &net, &b->work, &r), HF_OK);
    for (int i = 0; i < 3 * m->n_node; i++)
        place[i] = b->work.position_m[i % 3 * m->n_node + i / 3];
    memcpy(tension, b->work.tension_N, (size_t)m->n_cable * sizeof *tension);
    free(off);
}

/* Central differences of fourth order with steps of 1e-4 of errors of 1e-2: the remainder is 1e-12 or so, the residual
 * of 1e-12 of 10 N over the step gives about 1e-8. */
START_TEST(moves_and_tensions_are_derivatives)
{
    static bench b;
    open_bench(&b, _i);
    const hf_model *m = &b.built.model;
    size_t n_dof = b.linear.n_dof, n = (size_t)m->n_cable;
    static const double at[4] = {-2, -1, 1, 2}, weight[4] = {1. / 12, -2. / 3, 2. / 3, -1. / 12};
    struct rng rng = rng_start(40 + (uint64_t)_i);
    double cut[MAX_CABLE], EA[MAX_CABLE], strain[MAX_CABLE], change[MAX_CABLE], tension[MAX_CABLE], h = 2e-2;
    double *buffer = calloc(4 * n_dof + n + b.linear.n_scratch, sizeof *buffer), *off = buffer, *move = off + n_dof,
           *place = move + n_dof, *slope = place + n_dof, *rate = slope + n_dof, *scratch = rate + n;
    for (size_t e = 0; e < n; e++) {
        cut[e] = rng_uniform(&rng, -1e-3, 1e-3);
        EA[e] = rng_uniform(&rng, -1e-1, 1e-1);
        strain[e] = b.linear.cut_N_per_m[e] * cut[e] + b.built.tension_N[e] * EA[e];
    }
    for (size_t i = 0; i < n_dof; i++)
        off[i] = i < 3 * (size_t)m->n_free ? 0 : rng_uniform(&rng, -1e-3, 1e-3);
    for (int k = 0; k < 4; k++) {
        solve_with(&b, at[k] * h, cut, EA, off, place, tension);
        for (size_t i = 0; i < n_dof; i++)
            slope[i] += weight[k] / h * place[i];
        for (size_t e = 0; e < n; e++)
            rate[e] += weight[k] / h * tension[e];
    }
    memcpy(move, off, n_dof * sizeof *move);
    hf_built_linear_apply(&b.linear, NULL, 1, strain, NULL, move, scratch);
    hf_built_linear_tension(&b.linear, strain, move, change);
    double largest_m = largest(move, (int)n_dof), largest_N = largest(change, (int)n);
    for (size_t i = 0; i < n_dof; i++)
        ck_assert_double_eq_tol(move[i], slope[i], 1e-7 * largest_m);
    for (size_t e = 0; e < n; e++)
        ck_assert_double_eq_tol(change[e], rate[e], 1e-7 * largest_N);
    free(buffer);
    close_bench(&b);
}
END_TEST

/* Two cables in line whose node has come loose, and two that are taut: there is an answer, the loose node stays where
 * it is, and the taut one moves with its support by the part that its cables share. */
START_TEST(a_loose_node_stays_where_it_is)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0, 0}, HF_ROLE_INNER, {0}},
                                            {{2, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 1, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 1, 0}, HF_ROLE_INNER, {0}},   {{2, 1, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{1, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{3, 4}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{4, 5}, HF_GROUP_INNER, HF_LAW_TENSION, 10}};
    static bench b;
    hf_form_result r;
    double cut_m[4], move[18] = {0};
    for (int e = 0; e < 4; e++)
        b.EA[e] = 2000;
    OPEN_HAND(&b.net, node, cable, HF_METHOD_NEWTON);
    b.net.scene.EA_N = b.EA;
    ck_assert_int_eq(hf_evaluate_form(&b.net.model, &b.net.form, &b.net.work, NULL, &b.net.result), HF_OK);
    hf_messages messages = {0};
    ck_assert_int_eq(hf_built_make("x.yaml", &b.net.scene, &b.net.model, &b.net.form, &b.net.work, &b.built, &messages),
                     HF_OK);
    ck_assert_int_eq(hf_workspace_create(&b.built.model, &b.work), HF_OK);
    ck_assert_int_eq(hf_built_linear_make(&b.built, &b.linear), HF_OK);
    for (int e = 0; e < 4; e++)
        cut_m[e] = b.built.scene.target[e] + (e < 2 ? 0.1 : 0);
    ck_assert_int_eq(hf_built_solve(&b.built, &(hf_built_net){.cut_m = cut_m}, &b.work, &r), HF_OK);
    ck_assert_int_eq(r.n_loose, 1);
    ck_assert_int_eq(hf_built_linear_take(&b.linear, &b.work), HF_OK);
    const int *row = b.built.model.row_of_node;
    double *scratch = calloc(b.linear.n_scratch, sizeof *scratch);
    move[3 * row[2]] = move[3 * row[5]] = 0.01;
    hf_built_linear_apply(&b.linear, NULL, 1, NULL, NULL, move, scratch);
    ck_assert_double_eq(move[3 * row[1]], 0);
    ck_assert_double_eq_tol(move[3 * row[4]], 0.005, 1e-12);
    int n_factor = b.linear.n_factor;
    ck_assert_int_eq(hf_built_linear_take(&b.linear, &b.work), HF_OK);
    ck_assert_int_eq(b.linear.n_factor, n_factor); /* it is the same shape */
    free(scratch);
    close_bench(&b);
}
END_TEST

/* g'(S e) = (S'g)'e, several right-hand sides at a time. */
START_TEST(the_transpose_is_one)
{
    enum { N = 4 };
    static bench b;
    open_bench(&b, _i);
    size_t n_dof = b.linear.n_dof, n = (size_t)b.built.model.n_cable, n_free = 3 * (size_t)b.built.model.n_free;
    struct rng rng = rng_start(60 + (uint64_t)_i);
    double *buffer = calloc(N * (3 * n_dof + 2 * n + b.linear.n_scratch), sizeof *buffer), *off = buffer,
           *move = off + N * n_dof, *slope = move + N * n_dof, *strain = slope + N * n_dof, *rate = strain + N * n,
           *scratch = rate + N * n, left[N] = {0}, right[N] = {0}, size = 0;
    for (size_t i = 0; i < N * n; i++)
        strain[i] = rng_uniform(&rng, -1, 1);
    for (size_t i = 0; i < N * n_dof; i++) {
        move[i] = off[i] = rng_uniform(&rng, -1e-2, 1e-2);
        slope[i] = rng_uniform(&rng, -1, 1);
    }
    hf_built_linear_apply(&b.linear, NULL, N, strain, NULL, move, scratch);
    for (size_t i = 0; i < N * n_dof; i++)
        left[i / n_dof] += slope[i] * move[i];
    hf_built_linear_transpose(&b.linear, N, slope, rate, scratch);
    for (size_t i = 0; i < N * n; i++) {
        right[i / n] += rate[i] * strain[i];
        size += fabs(rate[i]);
    }
    for (size_t i = 0; i < N * n_dof; i++)
        if (i % n_dof >= n_free) right[i / n_dof] += slope[i] * off[i];
    for (int k = 0; k < N; k++)
        ck_assert_double_eq_tol(left[k], right[k], 1e-10 * (size + 1));
    free(buffer);
    close_bench(&b);
}
END_TEST

Suite *suite_unit_linear(void)
{
    Suite *suite = suite_create("unit/linear");
    TCase *tcase = tcase_create("linear");
    tcase_add_loop_test(tcase, moves_and_tensions_are_derivatives, 0, 6);
    tcase_add_loop_test(tcase, the_transpose_is_one, 0, 6);
    tcase_add_test(tcase, a_loose_node_stays_where_it_is);
    suite_add_tcase(suite, tcase);
    return suite;
}
