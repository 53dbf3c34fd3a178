/* Proven bounds on nets whose answers are known, and the reasons for which there is none. Random nets are in
 * property/solve/bound. */
#include "flexible.h"

#include <hifdm/evaluate.h>

#include "solve/certificate.h"
#include "solve/flexibility.h"

/* The bounds of the shape in the workspace. */
static void prove(struct net *net)
{
    hf_form_measure(&net->model, &net->form, &net->work, &net->result);
    hf_certify(&net->model, &net->work, &net->result);
}

static void evaluate(struct net *net)
{
    hf_evaluate_form(&net->model, &net->form, &net->work, NULL, &net->result);
}

/* A node moved out of the answer by a known way is as far away as the bound says. */
START_TEST(a_known_move_is_the_bound)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    evaluate(&net);
    ck_assert_int_eq(net.result.bound_reason, HF_BOUND_CERTIFIED);
    double own_m = net.result.position_bound_m, move_m = pow(10, -1 - 2 * _i), psi_m = net.result.psi_m;
    ck_assert_double_le(own_m, 1e-12);
    net.work.position_m[net.model.n_node + 5] += 0.6 * move_m;
    net.work.position_m[2 * net.model.n_node + 5] -= 0.8 * move_m;
    prove(&net);
    if (_i > 0) { /* 0.1 m is too far for steps that are not damped */
        ck_assert_int_eq(net.result.bound_reason, HF_BOUND_CERTIFIED);
        ck_assert_double_ge(net.result.position_bound_m, move_m - own_m);
        ck_assert_double_le(net.result.position_bound_m, 1.000001 * move_m + 2 * own_m);
        double error_m = fabs(net.result.psi_m - psi_m);
        ck_assert_double_ge(net.result.psi_bound_m, error_m - own_m);
        ck_assert_double_le(net.result.psi_bound_m, error_m + 2 * own_m);
    }
    close_net(&net);
}
END_TEST

/* Two cables under law length hold a node in the plane y = 0; closed form: a triangle with sides 4, 2.5, 2.5. */
static const struct hand_node triangle[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{4, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{2, 0, -1.4}, HF_ROLE_INNER, {0, 0, -3}},
                                            {{2, 9, -1.5}, HF_ROLE_SUPPORT, {0}},
                                            {{2, -9, -1.5}, HF_ROLE_SUPPORT, {0}}};

START_TEST(lengths_are_met_exactly)
{
    static const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 2.5},
                                              {{2, 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 2.5},
                                              {{2, 3}, HF_GROUP_INNER, HF_LAW_TENSION, 7},
                                              {{4, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 7}};
    struct net net;
    OPEN_HAND(&net, triangle, cable, HF_METHOD_AUTO);
    evaluate(&net);
    ck_assert_int_eq(net.result.bound_reason, HF_BOUND_CERTIFIED);
    double off = hypot(hypot(found_m(&net, 2, 0) - 2, found_m(&net, 2, 1)), found_m(&net, 2, 2) + 1.5);
    ck_assert_double_ge(net.result.position_bound_m, off);
    ck_assert_double_le(net.result.position_bound_m, fmax(1.0001 * off, 1e-20));
    net.work.position_m[2 * net.model.n_node + net.model.row_of_node[2]] = -1.5 - 1e-4;
    prove(&net);
    ck_assert_double_eq_tol(net.result.position_bound_m, 1e-4, 1e-15);
    close_net(&net);
}
END_TEST

/* A third length between the same ends is met only by chance; a longer one is slack. */
START_TEST(dependent_lengths_are_not_proven)
{
    struct hand_cable cable[] = {{{0, 2}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 2.5},
                                 {{2, 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 2.5},
                                 {{2, 3}, HF_GROUP_INNER, HF_LAW_TENSION, 7},
                                 {{4, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 7},
                                 {{2, 0}, HF_GROUP_INNER, HF_LAW_LENGTH, _i ? 2.6 : 2.5}};
    struct net net;
    OPEN_HAND(&net, triangle, cable, HF_METHOD_AUTO);
    evaluate(&net);
    ck_assert_int_eq(net.result.bound_reason, _i ? HF_BOUND_CERTIFIED : HF_BOUND_DEPENDENT_LENGTHS);
    ck_assert(_i ? net.result.position_bound_m < 1e-15 : isnan(net.result.position_bound_m));
    close_net(&net);
}
END_TEST

/* An answer in which a cable of law length is straight without pulling: neither slack nor taut. */
START_TEST(a_cable_at_the_brink_is_not_proven)
{
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{4, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{2, 0, 0}, HF_ROLE_INNER, {0}}};
    const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 3},
                                       {{2, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 3},
                                       {{0, 2}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 2 + 0.125 * _i}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_AUTO);
    evaluate(&net);
    ck_assert_int_eq(net.result.bound_reason, _i ? HF_BOUND_CERTIFIED : HF_BOUND_SLACK_OR_TAUT);
    close_net(&net);
}
END_TEST

/* Force densities alone: no Newton matrix, and the bound from D. Then a strut. */
START_TEST(force_densities_are_proven_and_struts_are_not)
{
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{3, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 1, 0}, HF_ROLE_INNER, {0, 0, 1}}};
    const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 3},
                                       {{2, 1}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, _i ? -1 : 4}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_FDM);
    evaluate(&net);
    ck_assert_int_eq(net.result.bound_reason, _i ? HF_BOUND_STRUTS : HF_BOUND_CERTIFIED);
    if (!_i) {
        double off = hypot(found_m(&net, 2, 0) - 12.0 / 7, found_m(&net, 2, 2) - 1.0 / 7);
        ck_assert_double_ge(net.result.position_bound_m, off);
        ck_assert_double_le(net.result.position_bound_m, 1e-15);
        net.work.position_m[net.model.row_of_node[2]] += 1;
        prove(&net);
        ck_assert_double_eq_tol(net.result.position_bound_m, 1, 1e-14);
    }
    close_net(&net);
}
END_TEST

/* A node that all but hangs free: a stiffness of 1e-14 beside 1 is not told from rounding. */
START_TEST(what_drowns_in_rounding_is_not_proven)
{
    static const double q[] = {1e-2, 1e-8, 1e-14};
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{3, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1, 0, 0}, HF_ROLE_INNER, {0}},
                                            {{2, 0, 0}, HF_ROLE_INNER, {0}}};
    const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1},
                                       {{2, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1},
                                       {{0, 3}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, q[_i]},
                                       {{3, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, q[_i]}};
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_FDM);
    evaluate(&net);
    ck_assert_int_eq(net.result.bound_reason, _i < 2 ? HF_BOUND_CERTIFIED : HF_BOUND_NOT_DEFINITE);
    close_net(&net);
}
END_TEST

/* A net with law length, elastic, tension and force_density whose position error was once estimated as 3e-15 m where it
 * was 6e-4 m: a cable of law length pulls with 0.0044 N, and the paper's iteration let it go slack. */
START_TEST(bounds_hold_on_the_way_to_a_small_tension)
{
    struct net net, answer;
    OPEN_CASE(&answer, "tests/verify/data/mixed/case.yaml", "form.residual_tolerance=1e-12",
              "form.length_tolerance=1e-12");
    evaluate(&answer);
    ck_assert_int_eq(answer.result.bound_reason, HF_BOUND_CERTIFIED);
    OPEN_CASE(&net, "tests/verify/data/mixed/case.yaml", "form.method=hifdm", "form.residual_tolerance=1e-13");
    net.form.length_tolerance = 1e-13;
    int n_proven = 0;
    for (net.form.max_iterations = 1; net.form.max_iterations <= 4096; net.form.max_iterations *= 2) {
        evaluate(&net);
        if (net.result.bound_reason != HF_BOUND_CERTIFIED) continue;
        double far_m = 0;
        for (int i = 0; i < net.model.n_free; i++) {
            double square = 0;
            for (int c = 0; c < 3; c++)
                square += pow(net.work.position_m[c * net.model.n_node + i] -
                                  answer.work.position_m[c * net.model.n_node + i],
                              2);
            far_m = fmax(far_m, sqrt(square));
        }
        ck_assert_double_ge(net.result.position_bound_m, far_m - answer.result.position_bound_m);
        n_proven++;
    }
    ck_assert_int_ge(n_proven, 3);
    close_net(&net);
    close_net(&answer);
}
END_TEST

/* ---- on a truss ---- */

/* Attaches the first n_attachment nodes to this flexibility. */
static void attach(struct net *net, int n_attachment, const double *flexibility)
{
    static const int node[] = {0, 1, 2, 3, 4};
    hf_messages messages = {0};
    ck_assert_int_eq(hf_model_attach(&net->model, n_attachment, node, flexibility, &messages), HF_OK);
    hf_workspace_free(&net->work);
    ck_assert_int_eq(hf_workspace_create(&net->model, &net->work), HF_OK);
    poison_workspace(&net->model, &net->work);
    net->form.coupling = (hf_coupling_settings){1e-12, HF_COUPLING_AUTO, 500};
}

/* A diagonal flexibility [6][6] of two attachments. */
static void set_diagonal(double *flexibility, const double diagonal[6])
{
    memset(flexibility, 0, 36 * sizeof *flexibility);
    for (int i = 0; i < 6; i++)
        flexibility[7 * i] = diagonal[i];
}

static const struct hand_node two_supports[] = {
    {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{3, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 1, 0}, HF_ROLE_INNER, {1, -2, 3}}};

/* Closed form: for each coordinate the force density q and the flexibility f of an attachment are springs in series, of
 * stiffness q/(1 + q f). Also with attachments that are rigid in some directions, and with a coupling that stops long
 * before the truss has given what it will: the net alone is in balance there, and its own error is rounding. */
START_TEST(the_truss_counts_in_the_bound)
{
    static const double diagonal[][6] = {
        {1e-2, 2e-2, 5e-3, 1e-3, 3e-2, 1e-2}, {1e-2, 0, 5e-3, 0, 0, 1e-2}, {0}, {1e-7, 2e-7, 0, 0, 3e-7, 1e-7}};
    static const double q[] = {3, 4}, load[] = {1, -2, 3};
    const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, q[0]},
                                       {{2, 1}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, q[1]}};
    const double *f = diagonal[_i / 2];
    double flexibility[36], off = 0;
    struct net net;
    OPEN_HAND(&net, two_supports, cable, HF_METHOD_AUTO);
    set_diagonal(flexibility, f);
    attach(&net, 2, flexibility);
    if (_i % 2) net.form.coupling = (hf_coupling_settings){1, HF_COUPLING_PLAIN, 500};
    evaluate(&net);
    ck_assert_int_eq(net.result.status, HF_OK);
    ck_assert_int_eq(net.result.bound_reason, HF_BOUND_CERTIFIED);
    for (int i = 0; i < 3; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            double k[] = {q[0] / (1 + q[0] * f[c]), q[1] / (1 + q[1] * f[3 + c])}, end = c ? 0 : 3;
            double x = (k[1] * end + load[c]) / (k[0] + k[1]);
            double at[] = {f[c] * k[0] * x, end - f[3 + c] * k[1] * (end - x), x};
            square += pow(found_m(&net, i, c) - at[i], 2);
        }
        off = fmax(off, sqrt(square));
    }
    ck_assert_double_ge(net.result.position_bound_m, off - 1e-15);
    ck_assert_double_le(net.result.position_bound_m, 1.0001 * off + 1e-15);
    if (_i == 1) ck_assert_double_ge(off, 1e-5);
    if (_i % 2 == 0) ck_assert_double_le(net.result.position_bound_m, 1e-11);
    close_net(&net);
}
END_TEST

/* A matrix that no elastic structure has: its diagonal is not below zero, an eigenvalue is. */
START_TEST(a_truss_that_gives_energy_is_not_proven)
{
    const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 3},
                                       {{2, 1}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 4}};
    double flexibility[36];
    struct net net;
    OPEN_HAND(&net, two_supports, cable, HF_METHOD_AUTO);
    set_diagonal(flexibility, (double[]){1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3});
    flexibility[3] = flexibility[18] = _i ? 1.0001e-3 : 0.9999e-3;
    attach(&net, 2, flexibility);
    evaluate(&net);
    ck_assert_int_eq(net.result.status, HF_OK);
    ck_assert_int_eq(net.result.bound_reason, _i ? HF_BOUND_TRUSS : HF_BOUND_CERTIFIED);
    ck_assert(_i ? isnan(net.result.position_bound_m) : net.result.position_bound_m < 1e-10);
    close_net(&net);
}
END_TEST

/* Struts, dependent lengths, a cable at the brink and a loose node have no bound on a truss either. */
START_TEST(a_truss_proves_nothing_more)
{
    static const hf_bound_reason reason[] = {HF_BOUND_CERTIFIED, HF_BOUND_STRUTS, HF_BOUND_DEPENDENT_LENGTHS,
                                             HF_BOUND_SLACK_OR_TAUT, HF_BOUND_LOOSE};
    struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                               {{4, 0, 0}, HF_ROLE_SUPPORT, {0}},
                               {{2, 0, 0}, HF_ROLE_INNER, {0}},
                               {{2, 1, 0}, HF_ROLE_INNER, {0, _i == 4 ? 0 : 0.5, 0}}};
    struct hand_cable cable[] = {
        {{0, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 3}, {{2, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 3},
        {{0, 3}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 2.5},   {{3, 1}, HF_GROUP_BOUNDARY, HF_LAW_LENGTH, 2.5},
        {{0, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1}, {{0, 1}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 0.5}};
    if (_i == 1) cable[4].target = -1;
    if (_i == 2) cable[4] = (struct hand_cable){{3, 0}, HF_GROUP_INNER, HF_LAW_LENGTH, 2.5};
    if (_i == 3) cable[4] = (struct hand_cable){{0, 2}, HF_GROUP_INNER, HF_LAW_LENGTH, 2};
    double flexibility[36];
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_AUTO);
    set_diagonal(flexibility, (double[]){_i == 3 ? 0 : 1e-4, 1e-4, 1e-4, _i == 3 ? 0 : 1e-4, 1e-4, 1e-4});
    attach(&net, 2, flexibility);
    evaluate(&net);
    ck_assert_int_eq(net.result.status, HF_OK);
    ck_assert_msg(net.result.bound_reason == reason[_i], "%s", hf_bound_reason_word((int)net.result.bound_reason));
    ck_assert(_i ? isnan(net.result.position_bound_m) : net.result.position_bound_m < 1e-10);
    if (_i == 4) ck_assert_double_nan(net.result.position_error_m);
    close_net(&net);
}
END_TEST

/* A node that may be anywhere along a line is one of many answers on a truss, too. */
START_TEST(drift_on_a_truss_has_no_position_error)
{
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 0, -3}, HF_ROLE_SUPPORT, {0}}, {{0, 0, -1}, HF_ROLE_INNER, {0}}};
    static const struct hand_cable cable[] = {{{0, 2}, HF_GROUP_INNER, HF_LAW_TENSION, 3},
                                              {{2, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 3}};
    double flexibility[36];
    struct net net;
    OPEN_HAND(&net, node, cable, HF_METHOD_AUTO);
    set_diagonal(flexibility, (double[]){1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4});
    attach(&net, 2, flexibility);
    evaluate(&net);
    ck_assert_int_eq(net.result.status, HF_OK);
    ck_assert_int_eq(net.result.n_drifting, 1);
    ck_assert_double_nan(net.result.position_error_m);
    ck_assert_double_nan(net.result.position_bound_m);
    close_net(&net);
}
END_TEST

/* What rounding may do is counted once more, in another order: an inner product of t terms is wrong by (t + 2) u of the
 * diagonal entries, for each entry of a row. The bounds are above this count, by a tenth and what follows from it. */
START_TEST(rounding_counts_every_operation)
{
    static const struct {
        int has_newton, half_bandwidth, n_free, n;
    } of[] = {{0, 3, 40, 6}, {1, 3, 40, 6}, {1, 140, 3000, 60}, {0, 1, 2, 3}};
    const double u = 0x1p-53, stiffness = 5e4, n_cable = 6, trace = 3e-6;
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        hf_model model = {.n_free = of[i].n_free, .half_bandwidth = of[i].half_bandwidth};
        model.has_newton = of[i].has_newton;
        const hf_flexibility f = {.n = of[i].n, .trace = trace};
        hf_flexibility_rounding r = hf_flexibility_rounding_of(&model, &f, stiffness, n_cable);
        double n = of[i].n, band = of[i].has_newton ? 3 * (of[i].half_bandwidth + 1) - 1 : of[i].half_bandwidth;
        double free = (band + 3) * (band + 1 + n) * u, own = (n + 3) * (n + 1) * u;
        double between = (3.0 * of[i].n_free + n + 3) * (n + 1) * u + 2 * n * sqrt(n) * u;
        double blocks = (400 + 20 * n_cable) * u; /* of the entries themselves */
        ck_assert(r.free > free + blocks / 2 && r.free < 2 * (free + blocks));
        ck_assert(r.own > own && r.own < 2 * own);
        ck_assert_double_eq_tol(r.free_N_per_m / (2 * stiffness * r.free), 1, 1e-12);
        double own_1 = r.own_1 / (2 * stiffness * trace) - r.free;
        ck_assert(own_1 > between && own_1 < 4 * between);
    }
}
END_TEST

Suite *suite_unit_bound(void)
{
    Suite *suite = suite_create("unit/solve/bound");
    TCase *tests = tcase_create("bound");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, a_known_move_is_the_bound, 0, 5);
    tcase_add_test(tests, lengths_are_met_exactly);
    tcase_add_loop_test(tests, dependent_lengths_are_not_proven, 0, 2);
    tcase_add_loop_test(tests, a_cable_at_the_brink_is_not_proven, 0, 2);
    tcase_add_loop_test(tests, force_densities_are_proven_and_struts_are_not, 0, 2);
    tcase_add_loop_test(tests, what_drowns_in_rounding_is_not_proven, 0, 3);
    tcase_add_test(tests, bounds_hold_on_the_way_to_a_small_tension);
    tcase_add_loop_test(tests, the_truss_counts_in_the_bound, 0, 8);
    tcase_add_loop_test(tests, a_truss_that_gives_energy_is_not_proven, 0, 2);
    tcase_add_loop_test(tests, a_truss_proves_nothing_more, 0, 5);
    tcase_add_test(tests, drift_on_a_truss_has_no_position_error);
    tcase_add_test(tests, rounding_counts_every_operation);
    return suite;
}
