#include "truss/tube.h"

#include "base/elementary.h"

#include <math.h>
#include <stdio.h>

/* Sets the section, material and joint of member e. */
static void set_section(const hf_truss_settings *s, double diameter_m, double wall_m, hf_truss *t, int e)
{
    double outer = diameter_m / 2, inner = outer - wall_m;
    t->joint[e] = (unsigned char)s->joints;
    t->E_Pa[e] = s->E_Pa;
    t->G_Pa[e] = s->G_Pa;
    t->A_m2[e] = HF_PI * (outer * outer - inner * inner);
    t->Iy_m4[e] = t->Iz_m4[e] = HF_PI / 4 * (outer * outer * outer * outer - inner * inner * inner * inner);
    t->J_m4[e] = 2 * t->Iy_m4[e];
    t->Asy_m2[e] = t->Asz_m2[e] = s->theory == HF_THEORY_TIMOSHENKO ? t->A_m2[e] / 2 : (double)INFINITY;
    t->density_kg_per_m3[e] = s->density_kg_per_m3;
    t->expansion_per_K[e] = s->expansion_per_K;
}

char *hf_tube_join(const hf_truss_settings *s, double diameter_m, double wall_m, hf_truss *t, int e, int a, int b,
                   hf_unit unit, char *text, size_t size)
{
    t->end[2 * e] = a;
    t->end[2 * e + 1] = b;
    t->unit[e] = (unsigned char)unit;
    set_section(s, diameter_m, wall_m, t, e);
    t->member_id[e] = text;
    return text + snprintf(text, size, "%s-%s", t->node_id[a], t->node_id[b]) + 1;
}
