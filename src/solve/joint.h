/* joint - one Newton matrix for a net and its truss (METHOD section 8): the band of the free nodes, and a dense matrix
 * for the attachments.
 * Stability: internal; may change in any version.
 *
 * Vectors [3 n_moving] hold the free nodes by dof 3*row + c, and then the attachments in the same way. Forces on
 * attachments are those of cables and loads; the truss answers them by displacements F f, which need no inverse of F.
 * With n_moving = n_free all functions are those of newton_matrix.h for the net alone. */
#ifndef HIFDM_JOINT_H
#define HIFDM_JOINT_H

#include "solve/newton_matrix.h"

/* hf_newton_matrix_factor_blocks for net and truss; springs at free nodes only. condition (may be NULL) is that of the
 * band of the free nodes. */
hf_status hf_joint_factor(const hf_model *model, hf_workspace *workspace, hf_newton_block *block_of,
                          const double *spring_N_per_m, double *condition);

/* Solve in place with that factor and the same blocks: rhs [3 n_moving], forces, becomes the step. The attachments
 * go from where they are in position_m to the displacements under the forces after the step. */
void hf_joint_solve(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of, double *rhs);

/* Largest |F f - r| of an attachment for the forces [3 n_moving] at the shape position_m, m; 0 without a truss.
 * *square (may be NULL) is increased by the sum of the squares over that of the mean length. */
double hf_joint_gap_m(const hf_model *model, const hf_workspace *workspace, const double *position_m,
                      const double *force, double *square);

/* Returns where entry `at` of position_m [3][n_node] is before the truss deflects, m. */
double hf_joint_resting_m(const hf_model *model, const hf_workspace *workspace, int at);

/* Mean theoretical length of the cables. */
double hf_joint_mean_length_m(const hf_model *model);

/* A gap below it is rounding of the coordinates. */
#define HF_JOINT_NO_GAP_M 1e-14

/* Set displacement_m to where the attachments are in position_m. */
void hf_joint_set_displacement(const hf_model *model, hf_workspace *workspace);

#endif
