/* surface_measure - half-path RMS values of many similar shapes of one net. */
#pragma once

#include "surface/surface_near.h"
#include <hifdm/facets.h>

/* Half-path RMS values of a shape, m. NaN: no shape or no fit. */
typedef struct {
    double nodes_m, nodes_fit_m, facets_m, facets_fit_m;
} hf_surface_paths;

/* The fits of a shape. Fits of similar shapes start from them. */
typedef struct {
    hf_surface_pose nodes, facets;
} hf_surface_design;

/* Finds the fits of a shape, position_m [3][n_node] by row and tension_N [n_cable]. `facets` may be NULL. Returns
 * HF_OK or HF_NO_MEMORY. */
hf_status hf_surface_design_make(const hf_surface_settings *settings, const hf_facets *facets, const hf_model *model,
                                 const double *position_m, const double *tension_N, hf_surface_design *design);

/* Measures another shape of the same net like hf_surface_measure, usually in at most a tenth of its time. `facets` may
 * be NULL. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_surface_measure_near(const hf_surface_design *design, const hf_surface_settings *settings,
                                  const hf_facets *facets, const hf_model *model, const double *position_m,
                                  const double *tension_N, hf_surface_paths *paths);
