#include <hifdm/states.h>

#include "base/arena.h"

static void lay_out(hf_arena *arena, const hf_scene *s, size_t n_member, int n, hf_states *states)
{
    for (int k = 0; k < n; k++) {
        hf_state *state = &states->state[k];
        state->rise_K = hf_arena_take(arena, (size_t)s->n_cable, sizeof(double));
        state->member_rise_K = hf_arena_take(arena, n_member, sizeof(double));
        state->force_N = hf_arena_take(arena, 3 * (size_t)s->n_node, sizeof(double));
        state->move_m = hf_arena_take(arena, 3 * (size_t)s->n_node, sizeof(double));
    }
}

hf_status hf_states_allocate(const hf_scene *scene, int n_member, int n, hf_states *states)
{
    hf_arena arena = {0};
    *states = (hf_states){0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, scene, (size_t)n_member, n, states)));
    states->block = arena.block;
    states->n = n;
    return HF_OK;
}

void hf_states_free(hf_states *states)
{
    hf_material_free(&states->material);
    hf_arena_free_block(states->block);
    *states = (hf_states){0};
}
