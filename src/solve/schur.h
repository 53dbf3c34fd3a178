/* schur - the exact derivative of a net on its truss, for sensitivities, certificates and the population solver (METHOD
 * section 8).
 * Stability: internal; may change in any version.
 *
 * r are the displacements of the attachments and F is their flexibility. H is the Newton matrix in parts of free nodes
 * (f) and attachments (a). The stiffness of the net at the attachments is S = H_aa - H_af H_ff^-1 H_fa. */
#pragma once

#include "solve/newton_matrix.h"

/* Sets displacement_m to F force_N: the displacements of the attachments under the forces on them. Both are [3
 * n_attachment], m and N. */
void hf_schur_flex(const hf_model *model, const double *force_N, double *displacement_m);

/* The matrices at one shape, with the factor of I + F S. */
#define HF_SCHUR_FIELDS(X)                                                                                             \
    X(double, stiffness, (size_t)to->n *(size_t)to->n, "S, symmetric")                                                 \
    X(double, flexed, (size_t)to->n *(size_t)to->n, "F S, column-major")                                               \
    X(double, factor, (size_t)to->n *(size_t)to->n, "LU of I + F S, column-major")                                     \
    X(double, column, HF_SCHUR_COLUMNS(m), "scratch")                                                                  \
    X(int, pivot, to->n, "rows of the LU")
typedef struct {
    int n; /* 3 n_attachment */
    HF_SCHUR_FIELDS(HF_ARENA_MEMBER)
    hf_arena arena; /* owned memory, unless it is that of a workspace */
} hf_schur;

/* Allocates the matrices. Returns HF_OK or HF_NO_MEMORY. The caller frees it in either case. */
hf_status hf_schur_create(const hf_model *model, hf_schur *schur);

/* Returns the matrices in the memory of a workspace that has a Newton matrix. There is nothing to free. The last factor
 * in the workspace is kept. */
hf_schur hf_schur_of(const hf_model *model, const hf_workspace *workspace);

/* Assembles and factors the matrices at the workspace's shape for the Newton matrix of these blocks. newton_band must
 * hold the factor of its part for the free nodes. Returns HF_OK or HF_SINGULAR. */
hf_status hf_schur_factor(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of,
                          hf_schur *schur);

/* Adds H_aa to stiffness [n][n], n = per_node n_attachment: the cables from attachments to free nodes, fixed supports
 * and other attachments. per_node is 3, or 1 if the three coordinates have the same matrix. */
void hf_schur_add_own(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of, int per_node,
                      double *stiffness);

/* Subtracts H_aa r from pull [n], N, for the displacements r [n], m. After hf_schur_push of r, a solve for the free
 * nodes, and hf_schur_pull, pull is -S r. */
void hf_schur_hold(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of,
                   const double *displacement_m, double *pull);

/* Sets displacement_m [n] to (I + F S)^-1 F b, m: the step of the attachments if b [n], N, is added to the pull on them
 * at their present positions. */
void hf_schur_displace(const hf_model *model, const hf_schur *schur, const double *b, double *displacement_m);

/* Replaces b [n] by (I + F S)^-1 b. */
void hf_schur_solve(const hf_schur *schur, double *b);

/* Approximates (I + F S)^-1 by I + sum of left right' over the modes in which F S is large. Modes are added until the
 * Frobenius norm of the remainder is at most `tolerance`, or there are max_mode. mode is [max_mode][2][n], left before
 * right. Returns the number of modes. Overwrites `flexed`. */
int hf_schur_modes(hf_schur *schur, double tolerance, int max_mode, double *mode);

/* hf_schur_push subtracts H_fa r from force [3 n_free], N, for displacements r of the attachments, m. hf_schur_pull
 * subtracts H_af x from pull [3 n_attachment], N, for the step x of the free nodes, m. H is the matrix of these
 * blocks. */
void hf_schur_push(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of,
                   const double *displacement_m, double *force);
void hf_schur_pull(const hf_model *model, const hf_workspace *workspace, hf_newton_block *block_of,
                   const double *step_m, double *pull);
