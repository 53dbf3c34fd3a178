/* Computes the cutting length l0 = l/(1 + T/EA) of a cable of a stored shape (METHOD section 12, M32). */
#include "out/cut.h"

#include <hifdm/metrics.h>

#include <math.h>

hf_cut hf_cut_of(const hf_scene *s, const hf_shape *shape, double reference_N, int e)
{
    hf_law law = shape->law[e];
    hf_cut c = {.tension_N = shape->tension_N[e], .length_m = shape->length_m[e]};
    double length_at_target_m = hf_scene_length_at_target(s, e);
    hf_law_cable cable = {law, s->target[e], s->EA_N[e], length_at_target_m};
    /* The target in the scene belongs to the law of the scene, which a design may have replaced. A cable counts as
     * slack only while that law holds, because hf_law_cut_m then reads the target. */
    bool is_slack = fabs(c.tension_N) < HF_SLACK_RATIO * reference_N && law == s->law[e];
    c.l0_m = hf_law_cut_m(cable, c.length_m, c.tension_N, is_slack);
    c.unstressed_minus_target_m = c.l0_m - length_at_target_m / (1 + c.tension_N / s->EA_N[e]);
    return c;
}
