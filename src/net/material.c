#include <hifdm/material.h>

#include "base/arena.h"

#include <math.h>

_Static_assert(HF_NODES_SUPPORT - 1 == HF_ROLE_SUPPORT && HF_NODES_EDGE - 1 == HF_ROLE_EDGE, "roles are in one order");

hf_status hf_material_allocate(const hf_scene *scene, hf_material *material)
{
    *material = (hf_material){0};
    HF_TRY(HF_ARENA_ARRAYS(&material->block, HF_ARRAY(material->expansion_per_K, scene->n_cable),
                           HF_ARRAY(material->mass_kg_per_m, scene->n_cable),
                           HF_ARRAY(material->node_mass_kg, scene->n_node)));
    for (int e = 0; e < scene->n_cable; e++)
        material->expansion_per_K[e] = material->mass_kg_per_m[e] = (double)NAN;
    return HF_OK;
}

void hf_material_free(hf_material *material)
{
    hf_arena_free_block(material->block);
    *material = (hf_material){0};
}
