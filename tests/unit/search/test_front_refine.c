/* Fronts by Levenberg-Marquardt: of two objectives two in closed form, with their slopes, of three one; a reflector's,
 * whose points are even, none better than another, and the same on any number of threads. */
#include "nets.h"

#include "net/variables.h"
#include "search/refine.h"
#include "search/front_refine.h"
#include <hifdm/problem.h>

enum { MAX_CABLE = 8, MAX_VARIABLE = 4, MAX_VARIABLE_OF_CASE = 200 };
static int failed_end;

struct traded {
    struct net net;
    hf_objectives objectives;
    hf_objectives_point point;
    hf_evaluator evaluator;
    double start_q[MAX_CABLE], base[MAX_VARIABLE], lower[MAX_VARIABLE], upper[MAX_VARIABLE];
    hf_front front;
};

/* The same search again. */
static hf_front_refine trade_of(const struct traded *t, int n_point)
{
    return (hf_front_refine){.evaluator = &t->evaluator,
                             .lower = t->lower,
                             .upper = t->upper,
                             .n_point = n_point,
                             .max_iterations = 200,
                             .n_thread = 1,
                             .n_start = 1,
                             .start = t->base};
}

/* Follow the front of the objectives; the cables of a set vary their force densities between these bounds. */
static void follow(struct traded *t, int n_objective, const hf_objective_settings *objective, const char *set,
                   double lower, double upper, int n_point)
{
    hf_messages messages = {0};
    hf_optimize_settings s = {.n_front = n_objective, .n_variable_row = 1};
    for (int k = 0; k < n_objective; k++)
        s.front[k] = objective[k];
    hf_workspace *w = &t->net.work;
    hf_model *m = &t->net.model;
    s.variable_row[0] = (hf_variable_settings){
        .vary = HF_VARY_FORCE_DENSITY, .range = NAN, .range_ratio = NAN, .lower = lower, .upper = upper};
    snprintf(s.variable_row[0].set, sizeof s.variable_row[0].set, "%s", set);
    t->net.form.residual_tolerance = t->net.form.length_tolerance = 1e-13;
    ck_assert_int_eq(hf_variables_apply(&t->net.scene, &s, NULL, m, &messages), HF_OK);
    hf_model_want_newton(m);
    hf_workspace_free(w);
    ck_assert_int_eq(hf_workspace_create(m, w), HF_OK);
    ck_assert_msg(hf_objectives_create(&t->net.scene, m, &s, NULL, NULL, NULL, &t->objectives, &messages) == HF_OK,
                  "%s", messages.text);
    ck_assert_int_eq(find_shape(&t->net), HF_OK);
    memcpy(t->start_q, w->q_N_per_m, (size_t)m->n_cable * sizeof(double));
    hf_variables_read(m, w->q_N_per_m, w->tension_N, w->length_m, t->base);
    for (int k = 0; k < m->n_variable; k++) {
        t->lower[k] = lower;
        t->upper[k] = upper;
    }
    t->evaluator = (hf_evaluator){.model = m,
                                  .form = &t->net.form,
                                  .start_q_N_per_m = t->start_q,
                                  .solver = HF_SOLVER_NEWTON,
                                  .boundary_ratio_cap = INFINITY,
                                  .objectives = &t->objectives};
    const hf_front_refine trade = trade_of(t, n_point);
    ck_assert(hf_front_refine_applies(&t->evaluator));
    ck_assert_int_eq(hf_front_refine_find(&trade, &t->front, &failed_end), HF_OK);
}

static void close_traded(struct traded *t)
{
    hf_front_free(&t->front);
    hf_objectives_point_free(&t->point);
    hf_objectives_free(&t->objectives);
    close_net(&t->net);
}

static hf_objective_settings objective(hf_figure_kind kind, const char *set, double target)
{
    hf_objective_settings s = {.figure = kind, .target = target, .mass_kg_per_m = NAN};
    snprintf(s.set, sizeof s.set, "%s", set);
    return s;
}

static void assert_relative(double is, double wanted, double tolerance)
{
    ck_assert_msg(fabs(is - wanted) <= tolerance * fabs(wanted), "%.17g, not %.17g", is, wanted);
}

/* A node between two supports at -1 and 1 m, which wants to be at 0.5 m. */
static const struct hand_node on_line[] = {
    {{-1, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0.5, 0, 0}, HF_ROLE_INNER, {0}}, {{1, 0, 0}, HF_ROLE_SUPPORT, {0}}};
static const struct hand_cable along_line[] = {{{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 10},
                                               {{1, 2}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 12}};

/* A node on the line between two supports at -1 and 1 m is at x = (q1 - q0)/(q0 + q1) and wants to be at 0.5 m, where
 * its cables are 1.5 and 0.5 m long and want to be 0.8 m. So psi = 0.5 - x, and the length objective is
 * L = sqrt(((1 + x - 0.8)^2 + (1 - x - 0.8)^2)/2) = sqrt(0.04 + x^2). The front is 0 <= x <= 0.5:
 * psi = 0.5 - sqrt(L^2 - 0.04), and -d psi/dL = L/sqrt(L^2 - 0.04) = L/(0.5 - psi). */
START_TEST(a_node_on_a_line_has_a_front_in_closed_form)
{
    struct traded t = {0};
    hf_objective_settings wanted[2] = {objective(HF_FIGURE_PSI, "", NAN), objective(HF_FIGURE_LENGTH, "", 0.8)};
    bool is_turned = _i % 2; /* the order of the objectives says which one is least under limits on the other */
    OPEN_HAND(&t.net, on_line, along_line, HF_METHOD_FDM);
    const hf_objective_settings turned[2] = {wanted[is_turned], wanted[!is_turned]};
    follow(&t, 2, turned, "boundary", 1, 100, 11);
    ck_assert_int_eq(t.front.n_point, 11);
    ck_assert_int_eq(t.front.minimised, 0);
    for (int i = 0; i < 11; i++) {
        const hf_front_point *p = &t.front.point[i];
        double psi_m = p->objective[is_turned], length_m = p->objective[!is_turned], slope = length_m / (0.5 - psi_m);
        bool is_end = i == 0 || i == 10;
        ck_assert_int_eq(p->status, HF_OK);
        ck_assert_int_eq(p->mark, HF_FRONT_ON);
        ck_assert_double_eq_tol(psi_m, 0.5 - sqrt(fmax(0, length_m * length_m - 0.04)), is_end ? 1e-6 : 1e-8 * psi_m);
        if (!is_end) assert_relative(p->multiplier[1], is_turned ? 1 / slope : slope, 1e-8);
    }
    const hf_front_point *end = t.front.point; /* the least of objective 0 comes first */
    ck_assert_double_eq_tol(end[is_turned ? 10 : 0].objective[is_turned], 0, 1e-12);
    assert_relative(end[is_turned ? 0 : 10].objective[!is_turned], 0.2, 1e-8);
    ck_assert_double_eq(end[0].multiplier[1], 0); /* where the first is least alone, the other holds nothing */
    close_traded(&t);
}
END_TEST

/* The same node, whose cables want to be 1.5 and 0.5 m long where it wants to be: there both objectives are nothing. */
START_TEST(objectives_that_agree_are_one_design)
{
    struct traded t = {0};
    hf_front_table table;
    const hf_objective_settings wanted[2] = {objective(HF_FIGURE_PSI, "", NAN), objective(HF_FIGURE_LENGTH, "", NAN)};
    OPEN_HAND(&t.net, on_line, along_line, HF_METHOD_FDM);
    follow(&t, 2, wanted, "boundary", 1, 100, 11);
    ck_assert_int_eq(t.front.n_point, 1);
    for (int k = 0; k < 2; k++) {
        ck_assert_double_lt(t.front.point[0].objective[k], 1e-9);
        ck_assert(isnan(t.front.point[0].multiplier[k]));
    }
    assert_relative(t.front.design[1] / t.front.design[0], 3, 1e-8); /* q0 1.5 = q1 0.5 */
    hf_front_tabulate(&t.front, &table);
    ck_assert(hf_front_agrees(&table));
    table.n_failed = 1; /* a point that was not found may be another one */
    ck_assert(!hf_front_agrees(&table));
    table.n_failed = 0;
    table.n_on = 2;
    ck_assert(!hf_front_agrees(&table));
    close_traded(&t);
}
END_TEST

/* A node between supports at -1 and 1 m along x, whose cables vary up to Q = 40 N/m, and two at -1 and 1 m along y,
 * with 5 N/m each: it stays on y = 0, and T0 = T1 - 2 x 5 x. So the ratio of T1 = q1 (1 - x) to T0 is least with
 * q1 = Q: 1/r = 1 - 10 x/(Q (1 - x)). The node wants to be at 0.4 m: with u = (1 - 1/r) Q the front is
 * psi = 0.4 - u/(10 + u) and -d psi/dr = 10 Q/(r (10 + u))^2, from r = 1 to 1/(1 - 4/(0.6 Q)). A bound and a corner
 * hold all of it. */
START_TEST(a_ratio_has_a_front_in_closed_form)
{
    static const struct hand_node node[] = {{{-1, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{0.4, 0, 0}, HF_ROLE_INNER, {0}},
                                            {{1, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{0.4, -1, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{0.4, 1, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 20},
                                              {{1, 2}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 25},
                                              {{1, 3}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 5},
                                              {{1, 4}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 5}};
    struct traded t = {0};
    const hf_objective_settings wanted[2] = {objective(HF_FIGURE_RATIO, "boundary", NAN),
                                             objective(HF_FIGURE_PSI, "", NAN)};
    struct hand_node placed[5];
    memcpy(placed, node, sizeof node);
    placed[3].position_m[0] = placed[4].position_m[0] = 0; /* the cables along y pull the node to x = 0 */
    OPEN_HAND(&t.net, placed, cable, HF_METHOD_FDM);
    follow(&t, 2, wanted, "boundary", 1, 40, 9);
    ck_assert_int_eq(t.front.n_point, 9);
    ck_assert_int_eq(t.front.minimised, 1); /* psi is smooth */
    for (int i = 0; i < 9; i++) {
        const hf_front_point *p = &t.front.point[i];
        double r = p->objective[0], u = 40 * (1 - 1 / r), psi_m = 0.4 - u / (10 + u);
        ck_assert_int_eq(p->mark, HF_FRONT_ON);
        ck_assert_double_eq_tol(p->objective[1], psi_m, i == 8 ? 1e-8 : 1e-8 * psi_m);
        if (i > 0 && i < 8) assert_relative(p->multiplier[0], 400 / (r * r * (10 + u) * (10 + u)), 1e-8);
        ck_assert(isnan(p->multiplier[1]));
    }
    assert_relative(t.front.point[0].objective[0], 1, 1e-8);
    assert_relative(t.front.point[8].objective[0], 1 / (1 - 4 / (0.6 * 40)), 1e-5);
    close_traded(&t);
}
END_TEST

/* ---- three objectives ---- */

/* A node between supports at (-1, 0) and (1, 0), pulled along y by 10 N: it is at x = (q1 - q0)/Q, y = 10/Q with
 * Q = q0 + q1. It wants to be at (0, 1), and its two cables want to be 0.2 m long, which bounds forbid. With u the unit
 * vectors away from these three places, the front is where u_psi + a u_0 + b u_1 = 0 with a, b >= 0, which are the
 * slopes: the triangle of the three places. */
#define SHORT 0.2
#define MOST_Q 40
static void open_triangle(struct traded *t, int n_point)
{
    static const struct hand_node node[] = {
        {{-1, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0, 1, 0}, HF_ROLE_INNER, {0, 10, 0}}, {{1, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 6},
                                              {{1, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 7}};
    const hf_objective_settings wanted[3] = {objective(HF_FIGURE_PSI, "", NAN),
                                             objective(HF_FIGURE_LENGTH, "boundary", SHORT),
                                             objective(HF_FIGURE_LENGTH, "inner", SHORT)};
    OPEN_HAND(&t->net, node, cable, HF_METHOD_FDM);
    follow(t, 3, wanted, "all", 0.1, MOST_Q, n_point);
}

/* The slopes at (x, y). */
static void triangle_slopes(double x, double y, double slope[2])
{
    double r = hypot(x, y - 1), l = hypot(x + 1, y), m = hypot(x - 1, y);
    double u[2] = {-x / r, -(y - 1) / r}, a[2] = {(x + 1) / l, y / l}, b[2] = {(x - 1) / m, y / m};
    double area = a[0] * b[1] - a[1] * b[0];
    slope[0] = (u[0] * b[1] - u[1] * b[0]) / area;
    slope[1] = (a[0] * u[1] - a[1] * u[0]) / area;
}

START_TEST(a_node_in_a_plane_has_a_front_of_three_in_closed_form)
{
    struct traded t = {0};
    enum { N = 50 };
    int n_inside = 0;
    open_triangle(&t, N);
    ck_assert_int_eq(t.front.n_objective, 3);
    ck_assert_int_eq(t.front.minimised, 0);
    ck_assert_int_ge(t.front.n_point, N - 1);
    ck_assert_int_le(t.front.n_point, N);
    for (int i = 0; i < t.front.n_point; i++) {
        const hf_front_point *p = &t.front.point[i];
        const double *q = t.front.design + 2 * i;
        double x = (q[1] - q[0]) / (q[0] + q[1]), y = 10 / (q[0] + q[1]), slope[2];
        ck_assert_int_eq(p->status, HF_OK);
        ck_assert_int_eq(p->mark, HF_FRONT_ON);
        assert_relative(p->objective[0] + 1, hypot(x, y - 1) + 1, 1e-12);
        assert_relative(p->objective[1] + 1, hypot(x + 1, y) - SHORT + 1, 1e-12);
        assert_relative(p->objective[2] + 1, hypot(x - 1, y) - SHORT + 1, 1e-12);
        if (!(p->multiplier[1] > 0 && p->multiplier[2] > 0) || fmax(q[0], q[1]) > 0.999 * MOST_Q) continue;
        n_inside++;
        triangle_slopes(x, y, slope);
        assert_relative(p->multiplier[1], slope[0], 1e-6);
        assert_relative(p->multiplier[2], slope[1], 1e-6);
    }
    ck_assert_int_ge(n_inside, 8);
    close_traded(&t);
}
END_TEST

/* No place of the triangle that bounds let the node be at is far from a point. */
START_TEST(a_front_of_three_has_no_holes)
{
    struct traded t = {0};
    double worst = 0;
    open_triangle(&t, 50);
    for (double x = -0.9; x < 0.95; x += 0.1)
        for (double y = 0.1; y <= 1 - fabs(x); y += 0.1) {
            double l = hypot(x + 1, y) - SHORT, m = hypot(x - 1, y) - SHORT, r = hypot(x, y - 1), nearest = INFINITY;
            if (5 * (1 + fabs(x)) / y > MOST_Q) continue;
            for (int i = 0; i < t.front.n_point; i++) {
                const double *f = t.front.point[i].objective;
                nearest =
                    fmin(nearest, sqrt((f[0] - r) * (f[0] - r) + (f[1] - l) * (f[1] - l) + (f[2] - m) * (f[2] - m)));
            }
            worst = fmax(worst, nearest);
        }
    ck_assert_msg(worst < 0.2, "%g", worst);
    close_traded(&t);
}
END_TEST

/* What one step from a start makes of objective k alone. */
static double after_a_step(struct traded *t, const double *start, int k)
{
    const hf_watch_front alone = {k, (const double[]){INFINITY, INFINITY, INFINITY}};
    double design[2] = {start[0], start[1]};
    hf_refine_result refined;
    hf_form_result r;
    hf_workspace *w = &t->net.work;
    hf_status status = hf_refine_run(&t->evaluator, t->lower, t->upper, 1, &alone, NULL, design, w, &refined);
    ck_assert_int_eq(status, HF_OK);
    ck_assert_int_ne(refined.stop, HF_REFINE_CONVERGED);
    ck_assert_int_eq(hf_evaluate(&t->evaluator, design, w, &t->point, &r), HF_OK);
    return r.objective[k];
}

/* Each end is begun from the start that is best in its objective; where that does not come to an end from the start
 * that is best in the next one as well, and the better of both counts. */
START_TEST(a_search_that_does_not_end_is_tried_from_another_start)
{
    struct traded t = {0};
    struct rng rng = rng_start(4000);
    int n_second = 0;
    open_triangle(&t, 4);
    ck_assert_int_eq(hf_objectives_point_create(&t.objectives, &t.point), HF_OK);
    for (int trial = 0; trial < 40; trial++) {
        double start[4];
        hf_form_result at[2];
        hf_front front;
        hf_front_refine trade = trade_of(&t, 4);
        trade.max_iterations = 1;
        trade.n_start = 2;
        trade.start = start;
        for (int i = 0; i < 4; i++)
            start[i] = rng_uniform(&rng, 1, MOST_Q);
        for (int i = 0; i < 2; i++)
            ck_assert_int_eq(hf_evaluate(&t.evaluator, start + 2 * i, &t.net.work, &t.point, &at[i]), HF_OK);
        ck_assert_int_eq(hf_front_refine_find(&trade, &front, &failed_end), HF_OK);
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, first = at[1].objective[k] < at[0].objective[k],
                second = at[1].objective[l] < at[0].objective[l];
            double by_first = after_a_step(&t, start + 2 * first, k),
                   by_second = after_a_step(&t, start + 2 * second, k);
            double least = INFINITY;
            for (int i = 0; i < front.n_point; i++)
                least = fmin(least, front.point[i].objective[k]);
            ck_assert_double_le(least, fmin(by_first, by_second) + 1e-5);
            n_second += by_second < by_first - 1e-3;
        }
        hf_front_free(&front);
    }
    ck_assert_int_gt(n_second, 2);
    close_traded(&t);
}
END_TEST

/* ---- memory ---- */

static void open_line(struct traded *t, int n_point)
{
    const hf_objective_settings wanted[2] = {objective(HF_FIGURE_PSI, "", NAN), objective(HF_FIGURE_LENGTH, "", 0.8)};
    OPEN_HAND(&t->net, on_line, along_line, HF_METHOD_FDM);
    follow(t, 2, wanted, "boundary", 1, 100, n_point);
}

/* A cable between supports keeps its length: psi and the lengths of the others are traded. */
START_TEST(an_objective_without_a_range_leaves_the_others_to_be_traded)
{
    static const struct hand_node node[] = {
        {{-1, 0, 0}, HF_ROLE_SUPPORT, {0}}, {{0.5, 0, 0}, HF_ROLE_INNER, {0}}, {{1, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 10},
                                              {{1, 2}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 12},
                                              {{0, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 5}};
    const hf_objective_settings wanted[3] = {objective(HF_FIGURE_LENGTH, "inner", 0.7),
                                             objective(HF_FIGURE_PSI, "", NAN),
                                             objective(HF_FIGURE_LENGTH, "boundary", 0.8)};
    struct traded t = {0};
    OPEN_HAND(&t.net, node, cable, HF_METHOD_FDM);
    follow(&t, 3, wanted, "boundary", 1, 100, 8);
    ck_assert_int_eq(t.front.minimised, 1);
    ck_assert_int_eq(t.front.n_point, 8);
    for (int i = 0; i < 8; i++)
        ck_assert_int_eq(t.front.point[i].mark, HF_FRONT_ON);
    close_traded(&t);
}
END_TEST

/* Any allocation may fail: no front, no leak, and the next search is as ever. */
START_TEST(without_memory_there_is_no_front)
{
    struct traded t = {0};
    int n_failed = 0, n_point = _i ? 8 : 3;
    if (_i)
        open_triangle(&t, n_point);
    else
        open_line(&t, n_point);
    const hf_front_refine trade = trade_of(&t, n_point);
    for (bool has_failed = true; has_failed;) {
        hf_front front;
        fail_allocation_at(n_failed + 1);
        hf_status status = hf_front_refine_find(&trade, &front, &failed_end);
        has_failed = end_allocation_failure();
        ck_assert_int_eq(status, has_failed ? HF_NO_MEMORY : HF_OK);
        if (has_failed)
            ck_assert_int_eq(front.n_point, 0);
        else
            ck_assert_mem_eq(front.design, t.front.design,
                             (size_t)front.n_point * (size_t)front.n_variable * sizeof(double));
        hf_front_free(&front);
        n_failed += has_failed;
    }
    ck_assert_int_gt(n_failed, 20);
    close_traded(&t);
}
END_TEST

/* ---- a reflector ---- */

static void open_chen(hf_problem *p, const char *objectives)
{
    const char *const set[] = {"optimize.method=lm", objectives, "surface.focal_length_m=15.95"};
    hf_messages messages = {0};
    ck_assert_msg(hf_problem_open("configs/chen2022.yaml", set, 3, 1, p, &messages) == HF_OK, "%s", messages.text);
}

static void bound(const hf_problem *p, double *lower, double *upper)
{
    for (int k = 0; k < p->model.n_variable; k++) {
        lower[k] = fmax(p->initial[k] - 1, 0.1);
        upper[k] = p->initial[k] + 1;
    }
}

static void note_points(void *told, int n_point, long n_step)
{
    ck_assert(n_point >= *(int *)told && n_step > 0);
    *(int *)told = n_point;
}

/* All points are counted for who watches. */
static void follow_problem(hf_problem *p, int n_point, int n_thread, hf_front *front)
{
    int told = 0;
    hf_front_refine_watcher watcher = {.tell = note_points, .context = &told, .is_telling = ATOMIC_FLAG_INIT};
    double lower[MAX_VARIABLE_OF_CASE], upper[MAX_VARIABLE_OF_CASE];
    bound(p, lower, upper);
    const hf_front_refine trade = {.evaluator = &p->evaluator,
                                   .lower = lower,
                                   .upper = upper,
                                   .n_point = n_point,
                                   .max_iterations = 200,
                                   .n_thread = n_thread,
                                   .n_start = 1,
                                   .start = p->initial,
                                   .watcher = &watcher};
    ck_assert_int_eq(hf_front_refine_find(&trade, front, &failed_end), HF_OK);
    ck_assert(watcher.n_point == front->n_point && told > front->n_point / 2);
}

/* The least of objective 0 where the others are at most this, from that design. */
static double least_beside(hf_problem *p, const double most[HF_FRONT_OBJECTIVES_MAX], const double *from)
{
    double design[MAX_VARIABLE_OF_CASE], lower[MAX_VARIABLE_OF_CASE], upper[MAX_VARIABLE_OF_CASE];
    bound(p, lower, upper);
    const hf_watch_front trade = {0, most};
    hf_refine_result r;
    memcpy(design, from, (size_t)p->model.n_variable * sizeof *design);
    ck_assert_int_eq(hf_refine_run(&p->evaluator, lower, upper, 200, &trade, NULL, design, &p->workspace, &r), HF_OK);
    return r.merit;
}

static const char *const traded[] = {
    "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}]",
    "optimize.front=[{figure: facets, feed: fixed}, {figure: pull}]",
    "optimize.front=[{figure: psi}, {figure: evenness, set: boundary}]",
};
enum { N_TRADED = sizeof traded / sizeof *traded, N_POINT = 11 };

/* No point is better than another in both, the gaps between them are about even, and slopes are those of differences,
 * with ratios and pulls, which have corners, and where only smooth goals are weighed. */
START_TEST(points_are_even_and_slopes_those_of_differences)
{
    hf_problem p;
    hf_front front;
    double longest = 0, shortest = INFINITY;
    open_chen(&p, traded[_i]);
    ck_assert_int_le(p.model.n_variable, MAX_VARIABLE_OF_CASE);
    follow_problem(&p, N_POINT, 1, &front);
    ck_assert_int_eq(front.n_point, N_POINT);
    const hf_front_point *a = front.point, *z = a + N_POINT - 1;
    for (int i = 0; i < N_POINT; i++) {
        ck_assert_int_eq(a[i].mark, HF_FRONT_ON);
        if (i == 0) continue;
        double gap = hypot((a[i].objective[0] - a[i - 1].objective[0]) / (z->objective[0] - a->objective[0]),
                           (a[i].objective[1] - a[i - 1].objective[1]) / (z->objective[1] - a->objective[1]));
        longest = fmax(longest, gap);
        shortest = fmin(shortest, gap);
    }
    ck_assert_double_lt(longest, 6 * shortest);
    for (int i = 1; i < N_POINT - 1; i += 3) {
        double step = 1e-5 * (a->objective[1] - z->objective[1]), at = a[i].objective[1];
        const double *design = front.design + (size_t)i * (size_t)front.n_variable;
        const double *last = front.design + (size_t)(N_POINT - 1) * (size_t)front.n_variable;
        double more = least_beside(&p, (const double[]){INFINITY, at + step, INFINITY}, design);
        double less = least_beside(&p, (const double[]){INFINITY, at - step, INFINITY}, last);
        double slope = (less - more) / (2 * step);
        ck_assert_msg(fabs(a[i].multiplier[1] - slope) < 1e-3 * slope, "point %d: %g, by differences %g", i,
                      a[i].multiplier[1], slope);
    }
    hf_front_free(&front);
    hf_problem_free(&p);
}
END_TEST

static const char *const three[] = {
    "optimize.front=[{figure: psi}, {figure: ratio, set: boundary}, {figure: evenness, set: boundary}]",
    "optimize.front=[{figure: psi}, {figure: evenness, set: boundary}, {figure: pull}]",
};
enum { N_THREE = sizeof three / sizeof *three };

/* The least of an objective on the front, and a part of its range. */
static double least_of(const hf_front *f, int k, double part)
{
    double least = INFINITY, largest = -INFINITY;
    for (int i = 0; i < f->n_point; i++) {
        least = fmin(least, f->point[i].objective[k]);
        largest = fmax(largest, f->point[i].objective[k]);
    }
    return least + part * (largest - least);
}

/* No point is better than another in all, and where both limits hold the slopes are those of differences. */
START_TEST(slopes_of_three_are_those_of_differences)
{
    hf_problem p;
    hf_front front;
    int n_held = 0;
    open_chen(&p, three[_i]);
    follow_problem(&p, 16, 2, &front);
    ck_assert_int_ge(front.n_point, 15);
    for (int i = 0; i < front.n_point; i++) {
        const hf_front_point *a = &front.point[i];
        ck_assert_int_eq(a->mark, HF_FRONT_ON);
        bool is_inside = a->multiplier[1] > 0 && a->multiplier[2] > 0;
        for (int k = 1; k < 3; k++)
            is_inside &= a->objective[k] > least_of(&front, k, 0.05);
        if (!is_inside || n_held == 3) continue;
        n_held++;
        for (int k = 1; k < 3; k++) {
            double step = 1e-5 * a->objective[k], least[2];
            for (int side = 0; side < 2; side++) {
                double most[] = {INFINITY, a->objective[1], a->objective[2]};
                most[k] += side ? step : -step;
                least[side] = least_beside(&p, most, front.design + (size_t)i * (size_t)front.n_variable);
            }
            double slope = (least[0] - least[1]) / (2 * step);
            ck_assert_msg(fabs(a->multiplier[k] - slope) < 1e-2 * slope, "point %d: %g, by differences %g", i,
                          a->multiplier[k], slope);
        }
    }
    ck_assert_int_ge(n_held, 2);
    hf_front_free(&front);
    hf_problem_free(&p);
}
END_TEST

START_TEST(threads_do_not_change_a_bit)
{
    hf_problem p;
    hf_front one, two;
    open_chen(&p, _i ? three[0] : traded[0]);
    follow_problem(&p, _i ? 12 : 9, 1, &one);
    follow_problem(&p, _i ? 12 : 9, 2, &two);
    ck_assert_int_eq(one.n_point, two.n_point);
    ck_assert_mem_eq(one.design, two.design, (size_t)one.n_point * (size_t)one.n_variable * sizeof(double));
    for (int i = 0; i < one.n_point; i++) {
        ck_assert_mem_eq(one.point[i].objective, two.point[i].objective, sizeof one.point[i].objective);
        ck_assert_mem_eq(&one.point[i].multiplier[1], &two.point[i].multiplier[1], (size_t)(_i + 1) * sizeof(double));
        ck_assert_int_eq(one.point[i].steps, two.point[i].steps);
    }
    hf_front_free(&one);
    hf_front_free(&two);
    hf_problem_free(&p);
}
END_TEST

/* A run that is told to stop has no front. */
START_TEST(a_stop_ends_the_search)
{
    static const volatile sig_atomic_t stop = 1;
    hf_problem p;
    hf_front front;
    open_chen(&p, traded[0]);
    const hf_front_refine trade = {.evaluator = &p.evaluator,
                                   .lower = p.initial,
                                   .upper = p.initial,
                                   .n_point = 5,
                                   .max_iterations = 200,
                                   .n_thread = 2,
                                   .n_start = 1,
                                   .start = p.initial,
                                   .stop = &stop};
    ck_assert_int_eq(hf_front_refine_find(&trade, &front, &failed_end), HF_INTERRUPTED);
    ck_assert_int_eq(front.n_point, 0);
    hf_front_free(&front);
    hf_problem_free(&p);
}
END_TEST

Suite *suite_unit_front_refine(void)
{
    Suite *suite = suite_create("unit/trade");
    TCase *tests = tcase_create("trade");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, a_node_on_a_line_has_a_front_in_closed_form, 0, 2);
    tcase_add_loop_test(tests, points_are_even_and_slopes_those_of_differences, 0, N_TRADED);
    tcase_add_test(tests, objectives_that_agree_are_one_design);
    tcase_add_test(tests, a_node_in_a_plane_has_a_front_of_three_in_closed_form);
    tcase_add_test(tests, a_front_of_three_has_no_holes);
    tcase_add_test(tests, a_search_that_does_not_end_is_tried_from_another_start);
    tcase_add_test(tests, an_objective_without_a_range_leaves_the_others_to_be_traded);
    tcase_add_loop_test(tests, slopes_of_three_are_those_of_differences, 0, N_THREE);
    tcase_add_loop_test(tests, threads_do_not_change_a_bit, 0, 2);
    tcase_add_loop_test(tests, without_memory_there_is_no_front, 0, 2);
    tcase_add_test(tests, a_stop_ends_the_search);
    tcase_add_test(tests, a_ratio_has_a_front_in_closed_form);
    return suite;
}
