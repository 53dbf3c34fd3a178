/* config_check - checks of keys that must fit together, and values that one key determines for another. */
#pragma once

#include "case/config_fault.h"

/* Reports missing keys and keys that do not fit together. */
void hf_config_check(const hf_case *settings, hf_config_faults *faults);

/* Reports faults in the keys of the as-built net: `adjust`, `cables`, `load_cases` and `tolerance`. */
void hf_config_check_built(const hf_case *settings, hf_config_faults *faults);

/* Reports faults in the rows of `requirements`. */
void hf_config_check_requirements(const hf_case *settings, hf_config_faults *faults);

enum { HF_CONFIG_WHAT_SIZE = 512 };

/* Returns the fault of a frequency that is probably in GHz, for the end of a message, or NULL. */
const char *hf_config_frequency_fault(double frequency_Hz, char what[HF_CONFIG_WHAT_SIZE]);

/* Returns the highest of surface.frequencies_Hz, NaN without one. */
double hf_config_highest_Hz(const hf_case *settings);

/* Reports a key in a row of a kind that does not use it. `users` has one bit for each kind that uses it. */
void hf_config_check_use(hf_config_faults *faults, const char *list, int row, const char *key, int kind,
                         const char *const *kind_word, unsigned users);

/* Reports faults in the keys `state`, `over`, `take` and `quantile` of the n_objective rows of a list of objectives. */
void hf_config_check_nets(const hf_case *settings, const char *list, int n_objective,
                          const hf_objective_settings *objective, hf_config_faults *faults);

/* Reports a set name in a row that no set can have. */
void hf_config_check_set(hf_config_faults *faults, const char *list, int row, const char *set);

/* Sets the bounds, feeds and frequencies of rows of `requirements` that follow from other keys. */
void hf_config_complete_requirements(hf_case *settings);

/* Sets members that follow from the existing sections: whether there is a truss, and values of the surface that the
 * case does not give and the generator of the net determines. */
void hf_config_complete(hf_case *settings);

/* Returns the surface that a generated net determines; unknown members are 0. *key is its key of the focal length; it
 * is unchanged without a generated net. */
hf_surface_settings hf_config_known_surface(const hf_case *settings, const char **key);
