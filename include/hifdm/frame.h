/* frame - linear statics of a truss: displacements, reactions and member forces under load cases.
 * Stability: stable.
 *
 * Pipeline:
 *
 *   hf_frame_build       truss -> stiffness matrix (Eqs. 14, 15), scaled to a unit diagonal, and its Cholesky factor
 *   hf_frame_solve       loads, settlements, temperatures -> displacements, by two triangular solves for each load case
 *   hf_frame_reactions, hf_frame_member_forces, hf_frame_strain_energy   displacements -> forces, energy
 *   hf_frame_condense    factor -> flexibility of some nodes
 *
 * Members are spatial beams with 12 degrees of freedom (METHOD section 8), or they carry axial force alone. The beam
 * theory is that of Euler and Bernoulli or of Timoshenko. The matrix is a lower band in LAPACK's layout, numbered for a
 * small bandwidth.
 *
 * Vectors over the nodes are [n_node][6]: components along x, y, z in m or N, then about x, y, z in rad or N m. */
#ifndef HIFDM_FRAME_H
#define HIFDM_FRAME_H

#include <hifdm/api.h>
#include <hifdm/truss.h>

HF_API_BEGIN

/* A truss with its factored stiffness matrix. It does not change once it is built, so threads share it. */
typedef struct {
    const hf_truss *truss; /* the truss; borrowed, must outlive the frame */
    int n_dof;             /* number of unknowns */
    int half_bandwidth;    /* number of columns below the diagonal */
    int *row_of_dof;       /* [n_node][6] row of the matrix, HF_FRAME_FIXED or HF_FRAME_ABSENT */
    double *axes;          /* [n_member][3][3] local x, y, z as unit vectors */
    double *length_m;      /* [n_member] lengths */
    double *stiffness;     /* [n_member][6] EA/L (N/m), GJ/L, then near and far bending about z and y (N m) */
    double *scale;         /* [n_dof] 1/sqrt of the diagonal */
    double *factor;        /* [n_dof][half_bandwidth+1] Cholesky factor of the scaled matrix */
    double condition;      /* estimated condition number of the scaled matrix */
    void *block;           /* owned memory behind the arrays */
} hf_frame;

#define HF_FRAME_FIXED -1  /* held by a support */
#define HF_FRAME_ABSENT -2 /* rotation that no beam resists, because all members are pinned; its value is 0 */

/* One load case. A member that is NULL stands for no load of this kind. */
typedef struct {
    const double *force;         /* [n_node][6] nodal forces and moments, N, N m */
    const double *settlement;    /* [n_node][6] displacements of supported dofs, m, rad; other dofs are ignored */
    const double *temperature_K; /* [n_member] rise above the temperature at which the members have no stress */
} hf_frame_load;

/* Builds the frame of a checked truss. Returns HF_OK; HF_MECHANISM, with a message that names a node and a dof that can
 * move without force, for a mechanism or a truss without enough supports; HF_BAD_CASE if every node is supported;
 * HF_NO_MEMORY, also if the matrix is too large; HF_NO_LAPACK. Call hf_frame_free in any case. */
hf_status hf_frame_build(const hf_truss *truss, hf_frame *frame, hf_messages *messages);
/* Frees the arrays of the frame, but not the truss. */
void hf_frame_free(hf_frame *frame);

/* Returns the number of doubles that hf_frame_solve needs in `work` for n_case load cases. */
size_t hf_frame_work_size(const hf_frame *frame, int n_case);

/* Solves n_case load cases load [n_case] in one pass over the factor. work [hf_frame_work_size] is scratch.
 * displacement [n_case][n_node][6] receives the displacements in m and rad, with the settlements in the supported dofs.
 * Returns HF_OK and sets *bad_dof to -1. Returns HF_MECHANISM if a moment acts where nothing resists rotation; *bad_dof
 * is then 6 * node + dof, and displacement is unchanged. */
hf_status hf_frame_solve(const hf_frame *frame, int n_case, const hf_frame_load *load, double *work,
                         double *displacement, int *bad_dof);

/* Computes the reactions under a load case from its displacement [n_node][6]. reaction [n_node][6] receives the forces
 * of the supports on the truss, 0 at free dofs. residual [n_node][6], which may be NULL, receives the forces out of
 * balance at free dofs, 0 at supported ones. */
void hf_frame_reactions(const hf_frame *frame, const hf_frame_load *load, const double *displacement, double *reaction,
                        double *residual);

/* Computes the member forces under a load case from its displacement [n_node][6]. end_force [n_member][12] receives the
 * local forces of the nodes on the member: Nx, Vy, Vz, Tx, My, Mz at end i, then at end j, in N and N m. Nx > 0 at i is
 * compression. */
void hf_frame_member_forces(const hf_frame *frame, const hf_frame_load *load, const double *displacement,
                            double *end_force);

/* Returns the strain energy under a load case with this displacement [n_node][6], J. Only elastic strain counts, not
 * thermal expansion. */
double hf_frame_strain_energy(const hf_frame *frame, const hf_frame_load *load, const double *displacement);

/* Computes the flexibility F of the nodes node [n_point] (Eq. 15, condensed). flexibility_m_per_N
 * [3 n_point][3 n_point] at row 3*i+c and column 3*k+d receives the displacement of node[i] along c under a unit force
 * on node[k] along d. It is symmetric to the last bit. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_frame_condense(const hf_frame *frame, int n_point, const int *node, double *flexibility_m_per_N);

HF_API_END
#endif
