/* Contents: sums at nodes - the least eigenvalue - independent lengths - the radius of the ball - the proof. The found
 * shape is computed to twice the precision (precise.c). What is then out of balance is so small that a crude proof
 * suffices: the energy is larger on the surface of a tiny ball around the precise shape than within it, so that every
 * equilibrium lies in the ball. The bound is the distance to the precise shape, plus the radius of the ball (METHOD
 * section 3). */
#include "solve/bound.h"

#include "linalg/band.h"
#include "solve/newton_matrix.h"
#include "solve/precise.h"

#include <math.h>
#include <string.h>

#define SHARE_OF_LAST 1e-3  /* part of a shift that has failed that is tried next */
#define SMALL 1e-3          /* a radius by the first matrix that is a larger part of the bound is found anew */
#define INSIDE_LENGTH 0.005 /* the ball is smaller than this part of every length */
#define TRUSS_LEFT 0.5      /* part of the truss's energy that is not needed to keep the free nodes stiff */

/* ---- sums at nodes ---- */

static double one(const hf_precise *p, int e)
{
    (void)p, (void)e;
    return 1;
}

/* phi'', N/m; of a rigid law the stiffness that the proof adds. */
static double stiffness_of(const hf_precise *p, int e)
{
    hf_law_cable cable = hf_workspace_cable(p->m, p->w, e);
    double k = hf_law_stiffness_N_per_m(cable, INFINITY);
    return isinf(k) ? p->cable[e].along : k;
}

static double stiffness_sum(const hf_precise *p, int e)
{
    return stiffness_of(p, e) + p->cable[e].across;
}

/* The same without what the proof adds, which has no gradient where the lengths are exact. */
static double own_stiffness_sum(const hf_precise *p, int e)
{
    bool is_rigid = hf_law_has((hf_law)p->w->law[e], HF_LAW_IS_RIGID);
    return (is_rigid ? 0 : stiffness_of(p, e)) + p->cable[e].across;
}

/* The Hessian of a cable of law force_density does not depend on the shape. */
static double stiffness_change(const hf_precise *p, int e)
{
    return hf_newton_matrix_is_spring((hf_law)p->w->law[e]) ? 0 : stiffness_sum(p, e) / p->cable[e].length;
}

/* What the rounding of a pull is relative to, N. */
static double rounded_force(const hf_precise *p, int e)
{
    const hf_precise_cable *c = p->cable + e;
    bool is_elastic = hf_law_has((hf_law)p->w->law[e], HF_LAW_NEEDS_EA);
    return (c->across + (is_elastic ? 2 * stiffness_of(p, e) : 0)) * c->length;
}

/* ---- the least eigenvalue ---- */

/* Sets `along` to the stiffness of the proof: that of the law, but at most the largest `across`, which is less than the
 * true one and rounds off less; and as much for a cable of law length. */
static void set_proof_stiffness(hf_precise *p)
{
    double most = 0;
    for (int e = 0; e < p->m->n_cable; e++)
        if (!hf_precise_is_fixed(p->m, e)) most = fmax(most, p->cable[e].across);
    for (int e = 0; e < p->m->n_cable; e++) {
        double k = hf_law_stiffness_N_per_m(hf_workspace_cable(p->m, p->w, e), INFINITY);
        p->cable[e].along = p->cable[e].is_taut > 0 ? fmin(k, most) : 0;
    }
}

/* Assembles the matrix of the proof. Returns its largest diagonal entry. */
static double assemble_proof(hf_precise *p, double **band, int *n, int *k)
{
    const hf_model *m = p->m;
    if (m->has_newton) {
        *band = p->w->newton_band;
        *n = hf_newton_matrix_dofs(m);
        *k = 3 * m->half_bandwidth + 2;
        return hf_newton_matrix_assemble_blocks(m, p->w, hf_precise_block);
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
    return HF_UNIT * largest * (2.02 * (k + 4) * row + 400 + 20 * degree);
}

/* Returns a lower bound of the least eigenvalue for the free nodes of the Hessian of net and truss, from which a part
 * TRUSS_LEFT of the truss's own energy is left out, N/m; 0 when the Hessian less `shift` and rounding has no factor.
 * The bound is so small that |L s| is at most the norm of the ball, in which |s|^2 counts TRUSS_LEFT / bound times. */
static double least_on_truss(hf_precise *p, double shift, const hf_flexibility_rounding *rounding)
{
    hf_precise_truss *t = &p->truss;
    double *band;
    int n, k;
    assemble_proof(p, &band, &n, &k);
    for (int i = 0; i < n; i++)
        band[(size_t)i * (size_t)(k + 1)] -= shift + rounding->free * band[(size_t)i * (size_t)(k + 1)];
    if (hf_band_factor(n, k, band) != 0 ||
        !hf_flexibility_factor_net(p->m, p->w, hf_precise_block, rounding, 1 - TRUSS_LEFT, &t->flexibility))
        return 0;
    double least = shift - rounding->free_N_per_m;
    return t->flexibility.trace > 0 ? fmin(least, TRUSS_LEFT / t->flexibility.trace) : least;
}

/* A lower bound of the least eigenvalue of the Hessian of net and truss at the precise shape, N/m; 0 when there is no
 * proof. `guess` is tried first. */
static double least_eigenvalue_on_truss(hf_precise *p, double guess)
{
    hf_flexibility_rounding rounding = hf_flexibility_rounding_of(
        p->m, &p->truss.flexibility, hf_precise_largest_sum(p, hf_precise_matrix_sum), hf_precise_largest_sum(p, one));
    double smallest = 2 * rounding.free_N_per_m;
    for (;; guess *= SHARE_OF_LAST) {
        double least = least_on_truss(p, fmax(guess, smallest), &rounding);
        if (least > 0 || !(guess > smallest)) return least;
    }
}

/* A lower bound of the least eigenvalue of the Hessian at the precise shape, N/m; 0 when there is no proof. `guess` is
 * tried first. */
static double least_eigenvalue(hf_precise *p, double guess)
{
    int n, k;
    double *band, degree = hf_precise_largest_sum(p, one);
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

/* A bound of the norm of the change of the block of a taut cable between the found and the precise shape, N/m, but
 * for an eighth of its stiffness along the cable: of the pull over the length, of the direction, and what the proof
 * adds for an error of length. */
static double block_change(const hf_precise *p, int e)
{
    const hf_model *m = p->m;
    const hf_precise_cable *c = p->cable + e;
    hf_law_cable cable = hf_workspace_cable(m, p->w, e);
    if (hf_newton_matrix_is_spring(cable.law)) return 0;
    double u[3], length = hf_newton_matrix_direction(m, p->w->position_m, e, u), square = 0;
    double across = hf_newton_matrix_tension_N(cable, length, p->w->tension_N[e]) / length;
    for (int k = 0; k < 3; k++) {
        int a = k * m->n_node + m->end_row[2 * e], b = k * m->n_node + m->end_row[2 * e + 1];
        double from = (p->x[a].hi - p->w->position_m[a]) + p->x[a].lo;
        double to = (p->x[b].hi - p->w->position_m[b]) + p->x[b].lo;
        square += (to - from) * (to - from);
    }
    double turn = 1.02 * sqrt(square) / length; /* at most 2 |d - d'| / (l + l') */
    if (!(turn < 0.01)) return INFINITY;
    double along = hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER) ? c->along : 0;
    double over = hf_law_has(cable.law, HF_LAW_IS_RIGID) ? fabs(c->over.hi) : 0;
    return fabs(c->across - across) + 16 * HF_UNIT * (c->across + fabs(across)) + across * turn +
           8 * along * turn * turn + along * over / length;
}

/* A lower bound of the least eigenvalue at the precise shape from one at the found shape; 0 when they are too far
 * apart. (u'.y)^2 >= 7/8 (u.y)^2 - 8 |u' - u|^2 |y|^2, so that a turned stiff cable costs little. */
static double carried_over(const hf_precise *p, double least)
{
    for (int e = 0; e < p->m->n_cable; e++)
        if (!(p->cable[e].is_taut > 0) && p->w->tension_N[e] != 0) return 0; /* was in the matrix */
    double now = 0.875 * least - 2.01 * hf_precise_largest_sum(p, block_change);
    return now > least / 4 ? now : 0;
}

/* ---- independent lengths ---- */

static bool is_active(const hf_precise *p, int e)
{
    bool is_rigid = hf_law_has((hf_law)p->w->law[e], HF_LAW_IS_RIGID);
    return is_rigid && p->cable[e].is_taut > 0 && !hf_precise_is_fixed(p->m, e);
}

/* First or last free row of an active cable. */
static int free_row(const hf_precise *p, int e, bool last)
{
    int a = p->m->end_row[2 * e], b = p->m->end_row[2 * e + 1], low = a < b ? a : b, high = a < b ? b : a;
    return last && high < p->m->n_free ? high : low;
}

/* Writes the taut cables of law length into `order` [3 n_free] by their first free row. Returns their number; 0 and
 * *too_many when there are more than unknowns, which no shape obeys but by chance. */
static int order_active(const hf_precise *p, int *order, bool *too_many)
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
static double length_product(const hf_precise *p, int e, int f, bool *meets)
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
static double least_length_change(const hf_precise *p, const int *order, int n)
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

/* Radius within which there is a shape with the exact lengths; -1 when there is no proof. */
static double lengths_radius(const hf_precise *p)
{
    double square = 0, bend = 0;
    bool too_many;
    int n = order_active(p, p->w->newton_integer_work, &too_many);
    if (n == 0) return too_many ? -1 : 0;
    for (int k = 0; k < n; k++) {
        const hf_precise_cable *c = p->cable + p->w->newton_integer_work[k];
        double over = fabs(c->over.hi) + 128 * HF_TWOFOLD_UNIT * c->length;
        square += over * over;
        bend += 1 / (c->length * c->length);
    }
    double least = least_length_change(p, p->w->newton_integer_work, n), radius = 2.01 * sqrt(square) / least;
    return least > 0 && 2.3 * sqrt(bend) * radius <= least / 2 ? radius : -1;
}

/* Whether cables stay slack or taut within the radius. One that is not long against it: forces that only rounding has
 * left move so soft a net that far. */
static hf_bound_reason stays_apart(const hf_precise *p, double radius)
{
    double move = 1.5 * radius;
    for (int e = 0; e < p->m->n_cable; e++) {
        const hf_precise_cable *c = p->cable + e;
        hf_law law = (hf_law)p->w->law[e];
        if (hf_precise_is_fixed(p->m, e) || hf_newton_matrix_is_spring(law)) continue;
        if (!(move < INSIDE_LENGTH * c->length)) return HF_BOUND_NOT_DEFINITE;
        if (!hf_law_has(law, HF_LAW_HAS_MULTIPLIER)) continue;
        bool is_rigid = hf_law_has(law, HF_LAW_IS_RIGID);
        double least = is_rigid ? c->along * move : 0, longest = c->length - p->w->target[e];
        if (!(c->is_taut > 0) && !(c->over.hi < -move)) return HF_BOUND_SLACK_OR_TAUT;
        if (c->is_taut > 0 && is_rigid && !(c->T.hi > least)) return HF_BOUND_SLACK_OR_TAUT;
        if (c->is_taut > 0 && !is_rigid && !(longest > move + 4 * HF_UNIT * c->length)) return HF_BOUND_SLACK_OR_TAUT;
    }
    return HF_BOUND_PROVEN;
}

/* What rounding at twice the precision adds to the gradient: of the gap, whose part in it is at most the error of the
 * pull, and of the places of the attachments. */
static double rounding_of_truss(const hf_precise *p)
{
    const hf_model *m = p->m;
    double pull = 0, move_m = 0;
    if (!m->n_attachment) return 0;
    for (int i = 3 * m->n_free; i < 3 * p->n_moving; i++) {
        pull += fabs(p->force[i].hi);
        move_m += fabs(p->x[i % 3 * m->n_node + i / 3].hi);
    }
    for (int k = 0; k < p->truss.flexibility.rank; k++)
        move_m += fabs(p->truss.s[k].hi) * sqrt(p->truss.flexibility.trace);
    double stiffness = 6 * hf_precise_largest_sum(p, stiffness_sum);
    return HF_TWOFOLD_UNIT * (16 + 48.0 * m->n_attachment) * (pull + stiffness * move_m);
}

/* Sets *radius of the ball around the precise shape that holds every equilibrium, m, from a lower bound of the least
 * eigenvalue there. */
static hf_bound_reason find_radius(hf_precise *p, double least, double *radius)
{
    const hf_model *m = p->m;
    double square = 0, lengths = 0;
    if (!(least > 0)) return HF_BOUND_NOT_DEFINITE;
    if (m->has_newton) lengths = lengths_radius(p);
    if (lengths < 0) return HF_BOUND_DEPENDENT_LENGTHS;
    for (int i = 0; i < 3 * m->n_free; i++)
        square += p->force[i].hi * p->force[i].hi;
    for (int k = 0; k < p->truss.flexibility.rank; k++)
        square += least / TRUSS_LEFT * p->truss.gap[k].hi * p->truss.gap[k].hi;
    double rounding =
        HF_TWOFOLD_UNIT * (128 + 4 * hf_precise_largest_sum(p, one)) * hf_precise_largest_sum(p, rounded_force);
    double parts = m->n_attachment ? 2 : 1; /* of the gradient: by the free nodes, and by s */
    double force = 1.0001 * sqrt(square) + rounding * sqrt(3 * parts * p->n_moving) + rounding_of_truss(p);
    double norm = 3 * parts * hf_precise_largest_sum(p, own_stiffness_sum),
           change = 8 * hf_precise_largest_sum(p, stiffness_change);
    *radius = lengths + 4.1 * (force + norm * lengths) / least;
    if (!(change * *radius <= least / 2)) return HF_BOUND_NOT_DEFINITE;
    return stays_apart(p, *radius);
}

/* By the matrix of the found shape, if its least eigenvalue is known and the precise one is near; else by one of the
 * precise shape. */
static hf_bound_reason prove_radius(hf_precise *p, double least_N_per_m, double moved_m, double *radius)
{
    if (least_N_per_m > 0 && p->is_first_matrix) {
        double least = carried_over(p, least_N_per_m);
        if (least > 0 && find_radius(p, least, radius) == HF_BOUND_PROVEN && *radius <= SMALL * moved_m)
            return HF_BOUND_PROVEN;
    }
    double guess = hf_precise_guess(p);
    set_proof_stiffness(p);
    double least = p->m->n_attachment ? least_eigenvalue_on_truss(p, guess) : least_eigenvalue(p, guess);
    return find_radius(p, least, radius);
}

/* ---- the proof ---- */

/* Largest distance of a node to its precise place. */
static double largest_move(const hf_precise *p)
{
    const hf_model *m = p->m;
    double largest = 0;
    for (int i = 0; i < p->n_moving; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            hf_twofold x = p->x[c * m->n_node + i];
            double d = (x.hi - p->w->position_m[c * m->n_node + i]) + x.lo;
            square += d * d;
        }
        largest = fmax(largest, square);
    }
    return sqrt(largest) * (1 + 16 * HF_UNIT);
}

static hf_twofold precise_psi(const hf_precise *p)
{
    const hf_model *m = p->m;
    hf_twofold sum = {0, 0};
    for (int k = 0; k < m->n_inner_node; k++)
        for (int c = 0; c < 3; c++) {
            int i = c * m->n_node + m->inner_row[k];
            hf_twofold d = hf_twofold_subtract(p->x[i], hf_twofold_of(m->position_m[i]));
            hf_twofold_add_to(&sum, hf_twofold_multiply(d, d));
        }
    return hf_twofold_root(hf_twofold_divide(sum, hf_twofold_of(m->n_inner_node)));
}

void hf_bound_prove(const hf_model *m, bool has_factor, double least_N_per_m, hf_workspace *w, hf_form_result *r)
{
    hf_precise p;
    double radius = 0, moved_m = 0;
    r->position_bound_m = r->psi_bound_m = (double)NAN;
    r->bound_reason = m->has_strut ? HF_BOUND_STRUTS : r->n_loose ? HF_BOUND_LOOSE : HF_BOUND_NO_MATRIX;
    if (m->has_strut || r->n_loose || (!m->has_newton && hf_workspace_iterates(m, w))) return;
    int n_moving = w->n_moving;
    w->n_moving = m->n_free + m->n_attachment;
    r->bound_reason = HF_BOUND_TRUSS;
    if (hf_precise_open(m, w, r->condition, &p)) r->bound_reason = hf_precise_approach(&p, has_factor);
    if (r->bound_reason == HF_BOUND_PROVEN) {
        moved_m = largest_move(&p);
        r->bound_reason = prove_radius(&p, least_N_per_m, moved_m, &radius);
    }
    w->n_moving = n_moving;
    if (r->bound_reason != HF_BOUND_PROVEN) return;
    hf_twofold psi = hf_twofold_subtract(precise_psi(&p), hf_twofold_of(r->psi_m));
    r->position_bound_m = moved_m + radius;
    /* the ball is one of all coordinates together */
    double error_m = HF_TWOFOLD_UNIT * (64 + 4.0 * m->n_inner_node) * r->psi_m + radius / sqrt(m->n_inner_node);
    r->psi_bound_m = (fabs(psi.hi) + error_m) * (1 + 8 * HF_UNIT);
}
