/* The net on an elastic truss: r = F f. Contents: attachments - the loop - laws of the coupled state - soft trusses -
 * designs. */
#include "flexible.h"
#include "laws.h"

#include "solve/certificate.h"
#include "solve/coupling.h"

#include <hifdm/evaluate.h>

#define TIGHT "form.residual_tolerance=1e-12", "form.length_tolerance=1e-12"

static void open_flexible(struct net *net, double scale_m_per_N)
{
    struct rng rng = {5}; /* a fixed seed, because the outcome depends on how soft the truss is */
    OPEN_CASE(net, SMALL_REFLECTOR, TIGHT);
    attach_all(net, &rng, scale_m_per_N);
}

/* ---- attachments ---- */

START_TEST(bad_attachments_are_refused)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    int node[MAX_ATTACHMENT], n = list_supports(&net, node), kept = node[1], inner = 0;
    struct rng rng = rng_start(1);
    double *f = random_flexibility(&rng, n, 1e-5), was = f[1];
    while (net.scene.role[inner] == HF_ROLE_SUPPORT)
        inner++;
    const struct {
        int node;
        double f01, f00;
        const char *message;
    } fault[] = {{inner, was, 1e-5, "attachment 1 of the truss belongs to node"},
                 {-1, was, 1e-5, "is not a support"},
                 {node[0], was, 1e-5, "attachments 0 and 1"},
                 {kept, NAN, 1e-5, "not finite"},
                 {kept, was + 1e-9, 1e-5, "not symmetric"},
                 {kept, was, -1e-5, "is negative"}};
    for (size_t i = 0; i < sizeof fault / sizeof *fault; i++) {
        hf_messages messages = {0};
        node[1] = fault[i].node;
        f[1] = fault[i].f01;
        f[0] = fault[i].f00;
        ck_assert_int_eq(hf_model_attach(&net.model, n, node, f, &messages), HF_BAD_CASE);
        ck_assert_msg(strstr(messages.text, fault[i].message) != NULL, "%s", messages.text);
        ck_assert_int_eq(net.model.n_attachment, 0);
        hf_messages_free(&messages);
    }
    free(f);
    close_net(&net);
}
END_TEST

/* Whichever allocation fails: told, and the model is as it was. */
START_TEST(attaching_without_memory)
{
    struct net net;
    struct rng rng = {1};
    OPEN_CASE(&net, SMALL_REFLECTOR);
    int node[MAX_ATTACHMENT], n = list_supports(&net, node);
    double *f = random_flexibility(&rng, n, 1e-5);
    for (long i = 1;; i++) {
        hf_messages messages = {0};
        hf_model model = net.model;
        fail_allocation_at(i);
        hf_status status = hf_model_attach(&model, n, node, f, &messages);
        int failed = end_allocation_failure();
        hf_messages_free(&messages);
        if (!failed) {
            ck_assert_int_eq(status, HF_OK);
            ck_assert_int_gt(i, 1);
            net.model = model;
            break;
        }
        ck_assert_int_eq(status, HF_NO_MEMORY);
        ck_assert_mem_eq(&model, &net.model, sizeof model);
    }
    free(f);
    close_net(&net);
}
END_TEST

/* Workspaces grow with attachments only. */
START_TEST(scenes_without_a_truss_carry_nothing)
{
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    size_t bare = hf_workspace_bytes(&net.model);
    ck_assert_int_eq(HF_COUPLING_ITEMS(&net.model), 0);
    ck_assert_ptr_null(net.model.flexibility_m_per_N);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_PLAIN, 1e-9), HF_OK);
    ck_assert_int_eq(net.result.coupling.stop_reason, HF_COUPLING_NONE);
    ck_assert_int_eq(net.result.coupling.iterations, 0);
    struct rng rng = rng_start(1);
    attach_all(&net, &rng, 1e-5);
    ck_assert_uint_gt(hf_workspace_bytes(&net.model), bare);
    close_net(&net);
}
END_TEST

/* ---- the loop ---- */

/* Two cables of 10 N in a row, one end on a spring that also carries 3 N: it gives way by 10 N times its flexibility
 * along the cable, and by 3 N times that across. */
START_TEST(one_spring_by_hand)
{
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{1, 0.5, 0}, HF_ROLE_INNER, {0}}, {{2, 1, 0}, HF_ROLE_SUPPORT, {0, 0, 3}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10},
                                              {{2, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10}};
    static const double flexibility[9] = {1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4};
    struct net net;
    hf_messages messages = {0};
    OPEN_HAND(&net, node, cable, HF_METHOD_HIFDM);
    ck_assert_int_eq(hf_model_attach(&net.model, 1, (int[]){2}, flexibility, &messages), HF_OK);
    hf_workspace_free(&net.work);
    ck_assert_int_eq(hf_workspace_create(&net.model, &net.work), HF_OK);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_PLAIN, 1e-12), HF_OK);
    ck_assert_double_eq_tol(found_m(&net, 2, 0), 2 - 1e-3 * 2 / sqrt(5), 1e-10);
    ck_assert_double_eq_tol(found_m(&net, 2, 1), 1 - 1e-3 * 1 / sqrt(5), 1e-10);
    ck_assert_double_eq_tol(found_m(&net, 2, 2), 3e-4, 1e-6); /* the cable turns a little towards the load */
    ck_assert_double_eq(found_m(&net, 0, 0), 0);              /* the other support stays */
    close_net(&net);
}
END_TEST

/* Run to 1e-12 m both ways, positions agree to 1e-9 m: what 1e-11 N out of balance leaves where the net is softest. */
START_TEST(accelerated_is_the_plain_loop)
{
    static const double scale[] = {1e-6, 1e-5, 1e-4};
    struct net net;
    int solves[2];
    open_flexible(&net, scale[_i]);
    double *shape[2];
    for (int scheme = 0; scheme < 2; scheme++) {
        ck_assert_int_eq(find_coupled(&net, scheme, 1e-12), HF_OK);
        ck_assert_int_eq(net.result.coupling.stop_reason, HF_COUPLING_CONVERGED);
        ck_assert_double_le(net.result.coupling.step_m, 1e-12);
        ck_assert_double_lt(net.result.position_error_m, 1e-9);
        solves[scheme] = net.result.coupling.iterations;
        shape[scheme] = copy_shape(&net);
    }
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        ck_assert_double_eq_tol(shape[0][k], shape[1][k], 1e-9);
    ck_assert_int_le(solves[HF_COUPLING_ACCELERATED], solves[HF_COUPLING_PLAIN]);
    if (_i == 2) ck_assert_int_le(3 * solves[0], 2 * solves[1]); /* observed 11, 21 */
    free(shape[0]);
    free(shape[1]);
    close_net(&net);
}
END_TEST

/* Every third cable elastic, at 10 N in the theoretical shape: their descent starts where the supports have gone. */
START_TEST(elastic_cables_on_a_truss)
{
    struct rng rng = rng_start(6);
    struct net net = {.form = tight_form(HF_METHOD_NEWTON)};
    random_tension_scene(&rng, &net.scene);
    double *EA_N = malloc((size_t)net.scene.n_cable * sizeof *EA_N);
    ck_assert_ptr_nonnull(EA_N);
    for (int e = 0; e < net.scene.n_cable; e++) {
        EA_N[e] = 1000;
        if (e % 3) continue;
        net.scene.law[e] = HF_LAW_ELASTIC;
        net.scene.target[e] = hf_scene_length_at_target(&net.scene, e) / 1.01;
    }
    net.scene.EA_N = EA_N;
    open_net(&net);
    attach_all(&net, &rng, 1e-4);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_PLAIN, 1e-12), HF_OK);
    double *plain = copy_shape(&net);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_ACCELERATED, 1e-12), HF_OK);
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        ck_assert_double_eq_tol(found_m(&net, k / 3, k % 3), plain[k], 1e-9);
    ck_assert_double_gt(net.result.coupling.deflection_max_m, 1e-4);
    free(plain);
    free(EA_N);
    close_net(&net);
}
END_TEST

START_TEST(a_rigid_truss_changes_no_bit)
{
    struct net alone, rigid;
    struct rng rng = rng_start(1);
    const char *const method = _i ? "form.method=hifdm" : "form.method=newton";
    OPEN_CASE(&alone, SMALL_REFLECTOR, method);
    OPEN_CASE(&rigid, SMALL_REFLECTOR, method);
    attach_all(&rigid, &rng, 0);
    ck_assert_int_eq(find_coupled(&alone, _i, 1e-9), HF_OK);
    ck_assert_int_eq(find_coupled(&rigid, _i, 1e-9), HF_OK);
    ck_assert_int_eq(rigid.result.coupling.iterations, 1);
    ck_assert_double_eq(rigid.result.coupling.deflection_max_m, 0);
    ck_assert_mem_eq(alone.work.position_m, rigid.work.position_m, 3 * sizeof(double) * (size_t)alone.model.n_node);
    ck_assert_mem_eq(alone.work.tension_N, rigid.work.tension_N, sizeof(double) * (size_t)alone.model.n_cable);
    ck_assert(alone.result.psi_m == rigid.result.psi_m && alone.result.residual_N == rigid.result.residual_N);
    close_net(&alone);
    close_net(&rigid);
}
END_TEST

/* The shape by the paper's rule depends on its start. Both schemes restart it each time, so they agree to tof_m. */
START_TEST(the_papers_rule_is_restarted)
{
    struct net net;
    struct rng rng = {9};
    double psi_m[2];
    OPEN_CASE(&net, "configs/straight-edges.yaml");
    attach_all(&net, &rng, 1e-5);
    for (int scheme = 0; scheme < 2; scheme++) {
        ck_assert_int_eq(find_coupled(&net, scheme, 1e-6), HF_OK);
        ck_assert_int_eq(net.result.stop_reason, HF_STOPPED_RMS_CHANGE);
        psi_m[scheme] = net.result.psi_m;
    }
    ck_assert_double_eq_tol(psi_m[0], psi_m[1], 1e-6);
    ck_assert_double_gt(fabs(psi_m[0] - 6.6027e-3), 1e-6); /* psi on fixed supports */
    close_net(&net);
}
END_TEST

START_TEST(history_tells_every_iteration)
{
    struct net net;
    enum { ROOM = 1000 };
    static double form[5][ROOM], step_m[ROOM], psi_m[ROOM], max_m[ROOM];
    hf_history history = {ROOM, 0, form[0], form[1], form[2], form[3], form[4], {ROOM, 0, step_m, psi_m, max_m}};
    open_flexible(&net, 1e-4);
    net.form.coupling = (hf_coupling_settings){1e-10, HF_COUPLING_PLAIN, 100};
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, &history, &net.result), HF_OK);
    int n = history.coupling.n;
    ck_assert_int_eq(n, net.result.coupling.iterations);
    ck_assert_int_gt(n, 3);
    ck_assert_double_eq(step_m[n - 1], net.result.coupling.step_m);
    ck_assert_double_eq(psi_m[n - 1], net.result.psi_m);
    ck_assert_double_eq(step_m[n - 1] / step_m[n - 2], net.result.coupling.ratio);
    ck_assert_double_eq(max_m[0], 0);
    ck_assert_double_eq_tol(max_m[1], step_m[0], 1e-15); /* before the first step no attachment has moved */
    close_net(&net);
}
END_TEST

/* ---- laws of the coupled state ---- */

/* t with F t = r: the reactions of the truss, by Gaussian elimination. */
static void reactions(const hf_model *m, const double *r, double *t)
{
    size_t n = 3 * (size_t)m->n_attachment;
    double *a = malloc(n * n * sizeof *a);
    ck_assert_ptr_nonnull(a);
    memcpy(a, m->flexibility_m_per_N, n * n * sizeof *a);
    memcpy(t, r, n * sizeof *t);
    for (size_t k = 0; k < n; k++) /* positive definite: no pivoting */
        for (size_t i = k + 1; i < n; i++) {
            double factor = a[i * n + k] / a[k * n + k];
            for (size_t j = k; j < n; j++)
                a[i * n + j] -= factor * a[k * n + j];
            t[i] -= factor * t[k];
        }
    for (size_t i = n; i-- > 0;) {
        for (size_t j = i + 1; j < n; j++)
            t[i] -= a[i * n + j] * t[j];
        t[i] /= a[i * n + i];
    }
    free(a);
}

/* The forces of the net and the reactions of the truss agree to 1e-9 of the sum of the forces. */
START_TEST(forces_balance)
{
    struct net net;
    double t[3 * MAX_ATTACHMENT], sum = 0;
    open_flexible(&net, 1e-5);
    ck_assert_int_eq(find_coupled(&net, _i, 1e-13), HF_OK);
    hf_coupling_forces(&net.model, &net.work);
    reactions(&net.model, net.work.displacement_m, t);
    for (int k = 0; k < 3 * net.model.n_attachment; k++)
        sum += fabs(net.work.attachment_force_N[k]);
    ck_assert_double_gt(sum, 100);
    for (int k = 0; k < 3 * net.model.n_attachment; k++)
        ck_assert_double_eq_tol(net.work.attachment_force_N[k], t[k], 1e-9 * sum);
    for (int i = 0; i < net.model.n_attachment; i++) /* and the net ends where the truss has moved to */
        for (int c = 0; c < 3; c++) {
            int at = c * net.model.n_node + net.model.attachment_row[i];
            ck_assert_double_eq(net.work.position_m[at], net.model.position_m[at] + net.work.displacement_m[3 * i + c]);
        }
    close_net(&net);
}
END_TEST

/* sum T* l - P x of the free nodes + r' F^-1 r / 2 */
static double energy_J(const struct net *net, const double *x, const double *r)
{
    const hf_model *m = &net->model;
    double sum = 0, t[3 * MAX_ATTACHMENT];
    for (int e = 0; e < m->n_cable; e++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            double d = x[c * m->n_node + m->end_row[2 * e]] - x[c * m->n_node + m->end_row[2 * e + 1]];
            square += d * d;
        }
        sum += m->target[e] * sqrt(square);
    }
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < m->n_free; i++)
            sum -= m->load_N[c * m->n_node + i] * x[c * m->n_node + i];
    reactions(m, r, t);
    for (int k = 0; k < 3 * m->n_attachment; k++)
        sum += r[k] * t[k] / 2;
    return sum;
}

/* Whatever moves, nodes and attachments by up to 1 mm, costs energy: some 1e-6 J, where the sum is known to 1e-12. */
START_TEST(energy_is_least)
{
    struct rng rng = rng_start((uint64_t)_i);
    struct net net = {.form = tight_form(HF_METHOD_NEWTON)};
    random_tension_scene(&rng, &net.scene);
    open_net(&net);
    attach_all(&net, &rng, 1e-4);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_ACCELERATED, 1e-11), HF_OK);
    const hf_model *m = &net.model;
    double x[3 * 64], r[3 * MAX_ATTACHMENT], least = energy_J(&net, net.work.position_m, net.work.displacement_m);
    for (int trial = 0; trial < 50; trial++) {
        for (int k = 0; k < 3 * m->n_node; k++)
            x[k] = net.work.position_m[k] + (k % m->n_node < m->n_free ? rng_uniform(&rng, -1e-3, 1e-3) : 0);
        for (int k = 0; k < 3 * m->n_attachment; k++) {
            double move = trial % 2 ? rng_uniform(&rng, -1e-3, 1e-3) : 0;
            r[k] = net.work.displacement_m[k] + move;
            x[k % 3 * m->n_node + m->attachment_row[k / 3]] += move;
        }
        ck_assert_double_gt(energy_J(&net, x, r), least);
    }
    close_net(&net);
}
END_TEST

/* ---- soft trusses ---- */

/* At 1e-3 m/N in all directions, and the modes in addition, the plain loop diverges and the accelerated one converges.
 * At 1e-2 m/N the supports would have to move by more than the width of the net. */
START_TEST(soft_trusses_are_named)
{
    struct net net;
    open_flexible(&net, 1e-3);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_PLAIN, 1e-9), HF_TRUSS_TOO_SOFT);
    ck_assert_int_eq(net.result.coupling.stop_reason, HF_COUPLING_DIVERGED);
    ck_assert(isnan(net.result.psi_m));
    ck_assert_double_gt(net.result.coupling.step_m, 1e-3);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_ACCELERATED, 1e-9), HF_OK);
    close_net(&net);
    open_flexible(&net, 1e-2);
    for (int scheme = 0; scheme < 2; scheme++) {
        ck_assert_int_eq(find_coupled(&net, scheme, 1e-9), HF_TRUSS_TOO_SOFT);
        ck_assert_int_eq(hf_status_exit_code(net.result.status), 4);
    }
    close_net(&net);
}
END_TEST

/* A net of constant tensions on springs so soft that the plain loop's steps grow: the reported ratio is at least 1. */
START_TEST(growing_steps_have_a_ratio)
{
    struct rng rng = {3};
    struct net net = {.form = tight_form(HF_METHOD_NEWTON)};
    random_tension_scene(&rng, &net.scene);
    open_net(&net);
    attach_all(&net, &rng, 4.5e-2);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_PLAIN, 1e-9), HF_TRUSS_TOO_SOFT);
    ck_assert_double_ge(net.result.coupling.ratio, 1);
    ck_assert_int_lt(net.result.coupling.iterations, 100);
    close_net(&net);
}
END_TEST

START_TEST(a_limit_is_a_limit)
{
    struct net net;
    open_flexible(&net, 1e-4);
    net.form.coupling = (hf_coupling_settings){1e-12, HF_COUPLING_PLAIN, 3};
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_NOT_CONVERGED);
    ck_assert_int_eq(net.result.coupling.stop_reason, HF_COUPLING_MAX_ITERATIONS);
    ck_assert_int_eq(net.result.coupling.iterations, 3);
    ck_assert(isfinite(net.result.psi_m));
    close_net(&net);
}
END_TEST

/* A net that has no shape even on fixed supports ends with the net's status, not as a truss that is too soft. */
START_TEST(ill_posed_nets_keep_their_name)
{
    struct net net;
    struct rng rng = rng_start(2);
    OPEN_CASE(&net, "configs/straight-edges.yaml", "form.stop=residual", "form.max_iterations=3000");
    attach_all(&net, &rng, 1e-5);
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_ACCELERATED, 1e-6), HF_STRAIGHT_CHAIN);
    ck_assert_int_eq(net.result.coupling.stop_reason, HF_COUPLING_NET);
    close_net(&net);
}
END_TEST

/* Solves the net, but the form-finding number `at` ends with `status` (in a shape, as hf_form_find leaves it). */
struct failing_solver {
    const struct net *net;
    int *calls;
    int at;
    hf_status status;
};

static hf_status solve_or_fail(const void *context, hf_workspace *w, hf_history *history, hf_form_result *r)
{
    const struct failing_solver *s = context;
    hf_form_find(&s->net->model, &s->net->form, HF_STOP_RESIDUAL, w, history, r);
    if (++*s->calls == s->at) r->status = s->status;
    return r->status;
}

static void find_until(struct net *net, int at, hf_status status)
{
    int calls = 0;
    const struct failing_solver solver = {net, &calls, at, status};
    open_flexible(net, 1e-4);
    net->form.coupling = (hf_coupling_settings){1e-9, HF_COUPLING_ACCELERATED, 100};
    hf_form_prepare(&net->model, &net->work);
    hf_coupling_find(&net->model, &net->form.coupling, solve_or_fail, &solver, 0, &net->work, NULL, &net->result);
    ck_assert_int_eq(calls, at); /* no form-finding follows the one that failed */
    ck_assert_int_eq(net->result.status, status);
    ck_assert_int_eq(net->result.coupling.stop_reason, HF_COUPLING_NET);
}

/* An interruption at any form-finding ends as interrupted and is not reported as a truss that is too soft. */
START_TEST(a_stop_is_a_stop)
{
    struct net net;
    find_until(&net, _i, HF_INTERRUPTED);
    close_net(&net);
}
END_TEST

/* A net that stops before it has converged has a shape. Forces and step must be those of this shape, not of the one
 * before, whose forces differ in the third digit. They are the same sums, so they agree to the bit. */
START_TEST(forces_of_a_net_that_did_not_converge_are_its_own)
{
    struct net net;
    double said[3 * MAX_ATTACHMENT];
    find_until(&net, _i, HF_NOT_CONVERGED);
    size_t bytes = 3 * (size_t)net.model.n_attachment * sizeof(double);
    memcpy(said, net.work.attachment_force_N, bytes);
    double step_m = net.result.coupling.step_m;
    hf_coupling_forces(&net.model, &net.work);
    ck_assert_mem_eq(said, net.work.attachment_force_N, bytes);
    ck_assert(isfinite(step_m) && step_m > 0);
    ck_assert(isnan(net.result.coupling.ratio) == (_i == 1)); /* the first step has none before it */
    ck_assert_double_eq(hf_coupling_measure(&net.model, &net.work, &net.result), step_m);
    close_net(&net);
}
END_TEST

/* Wanted lengths of cables at attachments change a little under a shape that was right: its position error is then how
 * far the new one is away, to second order. */
START_TEST(errors_of_length_at_attachments_are_position_errors)
{
    struct net net;
    int n_changed = 0;
    double moved_m = 0;
    open_flexible(&net, 1e-4);
    hf_model *m = &net.model;
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_ACCELERATED, 1e-12), HF_OK);
    double *before = copy_shape(&net);
    for (int k = 0; k < m->n_tie; k++) {
        int e = m->tie[k] / 2;
        if (m->law[e] != HF_LAW_LENGTH) continue;
        net.work.target[e] = m->target[e] *= 1 + 1e-6;
        n_changed++;
    }
    ck_assert_int_gt(n_changed, 0);
    hf_certify(m, &net.work, &net.result);
    double estimate_m = net.result.position_error_m;
    ck_assert_int_eq(find_coupled(&net, HF_COUPLING_ACCELERATED, 1e-12), HF_OK);
    double *after = copy_shape(&net);
    for (int i = 0; i < net.scene.n_node; i++) {
        const double *a = before + 3 * i, *b = after + 3 * i;
        moved_m = fmax(moved_m, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
    }
    ck_assert_double_eq_tol(estimate_m, moved_m, 1e-2 * moved_m);
    free(before);
    free(after);
    close_net(&net);
}
END_TEST

Suite *suite_unit_coupling(void)
{
    Suite *suite = suite_create("unit/coupling");
    TCase *tests = tcase_create("coupling");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, bad_attachments_are_refused);
    tcase_add_test(tests, attaching_without_memory);
    tcase_add_test(tests, scenes_without_a_truss_carry_nothing);
    tcase_add_test(tests, one_spring_by_hand);
    tcase_add_loop_test(tests, accelerated_is_the_plain_loop, 0, 3);
    tcase_add_test(tests, elastic_cables_on_a_truss);
    tcase_add_loop_test(tests, a_rigid_truss_changes_no_bit, 0, 2);
    tcase_add_test(tests, the_papers_rule_is_restarted);
    tcase_add_test(tests, history_tells_every_iteration);
    tcase_add_loop_test(tests, forces_balance, 0, 2);
    tcase_add_loop_test(tests, energy_is_least, 0, 4);
    tcase_add_test(tests, soft_trusses_are_named);
    tcase_add_test(tests, growing_steps_have_a_ratio);
    tcase_add_test(tests, a_limit_is_a_limit);
    tcase_add_test(tests, ill_posed_nets_keep_their_name);
    tcase_add_test(tests, errors_of_length_at_attachments_are_position_errors);
    tcase_add_loop_test(tests, a_stop_is_a_stop, 1, 4);
    tcase_add_loop_test(tests, forces_of_a_net_that_did_not_converge_are_its_own, 1, 4);
    return suite;
}
