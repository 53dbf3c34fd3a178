/* config_check - what joins several keys of a case: faults of keys that do not go together, and what one key gives to
 * another. */
#ifndef HIFDM_CONFIG_CHECK_H
#define HIFDM_CONFIG_CHECK_H

#include "case/config_fault.h"

/* Report the keys that are missing and those that do not go together. */
void hf_config_check(const hf_case *settings, hf_config_faults *faults);

/* The part of it about the net as built: `cables`, `nodes` and `cases`. */
void hf_config_check_built(const hf_case *settings, hf_config_faults *faults);

/* The part of it about what rows of a list of goals are over. */
void hf_config_check_nets(const hf_case *settings, const char *list, int n_goal, const hf_goal_settings *goal,
                          hf_config_faults *faults);

/* Report the name of a set in a row that no set can have. */
void hf_config_check_set(hf_config_faults *faults, const char *list, int row, const char *set);

/* Set what follows from the sections that are there: whether there is a truss; of the surface, what the generator of
 * the net knows and the case does not give. */
void hf_config_complete(hf_case *settings);

/* What a generated net knows of its surface, 0 where it does not; *key: its key of the focal length, if there is such a
 * net. */
hf_surface_settings hf_config_known_surface(const hf_case *settings, const char **key);

#endif
