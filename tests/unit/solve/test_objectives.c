/* Goals of a design: values by hand and by the measures of a result, residuals against values, and what is refused. */
#include "objectives.h"

#include "surface/gain.h"

/* ---- values ---- */

START_TEST(without_rows_the_objective_is_psi)
{
    struct wanting t = {0};
    struct rng rng = rng_start((uint64_t)_i);
    double value, merit;
    open_wanting(&t, _i / 2, _i % 2, &rng);
    want(&t, 0, NULL);
    ck_assert_int_eq(t.objectives.n_objective, 1);
    long before = allocation_count();
    hf_status status = hf_objectives_measure(&t.objectives, &t.net.work, &t.point, &value, &merit);
    long after = allocation_count();
    ck_assert_int_eq(status, HF_OK);
    ck_assert_int_eq(after, before);
    ck_assert_mem_eq(&value, &t.net.result.psi_m, sizeof value);
    ck_assert_mem_eq(&merit, &t.net.result.psi_m, sizeof merit);
    close_wanting(&t);
}
END_TEST

/* Two inner nodes between two supports, 3, 4 and 5 N, at their theoretical places. */
static void open_line(struct wanting *t)
{
    static const struct hand_node node[] = {
        {{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
        {{1, 0, 0}, HF_ROLE_INNER, {0}},
        {{2, 0, 0.75}, HF_ROLE_INNER, {0}},
        {{3, 0, 0.75}, HF_ROLE_SUPPORT, {0}},
    };
    static const struct hand_cable cable[] = {
        {{0, 1}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 1},
        {{1, 2}, HF_GROUP_INNER, HF_LAW_FORCE_DENSITY, 1},
        {{2, 3}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 1},
    };
    *t = (struct wanting){0};
    OPEN_HAND(&t->net, node, cable, HF_METHOD_FDM);
    hf_workspace *w = &t->net.work;
    memcpy(w->position_m, t->net.model.position_m, 3 * 4 * sizeof(double));
    memset(w->loose, 0, 4);
    for (int e = 0; e < 3; e++) {
        w->tension_N[e] = 3 + e;
        w->length_m[e] = e == 1 ? 1.25 : 1;
    }
}

static double value_of(struct wanting *t, hf_objective_settings objective, double *merit)
{
    double value;
    want(t, 1, &objective);
    ck_assert_int_eq(hf_objectives_measure(&t->objectives, &t->net.work, &t->point, &value, merit), HF_OK);
    hf_objectives_point_free(&t->point);
    hf_objectives_free(&t->objectives);
    return value;
}

static const struct {
    hf_objective_settings objective;
    double value, merit;
} by_hand[] = {
    {WANT(PSI, "", NAN, 1), 0.5, 0.5}, /* one of two nodes is sqrt(1/2) away */
    {WANT(TENSION, "boundary", 4, 2), 1, 2},
    {WANT(TENSION, "inner", 4, 1), 0, 0},
    {WANT(LENGTH, "inner", 1, 1), 0.25, 0.25},
    {WANT(LENGTH, "", NAN, 1), 0, 0},
    {WANT(EVENNESS, "all", NAN, 4), 0.20412414523193150, 0.81649658092772603}, /* sqrt(2/3)/4 */
    {WANT_MASS("", 0.5), 1.625, 1.625},
    {WANT(PULL, "", NAN, 2), 5, 10.000176296057074},                /* 2 (3^16 + 5^16)^(1/16) */
    {WANT(RATIO, "boundary", NAN, 2), 5.0 / 3, 3.3334508650740591}, /* 10/3 (1 + (3/5)^16)^(1/8) */
};
enum { N_BY_HAND = sizeof by_hand / sizeof *by_hand };

START_TEST(values_are_those_by_hand)
{
    struct wanting t;
    double merit;
    open_line(&t);
    if (_i == 0) t.net.work.position_m[2 * 4 + t.net.model.row_of_node[1]] += sqrt(0.5);
    double value = value_of(&t, by_hand[_i].objective, &merit);
    ck_assert_double_eq_tol(value, by_hand[_i].value, 1e-15);
    ck_assert_double_eq_tol(merit, by_hand[_i].merit, 2e-15 * (1 + by_hand[_i].merit));
    close_wanting(&t);
}
END_TEST

/* A slack cable leaves no ratio, and no direction to a better one. */
START_TEST(a_slack_cable_has_no_ratio)
{
    struct wanting t;
    double merit, residual[6];
    hf_objective_settings ratio = objective_of(HF_FIGURE_RATIO);
    open_line(&t);
    t.net.work.tension_N[1] = 0;
    ck_assert(isinf(value_of(&t, ratio, &merit)) && isinf(merit));
    want(&t, 1, &ratio);
    ck_assert_int_eq(hf_objectives_linearise(&t.objectives, true, &t.net.work, &t.point, residual), HF_NOT_FINITE);
    close_wanting(&t);
}
END_TEST

/* Loose nodes are left out of psi; without a node there is no psi. */
START_TEST(loose_nodes_do_not_count)
{
    struct wanting t;
    double merit, residual[6], rate[6];
    const hf_objective_settings psi = objective_of(HF_FIGURE_PSI);
    open_line(&t);
    const hf_model *m = &t.net.model;
    hf_workspace *w = &t.net.work;
    w->position_m[2 * 4 + m->row_of_node[1]] += 0.5;
    w->position_m[m->row_of_node[2]] = NAN; /* it does not matter where a loose node is */
    w->loose[m->row_of_node[2]] = 1;
    ck_assert_double_eq(value_of(&t, psi, &merit), 0.5);
    want(&t, 1, &psi);
    ck_assert_int_eq(hf_objectives_linearise(&t.objectives, true, w, &t.point, residual), HF_OK);
    double square = 0, move[12], turn = 0;
    for (int i = 0; i < 12; i++)
        move[i] = 1;
    hf_objectives_push(&t.objectives, w, &t.point, &(hf_objectives_rate){move, NULL, NULL}, rate);
    for (int i = 0; i < 6; i++) {
        square += residual[i] * residual[i];
        turn += residual[i] * rate[i];
    }
    ck_assert_double_eq(square, 0.25);
    ck_assert_double_eq(turn, 0.5);
    w->loose[m->row_of_node[1]] = 1;
    ck_assert_int_eq(hf_objectives_linearise(&t.objectives, true, w, &t.point, residual), HF_NOT_FINITE);
    double value = 0;
    ck_assert_int_eq(hf_objectives_measure(&t.objectives, w, &t.point, &value, &merit), HF_OK);
    ck_assert(isnan(value) && isnan(merit));
    close_wanting(&t);
}
END_TEST

/* The merit is that of the weighted values; the residuals have it as their norm. */
START_TEST(objectives_are_weighed_together)
{
    struct wanting t = {0};
    struct rng rng = rng_start(0);
    hf_objective_settings objective[4] = {objective_of(HF_FIGURE_PSI), objective_of(HF_FIGURE_EVENNESS),
                                          objective_of(HF_FIGURE_FACETS), objective_of(HF_FIGURE_LENGTH)};
    double value[4], merit, square = 0, sum = 0;
    objective[0].weight = 3;
    objective[1].weight = 0.5;
    objective[3].weight = 0;
    open_wanting(&t, false, false, &rng);
    want(&t, 4, objective);
    double *residual = malloc((size_t)t.objectives.n_row * sizeof *residual);
    ck_assert_int_eq(hf_objectives_measure(&t.objectives, &t.net.work, &t.point, value, &merit), HF_OK);
    ck_assert_int_eq(hf_objectives_linearise(&t.objectives, true, &t.net.work, &t.point, residual), HF_OK);
    for (int k = 0; k < 4; k++)
        square += objective[k].weight * value[k] * objective[k].weight * value[k];
    for (int i = 0; i < t.objectives.n_row; i++)
        sum += residual[i] * residual[i];
    ck_assert_double_gt(value[3], 0);
    ck_assert_double_eq_tol(merit, sqrt(square), 1e-14 * merit);
    ck_assert_double_eq_tol(merit, sqrt(sum), 1e-13 * merit);
    free(residual);
    close_wanting(&t);
}
END_TEST

/* Those of the surface are measures of a result; the fits as well. */
START_TEST(errors_of_the_surface_are_those_of_a_result)
{
    struct wanting t = {0};
    struct rng rng = rng_start((uint64_t)_i);
    hf_surface_measures is;
    double value[8], merit;
    const hf_objective_settings objective[8] = {WANT_SURFACES(1)};
    open_wanting(&t, _i, false, &rng);
    for (int i = 0; i < 3 * t.net.model.n_node; i++)
        t.net.work.position_m[i] += rng_uniform(&rng, -1e-2, 1e-2);
    want(&t, 8, objective);
    ck_assert_int_eq(
        hf_surface_measure(&t.surface, &t.facets, &t.net.model, t.net.work.position_m, t.net.work.tension_N, &is),
        HF_OK);
    ck_assert_int_eq(hf_objectives_measure(&t.objectives, &t.net.work, &t.point, value, &merit), HF_OK);
    const double wanted[8] = {is.normal_rms_m,          is.fit.normal_rms_m,         is.half_path_rms_m,
                              is.fit.half_path_rms_m,   is.facet_normal_rms_m,       is.facet_fit_normal_rms_m,
                              is.facet_half_path_rms_m, is.facet_fit_half_path_rms_m};
    for (int k = 0; k < 8; k++) { /* the reported fit has half of the digits of its parameters (cloud.c) */
        double within = objective[k].feed == HF_REFOCUSED && objective[k].along == HF_ALONG_NORMAL ? 1e-7 : 1e-13;
        ck_assert_double_eq_tol(value[k], wanted[k], within * wanted[k]);
    }
    close_wanting(&t);
}
END_TEST

/* The goal is the root of the part that is lost, at the highest frequency or its own; a net that is not lit has no
 * value. */
START_TEST(the_gain_is_what_the_field_loses)
{
    struct wanting t = {0};
    struct rng rng = rng_start((uint64_t)_i);
    double value, merit, residual[20000];
    hf_gain_beam beam;
    hf_objective_settings gain = objective_of(HF_FIGURE_GAIN);
    if (_i % 2) gain.frequency_Hz = 0.2e9;
    open_wanting(&t, _i / 2, false, &rng);
    want(&t, 1, &gain);
    ck_assert_int_le(t.objectives.n_row, 20000);
    const hf_model *m = &t.net.model;
    double *place = calloc(3 * (size_t)m->n_node, sizeof *place);
    hf_model_positions(m, t.net.work.position_m, place);
    hf_gain_beam_make(&t.surface, &t.facets, t.net.scene.position_m, _i % 2 ? 0.2e9 : 0.3e9, &beam);
    double loss_dB = hf_gain_loss_dB(&beam, &(hf_pattern_surface){&t.facets, place, NULL});
    ck_assert_int_eq(hf_objectives_measure(&t.objectives, &t.net.work, &t.point, &value, &merit), HF_OK);
    ck_assert_double_eq(value, merit);
    ck_assert_double_gt(value, 1e-3);
    ck_assert_double_eq_tol(-10 * log10(1 - value * value), loss_dB, 1e-12);
    for (int i = 0; i < m->n_node; i++) /* turned over */
        t.net.work.position_m[i] = -t.net.work.position_m[i];
    ck_assert_int_eq(hf_objectives_linearise(&t.objectives, true, &t.net.work, &t.point, residual), HF_NOT_FINITE);
    free(place);
    close_wanting(&t);
}
END_TEST

/* ---- what is refused ---- */

static const struct {
    hf_objective_settings objective;
    const char *said;
} faulty[] = {
    {WANT(TENSION, "bounday", 4, 1), ".set: this net has no cable set 'bounday'; did you mean 'boundary'?"},
    {WANT_MASS("rear", 1), ".set: this net has no cable set 'rear'. The sets of this net are all, inner, boundary"},
    {WANT(TENSION, "inner", NAN, 1), ": tension: needs a target, in N"},
    {WANT(EVENNESS, "inner", NAN, 1), ": evenness: the evenness of one cable is always 0; use a set of several cables"},
    {WANT(RATIO, "inner", NAN, 1), ": ratio: the ratio of one cable is always 1; use a set of several cables"},
    {WANT(MASS, "", NAN, 1), ": mass: needs mass_kg_per_m of the cables of its set"},
    {WANT(SURFACE, "", NAN, 1),
     ": surface: needs a target surface: add a section surface (with focal_length_m for an imported net)"},
    {WANT(FACETS, "", NAN, 1),
     ": facets: needs a target surface: add a section surface (with focal_length_m for an imported net)"},
    {WANT(GAIN, "", NAN, 1), ": gain: needs a section surface.pattern with the feed of the reflector"},
    {WANT(DEFLECTION, "", NAN, 1), ": deflection: needs a truss that deflects, but this net has none"},
};
enum { N_FAULTY = sizeof faulty / sizeof *faulty };

/* All rows are read: the first and the third here have the same fault, the second has none. */
START_TEST(a_objective_without_meaning_is_refused)
{
    struct wanting t;
    hf_messages messages = {0};
    char said[512];
    hf_optimize_settings s = {
        .n_term = 3, .term = {faulty[_i].objective, {.figure = HF_FIGURE_PSI, .weight = 1}, faulty[_i].objective}};
    open_line(&t);
    ck_assert_int_eq(hf_objectives_create(&t.net.scene, &t.net.model, &s, NULL, NULL, NULL, &t.objectives, &messages),
                     HF_BAD_CASE);
    snprintf(said, sizeof said, "error: optimize.objective.0%s\nerror: optimize.objective.2%s\n", faulty[_i].said,
             faulty[_i].said);
    ck_assert_str_eq(messages.text, said);
    hf_messages_free(&messages);
    close_wanting(&t);
}
END_TEST

START_TEST(a_surface_may_lack_facets_and_nodes)
{
    struct wanting t;
    hf_messages messages = {0};
    const hf_surface_settings surface = {.focal_length_m = 2, .kind = HF_SURFACE_PARABOLIC_CYLINDER};
    hf_optimize_settings s = {.n_term = 2, .term = {objective_of(HF_FIGURE_FACETS), objective_of(HF_FIGURE_SURFACE)}};
    open_line(&t);
    ck_assert_int_eq(hf_facets_find(&t.net.scene, &surface, &t.facets), HF_OK);
    ck_assert_int_eq(
        hf_objectives_create(&t.net.scene, &t.net.model, &s, &surface, &t.facets, NULL, &t.objectives, &messages),
        HF_BAD_CASE);
    ck_assert_str_eq(messages.text,
                     "error: optimize.objective.0: facets: this net has no facets\n"
                     "error: optimize.objective.1: surface: a refocused feed needs at least six inner nodes; use feed: "
                     "fixed\n");
    hf_messages_free(&messages);
    close_wanting(&t);
}
END_TEST

START_TEST(without_memory_there_are_no_objectives)
{
    struct wanting t;
    const hf_objective_settings objective = objective_of(HF_FIGURE_EVENNESS);
    hf_optimize_settings s = {.n_term = 1, .term = {objective}};
    hf_messages messages = {0};
    open_line(&t);
    fail_allocation_at(1);
    hf_status status = hf_objectives_create(&t.net.scene, &t.net.model, &s, NULL, NULL, NULL, &t.objectives, &messages);
    ck_assert(end_allocation_failure());
    ck_assert_int_eq(status, HF_NO_MEMORY);
    hf_objectives_free(&t.objectives);
    hf_messages_free(&messages);
    want(&t, 1, &objective);
    hf_objectives_point_free(&t.point);
    fail_allocation_at(1);
    status = hf_objectives_point_create(&t.objectives, &t.point);
    ck_assert(end_allocation_failure());
    ck_assert_int_eq(status, HF_NO_MEMORY);
    close_wanting(&t);
}
END_TEST

/* Three samples of 2^30 residuals are more than an int holds: no table of them may be made too small. */
START_TEST(too_many_residuals_are_refused)
{
    struct wanting t;
    hf_objective_settings objective = objective_of(HF_FIGURE_PSI);
    const hf_objectives_nets nets = {.n_sample = 1 << 30};
    hf_messages messages = {0};
    open_line(&t);
    objective.over = HF_OVER_SAMPLES;
    hf_optimize_settings s = {.n_term = 3, .term = {objective, objective, objective}};
    ck_assert_int_eq(hf_objectives_create(&t.net.scene, &t.net.model, &s, NULL, NULL, &nets, &t.objectives, &messages),
                     HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(messages.text, "optimize.samples"));
    hf_messages_free(&messages);
    hf_objectives_free(&t.objectives);
    objective.over = HF_OVER_DESIGN;
    want(&t, 1, &objective);
    close_wanting(&t);
}
END_TEST

/* The name under which files, tables and JSON have a goal tells it from every other. */
START_TEST(names_tell_objectives_apart)
{
    static const struct {
        hf_objective_settings wanted;
        const char *name;
    } row[] = {
        {{.figure = HF_FIGURE_PSI}, "objective_%d_psi"},
        {{.figure = HF_FIGURE_TENSION, .set = "edge"}, "objective_%d_tension_edge"},
        {{.figure = HF_FIGURE_PSI, .load_case = "hot"}, "objective_%d_psi_hot"},
        {{.figure = HF_FIGURE_RATIO, .set = "edge", .load_case = "hot", .take = HF_TAKE_WORST},
         "objective_%d_ratio_edge_hot"},
        {{.figure = HF_FIGURE_PSI, .load_case = "a_name_of_a_state_of_31_letters"},
         "objective_%d_psi_a_name_of_a_state_of_31_"},
        {{.figure = HF_FIGURE_PSI, .load_case = "all", .take = HF_TAKE_MEAN}, "objective_%d_psi_load_cases_mean"},
        {{.figure = HF_FIGURE_PSI, .load_case = "all", .take = HF_TAKE_WORST}, "objective_%d_psi_load_cases_worst"},
        {{.figure = HF_FIGURE_PSI, .over = HF_OVER_SAMPLES, .take = HF_TAKE_MEAN}, "objective_%d_psi_samples_mean"},
        {{.figure = HF_FIGURE_PSI, .over = HF_OVER_SAMPLES, .quantile = 0.9}, "objective_%d_psi_samples_quantile"}};
    for (int k = 0; k < (int)(sizeof row / sizeof *row); k++) {
        hf_objectives objectives = {.n_objective = 1};
        char name[HF_OBJECTIVE_NAME_SIZE], expected[HF_OBJECTIVE_NAME_SIZE];
        objectives.objective[k].settings = row[k].wanted;
        snprintf(expected, sizeof expected, row[k].name, k);
        ck_assert_str_eq(hf_objectives_name(&objectives, k, name), expected);
    }
}
END_TEST

Suite *suite_unit_objectives(void)
{
    Suite *suite = suite_create("unit/goals");
    TCase *tests = tcase_create("goals");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, without_rows_the_objective_is_psi, 0, 4);
    tcase_add_loop_test(tests, values_are_those_by_hand, 0, N_BY_HAND);
    tcase_add_test(tests, names_tell_objectives_apart);
    tcase_add_test(tests, loose_nodes_do_not_count);
    tcase_add_test(tests, a_slack_cable_has_no_ratio);
    tcase_add_test(tests, objectives_are_weighed_together);
    tcase_add_loop_test(tests, errors_of_the_surface_are_those_of_a_result, 0, 2);
    tcase_add_loop_test(tests, the_gain_is_what_the_field_loses, 0, 4);
    tcase_add_loop_test(tests, a_objective_without_meaning_is_refused, 0, N_FAULTY);
    tcase_add_test(tests, a_surface_may_lack_facets_and_nodes);
    tcase_add_test(tests, without_memory_there_are_no_objectives);
    tcase_add_test(tests, too_many_residuals_are_refused);
    return suite;
}
