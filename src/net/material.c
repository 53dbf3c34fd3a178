#include <hifdm/material.h>

#include "base/arena.h"

#include <math.h>

_Static_assert(HF_NODES_SUPPORT - 1 == HF_ROLE_SUPPORT && HF_NODES_EDGE - 1 == HF_ROLE_EDGE, "roles are in one order");

static void lay_out(hf_arena *arena, const hf_scene *s, hf_material *t)
{
    size_t n = (size_t)s->n_cable;
    t->expansion_per_K = hf_arena_take(arena, n, sizeof(double));
    t->mass_kg_per_m = hf_arena_take(arena, n, sizeof(double));
    t->node_mass_kg = hf_arena_take(arena, (size_t)s->n_node, sizeof(double));
}

hf_status hf_material_allocate(const hf_scene *scene, hf_material *material)
{
    hf_arena arena = {0};
    *material = (hf_material){0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, scene, material)));
    material->block = arena.block;
    for (int e = 0; e < scene->n_cable; e++)
        material->expansion_per_K[e] = material->mass_kg_per_m[e] = (double)NAN;
    return HF_OK;
}

void hf_material_free(hf_material *material)
{
    hf_arena_free_block(material->block);
    *material = (hf_material){0};
}
