/* Contents: choice of the method - one shape, alone or with a truss - one design */
#include <hifdm/evaluate.h>

#include "solve/certificate.h"
#include "solve/coupling.h"
#include "solve/equilibrium.h"
#include "solve/loose.h"
#include <hifdm/metrics.h>

#include <math.h>

/* ---- choice of the method ---- */

hf_method hf_evaluate_method(const hf_model *m, const hf_form_settings *s, const char **why)
{
    const char *reason = "asked for";
    hf_method method = s->method == HF_METHOD_NEWTON ? HF_METHOD_NEWTON : HF_METHOD_HIFDM;
    if (s->method == HF_METHOD_AUTO) {
        method = m->has_newton && s->stop == HF_STOP_RESIDUAL ? HF_METHOD_NEWTON : HF_METHOD_HIFDM;
        reason = method == HF_METHOD_NEWTON ? "every potential is convex: quadratic convergence"
                                            : "stop: rms_change is a rule for it";
    }
    if (!m->has_newton && method == HF_METHOD_NEWTON) method = HF_METHOD_HIFDM;
    if (!m->has_newton)
        reason = m->has_strut ? "struts: the energy is not convex" : "force densities are given: one solve";
    if (why) *why = reason;
    return method;
}

/* ---- one shape, alone or with a truss ---- */

typedef struct {
    const hf_model *m;
    const hf_form_settings *form;
    bool by_newton;
    hf_stop_rule stop; /* of the paper's iteration */
} net_problem;

static hf_status find_alone(const void *context, hf_workspace *w, hf_history *history, hf_form_result *r)
{
    const net_problem *p = context;
    if (p->by_newton) return hf_equilibrium_find(p->m, p->form, w, history, r);
    return hf_equilibrium_find_by_paper(p->m, p->form, p->stop, w, history, r);
}

/* Finds the shape from the workspace's first force densities. Under the paper's rule the place of the stop depends on
 * the start, so all iterations of the coupling then share one start. */
static hf_status find_net(const net_problem *p, hf_workspace *w, hf_history *history, hf_form_result *r)
{
    if (!p->m->n_attachment) return find_alone(p, w, history, r);
    hf_coupling_settings s = p->form->coupling;
    if (p->by_newton && s.scheme == HF_COUPLING_AUTO)
        return hf_coupling_find_either_way(p->m, &s, find_alone, p, w, history, r);
    if (s.scheme == HF_COUPLING_AUTO) s.scheme = HF_COUPLING_ACCELERATED;
    bool start_counts = !p->by_newton && p->stop == HF_STOP_RMS_CHANGE;
    return hf_coupling_find(p->m, &s, find_alone, p, start_counts, w, history, r);
}

hf_status hf_evaluate_form(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_history *history,
                           hf_form_result *r)
{
    net_problem problem = {m, s, hf_evaluate_method(m, s, NULL) == HF_METHOD_NEWTON, s->stop};
    hf_form_prepare(m, w);
    find_net(&problem, w, history, r);
    hf_loose_settle(m, s, w, r);
    hf_certify(m, w, r);
    return r->status;
}

/* ---- one design ---- */

double hf_evaluate_design_length_m(const hf_model *m, int i_cable)
{
    return hf_law_has(m->law[i_cable], HF_LAW_IS_RIGID) ? m->target[i_cable] : m->length_m[i_cable];
}

double hf_evaluate_design_target(const hf_evaluator *v, int i_cable, double tension_N)
{
    if (v->rule != HF_RULE_FORCE_DENSITY) return tension_N;
    return tension_N / hf_evaluate_design_length_m(v->model, i_cable);
}

/* Sets law, target and first force density of boundary cable e from its design tension (METHOD section 7). */
static void apply_rule(const hf_evaluator *v, int e, double tension_N, hf_workspace *w)
{
    w->q_N_per_m[e] = tension_N / hf_evaluate_design_length_m(v->model, e);
    switch (v->rule) {
    case HF_RULE_FORCE_DENSITY:
        w->law[e] = HF_LAW_FORCE_DENSITY;
        w->target[e] = hf_evaluate_design_target(v, e, tension_N);
        break;
    case HF_RULE_TENSION:
        w->law[e] = HF_LAW_TENSION;
        w->target[e] = hf_evaluate_design_target(v, e, tension_N);
        break;
    default: /* seeded: the law of the case, with the force density set above as its start */
        break;
    }
}

void hf_evaluate_prepare(const hf_evaluator *v, const double *design_N, hf_workspace *w)
{
    const hf_model *m = v->model;
    hf_form_prepare(m, w);
    /* A convex problem has one answer, so a start near it changes nothing but the time. The answer under rule seeded
     * depends on the start, so it keeps that of the model, as in the paper. */
    for (int e = 0; e < m->n_cable && v->rule != HF_RULE_SEEDED; e++)
        if (hf_law_has(m->law[e], HF_LAW_ITERATES))
            w->q_N_per_m[e] = fmax(v->start_q_N_per_m[e], HF_LAW_LEAST_Q_N_PER_M);
    for (int k = 0; k < m->n_gene; k++)
        apply_rule(v, m->gene_cable[k], design_N[k], w);
}

bool hf_evaluate_is_above_cap(const hf_evaluator *v, const hf_form_result *r)
{
    return r->status == HF_OK && r->boundary_tension_ratio > v->boundary_ratio_cap;
}

/* By how much tensions would have to change for the cap, cable by cable: a smaller sum is nearer to the cap also where
 * several cables share the largest or the smallest tension, so that no single one of them changes the ratio. */
static double violation(const hf_evaluator *v, const hf_workspace *w)
{
    const hf_model *m = v->model;
    double low = INFINITY, high = 0, sum = 0, cap = v->boundary_ratio_cap, slack_N = HF_SLACK_RATIO * m->reference_N;
    for (int e = 0; e < m->n_cable; e++) {
        if (m->group[e] != HF_GROUP_BOUNDARY) continue;
        low = fmin(low, w->tension_N[e]);
        high = fmax(high, w->tension_N[e]);
    }
    double least = sqrt(fmax(low, slack_N) * high / cap), most = cap * least;
    for (int e = 0; e < m->n_cable; e++) {
        double tension = w->tension_N[e];
        if (m->group[e] != HF_GROUP_BOUNDARY) continue;
        if (tension < least) sum += 1 - tension / least;
        if (tension > most) sum += 1 - most / tension;
    }
    return sum;
}

hf_status hf_evaluate_judge(const hf_evaluator *v, const hf_workspace *w, hf_form_result *r)
{
    r->violation = r->status == HF_OK ? 0 : (double)NAN;
    if (hf_evaluate_is_above_cap(v, r)) {
        r->status = HF_RATIO_CAP;
        r->violation = violation(v, w);
    }
    if (r->status != HF_OK) r->psi_m = (double)NAN;
    if (r->status != HF_OK && r->status != HF_RATIO_CAP)
        r->inner_tension_ratio = r->boundary_tension_ratio = (double)NAN;
    return r->status;
}

hf_status hf_evaluate(const hf_evaluator *v, const double *design_N, hf_workspace *w, hf_form_result *r)
{
    bool seeded = v->rule == HF_RULE_SEEDED;
    net_problem problem = {v->model, v->form, !seeded && v->solver != HF_SOLVER_FIXED_POINT && v->model->has_newton,
                           seeded ? HF_STOP_RMS_CHANGE : HF_STOP_RESIDUAL};
    hf_evaluate_prepare(v, design_N, w);
    find_net(&problem, w, NULL, r);
    hf_loose_refuse(v->model, v->form, w, r);
    return hf_evaluate_judge(v, w, r);
}
