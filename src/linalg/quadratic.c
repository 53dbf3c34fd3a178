/* Solves a quadratic programme by the dual method of Goldfarb and Idnani:
 *
 *     H, g, active bounds of the last solution
 *       -> begin    factor H = L L'; minimum subject to these bounds; drop bounds with a negative multiplier
 *       -> worst    the caller reports the limit that x violates most; if there is none, x is the solution
 *       -> obey     move x until this limit holds; drop active limits whose multiplier becomes 0 on the way
 *       -> worst    and so on
 *
 * J with J J' = H^-1 is scratch, and R is the triangle of the active normals in terms of J. Adding and dropping a limit
 * updates both by Givens rotations.
 *
 * Contents: kernels - layout - matrices - the start */
#include "linalg/quadratic.h"

#include "linalg/band.h"
#include "linalg/dot.h"
#include "linalg/quadratic_kernel.h"

#include <math.h>
#include <string.h>

/* The normal of a limit depends on the active normals if the square of its independent part is below DEPENDENT times
 * its whole square. An active limit must then be dropped first. All tests pass with 1e-26 to 1e-14. */
#define DEPENDENT 1e-20
#define STEPS_PER_VARIABLE 50 /* maximum of limits added or dropped, per variable; tests pass with 5, not with 1 */

/* ---- kernels ---- */

static const hf_quadratic_kernels *const kernels_of_isa[] = {HF_LANE_EACH(&hf_quadratic_kernels)};

void hf_quadratic_combine(int ld, int n, const double *weight, const double *J, double *sum)
{
    kernels_of_isa[hf_lane_best_isa()]->combine(ld, 0, n, weight, J, sum);
}

/* ---- layout ---- */

hf_status hf_quadratic_create(int n_variable, hf_quadratic *to)
{
    size_t n = (size_t)n_variable, ld = (n + HF_LANES - 1) / HF_LANES * HF_LANES;
    *to = (hf_quadratic){.n = n_variable, .ld = (int)ld};
    return HF_ARENA_ARRAYS(&to->block, HF_QUADRATIC_FIELDS(HF_ARENA_ITEM));
}

/* ---- matrices ---- */

/* Computes J = L^-T for L as a band whose columns begin with the diagonal. L L' is H in the order of `order`. Eight
 * columns of L^-1, which are rows of J, are computed together in `strip`. The loop runs over the columns of L, so that
 * it has no sum and reads L once for eight columns. The columns of J are in reverse order. So row order[n-1] of J has
 * one entry, in column 0; row order[n-2] has two, in columns 0 and 1. */
static void invert_transposed(hf_quadratic *q)
{
    int n = q->n;
    for (int first = 0; first < n; first += HF_LANES) {
        int n_lane = first + HF_LANES <= n ? HF_LANES : n - first;
        memset(q->strip, 0, (size_t)n * HF_LANES * sizeof(double));
        for (int lane = 0; lane < n_lane; lane++)
            q->strip[HF_LANES * (first + lane) + lane] = 1;
        kernels_of_isa[hf_lane_best_isa()]->invert(n, first, q->triangle, q->strip);
        for (int r = 0; r < n; r++)
            for (int lane = 0; lane < n_lane; lane++)
                q->inverse[(n - 1 - r) * q->ld + q->order[first + lane]] = q->strip[HF_LANES * r + lane];
    }
}

/* Factors H = L L' in the order of `order`. Returns HF_OK or HF_SINGULAR. */
static hf_status factor(hf_quadratic *q, const double *hessian)
{
    int n = q->n;
    double *L = q->triangle; /* the array is free until a limit is active */
    for (int c = 0; c < n; c++) {
        int j = q->order[c];
        for (int r = c; r < n; r++) {
            int i = q->order[r];
            L[c * n + r - c] = i > j ? hessian[i * n + j] : hessian[j * n + i];
        }
        memset(L + c * n + n - c, 0, (size_t)c * sizeof(double));
    }
    return hf_band_factor(n, n - 1, L) == 0 ? HF_OK : HF_SINGULAR;
}

/* Computes the Givens rotation that turns the pair (*f, *g) into (length, 0), and applies it to the pair. */
static void rotate(double *f, double *g, double *cosine, double *sine)
{
    double length = sqrt(*f * *f + *g * *g);
    *cosine = length > 0 ? *f / length : 1;
    *sine = length > 0 ? *g / length : 0;
    *f = length;
    *g = 0;
}

/* Adds a limit to the active ones. d = J' normal. */
static void take_in(hf_quadratic *q, double *d, hf_quadratic_active limit)
{
    int m = q->n_active, n = q->n;
    double *cosine = q->scratch + 4 * q->ld, *sine = cosine + q->ld;
    for (int i = n - 2; i >= m; i--)
        rotate(d + i, d + i + 1, cosine + i, sine + i);
    kernels_of_isa[hf_lane_best_isa()]->turn(q->ld, m, n - 2, cosine, sine, q->inverse);
    memcpy(q->triangle + m * n, d, (size_t)(m + 1) * sizeof(double));
    q->active[q->n_active++] = limit;
}

/* Removes active limit k. Rotations make R without its column k triangular again. */
static void let_go(hf_quadratic *q, int k)
{
    int n = q->n;
    double cosine, sine, *R = q->triangle;
    q->n_active--;
    for (int j = k; j < q->n_active; j++) {
        memcpy(R + j * n, R + (j + 1) * n, (size_t)(j + 2) * sizeof(double));
        q->active[j] = q->active[j + 1];
    }
    for (int j = k; j < q->n_active; j++) {
        rotate(R + j * n + j, R + j * n + j + 1, &cosine, &sine);
        kernels_of_isa[hf_lane_best_isa()]->turn(q->ld, 0, 0, &cosine, &sine, q->inverse + j * q->ld);
        for (int c = j + 1; c < q->n_active; c++) {
            double *f = R + c * n + j, old = f[0];
            f[0] = cosine * old + sine * f[1];
            f[1] = cosine * f[1] - sine * old;
        }
    }
}

/* Computes z, the sum of the columns of J from column m on, weighted with d. */
static void find_direction(const hf_quadratic *q, int m, const double *d, double *z)
{
    kernels_of_isa[hf_lane_best_isa()]->combine(q->ld, m, q->n, d, q->inverse, z);
}

/* Moves x until `limit` holds with equality, and adds it to the active limits. An active limit whose multiplier would
 * become negative is removed first. Returns HF_DIFFERENT if no step is possible or no steps are left. */
static hf_status obey(hf_quadratic *q, const hf_quadratic_limit *limit, int *steps_left)
{
    int n = q->n;
    double own = 0, *d = q->scratch, *z = d + q->ld, *r = z + q->ld;
    while ((*steps_left)-- > 0) {
        int m = q->n_active, blocking = -1;
        double dual_step = INFINITY, free_square, whole;
        for (int j = 0; j < n && limit->only >= 0; j++) /* d = J' normal */
            d[j] = limit->normal[limit->only] * q->inverse[j * q->ld + limit->only];
        if (limit->only < 0) hf_dots((size_t)n, (size_t)n, q->inverse, (size_t)q->ld, limit->normal, d);
        free_square = hf_dot((size_t)(n - m), d + m, d + m);
        whole = hf_dot((size_t)n, d, d);
        find_direction(q, m, d, z);
        for (int i = m - 1; i >= 0; i--) {
            double sum = d[i];
            for (int j = i + 1; j < m; j++)
                sum -= q->triangle[j * n + i] * r[j];
            r[i] = sum / q->triangle[i * n + i];
            if (r[i] > 0 && q->active[i].multiplier / r[i] < dual_step) {
                dual_step = q->active[i].multiplier / r[i];
                blocking = i;
            }
        }
        double short_of = limit->bound - hf_dot((size_t)n, limit->normal, q->x);
        double full_step = free_square > DEPENDENT * whole ? fmax(short_of, 0) / free_square : INFINITY;
        double step = fmin(dual_step, full_step);
        if (!isfinite(step)) return HF_DIFFERENT;
        for (int i = 0; i < n && isfinite(full_step); i++)
            q->x[i] += step * z[i];
        for (int i = 0; i < m; i++)
            q->active[i].multiplier -= step * r[i];
        own += step;
        if (full_step <= dual_step) {
            double sign = limit->only >= 0 ? limit->normal[limit->only] : 0;
            take_in(q, d, (hf_quadratic_active){limit->kind, limit->only, sign, limit->bound, own});
            return HF_OK;
        }
        let_go(q, blocking);
    }
    return HF_DIFFERENT;
}

/* ---- the start ---- */

/* Makes the bounds that were active in the last solution active again, and puts their variables at the end
 * of the order. */
static void guess(hf_quadratic *q, const double *low, const double *high)
{
    int n = q->n, n_free = 0;
    q->n_active = 0;
    for (int i = 0; i < n; i++) {
        double bound = q->side[i] == 0 ? INFINITY : q->side[i] > 0 ? low[i] : high[i];
        if (!isfinite(bound)) {
            q->order[n_free++] = i;
            continue;
        }
        q->order[n - 1 - q->n_active] = i;
        q->active[q->n_active++] = (hf_quadratic_active){0, i, q->side[i], q->side[i] * bound, 0};
    }
}

/* Computes the minimum with the active limits as equations: x = J (y, -J2' g) with R' y = their bounds. The multipliers
 * are R^-1 (J1' g + y). J1 is the first n_active columns of J, J2 the others. Returns the index of the active limit
 * with the most negative multiplier, or -1 if none is negative. */
static int hold(hf_quadratic *q, const double *gradient)
{
    int n = q->n, m = q->n_active, worst = -1;
    double *share = q->scratch, *y = share + q->ld, least = 0;
    hf_dots((size_t)n, (size_t)n, q->inverse, (size_t)q->ld, gradient, share);
    for (int j = 0; j < n; j++)
        y[j] = -share[j];
    for (int j = 0; j < m; j++)
        y[j] = (q->active[j].bound - hf_dot((size_t)j, q->triangle + j * n, y)) / q->triangle[j * n + j];
    find_direction(q, 0, y, q->x);
    for (int i = m - 1; i >= 0; i--) {
        double sum = share[i] + y[i];
        for (int j = i + 1; j < m; j++)
            sum -= q->triangle[j * n + i] * q->active[j].multiplier;
        double multiplier = q->active[i].multiplier = sum / q->triangle[i * n + i];
        q->x[q->active[i].only] = q->active[i].sign * q->active[i].bound;
        if (multiplier < least) least = multiplier, worst = i;
    }
    return worst;
}

/* Begins at the minimum subject to the bounds that were active in the last solution. Bounds with a negative
 * multiplier are removed. The resulting x solves the programme with some of the limits; the dual method requires this
 * of every iterate. If no bound was active, x is the unconstrained minimum -H^-1 g, and J is computed when the first
 * limit is violated. */
static hf_status begin(hf_quadratic *q, const double *hessian, const double *gradient, const double *low,
                       const double *high, bool *has_inverse)
{
    int n = q->n;
    guess(q, low, high);
    HF_TRY(factor(q, hessian));
    *has_inverse = q->n_active > 0;
    if (!*has_inverse) {
        for (int i = 0; i < n; i++)
            q->x[i] = -gradient[i];
        hf_band_back_solve(n, n - 1, 1, q->triangle, q->x, n);
        return HF_OK;
    }
    invert_transposed(q);
    for (int k = 0; k < q->n_active; k++)
        for (int j = 0; j <= k; j++)
            q->triangle[k * n + j] = q->active[k].sign * q->inverse[j * q->ld + q->active[k].only];
    for (int k = hold(q, gradient); k >= 0; k = hold(q, gradient))
        let_go(q, k);
    return HF_OK;
}

hf_status hf_quadratic_solve(hf_quadratic *q, const double *hessian, const double *gradient, const double *low,
                             const double *high, hf_quadratic_worst *worst, void *context)
{
    int steps_left = STEPS_PER_VARIABLE * (q->n + 1);
    hf_quadratic_limit limit = {.normal = q->scratch + 3 * q->ld};
    bool has_inverse;
    HF_TRY(begin(q, hessian, gradient, low, high, &has_inverse));
    for (;; has_inverse = true) {
        memset(limit.normal, 0, (size_t)q->n * sizeof(double));
        limit.only = -1;
        if (!worst(context, q->x, &limit)) break;
        if (!has_inverse) invert_transposed(q);
        HF_TRY(obey(q, &limit, &steps_left));
    }
    memset(q->side, 0, (size_t)q->n * sizeof(int));
    for (int k = 0; k < q->n_active; k++)
        if (q->active[k].only >= 0) q->side[q->active[k].only] = q->active[k].sign > 0 ? 1 : -1;
    return HF_OK;
}
