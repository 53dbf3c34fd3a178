/* Computes the equilibrium near a found shape at twice the precision. certificate.c certifies its bounds at this
 * precise shape.
 *
 *     shape, tensions and factored matrix in the workspace
 *         | start: cables taut or slack, s of the truss from the pull on it
 *         v
 *     measure forces and lengths at twice the precision  <------------------+
 *         | Newton steps (M8) with one matrix; differences in doubles       |
 *         | suffice near a measured shape                                   |
 *         v                                                                 |
 *     move = sum of the steps, added at twice the precision  ---------------+
 *         | the errors are small enough, or no move halves them any more
 *         v
 *     HF_BOUND_CERTIFIED; else factor the matrix again at the precise shape and repeat */
#include "solve/precise.h"

#include "linalg/band.h"
#include "linalg/dot.h"
#include "solve/coupling.h"
#include "solve/joint.h"
#include "solve/precise_kernel.h"
#include "solve/schur.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#define STEPS_MAX 12       /* steps in one move; a found shape takes two to four */
#define NEAR_ENOUGH 1e-12  /* part of the measured errors at which the steps end; 1e-15 would be rounding */
#define MOVES_MAX 4        /* moves with one matrix; a found shape takes one or two */
#define MATRICES_MAX 2     /* matrices factored here: far from balance, or a cable taken wrongly for slack or taut */
#define ENOUGH 1e-11       /* target of the errors: this part of those of the found shape */
#define FINEST 1e-28       /* minimum target of the errors; twice the precision reaches 1e-30 */
#define CONTRACTED 1e-18   /* maximum target of the errors; more is divergence; the certificate does not rely on it */
#define SHARE_OF_GUESS 0.1 /* part of the estimated minimum eigenvalue that is tried first */

/* ---- start ---- */

static_assert(sizeof(hf_precise_cable) == HF_BOUND_CABLE_ITEMS * sizeof(double), "HF_BOUND_CABLE_ITEMS");

/* Starts from the tensions in the workspace. A cable with a multiplier is taut if its matrix has stiffness along it. */
static void set_first_state(hf_precise *p)
{
    for (int e = 0; e < p->m->n_cable; e++) {
        hf_precise_cable *c = p->cable + e;
        hf_law_cable cable = hf_workspace_cable(p->m, p->w, e);
        c->T = (hf_twofold){0, 0};
        c->along = 0;
        c->is_taut = 1;
        if (hf_precise_is_fixed(p->m, e) || !hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER)) continue;
        double u[3], T = p->w->tension_N[e], length = hf_newton_matrix_direction(p->m, p->w->position_m, e, u);
        c->along = hf_newton_matrix_stiffness(cable, length, T);
        c->is_taut = c->along > 0;
        if (c->is_taut > 0) c->T = hf_twofold_of(T);
    }
}

/* Sets the precise positions of the attachments: position at rest + L s + rest_m. */
static void place_attachments(hf_precise *p)
{
    const hf_model *m = p->m;
    const hf_precise_truss *t = &p->truss;
    for (int i = 0; i < 3 * m->n_attachment; i++) {
        int at = i % 3 * m->n_node + m->attachment_row[i / 3];
        hf_twofold r = hf_twofold_add(hf_flexibility_displace_twofold(&t->flexibility, t->s, i), t->rest_m[i]);
        p->x[at] = hf_twofold_add(hf_twofold_of(hf_joint_resting_m(m, p->w, at)), r);
    }
}

/* Sets gap and rest_m for the pull on the attachments in `force`. */
static void measure_truss(hf_precise *p)
{
    hf_precise_truss *t = &p->truss;
    const hf_twofold *pull = p->force + 3 * p->m->n_free;
    for (int k = 0; k < t->flexibility.rank; k++)
        t->gap[k] = hf_flexibility_load_twofold(&t->flexibility, pull, k);
    for (int i = 0; i < t->flexibility.n; i++)
        t->rest_m[i] = hf_twofold_subtract(hf_flexibility_row_twofold(p->m, pull, i),
                                           hf_flexibility_displace_twofold(&t->flexibility, t->gap, i));
    for (int k = 0; k < t->flexibility.rank; k++) {
        t->gap[k] = hf_twofold_subtract(t->gap[k], t->s[k]);
        t->near_gap[k] = t->gap[k].hi;
    }
}

/* Lays out the arrays of the truss in `room` and starts from the displacements under the pull of the found shape.
 * Returns false if the flexibility of the truss has a negative eigenvalue. */
static bool open_truss(hf_precise *p, double *room)
{
    const hf_model *m = p->m;
    hf_precise_truss *t = &p->truss;
    size_t n = 3 * (size_t)m->n_attachment;
    if (n == 0) return true;
    t->s = (hf_twofold *)room;
    t->gap = t->s + n;
    t->rest_m = t->gap + n;
    t->move = (double *)(t->rest_m + n);
    t->step = t->move + n;
    t->near_gap = t->step + n;
    t->flexibility.root = t->near_gap + n;
    t->flexibility.factor = t->flexibility.root + n * n;
    t->flexibility.window = t->flexibility.factor + n * n;
    if (!hf_flexibility_factor(m, &t->flexibility)) return false;
    hf_coupling_forces(m, p->w);
    for (size_t i = 0; i < n; i++) {
        p->force[3 * (size_t)m->n_free + i] = hf_twofold_of(p->w->attachment_force_N[i]);
        t->s[i] = (hf_twofold){0, 0};
    }
    measure_truss(p);
    memcpy(t->s, t->gap, (size_t)t->flexibility.rank * sizeof *t->s);
    place_attachments(p);
    return true;
}

bool hf_precise_open(const hf_model *m, hf_workspace *w, double condition, hf_precise *p)
{
    size_t n_node = (size_t)m->n_node, n_moving = (size_t)(m->n_free + m->n_attachment);
    *p = (hf_precise){.m = m, .w = w, .n_moving = (int)n_moving, .condition = condition, .wanted = INFINITY};
    p->cable = (hf_precise_cable *)w->bound_work;
    p->x = (hf_twofold *)(p->cable + m->n_cable);
    p->force = p->x + 3 * n_node;
    p->move = (double *)(p->force + 3 * n_moving);
    p->step = p->move + 3 * n_moving;
    p->near_N = p->step + 3 * n_moving;
    p->sum = p->near_N + 3 * n_moving;
    for (size_t i = 0; i < 3 * n_node; i++)
        p->x[i] = hf_twofold_of(w->position_m[i]);
    set_first_state(p);
    return open_truss(p, p->sum + n_moving);
}

/* ---- forces and lengths at twice the precision ---- */

/* Returns the larger of the two, or `next` if it is NaN. */
static double larger(double now, double next)
{
    return next <= now ? now : next;
}

static hf_precise_measure *const measure_of_isa[] = {HF_LANE_EACH(hf_precise_measure)};

/* Copies cable e into lane k. */
static void put_cable(const hf_precise *p, int e, hf_precise_lanes *l, int k)
{
    const hf_precise_cable *c = p->cable + e;
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

/* Copies the measures of cable e from lane k and adds its pull to the forces. Returns the length error of a taut cable
 * with a multiplier, relative to its length at the target positions, else 0. */
static double take_cable(hf_precise *p, int e, const hf_precise_lanes *l, int k)
{
    hf_precise_cable *c = p->cable + e;
    int a = p->m->end_row[2 * e], b = p->m->end_row[2 * e + 1];
    c->length = l->length[k];
    c->across = l->q[k];
    for (int i = 0; i < 3; i++) {
        hf_twofold pull = {l->pull[i][0][k], l->pull[i][1][k]};
        c->unit[i] = l->unit[i][k];
        if (a < p->n_moving) hf_twofold_add_to(p->force + 3 * a + i, pull);
        if (b < p->n_moving) hf_twofold_add_to(p->force + 3 * b + i, hf_twofold_minus(pull));
    }
    if (!hf_law_has((hf_law)p->w->law[e], HF_LAW_HAS_MULTIPLIER)) return 0;
    c->over = (hf_twofold){l->over[0][k], l->over[1][k]};
    return c->is_taut > 0 ? fabs(c->over.hi) / p->m->length_m[e] : 0;
}

/* Returns the maximum component of the displacements L near_gap, relative to the mean length; 0 without a truss. */
static double gap_error(const hf_precise *p)
{
    double largest = 0, *r = p->w->coupling_work;
    if (!p->m->n_attachment) return 0;
    hf_flexibility_displace(&p->truss.flexibility, p->truss.near_gap, r);
    for (int i = 0; i < 3 * p->m->n_attachment; i++)
        largest = larger(largest, fabs(r[i]));
    return largest / hf_joint_mean_length_m(p->m);
}

/* Sets the forces, the gaps, and length, unit, over and across of the cables. With by_law, elastic cables pull with the
 * tension that their law gives at their length, else with the multiplier. Returns the maximum error, relative to the
 * reference tension and the lengths at the target positions. */
static double measure_precise(hf_precise *p, bool by_law)
{
    const hf_model *m = p->m;
    double largest = 0;
    for (int i = 0; i < 3 * p->n_moving; i++)
        p->force[i] = hf_twofold_of(m->load_N ? m->load_N[i % 3 * m->n_node + i / 3] : 0);
    int e = 0, kept[HF_LANES];
    hf_precise_lanes lanes;
    memset(&lanes, 0, sizeof lanes);
    for (int k = 0; k < HF_LANES; k++)
        lanes.to[0][0][k] = lanes.target[k] = lanes.EA[k] = 1;
    while (e < m->n_cable) {
        int n = 0;
        for (; e < m->n_cable && n < HF_LANES; e++) {
            if (hf_precise_is_fixed(m, e)) continue;
            kept[n] = e;
            put_cable(p, e, &lanes, n++);
        }
        measure_of_isa[hf_lane_best_isa()](&lanes, by_law);
        for (int k = 0; k < n; k++)
            largest = fmax(largest, take_cable(p, kept[k], &lanes, k));
    }
    measure_truss(p);
    largest = fmax(largest, gap_error(p));
    for (int i = 0; i < 3 * m->n_free; i++)
        largest = larger(largest, fabs(p->force[i].hi) / m->reference_N);
    return largest;
}

/* ---- sums at nodes ---- */

double hf_precise_largest_sum(const hf_precise *p, hf_precise_figure *figure)
{
    double largest = 0;
    memset(p->sum, 0, (size_t)p->n_moving * sizeof *p->sum);
    for (int e = 0; e < p->m->n_cable; e++) {
        if (hf_precise_is_fixed(p->m, e) || !(p->cable[e].is_taut > 0)) continue;
        double value = figure(p, e);
        for (int k = 2 * e; k < 2 * e + 2; k++)
            if (p->m->end_row[k] < p->n_moving) p->sum[p->m->end_row[k]] += value;
    }
    for (int i = 0; i < p->n_moving; i++)
        largest = fmax(largest, p->sum[i]);
    return largest;
}

double hf_precise_matrix_sum(const hf_precise *p, int e)
{
    return p->cable[e].along + p->cable[e].across;
}

/* ---- steps near a measured shape ---- */

/* Sets near_N to the measured forces. For attachments only the change matters, which a double holds, so they start at
 * 0. */
static void begin_near(hf_precise *p)
{
    for (int i = 0; i < 3 * p->n_moving; i++)
        p->near_N[i] = i < 3 * p->m->n_free ? p->force[i].hi : 0;
}

/* Sets near_N, near_gap and near_over after move and change, relative to the last measurement. It computes only
 * differences, so rounding errors are relative to the moves. Returns the maximum error, as measure_precise does. */
static double measure_near(hf_precise *p)
{
    const hf_model *m = p->m;
    hf_precise_truss *t = &p->truss;
    double largest = 0;
    begin_near(p);
    for (int e = 0; e < m->n_cable; e++) {
        hf_precise_cable *c = p->cable + e;
        if (hf_precise_is_fixed(m, e) || !(c->is_taut > 0)) continue;
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        hf_law_cable cable = hf_workspace_cable(m, p->w, e);
        double d[3], more[3], square = 0, change = 0, pull[3], T = c->across * c->length;
        for (int k = 0; k < 3; k++) {
            d[k] = c->length * c->unit[k];
            more[k] = (b < p->n_moving ? p->move[3 * b + k] : 0) - (a < p->n_moving ? p->move[3 * a + k] : 0);
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
        largest = fmax(largest, fabs(c->near_over) / cable.length_at_target_m);
    }
    hf_flexibility_load(&t->flexibility, p->near_N + 3 * m->n_free, t->near_gap);
    for (int k = 0; k < t->flexibility.rank; k++)
        t->near_gap[k] += t->gap[k].hi - t->move[k];
    largest = fmax(largest, gap_error(p));
    for (int i = 0; i < 3 * m->n_free; i++)
        largest = larger(largest, fabs(p->near_N[i]) / m->reference_N);
    return largest;
}

/* Replaces the forces v [3 n_free] by the step of the free nodes while the attachments stay. */
static void solve_free(const hf_precise *p, double *v)
{
    const hf_model *m = p->m;
    if (m->has_newton) {
        hf_newton_matrix_solve(m, p->w, NULL, 1, v);
        return;
    }
    double *b = p->w->certificate_work;
    for (int i = 0; i < 3 * m->n_free; i++)
        b[i % 3 * m->n_node + i / 3] = v[i];
    hf_band_back_solve(m->n_free, m->half_bandwidth, 3, p->w->band, b, m->n_node);
    for (int i = 0; i < 3 * m->n_free; i++)
        v[i] = b[i % 3 * m->n_node + i / 3];
}

/* Completes the factor of the matrix with the rows of the truss. With is_first it is that of hf_newton_certify, or that
 * of D, else that at the precise shape. Returns false if there is none. */
static bool factor_truss(hf_precise *p, bool is_first)
{
    hf_newton_block *block_of = p->truss.block_of = is_first ? hf_newton_matrix_block : hf_precise_block;
    if (is_first && p->m->has_newton) return hf_flexibility_factor_schur(p->m, p->w, &p->truss.flexibility);
    return hf_flexibility_factor_net(p->m, p->w, block_of, NULL, 1, &p->truss.flexibility);
}

/* Replaces the forces in `step` by the step. Let p be the pull on the attachments after the step of the free nodes
 * alone, and S the stiffness (M15). The step of the truss is then d_s = (1 + L' S L)^-1 (gap + L' p), which is (M24)
 * for the unknowns s. */
static void solve_for_step(hf_precise *p)
{
    const hf_model *m = p->m;
    hf_precise_truss *t = &p->truss;
    int n_free = 3 * m->n_free, rank = t->flexibility.rank;
    double *at_attachment = p->step + n_free, *answer = p->w->force_N;
    solve_free(p, p->step);
    if (!m->n_attachment) return;
    hf_schur_pull(m, p->w, t->block_of, p->step, at_attachment);
    hf_flexibility_load(&t->flexibility, at_attachment, t->step);
    hf_add((size_t)rank, 1, t->near_gap, t->step);
    if (rank) hf_band_back_solve(rank, rank - 1, 1, t->flexibility.factor, t->step, rank);
    hf_flexibility_displace(&t->flexibility, t->step, at_attachment);
    memset(answer, 0, (size_t)n_free * sizeof *answer);
    hf_schur_push(m, p->w, t->block_of, at_attachment, answer);
    solve_free(p, answer);
    hf_add((size_t)n_free, 1, answer, p->step);
}

/* Sets `step`, the step of the truss, and `last` of the cables to the Newton step (M8) with the factored matrix. The
 * first pass adds the effect of the length errors to the forces and solves. The second pass computes the changes of
 * T. */
static void find_refinement(hf_precise *p)
{
    const hf_model *m = p->m;
    memcpy(p->step, p->near_N, 3 * (size_t)m->n_free * sizeof *p->step);
    memset(p->step + 3 * m->n_free, 0, 3 * (size_t)m->n_attachment * sizeof *p->step);
    for (int pass = 0; pass < 2; pass++) {
        for (int e = 0; e < m->n_cable; e++) {
            hf_precise_cable *c = p->cable + e;
            if (!(c->along > 0)) continue;
            int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
            double longer = c->near_over, pull[3];
            for (int k = 0; k < 3 && pass; k++)
                longer += c->unit[k] *
                          ((b < p->n_moving ? p->step[3 * b + k] : 0) - (a < p->n_moving ? p->step[3 * a + k] : 0));
            c->last = c->along * longer;
            for (int k = 0; k < 3; k++)
                pull[k] = c->last * c->unit[k];
            if (!pass) hf_newton_matrix_add_pull(m, p->w, e, pull, p->step);
        }
        if (!pass) solve_for_step(p);
    }
}

static void add_step(hf_precise *p, double part)
{
    hf_add(3 * (size_t)p->n_moving, part, p->step, p->move);
    hf_add((size_t)p->truss.flexibility.rank, part, p->truss.step, p->truss.move);
    for (int e = 0; e < p->m->n_cable; e++)
        p->cable[e].change += part * p->cable[e].last;
}

/* Sets `move`, the move of the truss and `change` of the cables: the sum of steps from the measured shape, whose
 * maximum error is `first`. It takes steps while each halves the errors. */
static void find_move(hf_precise *p, double first)
{
    memset(p->move, 0, 3 * (size_t)p->n_moving * sizeof *p->move);
    for (int k = 0; k < p->truss.flexibility.rank; k++) {
        p->truss.move[k] = 0;
        p->truss.near_gap[k] = p->truss.gap[k].hi;
    }
    begin_near(p);
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
        if (!(now < before)) add_step(p, -1); /* this ends the loop */
    }
}

/* ---- moves ---- */

static void apply_move(hf_precise *p, double part)
{
    const hf_model *m = p->m;
    for (int i = 0; i < 3 * m->n_free; i++)
        hf_twofold_add_to(p->x + i % 3 * m->n_node + i / 3, hf_twofold_of(part * p->move[i]));
    for (int e = 0; e < m->n_cable; e++)
        if (p->cable[e].along > 0) hf_twofold_add_to(&p->cable[e].T, hf_twofold_of(part * p->cable[e].change));
    for (int k = 0; k < p->truss.flexibility.rank; k++)
        hf_twofold_add_to(&p->truss.s[k], hf_twofold_of(part * p->truss.move[k]));
    place_attachments(p);
}

/* Applies moves while each halves the errors. Returns the maximum error. The forces at the end have elastic cables at
 * the tension of their law. */
static double correct(hf_precise *p)
{
    double now = measure_precise(p, false), before = INFINITY;
    p->wanted = fmax(fmin(fmin(ENOUGH * now, p->wanted), CONTRACTED), FINEST);
    for (int k = 0; k < MOVES_MAX && now > p->wanted && now < before / 2; k++) {
        find_move(p, now);
        apply_move(p, 1);
        before = now;
        now = measure_precise(p, false);
        if (now < before) continue;
        apply_move(p, -1);
        measure_precise(p, false);
    }
    if (p->m->EA_N) measure_precise(p, true);
    return now < before ? now : before;
}

void hf_precise_block(const hf_model *m, const hf_workspace *w, int e, double block[3][3])
{
    const hf_precise_cable *c = (const hf_precise_cable *)w->bound_work + e;
    double across = fmax(c->across, 0);
    bool is_spring = hf_newton_matrix_is_spring((hf_law)w->law[e]);
    (void)m;
    hf_newton_matrix_spring(is_spring ? across : c->along, across, c->unit, block);
}

/* Decides which cables are taut, by the rule of interior.c, and factors the matrix at the precise shape. Returns false
 * if it has no factor. */
static bool factor_anew(hf_precise *p)
{
    const hf_model *m = p->m;
    if (!m->has_newton) return false;
    for (int e = 0; e < m->n_cable; e++) {
        hf_precise_cable *c = p->cable + e;
        hf_law_cable cable = hf_workspace_cable(m, p->w, e);
        if (hf_precise_is_fixed(m, e)) continue;
        bool multiplier = hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER);
        if (multiplier) {
            c->is_taut = c->T.hi / m->reference_N + c->over.hi / cable.length_at_target_m > 0;
            if (!(c->is_taut > 0)) c->T = (hf_twofold){0, 0};
        }
        c->along = c->is_taut > 0 ? hf_law_stiffness_N_per_m(cable, INFINITY) : 0;
        if (multiplier && isinf(c->along)) c->along = hf_newton_matrix_rigid_stiffness(m, e, c->T.hi);
    }
    bool is_factored = hf_newton_matrix_factor_blocks(m, p->w, hf_precise_block, NULL, NULL, &p->condition) == HF_OK &&
                       (!m->n_attachment || factor_truss(p, false));
    for (int e = 0; e < m->n_cable; e++) /* from here on, `along` belongs to multipliers alone */
        if (!hf_law_has((hf_law)p->w->law[e], HF_LAW_HAS_MULTIPLIER)) p->cable[e].along = 0;
    return is_factored;
}

double hf_precise_guess(const hf_precise *p)
{
    return SHARE_OF_GUESS * hf_precise_largest_sum(p, hf_precise_matrix_sum) / p->condition;
}

static bool is_told_apart(const hf_precise *p)
{
    for (int e = 0; e < p->m->n_cable; e++) {
        const hf_precise_cable *c = p->cable + e;
        if (hf_precise_is_fixed(p->m, e) || !hf_law_has((hf_law)p->w->law[e], HF_LAW_HAS_MULTIPLIER)) continue;
        if (c->is_taut > 0 ? !(c->T.hi > 0) : !(c->over.hi < 0)) return false;
    }
    return true;
}

hf_bound_reason hf_precise_approach(hf_precise *p, bool has_factor)
{
    hf_bound_reason reason = HF_BOUND_NOT_CONTRACTING;
    if (has_factor && p->m->n_attachment) has_factor = factor_truss(p, true);
    if (!has_factor) measure_precise(p, false);
    for (int k = has_factor ? 0 : 1; k <= MATRICES_MAX; k++) {
        p->is_first_matrix = k == 0;
        if (k > 0 && !factor_anew(p)) return k == 1 && !has_factor ? HF_BOUND_NOT_DEFINITE : reason;
        double error = correct(p);
        reason = !(error < CONTRACTED) ? HF_BOUND_NOT_CONTRACTING
                 : is_told_apart(p)    ? HF_BOUND_CERTIFIED
                                       : HF_BOUND_SLACK_OR_TAUT;
        if (reason == HF_BOUND_CERTIFIED && error <= p->wanted) break;
    }
    return reason;
}
