/* Explains a form-finding to the user, with the names of cables, nodes and chains.
 *
 *     result and shape
 *         | a shape: warnings about balance, chains, loose and slack parts
 *         | none: an error with the culprit and a remedy
 *         v
 *     messages */
#include "run/problem_explain.h"

#include <hifdm/metrics.h>

#include <math.h>
#include <stdio.h>

#define NAMED_MAX 5 /* maximum number of names in a message */

/* ---- names ---- */

typedef struct {
    char text[1600];
    size_t length;
    int n;
} name_list;

static void add_name(name_list *list, const char *name)
{
    if (list->n++ >= NAMED_MAX || list->length >= sizeof list->text) return;
    list->length += (size_t)snprintf(list->text + list->length, sizeof list->text - list->length, "%s%s",
                                     list->n > 1 ? ", " : "", name);
}

static const char *close_names(name_list *list)
{
    if (list->n > NAMED_MAX && list->length < sizeof list->text)
        snprintf(list->text + list->length, sizeof list->text - list->length, " and %d more", list->n - NAMED_MAX);
    return list->text;
}

static void name_loaded_chains(const hf_problem *p, hf_workspace *w, name_list *list)
{
    const hf_model *m = &p->model;
    for (int i = 0; i < hf_form_n_chain(m); i++) {
        char name[256];
        if (!hf_form_chain_is_loaded(m, w, i)) continue;
        hf_model_chain_name(m, &p->scene, i, name, sizeof name);
        add_name(list, name);
    }
}

#define NODE_SIZE 2048

/* Writes "n (cables a, b)": the node of a row and the cables at it. Returns text. */
static const char *name_node(const hf_problem *p, int row, char text[NODE_SIZE])
{
    const hf_model *m = &p->model;
    name_list around = {0};
    for (int k = 0; k < 2 * m->n_cable; k++)
        if (m->end_row[k] == row) add_name(&around, p->scene.cable_id[k / 2]);
    snprintf(text, NODE_SIZE, "%s (cables %s)", p->scene.node_id[m->node_of_row[row]], close_names(&around));
    return text;
}

static void name_loose(const hf_problem *p, const char *stage, const hf_workspace *w, const hf_form_result *r,
                       hf_messages *messages)
{
    name_list loose = {0};
    char name[NODE_SIZE];
    for (int i = 0; r->n_loose && i < p->model.n_free; i++)
        if (w->loose[i]) add_name(&loose, name_node(p, i, name));
    if (r->n_loose)
        hf_warning(messages,
                   "no taut cable holds these nodes of the %s shape, %d: %s. They are put where their cables allow, as "
                   "close to their target positions as possible, and psi leaves them out",
                   stage, r->n_loose, close_names(&loose));
    if (r->n_drifting)
        hf_warning(messages,
                   "the equilibrium is not unique: %d free node%s no stiffness, mainly %s, so the position error is "
                   "unknown. Give a cable there another law, or support the node",
                   r->n_drifting, r->n_drifting == 1 ? " has" : "s have", name_node(p, r->culprit, name));
}

/* ---- warnings ---- */

/* Returns true if the shape is in balance with the multipliers of elastic cables, but not with the tensions of their
 * laws. The difference must be larger than OFF_BY_LAW times the tolerance, and the length errors larger than
 * rounding. */
#define OFF_BY_LAW 10.0
#define ROUNDED_LENGTH 1e-13
static bool is_off_by_law(const hf_problem *p, const hf_form_result *r)
{
    double allowed_N = p->settings.form.residual_tolerance * p->model.reference_N;
    return p->model.EA_N && r->residual_N > OFF_BY_LAW * allowed_N && r->length_error > ROUNDED_LENGTH;
}

void hf_problem_warn(const hf_problem *p, const char *stage, hf_workspace *w, const hf_form_result *r,
                     hf_messages *messages)
{
    const hf_model *m = &p->model;
    name_list chains = {0}, slack = {0};
    if (r->stop_reason == HF_STOPPED_RMS_CHANGE && r->residual_N > p->settings.form.residual_tolerance * m->reference_N)
        hf_warning(
            messages,
            "stop: rms_change ended before equilibrium of the %s shape: nodal residual %.2e N, relative error of cable "
            "lengths up to %.2e; use stop: residual to iterate to equilibrium",
            stage, r->residual_N, r->length_error);
    if (r->stop_reason == HF_STOPPED_CONVERGED && is_off_by_law(p, r))
        hf_warning(
            messages,
            "by the laws of the elastic cables, forces of up to %.2e N are out of balance, although the residual "
            "of the iteration is within form.residual_tolerance: the relative error of lengths is up to %.2e; "
            "lower form.length_tolerance%s",
            r->residual_N, r->length_error,
            hf_evaluate_method(m, &p->settings.form, NULL) == HF_METHOD_NEWTON ? "" : ", or use form.method: newton");
    if (r->n_loaded_chain) {
        name_loaded_chains(p, w, &chains);
        hf_warning(messages,
                   "%d straight chains of length-controlled cables carry lateral load, which no finite tension can "
                   "balance, so "
                   "the boundary tensions depend on where the iteration stopped: %s",
                   r->n_loaded_chain, close_names(&chains));
    }
    name_loose(p, stage, w, r, messages);
    for (int e = 0; r->n_slack && e < m->n_cable; e++)
        if (hf_metrics_is_slack(m, w, e)) add_name(&slack, p->scene.cable_id[e]);
    if (r->n_slack) hf_warning(messages, "slack in the %s shape, %d: %s", stage, r->n_slack, close_names(&slack));
}

/* ---- errors ---- */

/* Returns the cable under law tension or length with the maximum relative deviation from its law. */
static int furthest_off(const hf_problem *p)
{
    const hf_workspace *w = &p->workspace;
    int worst = 0;
    double most = -1;
    for (int e = 0; e < p->model.n_cable; e++) {
        double off = 0;
        if (hf_law_has(w->law[e], HF_LAW_GIVES_TENSION)) off = fabs(w->tension_N[e] / w->target[e] - 1);
        if (hf_law_has(w->law[e], HF_LAW_IS_RIGID) &&
            !(w->length_m[e] < w->target[e] && hf_metrics_is_slack(&p->model, w, e)))
            off = fabs(w->length_m[e] / w->target[e] - 1);
        if (off > most) most = off, worst = e;
    }
    return worst;
}

#define MOVE_SIZE 96

/* Writes how far an attachment still moved in the last step, and the ratio to the step before if it is known. Returns
 * text. */
static const char *name_move(const hf_coupling_result *c, char text[MOVE_SIZE])
{
    if (!isfinite(c->step_m)) return "without bound";
    int n = snprintf(text, MOVE_SIZE, "by %.2e m", c->step_m);
    if (isfinite(c->ratio)) snprintf(text + n, MOVE_SIZE - (size_t)n, ", %g times the previous step", c->ratio);
    return text;
}

static hf_status explain_not_converged(const hf_problem *p, const hf_form_result *r, hf_messages *messages)
{
    const hf_workspace *w = &p->workspace;
    char move[MOVE_SIZE];
    if (r->coupling.stop_reason == HF_COUPLING_MAX_ITERATIONS)
        return hf_error(
            messages, r->status,
            "the coupling of net and truss did not converge in %d form-findings: an attachment still moves %s; raise "
            "coupling.max_iterations or coupling.tof_m, or lower form.%s, which limits the accuracy of the forces",
            r->coupling.iterations, name_move(&r->coupling, move),
            r->stop_reason == HF_STOPPED_RMS_CHANGE ? "rms_tolerance_m" : "residual_tolerance");
    if (r->culprit >= 0 && r->n_drifting == 0) /* a cable; with drifting nodes it is a row */
        return hf_error(messages, r->status,
                        "form-finding is as accurate as double precision allows (nodal residual %.2e N): cable '%s' is "
                        "%.2e m long at %.2e N, which is too short or too tight for its coordinates; move the origin "
                        "closer to it, join its nodes or raise the tolerances",
                        r->residual_N, p->scene.cable_id[r->culprit], w->length_m[r->culprit],
                        w->tension_N[r->culprit]);
    int e = furthest_off(p);
    return hf_error(
        messages, r->status,
        "form-finding did not converge in %d iteration%s: nodal residual %.2e N, relative error of cable lengths up to "
        "%.2e; cable '%s' is farthest from its law, at %g N and %g m; raise form.max_iterations or the tolerances",
        r->iterations, r->iterations == 1 ? "" : "s", r->residual_N, r->length_error, p->scene.cable_id[e],
        w->tension_N[e], w->length_m[e]);
}

/* Returns advice on how to reduce the pull of the net. */
static const char *name_pull(const hf_problem *p)
{
    const hf_scene *s = &p->scene;
    bool has_tension = false;
    for (int e = 0; e < s->n_cable; e++) {
        bool is_tension = hf_law_has(s->law[e], HF_LAW_GIVES_TENSION);
        if (is_tension && isnan(s->target[e])) return "lower form.pretension_N";
        has_tension |= is_tension || s->law[e] == HF_LAW_FORCE_DENSITY;
    }
    return has_tension ? "lower the values of the cables that hold a tension or a force density"
                       : "give the cables longer values";
}

/* Reports a truss that is too soft. The loop of net and truss diverges, or they have no shape together although the net
 * alone has one. Returns r->status. */
static hf_status explain_too_soft(const hf_problem *p, const hf_form_result *r, hf_messages *messages)
{
    const hf_coupling_result *c = &r->coupling;
    const hf_form_settings *form = &p->settings.form;
    const char *stiffen =
        p->settings.has_truss_import ? "E_Pa and sections of its members" : "truss.E_Pa and its tubes";
    char move[MOVE_SIZE];
    if (form->coupling.scheme == HF_COUPLING_AUTO && hf_evaluate_method(&p->model, form, NULL) == HF_METHOD_NEWTON)
        return hf_error(messages, r->status,
                        "the truss is too soft for its net: together they have no shape; stiffen the truss (%s) or %s",
                        stiffen, name_pull(p));
    const char *other = p->model.has_newton
                            ? ", or solve both in one matrix: coupling.scheme: auto, form.method: newton"
                        : form->coupling.scheme == HF_COUPLING_PLAIN ? ", or try coupling.scheme: accelerated"
                                                                     : "";
    return hf_error(messages, r->status,
                    "the truss is too soft for the coupling with its net: after %d form-findings an attachment still "
                    "moves %s; stiffen the truss (%s), %s%s",
                    c->iterations, name_move(c, move), stiffen, name_pull(p), other);
}

static hf_status explain_chains(const hf_problem *p, hf_workspace *w, const hf_form_result *r, hf_messages *messages)
{
    name_list chains = {0};
    char name[256];
    double sum_m, span_m;
    if (hf_form_chain_is_short(&p->model, w, r->culprit, &sum_m, &span_m)) {
        hf_model_chain_name(&p->model, &p->scene, r->culprit, name, sizeof name);
        return hf_error(
            messages, r->status,
            "ill-posed: the lengths of %s add up to %.10g m, but their supports are %.10g m apart, so there is "
            "no shape. Give the cables longer L*, or another law",
            name, sum_m, span_m);
    }
    name_loaded_chains(p, w, &chains);
    return hf_error(messages, r->status,
                    "ill-posed: %d straight chains of length-controlled cables carry lateral load, which no finite "
                    "tension can balance: %s. Give them a sag (scene.parabolic_cylinder.scallop, longer L*) or another "
                    "law, or support their nodes",
                    r->n_loaded_chain, close_names(&chains));
}

hf_status hf_problem_explain(hf_problem *p, hf_messages *messages)
{
    const hf_form_result *r = &p->form;
    hf_workspace *w = &p->workspace;
    char node[NODE_SIZE] = "?";
    switch (r->status) {
    case HF_OK:
        hf_problem_warn(p, "form-finding", w, r, messages);
        return HF_OK;
    case HF_NOT_CONVERGED:
        hf_problem_warn(p, "form-finding", w, r, messages);
        return explain_not_converged(p, r, messages);
    case HF_INTERRUPTED:
        return r->status;
    case HF_TRUSS_TOO_SOFT:
        return explain_too_soft(p, r, messages);
    case HF_STRAIGHT_CHAIN:
        return explain_chains(p, w, r, messages);
    case HF_COLLAPSED:
        return hf_error(
            messages, r->status,
            "ill-posed: the net collapses at cable '%s', whose length fell below %g of its length at the target "
            "positions: check the tensions, lengths and supports near it",
            p->scene.cable_id[r->culprit], p->settings.form.collapse_ratio);
    case HF_NOT_FINITE:
        if (r->culprit < 0) return hf_error(messages, r->status, "ill-posed: a tension is no longer a finite number");
        return hf_error(messages, r->status, "ill-posed: the tension of cable '%s' is no longer a finite number",
                        p->scene.cable_id[r->culprit]);
    default:
        if (r->culprit >= 0) name_node(p, r->culprit, node);
        return hf_error(messages, r->status,
                        "ill-posed: the force density matrix is singular or not positive definite at node %s: its "
                        "cables are slack, "
                        "cannot balance its load, or do not lead to a support",
                        node);
    }
}
