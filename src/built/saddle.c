/* Assembles and solves the saddle-point system (M41) of an estimate:
 *
 *     cables, nodes, shared numbers ---> band, border columns, corner   (factor_parts)
 *     band ---> Cholesky where it applies (factor_dual), otherwise LU with pivoting
 *     corner - columns' band^-1 columns, with the truss ---> dense LU   (factor_border)
 *     right-hand side ---> band ---> border ---> band again             (hf_saddle_solve)
 *
 * Cholesky with iterative refinement, for a band without a border or with shared numbers alone:
 *
 *     factor   P + H (W + R)^-1 H ---> Cholesky ---> solve a probe of known solution; accepted to REFINED
 *     solve    residual ---> multipliers p (Cholesky) ---> displacements x ---> add both ---> residual with R = 0
 *                ^                                                                               |
 *                +---------------------- not small enough, still shrinking ----------------------+
 *
 * Contents: making, the band by Cholesky (matrix, products, refinement, factor), assembling, factor, solution. */
#include "built/saddle.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "linalg/band.h"
#include "linalg/dense.h"
#include "linalg/dot.h"
#include "solve/joint.h"

#include <math.h>
#include <string.h>

#define WEAK 2.5e-7        /* weight R of displacements of 2000 times the maximum error of a length */
#define REFINEMENTS_MAX 20 /* refinement steps; a probe that takes more shows that LU is needed */
#define REFINED 1e-12      /* required residual of a solution, relative to the right-hand side */
#define ENOUGH 1e-13       /* relative residual at which refinement stops */

/* ---- making ---- */

static int room_of_band(const hf_saddle *s)
{
    return 3 * s->half_bandwidth + 1;
}

/* Returns whether the border has only shared numbers. */
static bool may_be_dual(const hf_saddle *s)
{
    return s->n_border == s->prior.n_shared;
}

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

static hf_status create_dual(const hf_built_linear *l, hf_saddle_dual *d)
{
    const hf_model *m = &l->built->model;
    size_t n = 3 * (size_t)m->n_free, n_cable = (size_t)m->n_cable, panel = HF_SADDLE_PANEL;
    *d = (hf_saddle_dual){.linear = l, .n = (int)n, .half_bandwidth = 6 * m->half_bandwidth + 2};
    if (d->half_bandwidth > d->n - 1) d->half_bandwidth = d->n - 1;
    HF_TRY(HF_ARENA_ARRAYS(&d->memory, HF_ARRAY(d->start, m->n_node + 1), HF_ARRAY(d->cable, 2 * n_cable),
                           HF_ARRAY(d->block, 9 * n_cable), HF_ARRAY(d->push, n_cable), HF_ARRAY(d->spring, m->n_free),
                           HF_ARRAY(d->weight, n), HF_ARRAY(d->band, n * ((size_t)d->half_bandwidth + 1)),
                           HF_ARRAY(d->right, panel * n), HF_ARRAY(d->solution, panel * 2 * n),
                           HF_ARRAY(d->error, panel * 2 * n), HF_ARRAY(d->probe, 2 * n)));
    list_cables(d);
    return HF_OK;
}

hf_status hf_saddle_create(const hf_built_linear *l, const hf_saddle_prior *prior, hf_saddle *s)
{
    const hf_model *m = &l->built->model;
    *s = (hf_saddle){.linear = l, .prior = *prior, .n_band = 6 * m->n_free, .n_attached = 3 * m->n_attachment};
    s->half_bandwidth = 6 * m->half_bandwidth + 5;
    if (prior->support_sigma_m > 0) s->n_off = 3 * (m->n_node - m->n_free - m->n_attachment);
    s->n_border = 2 * s->n_attached + s->n_off + prior->n_shared;
    size_t n_cable = (size_t)m->n_cable; /* size_m: maximum error by one standard deviation of one number */
    s->size_m = fmax(hf_max_magnitude(n_cable, prior->sigma_m),
                     hf_max_magnitude((size_t)prior->n_shared * n_cable, prior->shared_m));
    size_t n = (size_t)s->n_band, border = (size_t)s->n_border, attached = (size_t)s->n_attached;
    HF_TRY(HF_ARENA_ARRAYS(&s->block, HF_ARRAY(s->general, n * (size_t)room_of_band(s)), HF_ARRAY(s->pivot, n),
                           HF_ARRAY(s->column, border * n), HF_ARRAY(s->solved, border * n),
                           HF_ARRAY(s->corner, border * border), HF_ARRAY(s->dense, border * border),
                           HF_ARRAY(s->flex, attached * attached), HF_ARRAY(s->work, (1 + HF_SADDLE_PANEL) * border),
                           HF_ARRAY(s->dense_pivot, border)));
    return may_be_dual(s) ? create_dual(l, &s->dual) : HF_OK;
}

void hf_saddle_free(hf_saddle *s)
{
    hf_arena_free_block(s->dual.memory);
    hf_arena_free_block(s->block);
    *s = (hf_saddle){0};
}

/* ---- the band by Cholesky: the matrix ---- */

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
    int e = d->cable[d->start[row] + k - 1];
    int other = m->end_row[2 * e] == row ? m->end_row[2 * e + 1] : m->end_row[2 * e];
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

/* ---- the band by Cholesky: products ---- */

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

/* Adds H v to `sum`, both [n]. */
static void add_stiffness(const hf_saddle_dual *d, const double *v, double *sum)
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
            double force = h[3 * r] * difference[0] + h[3 * r + 1] * difference[1] + h[3 * r + 2] * difference[2];
            if (end[0] < m->n_free) sum[3 * (ptrdiff_t)end[0] + r] += force;
            if (end[1] < m->n_free) sum[3 * (ptrdiff_t)end[1] + r] -= force;
        }
    }
    for (int i = 0; i < d->n; i++)
        sum[i] += d->spring[i / 3] * v[i];
}

/* ---- the band by Cholesky: refinement ---- */

/* Holds one of the right-hand sides that are refined together. */
typedef struct {
    double *band, *solution, *error; /* [2 n] right-hand side, its solution, its residual */
    double size, last, largest;      /* maximum entries: of the right-hand side, of the last two residuals */
} refinement;

/* Computes the right-hand side p of the multipliers from the residual in r->error, which it overwrites. */
static void ask_multipliers(const hf_saddle_dual *d, refinement *r, double *p)
{
    /* Displacements need less room than the residual, so they may overwrite it. */
    double *right = r->error, *displaced = right;
    for (int i = 0; i < d->n; i++)
        p[i] = -right[6 * (i / 3) + i % 3];
    for (int i = 0; i < d->n; i++)
        displaced[i] = right[6 * (i / 3) + 3 + i % 3] / weight_of(d, i);
    add_stiffness(d, displaced, p);
}

/* Adds the multipliers p and the displacements that follow from them to the solution. */
static void add_answer(const hf_saddle_dual *d, refinement *r, const double *p)
{
    double *displaced = r->error, *pull = displaced + d->n, *z = r->solution;
    memset(pull, 0, (size_t)d->n * sizeof *pull);
    add_stiffness(d, p, pull);
    for (int i = 0; i < d->n; i++) {
        z[6 * (i / 3) + i % 3] += p[i];
        z[6 * (i / 3) + 3 + i % 3] += displaced[i] - pull[i] / weight_of(d, i);
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

/* Computes the residual. Returns whether a further step is useful. */
static bool goes_on(const hf_saddle_dual *d, refinement *r)
{
    memcpy(r->error, r->band, 2 * (size_t)d->n * sizeof(double));
    take_off_product(d, r->solution, r->error);
    r->last = r->largest;
    r->largest = hf_max_magnitude(2 * (size_t)d->n, r->error);
    return r->largest > ENOUGH * r->size && !(r->largest <= REFINED * r->size && r->largest > r->last / 2);
}

/* Solves at most HF_SADDLE_PANEL right-hand sides in place. Returns whether all residuals are small. */
static bool refine_iteratively(const hf_saddle_dual *d, int n, double *band)
{
    refinement all[HF_SADDLE_PANEL], *open[HF_SADDLE_PANEL];
    size_t length = 2 * (size_t)d->n;
    bool is_found = true;
    int n_open = 0;
    for (int k = 0; k < n; k++) {
        size_t at = (size_t)k * length;
        all[k] = (refinement){.band = band + at, .solution = d->solution + at, .error = d->error + at};
        all[k].size = hf_max_magnitude(length, all[k].band);
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

/* Factors the matrix. Returns false when it has no factor, or when refinement does not solve a probe; another method is
 * then needed. */
static bool factor_dual(hf_saddle *s)
{
    hf_saddle_dual *d = &s->dual;
    const hf_built_linear *l = s->linear;
    const hf_model *m = &l->built->model;
    for (int e = 0; e < m->n_cable; e++) {
        double push = l->cut_N_per_m[e] * s->prior.sigma_m[e] * s->force_m_per_N;
        d->push[e] = push * push;
    }
    for (int i = 0; i < 9 * m->n_cable; i++)
        d->block[i] = s->size_m * s->force_m_per_N * l->block_N_per_m[i];
    for (int row = 0; row < m->n_free; row++)
        d->spring[row] = l->work.loose[row] ? hf_joint_loose_spring_N_per_m(m) * s->size_m * s->force_m_per_N : 0;
    for (int i = 0; i < d->n; i++)
        d->weight[i] = s->part * s->prior.weight_per_m2[i] * s->size_m * s->size_m;
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

/* ---- assembling ---- */

enum { MULTIPLIER, DISPLACEMENT }; /* kinds of unknowns */

/* Returns the first of three unknowns of a row, or -1 when it has none. Unknowns of the border begin at n_band. */
static int unknown_of(const hf_saddle *s, int row, int kind)
{
    const hf_model *m = &s->linear->built->model;
    if (row < m->n_free) return 6 * row + 3 * kind;
    int i = 3 * (row - m->n_free);
    if (i < s->n_attached) return s->n_band + i + (kind == MULTIPLIER ? s->n_attached : 0);
    return kind == DISPLACEMENT && s->n_off ? s->n_band + s->n_attached + i : -1;
}

/* Adds a value to the band, a column of the border or the corner. Columns of the border stand for its rows, too. */
static void add_entry(hf_saddle *s, int i, int j, double value)
{
    int k = s->half_bandwidth;
    if (i < s->n_band && j < s->n_band)
        s->general[(size_t)(2 * k + i - j) + (size_t)j * (size_t)room_of_band(s)] += value;
    else if (i < s->n_band)
        s->column[(size_t)(j - s->n_band) * (size_t)s->n_band + (size_t)i] += value;
    else if (j >= s->n_band)
        s->corner[(size_t)(i - s->n_band) * (size_t)s->n_border + (size_t)(j - s->n_band)] += value;
}

static double unit_of(const hf_saddle *s, int kind)
{
    return kind == DISPLACEMENT ? s->size_m : s->force_m_per_N;
}

/* Adds a block [3][3], times sign and units, between the unknowns of two rows. */
static void add_rows(hf_saddle *s, int row_i, int kind_i, int row_j, int kind_j, double sign, double block[3][3])
{
    int i = unknown_of(s, row_i, kind_i), j = unknown_of(s, row_j, kind_j);
    double unit = sign * unit_of(s, kind_i) * unit_of(s, kind_j);
    for (int r = 0; r < 3 && i >= 0 && j >= 0; r++)
        for (int c = 0; c < 3; c++)
            add_entry(s, i + r, j + c, unit * block[r][c]);
}

/* Adds the blocks of cable e: its stiffness, and the forces of its own error. */
static void add_cable(hf_saddle *s, int e)
{
    const hf_built_linear *l = s->linear;
    const int *end = l->built->model.end_row + 2 * (ptrdiff_t)e;
    const double *u = l->unit + 3 * (ptrdiff_t)e;
    double push = l->cut_N_per_m[e] * s->prior.sigma_m[e], block[3][3], spread[3][3];
    memcpy(block, l->block_N_per_m + 9 * (ptrdiff_t)e, sizeof block);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            spread[r][c] = push * push * u[r] * u[c];
    for (int p = 0; p < 2; p++)
        for (int q = 0; q < 2; q++) {
            double sign = p == q ? 1 : -1;
            add_rows(s, end[p], MULTIPLIER, end[q], DISPLACEMENT, sign, block);
            add_rows(s, end[p], DISPLACEMENT, end[q], MULTIPLIER, sign, block);
            add_rows(s, end[p], MULTIPLIER, end[q], MULTIPLIER, -sign, spread);
        }
}

/* Adds the weight of a row, the precision of a support, and the spring of a loose node. */
static void add_row(hf_saddle *s, int row)
{
    const hf_model *m = &s->linear->built->model;
    double weight[3][3] = {{0}}, spring[3][3] = {{0}}, rest = s->prior.support_sigma_m;
    for (int c = 0; c < 3; c++) {
        weight[c][c] = s->part * s->prior.weight_per_m2[3 * row + c];
        if (row >= m->n_free + m->n_attachment && s->n_off) weight[c][c] += 1 / (rest * rest);
        if (row < m->n_free && s->linear->work.loose[row]) spring[c][c] = hf_joint_loose_spring_N_per_m(m);
    }
    add_rows(s, row, DISPLACEMENT, row, DISPLACEMENT, 1, weight);
    if (spring[0][0] == 0) return;
    add_rows(s, row, DISPLACEMENT, row, MULTIPLIER, 1, spring);
    add_rows(s, row, MULTIPLIER, row, DISPLACEMENT, 1, spring);
}

/* Adds the border of shared number k: the forces of its errors, in the rows of the multipliers. They express z =
 * U'B'p. */
static void add_number(hf_saddle *s, int k)
{
    const hf_built_linear *l = s->linear;
    const hf_model *m = &l->built->model;
    const double *shared_m = s->prior.shared_m + (size_t)k * (size_t)m->n_cable;
    int at = s->n_band + s->n_border - s->prior.n_shared + k;
    for (int i = 0; i < 2 * m->n_cable; i++) {
        int e = i / 2, to = unknown_of(s, m->end_row[i], MULTIPLIER);
        double push = (i % 2 ? 1 : -1) * l->cut_N_per_m[e] * shared_m[e] * s->force_m_per_N;
        for (int c = 0; c < 3 && to >= 0 && push != 0; c++) {
            add_entry(s, to + c, at, push * l->unit[3 * (ptrdiff_t)e + c]);
            if (to >= s->n_band) add_entry(s, at, to + c, push * l->unit[3 * (ptrdiff_t)e + c]);
        }
    }
    add_entry(s, at, at, 1);
}

/* ---- factor ---- */

/* Fills the dense matrix of the border. Its unknowns are displacements of attachments, forces f on them, displacements
 * of supports, and shared numbers. The multipliers of attachments are F f with the flexibility F.
 *
 * Let T be the corner minus its part through the band, and D the variance of resting positions of attachments. Index 1
 * are displacements of attachments, 2 their multipliers, 3 supports and numbers. The rows are (T11, T12 F + 1, T13), (F
 * T21 + 1, F T22 F - D, F T23), (T31, T32 F, T33). The matrix is symmetric, so rows may be read as columns. */
static void fill_border(hf_saddle *s)
{
    const double *flex = s->flex;
    size_t n = (size_t)s->n_border, a = (size_t)s->n_attached;
    double rest = s->prior.support_sigma_m / s->size_m, *to = s->dense, *sum = s->work;
    memcpy(to, s->corner, n * n * sizeof *to);
    for (int side = 0; side < 2; side++) /* first the rows of the multipliers, then the columns */
        for (size_t j = 0; j < n; j++) {
            size_t along = side ? 1 : n, at = side ? n * j : j;
            for (size_t i = 0; i < a; i++) {
                sum[i] = 0;
                for (size_t k = 0; k < a; k++)
                    sum[i] += flex[i * a + k] * to[(a + k) * along + at];
            }
            for (size_t i = 0; i < a; i++)
                to[(a + i) * along + at] = sum[i];
        }
    for (size_t i = 0; i < a; i++) {
        to[i * n + a + i] += 1;
        to[(a + i) * n + i] += 1;
        to[(a + i) * n + a + i] -= rest * rest;
    }
}

/* Solves the band in place for n right-hand sides b [n][n_band]. No solution depends on the others. Returns HF_OK; or
 * HF_SINGULAR when rounding prevents a solution. */
static hf_status solve_band(const hf_saddle *s, int n, double *b)
{
    if (!s->is_dual) {
        hf_band_back_solve_general(s->n_band, s->half_bandwidth, n, s->general, s->pivot, b, s->n_band);
        return HF_OK;
    }
    for (int first = 0; first < n; first += HF_SADDLE_PANEL) {
        int n_now = n - first < HF_SADDLE_PANEL ? n - first : HF_SADDLE_PANEL;
        if (!refine_iteratively(&s->dual, n_now, b + (ptrdiff_t)first * s->n_band)) return HF_SINGULAR;
    }
    return HF_OK;
}

/* Solves the band for the columns of the border, subtracts the products from the corner, and factors it. */
static hf_status factor_border(hf_saddle *s)
{
    size_t n = (size_t)s->n_border, n_band = (size_t)s->n_band;
    if (n == 0) return HF_OK;
    memcpy(s->solved, s->column, n * n_band * sizeof *s->solved);
    HF_TRY(solve_band(s, s->n_border, s->solved));
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n_band; k++) {
            double entry = s->column[i * n_band + k]; /* most entries are 0 */
            for (size_t j = 0; j < n && entry != 0; j++)
                s->corner[i * n + j] -= entry * s->solved[j * n_band + k];
        }
    fill_border(s);
    return hf_dense_factor(s->n_border, s->dense, s->dense_pivot) == 0 ? HF_OK : HF_SINGULAR;
}

static void clear_border(hf_saddle *s)
{
    memset(s->column, 0, (size_t)s->n_border * (size_t)s->n_band * sizeof *s->column);
    memset(s->corner, 0, (size_t)s->n_border * (size_t)s->n_border * sizeof *s->corner);
    for (int k = 0; k < s->prior.n_shared; k++)
        add_number(s, k);
}

/* Factors by Cholesky where it applies and succeeds, otherwise by LU. */
static hf_status factor_parts(hf_saddle *s)
{
    const hf_model *m = &s->linear->built->model;
    /* units in which the entries of the matrix are about 1 */
    double stiffest = hf_max_magnitude((size_t)m->n_cable, s->linear->stiffness_N_per_m);
    s->force_m_per_N = 1 / (stiffest * s->size_m);
    for (int i = 0; i < s->n_attached * s->n_attached; i++)
        s->flex[i] = stiffest * m->flexibility_m_per_N[i];
    clear_border(s);
    s->is_dual = may_be_dual(s) && factor_dual(s);
    if (s->is_dual && factor_border(s) == HF_OK) return HF_OK;
    s->is_dual = false;
    clear_border(s);
    memset(s->general, 0, (size_t)s->n_band * (size_t)room_of_band(s) * sizeof *s->general);
    for (int e = 0; e < m->n_cable; e++)
        add_cable(s, e);
    for (int row = 0; row < m->n_node; row++)
        add_row(s, row);
    if (hf_band_factor_general(s->n_band, s->half_bandwidth, s->general, s->pivot) != 0) return HF_SINGULAR;
    return factor_border(s);
}

hf_status hf_saddle_factor(hf_saddle *s, double damping)
{
    double part = 1 / (1 + damping);
    if (s->n_factor == s->linear->n_factor && s->part == part) return HF_OK;
    s->part = part;
    s->n_factor = 0;
    HF_TRY(factor_parts(s));
    s->n_factor = s->linear->n_factor;
    return HF_OK;
}

/* ---- solution ---- */

/* Writes a right-hand side: band [n_band] and border [n_border]. */
static void ask(const hf_saddle *s, const hf_saddle_answer *a, double *band, double *border)
{
    const hf_built_linear *l = s->linear;
    const hf_model *m = &l->built->model;
    double precision = s->n_off ? 1 / (s->prior.support_sigma_m * s->prior.support_sigma_m) : 0;
    memset(band, 0, (size_t)s->n_band * sizeof *band);
    memset(border, 0, (size_t)s->n_border * sizeof *border);
    for (int row = 0; row < m->n_node; row++) {
        int at = unknown_of(s, row, DISPLACEMENT);
        double *to = at < s->n_band ? band + at : border + (at - s->n_band);
        for (int c = 0; c < 3 && at >= 0; c++) {
            int i = 3 * row + c;
            if (s->prior.weight_per_m2[i] > 0) to[c] = s->part * s->prior.weight_per_m2[i] * a->gap_m[i] * s->size_m;
            if (row >= m->n_free + m->n_attachment) to[c] -= precision * a->rest_m[i] * s->size_m;
        }
    }
    for (int e = 0; e < m->n_cable; e++)
        for (int p = 0; p < 2; p++) {
            int at = unknown_of(s, m->end_row[2 * e + p], MULTIPLIER);
            double *to = at < s->n_band ? band + at : border + (at - s->n_band);
            double push = (p ? 1 : -1) * l->cut_N_per_m[e] * a->cut_m[e] * s->force_m_per_N;
            for (int c = 0; c < 3 && at >= 0; c++)
                to[c] += push * l->unit[3 * (ptrdiff_t)e + c];
        }
}

/* Solves the border. On entry it is the right-hand side minus the part through the band. On return it holds the
 * displacements of attachments, their multipliers, displacements of supports, and numbers; `force` holds the forces on
 * attachments. */
static void solve_border(const hf_saddle *s, const hf_saddle_answer *a, double *border, double *force)
{
    const hf_model *m = &s->linear->built->model;
    size_t n = (size_t)s->n_attached;
    for (size_t i = 0; i < n; i++) {
        force[i] = -a->rest_m[3 * (size_t)m->n_free + i] / s->size_m;
        for (size_t k = 0; k < n; k++)
            force[i] += s->flex[i * n + k] * border[n + k];
    }
    memcpy(border + n, force, n * sizeof *border);
    hf_dense_solve(s->n_border, s->dense, s->dense_pivot, 1, border);
    memcpy(force, border + n, n * sizeof *force);
    hf_dots(n, n, s->flex, n, force, border + n);
}

/* Reads the three unknowns of a row in SI units, or zeros when it has none. */
static void read_unknown(const hf_saddle *s, int row, int kind, const double *band, const double *border, double to[3])
{
    int at = unknown_of(s, row, kind);
    for (int c = 0; c < 3; c++)
        to[c] = at < 0 ? 0 : unit_of(s, kind) * (at < s->n_band ? band[at + c] : border[at - s->n_band + c]);
}

/* Writes displacements, errors and shared numbers from the unknowns. */
static void read_answer(const hf_saddle *s, hf_saddle_answer *a, const double *band, const double *border,
                        const double *force)
{
    const hf_built_linear *l = s->linear;
    const hf_model *m = &l->built->model;
    double rest = s->prior.support_sigma_m;
    for (int row = 0; row < m->n_node; row++)
        read_unknown(s, row, DISPLACEMENT, band, border, a->move_m + 3 * (ptrdiff_t)row);
    for (int i = 3 * m->n_free; i < 3 * m->n_node; i++) {
        int k = i - 3 * m->n_free;
        if (k < s->n_attached)
            a->rest_m[i] = rest * rest * force[k] / s->size_m;
        else
            a->rest_m[i] += a->move_m[i];
    }
    for (int e = 0; e < m->n_cable; e++) {
        const double *u = l->unit + 3 * (ptrdiff_t)e;
        double p[3], q[3], sigma = s->prior.sigma_m[e];
        read_unknown(s, m->end_row[2 * e], MULTIPLIER, band, border, p);
        read_unknown(s, m->end_row[2 * e + 1], MULTIPLIER, band, border, q);
        double along = u[0] * (p[0] - q[0]) + u[1] * (p[1] - q[1]) + u[2] * (p[2] - q[2]);
        a->cut_m[e] = sigma * sigma * l->cut_N_per_m[e] * along;
    }
    for (int k = 0; k < s->prior.n_shared; k++) {
        a->shared[k] = border[s->n_border - s->prior.n_shared + k];
        hf_add((size_t)m->n_cable, a->shared[k], s->prior.shared_m + (size_t)k * (size_t)m->n_cable, a->cut_m);
    }
}

/* Completes a solution from the band's own part: first the border, then the part of the band that the border
 * changes. */
static void finish_answer(const hf_saddle *s, hf_saddle_answer *a, double *band, double *border)
{
    size_t n_band = (size_t)s->n_band;
    double *force = s->work;
    for (size_t j = 0; j < (size_t)s->n_border; j++)
        for (size_t i = 0; i < n_band; i++)
            border[j] -= s->column[j * n_band + i] * band[i];
    if (s->n_border) solve_border(s, a, border, force);
    for (size_t j = 0; j < (size_t)s->n_border; j++)
        hf_subtract(n_band, border[j], s->solved + j * n_band, band);
    read_answer(s, a, band, border, force);
}

hf_status hf_saddle_solve(const hf_saddle *s, int n, hf_saddle_answer *a, double *band)
{
    for (int k = 0; k < n; k++)
        ask(s, &a[k], band + (ptrdiff_t)k * s->n_band, s->work + (ptrdiff_t)(1 + k) * s->n_border);
    HF_TRY(solve_band(s, n, band));
    for (int k = 0; k < n; k++)
        finish_answer(s, &a[k], band + (ptrdiff_t)k * s->n_band, s->work + (ptrdiff_t)(1 + k) * s->n_border);
    return HF_OK;
}
