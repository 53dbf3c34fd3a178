/* schur - the exact derivative of a net on its truss, for sensitivities, certificates and the population solver (METHOD
 * section 8).
 * Stability: internal; may change in any version.
 *
 * With r the displacements of the attachments, F their flexibility, and H the Newton matrix in parts of free nodes (f)
 * and attachments (a), the net's stiffness at the attachments is S = H_aa - H_af H_ff^-1 H_fa. */
#ifndef HIFDM_SCHUR_H
#define HIFDM_SCHUR_H

#include "solve/newton_matrix.h"

/* r = F f: displacements of the attachments under the forces on them; both [3 n_attachment], m and N. */
void hf_schur_flex(const hf_model *model, const double *force_N, double *displacement_m);

/* The matrices at one shape, with I + F S factored. */
typedef struct {
    int n;             /* 3 n_attachment */
    double *stiffness; /* [n][n] S, symmetric */
    double *flexed;    /* [n][n] F S, column-major */
    double *factor;    /* [n][n] LU of I + F S, column-major */
    double *column;    /* [HF_SCHUR_COLUMNS] scratch */
    int *pivot;        /* [n] */
    void *block;
} hf_schur;

/* HF_OK or HF_NO_MEMORY. The caller frees it in either case. */
hf_status hf_schur_create(const hf_model *model, hf_schur *schur);
void hf_schur_free(hf_schur *schur);

/* In the memory of a workspace that has a Newton matrix: nothing to free. The last factor there is kept. */
hf_schur hf_schur_of(const hf_model *model, const hf_workspace *workspace);

/* Assemble and factor at the workspace's shape for the matrix of these blocks, whose part for the free nodes must be
 * factored in newton_band. HF_OK or HF_SINGULAR. */
hf_status hf_schur_factor(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of,
                          hf_schur *schur);

/* stiffness [n][n] += H_aa, n = per_node n_attachment: cables from attachments to free nodes, fixed supports and other
 * attachments. per_node is 3, or 1 where the three coordinates have the same matrix. */
void hf_schur_add_own(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of, int per_node,
                      double *stiffness);

/* pull [n] -= H_aa r. After hf_schur_push of r, a solve for the free nodes, and hf_schur_pull it is -S r. */
void hf_schur_hold(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of,
                   const double *displacement_m, double *pull);

/* (I + F S)^-1 F b into displacement_m, both [n]: the move of the attachments when b, N, is added to the pull on them
 * at their present places. */
void hf_schur_displace(const hf_model *model, const hf_schur *schur, const double *b, double *displacement_m);

/* b [n] -> (I + F S)^-1 b. */
void hf_schur_solve(const hf_schur *schur, double *b);

/* (I + F S)^-1 = I + sum of left right' over the modes in which F S is large. Modes are taken greedily until the
 * remainder has a Frobenius norm of at most `tolerance`, or max_mode are there. mode: [max_mode][2][n], left before
 * right. Returns the number of modes. Overwrites `flexed`. */
int hf_schur_modes(hf_schur *schur, double tolerance, int max_mode, double *mode);

/* force [3 n_free] += -H_fa r; pull [3 n_attachment] += -H_af x, with H of these blocks. */
void hf_schur_push(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of,
                   const double *displacement_m, double *force);
void hf_schur_pull(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of,
                   const double *step_m, double *pull);

#endif
