#include <hifdm/evaluate.h>

#include <math.h>

/* What the design means for boundary cable e (METHOD section 5). */
static void apply_rule(const hf_evaluator *v, int e, double tension_N, hf_workspace *w)
{
    /* L* is the prescribed length where there is one, else the theoretical length */
    const hf_model *m = v->model;
    double length_m = m->law[e] == HF_LAW_LENGTH ? m->target[e] : m->length_m[e];
    w->q_N_per_m[e] = tension_N / length_m;
    switch (v->rule) {
    case HF_RULE_FORCE_DENSITY:
        w->law[e] = HF_LAW_FORCE_DENSITY;
        w->target[e] = w->q_N_per_m[e];
        break;
    case HF_RULE_TENSION:
        w->law[e] = HF_LAW_TENSION;
        w->target[e] = tension_N;
        break;
    default: /* seeded: the law of the case, started from here */
        break;
    }
}

hf_status hf_evaluate(const hf_evaluator *v, const double *design_N, hf_workspace *w, hf_form_result *result)
{
    const hf_model *m = v->model;
    hf_form_prepare(m, w);
    /* a convex problem has one answer: starting near it is free. The seeded rule depends on its start: the paper's. */
    for (int e = 0; e < m->n_cable && v->rule != HF_RULE_SEEDED; e++)
        if (m->law[e] != HF_LAW_FORCE_DENSITY) w->q_N_per_m[e] = v->start_q_N_per_m[e];
    for (int k = 0; k < m->n_gene; k++)
        apply_rule(v, m->gene_cable[k], design_N[k], w);
    int stop = v->rule == HF_RULE_SEEDED ? HF_STOP_RMS_CHANGE : HF_STOP_RESIDUAL;
    hf_form_find(m, v->form, stop, w, NULL, result);
    if (result->status == HF_OK && result->boundary_tension_ratio > v->boundary_ratio_cap)
        result->status = HF_RATIO_CAP;
    if (result->status != HF_OK)
        result->psi_m = result->inner_tension_ratio = result->boundary_tension_ratio = (double)NAN;
    return result->status;
}
