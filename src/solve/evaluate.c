/* Evaluates the case itself or a design.
 *
 *     case: laws and first q of the model        design: laws and first q by its variables
 *         |                                          |
 *         +--------------------+---------------------+
 *                              v
 *     one shape: Newton (equilibrium.c) or the paper's iteration, on a truss by the coupling (coupling.c)
 *         |                                          |
 *         v                                          v
 *     positions for loose nodes, certificate     refusal of loose nodes, cap and limits, objectives */
#include <hifdm/evaluate.h>

#include "solve/certificate.h"
#include "solve/coupling.h"
#include "solve/equilibrium.h"
#include "solve/limits.h"
#include "solve/loose.h"

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
    hf_stop_rule stop; /* stopping rule of the paper's iteration */
} net_problem;

static hf_status find_alone(const void *context, hf_workspace *w, hf_history *history, hf_form_result *r)
{
    const net_problem *p = context;
    if (p->by_newton) return hf_equilibrium_find(p->m, p->form, w, history, r);
    return hf_equilibrium_find_by_paper(p->m, p->form, p->stop, w, history, r);
}

/* Finds the shape from the workspace's first force densities. Under the paper's rule the point at which the iteration
 * stops depends on the start. All iterations of the coupling then share one start. Returns r->status. */
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

hf_status hf_evaluate_prepared(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_history *history,
                               hf_form_result *r)
{
    net_problem problem = {m, s, hf_evaluate_method(m, s, NULL) == HF_METHOD_NEWTON, s->stop};
    find_net(&problem, w, history, r);
    hf_loose_settle(m, s, w, r);
    return r->status;
}

hf_status hf_evaluate_form(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_history *history,
                           hf_form_result *r)
{
    hf_form_prepare(m, w);
    hf_evaluate_prepared(m, s, w, history, r);
    hf_certify(m, w, r);
    return r->status;
}

/* ---- one design ---- */

double hf_evaluate_design_length_m(const hf_model *m, int i_cable)
{
    return hf_law_has(m->law[i_cable], HF_LAW_IS_RIGID) ? m->target[i_cable] : m->length_m[i_cable];
}

hf_variable_sets hf_evaluate_sets(const hf_evaluator *v, int k)
{
    hf_vary vary = hf_model_vary(v->model, k);
    if (vary == HF_VARY_PRETENSION && v->rule == HF_RULE_SEEDED) return HF_SETS_START;
    if (vary == HF_VARY_PRETENSION) vary = v->rule == HF_RULE_TENSION ? HF_VARY_TENSION : HF_VARY_FORCE_DENSITY;
    if (vary == HF_VARY_TENSION) return v->by_density && !v->model->links_tensions ? HF_SETS_DENSITY : HF_SETS_TENSION;
    if (vary == HF_VARY_FORCE_DENSITY) return HF_SETS_DENSITY;
    if (vary == HF_VARY_LENGTH) return HF_SETS_LENGTH;
    return vary == HF_VARY_UNSTRESSED_LENGTH ? HF_SETS_CUT : HF_SETS_SUPPORT;
}

double hf_evaluate_divisor(const hf_evaluator *v, int k)
{
    if (hf_model_vary(v->model, k) == HF_VARY_FORCE_DENSITY) return 1;
    return hf_evaluate_design_length_m(v->model, v->model->variable_cable[k]);
}

/* Sets law, target and first force density of a cable from the value of design variable k, or the displacement of a
 * support (METHOD section 7). */
static void apply_variable(const hf_evaluator *v, int k, double value, hf_workspace *w)
{
    const hf_model *m = v->model;
    int e = m->variable_cable[k];
    hf_variable_sets sets = hf_evaluate_sets(v, k);
    if (sets == HF_SETS_SUPPORT) {
        for (int c = 0; c < 3; c++)
            w->support_displacement_m[c * m->n_node + m->variable[k].support_row] +=
                value * m->variable[k].direction[c];
        return;
    }
    if (sets == HF_SETS_START || sets == HF_SETS_TENSION || sets == HF_SETS_DENSITY)
        w->q_N_per_m[e] = value / hf_evaluate_divisor(v, k);
    if (sets == HF_SETS_TENSION) w->law[e] = HF_LAW_TENSION;
    if (sets == HF_SETS_DENSITY) w->law[e] = HF_LAW_FORCE_DENSITY;
    if (sets == HF_SETS_LENGTH) w->law[e] = HF_LAW_LENGTH;
    /* HF_SETS_START keeps the law of the case, with this force density as its start. */
    if (sets != HF_SETS_START) w->target[e] = sets == HF_SETS_DENSITY ? w->q_N_per_m[e] : value;
}

static bool is_above_cap(const hf_evaluator *v, const hf_form_result *r)
{
    return r->status == HF_OK && r->boundary_tension_ratio > v->boundary_ratio_cap;
}

bool hf_evaluate_needs_shape(const hf_evaluator *v, const hf_form_result *r)
{
    return is_above_cap(v, r) || v->limits || v->objectives;
}

void hf_evaluate_prepare(const hf_evaluator *v, const double *design, hf_workspace *w)
{
    const hf_model *m = v->model;
    hf_form_prepare(m, w);
    /* A convex problem has one answer, so a start near it saves time and changes nothing else. Under rule seeded the
     * answer depends on the start, so the start is that of the model, as in the paper. */
    for (int e = 0; e < m->n_cable && hf_evaluate_is_unique(v); e++)
        if (hf_law_has(m->law[e], HF_LAW_ITERATES)) w->q_N_per_m[e] = fmax(v->start_q_N_per_m[e], HF_LAW_MIN_Q_N_PER_M);
    for (int k = 0; k < m->n_variable; k++)
        apply_variable(v, k, design[k], w);
}

/* Measures the constraints by requirements, and adds their violation. The refinement measures their smooth form and
 * keeps its steps within them itself. */
static hf_status judge_constraints(const hf_evaluator *v, const hf_workspace *w, hf_objectives_point *point,
                                   hf_form_result *r)
{
    const hf_constraints *c = v->objectives ? v->objectives->constraints : NULL;
    if (!c) return HF_OK;
    HF_TRY(c->measure(point->constraints, w, v->by_density, point->constraint));
    for (int k = 0; k < c->n && !v->by_density; k++)
        if (hf_objectives_judges(v->objectives, k)) r->violation += fmax(0, point->constraint[k]) / c->unit[k];
    return HF_OK;
}

hf_status hf_evaluate_judge(const hf_evaluator *v, const hf_workspace *w, hf_objectives_point *point, hf_form_result *r)
{
    bool has_shape = r->status == HF_OK, breaks_cap = is_above_cap(v, r);
    r->violation = has_shape ? 0 : (double)NAN;
    if (has_shape && (v->limits || breaks_cap)) r->violation = hf_limits_violation(v, w);
    if (has_shape && judge_constraints(v, w, point, r) != HF_OK) r->status = HF_NO_MEMORY;
    if (has_shape && r->violation > 0) r->status = HF_OUT_OF_LIMITS;
    if (breaks_cap) r->status = HF_RATIO_CAP;
    if (has_shape && v->objectives && /* feasible or not */
        hf_objectives_measure(v->objectives, w, point, r->objective, &r->merit) != HF_OK)
        r->status = HF_NO_MEMORY;
    if (!v->objectives) r->merit = r->psi_m;
    if (v->objectives && r->status == HF_OK && !isfinite(r->merit)) { /* an objective has no value for this shape */
        r->status = HF_NOT_FINITE;
        r->violation = (double)NAN;
    }
    if (r->status != HF_OK) r->psi_m = r->merit = (double)NAN;
    if (!hf_status_has_shape(r->status)) r->inner_tension_ratio = r->boundary_tension_ratio = (double)NAN;
    return r->status;
}

bool hf_evaluate_is_unique(const hf_evaluator *v)
{
    return v->rule != HF_RULE_SEEDED || v->model->variable;
}

hf_status hf_evaluate(const hf_evaluator *v, const double *design, hf_workspace *w, hf_objectives_point *point,
                      hf_form_result *r)
{
    bool seeded = !hf_evaluate_is_unique(v);
    net_problem problem = {v->model, v->form, !seeded && v->solver != HF_SOLVER_FIXED_POINT && v->model->has_newton,
                           seeded ? HF_STOP_RMS_CHANGE : HF_STOP_RESIDUAL};
    hf_evaluate_prepare(v, design, w);
    find_net(&problem, w, NULL, r);
    hf_loose_refuse(v->model, v->form, w, r);
    return hf_evaluate_judge(v, w, point, r);
}
