/* Allocates all memory that one solver thread writes to, from the list HF_WORKSPACE_FIELDS. */
#include <hifdm/workspace.h>

#include "base/arena.h"
#include "linalg/lapack.h"

static void lay_out(hf_arena *arena, const hf_model *m, hf_workspace *to){HF_WORKSPACE_FIELDS(HF_ARENA_TAKE)}

size_t hf_workspace_bytes(const hf_model *m)
{
    hf_arena arena = {0};
    hf_workspace w;
    lay_out(&arena, m, &w);
    return arena.used;
}

hf_status hf_workspace_create(const hf_model *m, hf_workspace *w)
{
    *w = (hf_workspace){0};
    hf_arena arena = {0};
    HF_TRY(hf_lapack_load(NULL));
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, m, w)));
    w->block = arena.block;
    w->n_moving = m->n_free;
    return HF_OK;
}

void hf_workspace_free(hf_workspace *w)
{
    hf_arena_free_block(w->block);
    *w = (hf_workspace){0};
}

bool hf_workspace_iterates(const hf_model *m, const hf_workspace *w)
{
    for (int e = 0; e < m->n_cable; e++)
        if (hf_law_has(w->law[e], HF_LAW_ITERATES)) return true;
    return false;
}
