/* surface_near - the best fit to points that are near those of another fit, such as a net as built near its design: by
 * Gauss and Newton from that fit, without memory of its own (METHOD section 9). hf_surface_fit_points is its reference,
 * and what finds the fits that this does not. */
#ifndef HIFDM_SURFACE_NEAR_H
#define HIFDM_SURFACE_NEAR_H

#include "surface/surface_fit.h"
#include <hifdm/facets.h>

/* A fitted surface: z = curvature x^2 (+ y^2) in a frame in which point p is at turn (p - center - shift) + center. */
typedef struct {
    bool is_whole; /* the points of this fit determine all parameters */
    hf_surface_kind kind;
    double center_m[3], shift_m[3], turn[3][3];
    double curvature_per_m, wanted_per_m, size_m;
} hf_surface_pose;

hf_surface_pose hf_surface_pose_of(hf_surface_kind kind, double focal_length_m, const hf_surface_fit *fit,
                                   const hf_fit_parameters *parameters);

/* Half-path RMS after the best fit of points [3][n], with the roots of their weights [n] (NULL: all are 1), from this
 * pose. False where steps do not end at once, or end near what the reference takes for undetermined; half_path_rms_m
 * means nothing then. Agrees with the reference to 1e-9 of the RMS (unit/surface/surface). */
bool hf_surface_fit_near(const hf_surface_pose *from, int n, const double *position_m, const double *root_weight,
                         double *half_path_rms_m);

/* The half-path RMS values of a shape. NaN: it has none, or no fit. */
typedef struct {
    double nodes_m, nodes_fit_m, facets_m, facets_fit_m;
} hf_surface_paths;

/* The fits of a shape, from which those of shapes near it begin. */
typedef struct {
    hf_surface_pose nodes, facets;
} hf_surface_design;

/* workspace: the shape. HF_OK or HF_NO_MEMORY. */
hf_status hf_surface_design_make(const hf_surface_settings *settings, const hf_facets *facets, const hf_model *model,
                                 const double *position_m, const double *tension_N, hf_surface_design *design);

/* What hf_surface_measure has of another shape of the same net, mostly in a tenth of its time or less. facets may be
 * NULL. HF_OK or HF_NO_MEMORY. */
hf_status hf_surface_measure_near(const hf_surface_design *design, const hf_surface_settings *settings,
                                  const hf_facets *facets, const hf_model *model, const double *position_m,
                                  const double *tension_N, hf_surface_paths *paths);

#endif
