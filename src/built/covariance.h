/* covariance - what errors do to the shape of a net as built, to first order: the exact mean of psi^2, and the share of
 * each error in it (METHOD section 12). One solve for each coordinate of an inner node, whatever kinds of errors there
 * are. */
#ifndef HIFDM_COVARIANCE_H
#define HIFDM_COVARIANCE_H

#include "built/errors.h"

typedef struct {
    double nominal_psi_m;
    double spread_m2; /* what errors add to the mean of psi^2 */
    double *share_m2; /* [n] of each error in that; the sum is spread_m2 */
    double *cable_m2; /* [n_cable] of a cable's own errors */
    double kind_m2[HF_ERROR_N_KIND];
    double *psi_by_cut;  /* [n_cable] d psi / d l0 of the nominal net: what letting a cable out does; NaN where psi is
                           below 1e-3 of the root of spread_m2 */
    double *deviation_m; /* [n_inner_node] of each inner node, in the order of the model */
    void *block;
} hf_covariance;

/* The same bits for any number of threads. HF_OK or HF_NO_MEMORY; free in any case. */
hf_status hf_covariance_find(const hf_built_errors *errors, int n_thread, hf_covariance *covariance);
void hf_covariance_free(hf_covariance *covariance);

/* psi of the nominal net after these moves [n_dof], m. */
double hf_covariance_psi_m(const hf_built_linear *linear, const double *move_m);

#endif
