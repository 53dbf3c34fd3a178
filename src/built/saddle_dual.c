/* Solves the saddle-point band by Cholesky and iterative refinement:
 *
 *     factor   P + H (W + R)^-1 H ---> Cholesky ---> solve a probe of known solution; accepted to REFINED
 *     solve    residual ---> multipliers p (Cholesky) ---> displacements x ---> add both ---> residual with R = 0
 *                ^                                                                               |
 *                +---------------------- not small enough, still shrinking ----------------------+
 *
 * Contents: making, the matrix, products, refinement, factor. */
#include "built/saddle_dual.h"

#include "base/arena.h"
#include "linalg/band.h"
#include "solve/loose.h"

#include <math.h>
#include <string.h>

#define WEAK 2.5e-7        /* weight R of displacements of 2000 times the maximum error of a length */
#define REFINEMENTS_MAX 20 /* refinement steps; a probe that takes more shows that LU is needed */
#define REFINED 1e-12      /* required residual of a solution, relative to the right-hand side */
#define ENOUGH 1e-13       /* relative residual at which refinement stops */

/* ---- making ---- */

/* Lists the cables of each row, one row after the other. */
static void list_cables(hf_saddle_dual *d)
{
    const hf_model *m = &d->linear->built->model;
    for (int i = 0; i < 2 * m->n_cable; i++)
        d->start[m->end_row[i]]++;
    for (int row = 0; row < m->n_node; row++)
        d->start[row + 1] += d->start[row];       /* the end of the cables of `row` */
    for (int i = 2 * m->n_cable - 1; i >= 0; i--) /* becomes their start */
        d->cable[--d->start[m->end_row[i]]] = i / 2;
}

hf_status hf_saddle_dual_create(const hf_built_linear *l, hf_saddle_dual *d)
{
    const hf_model *m = &l->built->model;
    *d = (hf_saddle_dual){.linear = l, .n = 3 * m->n_free, .half_bandwidth = 6 * m->half_bandwidth + 2};
    if (d->half_bandwidth > d->n - 1) d->half_bandwidth = d->n - 1;
    size_t n = (size_t)d->n, n_cable = (size_t)m->n_cable, panel = HF_SADDLE_DUAL_PANEL;
    HF_TRY(HF_ARENA_ARRAYS(&d->memory, HF_ARRAY(d->start, m->n_node + 1), HF_ARRAY(d->cable, 2 * n_cable),
                           HF_ARRAY(d->block, 9 * n_cable), HF_ARRAY(d->push, n_cable), HF_ARRAY(d->spring, m->n_free),
                           HF_ARRAY(d->weight, n), HF_ARRAY(d->band, n * ((size_t)d->half_bandwidth + 1)),
                           HF_ARRAY(d->right, panel * n), HF_ARRAY(d->solution, panel * 2 * n),
                           HF_ARRAY(d->error, panel * 2 * n), HF_ARRAY(d->probe, 2 * n)));
    list_cables(d);
    return HF_OK;
}

void hf_saddle_dual_free(hf_saddle_dual *d)
{
    hf_arena_free_block(d->memory);
    *d = (hf_saddle_dual){0};
}

/* ---- the matrix ---- */

/* Returns the weight of coordinate i including R. */
static double weight_of(const hf_saddle_dual *d, int i)
{
    return fmax(d->weight[i], WEAK);
}

/* Adds sign times block to the rows of node i and the columns of node j, within the lower triangle. */
static void add_block(hf_saddle_dual *d, int i, int j, double sign, double block[3][3])
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            int row = 3 * i + r, column = 3 * j + c;
            if (row >= column)
                d->band[(size_t)column * ((size_t)d->half_bandwidth + 1) + (size_t)(row - column)] +=
                    sign * block[r][c];
        }
}

/* Adds the part of P by the errors of cable e. */
static void add_push(hf_saddle_dual *d, int e)
{
    const hf_model *m = &d->linear->built->model;
    const int *end = m->end_row + 2 * (ptrdiff_t)e;
    const double *u = d->linear->unit + 3 * (ptrdiff_t)e;
    double block[3][3];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            block[r][c] = d->push[e] * u[r] * u[c];
    for (int p = 0; p < 2; p++)
        for (int q = 0; q < 2; q++)
            if (end[p] < m->n_free && end[q] < m->n_free) add_block(d, end[p], end[q], p == q ? 1 : -1, block);
}

static int other_end(const hf_model *m, int e, int row)
{
    return m->end_row[2 * e] == row ? m->end_row[2 * e + 1] : m->end_row[2 * e];
}

/* Computes block k of the row of H at `row`: its diagonal block for k = 0, otherwise that of one of its cables. Returns
 * the column, or -1 when it is not a free node. */
static int part_of_row(const hf_saddle_dual *d, int row, int k, double block[3][3])
{
    const hf_model *m = &d->linear->built->model;
    memset(block, 0, 9 * sizeof(double));
    if (k == 0) {
        for (int i = d->start[row]; i < d->start[row + 1]; i++)
            for (int c = 0; c < 9; c++)
                block[c / 3][c % 3] += d->block[9 * (ptrdiff_t)d->cable[i] + c];
        for (int c = 0; c < 3; c++)
            block[c][c] += d->spring[row];
        return row;
    }
    int e = d->cable[d->start[row] + k - 1], other = other_end(m, e, row);
    for (int c = 0; c < 9; c++)
        block[c / 3][c % 3] = -d->block[9 * (ptrdiff_t)e + c];
    return other < m->n_free ? other : -1;
}

/* Adds the part of H (W + R)^-1 H by the displacements of one node. */
static void add_node(hf_saddle_dual *d, int row)
{
    double left[3][3], right[3][3], product[3][3];
    int n_part = d->start[row + 1] - d->start[row] + 1;
    for (int k = 0; k < n_part; k++) {
        int i = part_of_row(d, row, k, left);
        for (int l = 0; l < n_part && i >= 0; l++) {
            int j = part_of_row(d, row, l, right);
            if (j < 0 || j > i) continue;
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++) {
                    product[r][c] = 0;
                    for (int t = 0; t < 3; t++)
                        product[r][c] += left[t][r] * right[t][c] / weight_of(d, 3 * row + t);
                }
            add_block(d, i, j, 1, product);
        }
    }
}

/* ---- products ---- */

/* Subtracts M z from `left`, where M is the matrix of the saddle-point system. */
static void take_off_product(const hf_saddle_dual *d, const double *z, double *left)
{
    const hf_model *m = &d->linear->built->model;
    for (int e = 0; e < m->n_cable; e++) {
        const int *end = m->end_row + 2 * (ptrdiff_t)e;
        const double *u = d->linear->unit + 3 * (ptrdiff_t)e, *h = d->block + 9 * (ptrdiff_t)e;
        double difference[6] = {0}, along = 0, force[6];
        for (int p = 0; p < 2; p++)
            for (int c = 0; c < 6 && end[p] < m->n_free; c++)
                difference[c] += (p ? -1 : 1) * z[6 * (ptrdiff_t)end[p] + c];
        for (int c = 0; c < 3; c++)
            along += u[c] * difference[c];
        for (int r = 0; r < 3; r++) {
            force[r] = -d->push[e] * along * u[r];
            force[3 + r] = 0;
            for (int c = 0; c < 3; c++) {
                force[r] += h[3 * r + c] * difference[3 + c];
                force[3 + r] += h[3 * r + c] * difference[c];
            }
        }
        for (int p = 0; p < 2; p++)
            for (int c = 0; c < 6 && end[p] < m->n_free; c++)
                left[6 * (ptrdiff_t)end[p] + c] -= (p ? -1 : 1) * force[c];
    }
    for (int i = 0; i < d->n; i++) {
        int p = 6 * (i / 3) + i % 3, x = p + 3;
        left[p] -= d->spring[i / 3] * z[x];
        left[x] -= d->spring[i / 3] * z[p] + d->weight[i] * z[x];
    }
}

/* Adds sign times H v to `sum`, both [n]. */
static void add_stiffness(const hf_saddle_dual *d, double sign, const double *v, double *sum)
{
    const hf_model *m = &d->linear->built->model;
    for (int e = 0; e < m->n_cable; e++) {
        const int *end = m->end_row + 2 * (ptrdiff_t)e;
        const double *h = d->block + 9 * (ptrdiff_t)e;
        double difference[3] = {0};
        for (int p = 0; p < 2; p++)
            for (int c = 0; c < 3 && end[p] < m->n_free; c++)
                difference[c] += (p ? -1 : 1) * v[3 * (ptrdiff_t)end[p] + c];
        for (int r = 0; r < 3; r++) {
            double force =
                sign * (h[3 * r] * difference[0] + h[3 * r + 1] * difference[1] + h[3 * r + 2] * difference[2]);
            if (end[0] < m->n_free) sum[3 * (ptrdiff_t)end[0] + r] += force;
            if (end[1] < m->n_free) sum[3 * (ptrdiff_t)end[1] + r] -= force;
        }
    }
    for (int i = 0; i < d->n; i++)
        sum[i] += sign * d->spring[i / 3] * v[i];
}

/* ---- refinement ---- */

/* Holds one of the right-hand sides that are refined together. */
typedef struct {
    double *band, *solution, *error; /* [2 n] right-hand side, its solution, its residual */
    double size, last, largest;      /* maximum entries: of the right-hand side, of the last two residuals */
} refinement;

/* Computes the right-hand side p of the multipliers from the residual in r->error, which it overwrites. */
static void ask_multipliers(const hf_saddle_dual *d, refinement *r, double *p)
{
    /* Displacements need less room than the residual, so they may overwrite it. */
    double *right = r->error, *moved = right;
    for (int i = 0; i < d->n; i++)
        p[i] = -right[6 * (i / 3) + i % 3];
    for (int i = 0; i < d->n; i++)
        moved[i] = right[6 * (i / 3) + 3 + i % 3] / weight_of(d, i);
    add_stiffness(d, 1, moved, p);
}

/* Adds the multipliers p and the displacements that follow from them to the solution. */
static void add_answer(const hf_saddle_dual *d, refinement *r, const double *p)
{
    double *moved = r->error, *pull = moved + d->n, *z = r->solution;
    memset(pull, 0, (size_t)d->n * sizeof *pull);
    add_stiffness(d, 1, p, pull);
    for (int i = 0; i < d->n; i++) {
        z[6 * (i / 3) + i % 3] += p[i];
        z[6 * (i / 3) + 3 + i % 3] += moved[i] - pull[i] / weight_of(d, i);
    }
}

/* Adds corrections to n solutions: the solutions of the matrix with R for their residuals. */
static void correct(const hf_saddle_dual *d, int n, refinement *const *open)
{
    for (int k = 0; k < n; k++)
        ask_multipliers(d, open[k], d->right + (ptrdiff_t)k * d->n);
    hf_band_back_solve(d->n, d->half_bandwidth, n, d->band, d->right, d->n);
    for (int k = 0; k < n; k++)
        add_answer(d, open[k], d->right + (ptrdiff_t)k * d->n);
}

static double largest_entry(const hf_saddle_dual *d, const double *v)
{
    double largest = 0;
    for (int i = 0; i < 2 * d->n; i++)
        largest = fmax(largest, fabs(v[i]));
    return largest;
}

/* Computes the residual. Returns whether a further step is useful. */
static bool goes_on(const hf_saddle_dual *d, refinement *r)
{
    memcpy(r->error, r->band, 2 * (size_t)d->n * sizeof(double));
    take_off_product(d, r->solution, r->error);
    r->last = r->largest;
    r->largest = largest_entry(d, r->error);
    return r->largest > ENOUGH * r->size && !(r->largest <= REFINED * r->size && r->largest > r->last / 2);
}

/* Solves at most HF_SADDLE_DUAL_PANEL right-hand sides in place. Returns whether all residuals are small. */
static bool refine_iteratively(const hf_saddle_dual *d, int n, double *band)
{
    refinement all[HF_SADDLE_DUAL_PANEL], *open[HF_SADDLE_DUAL_PANEL];
    size_t length = 2 * (size_t)d->n;
    bool is_found = true;
    int n_open = 0;
    for (int k = 0; k < n; k++) {
        size_t at = (size_t)k * length;
        all[k] = (refinement){.band = band + at, .solution = d->solution + at, .error = d->error + at};
        all[k].size = largest_entry(d, all[k].band);
        all[k].largest = all[k].size > 0 ? (double)INFINITY : 0;
        if (all[k].size > 0) open[n_open++] = &all[k];
    }
    memset(d->solution, 0, (size_t)n * length * sizeof(double));
    for (int step = 0; step <= REFINEMENTS_MAX && n_open > 0; step++) {
        int n_left = 0;
        for (int k = 0; k < n_open; k++)
            if (goes_on(d, open[k])) open[n_left++] = open[k];
        n_open = n_left;
        if (step < REFINEMENTS_MAX) correct(d, n_open, open);
    }
    memcpy(band, d->solution, (size_t)n * length * sizeof(double));
    for (int k = 0; k < n; k++)
        is_found = is_found && (all[k].size == 0 || all[k].largest / all[k].size < REFINED);
    return is_found;
}

bool hf_saddle_dual_solve(const hf_saddle_dual *d, int n, double *band)
{
    const int panel = HF_SADDLE_DUAL_PANEL;
    for (int first = 0; first < n; first += panel)
        if (!refine_iteratively(d, n - first < panel ? n - first : panel, band + 2 * (ptrdiff_t)first * d->n))
            return false;
    return true;
}

/* ---- factor ---- */

/* Scales the stiffness and the variance of cable e. */
static void take_cable(hf_saddle_dual *d, int e, double sigma_m, double size_m, double force_m_per_N)
{
    const hf_built_linear *l = d->linear;
    double push = l->cut_N_per_m[e] * sigma_m * force_m_per_N;
    d->push[e] = push * push;
    for (int c = 0; c < 9; c++)
        d->block[9 * (ptrdiff_t)e + c] = size_m * force_m_per_N * l->block_N_per_m[9 * (ptrdiff_t)e + c];
}

bool hf_saddle_dual_factor(hf_saddle_dual *d, const double *sigma_m, const double *weight_per_m2, double part,
                           double size_m, double force_m_per_N)
{
    const hf_model *m = &d->linear->built->model;
    for (int e = 0; e < m->n_cable; e++)
        take_cable(d, e, sigma_m[e], size_m, force_m_per_N);
    for (int row = 0; row < m->n_free; row++)
        d->spring[row] = d->linear->work.loose[row] ? hf_loose_spring_N_per_m(m) * size_m * force_m_per_N : 0;
    for (int i = 0; i < d->n; i++)
        d->weight[i] = part * weight_per_m2[i] * size_m * size_m;
    memset(d->band, 0, (size_t)d->n * ((size_t)d->half_bandwidth + 1) * sizeof *d->band);
    for (int e = 0; e < m->n_cable; e++)
        add_push(d, e);
    for (int row = 0; row < m->n_free; row++)
        add_node(d, row);
    if (hf_band_factor(d->n, d->half_bandwidth, d->band) != 0) return false;
    for (int i = 0; i < 2 * d->n; i++)
        d->solution[i] = i % 7 < 3 ? 1 : -1; /* the known solution of the probe */
    memset(d->probe, 0, 2 * (size_t)d->n * sizeof *d->probe);
    take_off_product(d, d->solution, d->probe);
    return refine_iteratively(d, 1, d->probe);
}
