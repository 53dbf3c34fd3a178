/* The Newton matrix compared with finite differences of the forces, its condition number with that from the inverse. */
#include "laws.h"

#include "linalg/band.h"
#include "solve/newton_matrix.h"
#include <hifdm/evaluate.h>

/* L L' of the factor in newton_band, dense. */
static void multiply_factor(const hf_model *m, const hf_workspace *w, double *dense)
{
    int n = 3 * m->n_free, ld = 3 * m->half_bandwidth + 3;
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double sum = 0;
            for (int k = i - ld + 1 > 0 ? i - ld + 1 : 0; k <= j; k++)
                sum += w->newton_band[i - k + k * ld] * w->newton_band[j - k + k * ld];
            dense[i * n + j] = dense[j * n + i] = sum;
        }
}

/* Nodal forces at the workspace's positions by the laws tension and force_density, [3 row + c]. */
static void forces(const hf_model *m, const hf_workspace *w, double *force)
{
    memset(force, 0, 3 * (size_t)m->n_node * sizeof *force);
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        double d[3], square = 0;
        for (int c = 0; c < 3; c++) {
            d[c] = w->position_m[c * m->n_node + b] - w->position_m[c * m->n_node + a];
            square += d[c] * d[c];
        }
        double q = w->law[e] == HF_LAW_TENSION ? w->target[e] / sqrt(square) : w->target[e];
        for (int c = 0; c < 3; c++) {
            force[3 * a + c] += q * d[c];
            force[3 * b + c] -= q * d[c];
        }
    }
}

/* A tension net with every third cable at a given force density, found. */
static void open_smooth(struct net *net, int trial)
{
    struct rng rng = rng_start(100 + (uint64_t)trial);
    *net = (struct net){.form = tight_form(HF_METHOD_NEWTON)};
    random_tension_scene(&rng, &net->scene);
    for (int e = 0; e < net->scene.n_cable; e += 3) {
        net->scene.law[e] = HF_LAW_FORCE_DENSITY;
        net->scene.target[e] /= hf_scene_length_at_target(&net->scene, e);
    }
    open_net(net);
    ck_assert_int_eq(hf_evaluate_form(&net->model, &net->form, &net->work, NULL, &net->result), HF_OK);
}

/* Central differences with 1e-5 m at some 10 N/m: truncation (1e-5)^2 of third derivatives, 10 N/m^3, is 1e-9 N/m;
 * rounding 1e-15 * 10 N / 1e-5 m is the same. */
START_TEST(matrix_is_the_derivative_of_the_forces)
{
    struct net net;
    open_smooth(&net, _i);
    const hf_model *m = &net.model;
    int n = 3 * m->n_free;
    double *dense = malloc((size_t)n * (size_t)n * sizeof *dense), *up = malloc(3 * (size_t)m->n_node * sizeof *up);
    double *down = malloc(3 * (size_t)m->n_node * sizeof *down), step = 1e-5;
    ck_assert(dense && up && down);
    ck_assert_int_eq(hf_newton_matrix_factor(m, &net.work, NULL), HF_OK);
    multiply_factor(m, &net.work, dense);
    for (int j = 0; j < n; j++) {
        double *x = net.work.position_m + j % 3 * m->n_node + j / 3, kept = *x;
        *x = kept + step;
        forces(m, &net.work, up);
        *x = kept - step;
        forces(m, &net.work, down);
        *x = kept;
        for (int i = 0; i < n; i++) /* the forces are minus the gradient */
            ck_assert_double_eq_tol(dense[i * n + j], (down[i] - up[i]) / (2 * step), 1e-7);
    }
    free(dense);
    free(up);
    free(down);
    close_net(&net);
}
END_TEST

/* LAPACK's estimate is a lower bound of the 1-norm condition number, rarely off by more than 3; the guard on the
 * diagonal and rounding change it in the 13th digit. */
START_TEST(condition_is_that_of_the_matrix)
{
    struct net net;
    open_smooth(&net, _i);
    const hf_model *m = &net.model;
    int n = 3 * m->n_free;
    double *dense = malloc((size_t)n * (size_t)n * sizeof *dense), *column = malloc((size_t)n * sizeof *column);
    double estimate, norm = 0, inverse_norm = 0;
    ck_assert(dense && column);
    ck_assert_int_eq(hf_newton_matrix_factor(m, &net.work, &estimate), HF_OK);
    ck_assert_double_eq_tol(estimate, net.result.condition, 1e-4 * estimate); /* of a matrix for the bound, see below */
    multiply_factor(m, &net.work, dense);
    for (int j = 0; j < n; j++) {
        double sum = 0, inverse_sum = 0;
        memset(column, 0, (size_t)n * sizeof *column);
        column[j] = 1;
        hf_band_back_solve(n, 3 * m->half_bandwidth + 2, 1, net.work.newton_band, column, n);
        for (int i = 0; i < n; i++) {
            sum += fabs(dense[i * n + j]);
            inverse_sum += fabs(column[i]);
        }
        norm = fmax(norm, sum);
        inverse_norm = fmax(inverse_norm, inverse_sum);
    }
    ck_assert_double_le(estimate, norm * inverse_norm * (1 + 1e-9));
    ck_assert_double_ge(estimate, norm * inverse_norm / 3);
    free(dense);
    free(column);
    close_net(&net);
}
END_TEST

/* What is taken off the diagonal is more than the bound that it proves, and too little to be seen in the condition.
 * Where a node hangs on next to nothing, the least eigenvalue is not clearly above it. */
START_TEST(a_factor_from_below_proves_a_bound)
{
    struct net net;
    open_smooth(&net, _i);
    const hf_model *m = &net.model;
    int n = 3 * m->n_free;
    double *whole = malloc((size_t)n * (size_t)n * sizeof *whole), *less = malloc((size_t)n * (size_t)n * sizeof *less);
    double condition, other;
    ck_assert(whole && less);
    ck_assert_int_eq(hf_newton_matrix_factor(m, &net.work, &condition), HF_OK);
    multiply_factor(m, &net.work, whole);
    double least = hf_newton_matrix_factor_below(m, &net.work, &other);
    ck_assert_double_gt(least, 0);
    ck_assert_double_eq_tol(other, condition, 1e-4 * condition);
    multiply_factor(m, &net.work, less);
    for (int i = 0; i < n * n; i++) {
        bool is_diagonal = i % (n + 1) == 0;
        double size = whole[i / n * n + i / n] + whole[i % n * n + i % n], taken = whole[i] - less[i];
        ck_assert_double_le(fabs(taken), is_diagonal ? 1e-6 * size : 1e-13 * size);
        if (is_diagonal) ck_assert_double_ge(taken, 0.999999 * least);
    }
    for (int k = 0; k < 2 * m->n_cable; k++)
        if (m->end_row[k] == 0) net.work.target[k / 2] *= 1e-9;
    ck_assert_double_eq(hf_newton_matrix_factor_below(m, &net.work, &other), 0);
    free(whole);
    free(less);
    close_net(&net);
}
END_TEST

/* A cable that pushes with twice its tension makes the matrix indefinite, and a large shift definite again. Cables that
 * all push leave no positive entry on the diagonal, which no shift helps. */
START_TEST(an_indefinite_matrix_is_shifted)
{
    struct net net;
    open_smooth(&net, _i);
    const hf_model *m = &net.model;
    double condition = 0;
    int pushing = 0; /* a cable under law force_density between two free nodes */
    while (m->end_row[2 * pushing] >= m->n_free || m->end_row[2 * pushing + 1] >= m->n_free)
        pushing += 3;
    ck_assert_int_lt(pushing, m->n_cable);
    net.work.target[pushing] *= -2;
    ck_assert_int_eq(hf_newton_matrix_factor(m, &net.work, &condition), HF_OK);
    ck_assert(isinf(condition));
    for (int e = 0; e < m->n_cable; e++)
        net.work.target[e] = -fabs(net.work.target[e]);
    ck_assert_int_eq(hf_newton_matrix_factor(m, &net.work, &condition), HF_SINGULAR);
    close_net(&net);
}
END_TEST

Suite *suite_unit_newton_matrix(void)
{
    Suite *suite = suite_create("unit/newton_matrix");
    TCase *tests = tcase_create("newton_matrix");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, matrix_is_the_derivative_of_the_forces, 0, 5);
    tcase_add_loop_test(tests, condition_is_that_of_the_matrix, 0, 5);
    tcase_add_loop_test(tests, a_factor_from_below_proves_a_bound, 0, 5);
    tcase_add_loop_test(tests, an_indefinite_matrix_is_shifted, 0, 5);
    return suite;
}
