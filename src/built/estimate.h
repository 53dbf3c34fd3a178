/* estimate - the most probable errors of an as-built net, given measured positions of its nodes (METHOD section 12).
 *
 * It minimises (M40) by the Gauss-Newton method. Each step solves one saddle-point system (built/saddle.h), and each
 * trial solves the whole shape. */
#pragma once

#include "built/near.h"
#include "built/saddle.h"

/* Scratch of an estimate. A step uses errors, supports, displacements, shared numbers, the differences to measured
 * positions before and after it, and the band. A shape uses cut lengths and supports; the linear model uses the last
 * two. Arrays that samples use have room for HF_SADDLE_PANEL of them. */
typedef struct {
    double *cut_m, *rest_m, *shared, *gap_m, *trial_m, *move_m, *band, *length_m, *support_m, *strain_N, *linear;
} hf_estimate_scratch;

typedef struct {
    const hf_built *built;
    hf_saddle_prior prior;
    const double *position_m; /* [n_dof] measured positions */
    hf_built_linear linear;
    hf_near near;
    bool has_near; /* false on a truss, or when the nominal net has no matrix for it */
    hf_built last; /* `built` at the shape solved last, where the next solve starts */
    hf_saddle saddle;
    hf_workspace work;   /* holds the estimated shape */
    hf_form_result form; /* result of that shape */
    double *cut_m;       /* [n_cable] estimated errors of cut lengths */
    double *shared;      /* [n_shared] estimated numbers that cables share; cut_m includes them */
    double *rest_m;      /* [n_dof] estimated displacements of supports, and of attachments where they rest */
    /* Half of chi^2: half the sum of squares of errors and of differences to measured positions, each divided by its
     * sigma. */
    double misfit;
    int n_step;
    bool is_settled; /* converged: the linear model predicts no further reduction of the misfit */
    hf_estimate_scratch scratch;
    void *block;
} hf_estimate;

/* Makes an estimate that starts at the nominal net. `built`, position_m and the arrays of `prior` are borrowed.
 * position_m [n_dof] are the measured positions. Returns HF_OK; HF_NO_MEMORY; or HF_SINGULAR when the nominal net has
 * no stiffness. Call hf_estimate_free in any case. */
hf_status hf_estimate_create(const hf_built *built, const hf_saddle_prior *prior, const double *position_m,
                             hf_estimate *estimate);
void hf_estimate_free(hf_estimate *estimate);

/* Finds the most probable errors. Returns HF_OK, also when it stops without convergence because no step reduces the
 * misfit; is_settled distinguishes the two cases. Otherwise returns HF_NO_MEMORY, HF_INTERRUPTED, or the status of the
 * nominal net when that has no shape. */
hf_status hf_estimate_find(hf_estimate *estimate);

/* Solves the net with the estimated errors, its cut lengths increased by adjustment_m [n_cable], m (NULL: not
 * increased). Returns result->status. */
hf_status hf_estimate_shape(const hf_estimate *estimate, const double *adjustment_m, hf_workspace *work,
                            hf_form_result *result);

/* Computes the RMS displacement of each node of the nominal net, expected_m [n_node] by row, under errors of the size
 * of the prior. It is the RMS over HF_ESTIMATE_SAMPLES sets of random signs. Call it before hf_estimate_find. Returns
 * HF_OK. */
#define HF_ESTIMATE_SAMPLES 64
hf_status hf_estimate_expect(hf_estimate *estimate, double *expected_m);

/* Computes how much the prior reduces the estimates of single cables, to first order. part[k], 0 to 1, is the part of
 * an error of cable[k] alone that the estimate attributes to this cable. Without a prior for this one cable, its own
 * error would be estimated as the present value divided by this part. Returns HF_OK or HF_SINGULAR. */
hf_status hf_estimate_belief(hf_estimate *estimate, int n, const int *cable, double *part);

/* Returns the part of the estimated error of a cable that is its own and not shared, m. */
double hf_estimate_own_m(const hf_estimate *estimate, int cable);

/* Computes HF_ESTIMATE_SAMPLES samples of the posterior, to first order. They have the covariance of the errors that
 * prior and measurement leave undetermined. Each sample draws errors and measurement errors with random signs and
 * subtracts their estimate.
 *
 * move_m [samples][n_dof] are displacements of the estimated shape. sigma_N [n_cable] is the standard deviation of each
 * tension. cause receives the errors of the samples; it may be NULL. They are needed after an adjustment: errors of
 * tensions that do not displace the measured net displace the adjusted one. Returns HF_OK or HF_SINGULAR. */
typedef struct {
    double *cut_m, *rest_m; /* [samples][n_cable], m; [samples][n_dof] displacements of supports, m */
} hf_estimate_cause;
hf_status hf_estimate_doubt(hf_estimate *estimate, double *move_m, double *sigma_N, const hf_estimate_cause *cause);

/* Computes RMS and standard deviation of a quantity that has one value for each sample. */
void hf_estimate_spread(const double value[HF_ESTIMATE_SAMPLES], double *rms, double *deviation);
