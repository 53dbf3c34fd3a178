/* pattern_feed - the field of a feed at the points of a surface (METHOD section 13). */
#pragma once

#include <hifdm/pattern.h>

/* Computes the magnetic field of the feed at p, times the impedance of space, without its phase: field [3], real. It is
 * 0 behind the feed. toward [3]: unit vector of the direction of the wave. Returns the path length from the feed, m;
 * for a plane wave from the origin. */
double hf_feed_light(const hf_feed *feed, const double p[3], double toward[3], double field[3]);

/* Computes the rate of this field for a motion `move` of p. The rate of the path is toward . move. */
void hf_feed_light_rate(const hf_feed *feed, const double p[3], const double move[3], double field_rate[3]);
