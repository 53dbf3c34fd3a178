/* Solves linear programmes in tensions. tension_programme.h describes the interface. All tensions are divided by the
 * reference tension.
 *
 *     constraints: lower and upper bounds of the tensions that are not fixed, then the rows; slack s, multiplier z
 *         |
 *         v
 *     residuals of equilibrium, slacks and multipliers  ---- all small: done
 *         | D = sum of z/s by cable; band A D^-1 A', factored; Schur complement of the shared variables
 *         v
 *     predicted step to z s = 0, then corrected step to z s = mu; both end before a slack or a multiplier is 0
 *
 * Contents: layout, constraints, residuals, matrices, steps, the iteration. */
#include "solve/tension_programme.h"

#include "base/arena.h"
#include "linalg/band.h"
#include "linalg/dense.h"
#include "solve/newton_matrix.h"

#include <math.h>
#include <string.h>

#define ITERATION_MAX 60
/* Maximum nodal force and maximum error of a slack, over the reference tension, and the maximum of z's, at the end. */
#define EXACT 1e-6
#define GAP 1e-7
/* Shift of the matrix over its maximum diagonal entry; a failed factorisation multiplies it by 100. */
#define SHIFT 1e-13
/* Number of refinements of each solution, which undo the shift. */
#define REFINEMENTS 1
/* Part of the way to the nearest bound that a step takes. */
#define PART 0.995
/* A step shorter than this part of a whole one leads nowhere. The iteration ends after STUCK such steps. */
#define SHORT 1e-4
#define STUCK 4

/* ---- layout ---- */

/* The arrays of the iteration; e is the number of cables, n that of equations, k that of constraints, y that of shared
 * variables. */
#define ITERATION_FIELDS(X)                                                                                            \
    X(double, unit, 3 * e, "[n_cable][3] from the first end to the second")                                            \
    X(double, tension, e, "T")                                                                                         \
    X(double, tension_step, e, "")                                                                                     \
    X(double, stiff, e, "D: sum of z/s; of a fixed tension 0")                                                         \
    X(double, coupled, y *e, "[n_shared][n_cable] sum of sign g z/s")                                                  \
    X(double, pull, e, "residual of the multipliers, then scratch")                                                    \
    X(double, stretch, e, "scratch: A' of a vector")                                                                   \
    X(double, part, e, "scratch: a vector of cables before A")                                                         \
    X(double, force, n, "residual of equilibrium, -P - A T")                                                           \
    X(double, multiplier, n, "of equilibrium")                                                                         \
    X(double, multiplier_step, n, "")                                                                                  \
    X(double, right, n, "scratch: right-hand side")                                                                    \
    X(double, rest, n, "scratch: its residual, then the correction of a solution")                                     \
    X(double, column, y *n, "[n_shared][n] solutions for the shared variables")                                        \
    X(hf_tension_row, row, k, "the constraints, with bounds over the reference tension")                               \
    X(double, slack, k, "s")                                                                                           \
    X(double, weight, k, "z")                                                                                          \
    X(double, slack_step, k, "")                                                                                       \
    X(double, weight_step, k, "")                                                                                      \
    X(double, miss, k, "residual of the slacks")                                                                       \
    X(double, aim, k, "required change of z s")                                                                        \
    X(double, band, n *((size_t)to->half_bandwidth + 1), "[n][half_bandwidth+1]")

typedef struct {
    const hf_tension_programme *of;
    const hf_model *m;
    int n, half_bandwidth, n_row, n_shared;
    double unit_N;
    ITERATION_FIELDS(HF_ARENA_MEMBER)
    double shared[HF_TENSION_SHARED_MAX], shared_step[HF_TENSION_SHARED_MAX];
    double shared_pull[HF_TENSION_SHARED_MAX]; /* residual of the multipliers of the shared variables */
    double schur[HF_TENSION_SHARED_MAX * HF_TENSION_SHARED_MAX];
    int pivot[HF_TENSION_SHARED_MAX];
    double gap, most_force, most_miss;
    void *block;
} iteration;

/* ---- constraints ---- */

static bool is_fixed(const iteration *q, int e)
{
    return !(q->of->lower_N[e] < q->of->upper_N[e]);
}

static void add_row(iteration *q, hf_tension_row row)
{
    row.bound_N /= q->unit_N;
    q->row[q->n_row++] = row;
}

static double row_value(const hf_tension_row *row, const double *tension, const double *shared)
{
    double value = row->sign * tension[row->cable];
    for (int i = 0; i < 2; i++)
        if (row->shared[i] >= 0) value += row->by[i] * shared[row->shared[i]];
    return value;
}

/* Starts with every slack at least a tenth of the reference tension, and with multipliers that are small where the
 * slack is large. */
static void begin(iteration *q)
{
    const hf_tension_programme *of = q->of;
    const hf_model *m = q->m;
    for (int e = 0; e < m->n_cable; e++) {
        hf_newton_matrix_direction(m, m->position_m, e, q->unit + 3 * (size_t)e);
        q->tension[e] = fmin(fmax(of->start_N[e], of->lower_N[e]), of->upper_N[e]) / q->unit_N;
        if (is_fixed(q, e)) continue;
        add_row(q, (hf_tension_row){e, 1, of->lower_N[e], {-1, -1}, {0}});
        if (isfinite(of->upper_N[e])) add_row(q, (hf_tension_row){e, -1, -of->upper_N[e], {-1, -1}, {0}});
    }
    for (int i = 0; i < of->n_row; i++)
        add_row(q, of->row[i]);
    for (int i = 0; i < q->n_row; i++) {
        q->slack[i] = fmax(row_value(&q->row[i], q->tension, q->shared) - q->row[i].bound_N, 0.1);
        q->weight[i] = (1 + 0.1 / q->slack[i]) / q->n_row;
    }
}

/* ---- equilibrium ---- */

/* Returns the row of one end of a cable in the equations, or -1 for a node that needs no equilibrium. */
static int row_at(const iteration *q, int end)
{
    int row = q->m->end_row[end];
    return row >= q->m->n_free || (q->of->is_open && q->of->is_open[row]) ? -1 : row;
}

/* Adds `by` A x to force [n]. */
static void add_forces(const iteration *q, double by, const double *x, double *force)
{
    for (int e = 0; e < q->m->n_cable; e++) {
        int a = row_at(q, 2 * e), b = row_at(q, 2 * e + 1);
        for (int c = 0; c < 3; c++) {
            if (a >= 0) force[3 * a + c] += by * x[e] * q->unit[3 * e + c];
            if (b >= 0) force[3 * b + c] -= by * x[e] * q->unit[3 * e + c];
        }
    }
}

/* Sets stretch [n_cable] to A' x; 0 for fixed tensions. */
static void set_stretches(const iteration *q, const double *x, double *stretch)
{
    for (int e = 0; e < q->m->n_cable; e++) {
        int a = row_at(q, 2 * e), b = row_at(q, 2 * e + 1);
        stretch[e] = 0;
        for (int c = 0; c < 3 && !is_fixed(q, e); c++)
            stretch[e] += q->unit[3 * e + c] * ((a >= 0 ? x[3 * a + c] : 0) - (b >= 0 ? x[3 * b + c] : 0));
    }
}

static void set_force(iteration *q)
{
    const hf_model *m = q->m;
    memset(q->force, 0, (size_t)q->n * sizeof *q->force);
    for (int i = 0; m->load_N && i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            if (!q->of->is_open || !q->of->is_open[i]) q->force[3 * i + c] = -m->load_N[c * m->n_node + i] / q->unit_N;
    add_forces(q, -1, q->tension, q->force);
}

/* Returns false if fixed tensions alone leave a force at a node, so that no others can hold it. */
static bool fixed_hold(iteration *q)
{
    const hf_model *m = q->m;
    set_force(q);
    memset(q->multiplier_step, 0, (size_t)q->n * sizeof *q->multiplier_step); /* 1: a tension there is not fixed */
    for (int end = 0; end < 2 * m->n_cable; end++)
        if (!is_fixed(q, end / 2) && row_at(q, end) >= 0) q->multiplier_step[3 * row_at(q, end)] = 1;
    for (int i = 0; i < q->n; i++)
        if (q->multiplier_step[i - i % 3] < 1 && fabs(q->force[i]) > EXACT) return false;
    return true;
}

/* ---- residuals ---- */

static void set_residuals(iteration *q)
{
    set_force(q);
    set_stretches(q, q->multiplier, q->stretch);
    q->gap = q->most_force = q->most_miss = 0;
    for (int e = 0; e < q->m->n_cable; e++)
        q->pull[e] = -q->stretch[e];
    for (int y = 0; y < q->n_shared; y++)
        q->shared_pull[y] = q->of->cost[y];
    for (int i = 0; i < q->n_row; i++) {
        const hf_tension_row *row = &q->row[i];
        q->miss[i] = row_value(row, q->tension, q->shared) - row->bound_N - q->slack[i];
        q->most_miss = fmax(q->most_miss, fabs(q->miss[i]));
        q->gap += q->slack[i] * q->weight[i];
        if (!is_fixed(q, row->cable)) q->pull[row->cable] -= row->sign * q->weight[i];
        for (int k = 0; k < 2; k++)
            if (row->shared[k] >= 0) q->shared_pull[row->shared[k]] -= row->by[k] * q->weight[i];
    }
    for (int i = 0; i < q->n; i++)
        q->most_force = fmax(q->most_force, fabs(q->force[i]));
}

/* ---- matrices ---- */

static void sum_weights(iteration *q)
{
    int n_cable = q->m->n_cable, n_shared = q->n_shared;
    memset(q->stiff, 0, (size_t)n_cable * sizeof *q->stiff);
    memset(q->coupled, 0, (size_t)n_cable * (size_t)n_shared * sizeof *q->coupled);
    memset(q->schur, 0, sizeof q->schur);
    for (int i = 0; i < q->n_row; i++) {
        const hf_tension_row *row = &q->row[i];
        double d = q->weight[i] / q->slack[i];
        bool varies = !is_fixed(q, row->cable);
        if (varies) q->stiff[row->cable] += d;
        for (int k = 0; k < 2; k++) {
            if (row->shared[k] < 0) continue;
            if (varies) q->coupled[row->shared[k] * (ptrdiff_t)n_cable + row->cable] += row->sign * row->by[k] * d;
            for (int j = 0; j < 2; j++)
                if (row->shared[j] >= 0)
                    q->schur[row->shared[k] * n_shared + row->shared[j]] += row->by[k] * row->by[j] * d;
        }
    }
}

static hf_status factor_springs(iteration *q)
{
    size_t column = (size_t)q->half_bandwidth + 1;
    for (double shift = SHIFT; shift < 1; shift *= 100) {
        double largest = 0;
        memset(q->band, 0, (size_t)q->n * column * sizeof *q->band);
        for (int e = 0; e < q->m->n_cable; e++) {
            double block[3][3];
            int a = row_at(q, 2 * e), b = row_at(q, 2 * e + 1);
            if ((a < 0 && b < 0) || is_fixed(q, e)) continue;
            hf_newton_matrix_spring(1 / q->stiff[e], 0, q->unit + 3 * (size_t)e, block);
            hf_newton_matrix_add_block(q->band, (int)column, a, b, block);
        }
        for (size_t i = 0; i < (size_t)q->n; i++)
            largest = fmax(largest, q->band[i * column]);
        for (size_t i = 0; i < (size_t)q->n; i++)
            q->band[i * column] += shift * (largest > 0 ? largest : 1); /* 0: no equation has a varied tension */
        if (hf_band_factor(q->n, q->half_bandwidth, q->band) == 0) return HF_OK;
    }
    return HF_SINGULAR;
}

/* Sets part [n_cable] to x / D, 0 for fixed tensions. */
static void divide(const iteration *q, const double *x, double *part)
{
    for (int e = 0; e < q->m->n_cable; e++)
        part[e] = is_fixed(q, e) ? 0 : x[e] / q->stiff[e];
}

static double dot(int n, const double *a, const double *b)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Solves A D^-1 A' x = b; x replaces b. */
static void back_solve(iteration *q, double *b)
{
    int n = q->n;
    memcpy(q->right, b, (size_t)n * sizeof *b);
    hf_band_back_solve(n, q->half_bandwidth, 1, q->band, b, n);
    for (int k = 0; k < REFINEMENTS; k++) {
        memcpy(q->rest, q->right, (size_t)n * sizeof *b);
        set_stretches(q, b, q->stretch);
        divide(q, q->stretch, q->part);
        add_forces(q, -1, q->part, q->rest);
        hf_band_back_solve(n, q->half_bandwidth, 1, q->band, q->rest, n);
        for (int i = 0; i < n; i++)
            b[i] += q->rest[i];
    }
}

/* Factors the matrix of the equations and the Schur complement of the shared variables in it. */
static hf_status factor(iteration *q)
{
    int n_cable = q->m->n_cable, n = q->n;
    sum_weights(q);
    HF_TRY(factor_springs(q));
    memset(q->column, 0, (size_t)n * (size_t)q->n_shared * sizeof *q->column);
    for (int y = 0; y < q->n_shared; y++) {
        divide(q, q->coupled + y * (ptrdiff_t)n_cable, q->part);
        add_forces(q, 1, q->part, q->column + y * (ptrdiff_t)n);
        back_solve(q, q->column + y * (ptrdiff_t)n);
    }
    for (int y = 0; y < q->n_shared; y++) {
        set_stretches(q, q->column + y * (ptrdiff_t)n, q->stretch);
        for (int e = 0; e < n_cable; e++)
            q->stretch[e] -= q->coupled[y * (ptrdiff_t)n_cable + e];
        divide(q, q->stretch, q->part);
        for (int x = 0; x < q->n_shared; x++)
            q->schur[y * q->n_shared + x] += dot(n_cable, q->coupled + x * (ptrdiff_t)n_cable, q->part);
    }
    return hf_dense_factor(q->n_shared, q->schur, q->pivot) == 0 ? HF_OK : HF_SINGULAR;
}

/* ---- steps ---- */

/* Sets the steps for the required changes `aim` of z s. */
static void find_step(iteration *q)
{
    int n_cable = q->m->n_cable, n = q->n;
    double *want = q->tension_step, *step = q->multiplier_step;
    for (int e = 0; e < n_cable; e++)
        want[e] = -q->pull[e];
    for (int y = 0; y < q->n_shared; y++)
        q->shared_step[y] = -q->shared_pull[y];
    for (int i = 0; i < q->n_row; i++) {
        const hf_tension_row *row = &q->row[i];
        double t = (q->aim[i] - q->weight[i] * q->miss[i]) / q->slack[i];
        want[row->cable] += row->sign * t;
        for (int k = 0; k < 2; k++)
            if (row->shared[k] >= 0) q->shared_step[row->shared[k]] += row->by[k] * t;
    }
    memcpy(step, q->force, (size_t)n * sizeof *step);
    divide(q, want, q->part);
    add_forces(q, -1, q->part, step);
    back_solve(q, step);
    set_stretches(q, step, q->stretch);
    for (int e = 0; e < n_cable; e++)
        q->stretch[e] += want[e];
    divide(q, q->stretch, q->part);
    for (int y = 0; y < q->n_shared; y++)
        q->shared_step[y] -= dot(n_cable, q->coupled + y * (ptrdiff_t)n_cable, q->part);
    hf_dense_solve(q->n_shared, q->schur, q->pivot, 1, q->shared_step);
    for (int y = 0; y < q->n_shared; y++)
        for (int i = 0; i < n; i++)
            step[i] += q->shared_step[y] * q->column[y * (ptrdiff_t)n + i];
    set_stretches(q, step, q->stretch);
    for (int e = 0; e < n_cable; e++) {
        double sum = want[e] + q->stretch[e];
        for (int y = 0; y < q->n_shared; y++)
            sum -= q->shared_step[y] * q->coupled[y * (ptrdiff_t)n_cable + e];
        want[e] = is_fixed(q, e) ? 0 : sum / q->stiff[e];
    }
    for (int i = 0; i < q->n_row; i++) {
        q->slack_step[i] = row_value(&q->row[i], q->tension_step, q->shared_step) + q->miss[i];
        q->weight_step[i] = (q->aim[i] - q->weight[i] * q->slack_step[i]) / q->slack[i];
    }
}

/* Returns the maximum part of a step, at most 1, at which no x falls below 0. */
static double part_within(int n, const double *x, const double *step)
{
    double part = 1;
    for (int i = 0; i < n; i++)
        if (step[i] < 0) part = fmin(part, -x[i] / step[i]);
    return part;
}

static void move(int n, double part, const double *step, double *x)
{
    for (int i = 0; i < n; i++)
        x[i] += part * step[i];
}

/* Takes a predicted and a corrected step. Returns the larger of the parts of the corrected one that slacks and
 * multipliers could take. */
static double take_step(iteration *q)
{
    double mu = q->gap / q->n_row, after = 0;
    for (int i = 0; i < q->n_row; i++)
        q->aim[i] = -q->slack[i] * q->weight[i];
    find_step(q);
    double primal = part_within(q->n_row, q->slack, q->slack_step);
    double dual = part_within(q->n_row, q->weight, q->weight_step);
    for (int i = 0; i < q->n_row; i++)
        after += (q->slack[i] + primal * q->slack_step[i]) * (q->weight[i] + dual * q->weight_step[i]);
    double centre = pow(after / q->gap, 3);
    for (int i = 0; i < q->n_row; i++)
        q->aim[i] = centre * mu - q->slack[i] * q->weight[i] - q->slack_step[i] * q->weight_step[i];
    find_step(q);
    primal = fmin(1, PART * part_within(q->n_row, q->slack, q->slack_step));
    dual = fmin(1, PART * part_within(q->n_row, q->weight, q->weight_step));
    move(q->m->n_cable, primal, q->tension_step, q->tension);
    move(q->n_shared, primal, q->shared_step, q->shared);
    move(q->n_row, primal, q->slack_step, q->slack);
    move(q->n_row, dual, q->weight_step, q->weight);
    move(q->n, dual, q->multiplier_step, q->multiplier);
    return fmax(primal, dual);
}

/* ---- the iteration ---- */

static hf_status iterate(iteration *q)
{
    int n_stuck = 0;
    begin(q);
    if (!fixed_hold(q)) return HF_NOT_CONVERGED;
    for (int i = 0; i < ITERATION_MAX && n_stuck < STUCK; i++) {
        set_residuals(q);
        if (!isfinite(q->gap) || !isfinite(q->most_force)) return HF_NOT_CONVERGED;
        bool holds = q->most_force <= EXACT && q->most_miss <= EXACT;
        if (holds && (q->gap <= GAP || q->shared[0] * q->unit_N <= q->of->enough_N)) return HF_OK;
        if (factor(q) != HF_OK) return HF_NOT_CONVERGED;
        n_stuck = take_step(q) < SHORT ? n_stuck + 1 : 0;
    }
    return HF_NOT_CONVERGED;
}

hf_status hf_tension_programme_solve(const hf_tension_programme *of, double *shared_N, double *multiplier)
{
    const hf_model *m = of->model;
    iteration q = {.of = of, .m = m, .n = 3 * m->n_free, .half_bandwidth = 3 * m->half_bandwidth + 2};
    iteration *to = &q;
    size_t e = (size_t)m->n_cable, n = (size_t)q.n, y = (size_t)of->n_shared, k = 2 * e + (size_t)of->n_row;
    q.n_shared = of->n_shared;
    q.unit_N = m->reference_N;
    HF_TRY(HF_ARENA_ARRAYS(&q.block, ITERATION_FIELDS(HF_ARENA_ITEM)));
    hf_status status = iterate(&q);
    for (int i = 0; i < of->n_shared; i++)
        shared_N[i] = q.shared[i] * q.unit_N;
    if (multiplier && status == HF_OK)
        memcpy(multiplier, q.weight + q.n_row - of->n_row, (size_t)of->n_row * sizeof *multiplier);
    hf_arena_free_block(q.block);
    return status;
}
