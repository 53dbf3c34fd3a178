/* Iterates from force densities to a shape by the paper's method (METHOD sections 1 to 4).
 *
 *     force densities q, positions of the supports
 *         |
 *         v
 *     1. solve D x_f = P - C_f' Q C_g x_g for x, y, z       (Eqs. 2, 5)  <---+
 *     2. lengths, tensions q l, errors against the laws     (Eqs. 4, 6)      |
 *     3. psi, residual, loaded straight chains: stop?                        |
 *         | no: q by the laws of the cables                 (Eqs. 7, 8)  ----+
 *         v yes
 *     result, or the status of an ill-posed net
 *
 * hf_form_measure and hf_form_accept do steps 2 and 3 for a shape that another solver has found. */
#include <hifdm/formfind.h>

#include "base/elementary.h"
#include "linalg/band.h"
#include "linalg/dot.h"
#include "solve/history.h"
#include "solve/newton_matrix.h"
#include <hifdm/metrics.h>

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

/* Straight chains are examined after this many iterations, and again each time the number of iterations has doubled. A
 * smaller value refuses a net sooner, a larger one gives its loads more iterations to settle. From 1 to 512 the tests
 * of solve and stress judge all nets alike; with 2048 one of the coupling fails (soft_trusses_are_named). */
#define FIRST_CHAIN_CHECK 64
/* A load has settled when its relative change between two examinations is below this value. The tests of form-finding
 * pass with 0.01 and 0.1; with 0.001 one of them fails (loaded_straight_chain_is_ill_posed). */
#define CHAIN_LOAD_SETTLED 0.01
/* An imbalance of up to this many roundings of the coordinates of the ends counts as rounding. From 3 to 1000 the tests
 * of solve and stress take the same steps; with 1 one fails (what_rounding_leaves_is_named). */
#define ROUNDING_STEPS 32
/* A lateral load below this fraction of the reference tension counts as zero. The tests of form-finding pass with 1e-8
 * and 1e-4. */
#define CHAIN_LOAD_NONE 1e-6

/* ---- starts ---- */

void hf_form_prepare(const hf_model *m, hf_workspace *w)
{
    size_t n = (size_t)m->n_cable;
    memcpy(w->law, m->law, n);
    memcpy(w->target, m->target, n * sizeof(double));
    memcpy(w->q_N_per_m, m->start_q_N_per_m, n * sizeof(double));
    if (m->EA_N) memcpy(w->EA_N, m->EA_N, n * sizeof(double));
    memset(w->loose, 0, (size_t)m->n_node);
    if (m->moves_supports) memset(w->support_displacement_m, 0, 3 * (size_t)m->n_node * sizeof(double));
    memset(w->displacement_m, 0, 3 * (size_t)m->n_attachment * sizeof(double));
    w->n_moving = m->n_free;
}

void hf_form_set_supports(const hf_model *m, hf_workspace *w)
{
    memcpy(w->position_m, m->position_m, 3 * (size_t)m->n_node * sizeof(double));
    for (int i = 0; m->moves_supports && i < 3 * m->n_node; i++)
        w->position_m[i] += w->support_displacement_m[i];
    for (int i = 0; i < m->n_attachment; i++)
        for (int c = 0; c < 3; c++)
            w->position_m[c * m->n_node + m->attachment_row[i]] += w->displacement_m[3 * i + c];
}

/* ---- one linear solve: D x_f = P - C_f' Q C_g x_g for x, y, z (Eqs. 2, 5) ---- */

void hf_form_assemble(const hf_model *m, hf_workspace *w)
{
    memset(w->band, 0, ((size_t)m->n_band + 1) * sizeof(double));
    for (int e = 0; e < m->n_cable; e++) {
        double q = w->q_N_per_m[e];
        w->band[m->diagonal_a[e]] += q; /* the entry of a support is the spare one after the band */
        w->band[m->diagonal_b[e]] += q;
        w->band[m->off_diagonal[e]] -= q;
    }
}

/* The support rows keep the positions of the supports. */
void hf_form_assemble_loads(const hf_model *m, hf_workspace *w)
{
    for (ptrdiff_t c = 0; c < 3; c++)
        hf_copy((size_t)m->n_free, m->load_N ? m->load_N + c * m->n_node : NULL, w->position_m + c * m->n_node);
    double *x = w->position_m, *y = x + m->n_node, *z = y + m->n_node;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        int inside = a < b ? a : b, support = a < b ? b : a;
        if (support < m->n_free || inside >= m->n_free) continue;
        double q = w->q_N_per_m[e];
        x[inside] += q * x[support];
        y[inside] += q * y[support];
        z[inside] += q * z[support];
    }
}

static hf_status solve_positions(const hf_model *m, hf_workspace *w, int *bad_row)
{
    hf_form_assemble(m, w);
    hf_form_assemble_loads(m, w);
    if (m->has_strut)
        return hf_band_solve_indefinite(m->n_free, m->half_bandwidth, w->band, w->general_band, w->pivot, w->position_m,
                                        m->n_node, bad_row);
    return hf_band_solve(m->by_lapack, m->n_free, m->half_bandwidth, w->band, w->position_m, m->n_node, bad_row);
}

/* ---- measuring cables ---- */

/* Returns the larger number without a function call. A NaN in `next` leaves `now` unchanged. */
static inline double larger(double now, double next)
{
    return next > now ? next : now;
}

/* Sets lengths, tensions (Eqs. 4, 6) and the errors against the laws. length_gap is the length error for the stopping
 * rule. It includes taut cables and slack cables that are too long. A slack cable that is too short counts with a
 * weight: the tension that remains in it, relative to the reference tension. */
void hf_form_measure_cables(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_form_result *r,
                            double *length_gap)
{
    const double *x = w->position_m, *y = x + m->n_node, *z = y + m->n_node;
    double shortest = INFINITY;
    r->tension_error = r->length_error = *length_gap = 0;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        double dx = x[b] - x[a], dy = y[b] - y[a], dz = z[b] - z[a];
        double length = sqrt(dx * dx + dy * dy + dz * dz), tension = w->q_N_per_m[e] * length;
        double part = length / m->length_m[e];
        w->length_m[e] = length;
        w->tension_N[e] = tension;
        if (!isfinite(tension)) {
            r->status = HF_NOT_FINITE;
            r->culprit = e;
            return;
        }
        hf_law_cable cable = hf_workspace_cable(m, w, e);
        bool gives_tension = hf_law_has(cable.law, HF_LAW_GIVES_TENSION);
        bool may_vanish = hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER); /* its tension may be zero */
        if (part < (gives_tension ? s->collapse_ratio : HF_FORM_GONE) && !may_vanish) {
            r->status = HF_COLLAPSED;
            r->culprit = e;
            return;
        }
        if (part > HF_FORM_BLOWN_UP) { /* D is singular except for rounding */
            r->status = HF_SINGULAR;
            r->culprit = a < b ? a : b;
            return;
        }
        if (part < shortest) shortest = part;
        if (gives_tension) {
            r->tension_error = larger(r->tension_error, fabs(tension / cable.target - 1));
        } else if (may_vanish) {
            double strain = length / hf_law_required_length_m(cable, tension) - 1;
            double pull = tension / m->reference_N;
            if (pull > 1) pull = 1;
            double error = fabs(strain);
            bool is_taut = pull >= HF_SLACK_RATIO;
            if (is_taut) r->length_error = larger(r->length_error, error);
            *length_gap = larger(*length_gap, strain > 0 || is_taut ? error : error * pull);
        }
    }
    r->shortest_length_ratio = shortest;
}

/* ---- nodal residual ---- */

typedef enum {
    WITH_MULTIPLIERS, /* T* under law tension, q l of the others: the forces that the iteration balances */
    WITHOUT_CHAINS,   /* the same without the straight chains under law length */
    BY_LAW            /* as above, but elastic cables at the tension that their law gives at their length */
} pulls;

/* Sets force_N to the sum of the loads and of the forces of all cables on their nodes. */
static void nodal_forces(const hf_model *m, hf_workspace *w, pulls which)
{
    const double *x = w->position_m, *y = x + m->n_node, *z = y + m->n_node;
    double *fx = w->force_N, *fy = fx + m->n_node, *fz = fy + m->n_node;
    hf_copy(3 * (size_t)m->n_node, m->load_N, fx);
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        if (which == WITHOUT_CHAINS && hf_law_has(w->law[e], HF_LAW_IS_RIGID) &&
            (m->chain_of_row[a] >= 0 || m->chain_of_row[b] >= 0))
            continue;
        double q = hf_workspace_held_q_N_per_m(m, w, e);
        if (which == BY_LAW && hf_law_has(w->law[e], HF_LAW_GOES_SLACK))
            q = hf_law_tension_N(hf_workspace_cable(m, w, e), w->length_m[e]) / w->length_m[e];
        double dx = q * (x[b] - x[a]), dy = q * (y[b] - y[a]), dz = q * (z[b] - z[a]);
        fx[a] += dx, fy[a] += dy, fz[a] += dz;
        fx[b] -= dx, fy[b] -= dy, fz[b] -= dz;
    }
}

static double largest_nodal_force_N(const hf_model *m, hf_workspace *w, pulls which)
{
    double largest = 0, scale = 1 / m->reference_N; /* the squares of tiny forces would underflow */
    const double *fx = w->force_N, *fy = fx + m->n_node, *fz = fy + m->n_node;
    nodal_forces(m, w, which);
    for (int i = 0; i < m->n_free; i++) {
        double x = scale * fx[i], y = scale * fy[i], z = scale * fz[i];
        largest = larger(largest, x * x + y * y + z * z);
    }
    return sqrt(largest) * m->reference_N;
}

double hf_form_residual_N(const hf_model *m, hf_workspace *w)
{
    return largest_nodal_force_N(m, w, WITH_MULTIPLIERS);
}

/* Returns the maximum coordinate of the ends of cable e, m. The rounding error of the cable's length is relative to
 * it. */
static double largest_coordinate_m(const hf_model *m, const hf_workspace *w, int e)
{
    double largest = 0;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 2; k++)
            largest = larger(largest, fabs(w->position_m[c * m->n_node + m->end_row[2 * e + k]]));
    return largest;
}

/* Returns the cable whose length is so small compared with its coordinates that rounding prevents convergence, or -1.
 * Reads the nodal forces in force_N. */
static int find_rounded_cable(const hf_model *m, const hf_form_settings *s, const hf_workspace *w)
{
    const double *f = w->force_N;
    int worst_row = 0, culprit = -1;
    double worst = -1, floor_N = 0, coarsest_N = 0;
    for (int i = 0; i < m->n_free; i++) {
        double force = hf_norm(f[i], f[m->n_node + i], f[2 * m->n_node + i]);
        if (force > worst) worst = force, worst_row = i;
    }
    for (int e = 0; e < m->n_cable; e++) {
        double step_m = DBL_EPSILON * largest_coordinate_m(m, w, e), step_N = fabs(w->q_N_per_m[e]) * step_m;
        double error = hf_law_has(w->law[e], HF_LAW_GIVES_TENSION) ? fabs(w->tension_N[e] / w->target[e] - 1) : 0;
        if (error > s->residual_tolerance && error <= ROUNDING_STEPS * step_m / w->length_m[e]) return e;
        if (m->end_row[2 * e] != worst_row && m->end_row[2 * e + 1] != worst_row) continue;
        floor_N += step_N;
        if (step_N > coarsest_N) coarsest_N = step_N, culprit = e;
    }
    return worst > s->residual_tolerance * m->reference_N && worst <= ROUNDING_STEPS * floor_N ? culprit : -1;
}

/* ---- straight chains: a chain that cannot deflect carries no lateral load at a finite tension ---- */

/* Returns the squared distance of the supports at the two ends of chain i_chain, m^2. `span` becomes the vector between
 * them, and *from the row of the first one. */
static double chain_span(const hf_model *m, const hf_workspace *w, int i_chain, int *from, double span[3])
{
    const int *first = m->end_row + 2 * m->chain_cable[m->chain_start[i_chain]];
    const int *last = m->end_row + 2 * m->chain_cable[m->chain_start[i_chain + 1] - 1];
    int to = last[0] >= m->n_free ? last[0] : last[1];
    double square = 0;
    *from = first[0] >= m->n_free ? first[0] : first[1];
    for (int c = 0; c < 3; c++) {
        span[c] = w->position_m[c * m->n_node + to] - w->position_m[c * m->n_node + *from];
        square += span[c] * span[c];
    }
    return square;
}

/* Returns the maximum force perpendicular to chain i_chain at one of its nodes, N. force_N holds the forces without the
 * chains. */
static double lateral_load_N(const hf_model *m, const hf_workspace *w, int i_chain)
{
    const double *f = w->force_N;
    int from;
    double u[3], span = chain_span(m, w, i_chain, &from, u), largest = 0;
    const int *ends = m->end_row + 2 * m->chain_cable[m->chain_start[i_chain]];
    int row = from == ends[0] ? ends[1] : ends[0];
    for (int k = m->chain_start[i_chain]; k + 1 < m->chain_start[i_chain + 1]; k++) {
        double along = 0, square = 0;
        for (int c = 0; c < 3; c++)
            along += f[c * m->n_node + row] * u[c] / span;
        for (int c = 0; c < 3; c++) {
            double across = f[c * m->n_node + row] - along * u[c];
            square += across * across;
        }
        largest = fmax(largest, sqrt(square));
        ends = m->end_row + 2 * m->chain_cable[k + 1];
        row = ends[0] == row ? ends[1] : ends[0];
    }
    return largest;
}

int hf_form_n_chain(const hf_model *m)
{
    return m->n_attachment ? m->n_any_chain : m->n_chain;
}

/* Returns the sum of the lengths of chain i_chain, m, and sets *square to the squared distance of its supports, m^2. */
static double chain_sum(const hf_model *m, const hf_workspace *w, int i_chain, double *square)
{
    int from;
    double sum = 0, span[3];
    for (int k = m->chain_start[i_chain]; k < m->chain_start[i_chain + 1]; k++)
        sum += w->target[m->chain_cable[k]];
    *square = chain_span(m, w, i_chain, &from, span);
    return sum;
}

static bool chain_is_rigid(const hf_model *m, const hf_workspace *w, int i_chain)
{
    for (int k = m->chain_start[i_chain]; k < m->chain_start[i_chain + 1]; k++)
        if (!hf_law_has((hf_law)w->law[m->chain_cable[k]], HF_LAW_IS_RIGID)) return false;
    return true;
}

/* Returns true if chain i_chain is under law length and straight at the present positions of its supports. */
static bool chain_is_straight(const hf_model *m, const hf_workspace *w, int i_chain)
{
    double square;
    if (!chain_is_rigid(m, w, i_chain)) return false;
    if (!m->n_attachment) return true;
    return chain_sum(m, w, i_chain, &square) <= sqrt(square) * (1 + HF_STRAIGHT_EXCESS);
}

bool hf_form_chain_is_short(const hf_model *m, const hf_workspace *w, int i_chain, double *sum_m, double *span_m)
{
    double square;
    *sum_m = chain_sum(m, w, i_chain, &square);
    *span_m = sqrt(square);
    return chain_is_rigid(m, w, i_chain) && *sum_m * (1 + HF_STRAIGHT_EXCESS) < *span_m;
}

/* Returns the lateral load of chain i_chain, N. Returns INFINITY if the chain is too short for its supports, because no
 * shape then has its lengths. */
static double chain_burden_N(const hf_model *m, const hf_workspace *w, int i_chain)
{
    double sum, span;
    return hf_form_chain_is_short(m, w, i_chain, &sum, &span) ? INFINITY : lateral_load_N(m, w, i_chain);
}

bool hf_form_chain_is_loaded(const hf_model *m, hf_workspace *w, int i_chain)
{
    if (!chain_is_straight(m, w, i_chain)) return false;
    nodal_forces(m, w, WITHOUT_CHAINS);
    return chain_burden_N(m, w, i_chain) > CHAIN_LOAD_NONE * m->reference_N;
}

/* Sets n_loaded_chain and returns the maximum lateral load on a straight chain, N. *worst is that chain, or -1. */
static double look_at_chains(const hf_model *m, hf_workspace *w, hf_form_result *r, int *worst)
{
    double largest = 0;
    r->n_loaded_chain = 0;
    *worst = -1;
    int n_chain = hf_form_n_chain(m);
    if (n_chain) nodal_forces(m, w, WITHOUT_CHAINS);
    for (int i = 0; i < n_chain; i++) {
        if (!chain_is_straight(m, w, i)) continue;
        double load = chain_burden_N(m, w, i);
        if (!(load > CHAIN_LOAD_NONE * m->reference_N)) continue;
        r->n_loaded_chain++;
        if (load > largest) {
            largest = load;
            *worst = i;
        }
    }
    return largest;
}

/* ---- updates ---- */

void hf_form_update(const hf_model *m, hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++)
        w->q_N_per_m[e] =
            hf_law_next_q_N_per_m(hf_workspace_cable(m, w, e), w->length_m[e], w->tension_N[e], w->q_N_per_m[e]);
}

/* ---- stopping ---- */

typedef struct {
    hf_stop_rule stop;
    bool iterates;
    double psi_before_m;      /* NaN at the first iteration */
    double chain_load_before; /* NaN before the first examination */
    int next_chain_look;
} progress;

/* Decides whether the shape just measured is the last one. Sets status and stop reason if so. */
static bool is_last(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_form_result *r, progress *p,
                    double length_gap)
{
    if (!p->iterates) {
        r->stop_reason = HF_STOPPED_DIRECT;
        if (r->residual_N > s->residual_tolerance * m->reference_N) r->status = HF_NOT_CONVERGED;
        return true;
    }
    if (p->stop == HF_STOP_RMS_CHANGE) {
        if (fabs(r->psi_m - p->psi_before_m) < s->rms_tolerance_m) r->stop_reason = HF_STOPPED_RMS_CHANGE;
        p->psi_before_m = r->psi_m;
    } else {
        int worst;
        bool looks = hf_form_n_chain(m) && r->iterations == p->next_chain_look;
        /* The residual has cables at the tensions of their laws, so the tensions of the last solve are checked, too. */
        if (r->residual_N <= s->residual_tolerance * m->reference_N && r->tension_error <= s->residual_tolerance &&
            length_gap <= s->length_tolerance)
            r->stop_reason = HF_STOPPED_CONVERGED;
        if (looks && r->stop_reason == HF_STOPPED_NONE) {
            double load = look_at_chains(m, w, r, &worst);
            p->next_chain_look *= 2;
            if (isinf(load)) return true;
            if (worst >= 0 && fabs(load - p->chain_load_before) < CHAIN_LOAD_SETTLED * load) return true;
            p->chain_load_before = load;
        }
    }
    if (r->stop_reason != HF_STOPPED_NONE) return true;
    if (r->iterations < s->max_iterations) return false;
    r->stop_reason = HF_STOPPED_MAX_ITERATIONS;
    r->status = HF_NOT_CONVERGED;
    return true;
}

/* Refuses a net with a loaded straight chain under the stopping rule `residual`. Such a net has no equilibrium, even if
 * its residual is small. Under the paper's rule the result stands, and n_loaded_chain counts the chains. */
static void judge_chains(const hf_model *m, hf_workspace *w, const progress *p, hf_form_result *r)
{
    int worst;
    look_at_chains(m, w, r, &worst);
    if (worst < 0 || p->stop == HF_STOP_RMS_CHANGE) return;
    r->status = HF_STRAIGHT_CHAIN;
    r->culprit = worst;
}

/* Sets a result before its first iteration: status ok, no culprit, all measures NaN. */
static void open_result(hf_form_result *r)
{
    *r = (hf_form_result){.status = HF_OK, .culprit = -1};
    hf_result_blank(r);
}

static hf_status close_refused(hf_form_result *r)
{
    r->stop_reason = HF_STOPPED_ILL_POSED;
    hf_result_blank(r);
    r->n_slack = 0;
    return r->status;
}

static hf_status finish_result(const hf_model *m, hf_workspace *w, hf_form_result *r)
{
    if (r->status != HF_OK && r->status != HF_NOT_CONVERGED) return close_refused(r);
    if (m->EA_N) r->residual_N = largest_nodal_force_N(m, w, BY_LAW);
    r->psi_m = hf_metrics_psi_m(m, w);
    r->inner_tension_ratio = hf_metrics_tension_ratio(m, w, HF_GROUP_INNER);
    r->boundary_tension_ratio = hf_metrics_tension_ratio(m, w, HF_GROUP_BOUNDARY);
    r->n_slack = hf_metrics_slack_count(m, w);
    return r->status;
}

/* ---- the iteration ---- */

hf_status hf_form_find(const hf_model *m, const hf_form_settings *s, hf_stop_rule stop, hf_workspace *w,
                       hf_history *history, hf_form_result *r)
{
    assert(m->n_free > 0 && s->max_iterations > 0);
    progress p = {stop, hf_workspace_iterates(m, w), (double)NAN, (double)NAN, FIRST_CHAIN_CHECK};
    bool need_psi = history || stop == HF_STOP_RMS_CHANGE;
    bool need_residual = history || stop == HF_STOP_RESIDUAL || !p.iterates;
    double length_gap;
    open_result(r);
    hf_form_set_supports(m, w);
    for (;;) {
        r->iterations++;
        r->status = w->stop && *w->stop ? HF_INTERRUPTED : solve_positions(m, w, &r->culprit);
        if (r->status != HF_OK) break;
        hf_form_measure_cables(m, s, w, r, &length_gap);
        if (r->status != HF_OK) break;
        if (need_psi) r->psi_m = hf_metrics_psi_m(m, w);
        if (need_residual) r->residual_N = hf_form_residual_N(m, w);
        if (history) hf_history_add(history, m, w, r->psi_m, r->residual_N, r->length_error);
        if (is_last(m, s, w, r, &p, length_gap)) break;
        hf_form_update(m, w);
    }
    if (r->status == HF_OK || r->status == HF_NOT_CONVERGED) {
        if (!need_residual) r->residual_N = hf_form_residual_N(m, w);
        if (r->status == HF_NOT_CONVERGED) r->culprit = find_rounded_cable(m, s, w);
        if (r->status == HF_OK || r->iterations >= FIRST_CHAIN_CHECK) judge_chains(m, w, &p, r);
    }
    return finish_result(m, w, r);
}

/* ---- shapes of other solvers: Newton, lanes ---- */

hf_status hf_form_measure(const hf_model *m, const hf_form_settings *s, hf_workspace *w, hf_form_result *r)
{
    double length_gap, u[3];
    open_result(r);
    for (int e = 0; e < m->n_cable; e++) {
        if (!hf_law_has(w->law[e], HF_LAW_GIVES_TENSION)) continue;
        double length = hf_newton_matrix_direction(m, w->position_m, e, u);
        w->q_N_per_m[e] = length > 0 ? w->target[e] / length : 0; /* without length: refused as collapsed below */
    }
    hf_form_measure_cables(m, s, w, r, &length_gap);
    if (r->status != HF_OK) return finish_result(m, w, r);
    r->residual_N = hf_form_residual_N(m, w);
    r->stop_reason = HF_STOPPED_CONVERGED;
    if (!(r->residual_N <= s->residual_tolerance * m->reference_N && length_gap <= s->length_tolerance)) {
        r->status = HF_NOT_CONVERGED;
        r->stop_reason = HF_STOPPED_MAX_ITERATIONS;
    }
    return finish_result(m, w, r);
}

hf_status hf_form_accept(const hf_model *m, const hf_form_settings *s, hf_stop_reason reason, int iterations,
                         hf_workspace *w, hf_form_result *r)
{
    double length_gap;
    progress p = {.stop = reason == HF_STOPPED_RMS_CHANGE ? HF_STOP_RMS_CHANGE : HF_STOP_RESIDUAL};
    open_result(r);
    r->iterations = iterations;
    r->stop_reason = reason;
    hf_form_measure_cables(m, s, w, r, &length_gap);
    if (r->status == HF_OK) {
        if (reason == HF_STOPPED_MAX_ITERATIONS) r->status = HF_NOT_CONVERGED;
        r->residual_N = hf_form_residual_N(m, w);
        if (r->status == HF_NOT_CONVERGED) r->culprit = find_rounded_cable(m, s, w);
        judge_chains(m, w, &p, r);
    }
    return finish_result(m, w, r);
}

void hf_form_refuse(hf_status status, int iterations, hf_form_result *r)
{
    open_result(r);
    r->status = status;
    r->iterations = iterations;
    close_refused(r);
}
