/* arena - one zeroed, 64-byte aligned block of memory for each owner. Code on the hot path allocates nothing else.
 *
 * An owner lists its arrays:
 *
 *     HF_TRY(HF_ARENA_ARRAYS(&object->block, HF_ARRAY(object->length_m, n_cable), HF_ARRAY(object->row, n_node)));
 *     hf_arena_free_block(object->block);
 *
 * Where arrays cannot be listed, because their number varies, layout code runs twice. The first run uses an arena
 * without a block and only counts bytes. The second run uses the allocated block.
 *
 *     hf_arena arena = {0};
 *     HF_TRY(HF_ARENA_MAKE(&arena, lay_out(&arena, object)));
 *     object->block = arena.block; // the owner frees it with hf_arena_free_block
 *
 * A struct may also contain its arena. Its owner then frees it with hf_arena_free(&object.arena). */
#pragma once

#include <hifdm/status.h>

#define HF_ALIGNMENT 64

typedef struct {
    unsigned char *block; /* NULL while counting */
    size_t size;          /* bytes of the block */
    size_t used;          /* bytes taken so far; SIZE_MAX after an overflow */
} hf_arena;

/* Returns zeroed space for `count` items of `item_bytes` bytes each, aligned to 64 bytes. Returns NULL while counting
 * and after an overflow of the size. */
void *hf_arena_take(hf_arena *arena, size_t count, size_t item_bytes);

/* Allocates the block that the counting run needs, and resets `used` to 0 for the second run. Returns
 * HF_OK or HF_NO_MEMORY. */
hf_status hf_arena_allocate(hf_arena *arena);

/* Evaluates the expression `lay_out` to count, allocates the block, and evaluates `lay_out` again. `lay_out` is a call
 * of hf_arena_take or of a function that calls it. Returns HF_OK or HF_NO_MEMORY. After HF_NO_MEMORY all pointers that
 * `lay_out` set are NULL. */
#define HF_ARENA_MAKE(arena, lay_out)                                                                                  \
    ((void)(lay_out), hf_arena_allocate(arena) != HF_OK ? HF_NO_MEMORY : ((void)(lay_out), HF_OK))

/* Describes an array of `count` items. `pointer` is the pointer that will point to it; the items have its type. */
typedef struct {
    void *pointer; /* address of that pointer */
    size_t count, item_bytes;
} hf_arena_array;
#define HF_ARRAY(pointer, count)                                                                                       \
    {                                                                                                                  \
        &(pointer), (size_t)(count), sizeof *(pointer)                                                                 \
    }

/* Allocates a zeroed block for arrays HF_ARRAY(pointer, count), each aligned to 64 bytes, and sets their pointers and
 * *block. The owner frees the block with hf_arena_free_block. Returns HF_OK or HF_NO_MEMORY. After HF_NO_MEMORY all
 * pointers and *block are NULL. */
#define HF_ARENA_ARRAYS(block, ...)                                                                                    \
    hf_arena_arrays(block, sizeof((const hf_arena_array[]){__VA_ARGS__}) / sizeof(hf_arena_array),                     \
                    (const hf_arena_array[]){__VA_ARGS__})
hf_status hf_arena_arrays(void **block, size_t n, const hf_arena_array *array);

void hf_arena_free(hf_arena *arena);

/* The arrays of a struct are listed once, in rows X(type, name, count, meaning). These make the members of the struct,
 * list the arrays of the struct `to` for HF_ARENA_ARRAYS, or take them in a layout function with an `arena`. */
#define HF_ARENA_MEMBER(type, name, ...) type *name;
#define HF_ARENA_ITEM(type, name, count, ...) HF_ARRAY(to->name, count),
#define HF_ARENA_TAKE(type, name, count, ...) to->name = hf_arena_take(arena, (size_t)(count), sizeof(type));

static inline void hf_arena_free_block(void *block)
{
    hf_arena_free(&(hf_arena){.block = block});
}
