/* Classes of numbers joined pair by pair. */
#include "support.h"

#include "base/union_find.h"

enum { N = 60 };

/* Against labels that are replaced one by one: the same pairs are in one class, after every join. */
START_TEST(classes_are_those_of_labels)
{
    struct rng rng = rng_start((uint64_t)_i);
    int parent[N], label[N];
    for (int i = 0; i < N; i++)
        parent[i] = label[i] = i;
    for (int n = 0; n < N; n++) {
        int a = rng_int(&rng, 0, N - 1), b = rng_int(&rng, 0, N - 1), old = label[a];
        parent[hf_union_find_root(parent, a)] = hf_union_find_root(parent, b);
        for (int i = 0; i < N; i++)
            if (label[i] == old) label[i] = label[b];
        for (int i = 0; i < N; i++)
            for (int j = 0; j < i; j++)
                ck_assert_int_eq(hf_union_find_root(parent, i) == hf_union_find_root(parent, j), label[i] == label[j]);
    }
}
END_TEST

Suite *suite_unit_union_find(void)
{
    Suite *suite = suite_create("unit/union_find");
    TCase *tcase = tcase_create("union_find");
    tcase_add_loop_test(tcase, classes_are_those_of_labels, 0, 20);
    suite_add_tcase(suite, tcase);
    return suite;
}
