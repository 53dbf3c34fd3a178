/* material - thermal expansion and mass of cables and nodes of the as-built net.
 * Stability: internal. This header may change in any version. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

/* Contains the properties of the cables and nodes of a scene. */
typedef struct {
    double *expansion_per_K; /* [n_cable] coefficient of thermal expansion; NaN: not given */
    double *mass_kg_per_m;   /* [n_cable] mass per unstressed length; NaN: not given */
    double *node_mass_kg;    /* [n_node] mass; 0: not given */
    void *block;             /* owned memory behind the arrays */
} hf_material;

/* Allocates the properties of the cables and nodes of a scene. Initially no property is given. Returns HF_OK or
 * HF_NO_MEMORY. Call hf_material_free even if hf_material_allocate fails. */
hf_status hf_material_allocate(const hf_scene *scene, hf_material *material);
/* Frees the properties. */
void hf_material_free(hf_material *material);

/* Returns true if a row of `nodes` applies to a node with the role `role` (hf_role). */
static inline bool hf_material_names(hf_nodes nodes, unsigned char role)
{
    return nodes == HF_NODES_ALL || (int)nodes - 1 == (int)role; /* hf_nodes lists the roles in the order of hf_role */
}

HF_API_END
