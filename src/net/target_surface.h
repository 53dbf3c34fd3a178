/* target_surface - the target surface: parabolic cylinder z = x^2/(4f) along y, or paraboloid z = (x^2 + y^2)/(4f). */
#pragma once

#include <hifdm/scene.h>
#include <hifdm/settings.h>

/* Returns the height of a point above the surface, m, and writes the slopes of the surface there. `kind` is not
 * HF_SURFACE_AUTO; curvature = 1/(4f). */
static inline double hf_target_surface_height_above(hf_surface_kind kind, double curvature, const double p[3],
                                                    double slope[2])
{
    bool is_round = kind == HF_SURFACE_PARABOLOID;
    double above = p[2] - curvature * p[0] * p[0];
    slope[0] = 2 * curvature * p[0];
    slope[1] = is_round ? 2 * curvature * p[1] : 0;
    return is_round ? above - curvature * p[1] * p[1] : above;
}

/* Distances of the inner nodes of a scene, at their target positions, from a surface, measured along z. */
typedef struct {
    double rms_m, max_m;
    int farthest;   /* node with the maximum distance */
    double depth_m; /* highest minus lowest z of the surface at x and y of all nodes */
} hf_target_surface_fit;

hf_target_surface_fit hf_target_surface_compare(hf_surface_kind kind, double focal_length_m, const hf_scene *scene);
