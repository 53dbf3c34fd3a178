/* saddle_dual - the system of a saddle without border by band Cholesky, several times as fast as by LU (METHOD section
 * 12).
 *
 * With weights W + R of all coordinates, where R > 0 stands in for those that nobody measured, moves follow from the
 * multipliers p, and what is left for these is symmetric and positive definite,
 *     (P + H (W + R)^-1 H) p = H (W + R)^-1 b - a,    of   -P p + H x = a,   H p + W x = b,
 * with P = B sigma^2 B'. Its band is twice that of H. What R and rounding do wrong is taken off by refinement. */
#ifndef HIFDM_SADDLE_DUAL_H
#define HIFDM_SADDLE_DUAL_H

#include "built/linear.h"

#define HF_SADDLE_DUAL_PANEL 3 /* right-hand sides for which the kernel of the band reads the factor once */

typedef struct {
    const hf_built_linear *linear;
    int n, half_bandwidth;    /* 3 n_free rows */
    int *start, *cable;       /* [n_free + 1], [start[n_free]] cables of each free row */
    double *block;            /* [n_cable][9] of H, without unit */
    double *push;             /* [n_cable] diagonal of sigma^2 times B's square, without unit */
    double *spring;           /* [n_free] of loose nodes, without unit */
    double *weight;           /* [n] W, without unit */
    double *band, *right;     /* the matrix, then its factor; [HF_SADDLE_DUAL_PANEL][n] */
    double *solution, *error; /* [HF_SADDLE_DUAL_PANEL][2 n] three multipliers and three moves of each row */
    double *probe;            /* [2 n] a right-hand side */
    void *memory;
} hf_saddle_dual;

/* HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_saddle_dual_create(const hf_built_linear *linear, hf_saddle_dual *dual);
void hf_saddle_dual_free(hf_saddle_dual *dual);

/* Factor at the shape that the linear answer has, in units of moves and multipliers; sigma_m [n_cable], weight_per_m2
 * [n_dof] times `part`. False when refinement does not find solutions: another way is needed. */
bool hf_saddle_dual_factor(hf_saddle_dual *dual, const double *sigma_m, const double *weight_per_m2, double part,
                           double size_m, double force_m_per_N);

/* Right-hand sides [n][6 n_free], rows of each node side by side, replaced by the solutions. False when refinement does
 * not find one of them. No solution depends on the others. */
bool hf_saddle_dual_solve(const hf_saddle_dual *dual, int n, double *band);

#endif
