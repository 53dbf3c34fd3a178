/* saddle_dual - solves the band of the saddle-point system by Cholesky, several times as fast as by LU (METHOD section
 * 12).
 *
 * The weights are W + R, where a small R > 0 stands for coordinates that were not measured. Displacements x then follow
 * from the multipliers p. With P = B sigma^2 B', the system -P p + H x = a, H p + W x = b becomes
 *
 *     (P + H (W + R)^-1 H) p = H (W + R)^-1 b - a.
 *
 * This matrix is symmetric and positive definite, with twice the bandwidth of H. Iterative refinement with the original
 * matrix removes the errors of R and of rounding. */
#ifndef HIFDM_SADDLE_DUAL_H
#define HIFDM_SADDLE_DUAL_H

#include "built/linear.h"

#define HF_SADDLE_DUAL_PANEL 3 /* right-hand sides for which the band kernel reads the factor once */

typedef struct {
    const hf_built_linear *linear;
    int n, half_bandwidth; /* n: 3 n_free rows */
    int *start, *cable;    /* [n_node + 1], [2 n_cable] cables of each row */
    double *block;         /* [n_cable][9] stiffness blocks, scaled */
    double *push;          /* [n_cable] sigma^2 (dT/dl0)^2, scaled */
    double *spring;        /* [n_free] springs of loose nodes, scaled */
    double *weight;        /* [n] W, scaled */
    double *band, *right;  /* the matrix, then its factor; [HF_SADDLE_DUAL_PANEL][n] */
    /* [HF_SADDLE_DUAL_PANEL][2 n], three multipliers and three displacements of each row. */
    double *solution, *error;
    double *probe; /* [2 n] right-hand side of the probe */
    void *memory;
} hf_saddle_dual;

/* Makes the matrix for the linear model `linear`, which is borrowed. Returns HF_OK or HF_NO_MEMORY; call
 * hf_saddle_dual_free in either case. */
hf_status hf_saddle_dual_create(const hf_built_linear *linear, hf_saddle_dual *dual);
void hf_saddle_dual_free(hf_saddle_dual *dual);

/* Factors the matrix at the present shape of the linear model. size_m and force_m_per_N are the units of displacements
 * and multipliers. The prior is sigma_m [n_cable], the weights are weight_per_m2 [n_dof] times `part`. Returns false
 * when the matrix has no factor or refinement does not solve a probe; another method is then needed. */
bool hf_saddle_dual_factor(hf_saddle_dual *dual, const double *sigma_m, const double *weight_per_m2, double part,
                           double size_m, double force_m_per_N);

/* Replaces n right-hand sides band [n][6 n_free] by their solutions; three multipliers and three displacements of each
 * row are side by side. Returns false when refinement fails for one of them. No solution depends on the others. */
bool hf_saddle_dual_solve(const hf_saddle_dual *dual, int n, double *band);

#endif
