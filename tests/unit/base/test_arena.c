/* The arena: counting pass and real pass agree, aligned, zeroed, safe against overflow. */
#include "support.h"

#include "base/arena.h"

#include <string.h>

struct layout {
    double *a;
    char *b;
    int *none, *c;
};

static void lay_out(hf_arena *arena, struct layout *l)
{
    l->a = hf_arena_take(arena, 17, sizeof *l->a);
    l->b = hf_arena_take(arena, 3, sizeof *l->b);
    l->none = hf_arena_take(arena, 0, sizeof *l->none);
    l->c = hf_arena_take(arena, 64, sizeof *l->c);
}

START_TEST(both_passes_agree)
{
    hf_arena arena = {0};
    struct layout l;
    lay_out(&arena, &l);
    size_t counted = arena.used;
    ck_assert_ptr_null(l.a);                        /* nothing is usable while counting */
    ck_assert_uint_eq(counted, 192 + 64 + 0 + 256); /* 136, 3, 0 and 256 bytes, each rounded up to 64 */
    ck_assert_int_eq(hf_arena_allocate(&arena), HF_OK);
    ck_assert_uint_eq(arena.size, counted);
    ck_assert_uint_eq(arena.used, 0);
    lay_out(&arena, &l);
    ck_assert_uint_eq(arena.used, counted);
    hf_arena_free(&arena);
    ck_assert_ptr_null(arena.block);
}
END_TEST

START_TEST(parts_are_aligned_zero_and_apart)
{
    hf_arena arena = {0};
    struct layout l;
    ck_assert_int_eq(HF_ARENA_MAKE(&arena, lay_out(&arena, &l)), HF_OK);
    ck_assert_uint_eq(arena.used, arena.size);
    for (size_t i = 0; i < arena.size; i++)
        ck_assert_int_eq(arena.block[i], 0);
    ck_assert_uint_eq((uintptr_t)l.a % HF_ALIGNMENT, 0);
    ck_assert_uint_eq((uintptr_t)l.b % HF_ALIGNMENT, 0);
    ck_assert_uint_eq((uintptr_t)l.c % HF_ALIGNMENT, 0);
    memset(l.a, 1, 17 * sizeof *l.a);
    memset(l.b, 2, 3);
    memset(l.c, 3, 64 * sizeof *l.c);
    for (size_t i = 0; i < 17 * sizeof *l.a; i++)
        ck_assert_int_eq(((char *)l.a)[i], 1);
    for (size_t i = 0; i < 3; i++)
        ck_assert_int_eq(l.b[i], 2);
    hf_arena_free(&arena);
}
END_TEST

START_TEST(empty_arena_can_be_allocated)
{
    hf_arena arena = {0};
    ck_assert_int_eq(hf_arena_allocate(&arena), HF_OK);
    ck_assert_ptr_nonnull(arena.block);
    hf_arena_free(&arena);
}
END_TEST

/* A total beyond SIZE_MAX must not wrap around to a small size, and the overflow must stay recorded. */
START_TEST(overflow_is_out_of_memory)
{
    static const size_t count[] = {SIZE_MAX, SIZE_MAX / 8, SIZE_MAX / 8 + 1, SIZE_MAX / 8 - 7};
    for (size_t i = 0; i < sizeof count / sizeof *count; i++) {
        hf_arena arena = {0};
        hf_arena_take(&arena, count[i], 8);
        hf_arena_take(&arena, 1, 8);
        ck_assert_uint_eq(arena.used, SIZE_MAX);
        ck_assert_int_eq(hf_arena_allocate(&arena), HF_NO_MEMORY);
        ck_assert_ptr_null(arena.block);
    }
}
END_TEST

START_TEST(sum_of_parts_may_overflow_too)
{
    hf_arena arena = {0};
    hf_arena_take(&arena, SIZE_MAX / 2, 1);
    hf_arena_take(&arena, SIZE_MAX / 2, 1);
    ck_assert_uint_eq(arena.used, SIZE_MAX);
    ck_assert_int_eq(hf_arena_allocate(&arena), HF_NO_MEMORY);
}
END_TEST

START_TEST(failed_allocation_is_out_of_memory)
{
    hf_arena arena = {0};
    double *part = (double *)&arena;
    fail_allocation_at(1);
    hf_status status = HF_ARENA_MAKE(&arena, part = hf_arena_take(&arena, 100, sizeof *part));
    ck_assert(end_allocation_failure());
    ck_assert_int_eq(status, HF_NO_MEMORY);
    ck_assert_ptr_null(arena.block);
    ck_assert_ptr_null(part);
    hf_arena_free(&arena); /* harmless */
}
END_TEST

START_TEST(listed_arrays_are_those_of_an_arena)
{
    void *block;
    double *a, *none;
    char *b;
    ck_assert_int_eq(HF_ARENA_ARRAYS(&block, HF_ARRAY(a, 17), HF_ARRAY(b, 3), HF_ARRAY(none, 0)), HF_OK);
    ck_assert_ptr_eq(a, block);
    ck_assert_ptr_nonnull(none);
    ck_assert((unsigned char *)b >= (unsigned char *)(a + 17) && (uintptr_t)b % HF_ALIGNMENT == 0);
    for (int i = 0; i < 17; i++)
        ck_assert(a[i] == 0);
    hf_arena_free_block(block);
}
END_TEST

START_TEST(listed_arrays_are_null_without_memory)
{
    void *block = &block;
    double *a = block;
    int *b = block;
    fail_allocation_at(1);
    hf_status status = HF_ARENA_ARRAYS(&block, HF_ARRAY(a, 17), HF_ARRAY(b, 3));
    ck_assert(end_allocation_failure());
    ck_assert_int_eq(status, HF_NO_MEMORY);
    ck_assert(!block && !a && !b);
    ck_assert_int_eq(HF_ARENA_ARRAYS(&block, HF_ARRAY(a, SIZE_MAX / 8), HF_ARRAY(b, 3)), HF_NO_MEMORY);
    ck_assert(!block && !a && !b);
}
END_TEST

Suite *suite_unit_arena(void)
{
    Suite *suite = suite_create("unit/arena");
    TCase *tests = tcase_create("arena");
    suite_add_tcase(suite, tests);
    tcase_add_checked_fixture(tests, without_guards, NULL);
    tcase_add_test(tests, both_passes_agree);
    tcase_add_test(tests, parts_are_aligned_zero_and_apart);
    tcase_add_test(tests, empty_arena_can_be_allocated);
    tcase_add_test(tests, overflow_is_out_of_memory);
    tcase_add_test(tests, sum_of_parts_may_overflow_too);
    tcase_add_test(tests, failed_allocation_is_out_of_memory);
    tcase_add_test(tests, listed_arrays_are_those_of_an_arena);
    tcase_add_test(tests, listed_arrays_are_null_without_memory);
    return suite;
}
