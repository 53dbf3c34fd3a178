/* Reads the materials of cables and nodes from the rows of `cables` and `nodes`. */
#include <hifdm/config.h>

#include "base/arena.h"
#include "net/cable_pick.h"

#include <math.h>
#include <stdio.h>

#define WHERE_SIZE (HF_PATH_SIZE + 96)

static void location_of(const hf_case *c, const char *list, int row, const char *key, char where[WHERE_SIZE])
{
    char path[64];
    snprintf(path, sizeof path, "%s.%d.%s", list, row, key);
    hf_config_location(c, path, where, WHERE_SIZE);
}

static hf_status set_cables(const hf_case *c, const hf_scene *s, int *cable, hf_material *t, hf_messages *messages)
{
    hf_status status = HF_OK;
    for (int i = 0; i < c->built.n_cable; i++) {
        const hf_cable_settings *row = &c->built.cable[i];
        char where[WHERE_SIZE];
        location_of(c, "cables", i, "set", where);
        int n = hf_cable_pick_some(s, row->set, where, cable, messages);
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
        char where[WHERE_SIZE];
        int n = 0;
        for (int k = 0; k < s->n_node; k++) {
            if (!hf_material_names(row->role, s->role[k])) continue;
            t->node_mass_kg[k] = row->mass_kg;
            n++;
        }
        location_of(c, "nodes", i, "role", where);
        if (n == 0)
            status = hf_error(messages, HF_BAD_CASE, "%s: this net has no %s nodes", where, hf_nodes_word[row->role]);
    }
    return status;
}

hf_status hf_config_material(const hf_case *c, const hf_scene *s, hf_material *t, hf_messages *messages)
{
    int *cable = NULL;
    hf_arena arena = {0};
    hf_status status = hf_material_allocate(s, t);
    if (status == HF_OK)
        status = HF_ARENA_MAKE(&arena, cable = hf_arena_take(&arena, (size_t)s->n_cable, sizeof *cable));
    if (status != HF_OK) return hf_error(messages, status, "%s: out of memory", c->path);
    hf_status of_nodes = set_nodes(c, s, t, messages);
    status = set_cables(c, s, cable, t, messages);
    hf_arena_free(&arena);
    return status == HF_OK ? of_nodes : status;
}
