/* cable_pick - the cables that a row of a case file names: a named set of the scene, or `inner`, `boundary`, `all`; and
 * those that lack an EA. */
#ifndef HIFDM_CABLE_PICK_H
#define HIFDM_CABLE_PICK_H

#include <hifdm/cable_set.h>

/* The cables of a set by its name; "" are all of them. Writes them, ascending, into `cable` [n_cable], which may be
 * NULL. Returns how many there are, or -1 when the scene has no such set. */
int hf_cable_pick(const hf_scene *scene, const char *set, int *cable);

/* The same where a row of the case needs a cable at least: else 0, and a message that begins with `where` and ": " and
 * names the sets there are. */
int hf_cable_pick_some(const hf_scene *scene, const char *set, const char *where, int *cable, hf_messages *messages);

/* HF_BAD_CASE with a message for each group of cables without EA; it begins with `where` and says who needs it, such as
 * "cut lengths need", and what to do after it is given ("": nothing more). */
hf_status hf_cable_demand_EA(const hf_scene *scene, const char *where, const char *who_needs, const char *then,
                             hf_messages *messages);

#endif
