/* Figures of requirements: columns, margins, error bounds against nets whose nodes are displaced, verdicts on the
 * nominal net around a bound, and on shares of samples with random margins. */
#include "built_nets.h"

#include "built/required_radio.h"
#include "built/statistics.h"
#include <hifdm/problem.h>

enum { MAX_ROW = 12 };

typedef struct {
    int n;
    hf_requirement_settings row[MAX_ROW];
} row_list;

/* Adds a row. share NaN: the nominal net. */
static hf_requirement_settings *add(row_list *l, hf_required_figure figure, const char *set, const char *load_case,
                                    double at_least, double at_most, double share)
{
    hf_requirement_settings *r = &l->row[l->n++];
    ck_assert_int_le(l->n, MAX_ROW);
    *r = (hf_requirement_settings){
        .figure = figure, .at_least = at_least, .at_most = at_most, .within = {-INFINITY, INFINITY}, .share = share};
    snprintf(r->set, sizeof r->set, "%s", set);
    snprintf(r->load_case, sizeof r->load_case, "%s", load_case);
    return r;
}

static const hf_load_cases two_cases = {.n = 2, .load_case = {{.name = "cold"}, {.name = "hot"}}};

static void create(const row_list *l, const hf_scene *scene, const double *mass_kg_per_m, hf_required *q)
{
    ck_assert_int_eq(hf_required_create(l->n, l->row, scene, &two_cases, mass_kg_per_m, q), HF_OK);
}

/* Fixed between (-1, 0, 0), (1, 0, 0) and (0, 1, 0), a node at the origin. */
static const struct hand_node star_node[] = {{{0, 0, 0}, HF_ROLE_INNER, {0}},
                                             {{-1, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                             {{2, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                             {{0, 1, 0}, HF_ROLE_SUPPORT, {0}}};
static const struct hand_cable star_cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 20},
                                               {{0, 2}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 20},
                                               {{3, 0}, HF_GROUP_BOUNDARY, HF_LAW_TENSION, 5}};

/* ---- columns and figures ---- */

/* Rows of the same figure and set share a column, whose load cases are those of all its rows. */
START_TEST(columns_are_measured_once)
{
    row_list l = {0};
    struct net net;
    hf_required q;
    char name[HF_REQUIRED_NAME_SIZE];
    OPEN_HAND(&net, star_node, star_cable, HF_METHOD_NEWTON);
    add(&l, HF_REQUIRED_TENSION, "", "nominal", 5, 60, NAN);
    add(&l, HF_REQUIRED_TENSION, "", "hot", 4, NAN, 0.9);
    add(&l, HF_REQUIRED_TENSION, "inner", "all", NAN, 50, 0.5);
    add(&l, HF_REQUIRED_SLACK, "", "cold", 0, 2, NAN);
    add(&l, HF_REQUIRED_FACETS, "", "all", NAN, 1, NAN);
    add(&l, HF_REQUIRED_FACETS, "", "cold", NAN, 1, 0)->feed = HF_FIXED;
    add(&l, HF_REQUIRED_GAIN, "", "cold", 50, NAN, NAN)->frequency_Hz = 8e9;
    add(&l, HF_REQUIRED_GAIN, "", "hot", NAN, 60, NAN)->frequency_Hz = 8e9;
    add(&l, HF_REQUIRED_GAIN, "", "cold", 50, NAN, NAN)->frequency_Hz = 8.5e9;
    add(&l, HF_REQUIRED_GAIN_LOSS, "", "all", NAN, 1, 0.5)->frequency_Hz = 8e9;
    create(&l, &net.scene, NULL, &q);
    static const struct {
        const char *name;
        unsigned nominal, many;
    } expected[] = {{"tension_min", 1, 4},         {"tension_max", 1, 0},           {"tension_max_inner", 0, 7},
                    {"slack_cables", 2, 0},        {"facets_refocused", 7, 0},      {"facets_fixed", 0, 2},
                    {"gain_refocused_8GHz", 6, 0}, {"gain_refocused_8.5GHz", 2, 0}, {"gain_loss_refocused_8GHz", 0, 7}};
    ck_assert_int_eq(q.n_column, 9);
    for (int k = 0; k < q.n_column; k++) {
        ck_assert_str_eq(hf_required_column_name(&q.column[k], name), expected[k].name);
        ck_assert_uint_eq(q.column[k].nominal, expected[k].nominal);
        ck_assert_uint_eq(q.column[k].many, expected[k].many);
    }
    ck_assert(q.low[0] == 0 && q.high[0] == 1 && q.low[1] == 0 && q.high[1] == -1 && q.low[3] == q.high[3]);
    ck_assert(q.n_share == 4 && q.share[0] == 1 && q.share[2] == 5);
    unsigned what[HF_REQUIREMENT_ROWS_MAX]; /* rows at a frequency share its antenna, and groups of figures */
    ck_assert_int_eq(q.n_antenna, 2);
    ck_assert(q.column[6].antenna == 0 && q.column[7].antenna == 1 && q.column[8].antenna == 0);
    ck_assert(!hf_required_radio_what(&q, false, 0, what) && what[0] == 0 && what[1] == 0);
    ck_assert(hf_required_radio_what(&q, false, 1, what));
    ck_assert(what[0] == HF_ANTENNA_REFOCUSED && what[1] == HF_ANTENNA_REFOCUSED);
    ck_assert(hf_required_radio_what(&q, true, 1, what) && what[0] == HF_ANTENNA_REFOCUSED && what[1] == 0);
    ck_assert(q.nominal == 7 && q.many == 7);
    ck_assert(hf_required_needs_surface(&q, false, 0) && hf_required_needs_surface(&q, true, 1));
    ck_assert(!hf_required_needs_surface(&q, true, 0) && !hf_required_needs_surface(&q, true, 2));
    ck_assert_str_eq(hf_required_state_name(&q, 0), "nominal");
    ck_assert_str_eq(hf_required_state_name(&q, 2), "hot");
    hf_required_free(&q);
    close_net(&net);
}
END_TEST

/* By hand: pulls of the supports are the tensions; the slack limit is a thousandth of the reference. */
START_TEST(figures_of_a_star_by_hand)
{
    enum { N = 8 };
    row_list l = {0};
    struct net net;
    hf_required q;
    double value[MAX_ROW], item[MAX_ROW], tension_N[] = {20, 20, 5}, mass[] = {0.1, 0.2, 0.4}, position_m[12];
    OPEN_HAND(&net, star_node, star_cable, HF_METHOD_NEWTON);
    add(&l, HF_REQUIRED_TENSION, "", "nominal", 5, 60, NAN);
    add(&l, HF_REQUIRED_RATIO, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_RATIO, "boundary", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_SLACK, "", "nominal", NAN, 0, NAN);
    add(&l, HF_REQUIRED_PULL, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_MASS, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_PSI, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_DEFLECTION, "", "nominal", NAN, 9, NAN);
    create(&l, &net.scene, mass, &q);
    memcpy(position_m, net.model.position_m, sizeof position_m);
    position_m[0] += 3e-3; /* the free node is row 0 */
    position_m[4] -= 4e-3;
    hf_required_shape s = {.model = &net.model, .position_m = position_m, .tension_N = tension_N};
    hf_required_measure(&q, false, 0, &s, value, item);
    const double length_m[] = {hypot(1.003, 4e-3), hypot(1.997, 4e-3), hypot(1.004, 3e-3)};
    static const double wanted_item[] = {2, 0, 2, 2, -1, 1, -1, -1, -1};
    const double expected[] = {5, 20, 4, 4, 0, 20, 0.1 * length_m[0] + 0.2 * length_m[1] + 0.4 * length_m[2], 5e-3};
    for (int k = 0; k < N; k++) {
        ck_assert_double_eq_tol(value[k], expected[k], 1e-12);
        ck_assert_double_eq(item[k], wanted_item[k]);
    }
    ck_assert(isnan(value[N])); /* a net on rigid ground has no deflection */
    hf_required_measure(&q, true, 0, &s, value, item);
    for (int k = 0; k <= N; k++)
        ck_assert(isnan(value[k]) && item[k] == -1); /* no sample needs them */
    tension_N[0] = HF_SLACK_RATIO * net.model.reference_N * (1 - 1e-9);
    hf_required_measure(&q, false, 0, &s, value, item);
    ck_assert(value[4] == 1 && item[4] == 0 && isinf(value[2]) && value[3] == 4);
    tension_N[0] = -20;
    hf_required_measure(&q, false, 0, &s, value, item);
    ck_assert(value[4] == 0 && isnan(value[2]) && value[0] == -20); /* a strut */
    hf_required_free(&q);
    close_net(&net);
}
END_TEST

/* A net on a truss: the displacement of an attachment, and the pull on an attachment, are the maximum over all. */
START_TEST(figures_of_a_net_on_a_truss)
{
    static double EA[MAX_BUILT_CABLE];
    row_list l = {0};
    struct net net;
    hf_required q;
    double value[2], item[2], deflection_m = 0, pull_N = 0;
    int at_deflection = -1, at_pull = -1;
    open_design(&net, 2 * _i, EA, true);
    const hf_model *m = &net.model;
    add(&l, HF_REQUIRED_DEFLECTION, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_PULL, "", "nominal", NAN, 9, NAN);
    create(&l, &net.scene, NULL, &q);
    hf_required_shape s = {.model = m,
                           .position_m = net.work.position_m,
                           .tension_N = net.work.tension_N,
                           .displacement_m = net.work.displacement_m};
    hf_required_measure(&q, false, 0, &s, value, item);
    for (int k = 0; k < m->n_attachment; k++) {
        double square = 0;
        for (int c = 0; c < 3; c++)
            square += pow(net.work.displacement_m[3 * k + c], 2);
        if (sqrt(square) <= deflection_m) continue;
        deflection_m = sqrt(square);
        at_deflection = m->node_of_row[m->attachment_row[k]];
    }
    for (int i = 0; i < m->n_node; i++) {
        double force[3] = {0};
        for (int e = 0; e < m->n_cable; e++)
            for (int end = 0; end < 2; end++) {
                int here = net.scene.end[2 * e + end], there = net.scene.end[2 * e + !end];
                if (here != i) continue;
                double d[3] = {0}, length_m = 0;
                for (int c = 0; c < 3; c++)
                    d[c] = found_m(&net, there, c) - found_m(&net, here, c);
                length_m = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                for (int c = 0; c < 3; c++)
                    force[c] += net.work.tension_N[e] * d[c] / length_m;
            }
        double size_N = sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
        if (net.scene.role[i] != HF_ROLE_SUPPORT || size_N <= pull_N) continue;
        pull_N = size_N;
        at_pull = i;
    }
    ck_assert(deflection_m > 0 && pull_N > 0);
    ck_assert_double_eq_tol(value[0], deflection_m, 1e-14);
    ck_assert_double_eq_tol(value[1], pull_N, 1e-10);
    ck_assert(item[0] == at_deflection && item[1] == at_pull);
    hf_required_free(&q);
    close_design(&net);
}
END_TEST

/* ---- error bounds ---- */

/* Moves each node by at most bound_m. Supports on rigid ground stay. */
static void displace(struct rng *rng, const hf_model *m, double bound_m, const double *from, double *to)
{
    memcpy(to, from, 3 * (size_t)m->n_node * sizeof *to);
    for (int row = 0; row < m->n_free; row++) {
        double d[3], size = 0;
        for (int c = 0; c < 3; c++) {
            d[c] = rng_uniform(rng, -1, 1);
            size += d[c] * d[c];
        }
        for (int c = 0; c < 3; c++)
            to[c * m->n_node + row] += bound_m * d[c] / sqrt(size);
    }
}

/* Sets the tensions that the laws demand in a shape. */
static void apply_laws(const hf_model *m, const hf_workspace *w, const double *position_m, double *tension_N)
{
    for (int e = 0; e < m->n_cable; e++) {
        double square = 0;
        for (int c = 0; c < 3; c++)
            square += pow(
                position_m[c * m->n_node + m->end_row[2 * e]] - position_m[c * m->n_node + m->end_row[2 * e + 1]], 2);
        tension_N[e] = hf_law_tension_N(hf_workspace_cable(m, w, e), sqrt(square));
    }
}

/* Gives the cables of a workspace a law, and target values other than those of the model. */
static void change_laws(const hf_model *m, hf_law law, hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++) {
        double more_N = 1.1 * w->tension_N[e], EA_N = law == HF_LAW_ELASTIC ? w->EA_N[e] : (double)NAN;
        w->law[e] = (unsigned char)law;
        w->target[e] = law == HF_LAW_TENSION         ? more_N
                       : law == HF_LAW_FORCE_DENSITY ? more_N / w->length_m[e]
                                                     : w->length_m[e] / (1 + more_N / EA_N);
    }
}

/* The figures of any shape whose nodes are at most e away differ by at most the bound, for nets of each law, and are
 * not far below it for some. Also after the target values of the workspace have changed. */
START_TEST(error_bounds_hold_for_displaced_nodes)
{
    const hf_law law = (hf_law[]){HF_LAW_TENSION, HF_LAW_FORCE_DENSITY, HF_LAW_ELASTIC}[_i % 3];
    const double bound_m = 1e-6;
    static double EA[MAX_BUILT_CABLE], mass[MAX_BUILT_CABLE];
    double value[2][MAX_ROW], item[MAX_ROW], error[MAX_ROW], closest[MAX_ROW] = {0};
    struct rng rng = rng_start(4200 + (uint64_t)_i);
    row_list l = {0};
    struct net net;
    hf_built built;
    hf_workspace work;
    hf_form_result r;
    hf_required q;
    open_design(&net, _i, EA, false);
    make_built(&net, &built, &work);
    ck_assert_int_eq(hf_built_solve(&built, &(hf_built_net){NULL, NULL, NULL, NULL}, &work, &r), HF_OK);
    const hf_model *m = law == HF_LAW_ELASTIC ? &built.model : &net.model;
    hf_workspace *w = law == HF_LAW_ELASTIC ? &work : &net.work;
    change_laws(m, law, w);
    for (int e = 0; e < m->n_cable; e++)
        mass[e] = rng_uniform(&rng, 0.01, 0.1);
    add(&l, HF_REQUIRED_TENSION, "", "nominal", 5, 60, NAN);
    add(&l, HF_REQUIRED_RATIO, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_PULL, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_MASS, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_PSI, "", "nominal", NAN, 9, NAN);
    create(&l, &net.scene, mass, &q);
    size_t n = 3 * (size_t)m->n_node;
    double *moved_m = malloc((n + (size_t)m->n_cable) * sizeof *moved_m), *tension_N = moved_m + n;
    ck_assert_ptr_nonnull(moved_m);
    for (int trial = 0; trial < 200; trial++) {
        for (int k = 0; k < 2; k++) {
            if (k) displace(&rng, m, bound_m, w->position_m, moved_m);
            const double *position_m = k ? moved_m : w->position_m;
            apply_laws(m, w, position_m, tension_N);
            hf_required_shape s = {.model = m, .position_m = position_m, .tension_N = tension_N, .work = w};
            hf_required_measure(&q, false, 0, &s, value[k], item);
            hf_required_bound_errors(&q, 0, &s, bound_m, bound_m, value[k], error);
        }
        for (int k = 0; k < q.n_column; k++) {
            double off = fabs(value[1][k] - value[0][k]);
            ck_assert_msg(off <= error[k] * (1 + 1e-5) + 1e-12 * value[0][k], "column %d, trial %d: %g, bound %g", k,
                          trial, off, error[k]);
            closest[k] = fmax(closest[k], off / fmax(error[k], 1e-300));
        }
    }
    ck_assert_msg(closest[5] > 0.01, "psi: %g", closest[5]); /* a bound far too large would decide nothing */
    for (int k = 0; k < 5; k++)
        if (law == HF_LAW_FORCE_DENSITY) ck_assert_msg(closest[k] > 1e-3, "column %d: %g", k, closest[k]);
    free(moved_m);
    hf_required_free(&q);
    hf_workspace_free(&work);
    hf_built_free(&built);
    close_design(&net);
}
END_TEST

/* Half-path errors of nodes and facets, raw and after best fit, of a whole reflector. */
START_TEST(error_bounds_hold_for_surfaces)
{
    static const char *const set[] = {"scene.paraboloid.rings=3", "form.pretension_N=20"};
    hf_problem p;
    hf_messages messages = {0};
    const double bound_m = 1e-5;
    double value[2][4], item[4], error[4], most[4] = {0};
    struct rng rng = rng_start(4300);
    row_list l = {0};
    hf_required q;
    ck_assert_msg(hf_problem_open(source_path("configs/paraboloid-6m.yaml"), set, 2, 1, &p, &messages) == HF_OK, "%s",
                  messages.text);
    for (int k = 0; k < 4; k++)
        add(&l, k < 2 ? HF_REQUIRED_SURFACE : HF_REQUIRED_FACETS, "", "nominal", NAN, 1, NAN)->feed =
            k % 2 ? HF_FIXED : HF_REFOCUSED;
    create(&l, &p.scene, NULL, &q);
    double *moved_m = malloc(3 * (size_t)p.model.n_node * sizeof *moved_m);
    ck_assert_ptr_nonnull(moved_m);
    for (int trial = 0; trial < 40; trial++) {
        for (int k = 0; k < 2; k++) {
            hf_surface_measures is;
            if (k) displace(&rng, &p.model, bound_m, p.workspace.position_m, moved_m);
            const double *position_m = k ? moved_m : p.workspace.position_m;
            ck_assert_int_eq(
                hf_surface_measure(&p.surface, &p.facets, &p.model, position_m, p.workspace.tension_N, &is), HF_OK);
            hf_required_shape s = {.model = &p.model,
                                   .position_m = position_m,
                                   .tension_N = p.workspace.tension_N,
                                   .paths = {is.half_path_rms_m, is.fit.half_path_rms_m, is.facet_half_path_rms_m,
                                             is.facet_fit_half_path_rms_m},
                                   .work = &p.workspace};
            hf_required_measure(&q, false, 0, &s, value[k], item);
            hf_required_bound_errors(&q, 0, &s, bound_m, bound_m, value[k], error);
        }
        for (int k = 0; k < 4; k++) {
            ck_assert_double_eq(error[k], bound_m);
            ck_assert_msg(fabs(value[1][k] - value[0][k]) <= bound_m, "column %d: %g", k, value[1][k] - value[0][k]);
            most[k] = fmax(most[k], fabs(value[1][k] - value[0][k]));
        }
    }
    for (int k = 0; k < 4; k++)
        ck_assert_msg(most[k] > 1e-3 * bound_m, "column %d: %g", k, most[k]);
    ck_assert(value[0][0] != value[0][1] && value[0][2] > value[0][0]);
    free(moved_m);
    hf_required_free(&q);
    hf_problem_free(&p);
}
END_TEST

/* Without a certificate only what the laws fix is bounded. A cable of law length has a tension of no known error, which
 * its support and its set share. A tension near the limit of slack leaves the count in doubt. */
START_TEST(what_has_no_bound_says_so)
{
    row_list l = {0};
    struct net net;
    hf_required q;
    double value[MAX_ROW], item[MAX_ROW], error[MAX_ROW], mass[] = {1, 1, 1}, EA[] = {1e4, 1e4, 1e4};
    struct hand_cable cable[3];
    memcpy(cable, star_cable, sizeof cable);
    OPEN_HAND(&net, star_node, cable, HF_METHOD_NEWTON);
    net.scene.EA_N = EA;
    hf_form_prepare(&net.model, &net.work);
    add(&l, HF_REQUIRED_TENSION, "", "nominal", 5, NAN, NAN);
    add(&l, HF_REQUIRED_TENSION, "inner", "nominal", 5, NAN, NAN);
    add(&l, HF_REQUIRED_PULL, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_MASS, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_PSI, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_SLACK, "", "nominal", NAN, 9, NAN);
    add(&l, HF_REQUIRED_LOOSE, "", "nominal", NAN, 9, NAN);
    create(&l, &net.scene, mass, &q);
    double tension_N[] = {20, 20, 5}, limit_N = HF_SLACK_RATIO * net.model.reference_N;
    hf_required_shape s = {
        .model = &net.model, .position_m = net.model.position_m, .tension_N = tension_N, .work = &net.work};
    hf_required_measure(&q, false, 0, &s, value, item);
    hf_required_bound_errors(&q, 0, &s, NAN, NAN, value, error);
    ck_assert(error[0] == 0 && error[1] == 0 && isnan(error[2]) && isnan(error[3]) && isnan(error[4]));
    ck_assert(error[5] == 0 && error[6] == 0);
    hf_required_bound_errors(&q, 0, &s, 1e-9, 0.5 * 1e-9, value, error);
    ck_assert_double_eq_tol(error[2], 2e-9 * 20, 1e-15); /* of the support at 1 m, with 20 N */
    ck_assert_double_eq_tol(error[3], 3 * 2e-9, 1e-15);
    ck_assert_double_eq(error[4], 0.5e-9);
    hf_required_bound_errors(&q, 1, &s, 1e-9, 0.5 * 1e-9, value, error);
    for (int k = 0; k < q.n_column; k++)
        ck_assert(isnan(error[k])); /* no row needs this load case */
    net.work.law[1] = HF_LAW_LENGTH;
    hf_required_bound_errors(&q, 0, &s, 1e-9, 0.5 * 1e-9, value, error);
    ck_assert(isnan(error[0]) && error[1] == 0 && isnan(error[2]) && isnan(error[3]) && isnan(error[5]));
    for (int e = 0; e < 3; e++) {
        net.work.law[e] = HF_LAW_FORCE_DENSITY;
        net.work.target[e] = tension_N[e] = e ? 20 : limit_N * (1 + 1e-10);
    }
    net.work.target[1] = 10;
    hf_required_measure(&q, false, 0, &s, value, item);
    hf_required_bound_errors(&q, 0, &s, 1e-7, 0.5 * 1e-7, value, error);
    ck_assert(value[5] == 0 && error[5] == 1); /* an error of 2e-7 of its tension */
    hf_required_bound_errors(&q, 0, &s, 1e-12, 0.5 * 1e-12, value, error);
    ck_assert(error[5] == 0);
    net.scene.EA_N = NULL;
    hf_required_free(&q);
    close_net(&net);
}
END_TEST

/* ---- the nominal net ---- */

/* Verdicts for a margin and the bound of its error. */
START_TEST(a_margin_is_judged_by_its_error)
{
    static const struct {
        double margin, error;
        hf_verdict expected;
    } table[] = {{2, 1, HF_VERDICT_PASS},      {1, 1, HF_VERDICT_PASS},           {0.999, 1, HF_VERDICT_UNDECIDED},
                 {0, 1, HF_VERDICT_UNDECIDED}, {-0.999, 1, HF_VERDICT_UNDECIDED}, {-1, 1, HF_VERDICT_UNDECIDED},
                 {-1.001, 1, HF_VERDICT_FAIL}, {0, 0, HF_VERDICT_PASS},           {-1e-300, 0, HF_VERDICT_FAIL},
                 {0, NAN, HF_VERDICT_PASS},    {1e-9, NAN, HF_VERDICT_PASS},      {-1e-9, NAN, HF_VERDICT_FAIL},
                 {NAN, 1, HF_VERDICT_FAIL},    {NAN, NAN, HF_VERDICT_FAIL}};
    row_list l = {0};
    struct net net;
    hf_required q;
    OPEN_HAND(&net, star_node, star_cable, HF_METHOD_NEWTON);
    add(&l, HF_REQUIRED_TENSION, "", "nominal", 0, NAN, NAN);
    add(&l, HF_REQUIRED_PULL, "", "nominal", NAN, 0, NAN);
    create(&l, &net.scene, NULL, &q);
    for (size_t k = 0; k < sizeof table / sizeof *table; k++)
        for (int i = 0; i < 2; i++) {
            double value[6] = {table[k].margin, -table[k].margin, NAN, NAN, NAN, NAN}, item[6] = {2, 3, -1, -1, -1, -1},
                   error[6] = {table[k].error, table[k].error, NAN, NAN, NAN, NAN};
            hf_requirement_verdict v = {0};
            hf_required_judge_nominal(&q, i, value, item, error, &v);
            ck_assert_msg(v.verdict == table[k].expected, "%zu: %s", k, hf_verdict_word[v.verdict]);
            ck_assert_str_eq(v.worst_item, i ? "n3" : "c2");
            ck_assert_str_eq(v.worst_load_case, "nominal");
            ck_assert(isnan(v.relative_margin)); /* the bound is 0 */
            if (!isnan(table[k].margin)) ck_assert_double_eq(v.margin, table[k].margin);
        }
    hf_required_free(&q);
    close_net(&net);
}
END_TEST

/* The relatively nearer bound and the load case with the minimum margin count: 56 of 60 is nearer than 8 of 5. A load
 * case with a larger margin and a larger error leaves the row undecided. */
START_TEST(all_load_cases_and_both_bounds_count)
{
    row_list l = {0};
    struct net net;
    hf_required q;
    OPEN_HAND(&net, star_node, star_cable, HF_METHOD_NEWTON);
    add(&l, HF_REQUIRED_TENSION, "", "all", 5, 60, NAN);
    create(&l, &net.scene, NULL, &q);
    ck_assert_int_eq(q.n_column, 2); /* minimum, maximum */
    double value[6] = {20, 30, 8, 41, 30, 56}, item[6] = {0, 1, 2, 0, 1, 2}, error[6] = {0};
    hf_requirement_verdict v = {0};
    int state, column;
    ck_assert_double_eq(hf_required_margin(&q, 0, value, 2, &state, &column), 4.0 / 60);
    ck_assert(state == 2 && column == 1);
    hf_required_judge_nominal(&q, 0, value, item, error, &v);
    ck_assert(v.value == 56 && v.bound == 60 && v.margin == 4 && v.relative_margin == 4.0 / 60 && v.worst_value == 56);
    ck_assert_str_eq(v.worst_load_case, "hot");
    ck_assert_str_eq(v.worst_item, "c2");
    ck_assert_int_eq(v.verdict, HF_VERDICT_PASS);
    error[5] = 4.5; /* of a margin of 4 */
    hf_required_judge_nominal(&q, 0, value, item, error, &v);
    ck_assert_int_eq(v.verdict, HF_VERDICT_UNDECIDED);
    value[5] = 63;
    error[5] = 2;
    hf_required_judge_nominal(&q, 0, value, item, error, &v);
    ck_assert(v.verdict == HF_VERDICT_FAIL && v.value == 63 && v.bound == 60 && v.margin == -3);
    ck_assert(v.relative_margin == -0.05 && v.error_bound == 2);
    ck_assert_str_eq(v.worst_load_case, "hot");
    value[2] = (double)NAN; /* no shape */
    hf_required_judge_nominal(&q, 0, value, item, error, &v);
    ck_assert(v.verdict == HF_VERDICT_FAIL && isinf(v.margin) && v.margin < 0 && isnan(v.value));
    ck_assert_str_eq(v.worst_load_case, "cold");
    hf_required_free(&q);
    close_net(&net);
}
END_TEST

static hf_verdict verdict_on(int n, const hf_requirement_verdict *v)
{
    hf_judgement of = hf_requirements_judge(n, v);
    ck_assert_int_le(of.n_failed + of.n_undecided, of.n_required);
    return hf_judgement_verdict(&of);
}

START_TEST(the_verdict_on_all_rows)
{
    hf_requirement_verdict v[3] = {
        {.verdict = HF_VERDICT_NONE}, {.verdict = HF_VERDICT_NONE}, {.verdict = HF_VERDICT_NONE}};
    ck_assert_int_eq(verdict_on(0, v), HF_VERDICT_NONE);
    ck_assert_int_eq(verdict_on(2, v), HF_VERDICT_NONE);
    v[2].verdict = HF_VERDICT_PASS;
    ck_assert_int_eq(verdict_on(3, v), HF_VERDICT_PASS);
    v[1].verdict = HF_VERDICT_UNDECIDED;
    ck_assert_int_eq(verdict_on(3, v), HF_VERDICT_UNDECIDED);
    v[0].verdict = HF_VERDICT_FAIL;
    ck_assert_int_eq(verdict_on(3, v), HF_VERDICT_FAIL);
}
END_TEST

/* In each pair, the first judgement ranks before the second one: by failed rows, then by undecided ones, then by the
 * margin. One without a verdict ranks last. */
START_TEST(judgements_rank_by_failures_first)
{
    static const hf_judgement pair[][2] = {
        {{3, 0, 0, 0.1}, {3, 1, 0, 5}},   {{3, 0, 3, -1}, {3, 1, 0, 5}},      {{3, 1, 1, 0.1}, {3, 1, 2, 5}},
        {{3, 0, 0, 0.2}, {3, 0, 0, 0.1}}, {{3, 1, 0, -0.1}, {3, 1, 0, -0.2}}, {{3, 2, 1, -5}, {0, 0, 0, 0}},
    };
    for (size_t k = 0; k < sizeof pair / sizeof *pair; k++) {
        ck_assert_int_lt(hf_judgement_compare(&pair[k][0], &pair[k][1]), 0);
        ck_assert_int_gt(hf_judgement_compare(&pair[k][1], &pair[k][0]), 0);
        ck_assert_int_eq(hf_judgement_compare(&pair[k][0], &pair[k][0]), 0);
    }
    hf_judgement no_margin = {3, 0, 0, (double)NAN};
    ck_assert_int_eq(hf_judgement_compare(&no_margin, &pair[0][0]), 0);
}
END_TEST

/* ---- shares ---- */

typedef struct {
    int n_value;
    double *row;
} table;

static hf_status read_rows(void *context, long first, int n, double *row)
{
    const table *t = context;
    memcpy(row, t->row + first * t->n_value, (size_t)n * (size_t)t->n_value * sizeof *row);
    return HF_OK;
}

/* For random margins, numbers of samples and shares: the quantile is at least 0 exactly if the yield is at least the
 * share; it is the value of one sample, which stands at its rank; the worst sample is the first with the minimum. A
 * sample without a shape, or with an infinite ratio, meets no row. */
START_TEST(quantile_and_yield_agree)
{
    struct rng rng = rng_start(4400 + (uint64_t)_i);
    static const double share_table[] = {0.5, 0.9, 0.95, 0.99, 1.0 / 3, 0.7};
    row_list l = {0};
    struct net net;
    hf_required q;
    int n = rng_int(&rng, 10, 3000), part = rng_int(&rng, 0, 99);
    double share = _i % 3 ? share_table[rng_int(&rng, 0, 5)] : (double)rng_int(&rng, 1, n - 1) / n,
           by = _i % 2 ? 1 : 10;
    OPEN_HAND(&net, star_node, star_cable, HF_METHOD_NEWTON);
    add(&l, HF_REQUIRED_TENSION, "", "all", 5, 60, share);
    add(&l, HF_REQUIRED_PSI, "", "hot", NAN, 1, NAN); /* of the nominal net */
    add(&l, HF_REQUIRED_RATIO, "", "cold", NAN, 4, 0.9999);
    create(&l, &net.scene, NULL, &q);
    hf_montecarlo m = {.required = &q, .n_value = HF_TOLERANCE_COLUMNS + q.n_share + 2 * q.n_state * q.n_column};
    table rows = {m.n_value, calloc((size_t)n * (size_t)m.n_value, sizeof(double))};
    ck_assert_ptr_nonnull(rows.row);
    const size_t stride = 2 * (size_t)q.n_column;
    double worst = INFINITY, *margin = malloc((size_t)n * sizeof *margin);
    long met = 0, at_worst = -1;
    ck_assert_ptr_nonnull(margin);
    for (int i = 0; i < n; i++) {
        double *row = rows.row + i * m.n_value, *value = row + hf_montecarlo_value_at(&q, 0, false);
        bool is_good = rng_int(&rng, 0, 99) < part || (int)((i + 1) * share) != (int)(i * share);
        for (int state = 0; state < 3; state++) {
            value[(size_t)state * stride] = floor(by * rng_uniform(&rng, is_good ? 5 : 0, 30)) / by; /* with ties */
            value[(size_t)state * stride + 1] = rng_uniform(&rng, 30, is_good ? 60 : 63);
        }
        if (rng_int(&rng, 0, 49) == 0) value[stride * (size_t)rng_int(&rng, 0, 2)] = (double)NAN;
        value[stride + 3] = rng_int(&rng, 0, 9) ? rng_uniform(&rng, 1, 6) : (double)INFINITY;
        int state, column;
        for (int k = 0; k < 2; k++)
            row[hf_montecarlo_margin_at(k)] = hf_required_margin(&q, q.share[k], value, stride, &state, &column);
        margin[i] = INFINITY; /* again, by hand */
        for (int s = 0; s < 3; s++) {
            double low = (value[(size_t)s * stride] - 5) / 5, high = (60 - value[(size_t)s * stride + 1]) / 60;
            margin[i] = fmin(margin[i], isnan(low) ? -(double)INFINITY : fmin(low, high));
        }
        ck_assert_double_eq(row[hf_montecarlo_margin_at(0)], margin[i]);
        met += margin[i] >= 0;
        if (at_worst < 0 || margin[i] < worst) {
            worst = margin[i];
            at_worst = i;
        }
    }
    hf_requirement_verdict v[3] = {{.margin = -7}, {.margin = -7}, {.margin = -7}};
    const hf_statistics_rows of = {n, read_rows, &rows, m.n_value};
    ck_assert_int_eq(hf_statistics_judge(&m, &of, v), HF_OK);
    ck_assert_double_eq(v[0].yield, (double)met / n);
    ck_assert_msg((v[0].margin >= 0) == ((double)met >= share * n * (1 - 1e-12)), "quantile %g, %ld of %d, share %.17g",
                  v[0].margin, met, n, share);
    ck_assert_int_eq(v[0].worst_sample, at_worst);
    double of_worst = v[0].worst_value;
    if (isinf(worst))
        ck_assert_double_eq(v[0].worst_margin, worst);
    else
        ck_assert(fmin((of_worst - 5) / 5, (60 - of_worst) / 60) == worst &&
                  (v[0].worst_margin == of_worst - 5 || v[0].worst_margin == 60 - of_worst));
    long below = 0, equal = 0, rank = 1 + (long)floor((1 - share) * n + 1e-9);
    for (int i = 0; i < n; i++) {
        below += margin[i] < v[0].relative_margin;
        equal += margin[i] == v[0].relative_margin;
    }
    ck_assert_msg(below < rank && below + equal >= rank, "%ld below, %ld equal, rank %ld", below, equal, rank);
    if (!isinf(v[0].margin)) {
        ck_assert_double_eq(v[0].relative_margin, fmin((v[0].value - 5) / 5, (60 - v[0].value) / 60));
        ck_assert_double_eq(v[0].margin, v[0].bound == 5 ? v[0].value - 5 : 60 - v[0].value);
    }
    hf_verdict expected = v[0].yield_low >= share   ? HF_VERDICT_PASS
                          : v[0].yield_high < share ? HF_VERDICT_FAIL
                                                    : HF_VERDICT_UNDECIDED;
    double low, high;
    hf_statistics_interval(n, met, &low, &high);
    ck_assert(v[0].verdict == expected && v[0].yield_low == low && v[0].yield_high == high);
    ck_assert_double_eq(v[1].margin, -7); /* the nominal net is judged elsewhere */
    ck_assert_int_eq(v[2].verdict, v[2].yield_high < 0.9999 ? HF_VERDICT_FAIL : HF_VERDICT_UNDECIDED);
    ck_assert(v[2].yield < 1 && isinf(v[2].worst_margin) && isinf(v[2].worst_value));
    ck_assert_str_eq(v[2].worst_load_case, "cold");
    free(margin);
    free(rows.row);
    hf_required_free(&q);
    close_net(&net);
}
END_TEST

Suite *suite_unit_required(void)
{
    Suite *suite = suite_create("unit/required");
    TCase *tests = tcase_create("required");
    tcase_add_test(tests, columns_are_measured_once);
    tcase_add_test(tests, figures_of_a_star_by_hand);
    tcase_add_loop_test(tests, figures_of_a_net_on_a_truss, 0, 6);
    tcase_add_loop_test(tests, error_bounds_hold_for_displaced_nodes, 0, 12);
    tcase_add_test(tests, error_bounds_hold_for_surfaces);
    tcase_add_test(tests, what_has_no_bound_says_so);
    tcase_add_test(tests, a_margin_is_judged_by_its_error);
    tcase_add_test(tests, all_load_cases_and_both_bounds_count);
    tcase_add_test(tests, the_verdict_on_all_rows);
    tcase_add_test(tests, judgements_rank_by_failures_first);
    tcase_add_loop_test(tests, quantile_and_yield_agree, 0, 60);
    suite_add_tcase(suite, tests);
    return suite;
}
