/* frame - linear statics of a truss: displacements, reactions and member forces under load cases.
 * Stability: stable.
 *
 * Members are 12-dof spatial beams (Eqs. 14, 15 of Chen et al. 2022), Euler and Bernoulli's or Timoshenko's, or carry
 * axial force alone. The stiffness matrix is assembled as LAPACK's lower band on a numbering with a
 * small bandwidth, scaled to a unit diagonal, and factored once; every load case after that is two triangular solves.
 *
 * Vectors over the nodes are [n_node][6]: x, y, z components (m or N), then about x, y, z (rad or N m). */
#ifndef HIFDM_FRAME_H
#define HIFDM_FRAME_H

#include <hifdm/api.h>
#include <hifdm/truss.h>

HF_API_BEGIN

/* Shared and constant once it is built. */
typedef struct {
    const hf_truss *truss; /* borrowed: must outlive the frame */
    int n_dof;             /* unknowns */
    int half_bandwidth;
    int *row_of_dof;   /* [n_node][6] row of the matrix, HF_FRAME_FIXED or HF_FRAME_ABSENT */
    double *axes;      /* [n_member][3][3] local x, y, z as unit vectors */
    double *length_m;  /* [n_member] */
    double *stiffness; /* [n_member][6] EA/L (N/m), GJ/L, then near and far bending about z and y (N m) */
    double *scale;     /* [n_dof] 1/sqrt of the diagonal */
    double *factor;    /* [n_dof][half_bandwidth+1] Cholesky factor of the scaled matrix */
    double condition;  /* of the scaled matrix, estimated */
    void *block;
} hf_frame;

#define HF_FRAME_FIXED -1  /* held by a support */
#define HF_FRAME_ABSENT -2 /* a rotation that no beam resists: all members of the node are pinned. Given as 0. */

/* One load case; NULL: no load of this kind. */
typedef struct {
    const double *force;         /* [n_node][6] N, N m */
    const double *settlement;    /* [n_node][6] m, rad: displacements of supported dofs; other dofs are ignored */
    const double *temperature_K; /* [n_member] rise above the temperature without stress */
} hf_frame_load;

/* Build the frame of a checked truss. Returns HF_OK; HF_MECHANISM with a message that names a node and dof that can
 * move without force (a mechanism, or a truss without enough supports); HF_NO_MEMORY; HF_NO_LAPACK. Free with
 * hf_frame_free in any case. */
hf_status hf_frame_build(const hf_truss *truss, hf_frame *frame, hf_messages *messages);
void hf_frame_free(hf_frame *frame);

size_t hf_frame_work_size(const hf_frame *frame, int n_case); /* doubles in `work` */

/* Solve n_case load cases in one pass over the factor. work: [hf_frame_work_size]; displacement: [n_case][n_node][6],
 * with settlements in the supported dofs. Returns HF_OK; HF_MECHANISM, with displacement untouched, when a moment acts
 * where nothing resists rotation: *bad_dof is then 6 * node + dof, else -1. */
hf_status hf_frame_solve(const hf_frame *frame, int n_case, const hf_frame_load *load, double *work,
                         double *displacement, int *bad_dof);

/* Compute reactions from the displacement under this load case. reaction: [n_node][6] forces of the supports on the
 * truss, 0 at free dofs. residual, or NULL: [n_node][6] forces out of balance at free dofs, 0 at supported ones. */
void hf_frame_reactions(const hf_frame *frame, const hf_frame_load *load, const double *displacement, double *reaction,
                        double *residual);

/* Compute end_force [n_member][12], the local forces of the nodes on the member: Nx, Vy, Vz, Tx, My, Mz at i (Nx > 0:
 * compression), then at j. */
void hf_frame_member_forces(const hf_frame *frame, const hf_frame_load *load, const double *displacement,
                            double *end_force);

double hf_frame_strain_energy(const hf_frame *frame, const hf_frame_load *load, const double *displacement); /* J */

/* Compute the flexibility of the nodes listed in node [n_point]: flexibility_m_per_N [3 n_point][3 n_point] holds the
 * displacement of dof 3*i+c under a unit force on dof 3*k+d, and is symmetric to the last bit. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_frame_condense(const hf_frame *frame, int n_point, const int *node, double *flexibility_m_per_N);

HF_API_END
#endif
