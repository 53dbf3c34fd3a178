/* Quadratic programmes: the conditions of Karush, Kuhn and Tucker on random ones, and answers by hand. */
#include "support.h"

#include "linalg/quadratic.h"

#include <math.h>
#include <string.h>

enum { MAX_N = 24, MAX_LIMIT = 80 };

struct programme {
    int n, n_limit;
    double hessian[MAX_N * MAX_N], gradient[MAX_N], normal[MAX_LIMIT][MAX_N], bound[MAX_LIMIT];
    double low[MAX_N], high[MAX_N];
    int n_broken; /* limits that were named */
};

static double product(int n, const double *a, const double *b)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

static bool worst_of(void *context, const double *x, hf_quadratic_limit *limit)
{
    struct programme *p = context;
    double worst = 1e-11, side = 0;
    limit->kind = -1;
    for (int i = 0; i < p->n; i++) {
        double sign = p->low[i] - x[i] > x[i] - p->high[i] ? 1 : -1, bound = sign > 0 ? p->low[i] : p->high[i];
        if (sign * (bound - x[i]) <= worst) continue;
        worst = sign * (bound - x[i]);
        side = sign;
        *limit = (hf_quadratic_limit){limit->normal, i, sign * bound, 0};
    }
    for (int k = 0; k < p->n_limit; k++) {
        double size = sqrt(product(p->n, p->normal[k], p->normal[k]));
        double beyond = (p->bound[k] - product(p->n, p->normal[k], x)) / size;
        if (beyond <= worst) continue;
        worst = beyond;
        limit->kind = k + 1;
    }
    if (limit->kind < 0) return false;
    p->n_broken++;
    if (limit->kind == 0) {
        limit->normal[limit->only] = side;
        return true;
    }
    limit->only = -1;
    memcpy(limit->normal, p->normal[limit->kind - 1], (size_t)p->n * sizeof(double));
    limit->bound = p->bound[limit->kind - 1];
    return true;
}

/* H = A A' + a little; limits that a random point obeys, so that there is an answer; some of them twice. */
static struct programme random_programme(uint64_t stream)
{
    struct rng rng = rng_start(stream);
    struct programme p = {.n = 1 + (int)rng_uniform(&rng, 0, MAX_N - 0.01)};
    double factor[MAX_N * MAX_N], inside[MAX_N];
    p.n_limit = (int)rng_uniform(&rng, 0, MAX_LIMIT);
    for (int i = 0; i < p.n * p.n; i++)
        factor[i] = rng_uniform(&rng, -1, 1);
    for (int i = 0; i < MAX_N; i++) {
        p.low[i] = i % 3 ? -0.5 : -INFINITY; /* a random point is inside */
        p.high[i] = i % 4 ? 0.5 : INFINITY;
    }
    for (int r = 0; r < p.n; r++) {
        for (int c = 0; c <= r; c++)
            p.hessian[r * p.n + c] = product(p.n, factor + r * p.n, factor + c * p.n) + (r == c ? 0.01 : 0);
        p.gradient[r] = rng_uniform(&rng, -3, 3);
        inside[r] = rng_uniform(&rng, -0.5, 0.5);
    }
    for (int k = 0; k < p.n_limit; k++) {
        bool is_copy = k > 0 && rng_uniform(&rng, 0, 1) < 0.2, is_bound = rng_uniform(&rng, 0, 1) < 0.5;
        for (int i = 0; i < p.n; i++)
            p.normal[k][i] = is_copy ? p.normal[k - 1][i] : is_bound ? 0 : rng_uniform(&rng, -1, 1);
        if (!is_copy && is_bound) p.normal[k][(int)rng_uniform(&rng, 0, p.n - 0.01)] = k % 2 ? 1 : -1;
        p.bound[k] = product(p.n, p.normal[k], inside) - (k % 5 ? rng_uniform(&rng, 0, 0.3) : 0);
    }
    return p;
}

static double hessian_row(const struct programme *p, int r, const double *x)
{
    double sum = 0;
    for (int c = 0; c < p->n; c++)
        sum += (c <= r ? p->hessian[r * p->n + c] : p->hessian[c * p->n + r]) * x[c];
    return sum;
}

static hf_status solve(hf_quadratic *q, struct programme *p)
{
    p->n_broken = 0;
    return hf_quadratic_solve(q, p->hessian, p->gradient, p->low, p->high, worst_of, p);
}

/* The gradient at x is the sum of the active normals with multipliers >= 0, and no limit is broken: for a strictly
 * convex programme only the answer does that. */
static void check_answer(const struct programme *p, const hf_quadratic *q)
{
    double left[MAX_N], scale = 1;
    for (int k = 0; k < p->n_limit; k++)
        ck_assert_double_ge(product(p->n, p->normal[k], q->x), p->bound[k] - 1e-9);
    for (int r = 0; r < p->n; r++) {
        ck_assert_double_ge(q->x[r], p->low[r] - 1e-9);
        ck_assert_double_le(q->x[r], p->high[r] + 1e-9);
        left[r] = hessian_row(p, r, q->x) + p->gradient[r];
        scale = fmax(scale, fabs(left[r]));
    }
    ck_assert_int_le(q->n_active, p->n);
    for (int a = 0; a < q->n_active; a++) {
        const hf_quadratic_active *of = &q->active[a];
        double normal[MAX_N] = {0};
        if (of->kind > 0) memcpy(normal, p->normal[of->kind - 1], sizeof normal);
        if (of->kind == 0) normal[of->only] = of->sign;
        ck_assert_double_ge(of->multiplier, 0);
        ck_assert_double_eq_tol(product(p->n, normal, q->x), of->bound, 1e-9);
        for (int r = 0; r < p->n; r++)
            left[r] -= of->multiplier * normal[r];
        scale = fmax(scale, of->multiplier);
    }
    for (int r = 0; r < p->n; r++)
        ck_assert_msg(fabs(left[r]) < 1e-8 * scale, "row %d: %g of %g left", r, left[r], scale);
}

START_TEST(answers_obey_karush_kuhn_tucker)
{
    struct programme p = random_programme((uint64_t)_i);
    hf_quadratic q;
    ck_assert_int_eq(hf_quadratic_create(p.n, &q), HF_OK);
    ck_assert_int_eq(solve(&q, &p), HF_OK);
    check_answer(&p, &q);
    hf_arena_free_block(q.block);
}
END_TEST

/* The same programme again names no bound of a variable that held it; one whose gradient turns, and whose bounds move,
 * begins from bounds that hold it no longer. */
START_TEST(bounds_that_held_the_last_answer_are_where_the_next_begins)
{
    struct programme p = random_programme((uint64_t)_i);
    hf_quadratic q;
    if (_i % 2) p.n_limit = 0;
    ck_assert_int_eq(hf_quadratic_create(p.n, &q), HF_OK);
    ck_assert_int_eq(solve(&q, &p), HF_OK);
    ck_assert_int_ge(p.n_broken, q.n_active);
    ck_assert_int_eq(solve(&q, &p), HF_OK);
    check_answer(&p, &q);
    if (p.n_limit == 0) ck_assert_int_eq(p.n_broken, 0);
    for (int i = 0; i < p.n; i++) {
        p.gradient[i] *= i % 3 - 0.5;
        if (i % 5 == 0) p.low[i] = -INFINITY;
        if (i % 7 == 0) p.high[i] = 0.6;
    }
    ck_assert_int_eq(solve(&q, &p), HF_OK);
    check_answer(&p, &q);
    hf_arena_free_block(q.block);
}
END_TEST

static void open_bounds(struct programme *p)
{
    for (int i = 0; i < MAX_N; i++) {
        p->low[i] = -INFINITY;
        p->high[i] = INFINITY;
    }
}

/* The least of (x - 3)^2 + (y - 2)^2 with x + y <= 3, x <= 1.5, and then y <= 1 on top. */
START_TEST(answers_by_hand)
{
    struct programme p = {.n = 2, .hessian = {2, 0, 0, 2}, .gradient = {-6, -4}};
    open_bounds(&p);
    static const double normal[3][2] = {{-1, -1}, {-1, 0}, {0, -1}}, bound[3] = {-3, -1.5, -1};
    static const double answer[4][2] = {{3, 2}, {2, 1}, {1.5, 1.5}, {1.5, 1}};
    hf_quadratic q;
    ck_assert_int_eq(hf_quadratic_create(2, &q), HF_OK);
    for (p.n_limit = 0; p.n_limit < 4; p.n_limit++) {
        if (p.n_limit > 0) {
            memcpy(p.normal[p.n_limit - 1], normal[p.n_limit - 1], sizeof normal[0]);
            p.bound[p.n_limit - 1] = bound[p.n_limit - 1];
        }
        ck_assert_int_eq(solve(&q, &p), HF_OK);
        ck_assert_double_eq_tol(q.x[0], answer[p.n_limit][0], 1e-14);
        ck_assert_double_eq_tol(q.x[1], answer[p.n_limit][1], 1e-14);
    }
    hf_arena_free_block(q.block);
}
END_TEST

START_TEST(what_has_no_answer_is_told)
{
    struct programme p = {.n = 1, .n_limit = 2, .hessian = {1}, .gradient = {0}, .bound = {1, 0}};
    open_bounds(&p);
    p.normal[0][0] = 1;  /* x >= 1 */
    p.normal[1][0] = -1; /* x <= 0 */
    hf_quadratic q;
    ck_assert_int_eq(hf_quadratic_create(1, &q), HF_OK);
    ck_assert_int_eq(solve(&q, &p), HF_DIFFERENT);
    p.hessian[0] = -1;
    ck_assert_int_eq(solve(&q, &p), HF_SINGULAR);
    hf_arena_free_block(q.block);
}
END_TEST

Suite *suite_unit_quadratic(void)
{
    Suite *suite = suite_create("unit/quadratic");
    TCase *tests = tcase_create("quadratic");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, answers_obey_karush_kuhn_tucker, 0, 200);
    tcase_add_loop_test(tests, bounds_that_held_the_last_answer_are_where_the_next_begins, 0, 200);
    tcase_add_test(tests, answers_by_hand);
    tcase_add_test(tests, what_has_no_answer_is_told);
    return suite;
}
