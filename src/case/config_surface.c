/* Checks that the net lies on the target surface of the case. */
#include "case/config_check.h"
#include "net/target_surface.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Maximum RMS distance of the target positions from the target surface, relative to the depth of the surface below the
 * net. It is 1 mm for a shallow reflector of 50 mm, or half the sag of facets with a side of a sixth of the radius. If
 * a paraboloid is taken for a cylinder, the distance is a third of the depth. */
#define OFF_MOST 0.02

#define FOCAL_MOST 20.0 /* apertures; a larger one was probably given in mm */

static bool is_on(const hf_target_surface_fit *fit)
{
    return fit->rms_m <= OFF_MOST * fit->depth_m;
}

static hf_status refuse(const hf_case *c, const hf_scene *scene, const hf_surface_settings *surface,
                        const hf_target_surface_fit *cylinder, const hf_target_surface_fit *paraboloid,
                        hf_messages *messages)
{
    char location[HF_LOCATION_SIZE], other[HF_LOCATION_SIZE], line[32] = "";
    bool is_round = surface->kind == HF_SURFACE_PARABOLOID;
    const hf_target_surface_fit *fit = is_round ? paraboloid : cylinder;
    const char *advice = "The vertex of the target surface is the origin, and its axis is z";
    if (is_on(is_round ? cylinder : paraboloid))
        advice = is_round ? "Give surface.kind: parabolic_cylinder" : "Give surface.kind: paraboloid";
    if (!hf_config_location(c, "surface.focal_length_m", location, sizeof location) &&
        hf_config_location(c, "surface.kind", other, sizeof other))
        memcpy(location, other, sizeof location);
    if (scene->node_line) snprintf(line, sizeof line, ", line %d", scene->node_line[fit->farthest]);
    return hf_error(messages, HF_BAD_CASE,
                    "%s: the inner nodes are not on the %s with f = %g m. The RMS height error of the inner nodes is "
                    "%.4g mm, and node '%s'%s has the maximum error of %.4g mm. The RMS height error is %.4g mm for "
                    "the parabolic_cylinder z = x^2/(4f), and %.4g mm for the paraboloid z = (x^2 + y^2)/(4f). %s",
                    location, hf_surface_kind_word[surface->kind], surface->focal_length_m, fit->rms_m * 1e3,
                    scene->node_id[fit->farthest], line, fit->max_m * 1e3, cylinder->rms_m * 1e3,
                    paraboloid->rms_m * 1e3, advice);
}

/* Warns of a focal length out of proportion. Focal lengths of reflectors are 0.2 to 10 apertures. The aperture is the
 * extent across the axis; for a cylinder, the extent along x. */
static void doubt_focal_length(const hf_case *c, const hf_scene *scene, hf_messages *messages)
{
    const char *key = NULL;
    char location[HF_LOCATION_SIZE];
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    hf_surface_settings of = hf_config_known_surface(c, &key);
    if (of.focal_length_m == 0) {
        of = c->surface;
        key = "surface.focal_length_m";
    }
    for (int i = 0; i < scene->n_node; i++)
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], scene->position_m[3 * i + k]);
            high[k] = fmax(high[k], scene->position_m[3 * i + k]);
        }
    double x_m = high[0] - low[0], y_m = high[1] - low[1];
    double aperture_m = of.kind == HF_SURFACE_PARABOLIC_CYLINDER ? x_m : fmax(x_m, y_m);
    if (!(of.focal_length_m > FOCAL_MOST * aperture_m)) return;
    hf_warning(messages,
               "%s: the focal length of %g m is %.0f times the aperture of %g m, but the usual maximum for reflectors "
               "is %g times. Is this value in m?",
               hf_config_place(c, location, "%s", key), of.focal_length_m, of.focal_length_m / aperture_m, aperture_m,
               FOCAL_MOST);
}

/* Sets values of the feed that the case does not give to NaN. They follow from the target surface. */
static void open_feed(const hf_case *c, hf_pattern_settings *p)
{
    char location[HF_LOCATION_SIZE];
    if (!hf_config_location(c, "surface.pattern.feed.position_m", location, sizeof location))
        p->position_m[0] = (double)NAN;
    if (!hf_config_location(c, "surface.pattern.feed.aim_m", location, sizeof location)) p->aim_m[0] = (double)NAN;
    if (!hf_config_location(c, "surface.pattern.feed.cos_power", location, sizeof location)) p->cos_power = (double)NAN;
}

hf_status hf_config_surface(const hf_case *c, const hf_scene *scene, hf_surface_settings *surface,
                            hf_messages *messages)
{
    *surface = (hf_surface_settings){0};
    doubt_focal_length(c, scene, messages);
    if (!c->has_surface) return HF_OK;
    *surface = c->surface;
    open_feed(c, &surface->pattern);
    hf_target_surface_fit cylinder =
        hf_target_surface_compare(HF_SURFACE_PARABOLIC_CYLINDER, surface->focal_length_m, scene);
    hf_target_surface_fit paraboloid = hf_target_surface_compare(HF_SURFACE_PARABOLOID, surface->focal_length_m, scene);
    if (surface->kind == HF_SURFACE_AUTO)
        surface->kind = paraboloid.rms_m < cylinder.rms_m ? HF_SURFACE_PARABOLOID : HF_SURFACE_PARABOLIC_CYLINDER;
    if (is_on(surface->kind == HF_SURFACE_PARABOLOID ? &paraboloid : &cylinder)) return HF_OK;
    return refuse(c, scene, surface, &cylinder, &paraboloid, messages);
}
