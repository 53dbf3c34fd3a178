/* flexibility - the flexibility of the truss as F = L L', which gives net and truss one convex energy (METHOD section
 * 3).
 * Stability: internal; may change in any version.
 *
 * The displacements of the attachments are r = L s, and the truss stores the energy s's/2. The components of s are the
 * unknowns of the truss. Their number is the rank of F, so the truss may be rigid in some directions. Vectors b and r
 * have n = 3 n_attachment components by dof 3*i + c. */
#pragma once

#include "linalg/twofold.h"
#include "solve/newton_matrix.h"

/* L, and the factor of the rows of the truss. HF_BOUND_TRUSS_ITEMS (workspace.h) has room for the arrays. */
typedef struct {
    int n, rank;
    bool is_lower;  /* column k of L begins with k zeros */
    double *root;   /* [rank][n] columns of L, (m/N)^(1/2) */
    double trace;   /* of L L', m/N: an upper bound of its norm that includes rounding */
    double *factor; /* [rank][rank] of share + L' S L: lower band with all columns */
    double *window; /* scratch */
} hf_flexibility;

/* Factors the flexibility of the model into root; the caller has set root, factor and window. L L' differs from that
 * matrix by rounding alone. Returns false if there is no such L, because the matrix has a negative eigenvalue. */
bool hf_flexibility_factor(const hf_model *model, hf_flexibility *flexibility);

/* hf_flexibility_displace sets r [n] = L s, and hf_flexibility_load sets s [rank] = L' b. */
void hf_flexibility_displace(const hf_flexibility *flexibility, const double *s, double *r);
void hf_flexibility_load(const hf_flexibility *flexibility, const double *b, double *s);

/* These return row i of L s, component k of L' b, and row i of F b, at twice the precision. Their errors are below c
 * HF_TWOFOLD_UNIT times the sum of the absolute values of the products. c is 8 (rank + 1) for L s and 8 (n + 1) for the
 * others. */
hf_twofold hf_flexibility_displace_twofold(const hf_flexibility *flexibility, const hf_twofold *s, int i);
hf_twofold hf_flexibility_load_twofold(const hf_flexibility *flexibility, const hf_twofold *b, int k);
hf_twofold hf_flexibility_row_twofold(const hf_model *model, const hf_twofold *b, int i);

/* Bounds of the effect of rounding in hf_flexibility_factor_net on the diagonal entries of the free nodes and of s. */
typedef struct {
    double free, own;           /* relative to the diagonal entry */
    double free_N_per_m, own_1; /* absolute; own_1 without a unit */
} hf_flexibility_rounding;

/* Returns these bounds. stiffness_N_per_m: maximum sum of the stiffnesses of the cables at a node; n_cable: maximum
 * number of cables at a node. */
hf_flexibility_rounding hf_flexibility_rounding_of(const hf_model *model, const hf_flexibility *flexibility,
                                                   double stiffness_N_per_m, double n_cable);

/* Completes the Cholesky factorisation of the Hessian of net and truss in the unknowns of the free nodes and s. The
 * stiffness of the truss is `share` in place of 1, so `factor` becomes that of share + L' S L, with S of (M15). Before,
 * newton_band, or `band` without a Newton matrix, must hold the factor of the free nodes. The function block_of gives
 * the blocks of the cables. `rounding` (may be NULL) is subtracted from the diagonal. Returns false if there is no
 * factor. Overwrites `factor` and `flexed` of hf_schur_factor. */
bool hf_flexibility_factor_net(const hf_model *model, hf_workspace *workspace, hf_newton_block *block_of,
                               const hf_flexibility_rounding *rounding, double share, hf_flexibility *flexibility);

/* Does the same with share 1 and the S that hf_schur_factor has left in the workspace. */
bool hf_flexibility_factor_schur(const hf_model *model, const hf_workspace *workspace, hf_flexibility *flexibility);
