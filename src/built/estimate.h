/* estimate - the most probable errors of the net as built, given where its nodes were measured: by Gauss and Newton,
 * each step one saddle system, each trial the whole shape (METHOD section 12). */
#ifndef HIFDM_ESTIMATE_H
#define HIFDM_ESTIMATE_H

#include "built/near.h"
#include "built/saddle.h"

typedef struct {
    const hf_built *built;
    hf_saddle_prior prior;
    const double *place_m; /* [n_dof] measured */
    hf_built_linear linear;
    hf_near near;
    bool has_near; /* false: on a truss, or the nominal net has no matrix for it */
    hf_built last; /* `built` at the last shape that was found, where the next one starts */
    hf_saddle saddle;
    hf_workspace work;   /* holds the estimated shape */
    hf_form_result form; /* of that shape */
    double *cut_m;       /* [n_cable] estimated errors of cut lengths */
    double *shared;      /* [n_shared] estimated numbers that cables share, which are in cut_m, too */
    double *rest_m;      /* [n_dof] how far supports are off; of attachments, where they rest */
    double misfit;       /* half the sum of squares of errors and differences, each over its sigma */
    int n_step;
    bool is_settled; /* a further step promises nothing */
    double *scratch;
    void *block;
} hf_estimate;

/* Everything is borrowed. Starts at the nominal net. HF_OK, HF_NO_MEMORY, or HF_SINGULAR when the design has no
 * stiffness. Free it in any case. */
hf_status hf_estimate_create(const hf_built *built, const hf_saddle_prior *prior, const double *place_m,
                             hf_estimate *estimate);
void hf_estimate_free(hf_estimate *estimate);

/* Move to the most probable errors. HF_OK, also when no step gains any more before it is settled; else what the nominal
 * net has instead of a shape. */
hf_status hf_estimate_find(hf_estimate *estimate);

/* The shape of the net with these errors, and cut lengths changed by turn_m [n_cable] (NULL: not). */
hf_status hf_estimate_shape(const hf_estimate *estimate, const double *turn_m, hf_workspace *work,
                            hf_form_result *result);

/* RMS of how far errors as large as the prior says move each node of the nominal net, [n_node] by row: a mean over
 * n_sample signs. Call it before hf_estimate_find. HF_OK or HF_NO_MEMORY. */
#define HF_ESTIMATE_SAMPLES 64
hf_status hf_estimate_expect(hf_estimate *estimate, double *expected_m);

/* How far the prior holds back what places say of single cables: of an error of each cable of the list, all by itself,
 * the part that the estimate takes to be that cable's own, 0 to 1 (to first order). The estimate with a boundless sigma
 * of one cable, all else as it is, has its own error over this part. part [n]. HF_OK, HF_SINGULAR, HF_NO_MEMORY. */
hf_status hf_estimate_belief(hf_estimate *estimate, int n, const int *cable, double *part);

/* What of the estimated error of a cable is its own, and not that of what it shares. */
double hf_estimate_own_m(const hf_estimate *estimate, int cable);

/* What is left unknown: HF_ESTIMATE_SAMPLES moves [n_dof] of the estimated shape, with the covariance of what errors
 * and measurement leave open (to first order). Each is the answer to errors and measurements of random signs, less what
 * the estimate would make of them. sigma_N [n_cable]: RMS of what they do to tensions. cause (NULL: not wanted): the
 * errors behind them: where tensions are open the places are known, and after turns no more. HF_OK, HF_SINGULAR,
 * HF_NO_MEMORY. */
typedef struct {
    double *cut_m, *rest_m; /* [samples][n_cable]; [samples][n_dof] of supports */
} hf_estimate_cause;
hf_status hf_estimate_doubt(hf_estimate *estimate, double *move_m, double *sigma_N, const hf_estimate_cause *cause);

/* RMS and standard deviation of what has a value for each sample. */
void hf_estimate_spread(const double value[HF_ESTIMATE_SAMPLES], double *rms, double *deviation);

#endif
