/* cut - the cutting length of each cable of a stored shape, for the cut list and for the page of a result. */
#pragma once

#include <hifdm/store.h>

typedef struct {
    double tension_N, length_m;
    double l0_m; /* unstressed length */
    double
        unstressed_minus_target_m; /* excess over the unstressed length for the same tension at the target positions */
} hf_cut;

/* Returns the cutting length of cable i_cable, which must have an EA. reference_N is hf_model_reference_N of the
 * case. */
hf_cut hf_cut_of(const hf_scene *scene, const hf_shape *shape, double reference_N, int i_cable);
