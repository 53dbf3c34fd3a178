/* In a file of its own: the test program puts guards behind arrays by replacing the calls of hf_arena_take. */
#include "base/arena.h"

#include <string.h>

static void set_pointers(hf_arena *arena, size_t n, const hf_arena_array *array)
{
    for (size_t i = 0; i < n; i++) {
        void *space = hf_arena_take(arena, array[i].count, array[i].item_bytes);
        memcpy(array[i].pointer, &space, sizeof space);
    }
}

hf_status hf_arena_arrays(void **block, size_t n, const hf_arena_array *array)
{
    hf_arena arena = {0};
    hf_status status = HF_ARENA_MAKE(&arena, set_pointers(&arena, n, array));
    *block = arena.block;
    return status;
}
