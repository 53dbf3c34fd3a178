/* tolerance - the effect of errors of cut lengths, stiffness, supports and temperature on an as-built net.
 * Stability: internal. This header may change in any version.
 *
 * hifdm computes the effect of the errors to first order and from solved samples (METHOD section 12). Pipeline:
 *
 *   errors of the case (hf_tolerance_settings) -> samples -> a row of measures for each -> hf_tolerance_summary
 *
 * The errors of a sample depend only on (seed, sample, error). Samples may therefore be computed in any order, by any
 * thread and on any machine. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/surface.h>

HF_API_BEGIN

/* The row of a sample contains its hf_status, psi in m to first order for the same errors, and the measures. A value
 * that is not measured is NaN. If a sample has no shape, all its measures are NaN. */
enum { HF_TOLERANCE_STATUS, HF_TOLERANCE_LINEAR_PSI, HF_TOLERANCE_FIRST };
#define HF_TOLERANCE_COLUMNS (HF_TOLERANCE_FIRST + HF_TOLERANCE_N_MEASURE)  /* number of columns */
extern const char *const hf_tolerance_measure_unit[HF_TOLERANCE_N_MEASURE]; /* units of the measures */
extern const char *const hf_tolerance_measure_help[HF_TOLERANCE_N_MEASURE]; /* descriptions of the measures */

/* Number of reported quantiles. A quantile is a value that a given share of the samples does not exceed. If a larger
 * value is better, the quantile is a value that the given share of the samples does not fall below. */
#define HF_TOLERANCE_QUANTILES 3
extern const double hf_tolerance_quantile[HF_TOLERANCE_QUANTILES]; /* shares of the samples: 0.5, 0.95, 0.99 */
/* Returns true if a larger value of the measure is better, as for the minimum tension. */
bool hf_tolerance_more_is_better(hf_tolerance_measure measure);

/* Contains the statistics of one measure over the samples. Mean, standard deviation, minimum and maximum include only
 * the samples that have a value. Quantiles include all samples. For quantiles, a sample without a value is the worst
 * sample and has an infinite value. NaN means that a value is unknown. Infinite values have no mean value.
 *
 * Each confidence interval contains the true value with a probability of 95 %. The confidence intervals of quantiles
 * are order statistics. Order statistics require no assumption about the distribution. If there are too few samples,
 * the confidence intervals of quantiles are NaN. The confidence interval of the mean follows from the standard error of
 * the mean. */
typedef struct {
    bool is_measured; /* false: the other members have no meaning */
    /* mean and its interval, standard deviation, minimum, maximum */
    double mean, mean_low, mean_high, deviation, min, max;
    /* quantiles and their intervals */
    double value[HF_TOLERANCE_QUANTILES], low[HF_TOLERANCE_QUANTILES], high[HF_TOLERANCE_QUANTILES];
} hf_tolerance_figures;

#define HF_TOLERANCE_RANKED 20                                       /* maximum number of cables in the list */
#define HF_TOLERANCE_BINS 40                                         /* number of bins of the histogram of psi */
#define HF_TOLERANCE_ID_SIZE 256                                     /* size in bytes of the id of a cable */
#define HF_TOLERANCE_KINDS 8                                         /* number of kinds of errors */
extern const char *const hf_tolerance_kind_word[HF_TOLERANCE_KINDS]; /* words of the kinds of errors */

/* The figures of the samples. The rows have the form of the lists in summary.h. */
#define HF_TOLERANCE_LIST(X)                                                                                           \
    X(int, samples, INT, .json = 1, .description = "as-built samples")                                                 \
    X(int, n_failed, INT, .json = 1, .key = "failed", .description = "those of them without a shape")                  \
    X(int, n_with_slack, INT, .json = 1, .key = "with_slack_cables", .description = "those with slack cables")         \
    X(int, n_with_loose, INT, .json = 1, .key = "with_loose_nodes",                                                    \
      .description = "those with nodes that no taut cable holds")                                                      \
    X(int, n_sampled_load_case, INT, .json = 1, .key = "sampled_load_cases",                                           \
      .description = "load cases in which requirements need the samples, without the nominal one")                     \
    X(int, n_with_slack_in_any, INT, .json = 1, .key = "with_slack_cables_in_any_load_case",                           \
      .description = "samples with slack cables in the nominal load case or in one of these")                          \
    X(int, n_failed_in_any, INT, .json = 1, .key = "failed_in_any_load_case",                                          \
      .description = "samples without a shape in the nominal load case or in one of these")                            \
    X(double, nominal_psi_m, REAL, .json = 2, .description = "of the net without errors")                              \
    X(double, first_order_rms_psi_m, REAL, .json = 2, .description = "root of the mean of psi^2, to first order")      \
    X(double, psi_95_m, REAL, .json = 2,                                                                               \
      .description = "95 % of all nets do not exceed it; infinite: fewer have a shape")                                \
    X(double, rms_psi_m, REAL, .json = 2, .description = "root of the mean of psi^2 of the samples with a shape")      \
    X(double, rms_psi_low_m, REAL, .json = 2, .description = "95 % interval of rms_psi_m: its lower end")              \
    X(double, rms_psi_high_m, REAL, .json = 2, .description = "95 % interval of rms_psi_m: its upper end")             \
    X(double, controlled_rms_psi_m, REAL, .json = 3, .description = "rms_psi_m with first order as a control variate") \
    X(double, controlled_low_m, REAL, .json = 3,                                                                       \
      .description = "95 % interval of controlled_rms_psi_m: its lower end")                                           \
    X(double, controlled_high_m, REAL, .json = 3,                                                                      \
      .description = "95 % interval of controlled_rms_psi_m: its upper end")                                           \
    X(double, correlation, REAL, .json = 3, .description = "of psi^2 with psi^2 to first order; 1: first order holds") \
    X(double, variance_saved, REAL, .json = 3,                                                                         \
      .description = "part of the variance of the mean of psi^2 that it takes")                                        \
    X(double, yield, REAL, .json = 4,                                                                                  \
      .description = "part of the samples that meets all rows of requirements with a share; NaN: no rows")             \
    X(double, yield_low, REAL, .json = 4,                                                                              \
      .description = "95 % interval of the yield (Clopper and Pearson): its lower end")                                \
    X(double, yield_high, REAL, .json = 4, .description = "95 % interval of the yield: its upper end")                 \
    X(double, sigma_scale, REAL, .json = 4,                                                                            \
      .description = "all errors times this give the required shares; NaN: not asked for")                             \
    X(int, scale_bound, INT, .json = 4,                                                                                \
      .description = "1: sigma_scale is at least that, -1: below that; 0: just that")                                  \
    X(int, scale_samples, INT, .json = 4, .description = "of each yield on the way to it")                             \
    X(double, tolerance_wall_s, REAL, .json = 5, .key = "wall_s", .description = "wall-clock time")

#define HF_TOLERANCE_MEMBER(type, member, ...) type member;
/* Contains the result of the tolerance analysis. */
typedef struct {
    HF_TOLERANCE_LIST(HF_TOLERANCE_MEMBER)
    hf_tolerance_figures figure[HF_TOLERANCE_N_MEASURE]; /* statistics by hf_tolerance_measure */
    int n_ranked; /* number of listed cables, ordered by the share of their own errors in the increase of psi^2 */
    char ranked_id[HF_TOLERANCE_RANKED][HF_TOLERANCE_ID_SIZE]; /* [n_ranked] ids of these cables */
    double ranked_share[HF_TOLERANCE_RANKED];                  /* [n_ranked] shares of these cables */
    double kind_share[HF_TOLERANCE_KINDS]; /* share of each kind of errors in the increase of psi^2 */
    double bin_low_m, bin_high_m;          /* range of the histogram, from minimum to maximum psi */
    double bin[HF_TOLERANCE_BINS];         /* share of the samples with a shape in each bin */
} hf_tolerance_summary;
#undef HF_TOLERANCE_MEMBER

HF_API_END
