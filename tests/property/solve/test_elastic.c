/* Nets as built: a reflector's net of elastic cables, from soft to nearly rigid, each cut a little too long or too
 * short. A shape that is found must be in equilibrium under the tensions that follow from its lengths; the test
 * measures this itself. Nodes whose cables are all slack are loose: they are counted, and are as near to their
 * theoretical places as their cables allow. */
#include "laws.h"

#include <hifdm/evaluate.h>

/* Largest force out of balance when every cable pulls with EA max(l/l0 - 1, 0), in long double. *rounding: the largest
 * force, N, that rounding of the coordinates causes in a cable. */
static double imbalance_N(const struct net *net, double *rounding)
{
    const hf_model *m = &net->model;
    long double *force = calloc(3 * (size_t)m->n_node, sizeof *force), largest = 0;
    ck_assert_ptr_nonnull(force);
    *rounding = 0;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        long double d[3], square = 0, l0 = m->target[e];
        for (int c = 0; c < 3; c++) {
            d[c] = (long double)net->work.position_m[c * m->n_node + b] - net->work.position_m[c * m->n_node + a];
            square += d[c] * d[c];
        }
        long double length = sqrtl(square), T = length > l0 ? m->EA_N[e] * (length / l0 - 1) : 0;
        *rounding = fmax(*rounding, m->EA_N[e] * 5 * 2.3e-16 / m->target[e]); /* coordinates of 5 m */
        for (int c = 0; c < 3; c++) {
            force[c * m->n_node + a] += T * d[c] / length;
            force[c * m->n_node + b] -= T * d[c] / length;
        }
    }
    for (int i = 0; i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            largest = fmaxl(largest, fabsl(force[c * m->n_node + i]));
    free(force);
    return (double)largest;
}

static int is_loose(const struct net *net, int row)
{
    const hf_model *m = &net->model;
    for (int e = 0; e < m->n_cable; e++)
        if ((m->end_row[2 * e] == row || m->end_row[2 * e + 1] == row) && net->work.q_N_per_m[e] > 1e-12)
            return 0; /* 1e-12 N/m is nothing beside tensions of 10 N */
    return 1;
}

/* Distance of a row to its theoretical place after `part` of the way there, or INFINITY if a cable gets too long. */
static double distance_after(const struct net *net, int row, double part)
{
    const hf_model *m = &net->model;
    double x[3], square = 0;
    for (int c = 0; c < 3; c++) {
        double at = net->work.position_m[c * m->n_node + row], there = m->position_m[c * m->n_node + row];
        x[c] = at + part * (there - at);
        square += (x[c] - there) * (x[c] - there);
    }
    for (int k = 0; k < 2 * m->n_cable; k++) {
        double length = 0;
        if (m->end_row[k] != row) continue;
        for (int c = 0; c < 3; c++)
            length += pow(x[c] - net->work.position_m[c * m->n_node + m->end_row[k ^ 1]], 2);
        if (sqrt(length) > m->target[k / 2] * (1 + 2e-10)) return INFINITY;
    }
    return sqrt(square);
}

/* The loose nodes of a result are those without a taut cable, and none of them could be nearer to its theoretical
 * place; psi is that of the others. */
static void check_loose_nodes(const struct net *net)
{
    const hf_model *m = &net->model;
    int n_loose = 0, n = 0;
    double sum = 0;
    for (int i = 0; i < m->n_free; i++) {
        if (!is_loose(net, i)) continue;
        n_loose++;
        ck_assert_double_le(distance_after(net, i, 0), 10);
        if (distance_after(net, i, 0) > 1e-6) ck_assert_double_eq(distance_after(net, i, 0.2), INFINITY);
    }
    ck_assert_int_eq(net->result.n_loose, n_loose);
    for (int k = 0; k < m->n_inner_node; k++) {
        if (is_loose(net, m->inner_row[k])) continue;
        n++;
        for (int c = 0; c < 3; c++)
            sum += pow(
                found_m(net, m->node_of_row[m->inner_row[k]], c) - m->position_m[c * m->n_node + m->inner_row[k]], 2);
    }
    if (n > 0) ck_assert_double_eq_tol(net->result.psi_m, sqrt(sum / n), 1e-12);
    if (n == 0) ck_assert_double_nan(net->result.psi_m);
}

/* Cuts cables for the found shape with relative errors of up to `off`; the search starts from the theoretical shape. */
static hf_status build_from_cuts(struct net *net, struct rng *rng, double EA_N, double off)
{
    struct net built = {.form = net->form};
    built.scene = net->scene;
    double *EA = malloc((size_t)net->scene.n_cable * sizeof *EA);
    double *target = malloc((size_t)net->scene.n_cable * sizeof *target);
    unsigned char *law = malloc((size_t)net->scene.n_cable);
    ck_assert(EA && target && law);
    for (int e = 0; e < net->scene.n_cable; e++) {
        EA[e] = EA_N;
        law[e] = HF_LAW_ELASTIC;
        target[e] = net->work.length_m[e] / (1 + net->work.tension_N[e] / EA_N) * (1 + rng_uniform(rng, -off, off));
    }
    built.scene.EA_N = EA;
    built.scene.target = target;
    built.scene.law = law;
    built.form.method = HF_METHOD_AUTO;
    built.form.residual_tolerance = built.form.length_tolerance = 1e-10;
    open_net(&built);
    hf_status status = hf_evaluate_form(&built.model, &built.form, &built.work, NULL, &built.result);
    if (status == HF_OK) {
        double rounding, out_N = imbalance_N(&built, &rounding);
        /* ten cables at most meet at a node; a length is right to 1e-10 */
        double allowed_N = 1e-10 * 10 * 10 + 10 * EA_N * 1e-10 + 10 * rounding;
        ck_assert_msg(out_N <= allowed_N, "EA %g off %g: %g N, not %g", EA_N, off, out_N, allowed_N);
        check_loose_nodes(&built);
        if (off == 0) /* exact cuts give back the shape that they were made for */
            for (int k = 0; k < 3 * built.model.n_node; k++)
                ck_assert_double_eq_tol(built.work.position_m[k], net->work.position_m[k], 1e-8);
    } else { /* rounding: the path ends before it is clear which cables are slack */
        ck_assert_msg(status == HF_NOT_CONVERGED && EA_N >= 1e6, "EA %g off %g: %s", EA_N, off, hf_status_word(status));
    }
    ck_assert_int_le(built.result.iterations, 1000);
    hf_workspace_free(&built.work);
    hf_model_free(&built.model);
    free(EA);
    free(target);
    free(law);
    return status;
}

START_TEST(nets_built_from_inexact_cuts)
{
    static const double off[] = {0, 1e-6, 1e-5, 1e-4, 1e-3};
    struct rng rng = rng_start(900 + (uint64_t)_i);
    struct net net;
    int n_found = 0;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    net.form = tight_form(HF_METHOD_NEWTON);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    for (double EA_N = 1e2; EA_N < 2e9; EA_N *= 10)
        for (int k = 0; k < 5; k++)
            n_found += build_from_cuts(&net, &rng, EA_N, off[k]) == HF_OK;
    ck_assert_int_ge(n_found, 38); /* of 40 */
    close_net(&net);
}
END_TEST

/* The boundary is rigid, the rest elastic and cut for the found shape: that shape comes back. */
START_TEST(elastic_cables_beside_the_other_laws)
{
    static const double EA_N[] = {1e3, 47e3, 1e7};
    struct net net;
    OPEN_CASE(&net, SMALL_REFLECTOR);
    net.form = tight_form(HF_METHOD_NEWTON);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    double *found = malloc(3 * (size_t)net.model.n_node * sizeof *found);
    double *EA = malloc((size_t)net.scene.n_cable * sizeof *EA);
    ck_assert(found && EA);
    memcpy(found, net.work.position_m, 3 * (size_t)net.model.n_node * sizeof *found);
    for (int e = 0; e < net.scene.n_cable; e++) {
        EA[e] = EA_N[_i];
        if (net.scene.law[e] != HF_LAW_TENSION || e % 3 == 0) continue;
        net.scene.law[e] = HF_LAW_ELASTIC;
        net.scene.target[e] = net.work.length_m[e] / (1 + net.work.tension_N[e] / EA[e]);
    }
    hf_workspace_free(&net.work);
    hf_model_free(&net.model);
    net.scene.EA_N = EA;
    net.form.residual_tolerance = net.form.length_tolerance = 1e-10;
    open_net(&net);
    ck_assert_int_eq(hf_evaluate_form(&net.model, &net.form, &net.work, NULL, &net.result), HF_OK);
    ck_assert_int_lt(net.result.iterations, 300);
    for (int k = 0; k < 3 * net.model.n_node; k++)
        ck_assert_double_eq_tol(net.work.position_m[k], found[k], 1e-8);
    free(found);
    free(EA);
    close_net(&net);
}
END_TEST

Suite *suite_property_elastic(void)
{
    Suite *suite = suite_create("property/elastic");
    TCase *tests = tcase_create("elastic");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, nets_built_from_inexact_cuts, 0, 8);
    tcase_add_loop_test(tests, elastic_cables_beside_the_other_laws, 0, 3);
    return suite;
}
