#include "search/swarm.h"

#include <math.h>
#include <string.h>

/* One run, and where its lanes are. */
typedef struct {
    const hf_evaluator *v;
    const hf_lane_plan *plan;
    hf_lane_workspace *lanes;
    hf_workspace *w;
    const double *design_N;
    hf_form_result *result;
    int stop;             /* hf_stop_rule */
    int design[HF_LANES]; /* -1 = empty */
    int iterations[HF_LANES];
    double psi_before_m[HF_LANES]; /* NaN at the first iteration */
} swarm;

static void load(swarm *s, int lane, int i_design)
{
    const hf_model *m = s->v->model;
    hf_evaluate_prepare(s->v, s->design_N + (size_t)i_design * (size_t)m->n_gene, s->w);
    memcpy(s->w->position_m, m->position_m, 3 * (size_t)m->n_node * sizeof(double)); /* the support rows count */
    hf_lane_put(s->plan, s->w, lane, s->lanes);
    s->design[lane] = i_design;
    s->iterations[lane] = 0;
    s->psi_before_m[lane] = (double)NAN;
}

/* HF_OK, or why there is no shape in this lane. */
static hf_status health(const swarm *s, const hf_lane_measures *now, int lane)
{
    if (s->lanes->bad_row[lane] >= 0) return HF_SINGULAR;
    if (!now->is_finite[lane]) return HF_NOT_FINITE;
    if (now->shortest_of_law[HF_LAW_TENSION][lane] < s->v->form->collapse_ratio) return HF_COLLAPSED;
    if (now->shortest_of_law[HF_LAW_FORCE_DENSITY][lane] < HF_FORM_GONE) return HF_COLLAPSED;
    return now->longest_length_ratio[lane] > HF_FORM_BLOWN_UP ? HF_SINGULAR : HF_OK;
}

static hf_stop_reason stop_reason(swarm *s, const hf_lane_measures *now, int lane)
{
    const hf_form_settings *form = s->v->form;
    if (s->stop == HF_STOP_RMS_CHANGE) {
        double change_m = fabs(now->psi_m[lane] - s->psi_before_m[lane]);
        s->psi_before_m[lane] = now->psi_m[lane];
        if (change_m < form->rms_tolerance_m) return HF_STOPPED_RMS_CHANGE;
    } else if (now->residual_N[lane] <= form->residual_tolerance * s->v->model->reference_N &&
               now->tension_error[lane] <= form->residual_tolerance &&
               now->length_gap[lane] <= form->length_tolerance) {
        return HF_STOPPED_RESIDUAL;
    }
    return s->iterations[lane] < form->max_iterations ? HF_STOPPED_NONE : HF_STOPPED_MAX_ITERATIONS;
}

/* One more shape in this lane: store its result when it is the last. Returns 1 when the lane has become free. */
static int settle(swarm *s, const hf_lane_measures *now, int lane)
{
    hf_form_result *r = s->result + s->design[lane];
    s->iterations[lane]++;
    hf_status status = health(s, now, lane);
    hf_stop_reason reason = status == HF_OK ? stop_reason(s, now, lane) : HF_STOPPED_ILL_POSED;
    if (reason == HF_STOPPED_NONE) return 0;
    if (status == HF_OK) {
        const double *design_N = s->design_N + (size_t)s->design[lane] * (size_t)s->v->model->n_gene;
        hf_evaluate_prepare(s->v, design_N, s->w);
        hf_lane_get(s->plan, s->lanes, lane, s->w);
        hf_form_accept(s->v->model, s->v->form, reason, s->iterations[lane], s->w, r);
    } else {
        hf_form_refuse(status, s->iterations[lane], r);
    }
    hf_evaluate_judge(s->v, r);
    s->design[lane] = -1;
    return 1;
}

void hf_swarm_run(const hf_evaluator *evaluator, const hf_lane_plan *plan, hf_lane_workspace *lanes,
                  hf_workspace *workspace, int (*next)(void *context), void *context, const double *design_N,
                  hf_form_result *result)
{
    swarm s = {evaluator, plan, lanes, workspace, design_N, result, HF_STOP_RESIDUAL, {0}, {0}, {0}};
    if (evaluator->rule == HF_RULE_SEEDED) s.stop = HF_STOP_RMS_CHANGE;
    hf_lane_measures now;
    int n_busy = 0, more = 1;
    for (int lane = 0; lane < HF_LANES; lane++) {
        load(&s, lane, 0); /* an empty lane works on something harmless */
        s.design[lane] = -1;
    }
    memcpy(lanes->law, workspace->law, (size_t)evaluator->model->n_cable); /* the same for all designs */
    for (;;) {
        for (int lane = 0; lane < HF_LANES && more; lane++) {
            if (s.design[lane] >= 0) continue;
            int i = next(context);
            more = i >= 0;
            if (!more) break;
            load(&s, lane, i);
            n_busy++;
        }
        if (n_busy == 0) return;
        hf_lane_solve(plan, lanes);
        hf_lane_measure(plan, lanes, &now);
        if (s.stop == HF_STOP_RMS_CHANGE)
            hf_lane_psi(plan, lanes, &now);
        else
            hf_lane_residual(plan, lanes, &now);
        for (int lane = 0; lane < HF_LANES; lane++)
            if (s.design[lane] >= 0) n_busy -= settle(&s, &now, lane);
        hf_lane_update(lanes);
    }
}
