/* Puts guards behind every array of an arena, in the test program alone. A guard has the bytes FF 7F FF 7F ..., which
 * are NaN as a double and beyond every array as an index. A read beyond an array therefore gives a number that no test
 * accepts. A write is found when the arena is freed. Without guards such an access would reach the zeros that fill an
 * array up to whole cache lines, or the next array. */
#include "support.h"

#include "base/arena.h"

#include <pthread.h>

void *__real_hf_arena_take(hf_arena *arena, size_t count, size_t item_bytes);
hf_status __real_hf_arena_allocate(hf_arena *arena);
void __real_hf_arena_free(hf_arena *arena);
void *__wrap_hf_arena_take(hf_arena *arena, size_t count, size_t item_bytes);
hf_status __wrap_hf_arena_allocate(hf_arena *arena);
void __wrap_hf_arena_free(hf_arena *arena);

enum { GUARD = HF_ALIGNMENT, MAX_GUARD = 1 << 16 };

static struct guard {
    const unsigned char *block, *from;
    size_t n;
} guards[MAX_GUARD];
static int n_guard;
static bool is_off;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static unsigned char guard_at(const unsigned char *place)
{
    return (uintptr_t)place % 2 ? 0x7F : 0xFF;
}

void without_guards(void)
{
    is_off = true;
}

/* Removes the guards of a block from the list. Returns true if all of them were unchanged. */
static bool forget_guards(const unsigned char *block)
{
    bool is_whole = true;
    pthread_mutex_lock(&lock);
    for (int i = n_guard - 1; i >= 0 && block; i--) {
        if (guards[i].block != block) continue;
        for (size_t k = 0; k < guards[i].n; k++)
            is_whole = is_whole && guards[i].from[k] == guard_at(guards[i].from + k);
        guards[i] = guards[--n_guard];
    }
    pthread_mutex_unlock(&lock);
    return is_whole;
}

void *__wrap_hf_arena_take(hf_arena *arena, size_t count, size_t item_bytes)
{
    unsigned char *array = __real_hf_arena_take(arena, count, item_bytes);
    if (is_off) return array;
    unsigned char *guard = __real_hf_arena_take(arena, GUARD, 1);
    if (!guard || !array) return array;
    unsigned char *end = array + count * item_bytes;
    size_t n = (size_t)(guard + GUARD - end);
    for (size_t k = 0; k < n; k++)
        end[k] = guard_at(end + k);
    pthread_mutex_lock(&lock);
    if (n_guard < MAX_GUARD) guards[n_guard++] = (struct guard){arena->block, end, n};
    pthread_mutex_unlock(&lock);
    return array;
}

/* The system may return a block again that was freed by free alone, so its old guards are removed. */
hf_status __wrap_hf_arena_allocate(hf_arena *arena)
{
    hf_status status = __real_hf_arena_allocate(arena);
    pthread_mutex_lock(&lock);
    for (int i = n_guard - 1; i >= 0; i--) {
        const unsigned char *from = guards[i].from;
        bool is_within = from >= arena->block && from < arena->block + arena->size;
        if (guards[i].block == arena->block || is_within) guards[i] = guards[--n_guard];
    }
    pthread_mutex_unlock(&lock);
    return status;
}

void __wrap_hf_arena_free(hf_arena *arena)
{
    bool is_whole = forget_guards(arena->block);
    __real_hf_arena_free(arena);
    if (!is_whole) ck_abort_msg("something was written behind an array of an arena");
}
