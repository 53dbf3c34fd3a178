/* Draws, solves and measures samples of an as-built net (METHOD section 12):
 *
 *     seed, sample ---> numbers z (built/errors, built/directions) ---> cut lengths, EA, supports
 *                        |                                                |
 *                        v                                                v
 *              linear model: psi (predict)                  shape (hf_built_batch_run)
 *                        |                                                |
 *                        |                                                v
 *                        |                      psi, tensions, surface, far field (take_sample)
 *                        v                                                v
 *                      row of the sample [HF_TOLERANCE_COLUMNS] <---------+
 *
 * Contents: making, errors of a sample, measures, first order, samples, requirements. */
#include "built/montecarlo.h"

#include "base/arena.h"
#include "built/required_radio.h"
#include "search/parallel.h"
#include "surface/antenna_shape.h"

#include <math.h>

/* Limits of the number of samples in one call. Their numbers are kept in at most CHUNK_BYTES until the linear model has
 * used them, but for CHUNK_MIN samples in any case. No limit affects the bits of a sample. */
#define CHUNK_BYTES (64 << 20)
#define CHUNK_MIN 64
#define CHUNK_MAX 256
#define AT_ONCE 6 /* right-hand sides of one solve of the linear model */

/* ---- making ---- */

static bool has_surface(const hf_montecarlo *t)
{
    return t->surface && t->surface->focal_length_m > 0;
}

static void choose_sizes(hf_montecarlo *t)
{
    const hf_model *m = &t->built->model;
    size_t n_error = (size_t)hf_built_errors_count(&t->errors), bytes = n_error * sizeof(double);
    size_t n = CHUNK_BYTES / (bytes + 1);
    t->n_z = n_error;
    t->n_chunk = n < CHUNK_MIN ? CHUNK_MIN : n > CHUNK_MAX ? CHUNK_MAX : (int)n;
    if (t->n_chunk > t->settings->samples) t->n_chunk = t->settings->samples;
    t->n_room = AT_ONCE * (t->linear.n_dof + (size_t)m->n_cable + t->linear.n_scratch);
}

hf_status hf_montecarlo_create(const hf_tolerance_settings *s, const hf_built *b, const hf_surface_settings *surface,
                               const hf_facets *facets, const hf_built_heat *heat, int n_thread, hf_montecarlo *t)
{
    *t = (hf_montecarlo){.settings = s, .built = b, .surface = surface, .facets = facets};
    HF_TRY(hf_built_batch_create(b, n_thread, &t->batch));
    n_thread = hf_built_batch_threads(t->batch);
    HF_TRY(hf_built_linear_make(b, &t->linear));
    HF_TRY(hf_built_errors_make(&t->linear, s, heat, &t->errors));
    HF_TRY(hf_covariance_find(&t->errors, n_thread, &t->covariance));
    if (s->sampling == HF_SAMPLING_SOBOL)
        HF_TRY(hf_directions_find(&t->errors, &t->covariance, n_thread, &t->directions));
    choose_sizes(t);
    size_t n = (size_t)t->n_chunk;
    t->n_value = HF_TOLERANCE_COLUMNS;
    HF_TRY(HF_ARENA_ARRAYS(&t->block, HF_ARRAY(t->row, n * HF_TOLERANCE_COLUMNS),
                           HF_ARRAY(t->point, n * (size_t)t->directions.n), HF_ARRAY(t->z, n * t->n_z),
                           HF_ARRAY(t->scratch, (size_t)n_thread * t->n_room)));
    t->varies = hf_built_errors_vary(&t->errors);
    if (!has_surface(t)) return HF_OK;
    return hf_surface_design_make(surface, facets, &b->model, b->position_m, b->tension_N, &t->design);
}

/* Makes the net of a load case, near which its samples are. */
static hf_status make_load_case(hf_montecarlo *t, const hf_built_rest *rest, hf_montecarlo_load_case *to,
                                hf_messages *messages)
{
    hf_built_loaded *net = &to->net;
    hf_built_loaded_select(t->required->load_cases, to->state - 1, rest, t->built->model.n_attachment, net);
    HF_TRY(hf_built_loaded_make(t->built, NULL, hf_built_batch_threads(t->batch), net, messages));
    if (!net->has_shape) return HF_OK;
    if (hf_required_needs_surface(t->required, true, to->state))
        HF_TRY(hf_surface_design_make(t->surface, t->facets, &t->built->model, net->built.position_m,
                                      net->built.tension_N, &to->design));
    return hf_required_radio_near(
        t->required, &(hf_required_net){&t->built->model, net->built.position_m, net->built.tension_N}, to->antenna);
}

hf_status hf_montecarlo_require(hf_montecarlo *t, const hf_required *q, const hf_built_rest *rest,
                                hf_messages *messages)
{
    if (q->n_share == 0) return HF_OK;
    int n = 0;
    for (int state = 1; state < q->n_state; state++)
        n += (int)(q->many >> state & 1u);
    t->required = q;
    t->n_value = HF_TOLERANCE_COLUMNS + q->n_share + 2 * q->n_state * q->n_column + HF_SAMPLE_COUNTS;
    HF_TRY(HF_ARENA_ARRAYS(&t->required_block, HF_ARRAY(t->row, (size_t)t->n_chunk * (size_t)t->n_value),
                           HF_ARRAY(t->load_case, n), HF_ARRAY(t->antenna, (1 + n) * q->n_antenna)));
    HF_TRY(hf_required_radio_near(q, &(hf_required_net){&t->built->model, t->built->position_m, t->built->tension_N},
                                  t->antenna));
    for (int state = 1; state < q->n_state; state++) {
        if (!(q->many >> state & 1u)) continue;
        t->load_case[t->n_load_case].state = state;
        t->load_case[t->n_load_case].antenna = t->antenna + (1 + t->n_load_case) * q->n_antenna;
        HF_TRY(make_load_case(t, rest, &t->load_case[t->n_load_case++], messages));
    }
    return HF_OK;
}

void hf_montecarlo_free(hf_montecarlo *t)
{
    for (int k = 0; k < t->n_load_case; k++)
        hf_built_loaded_free(&t->load_case[k].net);
    hf_arena_free_block(t->required_block);
    hf_built_batch_free(t->batch);
    hf_directions_free(&t->directions);
    hf_arena_free_block(t->covariance.block);
    hf_arena_free_block(t->errors.block);
    hf_built_linear_free(&t->linear);
    hf_arena_free_block(t->block);
    *t = (hf_montecarlo){0};
}

/* ---- errors of a sample ---- */

/* Makes the errors of sample i, as an hf_built_sample. */
static void make_sample(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m,
                        double *load_N)
{
    hf_montecarlo *t = context;
    size_t k = (size_t)(i - t->first);
    (void)load_N;
    double *z = t->z + k * t->n_z;
    if (t->directions.n)
        hf_directions_draw(&t->directions, i, t->point + k * (size_t)t->directions.n, z);
    else
        hf_built_errors_draw(&t->errors, i, z);
    hf_built_errors_apply(&t->errors, t->scale, z, cut_m, EA_N, support_displacement_m);
}

/* Samples of one load case. */
typedef struct {
    hf_montecarlo *t;
    const hf_montecarlo_load_case *load_case;
} loaded_samples;

/* Makes the errors of sample i in a load case, as an hf_built_sample. They are those of the same sample without load
 * case, and the errors of the load case itself. */
static void make_loaded(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m,
                        double *load_N)
{
    const loaded_samples *l = context;
    const hf_montecarlo *t = l->t;
    hf_built_loaded_apply(&l->load_case->net, &t->errors, t->scale, i, t->z + (size_t)(i - t->first) * t->n_z, cut_m,
                          EA_N, support_displacement_m, load_N);
}

/* ---- measures ---- */

bool hf_montecarlo_measures(const hf_surface_settings *surface, const hf_facets *facets, hf_tolerance_measure measure)
{
    /* What there is, and as a condition: what a measure needs besides. */
    enum { ALWAYS = 0, SURFACE = 1, HAS_FACETS = 2, HAS_FREQUENCY = 4, HAS_PATTERN = 8 };
    enum { FACETS = SURFACE | HAS_FACETS, LOSS = SURFACE | HAS_FREQUENCY, FACET_LOSS = FACETS | LOSS };
    enum { PATTERN = FACETS | HAS_PATTERN };
#define CONDITION(name, word, unit, condition, description) condition,
    static const int condition_of[HF_TOLERANCE_N_MEASURE] = {HF_TOLERANCE_MEASURES(CONDITION)};
#undef CONDITION
    int has = facets && facets->n_facet > 0 ? HAS_FACETS : 0;
    if (surface && surface->focal_length_m > 0)
        has |= SURFACE | (surface->frequencies_Hz.n > 0 ? HAS_FREQUENCY : 0) | (surface->has_pattern ? HAS_PATTERN : 0);
    return (condition_of[measure] & ~has) == 0;
}

/* Returns Ruze's gain loss at the highest frequency; NaN without a frequency. */
static double loss_dB(const hf_montecarlo *t, double half_path_rms_m)
{
    double highest_Hz = hf_surface_highest_Hz(t->surface);
    if (!(highest_Hz > 0)) return (double)NAN;
    double loss = hf_surface_gain_loss_dB(half_path_rms_m, highest_Hz);
    return isnan(loss) && !isnan(half_path_rms_m) ? (double)INFINITY : loss; /* outside the range of Ruze's formula */
}

/* Measures the far-field loss of a sample. Pillows whose mesh tension exceeds what a cable can hold have none. */
static hf_status measure_pattern(const hf_montecarlo *t, const hf_built_shape *is, double *value)
{
    hf_antenna_shape shape;
    hf_status status = hf_antenna_shape_take(t->surface->mesh_tension_N_per_m, t->facets, &t->built->model,
                                             is->position_m, is->tension_N, &shape);
    if (status == HF_OK && shape.exists) *value = hf_gain_loss_dB(t->beam, &shape.surface);
    hf_antenna_shape_free(&shape);
    return status;
}

/* Measures the surface of a sample. A fit that does not converge gives NaN, and so does its gain loss. Neither meets a
 * requirement. */
static void measure_surface(hf_montecarlo *t, const hf_built_shape *shape, hf_surface_paths *is, double *value)
{
    if (hf_surface_measure_near(&t->design, t->surface, t->facets, &t->built->model, shape->position_m,
                                shape->tension_N, is) != HF_OK ||
        (t->beam && measure_pattern(t, shape, &value[HF_TOLERANCE_PATTERN_LOSS]) != HF_OK)) {
        t->has_no_memory = true;
        return;
    }
    value[HF_TOLERANCE_HALF_PATH] = is->nodes_m;
    value[HF_TOLERANCE_FIT_HALF_PATH] = is->nodes_fit_m;
    bool has_facets = t->facets && t->facets->n_facet > 0;
    if (has_facets) {
        value[HF_TOLERANCE_FACET_HALF_PATH] = is->facets_m;
        value[HF_TOLERANCE_FACET_FIT_HALF_PATH] = is->facets_fit_m;
    }
    for (int k = 0; k < (has_facets ? 4 : 2); k++)
        value[HF_TOLERANCE_GAIN_LOSS + k] = loss_dB(t, value[HF_TOLERANCE_HALF_PATH + k]);
}

/* Returns psi over all inner nodes, as in the linear model. The psi of a result leaves out loose nodes; here they count
 * at the positions that they were given. */
static double psi_m_of(const hf_montecarlo *t, const hf_built_shape *shape, const hf_form_result *r)
{
    const hf_model *m = &t->built->model;
    double sum = 0;
    if (r->n_loose == 0) return r->psi_m;
    for (int k = 0; k < 3 * m->n_inner_node; k++) {
        int at = k % 3 * m->n_node + m->inner_row[k / 3];
        double d = shape->position_m[at] - m->position_m[at];
        sum += d * d;
    }
    return m->n_inner_node > 0 ? sqrt(sum / m->n_inner_node) : (double)NAN;
}

static double *row_of(const hf_montecarlo *t, long i)
{
    return t->row + (size_t)(i - t->first) * (size_t)t->n_value;
}

/* Measures what the rows of `requirements` need of a sample in one load case. All nodes count in psi. `antenna`: those
 * whose best fits start from the shape without errors. */
static void measure_required(hf_montecarlo *t, const hf_model *m, int state, const hf_antenna *antenna,
                             const hf_built_shape *shape, const hf_form_result *r, const hf_surface_paths *paths,
                             double *row)
{
    hf_antenna_figures radio[HF_REQUIREMENT_ROWS_MAX];
    unsigned what[HF_REQUIREMENT_ROWS_MAX];
    if (hf_required_radio_what(t->required, true, state, what) &&
        hf_required_radio_measure(t->required, antenna, what,
                                  &(hf_required_net){m, shape->position_m, shape->tension_N}, radio) != HF_OK) {
        t->has_no_memory = true;
        return;
    }
    const hf_required_shape of = {.model = m,
                                  .position_m = shape->position_m,
                                  .tension_N = shape->tension_N,
                                  .displacement_m = shape->displacement_m,
                                  .n_loose = r->n_loose,
                                  .paths = *paths,
                                  .radio = radio};
    hf_required_measure(t->required, true, state, &of, row + hf_montecarlo_value_at(t->required, state, false),
                        row + hf_montecarlo_value_at(t->required, state, true));
}

/* Adds the shape of a sample in one load case to the counts of its row. r is NULL if the load case has no shape. */
static void count_slack(const hf_montecarlo *t, const hf_form_result *r, double *row)
{
    double *count = row + hf_montecarlo_count_at(t->required);
    bool is_first = isnan(count[HF_SAMPLE_SLACK]), has_shape = r && r->status == HF_OK;
    count[HF_SAMPLE_SLACK] = fmax(is_first ? 0 : count[HF_SAMPLE_SLACK], has_shape ? r->n_slack : 0);
    count[HF_SAMPLE_WITHOUT_SHAPE] = (is_first ? 0 : count[HF_SAMPLE_WITHOUT_SHAPE]) + !has_shape;
}

/* Measures the shape of sample i and writes its row, as an hf_built_take. */
static void take_sample(void *context, long i, const hf_built_shape *shape, const hf_form_result *r)
{
    hf_montecarlo *t = context;
    const hf_model *m = &t->built->model;
    double *row = row_of(t, i), *value = row + HF_TOLERANCE_FIRST;
    hf_surface_paths paths = {NAN, NAN, NAN, NAN};
    row[HF_TOLERANCE_STATUS] = r->status;
    for (int k = HF_TOLERANCE_FIRST; k < t->n_value; k++)
        row[k] = (double)NAN;
    if (t->required) count_slack(t, r, row);
    if (r->status != HF_OK) return;
    value[HF_TOLERANCE_PSI] = psi_m_of(t, shape, r);
    value[HF_TOLERANCE_SLACK] = r->n_slack;
    value[HF_TOLERANCE_LOOSE] = r->n_loose;
    double min_N = INFINITY;
    for (int e = 0; e < m->n_cable; e++)
        min_N = fmin(min_N, shape->tension_N[e]);
    value[HF_TOLERANCE_MIN_TENSION] = min_N;
    if (has_surface(t) && !t->skips_surface) measure_surface(t, shape, &paths, value);
    if (t->required) measure_required(t, m, 0, t->antenna, shape, r, &paths, row);
}

/* Measures the shape of sample i in a load case, as an hf_built_take. */
static void take_loaded(void *context, long i, const hf_built_shape *shape, const hf_form_result *r)
{
    const loaded_samples *l = context;
    hf_montecarlo *t = l->t;
    const hf_montecarlo_load_case *c = l->load_case;
    hf_surface_paths paths = {NAN, NAN, NAN, NAN};
    count_slack(t, r, row_of(t, i));
    if (r->status != HF_OK) return; /* the values are NaN already */
    if (hf_required_needs_surface(t->required, true, c->state) &&
        hf_surface_measure_near(&c->design, t->surface, t->facets, &c->net.built.model, shape->position_m,
                                shape->tension_N, &paths) != HF_OK)
        t->has_no_memory = true;
    measure_required(t, &c->net.built.model, c->state, c->antenna, shape, r, &paths, row_of(t, i));
}

/* ---- first order ---- */

/* Computes psi of up to AT_ONCE samples by the linear model, in one solve. */
static void predict(void *context, int room, int i)
{
    hf_montecarlo *t = context;
    const hf_built_linear *l = &t->linear;
    if (hf_built_must_stop(t->built)) return;
    int first = i * AT_ONCE, n = t->n_now - first < AT_ONCE ? t->n_now - first : AT_ONCE;
    size_t n_cable = (size_t)t->built->model.n_cable;
    double *move = t->scratch + (size_t)room * t->n_room, *strain = move + AT_ONCE * l->n_dof,
           *more = strain + AT_ONCE * n_cable;
    for (int k = 0; k < n; k++)
        hf_built_errors_strain(&t->errors, t->scale, t->z + (size_t)(first + k) * t->n_z, strain + (size_t)k * n_cable,
                               move + (size_t)k * l->n_dof);
    hf_built_linear_apply(l, NULL, n, strain, NULL, move, more);
    for (int k = 0; k < n; k++)
        t->row[(first + k) * t->n_value + HF_TOLERANCE_LINEAR_PSI] =
            hf_covariance_psi_m(l, move + (size_t)k * l->n_dof);
}

#define TOUCH_SAMPLES 64 /* give a standard deviation within 9 % of the exact one */
hf_status hf_montecarlo_find_touchiest(const hf_montecarlo *t, int *cable, double *deviation_N)
{
    const hf_built_linear *l = &t->linear;
    const size_t n_cable = (size_t)t->built->model.n_cable;
    double *z, *move, *strain, *change, *square, *more, worst = -1;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(z, t->n_z), HF_ARRAY(move, l->n_dof), HF_ARRAY(strain, n_cable),
                           HF_ARRAY(change, n_cable), HF_ARRAY(square, n_cable), HF_ARRAY(more, l->n_scratch)));
    for (long i = 0; i < TOUCH_SAMPLES; i++) {
        hf_built_errors_draw(&t->errors, i, z);
        hf_built_errors_strain(&t->errors, 1, z, strain, move);
        hf_built_linear_apply(l, NULL, 1, strain, NULL, move, more);
        hf_built_linear_tension(l, strain, move, change);
        for (size_t e = 0; e < n_cable; e++)
            square[e] += change[e] * change[e] / TOUCH_SAMPLES;
    }
    for (size_t e = 0; e < n_cable; e++) {
        double ratio = sqrt(square[e]) / t->built->tension_N[e];
        if (!(ratio > worst)) continue;
        worst = ratio;
        *cable = (int)e;
        *deviation_N = sqrt(square[e]);
    }
    hf_arena_free_block(block);
    return HF_OK;
}

/* ---- samples ---- */

static void find_margins(hf_montecarlo *t, int n)
{
    const hf_required *q = t->required;
    const size_t stride = 2 * (size_t)q->n_column;
    int state, column;
    for (int i = 0; i < n; i++) {
        double *row = t->row + (size_t)i * (size_t)t->n_value;
        for (int k = 0; k < q->n_share; k++)
            row[hf_montecarlo_margin_at(k)] =
                hf_required_margin(q, q->share[k], row + hf_montecarlo_value_at(q, 0, false), stride, &state, &column);
    }
}

hf_status hf_montecarlo_run(hf_montecarlo *t, double scale, long first, int n)
{
    t->scale = scale;
    t->first = first;
    t->n_now = n;
    if (t->directions.n) hf_directions_points(&t->directions, first, n, t->point);
    hf_built_batch_run(t->batch, t->varies, first, n, make_sample, take_sample, t);
    hf_parallel_each(hf_built_batch_threads(t->batch), (n + AT_ONCE - 1) / AT_ONCE, predict, t);
    for (int k = 0; k < t->n_load_case; k++) {
        loaded_samples loaded = {t, &t->load_case[k]};
        const hf_built_loaded *net = &loaded.load_case->net;
        if (net->has_shape)
            hf_built_batch_run(net->batch, hf_built_loaded_vary(net, &t->errors), first, n, make_loaded, take_loaded,
                               &loaded);
        for (long i = first; !net->has_shape && i < first + n; i++)
            count_slack(t, NULL, row_of(t, i));
    }
    if (t->required) find_margins(t, n);
    if (hf_built_must_stop(t->built)) return HF_INTERRUPTED;
    return t->has_no_memory ? HF_NO_MEMORY : HF_OK;
}

/* ---- the scale ---- */

/* Computes whether each row has its share of the first n samples at this scale. The last samples are not solved when
 * they cannot change the answer. */
static hf_status reaches_shares(hf_montecarlo *t, long n, double scale, bool *reaches)
{
    const hf_required *q = t->required;
    long met[HF_REQUIREMENT_ROWS_MAX] = {0};
    *reaches = false;
    if (t->tell) t->tell(t->tell_context, scale);
    for (long first = 0; first < n; first += t->n_chunk) {
        int count = n - first < t->n_chunk ? (int)(n - first) : t->n_chunk;
        bool is_lost = false;
        HF_TRY(hf_montecarlo_run(t, scale, first, count));
        *reaches = true;
        for (int k = 0; k < q->n_share; k++) {
            double needed = q->row[q->share[k]].share * (double)n * (1 - 1e-12);
            for (int i = 0; i < count; i++)
                met[k] += t->row[(size_t)i * (size_t)t->n_value + hf_montecarlo_margin_at(k)] >= 0;
            *reaches &= (double)met[k] >= needed;
            is_lost |= (double)(n - (first + count - met[k])) < needed;
        }
        if (*reaches || is_lost) break;
    }
    return HF_OK;
}

/* Sets the result when all tried scales reach the shares, or none does. In the latter case the net without errors shows
 * whether any scale can. */
static hf_status judge_end(hf_montecarlo *t, bool goes_up, double *scale, int *bound)
{
    bool reaches = true;
    if (!goes_up) HF_TRY(reaches_shares(t, 1, 0, &reaches));
    *bound = goes_up ? 1 : reaches ? -1 : 0;
    if (!reaches) *scale = 0;
    return HF_OK;
}

/* Bisects the logarithm of the scale. It doubles or halves the scale up to 10 times, but not beyond
 * hf_built_errors_largest_scale. It then halves the interval 7 times, to a factor of 2^(1/128). */
static hf_status find_scale(hf_montecarlo *t, int n, double *scale, int *bound)
{
    double largest = fmin(ldexp(1, HF_SCALE_DOUBLINGS), fmax(1, hf_built_errors_largest_scale(&t->errors)));
    double at = 1, before = 1;
    bool reaches;
    *bound = 0;
    HF_TRY(reaches_shares(t, n, at, &reaches));
    bool goes_up = reaches;
    while (reaches == goes_up && (goes_up ? at < largest : at > ldexp(1, -HF_SCALE_DOUBLINGS))) {
        before = at;
        at = goes_up ? fmin(2 * at, largest) : at / 2;
        HF_TRY(reaches_shares(t, n, at, &reaches));
    }
    *scale = at;
    if (reaches == goes_up) return judge_end(t, goes_up, scale, bound);
    double good = goes_up ? before : at, bad = goes_up ? at : before;
    for (int k = 0; k < HF_SCALE_HALVINGS; k++) {
        double middle = sqrt(good * bad);
        HF_TRY(reaches_shares(t, n, middle, &reaches));
        *(reaches ? &good : &bad) = middle;
    }
    *scale = good;
    return HF_OK;
}

/* Finds the scale, and measures the surface at ambient only if a requirement needs it. */
hf_status hf_montecarlo_find_scale(hf_montecarlo *t, int n, double *scale, int *bound)
{
    t->skips_surface = !hf_required_needs_surface(t->required, true, 0);
    hf_status status = find_scale(t, n, scale, bound);
    t->skips_surface = false;
    return status;
}
