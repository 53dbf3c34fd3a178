/* cut - to which length the cable of a stored shape is cut, for the workshop and for the page of a result. */
#ifndef HIFDM_CUT_H
#define HIFDM_CUT_H

#include <hifdm/store.h>

typedef struct {
    double tension_N, length_m;
    double l0_m;              /* unstressed length */
    double l0_minus_theory_m; /* how much longer than if it were cut for the theoretical shape */
} hf_cut;

/* Of cable i_cable, whose EA the scene has. reference_N: hf_model_reference_N of the case. */
hf_cut hf_cut_of(const hf_scene *scene, const hf_shape *shape, double reference_N, int i_cable);

#endif
