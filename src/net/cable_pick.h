/* cable_pick - the cables that a row of a case file names: a named set of the scene, or `inner`, `boundary`, `all`. */
#ifndef HIFDM_CABLE_PICK_H
#define HIFDM_CABLE_PICK_H

#include <hifdm/cable_set.h>

/* The cables of a set by its name; "" are all of them. Writes them, ascending, into `cable` [n_cable], which may be
 * NULL. Returns how many there are, or -1 when the scene has no such set. */
int hf_cable_pick(const hf_scene *scene, const char *set, int *cable);

/* The same where a row of the case needs a cable at least: else 0, and a message that begins with `where` and ": " and
 * names the sets there are. */
int hf_cable_pick_some(const hf_scene *scene, const char *set, const char *where, int *cable, hf_messages *messages);

#endif
