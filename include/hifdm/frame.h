/* frame - linear statics of a truss: displacements, reactions and member forces in load cases.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   hf_frame_build       truss -> stiffness matrix (Eqs. 14, 15), scaled to a unit diagonal, and its Cholesky factor
 *   hf_frame_solve       loads, settlements, temperatures -> displacements; two triangular solves for each load case
 *   hf_frame_reactions, hf_frame_member_forces, hf_frame_strain_energy   displacements -> forces, energy
 *   hf_frame_condense    Cholesky factor -> flexibility of selected nodes
 *   hf_frame_blocks      members -> stiffness matrix by blocks
 *
 * A member is a spatial beam with 12 degrees of freedom (METHOD section 8), or it carries only axial force. Beams
 * follow the Euler-Bernoulli theory or the Timoshenko theory. The stiffness matrix is stored as a lower band in the
 * layout of LAPACK. The numbering of the unknowns reduces the bandwidth of the stiffness matrix.
 *
 * Vectors over the nodes have the shape [n_node][6]. A vector contains six components for each node: along x, y, z in m
 * or N, and about x, y, z in rad or N m. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/model.h>
#include <hifdm/truss.h>

HF_API_BEGIN

/* Contains a truss with its factored stiffness matrix. A frame does not change after it is built. Threads can therefore
 * share a frame. */
typedef struct {
    const hf_truss *truss; /* the truss, borrowed; it must outlive the frame */
    int n_dof;             /* number of unknowns */
    int half_bandwidth;    /* number of matrix columns below the diagonal */
    int *row_of_dof;       /* [n_node][6] row of the matrix, HF_FRAME_FIXED or HF_FRAME_ABSENT */
    double *axes;          /* [n_member][3][3] unit vectors of the local axes x, y, z */
    double *length_m;      /* [n_member] lengths */
    double *stiffness;     /* [n_member][6] EA/L (N/m), GJ/L, then bending terms, near and far, about z and y (N m) */
    double *scale;         /* [n_dof] 1/sqrt of the diagonal entries */
    double *factor;        /* [n_dof][half_bandwidth+1] Cholesky factor of the scaled matrix */
    double condition;      /* estimated condition number of the scaled matrix */
    void *block;           /* owned memory behind the arrays */
} hf_frame;

#define HF_FRAME_FIXED -1 /* degree of freedom that a support holds */
/* rotation that no beam resists because all members at the node are pinned; its value is 0 */
#define HF_FRAME_ABSENT -2

/* One load case. If a pointer in this struct is NULL, the load case has no load of this kind. */
typedef struct {
    const double *force; /* [n_node][6] nodal forces in N and moments in N m */
    /* [n_node][6] displacements of supported degrees of freedom, m and rad; others are ignored */
    const double *settlement;
    const double *temperature_K; /* [n_member] rise above the temperature at which the members have no stress */
} hf_frame_load;

/* Builds the frame of a checked truss. Returns HF_OK, or HF_BAD_CASE if every node is supported. Returns HF_MECHANISM
 * if the truss is a mechanism or lacks supports. The error message contains a node and a degree of freedom that can
 * move without a force. Returns HF_NO_MEMORY if memory runs out or the matrix is too large. Returns HF_NO_LAPACK if
 * LAPACK cannot be loaded. Call hf_frame_free even if hf_frame_build fails. */
hf_status hf_frame_build(const hf_truss *truss, hf_frame *frame, hf_messages *messages);
/* Frees the arrays of the frame. This function does not free the truss. */
void hf_frame_free(hf_frame *frame);

/* Returns the number of doubles in the array `work` that hf_frame_solve needs for n_case load cases. */
size_t hf_frame_work_size(const hf_frame *frame, int n_case);

/* Solves the n_case load cases in the array `load` in one pass over the Cholesky factor. The array work
 * [hf_frame_work_size] is scratch memory. The array displacement [n_case][n_node][6] receives the displacements in m
 * and rad. At supported degrees of freedom, the displacements are the settlements. If the function succeeds, it returns
 * HF_OK and sets *bad_dof to -1. Returns HF_MECHANISM if a moment acts at a node where nothing resists rotation. If the
 * status is HF_MECHANISM, *bad_dof is 6 * node + dof, and displacement is unchanged. */
hf_status hf_frame_solve(const hf_frame *frame, int n_case, const hf_frame_load *load, double *work,
                         double *displacement, int *bad_dof);

/* Computes the reactions in a load case from the nodal displacements displacement [n_node][6]. The array reaction
 * [n_node][6] receives the forces of the supports on the truss. At free degrees of freedom, the reactions are 0. The
 * array residual [n_node][6] receives the residual forces at free degrees of freedom. At supported degrees of freedom,
 * the residual forces are 0. The array `residual` may be NULL. */
void hf_frame_reactions(const hf_frame *frame, const hf_frame_load *load, const double *displacement, double *reaction,
                        double *residual);

/* Computes the member forces in a load case from the nodal displacements displacement [n_node][6]. The array end_force
 * [n_member][12] receives the forces of the nodes on the member in local axes. The forces are Nx, Vy, Vz, Tx, My and
 * Mz, in N and N m, first at end i and then at end j. If the axial force Nx at end i is above 0, the member is under
 * compression. */
void hf_frame_member_forces(const hf_frame *frame, const hf_frame_load *load, const double *displacement,
                            double *end_force);

/* Returns the strain energy in J for the nodal displacements displacement [n_node][6] in a load case. The strain energy
 * includes only elastic strain, not thermal expansion. */
double hf_frame_strain_energy(const hf_frame *frame, const hf_frame_load *load, const double *displacement);

/* Computes the flexibility matrix F of the n_point nodes in the array `node` (Eq. 15, condensed). Row 3*i+c of the
 * array flexibility_m_per_N [3 n_point][3 n_point] belongs to the displacement of node[i] along axis c. Column 3*k+d of
 * the flexibility matrix belongs to a unit force on node[k] along axis d. The flexibility matrix is exactly symmetric.
 * Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_frame_condense(const hf_frame *frame, int n_point, const int *node, double *flexibility_m_per_N);

/* Computes the stiffness matrix of the truss by blocks. The first n_point blocks are the translations of the nodes in
 * the array `node`. The blocks of the other translations and of the rotations follow. If two of the n_point nodes are
 * the same node, to->n is 0. The owner frees to->memory with free. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_frame_blocks(const hf_frame *frame, int n_point, const int *node, hf_stiffness_blocks *to);

HF_API_END
