/* Runs the paper's iteration for many designs, eight at a time. swarm.h describes the interface, swarm_lane.h one
 * iteration.
 *
 *     load     force densities, targets and supports of a design into a lane
 *     look     solve for the positions of all lanes; lengths, errors, next force densities; residual or psi
 *     settle   converged: store the result; no shape: its status, or hf_evaluate; otherwise one more iteration
 *     step     the next force densities become the present ones                                (Eqs. 7, 8) */
#include "search/swarm.h"

#include "solve/equilibrium.h"
#include "solve/loose.h"

#include <math.h>
#include <string.h>

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
    hf_swarm_solve(s->plan, s->lanes);
    hf_swarm_measure(s->plan, s->lanes, &s->now);
    if (s->stop == HF_STOP_RMS_CHANGE)
        hf_swarm_psi(s->plan, s->lanes, &s->now);
    else
        hf_swarm_residual(s->plan, s->lanes, &s->now);
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
        hf_evaluate(s->v, design, s->w, r);
        return true;
    } else {
        hf_form_refuse(status, s->iterations[lane], r);
    }
    hf_evaluate_judge(s->v, s->w, r);
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
