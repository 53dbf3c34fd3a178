/* wanted - the wanted surface: the parabolic cylinder z = x^2/(4f) along y, or the paraboloid z = (x^2 + y^2)/(4f). */
#ifndef HIFDM_WANTED_H
#define HIFDM_WANTED_H

#include <hifdm/scene.h>
#include <hifdm/settings.h>

/* Height of a point above the surface of this kind, not HF_SURFACE_AUTO, and curvature = 1/(4f); its slopes there. */
static inline double hf_wanted_height_above(hf_surface_kind kind, double curvature, const double p[3], double slope[2])
{
    bool is_round = kind == HF_SURFACE_PARABOLOID;
    double above = p[2] - curvature * p[0] * p[0];
    slope[0] = 2 * curvature * p[0];
    slope[1] = is_round ? 2 * curvature * p[1] : 0;
    return is_round ? above - curvature * p[1] * p[1] : above;
}

/* How far the inner nodes of a scene, at their theoretical places, are from a surface, by height. */
typedef struct {
    double rms_m, most_m; /* most_m: of the farthest */
    int farthest;         /* this node */
    double depth_m;       /* of the surface below all nodes: its largest height less its least */
} hf_wanted_fit;

hf_wanted_fit hf_wanted_compare(hf_surface_kind kind, double focal_length_m, const hf_scene *scene);

#endif
