/* cable_set - named sets of cables, such as front or edge_tie: what cables have in common besides their group.
 * Stability: stable.
 *
 * A cable belongs to any number of sets. Generators name the families of their cables; an import has the column `set`.
 * The groups inner and boundary are no sets, because hf_scene.group has them. No set may have their names, nor the name
 * `all`. */
#ifndef HIFDM_CABLE_SET_H
#define HIFDM_CABLE_SET_H

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

/* Size of the name of a set with its NUL, bytes. */
#define HF_CABLE_SET_NAME_SIZE HF_SET_NAME_SIZE

/* One cable of one set, by index. */
typedef struct {
    int set, cable; /* indices of the set and of the cable */
} hf_cable_set_member;

/* Checks the name of a set: 1 to 63 letters, digits, _ and -, not beginning with -, neither the name of a group nor
 * `all`. Returns NULL if the name is valid, otherwise the fault as the end of a sentence, a constant string. */
const char *hf_cable_set_name_fault(const char *name);

/* Allocates n_set >= 1 sets with n_member cables in all, in a scene without sets. Everything is zero, and the names are
 * empty with room for HF_CABLE_SET_NAME_SIZE bytes. hf_scene_free frees the memory. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_cable_set_allocate(hf_scene *scene, int n_set, int n_member);

/* Defines the sets of a scene that has none. name [n_set] is sorted by strcmp without duplicates. member [n_member] has
 * no duplicates, and the cables of a set are in ascending order. Sets without a cable are left out. The names are
 * copied. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_cable_set_make(hf_scene *scene, int n_set, const char *const *name, int n_member,
                            const hf_cable_set_member *member);

/* Returns the index of the set of this name; -1 if there is none. */
int hf_cable_set_find(const hf_scene *scene, const char *name);

/* Returns true if set i_set contains cable i_cable. Takes a time proportional to the logarithm of the size of the
 * set. */
bool hf_cable_set_has(const hf_scene *scene, int i_set, int i_cable);

HF_API_END
#endif
