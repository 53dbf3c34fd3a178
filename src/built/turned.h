/* turned - how far the samples of what an estimate leaves open lie apart once the net is turned: by the stiffness of
 * the turned net, and each of them solved, since cables that become slack or taut by the turns are beyond first order
 * (METHOD section 12). */
#ifndef HIFDM_TURNED_H
#define HIFDM_TURNED_H

#include "built/estimate.h"

/* What hf_estimate_doubt has found, and scratch. Borrowed. */
typedef struct {
    hf_estimate *estimate;
    const double *doubt_m; /* [samples][n_dof] of the estimated shape */
    const hf_estimate_cause *cause;
    double *strain_N, *scratch; /* [n_cable]; [linear.n_scratch] */
} hf_turned;

/* What the errors that are left move, move_m [samples][n_dof], by the stiffness of this shape of the estimated net;
 * where it has none, doubt_m. HF_OK, HF_INTERRUPTED, HF_NO_MEMORY. */
hf_status hf_turned_answer(const hf_turned *turned, const hf_workspace *shape, double *move_m);

/* What that misses of the solved samples, beyond_m [samples][n_dof], with cut lengths changed by turn_m [n_cable], by
 * which the estimated net got `shape`; 0 of a sample without a shape. answer_m: as of hf_turned_answer. n_thread 0: all
 * cores; the same bits for any number. HF_OK, HF_INTERRUPTED, HF_NO_MEMORY. */
hf_status hf_turned_beyond(const hf_turned *turned, const double *turn_m, const hf_workspace *shape, int n_thread,
                           double *answer_m, double *beyond_m);

#endif
