/* cable_set - named sets of cables: what several cables have in common beside their group, such as front or edge_tie.
 * Stability: stable.
 *
 * A cable belongs to any number of sets. Generators name the families of their cables; an import has the column `set`.
 * The groups inner and boundary are not listed, because hf_scene.group has them; their names are taken, as is `all`. */
#ifndef HIFDM_CABLE_SET_H
#define HIFDM_CABLE_SET_H

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

#define HF_CABLE_SET_NAME_SIZE HF_SET_NAME_SIZE

typedef struct {
    int set, cable;
} hf_cable_set_member;

/* What is wrong with the name of a set, as the end of a sentence; NULL when it is right: letters, digits, _ and -, none
 * of the latter in front, and neither the name of a group nor `all`. */
const char *hf_cable_set_name_fault(const char *name);

/* Make room in a scene without sets for n_set >= 1 sets with n_member cables in all, names of up to
 * HF_CABLE_SET_NAME_SIZE bytes; everything is zero, the names are empty. HF_OK, HF_NO_MEMORY. hf_scene_free frees it.
 */
hf_status hf_cable_set_allocate(hf_scene *scene, int n_set, int n_member);

/* Give a scene without sets these. name [n_set]: sorted by strcmp, no two alike; member [n_member]: no two alike, those
 * of one set with ascending cables. Sets without a cable are left out. HF_OK, HF_NO_MEMORY. */
hf_status hf_cable_set_make(hf_scene *scene, int n_set, const char *const *name, int n_member,
                            const hf_cable_set_member *member);

/* Index of the set of this name, or -1. */
int hf_cable_set_find(const hf_scene *scene, const char *name);

bool hf_cable_set_has(const hf_scene *scene, int i_set, int i_cable);

HF_API_END
#endif
