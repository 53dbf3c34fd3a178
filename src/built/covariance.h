/* covariance - the first-order effect of errors on the shape of an as-built net (METHOD section 12).
 *
 * It gives the exact mean of psi^2 to first order, and the share of each error in it. It takes one solve for each
 * coordinate of an inner node, whatever the number of errors. */
#pragma once

#include "built/errors.h"

typedef struct {
    double nominal_psi_m;
    double spread_m2; /* increase of the mean of psi^2 by errors */
    double *share_m2; /* [n] share of each error in spread_m2; their sum is spread_m2 */
    double *cable_m2; /* [n_cable] share of the own errors of each cable */
    /* Share of each kind of error. */
    double kind_m2[HF_ERROR_N_KIND];
    /* [n_cable] derivative of psi of the nominal net with respect to each unstressed length. It is NaN where psi is not
     * above 1e-3 of the root of spread_m2. */
    double *psi_by_cut;
    double *deviation_m; /* [n_inner_node] standard deviation of the position, in the order of the model */
    void *block;
} hf_covariance;

/* Computes all members. The result has the same bits for any number of threads. Returns HF_OK, HF_NO_MEMORY or
 * HF_INTERRUPTED; the caller frees its block in any case. */
hf_status hf_covariance_find(const hf_built_errors *errors, int n_thread, hf_covariance *covariance);

/* Returns psi, m, of the nominal net after the displacements move_m [n_dof]; NULL: without displacements. */
double hf_covariance_psi_m(const hf_built_linear *linear, const double *move_m);
