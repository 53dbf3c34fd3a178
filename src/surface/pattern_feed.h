/* pattern_feed - what a feed makes of the places on a surface (METHOD section 13). */
#ifndef HIFDM_PATTERN_FEED_H
#define HIFDM_PATTERN_FEED_H

#include <hifdm/pattern.h>

/* The magnetic field that the feed sends to p, times the impedance of space, without its phase: field [3], real; 0
 * behind the feed. toward [3]: unit vector in which the wave goes. Returns the length of its path from the feed; of a
 * plane wave that from the origin. */
double hf_feed_light(const hf_feed *feed, const double p[3], double toward[3], double field[3]);

/* The change of this field for a move of p; of the path it is toward . move. */
void hf_feed_light_rate(const hf_feed *feed, const double p[3], const double move[3], double field_rate[3]);

#endif
