#include "linalg/quadratic.h"

#include "base/arena.h"
#include "linalg/band.h"
#include "linalg/dot.h"

#include <math.h>
#include <string.h>

/* A limit whose normal is this near to a combination of the active ones (as a part of its square) adds nothing: an
 * active one must go first. No test fails from 1e-26 to 1e-14. */
#define DEPENDENT 1e-20
#define STEPS_PER_VARIABLE 50 /* of limits taken in or let go: 5 pass every test, 1 does not; against cycles */

static void lay_out(hf_arena *a, hf_quadratic *q)
{
    size_t n = (size_t)q->n;
    q->inverse = hf_arena_take(a, n * n, sizeof(double));
    q->triangle = hf_arena_take(a, n * n, sizeof(double));
    q->x = hf_arena_take(a, n, sizeof(double));
    q->active = hf_arena_take(a, n, sizeof *q->active);
    q->side = hf_arena_take(a, n, sizeof(int));
    q->order = hf_arena_take(a, n, sizeof(int));
    q->scratch = hf_arena_take(a, 4 * n, sizeof(double));
    q->strip = hf_arena_take(a, n, sizeof *q->strip);
}

hf_status hf_quadratic_create(int n, hf_quadratic *q)
{
    hf_arena arena = {0};
    *q = (hf_quadratic){.n = n};
    hf_status status = HF_ARENA_MAKE(&arena, lay_out(&arena, q));
    q->block = arena.block;
    return status;
}

void hf_quadratic_free(hf_quadratic *q)
{
    hf_arena arena = {.block = q->block};
    hf_arena_free(&arena);
    *q = (hf_quadratic){0};
}

/* J = L^-T for L as a band whose columns begin with the diagonal, L L' being H in the order of `order`. Columns of
 * L^-1, rows of J, are made side by side in `strip`, by columns of L, so that the inner loop has no sum and L passes
 * once for as many. The columns of J are in reverse: row order[n-1] of J has one entry, in column 0, row order[n-2]
 * two, in columns 0 and 1, ... */
static void invert_transposed(hf_quadratic *q)
{
    int n = q->n;
    hf_quadratic_strip *restrict strip = q->strip;
    for (int first = 0; first < n; first += HF_QUADRATIC_STRIP) {
        int n_lane = first + HF_QUADRATIC_STRIP <= n ? HF_QUADRATIC_STRIP : n - first;
        memset(strip, 0, (size_t)n * sizeof *strip);
        for (int lane = 0; lane < n_lane; lane++)
            strip[first + lane][lane] = 1;
        for (int k = first; k < n; k++) {
            const double *restrict l = q->triangle + k * n - k; /* entry (i, k) is l[i] */
            hf_quadratic_strip x = strip[k] /= l[k];
            for (int i = k + 1; i < n; i++)
                strip[i] -= x * l[i];
        }
        for (int r = 0; r < n; r++)
            for (int lane = 0; lane < n_lane; lane++)
                q->inverse[(n - 1 - r) * n + q->order[first + lane]] = strip[r][lane];
    }
}

/* Factor H = L L' in the order of `order`. */
static hf_status factor(hf_quadratic *q, const double *hessian)
{
    int n = q->n;
    double *L = q->triangle; /* which is needed as soon as a limit is active */
    memset(L, 0, (size_t)n * (size_t)n * sizeof(double));
    for (int c = 0; c < n; c++)
        for (int r = c; r < n; r++) {
            int i = q->order[r], j = q->order[c];
            L[c * n + r - c] = i > j ? hessian[i * n + j] : hessian[j * n + i];
        }
    return hf_band_factor(n, n - 1, L) == 0 ? HF_OK : HF_SINGULAR;
}

/* Turn columns a and b of J so that the pair (*f, *g), rows a and b of a column of R, becomes (length, 0). */
static void rotate(double *f, double *g, double *cosine, double *sine)
{
    double length = sqrt(*f * *f + *g * *g);
    *cosine = length > 0 ? *f / length : 1;
    *sine = length > 0 ? *g / length : 0;
    *f = length;
    *g = 0;
}

static void turn_columns(hf_quadratic *q, int a, double cosine, double sine)
{
    int n = q->n;
    double *restrict u = q->inverse + a * n, *restrict v = u + n;
    for (int i = 0; i < n; i++) {
        double old = u[i];
        u[i] = cosine * old + sine * v[i];
        v[i] = cosine * v[i] - sine * old;
    }
}

/* Take in a limit whose normal is d = J' normal in terms of J. */
static void take_in(hf_quadratic *q, double *d, hf_quadratic_active limit)
{
    int m = q->n_active, n = q->n;
    double cosine, sine;
    for (int i = n - 2; i >= m; i--) {
        rotate(d + i, d + i + 1, &cosine, &sine);
        turn_columns(q, i, cosine, sine);
    }
    memcpy(q->triangle + m * n, d, (size_t)(m + 1) * sizeof(double));
    q->active[q->n_active++] = limit;
}

/* Let the active limit k go: R without column k is made triangular again. */
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
        turn_columns(q, j, cosine, sine);
        for (int c = j + 1; c < q->n_active; c++) {
            double *f = R + c * n + j, old = f[0];
            f[0] = cosine * old + sine * f[1];
            f[1] = cosine * f[1] - sine * old;
        }
    }
}

/* d = J' normal. */
static void find_share(const hf_quadratic *q, const hf_quadratic_limit *limit, double *d)
{
    int n = q->n;
    for (int j = 0; j < n && limit->only >= 0; j++)
        d[j] = limit->normal[limit->only] * q->inverse[j * n + limit->only];
    for (int j = 0; j < n && limit->only < 0; j++)
        d[j] = hf_dot((size_t)n, q->inverse + j * n, limit->normal);
}

/* z = the columns of J from the m-th on, times d. */
static void find_direction(const hf_quadratic *q, int m, const double *d, double *restrict z)
{
    int n = q->n;
    memset(z, 0, (size_t)n * sizeof(double));
    for (int j = m; j < n; j++) {
        const double *restrict column = q->inverse + j * n;
        for (int i = 0; i < n; i++)
            z[i] += d[j] * column[i];
    }
}

/* Move until `limit` holds, letting active limits go whose multipliers would become negative. */
static hf_status obey(hf_quadratic *q, const hf_quadratic_limit *limit, int *steps_left)
{
    int n = q->n;
    double own = 0, *d = q->scratch, *z = d + n, *r = z + n;
    while ((*steps_left)-- > 0) {
        int m = q->n_active, blocking = -1;
        double dual_step = INFINITY, free_square, whole;
        find_share(q, limit, d);
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

/* Put the variables whose bounds held the last answer at the end of the order, and take these bounds as active. */
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

/* The least under the active limits as equations: x = J (y, -J2' g) with R' y = their bounds, and the multipliers
 * R^-1 (J1' g + y). Returns the most negative multiplier's limit; -1: there is none. */
static int hold(hf_quadratic *q, const double *gradient)
{
    int n = q->n, m = q->n_active, worst = -1;
    double *share = q->scratch, *y = share + n, least = 0;
    for (int j = 0; j < n; j++)
        y[j] = -(share[j] = hf_dot((size_t)n, q->inverse + j * n, gradient));
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

/* Begin at the least under the bounds that held the last answer, without those that now pull the wrong way: what is
 * left is the answer to a part of the limits, as each point on the way is. Without such bounds that is the free minimum
 * x = -H^-1 g, and J is made when the first limit is broken. */
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
            q->triangle[k * n + j] = q->active[k].sign * q->inverse[j * n + q->active[k].only];
    for (int k = hold(q, gradient); k >= 0; k = hold(q, gradient))
        let_go(q, k);
    return HF_OK;
}

static void remember_sides(hf_quadratic *q)
{
    memset(q->side, 0, (size_t)q->n * sizeof(int));
    for (int k = 0; k < q->n_active; k++)
        if (q->active[k].only >= 0) q->side[q->active[k].only] = q->active[k].sign > 0 ? 1 : -1;
}

hf_status hf_quadratic_solve(hf_quadratic *q, const double *hessian, const double *gradient, const double *low,
                             const double *high, hf_quadratic_worst *worst, void *context)
{
    int steps_left = STEPS_PER_VARIABLE * (q->n + 1);
    hf_quadratic_limit limit = {.normal = q->scratch + 3 * q->n};
    bool has_inverse;
    HF_TRY(begin(q, hessian, gradient, low, high, &has_inverse));
    for (;; has_inverse = true) {
        memset(limit.normal, 0, (size_t)q->n * sizeof(double));
        limit.only = -1;
        if (!worst(context, q->x, &limit)) break;
        if (!has_inverse) invert_transposed(q);
        HF_TRY(obey(q, &limit, &steps_left));
    }
    remember_sides(q);
    return HF_OK;
}
