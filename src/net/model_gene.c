/* Names and units of design variables. */
#include <hifdm/model.h>

#include <stdio.h>

static const char *direction_name(const hf_variable *g)
{
    if (g->vary == HF_VARY_SUPPORT_NORMAL) return "normal";
    return g->direction[0] > 0 ? "x" : g->direction[1] > 0 ? "y" : "z";
}

void hf_model_variable_name(const hf_model *m, const hf_scene *scene, int k, char *text, size_t size)
{
    if (m->variable_cable[k] >= 0)
        snprintf(text, size, "%s", scene->cable_id[m->variable_cable[k]]);
    else
        snprintf(text, size, "%s.%s", scene->node_id[m->node_of_row[m->variable[k].support_row]],
                 direction_name(&m->variable[k]));
}

const char *hf_model_variable_unit(const hf_model *m, int k)
{
    switch (hf_model_vary(m, k)) {
    case HF_VARY_PRETENSION:
    case HF_VARY_TENSION:
        return "N";
    case HF_VARY_FORCE_DENSITY:
        return "N/m";
    default:
        return "m";
    }
}
