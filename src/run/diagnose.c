/* Implements diagnose.h: messages about a form-finding, variables without effect, searches without a design, and
 * doubts about a result. */
#include "run/diagnose.h"

#include "base/arena.h"
#include "base/random.h"
#include "case/config_fault.h"
#include "net/target_surface.h"
#include "net/variables.h"
#include "run/feasible.h"
#include "run/problem_nets.h"
#include "run/problem_parts.h"
#include "search/refine.h"
#include "search/sensitivity.h"
#include "solve/certificate.h"
#include "solve/limits.h"
#include "solve/prestress.h"
#include <hifdm/batch.h>
#include <hifdm/metrics.h>
#include <hifdm/summary.h>

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- form-finding ---- */

/* Explains a form-finding to the user, with the names of cables, nodes and chains.
 *
 *     result and shape
 *         | a shape: warnings about balance, chains, loose and slack parts
 *         | none: an error with the culprit and a remedy
 *         v
 *     messages */

#define NAMED_MAX 5 /* maximum number of names in a message */

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
                   "no taut cable holds these nodes of the %s shape (%d): %s. hifdm places loose nodes as close to "
                   "their target positions as their cables allow. psi does not include loose nodes",
                   stage, r->n_loose, close_names(&loose));
    if (r->n_drifting)
        hf_warning(messages,
                   "the equilibrium is not unique, because %d free node%s no stiffness, mainly %s. The position error "
                   "is therefore unknown. Assign another law to a cable at this node, or support the node",
                   r->n_drifting, r->n_drifting == 1 ? " has" : "s have", name_node(p, r->culprit, name));
}

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
        hf_warning(messages,
                   "the stopping rule rms_change ended the iteration before equilibrium of the %s shape. The nodal "
                   "residual is %.2e N, and the relative error of cable lengths is up to %.2e. To iterate until "
                   "equilibrium, use form.stop: residual",
                   stage, r->residual_N, r->length_error);
    if (r->stop_reason == HF_STOPPED_CONVERGED && is_off_by_law(p, r))
        hf_warning(messages,
                   "with the laws of the elastic cables, residual forces of up to %.2e N remain, although the residual "
                   "of the iteration is within form.residual_tolerance. The relative error of cable lengths is up to "
                   "%.2e. Lower form.length_tolerance%s",
                   r->residual_N, r->length_error,
                   hf_evaluate_method(m, &p->settings.form, NULL) == HF_METHOD_NEWTON ? ""
                                                                                      : ", or use form.method: newton");
    if (r->n_loaded_chain) {
        name_loaded_chains(p, w, &chains);
        hf_warning(messages,
                   "%d straight chain%s of length-controlled cables carr%s a lateral load that no finite tension can "
                   "balance: %s. The boundary tensions therefore depend on the iteration at which hifdm stopped",
                   r->n_loaded_chain, r->n_loaded_chain == 1 ? "" : "s", r->n_loaded_chain == 1 ? "ies" : "y",
                   close_names(&chains));
    }
    name_loose(p, stage, w, r, messages);
    for (int e = 0; r->n_slack && e < m->n_cable; e++)
        if (hf_metrics_is_slack(m, w, e)) add_name(&slack, p->scene.cable_id[e]);
    if (r->n_slack)
        hf_warning(messages, "these cables of the %s shape are slack (%d): %s", stage, r->n_slack, close_names(&slack));
}

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
            "the coupling of net and truss did not converge in %d form-findings. An attachment still moves %s. Raise "
            "coupling.max_iterations or coupling.tof_m, or lower form.%s, which limits the accuracy of the forces",
            r->coupling.iterations, name_move(&r->coupling, move),
            r->stop_reason == HF_STOPPED_RMS_CHANGE ? "rms_tolerance_m" : "residual_tolerance");
    if (r->culprit >= 0 && r->n_drifting == 0) /* a cable; with drifting nodes it is a row */
        return hf_error(
            messages, r->status,
            "form-finding has reached the limit of double precision at a nodal residual of %.2e N. Cable '%s' with a "
            "length of %.2e m and a tension of %.2e N is too short or too tight for its coordinates. Move the origin "
            "closer to this cable, join the nodes of the cable, or raise the tolerances",
            r->residual_N, p->scene.cable_id[r->culprit], w->length_m[r->culprit], w->tension_N[r->culprit]);
    int e = furthest_off(p);
    return hf_error(messages, r->status,
                    "form-finding did not converge in %d iteration%s. The nodal residual is %.2e N, and the relative "
                    "error of cable lengths is up to %.2e. Cable '%s' deviates most from its law, with a tension of %g "
                    "N and a length of %g m. Raise form.max_iterations or the tolerances",
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
                        "the truss is too soft for its net, so net and truss together have no equilibrium. Stiffen the "
                        "truss (%s) or %s",
                        stiffen, name_pull(p));
    const char *other = p->model.has_newton
                            ? ", or solve both in one matrix: coupling.scheme: auto, form.method: newton"
                        : form->coupling.scheme == HF_COUPLING_PLAIN ? ", or try coupling.scheme: accelerated"
                                                                     : "";
    return hf_error(messages, r->status,
                    "the truss is too soft for the coupling with its net. After %d form-findings, an attachment still "
                    "moves %s. Stiffen the truss (%s), %s%s",
                    c->iterations, name_move(c, move), stiffen, name_pull(p), other);
}

static hf_status explain_chains(const hf_problem *p, hf_workspace *w, const hf_form_result *r, hf_messages *messages)
{
    name_list chains = {0};
    char name[256];
    double sum_m, span_m;
    if (hf_form_chain_is_short(&p->model, w, r->culprit, &sum_m, &span_m)) {
        hf_model_chain_name(&p->model, &p->scene, r->culprit, name, sizeof name);
        return hf_error(messages, r->status,
                        "ill-posed: the lengths of %s add up to %.10g m, but the supports of these cables are %.10g m "
                        "apart. Use a longer length L* or another law for these cables",
                        name, sum_m, span_m);
    }
    name_loaded_chains(p, w, &chains);
    return hf_error(messages, r->status,
                    "ill-posed: %d straight chain%s of length-controlled cables carr%s a lateral load that no finite "
                    "tension can balance: %s. Give these cables a sag (scene.parabolic_cylinder.scallop, longer L*) or "
                    "another law, or support their nodes",
                    r->n_loaded_chain, r->n_loaded_chain == 1 ? "" : "s", r->n_loaded_chain == 1 ? "ies" : "y",
                    close_names(&chains));
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
        return hf_error(messages, r->status,
                        "ill-posed: the net collapses at cable '%s', whose length fell below %g times its length at "
                        "the target positions. Check the tensions, lengths and supports near this cable",
                        p->scene.cable_id[r->culprit], p->settings.form.collapse_ratio);
    case HF_NOT_FINITE:
        if (r->culprit < 0) return hf_error(messages, r->status, "ill-posed: a tension is no longer a finite number");
        return hf_error(messages, r->status, "ill-posed: the tension of cable '%s' is no longer a finite number",
                        p->scene.cable_id[r->culprit]);
    default:
        if (r->culprit >= 0) name_node(p, r->culprit, node);
        return hf_error(messages, r->status,
                        "ill-posed: the force density matrix is singular or not positive definite at node %s. The "
                        "cables of this node are slack, cannot balance its load, or do not lead to a support",
                        node);
    }
}

/* ---- reach of the design variables ---- */

/* Finds objectives, limits and rows of variables that no design variable changes.
 *
 *     initial design, then one beside it, because a derivative may vanish at one point
 *         | exact derivatives of positions and tensions by classes of variables
 *         v
 *     strike out each row that looks at something that a class changes
 *         |
 *         v
 *     remaining rows: warnings, or errors if an objective would be constant
 *
 * A class has variables of one row of optimize.variables, and linked variables are in one class. An objective that some
 * variable changes is therefore changed by some class, except by chance. */

#define ROUNDED 1e-9  /* part of the maximum change that counts as none; prescribed values show up to 1e-12 */
#define BESIDE 0.05   /* distance of the second design, over the range of a variable */
#define FAR_RANGE 3.0 /* a range above this multiple of the maximum value is in doubt */
#define CLASSES 16    /* maximum number of classes; at least one for each row */

/* What no variable has been seen to change, and rows of variables that have been seen to change nothing. Rows that do
 * not exist are false. */
typedef struct {
    bool psi; /* of a case with inner nodes and without objectives */
    bool objective[HF_DESIGN_ROWS_MAX], limit[HF_DESIGN_ROWS_MAX], variable_row[HF_DESIGN_ROWS_MAX];
} unchanged;

typedef struct {
    const hf_problem *p;
    hf_model model; /* the model of the problem with variables linked by class */
    hf_evaluator v; /* the evaluator of the problem for this model, without limits */
    hf_sensitivity slopes;
    hf_workspace w;
    int *leader;             /* [n_variable] first variable of the class */
    double *design;          /* [n_variable] values of the design variables */
    double *move_m, *rate_N; /* [3][n_node], [n_cable] changes by a class */
    double most_m, most_N;   /* maximum changes */
    unchanged now;
    void *block;
} reach;

static int row_of_variable(const hf_model *m, int k)
{
    return m->variable ? m->variable[k].setting : 0;
}

/* Links variables by class. The class of a leading variable is chosen by a hash among the classes of its row. */
static void link_classes(reach *q)
{
    const hf_model *m = &q->p->model;
    int n_row = q->p->settings.optimize.n_variable_row, n = n_row > 1 ? CLASSES / n_row : CLASSES, first[CLASSES];
    for (int i = 0; i < CLASSES; i++)
        first[i] = -1;
    q->model.n_leader = 0;
    for (int k = 0; k < m->n_variable; k++) {
        int leader = m->variable_leader[k];
        int i = row_of_variable(m, leader) * n + (int)(hf_random_mix((uint64_t)leader) % (uint64_t)n);
        if (first[i] < 0) first[i] = k;
        q->leader[k] = first[i];
        q->model.n_leader += first[i] == k;
    }
    q->model.variable_leader = q->leader;
}

static hf_status create_reach(const hf_problem *p, reach *q)
{
    const hf_model *m = &q->model;
    *q = (reach){.p = p, .model = p->model, .v = p->evaluator};
    q->v.model = &q->model;
    q->v.boundary_ratio_cap = INFINITY;
    q->v.limits = NULL;
    q->v.objectives = NULL;
    q->v.n_thread = 1;
    memset(q->now.objective, true, (size_t)p->objectives.n_objective);
    memset(q->now.limit, true, (size_t)p->settings.optimize.n_limit);
    memset(q->now.variable_row, true, (size_t)p->settings.optimize.n_variable_row);
    q->now.psi = p->objectives.n_objective == 0 && p->model.n_inner_node > 0;
    HF_TRY(HF_ARENA_ARRAYS(&q->block, HF_ARRAY(q->leader, m->n_variable), HF_ARRAY(q->design, m->n_variable),
                           HF_ARRAY(q->move_m, 3 * (size_t)m->n_node), HF_ARRAY(q->rate_N, m->n_cable)));
    link_classes(q);
    HF_TRY(hf_workspace_create(&q->model, &q->w));
    return hf_sensitivity_create(&q->v, &q->slopes);
}

static void measure_class(reach *q, int i)
{
    const hf_model *m = &q->model;
    hf_sensitivity_spread(&q->slopes, i, q->move_m, q->rate_N);
    q->most_m = q->most_N = 0;
    for (int k = 0; k < 3 * m->n_node; k++)
        q->most_m = fmax(q->most_m, fabs(q->move_m[k]));
    for (int e = 0; e < m->n_cable; e++)
        q->most_N = fmax(q->most_N, fabs(q->rate_N[e]));
}

static bool moves_row(const reach *q, int row)
{
    bool does = false;
    for (int c = 0; c < 3; c++)
        does |= fabs(q->move_m[c * q->model.n_node + row]) > ROUNDED * q->most_m;
    return does;
}

static bool pulls_otherwise(const reach *q, int e)
{
    return fabs(q->rate_N[e]) > ROUNDED * q->most_N;
}

static bool lengthens(const reach *q, int e)
{
    const hf_model *m = &q->model;
    const int *end = m->end_row + 2 * (ptrdiff_t)e;
    double sum = 0, length = q->w.length_m[e];
    for (int c = 0; c < 3; c++) {
        int at = c * m->n_node;
        sum += (q->w.position_m[at + end[1]] - q->w.position_m[at + end[0]]) / length *
               (q->move_m[at + end[1]] - q->move_m[at + end[0]]);
    }
    return fabs(sum) > ROUNDED * q->most_m;
}

/* Returns true if a class changes one of these n cables or rows of nodes. */
static bool any(const reach *q, int n, const int *at, bool (*changes)(const reach *, int))
{
    for (int i = 0; i < n; i++)
        if (changes(q, at[i])) return true;
    return false;
}

/* What of the net an objective is computed from. */
typedef enum { OF_INNER_NODES, OF_FACETS, OF_TENSIONS, OF_LENGTHS, OF_PULL } source;
static const source source_of[] = {
    [HF_FIGURE_PSI] = OF_INNER_NODES, [HF_FIGURE_SURFACE] = OF_INNER_NODES, [HF_FIGURE_FACETS] = OF_FACETS,
    [HF_FIGURE_GAIN] = OF_FACETS,     [HF_FIGURE_TENSION] = OF_TENSIONS,    [HF_FIGURE_EVENNESS] = OF_TENSIONS,
    [HF_FIGURE_RATIO] = OF_TENSIONS,  [HF_FIGURE_LENGTH] = OF_LENGTHS,      [HF_FIGURE_MASS] = OF_LENGTHS,
    [HF_FIGURE_PULL] = OF_PULL,       [HF_FIGURE_DEFLECTION] = OF_PULL,
};

static bool changes_objective(const reach *q, const hf_objective *g)
{
    const hf_objectives *objectives = &q->p->objectives;
    if (g->n_net) return true; /* another cut changes the tensions and the shape of an as-built net */
    switch (source_of[g->settings.figure]) {
    case OF_INNER_NODES:
        return any(q, q->model.n_inner_node, q->model.inner_row, moves_row);
    case OF_FACETS:
        return any(q, 4 * objectives->n_facet, objectives->corner_row, moves_row);
    case OF_TENSIONS:
        return any(q, g->n_cable, g->cable, pulls_otherwise);
    case OF_LENGTHS:
        return any(q, g->n_cable, g->cable, lengthens);
    case OF_PULL:
        break; /* any change of the shape changes the pull on supports */
    }
    return true;
}

/* Strikes out the rows that the variables change at the design in the workspace. */
static void strike(reach *q)
{
    const hf_optimize_settings *o = &q->p->settings.optimize;
    const int *of_variable = q->slopes.class_of_variable;
    for (int k = 0; k < q->model.n_variable; k++) {
        if (q->leader[k] != k) continue;
        measure_class(q, of_variable[k]);
        if (!(q->most_m > 0) && !(q->most_N > 0)) continue;
        q->now.variable_row[row_of_variable(&q->model, k)] = false;
        if (q->now.psi) q->now.psi = !any(q, q->model.n_inner_node, q->model.inner_row, moves_row);
        for (int i = 0; i < q->p->objectives.n_objective; i++)
            if (q->now.objective[i]) q->now.objective[i] = !changes_objective(q, &q->p->objectives.objective[i]);
        for (int i = 0; i < o->n_limit; i++) {
            const hf_limit *row = &q->p->limits.row[i];
            q->now.limit[i] = q->now.limit[i] && row->kind != HF_LIMIT_DEFLECTION &&
                              !any(q, row->n_cable, row->cable, pulls_otherwise);
        }
    }
}

/* Sets q->design to the initial design, or to one near it without its symmetry. */
static void choose_design(reach *q, bool is_beside)
{
    const hf_problem *p = q->p;
    hf_random random = hf_random_stream(1, 0, 0);
    for (int k = 0; k < q->model.n_variable; k++) {
        double lower, upper, range, base = p->initial[k];
        hf_variables_bound(&p->settings.optimize, &q->model, k, base, &lower, &upper, &range);
        if (q->model.variable_cable[k] >= 0) range = fmin(range, base); /* values of cables stay above zero */
        double part = hf_random_uniform(&random);
        q->design[k] = is_beside && isfinite(range) ? base + BESIDE * (2 * part - 1) * range : base;
    }
}

/* Why an objective of each source is constant. */
static const char *const why_constant[] = {
    [OF_INNER_NODES] = "none of its nodes moves",
    [OF_FACETS] = "none of its nodes moves",
    [OF_TENSIONS] = "all of its cables keep their tensions",
    [OF_LENGTHS] = "all of its cables keep their lengths",
    [OF_PULL] = "the pull on the supports does not change",
};

static hf_status tell_objectives(const reach *q, hf_messages *messages)
{
    const hf_objectives *objectives = &q->p->objectives;
    bool is_front = q->p->settings.optimize.n_front > 0, is_reached = false, has_fault = false;
    char place[HF_LOCATION_SIZE], name[HF_OBJECTIVE_NAME_SIZE];
    for (int i = 0; i < objectives->n_objective; i++)
        is_reached |= !q->now.objective[i];
    for (int i = 0; i < objectives->n_objective; i++) {
        if (!q->now.objective[i]) continue;
        hf_config_place(&q->p->settings, place, "optimize.%s.%d", is_front ? "front" : "objective", i);
        hf_objectives_name(objectives, i, name);
        const char *why = why_constant[source_of[objectives->objective[i].settings.figure]];
        has_fault |= is_front || !is_reached;
        if (is_front || !is_reached)
            hf_error(messages, HF_BAD_CASE,
                     "%s: no design variable of this case changes %s: %s. Add a design variable that changes this "
                     "objective, or remove the objective",
                     place, name, why);
        else
            hf_warning(messages, "%s: no design variable of this case changes %s: %s", place, name, why);
    }
    return has_fault ? HF_BAD_CASE : HF_OK;
}

static hf_status tell_reach(const reach *q, hf_messages *messages)
{
    const hf_optimize_settings *o = &q->p->settings.optimize;
    char place[HF_LOCATION_SIZE];
    for (int i = 0; i < o->n_variable_row; i++)
        if (q->now.variable_row[i])
            hf_warning(messages,
                       "%s: this row has no effect at the initial design, because its cables, or the cables at its "
                       "supports, are slack",
                       hf_config_place(&q->p->settings, place, "optimize.variables.%d", i));
    for (int i = 0; i < o->n_limit; i++)
        if (q->now.limit[i])
            hf_warning(messages, "%s: no design variable of this case changes the limited quantity: %s",
                       hf_config_place(&q->p->settings, place, "optimize.limits.%d", i),
                       why_constant[o->limit[i].figure == HF_LIMIT_DEFLECTION ? OF_PULL : OF_TENSIONS]);
    if (q->p->objectives.n_objective > 0) return tell_objectives(q, messages);
    if (!q->now.psi) return HF_OK;
    return hf_error(
        messages, HF_BAD_CASE,
        "%s: no design variable of this case changes psi: %s. Add a design variable that changes psi, or use another "
        "objective in the list optimize.objective",
        hf_config_place(&q->p->settings, place, o->n_variable_row ? "optimize.variables.0" : "optimize.range_N"),
        why_constant[OF_INNER_NODES]);
}

/* Examines both designs. Returns HF_OK, also if the second one has no shape; HF_NOT_EVALUATED if the first one has
 * none; HF_NO_MEMORY. */
static hf_status look_at_reach(reach *q)
{
    for (int i = 0; i < 2 && (i == 0 || memchr(&q->now, 1, sizeof q->now)); i++) {
        hf_form_result r;
        choose_design(q, i > 0);
        hf_status status = hf_evaluate(&q->v, q->design, &q->w, NULL, &r);
        if (status == HF_OK) status = hf_sensitivity_find(&q->slopes, &q->w);
        if (status == HF_NO_MEMORY) return status;
        if (status == HF_OK) strike(q);
        if (status != HF_OK && i == 0) return HF_NOT_EVALUATED;
    }
    return HF_OK;
}

/* Warns about ranges such as 50 for 50 %: far above the values of a row that has no upper bound. */
static void doubt_ranges(const hf_problem *p, hf_messages *messages)
{
    const hf_model *m = &p->model;
    char place[HF_LOCATION_SIZE];
    for (int i = 0; i < p->settings.optimize.n_variable_row; i++) {
        const hf_variable_settings *row = &p->settings.optimize.variable_row[i];
        double most = 0;
        for (int k = 0; k < m->n_variable; k++)
            if (row_of_variable(m, k) == i && m->variable_cable[k] >= 0) most = fmax(most, fabs(p->initial[k]));
        if (!(most > 0) || !isinf(row->upper) || !(row->range > FAR_RANGE * most)) continue;
        hf_warning(
            messages,
            "%s: the range %g is %.2g times the maximum value of this row, %.3g. For a relative range, write %g %%",
            hf_config_place(&p->settings, place, "optimize.variables.%d.range", i), row->range, row->range / most, most,
            row->range);
    }
}

hf_status hf_reach_check(const hf_problem *p, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    reach q;
    doubt_ranges(p, messages);
    if (!hf_refine_applies(&p->evaluator)) return HF_OK;
    if (!o->n_variable_row && !o->n_limit && !p->objectives.n_objective) return HF_OK;
    hf_status status = create_reach(p, &q);
    if (status == HF_OK) status = look_at_reach(&q);
    if (status == HF_NO_MEMORY) hf_error(messages, status, "out of memory for the derivatives of the objectives");
    if (status == HF_OK) status = tell_reach(&q, messages);
    hf_sensitivity_free(&q.slopes);
    hf_workspace_free(&q.w);
    hf_arena_free_block(q.block);
    return status == HF_NOT_EVALUATED ? HF_OK : status;
}

/* ---- no design ---- */

/* Writes messages that explain why a run has no design: counts of evaluations, the limit that the initial design
 * exceeds most, and the settings to change. */

const char *hf_no_design_cap(const hf_problem *p, double boundary_tension_ratio, char text[HF_NO_DESIGN_HINT_SIZE])
{
    char place[HF_LOCATION_SIZE];
    double cap = p->settings.optimize.boundary_ratio_cap;
    *text = '\0';
    if (!(boundary_tension_ratio > cap)) return text;
    if (hf_config_location(&p->settings, "optimize.boundary_ratio_cap", place, sizeof place)) return text;
    snprintf(
        text, HF_NO_DESIGN_HINT_SIZE,
        "; %g is the default of optimize.boundary_ratio_cap: if the net may have a larger ratio, set this key in the "
        "case",
        cap);
    return text;
}

/* Evaluates a design, and writes which limit or requirement its shape breaks most, ": tension of cable c7 is 9, but the
 * bound of optimize.limits.1 is 50", or "". */
static void name_broken(hf_problem *p, const double *design, hf_form_result *r, char text[2 * HF_HELD_NAME_SIZE])
{
    *text = '\0';
    hf_evaluate(&p->evaluator, design, &p->workspace, &p->point, r);
    if (!hf_status_has_shape(r->status)) return;
    hf_limits_name_broken(&p->evaluator, &p->scene, &p->workspace, text, 2 * HF_HELD_NAME_SIZE);
    if (!*text) hf_problem_broken_requirement(p, text, 2 * HF_HELD_NAME_SIZE);
}

/* Returns what gives the designs more room. */
static const char *what_to_widen(const hf_problem *p)
{
    return p->model.variable ? "the ranges and bounds of optimize.variables" : "optimize.range_N";
}

/* Writes "Raise form.pretension_N to 12 N, " for the advice "raise form.pretension_N to 12 N", or "" for none. Returns
 * text. */
static const char *begin_with(const char *advice, char text[HF_FEASIBLE_ADVICE_SIZE + 2])
{
    snprintf(text, HF_FEASIBLE_ADVICE_SIZE + 2, "%s%s", advice, *advice ? ", " : "");
    *text = (char)toupper((unsigned char)*text);
    return text;
}

hf_status hf_no_design_evolved(hf_problem *p, const hf_population *of, const double *nearest, const char *advice,
                               hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    long above = of->n_evaluation_above_cap, shapeless = of->n_evaluation_infeasible - above;
    const char *wider = what_to_widen(p);
    const char *which = nearest ? "nearest" : "initial";
    hf_form_result shown;
    char broken[2 * HF_HELD_NAME_SIZE], hint[HF_NO_DESIGN_HINT_SIZE], first[HF_FEASIBLE_ADVICE_SIZE + 2];
    name_broken(p, nearest ? nearest : of->initial, &shown, broken);
    bool is_required = p->objectives.constraints;
    if (above > 0 && (o->n_limit > 0 || is_required))
        return hf_error(messages, HF_NO_FEASIBLE,
                        "optimize: the search found no feasible design, because %ld of %ld evaluations exceed "
                        "optimize.limits%s or boundary_ratio_cap%s%s%s%s. %s%soosen the limits, or widen %s%s",
                        above, of->n_evaluation, is_required ? ", requirements" : "", *broken ? "; of the " : "",
                        *broken ? which : "", *broken ? " design, the" : "", broken + (*broken == ':'),
                        begin_with(advice, first), *advice ? "l" : "L", wider,
                        hf_no_design_cap(p, shown.boundary_tension_ratio, hint));
    if (above == 0)
        return hf_error(messages, HF_NO_FEASIBLE,
                        "optimize: the search found no feasible design, because none of %ld evaluations has a shape "
                        "(%s). Narrow %s to keep designs closer to the initial design",
                        shapeless, hf_status_text(of->trial_status[0]), wider);
    char ratio[64] = "has no shape", others[64] = "";
    if (isfinite(shown.boundary_tension_ratio))
        snprintf(ratio, sizeof ratio, "has the ratio %.4g", shown.boundary_tension_ratio);
    if (shapeless > 0) snprintf(others, sizeof others, ", %ld have no shape", shapeless);
    return hf_error(messages, HF_NO_FEASIBLE,
                    "optimize: the search found no feasible design, because %ld of %ld evaluations are above "
                    "boundary_ratio_cap %g%s. The %s design %s. Raise optimize.boundary_ratio_cap, or widen %s%s",
                    above, of->n_evaluation, o->boundary_ratio_cap, others, which, ratio, wider,
                    hf_no_design_cap(p, INFINITY, hint));
}

void hf_no_design_expected(const hf_problem *p, const hf_repair_doubt *doubt, hf_messages *messages)
{
    const hf_limit_held *limit = &doubt->limit;
    char what[2 * HF_HELD_NAME_SIZE], name[HF_HELD_NAME_SIZE];
    const char *bound = limit->row == HF_LIMITS_CAP ? "boundary_ratio_cap" : "its bound";
    if (doubt->constraint >= 0) {
        snprintf(what, sizeof what, "bound of %s is missed in all designs",
                 hf_problem_constraint_name(p, doubt->constraint, name, sizeof name));
    } else {
        snprintf(what, sizeof what, "%s is at %s %.4g in all designs, but %s is %g",
                 hf_limits_name(&p->scene, &p->model, limit, name, sizeof name),
                 limit->value > limit->bound ? "least" : "most", limit->value, bound, limit->bound);
    }
    hf_warning(messages,
               "optimize: hifdm expects no feasible design. By the derivatives at the nearest design of the first "
               "generation, the %s. The search goes on. Loosen this limit, or widen %s",
               what, what_to_widen(p));
}

/* Returns true if the shape in the workspace, whose result is `r`, misses a maximum of psi, the only requirement, by
 * less than the certified error of psi, or the tolerance of the coupling if no error is certified: a more accurate
 * shape may meet it. */
static bool misses_by_error(hf_problem *p, hf_form_result r)
{
    const hf_constraints *c = hf_problem_constraints_of(p);
    if (!c || c->n != 1 || !(c->psi_most_m > 0)) return false;
    r.status = HF_OK;
    r.psi_m = hf_metrics_psi_m(&p->model, &p->workspace);
    hf_certify(&p->model, &p->workspace, &r);
    double error_m = isnan(r.psi_bound_m) && p->model.n_attachment ? p->settings.form.coupling.tof_m : r.psi_bound_m;
    return r.psi_m > c->psi_most_m && r.psi_m - c->psi_most_m < error_m;
}

const char *hf_no_design_to_refine(hf_problem *p, const double *initial, const double *design, hf_status status,
                                   const char *advice, char text[HF_NO_DESIGN_SIZE])
{
    hf_form_result start;
    char broken[2 * HF_HELD_NAME_SIZE], hint[HF_NO_DESIGN_HINT_SIZE], first[HF_FEASIBLE_ADVICE_SIZE + 2];
    name_broken(p, design, &start, broken);
    const char *wider = p->model.variable ? "Widen the ranges and bounds of optimize.variables, " : "";
    if (start.status == HF_OUT_OF_LIMITS && misses_by_error(p, start))
        wider = p->model.n_attachment
                    ? "Lower coupling.tof_m and form.residual_tolerance, which bound the accuracy of psi, "
                    : "Lower form.residual_tolerance, which bounds the accuracy of psi, ";
    char factor[64] = "";
    double least, most;
    hf_variables_scales(&p->model, initial, design, &least, &most);
    if (!isnan(least)) snprintf(factor, sizeof factor, ", which scales variables by %.4g", least);
    if (most > least * (1 + 1e-9))
        snprintf(factor, sizeof factor, ", which scales variables by %.4g to %.4g", least, most);
    snprintf(text, HF_NO_DESIGN_SIZE,
             "optimize: Levenberg-Marquardt has no feasible start: at the nearest design%s, %s%s. %s%s%s", factor,
             hf_status_text(status), broken, *advice ? begin_with(advice, first) : wider,
             *advice || *wider ? "or loosen the limits" : "Loosen the limits",
             hf_no_design_cap(p, start.boundary_tension_ratio, hint));
    return text;
}

/* ---- doubts about a result ---- */

/* Checks a result for three things that its user should know before the net is built.
 *
 *     truss:   displacements too large for linear theory
 *     strains: T/EA of a cable above a few per cent
 *     nodes:   far from their positions after form-finding, in a direction that no objective counts */

/* Neglected displacement above which a warning appears, relative to the span of the attachments: 0.1 mm on 10 m, as
 * much as an error of cutting may be. It must also exceed SECOND_ORDER_PSI times psi. */
#define SECOND_ORDER_DOUBT 1e-5
#define SECOND_ORDER_PSI 0.05

/* The truss is computed by linear theory. This warns if the neglected second order is large for the size of the
 * reflector and its psi. */
void hf_result_doubt_truss(const hf_problem *p, const hf_carrier_state *truss, const hf_workspace *shape,
                           hf_messages *messages)
{
    double move_m, span_m, off_m = hf_carrier_second_order_m(&p->carrier, truss, &move_m, &span_m);
    double psi_m = shape ? hf_metrics_psi_m(&p->model, shape) : 0;
    if (off_m > fmax(SECOND_ORDER_DOUBT * span_m, SECOND_ORDER_PSI * psi_m))
        hf_warning(
            messages,
            "truss: the attachments deflect by %.3g mm in the result, so the linear theory of the truss may have an "
            "error of about %.2g mm. Stiffen the truss (tubes of larger diameter, more bays) or lower "
            "form.pretension_N",
            move_m * 1e3, off_m * 1e3);
}

/* Fibres and steel break at a few per cent. With more strain, EA or the tension is not the intended one. */
#define STRAIN_DOUBT 0.05

void hf_result_doubt_strain(const hf_problem *p, const hf_workspace *shape, hf_messages *messages)
{
    const double *EA_N = p->scene.EA_N;
    double most = STRAIN_DOUBT;
    int worst = -1, n = 0;
    char more[32] = "";
    for (int e = 0; EA_N && shape && e < p->scene.n_cable; e++) {
        double strain = EA_N[e] > 0 ? shape->tension_N[e] / EA_N[e] : 0;
        n += strain > STRAIN_DOUBT;
        if (!(strain > most)) continue;
        most = strain;
        worst = e;
    }
    if (worst < 0) return;
    if (n > 1) snprintf(more, sizeof more, " and %d more", n - 1);
    hf_warning(messages,
               "cable '%s'%s %s stretched by %s%.3g %% (tension %.4g N, EA %.4g N), but cables break at a few per "
               "cent. Check that EA is in N",
               p->scene.cable_id[worst], more, n > 1 ? "are" : "is", n > 1 ? "up to " : "", most * 100,
               shape->tension_N[worst], EA_N[worst]);
}

/* Displacement above which a warning appears, relative to the mean length of a node's cables. In the cases of configs/
 * the maximum uncounted one is 0.11. With every force density as a variable, the objective facets permits 0.3 to 1.3.
 * The tests pass with 0.17 to 0.3. */
#define FAR_MOVE 0.25

static void count_rows(hf_places *to, const int *row, int n, hf_counted how)
{
    for (int i = 0; i < n; i++)
        if (to->counted[row[i]] < how) to->counted[row[i]] = (unsigned char)how;
}

/* Forces, and sums of lengths, do not fix positions. */
static void count_objective(const hf_problem *p, const hf_objective *g, hf_places *to)
{
    const hf_model *m = &p->model;
    hf_figure_kind figure = g->settings.figure;
    if (source_of[figure] == OF_INNER_NODES)
        count_rows(to, m->inner_row, m->n_inner_node, figure == HF_FIGURE_PSI ? HF_COUNTED : HF_COUNTED_ACROSS);
    if (source_of[figure] == OF_FACETS)
        count_rows(to, p->objectives.corner_row, 4 * p->objectives.n_facet, HF_COUNTED_ACROSS);
    for (int i = 0; i < g->n_cable && figure == HF_FIGURE_LENGTH; i++)
        count_rows(to, m->end_row + 2 * (ptrdiff_t)g->cable[i], 2, HF_COUNTED);
}

hf_status hf_places_keep(const hf_problem *p, hf_places *to)
{
    const hf_model *m = &p->model;
    const hf_objective psi = {.settings = {.figure = HF_FIGURE_PSI}};
    size_t n = (size_t)m->n_node;
    *to = (hf_places){0};
    HF_TRY(HF_ARENA_ARRAYS(&to->block, HF_ARRAY(to->position_m, 3 * n), HF_ARRAY(to->cable_m, n),
                           HF_ARRAY(to->n_cable, n), HF_ARRAY(to->counted, n)));
    memcpy(to->position_m, p->workspace.position_m, 3 * n * sizeof(double));
    for (int i = 0; i < 2 * m->n_cable; i++) {
        to->cable_m[m->end_row[i]] += m->length_m[i / 2];
        to->n_cable[m->end_row[i]]++;
    }
    for (int row = 0; row < m->n_node; row++)
        if (to->n_cable[row]) to->cable_m[row] /= to->n_cable[row];
    if (p->objectives.n_objective == 0) count_objective(p, &psi, to);
    for (int k = 0; k < p->objectives.n_objective; k++)
        count_objective(p, &p->objectives.objective[k], to);
    return HF_OK;
}

void hf_places_free(hf_places *places)
{
    hf_arena_free_block(places->block);
    *places = (hf_places){0};
}

/* Splits the displacement of a node since form-finding, m, into a part that objectives count and one that they do
 * not. */
static void split_move(const hf_problem *p, const hf_places *form, const hf_workspace *shape, int row,
                       double *counted_m, double *open_m)
{
    double at[3], move[3], slope[2], square = 0, across = 0;
    for (int c = 0; c < 3; c++) {
        int i = c * p->model.n_node + row;
        at[c] = form->position_m[i];
        move[c] = shape->position_m[i] - at[c];
        square += move[c] * move[c];
    }
    if (form->counted[row] == HF_COUNTED) across = sqrt(square);
    if (form->counted[row] == HF_COUNTED_ACROSS) {
        hf_target_surface_height_above(p->surface.kind, 1 / (4 * p->surface.focal_length_m), at, slope);
        across = fabs(move[2] - slope[0] * move[0] - slope[1] * move[1]) /
                 sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);
    }
    *counted_m = across;
    *open_m = sqrt(fmax(0, square - across * across));
}

/* Returns the set to which most cables at a node belong, or their group, as a row of a case can name it. */
static const char *set_at(const hf_problem *p, int row)
{
    const hf_scene *s = &p->scene;
    const int *end = p->model.end_row;
    int best = -1, most = 0;
    for (int e = 0; e < s->n_cable; e++) {
        if (end[2 * e] != row && end[2 * e + 1] != row) continue;
        int family = hf_prestress_family(s, e), n = 0;
        for (int k = 0; k <= e; k++)
            n += (end[2 * k] == row || end[2 * k + 1] == row) && hf_prestress_family(s, k) == family;
        if (n > most) best = family;
        if (n > most) most = n;
    }
    return best < s->n_set ? s->set_name[best] : hf_group_word[best - s->n_set];
}

typedef struct {
    int row, n; /* row of the farthest node, and number of far nodes */
    double move_m;
} far_nodes;

/* Writes "", or ", and 61 more". Returns text. */
static const char *and_more(const far_nodes *far, char text[32])
{
    *text = '\0';
    if (far->n > 1) snprintf(text, 32, ", and %d more", far->n - 1);
    return text;
}

static void tell_far(const hf_problem *p, const hf_places *form, const far_nodes *far, hf_messages *messages)
{
    const far_nodes *open = &far[HF_COUNTED_NOT], *within = &far[HF_COUNTED_ACROSS];
    char more[32];
    if (open->n)
        hf_warning(messages,
                   "optimize: node %s%s moved far from its position after form-finding, by %.0f mm, but its cables are "
                   "only %.0f mm long. No objective counts this displacement. Vary fewer cable sets, or add the row "
                   "{figure: length, set: %s, weight: 0.1} to the list optimize.objective%s",
                   p->scene.node_id[p->model.node_of_row[open->row]], and_more(open, more), open->move_m * 1e3,
                   form->cable_m[open->row] * 1e3, set_at(p, open->row),
                   p->objectives.n_objective ? "" : " beside {figure: psi}");
    if (within->n)
        hf_warning(messages,
                   "optimize: node %s%s moved far within the surface, by %.0f mm, but its cables are only %.0f mm "
                   "long. No objective counts this displacement. Vary fewer cable sets, or add the row {figure: psi, "
                   "weight: 0.1} to the list optimize.objective",
                   p->scene.node_id[p->model.node_of_row[within->row]], and_more(within, more), within->move_m * 1e3,
                   form->cable_m[within->row] * 1e3);
}

void hf_result_doubt_uncounted(const hf_problem *p, const hf_places *form, const hf_workspace *shape, hf_summary *s,
                               hf_messages *messages)
{
    far_nodes far[HF_COUNTED + 1] = {0};
    double counted_m, open_m, most_m = 0;
    if (!form->block || !shape) return;
    s->n_uncounted = 0;
    s->uncounted_move_m = 0;
    for (int row = 0; row < p->model.n_free; row++) {
        split_move(p, form, shape, row, &counted_m, &open_m);
        most_m = fmax(most_m, counted_m);
        s->n_uncounted += form->counted[row] != HF_COUNTED;
        if (!shape->loose[row]) s->uncounted_move_m = fmax(s->uncounted_move_m, open_m);
    }
    for (int row = 0; row < p->model.n_free; row++) {
        far_nodes *to = &far[form->counted[row]];
        split_move(p, form, shape, row, &counted_m, &open_m);
        if (shape->loose[row] || !(open_m > fmax(FAR_MOVE * form->cable_m[row], most_m))) continue;
        to->n++;
        if (open_m > to->move_m) to->row = row;
        to->move_m = fmax(to->move_m, open_m);
    }
    tell_far(p, form, far, messages);
}
