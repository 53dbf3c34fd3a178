#include "base/arena.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void *hf_arena_take(hf_arena *arena, size_t count, size_t item_bytes)
{
    size_t offset = arena->used;
    if (offset == SIZE_MAX || (item_bytes && count > (SIZE_MAX - offset - HF_ALIGNMENT) / item_bytes)) {
        arena->used = SIZE_MAX;
        return NULL;
    }
    size_t bytes = (count * item_bytes + HF_ALIGNMENT - 1) / HF_ALIGNMENT * HF_ALIGNMENT;
    arena->used += bytes;
    return arena->block ? arena->block + offset : NULL;
}

hf_status hf_arena_allocate(hf_arena *arena)
{
    if (arena->used == SIZE_MAX) return HF_NO_MEMORY;
    size_t size = arena->used ? arena->used : HF_ALIGNMENT;
    arena->block = aligned_alloc(HF_ALIGNMENT, size);
    if (!arena->block) return HF_NO_MEMORY;
    memset(arena->block, 0, size);
    arena->size = size;
    arena->used = 0;
    return HF_OK;
}

void hf_arena_free(hf_arena *arena)
{
    free(arena->block);
    *arena = (hf_arena){0};
}
