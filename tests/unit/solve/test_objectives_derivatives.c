/* Derivatives of the goals of a design by its shape against differences, for every goal, fit and feed. */
#include "objectives.h"

#include "surface/cloud.h"

/* A shape without its solver, and a change of all of it. */
struct shape {
    double *position_m, *tension_N, *displacement_m;
};

static struct shape new_shape(const hf_model *m)
{
    return (struct shape){calloc(3 * (size_t)m->n_node, sizeof(double)), calloc((size_t)m->n_cable, sizeof(double)),
                          calloc(3 * (size_t)m->n_attachment + 1, sizeof(double))};
}

static void free_shape(struct shape *s)
{
    free(s->position_m);
    free(s->tension_N);
    free(s->displacement_m);
}

static struct shape shape_of(const struct net *net)
{
    const hf_model *m = &net->model;
    struct shape s = new_shape(m);
    memcpy(s.position_m, net->work.position_m, 3 * (size_t)m->n_node * sizeof(double));
    memcpy(s.tension_N, net->work.tension_N, (size_t)m->n_cable * sizeof(double));
    memcpy(s.displacement_m, net->work.displacement_m, 3 * (size_t)m->n_attachment * sizeof(double));
    return s;
}

static struct shape random_change(const hf_model *m, struct rng *rng, double move_m, double part_N)
{
    struct shape s = new_shape(m);
    for (int i = 0; i < 3 * m->n_node; i++)
        s.position_m[i] = rng_uniform(rng, -move_m, move_m);
    for (int e = 0; e < m->n_cable; e++)
        s.tension_N[e] = rng_uniform(rng, -part_N, part_N);
    for (int i = 0; i < 3 * m->n_attachment; i++)
        s.displacement_m[i] = rng_uniform(rng, -1e-2, 1e-2);
    return s;
}

/* The workspace holds `from` + t `by`. */
static void put(struct net *net, const struct shape *from, const struct shape *by, double t)
{
    const hf_model *m = &net->model;
    hf_workspace *w = &net->work;
    for (int i = 0; i < 3 * m->n_node; i++)
        w->position_m[i] = from->position_m[i] + t * by->position_m[i];
    for (int i = 0; i < 3 * m->n_attachment; i++)
        w->displacement_m[i] = from->displacement_m[i] + t * by->displacement_m[i];
    for (int e = 0; e < m->n_cable; e++) {
        double square = 0;
        w->tension_N[e] = from->tension_N[e] + t * by->tension_N[e];
        for (int c = 0; c < 3; c++) {
            double d =
                w->position_m[c * m->n_node + m->end_row[2 * e + 1]] - w->position_m[c * m->n_node + m->end_row[2 * e]];
            square += d * d;
        }
        w->length_m[e] = sqrt(square);
    }
}

static const hf_objective_settings differed[] = {
    WANT(PSI, "", NAN, 0.3),          WANT_SURFACES(2),
    WANT(TENSION, "boundary", 10, 3), WANT(LENGTH, "all", NAN, 1),
    WANT(LENGTH, "inner", 0.3, 1),    WANT(EVENNESS, "inner", NAN, 1),
    WANT(PULL, "", NAN, 0.1),         WANT_MASS("", 0.002),
    WANT(DEFLECTION, "", NAN, 1), /* the last: only with a truss */
};
enum { N_DIFFERED = sizeof differed / sizeof *differed };

/* Largest difference of the derivative in a random direction from that by four differences (of the fourth order),
 * over the largest entry; by goal. */
static void differ(struct wanting *t, const struct shape *at, const struct shape *by, double *worst)
{
    const hf_objectives *g = &t->objectives;
    const double place[4] = {-2, -1, 1, 2}, factor[4] = {1.0 / 12, -8.0 / 12, 8.0 / 12, -1.0 / 12}, step = 3e-5;
    double *f = malloc((size_t)g->n_row * sizeof *f), *rate = malloc((size_t)g->n_row * sizeof *rate);
    double *difference = calloc((size_t)g->n_row, sizeof *difference);
    const hf_objectives_rate changes = {by->position_m, by->tension_N, by->displacement_m};
    for (int k = 0; k < 4; k++) {
        put(&t->net, at, by, step * place[k]);
        ck_assert_int_eq(hf_objectives_linearise(g, true, &t->net.work, &t->point, f), HF_OK);
        for (int i = 0; i < g->n_row; i++)
            difference[i] += factor[k] / step * f[i];
    }
    put(&t->net, at, by, 0);
    ck_assert_int_eq(hf_objectives_linearise(g, true, &t->net.work, &t->point, f), HF_OK);
    hf_objectives_push(g, &t->net.work, &t->point, &changes, rate);
    for (int k = 0, row = 0; k < g->n_objective; k++) {
        double most = 0;
        worst[k] = 0;
        for (int i = 0; i < g->objective[k].n_row; i++, row++) {
            most = fmax(most, fabs(rate[row]));
            worst[k] = fmax(worst[k], fabs(rate[row] - difference[row]));
        }
        ck_assert_double_gt(most, 0);
        worst[k] /= most;
    }
    free(f);
    free(rate);
    free(difference);
}

/* At the shape `found`, roughened, which are freed: each goal's derivative is that of differences. */
static void demand_derivatives(struct wanting *t, struct shape *found, struct shape *rough, struct rng *rng)
{
    double worst[N_DIFFERED];
    put(&t->net, found, rough, 1);
    struct shape at = shape_of(&t->net), by = random_change(&t->net.model, rng, 1, 10);
    differ(t, &at, &by, worst);
    for (int k = 0; k < t->objectives.n_objective; k++)
        ck_assert_msg(worst[k] < 1e-7, "goal %d: %g", k, worst[k]);
    free_shape(found);
    free_shape(rough);
    free_shape(&at);
    free_shape(&by);
}

START_TEST(derivatives_are_those_of_differences)
{
    struct wanting t = {0};
    bool is_round = _i / 2, with_truss = _i % 2;
    struct rng rng = rng_start((uint64_t)_i);
    open_wanting(&t, is_round, with_truss, &rng);
    want(&t, with_truss ? N_DIFFERED : N_DIFFERED - 1, differed);
    struct shape found = shape_of(&t.net), rough = random_change(&t.net.model, &rng, 1e-2, 2);
    demand_derivatives(&t, &found, &rough, &rng);
    close_wanting(&t);
}
END_TEST

/* Largest and smallest tension of a set in turn, each smooth. */
START_TEST(the_ratio_has_derivatives)
{
    struct wanting t = {0};
    struct rng rng = rng_start((uint64_t)_i);
    hf_objective_settings ratio[2] = {WANT(RATIO, "inner", NAN, 1), WANT(RATIO, "boundary", NAN, 0.4)};
    open_wanting(&t, _i / 2, _i % 2, &rng);
    want(&t, 2, ratio);
    struct shape found = shape_of(&t.net), rough = random_change(&t.net.model, &rng, 1e-3, 0.1);
    for (int e = 0; e < t.net.model.n_cable; e++) /* of the small bowl on soft supports some are slack */
        found.tension_N[e] = 10 + 0.1 * (e % 13);
    demand_derivatives(&t, &found, &rough, &rng);
    close_wanting(&t);
}
END_TEST

/* Fits with fewer parameters turn about the centre of the points, which moves with them: where the wanted surface has
 * another focal length (0, 1), or stands a metre aside (2, 3). */
START_TEST(lesser_fits_follow_their_centre)
{
    static const int n_parameter[4] = {4, 3, 5, 4};
    struct wanting t = {0};
    bool is_round = _i % 2, is_aside = _i / 2;
    struct rng rng = rng_start((uint64_t)_i);
    hf_objective_settings objective[4];
    for (int k = 0; k < 4; k++) {
        objective[k] = objective_of(k / 2 ? HF_FIGURE_FACETS : HF_FIGURE_SURFACE);
        objective[k].along = (hf_along)(k % 2);
    }
    open_wanting(&t, is_round, false, &rng);
    if (!is_aside) t.surface.focal_length_m *= 0.3;
    want(&t, 4, objective);
    struct shape found = shape_of(&t.net), rough = random_change(&t.net.model, &rng, 1e-3, 2);
    for (int row = 0; row < t.net.model.n_node && is_aside; row++)
        found.position_m[row] += 1;
    demand_derivatives(&t, &found, &rough, &rng);
    for (int k = 0; k < 4; k++)
        ck_assert_int_eq(t.point.cloud[k].pose.found.n, n_parameter[_i]);
    close_wanting(&t);
}
END_TEST

/* Every kind of feed, beside the focus as well, by both polarisations: the point and the line turn what they send. */
START_TEST(the_gain_has_derivatives_under_every_feed)
{
    struct wanting t = {0};
    struct rng rng = rng_start((uint64_t)_i);
    hf_objective_settings gain[2] = {objective_of(HF_FIGURE_GAIN), objective_of(HF_FIGURE_GAIN)};
    hf_feed_kind kind = (hf_feed_kind)(HF_FEED_POINT + _i / 2 % 3);
    gain[0].weight = 2;
    gain[1].frequency_Hz = 0.7e9;
    open_wanting(&t, _i / 6, _i % 2, &rng);
    t.surface.pattern.feed = kind;
    t.surface.pattern.polarisation = (hf_polarisation)(_i % 2);
    t.surface.pattern.cos_power = 2.3;
    for (int d = 0; d < 3 && kind != HF_FEED_PLANE_WAVE; d++)
        t.surface.pattern.position_m[d] = (d == 2 ? t.surface.focal_length_m : 0) + rng_uniform(&rng, -0.1, 0.1);
    want(&t, 2, gain);
    struct shape found = shape_of(&t.net), rough = random_change(&t.net.model, &rng, 1e-2, 2);
    demand_derivatives(&t, &found, &rough, &rng);
    close_wanting(&t);
}
END_TEST

Suite *suite_unit_objectives_derivatives(void)
{
    Suite *suite = suite_create("unit/goals_derivatives");
    TCase *tests = tcase_create("derivatives");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, derivatives_are_those_of_differences, 0, 4);
    tcase_add_loop_test(tests, the_ratio_has_derivatives, 0, 4);
    tcase_add_loop_test(tests, lesser_fits_follow_their_centre, 0, 4);
    tcase_add_loop_test(tests, the_gain_has_derivatives_under_every_feed, 0, 12);
    return suite;
}
