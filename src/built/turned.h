/* turned - posterior samples of an estimate after turnbuckle adjustments (METHOD section 12).
 *
 * It gives their displacements by the linear model of the adjusted net, and the corrections of samples that are solved
 * in full. The corrections matter when an adjustment makes cables slack or taut, because this is beyond first order. */
#ifndef HIFDM_TURNED_H
#define HIFDM_TURNED_H

#include "built/estimate.h"

/* Holds the output of hf_estimate_doubt, and scratch. All pointers are borrowed. */
typedef struct {
    hf_estimate *estimate;
    const double *doubt_m; /* [HF_ESTIMATE_SAMPLES][n_dof] posterior displacements of the estimated shape */
    const hf_estimate_cause *cause;
    double *strain_N, *scratch; /* [n_cable]; [linear.n_scratch] */
} hf_turned;

/* Computes the displacements move_m [HF_ESTIMATE_SAMPLES][n_dof] of the posterior samples by the linear model at
 * `shape`, a shape of the estimated net. Where that has no stiffness, move_m is doubt_m. Returns HF_OK, HF_INTERRUPTED
 * or HF_NO_MEMORY. */
hf_status hf_turned_answer(const hf_turned *turned, const hf_workspace *shape, double *move_m);

/* Solves the posterior samples with cut lengths increased by turn_m [n_cable], and computes their displacements minus
 * the linear ones, beyond_m [HF_ESTIMATE_SAMPLES][n_dof]. It is 0 for a sample without a shape. `shape` is the
 * estimated net with these adjustments. answer_m receives the output of hf_turned_answer.
 *
 * n_thread is the number of threads, 0 for all cores. The result has the same bits for any number. Returns HF_OK,
 * HF_INTERRUPTED or HF_NO_MEMORY. */
hf_status hf_turned_beyond(const hf_turned *turned, const double *turn_m, const hf_workspace *shape, int n_thread,
                           double *answer_m, double *beyond_m);

#endif
