/* What limits a step: rates by differences of shapes, and half-spaces whose edge is where the linear model says. */
#include "nets.h"

#include "search/refine_problem.h"
#include <hifdm/problem.h>

enum { MAX_VARIABLE = 200, MAX_COLUMN = MAX_VARIABLE + 1 };

static const struct {
    const char *file, *key, *objective; /* what stands under optimize beside it */
    double most[HF_FRONT_OBJECTIVES_MAX];
} kind[] = {
    {"configs/chen2022.yaml",
     "optimize.limits=[{figure: tension, set: boundary, bounds: [35, 60]}]",
     "optimize.objective=[{figure: psi}]",
     {0}},
    {"configs/chen2022-truss.yaml",
     "optimize.limits=[{figure: tension, set: boundary, bounds: [1, 45]}, {figure: deflection, bounds: [0, 1e-3]}]",
     "optimize.objective=[{figure: psi}]",
     {0}},
    {"configs/chen2022.yaml", "optimize.boundary_ratio_cap=1.05", "optimize.objective=[{figure: psi}]", {0}},
    {"configs/chen2022.yaml",
     "optimize.method=lm",
     "optimize.front=[{figure: ratio, set: boundary}, {figure: psi}]",
     {INFINITY, 1}},
    {"configs/chen2022.yaml", "optimize.method=lm", "optimize.front=[{figure: pull}, {figure: psi}]", {INFINITY, 1}},
    {"configs/chen2022.yaml",
     "optimize.method=lm",
     "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}, {figure: pull}]",
     {INFINITY, 1.1, 20}},
};
enum { N_KIND = sizeof kind / sizeof *kind };

struct watched {
    hf_problem problem;
    double lower[MAX_VARIABLE], upper[MAX_VARIABLE];
    hf_watch_front front;
    hf_refine_problem refine;
};

/* At the shape of the form-finding. */
static void open_watched(struct watched *t, int i)
{
    const char *const set[] = {kind[i].key, kind[i].objective, "optimize.method=lm", "surface.focal_length_m=15.95"};
    hf_messages messages = {0};
    *t = (struct watched){.front = {0, kind[i].most}};
    ck_assert_msg(hf_problem_open(source_path(kind[i].file), set, 4, 1, &t->problem, &messages) == HF_OK, "%s",
                  messages.text);
    hf_problem *p = &t->problem;
    ck_assert_int_le(p->model.n_variable, MAX_VARIABLE);
    for (int k = 0; k < p->model.n_variable; k++) {
        t->lower[k] = p->initial[k] - 0.5;
        t->upper[k] = p->initial[k] + 0.5;
    }
    hf_refine_problem *q = &t->refine;
    *q = (hf_refine_problem){.v = p->evaluator,
                             .caller = &p->evaluator,
                             .lower = t->lower,
                             .upper = t->upper,
                             .w = &p->workspace,
                             .front = kind[i].most[0] > 0 ? &t->front : NULL};
    q->v.by_density = true;
    q->v.boundary_ratio_cap = INFINITY;
    q->v.limits = NULL;
    ck_assert_int_eq(hf_refine_create(q), HF_OK);
    hf_refine_begin(q, p->initial);
    ck_assert_int_eq(hf_refine_evaluate(q, q->at), HF_OK);
    ck_assert_int_eq(hf_refine_linearise(q), HF_OK);
}

static void close_watched(struct watched *t)
{
    hf_refine_destroy(&t->refine);
    hf_problem_free(&t->problem);
}

/* A step of about this size, relative to the values of the variables. */
static void draw_step(const hf_refine_problem *p, struct rng *rng, double size, double x[MAX_COLUMN])
{
    for (int j = 0; j < p->n; j++)
        x[j] = rng_uniform(rng, -size, size) * p->unit[j];
    x[p->n] = 0;
}

static bool worst_of(hf_refine_problem *p, const double *x, double worst, double normal[MAX_COLUMN],
                     hf_quadratic_limit *limit)
{
    memset(normal, 0, MAX_COLUMN * sizeof *normal);
    *limit = (hf_quadratic_limit){.normal = normal, .only = -1};
    return hf_watch_worst(&p->watch, x, worst, limit);
}

/* What is predicted and what a shape has differ by the square of the step. */
START_TEST(predictions_are_of_first_order)
{
    static struct watched t;
    double x[MAX_COLUMN], off[2], unused[MAX_COLUMN];
    hf_quadratic_limit limit;
    open_watched(&t, _i);
    hf_refine_problem *p = &t.refine;
    ck_assert_int_gt(p->watch.n, 0);
    for (int trial = 0; trial < 3; trial++) {
        for (int half = 0; half < 2; half++) {
            struct rng rng = rng_start(7100 + (uint64_t)trial);
            draw_step(p, &rng, half ? 1e-4 : 2e-4, x);
            for (int j = 0; j < p->n; j++)
                p->trial[j] = p->at[j] + x[j];
            ck_assert_int_eq(hf_refine_evaluate(p, p->trial), HF_OK);
            hf_watch_keeps(&p->watch, p->w);
            worst_of(p, x, INFINITY, unused, &limit);
            off[half] = 0;
            for (int i = 0; i < p->watch.n; i++) {
                const hf_watched *item = &p->watch.item[i];
                double scale = fabs(item->value) + 1e-6 * item->unit;
                off[half] = fmax(off[half], fabs(item->now - item->predicted) / scale);
            }
        }
        ck_assert_msg(off[1] < 0.3 * off[0] + 1e-9, "trial %d: %g, with half the step %g", trial, off[0], off[1]);
        ck_assert_double_lt(off[0], 1e-4);
    }
    close_watched(&t);
}
END_TEST

/* The edge of the half-space of a violated limit is where the limit holds with equality, along its normal: there the
 * same limit is not violated any more, and a little before it still is. */
START_TEST(the_edge_of_a_limit_is_where_it_holds)
{
    static struct watched t;
    double x[MAX_COLUMN], y[MAX_COLUMN], normal[MAX_COLUMN], other[MAX_COLUMN];
    hf_quadratic_limit limit, again;
    int n_violated = 0;
    open_watched(&t, _i);
    hf_refine_problem *p = &t.refine;
    int n = p->n + p->has_corners;
    for (int trial = 0; trial < 40; trial++) {
        struct rng rng = rng_start(7200 + (uint64_t)trial);
        draw_step(p, &rng, 0.05, x);
        if (p->has_corners) x[p->n] = rng_uniform(&rng, -0.02, 0.02) * p->watch.level;
        if (!worst_of(p, x, 1e-9, normal, &limit)) continue;
        n_violated++;
        double along = 0, square = 0;
        for (int j = 0; j < n; j++) {
            along += normal[j] * x[j];
            square += normal[j] * normal[j];
        }
        ck_assert_double_gt(square, 0);
        ck_assert_double_lt(along, limit.bound);
        for (int before = 0; before < 2; before++) {
            double part = before ? 0.99 : 1;
            for (int j = 0; j < n; j++)
                y[j] = x[j] + part * (limit.bound - along) / square * normal[j];
            bool is_same = worst_of(p, y, 1e-8, other, &again) && again.kind == limit.kind &&
                           again.bound == limit.bound && !memcmp(other, normal, sizeof normal);
            if (before)
                ck_assert_msg(worst_of(p, y, 0, other, &again), "trial %d: the edge is too far away", trial);
            else
                ck_assert_msg(!is_same, "trial %d: the limit is violated at its edge", trial);
        }
    }
    ck_assert_int_gt(n_violated, 10);
    close_watched(&t);
}
END_TEST

Suite *suite_unit_watch(void)
{
    Suite *suite = suite_create("unit/watch");
    TCase *tests = tcase_create("watch");
    tcase_add_loop_test(tests, predictions_are_of_first_order, 0, N_KIND);
    tcase_add_loop_test(tests, the_edge_of_a_limit_is_where_it_holds, 0, N_KIND);
    suite_add_tcase(suite, tests);
    return suite;
}
