#include <hifdm/load_cases.h>

#include "base/arena.h"

static void lay_out(hf_arena *arena, const hf_scene *s, size_t n_member, int n, hf_load_cases *load_cases)
{
    for (int k = 0; k < n; k++) {
        hf_load_case *load_case = &load_cases->load_case[k];
        load_case->rise_K = hf_arena_take(arena, (size_t)s->n_cable, sizeof(double));
        load_case->member_rise_K = hf_arena_take(arena, n_member, sizeof(double));
        load_case->force_N = hf_arena_take(arena, 3 * (size_t)s->n_node, sizeof(double));
        load_case->support_displacement_m = hf_arena_take(arena, 3 * (size_t)s->n_node, sizeof(double));
    }
}

hf_status hf_load_cases_allocate(const hf_scene *scene, int n_member, int n, hf_load_cases *load_cases)
{
    hf_arena arena = {0};
    *load_cases = (hf_load_cases){0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, scene, (size_t)n_member, n, load_cases)));
    load_cases->block = arena.block;
    load_cases->n = n;
    return HF_OK;
}

void hf_load_cases_free(hf_load_cases *load_cases)
{
    hf_material_free(&load_cases->material);
    hf_arena_free_block(load_cases->block);
    *load_cases = (hf_load_cases){0};
}
