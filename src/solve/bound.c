/* Contents: state - forces and lengths at twice the precision - sums at nodes - refinement - the least eigenvalue -
 * independent lengths - the radius of the ball - the proof. The found shape is refined at twice the precision by steps
 * with a matrix that is factored already. What is then out of balance is so small that a crude proof suffices: the
 * energy is larger on the surface of a tiny ball around the refined shape than within it, so that every equilibrium
 * lies in the ball. The bound is the distance to the refined shape, plus the radius of the ball (METHOD section 3). */
#include "solve/bound.h"

#include "linalg/band.h"
#include "linalg/twofold.h"
#include "solve/newton_matrix.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#define U 0x1p-53           /* unit of rounding */
#define REFINEMENTS_MAX 12  /* steps with one matrix; a found shape takes two to four */
#define MATRICES_MAX 2      /* matrices of its own, for shapes far from balance and cables taken for slack or taut */
#define FINE 1e-28          /* relative errors at which refinement ends; twice the precision leaves 1e-30 */
#define FINE_ENOUGH 1e-22   /* errors for which another matrix is not worth its factorisation */
#define CONTRACTED 1e-16    /* errors that are not below it are taken for divergence; the proof does not rely on it */
#define STIFFENING 1e7      /* of a taut cable of law length, as in interior.c */
#define LEAST_PULL 1e-3     /* the same */
#define SHARE_OF_GUESS 0.1  /* part of the estimate of the least eigenvalue that is tried first */
#define SHARE_OF_LAST 1e-3  /* part of what has failed that is tried next */
#define INSIDE_LENGTH 0.005 /* the ball is smaller than this part of every length */

/* ---- state ---- */

typedef struct {
    hf_twofold T;         /* multiplier, N; 0 of a slack cable */
    hf_twofold over;      /* length less the wanted length at T, m; of cables with a multiplier */
    double unit[3];       /* from the first end to the second */
    double length;        /* m */
    double along, across; /* of the matrix, N/m */
    double change;        /* of T in the last step, N */
    double is_taut;       /* 1 or 0; 1 of a cable without a multiplier */
} bound_cable;

static_assert(sizeof(bound_cable) == HF_BOUND_CABLE_ITEMS * sizeof(double), "HF_BOUND_CABLE_ITEMS");

typedef struct {
    const hf_model *m;
    hf_workspace *w;
    bound_cable *cable; /* [n_cable] */
    hf_twofold *x;      /* [3][n_node] refined shape */
    hf_twofold *force;  /* [3 n_free] out of balance, by dof */
    double *step;       /* [3 n_free] by dof */
    double *sum;        /* [n_free] scratch */
    double condition;   /* estimate, of the matrix that is factored */
    double guess;       /* of a number below its least eigenvalue, N/m */
} refined;

static void lay_out_bound(const hf_model *m, hf_workspace *w, refined *p)
{
    size_t n_node = (size_t)m->n_node, n_free = (size_t)m->n_free;
    *p = (refined){.m = m, .w = w, .cable = (bound_cable *)w->bound_work};
    p->x = (hf_twofold *)(p->cable + m->n_cable);
    p->force = p->x + 3 * n_node;
    p->step = (double *)(p->force + 3 * n_free);
    p->sum = p->step + 3 * n_free;
    for (size_t i = 0; i < 3 * n_node; i++)
        p->x[i] = hf_twofold_of(w->position_m[i]);
}

static bool is_between_supports(const hf_model *m, int e)
{
    return m->end_row[2 * e] >= m->n_free && m->end_row[2 * e + 1] >= m->n_free;
}

static bool is_a_spring(hf_law law)
{
    return !hf_law_has(law, HF_LAW_HAS_MULTIPLIER | HF_LAW_GIVES_TENSION);
}

/* Starts from the tensions in the workspace, and from what its matrix takes for taut. */
static void set_first_state(refined *p)
{
    for (int e = 0; e < p->m->n_cable; e++) {
        bound_cable *c = p->cable + e;
        hf_law_cable cable = hf_workspace_cable(p->m, p->w, e);
        c->T = (hf_twofold){0, 0};
        c->along = 0;
        c->is_taut = 1;
        if (is_between_supports(p->m, e) || !hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER)) continue;
        double u[3], T = p->w->tension_N[e], length = hf_newton_matrix_direction(p->m, p->w->position_m, e, u);
        c->along = hf_newton_matrix_stiffness(cable, length, T);
        c->is_taut = c->along > 0;
        if (c->is_taut > 0) c->T = hf_twofold_of(T);
    }
}

/* ---- forces and lengths at twice the precision ---- */

/* hf_law_wanted_length_m */
static hf_twofold wanted_length(hf_law_cable c, hf_twofold T)
{
    hf_twofold target = hf_twofold_of(c.target);
    if (!hf_law_has(c.law, HF_LAW_NEEDS_EA)) return target;
    return hf_twofold_add(target, hf_twofold_divide(hf_twofold_multiply(target, T), hf_twofold_of(c.EA_N)));
}

/* Tension of a taut cable: the multiplier, or what the law gives at this length. */
static hf_twofold tension_at(hf_law_cable c, hf_twofold length, hf_twofold multiplier, bool by_law)
{
    if (hf_law_has(c.law, HF_LAW_GIVES_TENSION)) return hf_twofold_of(c.target);
    if (is_a_spring(c.law)) return hf_twofold_multiply(hf_twofold_of(c.target), length);
    if (!by_law || hf_law_has(c.law, HF_LAW_IS_RIGID)) return multiplier;
    hf_twofold l0 = hf_twofold_of(c.target), EA = hf_twofold_of(c.EA_N);
    return hf_twofold_divide(hf_twofold_multiply(EA, hf_twofold_subtract(length, l0)), l0);
}

static void add_to(hf_twofold *sum, hf_twofold a)
{
    *sum = hf_twofold_add(*sum, a);
}

/* Vector between the ends of cable e, m. Returns its length. */
static hf_twofold vector_between(const refined *p, int e, hf_twofold d[3])
{
    const int *end = p->m->end_row + 2 * e;
    hf_twofold square = {0, 0};
    for (int c = 0; c < 3; c++) {
        const hf_twofold *x = p->x + (size_t)c * (size_t)p->m->n_node;
        d[c] = hf_twofold_subtract(x[end[1]], x[end[0]]);
        add_to(&square, hf_twofold_multiply(d[c], d[c]));
    }
    return hf_twofold_root(square);
}

/* Sets the forces out of balance, and length, unit, over and across of the cables. by_law: elastic cables pull with
 * what their law gives at their length, else with the multiplier. Returns the largest error, relative to the reference
 * tension and the theoretical lengths. */
static double measure_refined(refined *p, bool by_law)
{
    const hf_model *m = p->m;
    double largest = 0;
    for (int i = 0; i < 3 * m->n_free; i++)
        p->force[i] = hf_twofold_of(m->load_N ? m->load_N[i % 3 * m->n_node + i / 3] : 0);
    for (int e = 0; e < m->n_cable; e++) {
        bound_cable *c = p->cable + e;
        if (is_between_supports(m, e)) continue;
        hf_law_cable cable = hf_workspace_cable(m, p->w, e);
        hf_twofold d[3], length = vector_between(p, e, d);
        bool is_taut = c->is_taut > 0;
        c->length = length.hi;
        if (hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER)) {
            c->over = hf_twofold_subtract(length, wanted_length(cable, c->T));
            if (is_taut) largest = fmax(largest, fabs(c->over.hi) / cable.theoretical_m);
        }
        hf_twofold q = hf_twofold_divide(tension_at(cable, length, c->T, by_law), length);
        if (!is_taut) q = (hf_twofold){0, 0};
        c->across = q.hi;
        for (int k = 0; k < 3; k++) {
            int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
            hf_twofold pull = hf_twofold_multiply(q, d[k]);
            c->unit[k] = d[k].hi / length.hi;
            if (a < m->n_free) add_to(p->force + 3 * a + k, pull);
            if (b < m->n_free) add_to(p->force + 3 * b + k, hf_twofold_minus(pull));
        }
    }
    for (int i = 0; i < 3 * m->n_free; i++) {
        double error = fabs(p->force[i].hi) / m->reference_N;
        if (!(error <= largest)) largest = error; /* keeps a NaN */
    }
    return largest;
}

/* ---- sums at nodes ---- */

typedef double cable_figure(const refined *p, int e);

/* Largest sum of a figure of the cables at a free node. */
static double largest_sum(const refined *p, cable_figure *figure)
{
    double largest = 0;
    memset(p->sum, 0, (size_t)p->m->n_free * sizeof *p->sum);
    for (int e = 0; e < p->m->n_cable; e++) {
        if (is_between_supports(p->m, e) || !(p->cable[e].is_taut > 0)) continue;
        double value = figure(p, e);
        for (int k = 2 * e; k < 2 * e + 2; k++)
            if (p->m->end_row[k] < p->m->n_free) p->sum[p->m->end_row[k]] += value;
    }
    for (int i = 0; i < p->m->n_free; i++)
        largest = fmax(largest, p->sum[i]);
    return largest;
}

/* Of the matrix that is factored, whose norm is at least as large as the largest sum. */
static double matrix_sum(const refined *p, int e)
{
    return p->cable[e].along + p->cable[e].across;
}

/* phi'', N/m; of a rigid law the stiffness that the proof adds. */
static double stiffness_of(const refined *p, int e)
{
    hf_law_cable cable = hf_workspace_cable(p->m, p->w, e);
    double k = hf_law_stiffness_N_per_m(cable, INFINITY);
    return isinf(k) ? p->cable[e].along : k;
}

static double one(const refined *p, int e)
{
    (void)p, (void)e;
    return 1;
}

static double stiffness_sum(const refined *p, int e)
{
    return stiffness_of(p, e) + p->cable[e].across;
}

/* The Hessian of a cable of law force_density does not depend on the shape. */
static double stiffness_change(const refined *p, int e)
{
    return is_a_spring((hf_law)p->w->law[e]) ? 0 : stiffness_sum(p, e) / p->cable[e].length;
}

/* What the rounding of a pull is relative to, N. */
static double rounded_force(const refined *p, int e)
{
    const bound_cable *c = p->cable + e;
    bool is_elastic = hf_law_has((hf_law)p->w->law[e], HF_LAW_NEEDS_EA);
    return (c->across + (is_elastic ? 2 * stiffness_of(p, e) : 0)) * c->length;
}

/* ---- refinement ---- */

static void solve_for_step(refined *p)
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

/* The Newton step (M8) with the matrix that is factored: step, and change of the cables. */
static void find_refinement(refined *p)
{
    const hf_model *m = p->m;
    for (int i = 0; i < 3 * m->n_free; i++)
        p->step[i] = p->force[i].hi;
    for (int pass = 0; pass < 2; pass++) {
        for (int e = 0; e < m->n_cable; e++) {
            bound_cable *c = p->cable + e;
            if (!(c->along > 0)) continue;
            int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
            double longer = c->over.hi, pull[3];
            for (int k = 0; k < 3 && pass; k++)
                longer +=
                    c->unit[k] * ((b < m->n_free ? p->step[3 * b + k] : 0) - (a < m->n_free ? p->step[3 * a + k] : 0));
            c->change = c->along * longer;
            for (int k = 0; k < 3; k++)
                pull[k] = c->change * c->unit[k];
            if (!pass) hf_newton_matrix_add_pull(m, p->w, e, pull, p->step);
        }
        if (!pass) solve_for_step(p);
    }
}

static void move_refined(refined *p, double part)
{
    const hf_model *m = p->m;
    for (int i = 0; i < 3 * m->n_free; i++)
        add_to(p->x + i % 3 * m->n_node + i / 3, hf_twofold_of(part * p->step[i]));
    for (int e = 0; e < m->n_cable; e++)
        if (p->cable[e].along > 0) add_to(&p->cable[e].T, hf_twofold_of(part * p->cable[e].change));
}

/* Takes steps while each halves the errors. Returns the errors at the end, with the forces by law. */
static double refine(refined *p)
{
    double now = measure_refined(p, false), before = INFINITY;
    for (int k = 0; k < REFINEMENTS_MAX && now > FINE && now < before / 2; k++) {
        bool is_last = k > 0 && now * (now / before) < FINE; /* when the next step does as the last one did */
        find_refinement(p);
        move_refined(p, 1);
        before = now;
        now = measure_refined(p, is_last);
        if (is_last && now < FINE_ENOUGH) return now;
        if (is_last) now = measure_refined(p, false);
        if (!(now < before)) move_refined(p, -1); /* which ends the loop */
    }
    return measure_refined(p, true);
}

static void refined_block(const hf_model *m, const hf_workspace *w, int e, double block[3][3])
{
    const bound_cable *c = (const bound_cable *)w->bound_work + e;
    (void)m;
    hf_newton_matrix_spring(c->along, fmax(c->across, 0), c->unit, block);
}

/* Decides which cables are taut, as interior.c does, and factors the matrix of the refined shape. */
static bool factor_anew(refined *p)
{
    const hf_model *m = p->m;
    if (!m->has_newton) return false;
    for (int e = 0; e < m->n_cable; e++) {
        bound_cable *c = p->cable + e;
        hf_law_cable cable = hf_workspace_cable(m, p->w, e);
        if (is_between_supports(m, e)) continue;
        bool multiplier = hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER);
        if (multiplier) {
            c->is_taut = c->T.hi / m->reference_N + c->over.hi / cable.theoretical_m > 0;
            if (!(c->is_taut > 0)) c->T = (hf_twofold){0, 0};
        }
        c->along = c->is_taut > 0 ? hf_law_stiffness_N_per_m(cable, INFINITY) : 0;
        if (multiplier && isinf(c->along))
            c->along = STIFFENING * fmax(c->T.hi, LEAST_PULL * m->reference_N) / cable.theoretical_m;
    }
    bool is_factored = hf_newton_matrix_factor_blocks(m, p->w, refined_block, &p->condition) == HF_OK;
    for (int e = 0; e < m->n_cable; e++) /* from here on `along` is of cables with a multiplier alone */
        if (!hf_law_has((hf_law)p->w->law[e], HF_LAW_HAS_MULTIPLIER)) p->cable[e].along = 0;
    return is_factored;
}

static bool is_told_apart(const refined *p)
{
    for (int e = 0; e < p->m->n_cable; e++) {
        const bound_cable *c = p->cable + e;
        if (is_between_supports(p->m, e) || !hf_law_has((hf_law)p->w->law[e], HF_LAW_HAS_MULTIPLIER)) continue;
        if (c->is_taut > 0 ? !(c->T.hi > 0) : !(c->over.hi < 0)) return false;
    }
    return true;
}

/* Brings the refined shape to the equilibrium. HF_BOUND_PROVEN, or the reason why it does not get there. */
static hf_bound_reason approach(refined *p, bool has_factor)
{
    hf_bound_reason reason = HF_BOUND_NOT_CONTRACTING;
    if (!has_factor) measure_refined(p, false);
    for (int k = has_factor ? 0 : 1; k <= MATRICES_MAX; k++) {
        if (k > 0 && !factor_anew(p)) return k == 1 && !has_factor ? HF_BOUND_NOT_DEFINITE : reason;
        double error = refine(p);
        reason = !(error < CONTRACTED) ? HF_BOUND_NOT_CONTRACTING
                 : is_told_apart(p)    ? HF_BOUND_PROVEN
                                       : HF_BOUND_SLACK_OR_TAUT;
        p->guess = SHARE_OF_GUESS * largest_sum(p, matrix_sum) / p->condition;
        if (reason == HF_BOUND_PROVEN && error < FINE_ENOUGH) break;
    }
    return reason;
}

/* ---- the least eigenvalue ---- */

/* Sets `along` to the stiffness of the proof: that of the law, but at most the largest `across`, which is less than the
 * true one and rounds off less; and as much for a cable of law length. */
static void set_proof_stiffness(refined *p)
{
    double most = 0;
    for (int e = 0; e < p->m->n_cable; e++)
        if (!is_between_supports(p->m, e)) most = fmax(most, p->cable[e].across);
    for (int e = 0; e < p->m->n_cable; e++) {
        double k = hf_law_stiffness_N_per_m(hf_workspace_cable(p->m, p->w, e), INFINITY);
        p->cable[e].along = p->cable[e].is_taut > 0 ? fmin(k, most) : 0;
    }
}

/* Assembles the matrix of the proof. Returns its largest diagonal entry. */
static double assemble_proof(refined *p, double **band, int *n, int *k)
{
    const hf_model *m = p->m;
    if (m->has_newton) {
        *band = p->w->newton_band;
        *n = hf_newton_matrix_dofs(m);
        *k = 3 * m->half_bandwidth + 2;
        return hf_newton_matrix_assemble_blocks(m, p->w, refined_block);
    }
    double largest = 0;
    *band = p->w->band;
    *n = m->n_free;
    *k = m->half_bandwidth;
    hf_form_assemble(m, p->w);
    for (int i = 0; i < m->n_free; i++)
        largest = fmax(largest, p->w->band[(size_t)i * (size_t)(m->half_bandwidth + 1)]);
    return largest;
}

/* What rounding can do to an eigenvalue: of the factorisation, by Rump (BIT 46, 2006), whose entries of row i and
 * column j err by (k + 2) u times the root of their diagonal entries, doubled for other orders of the operations; and
 * of entries assembled from cables, of which `degree` are at one node. */
static double rounding_of(int n, int k, double degree, double largest)
{
    double row = fmin(n, 2.0 * k + 1);
    return U * largest * (2.02 * (k + 4) * row + 400 + 20 * degree);
}

/* A lower bound of the least eigenvalue of the Hessian at the refined shape, N/m; 0 when there is no proof. */
static double least_eigenvalue(refined *p)
{
    int n, k;
    double *band, degree = largest_sum(p, one), guess = p->guess;
    for (;;) {
        double largest = assemble_proof(p, &band, &n, &k);
        double rounding = rounding_of(n, k, degree, largest), shift = fmax(guess, 2 * rounding);
        if (!(isfinite(largest) && largest > 0)) return 0;
        for (int i = 0; i < n; i++)
            band[(size_t)i * (size_t)(k + 1)] -= shift;
        if (hf_band_factor(n, k, band) == 0) return shift - rounding;
        if (!(guess > 2 * rounding)) return 0;
        guess *= SHARE_OF_LAST;
    }
}

/* ---- independent lengths ---- */

static bool is_active(const refined *p, int e)
{
    bool is_rigid = hf_law_has((hf_law)p->w->law[e], HF_LAW_IS_RIGID);
    return is_rigid && p->cable[e].is_taut > 0 && !is_between_supports(p->m, e);
}

/* First or last free row of an active cable. */
static int free_row(const refined *p, int e, bool last)
{
    int a = p->m->end_row[2 * e], b = p->m->end_row[2 * e + 1], low = a < b ? a : b, high = a < b ? b : a;
    return last && high < p->m->n_free ? high : low;
}

/* Writes the taut cables of law length into `order` [3 n_free] by their first free row. Returns their number; 0 and
 * *too_many when there are more than unknowns, which no shape obeys but by chance. */
static int order_active(const refined *p, int *order, bool *too_many)
{
    int n = 0;
    *too_many = false;
    for (int e = 0; e < p->m->n_cable; e++) {
        if (!is_active(p, e)) continue;
        *too_many = n == 3 * p->m->n_free;
        if (*too_many) return 0;
        int k = n++;
        for (; k > 0 && free_row(p, order[k - 1], false) > free_row(p, e, false); k--)
            order[k] = order[k - 1];
        order[k] = e;
    }
    return n;
}

/* Product of the derivatives of the lengths of two cables by the free nodes. *meets: they share one. */
static double length_product(const refined *p, int e, int f, bool *meets)
{
    const double *u = p->cable[e].unit, *v = p->cable[f].unit;
    double inner = u[0] * v[0] + u[1] * v[1] + u[2] * v[2], sum = 0;
    *meets = false;
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            int row = p->m->end_row[2 * e + a];
            if (row >= p->m->n_free || row != p->m->end_row[2 * f + b]) continue;
            sum += a == b ? inner : -inner;
            *meets = true;
        }
    return sum;
}

/* A lower bound of the least singular value of the derivative of the lengths of the n cables in `order`; 0 when there
 * is no proof. The matrix of their products takes the place of the Newton matrix. */
static double least_length_change(const refined *p, const int *order, int n)
{
    double *band = p->w->newton_band;
    bool meets;
    int k = 0;
    for (int i = 0; i < n; i++)
        for (int j = 1; i + j < n && free_row(p, order[i + j], false) <= free_row(p, order[i], true); j++) {
            length_product(p, order[i], order[i + j], &meets);
            if (meets && j > k) k = j;
        }
    size_t column = (size_t)k + 1, room = 3 * (size_t)p->m->n_free * (3 * (size_t)p->m->half_bandwidth + 3);
    if ((size_t)n * column > room) return 0;
    double rounding = rounding_of(n, k, 0, 2), shift = fmax(1e-4, 2 * rounding);
    for (;; shift = 2 * rounding) {
        memset(band, 0, (size_t)n * column * sizeof *band);
        for (int i = 0; i < n; i++)
            for (int j = 0; j <= k && i + j < n; j++)
                band[(size_t)i * column + (size_t)j] = length_product(p, order[i], order[i + j], &meets);
        for (int i = 0; i < n; i++)
            band[(size_t)i * column] -= shift;
        if (hf_band_factor(n, k, band) == 0) return sqrt(shift - rounding);
        if (!(shift > 2 * rounding)) return 0;
    }
}

/* ---- the radius of the ball ---- */

/* Radius within which there is a shape with the exact lengths; -1 when there is no proof. *extra: what the stiffness of
 * the proof adds to the force, N. */
static double lengths_radius(const refined *p, double *extra)
{
    double square = 0, bend = 0;
    bool too_many;
    int n = order_active(p, p->w->newton_integer_work, &too_many);
    *extra = 0;
    if (n == 0) return too_many ? -1 : 0;
    for (int k = 0; k < n; k++) {
        const bound_cable *c = p->cable + p->w->newton_integer_work[k];
        double over = fabs(c->over.hi) + 128 * HF_TWOFOLD_UNIT * c->length;
        square += over * over;
        bend += 1 / (c->length * c->length);
        *extra += 1.5 * c->along * over;
    }
    double least = least_length_change(p, p->w->newton_integer_work, n), radius = 2.01 * sqrt(square) / least;
    return least > 0 && 2.3 * sqrt(bend) * radius <= least / 2 ? radius : -1;
}

/* Whether cables stay slack or taut within the radius, and are long against it. */
static bool stays_apart(const refined *p, double radius)
{
    double move = 1.5 * radius;
    for (int e = 0; e < p->m->n_cable; e++) {
        const bound_cable *c = p->cable + e;
        hf_law law = (hf_law)p->w->law[e];
        if (is_between_supports(p->m, e) || is_a_spring(law)) continue;
        if (!(move < INSIDE_LENGTH * c->length)) return false;
        if (!hf_law_has(law, HF_LAW_HAS_MULTIPLIER)) continue;
        bool is_rigid = hf_law_has(law, HF_LAW_IS_RIGID);
        double least = is_rigid ? c->along * move : 0, longest = c->length - p->w->target[e];
        if (!(c->is_taut > 0) && !(c->over.hi < -move)) return false;
        if (c->is_taut > 0 && is_rigid && !(c->T.hi > least)) return false;
        if (c->is_taut > 0 && !is_rigid && !(longest > move + 4 * U * c->length)) return false;
    }
    return true;
}

/* Sets *radius of the ball around the refined shape that holds every equilibrium, m. */
static hf_bound_reason find_radius(refined *p, double *radius)
{
    const hf_model *m = p->m;
    double square = 0, extra = 0, lengths = 0;
    set_proof_stiffness(p);
    double least = least_eigenvalue(p);
    if (!(least > 0)) return HF_BOUND_NOT_DEFINITE;
    if (m->has_newton) lengths = lengths_radius(p, &extra);
    if (lengths < 0) return HF_BOUND_DEPENDENT_LENGTHS;
    for (int i = 0; i < 3 * m->n_free; i++)
        square += p->force[i].hi * p->force[i].hi;
    double rounding = HF_TWOFOLD_UNIT * (128 + 4 * largest_sum(p, one)) * largest_sum(p, rounded_force);
    double force = 1.0001 * sqrt(square) + extra + rounding * sqrt(3.0 * m->n_free);
    double norm = 3 * largest_sum(p, stiffness_sum), change = 8 * largest_sum(p, stiffness_change);
    *radius = lengths + 4.1 * (force + norm * lengths) / least;
    if (!(change * *radius <= least / 2)) return HF_BOUND_NOT_CONTRACTING;
    return stays_apart(p, *radius) ? HF_BOUND_PROVEN : HF_BOUND_SLACK_OR_TAUT;
}

/* ---- the proof ---- */

/* Largest distance of a free node to its refined place. */
static double largest_move(const refined *p)
{
    const hf_model *m = p->m;
    double largest = 0;
    for (int i = 0; i < m->n_free; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            hf_twofold x = p->x[c * m->n_node + i];
            double d = (x.hi - p->w->position_m[c * m->n_node + i]) + x.lo;
            square += d * d;
        }
        largest = fmax(largest, square);
    }
    return sqrt(largest) * (1 + 16 * U);
}

static hf_twofold refined_psi(const refined *p)
{
    const hf_model *m = p->m;
    hf_twofold sum = {0, 0};
    for (int k = 0; k < m->n_inner_node; k++)
        for (int c = 0; c < 3; c++) {
            int i = c * m->n_node + m->inner_row[k];
            hf_twofold d = hf_twofold_subtract(p->x[i], hf_twofold_of(m->position_m[i]));
            add_to(&sum, hf_twofold_multiply(d, d));
        }
    return hf_twofold_root(hf_twofold_divide(sum, hf_twofold_of(m->n_inner_node)));
}

void hf_bound_prove(const hf_model *m, bool has_factor, hf_workspace *w, hf_form_result *r)
{
    refined p;
    double radius = 0;
    r->position_bound_m = r->psi_bound_m = (double)NAN;
    r->bound_reason = m->has_strut ? HF_BOUND_STRUTS : m->n_attachment ? HF_BOUND_TRUSS : HF_BOUND_NO_MATRIX;
    if (m->has_strut || m->n_attachment || (!m->has_newton && hf_workspace_iterates(m, w))) return;
    lay_out_bound(m, w, &p);
    p.condition = r->condition;
    set_first_state(&p);
    r->bound_reason = approach(&p, has_factor);
    if (r->bound_reason == HF_BOUND_PROVEN) r->bound_reason = find_radius(&p, &radius);
    if (r->bound_reason != HF_BOUND_PROVEN) return;
    hf_twofold psi = hf_twofold_subtract(refined_psi(&p), hf_twofold_of(r->psi_m));
    r->position_bound_m = largest_move(&p) + radius;
    r->psi_bound_m = fabs(psi.hi) * (1 + 4 * U) + HF_TWOFOLD_UNIT * (64 + 4.0 * m->n_inner_node) * r->psi_m + radius;
}
