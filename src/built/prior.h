/* prior - what the section tolerance says of the errors of cut lengths before anything is measured (METHOD section 12):
 * each cable's own, and those that cables share: one number for each spool, one for the temperature. Their covariance
 * is a diagonal and a few columns. */
#ifndef HIFDM_PRIOR_H
#define HIFDM_PRIOR_H

#include "built/errors.h"

/* A number of mean 0 and deviation 1 that several cables share. */
typedef struct {
    hf_error_kind kind; /* HF_ERROR_RATIO_BATCH, HF_ERROR_EA_BATCH or HF_ERROR_TEMPERATURE */
    const char *set;    /* name of the spool, of the scene; NULL of temperature */
    double sigma;       /* ratio, or K */
} hf_prior_number;

typedef struct {
    double *own_m;           /* [n_cable] deviation of a cable's own error */
    double *sigma_m;         /* [n_cable] of its whole error */
    int n_shared;            /* numbers */
    hf_prior_number *number; /* [n_shared] */
    double *shared_m;        /* [n_shared][n_cable] what each number adds to the lengths */
    void *block;
} hf_prior;

/* An error of EA acts as one of the length by which the cable is strained. A spool of one cable is part of that cable's
 * own error. expansion_per_K [n_cable] is needed with sigma_temperature_K. HF_OK or HF_NO_MEMORY; free in any case. */
hf_status hf_prior_make(const hf_built *built, const hf_tolerance_settings *settings, const double *expansion_per_K,
                        hf_prior *prior);
void hf_prior_free(hf_prior *prior);

#endif
