/* facet_rms - the errors of the surface between the nodes: RMS over the facets of a shape, and the errors of each facet
 * (METHOD section 9). */
#ifndef HIFDM_FACET_RMS_H
#define HIFDM_FACET_RMS_H

#include "base/arena.h"
#include <hifdm/facets.h>
#include "surface/surface_fit.h"
#include "surface/surface_near.h"

/* A found shape in the order of the scene; borrowed. */
typedef struct {
    const double *position_m; /* [n_node][3] */
    int n_cable;
    const int *end;          /* [n_cable][2] */
    const double *tension_N; /* [n_cable]; NULL, as of the theoretical shape: facets are flat, whatever the mesh */
} hf_facet_shape;

/* A shape of a model, position_m [3][n_node] by row; it borrows tension_N [n_cable]. Free the arena in any case. HF_OK
 * or HF_NO_MEMORY. */
hf_status hf_facet_shape_take(const hf_model *model, const double *position_m, const double *tension_N,
                              hf_facet_shape *shape, hf_arena *arena);

/* Gauss-Legendre on [0, 1] for flat facets, exact to the fifth power. */
enum { HF_FACET_N_FLAT = 3 };
extern const double hf_facet_flat_at[HF_FACET_N_FLAT], hf_facet_flat_weight[HF_FACET_N_FLAT];

/* Set the members facet_... and n_facet, n_open_face of `to`, but for losses of gain; NaN without a facet. HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_facet_measure(const hf_surface_settings *settings, const hf_facets *facets, const hf_facet_shape *shape,
                           hf_surface_measures *to);

/* The best fit to the facets of a shape, with its parameters; not converged where the mesh has no shape. HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_facet_fit(const hf_surface_settings *settings, const hf_facets *facets, const hf_facet_shape *shape,
                       hf_surface_fit *fit, hf_fit_parameters *parameters);

/* facet_half_path_rms_m and facet_fit_half_path_rms_m of hf_facet_measure, the latter from the fit of a shape nearby.
 * HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_measure_near(const hf_surface_pose *from, const hf_surface_settings *settings,
                                const hf_facets *facets, const hf_facet_shape *shape, double *half_path_rms_m,
                                double *fit_half_path_rms_m);

/* Errors along the normal of each facet, [n_facet], by projected area: mean and RMS, against the wanted surface and
 * against the best fit to all facets (NaN when it does not converge). */
typedef struct {
    double *normal_mean_m, *normal_rms_m, *fit_normal_mean_m, *fit_normal_rms_m;
} hf_facet_errors;

/* HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_map(const hf_surface_settings *settings, const hf_facets *facets, const hf_facet_shape *shape,
                       const hf_facet_errors *to);

#endif
