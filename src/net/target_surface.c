#include "net/target_surface.h"

#include <math.h>

hf_target_surface_fit hf_target_surface_compare(hf_surface_kind kind, double focal_length_m, const hf_scene *s)
{
    hf_target_surface_fit fit = {.farthest = -1};
    double low = INFINITY, high = -INFINITY, square = 0, slope[2], curvature = 1 / (4 * focal_length_m);
    int n = 0;
    for (int i = 0; i < s->n_node; i++) {
        const double *p = s->position_m + 3 * (size_t)i;
        double above = hf_target_surface_height_above(kind, curvature, p, slope), target = p[2] - above;
        low = fmin(low, target);
        high = fmax(high, target);
        if (s->role[i] != HF_ROLE_INNER) continue;
        n++;
        square += above * above;
        if (!(fabs(above) > fit.max_m) && fit.farthest >= 0) continue;
        fit.max_m = fabs(above);
        fit.farthest = i;
    }
    fit.depth_m = high - low;
    fit.rms_m = n ? sqrt(square / n) : 0;
    return fit;
}
