/* tolerance - the effect of errors of cut lengths, stiffness, supports and temperature on an as-built net (METHOD
 * section 12).
 * Stability: internal; may change in any version.
 *
 * Errors are taken to first order, and as samples that are solved. Pipeline:
 *
 *   errors of the case (hf_tolerance_settings) -> samples -> a row of measures for each -> hf_tolerance_summary
 *
 * The errors of a sample depend on (seed, sample, error) alone. Samples may therefore be computed in any order, by any
 * threads and machines. */
#ifndef HIFDM_TOLERANCE_H
#define HIFDM_TOLERANCE_H

#include <hifdm/api.h>
#include <hifdm/surface.h>

HF_API_BEGIN

/* Columns of the row of a sample: hf_status, psi of the same errors to first order in m, then the measures. What is not
 * measured is NaN, as are all measures of a sample without a shape. */
enum { HF_TOLERANCE_STATUS, HF_TOLERANCE_LINEAR_PSI, HF_TOLERANCE_FIRST };
#define HF_TOLERANCE_COLUMNS (HF_TOLERANCE_FIRST + HF_TOLERANCE_N_MEASURE)  /* number of columns */
extern const char *const hf_tolerance_measure_unit[HF_TOLERANCE_N_MEASURE]; /* units of the measures */
extern const char *const hf_tolerance_measure_help[HF_TOLERANCE_N_MEASURE]; /* descriptions of the measures */

/* Number of reported quantiles. A quantile is a value that a part of the samples does not exceed, or does not fall
 * below if more is better. */
#define HF_TOLERANCE_QUANTILES 3
extern const double hf_tolerance_quantile[HF_TOLERANCE_QUANTILES]; /* parts of the samples: 0.5, 0.95, 0.99 */
/* Returns true if a larger value of the measure is better, such as the minimum tension. */
bool hf_tolerance_more_is_better(hf_tolerance_measure measure);

/* Statistics of one measure. Mean, deviation, minimum and maximum are over the samples that have a value. Quantiles are
 * over all samples; those without a value count as the worst, infinite. NaN: unknown; there is no mean of infinite
 * values.
 *
 * Intervals contain the true value with a probability of 95 %. Those of quantiles are order statistics, which need no
 * assumption (NaN: too few samples). That of the mean follows from its standard error. */
typedef struct {
    bool is_measured; /* false: the other members have no meaning */
    /* mean with its interval, standard deviation, minimum, maximum */
    double mean, mean_low, mean_high, deviation, min, max;
    /* quantiles with their intervals */
    double value[HF_TOLERANCE_QUANTILES], low[HF_TOLERANCE_QUANTILES], high[HF_TOLERANCE_QUANTILES];
} hf_tolerance_figures;

#define HF_TOLERANCE_RANKED 20                                       /* maximum number of cables that are listed */
#define HF_TOLERANCE_BINS 40                                         /* number of bins of the histogram of psi */
#define HF_TOLERANCE_ID_SIZE 256                                     /* bytes of the id of a cable */
#define HF_TOLERANCE_KINDS 8                                         /* number of kinds of errors */
extern const char *const hf_tolerance_kind_word[HF_TOLERANCE_KINDS]; /* words of the kinds of errors */

/* The figures of the samples: rows as in the lists of summary.h. */
#define HF_TOLERANCE_LIST(X)                                                                                           \
    X(int, samples, INT, .json = 1, .description = "as-built samples")                                                 \
    X(int, n_failed, INT, .json = 1, .key = "failed", .description = "those of them without a shape")                  \
    X(int, n_with_slack, INT, .json = 1, .key = "with_slack_cables", .description = "those with slack cables")         \
    X(int, n_with_loose, INT, .json = 1, .key = "with_loose_nodes",                                                    \
      .description = "those with nodes that no taut cable holds")                                                      \
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
      .description = "part of the samples that meets all rows of tolerance.require; NaN: no rows")                     \
    X(double, yield_low, REAL, .json = 4,                                                                              \
      .description = "95 % interval of the yield (Clopper and Pearson): its lower end")                                \
    X(double, yield_high, REAL, .json = 4, .description = "95 % interval of the yield: its upper end")                 \
    X(double, required_yield, REAL, .json = 4, .description = "tolerance.required_yield of the case; NaN: none")       \
    X(double, sigma_scale, REAL, .json = 4,                                                                            \
      .description = "all errors times this give the required yield; NaN: not asked for")                              \
    X(int, scale_bound, INT, .json = 4,                                                                                \
      .description = "1: sigma_scale is at least that, -1: below that; 0: just that")                                  \
    X(int, scale_samples, INT, .json = 4, .description = "of each yield on the way to it")                             \
    X(double, tolerance_wall_s, REAL, .json = 5, .key = "wall_s", .description = "wall-clock time")

#define HF_TOLERANCE_MEMBER(type, member, ...) type member;
/* The result of the tolerance analysis. */
typedef struct {
    HF_TOLERANCE_LIST(HF_TOLERANCE_MEMBER)
    hf_tolerance_figures figure[HF_TOLERANCE_N_MEASURE]; /* statistics by hf_tolerance_measure */
    int n_require;                                       /* number of rows of tolerance.require */
    hf_require_settings require[HF_REQUIRE_ROWS_MAX];    /* [n_require] the rows */
    double require_yield[HF_REQUIRE_ROWS_MAX];           /* [n_require] yield under each row alone */
    int n_ranked; /* number of cables listed by the share of their own errors in the growth of psi^2 */
    char ranked_id[HF_TOLERANCE_RANKED][HF_TOLERANCE_ID_SIZE]; /* [n_ranked] ids of these cables */
    double ranked_share[HF_TOLERANCE_RANKED];                  /* [n_ranked] shares of these cables */
    double kind_share[HF_TOLERANCE_KINDS];                     /* share of each kind of errors in the growth of psi^2 */
    double bin_low_m, bin_high_m;                              /* range of the histogram: minimum and maximum psi */
    double bin[HF_TOLERANCE_BINS];                             /* part of the samples with a shape in each bin */
} hf_tolerance_summary;
#undef HF_TOLERANCE_MEMBER

HF_API_END
#endif
