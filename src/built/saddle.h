/* saddle - the linear least-squares problem of an estimate as one band system (METHOD section 12, M41). It finds the
 * errors of cut lengths and of positions of supports that explain measured positions best, for a linear model.
 *
 * With the multipliers p of equilibrium the estimated errors are e = B'p times their variances sigma^2. The remaining
 * unknowns are the displacements x and p:
 *
 *     H x - B sigma^2 B' p = -B e_now,    H p + W x = W gap.
 *
 * All blocks are in the band of H. The border has the attachments on a truss, whose flexibility is dense, supports with
 * errors, and numbers z that cables share. The errors of lengths are then the cables' own ones plus U z, with z =
 * U'B'p. No matrix is inverted that may be singular. B sigma^2 B' is singular across a flat net, and W is singular when
 * nodes were not measured. */
#pragma once

#include "built/linear.h"

/* Describes the prior and the measurement. All pointers are borrowed. */
typedef struct {
    const double *sigma_m; /* [n_cable] standard deviation of each cable's own error of length, >= 0 */
    /* Standard deviation of each coordinate of a support, or of the resting position of an attachment; 0: they are
     * exact. */
    double support_sigma_m;
    const double *weight_per_m2; /* [n_dof] 1/sigma^2 of measured coordinates; 0: not measured */
    int n_shared;                /* numbers of standard deviation 1 that cables share */
    const double *shared_m;      /* [n_shared][n_cable] error of each length by each number */
} hf_saddle_prior;

#define HF_SADDLE_PANEL 3 /* right-hand sides for which the band kernel reads the factor once */

/* The band as a problem of multipliers alone. Cholesky solves it several times as fast as LU.
 *
 * The weights are W + R, where a small R > 0 stands for coordinates that were not measured. Displacements x then follow
 * from the multipliers p. With P = B sigma^2 B', the system -P p + H x = a, H p + W x = b becomes
 *
 *     (P + H (W + R)^-1 H) p = H (W + R)^-1 b - a.
 *
 * This matrix is symmetric and positive definite, with twice the bandwidth of H. Iterative refinement with the original
 * matrix removes the errors of R and of rounding. */
typedef struct {
    const hf_built_linear *linear;
    int n, half_bandwidth; /* n: 3 n_free rows */
    int *start, *cable;    /* [n_node + 1], [2 n_cable] cables of each row */
    double *block;         /* [n_cable][9] stiffness blocks, scaled */
    double *push;          /* [n_cable] sigma^2 (dT/dl0)^2, scaled */
    double *spring;        /* [n_free] springs of loose nodes, scaled */
    double *weight;        /* [n] W, scaled */
    double *band, *right;  /* the matrix, then its factor; [HF_SADDLE_PANEL][n] */
    /* [HF_SADDLE_PANEL][2 n], three multipliers and three displacements of each row. */
    double *solution, *error;
    double *probe; /* [2 n] right-hand side of the probe */
    void *memory;
} hf_saddle_dual;

typedef struct {
    const hf_built_linear *linear;
    hf_saddle_prior prior;
    int n_band, half_bandwidth; /* 6 n_free rows: for each node three multipliers, then three displacements */
    int n_attached, n_off;      /* 3 n_attachment; 3 times the supports on rigid ground that have errors */
    /* Size of the border: displacements of attachments, their multipliers, displacements of supports, shared
     * numbers. */
    int n_border;
    hf_saddle_dual dual;          /* a faster method, tried first when the border has only shared numbers */
    bool is_dual;                 /* true: the last factor is that of `dual` */
    double part;                  /* factor of the weights, 1/(1 + damping) */
    int n_factor;                 /* linear->n_factor at the last factorisation; 0: there is no factor */
    double size_m, force_m_per_N; /* units of displacements and multipliers; they scale the entries to about 1 */
    double *general;              /* the band, then its factor */
    int *pivot;                   /* [n_band] row exchanges of the band */
    double *column, *solved;      /* [n_border][n_band] columns of the border, and the solutions of the band for them */
    /* [n_border][n_border] corner; [n_border][n_border] its factor; [n_attached][n_attached] scaled flexibility. */
    double *corner, *dense, *flex;
    double *work;     /* [1 + HF_SADDLE_PANEL][n_border] scratch, then right-hand sides */
    int *dense_pivot; /* [n_border] row exchanges of the corner */
    void *block;
} hf_saddle;

/* Makes a system for the linear model `linear`, which is borrowed. Returns HF_OK or HF_NO_MEMORY; call hf_saddle_free
 * in either case. */
hf_status hf_saddle_create(const hf_built_linear *linear, const hf_saddle_prior *prior, hf_saddle *saddle);
void hf_saddle_free(hf_saddle *saddle);

/* Factors the system at the present shape of the linear model, with the weights of positions divided by 1 + damping.
 * Does nothing when both are as before. Returns HF_OK or HF_SINGULAR. */
hf_status hf_saddle_factor(hf_saddle *saddle, double damping);

/* Holds a right-hand side and its solution. Arrays are [n_cable] or [n_dof] unless stated otherwise. */
typedef struct {
    const double *gap_m; /* in: measured minus present position; read only where measured */
    double *cut_m;       /* in: errors of the present shape; out: the estimate */
    double *rest_m;      /* in: displacements of supports in the present shape; out: the estimate */
    double *move_m;      /* out: displacements from the present to the estimated shape */
    double *shared;      /* out: [n_shared] numbers; cut_m includes them */
} hf_saddle_answer;

/* Solves n <= HF_SADDLE_PANEL independent right-hand sides; work is [n][n_band]. Returns HF_OK; or HF_SINGULAR
 * when rounding prevents a solution, in which case no solution is written. */
hf_status hf_saddle_solve(const hf_saddle *saddle, int n, hf_saddle_answer *answer, double *work);
