/* prior - the covariance of the errors of cut lengths before any measurement, from the section `tolerance` (METHOD
 * section 12).
 *
 * Each cable has its own error. Cables share one number for each spool and one for the temperature. The covariance is
 * therefore a diagonal and a few columns. */
#pragma once

#include "built/errors.h"

/* Describes a number of mean 0 and standard deviation 1 that several cables share. */
typedef struct {
    hf_error_kind kind; /* HF_ERROR_RATIO_BATCH, HF_ERROR_EA_BATCH or HF_ERROR_TEMPERATURE */
    const char *set;    /* name of the spool, owned by the scene or static; NULL for temperature */
    double sigma;       /* relative, or in K for temperature */
} hf_prior_number;

typedef struct {
    double *own_m;           /* [n_cable] standard deviation of a cable's own error */
    double *sigma_m;         /* [n_cable] standard deviation of its whole error */
    int n_shared;            /* shared numbers */
    hf_prior_number *number; /* [n_shared] their descriptions */
    double *shared_m;        /* [n_shared][n_cable] error of each length by each number */
    void *block;
} hf_prior;

/* Makes the prior. An error of EA counts as the error of the length that strains the cable by the same tension. The
 * number of a spool with one cable is part of that cable's own error. expansion_per_K [n_cable] is needed with
 * sigma_temperature_K. Returns HF_OK or HF_NO_MEMORY; the caller frees its block in any case. */
hf_status hf_prior_make(const hf_built *built, const hf_tolerance_settings *settings, const double *expansion_per_K,
                        hf_prior *prior);
