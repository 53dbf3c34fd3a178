/* antenna_shape - a shape of a model as the surface of an antenna: facets, positions, sags of the mesh. */
#pragma once

#include "surface/facet_mesh.h"
#include <hifdm/pattern.h>

typedef struct {
    bool exists; /* false: a cable cannot hold the pull of the mesh */
    hf_pattern_surface surface;
    hf_facet_shape shape;
    hf_arena sags;
} hf_antenna_shape;

/* Takes a shape, position_m [3][n_node] by row and tension_N [n_cable]. The facets and tensions are borrowed. Returns
 * HF_OK or HF_NO_MEMORY. Free the shape in every case. */
hf_status hf_antenna_shape_take(double mesh_tension_N_per_m, const hf_facets *facets, const hf_model *model,
                                const double *position_m, const double *tension_N, hf_antenna_shape *shape);
void hf_antenna_shape_free(hf_antenna_shape *shape);
