/* facet_rms - errors of the surface between the nodes: RMS over the facets of a shape, and the errors of each facet
 * (METHOD section 9). */
#ifndef HIFDM_FACET_RMS_H
#define HIFDM_FACET_RMS_H

#include "base/arena.h"
#include <hifdm/facets.h>
#include "surface/surface_fit.h"
#include "surface/surface_near.h"

/* A shape in the order of the scene; all pointers are borrowed. */
typedef struct {
    const double *position_m; /* [n_node][3] */
    int n_cable;
    const int *end;          /* [n_cable][2] */
    const double *tension_N; /* [n_cable]; NULL (target positions): facets are flat, even with a mesh tension */
} hf_facet_shape;

/* Makes an hf_facet_shape from a shape of a model, position_m [3][n_node] by row. Borrows tension_N [n_cable]. Returns
 * HF_OK or HF_NO_MEMORY. Free the arena in every case. */
hf_status hf_facet_shape_take(const hf_model *model, const double *position_m, const double *tension_N,
                              hf_facet_shape *shape, hf_arena *arena);

/* Gauss-Legendre rule on [0, 1] for flat facets, exact for polynomials of degree 5. */
enum { HF_FACET_N_FLAT = 3 };
extern const double hf_facet_flat_at[HF_FACET_N_FLAT], hf_facet_flat_weight[HF_FACET_N_FLAT];

/* Sets the members facet_..., n_facet, n_open_face, pillow_rms_m and mesh_pull_ratio of `to`, but no losses of gain.
 * The errors are NaN without facets. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_measure(const hf_surface_settings *settings, const hf_facets *facets, const hf_facet_shape *shape,
                           hf_surface_measures *to);

/* Finds the best fit to the facets of a shape, with its parameters. It has not converged if the mesh has no shape.
 * Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_fit(const hf_surface_settings *settings, const hf_facets *facets, const hf_facet_shape *shape,
                       hf_surface_fit *fit, hf_fit_parameters *parameters);

/* Computes facet_half_path_rms_m and facet_fit_half_path_rms_m as hf_facet_measure does. The fit starts from that of a
 * similar shape. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_measure_near(const hf_surface_pose *from, const hf_surface_settings *settings,
                                const hf_facets *facets, const hf_facet_shape *shape, double *half_path_rms_m,
                                double *fit_half_path_rms_m);

/* Errors of each facet along the normal, [n_facet], weighted by projected area: mean and RMS, against the target
 * surface and against the best fit to all facets (NaN if it does not converge). */
typedef struct {
    double *normal_mean_m, *normal_rms_m, *fit_normal_mean_m, *fit_normal_rms_m;
} hf_facet_errors;

/* Computes the errors of each facet. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_facet_map(const hf_surface_settings *settings, const hf_facets *facets, const hf_facet_shape *shape,
                       const hf_facet_errors *to);

#endif
