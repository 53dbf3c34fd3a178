/* Reads the materials of cables and nodes from the rows of `cables` and `nodes`. */
#include <hifdm/config.h>

#include "base/arena.h"
#include "case/config_fault.h"
#include "net/cable_pick.h"

#include <math.h>

static hf_status set_cables(const hf_case *c, const hf_scene *s, int *cable, hf_material *t, hf_messages *messages)
{
    hf_status status = HF_OK;
    for (int i = 0; i < c->built.n_cable; i++) {
        const hf_cable_settings *row = &c->built.cable[i];
        char where[HF_LOCATION_SIZE];
        hf_config_place(c, where, "cables.%d.set", i);
        /* other faults of a set were reported before */
        int n = hf_config_is_sound(c, "cables.%d.set", i) ? hf_cable_pick_some(s, row->set, where, cable, messages) : 0;
        if (n == 0) status = HF_BAD_CASE;
        for (int k = 0; k < n; k++) {
            if (!isnan(row->expansion_per_K)) t->expansion_per_K[cable[k]] = row->expansion_per_K;
            if (!isnan(row->mass_kg_per_m)) t->mass_kg_per_m[cable[k]] = row->mass_kg_per_m;
        }
    }
    return status;
}

static hf_status set_nodes(const hf_case *c, const hf_scene *s, hf_material *t, hf_messages *messages)
{
    hf_status status = HF_OK;
    for (int i = 0; i < c->built.n_node; i++) {
        const hf_node_settings *row = &c->built.node[i];
        char where[HF_LOCATION_SIZE];
        int n = 0;
        for (int k = 0; k < s->n_node; k++) {
            if (!hf_material_names(row->role, s->role[k])) continue;
            t->node_mass_kg[k] = row->mass_kg;
            n++;
        }
        if (n == 0)
            status = hf_error(messages, HF_BAD_CASE, "%s: this net has no %s nodes",
                              hf_config_place(c, where, "nodes.%d.role", i), hf_nodes_word[row->role]);
    }
    return status;
}

hf_status hf_config_material(const hf_case *c, const hf_scene *s, hf_material *t, hf_messages *messages)
{
    int *cable;
    void *block;
    hf_status status = hf_material_allocate(s, t);
    if (status == HF_OK) status = HF_ARENA_ARRAYS(&block, HF_ARRAY(cable, s->n_cable));
    if (status != HF_OK) return hf_error(messages, status, "%s: out of memory", c->path);
    hf_status of_nodes = set_nodes(c, s, t, messages);
    status = set_cables(c, s, cable, t, messages);
    hf_arena_free_block(block);
    return status == HF_OK ? of_nodes : status;
}
