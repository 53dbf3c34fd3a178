/* cable_set - named sets of cables, such as front or edge_tie, which group cables in addition to hf_group.
 * Stability: stable.
 *
 * A cable may belong to any number of sets. Generators create one set for each family of cables. The table of cables of
 * an import has the column `set`. The groups inner and boundary are not sets, because hf_scene.group contains them. The
 * names of the groups and the name `all` are not allowed as names of sets. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

/* Size in bytes of the name of a set, including its NUL. */
#define HF_CABLE_SET_NAME_SIZE HF_SET_NAME_SIZE

/* The membership of one cable in one set. */
typedef struct {
    int set, cable; /* indices of the set and of the cable */
} hf_cable_set_member;

/* Checks the name of a set. A valid name has 1 to 63 letters, digits, _ and -, and does not begin with -. A name of a
 * set must not be the name of a group or `all`. Returns NULL if the name is valid. If the name is invalid, returns the
 * fault as the end of a sentence in a constant string. */
const char *hf_cable_set_name_fault(const char *name);

/* Allocates n_set >= 1 sets with n_member cables in total, in a scene without sets. All values are zero and the names
 * are empty. Each name has space for HF_CABLE_SET_NAME_SIZE bytes. hf_scene_free frees the memory. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_cable_set_allocate(hf_scene *scene, int n_set, int n_member);

/* Defines the sets of a scene that has no sets. The names name [n_set] must be sorted by strcmp and have no duplicates.
 * The array member [n_member] must have no duplicates, and the cables of each set must be in ascending order. The
 * function omits sets without a cable. The function copies the names. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_cable_set_make(hf_scene *scene, int n_set, const char *const *name, int n_member,
                            const hf_cable_set_member *member);

/* Returns the index of the set with this name, or -1 if there is none. */
int hf_cable_set_find(const hf_scene *scene, const char *name);

/* Returns true if set i_set contains cable i_cable. The time of a call is proportional to the logarithm of the size of
 * the set. */
bool hf_cable_set_has(const hf_scene *scene, int i_set, int i_cable);

HF_API_END
