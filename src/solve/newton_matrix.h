/* newton_matrix - the Hessian of the energy Pi(x) of a tension net with the multipliers eliminated (METHOD section 5).
 * Stability: internal; may change in any version.
 *
 * The unknowns are the 3 n_free coordinates, dof 3*row + component. A cable with unit vector u, tension T and length l
 * adds the block (T/l)(I - uu') + k uu' between its ends, where k = phi''(l). A cable under law length has k =
 * HF_NEWTON_STIFFENING T/L* instead. Its tension step dT = k (dl + l - L*) is eliminated, so the matrix stays symmetric
 * positive definite. Eq. 8 is the same step with a stiffening of 1. A taut elastic cable has k = EA/l0 and L* = l0 (1 +
 * T/EA), so no force contains EA times a length error. A slack one has k = 0. The matrix is stored as a lower band,
 * column-major, with half-bandwidth 3b + 2, in the workspace's newton_band. */
#pragma once

#include "linalg/packed_band.h"
#include <hifdm/workspace.h>

#include <math.h>

/* Stiffness of a cable under law length, divided by its tension per length. The larger it is, the closer a step comes
 * to a hard constraint. The forces do not contain it, so it costs no accuracy in the residual. From 1e6 to 1e9 the
 * tests of solve and stress pass; with 1e5 one fails (flat_edges_are_solved). */
#define HF_NEWTON_STIFFENING 1e7
#define HF_NEWTON_LEAST_PULL 1e-3 /* minimum over the reference tension; tests of the path pass with 0.1, not 1e-6 */

/* Returns the number of rows of the band, 3 n_free. */
static inline int hf_newton_matrix_dofs(const hf_model *model)
{
    return 3 * model->n_free;
}

/* Returns the length of cable i_cable at the shape position_m [3][n_node], m, and sets its unit vector. */
static inline double hf_newton_matrix_direction(const hf_model *model, const double *position_m, int i_cable,
                                                double unit[3])
{
    int a = model->end_row[2 * i_cable], b = model->end_row[2 * i_cable + 1];
    for (int c = 0; c < 3; c++)
        unit[c] = position_m[c * model->n_node + b] - position_m[c * model->n_node + a];
    double length = sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
    for (int c = 0; c < 3; c++)
        unit[c] /= length;
    return length;
}

/* Returns the rate of the length of a cable with this unit vector when the nodes move by move_m [3][n_node]. `relative`
 * [3] becomes the move of its second end relative to its first. */
static inline double hf_newton_matrix_length_rate(const hf_model *model, int i_cable, const double unit[3],
                                                  const double *move_m, double relative[3])
{
    for (int c = 0; c < 3; c++)
        relative[c] = move_m[c * model->n_node + model->end_row[2 * i_cable + 1]] -
                      move_m[c * model->n_node + model->end_row[2 * i_cable]];
    return unit[0] * relative[0] + unit[1] * relative[1] + unit[2] * relative[2];
}

/* Sets rate [3] to the rate of the pull of a cable at its first end when the nodes move and its tension changes. */
static inline void hf_newton_matrix_pull_rate(const hf_model *model, const double *position_m, int i_cable,
                                              double tension_N, double tension_rate, const double *move_m,
                                              double rate[3])
{
    double unit[3], length = hf_newton_matrix_direction(model, position_m, i_cable, unit);
    double along = hf_newton_matrix_length_rate(model, i_cable, unit, move_m, rate);
    for (int c = 0; c < 3; c++)
        rate[c] = tension_rate * unit[c] + tension_N * ((rate[c] - along * unit[c]) / length);
}

/* Sets force [3 n_moving] to the loads, N. */
static inline void hf_newton_matrix_set_loads(const hf_model *model, const hf_workspace *workspace, double *force)
{
    for (int i = 0; i < workspace->n_moving; i++)
        for (int c = 0; c < 3; c++)
            force[3 * i + c] = model->load_N ? model->load_N[c * model->n_node + i] : 0;
}

/* Adds `part` of newton_step to position_m [3][n_node]. */
static inline void hf_newton_matrix_move_nodes(const hf_model *model, const hf_workspace *workspace, double part,
                                               double *position_m)
{
    for (int i = 0; i < workspace->n_moving; i++)
        for (int c = 0; c < 3; c++)
            position_m[c * model->n_node + i] += part * workspace->newton_step[3 * i + c];
}

/* Adds the pull of cable i_cable, N, to force [3 n_moving] at its first end, and subtracts it at its second. */
static inline void hf_newton_matrix_add_pull(const hf_model *model, const hf_workspace *workspace, int i_cable,
                                             const double pull[3], double *force)
{
    int a = model->end_row[2 * i_cable], b = model->end_row[2 * i_cable + 1];
    for (int c = 0; c < 3; c++) {
        if (a < workspace->n_moving) force[3 * a + c] += pull[c];
        if (b < workspace->n_moving) force[3 * b + c] -= pull[c];
    }
}

/* Does the same for the supports alone, to force [3 n_support]; attachments are supports. */
static inline void hf_newton_matrix_add_to_supports(const hf_model *model, int i_cable, const double pull[3],
                                                    double *force)
{
    for (int end = 0; end < 2; end++) {
        int support = model->end_row[2 * i_cable + end] - model->n_free;
        for (int c = 0; c < 3 && support >= 0; c++)
            force[3 * support + c] += end ? -pull[c] : pull[c];
    }
}

/* Returns true if cable i_cable ends at a support, on a truss or on rigid ground. */
static inline bool hf_newton_matrix_is_at_support(const hf_model *model, int i_cable)
{
    return model->end_row[2 * i_cable] >= model->n_free || model->end_row[2 * i_cable + 1] >= model->n_free;
}

/* Sets block [3][3] to the stiffness of a spring with this unit vector, N/m (M6). along and across are in N/m. */
static inline void hf_newton_matrix_spring(double along, double across, const double unit[3], double block[3][3])
{
    double more = along - across;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            block[r][c] = more * unit[r] * unit[c] + (r == c ? across : 0);
}

/* Adds a spring between two nodes to a lower band of `column` entries per column, three rows per node. a and b are the
 * indices of the nodes in it. A negative index is a node that does not move; at most one of the two may be negative. */
static inline void hf_newton_matrix_add_block(double *band, int column, int a, int b, double block[3][3])
{
    int low = a < b ? a : b, high = a < b ? b : a;
    bool is_between = low >= 0;
    if (!is_between) low = high;
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++) {
            double k = block[r][c];
            double *diagonal = band + (r - c) + (size_t)(3 * low + c) * (size_t)column;
            if (r >= c) *diagonal += k;
            if (!is_between) continue;
            if (r >= c) diagonal[(size_t)(3 * (high - low)) * (size_t)column] += k;
            diagonal[3 * (high - low)] -= k;
        }
}

/* Returns the tension, N: the multiplier if the law has one, else what the law gives at this length. */
static inline double hf_newton_matrix_tension_N(hf_law_cable cable, double length_m, double multiplier_N)
{
    return hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER) ? multiplier_N : hf_law_tension_N(cable, length_m);
}

/* Returns k = phi'' of a cable of this length, N/m. For a rigid law it is the stiffness of the spring that replaces
 * it. */
static inline double hf_newton_matrix_stiffness(hf_law_cable cable, double length_m, double tension_N)
{
    if (hf_law_has(cable.law, HF_LAW_IS_RIGID))
        return HF_NEWTON_STIFFENING * tension_N / hf_law_required_length_m(cable, tension_N);
    return hf_law_stiffness_N_per_m(cable, length_m);
}

/* Returns the stiffness of the spring that replaces a taut cable under a rigid law, N/m. Its tension may be near zero
 * or still negative. */
static inline double hf_newton_matrix_rigid_stiffness(const hf_model *m, int i_cable, double tension_N)
{
    return HF_NEWTON_STIFFENING * fmax(tension_N, HF_NEWTON_LEAST_PULL * m->reference_N) / m->length_m[i_cable];
}

/* Returns true for law force_density, under which the force is a linear function of the positions. */
static inline bool hf_newton_matrix_is_spring(hf_law law)
{
    return !hf_law_has(law, HF_LAW_HAS_MULTIPLIER | HF_LAW_GIVES_TENSION);
}

/* Sets block [3][3] to the stiffness of cable i_cable between its ends at the workspace's shape and tensions, N/m (M6).
 * The coupling with a truss uses it for the cables that end at attachments. */
void hf_newton_matrix_block(const hf_model *model, const hf_workspace *workspace, int i_cable, double block[3][3]);

/* Sets block [3][3] to the stiffness between the ends of a cable, N/m. The functions below take it for matrices of
 * other blocks than that of hf_newton_matrix_block. */
typedef void hf_newton_block(const hf_model *model, const hf_workspace *workspace, int i_cable, double block[3][3]);

/* The rows whose nodes move. A spring of stiffness INFINITY fixes a row. */
typedef struct {
    int n, half_bandwidth;
    const int *place; /* [n_free] index among the moving rows; -1: fixed */
} hf_newton_rows;

/* Returns the rows that the springs [n_free] do not fix. Fills place [n_free]. */
hf_newton_rows hf_newton_matrix_find_rows(const hf_model *model, const double *spring_N_per_m, int *place);

/* Factors the matrix at the workspace's shape and tensions into newton_band. *condition (may be NULL) becomes an
 * estimate of its 1-norm condition number, or INFINITY if a Levenberg shift beyond the smallest was needed. Returns
 * HF_OK, or HF_SINGULAR if no shift helps. */
hf_status hf_newton_matrix_factor(const hf_model *model, hf_workspace *workspace, double *condition);

/* Assembles the matrix of these blocks into newton_band. Returns its maximum diagonal entry, N/m. */
double hf_newton_matrix_assemble_blocks(const hf_model *model, hf_workspace *workspace, hf_newton_block *block_of);

/* Factors the matrix of these blocks, as hf_newton_matrix_factor does. block_of is not called for cables between two
 * supports. spring_N_per_m [n_free] (may be NULL) are springs that tie the rows to the ground. `rows` are the moving
 * rows; NULL: all rows move. */
hf_status hf_newton_matrix_factor_blocks(const hf_model *model, hf_workspace *workspace, hf_newton_block *block_of,
                                         const double *spring_N_per_m, const hf_newton_rows *rows, double *condition);

/* Factors the matrix minus a small shift of its diagonal into newton_band. The existence of the factor certifies a
 * lower bound of the minimum eigenvalue of the matrix (METHOD section 3). Returns that bound, N/m, and sets *condition.
 * Returns 0 if there is no such factor, or if the estimated eigenvalue is not clearly above the shift; newton_band and
 * *condition are then of no use. */
double hf_newton_matrix_factor_below(const hf_model *model, hf_workspace *workspace, double *condition);

/* Returns a packed matrix, without arrays, for the factor of the Newton matrix in newton_band. */
static inline hf_packed_band hf_newton_matrix_packed(const hf_model *model)
{
    return hf_packed_band_of(3 * model->n_free, 3 * model->half_bandwidth + 2);
}

#define HF_UNIT 0x1p-53 /* half the distance from 1 to the next double */

/* Returns a bound of how much rounding changes a quadratic form with the matrix, relative to the sum of diagonal
 * entries times squares. It includes the assembly from cables, at most n_cable at a node, and the factorisation with
 * this half-bandwidth. */
static inline double hf_newton_matrix_rounding(int half_bandwidth, double n_cable)
{
    double k = half_bandwidth;
    return HF_UNIT * (1.1 * (k + 4) * (k + 1) + 400 + 20 * n_cable);
}

/* Solves in place with the factor in newton_band: rhs [n_rhs][3 n_free], forces in N, becomes the step in m. rows:
 * NULL, or the moving rows of the factor, for one right-hand side; the step of the others is 0. */
void hf_newton_matrix_solve(const hf_model *model, const hf_workspace *workspace, const hf_newton_rows *rows, int n_rhs,
                            double *rhs);
