/* cable_set - named sets of cables, such as front or edge_tie, which group cables in addition to hf_group.
 * Stability: stable.
 *
 * A cable may belong to any number of sets. Generators create one set for each family of cables. If a net is imported,
 * the column `set` of its cable table assigns the cables to sets. The groups inner and boundary are not sets because
 * the array hf_scene.group already defines these groups. A set must not have the name `all` or the name of a group. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

/* Defines the size in bytes of a set name, including the terminating NUL. */
#define HF_CABLE_SET_NAME_SIZE HF_SET_NAME_SIZE

/* States that one cable belongs to one set. */
typedef struct {
    int set, cable; /* indices of the set and of the cable */
} hf_cable_set_member;

/* Checks the name of a set. A valid name consists of 1 to 63 letters, digits, underscores and hyphens. The first
 * character of a name must not be a hyphen. A set must not have the name of a group or the name `all`. Returns NULL if
 * the name is valid. If the name is invalid, the function returns a constant string that describes the fault as the end
 * of a sentence. */
const char *hf_cable_set_name_fault(const char *name);

/* Allocates n_set sets with n_member cables in total for a scene that has no sets. The argument n_set must be at least
 * 1. The function sets all indices to zero and all names to empty strings. Each name has space for
 * HF_CABLE_SET_NAME_SIZE bytes. The function hf_scene_free frees the memory. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_cable_set_allocate(hf_scene *scene, int n_set, int n_member);

/* Defines the sets of a scene that has no sets. The array name [n_set] must be sorted by strcmp and must not contain
 * duplicates. The array member [n_member] must not contain duplicates. The cables of each set must be in ascending
 * order. The function omits sets without a cable. The function copies the names. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_cable_set_make(hf_scene *scene, int n_set, const char *const *name, int n_member,
                            const hf_cable_set_member *member);

/* Returns the index of the set with this name, or -1 if no set has this name. */
int hf_cable_set_find(const hf_scene *scene, const char *name);

/* Returns true if set i_set contains cable i_cable. The search time is proportional to the logarithm of the number of
 * cables in the set. */
bool hf_cable_set_has(const hf_scene *scene, int i_set, int i_cable);

HF_API_END
