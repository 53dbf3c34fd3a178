/* Computes the exact first-order mean of psi^2 and the shares of errors in it (M39).
 *
 *     for each coordinate of an inner node:  unit vector ---> transposed linear model (one solve)
 *                                                        ---> derivatives of the coordinate by all errors
 *                                                        ---> their squares, added to the shares */
#include "built/covariance.h"

#include "base/arena.h"
#include "search/parallel.h"

#include <math.h>
#include <string.h>

/* Number of groups of coordinates. Shares are summed within a group in order, and then over the groups, so that the
 * result does not depend on the number of threads. */
#define STRIPS 32
#define AT_ONCE 6 /* right-hand sides of one solve; their number does not change any sum */

typedef struct {
    const hf_built_errors *errors;
    double *share;   /* [STRIPS][n] sums of squares of each group */
    double *square;  /* [3 n_inner_node] variance of each coordinate */
    double *scratch; /* [n_thread][n_room] scratch of each thread */
    size_t n_room;   /* doubles of scratch for one thread */
} strips;

/* Adds the squares for the coordinates first to first + count - 1 of the inner nodes. */
static void add_coordinates(strips *s, int i_strip, int first, int count, double *room)
{
    const hf_built_linear *l = s->errors->linear;
    const hf_model *m = &l->built->model;
    size_t n = (size_t)hf_built_errors_count(s->errors), n_cable = (size_t)m->n_cable;
    double *slope = room, *strain = slope + AT_ONCE * l->n_dof, *of_z = strain + AT_ONCE * n_cable;
    double *share = s->share + (size_t)i_strip * n;
    memset(slope, 0, (size_t)count * l->n_dof * sizeof *slope);
    for (int k = 0; k < count; k++)
        slope[(size_t)k * l->n_dof + (size_t)(3 * m->inner_row[(first + k) / 3] + (first + k) % 3)] = 1;
    hf_built_linear_transpose(l, count, slope, strain, of_z + n);
    for (int k = 0; k < count; k++) {
        double sum = 0;
        hf_built_errors_slope(s->errors, strain + (size_t)k * n_cable, slope + (size_t)k * l->n_dof, of_z);
        for (size_t i = 0; i < n; i++) {
            share[i] += of_z[i] * of_z[i];
            sum += of_z[i] * of_z[i];
        }
        s->square[first + k] = sum;
    }
}

static void work_on_strip(void *context, int room, int i_strip)
{
    strips *s = context;
    long n = 3L * s->errors->linear->built->model.n_inner_node;
    int first = (int)(n * i_strip / STRIPS), end = (int)(n * (i_strip + 1) / STRIPS);
    for (; first < end && !hf_built_must_stop(s->errors->linear->built); first += AT_ONCE)
        add_coordinates(s, i_strip, first, end - first < AT_ONCE ? end - first : AT_ONCE,
                        s->scratch + (size_t)room * s->n_room);
}

static void sum_up(const strips *s, hf_covariance *c)
{
    const hf_model *m = &s->errors->linear->built->model;
    int n = hf_built_errors_count(s->errors);
    for (int i = 0; i < n; i++) {
        double sum = 0;
        for (int k = 0; k < STRIPS; k++)
            sum += s->share[(size_t)k * (size_t)n + (size_t)i];
        c->share_m2[i] = sum / m->n_inner_node;
        c->spread_m2 += c->share_m2[i];
        c->kind_m2[hf_built_errors_kind(s->errors, i)] += c->share_m2[i];
        int cable = hf_built_errors_cable(s->errors, i);
        if (cable >= 0) c->cable_m2[cable] += c->share_m2[i];
    }
    for (int k = 0; k < m->n_inner_node; k++)
        c->deviation_m[k] = sqrt(s->square[3 * k] + s->square[3 * k + 1] + s->square[3 * k + 2]);
}

/* psi has a corner at 0. Below this fraction of the RMS that errors add, its derivative is mostly rounding, so none is
 * given. */
#define NO_PSI 1e-3

/* Computes psi_by_cut by one transposed solve. The derivative of psi with respect to an inner node is d/(n psi), where
 * d is its distance from its target position. */
static void find_psi_by_cut(const hf_built_linear *l, double *room, hf_covariance *c)
{
    const hf_model *m = &l->built->model;
    double *slope = room, *strain = slope + l->n_dof, *scratch = strain + m->n_cable;
    memset(slope, 0, l->n_dof * sizeof *slope);
    for (int k = 0; k < m->n_inner_node; k++)
        for (int i = 0; i < 3; i++) {
            int row = m->inner_row[k], at = i * m->n_node + row;
            slope[3 * row + i] = (l->built->position_m[at] - m->position_m[at]) / (m->n_inner_node * c->nominal_psi_m);
        }
    hf_built_linear_transpose(l, 1, slope, strain, scratch);
    for (int e = 0; e < m->n_cable; e++)
        c->psi_by_cut[e] = c->nominal_psi_m > NO_PSI * sqrt(c->spread_m2) ? strain[e] * l->cut_N_per_m[e] : (double)NAN;
}

hf_status hf_covariance_find(const hf_built_errors *e, int n_thread, hf_covariance *c)
{
    const hf_built_linear *l = e->linear;
    const hf_model *m = &l->built->model;
    size_t n = (size_t)hf_built_errors_count(e);
    strips s = {.errors = e, .n_room = AT_ONCE * (l->n_dof + (size_t)m->n_cable + l->n_scratch) + n};
    void *scratch;
    if (n_thread < 1) n_thread = hf_parallel_cores();
    *c = (hf_covariance){0};
    HF_TRY(HF_ARENA_ARRAYS(&c->block, HF_ARRAY(c->share_m2, n), HF_ARRAY(c->cable_m2, m->n_cable),
                           HF_ARRAY(c->psi_by_cut, m->n_cable), HF_ARRAY(c->deviation_m, m->n_inner_node)));
    HF_TRY(HF_ARENA_ARRAYS(&scratch, HF_ARRAY(s.share, STRIPS * n), HF_ARRAY(s.square, 3 * (size_t)m->n_inner_node),
                           HF_ARRAY(s.scratch, (size_t)n_thread * s.n_room)));
    hf_parallel_each(n_thread, STRIPS, work_on_strip, &s);
    sum_up(&s, c);
    c->nominal_psi_m = hf_covariance_psi_m(l, NULL);
    find_psi_by_cut(l, s.scratch, c);
    hf_arena_free_block(scratch);
    return hf_built_must_stop(l->built) ? HF_INTERRUPTED : HF_OK;
}

double hf_covariance_psi_m(const hf_built_linear *l, const double *move)
{
    const hf_model *m = &l->built->model;
    double sum = 0;
    for (int k = 0; k < m->n_inner_node; k++)
        for (int c = 0; c < 3; c++) {
            int row = m->inner_row[k], at = c * m->n_node + row;
            double d = l->built->position_m[at] - m->position_m[at] + (move ? move[3 * row + c] : 0);
            sum += d * d;
        }
    return sqrt(sum / m->n_inner_node);
}
