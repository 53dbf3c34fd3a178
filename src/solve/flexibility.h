/* flexibility - the flexibility of the truss as F = L L', with which net and truss have one convex energy (METHOD
 * section 3).
 * Stability: internal; may change in any version.
 *
 * The displacements of the attachments are r = L s, and the truss stores the energy s's/2. The components of s are the
 * unknowns of the truss; there are as many as F has directions that move, so that the truss may be rigid in the others.
 * Vectors b and r have n = 3 n_attachment components by dof 3*i + c. */
#ifndef HIFDM_FLEXIBILITY_H
#define HIFDM_FLEXIBILITY_H

#include "linalg/twofold.h"
#include "solve/newton_matrix.h"

/* HF_BOUND_TRUSS_ITEMS (workspace.h) has room for the arrays. */
typedef struct {
    int n, rank;
    bool is_lower;  /* column k of L begins with k zeros */
    double *root;   /* [rank][n] columns of L, N^-1/2 m^1/2 */
    double trace;   /* of L L', m/N: an upper bound of its norm, rounding included */
    double *factor; /* [rank][rank] of share + L' S L: lower band of all columns */
    double *window; /* scratch */
} hf_flexibility;

/* Factors the flexibility of the model into root; factor and window have been set. L L' differs from the matrix of the
 * model by rounding alone; returns false when there is no such L, because the matrix has an eigenvalue below zero. */
bool hf_flexibility_factor(const hf_model *model, hf_flexibility *flexibility);

/* r [n] = L s, and s [rank] = L' b. */
void hf_flexibility_displace(const hf_flexibility *flexibility, const double *s, double *r);
void hf_flexibility_load(const hf_flexibility *flexibility, const double *b, double *s);

/* Row i of L s, component k of L' b, and row i of F b, at twice the precision. Their errors are below 8 (rank + 1) and
 * 8 (n + 1) HF_TWOFOLD_UNIT times the sum of the absolute values of the products. */
hf_twofold hf_flexibility_displace_twofold(const hf_flexibility *flexibility, const hf_twofold *s, int i);
hf_twofold hf_flexibility_load_twofold(const hf_flexibility *flexibility, const hf_twofold *b, int k);
hf_twofold hf_flexibility_row_twofold(const hf_model *model, const hf_twofold *b, int i);

/* What rounding may do in hf_flexibility_factor_net: relative to the diagonal entries of the free nodes and of s, and
 * absolutely. */
typedef struct {
    double free, own;           /* relative */
    double free_N_per_m, own_1; /* absolute; the second without a unit */
} hf_flexibility_rounding;

/* stiffness_N_per_m: the largest sum of the stiffnesses of the cables at a node; n_cable: most cables at one. */
hf_flexibility_rounding hf_flexibility_rounding_of(const hf_model *model, const hf_flexibility *flexibility,
                                                   double stiffness_N_per_m, double n_cable);

/* Ends the Cholesky factorisation of the Hessian of net and truss in the unknowns of the free nodes and s, with
 * `share` in place of 1 as the stiffness of the truss: `factor` becomes that of share + L' S L, S of (M15).
 * newton_band, or `band` without a Newton matrix, holds the factor of the free nodes; block_of gives the blocks of the
 * cables. rounding (may be NULL) is subtracted from the diagonal. Returns false when there is no factor. Overwrites
 * `factor` and `flexed` of hf_schur_factor. */
bool hf_flexibility_factor_net(const hf_model *model, hf_workspace *workspace, hf_newton_block *block_of,
                               const hf_flexibility_rounding *rounding, double share, hf_flexibility *flexibility);

/* The same with share 1 and the S that hf_schur_factor has left in the workspace. */
bool hf_flexibility_factor_schur(const hf_model *model, const hf_workspace *workspace, hf_flexibility *flexibility);

#endif
