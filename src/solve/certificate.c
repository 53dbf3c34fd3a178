/* Estimates the errors of a shape and certifies bounds for them (METHOD section 3).
 *
 *     shape and tensions in the workspace
 *         | residual / maximum sum of tensions at a node         -> backward_error
 *         | Newton matrix (newton.c), or D: factor and one step  -> condition, position_error_m
 *         | bounds, with this factor                             -> position_bound_m, psi_bound_m, bound_reason
 *
 * The bounds:
 *
 *     found shape x, factor of the Hessian H
 *         | precise.c: compute the equilibrium near x at twice the precision
 *         v
 *     precise shape x'
 *         | minimum eigenvalue of H at x': Cholesky factorisation of H minus a shift
 *         | independent lengths: a shape with exact lengths lies within rho of x'
 *         v
 *     radius R (M23): every equilibrium lies within rho + R of x'
 *         |
 *         v
 *     position_bound_m = max |x' - x| + rho + R,   psi_bound_m
 *
 * The forces out of balance at x' are so small that crude estimates suffice for R. The energy is larger on the surface
 * of a tiny ball around x' than inside it. Because the energy is convex, every equilibrium lies in the ball. */
#include "solve/certificate.h"

#include "base/elementary.h"
#include "linalg/band.h"
#include "solve/newton.h"
#include "solve/newton_matrix.h"
#include "solve/precise.h"

#include <math.h>
#include <string.h>

#define SHARE_OF_LAST 1e-3  /* factor applied to a shift for which no factor exists */
#define SMALL 1e-3          /* a radius from the first matrix is accepted up to this part of max |x' - x| */
#define INSIDE_LENGTH 0.005 /* 1.5 times the radius must be below this part of every length */
#define TRUSS_LEFT 0.5      /* part of the truss's energy that enters the norm of the ball */

/* ---- sums at nodes ---- */

static double one(const hf_precise *p, int e)
{
    (void)p, (void)e;
    return 1;
}

/* Returns phi'', N/m. For a rigid law it is the stiffness k that the certificate adds (M22). */
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

/* Returns stiffness_sum without the stiffness k that the certificate adds. At x^, where the lengths are exact, k
 * contributes nothing to the gradient. */
static double own_stiffness_sum(const hf_precise *p, int e)
{
    bool is_rigid = hf_law_has((hf_law)p->w->law[e], HF_LAW_IS_RIGID);
    return (is_rigid ? 0 : stiffness_of(p, e)) + p->cable[e].across;
}

/* Returns (phi'' + T/l) / l, a cable's term in the sum of K (M23), N/m^2. Returns 0 for a cable under law
 * force_density, because its Hessian does not depend on the shape. */
static double stiffness_change(const hf_precise *p, int e)
{
    return hf_newton_matrix_is_spring((hf_law)p->w->law[e]) ? 0 : stiffness_sum(p, e) / p->cable[e].length;
}

/* Returns the force to which the rounding error of a cable's pull is relative, N. */
static double rounded_force(const hf_precise *p, int e)
{
    const hf_precise_cable *c = p->cable + e;
    bool is_elastic = hf_law_has((hf_law)p->w->law[e], HF_LAW_NEEDS_EA);
    return (c->across + (is_elastic ? 2 * stiffness_of(p, e) : 0)) * c->length;
}

/* ---- the minimum eigenvalue ---- */

/* Sets `along` to the stiffness that the certificate uses: phi'' of the law, but at most the maximum `across`. The
 * smaller value is still a lower bound and causes smaller rounding errors. A cable under law length gets that
 * maximum. */
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

/* Assembles the matrix of the certificate: the Newton matrix, or D where the model has none. Sets *band to its storage,
 * *n to its rows and *k to its half-bandwidth. Returns its maximum diagonal entry, N/m. */
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

/* Returns a bound of the change that rounding causes in an eigenvalue, N/m. n and k are the rows and the
 * half-bandwidth, `degree` is the maximum number of cables at a node, and `largest` the maximum diagonal entry c. An
 * entry of L L' differs from that of the matrix by at most (k + 4) u sqrt(c_ii c_jj) (Rump, BIT 46, 2006). A row has up
 * to 2 k + 1 entries. The factor 2.02 covers other orders of the operations, and the remaining terms cover the assembly
 * of the entries. */
static double rounding_of(int n, int k, double degree, double largest)
{
    double row = fmin(n, 2.0 * k + 1);
    return HF_UNIT * largest * (2.02 * (k + 4) * row + 400 + 20 * degree);
}

/* Returns lambda, N/m, for which the matrix (M37) of net and truss is positive semidefinite. Returns 0 if the matrix
 * minus `shift` and `rounding` has no Cholesky factor. lambda is at most TRUSS_LEFT / tr(L L'), so |L ds| does not
 * exceed the norm of the ball, whose square is |dx|^2 + TRUSS_LEFT |ds|^2 / lambda. */
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

/* Returns lambda of (M37) at the precise shape, N/m, or 0 if none can be certified. The shift `guess`, N/m, is tried
 * first. */
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

/* Returns a lower bound of the minimum eigenvalue of the Hessian at the precise shape, N/m, or 0 if none can be
 * certified. The shift `guess`, N/m, is tried first. */
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

/* Returns a bound of the change of a taut cable's block between the found and the precise shape, N/m. It is the sum of
 * three changes: of T/l, of the direction, and of the stiffness that is added for an error of a prescribed length. An
 * eighth of the stiffness along the cable is not included; carried_over subtracts it. */
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

/* Returns a lower bound of the minimum eigenvalue at the precise shape, N/m, from the bound `least` at the found shape.
 * Returns 0 if the two shapes are too far apart. It uses (u'.y)^2 >= 7/8 (u.y)^2 - 8 |u' - u|^2 |y|^2, so a small turn
 * of a stiff cable lowers the bound only a little. */
static double carried_over(const hf_precise *p, double least)
{
    for (int e = 0; e < p->m->n_cable; e++)
        if (!(p->cable[e].is_taut > 0) && p->w->tension_N[e] != 0) return 0; /* that matrix has it as taut */
    double now = 0.875 * least - 2.01 * hf_precise_largest_sum(p, block_change);
    return now > least / 4 ? now : 0;
}

/* ---- independent lengths ---- */

/* Returns the first free row of an active cable, or with `last` the last one. */
static int free_row(const hf_precise *p, int e, bool last)
{
    int a = p->m->end_row[2 * e], b = p->m->end_row[2 * e + 1], low = a < b ? a : b, high = a < b ? b : a;
    return last && high < p->m->n_free ? high : low;
}

/* Writes the taut cables under law length into `order` [3 n_free], sorted by their first free row. Returns their
 * number. If there are more such cables than unknowns, returns 0 and sets *too_many: no shape has these lengths except
 * by chance. */
static int order_active(const hf_precise *p, int *order, bool *too_many)
{
    int n = 0;
    *too_many = false;
    for (int e = 0; e < p->m->n_cable; e++) {
        bool is_rigid = hf_law_has((hf_law)p->w->law[e], HF_LAW_IS_RIGID);
        if (!is_rigid || !(p->cable[e].is_taut > 0) || hf_precise_is_fixed(p->m, e)) continue;
        *too_many = n == 3 * p->m->n_free;
        if (*too_many) return 0;
        int k = n++;
        for (; k > 0 && free_row(p, order[k - 1], false) > free_row(p, e, false); k--)
            order[k] = order[k - 1];
        order[k] = e;
    }
    return n;
}

/* Returns the inner product of the derivatives of the lengths of cables e and f by the free coordinates. *meets becomes
 * true if the cables share a free node. */
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

/* Returns a lower bound beta of the minimum singular value of B, the derivative of the lengths of the n cables in
 * `order`. Returns 0 if none can be certified. It factors B B' minus a shift, in the storage of the Newton matrix. */
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

/* Returns rho, the radius within which a shape with the exact lengths exists, m. Returns 0 if no taut cable is under
 * law length, and -1 if no radius can be certified. */
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

/* Returns HF_BOUND_CERTIFIED if every cable stays slack or taut within the radius (m), else HF_BOUND_SLACK_OR_TAUT.
 * Returns HF_BOUND_NOT_DEFINITE if the radius is not small compared with a length. The net is then so soft that
 * rounding errors of the forces alone move it that far. */
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
    return HF_BOUND_CERTIFIED;
}

/* Returns a bound of the errors of the gradient from rounding at twice the precision on a truss, N. They arise in the
 * gap L'b - s, whose error is at most that of the pull, and in the positions of the attachments. */
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

/* Sets *radius to rho + R of (M23), m: the ball around the precise shape that contains every equilibrium. `least` is a
 * lower bound of the minimum eigenvalue at that shape, N/m. Returns HF_BOUND_CERTIFIED, or the reason why the radius is
 * not certified. */
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
    double parts = m->n_attachment ? 2 : 1; /* blocks of the gradient: free nodes, and s of a truss */
    double force = 1.0001 * sqrt(square) + rounding * sqrt(3 * parts * p->n_moving) + rounding_of_truss(p);
    double norm = 3 * parts * hf_precise_largest_sum(p, own_stiffness_sum),
           change = 8 * hf_precise_largest_sum(p, stiffness_change);
    *radius = lengths + 4.1 * (force + norm * lengths) / least;
    if (!(change * *radius <= least / 2)) return HF_BOUND_NOT_DEFINITE;
    return stays_apart(p, *radius);
}

/* Sets *radius as find_radius does. The matrix of the found shape is used if least_N_per_m, a lower bound of its
 * minimum eigenvalue, is known and the precise shape is close. Otherwise the matrix is factored again at the precise
 * shape. moved_m is the maximum distance between the two shapes, m. */
static hf_bound_reason prove_radius(hf_precise *p, double least_N_per_m, double moved_m, double *radius)
{
    if (least_N_per_m > 0 && p->is_first_matrix) {
        double least = carried_over(p, least_N_per_m);
        if (least > 0 && find_radius(p, least, radius) == HF_BOUND_CERTIFIED && *radius <= SMALL * moved_m)
            return HF_BOUND_CERTIFIED;
    }
    double guess = hf_precise_guess(p);
    set_proof_stiffness(p);
    double least = p->m->n_attachment ? least_eigenvalue_on_truss(p, guess) : least_eigenvalue(p, guess);
    return find_radius(p, least, radius);
}

/* ---- the bounds ---- */

/* Returns the maximum distance of a node between the found and the precise shape, m. */
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

/* Computes position_bound_m, psi_bound_m and bound_reason of the result whose shape is in the workspace. If has_factor
 * is true, the workspace holds a factor of the matrix at this shape: that of hf_newton_certify, or that of D in `band`
 * if there is no Newton matrix. The factor is overwritten unless the reason is HF_BOUND_STRUTS, HF_BOUND_LOOSE or
 * HF_BOUND_NO_MATRIX. least_N_per_m: a certified lower bound of its minimum eigenvalue, or 0. */
static void prove_bounds(const hf_model *m, bool has_factor, double least_N_per_m, hf_workspace *w, hf_form_result *r)
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
    if (r->bound_reason == HF_BOUND_CERTIFIED) {
        moved_m = largest_move(&p);
        r->bound_reason = prove_radius(&p, least_N_per_m, moved_m, &radius);
    }
    w->n_moving = n_moving;
    if (r->bound_reason != HF_BOUND_CERTIFIED) return;
    hf_twofold psi = hf_twofold_subtract(precise_psi(&p), hf_twofold_of(r->psi_m));
    r->position_bound_m = moved_m + radius;
    /* the radius bounds the 2-norm over all coordinates, so psi changes by at most radius / sqrt(n_inner_node) */
    double error_m = HF_TWOFOLD_UNIT * (64 + 4.0 * m->n_inner_node) * r->psi_m + radius / sqrt(m->n_inner_node);
    r->psi_bound_m = (fabs(psi.hi) + error_m) * (1 + 8 * HF_UNIT);
}

/* ---- the estimates ---- */

/* Returns the maximum sum of tensions at one free node, N. The backward error is the nodal residual divided by it. pull
 * [n_node] is scratch. */
static double largest_pull_N(const hf_model *m, const hf_workspace *w, double *pull)
{
    memset(pull, 0, (size_t)m->n_node * sizeof *pull);
    for (int e = 0; e < m->n_cable; e++)
        for (int k = 0; k < 2; k++)
            pull[m->end_row[2 * e + k]] += fabs(w->tension_N[e]);
    return hf_max_magnitude((size_t)m->n_free, pull);
}

/* Sets condition and position_error_m with D. D is assembled and factored again: its norm is needed, and the band holds
 * the factor of the form-finding. */
static void certify_linear(const hf_model *m, hf_workspace *w, hf_form_result *r)
{
    int n = m->n_free, k = m->half_bandwidth, bad_row;
    double *step = w->certificate_work, norm;
    hf_form_residual_N(m, w);
    hf_form_assemble(m, w);
    norm = hf_band_norm(n, k, w->band, step);
    if (!m->has_strut) {
        if (hf_band_factor(n, k, w->band) != 0) return;
        r->condition = hf_band_condition(n, k, w->band, norm, step, w->certificate_integer_work);
        memcpy(step, w->force_N, 3 * (size_t)m->n_node * sizeof *step);
        hf_band_back_solve(n, k, 3, w->band, step, m->n_node);
    } else {
        memcpy(step, w->force_N, 3 * (size_t)m->n_node * sizeof *step);
        if (hf_band_solve_indefinite(n, k, w->band, w->general_band, w->pivot, step, m->n_node, &bad_row) != HF_OK)
            return;
    }
    double largest = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, hf_norm(step[i], step[m->n_node + i], step[2 * m->n_node + i]));
    if (!hf_workspace_iterates(m, w) && !m->n_attachment) r->position_error_m = largest;
    if (m->has_strut)
        r->condition =
            hf_band_condition_indefinite(n, k, w->general_band, w->pivot, norm, step, w->certificate_integer_work);
}

void hf_certify(const hf_model *m, hf_workspace *w, hf_form_result *r)
{
    r->position_error_m = r->condition = r->backward_error = (double)NAN;
    r->position_bound_m = r->psi_bound_m = (double)NAN;
    r->bound_reason = HF_BOUND_NONE;
    if (r->status != HF_OK && r->status != HF_NOT_CONVERGED) return;
    r->backward_error = r->residual_N / largest_pull_N(m, w, m->has_newton ? w->newton_trial_m : w->certificate_work);
    double least_N_per_m = 0;
    if (m->has_newton)
        least_N_per_m = hf_newton_certify(m, w, r);
    else
        certify_linear(m, w, r);
    prove_bounds(m, !isnan(r->condition), least_N_per_m, w, r);
}
