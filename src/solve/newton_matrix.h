/* newton_matrix - the Hessian of the energy Pi(x) of a tension net with the multipliers eliminated (METHOD section 5).
 * Stability: internal; may change in any version.
 *
 * Unknowns: the 3 n_free coordinates, dof 3*row + component. A cable with unit vector u, tension T and length l adds
 * the block (T/l)(I - uu') + k uu' between its ends, where k = phi''(l). A cable under law length has
 * k = HF_NEWTON_STIFFENING T/L* instead: its tension step dT = k (dl + l - L*) is eliminated, so the matrix stays
 * symmetric positive definite. Eq. 8 is the same step with a stiffening of 1. An elastic cable has k = EA/l0 and
 * L* = l0 (1 + T/EA), so that no force contains EA times an error of length; a slack one has k = 0.
 * Storage: lower band, column-major, half-bandwidth 3b + 2, in the workspace's newton_band. */
#ifndef HIFDM_NEWTON_MATRIX_H
#define HIFDM_NEWTON_MATRIX_H

#include <hifdm/workspace.h>

#include <math.h>

/* Stiffness of a cable under law length, divided by its tension per length. The larger it is, the nearer a step comes
 * to a hard constraint. The forces do not contain it, so it costs no accuracy in the residual. From 1e6 to 1e9 the
 * tests of solve and stress pass; with 1e5 one fails (flat_edges_are_solved). */
#define HF_NEWTON_STIFFENING 1e7
#define HF_NEWTON_LEAST_PULL 1e-3 /* over the reference tension; the path's tests pass with 0.1, not with 1e-6 */

/* Number of rows of the band, 3 n_free. */
static inline int hf_newton_matrix_dofs(const hf_model *model)
{
    return 3 * model->n_free;
}

/* Length of cable i_cable at the shape position_m [3][n_node], m, and its unit vector. */
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

/* Set force [3 n_moving] to the loads. */
static inline void hf_newton_matrix_set_loads(const hf_model *model, const hf_workspace *workspace, double *force)
{
    for (int i = 0; i < workspace->n_moving; i++)
        for (int c = 0; c < 3; c++)
            force[3 * i + c] = model->load_N ? model->load_N[c * model->n_node + i] : 0;
}

/* Add the pull of cable i_cable on its first end, and the opposite on its second, to force [3 n_moving]. */
static inline void hf_newton_matrix_add_pull(const hf_model *model, const hf_workspace *workspace, int i_cable,
                                             const double pull[3], double *force)
{
    int a = model->end_row[2 * i_cable], b = model->end_row[2 * i_cable + 1];
    for (int c = 0; c < 3; c++) {
        if (a < workspace->n_moving) force[3 * a + c] += pull[c];
        if (b < workspace->n_moving) force[3 * b + c] -= pull[c];
    }
}

/* Stiffness [3][3] of a spring in the direction of the unit vector, N/m (M6). */
static inline void hf_newton_matrix_spring(double along, double across, const double unit[3], double block[3][3])
{
    double more = along - across;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            block[r][c] = more * unit[r] * unit[c] + (r == c ? across : 0);
}

/* Add a spring between two nodes to a lower band of `column` entries a column, three rows to a node. a, b: their places
 * in it; below zero: the node does not move, of one of them at most. */
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

/* Tension, N: the multiplier where the law has one, else what the law gives at this length. */
static inline double hf_newton_matrix_tension_N(hf_law_cable cable, double length_m, double multiplier_N)
{
    return hf_law_has(cable.law, HF_LAW_HAS_MULTIPLIER) ? multiplier_N : hf_law_tension_N(cable, length_m);
}

/* k = phi'' of a cable of this length, N/m; for a rigid law, k of the stiff spring in its place. */
static inline double hf_newton_matrix_stiffness(hf_law_cable cable, double length_m, double tension_N)
{
    if (hf_law_has(cable.law, HF_LAW_IS_RIGID))
        return HF_NEWTON_STIFFENING * tension_N / hf_law_wanted_length_m(cable, tension_N);
    return hf_law_stiffness_N_per_m(cable, length_m);
}

/* The same spring for a taut cable whose tension may be near zero, or still below it. */
static inline double hf_newton_matrix_rigid_stiffness(const hf_model *m, int i_cable, double tension_N)
{
    return HF_NEWTON_STIFFENING * fmax(tension_N, HF_NEWTON_LEAST_PULL * m->reference_N) / m->length_m[i_cable];
}

/* Law force_density: the force is a linear function of the positions. */
static inline bool hf_newton_matrix_is_spring(hf_law law)
{
    return !hf_law_has(law, HF_LAW_HAS_MULTIPLIER | HF_LAW_GIVES_TENSION);
}

/* Stiffness [3][3] of cable i_cable between its ends at the workspace's shape and tensions, N/m (M6). The coupling with
 * a truss uses it for the cables that end at attachments. */
void hf_newton_matrix_block(const hf_model *model, const hf_workspace *workspace, int i_cable, double block[3][3]);

/* Stiffness between the ends of a cable, for matrices of other blocks than the above. */
typedef void hf_newton_block(const hf_model *model, const hf_workspace *workspace, int i_cable, double block[3][3]);

/* The rows whose nodes move; a spring without end (INFINITY) pins a row. */
typedef struct {
    int n, half_bandwidth;
    const int *place; /* [n_free] of a row among them; -1: it does not move */
} hf_newton_rows;

/* Find them; place: [n_free], filled. */
hf_newton_rows hf_newton_matrix_find_rows(const hf_model *model, const double *spring_N_per_m, int *place);

/* Factor the matrix at the workspace's shape and tensions into newton_band. *condition (may be NULL): estimate of its
 * 1-norm condition number, INFINITY when it took a Levenberg shift beyond the smallest. HF_SINGULAR when no shift
 * helps. */
hf_status hf_newton_matrix_factor(const hf_model *model, hf_workspace *workspace, double *condition);

/* Assemble the matrix of these blocks into newton_band. Returns the largest diagonal entry. */
double hf_newton_matrix_assemble_blocks(const hf_model *model, hf_workspace *workspace, hf_newton_block *block_of);

/* hf_newton_matrix_factor for the matrix of these blocks. Cables between two supports are not asked for.
 * spring_N_per_m [n_free] (may be NULL): springs that tie the rows to the ground. */
hf_status hf_newton_matrix_factor_blocks(const hf_model *model, hf_workspace *workspace, hf_newton_block *block_of,
                                         const double *spring_N_per_m, double *condition);

/* The same for the rows that move alone, and a solution: rhs [3 n_free] gets 0 in the others. */
hf_status hf_newton_matrix_factor_rows(const hf_model *model, hf_workspace *workspace, hf_newton_block *block_of,
                                       const double *spring_N_per_m, const hf_newton_rows *rows);
void hf_newton_matrix_solve_rows(const hf_model *model, const hf_workspace *workspace, const hf_newton_rows *rows,
                                 double *rhs);

/* hf_newton_matrix_factor for the matrix less a little on its diagonal, such that the factor proves a lower bound of
 * its least eigenvalue, N/m, which is returned (METHOD section 3). 0: there is no such factor, or the little is not
 * clearly below that eigenvalue; newton_band then holds nothing. */
double hf_newton_matrix_factor_below(const hf_model *model, hf_workspace *workspace, double *condition);

#define HF_UNIT 0x1p-53 /* half the distance from 1 to the next double */

/* What assembling a matrix from cables, of which n_cable are at one node, and factoring it in half-bandwidth k can
 * do to a quadratic form with it, relative to the sum of diagonal entries times squares. */
static inline double hf_newton_matrix_rounding(int half_bandwidth, double n_cable)
{
    double k = half_bandwidth;
    return HF_UNIT * (1.1 * (k + 4) * (k + 1) + 400 + 20 * n_cable);
}

/* Solve in place, rhs [3 n_free] or [n_rhs][3 n_free], with the factor in newton_band. */
void hf_newton_matrix_solve(const hf_model *model, const hf_workspace *workspace, double *rhs);
void hf_newton_matrix_solve_many(const hf_model *model, const hf_workspace *workspace, int n_rhs, double *rhs);

#endif
