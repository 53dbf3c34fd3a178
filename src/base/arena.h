/* arena - one zeroed, 64-byte aligned block per owner: the only heap call of everything on the hot path.
 *
 * The same code lays the block out twice: first on an arena without a block, where it only counts, then on the real
 * one.
 *
 *     hf_arena arena = {0};
 *     HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, object)));
 *     object->block = arena.block; // the owner frees it by hf_arena_free_block
 */
#ifndef HIFDM_ARENA_H
#define HIFDM_ARENA_H

#include <hifdm/status.h>

#define HF_ALIGNMENT 64

typedef struct {
    unsigned char *block; /* NULL while counting */
    size_t size;          /* bytes of the block */
    size_t used;          /* bytes taken so far; SIZE_MAX after an overflow */
} hf_arena;

/* Zeroed space for `count` items of `item_bytes`, aligned to 64 bytes. While counting the pointer is not usable. */
void *hf_arena_take(hf_arena *arena, size_t count, size_t item_bytes);

/* Allocate the block that the counting pass asked for, and start over at its beginning. HF_OK or HF_NO_MEMORY. */
hf_status hf_arena_allocate(hf_arena *arena);

/* Evaluate `lay_out`, a call of hf_arena_take or of a function that calls it, to count; allocate; evaluate it again.
 * HF_OK, or HF_NO_MEMORY: all pointers are NULL then. */
#define HF_ARENA_MAKE(arena, lay_out)                                                                                  \
    ((void)(lay_out), hf_arena_allocate(arena) != HF_OK ? HF_NO_MEMORY : ((void)(lay_out), HF_OK))

void hf_arena_free(hf_arena *arena);

static inline void hf_arena_free_block(void *block)
{
    hf_arena_free(&(hf_arena){.block = block});
}

#endif
