/* Makes the net and the truss that a case describes. */
#include <hifdm/config.h>

#include "net/facet_import.h"
#include "net/scene_doubt.h"
#include "net/scene_import.h"
#include "truss/truss_import.h"

hf_status hf_config_scene(const hf_case *settings, hf_scene *scene, hf_messages *messages)
{
    if (settings->has_import)
        HF_TRY(hf_scene_import(settings->nodes_path, settings->cables_path, settings->EA_N, scene, messages));
    if (settings->has_import && *settings->facets_path) HF_TRY(hf_facet_import(settings->facets_path, scene, messages));
#define MAKE(section, type, KEYS)                                                                                      \
    if (settings->has_##section) HF_TRY(hf_scene_##section(&settings->section, settings->EA_N, scene, messages));
    HF_GENERATORS(MAKE)
#undef MAKE
    HF_TRY(hf_scene_check(scene, messages));
    return hf_scene_doubt(scene, messages);
}

hf_status hf_config_truss(const hf_case *settings, hf_truss *truss, hf_messages *messages)
{
    if (settings->has_truss_import)
        HF_TRY(hf_truss_import(settings->truss_nodes_path, settings->truss_members_path, truss, messages));
    else if (settings->has_truss_ring)
        HF_TRY(hf_truss_ring_generate(&settings->truss, &settings->paraboloid, truss, messages));
    else
        HF_TRY(hf_truss_generate(&settings->truss, &settings->parabolic_cylinder, truss, messages));
    return hf_truss_check(truss, messages);
}

hf_status hf_config_carrier(const hf_case *settings, const hf_scene *scene, hf_carrier *carrier, hf_messages *messages)
{
    hf_truss truss;
    *carrier = (hf_carrier){0};
    hf_status status = hf_config_truss(settings, &truss, messages);
    if (status == HF_OK) return hf_carrier_build(&truss, settings->truss.match_tolerance_m, scene, carrier, messages);
    hf_truss_free(&truss);
    return status;
}
