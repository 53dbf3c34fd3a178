/* tolerance - what errors of cut lengths, stiffness, supports and temperature do to a net as built: to first order, and
 * by many samples that are solved (METHOD section 12).
 * Stability: internal; may change in any version.
 *
 * A sample's errors depend on (seed, sample, error) alone, so samples may be found in any order, by any threads and
 * machines. */
#ifndef HIFDM_TOLERANCE_H
#define HIFDM_TOLERANCE_H

#include <hifdm/api.h>
#include <hifdm/surface.h>

HF_API_BEGIN

/* Columns of a row: hf_status, psi of the same errors to first order (m), then the measures; NaN for what is not
 * measured, and for all measures of a sample without a shape. */
enum { HF_TOLERANCE_STATUS, HF_TOLERANCE_LINEAR_PSI, HF_TOLERANCE_FIRST };
#define HF_TOLERANCE_COLUMNS (HF_TOLERANCE_FIRST + HF_TOLERANCE_N_MEASURE)
extern const char *const hf_tolerance_measure_unit[HF_TOLERANCE_N_MEASURE];
extern const char *const hf_tolerance_measure_help[HF_TOLERANCE_N_MEASURE];

/* Quantiles that are told: so many samples have no larger value, or no smaller one where more is better. */
#define HF_TOLERANCE_QUANTILES 3
extern const double hf_tolerance_quantile[HF_TOLERANCE_QUANTILES]; /* 0.5, 0.95, 0.99 */
bool hf_tolerance_more_is_better(hf_tolerance_measure measure);

/* Of one measure: mean, deviation, least and largest over the samples that have a value, quantiles over all samples, of
 * which those without a value are the worst (infinite). NaN is what is not known; there is no mean of infinite values.
 * Intervals hold the true value with 95 %: of quantiles by order statistics, which need no assumption (NaN: too few
 * samples), of the mean by its standard error. */
typedef struct {
    bool is_measured;
    double mean, mean_low, mean_high, deviation, least, largest;
    double value[HF_TOLERANCE_QUANTILES], low[HF_TOLERANCE_QUANTILES], high[HF_TOLERANCE_QUANTILES];
} hf_tolerance_figures;

#define HF_TOLERANCE_RANKED 20 /* cables that are named */
#define HF_TOLERANCE_BINS 40   /* of the histogram of psi */
#define HF_TOLERANCE_ID_SIZE 256
#define HF_TOLERANCE_KINDS 8 /* of errors */
extern const char *const hf_tolerance_kind_word[HF_TOLERANCE_KINDS];

/* X(type, member, kind, json, key, description), as the lists of summary.h. */
#define HF_TOLERANCE_LIST(X)                                                                                           \
    X(int, samples, INT, 1, "samples", "nets as built")                                                                \
    X(int, n_failed, INT, 1, "failed", "those of them without a shape")                                                \
    X(int, n_with_slack, INT, 1, "with_slack_cables", "those with slack cables")                                       \
    X(int, n_with_loose, INT, 1, "with_loose_nodes", "those with nodes that no taut cable holds")                      \
    X(double, nominal_psi_m, REAL, 2, "nominal_psi_m", "of the net without errors")                                    \
    X(double, first_order_rms_psi_m, REAL, 2, "first_order_rms_psi_m", "root of the mean of psi^2, to first order")    \
    X(double, psi_95_m, REAL, 2, "psi_95_m", "95 % of all nets do not exceed it; infinite: fewer have a shape")        \
    X(double, rms_psi_m, REAL, 2, "rms_psi_m", "root of the mean of psi^2 of the samples with a shape")                \
    X(double, rms_psi_low_m, REAL, 2, "rms_psi_low_m", "95 % interval of rms_psi_m: its lower end")                    \
    X(double, rms_psi_high_m, REAL, 2, "rms_psi_high_m", "95 % interval of rms_psi_m: its upper end")                  \
    X(double, controlled_rms_psi_m, REAL, 3, "controlled_rms_psi_m",                                                   \
      "rms_psi_m with first order as a control variate")                                                               \
    X(double, controlled_low_m, REAL, 3, "controlled_low_m", "95 % interval of controlled_rms_psi_m: its lower end")   \
    X(double, controlled_high_m, REAL, 3, "controlled_high_m", "95 % interval of controlled_rms_psi_m: its upper end") \
    X(double, correlation, REAL, 3, "correlation", "of psi^2 with psi^2 to first order; 1: first order holds")         \
    X(double, variance_saved, REAL, 3, "variance_saved", "part of the variance of the mean of psi^2 that it takes")    \
    X(double, yield, REAL, 4, "yield", "part of the samples that meets all rows of tolerance.require; NaN: no rows")   \
    X(double, yield_low, REAL, 4, "yield_low", "95 % interval of the yield (Clopper and Pearson): its lower end")      \
    X(double, yield_high, REAL, 4, "yield_high", "95 % interval of the yield: its upper end")                          \
    X(double, wanted_yield, REAL, 4, "wanted_yield", "tolerance.yield of the case; NaN: none")                         \
    X(double, sigma_scale, REAL, 4, "sigma_scale", "all errors times this give the wanted yield; NaN: not asked for")  \
    X(int, scale_bound, INT, 4, "scale_bound", "1: sigma_scale is at least that, -1: below that; 0: just that")        \
    X(int, scale_samples, INT, 4, "scale_samples", "of each yield on the way to it")                                   \
    X(double, tolerance_wall_s, REAL, 5, "wall_s", "wall-clock time")

#define HF_TOLERANCE_MEMBER(type, member, kind, json, key, description) type member;
typedef struct {
    HF_TOLERANCE_LIST(HF_TOLERANCE_MEMBER)
    hf_tolerance_figures figure[HF_TOLERANCE_N_MEASURE];
    int n_require;
    hf_require_settings require[HF_REQUIRE_ROWS_MAX];
    double require_yield[HF_REQUIRE_ROWS_MAX]; /* of each row alone */
    int n_ranked;                              /* cables by the share of their own errors in what psi^2 gains */
    char ranked_id[HF_TOLERANCE_RANKED][HF_TOLERANCE_ID_SIZE];
    double ranked_share[HF_TOLERANCE_RANKED];
    double kind_share[HF_TOLERANCE_KINDS]; /* of each kind of errors, see hf_tolerance_kind_word */
    double bin_low_m, bin_high_m;          /* range of the histogram: least and largest psi */
    double bin[HF_TOLERANCE_BINS];         /* part of the samples with a shape in each */
} hf_tolerance_summary;
#undef HF_TOLERANCE_MEMBER

HF_API_END
#endif
