/* saddle - the least squares of an estimate in one band matrix (METHOD section 12): which errors of cut lengths, and of
 * places of supports, explain measured places best, when what they move is linear.
 *
 * With the multipliers p of equilibrium the errors are e = sigma^2 B'p, and what is left are moves x and p:
 *     H x - B sigma^2 B' p = -B e_now,    H p + W x = W gap,
 * of both parts in the band of H. Attachments on a truss, whose flexibility is dense, supports that may be off, and
 * numbers z that cables share (lengths e = own errors + U z, so z = U'B'p) are a border. Nothing is inverted that may
 * be singular: neither B sigma^2 B' (a flat net has none across) nor W (nodes that nobody measured). */
#ifndef HIFDM_SADDLE_H
#define HIFDM_SADDLE_H

#include "built/saddle_dual.h"

/* What is known beforehand, and how well places are known. Borrowed. */
typedef struct {
    const double *sigma_m;       /* [n_cable] of a cable's own errors of its length; >= 0 */
    double support_sigma_m;      /* of a coordinate of supports and of where attachments rest; 0: they are right */
    const double *weight_per_m2; /* [n_dof] 1/sigma^2 of measured coordinates; 0: not measured */
    int n_shared;                /* numbers of deviation 1 that cables share */
    const double *shared_m;      /* [n_shared][n_cable] what each adds to the lengths */
} hf_saddle_prior;

typedef struct {
    const hf_built_linear *linear;
    hf_saddle_prior prior;
    int n_band, half_bandwidth;    /* 6 n_free rows: of each node three multipliers, then three moves */
    int n_attached, n_off;         /* 3 n_attachment; 3 times the supports on rigid ground that may be off */
    int n_border;                  /* moves of attachments, their multipliers, moves of these supports, numbers */
    hf_saddle_dual dual;           /* with no border but numbers: a quicker way, which is tried first */
    bool is_dual;                  /* the last factor is that */
    double part;                   /* of the weights, 1/(1 + damping) */
    int n_factor;                  /* that of `linear` for which the factor is; 0: there is none */
    double size_m, force_m_per_N;  /* units of moves and multipliers: entries of the matrix are about 1 */
    double *general;               /* the band, then its factor */
    int *pivot;                    /* [n_band] */
    double *column, *solved;       /* [n_border][n_band] the border, and what the factor makes of it */
    double *corner, *dense, *flex; /* [n_border][n_border]; its factor; [n_attached][n_attached] */
    double *work;                  /* [1 + HF_SADDLE_DUAL_PANEL][n_border] */
    int *dense_pivot;              /* [n_border] */
    void *block;
} hf_saddle;

/* HF_OK or HF_NO_MEMORY; free in either case. */
hf_status hf_saddle_create(const hf_built_linear *linear, const hf_saddle_prior *prior, hf_saddle *saddle);
void hf_saddle_free(hf_saddle *saddle);

/* Factor at the shape that the linear answer has now, with the weights of places divided by 1 + damping; nothing is
 * done where both are as before. HF_OK or HF_SINGULAR. */
hf_status hf_saddle_factor(hf_saddle *saddle, double damping);

/* An answer, and what it is asked for. All by cable [n_cable] or dof [n_dof]. */
typedef struct {
    const double *gap_m; /* measured less present place; read where it is measured */
    double *cut_m;       /* in: errors of the present shape; out: the estimate */
    double *rest_m;      /* in: how far supports are off in the present shape; out: the estimate */
    double *move_m;      /* out: from the present shape to the estimated one */
    double *shared;      /* out: numbers [n_shared], which are in cut_m, too */
} hf_saddle_answer;

/* n <= HF_SADDLE_DUAL_PANEL answers, which do not depend on each other; work: [n][n_band]. HF_OK; HF_SINGULAR when
 * rounding leaves one without answer: none is written then. */
hf_status hf_saddle_solve(const hf_saddle *saddle, int n, hf_saddle_answer *answer, double *work);

#endif
