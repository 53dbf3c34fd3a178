/* double_net - where a rear net is behind a front net. The generators of such nets share this module.
 *
 * The front net lies on z = x^2/(4f) or z = (x^2 + y^2)/(4f). Let s be the distance from its middle, measured along x
 * or in the plane of x and y. Its rim is at s = half_m. The rear surface is z_front + (half^2 - s^2) (1/(4f) +
 * 1/(4f_rear)) - distance. Its rim is straight below the rim of the front, and it bulges towards the front. */
#pragma once

#include <hifdm/generate.h>

typedef struct {
    hf_surface_kind kind; /* of the front net */
    double focal_length_m, rear_focal_length_m;
    double middle_x_m, half_m;
    double distance_m; /* 0: no rear net */
    hf_tie_direction direction;
    bool supports_along_z; /* true: rear supports are straight below, also if ties run along the normal */
    hf_law law;            /* law of the ties */
    double tension_N;      /* tension of ties of the laws tension, force_density and elastic at the target positions */
} hf_double_net;

/* Initialises the members of hf_double_net from the settings of a generator. The settings contain
 * HF_DOUBLE_NET_MEMBERS. */
#define HF_DOUBLE_NET_OF(p)                                                                                            \
    .distance_m = (p)->rear_distance_m, .direction = (p)->tie_direction, .law = (p)->tie_law,                          \
    .tension_N = (p)->tie_tension_N,                                                                                   \
    .rear_focal_length_m = (p)->rear_focal_length_m > 0 ? (p)->rear_focal_length_m : (p)->focal_length_m

/* Computes the position rear_m [3] behind the point front_m [3] of the front net: straight below it if `along_z`, else
 * where its normal meets the rear surface. Returns false if there is no such point below. */
bool hf_double_net_behind(const hf_double_net *d, bool along_z, const double front_m[3], double rear_m[3]);

/* Returns "rear_distance_m" with the reason in `what` if the nets meet in the middle, else NULL. */
const char *hf_double_net_fault(const hf_double_net *d, char *what, size_t size);

/* Returns true if the ties are elastic and EA_N contains no stiffness for them. EA_N [2] is by hf_group, as
 * in the generators. */
bool hf_double_net_lacks_EA(const hf_double_net *d, const double EA_N[2]);
