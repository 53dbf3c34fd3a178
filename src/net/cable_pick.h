/* cable_pick - selects the cables that a row of a case file refers to (named sets of the scene, or `inner`,
 * `boundary`, `all`), and checks that cables have an EA. */
#pragma once

#include <hifdm/cable_set.h>

/* Copies the first of several names of sets, which are joined by +. Returns the names behind it, NULL: none. */
const char *hf_cable_pick_name(const char *sets, char name[HF_SET_NAME_SIZE]);

/* Writes the cables of a set, ascending, into `cable` [n_cable]. The name "" means all cables, and several names joined
 * by + mean the cables of any of these sets. Returns their number, or -1 if the scene does not have all of the sets. */
int hf_cable_pick(const hf_scene *scene, const char *set, int *cable);

/* Selects the cables of a set like hf_cable_pick, for a row of a case that needs at least one cable. Returns the number
 * of cables. If there are none, returns 0 with an error that begins with `where` and suggests a set or lists the sets
 * of the net. */
int hf_cable_pick_some(const hf_scene *scene, const char *set, const char *where, int *cable, hf_messages *messages);

/* Returns HF_BAD_CASE if cables have no EA, with one error for each group. The error begins with `where`. `who_needs`
 * says what needs the EA, such as "cut lengths need"; `then` says what else to do, or is "". */
hf_status hf_cable_demand_EA(const hf_scene *scene, const char *where, const char *who_needs, const char *then,
                             hf_messages *messages);
