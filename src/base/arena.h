/* arena - one zeroed, 64-byte aligned block per owner: the only heap call of everything on the hot path.
 *
 * Lay out twice with the same code: first on an arena without a block, which only counts, then on the real one.
 *
 *     hf_arena a = {0};
 *     lay_out(&a, object);              // pointers are meaningless, a.used is the size
 *     if (hf_arena_allocate(&a)) ...    // one block of a.used bytes
 *     lay_out(&a, object);              // pointers are real
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

void hf_arena_free(hf_arena *arena);

#endif
