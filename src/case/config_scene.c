/* What a case describes, made: the net and the truss; and its end. */
#include <hifdm/config.h>

#include "net/scene_import.h"
#include "truss/truss_import.h"

#include <stdlib.h>

hf_status hf_config_scene(const hf_case *settings, hf_scene *scene, hf_messages *messages)
{
    if (settings->has_import)
        HF_TRY(hf_scene_import(settings->nodes_path, settings->cables_path, settings->cylinder.EA_N, scene, messages));
    else
        HF_TRY(hf_scene_parabolic_cylinder(&settings->cylinder, scene, messages));
    return hf_scene_check(scene, messages);
}

hf_status hf_config_truss(const hf_case *settings, hf_truss *truss, hf_messages *messages)
{
    if (settings->has_truss_import)
        HF_TRY(hf_truss_import(settings->truss_nodes_path, settings->truss_members_path, truss, messages));
    else
        HF_TRY(hf_truss_generate(&settings->truss, &settings->cylinder, truss, messages));
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

void hf_case_free(hf_case *settings)
{
    free(settings->text);
    free(settings->overrides);
    *settings = (hf_case){0};
}
