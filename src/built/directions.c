/* Finds the leading directions of the errors and draws quasi-random samples:
 *
 *     linear model M ---> orthogonal iteration with M'M ---> axis V (normal errors)
 *     shares of errors ---> the largest of them              (uniform errors)
 *     point of Sobol's sequence xi, random numbers zeta ---> z = zeta + V (xi - V' zeta)
 *
 * Contents: leading directions, points, numbers. */
#include "built/directions.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "linalg/dot.h"
#include "search/parallel.h"

#include <math.h>
#include <string.h>

/* Rounds of orthogonal iteration. Samples are correct for any orthonormal directions. Means converge faster, the nearer
 * the directions are to the leading ones. */
#define ROUNDS 6
/* Streams of random numbers for the sequence itself. Their numbers continue those of the kinds of errors. */
enum { SHIFTS = HF_ERROR_STREAMS, LAST_BITS, STARTS };

/* ---- leading directions ---- */

typedef struct {
    const hf_built_errors *errors;
    int n;
    double *column;  /* [n][n_error] present directions */
    double *scratch; /* [n_thread][n_room] scratch of each thread */
    size_t n_room;
} iteration;

/* Replaces column i by M'M times it, where M is the linear model from errors to the positions of inner nodes. */
static void multiply(void *context, int room, int i)
{
    iteration *t = context;
    const hf_built_errors *e = t->errors;
    const hf_built_linear *l = e->linear;
    const hf_model *m = &l->built->model;
    double *move = t->scratch + (size_t)room * t->n_room, *slope = move + l->n_dof, *strain = slope + l->n_dof,
           *more = strain + m->n_cable, *column = t->column + (size_t)i * (size_t)hf_built_errors_count(e);
    if (hf_built_must_stop(l->built)) return;
    hf_built_errors_strain(e, 1, column, strain, move);
    hf_built_linear_apply(l, NULL, 1, strain, NULL, move, more);
    memset(slope, 0, l->n_dof * sizeof *slope);
    for (int k = 0; k < m->n_inner_node; k++)
        memcpy(slope + 3 * m->inner_row[k], move + 3 * m->inner_row[k], 3 * sizeof *slope);
    hf_built_linear_transpose(l, 1, slope, strain, more);
    hf_built_errors_slope(e, strain, slope, column);
}

/* Orthonormalises the columns in their order, by Gram-Schmidt applied twice. The order of its sums is fixed, unlike
 * LAPACK's. A column that depends linearly on earlier ones becomes 0 and has no effect. */
static void orthonormalise(iteration *t)
{
    size_t n = (size_t)hf_built_errors_count(t->errors);
    for (int i = 0; i < t->n; i++) {
        double *a = t->column + (size_t)i * n, before = sqrt(hf_dot(n, a, a));
        for (int k = 0; k < 2 * i; k++) {
            const double *b = t->column + (size_t)(k % i) * n;
            double share = hf_dot(n, a, b);
            hf_subtract(n, share, b, a);
        }
        double size = sqrt(hf_dot(n, a, a)), factor = size > 1e-10 * before ? 1 / size : 0;
        for (size_t j = 0; j < n; j++)
            a[j] *= factor;
    }
}

/* Finds the leading right singular vectors by orthogonal iteration. Returns HF_OK, HF_NO_MEMORY or HF_INTERRUPTED. */
static hf_status find_axes(const hf_built_errors *e, int n_thread, hf_directions *d)
{
    const hf_built_linear *l = e->linear;
    size_t n = (size_t)hf_built_errors_count(e);
    iteration t = {.errors = e, .n = d->n};
    void *block;
    if (n_thread < 1) n_thread = hf_parallel_cores();
    t.n_room = 2 * l->n_dof + (size_t)l->built->model.n_cable + l->n_scratch;
    HF_TRY(
        HF_ARENA_ARRAYS(&block, HF_ARRAY(t.column, (size_t)t.n * n), HF_ARRAY(t.scratch, (size_t)n_thread * t.n_room)));
    for (size_t i = 0; i < (size_t)t.n * n; i++)
        t.column[i] = hf_built_errors_uniform(e->seed, (long)(i / n), STARTS, (int)(i % n)) - 0.5;
    orthonormalise(&t);
    for (int round = 0; round < ROUNDS && !hf_built_must_stop(l->built); round++) {
        hf_parallel_each(n_thread, t.n, multiply, &t);
        orthonormalise(&t);
    }
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < t.n; k++)
            d->axis[i * (size_t)t.n + (size_t)k] = t.column[(size_t)k * n + i];
    hf_arena_free_block(block);
    return hf_built_must_stop(l->built) ? HF_INTERRUPTED : HF_OK;
}

hf_status hf_directions_find(const hf_built_errors *e, const hf_covariance *c, int n_thread, hf_directions *d)
{
    int n_error = hf_built_errors_count(e), n_answer = 3 * e->linear->built->model.n_inner_node;
    bool rotates = e->distribution == HF_DISTRIBUTION_NORMAL;
    *d = (hf_directions){.errors = e, .n = n_error < HF_DIRECTIONS_MAX ? n_error : HF_DIRECTIONS_MAX};
    if (rotates && n_answer < d->n) d->n = n_answer;
    size_t n_axis = rotates ? (size_t)n_error * (size_t)d->n : 0;
    HF_TRY(HF_ARENA_ARRAYS(&d->block, HF_ARRAY(d->axis, n_axis), HF_ARRAY(d->error, d->n)));
    d->sequence = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)d->n);
    if (!d->sequence) return HF_NO_MEMORY;
    for (int k = 0; k < d->n; k++)
        d->shift[k] = (uint32_t)(hf_built_errors_uniform(e->seed, 0, SHIFTS, k) * 0x1p30);
    if (rotates) return find_axes(e, n_thread, d);
    d->axis = NULL;
    for (int i = 0, n = 0; i < n_error; i++)
        n = hf_list_largest(i, c->share_m2, d->n, n, d->error);
    return HF_OK;
}

void hf_directions_free(hf_directions *d)
{
    if (d->sequence) gsl_qrng_free(d->sequence);
    hf_arena_free_block(d->block);
    *d = (hf_directions){0};
}

/* ---- points ---- */

/* The origin is point 0. GSL's generator begins with point 1 and has 30 bits; the lower bits are random. */
void hf_directions_points(hf_directions *d, long first, int count, double *point)
{
    double at[HF_DIRECTIONS_MAX] = {0};
    if (first < d->next) {
        gsl_qrng_init(d->sequence);
        d->next = 0;
    }
    for (; d->next < first + count; d->next++) {
        long i = d->next;
        if (i > 0) gsl_qrng_get(d->sequence, at);
        for (int k = 0; k < d->n && i >= first; k++) {
            uint32_t bits = (uint32_t)(at[k] * 0x1p30) ^ d->shift[k];
            double last = hf_built_errors_uniform(d->errors->seed, i, LAST_BITS, k);
            point[(i - first) * d->n + k] = (bits + last) * 0x1p-30;
        }
    }
}

/* ---- numbers ---- */

void hf_directions_draw(const hf_directions *d, long sample, const double *point, double *z)
{
    int n_error = hf_built_errors_count(d->errors);
    double change[HF_DIRECTIONS_MAX];
    hf_built_errors_draw(d->errors, sample, z);
    for (int k = 0; k < d->n; k++)
        change[k] = hf_built_errors_shape(d->errors->distribution, point[k]);
    if (!d->axis) {
        for (int k = 0; k < d->n; k++)
            z[d->error[k]] = change[k];
        return;
    }
    for (int i = 0; i < n_error; i++)
        hf_subtract((size_t)d->n, z[i], d->axis + (size_t)i * (size_t)d->n, change);
    for (int i = 0; i < n_error; i++)
        for (int k = 0; k < d->n; k++)
            z[i] += d->axis[(size_t)i * (size_t)d->n + (size_t)k] * change[k];
}
