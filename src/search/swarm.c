/* Makes the plan and the lanes of the paper's iteration, and runs it for many designs, eight at a time. swarm.h
 * describes the interface, swarm_kernel.c has the loops.
 *
 *     model -> incidences of each node -> skyline and tiles of D -> plan (shared)
 *     plan  -> lanes of a thread -> put a design into a lane -> kernels -> get the shape of a lane
 *
 *     load     force densities, targets and supports of a design into a lane
 *     look     solve for the positions of all lanes; lengths, errors, next force densities; residual or psi
 *     settle   converged: store the result; no shape: its status, or hf_evaluate; otherwise one more iteration
 *     step     the next force densities become the present ones                                (Eqs. 7, 8)
 *
 * Contents: plan - lanes - one lane in and out - the run */
#include "search/swarm.h"

#include "solve/equilibrium.h"
#include "solve/loose.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static const hf_swarm_kernels *const kernels_of_isa[] = {HF_LANE_EACH(&hf_swarm_kernels)};

/* ---- plan ---- */

/* Lists the cables at each free node, by a counting sort. incidence_start[row] first counts the cables of the row, then
 * is where they end, and while the list is filled from its end falls to where they begin. */
static void list_incidences(hf_swarm_plan *p)
{
    const hf_model *m = p->model;
    int *start = p->incidence_start;
    for (int k = 0; k < 2 * m->n_cable; k++)
        if (m->end_row[k] < m->n_free) start[m->end_row[k]]++;
    for (int row = 0; row < m->n_free; row++)
        start[row + 1] += start[row];
    for (int k = 2 * m->n_cable - 1; k >= 0; k--) {
        int row = m->end_row[k], other = m->end_row[k ^ 1];
        if (row < m->n_free) p->incidence[--start[row]] = (hf_swarm_incidence){k / 2, p->n_pad + other};
    }
}

/* Returns the lane rows of cable e, the lower one first. Returns false if one of its ends is a support. */
static bool is_between_free_nodes(const hf_swarm_plan *p, int e, int *low, int *high)
{
    const hf_model *m = p->model;
    int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    *low = p->n_pad + (a < b ? a : b);
    *high = p->n_pad + (a < b ? b : a);
    return *high < p->n_pad + m->n_free;
}

/* Finds the tiles of each block row. The factor may have an entry in every column from the first entry of D in the row
 * on, so storage begins there. */
static void find_skyline(hf_swarm_plan *p)
{
    int low, high;
    for (int i = 0; i < p->n_block; i++)
        p->first_column[i] = i * HF_SWARM_BLOCK;
    for (int e = 0; e < p->model->n_cable; e++) {
        if (!is_between_free_nodes(p, e, &low, &high)) continue;
        int *first = &p->first_column[high / HF_SWARM_BLOCK];
        if (low < *first) *first = low;
    }
    for (int i = 0; i < p->n_block; i++) {
        size_t first = (size_t)(p->first_column[i] / HF_SWARM_BLOCK);
        p->tile_0[i] = p->n_tile - first; /* never negative: each earlier block row has at least one tile */
        p->n_tile += (size_t)i - first + 1;
        p->has_entry[p->n_tile - 1] = 1; /* the diagonal tile has entries */
    }
    for (int e = 0; e < p->model->n_cable; e++)
        if (is_between_free_nodes(p, e, &low, &high))
            p->has_entry[p->tile_0[high / HF_SWARM_BLOCK] + (size_t)(low / HF_SWARM_BLOCK)] = 1;
}

hf_status hf_swarm_plan_create(const hf_model *m, hf_lane_isa isa, hf_swarm_plan *to)
{
    assert(m->n_free > 0 && !m->has_strut && hf_lane_has_isa(isa));
    int n_block = (m->n_free + HF_SWARM_BLOCK - 1) / HF_SWARM_BLOCK;
    size_t n_widest = ((size_t)m->half_bandwidth + HF_SWARM_BLOCK - 1) / HF_SWARM_BLOCK + 1;
    *to = (hf_swarm_plan){
        .model = m, .kernels = kernels_of_isa[isa], .n_pad = n_block * HF_SWARM_BLOCK - m->n_free, .n_block = n_block};
    HF_TRY(HF_ARENA_ARRAYS(&to->block, HF_SWARM_PLAN_FIELDS(HF_ARENA_ITEM)));
    list_incidences(to);
    find_skyline(to);
    for (int e = 0; e < m->n_cable; e++)
        to->inverse_length[e] = 1 / m->length_m[e];
    return HF_OK;
}

/* ---- lanes ---- */

static void lay_out_lanes(hf_arena *arena, const hf_swarm_plan *plan, hf_swarm_lanes *to)
{
    const hf_model *m = plan->model;
    HF_SWARM_FIELDS(HF_ARENA_TAKE)
}

size_t hf_swarm_lanes_bytes(const hf_swarm_plan *plan)
{
    hf_arena arena = {0};
    hf_swarm_lanes lanes;
    lay_out_lanes(&arena, plan, &lanes);
    return arena.used;
}

hf_status hf_swarm_lanes_create(const hf_swarm_plan *plan, hf_swarm_lanes *lanes)
{
    *lanes = (hf_swarm_lanes){0};
    return HF_ARENA_MAKE(&lanes->arena, lay_out_lanes(&lanes->arena, plan, lanes));
}

/* ---- one lane in and out ---- */

void hf_swarm_put(const hf_swarm_plan *plan, const hf_workspace *from, int lane, hf_swarm_lanes *w)
{
    const hf_model *m = plan->model;
    for (int e = 0; e < m->n_cable; e++) {
        w->q_N_per_m[e * HF_LANES + lane] = from->q_N_per_m[e];
        w->target[e * HF_LANES + lane] = from->target[e];
    }
    double *x = w->position_m + plan->n_pad * 3 * HF_LANES + lane;
    for (int i = m->n_free; i < m->n_node; i++)
        for (int c = 0; c < 3; c++)
            x[(3 * i + c) * HF_LANES] = from->position_m[c * m->n_node + i];
}

void hf_swarm_get(const hf_swarm_plan *plan, const hf_swarm_lanes *w, int lane, hf_workspace *to)
{
    const hf_model *m = plan->model;
    for (int e = 0; e < m->n_cable; e++) {
        to->q_N_per_m[e] = w->q_N_per_m[e * HF_LANES + lane];
        to->length_m[e] = w->length_m[e * HF_LANES + lane];
        to->tension_N[e] = to->q_N_per_m[e] * to->length_m[e];
    }
    const double *x = w->position_m + plan->n_pad * 3 * HF_LANES + lane;
    for (int i = 0; i < m->n_node; i++)
        for (int c = 0; c < 3; c++)
            to->position_m[c * m->n_node + i] = x[(3 * i + c) * HF_LANES];
}

void hf_swarm_update(hf_swarm_lanes *lanes)
{
    double *q = lanes->q_N_per_m;
    lanes->q_N_per_m = lanes->next_q_N_per_m;
    lanes->next_q_N_per_m = q;
}

/* ---- the run ---- */

/* One call of hf_swarm_run, with the state of its lanes. */
typedef struct {
    const hf_evaluator *v;
    const hf_swarm_plan *plan;
    hf_swarm_lanes *lanes;
    hf_workspace *w;
    const double *design;
    hf_form_result *result;
    hf_stop_rule stop;
    int iterations[HF_LANES];
    double psi_before_m[HF_LANES]; /* NaN in the first iteration */
    hf_swarm_measures now;
} swarm;

static void load(void *solver, int lane, int i_design)
{
    swarm *s = solver;
    const hf_model *m = s->v->model;
    hf_evaluate_prepare(s->v, s->design + (size_t)i_design * (size_t)m->n_variable, s->w);
    /* hf_swarm_put reads the positions of the supports only. */
    memcpy(s->w->position_m, m->position_m, 3 * (size_t)m->n_node * sizeof(double));
    hf_swarm_put(s->plan, s->w, lane, s->lanes);
    s->iterations[lane] = 0;
    s->psi_before_m[lane] = (double)NAN;
}

static void look(void *solver)
{
    swarm *s = solver;
    s->plan->kernels->solve(s->plan, s->lanes);
    s->plan->kernels->measure(s->plan, s->lanes, &s->now);
    if (s->stop == HF_STOP_RMS_CHANGE)
        s->plan->kernels->psi(s->plan, s->lanes, &s->now);
    else
        s->plan->kernels->residual(s->plan, s->lanes, &s->now);
}

/* Returns HF_OK, or the reason why there is no shape in this lane. */
static hf_status health(const swarm *s, const hf_swarm_measures *now, int lane)
{
    if (s->lanes->bad_row[lane] >= 0) return HF_SINGULAR;
    if (!now->is_finite[lane]) return HF_NOT_FINITE;
    if (now->shortest_of_law[HF_LAW_TENSION][lane] < s->v->form->collapse_ratio) return HF_COLLAPSED;
    if (now->shortest_of_law[HF_LAW_FORCE_DENSITY][lane] < HF_FORM_GONE) return HF_COLLAPSED;
    return now->longest_length_ratio[lane] > HF_FORM_BLOWN_UP ? HF_SINGULAR : HF_OK;
}

/* Returns the reason for which the iteration of this lane ends, or HF_STOPPED_NONE. */
static hf_stop_reason stop_reason(swarm *s, const hf_swarm_measures *now, int lane)
{
    const hf_form_settings *form = s->v->form;
    if (s->stop == HF_STOP_RMS_CHANGE) {
        double change_m = fabs(now->psi_m[lane] - s->psi_before_m[lane]);
        s->psi_before_m[lane] = now->psi_m[lane];
        if (change_m < form->rms_tolerance_m) return HF_STOPPED_RMS_CHANGE;
    } else if (now->residual_N[lane] <= form->residual_tolerance * s->v->model->reference_N &&
               now->tension_error[lane] <= form->residual_tolerance &&
               now->length_gap[lane] <= form->length_tolerance) {
        return HF_STOPPED_CONVERGED;
    }
    return s->iterations[lane] < form->max_iterations ? HF_STOPPED_NONE : HF_STOPPED_MAX_ITERATIONS;
}

/* Counts the iteration of this lane. If it was the last one, stores the result and returns true. */
static bool settle(void *solver, int lane, int i_design)
{
    swarm *s = solver;
    hf_form_result *r = s->result + i_design;
    const double *design = s->design + (size_t)i_design * (size_t)s->v->model->n_variable;
    s->iterations[lane]++;
    hf_status status = health(s, &s->now, lane);
    hf_stop_reason reason = status == HF_OK ? stop_reason(s, &s->now, lane) : HF_STOPPED_ILL_POSED;
    if (reason == HF_STOPPED_NONE) return false;
    if (status == HF_OK) {
        hf_evaluate_prepare(s->v, design, s->w);
        hf_swarm_get(s->plan, s->lanes, lane, s->w);
        hf_form_accept(s->v->model, s->v->form, reason, s->iterations[lane], s->w, r);
        if (s->stop == HF_STOP_RESIDUAL) hf_equilibrium_judge_open(s->v->model, s->v->form, s->w, r);
        hf_loose_refuse(s->v->model, s->v->form, s->w, r);
    } else if (s->v->model->has_newton) { /* hf_evaluate finds out whether the net has a shape all the same */
        hf_evaluate(s->v, design, s->w, NULL, r);
        return true;
    } else {
        hf_form_refuse(status, s->iterations[lane], r);
    }
    hf_evaluate_judge(s->v, s->w, NULL, r);
    return true;
}

static void step(void *solver)
{
    swarm *s = solver;
    hf_swarm_update(s->lanes);
}

void hf_swarm_run(const hf_evaluator *evaluator, const hf_swarm_plan *plan, hf_swarm_lanes *lanes, hf_workspace *w,
                  hf_lane_next *next, void *context, const double *design, hf_form_result *r)
{
    static const hf_lane_solver work = {load, look, settle, step};
    swarm s = {.v = evaluator,
               .plan = plan,
               .lanes = lanes,
               .w = w,
               .design = design,
               .result = r,
               .stop = evaluator->rule == HF_RULE_SEEDED ? HF_STOP_RMS_CHANGE : HF_STOP_RESIDUAL};
    hf_evaluate_prepare(evaluator, design, w);
    memcpy(lanes->law, w->law, (size_t)evaluator->model->n_cable); /* all designs have the same laws */
    hf_lane_schedule_run(&work, &s, next, context);
}
