/* Derivatives of every goal by everything that a design may vary, against differences of solved shapes: on fixed
 * supports and on a truss, cable by cable and set by set, as hf_evaluate takes a design and as Levenberg-Marquardt
 * does. */
#include "objectives.h"

#include "net/variables.h"
#include "search/residuals.h"

enum { N_VARY = HF_VARY_SUPPORT_XYZ + 1, MAX_CABLE = 80, MAX_VARIABLE = 80, MAX_ROW = 2400, MAX_TRIED = 8 };
#define STIFFNESS_N 2e4
#define MOVE_M 3e-4 /* of the node that a step moves most: differences of order 4 are off by some (MOVE_M/l)^4 */
#define AGREEMENT 1e-7

struct designed {
    struct net net;
    hf_surface_settings surface;
    hf_facets facets;
    hf_objectives objectives;
    hf_objectives_point point;
    hf_evaluator evaluator;
    hf_sensitivity slopes;
    double EA[MAX_CABLE], start_q[MAX_CABLE], base[MAX_VARIABLE];
};

/* What each kind of variable is tried on: a small double net has ties of law length, rear cables of law elastic, a
 * front of law tension, a rear edge of law force density. */
static const char *const set_of[N_VARY] = {
    [HF_VARY_TENSION] = "front",          [HF_VARY_FORCE_DENSITY] = "front", [HF_VARY_LENGTH] = "tie",
    [HF_VARY_UNSTRESSED_LENGTH] = "rear", [HF_VARY_SUPPORT_Z] = "rear_edge", [HF_VARY_SUPPORT_NORMAL] = "front_edge",
    [HF_VARY_SUPPORT_XYZ] = "front_edge",
};

static const hf_objective_settings wanted[] = {
    WANT_ERROR(SURFACE, NORMAL, FIXED, 1), /* the first: without a truss */
    WANT(PSI, "", NAN, 1),
    WANT_ERROR(SURFACE, NORMAL, REFOCUSED, 1),
    WANT_ERROR(SURFACE, HALF_PATH, FIXED, 1),
    WANT_ERROR(SURFACE, HALF_PATH, REFOCUSED, 1),
    WANT_ERRORS(FACETS, 2),
    WANT(TENSION, "tie", 9, 1),
    WANT(TENSION, "rear", 9, 1),
    WANT(LENGTH, "front", NAN, 2),
    WANT(EVENNESS, "all", NAN, 1),
    WANT(PULL, "", NAN, 1),
    WANT(GAIN, "", NAN, 1),
    WANT_MASS("", 0.01),
    WANT(DEFLECTION, "", NAN, 1), /* the last: only with a truss */
};
enum { N_WANTED = sizeof wanted / sizeof *wanted - 1 };

/* ---- the net ---- */

static bool is_in(const hf_scene *s, int e, const char *name)
{
    for (int k = 0; k < s->n_set; k++)
        for (int i = s->set_start[k]; i < s->set_start[k + 1]; i++)
            if (s->set_cable[i] == e && strcmp(s->set_name[k], name) == 0) return true;
    return false;
}

/* Every cable keeps tension and length of a shape that tensions alone hold, by the law of its set. */
static void mix_laws(struct designed *d)
{
    struct net *net = &d->net;
    hf_scene *s = &net->scene;
    ck_assert_int_le(s->n_cable, MAX_CABLE);
    for (int e = 0; e < s->n_cable; e++) {
        s->law[e] = HF_LAW_TENSION;
        s->target[e] = is_in(s, e, "tie") ? 8 : 10 + 0.1 * (e % 7);
        d->EA[e] = STIFFNESS_N;
    }
    hf_workspace_free(&net->work);
    hf_model_free(&net->model);
    open_net(net);
    ck_assert_int_eq(find_shape(net), HF_OK);
    for (int e = 0; e < s->n_cable; e++) {
        double tension = net->work.tension_N[e], length = net->work.length_m[e];
        if (is_in(s, e, "tie")) s->law[e] = HF_LAW_LENGTH, s->target[e] = length;
        if (is_in(s, e, "rear")) s->law[e] = HF_LAW_ELASTIC, s->target[e] = length / (1 + tension / STIFFNESS_N);
        if (is_in(s, e, "rear_edge")) s->law[e] = HF_LAW_FORCE_DENSITY, s->target[e] = tension / length;
    }
    s->EA_N = d->EA;
    hf_workspace_free(&net->work);
    hf_model_free(&net->model);
    open_net(net);
}

static void open_designed(struct designed *d, hf_vary vary, hf_link link, bool on_truss)
{
    hf_messages messages = {0};
    struct rng rng = rng_start(5);
    struct net *net = &d->net;
    hf_optimize_settings s = {.n_variable_row = 1, .n_term = N_WANTED};
    OPEN_CASE(net, "configs/paraboloid-6m.yaml", "scene.paraboloid.rings=2", "surface.frequencies_Hz=[0.3e9]",
              "surface.pattern.n_theta=3");
    net->form = tight_form(HF_METHOD_NEWTON);
    net->form.residual_tolerance = net->form.length_tolerance = 1e-13;
    net->form.coupling = (hf_coupling_settings){1e-13, HF_COUPLING_AUTO, 200};
    ck_assert_int_eq(hf_config_surface(&net->settings, &net->scene, &d->surface, &messages), HF_OK);
    ck_assert_int_eq(hf_facets_find(&net->scene, &d->surface, &d->facets), HF_OK);
    mix_laws(d);
    s.variable_row[0] = (hf_variable_settings){.vary = vary, .range = 1, .range_ratio = NAN, .link = link};
    snprintf(s.variable_row[0].set, sizeof s.variable_row[0].set, "%s", set_of[vary]);
    _Static_assert(N_WANTED <= HF_DESIGN_ROWS_MAX, "all goals at once");
    memcpy(s.term, wanted + on_truss, N_WANTED * sizeof *wanted);
    hf_status status = hf_variables_apply(&net->scene, &s, &d->surface, &net->model, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    hf_workspace_free(&net->work);
    ck_assert_int_eq(hf_workspace_create(&net->model, &net->work), HF_OK);
    if (on_truss) attach_all(net, &rng, 1e-4);
    status =
        hf_objectives_create(&net->scene, &net->model, &s, &d->surface, &d->facets, NULL, &d->objectives, &messages);
    ck_assert_msg(status == HF_OK, "%s", messages.text);
    ck_assert_int_le(d->objectives.n_row, MAX_ROW);
}

/* The base design, in the meaning that the evaluator gives it. */
static void start(struct designed *d, bool by_density)
{
    const hf_model *m = &d->net.model;
    hf_workspace *w = &d->net.work;
    d->evaluator = (hf_evaluator){.model = m,
                                  .form = &d->net.form,
                                  .start_q_N_per_m = d->start_q,
                                  .rule = HF_RULE_TENSION,
                                  .solver = HF_SOLVER_NEWTON,
                                  .boundary_ratio_cap = INFINITY,
                                  .objectives = &d->objectives,
                                  .by_density = by_density};
    ck_assert_int_eq(hf_evaluate_form(m, &d->net.form, w, NULL, &d->net.result), HF_OK);
    ck_assert(m->n_variable > 0 && m->n_variable <= MAX_VARIABLE);
    memcpy(d->start_q, w->q_N_per_m, (size_t)m->n_cable * sizeof(double));
    hf_variables_read(m, w->q_N_per_m, w->tension_N, w->length_m, d->base);
    for (int k = 0; k < m->n_variable && by_density && hf_model_vary(m, k) == HF_VARY_TENSION; k++)
        d->base[k] *= hf_evaluate_divisor(&d->evaluator, k) / w->length_m[m->variable_cable[k]];
    ck_assert_int_eq(hf_objectives_point_create(&d->objectives, &d->point), HF_OK);
    ck_assert_int_eq(hf_sensitivity_create(&d->evaluator, &d->slopes), HF_OK);
}

static void close_designed(struct designed *d)
{
    hf_sensitivity_free(&d->slopes);
    hf_objectives_point_free(&d->point);
    hf_objectives_free(&d->objectives);
    hf_facets_free(&d->facets);
    close_net(&d->net);
}

/* ---- derivatives ---- */

/* Residuals of the base design with variable i changed by `step`. */
static void residuals_at(struct designed *d, int i, double step, double *residual)
{
    const hf_model *m = &d->net.model;
    hf_form_result result;
    double design[MAX_VARIABLE];
    for (int k = 0; k < m->n_variable; k++)
        design[k] = d->base[k] + (d->slopes.class_of_variable[k] == i ? step : 0);
    ck_assert_int_eq(hf_evaluate(&d->evaluator, design, &d->net.work, &d->point, &result), HF_OK);
    ck_assert_int_eq(hf_objectives_linearise(&d->objectives, true, &d->net.work, &d->point, residual), HF_OK);
}

/* Central differences over `step` and twice that, together of order 4. */
static void differ(struct designed *d, int i, double step, double *rate)
{
    double at[4][MAX_ROW];
    for (int k = 0; k < 4; k++)
        residuals_at(d, i, step * (k < 2 ? 1 : 2) * (k % 2 ? -1 : 1), at[k]);
    for (int r = 0; r < d->objectives.n_row; r++)
        rate[r] = (8 * (at[0][r] - at[1][r]) - (at[2][r] - at[3][r])) / (12 * step);
}

/* Exact derivatives by variable i at the base design, and a step that moves no node by more than MOVE_M. */
static double derive(struct designed *d, int i, double *rate)
{
    const hf_model *m = &d->net.model;
    double residual[MAX_ROW], tension[MAX_CABLE], *move = malloc(3 * sizeof *move * (size_t)m->n_node), most = 0;
    ck_assert_ptr_nonnull(move);
    residuals_at(d, i, 0, residual);
    ck_assert_int_eq(hf_sensitivity_find(&d->slopes, &d->net.work), HF_OK);
    hf_sensitivity_spread(&d->slopes, i, move, tension);
    const double *displacement = m->n_attachment ? hf_sensitivity_displacement(&d->slopes, i, 0) : NULL;
    hf_objectives_push(&d->objectives, &d->net.work, &d->point, &(hf_objectives_rate){move, tension, displacement},
                       rate);
    for (int k = 0; k < 3 * m->n_node; k++)
        most = fmax(most, fabs(move[k]));
    free(move);
    ck_assert_double_gt(most, 0);
    return MOVE_M / most;
}

/* |x - y|; y: NULL for zero. */
static double distance(int n, const double *x, const double *y)
{
    double square = 0;
    for (int i = 0; i < n; i++)
        square += (x[i] - (y ? y[i] : 0)) * (x[i] - (y ? y[i] : 0));
    return sqrt(square);
}

/* Exact and found derivatives of each goal by each variable that is tried, relative to the largest of the goal. */
static void assert_derivatives(struct designed *d, const char *what)
{
    static double exact[MAX_TRIED][MAX_ROW], found[MAX_TRIED][MAX_ROW];
    int n_tried = 0, stride = 1 + d->slopes.n / MAX_TRIED;
    for (int i = 0; i < d->slopes.n; i += stride, n_tried++)
        differ(d, i, derive(d, i, exact[n_tried]), found[n_tried]);
    for (int k = 0, first = 0; k < d->objectives.n_objective; first += d->objectives.objective[k++].n_row) {
        double largest = 0;
        int n = d->objectives.objective[k].n_row;
        for (int i = 0; i < n_tried; i++)
            largest = fmax(largest, distance(n, exact[i] + first, NULL));
        for (int i = 0; i < n_tried; i++) {
            double off = distance(n, exact[i] + first, found[i] + first);
            ck_assert_msg(off <= AGREEMENT * largest, "%s, variable %d, goal %d: off by %g of %g", what, i * stride, k,
                          off, largest);
        }
    }
}

START_TEST(every_pair_agrees_with_differences)
{
    struct designed d = {0};
    hf_vary vary = (hf_vary)(_i / 8);
    bool by_set = _i / 4 % 2, on_truss = _i / 2 % 2, by_density = _i % 2;
    if (by_density && vary != HF_VARY_TENSION) return; /* the same to the bit */
    char what[80];
    snprintf(what, sizeof what, "%s of %s, link %s%s%s", hf_vary_word[vary], set_of[vary], by_set ? "set" : "each",
             on_truss ? ", truss" : "", by_density ? ", as densities" : "");
    open_designed(&d, vary, by_set ? HF_LINK_SET : HF_LINK_EACH, on_truss);
    start(&d, by_density);
    ck_assert_int_eq(d.slopes.n, !by_set ? d.net.model.n_variable : vary == HF_VARY_SUPPORT_XYZ ? 3 : 1);
    ck_assert_int_gt(d.net.model.n_variable, 3);
    assert_derivatives(&d, what);
    close_designed(&d);
}
END_TEST

/* Residuals, their derivatives by every variable and the gradient, by so many threads. */
static double *rates_by(struct designed *d, int n_thread)
{
    hf_residuals residuals;
    hf_form_result result;
    size_t n = (size_t)d->slopes.n, n_row = (size_t)d->objectives.n_row;
    double *all = malloc((n_row + n + n * n_row) * sizeof *all);
    ck_assert_ptr_nonnull(all);
    hf_sensitivity_free(&d->slopes);
    d->evaluator.n_thread = n_thread;
    ck_assert_int_eq(hf_sensitivity_create(&d->evaluator, &d->slopes), HF_OK);
    ck_assert_int_eq(hf_residuals_create(&d->evaluator, &residuals), HF_OK);
    ck_assert_int_eq(hf_evaluate(&d->evaluator, d->base, &d->net.work, &d->point, &result), HF_OK);
    ck_assert_int_eq(hf_sensitivity_find(&d->slopes, &d->net.work), HF_OK);
    ck_assert_int_eq(hf_residuals_find(&residuals, &d->net.work), HF_OK);
    memcpy(all, residuals.value, n_row * sizeof *all);
    hf_residuals_rates(&residuals, &d->slopes, &d->net.work, all + n_row + n, all + n_row);
    hf_residuals_free(&residuals);
    return all;
}

START_TEST(any_number_of_threads_gives_the_same_bits)
{
    static const hf_vary tried[] = {HF_VARY_TENSION, HF_VARY_LENGTH}; /* length: all that is done for stiff springs */
    struct designed d = {0};
    open_designed(&d, tried[_i / 2], HF_LINK_EACH, _i % 2);
    start(&d, false);
    double *by_one = rates_by(&d, 0);
    for (int n_thread = 1; n_thread <= 3; n_thread++) {
        double *by_many = rates_by(&d, n_thread);
        size_t n = (size_t)d.slopes.n, n_row = (size_t)d.objectives.n_row;
        ck_assert_mem_eq(by_many, by_one, (n_row + n + n * n_row) * sizeof *by_one);
        free(by_many);
    }
    free(by_one);
    close_designed(&d);
}
END_TEST

Suite *suite_unit_sensitivity(void)
{
    Suite *s = suite_create("unit/sensitivity");
    TCase *t = tcase_create("derivatives");
    tcase_add_loop_test(t, every_pair_agrees_with_differences, 0, 8 * N_VARY);
    tcase_add_loop_test(t, any_number_of_threads_gives_the_same_bits, 0, 4);
    suite_add_tcase(s, t);
    return s;
}
