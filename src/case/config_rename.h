/* config_rename - the names of keys and words before version 0.3. */
#pragma once

#include "case/config_fault.h"

/* Writes the new name of a key, "optimize.goals.0.goal", or of a key with its word, "adjust.aim=theory", into `now`.
 * If `old` is an old name, warns once with the line and the column, counted from 0, and returns true. A key with its
 * word is old only if the word is old, so that both together cause one warning. */
bool hf_config_rename(hf_config_faults *faults, size_t line, size_t column, const char *old, char now[HF_KEY_SIZE]);

/* The measures of tolerance.require as X(word, figure, feed, is_ruze). A loss by Ruze's formula becomes a
 * bound on the RMS error from which it follows. */
#define HF_OLD_MEASURES(X)                                                                                             \
    X("psi_m", PSI, REFOCUSED, false)                                                                                  \
    X("half_path_rms_m", SURFACE, FIXED, false)                                                                        \
    X("fit_half_path_rms_m", SURFACE, REFOCUSED, false)                                                                \
    X("facet_half_path_rms_m", FACETS, FIXED, false)                                                                   \
    X("facet_fit_half_path_rms_m", FACETS, REFOCUSED, false)                                                           \
    X("gain_loss_dB", SURFACE, FIXED, true)                                                                            \
    X("fit_gain_loss_dB", SURFACE, REFOCUSED, true)                                                                    \
    X("facet_gain_loss_dB", FACETS, FIXED, true)                                                                       \
    X("facet_fit_gain_loss_dB", FACETS, REFOCUSED, true)                                                               \
    X("pattern_loss_dB", GAIN_LOSS, FIXED, false)                                                                      \
    X("tension_min_N", TENSION, REFOCUSED, false)                                                                      \
    X("least_tension_N", TENSION, REFOCUSED, false)                                                                    \
    X("n_slack", SLACK, REFOCUSED, false)                                                                              \
    X("n_loose", LOOSE, REFOCUSED, false)

/* Converts the rows of tolerance.require, with tolerance.required_yield, to rows of `requirements`, and warns once with
 * these rows. A case without required_yield gets a share of 0.95, the share for which the summary states figures. The
 * rows have the locations of the old ones, and do not constrain the search. Does nothing if the case has faults. */
void hf_config_rename_require(hf_case *settings, hf_config_faults *faults);

/* Writes the name that a key, or a key with its word, had in version 0.2. */
void hf_config_old_name(const char *now, char old[HF_KEY_SIZE]);
