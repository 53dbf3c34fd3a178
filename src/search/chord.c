/* Takes Newton steps that share one matrix, for eight designs at a time. chord.h describes the interface,
 * chord_kernel.c the inner loops.
 *
 *     initial design -> hf_evaluate -> Newton matrix H0, factored and packed once for all threads
 *
 *     load     a design into a lane, at the initial shape
 *     look     forces f of the net, gap F f - r of the truss
 *     settle   converged: measure and store the result; too slow: hf_evaluate; otherwise one more step
 *     step     r <- r + (I + F S)^-1 (F f - r),  x <- x + H0^-1 f                                    (M9)
 *
 * Contents: shared matrix - lanes - steps of a lane - the run */
#include "search/chord.h"

#include "solve/coupling.h"
#include "solve/newton_matrix.h"
#include "solve/schur.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stddef.h>
#include <string.h>

/* These constants decide how long a lane works on a design before hf_evaluate solves the design alone. Both ways reach
 * the same shape within the tolerance. No test of search (unit and property) fails with STEPS_MAX 20 and 180,
 * PATIENCE 1 and 10, CONTRACTION 0.3 and 0.95, MODES_LEFT 0.005 and 0.5. */
#define STEPS_MAX 60
#define PATIENCE 3      /* steps before CONTRACTION is required */
#define MODES_LEFT 0.05 /* tolerance of the truncated inverse of I + F S (hf_schur_modes) */
#define CONTRACTION 0.7 /* after PATIENCE steps, a step must reduce the residual to less than this part */

static const hf_chord_kernels *const kernels_of_isa[] = {HF_LANE_EACH(&hf_chord_kernels)};

/* ---- shared matrix ---- */

static bool is_between_supports(const hf_model *m, int e)
{
    return m->end_row[2 * e] >= m->n_free && m->end_row[2 * e + 1] >= m->n_free;
}

static bool is_served(const hf_model *m, int e)
{
    return hf_law_is_served(m->law[e], HF_CHORD_LAWS);
}

bool hf_chord_applies(const hf_evaluator *v)
{
    const hf_model *m = v->model;
    if (!m->has_newton || m->n_variable == 0 || m->by_lapack) return false;
    for (int k = 0; k < m->n_variable; k++) {
        hf_variable_sets sets = hf_evaluate_sets(v, k);
        if (sets != HF_SETS_TENSION && sets != HF_SETS_DENSITY) return false;
    }
    int n_other = 0; /* cables whose laws the kernels do not support */
    for (int e = 0; e < m->n_cable; e++)
        n_other += !is_served(m, e);
    for (int k = 0; k < m->n_variable; k++) /* a design replaces the law of a cable that it varies */
        n_other -= !is_served(m, m->variable_cable[k]);
    for (int e = 0; e < m->n_cable; e++) /* a cable between two supports pulls on no free node */
        n_other -= !is_served(m, e) && is_between_supports(m, e);
    for (int k = 0; k < m->n_tie; k++) /* a cable between supports counts if it pulls on the truss */
        n_other += !is_served(m, m->tie[k] / 2) && is_between_supports(m, m->tie[k] / 2);
    return n_other == 0;
}

static void lay_out(hf_arena *arena, hf_chord *to)
{
    const hf_model *m = to->evaluator->model;
    size_t n_pull = (size_t)to->n_pull;
    hf_packed_band_lay_out(arena, &to->matrix);
    HF_CHORD_FIELDS(HF_ARENA_TAKE)
}

/* Returns a shared matrix with its sizes, without memory. */
static hf_chord dimensions(const hf_evaluator *v)
{
    int n_pull = 3 * v->model->n_attachment;
    return (hf_chord){.evaluator = v,
                      .matrix = hf_newton_matrix_packed(v->model),
                      .n_pull = n_pull,
                      .n_pull_pad = (n_pull + HF_CHORD_ROWS - 1) / HF_CHORD_ROWS * HF_CHORD_ROWS};
}

/* Packs (I + F S)^-1 [n_pull][n_pull] by blocks of rows; padding rows stay zero. */
static void pack_inverse(const hf_schur *schur, double *inverse)
{
    size_t n = (size_t)schur->n;
    for (size_t j = 0; j < n; j++) {
        memset(schur->column, 0, n * sizeof *schur->column);
        schur->column[j] = 1;
        hf_schur_solve(schur, schur->column);
        for (size_t i = 0; i < n; i++)
            inverse[(i / HF_CHORD_ROWS * n + j) * HF_CHORD_ROWS + i % HF_CHORD_ROWS] = schur->column[i];
    }
}

/* Packs the flexibility of the truss, the stiffness of the cables at attachments, and (I + F S)^-1 or its modes. The
 * workspace holds the initial shape and its factored Newton matrix. Returns HF_OK, HF_NO_MEMORY or HF_SINGULAR. */
static hf_status pack_truss(const hf_model *m, hf_workspace *w, double *inverse, hf_chord *c)
{
    size_t n = (size_t)c->n_pull;
    hf_schur schur;
    for (size_t i = 0; i < n; i++) /* padding rows stay zero */
        for (size_t j = 0; j < n; j++)
            c->flexibility[(i / HF_CHORD_ROWS * n + j) * HF_CHORD_ROWS + i % HF_CHORD_ROWS] =
                m->flexibility_m_per_N[i * n + j];
    for (int k = 0; k < m->n_tie; k++) {
        double block[3][3];
        hf_newton_matrix_block(m, w, m->tie[k] / 2, block);
        memcpy(c->tie_block + 9 * k, block, sizeof block);
    }
    memcpy(c->base_displacement_m, w->displacement_m, n * sizeof(double));
    hf_status status = hf_schur_create(m, &schur);
    if (status == HF_OK) status = hf_schur_factor(m, w, hf_newton_matrix_block, &schur);
    if (status == HF_OK && inverse) pack_inverse(&schur, inverse);
    if (status == HF_OK && !inverse) c->n_mode = hf_schur_modes(&schur, MODES_LEFT, HF_CHORD_MODES_MAX, c->mode);
    hf_arena_free(&schur.arena);
    return status;
}

/* Lists for each cable its design variable, the row of its force density in `variable`, and whether its tension is
 * given. */
static void list_cables(const hf_evaluator *v, hf_chord *c)
{
    const hf_model *m = v->model;
    for (int e = 0; e < m->n_cable; e++)
        c->variable_of_cable[e] = -1;
    for (int k = 0; k < m->n_variable; k++) {
        c->variable_of_cable[m->variable_cable[k]] = k;
        c->variable_divisor[k] = hf_evaluate_sets(v, k) == HF_SETS_TENSION ? 1 : hf_evaluate_divisor(v, k);
    }
    c->serves_all = true;
    for (int e = 0; e < m->n_cable; e++) {
        int k = c->variable_of_cable[e];
        bool gives_tension = k >= 0 && hf_evaluate_sets(v, k) == HF_SETS_TENSION;
        c->inverse_length[e] = 1 / m->length_m[e];
        c->slot_of_cable[e] = k >= 0 && !gives_tension ? k : m->n_variable + e;
        c->is_pulled[e] = k >= 0 ? gives_tension : hf_law_has(m->law[e], HF_LAW_GIVES_TENSION);
        if (c->is_pulled[e]) c->pulled[c->n_pulled++] = e;
        if (k < 0 && !is_served(m, e)) c->serves_all = false;
    }
}

/* Lists the cables at each free node and attachment, by a counting sort. incidence_start[i] first counts the cables of
 * node i, then is where they end, and while the list is filled from its end falls to where they begin. */
static void list_incidences(const hf_model *m, hf_chord *c)
{
    int *start = c->incidence_start, *place_of_row = c->place_of_row;
    for (int row = 0; row < m->n_node; row++)
        place_of_row[row] = row < m->n_free ? row : -1;
    for (int i = 0; i < m->n_attachment; i++)
        place_of_row[m->attachment_row[i]] = m->n_free + i;
    for (int k = 0; k < 2 * m->n_cable; k++)
        if (place_of_row[m->end_row[k]] >= 0) start[place_of_row[m->end_row[k]]]++;
    for (int i = 0; i < m->n_free + m->n_attachment; i++)
        start[i + 1] += start[i];
    for (int k = 2 * m->n_cable - 1; k >= 0; k--) {
        int place = place_of_row[m->end_row[k]];
        if (place >= 0) c->incidence[--start[place]] = (hf_chord_incidence){c->slot_of_cable[k / 2], m->end_row[k ^ 1]};
    }
}

hf_status hf_chord_create_here(const hf_evaluator *v, hf_workspace *w, double *inverse, hf_chord *chord)
{
    const hf_model *m = v->model;
    *chord = dimensions(v);
    HF_TRY(hf_newton_matrix_factor(m, w, NULL));
    HF_TRY(HF_ARENA_MAKE(&chord->arena, lay_out(&chord->arena, chord)));
    chord->kernels = kernels_of_isa[hf_lane_best_isa()];
    hf_packed_band_pack(&chord->matrix, w->newton_band);
    memcpy(chord->base_m, w->position_m, 3 * (size_t)m->n_node * sizeof(double));
    list_cables(v, chord);
    list_incidences(m, chord);
    return chord->n_pull ? pack_truss(m, w, inverse, chord) : HF_OK;
}

hf_status hf_chord_create(const hf_evaluator *v, const double *initial, hf_workspace *w, hf_objectives_point *point,
                          hf_chord *chord)
{
    hf_form_result base;
    *chord = (hf_chord){0};
    hf_status status = hf_evaluate(v, initial, w, point, &base);
    if (!hf_status_has_shape(status)) return status; /* a design that only breaks a limit has a shape, too */
    return hf_chord_create_here(v, w, NULL, chord);
}

/* ---- lanes ---- */

static void lay_out_lanes(hf_arena *arena, const hf_chord *c, hf_chord_lanes *to)
{
    const hf_model *m = c->evaluator->model;
    HF_CHORD_LANES_FIELDS(HF_ARENA_TAKE)
}

size_t hf_chord_bytes(const hf_evaluator *evaluator, size_t *lanes_bytes)
{
    hf_chord chord = dimensions(evaluator);
    hf_chord_lanes lanes;
    hf_arena shared = {0}, own = {0};
    lay_out(&shared, &chord);
    lay_out_lanes(&own, &chord, &lanes);
    *lanes_bytes = own.used;
    return shared.used;
}

hf_status hf_chord_lanes_create(const hf_chord *chord, hf_chord_lanes *lanes)
{
    *lanes = (hf_chord_lanes){0};
    HF_TRY(HF_ARENA_MAKE(&lanes->arena, lay_out_lanes(&lanes->arena, chord, lanes)));
    const hf_model *m = chord->evaluator->model;
    double *q_N_per_m = lanes->variable + (size_t)m->n_variable * HF_LANES;
    for (size_t i = 0; i < 3 * (size_t)m->n_node * HF_LANES; i++)
        lanes->x_m[i] = chord->base_m[i / HF_LANES];
    /* The target of law force_density is the force density. The kernels overwrite those of cables with a given
     * tension. */
    for (size_t i = 0; i < (size_t)m->n_cable * HF_LANES; i++)
        q_N_per_m[i] = m->target[i / HF_LANES];
    return HF_OK;
}

/* ---- steps of a lane ---- */

void hf_chord_begin(const hf_chord *c, const hf_chord_lanes *l, int lane, hf_chord_progress *p)
{
    for (int i = 0; i < c->n_pull; i++)
        l->displacement_m[i * HF_LANES + lane] = c->base_displacement_m[i];
    p->steps[lane] = 0;
    p->excess_before_N[lane] = INFINITY;
}

void hf_chord_look(const hf_chord *c, const hf_chord_lanes *l, hf_chord_progress *p)
{
    double squared[HF_LANES], gap_squared[HF_LANES] = {0}, reference_N = c->evaluator->model->reference_N;
    const hf_form_settings *form = c->evaluator->form;
    double scale = c->n_pull ? form->residual_tolerance * reference_N / form->coupling.tof_m : 0;
    p->is_measured = false;
    c->kernels->forces(c, l, squared);
    if (c->n_pull) c->kernels->couple(c, l, gap_squared);
    for (int lane = 0; lane < HF_LANES; lane++) {
        p->residual_N[lane] = p->excess_N[lane] = reference_N * sqrt(squared[lane]);
        p->gap_m[lane] = sqrt(gap_squared[lane]);
        double gap_N = scale * p->gap_m[lane];
        if (c->n_pull && !(gap_N <= p->excess_N[lane])) p->excess_N[lane] = gap_N; /* a gap that is NaN is kept */
    }
}

bool hf_chord_goes_on(int lane, int patience, hf_chord_progress *p)
{
    double excess_N = p->excess_N[lane];
    bool contracts = p->steps[lane] < patience || excess_N < CONTRACTION * p->excess_before_N[lane];
    if (!contracts || !isfinite(excess_N) || p->steps[lane] >= STEPS_MAX) return false;
    p->excess_before_N[lane] = excess_N;
    p->steps[lane]++;
    return true;
}

static double tension_ratio(const hf_chord_measures *now, hf_group group, int lane)
{
    double high_N = now->highest_N[group][lane];
    return high_N > 0 ? high_N / now->lowest_N[group][lane] : (double)NAN;
}

void hf_chord_report(const hf_chord *c, const hf_chord_lanes *l, int lane, hf_chord_progress *p, hf_form_result *r)
{
    const hf_chord_measures *now = &p->now;
    if (!p->is_measured) c->kernels->measure(c, l, &p->now);
    p->is_measured = true;
    *r = (hf_form_result){.status = HF_OK, .stop_reason = HF_STOPPED_CONVERGED, .culprit = -1};
    hf_result_blank(r);
    r->psi_m = c->evaluator->model->n_inner_node ? now->psi_m[lane] : (double)NAN;
    r->residual_N = p->residual_N[lane];
    r->tension_error = now->tension_error[lane];
    r->length_error = 0;
    r->inner_tension_ratio = tension_ratio(now, HF_GROUP_INNER, lane);
    r->boundary_tension_ratio = tension_ratio(now, HF_GROUP_BOUNDARY, lane);
    r->shortest_length_ratio = fmin(now->shortest_pulled[lane], now->shortest_other[lane]);
    r->iterations = p->steps[lane];
}

/* ---- the run ---- */

/* One call of hf_chord_run, with the state of its lanes. */
typedef struct {
    const hf_chord *chord;
    hf_chord_lanes *lanes;
    hf_workspace *w;
    hf_objectives_point *point;
    bool keeps_shape;
    const double *design;
    hf_form_result *result;
    hf_chord_progress progress;
} chord_run;

/* Begins with a design in a lane, at the initial shape. Fixed supports keep the positions that hf_chord_lanes_create
 * wrote. */
static void load(void *solver, int lane, int i_design)
{
    chord_run *s = solver;
    const hf_chord *c = s->chord;
    const hf_model *m = c->evaluator->model;
    const double *design = s->design + (size_t)i_design * (size_t)m->n_variable;
    const hf_chord_lanes *l = s->lanes;
    for (int d = 0; d < 3; d++) {
        double *x = l->x_m + (ptrdiff_t)d * m->n_node * HF_LANES + lane;
        const double *base = c->base_m + (ptrdiff_t)d * m->n_node;
        for (int i = 0; i < m->n_free; i++)
            x[(ptrdiff_t)i * HF_LANES] = base[i];
        for (int i = 0; i < m->n_attachment; i++)
            x[(ptrdiff_t)m->attachment_row[i] * HF_LANES] = base[m->attachment_row[i]];
    }
    for (int k = 0; k < m->n_variable; k++)
        l->variable[k * HF_LANES + lane] = design[k] / c->variable_divisor[k];
    hf_chord_begin(c, l, lane, &s->progress);
}

/* Copies the shape of the lane into the workspace. The scalar code measures it there and writes the result. */
static void unload(const chord_run *s, int lane, const double *design, hf_form_result *r)
{
    const hf_chord *c = s->chord;
    const hf_chord_lanes *l = s->lanes;
    const hf_model *m = c->evaluator->model;
    hf_workspace *w = s->w;
    hf_evaluate_prepare(c->evaluator, design, w);
    for (int i = 0; i < 3 * m->n_node; i++)
        w->position_m[i] = l->x_m[i * HF_LANES + lane];
    hf_form_measure(m, c->evaluator->form, w, r);
}

/* Returns true if the figures that the kernel measured are those of the result. Otherwise a cable is slack, or the
 * shape has a fault that the scalar code must identify. */
static bool is_ordinary(const chord_run *s, int lane)
{
    const hf_chord_measures *now = &s->progress.now;
    double slack_N = HF_SLACK_RATIO * s->chord->evaluator->model->reference_N;
    return s->chord->serves_all && now->shortest_pulled[lane] >= s->chord->evaluator->form->collapse_ratio &&
           now->shortest_other[lane] >= HF_FORM_GONE && now->longest[lane] <= HF_FORM_BLOWN_UP &&
           now->lowest_N[HF_GROUP_INNER][lane] >= slack_N && now->lowest_N[HF_GROUP_BOUNDARY][lane] >= slack_N;
}

/* Stores the result of a lane that has converged. The kernel measures all lanes at once. If the shape is not ordinary,
 * the scalar code measures it again. */
static void finish(chord_run *s, int lane, const double *design, hf_form_result *r)
{
    const hf_chord *c = s->chord;
    hf_chord_report(c, s->lanes, lane, &s->progress, r);
    bool ordinary = is_ordinary(s, lane);
    hf_form_result alone = *r;
    if (s->keeps_shape || !ordinary || hf_evaluate_needs_shape(c->evaluator, r)) unload(s, lane, design, &alone);
    if (!ordinary) *r = alone;
    r->iterations = s->progress.steps[lane];
    for (int i = 0; i < c->n_pull; i++)
        s->w->displacement_m[i] = s->lanes->displacement_m[i * HF_LANES + lane];
    if (c->n_pull) hf_coupling_accept(c->evaluator->model, s->w, r->iterations, s->progress.gap_m[lane], r);
    hf_evaluate_judge(c->evaluator, s->w, s->point, r);
}

static void look(void *solver)
{
    chord_run *s = solver;
    hf_chord_look(s->chord, s->lanes, &s->progress);
}

/* Stores the result of a lane that has converged, and returns true. Returns false if the lane takes another step,
 * because its residual falls fast enough. Otherwise hf_evaluate solves the design, and the function returns true. */
static bool settle(void *solver, int lane, int i_design)
{
    chord_run *s = solver;
    const hf_evaluator *v = s->chord->evaluator;
    const double *design = s->design + (size_t)i_design * (size_t)v->model->n_variable;
    if (s->progress.excess_N[lane] <= v->form->residual_tolerance * v->model->reference_N) {
        finish(s, lane, design, s->result + i_design);
        return true;
    }
    if (hf_chord_goes_on(lane, PATIENCE, &s->progress)) return false;
    hf_evaluate(v, design, s->w, s->point, s->result + i_design);
    return true;
}

/* Advances all lanes by one Newton step: first the attachments, then the free nodes. */
static void step(void *solver)
{
    chord_run *s = solver;
    const hf_chord_kernels *k = s->chord->kernels;
    if (s->chord->n_pull) k->move(s->chord, s->lanes);
    s->chord->matrix.solve(&s->chord->matrix, s->lanes->force_N);
    k->step(s->chord, s->lanes);
}

void hf_chord_run(const hf_chord *chord, hf_chord_lanes *lanes, hf_workspace *w, hf_objectives_point *point,
                  hf_lane_next *next, void *context, bool keeps_shape, const double *design, hf_form_result *r)
{
    static const hf_lane_solver work = {load, look, settle, step};
    chord_run s = {.chord = chord,
                   .lanes = lanes,
                   .w = w,
                   .point = point,
                   .keeps_shape = keeps_shape,
                   .design = design,
                   .result = r};
    hf_lane_schedule_run(&work, &s, next, context);
}
