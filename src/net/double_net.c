#include "net/double_net.h"

#include "net/target_surface.h"

#include <math.h>
#include <stdio.h>

#define FOUND 1e-10 /* relative step at which Newton's method ends: the next step is below rounding */

static double front_curvature(const hf_double_net *d)
{
    return 1 / (4 * d->focal_length_m);
}

/* Returns how the nets approach each other, 1/m: at the distance s from the middle, they are nearer than at the rim by
 * (half_m^2 - s^2) times this. */
static double nearing(const hf_double_net *d)
{
    return front_curvature(d) + 1 / (4 * d->rear_focal_length_m);
}

/* Returns z of the rear surface at x and y of point p, m, and its slopes. */
static double rear_height(const hf_double_net *d, const double p[3], double slope[2])
{
    bool is_round = d->kind == HF_SURFACE_PARABOLOID;
    double dx = p[0] - d->middle_x_m, dy = is_round ? p[1] : 0;
    double front_z = p[2] - hf_target_surface_height_above(d->kind, front_curvature(d), p, slope);
    slope[0] -= 2 * nearing(d) * dx;
    slope[1] -= 2 * nearing(d) * dy;
    return front_z + (d->half_m * d->half_m - dx * dx - dy * dy) * nearing(d) - d->distance_m;
}

bool hf_double_net_behind(const hf_double_net *d, bool along_z, const double front_m[3], double rear_m[3])
{
    double slope[2], normal[3] = {0, 0, -1}, t = 0;
    bool is_found = along_z;
    hf_target_surface_height_above(d->kind, front_curvature(d), front_m, slope);
    for (int c = 0; c < 3; c++)
        rear_m[c] = front_m[c];
    if (!along_z) normal[0] = slope[0], normal[1] = slope[1];
    for (int i = 0; i < 60 && !is_found; i++) { /* Newton's method for the length along the normal */
        for (int c = 0; c < 3; c++)
            rear_m[c] = front_m[c] + t * normal[c];
        double above = rear_m[2] - rear_height(d, rear_m, slope);
        double step = above / (normal[2] - slope[0] * normal[0] - slope[1] * normal[1]);
        t -= step;
        is_found = fabs(step) <= FOUND * fabs(t);
    }
    for (int c = 0; c < 2; c++)
        rear_m[c] = front_m[c] + t * normal[c];
    rear_m[2] = rear_height(d, rear_m, slope);
    return is_found && rear_m[2] < front_m[2];
}

const char *hf_double_net_fault(const hf_double_net *d, char *what, size_t size)
{
    double nearer_m = d->half_m * d->half_m * nearing(d);
    if (d->distance_m == 0 || d->distance_m > nearer_m) return NULL;
    snprintf(what, size, "of %.6g m lets the nets meet in the middle, where they come %.6g m nearer than at the rim",
             d->distance_m, nearer_m);
    return "rear_distance_m";
}

bool hf_double_net_lacks_EA(const hf_double_net *d, const double EA_N[2])
{
    return d->distance_m > 0 && d->law == HF_LAW_ELASTIC && !(EA_N && EA_N[HF_GROUP_INNER] > 0);
}
