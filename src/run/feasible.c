/* Implements feasible.h.
 *
 * Contents: bounds of the case, tensions that designs can have, sides of bounds, the linear programmes, advice,
 * messages. */
#include "run/feasible.h"

#include "base/arena.h"
#include "case/config_fault.h"
#include "net/variables.h"
#include "run/problem_parts.h"
#include "run/requirements_stage.h"
#include "solve/tension_programme.h"
#include "surface/facet_mesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MISSED 1e-5         /* amount over the reference tension from which a bound counts as missed */
#define SHARE_OF_DESIGN 0.5 /* a larger share of the samples requires that about the design meets the bound, too */
#define NAMED_MAX 3         /* maximum number of bounds in a message about a contradiction */
/* Part of the sum of the multipliers above which a bound takes part in a contradiction. */
#define TAKES_PART 1e-3
#define PRETENSIONS_MAX 5 /* maximum number of pretensions that are tried for advice */
#define RATIO_STEPS_MAX 6 /* maximum number of programmes for the minimum ratio */
#define RATIO_AGREES 1e-4 /* relative change at which that ratio has settled */

/* ---- bounds of the case ---- */

/* Writes the bounds by optimize.limits and boundary_ratio_cap. Returns their number. */
static int list_bounds(const hf_problem *p, hf_feasible_bound bound[HF_FEASIBLE_BOUNDS_MAX])
{
    const hf_optimize_settings *o = &p->settings.optimize;
    const hf_model *m = &p->model;
    int n = 0;
    if (isfinite(p->evaluator.boundary_ratio_cap) && m->n_boundary > 0)
        bound[n++] = (hf_feasible_bound){"optimize.boundary_ratio_cap",
                                         -1,
                                         hf_group_word[HF_GROUP_BOUNDARY],
                                         m->n_boundary,
                                         m->boundary_cable,
                                         -INFINITY,
                                         INFINITY,
                                         p->evaluator.boundary_ratio_cap};
    for (int i = 0; i < p->limits.n; i++) {
        const hf_limit *row = &p->limits.row[i];
        bool is_ratio = row->kind == HF_LIMIT_RATIO;
        if (row->kind == HF_LIMIT_DEFLECTION) continue;
        bound[n++] = (hf_feasible_bound){"optimize.limits",
                                         i,
                                         o->limit[i].set,
                                         row->n_cable,
                                         row->cable,
                                         is_ratio ? -INFINITY : row->lower,
                                         is_ratio ? INFINITY : row->upper,
                                         is_ratio ? row->upper : INFINITY};
    }
    return n;
}

/* Adds the bounds by the rows of `requirements` about the nominal load case. If the design misses the bound of a row
 * with a share, so do about half of its samples. Returns the number of all bounds. */
static int add_required(const hf_required *q, int n, hf_feasible_bound bound[HF_FEASIBLE_BOUNDS_MAX])
{
    for (int i = 0; i < q->n; i++) {
        const hf_requirement_settings *r = &q->row[i];
        const hf_required_column *cables = &q->column[q->low[i] < 0 ? q->high[i] : q->low[i]];
        bool is_ratio = r->figure == HF_REQUIRED_RATIO, is_nominal = !(r->share < SHARE_OF_DESIGN) && q->states[i] & 1u;
        if (!is_nominal || (!is_ratio && r->figure != HF_REQUIRED_TENSION)) continue;
        double most = isnan(r->at_most) ? (double)INFINITY : r->at_most;
        bound[n++] = (hf_feasible_bound){"requirements",
                                         i,
                                         r->set,
                                         cables->n_cable,
                                         cables->cable,
                                         is_ratio || isnan(r->at_least) ? -INFINITY : r->at_least,
                                         is_ratio ? INFINITY : most,
                                         is_ratio ? most : INFINITY};
    }
    return n;
}

/* Writes the minimum and the maximum tension of the cables of a bound. */
static void find_range(const hf_feasible_bound *b, const double *tension_N, double *low_N, double *high_N)
{
    *low_N = INFINITY;
    *high_N = -INFINITY;
    for (int i = 0; i < b->n_cable; i++) {
        *low_N = fmin(*low_N, tension_N[b->cable[i]]);
        *high_N = fmax(*high_N, tension_N[b->cable[i]]);
    }
}

static bool meets(int n, const hf_feasible_bound *bound, const double *tension_N)
{
    for (int i = 0; i < n; i++) {
        double low_N, high_N;
        find_range(&bound[i], tension_N, &low_N, &high_N);
        if (low_N < bound[i].lower_N || high_N > bound[i].upper_N) return false;
        if (isfinite(bound[i].ratio) && !(high_N <= bound[i].ratio * low_N)) return false;
    }
    return true;
}

/* ---- tensions that designs can have ---- */

/* The sides of bounds, with the programmes that decide about them. */
typedef enum { LOWER, UPPER, RATIO, N_SIDE } side_kind;

typedef struct {
    const hf_problem *p;
    const hf_feasible_bound *bound;
    int n_bound;
    double *tension_N;         /* [n_cable] tensions of the initial design at the target positions */
    double *lower_N, *upper_N; /* [n_cable] tensions that designs can have there */
    bool *is_given;            /* [n_cable] the design gives the tension itself, at all positions */
    bool *is_open;             /* [n_free] nodes that need no equilibrium */
    hf_tension_row *row;       /* [n_row_max] */
    int *row_side;             /* [n_row_max] side of each row, N_SIDE bound + kind */
    double *multiplier;        /* [n_row_max] */
    int n_row;
    void *block;
} feasible;

static hf_status create(const hf_problem *p, int n_bound, const hf_feasible_bound *bound, feasible *q)
{
    size_t n_row = 0, e = (size_t)p->model.n_cable;
    *q = (feasible){.p = p, .bound = bound, .n_bound = n_bound};
    for (int i = 0; i < n_bound; i++)
        n_row += 4 * (size_t)bound[i].n_cable;
    return HF_ARENA_ARRAYS(&q->block, HF_ARRAY(q->tension_N, e), HF_ARRAY(q->lower_N, e), HF_ARRAY(q->upper_N, e),
                           HF_ARRAY(q->is_given, e), HF_ARRAY(q->is_open, p->model.n_free), HF_ARRAY(q->row, n_row),
                           HF_ARRAY(q->row_side, n_row), HF_ARRAY(q->multiplier, n_row));
}

/* Sets the tension of each cable in the initial design at the target positions, if its law gives one. */
static void set_tensions(feasible *q)
{
    const hf_model *m = &q->p->model;
    for (int e = 0; e < m->n_cable; e++) {
        q->tension_N[e] = q->p->workspace.tension_N[e];
        if (m->law[e] == HF_LAW_FORCE_DENSITY) q->tension_N[e] = m->target[e] * m->length_m[e];
        if (m->law[e] == HF_LAW_TENSION) q->tension_N[e] = m->target[e];
    }
}

/* Sets the tensions that a design variable can give to its cable. `base` is its initial value. */
static void set_range_of_variable(feasible *q, int k)
{
    const hf_problem *p = q->p;
    int e = p->model.variable_cable[k];
    hf_variable_sets sets = hf_evaluate_sets(&p->evaluator, k);
    double lower, upper, reach, base = p->initial[k], to_N = 1;
    if (sets == HF_SETS_DENSITY || sets == HF_SETS_TENSION) {
        if (sets == HF_SETS_DENSITY) to_N = p->model.length_m[e] / hf_evaluate_divisor(&p->evaluator, k);
        if (p->settings.form.prestress == HF_PRESTRESS_EXACT) base = q->tension_N[e] / to_N;
        hf_variables_bound(&p->settings.optimize, &p->model, k, base, &lower, &upper, &reach);
        q->is_given[e] = sets == HF_SETS_TENSION;
        q->lower_N[e] = fmax(0, lower) * to_N;
        q->upper_N[e] = upper * to_N;
    } else if (sets != HF_SETS_START) {
        q->is_given[e] = false;
        q->lower_N[e] = 0;
        q->upper_N[e] = INFINITY;
    }
}

/* Nodes at a support that designs displace need no equilibrium, because the directions of their cables change. */
static void open_nodes(feasible *q, int support_row)
{
    const hf_model *m = &q->p->model;
    for (int end = 0; end < 2 * m->n_cable; end++)
        if (m->end_row[end] == support_row && m->end_row[end ^ 1] < m->n_free) q->is_open[m->end_row[end ^ 1]] = true;
}

/* Sets the tensions that designs can have, from the initial design q->tension_N. */
static void set_ranges(feasible *q)
{
    const hf_model *m = &q->p->model;
    for (int e = 0; e < m->n_cable; e++) {
        bool is_fixed = m->law[e] == HF_LAW_FORCE_DENSITY || m->law[e] == HF_LAW_TENSION;
        q->is_given[e] = m->law[e] == HF_LAW_TENSION;
        q->lower_N[e] = is_fixed ? q->tension_N[e] : 0;
        q->upper_N[e] = is_fixed ? q->tension_N[e] : INFINITY;
    }
    for (int k = 0; k < m->n_variable; k++) {
        if (m->variable_cable[k] >= 0)
            set_range_of_variable(q, k);
        else
            open_nodes(q, m->variable[k].support_row);
    }
}

/* ---- the linear programmes ---- */

static void add_row(feasible *q, int side, hf_tension_row row)
{
    q->row_side[q->n_row] = side;
    q->row[q->n_row++] = row;
}

/* Adds the rows of one side, loosened by the shared variable 0. The ratio takes another one, between the minimum
 * tension and the maximum tension over the ratio. */
static void add_side(feasible *q, int side, int *n_shared)
{
    const hf_feasible_bound *b = &q->bound[side / N_SIDE];
    side_kind kind = (side_kind)(side % N_SIDE);
    if (kind == LOWER && isfinite(b->lower_N) && b->lower_N > 0)
        for (int i = 0; i < b->n_cable; i++)
            add_row(q, side, (hf_tension_row){b->cable[i], 1, b->lower_N, {0, -1}, {1, 0}});
    if (kind == UPPER && isfinite(b->upper_N))
        for (int i = 0; i < b->n_cable; i++)
            add_row(q, side, (hf_tension_row){b->cable[i], -1, -b->upper_N, {0, -1}, {1, 0}});
    if (kind != RATIO || !isfinite(b->ratio)) return;
    for (int i = 0; i < b->n_cable; i++) {
        add_row(q, side, (hf_tension_row){b->cable[i], 1, 0, {0, *n_shared}, {1, -1}});
        add_row(q, side, (hf_tension_row){b->cable[i], -1, 0, {0, *n_shared}, {1, b->ratio}});
    }
    ++*n_shared;
}

/* Finds the minimum amount by which the rows must be loosened, or 0 if they need not be. Returns HF_OK,
 * HF_NOT_CONVERGED if no tensions hold the net or there are too many rows, or HF_NO_MEMORY. */
static hf_status solve(feasible *q, int n_shared, double *amount_N)
{
    const double cost[HF_TENSION_SHARED_MAX] = {1};
    double shared_N[HF_TENSION_SHARED_MAX];
    const hf_tension_programme programme = {&q->p->model, q->lower_N, q->upper_N, q->tension_N, q->is_open,
                                            q->n_row,     n_shared,   q->row,     cost,         0};
    *amount_N = 0;
    if (q->n_row == 0) return HF_OK;
    if (n_shared > HF_TENSION_SHARED_MAX) return HF_NOT_CONVERGED;
    HF_TRY(hf_tension_programme_solve(&programme, shared_N, q->multiplier));
    *amount_N = fmax(0, shared_N[0]);
    return HF_OK;
}

static hf_status solve_all(feasible *q, double *amount_N)
{
    int n_shared = 1;
    q->n_row = 0;
    for (int side = 0; side < N_SIDE * q->n_bound; side++)
        add_side(q, side, &n_shared);
    return solve(q, n_shared, amount_N);
}

/* Finds the minimum ratio of a bound by Dinkelbach's method: the minimum of max / ratio - min is 0 at the
 * minimum ratio. */
static hf_status find_ratio(feasible *q, const hf_feasible_bound *b, double *ratio)
{
    double at = b->ratio;
    q->n_row = 0;
    for (int i = 0; i < b->n_cable; i++) {
        add_row(q, 0, (hf_tension_row){b->cable[i], -1, 0, {0, -1}, {1, 0}});
        add_row(q, 0, (hf_tension_row){b->cable[i], 1, 0, {1, -1}, {-1, 0}});
    }
    for (int i = 0; i < RATIO_STEPS_MAX; i++) {
        const double cost[] = {1 / at, -1};
        double shared_N[2], before = at;
        const hf_tension_programme programme = {&q->p->model, q->lower_N, q->upper_N, q->tension_N, q->is_open,
                                                q->n_row,     2,          q->row,     cost,         -INFINITY};
        HF_TRY(hf_tension_programme_solve(&programme, shared_N, NULL));
        at = shared_N[1] > 0 ? shared_N[0] / shared_N[1] : (double)INFINITY;
        if (!isfinite(at) || fabs(at - before) <= RATIO_AGREES * before) break;
    }
    *ratio = at;
    return HF_OK;
}

/* Finds the best value of one side alone: the largest minimum tension, the smallest maximum tension or the smallest
 * ratio. Sets *is_missed if it does not meet its bound. amount_N is the amount by which this side must be loosened if
 * no other one takes part in its contradiction, else NAN. */
static hf_status find_best(feasible *q, int side, double amount_N, double *best, bool *is_missed)
{
    const hf_feasible_bound *b = &q->bound[side / N_SIDE];
    int n_shared = 1;
    q->n_row = 0;
    add_side(q, side, &n_shared);
    if (isnan(amount_N)) HF_TRY(solve(q, n_shared, &amount_N));
    *is_missed = amount_N > MISSED * q->p->model.reference_N;
    if (side % N_SIDE == LOWER) *best = b->lower_N - amount_N;
    if (side % N_SIDE == UPPER) *best = b->upper_N + amount_N;
    return side % N_SIDE == RATIO && *is_missed ? find_ratio(q, b, best) : HF_OK;
}

/* ---- advice ---- */

/* Rounds a positive value to some digits, up or down, so that a bound met by the exact value is met by the rounded
 * one. */
static double round_to(double value, int digits, bool up)
{
    double unit = pow(10, floor(log10(value)) + 1 - digits), n = value / unit, whole = nearbyint(n);
    if (fabs(n - whole) < 1e-6) return whole * unit;
    return (up ? ceil(n) : floor(n)) * unit;
}

/* Returns the next pretension to try: the present one times the factor by which the worst tension misses its bound. */
static double scaled(const feasible *q, double pretension_N, const double *tension_N)
{
    double up = 1, down = 1;
    for (int i = 0; i < q->n_bound; i++) {
        double low_N, high_N;
        find_range(&q->bound[i], tension_N, &low_N, &high_N);
        if (q->bound[i].lower_N > 0) up = fmax(up, low_N > 0 ? q->bound[i].lower_N / low_N : INFINITY);
        if (isfinite(q->bound[i].upper_N)) down = fmin(down, q->bound[i].upper_N / high_N);
    }
    if ((up > 1 && down < 1) || !isfinite(up) || !(down > 0)) return NAN;
    return up > 1 ? round_to(pretension_N * up, 3, true) : round_to(pretension_N * down, 3, false);
}

/* Finds a pretension with which the initial design meets all bounds. Without loads the tensions are in proportion to
 * the pretension, and the first one tried is right; otherwise each is tried. */
static hf_status advise(feasible *q, const hf_problem_source *source, char advice[HF_FEASIBLE_ADVICE_SIZE])
{
    const hf_model *m = &q->p->model;
    const double *length_m = q->p->workspace.length_m;
    double before_N = q->p->settings.form.pretension_N, *tension_N = q->lower_N; /* scratch before set_ranges */
    memcpy(tension_N, q->p->workspace.tension_N, (size_t)m->n_cable * sizeof *tension_N);
    for (int i = 0; i < PRETENSIONS_MAX; i++) {
        double try_N = scaled(q, before_N, tension_N);
        if (!(try_N > 0) || !(fabs(try_N - before_N) > 0)) return HF_OK;
        hf_status status = hf_problem_hold_at(q->p, source, try_N, tension_N);
        if (status != HF_OK) return status == HF_NO_MEMORY ? status : HF_OK;
        /* a truss deflects in proportion to the pretension, which changes the lengths */
        for (int e = 0; e < m->n_cable; e++)
            tension_N[e] *= 1 + (length_m[e] / m->length_m[e] - 1) * try_N / q->p->settings.form.pretension_N;
        if (meets(q->n_bound, q->bound, tension_N)) {
            snprintf(advice, HF_FEASIBLE_ADVICE_SIZE,
                     "%s form.pretension_N to %.6g N, at which the initial design meets all limits on tensions",
                     try_N > q->p->settings.form.pretension_N ? "raise" : "lower", try_N);
            return HF_OK;
        }
        before_N = try_N;
    }
    return HF_OK;
}

/* ---- messages ---- */

static const char *place_of(const feasible *q, const hf_feasible_bound *b, char place[HF_LOCATION_SIZE])
{
    if (b->row < 0) return hf_config_place(&q->p->settings, place, "%s", b->list);
    return hf_config_place(&q->p->settings, place, "%s.%d", b->list, b->row);
}

static const char *set_of(const hf_feasible_bound *b)
{
    return *b->set ? b->set : "all";
}

#define SIDE_SIZE 160

/* Writes "minimum tension of tie at least 5 N". Returns text. */
static const char *name_side(const feasible *q, int side, char text[SIDE_SIZE])
{
    const hf_feasible_bound *b = &q->bound[side / N_SIDE];
    if (side % N_SIDE == LOWER) snprintf(text, SIDE_SIZE, "tension of %s at least %.6g N", set_of(b), b->lower_N);
    if (side % N_SIDE == UPPER) snprintf(text, SIDE_SIZE, "tension of %s at most %.6g N", set_of(b), b->upper_N);
    if (side % N_SIDE == RATIO) snprintf(text, SIDE_SIZE, "tension ratio of %s at most %.6g", set_of(b), b->ratio);
    return text;
}

static void report_one(const feasible *q, int side, double best, const char *advice, hf_messages *messages)
{
    const hf_feasible_bound *b = &q->bound[side / N_SIDE];
    char place[HF_LOCATION_SIZE], text[SIDE_SIZE], found[SIDE_SIZE] = "", given[64] = "";
    bool is_lower = side % N_SIDE == LOWER, is_ratio = side % N_SIDE == RATIO;
    if (q->p->settings.form.prestress == HF_PRESTRESS_EXACT)
        snprintf(given, sizeof given, " with form.pretension_N %.6g", q->p->settings.form.pretension_N);
    if (isfinite(best) && best > 0)
        snprintf(found, sizeof found, ". There, the %s is %s %.4g%s%s",
                 is_ratio   ? "ratio"
                 : is_lower ? "minimum tension"
                            : "maximum tension",
                 is_lower ? "at most" : "at least", round_to(best, 4, !is_lower), is_ratio ? "" : " N", given);
    hf_warning(messages,
               "%s: no design at the target positions meets this limit (%s)%s%s%s%s. Designs away from the target "
               "positions may meet it",
               place_of(q, b, place), name_side(q, side, text), found, *advice ? "; " : "", advice,
               *advice ? "" : "; loosen the limit or widen the design variables");
}

static void report_contradiction(const feasible *q, int n, const int *side, double amount_N, const char *advice,
                                 hf_messages *messages)
{
    char place[HF_LOCATION_SIZE], list[NAMED_MAX * (SIDE_SIZE + 64)] = "";
    size_t used = 0;
    for (int i = 0; i < n && i < NAMED_MAX; i++) {
        const hf_feasible_bound *b = &q->bound[side[i] / N_SIDE];
        char one[SIDE_SIZE], row[64] = "";
        if (b->row >= 0) snprintf(row, sizeof row, " (%s.%d)", b->list, b->row);
        used +=
            (size_t)snprintf(list + used, sizeof list - used, "%s%s%s", i ? ", " : "", name_side(q, side[i], one), row);
    }
    hf_warning(messages,
               "%s: no design at the target positions meets these limits together: %s%s. Each would have to be "
               "loosened by %.3g N; %s. Designs away from the target positions may meet them",
               place_of(q, &q->bound[side[0] / N_SIDE], place), list, n > NAMED_MAX ? ", and more" : "", amount_N,
               *advice ? advice : "loosen one of them or widen the design variables");
}

/* Lists the sides with multipliers, the largest first. Returns their number. */
static int list_sides(const feasible *q, int side[N_SIDE * HF_FEASIBLE_BOUNDS_MAX])
{
    double weight[N_SIDE * HF_FEASIBLE_BOUNDS_MAX] = {0}, sum = 0;
    int n = 0;
    for (int i = 0; i < q->n_row; i++) {
        weight[q->row_side[i]] += q->multiplier[i];
        sum += q->multiplier[i];
    }
    for (int i = 0; i < N_SIDE * q->n_bound; i++) {
        int at = n;
        if (!(weight[i] > TAKES_PART * sum)) continue;
        for (; at > 0 && weight[side[at - 1]] < weight[i]; at--)
            side[at] = side[at - 1];
        side[at] = i;
        n++;
    }
    return n;
}

/* Reports which bounds cannot be met, one by one or together. */
static hf_status report(feasible *q, double amount_N, const char *advice, hf_messages *messages)
{
    int side[N_SIDE * HF_FEASIBLE_BOUNDS_MAX], n = list_sides(q, side), n_reported = 0;
    for (int i = 0; i < n && i < NAMED_MAX; i++) {
        double best = NAN;
        bool is_missed = false;
        hf_status status = find_best(q, side[i], n == 1 ? amount_N : (double)NAN, &best, &is_missed);
        if (status == HF_NO_MEMORY) return status;
        if (!is_missed) continue;
        report_one(q, side[i], status == HF_OK ? best : (double)NAN, advice, messages);
        n_reported++;
    }
    if (n_reported == 0 && n > 0) report_contradiction(q, n, side, amount_N, advice, messages);
    return HF_OK;
}

/* Warns about bounds that the tensions of single cables miss in all designs, at any positions. Returns their number. */
static int report_given(const feasible *q, hf_messages *messages)
{
    int n = 0;
    for (int side = 0; side < N_SIDE * q->n_bound; side++) {
        const hf_feasible_bound *b = &q->bound[side / N_SIDE];
        char place[HF_LOCATION_SIZE], text[SIDE_SIZE];
        bool is_lower = side % N_SIDE == LOWER;
        double worst_N = MISSED * q->p->model.reference_N;
        int worst = -1;
        for (int i = 0; i < b->n_cable && side % N_SIDE != RATIO; i++) {
            int e = b->cable[i];
            double missed_N = is_lower ? b->lower_N - q->upper_N[e] : q->lower_N[e] - b->upper_N;
            if (!q->is_given[e] || !(missed_N > worst_N)) continue;
            worst = e;
            worst_N = missed_N;
        }
        if (worst < 0) continue;
        hf_warning(messages,
                   "%s: no design meets this limit (%s), because cable '%s' has a tension of at %s %.6g N in every "
                   "design. Loosen the limit, or vary the tension of this cable further",
                   place_of(q, b, place), name_side(q, side, text), q->p->scene.cable_id[worst],
                   is_lower ? "most" : "least", is_lower ? q->upper_N[worst] : q->lower_N[worst]);
        n++;
    }
    return n;
}

static hf_status look(feasible *q, const hf_problem_source *source, char advice[HF_FEASIBLE_ADVICE_SIZE],
                      hf_messages *messages)
{
    double amount_N;
    set_tensions(q);
    if (q->p->settings.form.prestress == HF_PRESTRESS_EXACT) HF_TRY(advise(q, source, advice));
    set_ranges(q);
    if (report_given(q, messages) > 0) return HF_OK;
    HF_TRY(solve_all(q, &amount_N));
    if (amount_N <= MISSED * q->p->model.reference_N) return HF_OK;
    return report(q, amount_N, advice, messages);
}

hf_status hf_feasible_check_bounds(const hf_problem *p, const hf_problem_source *source, int n_bound,
                                   const hf_feasible_bound *bound, char advice[HF_FEASIBLE_ADVICE_SIZE],
                                   hf_messages *messages)
{
    feasible q;
    *advice = '\0';
    if (meets(n_bound, bound, p->workspace.tension_N)) return HF_OK;
    hf_status status = create(p, n_bound, bound, &q);
    if (status == HF_OK) status = look(&q, source, advice, messages);
    hf_arena_free_block(q.block);
    if (status == HF_NO_MEMORY) return hf_error(messages, status, "out of memory for the limits on tensions");
    return HF_OK;
}

/* Warns about rows on facets that the target shape misses: its facets are too large. */
static hf_status check_facets(const hf_problem *p, hf_messages *messages)
{
    const hf_facet_shape target = {.position_m = p->scene.position_m};
    hf_surface_measures m = {.facet_half_path_rms_m = NAN};
    for (int i = 0; i < p->settings.n_requirement; i++) {
        const hf_requirement_settings *r = &p->settings.requirement[i];
        char place[HF_LOCATION_SIZE];
        if (r->figure != HF_REQUIRED_FACETS || isnan(r->at_most) || p->facets.n_facet == 0) continue;
        if (isnan(m.facet_half_path_rms_m)) HF_TRY(hf_facet_measure(&p->surface, &p->facets, &target, &m));
        double rms_m = r->feed == HF_REFOCUSED ? m.facet_fit_half_path_rms_m : m.facet_half_path_rms_m;
        if (!(rms_m > r->at_most)) continue;
        char more[64] = "";
        if (r->at_most > 0)
            snprintf(more, sizeof more, "Use about %.0f facets instead of %d, or loosen",
                     ceil(p->facets.n_facet * rms_m / r->at_most), p->facets.n_facet);
        hf_warning(
            messages,
            "%s: at the target positions, the facets already have %.4g mm, and the bound is %.4g mm. %s the bound",
            hf_config_place(&p->settings, place, "requirements.%d", i), rms_m * 1e3, r->at_most * 1e3,
            *more ? more : "Loosen");
    }
    return HF_OK;
}

hf_status hf_feasible_check(const hf_problem *p, const hf_problem_source *source, char advice[HF_FEASIBLE_ADVICE_SIZE],
                            hf_messages *messages)
{
    hf_feasible_bound bound[HF_FEASIBLE_BOUNDS_MAX];
    hf_required required = {0};
    hf_material masses = {0};
    hf_status status = hf_requirements_stage_rows(p, &masses, &required, messages);
    if (status == HF_OK)
        status = hf_feasible_check_bounds(p, source, add_required(&required, list_bounds(p, bound), bound), bound,
                                          advice, messages);
    hf_required_free(&required);
    hf_material_free(&masses);
    if (status == HF_OK && check_facets(p, messages) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for the surface errors");
    return status;
}
