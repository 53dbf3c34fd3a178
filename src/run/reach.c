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
#include "run/reach.h"

#include "base/arena.h"
#include "base/random.h"
#include "net/variables.h"
#include "run/problem_parts.h"
#include "search/refine.h"
#include "search/sensitivity.h"
#include "solve/limits.h"

#include <math.h>
#include <string.h>

#define ROUNDED 1e-9  /* part of the maximum change that counts as none; prescribed values show up to 1e-12 */
#define BESIDE 0.05   /* distance of the second design, over the range of a variable */
#define FAR_RANGE 3.0 /* a range above this multiple of the maximum value is in doubt */
#define CLASSES 16    /* maximum number of classes; at least one for each row */

/* What no variable has been seen to change, and rows of variables that have been seen to change nothing. */
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

/* ---- classes of variables ---- */

static int row_of_variable(const hf_model *m, int k)
{
    return m->variable ? m->variable[k].setting : 0;
}

/* Returns the class of a leading variable, chosen by a hash among the classes of its row. */
static int class_of(const reach *q, int k)
{
    int n_row = q->p->settings.optimize.n_variable_row, n = n_row > 1 ? CLASSES / n_row : CLASSES;
    return row_of_variable(&q->model, k) * n + (int)(hf_random_mix((uint64_t)k) % (uint64_t)n);
}

static void link_classes(reach *q)
{
    const hf_model *m = &q->p->model;
    int first[CLASSES];
    for (int i = 0; i < CLASSES; i++)
        first[i] = -1;
    q->model.n_leader = 0;
    for (int k = 0; k < m->n_variable; k++) {
        int i = class_of(q, m->variable_leader[k]);
        if (first[i] < 0) first[i] = k;
        q->leader[k] = first[i];
        q->model.n_leader += first[i] == k;
    }
    q->model.variable_leader = q->leader;
}

static void lay_out(hf_arena *a, reach *q)
{
    const hf_model *m = &q->model;
    q->leader = hf_arena_take(a, (size_t)m->n_variable, sizeof(int));
    q->design = hf_arena_take(a, (size_t)m->n_variable, sizeof(double));
    q->move_m = hf_arena_take(a, 3 * (size_t)m->n_node, sizeof(double));
    q->rate_N = hf_arena_take(a, (size_t)m->n_cable, sizeof(double));
}

static hf_status create(const hf_problem *p, reach *q)
{
    hf_arena arena = {0};
    *q = (reach){.p = p, .model = p->model, .v = p->evaluator};
    q->v.model = &q->model;
    q->v.boundary_ratio_cap = INFINITY;
    q->v.limits = NULL;
    q->v.objectives = NULL;
    q->v.n_thread = 1;
    memset(&q->now, true, sizeof q->now);
    q->now.psi = p->objectives.n_objective == 0 && p->model.n_inner_node > 0;
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, q)));
    q->block = arena.block;
    link_classes(q);
    HF_TRY(hf_workspace_create(&q->model, &q->w));
    return hf_sensitivity_create(&q->v, &q->slopes);
}

static void destroy(reach *q)
{
    hf_arena arena = {.block = q->block};
    hf_sensitivity_free(&q->slopes);
    hf_workspace_free(&q->w);
    hf_arena_free(&arena);
}

/* ---- what changes ---- */

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

static bool moves(const reach *q, int row)
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

/* ---- what rows depend on ---- */

static bool any_cable(const reach *q, int n, const int *cable, bool (*changes)(const reach *, int))
{
    for (int i = 0; i < n; i++)
        if (changes(q, cable[i])) return true;
    return false;
}

static bool any_row(const reach *q, int n, const int *row)
{
    for (int i = 0; i < n; i++)
        if (moves(q, row[i])) return true;
    return false;
}

static bool changes_objective(const reach *q, const hf_objective *g)
{
    const hf_objectives *objectives = &q->p->objectives;
    if (g->n_net) return true; /* another cut changes the tensions and the shape of an as-built net */
    switch (g->settings.figure) {
    case HF_FIGURE_PSI:
    case HF_FIGURE_SURFACE:
        return any_row(q, q->model.n_inner_node, q->model.inner_row);
    case HF_FIGURE_FACETS:
    case HF_FIGURE_GAIN:
        return any_row(q, 4 * objectives->n_facet, objectives->corner_row);
    case HF_FIGURE_TENSION:
    case HF_FIGURE_EVENNESS:
    case HF_FIGURE_RATIO:
        return any_cable(q, g->n_cable, g->cable, pulls_otherwise);
    case HF_FIGURE_LENGTH:
    case HF_FIGURE_MASS:
        return any_cable(q, g->n_cable, g->cable, lengthens);
    case HF_FIGURE_PULL:
    case HF_FIGURE_DEFLECTION:
        return true; /* any change of the shape changes the pull on supports */
    }
    return true;
}

static bool changes_limit(const reach *q, const hf_limit *row)
{
    return row->kind == HF_LIMIT_DEFLECTION || any_cable(q, row->n_cable, row->cable, pulls_otherwise);
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
        if (q->now.psi) q->now.psi = !any_row(q, q->model.n_inner_node, q->model.inner_row);
        for (int i = 0; i < q->p->objectives.n_objective; i++)
            if (q->now.objective[i]) q->now.objective[i] = !changes_objective(q, &q->p->objectives.objective[i]);
        for (int i = 0; i < o->n_limit; i++)
            if (q->now.limit[i]) q->now.limit[i] = !changes_limit(q, &q->p->limits.row[i]);
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

/* ---- messages ---- */

static const char *why_objective(hf_figure_kind kind)
{
    switch (kind) {
    case HF_FIGURE_PSI:
    case HF_FIGURE_SURFACE:
    case HF_FIGURE_FACETS:
    case HF_FIGURE_GAIN:
        return "none of its nodes moves";
    case HF_FIGURE_TENSION:
    case HF_FIGURE_EVENNESS:
    case HF_FIGURE_RATIO:
        return "all of its cables keep their tensions";
    case HF_FIGURE_LENGTH:
    case HF_FIGURE_MASS:
        return "all of its cables keep their lengths";
    default:
        return "the pull on the supports does not change";
    }
}

static hf_status tell_objectives(const reach *q, hf_messages *messages)
{
    const hf_objectives *objectives = &q->p->objectives;
    bool is_front = q->p->settings.optimize.n_front > 0, is_reached = false, has_fault = false;
    char place[HF_LOCATION_SIZE], name[HF_OBJECTIVE_NAME_SIZE];
    for (int i = 0; i < objectives->n_objective; i++)
        is_reached |= !q->now.objective[i];
    for (int i = 0; i < objectives->n_objective; i++) {
        if (!q->now.objective[i]) continue;
        hf_messages_location(messages, place, "optimize.%s.%d", is_front ? "front" : "objective", i);
        hf_objectives_name(objectives, i, name);
        const char *why = why_objective(objectives->objective[i].settings.figure);
        has_fault |= is_front || !is_reached;
        if (is_front || !is_reached)
            hf_error(messages, HF_BAD_CASE,
                     "%s: no design variable of this case changes %s: %s; add one that does, or leave the row out",
                     place, name, why);
        else
            hf_warning(messages, "%s: no design variable of this case changes %s: %s", place, name, why);
    }
    return has_fault ? HF_BAD_CASE : HF_OK;
}

static hf_status tell(const reach *q, hf_messages *messages)
{
    const hf_optimize_settings *o = &q->p->settings.optimize;
    char place[HF_LOCATION_SIZE];
    for (int i = 0; i < o->n_variable_row; i++)
        if (q->now.variable_row[i])
            hf_warning(
                messages,
                "%s: changes nothing at the initial design, because its cables, or those at its supports, are slack",
                hf_messages_location(messages, place, "optimize.variables.%d", i));
    for (int i = 0; i < o->n_limit; i++)
        if (q->now.limit[i])
            hf_warning(messages, "%s: no design variable of this case changes the limited figure: %s",
                       hf_messages_location(messages, place, "optimize.limits.%d", i),
                       o->limit[i].figure == HF_LIMIT_DEFLECTION ? why_objective(HF_FIGURE_DEFLECTION)
                                                                 : why_objective(HF_FIGURE_TENSION));
    if (q->p->objectives.n_objective > 0) return tell_objectives(q, messages);
    if (!q->now.psi) return HF_OK;
    return hf_error(
        messages, HF_BAD_CASE,
        "%s: no design variable of this case changes psi: %s; add one that does, or use another optimize.objective",
        hf_messages_location(messages, place, o->n_variable_row ? "optimize.variables.0" : "optimize.range_N"),
        why_objective(HF_FIGURE_PSI));
}

/* Returns true if a row remains that no variable has been seen to change, or that has changed nothing. */
static bool is_open(const reach *q)
{
    const hf_optimize_settings *o = &q->p->settings.optimize;
    bool is = q->now.psi;
    for (int i = 0; i < HF_DESIGN_ROWS_MAX; i++)
        is |= (i < q->p->objectives.n_objective && q->now.objective[i]) || (i < o->n_limit && q->now.limit[i]) ||
              (i < o->n_variable_row && q->now.variable_row[i]);
    return is;
}

/* Examines both designs. Returns HF_OK, also if the second one has no shape; HF_NOT_EVALUATED if the first one has
 * none; HF_NO_MEMORY. */
static hf_status look(reach *q)
{
    for (int i = 0; i < 2 && (i == 0 || is_open(q)); i++) {
        hf_form_result r;
        choose_design(q, i > 0);
        hf_status status = hf_evaluate(&q->v, q->design, &q->w, &r);
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
        hf_warning(messages,
                   "%s: %g is %.2g times the maximum value of this row, %.3g; for a relative range, write %g %%",
                   hf_messages_location(messages, place, "optimize.variables.%d.range", i), row->range,
                   row->range / most, most, row->range);
    }
}

hf_status hf_reach_check(const hf_problem *p, hf_messages *messages)
{
    const hf_optimize_settings *o = &p->settings.optimize;
    reach q;
    hf_problem_give_places(p, messages);
    doubt_ranges(p, messages);
    hf_problem_give_places(NULL, messages);
    if (!hf_refine_applies(&p->evaluator)) return HF_OK;
    if (!o->n_variable_row && !o->n_limit && !p->objectives.n_objective) return HF_OK;
    hf_status status = create(p, &q);
    if (status == HF_OK) status = look(&q);
    if (status == HF_NO_MEMORY) hf_error(messages, status, "out of memory for the derivatives of the objectives");
    if (status == HF_OK) {
        hf_problem_give_places(p, messages);
        status = tell(&q, messages);
        hf_problem_give_places(NULL, messages);
    }
    destroy(&q);
    return status == HF_NOT_EVALUATED ? HF_OK : status;
}
