/* Contents: start - forces and lengths at twice the precision - sums at nodes - steps near a measured shape -
 * refinement. Forces are measured at twice the precision once before and once after a move; the steps of which it
 * consists compute differences in doubles. */
#include "solve/refine.h"

#include "linalg/band.h"
#include "solve/newton_matrix.h"
#include "solve/refine_kernel.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#define STEPS_MAX 12       /* steps with one matrix; a found shape takes two to four */
#define NEAR_ENOUGH 1e-12  /* part of the errors of the measured shape at which steps end; 1e-15 would be rounding */
#define MOVES_MAX 4        /* with one matrix; a found shape takes one or two */
#define MATRICES_MAX 2     /* matrices of its own, for shapes far from balance and cables taken for slack or taut */
#define ENOUGH 1e-11       /* part of the errors of the found shape at which refinement ends ... */
#define FINEST 1e-28       /* ... or errors at which it does; twice the precision leaves 1e-30 */
#define CONTRACTED 1e-18   /* errors that are not below it are taken for divergence; the proof does not rely on it */
#define SHARE_OF_GUESS 0.1 /* part of the estimate of the least eigenvalue that is tried first */

/* ---- start ---- */

static_assert(sizeof(hf_refined_cable) == HF_BOUND_CABLE_ITEMS * sizeof(double), "HF_BOUND_CABLE_ITEMS");

/* Starts from the tensions in the workspace, and from what its matrix takes for taut. */
static void set_first_state(hf_refined *p)
{
    for (int e = 0; e < p->m->n_cable; e++) {
        hf_refined_cable *c = p->cable + e;
        hf_law_cable cable = hf_workspace_cable(p->m, p->w, e);
        c->T = (hf_twofold){0, 0};
        c->along = 0;
        c->is_taut = 1;
        if (hf_refine_is_fixed(p->m, e) || !hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER)) continue;
        double u[3], T = p->w->tension_N[e], length = hf_newton_matrix_direction(p->m, p->w->position_m, e, u);
        c->along = hf_newton_matrix_stiffness(cable, length, T);
        c->is_taut = c->along > 0;
        if (c->is_taut > 0) c->T = hf_twofold_of(T);
    }
}

void hf_refine_open(const hf_model *m, hf_workspace *w, double condition, hf_refined *p)
{
    size_t n_node = (size_t)m->n_node, n_free = (size_t)m->n_free;
    *p = (hf_refined){
        .m = m, .w = w, .cable = (hf_refined_cable *)w->bound_work, .condition = condition, .wanted = INFINITY};
    p->x = (hf_twofold *)(p->cable + m->n_cable);
    p->force = p->x + 3 * n_node;
    p->move = (double *)(p->force + 3 * n_free);
    p->step = p->move + 3 * n_free;
    p->near_N = p->step + 3 * n_free;
    p->sum = p->near_N + 3 * n_free;
    for (size_t i = 0; i < 3 * n_node; i++)
        p->x[i] = hf_twofold_of(w->position_m[i]);
    set_first_state(p);
}

/* ---- forces and lengths at twice the precision ---- */

static hf_refine_measure *measure_here(void)
{
    static hf_refine_measure *const of_isa[HF_LANE_N_ISA] = {hf_refine_measure_portable, hf_refine_measure_avx2,
                                                             hf_refine_measure_avx512};
    return of_isa[hf_lane_best_isa()];
}

/* Puts cable e into a lane. */
static void put_cable(const hf_refined *p, int e, hf_refine_lanes *l, int k)
{
    const hf_refined_cable *c = p->cable + e;
    const int *end = p->m->end_row + 2 * e;
    hf_law_cable cable = hf_workspace_cable(p->m, p->w, e);
    bool is_given = hf_law_has(cable.law, HF_LAW_GIVES_TENSION), is_elastic = hf_law_has(cable.law, HF_LAW_NEEDS_EA);
    for (int i = 0; i < 3; i++) {
        const hf_twofold *x = p->x + (size_t)i * (size_t)p->m->n_node;
        l->from[i][0][k] = x[end[0]].hi;
        l->from[i][1][k] = x[end[0]].lo;
        l->to[i][0][k] = x[end[1]].hi;
        l->to[i][1][k] = x[end[1]].lo;
    }
    l->T[0][k] = is_given ? cable.target : c->T.hi;
    l->T[1][k] = is_given ? 0 : c->T.lo;
    l->target[k] = cable.target;
    l->EA[k] = is_elastic ? cable.EA_N : 1;
    l->is_spring[k] = hf_newton_matrix_is_spring(cable.law);
    l->is_elastic[k] = is_elastic;
    l->is_slack[k] = !(c->is_taut > 0);
}

/* Takes the measures of cable e from its lane, and adds its pull to the forces. Returns the error of length of a taut
 * cable with a multiplier, over its theoretical length. */
static double take_cable(hf_refined *p, int e, const hf_refine_lanes *l, int k)
{
    hf_refined_cable *c = p->cable + e;
    int a = p->m->end_row[2 * e], b = p->m->end_row[2 * e + 1];
    c->length = l->length[k];
    c->across = l->q[k];
    for (int i = 0; i < 3; i++) {
        hf_twofold pull = {l->pull[i][0][k], l->pull[i][1][k]};
        c->unit[i] = l->unit[i][k];
        if (a < p->m->n_free) hf_twofold_add_to(p->force + 3 * a + i, pull);
        if (b < p->m->n_free) hf_twofold_add_to(p->force + 3 * b + i, hf_twofold_minus(pull));
    }
    if (!hf_law_has((hf_law)p->w->law[e], HF_LAW_HAS_MULTIPLIER)) return 0;
    c->over = (hf_twofold){l->over[0][k], l->over[1][k]};
    return c->is_taut > 0 ? fabs(c->over.hi) / p->m->length_m[e] : 0;
}

/* Sets the forces out of balance, and length, unit, over and across of the cables. by_law: elastic cables pull with
 * what their law gives at their length, else with the multiplier. Returns the largest error, relative to the reference
 * tension and the theoretical lengths. */
static double measure_refined(hf_refined *p, bool by_law)
{
    const hf_model *m = p->m;
    double largest = 0;
    for (int i = 0; i < 3 * m->n_free; i++)
        p->force[i] = hf_twofold_of(m->load_N ? m->load_N[i % 3 * m->n_node + i / 3] : 0);
    int e = 0, kept[HF_LANES];
    hf_refine_lanes lanes;
    memset(&lanes, 0, sizeof lanes);
    for (int k = 0; k < HF_LANES; k++)
        lanes.to[0][0][k] = lanes.target[k] = lanes.EA[k] = 1;
    while (e < m->n_cable) {
        int n = 0;
        for (; e < m->n_cable && n < HF_LANES; e++) {
            if (hf_refine_is_fixed(m, e)) continue;
            kept[n] = e;
            put_cable(p, e, &lanes, n++);
        }
        measure_here()(&lanes, by_law);
        for (int k = 0; k < n; k++)
            largest = fmax(largest, take_cable(p, kept[k], &lanes, k));
    }
    for (int i = 0; i < 3 * m->n_free; i++) {
        double error = fabs(p->force[i].hi) / m->reference_N;
        if (!(error <= largest)) largest = error; /* keeps a NaN */
    }
    return largest;
}

/* ---- sums at nodes ---- */

/* Largest sum of a figure of the cables at a free node. */
double hf_refine_largest_sum(const hf_refined *p, hf_refined_figure *figure)
{
    double largest = 0;
    memset(p->sum, 0, (size_t)p->m->n_free * sizeof *p->sum);
    for (int e = 0; e < p->m->n_cable; e++) {
        if (hf_refine_is_fixed(p->m, e) || !(p->cable[e].is_taut > 0)) continue;
        double value = figure(p, e);
        for (int k = 2 * e; k < 2 * e + 2; k++)
            if (p->m->end_row[k] < p->m->n_free) p->sum[p->m->end_row[k]] += value;
    }
    for (int i = 0; i < p->m->n_free; i++)
        largest = fmax(largest, p->sum[i]);
    return largest;
}

/* Of the matrix that is factored, whose norm is at least as large as the largest sum. */
static double matrix_sum(const hf_refined *p, int e)
{
    return p->cable[e].along + p->cable[e].across;
}

/* ---- steps near a measured shape ---- */

/* Sets near_N and near_over after move and change, from what was measured before them. Differences alone are computed,
 * so that errors are relative to the moves. Returns the largest error, as measure_refined does. */
static double measure_near(hf_refined *p)
{
    const hf_model *m = p->m;
    double largest = 0;
    for (int i = 0; i < 3 * m->n_free; i++)
        p->near_N[i] = p->force[i].hi;
    for (int e = 0; e < m->n_cable; e++) {
        hf_refined_cable *c = p->cable + e;
        if (hf_refine_is_fixed(m, e) || !(c->is_taut > 0)) continue;
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        hf_law_cable cable = hf_workspace_cable(m, p->w, e);
        double d[3], more[3], square = 0, change = 0, pull[3], T = c->across * c->length;
        for (int k = 0; k < 3; k++) {
            d[k] = c->length * c->unit[k];
            more[k] = (b < m->n_free ? p->move[3 * b + k] : 0) - (a < m->n_free ? p->move[3 * a + k] : 0);
            change += (2 * d[k] + more[k]) * more[k];
            square += (d[k] + more[k]) * (d[k] + more[k]);
        }
        double length = sqrt(square), longer = change / (length + c->length);
        for (int k = 0; k < 3; k++)
            pull[k] = hf_newton_matrix_is_spring(cable.law)
                          ? c->across * more[k]
                          : (T * (more[k] - c->unit[k] * longer) + c->change * (d[k] + more[k])) / length;
        hf_newton_matrix_add_pull(m, p->w, e, pull, p->near_N);
        if (!hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER)) continue;
        c->near_over = c->over.hi + longer - c->change / hf_law_stiffness_N_per_m(cable, INFINITY);
        largest = fmax(largest, fabs(c->near_over) / cable.theoretical_m);
    }
    for (int i = 0; i < 3 * m->n_free; i++) {
        double error = fabs(p->near_N[i]) / m->reference_N;
        if (!(error <= largest)) largest = error; /* keeps a NaN */
    }
    return largest;
}

static void solve_for_step(hf_refined *p)
{
    const hf_model *m = p->m;
    if (m->has_newton) {
        hf_newton_matrix_solve(m, p->w, p->step);
        return;
    }
    double *b = p->w->certificate_work;
    for (int i = 0; i < 3 * m->n_free; i++)
        b[i % 3 * m->n_node + i / 3] = p->step[i];
    hf_band_back_solve(m->n_free, m->half_bandwidth, 3, p->w->band, b, m->n_node);
    for (int i = 0; i < 3 * m->n_free; i++)
        p->step[i] = b[i % 3 * m->n_node + i / 3];
}

/* The Newton step (M8) with the matrix that is factored: step, and last of the cables. */
static void find_refinement(hf_refined *p)
{
    const hf_model *m = p->m;
    memcpy(p->step, p->near_N, 3 * (size_t)m->n_free * sizeof *p->step);
    for (int pass = 0; pass < 2; pass++) {
        for (int e = 0; e < m->n_cable; e++) {
            hf_refined_cable *c = p->cable + e;
            if (!(c->along > 0)) continue;
            int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
            double longer = c->near_over, pull[3];
            for (int k = 0; k < 3 && pass; k++)
                longer +=
                    c->unit[k] * ((b < m->n_free ? p->step[3 * b + k] : 0) - (a < m->n_free ? p->step[3 * a + k] : 0));
            c->last = c->along * longer;
            for (int k = 0; k < 3; k++)
                pull[k] = c->last * c->unit[k];
            if (!pass) hf_newton_matrix_add_pull(m, p->w, e, pull, p->step);
        }
        if (!pass) solve_for_step(p);
    }
}

static void add_step(hf_refined *p, double part)
{
    for (int i = 0; i < 3 * p->m->n_free; i++)
        p->move[i] += part * p->step[i];
    for (int e = 0; e < p->m->n_cable; e++)
        p->cable[e].change += part * p->cable[e].last;
}

/* Takes steps from the measured shape, whose errors are `first`, while each halves the errors: move, and change of the
 * cables. */
static void find_move(hf_refined *p, double first)
{
    memset(p->move, 0, 3 * (size_t)p->m->n_free * sizeof *p->move);
    for (int i = 0; i < 3 * p->m->n_free; i++)
        p->near_N[i] = p->force[i].hi;
    for (int e = 0; e < p->m->n_cable; e++) {
        p->cable[e].change = p->cable[e].last = 0;
        p->cable[e].near_over = p->cable[e].over.hi;
    }
    double now = first, before = INFINITY;
    for (int k = 0; k < STEPS_MAX && now < before / 2 && now > NEAR_ENOUGH * first; k++) {
        find_refinement(p);
        add_step(p, 1);
        before = now;
        now = measure_near(p);
        if (!(now < before)) add_step(p, -1); /* which ends the loop */
    }
}

/* ---- refinement ---- */

static void apply_move(hf_refined *p, double part)
{
    const hf_model *m = p->m;
    for (int i = 0; i < 3 * m->n_free; i++)
        hf_twofold_add_to(p->x + i % 3 * m->n_node + i / 3, hf_twofold_of(part * p->move[i]));
    for (int e = 0; e < m->n_cable; e++)
        if (p->cable[e].along > 0) hf_twofold_add_to(&p->cable[e].T, hf_twofold_of(part * p->cable[e].change));
}

/* Moves while each move halves the errors. Returns the errors at the end, where the forces are by law. */
static double refine(hf_refined *p)
{
    double now = measure_refined(p, false), before = INFINITY;
    p->wanted = fmax(fmin(fmin(ENOUGH * now, p->wanted), CONTRACTED), FINEST);
    for (int k = 0; k < MOVES_MAX && now > p->wanted && now < before / 2; k++) {
        find_move(p, now);
        apply_move(p, 1);
        before = now;
        now = measure_refined(p, false);
        if (now < before) continue;
        apply_move(p, -1);
        measure_refined(p, false);
    }
    if (p->m->EA_N) measure_refined(p, true);
    return now < before ? now : before;
}

void hf_refine_block(const hf_model *m, const hf_workspace *w, int e, double block[3][3])
{
    const hf_refined_cable *c = (const hf_refined_cable *)w->bound_work + e;
    (void)m;
    hf_newton_matrix_spring(c->along, fmax(c->across, 0), c->unit, block);
}

/* Decides which cables are taut, as interior.c does, and factors the matrix of the refined shape. */
static bool factor_anew(hf_refined *p)
{
    const hf_model *m = p->m;
    if (!m->has_newton) return false;
    for (int e = 0; e < m->n_cable; e++) {
        hf_refined_cable *c = p->cable + e;
        hf_law_cable cable = hf_workspace_cable(m, p->w, e);
        if (hf_refine_is_fixed(m, e)) continue;
        bool multiplier = hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER);
        if (multiplier) {
            c->is_taut = c->T.hi / m->reference_N + c->over.hi / cable.theoretical_m > 0;
            if (!(c->is_taut > 0)) c->T = (hf_twofold){0, 0};
        }
        c->along = c->is_taut > 0 ? hf_law_stiffness_N_per_m(cable, INFINITY) : 0;
        if (multiplier && isinf(c->along)) c->along = hf_newton_matrix_rigid_stiffness(m, e, c->T.hi);
    }
    bool is_factored = hf_newton_matrix_factor_blocks(m, p->w, hf_refine_block, NULL, &p->condition) == HF_OK;
    for (int e = 0; e < m->n_cable; e++) /* from here on `along` is of cables with a multiplier alone */
        if (!hf_law_has((hf_law)p->w->law[e], HF_LAW_HAS_MULTIPLIER)) p->cable[e].along = 0;
    return is_factored;
}

double hf_refine_guess(const hf_refined *p)
{
    return SHARE_OF_GUESS * hf_refine_largest_sum(p, matrix_sum) / p->condition;
}

static bool is_told_apart(const hf_refined *p)
{
    for (int e = 0; e < p->m->n_cable; e++) {
        const hf_refined_cable *c = p->cable + e;
        if (hf_refine_is_fixed(p->m, e) || !hf_law_has((hf_law)p->w->law[e], HF_LAW_HAS_MULTIPLIER)) continue;
        if (c->is_taut > 0 ? !(c->T.hi > 0) : !(c->over.hi < 0)) return false;
    }
    return true;
}

hf_bound_reason hf_refine_approach(hf_refined *p, bool has_factor)
{
    hf_bound_reason reason = HF_BOUND_NOT_CONTRACTING;
    if (!has_factor) measure_refined(p, false);
    for (int k = has_factor ? 0 : 1; k <= MATRICES_MAX; k++) {
        p->is_first_matrix = k == 0;
        if (k > 0 && !factor_anew(p)) return k == 1 && !has_factor ? HF_BOUND_NOT_DEFINITE : reason;
        double error = refine(p);
        reason = !(error < CONTRACTED) ? HF_BOUND_NOT_CONTRACTING
                 : is_told_apart(p)    ? HF_BOUND_PROVEN
                                       : HF_BOUND_SLACK_OR_TAUT;
        if (reason == HF_BOUND_PROVEN && error <= p->wanted) break;
    }
    return reason;
}
