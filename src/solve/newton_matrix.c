#include "solve/newton_matrix.h"

#include "linalg/band.h"

#include <string.h>

/* Levenberg shift of every matrix, relative to the largest diagonal entry. From 0 to 1e-12 the tests of solve and
 * stress pass; with 1e-10 two fail (last_digits_are_cheap, flat_edges_are_solved). */
#define DIAGONAL_GUARD 1e-14
/* Shift after the first failed factorisation, a hundredfold after each further one. No net of these tests has such a
 * matrix, so that nothing changes from 1e-13 to 1e-4; the unit test makes one by a cable that pushes. */
#define SHIFT_FIRST 1e-10
/* Stiffness of the spring at a row that does not move, over the diagonal without it: it moves less than rounding. */
#define PINNED 1e20

static int half_bandwidth(const hf_model *m)
{
    return 3 * m->half_bandwidth + 2;
}

void hf_newton_matrix_block(const hf_model *m, const hf_workspace *w, int e, double block[3][3])
{
    hf_law_cable cable = hf_workspace_cable(m, w, e);
    double u[3], length = hf_newton_matrix_direction(m, w->position_m, e, u);
    double T = hf_newton_matrix_tension_N(cable, length, w->tension_N[e]);
    hf_newton_matrix_spring(hf_newton_matrix_stiffness(cable, length, T), T / length, u, block);
}

double hf_newton_matrix_assemble_blocks(const hf_model *m, hf_workspace *w, hf_newton_block *block_of)
{
    int column = half_bandwidth(m) + 1;
    double *band = w->newton_band, block[3][3], largest = 0;
    memset(band, 0, (size_t)hf_newton_matrix_dofs(m) * (size_t)column * sizeof *band);
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1], low = a < b ? a : b, high = a < b ? b : a;
        if (low >= m->n_free) continue;
        block_of(m, w, e, block);
        for (int c = 0; c < 3; c++)
            for (int r = 0; r < 3; r++) {
                double k = block[r][c];
                double *diagonal = band + (r - c) + (size_t)(3 * low + c) * (size_t)column;
                if (r >= c) *diagonal += k;
                if (high >= m->n_free) continue;
                if (r >= c) diagonal[(size_t)(3 * (high - low)) * (size_t)column] += k;
                diagonal[3 * (high - low)] -= k;
            }
    }
    for (int i = 0; i < hf_newton_matrix_dofs(m); i++)
        largest = fmax(largest, band[(size_t)i * (size_t)column]);
    return largest;
}

static void shift_diagonal(const hf_model *m, hf_workspace *w, double shift)
{
    size_t column = (size_t)half_bandwidth(m) + 1;
    for (size_t i = 0; i < (size_t)hf_newton_matrix_dofs(m); i++)
        w->newton_band[i * column] += shift;
}

static void add_springs(const hf_model *m, hf_workspace *w, const double *spring_N_per_m)
{
    size_t column = (size_t)half_bandwidth(m) + 1;
    for (int i = 0; i < hf_newton_matrix_dofs(m); i++)
        w->newton_band[(size_t)i * column] += fmin(spring_N_per_m[i / 3], PINNED * w->newton_band[(size_t)i * column]);
}

hf_status hf_newton_matrix_factor_blocks(const hf_model *m, hf_workspace *w, hf_newton_block *block_of,
                                         const double *spring_N_per_m, double *condition)
{
    int n = hf_newton_matrix_dofs(m), k = half_bandwidth(m);
    double shift = DIAGONAL_GUARD;
    for (;; shift = shift < SHIFT_FIRST ? SHIFT_FIRST : 100 * shift) {
        double largest = hf_newton_matrix_assemble_blocks(m, w, block_of);
        if (!(isfinite(largest) && largest > 0) || shift > 1) return HF_SINGULAR;
        shift_diagonal(m, w, shift * largest);
        if (spring_N_per_m) add_springs(m, w, spring_N_per_m);
        double norm = condition ? hf_band_norm(n, k, w->newton_band, w->newton_work) : 0;
        if (hf_band_factor(n, k, w->newton_band) != 0) continue;
        if (condition)
            *condition = hf_band_condition(n, k, w->newton_band, norm, w->newton_work, w->newton_integer_work);
        if (condition && shift > DIAGONAL_GUARD) *condition = INFINITY;
        return HF_OK;
    }
}

hf_status hf_newton_matrix_factor(const hf_model *m, hf_workspace *w, double *condition)
{
    return hf_newton_matrix_factor_blocks(m, w, hf_newton_matrix_block, NULL, condition);
}

void hf_newton_matrix_solve_many(const hf_model *m, const hf_workspace *w, int n_rhs, double *rhs)
{
    int n = hf_newton_matrix_dofs(m);
    hf_band_back_solve(n, half_bandwidth(m), n_rhs, w->newton_band, rhs, n);
}

void hf_newton_matrix_solve(const hf_model *m, const hf_workspace *w, double *rhs)
{
    hf_newton_matrix_solve_many(m, w, 1, rhs);
}
