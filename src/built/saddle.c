/* Assembles and solves the saddle-point system (M41) of an estimate:
 *
 *     cables, nodes, shared numbers ---> band, border columns, corner   (factor_parts)
 *     band ---> saddle_dual where it applies, otherwise LU with pivoting
 *     corner - columns' band^-1 columns, with the truss ---> dense LU   (factor_border)
 *     right-hand side ---> band ---> border ---> band again             (hf_saddle_solve)
 *
 * Contents: making, assembling, factor, solution. */
#include "built/saddle.h"

#include "base/arena.h"
#include "linalg/band.h"
#include "linalg/dense.h"
#include "solve/loose.h"

#include <math.h>
#include <string.h>

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

/* Returns the maximum error of a length by one standard deviation of an own error or of a shared number. */
static double largest_error_m(const hf_model *m, const hf_saddle_prior *prior)
{
    double largest = 0;
    for (int e = 0; e < m->n_cable; e++)
        largest = fmax(largest, prior->sigma_m[e]);
    for (size_t i = 0; i < (size_t)prior->n_shared * (size_t)m->n_cable; i++)
        largest = fmax(largest, fabs(prior->shared_m[i]));
    return largest;
}

hf_status hf_saddle_create(const hf_built_linear *l, const hf_saddle_prior *prior, hf_saddle *s)
{
    const hf_model *m = &l->built->model;
    *s = (hf_saddle){.linear = l, .prior = *prior, .n_band = 6 * m->n_free, .n_attached = 3 * m->n_attachment};
    s->half_bandwidth = 6 * m->half_bandwidth + 5;
    if (prior->support_sigma_m > 0) s->n_off = 3 * (m->n_node - m->n_free - m->n_attachment);
    s->n_border = 2 * s->n_attached + s->n_off + prior->n_shared;
    s->size_m = largest_error_m(m, prior);
    size_t n = (size_t)s->n_band, border = (size_t)s->n_border, attached = (size_t)s->n_attached;
    HF_TRY(HF_ARENA_ARRAYS(&s->block, HF_ARRAY(s->general, n * (size_t)room_of_band(s)), HF_ARRAY(s->pivot, n),
                           HF_ARRAY(s->column, border * n), HF_ARRAY(s->solved, border * n),
                           HF_ARRAY(s->corner, border * border), HF_ARRAY(s->dense, border * border),
                           HF_ARRAY(s->flex, attached * attached),
                           HF_ARRAY(s->work, (1 + HF_SADDLE_DUAL_PANEL) * border), HF_ARRAY(s->dense_pivot, border)));
    return may_be_dual(s) ? hf_saddle_dual_create(l, &s->dual) : HF_OK;
}

void hf_saddle_free(hf_saddle *s)
{
    hf_saddle_dual_free(&s->dual);
    hf_arena_free_block(s->block);
    *s = (hf_saddle){0};
}

/* ---- assembling ---- */

enum { MULTIPLIER, MOVE }; /* kinds of unknowns */

/* Returns the first of three unknowns of a row, or -1 when it has none. Unknowns of the border begin at n_band. */
static int unknown_of(const hf_saddle *s, int row, int kind)
{
    const hf_model *m = &s->linear->built->model;
    if (row < m->n_free) return 6 * row + 3 * kind;
    int i = 3 * (row - m->n_free);
    if (i < s->n_attached) return s->n_band + i + (kind == MULTIPLIER ? s->n_attached : 0);
    return kind == MOVE && s->n_off ? s->n_band + s->n_attached + i : -1;
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
    return kind == MOVE ? s->size_m : s->force_m_per_N;
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
            add_rows(s, end[p], MULTIPLIER, end[q], MOVE, sign, block);
            add_rows(s, end[p], MOVE, end[q], MULTIPLIER, sign, block);
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
        if (row < m->n_free && s->linear->work.loose[row]) spring[c][c] = hf_loose_spring_N_per_m(m);
    }
    add_rows(s, row, MOVE, row, MOVE, 1, weight);
    if (spring[0][0] == 0) return;
    add_rows(s, row, MOVE, row, MULTIPLIER, 1, spring);
    add_rows(s, row, MULTIPLIER, row, MOVE, 1, spring);
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

/* Solves the band in place for n right-hand sides b [n][n_band]. Returns HF_OK; or HF_SINGULAR when rounding prevents a
 * solution. */
static hf_status solve_band(const hf_saddle *s, int n, double *b)
{
    if (s->is_dual) return hf_saddle_dual_solve(&s->dual, n, b) ? HF_OK : HF_SINGULAR;
    hf_band_back_solve_general(s->n_band, s->half_bandwidth, n, s->general, s->pivot, b, s->n_band);
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

/* Chooses units in which the entries of the matrix are about 1. */
static void choose_units(hf_saddle *s)
{
    const hf_built_linear *l = s->linear;
    const hf_model *m = &l->built->model;
    double stiffest = 0;
    for (int e = 0; e < m->n_cable; e++)
        stiffest = fmax(stiffest, l->stiffness_N_per_m[e]);
    s->force_m_per_N = 1 / (stiffest * s->size_m);
    for (int i = 0; i < s->n_attached * s->n_attached; i++)
        s->flex[i] = stiffest * m->flexibility_m_per_N[i];
}

static void clear_border(hf_saddle *s)
{
    memset(s->column, 0, (size_t)s->n_border * (size_t)s->n_band * sizeof *s->column);
    memset(s->corner, 0, (size_t)s->n_border * (size_t)s->n_border * sizeof *s->corner);
    for (int k = 0; k < s->prior.n_shared; k++)
        add_number(s, k);
}

/* Factors by saddle_dual where it applies and succeeds, otherwise by LU. */
static hf_status factor_parts(hf_saddle *s)
{
    const hf_model *m = &s->linear->built->model;
    choose_units(s);
    clear_border(s);
    s->is_dual = may_be_dual(s) && hf_saddle_dual_factor(&s->dual, s->prior.sigma_m, s->prior.weight_per_m2, s->part,
                                                         s->size_m, s->force_m_per_N);
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
        int at = unknown_of(s, row, MOVE);
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
    for (size_t i = 0; i < n; i++) {
        border[n + i] = 0;
        for (size_t k = 0; k < n; k++)
            border[n + i] += s->flex[i * n + k] * force[k];
    }
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
        read_unknown(s, row, MOVE, band, border, a->move_m + 3 * (ptrdiff_t)row);
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
        for (int e = 0; e < m->n_cable; e++)
            a->cut_m[e] += a->shared[k] * s->prior.shared_m[(size_t)k * (size_t)m->n_cable + (size_t)e];
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
        for (size_t i = 0; i < n_band; i++)
            band[i] -= s->solved[j * n_band + i] * border[j];
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
