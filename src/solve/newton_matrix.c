/* Assembles and factors the Newton matrix of a net (METHOD section 5).
 *
 *     block K_e = (T/l) (I - uu') + k uu' of each cable   (M6)
 *         | assemble: lower band of the free rows, or of the rows that move alone
 *         | add the Levenberg shift and the springs to the diagonal
 *         | band Cholesky; if it fails, repeat with a larger shift
 *         v
 *     factor in newton_band, estimate of the condition
 *
 * hf_newton_matrix_factor_below subtracts a shift instead. Its factor certifies a lower bound of the minimum
 * eigenvalue. */
#include "solve/newton_matrix.h"

#include "linalg/band.h"

#include <string.h>

/* Levenberg shift of every matrix, relative to the maximum diagonal entry. From 0 to 1e-12 the tests of solve and
 * stress pass; with 1e-10 two fail (last_digits_are_cheap, flat_edges_are_solved). */
#define DIAGONAL_GUARD 1e-14
/* Shift after the first failed factorisation; each further failure multiplies it by 100. No net of these tests has such
 * a matrix, so values from 1e-13 to 1e-4 make no difference. The unit test makes one with a cable that pushes. */
#define SHIFT_FIRST 1e-10
/* BELOW is the shift that hf_newton_matrix_factor_below subtracts, relative to the maximum sum of T/l at a node. The
 * estimated minimum eigenvalue must exceed the shift by the factor BELOW_CLEARLY. A larger shift allows bounds for
 * shapes farther from the equilibrium. From 1e-9 to 1e-7 the precise iteration takes the same steps with this matrix as
 * with the unshifted one. */
#define BELOW 1e-7
#define BELOW_CLEARLY 100.0

void hf_newton_matrix_block(const hf_model *m, const hf_workspace *w, int e, double block[3][3])
{
    hf_law_cable cable = hf_workspace_cable(m, w, e);
    double u[3], length = hf_newton_matrix_direction(m, w->position_m, e, u);
    double T = hf_newton_matrix_tension_N(cable, length, w->tension_N[e]);
    hf_newton_matrix_spring(hf_newton_matrix_stiffness(cable, length, T), T / length, u, block);
}

/* ---- rows that move ---- */

static hf_newton_rows all_rows(const hf_model *m)
{
    return (hf_newton_rows){m->n_free, m->half_bandwidth, NULL};
}

static int place_of(const hf_model *m, const hf_newton_rows *rows, int row)
{
    if (row >= m->n_free) return -1;
    return rows->place ? rows->place[row] : row;
}

hf_newton_rows hf_newton_matrix_find_rows(const hf_model *m, const double *spring_N_per_m, int *place)
{
    hf_newton_rows rows = {0, 0, place};
    for (int i = 0; i < m->n_free; i++)
        place[i] = isinf(spring_N_per_m[i]) ? -1 : rows.n++;
    for (int e = 0; e < m->n_cable; e++) {
        int a = place_of(m, &rows, m->end_row[2 * e]), b = place_of(m, &rows, m->end_row[2 * e + 1]);
        int width = a < b ? b - a : a - b;
        if (a >= 0 && b >= 0 && width > rows.half_bandwidth) rows.half_bandwidth = width;
    }
    return rows;
}

/* ---- assembling ---- */

static int column_of(const hf_newton_rows *rows)
{
    return 3 * rows->half_bandwidth + 3;
}

static double assemble_rows(const hf_model *m, hf_workspace *w, hf_newton_block *block_of, const hf_newton_rows *rows)
{
    int column = column_of(rows);
    double *band = w->newton_band, block[3][3], largest = 0;
    memset(band, 0, 3 * (size_t)rows->n * (size_t)column * sizeof *band);
    for (int e = 0; e < m->n_cable; e++) {
        int a = place_of(m, rows, m->end_row[2 * e]), b = place_of(m, rows, m->end_row[2 * e + 1]);
        if (a < 0 && b < 0) continue;
        block_of(m, w, e, block);
        hf_newton_matrix_add_block(band, column, a, b, block);
    }
    for (int i = 0; i < 3 * rows->n; i++)
        largest = fmax(largest, band[(size_t)i * (size_t)column]);
    return largest;
}

double hf_newton_matrix_assemble_blocks(const hf_model *m, hf_workspace *w, hf_newton_block *block_of)
{
    hf_newton_rows rows = all_rows(m);
    return assemble_rows(m, w, block_of, &rows);
}

/* Adds `shift` and the springs [n_free] (may be NULL) to the diagonal, N/m. */
static void stiffen(const hf_model *m, hf_workspace *w, const hf_newton_rows *rows, double shift,
                    const double *spring_N_per_m)
{
    size_t column = (size_t)column_of(rows);
    for (int i = 0; i < m->n_free; i++) {
        int at = place_of(m, rows, i);
        for (int c = 0; c < 3 && at >= 0; c++) {
            double *diagonal = w->newton_band + (size_t)(3 * at + c) * column;
            *diagonal += shift;
            if (spring_N_per_m) *diagonal += spring_N_per_m[i];
        }
    }
}

/* ---- factor and solve ---- */

hf_status hf_newton_matrix_factor_blocks(const hf_model *m, hf_workspace *w, hf_newton_block *block_of,
                                         const double *spring_N_per_m, const hf_newton_rows *rows, double *condition)
{
    hf_newton_rows all = all_rows(m);
    if (!rows) rows = &all;
    int n = 3 * rows->n, k = column_of(rows) - 1;
    double shift = DIAGONAL_GUARD;
    for (;; shift = shift < SHIFT_FIRST ? SHIFT_FIRST : 100 * shift) {
        double largest = assemble_rows(m, w, block_of, rows);
        if (!(isfinite(largest) && largest > 0) || shift > 1) return HF_SINGULAR;
        stiffen(m, w, rows, shift * largest, spring_N_per_m);
        double norm = condition ? hf_band_norm(n, k, w->newton_band, w->newton_work) : 0;
        if ((m->by_lapack ? hf_band_factor_lapack : hf_band_factor)(n, k, w->newton_band) != 0) continue;
        if (condition)
            *condition = hf_band_condition(n, k, w->newton_band, norm, w->newton_work, w->newton_integer_work);
        if (condition && shift > DIAGONAL_GUARD) *condition = INFINITY;
        return HF_OK;
    }
}

/* Returns the maximum sum of T/l of the cables at a free node, N/m. Sets *n_most to the maximum number of cables at
 * one. */
static double largest_across(const hf_model *m, hf_workspace *w, double *n_most)
{
    double *sum = w->newton_work, *count = sum + m->n_free, largest = 0, u[3];
    memset(sum, 0, 2 * (size_t)m->n_free * sizeof *sum);
    for (int e = 0; e < m->n_cable; e++) {
        double length = hf_newton_matrix_direction(m, w->position_m, e, u);
        double T = hf_newton_matrix_tension_N(hf_workspace_cable(m, w, e), length, w->tension_N[e]);
        for (int k = 2 * e; k < 2 * e + 2; k++) {
            if (m->end_row[k] >= m->n_free) continue;
            sum[m->end_row[k]] += fabs(T) / length;
            count[m->end_row[k]]++;
        }
    }
    *n_most = 0;
    for (int i = 0; i < m->n_free; i++) {
        largest = fmax(largest, sum[i]);
        *n_most = fmax(*n_most, count[i]);
    }
    return largest;
}

double hf_newton_matrix_factor_below(const hf_model *m, hf_workspace *w, double *condition)
{
    hf_newton_rows rows = all_rows(m);
    int n = 3 * rows.n, k = column_of(&rows) - 1;
    double n_most, across = largest_across(m, w, &n_most), shift = BELOW * across;
    double largest = assemble_rows(m, w, hf_newton_matrix_block, &rows);
    double part = hf_newton_matrix_rounding(k, n_most), least = shift - part * across;
    if (!(isfinite(largest) && least > 0)) return 0;
    for (int i = 0; i < n; i++) {
        double *diagonal = w->newton_band + (size_t)i * ((size_t)k + 1);
        *diagonal -= shift + part * *diagonal;
    }
    double norm = hf_band_norm(n, k, w->newton_band, w->newton_work);
    if (hf_band_factor(n, k, w->newton_band) != 0) return 0;
    *condition = hf_band_condition(n, k, w->newton_band, norm, w->newton_work, w->newton_integer_work);
    return norm / *condition > BELOW_CLEARLY * shift ? least : 0;
}

/* With rows, this works in place because the index of a row among the moving ones never exceeds its index among all. */
void hf_newton_matrix_solve(const hf_model *m, const hf_workspace *w, const hf_newton_rows *rows, int n_rhs,
                            double *rhs)
{
    int n = rows ? 3 * rows->n : hf_newton_matrix_dofs(m), k = rows ? column_of(rows) - 1 : 3 * m->half_bandwidth + 2;
    for (int i = 0; rows && i < m->n_free; i++)
        if (rows->place[i] >= 0) memmove(rhs + 3 * rows->place[i], rhs + 3 * i, 3 * sizeof *rhs);
    (m->by_lapack ? hf_band_back_solve_lapack : hf_band_back_solve)(n, k, n_rhs, w->newton_band, rhs, n);
    for (int i = m->n_free - 1; rows && i >= 0; i--)
        for (int c = 0; c < 3; c++)
            rhs[3 * i + c] = rows->place[i] >= 0 ? rhs[3 * rows->place[i] + c] : 0;
}

hf_status hf_newton_matrix_factor(const hf_model *m, hf_workspace *w, double *condition)
{
    return hf_newton_matrix_factor_blocks(m, w, hf_newton_matrix_block, NULL, NULL, condition);
}
