/* joint - one Newton matrix for a net and its truss (METHOD section 8): the band of the free nodes, and a dense matrix
 * for the attachments.
 * Stability: internal; may change in any version.
 *
 * Vectors [3 n_moving] hold the free nodes by dof 3*row + c, followed by the attachments in the same way. The forces on
 * attachments are those of cables and loads. The truss answers them by the displacements F f, so the inverse of F is
 * not needed. With n_moving = n_free all functions act on the net alone, as in newton_matrix.h. */
#pragma once

#include "solve/newton_matrix.h"

/* Factors the matrix of these blocks for net and truss. spring_N_per_m [n_free] (may be NULL) are springs at free
 * nodes. rows: NULL, or the rows of a net alone that move. condition (may be NULL) is that of the band of the free
 * nodes. Returns HF_OK or HF_SINGULAR. */
hf_status hf_joint_factor(const hf_model *model, hf_workspace *workspace, hf_newton_block *block_of,
                          const double *spring_N_per_m, const hf_newton_rows *rows, double *condition);

/* Solves in place with that factor, the same blocks and the same rows: the forces rhs [3 n_moving], N, become the step,
 * m. The attachments step from their displacements in position_m to those under the forces after the step. */
void hf_joint_solve(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of,
                    const hf_newton_rows *rows, double *rhs);

/* Returns the maximum length of n vectors [3], scale a - b; b may be NULL. A NaN stays. */
double hf_joint_largest(int n, double scale, const double *a, const double *b);

/* Returns the maximum |F f - r| of an attachment for the forces [3 n_moving], N, at the shape position_m [3][n_node],
 * m; 0 without a truss. *square (may be NULL) is increased by the sum of the squares, relative to the square of the
 * mean length. */
double hf_joint_gap_m(const hf_model *model, const hf_workspace *workspace, const double *position_m,
                      const double *force, double *square);

/* Returns entry `at` of position_m [3][n_node] before the truss deflects, m. */
double hf_joint_resting_m(const hf_model *model, const hf_workspace *workspace, int at);

/* Returns the mean length of the cables at the target positions, m. */
double hf_joint_mean_length_m(const hf_model *model);

/* Returns the stiffness that a loose row is given in a matrix, because it has none of its own, N/m. */
double hf_joint_loose_spring_N_per_m(const hf_model *model);

/* A gap below this value is rounding of the coordinates. */
#define HF_JOINT_NO_GAP_M 1e-14

/* Sets displacement_m to the displacements of the attachments in position_m. */
void hf_joint_set_displacement(const hf_model *model, hf_workspace *workspace);
