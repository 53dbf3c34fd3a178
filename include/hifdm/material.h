/* material - what cables and nodes are made of, as far as a case says it: for the net as built.
 * Stability: internal; may change in any version. */
#ifndef HIFDM_MATERIAL_H
#define HIFDM_MATERIAL_H

#include <hifdm/api.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>

HF_API_BEGIN

typedef struct {
    double *expansion_per_K; /* [n_cable] NaN where not given */
    double *mass_kg_per_m;   /* [n_cable] of unstressed length; NaN where not given */
    double *node_mass_kg;    /* [n_node] 0 where not given */
    void *block;
} hf_material;

/* Nothing is given. HF_OK or HF_NO_MEMORY. */
hf_status hf_material_allocate(const hf_scene *scene, hf_material *material);
void hf_material_free(hf_material *material);

/* Is this one of the nodes that a row names? */
static inline bool hf_material_names(hf_nodes nodes, unsigned char role)
{
    return nodes == HF_NODES_ALL || (int)nodes - 1 == (int)role; /* hf_role in the same order */
}

HF_API_END
#endif
